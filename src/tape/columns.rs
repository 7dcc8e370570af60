//! A list in f64 over many designs at once, operation by operation: the same bits as the formula itself.

use super::root_columns::{RootColumns, serves};
use super::{Binary, List, Node, Operation, Unary};
use crate::real::{Real, wide};
use multiversion::multiversion;

/// Most designs in a chunk: a column fits the first-level cache.
pub const CHUNK: usize = 1024;

/// A number of the formula over a chunk of designs.
#[derive(Clone, Copy, Debug)]
pub enum ColumnValue<'a> {
    /// The same for all.
    One(f64),
    /// One per design.
    Each(&'a [f64]),
}

impl ColumnValue<'_> {
    /// The number of one design.
    #[inline(always)]
    pub fn at(self, lane: usize) -> f64 {
        match self {
            Self::One(value) => value,
            Self::Each(values) => values[lane],
        }
    }
}

/// What the operations of a list are over a chunk of designs; one per thread.
///
/// Which operations have a number per design and which one that all share is the caller's business: `each` answers it.
#[derive(Debug, Default)]
pub struct NodeColumns {
    /// Of every operation: the number that all designs share; also room for one design.
    pub slots: Vec<f64>,
    columns: Vec<Vec<f64>>,
    /// Of every operation: which column is its own while somebody reads it.
    place: Vec<Node>,
    count: usize,
    /// Where roots are found; none while they are, as none stands within another.
    roots: Option<Box<RootColumns>>,
}

impl NodeColumns {
    /// Room for a list.
    pub fn new(list: &List) -> Self {
        let roots = (!list.roots.is_empty()).then(|| Box::new(RootColumns::new(list)));
        Self { roots, ..Self::plain(list) }
    }

    /// The same where no root is found.
    pub(super) fn plain(list: &List) -> Self {
        let operations = list.operations.len();
        let place = (0..operations as Node).collect();
        Self { slots: vec![0.0; operations], columns: vec![Vec::new(); operations], place, count: 0, roots: None }
    }

    /// Lets these operations, operands first, share columns: one is free again after it was last read, so that all of them stay in the
    /// caches. Those that are `kept` are read at the end. Only they may be computed, and in this order.
    pub(super) fn share(&mut self, list: &List, order: &[Node], kept: &[Node]) {
        let mut last_read = vec![0; list.operations.len()];
        let mut is_column = vec![false; list.operations.len()];
        order.iter().for_each(|&node| is_column[node as usize] = true);
        for (step, &node) in order.iter().enumerate() {
            list.reads(node, |operand| last_read[operand as usize] = step);
        }
        kept.iter().for_each(|&node| last_read[node as usize] = usize::MAX);
        let mut free: Vec<Node> = Vec::new();
        let mut ended: Vec<Node> = Vec::new();
        let mut columns = 0;
        for (step, &node) in order.iter().enumerate() {
            // Before the operands are free: no operation writes what it reads.
            self.place[node as usize] = free.pop().unwrap_or_else(|| {
                columns += 1;
                columns - 1
            });
            ended.clear();
            list.reads(node, |operand| ended.push(operand));
            ended.retain(|&operand| last_read[operand as usize] == step && is_column[operand as usize]);
            ended.sort_unstable();
            ended.dedup();
            free.extend(ended.iter().map(|&operand| self.place[operand as usize]));
        }
    }

    /// Begins a chunk of that many designs, at most [`CHUNK`].
    pub fn begin(&mut self, count: usize) {
        self.count = count;
    }

    /// A number of the chunk.
    #[inline]
    pub fn value(&self, node: Node, each: impl Fn(Node) -> bool) -> ColumnValue<'_> {
        if each(node) {
            ColumnValue::Each(&self.columns[self.place[node as usize] as usize][..self.count])
        } else {
            ColumnValue::One(self.slots[node as usize])
        }
    }

    /// Fills the column of an operation by what the caller knows of it, such as the values of an input.
    pub fn fill(&mut self, node: Node, fill: impl FnOnce(&mut [f64])) {
        let column = &mut self.columns[self.place[node as usize] as usize];
        fill(room(column, self.count));
    }

    /// Exchanges the column of an operation for these numbers, one per design.
    pub(super) fn swap(&mut self, node: Node, numbers: &mut Vec<f64>) {
        assert_eq!(numbers.len(), self.count, "one number per design");
        std::mem::swap(&mut self.columns[self.place[node as usize] as usize], numbers);
    }

    /// Computes the column of an operation from its operands; what inputs are is the caller's business.
    pub fn compute(&mut self, list: &List, node: Node, each: impl Fn(Node) -> bool) {
        let place = self.place[node as usize] as usize;
        let mut column = std::mem::take(&mut self.columns[place]);
        let room = room(&mut column, self.count);
        let of = |node| self.value(node, &each);
        match list.operations[node as usize] {
            Operation::Unary(operation, a) => unary(operation, of(a), room),
            Operation::Binary(operation, a, b) => binary(operation, of(a), of(b), room),
            Operation::Select(margin, a, b) => {
                select(of(margin), of(a), of(b), room);
            }
            Operation::Root(number) if self.roots.is_some() && serves(list, number) => {
                let mut roots = self.roots.take();
                if let Some(roots) = &mut roots {
                    roots.find(list, number, &|node| self.value(node, &each), room);
                }
                self.roots = roots;
            }
            Operation::Root(number) => {
                let mut reads = Vec::new();
                list.outside(number, |node| reads.push(node));
                for (lane, it) in room.iter_mut().enumerate() {
                    for &read in &reads {
                        self.slots[read as usize] = self.value(read, &each).at(lane);
                    }
                    list.compute(node, &mut self.slots);
                    *it = self.slots[node as usize];
                }
            }
            Operation::Input(_) | Operation::Constant(_) | Operation::Argument(_) | Operation::Rolled(_) => {}
        }
        self.columns[place] = column;
    }
}

/// The first of a column, which grows to the longest chunk and no further: longer strides would put all columns at the same places of the
/// first-level cache.
#[inline]
fn room(column: &mut Vec<f64>, count: usize) -> &mut [f64] {
    if column.len() < count {
        column.resize(count, 0.0);
    }
    &mut column[..count]
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn select(margin: ColumnValue<'_>, a: ColumnValue<'_>, b: ColumnValue<'_>, column: &mut [f64]) {
    let margin = match margin {
        ColumnValue::Each(margin) => margin,
        ColumnValue::One(margin) => {
            return match if margin >= 0.0 { a } else { b } {
                ColumnValue::One(value) => column.fill(value),
                ColumnValue::Each(values) => column.copy_from_slice(values),
            };
        }
    };
    // Written out, so that each becomes a loop of vector instructions.
    let lanes = column.iter_mut().zip(margin);
    match (a, b) {
        (ColumnValue::Each(a), ColumnValue::Each(b)) => {
            lanes.zip(a).zip(b).for_each(|(((it, &margin), &a), &b)| *it = f64::select(margin, a, b));
        }
        (ColumnValue::Each(a), ColumnValue::One(b)) => lanes.zip(a).for_each(|((it, &margin), &a)| *it = f64::select(margin, a, b)),
        (ColumnValue::One(a), ColumnValue::Each(b)) => lanes.zip(b).for_each(|((it, &margin), &b)| *it = f64::select(margin, a, b)),
        (ColumnValue::One(a), ColumnValue::One(b)) => lanes.for_each(|(it, &margin)| *it = f64::select(margin, a, b)),
    }
}

fn unary(operation: Unary, a: ColumnValue<'_>, column: &mut [f64]) {
    let ColumnValue::Each(a) = a else { return column.fill(operation.of(a.at(0))) };
    match operation {
        Unary::Neg => negated(a, column),
        Unary::Abs => magnitudes(a, column),
        Unary::Scale(power) => scaled(a, power, column),
        Unary::Sqrt => roots(a, column),
        Unary::ExpM1 => wide::exp_m1(a, column),
        Unary::Ln1p => wide::ln_1p(a, column),
        Unary::Sin => wide::sin(a, column),
        Unary::Cos => wide::cos(a, column),
        Unary::Asin => wide::asin(a, column),
        _ => column.iter_mut().zip(a).for_each(|(it, &a)| *it = operation.of(a)),
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn negated(a: &[f64], column: &mut [f64]) {
    column.iter_mut().zip(a).for_each(|(it, &a)| *it = -a);
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn magnitudes(a: &[f64], column: &mut [f64]) {
    column.iter_mut().zip(a).for_each(|(it, &a)| *it = a.abs());
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn scaled(a: &[f64], power: i16, column: &mut [f64]) {
    column.iter_mut().zip(a).for_each(|(it, &a)| *it = Real::scaled(a, power));
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn roots(a: &[f64], column: &mut [f64]) {
    column.iter_mut().zip(a).for_each(|(it, &a)| *it = a.sqrt());
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn binary(operation: Binary, a: ColumnValue<'_>, b: ColumnValue<'_>, column: &mut [f64]) {
    // Written out, so that every combination becomes one loop of vector instructions.
    macro_rules! each {
        ($($kind:ident),*) => {
            match (operation, a, b) {
                $(
                    (Binary::$kind, ColumnValue::Each(a), ColumnValue::Each(b)) => {
                        column.iter_mut().zip(a).zip(b).for_each(|((it, &a), &b)| *it = Binary::$kind.of(a, b));
                    }
                    (Binary::$kind, ColumnValue::Each(a), ColumnValue::One(b)) => column.iter_mut().zip(a).for_each(|(it, &a)| *it = Binary::$kind.of(a, b)),
                    (Binary::$kind, ColumnValue::One(a), ColumnValue::Each(b)) => column.iter_mut().zip(b).for_each(|(it, &b)| *it = Binary::$kind.of(a, b)),
                )*
                (_, ColumnValue::One(a), ColumnValue::One(b)) => column.fill(operation.of(a, b)),
            }
        };
    }
    each!(Add, Sub, Mul, Div, Min, Max, PlusWhole);
}
