//! The number types that the model formulas are generic over.
//!
//! A formula is written once, over [`Real`]. `f64` is the reference, [`Lanes`] are eight f64 designs at a time, `f32` is the arithmetic
//! of a shader, and [`Trace`](crate::tape::Trace) records what the formula does, for everything else: bounds, shaders, dependencies.
//! That is why `Real` has no comparison and no branching: a formula selects with [`Real::select`], clamps with `min` and `max`, and
//! answers questions with signed margins.

mod elementary;
mod float;
pub mod functions;
mod lanes;
mod loops;
mod root;
pub(crate) mod wide;

pub use functions::FUNCTION_ULP;
pub use lanes::{LANES, Lanes};
pub use loops::{Loop, Place};
pub(crate) use root::{Lane, MOST_STEPS, bracketed_newton, has_ended, newton_step, root_step};
pub use root::{ROOT_PARAMETERS, RootFunction, RootSearch, RootStep, Smoothness};

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number that a model formula can be evaluated with.
///
/// Angles are in radians, quantities in SI units. Every instance must agree with `f64` in meaning; only the precision, or
/// what is recorded beside the value, differs.
pub trait Real:
    Copy + Debug + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// What a first stage hands to the second: the number itself, or one number that all lanes share.
    type Shared: Copy;
    /// Reads what the first stage passed on.
    fn shared(value: Self::Shared) -> Self;
    /// A number that depends on no input.
    fn constant(value: f64) -> Self;
    /// Square root of a number that is not negative.
    fn sqrt(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// The smaller of two numbers.
    fn min(self, other: Self) -> Self;
    /// The larger of two numbers.
    fn max(self, other: Self) -> Self;
    /// `exp(self) - 1`, exact to rounding also where `self` is small.
    fn exp_m1(self) -> Self;
    /// `log(1 + self)`, exact to rounding also where `self` is small.
    fn ln_1p(self) -> Self;
    /// Sine.
    fn sin(self) -> Self;
    /// Cosine.
    fn cos(self) -> Self;
    /// Arc sine; the caller clamps the argument to [-1, 1].
    fn asin(self) -> Self;
    /// The largest whole number that is not above it.
    fn floor(self) -> Self;
    /// The slope of [`Real::floor`], zero but at the jumps: a number that stands for many designs does not know it where some of them
    /// lie on different steps.
    #[inline(always)]
    fn floor_slope(self) -> Self {
        Self::constant(0.0)
    }
    /// `at_least_zero` where `margin >= 0`, else `below_zero`. Both are evaluated: neither may be a NaN that leaks.
    fn select(margin: Self, at_least_zero: Self, below_zero: Self) -> Self;
    /// The slope, in some direction, of what [`Real::select`] gives, from the branches' slopes and from the margin's own: a number that
    /// stands for many designs does not know it where the choice changes on the way.
    #[inline(always)]
    fn select_slope(margin: Self, _margin_slope: Self, at_least_zero: Self, below_zero: Self) -> Self {
        Self::select(margin, at_least_zero, below_zero)
    }
    /// The sum of two whole numbers that are small enough for every instance to hold exactly.
    fn plus_whole(self, other: Self) -> Self;
    /// A whole number as the iterations of a loop: the largest value that it may have, at most `most`. Iterations beyond the value
    /// itself must change nothing.
    fn iterations(self, most: usize) -> usize;
    /// A loop: `body` takes a place and the state, and returns the next state; what the last iteration returned is the result. What
    /// the body writes into a table goes there by [`Real::put`].
    #[inline(always)]
    fn fold<const S: usize>(over: Loop<Self>, state: [Self; S], body: impl FnMut(Place, [Self; S]) -> [Self; S]) -> [Self; S] {
        over.run(state, body)
    }
    /// The number of a place.
    #[inline(always)]
    #[allow(clippy::cast_precision_loss, reason = "tables are short")]
    fn number(place: Place) -> Self {
        Self::constant(place.known() as f64)
    }
    /// At least zero at a place that is not before `end`, a whole number, and below zero before it: half a place away from either, so
    /// that rounding cannot matter.
    #[inline(always)]
    #[allow(clippy::cast_precision_loss, reason = "tables are short")]
    fn beyond(place: Place, end: Self) -> Self {
        Self::constant(place.known() as f64 + 0.5) - end
    }
    /// Room for numbers that a loop writes and another reads, under a name.
    #[inline(always)]
    fn table<const N: usize>(_name: &'static str, fill: Self) -> [Self; N] {
        [fill; N]
    }
    /// Writes a number into a table.
    #[inline(always)]
    fn put(table: &mut [Self], place: Place, number: Self) {
        table[place.known()] = number;
    }
    /// Writes the last number of a table, behind `end` others (a whole number); what stands beyond it is never read.
    #[inline(always)]
    fn put_last(table: &mut [Self], end: Self, number: Self) {
        let most = end.iterations(table.len() - 1);
        for (at, held) in table.iter_mut().enumerate().take(most + 1) {
            *held = Self::select(Self::beyond(Place::at(at), end), number, *held);
        }
    }
    /// Reads a number of a table.
    #[inline(always)]
    fn get(table: &[Self], place: Place) -> Self {
        table[place.known()]
    }
    /// Reads a number of a table that a first stage passed on.
    #[inline(always)]
    fn passed(table: &[Self::Shared], place: Place) -> Self {
        Self::shared(table[place.known()])
    }
    /// Reads the number of a passed table at `index`, a whole number from 0 to `last`.
    #[inline(always)]
    fn passed_at(table: &[Self::Shared], index: Self, last: Self) -> Self {
        chosen_at(table, index, last)
    }
    /// What a device leaves to f64, since it takes nested loops or the like: anywhere else, what `compute` gives.
    #[inline(always)]
    fn left_to_f64<const N: usize>(compute: impl FnOnce() -> [Self; N]) -> [Self; N] {
        compute()
    }
    /// Is it surely zero, in every lane? What has settled may end a loop, and a switch that is off may save what hangs on it; that the
    /// answer may also be no must change nothing but the time.
    fn is_zero(self) -> bool;
    /// The root of an increasing function, between the ends of `bracket`, found from `start`.
    ///
    /// `function` takes the parameters that it depends on and the place, and returns value and slope; `smoothness` says when the search may
    /// end. If there is no root in the bracket
    /// the result is some number inside it: the caller states the condition under which a root exists as a status of its own.
    fn monotone_root<const P: usize>(
        bracket: (Self, Self),
        start: Self,
        smoothness: Smoothness,
        parameters: [Self; P],
        function: impl Fn([Self; P], Self) -> (Self, Self),
    ) -> Self;
    /// The same of a function that has a name: who looks for many roots at a time may have it compiled for that.
    #[inline(always)]
    fn root_of<F: RootFunction>(bracket: (Self, Self), start: Self, parameters: [Self; ROOT_PARAMETERS]) -> Self {
        Self::monotone_root(bracket, start, Smoothness::Smooth, parameters, F::at)
    }

    /// The exponential function. In f32 it has no error bound beyond about 87 on either side of zero; in f64 it is infinite above 709, and
    /// below -709 what it is there, half the least normal number.
    #[inline(always)]
    #[must_use]
    fn exp(self) -> Self {
        elementary::exp(self)
    }
    /// Natural logarithm of a number above zero.
    #[inline(always)]
    #[must_use]
    fn ln(self) -> Self {
        elementary::ln(self)
    }
    /// Logarithm to base 10 of a number above zero.
    #[inline(always)]
    #[must_use]
    fn log10(self) -> Self {
        elementary::log10(self)
    }
    /// Hyperbolic tangent.
    #[inline(always)]
    #[must_use]
    fn tanh(self) -> Self {
        elementary::tanh(self)
    }
    /// Tangent.
    #[inline(always)]
    #[must_use]
    fn tan(self) -> Self {
        self.sin() / self.cos()
    }
    /// Arc cosine; the caller clamps the argument to [-1, 1].
    #[inline(always)]
    #[must_use]
    fn acos(self) -> Self {
        elementary::acos(self)
    }
    /// Arc tangent.
    #[inline(always)]
    #[must_use]
    fn atan(self) -> Self {
        elementary::atan(self)
    }
    /// The angle of the point at height `self` and distance `x` to the right, above -pi and up to pi: 0 at the origin, pi on the axis to
    /// the left of it, whatever the signs of zeros are. On a device a point whose coordinates are both zero, or nearly, is left to f64.
    #[inline(always)]
    #[must_use]
    fn atan2(self, x: Self) -> Self {
        elementary::atan2(self, x)
    }
    /// Root of the sum of two squares, of which none overflows or vanishes.
    #[inline(always)]
    #[must_use]
    fn hypot(self, other: Self) -> Self {
        elementary::hypot(self, other)
    }
    /// The least whole number that is not below it.
    #[inline(always)]
    #[must_use]
    fn ceil(self) -> Self {
        -(-self).floor()
    }
    /// The nearest whole number: `floor(x + 1/2)`, so that halves go up, below zero too.
    #[inline(always)]
    #[must_use]
    fn round(self) -> Self {
        (self + Self::constant(0.5)).floor()
    }

    /// Square.
    #[inline(always)]
    fn squared(self) -> Self {
        self * self
    }
    /// Times two to this power.
    #[inline(always)]
    fn scaled(self, power: i16) -> Self {
        self * Self::constant(f64::from_bits(((i64::from(power) + 1023) as u64) << 52))
    }
    /// The same number, with the name and the equation (empty where there is none) that it has in what is written of the formula.
    #[inline(always)]
    #[must_use]
    fn named(self, _name: &'static str, _equation: &'static str) -> Self {
        self
    }
}

/// The number of a table at a whole number that need not be the same for all designs, by one selection after the other.
#[inline(always)]
pub(crate) fn chosen_at<R: Real>(table: &[R::Shared], index: R, last: R) -> R {
    let end = last.iterations(table.len() - 1);
    let mut chosen = R::shared(table[0]);
    for (at, &number) in table.iter().enumerate().take(end + 1).skip(1) {
        // Half a place away from either neighbour, so that rounding cannot matter.
        chosen = R::select(index - R::constant(at as f64 - 0.5), R::shared(number), chosen);
    }
    chosen
}
