//! What a map shows, and along what: for its files and its picture.

use crate::study::{Axis, Best, Levels, MapSpec, Study};

/// Name of a map of feasible shares, in place of a quantity's.
const SHARE: &str = "feasible_share";

/// What a map shows: name and unit.
pub fn value_of<'s>(study: &'s Study, spec: &MapSpec) -> (&'s str, &'static str) {
    match spec.value {
        Best::Value(quantity, _) => (quantity.name(&study.model), quantity.unit(&study.model)),
        Best::Share => (SHARE, ""),
    }
}

/// Is a level of this axis of one input a word?
pub fn has_words(study: &Study, axis: &Axis) -> bool {
    let input = &study.model.inputs[axis.inputs()[0]];
    // Levels given by a rule are numbers.
    let listed = !matches!(axis, Axis::Single { levels: Levels::Even { .. } | Levels::Step { .. } | Levels::Continuous { .. }, .. });
    listed && (0..axis.count()).any(|level| input.word_for(axis.value(0, level)).is_some())
}
