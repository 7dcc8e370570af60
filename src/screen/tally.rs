//! Why designs are not feasible: a count per status and constraint over a fixed sample of the designs.
//!
//! A sweep gives up on a design at the first thing that is wrong with it, so what limits feasibility is counted on a sample of
//! its own, in f64 and to the end: stratified design indices, as many as the model says (all designs if fewer), the same whatever ran
//! the sweep.

use super::Control;
use super::cpu::{CpuEngine, holds, row_value, worse_of};
use super::judged::JudgedDesigns;
use super::spectrum::CaseSums;
use super::tables::{BLOCK, FastBlock, Tables};
use crate::error::{Error, Result};
use crate::masks;
use crate::models::Set;
use crate::parallel::one_after_another;
use crate::plan::{Plan, Source, Tracked, worst_end};
use crate::sample::mix;
use crate::study::Study;
use serde::{Deserialize, Serialize};
use std::sync::atomic::Ordering;

/// Counts over the sample. A design may fail in several ways and counts in each.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// Designs in the sample.
    pub sampled: u64,
    /// Of these, feasible.
    pub feasible: u64,
    /// Per condition of the model: designs whose status it is in some scenario. Conditions of one reason count as the first of them.
    pub conditions: Vec<u64>,
    /// Designs of which a value that the study asks for is beyond what f64 holds in some scenario.
    pub overflow: u64,
    /// Per constraint of the study: designs that violate it in some scenario in which they have a meaning.
    pub constraints: Vec<u64>,
    /// Per constraint: designs that would be feasible but for it.
    pub only: Vec<u64>,
    /// Per tracked quantity: least and largest worst value of the sample's feasible designs.
    pub ranges: Vec<Option<(f64, f64)>>,
}

/// What a design fails at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Failures {
    /// Conditions of the model.
    conditions: Set,
    /// Constraints of the study: a study has no more than fit.
    constraints: Set,
    /// A value that the study asks for is beyond what f64 holds.
    overflow: bool,
}

impl Failures {
    const NONE: Self = Self { conditions: Set::EMPTY, constraints: Set::EMPTY, overflow: false };
}

impl Tally {
    /// Counts the sample of a plan.
    pub fn new(plan: &Plan, tables: &Tables, threads: usize) -> Self {
        Self::count(plan, tables, threads, &Control::default()).0
    }

    /// The same, seen and stopped by others.
    ///
    /// # Errors
    /// [`Error::Stopped`] after `control.stop`.
    pub fn watched(plan: &Plan, tables: &Tables, threads: usize, control: &Control) -> Result<Self> {
        Ok(Self::with_judged(plan, tables, threads, control)?.0)
    }

    /// The same with the designs of the sample, where they are worth keeping for [`Tables::take_over`].
    ///
    /// # Errors
    /// [`Error::Stopped`] after `control.stop`.
    pub fn with_judged(plan: &Plan, tables: &Tables, threads: usize, control: &Control) -> Result<(Self, JudgedDesigns)> {
        let counted = Self::count(plan, tables, threads, control);
        if control.stop.load(Ordering::Relaxed) {
            return Err(Error::Stopped { kept: None });
        }
        Ok(counted)
    }

    fn count(plan: &Plan, tables: &Tables, threads: usize, control: &Control) -> (Self, JudgedDesigns) {
        let indices = sample(plan.designs(), plan.study.model.sample);
        let mut positions: Vec<u64> = indices.map(|design| plan.position_of(design)).collect();
        // In the order of the sweep neighbours share what is prepared.
        positions.sort_unstable();
        control.sample.store(positions.len() as u64, Ordering::Relaxed);
        let begin = || Counter::new(plan, tables, control);
        let parts = one_after_another(plan.parts(&positions, threads), threads, begin, Counter::count);
        parts.into_iter().fold((Self::empty(plan), JudgedDesigns::new(plan)), |(tally, mut judged), (of_part, judged_there)| {
            judged.append(judged_there);
            (tally.merge(of_part), judged)
        })
    }

    /// The range of every histogram of the study: as given, else what the sample's feasible designs cover.
    pub fn histogram_ranges(&self, plan: &Plan) -> Vec<(f64, f64)> {
        let automatic = |of| {
            let wanted = Tracked::worst(of, worst_end(&plan.study, of));
            let column = plan.tracked.iter().position(|(it, _)| *it == wanted).expect("the plan tracks what histograms are of");
            match self.ranges[column] {
                Some((low, high)) if low < high => (low, high),
                // One value needs a bin around it; without a feasible design any range will do.
                Some((value, _)) => {
                    let half = value.abs().max(1.0) / 2.0;
                    ((value - half).max(f64::MIN), (value + half).min(f64::MAX))
                }
                None => (0.0, 1.0),
            }
        };
        plan.study.report.histograms.iter().map(|it| it.range.unwrap_or_else(|| automatic(it.of))).collect()
    }

    /// Before the first design of the sample.
    pub fn empty(plan: &Plan) -> Self {
        let constraints = plan.constraints.len();
        Self {
            sampled: 0,
            feasible: 0,
            conditions: vec![0; plan.study.model.conditions.len()],
            overflow: 0,
            constraints: vec![0; constraints],
            only: vec![0; constraints],
            ranges: vec![None; plan.tracked.len()],
        }
    }

    /// How many designs have each status in some scenario, by its reason. Both ends of an input's valid range have the same. Of a study with
    /// distributions also how many lack a statistic that the study asks for, where there are such.
    pub fn statuses<'s>(&self, study: &'s Study) -> Vec<(&'s str, u64)> {
        let model = &study.model;
        let counted = model.conditions.iter().zip(&self.conditions).enumerate();
        let is_told = |number: usize, quiet: bool, count: u64| {
            model.first_of_reason(number) == number && (!quiet || (study.probability.is_some() && count > 0))
        };
        counted.filter(|&(number, (it, &count))| is_told(number, it.quiet, count)).map(|(_, (it, &count))| (&*it.reason, count)).collect()
    }

    fn merge(mut self, other: Self) -> Self {
        let add = |to: &mut [u64], from: &[u64]| to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
        self.sampled += other.sampled;
        self.feasible += other.feasible;
        self.overflow += other.overflow;
        add(&mut self.conditions, &other.conditions);
        add(&mut self.constraints, &other.constraints);
        add(&mut self.only, &other.only);
        for (to, from) in self.ranges.iter_mut().zip(other.ranges) {
            *to = match (*to, from) {
                (Some((a, b)), Some((c, d))) => Some((a.min(c), b.max(d))),
                (either, None) | (None, either) => either,
            };
        }
        self
    }

    fn count_design(&mut self, failures: Failures) {
        self.sampled += 1;
        self.feasible += u64::from(failures == Failures::NONE);
        self.overflow += u64::from(failures.overflow);
        for (number, count) in self.conditions.iter_mut().enumerate() {
            *count += u64::from(failures.conditions.contains(number));
        }
        for (number, (count, only)) in self.constraints.iter_mut().zip(&mut self.only).enumerate() {
            *count += u64::from(failures.constraints.contains(number));
            *only += u64::from(failures == Failures { constraints: Set::one(number), ..Failures::NONE });
        }
    }
}

/// The design indices of the sample: one in each of `most` equal strata.
pub(crate) fn sample(designs: u64, most: u64) -> impl Iterator<Item = u64> {
    let strata = designs.min(most);
    let edge = move |stratum: u64| (u128::from(designs) * u128::from(stratum) / u128::from(strata)) as u64;
    (0..strata).map(move |stratum| {
        let (first, next) = (edge(stratum), edge(stratum + 1));
        first + mix(stratum) % (next - first)
    })
}

/// What the designs of a block fail at in some scenario, a mask per design and failure.
struct Marks {
    /// Where no condition has failed in the current scenario.
    ok: Vec<u64>,
    /// Of each lane condition, and of each constraint.
    conditions: Vec<Vec<u64>>,
    constraints: Vec<Vec<u64>>,
    overflow: Vec<u64>,
    /// Conditions that are the same for the whole row: that all designs fail at, and those whose designs are marked.
    of_all: Set,
    of_row: Vec<(usize, Vec<u64>)>,
}

impl Marks {
    fn new(plan: &Plan, designs: usize) -> Self {
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
    fn scenario(&mut self, counter: &Counter<'_>, fast: &FastBlock, of_row: Option<usize>) {
        let (plan, engine) = (counter.plan, &counter.engine);
        self.ok.fill(u64::MAX);
        // The first condition that fails is the status; what comes after it may have lost its meaning.
        let lane_margins = plan.lane_conditions.iter().zip(&engine.results[plan.lane_outputs.len()..]);
        for ((&number, margins), marks) in lane_margins.zip(&mut self.conditions) {
            if of_row.is_none_or(|of_row| number < of_row) {
                let low = if plan.study.model.conditions[number].strict { f64::from_bits(1) } else { 0.0 };
                masks::mark_outside(&mut self.ok, marks, margins, (low, f64::INFINITY));
            }
        }
        if let Some(number) = of_row {
            self.mark_row(plan.study.model.first_of_reason(number));
            return self.ok.fill(0);
        }
        for ((constraint, &source), marks) in plan.study.constraints.iter().zip(&plan.constraints).zip(&mut self.constraints) {
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
        for &(_, source) in &plan.tracked {
            match counter.values(source, fast) {
                BlockValues::Each(values) => masks::mark_overflow(&self.ok, &mut self.overflow, values),
                BlockValues::One(value) if value.is_finite() => {}
                BlockValues::One(_) => self.overflow.iter_mut().zip(&self.ok).for_each(|(mark, ok)| *mark |= ok),
            }
        }
    }

    /// Marks the designs that have failed at nothing before the row's condition.
    fn mark_row(&mut self, number: usize) {
        if self.of_all.contains(number) {
            return;
        }
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
    fn add_to(&self, plan: &Plan, failures: &mut [Failures]) {
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

/// What a quantity is over a block in the current scenario.
enum BlockValues<'a> {
    One(f64),
    Each(&'a [f64]),
}

/// One thread's share of the counting.
struct Counter<'p> {
    plan: &'p Plan,
    engine: CpuEngine<'p>,
    tables: &'p Tables,
    control: &'p Control,
    tally: Tally,
    /// Designs that have been judged, if they are kept.
    judged: Option<JudgedDesigns>,
}

impl<'p> Counter<'p> {
    fn new(plan: &'p Plan, tables: &'p Tables, control: &'p Control) -> Self {
        Self {
            plan,
            tables,
            engine: CpuEngine::new(plan, tables).stopping_on(&control.stop).with_all_values(),
            control,
            tally: Tally::empty(plan),
            // Designs that are judged together are judged quicker than one by one.
            judged: (JudgedDesigns::are_kept(plan) && !tables.has_rows_together()).then(|| JudgedDesigns::new(plan)),
        }
    }

    /// Counts some designs of the sample.
    fn count(&mut self, positions: &[u64]) -> (Tally, JudgedDesigns) {
        let width = self.plan.fast.count();
        'sample: for row in positions.chunk_by(|a, b| a / width == b / width) {
            for block in row.chunks(BLOCK) {
                let fast: Vec<u64> = block.iter().map(|position| position % width).collect();
                if self.engine.stopped() || !self.count_block(block[0] / width, &fast) {
                    break 'sample;
                }
                self.control.sampled.fetch_add(block.len() as u64, Ordering::Relaxed);
                // Here the sample does the work of the sweep: the progress bar follows it.
                if self.judged.is_some() && self.control.sample.load(Ordering::Relaxed) == self.plan.designs() {
                    self.control.done.fetch_add(block.len() as u64, Ordering::Relaxed);
                }
            }
        }
        let judged = self.judged.as_mut().map(|it| std::mem::replace(it, JudgedDesigns::new(self.plan)));
        (std::mem::replace(&mut self.tally, Tally::empty(self.plan)), judged.unwrap_or_default())
    }

    /// Counts designs of one row, at most [`BLOCK`]; false if it was stopped.
    fn count_block(&mut self, row: u64, designs: &[u64]) -> bool {
        let plan = self.plan;
        let fast = FastBlock::new(plan, self.tables.lanes.as_ref(), designs.iter().copied());
        let mut failures = vec![Failures::NONE; designs.len()];
        let mut marks = Marks::new(plan, designs.len());
        let mut sums = CaseSums::new(plan, designs.len());
        // Worst values that are sums over cases are found by judging the feasible designs once more.
        let mut worst = vec![vec![0.0; designs.len()]; plan.tracked.len()];
        self.engine.set_row(row);
        for q in 0..plan.slow_scenarios.count() {
            let prepared = self.engine.prepare(q);
            for t in 0..plan.fast_scenarios.count() {
                if self.engine.stopped() {
                    return false;
                }
                self.engine.set_fast_scenario(t);
                self.engine.row_values(prepared.clone());
                let failed = plan.row_conditions.iter().filter(|&&number| !holds(plan, number, self.engine.row_margins[number]));
                let of_row = failed.min().copied();
                self.engine.evaluate(prepared.clone(), &fast);
                marks.scenario(self, &fast, of_row);
                let mut has_failed = Vec::new();
                if plan.spectrum.is_some() {
                    // Whether a sum has a meaning depends on what has failed before.
                    marks.add_to(plan, &mut failures);
                    has_failed.extend(marks.ok.iter().map(|ok| *ok == 0));
                }
                self.sum(&mut sums, (q, t), &fast, &has_failed, &mut failures);
                if plan.spectrum.is_none() {
                    self.worsen(&mut worst, q == 0 && t == 0, &fast);
                }
            }
        }
        marks.add_to(plan, &mut failures);
        for &failures in &failures {
            self.tally.count_design(failures);
        }
        let is_feasible = || failures.iter().map(|&it| it == Failures::NONE);
        if is_feasible().any(|it| it) {
            if plan.spectrum.is_some() && !self.worst_sums(row, &fast, &mut worst) {
                return false;
            }
            stretch(&mut self.tally.ranges, &failures, &worst);
        }
        if let Some(judged) = &mut self.judged {
            let first = row * plan.fast.count();
            judged.add(designs.iter().map(|design| first + design), is_feasible(), &worst);
        }
        true
    }

    /// Takes the values of the current scenario into the worst ones of the block.
    fn worsen(&self, worst: &mut [Vec<f64>], is_first: bool, fast: &FastBlock) {
        for (worst, &(tracked, source)) in worst.iter_mut().zip(&self.plan.tracked) {
            let count = worst.len();
            match source {
                Source::LaneOutput(position) => {
                    let output = &self.engine.results[position][..count];
                    masks::worsen(tracked.worse, is_first, worst, output);
                }
                Source::LaneInput(input) => worst.copy_from_slice(&fast.own(input)[..count]),
                Source::RowInput(_) | Source::RowOutput(_) => {
                    let value = row_value(self.plan, source, &self.engine.own, &self.engine.row_outputs);
                    let of = |before: f64| worse_of(tracked.worse, if is_first { tracked.worse.least_bad() } else { before }, value);
                    worst.iter_mut().for_each(|worst| *worst = of(*worst));
                }
            }
        }
    }

    /// The values of the designs in the current scenario.
    fn values<'a>(&'a self, source: Source, fast: &'a FastBlock) -> BlockValues<'a> {
        match source {
            Source::LaneInput(input) => BlockValues::Each(fast.own(input)),
            Source::LaneOutput(position) => BlockValues::Each(&self.engine.results[position]),
            Source::RowInput(_) | Source::RowOutput(_) => {
                BlockValues::One(row_value(self.plan, source, &self.engine.own, &self.engine.row_outputs))
            }
        }
    }

    /// The value of a design in the current scenario.
    fn value(&self, source: Source, lane: usize, fast: &FastBlock) -> f64 {
        match source {
            Source::LaneInput(input) => fast.own(input)[lane],
            Source::LaneOutput(position) => self.engine.results[position][lane],
            Source::RowInput(_) | Source::RowOutput(_) => row_value(self.plan, source, &self.engine.own, &self.engine.row_outputs),
        }
    }

    /// Adds the current scenario to the sums over the cases of a spectrum. After the last case, adds the constraints on sums that are
    /// violated, and whether a sum is beyond what f64 holds. A sum with a case that has failed has no meaning: it is NaN.
    fn sum(&self, sums: &mut CaseSums, scenario: (u64, u64), fast: &FastBlock, has_failed: &[bool], failures: &mut [Failures]) {
        let Some(spectrum) = &self.plan.spectrum else { return };
        let place = spectrum.place(scenario);
        for (number, &source) in spectrum.sums.iter().enumerate() {
            let value = |lane: usize| {
                let value = self.value(source, lane, fast);
                if has_failed[lane] || !value.is_finite() { f64::NAN } else { value }
            };
            sums.add(place, number, (0..has_failed.len()).map(value));
        }
        if !place.is_last {
            return;
        }
        let is_beyond = |sum: f64, failures: Failures| sum.is_infinite() || (sum.is_nan() && failures == Failures::NONE);
        for (number, (constraint, &source)) in self.plan.study.constraints.iter().zip(&self.plan.constraints).enumerate() {
            if !constraint.over.is_worst() {
                let result = sums.result(place, spectrum.number(source), constraint.over);
                for (failures, &sum) in failures.iter_mut().zip(result) {
                    failures.overflow |= is_beyond(sum, *failures);
                    if sum.is_finite() && !constraint.holds(sum) {
                        failures.constraints.insert(number);
                    }
                }
            }
        }
        for (tracked, source) in self.plan.tracked.iter().filter(|(tracked, _)| !tracked.over.is_worst()) {
            let result = sums.result(place, spectrum.number(*source), tracked.over);
            failures.iter_mut().zip(result).for_each(|(failures, &sum)| failures.overflow |= is_beyond(sum, *failures));
        }
    }

    /// The worst values of a block's feasible designs, of which some are sums over cases; false if it was stopped.
    fn worst_sums(&mut self, row: u64, fast: &FastBlock, worst: &mut [Vec<f64>]) -> bool {
        // What has just been prepared of the row is still there.
        self.engine.row = None;
        let entered = self.engine.enter_row(row);
        entered
            && self.engine.screen_block(fast, &mut |block| {
                worst.iter_mut().zip(0..).for_each(|(worst, column)| worst.copy_from_slice(block.column(column)));
            })
    }
}

/// Takes the worst values of the feasible designs of a block into the ranges.
fn stretch(ranges: &mut [Option<(f64, f64)>], failures: &[Failures], worst: &[Vec<f64>]) {
    for lane in (0..failures.len()).filter(|&lane| failures[lane] == Failures::NONE) {
        for (range, values) in ranges.iter_mut().zip(worst) {
            let value = values[lane];
            let (low, high) = range.unwrap_or((value, value));
            *range = Some((low.min(value), high.max(value)));
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::models::tests::watched;
    use crate::study::study_of;
    use std::time::Duration;

    pub const STUDY: &str = r#"
        [design]
        power_kW = { from = 1, to = 4, count = 300 }
        [operation]
        slack_tension_N = [500, 700]
        [fixed]
        friction_direction_deg = 45
        [constraints]
        friction_margin = { min = 0.7 }
        [objectives]
        torque_Nm = "max"
    "#;

    #[test]
    fn a_slow_model_is_sampled_less_and_prepares_each_design_of_the_sample_once() {
        let (model, kernel) = watched(Duration::ZERO, 0);
        let plan = Plan::new(study_of(&model, STUDY).expect("the study is right"));
        let control = Control::default();
        let tally = Tally::watched(&plan, &Tables::new(&plan), 2, &control).expect("nobody stops it");
        assert_eq!((tally.sampled, kernel.prepared.load(Ordering::Relaxed)), (50, 100));
        assert!(tally.feasible > 0 && tally.constraints[0] > 0, "{tally:?}");
        assert_eq!([&control.sample, &control.sampled].map(|it| it.load(Ordering::Relaxed)), [50, 50]);
        assert_eq!(tally, Tally::new(&plan, &Tables::new(&plan), 1), "whatever the threads");
    }

    /// Worst values of row and lane quantities, at either end, over every feasible design as a sweep finds them.
    #[test]
    fn ranges_are_those_of_all_feasible_designs_where_the_sample_has_all() {
        let text = r#"
            [design]
            groove_angle_deg  = [18, 22, 26]
            band_thickness_mm = { from = 0.10, to = 0.30, count = 20 }
            band_count        = { from = 4, to = 14 }
            [operation]
            ratio     = [0.6, 1, 1.7]
            torque_Nm = [50, 90]
            [constraints]
            stress_margin = { min = 0 }
            [objectives]
            axial_force_N = "min"
            stress_margin = "max"
            band_count = "min"
            [report]
            histograms = [
                { of = "groove_angle_deg", bins = 3 }, { of = "torque_capacity_Nm", bins = 3 }, { of = "tight_force_N", bins = 3 },
            ]
        "#;
        let plan = Plan::new(study_of(&crate::models::find("metal-cvt").expect("it is a model"), text).expect("the study is right"));
        let tables = Tables::new(&plan);
        let tally = Tally::new(&plan, &tables, 2);
        let mut expected: Vec<Option<(f64, f64)>> = vec![None; plan.tracked.len()];
        let mut feasible = 0;
        CpuEngine::new(&plan, &tables).screen(0..plan.designs(), |block| {
            for lane in block.feasible() {
                feasible += 1;
                for (range, column) in expected.iter_mut().zip(0..) {
                    let value = block.column(column)[lane];
                    *range = range.map_or(Some((value, value)), |(low, high)| Some((low.min(value), high.max(value))));
                }
            }
        });
        assert!(feasible > 20 && feasible < plan.designs() && plan.tracked.len() == 6, "{feasible} of {}", plan.tracked.len());
        assert_eq!((tally.sampled, tally.feasible, tally.ranges), (plan.designs(), feasible, expected));
    }

    #[test]
    fn counting_can_be_stopped() {
        let (model, kernel) = watched(Duration::from_millis(1), 0);
        let control: &Control = Box::leak(Box::default());
        assert!(kernel.stop.set((20, control)).is_ok());
        let plan = Plan::new(study_of(&model, STUDY).expect("the study is right"));
        let stopped = Tally::watched(&plan, &Tables::new(&plan), 2, control);
        assert!(matches!(stopped, Err(Error::Stopped { .. })), "{stopped:?}");
        assert!(kernel.prepared.load(Ordering::Relaxed) < 24 && control.sampled.load(Ordering::Relaxed) < 24);
    }
}
