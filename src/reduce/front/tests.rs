//! The front against comparing everything.

use super::*;
use crate::sample::mix;
use crate::study::{Goal, Objective, OverScenarios, Quantity};

/// A block that owns its columns.
struct Owned {
    row_index: u64,
    offsets: Vec<u64>,
    alive: Vec<u64>,
    values: Vec<Vec<f64>>,
}

impl Owned {
    fn block(&self) -> Block<'_> {
        let feasible_count = self.alive.iter().filter(|&&alive| alive != 0).count() as u64;
        Block { row_index: self.row_index, offsets: &self.offsets, feasible_count, alive: &self.alive, values: &self.values }
    }
}

fn rules(dimensions: usize) -> Vec<KeyRule> {
    let goal = |d: usize| if d.is_multiple_of(2) { Goal::Min } else { Goal::Max };
    let objective =
        |d| Objective { quantity: Quantity::Input(0), goal: goal(d), resolution: (d == 3).then_some(3.0), over: OverScenarios::Worst };
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

        // Three threads that start with the same points: the first meets these designs again, the last meets none.
        let known = points_of(&rules, &blocks[..5], &objectives);
        let parts = [&blocks[..9], &blocks[9..], &[]].map(|part| {
            let mut own = Front::seeded(&rules, known.clone());
            part.iter().for_each(|block| own.absorb(&block.block(), &objectives));
            own
        });
        assert_eq!(&together(Vec::from(parts)), whole.points(), "{dimensions} objectives, three threads");
    }
}

/// The front of a few blocks.
fn points_of(rules: &[KeyRule], blocks: &[Owned], objectives: &[usize]) -> Points {
    let mut front = Front::new(rules);
    blocks.iter().for_each(|block| front.absorb(&block.block(), objectives));
    front.points().clone()
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
        for objectives in 2..=4 {
            let objective = Objective { quantity: Quantity::Input(0), goal: Goal::Min, resolution: None, over: OverScenarios::Worst };
            let rules = vec![KeyRule::from(&objective); objectives];
            let value = |i: u64, d: usize| offset + width * (mix(i * 4 + d as u64) % 1000) as f64;
            let mut front = Front::new(&rules);
            let column = |d| (0..512).map(|i| value(i, d)).collect::<Vec<_>>();
            let values = (0..objectives).map(column).collect();
            let block = Owned { row_index: 0, offsets: (0..512).collect(), alive: vec![u64::MAX; 512], values };
            let places: Vec<_> = (0..objectives).collect();
            front.absorb(&block.block(), &places);
            front.points();
            front.absorb(&block.block(), &places);
            assert_eq!(sorted(front.points()), brute_force(&rules, &[block]), "{offset} {width}, {objectives} objectives");
        }
    }
}

#[test]
fn a_slice_knows_what_the_front_knows_of_designs_with_something_in_common() {
    for (objectives, free) in [(3, FreeObjectives(0, 1)), (3, FreeObjectives(0, 2)), (4, FreeObjectives(1, 3)), (4, FreeObjectives(2, 0))] {
        // About a plane, on so few levels that ties in single coordinates and in all of them are common.
        let point = |seed: u64| -> Vec<f64> {
            let key: Vec<f64> = (0..objectives).map(|d| (mix(seed * 8 + d) % 40) as f64).collect();
            let behind = (60.0 - key.iter().sum::<f64>()) / objectives as f64;
            key.iter().map(|it| (it + behind).round()).collect()
        };
        let mut waiting = Points::default();
        (0..600).for_each(|seed| waiting.push(point(seed), seed + 1));
        let mut front = Front::new(&rules(objectives as usize));
        front.merge(waiting);
        let (mut told, mut made) = (0, 0);
        for seed in 0..4000 {
            // Among and behind the points, and the points themselves.
            let mut lower = point(seed % 900);
            lower.iter_mut().for_each(|it| *it += (seed % 4) as f64 - 2.0);
            let index = if seed % 2 == 0 { 1 + seed / 4 } else { 2000 };
            let expected = front.beats_from(&lower, index);
            // A slice is made when it has been asked for some times.
            (0..4).for_each(|_| assert!(front.known(Some(free), &lower).beats_from(&lower, index) == expected));
            let known = front.known(Some(free), &lower);
            assert_eq!(known.beats_from(&lower, index), expected, "{lower:?}, {index}, {free:?}");
            told += u32::from(expected);
            made += u32::from(matches!(known, KnownFront::Slice(_)));
        }
        assert!((1000..3500).contains(&told) && made == 4000, "{told}, {made} of {} points", front.len());
    }
}
