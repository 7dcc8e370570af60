//! Sweeps by bounds give the same result as judging every design, for any study.

mod bites;
mod left;
mod structured;
pub mod ways;

use crate::pipeline::naive::Evaluated;
use crate::pipeline::random_study::Draft;
use crate::pipeline::runs::{Pipeline, differing_file};
use crate::pipeline::{Coverage, full, parse};
use crate::random::Random;
use beltspace::bounds::{Certificate, refusal};
use beltspace::error::Error;
use beltspace::plan::Plan;
use beltspace::reduce::State;
use beltspace::study::{Best, Quantity, Study};
use beltspace::sweep::{Control, Settings};
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

/// Designs that constraints and resolutions are chosen by.
const SAMPLE: u64 = 200;

fn studies() -> u64 {
    if full() { 300 } else { 60 }
}

/// A random study that bounds can serve.
fn draft_of(seed: u64) -> (Draft, String) {
    let mut draft = Draft::for_bounds(seed);
    let study = parse(&draft.text());
    let designs: u64 = study.design.iter().map(|axis| axis.count()).product();
    let random = &mut Random::new(seed ^ 0x5A_3B1E);
    let chosen: BTreeSet<u64> = match designs {
        ..=SAMPLE => (0..designs).collect(),
        _ => (0..SAMPLE).map(|_| random.next() % designs).collect(),
    };
    let evaluated = Evaluated::of(&study, chosen);
    draft.constrain(seed, &study, &evaluated);
    let text = draft.text();
    (draft, text)
}

#[test]
fn bounds_find_what_looking_at_every_design_finds() {
    let mut coverage = Coverage::new();
    // Another first seed tries other studies, or one that failed at once.
    let first = std::env::var("BELTSPACE_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(61);
    let mut failed = Vec::new();
    for seed in first..first + studies() {
        let (draft, text) = draft_of(seed);
        if let Err(problem) = guarded(|| check(seed, &draft, &text, &mut coverage)) {
            eprintln!("seed {seed}: {problem}\n{text}\nthe smallest of its parts that fails:\n{}", smallest(&text));
            failed.push(seed);
        }
    }
    eprintln!("of {} studies: {coverage:#?}", studies());
    assert!(failed.is_empty(), "seeds {failed:?} differ");
    for feature in EVERY_FEATURE {
        assert!(coverage.get(*feature).is_some_and(|&count| count > 0), "no random study has: {feature}");
    }
}

/// What went wrong: the error or the panic.
fn guarded(check: impl FnOnce() -> Result<(), String>) -> Result<(), String> {
    catch_unwind(AssertUnwindSafe(check)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().cloned().or_else(|| panic.downcast_ref::<&str>().map(|it| (*it).to_owned()));
        Err(format!("panic: {}", text.unwrap_or_default()))
    })
}

/// A study without the lines that a failure does not need.
fn smallest(text: &str) -> String {
    let fails = |text: &str| {
        let Ok(study) = Study::parse_in(text, "random.toml", ".".as_ref()) else { return false };
        let plan = Plan::new(study);
        refusal(&plan).is_none() && guarded(|| plain_difference(&Pipeline::new(&plan, text)).map(|_| ())).is_err()
    };
    let mut lines: Vec<&str> = text.lines().collect();
    if !fails(text) {
        return "(none: one plain run by bounds gives the same)".to_owned();
    }
    loop {
        let before = lines.len();
        for at in (0..lines.len()).rev() {
            let mut fewer = lines.clone();
            fewer.remove(at);
            if fails(&fewer.join("\n")) {
                lines = fewer;
            }
        }
        if lines.len() == before {
            return lines.join("\n");
        }
    }
}

/// One run of either kind; what both found, and the certificate. `None` if both refuse the front for its size.
fn plain_difference(pipeline: &Pipeline<'_>) -> Result<Option<(State, Certificate)>, String> {
    let options = Settings { threads: 2, ..Settings::default() };
    let reference = match ways::one_by_one(pipeline, &options, None, &Control::default()) {
        Ok(swept) => swept.state,
        Err(Error::FrontBudget { .. }) => {
            let found = ways::by_bounds(pipeline, &options, None, &Control::default());
            return if matches!(found, Err(Error::FrontBudget { .. })) { Ok(None) } else { Err("the front is over the budget".to_owned()) };
        }
        Err(error) => return Err(error.to_string()),
    };
    let (found, certificate) = ways::whole(pipeline, 1)?;
    ways::difference(&reference, &found).map_or(Ok(Some((reference, certificate))), Err)
}

/// Checks one study in every way that must not affect the result.
fn check(seed: u64, draft: &Draft, text: &str, coverage: &mut Coverage) -> Result<(), String> {
    let study = parse(text);
    draft.check_axes(&study);
    let plan = Plan::new(study);
    assert_eq!(refusal(&plan), None);
    let pipeline = Pipeline::new(&plan, text);
    let begun = Instant::now();
    let Some((reference, certificate)) = plain_difference(&pipeline)? else { return Ok(()) };
    let usual = begun.elapsed() / 2;
    cover(draft, &plan, &reference, &certificate, text, coverage);
    let random = &mut Random::new(seed);
    let folder = tempfile::tempdir().expect("a folder can be made");
    let differs = |way: &str, state: &State| match ways::difference(&reference, state) {
        Some(difference) => Err(format!("{way}: {difference}")),
        None => Ok(()),
    };
    let threads = random.whole(2, 3);
    let (state, _) = ways::whole(&pipeline, threads)?;
    differs("several threads", &state)?;
    let (state, shared) = ways::whole_shared(&pipeline, threads)?;
    differs("what searches share", &state)?;
    cover_shared(&certificate, &shared, coverage);
    // Folders and checkpoints are synced to the disk, which takes most of the time.
    if full() || seed.is_multiple_of(3) {
        differs("shards", &ways::sharded(&pipeline, random, folder.path()))?;
        let (state, stops) = ways::stopped(&pipeline, random, text, usual, &folder.path().join("stopped"))?;
        differs("stopped and resumed", &state)?;
        if stops > 0 {
            *coverage.entry("stopped and resumed by the other method".to_owned()).or_default() += 1;
        }
    }
    if seed.is_multiple_of(if full() { 3 } else { 10 }) {
        let expected = pipeline.write(reference.clone(), 1, &folder.path().join("expected"));
        let found = pipeline.write(state, threads, &folder.path().join("found"));
        if let Some(name) = differing_file(&expected, &found) {
            return Err(format!("{name} differs"));
        }
        *coverage.entry("files written".to_owned()).or_default() += 1;
    }
    Ok(())
}

const EVERY_FEATURE: &[&str] = &[
    "rubber-cvt",
    "metal-cvt",
    "pulley-load",
    "timing-belt",
    "one value",
    "list",
    "count",
    "log count",
    "step",
    "log step",
    "whole numbers",
    "joint axis in operation",
    "joint axis in uncertainty",
    "words and numbers on one axis",
    "inert axis",
    "several scenarios",
    "one design axis",
    "five design axes",
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
    "inclusive bound",
    "strict bound",
    "bounds on both sides",
    "top",
    "sample",
    "histogram",
    "histogram with a given range",
    "map of the best",
    "map of shares",
    "front of at least 20 points",
    "nothing feasible",
    "some feasible",
    "all feasible",
    "at most 10 designs",
    "at least 30000 designs",
    "files written",
    "stopped and resumed by the other method",
    "count: infeasible boxes",
    "count: feasible boxes",
    "count: products",
    "count: pairs",
    "count: evaluated",
    "histogram: infeasible boxes",
    "histogram: feasible boxes",
    "histogram: products",
    "histogram: pairs",
    "histogram: evaluated",
    "map: infeasible boxes",
    "map: feasible boxes",
    "map: products",
    "map: evaluated",
    "search: infeasible boxes",
    "search: beaten boxes",
    "search: evaluated",
    "sample: infeasible boxes",
    "sample: later designs",
    "judged for all",
    "judged for all, then counted",
    "in part judged for all",
    "tallies judged",
];

/// Counts what the searches of a study had in common, beside its certificate where each is by itself.
fn cover_shared(alone: &Certificate, shared: &Certificate, coverage: &mut Coverage) {
    let mut note = |feature: &str, there: bool| {
        if there {
            *coverage.entry(feature.to_owned()).or_default() += 1;
        }
    };
    let boxes: Vec<u64> = shared.searches.iter().map(|(_, it)| it.boxes).collect();
    // The first looks for the front, by itself; the second judges for those that follow.
    let others = boxes.get(2..).unwrap_or_default();
    note("judged for all", !others.is_empty() && others.iter().all(|&boxes| boxes == 0));
    note(
        "in part judged for all",
        shared.searches.iter().zip(&alone.searches).skip(1).any(|((_, it), (_, own))| it.boxes > 0 && it.evaluations < own.evaluations),
    );
    note("judged for all, then counted", shared.tallies.is_empty() && shared.count.boxes == 0 && shared.count.evaluated > 0);
    note("tallies judged", shared.tallies.iter().zip(&alone.tallies).any(|((_, it), (_, own))| it.boxes == 0 && own.boxes > 0));
}

/// Counts what a study had, and by which rules its designs were settled.
fn cover(draft: &Draft, plan: &Plan, state: &State, certificate: &Certificate, text: &str, coverage: &mut Coverage) {
    let study = &plan.study;
    let mut had: BTreeSet<String> = draft.kinds().collect();
    let mut note = |feature: &str, there: bool| {
        if there {
            had.insert(feature.to_owned());
        }
    };
    note(&study.model.name, true);
    let mixed =
        |line: &str| line.contains(" = [") && line.contains('"') && !line.contains('{') && line.chars().any(|it| it.is_ascii_digit());
    note("words and numbers on one axis", text.lines().any(mixed));
    note("inert axis", !plan.inert_axes().is_empty());
    note("several scenarios", plan.scenarios() > 1);
    let axes = study.design.iter().filter(|axis| axis.count() > 1).count();
    note("one design axis", axes == 1);
    note("five design axes", axes == 5);
    note(&format!("{} objectives", study.objectives.len()), true);
    let is_input = |quantity: Quantity| matches!(quantity, Quantity::Input(_));
    note("resolution", study.objectives.iter().any(|it| it.resolution.is_some()));
    note("input as objective", study.objectives.iter().any(|it| is_input(it.quantity)));
    note("input as constraint", study.constraints.iter().any(|it| is_input(it.quantity)));
    let strict = |which: bool| study.constraints.iter().flat_map(|it| [it.low, it.high]).flatten().any(|(_, strict)| strict == which);
    note("inclusive bound", strict(false));
    note("strict bound", strict(true));
    note("bounds on both sides", study.constraints.iter().any(|it| it.low.is_some() && it.high.is_some()));
    note("top", study.report.top.is_some());
    note("sample", study.report.sample.is_some());
    let report = &study.report;
    note("histogram", !report.histograms.is_empty());
    note("histogram with a given range", report.histograms.iter().any(|it| it.range.is_some()));
    note("map of the best", report.maps.iter().any(|it| it.value != Best::Share));
    note("map of shares", report.maps.iter().any(|it| it.value == Best::Share));
    note("front of at least 20 points", state.front.len() >= 20);
    let designs = plan.designs();
    note("nothing feasible", state.feasible == 0);
    note("some feasible", 0 < state.feasible && state.feasible < designs);
    note("all feasible", state.feasible == designs);
    note("at most 10 designs", designs <= 10);
    note("at least 30000 designs", designs >= 30_000);
    let count = &certificate.count;
    note("count: infeasible boxes", count.infeasible > 0);
    note("count: feasible boxes", count.feasible > 0);
    note("count: products", count.products > 0);
    note("count: pairs", count.pairs > 0);
    note("count: evaluated", count.evaluated > 0);
    for (what, it) in &certificate.tallies {
        let what = if what.starts_with("histogram") { "histogram" } else { "map" };
        note(&format!("{what}: infeasible boxes"), it.infeasible > 0);
        note(&format!("{what}: feasible boxes"), it.feasible > 0);
        note(&format!("{what}: products"), it.products > 0);
        note(&format!("{what}: pairs"), it.pairs > 0);
        note(&format!("{what}: evaluated"), it.evaluated > 0);
    }
    for (_, it) in &certificate.searches {
        note("search: infeasible boxes", it.infeasible > 0);
        note("search: beaten boxes", it.beaten > 0);
        note("search: pairs", it.pairs > 0);
        note("search: evaluated", it.evaluated > 0);
    }
    for (_, it) in certificate.searches.iter().filter(|(what, _)| what == "sample") {
        note("sample: infeasible boxes", it.infeasible > 0);
        note("sample: later designs", it.beaten > 0);
    }
    for feature in had {
        *coverage.entry(feature).or_default() += 1;
    }
}
