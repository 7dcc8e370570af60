//! Eight points of the surface at all angles of the revolution: sums of harmonics, and the largest values.

#![allow(clippy::needless_range_loop, reason = "loops over lanes, of constant length, are what the compiler makes vectors of")]

use super::loads::Complex;
use super::response::{CHUNK, STRESSES};
use super::wide::{WIDTH, Wide, vectors, vectors_mut};
use pulp::{Arch, Simd, WithSimd};

/// Angles at which all points are evaluated, 3.75 degrees apart.
pub const ANGLES: usize = 96;
/// Steps of a quarter turn.
pub(super) const QUARTER: usize = ANGLES / 4;
/// Angles of a quarter turn that are added up together: sums of one alone would wait for each other.
const PLACES: usize = 5;
const _: () = assert!((QUARTER + 1).is_multiple_of(PLACES), "no angle of the quarter is left out");

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
pub(super) type Term = [Wide; 2];
/// Terms of the harmonics of a chunk of points, a list per stress; harmonics follow each other in even or odd multiples of the same.
pub(super) type Terms = [Vec<Term>; STRESSES];
/// Stresses of eight points at all angles.
pub(super) type ChunkStresses = Vec<[Wide; STRESSES]>;

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
pub(super) fn synthesise(terms: &Terms, step: usize, quarter: &[Waves], field: &mut ChunkStresses) {
    field.resize(ANGLES, [Wide::ZERO; STRESSES]);
    Arch::new().dispatch(Synthesis { terms, step, quarter, field });
}

/// The work of [`synthesise`].
struct Synthesis<'t> {
    terms: &'t Terms,
    step: usize,
    quarter: &'t [Waves],
    field: &'t mut ChunkStresses,
}

impl WithSimd for Synthesis<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { terms, step, quarter, field } = self;
        for vector in 0..WIDTH / S::F64_LANES {
            for stress in 0..STRESSES {
                let terms: &[Term] = &terms[stress];
                for (block, places) in quarter.as_chunks::<PLACES>().0.iter().enumerate() {
                    let sums = sums(simd, vector, terms, step, places);
                    for (place, [[ce, se], [co, so]]) in sums.into_iter().enumerate() {
                        let place = block * PLACES + place;
                        let (even, odd) = (simd.add_f64s(ce, so), simd.add_f64s(co, se));
                        let (even_back, odd_back) = (simd.sub_f64s(ce, so), simd.sub_f64s(co, se));
                        let mut set = |place: usize, value| vectors_mut::<S>(&mut field[place][stress])[vector] = value;
                        set(place, simd.add_f64s(even, odd));
                        set((ANGLES - place) % ANGLES, simd.add_f64s(even_back, odd_back));
                        set(ANGLES / 2 - place, simd.sub_f64s(even, odd));
                        set(ANGLES / 2 + place, simd.sub_f64s(even_back, odd_back));
                    }
                }
            }
        }
    }
}

/// Cosine and sine sums of the even and the odd harmonics at some angles, in one vector of the points.
#[inline(always)]
fn sums<S: Simd>(simd: S, vector: usize, terms: &[Term], step: usize, places: &[Waves; PLACES]) -> [[[S::f64s; 2]; 2]; PLACES] {
    let zero = simd.splat_f64s(0.0);
    let mut sums = [[[zero; 2]; 2]; PLACES];
    let (odds, stride) = if step % 2 == 1 { (1, 2) } else { (terms.len(), 1) };
    for odd in 0..2 {
        let (mut cosines, mut sines) = ([zero; PLACES], [zero; PLACES]);
        for number in (odd * odds..terms.len()).step_by(stride) {
            let [cosine, sine] = &terms[number];
            let (cosine, sine) = (vectors::<S>(cosine)[vector], vectors::<S>(sine)[vector]);
            for place in 0..PLACES {
                let wave = places[place].0[number * step];
                cosines[place] = simd.add_f64s(cosines[place], simd.mul_f64s(simd.splat_f64s(wave.0), cosine));
                sines[place] = simd.add_f64s(sines[place], simd.mul_f64s(simd.splat_f64s(wave.1), sine));
            }
        }
        for place in 0..PLACES {
            sums[place][odd] = [cosines[place], sines[place]];
        }
    }
    sums
}

/// Squares of the von Mises stresses of eight points.
#[inline(always)]
fn squares(stress: &[Wide; STRESSES]) -> [f64; CHUNK] {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_of_the_harmonics_with_all_vectors() {
        // Odd multiples of the harmonics go two by two, even ones one by one.
        for (step, orders) in [(1, 25), (3, 9), (4, 7)] {
            let value =
                |number: usize, stress: usize, lane: usize, sine: usize| ((number * 5 + stress * 3 + lane * 7 + sine) % 13) as f64 - 6.3;
            let term =
                |number: usize, stress: usize| [0, 1].map(|sine| Wide(std::array::from_fn(|lane| value(number, stress, lane, sine))));
            let terms: Terms = std::array::from_fn(|stress| (0..orders).map(|number| term(number, stress)).collect());
            let angle = |place: usize| std::f64::consts::TAU * place as f64 / ANGLES as f64;
            let quarter: Vec<Waves> = (0..=QUARTER).map(|place| Waves::new(angle(place), step * orders)).collect();
            let mut field = ChunkStresses::new();
            synthesise(&terms, step, &quarter, &mut field);
            for (place, stresses) in field.iter().enumerate() {
                for (stress, lane) in (0..STRESSES).flat_map(|stress| (0..WIDTH).map(move |lane| (stress, lane))) {
                    let wave = |number: usize| (angle(place) * (step * number) as f64).sin_cos();
                    let share =
                        |number: usize| value(number, stress, lane, 0) * wave(number).1 + value(number, stress, lane, 1) * wave(number).0;
                    let expected: f64 = (0..orders).map(share).sum();
                    let found = stresses[stress][lane];
                    assert!((found - expected).abs() < 1e-11, "step {step}, place {place}: {found} {expected}");
                }
            }
            let bits = |field: &ChunkStresses| field.iter().flatten().flat_map(|it| it.0.map(f64::to_bits)).collect::<Vec<_>>();
            let narrower = |sum: &dyn Fn(Synthesis<'_>)| {
                let mut narrow = vec![[Wide::ZERO; STRESSES]; ANGLES];
                sum(Synthesis { terms: &terms, step, quarter: &quarter, field: &mut narrow });
                bits(&narrow)
            };
            assert_eq!(narrower(&|work| Simd::vectorize(pulp::Scalar, work)), bits(&field), "one number at a time");
            #[cfg(target_arch = "x86_64")]
            if let Some(vectors) = pulp::x86::V3::try_new() {
                assert_eq!(narrower(&|work| Simd::vectorize(vectors, work)), bits(&field), "AVX2");
            }
        }
    }
}
