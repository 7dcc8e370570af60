//! Roots of increasing functions by Newton's method: one at a time, and a step of many at a time.

use super::{Real, wide};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Steps of a root at most.
pub(crate) const MOST_STEPS: usize = 100;

/// Parameters of a [`RootFunction`].
pub const ROOT_PARAMETERS: usize = 4;

/// What is known of an increasing function whose root is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Smoothness {
    /// It may have corners, as one that reads a measured curve.
    Unknown,
    /// Near the root, over a ten-thousandth of it, the curvature changes little: each of the last steps is about the square of the one
    /// before, times a number. So what the next one would come to is known without it.
    Smooth,
}

/// An increasing function whose root a formula looks for, by [`Real::root_of`]. It is [smooth](Smoothness::Smooth).
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

/// What is kept of the bits of a number on the way: its first 33 binary digits, so that the step from there goes beyond all of them.
const FIRST_DIGITS: u64 = !0 << 20;

/// A step of a search: where it is asked next, what is then known of the root, and the step. `rounding` is that of the function.
///
/// No condition waits for another one (`|` for `||`), so that many searches become vector instructions.
#[inline(always)]
pub(crate) fn newton_step(at: RootSearch<f64>, value: f64, slope: f64, rounding: f64, smoothness: Smoothness) -> RootSearch<f64> {
    let RootSearch { x, low, high, last_step } = at;
    let above = value > 0.0;
    let high = if above { x } else { high };
    let low = if above { low } else { x };
    let newton = x - value / slope;
    let halved = 0.5 * (low + high);
    let is_newton = (newton >= low) & (newton <= high);
    let next = if is_newton { newton } else { halved };
    let step = (next - x).abs();
    let at_rounding = step <= 1e4 * rounding * x.abs();
    let had_ended = has_ended(last_step);
    let ends = had_ended | (step == 0.0) | (at_rounding & (step >= 0.5 * last_step));
    let search = RootSearch { x: if had_ended { x } else { next }, low, high, last_step: if ends { -1.0 } else { step } };
    match smoothness {
        Smoothness::Unknown => search,
        Smoothness::Smooth => smooth_step(search, at, (is_newton, step), rounding),
    }
}

/// What is different where the function is smooth: the search ends sooner, and on its way it has fewer digits.
#[inline(always)]
fn smooth_step(next: RootSearch<f64>, at: RootSearch<f64>, (is_newton, step): (bool, f64), rounding: f64) -> RootSearch<f64> {
    let (size, last_step) = (at.x.abs(), at.last_step);
    // The next step would be step * (step / last_step)^2, near the root and after a step of Newton's: below rounding it is not taken.
    let is_near = is_newton & (last_step <= 1e-4 * size);
    let no_more = step * step * step <= 0.0625 * rounding * size * (last_step * last_step);
    let ends = has_ended(next.last_step) | (is_near & no_more);
    // The last step then begins at the very same number, but for rare cases, where the slope was computed in another way.
    let is_on_the_way = (step > 1e-6 * size) & !ends;
    let cut = Real::min(Real::max(f64::from_bits(next.x.to_bits() & FIRST_DIGITS), next.low), next.high);
    let x = if is_on_the_way { cut } else { next.x };
    let last_step = if is_newton { next.last_step } else { f64::INFINITY };
    RootSearch { x, last_step: if ends { -1.0 } else { last_step }, ..next }
}

/// Newton steps kept inside a shrinking bracket: the scalar definition of [`Real::monotone_root`], shared by every instance
/// that works with plain numbers.
///
/// The steps end when they no longer shrink at the level of rounding, or when the next one would be below it, so the result does not
/// depend on a tolerance.
#[inline]
pub(crate) fn bracketed_newton(
    bracket: (f64, f64),
    start: f64,
    rounding: f64,
    smoothness: Smoothness,
    mut function: impl FnMut(f64) -> (f64, f64),
) -> f64 {
    let (low, high) = bracket;
    let mut search = RootSearch { x: start.max(low).min(high), low, high, last_step: f64::INFINITY };
    for _ in 0..MOST_STEPS {
        let (value, slope) = function(search.x);
        search = newton_step(search, value, slope, rounding, smoothness);
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
            use $crate::real::{Lane, RootSearch, Smoothness, has_ended, newton_step};
            let count = asked.len();
            let (first, second, third, fourth) = (&first[..count], &second[..count], &third[..count], &fourth[..count]);
            let (low, high, last_step, x) = (&low[..count], &high[..count], &last_step[..count], &mut x[..count]);
            let (next_low, next_high, next_last) = (&mut next_low[..count], &mut next_high[..count], &mut next_last[..count]);
            let (mut left, mut rare) = (0_u64, 0_u64);
            for lane in 0..count {
                let parameters = [first[lane], second[lane], third[lane], fourth[lane]].map(Lane::of);
                let (value, slope) = <$function as $crate::real::RootFunction>::at(parameters, Lane::of(asked[lane]));
                let at = RootSearch { x: asked[lane], low: low[lane], high: high[lane], last_step: last_step[lane] };
                let next = newton_step(at, value.value, slope.value, f64::EPSILON, Smoothness::Smooth);
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
        _smoothness: Smoothness,
        _parameters: [Self; P],
        _function: impl Fn([Self; P], Self) -> (Self, Self),
    ) -> Self {
        start.unless(true, start.value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube root from a start that is a fifth too large, with the number of evaluations; the slope is a little off.
    fn cube_root(target: f64, smoothness: Smoothness, slope_error: f64) -> (f64, usize) {
        let mut count = 0;
        let root = bracketed_newton((0.0, 10.0), 1.2 * target.cbrt(), f64::EPSILON, smoothness, |x| {
            count += 1;
            (x * x * x - target, 3.0 * x * x * (1.0 + slope_error))
        });
        (root, count)
    }

    #[test]
    fn of_a_smooth_function_the_last_steps_are_foreseen() {
        let (mut foreseen, mut taken) = (0, 0);
        for target in (1..500).map(|it| 0.37 * f64::from(it)) {
            let (found, fewer) = cube_root(target, Smoothness::Smooth, 0.0);
            let (known, more) = cube_root(target, Smoothness::Unknown, 0.0);
            assert!((found - known).abs() <= 2.0 * f64::EPSILON * known, "{found} and {known} of {target}");
            foreseen += fewer;
            taken += more;
        }
        assert!(foreseen + 499 <= taken, "{foreseen} evaluations in place of {taken}, of 499 roots");
    }

    #[test]
    fn a_slope_that_is_rounded_in_another_way_leads_to_the_same_bits() {
        for target in (1..500).map(|it| 0.37 * f64::from(it)) {
            for slope_error in [-8.0, -1.0, 1.0, 8.0].map(|it| it * f64::EPSILON) {
                let [one, other] = [0.0, slope_error].map(|error| cube_root(target, Smoothness::Smooth, error).0);
                assert_eq!(one.to_bits(), other.to_bits(), "{target}");
            }
        }
    }

    #[test]
    fn corners_next_to_the_root_are_seen_unless_there_are_said_to_be_none() {
        // The slope is 3, then 2, then 1, and changes where no step would be foreseen to lead any more.
        let distance = 1e-9;
        let corners = |x: f64| match 1.0 - x {
            below if below > 3.0 * distance => (-5.0 * distance - 3.0 * (below - 3.0 * distance), 3.0),
            below if below > distance => (-distance - 2.0 * (below - distance), 2.0),
            below => (-below, 1.0),
        };
        let found = |smoothness| bracketed_newton((0.0, 2.0), 1.0 - 1e-4, f64::EPSILON, smoothness, corners);
        assert_eq!(found(Smoothness::Unknown), 1.0);
        assert!((found(Smoothness::Smooth) - 1.0).abs() > 0.1 * distance, "the corner is seen all the same: nobody needs to be told of it");
    }

    #[test]
    fn a_search_stays_within_its_bracket_on_its_way() {
        for (low, root) in [(0.7, 0.7), (-1.9, -1.9), (-0.3, 0.0), (0.1 + 0.2, 0.1 + 0.2)] {
            let asked = |x: f64| {
                assert!((low..=low + 5.0).contains(&x), "{x} is asked beyond {low}");
                (3.0 * (x - root) + (x - root).powi(3), 3.0 + 3.0 * (x - root).powi(2))
            };
            let found = bracketed_newton((low, low + 5.0), low + 0.8, f64::EPSILON, Smoothness::Smooth, asked);
            assert!((found - root).abs() <= 1e-15, "{found} in place of {root}");
        }
    }

    #[test]
    fn without_a_root_a_search_ends_at_the_end_of_its_bracket() {
        for smoothness in [Smoothness::Smooth, Smoothness::Unknown] {
            let found = |target: f64| bracketed_newton((1.0, 2.1), 1.7, f64::EPSILON, smoothness, |x| (x * x * x - target, 3.0 * x * x));
            assert!((2.1 - 1e-11..=2.1).contains(&found(100.0)), "{}", found(100.0));
            assert!((1.0..1.0 + 1e-11).contains(&found(0.5)), "{}", found(0.5));
        }
    }
}
