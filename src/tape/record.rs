//! Recording: a formula runs on names of numbers, and every operation that it asks for is written down.

use super::{Binary, Fields, FormulaTable, KnownFunction, Node, Operation, Rolled, RolledLoop, Root, RootParameter, Store, Unary};
use crate::real::{Loop, Place, ROOT_PARAMETERS, Real, RootFunction, Smoothness, bracketed_newton, chosen_at};
use rustc_hash::FxHashMap as HashMap;
use std::cell::RefCell;
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

/// How loops are recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loops {
    /// Every iteration for itself, to be run in boxes and with derivatives.
    EveryIteration,
    /// Once, unless the number of iterations is known: for a device.
    Once,
}

/// A recorded formula.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// All operations, operands first.
    pub operations: Vec<Operation>,
    /// The roots among them.
    pub roots: Vec<Root>,
    /// The loops that are recorded once; none where every iteration is.
    pub loops: Vec<RolledLoop>,
    /// The tables that these write.
    pub tables: Vec<FormulaTable>,
    /// Are loops recorded once?
    rolls: bool,
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
        Self::recorded(Loops::EveryIteration, inputs, formula)
    }

    /// The same with the loops recorded one way or the other.
    pub fn recorded(loops: Loops, inputs: &[Known], formula: impl FnOnce(&[Trace]) -> Vec<Trace>) -> (Self, Vec<Node>) {
        let rolls = loops == Loops::Once;
        with(|recorder| *recorder = Self { rolls, ..Self::default() });
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

    /// Number of the table that this stands for.
    fn table(&self, node: Node) -> Option<u8> {
        match self.operations[node as usize] {
            Operation::Rolled(Rolled::Table(table, _)) => Some(table),
            _ => None,
        }
    }

    /// What a table is read as: the version last written, or, of what the first stage passed on, its first number.
    fn readable(&self, first: Node) -> Option<Node> {
        match self.operations[first as usize] {
            Operation::Rolled(Rolled::Table(table, _)) => Some(self.tables[usize::from(table)].version),
            Operation::Input(_) if self.rolls => Some(first),
            _ => None,
        }
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

/// A new table, where loops are recorded once.
fn new_table(name: &'static str, length: usize, fill: Trace) -> Option<Trace> {
    with(|recorder| {
        recorder.rolls.then(|| {
            let table = u8::try_from(recorder.tables.len()).expect("a formula has few tables");
            // Two tables that begin alike are two: their numbers differ.
            let version = recorder.push(Operation::Rolled(Rolled::Table(table, fill.0)));
            recorder.tables.push(FormulaTable { name, length, version });
            Trace(version)
        })
    })
}

impl Trace {
    /// Room for what a first stage passes on: numbers, then tables.
    pub(crate) fn to_pass_on(fields: &Fields) -> Vec<Self> {
        let zero = Self::constant(0.0);
        let tables = fields.tables.iter().flat_map(|&(_, length)| vec![new_table("", length, zero).unwrap_or(zero); length]);
        vec![zero; fields.prepared.len()].into_iter().chain(tables).collect()
    }

    /// The table as it was last written, if this stands for one.
    pub(crate) fn as_written(self) -> Self {
        with(|recorder| recorder.table(self.0).map_or(self, |table| Self(recorder.tables[usize::from(table)].version)))
    }

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
    fn floor(self) -> Self {
        self.unary(Unary::Floor)
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
    fn iterations(self, most: usize) -> usize {
        with(|recorder| recorder.ends(self.0)).map_or(most, |(_, highest)| highest.iterations(most))
    }
    fn named(self, name: &'static str, equation: &'static str) -> Self {
        with(|recorder| {
            recorder.names.entry(self.0).or_insert((name, equation));
        });
        self
    }
    fn fold<const S: usize>(over: Loop<Self>, state: [Self; S], body: impl FnMut(Place, [Self; S]) -> [Self; S]) -> [Self; S] {
        if with(|recorder| recorder.rolls) && over.end.known().is_none() { rolled(over, state, body) } else { over.run(state, body) }
    }
    fn number(place: Place) -> Self {
        let offset = Self::constant(place.number.into());
        match place.of {
            None => offset,
            Some(number) => {
                let index = Self(with(|recorder| recorder.push(Operation::Rolled(Rolled::Index(number)))));
                if place.number == 0 { index } else { index.plus_whole(offset) }
            }
        }
    }
    fn beyond(place: Place, end: Self) -> Self {
        let inside = |number: u8| place.number <= 0 && with(|recorder| recorder.loops[usize::from(number)].end == end.0);
        match place.of {
            Some(number) if inside(number) => Self::constant(-0.5),
            Some(_) => Self::number(Place { number: 0, ..place }).plus_whole(Self::constant(f64::from(place.number) + 0.5)) - end,
            None => Self::constant(f64::from(place.number) + 0.5) - end,
        }
    }
    fn table<const N: usize>(name: &'static str, fill: Self) -> [Self; N] {
        [new_table(name, N, fill).unwrap_or(fill); N]
    }
    fn put(table: &mut [Self], place: Place, number: Self) {
        let written = with(|recorder| {
            let table = recorder.table(table[0].0)?;
            let of = place.of.expect("a table of a recorded formula is written in its loops");
            recorder.loops[usize::from(of)].stores.push(Store { table, place, number: number.0 });
            Some(())
        });
        if written.is_none() {
            table[place.known()] = number;
        }
    }
    fn put_last(table: &mut [Self], end: Self, number: Self) {
        let written = with(|recorder| {
            let written = usize::from(recorder.table(table[0].0)?);
            let before = recorder.tables[written].version;
            recorder.tables[written].version = recorder.push(Operation::Rolled(Rolled::PutLast(before, end.0, number.0)));
            Some(())
        });
        if written.is_none() {
            let most = end.iterations(table.len() - 1);
            for (at, held) in table.iter_mut().enumerate().take(most + 1) {
                *held = Self::select(Self::beyond(Place::at(at), end), number, *held);
            }
        }
    }
    fn get(table: &[Self], place: Place) -> Self {
        let get =
            |recorder: &mut Recording| recorder.readable(table[0].0).map(|it| recorder.push(Operation::Rolled(Rolled::Get(it, place))));
        match place.of {
            Some(_) => Self(with(get).expect("a recorded loop reads tables")),
            None => table[place.known()],
        }
    }
    fn passed(table: &[Self], place: Place) -> Self {
        Self::get(table, place)
    }
    fn passed_at(table: &[Self], index: Self, last: Self) -> Self {
        let found = with(|recorder| {
            let table = recorder.readable(table[0].0)?;
            Some(Self(recorder.push(Operation::Rolled(Rolled::GetAt(table, index.0)))))
        });
        found.unwrap_or_else(|| chosen_at(table, index, last))
    }
    fn left_to_f64<const N: usize>(compute: impl FnOnce() -> [Self; N]) -> [Self; N] {
        let unknown = with(|recorder| recorder.rolls.then(|| recorder.push(Operation::Rolled(Rolled::Unknown))));
        unknown.map_or_else(compute, |unknown| [Self(unknown); N])
    }
    fn is_zero(self) -> bool {
        self.known() == Some(0.0)
    }
    fn monotone_root<const P: usize>(
        bracket: (Self, Self),
        start: Self,
        smoothness: Smoothness,
        parameters: [Self; P],
        function: impl Fn([Self; P], Self) -> (Self, Self),
    ) -> Self {
        let number = with(|recorder| recorder.roots.len());
        let index = u8::try_from(number).expect("a formula has few roots");
        let argument = Self(with(|recorder| recorder.push(Operation::Argument(index))));
        // Taken at once, so that a root within this function gets a number of its own.
        let unknown = Root { bracket: (0, 0), start: 0, argument: argument.0, value: 0, slope: 0, smoothness, function: None };
        with(|recorder| recorder.roots.push(unknown));
        let (value, slope) = function(parameters, argument);
        if let (Some(low), Some(high), Some(first)) = (bracket.0.known(), bracket.1.known(), start.known()) {
            let root = with(|recorder| recorder.constant_root(argument.0, value.0, slope.0, (low, high), first, smoothness));
            if let Some(root) = root {
                return Self::constant(root);
            }
        }
        let bracket = (bracket.0.0, bracket.1.0);
        let root = Root { bracket, start: start.0, argument: argument.0, value: value.0, slope: slope.0, smoothness, function: None };
        with(|recorder| {
            recorder.roots[number] = root;
            Self(recorder.push(Operation::Root(index)))
        })
    }
    fn root_of<F: RootFunction>(bracket: (Self, Self), start: Self, parameters: [Self; ROOT_PARAMETERS]) -> Self {
        let root = Self::monotone_root(bracket, start, Smoothness::Smooth, parameters, F::at);
        let parameters = parameters.map(|it| it.known().map_or(RootParameter::Node(it.0), RootParameter::Number));
        let function = F::in_columns().map(|step| KnownFunction { step, parameters });
        with(|recorder| {
            if let Operation::Root(number) = recorder.operations[root.0 as usize] {
                recorder.roots[usize::from(number)].function = function;
            }
        });
        root
    }
}

/// A loop recorded once: its body sees the place and the state as numbers that nobody else has.
fn rolled<const S: usize>(over: Loop<Trace>, state: [Trace; S], mut body: impl FnMut(Place, [Trace; S]) -> [Trace; S]) -> [Trace; S] {
    let (number, begin) = with(|recorder| {
        let number = u8::try_from(recorder.loops.len()).expect("a formula has few loops");
        let begin = state.map(|it| (it.0, it.0)).to_vec();
        let until_zero = over.until_zero.map(|at| at as u8);
        let Loop { first, end, most, backwards, names, .. } = over;
        recorder.loops.push(RolledLoop { first, end: end.0, most, backwards, until_zero, state: begin, names, stores: Vec::new() });
        let begin: [Trace; S] = std::array::from_fn(|at| Trace(recorder.push(Operation::Rolled(Rolled::State(number, at as u8)))));
        (number, begin)
    });
    let next = body(Place { number: 0, of: Some(number) }, begin);
    with(|recorder| {
        let recorded = &mut recorder.loops[usize::from(number)];
        recorded.state.iter_mut().zip(next).for_each(|(of, next)| of.1 = next.0);
        let mut written: Vec<u8> = recorded.stores.iter().map(|store| store.table).collect();
        written.sort_unstable();
        written.dedup();
        for table in written {
            let before = recorder.tables[usize::from(table)].version;
            recorder.tables[usize::from(table)].version = recorder.push(Operation::Rolled(Rolled::Written(number, table, before)));
        }
        std::array::from_fn(|at| Trace(recorder.push(Operation::Rolled(Rolled::Folded(number, at as u8)))))
    })
}

impl Recording {
    /// The root of a function of its argument alone.
    fn constant_root(
        &self,
        argument: Node,
        value: Node,
        slope: Node,
        bracket: (f64, f64),
        start: f64,
        smoothness: Smoothness,
    ) -> Option<f64> {
        let mut needed = vec![false; self.operations.len()];
        needed[value as usize] = true;
        needed[slope as usize] = true;
        for node in (0..self.operations.len()).rev().filter(|&node| node as Node != argument) {
            if needed[node] {
                match self.operations[node] {
                    Operation::Input(_) | Operation::Root(_) | Operation::Argument(_) | Operation::Rolled(_) => return None,
                    operation => operation.operands(|operand| needed[operand as usize] = true),
                }
            }
        }
        let mut slots = vec![0.0; self.operations.len()];
        Some(bracketed_newton(bracket, start, f64::EPSILON, smoothness, |x| {
            for node in (0..slots.len()).filter(|&node| needed[node]) {
                slots[node] = match self.operations[node] {
                    Operation::Constant(bits) => f64::from_bits(bits),
                    Operation::Unary(operation, a) => operation.of(slots[a as usize]),
                    Operation::Binary(operation, a, b) => operation.of(slots[a as usize], slots[b as usize]),
                    Operation::Select(margin, a, b) => f64::select(slots[margin as usize], slots[a as usize], slots[b as usize]),
                    Operation::Input(_) | Operation::Argument(_) | Operation::Root(_) | Operation::Rolled(_) => x,
                };
            }
            (slots[value as usize], slots[slope as usize])
        }))
    }
}
