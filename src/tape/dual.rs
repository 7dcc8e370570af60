//! A value together with its derivatives in a few directions.
//!
//! Over `f64` these are the derivatives at a design; over [`Interval`](super::Interval) they are bounds of the derivatives over a box
//! of designs, and so tell where an output surely grows with an input. Most values depend on few of the directions: what is exactly
//! zero is not computed with.

use crate::real::{Real, Smoothness};
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

    /// The slopes of the two values that a kink chooses between, as the margin says.
    #[inline(always)]
    fn chosen(mut self, other: Self, value: T, margin: T) -> Self {
        self.value = value;
        for (own, other) in self.slopes.iter_mut().zip(&other.slopes) {
            if !(own.is_zero() && other.is_zero()) {
                *own = T::select(margin, *own, *other);
            }
        }
        self
    }
}

// What follows writes to a slope only where there is something to write: most are zero on both sides.

impl<T: Real<Shared = T>, const N: usize> Add for Dual<T, N> {
    type Output = Self;
    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        self.value = self.value + other.value;
        for (own, other) in self.slopes.iter_mut().zip(&other.slopes) {
            if !other.is_zero() {
                *own = if own.is_zero() { *other } else { *own + *other };
            }
        }
        self
    }
}

impl<T: Real<Shared = T>, const N: usize> Sub for Dual<T, N> {
    type Output = Self;
    #[inline(always)]
    fn sub(mut self, other: Self) -> Self {
        self.value = self.value - other.value;
        for (own, other) in self.slopes.iter_mut().zip(&other.slopes) {
            if !other.is_zero() {
                *own = if own.is_zero() { -*other } else { *own - *other };
            }
        }
        self
    }
}

impl<T: Real<Shared = T>, const N: usize> Mul for Dual<T, N> {
    type Output = Self;
    #[inline(always)]
    fn mul(mut self, other: Self) -> Self {
        let value = self.value;
        self.value = value * other.value;
        for (own, slope) in self.slopes.iter_mut().zip(&other.slopes) {
            if slope.is_zero() {
                if !own.is_zero() {
                    *own = *own * other.value;
                }
            } else {
                let change = *slope * value;
                *own = if own.is_zero() { change } else { *own * other.value + change };
            }
        }
        self
    }
}

impl<T: Real<Shared = T>, const N: usize> Div for Dual<T, N> {
    type Output = Self;
    #[inline(always)]
    fn div(mut self, other: Self) -> Self {
        self.value = self.value / other.value;
        // (a' - q b')/b
        for (own, slope) in self.slopes.iter_mut().zip(&other.slopes) {
            if slope.is_zero() {
                if !own.is_zero() {
                    *own = *own / other.value;
                }
            } else {
                let change = *slope * self.value;
                *own = if own.is_zero() { -change } else { *own - change } / other.value;
            }
        }
        self
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
        Self { value: self.value.plus_whole(other.value), ..self + other }
    }
    #[inline(always)]
    fn iterations(self, most: usize) -> usize {
        self.value.iterations(most)
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
        self.chosen(other, self.value.min(other.value), other.value - self.value)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.chosen(other, self.value.max(other.value), self.value - other.value)
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
    fn floor(self) -> Self {
        self.chain(self.value.floor(), || self.value.floor_slope())
    }
    #[inline(always)]
    fn floor_slope(self) -> Self {
        let slope = self.value.floor_slope();
        self.with_slopes(slope, |_| slope)
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
    /// Where it is not sure that every design of a box has a root in its bracket, nothing is known of the slopes.
    #[inline]
    fn monotone_root<const P: usize>(
        bracket: (Self, Self),
        start: Self,
        smoothness: Smoothness,
        parameters: [Self; P],
        function: impl Fn([Self; P], Self) -> (Self, Self),
    ) -> Self {
        let root = T::monotone_root(
            (bracket.0.value, bracket.1.value),
            start.value,
            smoothness,
            parameters.map(|parameter| parameter.value),
            |parameters, x| {
                let (value, slope) = function(parameters.map(Self::fixed), Self::fixed(x));
                (value.value, slope.value)
            },
        );
        let (change, slope) = function(parameters, Self::fixed(root));
        if change.slopes.iter().all(|change| change.is_zero()) {
            return Self::fixed(root);
        }
        // By the rule for implicit functions, where every design surely has a root between the ends of its bracket.
        let value_at = |x: T| function(parameters.map(|parameter| Self::fixed(parameter.value)), Self::fixed(x)).0.value;
        let (zero, one) = (T::constant(0.0), T::constant(1.0));
        let (below, above) = (-value_at(bracket.0.value), value_at(bracket.1.value));
        let sure = |slope: T| T::select_slope(below, one, T::select_slope(above, one, slope, zero), zero);
        change.with_slopes(root, |change| if change.is_zero() { change } else { sure(-(change / slope.value)) })
    }
    #[inline(always)]
    fn squared(self) -> Self {
        self.chain(self.value.squared(), || T::constant(2.0) * self.value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tape::Interval;

    /// A formula with every kind of operation, of two numbers.
    fn formula<R: Real>(x: R, y: R) -> R {
        let root = R::monotone_root((R::constant(0.0), R::constant(10.0)), x, Smoothness::Unknown, [x, y], |[x, y], at| {
            (at * at * at - x - y, R::constant(3.0) * at * at)
        });
        let waves = (x * y).sin() + (x / y).cos() - (y / R::constant(4.0)).asin();
        let kinks = x.min(y) * x.max(R::constant(1.0)) + (x - R::constant(5.0)).abs();
        waves + kinks + x.exp_m1() * y.ln_1p() + root.squared() + (x + y).sqrt() + R::select(x - y, x, -y)
    }

    #[test]
    fn slopes_are_those_of_difference_quotients() {
        for (x, y) in [(0.7, 1.3), (1.9, 0.4), (0.2, 3.1)] {
            let at = formula(Dual::<f64, 2>::variable(x, 0), Dual::variable(y, 1));
            assert_eq!(at.value, formula(x, y));
            let step = 1e-6;
            let quotients = [
                (formula(x + step, y) - formula(x - step, y)) / (2.0 * step),
                (formula(x, y + step) - formula(x, y - step)) / (2.0 * step),
            ];
            for (slope, quotient) in at.slopes.iter().zip(quotients) {
                assert!((slope - quotient).abs() < 1e-8 * (1.0 + quotient.abs()), "{slope} {quotient} at {x} {y}");
            }
            let range = |value: f64| Interval::new(value - 1e-9, value + 1e-9);
            let over = formula(Dual::<Interval, 2>::variable(range(x), 0), Dual::variable(range(y), 1));
            for (slope, bounds) in at.slopes.iter().zip(over.slopes) {
                assert!(bounds.contains(*slope) && bounds.width() < 1e-6, "{slope} {bounds:?}");
            }
        }
    }

    #[test]
    fn a_kink_has_both_slopes_and_a_jump_any() {
        let x = Dual::<Interval, 1>::variable(Interval::new(-1.0, 1.0), 0);
        let zero = Dual::constant(0.0);
        let kink = x.max(zero).slopes[0];
        assert_eq!((kink.low, kink.high), (0.0, 1.0));
        let magnitude = x.abs().slopes[0];
        assert_eq!((magnitude.low, magnitude.high), (-1.0, 1.0));
        assert!(!Real::select(x, Dual::constant(1.0), zero).slopes[0].is_finite());
        assert!(!(x - x).is_zero() && zero.is_zero());
    }
}
