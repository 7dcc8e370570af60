//! A model over columns of its inputs: its recorded formula, a chunk of rows at a time.

use super::{Asked, ResultPart, input_to_si};
use crate::decision::Decision;
use crate::models::{Model, Status, holds};
use crate::tape::{CHUNK, ColumnValue, Known, List, ListColumns, Set};

/// Formulas with more operations than this are evaluated one by one: their columns would not fit the caches.
const MOST_OPERATIONS: usize = 4096;

/// The formula with what is known of the inputs.
pub struct RecordedColumns {
    list: List,
    /// Of each output asked for: the conditions that take it away where they fail.
    takers: Vec<Vec<usize>>,
}

/// Which rows of a chunk fail a condition.
type FailedRows = Box<[bool]>;

/// What is known of a column in SI units: its ends, unless a value is no number.
fn known(model: &Model, input: usize, values: &[f64]) -> Known {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for &value in values {
        let value = input_to_si(&model.inputs[input], value);
        if value.is_nan() {
            return Known::ANY;
        }
        (low, high) = (low.min(value), high.max(value));
    }
    Known::Within(low, high)
}

impl RecordedColumns {
    /// Records a formula; `None` if that cannot be, or does not pay.
    pub fn new(asked: &Asked<'_>) -> Option<Self> {
        let Asked { model, given, inputs, outputs, .. } = *asked;
        let formula = model.kernel.formula()?;
        let mut of_inputs: Vec<Known> =
            model.inputs.iter().zip(inputs).map(|(input, &value)| Known::Fixed(input_to_si(input, value))).collect();
        given.iter().for_each(|&(input, values)| of_inputs[input] = known(model, input, values));
        let wanted = Set::of(outputs);
        let conditions: Vec<usize> = (0..model.conditions.len()).collect();
        let whole = formula.whole(&of_inputs, wanted, Set::of(&conditions));
        let results = outputs.iter().map(|&output| whole.outputs[output]).chain(conditions.iter().map(|&it| whole.conditions[it]));
        let list = List::cut(&whole.recording, &results.map(Some).collect::<Vec<_>>());
        let takes = |condition: usize, output: usize| {
            model.conditions[condition].invalidates.iter().any(|name| *name == model.outputs[output].name)
        };
        let takers = outputs.iter().map(|&output| conditions.iter().copied().filter(|&it| takes(it, output)).collect()).collect();
        (list.operations.len() <= MOST_OPERATIONS).then_some(Self { list, takers })
    }

    /// Fills some rows of the result.
    pub fn evaluate(&self, asked: &Asked<'_>, part: ResultPart<'_>) {
        let Asked { model, given, outputs: wanted, options, .. } = *asked;
        let ResultPart { first, statuses, mut outputs } = part;
        let list = &self.list;
        let mut columns = ListColumns::new(list);
        columns.turn_to(list, 0..list.results.len(), |_| true);
        let mut si: Vec<(usize, Vec<f64>)> = given.iter().map(|&(input, _)| (input, vec![0.0; CHUNK])).collect();
        for start in (0..statuses.len()).step_by(CHUNK) {
            if options.is_stopped() {
                return;
            }
            let count = CHUNK.min(statuses.len() - start);
            for ((input, column), (_, values)) in si.iter_mut().zip(given) {
                let (input, values) = (&model.inputs[*input], &values[first + start..][..count]);
                column.iter_mut().zip(values).for_each(|(si, &value)| *si = input_to_si(input, value));
            }
            let input = |number: u16| {
                let column = si.iter().find(|(input, _)| *input == usize::from(number));
                column.map_or(ColumnValue::One(f64::NAN), |(_, column)| ColumnValue::Each(&column[..count]))
            };
            columns.run(list, count, input, |columns, _, _| {
                let statuses = &mut statuses[start..start + count];
                let margin = |condition: usize| columns.result(list, wanted.len() + condition);
                let failed: Vec<Option<FailedRows>> =
                    (0..model.conditions.len()).map(|condition| failures(model, condition, margin(condition), count)).collect();
                for (number, (condition, failed)) in model.conditions.iter().zip(&failed).enumerate() {
                    let Some(failed) = failed.as_ref().filter(|_| !condition.quiet) else { continue };
                    for (status, _) in statuses.iter_mut().zip(failed).filter(|(status, failed)| **failed && **status == Status::Ok) {
                        *status = Status::Failed(number);
                    }
                }
                for (place, (column, &output)) in outputs.iter_mut().zip(wanted).enumerate() {
                    let unit = model.outputs[output].unit;
                    let column = &mut column[start..start + count];
                    match columns.result(list, place) {
                        ColumnValue::One(value) => column.fill(unit.from_si(value)),
                        ColumnValue::Each(values) => column.iter_mut().zip(values).for_each(|(to, &value)| *to = unit.from_si(value)),
                    }
                    let takers: Vec<&FailedRows> = self.takers[place].iter().filter_map(|&it| failed[it].as_ref()).collect();
                    clear(column, &takers, statuses);
                }
            });
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
/// condition fails.
fn clear(column: &mut [f64], takers: &[&FailedRows], statuses: &mut [Status]) {
    if takers.is_empty() && column.iter().fold(true, |all, value| all & value.is_finite()) {
        return;
    }
    for (row, (value, status)) in column.iter_mut().zip(statuses).enumerate() {
        if takers.iter().any(|failed| failed[row]) {
            *value = f64::NAN;
        } else if !value.is_finite() {
            *value = f64::NAN;
            if *status == Status::Ok {
                *status = Status::Overflow;
            }
        }
    }
}
