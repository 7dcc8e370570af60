//! The tables of the timing belt: inputs, outputs, conditions, presets.

use super::super::description::{Condition, Effort, Input, Output, Preset, Range, SAMPLE, Worse};
use super::super::model::Model;
use super::{FROM_BELT, SPACE, TimingBelt, notes, profile};
use crate::units::{
    DEGREE, GIGAPASCAL, GRAM, KILOGRAM_PER_CUBIC_METRE, MICROMETRE_PER_NEWTON, MILLIMETRE, NEWTON, NEWTON_METRE, NONE, RPM,
    SQUARE_MILLIMETRE, Unit,
};
use Worse::{Higher, Lower};
use std::sync::Arc;

const PAPER: &str = "paper";
const TRAPEZOID: &str = "chosen: ISO trapezoid L on 44 teeth";
/// A few roundings: some value uses up all of its running error bound.
const SIMPLE: f64 = 4.5;

fn angle(name: &str, symbol: &str, default: f64, usual: (f64, f64), most: f64, doc: &str, source: &str) -> Input {
    Input { valid: Range::from_until(0.0, most), ..Input::new(name, symbol, DEGREE, default, usual, doc, source) }
}

/// What only a pitch mass that comes from the belt reads.
fn of_belt(name: &str, symbol: &str, unit: Unit, default: f64, usual: (f64, f64), doc: &str, source: &str) -> Input {
    Input::new(name, symbol, unit, default, usual, format!("{doc}; read by pitch_mass_g = \"from-belt\" only."), source)
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

/// Of counted teeth, and of the position among them: zero, or hardly more, where every tooth surely meshes or lifts, and else, at one tooth
/// for each that may do either, four times that. Such an error is all of the running bound and never more: where the last tooth lifts or
/// not, or where a formula of a study that gives `teeth_in_mesh` rounds up or down, the position is a whole tooth off in f32. Everywhere
/// else its errors were at most 0.11 of the running bound.
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
             With an ordinary car belt (preset car-belt, 0.85 g a pitch) tooth 7 is the first to lift at 5000 rpm of the pulley, not 16. \
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
                "Mass of one pitch of the belt, (20), (21); \"from-belt\": of its rubber and cords below.",
                "calibrated: first lifted tooth 16 in Fig. 9",
            )
            .with_words(&[("from-belt", FROM_BELT)]),
            Input {
                follows: Some("space_half_angle_deg".into()),
                ..angle(
                    "lift_angle_deg",
                    "theta",
                    SPACE,
                    (0.0, 12.0),
                    30.0,
                    "Angle by which lifted teeth are rotated, at most half the angle of the tooth space; \"space\": that much.",
                    "chosen; the paper has theta <= phi",
                )
                .with_words(&[("space", SPACE)])
            },
            Input::new(
                "pitch_mm",
                "p",
                MILLIMETRE,
                9.525,
                (5.0, 20.0),
                "Pitch of the belt; read by centrifugal_land_friction and by pitch_mass_g = \"from-belt\" only.",
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
            Input {
                valid: Range::NOT_NEGATIVE,
                ..Input::new(
                    "pitch_line_mm",
                    "a",
                    MILLIMETRE,
                    0.686,
                    (0.25, 1.6),
                    "Distance of the pitch line, where the cords are, from the tips; read by torque_Nm only.",
                    "chosen: automotive sections ZA and ZB of pitch 9.525 mm (ISO 9011); section L of that pitch has 0.381 mm (ISO 5294)",
                )
            },
            of_belt("belt_width_mm", "b", MILLIMETRE, 12.7, (5.0, 40.0), "Width of the belt", "chosen: ISO 5296, width code 050"),
            of_belt(
                "tooth_area_mm2",
                "A_1",
                SQUARE_MILLIMETRE,
                7.54,
                (2.0, 40.0),
                "Area of a tooth seen from the side: V1 of (20) per width",
                "trapezoid L: 4.65 mm at its base, 1.91 mm high, flanks 40 degrees apart",
            ),
            of_belt(
                "land_area_mm2",
                "A_2",
                SQUARE_MILLIMETRE,
                8.23,
                (2.0, 40.0),
                "Area of a pitch of the belt's back seen from the side, less that of the cords: V2 of (20) per width",
                "trapezoid L: back 1.69 mm thick, cords as below",
            ),
            of_belt(
                "gross_cord_area_mm2",
                "A_3",
                SQUARE_MILLIMETRE,
                10.52,
                (1.0, 40.0),
                "Cross-section of all cords with their coating: V3 of (20) per pitch",
                "chosen: 9 glass cords EC9 34 3/13 of 1.22 mm",
            ),
            of_belt(
                "rubber_density_kg_per_m3",
                "rho_r",
                KILOGRAM_PER_CUBIC_METRE,
                1300.0,
                (1150.0, 1400.0),
                "Density of the rubber",
                "usual for chloroprene and HNBR compounds",
            ),
            of_belt(
                "cord_density_kg_per_m3",
                "rho_c",
                KILOGRAM_PER_CUBIC_METRE,
                1500.0,
                (1450.0, 1550.0),
                "Density of the cords with their coating",
                "EC9 34 3/13: 1750 g/km at 1.22 mm (NGF glass cord)",
            ),
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
            .with_bound_factor(COUNTED),
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
            output("torque_Nm", "M", NEWTON_METRE, Lower, "P (r + a)", "Torque that the pulley transmits.").with_bound_factor(SIMPLE),
            output("pitch_mass_used_g", "", GRAM, Higher, "(20)", "Mass of one pitch that the results stand on.").with_bound_factor(SIMPLE),
        ],
        conditions: vec![
            Condition::new("no effective tension", true, OF_THE_MESH, "The tight side is tighter than the slack side."),
            Condition::new(
                "lift angle exceeds tooth space",
                false,
                &["boundary_tension_N", "peak_tooth_load_N", "least_tooth_load_N"],
                "A lifted tooth stays in its space: theta <= phi.",
            ),
            Condition::new(
                "wrap exceeds 360 degrees",
                false,
                OF_THE_MESH,
                "The teeth in mesh, each with a land and a space, go around the pulley once at most.",
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
            Preset::new(
                "car-belt",
                &[
                    ("cord_area_mm2", 6.79),
                    ("tip_radius_mm", 66.02),
                    ("pitch_mass_g", FROM_BELT),
                    ("belt_width_mm", 19.05),
                    ("tooth_area_mm2", 12.13),
                    ("land_area_mm2", 13.44),
                    ("gross_cord_area_mm2", 15.20),
                ],
            ),
        ],
        starter: include_str!("../../../studies/timing-design.toml").into(),
        kernel: Arc::new(TimingBelt),
        pulley: None,
        origin: None,
        profile: Some(Arc::new(profile::profile)),
        notes: Some(Arc::new(notes::notes)),
        remarks: Some(Arc::new(notes::remarks)),
        doubts: Some(Arc::new(notes::doubts)),
        effort: Effort { prepare: 1e-6, finish: 1e-8 },
        sample: SAMPLE,
        on_gpu: true,
    }
}
