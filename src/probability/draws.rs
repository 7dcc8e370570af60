//! Draws: values of all uncertain inputs, number by number.

use super::correlation::Factor;
use super::distribution::Distribution;
use super::problem::ProbabilityProblem;
use super::special::{normal_below, normal_quantile};
use crate::likeness::remedy;
use crate::spread::{SobolSequence, mix, permuted};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use sha2::{Digest, Sha256};
use std::ops::Range;

/// Bits of a drawn probability: with one half more it stays an f64, and 1 less it too.
const BITS: u32 = 52;
/// Most draws.
const MOST_DRAWS: u64 = 1_000_000_000;
/// Fewer replicates would not tell how much they differ.
const LEAST_REPLICATES: u64 = 16;

/// How draws are spread over the probabilities from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Sampling {
    /// Independently. Only of such draws a count has a [confidence interval](super::clopper_pearson).
    Random,
    /// Each replicate has one draw in each of as many equally likely ranges of every input.
    LatinHypercube {
        /// Independent hypercubes that the draws are divided into, at least 16: what they differ by gives the
        /// [standard error](super::replicated).
        replicates: u64,
    },
    /// Each replicate has points of Sobol, scrambled after Owen; a power of two of them.
    Sobol {
        /// Independent scramblings that the draws are divided into, at least 16.
        replicates: u64,
    },
}

/// Draws of all uncertain inputs.
///
/// A draw is a function of the seed, the names and distributions of the inputs, their correlations and its number, and of nothing else:
/// not of the order of the inputs, nor of the machine. Of [random](Sampling::Random) draws the first are the same however many there are,
/// and an input without correlations is drawn the same whatever other inputs there are.
///
/// ```
/// use beltspace::probability::{Distribution, Draws, Sampling};
///
/// let inputs = [("friction", Distribution::normal(0.08, 0.006)?), ("load_N", Distribution::gumbel(570.0, 40.0)?)];
/// let draws = Draws::new(&inputs, 4096, Sampling::Random, 1)?.correlated(&[("friction", "load_N", -0.3)])?;
/// let columns = draws.columns(0..4096);
/// assert!((columns[0].iter().sum::<f64>() / 4096.0 - 0.08).abs() < 0.0004);
/// assert_eq!(draws.columns(17..18)[1][0], columns[1][17]);
/// # Ok::<(), beltspace::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Draws {
    inputs: Vec<DrawnInput>,
    /// The inputs in the order of their names.
    sorted: Vec<usize>,
    /// In that order.
    factor: Option<Factor>,
    sampling: Sampling,
    sobol: SobolSequence,
    count: u64,
    seed: u64,
}

#[derive(Clone, Debug)]
struct DrawnInput {
    name: String,
    distribution: Distribution,
    /// Place among the sorted names.
    rank: usize,
    /// Key of its random numbers.
    key: [u8; 32],
}

/// What random numbers are for: each purpose has its own.
#[derive(Clone, Copy)]
enum Purpose {
    Choosing,
    Confirming,
}

fn key(purpose: Purpose, seed: u64, name: &str) -> [u8; 32] {
    let word = match purpose {
        Purpose::Choosing => "choosing",
        Purpose::Confirming => "confirming",
    };
    Sha256::new().chain_update(word).chain_update(seed.to_le_bytes()).chain_update(name).finalize().into()
}

impl Draws {
    /// `count` draws of inputs, which have distributions by name, spread by `sampling`.
    ///
    /// # Errors
    /// `count` is not between 1 and 1e9, a name stands there twice, there are less than 16 replicates, the draws cannot be divided into
    /// them (for Sobol into powers of two), or more than 100 inputs want Sobol points.
    pub fn new(inputs: &[(&str, Distribution)], count: u64, sampling: Sampling, seed: u64) -> Result<Self, ProbabilityProblem> {
        check_count("draws", count)?;
        check_replicates(count, sampling)?;
        let mut sorted: Vec<_> = (0..inputs.len()).collect();
        sorted.sort_by_key(|&input| inputs[input].0);
        if let Some(pair) = sorted.windows(2).find(|pair| inputs[pair[0]].0 == inputs[pair[1]].0) {
            return Err(ProbabilityProblem::Twice { name: inputs[pair[0]].0.to_owned() });
        }
        let dimensions = if matches!(sampling, Sampling::Sobol { .. }) { inputs.len() } else { 0 };
        if dimensions > SobolSequence::MOST_DIMENSIONS {
            return Err(ProbabilityProblem::Dimensions { inputs: dimensions, most: SobolSequence::MOST_DIMENSIONS });
        }
        let inputs = inputs.iter().enumerate().map(|(place, (name, distribution))| DrawnInput {
            name: (*name).to_owned(),
            distribution: distribution.clone(),
            rank: sorted.iter().position(|&input| input == place).unwrap_or(0),
            key: key(Purpose::Choosing, seed, name),
        });
        Ok(Self { inputs: inputs.collect(), sorted, factor: None, sampling, sobol: SobolSequence::new(dimensions), count, seed })
    }

    /// The same with correlations of pairs of inputs, in place of any before; pairs that are not named have none.
    ///
    /// They are those of the normal scores (a Gaussian copula): of the standard normal numbers with the same probability below them. Values
    /// of a discrete distribution rise with their score.
    ///
    /// # Errors
    /// An input has no distribution, a pair is named twice or is one input, a correlation is not between -1 and 1, or no numbers can have
    /// all of these correlations; then the message names the pair that needs the least change, and its limits.
    pub fn correlated(mut self, pairs: &[(&str, &str, f64)]) -> Result<Self, ProbabilityProblem> {
        let names: Vec<_> = self.sorted.iter().map(|&input| self.inputs[input].name.as_str()).collect();
        let place = |name: &str| {
            let known = || if names.is_empty() { "no input has".to_owned() } else { format!("these have: {}", names.join(", ")) };
            let unknown = || ProbabilityProblem::NotUncertain { name: name.to_owned(), remedy: remedy(name, &names, known) };
            names.iter().position(|it| *it == name).ok_or_else(unknown)
        };
        let mut matrix: Vec<Vec<f64>> = (0..names.len()).map(|i| (0..names.len()).map(|j| f64::from(u8::from(i == j))).collect()).collect();
        let mut seen = Vec::new();
        for &(first, second, value) in pairs {
            let (a, b) = (place(first)?, place(second)?);
            let (first, second) = (first.to_owned(), second.to_owned());
            if a == b || seen.contains(&(a.min(b), a.max(b))) {
                return Err(ProbabilityProblem::Pair { first, second });
            }
            if value.is_nan() || value.abs() >= 1.0 {
                return Err(ProbabilityProblem::Correlation { first, second, value, low: -1.0, high: 1.0 });
            }
            seen.push((a.min(b), a.max(b)));
            (matrix[a][b], matrix[b][a]) = (value, value);
        }
        self.factor = Some(Factor::of(&matrix, &names)?);
        Ok(self)
    }

    /// `count` fresh random draws of the same inputs with the same correlations: independent of these, to judge what these have chosen.
    ///
    /// # Errors
    /// `count` is not between 1 and 1e9.
    pub fn confirming(&self, count: u64) -> Result<Self, ProbabilityProblem> {
        check_count("confirm", count)?;
        let mut fresh = self.clone();
        for input in &mut fresh.inputs {
            input.key = key(Purpose::Confirming, self.seed, &input.name);
        }
        (fresh.count, fresh.sampling) = (count, Sampling::Random);
        Ok(fresh)
    }

    /// Number of draws.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Values of the draws numbered `range`, one column for each input in the order they were given.
    ///
    /// # Panics
    /// The range goes beyond the [count](Self::count).
    pub fn columns(&self, range: Range<u64>) -> Vec<Vec<f64>> {
        assert!(range.end <= self.count, "there are {} draws, and {range:?} goes beyond", self.count);
        let probabilities: Vec<_> = self.inputs.iter().map(|input| self.probabilities(input, range.clone())).collect();
        let Some(factor) = &self.factor else {
            let values = |(input, column): (&DrawnInput, Vec<f64>)| column.into_iter().map(|below| input.value(below)).collect();
            return self.inputs.iter().zip(probabilities).map(values).collect();
        };
        let score = |input: usize| probabilities[input].iter().map(|below| normal_quantile(*below, 1.0 - below)).collect::<Vec<_>>();
        let scores: Vec<_> = self.sorted.iter().map(|&input| score(input)).collect();
        let column = |(place, input): (usize, &DrawnInput)| -> Vec<f64> {
            if factor.is_alone(input.rank) {
                return probabilities[place].iter().map(|below| input.value(*below)).collect();
            }
            let values = (0..probabilities[place].len()).map(|draw| {
                let score = factor.correlated(input.rank, |other| scores[other][draw]);
                input.distribution.value(normal_below(score), normal_below(-score))
            });
            values.collect()
        };
        self.inputs.iter().enumerate().map(column).collect()
    }

    /// The probability below each value of an input, were it independent of the others: odd multiples of 2^-53.
    fn probabilities(&self, input: &DrawnInput, range: Range<u64>) -> Vec<f64> {
        let mut random = ChaCha8Rng::from_seed(input.key);
        // What holds for a replicate as a whole is in a stream of its own.
        let of_replicate = |place: u64| {
            let mut random = ChaCha8Rng::from_seed(input.key);
            random.set_stream(1);
            random.set_word_pos(u128::from(place) * 2);
            random
        };
        match self.sampling {
            Sampling::Random => {
                random.set_word_pos(u128::from(range.start) * 2);
                range.map(|_| to_probability(random.next_u64() >> (64 - BITS))).collect()
            }
            Sampling::LatinHypercube { replicates } => {
                let size = self.count / replicates;
                random.set_word_pos(u128::from(range.start) * 2);
                let mut permutation = (u64::MAX, 0);
                let mut place = |draw: u64| {
                    if permutation.0 != draw / size {
                        permutation = (draw / size, of_replicate(draw / size).next_u64());
                    }
                    permuted(draw % size, size, permutation.1)
                };
                range.map(|draw| to_probability(within(place(draw), random.next_u64() >> (64 - BITS), size))).collect()
            }
            Sampling::Sobol { replicates } => {
                let size = self.count / replicates;
                let mut scramble = (u64::MAX, [0; BITS as usize]);
                let mut scrambled = |draw: u64| {
                    if scramble.0 != draw / size {
                        let mut random = of_replicate(draw / size * u64::from(BITS));
                        scramble = (draw / size, std::array::from_fn(|_| random.next_u64()));
                    }
                    owen(self.sobol.point(input.rank, draw % size) >> (64 - BITS), &scramble.1)
                };
                range.map(|draw| to_probability(scrambled(draw))).collect()
            }
        }
    }
}

impl DrawnInput {
    fn value(&self, below: f64) -> f64 {
        self.distribution.value(below, 1.0 - below)
    }
}

fn check_count(parameter: &'static str, count: u64) -> Result<(), ProbabilityProblem> {
    if (1..=MOST_DRAWS).contains(&count) {
        return Ok(());
    }
    Err(ProbabilityProblem::Parameter { of: "probability", parameter, value: count as f64, limit: "between 1 and 1e9" })
}

fn check_replicates(draws: u64, sampling: Sampling) -> Result<(), ProbabilityProblem> {
    let (name, replicates, of_what) = match sampling {
        Sampling::Random => return Ok(()),
        Sampling::LatinHypercube { replicates } => ("latin-hypercube", replicates, ""),
        Sampling::Sobol { replicates } => ("sobol", replicates, " of a power of two each"),
    };
    if !(LEAST_REPLICATES..=MOST_DRAWS).contains(&replicates) {
        return Err(ProbabilityProblem::Parameter {
            of: name,
            parameter: "replicates",
            value: replicates as f64,
            limit: "between 16 and 1e9",
        });
    }
    let each = draws.div_ceil(replicates);
    let each = if of_what.is_empty() { each } else { each.next_power_of_two() };
    if each * replicates == draws {
        return Ok(());
    }
    Err(ProbabilityProblem::Replicates { sampling: name, draws, replicates, of_what, nearest: each * replicates })
}

/// The middle of range number `place` of 2^52.
fn to_probability(place: u64) -> f64 {
    (2 * place + 1) as f64 / (1u64 << (BITS + 1)) as f64
}

/// The place, of 2^52, of a number that lies in range `stratum` of `count` and there at `bits` of 2^52.
fn within(stratum: u64, bits: u64, count: u64) -> u64 {
    let place = ((u128::from(stratum) << BITS) + u128::from(bits)) / u128::from(count);
    u64::try_from(place).unwrap_or(u64::MAX).min((1 << BITS) - 1)
}

/// Owen's nested scrambling: each bit may be flipped, as chance decides for it and the bits above it together.
fn owen(place: u64, keys: &[u64; BITS as usize]) -> u64 {
    let flip = |(bit, key): (u32, &u64)| (mix(mix(place >> (BITS - bit)) ^ key) >> 63) << (BITS - 1 - bit);
    place ^ (0..BITS).zip(keys).map(flip).fold(0, |flips, flip| flips | flip)
}

/// What a drawn number does to the value that a design says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// It is the value: what the design says does not matter.
    Is,
    /// A factor, for a tolerance relative to what the design says.
    Times,
    /// An addend, for a tolerance in the unit of the value.
    Plus,
}

impl Effect {
    /// The actual value where the design says `nominal`.
    pub fn of(self, nominal: f64, drawn: f64) -> f64 {
        match self {
            Self::Is => drawn,
            Self::Times => nominal * drawn,
            Self::Plus => nominal + drawn,
        }
    }

    /// A distribution in words, after "times" or "plus" if it is a tolerance.
    pub(crate) fn in_words_with(self, law: &str) -> String {
        match self {
            Self::Is => law.to_owned(),
            Self::Times => format!("times {law}"),
            Self::Plus => format!("plus {law}"),
        }
    }
}
