//! Distribution functions, densities and quantiles as intervals that surely hold the exact ones.
//!
//! Elementary functions of `libm` are off by less than an ULP and are moved outwards by four. Two functions have an error bound of their
//! own, each tested against numbers of many digits: the normal distribution function ([`normal_error`]) and the incomplete beta function
//! ([`beta_error`]). A quantile needs none: whatever finds it, the distribution function proves at its two ends that it lies between.

use super::distribution::{DiscreteStep, Distribution, Law};
use super::special::{Beta, DENSITY_AT_ZERO, normal_below, normal_quantile};
use crate::real::Real;
use crate::tape::{EVERYTHING, Interval};

/// What moves a value of `libm` outwards, relative.
const FUNCTION: f64 = 4.0 * f64::EPSILON;
/// Steps by which the ends of a quantile are sought; each is four times as wide as the one before.
const STEPS: usize = 600;

/// A probability that is known exactly: below a place, or above it, whichever is smaller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tail {
    /// At most about a half.
    pub share: f64,
    /// Is it above the place?
    pub is_upper: bool,
}

fn point(value: f64) -> Interval {
    Interval::point(value)
}

/// Numbers within a relative distance of a computed one.
fn about(value: f64, relative: f64) -> Interval {
    let off = value.abs() * relative + f64::MIN_POSITIVE;
    Interval::new(value - off, value + off)
}

/// A function of `libm` that increases.
fn increasing(of: Interval, function: impl Fn(f64) -> f64) -> Interval {
    if !of.is_finite() {
        return EVERYTHING;
    }
    Interval::new(about(function(of.low), FUNCTION).low, about(function(of.high), FUNCTION).high)
}

pub(super) fn exp(of: Interval) -> Interval {
    at_least_zero(increasing(of, libm::exp))
}

fn ln(of: Interval) -> Interval {
    if of.low > 0.0 { increasing(of, libm::log) } else { EVERYTHING }
}

/// A power of what is not negative, with an exponent above zero.
fn power(of: Interval, exponent: f64) -> Interval {
    increasing(at_least_zero(of), |it| libm::pow(it, exponent))
}

fn at_least_zero(it: Interval) -> Interval {
    if it.low >= 0.0 || it == EVERYTHING { it } else { Interval::new(0.0, it.high.max(0.0)) }
}

/// A probability: nothing beyond 0 and 1.
fn share(it: Interval) -> Interval {
    if it == EVERYTHING { Interval::new(0.0, 1.0) } else { Interval::new(it.low.clamp(0.0, 1.0), it.high.clamp(0.0, 1.0)) }
}

/// Relative error bound of [`normal_below`]: that of erfc, and that of its argument times how much it changes with it, z^2 + 1 in the
/// lower tail, less elsewhere.
pub(super) fn normal_error(z: f64) -> f64 {
    let tail = z.min(0.0);
    (tail * tail + 4.0) * f64::EPSILON
}

/// Relative error bound of [`Beta::below`]: its series ends at 1e-15 of the sum, and the logarithm of the beta function may have lost a
/// few of the last digits of parameters as large as these.
pub(super) fn beta_error(beta: &Beta) -> f64 {
    let (a, b) = beta.parameters();
    4e-13 + 1e-14 * (a + b)
}

/// The probability below a standard normal number.
pub(super) fn normal_share(z: f64) -> Interval {
    share(about(normal_below(z), normal_error(z)))
}

/// The probability below standard normal numbers.
fn normal_shares(z: Interval) -> Interval {
    Interval::new(normal_share(z.low).low, normal_share(z.high).high)
}

/// The density of the standard normal distribution.
pub(super) fn normal_density(z: Interval) -> Interval {
    point(DENSITY_AT_ZERO) * about(1.0, f64::EPSILON) * exp(z.squared() * point(-0.5))
}

/// The standard normal number with this probability beyond it.
pub(super) fn normal_score(tail: Tail) -> Interval {
    if tail.share <= 0.0 {
        return EVERYTHING;
    }
    let size = -normal_quantile(tail.share, 1.0 - tail.share);
    let slope = libm::exp(-0.5 * size * size) * DENSITY_AT_ZERO;
    let start = (2.0 * normal_error(-size) * tail.share / slope).abs() + f64::EPSILON * (1.0 + size.abs());
    let far = outermost(size, start, |it| normal_share(-it).high <= tail.share);
    let near = outermost(size, -start, |it| normal_share(-it).low >= tail.share);
    let score = Interval::new(near, far);
    if tail.is_upper || score == EVERYTHING { score } else { -score }
}

/// The first place on the way from `start` in steps of growing width at which a proof succeeds; where none does, infinity.
fn outermost(start: f64, step: f64, proves: impl Fn(f64) -> bool) -> f64 {
    let mut step = step;
    for _ in 0..STEPS {
        let place = start + step;
        if proves(place) {
            return place;
        }
        if !place.is_finite() {
            break;
        }
        step *= 4.0;
    }
    step.signum() * f64::INFINITY
}

/// A distribution, ready for intervals.
#[derive(Debug)]
pub struct Outward {
    distribution: Distribution,
    /// Probabilities below and above what a truncation leaves, and of that itself.
    cut: Option<[Interval; 3]>,
    /// No value is beyond.
    support: (f64, f64),
}

impl Outward {
    pub fn new(distribution: &Distribution) -> Self {
        let law = &distribution.shape;
        let (mut low, mut high) = support(law);
        let cut = distribution.cut.map(|cut| {
            (low, high) = (low.max(cut.from), high.min(cut.to));
            let (from, to) = (tails(law, cut.from), tails(law, cut.to));
            // Whichever of the two differences lost fewer digits.
            let kept = [to.0 - from.0, from.1 - to.1].map(share);
            let kept = if kept[0].width() <= kept[1].width() { kept[0] } else { kept[1] };
            [from.0, to.1, kept]
        });
        Self { distribution: distribution.clone(), cut, support: (low, high) }
    }

    /// Least and largest value, which may be infinite.
    pub fn support(&self) -> (f64, f64) {
        self.support
    }

    /// Mean and standard deviation if the value is a linear function of a standard normal number.
    pub fn linear(&self) -> Option<(f64, f64)> {
        match self.distribution.shape {
            Law::Normal { mean, sd } if self.cut.is_none() => Some((mean, sd)),
            _ => None,
        }
    }

    /// Single values, if there are nothing but these: each with bounds of the probability of it and all below.
    pub fn steps(&self) -> Option<Vec<(f64, f64, f64)>> {
        let Law::Discrete { steps, .. } = &self.distribution.shape else { return None };
        Some((0..steps.len()).map(|step| (steps[step].value, up_to(steps, step).low, up_to(steps, step).high)).collect())
    }

    /// Are there single values only?
    pub fn is_discrete(&self) -> bool {
        matches!(self.distribution.shape, Law::Discrete { .. })
    }

    /// Probabilities of the values up to x, and above.
    pub(super) fn tails(&self, x: f64) -> (Interval, Interval) {
        let (below, above) = tails(&self.distribution.shape, x);
        let Some([below_cut, above_cut, kept]) = self.cut else { return (below, above) };
        if x < self.support.0 {
            (point(0.0), point(1.0))
        } else if x >= self.support.1 {
            (point(1.0), point(0.0))
        } else {
            (share((below - below_cut) / kept), share((above - above_cut) / kept))
        }
    }

    /// A value that surely has at most this probability at or below it (`is_low`), or at least this.
    pub fn end(&self, tail: Tail, is_low: bool) -> f64 {
        let (below, above) = if tail.is_upper { (1.0 - tail.share, tail.share) } else { (tail.share, 1.0 - tail.share) };
        if let Law::Discrete { steps, .. } = &self.distribution.shape {
            return discrete_end(steps, tail, is_low);
        }
        let (least, largest) = self.support;
        let value = self.distribution.value(below, above);
        if !value.is_finite() {
            return if is_low { least } else { largest };
        }
        let scale = value.abs().max(if least.is_finite() { (value - least).abs() } else { 0.0 });
        let step = 4.0 * f64::EPSILON * scale + f64::MIN_POSITIVE;
        let proves = |x: f64| {
            let (below, above) = self.tails(x);
            match (tail.is_upper, is_low) {
                (false, true) => x <= least || below.high <= tail.share,
                (false, false) => x >= largest || below.low >= tail.share,
                (true, true) => x <= least || above.low >= tail.share,
                (true, false) => x >= largest || above.high <= tail.share,
            }
        };
        outermost(value, if is_low { -step } else { step }, proves).clamp(least, largest)
    }

    /// The density over a range of values.
    pub fn density(&self, x: Interval) -> Interval {
        let density = at_least_zero(density(&self.distribution.shape, x));
        self.cut.map_or(density, |[_, _, kept]| density / kept)
    }
}

fn discrete_end(steps: &[DiscreteStep], tail: Tail, is_low: bool) -> f64 {
    let below = if tail.is_upper { point(1.0) - point(tail.share) } else { point(tail.share) };
    let at = if is_low {
        (0..steps.len()).find(|&step| up_to(steps, step).high > below.low)
    } else {
        (0..steps.len()).find(|&step| up_to(steps, step).low >= below.high)
    };
    steps[at.unwrap_or(steps.len() - 1)].value
}

/// The probability of a value and all below. It is a quotient of sums of so many numbers.
fn up_to(steps: &[DiscreteStep], step: usize) -> Interval {
    if step + 1 == steps.len() {
        return point(1.0);
    }
    share(about(steps[step].up_to, 2.0 * (steps.len() + 2) as f64 * f64::EPSILON))
}

fn support(law: &Law) -> (f64, f64) {
    match law {
        Law::Uniform { from, to } | Law::Triangular { from, to, .. } | Law::Beta { from, to, .. } => (*from, *to),
        Law::Lognormal { .. } => (0.0, f64::INFINITY),
        Law::Weibull { from, .. } => (*from, f64::INFINITY),
        Law::Normal { .. } | Law::Gumbel { .. } => (f64::NEG_INFINITY, f64::INFINITY),
        Law::Discrete { steps, .. } => (steps[0].value, steps[steps.len() - 1].value),
    }
}

/// Mean and standard deviation of the logarithm.
fn of_logarithm(mean: f64, sd: f64) -> (Interval, Interval) {
    let variance = (point(sd) / point(mean)).squared().ln_1p();
    (ln(point(mean)) - point(0.5) * variance, variance.sqrt())
}

/// Probabilities at or below x, and above.
fn tails(law: &Law, x: f64) -> (Interval, Interval) {
    let (none, all) = (point(0.0), point(1.0));
    let (least, largest) = support(law);
    if x < least || x == f64::NEG_INFINITY {
        return (none, all);
    }
    if x >= largest {
        return (all, none);
    }
    let one_less = |it: Interval| share(point(1.0) - it);
    let normal = |z: Interval| if z == EVERYTHING { (share(z), share(z)) } else { (normal_shares(z), normal_shares(-z)) };
    let position = |from: f64, of: Interval| (of - point(from)) / (point(largest) - point(least));
    let at = point(x);
    match law {
        Law::Uniform { from, to } => (share(position(*from, at)), share((point(*to) - at) / (point(*to) - point(*from)))),
        Law::Normal { mean, sd } => normal((at - point(*mean)) / point(*sd)),
        Law::Lognormal { .. } if x <= 0.0 => (none, all),
        Law::Lognormal { mean, sd, .. } => {
            let (mu, sigma) = of_logarithm(*mean, *sd);
            normal((ln(at) - mu) / sigma)
        }
        &Law::Triangular { from, mode, to } => {
            let width = point(to) - point(from);
            if x < mode {
                let below = share((at - point(from)).squared() / width / (point(mode) - point(from)));
                (below, one_less(below))
            } else {
                let above = share((point(to) - at).squared() / width / (point(to) - point(mode)));
                (one_less(above), above)
            }
        }
        Law::Beta { unit, from, to } => {
            let width = point(*to) - point(*from);
            let (low, high) = (share((at - point(*from)) / width), share((point(*to) - at) / width));
            let mirrored = unit.mirrored();
            let of = |beta: &Beta, x: f64| share(about(beta.below(x), beta_error(beta)));
            let shares = |beta: &Beta, x: Interval| Interval::new(of(beta, x.low).low, of(beta, x.high).high);
            // The smaller probability has all its digits; the series of the larger has lost them.
            let (below, above) = (shares(unit, low), shares(&mirrored, high));
            if below.high <= above.low { (below, one_less(below)) } else { (one_less(above), above) }
        }
        Law::Weibull { shape, scale, from, .. } => {
            let powered = power((at - point(*from)) / point(*scale), *shape);
            if powered == EVERYTHING {
                return (share(powered), share(powered));
            }
            (share(-(-powered).exp_m1()), share(exp(-powered)))
        }
        Law::Gumbel { mode, scale } => {
            let rate = exp((point(*mode) - at) / point(*scale));
            if rate == EVERYTHING {
                return (share(rate), share(rate));
            }
            (share(exp(-rate)), share(-(-rate).exp_m1()))
        }
        Law::Discrete { steps, .. } => {
            let count = steps.partition_point(|step| step.value <= x);
            let below = if count == 0 { none } else { up_to(steps, count - 1) };
            (below, one_less(below))
        }
    }
}

/// The density before truncation, over values within the support.
fn density(law: &Law, x: Interval) -> Interval {
    if !x.is_finite() {
        return EVERYTHING;
    }
    let one = point(1.0);
    // Of a number from 0 to 1 to this power, which may be negative.
    let raised = |it: Interval, exponent: f64| {
        if exponent == 0.0 {
            one
        } else if exponent > 0.0 {
            power(it, exponent)
        } else if it.low > 0.0 {
            one / power(it, -exponent)
        } else {
            EVERYTHING
        }
    };
    match law {
        Law::Uniform { from, to } => one / (point(*to) - point(*from)),
        Law::Normal { mean, sd } => normal_density((x - point(*mean)) / point(*sd)) / point(*sd),
        Law::Lognormal { mean, sd, .. } => {
            let (mu, sigma) = of_logarithm(*mean, *sd);
            normal_density((ln(x) - mu) / sigma) / (sigma * x)
        }
        &Law::Triangular { from, mode, to } => {
            let width = point(to) - point(from);
            let at = |x: f64| {
                let side = if x < mode { (point(x) - point(from)) / (point(mode) - point(from)) } else { one };
                let other = if x > mode { (point(to) - point(x)) / (point(to) - point(mode)) } else { one };
                at_least_zero(point(2.0) * side * other / width)
            };
            let ends = at(x.low.clamp(from, to)).hull(at(x.high.clamp(from, to)));
            if x.contains(mode) { ends.hull(at(mode)) } else { ends }
        }
        Law::Beta { unit, from, to } => {
            let width = point(*to) - point(*from);
            let (a, b) = unit.parameters();
            let low = share((x - point(*from)) / width);
            let high = share((point(*to) - x) / width);
            let scale = about(libm::exp(-unit.ln_beta()), beta_error(unit));
            raised(low, a - 1.0) * raised(high, b - 1.0) * scale / width
        }
        Law::Weibull { shape, scale, from, .. } => {
            let t = at_least_zero((x - point(*from)) / point(*scale));
            point(*shape) / point(*scale) * raised(t, shape - 1.0) * exp(-power(t, *shape))
        }
        Law::Gumbel { mode, scale } => {
            let rate = exp((point(*mode) - x) / point(*scale));
            rate * exp(-rate) / point(*scale)
        }
        Law::Discrete { .. } => EVERYTHING,
    }
}

#[cfg(test)]
mod tests;
