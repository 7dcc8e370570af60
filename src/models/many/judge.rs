//! Status and presence of outputs over a chunk of rows.

use crate::decision::Decision;
use crate::models::{Model, Status, holds};
use crate::tape::ColumnValue;

/// Which rows of a chunk fail a condition.
type FailedRows = Box<[bool]>;

/// Judges rows of a model by the margins of its conditions.
#[derive(Debug)]
pub(crate) struct ColumnJudge {
    outputs: Vec<JudgedOutput>,
}

/// An output that is asked for.
#[derive(Debug)]
struct JudgedOutput {
    number: usize,
    /// The conditions that take it away where they fail.
    takers: Vec<usize>,
    /// Is it a status if it overflows?
    counts: bool,
}

impl ColumnJudge {
    /// For these outputs; an overflow is a status of those that count.
    pub fn new(model: &Model, outputs: &[usize], counts: impl Fn(usize) -> bool) -> Self {
        let takes = |condition: usize, output: usize| {
            model.conditions[condition].invalidates.iter().any(|name| *name == model.outputs[output].name)
        };
        let judged = |&number: &usize| JudgedOutput {
            number,
            takers: (0..model.conditions.len()).filter(|&it| takes(it, number)).collect(),
            counts: counts(number),
        };
        Self { outputs: outputs.iter().map(judged).collect() }
    }

    /// Judges a chunk: `margin` of each condition and `value` of each output asked for, in SI units. Statuses must be ok before; outputs are
    /// written in their units, NaN where they have no meaning.
    pub fn judge<'c>(
        &self,
        model: &Model,
        margin: impl Fn(usize) -> ColumnValue<'c>,
        value: impl Fn(usize) -> ColumnValue<'c>,
        statuses: &mut [Status],
        outputs: &mut [&mut [f64]],
    ) {
        let failed: Vec<Option<FailedRows>> =
            (0..model.conditions.len()).map(|condition| failures(model, condition, margin(condition), statuses.len())).collect();
        for (number, (condition, failed)) in model.conditions.iter().zip(&failed).enumerate() {
            let Some(failed) = failed.as_ref().filter(|_| !condition.quiet) else { continue };
            for (status, _) in statuses.iter_mut().zip(failed).filter(|(status, failed)| **failed && **status == Status::Ok) {
                *status = Status::Failed(number);
            }
        }
        for (place, (column, output)) in outputs.iter_mut().zip(&self.outputs).enumerate() {
            let unit = model.outputs[output.number].unit;
            match value(place) {
                ColumnValue::One(value) => column.fill(unit.from_si(value)),
                ColumnValue::Each(values) => column.iter_mut().zip(values).for_each(|(to, &value)| *to = unit.from_si(value)),
            }
            let takers: Vec<&FailedRows> = output.takers.iter().filter_map(|&it| failed[it].as_ref()).collect();
            clear(column, &takers, output.counts, statuses);
        }
    }
}

/// The rows in which a condition fails; `None` if it holds in all.
fn failures(model: &Model, condition: usize, margins: ColumnValue<'_>, count: usize) -> Option<FailedRows> {
    let fails = |margin: f64| holds(model, condition, margin, 0.0) != Decision::Yes;
    match margins {
        ColumnValue::One(margin) => fails(margin).then(|| vec![true; count].into()),
        ColumnValue::Each(margins) => {
            let strict = model.conditions[condition].strict;
            // What most rows pass is asked in a way that is quick.
            let surely = if strict { margins.iter().all(|&it| it > 0.0) } else { margins.iter().all(|&it| it >= 0.0) };
            (!surely).then(|| margins.iter().map(|&margin| fails(margin)).collect())
        }
    }
}

/// Takes away what has no meaning: values that failed conditions take, and those that overflowed, which is a status of its own where no
/// condition fails and the output counts.
fn clear(column: &mut [f64], takers: &[&FailedRows], counts: bool, statuses: &mut [Status]) {
    if takers.is_empty() && column.iter().fold(true, |all, value| all & value.is_finite()) {
        return;
    }
    for (row, (value, status)) in column.iter_mut().zip(statuses).enumerate() {
        if takers.iter().any(|failed| failed[row]) {
            *value = f64::NAN;
        } else if !value.is_finite() {
            *value = f64::NAN;
            if counts && *status == Status::Ok {
                *status = Status::Overflow;
            }
        }
    }
}
