//! A value together with its derivatives in a few directions.
//!
//! Over `f64` these are the derivatives at a design; over [`Interval`](super::Interval) they are bounds of the derivatives over a box
//! of designs, and so tell where an output surely grows with an input. Most values depend on few of the directions: what is exactly
//! zero is not computed with.

use super::Real;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value and its derivatives in `N` directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<T, const N: usize> {
    /// The value itself.
    pub value: T,
    /// How it changes in each direction.
    pub slopes: [T; N],
}

impl<T: Real<Shared = T>, const N: usize> Dual<T, N> {
    /// A value that no direction changes.
    #[inline(always)]
    pub fn fixed(value: T) -> Self {
        Self { value, slopes: [T::constant(0.0); N] }
    }

    /// The variable of a direction: it changes by as much as one goes.
    #[inline(always)]
    pub fn variable(value: T, direction: usize) -> Self {
        let mut variable = Self::fixed(value);
        if let Some(slope) = variable.slopes.get_mut(direction) {
            *slope = T::constant(1.0);
        }
        variable
    }

    /// A function of this value with this slope.
    #[inline(always)]
    fn chain(self, value: T, slope: impl FnOnce() -> T) -> Self {
        if self.slopes.iter().all(|own| own.is_zero()) {
            return Self::fixed(value);
        }
        let slope = slope();
        self.with_slopes(value, |own| if own.is_zero() { own } else { own * slope })
    }

    /// Another value, with slopes made of this one's. Loops over slopes are plain ones: compilers make calls of those over arrays.
    #[inline(always)]
    fn with_slopes(mut self, value: T, slope: impl Fn(T) -> T) -> Self {
        self.value = value;
        for own in &mut self.slopes {
            *own = slope(*own);
        }
        self
    }

    /// The slopes of two values, merged one by one.
    #[inline(always)]
    fn merged(mut self, other: Self, value: T, merge: impl Fn(T, T) -> T) -> Self {
        self.value = value;
        for (own, other) in self.slopes.iter_mut().zip(&other.slopes) {
            *own = merge(*own, *other);
        }
        self
    }
}

/// A slope times a value.
#[inline(always)]
fn times<T: Real>(slope: T, value: T) -> T {
    if slope.is_zero() { slope } else { slope * value }
}

#[inline(always)]
fn plus<T: Real>(a: T, b: T) -> T {
    if a.is_zero() {
        b
    } else if b.is_zero() {
        a
    } else {
        a + b
    }
}

impl<T: Real<Shared = T>, const N: usize> Add for Dual<T, N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.merged(other, self.value + other.value, plus)
    }
}

impl<T: Real<Shared = T>, const N: usize> Sub for Dual<T, N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.merged(other, self.value - other.value, |a, b| plus(a, -b))
    }
}

impl<T: Real<Shared = T>, const N: usize> Mul for Dual<T, N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.merged(other, self.value * other.value, |a, b| plus(times(a, other.value), times(b, self.value)))
    }
}

impl<T: Real<Shared = T>, const N: usize> Div for Dual<T, N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        // (a' - q b')/b
        self.merged(other, quotient, |a, b| {
            let change = plus(a, -times(b, quotient));
            if change.is_zero() { change } else { change / other.value }
        })
    }
}

impl<T: Real<Shared = T>, const N: usize> Neg for Dual<T, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.with_slopes(-self.value, |slope| -slope)
    }
}

impl<T: Real<Shared = T>, const N: usize> Real for Dual<T, N> {
    type Shared = Self;
    #[inline(always)]
    fn shared(value: Self) -> Self {
        value
    }
    #[inline(always)]
    fn plus_whole(self, other: Self) -> Self {
        self.merged(other, self.value.plus_whole(other.value), plus)
    }
    #[inline(always)]
    fn turns(self, most: usize) -> usize {
        self.value.turns(most)
    }
    /// Only where nothing changes it either.
    #[inline(always)]
    fn is_zero(self) -> bool {
        self.value.is_zero() && self.slopes.iter().all(|slope| slope.is_zero())
    }
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self::fixed(T::constant(value))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, || T::constant(0.5) / root)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.with_slopes(self.value.abs(), |slope| if slope.is_zero() { slope } else { T::select(self.value, slope, -slope) })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        let margin = other.value - self.value;
        let merge = |a: T, b: T| if a.is_zero() && b.is_zero() { a } else { T::select(margin, a, b) };
        self.merged(other, self.value.min(other.value), merge)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        let margin = self.value - other.value;
        let merge = |a: T, b: T| if a.is_zero() && b.is_zero() { a } else { T::select(margin, a, b) };
        self.merged(other, self.value.max(other.value), merge)
    }
    #[inline(always)]
    fn exp_m1(self) -> Self {
        let value = self.value.exp_m1();
        self.chain(value, || value + T::constant(1.0))
    }
    #[inline(always)]
    fn ln_1p(self) -> Self {
        let one = T::constant(1.0);
        self.chain(self.value.ln_1p(), || one / (one + self.value))
    }
    #[inline(always)]
    fn sin(self) -> Self {
        self.chain(self.value.sin(), || self.value.cos())
    }
    #[inline(always)]
    fn cos(self) -> Self {
        self.chain(self.value.cos(), || -self.value.sin())
    }
    #[inline(always)]
    fn asin(self) -> Self {
        let one = T::constant(1.0);
        self.chain(self.value.asin(), || {
            let sine = self.value.min(one).max(-one);
            one / ((one - sine) * (one + sine)).sqrt()
        })
    }
    #[inline(always)]
    fn select(margin: Self, at_least_zero: Self, below_zero: Self) -> Self {
        let mut selected = Self { value: T::select(margin.value, at_least_zero.value, below_zero.value), ..margin };
        let branches = at_least_zero.slopes.iter().zip(&below_zero.slopes);
        for (slope, (at_least_zero, below_zero)) in selected.slopes.iter_mut().zip(branches) {
            *slope = T::select_slope(margin.value, *slope, *at_least_zero, *below_zero);
        }
        selected
    }
    /// The slopes are those of the root, by the rule for implicit functions; they mean something only where there is a root, which the
    /// formula states as a condition.
    #[inline]
    fn monotone_root(bracket: (Self, Self), start: Self, function: impl Fn(Self) -> (Self, Self)) -> Self {
        let root = T::monotone_root((bracket.0.value, bracket.1.value), start.value, |x| {
            let (value, slope) = function(Self::fixed(x));
            (value.value, slope.value)
        });
        let (change, slope) = function(Self::fixed(root));
        change.with_slopes(root, |change| if change.is_zero() { change } else { -(change / slope.value) })
    }
    #[inline(always)]
    fn squared(self) -> Self {
        self.chain(self.value.squared(), || T::constant(2.0) * self.value)
    }
}
