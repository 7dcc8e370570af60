//! A model of one's own, a flat belt after Eytelwein: written once, swept on the CPU, in boxes by bounds and, where there is one, on a GPU.
//! Run with `cargo run --example own_model`.

use beltspace::models::{Condition, Effort, Fields, Formula, Input, Model, Models, Output, Set, Shader, Worse};
use beltspace::real::Real;
use beltspace::units::{DEGREE, KILOGRAM_PER_METRE, METRE_PER_SECOND, NEWTON, NONE};
use beltspace::{Engine, Judging, Options, Study};
use std::sync::Arc;

/// Tight tension of a flat belt that just does not slip, and the power that it carries.
struct FlatBelt;

impl Formula for FlatBelt {
    const FIELDS: Fields = Fields {
        inputs: &["slack_tension", "friction", "wrap", "belt_speed", "belt_mass"],
        prepared: &["grip"],
        tables: &[],
        turns: 0,
        conditions: 1,
        outputs: &["tight_tension", "effective_tension"],
    };

    // What is expensive, and depends on few inputs: exp(mu theta).
    fn prepare<R: Real>(inputs: &[R], _wanted: Set, prepared: &mut [R]) {
        let [friction, wrap] = [inputs[1], inputs[2]];
        prepared[0] = ((friction * wrap).exp_m1() + R::constant(1.0)).named("grip", "Eytelwein");
    }

    // Above zero where the formula has a meaning: the belt stays on the pulley.
    fn conditions<R: Real>(_prepared: &[R::Shared], inputs: &[R], _wanted: Set, margins: &mut [R]) {
        let [slack, speed, mass] = [0, 3, 4].map(|input| inputs[input]);
        margins[0] = slack - mass * speed.squared();
    }

    // The inner loop, in SI units.
    fn finish<R: Real>(prepared: &[R::Shared], inputs: &[R], _wanted: Set, outputs: &mut [R]) {
        let [slack, speed, mass] = [0, 3, 4].map(|input| inputs[input]);
        let centrifugal = (mass * speed.squared()).named("centrifugal", "");
        let tight = (slack - centrifugal) * R::shared(prepared[0]) + centrifugal;
        outputs[0] = tight;
        outputs[1] = tight - slack;
    }
}

fn flat_belt() -> Model {
    Model {
        name: "flat-belt".into(),
        version: "1".into(),
        summary: "Flat belt after Eytelwein: tensions at the limit of slip".into(),
        source: "Eytelwein's equation with centrifugal tension".into(),
        limits: "No bending, no creep.".into(),
        inputs: vec![
            Input::new("slack_tension_N", "F2", NEWTON, 100.0, (10.0, 1000.0), "Tension of the slack side.", "chosen"),
            Input::new("friction", "mu", NONE, 0.3, (0.1, 0.6), "Coefficient of friction.", "chosen"),
            Input::new("wrap_deg", "theta", DEGREE, 180.0, (90.0, 270.0), "Angle of wrap.", "chosen"),
            Input::new("belt_speed_m_per_s", "v", METRE_PER_SECOND, 10.0, (1.0, 60.0), "Speed of the belt.", "chosen"),
            Input::new("belt_mass_kg_per_m", "m", KILOGRAM_PER_METRE, 0.1, (0.01, 1.0), "Mass of the belt per length.", "chosen"),
        ],
        outputs: vec![
            Output::new("tight_tension_N", "F1", NEWTON, Worse::Higher, "Eytelwein", "Tension of the tight side.").promising(4.5),
            Output::new("effective_tension_N", "Fu", NEWTON, Worse::Lower, "F1 - F2", "What the belt can pull.").promising(4.5),
        ],
        conditions: vec![Condition::new("belt lifts", true, &["tight_tension_N", "effective_tension_N"], "The belt stays on the pulley.")],
        presets: Vec::new(),
        starter: String::new(),
        kernel: Arc::new(FlatBelt),
        effort: Effort { prepare: 1e-7, finish: 2e-9 },
        sample: 65_536,
        shader: Some(Shader::Recorded),
        remarks: None,
        notes: None,
        profile: None,
        pulley: None,
    }
}

const STUDY: &str = r#"
model = "flat-belt"
[design]
slack_tension_N = { from = 20, to = 400, count = 381 }
wrap_deg = { from = 120, to = 220, count = 101 }
[operation]
belt_speed_m_per_s = [5, 20, 40]
[uncertainty]
friction = [0.25, 0.3, 0.35]
[constraints]
effective_tension_N = { min = 120 }
[objectives]
slack_tension_N = "min"
wrap_deg = "min"
tight_tension_N = "min"
"#;

/// Prints it.
pub fn main() -> beltspace::Result<()> {
    let models = Models::new().with(Arc::new(flat_belt()))?;
    let study = Study::parse_with(&models, STUDY, "flat-belt.toml", ".".as_ref())?;
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
