//! The choice of a device where the crate is built without the feature `gpu`: always the CPU. Asking for a GPU is an error.

use super::Engine;
use crate::checkpoint::Checkpoint;
use crate::error::{Error, Result};
use crate::plan::Plan;
use crate::reduce::Reduction;
use crate::screen::Tables;
use crate::sweep::costs::Speed;
use crate::sweep::{Control, DeviceRecord, OnDevice, Settings, Swept};
use serde_json::Value;

/// The error for a request that needs a device.
///
/// # Errors
/// Always.
pub fn without_gpu<T>() -> Result<T> {
    Err(Error::Request("beltspace is built here without its GPU engine: use --engine cpu, or build it with the feature gpu".to_owned()))
}

/// A device that has passed its self-test: there is none.
#[derive(Debug)]
pub enum Trusted {}

impl Trusted {
    /// The device, for the sweep.
    pub fn on(&self) -> &OnDevice {
        match *self {}
    }

    /// The device, its driver and what it did, for `run.json`.
    pub fn describe(&self, _: &DeviceRecord) -> Value {
        match *self {}
    }
}

/// Deliberate errors in a device's kernel: none.
#[derive(Debug, Default)]
pub struct Wrong(());

/// No device.
///
/// # Errors
/// [`Error::Request`] if one is asked for.
pub fn choose(_: &Plan, engine: Engine, adapter: Option<&str>, _: Wrong, _: &mut dyn FnMut(&str)) -> Result<Option<Trusted>> {
    if engine == Engine::Gpu || adapter.is_some() { without_gpu() } else { Ok(None) }
}

/// The same, tried on the study.
///
/// # Errors
/// [`Error::Request`] if one is asked for.
pub fn choose_tried(
    plan: &Plan,
    engine: Engine,
    _: Engine,
    adapter: Option<&str>,
    wrong: Wrong,
    remark: &mut dyn FnMut(&str),
) -> Result<Option<Trusted>> {
    choose(plan, engine, adapter, wrong, remark)
}

/// Will `--engine auto` take a device?
pub fn is_expected(_: &Plan, _: Engine, _: Option<&str>) -> bool {
    false
}

/// An estimate of how fast a device judges designs, from how fast the CPU does.
pub fn about(cpu: Speed) -> Speed {
    cpu
}

/// Can a device count these histograms?
///
/// # Errors
/// Always.
pub fn supports_histograms(_: &Plan, _: &[(f64, f64)]) -> Result<()> {
    without_gpu()
}

/// Sweeps on a device.
///
/// # Errors
/// None: it cannot be called, for there is no device.
pub fn sweep_on_device(
    _: &Plan,
    _: &Tables,
    _: &Reduction,
    _: &Settings,
    _: Option<&mut Checkpoint>,
    _: &Control,
    on: &OnDevice,
) -> Result<(Swept, DeviceRecord)> {
    match *on {}
}
