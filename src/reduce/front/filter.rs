//! The cheap first comparison, which drops nearly every design.

use super::Points;
use crate::reduce::Dominance;
use multiversion::multiversion;

/// Bins of the two-objective table.
pub(super) const BINS: usize = 8192;

/// What a front compares with first.
#[derive(Debug)]
pub(super) enum Filter {
    /// No front yet, or no objectives.
    Nothing,
    /// One objective: the best value.
    Best(f64),
    /// Two objectives.
    Table(BinTable),
    /// More: recent dominators, then all points.
    Dominators { recent: Vec<(Vec<f64>, u64)>, next: usize, all: Dominance },
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
            Self::Dominators { recent, .. } => recent.iter().for_each(|(dominator, _)| drop_dominated(alive, dominator, keys)),
            Self::Nothing | Self::Table(_) => {}
        }
    }
}

/// For every bin of the first coordinate, the best second coordinate of the points in bins strictly below: those points are
/// strictly better in the first, so that value or more is surely beaten.
#[derive(Debug)]
pub(super) struct BinTable {
    low: f64,
    scale: f64,
    best: Box<[f64; BINS]>,
}

impl BinTable {
    pub(super) fn new(points: &Points) -> Self {
        let (low, high) = (points.keys[0], points.keys[2 * (points.len() - 1)]);
        let scale = if high > low { (BINS - 2) as f64 / (high - low) } else { 0.0 };
        let mut table = Self { low, scale: if scale.is_finite() { scale } else { 0.0 }, best: Box::new([f64::INFINITY; BINS]) };
        for key in points.keys.chunks(2) {
            let next = table.bin(key[0]) + 1;
            if next < BINS {
                table.best[next] = table.best[next].min(key[1]);
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

    /// A monotone function of the coordinate: all that the table relies on. What lies below the front's range shares bin 0
    /// with nothing, what lies above shares the last bin with its end.
    #[inline(always)]
    fn bin(&self, key: f64) -> usize {
        let place = (key - self.low) * self.scale + 1.0;
        let place = if place > 0.0 { place } else { 0.0 };
        let place = if place < (BINS - 1) as f64 { place } else { (BINS - 1) as f64 };
        // Adding 2^52 leaves the rounded number in the low bits: one addition where a conversion would not vectorise.
        ((place + (1u64 << 52) as f64).to_bits() & (BINS as u64 - 1)) as usize
    }
}

/// Keeps, of the feasible designs, those that the table does not know to be beaten.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn keep_unbeaten(table: &BinTable, feasible: &[u64], first: &[f64], second: &[f64], alive: &mut [u64]) {
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
