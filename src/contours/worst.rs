//! The worst value over all scenarios at any point of the plane, in f64.

use crate::models::{Latest, Set, Worse, judge, shown, to_si};
use crate::plan::Plan;
use crate::study::Quantity;
use std::sync::{Mutex, PoisonError};

/// The worst value over the plane of two inputs; all other inputs are those of the study.
pub struct WorstOnPlane<'p> {
    plan: &'p Plan,
    axes: [usize; 2],
    inputs: Vec<f64>,
    /// Prepared numbers of earlier points: one set for each thread that has evaluated at the same time as others.
    latest: Mutex<Vec<Latest>>,
}

impl<'p> WorstOnPlane<'p> {
    /// The plane of these two inputs, which are the only ones that designs vary.
    pub fn new(plan: &'p Plan, axes: [usize; 2]) -> Self {
        Self { plan, axes, inputs: plan.space.inputs(0, 0), latest: Mutex::default() }
    }

    /// The worst values at a point, by the given ends; `None` if a quantity has no value in some scenario.
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
                // The prepared numbers of the slow scenario inputs serve all fast ones.
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
