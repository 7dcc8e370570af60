//! Judging a block of designs of the row that was entered, scenario by scenario.

use super::CpuEngine;
use crate::masks::{self, any, keep_between, keep_finite, keep_margin};
use crate::models::Columns;
use crate::plan::Source;
use crate::screen::Block;
use crate::screen::tables::FastBlock;
use crate::tape::LaneBlock;
use std::ops::Range;

impl CpuEngine<'_> {
    /// Judges one block of the current row over all scenarios; false if it was stopped before it had.
    pub(in crate::screen) fn screen_block(&mut self, fast: &FastBlock, absorb: &mut impl FnMut(&Block<'_>)) -> bool {
        let plan = self.plan;
        let count = fast.count;
        self.alive.clear();
        self.alive.resize(count, u64::MAX);
        for (constraint, source) in plan.study.constraints.iter().zip(&plan.constraints) {
            if let Source::LaneInput(input) = *source {
                let (low, high) = constraint.ends();
                keep_between(&mut self.alive, fast.own(input), low, high);
            }
        }
        for (((_, source), column), &worst) in plan.tracked.iter().zip(&mut self.values).zip(&self.row_worst) {
            match *source {
                Source::LaneInput(input) => column[..count].copy_from_slice(&fast.own(input)[..count]),
                // The first scenario overwrites what the block before left here.
                Source::LaneOutput(_) => {}
                Source::RowInput(_) | Source::RowOutput(_) => column[..count].fill(worst),
            }
        }
        if !self.results.is_empty() && !self.judge_block(fast) {
            return false;
        }
        let feasible = masks::count(&self.alive);
        if feasible > 0 {
            let (row_index, offsets) = (self.row_index, &fast.offsets);
            absorb(&Block { row_index, offsets, feasible_count: feasible, alive: &self.alive, values: &self.values });
        }
        true
    }

    /// Judges the block in every scenario that may decide; false if it was stopped before it had.
    fn judge_block(&mut self, fast: &FastBlock) -> bool {
        let Some((_, decisive)) = &self.numbers else {
            return self.each_scenario(|engine, prepared, is_first, is_last| {
                engine.evaluate(prepared, fast);
                engine.judge_block_scenario(is_first, engine.plan.scenarios() == 1);
                !is_last || any(&engine.alive)
            });
        };
        let count = decisive.count();
        for number in 0..count {
            if self.stopped() {
                return false;
            }
            self.evaluate_settled(number, fast);
            self.judge_block_scenario(number == 0, count == 1);
            if !any(&self.alive) {
                break;
            }
        }
        true
    }

    /// Runs the inner loop: lane outputs and lane condition margins of a block in the current scenario.
    pub(in crate::screen) fn evaluate(&mut self, prepared: Range<usize>, fast: &FastBlock) {
        let plan = self.plan;
        if self.results.is_empty() {
            return;
        }
        self.enter_scenario(prepared.clone());
        if let (Some(list), Some((numbers, _))) = (&self.tables.lanes, &mut self.numbers) {
            return list.run(numbers, LaneBlock { shared: &fast.shared, given: &[], count: fast.count }, &mut self.results);
        }
        let prepared = &self.prepared[prepared];
        let columns = Columns { count: fast.count, varying: &fast.si, outputs: &plan.lane_outputs, conditions: &plan.lane_conditions };
        plan.study.model.kernel.finish_columns(prepared, &self.si, &columns, &mut self.scratch, &mut self.results);
        columns.to_units(&plan.study.model.outputs, &mut self.results);
    }

    /// The same in one of the scenarios that decide.
    pub(in crate::screen) fn evaluate_settled(&mut self, number: usize, fast: &FastBlock) {
        let (Some((numbers, decisive)), Some(list)) = (&mut self.numbers, &self.tables.lanes) else { return };
        numbers.set_scalars(list, decisive.scalars(number));
        list.run(numbers, LaneBlock { shared: &fast.shared, given: &[], count: fast.count }, &mut self.results);
    }

    fn judge_block_scenario(&mut self, first: bool, only: bool) {
        let plan = self.plan;
        let (outputs, margins) = self.results.split_at_mut(plan.lane_outputs.len());
        let alive = &mut self.alive;
        for (&number, margins) in plan.lane_conditions.iter().zip(&*margins) {
            keep_margin(alive, margins, plan.study.model.conditions[number].strict);
        }
        let sums = &mut self.lane_sums;
        if let Some(spectrum) = &plan.spectrum {
            sums.judge_lanes(plan, spectrum, (self.scenario, first), outputs, alive, &mut self.values);
        }
        for (constraint, source) in plan.study.constraints.iter().zip(&plan.constraints).filter(|(it, _)| it.over.is_worst()) {
            if let Source::LaneOutput(position) = *source {
                let (low, high) = constraint.ends();
                keep_between(alive, &outputs[position], low, high);
            }
        }
        for ((tracked, source), worst) in plan.tracked.iter().zip(&mut self.values).filter(|((it, _), _)| it.over.is_worst()) {
            if let Source::LaneOutput(position) = *source {
                let output = &outputs[position][..alive.len()];
                // A constraint on the same output has asked for a finite number already.
                if !plan.constraints.contains(source) {
                    keep_finite(alive, output);
                }
                // The only scenario is the worst, and nobody else asks for the column: it changes hands without a copy.
                if only && plan.tracked.iter().filter(|(_, other)| other == source).count() == 1 {
                    std::mem::swap(worst, &mut outputs[position]);
                    continue;
                }
                masks::worsen(tracked.worse, first, &mut worst[..alive.len()], output);
            }
        }
    }
}
