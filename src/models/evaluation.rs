//! One design in one scenario, evaluated for a person or a table: outputs in their units, absent where they have no meaning.

use super::description::{Input, Model};
use super::formula::{CONDITIONS, INPUTS, OUTPUTS};
use crate::decision::Decision;

/// What became of an evaluation: ok, or the first condition that failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The formula has a meaning.
    Ok,
    /// Number of the condition that failed.
    Failed(usize),
    /// A value is beyond what f64 holds, and absent.
    Overflow,
}

/// The reason of [`Status::Overflow`].
pub const OVERFLOW: &str = "overflow";

impl Status {
    /// `ok` or the reason.
    pub fn reason(self, model: &Model) -> &str {
        match self {
            Self::Ok => "ok",
            Self::Failed(condition) => &model.conditions[condition].reason,
            Self::Overflow => OVERFLOW,
        }
    }
}

/// Status and outputs of one design in one scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// Ok, or why not.
    pub status: Status,
    /// One value per output of the model, in the output's unit; `None` where it has no meaning.
    pub outputs: Vec<Option<f64>>,
}

/// An input's value in SI units; a word's number stays what it is.
pub(crate) fn input_to_si(input: &Input, value: f64) -> f64 {
    if input.word_for(value).is_some() { value } else { input.unit.to_si(value) }
}

/// The inputs in SI units, padded to the length that formulas take.
pub(crate) fn to_si(model: &Model, inputs: &[f64]) -> [f64; INPUTS] {
    let mut si = [0.0; INPUTS];
    for ((si, input), &value) in si.iter_mut().zip(&model.inputs).zip(inputs) {
        *si = input_to_si(input, value);
    }
    si
}

/// Does this condition hold, given its margin? In f64 the answer is never unsure.
pub(crate) fn holds(model: &Model, condition: usize, margin: f64, bound: f64) -> Decision {
    if model.conditions[condition].strict { Decision::above_zero(margin, bound) } else { Decision::at_least_zero(margin, bound) }
}

/// Status, and which outputs remain, from the f64 margins.
pub(crate) fn judge(model: &Model, margins: &[f64; CONDITIONS]) -> (Status, u64) {
    let mut status = Status::Ok;
    let mut present = u64::MAX;
    for (number, condition) in model.conditions.iter().enumerate() {
        if holds(model, number, margins[number], 0.0) != Decision::Yes {
            if status == Status::Ok && !condition.quiet {
                status = Status::Failed(number);
            }
            for name in &condition.invalidates {
                present &= !model.output(name).map_or(0, |output| 1 << output);
            }
        }
    }
    (status, present)
}

/// An output in its unit, if it has a meaning. A number that overflowed is as absent as one without: never a NaN or infinity in a file.
pub(crate) fn shown(model: &Model, outputs: &[f64; OUTPUTS], present: u64, output: usize) -> Option<f64> {
    let value = model.outputs[output].unit.from_si(outputs[output]);
    (present >> output & 1 == 1 && value.is_finite()).then_some(value)
}

/// Evaluates a model in f64. `inputs`: one value per input of the model, in its unit.
///
/// The values are not checked against the inputs' ranges: what has no meaning shows as a status.
pub fn evaluate(model: &Model, inputs: &[f64]) -> Evaluation {
    evaluate_asked(model, inputs, u64::MAX)
}

/// The same where only the outputs of a bit set are asked for: an overflow of another one leaves the status as it is.
pub fn evaluate_asked(model: &Model, inputs: &[f64], asked: u64) -> Evaluation {
    let si = to_si(model, inputs);
    evaluated(model, &si, &model.kernel.prepared(&si), asked)
}

/// The second stage of an evaluation, of inputs in SI units and what was prepared of them.
pub(super) fn evaluated(model: &Model, si: &[f64; INPUTS], prepared: &[f64], asked: u64) -> Evaluation {
    let mut outputs = [0.0; OUTPUTS];
    model.kernel.finish(prepared, si, u64::MAX, &mut outputs);
    let (status, present) = judge(model, &model.kernel.conditions(prepared, si));
    let outputs: Vec<_> = (0..model.outputs.len()).map(|output| shown(model, &outputs, present, output)).collect();
    // What no condition takes away and is absent all the same has overflowed.
    let overflow = outputs.iter().enumerate().any(|(output, value)| value.is_none() && (asked & present) >> output & 1 == 1);
    let status = if status == Status::Ok && overflow { Status::Overflow } else { status };
    Evaluation { status, outputs }
}
