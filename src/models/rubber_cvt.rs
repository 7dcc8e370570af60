//! Rubber V-belt variator. The formula is [`super::cvt`]'s, with one belt section of width b and thickness h.

use super::cvt::{Belt, Cvt, Drive, condition_table, groove_angle, output_table, ratio, torque, traction};
use super::description::{Condition, Effort, Input, Output, SAMPLE};
use super::formula::record;
use super::model::Model;
use crate::real::Real;
use crate::units::{MEGAPASCAL, MILLIMETRE, NONE};
use std::sync::Arc;

record! {
    /// Inputs in the order of the table.
    pub(super) Inputs {
        friction, groove_angle, ratio, belt_length, centre_distance, belt_width, belt_thickness, elastic_modulus, strength,
        traction, torque,
    }
}

const PAPER: &str = "paper, test rig";

/// The belts' tables without what the metal belt alone has: its last two outputs and the condition for the last of them.
fn own_tables() -> (Vec<Output>, Vec<Condition>) {
    let (mut outputs, mut conditions) = (output_table(), condition_table());
    let of_metal = outputs.split_off(outputs.len() - 2);
    conditions.pop();
    for condition in &mut conditions {
        condition.invalidates.retain(|name| of_metal.iter().all(|output| output.name != *name));
    }
    (outputs, conditions)
}

/// The model.
pub fn model() -> Model {
    let (outputs, conditions) = own_tables();
    Model {
        name: "rubber-cvt".into(),
        version: String::new(),
        summary: "Rubber V-belt variator: axial forces, stress and torque capacity".into(),
        source: "H. S. Kim, K. W. Kim: ratio, torque load and axial force of rubber and metal V-belt CVTs, eqs (1)-(5), (17)-(21)".into(),
        limits: "Gross slip of a rubber belt is not predicted: measured at a traction of 0.8, the model gives 0.985. Centrifugal force, \
             belt compression and shear, the sliding angle, pulley bending and shift dynamics are neglected."
            .into(),
        inputs: vec![
            Input::new("friction", "mu", NONE, 0.4, (0.3, 0.5), "Coefficient of friction between belt and pulley.", PAPER),
            groove_angle(30.0, (22.0, 36.0), PAPER),
            ratio((0.5, 2.5), PAPER),
            Input::new("belt_length_mm", "L", MILLIMETRE, 1066.0, (300.0, 3000.0), "Pitch length of the belt.", PAPER),
            Input::new("centre_distance_mm", "A", MILLIMETRE, 260.0, (80.0, 1000.0), "Distance of the pulley axes.", PAPER),
            Input::new("belt_width_mm", "b", MILLIMETRE, 50.0, (10.0, 100.0), "Width of the belt.", PAPER),
            Input::new("belt_thickness_mm", "h", MILLIMETRE, 10.0, (1.0, 20.0), "Thickness of the belt.", PAPER),
            Input::new("elastic_modulus_MPa", "E", MEGAPASCAL, 600.0, (50.0, 5000.0), "Modulus of elasticity along the belt.", PAPER),
            Input::new("strength_MPa", "sigma_y", MEGAPASCAL, 18.0, (1.0, 200.0), "Largest permissible stress.", PAPER),
            traction(0.8, "slip measured in the paper"),
            torque(50.0, (1.0, 500.0)),
        ],
        outputs,
        conditions,
        presets: Vec::new(),
        starter: include_str!("../../studies/rubber-cvt.toml").into(),
        kernel: Arc::new(Cvt(RubberBelt)),
        pulley: None,
        origin: None,
        profile: None,
        notes: None,
        remarks: None,
        effort: Effort { prepare: 5e-7, finish: 3e-9 },
        sample: SAMPLE,
        on_gpu: true,
    }
}

pub(super) struct RubberBelt;

impl Belt for RubberBelt {
    const INPUT_NAMES: &'static [&'static str] = Inputs::<usize>::NAMES;

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
            traction: i.traction,
            torque: i.torque,
        }
    }
}
