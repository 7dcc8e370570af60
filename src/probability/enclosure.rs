//! Bounds of the probability that a draw holds: boxes of draws that surely hold or surely fail are added up, those that are not sure are
//! divided.
//!
//! The box with the largest probability that is not settled comes first, so the result depends on nothing but the question: neither on
//! the machine nor on time. Sums are of whole multiples of 2^-120 and exact; a box's own probability is rounded down, and what rounding
//! leaves out counts as not settled.

use super::cells::DrawCell;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::rc::Rc;

/// The probability 1 in sums.
const ONE: u128 = 1 << 120;

/// Proven bounds of a yield.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure {
    /// The yield is no less, a share from 0 to 1.
    pub at_least: f64,
    /// The yield is no more, a share from 0 to 1.
    pub at_most: f64,
    /// Boxes of draws that were judged.
    pub boxes: u64,
}

impl Enclosure {
    /// How far the bounds are apart.
    pub fn width(&self) -> f64 {
        self.at_most - self.at_least
    }
}

/// What is known of a box of draws.
#[derive(Debug)]
pub struct CellVerdict<O> {
    /// At least this share of it surely holds.
    pub holds: f64,
    /// At least this share of it surely fails.
    pub fails: f64,
    /// The axis and the place at which to divide it; `None` if it cannot be divided.
    pub split: Option<(usize, u64)>,
    /// What is to be asked of its parts.
    pub open: Rc<O>,
}

/// Judges boxes of draws.
pub trait Judge {
    /// What is left to be asked.
    type Open;
    /// Judges a box at a level of what has no probability, of which `open` is not settled yet.
    fn judge(&mut self, level: usize, cell: &DrawCell, open: &Rc<Self::Open>) -> CellVerdict<Self::Open>;
}

/// A box that is not settled.
struct Unsettled<O> {
    /// Probability that is not settled.
    unsettled: u128,
    /// The earlier comes first of two that are alike.
    number: u64,
    cell: DrawCell,
    verdict: CellVerdict<O>,
    counted: Counted,
}

/// Probabilities of a box that are settled.
#[derive(Clone, Copy)]
struct Counted {
    holds: u128,
    fails: u128,
}

impl<O> Ord for Unsettled<O> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.unsettled.cmp(&other.unsettled).then(other.number.cmp(&self.number))
    }
}

impl<O> PartialOrd for Unsettled<O> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<O> PartialEq for Unsettled<O> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<O> Eq for Unsettled<O> {}

/// One level: what is settled there, and what is not.
struct LevelSums<O> {
    settled: Counted,
    queue: BinaryHeap<Unsettled<O>>,
}

/// A probability as a multiple of 2^-120, rounded down.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 1")]
fn floored(probability: f64) -> u128 {
    (probability.clamp(0.0, 1.0) * ONE as f64) as u128
}

/// Bounds of the least yield over all levels, each of which consists of the same boxes, until they are no more than `width` apart, or
/// another two boxes would be more than `budget`. The boxes that all begins with are judged in any case.
pub fn enclose<J: Judge>(judge: &mut J, roots: &[DrawCell], open: Vec<Rc<J::Open>>, width: f64, budget: u64) -> Enclosure {
    let mut boxes = 0;
    let mut judged = |levels: &mut [LevelSums<J::Open>], level: usize, cell: DrawCell, open: &Rc<J::Open>| {
        let verdict = judge.judge(level, &cell, open);
        let probability = cell.probability();
        let share = |share: f64| floored(probability * share * (1.0 - 2.0 * f64::EPSILON));
        // Without rounding where there is nothing to round.
        let whole = |it: f64| if it >= 1.0 { floored(probability) } else { share(it) };
        let counted = Counted { holds: whole(verdict.holds), fails: whole(verdict.fails) };
        let LevelSums { settled, queue } = &mut levels[level];
        (settled.holds, settled.fails) = (settled.holds + counted.holds, settled.fails + counted.fails);
        let unsettled = floored(probability).saturating_sub(counted.holds + counted.fails);
        if verdict.split.is_some() && verdict.holds < 1.0 && verdict.fails < 1.0 {
            queue.push(Unsettled { unsettled, number: boxes, cell, verdict, counted });
        }
        boxes += 1;
        boxes
    };
    let mut levels: Vec<LevelSums<J::Open>> =
        open.iter().map(|_| LevelSums { settled: Counted { holds: 0, fails: 0 }, queue: BinaryHeap::new() }).collect();
    let mut used = 0;
    for (level, open) in open.iter().enumerate() {
        for &cell in roots {
            used = judged(&mut levels, level, cell, open);
        }
    }
    let wanted = floored(width);
    loop {
        let worst = (0..levels.len()).min_by_key(|&level| levels[level].settled.holds).unwrap_or(0);
        let Some(holds) = levels.get(worst).map(|it| it.settled.holds) else { break };
        let most = levels.iter().map(|it| ONE - it.settled.fails).min().unwrap_or(ONE);
        if most - holds <= wanted || used + 2 > budget {
            break;
        }
        let Some(Unsettled { cell, verdict, counted, .. }) = levels[worst].queue.pop() else { break };
        let Some((axis, place)) = verdict.split else { break };
        let settled = &mut levels[worst].settled;
        (settled.holds, settled.fails) = (settled.holds - counted.holds, settled.fails - counted.fails);
        for part in cell.split(axis, place) {
            used = judged(&mut levels, worst, part, &verdict.open);
        }
    }
    let at_least = levels.iter().map(|it| it.settled.holds).min().map_or(0.0, |sum| rounded(sum).0);
    let at_most = levels.iter().map(|it| ONE - it.settled.fails).min().map_or(1.0, |sum| rounded(sum).1);
    Enclosure { at_least, at_most, boxes: used }
}

/// The nearest numbers that are no more and no less than a sum.
fn rounded(sum: u128) -> (f64, f64) {
    let nearest = sum as f64 / ONE as f64;
    let back = floored(nearest);
    (if back <= sum { nearest } else { nearest.next_down() }, if back >= sum { nearest } else { nearest.next_up() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probability::{Distribution, DrawCells};

    /// The sum of two numbers, both uniform from 0 to 1, is at most 3/4 (a share of 9/32), judged by the corners of a box; what is claimed
    /// of boxes that are settled is multiplied by `claims`.
    struct CornerJudge {
        cells: DrawCells<2>,
        claims: f64,
    }

    impl Judge for CornerJudge {
        type Open = ();
        fn judge(&mut self, _level: usize, cell: &DrawCell, open: &Rc<()>) -> CellVerdict<()> {
            let [a, b] = self.cells.over(cell).map(|it| it.value);
            let (holds, fails) = (a.high + b.high <= 0.75, a.low + b.low > 0.75);
            let share = |is_sure: bool| f64::from(u8::from(is_sure)) * self.claims;
            let axis = usize::from(b.width() > a.width());
            let split = self.cells.middle(cell, axis).filter(|_| !holds && !fails).map(|place| (axis, place));
            CellVerdict { holds: share(holds), fails: share(fails), split, open: open.clone() }
        }
    }

    fn corner(claims: f64, width: f64, budget: u64) -> Enclosure {
        let unit = Distribution::uniform(0.0, 1.0).expect("a range");
        let cells = DrawCells::<2>::new(&[("a", &unit), ("b", &unit)], &[]).expect("no correlations");
        let roots = cells.roots(width);
        enclose(&mut CornerJudge { cells, claims }, &roots, vec![Rc::new(())], width, budget)
    }

    #[test]
    fn bounds_close_in_on_the_share_and_keep_width_and_budget() {
        let mut before = corner(1.0, 0.0, 1);
        assert_eq!(before, Enclosure { at_least: 0.0, at_most: 1.0, boxes: 1 });
        for budget in [9, 99, 999, 9999] {
            let found = corner(1.0, 0.0, budget);
            assert!(found.at_least <= 0.28125 && 0.28125 <= found.at_most, "{found:?}");
            assert!(found.width() < before.width() && found.boxes == budget, "{found:?} after {before:?}");
            before = found;
        }
        let wide = corner(1.0, 0.1, 9999);
        assert!(wide.width() <= 0.1 && wide.boxes < 999, "{wide:?}");
        assert_eq!(corner(1.0, 0.1, 9999), wide, "the same question has the same answer");
    }

    #[test]
    fn a_judge_that_claims_too_much_is_found_out() {
        // Were a share not rounded down but up by as little as the bounds are apart, they would not hold the truth.
        let honest = corner(1.0, 0.0, 99_999);
        let wrong = 1.0 + 4.0 * honest.width();
        let found = corner(wrong.recip(), 0.0, 99_999);
        assert!(found.at_least <= 0.28125 && 0.28125 <= found.at_most, "claiming less is no lie: {found:?}");
        let lying = Enclosure { at_least: honest.at_least * wrong, ..honest };
        assert!(lying.at_least > 0.28125, "{lying:?}");
    }

    #[test]
    fn the_least_of_several_levels_is_bounded_and_the_others_are_left_alone() {
        struct TwoLevels(DrawCells<1>);
        impl Judge for TwoLevels {
            type Open = ();
            /// Of level 0 the lower 0.3 hold, of level 1 the lower 0.9.
            fn judge(&mut self, level: usize, cell: &DrawCell, open: &Rc<()>) -> CellVerdict<()> {
                let limit = [0.3, 0.9][level];
                let value = self.0.over(cell)[0].value;
                let share = |is_sure: bool| f64::from(u8::from(is_sure));
                let split = self.0.middle(cell, 0).map(|place| (0, place));
                CellVerdict { holds: share(value.high <= limit), fails: share(value.low > limit), split, open: open.clone() }
            }
        }
        let cells = DrawCells::<1>::new(&[("a", &Distribution::uniform(0.0, 1.0).expect("a range"))], &[]).expect("no correlations");
        let roots = cells.roots(1e-9);
        let found = enclose(&mut TwoLevels(cells), &roots, vec![Rc::new(()), Rc::new(())], 1e-9, 1000);
        assert!(found.at_least <= 0.3 && 0.3 <= found.at_most && found.width() <= 1e-9, "{found:?}");
        assert!(found.boxes < 2 * 35 + 10, "level 1 needs but a few boxes: {found:?}");
    }

    #[test]
    fn sums_are_shown_without_rounding_inwards() {
        assert_eq!(rounded(ONE), (1.0, 1.0));
        assert_eq!(rounded(0), (0.0, 0.0));
        let (low, high) = rounded(ONE / 3);
        assert!(low < 1.0 / 3.0 + 1e-16 && floored(low) <= ONE / 3 && floored(high) >= ONE / 3 && low < high);
    }
}
