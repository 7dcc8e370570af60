//! Rows next to each other along the innermost slow axis, entered all at once: what they read stands in columns already
//! ([`RowNumbers`](crate::screen::row_list::RowNumbers)), so that a row costs little more than the search in its sorted designs.

use super::column::SortedColumn;
use super::{OrderedNumbers, OrderedRow, OrderedRows};
use crate::plan::Plan;
use crate::reduce::{Reducers, Reduction};
use crate::screen::tables::FastBlock;
use crate::tape::{ColumnValue, Node};
use std::ops::Range;

/// What is the same for all designs of each row of a column; one per thread.
#[derive(Debug, Default)]
pub(in crate::screen) struct RowRun {
    /// The first row of the column.
    pub(super) first: Option<u64>,
    /// Of each row: may it have feasible designs, what its chains read, and its worst values by tracked quantity.
    may_hold: Vec<bool>,
    others: Vec<f64>,
    worst: Vec<f64>,
}

/// A row of a run: its sorted designs, and the places of the feasible ones.
struct NarrowedRow<'a> {
    row: OrderedRow<'a>,
    column: &'a SortedColumn,
    feasible: Range<usize>,
}

impl RowRun {
    /// Are these the rows from this one on?
    pub(in crate::screen) fn is_at(&self, row: u64) -> bool {
        self.first == Some(row)
    }

    /// Begins with these rows, all of which may have feasible designs. What their chains read and their worst values are still to come.
    pub(in crate::screen) fn begin(&mut self, plan: &Plan, ordered: &OrderedRows, rows: &Range<u64>) {
        let count = (rows.end - rows.start) as usize;
        self.first = Some(rows.start);
        self.may_hold.clear();
        self.may_hold.resize(count, true);
        self.others.resize(count * ordered.reads.len(), 0.0);
        self.worst.resize(count * plan.tracked.len(), 0.0);
    }

    /// What the chains read of each row, given the numbers of its operations.
    pub(in crate::screen) fn set_others<'n>(&mut self, ordered: &OrderedRows, number: impl Fn(Node) -> ColumnValue<'n>) {
        let reads = ordered.reads.len();
        for (place, &node) in ordered.reads.iter().enumerate() {
            let column = number(node);
            self.others.iter_mut().skip(place).step_by(reads).enumerate().for_each(|(row, other)| *other = column.at(row));
        }
    }

    /// Drops the rows whose number does not hold.
    pub(in crate::screen) fn keep(&mut self, number: ColumnValue<'_>, holds: impl Fn(f64) -> bool) {
        match number {
            ColumnValue::One(number) if holds(number) => {}
            ColumnValue::One(_) => self.may_hold.fill(false),
            ColumnValue::Each(numbers) => self.may_hold.iter_mut().zip(numbers).for_each(|(may_hold, &number)| *may_hold &= holds(number)),
        }
    }

    /// Drops the rows that `judge` finds to be out; of the others it writes the worst values.
    pub(in crate::screen) fn keep_rows(&mut self, tracked: usize, mut judge: impl FnMut(usize, &mut [f64]) -> bool) {
        for (place, may_hold) in self.may_hold.iter_mut().enumerate().filter(|(_, may_hold)| **may_hold) {
            *may_hold = judge(place, &mut self.worst[place * tracked..][..tracked]);
        }
    }

    /// Judges rows that were begun, as long as their sorted columns are there and the order is sure; returns how many.
    pub(in crate::screen) fn judge(
        &self,
        plan: &Plan,
        ordered: &OrderedRows,
        blocks: &[FastBlock],
        rows: Range<u64>,
        (room, reduction, reducers): (&mut OrderedNumbers, &Reduction, &mut Reducers),
    ) -> u64 {
        let (mut column, column_step) = ordered.column_of(plan, rows.start);
        let mut row_index = plan.slow.source_index(rows.start);
        let index_step = plan.slow.source_index(rows.end - 1).saturating_sub(row_index) / (rows.end - 1 - rows.start).max(1);
        let (reads, tracked) = (ordered.reads.len(), plan.tracked.len());
        let first = (rows.start - self.first.unwrap_or(rows.start)) as usize;
        let mut narrowed = Vec::with_capacity((rows.end - rows.start) as usize);
        let mut judged = 0;
        for place in first..first + (rows.end - rows.start) as usize {
            if self.may_hold[place] {
                let Some(column) = ordered.made(column) else { break };
                let (others, row_worst) = (&self.others[place * reads..][..reads], &self.worst[place * tracked..][..tracked]);
                let row = OrderedRow { plan, blocks, row_index, row_worst, others };
                if !row.is_sure(ordered, column) {
                    break;
                }
                narrowed.push(NarrowedRow { row, column, feasible: 0..column.values.len() });
            }
            (column, row_index, judged) = (column + column_step, row_index + index_step, judged + 1);
        }
        // Each step is made for all rows before the next one: their numbers lie far apart in memory, and the processor fetches those of
        // several rows at a time.
        let mut cuts = Vec::with_capacity(narrowed.len());
        for (chain, bounds) in ordered.bounds() {
            cuts.clear();
            cuts.extend(narrowed.iter().map(|it| it.row.cut(chain, it.column, bounds)));
            for (NarrowedRow { row, column, feasible }, &cut) in narrowed.iter_mut().zip(&cuts) {
                row.narrow(chain, column, feasible, cut, bounds);
            }
        }
        for NarrowedRow { row, column, feasible } in narrowed {
            row.take_in(ordered, column, feasible, room, reduction, reducers);
        }
        judged
    }
}
