//! Every model over every number type: f32 with its error bound, intervals, derivatives, dependencies, and eight designs at a time.

mod bounds;
mod boxes;
mod columns;
mod dependence;
mod derivatives;
mod elementary;
mod intervals;
mod precise;

pub use boxes::run_over;

use beltspace::models::{Input, Model, Set, evaluate};

/// Inputs in SI units, as formulas take them.
pub fn si(model: &Model, inputs: &[f64]) -> Vec<f64> {
    let si = |(input, &value): (&Input, &f64)| if input.word_for(value).is_some() { value } else { input.unit.to_si(value) };
    model.inputs.iter().zip(inputs).map(si).collect()
}

/// All outputs in SI units, those without a meaning included.
fn outputs_si(model: &Model, si: &[f64]) -> Vec<f64> {
    model.kernel.outputs(&model.kernel.prepared(si), si, Set::ALL)
}

/// Outputs in SI units where they have a meaning.
pub fn meaningful_si(model: &Model, inputs: &[f64]) -> Vec<Option<f64>> {
    let outputs = outputs_si(model, &si(model, inputs));
    let present = evaluate(model, inputs).outputs;
    present.iter().zip(outputs).map(|(present, value)| present.map(|_| value)).collect()
}
