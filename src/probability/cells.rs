//! Boxes of draws: ranges of the probabilities of independent uniform numbers, and the values of the inputs that they stand for.
//!
//! The ends of a range are whole multiples of 2^-63, so that the probability of a box needs no distribution function. The quantiles of the
//! ends, and through Cholesky's factor those of correlated inputs, are intervals that surely hold the exact ones.

use super::correlation::Factor;
use super::distribution::Distribution;
use super::half_space::DIMENSIONS;
use super::outward::{Outward, Tail, normal_density, normal_score, normal_share};
use super::problem::ProbabilityProblem;
use super::special::normal_below;
use crate::real::Real;
use crate::tape::{EVERYTHING, Interval};
use rustc_hash::FxHashMap;

/// The probability 1 as a multiple of 2^-63.
const ONE: u64 = 1 << 63;
/// 2^-63.
const UNIT: f64 = 1.0 / ONE as f64;
/// A tail of an unbounded input has this share of the width asked for, divided by the number of inputs.
const TAIL: f64 = 1.0 / 16.0;

/// The range of probabilities of every input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawCell {
    /// Lower and upper end in multiples of 2^-63; those beyond the number of inputs are not read.
    sides: [(u64, u64); DIMENSIONS],
}

impl DrawCell {
    const WHOLE: Self = Self { sides: [(0, ONE); DIMENSIONS] };

    /// The two parts of a cell on either side of a place.
    pub fn split(&self, axis: usize, at: u64) -> [Self; 2] {
        let (mut below, mut above) = (*self, *self);
        (below.sides[axis].1, above.sides[axis].0) = (at, at);
        [below, above]
    }

    /// The part of a cell at one place along an axis.
    pub fn at(&self, axis: usize, place: u64) -> Self {
        let mut thin = *self;
        thin.sides[axis] = (place, place);
        thin
    }

    /// Where a place lies along an axis, from 0 to 1.
    pub fn within(&self, axis: usize, place: u64) -> f64 {
        let (low, high) = self.sides[axis];
        (place - low) as f64 / (high - low) as f64
    }

    /// Its share of all draws along an axis.
    pub fn side(&self, axis: usize) -> f64 {
        let (low, high) = self.sides[axis];
        (high - low) as f64 * UNIT
    }

    /// Its probability, rounded down.
    pub fn probability(&self) -> f64 {
        // An integer of 64 bits as f64 may round up, and each product too.
        const DOWN: f64 = 1.0 - 2.0 * f64::EPSILON;
        self.sides
            .iter()
            .filter(|side| **side != (0, ONE))
            .fold(1.0, |product, side| product * ((side.1 - side.0) as f64 * UNIT * DOWN) * DOWN)
    }
}

/// The probability at or below a place, or above it: exact.
fn tail(place: u64) -> Tail {
    let is_upper = place > ONE / 2;
    let multiple = if is_upper { ONE - place } else { place };
    Tail { share: multiple as f64 * UNIT, is_upper }
}

/// The nearest place of which a tail is exact in f64.
fn neat(place: u64) -> u64 {
    let is_upper = place > ONE / 2;
    let multiple = if is_upper { ONE - place } else { place };
    let kept = multiple & (u64::MAX << (64 - multiple.leading_zeros()).saturating_sub(f64::MANTISSA_DIGITS));
    if is_upper { ONE - kept } else { kept }
}

/// The place with about this probability below it.
fn place_of(tail: Tail) -> u64 {
    let multiple = (tail.share.clamp(0.0, 0.5) * ONE as f64) as u64;
    neat(if tail.is_upper { ONE - multiple } else { multiple })
}

/// Values of an input over a cell, and how they change from one side of the cell to the other.
#[derive(Clone, Copy, Debug)]
pub struct DrawnPoint<const N: usize> {
    /// In the unit of the distribution.
    pub value: Interval,
    /// Derivatives by the place within the cell, which goes from 0 to 1 along every axis.
    pub slopes: [Interval; N],
}

/// How an input follows from the independent numbers.
#[derive(Debug)]
enum Follows {
    /// From its own alone.
    Own,
    /// From a score that is the sum of these multiples of the independent scores.
    Scores(Vec<Interval>),
}

#[derive(Debug)]
struct CellInput {
    outward: Outward,
    follows: Follows,
    /// Where its values change, if they are single ones and follow from its own number alone: every place within the second range may be
    /// the exact one.
    jumps: Option<Vec<(u64, u64)>>,
    /// Quantiles of places, and of the normal scores there.
    quantiles: FxHashMap<u64, Interval>,
    scores: FxHashMap<u64, Interval>,
}

/// Uncertain inputs over cells.
#[derive(Debug)]
pub struct DrawCells<const N: usize> {
    inputs: Vec<CellInput>,
}

impl<const N: usize> DrawCells<N> {
    /// Of N inputs with these correlations of pairs of normal scores.
    ///
    /// # Errors
    /// No numbers can have all of these correlations.
    pub fn new(inputs: &[(&str, &Distribution)], correlation: &[(usize, usize, f64)]) -> Result<Self, ProbabilityProblem> {
        let names: Vec<&str> = inputs.iter().map(|it| it.0).collect();
        let mut matrix = vec![vec![0.0; inputs.len()]; inputs.len()];
        (0..inputs.len()).for_each(|it| matrix[it][it] = 1.0);
        for &(a, b, value) in correlation {
            (matrix[a][b], matrix[b][a]) = (value, value);
        }
        Factor::of(&matrix, &names)?;
        let factor = factored(&matrix);
        let input = |(place, (_, distribution)): (usize, &(&str, &Distribution))| {
            let outward = Outward::new(distribution);
            let is_alone = factor[place][..place].iter().all(|it| it.is_zero());
            let follows = if is_alone { Follows::Own } else { Follows::Scores(factor[place].clone()) };
            let jumps = outward.steps().filter(|_| is_alone).map(|steps| jumps(&steps));
            CellInput { outward, follows, jumps, quantiles: FxHashMap::default(), scores: FxHashMap::default() }
        };
        Ok(Self { inputs: inputs.iter().enumerate().map(input).collect() })
    }

    /// DrawCells that together are all draws: the tails of unbounded inputs, whose values have no bound, are cut off so that they have a small
    /// share of `width`.
    pub fn roots(&self, width: f64) -> Vec<DrawCell> {
        let share = (width.min(0.5) * TAIL / N as f64).max(2.0 * UNIT);
        let (low, high) = (place_of(Tail { share, is_upper: false }), place_of(Tail { share, is_upper: true }));
        let mut core = DrawCell::WHOLE;
        let mut roots = Vec::new();
        for (axis, input) in self.inputs.iter().enumerate() {
            // Correlated inputs may follow from this number too.
            let depends =
                |it: &CellInput| matches!(&it.follows, Follows::Scores(factors) if factors.get(axis).is_some_and(|it| !it.is_zero()));
            let support = input.outward.support();
            let is_open = self.inputs.iter().any(depends);
            for (is_cut, at, tail) in
                [(is_open || support.0 == f64::NEG_INFINITY, low, 0), (is_open || support.1 == f64::INFINITY, high, 1)]
            {
                if is_cut {
                    let parts = core.split(axis, at);
                    roots.push(parts[tail]);
                    core = parts[1 - tail];
                }
            }
        }
        roots.push(core);
        roots
    }

    /// Where to divide a side of a cell; `None` if it cannot be divided.
    pub fn middle(&mut self, cell: &DrawCell, axis: usize) -> Option<u64> {
        let (low, high) = cell.sides[axis];
        let inside = |place: &u64| *place > low && *place < high;
        if let Some(jumps) = &self.inputs[axis].jumps {
            let half = low + (high - low) / 2;
            return jumps.iter().flat_map(|&(a, b)| [a, b]).filter(inside).min_by_key(|place| place.abs_diff(half));
        }
        let near = match self.inputs[axis].follows {
            Follows::Own => {
                let (a, b) = (self.quantile(axis, low).low, self.quantile(axis, high).high);
                let middle = 0.5 * (a + b);
                middle.is_finite().then(|| {
                    let (below, above) = self.inputs[axis].outward.tails(middle);
                    let is_upper = below.low > above.low;
                    Tail { share: if is_upper { above.low } else { below.low }, is_upper }
                })
            }
            Follows::Scores(_) => None,
        };
        let near = near.unwrap_or_else(|| {
            let (a, b) = (self.score(axis, low).low, self.score(axis, high).high);
            let score = match (a.is_finite(), b.is_finite()) {
                (true, true) => 0.5 * (a + b),
                (true, false) => a.max(0.0) + 0.5,
                (false, true) => b.min(0.0) - 0.5,
                (false, false) => 0.0,
            };
            Tail { share: normal_below(-score.abs()), is_upper: score > 0.0 }
        });
        [place_of(near), neat(low + (high - low) / 2)].into_iter().find(inside)
    }

    fn quantile(&mut self, input: usize, place: u64) -> Interval {
        let CellInput { outward, quantiles, .. } = &mut self.inputs[input];
        *quantiles.entry(place).or_insert_with(|| {
            let tail = tail(place);
            match (tail.share == 0.0, tail.is_upper) {
                (true, false) => Interval { low: outward.support().0, high: outward.support().0, error: 0.0 },
                (true, true) => Interval { low: outward.support().1, high: outward.support().1, error: 0.0 },
                _ => match outward.linear() {
                    Some((mean, sd)) => Interval::point(mean) + Interval::point(sd) * normal_score(tail),
                    None => Interval { low: outward.end(tail, true), high: outward.end(tail, false), error: 0.0 },
                },
            }
        })
    }

    fn score(&mut self, axis: usize, place: u64) -> Interval {
        *self.inputs[axis].scores.entry(place).or_insert_with(|| {
            let tail = tail(place);
            let far = if tail.is_upper { f64::INFINITY } else { f64::NEG_INFINITY };
            if tail.share == 0.0 { Interval { low: far, high: far, error: 0.0 } } else { normal_score(tail) }
        })
    }

    /// The values of all inputs over a cell.
    pub fn over(&mut self, cell: &DrawCell) -> [DrawnPoint<N>; N] {
        std::array::from_fn(|input| {
            if let Follows::Own = self.inputs[input].follows {
                return self.own(cell, input);
            }
            self.of_scores(input, |cells, axis| (cells.score_over(cell, axis), cell_width(cell, axis)))
        })
    }

    /// The values of all inputs at one place of every side. What is the same all over the cell needs none.
    pub fn at(&mut self, places: &[Option<u64>; N], over: &[DrawnPoint<N>; N]) -> [Interval; N] {
        let places = places.map(Option::unwrap_or_default);
        std::array::from_fn(|input| {
            if over[input].slopes.iter().all(|slope| slope.is_zero()) {
                return over[input].value;
            }
            if let Follows::Own = self.inputs[input].follows {
                return if self.inputs[input].jumps.is_some() { EVERYTHING } else { known(self.quantile(input, places[input])) };
            }
            self.of_scores(input, |cells, axis| (known(cells.score(axis, places[axis])), Interval::point(0.0))).value
        })
    }

    fn score_over(&mut self, cell: &DrawCell, axis: usize) -> Interval {
        let (low, high) = cell.sides[axis];
        Interval::new(self.score(axis, low).low, self.score(axis, high).high)
    }

    fn own(&mut self, cell: &DrawCell, input: usize) -> DrawnPoint<N> {
        let (low, high) = cell.sides[input];
        let mut slopes = [Interval::point(0.0); N];
        if self.inputs[input].outward.is_discrete() {
            let outward = &self.inputs[input].outward;
            let value = Interval::new(outward.end(tail(low), true), outward.end(tail(high), false));
            slopes[input] = if value.low == value.high { Interval::point(0.0) } else { EVERYTHING };
            return DrawnPoint { value, slopes };
        }
        let value = Interval::new(self.quantile(input, low).low, self.quantile(input, high).high);
        let outward = &self.inputs[input].outward;
        slopes[input] = cell_width(cell, input) / outward.density(value);
        DrawnPoint { value, slopes }
    }

    /// An input that follows from a sum of scores, given each of them and the width of the cell along it.
    fn of_scores(&mut self, input: usize, mut at: impl FnMut(&mut Self, usize) -> (Interval, Interval)) -> DrawnPoint<N> {
        let Follows::Scores(factors) = &self.inputs[input].follows else {
            return DrawnPoint { value: EVERYTHING, slopes: [EVERYTHING; N] };
        };
        let factors = factors.clone();
        let mut score = Interval::point(0.0);
        let mut slopes = [Interval::point(0.0); N];
        for (axis, factor) in factors.iter().enumerate().filter(|(_, factor)| !factor.is_zero()) {
            let (own, width) = at(self, axis);
            score = score + *factor * own;
            slopes[axis] = *factor * width / normal_density(own);
        }
        let outward = &self.inputs[input].outward;
        if let Some((mean, sd)) = outward.linear() {
            let slopes = slopes.map(|it| it * Interval::point(sd));
            return DrawnPoint { value: known(Interval::point(mean) + Interval::point(sd) * score), slopes };
        }
        if !score.is_finite() {
            return DrawnPoint { value: EVERYTHING, slopes: [EVERYTHING; N] };
        }
        let end = |score: f64, is_low: bool| {
            let is_upper = score > 0.0;
            let share = normal_share(-score.abs());
            // Farther out: what is at most below the lower end, at least below the upper one.
            outward.end(Tail { share: if is_low == is_upper { share.high } else { share.low }, is_upper }, is_low)
        };
        let value = Interval::new(end(score.low, true), end(score.high, false));
        let slope = if outward.is_discrete() {
            if value.low == value.high { Interval::point(0.0) } else { EVERYTHING }
        } else {
            normal_density(score) / outward.density(value)
        };
        DrawnPoint { value, slopes: slopes.map(|it| if it.is_zero() { it } else { it * slope }) }
    }
}

/// An interval with finite ends, or everything.
fn known(it: Interval) -> Interval {
    Interval::new(it.low, it.high)
}

/// The probability of a side.
fn cell_width(cell: &DrawCell, axis: usize) -> Interval {
    let (low, high) = cell.sides[axis];
    let width = (high - low) as f64 * UNIT;
    Interval::new(width.next_down(), width.next_up())
}

/// Places around those where a value ends and the next begins.
fn jumps(steps: &[(f64, f64, f64)]) -> Vec<(u64, u64)> {
    let down = |share: f64| neat((share * ONE as f64) as u64);
    let jump = |&(_, low, high): &(f64, f64, f64)| (down(low).saturating_sub(1 << 12), (down(high) + (1 << 12)).min(ONE));
    steps[..steps.len() - 1].iter().map(jump).map(|(low, high)| (neat(low), neat(high))).collect()
}

/// Cholesky's factor of a matrix of correlations that has one, as intervals.
fn factored(matrix: &[Vec<f64>]) -> Vec<Vec<Interval>> {
    let mut rows: Vec<Vec<Interval>> = Vec::new();
    for (place, of) in matrix.iter().enumerate() {
        let mut row: Vec<Interval> = Vec::new();
        for before in 0..place {
            let rest = (0..before).fold(Interval::point(of[before]), |rest, it| rest - row[it] * rows[before][it]);
            // What is exactly nothing has no rounding.
            row.push(if rest.is_zero() { rest } else { rest / rows[before][before] });
        }
        let rest = row.iter().fold(Interval::point(1.0), |rest, it| rest - it.squared());
        row.push(if row.iter().all(|it| it.is_zero()) { Interval::point(1.0) } else { Real::sqrt(rest) });
        rows.push(row);
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(of: Result<Distribution, ProbabilityProblem>) -> Distribution {
        of.expect("its parameters are right")
    }

    /// Divides cells again and again, in turn along all axes.
    fn divided<const N: usize>(cells: &mut DrawCells<N>, times: usize) -> Vec<DrawCell> {
        let mut all = cells.roots(1e-3);
        for time in 0..times {
            let divide = |cell: DrawCell| match cells.middle(&cell, time % N) {
                Some(place) => cell.split(time % N, place).to_vec(),
                None => vec![cell],
            };
            all = all.into_iter().flat_map(divide).collect();
        }
        all
    }

    #[test]
    fn cells_are_all_draws_and_each_has_its_probability() {
        let (normal, weibull) = (law(Distribution::normal(0.0, 1.0)), law(Distribution::weibull(2.0, 1.0, 0.0)));
        let mut cells = DrawCells::<2>::new(&[("a", &normal), ("b", &weibull)], &[]).expect("no correlations");
        let all = divided(&mut cells, 8);
        let sum: f64 = all.iter().map(DrawCell::probability).sum();
        assert!((1.0 - sum).abs() < 1e-13 && all.len() > 100, "{sum} of {}", all.len());
        // By the distribution functions of the values at the ends.
        for cell in &all {
            let [a, b] = cells.over(cell).map(|it| it.value);
            if a.is_finite() && b.is_finite() {
                let share = (normal.cdf(a.high) - normal.cdf(a.low)) * (weibull.cdf(b.high) - weibull.cdf(b.low));
                let own = cell.probability();
                assert!((own - share).abs() <= 1e-12, "{own} and {share} of {cell:?}");
            }
        }
    }

    #[test]
    fn values_within_a_cell_and_their_derivatives_are_those_of_draws() {
        let laws =
            [law(Distribution::gumbel(3.0, 0.5)), law(Distribution::lognormal(2.0, 0.5)), law(Distribution::beta(2.0, 5.0, 0.0, 1.0))];
        let named: Vec<_> = laws.iter().map(|it| ("a", it)).collect();
        let mut cells = DrawCells::<3>::new(&named, &[(0, 1, 0.5), (0, 2, -0.3), (1, 2, 0.2)]).expect("possible");
        let all = divided(&mut cells, 9);
        let shown = |laws: &[Distribution; 3], shares: [f64; 3]| -> [f64; 3] {
            // Cholesky's factor of the three correlations, by hand.
            let score = shares.map(|share| law(Distribution::normal(0.0, 1.0)).quantile(share).expect("a probability"));
            let second = [0.5, 0.75f64.sqrt()];
            let third = [-0.3, (0.2 + 0.15) / second[1]];
            let last = (1.0 - third[0] * third[0] - third[1] * third[1]).sqrt();
            let scores =
                [score[0], second[0] * score[0] + second[1] * score[1], third[0] * score[0] + third[1] * score[1] + last * score[2]];
            std::array::from_fn(|it| laws[it].quantile(normal_below(scores[it])).expect("a probability"))
        };
        let mut judged = 0;
        for cell in &all {
            let over = cells.over(cell);
            if over.iter().any(|it| !it.value.is_finite()) {
                continue;
            }
            judged += 1;
            let share = |axis: usize, within: f64| {
                let (low, high) = cell.sides[axis];
                (low as f64 + within * (high - low) as f64) * UNIT
            };
            for within in [[0.01, 0.5, 0.99], [0.7, 0.02, 0.3]] {
                let at = |within: [f64; 3]| shown(&laws, std::array::from_fn(|axis| share(axis, within[axis])));
                let values = at(within);
                for (it, value) in over.iter().zip(values) {
                    assert!(
                        it.value.low <= value * (1.0 + 1e-12) && value * (1.0 - 1e-12) <= it.value.high,
                        "{value} beyond {:?}",
                        it.value
                    );
                }
                for axis in 0..3 {
                    let mut next = within;
                    next[axis] += 1e-4;
                    for ((it, value), next) in over.iter().zip(values).zip(at(next)) {
                        let slope = (next - value) / 1e-4;
                        let (low, high) = (it.slopes[axis].low, it.slopes[axis].high);
                        assert!(
                            low - 1e-6 * low.abs().max(1e-3) <= slope && slope <= high + 1e-6 * high.abs().max(1e-3),
                            "{slope} {low} {high}"
                        );
                    }
                }
            }
        }
        assert!(judged > 100, "only {judged} cells of {} have ends", all.len());
    }

    #[test]
    fn single_values_are_told_apart_where_they_end() {
        let dice = law(Distribution::discrete(&[1.0, 2.0, 4.0], &[1.0, 1.0, 1.0]));
        let mut cells = DrawCells::<1>::new(&[("a", &dice)], &[]).expect("no correlations");
        let all = divided(&mut cells, 5);
        let unsure: f64 = all.iter().filter(|cell| cells.over(cell)[0].value.width() > 0.0).map(DrawCell::probability).sum();
        assert!(all.len() == 5 && unsure < 1e-14, "{unsure} in {}", all.len());
        assert!(cells.middle(&all[0], 0).is_none(), "nothing is left to divide");
    }
}
