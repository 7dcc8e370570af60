//! Eight numbers side by side, of harmonics or of points of the surface, and their arithmetic with the vectors of the processor.

use bytemuck::{Pod, Zeroable, cast_slice, cast_slice_mut};
use pulp::Simd;
use std::ops::{Index, IndexMut};

/// Harmonics that are solved together, and points that are evaluated together.
pub const WIDTH: usize = 8;

/// One number of each harmonic or point. Aligned, as a vector that lies across two lines of the cache takes twice as long to load.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct Wide(pub [f64; WIDTH]);

impl Wide {
    /// Zeros.
    pub const ZERO: Self = Self([0.0; WIDTH]);
}

impl Index<usize> for Wide {
    type Output = f64;

    #[inline(always)]
    fn index(&self, lane: usize) -> &f64 {
        &self.0[lane]
    }
}

impl IndexMut<usize> for Wide {
    #[inline(always)]
    fn index_mut(&mut self, lane: usize) -> &mut f64 {
        &mut self.0[lane]
    }
}

/// The vectors of a processor that hold some numbers.
#[inline(always)]
pub fn vectors<S: Simd>(numbers: &Wide) -> &[S::f64s] {
    cast_slice(&numbers.0)
}

/// The same, to be changed.
#[inline(always)]
pub fn vectors_mut<S: Simd>(numbers: &mut Wide) -> &mut [S::f64s] {
    cast_slice_mut(&mut numbers.0)
}

/// Arithmetic on eight numbers with the vectors of a processor, of which `N` hold them. Every number takes part in the same operations in
/// the same order on every machine, and no product is contracted with a sum, so that the bits are the same.
#[derive(Clone, Copy)]
pub struct Vectors<S: Simd, const N: usize> {
    simd: S,
}

impl<S: Simd, const N: usize> Vectors<S, N> {
    /// The arithmetic of a processor.
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        Self { simd }
    }

    /// Numbers as vectors.
    #[inline(always)]
    pub fn of(self, numbers: &[Wide]) -> &[[S::f64s; N]] {
        cast_slice(numbers)
    }

    /// Numbers as vectors that can be changed.
    #[inline(always)]
    pub fn of_mut(self, numbers: &mut [Wide]) -> &mut [[S::f64s; N]] {
        cast_slice_mut(numbers)
    }

    /// The same number in every lane.
    #[inline(always)]
    pub fn all(self, number: f64) -> [S::f64s; N] {
        [self.simd.splat_f64s(number); N]
    }

    /// Sums.
    #[inline(always)]
    pub fn add(self, mut a: [S::f64s; N], b: [S::f64s; N]) -> [S::f64s; N] {
        for it in 0..N {
            a[it] = self.simd.add_f64s(a[it], b[it]);
        }
        a
    }

    /// Products.
    #[inline(always)]
    pub fn multiply(self, mut a: [S::f64s; N], b: [S::f64s; N]) -> [S::f64s; N] {
        for it in 0..N {
            a[it] = self.simd.mul_f64s(a[it], b[it]);
        }
        a
    }

    /// `from - factor * known`.
    #[inline(always)]
    pub fn subtract(self, mut from: [S::f64s; N], factor: [S::f64s; N], known: [S::f64s; N]) -> [S::f64s; N] {
        for it in 0..N {
            from[it] = self.simd.sub_f64s(from[it], self.simd.mul_f64s(factor[it], known[it]));
        }
        from
    }

    /// Subtracts the products of four pairs, of which two sums are made first.
    #[inline(always)]
    pub fn subtract_four(
        self,
        mut from: [S::f64s; N],
        [a, b, c, d]: [[S::f64s; N]; 4],
        [fa, fb, fc, fd]: &[[S::f64s; N]; 4],
    ) -> [S::f64s; N] {
        let simd = self.simd;
        for it in 0..N {
            let ab = simd.add_f64s(simd.mul_f64s(a[it], fa[it]), simd.mul_f64s(b[it], fb[it]));
            let cd = simd.add_f64s(simd.mul_f64s(c[it], fc[it]), simd.mul_f64s(d[it], fd[it]));
            from[it] = simd.sub_f64s(from[it], simd.add_f64s(ab, cd));
        }
        from
    }

    /// 1 over the square root.
    #[inline(always)]
    pub fn inverse_root(self, mut number: [S::f64s; N]) -> [S::f64s; N] {
        for vector in &mut number {
            *vector = self.simd.div_f64s(self.simd.splat_f64s(1.0), self.simd.sqrt_f64s(*vector));
        }
        number
    }

    /// Are all numbers zero?
    #[inline(always)]
    pub fn are_zero(self, numbers: &[[S::f64s; N]]) -> bool {
        cast_slice::<[S::f64s; N], f64>(numbers).iter().all(|number| *number == 0.0)
    }
}
