//! The scalar reference: a model's own formula, one design and one scenario after the other.

use super::{AtWorst, Column, Row};
use crate::models::{Latest, Set, Sizes, Status, fill_si, judge, shown};
use crate::plan::Plan;
use crate::study::{OverScenarios, Quantity};
use std::sync::atomic::{AtomicBool, Ordering};

/// The scalar f64 evaluation of designs over all scenarios. It keeps the prepared numbers of one row, which depend on slow inputs only.
pub(super) struct Reference<'p> {
    plan: &'p Plan,
    columns: &'p [Column],
    wanted: Set,
    /// The quantities that are summed over the cases of a spectrum, each once.
    summed: Vec<Quantity>,
    /// Outputs that the study judges by: of these an overflow is a status.
    used: Vec<usize>,
    row: Option<u64>,
    /// The prepared numbers of the first slow scenarios, as many as there is room for.
    prepared: Vec<Vec<f64>>,
    /// The prepared numbers of another slow scenario.
    beyond: Vec<f64>,
    /// Rows that differ only in inputs that their section does not read share their prepared numbers.
    latest: Latest,
    stop: &'p AtomicBool,
}

impl<'p> Reference<'p> {
    pub fn new(plan: &'p Plan, columns: &'p [Column], stop: &'p AtomicBool) -> Self {
        let tracked = plan.tracked.iter().map(|(it, _)| it.quantity);
        let asked = columns.iter().map(|it| it.quantity).chain(plan.study.constraints.iter().map(|it| it.quantity)).chain(tracked);
        let wanted = asked.filter_map(Quantity::output).collect();
        let of_columns = columns.iter().map(|it| (it.quantity, it.over));
        let of_constraints = plan.study.constraints.iter().map(|it| (it.quantity, it.over));
        let of_tracked = plan.tracked.iter().map(|(it, _)| (it.quantity, it.over));
        let mut summed = Vec::new();
        for (quantity, over) in of_columns.chain(of_constraints).chain(of_tracked) {
            if !over.is_worst() && !summed.contains(&quantity) {
                summed.push(quantity);
            }
        }
        let (model, used) = (&plan.study.model, plan.used_outputs());
        let used = (0..model.outputs.len()).filter(|&it| used.contains(it)).collect();
        Self { plan, columns, wanted, summed, used, row: None, prepared: Vec::new(), beyond: Vec::new(), latest: Latest::new(model), stop }
    }

    /// The row of a design; `None` if it was stopped.
    pub fn row(&mut self, position: u64) -> Option<Row> {
        let plan = self.plan;
        let model = &plan.study.model;
        let index = plan.design_at(position);
        let mut inputs = plan.space.inputs(index, 0);
        let first = inputs.clone();
        let row = position / plan.fast.count();
        if self.row != Some(row) {
            self.row = Some(row);
            self.prepared.clear();
        }
        let Sizes { outputs, conditions, .. } = model.kernel.sizes();
        let [mut si, mut outputs, mut margins] = [inputs.len(), outputs, conditions].map(|length| vec![0.0; length]);
        let (mut feasible, mut without_result, mut first_without) = (true, 0, None);
        let mut first_not_ok = (u64::MAX, Status::Ok);
        let mut worst = vec![(f64::NEG_INFINITY, AtWorst { value: None, scenario: 0 }); self.columns.len()];
        let mut complete = vec![true; self.columns.len()];
        let mut sums = SummedCases::new(plan, &self.summed);
        for q in 0..plan.slow_scenarios.count() {
            plan.slow_scenarios.set(q, &mut inputs);
            for t in 0..plan.fast_scenarios.count() {
                if self.stop.load(Ordering::Relaxed) {
                    return None;
                }
                plan.fast_scenarios.set(t, &mut inputs);
                fill_si(model, &inputs, &mut si);
                let kept = q < plan.kept_scenarios();
                if t == 0 && (!kept || self.prepared.len() as u64 == q) {
                    let mut prepared = std::mem::take(&mut self.beyond);
                    prepared.resize(model.kernel.prepared_len(), 0.0);
                    self.latest.prepare(&si, self.wanted, &mut prepared);
                    if kept { self.prepared.push(prepared) } else { self.beyond = prepared }
                }
                let prepared = if kept { &self.prepared[q as usize] } else { &self.beyond };
                model.kernel.finish_with_conditions(prepared, &si, self.wanted, &mut outputs, &mut margins);
                let (status, present) = judge(model, &margins);
                let scenario = plan.slow_scenarios.source_index(q) + plan.fast_scenarios.source_index(t);
                let value = |quantity| match quantity {
                    Quantity::Input(input) => Some(inputs[input]),
                    Quantity::Output(output) => shown(model, &outputs, present, output),
                };
                // A tracked quantity without a value in some scenario makes a design infeasible, as in the sweep.
                let mut asked = plan.tracked.iter().map(|(it, _)| it.quantity).chain(plan.study.constraints.iter().map(|it| it.quantity));
                let has_result = status == Status::Ok && asked.all(|quantity| value(quantity).is_some());
                if !has_result {
                    without_result += 1;
                    first_without = Some(first_without.map_or(scenario, |first: u64| first.min(scenario)));
                }
                feasible &= has_result;
                feasible &=
                    plan.study.constraints.iter().all(|it| value(it.quantity).is_some_and(|value| !it.over.is_worst() || it.holds(value)));
                // What no condition takes away and is absent all the same has overflowed.
                let overflown = |&it: &usize| present.contains(it) && shown(model, &outputs, present, it).is_none();
                let overflow = status == Status::Ok && self.used.iter().any(overflown);
                let status = if overflow { Status::Overflow } else { status };
                if status != Status::Ok && scenario < first_not_ok.0 {
                    first_not_ok = (scenario, status);
                }
                let of_columns = self.columns.iter().zip(worst.iter_mut().zip(&mut complete));
                for (column, (worst, complete)) in of_columns.filter(|(column, _)| column.over.is_worst()) {
                    let value = value(column.quantity);
                    *complete &= value.is_some();
                    column.worst.take(worst, value, scenario);
                }
                let Some(known) = sums.add((q, t), scenario, value) else { continue };
                let sum = |quantity, over| sums.result(known, quantity, over);
                feasible &= plan
                    .study
                    .constraints
                    .iter()
                    .all(|it| it.over.is_worst() || sum(it.quantity, it.over).is_some_and(|value| it.holds(value)));
                feasible &= plan.tracked.iter().all(|(it, _)| it.over.is_worst() || sum(it.quantity, it.over).is_some());
                let of_columns = self.columns.iter().zip(worst.iter_mut().zip(&mut complete));
                for (column, (worst, complete)) in of_columns.filter(|(column, _)| !column.over.is_worst()) {
                    let value = sum(column.quantity, column.over);
                    *complete &= value.is_some();
                    column.worst.take(worst, value, known.1);
                }
            }
        }
        let columns = worst.into_iter().map(|(_, at)| at).collect();
        Some(Row { index, feasible, without_result, first_without, status: first_not_ok.1, inputs: first, columns, complete })
    }

    /// What the columns and constraints are of in one scenario of a design: the status, and the value of a quantity.
    pub fn at(&mut self, index: u64, scenario: u64) -> (Status, impl Fn(Quantity) -> Option<f64> + use<'_, 'p>) {
        let model = &self.plan.study.model;
        let inputs = self.plan.space.inputs(index, scenario);
        let Sizes { outputs, conditions, .. } = model.kernel.sizes();
        let [mut si, mut outputs, mut margins] = [inputs.len(), outputs, conditions].map(|length| vec![0.0; length]);
        fill_si(model, &inputs, &mut si);
        let mut prepared = vec![0.0; model.kernel.prepared_len()];
        self.latest.prepare(&si, self.wanted, &mut prepared);
        model.kernel.finish_with_conditions(&prepared, &si, self.wanted, &mut outputs, &mut margins);
        let (status, present) = judge(model, &margins);
        let value = move |quantity| match quantity {
            Quantity::Input(input) => Some(inputs[input]),
            Quantity::Output(output) => shown(model, &outputs, present, output),
        };
        (status, value)
    }
}

/// Sums over the cases of a spectrum for one design.
struct SummedCases<'p> {
    plan: &'p Plan,
    summed: &'p [Quantity],
    /// Of each sum under way, of each quantity: the sum, if every case so far has a value.
    sums: Vec<Option<f64>>,
}

/// A sum that has all its cases: which of those under way, and the scenario of its first case.
type KnownSum = (u64, u64);

impl<'p> SummedCases<'p> {
    fn new(plan: &'p Plan, summed: &'p [Quantity]) -> Self {
        let under_way = plan.spectrum.as_ref().map_or(0, |spectrum| spectrum.under_way) as usize;
        Self { plan, summed, sums: vec![None; under_way * summed.len()] }
    }

    /// Adds a scenario; tells what is known once it was the last case.
    fn add(&mut self, turn: (u64, u64), scenario: u64, value: impl Fn(Quantity) -> Option<f64>) -> Option<KnownSum> {
        let spectrum = self.plan.spectrum.as_ref().filter(|_| !self.summed.is_empty())?;
        let place = spectrum.place(turn);
        let first = place.slot as usize * self.summed.len();
        for (sum, &quantity) in self.sums[first..].iter_mut().zip(self.summed) {
            let before = if place.case == 0 { Some(0.0) } else { *sum };
            *sum = before.zip(value(quantity)).map(|(sum, value)| sum + place.weight * value);
        }
        place.is_last.then(|| (place.slot, scenario - place.case as u64 * spectrum.stride))
    }

    /// The mean or sum of a quantity; `None` if a case has no value, or it is beyond what f64 holds.
    fn result(&self, (slot, _): KnownSum, quantity: Quantity, over: OverScenarios) -> Option<f64> {
        let number = self.summed.iter().position(|&it| it == quantity)?;
        let sum = self.sums[slot as usize * self.summed.len() + number]?;
        let total = self.plan.spectrum.as_ref()?.total;
        let result = if over == OverScenarios::Mean { sum / total } else { sum };
        result.is_finite().then_some(result)
    }
}
