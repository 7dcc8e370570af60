//! Correlated numbers: a matrix of correlations, checked and factored.

use super::problem::ProbabilityProblem;

/// What must be left of the variance of a number once the numbers before it are known: less is rounding.
const LEAST_VARIANCE: f64 = 1e-10;

/// The lower triangle L with L L' = the matrix, which turns independent normal scores into correlated ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    rows: Vec<Vec<f64>>,
}

impl Factor {
    /// Factors the matrix of all correlations of the inputs called `names`.
    pub fn of(matrix: &[Vec<f64>], names: &[&str]) -> Result<Self, ProbabilityProblem> {
        let all: Vec<_> = (0..names.len()).collect();
        match factored(matrix, &all) {
            Ok(rows) => Ok(Self { rows }),
            Err(failed) => Err(nearest_remedy(matrix, names, all[..=failed].to_vec())),
        }
    }

    /// Score number `row` by the independent ones.
    pub fn correlated(&self, row: usize, score: impl Fn(usize) -> f64) -> f64 {
        self.rows[row].iter().enumerate().filter(|(_, factor)| **factor != 0.0).map(|(column, factor)| factor * score(column)).sum()
    }

    /// The independent score that gives score number `row` this value, where `score` tells the independent ones before it.
    pub fn independent(&self, row: usize, value: f64, score: impl Fn(usize) -> f64) -> f64 {
        let before: f64 = self.rows[row][..row].iter().enumerate().map(|(column, factor)| factor * score(column)).sum();
        (value - before) / self.rows[row][row]
    }

    /// Does the number depend on no other?
    pub fn is_alone(&self, row: usize) -> bool {
        self.rows[row].iter().rev().skip(1).all(|factor| *factor == 0.0)
    }
}

/// Cholesky's factor of the matrix of some numbers, or the place of the first whose variance the ones before it use up.
fn factored(matrix: &[Vec<f64>], some: &[usize]) -> Result<Vec<Vec<f64>>, usize> {
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for (place, &number) in some.iter().enumerate() {
        let mut row = Vec::with_capacity(place + 1);
        for (before, &other) in some[..place].iter().enumerate() {
            row.push((matrix[number][other] - dot(&row, &rows[before][..before])) / rows[before][before]);
        }
        let variance = 1.0 - dot(&row, &row);
        if variance < LEAST_VARIANCE {
            return Err(place);
        }
        row.push(libm::sqrt(variance));
        rows.push(row);
    }
    Ok(rows)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Of numbers whose correlations are impossible together: the pair whose correlation is nearest to what the others allow.
fn nearest_remedy(matrix: &[Vec<f64>], names: &[&str], mut some: Vec<usize>) -> ProbabilityProblem {
    // Whoever can be left out has no part in it; then each pair alone is what stands in the way, and has a range of its own.
    let mut place = 0;
    while place < some.len() {
        let mut fewer = some.clone();
        fewer.remove(place);
        if factored(matrix, &fewer).is_err() {
            some = fewer;
        } else {
            place += 1;
        }
    }
    let mut best: Option<(f64, ProbabilityProblem)> = None;
    for (place, &first) in some.iter().enumerate() {
        for &second in &some[place + 1..] {
            let mut order: Vec<_> = some.iter().copied().filter(|it| *it != first && *it != second).collect();
            order.push(first);
            let Ok(rows) = factored(matrix, &order) else { continue };
            let others = order.len() - 1;
            let mut last = Vec::with_capacity(others);
            for before in 0..others {
                last.push((matrix[second][order[before]] - dot(&last, &rows[before][..before])) / rows[before][before]);
            }
            let middle = dot(&last, &rows[others][..others]);
            let half = rows[others][others] * libm::sqrt((1.0 - dot(&last, &last)).max(0.0));
            let (value, low, high) = (matrix[first][second], middle - half, middle + half);
            let distance = (low - value).max(value - high);
            if best.as_ref().is_none_or(|(least, _)| distance < *least) {
                let (first, second) = (names[first].to_owned(), names[second].to_owned());
                best = Some((distance, ProbabilityProblem::Correlation { first, second, value, low, high }));
            }
        }
    }
    best.expect("two numbers at least are impossible together").1
}
