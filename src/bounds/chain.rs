//! A number that reaches an output along one chain of operations, each of which rounds correctly and so keeps the order of numbers.
//!
//! If half of a box's axes act on an output through one such number v alone, and the others only on what v is combined with on its
//! way, then for fixed others the output in f64 rises or falls with v, see [`Steps`]. No derivative and no margin for errors is needed.

use super::box_columns::BoxColumns;
use super::requirement::NumberSource;
use super::study_tape::StudyTape;
use crate::tape::{Node, Operation, Step, Steps, Unary};

/// A chain from a number to an output.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// The number that it starts from.
    pub channel: Node,
    /// The operations, in order.
    pub steps: Steps,
    /// What the number is combined with.
    pub others: Vec<Node>,
    /// Axes that the others depend on, as a bit set.
    pub other_axes: u64,
    /// The output.
    pub source: NumberSource,
}

/// Longest chain that is followed, and most ways that are looked at.
const LONGEST: usize = 24;
const MOST: usize = 4096;

impl Chain {
    /// All chains to an output whose start and others both depend on some of the `varying` axes.
    pub fn all(tape: &StudyTape, source: NumberSource, varying: u64) -> Vec<Self> {
        let mut found = Vec::new();
        let mut looked = 0;
        if let NumberSource::Node(node, _) = source {
            follow(tape, node, varying, &mut Vec::new(), &mut looked, &mut |channel, path| {
                let mut chain = Self { channel, steps: Steps::default(), others: Vec::new(), other_axes: 0, source };
                for (step, other) in path.iter().rev() {
                    let step = match *step {
                        Step::Alone(unary) => Step::Alone(unary),
                        Step::First(binary, _) => Step::First(binary, chain.others.len()),
                        Step::Second(binary, _) => Step::Second(binary, chain.others.len()),
                    };
                    chain.steps.0.push(step);
                    if let Some(other) = *other {
                        chain.others.push(other);
                        chain.other_axes |= tape.axes[other as usize];
                    }
                }
                found.push(chain);
            });
        }
        found
    }

    /// The output, in its unit, for a number at the start; `others` in the order of [`Chain::others`].
    #[inline(always)]
    pub fn value(&self, start: f64, others: &[f64]) -> f64 {
        self.source.shown(self.steps.value(start, others))
    }

    /// The output at two starts, between which it rises or falls all the way; see [`Steps::ends`].
    #[inline]
    pub fn ends(&self, low: f64, high: f64, others: &[f64]) -> Option<(f64, f64)> {
        let (a, b) = self.steps.ends(low, high, others)?;
        Some((self.source.shown(a), self.source.shown(b)))
    }

    /// The others of one design of the box that columns were computed for.
    pub fn others_at<'a>(&'a self, columns: &'a BoxColumns<'_>, lane: usize) -> impl Iterator<Item = f64> + 'a {
        self.others.iter().map(move |&other| columns.value(other).at(lane))
    }
}

/// Walks from an output to what it is made of. Whatever is on the way is a start; the path holds the steps from the output down.
fn follow(
    tape: &StudyTape,
    node: Node,
    varying: u64,
    path: &mut Vec<(Step, Option<Node>)>,
    looked: &mut usize,
    found: &mut impl FnMut(Node, &[(Step, Option<Node>)]),
) {
    let depends = |node: Node| tape.axes[node as usize] & varying;
    if path.iter().any(|(_, other)| other.is_some_and(|other| depends(other) != 0)) {
        found(node, path);
    }
    *looked += 1;
    // Of what depends on one axis alone, only what others read is tabulated.
    if path.len() == LONGEST || *looked > MOST || tape.axes[node as usize].is_power_of_two() {
        return;
    }
    match tape.list.operations[node as usize] {
        Operation::Unary(unary @ (Unary::Neg | Unary::Sqrt), a) if depends(a) != 0 => {
            path.push((Step::Alone(unary), None));
            follow(tape, a, varying, path, looked, found);
            path.pop();
        }
        Operation::Binary(binary, a, b) if a != b => {
            for (next, other, step) in [(a, b, Step::First(binary, 0)), (b, a, Step::Second(binary, 0))] {
                if depends(next) != 0 {
                    path.push((step, Some(other)));
                    follow(tape, next, varying, path, looked, found);
                    path.pop();
                }
            }
        }
        _ => {}
    }
}
