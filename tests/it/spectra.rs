//! Load spectra: means and sums over weighted cases against a plain loop, whatever runs them, and how a result shows them.

use crate::pipeline::runs::{Pipeline, differing_file};
use beltspace::certify;
use beltspace::models::{Status, evaluate};
use beltspace::plan::Plan;
use beltspace::screen::Control;
use beltspace::study::{Axis, OverScenarios, Quantity, Study};
use beltspace::sweep::Settings;
use std::path::Path;
use std::process::Command;

/// A duty cycle with two comments and a case that never happens but must be survived.
const DUTY: &str = "# measured\ntorque_Nm,ratio,share\n50,0.6,0.3\n100,1,0.5\n# rare\n150,1.7,0.4\n185,1.7,0\n";

/// Weights from a CSV file, one of them 0; the cases are the only scenarios.
const MEAN: &str = r#"model = "metal-cvt"
[design]
band_thickness_mm = { from = 0.10, to = 0.30, count = 21 }
band_count        = { from = 6, to = 12 }
groove_angle_deg  = [18, 22, 30]
[operation]
duty = { cases = { csv = "duty.csv" }, weight = "share" }
[fixed]
strength_MPa = 600
[constraints]
stress_margin = { min = 0.05 }
[objectives]
mean_force = { of = "axial_force_N", goal = "min", over_scenarios = "mean" }
stress_margin = "max"
[report]
columns = [{ of = "max_stress_MPa", over_scenarios = "sum" }, { of = "axial_force_N", worst = "lowest" }]
variants = true
"#;

/// A further axis that nobody knows, before which and after which others stand, and one quantity in three roles.
const UNCERTAIN: &str = r#"model = "metal-cvt"
[design]
band_thickness_mm = { from = 0.10, to = 0.30, count = 11 }
band_count        = { from = 6, to = 12 }
groove_angle_deg  = [18, 22, 30]
[operation]
strength_MPa = [600, 650]
duty = { cases = { csv = "duty.csv" }, weight = "share" }
[uncertainty]
friction = [0.06, 0.09, 0.07]
[constraints]
worst = { of = "axial_force_N", max = 50000 }
most  = { of = "axial_force_N", over_scenarios = "sum", max = 29500 }
[objectives]
mean_force    = { of = "axial_force_N", goal = "min", over_scenarios = "mean" }
max_stress_MPa = { goal = "min", over_scenarios = "sum" }
[report]
variants = true
"#;

/// Miner's sum of a formula whose value is a damage per hour, times hours.
const MINER: &str = r#"model = "metal-cvt"
[design]
band_thickness_mm = { from = 0.10, to = 0.30, count = 41 }
band_count        = { from = 6, to = 12 }
[operation]
duty = { cases = [
  { torque_Nm = 50, ratio = 0.6, duration_h = 4000 },
  { torque_Nm = 100, ratio = 1, duration_h = 900 },
  { torque_Nm = 150, ratio = 1.7, duration_h = 60 },
], weight = "duration_h" }
[formulas]
cycles_per_h = "4e5[1/h] * if(ratio > 1, ratio, 1)"
damage_per_h = "cycles_per_h * (max_stress_MPa / endurance_MPa) ^ 9 / 1e9"
[fixed]
endurance_MPa = 500
strength_MPa  = 900
[constraints]
damage = { of = "damage_per_h", over_scenarios = "sum", max = 1 }
[objectives]
axial_force_N = { goal = "min", over_scenarios = "mean" }
damage_per_h  = { goal = "min", over_scenarios = "sum" }
[report]
variants = true
"#;

fn study_of(text: &str) -> Study {
    let folder = tempfile::tempdir().expect("a folder can be made");
    std::fs::write(folder.path().join("duty.csv"), DUTY).expect("it can be written");
    Study::parse_in(text, "study.toml", folder.path()).unwrap_or_else(|errors| panic!("{errors}"))
}

/// Every combination of axes as inputs, the last axis fastest.
fn combinations(axes: &[&Axis], inputs: &[f64]) -> Vec<Vec<f64>> {
    let Some((axis, rest)) = axes.split_first() else { return vec![inputs.to_vec()] };
    let level = |level: u64| {
        let mut inputs = inputs.to_vec();
        axis.inputs().iter().enumerate().for_each(|(column, &input)| inputs[input] = axis.value(column, level));
        combinations(rest, &inputs)
    };
    (0..axis.count()).flat_map(level).collect()
}

/// What a design comes to in one role.
struct Expected {
    worst: f64,
    scenario: usize,
}

/// A plain loop: for each setting of the other scenario axes the sum over the duty, then the highest or lowest of these.
fn by_hand(study: &Study, design: &[f64], quantity: Quantity, over: OverScenarios, highest: bool) -> Option<Expected> {
    let scenario_axes: Vec<&Axis> = study.operation.iter().chain(&study.uncertainty).collect();
    let spectrum = study.spectrum.as_ref().expect("it has weights");
    let own = study.operation[spectrum.axis].inputs();
    let values: Vec<(Vec<f64>, f64)> = combinations(&scenario_axes, design)
        .into_iter()
        .map(|inputs| {
            let found = evaluate(&study.model, &inputs);
            let value = match quantity {
                Quantity::Input(input) => Some(inputs[input]),
                Quantity::Output(output) => found.outputs[output],
            };
            Some((inputs, value?))
        })
        .collect::<Option<_>>()?;
    let mut found: Option<Expected> = None;
    for (scenario, (inputs, value)) in values.iter().enumerate() {
        let others = |it: &[f64]| it.iter().enumerate().filter(|(input, _)| !own.contains(input)).map(|(_, it)| *it).collect::<Vec<_>>();
        let total = if over == OverScenarios::Worst {
            *value
        } else {
            let cases: Vec<f64> = values.iter().filter(|(it, _)| others(it) == others(inputs)).map(|(_, value)| *value).collect();
            assert_eq!(cases.len(), spectrum.weights.len());
            let (mut sum, mut weights) = (0.0, 0.0);
            for (weight, value) in spectrum.weights.iter().zip(&cases) {
                sum += weight * value;
                weights += weight;
            }
            if over == OverScenarios::Mean { sum / weights } else { sum }
        };
        let is_worse = |held: &Expected| if highest { total > held.worst } else { total < held.worst };
        if found.as_ref().is_none_or(is_worse) {
            found = Some(Expected { worst: total, scenario });
        }
    }
    found
}

/// Compares the list of all designs with the plain loop; tells how many are feasible.
fn compare(text: &str, columns: &[(&str, &str, OverScenarios, bool)], keeps: impl Fn(&dyn Fn(&str) -> f64) -> bool) -> usize {
    let study = study_of(text);
    let plan = Plan::new(study);
    let study = &plan.study;
    let pipeline = Pipeline::new(&plan, text);
    let folder = tempfile::tempdir().expect("a folder can be made");
    pipeline.write(pipeline.whole(&Settings { threads: 1, ..Settings::default() }), 1, folder.path());
    let variants = std::fs::read_to_string(folder.path().join("variants.csv")).expect("it is there");
    let mut lines = variants.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let header = lines.next().expect("there is a header");
    let place = |name: &str| header.iter().position(|it| it == name).unwrap_or_else(|| panic!("no column {name} in {header:?}"));
    let designs = combinations(&study.design.iter().collect::<Vec<_>>(), &study.fixed);
    let mut feasible = 0;
    for (row, design) in lines.zip(&designs) {
        for &(column, name, over, highest) in columns {
            let quantity = study.model.output(name).map(Quantity::Output).expect("it is an output");
            let expected = by_hand(study, design, quantity, over, highest).expect("every design of these has a value");
            let cell: f64 = row[place(column)].parse().expect("a number");
            assert_eq!(cell.to_bits(), expected.worst.to_bits(), "{column} of design {}", row[0]);
            assert_eq!(row[place(&format!("{column}_scenario"))], expected.scenario.to_string(), "{column} of design {}", row[0]);
        }
        let scenario_axes: Vec<&Axis> = study.operation.iter().chain(&study.uncertainty).collect();
        let is_ok = combinations(&scenario_axes, design).iter().all(|inputs| evaluate(&study.model, inputs).status == Status::Ok);
        let value = |name: &str| row[place(name)].parse::<f64>().expect("a number");
        let is_feasible = is_ok && keeps(&value);
        assert_eq!(row[place("feasible")], if is_feasible { "yes" } else { "no" }, "design {}", row[0]);
        feasible += usize::from(is_feasible);
    }
    assert!(feasible > 0 && feasible < designs.len(), "{feasible} of {}", designs.len());
    feasible
}

use OverScenarios::{Mean, Sum, Worst};

#[test]
fn means_and_sums_are_those_of_a_plain_loop() {
    let columns = [
        ("axial_force_N_mean", "axial_force_N", Mean, true),
        ("stress_margin", "stress_margin", Worst, false),
        ("max_stress_MPa_sum", "max_stress_MPa", Sum, true),
        ("axial_force_N", "axial_force_N", Worst, false),
    ];
    compare(MEAN, &columns, |value| value("stress_margin") >= 0.05);
    let columns = [
        ("axial_force_N_mean", "axial_force_N", Mean, true),
        ("max_stress_MPa_sum", "max_stress_MPa", Sum, true),
        ("axial_force_N", "axial_force_N", Worst, true),
        ("axial_force_N_sum", "axial_force_N", Sum, true),
    ];
    compare(UNCERTAIN, &columns, |value| value("axial_force_N") <= 50000.0 && value("axial_force_N_sum") <= 29500.0);
    let columns = [("axial_force_N_mean", "axial_force_N", Mean, true), ("damage_per_h_sum", "damage_per_h", Sum, true)];
    compare(MINER, &columns, |value| value("damage_per_h_sum") <= 1.0);
}

/// A case of weight 0 counts for the worst: without it, more designs are feasible.
#[test]
fn a_case_of_weight_0_must_be_survived() {
    let columns = [("stress_margin", "stress_margin", Worst, false)];
    let with = compare(MEAN, &columns, |value| value("stress_margin") >= 0.05);
    let inline = DUTY.lines().filter(|line| !line.starts_with(['#', 't']) && !line.ends_with(",0"));
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        format!("{{ torque_Nm = {}, ratio = {}, share = {} }}", cells[0], cells[1], cells[2])
    };
    let rows: Vec<String> = inline.map(row).collect();
    let text = MEAN.replace("{ csv = \"duty.csv\" }", &format!("[{}]", rows.join(", ")));
    let without = compare(&text, &columns, |value| value("stress_margin") >= 0.05);
    assert!(without > with, "{without} without it, {with} with it");
}

/// Threads, tiles, shards and merging give the same files to the byte; the description comes back, and is that of before where no
/// spectrum is used.
#[test]
fn every_way_gives_the_same_files() {
    // The weight is a variable too where a formula reads it.
    let read = MEAN
        .replace("[fixed]", "[formulas]\nshared_force_N = \"axial_force_N * share\"\n[fixed]")
        .replace("\"max_stress_MPa\"", "\"shared_force_N\"");
    for text in [MEAN, UNCERTAIN, MINER, &read] {
        let plan = Plan::new(study_of(text));
        let described = plan.study.describe();
        let back = Study::from_description(&described).expect("it comes back");
        assert_eq!((back.hash(), &back.spectrum), (plan.study.hash(), &plan.study.spectrum));
        assert_eq!(described["spectrum"]["name"], "duty");
        let pipeline = Pipeline::new(&plan, text);
        let folder = tempfile::tempdir().expect("a folder can be made");
        let reference = pipeline.write(pipeline.whole(&Settings { threads: 1, ..Settings::default() }), 1, &folder.path().join("one"));
        for (number, (threads, tile)) in [(2, 1), (3, 7), (2, 50)].into_iter().enumerate() {
            let state = pipeline.whole(&Settings { threads, tile, ..Settings::default() });
            let files = pipeline.write(state, threads, &folder.path().join(number.to_string()));
            assert_eq!(differing_file(&reference, &files), None, "{threads} threads, tiles of {tile}");
        }
        let state = pipeline.sharded(&mut crate::random::Random::new(5), folder.path());
        assert_eq!(differing_file(&reference, &pipeline.write(state, 2, &folder.path().join("merged"))), None);
    }
}

/// The comparison objects to another weight, to weights in another order, and to a mean in place of a sum.
#[test]
fn the_plain_loop_is_not_that_of_another_spectrum() {
    let plan = Plan::new(study_of(UNCERTAIN));
    let columns = certify::columns(&plan.study);
    let row = certify::rows(&plan, &columns, &[5], 1, &Control::default()).expect("nobody stops it").remove(0);
    let column = columns.iter().position(|it| it.name == "axial_force_N_sum").expect("it is constrained");
    let found = row.columns[column].value.expect("it has a value");
    let quantity = columns[column].quantity;
    let expected = |study: &Study, over: OverScenarios| {
        let inputs = combinations(&study.design.iter().collect::<Vec<_>>(), &study.fixed).remove(5);
        by_hand(study, &inputs, quantity, over, true).expect("it has a value").worst
    };
    assert_eq!(expected(&plan.study, Sum).to_bits(), found.to_bits());
    assert_ne!(expected(&plan.study, Mean), found);
    let changed = |change: fn(&mut Vec<f64>)| {
        let mut study = plan.study.clone();
        change(&mut study.spectrum.as_mut().expect("it has one").weights);
        expected(&study, Sum)
    };
    assert_ne!(changed(|weights| weights[1] *= 1.0 + 1e-12), found);
    assert_ne!(changed(|weights| weights.reverse()), found);
}

/// The sums under way are few whatever the axes are, and all that is done is the same.
#[test]
fn a_long_fast_axis_does_not_keep_many_sums_under_way() {
    let text = MEAN.replace("[fixed]\nstrength_MPa = 600", "[uncertainty]\nstrength_MPa = { from = 500, to = 600, count = 1000 }");
    let text = text.replace("count = 21", "count = 2").replace("variants = true", "");
    let plan = Plan::new(study_of(&text));
    let spectrum = plan.spectrum.as_ref().expect("it has one");
    assert!(spectrum.under_way <= 256, "{}", spectrum.under_way);
    assert_eq!(plan.slow_scenarios.count() * plan.fast_scenarios.count(), 4000);
}

fn run(arguments: &[&str], folder: &Path) -> (bool, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_beltspace")).args(arguments).current_dir(folder).output().expect("it runs");
    (output.status.success(), String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr))
}

#[test]
fn the_command_line_shows_and_refuses_by_name() {
    let folder = tempfile::tempdir().expect("a folder can be made");
    let path = folder.path();
    std::fs::write(path.join("duty.csv"), DUTY).expect("it can be written");
    std::fs::write(path.join("study.toml"), UNCERTAIN).expect("it can be written");
    let (good, said) = run(&["sweep", "study.toml", "--out", "whole"], path);
    assert!(good && said.contains("axial_force_N_mean (min)") && said.contains("axial_force_N_sum at most 29500 N"), "{said}");
    let page = std::fs::read_to_string(path.join("whole/report.html")).expect("it is there");
    for shown in ["axial_force_N_mean", "mean over duty, weighted by share, highest of the other scenarios"] {
        assert!(page.contains(shown), "the page has no {shown}");
    }
    // Shards, one after the other, and merged: the files of the whole but for the record of the run.
    for shard in ["1/3", "2/3", "3/3"] {
        let (good, said) = run(&["sweep", "study.toml", "--shard", shard, "--out", &shard.replace('/', "-")], path);
        assert!(good, "{said}");
    }
    let (good, said) = run(&["merge", "1-3", "2-3", "3-3", "--out", "merged"], path);
    assert!(good, "{said}");
    for name in ["front.csv", "front.parquet", "variants.csv", "study.json", "summary.json", "front.svg"] {
        let read = |folder: &str| std::fs::read(path.join(folder).join(name)).expect("it is there");
        assert!(read("whole") == read("merged"), "{name} differs");
    }
    let (_, said) = run(&["sweep", "study.toml", "--method", "bounds", "--out", "b"], path);
    assert!(said.contains("a mean or sum over the cases of a spectrum is no worst value"), "{said}");
    let (_, said) = run(&["sweep", "study.toml", "--engine", "gpu", "--out", "g"], path);
    assert!(said.contains("it asks for a mean or sum over the cases of a spectrum, and these are added up on the CPU"), "{said}");
    let (good, said) = run(&["eval", "study.toml", "--design", "3"], path);
    assert!(good && said.contains("axial_force_N_sum"), "{said}");
}

/// What is wrong in a CSV file of weights is told with its place.
#[test]
fn broken_weights_in_a_file_are_told_with_their_place() {
    let folder = tempfile::tempdir().expect("a folder can be made");
    let problems = |csv: &str| {
        std::fs::write(folder.path().join("duty.csv"), csv).expect("it can be written");
        let Err(errors) = Study::parse_in(MEAN, "study.toml", folder.path()) else { return String::new() };
        errors.to_string()
    };
    for (csv, expected) in [
        (
            "torque_Nm,ratio\n50,1\n",
            "duty.csv:1:1: there is no column \"share\" with the weights; the columns are \"torque_Nm\", \"ratio\"",
        ),
        (
            "# a\ntorque_Nm,share\n\n# b\n50,-1\n",
            "duty.csv:5:2: column \"share\": the weight -1 cannot be used; give a number of at least 0",
        ),
        ("torque_Nm,share\n50,much\n", "duty.csv:2:2: column \"share\": \"much\" is no number; give the weight of the case"),
        ("torque_Nm,share\n50,\n", "duty.csv:2:2: column \"share\": \"\" is no number; give the weight of the case"),
        ("torque_Nm,share\n50,inf\n", "duty.csv:2:2: column \"share\": \"inf\" is no number; give the weight of the case"),
        ("share\n1\n", "duty.csv:1:1: there are only weights; name an input in the first line, such as friction"),
        ("torque_Nm,share,share\n50,1,1\n", "duty.csv:1:3: \"share\" has two columns; drop one"),
        ("torque_Nm,share\n50,1\n50,2\n", "duty.csv:3:1: the row equals that of line 2; drop one"),
        (
            "torque_Nm,share\n50,0\n60,0\n",
            "study.toml:7:49: axis \"duty\": all weights in \"share\" are 0; give one case a weight at least",
        ),
    ] {
        assert_eq!(problems(csv), expected, "{csv}");
    }
    assert_eq!(problems(DUTY), "");
}
