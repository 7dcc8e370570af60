//! A model over columns of its inputs: its recorded formula, a chunk of rows at a time.

use super::judge::{ColumnJudge, JudgeRoom};
use super::vectors::{ColumnEnds, converted, ends};
use super::{AskedColumns, ResultColumns, ResultPart, input_to_si};
use crate::models::{Input, Status};
use crate::tape::{Known, LIST_CHUNK, List, ListColumns, Set};
use std::sync::OnceLock;

/// Formulas with more operations than this are evaluated one by one: their columns would not fit the caches.
const MOST_OPERATIONS: usize = 4096;

/// Of a long column so many rows are looked at to say what it may have, in so many places.
const SAMPLED: usize = 256;
const PLACES: usize = 16;

/// The formula over columns of inputs.
pub struct RecordedColumns {
    /// For columns that lie within what a sample of them says.
    narrow: List,
    /// The ends that are meant, in the input's unit; `None`: of this column nothing was supposed.
    supposed: Vec<Option<(f64, f64)>>,
    /// For all that the columns hold, if that pays.
    wide: OnceLock<Option<List>>,
    judge: ColumnJudge,
}

/// Room for a thread that evaluates, for each of the two lists; made where it is used.
#[derive(Default)]
pub struct RecordedRooms {
    narrow: Option<RecordedRoom>,
    wide: Option<RecordedRoom>,
}

struct RecordedRoom {
    columns: ListColumns,
    judge: JudgeRoom,
}

impl RecordedRoom {
    fn new(list: &List) -> Self {
        let mut columns = ListColumns::new(list);
        columns.turn_to(list, 0..list.results.len(), |_| true);
        Self { columns, judge: JudgeRoom::default() }
    }
}

/// What a sample of a column says: somewhat more than its ends, with the sign that they have; `None` if a value is no number.
fn supposed(values: &[f64]) -> Option<(f64, f64)> {
    let last = values.len().saturating_sub(SAMPLED);
    let places = if last < SAMPLED * PLACES {
        vec![values]
    } else {
        (0..PLACES).map(|place| &values[last * place / (PLACES - 1)..][..SAMPLED]).collect()
    };
    let sampled: Vec<ColumnEnds> = places.iter().map(|values| ends(values)).collect();
    let (low, high) = sampled.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), it| (low.min(it.low), high.max(it.high)));
    let beyond = if places.len() > 1 { 0.125 * (high - low) } else { 0.0 };
    let less = if low - beyond < 0.0 && low >= 0.0 { 0.5 * low } else { low - beyond };
    let more = if high + beyond > 0.0 && high <= 0.0 { 0.5 * high } else { high + beyond };
    sampled.iter().all(|it| it.numbers).then_some((less, more))
}

/// What is known of a column of words and numbers, in SI units: its ends, unless a value is no number.
fn known_of_words(input: &Input, values: &[f64]) -> Known {
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
        asked.model.kernel.formula()?;
        // Of words and numbers all are looked at.
        let is_of_numbers = |input: usize| asked.model.inputs[input].words.is_empty();
        let supposed: Vec<_> = asked.given.iter().map(|&(input, values)| supposed(values).filter(|_| is_of_numbers(input))).collect();
        let narrow = Self::recorded(asked, |column| supposed[column]);
        let judge = ColumnJudge::new(asked.model, asked.outputs, |_| true);
        (narrow.operations.len() <= MOST_OPERATIONS).then_some(Self { narrow, supposed, wide: OnceLock::new(), judge })
    }

    /// The formula as a list, where columns of numbers have these ends, in the unit of the input.
    fn recorded(asked: &AskedColumns<'_>, ends: impl Fn(usize) -> Option<(f64, f64)>) -> List {
        let AskedColumns { model, given, inputs, outputs, .. } = *asked;
        let mut known: Vec<Known> =
            model.inputs.iter().zip(inputs).map(|(input, &value)| Known::Fixed(input_to_si(input, value))).collect();
        for (column, &(number, values)) in given.iter().enumerate() {
            let input = &model.inputs[number];
            known[number] = match ends(column) {
                _ if !input.words.is_empty() => known_of_words(input, values),
                // A unit is a factor above zero, so that the ends stay the ends.
                Some((low, high)) => Known::Within(input.unit.to_si(low), input.unit.to_si(high)),
                None => Known::ANY,
            };
        }
        let formula = model.kernel.formula().expect("it has been looked for");
        let whole = formula.whole(&known, Set::of(outputs), (0..model.conditions.len()).collect());
        whole.settled(&known, outputs, model.conditions.iter().map(|it| it.strict))
    }

    /// Fills some rows of the result, whose inputs have these ends.
    pub fn evaluate<S: From<Status>>(
        &self,
        asked: &AskedColumns<'_>,
        part: ResultPart<'_, S>,
        ends: &[ColumnEnds],
        rooms: &mut RecordedRooms,
    ) {
        let AskedColumns { model, given, inputs, outputs: wanted, options } = *asked;
        let ResultPart { first, results: ResultColumns { statuses, mut outputs } } = part;
        let is_within = |(ends, supposed): (&ColumnEnds, &Option<(f64, f64)>)| {
            supposed.is_none_or(|(low, high)| ends.numbers && low <= ends.low && ends.high <= high)
        };
        let (list, room) = if ends.iter().zip(&self.supposed).all(is_within) {
            (&self.narrow, &mut rooms.narrow)
        } else {
            let of_all = || {
                let ends: Vec<ColumnEnds> = given.iter().map(|(_, values)| super::ends(values)).collect();
                let list = Self::recorded(asked, |column| ends[column].numbers.then_some((ends[column].low, ends[column].high)));
                Some(list).filter(|list| list.operations.len() <= MOST_OPERATIONS)
            };
            let Some(list) = self.wide.get_or_init(of_all) else {
                return asked.one_by_one(ResultPart { first, results: ResultColumns { statuses, outputs } });
            };
            (list, &mut rooms.wide)
        };
        let RecordedRoom { columns, judge } = room.get_or_insert_with(|| RecordedRoom::new(list));
        let mut judged = [0; LIST_CHUNK];
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
            // A condition that surely holds has no margin.
            let margin = |condition: usize| columns.asked_result(list, wanted.len() + condition);
            let mut outputs: Vec<&mut [f64]> = outputs.iter_mut().map(|column| &mut column[start..start + count]).collect();
            self.judge.judge(model, margin, |place| columns.asked_result(list, place), judged, &mut outputs, judge);
            statuses[start..][..count].iter_mut().zip(judged).for_each(|(status, judged)| *status = S::from(Status::of_number(*judged)));
        }
    }
}
