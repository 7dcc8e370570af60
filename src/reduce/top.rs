//! The best K designs by one quantity.

use crate::screen::Block;
use crate::study::Goal;
use serde::{Deserialize, Serialize};

/// The best designs so far.
///
/// Invariant: `best` holds at most `2 * count` designs, and once `count` have been seen, every design of the answer is among
/// them and none worse than `worst_kept` can be part of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Top {
    goal: Goal,
    count: usize,
    /// Key (less is better) and index.
    best: Vec<(f64, u64)>,
    worst_kept: f64,
}

impl Top {
    /// Nothing seen yet; `count` is at least 1.
    pub fn new(goal: Goal, count: usize) -> Self {
        Self { goal, count, best: Vec::new(), worst_kept: f64::INFINITY }
    }

    /// Takes in a block.
    pub fn absorb(&mut self, block: &Block<'_>, column: usize) {
        let values = block.column(column);
        for (lane, (&value, &alive)) in values.iter().zip(block.alive).enumerate() {
            let key = if self.goal == Goal::Min { value } else { -value };
            if alive != 0 && key <= self.worst_kept {
                self.push(key + 0.0, block.index(lane));
            }
        }
    }

    /// Takes in the best of other designs.
    pub fn merge(&mut self, other: Self) {
        for (key, index) in other.best {
            self.push(key, index);
        }
    }

    /// Key (less is better) and index of the worst of the best K, once there are K.
    pub fn worst(&mut self) -> Option<(f64, u64)> {
        self.shrink();
        (self.best.len() == self.count).then(|| self.best[self.count - 1])
    }

    fn push(&mut self, key: f64, index: u64) {
        self.best.push((key, index));
        if self.best.len() >= 2 * self.count {
            self.shrink();
        }
    }

    fn shrink(&mut self) {
        self.best.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        // The same design may come twice, when a comparison merges what it has merged before.
        self.best.dedup_by_key(|(_, index)| *index);
        self.best.truncate(self.count);
        if self.best.len() == self.count {
            self.worst_kept = self.best[self.count - 1].0;
        }
    }

    /// The design indices, best first, ties by index.
    pub fn indices(&self) -> Vec<u64> {
        let mut sorted = self.clone();
        sorted.shrink();
        sorted.best.into_iter().map(|(_, index)| index).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::mix;

    #[test]
    fn the_best_are_those_of_sorting_everything() {
        for (goal, count) in [(Goal::Min, 1), (Goal::Min, 7), (Goal::Max, 50), (Goal::Max, 2000)] {
            let value = |index: u64| (mix(index) % 60) as f64;
            let mut top = Top::new(goal, count);
            for first in [600u64, 0, 900, 300] {
                let values = (first..first + 300).map(value).collect();
                let alive: Vec<u64> = (first..first + 300).map(|index| if index % 3 == 0 { 0 } else { u64::MAX }).collect();
                let offsets: Vec<u64> = (0..300).collect();
                top.absorb(&Block { row_index: first, offsets: &offsets, feasible_count: 200, alive: &alive, values: &[values] }, 0);
            }
            let mut all: Vec<u64> = (0..1200).filter(|index| index % 3 != 0).collect();
            let sign = if goal == Goal::Min { 1.0 } else { -1.0 };
            all.sort_by(|&a, &b| (sign * value(a)).total_cmp(&(sign * value(b))).then(a.cmp(&b)));
            all.truncate(count);
            assert_eq!(top.indices(), all);
        }
    }
}
