//! Numbers of several harmonics side by side.

#![allow(clippy::needless_range_loop, reason = "loops over lanes, of constant length, are what the compiler makes vectors of")]

use std::ops::{Index, IndexMut};

/// Harmonics that are solved together.
pub const WIDTH: usize = 4;

/// One number of each harmonic. Aligned, as a vector that lies across two lines of the cache takes twice as long to load.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(32))]
pub struct Wide(pub [f64; WIDTH]);

impl Wide {
    /// Zero in every harmonic.
    pub const ZERO: Self = Self([0.0; WIDTH]);
    /// One in every harmonic.
    pub const ONE: Self = Self([1.0; WIDTH]);

    /// `self -= factor * known` in every harmonic.
    #[inline(always)]
    pub fn subtract(&mut self, factor: &Self, known: &Self) {
        for lane in 0..WIDTH {
            self[lane] -= factor[lane] * known[lane];
        }
    }

    /// Subtracts the products of four pairs, of which two sums are made first.
    #[inline(always)]
    pub fn subtract_four(&mut self, [a, b, c, d]: [&Self; 4], [fa, fb, fc, fd]: &[Self; 4]) {
        for lane in 0..WIDTH {
            self[lane] -= (a[lane] * fa[lane] + b[lane] * fb[lane]) + (c[lane] * fc[lane] + d[lane] * fd[lane]);
        }
    }

    /// `self *= by` in every harmonic.
    #[inline(always)]
    pub fn multiply(&mut self, by: &Self) {
        for lane in 0..WIDTH {
            self[lane] *= by[lane];
        }
    }
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
