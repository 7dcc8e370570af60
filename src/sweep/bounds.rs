//! The sweep by bounds: what a result names is searched for, then the feasible designs are counted, range by range.
//!
//! A range counts as done when it is counted; the search comes first and covers all of it, so that whatever a checkpoint holds is as
//! complete as that of a sweep design by design, and either may go on with the other's.

use super::costs::{Forecast, ranges_for_trial};
use super::watch::{Leaving, OFTEN, Teller, Watch};
use super::{Control, Settings, SweepJob, SweepWork, Swept, run_thread};
use crate::bounds::{BoundedStudy, BoxCounter, BoxTally, Certificate, SearchJob, Settled, Shared, Worker, in_words, refusal};
use crate::checkpoint::Checkpoint;
use crate::error::{Error, Result};
use crate::parallel::{on_threads, with_beside};
use crate::plan::Plan;
use crate::reduce::{Reducers, Reduction, State};
use crate::screen::{CpuEngine, Tables};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How long a range should take to count: what a killed run loses per thread.
const CHUNK: Duration = Duration::from_secs(4);
/// Parts that a study is counted in where it goes fast.
const PARTS: u64 = 16;
/// Random ranges that are judged design by design besides, and designs of each.
const COMPARED_RANGES: u64 = 32;
const COMPARED: u64 = 4096;
/// Seconds that this may take, by what the model says.
const COMPARED_TIME: f64 = 2.0;
/// Of histograms and maps this share, over the number of threads, is tried before bounds begin where they may be left.
const TRIED: f64 = 1.0 / 32.0;

/// Sweeps a plan by bounds. With a checkpoint, starts from what it holds, however that was made.
///
/// # Errors
/// As [`sweep`](super::sweep); [`Error::NotByBounds`] if bounds cannot serve the study; [`Error::Disagreement`] if designs judged one by one do
/// not agree with what the bounds say, or the rules do not add up to all designs.
pub fn sweep_by_bounds(
    plan: &Plan,
    tables: &Tables,
    reduction: &Reduction,
    options: &Settings,
    checkpoint: Option<&mut Checkpoint>,
    control: &Control,
) -> Result<(Swept, Certificate)> {
    let start = Instant::now();
    let job = SweepJob { plan, tables, reduction, options, control };
    let mut work = SweepWork::begin(job, checkpoint)?;
    let designs = work.todo.count();
    match settle(job, &mut work, None)? {
        Settling::Done(state, certificate) => Ok((Swept { state, designs, time: start.elapsed() }, certificate)),
        Settling::Left(_) | Settling::Tried(_) => Err(stopped()),
    }
}

/// How bounds got on when they were tried for a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BoundsTrial {
    /// They settled every design, in so many seconds.
    Finished(f64),
    /// They settled this fraction of their work in so many seconds, or less if a trial of histograms and maps was slower.
    Begun {
        /// Fraction of the work, from 0 to 1.
        settled: f64,
        /// Seconds.
        seconds: f64,
    },
}

impl BoundsTrial {
    /// Seconds that all of it takes at this pace; infinite where nothing was settled.
    pub fn expected(&self) -> f64 {
        match *self {
            Self::Finished(seconds) => seconds,
            Self::Begun { settled, seconds } => seconds / settled,
        }
    }
}

/// Sweeps a plan by bounds for so long at most, to see how they get on; nothing is kept. `None` if they cannot serve it or fail.
pub fn try_bounds(plan: &Plan, threads: usize, time: Duration) -> Option<BoundsTrial> {
    let tables = Tables::new(plan);
    let reduction = Reduction::new(plan, &ranges_for_trial(plan, &tables, threads, time));
    let settings = Settings { threads, ..Settings::default() };
    let layout = BoundedStudy::new(plan)?;
    let (control, over, half_over) = (Control::default(), AtomicBool::new(false), AtomicBool::new(false));
    let start = Instant::now();
    let watch = || {
        while !over.load(Ordering::Relaxed) && start.elapsed() < time {
            half_over.store(start.elapsed() > time / 2, Ordering::Relaxed);
            std::thread::sleep(OFTEN);
        }
        half_over.store(true, Ordering::Relaxed);
        control.stop.store(true, Ordering::Relaxed);
    };
    let (tallies, swept, seconds) = with_beside(watch, |runs| {
        let _end = AtEnd(&over);
        // Without a thread to watch it nothing would end it.
        runs.then(|| {
            let job = SweepJob { plan, tables: &tables, reduction: &reduction, options: &settings, control: &control };
            let tallies = seconds_of_tallies(job, &layout, &(0..plan.designs()), plan.designs(), &half_over, &|_| ());
            let start = Instant::now();
            let swept = sweep_by_bounds(plan, &tables, &reduction, &settings, None, &control);
            (tallies, swept, start.elapsed().as_secs_f64())
        })
    })?;
    match swept {
        Ok(_) => Some(BoundsTrial::Finished(seconds)),
        #[allow(clippy::cast_precision_loss, reason = "an estimate")]
        Err(Error::Stopped { .. }) => {
            let settled = control.done.load(Ordering::Relaxed) as f64 / plan.designs() as f64;
            // The searches come first, and may be fast: at that pace nobody counts bins and cells.
            Some(BoundsTrial::Begun { settled: settled.min(1.0).min(seconds / tallies), seconds })
        }
        Err(_) => None,
    }
}

/// What came of bounds.
pub(super) enum Settling {
    /// They settled every design.
    Done(State, Certificate),
    /// Histograms and maps were tried, and judging every design is faster.
    Tried(Forecast),
    /// They were left; what they counted and found is kept in the work.
    Left(Remains),
}

/// What bounds leave behind.
pub(super) struct Remains {
    pub forecast: Forecast,
    /// What they were at.
    pub at: String,
    /// Designs that they counted.
    pub counted: u64,
    /// What the result names, if they had found all of it.
    pub found: Option<State>,
}

/// Settles designs by bounds until there are none left, or, where `leaving` says when and how many seconds a design takes one by one,
/// until that pays no more.
pub(super) fn settle(job: SweepJob<'_>, work: &mut SweepWork<'_>, leaving: Option<(Leaving, f64)>) -> Result<Settling> {
    let SweepJob { plan, options, control, .. } = job;
    let refuse = || Error::NotByBounds { why: refusal(plan).unwrap_or_default() };
    let mut layout = BoundedStudy::new(plan).ok_or_else(refuse)?;
    layout.most_points = options.most_points(plan);
    let whole = job.whole();
    let searches = (whole.end - whole.start, BoundedStudy::searches(plan));
    let counts = (work.todo.count(), BoundedStudy::tallies(plan).len() + 1);
    let watch = Watch::new(control, leaving, searches, counts);
    let over = AtomicBool::new(false);
    let mut settle = || settle_watched(job, &layout, &whole, work, &watch);
    if !watch.may_leave() {
        return settle();
    }
    let look = || {
        while !over.load(Ordering::Relaxed) {
            watch.look();
            watch.look_at_trial();
            std::thread::sleep(OFTEN);
        }
    };
    // Where no thread can be had, those who settle boxes look at the clock.
    with_beside(look, |_| {
        // Whatever happens, the watcher ends.
        let _end = AtEnd(&over);
        settle()
    })
}

/// Sets a flag when it goes.
struct AtEnd<'a>(&'a AtomicBool);

impl Drop for AtEnd<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

fn settle_watched(
    job: SweepJob<'_>,
    layout: &BoundedStudy,
    whole: &Range<u64>,
    work: &mut SweepWork<'_>,
    watch: &Watch<'_>,
) -> Result<Settling> {
    let SweepJob { plan, options, control, .. } = job;
    if let Some(forecast) = tallies_are_poor(job, layout, whole, work.todo.count(), watch) {
        return Ok(Settling::Tried(forecast));
    }
    let designs = work.todo.count();
    let mut certificate = Certificate::default();
    let mut shared = if options.shares_judged { Shared::new(plan) } else { Shared::alone() };
    let searched = search(job, layout, whole, &mut shared, work, watch, &mut certificate);
    let state = work.reducers.state();
    work.save(&state)?;
    options.check_memory(plan, state.front.len())?;
    let left = || watch.left().filter(|_| !control.stop.load(Ordering::Relaxed));
    let at = || control.settled_for().unwrap_or_default();
    if !searched {
        let forecast = left().ok_or_else(stopped)?;
        return Ok(Settling::Left(Remains { forecast, at: at(), counted: 0, found: None }));
    }
    // What was searched is final.
    options.check_budget(plan, &state)?;
    let passes = BoundedStudy::searches(plan) as u64 + 1;
    let what = if BoundedStudy::tallies(plan).is_empty() { "count" } else { "counts" };
    control.settles(format!("{what}, {passes} of {passes}"));
    watch.counts();
    let tallies = BoundedStudy::tallies(plan);
    if tallies.is_empty() {
        take_counted(job, layout, whole, &shared, watch, &mut certificate, work)?;
    }
    work.known = Arc::new(work.reducers.front.points().clone());
    let todo = Mutex::new(work);
    // Where bounds may be left, a trial has decided about histograms and maps already.
    let is_judged = !watch.may_leave() && !tallies.is_empty() && layout.has_judged_most(&shared, whole);
    let settled = on_threads(0..options.threads.max(1), |_| match is_judged {
        true => judge_on_thread(job, &tallies, &todo, watch),
        false => count_on_thread(job, layout, &tallies, &todo, watch),
    });
    certificate.tallies = tallies.iter().map(|tally| (tally.in_words(plan), Settled::default())).collect();
    for settled in &settled {
        let counts = std::iter::once(&mut certificate.count).chain(certificate.tallies.iter_mut().map(|(_, it)| it));
        counts.zip(settled).for_each(|(count, own)| count.add(own));
    }
    let work = todo.into_inner().unwrap_or_else(PoisonError::into_inner);
    if let Some(failure) = work.failure.take() {
        return Err(failure);
    }
    let state = work.reducers.state();
    work.save(&state)?;
    let counted = designs - work.todo.count();
    if counted < designs || control.stop.load(Ordering::Relaxed) {
        let forecast = left().ok_or_else(stopped)?;
        adds_up(&certificate, counted, whole.end - whole.start)?;
        return Ok(Settling::Left(Remains { forecast, at: at(), counted, found: Some(state) }));
    }
    adds_up(&certificate, designs, whole.end - whole.start)?;
    // What an earlier run has counted, it may have counted by bounds.
    let is_bounded = certificate.is_count_bounded() || designs < whole.end - whole.start;
    certificate.compared = compare(job, layout, whole, &state, is_bounded)? + none_is_feasible(job, &layout.sample_of_infeasible(&shared))?;
    control.done.store(whole.end - whole.start, Ordering::Relaxed);
    Ok(Settling::Done(state, certificate))
}

pub(super) fn stopped() -> Error {
    Error::Stopped { kept: None }
}

/// Tries histograms and maps, where there are any and bounds may be left: the forecast at which they are, if it does not pay.
fn tallies_are_poor(job: SweepJob<'_>, layout: &BoundedStudy, whole: &Range<u64>, left: u64, watch: &Watch<'_>) -> Option<Forecast> {
    let (report, control) = (&job.plan.study.report, job.control);
    let judging = watch.begin_trial().filter(|_| !report.histograms.is_empty() || !report.maps.is_empty())?;
    control.settles("a trial of histograms and maps".to_owned());
    let expected = seconds_of_tallies(job, layout, whole, left, watch.trial_is_over(), &|_| watch.look_at_trial());
    let poor = expected > judging && !control.stop.load(Ordering::Relaxed);
    poor.then(|| Forecast { spent: watch.spent(), settled: 0.0, bounds: expected, judging })
}

/// Seconds that histograms and maps are expected to take where so many designs are `left`, by a trial of a small part of them; infinite if
/// that was stopped.
#[allow(clippy::cast_precision_loss, reason = "an estimate")]
fn seconds_of_tallies(
    job: SweepJob<'_>,
    layout: &BoundedStudy,
    whole: &Range<u64>,
    left: u64,
    stop: &AtomicBool,
    progress: &(dyn Fn(u64) + Sync),
) -> f64 {
    let SweepJob { plan, tables, reduction, options, .. } = job;
    let threads = options.threads.max(1) as f64;
    let trial = SearchJob { plan, reduction, range: whole, stop, progress };
    let left = left as f64 / (whole.end - whole.start) as f64;
    layout.try_tallies(trial, layout.worker(plan, tables, stop), TRIED / threads, left).map_or(f64::INFINITY, |seconds| seconds / threads)
}

/// Searches for everything that the result names; false if it was stopped.
fn search(
    job: SweepJob<'_>,
    layout: &BoundedStudy,
    whole: &Range<u64>,
    shared: &mut Shared,
    work: &mut SweepWork<'_>,
    watch: &Watch<'_>,
    certificate: &mut Certificate,
) -> bool {
    let SweepJob { plan, tables, reduction, options, control } = job;
    let (mut passes, all_passes) = (1.., BoundedStudy::searches(plan) + 1);
    let mut begin = |what: &str| control.settles(format!("{what}, {} of {all_passes}", passes.next().unwrap_or(all_passes)));
    let mut workers: Vec<Worker<'_>> = (0..options.threads.max(1)).map(|_| layout.worker(plan, tables, watch.stop())).collect();
    let progress = |designs: u64| watch.settle(designs);
    let search = SearchJob { plan, reduction, range: whole, stop: watch.stop(), progress: &progress };
    for sought in BoundedStudy::sought(plan) {
        begin(&in_words(plan, sought));
        match layout.search_sharing(search, sought, shared, &mut workers, &mut work.reducers) {
            Some(searched) => certificate.searches.push((in_words(plan, sought), searched)),
            None => return false,
        }
    }
    if plan.study.report.sample.is_some() {
        begin(SAMPLE);
        let Some(searched) = layout.draw(search, &mut workers, &mut work.reducers) else { return false };
        certificate.searches.push((SAMPLE.to_owned(), searched));
    }
    true
}

/// What is searched for by [`BoundedStudy::draw`].
const SAMPLE: &str = "sample";

/// Takes the number of feasible designs from a search that has counted all of them on its way, if one has; or counts what the searches
/// have left, if that is little.
fn take_counted(
    job: SweepJob<'_>,
    layout: &BoundedStudy,
    whole: &Range<u64>,
    shared: &Shared,
    watch: &Watch<'_>,
    certificate: &mut Certificate,
    work: &mut SweepWork<'_>,
) -> Result<()> {
    let Some(range) = work.todo.first().filter(|it| it == whole) else { return Ok(()) };
    let counted = certificate.searches.iter().find_map(|(_, it)| {
        let settled = Settled { infeasible: it.infeasible, pairs: it.pairs, evaluated: it.evaluated, ..Settled::default() };
        it.counted.map(|feasible| (feasible, settled))
    });
    let count_rest = || layout.count_rest(shared, whole, job.options.threads.max(1), watch.stop(), &|designs| watch.settle(designs));
    let Some((feasible, settled)) = counted.or_else(count_rest) else { return Ok(()) };
    certificate.count = settled;
    let mut counted = job.reduction.start();
    counted.feasible = feasible;
    work.todo.take(range.end - range.start);
    work.reducers.merge(counted.into_fresh());
    work.finish(job.plan, range)
}

/// Judges ranges design by design until there are none left, for all counts together: where searches have judged most designs, boxes would
/// settle little of the tallies too.
fn judge_on_thread(job: SweepJob<'_>, tallies: &[BoxTally], work: &Mutex<&mut SweepWork<'_>>, watch: &Watch<'_>) -> Vec<Settled> {
    let counts = tallies.len() as u64 + 1;
    let judged = run_thread(job, work, &|designs| watch.settle(designs * counts));
    let each = Settled { evaluated: judged, ..Settled::default() };
    std::iter::once(Settled { evaluations: judged, ..each }).chain(tallies.iter().map(|_| each)).collect()
}

/// Counts ranges until there are none left: the feasible designs, then those of each tally. Returns how each of them was settled.
fn count_on_thread(
    job: SweepJob<'_>,
    layout: &BoundedStudy,
    tallies: &[BoxTally],
    work: &Mutex<&mut SweepWork<'_>>,
    watch: &Watch<'_>,
) -> Vec<Settled> {
    let SweepJob { plan, reduction, options, .. } = job;
    let teller = Teller::new(watch);
    let settle = |designs: u64| teller.settle(designs);
    let mut counter = layout.counter(watch.stop()).telling(&settle);
    let lock = || work.lock().unwrap_or_else(PoisonError::into_inner);
    let all = options.shard.range(plan.designs());
    let least = (all.end - all.start) / PARTS;
    let mut settled = vec![Settled::default(); tallies.len() + 1];
    loop {
        let range = {
            let mut work = lock();
            if watch.stop().load(Ordering::Relaxed) || work.failure.is_some() {
                return settled;
            }
            let Some(first) = work.todo.first() else { return settled };
            let fair = work.todo.count() / options.threads.max(1) as u64;
            let chunk = CHUNK.as_secs_f64().min(watch.chunk());
            let about = work.rate.map_or(least, |rate| ((rate * chunk) as u64).min(fair.max(least)));
            let end = layout.round(&first, about.max(1));
            work.todo.take(end - first.start).unwrap_or(first)
        };
        let start = Instant::now();
        match count_range(plan, layout, tallies, &mut counter, &range, reduction.start()) {
            Ok(Some((counted, own))) => {
                settled.iter_mut().zip(&own).for_each(|(all, own)| all.add(own));
                teller.tell();
                hand_over(plan, range, counted, start.elapsed(), &mut lock());
            }
            Ok(None) => {
                lock().todo.add(range);
                return settled;
            }
            Err(failure) => {
                lock().failure = Some(failure);
                return settled;
            }
        }
    }
}

/// Counts all that is asked for at a range of positions into empty reducers; how each count was settled. `None` if it was stopped.
fn count_range(
    plan: &Plan,
    layout: &BoundedStudy,
    tallies: &[BoxTally],
    counter: &mut BoxCounter<'_>,
    range: &Range<u64>,
    mut into: Reducers,
) -> Result<Option<(Reducers, Vec<Settled>)>> {
    let mut before = counter.settled;
    let mut since = |counter: &BoxCounter<'_>| {
        let mut own = counter.settled;
        own.subtract(&before);
        before = counter.settled;
        own
    };
    let Some(feasible) = layout.count(counter, range) else { return Ok(None) };
    into.feasible = feasible;
    let mut settled = vec![since(counter)];
    for &tally in tallies {
        let Some(counted) = layout.count_by(tally, counter, range, &mut into.reported) else { return Ok(None) };
        if counted != feasible {
            let what = tally.in_words(plan);
            return Err(Error::Disagreement(format!(
                "at positions {range:?} bounds counted {feasible} feasible designs, and {counted} for the {what}"
            )));
        }
        settled.push(since(counter));
    }
    Ok(Some((into, settled)))
}

fn hand_over(plan: &Plan, range: Range<u64>, counted: Reducers, time: Duration, work: &mut SweepWork<'_>) {
    work.rate = Some((range.end - range.start) as f64 / time.as_secs_f64().max(1e-6));
    work.reducers.merge(counted.into_fresh());
    if let Err(failure) = work.finish(plan, range) {
        work.failure = Some(failure);
    }
}

/// Every design must have been settled by one rule: once for each count, and once in each search.
fn adds_up(certificate: &Certificate, counted: u64, searched: u64) -> Result<()> {
    let differs = |what: &str, settled: u64, all: u64| {
        Error::Disagreement(format!("bounds settled {settled} designs for the {what}, but there are {all}"))
    };
    let counts = std::iter::once(("count", &certificate.count)).chain(certificate.tallies.iter().map(|(what, it)| (&**what, it)));
    if let Some((what, it)) = counts.into_iter().find(|(_, it)| it.designs() != counted) {
        return Err(differs(what, it.designs(), counted));
    }
    match certificate.searches.iter().find(|(_, it)| it.designs() != searched) {
        Some((what, it)) => Err(differs(what, it.designs(), searched)),
        None => Ok(()),
    }
}

/// Judges random ranges design by design: all counts must be the same, where bounds have their part in them, and no design may be better
/// than what was found.
fn compare(job: SweepJob<'_>, layout: &BoundedStudy, whole: &Range<u64>, state: &State, is_count_bounded: bool) -> Result<u64> {
    let SweepJob { plan, tables, reduction, control, .. } = job;
    let size = whole.end - whole.start;
    let affordable = (COMPARED_TIME / plan.seconds_per_design().max(1e-12)) as u64;
    let length = COMPARED.min(size / COMPARED_RANGES).min(affordable / COMPARED_RANGES).max(1).min(size);
    let mut engine = CpuEngine::new(plan, tables).stopping_on(&control.stop);
    let mut counter = layout.counter(&control.stop);
    let tallies = BoundedStudy::tallies(plan);
    let mut known = reduction.restore(state.clone());
    let mut compared = 0;
    for number in 0..COMPARED_RANGES.min(size) {
        let spread = (u128::from(plan.spread(number + 1)) * u128::from(size - length + 1) / u128::from(plan.designs())) as u64;
        let range = whole.start + spread..whole.start + spread + length;
        let mut judged = reduction.start();
        engine.screen(range.clone(), |block| reduction.absorb(&mut judged, block));
        let counted = match is_count_bounded {
            true => count_range(plan, layout, &tallies, &mut counter, &range, reduction.start())?.map(|(counted, _)| Some(counted)),
            false => Some(None),
        };
        let Some(counted) = counted.filter(|_| !control.stop.load(Ordering::Relaxed)) else { return Err(stopped()) };
        if let Some(counted) = counted {
            let feasible = Some(("feasible designs", counted.feasible, judged.feasible)).filter(|(_, counted, judged)| counted != judged);
            if let Some((what, counted, judged)) = feasible.or_else(|| counted.reported.miscounts(&judged.reported)) {
                return Err(Error::Disagreement(format!(
                    "at positions {range:?} bounds counted {counted} {what}, one by one they are {judged}"
                )));
            }
        }
        known.merge(judged.into_fresh());
        compared += length;
    }
    if !state.names_all_of(&known.state()) {
        return Err(Error::Disagreement("designs judged one by one are better than what bounds found".to_owned()));
    }
    Ok(compared)
}

/// Judges designs that bounds hold to be infeasible, as many as there is time for; returns how many.
fn none_is_feasible(job: SweepJob<'_>, positions: &[u64]) -> Result<u64> {
    let SweepJob { plan, tables, control, .. } = job;
    let affordable = (COMPARED_TIME / plan.seconds_per_design().max(1e-12)) as usize;
    let positions: Vec<u64> = positions.iter().copied().step_by(positions.len().div_ceil(affordable.max(1)).max(1)).collect();
    let mut feasible = 0;
    CpuEngine::new(plan, tables).stopping_on(&control.stop).screen_some(&positions, |block| feasible += block.feasible_count);
    if control.stop.load(Ordering::Relaxed) {
        return Err(stopped());
    }
    match feasible {
        0 => Ok(positions.len() as u64),
        _ => Err(Error::Disagreement(format!("of {} designs that bounds hold to be infeasible {feasible} are feasible", positions.len()))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::find;
    use crate::study::study_of;

    #[test]
    fn a_feasible_design_in_a_box_held_to_be_infeasible_is_noticed() {
        let text = "[design]\npower_kW = { from = 1, to = 3, count = 9 }\nspeed_rpm = { from = 1000, to = 4000, count = 16 }\n\
                    [constraints]\nspeed_rpm = { min = 2000 }\n[objectives]\nresultant_force_N = \"min\"\n";
        let plan = Plan::new(study_of(&find("pulley-load").expect("it is a model"), text).expect("the study is right"));
        let (tables, control) = (Tables::new(&plan), Control::default());
        let (reduction, options) = (Reduction::new(&plan, &[]), Settings::default());
        let job = SweepJob { plan: &plan, tables: &tables, reduction: &reduction, options: &options, control: &control };
        let feasible_at = |position: u64| none_is_feasible(job, &[position]).is_err();
        let (feasible, infeasible): (Vec<u64>, Vec<u64>) = (0..plan.designs()).partition(|&position| feasible_at(position));
        assert!(!feasible.is_empty() && !infeasible.is_empty());
        assert_eq!(none_is_feasible(job, &infeasible).expect("none is"), infeasible.len() as u64);
        // Who stops it is not told that all is well.
        let stopped = Control::default();
        stopped.stop.store(true, Ordering::Relaxed);
        let ended = none_is_feasible(SweepJob { control: &stopped, ..job }, &infeasible);
        assert!(matches!(ended, Err(Error::Stopped { .. })), "{ended:?}");
        let all: Vec<u64> = (0..plan.designs()).collect();
        let error = none_is_feasible(job, &all).expect_err("some are").to_string();
        assert!(error.contains(&format!("of 144 designs that bounds hold to be infeasible {} are feasible", feasible.len())), "{error}");
    }
}
