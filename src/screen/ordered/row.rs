//! A row, judged by its sorted designs.

use super::OrderedRows;
use super::chain::RowChain;
use super::column::{ColumnCut, SortedColumn};
use super::sorted_row::{SortedRow, SortedValues};
use crate::plan::{Plan, Source};
use crate::reduce::{KeyRule, Reducers, Reduction};
use crate::screen::Block;
use crate::screen::tables::{BLOCK, FastBlock};
use std::ops::Range;

/// A stretch of so few designs is looked at one by one.
const FEW: usize = 4;

/// Room for a thread.
#[derive(Debug, Default)]
pub(in crate::screen) struct OrderedNumbers {
    offsets: Vec<u64>,
    alive: Vec<u64>,
    values: Vec<Vec<f64>>,
    open: Vec<Range<usize>>,
    sorted: SortedValues,
}

/// A whole row, to be judged at once.
#[derive(Debug)]
pub(in crate::screen) struct OrderedRow<'a> {
    pub(in crate::screen) plan: &'a Plan,
    pub(in crate::screen) blocks: &'a [FastBlock],
    /// The row's part of the design index.
    pub(in crate::screen) row_index: u64,
    /// Worst values that are the same for the whole row, by tracked quantity.
    pub(in crate::screen) row_worst: &'a [f64],
    /// What the chains read of the row: [`OrderedRows::others`].
    pub(in crate::screen) others: &'a [f64],
}

impl OrderedRow<'_> {
    /// Part of the design index that a lane contributes.
    #[inline(always)]
    pub(super) fn offset(&self, lane: u16) -> u64 {
        let lane = usize::from(lane);
        self.blocks[lane / BLOCK].offsets[lane % BLOCK]
    }

    /// Design index of a lane.
    #[inline(always)]
    pub(super) fn index(&self, lane: u16) -> u64 {
        self.row_index + self.offset(lane)
    }

    /// Do the results of all chains rise or fall all the way along a sorted column?
    #[inline(always)]
    pub(super) fn is_sure(&self, rows: &OrderedRows, column: &SortedColumn) -> bool {
        rows.chains.iter().all(|chain| chain.ends(column.ends, self.others).is_some())
    }

    /// What the bounds of a chain cut off a sorted column.
    #[inline(always)]
    pub(super) fn cut(&self, chain: &RowChain, column: &SortedColumn, bounds: (f64, f64)) -> ColumnCut {
        let [a, b] = [column.ends.0, column.ends.1].map(|number| chain.value(number, self.others));
        let factor = chain.factor(self.others).unwrap_or(f64::NAN);
        column.cut((a, b), bounds, |bound| bound / factor)
    }

    /// Leaves of a range of places in a sorted column those whose results are between the bounds of a chain.
    #[inline(always)]
    pub(super) fn narrow(&self, chain: &RowChain, column: &SortedColumn, places: &mut Range<usize>, cut: ColumnCut, bounds: (f64, f64)) {
        // A product needs no look at the steps of the chain.
        match chain.multiplier(self.others) {
            Some(factor) => column.narrow(places, cut, bounds, |number| chain.shown(number * factor)),
            None => column.narrow(places, cut, bounds, |number| chain.value(number, self.others)),
        }
    }

    /// Judges the row for reducers; false if it is not sure of the order.
    pub(in crate::screen) fn judge(
        &self,
        rows: &OrderedRows,
        column: &SortedColumn,
        room: &mut OrderedNumbers,
        reduction: &Reduction,
        reducers: &mut Reducers,
    ) -> bool {
        if !self.is_sure(rows, column) {
            return false;
        }
        let mut feasible = 0..column.values.len();
        for (chain, bounds) in rows.bounds() {
            self.narrow(chain, column, &mut feasible, self.cut(chain, column, bounds), bounds);
        }
        self.take_in(rows, column, feasible, room, reduction, reducers);
        true
    }

    /// Takes in feasible designs: counts them, hands them to what the report asks for, and to front and extremes those that these may need.
    pub(super) fn take_in(
        &self,
        rows: &OrderedRows,
        column: &SortedColumn,
        feasible: Range<usize>,
        room: &mut OrderedNumbers,
        reduction: &Reduction,
        reducers: &mut Reducers,
    ) {
        if feasible.is_empty() {
            return;
        }
        reducers.feasible += feasible.len() as u64;
        let values = &column.values;
        let worst_of = |tracked: usize, number: f64| match self.plan.tracked[tracked].1 {
            Source::LaneOutput(result) => rows.chains[result].value(number, self.others),
            _ => self.row_worst[tracked],
        };
        let worst_at = |tracked: usize, place: usize| worst_of(tracked, values[place]);
        let ends = column.ends_of(&feasible);
        let OrderedNumbers { offsets, alive, values: columns, open, sorted } = room;
        if !reducers.reported.is_empty() {
            reducers.reported.absorb_row(&mut SortedRow::new(self, rows, column, feasible.clone(), sorted));
        }
        if self.plan.objectives.is_empty() {
            return;
        }
        columns.resize(self.plan.tracked.len(), Vec::new());
        let mut keep = |place: usize| {
            offsets.push(self.offset(column.lanes[place]));
            let objectives = columns.iter_mut().enumerate().filter(|(tracked, _)| self.plan.objectives.contains(tracked));
            objectives.for_each(|(tracked, column)| column.push(worst_at(tracked, place)));
        };
        for (objective, &tracked) in self.plan.objectives.iter().enumerate() {
            for (place, number, step) in [(feasible.start, ends.0, 1isize), (feasible.end - 1, ends.1, -1)] {
                let value = worst_of(tracked, number);
                if reducers.extremes.may_take(objective, value, self.row_index) {
                    // All that have the same value: which of them has the lowest index is seen later.
                    let mut at = place;
                    while feasible.contains(&at) && worst_at(tracked, at) == value {
                        keep(at);
                        at = at.wrapping_add_signed(step);
                    }
                }
            }
        }
        open.clear();
        match self.ray(rows, ends, reduction) {
            Some(factors) => {
                let mut add = |low, high| open.push(column.between(feasible.clone(), low, high));
                let on_ray = reducers.front.open_on_ray(factors, ends, &mut add);
                if !on_ray {
                    open.push(feasible);
                }
            }
            None => open.push(feasible),
        }
        let mut lower = [0.0; crate::reduce::MOST_OBJECTIVES];
        while let Some(stretch) = open.pop() {
            if stretch.is_empty() {
                continue;
            }
            for ((rule, &tracked), lower) in reduction.rules().iter().zip(&self.plan.objectives).zip(&mut lower) {
                let [a, b] = [stretch.start, stretch.end - 1].map(|place| rule.key(worst_at(tracked, place)));
                *lower = a.min(b);
            }
            if reducers.front.beats_from(&lower[..reduction.rules().len()], self.row_index) {
                continue;
            }
            if stretch.len() <= FEW {
                stretch.for_each(&mut keep);
            } else {
                let middle = stretch.start + stretch.len() / 2;
                open.extend([middle..stretch.end, stretch.start..middle]);
            }
        }
        if !offsets.is_empty() {
            alive.clear();
            alive.resize(offsets.len(), u64::MAX);
            let block = Block { row_index: self.row_index, offsets, feasible_count: offsets.len() as u64, alive, values: columns };
            reduction.absorb_objectives(reducers, &block);
            offsets.clear();
            columns.iter_mut().for_each(Vec::clear);
        }
    }

    /// The factors of both objectives' keys, where each is one times the number, which lies between two ends.
    #[inline]
    fn ray(&self, rows: &OrderedRows, ends: (f64, f64), reduction: &Reduction) -> Option<(f64, f64)> {
        let [first, second] = self.plan.objectives[..] else { return None };
        let factor = |tracked: usize, rule: &KeyRule| {
            let Source::LaneOutput(result) = self.plan.tracked[tracked].1 else { return None };
            rows.chains[result].factor(self.others).filter(|_| !rule.has_steps()).map(|factor| rule.key(factor))
        };
        let factors = (factor(first, &reduction.rules()[0])?, factor(second, &reduction.rules()[1])?);
        (ends.0 >= 0.0 && factors.0.is_finite() && factors.1.is_finite()).then_some(factors)
    }
}
