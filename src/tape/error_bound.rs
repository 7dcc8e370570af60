//! An f32 value together with a bound on its distance from the exact result.
//!
//! The bound follows what WGSL permits a GPU to do, not what one GPU does: sums and products rounded once (contraction into a
//! fused multiply-add only rounds less), division and square root several ULP, but no accuracy at all for divisors beyond 2^126 or
//! below 2^-126, subnormal numbers flushed to zero, inputs rounded to f32. Transcendental functions are allowed
//! [`FUNCTION_ULP`] ULP of their own error.
//! Bounds are carried in f64, where their own rounding is nine orders of magnitude below what they measure.

use crate::real::{FUNCTION_ULP, Real, Smoothness, bracketed_newton};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Half an ULP of an f32, relative: one correctly rounded operation.
pub(crate) const ROUNDING: f64 = 1.0 / (1 << 24) as f64;
/// WGSL: division is accurate to 2.5 ULP.
pub(crate) const DIVISION: f64 = 2.5 * 2.0 * ROUNDING;
/// WGSL: for divisors of this size at most, and of its inverse at least; the reciprocal of others may be flushed to zero.
pub(crate) const LARGEST_DIVISOR: f64 = 1.0 / FLUSH;
/// WGSL: `sqrt` inherits from `1 / inverseSqrt`, 2 ULP and a division.
pub(crate) const SQUARE_ROOT: f64 = (2.0 + 2.5) * 2.0 * ROUNDING;
/// Relative error of one of our own functions.
pub(crate) const FUNCTION: f64 = FUNCTION_ULP * 2.0 * ROUNDING;
/// Results below the least normal number may be flushed to zero.
pub(crate) const FLUSH: f64 = f32::MIN_POSITIVE as f64;

/// A value computed in f32 and how far it can be from the value of exact arithmetic on the exact inputs.
#[derive(Clone, Copy, Debug)]
pub struct RunningError {
    /// What f32 arithmetic gives.
    pub value: f32,
    /// Largest possible distance of `value` from the exact result; infinite where nothing can be said.
    pub bound: f64,
}

/// An f64 as a device receives it: the nearest f32, and a bound on the distance, 0 where there is none.
#[allow(clippy::cast_possible_truncation, reason = "rounding to f32 is the point; the bound is rounded up")]
pub fn nearest_f32(value: f64) -> (f32, f32) {
    let near = value as f32;
    let away = (value - f64::from(near)).abs();
    (near, if away == 0.0 { 0.0 } else { (away as f32).next_up() })
}

#[allow(clippy::cast_possible_truncation, reason = "rounding to f32 is what is being measured")]
fn round(value: f64) -> f32 {
    value as f32
}

impl RunningError {
    /// An input as a shader receives it: the f64 axis value rounded to f32.
    pub fn input(value: f64) -> Self {
        Self { value: round(value), bound: (value - f64::from(round(value))).abs() }
    }

    /// `value` was rounded with a relative error of `relative` after its operands brought in `inherited`.
    fn rounded(value: f32, inherited: f64, relative: f64) -> Self {
        let magnitude = f64::from(value).abs();
        let bound = inherited + (magnitude + inherited) * relative + FLUSH;
        Self { value, bound: if bound.is_nan() { f64::INFINITY } else { bound } }
    }

    /// The one of two numbers that is the smaller or larger, with its own bound if it surely is: a clamp that surely holds is
    /// exact.
    fn chosen_over(self, other: Self) -> Self {
        let sure = (f64::from(self.value) - f64::from(other.value)).abs() > self.bound + other.bound;
        Self { value: self.value, bound: if sure { self.bound } else { self.bound.max(other.bound) } }
    }

    /// A function that is monotone over the argument's uncertainty: its own uncertainty is read at the ends.
    fn monotone(self, value: f32, function: impl Fn(f64) -> f64, relative: f64) -> Self {
        let centre = function(f64::from(self.value));
        let low = function(f64::from(self.value) - self.bound);
        let high = function(f64::from(self.value) + self.bound);
        Self::rounded(value, (high - centre).abs().max((centre - low).abs()), relative)
    }
}

impl Add for RunningError {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::rounded(self.value + other.value, self.bound + other.bound, ROUNDING)
    }
}
impl Sub for RunningError {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::rounded(self.value - other.value, self.bound + other.bound, ROUNDING)
    }
}
impl Mul for RunningError {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        // Nothing is flushed where a factor is zero; a plateau, such as a capacity of 0, is known to be one.
        if [self, other].iter().any(|it| it.value == 0.0 && it.bound == 0.0) {
            let value = self.value * other.value;
            return Self { value, bound: if value.is_nan() { f64::INFINITY } else { 0.0 } };
        }
        let (a, b) = (f64::from(self.value).abs(), f64::from(other.value).abs());
        let inherited = a * other.bound + b * self.bound + self.bound * other.bound;
        Self::rounded(self.value * other.value, inherited, ROUNDING)
    }
}
impl Div for RunningError {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let size = f64::from(other.value).abs();
        let divisor = size - other.bound;
        let quotient = (f64::from(self.value) / f64::from(other.value)).abs();
        let is_accurate = divisor >= FLUSH && size <= LARGEST_DIVISOR;
        let inherited = if is_accurate { (self.bound + quotient * other.bound) / divisor } else { f64::INFINITY };
        Self::rounded(self.value / other.value, inherited, DIVISION)
    }
}
impl Neg for RunningError {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, bound: self.bound }
    }
}

impl Real for RunningError {
    type Shared = Self;
    fn shared(value: Self) -> Self {
        value
    }
    fn plus_whole(self, other: Self) -> Self {
        Self { value: self.value + other.value, bound: self.bound + other.bound }
    }
    fn iterations(self, most: usize) -> usize {
        (f64::from(self.value) + self.bound).iterations(most)
    }
    fn scaled(self, power: i16) -> Self {
        let factor = f32::powi(2.0, power.into());
        // Exact, but for what is flushed to zero.
        let flushed = if power < 0 { FLUSH } else { 0.0 };
        Self { value: self.value * factor, bound: self.bound * f64::from(factor) + flushed }
    }
    fn is_zero(self) -> bool {
        self.value == 0.0 && self.bound == 0.0
    }
    fn constant(value: f64) -> Self {
        Self::input(value)
    }
    fn sqrt(self) -> Self {
        self.monotone(f32::sqrt(self.value), |x| f64::sqrt(x.max(0.0)), SQUARE_ROOT)
    }
    fn abs(self) -> Self {
        Self { value: f32::abs(self.value), bound: self.bound }
    }
    fn min(self, other: Self) -> Self {
        if other.value < self.value { other.chosen_over(self) } else { self.chosen_over(other) }
    }
    fn max(self, other: Self) -> Self {
        if other.value > self.value { other.chosen_over(self) } else { self.chosen_over(other) }
    }
    fn exp_m1(self) -> Self {
        self.monotone(Real::exp_m1(self.value), libm::expm1, FUNCTION)
    }
    fn ln_1p(self) -> Self {
        self.monotone(Real::ln_1p(self.value), |x| libm::log1p(x.max(-1.0)), FUNCTION)
    }
    fn sin(self) -> Self {
        Self::rounded(Real::sin(self.value), self.bound, FUNCTION)
    }
    fn cos(self) -> Self {
        Self::rounded(Real::cos(self.value), self.bound, FUNCTION)
    }
    fn asin(self) -> Self {
        let arc = self.monotone(Real::asin(self.value), |x| libm::asin(x.clamp(-1.0, 1.0)), FUNCTION);
        // Beyond one half it takes a square root: what that may be off by is 1.11 times as much, at most, of the angle to pi/2.
        let rest = (std::f64::consts::FRAC_PI_2 - f64::from(arc.value).abs()).max(0.0);
        let rooted = if f32::abs(self.value) > 0.5 { 1.11 * SQUARE_ROOT * rest } else { 0.0 };
        Self { bound: arc.bound + rooted, ..arc }
    }
    /// Exact unless a whole number lies within the bound; then as many whole numbers off as the bound reaches over.
    fn floor(self) -> Self {
        let value = f32::floor(self.value);
        let above = f64::from(self.value) - f64::from(value);
        let is_sure = self.bound == 0.0 || (self.bound < above && self.bound < 1.0 - above);
        Self { value, bound: if is_sure { 0.0 } else { self.bound.ceil() } }
    }
    fn select(margin: Self, at_least_zero: Self, below_zero: Self) -> Self {
        let (chosen, other) = if margin.value >= 0.0 { (at_least_zero, below_zero) } else { (below_zero, at_least_zero) };
        // A margin that is exact decides at zero too: a traction or torque of 0 is no borderline case.
        if margin.bound == 0.0 || f64::from(margin.value).abs() > margin.bound {
            return chosen;
        }
        // The exact margin may lie on the other side: the exact result may be the other branch.
        let apart = (f64::from(chosen.value) - f64::from(other.value)).abs();
        Self { value: chosen.value, bound: chosen.bound.max(apart + other.bound) }
    }
    fn monotone_root<const P: usize>(
        bracket: (Self, Self),
        start: Self,
        smoothness: Smoothness,
        parameters: [Self; P],
        function: impl Fn([Self; P], Self) -> (Self, Self),
    ) -> Self {
        let ends = (f64::from(bracket.0.value), f64::from(bracket.1.value));
        let at = |x: f64| function(parameters, Self { value: round(x), bound: 0.0 });
        let root = round(bracketed_newton(ends, f64::from(start.value), f64::from(f32::EPSILON), smoothness, |x| {
            let (value, slope) = at(x);
            (f64::from(value.value), f64::from(slope.value))
        }));
        // The exact function is within `bound` of the f32 one, so its root is within residual / least slope of ours. The
        // slope is taken at the root; it varies little over a distance of a few ULP, for which a factor 2 is ample.
        let (value, slope) = at(f64::from(root));
        let residual = f64::from(value.value).abs() + value.bound;
        let least_slope = 0.5 * (f64::from(slope.value).abs() - slope.bound);
        let inherited = if least_slope > 0.0 { residual / least_slope } else { f64::INFINITY };
        Self::rounded(root, inherited, ROUNDING)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cancellation_is_seen() {
        let a = RunningError::input(1.000_000_1);
        let b = RunningError::input(1.0);
        let difference = a - b;
        let exact = 1.000_000_1 - 1.0;
        assert!((f64::from(difference.value) - exact).abs() <= difference.bound);
        assert!(difference.bound > 0.1 * exact, "a tenth of the digits at most survive");
    }

    #[test]
    fn division_by_what_may_be_zero_has_no_bound() {
        let zero = RunningError::input(0.1) - RunningError::input(0.1);
        assert_eq!((RunningError::input(1.0) / zero).bound, f64::INFINITY);
    }

    #[test]
    fn division_by_what_has_no_reciprocal_in_f32_has_no_bound() {
        let quotient = |divisor: f64| RunningError::input(1.0) / RunningError { value: round(divisor), bound: 0.0 };
        let largest = 2f64.powi(126);
        for (inside, outside) in [(largest, largest * 1.000_001), (1.0 / largest, 0.999_999 / largest), (-largest, -largest * 1.000_001)] {
            assert!(quotient(inside).bound.is_finite(), "{inside}");
            assert_eq!(quotient(outside).bound, f64::INFINITY, "{outside}");
        }
    }

    #[test]
    fn an_unsure_selection_covers_both_branches() {
        let unsure = RunningError { value: 1e-9, bound: 1e-8 };
        let chosen = Real::select(unsure, RunningError::input(1.0), RunningError::input(3.0));
        assert_eq!(chosen.value, 1.0);
        assert!(chosen.bound >= 2.0);
    }
}
