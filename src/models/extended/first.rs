//! What a model that is formulas alone computes once for all designs that have their slow inputs in common.

use crate::formula::{Expression, ExpressionNode, Formulas, Operator, StudyFormula};
use std::collections::BTreeSet;

/// Most numbers that are passed on.
const MOST: usize = 200;
/// Functions that take no longer than a few sums.
const CHEAP: [&str; 10] = ["min", "max", "abs", "sqrt", "hypot", "clamp", "round", "floor", "ceil", "default"];

/// A number that the first stage passes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PassedNumber {
    /// What a formula gives, by its slot.
    Slot(usize),
    /// The margin of a requirement, by its number.
    Need(usize),
}

/// The formulas of the first stage, and what it passes on.
#[derive(Clone, Debug, Default)]
pub struct FirstStage {
    /// Formulas that it leaves to the second, in order.
    pub left: Vec<usize>,
    /// What the second one needs of it.
    pub passed: Vec<PassedNumber>,
}

impl FirstStage {
    /// Nothing: these formulas are all left to the second stage.
    pub fn none(before: &[usize]) -> Self {
        Self { left: before.to_vec(), passed: Vec::new() }
    }

    /// Of formulas alone, which read only these many inputs. `asked`: formulas whose values are asked for from without.
    ///
    /// What takes long decides which inputs are slow: roots as long as there is one left that is not, since a first stage that reads
    /// them all would serve no two designs; exponentials, curves and the like as long as a third is left, since they take less time than
    /// a first stage does that serves few.
    pub fn of(formulas: &Formulas, before: &[usize], inputs: usize, asked: &[usize]) -> Self {
        let all = formulas.all();
        let mut costly: Vec<(bool, &StudyFormula)> =
            before.iter().map(|&it| &all[it]).filter_map(|it| Some((!cost(&it.expression)?, it))).collect();
        costly.sort_by_key(|(is_cheaper, it)| (*is_cheaper, it.depends_on.len()));
        let mut slow: BTreeSet<usize> = BTreeSet::new();
        for (is_cheaper, formula) in costly {
            let with: BTreeSet<usize> = slow.iter().chain(&formula.depends_on).copied().collect();
            let left = inputs - with.len();
            if (is_cheaper && 3 * left >= inputs) || (!is_cheaper && left > 0) {
                slow = with;
            }
        }
        if slow.is_empty() {
            return Self::none(before);
        }
        let mut kept: Vec<usize> = before.iter().copied().filter(|&it| all[it].depends_on.iter().all(|slot| slow.contains(slot))).collect();
        loop {
            let left: Vec<usize> = before.iter().copied().filter(|it| !kept.contains(it)).collect();
            let passed = passed(formulas, &kept, &left, asked);
            if passed.len() <= MOST {
                return Self { left, passed };
            }
            kept.pop();
        }
    }
}

/// What is read of these formulas by others or from without, and the margins of their requirements.
fn passed(formulas: &Formulas, kept: &[usize], left: &[usize], asked: &[usize]) -> Vec<PassedNumber> {
    let all = formulas.all();
    let is_read = |formula: &usize| asked.contains(formula) || left.iter().any(|&it| all[it].reads.contains(&all[*formula].slot));
    let values = kept.iter().filter(|it| is_read(it)).map(|&it| PassedNumber::Slot(all[it].slot));
    let of_kept = |need: &usize| kept.contains(&formulas.requirements()[*need].formula);
    values.chain((0..formulas.requirements().len()).filter(of_kept).map(PassedNumber::Need)).collect()
}

/// Is there a root in it? `None` if it takes no longer than a few sums.
fn cost(expression: &Expression) -> Option<bool> {
    let own = match &expression.node {
        ExpressionNode::Root(..) => Some(true),
        ExpressionNode::Call(name, _) if !CHEAP.contains(&&**name) => Some(false),
        ExpressionNode::Binary(Operator::Power, _, exponent) => match exponent.node {
            ExpressionNode::Number(power, None) if power.fract() == 0.0 && power <= 8.0 => None,
            _ => Some(false),
        },
        _ => None,
    };
    expression.parts().filter_map(cost).chain(own).max()
}
