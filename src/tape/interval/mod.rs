//! All values that a quantity takes over a box of designs, and how far f64 is from the exact ones.
//!
//! The two ends hold what the reference computes for any design of the box as well as what exact arithmetic gives, so a margin of one
//! sign decides for the whole box. The error is carried beside them, because a wide box has a wide range but the same rounding.
//! Nothing here asks the processor to round in another direction: every result is moved outwards instead.

mod real;
mod root;
#[cfg(test)]
mod tests;

use crate::real::Real;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Half an ULP of an f64, relative: one correctly rounded operation.
const ROUNDING: f64 = f64::EPSILON / 2.0;
/// ULP that a function of `libm` may be off by, as an error and as what moves an end outwards.
const FUNCTION: f64 = 4.0 * f64::EPSILON;
/// Factors that move a positive number at least to its neighbour.
const DOWN: f64 = 1.0 - ROUNDING;
const UP: f64 = 1.0 + f64::EPSILON;
/// What the additions and products of an error may round off it.
const OF_ERRORS: f64 = 1.0 + 8.0 * f64::EPSILON;
/// Below this a product or quotient may have lost digits to underflow, which this much makes up for.
const UNDERFLOW: f64 = 1e-290;
const LOST: f64 = f64::MIN_POSITIVE;
/// Beyond this a sine's argument is not reduced to a period: nothing but [-1, 1] is known.
const PERIODS: f64 = 1e5;

/// All numbers between two ends, and the rounding error of each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// No value is less, neither of f64 nor the exact one.
    pub low: f64,
    /// No value is larger, neither of f64 nor the exact one.
    pub high: f64,
    /// Largest possible distance of an f64 value from the exact value of the same design.
    pub error: f64,
}

/// Nothing is known; the value may be a NaN.
pub const EVERYTHING: Interval = Interval { low: f64::NEG_INFINITY, high: f64::INFINITY, error: f64::INFINITY };
const ZERO: Interval = Interval { low: 0.0, high: 0.0, error: 0.0 };

/// Like `minsd`: the second of two numbers that do not compare.
#[inline(always)]
pub(super) fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline(always)]
pub(super) fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Below what was rounded to `x`; finite where that overflowed, because the exact value is.
#[inline(always)]
fn down(x: f64) -> f64 {
    lesser(f64::MAX, lesser(x * DOWN, x * UP))
}

/// Above what was rounded to `x`.
#[inline(always)]
fn up(x: f64) -> f64 {
    greater(f64::MIN, greater(x * DOWN, x * UP))
}

impl Interval {
    /// All inputs between two numbers that are exact.
    #[inline(always)]
    pub fn new(low: f64, high: f64) -> Self {
        if low <= high && low.is_finite() && high.is_finite() { Self { low, high, error: 0.0 } } else { EVERYTHING }
    }

    /// One exact number.
    #[inline(always)]
    pub fn point(value: f64) -> Self {
        Self::new(value, value)
    }

    /// Is this a value of it?
    #[inline(always)]
    pub fn contains(self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// Distance of its ends.
    #[inline(always)]
    pub fn width(self) -> f64 {
        self.high - self.low
    }

    /// Are both ends known?
    #[inline(always)]
    pub fn is_finite(self) -> bool {
        self.low > f64::NEG_INFINITY && self.high < f64::INFINITY
    }

    /// All values of either.
    #[inline(always)]
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        Self { low: lesser(self.low, other.low), high: greater(self.high, other.high), error: greater(self.error, other.error) }
    }

    #[inline(always)]
    pub(super) fn middle(self) -> f64 {
        0.5 * (self.low + self.high)
    }

    /// The largest magnitude of any value.
    #[inline(always)]
    fn magnitude(self) -> f64 {
        greater(f64::abs(self.low), f64::abs(self.high))
    }

    /// Ends that were moved outwards: [`EVERYTHING`] if one is a NaN. No error exceeds the distance of the ends, because f64 and exact
    /// value both lie between them.
    #[inline(always)]
    pub(super) fn known(low: f64, high: f64, error: f64) -> Self {
        if low <= high { Self { low, high, error: lesser(error, (high - low) * UP) } } else { EVERYTHING }
    }

    /// Ends as they were computed, rounded to nearest; `inherited` is what the operands' errors make of this one's.
    #[inline(always)]
    fn rounded(low: f64, high: f64, inherited: f64) -> Self {
        let (low, high) = (down(low), up(high));
        Self::known(low, high, (inherited + ROUNDING * greater(f64::abs(low), f64::abs(high))) * OF_ERRORS)
    }

    /// Ends of a product or quotient that may have underflowed, and its error.
    #[inline(always)]
    fn with_underflow(low: f64, high: f64, inherited: f64) -> Self {
        let result = Self::rounded(low, high, inherited);
        Self::known(result.low - LOST, result.high + LOST, result.error + LOST)
    }

    /// The part of it that is not negative, or not positive: of a result whose sign is sure.
    #[inline(always)]
    fn with_sign(self, is_not_negative: bool, is_not_positive: bool) -> Self {
        let low = if is_not_negative { greater(self.low, 0.0) } else { self.low };
        let high = if is_not_positive { lesser(self.high, 0.0) } else { self.high };
        Self { low, high, ..self }
    }

    #[inline(never)]
    fn product(self, other: Self) -> Self {
        // A slope times a value that is positive: two products are enough.
        if other.low > 0.0 {
            let low = self.low * if self.low >= 0.0 { other.low } else { other.high };
            let high = self.high * if self.high >= 0.0 { other.high } else { other.low };
            let far = greater(f64::abs(low), f64::abs(high));
            if lesser(f64::abs(low), f64::abs(high)) > UNDERFLOW && far < f64::INFINITY {
                return Self::rounded(low, high, self.magnitude() * other.error + other.high * self.error);
            }
        }
        let ends = [self.low * other.low, self.low * other.high, self.high * other.low, self.high * other.high];
        // Also where two infinities meet, which leaves everything open too.
        if (ends[0] + ends[1] + ends[2] + ends[3]).is_nan() {
            return EVERYTHING;
        }
        if self.is_zero() || other.is_zero() {
            return ZERO;
        }
        let low = lesser(lesser(ends[0], ends[1]), lesser(ends[2], ends[3]));
        let high = greater(greater(ends[0], ends[1]), greater(ends[2], ends[3]));
        let inherited = self.magnitude() * other.error + other.magnitude() * self.error;
        let alike = (self.low >= 0.0 && other.low >= 0.0) || (self.high <= 0.0 && other.high <= 0.0);
        let unlike = (self.low >= 0.0 && other.high <= 0.0) || (self.high <= 0.0 && other.low >= 0.0);
        Self::with_underflow(low, high, inherited).with_sign(alike, unlike)
    }

    /// The quotient by what is positive.
    #[inline(always)]
    fn over_positive(self, divisor: Self) -> Self {
        let low = self.low / if self.low >= 0.0 { divisor.high } else { divisor.low };
        let high = self.high / if self.high >= 0.0 { divisor.low } else { divisor.high };
        // (a' - q b')/b with the errors of a and b, and any quotient q.
        let quotient = greater(f64::abs(low), f64::abs(high)) * UP;
        let inherited = (self.error + quotient * divisor.error) / divisor.low;
        if self.low > UNDERFLOW && low > UNDERFLOW && high < f64::INFINITY {
            return Self::rounded(low, high, inherited);
        }
        // Infinity over infinity is a NaN; zero over anything else is zero.
        if !self.is_finite() && !divisor.is_finite() {
            return EVERYTHING;
        }
        if self.is_zero() {
            return ZERO;
        }
        Self::with_underflow(low, high, inherited).with_sign(self.low >= 0.0, self.high <= 0.0)
    }

    /// A function of `libm` that increases: its values at both ends, and the error with which its argument's error comes to
    /// `inherited`.
    #[inline(always)]
    fn increasing(self, function: impl Fn(f64) -> f64, inherited: impl Fn(Self) -> f64) -> Self {
        let low = function(self.low);
        let high = if self.low == self.high { low } else { function(self.high) };
        Self::of_function(low, high, inherited)
    }

    /// Ends as a function of `libm` gave them: exact where they are zero.
    #[inline(always)]
    fn of_function(low: f64, high: f64, inherited: impl Fn(Self) -> f64) -> Self {
        let low = if low == 0.0 { 0.0 } else { low - f64::abs(low) * FUNCTION - LOST };
        let high = if high == 0.0 { 0.0 } else { high + f64::abs(high) * FUNCTION + LOST };
        let range = Self::known(low, high, f64::INFINITY);
        Self::known(low, high, (inherited(range) + FUNCTION * range.magnitude() + LOST) * OF_ERRORS)
    }

    /// A sine or cosine with these values at the ends, largest or least at `peak + k pi` for even or odd k.
    #[inline]
    fn wave(self, function: impl Fn(f64) -> f64, peak: f64) -> Self {
        use std::f64::consts::PI;
        if !self.is_finite() {
            return EVERYTHING;
        }
        if self.magnitude() > PERIODS {
            return Self::known(-1.0, 1.0, self.error + FUNCTION);
        }
        let a = function(self.low);
        let b = if self.low == self.high { a } else { function(self.high) };
        let error = self.error;
        let mut range = Self::of_function(lesser(a, b), greater(a, b), |_| error);
        // A peak that rounding puts on the wrong side of an end is less than an ULP above that end's value.
        let (first, last) = (((self.low - peak) / PI).ceil(), ((self.high - peak) / PI).floor());
        if first <= last {
            let is_even = first % 2.0 == 0.0;
            if is_even || last > first {
                range.high = 1.0;
            }
            if !is_even || last > first {
                range.low = -1.0;
            }
        }
        Self::known(greater(range.low, -1.0), lesser(range.high, 1.0), (error + FUNCTION) * OF_ERRORS)
    }
}

impl Add for Interval {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::rounded(self.low + other.low, self.high + other.high, self.error + other.error)
    }
}

impl Sub for Interval {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::rounded(self.low - other.high, self.high - other.low, self.error + other.error)
    }
}

impl Mul for Interval {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (low, high) = (self.low * other.low, self.high * other.high);
        // Nothing is negative, infinite or near underflow: hardly any product is of another kind.
        if self.low > 0.0 && other.low > 0.0 && low > UNDERFLOW && high < f64::INFINITY {
            return Self::rounded(low, high, self.high * other.error + other.high * self.error);
        }
        self.product(other)
    }
}

impl Div for Interval {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        if other.low > 0.0 {
            self.over_positive(other)
        } else if other.high < 0.0 {
            (-self).over_positive(-other)
        } else {
            EVERYTHING
        }
    }
}

impl Neg for Interval {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { low: -self.high, high: -self.low, error: self.error }
    }
}
