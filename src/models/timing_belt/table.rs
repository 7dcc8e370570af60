//! The tables of the timing belt: inputs, outputs, conditions, presets.

use super::super::description::{Condition, Effort, Input, Output, Preset, Range, SAMPLE, Worse};
use super::super::model::Model;
use super::super::status::{Evaluation, Status};
use super::{Inputs, OUT, SPACE, TimingBelt, profile};
use crate::units::{DEGREE, GIGAPASCAL, GRAM, MICROMETRE_PER_NEWTON, MILLIMETRE, NEWTON, NONE, RPM, SQUARE_MILLIMETRE, Unit};
use Worse::{Higher, Lower};
use std::sync::Arc;

const PAPER: &str = "paper";
const TRAPEZOID: &str = "chosen: ISO trapezoid L on 44 teeth";
/// A few roundings: some value uses up all of its running error bound.
const SIMPLE: f64 = 4.5;

fn angle(name: &str, symbol: &str, default: f64, usual: (f64, f64), most: f64, doc: &str, source: &str) -> Input {
    Input { valid: Range::from_until(0.0, most), ..Input::new(name, symbol, DEGREE, default, usual, doc, source) }
}

fn output(name: &str, symbol: &str, unit: Unit, worse: Worse, source: &str, doc: &str) -> Output {
    Output::new(name, symbol, unit, worse, source, doc)
}

const OF_THE_MESH: &[&str] = &[
    "boundary_tooth",
    "boundary_position",
    "incomplete_teeth",
    "lift_speed_rpm",
    "boundary_tension_N",
    "peak_tooth_load_N",
    "peak_tooth_load_complete_N",
    "least_tooth_load_N",
];

/// Of counted teeth: zero where every tooth surely meshes or lifts, and else, at one tooth for each that may do either, four times that.
const COUNTED: f64 = 4.5;

/// The model.
pub fn model() -> Model {
    Model {
        name: "timing-belt".into(),
        version: String::new(),
        summary: "Timing belt: tooth loads, and teeth that the centrifugal force lifts out of mesh".into(),
        source: "H. S. Kim, C. K. Yeo, I. H. Lee: force distribution of incomplete meshing teeth in timing belt drive, eqs (1)-(21)".into(),
        limits:
            "The boundary tooth is calibrated by the pitch mass, not predicted: the paper does not print the radial balance that it uses. \
             One pulley at constant speed; shock, the belt's bending moment, tooth jumping and span vibration are not covered."
                .into(),
        inputs: vec![
            Input {
                valid: Range::NOT_NEGATIVE,
                ..Input::new("pulley_speed_rpm", "n", RPM, 5000.0, (0.0, 10_000.0), "Speed of the pulley.", "paper, Fig. 9")
            },
            Input::new("tight_tension_N", "T_t", NEWTON, 196.0, (50.0, 2000.0), "Tension of the tight side.", "paper, Fig. 9"),
            Input {
                valid: Range::NOT_NEGATIVE,
                ..Input::new("slack_tension_N", "T_s", NEWTON, 0.0, (0.0, 500.0), "Tension of the slack side.", PAPER)
            },
            Input {
                integer: true,
                valid: Range { low: 4.0, high: super::TEETH as f64, includes_low: true, includes_high: true },
                ..Input::new(
                    "teeth_in_mesh",
                    "N+1",
                    NONE,
                    23.0,
                    (4.0, 60.0),
                    "Teeth of the belt on the pulley.",
                    "paper: 23 driven, 11 driver",
                )
            },
            Input {
                valid: Range::NOT_NEGATIVE,
                ..Input::new("friction", "mu", NONE, 0.45, (0.3, 0.55), "Coefficient of friction between belt and pulley.", PAPER)
            },
            Input::new(
                "tooth_compliance_um_per_N",
                "f",
                MICROMETRE_PER_NEWTON,
                2.55,
                (1.5, 8.0),
                "Deflection of a tooth per force.",
                "paper: 0.025 mm/kgf",
            ),
            Input::new("cord_modulus_GPa", "E", GIGAPASCAL, 78.4, (60.0, 90.0), "Modulus of elasticity of the cord.", PAPER),
            Input::new(
                "cord_area_mm2",
                "A",
                SQUARE_MILLIMETRE,
                21.5,
                (4.7, 40.0),
                "Mean cross-section of the belt.",
                "chosen: 12.7 mm x 1.69 mm",
            ),
            Input::new("tip_radius_mm", "r", MILLIMETRE, 66.32, (10.0, 150.0), "Tip radius of the pulley.", TRAPEZOID),
            Input {
                valid: Range::between(0.0, 30.0),
                ..angle("land_half_angle_deg", "beta", 1.473, (0.5, 8.0), 30.0, "Half the angle of a tip land.", TRAPEZOID)
            },
            Input {
                valid: Range::between(0.0, 30.0),
                ..angle("space_half_angle_deg", "phi", 2.618, (1.0, 12.0), 30.0, "Half the angle of a tooth space.", TRAPEZOID)
            },
            Input::new("tooth_length_mm", "l", MILLIMETRE, 6.10, (3.0, 12.0), "Length of the belt's tooth part.", TRAPEZOID),
            angle("pressure_angle_deg", "alpha", 20.0, (15.0, 25.0), 45.0, "Pressure angle of the tooth flank.", TRAPEZOID),
            angle("tight_span_angle_deg", "Omega", 6.0, (0.0, 15.0), 60.0, "Inclination of the tight span at the first tooth.", "chosen"),
            angle("slack_span_angle_deg", "psi", 6.0, (0.0, 15.0), 60.0, "Inclination of the slack span at the last tooth.", "chosen"),
            Input::new(
                "pitch_mass_g",
                "m",
                GRAM,
                0.411,
                (0.1, 3.0),
                "Mass of one pitch of the belt, (20), (21).",
                "calibrated: first lifted tooth 16 in Fig. 9",
            ),
            Input {
                follows: Some("space_half_angle_deg".into()),
                ..angle(
                    "lift_angle_deg",
                    "theta",
                    SPACE,
                    (0.0, 12.0),
                    30.0,
                    "Angle by which lifted teeth are rotated, at most half the angle of the tooth space; \"space\": that much.",
                    PAPER,
                )
                .with_words(&[("space", SPACE)])
            },
            Input::new(
                "pitch_mm",
                "p",
                MILLIMETRE,
                9.525,
                (5.0, 20.0),
                "Pitch of the belt; read by centrifugal_land_friction only.",
                TRAPEZOID,
            ),
            Input {
                integer: true,
                cpu_only: true,
                valid: Range { low: 0.0, high: 1.0, includes_low: true, includes_high: true },
                ..Input::new(
                    "centrifugal_land_friction",
                    "",
                    NONE,
                    0.0,
                    (0.0, 1.0),
                    "1: in the incomplete mesh the centrifugal force reduces the friction on the lands; 0: it does not.",
                    "paper, step (5), not printed there",
                )
            },
        ],
        outputs: vec![
            output("centrifugal_force_N", "F", NEWTON, Higher, "m r omega^2", "Centrifugal force on one pitch.").with_bound_factor(SIMPLE),
            output(
                "boundary_tooth",
                "j",
                NONE,
                Lower,
                "steps (3), (4)",
                "First tooth from the tight side that lifts; teeth_in_mesh + 1 if none does.",
            )
            .whole()
            .with_bound_factor(COUNTED),
            output(
                "boundary_position",
                "",
                NONE,
                Lower,
                "steps (3), (4), interpolated",
                "Position between two teeth at which the radial balance changes its sign; 1 if the first tooth lifts.",
            )
            .with_bound_factor(2.5),
            output("incomplete_teeth", "", NONE, Higher, "N + 2 - j", "Number of teeth from the first lifted one to the slack side.")
                .whole()
                .with_bound_factor(COUNTED),
            output("lift_speed_rpm", "", RPM, Lower, "inward force = m r omega^2", "Lowest speed at which a tooth lifts; 0: even at rest."),
            output("boundary_tension_N", "T*", NEWTON, Higher, "(19)", "Tension between the last meshing and the first lifted tooth.")
                .with_bound_factor(2.0),
            output("peak_tooth_load_N", "", NEWTON, Higher, "(8), (14)", "Largest tooth load of the actual mesh."),
            output("peak_tooth_load_complete_N", "", NEWTON, Higher, "(8)", "Largest tooth load if every tooth meshed."),
            output(
                "least_tooth_load_N",
                "",
                NEWTON,
                Lower,
                "(8), (14)",
                "Least tooth load of the actual mesh; if negative, a tooth is held by its other flank, which the model does not cover.",
            ),
            output("effective_tension_N", "P", NEWTON, Lower, "T_t - T_s", "Tension that the pulley transmits.").with_bound_factor(SIMPLE),
        ],
        conditions: vec![
            Condition::new("no effective tension", true, OF_THE_MESH, "The tight side is tighter than the slack side."),
            Condition::new(
                "lift angle exceeds tooth space",
                false,
                &["boundary_tension_N", "peak_tooth_load_N", "least_tooth_load_N"],
                "A lifted tooth stays in its space: theta <= phi.",
            ),
            Condition::new("no tooth lifts", true, &["boundary_tension_N"], "The centrifugal force exceeds the least inward force.")
                .quiet(),
        ],
        presets: vec![
            Preset::new("ohc-driven", &[]),
            Preset::new(
                "ohc-driver",
                &[
                    ("pulley_speed_rpm", 10_000.0),
                    ("teeth_in_mesh", 11.0),
                    ("tip_radius_mm", 32.97),
                    ("land_half_angle_deg", 2.945),
                    ("space_half_angle_deg", 5.236),
                ],
            ),
        ],
        starter: include_str!("../../../studies/timing-design.toml").into(),
        kernel: Arc::new(TimingBelt),
        pulley: None,
        origin: None,
        profile: Some(Arc::new(profile::profile)),
        notes: Some(Arc::new(notes)),
        remarks: Some(Arc::new(remarks)),
        effort: Effort { prepare: 1e-6, finish: 1e-8 },
        sample: SAMPLE,
        on_gpu: true,
    }
}

/// The similarity law, where it holds.
fn remarks(fixed: &[Option<f64>]) -> Vec<String> {
    let law = "without slack tension the boundary tooth depends on pitch_mass * tip_radius * speed^2 / tight_tension alone, for one belt on \
               one pulley";
    if fixed[Inputs::NUMBER.slack_tension] == Some(0.0) { vec![law.to_owned()] } else { Vec::new() }
}

/// What a person should know of one evaluation besides its numbers.
fn notes(model: &Model, inputs: &[f64], evaluation: &Evaluation) -> Vec<String> {
    let mut notes = Vec::new();
    if evaluation.status != Status::Ok {
        return notes;
    }
    if let Some(least) = evaluation.outputs[OUT.least_tooth_load].filter(|load| *load < 0.0) {
        notes.push(format!(
            "a tooth load is negative ({least:.3} N): that tooth is held by its other flank, which the model does not cover"
        ));
    }
    let si = super::super::to_si(model, inputs);
    let i = Inputs::read(&si);
    let wrap = i.teeth_in_mesh * (2.0 * (i.land_half_angle + i.space_half_angle)).to_degrees();
    if wrap > 360.0 {
        notes.push(format!("{} teeth in mesh wrap {wrap:.0} degrees of a pulley with this land and space", i.teeth_in_mesh));
    }
    if i.slack_tension == 0.0 {
        let ratio = i.pitch_mass * i.tip_radius * i.pulley_speed * i.pulley_speed / i.tight_tension;
        notes.push(format!(
            "without slack tension the boundary depends on pitch_mass * tip_radius * speed^2 / tight_tension alone, here {ratio:.4}"
        ));
    }
    notes
}
