//! Options of the command line that concern the GPU kernel: `--perturb` and `--emit-shader`.

use beltspace::error::{Error, Result};
use beltspace::files::{MOVE, refuse_foreign, replace};
use beltspace::models::Model;
use beltspace::plan::Plan;
use beltspace::run::device::{Wrong, refuse_cpu_only};
use beltspace::screen::gpu::kernel_of;
use beltspace::screen::{Tables, Tally};
use std::path::Path;

/// The errors to put into a device's kernel, from the values of `--perturb`.
pub fn wrong(model: &Model, words: &[String]) -> Result<Wrong> {
    Ok(Wrong::by(perturbations(model, words)?))
}

/// Reads `OUTPUT=FRACTION` of `--perturb`.
fn perturbations(model: &Model, words: &[String]) -> Result<Vec<(usize, f64)>> {
    let one = |word: &String| {
        let both = word.split_once('=').and_then(|(name, fraction)| Some((name.trim(), fraction.trim().parse::<f64>().ok()?)));
        let (name, fraction) = both
            .filter(|(_, fraction)| fraction.is_finite())
            .ok_or_else(|| Error::Request(format!("--perturb \"{word}\": write OUTPUT=FRACTION, such as torque_capacity_Nm=2e-5")))?;
        let output = model.output(name).ok_or_else(|| Error::Request(format!("--perturb: {} has no output \"{name}\"", model.name)))?;
        Ok((output, fraction))
    };
    words.iter().map(one).collect()
}

/// First line of a kernel's file.
const KERNEL: &str = "// The kernel of a study, written by beltspace sweep --emit-shader.";

/// Writes the kernel of a study.
pub fn emit_shader(plan: &Plan, wrong: &Wrong, threads: usize, file: &Path) -> Result<()> {
    refuse_cpu_only(&plan.study.model, "it has no shader to write; leave --emit-shader out")?;
    refuse_foreign(file, MOVE, |head| head.starts_with(KERNEL))?;
    let ranges = Tally::new(plan, &Tables::new(plan), threads).histogram_ranges(plan);
    let kernel = kernel_of(plan, &ranges, &wrong.perturb)?;
    replace(file, format!("{KERNEL}\n{kernel}").as_bytes())
}

#[cfg(test)]
mod tests {
    use super::super::unlike::cpu_only;
    use super::*;
    use beltspace::run::Engine;
    use beltspace::run::device::choose;
    use beltspace::screen::gpu::supports;
    use beltspace::study::Study;

    #[test]
    fn a_model_without_a_gpu_implementation_is_refused_a_gpu_and_runs_on_the_cpu() {
        let model = cpu_only();
        let text = beltspace::models::find("pulley-load").expect("it is a model").starter.clone();
        let mut study = Study::parse_in(&text, "study.toml", ".".as_ref()).expect("the starter is right");
        study.model = model;
        let plan = Plan::new(study);
        for (engine, adapter) in [(Engine::Gpu, None), (Engine::Gpu, Some("any")), (Engine::Auto, Some("any"))] {
            let refused =
                choose(&plan, engine, adapter, Wrong::default(), &mut |_| ()).map(drop).expect_err("it has no GPU implementation");
            assert!(matches!(refused, Error::CpuOnly { .. }));
            assert_eq!(
                refused.to_string(),
                "cpu-only is computed in f64 on the CPU only; use --engine cpu, or leave --engine and --adapter out"
            );
        }
        for engine in [Engine::Auto, Engine::Cpu] {
            assert!(choose(&plan, engine, None, Wrong::default(), &mut |_| ()).expect("the CPU can do it").is_none());
        }
        let refused = supports(&plan, true).expect_err("it has no GPU implementation").to_string();
        assert_eq!(refused, "cpu-only is computed in f64 on the CPU only");
    }

    #[test]
    fn a_model_without_a_gpu_implementation_has_no_shader_to_write() {
        let text = beltspace::models::find("pulley-load").expect("it is a model").starter.clone();
        let mut study = Study::parse_in(&text, "study.toml", ".".as_ref()).expect("the starter is right");
        study.model = cpu_only();
        let refused =
            emit_shader(&Plan::new(study), &Wrong::default(), 1, Path::new("unwritten.wgsl")).expect_err("it has no GPU implementation");
        assert!(matches!(refused, Error::CpuOnly { .. }));
        let expected = "cpu-only is computed in f64 on the CPU only; it has no shader to write; leave --emit-shader out";
        assert_eq!((refused.to_string().as_str(), Path::new("unwritten.wgsl").exists()), (expected, false));
    }
}
