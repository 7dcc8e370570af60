//! Roots of increasing functions by Newton's method: one at a time, and a step of many at a time.

use super::{Real, wide};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Steps of a root at most.
pub(crate) const MOST_STEPS: usize = 100;

/// Parameters of a [`RootFunction`].
pub const ROOT_PARAMETERS: usize = 4;

/// An increasing function whose root a formula looks for, by [`Real::root_of`].
pub trait RootFunction {
    /// Value and slope at a place, as [`Real::monotone_root`] wants them.
    fn at<R: Real>(parameters: [R; ROOT_PARAMETERS], x: R) -> (R, R);

    /// A step of many searches at a time, if that has been compiled.
    fn in_columns() -> Option<RootStep> {
        None
    }
}

/// Where many searches are, a column each.
#[derive(Clone, Debug, Default)]
pub struct RootSearch<C> {
    /// Where the function is asked.
    pub x: C,
    /// The root lies above this number.
    pub low: C,
    /// The root lies below this number.
    pub high: C,
    /// How far the step before went; below zero where the search has ended, which stays where it is.
    pub last_step: C,
}

/// Takes a step of every search, given the parameters of each, where it is, and room for where it is next. Returns how many searches have
/// not ended; `None`, and what was written is of no use, where the function meets an argument that has not been compiled for.
pub type RootStep = fn([&[f64]; ROOT_PARAMETERS], RootSearch<&[f64]>, RootSearch<&mut [f64]>) -> Option<usize>;

/// Has a search ended? A step that is no number, as between two infinities, ends nothing.
#[inline(always)]
pub(crate) fn has_ended(last_step: f64) -> bool {
    last_step < 0.0
}

/// A step of a search: where it is asked next, what is then known of the root, and the step. `rounding` is that of the function.
///
/// No condition waits for another one (`|` for `||`), so that many searches become vector instructions.
#[inline(always)]
pub(crate) fn newton_step(at: RootSearch<f64>, value: f64, slope: f64, rounding: f64) -> RootSearch<f64> {
    let RootSearch { x, low, high, last_step } = at;
    let above = value > 0.0;
    let high = if above { x } else { high };
    let low = if above { low } else { x };
    let newton = x - value / slope;
    let halved = 0.5 * (low + high);
    let next = if (newton >= low) & (newton <= high) { newton } else { halved };
    let step = (next - x).abs();
    let at_rounding = step <= 1e4 * rounding * x.abs();
    let had_ended = has_ended(last_step);
    let ends = had_ended | (step == 0.0) | (at_rounding & (step >= 0.5 * last_step));
    RootSearch { x: if had_ended { x } else { next }, low, high, last_step: if ends { -1.0 } else { step } }
}

/// Newton steps kept inside a shrinking bracket: the scalar definition of [`Real::monotone_root`], shared by every instance
/// that works with plain numbers.
///
/// The steps end when they no longer shrink at the level of rounding, so the result does not depend on a tolerance.
#[inline]
pub(crate) fn bracketed_newton(bracket: (f64, f64), start: f64, rounding: f64, mut function: impl FnMut(f64) -> (f64, f64)) -> f64 {
    let (low, high) = bracket;
    let mut search = RootSearch { x: start.max(low).min(high), low, high, last_step: f64::INFINITY };
    for _ in 0..MOST_STEPS {
        let (value, slope) = function(search.x);
        search = newton_step(search, value, slope, rounding);
        if has_ended(search.last_step) {
            break;
        }
    }
    search.x
}

/// The [`RootStep`] of a [`RootFunction`]: the function and the step in one loop, which keeps what it computes in registers.
macro_rules! root_step {
    ($function:ty) => {{
        #[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
        #[allow(clippy::too_many_arguments, reason = "the compiler must know that none overlaps another")]
        fn steps(
            first: &[f64],
            second: &[f64],
            third: &[f64],
            fourth: &[f64],
            asked: &[f64],
            low: &[f64],
            high: &[f64],
            last_step: &[f64],
            x: &mut [f64],
            next_low: &mut [f64],
            next_high: &mut [f64],
            next_last: &mut [f64],
        ) -> Option<usize> {
            use $crate::real::{Lane, RootSearch, has_ended, newton_step};
            let count = asked.len();
            let (first, second, third, fourth) = (&first[..count], &second[..count], &third[..count], &fourth[..count]);
            let (low, high, last_step, x) = (&low[..count], &high[..count], &last_step[..count], &mut x[..count]);
            let (next_low, next_high, next_last) = (&mut next_low[..count], &mut next_high[..count], &mut next_last[..count]);
            let (mut left, mut rare) = (0_u64, 0_u64);
            for lane in 0..count {
                let parameters = [first[lane], second[lane], third[lane], fourth[lane]].map(Lane::of);
                let (value, slope) = <$function as $crate::real::RootFunction>::at(parameters, Lane::of(asked[lane]));
                let at = RootSearch { x: asked[lane], low: low[lane], high: high[lane], last_step: last_step[lane] };
                let next = newton_step(at, value.value, slope.value, f64::EPSILON);
                (x[lane], next_low[lane], next_high[lane], next_last[lane]) = (next.x, next.low, next.high, next.last_step);
                left += u64::from(!has_ended(next.last_step));
                rare |= value.rare | slope.rare;
            }
            (rare == 0).then_some(left as usize)
        }
        let step: $crate::real::RootStep = |[first, second, third, fourth], at, next| {
            let $crate::real::RootSearch { x, low, high, last_step } = next;
            steps(first, second, third, fourth, at.x, at.low, at.high, at.last_step, x, low, high, last_step)
        };
        Some(step)
    }};
}
pub(crate) use root_step;

/// A number of one of many lanes, of which the common ways of the functions are computed without a branch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lane {
    /// The number, if it is not rare.
    pub value: f64,
    /// Not zero where a function on the way to it took a rare way.
    pub rare: u64,
}

impl Lane {
    /// A number that is known.
    #[inline(always)]
    pub fn of(value: f64) -> Self {
        Self { value, rare: 0 }
    }

    #[inline(always)]
    fn map(self, function: impl Fn(f64) -> f64) -> Self {
        Self { value: function(self.value), ..self }
    }

    #[inline(always)]
    fn zip(self, other: Self, function: impl Fn(f64, f64) -> f64) -> Self {
        Self { value: function(self.value, other.value), rare: self.rare | other.rare }
    }

    #[inline(always)]
    fn unless(self, is_rare: bool, value: f64) -> Self {
        Self { value, rare: self.rare | u64::from(is_rare) }
    }
}

macro_rules! arithmetic {
    ($($trait:ident, $method:ident, $operator:tt;)*) => {$(
        impl $trait for Lane {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $operator b)
            }
        }
    )*};
}
arithmetic! {
    Add, add, +;
    Sub, sub, -;
    Mul, mul, *;
    Div, div, /;
}

impl Neg for Lane {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl Real for Lane {
    type Shared = f64;
    #[inline(always)]
    fn shared(value: f64) -> Self {
        Self::of(value)
    }
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self::of(value)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.map(f64::abs)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, Real::min)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, Real::max)
    }
    #[inline(always)]
    fn exp_m1(self) -> Self {
        self.unless(wide::exp_m1_is_rare(self.value), wide::exp_m1_of(self.value))
    }
    #[inline(always)]
    fn ln_1p(self) -> Self {
        self.unless(wide::ln_1p_is_rare(self.value), wide::ln_1p_of(self.value))
    }
    #[inline(always)]
    fn sin(self) -> Self {
        self.unless(wide::turn_is_rare(self.value), wide::sin_of(self.value))
    }
    #[inline(always)]
    fn cos(self) -> Self {
        self.unless(wide::turn_is_rare(self.value), wide::cos_of(self.value))
    }
    /// Beyond 1/2 it is rare: a belt leans less.
    #[inline(always)]
    fn asin(self) -> Self {
        self.unless(!wide::is_asin_near(self.value), wide::asin_near(self.value))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        self.map(f64::floor)
    }
    #[inline(always)]
    fn select(margin: Self, at_least_zero: Self, below_zero: Self) -> Self {
        let value = f64::select(margin.value, at_least_zero.value, below_zero.value);
        Self { value, rare: margin.rare | at_least_zero.rare | below_zero.rare }
    }
    #[inline(always)]
    fn plus_whole(self, other: Self) -> Self {
        self + other
    }
    #[inline(always)]
    fn iterations(self, most: usize) -> usize {
        self.value.iterations(most)
    }
    #[inline(always)]
    fn is_zero(self) -> bool {
        false
    }
    /// A root within a root is left to who looks for one at a time.
    #[inline(always)]
    fn monotone_root<const P: usize>(
        _bracket: (Self, Self),
        start: Self,
        _parameters: [Self; P],
        _function: impl Fn([Self; P], Self) -> (Self, Self),
    ) -> Self {
        start.unless(true, start.value)
    }
}
