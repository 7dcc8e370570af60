//! A row, judged by its sorted designs.

use super::OrderedRows;
use super::chain::RowChain;
use super::column::{ColumnCut, ColumnGroup, SortedColumn};
use super::sorted_row::{SortedRow, SortedValues};
use crate::plan::{Plan, Source};
use crate::reduce::{FreeObjectives, KnownFront, MOST_OBJECTIVES, Reducers, Reduction};
use crate::screen::Block;
use crate::screen::tables::{BLOCK, FastBlock};
use std::ops::{Deref, Range};

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

    /// An input of the fast axes, in its unit.
    #[inline(always)]
    pub(super) fn input(&self, input: usize, lane: u16) -> f64 {
        let lane = usize::from(lane);
        self.blocks[lane / BLOCK].own(input)[lane % BLOCK]
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
        if !reducers.reported.is_empty() {
            reducers.reported.absorb_row(&mut SortedRow::new(self, rows, column, feasible.clone(), &mut room.sorted));
        }
        if self.plan.objectives.is_empty() {
            return;
        }
        room.values.resize(self.plan.tracked.len(), Vec::new());
        let alike = AlikeDesigns { row: self, rows, column, inputs: &[] };
        alike.keep_extremes(&feasible, room, reducers);
        let ends = column.ends_of(&feasible);
        if column.groups.is_empty() {
            alike.keep_front(feasible, ends, room, reduction, reducers.front.known(rows.free, &alike.lower(ends, reduction)));
        } else {
            for ColumnGroup { inputs, designs } in &column.groups {
                AlikeDesigns { row: self, rows, column: designs, inputs }.keep(ends, room, reduction, reducers);
            }
        }
        let OrderedNumbers { offsets, alive, values, .. } = room;
        if !offsets.is_empty() {
            alive.clear();
            alive.resize(offsets.len(), u64::MAX);
            let block = Block { row_index: self.row_index, offsets, feasible_count: offsets.len() as u64, alive, values };
            reduction.absorb_objectives(reducers, &block);
            offsets.clear();
            values.iter_mut().for_each(Vec::clear);
        }
    }
}

/// Designs of a column or of one of its groups, with what their objectives are.
#[derive(Clone, Copy)]
struct AlikeDesigns<'a> {
    row: &'a OrderedRow<'a>,
    rows: &'a OrderedRows,
    column: &'a SortedColumn,
    /// Of a group, by tracked quantity: the objectives that are inputs of the fast axes. Empty where these are not asked for.
    inputs: &'a [f64],
}

/// Keys of all objectives.
struct LowerKeys([f64; MOST_OBJECTIVES], usize);

impl Deref for LowerKeys {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.0[..self.1]
    }
}

impl AlikeDesigns<'_> {
    /// The worst value of a tracked quantity for a number of the column.
    #[inline(always)]
    fn worst_of(self, tracked: usize, number: f64) -> f64 {
        match self.row.plan.tracked[tracked].1 {
            Source::LaneOutput(result) => self.rows.chains[result].value(number, self.row.others),
            Source::LaneInput(_) => self.inputs[tracked],
            Source::RowInput(_) | Source::RowOutput(_) => self.row.row_worst[tracked],
        }
    }

    /// Hands a design over to front and extremes.
    #[inline(always)]
    fn keep_design(self, place: usize, offsets: &mut Vec<u64>, values: &mut [Vec<f64>]) {
        let lane = self.column.lanes[place];
        offsets.push(self.row.offset(lane));
        let objectives = values.iter_mut().enumerate().filter(|(tracked, _)| self.row.plan.objectives.contains(tracked));
        objectives.for_each(|(tracked, column)| {
            column.push(match self.row.plan.tracked[tracked].1 {
                Source::LaneInput(input) => self.row.input(input, lane),
                _ => self.worst_of(tracked, self.column.values[place]),
            });
        });
    }

    /// The least that the keys of designs with numbers between two can be.
    #[inline(always)]
    fn lower(self, (low, high): (f64, f64), reduction: &Reduction) -> LowerKeys {
        let mut lower = [0.0; MOST_OBJECTIVES];
        for ((rule, &tracked), lower) in reduction.rules().iter().zip(&self.row.plan.objectives).zip(&mut lower) {
            let [a, b] = [low, high].map(|number| rule.key(self.worst_of(tracked, number)));
            *lower = a.min(b);
        }
        LowerKeys(lower, reduction.rules().len())
    }

    /// Of a group: hands over designs that may be an extreme or on the front, given the ends of the feasible numbers of the whole row.
    fn keep(self, (low, high): (f64, f64), room: &mut OrderedNumbers, reduction: &Reduction, reducers: &mut Reducers) {
        let own = self.column.ends;
        let ends = (own.0.max(low), own.1.min(high));
        if ends.0 > ends.1 {
            return;
        }
        let objectives = || self.row.plan.objectives.iter().copied().enumerate();
        let mut inputs = objectives().filter(|(_, tracked)| matches!(self.row.plan.tracked[*tracked].1, Source::LaneInput(_)));
        let is_extreme = inputs.any(|(objective, tracked)| reducers.extremes.may_take(objective, self.inputs[tracked], self.row.row_index));
        let lower = self.lower(ends, reduction);
        let known = reducers.front.known(self.rows.free, &lower);
        let is_beaten = known.beats_from(&lower, self.row.row_index);
        if is_beaten && !is_extreme {
            return;
        }
        let all = 0..self.column.values.len();
        if is_extreme {
            self.keep_first(self.column.between(all.clone(), low, high), room);
        }
        if !is_beaten {
            self.keep_front(all, ends, room, reduction, known);
        }
    }

    /// Of designs that are all as extreme, hands over the one with the lowest index, which the extremes take.
    fn keep_first(self, places: Range<usize>, room: &mut OrderedNumbers) {
        if let Some(place) = places.min_by_key(|&place| self.row.offset(self.column.lanes[place])) {
            self.keep_design(place, &mut room.offsets, &mut room.values);
        }
    }

    /// Hands over the designs at places that may be an extreme of an objective that is no input of the fast axes.
    fn keep_extremes(self, places: &Range<usize>, room: &mut OrderedNumbers, reducers: &Reducers) {
        let ends = self.column.ends_of(places);
        for (objective, &tracked) in self.row.plan.objectives.iter().enumerate() {
            if matches!(self.row.plan.tracked[tracked].1, Source::LaneInput(_)) {
                continue;
            }
            for (place, number, step) in [(places.start, ends.0, 1isize), (places.end - 1, ends.1, -1)] {
                let value = self.worst_of(tracked, number);
                if reducers.extremes.may_take(objective, value, self.row.row_index) {
                    let mut end = place;
                    while places.contains(&end) && self.worst_of(tracked, self.column.values[end]) == value {
                        end = end.wrapping_add_signed(step);
                    }
                    self.keep_first(if step > 0 { place..end } else { end.wrapping_add(1)..place + 1 }, room);
                }
            }
        }
    }

    /// Hands over the designs that may be of the front, of those at places whose numbers are between two.
    #[inline(always)]
    fn keep_front(self, places: Range<usize>, ends: (f64, f64), room: &mut OrderedNumbers, reduction: &Reduction, known: KnownFront<'_>) {
        let OrderedNumbers { offsets, values, open, .. } = room;
        open.clear();
        let mut add = |low: f64, high: f64| open.push(self.column.between(places.clone(), low.max(ends.0), high.min(ends.1)));
        // If no part of the ray is open, no place is looked for. An end that is no number leaves that of all.
        if !self.ray(ends, reduction).is_some_and(|factors| known.open_on_ray(factors, ends, &mut add)) {
            add(ends.0, ends.1);
        }
        while let Some(stretch) = open.pop() {
            if stretch.is_empty() {
                continue;
            }
            let ends = (self.column.values[stretch.start], self.column.values[stretch.end - 1]);
            if known.beats_from(&self.lower(ends, reduction), self.row.row_index) {
                continue;
            }
            if stretch.len() <= FEW {
                stretch.for_each(|place| self.keep_design(place, offsets, values));
            } else {
                let middle = stretch.start + stretch.len() / 2;
                open.extend([middle..stretch.end, stretch.start..middle]);
            }
        }
    }

    /// The factors of both objectives' keys, where each is one times the number, which lies between two ends.
    #[inline]
    fn ray(self, ends: (f64, f64), reduction: &Reduction) -> Option<(f64, f64)> {
        let FreeObjectives(first, second) = self.rows.free?;
        let factor = |objective: usize| {
            let Source::LaneOutput(result) = self.row.plan.tracked[self.row.plan.objectives[objective]].1 else { return None };
            self.rows.chains[result].factor(self.row.others).map(|factor| reduction.rules()[objective].uncut(factor))
        };
        let factors = (factor(first)?, factor(second)?);
        (ends.0 >= 0.0 && factors.0.is_finite() && factors.1.is_finite()).then_some(factors)
    }
}
