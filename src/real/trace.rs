//! A formula as a list of operations, recorded by running it once.
//!
//! What the formula is run on are not numbers but names of numbers: every operation that it asks for is written down. The list can
//! then be run over any other [`Real`], cut down to what is asked for, and searched for structure (see [`crate::bounds`]). Constants
//! are folded with the functions of f64 and equal operations are written once, so that f64 gives the same bits as the formula.

use super::{Real, bracketed_newton};
use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Number of an operation in its list.
pub type Node = u32;

/// An operation; its operands come before it in the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Operation {
    /// An input, by number.
    Input(u8),
    /// A known number, as bits.
    Constant(u64),
    /// What the function of a root is asked at.
    Argument(u8),
    /// The root of an increasing function: its number among the roots.
    Root(u8),
    /// Of one number.
    Unary(Unary, Node),
    /// Of two numbers.
    Binary(Binary, Node, Node),
    /// Margin, at least zero, below zero.
    Select(Node, Node, Node),
}

/// Operations on one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names of the operations of Real")]
pub enum Unary {
    Neg,
    Sqrt,
    Abs,
    ExpM1,
    Ln1p,
    Sin,
    Cos,
    Asin,
}

/// Operations on two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names of the operations of Real")]
pub enum Binary {
    Add,
    Sub,
    Mul,
    Div,
    Min,
    Max,
    PlusWhole,
}

impl Unary {
    /// Applies it.
    #[inline(always)]
    pub fn of<R: Real>(self, a: R) -> R {
        match self {
            Self::Neg => -a,
            Self::Sqrt => a.sqrt(),
            Self::Abs => a.abs(),
            Self::ExpM1 => a.exp_m1(),
            Self::Ln1p => a.ln_1p(),
            Self::Sin => a.sin(),
            Self::Cos => a.cos(),
            Self::Asin => a.asin(),
        }
    }
}

impl Binary {
    /// Applies it.
    #[inline(always)]
    pub fn of<R: Real>(self, a: R, b: R) -> R {
        match self {
            Self::Add => a + b,
            Self::Sub => a - b,
            Self::Mul => a * b,
            Self::Div => a / b,
            Self::Min => a.min(b),
            Self::Max => a.max(b),
            Self::PlusWhole => a.plus_whole(b),
        }
    }
}

impl Operation {
    /// Calls `each` with every operand; those of a root's function are in [`Root`].
    pub fn operands(self, mut each: impl FnMut(Node)) {
        match self {
            Self::Input(_) | Self::Constant(_) | Self::Argument(_) | Self::Root(_) => {}
            Self::Unary(_, a) => each(a),
            Self::Binary(_, a, b) => {
                each(a);
                each(b);
            }
            Self::Select(margin, a, b) => {
                each(margin);
                each(a);
                each(b);
            }
        }
    }
}

/// The root of an increasing function: where it is sought, and what the function is.
#[derive(Clone, Debug, PartialEq)]
pub struct Root {
    /// Ends of the bracket.
    pub bracket: (Node, Node),
    /// Where the search starts.
    pub start: Node,
    /// Stands for what the function is asked at.
    pub argument: Node,
    /// The function's value.
    pub value: Node,
    /// The function's slope.
    pub slope: Node,
}

/// What is known of an input before the formula runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Known {
    /// The same number for all.
    Fixed(f64),
    /// Values from the least to the largest.
    Within(f64, f64),
}

/// A recorded formula.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// All operations, operands first.
    pub operations: Vec<Operation>,
    /// The roots among them.
    pub roots: Vec<Root>,
    known: HashMap<Operation, Node>,
    /// Ends of inputs that vary.
    ranges: HashMap<Node, (f64, f64)>,
}

/// A number's name while a formula is recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trace(Node);

thread_local! {
    static RECORDER: RefCell<Recording> = RefCell::default();
}

fn with<T>(act: impl FnOnce(&mut Recording) -> T) -> T {
    RECORDER.with(|recorder| act(&mut recorder.borrow_mut()))
}

impl Recording {
    /// Records a formula; returns what it returned, as nodes of the list.
    pub fn of(inputs: &[Known], formula: impl FnOnce(&[Trace]) -> Vec<Trace>) -> (Self, Vec<Node>) {
        with(|recorder| *recorder = Self::default());
        let named: Vec<Trace> = inputs
            .iter()
            .enumerate()
            .map(|(input, known)| match *known {
                Known::Fixed(value) => Trace::constant(value),
                Known::Within(low, high) => with(|recorder| {
                    let node = recorder.push(Operation::Input(u8::try_from(input).expect("a model has few inputs")));
                    recorder.ranges.insert(node, (low, high));
                    Trace(node)
                }),
            })
            .collect();
        let results = formula(&named).into_iter().map(|trace| trace.0).collect();
        (with(std::mem::take), results)
    }

    /// Writes an operation down, unless it stands there already.
    pub fn push(&mut self, operation: Operation) -> Node {
        let next = Node::try_from(self.operations.len()).expect("a formula has fewer than 2^32 operations");
        *self.known.entry(operation).or_insert_with(|| {
            self.operations.push(operation);
            next
        })
    }

    fn constant_at(&self, node: Node) -> Option<f64> {
        match self.operations[node as usize] {
            Operation::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }
}

impl Trace {
    fn known(self) -> Option<f64> {
        with(|recorder| recorder.constant_at(self.0))
    }

    fn unary(self, operation: Unary) -> Self {
        match self.known() {
            Some(value) => Self::constant(operation.of(value)),
            None => Self(with(|recorder| recorder.push(Operation::Unary(operation, self.0)))),
        }
    }

    fn binary(self, operation: Binary, other: Self) -> Self {
        match (self.known(), other.known()) {
            (Some(a), Some(b)) => Self::constant(operation.of(a, b)),
            _ => Self(with(|recorder| recorder.push(Operation::Binary(operation, self.0, other.0)))),
        }
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl $trait for Trace {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                self.binary(Binary::$trait, other)
            }
        }
    };
}
operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl Neg for Trace {
    type Output = Self;
    fn neg(self) -> Self {
        self.unary(Unary::Neg)
    }
}

impl Real for Trace {
    type Shared = Self;
    fn shared(value: Self) -> Self {
        value
    }
    fn constant(value: f64) -> Self {
        Self(with(|recorder| recorder.push(Operation::Constant(value.to_bits()))))
    }
    fn sqrt(self) -> Self {
        self.unary(Unary::Sqrt)
    }
    fn abs(self) -> Self {
        self.unary(Unary::Abs)
    }
    fn min(self, other: Self) -> Self {
        self.binary(Binary::Min, other)
    }
    fn max(self, other: Self) -> Self {
        self.binary(Binary::Max, other)
    }
    fn exp_m1(self) -> Self {
        self.unary(Unary::ExpM1)
    }
    fn ln_1p(self) -> Self {
        self.unary(Unary::Ln1p)
    }
    fn sin(self) -> Self {
        self.unary(Unary::Sin)
    }
    fn cos(self) -> Self {
        self.unary(Unary::Cos)
    }
    fn asin(self) -> Self {
        self.unary(Unary::Asin)
    }
    fn select(margin: Self, at_least_zero: Self, below_zero: Self) -> Self {
        let ends = with(|recorder| recorder.constant_at(margin.0).map(|it| (it, it)).or(recorder.ranges.get(&margin.0).copied()));
        match ends {
            Some((low, _)) if low >= 0.0 => at_least_zero,
            Some((_, high)) if high < 0.0 => below_zero,
            _ if at_least_zero == below_zero => at_least_zero,
            _ => Self(with(|recorder| recorder.push(Operation::Select(margin.0, at_least_zero.0, below_zero.0)))),
        }
    }
    fn plus_whole(self, other: Self) -> Self {
        self.binary(Binary::PlusWhole, other)
    }
    fn turns(self, most: usize) -> usize {
        let highest = with(|recorder| recorder.constant_at(self.0).or(recorder.ranges.get(&self.0).map(|ends| ends.1)));
        highest.map_or(most, |value| value.turns(most))
    }
    fn is_zero(self) -> bool {
        self.known() == Some(0.0)
    }
    fn monotone_root<const P: usize>(
        bracket: (Self, Self),
        start: Self,
        parameters: [Self; P],
        function: impl Fn([Self; P], Self) -> (Self, Self),
    ) -> Self {
        let number = with(|recorder| recorder.roots.len());
        let index = u8::try_from(number).expect("a formula has few roots");
        let argument = Self(with(|recorder| recorder.push(Operation::Argument(index))));
        // Taken at once, so that a root within this function gets a number of its own.
        let unknown = Root { bracket: (0, 0), start: 0, argument: argument.0, value: 0, slope: 0 };
        with(|recorder| recorder.roots.push(unknown));
        let (value, slope) = function(parameters, argument);
        if let (Some(low), Some(high), Some(first)) = (bracket.0.known(), bracket.1.known(), start.known()) {
            let root = with(|recorder| recorder.constant_root(argument.0, value.0, slope.0, (low, high), first));
            if let Some(root) = root {
                return Self::constant(root);
            }
        }
        let root = Root { bracket: (bracket.0.0, bracket.1.0), start: start.0, argument: argument.0, value: value.0, slope: slope.0 };
        with(|recorder| {
            recorder.roots[number] = root;
            Self(recorder.push(Operation::Root(index)))
        })
    }
}

impl Recording {
    /// The root of a function of its argument alone.
    fn constant_root(&self, argument: Node, value: Node, slope: Node, bracket: (f64, f64), start: f64) -> Option<f64> {
        let mut needed = vec![false; self.operations.len()];
        needed[value as usize] = true;
        needed[slope as usize] = true;
        for node in (0..self.operations.len()).rev().filter(|&node| node as Node != argument) {
            if needed[node] {
                match self.operations[node] {
                    Operation::Input(_) | Operation::Root(_) | Operation::Argument(_) => return None,
                    operation => operation.operands(|operand| needed[operand as usize] = true),
                }
            }
        }
        let mut slots = vec![0.0; self.operations.len()];
        Some(bracketed_newton(bracket, start, f64::EPSILON, |x| {
            for node in (0..slots.len()).filter(|&node| needed[node]) {
                slots[node] = match self.operations[node] {
                    Operation::Constant(bits) => f64::from_bits(bits),
                    Operation::Unary(operation, a) => operation.of(slots[a as usize]),
                    Operation::Binary(operation, a, b) => operation.of(slots[a as usize], slots[b as usize]),
                    Operation::Select(margin, a, b) => f64::select(slots[margin as usize], slots[a as usize], slots[b as usize]),
                    Operation::Input(_) | Operation::Argument(_) | Operation::Root(_) => x,
                };
            }
            (slots[value as usize], slots[slope as usize])
        }))
    }
}
