//! From the number that a row's designs are sorted by to a result.

use crate::models::Set;
use crate::tape::{Binary, List, Node, Operation, Step, Steps, Unary};
use crate::units::Unit;

/// Longest chain that is followed.
const LONGEST: usize = 24;

/// From the number to a result.
#[derive(Debug)]
pub(super) struct RowChain {
    /// What they combine it with stands among [`OrderedRows::reads`](super::OrderedRows::reads).
    steps: Steps,
    /// Where what it is multiplied by stands, if nothing else becomes of it.
    factor: Option<usize>,
    /// Of an output: its unit.
    unit: Option<Unit>,
}

/// The number by which what differs between the designs of a row comes into all results.
pub(in crate::screen) struct RowChannel {
    /// The operation that makes it.
    pub node: Node,
    /// From each result down to what it is made of.
    pub paths: Vec<Vec<Node>>,
}

impl RowChannel {
    /// `None` if there is no such number. `over_lanes`: which operations differ within a row; `columns`: what each one depends on beside
    /// that, for each combination of which there is a column of numbers.
    pub(in crate::screen) fn new(list: &List, results: &[Node], over_lanes: &[bool], columns: &[Set]) -> Option<Self> {
        let paths: Vec<Vec<Node>> = results.iter().map(|&node| path(list, node, over_lanes)).collect();
        let start = *paths.first()?.last()?;
        if !paths.iter().all(|path| path.last() == Some(&start) && path.len() <= LONGEST) {
            return None;
        }
        // Further up on the way that all have in common there is less left to compute, as long as that takes no more columns.
        let serves = |&&node: &&Node| paths.iter().all(|path| path.contains(&node)) && columns[node as usize] == columns[start as usize];
        let node = *paths[0].iter().find(serves)?;
        Some(Self { node, paths })
    }
}

/// From a result down to the first number that more than one operand makes different for each design; the result first.
fn path(list: &List, result: Node, over_lanes: &[bool]) -> Vec<Node> {
    let mut path = vec![result];
    let mut node = result;
    while path.len() <= LONGEST {
        node = match list.operations[node as usize] {
            Operation::Unary(Unary::Neg | Unary::Sqrt, a) => a,
            Operation::Binary(binary, a, b) if a != b && binary != Binary::PlusWhole => {
                match (over_lanes[a as usize], over_lanes[b as usize]) {
                    (true, false) => a,
                    (false, true) => b,
                    _ => break,
                }
            }
            _ => break,
        };
        path.push(node);
    }
    path
}

/// The operations from `channel` up along a path; what they read of the row is added to `reads`.
pub(super) fn chain(list: &List, path: &[Node], channel: Node, unit: Option<Unit>, reads: &mut Vec<Node>) -> RowChain {
    let mut made = RowChain { steps: Steps::default(), factor: None, unit: unit.filter(|unit| !unit.is_si()) };
    let start = path.iter().position(|&node| node == channel).expect("every path goes through it");
    for pair in path[..=start].windows(2).rev() {
        let (node, below) = (pair[0], pair[1]);
        let step = match list.operations[node as usize] {
            Operation::Unary(unary, _) => Step::Alone(unary),
            Operation::Binary(binary, a, b) => {
                let other = reads.len();
                reads.push(if a == below { b } else { a });
                if a == below { Step::First(binary, other) } else { Step::Second(binary, other) }
            }
            other => unreachable!("{other:?} is on no path"),
        };
        made.steps.0.push(step);
    }
    if let [Step::First(Binary::Mul, other) | Step::Second(Binary::Mul, other)] = made.steps.0[..] {
        made.factor = Some(other);
    }
    made
}

impl RowChain {
    /// What the number is multiplied by before it is turned into its unit, if nothing else becomes of it.
    #[inline(always)]
    pub(super) fn multiplier(&self, others: &[f64]) -> Option<f64> {
        self.factor.map(|other| others[other])
    }

    /// The same with the factor of the unit.
    #[inline(always)]
    pub(super) fn factor(&self, others: &[f64]) -> Option<f64> {
        self.multiplier(others).map(|it| self.shown(it))
    }

    /// The result of a number.
    #[inline(always)]
    pub(super) fn value(&self, start: f64, others: &[f64]) -> f64 {
        self.shown(match self.factor {
            Some(other) => start * others[other],
            None => self.steps.value(start, others),
        })
    }

    /// The results of two numbers, between which they rise or fall all the way; `None` where that is not sure.
    #[inline(always)]
    pub(super) fn ends(&self, (low, high): (f64, f64), others: &[f64]) -> Option<(f64, f64)> {
        let (a, b) = match self.factor {
            Some(other) => (low * others[other], high * others[other]),
            None => self.steps.ends(low, high, others)?,
        };
        let (a, b) = (self.shown(a), self.shown(b));
        (a.is_finite() && b.is_finite()).then_some((a, b))
    }

    /// In its unit, whose factors are above zero.
    #[inline(always)]
    pub(super) fn shown(&self, value: f64) -> f64 {
        self.unit.map_or(value, |unit| unit.from_si(value))
    }
}
