//! The CPU engine: f64, eight designs at a time.
//!
//! For each row (one combination of the slow design axes): `prepare` once per slow scenario, judge what is the same for the
//! whole row, then run the inner loop over blocks of the fast design axes, scenario by scenario, until no design is left.

use super::Block;
use super::decisive::Decisive;
use super::kept_rows::KeptRows;
use super::lane_list::{LaneList, LaneNumbers};
use super::ordered::{OrderedNumbers, OrderedRow};
use super::row_list::{RowList, RowNumbers};
use super::rows_together::{BlockOfRows, RowsTogether};
use super::spectrum::CaseSums;
use super::tables::{BLOCK, FastBlock, Setting, Tables, setting};
use crate::decision::Decision;
use crate::masks::{self, any, keep_between, keep_finite, keep_margin};
use crate::models::{self, Columns, Latest, Scratch, Set, Sizes, Worse};
use crate::plan::{Plan, Source};
use crate::reduce::{Reducers, Reduction};
use crate::space::Product;
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
        let lanes = LaneList::new(plan);
        let of_lanes = lanes.as_ref().map_or(0, |list| list.bytes() + Decisive::bytes(plan, list));
        prepared + CaseSums::bytes(plan, BLOCK) + of_lanes + RowList::room(plan, lanes.as_ref()) + RowsTogether::room(plan)
    }

    /// An engine that keeps the prepared numbers of that many slow scenarios.
    fn with_room(plan: &'p Plan, tables: &'p Tables, room: u64) -> Self {
        let columns = plan.lane_outputs.len() + plan.lane_conditions.len();
        let first = plan.space.inputs(0, 0);
        let Sizes { prepared: width, outputs, conditions, .. } = plan.study.model.kernel.sizes();
        let numbers = tables.lanes.as_ref().and_then(|list| Some((list.numbers(), Decisive::new(plan, list)?)));
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

    /// Judges the designs at `positions` for reducers; returns what [`CpuEngine::screen`] does. Whole rows whose designs stand in one order
    /// are judged at once where only the front is asked for.
    pub fn screen_for(&mut self, positions: Range<u64>, reduction: &Reduction, reducers: &mut Reducers) -> u64 {
        let width = self.plan.fast.count();
        let mut position = positions.start;
        self.ahead = width;
        if reduction.is_front_only() && self.tables.ordered.is_some() {
            let first = position.next_multiple_of(width);
            let last = positions.end / width;
            if first / width < last {
                position = self.screen(position..first, |block| reduction.absorb(reducers, block));
                while position >= first && position < last * width {
                    if !self.enter_row(position / width) {
                        return position;
                    }
                    let judged = if self.judge_ordered(reduction, reducers) {
                        position + width
                    } else {
                        self.screen(position..position + width, |block| reduction.absorb(reducers, block))
                    };
                    if judged < position + width {
                        return judged;
                    }
                    position = judged;
                }
            }
        }
        self.screen(position..positions.end, |block| reduction.absorb(reducers, block))
    }

    /// Judges the current row at once; false if that cannot be done.
    fn judge_ordered(&mut self, reduction: &Reduction, reducers: &mut Reducers) -> bool {
        let (Some(ordered), Some(list)) = (&self.tables.ordered, &self.tables.lanes) else { return false };
        let Some((numbers, _)) = &self.numbers else { return false };
        if !self.row_feasible {
            return true;
        }
        let row = OrderedRow {
            plan: self.plan,
            list,
            blocks: &self.tables.blocks,
            row: self.row.expect("the row has been entered"),
            row_index: self.row_index,
            row_worst: &self.row_worst,
            numbers: numbers.row(),
        };
        row.judge(ordered, &mut self.ordered_numbers, reduction, reducers)
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

    /// Sets the inputs of a row, prepares its scenarios and judges what is the same for all its designs; false if it was stopped.
    pub(super) fn enter_row(&mut self, row: u64) -> bool {
        if self.row == Some(row) {
            return true;
        }
        self.set_row(row);
        self.row = Some(row);
        self.row_feasible = true;
        for (worst, (tracked, _)) in self.row_worst.iter_mut().zip(&self.plan.tracked) {
            *worst = tracked.worse.least_bad();
        }
        if let Some((_, decisive)) = &mut self.numbers {
            decisive.begin();
        }
        let mut scenarios = 0;
        let done = self.each_scenario(|engine, prepared, _, _| {
            engine.row_feasible &= engine.judge_row_scenario(prepared.clone());
            if engine.row_feasible {
                engine.add_scenario(prepared);
                scenarios += 1;
            }
            engine.row_feasible
        });
        if !done {
            self.row = None;
        } else if let (true, Some((_, decisive)), Some(list)) = (self.row_feasible, &mut self.numbers, &self.tables.lanes) {
            decisive.settle(list, scenarios, self.ahead);
        }
        done
    }

    /// Keeps what the designs of the row need of the current scenario.
    fn add_scenario(&mut self, prepared: Range<usize>) {
        self.enter_scenario(prepared);
        if let (Some((numbers, decisive)), Some(list)) = (&mut self.numbers, &self.tables.lanes) {
            decisive.add(numbers.scalars(list));
        }
    }

    /// Computes what the inner loop reads of the current row and scenario, where it is a list.
    fn enter_scenario(&mut self, prepared: Range<usize>) {
        let is_listed = self.is_listed;
        let (Some((numbers, _)), Some(list)) = (&mut self.numbers, &self.tables.lanes) else { return };
        match (&self.row_numbers, &self.tables.rows) {
            (Some(of_row), Some(rows)) if is_listed => of_row.enter(rows, self.scenario, list, numbers),
            _ => list.enter(numbers, &self.prepared[prepared], &self.si),
        }
    }

    /// Turns to one scenario after the other, as long as `judge` wants to go on; false if it was stopped before that. `judge` is told
    /// where the prepared numbers stand, whether the scenario is the first, and whether it is the last with these numbers.
    fn each_scenario(&mut self, mut judge: impl FnMut(&mut Self, Range<usize>, bool, bool) -> bool) -> bool {
        let (slow, fast) = (self.plan.slow_scenarios.count(), self.plan.fast_scenarios.count());
        if self.chosen.is_empty() {
            for q in 0..slow {
                let prepared = self.prepare(q);
                for t in 0..fast {
                    if self.stopped() {
                        return false;
                    }
                    self.set_fast_scenario(t);
                    if !judge(self, prepared.clone(), q == 0 && t == 0, t + 1 == fast) {
                        return true;
                    }
                }
            }
            return true;
        }
        let chosen = std::mem::take(&mut self.chosen);
        let mut goes_on = true;
        for (at, part) in chosen.chunk_by(|a, b| a.0 == b.0).enumerate() {
            // What is kept is always that of the first scenarios: these find room beside it.
            let prepared = self.prepare_at(part[0].0, self.room);
            for (number, &(_, t)) in part.iter().enumerate() {
                self.set_fast_scenario(t);
                goes_on = goes_on && judge(self, prepared.clone(), at == 0 && number == 0, number + 1 == part.len());
            }
            if !goes_on || self.stopped() {
                break;
            }
        }
        self.chosen = chosen;
        !self.stopped()
    }

    pub(super) fn set_row(&mut self, row: u64) {
        // What a part of the formula does not depend on may still decide a selection the same way for every value of its axis:
        // every input must have one of its own values, not the default.
        let mut before = std::mem::take(&mut self.before);
        before.clone_from(&self.own);
        self.own.copy_from_slice(&self.first);
        self.plan.slow.set(row, &mut self.own);
        models::fill_si(&self.plan.study.model, &self.own, &mut self.si);
        self.row_index = self.plan.slow.source_index(row);
        self.kept_rows.turn(&before, &self.own);
        // The outer of the axes that the first stage does not read is walked with the slow ones: rows along it share what is prepared.
        if (0..self.own.len()).any(|input| self.slow_reads.contains(input) && self.own[input] != before[input]) {
            self.kept = 0;
        }
        self.before = before;
        self.is_listed = false;
        let can_be_listed = self.numbers.is_some() || self.results.is_empty();
        if let (Some(rows), Some(numbers), true) = (&self.tables.rows, &mut self.row_numbers, can_be_listed) {
            // Numbers of several rows do not pay where only some of them are asked for.
            let follows = self.last_row.is_some_and(|last| row == last + 1);
            if follows || numbers.holds(rows, row) || !rows.has_rows() {
                numbers.turn(rows, self.tables.lanes.as_ref(), row, &self.si);
                self.is_listed = true;
            }
        }
        self.last_row = Some(row);
    }

    /// Conditions, constraints and worst values of a row in the current scenario; false if the whole row is out.
    fn judge_row_scenario(&mut self, prepared: Range<usize>) -> bool {
        let plan = self.plan;
        self.row_values(prepared);
        if !plan.row_conditions.iter().all(|&number| holds(plan, number, self.row_margins[number])) {
            return false;
        }
        let value = |source| row_value(plan, source, &self.own, &self.row_outputs);
        let constraints = plan.study.constraints.iter().zip(&plan.constraints);
        if !constraints.filter(|(it, source)| source.is_row() && it.over.is_worst()).all(|(constraint, &source)| {
            let value = value(source);
            value.is_finite() && constraint.holds(value)
        }) {
            return false;
        }
        for ((tracked, source), worst) in plan.tracked.iter().zip(&mut self.row_worst) {
            if source.is_row() && tracked.over.is_worst() {
                let value = value(*source);
                if !value.is_finite() {
                    return false;
                }
                *worst = worse_of(tracked.worse, *worst, value);
            }
        }
        self.row_sums.judge_row(plan, self.scenario, value, &mut self.row_worst)
    }

    /// Computes condition margins and row outputs in the current scenario.
    pub(super) fn row_values(&mut self, prepared: Range<usize>) {
        if let (Some(rows), Some(numbers), true) = (&self.tables.rows, &self.row_numbers, self.is_listed) {
            return numbers.recall(rows, self.scenario, &mut self.row_margins, &mut self.row_outputs);
        }
        if self.kept_rows.recall(self.scenario, &mut self.row_margins, &mut self.row_outputs) {
            return;
        }
        let kernel = &self.plan.study.model.kernel;
        let prepared = &self.prepared[prepared];
        if !self.plan.row_outputs.is_empty() {
            kernel.finish(prepared, &self.si, self.plan.row_outputs, &mut self.row_outputs);
        }
        kernel.conditions(prepared, &self.si, &mut self.row_margins);
        self.kept_rows.keep(self.scenario, &self.row_margins, &self.row_outputs);
    }

    /// Judges one block of the current row over all scenarios; false if it was stopped before it had.
    pub(super) fn screen_block(&mut self, fast: &FastBlock, absorb: &mut impl FnMut(&Block<'_>)) -> bool {
        let plan = self.plan;
        let count = fast.count;
        self.alive.clear();
        self.alive.resize(count, u64::MAX);
        for (constraint, source) in plan.study.constraints.iter().zip(&plan.constraints) {
            if let Source::LaneInput(input) = *source {
                let (low, high) = constraint.ends();
                keep_between(&mut self.alive, fast.own(input), low, high);
            }
        }
        for (((_, source), column), &worst) in plan.tracked.iter().zip(&mut self.values).zip(&self.row_worst) {
            match *source {
                Source::LaneInput(input) => column[..count].copy_from_slice(&fast.own(input)[..count]),
                // The first scenario overwrites what the block before left here.
                Source::LaneOutput(_) => {}
                Source::RowInput(_) | Source::RowOutput(_) => column[..count].fill(worst),
            }
        }
        if !self.results.is_empty() && !self.judge_block(fast) {
            return false;
        }
        let feasible = masks::count(&self.alive);
        if feasible > 0 {
            let (row_index, offsets) = (self.row_index, &fast.offsets);
            absorb(&Block { row_index, offsets, feasible_count: feasible, alive: &self.alive, values: &self.values });
        }
        true
    }

    /// Judges the block in every scenario that may decide; false if it was stopped before it had.
    fn judge_block(&mut self, fast: &FastBlock) -> bool {
        let (Some(list), true) = (&self.tables.lanes, self.numbers.is_some()) else {
            return self.each_scenario(|engine, prepared, is_first, is_last| {
                engine.evaluate(prepared, fast);
                engine.judge_block_scenario(is_first, engine.plan.scenarios() == 1);
                !is_last || any(&engine.alive)
            });
        };
        let count = self.numbers.as_ref().map_or(0, |(_, decisive)| decisive.count());
        for number in 0..count {
            if self.stopped() {
                return false;
            }
            if let Some((numbers, decisive)) = &mut self.numbers {
                numbers.set_scalars(list, decisive.scalars(number));
                list.run(numbers, (&fast.shared, fast.count), &mut self.results);
            }
            self.judge_block_scenario(number == 0, count == 1);
            if !any(&self.alive) {
                break;
            }
        }
        true
    }

    /// Runs the inner loop: lane outputs and lane condition margins of a block in the current scenario.
    pub(super) fn evaluate(&mut self, prepared: Range<usize>, fast: &FastBlock) {
        let plan = self.plan;
        if self.results.is_empty() {
            return;
        }
        self.enter_scenario(prepared.clone());
        if let (Some(list), Some((numbers, _))) = (&self.tables.lanes, &mut self.numbers) {
            return list.run(numbers, (&fast.shared, fast.count), &mut self.results);
        }
        let prepared = &self.prepared[prepared];
        let columns = Columns { count: fast.count, varying: &fast.si, outputs: &plan.lane_outputs, conditions: &plan.lane_conditions };
        plan.study.model.kernel.finish_columns(prepared, &self.si, &columns, &mut self.scratch, &mut self.results);
        columns.to_units(&plan.study.model.outputs, &mut self.results);
    }

    fn judge_block_scenario(&mut self, first: bool, only: bool) {
        let plan = self.plan;
        let (outputs, margins) = self.results.split_at_mut(plan.lane_outputs.len());
        let alive = &mut self.alive;
        for (&number, margins) in plan.lane_conditions.iter().zip(&*margins) {
            keep_margin(alive, margins, plan.study.model.conditions[number].strict);
        }
        let sums = &mut self.lane_sums;
        if let Some(spectrum) = &plan.spectrum {
            sums.judge_lanes(plan, spectrum, (self.scenario, first), outputs, alive, &mut self.values);
        }
        for (constraint, source) in plan.study.constraints.iter().zip(&plan.constraints).filter(|(it, _)| it.over.is_worst()) {
            if let Source::LaneOutput(position) = *source {
                let (low, high) = constraint.ends();
                keep_between(alive, &outputs[position], low, high);
            }
        }
        for ((tracked, source), worst) in plan.tracked.iter().zip(&mut self.values).filter(|((it, _), _)| it.over.is_worst()) {
            if let Source::LaneOutput(position) = *source {
                let output = &outputs[position][..alive.len()];
                // A constraint on the same output has asked for a finite number already.
                if !plan.constraints.contains(source) {
                    keep_finite(alive, output);
                }
                // The only scenario is the worst, and nobody else asks for the column: it changes hands without a copy.
                if only && plan.tracked.iter().filter(|(_, other)| other == source).count() == 1 {
                    std::mem::swap(worst, &mut outputs[position]);
                    continue;
                }
                masks::worsen(tracked.worse, first, &mut worst[..alive.len()], output);
            }
        }
    }

    /// Where the row's prepared numbers of slow scenario `q` stand; its inputs become the current ones. A row asks for its
    /// scenarios in order, so that what is kept is always the first ones.
    pub(super) fn prepare(&mut self, q: u64) -> Range<usize> {
        if q >= self.kept && !self.is_listed {
            let place = self.prepare_at(q, q.min(self.room));
            self.kept = self.kept.max((q + 1).min(self.room));
            return place;
        }
        self.set_slow_scenario(q);
        // Nobody reads the place of a row whose numbers are listed.
        self.place(q.min(self.room))
    }

    /// Prepares a slow scenario at some place.
    fn prepare_at(&mut self, q: u64, at: u64) -> Range<usize> {
        self.set_slow_scenario(q);
        let place = self.place(at);
        if !self.is_listed {
            self.latest.prepare(&self.si, self.wanted, &mut self.prepared[place.clone()]);
        }
        place
    }

    fn place(&self, at: u64) -> Range<usize> {
        let at = at as usize * self.width;
        at..at + self.width
    }

    fn set_slow_scenario(&mut self, q: u64) {
        self.scenario.0 = q;
        let tables = self.tables;
        self.apply(tables.slow_scenarios.get(usize::try_from(q).unwrap_or(usize::MAX)), &self.plan.slow_scenarios, q);
    }

    pub(super) fn set_fast_scenario(&mut self, t: u64) {
        self.scenario.1 = t;
        let tables = self.tables;
        self.apply(tables.fast_scenarios.get(usize::try_from(t).unwrap_or(usize::MAX)), &self.plan.fast_scenarios, t);
    }

    fn apply(&mut self, kept: Option<&Setting>, product: &Product, index: u64) {
        let made;
        let setting = match kept {
            Some(setting) => setting,
            None => {
                made = setting(self.plan, product, index);
                &made
            }
        };
        for &(input, own, si) in setting {
            self.own[input] = own;
            self.si[input] = si;
        }
    }
}

/// Does a condition hold? In f64 the answer is never unsure.
pub(super) fn holds(plan: &Plan, condition: usize, margin: f64) -> bool {
    models::holds(&plan.study.model, condition, margin, 0.0) == Decision::Yes
}

/// A value that is the same for the whole row, in its unit.
pub(super) fn row_value(plan: &Plan, source: Source, own: &[f64], outputs: &[f64]) -> f64 {
    match source {
        Source::RowInput(input) => own[input],
        Source::RowOutput(output) => plan.study.model.outputs[output].unit.from_si(outputs[output]),
        Source::LaneInput(_) | Source::LaneOutput(_) => unreachable!("asked for row sources only"),
    }
}

pub(super) fn worse_of(worse: Worse, a: f64, b: f64) -> f64 {
    match worse {
        Worse::Higher => a.max(b),
        Worse::Lower => a.min(b),
    }
}

#[cfg(test)]
mod tests;
