//! What a model that is formulas alone computes once for all designs that have their slow inputs in common.

use crate::formula::{ComparisonSign, Expression, ExpressionNode, Formulas, Operator};
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

    /// Of formulas alone, around these inputs. `asked`: formulas whose values are asked for from without.
    ///
    /// What takes long decides which inputs are slow: roots as long as there is one left that is not, since a first stage that reads
    /// them all would serve no two designs; exponentials, curves and the like as long as a third is left, since they take less time than
    /// a first stage does that serves few. Where a formula chooses by a word, what it takes for the default word counts: most studies
    /// leave it at that, and what is quick and reads a further input is left to the second stage.
    pub fn of(formulas: &Formulas, before: &[usize], inputs: &NamedInputs<'_>, asked: &[usize]) -> Self {
        let all = formulas.all();
        let usual = UsualReads::new(formulas, inputs);
        let mut costly: Vec<(bool, &BTreeSet<usize>)> =
            before.iter().filter_map(|&it| Some((!cost(&all[it].expression, &usual)?, &usual.of[it]))).collect();
        costly.sort_by_key(|(is_cheaper, reads)| (*is_cheaper, reads.len()));
        let mut slow: BTreeSet<usize> = BTreeSet::new();
        for (is_cheaper, reads) in costly {
            let with: BTreeSet<usize> = slow.union(reads).copied().collect();
            let left = inputs.count.saturating_sub(with.len());
            if (is_cheaper && 3 * left >= inputs.count) || (!is_cheaper && left > 0) {
                slow = with;
            }
        }
        if slow.is_empty() {
            return Self::none(before);
        }
        let has_root = |it: usize| all[it].expression.roots() > 0;
        let mut kept: Vec<usize> = before.iter().copied().filter(|&it| has_root(it) || usual.of[it].is_subset(&slow)).collect();
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

/// The inputs of formulas alone.
pub struct NamedInputs<'a> {
    /// The slot of an input.
    pub slot: &'a dyn Fn(&str) -> Option<usize>,
    /// The word that an input is if nobody says otherwise.
    pub default_word: &'a dyn Fn(&str) -> Option<String>,
    /// How many there are.
    pub count: usize,
}

/// What each formula depends on where every word is the default.
struct UsualReads<'a> {
    inputs: &'a NamedInputs<'a>,
    /// Slots of inputs, by formula.
    of: Vec<BTreeSet<usize>>,
}

impl<'a> UsualReads<'a> {
    fn new(formulas: &Formulas, inputs: &'a NamedInputs<'a>) -> Self {
        let mut usual = Self { inputs, of: vec![BTreeSet::new(); formulas.all().len()] };
        for &formula in formulas.order() {
            let mut slots = BTreeSet::new();
            let mut open = vec![&formulas.all()[formula].expression];
            while let Some(expression) = open.pop() {
                if let ExpressionNode::Name(name) = &expression.node {
                    match (formulas.find(name), (inputs.slot)(name)) {
                        (Some(of), _) => slots.extend(&usual.of[of]),
                        (None, slot) => slots.extend(slot),
                    }
                }
                open.extend(usual.branches(expression));
            }
            usual.of[formula] = slots;
        }
        usual
    }

    /// The parts of an expression that count.
    fn branches<'e>(&self, expression: &'e Expression) -> Vec<&'e Expression> {
        let ExpressionNode::If(ComparisonSign::Equal, parts) = &expression.node else { return expression.parts().collect() };
        let [left, right, then, otherwise] = &**parts;
        let (ExpressionNode::Name(name), ExpressionNode::Word(word)) = (&left.node, &right.node) else {
            return expression.parts().collect();
        };
        match (self.inputs.default_word)(name) {
            Some(default) => vec![left, if default == *word { then } else { otherwise }],
            None => expression.parts().collect(),
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
fn cost(expression: &Expression, usual: &UsualReads<'_>) -> Option<bool> {
    let own = match &expression.node {
        ExpressionNode::Root(..) => Some(true),
        ExpressionNode::Call(name, _) if !CHEAP.contains(&&**name) => Some(false),
        ExpressionNode::Binary(Operator::Power, _, exponent) => match exponent.node {
            ExpressionNode::Number(power, None) if power.fract() == 0.0 && power <= 8.0 => None,
            _ => Some(false),
        },
        _ => None,
    };
    usual.branches(expression).into_iter().filter_map(|part| cost(part, usual)).chain(own).max()
}
