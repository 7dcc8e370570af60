//! Ranges of positions: what is still to be swept, what has been swept, and what belongs to a shard.

use serde::{Deserialize, Serialize};
use std::ops::Range;

/// A set of positions as sorted, separate ranges.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ranges(pub Vec<Range<u64>>);

impl Ranges {
    /// One range.
    pub fn of(range: Range<u64>) -> Self {
        Self(if range.is_empty() { Vec::new() } else { vec![range] })
    }

    /// Number of positions.
    pub fn count(&self) -> u64 {
        self.0.iter().map(|range| range.end - range.start).sum()
    }

    /// Adds a range, none of whose positions is in the set.
    pub fn add(&mut self, range: Range<u64>) {
        if range.is_empty() {
            return;
        }
        let at = self.0.partition_point(|it| it.start < range.start);
        self.0.insert(at, range);
        // Adjacent ranges are joined, so that a finished run is a single range.
        self.0.dedup_by(|next, previous| {
            let touch = previous.end == next.start;
            if touch {
                previous.end = next.end;
            }
            touch
        });
    }

    /// Positions of `whole` that are not in the set.
    pub fn missing_from(&self, whole: Range<u64>) -> Self {
        let mut missing = Vec::new();
        let mut next = whole.start;
        for range in self.0.iter().filter(|range| range.end > whole.start && range.start < whole.end) {
            if range.start > next {
                missing.push(next..range.start);
            }
            next = next.max(range.end);
        }
        if next < whole.end {
            missing.push(next..whole.end);
        }
        Self(missing)
    }

    /// The first range.
    pub fn first(&self) -> Option<Range<u64>> {
        self.0.first().cloned()
    }

    /// Removes and returns at most `count` leading positions.
    pub fn take(&mut self, count: u64) -> Option<Range<u64>> {
        let first = self.0.first_mut()?;
        let taken = first.start..first.end.min(first.start.saturating_add(count));
        first.start = taken.end;
        if first.is_empty() {
            self.0.remove(0);
        }
        Some(taken)
    }
}

/// One of several equal parts of a study, which can run on different machines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// Number of the part, from 1.
    pub number: u64,
    /// Number of parts.
    pub of: u64,
}

impl Shard {
    /// The whole study.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// The positions of this part.
    pub fn range(self, designs: u64) -> Range<u64> {
        let edge = |part: u64| (u128::from(designs) * u128::from(part) / u128::from(self.of)) as u64;
        edge(self.number - 1)..edge(self.number)
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
        match parts {
            Some((number, of)) if 1 <= number && number <= of => Ok(Self { number, of }),
            _ => Err("a shard is K/N with K from 1 to N, such as 3/8".to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_cover_the_study_once() {
        for designs in [0, 1, 5, 100, u64::MAX] {
            for of in [1, 2, 3, 7] {
                let mut all = Ranges::default();
                (1..=of).for_each(|number| all.add(Shard { number, of }.range(designs)));
                assert_eq!(all, Ranges::of(0..designs));
            }
        }
    }

    #[test]
    fn ranges_add_up_and_miss_what_is_missing() {
        let mut done = Ranges::default();
        for range in [10..20, 40..50, 20..25, 0..10] {
            done.add(range);
        }
        assert_eq!(done.0, [0..25, 40..50]);
        assert_eq!(done.missing_from(5..60).0, [25..40, 50..60]);
        let mut todo = done.missing_from(0..60);
        assert_eq!((todo.take(7), todo.take(100), todo.take(3)), (Some(25..32), Some(32..40), Some(50..53)));
    }

    #[test]
    fn what_is_no_shard_is_refused() {
        assert_eq!("2/3".parse(), Ok(Shard { number: 2, of: 3 }));
        for text in ["0/3", "4/3", "1", "a/b", "1/0", ""] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }
}
