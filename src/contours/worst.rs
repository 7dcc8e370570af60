//! The worst value over all scenarios at any place of the plane, in f64.

use crate::models::{Latest, Set, Worse, judge, shown, to_si};
use crate::plan::Plan;
use crate::study::Quantity;
use std::sync::{Mutex, PoisonError};

/// The plane of two inputs; everything else is as the study has it.
pub struct Worst<'p> {
    plan: &'p Plan,
    axes: [usize; 2],
    inputs: Vec<f64>,
    /// What places before have prepared: one for each thread that has been here at the same time as others.
    latest: Mutex<Vec<Latest>>,
}

impl<'p> Worst<'p> {
    /// The plane of these two inputs, the only ones in which designs differ.
    pub fn new(plan: &'p Plan, axes: [usize; 2]) -> Self {
        Self { plan, axes, inputs: plan.space.inputs(0, 0), latest: Mutex::default() }
    }

    /// The worst values at a place, by the ends named; `None` where a quantity has no value in some scenario.
    pub fn at(&self, x: f64, y: f64, wanted: &[(Quantity, Worse)]) -> Vec<Option<f64>> {
        let plan = self.plan;
        let model = &plan.study.model;
        let outputs_wanted: Set = wanted.iter().filter_map(|(quantity, _)| quantity.output()).collect();
        let mut inputs = self.inputs.clone();
        (inputs[self.axes[0]], inputs[self.axes[1]]) = (x, y);
        let mut worst: Vec<Option<f64>> = Vec::new();
        let mut prepared = vec![0.0; model.kernel.prepared_len()];
        let unused = self.latest.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut latest = unused.unwrap_or_else(|| Latest::new(model));
        for slow in 0..plan.slow_scenarios.count() {
            plan.slow_scenarios.set(slow, &mut inputs);
            for fast in 0..plan.fast_scenarios.count() {
                plan.fast_scenarios.set(fast, &mut inputs);
                let si = to_si(model, &inputs);
                // What the slow scenario inputs prepare serves all fast ones.
                if fast == 0 {
                    latest.prepare(&si, outputs_wanted, &mut prepared);
                }
                let outputs = model.kernel.outputs(&prepared, &si, outputs_wanted);
                let (_, present) = judge(model, &model.kernel.margins(&prepared, &si));
                let value = |quantity| match quantity {
                    Quantity::Input(input) => Some(inputs[input]),
                    Quantity::Output(output) => shown(model, &outputs, present, output),
                };
                let values = wanted.iter().map(|(quantity, _)| value(*quantity));
                if worst.is_empty() {
                    worst = values.collect();
                } else {
                    for ((worst, value), (_, end)) in worst.iter_mut().zip(values).zip(wanted) {
                        *worst = worst.zip(value).map(|(worst, value)| match end {
                            Worse::Higher => worst.max(value),
                            Worse::Lower => worst.min(value),
                        });
                    }
                }
            }
        }
        self.latest.lock().unwrap_or_else(PoisonError::into_inner).push(latest);
        worst
    }
}
