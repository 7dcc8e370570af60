//! What a front says of designs that have all objectives but two in common.
//!
//! Such a design is beaten by a point that is no worse in what they have in common and in the two others. So of the points that are no worse
//! in the first it compares with those that no other of them beats in the two, as if there were these two objectives only. What designs have
//! in common is an input or an output that is the same for a whole row, or for a group of its designs.

use super::filter::{BinTable, Filter};
use super::{Front, KeyRule, MOST_OBJECTIVES, Points};
use std::collections::HashMap;

/// Bins of a slice: many of them are in use at a time.
const BINS: usize = 1024;
/// Of so few points no slice is made.
const FEW_POINTS: usize = 32;
/// A slice is made when it has been asked for once for each so many points: to make it takes a look at all of them.
const POINTS_PER_QUESTION: usize = 256;
/// Most slices that are kept, and their points where the front has no more itself.
const MOST_SLICES: usize = 128;
const MOST_POINTS: usize = 1 << 14;

/// Bytes of the tables of so many slices of a front, as far as they are kept at a time.
pub fn slice_bytes(objectives: usize, slices: u64) -> u64 {
    // The best of each bin, and how steep a ray is there.
    if objectives > 2 { slices.min(MOST_SLICES as u64) * (2 * 8 * BINS + size_of::<FrontSlice>()) as u64 } else { 0 }
}

/// The two objectives that designs with something in common differ by.
#[derive(Clone, Copy, Debug)]
pub struct FreeObjectives(pub usize, pub usize);

/// Those points of a front that count for designs with something in common.
#[derive(Debug)]
pub struct FrontSlice {
    free: FreeObjectives,
    cut: (f64, f64),
    /// The two coordinates: sorted by the first, the second falls. A point that is better in what is common beats whatever it is no worse than:
    /// it has index 0.
    points: Points,
    /// None where there are no points.
    table: Option<BinTable<BINS>>,
}

impl FrontSlice {
    fn new(rules: &[KeyRule], free: FreeObjectives, points: &Points, lower: &[f64]) -> Self {
        let common: Vec<usize> = (0..rules.len()).filter(|&it| it != free.0 && it != free.1).collect();
        let mut counting: Vec<(f64, f64, u64)> = Vec::new();
        for (key, &index) in points.keys.chunks(rules.len()).zip(&points.indices) {
            if common.iter().all(|&it| key[it] <= lower[it]) {
                let is_better = common.iter().any(|&it| key[it] < lower[it]);
                counting.push((key[free.0], key[free.1], if is_better { 0 } else { index }));
            }
        }
        let table = (!counting.is_empty()).then(|| BinTable::new(counting.iter().map(|it| [it.0, it.1])));
        // The table knows most of those that others beat.
        counting.retain(|&(first, second, _)| table.as_ref().is_some_and(|table| !table.beats(first, second)));
        counting.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let mut best = f64::INFINITY;
        let mut points = Points::default();
        for (first, second, index) in counting {
            if second < best {
                points.push([first, second], index);
                best = second;
            }
        }
        Self { free, cut: (rules[free.0].most_cut(), rules[free.1].most_cut()), points, table }
    }
}

/// The slices that have been asked for, by what designs have in common.
#[derive(Debug, Default)]
pub(super) struct FrontSlices {
    numbers: HashMap<[u64; MOST_OBJECTIVES], usize>,
    /// How often each was asked for, until it is made.
    asked: Vec<(usize, Option<FrontSlice>)>,
    /// Points of all that are made.
    points: usize,
}

impl FrontSlices {
    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.numbers.clear();
        self.asked.clear();
        self.points = 0;
    }

    /// Which one it is of designs with this in common.
    fn number(&mut self, common: [u64; MOST_OBJECTIVES]) -> usize {
        if let Some(&number) = self.numbers.get(&common) {
            return number;
        }
        if self.asked.len() == MOST_SLICES {
            self.clear();
        }
        self.numbers.insert(common, self.asked.len());
        self.asked.push((0, None));
        self.asked.len() - 1
    }
}

/// What designs of a row are compared with.
#[derive(Clone, Copy, Debug)]
pub enum KnownFront<'a> {
    /// The whole front.
    Front(&'a Front),
    /// What counts of it for designs that have all objectives but two in common.
    Slice(&'a FrontSlice),
}

impl KnownFront<'_> {
    /// Is every design whose coordinates are at least these, and whose index is at least this, surely superfluous beside a point so far?
    /// Points that wait are not asked.
    pub fn beats_from(self, lower: &[f64], least_index: u64) -> bool {
        match self {
            Self::Front(front) => front.beats_from(lower, least_index),
            Self::Slice(FrontSlice { free, points, table, .. }) => {
                table.as_ref().is_some_and(|table| table.beats_from(points, [lower[free.0], lower[free.1]], least_index))
            }
        }
    }

    /// Calls `each` with ranges of a number y between two ends outside of which designs whose two coordinates are these factors times y, but
    /// for rounding and what steps cut off, are surely beaten. One of the factors must be above zero, the other below; y is at least zero.
    /// False if the front does not tell.
    pub fn open_on_ray(self, factors: (f64, f64), ends: (f64, f64), each: impl FnMut(f64, f64)) -> bool {
        match self {
            Self::Front(front) => {
                let Filter::Table(table) = &front.filter else { return false };
                table.open_on_ray(factors, ends, (front.rules[0].most_cut(), front.rules[1].most_cut()), each)
            }
            Self::Slice(FrontSlice { table, cut, .. }) => table.as_ref().is_some_and(|table| table.open_on_ray(factors, ends, *cut, each)),
        }
    }
}

impl Front {
    /// What designs are compared with that differ by two objectives only, where that is so; `lower` has what they have in common. With two
    /// objectives that is the whole front.
    pub fn known(&mut self, free: Option<FreeObjectives>, lower: &[f64]) -> KnownFront<'_> {
        match free.filter(|_| self.rules.len() > 2).and_then(|free| self.slice(free, lower)) {
            Some(number) => self.slices.asked[number].1.as_ref().map_or(KnownFront::Front(self), KnownFront::Slice),
            None => KnownFront::Front(self),
        }
    }

    /// Which slice it is, if it has been made.
    fn slice(&mut self, free: FreeObjectives, lower: &[f64]) -> Option<usize> {
        if self.points.len() < FEW_POINTS {
            return None;
        }
        let mut key = [0; MOST_OBJECTIVES];
        let common = lower.iter().enumerate().filter(|&(it, _)| it != free.0 && it != free.1);
        key.iter_mut().zip(common).for_each(|(key, (_, lower))| *key = lower.to_bits());
        let mut number = self.slices.number(key);
        let (count, slice) = &mut self.slices.asked[number];
        *count += 1;
        if slice.is_none() {
            if *count * POINTS_PER_QUESTION < self.points.len() {
                return None;
            }
            let made = FrontSlice::new(&self.rules, free, &self.points, lower);
            // One front more at most, however much its slices have in common.
            if self.slices.points + made.points.len() > self.points.len().max(MOST_POINTS) {
                self.slices.clear();
                number = self.slices.number(key);
            }
            self.slices.points += made.points.len();
            self.slices.asked[number].1 = Some(made);
        }
        Some(number)
    }
}
