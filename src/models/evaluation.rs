//! One design in one scenario, evaluated for a person or a table: outputs in their units, absent where they have no meaning.

use super::description::Input;
use super::model::Model;
use super::status::{Evaluation, OVERFLOW, Status};
use crate::decision::Decision;
use crate::tape::Set;

impl Status {
    /// `ok` or the reason.
    pub fn reason(self, model: &Model) -> &str {
        match self {
            Self::Ok => "ok",
            Self::Failed(condition) => &model.conditions[usize::from(condition)].reason,
            Self::Overflow => OVERFLOW,
        }
    }
}

/// An input's value in SI units; a word's number stays what it is.
pub(crate) fn input_to_si(input: &Input, value: f64) -> f64 {
    if input.word_for(value).is_some() { value } else { input.unit.to_si(value) }
}

/// The inputs in SI units.
pub(crate) fn to_si(model: &Model, inputs: &[f64]) -> Vec<f64> {
    model.inputs.iter().zip(inputs).map(|(input, &value)| input_to_si(input, value)).collect()
}

/// The same in room that is there already.
pub(crate) fn fill_si(model: &Model, inputs: &[f64], si: &mut [f64]) {
    si.iter_mut().zip(&model.inputs).zip(inputs).for_each(|((si, input), &value)| *si = input_to_si(input, value));
}

/// Does this condition hold, given its margin? In f64 the answer is never unsure.
pub(crate) fn holds(model: &Model, condition: usize, margin: f64, bound: f64) -> Decision {
    if model.conditions[condition].strict { Decision::above_zero(margin, bound) } else { Decision::at_least_zero(margin, bound) }
}

/// Status, and which outputs remain, from the f64 margins.
pub(crate) fn judge(model: &Model, margins: &[f64]) -> (Status, Set) {
    let mut status = Status::Ok;
    let mut absent = Set::EMPTY;
    for (number, condition) in model.conditions.iter().enumerate() {
        if holds(model, number, margins[number], 0.0) != Decision::Yes {
            if status == Status::Ok && !condition.quiet {
                status = Status::failed(number);
            }
            condition.invalidates.iter().filter_map(|name| model.output(name)).for_each(|output| absent.insert(output));
        }
    }
    (status, Set::ALL - absent)
}

/// An output in its unit, if it has a meaning. A number that overflowed is as absent as one without: never a NaN or infinity in a file.
pub(crate) fn shown(model: &Model, outputs: &[f64], present: Set, output: usize) -> Option<f64> {
    let value = model.outputs[output].unit.from_si(outputs[output]);
    (present.contains(output) && value.is_finite()).then_some(value)
}

/// Evaluates a model in f64. `inputs`: one value per input of the model, in its unit.
///
/// The values are not checked against the inputs' ranges: what has no meaning shows as a status.
pub fn evaluate(model: &Model, inputs: &[f64]) -> Evaluation {
    evaluate_asked(model, inputs, Set::ALL)
}

/// The same where only these outputs are asked for: an overflow of another one leaves the status as it is.
pub fn evaluate_asked(model: &Model, inputs: &[f64], asked: Set) -> Evaluation {
    let si = to_si(model, inputs);
    evaluated(model, &si, &model.kernel.prepared(&si), asked)
}

/// The second stage of an evaluation, of inputs in SI units and what was prepared of them.
pub(super) fn evaluated(model: &Model, si: &[f64], prepared: &[f64], asked: Set) -> Evaluation {
    let sizes = model.kernel.sizes();
    let [mut outputs, mut margins] = [sizes.outputs, sizes.conditions].map(|length| vec![0.0; length]);
    model.kernel.finish_with_conditions(prepared, si, Set::ALL, &mut outputs, &mut margins);
    let (status, present) = judge(model, &margins);
    let outputs: Vec<_> = (0..model.outputs.len()).map(|output| shown(model, &outputs, present, output)).collect();
    // What no condition takes away and is absent all the same has overflowed.
    let overflow = outputs.iter().enumerate().any(|(output, value)| value.is_none() && (asked & present).contains(output));
    let status = if status == Status::Ok && overflow { Status::Overflow } else { status };
    Evaluation { status, outputs }
}
