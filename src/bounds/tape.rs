//! The formula of a study as a list of operations: cut down to what the study asks for, with what each of them depends on.

use super::axes::Axes;
use crate::models::{CONDITIONS, Formula, INPUTS, OUTPUTS, Visitor, input_to_si, visit};
use crate::plan::Plan;
use crate::real::Real;
use crate::real::trace::{Known, Node, Operation, Recording, Root, Trace};
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
        let is_wanted = |at: usize| if at < OUTPUTS { wanted >> at & 1 == 1 } else { mattering >> (at - OUTPUTS) & 1 == 1 };
        let asked: Vec<Option<Node>> = results.into_iter().enumerate().map(|(at, node)| is_wanted(at).then_some(node)).collect();
        Some(Self::cut(recording, &asked, input_axes))
    }

    /// Keeps what is asked for and follows who depends on what.
    fn cut(recording: Recording, asked: &[Option<Node>], input_axes: [Option<(u8, u8)>; INPUTS]) -> Self {
        let Recording { operations, roots, .. } = recording;
        let mut needed = vec![false; operations.len()];
        asked.iter().flatten().for_each(|&node| needed[node as usize] = true);
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
                    root.root = Root { bracket: (at(bracket.0), at(bracket.1)), start: at(start), argument: at(argument), value: at(value), slope: at(slope) };
                    let Root { bracket, start, value, slope, .. } = root.root;
                    for node in [bracket.0, bracket.1, start, value, slope] {
                        depends |= tape.axes[node as usize];
                        within |= arguments[node as usize];
                    }
                    within &= !(1 << number);
                    root.inner = (0..new).filter(|&node| arguments[node as usize] >> number & 1 == 1 && tape.operations[node as usize] != Operation::Argument(number)).collect();
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
            Operation::Binary(crate::real::trace::Binary::Mul, a, b) if a == b => slots[a as usize].squared(),
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
