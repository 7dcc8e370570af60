//! What every design is worth in a working set of scenarios, kept while only bounds change.
//!
//! A bound that moves changes no value. So the worst values of all designs are kept, without the bounds, and a front under other bounds is
//! found by holding each design against them.

use super::search::WorkingSet;
use crate::certify::{Column, margin_columns};
use crate::masks::{count, keep_between, keep_finite};
use crate::models::Worse;
use crate::parallel::on_threads;
use crate::plan::{Plan, Tracked};
use crate::reduce::{Points, Reduction};
use crate::screen::{BLOCK, Block, CpuEngine, Tables};
use crate::study::{Constraint, OverScenarios, Study};
use rustc_hash::FxHashSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Most bytes of a table.
const MOST_BYTES: u64 = 64 << 20;
/// Parts of a table, per thread.
const PARTS: usize = 16;

/// The worst values of designs in a working set.
#[derive(Debug)]
pub struct WorstTable {
    /// Of the study without its bounds.
    hash: String,
    followed: Vec<Tracked>,
    set: WorkingSet,
    /// Of a coarse grid of rows: their front drops most of what follows.
    coarse: Arc<Vec<TablePart>>,
    /// Of all other rows, once they are asked for.
    rest: Option<Vec<TablePart>>,
}

/// What a front has beside the designs of a table.
#[derive(Debug, Default)]
pub struct TableBeside<'a> {
    /// The front of other designs, or of designs with other values.
    pub points: Points,
    /// Designs of the table that are left out.
    pub without: Option<&'a FxHashSet<u64>>,
}

/// Those of some rows of the sweep.
#[derive(Debug)]
struct TablePart {
    rows: Vec<u64>,
    /// By what the plan follows: one value per design, row by row; not a number where a design has no result.
    columns: Vec<Vec<f64>>,
}

/// What a study's bounds are asked of: places among what the plan follows, with the least and the largest value that holds.
type LiveBounds = Vec<(usize, f64, f64)>;

/// The plan of a study without bounds that follows what they are about.
pub fn free_plan(study: &Study) -> Plan {
    let followed: Vec<Tracked> = margin_columns(study).iter().flat_map(Column::followed).collect();
    let free = Study { constraints: Vec::new(), ..study.clone() };
    Plan::following(free, &followed)
}

/// Is the table of a plan small enough to be kept?
pub fn is_kept(free: &Plan) -> bool {
    free.designs().saturating_mul(8 * free.tracked.len() as u64) <= MOST_BYTES
}

impl WorstTable {
    /// Judges every design of at most so many rows, which are spread over all, in some scenarios; `None` if it was stopped.
    pub fn begin(free: &Plan, tables: &Tables, set: &WorkingSet, rows: u64, threads: usize, stop: &AtomicBool) -> Option<Self> {
        let coarse = Arc::new(judge(free, tables, set, &shares(&free.slow.coarse(rows.max(1)), threads), threads, stop, |_, new| new)?);
        Some(Self { hash: free.study.hash(), followed: followed(free), set: set.clone(), coarse, rest: None })
    }

    /// The same with all other designs; `None` if it was stopped.
    pub fn finish(&self, free: &Plan, tables: &Tables, threads: usize, stop: &AtomicBool) -> Option<Self> {
        let known: FxHashSet<u64> = self.coarse.iter().flat_map(|part| part.rows.iter().copied()).collect();
        let rows: Vec<u64> = (0..free.slow.count()).filter(|row| !known.contains(row)).collect();
        let rest = Some(judge(free, tables, &self.set, &shares(&rows, threads), threads, stop, |_, new| new)?);
        let (hash, followed, set) = (self.hash.clone(), self.followed.clone(), self.set.clone());
        Some(Self { hash, followed, set, coarse: Arc::clone(&self.coarse), rest })
    }

    /// The scenarios that a larger working set has beyond this table's, if that is all that it lacks.
    pub fn lacks(&self, free: &Plan, set: &WorkingSet) -> Option<WorkingSet> {
        let is_worst = |(it, _): &(Tracked, _)| it.over == OverScenarios::Worst;
        let new = set.beyond(&self.set).filter(|new| *new != WorkingSet::default())?;
        (free.tracked.iter().all(is_worst) && self.serves(free, &self.set)).then_some(new)
    }

    /// The same with more scenarios: only these are judged, and of both values the worse one counts. `None` if it was stopped.
    pub fn joined_by(&self, free: &Plan, tables: &Tables, new: &WorkingSet, threads: usize, stop: &AtomicBool) -> Option<Self> {
        let joined = |parts: &[TablePart]| {
            let rows: Vec<&[u64]> = parts.iter().map(|part| part.rows.as_slice()).collect();
            judge(free, tables, new, &rows, threads, stop, |number, new| worse(free, &parts[number].columns, new))
        };
        let coarse = Arc::new(joined(&self.coarse)?);
        let rest = match &self.rest {
            Some(rest) => Some(joined(rest)?),
            None => None,
        };
        Some(Self { hash: self.hash.clone(), followed: self.followed.clone(), set: self.set.joined_by(new), coarse, rest })
    }

    /// The rows with the bits of their values, in order.
    #[cfg(test)]
    pub fn values(&self, width: usize) -> Vec<(u64, Vec<u64>)> {
        let parts = self.coarse.iter().chain(self.rest.iter().flatten());
        let of_row = |part: &TablePart, at: usize| {
            part.columns.iter().flat_map(|column| column[at * width..][..width].iter().map(|it| it.to_bits())).collect()
        };
        let mut rows: Vec<_> = parts.flat_map(|part| (0..part.rows.len()).map(|at| (part.rows[at], of_row(part, at)))).collect();
        rows.sort_unstable();
        rows
    }

    /// Are all designs in it?
    pub fn is_whole(&self) -> bool {
        self.rest.is_some()
    }

    /// Designs of the coarse grid.
    pub fn begun(&self, free: &Plan) -> u64 {
        self.coarse.iter().map(|part| part.rows.len() as u64).sum::<u64>() * free.fast.count()
    }

    /// Does it serve a plan without bounds and a working set?
    pub fn serves(&self, free: &Plan, set: &WorkingSet) -> bool {
        self.set == *set && self.followed == followed(free) && self.hash == free.study.hash()
    }

    /// The front of all designs in it that keep the bounds, but for some that count with other values; `None` if it was stopped.
    pub fn front_beside(&self, beside: TableBeside<'_>, free: &Plan, study: &Study, threads: usize, stop: &AtomicBool) -> Option<Points> {
        let parts: Vec<&TablePart> = self.coarse.iter().chain(self.rest.iter().flatten()).collect();
        front(&parts, &beside, free, study, threads, stop)
    }

    /// The front of the coarse grid's designs that keep the bounds of a study; `None` if it was stopped.
    pub fn coarse_front(&self, free: &Plan, study: &Study, threads: usize, stop: &AtomicBool) -> Option<Points> {
        let parts: Vec<&TablePart> = self.coarse.iter().collect();
        front(&parts, &TableBeside::default(), free, study, threads, stop)
    }

    /// The front of all designs in it that keep the bounds, where that of the coarse grid is known; `None` if it was stopped.
    pub fn front(&self, coarse: Points, free: &Plan, study: &Study, threads: usize, stop: &AtomicBool) -> Option<Points> {
        let parts: Vec<&TablePart> = self.rest.iter().flatten().collect();
        front(&parts, &TableBeside { points: coarse, without: None }, free, study, threads, stop)
    }
}

/// Rows cut into parts for so many threads.
fn shares(rows: &[u64], threads: usize) -> Vec<&[u64]> {
    rows.chunks(rows.len().div_ceil(PARTS * threads).max(1)).collect()
}

/// The worse of two values each; none where either is missing.
fn worse(free: &Plan, known: &[Vec<f64>], mut new: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    for (((tracked, _), known), new) in free.tracked.iter().zip(known).zip(&mut new) {
        let both = known.iter().zip(new);
        match tracked.worse {
            Worse::Lower => both.for_each(|(&known, new)| *new = if known < *new || known.is_nan() { known } else { *new }),
            Worse::Higher => both.for_each(|(&known, new)| *new = if known > *new || known.is_nan() { known } else { *new }),
        }
    }
    new
}

/// Judges every design of some rows, share by share; `keep` makes of a share's number and values what is kept.
fn judge(
    free: &Plan,
    tables: &Tables,
    set: &WorkingSet,
    shares: &[&[u64]],
    threads: usize,
    stop: &AtomicBool,
    keep: impl Fn(usize, Vec<Vec<f64>>) -> Vec<Vec<f64>> + Sync,
) -> Option<Vec<TablePart>> {
    let width = free.fast.count();
    let (places, chosen) = ((0..width).collect::<Vec<u64>>(), set.chosen(free));
    let next = AtomicUsize::new(0);
    let parts = on_threads(0..threads, |_| {
        let mut engine = CpuEngine::new(free, tables).stopping_on(stop);
        let mut own = Vec::new();
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            let Some(rows) = shares.get(number).filter(|_| !stop.load(Ordering::Relaxed)) else { break };
            let size = usize::try_from(rows.len() as u64 * width).expect("it is held in memory");
            let mut columns = vec![vec![f64::NAN; size]; free.tracked.len()];
            engine.screen_rows(rows, &places, &chosen, |block| {
                let row = rows.binary_search(&free.slow.index_of(block.row_index)).expect("it is one of these");
                let first = usize::try_from(row as u64 * width + free.fast.index_of(block.offsets[0])).expect("it is held in memory");
                for (at, column) in columns.iter_mut().enumerate() {
                    let values = block.column(at).iter().zip(block.alive);
                    let room = &mut column[first..first + block.count()];
                    room.iter_mut().zip(values).for_each(|(to, (&value, &alive))| *to = if alive == 0 { f64::NAN } else { value });
                }
            });
            own.push(TablePart { rows: rows.to_vec(), columns: keep(number, columns) });
        }
        own
    });
    (!stop.load(Ordering::Relaxed)).then(|| parts.into_iter().flatten().collect())
}

/// The front of the designs of some parts that keep the bounds of a study, and of what is beside them.
fn front(parts: &[&TablePart], beside: &TableBeside<'_>, free: &Plan, study: &Study, threads: usize, stop: &AtomicBool) -> Option<Points> {
    let reduction = Reduction::of_front(free);
    let bounds = bounds(free, study);
    let offsets: Vec<u64> = (0..free.fast.count()).map(|place| free.fast.source_index(place)).collect();
    let next = AtomicUsize::new(0);
    let found = on_threads(0..threads, |_| {
        let mut own = reduction.start_after(beside.points.clone());
        let mut alive = Vec::new();
        let mut values = vec![Vec::new(); free.tracked.len()];
        while let Some(part) = parts.get(next.fetch_add(1, Ordering::Relaxed)).filter(|_| !stop.load(Ordering::Relaxed)) {
            for (at, &row) in part.rows.iter().enumerate() {
                let first = at * offsets.len();
                let row_index = free.slow.source_index(row);
                for (number, offsets) in offsets.chunks(BLOCK).enumerate() {
                    let place = first + number * BLOCK;
                    let lanes = place..place + offsets.len();
                    alive.clear();
                    alive.resize(offsets.len(), u64::MAX);
                    keep_finite(&mut alive, &part.columns[0][lanes.clone()]);
                    for &(column, low, high) in &bounds {
                        keep_between(&mut alive, &part.columns[column][lanes.clone()], low, high);
                    }
                    if let Some(without) = beside.without {
                        let of_design = alive.iter_mut().zip(offsets).filter(|(alive, _)| **alive != 0);
                        of_design.for_each(|(alive, offset)| *alive *= u64::from(!without.contains(&(row_index + offset))));
                    }
                    let feasible_count = count(&alive);
                    if feasible_count == 0 {
                        continue;
                    }
                    for &column in &free.objectives {
                        values[column].clear();
                        values[column].extend_from_slice(&part.columns[column][lanes.clone()]);
                    }
                    reduction.absorb_objectives(&mut own, &Block { row_index, offsets, feasible_count, alive: &alive, values: &values });
                }
            }
        }
        own
    });
    (!stop.load(Ordering::Relaxed)).then(|| reduction.front_together(found))
}

fn followed(plan: &Plan) -> Vec<Tracked> {
    plan.tracked.iter().map(|(it, _)| *it).collect()
}

/// Where the values stand that a study's bounds are about: the least of all scenarios for a lower bound, the largest for an upper one.
fn bounds(free: &Plan, study: &Study) -> LiveBounds {
    let of_constraint = |it: &Constraint| {
        let (low, high) = it.ends();
        let ends =
            margin_columns(study).into_iter().filter(|column| column.is_of(it.quantity, it.over)).flat_map(|column| column.followed());
        let place = |tracked: Tracked| free.tracked.iter().position(|(other, _)| *other == tracked);
        ends.filter_map(place).map(|place| (place, low, high)).collect::<Vec<_>>()
    };
    study.constraints.iter().flat_map(of_constraint).collect()
}
