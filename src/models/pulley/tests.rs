//! Checks of the pulley model against the reference table and against hand calculations.

use super::super::evaluation::evaluate;
use super::super::status::Status;
use super::*;
use crate::models::{Model, find};
use std::sync::Arc;

/// The model.
fn pulley() -> Arc<Model> {
    find("pulley").expect("it is in the list")
}

fn with(changes: &[(&str, f64)]) -> Vec<f64> {
    let mut inputs = pulley().defaults();
    for (name, value) in changes {
        inputs[pulley().input(name).unwrap_or_else(|| panic!("{name}"))] = *value;
    }
    inputs
}

fn output(inputs: &[f64], name: &str) -> Option<f64> {
    evaluate(&pulley(), inputs).outputs[pulley().output(name).unwrap()]
}

#[test]
fn a_tightening_torque_gives_the_clamp_force() {
    let inputs = with(&[("clamp_force_N", fields::TORQUE)]);
    let si = super::super::evaluation::to_si(&pulley(), &inputs);
    // Physics, 3.1: M6, 10 N m, friction 0.15, washer 12/6.6.
    let force = design::clamp_force(&Inputs::read(&si));
    assert!((force - 7470.0).abs() < 5.0, "{force}");
}

#[test]
fn impossible_sections_and_loads_have_a_status_and_never_a_number() {
    let cases: [(&[(&str, f64)], usize); 9] = [
        (&[("slack_tension_N", 39.0)], 0),
        (&[("hub_bend_radius_mm", 1.7)], NO_SECTION),
        (&[("fold_radius_mm", 1.8)], NO_SECTION),
        (&[("web_bend_radius_mm", 20.0)], NO_SECTION),
        (&[("groove_count", 2.0)], NO_SECTION),
        (&[("contact_height_mm", 10.5)], BAND),
        (&[("bolt_circle_mm", 52.0)], SEAT),
        (&[("bracket_diameter_mm", 62.0)], SEAT),
        (&[("bore_diameter_mm", 36.0)], SEAT),
    ];
    for (changes, condition) in cases {
        let evaluation = evaluate(&pulley(), &with(changes));
        assert_eq!(evaluation.status, Status::failed(condition), "{changes:?}");
        for name in ["max_stress_MPa", "stress_Fl_MPa", "mass_g", "yield_safety"] {
            assert_eq!(evaluation.outputs[pulley().output(name).unwrap()], None, "{changes:?}: {name}");
        }
        if condition > 1 {
            let said = notes::notes(&pulley(), &with(changes), &evaluation);
            assert_eq!(said.len(), 1, "{changes:?}: one sentence says what is wrong");
        }
    }
}

#[test]
fn a_load_case_on_a_solved_section_is_the_same_as_one_of_its_own() {
    let si = |changes: &[(&str, f64)]| super::super::evaluation::to_si(&pulley(), &with(changes));
    let prepared = pulley().kernel.prepared(&si(&[]));
    let changes: &[(&str, f64)] =
        &[("power_kW", 2.0), ("wrap_angle_deg", 150.0), ("friction_direction_deg", 0.0), ("clamp_force_N", 5000.0)];
    let shared = pulley().kernel.outputs(&prepared, &si(changes), Set::ALL);
    let own = pulley().kernel.outputs(&pulley().kernel.prepared(&si(changes)), &si(changes), Set::ALL);
    assert_eq!(shared, own);
}

#[test]
fn the_worst_angle_of_the_bolts_is_no_better_than_any() {
    let worst = output(&with(&[("bolt_angle_deg", fields::ANGLE_WORST)]), "stress_Br_MPa").unwrap();
    let any = |angle: f64| output(&with(&[("bolt_angle_deg", angle)]), "stress_Br_MPa").unwrap();
    let largest = (0..12).map(|it| any(7.5 * f64::from(it))).fold(0.0, f64::max);
    assert!(worst >= largest - 1e-3 * largest && worst <= 1.01 * largest, "{worst} {largest}");
}

#[test]
fn a_point_of_ones_own_reads_the_stress_of_the_surface_there() {
    let [r, z] = ["max_stress_r_mm", "max_stress_z_mm"].map(|name| output(&with(&[]), name).unwrap());
    let inputs = with(&[("point_1_r_mm", r), ("point_1_z_mm", z)]);
    let (own, largest) = (output(&inputs, "stress_P1_MPa").unwrap(), output(&inputs, "max_stress_MPa").unwrap());
    assert!((own - largest).abs() < 1e-9 * largest, "{own} {largest}");
    assert_eq!(output(&inputs, "stress_P2_MPa"), None);
}

/// Names of the inputs that shape each type of section, as studies write them.
const SHAPE: [(&str, &[&str]); 4] = [
    (
        "machined",
        &[
            "thickness_mm",
            "bore_diameter_mm",
            "cup_diameter_mm",
            "wall_thickness_mm",
            "rim_thickness_mm",
            "lip_thickness_mm",
            "fillet_radius_mm",
            "groove_offset_mm",
            "groove_width_mm",
            "groove_height_mm",
            "floor_depth_mm",
            "floor_bend_radius_mm",
            "rim_height_mm",
        ],
    ),
    (
        "welded-discs",
        &[
            "thickness_mm",
            "bore_diameter_mm",
            "hub_bend_radius_mm",
            "weld_diameter_mm",
            "groove_width_mm",
            "groove_height_mm",
            "rim_height_mm",
        ],
    ),
    (
        "double-groove",
        &[
            "thickness_mm",
            "bore_diameter_mm",
            "cup_diameter_mm",
            "wall_diameter_mm",
            "wall_offset_mm",
            "hub_bend_radius_mm",
            "web_bend_radius_mm",
            "fold_radius_mm",
            "ridge_width_mm",
            "groove_width_mm",
            "groove_height_mm",
            "floor_depth_mm",
            "floor_bend_radius_mm",
            "rim_height_mm",
        ],
    ),
    (
        "pressed-cup",
        &[
            "thickness_mm",
            "bore_diameter_mm",
            "cup_diameter_mm",
            "wall_diameter_mm",
            "wall_offset_mm",
            "hub_bend_radius_mm",
            "web_bend_radius_mm",
            "fold_radius_mm",
            "groove_width_mm",
            "groove_height_mm",
            "floor_depth_mm",
            "floor_bend_radius_mm",
            "rim_height_mm",
        ],
    ),
];

/// Names of all other inputs, which every type reads.
const COMMON: [&str; 38] = [
    "power_kW",
    "speed_rpm",
    "tensioning",
    "slack_tension_N",
    "installed_tension_N",
    "wrap_angle_deg",
    "mean_radius_mm",
    "groove_angle_deg",
    "groove_count",
    "belt_mass_kg_per_m",
    "friction_limit",
    "friction_direction_deg",
    "section",
    "accuracy",
    "contact_height_mm",
    "bracket_diameter_mm",
    "bolt_count",
    "bolt_circle_mm",
    "bolt_hole_mm",
    "bolt_head_mm",
    "bolt_angle_deg",
    "clamp_force_N",
    "tightening_torque_Nm",
    "bolt_friction",
    "bolt_pitch_mm",
    "bolt_pitch_diameter_mm",
    "bolt_proof_strength_MPa",
    "joint_friction",
    "elastic_modulus_MPa",
    "poisson_ratio",
    "density_kg_per_m3",
    "yield_strength_MPa",
    "tensile_strength_MPa",
    "endurance_limit_MPa",
    "point_1_r_mm",
    "point_1_z_mm",
    "point_2_r_mm",
    "point_2_z_mm",
];

/// Does this type of section read the input?
fn of_type(input: &crate::models::Input, kind: &str) -> bool {
    input.only_for.as_ref().is_none_or(|it| it.input != "section" || it.words.iter().any(|word| word == kind))
}

#[test]
fn the_inputs_of_each_type_keep_their_names() {
    for (kind, shape) in SHAPE {
        let model = pulley();
        let read = model.inputs.iter().filter(|input| of_type(input, kind));
        let mut read: Vec<&str> = read.map(|input| input.name.as_str()).collect();
        let mut expected: Vec<&str> = COMMON.iter().chain(shape).copied().collect();
        read.sort_unstable();
        expected.sort_unstable();
        assert_eq!(read, expected, "{kind}");
    }
}

#[test]
fn a_type_is_shaped_by_the_inputs_it_says_and_by_no_other() {
    let shaped = |inputs: &[f64]| {
        let si = super::super::evaluation::to_si(&pulley(), inputs);
        let (kind, dimensions) = (design::kind(&si), design::dimensions(&si));
        let outline = section::checked_outline(kind, &dimensions).expect("a preset and what is near it");
        // The weld does not show in the outline.
        let mesh = (kind == SectionKind::WeldedDiscs).then(|| section::mesh(kind, &dimensions, &section::Fineness::USUAL));
        (outline, mesh)
    };
    let any: std::collections::BTreeSet<&str> = SHAPE.iter().flat_map(|(_, shape)| *shape).copied().collect();
    for (kind, shape) in SHAPE {
        let preset = pulley().preset(kind).expect("each type has one");
        let before = shaped(&preset);
        for &name in &any {
            let mut inputs = preset.clone();
            inputs[pulley().input(name).expect("an input")] *= 1.001;
            assert_eq!(shaped(&inputs) != before, shape.contains(&name), "{kind}: {name}");
        }
    }
}
