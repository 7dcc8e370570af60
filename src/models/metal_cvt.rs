//! Metal push-belt variator. The formula is [`super::cvt`]'s, with two packs of n bands of width b and thickness h.

use super::cvt::{
    Belt, COMMON, Cvt, Drive, LIMIT, Prepared, belt_mass, belt_width, clamping_force, condition_table, driver_speed, groove_angle,
    output_table, printed_torque_coefficient, ratio, torque, traction, with_own,
};
use super::description::{Effort, Input, Output, SAMPLE, Worse};
use super::formula::record;
use super::model::Model;
use crate::real::Real;
use crate::tape::Set;
use crate::units::{MEGAPASCAL, MILLIMETRE, NEWTON_PER_MILLIMETRE, NONE};
use std::sync::Arc;

record! {
    /// Inputs in the order of the table.
    pub(super) Inputs {
        friction, groove_angle, ratio, belt_length, centre_distance, band_width, band_thickness, band_count, elastic_modulus,
        strength, traction, torque, clamping_force, driver_speed, belt_mass,
    }
}

const PAPER: &str = "paper, test rig";

/// Outputs that only this belt has, behind those of either belt.
fn own_table() -> [Output; 2] {
    [
        Output::new(
            "printed_torque_coefficient_N_per_mm",
            "C_M",
            NEWTON_PER_MILLIMETRE,
            Worse::Lower,
            "(28)",
            "The metal belt's constant as printed: too large if the entry compression is negative.",
        )
        .with_bound_factor(2.0),
        Output::new(
            "entry_compression",
            "P1/P2",
            NONE,
            Worse::Lower,
            "1 - (x-1)(e-1)",
            "Block compression at the entry that (28) implies: a negative value is not physical; 0 only at the slip limit.",
        )
        .with_bound_factor(2.0),
    ]
}

/// The model.
pub fn model() -> Model {
    let outputs = [output_table(), own_table().into()].concat();
    Model {
        name: "metal-cvt".into(),
        version: String::new(),
        summary: "Metal push-belt variator: axial forces, stress and torque capacity".into(),
        source: "H. S. Kim, K. W. Kim: ratio, torque load and axial force of rubber and metal V-belt CVTs, eqs (6)-(16), (22)-(28)".into(),
        limits: "The belt is taken to be self-locked on the driver, which holds for friction > tan(groove_angle/2) and so only weakly \
             for metal belts: the axial forces are lower bounds, axial_force_upper_N and its like are the upper ones; size hydraulics and \
             bearings by these. Bands that carry torque, the sliding angle, lubrication, pulley bending and shift dynamics are neglected."
            .into(),
        inputs: vec![
            Input::new("friction", "mu", NONE, 0.08, (0.05, 0.14), "Coefficient of friction between blocks and pulley.", PAPER),
            groove_angle(22.0, (18.0, 30.0), "paper; 11 degrees a side is standard"),
            ratio((0.4, 2.5), PAPER),
            Input::new("belt_length_mm", "L", MILLIMETRE, 613.0, (300.0, 1200.0), "Pitch length of the belt.", PAPER),
            Input::new("centre_distance_mm", "A", MILLIMETRE, 156.0, (80.0, 300.0), "Distance of the pulley axes.", PAPER),
            Input::new("band_width_mm", "b", MILLIMETRE, 9.0, (5.0, 20.0), "Width of a band.", PAPER),
            Input::new("band_thickness_mm", "h", MILLIMETRE, 0.2, (0.1, 0.4), "Thickness of a band.", PAPER),
            Input {
                integer: true,
                ..Input::new(
                    "band_count",
                    "n",
                    NONE,
                    10.0,
                    (4.0, 14.0),
                    "Bands in each of the two packs.",
                    "paper; a series car of the time has 10",
                )
            },
            Input::new("elastic_modulus_MPa", "E", MEGAPASCAL, 2.1e5, (1.8e5, 2.2e5), "Modulus of elasticity of the bands.", PAPER),
            Input::new("strength_MPa", "sigma_y", MEGAPASCAL, 500.0, (200.0, 2200.0), "Largest permissible stress of a band.", PAPER),
            traction(LIMIT, "chosen: squeezed just enough"),
            torque(100.0, (10.0, 500.0)),
            clamping_force((10_000.0, 50_000.0)),
            driver_speed(),
            belt_mass((0.0, 2.0)),
        ],
        conditions: condition_table(&outputs),
        outputs,
        presets: Vec::new(),
        starter: include_str!("../../studies/metal-cvt.toml").into(),
        kernel: Arc::new(Cvt(MetalBelt)),
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

pub(super) struct MetalBelt;

impl Belt for MetalBelt {
    const INPUT_NAMES: &'static [&'static str] = Inputs::<usize>::NAMES;
    const OUTPUT_NAMES: &'static [&'static str] = &with_own::<{ COMMON + 2 }>(&["printed_torque_coefficient", "entry_compression"]);

    #[inline(always)]
    fn drive<R: Real>(inputs: &[R]) -> Drive<R> {
        let i = Inputs::read(inputs);
        Drive {
            friction: i.friction,
            groove_angle: i.groove_angle,
            ratio: i.ratio,
            belt_length: i.belt_length,
            centre_distance: i.centre_distance,
            width: i.band_width,
            thickness: i.band_thickness,
            sections: R::constant(2.0) * i.band_count,
            elastic_modulus: i.elastic_modulus,
            strength: i.strength,
            bending_modulus: i.elastic_modulus,
            traction: i.traction,
            torque: i.torque,
            clamping_force: i.clamping_force,
            driver_speed: i.driver_speed,
            belt_mass: i.belt_mass,
        }
    }

    #[inline(always)]
    fn own_outputs<R: Real>(p: &Prepared<R>, belt: &Drive<R>, wanted: Set, out: &mut [R]) {
        let out = &mut out[..COMMON + 2];
        if wanted.contains(COMMON) {
            let Drive { strength, elastic_modulus, .. } = *belt;
            out[COMMON] = printed_torque_coefficient(p.printed_pull, strength, elastic_modulus, p.free_ratio, belt_width(belt));
        }
        out[COMMON + 1] = p.entry_compression;
    }
}
