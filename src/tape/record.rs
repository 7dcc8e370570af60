//! Recording: a formula runs on names of numbers, and every operation that it asks for is written down.

use super::{Binary, Node, Operation, Root, Unary};
use crate::real::{Real, bracketed_newton};
use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// What is known of an input before the formula runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Known {
    /// The same number for all.
    Fixed(f64),
    /// Values from the least to the largest.
    Within(f64, f64),
}

impl Known {
    /// Nothing is known.
    pub const ANY: Self = Self::Within(f64::NEG_INFINITY, f64::INFINITY);
}

/// A recorded formula.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// All operations, operands first.
    pub operations: Vec<Operation>,
    /// The roots among them.
    pub roots: Vec<Root>,
    known: HashMap<Operation, Node>,
    /// Ends of inputs that vary, and of their negatives.
    ranges: HashMap<Node, (f64, f64)>,
    /// What the formula calls a number, and the equation that it comes from.
    names: HashMap<Node, (&'static str, &'static str)>,
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
                    let node = recorder.push(Operation::Input(u16::try_from(input).expect("a model has few inputs")));
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

    /// The number, if it is the same for all.
    pub fn constant_at(&self, node: Node) -> Option<f64> {
        match self.operations[node as usize] {
            Operation::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// Least and largest value of a number, where that is known.
    fn ends(&self, node: Node) -> Option<(f64, f64)> {
        self.constant_at(node).map(|value| (value, value)).or(self.ranges.get(&node).copied())
    }

    /// What the formula calls a number, and the equation that it comes from; the latter may be empty.
    pub fn name(&self, node: Node) -> Option<(&'static str, &'static str)> {
        self.names.get(&node).copied()
    }
}

/// The power of a power of two that f32 holds too: products with it are exact.
fn power_of_two(value: f64) -> Option<i16> {
    let power = (value.to_bits() >> 52) as i16 - 1023;
    (value > 0.0 && value.to_bits() << 12 == 0 && power.abs() <= 126).then_some(power)
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
            (Some(a), None) if operation == Binary::Mul && power_of_two(a).is_some() => other.scaled_by(a),
            (None, Some(b)) if operation == Binary::Mul && power_of_two(b).is_some() => self.scaled_by(b),
            (None, Some(b)) if operation == Binary::Div && power_of_two(b).is_some() => self.scaled_by(1.0 / b),
            _ => Self(with(|recorder| recorder.push(Operation::Binary(operation, self.0, other.0)))),
        }
    }

    /// Times a power of two, which is exact.
    fn scaled_by(self, factor: f64) -> Self {
        match power_of_two(factor) {
            Some(0) | None => self,
            Some(power) => self.unary(Unary::Scale(power)),
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
        let negative = self.unary(Unary::Neg);
        with(|recorder| {
            if let Some((low, high)) = recorder.ranges.get(&self.0).copied() {
                recorder.ranges.insert(negative.0, (-high, -low));
            }
        });
        negative
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
        match with(|recorder| recorder.ends(margin.0)) {
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
        with(|recorder| recorder.ends(self.0)).map_or(most, |(_, highest)| highest.turns(most))
    }
    fn named(self, name: &'static str, equation: &'static str) -> Self {
        with(|recorder| {
            recorder.names.entry(self.0).or_insert((name, equation));
        });
        self
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
