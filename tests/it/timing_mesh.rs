//! The timing belt compared with the paper's figures and closed forms.

use crate::physics::{Region, draw};
use crate::random::Random;
use crate::second::timing_belt::{
    CALIBRATED, OHC_DRIVEN, OHC_DRIVER, TRENDS, closed_boundary, closed_complete, closed_incomplete, printed_boundary, profile,
};
use beltspace::models::{Model, Preset, evaluate, find};
use std::collections::BTreeMap;
use std::sync::Arc;

fn model() -> Arc<Model> {
    find("timing-belt").expect("it is a model")
}

/// The defaults with these changes, in their units.
fn inputs(changes: &[(&str, f64)]) -> Vec<f64> {
    let mut inputs = model().defaults();
    for (name, value) in changes {
        inputs[model().input(name).expect("it is an input")] = *value;
    }
    inputs
}

fn output(inputs: &[f64], name: &str) -> f64 {
    evaluate(&model(), inputs).outputs[model().output(name).expect("it is an output")].unwrap_or_else(|| panic!("{name} of {inputs:?}"))
}

/// A column of the per-tooth profile.
fn column(inputs: &[f64], name: &str) -> Vec<f64> {
    let profile = model().along_the_belt(inputs).expect("it has one");
    let at = profile.columns.iter().position(|column| column.name == name).expect("it is a column");
    profile.rows.iter().map(|row| row[at]).collect()
}

/// As the second implementation takes them.
fn by_name(inputs: &[f64]) -> BTreeMap<String, f64> {
    let model = model();
    let numbers = model.inputs.iter().zip(inputs).filter(|(input, value)| input.word_for(**value).is_none());
    numbers.map(|(input, &value)| (input.name.to_owned(), value)).collect()
}

#[test]
fn the_presets_are_the_belts_of_the_specification() {
    let given: BTreeMap<_, _> = OHC_DRIVEN.iter().copied().collect();
    for (input, value) in model().inputs.iter().zip(model().defaults()) {
        assert!(input.word_for(value).is_some() || given[input.name.as_str()] == value, "{} = {value}", input.name);
    }
    let preset = |name: &str| model().presets.iter().find(|it| it.name == name).expect("it is a preset").changes.clone();
    assert!(preset("ohc-driven").is_empty());
    assert_eq!(Preset::new("ohc-driver", OHC_DRIVER).changes, preset("ohc-driver"));
}

#[test]
fn the_boundary_moves_as_in_the_figures() {
    for (changes, j) in CALIBRATED {
        assert_eq!(output(&inputs(changes), "boundary_tooth"), *j, "{changes:?}");
    }
    for trend in TRENDS {
        let position = |changes| output(&inputs(changes), "boundary_position");
        assert!(position(trend.later) > position(trend.earlier), "{} ({})", trend.what, trend.source);
    }
    // Fig. 9: loads rise a little before the boundary and fall behind it.
    let (complete, incomplete) = (column(&inputs(&[]), "tooth_load_complete_N"), column(&inputs(&[]), "tooth_load_N"));
    for (at, (complete, incomplete)) in complete.iter().zip(incomplete).enumerate() {
        let change = incomplete / complete - 1.0;
        let (low, high) = if at + 1 < 16 { (0.017, 0.036) } else { (-0.112, -0.108) };
        assert!((low..high).contains(&change), "tooth {}: {change}", at + 1);
    }
    // Fig. 8: at rest the driven pulley's teeth carry less than the driver's.
    let at_rest = [("pulley_speed_rpm", 0.0), ("tight_tension_N", 490.0)];
    let driver: Vec<_> = OHC_DRIVER.iter().copied().chain(at_rest).collect();
    let most = column(&inputs(&at_rest), "tooth_load_N").into_iter().fold(0.0, f64::max);
    let least = column(&inputs(&driver), "tooth_load_N").into_iter().fold(f64::INFINITY, f64::min);
    assert!(most < least, "driven {most}, driver {least}");
}

#[test]
fn tension_speed_and_mass_move_the_boundary_one_way_only() {
    let random = &mut Random::new(81);
    for _ in 0..500 {
        let mut belt = draw(&model(), Region::Usual, random);
        let at = |name: &str| model().input(name).expect("it is an input");
        belt[at("slack_tension_N")] = 0.0;
        belt[at("lift_angle_deg")] = -1.0;
        let mut last = f64::INFINITY;
        for speed in [0.0, 1000.0, 3000.0, 5000.0, 7000.0, 10_000.0] {
            belt[at("pulley_speed_rpm")] = speed;
            let position = output(&belt, "boundary_position");
            assert!(position <= last, "{belt:?}");
            last = position;
        }
        for (name, towards_slack) in [("tight_tension_N", true), ("pitch_mass_g", false)] {
            let mut other = belt.clone();
            other[at(name)] *= 1.3;
            let (before, after) = (output(&belt, "boundary_position"), output(&other, "boundary_position"));
            assert!(if towards_slack { after >= before } else { after <= before }, "{name}: {belt:?}");
        }
    }
}

#[test]
fn without_slack_tension_the_boundary_depends_on_one_ratio() {
    let random = &mut Random::new(82);
    let at = |name: &str| model().input(name).expect("it is an input");
    for _ in 0..2000 {
        let mut belt = draw(&model(), Region::Usual, random);
        belt[at("slack_tension_N")] = 0.0;
        let (before, position) = (output(&belt, "boundary_tooth"), output(&belt, "boundary_position"));
        // m r omega^2 / T_t stays: r, which the elastic mesh depends on too, is left alone. Powers of two round nothing.
        belt[at("pulley_speed_rpm")] *= 2.0;
        belt[at("tight_tension_N")] *= 2.0;
        belt[at("pitch_mass_g")] /= 2.0;
        assert_eq!(output(&belt, "boundary_tooth"), before, "{belt:?}");
        assert!((output(&belt, "boundary_position") - position).abs() <= 1e-9 * position, "{belt:?}");
    }
    let mut belt = inputs(&[("slack_tension_N", 20.0)]);
    let position = output(&belt, "boundary_position");
    belt[at("pulley_speed_rpm")] *= 2.0;
    belt[at("tight_tension_N")] *= 4.0;
    assert!((output(&belt, "boundary_position") - position).abs() > 1e-3, "with slack tension the law must not hold");
}

#[test]
fn the_closed_forms_are_the_tensions_of_the_system() {
    let random = &mut Random::new(83);
    let at = |name: &str| model().input(name).expect("it is an input");
    let (mut met, mut worst) = (0, 0.0f64);
    for _ in 0..20_000 {
        let mut belt = draw(&model(), Region::Usual, random);
        belt[at("centrifugal_land_friction")] = 0.0;
        let (tight, slack) = (belt[at("tight_tension_N")], belt[at("slack_tension_N")]);
        if slack >= tight || belt[at("lift_angle_deg")] > belt[at("space_half_angle_deg")] {
            continue;
        }
        let named = by_name(&belt);
        let mut compare = |own: &[f64], closed: &[f64]| {
            assert_eq!(own.len(), closed.len());
            for (own, closed) in own.iter().zip(closed) {
                let error = (own - closed).abs() / tight;
                assert!(error < 1e-9, "{own} is {closed} in closed form: {belt:?}");
                worst = worst.max(error);
            }
        };
        compare(&column(&belt, "tension_complete_N"), &closed_complete(&named));
        let j = output(&belt, "boundary_tooth") as usize;
        if (3..=belt[at("teeth_in_mesh")] as usize).contains(&j) {
            met += 1;
            compare(&column(&belt, "tension_N"), &closed_incomplete(&named, j));
            compare(&[output(&belt, "boundary_tension_N")], &[closed_boundary(&named, j)]);
        }
    }
    eprintln!("{met} boundaries, worst difference {worst:.1e} of the tight tension");
    assert!(met > 500, "{met}");
}

#[test]
fn the_printed_boundary_tension_is_too_low() {
    let printed = printed_boundary(&by_name(&inputs(&[])), 16);
    let ratio = printed / output(&inputs(&[]), "boundary_tension_N") - 1.0;
    assert!((ratio + 0.023).abs() < 5e-4, "{ratio}: the repair of (17)-(19) is worth 2.3 %");
}

#[test]
fn every_tooth_is_as_in_the_second_implementation() {
    let random = &mut Random::new(85);
    let mut teeth = 0;
    for _ in 0..1500 {
        let belt = draw(&model(), random.pick(&[Region::Usual, Region::Edges, Region::Wide]), random);
        if evaluate(&model(), &belt).status != beltspace::models::Status::Ok {
            continue;
        }
        let tight = belt[model().input("tight_tension_N").expect("it is an input")];
        let columns =
            ["tension_complete_N", "tension_N", "tooth_load_complete_N", "tooth_load_N", "margin_N"].map(|name| column(&belt, name));
        for (at, tooth) in profile(&by_name(&belt)).iter().enumerate() {
            let expected = [tooth.complete_tension, tooth.incomplete_tension, tooth.complete_load, tooth.incomplete_load, tooth.margin];
            for (column, expected) in columns.iter().zip(expected) {
                // Far beyond the usual speeds the margin is as large as the centrifugal force.
                assert!(
                    (column[at] - expected).abs() <= 1e-9 * tight.max(expected.abs()),
                    "tooth {}: {} {expected}: {belt:?}",
                    at + 1,
                    column[at]
                );
            }
            teeth += 1;
        }
    }
    assert!(teeth > 5000, "{teeth}");
}

#[test]
fn the_profile_says_what_the_outputs_say() {
    let random = &mut Random::new(84);
    let mut lifted = 0;
    for _ in 0..2000 {
        let belt = draw(&model(), random.pick(&[Region::Usual, Region::Edges]), random);
        let evaluation = evaluate(&model(), &belt);
        if evaluation.status != beltspace::models::Status::Ok {
            continue;
        }
        let most = |values: Vec<f64>| values.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let close = |a: f64, b: f64, name: &str| {
            assert!((a - b).abs() <= 1e-9 * most(column(&belt, "tooth_load_complete_N")).abs(), "{name}: {a}, {b}: {belt:?}")
        };
        let loads = column(&belt, "tooth_load_N");
        close(loads.iter().copied().fold(f64::INFINITY, f64::min), output(&belt, "least_tooth_load_N"), "least load");
        close(most(loads), output(&belt, "peak_tooth_load_N"), "peak load");
        close(most(column(&belt, "tooth_load_complete_N")), output(&belt, "peak_tooth_load_complete_N"), "peak load, complete");
        let j = output(&belt, "boundary_tooth") as usize;
        let first = column(&belt, "margin_N").iter().position(|margin| *margin < 0.0);
        assert_eq!(first.map_or(column(&belt, "margin_N").len() + 1, |at| at + 1), j, "{belt:?}");
        lifted += usize::from(first.is_some());
    }
    assert!(lifted > 200, "{lifted}");
}

#[test]
fn the_outermost_contour_of_the_map_is_the_lift_speed() {
    let text =
        std::fs::read_to_string(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/timing-map.toml")).expect("it is shipped");
    let study = beltspace::study::Study::parse_in(&text, "timing-map.toml", std::path::Path::new(".")).expect("it is right");
    let plan = beltspace::plan::Plan::new(study);
    let contours = beltspace::contours::contours(&plan, &plan.study.report.maps[0], 2);
    let outermost = contours.last().expect("the map asks for contours");
    assert_eq!(outermost.at, 24.0, "beyond it no tooth of 23 lifts");
    let vertices: Vec<_> = outermost.lines.iter().flatten().collect();
    assert!(vertices.len() > 100, "{}", vertices.len());
    for vertex in vertices {
        let lift_speed = output(&inputs(&[("tight_tension_N", vertex.y)]), "lift_speed_rpm");
        // A tension that is off by half a bracket moves the speed by half as much, relatively.
        let bracket = vertex.bracket * if vertex.along == beltspace::contours::Along::X { 1.0 } else { vertex.x / vertex.y };
        assert!((vertex.x - lift_speed).abs() <= bracket, "{vertex:?}: lifts at {lift_speed}");
        assert!(bracket < 1e-4, "{vertex:?}");
    }
}
