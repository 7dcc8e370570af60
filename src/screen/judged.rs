//! Designs of the sample that the sweep need not judge again. To count why designs fail the sample judges them to the end, which is more
//! than a sweep does.

use super::Block;
use super::tables::BLOCK;
use crate::masks;
use crate::plan::Plan;
use std::ops::Range;

/// Designs that take fewer seconds are not kept: a sweep gives up on most of them early, in less time than the sample takes.
const SLOW: f64 = 1e-4;

/// Designs that have been judged over all scenarios, in the order of the sweep.
#[derive(Debug, Default)]
pub struct JudgedDesigns {
    /// Sorted.
    positions: Vec<u64>,
    /// All ones for a feasible design, else zero.
    alive: Vec<u64>,
    /// One column per tracked quantity; meaningful for feasible designs only.
    values: Vec<Vec<f64>>,
}

impl JudgedDesigns {
    /// Before the first.
    pub(super) fn new(plan: &Plan) -> Self {
        Self { values: vec![Vec::new(); plan.tracked.len()], ..Self::default() }
    }

    /// Are the designs of the sample kept? Only where each takes long; and the sample has all designs, or each is a row of its own.
    pub(super) fn are_kept(plan: &Plan) -> bool {
        plan.seconds_per_design() > SLOW && (plan.designs() <= plan.study.model.sample || plan.fast.count() == 1)
    }

    /// About how many bytes they take.
    pub(super) fn bytes(plan: &Plan) -> u64 {
        let kept = if Self::are_kept(plan) { plan.designs().min(plan.study.model.sample) } else { 0 };
        kept * 8 * (2 + plan.tracked.len()) as u64
    }

    /// Takes in designs behind those before: their positions, which are feasible, and their worst values.
    pub(super) fn add(&mut self, positions: impl Iterator<Item = u64>, is_feasible: impl Iterator<Item = bool>, worst: &[Vec<f64>]) {
        self.positions.extend(positions);
        self.alive.extend(is_feasible.map(|it| if it { u64::MAX } else { 0 }));
        self.values.iter_mut().zip(worst).for_each(|(to, from)| to.extend(from));
    }

    /// Takes in others, which stand behind these.
    pub(super) fn append(&mut self, other: Self) {
        self.add(other.positions.into_iter(), other.alive.into_iter().map(|it| it != 0), &other.values);
    }

    /// Are there none?
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// The judged designs that stand at the first of these positions, without a gap, and where the next judged one after them is: the
    /// positions between must be judged.
    pub(super) fn first_of(&self, positions: &Range<u64>) -> (Range<usize>, u64) {
        let place = self.positions.partition_point(|&it| it < positions.start);
        let ahead = self.positions[place..].iter().zip(positions.clone());
        let count = ahead.take_while(|(judged, position)| **judged == *position).count();
        let next = self.positions.get(place + count).map_or(positions.end, |&next| next.min(positions.end));
        (place..place + count, next)
    }

    /// Hands over those at some places, as an engine hands over what it has judged.
    pub(super) fn hand_over(&self, plan: &Plan, places: Range<usize>, absorb: &mut impl FnMut(&Block<'_>)) {
        let mut values = vec![Vec::new(); self.values.len()];
        for first in places.clone().step_by(BLOCK) {
            let block = first..places.end.min(first + BLOCK);
            let alive = &self.alive[block.clone()];
            let feasible_count = masks::count(alive);
            if feasible_count == 0 {
                continue;
            }
            let offsets: Vec<u64> = self.positions[block.clone()].iter().map(|&position| plan.design_at(position)).collect();
            for (column, kept) in values.iter_mut().zip(&self.values) {
                column.clear();
                column.extend(&kept[block.clone()]);
            }
            absorb(&Block { row_index: 0, offsets: &offsets, feasible_count, alive, values: &values });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::tests::watched;
    use crate::models::{Effort, Model};
    use crate::screen::tally::tests::STUDY;
    use crate::screen::{Control, CpuEngine, Tables, Tally};
    use crate::study::{Study, study_of};
    use std::sync::Arc;
    use std::sync::atomic::Ordering;
    use std::time::Duration;

    const STUDIES: [&str; 3] = [
        // Rows of many designs, worst values over slow and fast scenarios.
        r#"model = "metal-cvt"
        [design]
        groove_angle_deg  = [18, 22, 26]
        band_thickness_mm = { from = 0.10, to = 0.30, count = 23 }
        band_count        = { from = 4, to = 14 }
        traction          = [0.3, 0.5]
        [operation]
        ratio     = [0.6, 1, 1.7]
        torque_Nm = [50, 90]
        [constraints]
        stress_margin = { min = 0 }
        axial_force_N = { max = 30000 }
        [objectives]
        axial_force_N = "min"
        slip_margin = "max"
        band_count = "min"
        "#,
        // Means over cases.
        r#"model = "metal-cvt"
        [design]
        groove_angle_deg  = [18, 22, 26]
        band_thickness_mm = { from = 0.10, to = 0.30, count = 23 }
        band_count        = { from = 4, to = 14 }
        [operation]
        duty = { cases = [{ ratio = 0.5, share = 2 }, { ratio = 1, share = 5 }, { ratio = 2, share = 1 }], weight = "share" }
        torque_Nm = [50, 90]
        [constraints]
        stress_margin = { min = 0 }
        [objectives]
        axial_force_N = { goal = "min", over_scenarios = "mean" }
        slip_margin = "max"
        "#,
        // Draws.
        r#"model = "rubber-cvt"
        [design]
        belt_width_mm = { from = 35, to = 60, count = 11 }
        belt_thickness_mm = { from = 8, to = 12, count = 9 }
        [uncertainty]
        friction = { normal = { mean = 0.4, sd = 0.03 }, from = 0.3, to = 0.5 }
        [probability]
        draws = 60
        [constraints]
        slip_margin = { min = 0 }
        flank_pressure_MPa = { max = 1.5 }
        yield = { min = 0.2 }
        [objectives]
        yield = "max"
        axial_force_N = { goal = "min", over_draws = { quantile = 0.95 } }
        "#,
    ];

    /// Feasible designs with the bits of their values, from stretches that begin and end anywhere.
    fn screened(plan: &Plan, tables: &Tables) -> Vec<(u64, Vec<u64>)> {
        let mut engine = CpuEngine::new(plan, tables);
        let mut found = Vec::new();
        let mut first = 0;
        while first < plan.designs() {
            let last = plan.designs().min(first + 1 + first * 5 % 1999);
            let reached = engine.screen(first..last, |block| {
                assert_eq!(block.feasible().count() as u64, block.feasible_count);
                let bits = |lane: usize| (0..plan.tracked.len()).map(|column| block.column(column)[lane].to_bits()).collect();
                found.extend(block.feasible().map(|lane| (block.index(lane), bits(lane))));
            });
            assert_eq!(reached, last);
            first = last;
        }
        found
    }

    #[test]
    fn a_sweep_takes_over_what_the_sample_has_judged_as_it_would_judge_it() {
        for text in STUDIES {
            let mut study = Study::parse_in(text, "test.toml", ".".as_ref()).unwrap_or_else(|errors| panic!("{errors}"));
            study.model = Arc::new(Model { effort: Effort { prepare: 0.0, finish: 2.0 * SLOW }, ..Model::clone(&study.model) });
            let plan = Plan::new(study);
            let mut tables = Tables::new(&plan);
            let own = screened(&plan, &tables);
            assert!(own.len() > 10 && (own.len() as u64) < plan.designs(), "{} feasible: {text}", own.len());
            for threads in [1, 3] {
                let control = Control::default();
                let (_, judged) = Tally::with_judged(&plan, &Tables::new(&plan), threads, &control).expect("nobody stops it");
                assert_eq!(control.done.load(Ordering::Relaxed), plan.designs(), "{text}");
                assert_eq!(judged.positions.len() as u64, plan.designs(), "{text}");
                tables.take_over(judged);
                assert!(screened(&plan, &tables) == own, "{threads} threads: {text}");
            }
        }
    }

    #[test]
    fn of_a_slow_model_a_few_of_many_are_taken_over_too() {
        let (model, kernel) = watched(Duration::from_micros(200), 0);
        let plan = Plan::new(study_of(&model, STUDY).expect("the study is right"));
        let mut tables = Tables::new(&plan);
        let own = screened(&plan, &tables);
        let control = Control::default();
        let (tally, judged) = Tally::with_judged(&plan, &tables, 2, &control).expect("nobody stops it");
        assert_eq!(control.done.load(Ordering::Relaxed), 0, "the sweep has most of its work before it");
        let positions = judged.positions.clone();
        assert_eq!((tally.sampled, positions.len()), (50, 50));
        tables.take_over(judged);
        let before = kernel.prepared.load(Ordering::Relaxed);
        let mut engine = CpuEngine::new(&plan, &tables);
        let mut feasible = 0;
        positions.iter().for_each(|&position| {
            engine.screen(position..position + 1, |block| feasible += block.feasible_count);
        });
        assert_eq!((feasible, kernel.prepared.load(Ordering::Relaxed)), (tally.feasible, before), "they are not judged again");
        assert!(feasible > 0 && screened(&plan, &tables) == own);
        assert!(kernel.prepared.load(Ordering::Relaxed) > before);
    }
}
