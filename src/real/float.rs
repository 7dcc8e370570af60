//! `f64`, the reference, and `f32`, the shader's twin.
//!
//! Transcendental functions come from the pure-Rust `libm`, never from the system, so that f64 gives the same bits on every
//! machine. `min` and `max` are written as comparisons because that is what one vector instruction does.

use super::{Real, bracketed_newton};

macro_rules! float {
    ($float:ident, $exp_m1:ident, $ln_1p:ident, $sin:ident, $cos:ident, $asin:ident) => {
        impl Real for $float {
            #[inline(always)]
            #[allow(clippy::cast_possible_truncation, reason = "f32 is the shader's twin: rounding is its meaning")]
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
                libm::$exp_m1(self)
            }
            #[inline]
            fn ln_1p(self) -> Self {
                libm::$ln_1p(self)
            }
            #[inline]
            fn sin(self) -> Self {
                libm::$sin(self)
            }
            #[inline]
            fn cos(self) -> Self {
                libm::$cos(self)
            }
            #[inline]
            fn asin(self) -> Self {
                libm::$asin(self)
            }
            #[inline(always)]
            fn select(margin: Self, at_least_zero: Self, below_zero: Self) -> Self {
                if margin >= 0.0 { at_least_zero } else { below_zero }
            }
            #[inline]
            #[allow(clippy::cast_possible_truncation, reason = "f32 is the shader's twin: rounding is its meaning")]
            fn monotone_root(bracket: (Self, Self), start: Self, function: impl Fn(Self) -> (Self, Self)) -> Self {
                let bracket = (f64::from(bracket.0), f64::from(bracket.1));
                let root = bracketed_newton(bracket, f64::from(start), f64::from($float::EPSILON), |x| {
                    let (value, slope) = function(x as $float);
                    (f64::from(value), f64::from(slope))
                });
                root as $float
            }
        }
    };
}

float!(f64, expm1, log1p, sin, cos, asin);
float!(f32, expm1f, log1pf, sinf, cosf, asinf);
