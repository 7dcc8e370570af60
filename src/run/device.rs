//! The choice of a GPU, which must pass a self-test before it is used.

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

/// How many times as fast as the CPU a device is taken to be before it has been measured: enough that bounds are not kept longer than the
/// device would take.
const GAIN: f64 = 20.0;

/// A device that has passed its self-test.
#[derive(Debug)]
pub struct Trusted {
    /// What it is.
    pub adapter: Adapter,
    /// What the self-test found.
    pub report: self_test::SelfTest,
    /// The device, for the sweep.
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

/// The device to sweep a study on; `None` for the CPU.
///
/// If a device was not asked for by name and cannot be used, `remark` is told why.
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
        let drive = plan.study.probability.as_ref().map(|it| &*it.drive.model);
        refuse_cpu_only(drive.unwrap_or(&plan.study.model), "use --engine cpu, or leave --engine and --adapter out")?;
    }
    match engine {
        Engine::Cpu if adapter.is_some() => Err(Error::Request("--adapter names a GPU, but --engine cpu was asked for".to_owned())),
        Engine::Cpu => Ok(None),
        Engine::Auto if adapter.is_none() => Ok(automatic(plan, wrong, remark)),
        Engine::Gpu | Engine::Auto => serving(plan, trusted(adapter, wrong)?).map(Some),
    }
}

/// The same, but a device that was not asked for by name must first set up the study's kernel: if its driver refuses, that is a remark.
/// `asked` is what the user said.
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
        remark(&format!("{error}; the CPU judges the designs"));
        return Ok(None);
    }
    Ok(device)
}

/// Refuses a model that is computed on the CPU only; `remedy` says what to do about it.
///
/// # Errors
/// [`Error::CpuOnly`].
pub fn refuse_cpu_only(model: &Model, remedy: &str) -> Result<()> {
    match model.on_device() {
        Ok(_) => Ok(()),
        Err(_) => Err(Error::CpuOnly { model: model.name.to_owned(), remedy: Some(remedy.to_owned()) }),
    }
}

/// Is `--engine auto` likely to take a device? Answered without starting one.
pub fn is_expected(plan: &Plan, engine: Engine, adapter: Option<&str>) -> bool {
    engine == Engine::Auto && adapter.is_none() && is_worth_a_device(plan) && gpu::adapters().iter().any(Adapter::is_hardware)
}

/// An estimate of how fast a device judges designs, from how fast the CPU does.
pub fn about(cpu: Speed) -> Speed {
    Speed { seconds: cpu.seconds / GAIN, measured: false }
}

#[allow(clippy::cast_precision_loss, reason = "an estimate")]
fn is_worth_a_device(plan: &Plan) -> bool {
    plan.study.model.on_gpu && !plan.study.decides_by_spectrum() && (plan.designs() as f64) * (plan.evaluations() as f64) >= WORTH_A_DEVICE
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
            remark(&format!("{error}; the CPU judges the designs"));
            None
        }
    }
}

/// Opens a device, if it can serve the study.
fn serving(plan: &Plan, device: Trusted) -> Result<Trusted> {
    supports(plan, device.on.limited_loops)?;
    Ok(device)
}

/// Makes the study's kernel and buffers on a device, as the sweep will, to find out whether its driver accepts them.
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
