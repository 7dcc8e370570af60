//! The sweep by bounds: what a result names is searched for, then the feasible designs are counted, range by range.
//!
//! A range counts as done when it is counted; the search comes first and covers all of it, so that whatever a checkpoint holds is as
//! complete as that of a sweep design by design, and either may go on with the other's.

use super::{Control, Options, Swept, Work, check_budget, head_start, look_around};
use crate::bounds::{Certificate, Layout, Settled, Worker, in_words, refusal};
use crate::checkpoint::{Checkpoint, Progress};
use crate::error::{Error, Result};
use crate::plan::Plan;
use crate::reduce::{Reduction, State};
use crate::screen::{CpuEngine, Tables};
use crate::tiles::Ranges;
use std::ops::Range;
use std::sync::atomic::Ordering;
use std::sync::{Mutex, MutexGuard, PoisonError};
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

/// Sweeps a plan by bounds. With a checkpoint, starts from what it holds, however that was made.
///
/// # Errors
/// As [`sweep`](super::sweep); [`Error::Request`] if bounds cannot serve the study; [`Error::Certificate`] if designs judged one by one do
/// not agree with what the bounds say, or the rules do not add up to all designs.
pub fn sweep_by_bounds(
    plan: &Plan,
    tables: &Tables,
    reduction: &Reduction,
    options: &Options,
    mut checkpoint: Option<&mut Checkpoint>,
    control: &Control,
) -> Result<(Swept, Certificate)> {
    let start = Instant::now();
    let refuse = || Error::Request(format!("bounds cannot serve this study: {}", refusal(plan).unwrap_or_default()));
    let layout = Layout::new(plan).ok_or_else(refuse)?;
    let whole = options.shard.range(plan.designs());
    let progress = match checkpoint.as_deref_mut() {
        Some(checkpoint) => checkpoint.take_progress(),
        None => None,
    };
    let fresh = || head_start(reduction, &mut look_around(plan, tables, reduction, &whole, control));
    let progress = progress.unwrap_or_else(|| Progress { done: Ranges::default(), state: fresh() });
    let mut work = Work::new(progress, whole.clone(), reduction, checkpoint, control);
    let designs = work.todo.count();
    let mut certificate = Certificate::default();
    let searched = search(plan, tables, reduction, options, &layout, &whole, &mut work, control, &mut certificate);
    let state = work.reducers.state();
    work.save(&state)?;
    check_budget(plan, &state)?;
    if !searched {
        return Err(stopped());
    }
    let passes = Layout::sought(plan).len() as u64 + 1;
    control.settles(format!("count, {passes} of {passes}"));
    let work = Mutex::new(work);
    let settled: Vec<Settled> = std::thread::scope(|scope| {
        let count = || count_on_thread(plan, &layout, options, passes, &work, control);
        let threads: Vec<_> = (0..options.threads.max(1)).map(|_| scope.spawn(count)).collect();
        threads.into_iter().map(|it| it.join().expect("counting does not panic")).collect()
    });
    settled.iter().for_each(|it| certificate.count.add(it));
    let mut work = work.into_inner().unwrap_or_else(PoisonError::into_inner);
    if let Some(failure) = work.failure {
        return Err(failure);
    }
    let state = work.reducers.state();
    work.save(&state)?;
    if work.todo.count() > 0 || control.stop.load(Ordering::Relaxed) {
        return Err(stopped());
    }
    adds_up(&certificate, designs, whole.end - whole.start)?;
    certificate.compared = compare(plan, tables, reduction, &layout, &whole, &state, control)?;
    control.done.store(whole.end - whole.start, Ordering::Relaxed);
    Ok((Swept { state, designs, time: start.elapsed() }, certificate))
}

fn stopped() -> Error {
    Error::Stopped { checkpoint: String::new(), resume: String::new() }
}

/// Searches for everything that the result names; false if it was stopped.
#[allow(clippy::too_many_arguments, reason = "what a sweep has")]
fn search(
    plan: &Plan,
    tables: &Tables,
    reduction: &Reduction,
    options: &Options,
    layout: &Layout,
    whole: &Range<u64>,
    work: &mut Work<'_>,
    control: &Control,
    certificate: &mut Certificate,
) -> bool {
    let all = Layout::sought(plan);
    let passes = all.len() as u64 + 1;
    let mut workers: Vec<Worker<'_>> = (0..options.threads.max(1)).map(|_| layout.worker(plan, tables, &control.stop)).collect();
    let progress = |designs: u64| {
        control.done.fetch_add(designs / passes, Ordering::Relaxed);
    };
    for (number, sought) in all.into_iter().enumerate() {
        control.settles(format!("{}, {} of {passes}", in_words(plan, sought), number + 1));
        let found = layout.search(plan, reduction, sought, whole, &mut workers, &mut work.reducers, &control.stop, &progress);
        match found {
            Some(searched) => certificate.searches.push((in_words(plan, sought), searched)),
            None => return false,
        }
    }
    true
}

/// Counts ranges until there are none left.
fn count_on_thread(plan: &Plan, layout: &Layout, options: &Options, passes: u64, work: &Mutex<Work<'_>>, control: &Control) -> Settled {
    let mut counter = layout.counter(&control.stop);
    let lock = || work.lock().unwrap_or_else(PoisonError::into_inner);
    let all = options.shard.range(plan.designs());
    let least = (all.end - all.start) / PARTS;
    let mut settled = Settled::default();
    loop {
        let range = {
            let mut work = lock();
            if control.stop.load(Ordering::Relaxed) || work.failure.is_some() {
                return settled;
            }
            let Some(first) = work.todo.first() else { return settled };
            let fair = work.todo.count() / options.threads.max(1) as u64;
            let about = work.rate.map_or(least, |rate| ((rate * CHUNK.as_secs_f64()) as u64).min(fair.max(least)));
            let end = layout.round(&first, about.max(1));
            work.todo.take(end - first.start).unwrap_or(first)
        };
        let start = Instant::now();
        let before = counter.settled;
        match layout.count(&mut counter, &range) {
            None => {
                lock().todo.add(range);
                return settled;
            }
            Some(feasible) => {
                let mut own = counter.settled;
                own.subtract(&before);
                settled.add(&own);
                control.done.fetch_add((range.end - range.start) / passes, Ordering::Relaxed);
                hand_over(plan, range, feasible, start.elapsed(), lock());
            }
        }
    }
}

fn hand_over(plan: &Plan, range: Range<u64>, feasible: u64, time: Duration, mut work: MutexGuard<'_, Work<'_>>) {
    work.rate = Some((range.end - range.start) as f64 / time.as_secs_f64().max(1e-6));
    work.reducers.feasible += feasible;
    if let Err(failure) = work.finish(plan, range) {
        work.failure = Some(failure);
    }
}

/// Every design must have been settled by one rule: once for the count, and once in each search.
fn adds_up(certificate: &Certificate, counted: u64, searched: u64) -> Result<()> {
    let differs = |what: &str, settled: u64, all: u64| {
        Error::Certificate(format!("bounds settled {settled} designs for the {what}, but there are {all}"))
    };
    if certificate.count.designs() != counted {
        return Err(differs("count", certificate.count.designs(), counted));
    }
    match certificate.searches.iter().find(|(_, it)| it.designs() != searched) {
        Some((what, it)) => Err(differs(what, it.designs(), searched)),
        None => Ok(()),
    }
}

/// Judges random ranges design by design: the count must be the same, and no design may be better than what was found.
fn compare(
    plan: &Plan,
    tables: &Tables,
    reduction: &Reduction,
    layout: &Layout,
    whole: &Range<u64>,
    state: &State,
    control: &Control,
) -> Result<u64> {
    let size = whole.end - whole.start;
    let affordable = (COMPARED_TIME / plan.seconds_per_design().max(1e-12)) as u64;
    let length = COMPARED.min(size / COMPARED_RANGES).min(affordable / COMPARED_RANGES).max(1).min(size);
    let mut engine = CpuEngine::new(plan, tables).stopping_on(&control.stop);
    let mut counter = layout.counter(&control.stop);
    let mut known = reduction.restore(State { feasible: 0, ..state.clone() });
    let mut compared = 0;
    for number in 0..COMPARED_RANGES.min(size) {
        let spread = (u128::from(plan.spread(number + 1)) * u128::from(size - length + 1) / u128::from(plan.designs())) as u64;
        let range = whole.start + spread..whole.start + spread + length;
        let before = known.feasible;
        engine.screen(range.clone(), |block| reduction.absorb(&mut known, block));
        let Some(counted) = layout.count(&mut counter, &range) else { return Err(stopped()) };
        if control.stop.load(Ordering::Relaxed) {
            return Err(stopped());
        }
        if known.feasible - before != counted {
            let judged = known.feasible - before;
            return Err(Error::Certificate(format!(
                "at positions {range:?} bounds counted {counted} feasible designs, one by one they are {judged}"
            )));
        }
        compared += length;
    }
    let seen = known.state();
    let best = |state: &State| state.top.as_ref().map(crate::reduce::Top::indices);
    if seen.front != state.front || seen.extremes != state.extremes || best(&seen) != best(state) {
        return Err(Error::Certificate("designs judged one by one are better than what bounds found".to_owned()));
    }
    Ok(compared)
}
