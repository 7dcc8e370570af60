//! Between the points of a front of two objectives: what a design must at least be worth to stand between two of them.
//!
//! A box whose designs are all good in one objective or the other, but never in both, has a best corner that none of its designs comes
//! near. If the product of both objectives (of their values or inverses, larger where better) has a bound, the corner is cut off: a
//! design that no point beats is better than a notch of the staircase in both objectives, so its product is larger than the notch's.

use crate::keys::Points;

/// How much of a product rounding may hide, relatively: that of both objectives and of the product.
const HIDDEN: f64 = 256.0 * f64::EPSILON;
/// Values this close to 0 may have lost digits.
const TINY: f64 = 1e-200;

/// The notches of a front of two objectives.
#[derive(Debug, Default)]
pub struct Staircase {
    /// Coordinates of the points: rising in the first, falling in the second.
    first: Vec<f64>,
    second: Vec<f64>,
    /// Least product of the notches, by blocks of doubling size: `least[k][i]` over notches `i .. i + 2^k`.
    least: Vec<Vec<f64>>,
}

/// Beyond this a product says nothing: one of its parts may have underflowed.
const USABLE: f64 = 1e100;

/// What became of a box among the notches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fit {
    /// It fits into none.
    None,
    /// Its product fits into fewer than about half of those that its corner reaches; how many times as large as that of the middle one it is.
    Few(f64),
    /// It fits into most of them, or more than notches; likewise.
    Many(f64),
}

/// What a coordinate is worth: its value or the inverse, larger where better; `None` where it is not positive.
fn worth(key: f64, is_largest_sought: bool) -> Option<f64> {
    let value = if is_largest_sought { -key } else { key };
    (value > TINY && value < 1.0 / TINY).then(|| if is_largest_sought { value } else { value.recip() })
}

impl Staircase {
    /// The notches between sorted points; `largest`: which objectives are to be large. Notches without a positive product are worth
    /// nothing, so that nothing is ever below them.
    pub fn new(points: &Points, largest: [bool; 2]) -> Self {
        let first: Vec<f64> = points.keys.iter().step_by(2).copied().collect();
        let second: Vec<f64> = points.keys.iter().skip(1).step_by(2).copied().collect();
        let usable = |product: &f64| *product > USABLE.recip() && *product < USABLE;
        let notch = |at: usize| Some(worth(first[at + 1], largest[0])? * worth(second[at], largest[1])?).filter(usable);
        let mut least = vec![(0..first.len().saturating_sub(1)).map(|at| notch(at).unwrap_or(0.0)).collect::<Vec<f64>>()];
        let mut size = 1;
        while 2 * size <= least[0].len() {
            let last = least.last().expect("there is one");
            least.push((0..=least[0].len() - 2 * size).map(|at| last[at].min(last[at + size])).collect());
            size *= 2;
        }
        Self { first, second, least }
    }

    /// Into how many notches might a design fit that has at least these coordinates and at most this product? Where it fits into none,
    /// the points make it superfluous.
    pub fn fit(&self, lower: [f64; 2], most: f64) -> Fit {
        let (Some(&last), true) = (self.second.last(), self.first.len() > 1) else { return Fit::Many(f64::INFINITY) };
        // Before the first point and after the last the stairs have no notch.
        let is_outside = lower[0] <= self.first[0] || lower[1] <= last;
        // Notch i lies between points i and i + 1: a design fits there if its corner is not beyond it.
        let from = self.first.partition_point(|&key| key < lower[0]).max(1) - 1;
        let to = self.second.partition_point(|&key| key >= lower[1]).min(self.least[0].len());
        if from >= to {
            return if is_outside { Fit::Few(f64::INFINITY) } else { Fit::None };
        }
        let level = (to - from).ilog2() as usize;
        let least = self.least[level][from].min(self.least[level][to - (1 << level)]);
        let middle = self.least[0][from + (to - from) / 2];
        let surplus = if middle > 0.0 { most / middle } else { f64::INFINITY };
        if !is_outside && most < least * (1.0 - HIDDEN) {
            Fit::None
        } else if most < middle {
            Fit::Few(surplus)
        } else {
            Fit::Many(surplus)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::mix;

    #[test]
    fn a_product_that_fits_into_no_notch_belongs_to_designs_that_are_beaten() {
        let number = |seed: u64| 1.0 + (mix(seed) % 1000) as f64 / 250.0;
        let (mut none, mut some) = (0, 0);
        for round in 0..300 {
            // Points (-a, b): a is to be large, b to be small, and a/b is at most 1 or so.
            let mut all: Vec<(f64, f64)> = (0..40)
                .map(|i| {
                    let b = number(round * 100 + i);
                    (-b * (1.0 - (mix(round * 100 + i + 50) % 100) as f64 / 400.0), b)
                })
                .collect();
            all.sort_by(|x, y| x.partial_cmp(y).expect("they are numbers"));
            let mut points = Points::default();
            let mut best = f64::INFINITY;
            for (at, &(first, second)) in all.iter().enumerate() {
                if second < best {
                    best = second;
                    points.keys.extend([first, second]);
                    points.indices.push(at as u64);
                }
            }
            let stairs = Staircase::new(&points, [true, false]);
            for seed in 0..60 {
                let corner = [-number(round * 1000 + seed), number(round * 1000 + seed + 500)];
                let most = 0.6 + (mix(round + seed) % 100) as f64 / 200.0;
                let fit = stairs.fit(corner, most);
                none += u32::from(fit == Fit::None);
                some += u32::from(fit != Fit::None);
                if fit != Fit::None {
                    continue;
                }
                // No design beyond the corner within the product is left by the points.
                for trial in 0..200 {
                    let second = corner[1] * (1.0 + (mix(trial + seed * 7) % 1000) as f64 / 300.0);
                    let first = (-second * most * (1.0 - (mix(trial * 3 + seed) % 100) as f64 / 300.0)).max(corner[0]);
                    let is_beaten = (0..points.len()).any(|at| points.keys[2 * at] <= first && points.keys[2 * at + 1] <= second);
                    assert!(is_beaten, "{first} {second} beyond {corner:?} within {most}");
                }
            }
        }
        assert!(none > 1000 && some > 1000, "{none} {some}");
    }
}
