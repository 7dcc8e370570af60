//! Every model over every number type: f32 with its error bound, intervals, derivatives, dependencies, and eight designs at a time.

mod bounds;
mod boxes;
mod columns;
mod dependence;
mod derivatives;
mod intervals;
mod precise;

pub use boxes::run_over;

use beltspace::models::{INPUTS, Model, OUTPUTS, evaluate};

/// Inputs in SI units, as formulas take them.
pub fn si(model: &Model, inputs: &[f64]) -> [f64; INPUTS] {
    let mut si = [0.0; INPUTS];
    for ((si, input), &value) in si.iter_mut().zip(&model.inputs).zip(inputs) {
        *si = if input.word_for(value).is_some() { value } else { input.unit.to_si(value) };
    }
    si
}

/// All outputs in SI units, those without a meaning included.
fn outputs_si(model: &Model, si: &[f64; INPUTS]) -> [f64; OUTPUTS] {
    let mut outputs = [0.0; OUTPUTS];
    model.kernel.finish(&model.kernel.prepared(si), si, u64::MAX, &mut outputs);
    outputs
}

/// Outputs in SI units where they have a meaning.
pub fn meaningful_si(model: &Model, inputs: &[f64]) -> Vec<Option<f64>> {
    let outputs = outputs_si(model, &si(model, inputs));
    let present = evaluate(model, inputs).outputs;
    present.iter().zip(outputs).map(|(present, value)| present.map(|_| value)).collect()
}
