//! Statistics over draws. All sums run in the order of the draws, so that they are the same to the last bit on every engine.
//!
//! A draw without a value is NaN.

use super::problem::ProbabilityProblem;
use crate::models::Worse;

/// A product this near to a whole number, relative to it, is that number: 0.07 x 100 comes out a little above 7.
const NEAR: f64 = 1e-9;

/// The mean, if every draw has a value and there are draws.
pub fn mean(values: &[f64]) -> Option<f64> {
    Some(values.iter().sum::<f64>() / values.len() as f64).filter(|mean| !mean.is_nan())
}

/// The standard deviation of these draws themselves, dividing by their number; if every draw has a value and there are draws.
pub fn sd(values: &[f64]) -> Option<f64> {
    let mean = mean(values)?;
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    Some(libm::sqrt(squares / values.len() as f64)).filter(|sd| !sd.is_nan())
}

/// The worst value, if every draw has one and there are draws: the worst of these, no bound.
pub fn worst(values: &[f64], worse: Worse) -> Option<f64> {
    sorted(values, worse).last().copied().filter(|worst| !worst.is_nan())
}

/// The value that the share `q` of the draws reaches or betters: of n values, the ceil(q n)-th best. Draws without a value are worse than
/// all others; there is none if it falls on one of these.
///
/// ```
/// use beltspace::models::Worse;
/// use beltspace::probability::quantile;
///
/// let forces = [31.0, 44.0, f64::NAN, 28.0, 39.0];
/// assert_eq!(quantile(&forces, 0.6, Worse::Higher)?, Some(39.0));
/// assert_eq!(quantile(&forces, 0.6, Worse::Lower)?, Some(31.0));
/// assert_eq!(quantile(&forces, 0.95, Worse::Higher)?, None);
/// # Ok::<(), beltspace::Error>(())
/// ```
///
/// # Errors
/// `q` is not above 0 and at most 1, or there are no draws.
pub fn quantile(values: &[f64], q: f64, worse: Worse) -> Result<Option<f64>, ProbabilityProblem> {
    if !(q > 0.0 && q <= 1.0) {
        return Err(ProbabilityProblem::Parameter {
            of: "quantile",
            parameter: "share of the draws",
            value: q,
            limit: "above 0 and at most 1",
        });
    }
    if values.is_empty() {
        return Err(ProbabilityProblem::NoValues { of: "quantile" });
    }
    Ok(Some(sorted(values, worse)[rank(q, values.len()) - 1]).filter(|value| !value.is_nan()))
}

/// ceil(q n), at least 1.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "q is between 0 and 1")]
fn rank(q: f64, n: usize) -> usize {
    let exact = q * n as f64;
    let whole = exact.round();
    let rank = if (exact - whole).abs() <= NEAR * whole { whole } else { exact.ceil() };
    (rank as usize).clamp(1, n)
}

/// From the best to the worst, draws without a value last.
fn sorted(values: &[f64], worse: Worse) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(|a, b| {
        let by_value = match worse {
            Worse::Higher => a.total_cmp(b),
            Worse::Lower => b.total_cmp(a),
        };
        a.is_nan().cmp(&b.is_nan()).then(by_value)
    });
    sorted
}

/// What replicates of a Latin hypercube or of Sobol points say together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Replicated {
    /// The mean of the replicates.
    pub mean: f64,
    /// Its standard error; none if all replicates agree, because then they do not tell how far off they are.
    pub standard_error: Option<f64>,
}

/// The estimate and standard error of a number that each replicate gives by itself.
///
/// # Errors
/// There are less than 16 replicates.
pub fn replicated(estimates: &[f64]) -> Result<Replicated, ProbabilityProblem> {
    let count = estimates.len() as f64;
    if estimates.len() < 16 {
        return Err(ProbabilityProblem::Parameter { of: "standard error", parameter: "replicates", value: count, limit: "at least 16" });
    }
    let mean = estimates.iter().sum::<f64>() / count;
    let squares: f64 = estimates.iter().map(|it| (it - mean) * (it - mean)).sum();
    let agree = estimates.iter().all(|it| *it == estimates[0]);
    let standard_error = libm::sqrt(squares / (count - 1.0) / count);
    Ok(Replicated { mean: if agree { estimates[0] } else { mean }, standard_error: Some(standard_error).filter(|_| !agree) })
}

/// The correlation of two columns of values after Pearson; none if one of them does not vary, or a value is absent.
///
/// # Panics
/// The columns do not have the same length.
pub fn pearson(x: &[f64], y: &[f64]) -> Option<f64> {
    assert_eq!(x.len(), y.len(), "both columns have a value in every draw");
    let (mean_x, mean_y) = (mean(x)?, mean(y)?);
    let sum = |of: &dyn Fn(f64, f64) -> f64| x.iter().zip(y).map(|(x, y)| of(x - mean_x, y - mean_y)).sum::<f64>();
    let (both, square_x, square_y) = (sum(&|x, y| x * y), sum(&|x, _| x * x), sum(&|_, y| y * y));
    Some(both / (libm::sqrt(square_x) * libm::sqrt(square_y))).filter(|it| it.is_finite()).map(|it| it.clamp(-1.0, 1.0))
}

/// The correlation of two columns after Spearman: that of their ranks, where equal values share their mean rank. None if one of them does
/// not vary, or a value is absent.
///
/// # Panics
/// The columns do not have the same length.
pub fn spearman(x: &[f64], y: &[f64]) -> Option<f64> {
    pearson(&ranks(x)?, &ranks(y)?)
}

fn ranks(values: &[f64]) -> Option<Vec<f64>> {
    if values.iter().any(|value| value.is_nan()) {
        return None;
    }
    let mut order: Vec<_> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    let mut first = 0;
    for equal in order.chunk_by(|&a, &b| values[a] == values[b]) {
        let mean_rank = first as f64 + 0.5 * (equal.len() - 1) as f64;
        equal.iter().for_each(|&place| ranks[place] = mean_rank);
        first += equal.len();
    }
    Some(ranks)
}
