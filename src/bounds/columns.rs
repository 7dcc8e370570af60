//! The recorded formula in f64 over many designs at once, operation by operation: the same bits as the formula itself.
//!
//! What depends on one axis alone (a geometry solved, a sine) is computed once per level and kept; what the designs of a box have in
//! common is one number; the rest are columns, a chunk of designs at a time.

use super::axes::{AXES, Axes, Spans};
use super::tape::Tape;
use crate::real::Real;
use crate::tape::{Binary, Node, Operation, Unary};
use multiversion::multiversion;

/// Most designs in a chunk: a column fits the first-level cache.
pub const CHUNK: usize = 1024;

/// A number of the formula over a chunk of designs.
#[derive(Clone, Copy, Debug)]
pub enum Value<'a> {
    /// The same for all.
    One(f64),
    /// One per design.
    Each(&'a [f64]),
}

impl Value<'_> {
    /// The number of one design.
    #[inline(always)]
    pub fn at(self, lane: usize) -> f64 {
        match self {
            Self::One(value) => value,
            Self::Each(values) => values[lane],
        }
    }
}

/// Evaluates a tape over designs; one per thread.
#[derive(Debug)]
pub struct NodeColumns<'t> {
    tape: &'t Tape,
    axes: &'t Axes,
    /// Per axis: the operations that depend on it alone, operands first.
    alone: Vec<Vec<Node>>,
    /// Per axis: those that others need or the study asks for.
    kept: Vec<Vec<Node>>,
    /// Of every operation that is kept: its place there.
    place: Vec<u32>,
    /// Per axis and kept operation: values by level.
    tables: Vec<Vec<Vec<f64>>>,
    /// Per axis: which levels are in the tables.
    known: Vec<Vec<bool>>,
    /// Numbers that are the same for all designs of the box; also room for one design.
    slots: Vec<f64>,
    columns: Vec<Vec<f64>>,
    /// The box being evaluated: its varying axes, outermost first, as a list and as a bit set.
    varying: Vec<usize>,
    varying_set: u64,
    spans: Spans,
    count: usize,
}

impl<'t> NodeColumns<'t> {
    /// An evaluator of a tape.
    pub fn new(tape: &'t Tape, axes: &'t Axes) -> Self {
        let count = tape.list.operations.len();
        let (alone, kept) = (tape.alone(axes.all.len()), tape.kept(axes.all.len()));
        let mut place = vec![0; count];
        for nodes in &kept {
            nodes.iter().enumerate().for_each(|(at, &node)| place[node as usize] = at as u32);
        }
        let mut slots = vec![0.0; count];
        for node in (0..count).filter(|&node| tape.axes[node] == 0 && !tape.list.inner[node]) {
            tape.list.compute(node as Node, &mut slots);
        }
        Self {
            tape,
            axes,
            tables: kept.iter().map(|nodes| vec![Vec::new(); nodes.len()]).collect(),
            known: vec![Vec::new(); axes.all.len()],
            alone,
            kept,
            place,
            slots,
            columns: vec![Vec::new(); count],
            varying: Vec::new(),
            varying_set: 0,
            spans: axes.whole(),
            count: 0,
        }
    }

    /// Turns to a box: `varying` axes (outermost first) run over their spans, every other one that `needed` reads is at one level.
    /// `needed` are operations in their order, with all that they need.
    pub fn enter(&mut self, needed: &[Node], spans: &Spans, varying: &[usize]) {
        self.varying.clear();
        self.varying.extend_from_slice(varying);
        self.varying_set = varying.iter().fold(0, |set, &axis| set | 1 << axis);
        self.spans = *spans;
        let used = needed.iter().fold(0, |set, &node| set | self.tape.axes[node as usize]);
        for axis in 0..self.axes.all.len() {
            if used >> axis & 1 == 1 {
                self.tabulate(axis);
                if self.varying_set >> axis & 1 == 0 {
                    let level = spans[axis].low as usize;
                    for (at, &node) in self.kept[axis].iter().enumerate() {
                        self.slots[node as usize] = self.tables[axis][at][level];
                    }
                }
            }
        }
        for &node in needed {
            let depends = self.tape.axes[node as usize];
            if depends & self.varying_set == 0 && depends.count_ones() > 1 {
                self.tape.list.compute(node, &mut self.slots);
            }
        }
    }

    /// Makes sure that the levels of the current span of an axis are tabulated.
    fn tabulate(&mut self, axis: usize) {
        let levels = self.axes.all[axis].count() as usize;
        if self.known[axis].is_empty() {
            self.known[axis] = vec![false; levels];
            self.tables[axis].iter_mut().for_each(|column| *column = vec![0.0; levels]);
        }
        let span = self.spans[axis];
        for level in span.low as usize..=span.high as usize {
            if std::mem::replace(&mut self.known[axis][level], true) {
                continue;
            }
            for &node in &self.alone[axis] {
                if let Operation::Input(input) = self.tape.list.operations[node as usize] {
                    let column = self.tape.input_axes[input as usize].map_or(0, |(_, column)| column);
                    self.slots[node as usize] = self.axes.all[axis].si[column as usize][level];
                } else {
                    self.tape.list.compute(node, &mut self.slots);
                }
            }
            for (at, &node) in self.kept[axis].iter().enumerate() {
                self.tables[axis][at][level] = self.slots[node as usize];
            }
        }
    }

    /// Computes designs `first..first + count` of the box, at most [`CHUNK`] of them.
    pub fn chunk(&mut self, needed: &[Node], first: u64, count: usize) {
        self.count = count;
        for &node in needed {
            let depends = self.tape.axes[node as usize];
            if depends & self.varying_set == 0 {
                continue;
            }
            let mut column = std::mem::take(&mut self.columns[node as usize]);
            column.resize(CHUNK, 0.0);
            if depends.is_power_of_two() {
                // Those that only others of the same axis read are in no table.
                let axis = depends.trailing_zeros() as usize;
                if self.kept[axis].get(self.place[node as usize] as usize) == Some(&node) {
                    self.gather(axis, node, first, &mut column[..count]);
                }
            } else {
                self.compute(node, &mut column[..count]);
            }
            self.columns[node as usize] = column;
        }
    }

    /// Spreads the values by level over the designs of a chunk.
    fn gather(&self, axis: usize, node: Node, first: u64, column: &mut [f64]) {
        let table = &self.tables[axis][self.place[node as usize] as usize];
        let at = self.varying.iter().position(|&it| it == axis).expect("the axis varies");
        let inner: u64 = self.varying[at + 1..].iter().map(|&axis| self.spans[axis].count()).product();
        let span = self.spans[axis];
        let (low, levels) = (span.low as usize, span.count());
        let (mut level, mut within) = ((first / inner % levels) as usize, first % inner);
        if inner == 1 {
            let mut rest = column;
            while !rest.is_empty() {
                let run = rest.len().min(levels as usize - level);
                let (now, later) = rest.split_at_mut(run);
                now.copy_from_slice(&table[low + level..low + level + run]);
                (rest, level) = (later, 0);
            }
            return;
        }
        let mut rest = column;
        while !rest.is_empty() {
            let run = rest.len().min(usize::try_from(inner - within).unwrap_or(usize::MAX));
            let (now, later) = rest.split_at_mut(run);
            now.fill(table[low + level]);
            rest = later;
            within = 0;
            level = if level as u64 + 1 == levels { 0 } else { level + 1 };
        }
    }

    fn compute(&mut self, node: Node, column: &mut [f64]) {
        let count = column.len();
        match self.tape.list.operations[node as usize] {
            Operation::Unary(operation, a) => unary(operation, self.of(a, count), column),
            Operation::Binary(operation, a, b) => binary(operation, self.of(a, count), self.of(b, count), column),
            Operation::Select(margin, a, b) => {
                let (margin, a, b) = (self.of(margin, count), self.of(a, count), self.of(b, count));
                for (lane, it) in column.iter_mut().enumerate() {
                    *it = f64::select(margin.at(lane), a.at(lane), b.at(lane));
                }
            }
            Operation::Root(number) => {
                let mut reads = Vec::new();
                self.tape.list.outside(number, |node| reads.push(node));
                for (lane, it) in column.iter_mut().enumerate() {
                    for &read in &reads {
                        self.slots[read as usize] = self.value(read).at(lane);
                    }
                    self.tape.list.compute(node, &mut self.slots);
                    *it = self.slots[node as usize];
                }
            }
            Operation::Input(_) | Operation::Constant(_) | Operation::Argument(_) | Operation::Rolled(_) => {}
        }
    }

    fn of(&self, node: Node, count: usize) -> Value<'_> {
        match self.value(node) {
            Value::Each(values) => Value::Each(&values[..count]),
            one => one,
        }
    }

    /// A number of the last chunk.
    pub fn value(&self, node: Node) -> Value<'_> {
        if self.tape.axes[node as usize] & self.varying_set == 0 {
            Value::One(self.slots[node as usize])
        } else {
            Value::Each(&self.columns[node as usize][..self.count])
        }
    }

    /// The level of one design of the box along every axis.
    pub fn levels(&self, design: u64) -> [u32; AXES] {
        let mut levels = self.spans.0.map(|span| span.low);
        let mut rest = design;
        for &axis in self.varying.iter().rev() {
            let count = self.spans[axis].count();
            levels[axis] += (rest % count) as u32;
            rest /= count;
        }
        levels
    }
}

fn unary(operation: Unary, a: Value<'_>, column: &mut [f64]) {
    let Value::Each(a) = a else { return column.fill(operation.of(a.at(0))) };
    match operation {
        Unary::Neg => negated(a, column),
        Unary::Sqrt => roots(a, column),
        _ => column.iter_mut().zip(a).for_each(|(it, &a)| *it = operation.of(a)),
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn negated(a: &[f64], column: &mut [f64]) {
    column.iter_mut().zip(a).for_each(|(it, &a)| *it = -a);
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn roots(a: &[f64], column: &mut [f64]) {
    column.iter_mut().zip(a).for_each(|(it, &a)| *it = a.sqrt());
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn binary(operation: Binary, a: Value<'_>, b: Value<'_>, column: &mut [f64]) {
    // Written out, so that every combination becomes one loop of vector instructions.
    macro_rules! each {
        ($($kind:ident),*) => {
            match (operation, a, b) {
                $(
                    (Binary::$kind, Value::Each(a), Value::Each(b)) => {
                        column.iter_mut().zip(a).zip(b).for_each(|((it, &a), &b)| *it = Binary::$kind.of(a, b));
                    }
                    (Binary::$kind, Value::Each(a), Value::One(b)) => column.iter_mut().zip(a).for_each(|(it, &a)| *it = Binary::$kind.of(a, b)),
                    (Binary::$kind, Value::One(a), Value::Each(b)) => column.iter_mut().zip(b).for_each(|(it, &b)| *it = Binary::$kind.of(a, b)),
                )*
                (_, Value::One(a), Value::One(b)) => column.fill(operation.of(a, b)),
            }
        };
    }
    each!(Add, Sub, Mul, Div, Min, Max, PlusWhole);
}
