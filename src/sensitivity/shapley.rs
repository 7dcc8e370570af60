//! Shapley effects: each input's mean contribution over all orders in which the inputs become known (Owen 2014).

use super::sobol::all_of;
use crate::probability::{Distribution, Draws, ProbabilityProblem, Sampling};
use std::collections::BTreeSet;

/// Sets of more inputs would be too many.
const MOST_INPUTS: usize = 20;
/// Up to so many inputs all sets are looked at where each set takes many evaluations.
const MOST_IN_ALL_SETS: usize = 10;
/// Orders of more inputs, drawn at random.
const ORDERS: u64 = 64;

/// The shares of `count` inputs in what all of them explain together, which they add up to.
///
/// `explained` is the variance that a set of inputs explains, Var(E(Y | these)), for the bits of its argument: bit 0 is the first input.
/// It is called once for each of the 2^count sets; what it says of the empty set is subtracted from every other.
///
/// # Errors
/// `count` is not between 1 and 20.
pub fn shapley_effects(count: usize, explained: impl Fn(u32) -> f64) -> Result<Vec<f64>, ProbabilityProblem> {
    if !(1..=MOST_INPUTS).contains(&count) {
        return Err(ProbabilityProblem::Parameter { of: "shapley", parameter: "inputs", value: count as f64, limit: "between 1 and 20" });
    }
    let of_set: Vec<_> = (0..1u32 << count).map(explained).collect();
    // Of the orders of all inputs, those in which exactly the inputs of a set of this size come before: 1/(n (n-1 choose size)).
    let mut weights = vec![1.0 / count as f64];
    for size in 1..count {
        weights.push(weights[size - 1] * size as f64 / (count - size) as f64);
    }
    let effect = |input: usize| -> f64 {
        let without = (0..1usize << count).filter(|set| set >> input & 1 == 0);
        without.map(|set| weights[set.count_ones() as usize] * (of_set[set | 1 << input] - of_set[set])).sum()
    };
    Ok((0..count).map(effect).collect())
}

/// The sets of inputs that Shapley effects are computed from: all sets, or of many inputs those along some orders.
pub(crate) enum ShapleySets {
    /// All sets of so many inputs.
    All(usize),
    /// Those along these orders.
    Along(Vec<Vec<usize>>),
}

impl ShapleySets {
    /// For `count` inputs: all sets of up to 10; else those along 64 orders, chosen by `seed`.
    ///
    /// # Errors
    /// There are no inputs.
    pub(crate) fn new(count: usize, seed: u64) -> Result<Self, ProbabilityProblem> {
        if count <= MOST_IN_ALL_SETS {
            return Ok(Self::All(count));
        }
        let unit = Distribution::uniform(0.0, 1.0)?;
        let names: Vec<_> = (0..count).map(|input| format!("order {input}")).collect();
        let chances: Vec<_> = names.iter().map(|name| (name.as_str(), unit.clone())).collect();
        let chances = Draws::new(&chances, ORDERS, Sampling::Random, seed)?.columns(0..ORDERS);
        let order = |number: usize| {
            let mut order: Vec<usize> = (0..count).collect();
            order.sort_by(|&a, &b| chances[a][number].total_cmp(&chances[b][number]));
            order
        };
        Ok(Self::Along((0..ORDERS as usize).map(order).collect()))
    }

    /// Number of orders, if not all sets are looked at.
    pub(crate) fn orders(&self) -> Option<usize> {
        if let Self::Along(orders) = self { Some(orders.len()) } else { None }
    }

    /// The sets whose explained variance is needed, in order.
    pub(crate) fn needed(&self) -> Vec<u64> {
        match self {
            Self::All(count) => (0..=all_of(*count)).collect(),
            Self::Along(orders) => {
                let sets: BTreeSet<u64> = orders.iter().flat_map(|order| prefixes(order)).collect();
                sets.into_iter().collect()
            }
        }
    }

    /// Of each input: its effect, and what the orders differ by, as the standard error of their mean; 0 where all sets are looked at.
    ///
    /// # Errors
    /// There are no inputs.
    pub(crate) fn effects(&self, explained: impl Fn(u64) -> f64) -> Result<Vec<(f64, f64)>, ProbabilityProblem> {
        match self {
            Self::All(count) => Ok(shapley_effects(*count, |set| explained(u64::from(set)))?.into_iter().map(|it| (it, 0.0)).collect()),
            Self::Along(orders) => {
                let mut steps: Vec<Vec<f64>> = vec![Vec::new(); orders.first().map_or(0, Vec::len)];
                for order in orders {
                    let values: Vec<f64> = prefixes(order).map(&explained).collect();
                    order.iter().zip(values.windows(2)).for_each(|(&input, pair)| steps[input].push(pair[1] - pair[0]));
                }
                Ok(steps.iter().map(|steps| mean_and_error(steps)).collect())
            }
        }
    }
}

/// The sets of the first inputs of an order, from none to all.
fn prefixes(order: &[usize]) -> impl Iterator<Item = u64> + '_ {
    (0..=order.len()).map(|length| order[..length].iter().fold(0, |set, input| set | 1 << input))
}

/// The mean of independent values, and its standard error.
fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|it| (it - mean) * (it - mean)).sum();
    (mean, libm::sqrt(squares / (count - 1.0) / count))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_agree_with_all_sets_within_their_error() {
        // Twelve inputs, of which pairs explain something together: each has its own part and half of the pair's.
        let part = |input: usize| (input + 1) as f64;
        let explained = |set: u64| -> f64 {
            let own: f64 = (0..12).filter(|input| set >> input & 1 == 1).map(part).sum();
            own + (0..6).filter(|pair| set >> (2 * pair) & 3 == 3).map(|pair| 10.0 * part(pair)).sum::<f64>()
        };
        let sets = ShapleySets::new(12, 1).expect("there are inputs");
        assert_eq!(sets.orders(), Some(64));
        let effects = sets.effects(explained).expect("there are inputs");
        let whole: f64 = effects.iter().map(|it| it.0).sum();
        assert!((whole - explained(all_of(12))).abs() < 1e-9, "they add up: {whole}");
        let exact = shapley_effects(12, |set| explained(u64::from(set))).expect("twelve are not too many");
        for (input, (effect, error)) in effects.iter().enumerate() {
            let truth = part(input) + 5.0 * part(input / 2);
            assert!((exact[input] - truth).abs() < 1e-9);
            assert!(*error > 0.0 && (effect - truth).abs() < 4.0 * error, "{effect} {error} {truth}");
        }
        assert!(sets.needed().len() < 64 * 12 && sets.needed().contains(&0) && sets.needed().contains(&all_of(12)));
    }

    #[test]
    fn few_inputs_have_all_their_sets() {
        let sets = ShapleySets::new(3, 1).expect("there are inputs");
        assert_eq!((sets.orders(), sets.needed()), (None, (0..8).collect()));
        // Three parts of 1, 2 and 4.
        assert_eq!(sets.effects(|set| set as f64).expect("there are inputs"), [(1.0, 0.0), (2.0, 0.0), (4.0, 0.0)]);
    }
}
