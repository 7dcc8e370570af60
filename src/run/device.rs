//! The choice of a device, and what must be known of it before it is trusted.

use super::Engine;
use crate::error::{Error, Result};
use crate::gpu::{self, Adapter, self_test};
use crate::models::Model;
use crate::plan::Plan;
use crate::screen::gpu::{GpuEngine, supports};
pub use crate::screen::gpu::{Wrong, supports_histograms};
use crate::sweep::costs::Speed;
pub use crate::sweep::sweep_on_device;
use crate::sweep::{DeviceRecord, OnDevice};
use serde_json::Value;

/// Evaluations below which starting a device costs more than it saves.
const WORTH_A_DEVICE: f64 = 2e8;

/// So many times as fast as the processor a device is taken to be before anybody has tried: enough not to bound boxes for longer than it
/// would take.
const GAIN: f64 = 20.0;

/// A device that has passed its self-test.
#[derive(Debug)]
pub struct Trusted {
    /// What it is.
    pub adapter: Adapter,
    /// What the self-test found.
    pub report: self_test::SelfTest,
    /// As the sweep takes it.
    pub on: OnDevice,
}

impl Trusted {
    /// As the sweep takes it.
    pub fn on(&self) -> &OnDevice {
        &self.on
    }

    /// The device, its driver and what it did, for `run.json`.
    pub fn describe(&self, did: &DeviceRecord) -> Value {
        let mut record = did.to_json();
        let (adapter, self_test) = (&self.adapter, self.report.to_json());
        for (name, value) in [("adapter", &adapter.name), ("driver", &adapter.driver), ("backend", &adapter.backend)] {
            record[name] = value.clone().into();
        }
        record["self_test"] = self_test;
        record
    }
}

/// The device to sweep a study on; `None` for the processor.
///
/// `remark` is told why a device that nobody asked for is not taken.
///
/// # Errors
/// [`Error::Request`] if the request contradicts itself; [`Error::NoAdapter`]; [`Error::CpuOnly`] and [`Error::NotOnDevice`] if a device
/// cannot serve the study; [`Error::Gpu`] if its driver fails.
pub fn choose(plan: &Plan, engine: Engine, adapter: Option<&str>, wrong: Wrong, remark: &mut dyn FnMut(&str)) -> Result<Option<Trusted>> {
    if engine != Engine::Gpu && !wrong.perturb.is_empty() {
        return Err(Error::Request("--perturb makes a GPU's kernel wrong on purpose: it needs --engine gpu".to_owned()));
    }
    let insists = engine == Engine::Gpu || (engine == Engine::Auto && adapter.is_some());
    if insists {
        needs_a_twin(&plan.study.model, "use --engine cpu, or leave --engine and --adapter out")?;
    }
    match engine {
        Engine::Cpu if adapter.is_some() => Err(Error::Request("--adapter names a GPU, but --engine cpu was asked for".to_owned())),
        Engine::Cpu => Ok(None),
        Engine::Auto if adapter.is_none() => Ok(automatic(plan, wrong, remark)),
        Engine::Gpu | Engine::Auto => serving(plan, trusted(adapter, wrong)?).map(Some),
    }
}

/// The same, tried out on the study where nobody insists on it: what a driver refuses is a remark then. `asked` is what the user said.
///
/// # Errors
/// As [`choose`].
pub fn choose_tried(
    plan: &Plan,
    engine: Engine,
    asked: Engine,
    adapter: Option<&str>,
    wrong: Wrong,
    remark: &mut dyn FnMut(&str),
) -> Result<Option<Trusted>> {
    let device = choose(plan, engine, adapter, wrong, remark)?;
    if let (Engine::Auto, Some(chosen)) = (asked, &device)
        && let Err(error) = try_out(plan, chosen)
    {
        remark(&format!("{error}; the processor judges the designs"));
        return Ok(None);
    }
    Ok(device)
}

/// A wrong request of a model that is computed on the processor only, and what to do about it.
///
/// # Errors
/// [`Error::CpuOnly`] if the model is such.
pub fn needs_a_twin(model: &Model, remedy: &str) -> Result<()> {
    match model.on_device() {
        Ok(_) => Ok(()),
        Err(_) => Err(Error::CpuOnly { model: model.name.to_owned(), remedy: Some(remedy.to_owned()) }),
    }
}

/// Will `--engine auto` take a device, as far as that can be told without starting one?
pub fn is_expected(plan: &Plan, engine: Engine, adapter: Option<&str>) -> bool {
    engine == Engine::Auto && adapter.is_none() && is_worth_a_device(plan) && gpu::adapters().iter().any(Adapter::is_hardware)
}

/// About how fast a device judges designs, by how fast the processor does.
pub fn about(processor: Speed) -> Speed {
    Speed { seconds: processor.seconds / GAIN, measured: false }
}

#[allow(clippy::cast_precision_loss, reason = "an estimate")]
fn is_worth_a_device(plan: &Plan) -> bool {
    plan.study.model.shader.is_some() && (plan.designs() as f64) * (plan.scenarios() as f64) >= WORTH_A_DEVICE
}

/// A hardware adapter for a study that is large enough; whatever is wrong with it is a remark.
fn automatic(plan: &Plan, wrong: Wrong, remark: &mut dyn FnMut(&str)) -> Option<Trusted> {
    if !is_worth_a_device(plan) {
        return None;
    }
    let adapter = gpu::adapters().into_iter().find(Adapter::is_hardware)?;
    match test(adapter, wrong).and_then(|device| serving(plan, device)) {
        Ok(trusted) => Some(trusted),
        Err(error) => {
            remark(&format!("{error}; the processor judges the designs"));
            None
        }
    }
}

/// A device, if it can serve the study.
fn serving(plan: &Plan, device: Trusted) -> Result<Trusted> {
    supports(plan, device.on.limited_loops)?;
    Ok(device)
}

/// Makes the study's kernel and buffers on a device, as the sweep will: what a driver refuses shows here.
///
/// # Errors
/// [`Error::Gpu`] if the device fails, [`Error::NotOnDevice`] if it cannot serve the study.
fn try_out(plan: &Plan, device: &Trusted) -> Result<()> {
    let ranges = vec![(0.0, 1.0); plan.study.report.histograms.len()];
    GpuEngine::new(plan, &ranges, &device.on.device, device.on.limited_loops, &device.on.wrong).map(|_| ())
}

/// The adapter of that name, or the best, if its driver can be trusted.
///
/// # Errors
/// [`Error::NoAdapter`] if there is none of that name, [`Error::Gpu`] if its driver fails or is wrong.
pub fn trusted(adapter: Option<&str>, wrong: Wrong) -> Result<Trusted> {
    test(gpu::choose(adapter)?, wrong)
}

fn test(adapter: Adapter, wrong: Wrong) -> Result<Trusted> {
    let device = adapter.open()?;
    let report = self_test::run(&device)?;
    let problems = report.problems();
    if !problems.is_empty() {
        return Err(Error::Gpu {
            device: adapter.name.clone(),
            problem: format!("its driver failed the self-test ({}); use --engine cpu", problems.join("; ")),
        });
    }
    let on = OnDevice { device, limited_loops: report.limited_loops(), wrong };
    Ok(Trusted { adapter, report, on })
}
