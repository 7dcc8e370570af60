//! The sweep on a device: tiles judged there, survivors in f64 here, one host thread that keeps the answers.

use super::beside::look_beside_front;
use super::recheck::{Recheck, Recheckable};
use super::{Control, HEAD_START_TIME, Settings, SweepJob, SweepWork, Swept, head_start, look_around};
use crate::checkpoint::{Checkpoint, Progress};
use crate::error::{Error, Result};
use crate::gpu::Device;
use crate::models::Set;
use crate::parallel::on_threads;
use crate::plan::Plan;
use crate::reduce::{Answers, MOST_OBJECTIVES, Points, Reducers, Reduction, State};
use crate::screen::gpu::{GpuEngine, InFlight, Survivor, Survivors, TileCounts, Wrong, value_maps};
use crate::screen::{CpuEngine, Tables};
use crate::study::{MapSpec, Quantity};
use crate::tiles::Ranges;
use std::collections::{HashMap, VecDeque};
use std::ops::Range;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Designs of the first tile: until the front is known almost everything survives.
const FIRST_TILE: u64 = 80_000;
/// How long a tile should take.
const TILE_TIME: Duration = Duration::from_millis(60);
/// Least survivors to be looked through that a thread is started for.
const LEAST_SHARE: usize = 1 << 11;
/// Least evaluations that a thread is started for.
const LEAST_EVALUATIONS: u64 = 1 << 9;

/// A device that a study is to be swept on.
#[derive(Clone, Debug)]
pub struct OnDevice {
    /// The device, which has passed its self-test.
    pub device: Device,
    /// Does its driver end long loops?
    pub limited_loops: bool,
    /// What is to be wrong with the kernel; for testing.
    pub wrong: Wrong,
}

impl DeviceRecord {
    /// As it stands in `run.json`.
    pub fn to_json(&self) -> serde_json::Value {
        serde_json::json!({
            "designs": self.designs, "unsure_designs": self.unsure, "survivors": self.survivors,
            "runs_judged_in_parts": self.open_runs, "judged_singly": self.singly, "survivors_evaluated_in_f64": self.evaluated,
            "tiles": self.tiles, "repeated_tiles": self.repeated,
            "seconds_waiting": self.waiting.as_secs_f64(), "compared_with_f64": self.recheck.to_json(),
        })
    }
}

/// What a device did in a sweep.
#[derive(Clone, Debug, Default)]
pub struct DeviceRecord {
    /// Designs that it judged.
    pub designs: u64,
    /// Of these, designs that were unsure, and that f64 decided.
    pub unsure: u64,
    /// Runs of neighbours that were judged in parts: as a whole they were not settled.
    pub open_runs: u64,
    /// Designs that were judged singly: neither a run of neighbours nor its part settled them.
    pub singly: u64,
    /// Designs that came back for f64, the unsure ones among them.
    pub survivors: u64,
    /// Of these, designs that f64 had to evaluate.
    pub evaluated: u64,
    /// Tiles.
    pub tiles: u64,
    /// Tiles that had to be repeated in parts because too many designs survived.
    pub repeated: u64,
    /// How long the CPU waited for its results. What a driver takes for itself when work is handed to it is not counted.
    pub waiting: Duration,
    /// The comparison with f64 of whole tiles.
    pub recheck: Recheck,
}

/// Sweeps a plan on a device. With a checkpoint, starts from what it holds, on whatever engine that was made.
///
/// # Errors
/// As [`sweep`](super::sweep); [`Error::Gpu`] if the device fails, the checkpoint then holding what was done before;
/// [`Error::ErrorBound`] if f64 finds a value outside a device's error bound; [`Error::Request`] if it cannot serve the study.
pub fn sweep_on_device(
    plan: &Plan,
    tables: &Tables,
    reduction: &Reduction,
    options: &Settings,
    mut checkpoint: Option<&mut Checkpoint>,
    control: &Control,
    on: &OnDevice,
) -> Result<(Swept, DeviceRecord)> {
    let progress = match checkpoint.as_deref_mut() {
        Some(checkpoint) => checkpoint.take_progress(plan, reduction)?,
        None => None,
    };
    go_on(SweepJob { plan, tables, reduction, options, control }, progress, checkpoint, on)
}

/// The same with what was done before.
pub(super) fn go_on(
    job: SweepJob<'_>,
    progress: Option<Progress>,
    checkpoint: Option<&mut Checkpoint>,
    on: &OnDevice,
) -> Result<(Swept, DeviceRecord)> {
    let SweepJob { plan, tables, reduction, options, control } = job;
    let start = Instant::now();
    let mut engine = GpuEngine::new(plan, &reduction.histogram_ranges(), &on.device, on.limited_loops, &on.wrong)?;
    engine.look_for_scenarios(tables, options.threads);
    let whole = job.whole();
    let mut seen = look_around(job, &whole, HEAD_START_TIME);
    // A sweep that goes on knows its own front.
    if progress.is_none() && !on.wrong.is_blind() {
        look_beside_front(job, &whole, HEAD_START_TIME / 2.0, &mut seen);
    }
    let progress = progress.unwrap_or_else(|| Progress { done: Ranges::default(), state: head_start(reduction, &mut seen) });
    let mut work = SweepWork::new(job, progress, checkpoint);
    let designs = work.todo.count();
    let mut run = Run {
        plan,
        reduction,
        engine: &mut engine,
        host: CpuEngine::new(plan, tables),
        tables,
        threads: options.threads.max(1),
        hints: answers(&mut seen),
        record: DeviceRecord::default(),
    };
    // Should the device turn out to break an error bound, nothing that it counted may be kept.
    let before = (work.done.clone(), work.reducers.state());
    let outcome = run.whole_run(&mut work, &whole, control);
    let record = std::mem::take(&mut run.record);
    let state = match &outcome {
        Err(Error::ErrorBound(_)) => {
            work.done = before.0;
            before.1
        }
        // Whatever else happened, what is complete is kept.
        _ => work.reducers.state(),
    };
    work.save(&state)?;
    let rechecked = outcome?;
    if control.stop.load(Ordering::Relaxed) && work.todo.count() > 0 {
        return Err(Error::Stopped { kept: None });
    }
    options.check_budget(plan, &state)?;
    let record = DeviceRecord { recheck: rechecked.into_report(), ..record };
    Ok((Swept { state, designs, time: start.elapsed() }, record))
}

/// Judges tiles of a study on a device and again in f64, without sweeping it.
///
/// # Errors
/// As [`sweep_on_device`].
pub fn recheck_on_device(plan: &Plan, tables: &Tables, reduction: &Reduction, threads: usize, on: &OnDevice) -> Result<Recheck> {
    let mut engine = GpuEngine::new(plan, &reduction.histogram_ranges(), &on.device, on.limited_loops, &on.wrong)?;
    engine.look_for_scenarios(tables, threads);
    let whole = 0..plan.designs();
    let job = SweepJob { plan, tables, reduction, options: &Settings { threads, ..Settings::default() }, control: &Control::default() };
    let answers = answers(&mut look_around(job, &whole, HEAD_START_TIME));
    engine.tell_cells(&answers);
    Recheckable::new(plan, tables, reduction, &mut engine, &answers, &whole, threads).map(Recheckable::into_report)
}

struct Run<'a, 'p> {
    plan: &'p Plan,
    reduction: &'a Reduction,
    engine: &'a mut GpuEngine<'p>,
    host: CpuEngine<'p>,
    tables: &'p Tables,
    threads: usize,
    /// What a look around the range has found: not counted yet, but certain.
    hints: Answers,
    record: DeviceRecord,
}

impl Run<'_, '_> {
    /// Compares whole tiles with f64, judges all that is to do, and looks for what the tiles hold that got lost.
    fn whole_run(&mut self, work: &mut SweepWork<'_>, whole: &Range<u64>, control: &Control) -> Result<Recheckable> {
        let mut rechecked = self.recheck(&mut work.reducers, whole)?;
        self.run(work, control)?;
        if work.todo.count() == 0 {
            rechecked.require_in(self.reduction, &work.reducers.state())?;
        }
        Ok(rechecked)
    }

    /// Judges all that is to do, two tiles in flight.
    fn run(&mut self, work: &mut SweepWork<'_>, control: &Control) -> Result<()> {
        let mut flying: VecDeque<(InFlight, Instant)> = VecDeque::new();
        let mut answers = self.answers(&mut work.reducers);
        self.engine.tell_cells(&answers);
        let mut size = FIRST_TILE.min(self.engine.at_once());
        let least = 1024.min(size);
        // Lowered where a tile had too many survivors.
        let mut most = u64::MAX;
        let mut host_time = Duration::ZERO;
        loop {
            self.start_tiles(&mut flying, work, size, &answers, control);
            let Some((tile, begun)) = flying.pop_front() else { return Ok(()) };
            let waiting = Instant::now();
            let finished = self.engine.finish(&tile);
            self.record.waiting += waiting.elapsed();
            let device_time = begun.elapsed() / (1 + flying.len() as u32);
            let range = tile.range.clone();
            let found = match finished {
                Ok(found) => found,
                Err(error) => {
                    work.todo.add(range);
                    flying.into_iter().for_each(|(tile, _)| work.todo.add(tile.range));
                    return Err(error);
                }
            };
            let designs = range.end - range.start;
            let Some((counts, survivors)) = found else {
                if designs == 1 {
                    return Err(self
                        .engine
                        .device()
                        .error("one design has more survivors, open runs or open parts than there is room for"));
                }
                self.record.repeated += 1;
                most = (designs / 2).max(1);
                size = size.min(most);
                work.todo.add(range);
                continue;
            };
            // The device goes on while the survivors are looked through.
            self.start_tiles(&mut flying, work, size, &answers, control);
            let host = Instant::now();
            self.take_in(work, &counts, &survivors)?;
            self.record.tiles += 1;
            self.record.designs += designs;
            control.done.fetch_add(designs, Ordering::Relaxed);
            work.finish(self.plan, range)?;
            answers = self.answers(&mut work.reducers);
            host_time = host.elapsed().max(host_time / 2);
            let wanted = TILE_TIME.max(2 * host_time).as_secs_f64();
            let fitting = designs as f64 * wanted / device_time.as_secs_f64().max(1e-4);
            size = (fitting as u64).clamp(size / 4, size.saturating_mul(4)).clamp(least.min(most), most);
        }
    }

    /// Hands over tiles until two are in flight.
    fn start_tiles(
        &mut self,
        flying: &mut VecDeque<(InFlight, Instant)>,
        work: &mut SweepWork<'_>,
        size: u64,
        answers: &Answers,
        control: &Control,
    ) {
        while flying.len() < 2 && !control.stop.load(Ordering::Relaxed) {
            let Some(first) = work.todo.first() else { return };
            let tile = self.engine.tile(&first, size);
            work.todo.take(tile.end - tile.start);
            flying.push_back((self.engine.start(tile, answers), Instant::now()));
        }
    }

    /// Adds what the device counted, and decides in f64 what it could not.
    fn take_in(&mut self, work: &mut SweepWork<'_>, counts: &TileCounts, survivors: &Survivors) -> Result<()> {
        let TileCounts { sure, unsure, open_runs, singly, reported } = counts;
        self.reduction.add_counts(&mut work.reducers, *sure, reported);
        self.record.unsure += unsure;
        self.record.open_runs += open_runs;
        self.record.singly += singly;
        self.record.survivors += survivors.len() as u64;
        // The front has grown since the tile was started, and the tile has met the best of its cells: most of what survived is
        // behind them by now.
        let plan = self.plan;
        let (front, objectives) = (&work.reducers.front, plan.study.objectives.len());
        let on_front = |it: &Survivor| it.front.is_some_and(|keys| !front.beats(&lower_keys(plan, &keys)[..objectives]));
        let cells = BestCells::new(plan, survivors);
        let looked = in_shares(survivors.len(), LEAST_SHARE, self.threads, |part| {
            let (mut sure, mut unsure) = (Vec::new(), Vec::new());
            for it in part.map(|at| survivors.get(at)) {
                if it.unsure {
                    unsure.push(it.position);
                } else if it.end || on_front(&it) || cells.may_be_best(plan, &it) {
                    sure.push(it.position);
                }
            }
            // Neighbours in a row are evaluated together.
            sure.sort_unstable();
            unsure.sort_unstable();
            (sure, unsure)
        });
        let (sure, unsure): (Vec<_>, Vec<_>) = looked.into_iter().unzip();
        let (sure, unsure) = (sure.concat(), unsure.concat());
        self.record.evaluated += (sure.len() + unsure.len()) as u64;
        let feasible = self.evaluate(&mut work.reducers, &sure, true);
        if feasible != sure.len() as u64 {
            return Err(self.name_the_infeasible(&sure));
        }
        self.evaluate(&mut work.reducers, &unsure, false);
        Ok(())
    }

    /// Evaluates designs in f64 and takes in the feasible ones, `counted` or not; returns how many these are.
    fn evaluate(&mut self, reducers: &mut Reducers, positions: &[u64], counted: bool) -> u64 {
        let (plan, reduction, tables) = (self.plan, self.reduction, self.tables);
        let absorb = |reducers: &mut Reducers, block: &crate::screen::Block<'_>| {
            if counted { reduction.absorb_counted(reducers, block) } else { reduction.absorb(reducers, block) }
        };
        // Each share begins with reducers of its own, and ends with merging them.
        let least = (LEAST_EVALUATIONS + reducers.reported.size()).div_ceil(plan.scenarios()) as usize;
        let mut feasible = 0;
        if positions.len() < 2 * least || self.threads == 1 {
            self.host.screen_some(positions, |block| {
                feasible += block.feasible_count;
                absorb(reducers, block);
            });
            return feasible;
        }
        // A long share knows the front so far, and drops what it beats; a short one has less to drop than there is to copy.
        let front = reducers.front.points();
        let words = front.keys.len() + front.len();
        let shares = positions.len().div_ceil(least).min(self.threads);
        let known = if positions.len() / shares * plan.scenarios() as usize > words { front.clone() } else { Points::default() };
        let parts: Vec<(State, u64)> = in_shares(positions.len(), least, self.threads, |part| {
            let (mut own, mut feasible) = (reduction.start_after(known.clone()), 0);
            CpuEngine::new(plan, tables).screen_some(&positions[part], |block| {
                feasible += block.feasible_count;
                absorb(&mut own, block);
            });
            (own.into_fresh(), feasible)
        });
        // All at once: merging into a front takes as long as the front is.
        let mut fresh = Points::default();
        for (mut state, found) in parts {
            fresh.keys.append(&mut state.front.keys);
            fresh.indices.append(&mut state.front.indices);
            reducers.merge(state);
            feasible += found;
        }
        reducers.front.merge(fresh);
        feasible
    }

    /// The error for designs that the device called surely feasible though f64 does not.
    fn name_the_infeasible(&mut self, positions: &[u64]) -> Error {
        let host = &mut self.host;
        let infeasible = |position: &&u64| {
            let mut feasible = 0;
            host.screen_some(&[**position], |block| feasible += block.feasible_count);
            feasible == 0
        };
        let mut positions = positions.to_vec();
        positions.sort_unstable();
        let design = positions.iter().find(infeasible).map_or(0, |&position| self.plan.design_at(position));
        Error::ErrorBound(format!("design {design}: the GPU is sure that it is feasible, f64 is sure that it is not"))
    }

    /// The answers so far, or the hints where they say more.
    fn answers(&self, reducers: &mut Reducers) -> Answers {
        let mut answers = answers(reducers);
        answers.tighten(&self.hints);
        answers
    }

    /// Compares whole tiles with f64, design by design.
    fn recheck(&mut self, reducers: &mut Reducers, whole: &Range<u64>) -> Result<Recheckable> {
        let answers = self.answers(reducers);
        self.engine.tell_cells(&answers);
        Recheckable::new(self.plan, self.tables, self.reduction, self.engine, &answers, whole, self.threads)
    }
}

/// Splits `0..count` into shares of at least `least` and calls `each` on every share, each on a thread of its own; results in order.
fn in_shares<T: Send>(count: usize, least: usize, threads: usize, each: impl Fn(Range<usize>) -> T + Sync) -> Vec<T> {
    let shares = (count / least.max(1)).clamp(1, threads);
    let part = |number: usize| count * number / shares..count * (number + 1) / shares;
    on_threads((0..shares).map(part), each)
}

/// The answers so far as the device is told of them.
pub(super) fn answers(reducers: &mut Reducers) -> Answers {
    let extremes = &reducers.extremes;
    let ends = extremes.least.iter().zip(&extremes.largest);
    let end = |it: &Option<crate::reduce::Extreme>| it.map(|it| (it.value, it.index));
    let extremes = ends.map(|(least, largest)| [end(least), end(largest)]).collect();
    let mut answers = Answers { extremes, front: reducers.front.points().keys.clone(), ..Answers::default() };
    reducers.reported.tell(&mut answers);
    answers
}

/// A survivor's lower bounds as f64 keys of the front, a coordinate per objective.
fn lower_keys(plan: &Plan, keys: &[f32; MOST_OBJECTIVES]) -> [f64; MOST_OBJECTIVES] {
    let mut lowered = [0.0; MOST_OBJECTIVES];
    for ((lowered, objective), &lower) in lowered.iter_mut().zip(&plan.study.objectives).zip(keys) {
        let lower = f64::from(lower);
        *lowered = match objective.quantity {
            // The device has inputs as f32 rounds them.
            Quantity::Input(_) => lower - lower.abs() * 6e-8,
            Quantity::Output(_) if objective.resolution.is_some() => lower,
            Quantity::Output(output) => {
                let value = plan.study.model.outputs[output].unit.from_si(lower);
                // The conversion rounds in f64.
                value - value.abs() * 1e-14
            }
        };
    }
    lowered
}

/// Who may be the best of a map's cell, among the survivors of a tile.
#[derive(Default)]
struct BestCells {
    /// Per map and cell: the least upper bound of the key.
    best: HashMap<(usize, u64), f32>,
    /// Per map: the lowest index of designs that agree on every axis that the shown value depends on. The others tie and lose.
    first: HashMap<(usize, u64), u64>,
}

impl BestCells {
    fn new(plan: &Plan, survivors: &Survivors) -> Self {
        let mut cells = Self::default();
        if value_maps(plan).next().is_none() {
            return cells;
        }
        for survivor in survivors.iter().filter(|it| !it.unsure) {
            let design = plan.design_at(survivor.position);
            for (number, keys) in survivor.maps.iter().flatten().enumerate() {
                let (spec, at) = spec_of(plan, number);
                let best = cells.best.entry((number, cell_of(plan, spec, design))).or_insert(f32::INFINITY);
                *best = best.min(keys[1]);
                let first = cells.first.entry((number, known_equal(plan, spec, at, design))).or_insert(u64::MAX);
                *first = design.min(*first);
            }
        }
        cells
    }

    fn may_be_best(&self, plan: &Plan, survivor: &Survivor) -> bool {
        let Some(maps) = &survivor.maps else { return false };
        let design = plan.design_at(survivor.position);
        maps.iter().enumerate().any(|(number, keys)| {
            let (spec, at) = spec_of(plan, number);
            keys[0] <= self.best[&(number, cell_of(plan, spec, design))]
                && self.first[&(number, known_equal(plan, spec, at, design))] == design
        })
    }
}

/// The index that a design shares with those that agree with it on the axes of a map and on all that the shown value depends on.
fn known_equal(plan: &Plan, spec: &MapSpec, tracked: usize, design: u64) -> u64 {
    let depends = match plan.tracked[tracked].0.quantity {
        Quantity::Input(input) => Set::one(input),
        Quantity::Output(output) => plan.dependencies.outputs[output],
    };
    let dimensions = plan.space.designs.dimensions().enumerate();
    let matters =
        |number: usize, inputs: &[usize]| number == spec.x || number == spec.y || inputs.iter().any(|&input| depends.contains(input));
    let mattering = dimensions.filter(|(number, (dimension, _))| matters(*number, dimension.inputs()));
    mattering.map(|(number, (_, stride))| plan.space.designs.digit(number, design) * stride).sum()
}

/// A map of values, and the position of what it shows among the tracked quantities.
fn spec_of(plan: &Plan, number: usize) -> (&MapSpec, usize) {
    let (spec, at, _) = value_maps(plan).nth(number).expect("a survivor has keys for the maps there are");
    (spec, at)
}

fn cell_of(plan: &Plan, spec: &MapSpec, design: u64) -> u64 {
    let designs = &plan.space.designs;
    designs.digit(spec.y, design) * plan.study.design[spec.x].count() + designs.digit(spec.x, design)
}

#[cfg(test)]
mod tests {
    use super::in_shares;

    #[test]
    fn shares_are_in_order_and_leave_nothing_out() {
        for (count, least, threads) in [(0, 4, 3), (1, 4, 3), (11, 4, 3), (12, 4, 3), (100, 4, 3), (100, 0, 7), (5, 1, 1)] {
            let parts = in_shares(count, least, threads, |part| part);
            assert!(parts.len() <= threads && (parts.len() == 1 || parts.iter().all(|part| part.len() >= least)), "{parts:?}");
            assert_eq!(parts.into_iter().flatten().collect::<Vec<_>>(), (0..count).collect::<Vec<_>>());
        }
    }
}
