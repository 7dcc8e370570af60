//! The variance of a quantity on all combinations of the levels of its inputs, taken apart exactly: what it is on average over the
//! combinations of a set of inputs, for each of their levels.

/// Values of a quantity on a grid, the last input fastest. Combinations that do not count have no weight.
pub(crate) struct GridTally {
    levels: Vec<usize>,
    /// Number of combinations that count, in each cell.
    counts: Vec<f64>,
    /// Sum of their values, less the mean of all.
    sums: Vec<f64>,
    /// Combinations that count.
    total: f64,
    mean: f64,
    variance: f64,
}

impl GridTally {
    /// From one value for each combination of the levels, `None` where a combination does not count; `None` if all values are the same, or
    /// there is none.
    pub(crate) fn new(levels: Vec<usize>, values: impl Iterator<Item = Option<f64>> + Clone) -> Option<Self> {
        let present = || values.clone().flatten();
        let first = present().next()?;
        if present().all(|it| it == first) {
            return None;
        }
        let total = present().count() as f64;
        let mean = present().sum::<f64>() / total;
        let counts = values.clone().map(|it| f64::from(u8::from(it.is_some()))).collect();
        let sums: Vec<f64> = values.map(|it| it.map_or(0.0, |it| it - mean)).collect();
        let variance = sums.iter().map(|it| it * it).sum::<f64>() / total;
        Some(Self { levels, counts, sums, total, mean, variance })
    }

    /// The mean of all values.
    pub(crate) fn mean(&self) -> f64 {
        self.mean
    }

    /// The variance of all values.
    pub(crate) fn variance(&self) -> f64 {
        self.variance
    }

    /// The variance that the inputs explain whose bits are in `known`: Var(E(Y | these)).
    pub(crate) fn explained(&self, known: u64) -> f64 {
        let mut sums = self.sums.clone();
        let mut counts = self.counts.clone();
        // From the last to the first, so that the strides of those before stay.
        let mut inner = 1;
        for (input, &count) in self.levels.iter().enumerate().rev() {
            if known >> input & 1 == 1 {
                inner *= count;
                continue;
            }
            sums = without(&sums, count, inner);
            counts = without(&counts, count, inner);
        }
        let between = sums.iter().zip(&counts).filter(|it| *it.1 > 0.0).map(|(sum, count)| sum * sum / count);
        between.sum::<f64>() / self.total
    }
}

/// Sums over a dimension of `count` levels, of which neighbours lie `inner` apart.
fn without(cells: &[f64], count: usize, inner: usize) -> Vec<f64> {
    let mut sums = vec![0.0; cells.len() / count];
    for (block, sums) in cells.chunks(count * inner).zip(sums.chunks_mut(inner)) {
        for level in block.chunks(inner) {
            sums.iter_mut().zip(level).for_each(|(sum, cell)| *sum += cell);
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensitivity::shapley_effects;

    #[test]
    fn a_sum_is_explained_by_its_parts_and_a_product_by_both() {
        // x of 0, 1, 2 and y of 0, 3: variances 2/3 and 9/4.
        let sum = GridTally::new(vec![3, 2], (0..6).map(|it| Some(f64::from(it / 2) + 3.0 * f64::from(it % 2)))).expect("it varies");
        for (known, truth) in [(0, 0.0), (1, 2.0 / 3.0), (2, 2.25), (3, 2.0 / 3.0 + 2.25)] {
            assert!((sum.explained(known) - truth).abs() < 1e-14, "{known}");
        }
        assert!((sum.mean() - 2.5).abs() < 1e-14 && (sum.variance() - 2.0 / 3.0 - 2.25).abs() < 1e-14);
        // Of a product of signs neither alone explains anything.
        let signs = GridTally::new(vec![2, 2], [1.0, -1.0, -1.0, 1.0].into_iter().map(Some)).expect("it varies");
        assert_eq!([0, 1, 2, 3].map(|known| signs.explained(known)), [0.0, 0.0, 0.0, 1.0]);
        assert!(
            GridTally::new(vec![2], [4.0, 4.0].into_iter().map(Some)).is_none() && GridTally::new(vec![1], [None].into_iter()).is_none()
        );
    }

    #[test]
    fn what_does_not_count_has_no_weight() {
        // Of x and y of 0 and 1 only (0, 0), (1, 0) and (1, 1) count; the quantity is y. E(y|x) is 0 for the one and 1/2 for the two others.
        let tally = GridTally::new(vec![2, 2], [Some(0.0), None, Some(0.0), Some(1.0)].into_iter()).expect("it varies");
        let mean: f64 = 1.0 / 3.0;
        let of_x = (mean * mean + 2.0 * (0.5 - mean) * (0.5 - mean)) / 3.0;
        assert!((tally.explained(1) - of_x).abs() < 1e-15 && (tally.explained(2) - tally.variance()).abs() < 1e-15);
        let effects = shapley_effects(2, |set| tally.explained(u64::from(set))).expect("two inputs");
        assert!((effects[0] - 0.5 * of_x).abs() < 1e-15 && (effects[0] + effects[1] - tally.variance()).abs() < 1e-15);
    }
}
