//! What stands in place of a device where the crate is built without the feature `gpu`: types without a value, so that whoever may be
//! handed a device needs no second form.

use super::{SweepJob, Swept};
use crate::checkpoint::{Checkpoint, Progress};
use crate::error::Result;

/// A device that a study is to be swept on: there is none.
#[derive(Clone, Copy, Debug)]
pub enum OnDevice {}

/// What a device did in a sweep: none did anything.
#[derive(Clone, Copy, Debug)]
pub enum DeviceRecord {}

impl DeviceRecord {
    /// As it would stand in `run.json`.
    pub fn to_json(&self) -> serde_json::Value {
        match *self {}
    }
}

/// Sweeps what is left on a device.
pub(super) fn go_on(_: SweepJob<'_>, _: Option<Progress>, _: Option<&mut Checkpoint>, on: &OnDevice) -> Result<(Swept, DeviceRecord)> {
    match *on {}
}
