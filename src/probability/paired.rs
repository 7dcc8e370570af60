//! Two sets of draws, and draws that have some inputs from the first set: what these inputs have in common is known, the rest is drawn again.
//!
//! With correlations the rest is drawn as it is likely beside the inputs that are known: normal scores are drawn from their conditional
//! distribution.

use super::correlation::Factor;
use super::distribution::Distribution;
use super::draws::{Draws, Sampling};
use super::problem::ProbabilityProblem;
use super::special::{normal_below, normal_quantile};

/// Independent sets of draws, whose differences give the standard errors.
pub const REPLICATES: u64 = 16;

/// Two sets of scrambled Sobol points of the same inputs, independent of each other.
pub struct PairedDraws {
    names: Vec<String>,
    laws: Vec<Distribution>,
    /// Of each input: the probability below each draw, in the first and in the second set, before correlations.
    first: Vec<Vec<f64>>,
    second: Vec<Vec<f64>>,
    /// Correlations of the normal scores.
    matrix: Vec<Vec<f64>>,
    /// Inputs with a correlation.
    correlated: Vec<usize>,
    /// Of each of these: its correlated scores in the first set, and its independent scores in the second.
    scores: Vec<(Vec<f64>, Vec<f64>)>,
}

impl PairedDraws {
    /// `draws` of each set; pairs of inputs have these correlations, by position.
    ///
    /// # Errors
    /// As [`Draws::new`] for twice the inputs, and [`Draws::correlated`].
    pub fn new(
        inputs: &[(&str, Distribution)],
        correlation: &[(usize, usize, f64)],
        draws: u64,
        seed: u64,
    ) -> Result<Self, ProbabilityProblem> {
        let unit = Distribution::uniform(0.0, 1.0)?;
        let again: Vec<_> = inputs.iter().map(|(name, _)| format!("{name} again")).collect();
        let names = || inputs.iter().map(|it| it.0);
        let twice: Vec<_> = names().chain(again.iter().map(String::as_str)).map(|name| (name, unit.clone())).collect();
        let mut first = Draws::new(&twice, draws, Sampling::Sobol { replicates: REPLICATES }, seed)?.columns(0..draws);
        let second = first.split_off(inputs.len());
        let mut matrix: Vec<Vec<f64>> =
            (0..inputs.len()).map(|i| (0..inputs.len()).map(|j| f64::from(u8::from(i == j))).collect()).collect();
        for &(a, b, value) in correlation {
            (matrix[a][b], matrix[b][a]) = (value, value);
        }
        let correlated: Vec<usize> = (0..inputs.len()).filter(|&i| (0..inputs.len()).any(|j| i != j && matrix[i][j] != 0.0)).collect();
        let mut drawn = Self {
            names: names().map(str::to_owned).collect(),
            laws: inputs.iter().map(|it| it.1.clone()).collect(),
            first,
            second,
            matrix,
            correlated,
            scores: Vec::new(),
        };
        let score = |column: &[f64]| column.iter().map(|below| normal_quantile(*below, 1.0 - below)).collect::<Vec<_>>();
        let factor = drawn.factor(&drawn.correlated)?;
        let own: Vec<_> = drawn.correlated.iter().map(|&input| score(&drawn.first[input])).collect();
        let correlated = |place: usize| (0..drawn.rows()).map(|row| factor.correlated(place, |other| own[other][row])).collect();
        drawn.scores =
            drawn.correlated.iter().enumerate().map(|(place, &input)| (correlated(place), score(&drawn.second[input]))).collect();
        Ok(drawn)
    }

    /// Draws of a set.
    pub fn rows(&self) -> usize {
        self.first.first().map_or(0, Vec::len)
    }

    /// The factor of the correlations of some inputs, in this order.
    fn factor(&self, some: &[usize]) -> Result<Factor, ProbabilityProblem> {
        let matrix: Vec<Vec<f64>> = some.iter().map(|&i| some.iter().map(|&j| self.matrix[i][j]).collect()).collect();
        let names: Vec<_> = some.iter().map(|&input| self.names[input].as_str()).collect();
        Factor::of(&matrix, &names)
    }

    /// A column of values for each input: those of the first set for the inputs whose bits are in `kept`, else drawn again.
    ///
    /// # Errors
    /// The correlations cannot be factored in the order that this needs.
    pub fn columns(&self, kept: u64) -> Result<Vec<Vec<f64>>, ProbabilityProblem> {
        let is_kept = |input: usize| kept >> input & 1 == 1;
        let alone = |input: usize| -> Vec<f64> {
            let column = if is_kept(input) { &self.first[input] } else { &self.second[input] };
            column.iter().map(|below| self.laws[input].value(*below, 1.0 - below)).collect()
        };
        let mut columns: Vec<Vec<f64>> =
            (0..self.laws.len()).map(|input| if self.correlated.contains(&input) { Vec::new() } else { alone(input) }).collect();
        // Those that are known come first, so that each of the others is drawn beside them.
        let (mut order, others): (Vec<_>, Vec<_>) = (0..self.correlated.len()).partition(|&place| is_kept(self.correlated[place]));
        order.extend(others);
        let inputs: Vec<usize> = order.iter().map(|&place| self.correlated[place]).collect();
        let factor = self.factor(&inputs)?;
        let mut independent = vec![0.0; inputs.len()];
        for row in 0..self.rows() {
            for (place, (&input, &known)) in inputs.iter().zip(&order).enumerate() {
                let (first, second) = &self.scores[known];
                let score = if is_kept(input) {
                    independent[place] = factor.independent(place, first[row], |other| independent[other]);
                    first[row]
                } else {
                    independent[place] = second[row];
                    factor.correlated(place, |other| independent[other])
                };
                columns[input].push(self.laws[input].value(normal_below(score), normal_below(-score)));
            }
        }
        Ok(columns)
    }
}

#[cfg(test)]
mod tests {
    use super::super::pearson;
    use super::*;

    #[test]
    fn what_is_drawn_again_has_the_correlations_and_is_otherwise_independent() {
        let normal = || Distribution::normal(0.0, 1.0).expect("it is a distribution");
        let inputs = [("a", normal()), ("b", normal()), ("c", normal()), ("d", normal())];
        // b depends on a and c, d on none.
        let draws = PairedDraws::new(&inputs, &[(0, 1, 0.6), (2, 1, -0.5)], 1 << 14, 1).expect("these are correlations");
        let all = draws.columns(0b1111).expect("they can be factored");
        let close = |x: &[f64], y: &[f64], expected: f64| {
            let found = pearson(x, y).expect("both vary");
            assert!((found - expected).abs() < 0.02, "{found} {expected}");
        };
        for kept in 0..16u64 {
            let mixed = draws.columns(kept).expect("they can be factored");
            for (first, second, expected) in [(0, 1, 0.6), (1, 2, -0.5), (0, 2, 0.0), (0, 3, 0.0)] {
                close(&mixed[first], &mixed[second], expected);
            }
            for input in 0..4 {
                if kept >> input & 1 == 1 {
                    assert!(mixed[input].iter().zip(&all[input]).all(|(a, b)| (a - b).abs() < 1e-12));
                }
            }
        }
        // Given a alone, b has 0.36 of its variance from a, so two draws of b beside the same a have the correlation 0.36.
        close(&draws.columns(0b0001).expect("they can be factored")[1], &all[1], 0.36);
        close(&draws.columns(0b0101).expect("they can be factored")[1], &all[1], 0.36 + 0.25);
        close(&draws.columns(0b1000).expect("they can be factored")[1], &all[1], 0.0);
    }
}
