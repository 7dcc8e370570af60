//! A throw-away interval type, to show that the formulas are open to number types that nobody thought of.

use beltspace::real::Real;
use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// All numbers between two ends.
#[derive(Clone, Copy, Debug)]
pub struct Interval {
    pub low: f64,
    pub high: f64,
}

const EVERYTHING: Interval = Interval { low: f64::NEG_INFINITY, high: f64::INFINITY };
/// ULP that a function of `libm` may be off by.
const FUNCTION_ULP: usize = 4;

impl Interval {
    pub fn new(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    pub fn contains(self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    pub fn width(self) -> f64 {
        self.high - self.low
    }

    /// Ends that were rounded `ulp` times, moved outwards.
    fn outward(low: f64, high: f64, ulp: usize) -> Self {
        if low.is_nan() || high.is_nan() {
            return EVERYTHING;
        }
        let widened = (0..ulp).fold((low, high), |(low, high), _| (low.next_down(), high.next_up()));
        Self { low: widened.0, high: widened.1 }
    }

    fn hull(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// An increasing function.
    fn increasing(self, function: impl Fn(f64) -> f64) -> Self {
        Self::outward(function(self.low), function(self.high), FUNCTION_ULP)
    }

    /// Of four products or quotients, the least and the largest.
    fn ends(values: [f64; 4]) -> Self {
        if values.iter().any(|value| value.is_nan()) {
            return EVERYTHING;
        }
        let low = values.into_iter().fold(f64::INFINITY, f64::min);
        Self::outward(low, values.into_iter().fold(f64::NEG_INFINITY, f64::max), 1)
    }
}

impl Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::outward(self.low + other.low, self.high + other.high, 1)
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::outward(self.low - other.high, self.high - other.low, 1)
    }
}

impl Mul for Interval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::ends([self.low * other.low, self.low * other.high, self.high * other.low, self.high * other.high])
    }
}

impl Div for Interval {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        if other.contains(0.0) {
            return EVERYTHING;
        }
        Self::ends([self.low / other.low, self.low / other.high, self.high / other.low, self.high / other.high])
    }
}

impl Neg for Interval {
    type Output = Self;
    fn neg(self) -> Self {
        Self { low: -self.high, high: -self.low }
    }
}

impl Real for Interval {
    type Shared = Self;
    fn shared(value: Self) -> Self {
        value
    }
    fn plus_whole(self, other: Self) -> Self {
        Self { low: self.low + other.low, high: self.high + other.high }
    }
    fn turns(self, most: usize) -> usize {
        self.high.turns(most)
    }
    fn is_zero(self) -> bool {
        self.low == 0.0 && self.high == 0.0
    }
    fn constant(value: f64) -> Self {
        Self { low: value, high: value }
    }
    fn sqrt(self) -> Self {
        self.increasing(|value| value.max(0.0).sqrt())
    }
    fn abs(self) -> Self {
        let far = self.low.abs().max(self.high.abs());
        let near = if self.contains(0.0) { 0.0 } else { self.low.abs().min(self.high.abs()) };
        Self { low: near, high: far }
    }
    fn min(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.min(other.high) }
    }
    fn max(self, other: Self) -> Self {
        Self { low: self.low.max(other.low), high: self.high.max(other.high) }
    }
    fn exp_m1(self) -> Self {
        self.increasing(libm::expm1)
    }
    fn ln_1p(self) -> Self {
        self.increasing(|value| libm::log1p(value.max(-1.0)))
    }
    fn sin(self) -> Self {
        (self - Self::constant(FRAC_PI_2)).cos()
    }
    fn cos(self) -> Self {
        let (a, b) = (libm::cos(self.low), libm::cos(self.high));
        let ends = Self::outward(a.min(b), a.max(b), FUNCTION_ULP);
        // Where the interval spans a multiple of pi, the cosine is 1 or -1 there.
        let (first, last) = ((self.low / PI).ceil(), (self.high / PI).floor());
        if first > last {
            return ends;
        }
        if last > first || !self.width().is_finite() {
            return Self { low: -1.0, high: 1.0 };
        }
        ends.hull(Self::constant(if first % 2.0 == 0.0 { 1.0 } else { -1.0 }))
    }
    fn asin(self) -> Self {
        self.increasing(|value| libm::asin(value.clamp(-1.0, 1.0)))
    }
    fn select(margin: Self, at_least_zero: Self, below_zero: Self) -> Self {
        if margin.low >= 0.0 {
            at_least_zero
        } else if margin.high < 0.0 {
            below_zero
        } else {
            at_least_zero.hull(below_zero)
        }
    }
    fn monotone_root(bracket: (Self, Self), _start: Self, function: impl Fn(Self) -> (Self, Self)) -> Self {
        let bisect = |is_beyond: &dyn Fn(Self) -> bool| {
            let (mut low, mut high) = (bracket.0.low, bracket.1.high);
            for _ in 0..100 {
                let middle = 0.5 * (low + high);
                if is_beyond(function(Self::constant(middle)).0) { high = middle } else { low = middle }
            }
            (low, high)
        };
        // Below the root of every function in question, and above that of every one; an iteration may stop a little off.
        let low = bisect(&|value| value.high >= 0.0).0;
        let high = bisect(&|value| value.low > 0.0).1;
        Self { low: low - 1e-12 * low.abs(), high: high + 1e-12 * high.abs() }
    }
}
