//! Random small studies, judged by brute force and by the pipeline in many ways, which must all agree to the last bit.

pub mod answer;
pub mod expected;
pub mod naive;
pub mod random_axes;
pub mod random_study;
pub mod runs;

use crate::random::Random;
use answer::{Answer, Cell};
use beltspace::plan::Plan;
use beltspace::reduce::{Reported, State, Top};
use beltspace::screen::BLOCK;
use beltspace::study::{Best, Method, Quantity, Study};
use beltspace::sweep::Settings;
use expected::Expected;
use naive::Evaluated;
use random_study::Draft;
use runs::{Pipeline, differing_file, options};
use std::collections::BTreeMap;
use std::path::Path;

/// How many studies had each feature, so that the loop cannot end up testing nothing.
pub type Coverage = BTreeMap<String, usize>;

/// Is this the full stage of the continuous integration?
pub fn full() -> bool {
    std::env::var("BELTSPACE_FULL").is_ok_and(|value| value == "1")
}

fn studies() -> u64 {
    if full() { 200 } else { 40 }
}

/// Are two states equivalent? One may still have more designs in its list of the best K than the other.
fn same(a: &State, b: &State) -> bool {
    let best = |state: &State| state.reported.top.first().map(Top::indices);
    let rest = |state: &State| State { reported: Reported { top: Vec::new(), ..state.reported.clone() }, ..state.clone() };
    best(a) == best(b) && rest(a) == rest(b)
}

pub fn parse(text: &str) -> Study {
    Study::parse_in(text, "random.toml", Path::new(".")).unwrap_or_else(|errors| panic!("{errors}"))
}

/// A random study: its text, what it means, and its answer.
fn study_of(seed: u64) -> (Draft, String, Study, Evaluated) {
    let mut draft = Draft::new(seed);
    let study = parse(&draft.text());
    let evaluated = Evaluated::new(&study);
    draft.constrain(seed, &study, &evaluated);
    let text = draft.text();
    let study = parse(&text);
    (draft, text, study, evaluated)
}

#[test]
fn the_pipeline_gives_what_brute_force_gives_however_it_is_run() {
    let mut coverage = Coverage::new();
    // Another first seed tries other studies, or one that failed at once.
    let first = std::env::var("BELTSPACE_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(1);
    for seed in first..first + studies() {
        let mut text = String::new();
        let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| check(seed, &mut text, &mut coverage)));
        if let Err(panic) = result {
            eprintln!("seed {seed}, study:\n{text}");
            std::panic::resume_unwind(panic);
        }
    }
    eprintln!("of {} studies: {coverage:#?}", studies());
    for feature in EVERY_FEATURE {
        assert!(coverage.get(*feature).is_some_and(|&count| count > 0), "no random study has: {feature}");
    }
}

/// Checks one study; `text` is for the message if it fails.
fn check(seed: u64, text: &mut String, coverage: &mut Coverage) {
    let (draft, study_text, study, evaluated) = study_of(seed);
    text.clone_from(&study_text);
    draft.check_axes(&study);
    let (plan, expected) = check_all_ways(seed, &study_text, study, &evaluated);
    cover(&draft, &plan, &evaluated, &expected, coverage);
}

/// Runs a study in every way that must not affect the result and compares each with brute force.
fn check_all_ways(seed: u64, text: &str, study: Study, evaluated: &Evaluated) -> (Plan, Expected) {
    let expected = Expected::new(&study, evaluated);
    let plan = Plan::new(study);
    let on_gpu = plan.study.model.on_gpu;
    check_ways(seed, text, &plan, Thorough { on_gpu, write_all: full() }, |found| expected.answer.difference(found));
    (plan, expected)
}

/// What takes its time.
#[derive(Clone, Copy)]
pub struct Thorough {
    /// Run it on the device too?
    pub on_gpu: bool,
    /// Write the files of every way? They are a function of the state; syncing them to the disk takes most of the time.
    pub write_all: bool,
}

/// Compares the result of one run with what is expected, and that of every other way to run the study with the first.
pub fn check_ways(seed: u64, text: &str, plan: &Plan, thorough: Thorough, difference: impl Fn(&Answer) -> Option<String>) {
    let pipeline = Pipeline::new(plan, text);
    let folder = tempfile::tempdir().expect("a folder can be made");

    let reference_state = pipeline.whole(&Settings { threads: 1, ..Settings::default() });
    let reference = pipeline.write(reference_state.clone(), 1, &folder.path().join("whole"));
    let found = Answer::read(&folder.path().join("whole"));
    if let Some(difference) = difference(&found) {
        panic!("seed {seed}: {difference}");
    }
    assert_eq!(reference["study.toml"], text.as_bytes(), "seed {seed}");
    for name in found
        .tables
        .keys()
        .filter(|name| !["scenarios.csv", "top.csv", "sample.csv", "feasible.parquet", "variants.csv"].contains(&name.as_str()))
    {
        assert!(reference.contains_key(&name.replace(".csv", ".svg")), "seed {seed}: there is no picture of {name}");
    }

    let random = &mut Random::new(seed);
    let mut ways: Vec<(String, State)> = Vec::new();
    // Handing over tens of thousands of single designs would only measure the lock.
    let least = plan.designs() / 2000;
    for tile in [1, 7, 1000, Settings::default().tile].map(|tile| tile.max(least)) {
        let options = options(random, tile);
        ways.push((format!("{options:?}"), pipeline.whole(&options)));
    }
    ways.push(("shards".to_owned(), pipeline.sharded(random, folder.path())));
    let written_too = random.below(ways.len());
    for (number, (way, state)) in ways.into_iter().enumerate() {
        assert!(same(&state, &reference_state), "seed {seed}: something else is kept with {way}");
        if !thorough.write_all && number != written_too {
            continue;
        }
        let files = pipeline.write(state, random.whole(1, 3), &folder.path().join(number.to_string()));
        if let Some(name) = differing_file(&reference, &files) {
            panic!("seed {seed}: {name} differs with {way}");
        }
    }
    // Means and sums are for the CPU.
    if thorough.on_gpu && !plan.study.decides_by_spectrum() {
        let (state, files) = pipeline.on_device(seed.is_multiple_of(2), &folder.path().join("device"));
        assert_eq!(state.feasible, reference_state.feasible, "seed {seed}: on the device");
        if let Some(name) = differing_file(&reference, &files) {
            panic!("seed {seed}: {name} differs on the device");
        }
    }
}

const EVERY_FEATURE: &[&str] = &[
    "rubber-cvt",
    "metal-cvt",
    "pulley-load",
    "one value",
    "list",
    "count",
    "log count",
    "step",
    "log step",
    "continuous",
    "whole numbers",
    "joint axis in design",
    "joint axis in operation",
    "joint axis in uncertainty",
    "sample Sobol",
    "sample LatinHypercube",
    "sample Random",
    "traction limit",
    "traction limit and numbers on one axis",
    "inert axis",
    "several rows of the fast axes",
    "plateau of capacity 0",
    "equal objective values",
    "a bound met exactly, inclusive",
    "a bound met exactly, strict",
    "0 objectives",
    "1 objectives",
    "2 objectives",
    "3 objectives",
    "4 objectives",
    "5 objectives",
    "6 objectives",
    "resolution",
    "input as objective",
    "input as constraint",
    "top",
    "sample of feasible designs",
    "all feasible designs written",
    "histogram, range given",
    "histogram, range automatic",
    "map of a value",
    "map of a share",
    "report columns",
    "list of all designs",
    "spectrum",
    "case of weight 0",
    "mean or sum as objective",
    "mean or sum as constraint",
    "mean or sum as column",
    "column of the other end",
    "spectrum among slow scenarios",
    "spectrum among fast scenarios",
    "spectrum beside other scenarios",
    "several scenarios",
    "worst scenario is not the first",
    "front of at least 2 points",
    "front of at least 20 points",
    "head start for the front",
    "nothing feasible",
    "some feasible",
    "all feasible",
];

/// Counts what a study had.
fn cover(draft: &Draft, plan: &Plan, evaluated: &Evaluated, expected: &Expected, coverage: &mut Coverage) {
    let study = &plan.study;
    let mut had: std::collections::BTreeSet<String> = draft.kinds().collect();
    let mut note = |feature: &str, there: bool| {
        if there {
            had.insert(feature.to_owned());
        }
    };
    note(&study.model.name, true);
    for method in [Method::Sobol, Method::LatinHypercube, Method::Random] {
        note(&format!("sample {method:?}"), study.sample.is_some_and(|sample| sample.method == method));
    }
    if let Some(traction) = study.model.input("traction") {
        let limit = |case: &naive::Case| case.inputs[traction] < 0.0;
        let limits = (0..evaluated.designs).flat_map(|design| evaluated.cases(design)).filter(|case| limit(case)).count() as u64;
        note("traction limit", limits > 0);
        note("traction limit and numbers on one axis", limits > 0 && limits < evaluated.designs * evaluated.scenarios);
        let capacity = Quantity::Output(study.model.output("torque_capacity_Nm").expect("both belts have it"));
        let zero = |design: &&u64| evaluated.cases(**design).iter().any(|case| case.value(capacity) == Some(0.0));
        let asked = study.objectives.iter().any(|objective| objective.quantity == capacity);
        note("plateau of capacity 0", asked && expected.feasible.iter().filter(zero).count() >= 2);
    }
    note("inert axis", !plan.inert_axes().is_empty());
    note("several rows of the fast axes", plan.slow.count() > 1 && plan.fast.count() > 1);
    note("equal objective values", expected.ties > 0);
    for constraint in &study.constraints {
        let touches = |design: u64, inclusive: bool| {
            let bounds = [constraint.low, constraint.high].into_iter().flatten();
            let values = evaluated.groups(constraint.over).into_iter();
            let values: Vec<_> = values.map(|group| evaluated.value_over(design, &group, constraint.quantity, constraint.over)).collect();
            bounds.filter(|(_, strict)| *strict != inclusive).any(|(bound, _)| values.contains(&Some(bound)))
        };
        let number = study.constraints.iter().position(|it| it == constraint).expect("it is one of them");
        let only_this = |design: &u64| expected.failures[*design as usize].constraints == [number];
        note("a bound met exactly, inclusive", expected.feasible.iter().any(|&design| touches(design, true)));
        note("a bound met exactly, strict", (0..evaluated.designs).filter(only_this).any(|design| touches(design, false)));
    }
    note(&format!("{} objectives", study.objectives.len()), true);
    let is_input = |quantity: Quantity| matches!(quantity, Quantity::Input(_));
    note("resolution", study.objectives.iter().any(|it| it.resolution.is_some()));
    note("input as objective", study.objectives.iter().any(|it| is_input(it.quantity)));
    note("input as constraint", study.constraints.iter().any(|it| is_input(it.quantity)));
    note("all feasible designs written", study.report.feasible && !expected.feasible.is_empty());
    note("top", study.report.top.is_some());
    note("sample of feasible designs", study.report.sample.is_some());
    note("histogram, range given", study.report.histograms.iter().any(|it| it.range.is_some()));
    note("histogram, range automatic", study.report.histograms.iter().any(|it| it.range.is_none()));
    note("map of a value", study.report.maps.iter().any(|it| matches!(it.value, Best::Value(..))));
    note("map of a share", study.report.maps.iter().any(|it| it.value == Best::Share));
    note("list of all designs", study.report.variants);
    note("report columns", !study.report.columns.is_empty());
    note("several scenarios", evaluated.scenarios > 1);
    if let (Some(spectrum), Some(planned)) = (&study.spectrum, &plan.spectrum) {
        note("spectrum", true);
        note("case of weight 0", spectrum.weights.contains(&0.0));
        note("mean or sum as objective", study.objectives.iter().any(|it| !it.over.is_worst()));
        note("mean or sum as constraint", study.constraints.iter().any(|it| !it.over.is_worst()));
        note("mean or sum as column", study.report.columns.iter().any(|it| !it.over.is_worst()));
        note("column of the other end", study.report.columns.iter().any(|it| it.worst.is_some()));
        note("spectrum among slow scenarios", planned.is_slow && !planned.sums.is_empty());
        note("spectrum among fast scenarios", !planned.is_slow && !planned.sums.is_empty());
        note("spectrum beside other scenarios", evaluated.scenarios > spectrum.weights.len() as u64);
    }
    let front = expected.answer.tables.get("front.csv");
    let late = |table: &answer::Table| {
        let scenario = |(name, cell): (&String, &Cell)| name.ends_with("_scenario") && *cell != Cell::number(0.0);
        table.rows.iter().any(|row| table.header.iter().zip(row).any(scenario))
    };
    note("worst scenario is not the first", front.is_some_and(late));
    note("front of at least 2 points", expected.front.len() >= 2);
    note("front of at least 20 points", expected.front.len() >= 20);
    note("head start for the front", evaluated.designs / 64 >= BLOCK as u64 && expected.front.len() >= 2);
    let (feasible, designs) = (expected.feasible.len() as u64, evaluated.designs);
    note("nothing feasible", feasible == 0);
    note("some feasible", 0 < feasible && feasible < designs);
    note("all feasible", feasible == designs);
    for feature in had {
        *coverage.entry(feature).or_default() += 1;
    }
}

/// The first random study whose answer has a front of this size, read from the directory that the pipeline writes.
fn answered_study(least_front: usize) -> (Expected, Answer) {
    for seed in 1.. {
        let (_, text, study, evaluated) = study_of(seed);
        let expected = Expected::new(&study, &evaluated);
        let tables = &expected.answer.tables;
        let enough = tables.keys().any(|name| name.starts_with("histogram")) && tables.keys().any(|name| name.starts_with("map"));
        if expected.front.len() < least_front || !enough {
            continue;
        }
        return (expected, run(&text, study));
    }
    unreachable!("seeds do not run out")
}

/// Sheets, sections, loads and an impossible bend, so few that a solver can judge each in every way.
const SOLVED: &str = r#"model = "pulley"
title = "Few pulleys"
[design]
section         = ["pressed-cup", "welded-discs"]
thickness_mm    = [1.6, 1.8, 1.9]
slack_tension_N = [500, 700]
[operation]
cases = [{ power_kW = 3, speed_rpm = 3000 }, { power_kW = 2, speed_rpm = 900 }]
[uncertainty]
friction_direction_deg = [0, 45]
[fixed]
fold_radius_mm = 3.7
bolt_angle_deg = "worst"
[constraints]
yield_safety = { min = 0.8 }
[objectives]
mass_g = "min"
yield_safety = "max"
slack_tension_N = "max"
[report]
variants = true
columns = ["max_stress_theta_deg", "stress_Fl_MPa", "stress_P1_MPa", "fatigue_safety"]
top = { by = "rim_displacement_mm", count = 3 }
histograms = [{ of = "max_stress_MPa", bins = 5 }]
maps = [{ x = "thickness_mm", y = "slack_tension_N", value = "mass_g" }]
"#;

#[test]
fn a_solver_gives_what_brute_force_gives_however_it_is_run() {
    let study = parse(SOLVED);
    assert!(crate::effort::is_slow(&study.model), "another study stands for formulas");
    let evaluated = Evaluated::new(&study);
    let (plan, expected) = check_all_ways(1, SOLVED, study, &evaluated);
    let feasible = expected.feasible.len() as u64;
    assert!(plan.slow.count() > 1 && plan.fast.count() > 1 && plan.fast_scenarios.count() > 1, "some of all is prepared once");
    assert!(expected.front.len() >= 2 && feasible < plan.designs(), "{feasible} of {}", plan.designs());
}

/// What the pipeline says of a study.
fn run(text: &str, study: Study) -> Answer {
    let plan = Plan::new(study);
    let pipeline = Pipeline::new(&plan, text);
    let folder = tempfile::tempdir().expect("a folder can be made");
    pipeline.write(pipeline.whole(&Settings::default()), 1, folder.path());
    Answer::read(folder.path())
}

/// The value of every design decides a selection of the formula the same way, so nothing else depends on the axis: the first
/// stage must run with a value of the axis all the same, and not with the default. (Found by seed 165.)
#[test]
fn an_axis_whose_values_all_choose_the_same_branch_is_not_swept_with_the_default() {
    for role in ["design", "operation", "uncertainty"] {
        for (traction, torque) in [("\"limit\"", "50"), ("[0]", "[0]"), ("0.5", "[0, 50]")] {
            let text = format!(
                "model = \"rubber-cvt\"\n[design]\nbelt_thickness_mm = [5, 10, 15]\ngroove_angle_deg = [26, 30]\n\
                 {}traction = {traction}\ntorque_Nm = {torque}\n[objectives]\nstress_margin = \"max\"\n\
                 axial_force_N = \"min\"\n[report]\ntop = {{ by = \"slack_force_N\", count = 9 }}\n",
                if role == "design" { String::new() } else { format!("[{role}]\n") }
            );
            let study = parse(&text);
            let expected = Expected::new(&study, &Evaluated::new(&study));
            assert!(!expected.front.is_empty());
            assert_eq!(expected.answer.difference(&run(&text, study)), None, "{text}");
        }
    }
}

/// Samples of every size, of all, some and no feasible designs, however the study is run; and a comparison that notices another order.
#[test]
fn a_sample_is_the_first_feasible_designs_of_the_shuffled_order() {
    for (count, seed, bound) in [(1, 0, 0.0), (40, 1, 0.0), (40, 2, 0.0), (40, 2, 0.45), (5000, 3, -9.0), (10, 0, 9.0)] {
        let text = format!(
            "model = \"metal-cvt\"\n[design]\nband_thickness_mm = {{ from = 0.1, to = 0.3, count = 41 }}\nband_count = {{ from = 6, to = 12 }}\n\
             groove_angle_deg = [18, 22, 30]\n[operation]\ntorque_Nm = [50, 90]\n[constraints]\nstress_margin = {{ min = {bound} }}\n\
             [objectives]\naxial_force_N = \"min\"\nstress_margin = \"max\"\n[report]\nsample = {{ count = {count}, seed = {seed} }}\n"
        );
        let study = parse(&text);
        let evaluated = Evaluated::new(&study);
        let (_, expected) = check_all_ways(seed, &text, study.clone(), &evaluated);
        let rows = &expected.answer.tables["sample.csv"].rows;
        assert_eq!(rows.len(), count.min(expected.feasible.len()));
        // Another seed takes others.
        let mut other = study;
        other.report.sample.as_mut().expect("it has one").seed += 1;
        let differs = Expected::new(&other, &evaluated).answer.difference(&expected.answer);
        assert_eq!(differs.is_some(), rows.len() < expected.feasible.len(), "{differs:?}");
    }
}

/// A state that names another design than the sample has, or too few, is refused or noticed before anything is written.
#[test]
fn a_sample_with_a_design_that_is_not_feasible_or_one_too_few_is_not_written() {
    let text = "model = \"metal-cvt\"\n[design]\nband_thickness_mm = { from = 0.1, to = 0.3, count = 41 }\nband_count = { from = 6, to = 12 }\n\
                [constraints]\nstress_margin = { min = 0.4 }\n[objectives]\naxial_force_N = \"min\"\n[report]\nsample = 20\n";
    let plan = Plan::new(parse(text));
    let pipeline = Pipeline::new(&plan, text);
    let good = pipeline.whole(&Settings { threads: 1, ..Settings::default() });
    let evaluated = Evaluated::new(&plan.study);
    let feasible = Expected::new(&plan.study, &evaluated).feasible;
    let infeasible = (0..plan.designs()).find(|it| feasible.binary_search(it).is_err()).expect("some are not feasible");
    let forged = |designs: &[u64]| {
        // As it is kept: how many, the keys of the order, the designs.
        let sample = beltspace::reduce::Shuffle::new(0);
        let bytes = postcard::to_stdvec(&(20usize, sample, designs)).expect("it can be written");
        let mut state = good.clone();
        state.reported.samples = vec![postcard::from_bytes(&bytes).expect("that is how it is kept")];
        state
    };
    let kept = good.reported.samples[0].indices();
    assert_eq!(forged(&kept).reported.samples, good.reported.samples);
    let check = |state: &State| pipeline.reduction.check(state, plan.designs(), plan.designs());
    let certified = |state: State| pipeline.certified(state).map(drop).map_err(|error| error.to_string());
    assert_eq!((check(&good), certified(good.clone())), (Ok(()), Ok(())));
    let lost = certified(forged(&kept[1..])).expect_err("one is missing");
    assert!(lost.contains("the sweep kept 19 of the"), "{lost}");
    let wrong = certified(forged(&[&[infeasible], &kept[1..]].concat())).expect_err("one is not feasible");
    assert!(wrong.contains("the f64 reference does not"), "{wrong}");
    for beyond in [forged(&[plan.designs()]), forged(&[0; 41])] {
        assert_eq!(check(&beyond), Err("its sample cannot be of this study".to_owned()));
    }
}

/// The same for the list of all feasible designs: one too few is noticed before anything is written, a wrong one when its row is made.
#[test]
fn a_list_of_feasible_designs_that_is_wrong_is_not_written() {
    let text = "model = \"metal-cvt\"\n[design]\nband_thickness_mm = { from = 0.1, to = 0.3, count = 41 }\nband_count = { from = 6, to = 12 }\n\
                [constraints]\nstress_margin = { min = 0.4 }\n[objectives]\naxial_force_N = \"min\"\n[report]\nfeasible = true\n";
    let plan = Plan::new(parse(text));
    let pipeline = Pipeline::new(&plan, text);
    let good = pipeline.whole(&Settings { threads: 1, ..Settings::default() });
    let evaluated = Evaluated::new(&plan.study);
    let feasible = Expected::new(&plan.study, &evaluated).feasible;
    let infeasible = (0..plan.designs()).find(|it| feasible.binary_search(it).is_err()).expect("some are not feasible");
    let forged = |designs: &[u64]| {
        let mut designs = designs.to_vec();
        designs.sort_unstable();
        // As it is kept: one piece, the differences of neighbours, which here take a byte each.
        let differences = designs.iter().scan(0, |last, &it| Some(u8::try_from(it - std::mem::replace(last, it)).expect("they lie close")));
        let bytes = postcard::to_stdvec(&vec![(designs.len() as u64, differences.collect::<Vec<u8>>())]).expect("it can be written");
        let mut state = good.clone();
        state.reported.all_feasible = vec![postcard::from_bytes(&bytes).expect("that is how it is kept")];
        state
    };
    assert_eq!(forged(&feasible).reported, good.reported);
    let check = |state: &State| pipeline.reduction.check(state, plan.designs(), plan.designs());
    assert_eq!((check(&good), pipeline.certified(good.clone()).map(drop).map_err(|error| error.to_string())), (Ok(()), Ok(())));
    let lost = pipeline.certified(forged(&feasible[1..])).map(drop).expect_err("one is missing").to_string();
    assert!(lost.contains(&format!("the sweep kept {} of the {} feasible designs", feasible.len() - 1, feasible.len())), "{lost}");
    let mut wrong = feasible[1..].to_vec();
    wrong.push(infeasible);
    let folder = tempfile::tempdir().expect("a folder can be made");
    let failed = pipeline.try_write(forged(&wrong), 1, folder.path()).expect_err("one is not feasible").to_string();
    assert!(failed.contains(&format!("design {infeasible}: the sweep found it feasible, the f64 reference does not")), "{failed}");
    assert!(!folder.path().join("summary.json").exists() && !folder.path().join("feasible.parquet").exists());
    assert_eq!(check(&forged(&[100, 200, plan.designs()])), Err("its list of feasible designs cannot be of this study".to_owned()));
}

/// A histogram of a quantity that some designs lack in some scenario makes those infeasible, in the list of all designs too. (Found
/// by seed 178.) A map over an axis that takes a word shows the word. (Found by seed 101.)
#[test]
fn what_a_histogram_lacks_and_what_a_map_names() {
    let text = "model = \"timing-belt\"\n[design]\ntight_tension_N = { from = 100, to = 500, count = 9 }\n\
                lift_angle_deg = [1, \"space\", 2]\n[operation]\npulley_speed_rpm = [2000, 5000]\n[objectives]\n\
                effective_tension_N = \"max\"\n[report]\nvariants = true\n\
                histograms = [{ of = \"boundary_tension_N\", bins = 3 }]\n\
                maps = [{ x = \"lift_angle_deg\", y = \"tight_tension_N\", best = \"share\" }]\n";
    let study = parse(text);
    let evaluated = Evaluated::new(&study);
    let (plan, expected) = check_all_ways(1, text, study, &evaluated);
    let feasible = expected.feasible.len() as u64;
    assert!(feasible > 0 && feasible < plan.designs(), "{feasible} of {}", plan.designs());
}

#[test]
fn the_comparison_objects_to_a_lost_point_a_wrong_count_and_a_wrong_last_bit() {
    let (expected, found) = answered_study(5);
    assert_eq!(expected.answer.difference(&found), None);
    let objection = |change: &dyn Fn(&mut Answer)| {
        let mut changed = found.clone();
        change(&mut changed);
        expected.answer.difference(&changed)
    };
    let table = |answer: &Answer, stem: &str| answer.tables.keys().find(|name| name.starts_with(stem)).expect("it was asked for").clone();
    let bump = |cell: &mut Cell, how: fn(f64) -> f64| {
        let Cell::Number(bits) = cell else { panic!("{cell:?} is no number") };
        *bits = how(f64::from_bits(*bits)).to_bits();
    };

    // A point of the front lost, one too many, and two in the wrong order.
    assert!(objection(&|answer| drop(answer.tables.get_mut("front.csv").unwrap().rows.pop())).is_some());
    assert!(objection(&|answer| drop(answer.tables.get_mut("front.csv").unwrap().rows.remove(0))).is_some());
    assert!(
        objection(&|answer| {
            let rows = &mut answer.tables.get_mut("front.csv").unwrap().rows;
            rows.push(rows[0].clone());
        })
        .is_some()
    );
    assert!(objection(&|answer| answer.tables.get_mut("front.csv").unwrap().rows.swap(0, 1)).is_some());
    // A count off by one.
    for name in ["feasible", "front", "tally.feasible", "scenarios"] {
        assert!(objection(&|answer| bump(answer.summary.get_mut(name).unwrap(), |count| count + 1.0)).is_some(), "{name}");
    }
    let histogram = table(&found, "histogram");
    for row in 0..found.tables[&histogram].rows.len() {
        let changed = objection(&|answer| bump(&mut answer.tables.get_mut(&histogram).unwrap().rows[row][2], |count| count + 1.0));
        assert!(changed.is_some(), "bin {row}");
    }
    // The last bit of any number of the front; a scenario that is another; a map that misses a value.
    let columns = found.tables["front.csv"].header.len();
    for column in (0..columns).filter(|&column| matches!(found.tables["front.csv"].rows[2][column], Cell::Number(_))) {
        let changed = objection(&|answer| bump(&mut answer.tables.get_mut("front.csv").unwrap().rows[2][column], f64::next_up));
        assert!(changed.is_some(), "column {column}");
    }
    assert!(objection(&|answer| bump(answer.summary.get_mut("knee.distance").unwrap(), f64::next_up)).is_some());
    let map = table(&found, "map");
    let cell = found.tables[&map].rows.iter().position(|row| row[2] != Cell::Absent).expect("some cell has a value");
    assert!(objection(&|answer| answer.tables.get_mut(&map).unwrap().rows[cell][2] = Cell::Absent).is_some());
    assert!(objection(&|answer| drop(answer.tables.remove(&map))).is_some());
}

#[test]
fn the_brute_force_front_itself_objects_to_a_dominated_and_a_doubled_point() {
    let keys = [vec![1.0, 5.0], vec![2.0, 4.0], vec![2.0, 4.0], vec![2.0, 5.0], vec![0.5, 6.0]];
    assert_eq!(naive::front(&keys), [0, 1, 4], "2 ties with 1, 3 is dominated by 0 and 1");
}
