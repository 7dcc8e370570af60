//! Judging whole rows whose designs stand in one order.

use super::CpuEngine;
use super::row::{holds, judge_row_values};
use crate::reduce::{Reducers, Reduction};
use crate::screen::ordered::{OrderedRow, SortedColumn};
use crate::tape::ColumnValue;
use std::ops::Range;

impl CpuEngine<'_> {
    /// Judges the designs at `positions` for reducers; returns what [`CpuEngine::screen`] does. Whole rows whose designs stand in one order
    /// are judged at once.
    pub fn screen_for(&mut self, positions: Range<u64>, reduction: &Reduction, reducers: &mut Reducers) -> u64 {
        let width = self.plan.fast.count();
        let (first, last) = (positions.start.next_multiple_of(width), positions.end / width * width);
        if self.tables.ordered.is_none() || first >= last {
            return self.screen(positions, |block| reduction.absorb(reducers, block));
        }
        let mut position = self.screen(positions.start..first, |block| reduction.absorb(reducers, block));
        if position == first {
            position = self.screen_whole_rows(first / width..last / width, reduction, reducers);
            reducers.reported.end_rows();
        }
        if position < last {
            return position;
        }
        self.screen(last..positions.end, |block| reduction.absorb(reducers, block))
    }

    /// The same for whole rows, each at once where that can be done.
    fn screen_whole_rows(&mut self, rows: Range<u64>, reduction: &Reduction, reducers: &mut Reducers) -> u64 {
        let width = self.plan.fast.count();
        let mut row = rows.start;
        self.ahead = width;
        while row < rows.end && !self.stopped() {
            row += self.judge_run(row..rows.end, reduction, reducers);
            if row == rows.end || !self.enter_row(row) {
                break;
            }
            if !self.judge_ordered(reduction, reducers) {
                let judged = self.screen(row * width..(row + 1) * width, |block| reduction.absorb(reducers, block));
                if judged < (row + 1) * width {
                    return judged;
                }
            }
            row += 1;
        }
        row * width
    }

    /// Judges the current row at once; false if that cannot be done.
    fn judge_ordered(&mut self, reduction: &Reduction, reducers: &mut Reducers) -> bool {
        let (Some(ordered), Some(list)) = (&self.tables.ordered, &self.tables.lanes) else { return false };
        let Some((numbers, _)) = &self.numbers else { return false };
        if !self.row_feasible {
            return true;
        }
        let (blocks, numbers) = (&self.tables.blocks, numbers.row());
        let (column, _) = ordered.column_of(self.plan, self.row.expect("the row has been entered"));
        let sorted = || SortedColumn::new(ordered, list, blocks, numbers);
        let Some(column) = ordered.column(column, sorted) else { return false };
        let others: Vec<f64> = ordered.others(|node| numbers[node as usize]).collect();
        let row = OrderedRow { plan: self.plan, blocks, row_index: self.row_index, row_worst: &self.row_worst, others: &others };
        row.judge(ordered, column, &mut self.ordered_numbers, reduction, reducers)
    }

    /// Judges the first of some rows without entering them one by one, as far as what they read stands in the same columns as that of the
    /// row entered last. Returns how many: none where the rows are not of that kind.
    fn judge_run(&mut self, rows: Range<u64>, reduction: &Reduction, reducers: &mut Reducers) -> u64 {
        let (Some(list), Some(numbers)) = (&self.tables.rows, &self.row_numbers) else { return 0 };
        let Some(ordered) = self.tables.ordered.as_ref().filter(|_| list.has_rows() && numbers.holds(list, rows.start)) else { return 0 };
        let of_column = list.rows_beside(rows.start);
        if !self.row_run.is_at(of_column.start) {
            self.enter_run(of_column.clone());
        }
        let rows = rows.start..rows.end.min(of_column.end);
        let (plan, blocks) = (self.plan, &self.tables.blocks);
        let judged = self.row_run.judge(plan, ordered, blocks, rows.clone(), (&mut self.ordered_numbers, reduction, reducers));
        if judged > 0 {
            self.last_row = Some(rows.start + judged - 1);
        }
        judged
    }

    /// Enters all rows of a column, whose numbers are there.
    fn enter_run(&mut self, rows: Range<u64>) {
        let plan = self.plan;
        let (Some(list), Some(numbers), Some(ordered)) = (&self.tables.rows, &self.row_numbers, &self.tables.ordered) else { return };
        let (Some(lanes), Some((lane_numbers, _))) = (&self.tables.lanes, &self.numbers) else { return };
        self.row_run.begin(plan, ordered, &rows);
        self.row_run.set_others(ordered, |node| match numbers.lane_column(list, node) {
            Some(column) if lanes.scalars().contains(&node) => column,
            // Constants.
            _ => ColumnValue::One(lane_numbers.row()[node as usize]),
        });
        numbers.conditions(list, |condition, margins| self.row_run.keep(margins, |margin| holds(plan, condition, margin)));
        let mut sources = plan.constraints.iter().chain(plan.tracked.iter().map(|(_, source)| source));
        if !sources.any(|source| source.is_row()) {
            return;
        }
        let mut own = self.own.clone();
        let (mut margins, mut outputs) = (self.row_margins.clone(), self.row_outputs.clone());
        self.row_run.keep_rows(plan.tracked.len(), |place, worst| {
            plan.slow.set(rows.start + place as u64, &mut own);
            worst.iter_mut().zip(&plan.tracked).for_each(|(worst, (tracked, _))| *worst = tracked.worse.least_bad());
            numbers.recall_at(list, place, &mut margins, &mut outputs);
            judge_row_values(plan, &own, &margins, &outputs, worst)
        });
    }
}
