//! Rubber V-belt variator. The formula is [`super::cvt`]'s, with one belt section of width b and thickness h.

use super::cvt::{self, CONDITION_TABLE, Drive, LIMIT, OUTPUT_TABLE, Prepared};
use super::description::{Input, Model, Range};
use super::formula::{CONDITIONS, Formula, INPUTS, OUTPUTS, PREPARED, record};
use crate::real::Real;
use crate::units::{DEGREE, MEGAPASCAL, MILLIMETRE, NEWTON_METRE, NONE, Unit};

record! {
    /// Inputs in the order of the table.
    Inputs {
        friction, groove_angle, ratio, belt_length, centre_distance, belt_width, belt_thickness, elastic_modulus, strength,
        traction, torque,
    }
}

/// An input whose valid and usual ranges differ from belt to belt.
pub(super) const fn input(
    name: &'static str,
    symbol: &'static str,
    unit: Unit,
    default: f64,
    usual: (f64, f64),
    doc: &'static str,
    source: &'static str,
) -> Input {
    Input { name, symbol, unit, default, valid: Range::POSITIVE, usual, integer: false, word: None, doc, source }
}

/// Groove angle of either belt.
pub(super) const fn groove_angle(default: f64, usual: (f64, f64), source: &'static str) -> Input {
    let doc = "Angle between the two flanks of a pulley.";
    Input { valid: Range::between(0.0, 180.0), ..input("groove_angle_deg", "a", DEGREE, default, usual, doc, source) }
}

/// Ratio of either belt.
pub(super) const fn ratio(usual: (f64, f64), source: &'static str) -> Input {
    input("ratio", "R", NONE, 1.0, usual, "Driven over driver radius; above 1 the driver runs on its small radius.", source)
}

/// Traction of either belt; `default` may be [`LIMIT`].
pub(super) const fn traction(default: f64, source: &'static str) -> Input {
    let doc = "Belt force difference over sum, (F1 - F2)/(F1 + F2), that the axial force is set for; \"limit\": the traction limit of the design.";
    Input {
        valid: Range::from_until(0.0, 1.0),
        word: Some(("limit", LIMIT)),
        ..input("traction", "lambda", NONE, default, (0.05, 0.95), doc, source)
    }
}

/// Torque of either belt.
pub(super) const fn torque(default: f64, usual: (f64, f64)) -> Input {
    let doc = "Torque on the driver pulley.";
    Input { valid: Range::NOT_NEGATIVE, ..input("torque_Nm", "T_L", NEWTON_METRE, default, usual, doc, "chosen") }
}

const PAPER: &str = "paper, test rig";

/// The model.
pub const MODEL: Model = Model {
    name: "rubber-cvt",
    summary: "Rubber V-belt variator: axial forces, stress and torque capacity",
    source: "H. S. Kim, K. W. Kim: ratio, torque load and axial force of rubber and metal V-belt CVTs, eqs (1)-(5), (17)-(21)",
    limits: "Gross slip of a rubber belt is not predicted: measured at a traction of 0.8, the model gives 0.985. Centrifugal force, \
             belt compression and shear, the sliding angle, pulley bending and shift dynamics are neglected.",
    inputs: &[
        input("friction", "mu", NONE, 0.4, (0.3, 0.5), "Coefficient of friction between belt and pulley.", PAPER),
        groove_angle(30.0, (22.0, 36.0), PAPER),
        ratio((0.5, 2.5), PAPER),
        input("belt_length_mm", "L", MILLIMETRE, 1066.0, (300.0, 3000.0), "Pitch length of the belt.", PAPER),
        input("centre_distance_mm", "A", MILLIMETRE, 260.0, (80.0, 1000.0), "Distance of the pulley axes.", PAPER),
        input("belt_width_mm", "b", MILLIMETRE, 50.0, (10.0, 100.0), "Width of the belt.", PAPER),
        input("belt_thickness_mm", "h", MILLIMETRE, 10.0, (1.0, 20.0), "Thickness of the belt.", PAPER),
        input("elastic_modulus_MPa", "E", MEGAPASCAL, 600.0, (50.0, 5000.0), "Modulus of elasticity along the belt.", PAPER),
        input("strength_MPa", "sigma_y", MEGAPASCAL, 18.0, (1.0, 200.0), "Largest permissible stress.", PAPER),
        traction(0.8, "slip measured in the paper"),
        torque(50.0, (1.0, 500.0)),
    ],
    outputs: OUTPUT_TABLE.split_at(OUTPUT_TABLE.len() - 2).0,
    conditions: CONDITION_TABLE.split_at(CONDITION_TABLE.len() - 1).0,
    presets: &[],
    starter: include_str!("../../studies/rubber-cvt.toml"),
    kernel: &RubberCvt,
    profile: None,
};

struct RubberCvt;

#[inline(always)]
fn drive<R: Real>(inputs: &[R; INPUTS]) -> Drive<R> {
    let i = Inputs::read(inputs);
    Drive {
        friction: i.friction,
        groove_angle: i.groove_angle,
        ratio: i.ratio,
        belt_length: i.belt_length,
        centre_distance: i.centre_distance,
        width: i.belt_width,
        thickness: i.belt_thickness,
        sections: R::constant(1.0),
        elastic_modulus: i.elastic_modulus,
        strength: i.strength,
        traction: i.traction,
        torque: i.torque,
    }
}

impl Formula for RubberCvt {
    fn prepare<R: Real>(inputs: &[R; INPUTS]) -> [R; PREPARED] {
        cvt::prepare(&drive(inputs)).to_array(R::constant(0.0))
    }
    #[inline(always)]
    fn conditions<R: Real>(prepared: &[R; PREPARED], inputs: &[R; INPUTS]) -> [R; CONDITIONS] {
        cvt::conditions(&Prepared::read(prepared), &drive(inputs))
    }
    #[inline(always)]
    fn finish<R: Real>(prepared: &[R; PREPARED], inputs: &[R; INPUTS], wanted: u64, outputs: &mut [R; OUTPUTS]) {
        cvt::finish(&Prepared::read(prepared), &drive(inputs), wanted, outputs);
    }
}
