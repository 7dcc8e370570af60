//! What the command line says to a device: errors on purpose, and the kernel as a file.

use beltspace::error::{Error, Result};
use beltspace::files::{MOVE, refuse_foreign, replace};
use beltspace::models::Model;
use beltspace::plan::Plan;
use beltspace::run::device::{Wrong, needs_a_twin};
use beltspace::screen::gpu::kernel_of;
use beltspace::screen::{Tables, Tally};
use std::path::Path;

/// What is to be wrong with a device's kernel, from the words of `--perturb`.
pub fn wrong(model: &Model, words: &[String]) -> Result<Wrong> {
    Ok(Wrong { perturb: perturbations(model, words)?, ..Wrong::default() })
}

/// Reads `OUTPUT=PART` of `--perturb`.
fn perturbations(model: &Model, words: &[String]) -> Result<Vec<(usize, f64)>> {
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

/// First line of a kernel's file.
const KERNEL: &str = "// The kernel of a study, written by beltspace sweep --emit-shader.";

/// Writes the kernel of a study.
pub fn emit_shader(plan: &Plan, wrong: &Wrong, threads: usize, file: &Path) -> Result<()> {
    needs_a_twin(&plan.study.model, "it has no shader to write; leave --emit-shader out")?;
    refuse_foreign(file, MOVE, |head| head.starts_with(KERNEL))?;
    let ranges = Tally::new(plan, &Tables::new(plan), threads).histogram_ranges(plan);
    let kernel = kernel_of(plan, &ranges, &wrong.perturb)?;
    replace(file, format!("{KERNEL}\n{kernel}").as_bytes())
}

#[cfg(test)]
mod tests {
    use super::super::unlike::on_the_processor_only;
    use super::*;
    use beltspace::run::Engine;
    use beltspace::run::device::choose;
    use beltspace::screen::gpu::supports;
    use beltspace::study::Study;

    #[test]
    fn a_model_without_a_twin_is_refused_a_gpu_and_left_to_the_processor_otherwise() {
        let model = on_the_processor_only();
        let text = beltspace::models::find("pulley-load").expect("it is a model").starter.clone();
        let mut study = Study::parse_in(&text, "study.toml", ".".as_ref()).expect("the starter is right");
        study.model = model;
        let plan = Plan::new(study);
        for (engine, adapter) in [(Engine::Gpu, None), (Engine::Gpu, Some("any")), (Engine::Auto, Some("any"))] {
            let refused = choose(&plan, engine, adapter, Wrong::default(), &mut |_| ()).map(drop).expect_err("it has no twin");
            assert!(matches!(refused, Error::CpuOnly { .. }));
            assert_eq!(
                refused.to_string(),
                "no-twin is computed in f64 on the processor only; use --engine cpu, or leave --engine and --adapter out"
            );
        }
        for engine in [Engine::Auto, Engine::Cpu] {
            assert!(choose(&plan, engine, None, Wrong::default(), &mut |_| ()).expect("that is what the processor is for").is_none());
        }
        let refused = supports(&plan, true).expect_err("it has no twin").to_string();
        assert_eq!(refused, "no-twin is computed in f64 on the processor only");
    }

    #[test]
    fn a_model_without_a_twin_has_no_shader_to_write() {
        let text = beltspace::models::find("pulley-load").expect("it is a model").starter.clone();
        let mut study = Study::parse_in(&text, "study.toml", ".".as_ref()).expect("the starter is right");
        study.model = on_the_processor_only();
        let refused = emit_shader(&Plan::new(study), &Wrong::default(), 1, Path::new("unwritten.wgsl")).expect_err("it has no twin");
        assert!(matches!(refused, Error::CpuOnly { .. }));
        let expected = "no-twin is computed in f64 on the processor only; it has no shader to write; leave --emit-shader out";
        assert_eq!((refused.to_string().as_str(), Path::new("unwritten.wgsl").exists()), (expected, false));
    }
}
