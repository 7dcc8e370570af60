//! A directory that only one process writes to at a time. Its lock lies beside it, so that it remains if the directory is removed:
//! `.NAME.beltspace-lock` for the directory `NAME`.

use super::{Lock, Made, Taken, parent};
use crate::error::{Error, Result};
use std::ffi::{OsStr, OsString};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// How often a parent directory is made again if it vanishes.
const ATTEMPTS: u32 = 20;

/// A directory that only this process writes to, as long as this or a copy of it lives.
#[derive(Clone, Debug)]
pub struct Claim {
    held: Arc<Held>,
}

/// What is held. It is given up in this order: the directory if it is still empty, the lock, the parent directories.
#[derive(Debug)]
struct Held {
    path: PathBuf,
    own: Made,
    lock: Option<Lock>,
    around: Made,
}

impl Drop for Held {
    fn drop(&mut self) {
        self.own.take_back();
        self.lock = None;
        self.around.take_back();
    }
}

impl Claim {
    /// Claims a directory, and makes it if it is not there. `task` is what others are told who want it meanwhile.
    ///
    /// # Errors
    /// [`Error::Busy`] if another process uses it; [`Error::Request`] if it cannot be used.
    pub fn new(path: &Path, task: &str) -> Result<Self> {
        let mut around = Made::default();
        let mut attempts = 0..ATTEMPTS;
        let taken = loop {
            let lock = match place(path, &mut around) {
                // Another process has just removed the directories that it had made.
                Err(Error::Io { source, .. }) if source.kind() == io::ErrorKind::NotFound && attempts.next().is_some() => continue,
                place => place.map_err(|error| unusable(path, error))?,
            };
            match Lock::alone(&lock, task) {
                Err(error) if error.kind() == io::ErrorKind::NotFound && attempts.next().is_some() => {}
                taken => break taken.map_err(|error| unlockable(path, &lock, &error))?,
            }
        };
        let lock = match taken {
            Taken::Held(lock) => lock,
            Taken::Busy(holder) => {
                around.take_back();
                return Err(Error::Busy { path: path.to_owned(), holder });
            }
        };
        let mut held = Held { path: path.to_owned(), own: Made::default(), lock: Some(lock), around };
        held.own.make(path).map_err(|source| unusable(path, Error::Io { path: path.to_owned(), source }))?;
        Ok(Self { held: Arc::new(held) })
    }

    /// Its path, as it was given.
    pub fn path(&self) -> &Path {
        &self.held.path
    }

    /// The error for a directory that has vanished since it was claimed.
    pub(crate) fn lost(&self, source: io::Error) -> Error {
        let problem = if source.kind() == io::ErrorKind::NotFound {
            "it was removed or moved while this program was writing to it; start again".to_owned()
        } else {
            format!("it cannot be written to: {source}")
        };
        Error::Checkpoint { path: self.path().to_owned(), problem }
    }
}

/// A directory that is being read and must not change meanwhile. Others may read it too.
#[derive(Debug)]
pub struct Reading {
    _lock: Option<Lock>,
}

impl Reading {
    /// Keeps others from writing to a directory while it is read. If no lock can be made because the parent directory is read-only, it goes
    /// on without one.
    ///
    /// # Errors
    /// [`Error::Busy`] if another process is writing to it.
    pub fn new(path: &Path, task: &str) -> Result<Self> {
        Self::with(path, |lock| match Lock::shared(lock, task) {
            Err(error) if [io::ErrorKind::PermissionDenied, io::ErrorKind::ReadOnlyFilesystem].contains(&error.kind()) => {
                Lock::shared_if_there(lock)
            }
            taken => taken.map(Some),
        })
    }

    /// The same without writing anything, not even a lock.
    ///
    /// # Errors
    /// As [`Reading::new`].
    pub fn without_trace(path: &Path) -> Result<Self> {
        Self::with(path, Lock::shared_if_there)
    }

    fn with(path: &Path, take: impl Fn(&Path) -> io::Result<Option<Taken>>) -> Result<Self> {
        // If the directory does not exist, reading it will say so.
        let Ok(real) = path.canonicalize() else { return Ok(Self { _lock: None }) };
        let Some(name) = real.file_name() else { return Ok(Self { _lock: None }) };
        let lock = lock_path(parent(&real), name);
        match take(&lock).map_err(|error| unlockable(path, &lock, &error))? {
            Some(Taken::Busy(holder)) => Err(Error::Busy { path: path.to_owned(), holder }),
            Some(Taken::Held(lock)) => Ok(Self { _lock: Some(lock) }),
            None => Ok(Self { _lock: None }),
        }
    }
}

/// The path of the lock of a directory, whatever links lead to it; its parent directories are made.
fn place(path: &Path, around: &mut Made) -> Result<PathBuf> {
    let request = |problem: &str| Error::Request(format!("{} {problem}; name a directory with --out", path.display()));
    let real = if path.exists() {
        if !path.is_dir() {
            return Err(request("is a file"));
        }
        path.canonicalize().map_err(Error::io(path))?
    } else {
        if path.is_symlink() {
            return Err(request("is a link to nothing"));
        }
        let name = path.file_name().ok_or_else(|| request("is not the name of a directory"))?;
        let folder = parent(path);
        around.make(folder).map_err(Error::io(folder))?;
        if !folder.is_dir() {
            return Err(Error::io(folder)(io::ErrorKind::NotADirectory.into()));
        }
        folder.canonicalize().map_err(Error::io(folder))?.join(name)
    };
    let name = real.file_name().ok_or_else(|| request("has no parent directory for its lock"))?;
    Ok(lock_path(parent(&real), name))
}

/// Name of the lock of a directory of this name.
fn lock_path(folder: &Path, name: &OsStr) -> PathBuf {
    let mut lock = OsString::from(".");
    lock.push(name);
    lock.push(".beltspace-lock");
    folder.join(lock)
}

/// The error for a directory that cannot be made.
fn unusable(path: &Path, error: Error) -> Error {
    match error {
        Error::Io { source, .. } => {
            Error::Request(format!("the directory {} cannot be made: {source}; name another with --out", path.display()))
        }
        other => other,
    }
}

fn unlockable(path: &Path, lock: &Path, error: &io::Error) -> Error {
    let remedy = if error.kind() == io::ErrorKind::InvalidFilename {
        "choose a shorter name"
    } else {
        "name a directory in a place where you may write"
    };
    Error::Request(format!("{} cannot be used: its lock {} cannot be taken ({error}); {remedy}", path.display(), lock.display()))
}
