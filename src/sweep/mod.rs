//! The sweep: ranges of designs go to threads, whose results are merged and kept.
//!
//! On the CPU a thread takes a chunk of positions, screens it with reducers of its own (which may drop what the front known so far beats)
//! and hands the result over as a whole. What is merged is therefore always complete for the ranges that the checkpoint names,
//! and the result does not depend on how the work was cut. For the sweep on a GPU see `sweep_on_device`.

mod auto;
#[cfg(feature = "gpu")]
mod beside;
mod bounds;
pub mod costs;
#[cfg(feature = "gpu")]
mod gpu;
#[cfg(not(feature = "gpu"))]
mod no_device;
#[cfg(feature = "gpu")]
mod recheck;
#[cfg(test)]
mod tests;
mod watch;

pub use crate::screen::Control;
pub use auto::{Auto, Left, Rule, Settler, sweep_auto};
pub use bounds::{BoundsTrial, sweep_by_bounds, try_bounds};
pub use costs::Forecast;
#[cfg(feature = "gpu")]
pub use gpu::{DeviceRecord, OnDevice, recheck_on_device, sweep_on_device};
#[cfg(not(feature = "gpu"))]
pub use no_device::{DeviceRecord, OnDevice};
#[cfg(feature = "gpu")]
pub use recheck::{LEAST_DESIGNS, Recheck};
pub use watch::Leaving;

use crate::checkpoint::{Checkpoint, Progress};
use crate::error::{Error, Result};
use crate::parallel::on_threads;
use crate::plan::{Plan, spread};
use crate::reduce::{FRONT_BYTES, Points, Reducers, Reduction, State, most_points};
use crate::screen::{BLOCK, CpuEngine, Tables};
use crate::tiles::{Ranges, Shard};
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How to run; nothing here changes a result.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Worker threads, at least 1.
    pub threads: usize,
    /// Most designs that a thread works on between looks at the clock.
    pub tile: u64,
    /// How long a chunk should take: what a killed run loses per thread.
    pub chunk: Duration,
    /// Which part of the study.
    pub shard: Shard,
    /// Bytes that the front may take while it is looked for.
    pub front_bytes: u64,
    /// By bounds: may a search judge designs for those that follow? Otherwise each judges its own and finds the same.
    pub shares_judged: bool,
}

impl Default for Settings {
    fn default() -> Self {
        let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        Self {
            threads,
            tile: 1 << 16,
            chunk: Duration::from_millis(500),
            shard: Shard::WHOLE,
            front_bytes: FRONT_BYTES,
            shares_judged: true,
        }
    }
}

impl Settings {
    /// Points that the front of a study may have while it is looked for.
    pub(crate) fn most_points(&self, plan: &Plan) -> u64 {
        most_points(plan.study.objectives.len(), self.front_bytes)
    }

    /// The front so far, of a shard or of a sweep that goes on, may have more points than the budget: better designs to come may beat
    /// most of them. It must fit into memory all the same.
    ///
    /// # Errors
    /// [`Error::FrontMemory`].
    pub(crate) fn check_memory(&self, plan: &Plan, points: usize) -> Result<()> {
        if points as u64 <= self.most_points(plan) {
            return Ok(());
        }
        Err(Error::FrontMemory { points: points as u64, megabytes: self.front_bytes >> 20, example: coarser(plan), resume: String::new() })
    }

    /// The front of a whole study must keep within its budget.
    ///
    /// # Errors
    /// [`Error::FrontBudget`].
    pub(crate) fn check_budget(&self, plan: &Plan, state: &State) -> Result<()> {
        let (points, budget) = (state.front.len() as u64, plan.study.report.front_budget);
        if self.shard != Shard::WHOLE || points <= budget {
            return Ok(());
        }
        Err(Error::FrontBudget { points, budget, example: coarser(plan), resume: String::new() })
    }
}

/// The first objective with a resolution to be filled in.
fn coarser(plan: &Plan) -> String {
    let objective = plan.study.objectives[0];
    let goal = if objective.goal == crate::study::Goal::Min { "min" } else { "max" };
    let over = if objective.over.is_worst() { String::new() } else { format!(", over_scenarios = \"{}\"", objective.over.word()) };
    format!("{} = {{ goal = \"{goal}\"{over}, resolution = ... }}", objective.quantity.name(&plan.study.model))
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

/// Draws of a whole block take little longer than those of one design: a tile has one, unless it would take this many seconds.
const LONGEST_TILE: f64 = 4.0;

/// A chunk that takes this many times as long as planned is handed over unfinished.
const PATIENCE: f64 = 2.0;

/// Least time of a chunk and between two saves.
const LEAST_CHUNK: Duration = Duration::from_millis(50);

/// Most blocks of the head start. It also takes at most one in `HEAD_START_SHARE` of all designs.
const HEAD_START: u64 = 256;
const HEAD_START_SHARE: u64 = 64;
/// Most rows of the coarser grid.
const HEAD_START_ROWS: u64 = 1 << 16;
/// Most seconds of the head start.
const HEAD_START_TIME: f64 = 0.3;

/// What is swept, how, and who may stop it.
#[derive(Clone, Copy)]
struct SweepJob<'a> {
    plan: &'a Plan,
    tables: &'a Tables,
    reduction: &'a Reduction,
    options: &'a Settings,
    control: &'a Control,
}

impl SweepJob<'_> {
    /// Positions of the designs of this shard.
    fn whole(&self) -> std::ops::Range<u64> {
        self.options.shard.range(self.plan.designs())
    }
}

/// What the threads share.
struct SweepWork<'a> {
    options: Settings,
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

impl<'a> SweepWork<'a> {
    /// What a checkpoint holds, or nothing yet but the front of a few designs.
    fn begin(job: SweepJob<'_>, mut checkpoint: Option<&'a mut Checkpoint>) -> Result<Self> {
        let progress = match checkpoint.as_deref_mut() {
            Some(checkpoint) => checkpoint.take_progress(job.plan, job.reduction)?,
            None => None,
        };
        let fresh = || {
            let front = &Reduction::of_front(job.plan);
            head_start(job.reduction, &mut look_around(SweepJob { reduction: front, ..job }, &job.whole(), HEAD_START_TIME))
        };
        let progress = progress.unwrap_or_else(|| Progress { done: Ranges::default(), state: fresh() });
        Ok(Self::new(job, progress, checkpoint))
    }

    fn new(job: SweepJob<'_>, progress: Progress, checkpoint: Option<&'a mut Checkpoint>) -> Self {
        let SweepJob { reduction, options, control, .. } = job;
        let Progress { done, state } = progress;
        let whole = job.whole();
        control.done.store(done.count(), Ordering::Relaxed);
        let mut reducers = reduction.restore(state);
        let known = Arc::new(reducers.front.points().clone());
        let start = Instant::now();
        Self {
            options: *options,
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
        if let Err(too_large) = self.options.check_memory(plan, self.reducers.front.len()) {
            let state = self.reducers.state();
            self.save(&state)?;
            return Err(too_large);
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
/// [`Error::Stopped`] after `control.stop`; [`Error::FrontBudget`] of a whole study; [`Error::FrontMemory`]; [`Error::Io`] if the
/// checkpoint cannot be written. What was judged is kept in the checkpoint whichever it is.
pub fn sweep(
    plan: &Plan,
    tables: &Tables,
    reduction: &Reduction,
    options: &Settings,
    checkpoint: Option<&mut Checkpoint>,
    control: &Control,
) -> Result<Swept> {
    let start = Instant::now();
    let job = SweepJob { plan, tables, reduction, options, control };
    let work = SweepWork::begin(job, checkpoint)?;
    let designs = work.todo.count();
    let state = judge(job, work)?;
    Ok(Swept { state, designs, time: start.elapsed() })
}

/// Judges what is left to do, design by design.
fn judge(job: SweepJob<'_>, mut work: SweepWork<'_>) -> Result<State> {
    let SweepJob { plan, options, control, .. } = job;
    let shared = Mutex::new(&mut work);
    let told = |designs: u64| {
        control.done.fetch_add(designs, Ordering::Relaxed);
    };
    on_threads(0..options.threads.max(1), |_| run_thread(job, &shared, &told));
    if let Some(failure) = work.failure {
        return Err(failure);
    }
    let state = work.reducers.state();
    work.save(&state)?;
    if work.todo.count() > 0 || control.stop.load(Ordering::Relaxed) {
        return Err(Error::Stopped { kept: None });
    }
    options.check_budget(plan, &state)?;
    Ok(state)
}

/// What remains of a few designs from all over a range, so that the first chunks have something to compare with: stretches of neighbours,
/// and whole rows of a coarser grid, which has the ends of every slow axis, where fronts often are.
///
/// It takes about so many seconds at most, by the cost that the model states. They are designs like any other, judged in f64: the sweep will
/// meet them again and finds those of the front there already.
fn look_around(job: SweepJob<'_>, whole: &std::ops::Range<u64>, seconds: f64) -> Reducers {
    let SweepJob { plan, tables, reduction, control, .. } = job;
    let mut seen = reduction.start();
    let mut engine = CpuEngine::new(plan, tables).stopping_on(&control.stop);
    let designs = whole.end - whole.start;
    let affordable = (seconds / (plan.seconds_per_design() * BLOCK as f64)) as u64;
    for step in 0..(designs / HEAD_START_SHARE / BLOCK as u64).min(HEAD_START).min(affordable) {
        let first = whole.start + ((u128::from(plan.spread(step)) * u128::from(designs)) / u128::from(plan.designs())) as u64;
        engine.screen(first..whole.end.min(first + BLOCK as u64), |block| reduction.absorb(&mut seen, block));
    }
    let (start, width) = (Instant::now(), plan.fast.count());
    let most = (plan.slow.count() / HEAD_START_SHARE).min(HEAD_START_ROWS);
    if most > 0 && plan.seconds_per_design() * (width as f64) < seconds / 4.0 {
        let rows = plan.slow.coarse(most);
        for step in 0..rows.len() as u64 {
            // All over them from the beginning: there may be no time for all.
            let row = rows[spread(rows.len() as u64, step) as usize] * width;
            if whole.contains(&row) && whole.contains(&(row + width - 1)) {
                engine.screen_for(row..row + width, reduction, &mut seen);
            }
            if start.elapsed().as_secs_f64() > seconds / 2.0 {
                break;
            }
        }
    }
    seen
}

/// The state of a sweep that has counted nothing, but knows the front of what was seen.
fn head_start(reduction: &Reduction, seen: &mut Reducers) -> State {
    let mut state = reduction.start().state();
    state.front = seen.front.points().clone();
    state
}

/// Where a tile that begins at `position` ends: at the end of a row, if it is longer than one.
fn tile_end(position: u64, tile: u64, row: u64) -> u64 {
    let end = position.saturating_add(tile);
    if tile > row { end.checked_next_multiple_of(row).unwrap_or(end) } else { end }
}

/// Work is cut by time: a tile of a slow model may be a single design, but not where draws are computed for a block at a time.
fn least_tile(plan: &Plan) -> u64 {
    let block = if plan.study.probability.is_some() { BLOCK as u64 } else { 1 };
    block.min((LONGEST_TILE / plan.seconds_per_design()) as u64).max(1)
}

/// Judges designs until there are none left; `told` how many. Returns how many it was in all.
fn run_thread(job: SweepJob<'_>, work: &Mutex<&mut SweepWork<'_>>, told: &dyn Fn(u64)) -> u64 {
    let SweepJob { plan, tables, reduction, options, control } = job;
    let mut engine = CpuEngine::new(plan, tables).stopping_on(&control.stop);
    let least = least_tile(plan).min(options.tile);
    let tile_at = |rate: f64| ((rate * TILE_TIME.as_secs_f64()) as u64).clamp(least, options.tile);
    let lock = || work.lock().unwrap_or_else(PoisonError::into_inner);
    let row = plan.fast.count();
    let mut all = 0;
    loop {
        let (chunk, known, planned, mut tile) = {
            let mut work = lock();
            // Short chunks first, so that little is lost early too; a large front is expensive to merge and to keep: longer ones then.
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
                return all;
            }
            match work.todo.take(if size > row { size.next_multiple_of(row) } else { size }) {
                Some(chunk) => (chunk, Arc::clone(&work.known), seconds, tile),
                None => return all,
            }
        };
        let start = Instant::now();
        let mut reducers = reduction.start_after(Points::clone(&known));
        drop(known);
        let mut position = chunk.start;
        while position < chunk.end && !control.stop.load(Ordering::Relaxed) {
            let end = chunk.end.min(tile_end(position, tile, row));
            let judged = engine.screen_for(position..end, reduction, &mut reducers);
            told(judged - position);
            position = judged;
            let seconds = start.elapsed().as_secs_f64();
            if seconds > PATIENCE * planned {
                break;
            }
            tile = tile_at((position - chunk.start) as f64 / seconds.max(1e-9));
        }
        all += position - chunk.start;
        hand_over(plan, chunk.start..position, chunk.end, reducers, start.elapsed(), &mut lock());
    }
}

/// Merges a finished chunk (or the part of it that was finished when the run was stopped, or patience was lost with it) and keeps the checkpoint.
fn hand_over(plan: &Plan, finished: std::ops::Range<u64>, chunk_end: u64, reducers: Reducers, time: Duration, work: &mut SweepWork<'_>) {
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
