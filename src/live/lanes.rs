//! Single designs over all their scenarios at once: the scenarios are the columns of the recorded formula.
//!
//! The engine of the sweep is quick where many designs share a row. The designs of a front share little; what they share is the scenarios.
//! What depends on the scenario alone is computed once for all designs, what depends on the design alone once for all scenarios, and from
//! design to design only what depends on an input that has changed. The numbers have the bits of the formula itself.

use super::search::UNKNOWN;
use crate::certify::{AtWorst, Column, Row};
use crate::masks::all_ends;
use crate::models::{Worse, input_to_si};
use crate::plan::{Plan, knowns};
use crate::study::{Axis, Constraint, Quantity};
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
    /// Operations that depend on no design, and all others, operands first.
    shared: Vec<Node>,
    own: Vec<Node>,
    /// The design's inputs that each operation depends on.
    turning: Vec<Set>,
    /// Conditions that matter, with the place of their margin among the results.
    conditions: Vec<(usize, usize)>,
    /// What constraints and columns are about, each once.
    asked: Vec<Quantity>,
    /// Inputs that scenarios set.
    inputs: Set,
    scenarios: usize,
}

/// Some scenarios, one after the other.
struct LaneScenarios {
    lanes: Range<usize>,
    /// Of each input that they set: its number, and its values in its unit and in SI.
    inputs: Vec<(usize, Vec<f64>, Vec<f64>)>,
}

impl LaneScenarios {
    fn new(plan: &Plan, set: Set, lanes: Range<usize>) -> Self {
        let mut values = plan.study.fixed.clone();
        let mut inputs: Vec<(usize, Vec<f64>, Vec<f64>)> = set.iter().map(|input| (input, Vec::new(), Vec::new())).collect();
        for scenario in lanes.clone() {
            plan.space.scenarios.set(scenario as u64, &mut values);
            for (input, own, si) in &mut inputs {
                own.push(values[*input]);
                si.push(input_to_si(&plan.study.model.inputs[*input], values[*input]));
            }
        }
        Self { lanes, inputs }
    }

    /// The values of an input in its unit and in SI, if they set it.
    fn values(&self, input: usize) -> Option<(&[f64], &[f64])> {
        self.inputs.iter().find(|(it, ..)| *it == input).map(|(_, own, si)| (own.as_slice(), si.as_slice()))
    }
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
        let is_rolled = |it: &Operation| matches!(it, Operation::Rolled(_));
        if list.operations.len() > MOST_OPERATIONS || list.operations.iter().any(is_rolled) || !list.has_roots_in_columns() {
            return None;
        }
        let by = |axes: &[&Vec<Axis>]| -> Set { axes.iter().flat_map(|axes| axes.iter()).flat_map(Axis::inputs).collect() };
        let (designs, scenarios) = (by(&[&study.design]), by(&[&study.operation, &study.uncertainty]));
        let reads = |inputs: Set| -> Vec<Set> {
            list.dependencies(|input| JoinedInputs(Set::one(input.into()) & inputs)).into_iter().map(|it| it.0).collect()
        };
        let turning = reads(designs);
        let of_scenario: Vec<bool> = reads(scenarios).iter().map(|it| !it.is_empty()).collect();
        let results: Vec<Node> = list.results.iter().flatten().copied().collect();
        let (shared, own) = list.needed_by(&results).into_iter().partition(|node| turning[*node as usize].is_empty());
        let count = usize::try_from(plan.scenarios()).ok()?;
        let outputs = formula.fields().outputs.len();
        let conditions = mattering.into_iter().map(|condition| (condition, outputs + condition)).collect();
        let mut asked: Vec<Quantity> = Vec::new();
        for quantity in study.constraints.iter().map(|it| it.quantity).chain(plan.tracked.iter().map(|(it, _)| it.quantity)) {
            if !asked.contains(&quantity) {
                asked.push(quantity);
            }
        }
        Some(Self { list, of_scenario, shared, own, turning, conditions, asked, inputs: scenarios, scenarios: count })
    }

    /// The feasible ones of some designs with their worst values, in any order. A design of which a followed value is absent somewhere is left
    /// out. Designs next to each other should share inputs.
    pub fn judge(&self, plan: &Plan, columns: &[Column], designs: &[u64], stop: &AtomicBool) -> Vec<Row> {
        let mut numbers = NodeColumns::new(&self.list);
        let own: Vec<Vec<f64>> = designs.iter().map(|&design| plan.space.inputs(design, 0)).collect();
        let mut worst: Vec<Option<Vec<(f64, AtWorst)>>> = designs.iter().map(|_| Some(vec![Column::nothing(); columns.len()])).collect();
        for first in (0..self.scenarios).step_by(CHUNK) {
            if stop.load(Ordering::Relaxed) {
                return Vec::new();
            }
            let lanes = LaneScenarios::new(plan, self.inputs, first..self.scenarios.min(first + CHUNK));
            numbers.begin(lanes.lanes.len());
            self.fill(plan, self.shared.iter(), &plan.study.fixed, &lanes, &mut numbers);
            let mut last: Option<&[f64]> = None;
            for (inputs, slot) in own.iter().zip(&mut worst) {
                if stop.load(Ordering::Relaxed) {
                    return Vec::new();
                }
                let Some(worst) = slot.as_mut() else { continue };
                let differs = |last: &[f64]| (0..inputs.len()).filter(|&it| inputs[it].to_bits() != last[it].to_bits()).collect::<Set>();
                let changed = last.map(differs);
                let is_stale = |node: &&Node| changed.is_none_or(|changed| self.turning[**node as usize].meets(changed));
                self.fill(plan, self.own.iter().filter(is_stale), inputs, &lanes, &mut numbers);
                last = Some(inputs);
                if !self.take(plan, columns, inputs, &lanes, &numbers, worst) {
                    *slot = None;
                }
            }
        }
        let row = |(&design, worst): (&u64, Option<Vec<(f64, AtWorst)>>)| {
            Some(Row::seen(plan, design, worst?.into_iter().map(|(_, at)| AtWorst { scenario: UNKNOWN, ..at }).collect()))
        };
        designs.iter().zip(worst).filter_map(row).collect()
    }

    /// Computes some operations over a chunk of scenarios.
    fn fill<'n>(
        &self,
        plan: &Plan,
        nodes: impl Iterator<Item = &'n Node>,
        inputs: &[f64],
        lanes: &LaneScenarios,
        numbers: &mut NodeColumns,
    ) {
        for &node in nodes {
            let at = node as usize;
            match self.list.operations[at] {
                Operation::Input(input) => match lanes.values(usize::from(input)) {
                    Some((_, si)) => numbers.fill(node, |to| to.copy_from_slice(si)),
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
        lanes: &LaneScenarios,
        numbers: &NodeColumns,
        worst: &mut [(f64, AtWorst)],
    ) -> bool {
        let model = &plan.study.model;
        let result = |place: usize| {
            let node = self.list.results[place].expect("the list is cut to what is asked for");
            numbers.value(node, |node| self.of_scenario[node as usize])
        };
        for &(condition, place) in &self.conditions {
            let least = match result(place) {
                ColumnValue::One(margin) => margin,
                ColumnValue::Each(margins) => all_ends(margins).map_or(f64::NAN, |(least, _)| least),
            };
            if !(least > 0.0 || least == 0.0 && !model.conditions[condition].strict) {
                return false;
            }
        }
        let values = |quantity: Quantity| match quantity {
            Quantity::Input(input) => match lanes.values(input) {
                Some((own, _)) => ColumnValue::Each(own),
                None => ColumnValue::One(inputs[input]),
            },
            Quantity::Output(output) => result(output),
        };
        let in_unit = |quantity: Quantity, value: f64| match quantity {
            Quantity::Input(_) => value,
            Quantity::Output(output) => model.outputs[output].unit.from_si(value),
        };
        // Converting a unit keeps the order of numbers, so the ends alone are converted.
        let ends_of = |quantity: Quantity| {
            let (low, high) = match values(quantity) {
                ColumnValue::One(value) => (value, value),
                ColumnValue::Each(values) => all_ends(values)?,
            };
            let ends = (in_unit(quantity, low), in_unit(quantity, high));
            (low.is_finite() && high.is_finite() && ends.0.is_finite() && ends.1.is_finite()).then_some(ends)
        };
        let Some(found) = self.asked.iter().map(|&quantity| ends_of(quantity)).collect::<Option<Vec<(f64, f64)>>>() else { return false };
        let ends = |quantity: Quantity| self.asked.iter().position(|it| *it == quantity).map(|at| found[at]);
        let holds = |(low, high): (f64, f64), of: &Constraint| of.holds(low) && of.holds(high);
        if !plan.study.constraints.iter().all(|it| ends(it.quantity).is_some_and(|ends| holds(ends, it))) {
            return false;
        }
        for (column, worst) in columns.iter().zip(worst) {
            // What is confirmed with other draws has no value here.
            if column.followed().iter().all(|it| !plan.tracked.iter().any(|(other, _)| other == it)) {
                continue;
            }
            let quantity = column.quantity;
            match (column.end(), ends(quantity), values(quantity)) {
                (Some(Worse::Lower), Some((low, _)), _) => column.take(worst, low, UNKNOWN),
                (Some(Worse::Higher), Some((_, high)), _) => column.take(worst, high, UNKNOWN),
                (.., ColumnValue::One(value)) => column.take(worst, in_unit(quantity, value), UNKNOWN),
                (.., ColumnValue::Each(values)) => {
                    values.iter().for_each(|&value| column.take(worst, in_unit(quantity, value), UNKNOWN));
                }
            }
        }
        true
    }
}

/// The inputs that an operation depends on, to be joined.
#[derive(Clone, Copy, Default)]
struct JoinedInputs(Set);

impl std::ops::BitOrAssign for JoinedInputs {
    fn bitor_assign(&mut self, other: Self) {
        self.0 = self.0 | other.0;
    }
}
