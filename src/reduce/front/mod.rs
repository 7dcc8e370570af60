//! The Pareto front: feasible designs that no other one makes superfluous.
//!
//! Designs stream in by the billion, so most must be dropped at the cost of a comparison or two: against a table for two to four
//! objectives, against the points that dropped the last ones for more. What passes is checked against the front so far, what
//! passes that waits in a list, and from time to time the list is merged into the front. The result does not depend on the
//! order of arrival: it is the set of designs that no other one beats, and "beats" is a strict order.

mod filter;
mod rays;
mod slice;
mod together;

pub use crate::keys::{KeyRule, Points};
pub use slice::{FreeObjectives, KnownFront, slice_bytes};
pub use together::together;

use super::dominance::{Dominance, beats};
use crate::screen::Block;
use filter::{BinTable, CellTable, Filter};
use slice::FrontSlices;

/// Most objectives that a study may have.
pub const MOST_OBJECTIVES: usize = 6;
/// Bytes that a front may take while it is looked for, where nobody says otherwise: far beyond any budget, and less than it takes to
/// bring a machine down.
pub const FRONT_BYTES: u64 = 4 << 30;
/// Copies of a front that a sweep holds at a time: its own with what compares with it, that of a checkpoint, those that threads know.
const COPIES: u64 = 6;
/// Recent dominators that are remembered.
const DOMINATORS: usize = 8;
/// Least number of waiting designs before they are merged.
const WAITING: usize = 2048;
/// Points of a front from which on merging is so dear that what waits is compared with too. Tests have small fronts.
const LARGE: usize = if cfg!(test) { 100 } else { 4 * WAITING };

/// The most points of a front with that many objectives which fit into that many bytes.
pub fn most_points(objectives: usize, bytes: u64) -> u64 {
    bytes / (COPIES * 8 * (objectives as u64 + 1))
}

/// The front of the designs seen so far.
#[derive(Debug)]
pub struct Front {
    rules: Vec<KeyRule>,
    /// Non-dominated points, sorted by coordinates, then index.
    points: Points,
    /// Which of them did not come with [`Front::seeded`].
    fresh: Vec<bool>,
    waiting: Points,
    filter: Filter,
    slices: FrontSlices,
    /// Room for the coordinates of a block, one column per objective.
    keys: Vec<Vec<f64>>,
    alive: Vec<u64>,
}

impl Front {
    /// An empty front under these objectives.
    pub fn new(rules: &[KeyRule]) -> Self {
        Self::seeded(rules, Points::default())
    }

    /// A front that starts with known points, non-dominated and sorted as another front keeps them.
    pub fn seeded(rules: &[KeyRule], points: Points) -> Self {
        let mut front = Self {
            rules: rules.to_vec(),
            fresh: vec![false; points.len()],
            points,
            waiting: Points::default(),
            filter: Filter::Nothing,
            slices: FrontSlices::default(),
            keys: vec![Vec::new(); rules.len()],
            alive: Vec::new(),
        };
        front.refresh_filter();
        front
    }

    /// Takes in a block; `objectives` are the positions of the objectives among its values.
    pub fn absorb(&mut self, block: &Block<'_>, objectives: &[usize]) {
        if self.rules.is_empty() {
            return;
        }
        // Taken out while it is lent to the comparisons below.
        let mut scratch = std::mem::take(&mut self.keys);
        let mut keys: [&[f64]; MOST_OBJECTIVES] = [&[]; MOST_OBJECTIVES];
        for (((key, scratch), rule), &column) in keys.iter_mut().zip(&mut scratch).zip(&self.rules).zip(objectives) {
            *key = rule.keys(block.column(column), scratch);
        }
        let keys = &keys[..self.rules.len()];
        self.alive.resize(block.count(), 0);
        self.filter.keep(block.alive, keys, &mut self.alive);
        for first in (0..block.count()).step_by(8) {
            let last = block.count().min(first + 8);
            if self.alive[first..last].iter().fold(0, |any, alive| any | alive) == 0 {
                continue;
            }
            for lane in first..last {
                if self.alive[lane] != 0 {
                    self.consider(keys, lane, block.index(lane));
                }
            }
        }
        self.keys = scratch;
        if self.waiting.len() >= WAITING.max(self.points.len() / 2) {
            self.merge_waiting();
        }
    }

    /// Lets a design that passed the filter wait, unless the front beats it.
    fn consider(&mut self, keys: &[&[f64]], lane: usize, index: u64) {
        let dimensions = self.rules.len();
        let mut key = [0.0; MOST_OBJECTIVES];
        for (key, keys) in key.iter_mut().zip(keys) {
            // Zero has one sign.
            *key = keys[lane] + 0.0;
        }
        let key = &key[..dimensions];
        match &mut self.filter {
            Filter::Nothing => {}
            Filter::Best(_) | Filter::Table(_) => {
                // Sorted by the first coordinate with the second falling: the last point not beyond it is the best candidate.
                let beyond = self.points.not_beyond(key[0], dimensions);
                if beyond > 0 && beats(self.points.key(beyond - 1, dimensions), self.points.indices[beyond - 1], key, index) {
                    return;
                }
            }
            Filter::Dominators { recent, next, all, .. } => {
                if let Some((dominator, dominator_index)) = all.dominator(key, index) {
                    let dominator = (dominator.to_vec(), dominator_index);
                    if recent.len() < DOMINATORS {
                        recent.push(dominator);
                    } else {
                        recent[*next % DOMINATORS] = dominator;
                    }
                    *next += 1;
                    return;
                }
                // Neighbours come soon, and are often beaten by this one.
                if self.points.len() >= LARGE {
                    all.insert(key, index);
                }
            }
        }
        self.waiting.push(key.iter().copied(), index);
    }

    /// Is a design whose coordinates are at least these surely beaten by a point so far?
    pub fn beats(&self, lower: &[f64]) -> bool {
        let dimensions = self.rules.len();
        match &self.filter {
            Filter::Nothing => false,
            Filter::Best(best) => *best < lower[0],
            Filter::Table(_) => {
                let beyond = self.points.not_beyond(lower[0], dimensions);
                beyond > 0 && beats(self.points.key(beyond - 1, dimensions), u64::MAX, lower, 0)
            }
            Filter::Dominators { cells, all, .. } => {
                cells.as_ref().is_some_and(|cells| cells.beats(lower)) || all.dominator(lower, 0).is_some()
            }
        }
    }

    /// Is every design whose coordinates are at least these, and whose index is at least this, surely superfluous beside a point so far?
    /// Points that wait may be left out.
    pub fn beats_from(&self, lower: &[f64], least_index: u64) -> bool {
        let dimensions = self.rules.len();
        match &self.filter {
            Filter::Nothing => false,
            Filter::Table(table) => table.beats_from(&self.points, [lower[0], lower[1]], least_index),
            Filter::Best(_) => {
                let beyond = self.points.not_beyond(lower[0], dimensions);
                beyond > 0 && beats(self.points.key(beyond - 1, dimensions), self.points.indices[beyond - 1], lower, least_index)
            }
            Filter::Dominators { cells, all, .. } => {
                cells.as_ref().is_some_and(|cells| cells.beats(lower)) || all.dominator(lower, least_index).is_some()
            }
        }
    }

    /// Takes in points of another front.
    pub fn merge(&mut self, other: Points) {
        let dimensions = self.rules.len();
        for point in 0..other.len() {
            let (key, index) = (other.key(point, dimensions), other.indices[point]);
            if !self.beats_from(key, index) {
                self.waiting.push(key.iter().copied(), index);
            }
        }
        self.merge_waiting();
    }

    /// The points of the front, sorted by coordinates, then index.
    pub fn points(&mut self) -> &Points {
        self.merge_waiting();
        &self.points
    }

    /// The points that did not come with the seed.
    pub fn into_fresh(mut self) -> Points {
        self.sort_waiting_in();
        let dimensions = self.rules.len();
        let mut fresh = Points::default();
        for point in (0..self.points.len()).filter(|&point| self.fresh[point]) {
            fresh.push(self.points.key(point, dimensions).iter().copied(), self.points.indices[point]);
        }
        fresh
    }

    /// Number of points, those that wait not counted.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Has it no points yet?
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Sorts what waits into the front and drops what is beaten. The front beats nothing that waits: each was checked when it came.
    fn merge_waiting(&mut self) {
        if !self.waiting.is_empty() {
            self.sort_waiting_in();
            self.refresh_filter();
        }
    }

    /// The same without [`Front::refresh_filter`]: no design can be compared with the front after it.
    fn sort_waiting_in(&mut self) {
        if self.waiting.is_empty() {
            return;
        }
        let dimensions = self.rules.len();
        // It is out of date, and its memory is needed now.
        self.filter = Filter::Nothing;
        let waiting = std::mem::take(&mut self.waiting);
        let mut all = std::mem::take(&mut self.points);
        let known = all.len();
        self.fresh.resize(all.len() + waiting.len(), true);
        all.keys.extend(waiting.keys);
        all.indices.extend(waiting.indices);
        let mut order: Vec<usize> = (0..all.len()).collect();
        // A stable sort takes the points, sorted already, as one run.
        order.sort_by(|&a, &b| {
            let first = all.keys[a * dimensions].total_cmp(&all.keys[b * dimensions]);
            if first.is_ne() {
                return first;
            }
            let keys = all.key(a, dimensions).iter().zip(all.key(b, dimensions));
            let by_key = keys.map(|(a, b)| a.total_cmp(b)).find(|ordering| ordering.is_ne());
            // A design that came back with a seed is the same point twice: the known one first, the other is dropped.
            by_key.unwrap_or_else(|| all.indices[a].cmp(&all.indices[b]).then(self.fresh[a].cmp(&self.fresh[b])))
        });
        // In this order a point can only be beaten by an earlier one, and only by one of those that waited.
        let mut new = Dominance::new(dimensions);
        let mut best_second = f64::INFINITY;
        let mut fresh = Vec::new();
        let mut last = None;
        for point in order {
            let (key, index) = (all.key(point, dimensions), all.indices[point]);
            let beaten = last == Some(index)
                || match dimensions {
                    1 => !self.points.is_empty(),
                    2 => key[1] >= best_second,
                    _ => new.dominator(key, index).is_some(),
                };
            last = Some(index);
            if !beaten {
                match dimensions {
                    1 => {}
                    2 => best_second = key[1],
                    _ if point < known => {}
                    _ => new.insert(key, index),
                }
                self.points.push(key.iter().copied(), index);
                fresh.push(self.fresh[point]);
            }
        }
        self.fresh = fresh;
    }

    fn refresh_filter(&mut self) {
        self.slices.clear();
        self.filter = match (self.points.is_empty(), self.rules.len()) {
            (true, _) | (_, 0) => Filter::Nothing,
            (_, 1) => Filter::Best(self.points.keys[0]),
            (_, 2) => Filter::Table(BinTable::new(self.points.keys.as_chunks().0.iter().copied())),
            (_, objectives) => Filter::Dominators {
                cells: CellTable::new(&self.points, objectives),
                recent: Vec::new(),
                next: 0,
                all: Dominance::of(objectives, &self.points.keys, &self.points.indices),
            },
        };
    }
}

#[cfg(test)]
mod tests;
