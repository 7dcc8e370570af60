//! Eight f64 designs side by side: the inner loop of the CPU engine.
//!
//! Every operation does to each lane exactly what `f64` does, in the same order, so a lane has the same bits as the scalar
//! reference. The loops over the lanes have a constant length and no branch, which the compiler turns into vector code.

use super::{Real, Smoothness, bracketed_newton};
use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Number of designs in a [`Lanes`].
pub const LANES: usize = 8;

/// Eight f64 values that are computed together.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Lanes(pub [f64; LANES]);

impl Lanes {
    /// The same value in every lane.
    #[inline(always)]
    pub fn splat(value: f64) -> Self {
        Self([value; LANES])
    }

    // Plain loops: the library's array functions are not always inlined, and then nothing vectorises.
    #[inline(always)]
    fn map(mut self, function: impl Fn(f64) -> f64) -> Self {
        for lane in 0..LANES {
            self.0[lane] = function(self.0[lane]);
        }
        self
    }

    #[inline(always)]
    fn zip(mut self, other: Self, function: impl Fn(f64, f64) -> f64) -> Self {
        for lane in 0..LANES {
            self.0[lane] = function(self.0[lane], other.0[lane]);
        }
        self
    }
}

macro_rules! lanewise {
    ($trait:ident, $method:ident, $operator:tt) => {
        impl $trait for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $operator b)
            }
        }
    };
}
lanewise!(Add, add, +);
lanewise!(Sub, sub, -);
lanewise!(Mul, mul, *);
lanewise!(Div, div, /);

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl Real for Lanes {
    /// A broadcast costs no more than a load, so eight copies of it need not be kept.
    type Shared = f64;
    #[inline(always)]
    fn shared(value: f64) -> Self {
        Self::splat(value)
    }
    #[inline(always)]
    fn plus_whole(self, other: Self) -> Self {
        self + other
    }
    #[inline(always)]
    fn iterations(self, most: usize) -> usize {
        let mut iterations = 0;
        for lane in self.0 {
            iterations = iterations.max(lane.iterations(most));
        }
        iterations
    }
    #[inline(always)]
    fn passed_at(table: &[f64], index: Self, last: Self) -> Self {
        let mut chosen = index;
        for lane in 0..LANES {
            chosen.0[lane] = f64::passed_at(table, index.0[lane], last.0[lane]);
        }
        chosen
    }
    #[inline(always)]
    fn is_zero(self) -> bool {
        // Both zeros have no bit but the sign.
        let mut bits = 0;
        for lane in 0..LANES {
            bits |= self.0[lane].to_bits() << 1;
        }
        bits == 0
    }
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self::splat(value)
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
        self.map(Real::exp_m1)
    }
    #[inline(always)]
    fn ln_1p(self) -> Self {
        self.map(Real::ln_1p)
    }
    #[inline(always)]
    fn sin(self) -> Self {
        self.map(Real::sin)
    }
    #[inline(always)]
    fn cos(self) -> Self {
        self.map(Real::cos)
    }
    #[inline(always)]
    fn asin(self) -> Self {
        self.map(Real::asin)
    }
    #[inline(always)]
    fn floor(self) -> Self {
        self.map(f64::floor)
    }
    #[inline(always)]
    fn select(margin: Self, at_least_zero: Self, below_zero: Self) -> Self {
        let mut chosen = below_zero;
        for lane in 0..LANES {
            chosen.0[lane] = f64::select(margin.0[lane], at_least_zero.0[lane], below_zero.0[lane]);
        }
        chosen
    }
    /// One lane after the other: each must take the very steps that the scalar takes.
    fn monotone_root<const P: usize>(
        bracket: (Self, Self),
        start: Self,
        smoothness: Smoothness,
        parameters: [Self; P],
        function: impl Fn([Self; P], Self) -> (Self, Self),
    ) -> Self {
        Self(from_fn(|lane| {
            bracketed_newton((bracket.0.0[lane], bracket.1.0[lane]), start.0[lane], f64::EPSILON, smoothness, |x| {
                let (value, slope) = function(parameters, Self::splat(x));
                (value.0[lane], slope.0[lane])
            })
        }))
    }
}
