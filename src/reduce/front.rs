//! The Pareto front: feasible designs that no other one makes superfluous.
//!
//! Designs stream in by the billion, so most must be dropped at the cost of a comparison or two: against a table for two
//! objectives, against the points that dropped the last ones for more. What passes is checked against the front so far, what
//! passes that waits in a list, and from time to time the list is merged into the front. The result does not depend on the
//! order of arrival: it is the set of designs that no other one beats, and "beats" is a strict order.

use super::dominance::{Dominance, beats};
use crate::screen::Block;
use crate::study::{Goal, Objective};
use multiversion::multiversion;
use serde::{Deserialize, Serialize};

/// Bins of the two-objective table.
const BINS: usize = 8192;
/// Points against which every design is compared first, for three objectives and more.
const KILLERS: usize = 8;
/// Least number of waiting designs before they are merged.
const WAITING: usize = 2048;

/// What an objective becomes for the comparison: less is better, steps of the resolution count as one value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeyRule {
    goal: Goal,
    resolution: Option<f64>,
}

impl From<&Objective> for KeyRule {
    fn from(objective: &Objective) -> Self {
        Self { goal: objective.goal, resolution: objective.resolution }
    }
}

impl KeyRule {
    /// The number that is compared. Zero has one sign, so that equal values are equal bits.
    #[inline(always)]
    pub fn key(&self, value: f64) -> f64 {
        let step = match self.resolution {
            Some(resolution) => (value / resolution).floor(),
            None => value,
        };
        (if self.goal == Goal::Min { step } else { -step }) + 0.0
    }

    /// The keys of a column of values.
    fn keys(self, values: &[f64], keys: &mut [f64]) {
        match (self.resolution, self.goal) {
            (Some(_), _) => keys.iter_mut().zip(values).for_each(|(key, &value)| *key = self.key(value)),
            (None, Goal::Min) => signed(values, 1.0, keys),
            (None, Goal::Max) => signed(values, -1.0, keys),
        }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn signed(values: &[f64], sign: f64, keys: &mut [f64]) {
    for (key, &value) in keys.iter_mut().zip(values) {
        *key = sign * value + 0.0;
    }
}

/// Designs of a front with what they are compared by: coordinates point after point, less is better.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Points {
    /// Coordinates.
    pub keys: Vec<f64>,
    /// Design indices.
    pub indices: Vec<u64>,
}

impl Points {
    /// Number of points.
    pub fn len(&self) -> usize {
        self.indices.len()
    }

    /// Are there none?
    pub fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }

    fn key(&self, point: usize, dimensions: usize) -> &[f64] {
        &self.keys[point * dimensions..][..dimensions]
    }

    /// Number of leading points whose first coordinate is at most `first`; the points must be sorted by it.
    fn not_beyond(&self, first: f64, dimensions: usize) -> usize {
        let (mut low, mut high) = (0, self.len());
        while low < high {
            let middle = (low + high) / 2;
            if self.keys[middle * dimensions] <= first { low = middle + 1 } else { high = middle }
        }
        low
    }

    fn push(&mut self, key: impl IntoIterator<Item = f64>, index: u64) {
        self.keys.extend(key);
        self.indices.push(index);
    }
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
    /// Coordinates of the block being absorbed, one column per objective.
    keys: Vec<Vec<f64>>,
    alive: Vec<u64>,
}

/// The cheap first comparison.
#[derive(Debug)]
enum Filter {
    /// No front yet, or no objectives.
    Nothing,
    /// One objective: the best value.
    Best(f64),
    /// Two objectives.
    Table(Table),
    /// More: recent killers, then all points.
    Killers { recent: Vec<(Vec<f64>, u64)>, next: usize, all: Dominance },
}

/// For every bin of the first coordinate, the best second coordinate of the points in bins strictly below: those points are
/// strictly better in the first, so that value or more is surely beaten.
#[derive(Debug)]
struct Table {
    low: f64,
    scale: f64,
    best: Box<[f64; BINS]>,
}

impl Table {
    fn new(points: &Points) -> Self {
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
fn keep_unbeaten(table: &Table, feasible: &[u64], first: &[f64], second: &[f64], alive: &mut [u64]) {
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

/// Drops what `killer` strictly dominates.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn drop_dominated(alive: &mut [u64], killer: &[f64], keys: &[Vec<f64>]) {
    const CHUNK: usize = 64;
    for first in (0..alive.len()).step_by(CHUNK) {
        let alive = &mut alive[first..];
        let count = alive.len().min(CHUNK);
        let (mut no_better, mut worse) = ([u64::MAX; CHUNK], [0u64; CHUNK]);
        for (&killer, keys) in killer.iter().zip(keys) {
            let keys = &keys[first..first + count];
            for ((no_better, worse), &key) in no_better.iter_mut().zip(&mut worse).zip(keys) {
                *no_better &= if killer <= key { u64::MAX } else { 0 };
                *worse |= if killer < key { u64::MAX } else { 0 };
            }
        }
        for ((alive, no_better), worse) in alive.iter_mut().zip(no_better).zip(worse) {
            *alive &= !(no_better & worse);
        }
    }
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
        for ((keys, rule), &column) in self.keys.iter_mut().zip(&self.rules).zip(objectives) {
            keys.resize(block.count(), 0.0);
            rule.keys(block.column(column), keys);
        }
        self.alive.resize(block.count(), 0);
        if !matches!(self.filter, Filter::Table(_)) {
            self.alive.copy_from_slice(block.alive);
        }
        match &self.filter {
            Filter::Nothing => {}
            Filter::Best(best) => {
                for (alive, key) in self.alive.iter_mut().zip(&self.keys[0]) {
                    *alive &= if key <= best { u64::MAX } else { 0 };
                }
            }
            Filter::Table(table) => keep_unbeaten(table, block.alive, &self.keys[0], &self.keys[1], &mut self.alive),
            Filter::Killers { recent, .. } => {
                for (killer, _) in recent {
                    drop_dominated(&mut self.alive, killer, &self.keys);
                }
            }
        }
        for first in (0..block.count()).step_by(8) {
            let last = block.count().min(first + 8);
            if self.alive[first..last].iter().fold(0, |any, alive| any | alive) == 0 {
                continue;
            }
            for lane in first..last {
                if self.alive[lane] != 0 {
                    self.consider(lane, block.index(lane));
                }
            }
        }
        if self.waiting.len() >= WAITING.max(self.points.len() / 2) {
            self.merge_waiting();
        }
    }

    /// Lets a design that passed the filter wait, unless the front beats it.
    fn consider(&mut self, lane: usize, index: u64) {
        let dimensions = self.rules.len();
        let mut key = [0.0; 8];
        for (key, keys) in key.iter_mut().zip(&self.keys) {
            *key = keys[lane];
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
            Filter::Killers { recent, next, all } => {
                if let Some((killer, killer_index)) = all.beater(key, index) {
                    let killer = (killer.to_vec(), killer_index);
                    if recent.len() < KILLERS {
                        recent.push(killer);
                    } else {
                        recent[*next % KILLERS] = killer;
                    }
                    *next += 1;
                    return;
                }
            }
        }
        self.waiting.push(key.iter().copied(), index);
    }

    /// Takes in points of another front.
    pub fn merge(&mut self, other: Points) {
        self.waiting.keys.extend(other.keys);
        self.waiting.indices.extend(other.indices);
        self.merge_waiting();
    }

    /// The points of the front, sorted by coordinates, then index.
    pub fn points(&mut self) -> &Points {
        self.merge_waiting();
        &self.points
    }

    /// The points that did not come with the seed.
    pub fn into_fresh(mut self) -> Points {
        self.merge_waiting();
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

    /// Sorts what waits into the front and drops what is beaten.
    fn merge_waiting(&mut self) {
        if self.waiting.is_empty() {
            return;
        }
        let dimensions = self.rules.len();
        let waiting = std::mem::take(&mut self.waiting);
        let mut all = std::mem::take(&mut self.points);
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
        // In this order a point can only be beaten by an earlier one.
        let mut kept = Dominance::new(dimensions);
        let mut best_second = f64::INFINITY;
        let mut fresh = Vec::new();
        let mut last = None;
        for point in order {
            let (key, index) = (all.key(point, dimensions), all.indices[point]);
            let beaten = last == Some(index)
                || match dimensions {
                    1 => !self.points.is_empty(),
                    2 => key[1] >= best_second,
                    _ => kept.beater(key, index).is_some(),
                };
            last = Some(index);
            if !beaten {
                match dimensions {
                    1 => {}
                    2 => best_second = key[1],
                    _ => kept.insert(key, index),
                }
                self.points.push(key.iter().copied(), index);
                fresh.push(self.fresh[point]);
            }
        }
        self.fresh = fresh;
        self.refresh_filter_with(kept);
    }

    fn refresh_filter(&mut self) {
        let mut all = Dominance::new(self.rules.len());
        if self.rules.len() > 2 {
            for (key, &index) in self.points.keys.chunks(self.rules.len()).zip(&self.points.indices) {
                all.insert(key, index);
            }
        }
        self.refresh_filter_with(all);
    }

    fn refresh_filter_with(&mut self, all: Dominance) {
        self.filter = match (self.points.is_empty(), self.rules.len()) {
            (true, _) | (_, 0) => Filter::Nothing,
            (_, 1) => Filter::Best(self.points.keys[0]),
            (_, 2) => Filter::Table(Table::new(&self.points)),
            _ => Filter::Killers { recent: Vec::new(), next: 0, all },
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::mix;
    use crate::study::Quantity;

    /// A block that owns its columns.
    struct Owned {
        row_index: u64,
        offsets: Vec<u64>,
        alive: Vec<u64>,
        values: Vec<Vec<f64>>,
    }

    impl Owned {
        fn block(&self) -> Block<'_> {
            Block { row_index: self.row_index, offsets: &self.offsets, alive: &self.alive, values: &self.values }
        }
    }

    fn rules(dimensions: usize) -> Vec<KeyRule> {
        let goal = |d: usize| if d.is_multiple_of(2) { Goal::Min } else { Goal::Max };
        let objective = |d| Objective { quantity: Quantity::Input(0), goal: goal(d), resolution: (d == 3).then_some(3.0) };
        (0..dimensions).map(|d| KeyRule::from(&objective(d))).collect()
    }

    /// Blocks of designs with `dimensions` values on few levels, some of them infeasible, in a shuffled order.
    fn blocks(dimensions: usize, designs: u64, seed: u64) -> Vec<Owned> {
        let value = |index: u64, d: usize| {
            let level = mix(seed ^ (index * 8 + d as u64)) % 40;
            level as f64 + if d == 0 { (index % 100) as f64 } else { 0.0 }
        };
        let mut blocks: Vec<Owned> = (0..designs)
            .step_by(100)
            .map(|first| Owned {
                row_index: first,
                offsets: (0..100).collect(),
                alive: (first..first + 100).map(|index| if mix(seed ^ index).is_multiple_of(3) { 0 } else { u64::MAX }).collect(),
                values: (0..dimensions).map(|d| (first..first + 100).map(|index| value(index, d)).collect()).collect(),
            })
            .collect();
        blocks.sort_by_key(|block| mix(block.row_index ^ seed));
        blocks
    }

    fn brute_force(rules: &[KeyRule], blocks: &[Owned]) -> Vec<u64> {
        let all: Vec<(Vec<f64>, u64)> = blocks
            .iter()
            .flat_map(|owned| {
                owned
                    .block()
                    .feasible()
                    .map(|lane| (rules.iter().zip(&owned.values).map(|(r, v)| r.key(v[lane])).collect(), owned.block().index(lane)))
            })
            .collect();
        let mut front: Vec<_> =
            all.iter().filter(|(key, index)| !all.iter().any(|(k, i)| beats(k, *i, key, *index))).map(|(_, index)| *index).collect();
        front.sort_unstable();
        front
    }

    fn sorted(points: &Points) -> Vec<u64> {
        let mut indices = points.indices.clone();
        indices.sort_unstable();
        indices
    }

    #[test]
    fn the_front_is_the_brute_force_one_whatever_the_order_and_the_split() {
        for dimensions in 1..=6 {
            let rules = rules(dimensions);
            let objectives: Vec<_> = (0..dimensions).collect();
            let blocks = blocks(dimensions, 2000, 77 + dimensions as u64);
            let expected = brute_force(&rules, &blocks);
            let mut whole = Front::new(&rules);
            blocks.iter().for_each(|block| whole.absorb(&block.block(), &objectives));
            assert_eq!(sorted(whole.points()), expected, "{dimensions} objectives");

            let (first, second) = blocks.split_at(7);
            let mut merged = Front::new(&rules);
            first.iter().for_each(|block| merged.absorb(&block.block(), &objectives));
            let mut part = Front::seeded(&rules, merged.points().clone());
            second.iter().rev().for_each(|block| part.absorb(&block.block(), &objectives));
            merged.merge(part.into_fresh());
            assert_eq!(sorted(merged.points()), expected, "{dimensions} objectives, two parts");
            assert_eq!(merged.points(), whole.points());
        }
    }

    #[test]
    fn designs_that_tie_in_everything_are_one_point_with_the_lowest_index() {
        for dimensions in 1..=3 {
            let rules = rules(dimensions);
            let block = |row_index| Owned {
                row_index,
                offsets: (0..512).collect(),
                alive: vec![u64::MAX; 512],
                values: vec![vec![5.0; 512]; dimensions],
            };
            let mut front = Front::new(&rules);
            for row in [4096, 1024, 2048] {
                front.absorb(&block(row).block(), &(0..dimensions).collect::<Vec<_>>());
            }
            assert_eq!(front.points().indices, [1024]);
        }
    }

    #[test]
    fn the_table_never_drops_a_point_of_the_front() {
        // Denormal spans and huge offsets: the bin function must stay monotone.
        for (offset, width) in [(0.0, 1e-310), (1e300, 1e285), (-1e-3, 1e-19), (5.0, 0.0)] {
            let rules = [KeyRule { goal: Goal::Min, resolution: None }; 2];
            let value = |i: u64, d: u64| offset + width * (mix(i * 2 + d) % 1000) as f64;
            let mut front = Front::new(&rules);
            let column = |d| (0..512).map(|i| value(i, d)).collect::<Vec<_>>();
            let block = Owned { row_index: 0, offsets: (0..512).collect(), alive: vec![u64::MAX; 512], values: vec![column(0), column(1)] };
            front.absorb(&block.block(), &[0, 1]);
            front.points();
            front.absorb(&block.block(), &[0, 1]);
            assert_eq!(sorted(front.points()), brute_force(&rules, &[block]), "{offset} {width}");
        }
    }
}
