//! A model in a file with all that a file can say, by brute force, by every engine, and from what a result keeps of it.

use super::{Numbers, front, parsed, told};
use beltspace::models::{Model, Status, evaluate};
use beltspace::plan::Plan;
use beltspace::study::{Goal, read_model};
use beltspace::{Engine, Judging, Options, Study};
use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;

const BRAKES: &str = include_str!("models/brakes.toml");

fn brake() -> Arc<Model> {
    read_model(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/formulas/models/band-brake.toml")).expect("it is right")
}

/// The brake in other words: status and what has a value.
fn evaluated(number: &dyn Fn(&str) -> f64, surface: &str, measured: bool) -> (String, Numbers) {
    let mut found = Numbers::new();
    let mut status = "ok".to_owned();
    let fails = |status: &mut String, reason: &str| {
        if status == "ok" {
            reason.clone_into(status);
        }
    };
    let (radius, angle, pull) = (number("drum_radius_mm") / 1000.0, number("wrap_deg") * PI / 180.0, number("pull_N"));
    let speed = number("speed_rpm") * PI / 30.0 * radius;
    found.insert("rubbing_speed_m_per_s".to_owned(), speed);
    let measured_grip = || {
        let points = [(0.0, 0.35), (10.0, 0.30), (24.0, 0.22)];
        let pair = points.windows(2).find(|pair| pair[0].0 <= speed && speed <= pair[1].0)?;
        Some(pair[0].1 + (pair[1].1 - pair[0].1) * (speed - pair[0].0) / (pair[1].0 - pair[0].0))
    };
    if speed >= 25.0 {
        fails(&mut status, "too fast");
    }
    let grip = if measured { measured_grip() } else { Some(number("friction")) };
    let Some(grip) = grip else {
        fails(&mut status, "formula grip_used: grip beyond its ends");
        return (status, found);
    };
    let tight = pull * (grip * if surface == "rough" { 1.3 } else { 1.0 } * angle).exp();
    found.insert("tight_N".to_owned(), tight);
    let rivets = number("rows") * (tight / 400.0).ceil();
    found.insert("rivets".to_owned(), rivets);
    found.insert("cost_EUR".to_owned(), 0.4 * rivets + 25.0 * angle * radius * 0.04 * 0.002 * 7850.0);
    let breaks = tight > 4000.0;
    if breaks {
        fails(&mut status, "band breaks");
    }
    if speed < 25.0 && !breaks {
        found.insert("torque_Nm".to_owned(), (tight - pull) * radius);
    }
    if pull == 0.0 {
        fails(&mut status, "formula gain: division by zero");
    } else if !breaks && radius >= 0.06 {
        found.insert("gain".to_owned(), tight / pull);
    }
    (status, found)
}

/// What a design of the study is in other words.
fn by_hand(study: &Study, inputs: &[f64]) -> (String, Numbers) {
    let model = &study.model;
    let at = |name: &str| model.input(name).expect("it is an input");
    let word = |name: &str| model.inputs[at(name)].word_for(inputs[at(name)]);
    let number = |name: &str| inputs[at(name)];
    evaluated(&number, word("surface").expect("it takes words only"), word("friction") == Some("measured"))
}

#[test]
fn every_design_has_the_status_and_the_values_of_the_model_in_other_words() {
    let study = parsed(BRAKES);
    let plan = Plan::new(study.clone());
    let mut seen = std::collections::BTreeMap::new();
    for design in 0..plan.designs() {
        for scenario in 0..plan.scenarios() {
            let inputs = plan.space.inputs(design, scenario);
            let (status, expected) = by_hand(&study, &inputs);
            let found = evaluate(&study.model, &inputs);
            assert_eq!(found.status.reason(&study.model), status, "{inputs:?}");
            *seen.entry(status).or_insert(0) += 1;
            for (output, value) in study.model.outputs.iter().zip(&found.outputs).filter(|(output, _)| output.name != "total_EUR") {
                let wanted = expected.get(&output.name);
                assert_eq!(value.is_some(), wanted.is_some(), "{}: {inputs:?}", output.name);
                if let (Some(value), Some(wanted)) = (value, wanted) {
                    assert!((value - wanted).abs() <= 1e-9 * wanted.abs(), "{}: {value}, not {wanted}: {inputs:?}", output.name);
                }
            }
        }
    }
    assert_eq!(seen.len(), 5, "{seen:?}");
    assert!(seen.values().all(|&count| count > 20), "{seen:?}");
}

#[test]
fn fronts_of_a_model_in_a_file_are_those_of_brute_force_on_every_engine_and_by_every_method() {
    let study = parsed(BRAKES);
    let plan = Plan::new(study.clone());
    let price = study.model.input("price_EUR").expect("it is a variable");
    let mut feasible = Vec::new();
    for design in 0..plan.designs() {
        let scenarios: Vec<_> = (0..plan.scenarios())
            .map(|scenario| {
                let inputs = plan.space.inputs(design, scenario);
                let (status, mut numbers) = by_hand(&study, &inputs);
                if let Some(cost) = numbers.get("cost_EUR") {
                    numbers.insert("total_EUR".to_owned(), inputs[price] * cost);
                }
                numbers.insert("pull_N".to_owned(), inputs[study.model.input("pull_N").expect("it is an input")]);
                (status == "ok" && numbers.get("torque_Nm")? >= &20.0 && numbers.get("gain")? >= &1.2).then_some(numbers)
            })
            .collect();
        let Some(scenarios) = scenarios.into_iter().collect::<Option<Vec<_>>>() else { continue };
        let worst = study.objectives.iter().map(|objective| {
            assert_eq!(objective.goal, Goal::Min);
            let name = objective.quantity.name(&study.model);
            scenarios.iter().map(|numbers| numbers[name]).fold(f64::NEG_INFINITY, f64::max)
        });
        feasible.push((design, worst.collect()));
    }
    let expected = front(&study, &feasible);
    assert!(feasible.len() > 50 && expected.len() > 2, "{} feasible, {} on the front", feasible.len(), expected.len());
    let cpu = || Options::default().engine(Engine::Cpu);
    let every = study.sweep(cpu().judging(Judging::Exhaustive)).expect("it is swept");
    assert_eq!(every.counts.feasible, feasible.len() as u64);
    assert_eq!(told(&every).keys().copied().collect::<Vec<_>>(), expected);
    // The worst torque is the lowest, since the file says so.
    let torque = every.front.column("torque_Nm").expect("it is a column");
    let lowest = |design: u64| {
        let of = |scenario| evaluate(&study.model, &plan.space.inputs(design, scenario));
        let at = study.model.output("torque_Nm").expect("it is an output");
        (0..plan.scenarios()).filter_map(|scenario| of(scenario).outputs[at]).fold(f64::INFINITY, f64::min)
    };
    let beltspace::Data::Number(torques) = &torque.data else { panic!("torques are numbers") };
    let designs: Vec<u64> = match &every.front.column("design_index").expect("it is a column").data {
        beltspace::Data::Whole(designs) => designs.iter().flatten().copied().collect(),
        _ => panic!("designs are whole"),
    };
    assert_eq!(torques.iter().flatten().copied().collect::<Vec<_>>(), designs.into_iter().map(lowest).collect::<Vec<_>>());

    let without_bins = parsed(&BRAKES.replace("histograms = [{ of = \"torque_Nm\", bins = 8 }]", ""));
    let bounds = without_bins.sweep(cpu().judging(Judging::Bounds)).expect("bounds serve it");
    let adapter = beltspace::gpu::adapters().into_iter().next().expect("the tests have an adapter").name;
    let on_gpu = Options::default().engine(Engine::Gpu).adapter(adapter).judging(Judging::Exhaustive);
    for other in [bounds, study.sweep(on_gpu).expect("it is swept"), study.sweep(cpu().threads(1)).expect("it is swept")] {
        assert_eq!(other.front.csv(), every.front.csv(), "{}", other.course.why);
        assert_eq!(other.counts, every.counts);
    }
}

#[test]
fn presets_whole_numbers_and_quiet_conditions_of_a_file_are_those_of_a_model() {
    let model = brake();
    let heavy = model.preset("heavy").expect("it is a preset");
    let value = |name: &str| heavy[model.input(name).expect("it is an input")];
    assert_eq!((value("drum_radius_mm"), value("rows"), value("pull_N")), (200.0, 3.0, 300.0));
    let surface = &model.inputs[model.input("surface").expect("it is an input")];
    assert_eq!(surface.word_for(value("surface")), Some("rough"));
    let output = |name: &str| &model.outputs[model.output(name).expect("it is an output")];
    assert!(output("rivets").integer && !output("torque_Nm").integer);
    assert!(model.output("grip_used").is_none() && model.output("rough_factor").is_none());
    assert_eq!((output("tight_N").symbol.as_str(), output("tight_N").source.as_str()), ("F1", "Eytelwein"));
    // A quiet condition takes a value away and leaves the status as it is.
    let mut small = model.defaults();
    small[model.input("drum_radius_mm").expect("it is an input")] = 50.0;
    let found = evaluate(&model, &small);
    assert_eq!((found.status, found.outputs[model.output("gain").expect("it is an output")]), (Status::Ok, None));
    assert!(evaluate(&model, &model.defaults()).outputs.iter().all(Option::is_some));
}

#[test]
fn a_study_comes_back_from_its_description_without_the_file() {
    let study = parsed(BRAKES);
    let described = study.describe();
    assert!(described["model_file"]["text"].as_str().is_some_and(|text| text.contains("Eytelwein")));
    let back = Study::from_description(&described).expect("it comes back");
    assert_eq!((back.hash(), back.model.clone()), (study.hash(), study.model.clone()));
    // Another text of the model is another study.
    let folder = tempfile::tempdir().expect("there is room");
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/formulas/models");
    let text = std::fs::read_to_string(own.join("band-brake.toml")).expect("it is there");
    std::fs::copy(own.join("grip.csv"), folder.path().join("grip.csv")).expect("it is copied");
    std::fs::write(folder.path().join("band-brake.toml"), text.replace("400[N]", "401[N]")).expect("it is written");
    let other = Study::parse_in(BRAKES, "study.toml", folder.path()).expect("it is right");
    assert_ne!(other.hash(), study.hash());
    let points = std::fs::read_to_string(own.join("grip.csv")).expect("it is there").replace("0.30", "0.31");
    std::fs::write(folder.path().join("band-brake.toml"), text).expect("it is written");
    std::fs::write(folder.path().join("grip.csv"), points).expect("it is written");
    let other = Study::parse_in(BRAKES, "study.toml", folder.path()).expect("it is right");
    assert_ne!(other.hash(), study.hash());
}

#[test]
fn formulas_of_a_study_may_be_tables_and_a_hidden_one_is_no_output() {
    let text = |table: &str, column: &str| {
        format!(
            "model = \"metal-cvt\"\n[design]\nband_count = [8, 10]\n[operation]\ntorque_Nm = [50, 100]\n[formulas]\n{table}\n\
             twice_N = \"2 * half_N\"\n[objectives]\ntwice_N = \"min\"\n[report]\ncolumns = [\"{column}\"]\n"
        )
    };
    let swept =
        |table: &str, column: &str| parsed(&text(table, column)).sweep(Options::default().engine(Engine::Cpu)).expect("it is swept");
    let column = |outcome: &beltspace::Outcome| match &outcome.front.column("half_N").expect("it is a column").data {
        beltspace::Data::Number(values) => values[0].expect("it has a value"),
        _ => panic!("it is a number"),
    };
    let high = column(&swept("half_N = \"belt_force_N / 2\"", "half_N"));
    let low = column(&swept("half_N = { is = \"belt_force_N / 2\", worst = \"lowest\" }", "half_N"));
    assert!((high - 2.0 * low).abs() < 1e-9 * high, "{high} and {low}");
    let said =
        Study::parse_in(&text("half_N = { is = \"belt_force_N / 2\", hidden = true }", "half_N"), "s", Path::new(".")).expect_err("hidden");
    let expected = "s:12:12: columns: half_N is a hidden formula, an intermediate value; drop hidden, or name it among the outputs";
    assert_eq!(said.to_string(), expected);
    let plain = parsed(&text("half_N = \"belt_force_N / 2\"", "half_N"));
    let as_table = parsed(&text("half_N = { is = \"belt_force_N / 2\" }", "half_N"));
    assert_eq!(plain.hash(), as_table.hash(), "a table that says no more is the same");
    let more = parsed(&text("half_N = { is = \"belt_force_N / 2\", symbol = \"P\", doc = \"Half.\", source = \"(1)\" }", "half_N"));
    assert_ne!(plain.hash(), more.hash());
    assert_eq!(Study::from_description(&more.describe()).expect("it comes back").model, more.model);
}
