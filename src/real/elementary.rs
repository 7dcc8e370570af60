//! Elementary functions made of the operations that every number type has, so that no type, bound or shader needs a function of its own.
//!
//! Each is accurate to a few ULP, relative to its value, wherever it has one; `tests/it/numbers/elementary.rs` measures them. Where a
//! function needs two expressions they are joined by `min` and `max`, such that one of them is exactly zero or one, and not by a
//! selection: of a selection whose margin has both signs in a box of designs no slope is known, of a kink both are. At the kink itself
//! one side alone must have a slope, which is why the order of operands matters: of two equal numbers `min` and `max` give the first.

use super::Real;
use std::f64::consts::{LOG10_E, PI};

/// `exp` of more has no inverse above the least normal f64, and soon overflows.
const LARGEST_INVERSE: f64 = 709.0;
/// Beyond this the hyperbolic tangent is 1 in every digit of f64.
const SATURATED: f64 = 32.0;
/// Beyond 2^60 the arc tangent is pi/2 in every digit of f64, and the square of 2^60 is no problem for f32.
const STEEP: f64 = (1u64 << 60) as f64;
/// A little more than sqrt(1/2), the sine of half a right angle: a bound for boxes that no number ever comes near.
const HALF_RIGHT: f64 = 0.7072;

/// `x` where it is above zero, and `-x` where it is below, each zero elsewhere.
#[inline(always)]
fn sides<R: Real>(x: R) -> (R, R) {
    let zero = R::constant(0.0);
    // At zero the first has the slope and the second has none.
    (x.max(zero), -zero.min(x))
}

/// One of the two factors is exactly one. `exp_m1(x) + 1` for negative `x` would cancel.
#[inline(always)]
pub(super) fn exp<R: Real>(x: R) -> R {
    let one = R::constant(1.0);
    let (above, below) = sides(x);
    (above.exp_m1() + one) / (below.min(R::constant(LARGEST_INVERSE)).exp_m1() + one)
}

/// One of the two terms is exactly zero. `(1 - x)/x` keeps the digits near 1, which `1/x - 1` would lose.
#[inline(always)]
pub(super) fn ln<R: Real>(x: R) -> R {
    let one = R::constant(1.0);
    let below = one.min(x);
    (x.max(one) - one).ln_1p() - ((one - below) / below).ln_1p()
}

/// By the natural logarithm. A product comes to a whole number for the powers of ten up to 10^14, where a quotient often would not.
#[inline(always)]
pub(super) fn log10<R: Real>(x: R) -> R {
    ln(x) * R::constant(LOG10_E)
}

/// With `m = 1 - exp(-2|x|)` it is `m/(2 - m)`, where nothing overflows and numerator and denominator tell the same way.
#[inline(always)]
pub(super) fn tanh<R: Real>(x: R) -> R {
    let two = R::constant(2.0);
    let of_side = |side: R| {
        let m = -(-(two * side.min(R::constant(SATURATED)))).exp_m1();
        m / (two - m)
    };
    let (above, below) = sides(x);
    of_side(above) - of_side(below)
}

/// By half the angle where the result is small, which keeps its digits, and by the arc sine where that is far from its steep end.
#[inline(always)]
pub(super) fn acos<R: Real>(x: R) -> R {
    let (half, two) = (R::constant(0.5), R::constant(2.0));
    let (above, below) = sides(x);
    two * (half * (R::constant(1.0) - above)).sqrt().asin() + below.asin()
}

/// Twice the angle with this sine, which lies between those of -45 and 45 degrees.
#[inline(always)]
fn twice_asin<R: Real>(sine: R) -> R {
    R::constant(2.0) * sine.asin()
}

/// Of a point at height `y` and distance `h`, `across` to the right: the sine of half its angle, never more than that of 45 degrees, so
/// that the arc sine is not steep there.
#[inline(always)]
fn half_sine<R: Real>(y: R, across: R, h: R) -> R {
    y / (R::constant(2.0) * h * (h + across)).sqrt()
}

/// The angle of the point (1, x).
#[inline(always)]
pub(super) fn atan<R: Real>(x: R) -> R {
    let (one, bound) = (R::constant(1.0), R::constant(HALF_RIGHT));
    let x = x.min(R::constant(STEEP)).max(R::constant(-STEEP));
    let sine = half_sine(x, one, (one + x.squared()).sqrt());
    twice_asin(sine.min(bound).max(-bound))
}

/// The larger and the smaller of two numbers that are not below zero, and what to divide both by: the larger, or 1 where that is zero.
///
/// The margin is a difference because that has an error in f32: a device may take a number below the least normal one for zero.
#[inline(always)]
fn sizes<R: Real>(a: R, b: R) -> (R, R, R) {
    let larger = a.max(b);
    let divisor = R::select(R::constant(0.0) - larger, R::constant(1.0), larger);
    (larger, b.min(a), divisor)
}

/// To the right the angle is smooth but for the origin; to the left it is half a revolution less the angle of the point's reflection.
///
/// Nothing is known of a quotient over a box that includes the origin, which is no reason to know nothing of the angle: a limit comes
/// first there, and covers what is no number. So that such coordinates give no angle all the same, zero times each is added.
#[inline(always)]
pub(super) fn atan2<R: Real>(y: R, x: R) -> R {
    let (zero, bound, half_turn) = (R::constant(0.0), R::constant(HALF_RIGHT), R::constant(PI));
    let (larger, smaller, divisor) = sizes(x.abs(), y.abs());
    let (up, across) = (y / divisor, x.abs() / divisor);
    // It is at least 1 unless both are zero. The limit lies below, so that it hides no slope.
    let h = (up.squared() + across.squared()).sqrt().max(R::constant(0.5));
    let right = twice_asin((-bound).max(half_sine(up, across, h)).min(bound));
    R::select(x, right, R::select(y, half_turn, -half_turn) - right) + zero * larger + zero * smaller
}

/// Scaled by the larger, so that no square overflows or vanishes. The limits of the ratio, and zero times the smaller, are there for what
/// [`atan2`] says.
#[inline(always)]
pub(super) fn hypot<R: Real>(a: R, b: R) -> R {
    let (zero, one) = (R::constant(0.0), R::constant(1.0));
    let (larger, smaller, divisor) = sizes(a.abs(), b.abs());
    let ratio = zero.max(smaller / divisor).min(one);
    larger * (one + ratio.squared()).sqrt() + zero * smaller
}
