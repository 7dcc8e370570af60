//! Distributions: how likely the values of an uncertain number are.

use super::moments::Moments;
use super::problem::ProbabilityProblem;
use super::special::{Beta, normal_below, normal_quantile};
use std::f64::consts::PI;

/// A truncation must leave this much probability: less is taken for a mistake in units.
const LEAST_KEPT: f64 = 1e-9;
/// Euler's constant.
const EULER: f64 = 0.577_215_664_901_532_9;

/// How likely the values of an uncertain number are.
///
/// Parameters describe the distribution before [truncation](Self::truncated). Each is in the unit of the number, or a plain number for a
/// shape; a parameter that is no finite number is an error, as is what each constructor names.
#[derive(Clone, Debug, PartialEq)]
pub struct Distribution {
    pub(super) shape: Law,
    pub(super) cut: Option<Truncation>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Law {
    Uniform { from: f64, to: f64 },
    Normal { mean: f64, sd: f64 },
    Lognormal { mean: f64, sd: f64, mu: f64, sigma: f64 },
    Triangular { from: f64, mode: f64, to: f64 },
    Beta { unit: Beta, from: f64, to: f64 },
    Weibull { name: &'static str, shape: f64, scale: f64, from: f64 },
    Gumbel { mode: f64, scale: f64 },
    Discrete { name: &'static str, steps: Vec<DiscreteStep> },
}

/// A value of a discrete distribution and the probability of it and all below; the last has 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DiscreteStep {
    pub(super) value: f64,
    weight: f64,
    pub(super) up_to: f64,
}

/// A truncation, with the probabilities below, above and between its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Truncation {
    pub(super) from: f64,
    pub(super) to: f64,
    below: f64,
    above: f64,
    kept: f64,
}

fn parameter(of: &'static str, parameter: &'static str, value: f64, fits: bool, limit: &'static str) -> Result<(), ProbabilityProblem> {
    if value.is_finite() && fits { Ok(()) } else { Err(ProbabilityProblem::Parameter { of, parameter, value, limit }) }
}

fn finite(of: &'static str, name: &'static str, value: f64) -> Result<(), ProbabilityProblem> {
    parameter(of, name, value, value.abs() <= 1e150, "a number between -1e150 and 1e150")
}

fn positive(of: &'static str, name: &'static str, value: f64) -> Result<(), ProbabilityProblem> {
    parameter(of, name, value, (1e-150..=1e150).contains(&value), "above 0 (1e-150 to 1e150)")
}

fn ordered(of: &'static str, (lower, below): (&'static str, f64), (upper, above): (&'static str, f64)) -> Result<(), ProbabilityProblem> {
    finite(of, lower, below)?;
    finite(of, upper, above)?;
    if below < above { Ok(()) } else { Err(ProbabilityProblem::Order { of, lower, below, upper, above }) }
}

impl Distribution {
    fn of(shape: Law) -> Self {
        Self { shape, cut: None }
    }

    /// Every value between two is equally likely.
    ///
    /// # Errors
    /// `from` is not below `to`.
    pub fn uniform(from: f64, to: f64) -> Result<Self, ProbabilityProblem> {
        ordered("uniform", ("from", from), ("to", to))?;
        Ok(Self::of(Law::Uniform { from, to }))
    }

    /// The normal distribution.
    ///
    /// # Errors
    /// `sd` is not above 0.
    pub fn normal(mean: f64, sd: f64) -> Result<Self, ProbabilityProblem> {
        finite("normal", "mean", mean)?;
        positive("normal", "sd", sd)?;
        Ok(Self::of(Law::Normal { mean, sd }))
    }

    /// The lognormal distribution, by the mean and standard deviation of the value itself, not of its logarithm.
    ///
    /// # Errors
    /// `mean` or `sd` is not above 0, or `sd` is above 1000 times the mean.
    pub fn lognormal(mean: f64, sd: f64) -> Result<Self, ProbabilityProblem> {
        positive("lognormal", "mean", mean)?;
        positive("lognormal", "sd", sd)?;
        let relative = sd / mean;
        parameter("lognormal", "sd", sd, relative <= 1000.0, "at most 1000 times the mean")?;
        let variance = libm::log1p(relative * relative);
        Ok(Self::of(Law::Lognormal { mean, sd, mu: libm::log(mean) - 0.5 * variance, sigma: libm::sqrt(variance) }))
    }

    /// The triangular distribution: no value beyond two ends, and the most likely one, which may be an end.
    ///
    /// # Errors
    /// `from` is not below `to`, or `mode` is not between them.
    pub fn triangular(from: f64, mode: f64, to: f64) -> Result<Self, ProbabilityProblem> {
        ordered("triangular", ("from", from), ("to", to))?;
        parameter("triangular", "mode", mode, (from..=to).contains(&mode), "between from and to")?;
        Ok(Self::of(Law::Triangular { from, mode, to }))
    }

    /// The beta distribution with the shapes `alpha` and `beta`, stretched from 0 to 1 to the range `from` to `to`.
    ///
    /// # Errors
    /// A shape is not between 0.01 and 1e6, or `from` is not below `to`.
    pub fn beta(alpha: f64, beta: f64, from: f64, to: f64) -> Result<Self, ProbabilityProblem> {
        parameter("beta", "alpha", alpha, (0.01..=1e6).contains(&alpha), "between 0.01 and 1e6")?;
        parameter("beta", "beta", beta, (0.01..=1e6).contains(&beta), "between 0.01 and 1e6")?;
        ordered("beta", ("from", from), ("to", to))?;
        Ok(Self::of(Law::Beta { unit: Beta::new(alpha, beta), from, to }))
    }

    /// The Weibull distribution of values above `from`: of these, exp(-((x - from)/scale)^shape) lie above x.
    ///
    /// # Errors
    /// `shape` is not between 0.1 and 1000, or `scale` is not above 0.
    pub fn weibull(shape: f64, scale: f64, from: f64) -> Result<Self, ProbabilityProblem> {
        parameter("weibull", "shape", shape, (0.1..=1000.0).contains(&shape), "between 0.1 and 1000")?;
        positive("weibull", "scale", scale)?;
        finite("weibull", "from", from)?;
        Ok(Self::of(Law::Weibull { name: "weibull", shape, scale, from }))
    }

    /// The Gumbel distribution of maxima, such as the highest load of a year: exp(-exp(-(x - mode)/scale)) of the values lie below x.
    ///
    /// # Errors
    /// `scale` is not above 0.
    pub fn gumbel(mode: f64, scale: f64) -> Result<Self, ProbabilityProblem> {
        finite("gumbel", "mode", mode)?;
        positive("gumbel", "scale", scale)?;
        Ok(Self::of(Law::Gumbel { mode, scale }))
    }

    /// The exponential distribution of values above 0.
    ///
    /// # Errors
    /// `mean` is not above 0.
    pub fn exponential(mean: f64) -> Result<Self, ProbabilityProblem> {
        positive("exponential", "mean", mean)?;
        Ok(Self::of(Law::Weibull { name: "exponential", shape: 1.0, scale: mean, from: 0.0 }))
    }

    /// Single values, each with a weight; the weights need not add up to 1.
    ///
    /// # Errors
    /// There are no values, or not as many weights, or a weight is negative, or all are 0.
    pub fn discrete(values: &[f64], weights: &[f64]) -> Result<Self, ProbabilityProblem> {
        if values.len() != weights.len() {
            return Err(ProbabilityProblem::Weights { values: values.len(), weights: weights.len() });
        }
        for &weight in weights {
            parameter("discrete", "weight", weight, (0.0..=1e150).contains(&weight), "between 0 and 1e150")?;
        }
        Self::stepped("discrete", values.iter().copied().zip(weights.iter().copied()).collect())
    }

    /// Measured values, each as likely as every other.
    ///
    /// # Errors
    /// There are no values.
    pub fn empirical(values: &[f64]) -> Result<Self, ProbabilityProblem> {
        Self::stepped("empirical", values.iter().map(|&value| (value, 1.0)).collect())
    }

    fn stepped(name: &'static str, mut pairs: Vec<(f64, f64)>) -> Result<Self, ProbabilityProblem> {
        if pairs.is_empty() {
            return Err(ProbabilityProblem::NoValues { of: name });
        }
        for &(value, _) in &pairs {
            finite(name, "value", value)?;
        }
        pairs.retain(|&(_, weight)| weight > 0.0);
        // Weights of equal values are added in the order of their size, so that the order of rows does not matter.
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        Ok(Self::of(Law::Discrete { name, steps: steps(&pairs).ok_or(ProbabilityProblem::NoWeight)? }))
    }

    /// This distribution, given that the value lies between `from` and `to`, both included; infinite ends are none.
    ///
    /// # Errors
    /// `from` is not below `to`, or less than 1e-9 of the probability lies between them.
    pub fn truncated(self, from: f64, to: f64) -> Result<Self, ProbabilityProblem> {
        let of = self.name();
        if from.is_nan() || to.is_nan() || from >= to {
            return Err(ProbabilityProblem::Order { of, lower: "from", below: from, upper: "to", above: to });
        }
        // Truncated once more, a distribution has the narrower of both ranges.
        let (from, to) = self.cut.map_or((from, to), |cut| (from.max(cut.from), to.min(cut.to)));
        let (below, _) = shape_tails(&self.shape, from);
        let (below_to, above) = shape_tails(&self.shape, to);
        let (_, above_from) = shape_tails(&self.shape, from);
        // The tails are small numbers with all their digits: the difference is taken of those on the side where the range lies.
        let kept = if from >= to {
            0.0
        } else if below_to <= above_from {
            below_to - below
        } else {
            (above_from - above).min(1.0 - below - above).max(0.0)
        };
        let empty = |kept| ProbabilityProblem::Truncation { of, from, to, kept };
        match self.shape {
            Law::Discrete { name, steps: all } => {
                let inside: Vec<_> = all.iter().map(|it| (it.value, it.weight)).filter(|it| (from..=to).contains(&it.0)).collect();
                let kept = inside.iter().map(|it| it.1).sum::<f64>() / all.iter().map(|it| it.weight).sum::<f64>();
                let steps = steps(&inside).filter(|_| kept >= LEAST_KEPT).ok_or(empty(kept))?;
                Ok(Self::of(Law::Discrete { name, steps }))
            }
            _ if kept < LEAST_KEPT => Err(empty(kept)),
            Law::Uniform { from: lowest, to: highest } => Self::uniform(from.max(lowest), to.min(highest)),
            shape => Ok(Self { shape, cut: Some(Truncation { from, to, below, above, kept }) }),
        }
    }

    /// Its name, as in messages.
    fn name(&self) -> &'static str {
        match self.shape {
            Law::Uniform { .. } => "uniform",
            Law::Normal { .. } => "normal",
            Law::Lognormal { .. } => "lognormal",
            Law::Triangular { .. } => "triangular",
            Law::Beta { .. } => "beta",
            Law::Gumbel { .. } => "gumbel",
            Law::Weibull { name, .. } | Law::Discrete { name, .. } => name,
        }
    }

    /// The probability of `x` and everything below.
    pub fn cdf(&self, x: f64) -> f64 {
        let (below, above) = shape_tails(&self.shape, x);
        let Some(cut) = self.cut else { return below };
        if x < cut.from {
            0.0
        } else if x >= cut.to {
            1.0
        } else if below <= above {
            ((below - cut.below) / cut.kept).clamp(0.0, 1.0)
        } else {
            (1.0 - (above - cut.above) / cut.kept).clamp(0.0, 1.0)
        }
    }

    /// The least value that has the probability `p` at or below it, from 0 to 1. At 0 and 1 it may be infinite.
    ///
    /// # Errors
    /// `p` is not between 0 and 1.
    pub fn quantile(&self, p: f64) -> Result<f64, ProbabilityProblem> {
        parameter("quantile", "probability", p, (0.0..=1.0).contains(&p), "between 0 and 1")?;
        Ok(self.value(p, 1.0 - p))
    }

    /// The value with the probability `below` it and `above` it, which add up to 1: the smaller has all its digits.
    pub(super) fn value(&self, below: f64, above: f64) -> f64 {
        match self.cut {
            None => shape_value(&self.shape, below, above),
            Some(cut) => shape_value(&self.shape, cut.below + below * cut.kept, cut.above + above * cut.kept).clamp(cut.from, cut.to),
        }
    }

    /// The mean, after truncation.
    pub fn mean(&self) -> f64 {
        self.moments().mean
    }

    /// The standard deviation, after truncation.
    pub fn sd(&self) -> f64 {
        self.moments().sd
    }

    fn moments(&self) -> Moments {
        let cut = self.cut.map(|cut| (cut.from, cut.to));
        match (&self.shape, cut) {
            (Law::Uniform { from, to }, _) => Moments { mean: from + 0.5 * (to - from), sd: (to - from) / libm::sqrt(12.0) },
            (&Law::Normal { mean, sd } | &Law::Lognormal { mean, sd, .. }, None) => Moments { mean, sd },
            (&Law::Triangular { from, mode, to }, _) => {
                let (lowest, highest) = cut.map_or((from, to), |cut| (cut.0.max(from), cut.1.min(to)));
                Moments::of_triangle([from, mode, to], lowest, highest)
            }
            (&Law::Gumbel { mode, scale }, None) => Moments { mean: mode + EULER * scale, sd: PI * scale / libm::sqrt(6.0) },
            (Law::Beta { unit, from, to }, None) => {
                let (alpha, beta) = unit.parameters();
                let (sum, width) = (alpha + beta, to - from);
                let sd = libm::sqrt(alpha / sum * (beta / sum) / (sum + 1.0));
                Moments { mean: from + width * (alpha / sum), sd: width * sd }
            }
            (Law::Discrete { steps, .. }, _) => Moments::of_weighted(|| steps.iter().map(|it| (it.value, it.weight))),
            _ => Moments::of_values(|below, above| self.value(below, above)),
        }
    }
}

/// Values with weights above zero, in rising order, with equal values joined; none if there are none.
fn steps(pairs: &[(f64, f64)]) -> Option<Vec<DiscreteStep>> {
    let mut steps: Vec<DiscreteStep> = Vec::new();
    let mut sum = 0.0;
    for &(value, weight) in pairs {
        sum += weight;
        match steps.last_mut().filter(|last| last.value == value) {
            Some(last) => (last.weight, last.up_to) = (last.weight + weight, sum),
            None => steps.push(DiscreteStep { value, weight, up_to: sum }),
        }
    }
    for step in &mut steps {
        step.up_to /= sum;
    }
    Some(steps).filter(|steps| !steps.is_empty())
}

/// The probabilities at or below `x`, and above.
fn shape_tails(shape: &Law, x: f64) -> (f64, f64) {
    let normal = |z: f64| (normal_below(z), normal_below(-z));
    match shape {
        Law::Uniform { from, to } => {
            let x = x.clamp(*from, *to);
            ((x - from) / (to - from), (to - x) / (to - from))
        }
        Law::Normal { mean, sd } => normal((x - mean) / sd),
        Law::Lognormal { mu, sigma, .. } => normal((libm::log(x.max(0.0)) - mu) / sigma),
        &Law::Triangular { from, mode, to } => {
            let (x, width) = (x.clamp(from, to), to - from);
            if x < mode {
                let below = (x - from) / width * ((x - from) / (mode - from));
                (below, 1.0 - below)
            } else {
                let above = if x == to { 0.0 } else { (to - x) / width * ((to - x) / (to - mode)) };
                (1.0 - above, above)
            }
        }
        Law::Beta { unit, from, to } => {
            let x = x.clamp(*from, *to);
            (unit.below((x - from) / (to - from)), unit.mirrored().below((to - x) / (to - from)))
        }
        Law::Weibull { shape, scale, from, .. } => {
            let power = libm::pow((x - from).max(0.0) / scale, *shape);
            (-libm::expm1(-power), libm::exp(-power))
        }
        Law::Gumbel { mode, scale } => {
            let rate = libm::exp(-(x - mode) / scale);
            (libm::exp(-rate), -libm::expm1(-rate))
        }
        Law::Discrete { steps, .. } => {
            let below = steps[..steps.partition_point(|step| step.value <= x)].last().map_or(0.0, |step| step.up_to);
            (below, 1.0 - below)
        }
    }
}

/// The least value with the probability `below` at or below it; the smaller of the two probabilities decides.
fn shape_value(shape: &Law, below: f64, above: f64) -> f64 {
    let lower = below <= above;
    match shape {
        Law::Uniform { from, to } => {
            let value = if lower { from + below * (to - from) } else { to - above * (to - from) };
            value.clamp(*from, *to)
        }
        Law::Normal { mean, sd } => mean + sd * normal_quantile(below, above),
        Law::Lognormal { mu, sigma, .. } => libm::exp(mu + sigma * normal_quantile(below, above)),
        &Law::Triangular { from, mode, to } => {
            let width = to - from;
            if below <= (mode - from) / width {
                (from + libm::sqrt(below * (mode - from) / width) * width).min(mode)
            } else {
                (to - libm::sqrt(above * (to - mode) / width) * width).max(mode)
            }
        }
        Law::Beta { unit, from, to } => {
            let width = to - from;
            let value = if lower { from + width * unit.lower_quantile(below) } else { to - width * unit.mirrored().lower_quantile(above) };
            value.clamp(*from, *to)
        }
        Law::Weibull { shape, scale, from, .. } => {
            let power = if lower { -libm::log1p(-below) } else { -libm::log(above) };
            from + scale * libm::pow(power, 1.0 / shape)
        }
        Law::Gumbel { mode, scale } => {
            let rate = if lower { -libm::log(below) } else { -libm::log1p(-above) };
            mode - scale * libm::log(rate)
        }
        Law::Discrete { steps, .. } => steps[steps.partition_point(|step| step.up_to < below).min(steps.len() - 1)].value,
    }
}
