//! The manifest of a checkpoint, with a checksum: only a folder that has one is taken for a checkpoint of this program.

use super::Switch;
use crate::error::{Error, Result, brief};
use crate::files::{is_regular, is_there, read_at_most, replace};
use crate::models::Models;
use crate::space::Space;
use crate::study::Study;
use crate::tiles::{Ranges, Shard};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::Path;

/// Version of the checkpoint's layout; another one is refused.
const VERSION: u32 = 4;
/// Its file.
pub(super) const MANIFEST: &str = "manifest.json";
/// Most bytes of a manifest: it holds the study's text with all rows of its tables.
const MOST_BYTES: u64 = 1 << 30;

/// More saves than any run makes; a larger number in a manifest is refused, because saves are numbered on from it.
const MOST_SAVES: u64 = 1 << 53;

/// The contents of the manifest's file. Without the checksum a manifest that was changed would be believed as long as its JSON is valid.
#[derive(Serialize, Deserialize)]
struct Sealed {
    version: u32,
    /// CRC-32 of the manifest as compact JSON.
    checksum: u32,
    manifest: Value,
}

/// What a checkpoint says of itself. `S`: its study, or nothing as long as the description has not been read.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Manifest<S = Study> {
    pub(super) program: String,
    pub(super) study_hash: String,
    #[serde(skip)]
    pub(super) study: S,
    pub(super) description: Value,
    pub(super) study_text: String,
    pub(super) designs: u64,
    pub(super) shard: Shard,
    /// Finished positions, of `0..designs` in the sweep's order.
    pub(super) done: Ranges,
    /// Name of the file with the state of the finished positions, and its CRC-32; `None` before the first save.
    pub(super) state: Option<(String, u32)>,
    pub(super) saves: u64,
    /// The finished result that is being put in place, once all of it is written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) switch: Option<Switch>,
}

/// What is found at the path of a checkpoint.
#[derive(Debug)]
pub enum Found {
    /// Nothing.
    Nothing,
    /// A checkpoint of this program, of this version or another.
    Checkpoint,
    /// Something else, and why it is not a checkpoint.
    Foreign(String),
}

/// Finds out what is at the path of a checkpoint.
pub fn found(folder: &Path) -> Found {
    let foreign = |why: String| Found::Foreign(why);
    if !is_there(folder) {
        return Found::Nothing;
    }
    if folder.is_symlink() || !folder.is_dir() {
        return foreign("it is a link or a file".to_owned());
    }
    if !is_there(&folder.join(MANIFEST)) {
        return foreign(format!("it has no {MANIFEST}"));
    }
    match unseal(folder) {
        Ok(_) => Found::Checkpoint,
        Err(why) => foreign(format!("its {MANIFEST} was not written by this program: {}", brief(&why))),
    }
}

/// The version and the contents of a sealed manifest.
fn unseal(folder: &Path) -> std::result::Result<(u32, Value), String> {
    let bytes = read_at_most(&folder.join(MANIFEST), MOST_BYTES)?;
    let sealed: Sealed = serde_json::from_slice(&bytes).map_err(|error| error.to_string())?;
    if crc32fast::hash(sealed.manifest.to_string().as_bytes()) != sealed.checksum {
        return Err("it does not match its checksum".to_owned());
    }
    Ok((sealed.version, sealed.manifest))
}

fn damaged(folder: &Path, why: &str) -> Error {
    refusal(folder, format!("the manifest is damaged ({}); remove the folder and start again", brief(why)))
}

fn refusal(folder: &Path, problem: String) -> Error {
    Error::Checkpoint { path: folder.to_owned(), problem }
}

impl Manifest<()> {
    /// Reads the manifest of a checkpoint folder as far as nobody needs the model for.
    fn read_stored(folder: &Path) -> Result<Self> {
        if !is_regular(&folder.join(MANIFEST)) {
            return Err(refusal(folder, "there is no checkpoint here".to_owned()));
        }
        let (version, manifest) = unseal(folder).map_err(|why| damaged(folder, &why))?;
        if version != VERSION {
            let problem = "the checkpoint was written by another version of beltspace; start again with --force";
            return Err(refusal(folder, problem.to_owned()));
        }
        serde_json::from_value(manifest).map_err(|error| damaged(folder, &error.to_string()))
    }

    /// The same with its study, whose model is one of these; checks that the two agree.
    fn with_its_study(self, models: &Models) -> std::result::Result<Manifest, String> {
        let Self { program, study_hash, study: (), description, study_text, designs, shard, done, state, saves, switch } = self;
        let study = Study::from_description_with(models, &description)?;
        let manifest = Manifest { program, study_hash, study, description, study_text, designs, shard, done, state, saves, switch };
        manifest.check().map(|()| manifest)
    }
}

impl Manifest {
    /// Reads the manifest of a checkpoint folder, of a study of one of these models.
    pub(super) fn read(folder: &Path, models: &Models) -> Result<Self> {
        Manifest::<()>::read_stored(folder)?.with_its_study(models).map_err(|why| damaged(folder, &why))
    }

    /// The finished result that waits in a checkpoint folder. It can be put in place without knowing the model.
    pub(super) fn switch(folder: &Path) -> Result<Option<Switch>> {
        let stored = Manifest::<()>::read_stored(folder)?;
        let models = Models::new();
        match stored.description["model"].as_str().and_then(|name| models.find(name)) {
            Some(_) => stored.with_its_study(&models).map(|it| it.switch).map_err(|why| damaged(folder, &why)),
            None => Ok(stored.switch),
        }
    }

    /// Checks that the manifest agrees with its study, and that the finished ranges lie within the shard and do not overlap.
    fn check(&self) -> std::result::Result<(), String> {
        let study = &self.study;
        if self.study_hash != study.hash() {
            return Err("it has the hash of another study".to_owned());
        }
        let designs = Space::new(study).designs.count();
        if self.designs != designs {
            return Err(format!("its study has {designs} designs, not {}", self.designs));
        }
        if self.saves > MOST_SAVES {
            return Err(format!("it counts {} saves, more than any run makes", self.saves));
        }
        let Shard { number, of } = self.shard;
        if number == 0 || number > of {
            return Err(format!("there is no shard {number}/{of}"));
        }
        let whole = self.shard.range(self.designs);
        let mut next = whole.start;
        for range in &self.done.0 {
            if range.start < next || range.start >= range.end || range.end > whole.end {
                return Err(format!(
                    "the range {} to {} overlaps another one or is not within {} to {}",
                    range.start, range.end, whole.start, whole.end
                ));
            }
            next = range.end;
        }
        Ok(())
    }

    /// Writes it in one step.
    pub(super) fn write(&self, folder: &Path) -> Result<()> {
        let manifest = serde_json::to_value(self).expect("a manifest has string keys and finite numbers");
        let sealed = Sealed { version: VERSION, checksum: crc32fast::hash(manifest.to_string().as_bytes()), manifest };
        let text = serde_json::to_string_pretty(&sealed).expect("a value can be written");
        replace(&folder.join(MANIFEST), text.as_bytes())
    }
}
