//! What a killed run leaves behind: a manifest of finished ranges and the certified state that belongs to them.
//!
//! A save writes the state under a new name and then replaces the manifest, which names the state and its checksum, in one
//! step: at any moment the manifest on disk and the state it names belong together.

use crate::error::{Error, Result};
use crate::reduce::State;
use crate::study::{Study, differences};
use crate::tiles::{Ranges, Shard};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Version of the checkpoint's layout; another one is refused.
const VERSION: u32 = 1;
const MANIFEST: &str = "manifest.json";
const LOCK: &str = "lock";
/// How often, and after which pauses, a lock is tried again before the folder counts as in use.
const LOCK_ATTEMPTS: u32 = 20;
const LOCK_PAUSE: Duration = Duration::from_millis(10);

/// What was finished before.
#[derive(Debug)]
pub struct Progress {
    /// Positions that were judged.
    pub done: Ranges,
    /// What remains of them.
    pub state: State,
}

/// The manifest's file: a manifest that was tampered with would be believed as far as its JSON parses, so it is sealed.
#[derive(Serialize, Deserialize)]
struct Sealed {
    version: u32,
    /// CRC-32 of the manifest as compact JSON.
    checksum: u32,
    manifest: Value,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Manifest {
    program: String,
    study_hash: String,
    study: Study,
    description: Value,
    study_text: String,
    designs: u64,
    shard: Shard,
    /// Finished positions, of `0..designs` in the sweep's order.
    done: Ranges,
    /// File with the state of the finished positions, and its CRC-32; none before the first save.
    state: Option<(String, u32)>,
    saves: u64,
}

/// A checkpoint folder that this process writes.
#[derive(Debug)]
pub struct Checkpoint {
    folder: PathBuf,
    manifest: Manifest,
    progress: Option<Progress>,
    /// Held while the folder is in use, so that no second run writes to it.
    _lock: File,
}

impl Checkpoint {
    /// Starts a checkpoint in `folder`; what an earlier run left there is dropped.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Checkpoint`] if another process is using the folder.
    pub fn create(folder: &Path, study: &Study, text: &str, shard: Shard, designs: u64) -> Result<Self> {
        fs::create_dir_all(folder).map_err(Error::io(folder))?;
        let lock = lock(folder)?;
        remove_contents(folder)?;
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
        };
        let checkpoint = Self { folder: folder.to_owned(), manifest, progress: None, _lock: lock };
        checkpoint.write_manifest()?;
        Ok(checkpoint)
    }

    /// Takes up the checkpoint in `folder`, of whatever study it is.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if there is none, it is damaged, of another version, or in use.
    pub fn open(folder: &Path) -> Result<Self> {
        let refuse = |problem: String| Error::Checkpoint { path: folder.to_owned(), problem };
        let path = folder.join(MANIFEST);
        if !path.exists() {
            return Err(refuse("there is no checkpoint here".to_owned()));
        }
        // Locked before it is read: another run may be replacing it.
        let lock = lock(folder)?;
        let text = fs::read_to_string(&path).map_err(Error::io(&path))?;
        let damaged = |why: String| refuse(format!("the manifest is damaged ({why}); start again with --force"));
        let value: Value = serde_json::from_str(&text).map_err(|error| damaged(error.to_string()))?;
        if value["version"].as_u64().is_some_and(|version| version != u64::from(VERSION)) {
            return Err(refuse("the checkpoint was written by another version of beltspace; start again with --force".to_owned()));
        }
        let sealed: Sealed = serde_json::from_value(value).map_err(|error| damaged(error.to_string()))?;
        if crc32fast::hash(sealed.manifest.to_string().as_bytes()) != sealed.checksum {
            return Err(damaged("it does not match its checksum".to_owned()));
        }
        let manifest: Manifest = serde_json::from_value(sealed.manifest).map_err(|error| damaged(error.to_string()))?;
        let progress = match &manifest.state {
            None => None,
            Some((name, checksum)) => {
                let damaged = || refuse(format!("{name} does not match its checksum; start again with --force"));
                let bytes = fs::read(folder.join(name)).map_err(Error::io(&folder.join(name)))?;
                if crc32fast::hash(&bytes) != *checksum {
                    return Err(damaged());
                }
                let state = postcard::from_bytes(&bytes).map_err(|_| damaged())?;
                Some(Progress { done: manifest.done.clone(), state })
            }
        };
        Ok(Self { folder: folder.to_owned(), manifest, progress, _lock: lock })
    }

    /// Is there a checkpoint in `folder`?
    pub fn exists(folder: &Path) -> bool {
        folder.join(MANIFEST).exists()
    }

    /// Refuses a checkpoint of another study or shard, saying what changed.
    ///
    /// # Errors
    /// [`Error::Checkpoint`].
    pub fn require(&self, study: &Study, shard: Shard) -> Result<()> {
        let refuse = |problem: String| Err(Error::Checkpoint { path: self.folder.clone(), problem });
        if self.manifest.study_hash != study.hash() {
            let changed = differences(&self.manifest.description, &study.describe()).join("; ");
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

    /// What was finished before, once.
    pub fn take_progress(&mut self) -> Option<Progress> {
        self.progress.take()
    }

    /// The study that it is of.
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

    /// What its study asks for.
    pub fn description(&self) -> &Value {
        &self.manifest.description
    }

    /// The shard that it is of.
    pub fn shard(&self) -> Shard {
        self.manifest.shard
    }

    /// Number of designs of the whole study.
    pub fn designs(&self) -> u64 {
        self.manifest.designs
    }

    /// Keeps the state of the finished ranges.
    ///
    /// # Errors
    /// [`Error::Io`]; what was kept before is then still whole.
    pub fn save(&mut self, done: &Ranges, state: &State) -> Result<()> {
        let bytes = postcard::to_stdvec(state).expect("plain numbers and vectors can be written");
        let old = self.manifest.state.take();
        self.manifest.saves += 1;
        let name = format!("state-{}.bin", self.manifest.saves);
        let path = self.folder.join(&name);
        write_through(&path, &bytes)?;
        self.manifest.done = done.clone();
        self.manifest.state = Some((name, crc32fast::hash(&bytes)));
        self.write_manifest()?;
        if let Some((old, _)) = old {
            let old = self.folder.join(old);
            fs::remove_file(&old).map_err(Error::io(&old))?;
        }
        Ok(())
    }

    fn write_manifest(&self) -> Result<()> {
        let manifest = serde_json::to_value(&self.manifest).expect("a manifest has string keys and finite numbers");
        let sealed = Sealed { version: VERSION, checksum: crc32fast::hash(manifest.to_string().as_bytes()), manifest };
        let text = serde_json::to_string_pretty(&sealed).expect("a value can be written");
        replace(&self.folder.join(MANIFEST), text.as_bytes())
    }

    /// Removes the folder: the run is complete and its result written.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn remove(self) -> Result<()> {
        // The manifest first: without it there is no checkpoint, however much of the rest a kill leaves.
        let manifest = self.folder.join(MANIFEST);
        fs::remove_file(&manifest).map_err(Error::io(&manifest))?;
        fs::remove_dir_all(&self.folder).map_err(Error::io(&self.folder))
    }
}

fn lock(folder: &Path) -> Result<File> {
    let path = folder.join(LOCK);
    let file = File::create(&path).map_err(Error::io(&path))?;
    // A program that this process is just starting shares its files, and so a lock that was let go, until it runs.
    let mut attempts = 0..LOCK_ATTEMPTS;
    let locked = loop {
        match file.try_lock() {
            Err(fs::TryLockError::WouldBlock) if attempts.next().is_some() => std::thread::sleep(LOCK_PAUSE),
            locked => break locked,
        }
    };
    match locked {
        Ok(()) => Ok(file),
        Err(fs::TryLockError::WouldBlock) => Err(Error::Checkpoint {
            path: folder.to_owned(),
            problem: "another beltspace is running here; wait for it or use another --out".to_owned(),
        }),
        Err(fs::TryLockError::Error(source)) => Err(Error::Io { path, source }),
    }
}

fn remove_contents(folder: &Path) -> Result<()> {
    for entry in fs::read_dir(folder).map_err(Error::io(folder))? {
        let entry = entry.map_err(Error::io(folder))?;
        if entry.file_name() != LOCK {
            let path = entry.path();
            let removed = if path.is_dir() { fs::remove_dir_all(&path) } else { fs::remove_file(&path) };
            removed.map_err(Error::io(&path))?;
        }
    }
    Ok(())
}

fn write_through(path: &Path, bytes: &[u8]) -> Result<()> {
    let write = || -> std::io::Result<()> {
        let mut file = File::create(path)?;
        file.write_all(bytes)?;
        file.sync_all()
    };
    write().map_err(Error::io(path))
}

/// Writes a file so that it is either the old one or the new one, whole, whatever happens meanwhile.
///
/// # Errors
/// [`Error::Io`]; the old file is then untouched.
pub fn replace(path: &Path, bytes: &[u8]) -> Result<()> {
    let mut temporary = path.as_os_str().to_owned();
    temporary.push(".writing");
    let temporary = PathBuf::from(temporary);
    let done = write_through(&temporary, bytes).and_then(|()| fs::rename(&temporary, path).map_err(Error::io(path)));
    if done.is_err() {
        // On a full disk it holds the last room; that it is gone matters less than why.
        let _ = fs::remove_file(&temporary);
    }
    done
}
