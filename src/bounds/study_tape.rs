//! The formula of a study as a list of operations: cut down to what the study asks for, with what each of them depends on.

use super::axes::Axes;
use crate::models::{Set, input_to_si};
use crate::plan::Plan;
use crate::study::{Goal, Quantity};
use crate::tape::{Binary, Known, List, Node, Operation, Recording, Unary};

/// The recorded formula of a study.
#[derive(Debug)]
pub struct StudyTape {
    /// The operations.
    pub list: List,
    /// Of every operation: the axes that it depends on, as a bit set.
    pub axes: Vec<u64>,
    /// The axis that sets an input, and the input's column there.
    pub input_axes: Vec<Option<(u8, u8)>>,
    /// Node of every output that the study asks for.
    pub outputs: Vec<Option<Node>>,
    /// Node of every condition's margin that matters.
    pub conditions: Vec<Option<Node>>,
    /// Products and quotients of two outputs, without the factors that cancel.
    pub merits: Vec<(Merit, Node)>,
}

/// A product of two outputs or their inverses, in SI.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Merit {
    /// Number of an output; is it above the line?
    pub first: (usize, bool),
    /// Of the other.
    pub second: (usize, bool),
}

impl StudyTape {
    /// Records the formula of a plan; `None` if its model is no formula over any number type.
    pub fn new(plan: &Plan, axes: &Axes) -> Option<Self> {
        let model = &plan.study.model;
        let mut known: Vec<Known> =
            model.inputs.iter().zip(&plan.study.fixed).map(|(input, &value)| Known::Fixed(input_to_si(input, value))).collect();
        let mut input_axes = vec![None; model.inputs.len()];
        for (number, axis) in axes.all.iter().enumerate() {
            for (column, &input) in axis.inputs.iter().enumerate() {
                let values = &axis.si[column];
                let ends = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &it| (low.min(it), high.max(it)));
                known[input] = if ends.0 == ends.1 { Known::Fixed(ends.0) } else { Known::Within(ends.0, ends.1) };
                input_axes[input] = Some((number as u8, column as u8));
            }
        }
        let wanted = plan.used_outputs();
        let mattering: Set = plan.row_conditions.iter().chain(&plan.lane_conditions).collect();
        let mut whole = model.kernel.formula()?.whole(&known, wanted, mattering);
        let merits: Vec<(Merit, Node)> = merits_of(plan)
            .into_iter()
            .filter_map(|merit| Some((merit, cancelled(&mut whole.recording, merit, &whole.outputs)?)))
            .collect();
        let mut asked = whole.asked(wanted, mattering);
        asked.extend(merits.iter().map(|&(_, node)| Some(node)));
        let list = List::cut(&whole.recording, &asked);
        let (of_outputs, rest) = list.results.split_at(whole.outputs.len());
        let (of_conditions, of_merits) = rest.split_at(whole.conditions.len());
        Some(Self {
            axes: list.dependencies(|input| input_axes[input as usize].map_or(0, |(axis, _)| 1 << axis)),
            input_axes,
            outputs: of_outputs.to_vec(),
            conditions: of_conditions.to_vec(),
            merits: merits.iter().zip(of_merits.iter().flatten()).map(|(&(merit, _), &node)| (merit, node)).collect(),
            list,
        })
    }

    /// Per axis: the operations that depend on it alone, operands first.
    pub fn alone(&self, axes: usize) -> Vec<Vec<Node>> {
        let mut alone = vec![Vec::new(); axes];
        for node in 0..self.list.operations.len() {
            if let Some(axis) = self.own_axis(node) {
                alone[axis].push(node as Node);
            }
        }
        alone
    }

    /// Of these: those that others need or the study asks for.
    pub fn kept(&self, axes: usize) -> Vec<Vec<Node>> {
        let list = &self.list;
        let mut read = vec![false; list.operations.len()];
        list.results.iter().flatten().for_each(|&node| read[node as usize] = true);
        for node in (0..list.operations.len()).filter(|&node| self.own_axis(node).is_none()) {
            let mut mark = |operand: Node| read[operand as usize] = true;
            match list.operations[node] {
                Operation::Root(number) => list.outside(number, mark),
                operation => operation.operands(&mut mark),
            }
        }
        let mut kept = self.alone(axes);
        kept.iter_mut().for_each(|nodes| nodes.retain(|&node| read[node as usize]));
        kept
    }

    /// The axis that an operation depends on alone.
    fn own_axis(&self, node: usize) -> Option<usize> {
        (!self.list.inner[node] && self.axes[node].is_power_of_two()).then(|| self.axes[node].trailing_zeros() as usize)
    }
}

/// The products and quotients that tell more than either output: of two objectives, larger where both are better; of an objective
/// and what a requirement limits, so that the limit of the one limits the other.
fn merits_of(plan: &Plan) -> Vec<Merit> {
    let study = &plan.study;
    let output = |quantity| if let Quantity::Output(output) = quantity { Some(output) } else { None };
    let mut merits = Vec::new();
    if let [a, b] = &study.objectives[..]
        && let (Some(first), Some(second)) = (output(a.quantity), output(b.quantity))
    {
        merits.push(Merit { first: (first, a.goal == Goal::Max), second: (second, b.goal == Goal::Max) });
    }
    for objective in &study.objectives {
        for constraint in &study.constraints {
            if let (Some(first), Some(second)) = (output(objective.quantity), output(constraint.quantity))
                && first != second
            {
                for is_above in [false, true] {
                    let limited = if is_above { constraint.high } else { constraint.low };
                    if limited.is_some_and(|(bound, _)| bound > 0.0) {
                        merits.push(Merit { first: (first, is_above), second: (second, !is_above) });
                    }
                }
            }
        }
    }
    merits
}

/// Writes a merit down without the factors that cancel; `None` if none does that varies.
fn cancelled(recording: &mut Recording, merit: Merit, results: &[Node]) -> Option<Node> {
    let (mut above, mut below) = (Vec::new(), Vec::new());
    for (output, is_above) in [merit.first, merit.second] {
        let sides = if is_above { (&mut above, &mut below) } else { (&mut below, &mut above) };
        factors(recording, results[output], sides.0, sides.1);
    }
    let mut any = false;
    above.retain(|factor| {
        let same = below.iter().position(|it| it == factor);
        if let Some(same) = same {
            below.remove(same);
            any |= !matches!(recording.operations[*factor as usize], Operation::Constant(_));
        }
        same.is_none()
    });
    if !any {
        return None;
    }
    let mut merit = recording.push(Operation::Constant(1f64.to_bits()));
    for factor in above {
        merit = recording.push(Operation::Binary(Binary::Mul, merit, factor));
    }
    for factor in below {
        merit = recording.push(Operation::Binary(Binary::Div, merit, factor));
    }
    Some(merit)
}

/// The factors of a number, above and below the line.
fn factors(recording: &mut Recording, node: Node, above: &mut Vec<Node>, below: &mut Vec<Node>) {
    match recording.operations[node as usize] {
        Operation::Binary(Binary::Mul, a, b) => {
            factors(recording, a, above, below);
            factors(recording, b, above, below);
        }
        Operation::Binary(Binary::Div, a, b) => {
            factors(recording, a, above, below);
            factors(recording, b, below, above);
        }
        Operation::Unary(Unary::Scale(power), a) => {
            above.push(recording.push(Operation::Constant(2f64.powi(power.into()).to_bits())));
            factors(recording, a, above, below);
        }
        _ => above.push(node),
    }
}
