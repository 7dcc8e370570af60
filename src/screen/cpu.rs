//! The CPU engine: f64, eight designs at a time.
//!
//! For each row (one combination of the slow design axes): `prepare` once per slow scenario, judge what is the same for the
//! whole row ([row]), then run the inner loop over blocks of the fast design axes ([block]), scenario by scenario, until no design is left.

mod block;
mod ordered;
mod row;

pub(super) use row::{holds, row_value, worse_of};

use super::Block;
use super::decisive::Decisive;
use super::kept_rows::KeptRows;
use super::ordered::{OrderedNumbers, RowRun};
use super::row_list::{RowList, RowNumbers};
use super::rows_together::{BlockOfRows, RowsTogether};
use super::spectrum::CaseSums;
use super::tables::{BLOCK, FastBlock, Tables, lane_list};
use crate::models::{Latest, Scratch, Set, Sizes};
use crate::plan::Plan;
use crate::tape::LaneNumbers;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

/// Judges ranges of designs; one per thread.
#[derive(Debug)]
pub struct CpuEngine<'p> {
    plan: &'p Plan,
    tables: &'p Tables,
    /// Inputs of design 0 in scenario 0, in their units.
    first: Vec<f64>,
    /// Slow inputs that the first stage reads.
    slow_reads: Set,
    /// Room for the inputs of the row before.
    before: Vec<f64>,
    /// Inputs of the current row and scenario, in their units and in SI.
    pub(super) own: Vec<f64>,
    si: Vec<f64>,
    /// The current row, its prepared table and what is the same for all its designs.
    pub(super) row: Option<u64>,
    row_feasible: bool,
    row_worst: Vec<f64>,
    /// One stretch of [`CpuEngine::width`] numbers per slow scenario that there is room for, and a last one for the others.
    prepared: Vec<f64>,
    room: u64,
    /// How many of them hold for the current row.
    kept: u64,
    width: usize,
    /// Outputs that the study asks for.
    wanted: Set,
    /// Kernel results: lane outputs, then lane condition margins.
    pub(super) results: Vec<Vec<f64>>,
    /// The block being judged: which designs are still in, and the worst values so far.
    alive: Vec<u64>,
    values: Vec<Vec<f64>>,
    row_index: u64,
    /// Sums over the cases of a spectrum: of values that are the same for the whole row, and of those of the block.
    row_sums: CaseSums,
    lane_sums: CaseSums,
    /// The current slow and fast scenario.
    scenario: (u64, u64),
    scratch: Scratch,
    /// Condition margins and row outputs (SI) of the current row and scenario.
    pub(super) row_margins: Vec<f64>,
    pub(super) row_outputs: Vec<f64>,
    /// The same of the rows before, for those that share it.
    pub(super) kept_rows: KeptRows,
    /// Rows and scenarios that differ in what the first stage does not read for them share what it passed on.
    latest: Latest,
    /// Set to end the work as soon as may be.
    stop: Option<&'p AtomicBool>,
    /// The only scenarios, slow and fast, that are looked at; none means all.
    chosen: Vec<(u64, u64)>,
    /// Room for the second stage as a list, and which scenarios of the current row it is run in.
    pub(super) numbers: Option<(LaneNumbers, Decisive)>,
    /// What is the same for the current row, over all scenarios at once, where that serves.
    row_numbers: Option<RowNumbers>,
    /// Are they those of the current row?
    is_listed: bool,
    /// The row before the current one.
    last_row: Option<u64>,
    /// Room for designs that are judged together, where rows have no more than one.
    together: Option<BlockOfRows>,
    /// Designs of a row that are to be judged.
    ahead: u64,
    ordered_numbers: OrderedNumbers,
    pub(super) row_run: RowRun,
}

impl<'p> CpuEngine<'p> {
    /// An engine for a plan and its tables.
    pub fn new(plan: &'p Plan, tables: &'p Tables) -> Self {
        Self::with_room(plan, tables, plan.kept_scenarios())
    }

    /// The same engine, which gives up what it is at when `stop` is set.
    #[must_use]
    pub fn stopping_on(self, stop: &'p AtomicBool) -> Self {
        Self { stop: Some(stop), ..self }
    }

    /// The same engine where the values of infeasible designs matter too.
    #[must_use]
    pub fn with_all_values(mut self) -> Self {
        self.scratch = self.scratch.asking_for(Vec::new());
        self
    }

    /// Bytes of prepared numbers and sums under way that an engine for this plan keeps.
    pub fn prepared_bytes(plan: &Plan) -> u64 {
        let prepared = 8 * plan.study.model.kernel.prepared_len() as u64 * (plan.kept_scenarios() + 1);
        let lanes = lane_list(plan);
        let of_lanes = lanes.as_ref().map_or(0, |list| list.bytes(BLOCK) + Decisive::bytes(plan, list));
        prepared + CaseSums::bytes(plan, BLOCK) + of_lanes + RowList::room(plan, lanes.as_ref()) + RowsTogether::room(plan)
    }

    /// An engine that keeps the prepared numbers of that many slow scenarios.
    fn with_room(plan: &'p Plan, tables: &'p Tables, room: u64) -> Self {
        let columns = plan.lane_outputs.len() + plan.lane_conditions.len();
        let first = plan.space.inputs(0, 0);
        let Sizes { prepared: width, outputs, conditions, .. } = plan.study.model.kernel.sizes();
        let numbers = tables.lanes.as_ref().and_then(|list| Some((list.numbers(BLOCK), Decisive::new(plan, list)?)));
        Self {
            row_numbers: tables.rows.as_ref().filter(|_| numbers.is_some() || columns == 0).map(RowNumbers::new),
            numbers,
            together: tables.together.as_ref().map(|rows| BlockOfRows::new(plan, rows)),
            plan,
            tables,
            slow_reads: plan.dependencies.prepared & plan.slow.inputs(),
            before: first.clone(),
            own: first.clone(),
            first,
            si: vec![0.0; plan.study.model.inputs.len()],
            row: None,
            row_feasible: false,
            row_worst: vec![0.0; plan.tracked.len()],
            prepared: vec![0.0; width * (room as usize + 1)],
            room,
            kept: 0,
            width,
            wanted: plan.used_outputs(),
            results: vec![vec![0.0; BLOCK]; columns],
            alive: Vec::new(),
            values: vec![vec![0.0; BLOCK]; plan.tracked.len()],
            row_index: 0,
            row_sums: CaseSums::new(plan, 1),
            lane_sums: CaseSums::new(plan, BLOCK),
            scenario: (0, 0),
            scratch: Scratch::new(plan.study.model.inputs.len(), &*plan.study.model.kernel).asking_for(plan.least_values()),
            row_margins: vec![0.0; conditions],
            row_outputs: vec![0.0; outputs],
            kept_rows: KeptRows::new(plan),
            latest: Latest::new(&plan.study.model),
            stop: None,
            chosen: Vec::new(),
            ordered_numbers: OrderedNumbers::default(),
            row_run: RowRun::default(),
            ahead: 0,
            is_listed: false,
            last_row: None,
        }
    }

    pub(super) fn stopped(&self) -> bool {
        self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    /// Judges the designs at `positions` and hands each block with a feasible design to `absorb`. Returns the position before which
    /// all are judged: the end, unless the engine was stopped.
    pub fn screen(&mut self, positions: Range<u64>, mut absorb: impl FnMut(&Block<'_>)) -> u64 {
        let mut position = positions.start;
        while position < positions.end {
            let (places, next) = self.tables.judged.first_of(&(position..positions.end));
            position += places.len() as u64;
            self.tables.judged.hand_over(self.plan, places, &mut absorb);
            let reached = self.judge(position..next, &mut absorb);
            if reached < next {
                return reached;
            }
            position = next;
        }
        position
    }

    /// Judges designs that the sample has not judged, as [`CpuEngine::screen`] does.
    fn judge(&mut self, positions: Range<u64>, mut absorb: &mut impl FnMut(&Block<'_>)) -> u64 {
        if let (Some(rows), Some(block), true) = (&self.tables.together, &mut self.together, self.chosen.is_empty()) {
            let is_stopped = || self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed));
            return block.judge(self.plan, rows, positions, is_stopped, absorb);
        }
        let width = self.plan.fast.count();
        self.ahead = width;
        let mut position = positions.start;
        while position < positions.end {
            let (row, first) = (position / width, position % width);
            let end = width.min(first + (positions.end - position));
            if !self.enter_row(row) {
                return position;
            }
            let judged = if self.row_feasible { self.screen_row(first..end, &mut absorb) } else { end };
            position += judged - first;
            if judged < end {
                return position;
            }
        }
        position
    }

    /// Judges single designs, given by their sorted positions, and hands each block with a feasible design to `absorb`.
    pub fn screen_some(&mut self, positions: &[u64], mut absorb: impl FnMut(&Block<'_>)) {
        let width = self.plan.fast.count();
        for row in positions.chunk_by(|a, b| a / width == b / width) {
            self.ahead = row.len() as u64;
            if self.enter_row(row[0] / width) && self.row_feasible {
                for block in row.chunks(BLOCK) {
                    let places: Vec<u64> = block.iter().map(|position| position % width).collect();
                    self.screen_block(&FastBlock::picked(self.plan, self.tables, &places), &mut absorb);
                }
            }
        }
    }

    /// The same in some scenarios only (slow and fast, sorted); none means all.
    pub fn screen_some_in(&mut self, chosen: &[(u64, u64)], positions: &[u64], absorb: impl FnMut(&Block<'_>)) {
        self.row = None;
        self.chosen.extend(chosen);
        self.screen_some(positions, absorb);
        self.chosen.clear();
        self.row = None;
    }

    /// Judges the designs of some rows that stand at the same places of each, and hands each block with a feasible design to `absorb`.
    /// What the rows have in common is made once. If some scenarios are `chosen` (slow and fast, sorted), only they are looked at.
    pub fn screen_rows(&mut self, rows: &[u64], places: &[u64], chosen: &[(u64, u64)], mut absorb: impl FnMut(&Block<'_>)) {
        if !chosen.is_empty() {
            self.row = None;
        }
        self.chosen.extend(chosen);
        self.ahead = places.len() as u64;
        let blocks: Vec<FastBlock> = places.chunks(BLOCK).map(|places| FastBlock::picked(self.plan, self.tables, places)).collect();
        for &row in rows {
            if self.enter_row(row) && self.row_feasible {
                for block in &blocks {
                    self.screen_block(block, &mut absorb);
                }
            }
        }
        if !chosen.is_empty() {
            self.chosen.clear();
            self.row = None;
        }
    }

    /// Judges a part of the current row; returns where it stopped, the end if nobody told it to.
    fn screen_row(&mut self, fast: Range<u64>, absorb: &mut impl FnMut(&Block<'_>)) -> u64 {
        let tables = self.tables;
        let mut first = fast.start;
        while first < fast.end {
            // A kept block is used whole; the ragged ends of a range and blocks that are not kept are made as they come.
            let whole = tables.blocks.get(usize::try_from(first / BLOCK as u64).unwrap_or(usize::MAX));
            let (last, done) = match whole {
                Some(block) if first.is_multiple_of(BLOCK as u64) && first + block.count as u64 <= fast.end => {
                    (first + block.count as u64, self.screen_block(block, absorb))
                }
                _ => {
                    let to_grid = BLOCK as u64 - first % BLOCK as u64;
                    let last = fast.end.min(first + to_grid);
                    (last, self.screen_block(&FastBlock::new(self.plan, self.tables.lanes.as_ref(), first..last), absorb))
                }
            };
            if !done {
                return first;
            }
            first = last;
        }
        first
    }
}

#[cfg(test)]
mod tests;
