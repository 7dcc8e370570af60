//! Bounds that are given up: whenever that happens, the result is the same as if every design were judged.

use super::ways::{by_bounds, difference, one_by_one};
use crate::pipeline::parse;
use crate::pipeline::runs::{Pipeline, differing_file};
use crate::random::Random;
use beltspace::checkpoint::Checkpoint;
use beltspace::error::Error;
use beltspace::files::Claim;
use beltspace::plan::Plan;
use beltspace::reduce::State;
use beltspace::screen::gpu::Wrong;
use beltspace::sweep::costs::Speed;
use beltspace::sweep::{Auto, Control, Leaving, Left, Rule, Settings, Settler, Swept, sweep_auto};
use beltspace::tiles::Shard;
use std::path::Path;
use std::sync::atomic::Ordering;

/// A study for which bounds split many boxes, for front, best list and extremes as well as for the count.
const STUDY: &str = r#"model = "pulley-load"
[design]
mean_radius_mm   = { from = 40, to = 80, count = 43 }
slack_tension_N  = { from = 100, to = 900, count = 61 }
groove_angle_deg = { from = 34, to = 38, count = 9 }
groove_count     = { from = 1, to = 3 }
[operation]
cases = [{ power_kW = 3.0, speed_rpm = 3000 }, { power_kW = 4.0, speed_rpm = 6500 }]
[uncertainty]
friction_direction_deg = [0, 45]
[constraints]
friction_margin = { min = 0.05 }
[objectives]
resultant_force_N = "min"
mean_radius_mm = "min"
[report]
top = { by = "resultant_force_N", count = 5 }
sample = 1_000_000
histograms = [{ of = "friction_margin", bins = 12 }]
maps = [
    { x = "mean_radius_mm", y = "groove_count", value = "resultant_force_N" },
    { x = "slack_tension_N", y = "groove_angle_deg", best = "share" },
]
"#;

/// Fractions of the bounds' work after which they are given up: at once, in the search for the front, for an extreme, for the map, for the
/// sample, in the counts.
const SHARES: [f64; 6] = [0.0, 0.05, 0.41, 0.6, 0.645, 0.93];

/// As if a thread took this many seconds for each design.
fn taking(seconds: f64) -> Rule<'static> {
    Rule { speed: Speed { seconds, measured: true }, device: None, leaving: Leaving::WhereTheyDoNotPay }
}

fn auto(
    pipeline: &Pipeline<'_>,
    options: &Settings,
    checkpoint: Option<&mut Checkpoint>,
    control: &Control,
    rule: &Rule<'_>,
) -> Result<Auto, Error> {
    sweep_auto(pipeline.plan, &pipeline.tables, &pipeline.reduction, options, checkpoint, control, rule)
}

fn leaving(
    pipeline: &Pipeline<'_>,
    share: f64,
    options: &Settings,
    checkpoint: Option<&mut Checkpoint>,
) -> Result<(Swept, Option<Left>), Error> {
    let rule = Rule { leaving: Leaving::After(share), ..taking(1.0) };
    let control = Control::default();
    let Auto { swept, settler, .. } = auto(pipeline, options, checkpoint, &control, &rule)?;
    let left = match settler {
        Settler::Both(left) => {
            assert_eq!(control.settled_for(), None, "what is shown is that designs are judged");
            Some(left)
        }
        Settler::Bounds(_) | Settler::EveryDesign | Settler::Tried(_) => None,
    };
    Ok((swept, left))
}

fn begun(pipeline: &Pipeline<'_>, shard: Shard, folder: &Path) -> (Claim, Checkpoint) {
    let claim = Claim::new(folder, "a test").expect("nobody has it");
    let (study, designs) = (&pipeline.plan.study, pipeline.plan.designs());
    let checkpoint = Checkpoint::create(&claim, study, STUDY, shard, designs).expect("a folder can be made");
    (claim, checkpoint)
}

fn reference(pipeline: &Pipeline<'_>) -> State {
    one_by_one(pipeline, &Settings { threads: 2, ..Settings::default() }, None, &Control::default()).expect("the sweep ends").state
}

#[test]
fn whenever_bounds_are_left_the_files_are_the_same() {
    let plan = Plan::new(parse(STUDY));
    let pipeline = Pipeline::new(&plan, STUDY);
    let expected = reference(&pipeline);
    let folder = tempfile::tempdir().expect("a folder can be made");
    let files = pipeline.write(expected.clone(), 1, &folder.path().join("expected"));
    let mut phases = Vec::new();
    for (number, share) in SHARES.into_iter().enumerate() {
        for threads in [1, 3] {
            let options = Settings { threads, ..Settings::default() };
            let (swept, left) = leaving(&pipeline, share, &options, None).expect("the sweep ends");
            let left = left.unwrap_or_else(|| panic!("bounds are not left at {share}"));
            assert_eq!(difference(&expected, &swept.state), None, "{left:?}");
            assert_eq!(
                (swept.designs, left.counted + left.judged),
                (plan.designs(), plan.designs()),
                "no design is judged twice: {left:?}"
            );
            assert!(left.forecast.settled >= share && left.forecast.settled < 1.0, "{left:?}");
            if threads == 1 {
                let found = pipeline.write(swept.state, 1, &folder.path().join(format!("found-{number}")));
                assert_eq!(differing_file(&files, &found), None, "{left:?}");
                phases.push((left.at.clone(), left.counted > 0));
            }
        }
    }
    // Nine passes: front, best, four extremes, the best of a map's cells, the sample; and three counts together.
    assert!(phases[0].0.starts_with("front, 1 of 9") && phases[1].0.starts_with("front, 1 of 9"), "{phases:?}");
    // What a search judges for those that follow is told at once, so that it is left a little sooner than in the middle of all.
    assert!(phases[2].0 == "largest resultant_force_N, 4 of 9" && phases[..5].iter().all(|it| !it.1), "{phases:?}");
    assert_eq!([3, 4].map(|at| &*phases[at].0), ["map of resultant_force_N, 7 of 9", "sample, 8 of 9"], "{phases:?}");
    assert_eq!(phases[5], ("counts, 9 of 9".to_owned(), true), "what is counted is kept");
}

/// Shards merge to the same; of how many was it so? Half of them continue from earlier checkpoints.
fn shards_of_which(seed: u64, mut is_so: impl FnMut(&mut Random, &Pipeline<'_>, &Settings, &mut Checkpoint) -> bool) -> u32 {
    let plan = Plan::new(parse(STUDY));
    let pipeline = Pipeline::new(&plan, STUDY);
    let folder = tempfile::tempdir().expect("a folder can be made");
    let mut count = 0;
    let state = pipeline.sharded_by(&mut Random::new(seed), folder.path(), |random, options, checkpoint| {
        count += u32::from(is_so(random, &pipeline, options, checkpoint));
    });
    assert_eq!(difference(&reference(&pipeline), &state), None);
    count
}

#[test]
fn shards_that_leave_bounds_merge_to_the_same() {
    let left = shards_of_which(3, |random, pipeline, options, checkpoint| {
        leaving(pipeline, random.pick(&SHARES), options, Some(checkpoint)).expect("the sweep ends").1.is_some()
    });
    assert!(left > 0, "no shard left bounds");
}

#[test]
fn shards_try_their_own_designs() {
    let settled = shards_of_which(5, |_, pipeline, options, checkpoint| {
        // Judging takes so long that histograms and maps are worth any trial, and bounds are never left.
        let swept = auto(pipeline, options, Some(checkpoint), &Control::default(), &taking(1e3)).expect("the sweep ends");
        matches!(swept.settler, Settler::Bounds(_))
    });
    assert!(settled > 0, "no shard was settled by bounds");
}

#[test]
fn a_run_that_left_bounds_is_resumed_by_any_method() {
    let plan = Plan::new(parse(STUDY));
    let pipeline = Pipeline::new(&plan, STUDY);
    let expected = reference(&pipeline);
    let folder = tempfile::tempdir().expect("a folder can be made");
    for (number, method) in ["bounds", "every design", "auto"].into_iter().enumerate() {
        let (claim, mut checkpoint) = begun(&pipeline, Shard::WHOLE, &folder.path().join(number.to_string()));
        // Stopped from outside during the count: only some of it is kept.
        let stopped = Control::default();
        let result = std::thread::scope(|scope| {
            scope.spawn(|| {
                // Three counts are three tenths of the work.
                while stopped.done.load(Ordering::Relaxed) < plan.designs() / 4 * 3 {
                    std::thread::yield_now();
                }
                stopped.stop.store(true, Ordering::Relaxed);
            });
            let options = Settings { threads: 1, ..Settings::default() };
            auto(&pipeline, &options, Some(&mut checkpoint), &stopped, &taking(1e3))
        });
        // It may have ended before it noticed.
        assert!(matches!(result, Err(Error::Stopped { .. }) | Ok(Auto { settler: Settler::Bounds(_), .. })), "{result:?}");
        drop(checkpoint);
        let mut checkpoint = Checkpoint::open(&claim).expect("what was done is kept");
        assert!(checkpoint.saved().has_progress());
        let (options, control) = (Settings { threads: 2, ..Settings::default() }, Control::default());
        let state = match method {
            "bounds" => by_bounds(&pipeline, &options, Some(&mut checkpoint), &control).expect("it ends").0.state,
            "auto" => leaving(&pipeline, 0.3, &options, Some(&mut checkpoint)).expect("it ends").0.state,
            _ => one_by_one(&pipeline, &options, Some(&mut checkpoint), &control).expect("it ends").state,
        };
        assert_eq!(difference(&expected, &state), None, "{method}");
    }
}

/// A study of which bounds settle almost nothing in a minute, while every design can be judged in a second.
const SLOW: &str = r#"model = "timing-belt"
preset = "ohc-driven"
[design]
space_half_angle_deg = { from = 4.2, to = 6.300202539223348, step = 0.09546375178287946 }
centrifugal_land_friction = { from = 0, to = 1 }
friction = { from = 0.332, to = 0.4362754791485245, count = 38, spacing = "log" }
pulley_speed_rpm = { from = 9030.0, to = 8510.0, count = 30, spacing = "log" }
[uncertainty]
tooth_compliance_um_per_N = { from = 7.574761552656416, to = 6.96, count = 3, spacing = "log" }
teeth_in_mesh = { from = 22, to = 23 }
[fixed]
tight_span_angle_deg = 2.283616152672057
[objectives]
least_tooth_load_N = { goal = "min", resolution = 0.052888952309719885 }
peak_tooth_load_N = { goal = "min", resolution = 0.018214795755776923 }
[report]
top = { by = "peak_tooth_load_N", count = 1000 }
"#;

#[test]
fn a_study_that_bounds_cannot_settle_is_judged() {
    let plan = Plan::new(parse(SLOW));
    let pipeline = Pipeline::new(&plan, SLOW);
    // Judged once for all searches, the designs would be done sooner than bounds are left.
    let options = Settings { threads: 2, shares_judged: false, ..Settings::default() };
    // As if judging it took a little more than a second: with less, bounds would not be tried.
    let swept_as_if = |seconds: f64| {
        let rule = taking(2.0 * seconds / plan.designs() as f64);
        auto(&pipeline, &options, None, &Control::default(), &rule).expect("the sweep ends")
    };
    let Auto { swept, settler, .. } = swept_as_if(1.1);
    assert!(matches!(&settler, Settler::Both(left) if left.forecast.bounds > left.forecast.judging), "{settler:?}");
    assert_eq!(difference(&reference(&pipeline), &swept.state), None);
    // Where most of the work would be in a histogram, that is tried first.
    let text = format!("{SLOW}histograms = [{{ of = \"peak_tooth_load_N\", bins = 1000 }}]\n");
    let plan = Plan::new(parse(&text));
    let pipeline = Pipeline::new(&plan, &text);
    let rule = taking(2.0 * 1.1 / plan.designs() as f64);
    let Auto { swept, settler, .. } = auto(&pipeline, &options, None, &Control::default(), &rule).expect("the sweep ends");
    assert!(matches!(settler, Settler::Tried(forecast) if forecast.bounds > forecast.judging), "{settler:?}");
    assert_eq!(difference(&reference(&pipeline), &swept.state), None);
    // Every design of such a short study is judged at once.
    let Auto { settler, .. } = swept_as_if(0.9);
    assert!(matches!(settler, Settler::EveryDesign), "{settler:?}");
}

#[test]
fn a_device_goes_on_where_bounds_are_left() {
    let plan = Plan::new(parse(STUDY));
    let pipeline = Pipeline::new(&plan, STUDY);
    let device = crate::gpu::wrong(Wrong::default());
    let expected = reference(&pipeline);
    for share in [0.05, 0.93] {
        let rule = Rule { device: Some(&device), leaving: Leaving::After(share), ..taking(1.0) };
        let options = Settings { threads: 1, ..Settings::default() };
        let Auto { swept, settler, device } = auto(&pipeline, &options, None, &Control::default(), &rule).expect("the sweep ends");
        let Settler::Both(left) = settler else { panic!("bounds are not left at {share}") };
        assert_eq!(difference(&expected, &swept.state), None, "{left:?}");
        assert!(device.is_some_and(|it| it.designs >= left.judged) && left.judged > 0, "{left:?}");
    }
}
