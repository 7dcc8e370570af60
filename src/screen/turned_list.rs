//! A list of operations, of which only those are computed again that read an input which has changed.

use crate::plan::{Plan, knowns};
use crate::tape::{ColumnValue, List, Node, NodeColumns, Operation, Set};

/// What an operation depends on.
#[derive(Clone, Copy, Default)]
pub(super) struct NumberReads {
    /// Inputs that turn while the columns stay as they are.
    pub(super) turning: Set,
    /// Has it a number for each place of a column, or one for all?
    pub(super) each: bool,
}

impl std::ops::BitOrAssign for NumberReads {
    fn bitor_assign(&mut self, other: Self) {
        self.turning = self.turning | other.turning;
        self.each |= other.each;
    }
}

/// The formula of a plan up to what is the same for all designs of a row.
pub(super) struct RowFormula {
    pub(super) list: List,
    /// Numbers that the first stage passes on, in the order in which they were asked for.
    pub(super) passed: Vec<Node>,
    /// Conditions and outputs of the model that the row decides, with their results.
    pub(super) conditions: Vec<(usize, Node)>,
    pub(super) outputs: Vec<(usize, Node)>,
}

impl RowFormula {
    /// Records it, with these of the numbers that the first stage passes on; `None` if that cannot be done.
    pub(super) fn new(plan: &Plan, passed: &[usize]) -> Option<Self> {
        let formula = plan.study.model.kernel.formula()?;
        let known = knowns(&plan.study, &plan.space);
        let whole = formula.whole(&known[..formula.fields().inputs.len()], plan.used_outputs(), Set::of(&plan.row_conditions));
        let asked = passed.iter().map(|&number| whole.prepared[number]);
        let asked = asked.chain(plan.row_conditions.iter().map(|&number| whole.conditions[number]));
        let asked: Vec<Option<Node>> = asked.chain(plan.row_outputs.iter().map(|number| whole.outputs[number])).map(Some).collect();
        let list = List::cut(&whole.recording, &asked);
        let results: Vec<Node> = list.results.iter().flatten().copied().collect();
        let (passed, rest) = results.split_at(passed.len());
        let (conditions, outputs) = rest.split_at(plan.row_conditions.len());
        Some(Self {
            passed: passed.to_vec(),
            conditions: plan.row_conditions.iter().copied().zip(conditions.iter().copied()).collect(),
            outputs: plan.row_outputs.iter().zip(outputs.iter().copied()).collect(),
            list,
        })
    }

    /// All results.
    pub(super) fn results(&self) -> Vec<Node> {
        let rest = self.conditions.iter().chain(&self.outputs).map(|(_, node)| *node);
        self.passed.iter().copied().chain(rest).collect()
    }
}

/// Operations of a list, operands first, with what each depends on.
#[derive(Debug)]
pub(super) struct TurnedList {
    pub(super) list: List,
    nodes: Vec<Node>,
    turning: Vec<Set>,
    each: Vec<bool>,
}

impl TurnedList {
    /// For these operations of a list, given what each input is.
    pub(super) fn new(list: List, asked: &[Node], of_input: impl Fn(u16) -> NumberReads) -> Self {
        let reads = list.dependencies(of_input);
        let nodes = list.needed_by(asked);
        Self { nodes, turning: reads.iter().map(|it| it.turning).collect(), each: reads.iter().map(|it| it.each).collect(), list }
    }

    /// Computes what depends on inputs that have changed; everything if that is not known.
    pub(super) fn turn<'c>(&self, numbers: &mut NodeColumns, changed: Option<Set>, input: impl Fn(u16) -> ColumnValue<'c>) {
        let is_stale = |node: &&Node| changed.is_none_or(|changed| self.turning[**node as usize].meets(changed));
        for &node in self.nodes.iter().filter(is_stale) {
            match self.list.operations[node as usize] {
                Operation::Input(number) => match input(number) {
                    ColumnValue::One(value) => numbers.slots[node as usize] = value,
                    ColumnValue::Each(column) => numbers.fill(node, |to| to.copy_from_slice(column)),
                },
                _ if self.each[node as usize] => numbers.compute(&self.list, node, |node| self.each[node as usize]),
                _ => self.list.compute(node, &mut numbers.slots),
            }
        }
    }

    /// The number of an operation.
    pub(super) fn value<'n>(&self, numbers: &'n NodeColumns, node: Node) -> ColumnValue<'n> {
        numbers.value(node, |node| self.each[node as usize])
    }

    /// Bytes of its numbers, with so many places in a column.
    pub(super) fn bytes(&self, places: usize) -> u64 {
        let columns = self.nodes.iter().filter(|&&node| self.each[node as usize]).count();
        8 * (columns * places + self.list.operations.len()) as u64
    }

    /// What an operation depends on.
    pub(super) fn reads(&self, node: Node) -> NumberReads {
        NumberReads { turning: self.turning[node as usize], each: self.each[node as usize] }
    }

    /// From now on it computes nothing again.
    #[cfg(test)]
    pub(super) fn forget(&mut self) {
        self.turning.fill(Set::EMPTY);
    }
}
