//! How a quantity's worst value is distributed over the feasible designs.

use crate::screen::Block;
use serde::{Deserialize, Serialize};

/// Counts per bin. Bin `i` of `n` holds `edge(i) <= value < edge(i + 1)`; the last one also its upper edge.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Histogram {
    /// Lower edge of the first bin.
    pub from: f64,
    /// Upper edge of the last bin.
    pub to: f64,
    /// Designs per bin.
    pub counts: Vec<u64>,
    /// Designs below the first bin.
    pub below: u64,
    /// Designs above the last bin.
    pub above: u64,
    /// Every [`Histogram::edge`], once it is needed often.
    #[serde(skip)]
    edges: Vec<f64>,
}

impl PartialEq for Histogram {
    fn eq(&self, other: &Self) -> bool {
        let ends = |it: &Self| (it.from, it.to, it.below, it.above);
        ends(self) == ends(other) && self.counts == other.counts
    }
}

impl Histogram {
    /// Empty bins over a range that is not empty.
    pub fn new((from, to): (f64, f64), bins: usize) -> Self {
        Self { from, to, counts: vec![0; bins], below: 0, above: 0, edges: Vec::new() }
    }

    /// Lower edge of a bin, or the upper edge of the last.
    #[allow(clippy::cast_precision_loss, reason = "bins are few")]
    pub fn edge(&self, bin: usize) -> f64 {
        if bin == self.counts.len() { self.to } else { self.from + bin as f64 * (self.to - self.from) / self.counts.len() as f64 }
    }

    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss, reason = "the value is in range")]
    fn count(&mut self, value: f64) {
        if value < self.from {
            self.below += 1;
        } else if value > self.to {
            self.above += 1;
        } else {
            let bins = self.counts.len();
            let guess = ((value - self.from) / (self.to - self.from) * bins as f64) as usize;
            let mut bin = guess.min(bins - 1);
            // The guess rounds; the edges decide.
            while bin > 0 && value < self.edge(bin) {
                bin -= 1;
            }
            while bin + 1 < bins && value >= self.edge(bin + 1) {
                bin += 1;
            }
            self.counts[bin] += 1;
        }
    }

    /// Takes in a block.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss, reason = "the edges decide")]
    pub fn absorb(&mut self, block: &Block<'_>, column: usize) {
        let bins = self.counts.len();
        if self.edges.is_empty() {
            self.edges = (0..=bins).map(|bin| self.edge(bin)).collect();
        }
        let (from, per_unit) = (self.from, bins as f64 / (self.to - self.from));
        // Neighbours often have one value, above all where values are whole numbers: those are counted by runs.
        let (mut last, mut run, mut place) = (f64::NAN, 0, 0);
        for (&alive, &value) in block.alive.iter().zip(&block.values[column]) {
            if alive == 0 {
                continue;
            }
            if value == last {
                run += 1;
                continue;
            }
            let guess = (((value - from) * per_unit) as usize).min(bins - 1);
            if value >= self.edges[guess] && value < self.edges[guess + 1] {
                self.counts[place] += run;
                (last, run, place) = (value, 1, guess);
            } else {
                self.count(value);
            }
        }
        self.counts[place] += run;
    }

    /// Adds counts made elsewhere: below, every bin, above.
    pub fn add(&mut self, counts: &[u32]) {
        let (below, rest) = counts.split_first().expect("there is a count below");
        let (above, bins) = rest.split_last().expect("there is a count above");
        self.below += u64::from(*below);
        self.above += u64::from(*above);
        self.counts.iter_mut().zip(bins).for_each(|(count, &bin)| *count += u64::from(bin));
    }

    /// Takes in the counts of other designs.
    pub fn merge(&mut self, other: &Self) {
        self.counts.iter_mut().zip(&other.counts).for_each(|(count, other)| *count += other);
        self.below += other.below;
        self.above += other.above;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_decide_and_what_is_outside_is_counted() {
        let mut histogram = Histogram::new((0.1, 0.7), 6);
        for bin in 0..=6 {
            histogram.count(histogram.edge(bin));
            histogram.count(histogram.edge(bin).next_down());
        }
        histogram.count(0.7f64.next_up());
        assert_eq!(histogram.counts, [2, 2, 2, 2, 2, 3]);
        assert_eq!((histogram.below, histogram.above), (1, 1));
    }
}
