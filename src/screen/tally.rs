//! Why designs are not feasible: a count per status and constraint over a fixed sample of the designs.
//!
//! A sweep gives up on a design at the first thing that is wrong with it, so what limits feasibility is counted on a sample of
//! its own, in f64 and to the end: stratified design indices, as many as the model says (all designs if fewer), the same whatever ran
//! the sweep.

mod counter;
mod marks;

use super::Control;
use super::judged::JudgedDesigns;
use super::tables::Tables;
use crate::error::{Error, Result};
use crate::models::Set;
use crate::parallel::one_after_another;
use crate::plan::{Plan, Tracked, worst_end};
use crate::sample::mix;
use crate::study::Study;
use counter::Counter;
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

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::models::tests::watched;
    use crate::screen::CpuEngine;
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
