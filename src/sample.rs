//! Sampled designs: design `i` is a function of the study and `i` alone, so a sample is swept like a grid.

use crate::spread::{SobolSequence, permuted};
use crate::study::{Axis, Levels, Method, Sample};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

pub(crate) use crate::spread::mix;

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
    /// Without dimensions unless it is needed; and a random shift per axis.
    sobol: SobolSequence,
    shifts: Vec<u64>,
}

impl Sampler {
    /// A sampler over the design axes of a study.
    pub fn new(sample: Sample, axes: &[Axis]) -> Self {
        let dimensions = if sample.method == Method::Sobol { axes.len() } else { 0 };
        let mut random = ChaCha8Rng::seed_from_u64(sample.seed);
        let columns: Vec<_> =
            axes.iter().enumerate().flat_map(|(axis, it)| (0..it.inputs().len()).map(move |column| (axis, column))).collect();
        Self {
            inputs: columns.iter().map(|&(axis, column)| axes[axis].inputs()[column]).collect(),
            columns,
            sobol: SobolSequence::new(dimensions),
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
        value_at(&self.axes[axis], column, self.unit(axis, index))
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
            Method::Sobol => to_unit(self.sobol.point(axis, index) ^ self.shifts[axis]),
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

/// The value that an axis gives its input number `column` at a place in [0, 1): of a whole range, or one of its levels, each as likely.
pub(crate) fn value_at(axis: &Axis, column: usize, place: f64) -> f64 {
    match axis {
        Axis::Single { levels: Levels::Continuous { from, to, log: false }, .. } => (from + place * (to - from)).min(from.max(*to)),
        Axis::Single { levels: Levels::Continuous { from, to, log: true }, .. } => {
            let (low, high) = (libm::log(*from), libm::log(*to));
            libm::exp(low + place * (high - low)).clamp(from.min(*to), from.max(*to))
        }
        levels => levels.value(column, level_of(place, levels.count())),
    }
}

/// One of `count` levels, each as likely.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss, reason = "place is in [0, 1)")]
fn level_of(place: f64, count: u64) -> u64 {
    ((place * count as f64) as u64).min(count - 1)
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
