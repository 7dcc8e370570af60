//! Random studies with distributions, by brute force and however they are run.

use super::brute::Brute;
use super::draft::{Bound, Draft, Role};
use crate::pipeline::expected::Expected;
use crate::pipeline::naive::Evaluated;
use crate::pipeline::{Coverage, Thorough, check_ways, full};
use crate::random::Random;
use beltspace::plan::Plan;
use beltspace::screen::gpu::supports;
use beltspace::study::{Quantity, Study};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// How much of a value may come from rounding: a tolerance acts on values in SI units, here on those in the input's unit. A share of at most
/// 150 draws cannot be off by so little.
const ROUNDING: f64 = 1e-11;

fn studies() -> u64 {
    if full() { 100 } else { 14 }
}

pub fn parse(text: &str) -> Study {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/formulas/models");
    Study::parse_in(text, "random.toml", &models).unwrap_or_else(|errors| panic!("{errors}"))
}

/// A study's designs at its levels, by brute force.
fn evaluated(study: &Study) -> Evaluated {
    let brute = Brute::new(study);
    let designs = study.design.iter().map(|axis| axis.count()).product();
    Evaluated::by(study, 0..designs, &|inputs| brute.evaluation(inputs))
}

/// The value below which this share lies.
fn at(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get((share * values.len() as f64) as usize).or(values.last()).copied().unwrap_or(0.0)
}

/// Gives the bounds of a draft values that let a part of the draws and designs through.
fn bound(seed: u64, draft: &mut Draft) {
    let random = &mut Random::new(seed ^ 0xb0_0d5);
    let pilot = parse(&draft.text(true));
    let brute = Brute::new(&pilot);
    let designs: u64 = pilot.design.iter().map(|axis| axis.count()).product();
    let cases = Evaluated::by(&pilot, 0..designs, &|_| beltspace::models::Evaluation {
        status: beltspace::models::Status::Ok,
        outputs: Vec::new(),
    });
    let tail = |random: &mut Random, bound: &Bound, values: Vec<f64>, most: f64| {
        let share = random.between(0.0, most);
        at(values, if ["min", "above"].contains(&bound.key) { share } else { 1.0 - share })
    };
    let mut bounds = std::mem::take(&mut draft.bounds);
    for bound in bounds.iter_mut().filter(|it| it.role != Role::Statistic) {
        let quantity = Quantity::Output(brute.model().output(&bound.of).expect("the model has it"));
        let mut values = Vec::new();
        for design in 0..designs {
            for draw in 0..brute.draws().min(10) {
                let inputs = &cases.cases(design)[random.below(cases.scenarios as usize)].inputs;
                values.extend(brute.drawn(inputs, draw).iter().filter_map(|it| it.value(quantity)));
            }
        }
        // A sum over cases is that of the weights times as large, roughly.
        let weights = pilot.probability.as_ref().and_then(|it| it.drive.spectrum.as_ref()).map_or(1.0, |it| it.weights.iter().sum());
        let scale: f64 = if bound.more.contains("sum") { weights } else { 1.0 };
        bound.value = scale * tail(random, bound, values, 0.4 / brute.case_count() as f64);
    }
    draft.bounds = bounds;
    // What is asked of all draws, bounded by nothing yet.
    let loose = |draft: &mut Draft| {
        for bound in draft.bounds.iter_mut().filter(|it| it.role == Role::Statistic) {
            bound.value = if ["min", "above"].contains(&bound.key) { -1e300 } else { 1e300 };
        }
    };
    loose(draft);
    let study = parse(&draft.text(false));
    let found = evaluated(&study);
    for (number, constraint) in study.constraints.iter().enumerate() {
        let least = |design: u64| {
            let values = found.cases(design).iter().map(|it| it.value(constraint.quantity));
            values.collect::<Option<Vec<f64>>>().map(|values| at(values, 0.0))
        };
        let values: Vec<f64> = (0..designs).filter_map(least).collect();
        match draft.bounds.get_mut(number) {
            Some(bound) if bound.role == Role::Statistic => bound.value = tail(random, bound, values, 0.5),
            Some(_) => {}
            // The yield of some design: a bound met exactly.
            None if draft.least_yield.is_some() => draft.least_yield = Some(at(values, random.between(0.0, 0.6))),
            // One draw must hold.
            None => {}
        }
    }
    // Constraints of single draws are none of the study itself, so that the numbers above are off by them.
    let own = draft.bounds.iter().filter(|it| it.role != Role::Draw).count();
    assert_eq!(study.constraints.len(), own + 1);
}

#[test]
fn studies_with_distributions_give_what_brute_force_gives_however_they_are_run() {
    let mut coverage = Coverage::new();
    // Another first seed tries other studies, or one that failed at once.
    let first = std::env::var("BELTSPACE_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(1);
    let mut failed = Vec::new();
    for seed in first..first + studies() {
        let mut text = String::new();
        if catch_unwind(AssertUnwindSafe(|| check(seed, &mut text, &mut coverage))).is_err() {
            eprintln!("seed {seed} (BELTSPACE_SEED={seed} tries it first), study:\n{text}");
            failed.push(seed);
        }
    }
    eprintln!("of {} studies: {coverage:#?}", studies());
    assert!(failed.is_empty(), "the studies of these seeds failed, see above: {failed:?}");
    if first == 1 {
        let missing: Vec<_> = EVERY_FEATURE.iter().filter(|it| !coverage.contains_key(**it)).collect();
        assert!(missing.is_empty(), "no random study has: {missing:?}");
    }
}

fn check(seed: u64, text: &mut String, coverage: &mut Coverage) {
    let mut draft = Draft::new(seed);
    *text = draft.text(true);
    bound(seed, &mut draft);
    *text = draft.text(false);
    let study = parse(text);
    let found = evaluated(&study);
    let expected = Expected::new(&study, &found);
    // Two studies of one text have the same hash, and the description brings it back.
    let again = Study::from_description(&study.describe()).expect("it is a description");
    assert_eq!((again.hash(), &again.describe()), (study.hash(), &study.describe()), "seed {seed}");
    let plan = Plan::new(study);
    let on_gpu = supports(&plan, crate::gpu::device().limited_loops).is_ok();
    let thorough = Thorough { on_gpu, write_all: full() };
    check_ways(seed, text, &plan, thorough, |found| expected.answer.difference_beyond(ROUNDING, found));
    let mut note = |feature: &str| *coverage.entry(feature.to_owned()).or_default() += 1;
    draft.features.iter().for_each(|it| note(it));
    if on_gpu {
        note("on a device");
    }
    note(match expected.feasible.len() as u64 {
        0 => "nothing feasible",
        all if all == found.designs => "all feasible",
        _ => "some feasible",
    });
    if expected.front.len() > 2 {
        note("front of at least 3 points");
    }
    if expected.failures.iter().any(|it| it.meaningless) {
        note("statistic without a value");
    }
    let yields = plan.study.model.output("yield").map(Quantity::Output).expect("a study with distributions has it");
    let shares = (0..found.designs).flat_map(|design| found.cases(design)).filter_map(|it| it.value(yields));
    if shares.into_iter().any(|it| it > 0.0 && it < 1.0) {
        note("yield between 0 and 1");
    }
}

const EVERY_FEATURE: &[&str] = &[
    "metal-cvt",
    "rubber-cvt",
    "pulley-load",
    "timing-belt",
    "flat-belt",
    "formulas around a model",
    "model in a file",
    "truncated",
    "times",
    "plus",
    "correlation",
    "levels",
    "spectrum",
    "operating cases",
    "mean or sum over cases",
    "random",
    "latin-hypercube",
    "sobol",
    "constraint of single draws",
    "constraint with its own yield",
    "constraint of a statistic",
    "yield as objective",
    "yield as constraint",
    "mean",
    "sd",
    "worst",
    "quantile",
    "top",
    "histogram",
    "map",
    "column",
    "variants",
    "some feasible",
    "front of at least 3 points",
    "statistic without a value",
    "yield between 0 and 1",
    "on a device",
];
