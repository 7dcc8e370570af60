//! Counting a thread's share of the sample.

use super::marks::Marks;
use super::{Failures, Tally};
use crate::masks;
use crate::plan::{Plan, Source};
use crate::screen::Control;
use crate::screen::cpu::{CpuEngine, holds, row_value, worse_of};
use crate::screen::decisive::Decisive;
use crate::screen::judged::JudgedDesigns;
use crate::screen::spectrum::CaseSums;
use crate::screen::tables::{BLOCK, FastBlock, Tables};
use std::ops::Range;
use std::sync::atomic::Ordering;

/// What a quantity is over a block in the current scenario.
pub(super) enum BlockValues<'a> {
    One(f64),
    Each(&'a [f64]),
}

/// One thread's share of the counting.
pub(super) struct Counter<'p> {
    pub plan: &'p Plan,
    pub engine: CpuEngine<'p>,
    tables: &'p Tables,
    control: &'p Control,
    tally: Tally,
    /// Designs that have been judged, if they are kept.
    judged: Option<JudgedDesigns>,
}

impl<'p> Counter<'p> {
    pub fn new(plan: &'p Plan, tables: &'p Tables, control: &'p Control) -> Self {
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
    pub fn count(&mut self, positions: &[u64]) -> (Tally, JudgedDesigns) {
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
        match self.count_by_few(row, designs) {
            Some(left) => left.is_empty() || self.count_by_all(row, &left),
            None => false,
        }
    }

    /// Counts the designs about which a few scenarios decide. Returns those that are left, or `None` if it was stopped.
    ///
    /// A scenario that is no worse than another one fails at no condition that the other one does not fail at, and violates no constraint
    /// that the other one does not violate. Where a condition fails, though, what is violated in milder scenarios counts too: designs of
    /// which one fails are left.
    fn count_by_few(&mut self, row: u64, designs: &[u64]) -> Option<Vec<u64>> {
        let plan = self.plan;
        let all = || Some(designs.to_vec());
        let is_worth_it = Decisive::is_worth_it(plan.scenarios(), designs.len() as u64);
        if self.judged.is_some() || !is_worth_it || !self.engine.begin_scenarios() {
            return all();
        }
        let fast = FastBlock::picked(plan, self.tables, designs);
        let mut marks = Marks::new(plan, designs.len());
        let (mut of_row, mut worst) = self.worst_of_none(designs.len());
        let (mut scenarios, mut is_sure) = (0, true);
        let done = self.each_scenario(row, |counter, _, prepared| {
            marks.begin();
            match counter.failed_of_row() {
                Some(_) if !plan.lane_conditions.is_empty() => is_sure = false,
                Some(number) => marks.mark_row(plan.study.model.first_of_reason(number)),
                None => {
                    marks.values(counter, &fast, Source::is_row);
                    counter.worsen_of_row(&mut of_row);
                    counter.engine.add_scenario(prepared);
                    scenarios += 1;
                }
            }
            is_sure
        });
        if !done {
            return None;
        }
        if !is_sure {
            return all();
        }
        let settled = self.engine.settle_scenarios(scenarios, designs.len() as u64);
        // Nothing would be saved, and some designs might be judged twice.
        if settled == scenarios && !plan.lane_conditions.is_empty() {
            return all();
        }
        for number in 0..settled {
            if self.engine.stopped() {
                return None;
            }
            self.engine.evaluate_settled(number, &fast);
            marks.begin();
            marks.conditions(self, None);
            marks.values(self, &fast, |source| !source.is_row());
            self.worsen_lanes(&mut worst, number == 0, &fast);
        }
        let left: Vec<usize> = marks.failed().collect();
        let mut failures = vec![Failures::NONE; designs.len()];
        marks.add_to(plan, &mut failures);
        self.fill_of_row(&of_row, &mut worst);
        stretch(&mut self.tally.ranges, &failures, &worst);
        for lane in (0..designs.len()).filter(|lane| left.binary_search(lane).is_err()) {
            self.tally.count_design(failures[lane]);
        }
        Some(left.into_iter().map(|lane| designs[lane]).collect())
    }

    /// Counts designs that are judged in every scenario; false if it was stopped.
    fn count_by_all(&mut self, row: u64, designs: &[u64]) -> bool {
        let plan = self.plan;
        let fast = FastBlock::picked(plan, self.tables, designs);
        let mut failures = vec![Failures::NONE; designs.len()];
        let mut marks = Marks::new(plan, designs.len());
        let mut sums = CaseSums::new(plan, designs.len());
        // Worst values that are sums over cases are found by judging the feasible designs once more.
        let (mut of_row, mut worst) = self.worst_of_none(designs.len());
        let done = self.each_scenario(row, |counter, scenario, prepared| {
            let failed = counter.failed_of_row();
            counter.engine.evaluate(prepared, &fast);
            marks.scenario(counter, &fast, failed);
            let mut has_failed = Vec::new();
            if plan.spectrum.is_some() {
                // Whether a sum has a meaning depends on what has failed before.
                marks.add_to(plan, &mut failures);
                has_failed.extend(marks.ok.iter().map(|ok| *ok == 0));
            }
            counter.sum(&mut sums, scenario, &fast, &has_failed, &mut failures);
            if plan.spectrum.is_none() {
                counter.worsen_of_row(&mut of_row);
                counter.worsen_lanes(&mut worst, scenario == (0, 0), &fast);
            }
            true
        });
        if !done {
            return false;
        }
        marks.add_to(plan, &mut failures);
        for &failures in &failures {
            self.tally.count_design(failures);
        }
        let is_feasible = || failures.iter().map(|&it| it == Failures::NONE);
        self.fill_of_row(&of_row, &mut worst);
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

    /// Enters a row and turns to one of its scenarios, slow and fast, after the other, as long as `look` wants to go on; `look` is told where
    /// the prepared numbers stand. False if it was stopped.
    fn each_scenario(&mut self, row: u64, mut look: impl FnMut(&mut Self, (u64, u64), Range<usize>) -> bool) -> bool {
        self.engine.set_row(row);
        for q in 0..self.plan.slow_scenarios.count() {
            let prepared = self.engine.prepare(q);
            for t in 0..self.plan.fast_scenarios.count() {
                if self.engine.stopped() {
                    return false;
                }
                self.engine.set_fast_scenario(t);
                self.engine.row_values(prepared.clone());
                if !look(self, (q, t), prepared.clone()) {
                    return true;
                }
            }
        }
        true
    }

    /// The first condition that the whole row fails at in the current scenario.
    fn failed_of_row(&self) -> Option<usize> {
        let fails = |number: &usize| !holds(self.plan, *number, self.engine.row_margins[*number]);
        self.plan.row_conditions.iter().copied().filter(fails).min()
    }

    /// Worst values before the first scenario: of what is the same for the whole row, and of so many designs.
    fn worst_of_none(&self, designs: usize) -> (Vec<f64>, Vec<Vec<f64>>) {
        let tracked = &self.plan.tracked;
        (tracked.iter().map(|(it, _)| it.worse.least_bad()).collect(), vec![vec![0.0; designs]; tracked.len()])
    }

    /// Takes what is the same for the whole row into its worst values.
    fn worsen_of_row(&self, worst: &mut [f64]) {
        for (worst, &(tracked, source)) in worst.iter_mut().zip(&self.plan.tracked).filter(|(_, (_, source))| source.is_row()) {
            let value = row_value(self.plan, source, &self.engine.own, &self.engine.row_outputs);
            *worst = worse_of(tracked.worse, *worst, value);
        }
    }

    /// Takes the designs' own values of the current scenario into the worst ones of the block.
    fn worsen_lanes(&self, worst: &mut [Vec<f64>], is_first: bool, fast: &FastBlock) {
        for (worst, &(tracked, source)) in worst.iter_mut().zip(&self.plan.tracked) {
            let count = worst.len();
            match source {
                Source::LaneOutput(position) => {
                    let output = &self.engine.results[position][..count];
                    masks::worsen(tracked.worse, is_first, worst, output);
                }
                Source::LaneInput(input) => worst.copy_from_slice(&fast.own(input)[..count]),
                Source::RowInput(_) | Source::RowOutput(_) => {}
            }
        }
    }

    /// Gives every design the worst values of its row.
    fn fill_of_row(&self, of_row: &[f64], worst: &mut [Vec<f64>]) {
        let of_tracked = worst.iter_mut().zip(of_row).zip(&self.plan.tracked);
        of_tracked.filter(|(_, (_, source))| source.is_row()).for_each(|((worst, &value), _)| worst.fill(value));
    }

    /// The values of the designs in the current scenario.
    pub fn values<'a>(&'a self, source: Source, fast: &'a FastBlock) -> BlockValues<'a> {
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
        match self.values(source, fast) {
            BlockValues::One(value) => value,
            BlockValues::Each(values) => values[lane],
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
            // Which of two zeros is the worst depends on the scenarios that were looked at.
            let value = values[lane] + 0.0;
            let (low, high) = range.unwrap_or((value, value));
            *range = Some((low.min(value), high.max(value)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Study;
    use std::path::Path;

    #[test]
    fn a_few_scenarios_count_as_all_do() {
        // Each study with what is expected: are designs counted in few scenarios, and are designs left for all of them?
        for (study, has_few, has_left) in [
            // One scenario decides by itself.
            ("studies/metal-grid.toml", false, true),
            // A condition fails for whole rows.
            ("studies/metal-cvt.toml", true, false),
            ("benches/studies/metal-cvt-traction.toml", true, false),
            // One fails for single designs.
            ("studies/flat-belt.toml", true, true),
            // Means over cases need them all.
            ("studies/push-belt-duty.toml", false, true),
        ] {
            let plan = Plan::new(Study::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join(study)).expect("it is right").0);
            let (tables, control) = (Tables::new(&plan), Control::default());
            let counter = || Counter::new(&plan, &tables, &control);
            let (mut by_few, mut by_all) = (counter(), counter());
            let (mut few, mut all, mut is_split) = (0, 0, false);
            for row in plan.slow.coarse(7) {
                for designs in plan.fast.coarse(400).chunks(200) {
                    let left = by_few.count_by_few(row, designs).expect("nobody stops it");
                    if left.len() < designs.len() {
                        let settled = by_few.engine.numbers.as_ref().map_or(0, |(_, decisive)| decisive.count() as u64);
                        assert!(settled < plan.scenarios(), "{study}: {settled} scenarios");
                    }
                    is_split |= !left.is_empty() && left.len() < designs.len();
                    (few, all) = (few + designs.len() - left.len(), all + left.len());
                    assert!(left.is_empty() || by_few.count_by_all(row, &left));
                    assert!(by_all.count_by_all(row, designs));
                }
            }
            let (found, tally) = (by_few.tally, by_all.tally);
            assert!(found == tally, "{study}: {found:?} and {tally:?}");
            assert!(tally.feasible > 0 && tally.feasible < tally.sampled && tally.constraints.iter().any(|it| *it > 0), "{tally:?}");
            assert_eq!((few > 0, all > 0, tally.sampled), (has_few, has_left, few as u64 + all as u64), "{study}: {few} and {all}");
            let fails_for_rows = tally.conditions.iter().any(|it| *it > 0);
            assert!(fails_for_rows || !study.ends_with("metal-cvt.toml"), "{tally:?}");
            assert_eq!(is_split, study.ends_with("flat-belt.toml"), "{study}: {few} and {all}");
        }
    }
}
