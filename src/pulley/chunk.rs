//! Eight points of the surface at all angles of the revolution: sums of harmonics, and the largest values.

#![allow(clippy::needless_range_loop, reason = "loops over lanes, of constant length, are what the compiler makes vectors of")]

use super::loads::Complex;
use super::response::{CHUNK, STRESSES};

/// Angles at which all points are evaluated, 3.75 degrees apart.
pub const ANGLES: usize = 96;
/// Steps of a quarter turn.
pub(super) const QUARTER: usize = ANGLES / 4;

/// Cosines and sines of k times an angle, for all harmonics.
#[derive(Clone, Debug)]
pub(super) struct Waves(pub Vec<Complex>);

impl Waves {
    pub fn new(theta: f64, orders: usize) -> Self {
        let (sine, cosine) = (libm::sin(theta), libm::cos(theta));
        let mut waves = Vec::with_capacity(orders);
        let mut now = (1.0, 0.0);
        for _ in 0..orders {
            waves.push(now);
            now = (now.0 * cosine - now.1 * sine, now.1 * cosine + now.0 * sine);
        }
        Self(waves)
    }
}

/// Cosine and sine term of eight points.
pub(super) type Term = [[f64; CHUNK]; 2];
/// Terms of the harmonics of a chunk of points, a list per stress; harmonics follow each other in even or odd multiples of the same.
pub(super) type Terms = [Vec<Term>; STRESSES];
/// Stresses of eight points at all angles.
pub(super) type ChunkStresses = Vec<[[f64; CHUNK]; STRESSES]>;

/// Stresses of one point at one angle: along and around, less the normal stress, and shear.
pub type Stress = [f64; STRESSES];

/// Square of the von Mises stress.
#[inline(always)]
pub fn von_mises_squared([along, around, shear]: Stress) -> f64 {
    along * along - along * around + around * around + 3.0 * (shear * shear)
}
/// The largest square of the von Mises stress of a difference between two of the angles, and which.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub(super) fn farthest(history: &[[f64; ANGLES]; STRESSES]) -> (f64, usize, usize) {
    let mut best = (0.0, 0, 0);
    for a in 0..ANGLES {
        let own = [history[0][a], history[1][a], history[2][a]];
        let mut squares = [0.0; ANGLES];
        for b in 0..ANGLES {
            let (along, around, shear) = (history[0][b] - own[0], history[1][b] - own[1], history[2][b] - own[2]);
            squares[b] = along * along - along * around + around * around + 3.0 * (shear * shear);
        }
        let mut most = [0.0; CHUNK];
        for squares in squares.as_chunks::<CHUNK>().0 {
            for lane in 0..CHUNK {
                most[lane] = if squares[lane] > most[lane] { squares[lane] } else { most[lane] };
            }
        }
        if most.iter().any(|square| *square > best.0) {
            for (b, &square) in squares.iter().enumerate() {
                if square > best.0 {
                    best = (square, a.min(b), a.max(b));
                }
            }
        }
    }
    best
}

/// Bounds on the stresses of eight points over the turn, MPa.
pub(super) struct Limits {
    /// Largest von Mises stress from the belt.
    pub belt: [f64; CHUNK],
    /// Largest from clamp and spin.
    pub held: [f64; CHUNK],
    /// No less than the amplitude: largest distance from the middle of the belt's stresses.
    pub swing: [f64; CHUNK],
}

/// Adds up the harmonics `step` times 0, 1, 2, ... at the angles of a quarter turn, and the others by symmetry.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub(super) fn synthesise(terms: &Terms, step: usize, quarter: &[Waves], field: &mut ChunkStresses) {
    field.resize(ANGLES, [[0.0; CHUNK]; STRESSES]);
    for place in 0..=QUARTER {
        let waves = &quarter[place].0;
        for stress in 0..STRESSES {
            let terms = &terms[stress];
            // Cosine and sine sums of the even and the odd harmonics.
            let mut sums = [[[0.0; CHUNK]; 2]; 2];
            for odd in 0..2 {
                let (mut cosines, mut sines) = ([0.0; CHUNK], [0.0; CHUNK]);
                let mut number = if step % 2 == 1 { odd } else { odd * terms.len() };
                let stride = if step % 2 == 1 { 2 } else { 1 };
                while number < terms.len() {
                    let (cosine, sine) = waves[number * step];
                    let term = &terms[number];
                    for lane in 0..CHUNK {
                        cosines[lane] += cosine * term[0][lane];
                        sines[lane] += sine * term[1][lane];
                    }
                    number += stride;
                }
                sums[odd] = [cosines, sines];
            }
            let [[ce, se], [co, so]] = sums;
            for lane in 0..CHUNK {
                let (even, odd) = (ce[lane] + so[lane], co[lane] + se[lane]);
                let (even_back, odd_back) = (ce[lane] - so[lane], co[lane] - se[lane]);
                field[place][stress][lane] = even + odd;
                field[(ANGLES - place) % ANGLES][stress][lane] = even_back + odd_back;
                field[ANGLES / 2 - place][stress][lane] = even - odd;
                field[ANGLES / 2 + place][stress][lane] = even_back - odd_back;
            }
        }
    }
}

/// Squares of the von Mises stresses of eight points.
#[inline(always)]
fn squares(stress: &[[f64; CHUNK]; STRESSES]) -> [f64; CHUNK] {
    let mut squares = [0.0; CHUNK];
    for lane in 0..CHUNK {
        squares[lane] = von_mises_squared([stress[0][lane], stress[1][lane], stress[2][lane]]);
    }
    squares
}

#[inline(always)]
fn raise(to: &mut [f64; CHUNK], values: [f64; CHUNK]) {
    for lane in 0..CHUNK {
        to[lane] = if values[lane] > to[lane] { values[lane] } else { to[lane] };
    }
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub(super) fn limits(belt: &ChunkStresses, held: &ChunkStresses) -> Limits {
    let mut limits = Limits { belt: [0.0; CHUNK], held: [0.0; CHUNK], swing: [0.0; CHUNK] };
    let (mut low, mut high) = (belt[0], belt[0]);
    for step in 0..belt.len() {
        raise(&mut limits.belt, squares(&belt[step]));
        raise(&mut limits.held, squares(&held[step]));
        for stress in 0..STRESSES {
            for lane in 0..CHUNK {
                let value = belt[step][stress][lane];
                low[stress][lane] = if value < low[stress][lane] { value } else { low[stress][lane] };
                high[stress][lane] = if value > high[stress][lane] { value } else { high[stress][lane] };
            }
        }
    }
    for step in 0..belt.len() {
        let mut away = belt[step];
        for stress in 0..STRESSES {
            for lane in 0..CHUNK {
                away[stress][lane] -= 0.5 * (low[stress][lane] + high[stress][lane]);
            }
        }
        raise(&mut limits.swing, squares(&away));
    }
    for lane in 0..CHUNK {
        limits.belt[lane] = limits.belt[lane].sqrt();
        limits.held[lane] = limits.held[lane].sqrt();
        limits.swing[lane] = limits.swing[lane].sqrt();
    }
    limits
}

/// Square of the length of a displacement.
#[inline(always)]
pub(super) fn length_squared([r, z, theta]: Stress) -> f64 {
    r * r + z * z + theta * theta
}

/// The largest measures over the turn of what eight points have together, and where, with the held field shifted by some angles.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub(super) fn largest_of(
    belt: &ChunkStresses,
    held: &ChunkStresses,
    shift: usize,
    measure: impl Fn(Stress) -> f64,
) -> ([f64; CHUNK], [usize; CHUNK]) {
    let (mut most, mut angles) = ([0.0; CHUNK], [0.0; CHUNK]);
    for step in 0..ANGLES {
        let (belt, held) = (&belt[step], &held[(step + ANGLES - shift) % ANGLES]);
        for lane in 0..CHUNK {
            let value = measure([belt[0][lane] + held[0][lane], belt[1][lane] + held[1][lane], belt[2][lane] + held[2][lane]]);
            let larger = value > most[lane];
            most[lane] = if larger { value } else { most[lane] };
            angles[lane] = if larger { step as f64 } else { angles[lane] };
        }
    }
    (most, angles.map(|step| step as usize))
}
