//! Sampled designs: design `i` is a function of the study and `i` alone, so a sample is swept like a grid.

use crate::study::{Axis, Levels, Method, Sample};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use sobol::Sobol;
use sobol::params::JoeKuoD6;

/// Bits of a sampled number: as many as an f64 in [0, 1) holds.
const BITS: u32 = 53;

/// Designs spread over the ranges of the design axes.
#[derive(Debug)]
pub struct Sampler {
    sample: Sample,
    axes: Vec<Axis>,
    /// Axis and column within it, for every input that is set.
    columns: Vec<(usize, usize)>,
    inputs: Vec<usize>,
    /// Sobol direction numbers per axis, and a random shift per axis.
    directions: Vec<Vec<u64>>,
    shifts: Vec<u64>,
}

impl Sampler {
    /// A sampler over the design axes of a study.
    pub fn new(sample: Sample, axes: &[Axis]) -> Self {
        let directions = match sample.method {
            Method::Sobol => Sobol::<u64>::init_direction_vals::<u32>(axes.len(), 64, &JoeKuoD6::minimal()),
            Method::LatinHypercube | Method::Random => Vec::new(),
        };
        let mut random = ChaCha8Rng::seed_from_u64(sample.seed);
        let columns: Vec<_> =
            axes.iter().enumerate().flat_map(|(axis, it)| (0..it.inputs().len()).map(move |column| (axis, column))).collect();
        Self {
            inputs: columns.iter().map(|&(axis, column)| axes[axis].inputs()[column]).collect(),
            columns,
            directions,
            shifts: axes.iter().map(|_| random.next_u64()).collect(),
            axes: axes.to_vec(),
            sample,
        }
    }

    /// Number of samples.
    pub fn count(&self) -> u64 {
        self.sample.count
    }

    /// The inputs that a sample sets.
    pub fn inputs(&self) -> &[usize] {
        &self.inputs
    }

    /// The value of input number `column` in sample `index`.
    pub fn value(&self, column: usize, index: u64) -> f64 {
        let (axis, column) = self.columns[column];
        let place = self.unit(axis, index);
        match &self.axes[axis] {
            Axis::Single { levels: Levels::Continuous { from, to, log: false }, .. } => (from + place * (to - from)).min(from.max(*to)),
            Axis::Single { levels: Levels::Continuous { from, to, log: true }, .. } => {
                let (low, high) = (libm::log(*from), libm::log(*to));
                libm::exp(low + place * (high - low)).clamp(from.min(*to), from.max(*to))
            }
            levels => levels.value(column, level_of(place, levels.count())),
        }
    }

    /// The level or row of axis number `axis` in sample `index`.
    pub fn level(&self, axis: usize, index: u64) -> u64 {
        level_of(self.unit(axis, index), self.axes[axis].count())
    }

    /// Least and largest value of input number `column`.
    pub fn ends(&self, column: usize) -> (f64, f64) {
        let (axis, column) = self.columns[column];
        self.axes[axis].ends(column)
    }

    /// A number in [0, 1) for one axis of one sample.
    #[allow(clippy::cast_precision_loss, reason = "53 bits are exact")]
    fn unit(&self, axis: usize, index: u64) -> f64 {
        let to_unit = |bits: u64| (bits >> (64 - BITS)) as f64 / (1u64 << BITS) as f64;
        match self.sample.method {
            Method::Sobol => {
                let gray = index ^ index >> 1;
                let directions = &self.directions[axis];
                let point = (0..64).filter(|bit| gray >> bit & 1 == 1).fold(0, |point, bit| point ^ directions[bit as usize]);
                to_unit(point ^ self.shifts[axis])
            }
            Method::Random => to_unit(self.random(axis, index)),
            Method::LatinHypercube => {
                let count = self.sample.count;
                let stratum = permuted(index, count, self.shifts[axis]);
                let unit = (stratum as f64 + to_unit(self.random(axis, index))) / count as f64;
                unit.min(1.0 - f64::EPSILON / 2.0)
            }
        }
    }

    /// The random number of one axis of one sample: a stream per axis, read at the sample's place.
    fn random(&self, axis: usize, index: u64) -> u64 {
        let mut random = ChaCha8Rng::seed_from_u64(self.sample.seed);
        random.set_stream(axis as u64 + 1);
        random.set_word_pos(u128::from(index) * 2);
        random.next_u64()
    }
}

/// One of `count` levels, each as likely.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss, reason = "place is in [0, 1)")]
fn level_of(place: f64, count: u64) -> u64 {
    ((place * count as f64) as u64).min(count - 1)
}

/// The image of `index` under a random permutation of `0..count` that `key` chooses, without a table: a Feistel network over
/// the next even power of two, walked until it lands inside.
fn permuted(index: u64, count: u64, key: u64) -> u64 {
    let half = (64 - (count - 1).leading_zeros()).div_ceil(2).max(1);
    let mask = (1u64 << half) - 1;
    let mut x = index;
    loop {
        let (mut left, mut right) = (x >> half, x & mask);
        for round in 0..6u64 {
            let mixed = mix(right ^ key.rotate_left(round as u32 * 11) ^ round << 56);
            (left, right) = (right, left ^ (mixed & mask));
        }
        x = left << half | right;
        if x < count {
            return x;
        }
    }
}

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014): every input bit reaches every output bit.
pub(crate) fn mix(x: u64) -> u64 {
    let x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ x >> 31
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampler(method: Method, count: u64) -> Sampler {
        let continuous = |input| Axis::Single { input, levels: Levels::Continuous { from: 0.0, to: 1.0, log: false } };
        let integers = Axis::Single { input: 2, levels: Levels::Step { from: 1.0, step: 1.0, count: 4, log: false } };
        Sampler::new(Sample { method, count, seed: 7 }, &[continuous(0), continuous(1), integers])
    }

    #[test]
    fn a_permutation_hits_every_number_once() {
        for count in [1, 2, 3, 64, 1000, 4097] {
            let mut seen: Vec<_> = (0..count).map(|i| permuted(i, count, 99)).collect();
            assert!(count < 64 || seen.iter().enumerate().filter(|&(i, &x)| i as u64 == x).count() < 10, "it should mix");
            seen.sort_unstable();
            assert!(seen.into_iter().eq(0..count), "{count}");
        }
    }

    #[test]
    fn a_latin_hypercube_hits_every_stratum_once_and_sobol_every_box() {
        let latin = sampler(Method::LatinHypercube, 1000);
        for column in 0..2 {
            let mut strata: Vec<_> = (0..1000).map(|i| (latin.value(column, i) * 1000.0) as u64).collect();
            strata.sort_unstable();
            assert!(strata.into_iter().eq(0..1000));
        }
        // A (0, m, 2)-net: every elementary box of 1024 points has exactly one, also after a digital shift.
        let sobol = sampler(Method::Sobol, 1024);
        let mut boxes: Vec<_> = (0..1024).map(|i| (sobol.value(0, i) * 32.0) as u64 * 32 + (sobol.value(1, i) * 32.0) as u64).collect();
        boxes.sort_unstable();
        assert!(boxes.into_iter().eq(0..1024));
    }

    #[test]
    fn random_designs_are_spread_and_a_function_of_the_index() {
        let random = sampler(Method::Random, 10_000);
        let mean = (0..10_000).map(|i| random.value(0, i)).sum::<f64>() / 1e4;
        assert!((mean - 0.5).abs() < 0.02, "{mean}");
        assert_eq!(random.value(1, 123), sampler(Method::Random, 10_000).value(1, 123));
        let counts = (0..10_000).fold([0; 5], |mut counts, i| {
            counts[random.value(2, i) as usize] += 1;
            counts
        });
        assert!(counts[1..].iter().all(|&count| (2300..2700).contains(&count)), "{counts:?}");
    }
}
