//! What becomes of a chunk of designs over their scenarios, a scenario at a time, in vectors.

use super::{AtWorst, Column, Row, Worst};
use crate::masks::{keep_between, keep_finite, mask};
use crate::models::{Status, Worse};
use crate::plan::Plan;
use crate::study::{Constraint, Quantity};
use crate::tape::ColumnValue;
use multiversion::multiversion;

/// A lane's yes; no is 0. As wide as a number, so that one loop may have both.
const YES: u64 = u64::MAX;
/// Lanes that are looked at together: most scenarios are the worst for none of them.
const LANES: usize = 32;

/// What is known of a chunk of designs after some scenarios.
pub(super) struct FoundWorst<'p> {
    columns: &'p [Column],
    /// The quantities that every scenario must have, each once: those without a column. Of the others the first column says it.
    asked: Vec<Quantity>,
    decides: Vec<bool>,
    /// Constraints without a column of the worst value, and those with one, which says in the end whether they hold.
    held: Vec<Constraint>,
    settled: Vec<(usize, Constraint)>,
    feasible: Vec<u64>,
    without_result: Vec<u64>,
    /// The first of these scenarios; [`NEVER`] if there is none.
    first_without: Vec<u64>,
    /// The first scenario whose status is not ok, and the number of that status.
    not_ok: Vec<u64>,
    status: Vec<u16>,
    /// Of each column.
    worst: Vec<WorstLanes>,
    /// Has the scenario a result?
    has: Vec<u64>,
    /// Room for a number that all designs share.
    room: Vec<f64>,
}

const NEVER: u64 = u64::MAX;
/// Numbers of statuses; those of conditions that fail are larger.
const OK: u16 = 0;
const OVERFLOW: u16 = 1;

/// The worst of one column.
struct WorstLanes {
    /// NaN as long as there is none.
    value: Vec<f64>,
    scenario: Vec<u64>,
    complete: Vec<u64>,
    /// The scenario that was taken in last.
    last: u64,
}

impl<'p> FoundWorst<'p> {
    pub(super) fn new(plan: &'p Plan, columns: &'p [Column], count: usize) -> Self {
        let lanes = |_: &Column| WorstLanes::new(count);
        let constraints = &plan.study.constraints;
        let mut asked: Vec<Quantity> = Vec::new();
        for quantity in plan.tracked.iter().map(|(it, _)| it.quantity).chain(constraints.iter().map(|it| it.quantity)) {
            if !asked.contains(&quantity) {
                asked.push(quantity);
            }
        }
        let mut decides = vec![false; columns.len()];
        asked.retain(|&quantity| match columns.iter().position(|it| it.quantity == quantity) {
            Some(column) => {
                decides[column] = true;
                false
            }
            None => true,
        });
        let (mut held, mut settled) = (Vec::new(), Vec::new());
        for constraint in constraints {
            let nearest = Worst::Margin(*constraint);
            // Where both ends are met and one of them is excluded, two values are equally near to it, of which one holds.
            let is_telling = constraint.low.zip(constraint.high).is_none_or(|(low, high)| low.1 == high.1);
            let is_its = |it: &Column| it.quantity == constraint.quantity && (it.worst == nearest || it.worst.same(nearest));
            let is_its = |it: &Column| is_telling && is_its(it);
            match columns.iter().position(is_its) {
                Some(column) => settled.push((column, *constraint)),
                None => held.push(*constraint),
            }
        }
        Self {
            columns,
            asked,
            decides,
            held,
            settled,
            feasible: vec![YES; count],
            without_result: vec![0; count],
            first_without: vec![NEVER; count],
            not_ok: vec![NEVER; count],
            status: vec![0; count],
            worst: columns.iter().map(lanes).collect(),
            has: vec![0; count],
            room: vec![0.0; count],
        }
    }

    /// Takes in a scenario; statuses as their numbers, and each value with whether it is that of the scenario before.
    pub(super) fn take<'c>(&mut self, scenario: u64, statuses: &[u16], value: impl Fn(Quantity) -> (ColumnValue<'c>, bool)) {
        let Self { columns, asked, decides, held, feasible, without_result, first_without, not_ok, status, worst, has, room, .. } = self;
        judge(statuses, scenario, has, not_ok, status);
        for &quantity in &*asked {
            if let (ColumnValue::Each(values), _) = value(quantity) {
                keep_finite(has, values);
            }
        }
        for ((column, lanes), &decides) in columns.iter().zip(worst).zip(&*decides) {
            let values = match value(column.quantity) {
                // What was taken in with an earlier scenario changes nothing.
                (ColumnValue::Each(values), true) if lanes.last < scenario => {
                    if decides {
                        keep_finite(has, values);
                    }
                    continue;
                }
                (ColumnValue::Each(values), _) => values,
                (ColumnValue::One(value), _) => {
                    room.fill(value);
                    &*room
                }
            };
            lanes.take(column.worst, values, scenario, decides.then_some(&mut *has));
        }
        count_missing(has, scenario, without_result, first_without, feasible);
        for constraint in &*held {
            match value(constraint.quantity).0 {
                ColumnValue::Each(values) => {
                    let (low, high) = constraint.ends();
                    keep_between(feasible, values, low, high);
                }
                ColumnValue::One(value) if !constraint.holds(value) => feasible.fill(0),
                ColumnValue::One(_) => {}
            }
        }
    }

    pub(super) fn into_rows(self, first: usize, inputs: impl Fn(usize) -> Vec<f64>) -> Vec<Row> {
        let row = |lane: usize| Row {
            index: (first + lane) as u64,
            feasible: self.feasible[lane] == YES && self.settled.iter().all(|(column, it)| it.holds(self.worst[*column].value[lane])),
            without_result: self.without_result[lane],
            first_without: Some(self.first_without[lane]).filter(|&it| it != NEVER),
            status: Status::of_number(self.status[lane]),
            inputs: inputs(lane),
            columns: self.worst.iter().map(|it| it.at(lane)).collect(),
            complete: self.worst.iter().map(|it| it.complete[lane] == YES).collect(),
        };
        (0..self.feasible.len()).map(row).collect()
    }
}

impl WorstLanes {
    fn new(count: usize) -> Self {
        Self { value: vec![f64::NAN; count], scenario: vec![0; count], complete: vec![YES; count], last: NEVER }
    }

    /// Takes in the values of a scenario; `has` loses the lanes whose value is not finite, if it is given.
    fn take(&mut self, worst: Worst, values: &[f64], scenario: u64, has: Option<&mut [u64]>) {
        self.last = scenario;
        match worst {
            Worst::End(Worse::Higher) => take_highest(self, values, scenario, has),
            Worst::End(Worse::Lower) => take_lowest(self, values, scenario, has),
            Worst::Margin(constraint) => take_nearest(self, values, scenario, has, &constraint),
        }
    }

    #[inline(always)]
    fn take_by(&mut self, badness: impl Fn(f64) -> f64, values: &[f64], scenario: u64, mut has: Option<&mut [u64]>) {
        for first in (0..values.len()).step_by(LANES) {
            let lanes = first..values.len().min(first + LANES);
            let (values, kept) = (&values[lanes.clone()], &mut self.value[lanes.clone()]);
            let (since, complete) = (&mut self.scenario[lanes.clone()], &mut self.complete[lanes.clone()]);
            // The last lanes may be fewer.
            if let (Ok(values), Ok(kept), Ok(since)) = (values.try_into(), (&*kept).try_into(), (&*since).try_into())
                && all_stay(&badness, values, kept, since, scenario)
            {
                continue;
            }
            // Without a short circuit, so that lanes go side by side.
            for lane in 0..values.len() {
                let value = values[lane];
                let (this, held) = (badness(value), badness(kept[lane]));
                let is_worse = (this > held) | ((this == held) & (scenario < since[lane])) | kept[lane].is_nan();
                let takes = is_worse & !value.is_nan();
                kept[lane] = if takes { value + 0.0 } else { kept[lane] };
                since[lane] = if takes { scenario } else { since[lane] };
                complete[lane] = if value.is_nan() { 0 } else { complete[lane] };
            }
            if let Some(has) = &mut has {
                keep_finite(&mut has[lanes], values);
            }
        }
    }

    fn at(&self, lane: usize) -> AtWorst {
        let value = self.value[lane];
        AtWorst { value: (!value.is_nan()).then_some(value), scenario: self.scenario[lane] }
    }
}

/// Is every value a finite number, and none worse than what is held? Eight lanes side by side: one sum over all of them is compiled to lanes
/// one after the other.
#[inline(always)]
fn all_stay(badness: &impl Fn(f64) -> f64, values: &[f64; LANES], kept: &[f64; LANES], since: &[u64; LANES], scenario: u64) -> bool {
    const WIDTH: usize = 8;
    let mut moves = [0; WIDTH];
    for first in (0..LANES).step_by(WIDTH) {
        for (lane, moves) in moves.iter_mut().enumerate() {
            let at = first + lane;
            let (this, held) = (badness(values[at]), badness(kept[at]));
            // What is not a number is neither milder nor as bad.
            let stays = mask(this < held) | (mask(this == held) & mask(since[at] <= scenario));
            *moves |= !(stays & mask(values[at].abs() <= f64::MAX));
        }
    }
    moves == [0; WIDTH]
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn take_highest(lanes: &mut WorstLanes, values: &[f64], scenario: u64, has: Option<&mut [u64]>) {
    lanes.take_by(|value| value, values, scenario, has);
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn take_lowest(lanes: &mut WorstLanes, values: &[f64], scenario: u64, has: Option<&mut [u64]>) {
    lanes.take_by(|value| -value, values, scenario, has);
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn take_nearest(lanes: &mut WorstLanes, values: &[f64], scenario: u64, has: Option<&mut [u64]>, constraint: &Constraint) {
    // From an end that is not there every number is infinitely far.
    let low = constraint.low.map_or(f64::NEG_INFINITY, |(bound, _)| bound);
    let high = constraint.high.map_or(f64::INFINITY, |(bound, _)| bound);
    lanes.take_by(|value| -(value - low).min(high - value), values, scenario, has);
}

/// Has the scenario a result, and which is the first status that is not ok? An overflow takes a value away, and counts as a result that is
/// missing only where the value is asked for.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn judge(statuses: &[u16], scenario: u64, has: &mut [u64], not_ok: &mut [u64], first: &mut [u16]) {
    let count = statuses.len();
    let (has, not_ok, first) = (&mut has[..count], &mut not_ok[..count], &mut first[..count]);
    for lane in 0..count {
        let status = statuses[lane];
        has[lane] = if status > OVERFLOW { 0 } else { YES };
        let is_first = (status != OK) & (scenario < not_ok[lane]);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::OverScenarios;

    #[test]
    fn lanes_have_the_worst_that_each_has_alone() {
        let count = 2 * LANES + 13;
        let bounds =
            Constraint { quantity: Quantity::Input(0), low: Some((1.0, false)), high: Some((2.0, true)), over: OverScenarios::Worst };
        let kinds =
            [Worst::End(Worse::Higher), Worst::End(Worse::Lower), Worst::Margin(bounds), Worst::Margin(Constraint { low: None, ..bounds })];
        let mut seed = 3_u64;
        let mut random = |below: u64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) % below
        };
        for worst in kinds {
            let mut lanes = WorstLanes::new(count);
            let mut alone = vec![(f64::NEG_INFINITY, AtWorst { value: None, scenario: 0 }); count];
            let mut complete = vec![true; count];
            // Scenarios out of order, most of them mild; some lanes are nothing or infinite for a while.
            for step in 0..60_u64 {
                let scenario = step * 7 % 60;
                let mut value = || match random(4000) {
                    0 => f64::NAN,
                    1 => f64::INFINITY,
                    2 => f64::NEG_INFINITY,
                    3 => -0.0,
                    4..300 => 0.5 * random(8) as f64,
                    _ => 1.5,
                };
                let values: Vec<f64> = (0..count).map(|_| value()).collect();
                let mut has = vec![YES; count];
                lanes.take(worst, &values, scenario, Some(&mut has));
                for lane in 0..count {
                    let value = Some(values[lane]).filter(|it| !it.is_nan());
                    worst.take(&mut alone[lane], value, scenario);
                    complete[lane] &= value.is_some();
                    assert_eq!(has[lane] == YES, values[lane].is_finite(), "{worst:?} {scenario} {lane}");
                }
            }
            for lane in 0..count {
                let (found, wanted) = (lanes.at(lane), alone[lane].1);
                assert_eq!((found, lanes.complete[lane] == YES), (wanted, complete[lane]), "{worst:?} {lane}");
                assert_eq!(found.value.map(f64::to_bits), wanted.value.map(f64::to_bits), "{worst:?} {lane}");
            }
        }
    }
}
