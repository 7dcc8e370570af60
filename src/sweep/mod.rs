//! The sweep: ranges of designs handed to threads, their results merged and kept.
//!
//! On the processor a thread takes a chunk of positions, screens it with reducers of its own (which may drop what the front known so far beats)
//! and hands the result over as a whole. What is merged is therefore always complete for the ranges that the checkpoint names,
//! and the result does not depend on how the work was cut. On a graphics device see [`sweep_on_device`].

mod bounds;
mod gpu;
mod recheck;
#[cfg(test)]
mod tests;

pub use crate::screen::Control;
pub use bounds::sweep_by_bounds;
pub use gpu::{DeviceRecord, OnDevice, recheck_on_device, sweep_on_device};
pub use recheck::{LEAST_DESIGNS, Recheck};

use crate::checkpoint::{Checkpoint, Progress};
use crate::error::{Error, Result};
use crate::plan::Plan;
use crate::reduce::{Points, Reducers, Reduction, State};
use crate::screen::{BLOCK, CpuEngine, Tables};
use crate::tiles::{Ranges, Shard};
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How to run; nothing here changes a result.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Worker threads, at least 1.
    pub threads: usize,
    /// Most designs that a thread works on between looks at the clock.
    pub tile: u64,
    /// How long a chunk should take: what a killed run loses per thread.
    pub chunk: Duration,
    /// Which part of the study.
    pub shard: Shard,
}

impl Default for Options {
    fn default() -> Self {
        let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        Self { threads, tile: 1 << 16, chunk: Duration::from_millis(500), shard: Shard::WHOLE }
    }
}

/// What a finished sweep knows.
#[derive(Debug)]
pub struct Swept {
    /// What remains of the designs.
    pub state: State,
    /// Designs judged by this run, without what a checkpoint brought.
    pub designs: u64,
    /// Time that this run took.
    pub time: Duration,
}

/// A first chunk this small calibrates the speed and gives the front something to compare with.
const FIRST_CHUNK: u64 = 4096;

/// How long a tile should take: how often a slow study shows that it moves.
const TILE_TIME: Duration = Duration::from_millis(100);

/// A chunk that takes so many times as long as was planned for is handed over as far as it is.
const PATIENCE: f64 = 2.0;

/// Least time of a chunk and between two saves.
const LEAST_CHUNK: Duration = Duration::from_millis(50);

/// Most blocks of the head start, and the share of all designs that it may not exceed.
const HEAD_START: u64 = 256;
const HEAD_START_SHARE: u64 = 64;
/// Seconds that it may take, by what the model says.
const HEAD_START_TIME: f64 = 0.3;

/// What the threads share.
struct Work<'a> {
    todo: Ranges,
    done: Ranges,
    reducers: Reducers,
    /// The front at the last merge, for new chunks to start with.
    known: Arc<Points>,
    checkpoint: Option<&'a mut Checkpoint>,
    failure: Option<Error>,
    start: Instant,
    /// Designs per second of one thread, once known.
    rate: Option<f64>,
    saved: Instant,
    saving: Duration,
    merging: Duration,
}

impl<'a> Work<'a> {
    fn new(
        progress: Progress,
        whole: std::ops::Range<u64>,
        reduction: &Reduction,
        checkpoint: Option<&'a mut Checkpoint>,
        control: &Control,
    ) -> Self {
        let Progress { done, state } = progress;
        control.done.store(done.count(), Ordering::Relaxed);
        let mut reducers = reduction.restore(state);
        let known = Arc::new(reducers.front.points().clone());
        let start = Instant::now();
        Self {
            todo: done.missing_from(whole),
            done,
            reducers,
            known,
            checkpoint,
            failure: None,
            start,
            rate: None,
            saved: start,
            saving: Duration::ZERO,
            merging: Duration::ZERO,
        }
    }

    /// Counts a range, all of whose designs have been taken in, as done; keeps the checkpoint from time to time.
    fn finish(&mut self, plan: &Plan, range: std::ops::Range<u64>) -> Result<()> {
        self.done.add(range);
        // The front may shrink again while better designs arrive; well beyond the budget it would only fill the memory.
        if self.reducers.front.len() as u64 > plan.study.report.front_budget.saturating_mul(4) {
            return Err(over_budget(plan));
        }
        if self.checkpoint.is_some() && self.saved.elapsed() >= LEAST_CHUNK.max(5 * self.saving) {
            let start = Instant::now();
            let state = self.reducers.state();
            self.save(&state)?;
            self.saving = start.elapsed();
            self.saved = Instant::now();
        }
        Ok(())
    }

    fn save(&mut self, state: &State) -> Result<()> {
        match &mut self.checkpoint {
            Some(checkpoint) => checkpoint.save(&self.done, state),
            None => Ok(()),
        }
    }
}

/// Sweeps a plan. With a checkpoint, starts from what it holds and keeps it up to date.
///
/// # Errors
/// [`Error::Stopped`] after `control.stop`; [`Error::FrontBudget`]; [`Error::Io`] if the checkpoint cannot be written.
pub fn sweep(
    plan: &Plan,
    tables: &Tables,
    reduction: &Reduction,
    options: &Options,
    mut checkpoint: Option<&mut Checkpoint>,
    control: &Control,
) -> Result<Swept> {
    let start = Instant::now();
    let whole = options.shard.range(plan.designs());
    let progress = match checkpoint.as_deref_mut() {
        Some(checkpoint) => checkpoint.take_progress(),
        None => None,
    };
    let fresh = || head_start(reduction, &mut look_around(plan, tables, reduction, &whole, control));
    let progress = progress.unwrap_or_else(|| Progress { done: Ranges::default(), state: fresh() });
    let work = Work::new(progress, whole, reduction, checkpoint, control);
    let designs = work.todo.count();
    let work = Mutex::new(work);
    std::thread::scope(|scope| {
        for _ in 0..options.threads.max(1) {
            scope.spawn(|| run_thread(plan, tables, reduction, options, &work, control));
        }
    });
    let mut work = work.into_inner().unwrap_or_else(PoisonError::into_inner);
    if let Some(failure) = work.failure {
        return Err(failure);
    }
    let state = work.reducers.state();
    let finished = work.todo.count() == 0 && !control.stop.load(Ordering::Relaxed);
    if finished {
        check_budget(plan, &state)?;
    }
    work.save(&state)?;
    if !finished {
        return Err(Error::Stopped { checkpoint: String::new(), resume: String::new() });
    }
    Ok(Swept { state, designs, time: start.elapsed() })
}

/// What remains of a few designs from all over a range, so that the first chunks have something to compare with.
///
/// They are designs like any other, judged in f64: the sweep will meet them again and finds those of the front there already.
fn look_around(plan: &Plan, tables: &Tables, reduction: &Reduction, whole: &std::ops::Range<u64>, control: &Control) -> Reducers {
    let mut seen = reduction.start();
    let mut engine = CpuEngine::new(plan, tables).stopping_on(&control.stop);
    let designs = whole.end - whole.start;
    let affordable = (HEAD_START_TIME / (plan.seconds_per_design() * BLOCK as f64)) as u64;
    for step in 0..(designs / HEAD_START_SHARE / BLOCK as u64).min(HEAD_START).min(affordable) {
        let first = whole.start + ((u128::from(plan.spread(step)) * u128::from(designs)) / u128::from(plan.designs())) as u64;
        engine.screen(first..whole.end.min(first + BLOCK as u64), |block| reduction.absorb(&mut seen, block));
    }
    seen
}

/// The state of a sweep that has counted nothing, but knows the front of what was seen.
fn head_start(reduction: &Reduction, seen: &mut Reducers) -> State {
    let mut state = reduction.start().state();
    state.front = seen.front.points().clone();
    state
}

/// A front must keep within the study's budget.
///
/// # Errors
/// [`Error::FrontBudget`].
pub fn check_budget(plan: &Plan, state: &State) -> Result<()> {
    if state.front.len() as u64 > plan.study.report.front_budget { Err(over_budget(plan)) } else { Ok(()) }
}

fn over_budget(plan: &Plan) -> Error {
    let objective = plan.study.objectives[0];
    let goal = if objective.goal == crate::study::Goal::Min { "min" } else { "max" };
    let example = format!("{} = {{ goal = \"{goal}\", resolution = ... }}", objective.quantity.name(plan.study.model));
    Error::FrontBudget { budget: plan.study.report.front_budget, example }
}

fn run_thread(plan: &Plan, tables: &Tables, reduction: &Reduction, options: &Options, work: &Mutex<Work<'_>>, control: &Control) {
    let mut engine = CpuEngine::new(plan, tables).stopping_on(&control.stop);
    // Work is cut by time: a tile of a slow model may be a single design.
    let tile_at = |rate: f64| ((rate * TILE_TIME.as_secs_f64()) as u64).clamp(1, options.tile);
    let lock = || work.lock().unwrap_or_else(PoisonError::into_inner);
    loop {
        let (chunk, known, planned, mut tile) = {
            let mut work = lock();
            // Short chunks first, so that little is lost early too; a large front is dear to merge and to keep: longer ones then.
            let young = (work.start.elapsed() / 2).max(LEAST_CHUNK).min(options.chunk);
            let seconds = young.max(10 * (work.saving + work.merging)).as_secs_f64();
            // Until the speed is known, it is what the model says.
            let tile = tile_at(work.rate.unwrap_or_else(|| plan.seconds_per_design().recip()));
            // Towards the end chunks shrink, so that the threads finish together.
            let fair = work.todo.count() / (2 * options.threads as u64).max(1);
            let size = match work.rate {
                Some(rate) => ((rate * seconds) as u64).min(fair).max(tile),
                None if tile < FIRST_CHUNK => tile.min(fair.max(1)),
                None => FIRST_CHUNK,
            };
            if control.stop.load(Ordering::Relaxed) || work.failure.is_some() {
                return;
            }
            match work.todo.take(size) {
                Some(chunk) => (chunk, Arc::clone(&work.known), seconds, tile),
                None => return,
            }
        };
        let start = Instant::now();
        let mut reducers = reduction.start_after(Points::clone(&known));
        drop(known);
        let mut position = chunk.start;
        while position < chunk.end && !control.stop.load(Ordering::Relaxed) {
            let end = chunk.end.min(position.saturating_add(tile));
            let judged = engine.screen(position..end, |block| reduction.absorb(&mut reducers, block));
            control.done.fetch_add(judged - position, Ordering::Relaxed);
            position = judged;
            let seconds = start.elapsed().as_secs_f64();
            if seconds > PATIENCE * planned {
                break;
            }
            tile = tile_at((position - chunk.start) as f64 / seconds.max(1e-9));
        }
        hand_over(plan, chunk.start..position, chunk.end, reducers, start.elapsed(), lock());
    }
}

/// Merges a finished chunk (or the part of it that was finished when the run was stopped, or patience was lost with it) and keeps the checkpoint.
fn hand_over(
    plan: &Plan,
    finished: std::ops::Range<u64>,
    chunk_end: u64,
    reducers: Reducers,
    time: Duration,
    mut work: MutexGuard<'_, Work<'_>>,
) {
    if finished.end < chunk_end {
        work.todo.add(finished.end..chunk_end);
    }
    work.rate = Some((finished.end - finished.start) as f64 / time.as_secs_f64().max(1e-9));
    let merging = Instant::now();
    let fresh = reducers.into_fresh();
    let news = !fresh.front.is_empty();
    work.reducers.merge(fresh);
    if news {
        work.known = Arc::new(work.reducers.front.points().clone());
    }
    work.merging = merging.elapsed();
    if let Err(failure) = work.finish(plan, finished) {
        work.failure = Some(failure);
    }
}
