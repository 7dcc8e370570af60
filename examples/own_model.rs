//! A model of one's own, a band brake after Eytelwein: written once, swept on the CPU, in boxes by bounds and, where there is one, on a GPU.
//! Run with `cargo run --example own_model`.

use beltspace::models::{Condition, Fields, Formula, Input, Model, Models, Output, Set, Worse};
use beltspace::real::Real;
use beltspace::units::{DEGREE, MILLIMETRE, NEWTON, NEWTON_METRE, NONE};
use beltspace::{Engine, Judging, Options, Study, record};
use std::f64::consts::PI;
use std::sync::Arc;

record!(Inputs { pull, friction, wrap, drum_diameter });
record!(Prepared { grip });
record!(Outputs { tight_tension, torque });

/// A band around a drum that turns towards the end at which a lever pulls.
struct BandBrake;

impl Formula for BandBrake {
    const FIELDS: Fields = Fields::new(Inputs::NAMES, Prepared::NAMES, Outputs::NAMES, 1);

    // What is expensive, and depends on few inputs: exp(mu theta) - 1.
    fn prepare<R: Real>(inputs: &[R], _wanted: Set, prepared: &mut [R]) {
        let i = Inputs::read(inputs);
        Prepared { grip: (i.friction * i.wrap).exp_m1() }.write(prepared);
    }

    // Above zero where the formula has a meaning: the band does not overlap itself.
    fn conditions<R: Real>(_prepared: &[R::Shared], inputs: &[R], _wanted: Set, margins: &mut [R]) {
        margins[0] = R::constant(2.0 * PI) - Inputs::read(inputs).wrap;
    }

    // The inner loop, in SI units.
    fn finish<R: Real>(prepared: &[R::Shared], inputs: &[R], _wanted: Set, outputs: &mut [R]) {
        let (i, p) = (Inputs::read(inputs), Prepared::<R>::shared(prepared));
        let friction_force = i.pull * p.grip;
        Outputs { tight_tension: i.pull + friction_force, torque: friction_force * i.drum_diameter / R::constant(2.0) }.write(outputs);
    }
}

/// The model.
pub fn band_brake() -> Model {
    Model::new("band-brake", BandBrake)
        .version("1")
        .inputs([
            Input::new("pull_N", "F2", NEWTON, 100.0, (10.0, 1000.0), "Pull of the lever.", "chosen"),
            Input::new("friction", "mu", NONE, 0.3, (0.1, 0.6), "Coefficient of friction.", "chosen"),
            Input::new("wrap_deg", "theta", DEGREE, 270.0, (180.0, 330.0), "Angle of wrap.", "chosen"),
            Input::new("drum_diameter_mm", "D", MILLIMETRE, 250.0, (100.0, 500.0), "Diameter of the drum.", "chosen"),
        ])
        .outputs([
            Output::new("tight_tension_N", "F1", NEWTON, Worse::Higher, "Eytelwein", "Tension of the end that is held."),
            Output::new("torque_Nm", "M", NEWTON_METRE, Worse::Lower, "(F1 - F2) D / 2", "Torque of the brake."),
        ])
        .conditions([Condition::new("band overlaps", true, &["tight_tension_N", "torque_Nm"], "The band goes around less than once.")])
}

/// A study of it.
pub const STUDY: &str = r#"
model = "band-brake"
[design]
pull_N = { from = 20, to = 400, count = 381 }
wrap_deg = { from = 200, to = 320, count = 121 }
[operation]
drum_diameter_mm = [200, 250]
[uncertainty]
friction = [0.25, 0.3, 0.35]
[constraints]
torque_Nm = { min = 30 }
[objectives]
pull_N = "min"
wrap_deg = "min"
tight_tension_N = "min"
"#;

/// Prints it.
pub fn main() -> beltspace::Result<()> {
    let models = Models::new().with(Arc::new(band_brake()))?;
    let study = Study::parse_with(&models, STUDY, "band-brake.toml", ".".as_ref())?;
    let options = Options::default().engine(Engine::Cpu);
    let every = study.sweep(options.clone().judging(Judging::Exhaustive))?;
    println!("{} of {} designs are feasible, {} are on the front", every.counts.feasible, every.counts.designs, every.counts.front);
    let in_boxes = study.sweep(options.judging(Judging::Bounds))?;
    assert_eq!((&every.front, &every.counts), (&in_boxes.front, &in_boxes.counts));
    println!("by bounds: the same");
    #[cfg(feature = "gpu")]
    if let Some(adapter) = beltspace::gpu::adapters().into_iter().next() {
        let options = Options::default().engine(Engine::Gpu).adapter(&adapter.name).judging(Judging::Exhaustive);
        let on_gpu = study.sweep(options)?;
        assert_eq!((&every.front, &every.counts), (&on_gpu.front, &on_gpu.counts));
        println!("{}: the same", adapter.in_words());
    }
    Ok(())
}
