//! Checkpoints, from which a run that was killed can continue: a manifest of the finished ranges, and the state that belongs to them.
//!
//! A save writes the state under a new name and then replaces the manifest, which names the state and its checksum, in one step: at any
//! moment the manifest on disk and the state that it names belong together. Likewise, a result is first written into the checkpoint, then
//! the manifest says that it is complete, and only then is it put in place, by this run or the next.

mod manifest;
mod saved;
mod switch;

pub use manifest::{Found, found};
pub use saved::{Progress, Saved};
pub use switch::{Switch, finish_switch};

use crate::error::{Error, Result};
use crate::files::{Claim, is_regular, remove_if_there, replace, replace_with, was_to_become, writing_name};
use crate::models::Models;
use crate::names::CHECKPOINT;
use crate::plan::Plan;
use crate::reduce::{Reduction, State};
use crate::result_files::{is_ours, is_remains};
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
    /// Starts a checkpoint in a result directory; the checkpoint of an earlier run is removed.
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
            // A folder without a manifest would not be recognised, so it gets its name only when it has one.
            Found::Nothing => {
                let new = beside(&folder);
                fs::create_dir(&new).map_err(|source| directory.lost(source))?;
                manifest.write(&new)?;
                fs::rename(&new, &folder).map_err(Error::io(&folder))?;
            }
        }
        Ok(Self { directory: directory.clone(), saved: Saved::new(folder, manifest) })
    }

    /// Opens the checkpoint of a result directory, of whatever study it is.
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

    /// Continues a checkpoint for this study and shard.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if it is of another study or shard; [`Error::Io`].
    pub fn adopt(&mut self, study: &Study, text: &str, shard: Shard) -> Result<()> {
        self.saved.require(study, shard)?;
        // The texts may differ in layout, and the studies in what does not affect the finished designs.
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

    /// The directory of the checkpoint.
    pub fn directory(&self) -> &Claim {
        &self.directory
    }

    /// Its contents when it was opened.
    pub fn saved(&self) -> &Saved {
        &self.saved
    }

    /// Takes the work that was finished before, if it fits this plan.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if it cannot.
    pub fn take_progress(&mut self, plan: &Plan, reduction: &Reduction) -> Result<Option<Progress>> {
        self.saved.take_progress(plan, reduction)
    }

    /// Saves the state of the finished ranges.
    ///
    /// # Errors
    /// [`Error::Io`]; the save before is then still complete.
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

    /// Writes a file of the result into the checkpoint; [`Checkpoint::switch`] puts it in place.
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

    /// Puts the staged files in place of those that are `replaced`, and removes the checkpoint; the last file is the mark of a finished
    /// result. Whenever this is interrupted, either the old result or all of the new one is there: once the manifest says that the files
    /// are complete, this run or the next one puts them in place.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Request`] if something that is not among `replaced` has the name of one of the files.
    pub fn switch(mut self, files: Vec<String>, replaced: Vec<String>) -> Result<()> {
        self.announce(files, replaced)?;
        finish_switch(&self.directory).map(|_| ())
    }

    /// Notes in the manifest that the staged files are complete and are to be put in place.
    pub(crate) fn announce(&mut self, files: Vec<String>, replaced: Vec<String>) -> Result<()> {
        self.saved.manifest.switch = Some(Switch { files, replaced });
        self.saved.manifest.write(&self.folder())
    }
}

/// The error for something else at the path of the checkpoint.
pub(crate) fn foreign(folder: &Path, why: &str) -> Error {
    Error::Request(format!(
        "{} is where the checkpoint would be, but this program did not write it ({why}); move it away, or write to another --out",
        folder.display()
    ))
}

/// Is this the name of a state's file?
fn is_state(name: &str) -> bool {
    let number = name.strip_prefix("state-").and_then(|it| it.strip_suffix(".bin"));
    number.is_some_and(|it| !it.is_empty() && it.bytes().all(|it| it.is_ascii_digit()))
}

/// Removes the files of a checkpoint from its folder, except for `kept`; any other file is not this program's and stays.
fn remove_all_but(folder: &Path, kept: &[&str]) -> Result<()> {
    let entries = |folder: &Path| -> Result<Vec<String>> {
        let entries = fs::read_dir(folder).map_err(Error::io(folder))?;
        entries.map(|entry| Ok(entry.map_err(Error::io(folder))?.file_name().to_string_lossy().into_owned())).collect()
    };
    for name in entries(folder)? {
        let path = folder.join(&name);
        // Before version 0.1 the lock was in this folder.
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
        // If anything else is in it, the folder stays.
        let _ = fs::remove_dir(&result);
    }
    Ok(())
}

/// Removes a checkpoint: the run is complete and its result in place. Files that this program did not put there stay, and the folder too.
fn remove(folder: &Path) -> Result<()> {
    // Rename it first: whenever this is interrupted, there is either a whole checkpoint or none.
    let old = beside(folder);
    fs::rename(folder, &old).map_err(Error::io(folder))?;
    remove_all_but(&old, &[])?;
    if fs::remove_dir(&old).is_err() {
        fs::rename(&old, folder).map_err(Error::io(folder))?;
    }
    Ok(())
}

/// Removes the remains of a checkpoint whose process was killed while it made or removed it.
pub(crate) fn remove_remains(folder: &Path) -> Result<()> {
    remove_all_but(folder, &[])?;
    // Not empty: it has something that is not this program's.
    let _ = fs::remove_dir(folder);
    Ok(())
}

/// The name of a checkpoint's folder while it is made or removed.
fn beside(folder: &Path) -> PathBuf {
    folder.with_file_name(writing_name(&folder.file_name().unwrap_or_default().to_string_lossy(), std::process::id()))
}
