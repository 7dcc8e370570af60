//! How sure a share of draws is.

use super::problem::ProbabilityProblem;
use super::special::Beta;

/// A range that holds the truth with a stated confidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConfidenceInterval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// The interval of Clopper and Pearson (1934) for the probability that a draw holds, where `holds` of `draws` independent draws did.
///
/// It contains the true probability at least as often as `confidence` says, whatever the probability. That is so only if number and seed
/// of the draws were fixed beforehand, and if they are not the draws by which the design was chosen.
///
/// ```
/// use beltspace::probability::clopper_pearson;
///
/// // All of 4096 draws hold: no more than 99.91 % is sure.
/// let yield_range = clopper_pearson(4096, 4096, 0.95)?;
/// assert!((yield_range.low - 0.9991).abs() < 1e-5 && yield_range.high == 1.0);
/// # Ok::<(), beltspace::Error>(())
/// ```
///
/// # Errors
/// There are no draws, more hold than there are, or `confidence` is not between 0 and 1.
pub fn clopper_pearson(holds: u64, draws: u64, confidence: f64) -> Result<ConfidenceInterval, ProbabilityProblem> {
    simultaneous(holds, draws, confidence, 1)
}

/// The same for one of `number` designs: with the probability `confidence` the intervals of all of them hold together (Bonferroni).
///
/// # Errors
/// As [`clopper_pearson`]; or `number` is 0.
pub fn simultaneous(holds: u64, draws: u64, confidence: f64, number: u64) -> Result<ConfidenceInterval, ProbabilityProblem> {
    let wrong = |parameter, value, limit| Err(ProbabilityProblem::Parameter { of: "confidence", parameter, value, limit });
    if !(1..=1_000_000_000).contains(&draws) {
        return wrong("draws", draws as f64, "between 1 and 1e9");
    }
    if holds > draws {
        return wrong("holds", holds as f64, "at most the number of draws");
    }
    if !(confidence > 0.0 && confidence < 1.0) {
        return wrong("confidence", confidence, "above 0 and below 1");
    }
    if number == 0 {
        return wrong("number", 0.0, "at least 1");
    }
    let tail = (1.0 - confidence) / number as f64 / 2.0;
    let (kept, missed) = (holds as f64, (draws - holds) as f64);
    let low = if holds == 0 { 0.0 } else { Beta::new(kept, missed + 1.0).lower_quantile(tail) };
    let high = if holds == draws { 1.0 } else { 1.0 - Beta::new(missed, kept + 1.0).lower_quantile(tail) };
    Ok(ConfidenceInterval { low, high })
}
