//! Sobol indices, by the estimators of Saltelli et al. (2010) for the first order and of Jansen (1999) for the total.

use crate::probability::{Distribution, PairedDraws, ProbabilityProblem, REPLICATES, Replicated, replicated};

/// The Sobol indices of one input.
#[derive(Clone, Debug, PartialEq)]
pub struct Indices {
    /// The input.
    pub name: String,
    /// Share of the variance that goes if this input alone is known.
    pub first: Replicated,
    /// Share of the variance that stays if all others are known.
    pub total: Replicated,
}

/// A quantity in two sets of draws that have nothing in common.
pub(crate) struct PairedValues {
    first: Vec<f64>,
    second: Vec<f64>,
    mean: f64,
    variance: f64,
}

impl PairedValues {
    /// From its values in both sets.
    ///
    /// # Errors
    /// It has no value in a draw, or the same in all.
    pub(crate) fn new(first: Vec<f64>, second: Vec<f64>) -> Result<Self, ProbabilityProblem> {
        let count = 2.0 * first.len() as f64;
        let both = || first.iter().chain(&second);
        if let Some(draw) = both().position(|it| !it.is_finite()) {
            return Err(ProbabilityProblem::Absent { draw: (draw % first.len()) as u64 });
        }
        if both().all(|it| *it == first[0]) {
            return Err(ProbabilityProblem::Constant);
        }
        let mean = both().sum::<f64>() / count;
        let variance = both().map(|it| (it - mean) * (it - mean)).sum::<f64>() / count;
        Ok(Self { first, second, mean, variance })
    }

    /// The mean of all draws.
    pub(crate) fn mean(&self) -> f64 {
        self.mean
    }

    /// The variance of all draws.
    pub(crate) fn variance(&self) -> f64 {
        self.variance
    }

    /// The share of the variance that goes if one input alone is known, from the values where only this one is of the second set.
    pub(crate) fn first_order(&self, mixed: &[f64]) -> Result<Replicated, ProbabilityProblem> {
        replicated(&self.by_replicate(|row| (self.second[row] - self.mean) * (mixed[row] - self.first[row])))
    }

    /// Of each replicate, the share of the variance that is left if some inputs are known, from the values where these are of the first set
    /// and the others are drawn again.
    pub(crate) fn left(&self, mixed: &[f64]) -> Vec<f64> {
        self.by_replicate(|row| 0.5 * (self.first[row] - mixed[row]) * (self.first[row] - mixed[row]))
    }

    /// The same where no input is known: all of the variance, but for the error of the draws.
    pub(crate) fn all_left(&self) -> Vec<f64> {
        self.left(&self.second)
    }

    fn by_replicate(&self, term: impl Fn(usize) -> f64) -> Vec<f64> {
        let size = self.first.len() / REPLICATES as usize;
        let estimate = |replicate: usize| {
            let sum: f64 = (replicate * size..(replicate + 1) * size).map(&term).sum();
            sum / size as f64 / self.variance
        };
        (0..REPLICATES as usize).map(estimate).collect()
    }
}

/// The bits of all of `count` inputs but this one.
pub(crate) fn all_but(input: usize, count: usize) -> u64 {
    all_of(count) & !(1 << input)
}

/// The bits of all of `count` inputs.
pub(crate) fn all_of(count: usize) -> u64 {
    if count >= 64 { u64::MAX } else { (1 << count) - 1 }
}

/// First-order and total Sobol indices of a quantity, one for each of its inputs, which are independent.
///
/// There are `draws` scrambled Sobol points, 16 times a power of two; each takes an evaluation for every input and two more.
///
/// # Errors
/// As [`Draws::new`](crate::probability::Draws::new) for twice the inputs; or the quantity has no value in a draw, or the same in all.
pub fn sobol_indices(
    inputs: &[(&str, Distribution)],
    draws: u64,
    seed: u64,
    quantity: impl Fn(&[f64]) -> f64,
) -> Result<Vec<Indices>, ProbabilityProblem> {
    let paired = PairedDraws::new(inputs, &[], draws, seed)?;
    // The value of each draw where the inputs outside of `kept` are taken from the second set.
    let values = |kept: u64| -> Result<Vec<f64>, ProbabilityProblem> {
        let columns = paired.columns(kept)?;
        let value = |row: usize| quantity(&columns.iter().map(|column| column[row]).collect::<Vec<_>>());
        let present = |(row, it): (usize, f64)| if it.is_finite() { Ok(it) } else { Err(ProbabilityProblem::Absent { draw: row as u64 }) };
        (0..paired.rows()).map(value).enumerate().map(present).collect()
    };
    let both = PairedValues::new(values(all_of(inputs.len()))?, values(0)?)?;
    let indices = inputs.iter().enumerate().map(|(input, (name, _))| {
        let mixed = values(all_but(input, inputs.len()))?;
        Ok(Indices { name: (*name).to_owned(), first: both.first_order(&mixed)?, total: replicated(&both.left(&mixed))? })
    });
    indices.collect()
}
