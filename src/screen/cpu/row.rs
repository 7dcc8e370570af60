//! Entering a row: its inputs, what its scenarios have prepared, and the judgement of what is the same for all its designs.

use super::CpuEngine;
use crate::decision::Decision;
use crate::models::{self, Worse};
use crate::plan::{Plan, Source};
use crate::screen::tables::{Setting, setting};
use crate::space::Product;
use std::ops::Range;

impl CpuEngine<'_> {
    /// Sets the inputs of a row, prepares its scenarios and judges what is the same for all its designs; false if it was stopped.
    pub(in crate::screen) fn enter_row(&mut self, row: u64) -> bool {
        if self.row == Some(row) {
            return true;
        }
        self.set_row(row);
        self.row = Some(row);
        self.row_feasible = true;
        for (worst, (tracked, _)) in self.row_worst.iter_mut().zip(&self.plan.tracked) {
            *worst = tracked.worse.least_bad();
        }
        self.begin_scenarios();
        let mut scenarios = 0;
        let done = self.each_scenario(|engine, prepared, _, _| {
            engine.row_feasible &= engine.judge_row_scenario(prepared.clone());
            if engine.row_feasible {
                engine.add_scenario(prepared);
                scenarios += 1;
            }
            engine.row_feasible
        });
        if !done {
            self.row = None;
        } else if self.row_feasible {
            self.settle_scenarios(scenarios, self.ahead);
        }
        done
    }

    /// The scenarios that decide about the designs of a row, each as its slow one times the number of fast ones plus its fast one; `None`
    /// where the row is infeasible or all may decide.
    #[cfg(feature = "gpu")]
    pub(in crate::screen) fn decisive_scenarios(&mut self, row: u64) -> Option<Vec<u32>> {
        self.ahead = self.plan.fast.count();
        let is_feasible = self.enter_row(row) && self.row_feasible;
        let (_, decisive) = self.numbers.as_ref().filter(|_| is_feasible)?;
        Some(decisive.kept().iter().map(|&scenario| scenario as u32).collect())
    }

    /// Begins to look for the scenarios that decide about a row's designs; false where that cannot be done.
    pub(in crate::screen) fn begin_scenarios(&mut self) -> bool {
        self.numbers.as_mut().is_some_and(|(_, decisive)| {
            decisive.begin();
            true
        })
    }

    /// Finds which of the scenarios that were added decide about so many designs, and returns how many these are.
    pub(in crate::screen) fn settle_scenarios(&mut self, added: usize, designs: u64) -> usize {
        let (Some((_, decisive)), Some(list)) = (&mut self.numbers, &self.tables.lanes) else { return 0 };
        decisive.settle(list, added, designs);
        decisive.count()
    }

    /// Keeps what the designs of the row need of the current scenario.
    pub(in crate::screen) fn add_scenario(&mut self, prepared: Range<usize>) {
        self.enter_scenario(prepared);
        if let (Some((numbers, decisive)), Some(list)) = (&mut self.numbers, &self.tables.lanes) {
            decisive.add(numbers.scalars(list));
        }
    }

    /// Computes what the inner loop reads of the current row and scenario, where it is a list.
    pub(super) fn enter_scenario(&mut self, prepared: Range<usize>) {
        let is_listed = self.is_listed;
        let (Some((numbers, _)), Some(list)) = (&mut self.numbers, &self.tables.lanes) else { return };
        match (&self.row_numbers, &self.tables.rows) {
            (Some(of_row), Some(rows)) if is_listed => of_row.enter(rows, self.scenario, list, numbers),
            _ => list.enter(numbers, &self.prepared[prepared], &self.si),
        }
    }

    /// Turns to one scenario after the other, as long as `judge` wants to go on; false if it was stopped before that. `judge` is told
    /// where the prepared numbers stand, whether the scenario is the first, and whether it is the last with these numbers.
    pub(super) fn each_scenario(&mut self, mut judge: impl FnMut(&mut Self, Range<usize>, bool, bool) -> bool) -> bool {
        let (slow, fast) = (self.plan.slow_scenarios.count(), self.plan.fast_scenarios.count());
        if self.chosen.is_empty() {
            for q in 0..slow {
                let prepared = self.prepare(q);
                for t in 0..fast {
                    if self.stopped() {
                        return false;
                    }
                    self.set_fast_scenario(t);
                    if !judge(self, prepared.clone(), q == 0 && t == 0, t + 1 == fast) {
                        return true;
                    }
                }
            }
            return true;
        }
        let chosen = std::mem::take(&mut self.chosen);
        let mut goes_on = true;
        for (at, part) in chosen.chunk_by(|a, b| a.0 == b.0).enumerate() {
            // What is kept is always that of the first scenarios: these find room beside it.
            let prepared = self.prepare_at(part[0].0, self.room);
            for (number, &(_, t)) in part.iter().enumerate() {
                self.set_fast_scenario(t);
                goes_on = goes_on && judge(self, prepared.clone(), at == 0 && number == 0, number + 1 == part.len());
            }
            if !goes_on || self.stopped() {
                break;
            }
        }
        self.chosen = chosen;
        !self.stopped()
    }

    pub(in crate::screen) fn set_row(&mut self, row: u64) {
        // What a part of the formula does not depend on may still decide a selection the same way for every value of its axis:
        // every input must have one of its own values, not the default.
        let mut before = std::mem::take(&mut self.before);
        before.clone_from(&self.own);
        self.own.copy_from_slice(&self.first);
        self.plan.slow.set(row, &mut self.own);
        models::fill_si(&self.plan.study.model, &self.own, &mut self.si);
        self.row_index = self.plan.slow.source_index(row);
        self.kept_rows.turn(&before, &self.own);
        // The outer of the axes that the first stage does not read is walked with the slow ones: rows along it share what is prepared.
        if (0..self.own.len()).any(|input| self.slow_reads.contains(input) && self.own[input] != before[input]) {
            self.kept = 0;
        }
        self.before = before;
        self.is_listed = false;
        let can_be_listed = self.numbers.is_some() || self.results.is_empty();
        if let (Some(rows), Some(numbers), true) = (&self.tables.rows, &mut self.row_numbers, can_be_listed) {
            // Numbers of several rows do not pay where only some of them are asked for.
            let follows = self.last_row.is_some_and(|last| row == last + 1);
            if follows || numbers.holds(rows, row) || !rows.has_rows() {
                numbers.turn(rows, self.tables.lanes.as_ref(), row, &self.si);
                self.is_listed = true;
            }
        }
        self.last_row = Some(row);
    }

    /// Conditions, constraints and worst values of a row in the current scenario; false if the whole row is out.
    fn judge_row_scenario(&mut self, prepared: Range<usize>) -> bool {
        let plan = self.plan;
        self.row_values(prepared);
        if !judge_row_values(plan, &self.own, &self.row_margins, &self.row_outputs, &mut self.row_worst) {
            return false;
        }
        let value = |source| row_value(plan, source, &self.own, &self.row_outputs);
        self.row_sums.judge_row(plan, self.scenario, value, &mut self.row_worst)
    }

    /// Computes condition margins and row outputs in the current scenario.
    pub(in crate::screen) fn row_values(&mut self, prepared: Range<usize>) {
        if let (Some(rows), Some(numbers), true) = (&self.tables.rows, &self.row_numbers, self.is_listed) {
            return numbers.recall(rows, self.scenario, &mut self.row_margins, &mut self.row_outputs);
        }
        if self.kept_rows.recall(self.scenario, &mut self.row_margins, &mut self.row_outputs) {
            return;
        }
        let kernel = &self.plan.study.model.kernel;
        let prepared = &self.prepared[prepared];
        // What is not asked for is not computed: of drawn drives the conditions of one design take as long as its draws.
        let (plan, si, outputs, margins) = (self.plan, &self.si, &mut self.row_outputs, &mut self.row_margins);
        match (plan.row_outputs.is_empty(), plan.row_conditions.is_empty()) {
            (false, false) => kernel.finish_with_conditions(prepared, si, plan.row_outputs, outputs, margins),
            (false, true) => kernel.finish(prepared, si, plan.row_outputs, outputs),
            (true, false) => kernel.conditions(prepared, si, margins),
            (true, true) => {}
        }
        self.kept_rows.keep(self.scenario, &self.row_margins, &self.row_outputs);
    }

    /// Where the row's prepared numbers of slow scenario `q` stand; its inputs become the current ones. A row asks for its
    /// scenarios in order, so that what is kept is always the first ones.
    pub(in crate::screen) fn prepare(&mut self, q: u64) -> Range<usize> {
        if q >= self.kept && !self.is_listed {
            let place = self.prepare_at(q, q.min(self.room));
            self.kept = self.kept.max((q + 1).min(self.room));
            return place;
        }
        self.set_slow_scenario(q);
        // Nobody reads the place of a row whose numbers are listed.
        self.place(q.min(self.room))
    }

    /// Prepares a slow scenario at some place.
    fn prepare_at(&mut self, q: u64, at: u64) -> Range<usize> {
        self.set_slow_scenario(q);
        let place = self.place(at);
        if !self.is_listed {
            self.latest.prepare(&self.si, self.wanted, &mut self.prepared[place.clone()]);
        }
        place
    }

    fn place(&self, at: u64) -> Range<usize> {
        let at = at as usize * self.width;
        at..at + self.width
    }

    fn set_slow_scenario(&mut self, q: u64) {
        self.scenario.0 = q;
        let tables = self.tables;
        self.apply(tables.slow_scenarios.get(usize::try_from(q).unwrap_or(usize::MAX)), &self.plan.slow_scenarios, q);
    }

    pub(in crate::screen) fn set_fast_scenario(&mut self, t: u64) {
        self.scenario.1 = t;
        let tables = self.tables;
        self.apply(tables.fast_scenarios.get(usize::try_from(t).unwrap_or(usize::MAX)), &self.plan.fast_scenarios, t);
    }

    fn apply(&mut self, kept: Option<&Setting>, product: &Product, index: u64) {
        let made;
        let setting = match kept {
            Some(setting) => setting,
            None => {
                made = setting(self.plan, product, index);
                &made
            }
        };
        for &(input, own, si) in setting {
            self.own[input] = own;
            self.si[input] = si;
        }
    }
}

/// Does a condition hold? In f64 the answer is never unsure.
pub(in crate::screen) fn holds(plan: &Plan, condition: usize, margin: f64) -> bool {
    models::holds(&plan.study.model, condition, margin, 0.0) == Decision::Yes
}

/// Conditions, constraints and worst values of a row, given its inputs, margins and outputs in a scenario; false if the whole row is out.
pub(super) fn judge_row_values(plan: &Plan, own: &[f64], margins: &[f64], outputs: &[f64], worst: &mut [f64]) -> bool {
    if !plan.row_conditions.iter().all(|&number| holds(plan, number, margins[number])) {
        return false;
    }
    let value = |source| row_value(plan, source, own, outputs);
    let constraints = plan.study.constraints.iter().zip(&plan.constraints);
    if !constraints.filter(|(it, source)| source.is_row() && it.over.is_worst()).all(|(constraint, &source)| {
        let value = value(source);
        value.is_finite() && constraint.holds(value)
    }) {
        return false;
    }
    for ((tracked, source), worst) in plan.tracked.iter().zip(worst) {
        if source.is_row() && tracked.over.is_worst() {
            let value = value(*source);
            if !value.is_finite() {
                return false;
            }
            *worst = worse_of(tracked.worse, *worst, value);
        }
    }
    true
}

/// A value that is the same for the whole row, in its unit.
pub(in crate::screen) fn row_value(plan: &Plan, source: Source, own: &[f64], outputs: &[f64]) -> f64 {
    match source {
        Source::RowInput(input) => own[input],
        Source::RowOutput(output) => plan.study.model.outputs[output].unit.from_si(outputs[output]),
        Source::LaneInput(_) | Source::LaneOutput(_) => unreachable!("asked for row sources only"),
    }
}

pub(in crate::screen) fn worse_of(worse: Worse, a: f64, b: f64) -> f64 {
    match worse {
        Worse::Higher => a.max(b),
        Worse::Lower => a.min(b),
    }
}
