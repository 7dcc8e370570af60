//! A distribution as a study gives it.

use crate::probability::{Distribution, ProbabilityProblem};
use crate::table::{brief, short};
use serde::{Deserialize, Serialize};

/// A distribution by name and parameters, each in the unit of the input, or a plain number for a factor or a shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs, reason = "the parameters are those of the constructors of Distribution")]
pub enum NamedLaw {
    Uniform { from: f64, to: f64 },
    Normal { mean: f64, sd: f64 },
    Lognormal { mean: f64, sd: f64 },
    Triangular { from: f64, mode: f64, to: f64 },
    Beta { alpha: f64, beta: f64, from: f64, to: f64 },
    Weibull { shape: f64, scale: f64, from: f64 },
    Gumbel { mode: f64, scale: f64 },
    Exponential { mean: f64 },
    Discrete { values: Vec<f64>, weights: Vec<f64> },
    Empirical { values: Vec<f64> },
}

/// Values of a list that are named one by one.
const NAMED: usize = 4;

impl NamedLaw {
    /// The parameters as the study gives them.
    pub(super) fn parameters(&self) -> String {
        let each = |parameters: &[(&str, f64)]| {
            let told = parameters.iter().map(|(name, value)| format!("{name} {}", short(*value)));
            told.collect::<Vec<_>>().join(", ")
        };
        match self {
            Self::Uniform { from, to } => format!("from {} to {}", short(*from), short(*to)),
            Self::Normal { mean, sd } | Self::Lognormal { mean, sd } => each(&[("mean", *mean), ("sd", *sd)]),
            Self::Triangular { from, mode, to } => each(&[("from", *from), ("mode", *mode), ("to", *to)]),
            Self::Beta { alpha, beta, from, to } => each(&[("alpha", *alpha), ("beta", *beta), ("from", *from), ("to", *to)]),
            Self::Weibull { shape, scale, from } if *from == 0.0 => each(&[("shape", *shape), ("scale", *scale)]),
            Self::Weibull { shape, scale, from } => each(&[("shape", *shape), ("scale", *scale), ("from", *from)]),
            Self::Gumbel { mode, scale } => each(&[("mode", *mode), ("scale", *scale)]),
            Self::Exponential { mean } => each(&[("mean", *mean)]),
            Self::Discrete { values, weights } if values.len() <= NAMED => {
                let sum: f64 = weights.iter().sum();
                let told =
                    values.iter().zip(weights).map(|(value, weight)| format!("{} ({} %)", short(*value), brief(100.0 * weight / sum)));
                told.collect::<Vec<_>>().join(", ")
            }
            Self::Empirical { values } if values.len() <= NAMED => values.iter().map(|it| short(*it)).collect::<Vec<_>>().join(", "),
            Self::Discrete { values, .. } | Self::Empirical { values } => {
                let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &it| (low.min(it), high.max(it)));
                format!("of {} values from {} to {}", values.len(), short(low), short(high))
            }
        }
    }
}

/// A distribution and where it is cut off.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LawText {
    /// The distribution before it is cut off.
    pub law: NamedLaw,
    /// Values below are left out.
    pub from: Option<f64>,
    /// Values above are left out.
    pub to: Option<f64>,
}

impl LawText {
    /// The distribution itself.
    ///
    /// # Errors
    /// What is wrong with its parameters.
    pub fn distribution(&self) -> Result<Distribution, ProbabilityProblem> {
        let whole = match &self.law {
            NamedLaw::Uniform { from, to } => Distribution::uniform(*from, *to),
            NamedLaw::Normal { mean, sd } => Distribution::normal(*mean, *sd),
            NamedLaw::Lognormal { mean, sd } => Distribution::lognormal(*mean, *sd),
            NamedLaw::Triangular { from, mode, to } => Distribution::triangular(*from, *mode, *to),
            NamedLaw::Beta { alpha, beta, from, to } => Distribution::beta(*alpha, *beta, *from, *to),
            NamedLaw::Weibull { shape, scale, from } => Distribution::weibull(*shape, *scale, *from),
            NamedLaw::Gumbel { mode, scale } => Distribution::gumbel(*mode, *scale),
            NamedLaw::Exponential { mean } => Distribution::exponential(*mean),
            NamedLaw::Discrete { values, weights } => Distribution::discrete(values, weights),
            NamedLaw::Empirical { values } => Distribution::empirical(values),
        }?;
        if self.from.is_none() && self.to.is_none() {
            return Ok(whole);
        }
        whole.truncated(self.from.unwrap_or(f64::NEG_INFINITY), self.to.unwrap_or(f64::INFINITY))
    }

    /// Where it is cut off; nothing if it is not.
    pub(super) fn cut_in_words(&self) -> String {
        let ends = [("below", self.from), ("above", self.to)];
        let ends: Vec<String> = ends.iter().filter_map(|(word, end)| Some(format!("{word} {}", short((*end)?)))).collect();
        if ends.is_empty() { String::new() } else { format!(", cut off {}", ends.join(" and ")) }
    }

    /// Its name.
    pub fn name(&self) -> &'static str {
        match self.law {
            NamedLaw::Uniform { .. } => "uniform",
            NamedLaw::Normal { .. } => "normal",
            NamedLaw::Lognormal { .. } => "lognormal",
            NamedLaw::Triangular { .. } => "triangular",
            NamedLaw::Beta { .. } => "beta",
            NamedLaw::Weibull { .. } => "weibull",
            NamedLaw::Gumbel { .. } => "gumbel",
            NamedLaw::Exponential { .. } => "exponential",
            NamedLaw::Discrete { .. } => "discrete",
            NamedLaw::Empirical { .. } => "empirical",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_told_as_they_are_given() {
        let told = |law: NamedLaw| law.parameters();
        assert_eq!(told(NamedLaw::Uniform { from: 0.98, to: 1.02 }), "from 0.98 to 1.02");
        assert_eq!(told(NamedLaw::Lognormal { mean: 200_000.0, sd: 2000.0 }), "mean 200000, sd 2000");
        assert_eq!(told(NamedLaw::Weibull { shape: 80.0, scale: 800.0, from: 0.0 }), "shape 80, scale 800");
        assert_eq!(told(NamedLaw::Weibull { shape: 80.0, scale: 800.0, from: 300.0 }), "shape 80, scale 800, from 300");
        assert_eq!(told(NamedLaw::Discrete { values: vec![1450.0, 2950.0], weights: vec![3.0, 1.0] }), "1450 (75 %), 2950 (25 %)");
        assert_eq!(told(NamedLaw::Empirical { values: vec![5.0, 1.0, 2.0, 1.5, 3.0] }), "of 5 values from 1 to 5");
        let cut = LawText { law: NamedLaw::Normal { mean: 0.08, sd: 0.005 }, from: Some(0.06), to: Some(0.1) };
        assert_eq!(cut.cut_in_words(), ", cut off below 0.06 and above 0.1");
    }
}
