//! Quantiles of the standard normal and the beta distribution, each from the probability of the nearer tail, where it has all its digits.
//!
//! Elementary functions are those of `libm`, so that every machine draws the same numbers.

use special::Beta as _;
use std::f64::consts::SQRT_2;

/// 1/sqrt(2 pi).
pub const DENSITY_AT_ZERO: f64 = 0.398_942_280_401_432_7;

/// The probability that a standard normal number lies below `z`.
pub fn normal_below(z: f64) -> f64 {
    0.5 * libm::erfc(-z / SQRT_2)
}

/// The density of the standard normal distribution.
pub fn normal_density(z: f64) -> f64 {
    DENSITY_AT_ZERO * libm::exp(-0.5 * z * z)
}

/// The standard normal number with the probability `below` it and `above` it; the smaller of the two decides.
///
/// It begins with formula 26.2.23 of Abramowitz and Stegun (1964), which is right to 4.5e-4, and goes on by Newton's method for the
/// logarithm of the probability. That logarithm is concave, so each step squares the error.
pub fn normal_quantile(below: f64, above: f64) -> f64 {
    let (tail, sign) = if below <= above { (below, -1.0) } else { (above, 1.0) };
    if tail <= 0.0 {
        return sign * f64::INFINITY;
    }
    let t = libm::sqrt(-2.0 * libm::log(tail));
    let mut z = t - (2.515_517 + t * (0.802_853 + t * 0.010_328)) / (1.0 + t * (1.432_788 + t * (0.189_269 + t * 0.001_308)));
    for _ in 0..4 {
        let reached = normal_below(-z);
        let step = libm::log1p((reached - tail) / tail) * reached / normal_density(z);
        z += step;
        if libm::fabs(step) <= 1e-9 {
            break;
        }
    }
    sign * z
}

/// The incomplete beta function: probabilities and quantiles of the beta distribution on 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beta {
    alpha: f64,
    beta: f64,
    ln_beta: f64,
}

impl Beta {
    /// With both parameters above 0.
    pub fn new(alpha: f64, beta: f64) -> Self {
        Self { alpha, beta, ln_beta: ln_beta(alpha, beta) }
    }

    /// The two parameters.
    pub fn parameters(&self) -> (f64, f64) {
        (self.alpha, self.beta)
    }

    /// The logarithm of the beta function of the two parameters.
    pub fn ln_beta(&self) -> f64 {
        self.ln_beta
    }

    /// The distribution of 1 less such a number.
    pub fn mirrored(&self) -> Self {
        Self { alpha: self.beta, beta: self.alpha, ln_beta: self.ln_beta }
    }

    /// The probability below `x`.
    pub fn below(&self, x: f64) -> f64 {
        x.clamp(0.0, 1.0).inc_beta(self.alpha, self.beta, self.ln_beta)
    }

    /// The number with the probability `tail` below it; for tails of at most about a half.
    ///
    /// Near zero the probability is a power of the number, so Newton's method works on the logarithms of both, between bounds that it
    /// narrows.
    pub fn lower_quantile(&self, tail: f64) -> f64 {
        if tail <= 0.0 {
            return 0.0;
        }
        let (mut low, mut high) = (0.0, 1.0);
        let power = libm::exp((libm::log(tail * self.alpha) + self.ln_beta) / self.alpha);
        let mut x = if power < 0.9 { power } else { self.alpha / (self.alpha + self.beta) };
        for _ in 0..200 {
            let reached = self.below(x);
            if reached < tail {
                low = x;
            } else {
                high = x;
            }
            let ln_density = (self.alpha - 1.0) * libm::log(x) + (self.beta - 1.0) * libm::log1p(-x) - self.ln_beta;
            let step = libm::log(reached / tail) * reached / (x * libm::exp(ln_density));
            let newton = x * libm::exp(-step);
            let next = if newton > low && newton < high {
                newton
            } else if low > 0.0 && high / low > 4.0 {
                libm::sqrt(low) * libm::sqrt(high)
            } else if low > 0.0 || high < 1e-290 {
                0.5 * (low + high)
            } else {
                high * 1e-3
            };
            if libm::fabs(next - x) <= 2.0 * f64::EPSILON * x {
                return next;
            }
            x = next;
        }
        x
    }
}

/// The logarithm of the beta function. Where both numbers are large the logarithms of three gamma functions would cancel, so it is taken
/// from Stirling's series.
fn ln_beta(a: f64, b: f64) -> f64 {
    const LARGE: f64 = 10.0;
    const HALF_LN_TWO_PI: f64 = 0.918_938_533_204_672_7;
    if a.min(b) < LARGE {
        let (small, large) = (a.min(b), a.max(b));
        if large < LARGE * 10.0 {
            return small.ln_beta(large);
        }
        // ln of gamma(large) / gamma(large + small), again without the large parts of both.
        let ratio = -(large - 0.5) * libm::log1p(small / large) - small * libm::log(large + small) + small + stirling(large)
            - stirling(large + small);
        return libm::lgamma(small) + ratio;
    }
    HALF_LN_TWO_PI - 0.5 * libm::log(b) - (a - 0.5) * libm::log1p(b / a) - b * libm::log1p(a / b) + stirling(a) + stirling(b)
        - stirling(a + b)
}

/// What ln gamma(x) has beyond (x - 1/2) ln x - x + ln(2 pi)/2, for x of 10 and more.
fn stirling(x: f64) -> f64 {
    let square = 1.0 / (x * x);
    let series = [1.0 / 12.0, -1.0 / 360.0, 1.0 / 1260.0, -1.0 / 1680.0, 1.0 / 1188.0, -691.0 / 360_360.0, 1.0 / 156.0];
    series.iter().rev().fold(0.0, |sum, term| sum * square + term) / x
}
