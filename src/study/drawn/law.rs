//! A distribution as a study gives it.

use crate::probability::{Distribution, ProbabilityProblem};
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
