//! What a front says of designs that have all objectives but two in common.
//!
//! Take the points that are no worse in the shared objectives. Among them only the other two objectives decide, so a slice is the front of
//! these points with two objectives. Objectives are shared where they are the same for a whole row or for a group of its designs.

use super::filter::{BinTable, Filter};
use super::{Front, KeyRule, MOST_OBJECTIVES, Points};
use std::collections::HashMap;

/// Bins of a slice's table: fewer than the front's, as many slices are kept.
const BINS: usize = 1024;
/// Of so few points no slice is made.
const FEW_POINTS: usize = 32;
/// A slice is made when it has been asked for so often, or once for each so many points of the front: making it is a pass over all points.
const LEAST_QUESTIONS: usize = 4;
const POINTS_PER_QUESTION: usize = 256;
/// Most slices that are kept, and most that are asked for and not made yet.
const MOST_SLICES: usize = 128;
const MOST_ASKED: usize = 4096;
/// All slices together have at most so many points, 24 bytes each, or a quarter of those of the front.
const MOST_POINTS: usize = 1 << 17;

/// Bytes of the tables of so many slices of a front, as far as they are kept at a time.
pub fn slice_bytes(objectives: usize, slices: u64) -> u64 {
    // The best of each bin, how steep a ray is there, and the largest of groups of bins.
    if objectives > 2 { slices.min(MOST_SLICES as u64) * (20 * BINS + size_of::<FrontSlice>()) as u64 } else { 0 }
}

/// The two objectives that designs may differ by which share the others.
#[derive(Clone, Copy, Debug)]
pub struct FreeObjectives(pub usize, pub usize);

/// Those points of a front that count for designs with something in common.
#[derive(Debug)]
pub struct FrontSlice {
    free: FreeObjectives,
    cut: (f64, f64),
    /// The two coordinates: sorted by the first, the second falls. A point that is better in a shared objective wins ties whatever its index,
    /// so it has index 0.
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
        // The table drops most beaten points before the sort.
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
        points.keys.shrink_to_fit();
        points.indices.shrink_to_fit();
        Self { free, cut: (rules[free.0].most_cut(), rules[free.1].most_cut()), points, table }
    }
}

/// What designs have in common, and which objectives are free.
type SliceKey = [u64; MOST_OBJECTIVES];

/// How often a slice was asked for since it was last made, and where it stands if it is.
#[derive(Debug, Default)]
struct AskedSlice {
    asked: usize,
    place: Option<usize>,
}

/// The slices that have been asked for.
#[derive(Debug, Default)]
pub(super) struct FrontSlices {
    asked: HashMap<SliceKey, AskedSlice>,
    made: Vec<(SliceKey, FrontSlice)>,
    oldest: usize,
    /// Points of all that are made.
    points: usize,
}

impl FrontSlices {
    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.asked.clear();
        self.made.clear();
        (self.oldest, self.points) = (0, 0);
    }

    /// Keeps a slice, in place of the oldest one if there are many; returns where it stands. `None` if all would have too many points.
    fn keep(&mut self, key: SliceKey, slice: FrontSlice, most_points: usize) -> Option<usize> {
        if self.points + slice.points.len() > most_points {
            // The next questions come before it is made in vain again.
            self.asked.remove(&key);
            return None;
        }
        self.points += slice.points.len();
        let place = if self.made.len() < MOST_SLICES {
            self.made.push((key, slice));
            self.made.len() - 1
        } else {
            let place = self.oldest;
            self.oldest = (self.oldest + 1) % MOST_SLICES;
            let (old, gone) = std::mem::replace(&mut self.made[place], (key, slice));
            self.points -= gone.points.len();
            self.asked.remove(&old);
            place
        };
        self.asked.insert(key, AskedSlice { asked: 0, place: Some(place) });
        Some(place)
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
    /// Points that wait may be left out.
    pub fn beats_from(self, lower: &[f64], least_index: u64) -> bool {
        match self {
            Self::Front(front) => front.beats_from(lower, least_index),
            Self::Slice(FrontSlice { free, points, table, .. }) => {
                table.as_ref().is_some_and(|table| table.beats_from(points, [lower[free.0], lower[free.1]], least_index))
            }
        }
    }

    /// Calls `each` with ranges of a number y between two ends outside of which every design whose two coordinates are these factors times y is
    /// surely beaten, rounding and steps allowed for. One of the factors must be above zero, the other below; y is at least zero. False if the
    /// front does not tell.
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
    /// The slice for designs that share all objectives but `free`, whose shared keys stand in `lower`; else the front. With two objectives it is
    /// always the front.
    pub fn known(&mut self, free: Option<FreeObjectives>, lower: &[f64]) -> KnownFront<'_> {
        match free.filter(|_| self.rules.len() > 2).and_then(|free| self.slice(free, lower)) {
            Some(place) => KnownFront::Slice(&self.slices.made[place].1),
            None => KnownFront::Front(self),
        }
    }

    /// Which slice it is, if it has been made.
    fn slice(&mut self, free: FreeObjectives, lower: &[f64]) -> Option<usize> {
        if self.points.len() < FEW_POINTS {
            return None;
        }
        // There are two objectives less in common than there may be objectives.
        let mut key = [0; MOST_OBJECTIVES];
        let common = lower.iter().enumerate().filter(|&(it, _)| it != free.0 && it != free.1);
        key.iter_mut().zip(common).for_each(|(key, (_, lower))| *key = lower.to_bits());
        (key[MOST_OBJECTIVES - 2], key[MOST_OBJECTIVES - 1]) = (free.0 as u64, free.1 as u64);
        let slices = &mut self.slices;
        if slices.asked.len() >= MOST_ASKED && !slices.asked.contains_key(&key) {
            slices.asked.retain(|_, it| it.place.is_some());
        }
        let entry = slices.asked.entry(key).or_default();
        if entry.place.is_some() {
            return entry.place;
        }
        entry.asked += 1;
        if entry.asked < LEAST_QUESTIONS.max(self.points.len() / POINTS_PER_QUESTION) {
            return None;
        }
        let made = FrontSlice::new(&self.rules, free, &self.points, lower);
        slices.keep(key, made, (self.points.len() / 4).max(MOST_POINTS))
    }
}

#[cfg(test)]
mod tests {
    use super::super::beats;
    use super::*;
    use crate::sample::mix;
    use crate::study::{Goal, Objective, OverScenarios, Quantity};

    /// A front of three objectives, the second of which has keys below zero, as one that is to be large.
    fn front(designs: u64, levels: u64) -> Front {
        let objective = |goal| Objective { quantity: Quantity::Input(0), goal, resolution: None, over: OverScenarios::Worst };
        let rules = [Goal::Min, Goal::Max, Goal::Min].map(|goal| KeyRule::from(&objective(goal)));
        let mut points = Points::default();
        for design in 0..designs {
            let [first, second, third] = [0, 1, 2].map(|d| mix(design * 4 + d));
            points.push([20.0 + (first % 200) as f64, -10.0 - (second % 150) as f64, (third % levels) as f64], design + 1);
        }
        let mut front = Front::new(&rules);
        front.merge(points);
        front
    }

    /// The slice of designs with this third objective, asked for until it is made.
    fn made(front: &mut Front, free: FreeObjectives, third: f64) -> &FrontSlice {
        let lower = [0.0, 0.0, third];
        for _ in 0..LEAST_QUESTIONS.max(front.points.len() / POINTS_PER_QUESTION) {
            front.known(Some(free), &lower);
        }
        let KnownFront::Slice(slice) = front.known(Some(free), &lower) else { panic!("it has been asked for often") };
        slice
    }

    #[test]
    fn designs_on_a_ray_that_a_slice_leaves_out_are_beaten() {
        let mut front = front(3000, 12);
        let points = front.points.clone();
        let (mut out, mut open) = (0, 0);
        for third in 0..12 {
            for free in [FreeObjectives(0, 1), FreeObjectives(1, 0)] {
                made(&mut front, free, f64::from(third));
                let known = front.known(Some(free), &[0.0, 0.0, f64::from(third)]);
                for ray in 0..8_u32 {
                    // Of the first and second objective, whichever of them is the first of the slice.
                    let (rising, falling) = (0.4 + 0.2 * f64::from(ray), -1.3 + 0.13 * f64::from(ray));
                    let factors = if free.0 == 0 { (rising, falling) } else { (falling, rising) };
                    let mut ranges: Vec<(f64, f64)> = Vec::new();
                    assert!(known.open_on_ray(factors, (0.0, 250.0), |low, high| ranges.push((low, high))), "{free:?} {third}");
                    for number in 0..500 {
                        let y = 0.5 * f64::from(number);
                        let key = [rising * y, falling * y, f64::from(third)];
                        let is_beaten = (0..points.len()).any(|it| beats(points.key(it, 3), points.indices[it], &key, u64::MAX));
                        let is_open = ranges.iter().any(|&(low, high)| (low..=high).contains(&y));
                        assert!(is_open || is_beaten, "{free:?}, {key:?}: {ranges:?}");
                        (out, open) = (out + u32::from(!is_open), open + u32::from(is_open));
                    }
                }
            }
        }
        assert!(out > 10_000 && open > 10_000, "{out} left out, {open} open");
    }

    #[test]
    fn many_slices_make_room_for_each_other_and_know_what_the_front_knows() {
        let (mut front, free) = (front(4000, 1000), FreeObjectives(0, 1));
        let count = 2 * MOST_SLICES as u64 + 7;
        for round in 0..2 {
            for third in 0..count {
                made(&mut front, free, third as f64);
                // The last one that was made, and one of those that had to go or are still there.
                for asked in [third, mix(third + round) % count] {
                    let lower = [40.0 + (mix(asked) % 100) as f64, -40.0 - (mix(asked + 1) % 60) as f64, asked as f64];
                    let expected = front.beats_from(&lower, 9000);
                    assert_eq!(front.known(Some(free), &lower).beats_from(&lower, 9000), expected, "{lower:?}");
                }
                let slices = &front.slices;
                assert_eq!(slices.points, slices.made.iter().map(|it| it.1.points.len()).sum::<usize>());
                let is_there = |(place, made): (usize, &(SliceKey, FrontSlice))| slices.asked[&made.0].place == Some(place);
                assert!(slices.made.len() <= MOST_SLICES && slices.made.iter().enumerate().all(is_there));
                assert_eq!(slices.asked.values().filter(|it| it.place.is_some()).count(), slices.made.len());
            }
        }
        assert_eq!(front.slices.made.len(), MOST_SLICES);
    }

    #[test]
    fn slices_with_too_many_points_are_not_kept() {
        let (mut front, free) = (front(3000, 12), FreeObjectives(0, 1));
        let of_first = made(&mut front, free, 0.0).points.len();
        let rules = front.rules.clone();
        let second = || FrontSlice::new(&rules, free, &front.points, &[0.0, 0.0, 1.0]);
        let (both, key) = (of_first + second().points.len(), [7; MOST_OBJECTIVES]);
        front.slices.asked.insert(key, AskedSlice { asked: 3, place: None });
        assert_eq!(front.slices.keep(key, second(), both - 1), None);
        assert!(front.slices.points == of_first && front.slices.made.len() == 1 && !front.slices.asked.contains_key(&key));
        assert_eq!(front.slices.keep(key, second(), both), Some(1));
        assert_eq!((front.slices.points, front.slices.asked[&key].place), (both, Some(1)));
    }
}
