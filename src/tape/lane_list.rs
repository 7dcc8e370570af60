//! The inner loop as a list of operations, each over the column of a block.
//!
//! Of the operations of the second stage some read inputs of the fast axes only: their columns are the same for all rows and are made once
//! for each block. Some read none of these: they are one number for the whole row. What is left is computed for every design, operation by
//! operation, and is often a small part. The bits are those of the formula.

use super::{Binary, EVERYTHING, Interval, Known, List, Node, Operation, Unary};
use crate::real::{LANES, Real};
use multiversion::multiversion;
use std::mem::take;

/// Most operations for every design: a longer list would not gain by what it shares.
const MOST_STEPS: usize = 512;

/// A number that an operation reads.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Operand {
    /// The same for the row: an operation of the list, or a factor of a unit after them.
    Row(usize),
    /// The same for all rows: a column of the block.
    Shared(usize),
    /// A column of the thread.
    Own(usize),
    /// An input that differs between rows and between designs of a row: a column that comes with the row.
    Given(usize),
}

/// An operation over a column.
#[derive(Clone, Copy, Debug)]
enum StepKind {
    Unary(Unary, Operand),
    Binary(Binary, Operand, Operand),
    Select(Operand, Operand, Operand),
}

/// An operation and the column that it writes.
#[derive(Clone, Copy, Debug)]
struct ColumnStep {
    kind: StepKind,
    to: usize,
}

/// What designs are asked for, laid out for rows and blocks.
#[derive(Debug)]
pub struct LaneList {
    list: List,
    /// The list's inputs below this are the model's; the others are what the first stage passes on.
    inputs: usize,
    /// Inputs of the list that are the same for a row: of the list, and where they stand.
    row_inputs: Vec<(Node, usize)>,
    /// Operations that are the same for a row, operands first.
    row: Vec<Node>,
    /// Constants, and then factors of units.
    constants: Vec<(usize, f64)>,
    slots: usize,
    /// Operations that are the same for all rows, operands first, and those of them that have a column in every block.
    shared: Vec<Node>,
    kept: Vec<Node>,
    /// Operations that these read and that are the same for all rows and designs, operands first.
    common: Vec<Node>,
    steps: Vec<ColumnStep>,
    columns: usize,
    results: Vec<Operand>,
    /// Operations for every design and row, operands first, and what each result is before it is turned into its unit.
    each: Vec<Node>,
    asked: Vec<Node>,
    /// What the operations for every design read of the row, without constants.
    scalars: Vec<Node>,
    /// Inputs that come as a column with each row.
    given: Vec<u16>,
    /// Of every operation that no row has to do with: all its values.
    ranges: Vec<Interval>,
}

/// What an operation differs over.
#[derive(Clone, Copy, Default, PartialEq)]
pub struct Varies {
    /// The designs of a row.
    pub over_lanes: bool,
    /// Rows, for one and the same place in them.
    pub over_rows: bool,
}

impl std::ops::BitOrAssign for Varies {
    fn bitor_assign(&mut self, other: Self) {
        self.over_lanes |= other.over_lanes;
        self.over_rows |= other.over_rows;
    }
}

/// Numbers of one thread.
#[derive(Debug)]
pub struct LaneNumbers {
    row: Vec<f64>,
    columns: Vec<Vec<f64>>,
}

impl LaneNumbers {
    /// What the operations for every design read of the row that was entered last.
    pub fn scalars<'n>(&'n self, list: &'n LaneList) -> impl Iterator<Item = f64> + 'n {
        list.scalars.iter().map(|&node| self.row[node as usize])
    }

    /// All numbers of the row that was entered last, by operation.
    pub fn row(&self) -> &[f64] {
        &self.row
    }

    /// Enters a row by the numbers of these operations.
    pub fn enter(&mut self, list: &LaneList, number: impl Fn(Node) -> f64) {
        list.scalars.iter().for_each(|&node| self.row[node as usize] = number(node));
    }

    /// Enters a row by these.
    pub fn set_scalars(&mut self, list: &LaneList, scalars: &[f64]) {
        list.scalars.iter().zip(scalars).for_each(|(&node, &scalar)| self.row[node as usize] = scalar);
    }
}

impl LaneList {
    /// Of these operations of a list, given what its inputs differ over. Its inputs below `inputs` are the model's; the others are what the
    /// first stage passes on. The first of what is asked for are turned into units with these factors to multiply by and to divide by.
    ///
    /// `None` where there is nothing to compute for every design, or the formula's own loop is as good: where there are roots or loops for
    /// every design.
    pub fn new(list: List, inputs: usize, asked: Vec<Node>, units: &[(f64, f64)], of_input: impl Fn(u16) -> Varies) -> Option<Self> {
        let varies = list.dependencies(of_input);
        let needed = list.needed_by(&asked);
        let is_each = |node: Node| varies[node as usize] == Varies { over_lanes: true, over_rows: true };
        let is_shared = |node: Node| varies[node as usize] == Varies { over_lanes: true, over_rows: false };
        let is_plain = |&node: &Node| {
            use Operation::{Binary, Constant, Input, Select, Unary};
            matches!(list.operations[node as usize], Unary(..) | Binary(..) | Select(..) | Input(_) | Constant(_))
        };
        let each: Vec<Node> = needed.iter().copied().filter(|&node| is_each(node)).collect();
        let shared: Vec<Node> = needed.iter().copied().filter(|&node| is_shared(node)).collect();
        let common = list.needed_by(&shared).into_iter().filter(|&node| varies[node as usize] == Varies::default()).collect();
        if asked.is_empty() || each.len() > MOST_STEPS || !each.iter().chain(&shared).all(is_plain) {
            return None;
        }
        let mut laid = Self {
            inputs,
            row_inputs: Vec::new(),
            row: Vec::new(),
            constants: Vec::new(),
            slots: list.operations.len(),
            shared,
            kept: Vec::new(),
            common,
            steps: Vec::new(),
            columns: 0,
            results: Vec::new(),
            scalars: Vec::new(),
            given: Vec::new(),
            ranges: Vec::new(),
            each,
            asked,
            list,
        };
        for &node in needed.iter().filter(|&&node| !varies[node as usize].over_lanes) {
            match laid.list.operations[node as usize] {
                Operation::Input(input) => laid.row_inputs.push((node, input.into())),
                Operation::Constant(bits) => laid.constants.push((node as usize, f64::from_bits(bits))),
                _ => laid.row.push(node),
            }
        }
        laid.lay_out(&varies);
        laid.add_units(units);
        Some(laid)
    }

    /// The same with [`LaneList::ranges`], from what is known of the model's inputs.
    pub fn knowing(self, known: &[Known]) -> Self {
        Self { ranges: self.ranges_of_shared(known), ..self }
    }

    /// All values of what is the same for all rows.
    fn ranges_of_shared(&self, known: &[Known]) -> Vec<Interval> {
        let mut slots = vec![EVERYTHING; self.list.operations.len()];
        for (slot, &operation) in slots.iter_mut().zip(&self.list.operations) {
            match operation {
                Operation::Constant(bits) => *slot = Interval::point(f64::from_bits(bits)),
                Operation::Input(input) if usize::from(input) < self.inputs => {
                    *slot = match known[usize::from(input)] {
                        Known::Fixed(value) => Interval::point(value),
                        Known::Within(least, largest) => Interval::new(least, largest),
                    };
                }
                _ => {}
            }
        }
        self.shared.iter().for_each(|&node| self.list.compute(node, &mut slots));
        slots
    }

    /// Gives every operation of `each` a column, which is free again after it was last read.
    fn lay_out(&mut self, varies: &[Varies]) {
        let (each, asked) = (self.each.clone(), self.asked.clone());
        let mut last_read = vec![usize::MAX; self.list.operations.len()];
        for (step, &node) in each.iter().enumerate() {
            self.list.operations[node as usize].operands(|operand| last_read[operand as usize] = step);
        }
        asked.iter().for_each(|&node| last_read[node as usize] = usize::MAX);
        let mut column_of = vec![0; self.list.operations.len()];
        let mut free: Vec<usize> = Vec::new();
        for (step, &node) in each.iter().enumerate() {
            let operation = self.list.operations[node as usize];
            if let Operation::Input(input) = operation {
                self.given.push(input);
                continue;
            }
            let mut operand = |node: Node| self.operand(node, varies, &column_of);
            let kind = match operation {
                Operation::Unary(kind, a) => StepKind::Unary(kind, operand(a)),
                Operation::Binary(kind, a, b) => StepKind::Binary(kind, operand(a), operand(b)),
                Operation::Select(margin, a, b) => StepKind::Select(operand(margin), operand(a), operand(b)),
                other => unreachable!("{other:?} does not differ both between rows and between designs of a row"),
            };
            // Before the operands are free: no operation writes what it reads.
            let to = free.pop().unwrap_or_else(|| {
                self.columns += 1;
                self.columns - 1
            });
            column_of[node as usize] = to;
            self.steps.push(ColumnStep { kind, to });
            let mut ended: Vec<usize> = Vec::new();
            operation.operands(|operand| {
                let varies = varies[operand as usize];
                let has_column =
                    varies.over_lanes && varies.over_rows && !matches!(self.list.operations[operand as usize], Operation::Input(_));
                if last_read[operand as usize] == step && has_column {
                    ended.push(column_of[operand as usize]);
                }
            });
            ended.sort_unstable();
            ended.dedup();
            free.extend(ended);
        }
        self.results = asked.iter().map(|&node| self.operand(node, varies, &column_of)).collect();
    }

    fn operand(&mut self, node: Node, varies: &[Varies], column_of: &[usize]) -> Operand {
        match varies[node as usize] {
            Varies { over_lanes: false, .. } => {
                let is_constant = matches!(self.list.operations[node as usize], Operation::Constant(_));
                if !is_constant && !self.scalars.contains(&node) {
                    self.scalars.push(node);
                }
                Operand::Row(node as usize)
            }
            Varies { over_rows: true, .. } => match self.list.operations[node as usize] {
                Operation::Input(input) => {
                    Operand::Given(self.given.iter().position(|&it| it == input).expect("operands come before what reads them"))
                }
                _ => Operand::Own(column_of[node as usize]),
            },
            Varies { .. } => Operand::Shared(self.kept.iter().position(|&it| it == node).unwrap_or_else(|| {
                self.kept.push(node);
                self.kept.len() - 1
            })),
        }
    }

    /// Outputs are turned into their units as [`crate::units::Unit::from_si`] does it.
    fn add_units(&mut self, units: &[(f64, f64)]) {
        for (result, &(multiply, divide)) in units.iter().enumerate() {
            for (kind, factor) in [(Binary::Mul, divide), (Binary::Div, multiply)] {
                if factor != 1.0 {
                    self.constants.push((self.slots, factor));
                    let kind = StepKind::Binary(kind, self.results[result], Operand::Row(self.slots));
                    self.steps.push(ColumnStep { kind, to: self.columns });
                    self.results[result] = Operand::Own(self.columns);
                    (self.slots, self.columns) = (self.slots + 1, self.columns + 1);
                }
            }
        }
    }

    /// Columns that every block has of it.
    pub fn kept(&self) -> usize {
        self.kept.len()
    }

    /// All operations.
    pub fn list(&self) -> &List {
        &self.list
    }

    /// Is an input of the list one of the model?
    pub fn is_input(&self, input: u16) -> bool {
        usize::from(input) < self.inputs
    }

    /// Which number of those that the first stage passes on an input of the list is.
    pub fn passed_on(&self, input: u16) -> Option<usize> {
        usize::from(input).checked_sub(self.inputs)
    }

    /// Those that are computed for every design, operands first.
    pub fn each(&self) -> &[Node] {
        &self.each
    }

    /// What is asked of the list, before it is turned into its unit: outputs, then margins.
    pub fn asked(&self) -> &[Node] {
        &self.asked
    }

    /// What the operations for every design read of the row.
    pub fn scalars(&self) -> &[Node] {
        &self.scalars
    }

    /// Of every operation that no row has to do with: all its values.
    pub fn ranges(&self) -> &[Interval] {
        &self.ranges
    }

    /// What a block of designs has in common with the same block of other rows, of its inputs in SI units, with idle lanes, and of those
    /// that no row and no design of it changes.
    pub fn shared_columns(&self, si: &[(usize, Vec<f64>)], common: &[f64]) -> Vec<Vec<f64>> {
        let count = si.first().map_or(0, |(_, column)| column.len());
        let column = |input: usize| &si.iter().find(|(it, _)| *it == input).expect("a lane input is set by a fast axis").1;
        let mut slots = vec![0.0; self.list.operations.len()];
        for &node in &self.common {
            match self.list.operations[node as usize] {
                Operation::Input(input) => slots[node as usize] = common[usize::from(input)],
                _ => self.list.compute(node, &mut slots),
            }
        }
        let mut columns: Vec<Vec<f64>> = self.kept.iter().map(|_| Vec::with_capacity(count)).collect();
        if columns.is_empty() {
            return columns;
        }
        for lane in 0..count {
            for &node in &self.shared {
                match self.list.operations[node as usize] {
                    Operation::Input(input) => slots[node as usize] = column(input.into())[lane],
                    _ => self.list.compute(node, &mut slots),
                }
            }
            for (column, &node) in columns.iter_mut().zip(&self.kept) {
                column.push(slots[node as usize]);
            }
        }
        columns
    }

    /// Room for a thread, for blocks of so many designs at most.
    pub fn numbers(&self, block: usize) -> LaneNumbers {
        let mut row = vec![0.0; self.slots];
        for &(slot, value) in &self.constants {
            row[slot] = value;
        }
        LaneNumbers { row, columns: vec![vec![0.0; block]; self.columns] }
    }

    /// Bytes of it, without what is allocated besides.
    pub fn bytes(&self, block: usize) -> u64 {
        8 * (self.slots + block * self.columns) as u64
    }

    /// Computes what the operations for every design read of a row, given its prepared numbers and inputs (SI).
    pub fn enter(&self, numbers: &mut LaneNumbers, prepared: &[f64], inputs: &[f64]) {
        for &(node, input) in &self.row_inputs {
            numbers.row[node as usize] = input.checked_sub(self.inputs).map_or_else(|| inputs[input], |passed| prepared[passed]);
        }
        for &node in &self.row {
            self.list.compute(node, &mut numbers.row);
        }
    }

    /// Inputs that come as a column with each row.
    pub fn given(&self) -> &[u16] {
        &self.given
    }

    /// Computes the block's results, the first in their units, for the row that was entered last.
    pub fn run(&self, numbers: &mut LaneNumbers, block: LaneBlock<'_>, results: &mut [Vec<f64>]) {
        let LaneBlock { shared, given, count } = block;
        let room = count.next_multiple_of(LANES);
        run_steps(&self.steps, &numbers.row, block, &mut numbers.columns);
        for (number, (result, &from)) in results.iter_mut().zip(&self.results).enumerate() {
            match from {
                Operand::Row(slot) => result[..room].fill(numbers.row[slot]),
                Operand::Shared(column) => result[..room].copy_from_slice(&shared[column][..room]),
                Operand::Given(column) => result[..room].copy_from_slice(&given[column][..room]),
                // The last result that asks for a column gets it without a copy.
                Operand::Own(column) if self.results[number + 1..].contains(&from) => {
                    result[..room].copy_from_slice(&numbers.columns[column][..room]);
                }
                Operand::Own(column) => std::mem::swap(result, &mut numbers.columns[column]),
            }
        }
    }
}

/// A block of designs in a row.
#[derive(Clone, Copy)]
pub struct LaneBlock<'a> {
    /// What it has in common with the same block of other rows: [`LaneList::shared_columns`].
    pub shared: &'a [Vec<f64>],
    /// The columns of [`LaneList::given`].
    pub given: &'a [&'a [f64]],
    /// Number of designs; there is room for a multiple of [`LANES`].
    pub count: usize,
}

/// A number for all designs, or one for each.
#[derive(Clone, Copy)]
enum RowOrLanes<'a> {
    One(f64),
    Each(&'a [f64]),
}

impl RowOrLanes<'_> {
    #[inline(always)]
    fn at(self, lane: usize) -> f64 {
        match self {
            Self::One(value) => value,
            Self::Each(values) => values[lane],
        }
    }
}

/// Only operations that round alike on every instruction set are vectorised, and nothing contracts a product and a sum.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn run_steps(steps: &[ColumnStep], row: &[f64], LaneBlock { shared, given, count }: LaneBlock<'_>, columns: &mut [Vec<f64>]) {
    let room = count.next_multiple_of(LANES);
    for step in steps {
        let mut column = take(&mut columns[step.to]);
        let to = &mut column[..room];
        let of = |operand| match operand {
            Operand::Row(slot) => RowOrLanes::One(row[slot]),
            Operand::Shared(column) => RowOrLanes::Each(&shared[column][..room]),
            Operand::Own(column) => RowOrLanes::Each(&columns[column][..room]),
            Operand::Given(column) => RowOrLanes::Each(&given[column][..room]),
        };
        // Written out, so that every combination becomes one loop of vector instructions.
        macro_rules! binary {
            ($kind:expr, $a:expr, $b:expr, $($name:ident),*) => {
                match ($kind, $a, $b) {
                    $(
                        (Binary::$name, RowOrLanes::Each(a), RowOrLanes::Each(b)) => {
                            to.iter_mut().zip(a).zip(b).for_each(|((it, &a), &b)| *it = Binary::$name.of(a, b));
                        }
                        (Binary::$name, RowOrLanes::Each(a), RowOrLanes::One(b)) => to.iter_mut().zip(a).for_each(|(it, &a)| *it = Binary::$name.of(a, b)),
                        (Binary::$name, RowOrLanes::One(a), RowOrLanes::Each(b)) => to.iter_mut().zip(b).for_each(|(it, &b)| *it = Binary::$name.of(a, b)),
                    )*
                    (kind, RowOrLanes::One(a), RowOrLanes::One(b)) => to.fill(kind.of(a, b)),
                }
            };
        }
        macro_rules! unary {
            ($kind:expr, $a:expr, $($name:ident),*) => {
                match ($kind, $a) {
                    (kind, RowOrLanes::One(a)) => to.fill(kind.of(a)),
                    $((Unary::$name, RowOrLanes::Each(a)) => to.iter_mut().zip(a).for_each(|(it, &a)| *it = Unary::$name.of(a)),)*
                    (kind, RowOrLanes::Each(a)) => to.iter_mut().zip(a).for_each(|(it, &a)| *it = kind.of(a)),
                }
            };
        }
        match step.kind {
            StepKind::Unary(kind, a) => unary!(kind, of(a), Neg, Sqrt, Abs, Floor),
            StepKind::Binary(kind, a, b) => binary!(kind, of(a), of(b), Add, Sub, Mul, Div, Min, Max, PlusWhole),
            StepKind::Select(margin, a, b) => select(of(margin), of(a), of(b), to),
        }
        columns[step.to] = column;
    }
}

#[inline(always)]
fn select(margin: RowOrLanes<'_>, a: RowOrLanes<'_>, b: RowOrLanes<'_>, to: &mut [f64]) {
    match (margin, a, b) {
        (RowOrLanes::One(margin), RowOrLanes::Each(a), _) if margin >= 0.0 => to.copy_from_slice(a),
        (RowOrLanes::Each(margin), RowOrLanes::Each(a), RowOrLanes::Each(b)) => {
            for (((it, &margin), &a), &b) in to.iter_mut().zip(margin).zip(a).zip(b) {
                *it = f64::select(margin, a, b);
            }
        }
        (RowOrLanes::Each(margin), RowOrLanes::Each(a), RowOrLanes::One(b)) => {
            to.iter_mut().zip(margin).zip(a).for_each(|((it, &margin), &a)| *it = f64::select(margin, a, b));
        }
        (RowOrLanes::Each(margin), RowOrLanes::One(a), RowOrLanes::Each(b)) => {
            to.iter_mut().zip(margin).zip(b).for_each(|((it, &margin), &b)| *it = f64::select(margin, a, b));
        }
        _ => to.iter_mut().enumerate().for_each(|(lane, it)| *it = f64::select(margin.at(lane), a.at(lane), b.at(lane))),
    }
}
