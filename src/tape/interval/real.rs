//! The operations of a formula over intervals.

use super::root::root_of_all;
use super::{DOWN, EVERYTHING, Interval, UP, ZERO, greater, lesser};
use crate::real::{Real, Smoothness};

impl Real for Interval {
    type Shared = Self;
    #[inline(always)]
    fn shared(value: Self) -> Self {
        value
    }
    #[inline(always)]
    fn plus_whole(self, other: Self) -> Self {
        Self::known(self.low + other.low, self.high + other.high, self.error + other.error)
    }
    #[inline(always)]
    fn iterations(self, most: usize) -> usize {
        self.high.iterations(most)
    }
    #[inline(always)]
    fn is_zero(self) -> bool {
        self.low == 0.0 && self.high == 0.0
    }
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self::point(value)
    }
    #[inline]
    fn sqrt(self) -> Self {
        // What may be a NaN stays one.
        if self.high < 0.0 || self == EVERYTHING {
            return EVERYTHING;
        }
        let low = greater(self.low, 0.0).sqrt();
        let by_slope = self.error / (2.0 * low * DOWN);
        // Near zero the slope has no bound, but two roots are no farther apart than the root of their squares' distance.
        let inherited = if low > 0.0 { lesser(by_slope, self.error.sqrt()) } else { self.error.sqrt() };
        Self::rounded(low, self.high.sqrt(), inherited)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        if self.low >= 0.0 {
            self
        } else if self.high <= 0.0 {
            -self
        } else if self == EVERYTHING {
            self
        } else {
            Self { low: 0.0, high: self.magnitude(), error: self.error }
        }
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self.high <= other.low {
            self
        } else if other.high < self.low {
            other
        } else if self == EVERYTHING {
            // Of a NaN and a number f64 keeps the NaN if it comes first.
            self
        } else {
            Self::known(lesser(self.low, other.low), lesser(self.high, other.high), greater(self.error, other.error))
        }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self.low >= other.high {
            self
        } else if other.low > self.high {
            other
        } else if self == EVERYTHING {
            self
        } else {
            Self::known(greater(self.low, other.low), greater(self.high, other.high), greater(self.error, other.error))
        }
    }
    #[inline]
    fn exp_m1(self) -> Self {
        let error = self.error;
        self.increasing(libm::expm1, |range| error * (range.high + 1.0))
    }
    #[inline]
    fn ln_1p(self) -> Self {
        if self.low < -1.0 {
            return EVERYTHING;
        }
        let (low, error) = (self.low, self.error);
        self.increasing(libm::log1p, |_| error / ((1.0 + low) * DOWN))
    }
    #[inline]
    fn sin(self) -> Self {
        self.wave(libm::sin, std::f64::consts::FRAC_PI_2)
    }
    #[inline]
    fn cos(self) -> Self {
        self.wave(libm::cos, 0.0)
    }
    #[inline]
    fn asin(self) -> Self {
        let error = self.error;
        let magnitude = lesser(self.magnitude(), 1.0);
        // At the ends the slope has no bound, but nowhere does asin change by more than acos(1 - error) <= 2.3 sqrt(error).
        let slope = 1.0 / ((1.0 - magnitude) * (1.0 + magnitude) * DOWN).sqrt();
        let inherited = lesser(error * slope, 2.3 * error.sqrt());
        self.increasing(|value| libm::asin(value.clamp(-1.0, 1.0)), |_| inherited)
    }
    #[inline]
    fn floor(self) -> Self {
        // Two numbers less than a whole one apart may lie on both sides of a jump.
        Self::known(self.low.floor(), self.high.floor(), self.error.ceil())
    }
    #[inline]
    fn floor_slope(self) -> Self {
        if self.low.floor() == self.high.floor() { ZERO } else { EVERYTHING }
    }
    #[inline(always)]
    fn select(margin: Self, at_least_zero: Self, below_zero: Self) -> Self {
        if margin.low >= 0.0 {
            at_least_zero
        } else if margin.high < 0.0 {
            below_zero
        } else {
            let hull = at_least_zero.hull(below_zero);
            // Where the margin has an error f64 may choose the other of the two: any distance between them is possible.
            let apart = greater(at_least_zero.high - below_zero.low, below_zero.high - at_least_zero.low) * UP;
            let error = if margin.error == 0.0 { hull.error } else { greater(hull.error, apart) };
            Self::known(hull.low, hull.high, error)
        }
    }
    #[inline(always)]
    fn select_slope(margin: Self, margin_slope: Self, at_least_zero: Self, below_zero: Self) -> Self {
        let is_decided = margin.low >= 0.0 || margin.high < 0.0;
        if is_decided || margin_slope.is_zero() { Self::select(margin, at_least_zero, below_zero) } else { EVERYTHING }
    }
    #[inline(always)]
    fn squared(self) -> Self {
        let size = self.abs();
        size * size
    }
    fn monotone_root<const P: usize>(
        bracket: (Self, Self),
        start: Self,
        smoothness: Smoothness,
        parameters: [Self; P],
        function: impl Fn([Self; P], Self) -> (Self, Self),
    ) -> Self {
        root_of_all(bracket, start, smoothness, |place| function(parameters, place))
    }
}
