//! The result directory: one owner at a time, who finds it free before anything is done and holds it to the end, and who touches
//! nothing in it that this program did not write.
//!
//! A directory is this program's by the mark of a finished result or by a checkpoint with a sealed manifest.

mod contents;
#[cfg(test)]
mod tests;

pub use contents::Contents;

use crate::checkpoint::{Found, finish_switch, found, remove_remains};
use crate::error::{Error, Result};
use crate::files::{Claim, is_regular, remove_if_there, was_to_become};
use crate::names::{CHECKPOINT, is_remains};
use std::path::Path;

/// A result directory that was taken.
#[derive(Debug)]
pub struct Taken {
    /// It is this process's alone as long as this lives.
    pub claim: Claim,
    /// A run was killed while it put its result in place here; that has been done now.
    pub completed: bool,
}

/// Takes a result directory for this process alone; it is made if it is not there. What a run that was killed had begun to put in place
/// is put in place, and what it was writing is removed. `task` is what others are told who ask for the directory meanwhile.
///
/// # Errors
/// [`Error::Busy`] if another process has it; [`Error::Request`] if it cannot be had.
pub fn claim(path: &Path, task: &str) -> Result<Taken> {
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
            // Of another version, or damaged: whoever wants to use it says so.
            Err(Error::Checkpoint { .. }) => false,
            completed => completed?,
        },
        Found::Nothing | Found::Foreign(_) => false,
    };
    Ok(Taken { claim, completed })
}
