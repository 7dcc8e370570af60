//! Sums over the cases of a spectrum while designs are judged.

use crate::masks::{keep_between, keep_finite, lower, raise};
use crate::models::Worse;
use crate::plan::{CasePlace, Plan, Source, SpectrumPlan};
use crate::study::OverScenarios;

/// Weighted sums that are being made: of each value that the plan sums, one column for every scenario of the other axes that is under
/// way.
#[derive(Debug, Default)]
pub(super) struct CaseSums {
    /// Of each scenario under way, of each value: one number per design.
    columns: Vec<Vec<f64>>,
    values: usize,
    total: f64,
    result: Vec<f64>,
}

impl CaseSums {
    /// Room for the sums of a plan over that many designs at a time.
    pub fn new(plan: &Plan, designs: usize) -> Self {
        let Some(spectrum) = &plan.spectrum else { return Self::default() };
        let values = spectrum.sums.len();
        let under_way = usize::try_from(spectrum.under_way).expect("the plan keeps them few");
        Self { columns: vec![vec![0.0; designs]; values * under_way], values, total: spectrum.total, result: vec![0.0; designs] }
    }

    /// Bytes that the sums of a plan take for so many designs.
    pub fn bytes(plan: &Plan, designs: usize) -> u64 {
        let columns = plan.spectrum.as_ref().map_or(0, |it| it.under_way * it.sums.len() as u64 + 1);
        8 * columns * designs as u64
    }

    fn at(&self, place: CasePlace, value: usize) -> usize {
        place.slot as usize * self.values + value
    }

    /// Adds the values of a case, times its weight, to sum number `value`.
    pub fn add(&mut self, place: CasePlace, value: usize, values: impl IntoIterator<Item = f64>) {
        let at = self.at(place, value);
        let column = &mut self.columns[at];
        if place.case == 0 {
            column.fill(0.0);
        }
        for (sum, value) in column.iter_mut().zip(values) {
            *sum += place.weight * value;
        }
    }

    /// What sum number `value` comes to after the last case.
    pub fn result(&mut self, place: CasePlace, value: usize, over: OverScenarios) -> &[f64] {
        let at = self.at(place, value);
        if over == OverScenarios::Mean {
            for (result, sum) in self.result.iter_mut().zip(&self.columns[at]) {
                *result = sum / self.total;
            }
            return &self.result;
        }
        &self.columns[at]
    }

    /// Takes in values that are the same for a whole row in the current scenario. After the last case, bounds on the sums are asked, and
    /// `worst` becomes the worst of the tracked ones so far. False if the row is out.
    pub fn judge_row(&mut self, plan: &Plan, scenario: (u64, u64), value: impl Fn(Source) -> f64, worst: &mut [f64]) -> bool {
        let Some(spectrum) = &plan.spectrum else { return true };
        let place = spectrum.place(scenario);
        for (number, &source) in spectrum.sums.iter().enumerate().filter(|(_, source)| source.is_row()) {
            let value = value(source);
            if !value.is_finite() {
                return false;
            }
            self.add(place, number, [value]);
        }
        if !place.is_last {
            return true;
        }
        let constraints = plan.study.constraints.iter().zip(&plan.constraints);
        for (constraint, &source) in constraints.filter(|(it, source)| source.is_row() && !it.over.is_worst()) {
            let sum = self.result(place, spectrum.number(source), constraint.over)[0];
            if !sum.is_finite() || !constraint.holds(sum) {
                return false;
            }
        }
        for ((tracked, source), worst) in plan.tracked.iter().zip(worst) {
            if source.is_row() && !tracked.over.is_worst() {
                let sum = self.result(place, spectrum.number(*source), tracked.over)[0];
                if !sum.is_finite() {
                    return false;
                }
                *worst = match tracked.worse {
                    Worse::Higher => worst.max(sum),
                    Worse::Lower => worst.min(sum),
                };
            }
        }
        true
    }

    /// The same for values that differ within the row. `first`: the scenario is the first one.
    pub fn judge_lanes(
        &mut self,
        plan: &Plan,
        spectrum: &SpectrumPlan,
        (scenario, first): ((u64, u64), bool),
        outputs: &[Vec<f64>],
        alive: &mut [u64],
        worst: &mut [Vec<f64>],
    ) {
        let place = spectrum.place(scenario);
        for (number, source) in spectrum.sums.iter().enumerate() {
            if let Source::LaneOutput(position) = *source {
                let output = &outputs[position][..alive.len()];
                keep_finite(alive, output);
                self.add(place, number, output.iter().copied());
            }
        }
        for (constraint, source) in plan.study.constraints.iter().zip(&plan.constraints) {
            if let (Source::LaneOutput(_), true) = (source, place.is_last && !constraint.over.is_worst()) {
                let (low, high) = constraint.ends();
                keep_between(alive, self.result(place, spectrum.number(*source), constraint.over), low, high);
            }
        }
        for ((tracked, source), worst) in plan.tracked.iter().zip(worst) {
            if !matches!(source, Source::LaneOutput(_)) || tracked.over.is_worst() {
                continue;
            }
            let worst = &mut worst[..alive.len()];
            if first {
                worst.fill(tracked.worse.least_bad());
            }
            if place.is_last {
                let sums = &self.result(place, spectrum.number(*source), tracked.over)[..alive.len()];
                keep_finite(alive, sums);
                match tracked.worse {
                    Worse::Higher => raise(worst, sums),
                    Worse::Lower => lower(worst, sums),
                }
            }
        }
    }
}
