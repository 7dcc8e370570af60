//! A finished result, put in place of what was there.

use super::manifest::Manifest;
use crate::error::{Error, Result};
use crate::files::{Claim, is_regular, is_there, remove_if_there};
use crate::names::{CHECKPOINT, MARK};
use crate::result_files::is_ours;
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::Path;

/// Folder within that of the checkpoint for the files that are to be put in place.
pub(super) const RESULT: &str = "result";

/// A result whose files are complete and are being put in place.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Switch {
    /// Names of its files, the mark of a finished result last.
    pub files: Vec<String>,
    /// Names of the files of the old result: they are replaced, or removed if the new result has no file of that name.
    pub replaced: Vec<String>,
}

impl Switch {
    /// The names must be those of a result's files, and the last one the mark.
    fn check(&self) -> std::result::Result<(), String> {
        match self.files.iter().chain(&self.replaced).find(|name| !is_ours(name)) {
            Some(name) => Err(format!("{name:?} is not a file of a result")),
            None if self.files.last().is_none_or(|it| it != MARK) => Err(format!("the last file is not {MARK}")),
            None => Ok(()),
        }
    }
}

/// Puts a finished result in place, if one is waiting, and removes its checkpoint; returns whether there was one. An earlier attempt may
/// have been interrupted at any point.
///
/// # Errors
/// [`Error::Io`]; [`Error::Checkpoint`] if files are missing that the manifest names.
pub fn finish_switch(directory: &Claim) -> Result<bool> {
    let folder = directory.path().join(CHECKPOINT);
    let waiting = Manifest::switch(&folder)?;
    let refuse = |problem: String| Error::Checkpoint { path: folder.clone(), problem };
    let Some(switch) = waiting else { return Ok(false) };
    switch.check().map_err(|problem| refuse(format!("the manifest is damaged ({problem}); remove the folder and start again")))?;
    let staged = folder.join(RESULT);
    // The mark is moved last: if it is no longer here, everything is in place.
    if is_regular(&staged.join(MARK)) {
        put_in_place(directory.path(), &staged, &switch).map_err(|error| match error {
            Stopped::Foreign(name) => Error::Request(format!(
                "{} was not written by this program; move it away and continue with --resume",
                directory.path().join(name).display()
            )),
            Stopped::Missing(name) => refuse(format!("its {name} is missing; start again with --force")),
            Stopped::Failed(error) => error,
        })?;
    } else if !is_regular(&directory.path().join(MARK)) {
        return Err(refuse(format!("its {MARK} is missing; start again with --force")));
    }
    super::remove(&folder)?;
    Ok(true)
}

/// Why a result could not be put in place.
enum Stopped {
    /// Something that this program did not write has the name.
    Foreign(String),
    /// The file is nowhere.
    Missing(String),
    Failed(Error),
}

impl From<Error> for Stopped {
    fn from(error: Error) -> Self {
        Self::Failed(error)
    }
}

fn put_in_place(out: &Path, staged: &Path, switch: &Switch) -> std::result::Result<(), Stopped> {
    let is_own = |name: &str| switch.replaced.iter().any(|it| it == name);
    let Some((mark, others)) = switch.files.split_last() else { return Ok(()) };
    if is_there(&out.join(mark)) && !is_own(mark) {
        return Err(Stopped::Foreign(mark.clone()));
    }
    // From here until the new mark is in place, this is not a finished result.
    remove_if_there(&out.join(mark))?;
    for name in others {
        let (from, to) = (staged.join(name), out.join(name));
        if is_regular(&from) {
            if is_there(&to) && !(is_own(name) && is_regular(&to)) {
                return Err(Stopped::Foreign(name.clone()));
            }
            fs::rename(&from, &to).map_err(Error::io(&to))?;
        } else if !is_regular(&to) {
            // It is neither waiting, nor was it put in place before the interruption.
            return Err(Stopped::Missing(name.clone()));
        }
    }
    for name in switch.replaced.iter().filter(|name| !switch.files.contains(name)) {
        if is_regular(&out.join(name)) {
            remove_if_there(&out.join(name))?;
        }
    }
    fs::rename(staged.join(mark), out.join(mark)).map_err(Error::io(&out.join(mark)))?;
    Ok(())
}
