//! The timing belt compared with the paper's figures and closed forms.

use crate::physics::{Region, draw};
use crate::random::Random;
use crate::second::timing_belt::{closed_boundary, closed_complete, closed_incomplete, printed_boundary, profile};
use crate::second::timing_data::{CALIBRATED, CAR_BELT, OHC_DRIVEN, OHC_DRIVER, TRENDS};
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

/// Random inputs of a pulley that has as many lands and spaces as teeth in mesh. Its pitch mass is a number, so that it can be changed.
fn around_a_pulley(region: Region, random: &mut Random) -> Vec<f64> {
    let model = model();
    let at = |name: &str| model.input(name).expect("it is an input");
    loop {
        let mut belt = draw(&model, region, random);
        if belt[at("teeth_in_mesh")] * 2.0 * (belt[at("land_half_angle_deg")] + belt[at("space_half_angle_deg")]) <= 360.0 {
            let mass = &mut belt[at("pitch_mass_g")];
            *mass = if *mass < 0.0 { 0.4 } else { *mass };
            return belt;
        }
    }
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
    let sorted = |mut changes: Vec<(String, f64)>| {
        changes.sort_by(|a, b| a.0.cmp(&b.0));
        changes
    };
    assert_eq!(sorted(Preset::new("car-belt", CAR_BELT).changes), sorted(preset("car-belt")));
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
        let mut belt = around_a_pulley(Region::Usual, random);
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
        let mut belt = around_a_pulley(Region::Usual, random);
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
        let mut belt = around_a_pulley(Region::Usual, random);
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

#[test]
fn the_torque_is_the_pull_at_the_pitch_line_and_the_belt_brings_the_power_that_the_pulley_gives() {
    let random = &mut Random::new(86);
    let at = |name: &str| model().input(name).expect("it is an input");
    for _ in 0..2000 {
        let belt = around_a_pulley(Region::Usual, random);
        let torque = output(&belt, "torque_Nm");
        // Power of the two spans at the speed of the pitch line against that of the shaft.
        let shaft = belt[at("pulley_speed_rpm")] / 60.0 * std::f64::consts::TAU;
        let speed = shaft * (belt[at("tip_radius_mm")] + belt[at("pitch_line_mm")]) / 1000.0;
        let spans = speed * belt[at("tight_tension_N")] - speed * belt[at("slack_tension_N")];
        assert!((torque * shaft - spans).abs() <= 1e-12 * speed * belt[at("tight_tension_N")], "{belt:?}");
        let changed = |name: &str, factor: f64| {
            let mut other = belt.clone();
            other[at(name)] *= factor;
            output(&other, "torque_Nm")
        };
        assert!(changed("tight_tension_N", 1.1) > torque, "{belt:?}");
        for grows in ["tip_radius_mm", "pitch_line_mm"] {
            assert_eq!(changed(grows, 1.1) > torque, torque > 0.0, "{grows}: {belt:?}");
        }
        for nothing in ["pulley_speed_rpm", "friction", "pitch_mass_g", "tooth_compliance_um_per_N", "pitch_mm"] {
            assert_eq!(changed(nothing, 1.1).to_bits(), torque.to_bits(), "{nothing}: {belt:?}");
        }
        let mut at_the_tips = belt.clone();
        at_the_tips[at("pitch_line_mm")] = 0.0;
        let pull = output(&belt, "effective_tension_N");
        assert_eq!(output(&at_the_tips, "torque_Nm"), pull * (belt[at("tip_radius_mm")] / 1000.0));
    }
}

#[test]
fn a_pitch_mass_from_the_belt_is_that_mass_as_a_number() {
    const OF_THE_BELT: [&str; 6] =
        ["belt_width_mm", "tooth_area_mm2", "land_area_mm2", "gross_cord_area_mm2", "rubber_density_kg_per_m3", "cord_density_kg_per_m3"];
    let random = &mut Random::new(87);
    let at = |name: &str| model().input(name).expect("it is an input");
    let mut moved = 0;
    for _ in 0..1000 {
        let mut belt = around_a_pulley(random.pick(&[Region::Usual, Region::Wide]), random);
        let given = evaluate(&model(), &belt);
        // In grams but for the rounding of the way to kilograms and back.
        let given_mass = belt[at("pitch_mass_g")];
        assert!((output(&belt, "pitch_mass_used_g") - given_mass).abs() <= 4e-16 * given_mass);
        for name in OF_THE_BELT {
            let mut other = belt.clone();
            other[at(name)] *= 1.7;
            assert_eq!(evaluate(&model(), &other).outputs, given.outputs, "{name} is read though the mass is given: {belt:?}");
        }
        belt[at("pitch_mass_g")] = model().inputs[at("pitch_mass_g")].value_of("from-belt").expect("it is a word");
        let mass = output(&belt, "pitch_mass_used_g");
        let mut same = belt.clone();
        same[at("pitch_mass_g")] = mass;
        let (own, same) = (evaluate(&model(), &belt), evaluate(&model(), &same));
        for (number, (own, same)) in own.outputs.iter().zip(&same.outputs).enumerate() {
            let close = match (own, same) {
                (Some(own), Some(same)) => (own - same).abs() <= 1e-11 * own.abs().max(1e-6),
                (own, same) => own == same,
            };
            assert!(close, "{}: {own:?} {same:?} {belt:?}", model().outputs[number].name);
        }
        // Of twice the width there is twice the rubber, of twice the densities twice the mass; each part adds some.
        for name in OF_THE_BELT {
            let mut other = belt.clone();
            other[at(name)] *= 2.0;
            let heavier = output(&other, "pitch_mass_used_g");
            assert!(heavier > mass && heavier < 2.0 * mass, "{name}: {belt:?}");
            let (before, after) = (evaluate(&model(), &belt), evaluate(&model(), &other));
            let position = model().output("boundary_position").expect("it is an output");
            if let (Some(before), Some(after)) = (before.outputs[position], after.outputs[position]) {
                assert!(after <= before, "{name}: a heavier belt lifts earlier: {belt:?}");
                moved += usize::from(after < before);
            }
        }
        let mut twice = belt.clone();
        for name in ["rubber_density_kg_per_m3", "cord_density_kg_per_m3"] {
            twice[at(name)] *= 2.0;
        }
        assert!((output(&twice, "pitch_mass_used_g") - 2.0 * mass).abs() <= 1e-14 * mass);
        // Rubber without cords, and cords without rubber.
        let without = |nothing: &[&str]| {
            let mut part = belt.clone();
            for name in nothing {
                part[at(name)] = 0.0;
            }
            output(&part, "pitch_mass_used_g")
        };
        let parts = [without(&["gross_cord_area_mm2"]), without(&["tooth_area_mm2", "land_area_mm2"])];
        assert!((parts[0] + parts[1] - mass).abs() <= 1e-14 * mass, "{belt:?}");
    }
    assert!(moved > 300, "{moved}");
}

#[test]
fn more_than_a_turn_is_a_status() {
    // 40 pitches of 9 degrees are one turn. Numbers whose sum is exact leave no doubt on which side it lies.
    let on = |teeth: f64, land: f64| inputs(&[("teeth_in_mesh", teeth), ("land_half_angle_deg", land), ("space_half_angle_deg", 3.0)]);
    let model = model();
    let status = |belt: &[f64]| evaluate(&model, belt).status.reason(&model).to_owned();
    assert_eq!([status(&on(39.0, 1.5)), status(&on(40.0, 1.499)), status(&on(40.0, 1.501))], ["ok", "ok", "wrap exceeds 360 degrees"]);
    let beyond = evaluate(&model, &on(41.0, 1.5));
    for (output, value) in model.outputs.iter().zip(&beyond.outputs) {
        let stands = ["centrifugal_force_N", "effective_tension_N", "torque_Nm", "pitch_mass_used_g"].contains(&output.name.as_str());
        assert_eq!(value.is_some(), stands, "{}", output.name);
    }
}

#[test]
fn a_pulley_that_does_not_fit_the_belt_is_told() {
    let notes = |belt: &[f64]| model().notes_on(belt, &evaluate(&model(), belt));
    let told = |belt: &[f64]| {
        let doubts = model().doubts_on(belt);
        assert!(notes(belt).starts_with(&doubts));
        doubts
    };
    for preset in &model().presets {
        assert!(told(&model().preset(&preset.name).expect("it is one")).is_empty(), "{}", preset.name);
    }
    // The default belt's pulley has a pitch of 9.569 mm.
    for (pitch, off) in
        [(9.569 / 1.049, None), (9.569 / 1.051, Some("5.1 % more")), (9.569 / 0.951, None), (9.569 / 0.949, Some("5.1 % less"))]
    {
        let doubts = told(&inputs(&[("pitch_mm", pitch)]));
        assert_eq!(doubts.len(), usize::from(off.is_some()), "{pitch}: {doubts:?}");
        assert!(off.is_none_or(|off| doubts[0].contains(off) && doubts[0].contains("pitch_mm")), "{doubts:?}");
    }
    for (name, value) in [("tip_radius_mm", 71.0), ("land_half_angle_deg", 1.9), ("space_half_angle_deg", 2.2), ("pitch_line_mm", 5.0)] {
        assert_eq!(told(&inputs(&[(name, value)])).len(), 1, "{name}");
    }
    // Where the status is another than ok, too: there the contradiction may be the reason.
    assert_eq!(told(&inputs(&[("teeth_in_mesh", 60.0), ("pitch_mm", 12.0)])).len(), 1);
}

#[test]
fn check_tells_of_a_pulley_that_does_not_fit_the_belt() {
    let folder = tempfile::tempdir().expect("a folder can be made");
    let said = |geometry: &str| {
        let text = format!(
            "model = \"timing-belt\"\n[design]\ntight_tension_N = [300, 400]\n{geometry}\n[operation]\npulley_speed_rpm = [1000, 6000]\n\
             [objectives]\ntight_tension_N = \"min\"\n"
        );
        std::fs::write(folder.path().join("study.toml"), text).expect("it can be written");
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_beltspace"))
            .args(["check", "study.toml"])
            .current_dir(folder.path())
            .output()
            .expect("it runs");
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success() && text.contains("evaluations"), "{output:?}");
        text.lines().find(|line| line.contains("does not fit the belt")).map(str::to_owned)
    };
    assert_eq!(said("cases = [{ tip_radius_mm = 66, pitch_mm = 9.525 }, { tip_radius_mm = 66.3, pitch_mm = 9.6 }]"), None);
    let told = said("cases = [{ tip_radius_mm = 66, pitch_mm = 9.525 }, { tip_radius_mm = 66, pitch_mm = 8 }]").expect("they contradict");
    assert!(told.contains("19.0 % more than pitch_mm 8") && told.contains("(design 1 and 1 more, of 4 looked at)"), "{told}");
    // What formulas give is looked at, too.
    let told = said("teeth = [44, 60]\n[formulas]\nspace_half_angle_deg = \"115.2[deg] / teeth\"").expect("60 teeth have another radius");
    assert!(told.contains("(design 1 and 1 more, of 4 looked at)"), "{told}");
}

#[test]
fn a_map_over_speed_and_tension_leaves_the_wrap_to_its_rows() {
    let text =
        std::fs::read_to_string(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/timing-map.toml")).expect("it is shipped");
    let study = beltspace::study::Study::parse_in(&text, "timing-map.toml", std::path::Path::new(".")).expect("it is right");
    let plan = beltspace::plan::Plan::new(study);
    // The short way of src/models/timing_belt/block.rs takes the condition on the tensions and no other.
    let effective = model().conditions.iter().position(|it| it.reason == "no effective tension").expect("it is a status");
    assert_eq!(plan.lane_conditions, [effective]);
}
