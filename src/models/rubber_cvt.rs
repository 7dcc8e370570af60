//! Rubber V-belt variator. The formula is [`super::cvt`]'s, with one belt section of width b and thickness h.

use super::cvt::{
    Belt, COMMON, Cvt, Drive, Prepared, belt_mass, clamping_force, condition_table, driver_speed, force_sum, groove_angle, output_table,
    ratio, torque, traction, with_own,
};
use super::description::{Effort, Input, Output, Preset, SAMPLE, Worse};
use super::formula::record;
use super::model::Model;
use crate::real::Real;
use crate::tape::Set;
use crate::units::{MEGAPASCAL, MILLIMETRE, NONE};
use std::sync::Arc;

record! {
    /// Inputs in the order of the table.
    pub(super) Inputs {
        friction, groove_angle, ratio, belt_length, centre_distance, belt_width, belt_thickness, elastic_modulus, strength,
        traction, torque, clamping_force, driver_speed, belt_mass, bending_modulus,
    }
}

const PAPER: &str = "paper, test rig";

/// The number that stands for bending modulus "elastic-modulus": one modulus for pull and bending, as in the paper.
const ELASTIC_MODULUS: f64 = -1.0;

/// The output that only this belt has, behind those of either belt.
fn own_table() -> [Output; 1] {
    [Output::new(
        "flank_pressure_MPa",
        "",
        MEGAPASCAL,
        Worse::Higher,
        "F1/(2 r_s h tan(a/2))",
        "Pressure of the flanks on the smaller pulley without friction along the radius; 1 to 2 is usual for rubber.",
    )
    .with_bound_factor(2.0)]
}

/// The model.
pub fn model() -> Model {
    let outputs = [output_table(), own_table().into()].concat();
    let mut conditions = condition_table(&outputs);
    // The last one is about an output of the metal belt.
    conditions.pop();
    Model {
        name: "rubber-cvt".into(),
        version: String::new(),
        summary: "Rubber V-belt variator: axial forces, stress and torque capacity".into(),
        source: "H. S. Kim, K. W. Kim: ratio, torque load and axial force of rubber and metal V-belt CVTs, eqs (1)-(5), (17)-(21)".into(),
        limits: "Gross slip of a rubber belt is not predicted: measured at a traction of 0.8, the model gives 0.985. The axial forces are lower \
             bounds, axial_force_upper_N and its like are the upper ones: size springs and bearings by these. Belt compression and shear, \
             the sliding angle, pulley bending and shift dynamics are neglected."
            .into(),
        inputs: vec![
            Input::new("friction", "mu", NONE, 0.4, (0.3, 0.5), "Coefficient of friction between belt and pulley.", PAPER),
            groove_angle(30.0, (22.0, 36.0), PAPER),
            ratio((0.5, 2.5), PAPER),
            Input::new("belt_length_mm", "L", MILLIMETRE, 1066.0, (300.0, 3000.0), "Pitch length of the belt.", PAPER),
            Input::new("centre_distance_mm", "A", MILLIMETRE, 260.0, (80.0, 1000.0), "Distance of the pulley axes.", PAPER),
            Input::new("belt_width_mm", "b", MILLIMETRE, 50.0, (10.0, 100.0), "Width of the belt.", PAPER),
            Input::new("belt_thickness_mm", "h", MILLIMETRE, 10.0, (1.0, 20.0), "Thickness of the belt.", "chosen; not printed"),
            Input::new("elastic_modulus_MPa", "E", MEGAPASCAL, 600.0, (50.0, 5000.0), "Modulus of elasticity along the belt.", PAPER),
            Input::new("strength_MPa", "sigma_y", MEGAPASCAL, 18.0, (1.0, 200.0), "Largest permissible stress.", PAPER),
            traction(0.8, "slip measured in the paper"),
            torque(50.0, (1.0, 500.0)),
            clamping_force((500.0, 10_000.0)),
            driver_speed(),
            belt_mass((0.0, 1.0)),
            Input::new(
                "bending_modulus_MPa",
                "E_b",
                MEGAPASCAL,
                ELASTIC_MODULUS,
                (10.0, 1000.0),
                "Modulus of elasticity in bending: far below that of the pull where cogs are cut and the cords lie near the neutral layer; \
                 \"elastic-modulus\": the same as along the belt.",
                "paper: one modulus",
            )
            .with_words(&[("elastic-modulus", ELASTIC_MODULUS)])
            .following("elastic_modulus_MPa"),
        ],
        outputs,
        conditions,
        presets: vec![
            Preset::new("paper", &[]).about("the wide belt of the paper's test rig; the defaults"),
            // 20 mm wide at the top, 9 mm high, 30 degrees: 158 mm2 of 1300 kg/m3, a quarter less for the cogs.
            Preset::new(
                "cogged-variable-speed",
                &[
                    ("belt_length_mm", 835.0),
                    ("centre_distance_mm", 255.0),
                    ("belt_width_mm", 20.0),
                    ("belt_thickness_mm", 9.0),
                    ("bending_modulus_MPa", 60.0),
                    ("belt_mass_kg_per_m", 0.155),
                ],
            )
            .about(
                "a cogged belt of the size 835-20-30 that scooters of 125 to 150 cm3 have, 9 mm high. Mass: section times 1300 kg/m3, a \
                 quarter less for the cogs. Assumed: centre distance, and a bending modulus of a tenth of the elastic one",
            ),
        ],
        starter: include_str!("../../studies/rubber-cvt.toml").into(),
        kernel: Arc::new(Cvt(RubberBelt)),
        pulley: None,
        origin: None,
        profile: None,
        notes: None,
        remarks: None,
        doubts: None,
        effort: Effort { prepare: 5e-7, finish: 3e-9 },
        sample: SAMPLE,
        on_gpu: true,
    }
}

pub(super) struct RubberBelt;

impl Belt for RubberBelt {
    const INPUT_NAMES: &'static [&'static str] = Inputs::<usize>::NAMES;
    const OUTPUT_NAMES: &'static [&'static str] = &with_own::<{ COMMON + 1 }>(&["flank_pressure"]);

    #[inline(always)]
    fn drive<R: Real>(inputs: &[R]) -> Drive<R> {
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
            bending_modulus: R::select(i.bending_modulus, i.bending_modulus, i.elastic_modulus),
            traction: i.traction,
            torque: i.torque,
            clamping_force: i.clamping_force,
            driver_speed: i.driver_speed,
            belt_mass: i.belt_mass,
        }
    }

    #[inline(always)]
    fn own_outputs<R: Real>(p: &Prepared<R>, belt: &Drive<R>, wanted: Set, out: &mut [R]) {
        let out = &mut out[..COMMON + 1];
        if wanted.contains(COMMON) {
            let two = R::constant(2.0);
            let tight_force = force_sum(p, belt) * (R::constant(1.0) + p.traction) / two;
            out[COMMON] = tight_force * p.unsupported / (two * p.smaller_radius * belt.thickness);
        }
    }
}
