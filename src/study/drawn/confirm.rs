//! Fresh draws, which judge what others have chosen.

use super::columns;
use super::statistic::{CONFIDENCE, ConfirmedEnd};
use crate::probability::{Draws, clopper_pearson, simultaneous};
use std::sync::OnceLock;

/// Draws that are looked at together, and the most numbers that are kept for the next design.
const BLOCK: u64 = columns::BLOCK as u64;
const MOST_KEPT: u64 = 1 << 23;

/// Fresh draws and the number of levels at which each design is judged by them.
pub struct FreshDraws {
    draws: Draws,
    inputs: u64,
    levels: u64,
    kept: OnceLock<Vec<Vec<Vec<f64>>>>,
}

impl FreshDraws {
    /// Of so many inputs.
    pub fn new(draws: Draws, inputs: usize, levels: u64) -> Self {
        Self { draws, inputs: inputs as u64, levels, kept: OnceLock::new() }
    }

    /// Numbers of an input that are kept, of so many draws.
    pub fn kept(draws: u64, inputs: u64) -> u64 {
        if draws.saturating_mul(inputs) <= MOST_KEPT { draws } else { BLOCK }
    }

    /// Most of them that are looked at together.
    pub fn at_a_time(&self) -> usize {
        self.draws.count().min(BLOCK) as usize
    }

    /// How many of them hold; `count` counts those of a block, a column per input.
    pub fn holding(&self, count: &mut dyn FnMut(&[Vec<f64>]) -> u64) -> u64 {
        let number = self.draws.count().div_ceil(BLOCK);
        let block = |it: u64| self.draws.columns(it * BLOCK..self.draws.count().min((it + 1) * BLOCK));
        if Self::kept(self.draws.count(), self.inputs) == self.draws.count() {
            return self.kept.get_or_init(|| (0..number).map(block).collect()).iter().map(|it| count(it)).sum();
        }
        (0..number).map(|it| count(&block(it))).sum()
    }

    /// What is told where so many hold. The interval is that of one design: it holds the yield, the least over the levels, with the
    /// confidence of 95 % at least.
    pub fn told(&self, end: ConfirmedEnd, holds: u64) -> f64 {
        let draws = self.draws.count();
        let interval = match end {
            ConfirmedEnd::Share => return holds as f64 / draws as f64,
            ConfirmedEnd::Low => clopper_pearson(holds, draws, CONFIDENCE).map(|it| it.low),
            // Any of the levels may be the one whose upper end is the least.
            ConfirmedEnd::High => simultaneous(holds, draws, CONFIDENCE, self.levels).map(|it| it.high),
            // Draws prove nothing: whoever certifies a design fills these in. And the standard error is not theirs.
            ConfirmedEnd::AtLeast | ConfirmedEnd::AtMost | ConfirmedEnd::StandardError => return f64::NAN,
        };
        interval.unwrap_or(f64::NAN)
    }
}
