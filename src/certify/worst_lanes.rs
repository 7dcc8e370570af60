//! What becomes of a chunk of designs over their scenarios, a scenario at a time, in vectors.

use super::{AtWorst, Column, Row, Worst};
use crate::masks::{keep_between, keep_finite};
use crate::models::{Status, Worse};
use crate::plan::Plan;
use crate::study::{Constraint, Quantity};
use crate::tape::ColumnValue;
use multiversion::multiversion;

/// A lane's yes; no is 0. As wide as a number, so that one loop may have both.
const YES: u64 = u64::MAX;

/// What is known of a chunk of designs after some scenarios.
pub(super) struct FoundWorst<'p> {
    plan: &'p Plan,
    columns: &'p [Column],
    /// The quantities that every scenario must have, each once.
    asked: Vec<Quantity>,
    feasible: Vec<u64>,
    without_result: Vec<u64>,
    /// The first of these scenarios; [`NEVER`] if there is none.
    first_without: Vec<u64>,
    /// The first scenario whose status is not ok, and that status.
    not_ok: Vec<u64>,
    status: Vec<Status>,
    /// Of each column.
    worst: Vec<WorstLanes>,
    /// Has the scenario a result?
    has: Vec<u64>,
    /// Room for a number that all designs share.
    room: Vec<f64>,
}

const NEVER: u64 = u64::MAX;

/// The worst of one column.
struct WorstLanes {
    badness: Vec<f64>,
    /// NaN as long as there is none.
    value: Vec<f64>,
    scenario: Vec<u64>,
    complete: Vec<u64>,
}

impl<'p> FoundWorst<'p> {
    pub(super) fn new(plan: &'p Plan, columns: &'p [Column], count: usize) -> Self {
        let lanes = |_: &Column| WorstLanes {
            badness: vec![f64::NEG_INFINITY; count],
            value: vec![f64::NAN; count],
            scenario: vec![0; count],
            complete: vec![YES; count],
        };
        let mut asked: Vec<Quantity> = Vec::new();
        let tracked = plan.tracked.iter().map(|(it, _)| it.quantity);
        for quantity in tracked.chain(plan.study.constraints.iter().map(|it| it.quantity)) {
            if !asked.contains(&quantity) {
                asked.push(quantity);
            }
        }
        Self {
            plan,
            columns,
            asked,
            feasible: vec![YES; count],
            without_result: vec![0; count],
            first_without: vec![NEVER; count],
            not_ok: vec![NEVER; count],
            status: vec![Status::Ok; count],
            worst: columns.iter().map(lanes).collect(),
            has: vec![0; count],
            room: vec![0.0; count],
        }
    }

    /// Takes in a scenario.
    pub(super) fn take<'c>(&mut self, scenario: u64, statuses: &[Status], value: impl Fn(Quantity) -> ColumnValue<'c>) {
        let Self { plan, columns, asked, feasible, without_result, first_without, not_ok, status, worst, has, room } = self;
        judge(statuses, scenario, has, not_ok, status);
        for &quantity in &*asked {
            if let ColumnValue::Each(values) = value(quantity) {
                keep_finite(has, values);
            }
        }
        count_missing(has, scenario, without_result, first_without, feasible);
        for constraint in &plan.study.constraints {
            match value(constraint.quantity) {
                ColumnValue::Each(values) => {
                    let (low, high) = constraint.ends();
                    keep_between(feasible, values, low, high);
                }
                ColumnValue::One(value) if !constraint.holds(value) => feasible.fill(0),
                ColumnValue::One(_) => {}
            }
        }
        for (column, lanes) in columns.iter().zip(worst) {
            let values = match value(column.quantity) {
                ColumnValue::Each(values) => values,
                ColumnValue::One(value) => {
                    room.fill(value);
                    &*room
                }
            };
            lanes.take(column.worst, values, scenario);
        }
    }

    pub(super) fn into_rows(self, first: usize, inputs: impl Fn(usize) -> Vec<f64>) -> Vec<Row> {
        let row = |lane: usize| Row {
            index: (first + lane) as u64,
            feasible: self.feasible[lane] == YES,
            without_result: self.without_result[lane],
            first_without: Some(self.first_without[lane]).filter(|&it| it != NEVER),
            status: self.status[lane],
            inputs: inputs(lane),
            columns: self.worst.iter().map(|it| it.at(lane)).collect(),
            complete: self.worst.iter().map(|it| it.complete[lane] == YES).collect(),
        };
        (0..self.feasible.len()).map(row).collect()
    }
}

impl WorstLanes {
    fn take(&mut self, worst: Worst, values: &[f64], scenario: u64) {
        match worst {
            Worst::End(Worse::Higher) => take_highest(self, values, scenario),
            Worst::End(Worse::Lower) => take_lowest(self, values, scenario),
            Worst::Margin(constraint) => take_nearest(self, values, scenario, &constraint),
        }
    }

    #[inline(always)]
    fn take_by(&mut self, badness: impl Fn(f64) -> f64, values: &[f64], scenario: u64) {
        let count = values.len();
        let (held, kept) = (&mut self.badness[..count], &mut self.value[..count]);
        let (since, complete) = (&mut self.scenario[..count], &mut self.complete[..count]);
        for lane in 0..count {
            let value = values[lane];
            let this = badness(value);
            // Without a short circuit, so that lanes go side by side.
            let is_worse = (this > held[lane]) | ((this == held[lane]) & (scenario < since[lane])) | kept[lane].is_nan();
            let takes = is_worse & !value.is_nan();
            held[lane] = if takes { this } else { held[lane] };
            kept[lane] = if takes { value + 0.0 } else { kept[lane] };
            since[lane] = if takes { scenario } else { since[lane] };
            complete[lane] = if value.is_nan() { 0 } else { complete[lane] };
        }
    }

    fn at(&self, lane: usize) -> AtWorst {
        let value = self.value[lane];
        AtWorst { value: (!value.is_nan()).then_some(value), scenario: self.scenario[lane] }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn take_highest(lanes: &mut WorstLanes, values: &[f64], scenario: u64) {
    lanes.take_by(|value| value, values, scenario);
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn take_lowest(lanes: &mut WorstLanes, values: &[f64], scenario: u64) {
    lanes.take_by(|value| -value, values, scenario);
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn take_nearest(lanes: &mut WorstLanes, values: &[f64], scenario: u64, constraint: &Constraint) {
    // From an end that is not there every number is infinitely far.
    let low = constraint.low.map_or(f64::NEG_INFINITY, |(bound, _)| bound);
    let high = constraint.high.map_or(f64::INFINITY, |(bound, _)| bound);
    lanes.take_by(|value| -(value - low).min(high - value), values, scenario);
}

/// Has the scenario a result, and which is the first status that is not ok? An overflow takes a value away, and counts as a result that is
/// missing only where the value is asked for.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn judge(statuses: &[Status], scenario: u64, has: &mut [u64], not_ok: &mut [u64], first: &mut [Status]) {
    let count = statuses.len();
    let (has, not_ok, first) = (&mut has[..count], &mut not_ok[..count], &mut first[..count]);
    for lane in 0..count {
        let status = statuses[lane];
        has[lane] = if matches!(status, Status::Failed(_)) { 0 } else { YES };
        let is_first = (status != Status::Ok) & (scenario < not_ok[lane]);
        not_ok[lane] = if is_first { scenario } else { not_ok[lane] };
        first[lane] = if is_first { status } else { first[lane] };
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn count_missing(has: &[u64], scenario: u64, missing: &mut [u64], first: &mut [u64], feasible: &mut [u64]) {
    let count = has.len();
    let (missing, first, feasible) = (&mut missing[..count], &mut first[..count], &mut feasible[..count]);
    for lane in 0..count {
        missing[lane] += !has[lane] & 1;
        let earlier = if scenario < first[lane] { scenario } else { first[lane] };
        first[lane] = if has[lane] == 0 { earlier } else { first[lane] };
        feasible[lane] &= has[lane];
    }
}
