//! What can be wrong with a distribution, draws, or a statement about them.

use crate::decimal::{plain, short};

/// A mistake in a distribution, in draws, or in a statement about them.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProbabilityProblem {
    /// A parameter is no number, or beyond its limit.
    #[error("{of}: {parameter} is {}, and must be {limit}", plain(*.value))]
    Parameter {
        /// The distribution or setting.
        of: &'static str,
        /// Its parameter.
        parameter: &'static str,
        /// The value.
        value: f64,
        /// What the value must be, such as "above 0".
        limit: &'static str,
    },
    /// Two parameters are in the wrong order.
    #[error("{of}: {lower} is {}, and must be below {upper}, which is {}", plain(*.below), plain(*.above))]
    Order {
        /// The distribution.
        of: &'static str,
        /// The parameter that must be the lower one.
        lower: &'static str,
        /// Its value.
        below: f64,
        /// The parameter that must be the upper one.
        upper: &'static str,
        /// Its value.
        above: f64,
    },
    /// Values and weights that do not fit together.
    #[error("discrete: {values} values but {weights} weights; give each value one weight")]
    Weights {
        /// Number of values.
        values: usize,
        /// Number of weights.
        weights: usize,
    },
    /// Every weight is zero.
    #[error("discrete: all weights are 0; at least one must be above 0")]
    NoWeight,
    /// There are no values.
    #[error("{of}: there are no values; give at least one")]
    NoValues {
        /// The distribution or statistic.
        of: &'static str,
    },
    /// A truncation leaves nothing, or next to nothing.
    #[error(
        "{of}: from {} to {} lies a probability of {}, and it must be at least 1e-9; widen from and to, or check the units",
        plain(*.from), plain(*.to), short(*.kept)
    )]
    Truncation {
        /// The distribution.
        of: &'static str,
        /// Lower end of the truncation.
        from: f64,
        /// Upper end of the truncation.
        to: f64,
        /// The probability between them.
        kept: f64,
    },
    /// Draws that cannot be divided into the replicates.
    #[error("{sampling}: {draws} draws cannot be divided into {replicates} replicates{of_what}; take {nearest} draws")]
    Replicates {
        /// How the draws are spread.
        sampling: &'static str,
        /// Number of draws.
        draws: u64,
        /// Number of replicates.
        replicates: u64,
        /// What each replicate must be, for Sobol points.
        of_what: &'static str,
        /// The next larger number of draws that can be divided.
        nearest: u64,
    },
    /// Sobol points have fewer dimensions than there are inputs.
    #[error("sobol: {inputs} inputs are uncertain, and there are points for at most {most}; use random or latin-hypercube")]
    Dimensions {
        /// Number of inputs.
        inputs: usize,
        /// Most dimensions.
        most: usize,
    },
    /// An input has two distributions.
    #[error("{name} has two distributions; give it one")]
    Twice {
        /// The input.
        name: String,
    },
    /// A correlation names an input that has no distribution.
    #[error("correlation: {name} has no distribution; {remedy}")]
    NotUncertain {
        /// The name.
        name: String,
        /// What was probably meant, or which inputs there are.
        remedy: String,
    },
    /// A pair of inputs has two correlations, or an input one with itself.
    #[error(
        "correlation: {first} and {second} {}",
        if first == second { "are the same input; name two" } else { "stand there twice; give them one correlation" }
    )]
    Pair {
        /// The first input.
        first: String,
        /// The second input.
        second: String,
    },
    /// Correlations that no set of numbers can have, at least not all of them.
    #[error(
        "correlation: {first} and {second} have {}, and it must be between {} and {}{}",
        plain(*.value), short(*.low), short(*.high), if *.low > -1.0 || *.high < 1.0 { ", given the others" } else { "" }
    )]
    Correlation {
        /// The first input.
        first: String,
        /// The second input.
        second: String,
        /// Their correlation.
        value: f64,
        /// What it must be above.
        low: f64,
        /// What it must be below.
        high: f64,
    },
    /// A quantity whose sensitivity is asked for has no value in a draw.
    #[error("the quantity has no value in draw {draw}; name one that has a value in every draw, or narrow the inputs")]
    Absent {
        /// The number of the draw or walk.
        draw: u64,
    },
    /// A quantity whose sensitivity is asked for does not vary.
    #[error("the quantity is the same in all draws, so that no input can matter; name one that varies")]
    Constant,
}
