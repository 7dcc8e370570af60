//! A model over columns of its inputs: its recorded formula, a chunk of rows at a time.

use super::judge::{ColumnJudge, JudgeRoom};
use super::vectors::{ColumnEnds, converted, ends};
use super::{AskedColumns, ResultColumns, ResultPart, input_to_si};
use crate::models::{Input, Model, Status};
use crate::parallel::on_threads;
use crate::tape::{Known, LIST_CHUNK, List, ListColumns, Set};

/// Formulas with more operations than this are evaluated one by one: their columns would not fit the caches.
const MOST_OPERATIONS: usize = 4096;

/// Numbers from which on several threads look at them.
const MUCH: usize = 100_000;

/// The formula with what is known of the inputs.
pub struct RecordedColumns {
    list: List,
    judge: ColumnJudge,
}

/// What is known of a column in SI units: its ends, unless a value is no number.
fn known(model: &Model, input: usize, values: &[f64], known: Option<ColumnEnds>) -> Known {
    let input = &model.inputs[input];
    if input.words.is_empty() {
        // A unit is a factor above zero, so that the ends stay the ends.
        let ends = known.unwrap_or_else(|| ends(values));
        return if ends.numbers { Known::Within(input.unit.to_si(ends.low), input.unit.to_si(ends.high)) } else { Known::ANY };
    }
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for &value in values {
        let value = input_to_si(input, value);
        if value.is_nan() {
            return Known::ANY;
        }
        (low, high) = (low.min(value), high.max(value));
    }
    Known::Within(low, high)
}

/// A column in SI units.
fn fill_si(input: &Input, values: &[f64], to: &mut [f64]) {
    if input.words.is_empty() {
        let _ = converted(values, input.unit.factors(), to);
    } else {
        to.iter_mut().zip(values).for_each(|(si, &value)| *si = input_to_si(input, value));
    }
}

impl RecordedColumns {
    /// Records a formula; `None` if that cannot be, or does not pay.
    pub fn new(asked: &AskedColumns<'_>) -> Option<Self> {
        let AskedColumns { model, given, inputs, outputs, .. } = *asked;
        let formula = model.kernel.formula()?;
        let mut of_inputs: Vec<Known> =
            model.inputs.iter().zip(inputs).map(|(input, &value)| Known::Fixed(input_to_si(input, value))).collect();
        let is_much = asked.options.ends.is_none() && given.iter().map(|(_, values)| values.len()).sum::<usize>() >= MUCH;
        let share = if is_much { given.len().div_ceil(asked.options.threads.max(1)) } else { given.len() };
        let ends = |column: usize| asked.options.ends.and_then(|ends| ends[column]);
        let columns: Vec<(usize, &(usize, &[f64]))> = given.iter().enumerate().collect();
        let found = on_threads(columns.chunks(share.max(1)), |part| {
            part.iter().map(|&(at, &(input, values))| (input, known(model, input, values, ends(at)))).collect::<Vec<_>>()
        });
        found.into_iter().flatten().for_each(|(input, known)| of_inputs[input] = known);
        let wanted = Set::of(outputs);
        let conditions: Vec<usize> = (0..model.conditions.len()).collect();
        let whole = formula.whole(&of_inputs, wanted, Set::of(&conditions));
        let results = outputs.iter().map(|&output| whole.outputs[output]).chain(conditions.iter().map(|&it| whole.conditions[it]));
        let list = List::cut(&whole.recording, &results.map(Some).collect::<Vec<_>>());
        let judge = ColumnJudge::new(model, outputs, |_| true);
        (list.operations.len() <= MOST_OPERATIONS).then_some(Self { list, judge })
    }

    /// Fills some rows of the result.
    pub fn evaluate<S: From<Status>>(&self, asked: &AskedColumns<'_>, part: ResultPart<'_, S>) {
        let AskedColumns { model, given, inputs, outputs: wanted, options } = *asked;
        let ResultPart { first, results: ResultColumns { statuses, mut outputs } } = part;
        let list = &self.list;
        let mut columns = ListColumns::new(list);
        columns.turn_to(list, 0..list.results.len(), |_| true);
        let (mut room, mut judged) = (JudgeRoom::default(), [0; LIST_CHUNK]);
        for start in (0..statuses.len()).step_by(LIST_CHUNK) {
            if options.is_stopped() {
                return;
            }
            let count = LIST_CHUNK.min(statuses.len() - start);
            columns.chunk(list, count, |number, node, numbers| {
                let input = usize::from(number);
                let of_input = &model.inputs[input];
                numbers.fill(node, |to| match given.iter().find(|(given, _)| *given == input) {
                    Some((_, values)) => fill_si(of_input, &values[first + start..][..count], to),
                    None => to.fill(input_to_si(of_input, inputs[input])),
                });
            });
            let judged = &mut judged[..count];
            let margin = |condition: usize| Some(columns.result(list, wanted.len() + condition));
            let mut outputs: Vec<&mut [f64]> = outputs.iter_mut().map(|column| &mut column[start..start + count]).collect();
            self.judge.judge(model, margin, |place| Some(columns.result(list, place)), judged, &mut outputs, &mut room);
            statuses[start..][..count].iter_mut().zip(judged).for_each(|(status, judged)| *status = S::from(Status::of_number(*judged)));
        }
    }
}
