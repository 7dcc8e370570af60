//! Quantities over the cases of one draw, and statistics over the draws, for single designs: the definition that columns agree with.

use super::super::spectrum::OverScenarios;
use super::cases::OperatingCases;
use super::statistic::{AskedQuantity, OverDraws};
use crate::models::Worse;
use crate::probability::{mean, quantile, sd, worst};

/// The worse of two values.
pub fn worse_of(worse: Worse, a: f64, b: f64) -> f64 {
    match worse {
        Worse::Higher => a.max(b),
        Worse::Lower => a.min(b),
    }
}

/// A quantity over the cases of one draw, from its values in each; none if it is absent in a case.
pub fn over_cases(asked: &AskedQuantity, cases: &OperatingCases, values: &[f64]) -> Option<f64> {
    if values.iter().any(|it| !it.is_finite()) {
        return None;
    }
    let start = asked.worse.least_bad();
    let result = match (asked.over, &cases.weights) {
        (OverScenarios::Worst, _) | (_, None) => values.iter().fold(start, |worst, &it| worse_of(asked.worse, worst, it)),
        (over, Some(weights)) => {
            let mut sums = vec![0.0; weights.sums];
            for (&(sum, weight), value) in weights.places.iter().zip(values) {
                sums[sum] += weight * value;
            }
            let of = |sum: f64| if over == OverScenarios::Mean { sum / weights.total } else { sum };
            sums.into_iter().map(of).fold(start, |worst, it| worse_of(asked.worse, worst, it))
        }
    };
    result.is_finite().then_some(result)
}

/// A statistic over the draws, one without a value being NaN.
pub fn over_draws(asked: &AskedQuantity, statistic: OverDraws, values: &[f64]) -> Option<f64> {
    let found = match statistic {
        OverDraws::Mean => mean(values),
        OverDraws::Sd => sd(values),
        OverDraws::Worst => worst(values, asked.worse),
        OverDraws::Quantile(share) => quantile(values, share, asked.worse).ok().flatten(),
    };
    // Without the sign of zero.
    found.filter(|it| it.is_finite()).map(|it| it + 0.0)
}

/// A quantity that does not depend on the draws: the worst of those draws that have a value.
pub fn of_any(asked: &AskedQuantity, values: &[f64]) -> Option<f64> {
    let present = values.iter().copied().filter(|it| !it.is_nan());
    present.reduce(|worst, it| worse_of(asked.worse, worst, it)).map(|it| it + 0.0)
}
