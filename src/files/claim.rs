//! A directory that one process writes at a time. The lock lies beside it, so that it outlives what it protects:
//! `.NAME.beltspace-lock` for the directory `NAME`.

use super::{Lock, Made, Taken, parent};
use crate::error::{Error, Result};
use std::ffi::{OsStr, OsString};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// How often a directory around the claimed one that vanished is made again.
const ATTEMPTS: u32 = 20;

/// A directory that this process alone writes, as long as this or a copy of it lives.
#[derive(Clone, Debug)]
pub struct Claim {
    held: Arc<Held>,
}

/// What is held, and given back in this order: the directory if it is still empty, the lock, the directories around it.
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
    /// Takes a directory, which is made if it is not there. `task` is what others are told who ask for it meanwhile.
    ///
    /// # Errors
    /// [`Error::Busy`] if another process has it; [`Error::Request`] if it cannot be had.
    pub fn new(path: &Path, task: &str) -> Result<Self> {
        let mut around = Made::default();
        let mut attempts = 0..ATTEMPTS;
        let taken = loop {
            let lock = match place(path, &mut around) {
                // Another process has just taken back what it had made.
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

    /// Where it is, as it was named.
    pub fn path(&self) -> &Path {
        &self.held.path
    }

    /// The error of a directory that was there when it was taken and is not there any more.
    pub(crate) fn lost(&self, source: io::Error) -> Error {
        let problem = if source.kind() == io::ErrorKind::NotFound {
            "it was removed or moved away while this program was writing to it; start again".to_owned()
        } else {
            format!("it cannot be written to: {source}")
        };
        Error::Checkpoint { path: self.path().to_owned(), problem }
    }
}

/// A directory that is read and must not change meanwhile. Others may read it too.
#[derive(Debug)]
pub struct Reading {
    _lock: Option<Lock>,
}

impl Reading {
    /// Keeps others from writing to a directory while it is read. Where no lock can be made because all around it is read-only, it can do
    /// without one.
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

    /// The same without writing anything, a lock included.
    ///
    /// # Errors
    /// As [`Reading::new`].
    pub fn without_trace(path: &Path) -> Result<Self> {
        Self::with(path, Lock::shared_if_there)
    }

    fn with(path: &Path, take: impl Fn(&Path) -> io::Result<Option<Taken>>) -> Result<Self> {
        // Whoever reads a directory that does not exist is told so by who reads it.
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

/// The lock of a directory, whatever links lead to it; what is around it is made.
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
        let name = path.file_name().ok_or_else(|| request("is no name of a directory"))?;
        let folder = parent(path);
        around.make(folder).map_err(Error::io(folder))?;
        if !folder.is_dir() {
            return Err(Error::io(folder)(io::ErrorKind::NotADirectory.into()));
        }
        folder.canonicalize().map_err(Error::io(folder))?.join(name)
    };
    let name = real.file_name().ok_or_else(|| request("has no directory around it, where its lock would be"))?;
    Ok(lock_path(parent(&real), name))
}

/// The lock of a directory of that name.
fn lock_path(folder: &Path, name: &OsStr) -> PathBuf {
    let mut lock = OsString::from(".");
    lock.push(name);
    lock.push(".beltspace-lock");
    folder.join(lock)
}

/// A directory that cannot be made is a wrong request.
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
        "name a directory in one that you may write to"
    };
    Error::Request(format!("{} cannot be used: its lock {} cannot be taken ({error}); {remedy}", path.display(), lock.display()))
}
