//! The recorded formula in f64 over many designs at once, operation by operation: the same bits as the formula itself.
//!
//! What depends on one axis alone (a geometry solved, a sine) is computed once per level and kept; what the designs of a box have in
//! common is one number; the rest are columns, a chunk of designs at a time.

use super::axes::{AXES, Axes, Spans};
use super::study_tape::StudyTape;
use crate::tape::{ColumnValue, Node, NodeColumns, Operation};

/// Evaluates a tape over designs; one per thread.
#[derive(Debug)]
pub struct BoxColumns<'t> {
    tape: &'t StudyTape,
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
    numbers: NodeColumns,
    /// The box being evaluated: its varying axes, outermost first, as a list and as a bit set.
    varying: Vec<usize>,
    varying_set: u64,
    spans: Spans,
}

impl<'t> BoxColumns<'t> {
    /// An evaluator of a tape.
    pub fn new(tape: &'t StudyTape, axes: &'t Axes) -> Self {
        let count = tape.list.operations.len();
        let (alone, kept) = (tape.alone(axes.all.len()), tape.kept(axes.all.len()));
        let mut place = vec![0; count];
        for nodes in &kept {
            nodes.iter().enumerate().for_each(|(at, &node)| place[node as usize] = at as u32);
        }
        let mut numbers = NodeColumns::new(&tape.list);
        for node in (0..count).filter(|&node| tape.axes[node] == 0 && !tape.list.inner[node]) {
            tape.list.compute(node as Node, &mut numbers.slots);
        }
        Self {
            tape,
            axes,
            tables: kept.iter().map(|nodes| vec![Vec::new(); nodes.len()]).collect(),
            known: vec![Vec::new(); axes.all.len()],
            alone,
            kept,
            place,
            numbers,
            varying: Vec::new(),
            varying_set: 0,
            spans: axes.whole(),
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
                        self.numbers.slots[node as usize] = self.tables[axis][at][level];
                    }
                }
            }
        }
        for &node in needed {
            let depends = self.tape.axes[node as usize];
            if depends & self.varying_set == 0 && depends.count_ones() > 1 {
                self.tape.list.compute(node, &mut self.numbers.slots);
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
                    self.numbers.slots[node as usize] = self.axes.all[axis].si[column as usize][level];
                } else {
                    self.tape.list.compute(node, &mut self.numbers.slots);
                }
            }
            for (at, &node) in self.kept[axis].iter().enumerate() {
                self.tables[axis][at][level] = self.numbers.slots[node as usize];
            }
        }
    }

    /// Computes designs `first..first + count` of the box, at most [`CHUNK`](crate::tape::CHUNK) of them.
    pub fn chunk(&mut self, needed: &[Node], first: u64, count: usize) {
        let mut numbers = std::mem::take(&mut self.numbers);
        numbers.begin(count);
        for &node in needed {
            let depends = self.tape.axes[node as usize];
            if depends & self.varying_set == 0 {
                continue;
            }
            if depends.is_power_of_two() {
                // Those that only others of the same axis read are in no table.
                let axis = depends.trailing_zeros() as usize;
                if self.kept[axis].get(self.place[node as usize] as usize) == Some(&node) {
                    numbers.fill(node, |column| self.gather(axis, node, first, column));
                }
            } else {
                numbers.compute(&self.tape.list, node, |node| self.varies(node));
            }
        }
        self.numbers = numbers;
    }

    /// Has an operation a number per design of the box?
    fn varies(&self, node: Node) -> bool {
        self.tape.axes[node as usize] & self.varying_set != 0
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

    /// A number of the last chunk.
    pub fn value(&self, node: Node) -> ColumnValue<'_> {
        self.numbers.value(node, |node| self.varies(node))
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
