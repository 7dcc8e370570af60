//! The result directory. One process at a time uses it: it claims the directory before anything is done, holds it to the end, and changes
//! no file that this program did not write.
//!
//! A directory is recognised as this program's by the mark of a finished result or by a checkpoint whose manifest has a valid checksum.

mod contents;
#[cfg(test)]
mod tests;

pub use contents::Contents;

use crate::checkpoint::{Found, finish_switch, found, remove_remains};
use crate::error::{Error, Result};
use crate::files::{Claim, is_regular, remove_if_there, was_to_become};
use crate::names::CHECKPOINT;
use crate::result_files::is_remains;
use std::path::Path;

/// A result directory that this process has claimed.
#[derive(Debug)]
pub struct ClaimedDirectory {
    /// Keeps other processes out as long as it lives.
    pub claim: Claim,
    /// A run had been killed while it put its result in place here; that has been completed now.
    pub completed: bool,
}

/// Claims a result directory for this process alone, and makes it if it is not there. If a run was killed while it put its result in
/// place, that is completed, and the files that it was writing are removed. `task` is what others are told who want the directory
/// meanwhile.
///
/// # Errors
/// [`Error::Busy`] if another process uses it; [`Error::Request`] if it cannot be used.
pub fn claim(path: &Path, task: &str) -> Result<ClaimedDirectory> {
    let claim = Claim::new(path, task)?;
    for entry in path.read_dir().map_err(Error::io(path))? {
        let entry = entry.map_err(Error::io(path))?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if !is_remains(&name) {
            continue;
        }
        let remains = entry.path();
        if is_regular(&remains) {
            remove_if_there(&remains)?;
        } else if was_to_become(&name) == Some(CHECKPOINT) && remains.is_dir() && !remains.is_symlink() {
            remove_remains(&remains)?;
        }
    }
    let completed = match found(&path.join(CHECKPOINT)) {
        Found::Checkpoint => match finish_switch(&claim) {
            // It is of another version or damaged. Whoever wants to use it reports that.
            Err(Error::Checkpoint { .. }) => false,
            completed => completed?,
        },
        Found::Nothing | Found::Foreign(_) => false,
    };
    Ok(ClaimedDirectory { claim, completed })
}
