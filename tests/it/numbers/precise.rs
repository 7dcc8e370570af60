//! Arithmetic with twice the digits of f64, slow, as a reference for the f64 values.
//!
//! Sums of two f64 with the usual error-free additions and products (Dekker, Knuth): about 31 digits. Constants are the f64 numbers that
//! the formula names.

use beltspace::real::{Real, Smoothness};
use std::f64::consts::FRAC_PI_2;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// `high + low`, where `low` is at most half an ULP of `high`.
#[derive(Clone, Copy, Debug)]
pub struct Precise {
    high: f64,
    low: f64,
}

/// What pi/2 has beyond its f64.
const FRAC_PI_2_REST: f64 = 6.123_233_995_736_766e-17;

fn sum(a: f64, b: f64) -> Precise {
    let high = a + b;
    let of_b = high - a;
    Precise { high, low: (a - (high - of_b)) + (b - of_b) }
}

/// The sum of a number and a much smaller one; an infinity or NaN has no rest.
fn renormalised(a: f64, b: f64) -> Precise {
    let high = a + b;
    Precise { high, low: if high.is_finite() { b - (high - a) } else { 0.0 } }
}

fn product(a: f64, b: f64) -> Precise {
    let high = a * b;
    Precise { high, low: if high.is_finite() { a.mul_add(b, -high) } else { 0.0 } }
}

impl From<f64> for Precise {
    fn from(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }
}

impl Precise {
    /// The nearest f64.
    pub fn rounded(self) -> f64 {
        self.high
    }

    /// How far an f64 is away.
    pub fn distance(self, value: f64) -> f64 {
        ((value - self.high) - self.low).abs()
    }

    fn is_below(self, other: Self) -> bool {
        self.high < other.high || (self.high == other.high && self.low < other.low)
    }

    /// `first + x2 first/(n (n + 1)) + ..`: a series whose terms are each the one before times x2 over the next two whole numbers.
    fn series(first: Self, square: Self, mut next: f64) -> Self {
        let (mut term, mut total) = (first, first);
        for _ in 0..20 {
            term = term * square / Self::from(next * (next + 1.0));
            total = total + term;
            next += 2.0;
        }
        total
    }

    /// Sine and cosine.
    fn sine_cosine(self) -> (Self, Self) {
        let quarters = (self.high / FRAC_PI_2).round();
        let rest = self - product(quarters, FRAC_PI_2) - product(quarters, FRAC_PI_2_REST);
        let square = -(rest * rest);
        let (sine, cosine) = (Self::series(rest, square, 2.0), Self::series(Self::from(1.0), square, 1.0));
        match quarters.rem_euclid(4.0) {
            0.0 => (sine, cosine),
            1.0 => (cosine, -sine),
            2.0 => (-sine, -cosine),
            _ => (-cosine, sine),
        }
    }
}

impl Add for Precise {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, low) = (sum(self.high, other.high), sum(self.low, other.low));
        let high = renormalised(high.high, high.low + low.high);
        renormalised(high.high, high.low + low.low)
    }
}
impl Sub for Precise {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}
impl Mul for Precise {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let high = product(self.high, other.high);
        renormalised(high.high, high.low + (self.high * other.low + self.low * other.high))
    }
}
impl Div for Precise {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        if !first.is_finite() || first == 0.0 {
            return Self::from(first);
        }
        let rest = self - other * Self::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from(second);
        renormalised(first, second) + Self::from(rest.high / other.high)
    }
}
impl Neg for Precise {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Real for Precise {
    type Shared = Self;
    fn shared(value: Self) -> Self {
        value
    }
    fn plus_whole(self, other: Self) -> Self {
        self + other
    }
    fn iterations(self, most: usize) -> usize {
        self.high.iterations(most)
    }
    fn is_zero(self) -> bool {
        self.high == 0.0
    }
    fn constant(value: f64) -> Self {
        Self::from(value)
    }
    fn sqrt(self) -> Self {
        let root = Self::from(self.high.sqrt());
        if root.high > 0.0 { root + (self - root * root) / (root + root) } else { root }
    }
    fn abs(self) -> Self {
        if self.high < 0.0 { -self } else { self }
    }
    fn min(self, other: Self) -> Self {
        if other.is_below(self) { other } else { self }
    }
    fn max(self, other: Self) -> Self {
        if self.is_below(other) { other } else { self }
    }
    fn exp_m1(self) -> Self {
        if self.high.is_nan() || self.high.abs() >= 701.0 {
            return Self::from(libm::expm1(self.high));
        }
        // The series where it converges fast, then e^2x - 1 = (e^x - 1)(e^x + 1) as often as needed: relative digits are kept.
        let mut part = self;
        let mut halvings = 0;
        while part.high.abs() > 0.05 {
            part = part * Self::from(0.5);
            halvings += 1;
        }
        let (mut term, mut total) = (part, part);
        for number in 2..20 {
            term = term * part / Self::from(f64::from(number));
            total = total + term;
        }
        (0..halvings).fold(total, |total, _| total * (total + Self::from(2.0)))
    }
    fn ln_1p(self) -> Self {
        let mut logarithm = Self::from(libm::log1p(self.high));
        if !logarithm.high.is_finite() || logarithm.high == 0.0 {
            return logarithm;
        }
        for _ in 0..2 {
            let there = logarithm.exp_m1();
            logarithm = logarithm + (self - there) / (there + Self::from(1.0));
        }
        logarithm
    }
    fn sin(self) -> Self {
        self.sine_cosine().0
    }
    fn cos(self) -> Self {
        self.sine_cosine().1
    }
    fn asin(self) -> Self {
        let one = Self::from(1.0);
        if self.high.abs() > 0.7 {
            // Near the ends the sine hardly tells angles apart.
            let rest = Real::sqrt((one - Real::abs(self)) * Self::from(0.5));
            let angle = Self { high: FRAC_PI_2, low: FRAC_PI_2_REST } - Self::from(2.0) * Real::asin(rest);
            return if self.high < 0.0 { -angle } else { angle };
        }
        let mut angle = Self::from(libm::asin(self.high));
        for _ in 0..2 {
            let (sine, cosine) = angle.sine_cosine();
            angle = angle + (self - sine) / cosine;
        }
        angle
    }
    fn floor(self) -> Self {
        let whole = self.high.floor();
        Self::from(if whole == self.high && self.low < 0.0 { whole - 1.0 } else { whole })
    }
    fn select(margin: Self, at_least_zero: Self, below_zero: Self) -> Self {
        if margin.high >= 0.0 { at_least_zero } else { below_zero }
    }
    fn monotone_root<const P: usize>(
        bracket: (Self, Self),
        start: Self,
        smoothness: Smoothness,
        parameters: [Self; P],
        function: impl Fn([Self; P], Self) -> (Self, Self),
    ) -> Self {
        let near = f64::monotone_root((bracket.0.high, bracket.1.high), start.high, smoothness, [], |[], x| {
            let (value, slope) = function(parameters, Self::from(x));
            (value.high, slope.high)
        });
        let mut root = Self::from(near);
        for _ in 0..3 {
            let (value, slope) = function(parameters, root);
            root = Real::min(Real::max(root - value / slope, bracket.0), bracket.1);
        }
        root
    }
}

#[test]
fn twice_the_digits_are_right() {
    // The same numbers by ways that have nothing in common; what remains is far below what f64 could hold.
    let agree = |a: Precise, b: Precise| assert!((a - b).high.abs() <= 1e-29 * b.high.abs(), "{a:?} {b:?}");
    for value in [1e-9, 0.013, 0.3, 0.71, 0.999, 0.999_999_999] {
        let x = Precise::from(value) + Precise::from(value * 1e-18);
        let one = Precise::from(1.0);
        agree(x.exp_m1().ln_1p(), x);
        agree(x.ln_1p().exp_m1(), x);
        agree(((-x).exp_m1() + one) * (x.exp_m1() + one), one);
        agree(Real::sin(Real::asin(x)), x);
        agree(Real::sqrt(x) * Real::sqrt(x), x);
        agree((x / Precise::from(3.0)) * Precise::from(3.0), x);
        let (sine, cosine) = (x * Precise::from(20.0)).sine_cosine();
        agree(sine * sine + cosine * cosine, one);
    }
    // e - 1 and the sine of 1, as tables have them.
    let digits = |high: f64, low: f64| Precise { high, low };
    agree(Precise::from(1.0).exp_m1(), digits(1.718_281_828_459_045_3, -7.747_991_575_210_629e-17));
    agree(Precise::from(1.0).sin(), digits(0.841_470_984_807_896_5, 1.776_845_092_935_536e-18));
}
