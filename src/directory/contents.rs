//! The contents of a directory that a result is to be written to, and which of its files this program wrote.

use crate::checkpoint::{Found, foreign, found};
use crate::error::{Error, Occupant, Result};
use crate::files::{MOVE, is_regular, is_there, read_at_most, refuse_foreign};
use crate::influence::is_influence_file;
use crate::names::{CHECKPOINT, MARK, PAGE, RUN, is_page};
use crate::result_files::is_ours;
use crate::study::Study;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Most bytes of `summary.json` or `run.json`.
const MOST_BYTES: u64 = 1 << 26;

/// The contents of a directory at one moment.
#[derive(Debug)]
pub struct Contents {
    path: PathBuf,
    /// Hash of the study of a finished result.
    finished: Option<String>,
    checkpoint: Found,
}

impl Contents {
    /// Reads the contents of a directory; one that does not exist is empty.
    ///
    /// # Errors
    /// [`Error::Occupied`] if it is a file.
    pub fn of(path: &Path) -> Result<Self> {
        if path.exists() && !path.is_dir() {
            return Err(Error::Occupied { path: path.to_owned(), by: Occupant::File });
        }
        Ok(Self { path: path.to_owned(), finished: finished(path), checkpoint: found(&path.join(CHECKPOINT)) })
    }

    /// Is there a finished result?
    pub fn is_finished(&self) -> bool {
        self.finished.is_some()
    }

    /// Is there a finished result of this study?
    pub fn is_result_of(&self, study: &Study) -> bool {
        self.finished.as_ref().is_some_and(|hash| *hash == study.hash())
    }

    /// Is there a checkpoint of an unfinished run?
    pub fn is_unfinished(&self) -> bool {
        matches!(self.checkpoint, Found::Checkpoint)
    }

    /// Refuses to replace anything that this program did not write, or a result or checkpoint without `--force`. `files` are those of the
    /// new result. A run that continues may replace a finished result beside its checkpoint.
    ///
    /// # Errors
    /// [`Error::Occupied`] with what is in the way.
    pub fn refuse_to_overwrite(&self, files: &[String], force: bool, resume: bool) -> Result<()> {
        if let Found::Foreign(why) = &self.checkpoint {
            return Err(foreign(&self.path.join(CHECKPOINT), why));
        }
        let goes_on = resume && self.is_unfinished();
        if self.is_finished() && !force && !goes_on {
            return Err(Error::Occupied { path: self.path.clone(), by: Occupant::Finished });
        }
        if self.is_unfinished() && !force && !resume {
            return Err(Error::Occupied { path: self.path.clone(), by: Occupant::Unfinished });
        }
        self.refuse_foreign(files)
    }

    /// Refuses to replace files that this program did not write.
    ///
    /// # Errors
    /// [`Error::Occupied`] with their names.
    pub fn refuse_foreign(&self, files: &[String]) -> Result<()> {
        let own = self.own_files()?;
        let foreign = |name: &&String| {
            let path = self.path.join(name);
            match name.as_str() {
                PAGE => refuse_foreign(&path, MOVE, is_page).is_err(),
                _ => is_there(&path) && !(own.contains(name) && is_regular(&path)),
            }
        };
        let names: Vec<String> = files.iter().filter(foreign).cloned().collect();
        if names.is_empty() {
            return Ok(());
        }
        Err(Error::Occupied { path: self.path.clone(), by: Occupant::Foreign(names) })
    }

    /// The files of the finished result that is there.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn own_files(&self) -> Result<Vec<String>> {
        if !self.is_finished() {
            return Ok(Vec::new());
        }
        let written = files_written(&self.path);
        let mut names = Vec::new();
        for entry in self.path.read_dir().map_err(Error::io(&self.path))? {
            let entry = entry.map_err(Error::io(&self.path))?;
            let name = entry.file_name().to_string_lossy().into_owned();
            // Older results do not list their files: then every file counts that has the name of a result's file. They have none of the
            // sensitivity, and the command `sensitivity` writes such files too.
            let listed = match &written {
                None => !is_influence_file(&name),
                Some(written) => written.contains(&name) || name == RUN || name == MARK,
            };
            let own = match name.as_str() {
                PAGE => refuse_foreign(&entry.path(), MOVE, is_page).is_ok(),
                _ => is_ours(&name) && listed,
            };
            if own && is_regular(&entry.path()) {
                names.push(name);
            }
        }
        names.sort();
        Ok(names)
    }
}

/// The hash of the study of a finished result; `None` if there is no mark of one, or the file was written by another program.
fn finished(path: &Path) -> Option<String> {
    let summary: Value = serde_json::from_slice(&read_at_most(&path.join(MARK), MOST_BYTES).ok()?).ok()?;
    let hash = summary["study_hash"].as_str().filter(|it| it.len() == 64 && it.bytes().all(|it| it.is_ascii_hexdigit()))?;
    let complete = ["version", "model", "title"].iter().all(|key| summary[key].is_string()) && summary["designs"].is_u64();
    complete.then(|| hash.to_owned())
}

/// The names of a result's files, as its `run.json` lists them.
fn files_written(path: &Path) -> Option<Vec<String>> {
    let run: Value = serde_json::from_slice(&read_at_most(&path.join(RUN), MOST_BYTES).ok()?).ok()?;
    let names = run["files"].as_array()?.iter().map(|it| it.as_str().map(str::to_owned));
    names.collect()
}
