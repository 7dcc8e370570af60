//! Reads a checkpoint without writing anything: a shard to be merged, or the start of a run that continues.

use super::manifest::Manifest;
use crate::error::{Error, Result};
use crate::files::is_regular;
use crate::models::Models;
use crate::plan::Plan;
use crate::reduce::{Reduction, State};
use crate::study::{Study, differences};
use crate::tiles::{Ranges, Shard};
use serde_json::Value;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

/// How often a checkpoint is read again if it was replaced meanwhile.
const ATTEMPTS: u32 = 20;

/// The work that was finished before.
#[derive(Debug)]
pub struct Progress {
    /// Positions that were judged.
    pub done: Ranges,
    /// Their state.
    pub state: State,
}

/// A checkpoint as it was read.
#[derive(Debug)]
pub struct Saved {
    folder: PathBuf,
    pub(super) manifest: Manifest,
    progress: Option<Progress>,
}

impl Saved {
    /// Reads the checkpoint in `folder`, of whatever study it is.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if there is none, it is damaged, or of another version.
    pub fn read(folder: &Path) -> Result<Self> {
        Self::read_with(&Models::new(), folder)
    }

    /// The same where the study may be of any of these models.
    ///
    /// # Errors
    /// As [`Saved::read`].
    pub fn read_with(models: &Models, folder: &Path) -> Result<Self> {
        // A run that uses the checkpoint first replaces the manifest, and then removes the state that the old one named.
        let mut attempts = 0..ATTEMPTS;
        loop {
            let manifest = Manifest::read(folder, models)?;
            match progress(folder, &manifest) {
                Err(error) => {
                    let replaced = Manifest::read(folder, models).is_ok_and(|it| it.saves != manifest.saves);
                    if !replaced || attempts.next().is_none() {
                        return Err(error);
                    }
                }
                Ok(progress) => return Ok(Self { folder: folder.to_owned(), manifest, progress }),
            }
        }
    }

    /// A checkpoint without finished work.
    pub(super) fn new(folder: PathBuf, manifest: Manifest) -> Self {
        Self { folder, manifest, progress: None }
    }

    /// Refuses a checkpoint of another study or shard, and says what changed.
    ///
    /// # Errors
    /// [`Error::Checkpoint`].
    pub fn require(&self, study: &Study, shard: Shard) -> Result<()> {
        let refuse = |problem: String| Err(Error::Checkpoint { path: self.folder.clone(), problem });
        let (was, is) = (&self.manifest.description, &study.describe());
        if self.manifest.study_hash != study.hash() && without_budget(was) != without_budget(is) {
            let changed = differences(was, is).join("; ");
            return refuse(format!("the checkpoint is of another study ({changed}); restore the study, or start again with --force"));
        }
        if self.manifest.shard != shard {
            let (was, is) = (self.manifest.shard, shard);
            return refuse(format!("the checkpoint is of shard {was}, not {is}; use --shard {was}, or start again with --force"));
        }
        Ok(())
    }

    /// Was anything finished before?
    pub fn has_progress(&self) -> bool {
        self.progress.as_ref().is_some_and(|progress| progress.done.count() > 0)
    }

    /// Was all of its shard finished before?
    pub fn is_finished(&self) -> bool {
        let range = self.manifest.shard.range(self.manifest.designs);
        self.progress.as_ref().is_some_and(|progress| progress.done.missing_from(range).count() == 0)
    }

    /// Takes the work that was finished before, if it fits this plan.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if it cannot.
    pub fn take_progress(&mut self, plan: &Plan, reduction: &Reduction) -> Result<Option<Progress>> {
        let Some(progress) = self.progress.take() else { return Ok(None) };
        let shard = self.manifest.shard.range(self.manifest.designs);
        let fits = if self.manifest.designs == plan.designs() {
            reduction.check(&progress.state, shard.end - shard.start, plan.designs())
        } else {
            Err(format!("it is of {} designs, not {}", self.manifest.designs, plan.designs()))
        };
        let misfit = |problem| Error::Checkpoint {
            path: self.folder.clone(),
            problem: format!("the checkpoint does not fit its study ({problem}); start again with --force"),
        };
        fits.map(|()| Some(progress)).map_err(misfit)
    }

    /// Its study.
    pub fn study(&self) -> &Study {
        &self.manifest.study
    }

    /// The text of that study's file.
    pub fn study_text(&self) -> &str {
        &self.manifest.study_text
    }

    /// The study's hash.
    pub fn study_hash(&self) -> &str {
        &self.manifest.study_hash
    }

    /// The description of that study.
    pub fn description(&self) -> &Value {
        &self.manifest.description
    }

    /// Its shard.
    pub fn shard(&self) -> Shard {
        self.manifest.shard
    }

    /// Number of designs of the whole study.
    pub fn designs(&self) -> u64 {
        self.manifest.designs
    }
}

/// A description without the budget of the front, which does not affect the finished designs.
fn without_budget(description: &Value) -> Value {
    let mut description = description.clone();
    if let Some(object) = description.as_object_mut() {
        object.remove("front_budget");
    }
    description
}

/// The finished ranges of the manifest, and the state that belongs to them.
fn progress(folder: &Path, manifest: &Manifest) -> Result<Option<Progress>> {
    let Some((name, checksum)) = &manifest.state else { return Ok(None) };
    let refuse = |problem: &str| Error::Checkpoint { path: folder.to_owned(), problem: format!("{name} {problem}") };
    let again = "start again with --force";
    // A name with a path in it could be any file.
    if !super::is_state(name) {
        return Err(refuse(&format!("is not the name of a state; {again}")));
    }
    let path = folder.join(name);
    if !is_regular(&path) {
        return Err(refuse(&format!("is missing; {again}")));
    }
    // The checksum is verified without reading the file into memory, however large it is.
    if checksum_of(&path).map_err(Error::io(&path))? != *checksum {
        return Err(refuse(&format!("does not match its checksum; {again}")));
    }
    let bytes = fs::read(&path).map_err(Error::io(&path))?;
    let state = match postcard::take_from_bytes(&bytes) {
        Ok((state, [])) => state,
        _ => return Err(refuse(&format!("is not the state of a sweep; {again}"))),
    };
    Ok(Some(Progress { done: manifest.done.clone(), state }))
}

/// The CRC-32 of a file.
fn checksum_of(path: &Path) -> std::io::Result<u32> {
    let mut file = File::open(path)?;
    let mut hasher = crc32fast::Hasher::new();
    let mut piece = vec![0; 1 << 16];
    loop {
        match file.read(&mut piece)? {
            0 => return Ok(hasher.finalize()),
            read => hasher.update(&piece[..read]),
        }
    }
}
