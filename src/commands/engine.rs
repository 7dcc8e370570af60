//! The choice of what judges the designs.

use crate::cli::Engine;
use crate::terminal;
use beltspace::error::{Error, Result};
use beltspace::gpu::{self, Adapter, self_test};
use beltspace::models::Model;
use beltspace::plan::Plan;
use beltspace::screen::gpu::{GpuEngine, Wrong, supports};
use beltspace::sweep::OnDevice;

/// Evaluations below which starting a device costs more than it saves.
const WORTH_A_DEVICE: f64 = 2e8;

/// A device that has passed its self-test.
pub struct Trusted {
    pub adapter: Adapter,
    pub report: self_test::Report,
    pub on: OnDevice,
}

/// The device to sweep a study on; `None` for the processor.
pub fn choose(plan: &Plan, engine: Engine, adapter: Option<&str>, wrong: Wrong) -> Result<Option<Trusted>> {
    if engine != Engine::Gpu && !wrong.perturb.is_empty() {
        return Err(Error::Request("--perturb makes a GPU's kernel wrong on purpose: it needs --engine gpu".to_owned()));
    }
    let insists = engine == Engine::Gpu || (engine == Engine::Auto && adapter.is_some());
    if insists {
        needs_a_twin(plan.study.model, "use --engine cpu, or leave --engine and --adapter out")?;
    }
    match engine {
        Engine::Cpu if adapter.is_some() => Err(Error::Request("--adapter names a GPU, but --engine cpu was asked for".to_owned())),
        Engine::Cpu => Ok(None),
        Engine::Auto if adapter.is_none() => Ok(automatic(plan, wrong)),
        Engine::Gpu | Engine::Auto => serving(plan, trusted(adapter, wrong)?).map(Some),
    }
}

/// A wrong request of a model that is computed on the processor only, and what to do about it.
pub fn needs_a_twin(model: &Model, remedy: &str) -> Result<()> {
    model.on_device().map(drop).map_err(|error| Error::Request(format!("{error}; {remedy}")))
}

/// A hardware adapter for a study that is large enough; whatever is wrong with it is a remark.
#[allow(clippy::cast_precision_loss, reason = "an estimate")]
fn automatic(plan: &Plan, wrong: Wrong) -> Option<Trusted> {
    if plan.study.model.device.is_none() || (plan.designs() as f64) * (plan.scenarios() as f64) < WORTH_A_DEVICE {
        return None;
    }
    let adapter = gpu::adapters().into_iter().find(Adapter::is_hardware)?;
    match test(adapter, wrong).and_then(|device| serving(plan, device)) {
        Ok(trusted) => Some(trusted),
        Err(error) => {
            terminal::remark("warning", &format!("{error}; the processor judges the designs"));
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
pub fn try_out(plan: &Plan, device: &Trusted) -> Result<()> {
    let ranges = vec![(0.0, 1.0); plan.study.report.histograms.len()];
    GpuEngine::new(plan, &ranges, &device.on.device, device.on.limited_loops, &device.on.wrong).map(|_| ())
}

/// The adapter of that name, or the best, if its driver can be trusted.
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

/// Reads `OUTPUT=PART` of `--perturb`.
pub fn perturbations(model: &Model, words: &[String]) -> Result<Vec<(usize, f64)>> {
    let one = |word: &String| {
        let parts = word.split_once('=').and_then(|(name, part)| Some((name.trim(), part.trim().parse::<f64>().ok()?)));
        let (name, part) = parts
            .filter(|(_, part)| part.is_finite())
            .ok_or_else(|| Error::Request(format!("--perturb \"{word}\": write OUTPUT=PART, such as torque_capacity_Nm=2e-5")))?;
        let output = model.output(name).ok_or_else(|| Error::Request(format!("--perturb: {} has no output \"{name}\"", model.name)))?;
        Ok((output, part))
    };
    words.iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::super::unlike::on_the_processor_only;
    use super::*;
    use beltspace::study::Study;

    #[test]
    fn a_model_without_a_twin_is_refused_a_gpu_and_left_to_the_processor_otherwise() {
        let model = on_the_processor_only();
        let text = beltspace::models::find("pulley-load").expect("it is a model").starter;
        let mut study = Study::parse(text, "study.toml", ".".as_ref()).expect("the starter is right");
        study.model = model;
        let plan = Plan::new(study);
        for (engine, adapter) in [(Engine::Gpu, None), (Engine::Gpu, Some("any")), (Engine::Auto, Some("any"))] {
            let refused = choose(&plan, engine, adapter, Wrong::default()).map(drop).expect_err("it has no twin");
            assert!(matches!(refused, Error::Request(_)));
            assert_eq!(
                refused.to_string(),
                "no-twin is computed in f64 on the processor only; use --engine cpu, or leave --engine and --adapter out"
            );
        }
        for engine in [Engine::Auto, Engine::Cpu] {
            assert!(choose(&plan, engine, None, Wrong::default()).expect("that is what the processor is for").is_none());
        }
        let refused = supports(&plan, true).expect_err("it has no twin").to_string();
        assert_eq!(refused, "no-twin is computed in f64 on the processor only");
    }
}
