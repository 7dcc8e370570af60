//! Designs that have nothing in common with their neighbours: every axis is read by the first stage, so that a row is one design.
//!
//! They are judged by the whole formula as a list over a block of designs, scenario after scenario, of which only what depends on an input
//! that changes is computed again. Designs that are out are left behind, and the scenario in which most of them fail comes first.

use super::Block;
use super::cpu::{holds, worse_of};
use super::tables::{Setting, settings};
use super::turned_list::{NumberReads, RowFormula, TurnedList};
use crate::masks::{self, keep_between, keep_finite, keep_margin};
use crate::models::input_to_si;
use crate::plan::{Plan, Source};
use crate::tape::{ColumnValue, Node, NodeColumns, Set};
use std::ops::Range;

/// Designs of a block: what is computed of them stays in the second-level cache.
const DESIGNS: usize = 256;
/// Most operations, for the same reason.
const MOST_OPERATIONS: usize = 2048;

/// The formula over blocks of designs; for all threads.
#[derive(Debug)]
pub(super) struct RowsTogether {
    list: TurnedList,
    /// Conditions with their margins, and outputs with their values in SI units.
    conditions: Vec<(usize, Node)>,
    outputs: Vec<(usize, Node)>,
    /// Inputs that design axes set, and those that scenarios do.
    inputs: Vec<usize>,
    of_scenarios: Set,
    scenarios: Vec<Setting>,
}

impl RowsTogether {
    /// `None` where rows have many designs, or the formula cannot be recorded.
    pub(super) fn new(plan: &Plan) -> Option<Self> {
        let has_lanes = plan.lane_outputs.len() + plan.lane_conditions.len() > 0;
        if has_lanes || plan.fast.count() > 1 || plan.designs() < DESIGNS as u64 || plan.spectrum.is_some() {
            return None;
        }
        let formula = RowFormula::new(plan, &[])?;
        if formula.list.operations.len() > MOST_OPERATIONS || !formula.list.loops.is_empty() {
            return None;
        }
        let [slow, fast] = [&plan.slow_scenarios, &plan.fast_scenarios].map(|product| settings(plan, product));
        if (slow.len() * fast.len()) as u64 != plan.scenarios() {
            return None;
        }
        let joined = slow.iter().flat_map(|slow| fast.iter().map(move |fast| slow.iter().chain(fast).copied().collect()));
        let of_designs = plan.slow.inputs() | plan.fast.inputs();
        let of_scenarios = plan.slow_scenarios.inputs() | plan.fast_scenarios.inputs();
        let of_input = |input: u16| NumberReads { turning: Set::one(input.into()) & of_scenarios, each: of_designs.contains(input.into()) };
        let results = formula.results();
        let RowFormula { list, conditions, outputs, .. } = formula;
        Some(Self {
            conditions,
            outputs,
            list: TurnedList::new(list, &results, of_input),
            inputs: of_designs.iter().collect(),
            of_scenarios,
            scenarios: joined.collect(),
        })
    }

    /// Bytes of a thread's room.
    pub(super) fn room(plan: &Plan) -> u64 {
        Self::new(plan).map_or(0, |it| it.list.bytes(DESIGNS) + 8 * (DESIGNS * (2 * it.inputs.len() + plan.tracked.len() + 4)) as u64)
    }
}

/// A block being judged; one per thread.
#[derive(Debug)]
pub(super) struct BlockOfRows {
    numbers: NodeColumns,
    /// Inputs of the designs that are still in, in their units and in SI, by [`RowsTogether::inputs`].
    own: Vec<Vec<f64>>,
    si: Vec<Vec<f64>>,
    /// Which designs these are.
    designs: Vec<u64>,
    alive: Vec<u64>,
    /// Worst values so far, by tracked quantity.
    values: Vec<Vec<f64>>,
    /// An output in its unit.
    output: Vec<f64>,
    /// Inputs that are the same for all of them, in their units and in SI.
    common: Vec<f64>,
    common_si: Vec<f64>,
    /// The order of the scenarios, and how many designs each has thrown out.
    order: Vec<usize>,
    failed: Vec<u64>,
}

impl BlockOfRows {
    /// Room for a thread.
    pub(super) fn new(plan: &Plan, rows: &RowsTogether) -> Self {
        let common = plan.space.inputs(0, 0);
        let columns = || rows.inputs.iter().map(|_| Vec::with_capacity(DESIGNS)).collect();
        Self {
            numbers: NodeColumns::new(&rows.list.list),
            own: columns(),
            si: columns(),
            designs: Vec::with_capacity(DESIGNS),
            alive: Vec::with_capacity(DESIGNS),
            values: plan.tracked.iter().map(|_| Vec::with_capacity(DESIGNS)).collect(),
            output: vec![0.0; DESIGNS],
            common_si: common.iter().zip(&plan.study.model.inputs).map(|(&value, input)| input_to_si(input, value)).collect(),
            common,
            order: (0..rows.scenarios.len()).collect(),
            failed: vec![0; rows.scenarios.len()],
        }
    }

    /// Judges the designs at `positions` and hands over each block with a feasible one. Returns the position before which all are judged.
    pub(super) fn judge(
        &mut self,
        plan: &Plan,
        rows: &RowsTogether,
        positions: Range<u64>,
        is_stopped: impl Fn() -> bool,
        mut absorb: impl FnMut(&Block<'_>),
    ) -> u64 {
        let mut first = positions.start;
        while first < positions.end {
            if is_stopped() {
                return first;
            }
            let last = positions.end.min(first + DESIGNS as u64);
            self.begin(plan, rows, first..last);
            if self.judge_block(plan, rows) {
                let (offsets, alive, values) = (&self.designs, &self.alive, &self.values);
                absorb(&Block { row_index: 0, offsets, feasible_count: masks::count(alive), alive, values });
            }
            first = last;
        }
        first
    }

    /// Lays out the designs at some positions.
    fn begin(&mut self, plan: &Plan, rows: &RowsTogether, positions: Range<u64>) {
        self.designs.clear();
        self.own.iter_mut().chain(&mut self.si).for_each(Vec::clear);
        let mut inputs = std::mem::take(&mut self.common);
        for position in positions {
            // Of a row with one design, the position is that of the row.
            plan.slow.set(position, &mut inputs);
            plan.fast.set(0, &mut inputs);
            self.designs.push(plan.design_at(position));
            self.own.iter_mut().zip(&rows.inputs).for_each(|(column, &input)| column.push(inputs[input]));
        }
        self.common = inputs;
        for ((si, own), &input) in self.si.iter_mut().zip(&self.own).zip(&rows.inputs) {
            let input = &plan.study.model.inputs[input];
            si.extend(own.iter().map(|&value| input_to_si(input, value)));
        }
        self.alive.clear();
        self.alive.resize(self.designs.len(), u64::MAX);
        for ((tracked, _), column) in plan.tracked.iter().zip(&mut self.values) {
            column.clear();
            column.resize(self.designs.len(), tracked.worse.least_bad());
        }
    }

    /// Judges the block in one scenario after the other; false if no design is left.
    fn judge_block(&mut self, plan: &Plan, rows: &RowsTogether) -> bool {
        let mut is_stale = true;
        for place in 0..self.order.len() {
            let scenario = self.order[place];
            let before = self.common_si.clone();
            for &(input, own, si) in &rows.scenarios[scenario] {
                (self.common[input], self.common_si[input]) = (own, si);
            }
            let has_changed = |&input: &usize| before[input].to_bits() != self.common_si[input].to_bits();
            let changed = (!is_stale).then(|| rows.of_scenarios.iter().filter(has_changed).collect());
            self.turn(rows, changed);
            is_stale = false;
            let were = masks::count(&self.alive);
            self.judge_scenario(plan, rows);
            let left = masks::count(&self.alive);
            self.failed[scenario] += were - left;
            if left == 0 {
                self.sort();
                return false;
            }
            // What is out costs as much as what is in, and laying out anew about as much as two scenarios.
            if left * 2 <= self.designs.len() as u64 && place + 2 < self.order.len() {
                self.compact();
                is_stale = true;
            }
        }
        self.sort();
        true
    }

    /// The scenario that throws out most designs comes first from now on.
    fn sort(&mut self) {
        let most = (0..self.order.len()).max_by_key(|&place| (self.failed[self.order[place]], std::cmp::Reverse(place)));
        self.order[..=most.unwrap_or(0)].rotate_right(1);
    }

    /// Computes the formula in the current scenario.
    fn turn(&mut self, rows: &RowsTogether, changed: Option<Set>) {
        let Self { numbers, si, common_si, designs, .. } = self;
        numbers.begin(designs.len());
        rows.list.turn(numbers, changed, |input| match rows.inputs.iter().position(|&it| it == usize::from(input)) {
            Some(column) => ColumnValue::Each(&si[column]),
            None => ColumnValue::One(common_si[usize::from(input)]),
        });
    }

    fn judge_scenario(&mut self, plan: &Plan, rows: &RowsTogether) {
        let Self { numbers, own, alive, values, output, common, .. } = self;
        let model = &plan.study.model;
        let out_if = |alive: &mut [u64], is_out: bool| {
            if is_out {
                alive.fill(0);
            }
        };
        for &(condition, node) in &rows.conditions {
            let strict = model.conditions[condition].strict;
            match rows.list.value(numbers, node) {
                ColumnValue::Each(margins) => keep_margin(alive, margins, strict),
                ColumnValue::One(margin) => out_if(alive, !holds(plan, condition, margin)),
            }
        }
        let mut judge = |source: Source, judge: &mut dyn FnMut(ColumnValue<'_>)| match source {
            Source::RowInput(input) | Source::LaneInput(input) => match rows.inputs.iter().position(|&it| it == input) {
                Some(column) => judge(ColumnValue::Each(&own[column])),
                None => judge(ColumnValue::One(common[input])),
            },
            Source::RowOutput(number) => {
                let (_, node) = rows.outputs.iter().find(|(it, _)| *it == number).expect("it was asked for");
                let unit = model.outputs[number].unit;
                match rows.list.value(numbers, *node) {
                    ColumnValue::One(value) => judge(ColumnValue::One(unit.from_si(value))),
                    ColumnValue::Each(column) if unit.is_si() => judge(ColumnValue::Each(column)),
                    ColumnValue::Each(column) => {
                        output.iter_mut().zip(column).for_each(|(to, &value)| *to = unit.from_si(value));
                        judge(ColumnValue::Each(&output[..column.len()]));
                    }
                }
            }
            Source::LaneOutput(_) => unreachable!("no output differs within a row of one design"),
        };
        for (constraint, &source) in plan.study.constraints.iter().zip(&plan.constraints) {
            let (low, high) = constraint.ends();
            judge(source, &mut |value| match value {
                ColumnValue::Each(column) => {
                    keep_between(alive, column, low, high);
                    keep_finite(alive, column);
                }
                ColumnValue::One(value) => out_if(alive, !(value.is_finite() && constraint.holds(value))),
            });
        }
        for ((tracked, source), worst) in plan.tracked.iter().zip(values) {
            judge(*source, &mut |value| match value {
                ColumnValue::Each(column) => {
                    keep_finite(alive, column);
                    masks::worsen(tracked.worse, false, worst, column);
                }
                ColumnValue::One(value) => {
                    out_if(alive, !value.is_finite());
                    worst.iter_mut().for_each(|worst| *worst = worse_of(tracked.worse, *worst, value));
                }
            });
        }
    }

    /// Leaves the designs behind that are out.
    fn compact(&mut self) {
        let Self { own, si, designs, alive, values, .. } = self;
        for column in own.iter_mut().chain(si).chain(values) {
            let mut number = 0;
            column.retain(|_| {
                number += 1;
                alive[number - 1] != 0
            });
        }
        let mut number = 0;
        designs.retain(|_| {
            number += 1;
            alive[number - 1] != 0
        });
        alive.retain(|alive| *alive != 0);
    }
}

#[cfg(test)]
mod tests {
    use super::super::row_list::tests::judged;
    use super::super::{CpuEngine, Tables};
    use super::*;
    use crate::study::Study;
    use std::path::Path;

    #[test]
    fn designs_judged_together_have_the_answers_of_each_alone() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
        let mut served = Vec::new();
        for name in ["rubber-cvt", "scooter-variator", "metal-cvt", "flat-belt", "catalogue-v-belts", "camshaft-torque"] {
            let plan = Plan::new(Study::read(&folder.join(format!("{name}.toml"))).expect("it is right").0);
            let mut tables = Tables::new(&plan);
            if tables.together.is_none() {
                continue;
            }
            // Stretches that begin and end anywhere, from end to end.
            let count = plan.designs();
            let stretches: Vec<Range<u64>> =
                (0..30).map(|step| step * 7_654_321 % (count - 900)).map(|first| first..first + 100 + first % 701).collect();
            let together = judged(&mut CpuEngine::new(&plan, &tables), &plan, &stretches);
            let rows = tables.together.take();
            let alone = judged(&mut CpuEngine::new(&plan, &tables), &plan, &stretches);
            assert_eq!(together, alone, "{name}");
            served.push((name, !alone.is_empty()));
            tables.together = rows;
            tables.together.iter_mut().for_each(|it| it.list.forget());
            let forgetful = judged(&mut CpuEngine::new(&plan, &tables), &plan, &stretches);
            assert!(alone.is_empty() || forgetful != alone, "{name}");
        }
        assert!(served.iter().any(|(_, some)| *some), "{served:?}");
    }
}
