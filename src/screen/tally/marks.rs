//! What the designs of a block fail at.

use super::Failures;
use super::counter::{BlockValues, Counter};
use crate::masks;
use crate::models::Set;
use crate::plan::{Plan, Source};
use crate::screen::tables::FastBlock;

/// What the designs of a block fail at in some scenario, a mask per design and failure.
pub(super) struct Marks {
    /// Where no condition has failed in the current scenario.
    pub ok: Vec<u64>,
    /// Of each lane condition, and of each constraint.
    conditions: Vec<Vec<u64>>,
    constraints: Vec<Vec<u64>>,
    overflow: Vec<u64>,
    /// Conditions that are the same for the whole row: that all designs fail at, and those whose designs are marked.
    of_all: Set,
    of_row: Vec<(usize, Vec<u64>)>,
}

impl Marks {
    pub fn new(plan: &Plan, designs: usize) -> Self {
        let none = || vec![0; designs];
        Self {
            ok: none(),
            conditions: plan.lane_conditions.iter().map(|_| none()).collect(),
            constraints: plan.constraints.iter().map(|_| none()).collect(),
            overflow: none(),
            of_all: Set::EMPTY,
            of_row: Vec::new(),
        }
    }

    /// Marks what fails in the current scenario; `of_row` is the first condition that the whole row fails at.
    pub fn scenario(&mut self, counter: &Counter<'_>, fast: &FastBlock, of_row: Option<usize>) {
        self.begin();
        self.conditions(counter, of_row);
        match of_row {
            Some(number) => self.mark_row(counter.plan.study.model.first_of_reason(number)),
            None => self.values(counter, fast, |_| true),
        }
    }

    /// Begins a scenario, in which nothing has failed yet.
    pub fn begin(&mut self) {
        self.ok.fill(u64::MAX);
    }

    /// Marks the first condition that each design fails at, of those before the one that the whole row fails at.
    pub fn conditions(&mut self, counter: &Counter<'_>, of_row: Option<usize>) {
        let (plan, engine) = (counter.plan, &counter.engine);
        // The first condition that fails is the status; what comes after it may have lost its meaning.
        let lane_margins = plan.lane_conditions.iter().zip(&engine.results[plan.lane_outputs.len()..]);
        for ((&number, margins), marks) in lane_margins.zip(&mut self.conditions) {
            if of_row.is_none_or(|of_row| number < of_row) {
                let low = if plan.study.model.conditions[number].strict { f64::from_bits(1) } else { 0.0 };
                masks::mark_outside(&mut self.ok, marks, margins, (low, f64::INFINITY));
            }
        }
    }

    /// Marks the constraints that are violated and the values that overflow, of these sources, where all conditions hold.
    pub fn values(&mut self, counter: &Counter<'_>, fast: &FastBlock, is_looked_at: impl Fn(Source) -> bool) {
        let plan = counter.plan;
        let constraints = plan.study.constraints.iter().zip(&plan.constraints).zip(&mut self.constraints);
        for ((constraint, &source), marks) in constraints.filter(|((_, source), _)| is_looked_at(**source)) {
            let ends = if constraint.over.is_worst() { constraint.ends() } else { (f64::NEG_INFINITY, f64::INFINITY) };
            match counter.values(source, fast) {
                BlockValues::Each(values) => masks::mark_violations(&self.ok, marks, &mut self.overflow, values, ends),
                BlockValues::One(value) => {
                    let marks = if value.is_finite() { marks } else { &mut self.overflow };
                    if !(value.is_finite() && ends.0 <= value && value <= ends.1) {
                        marks.iter_mut().zip(&self.ok).for_each(|(mark, ok)| *mark |= ok);
                    }
                }
            }
        }
        for &(_, source) in plan.tracked.iter().filter(|(_, source)| is_looked_at(*source)) {
            match counter.values(source, fast) {
                BlockValues::Each(values) => masks::mark_overflow(&self.ok, &mut self.overflow, values),
                BlockValues::One(value) if value.is_finite() => {}
                BlockValues::One(_) => self.overflow.iter_mut().zip(&self.ok).for_each(|(mark, ok)| *mark |= ok),
            }
        }
    }

    /// The places of the designs of which a condition has failed.
    pub fn failed(&self) -> impl Iterator<Item = usize> {
        let fails = |lane: &usize| self.conditions.iter().any(|marks| marks[*lane] != 0);
        (0..self.ok.len()).filter(fails)
    }

    /// Marks the designs that have failed at nothing before a condition that the row fails at, none of which is ok then.
    pub fn mark_row(&mut self, number: usize) {
        if !self.of_all.contains(number) {
            self.mark_row_anew(number);
        }
        self.ok.fill(0);
    }

    fn mark_row_anew(&mut self, number: usize) {
        if self.ok.iter().all(|ok| *ok != 0) {
            return self.of_all.insert(number);
        }
        let place = self.of_row.iter().position(|(it, _)| *it == number).unwrap_or_else(|| {
            self.of_row.push((number, vec![0; self.ok.len()]));
            self.of_row.len() - 1
        });
        self.of_row[place].1.iter_mut().zip(&self.ok).for_each(|(mark, ok)| *mark |= ok);
    }

    /// Adds what is marked to the designs' failures.
    pub fn add_to(&self, plan: &Plan, failures: &mut [Failures]) {
        for (lane, failures) in failures.iter_mut().enumerate() {
            failures.overflow |= self.overflow[lane] != 0;
            failures.conditions |= self.of_all;
            for (&number, marks) in plan.lane_conditions.iter().zip(&self.conditions) {
                if marks[lane] != 0 {
                    failures.conditions.insert(plan.study.model.first_of_reason(number));
                }
            }
            for (number, marks) in &self.of_row {
                if marks[lane] != 0 {
                    failures.conditions.insert(*number);
                }
            }
            for (number, marks) in self.constraints.iter().enumerate() {
                if marks[lane] != 0 {
                    failures.constraints.insert(number);
                }
            }
        }
    }
}
