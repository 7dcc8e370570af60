//! What becomes of the draws of many designs, column by column.

use super::super::resolved::Constraint;
use super::super::spectrum::OverScenarios;
use super::statistic::{AskedQuantity, Statistic};
use crate::masks::{keep_between, keep_finite, keep_marked, lower, raise};
use crate::models::Worse;

/// A mask of a design that is in.
pub const IN: u64 = u64::MAX;

/// A quantity over the cases, for each design in one draw, or for each draw of one design.
pub struct CaseFold {
    pub asked: AskedQuantity,
    pub present: Vec<u64>,
    pub result: Vec<f64>,
    pub sums: Vec<Vec<f64>>,
}

/// What becomes of the draws, for each design.
pub enum Track {
    /// Draws that hold.
    Holding(Vec<u64>),
    /// Draws that keep one constraint, with its mask in the current draw and the folds of both ends if it is of a mean or sum.
    Keeping { constraint: Constraint, kept: Vec<u64>, folds: Option<[usize; 2]>, count: Vec<u64> },
    /// The sum of a fold, NaN where a draw has no value.
    Sum { fold: usize, sum: Vec<f64> },
    /// The worst of a fold, and whether there is a value: in all draws, or in any.
    Worst { fold: usize, worst: Vec<f64>, present: Vec<u64>, in_any: bool },
    /// All values of a fold, draw by draw.
    All { fold: usize, values: Vec<f64> },
    /// Of fresh draws.
    Fresh,
    /// Nobody asks for it.
    Idle,
}

impl CaseFold {
    pub fn begin(&mut self, count: usize) {
        self.present[..count].fill(IN);
        self.result[..count].fill(self.asked.worse.least_bad());
        self.sums.iter_mut().for_each(|sum| sum[..count].fill(0.0));
    }

    /// Takes in the values of a case; absent are those that are no finite numbers.
    pub fn take(&mut self, values: &[f64], place: Option<(usize, f64)>) {
        keep_finite(&mut self.present[..values.len()], values);
        match place {
            None => worsen(self.asked.worse, &mut self.result[..values.len()], values),
            Some((sum, weight)) => self.sums[sum].iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value),
        }
    }

    /// After the last case.
    pub fn end(&mut self, count: usize, total: f64, built: &[u64]) {
        let Self { asked, present, result, sums } = self;
        for sum in sums {
            if asked.over == OverScenarios::Mean {
                sum[..count].iter_mut().for_each(|it| *it /= total);
            }
            worsen(asked.worse, &mut result[..count], &sum[..count]);
        }
        keep_finite(&mut present[..count], &result[..count]);
        keep_marked(&mut present[..count], &built[..count]);
    }
}

impl Track {
    /// Before the first of so many draws of `count` designs, for which there is room for `padded`.
    pub fn begin(&mut self, statistic: &Statistic, (draws, count, padded): (usize, usize, usize)) {
        let zero = |counts: &mut Vec<u64>| {
            counts.clear();
            counts.resize(padded, 0);
        };
        match self {
            Self::Holding(count) => zero(count),
            Self::Keeping { kept, count, .. } => {
                zero(kept);
                zero(count);
            }
            Self::Sum { sum, .. } => {
                sum.clear();
                sum.resize(padded, 0.0);
            }
            Self::Worst { worst, present, in_any, .. } => {
                worst.clear();
                worst.resize(padded, statistic.kind.asked().map_or(0.0, |it| it.worse.least_bad()));
                // A statistic needs a value in every draw, a quantity that does not depend on them in one.
                present.clear();
                present.resize(padded, if *in_any { 0 } else { IN });
            }
            Self::All { values, .. } => values.resize(draws * count, 0.0),
            Self::Fresh | Self::Idle => {}
        }
    }

    /// Of each design how many of the draws so far count, if that is what it tells.
    pub fn counts(&self) -> Option<&[u64]> {
        match self {
            Self::Holding(count) | Self::Keeping { count, .. } => Some(count),
            _ => None,
        }
    }

    /// Keeps the designs at these places, in this order; not for all values of all draws.
    pub fn keep(&mut self, places: &[usize]) {
        match self {
            Self::Holding(count) => keep(count, places),
            Self::Keeping { kept, count, .. } => {
                keep(kept, places);
                keep(count, places);
            }
            Self::Sum { sum, .. } => keep(sum, places),
            Self::Worst { worst, present, .. } => {
                keep(worst, places);
                keep(present, places);
            }
            Self::All { .. } => unreachable!("designs with all their values stay where they are"),
            Self::Fresh | Self::Idle => {}
        }
    }
}

/// Moves what stands at rising places to the front.
pub fn keep<T: Copy>(column: &mut [T], places: &[usize]) {
    for (to, &from) in places.iter().enumerate() {
        column[to] = column[from];
    }
}

fn worsen(worse: Worse, worst: &mut [f64], values: &[f64]) {
    match worse {
        Worse::Higher => raise(worst, values),
        Worse::Lower => lower(worst, values),
    }
}

/// Keeps what is built and, at both ends of a mean or sum, satisfies the constraint.
pub fn keep_folds(alive: &mut [u64], constraint: &Constraint, ends: [usize; 2], folds: &[CaseFold]) {
    let (low, high) = constraint.ends();
    for fold in ends.map(|end| &folds[end]) {
        keep_between(alive, &fold.result[..alive.len()], low, high);
        keep_marked(alive, &fold.present);
    }
}
