//! The formula of a study as a list of operations: cut down to what the study asks for, with what each of them depends on.

use super::axes::Axes;
use crate::models::{CONDITIONS, Formula, INPUTS, OUTPUTS, Visitor, input_to_si, visit};
use crate::plan::Plan;
use crate::real::Real;
use crate::real::trace::{Binary, Known, Node, Operation, Recording, Root, Trace};
use crate::study::{Goal, Quantity};
use std::cell::RefCell;

/// The recorded formula of a study.
#[derive(Debug)]
pub struct Tape {
    /// All operations, operands first.
    pub operations: Vec<Operation>,
    /// The roots among them.
    pub roots: Vec<TapeRoot>,
    /// Of every operation: the axes that it depends on, as a bit set.
    pub axes: Vec<u64>,
    /// Of every operation: is it part of a root's function, so that it has a value only while the root is sought?
    pub inner: Vec<bool>,
    /// The axis that sets an input, and the input's column there.
    pub input_axes: [Option<(u8, u8)>; INPUTS],
    /// Node of every output that the study asks for.
    pub outputs: [Option<Node>; OUTPUTS],
    /// Node of every condition's margin that matters.
    pub conditions: [Option<Node>; CONDITIONS],
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

/// A root with the operations of its function.
#[derive(Debug)]
pub struct TapeRoot {
    /// The root as recorded.
    pub root: Root,
    /// Operations that depend on what the function is asked at, operands first.
    pub inner: Vec<Node>,
}

/// Runs a formula on names.
struct Record<'a> {
    known: &'a [Known],
    outputs: u64,
    conditions: u64,
}

impl Visitor for Record<'_> {
    type Output = (Recording, Vec<Node>);

    fn visit<F: Formula>(self) -> Self::Output {
        Recording::of(self.known, |named| {
            let mut inputs = [named[0]; INPUTS];
            inputs[..named.len()].copy_from_slice(named);
            let mut prepared = vec![Trace::constant(0.0); F::FIELDS.prepared_len()];
            F::prepare(&inputs, self.outputs, &mut prepared);
            let mut outputs = [Trace::constant(0.0); OUTPUTS];
            F::finish(&prepared, &inputs, self.outputs, &mut outputs);
            outputs.into_iter().chain(F::conditions(&prepared, &inputs, self.conditions)).collect()
        })
    }
}

impl Tape {
    /// Records the formula of a plan; `None` if its model is no formula over any number type.
    pub fn new(plan: &Plan, axes: &Axes) -> Option<Self> {
        let model = plan.study.model;
        let mut known = [Known::Fixed(0.0); INPUTS];
        for (number, (input, &value)) in model.inputs.iter().zip(&plan.study.fixed).enumerate() {
            known[number] = Known::Fixed(input_to_si(input, value));
        }
        let mut input_axes = [None; INPUTS];
        for (number, axis) in axes.all.iter().enumerate() {
            for (column, &input) in axis.inputs.iter().enumerate() {
                let values = &axis.si[column];
                let ends = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &it| (low.min(it), high.max(it)));
                known[input] = if ends.0 == ends.1 { Known::Fixed(ends.0) } else { Known::Within(ends.0, ends.1) };
                input_axes[input] = Some((number as u8, column as u8));
            }
        }
        let wanted = plan.used_outputs();
        let mattering = plan.row_conditions.iter().chain(&plan.lane_conditions).fold(0u64, |set, &number| set | 1 << number);
        let (recording, results) = visit(model.name, Record { known: &known, outputs: wanted, conditions: mattering })?;
        let mut recording = recording;
        let merits: Vec<(Merit, Node)> =
            merits_of(plan).into_iter().filter_map(|merit| Some((merit, cancelled(&mut recording, merit, &results)?))).collect();
        let is_wanted = |at: usize| if at < OUTPUTS { wanted >> at & 1 == 1 } else { mattering >> (at - OUTPUTS) & 1 == 1 };
        let asked: Vec<Option<Node>> = results.into_iter().enumerate().map(|(at, node)| is_wanted(at).then_some(node)).collect();
        Some(Self::cut(recording, &asked, merits, input_axes))
    }

    /// Keeps what is asked for and follows who depends on what.
    fn cut(recording: Recording, asked: &[Option<Node>], merits: Vec<(Merit, Node)>, input_axes: [Option<(u8, u8)>; INPUTS]) -> Self {
        let Recording { operations, roots, .. } = recording;
        let mut needed = vec![false; operations.len()];
        asked.iter().flatten().chain(merits.iter().map(|(_, node)| node)).for_each(|&node| needed[node as usize] = true);
        for node in (0..operations.len()).rev() {
            if needed[node] {
                if let Operation::Root(number) = operations[node] {
                    let root = &roots[number as usize];
                    for node in [root.bracket.0, root.bracket.1, root.start, root.argument, root.value, root.slope] {
                        needed[node as usize] = true;
                    }
                }
                operations[node].operands(|operand| needed[operand as usize] = true);
            }
        }
        let mut place = vec![Node::MAX; operations.len()];
        let mut tape = Self {
            operations: Vec::new(),
            roots: roots.into_iter().map(|root| TapeRoot { root, inner: Vec::new() }).collect(),
            axes: Vec::new(),
            inner: Vec::new(),
            input_axes,
            outputs: [None; OUTPUTS],
            conditions: [None; CONDITIONS],
            merits: Vec::new(),
        };
        // Of every operation: the roots whose argument it depends on.
        let mut arguments: Vec<u64> = Vec::new();
        for (node, &operation) in operations.iter().enumerate().filter(|(node, _)| needed[*node]) {
            let new = tape.operations.len() as Node;
            place[node] = new;
            let at = |old: Node| place[old as usize];
            let operation = match operation {
                Operation::Unary(kind, a) => Operation::Unary(kind, at(a)),
                Operation::Binary(kind, a, b) => Operation::Binary(kind, at(a), at(b)),
                Operation::Select(margin, a, b) => Operation::Select(at(margin), at(a), at(b)),
                other => other,
            };
            let (mut depends, mut within) = (0, 0);
            match operation {
                Operation::Input(input) => depends = input_axes[input as usize].map_or(0, |(axis, _)| 1 << axis),
                Operation::Argument(root) => within = 1 << root,
                Operation::Root(number) => {
                    let root = &mut tape.roots[number as usize];
                    let Root { bracket, start, argument, value, slope } = root.root;
                    root.root = Root {
                        bracket: (at(bracket.0), at(bracket.1)),
                        start: at(start),
                        argument: at(argument),
                        value: at(value),
                        slope: at(slope),
                    };
                    let Root { bracket, start, value, slope, .. } = root.root;
                    for node in [bracket.0, bracket.1, start, value, slope] {
                        depends |= tape.axes[node as usize];
                        within |= arguments[node as usize];
                    }
                    within &= !(1 << number);
                    root.inner = (0..new)
                        .filter(|&node| {
                            arguments[node as usize] >> number & 1 == 1 && tape.operations[node as usize] != Operation::Argument(number)
                        })
                        .collect();
                }
                other => other.operands(|operand| {
                    depends |= tape.axes[operand as usize];
                    within |= arguments[operand as usize];
                }),
            }
            tape.operations.push(operation);
            tape.axes.push(depends);
            arguments.push(within);
        }
        tape.merits = merits.into_iter().map(|(merit, node)| (merit, place[node as usize])).collect();
        tape.inner = arguments.iter().map(|&within| within != 0).collect();
        for (number, node) in asked.iter().enumerate() {
            let node = node.map(|node| place[node as usize]);
            if number < OUTPUTS { tape.outputs[number] = node } else { tape.conditions[number - OUTPUTS] = node }
        }
        tape
    }

    /// The operations that these nodes need, operands first, without those inside the functions of roots.
    pub fn needed_by(&self, nodes: &[Node]) -> Vec<Node> {
        let mut needed = vec![false; self.operations.len()];
        nodes.iter().for_each(|&node| needed[node as usize] = true);
        for node in (0..self.operations.len()).rev().filter(|&node| !self.inner[node]) {
            if !needed[node] {
                continue;
            }
            let mut mark = |operand: Node| needed[operand as usize] = true;
            match self.operations[node] {
                Operation::Root(number) => self.outside(number, &mut mark),
                operation => operation.operands(mark),
            }
        }
        (0..self.operations.len() as Node).filter(|&node| needed[node as usize] && !self.inner[node as usize]).collect()
    }

    /// Per axis: the operations that depend on it alone, operands first.
    pub fn alone(&self, axes: usize) -> Vec<Vec<Node>> {
        let mut alone = vec![Vec::new(); axes];
        for node in 0..self.operations.len() {
            if let Some(axis) = self.own_axis(node) {
                alone[axis].push(node as Node);
            }
        }
        alone
    }

    /// Of these: those that others need or the study asks for.
    pub fn kept(&self, axes: usize) -> Vec<Vec<Node>> {
        let mut read = vec![false; self.operations.len()];
        let asked = self.outputs.iter().chain(&self.conditions).flatten().chain(self.merits.iter().map(|(_, node)| node));
        asked.for_each(|&node| read[node as usize] = true);
        for node in (0..self.operations.len()).filter(|&node| self.own_axis(node).is_none()) {
            let mut mark = |operand: Node| read[operand as usize] = true;
            match self.operations[node] {
                Operation::Root(number) => self.outside(number, mark),
                operation => operation.operands(&mut mark),
            }
        }
        let mut kept = self.alone(axes);
        kept.iter_mut().for_each(|nodes| nodes.retain(|&node| read[node as usize]));
        kept
    }

    /// The axis that an operation depends on alone.
    fn own_axis(&self, node: usize) -> Option<usize> {
        (!self.inner[node] && self.axes[node].is_power_of_two()).then(|| self.axes[node].trailing_zeros() as usize)
    }

    /// Calls `each` with what a root and its function read that does not depend on what the function is asked at.
    pub fn outside(&self, number: u8, mut each: impl FnMut(Node)) {
        let TapeRoot { root, inner } = &self.roots[number as usize];
        for node in [root.bracket.0, root.bracket.1, root.start, root.value, root.slope] {
            if !self.inner[node as usize] {
                each(node);
            }
        }
        for &node in inner {
            self.operations[node as usize].operands(|operand| {
                if !self.inner[operand as usize] {
                    each(operand);
                }
            });
        }
    }

    /// Computes one operation from its operands; what inputs are is the caller's business.
    #[inline]
    pub fn compute<R: Real>(&self, node: Node, slots: &mut [R]) {
        let value = match self.operations[node as usize] {
            Operation::Input(_) | Operation::Argument(_) => return,
            Operation::Constant(bits) => R::constant(f64::from_bits(bits)),
            Operation::Root(number) => self.root(number, slots),
            Operation::Unary(operation, a) => operation.of(slots[a as usize]),
            Operation::Binary(Binary::Mul, a, b) if a == b => slots[a as usize].squared(),
            Operation::Binary(operation, a, b) => operation.of(slots[a as usize], slots[b as usize]),
            Operation::Select(margin, a, b) => R::select(slots[margin as usize], slots[a as usize], slots[b as usize]),
        };
        slots[node as usize] = value;
    }

    fn root<R: Real>(&self, number: u8, slots: &mut [R]) -> R {
        let TapeRoot { root, inner } = &self.roots[number as usize];
        let [low, high, start] = [root.bracket.0, root.bracket.1, root.start].map(|node| slots[node as usize]);
        // The function is asked again and again, but by one caller at a time.
        let slots = RefCell::new(slots);
        R::monotone_root((low, high), start, [], |[], x| {
            let mut slots = slots.borrow_mut();
            slots[root.argument as usize] = x;
            for &node in inner {
                self.compute(node, &mut slots);
            }
            (slots[root.value as usize], slots[root.slope as usize])
        })
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
fn factors(recording: &Recording, node: Node, above: &mut Vec<Node>, below: &mut Vec<Node>) {
    match recording.operations[node as usize] {
        Operation::Binary(Binary::Mul, a, b) => {
            factors(recording, a, above, below);
            factors(recording, b, above, below);
        }
        Operation::Binary(Binary::Div, a, b) => {
            factors(recording, a, above, below);
            factors(recording, b, below, above);
        }
        _ => above.push(node),
    }
}
