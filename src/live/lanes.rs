//! Single designs over all their scenarios at once: the scenarios are the columns of the recorded formula.
//!
//! The engine of the sweep is quick where many designs share a row. The designs of a front share little; what they share is the scenarios.
//! What depends on the scenario alone is computed once for all designs, what depends on the design alone once for all scenarios. The
//! numbers have the bits of the formula itself.

use crate::certify::{AtWorst, Column, Row};
use crate::models::input_to_si;
use crate::plan::{Plan, Source, knowns};
use crate::study::{Axis, Quantity};
use crate::tape::{CHUNK, ColumnValue, List, Node, NodeColumns, Operation, Set};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

/// Most operations of a formula that is worth it: one with loops may have thousands.
const MOST_OPERATIONS: usize = 4000;

/// The formula of a plan, cut to what the plan asks for.
#[derive(Debug)]
pub struct ScenarioLanes {
    list: List,
    /// Does an operation depend on the scenario?
    of_scenario: Vec<bool>,
    /// Operations that depend on the scenario alone, and all others, operands first.
    shared: Vec<Node>,
    own: Vec<Node>,
    /// Conditions that matter, with the place of their margin among the results.
    conditions: Vec<(usize, usize)>,
    /// By scenario, of each input that the scenario sets: its number, and its values in its unit and in SI.
    inputs: Vec<(usize, Vec<f64>, Vec<f64>)>,
    scenarios: usize,
}

/// A number of every scenario.
#[derive(Clone, Copy)]
enum LaneValues<'a> {
    Column(ColumnValue<'a>),
    /// An input that the scenario sets, in its unit.
    Input(&'a [f64]),
}

impl ScenarioLanes {
    /// For a plan; `None` where it asks for sums over cases, or its model cannot be recorded.
    pub fn new(plan: &Plan) -> Option<Self> {
        let study = &plan.study;
        let model = &study.model;
        if plan.spectrum.is_some() || study.probability.is_some() {
            return None;
        }
        let formula = model.kernel.formula()?;
        let mattering: Vec<usize> = plan.row_conditions.iter().chain(&plan.lane_conditions).copied().collect();
        let (wanted, asked): (Set, Set) = (plan.used_outputs(), mattering.iter().collect());
        let list = formula.whole(&knowns(study, &plan.space), wanted, asked).list(wanted, asked);
        // A root takes long for each scenario, and the engine solves it once for all designs of a row.
        let is_slow = |it: &Operation| matches!(it, Operation::Root(_) | Operation::Rolled(_));
        if list.operations.len() > MOST_OPERATIONS || list.operations.iter().any(is_slow) {
            return None;
        }
        let by = |axes: &[&Vec<Axis>]| -> Set { axes.iter().flat_map(|axes| axes.iter()).flat_map(Axis::inputs).collect() };
        let (designs, scenarios) = (by(&[&study.design]), by(&[&study.operation, &study.uncertainty]));
        let depends = |inputs: Set| -> Vec<bool> {
            list.dependencies(|input| Bit(inputs.contains(input.into()))).into_iter().map(|it| it.0).collect()
        };
        let (of_design, of_scenario) = (depends(designs), depends(scenarios));
        let results: Vec<Node> = list.results.iter().flatten().copied().collect();
        let is_shared = |node: &Node| of_scenario[*node as usize] && !of_design[*node as usize];
        let (shared, own) = list.needed_by(&results).into_iter().partition(is_shared);
        let count = usize::try_from(plan.scenarios()).ok()?;
        let outputs = formula.fields().outputs.len();
        let mut values = study.fixed.clone();
        let mut inputs: Vec<(usize, Vec<f64>, Vec<f64>)> = scenarios.iter().map(|input| (input, Vec::new(), Vec::new())).collect();
        for scenario in 0..plan.scenarios() {
            plan.space.scenarios.set(scenario, &mut values);
            for (input, own, si) in &mut inputs {
                own.push(values[*input]);
                si.push(input_to_si(&model.inputs[*input], values[*input]));
            }
        }
        let conditions = mattering.into_iter().map(|condition| (condition, outputs + condition)).collect();
        Some(Self { list, of_scenario, shared, own, conditions, inputs, scenarios: count })
    }

    /// The feasible ones of some designs with their values at the worst scenarios, in any order. A design of which a followed value is
    /// absent somewhere is left out.
    pub fn judge(&self, plan: &Plan, columns: &[Column], designs: &[u64], stop: &AtomicBool) -> Vec<Row> {
        let mut numbers = NodeColumns::new(&self.list);
        let own: Vec<Vec<f64>> = designs.iter().map(|&design| plan.space.inputs(design, 0)).collect();
        let mut worst: Vec<Option<Vec<(f64, AtWorst)>>> = designs.iter().map(|_| Some(vec![Column::nothing(); columns.len()])).collect();
        for first in (0..self.scenarios).step_by(CHUNK) {
            let lanes = first..self.scenarios.min(first + CHUNK);
            numbers.begin(lanes.len());
            self.fill(plan, &self.shared, &plan.study.fixed, &lanes, &mut numbers);
            for (inputs, slot) in own.iter().zip(&mut worst) {
                if stop.load(Ordering::Relaxed) {
                    return Vec::new();
                }
                let Some(worst) = slot.as_mut() else { continue };
                self.fill(plan, &self.own, inputs, &lanes, &mut numbers);
                if !self.take(plan, columns, inputs, &lanes, &numbers, worst) {
                    *slot = None;
                }
            }
        }
        let row = |(&design, worst): (&u64, Option<Vec<(f64, AtWorst)>>)| {
            Some(Row::seen(plan, design, worst?.into_iter().map(|(_, at)| at).collect()))
        };
        designs.iter().zip(worst).filter_map(row).collect()
    }

    /// Computes some operations over a chunk of scenarios.
    fn fill(&self, plan: &Plan, nodes: &[Node], inputs: &[f64], lanes: &Range<usize>, numbers: &mut NodeColumns) {
        for &node in nodes {
            let at = node as usize;
            match self.list.operations[at] {
                Operation::Input(input) => match self.inputs.iter().find(|(it, ..)| *it == usize::from(input)) {
                    Some((_, _, si)) => numbers.fill(node, |to| to.copy_from_slice(&si[lanes.clone()])),
                    None => numbers.slots[at] = input_to_si(&plan.study.model.inputs[usize::from(input)], inputs[usize::from(input)]),
                },
                _ if self.of_scenario[at] => numbers.compute(&self.list, node, |node| self.of_scenario[node as usize]),
                _ => self.list.compute(node, &mut numbers.slots),
            }
        }
    }

    /// Takes the values of a chunk of scenarios into the worst ones; false if the design is out.
    fn take(
        &self,
        plan: &Plan,
        columns: &[Column],
        inputs: &[f64],
        lanes: &Range<usize>,
        numbers: &NodeColumns,
        worst: &mut [(f64, AtWorst)],
    ) -> bool {
        let model = &plan.study.model;
        let result = |place: usize| {
            let node = self.list.results[place].expect("the list is cut to what is asked for");
            numbers.value(node, |node| self.of_scenario[node as usize])
        };
        let count = lanes.len();
        let all = |value: ColumnValue<'_>, is: &dyn Fn(f64) -> bool| match value {
            ColumnValue::One(value) => is(value),
            ColumnValue::Each(values) => values.iter().all(|&value| is(value)),
        };
        let keeps = |condition: usize, margin: f64| if model.conditions[condition].strict { margin > 0.0 } else { margin >= 0.0 };
        if !self.conditions.iter().all(|&(condition, place)| all(result(place), &|margin| keeps(condition, margin))) {
            return false;
        }
        let values = |quantity: Quantity| match quantity {
            Quantity::Input(input) => match self.inputs.iter().find(|(it, ..)| *it == input) {
                Some((_, own, _)) => LaneValues::Input(&own[lanes.clone()]),
                None => LaneValues::Column(ColumnValue::One(inputs[input])),
            },
            Quantity::Output(output) => LaneValues::Column(result(output)),
        };
        let in_unit = |quantity: Quantity, value: f64| match quantity {
            Quantity::Input(_) => value,
            Quantity::Output(output) => model.outputs[output].unit.from_si(value),
        };
        let fits = |quantity: Quantity, is: &dyn Fn(f64) -> bool| match values(quantity) {
            LaneValues::Input(values) => values.iter().all(|&it| is(it)),
            LaneValues::Column(values) => all(values, &|it| is(in_unit(quantity, it))),
        };
        if !plan.study.constraints.iter().all(|it| fits(it.quantity, &|value| value.is_finite() && it.holds(value))) {
            return false;
        }
        // Constraints have asked for finite numbers already.
        let constrained = |source: &Source| plan.constraints.contains(source);
        let mut followed = plan.tracked.iter().filter(|(_, source)| !constrained(source));
        if !followed.all(|(it, _)| fits(it.quantity, &f64::is_finite)) {
            return false;
        }
        for (column, worst) in columns.iter().zip(worst) {
            // What is confirmed with other draws has no value here.
            if column.followed().iter().all(|it| !plan.tracked.iter().any(|(other, _)| other == it)) {
                continue;
            }
            let quantity = column.quantity;
            match values(quantity) {
                LaneValues::Column(ColumnValue::One(value)) => column.take(worst, in_unit(quantity, value), lanes.start as u64),
                LaneValues::Column(ColumnValue::Each(values)) => {
                    for (lane, &value) in values[..count].iter().enumerate() {
                        column.take(worst, in_unit(quantity, value), (lanes.start + lane) as u64);
                    }
                }
                LaneValues::Input(values) => {
                    for (lane, &value) in values.iter().enumerate() {
                        column.take(worst, value, (lanes.start + lane) as u64);
                    }
                }
            }
        }
        true
    }
}

/// One bit, to be joined over what a number depends on.
#[derive(Clone, Copy, Default)]
struct Bit(bool);

impl std::ops::BitOrAssign for Bit {
    fn bitor_assign(&mut self, other: Self) {
        self.0 |= other.0;
    }
}
