//! The feasible designs of a row in their order, as reducers take them in.

use super::chain::RowChain;
use super::column::SortedColumn;
use super::{OrderedRow, OrderedRows};
use crate::plan::Source;
use crate::screen::Block;
use multiversion::multiversion;
use std::ops::Range;

/// If fewer than one in so many lanes are counted, these are visited one by one; else all lanes are compared.
const SPARSE: usize = 8;

/// Feasible designs of one row by place in the order of the number that they differ by: each output rises or falls all the way.
#[derive(Debug)]
pub struct SortedRow<'a> {
    row: &'a OrderedRow<'a>,
    rows: &'a OrderedRows,
    column: &'a SortedColumn,
    /// Their places in the column, one at least.
    places: Range<usize>,
    room: &'a mut SortedValues,
}

/// Adds one to the count of every number from `low` to `high`.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn count_between(numbers: &[f64], low: f64, high: f64, counts: &mut [u64]) {
    for (count, &number) in counts.iter_mut().zip(numbers) {
        *count += u64::from(low <= number && number <= high);
    }
}

/// The designs of a [`SortedRow`] with the values of a tracked quantity.
#[derive(Debug)]
pub struct SortedDesigns<'a> {
    row: &'a OrderedRow<'a>,
    /// By place.
    pub lanes: &'a [u16],
    /// By place.
    pub values: &'a [f64],
}

impl SortedDesigns<'_> {
    /// Design index of a lane.
    #[inline]
    pub fn index(&self, lane: u16) -> u64 {
        self.row.index(lane)
    }
}

/// Room for the values of a row; one per thread.
#[derive(Debug, Default)]
pub struct SortedValues {
    /// By tracked quantity; empty where nobody has asked for them.
    values: Vec<Vec<f64>>,
    offsets: Vec<u64>,
    alive: Vec<u64>,
}

impl<'a> SortedRow<'a> {
    /// The designs at some places of a column, one at least.
    pub(super) fn new(
        row: &'a OrderedRow<'a>,
        rows: &'a OrderedRows,
        column: &'a SortedColumn,
        places: Range<usize>,
        room: &'a mut SortedValues,
    ) -> Self {
        room.values.resize(row.plan.tracked.len(), Vec::new());
        room.values.iter_mut().for_each(Vec::clear);
        Self { row, rows, column, places, room }
    }

    /// Number of designs, at least 1.
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// Part of the design index that the row contributes.
    pub fn row_index(&self) -> u64 {
        self.row.row_index
    }

    /// Lane of each design by place: its number among all designs of the row, feasible or not.
    pub fn lanes(&self) -> &'a [u16] {
        &self.column.lanes[self.places.clone()]
    }

    /// Parts of the design index that the lanes of the row contribute, lane by lane.
    pub fn offsets(&self) -> impl Iterator<Item = u64> {
        self.row.blocks.iter().flat_map(|block| block.offsets.iter().copied())
    }

    /// Design index of a place.
    pub fn index(&self, place: usize) -> u64 {
        self.row.index(self.lanes()[place])
    }

    /// Values of a tracked quantity at the first and the last place, between which it rises or falls all the way; `None` where it has no
    /// such order.
    pub fn ends(&self, tracked: usize) -> Option<(f64, f64)> {
        match self.source(tracked) {
            Source::LaneInput(_) => None,
            Source::LaneOutput(result) => {
                let (least, largest) = self.column.ends_of(&self.places);
                let value = |number| self.rows.chains[result].value(number, self.row.others);
                Some((value(least), value(largest)))
            }
            Source::RowInput(_) | Source::RowOutput(_) => Some((self.row.row_worst[tracked], self.row.row_worst[tracked])),
        }
    }

    /// For each of some limits in turn, how many designs have a value of a tracked quantity below it. The quantity must have an order.
    pub fn count_below(&self, tracked: usize, limits: &[f64], each: impl FnMut(usize)) {
        match self.source(tracked) {
            Source::LaneOutput(result) => {
                let chain = &self.rows.chains[result];
                // A product is worked out without a look at the steps of the chain.
                match chain.multiplier(self.row.others) {
                    Some(factor) => self.count_results_below(tracked, limits, chain, |number| chain.shown(number * factor), each),
                    None => self.count_results_below(tracked, limits, chain, |number| chain.value(number, self.row.others), each),
                }
            }
            Source::RowInput(_) | Source::RowOutput(_) => {
                let value = self.row.row_worst[tracked];
                limits.iter().map(|&limit| if value < limit { self.count() } else { 0 }).for_each(each);
            }
            Source::LaneInput(_) => unreachable!("an input of the row's own axes has no order"),
        }
    }

    /// The same for a result with its chain.
    #[inline(always)]
    fn count_results_below(
        &self,
        tracked: usize,
        limits: &[f64],
        chain: &RowChain,
        value: impl Fn(f64) -> f64,
        mut each: impl FnMut(usize),
    ) {
        let (first, last) = self.ends(tracked).expect("an output has an order");
        let factor = chain.factor(self.row.others).unwrap_or(f64::NAN);
        let Range { start, end } = self.places;
        if first <= last {
            for &limit in limits {
                each(self.column.first_not(&self.places, self.column.guess(limit / factor), |number| value(number) < limit) - start);
            }
        } else {
            for &limit in limits {
                each(end - self.column.first_not(&self.places, self.column.guess(limit / factor), |number| value(number) >= limit));
            }
        }
    }

    /// Adds one to the count of every lane that has one of the designs.
    pub fn count_lanes(&self, counts: &mut [u64]) {
        if self.column.by_lane.is_empty() || self.count() * SPARSE < counts.len() {
            self.lanes().iter().for_each(|&lane| counts[usize::from(lane)] += 1);
        } else {
            // Designs of equal numbers are all feasible or all not, so the numbers at the ends tell which lanes these are.
            let (least, largest) = self.column.ends_of(&self.places);
            count_between(&self.column.by_lane, least, largest, counts);
        }
    }

    /// Values of a tracked quantity, place by place.
    pub fn values(&mut self, tracked: usize) -> &[f64] {
        self.designs(tracked).values
    }

    /// Lanes and values of a tracked quantity, place by place, with what turns a lane into a design.
    pub fn designs(&mut self, tracked: usize) -> SortedDesigns<'_> {
        if self.room.values[tracked].is_empty() {
            self.fill(tracked);
        }
        SortedDesigns { row: self.row, lanes: self.lanes(), values: &self.room.values[tracked] }
    }

    /// The same designs as a block with all that is tracked.
    pub fn as_block(&mut self) -> Block<'_> {
        for tracked in 0..self.row.plan.tracked.len() {
            self.values(tracked);
        }
        let count = self.count();
        let lanes = self.lanes();
        let SortedValues { offsets, alive, .. } = &mut *self.room;
        offsets.clear();
        offsets.extend(lanes.iter().map(|&lane| self.row.offset(lane)));
        alive.clear();
        alive.resize(count, u64::MAX);
        let SortedValues { values, offsets, alive } = &*self.room;
        Block { row_index: self.row.row_index, offsets, feasible_count: count as u64, alive, values }
    }

    fn source(&self, tracked: usize) -> Source {
        self.row.plan.tracked[tracked].1
    }

    fn fill(&mut self, tracked: usize) {
        let (others, count, source, lanes) = (self.row.others, self.count(), self.source(tracked), self.lanes());
        let numbers = &self.column.values[self.places.clone()];
        let values = &mut self.room.values[tracked];
        match source {
            Source::LaneOutput(result) => {
                let chain = &self.rows.chains[result];
                match chain.multiplier(others) {
                    Some(factor) => values.extend(numbers.iter().map(|&number| chain.shown(number * factor))),
                    None => values.extend(numbers.iter().map(|&number| chain.value(number, others))),
                }
            }
            Source::LaneInput(input) => {
                values.extend(lanes.iter().map(|&lane| self.row.input(input, lane)));
            }
            Source::RowInput(_) | Source::RowOutput(_) => values.resize(count, self.row.row_worst[tracked]),
        }
    }
}
