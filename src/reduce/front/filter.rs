//! The cheap first comparison, which drops nearly every design.

use super::rays::Rays;
use super::{MOST_OBJECTIVES, Points};
use crate::reduce::Dominance;
use crate::reduce::dominance::beats;
use multiversion::multiversion;
use std::cmp::Ordering;
use std::sync::OnceLock;

/// Bins of the two-objective table.
const BINS: usize = 8192;
/// So many designs of a block are not compared with each other.
const FEW_LEFT: usize = 6;
/// Points from which on a table of cells pays.
const FEW_POINTS: usize = 32;

/// Points that tell which coordinate has the fewest levels.
const TELLING_POINTS: usize = 256;

/// What a front compares with first.
#[derive(Debug)]
pub(super) enum Filter {
    /// No front yet, or no objectives.
    Nothing,
    /// One objective: the best value.
    Best(f64),
    /// Two objectives.
    Table(BinTable<BINS>),
    /// More: a table where one serves, recent dominators, then all points.
    Dominators { cells: Option<CellTable>, recent: Vec<(Vec<f64>, u64)>, next: usize, all: Dominance },
}

impl Filter {
    /// Leaves those of the feasible designs in `alive` that are not known to be beaten. `keys` has a column per objective.
    pub(super) fn keep(&self, feasible: &[u64], keys: &[&[f64]], alive: &mut [u64]) {
        if let Self::Table(table) = self {
            return keep_unbeaten(table, feasible, keys[0], keys[1], alive);
        }
        alive.copy_from_slice(feasible);
        match self {
            Self::Best(best) => {
                for (alive, key) in alive.iter_mut().zip(keys[0]) {
                    *alive &= if key <= best { u64::MAX } else { 0 };
                }
            }
            Self::Dominators { cells, recent, .. } => {
                if let Some(cells) = cells {
                    drop_beaten(cells, keys, alive);
                }
                if drop_beaten_by_block(keys, alive) {
                    recent.iter().for_each(|(dominator, _)| drop_dominated(alive, dominator, keys));
                }
            }
            Self::Nothing | Self::Table(_) => {}
        }
    }
}

/// For every bin of the first coordinate, the best second coordinate of the points in bins strictly below: those points are
/// strictly better in the first, so that value or more is surely beaten.
#[derive(Debug)]
pub(super) struct BinTable<const BINS: usize> {
    low: f64,
    scale: f64,
    best: Box<[f64; BINS]>,
    /// What it says of rays, once one is asked about.
    rays: OnceLock<Rays<BINS>>,
}

impl<const BINS: usize> BinTable<BINS> {
    /// For points with these coordinates, one at least.
    pub(super) fn new(keys: impl Iterator<Item = [f64; 2]> + Clone) -> Self {
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        let (low, high) = keys.clone().fold(ends, |(low, high), [first, _]| (low.min(first), high.max(first)));
        let scale = if high > low { (BINS - 2) as f64 / (high - low) } else { 0.0 };
        let scale = if scale.is_finite() { scale } else { 0.0 };
        let mut table = Self { low, scale, best: Box::new([f64::INFINITY; BINS]), rays: OnceLock::new() };
        // One bin tells nothing, and how far a coordinate is from the least one may be no number.
        if table.scale == 0.0 {
            return table;
        }
        for [first, second] in keys {
            let next = table.bin(first) + 1;
            if next < BINS {
                table.best[next] = table.best[next].min(second);
            }
        }
        for bin in 1..BINS {
            table.best[bin] = table.best[bin].min(table.best[bin - 1]);
        }
        table
    }

    /// The least first coordinate of the front, and bins per coordinate: a coordinate belongs to the bin nearest to
    /// `(coordinate - low) * scale + 1`.
    pub(super) fn line(&self) -> (f64, f64) {
        (self.low, self.scale)
    }

    /// The second coordinate from which on what is in a bin is surely beaten.
    pub(super) fn best(&self, bin: usize) -> f64 {
        self.best[bin]
    }

    /// Is what has these coordinates, or more, surely beaten?
    pub(super) fn beats(&self, first: f64, second: f64) -> bool {
        second >= self.best[self.bin(first)]
    }

    /// Is what has these coordinates, or more, and at least this index, superfluous beside one of the points that the table was made of?
    /// They are sorted by the first coordinate, the second falls.
    #[inline]
    pub(super) fn beats_from(&self, points: &Points, lower: [f64; 2], least_index: u64) -> bool {
        // Nearly always the table knows.
        if self.beats(lower[0], lower[1]) {
            return true;
        }
        let beyond = points.not_beyond(lower[0], 2);
        beyond > 0 && beats(points.key(beyond - 1, 2), points.indices[beyond - 1], &lower, least_index)
    }

    /// Calls `each` with ranges of a number y between two ends outside of which designs are surely beaten whose two coordinates are these
    /// factors times y, but for rounding and what steps `cut` off. One of the factors must be above zero, the other below; y is at least zero.
    /// False if the table does not tell.
    pub(super) fn open_on_ray(&self, factors: (f64, f64), ends: (f64, f64), cut: (f64, f64), each: impl FnMut(f64, f64)) -> bool {
        let (is_steep, is_opposed) = (factors.0 < 0.0, factors.0 * factors.1 < 0.0);
        if !is_opposed {
            return false;
        }
        let rays = self.rays.get_or_init(|| Rays::new(self, is_steep, cut));
        if !rays.is_for(is_steep) {
            return false;
        }
        rays.open(factors, ends, each);
        true
    }

    #[inline(always)]
    fn bin(&self, key: f64) -> usize {
        bin(key, self.low, self.scale, BINS)
    }
}

/// A monotone function of the coordinate: all that a table relies on. What lies below the front's range shares bin 0 with nothing, what
/// lies above shares the last bin with its end.
#[inline(always)]
fn bin(key: f64, low: f64, scale: f64, bins: usize) -> usize {
    let place = (key - low) * scale + 1.0;
    let place = if place > 0.0 { place } else { 0.0 };
    let place = if place < (bins - 1) as f64 { place } else { (bins - 1) as f64 };
    // Adding 2^52 leaves the rounded number in the low bits: one addition where a conversion would not vectorise.
    ((place + (1u64 << 52) as f64).to_bits() & (bins as u64 - 1)) as usize
}

/// The same for three and four objectives: bins of all coordinates but one, and the best of that one among the points whose bins are
/// strictly below in all others.
#[derive(Debug)]
pub(super) struct CellTable {
    /// The coordinate that has no bins: that of the fewest levels, as equal coordinates share a bin, in which nothing is strictly below.
    value: usize,
    /// Of every other coordinate: which one it is, and the least number and the bins per unit.
    lines: Vec<(usize, f64, f64)>,
    /// Bins of a coordinate, as a power of two.
    bits: u32,
    /// NaN, beside which nothing is beaten, where there is no such point.
    best: Vec<f64>,
}

impl CellTable {
    /// For the points of a front; `None` where comparing with each is as good.
    pub(super) fn new(points: &Points, objectives: usize) -> Option<Self> {
        let bits = match objectives {
            3 => 7,
            4 => 5,
            _ => return None,
        };
        if points.len() < FEW_POINTS {
            return None;
        }
        let coordinates = |objective: usize| points.keys.iter().skip(objective).step_by(objectives).copied();
        // Where some points have hundreds of levels, it matters little how many all of them have.
        let apart = points.len().div_ceil(TELLING_POINTS);
        let levels = |&objective: &usize| {
            let mut all: Vec<f64> = coordinates(objective).step_by(apart).collect();
            all.sort_unstable_by(f64::total_cmp);
            all.dedup();
            all.len()
        };
        let value = (0..objectives).min_by_key(levels)?;
        let bins = 1_usize << bits;
        let line = |objective: usize| {
            let ends = coordinates(objective).fold((f64::INFINITY, f64::NEG_INFINITY), |ends, it| (ends.0.min(it), ends.1.max(it)));
            let scale = (bins - 2) as f64 / (ends.1 - ends.0);
            (objective, ends.0, if scale.is_finite() { scale } else { 0.0 })
        };
        let lines: Vec<_> = (0..objectives).filter(|&it| it != value).map(line).collect();
        if lines.iter().any(|line| line.2 == 0.0) {
            return None;
        }
        let mut table = Self { value, bits, best: vec![f64::NAN; 1 << (bits as usize * lines.len())], lines };
        for key in points.keys.chunks(objectives) {
            let places = table.lines.iter().map(|&(objective, low, scale)| bin(key[objective], low, scale, bins) + 1);
            // What lies in a last bin is strictly below nothing.
            if let Some(cell) = places.into_iter().try_fold(0, |cell, place| (place < bins).then_some((cell << bits) | place)) {
                table.best[cell] = table.best[cell].min(key[value]);
            }
        }
        for line in 0..table.lines.len() {
            let step = 1 << (bits as usize * line);
            for cells in table.best.chunks_mut(step * bins) {
                for first in (step..cells.len()).step_by(step) {
                    let (before, own) = cells.split_at_mut(first);
                    let better = |(own, before): (&mut f64, &f64)| *own = own.min(*before);
                    own.iter_mut().zip(&before[first - step..]).for_each(better);
                }
            }
        }
        Some(table)
    }

    /// Is what has these coordinates, or more, surely beaten?
    pub(super) fn beats(&self, lower: &[f64]) -> bool {
        let place = |&(objective, low, scale): &(usize, f64, f64)| bin(lower[objective], low, scale, 1 << self.bits);
        let cell = self.lines.iter().fold(0, |cell, line| (cell << self.bits) | place(line));
        self.best[cell] <= lower[self.value]
    }
}

/// Drops what the table knows to be beaten.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn drop_beaten(table: &CellTable, keys: &[&[f64]], alive: &mut [u64]) {
    const CHUNK: usize = 64;
    let bins = 1 << table.bits;
    for start in (0..alive.len()).step_by(CHUNK) {
        let end = alive.len().min(start + CHUNK);
        let alive = &mut alive[start..end];
        let mut cells = [0; CHUNK];
        for &(objective, low, scale) in &table.lines {
            for (cell, &key) in cells.iter_mut().zip(&keys[objective][start..end]) {
                *cell = (*cell << table.bits) | bin(key, low, scale, bins);
            }
        }
        let mut best = [0.0; CHUNK];
        for (best, &cell) in best[..alive.len()].iter_mut().zip(&cells) {
            *best = table.best[cell];
        }
        for ((alive, &key), &best) in alive.iter_mut().zip(&keys[table.value][start..end]).zip(&best) {
            *alive = if best <= key { 0 } else { *alive };
        }
    }
}

/// Drops what the designs of a block that are the best in one coordinate strictly dominate. In a row some coordinates are often all the same,
/// so that no table tells its designs apart, and all of them would wait to be sorted. False if few are left.
fn drop_beaten_by_block(keys: &[&[f64]], alive: &mut [u64]) -> bool {
    let are_many = |alive: &[u64]| alive.iter().filter(|&&it| it != 0).count() > FEW_LEFT;
    for objective in 0..keys.len() {
        if !are_many(alive) {
            return false;
        }
        // Of equal ones the best in the next coordinate.
        let order = |&a: &usize, &b: &usize| {
            let each = (0..keys.len()).map(|it| keys[(objective + it) % keys.len()]).map(|keys| keys[a].total_cmp(&keys[b]));
            each.into_iter().find(|it| it.is_ne()).unwrap_or(Ordering::Equal)
        };
        let Some(best) = (0..alive.len()).filter(|&lane| alive[lane] != 0).min_by(order) else { return false };
        let mut key = [0.0; MOST_OBJECTIVES];
        key.iter_mut().zip(keys).for_each(|(key, keys)| *key = keys[best]);
        drop_dominated(alive, &key[..keys.len()], keys);
    }
    are_many(alive)
}

/// Keeps, of the feasible designs, those that the table does not know to be beaten.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn keep_unbeaten(table: &BinTable<BINS>, feasible: &[u64], first: &[f64], second: &[f64], alive: &mut [u64]) {
    // Bins, then look-ups, then comparisons: the first and last vectorise, and nothing branches.
    const CHUNK: usize = 64;
    let mut bins = [0; CHUNK];
    let mut best = [0.0; CHUNK];
    for start in (0..feasible.len()).step_by(CHUNK) {
        let end = feasible.len().min(start + CHUNK);
        for (bin, &key) in bins.iter_mut().zip(&first[start..end]) {
            *bin = table.bin(key);
        }
        for (best, &bin) in best[..end - start].iter_mut().zip(&bins) {
            *best = table.best[bin & (BINS - 1)];
        }
        for (((alive, &feasible), &key), &best) in
            alive[start..end].iter_mut().zip(&feasible[start..end]).zip(&second[start..end]).zip(&best)
        {
            *alive = if key < best { feasible } else { 0 };
        }
    }
}

/// Drops what `dominator` strictly dominates.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn drop_dominated(alive: &mut [u64], dominator: &[f64], keys: &[&[f64]]) {
    const CHUNK: usize = 64;
    for first in (0..alive.len()).step_by(CHUNK) {
        let alive = &mut alive[first..];
        let count = alive.len().min(CHUNK);
        let (mut no_better, mut worse) = ([u64::MAX; CHUNK], [0u64; CHUNK]);
        for (&dominator, keys) in dominator.iter().zip(keys) {
            let keys = &keys[first..first + count];
            for ((no_better, worse), &key) in no_better.iter_mut().zip(&mut worse).zip(keys) {
                *no_better &= if dominator <= key { u64::MAX } else { 0 };
                *worse |= if dominator < key { u64::MAX } else { 0 };
            }
        }
        for ((alive, no_better), worse) in alive.iter_mut().zip(no_better).zip(worse) {
            *alive &= !(no_better & worse);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::mix;

    #[test]
    fn what_a_table_of_cells_says_is_beaten_is_and_nearly_all_that_is_far_behind_is_told() {
        for objectives in [3, 4] {
            // On and behind a plane, the last coordinate on few levels as a number of bands is.
            let point = |seed: u64, behind: f64| -> Vec<f64> {
                let mut key: Vec<f64> = (0..objectives).map(|d| (mix(seed * 8 + d) % 1000) as f64 / 250.0).collect();
                let sum: f64 = key.iter().sum();
                key.iter_mut().for_each(|it| *it += 2.0 - sum / objectives as f64 + behind);
                key.last_mut().into_iter().for_each(|it| *it = it.ceil());
                key
            };
            let mut points = Points::default();
            (0..500).for_each(|seed| points.push(point(seed, 0.0), seed));
            let table = CellTable::new(&points, objectives as usize).expect("there are many points");
            assert_eq!(table.value, objectives as usize - 1);
            let is_beaten = |key: &[f64]| points.keys.chunks(objectives as usize).any(|it| beats(it, 1, key, 0));
            let (mut told, mut beaten) = (0, 0);
            for seed in 1000..3000 {
                let key = point(seed, 0.8);
                let mut alive = [u64::MAX];
                drop_beaten(&table, &key.iter().map(std::slice::from_ref).collect::<Vec<_>>(), &mut alive);
                assert_eq!(table.beats(&key), alive == [0]);
                assert!(alive != [0] || is_beaten(&key), "{key:?}");
                told += u32::from(alive == [0]);
                beaten += u32::from(is_beaten(&key));
            }
            assert!(beaten > 1500 && 10 * told > 8 * beaten, "{objectives} objectives: {told} of {beaten}");
            // A point of the table is never beaten by it, nor what is no number.
            assert!(points.keys.chunks(objectives as usize).all(|it| !table.beats(it) || is_beaten(it)));
            assert!(!table.beats(&vec![f64::NAN; objectives as usize]));
        }
    }

    #[test]
    fn a_table_over_more_than_a_number_holds_tells_nothing() {
        for (keys, beaten_by_none) in
            [([[1e308, 5.0], [f64::INFINITY, 3.0]], [9e307, 4.0]), ([[-1.5e308, 5.0], [1.5e308, 3.0]], [-1.6e308, 4.0])]
        {
            assert!(!BinTable::<BINS>::new(keys.into_iter()).beats(beaten_by_none[0], beaten_by_none[1]));
            let mut points = Points::default();
            (0..FEW_POINTS).for_each(|number| points.push([keys[number % 2][0], number as f64, 0.0], number as u64));
            assert!(CellTable::new(&points, 3).is_none());
        }
    }

    #[test]
    fn of_a_row_with_equal_coordinates_only_the_best_are_left() {
        let equal = [3.0; 200];
        let each: Vec<f64> = (0..200).map(|lane| f64::from((lane * 37) % 101)).collect();
        for keys in [[&equal[..], &equal, &each], [&each, &equal, &equal], [&equal, &each, &equal]] {
            let mut alive = vec![u64::MAX; 200];
            alive[0] = 0;
            assert!(!drop_beaten_by_block(&keys, &mut alive));
            let left: Vec<usize> = (0..200).filter(|&lane| alive[lane] != 0).collect();
            // Lane 0 is infeasible; the next with a remainder of 0 is 101. Lanes that tie are told apart by their index later.
            assert_eq!(left, [101]);
        }
        // Where no one is beaten, all stay.
        let (up, down): (Vec<f64>, Vec<f64>) = (0..200).map(|lane| (f64::from(lane), f64::from(200 - lane))).unzip();
        let mut alive = vec![u64::MAX; 200];
        assert!(drop_beaten_by_block(&[&up, &down, &equal], &mut alive));
        assert_eq!(alive, [u64::MAX; 200]);
    }
}
