//! `f64`, the reference, and `f32`, the arithmetic of a shader.
//!
//! Transcendental functions of f64 come from the pure-Rust `libm`, never from the system, so that f64 gives the same bits on
//! every machine; those of f32 are the shaders' own. `min` and `max` are written as comparisons because that is what one vector instruction does.

use super::{Real, Smoothness, bracketed_newton, functions};

macro_rules! float {
    ($float:ident, $exp_m1:path, $ln_1p:path, $sin:path, $cos:path, $asin:path) => {
        impl Real for $float {
            type Shared = Self;
            #[inline(always)]
            fn shared(value: Self) -> Self {
                value
            }
            #[inline(always)]
            fn plus_whole(self, other: Self) -> Self {
                self + other
            }
            #[inline(always)]
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number, and the cast saturates")]
            fn iterations(self, most: usize) -> usize {
                ((self + 0.5) as usize).min(most)
            }
            #[inline(always)]
            fn put_last(table: &mut [Self], end: Self, number: Self) {
                let end = end.iterations(table.len() - 1);
                table[end] = number;
            }
            #[inline(always)]
            fn passed_at(table: &[Self], index: Self, _last: Self) -> Self {
                table[index.iterations(table.len() - 1)]
            }
            #[inline(always)]
            fn is_zero(self) -> bool {
                self == 0.0
            }
            #[inline(always)]
            #[allow(clippy::cast_possible_truncation, reason = "rounding is the meaning of f32")]
            fn constant(value: f64) -> Self {
                value as $float
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $float::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $float::abs(self)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if other < self { other } else { self }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if other > self { other } else { self }
            }
            #[inline]
            fn exp_m1(self) -> Self {
                $exp_m1(self)
            }
            #[inline]
            fn ln_1p(self) -> Self {
                $ln_1p(self)
            }
            #[inline]
            fn sin(self) -> Self {
                $sin(self)
            }
            #[inline]
            fn cos(self) -> Self {
                $cos(self)
            }
            #[inline]
            fn asin(self) -> Self {
                $asin(self)
            }
            #[inline(always)]
            fn floor(self) -> Self {
                $float::floor(self)
            }
            #[inline(always)]
            fn select(margin: Self, at_least_zero: Self, below_zero: Self) -> Self {
                if margin >= 0.0 { at_least_zero } else { below_zero }
            }
            #[inline]
            #[allow(clippy::cast_possible_truncation, reason = "rounding is the meaning of f32")]
            fn monotone_root<const P: usize>(
                bracket: (Self, Self),
                start: Self,
                smoothness: Smoothness,
                parameters: [Self; P],
                function: impl Fn([Self; P], Self) -> (Self, Self),
            ) -> Self {
                let bracket = (f64::from(bracket.0), f64::from(bracket.1));
                let root = bracketed_newton(bracket, f64::from(start), f64::from($float::EPSILON), smoothness, |x| {
                    let (value, slope) = function(parameters, x as $float);
                    (f64::from(value), f64::from(slope))
                });
                root as $float
            }
        }
    };
}

float!(f64, libm::expm1, libm::log1p, libm::sin, libm::cos, libm::asin);
float!(f32, functions::exp_m1, functions::ln_1p, functions::sine, functions::cosine, functions::arc_sine);
