//! Random studies with random formulas: every engine and method against a walk over trees that knows nothing of the crate but its
//! models.

mod asked;
mod bites;
mod cover;
mod grow;
mod measure;
mod study;
mod tree;
mod walk;

use crate::bounds::ways;
use crate::pipeline::expected::Expected;
use crate::pipeline::runs::{Pipeline, differing_file};
use crate::pipeline::{Coverage, Thorough, check_ways, full};
use crate::random::Random;
use asked::{Asked, Whole, parsed, walked};
use beltspace::bounds::refusal;
use beltspace::plan::Plan;
use beltspace::sweep::{Control, Settings};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};
use study::Around;
use tempfile::TempDir;

/// How much of a value may come from rounding.
const TOLERANCE: f64 = 1e-9;
/// How much an answer may change when every operation is off by a little: what changes more loses its digits somewhere.
const ROBUST: f64 = 1e-5;
/// How long the device may take to build its kernels in the short run.
const PATIENCE: Duration = Duration::from_secs(20);

fn studies() -> u64 {
    if full() { 200 } else { 24 }
}

/// A study that means the same to the last decision however its numbers are rounded.
struct Drawn {
    around: Around,
    asked: Asked,
    whole: Whole,
    expected: Expected,
    folder: TempDir,
    designs: u64,
    /// How many drafts had to be thrown away.
    thrown: Thrown,
}

/// Why drafts were thrown away.
#[derive(Clone, Copy, Debug, Default)]
struct Thrown {
    /// Hardly a design had a meaning.
    meaningless: usize,
    /// Some decision hung on rounding.
    unsure: usize,
    /// Too many or too few designs were feasible.
    one_sided: usize,
}

/// The study of a seed.
fn drawn(seed: u64) -> Drawn {
    let mut thrown = Thrown::default();
    for attempt in 0.. {
        assert!(attempt < 500, "seed {seed}: no draft is a study: {thrown:?}");
        let random = &mut Random::new(seed.wrapping_mul(1_000_003).wrapping_add(attempt));
        let Some(around) = Around::new(seed, random) else {
            thrown.meaningless += 1;
            continue;
        };
        let folder = tempfile::tempdir().expect("a folder can be made");
        around.write_curves(folder.path(), random);
        let mut asked = Asked::draw(&around, random);
        let study = parsed(&asked.text(&around, 1, true), folder.path());
        let designs = study.design.iter().map(|axis| axis.count()).product();
        let evaluated = walked(&study, &around.walker);
        // A few studies have no feasible design on purpose, and in a few more anything may come out.
        asked.constrain(random, &study, &evaluated, seed % 12 == 5);
        let text = asked.text(&around, designs, true);
        let study = parsed(&text, folder.path());
        let expected = Expected::new(&study, &evaluated);
        let share = expected.feasible.len() as f64 / designs as f64;
        if ![5, 9].contains(&(seed % 12)) && !(0.02..=0.98).contains(&share) {
            thrown.one_sided += 1;
            continue;
        }
        let whole = Whole { text, study, evaluated };
        if !is_robust(&around, &whole, &expected) {
            thrown.unsure += 1;
            continue;
        }
        return Drawn { around, asked, whole, expected, folder, designs, thrown };
    }
    unreachable!("attempts do not run out")
}

/// Does the answer stay the same when every operation is off by a little, and no value stand at a bound?
fn is_robust(around: &Around, whole: &Whole, expected: &Expected) -> bool {
    let at_bound = |value: f64, bound: f64| value != bound && (value - bound).abs() <= TOLERANCE * value.abs().max(bound.abs());
    let study = &whole.study;
    let near = |design: u64| {
        study.constraints.iter().any(|constraint| {
            let bounds = [constraint.low, constraint.high].into_iter().flatten();
            let values = || whole.evaluated.cases(design).iter().filter_map(|case| case.value(constraint.quantity));
            bounds.into_iter().any(|(bound, _)| values().any(|value| at_bound(value, bound)))
        })
    };
    let same = |shake: u64| {
        let walker = around.walker.with(shake, None);
        let shaken = Expected::new(study, &walked(study, &walker));
        !walker.doubtful.get()
            && expected.answer.difference_beyond(ROBUST, &shaken.answer).is_none()
            && shaken.feasible == expected.feasible
    };
    !around.walker.doubtful.get() && !(0..whole.evaluated.designs).any(near) && same(1) && same(2)
}

#[test]
fn random_formulas_give_what_a_walk_over_their_trees_gives_however_they_are_run() {
    let mut coverage = Coverage::new();
    // Another first seed tries other studies, or one that failed at once.
    let first = std::env::var("BELTSPACE_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(1);
    let (mut on_device, mut failed) = (Duration::ZERO, Vec::new());
    for seed in first..first + studies() {
        let mut text = String::new();
        let device = on_device < PATIENCE && (full() || seed % 12 == 1);
        let checked = catch_unwind(AssertUnwindSafe(|| check(seed, device, &mut text, &mut coverage)));
        match checked {
            Ok(took) => on_device += took,
            Err(_) => {
                eprintln!("seed {seed} (BELTSPACE_SEED={seed} tries it first), study:\n{text}");
                failed.push(seed);
            }
        }
    }
    eprintln!("of {} studies: {coverage:#?}", studies());
    assert!(failed.is_empty(), "the studies of these seeds failed, see above: {failed:?}");
    if first == 1 {
        let missing = cover::missing(&coverage, full());
        assert!(missing.is_empty(), "too few random studies have: {missing:?}");
    }
}

/// Checks one study; `text` is for the message if it fails. Returns how long the device took.
fn check(seed: u64, device: bool, text: &mut String, coverage: &mut Coverage) -> Duration {
    let drawn = drawn(seed);
    text.clone_from(&drawn.whole.text);
    let curves = drawn.around.walker.curves.iter();
    text.extend(curves.map(|curve| format!("# {}.csv: {:?}\n", curve.name, curve.points)));
    let plan = Plan::new(parsed(&drawn.whole.text, drawn.folder.path()));
    let thorough = Thorough { on_gpu: false, write_all: false };
    check_ways(seed, &drawn.whole.text, &plan, thorough, |found| drawn.expected.answer.difference_beyond(TOLERANCE, found));
    let mut took = Duration::ZERO;
    if device {
        let begun = Instant::now();
        check_device(&plan, &drawn);
        took = begun.elapsed();
        *coverage.entry("on the device".to_owned()).or_default() += 1;
    }
    let by_bounds = check_bounds(seed, &drawn);
    *coverage.entry(if by_bounds { "by bounds" } else { "refused by bounds" }.to_owned()).or_default() += 1;
    cover::count(&drawn, &plan, coverage);
    took
}

/// The device and the CPU write the same bytes.
fn check_device(plan: &Plan, drawn: &Drawn) {
    let pipeline = Pipeline::new(plan, &drawn.whole.text);
    let folder = tempfile::tempdir().expect("a folder can be made");
    let on_cpu = pipeline.write(pipeline.whole(&Settings::default()), 1, &folder.path().join("cpu"));
    let (state, on_device) = pipeline.on_device(false, &folder.path().join("device"));
    assert_eq!(state.feasible, drawn.expected.feasible.len() as u64, "on the device");
    assert_eq!(differing_file(&on_cpu, &on_device), None, "on the device");
}

/// Bounds and single designs give the same, where bounds serve the study; false where they do not.
fn check_bounds(seed: u64, drawn: &Drawn) -> bool {
    let text = drawn.asked.text(&drawn.around, drawn.designs, false);
    if !text.contains("[objectives]") && !text.contains("top = ") {
        return false;
    }
    let plan = Plan::new(parsed(&text, drawn.folder.path()));
    if refusal(&plan).is_some() {
        return false;
    }
    let pipeline = Pipeline::new(&plan, &text);
    let one_by_one = ways::one_by_one(&pipeline, &Settings::default(), None, &Control::default()).expect("the sweep ends").state;
    let (by_bounds, _) = ways::whole(&pipeline, 1 + seed as usize % 2).unwrap_or_else(|error| panic!("by bounds: {error}"));
    assert_eq!(ways::difference(&one_by_one, &by_bounds), None, "by bounds");
    let folder = tempfile::tempdir().expect("a folder can be made");
    let files = [("each", one_by_one), ("bounds", by_bounds)].map(|(name, state)| pipeline.write(state, 1, &folder.path().join(name)));
    assert_eq!(differing_file(&files[0], &files[1]), None, "by bounds");
    true
}
