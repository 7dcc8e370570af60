//! A recorded formula cut down to what is asked for, run over any number type.

use super::{Binary, FormulaTable, ListLoop, Node, Operation, Recording, Rolled, RolledLoop, Root, RootParameter};
use crate::real::Real;
use std::cell::RefCell;
use std::ops::BitOrAssign;

/// What a number is called, and the equation that it comes from.
pub type Name = (&'static str, &'static str);

/// The operations that some results need, operands first.
#[derive(Clone, Debug, Default)]
pub struct List {
    /// All operations, operands first.
    pub operations: Vec<Operation>,
    /// The roots among them.
    pub roots: Vec<ListRoot>,
    /// The loops that are recorded once, and the tables that they write.
    pub loops: Vec<ListLoop>,
    /// By number.
    pub tables: Vec<FormulaTable>,
    /// Of every operation: is it part of a root's function or a loop's body, so that it has a value only while these run?
    pub inner: Vec<bool>,
    /// Of every operation: what the formula calls it.
    pub names: Vec<Option<Name>>,
    /// The results, in the order in which they were asked for; `None` for those that nobody asked for.
    pub results: Vec<Option<Node>>,
}

/// A root with the operations of its function.
#[derive(Clone, Debug)]
pub struct ListRoot {
    /// The root as recorded.
    pub root: Root,
    /// Operations that depend on what the function is asked at, operands first.
    pub inner: Vec<Node>,
}

/// In the sets of roots and loops that an operation depends on: where the loops begin.
const LOOPS: u8 = 32;

/// Which operations these results need: those that a list cut to them has, in this order.
pub(super) fn needed(recording: &Recording, asked: &[Option<Node>]) -> Vec<bool> {
    let mut needed = vec![false; recording.operations.len()];
    let mut open: Vec<Node> = asked.iter().flatten().copied().collect();
    while let Some(node) = open.pop() {
        if std::mem::replace(&mut needed[node as usize], true) {
            continue;
        }
        match recording.operations[node as usize] {
            Operation::Root(number) => {
                let root = recording.roots[number as usize];
                root.reads(|node| open.push(node));
                open.push(root.argument);
            }
            operation => operation.operands(|node| open.push(node)),
        }
        if let Operation::Rolled(rolled) = recording.operations[node as usize] {
            rolled.of_loop(&recording.loops, |node| open.push(node));
        }
    }
    needed
}

impl List {
    /// Keeps what these results need.
    pub fn cut(recording: &Recording, asked: &[Option<Node>]) -> Self {
        let Recording { operations, roots, loops, tables, .. } = recording;
        let needed = needed(recording, asked);
        let in_use = |loop_number: u8| {
            let is_of = |operation: &Operation| matches!(operation, Operation::Rolled(rolled) if rolled.any_loop() == Some(loop_number));
            operations.iter().zip(&needed).any(|(operation, needed)| *needed && is_of(operation))
        };
        let loops: Vec<(u8, &RolledLoop)> = (0..).zip(loops).filter(|(number, _)| in_use(*number)).collect();
        let new_number = |old: u8| loops.iter().position(|(number, _)| *number == old).map_or(u8::MAX, |new| new as u8);
        let mut place = vec![Node::MAX; operations.len()];
        let mut list = Self { roots: roots.iter().map(|root| ListRoot { root: *root, inner: Vec::new() }).collect(), ..Self::default() };
        list.tables.clone_from(tables);
        // Of every operation: the roots whose argument it depends on, then the loops whose place or state it does.
        let mut arguments: Vec<u64> = Vec::new();
        for (node, &operation) in operations.iter().enumerate().filter(|(node, _)| needed[*node]) {
            let new = list.operations.len() as Node;
            place[node] = new;
            let at = |old: Node| place[old as usize];
            let operation = match operation.map(at) {
                Operation::Rolled(rolled) => Operation::Rolled(rolled.renumbered(new_number)),
                other => other,
            };
            let mut within = 0;
            match operation {
                Operation::Argument(root) => within = 1 << root,
                Operation::Rolled(rolled) if rolled.inside().is_some() => within = 1 << (LOOPS + rolled.inside().unwrap_or_default()),
                Operation::Root(number) => {
                    let root = &mut list.roots[number as usize];
                    root.root = root.root.map(at);
                    root.root.reads(|node| within |= arguments[node as usize]);
                    within &= !(1 << number);
                    let is_inner = |&node: &Node| {
                        arguments[node as usize] >> number & 1 == 1 && list.operations[node as usize] != Operation::Argument(number)
                    };
                    root.inner = (0..new).filter(is_inner).collect();
                    // A parameter that went into other numbers alone may not be computed at all.
                    let is_computed = |it| !matches!(it, RootParameter::Node(Node::MAX));
                    root.root.function = root.root.function.filter(|it| it.parameters.into_iter().all(is_computed));
                }
                other => other.operands(|operand| within |= arguments[operand as usize]),
            }
            list.operations.push(operation);
            list.names.push(recording.name(node as Node));
            arguments.push(within);
        }
        list.inner = arguments.iter().map(|&within| within != 0).collect();
        let kept = loops.iter().zip(0..).map(|((_, it), number)| {
            let inner =
                (0..arguments.len()).filter(|&node| arguments[node] >> (LOOPS + number) & 1 == 1).map(|node| node as Node).collect();
            let used = (0..it.state.len() as u8).map(|at| {
                let of_state = [Rolled::State(number, at), Rolled::Folded(number, at)].map(Operation::Rolled);
                it.until_zero == Some(at) || list.operations.iter().any(|operation| of_state.contains(operation))
            });
            ListLoop { recorded: it.map(|node| place[node as usize], new_number), used: used.collect(), inner }
        });
        list.loops = kept.collect();
        list.results = asked.iter().map(|node| node.map(|node| place[node as usize])).collect();
        list
    }

    /// Of every operation: the union of the sets that the inputs which it depends on have. Who depends on nothing has the empty set.
    pub fn dependencies<S: Copy + Default + BitOrAssign>(&self, of_input: impl Fn(u16) -> S) -> Vec<S> {
        let mut sets: Vec<S> = Vec::with_capacity(self.operations.len());
        for &operation in &self.operations {
            let mut set = S::default();
            match operation {
                Operation::Input(input) => set = of_input(input),
                Operation::Root(number) => self.roots[number as usize].root.reads(|node| set |= sets[node as usize]),
                other => other.operands(|operand| set |= sets[operand as usize]),
            }
            sets.push(set);
        }
        sets
    }

    /// The operations that these nodes need, operands first, without those inside the functions of roots.
    pub fn needed_by(&self, nodes: &[Node]) -> Vec<Node> {
        let mut needed = vec![false; self.operations.len()];
        nodes.iter().for_each(|&node| needed[node as usize] = true);
        for node in (0..self.operations.len()).rev().filter(|&node| !self.inner[node]) {
            if !needed[node] {
                continue;
            }
            let mark = |operand: Node| needed[operand as usize] = true;
            self.reads(node as Node, mark);
        }
        (0..self.operations.len() as Node).filter(|&node| needed[node as usize] && !self.inner[node as usize]).collect()
    }

    /// Calls `each` with the operations that one reads when it is computed.
    pub fn reads(&self, node: Node, each: impl FnMut(Node)) {
        match self.operations[node as usize] {
            Operation::Root(number) => self.outside(number, each),
            operation => operation.operands(each),
        }
    }

    /// Calls `each` with what a root and its function read that does not depend on what the function is asked at.
    pub fn outside(&self, number: u8, mut each: impl FnMut(Node)) {
        let ListRoot { root, inner } = &self.roots[number as usize];
        root.reads(|node| {
            if !self.inner[node as usize] {
                each(node);
            }
        });
        root.function.iter().for_each(|it| it.nodes().for_each(&mut each));
        for &node in inner {
            self.operations[node as usize].operands(|operand| {
                if !self.inner[operand as usize] {
                    each(operand);
                }
            });
        }
    }

    /// The value of every operation that is not [`List::inner`], given those of the inputs; `unknown` for what loops leave.
    pub fn values<R: Real>(&self, inputs: &[R], unknown: R) -> Vec<R> {
        let mut slots = vec![unknown; self.operations.len()];
        self.refill(inputs, |_| true, &mut slots);
        slots
    }

    /// Computes some of these again, where only inputs that they depend on have changed.
    pub fn refill<R: Real>(&self, inputs: &[R], changes: impl Fn(usize) -> bool, slots: &mut [R]) {
        for (node, operation) in self.operations.iter().enumerate().filter(|(node, _)| !self.inner[*node] && changes(*node)) {
            match *operation {
                Operation::Input(input) => slots[node] = inputs[input as usize],
                _ => self.compute(node as Node, slots),
            }
        }
    }

    /// Computes one operation from its operands; what inputs are is the caller's business.
    #[inline]
    pub fn compute<R: Real>(&self, node: Node, slots: &mut [R]) {
        let value = match self.operations[node as usize] {
            Operation::Input(_) | Operation::Argument(_) | Operation::Rolled(_) => return,
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
        let ListRoot { root, inner } = &self.roots[number as usize];
        let [low, high, start] = [root.bracket.0, root.bracket.1, root.start].map(|node| slots[node as usize]);
        // The function is asked again and again, but by one caller at a time.
        let slots = RefCell::new(slots);
        R::monotone_root((low, high), start, root.smoothness, [], |[], x| {
            let mut slots = slots.borrow_mut();
            slots[root.argument as usize] = x;
            for &node in inner {
                self.compute(node, &mut slots);
            }
            (slots[root.value as usize], slots[root.slope as usize])
        })
    }

    /// Runs the list over numbers of any type, one per input; results that nobody asked for are zero.
    pub fn run<R: Real>(&self, inputs: &[R]) -> Vec<R> {
        let zero = R::constant(0.0);
        let slots = self.values(inputs, zero);
        self.results.iter().map(|result| result.map_or(zero, |node| slots[node as usize])).collect()
    }
}
