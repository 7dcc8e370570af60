//! What a killed run leaves behind: a manifest of finished ranges and the certified state that belongs to them.
//!
//! A save writes the state under a new name and then replaces the manifest, which names the state and its checksum, in one
//! step: at any moment the manifest on disk and the state it names belong together. So it is with the result: it is written into
//! the checkpoint first, then the manifest says that it is whole, and from there on it is put in place, by this run or the next.

mod manifest;
mod saved;
mod switch;

pub use manifest::{Found, found};
pub use saved::{Progress, Saved};
pub use switch::{Switch, finish_switch};

use crate::error::{Error, Result};
use crate::files::{Claim, is_regular, remove_if_there, replace, replace_with, was_to_become, writing_name};
use crate::models::Models;
use crate::names::{CHECKPOINT, is_ours, is_remains};
use crate::plan::Plan;
use crate::reduce::{Reduction, State};
use crate::study::Study;
use crate::tiles::{Ranges, Shard};
use manifest::{MANIFEST, Manifest};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use switch::RESULT;

/// A checkpoint that this process writes, in the result directory that it holds.
#[derive(Debug)]
pub struct Checkpoint {
    directory: Claim,
    saved: Saved,
}

impl Checkpoint {
    /// Starts a checkpoint in a result directory; what an earlier run kept there is dropped.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Request`] if something else has the checkpoint's name.
    pub fn create(directory: &Claim, study: &Study, text: &str, shard: Shard, designs: u64) -> Result<Self> {
        let folder = directory.path().join(CHECKPOINT);
        let manifest = Manifest {
            program: env!("CARGO_PKG_VERSION").to_owned(),
            study_hash: study.hash(),
            study: study.clone(),
            description: study.describe(),
            study_text: text.to_owned(),
            designs,
            shard,
            done: Ranges::default(),
            state: None,
            saves: 0,
            switch: None,
        };
        match found(&folder) {
            Found::Foreign(why) => return Err(foreign(&folder, &why)),
            Found::Checkpoint => {
                manifest.write(&folder)?;
                remove_all_but(&folder, &[MANIFEST])?;
            }
            // A folder without a manifest would be nobody's: it gets its name once it has one.
            Found::Nothing => {
                let new = beside(&folder);
                fs::create_dir(&new).map_err(|source| directory.lost(source))?;
                manifest.write(&new)?;
                fs::rename(&new, &folder).map_err(Error::io(&folder))?;
            }
        }
        Ok(Self { directory: directory.clone(), saved: Saved::new(folder, manifest) })
    }

    /// Takes up the checkpoint of a result directory, of whatever study it is.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if there is none, it is damaged, or of another version.
    pub fn open(directory: &Claim) -> Result<Self> {
        Self::open_with(&Models::new(), directory)
    }

    /// The same where the study may be of any of these models.
    ///
    /// # Errors
    /// As [`Checkpoint::open`].
    pub fn open_with(models: &Models, directory: &Claim) -> Result<Self> {
        Ok(Self { directory: directory.clone(), saved: Saved::read_with(models, &directory.path().join(CHECKPOINT))? })
    }

    /// Goes on with a checkpoint for this study and shard.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if it is of another study or shard; [`Error::Io`].
    pub fn adopt(&mut self, study: &Study, text: &str, shard: Shard) -> Result<()> {
        self.saved.require(study, shard)?;
        // The texts may differ in layout, the studies in what changes nothing of what is done.
        let folder = self.folder();
        let manifest = &mut self.saved.manifest;
        let same = manifest.study_text == text;
        (manifest.study, manifest.study_text) = (study.clone(), text.to_owned());
        (manifest.study_hash, manifest.description) = (study.hash(), study.describe());
        // A finished shard is not saved again.
        if same { Ok(()) } else { manifest.write(&folder) }
    }

    fn folder(&self) -> PathBuf {
        self.directory.path().join(CHECKPOINT)
    }

    /// The directory that it is in.
    pub fn directory(&self) -> &Claim {
        &self.directory
    }

    /// What it held when it was opened, and what it is of.
    pub fn saved(&self) -> &Saved {
        &self.saved
    }

    /// What was finished before, once, if it can be of what this plan asks for.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if it cannot.
    pub fn take_progress(&mut self, plan: &Plan, reduction: &Reduction) -> Result<Option<Progress>> {
        self.saved.take_progress(plan, reduction)
    }

    /// Keeps the state of the finished ranges.
    ///
    /// # Errors
    /// [`Error::Io`]; what was kept before is then still whole.
    pub fn save(&mut self, done: &Ranges, state: &State) -> Result<()> {
        let folder = self.folder();
        if !is_regular(&folder.join(MANIFEST)) {
            return Err(self.directory.lost(std::io::ErrorKind::NotFound.into()));
        }
        let bytes = postcard::to_stdvec(state).expect("plain numbers and vectors can be written");
        let mut next = Manifest { saves: self.saved.manifest.saves + 1, done: done.clone(), ..self.saved.manifest.clone() };
        let name = format!("state-{}.bin", next.saves);
        replace(&folder.join(&name), &bytes)?;
        next.state = Some((name, crc32fast::hash(&bytes)));
        next.write(&folder)?;
        let old = std::mem::replace(&mut self.saved.manifest, next).state;
        old.map_or(Ok(()), |(old, _)| remove_if_there(&folder.join(old)))
    }

    /// Writes a file of the result, beside what is there: [`Checkpoint::switch`] puts it in place.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn stage(&self, name: &str, write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
        let folder = self.folder().join(RESULT);
        match fs::create_dir(&folder) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Err(self.directory.lost(error)),
            Err(error) if error.kind() != std::io::ErrorKind::AlreadyExists => return Err(Error::io(&folder)(error)),
            _ => {}
        }
        replace_with(&folder.join(name), write)
    }

    /// Puts the files that were staged, the last of them being the mark of a finished result, in place of those that are `replaced`, and
    /// removes the checkpoint. Whatever happens meanwhile, what was there or the whole of what is new can be had: once the manifest says
    /// that the files are complete, this run or the next one puts them in place.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Request`] if something that is not among `replaced` has one of the names.
    pub fn switch(mut self, files: Vec<String>, replaced: Vec<String>) -> Result<()> {
        self.announce(files, replaced)?;
        finish_switch(&self.directory).map(|_| ())
    }

    /// Says that the files that were staged are complete and are to be put in place.
    pub(crate) fn announce(&mut self, files: Vec<String>, replaced: Vec<String>) -> Result<()> {
        self.saved.manifest.switch = Some(Switch { files, replaced });
        self.saved.manifest.write(&self.folder())
    }
}

/// The request cannot be met: the checkpoint's name is taken.
pub(crate) fn foreign(folder: &Path, why: &str) -> Error {
    Error::Request(format!(
        "{} would be the folder of the checkpoint, but it is not one of this program ({why}); move it away, or write to another --out",
        folder.display()
    ))
}

/// Is this the name of a state's file?
fn is_state(name: &str) -> bool {
    let number = name.strip_prefix("state-").and_then(|it| it.strip_suffix(".bin"));
    number.is_some_and(|it| !it.is_empty() && it.bytes().all(|it| it.is_ascii_digit()))
}

/// Removes what a checkpoint leaves in its folder but for `kept`; anything else is not this program's and stays.
fn remove_all_but(folder: &Path, kept: &[&str]) -> Result<()> {
    let entries = |folder: &Path| -> Result<Vec<String>> {
        let entries = fs::read_dir(folder).map_err(Error::io(folder))?;
        entries.map(|entry| Ok(entry.map_err(Error::io(folder))?.file_name().to_string_lossy().into_owned())).collect()
    };
    for name in entries(folder)? {
        let path = folder.join(&name);
        // Up to version 0.1 the lock was in here.
        let is_own = |name: &str| name == MANIFEST || name == "lock" || is_state(name);
        let removable = is_own(&name) || was_to_become(&name).is_some_and(is_own) || name.strip_suffix(".writing").is_some_and(is_own);
        if removable && !kept.contains(&name.as_str()) && is_regular(&path) {
            remove_if_there(&path)?;
        }
    }
    let result = folder.join(RESULT);
    if result.is_dir() && !result.is_symlink() && !kept.contains(&RESULT) {
        for name in entries(&result)? {
            let path = result.join(&name);
            if (is_ours(&name) || is_remains(&name)) && is_regular(&path) {
                remove_if_there(&path)?;
            }
        }
        // With anything else in it, it stays.
        let _ = fs::remove_dir(&result);
    }
    Ok(())
}

/// Removes a checkpoint: the run is complete and its result in place. What this program did not put there stays, and so does the
/// folder then.
fn remove(folder: &Path) -> Result<()> {
    // Under another name first: whenever this is interrupted, there is a checkpoint or there is none.
    let old = beside(folder);
    fs::rename(folder, &old).map_err(Error::io(folder))?;
    remove_all_but(&old, &[])?;
    if fs::remove_dir(&old).is_err() {
        fs::rename(&old, folder).map_err(Error::io(folder))?;
    }
    Ok(())
}

/// Removes what is left of a checkpoint that was being made or removed when its process was killed.
pub(crate) fn remove_remains(folder: &Path) -> Result<()> {
    remove_all_but(folder, &[])?;
    // Not empty: there is something in it that is not this program's.
    let _ = fs::remove_dir(folder);
    Ok(())
}

/// The name that a checkpoint's folder has while it is made or removed.
fn beside(folder: &Path) -> PathBuf {
    folder.with_file_name(writing_name(&folder.file_name().unwrap_or_default().to_string_lossy(), std::process::id()))
}
