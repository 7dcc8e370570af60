//! The designs of the fast axes sorted by their number.

use super::OrderedRows;
use crate::screen::tables::FastBlock;
use crate::tape::{LaneList, Operation};
use std::collections::HashMap;
use std::ops::Range;

/// Places about a guess that are looked at at once.
const NEAR: usize = 8;

/// The designs of the fast axes sorted by their number.
#[derive(Debug)]
pub(in crate::screen) struct SortedColumn {
    /// The numbers, the least first, and the designs that have them.
    pub(super) values: Vec<f64>,
    pub(super) lanes: Vec<u16>,
    /// The number of every lane, NaN if its inputs break a constraint. Empty unless designs are counted lane by lane.
    pub(super) by_lane: Vec<f64>,
    /// How many numbers are below the lower edge of each of as many even steps from the least to the largest, and at last all of them;
    /// steps per number.
    below: Vec<u16>,
    scale: f64,
    /// The least and the largest number.
    pub(super) ends: (f64, f64),
    /// How many numbers equal the least one, and how many are below the largest: a formula with a limit makes many of them equal.
    plateaus: (usize, usize),
    /// The same designs, grouped by the inputs that are objectives; empty if there are none.
    pub(super) groups: Vec<ColumnGroup>,
}

/// The designs of a sorted column that have the same of all inputs of the fast axes that are objectives.
#[derive(Debug)]
pub(super) struct ColumnGroup {
    /// These inputs by tracked quantity; zero where that is something else.
    pub(super) inputs: Vec<f64>,
    pub(super) designs: SortedColumn,
}

/// Designs of a column that is not sorted yet: their numbers and their lanes.
type Members = Vec<(f64, u16)>;

/// What two bounds cut off a sorted column: about where what is left starts and ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct ColumnCut {
    rises: bool,
    start: u32,
    end: u32,
}

impl ColumnCut {
    /// In place of a start or an end: nothing is cut off there.
    const NOTHING: u32 = u32::MAX;
}

impl SortedColumn {
    /// The column of a row whose list has these numbers, without the designs whose inputs break a constraint; `None` if one of its own is not
    /// finite.
    pub(in crate::screen) fn new(rows: &OrderedRows, list: &LaneList, blocks: &[FastBlock], numbers: &[f64]) -> Option<Self> {
        let mut slots = numbers.to_vec();
        let mut members = Members::new();
        let (mut groups, mut group_of): (Vec<(Vec<f64>, Members)>, _) = (Vec::new(), HashMap::new());
        let mut by_lane = Vec::new();
        for block in blocks {
            for lane in 0..block.count {
                let lane_number = by_lane.len() as u16;
                by_lane.push(f64::NAN);
                if !rows.input_bounds.iter().all(|&(input, (low, high))| (low..=high).contains(&block.own(input)[lane])) {
                    continue;
                }
                for &node in &rows.below {
                    match list.list().operations[node as usize] {
                        Operation::Input(input) => slots[node as usize] = block.si(input.into())[lane],
                        _ => list.list().compute(node, &mut slots),
                    }
                }
                let member = (slots[rows.channel as usize], lane_number);
                by_lane[usize::from(lane_number)] = member.0;
                members.push(member);
                if rows.groups > 0 {
                    let inputs: Vec<f64> = rows.inputs.iter().map(|input| input.map_or(0.0, |input| block.own(input)[lane])).collect();
                    let group = *group_of.entry(inputs.iter().map(|it| it.to_bits()).collect::<Vec<_>>()).or_insert(groups.len());
                    if group == groups.len() {
                        groups.push((inputs, Vec::new()));
                    }
                    groups[group].1.push(member);
                }
            }
        }
        let mut column = Self::of(members)?;
        if rows.counts_lanes {
            column.by_lane = by_lane;
        }
        let group = |(inputs, members)| Some(ColumnGroup { inputs, designs: Self::of(members)? });
        column.groups = groups.into_iter().map(group).collect::<Option<_>>()?;
        Some(column)
    }

    /// The column of these numbers and designs; `None` if one is not finite, or there are none.
    fn of(mut members: Members) -> Option<Self> {
        if !members.iter().all(|(value, _)| value.is_finite()) {
            return None;
        }
        members.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (values, lanes): (Vec<f64>, _) = members.into_iter().unzip();
        let ends = (*values.first()?, *values.last()?);
        let (least, range) = (ends.0, ends.1 - ends.0);
        let scale = if range > 0.0 { (values.len() as f64 / range).min(f64::MAX) } else { 0.0 };
        let mut below = Vec::with_capacity(values.len() + 1);
        let mut place = 0;
        for step in 0..values.len() {
            // Where all numbers are the same the edges are beyond any.
            while values.get(place).is_some_and(|&value| value < least + step as f64 / scale) {
                place += 1;
            }
            below.push(place as u16);
        }
        below.push(values.len() as u16);
        let plateaus = (values.partition_point(|&value| value <= ends.0), values.partition_point(|&value| value < ends.1));
        Some(Self { values, lanes, by_lane: Vec::new(), below, scale, ends, plateaus, groups: Vec::new() })
    }

    /// About how many numbers are below this one, if it is neither below all of them nor beyond; else some place.
    #[inline(always)]
    pub(super) fn guess(&self, value: f64) -> usize {
        let steps = ((value - self.ends.0) * self.scale).clamp(0.0, (self.below.len() - 2) as f64);
        let step = steps as usize;
        let [before, after] = [self.below[step], self.below[step + 1]].map(i32::from);
        // Within a step they are taken to be spread evenly.
        let guess = (before + ((steps - step as f64) * f64::from(after - before)) as i32) as usize;
        guess.max(self.plateaus.0).min(self.plateaus.1)
    }

    /// The first place of a range whose number is no longer `before` something, given about where that is; the end if all are.
    #[inline(always)]
    pub(super) fn first_not(&self, range: &Range<usize>, guess: usize, before: impl Fn(f64) -> bool) -> usize {
        // Nearly always it is among a few next to the guess. They are compared without a branch, so that the processor can fetch the numbers
        // of the next rows at the same time.
        if range.len() >= NEAR {
            let start = guess.saturating_sub(NEAR / 2).max(range.start).min(range.end - NEAR);
            let count = self.values[start..][..NEAR].iter().map(|&value| usize::from(before(value))).sum::<usize>();
            if (count > 0 || start == range.start) && (count < NEAR || start + NEAR == range.end) {
                return start + count;
            }
        }
        turn(range, guess, |place| before(self.values[place]))
    }

    /// What two bounds cut off where results rise or fall all the way between those of the least and the largest number. `number` tells
    /// about which number has a result, NaN where that is not known.
    #[inline(always)]
    pub(super) fn cut(&self, (first, last): (f64, f64), (low, high): (f64, f64), number: impl Fn(f64) -> f64) -> ColumnCut {
        let guess = |is_needed: bool, bound: f64| if is_needed { self.guess(number(bound)) as u32 } else { ColumnCut::NOTHING };
        // Up to where they are on the one side, and from where on the other.
        if first <= last {
            ColumnCut { rises: true, start: guess(first < low, low), end: guess(last > high, high) }
        } else {
            ColumnCut { rises: false, start: guess(first > high, high), end: guess(last < low, low) }
        }
    }

    /// Leaves of a range of places those whose results are between two bounds, given what these cut off.
    #[inline(always)]
    pub(super) fn narrow(&self, places: &mut Range<usize>, cut: ColumnCut, (low, high): (f64, f64), result: impl Fn(f64) -> f64) {
        let ColumnCut { rises, start, end } = cut;
        if start == ColumnCut::NOTHING && end == ColumnCut::NOTHING {
            return;
        }
        let start = match (start, rises) {
            (ColumnCut::NOTHING, _) => places.start,
            (guess, true) => self.first_not(places, guess as usize, |it| result(it) < low),
            (guess, false) => self.first_not(places, guess as usize, |it| result(it) > high),
        };
        let end = match (end, rises) {
            (ColumnCut::NOTHING, _) => places.end,
            (guess, true) => self.first_not(places, guess as usize, |it| result(it) <= high),
            (guess, false) => self.first_not(places, guess as usize, |it| result(it) >= low),
        };
        *places = start..end.max(start);
    }

    /// The least and the largest number at some places.
    #[inline]
    pub(super) fn ends_of(&self, places: &Range<usize>) -> (f64, f64) {
        let least = if places.start == 0 { self.ends.0 } else { self.values[places.start] };
        (least, if places.end == self.values.len() { self.ends.1 } else { self.values[places.end - 1] })
    }

    /// The places within a range whose numbers are between two.
    pub(super) fn between(&self, range: Range<usize>, low: f64, high: f64) -> Range<usize> {
        let first = self.first_not(&range, self.guess(low), |it| it < low);
        first..self.first_not(&(first..range.end), self.guess(high), |it| it <= high)
    }
}

/// The first place of a range from which on `before` no longer holds, the end if it holds all the way; found soon if the guess is good.
fn turn(range: &Range<usize>, guess: usize, before: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (range.start, range.end);
    let guess = guess.clamp(low, high);
    let mut step = 1;
    if guess < high && before(guess) {
        low = guess + 1;
        while low + step <= high {
            let next = low + step - 1;
            if !before(next) {
                high = next;
                break;
            }
            (low, step) = (next + 1, 2 * step);
        }
    } else {
        high = guess;
        while low < high {
            let next = high.saturating_sub(step).max(low);
            if before(next) {
                low = next + 1;
                break;
            }
            (high, step) = (next, 2 * step);
        }
    }
    while low < high {
        let middle = low + (high - low) / 2;
        if before(middle) { low = middle + 1 } else { high = middle }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(values: impl Iterator<Item = f64>) -> SortedColumn {
        SortedColumn::of(values.enumerate().map(|(lane, value)| (value, lane as u16)).collect()).expect("it is of that kind")
    }

    #[test]
    fn a_place_is_found_from_any_guess() {
        // With stretches of equal numbers shorter and longer than those that are looked at at once.
        let column = column((0..60).map(|place| f64::from(place * place / 97 + if place > 40 { 3 } else { 0 })));
        for bound in -1..45 {
            let bound = f64::from(bound);
            for (start, end) in [(0, 60), (2, 57), (13, 20), (30, 30), (0, 8), (52, 60)] {
                let below = column.values[start..end].iter().filter(|value| **value < bound).count();
                for guess in 0..62 {
                    assert_eq!(column.first_not(&(start..end), guess, |it| it < bound), start + below, "{bound} from {guess}");
                }
            }
        }
    }

    #[test]
    fn a_guess_is_near_where_numbers_are_spread_unevenly() {
        // Bands of every number from 4 to 14 whose tension first rises and then falls with their thickness.
        // The thickest have none left.
        let tension = |place: u32| f64::from(place / 174 + 4) * (f64::from(place % 174) * (120.0 - f64::from(place % 174))).max(0.0);
        let column = column((0..11 * 174).map(tension));
        let numbers = (1..2000).map(|step| column.ends.0 + (column.ends.1 - column.ends.0) * (f64::from(step) / 1999.0).powi(4));
        let far = numbers.filter(|&number| {
            let below = column.values.partition_point(|&value| value < number);
            column.guess(number).abs_diff(below) >= NEAR / 2
        });
        assert!(far.count() < 40);
        // What is no number of the column's range has a guess too.
        let last = column.values.len();
        assert!([f64::NAN, f64::NEG_INFINITY, f64::INFINITY, -1e300].iter().all(|&number| column.guess(number) <= last));
    }

    #[test]
    fn numbers_that_are_not_finite_have_no_order() {
        assert!(SortedColumn::of(vec![(1.0, 0), (f64::NAN, 1)]).is_none());
        assert!(SortedColumn::of(Vec::new()).is_none());
        // Equal numbers have one.
        assert_eq!(column([2.0; 30].into_iter()).between(0..30, 2.0, 2.0), 0..30);
    }
}
