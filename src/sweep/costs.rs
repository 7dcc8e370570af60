//! What judging every design takes here, and whether bounds pay: one estimate for `check`, `--method auto` and the jobs of a cluster.

use super::{Control, Settings, SweepJob, look_around, tile_end};
use crate::bounds::refusal;
use crate::models::Effort;
use crate::parallel::on_threads;
use crate::plan::Plan;
use crate::reduce::{Points, Reducers, Reduction};
use crate::screen::{CpuEngine, Tables, Tally};
use std::time::{Duration, Instant};

/// Seconds above which a single design is not tried.
const LONGEST: f64 = 1.0;
/// Places of the study that are tried.
const PLACES: u64 = 5;
/// Seconds that a piece between two looks at the clock should take at most, and most designs of one: those of a sweep.
const PIECE: f64 = 0.1;
const LARGEST: u64 = 1 << 16;
/// How long `--method auto` measures, and how long first, which is enough where judging every design takes far less than [`SHORT`].
const BRIEFLY: Duration = Duration::from_millis(100);
const GLANCE: Duration = Duration::from_millis(4);
/// There is no glance at a model by which a thread judges fewer designs than this in its time.
const GLANCED_AT: f64 = 40.0;
/// A glance is enough if by it all designs take less than this part of [`SHORT`].
const GLANCED: f64 = 0.25;
/// It may have met nothing but rows that fail at once: so the model too must say that all designs take less than this many times [`SHORT`].
const TOLD: f64 = 4.0;
/// Seconds that judging every design may take before bounds are thought of.
const SHORT: f64 = 1.0;
/// Bounds may take this fraction of the time that judging every design would take before a forecast decides about them: what is lost where they
/// are left.
pub const PATIENCE: f64 = 0.25;
/// A count keeps what it has counted, and is judged by its own pace after this share.
const COUNT_PATIENCE: f64 = 0.1;
/// Up to this fraction of that time the better of two paces counts, of late and on the whole: designs are settled in bursts. Then it is that of
/// late, which shows where nothing moves any more.
const BURSTS: f64 = 0.4;
/// The pace of late is that of the last half of the time.
const RECENT: f64 = 0.5;
/// Bounds that are expected to end within so many times the time of judging every design stay: leaving them would take as long.
const TOLERANCE: f64 = 1.25;
/// Seconds between two notes of the pace grow by this much.
const SPACING: f64 = 1.05;

/// How fast a thread judges designs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speed {
    /// Seconds that a thread takes for a design.
    pub seconds: f64,
    /// Was that measured, or is it what the model says?
    pub measured: bool,
}

#[allow(clippy::cast_precision_loss, reason = "an estimate")]
impl Speed {
    /// What the model says.
    pub fn told(plan: &Plan) -> Self {
        Self { seconds: plan.seconds_per_design(), measured: false }
    }

    /// Measured for so long, on as many threads as shall judge, all at the same time. A model of which a single design takes long is
    /// believed.
    pub fn measured(plan: &Plan, threads: usize, time: Duration) -> Self {
        let Effort { prepare, finish } = plan.effort();
        if prepare + finish > LONGEST {
            return Self::told(plan);
        }
        let tables = Tables::new(plan);
        // How many edges a row crosses is most of what a histogram takes where designs are not counted one by one.
        let ranges = if tables.has_ordered_rows() {
            ranges_for_trial(plan, &tables, threads, time)
        } else {
            vec![(0.0, 1.0); plan.study.report.histograms.len()]
        };
        let reduction = Reduction::new(plan, &ranges);
        let known = if tables.has_ordered_rows() {
            // A sweep starts with such a front too.
            let (options, control) = (Settings { threads, ..Settings::default() }, Control::default());
            let job = SweepJob { plan, tables: &tables, reduction: &Reduction::of_front(plan), options: &options, control: &control };
            look_around(job, &(0..plan.designs()), time.as_secs_f64()).front.points().clone()
        } else {
            Points::default()
        };
        let seconds = on_threads(0..threads.max(1), |thread| {
            let reducers = reduction.start_after(known.clone());
            trial(plan, (&tables, &reduction, reducers), (thread as u64, threads.max(1) as u64), time)
        });
        Self { seconds: seconds.iter().sum::<f64>() / seconds.len() as f64, measured: true }
    }

    /// Measured for a moment, unless the model says that all designs together take no longer. First at a glance, which is enough where
    /// they take far less than a second.
    pub fn quick(plan: &Plan, threads: usize) -> Self {
        let of_all = |speed: &Self| speed.of(plan.designs(), threads);
        let told = Self::told(plan);
        if of_all(&told) < BRIEFLY.as_secs_f64() {
            return told;
        }
        let is_quick = GLANCED_AT * told.seconds < GLANCE.as_secs_f64() && of_all(&told) < TOLD * SHORT;
        let glanced = is_quick.then(|| Self::measured(plan, threads, GLANCE));
        glanced.filter(|it| of_all(it) < GLANCED * SHORT).unwrap_or_else(|| Self::measured(plan, threads, BRIEFLY))
    }

    /// Seconds that `threads` threads take for `designs` designs.
    pub fn of(&self, designs: u64, threads: usize) -> f64 {
        self.seconds * designs as f64 / threads.max(1) as f64
    }

    /// How it is known, in words.
    pub fn how(&self) -> &'static str {
        if self.measured { "measured over a moment" } else { "by what the model usually takes" }
    }
}

/// Ranges of histograms for a trial of so long: those of a sweep, unless its sample alone took longer. Any serve then, but tell less.
pub(super) fn ranges_for_trial(plan: &Plan, tables: &Tables, threads: usize, time: Duration) -> Vec<(f64, f64)> {
    let histograms = &plan.study.report.histograms;
    match histograms.iter().map(|spec| spec.range).collect() {
        Some(given) => given,
        None if plan.seconds_per_design() * plan.study.model.sample as f64 / threads as f64 > time.as_secs_f64() => {
            vec![(0.0, 1.0); histograms.len()]
        }
        None => Tally::new(plan, tables, threads).histogram_ranges(plan),
    }
}

/// Seconds per design on one thread, at places all over the study.
///
/// At each place designs are judged one after another, as a sweep does: what neighbours share is most of the work of some models. Of a slow
/// one only the beginnings of rows are tried; then the model says what that means for whole rows.
#[allow(clippy::cast_precision_loss, reason = "an estimate")]
fn trial(
    plan: &Plan,
    (tables, reduction, mut reducers): (&Tables, &Reduction, Reducers),
    (thread, threads): (u64, u64),
    time: Duration,
) -> f64 {
    let Effort { prepare, finish } = plan.effort();
    let mut engine = CpuEngine::new(plan, tables);
    let moment = time / PLACES as u32;
    let row = plan.fast.count();
    let piece = ((PIECE.min(moment.as_secs_f64()) / plan.seconds_per_design()) as u64).clamp(1, LARGEST);
    let places = (PLACES * threads).min(plan.designs());
    let edge = |place: u64| (u128::from(plan.designs()) * u128::from(place) / u128::from(places)) as u64;
    let (mut sum, mut tried) = (0.0, 0.0);
    for place in (thread % places..places).step_by(threads as usize) {
        let (first, last) = (edge(place), edge(place + 1));
        let (begin, mut at, mut rows, mut seconds) = (Instant::now(), first, 0u64, 0.0);
        while at < last && (at == first || begin.elapsed() < moment) {
            let end = last.min(tile_end(at, piece, row));
            if tables.has_ordered_rows() {
                // Columns are sorted once in a sweep: that does not count.
                engine.screen_for(at..end, reduction, &mut reducers);
            }
            let start = Instant::now();
            engine.screen_for(at..end, reduction, &mut reducers);
            seconds += start.elapsed().as_secs_f64();
            rows += (end - 1) / row - at / row + 1;
            at = end;
        }
        let judged = (at - first) as f64;
        sum += if (at - first) >= row {
            seconds / judged
        } else {
            plan.seconds_per_design() * seconds / (rows as f64 * prepare + judged * finish)
        };
        tried += 1.0;
    }
    sum / tried
}

/// Why `--method auto` judges every design of a study from the beginning, if that takes so many seconds; `None` if it begins by bounds.
pub fn why_every_design(plan: &Plan, seconds: f64) -> Option<String> {
    match refusal(plan) {
        Some(why) => Some(format!("bounds cannot serve the study: {why}")),
        None if seconds < SHORT => Some("the study is small enough to judge every design".to_owned()),
        None => None,
    }
}

/// How long bounds are expected to take, and judging one by one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// Seconds that bounds have taken.
    pub spent: f64,
    /// Share of what they are to settle that they had settled.
    pub settled: f64,
    /// Seconds that they would take for the rest; infinite if nothing moves.
    pub bounds: f64,
    /// Seconds that judging the rest would take.
    pub judging: f64,
}

/// How bounds got on: when they had settled how much, in designs over all passes.
#[derive(Clone, Debug, Default)]
pub(super) struct Pace {
    notes: Vec<(f64, f64)>,
}

impl Pace {
    pub fn note(&mut self, time: f64, settled: f64) {
        if self.notes.last().is_none_or(|(last, _)| time > last * SPACING + 1e-3) {
            self.notes.push((time, settled));
        }
    }

    /// Seconds that the rest takes at this pace; infinite if nothing moves. `whole`: seconds that judging every design takes.
    pub fn rest(&self, time: f64, settled: f64, rest: f64, whole: f64) -> f64 {
        let begin = time * (1.0 - RECENT);
        let (then, before) = self.notes.iter().rev().find(|(then, _)| *then <= begin).copied().unwrap_or((0.0, 0.0));
        let pace = |settled: f64, time: f64| if settled > 0.0 { rest / settled * time } else { f64::INFINITY };
        let recent = pace(settled - before, time - then);
        if time < BURSTS * whole { recent.min(pace(settled, time)) } else { recent }
    }
}

impl Forecast {
    /// Should bounds be left? They have taken so many seconds before what the forecast covers; judging every design takes `whole`.
    pub(super) fn is_poor(&self, whole: f64, counting_since: Option<f64>) -> bool {
        let patience = counting_since.map_or(PATIENCE * whole, |since| since + COUNT_PATIENCE * whole);
        self.spent > patience && self.bounds > self.judging && self.spent + self.bounds > TOLERANCE * whole
    }
}

const DAY: f64 = 86_400.0;
const YEAR: f64 = 365.25 * DAY;
/// From here on a span is told in years, and from there on not any more.
const MANY_DAYS: f64 = 1000.0;
const MANY_YEARS: f64 = 10_000.0;

/// A time span for people.
pub fn span(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => format!("{:.0} ms", s * 1e3),
        s if s < 120.0 => format!("{s:.1} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s if s < 172_800.0 => format!("{:.1} h", s / 3600.0),
        s if s < MANY_DAYS * DAY => format!("{:.0} days", s / DAY),
        s if s < MANY_YEARS * YEAR => format!("{:.0} years", s / YEAR),
        _ => format!("more than {MANY_YEARS} years"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::{Model, find};
    use crate::study::Study;
    use std::sync::Arc;

    #[test]
    fn a_design_that_takes_seconds_is_not_tried_and_a_fast_one_is_measured() {
        let model = find("pulley-load").expect("it is a model");
        let of = |effort: Effort| {
            let mut study = Study::parse_in(&model.starter, "study.toml", ".".as_ref()).expect("the starter is right");
            study.model = Arc::new(Model { effort, ..Model::clone(&model) });
            let plan = Plan::new(study);
            (Speed::measured(&plan, 2, Duration::from_millis(50)), Speed::told(&plan))
        };
        let (speed, told) = of(Effort { prepare: 60.0, finish: 0.0 });
        assert_eq!((speed, speed.how()), (told, "by what the model usually takes"));
        // It says that it is slow and is not: that is noticed, whether rows are judged whole or only begun.
        for effort in [Effort { prepare: 1e-5, finish: 1e-5 }, Effort { prepare: 0.02, finish: 1e-3 }] {
            let (speed, told) = of(effort);
            assert!(speed.how() == "measured over a moment" && speed.seconds > 0.0, "{speed:?}");
            assert!(speed.seconds < told.seconds / 3.0, "{speed:?} {told:?}");
        }
        assert_eq!(Speed { seconds: 0.5, measured: true }.of(12, 3), 2.0);
    }

    /// Pace of a run that settles by a function of time, looked at every 10 ms.
    fn pace(until: f64, settled: impl Fn(f64) -> f64) -> Pace {
        let mut pace = Pace::default();
        (0..(until * 100.0) as u32).for_each(|look| pace.note(f64::from(look) / 100.0, settled(f64::from(look) / 100.0)));
        pace
    }

    #[test]
    fn the_rest_takes_what_the_better_pace_says_and_later_the_last() {
        let near = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 0.1, "{found} {expected}");
        // 10 designs per second of 100.
        near(pace(4.0, |time| 10.0 * time).rest(4.0, 40.0, 60.0, 8.0), 6.0);
        // A burst in the first half and nothing since: early that means little, late everything.
        let burst = |time: f64| if time < 1.0 { 40.0 * time } else { 40.0 };
        near(pace(4.0, burst).rest(4.0, 40.0, 60.0, 20.0), 6.0);
        assert_eq!(pace(4.0, burst).rest(4.0, 40.0, 60.0, 8.0), f64::INFINITY);
        // Nothing in the first half: what counts is what comes now.
        near(pace(4.0, |time| 20.0 * (time - 2.0).max(0.0)).rest(4.0, 40.0, 60.0, 20.0), 3.0);
        assert_eq!(Pace::default().rest(4.0, 0.0, 60.0, 20.0), f64::INFINITY);
    }

    #[test]
    fn spans_are_told_in_units_of_their_size() {
        let told = [0.0123, 3.21, 600.0, 1e4, 3e6, 1e8, 1e11, 1e13, f64::INFINITY].map(span);
        let expected =
            ["12 ms", "3.2 s", "10 min", "2.8 h", "35 days", "3 years", "3169 years", "more than 10000 years", "more than 10000 years"];
        assert_eq!(told, expected);
    }

    #[test]
    fn bounds_are_left_where_judging_is_expected_to_be_faster() {
        let is_poor = |spent, bounds, judging| Forecast { spent, settled: 0.1, bounds, judging }.is_poor(100.0, None);
        // Before a quarter of the time nobody asks.
        assert!(!is_poor(24.0, f64::INFINITY, 100.0) && is_poor(26.0, f64::INFINITY, 100.0));
        assert!(!is_poor(26.0, 98.0, 100.0) && is_poor(26.0, 101.0, 100.0));
        // A study of a day is not left because a minute settled nothing.
        let day = Forecast { spent: 60.0, settled: 0.0, bounds: f64::INFINITY, judging: 86_400.0 };
        assert!(!day.is_poor(86_400.0, None));
        // A count is asked sooner, and what it has done counts: little is won by leaving it near the end.
        let counting = |spent, bounds, judging| Forecast { spent, settled: 0.9, bounds, judging }.is_poor(100.0, Some(5.0));
        assert!(!counting(14.0, 300.0, 100.0) && counting(16.0, 300.0, 100.0));
        assert!(!counting(60.0, 55.0, 50.0) && counting(60.0, 70.0, 50.0) && !counting(90.0, 300.0, 301.0));
    }
}
