//! Many designs of a model, evaluated in f64: operation by operation over columns where the formula can be recorded, else one by one.

mod columns;
mod judge;
mod vectors;

use super::{Evaluation, Model, Status, evaluate, evaluate_asked, input_to_si};
use crate::error::{Error, Result};
use crate::likeness::closest;
use crate::parallel::on_threads;
use crate::tape::{LIST_CHUNK, Set};
use columns::{RecordedColumns, RecordedRooms};
pub(crate) use judge::{ColumnJudge, JudgeRoom};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
pub(crate) use vectors::{ColumnEnds, ends};

/// Rows that a thread is started for at least.
const ROWS_PER_THREAD: usize = 256;
/// Rows that a thread takes at a time, about: what is read of them twice stays in the second-level cache.
const ROWS_AT_A_TIME: usize = 6 * LIST_CHUNK;
/// Rows from which on recording the formula takes less time than it saves.
const ROWS_TO_RECORD: usize = 512;

/// What many evaluations give, one entry per row of the columns that they were asked with.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Evaluations {
    /// Ok, or why not.
    pub statuses: Vec<Status>,
    /// One column per output of the model, in the order of the model and in the output's unit; `None` where it has no meaning.
    pub outputs: Vec<Vec<Option<f64>>>,
}

impl Evaluations {
    /// The column of the output of that name.
    pub fn output(&self, model: &Model, name: &str) -> Option<&[Option<f64>]> {
        self.outputs.get(model.output(name)?).map(Vec::as_slice)
    }
}

/// What many evaluations give, as columns of plain numbers.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct EvaluatedColumns {
    /// Of every row: ok, or why not.
    pub statuses: Vec<Status>,
    /// One column per output that was asked for, in that order and in the output's unit; NaN where it has no meaning.
    pub outputs: Vec<Vec<f64>>,
}

/// Where [`evaluate_into`] writes: everything has as many rows as the columns of inputs. What stood there before is lost.
#[derive(Debug)]
pub struct ResultColumns<'a, S = Status> {
    /// Of every row: ok, or why not.
    pub statuses: &'a mut [S],
    /// One column per output that is asked for, in that order and in the output's unit; NaN where it has no meaning.
    pub outputs: Vec<&'a mut [f64]>,
}

/// How many designs are evaluated, and what of them is asked for.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ManyOptions<'a> {
    /// The outputs, by number; `None`: all. An overflow of an output that is not asked for leaves the status as it is.
    pub outputs: Option<&'a [usize]>,
    /// Values of the inputs without a column, in their units; `None`: their defaults.
    pub inputs: Option<&'a [f64]>,
    /// Most threads, at least 1. By default one per core.
    pub threads: usize,
    /// Set by somebody else to end the work.
    pub stop: Option<&'a AtomicBool>,
    /// Asked before rows are evaluated: may a column have such numbers? Else the work ends as if it were stopped.
    pub(crate) check: Option<ColumnCheck<'a>>,
}

/// May the column of this number, in the order of the columns, have numbers with these ends?
#[derive(Clone, Copy)]
pub(crate) struct ColumnCheck<'a>(pub &'a (dyn Fn(usize, ColumnEnds) -> bool + Sync));

impl std::fmt::Debug for ColumnCheck<'_> {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        to.write_str("a check")
    }
}

impl Default for ManyOptions<'_> {
    fn default() -> Self {
        let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        Self { outputs: None, inputs: None, threads, stop: None, check: None }
    }
}

impl<'a> ManyOptions<'a> {
    /// The same where these outputs are asked for.
    #[must_use]
    pub fn outputs(self, outputs: &'a [usize]) -> Self {
        Self { outputs: Some(outputs), ..self }
    }

    /// The same with these values of the inputs that have no column: one per input of the model, in its unit.
    #[must_use]
    pub fn inputs(self, inputs: &'a [f64]) -> Self {
        Self { inputs: Some(inputs), ..self }
    }

    /// The same with this many threads, at least 1.
    #[must_use]
    pub fn threads(self, threads: usize) -> Self {
        Self { threads: threads.max(1), ..self }
    }

    /// The same where this flag ends the work.
    #[must_use]
    pub fn stop(self, stop: &'a AtomicBool) -> Self {
        Self { stop: Some(stop), ..self }
    }

    fn is_stopped(&self) -> bool {
        self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
    }
}

/// Evaluates a model in f64 for every row of some columns, on every core: the same numbers as [`evaluate`] gives, in the order of the rows.
///
/// A column is the name of an input and its values, in the input's unit; all are equally long. Inputs without a column have their
/// defaults. As in [`evaluate`] values are not checked against the inputs' ranges.
///
/// ```
/// use beltspace::models;
///
/// let model = models::find("metal-cvt").unwrap();
/// let found = models::evaluate_many(&model, &[("band_count", &[6.0, 9.0, 12.0]), ("torque_Nm", &[50.0, 100.0, 150.0])])?;
/// let forces = found.output(&model, "axial_force_N").unwrap();
/// assert!(forces[0] < forces[2]);
/// # Ok::<(), beltspace::Error>(())
/// ```
///
/// # Errors
/// [`Error::NoSuchInput`] for a name that the model does not have; [`Error::Columns`] if an input has two columns or columns differ in
/// length.
pub fn evaluate_many(model: &Model, columns: &[(&str, &[f64])]) -> Result<Evaluations> {
    let EvaluatedColumns { statuses, outputs } = evaluate_columns(model, columns, &ManyOptions::default())?;
    let present = |column: Vec<f64>| column.into_iter().map(|value| (!value.is_nan()).then_some(value)).collect();
    Ok(Evaluations { statuses, outputs: outputs.into_iter().map(present).collect() })
}

/// The same as columns of plain numbers, of as many outputs and on as many threads as asked for. A column takes 8 bytes a row.
///
/// ```
/// use beltspace::models::{self, ManyOptions};
///
/// let model = models::find("metal-cvt").unwrap();
/// let wanted = [model.output("axial_force_N").unwrap()];
/// let counts: Vec<f64> = (4..14).map(f64::from).collect();
/// let found = models::evaluate_columns(&model, &[("band_count", &counts)], &ManyOptions::default().outputs(&wanted))?;
/// assert_eq!((found.outputs.len(), found.outputs[0].len()), (1, 10));
/// # Ok::<(), beltspace::Error>(())
/// ```
///
/// # Errors
/// As [`evaluate_many`]; [`Error::Request`] if there is no output of a number, or values for more or fewer inputs than the model has;
/// [`Error::Stopped`] after `stop`.
pub fn evaluate_columns(model: &Model, columns: &[(&str, &[f64])], options: &ManyOptions<'_>) -> Result<EvaluatedColumns> {
    let rows = columns.first().map_or(0, |(_, values)| values.len());
    let count = options.outputs.map_or(model.outputs.len(), <[usize]>::len);
    // Zeros from the system, each column by itself: the threads are the first to touch them.
    let mut found = EvaluatedColumns { statuses: vec![Status::Ok; rows], outputs: (0..count).map(|_| vec![0.0; rows]).collect() };
    let EvaluatedColumns { statuses, outputs } = &mut found;
    let results = ResultColumns { statuses, outputs: outputs.iter_mut().map(Vec::as_mut_slice).collect() };
    evaluate_into(model, columns, options, results)?;
    Ok(found)
}

/// The same, written into memory that the caller provides. Statuses are of any type that [`Status`] turns into, such as `u16`.
///
/// ```
/// use beltspace::models::{self, ManyOptions, ResultColumns};
///
/// let model = models::find("metal-cvt").unwrap();
/// let wanted = [model.output("axial_force_N").unwrap()];
/// let (mut codes, mut forces) = ([9_u16; 2], [0.0; 2]);
/// let results = ResultColumns { statuses: &mut codes, outputs: vec![&mut forces] };
/// models::evaluate_into(&model, &[("band_count", &[6.0, 9.0])], &ManyOptions::default().outputs(&wanted), results)?;
/// assert!(codes == [0, 0] && forces[0] > 0.0);
/// # Ok::<(), beltspace::Error>(())
/// ```
///
/// # Errors
/// As [`evaluate_columns`]; [`Error::Request`] if the results have another number of rows or columns. After [`Error::Stopped`] the results
/// are incomplete.
pub fn evaluate_into<S: From<Status> + Send>(
    model: &Model,
    columns: &[(&str, &[f64])],
    options: &ManyOptions<'_>,
    results: ResultColumns<'_, S>,
) -> Result<()> {
    let rows = columns.first().map_or(0, |(_, values)| values.len());
    let mut given: Vec<(usize, &[f64])> = Vec::with_capacity(columns.len());
    for &(name, values) in columns {
        let input = model.input(name).ok_or_else(|| no_such_input(model, name))?;
        if given.iter().any(|(it, _)| *it == input) || values.len() != rows {
            return Err(Error::Columns { name: name.to_owned(), rows: values.len(), expected: rows });
        }
        given.push((input, values));
    }
    let all: Vec<usize> = (0..model.outputs.len()).collect();
    let outputs = options.outputs.unwrap_or(&all);
    let defaults = model.defaults();
    let inputs = options.inputs.unwrap_or(&defaults);
    if let Some(wrong) = outputs.iter().find(|&&it| it >= model.outputs.len()) {
        return Err(Error::Request(format!("{} has no output number {wrong}", model.name)));
    }
    if inputs.len() != model.inputs.len() {
        let (there, wanted) = (inputs.len(), model.inputs.len());
        return Err(Error::Request(format!("there are values for {there} inputs, but {} has {wanted}", model.name)));
    }
    if results.outputs.len() != outputs.len() {
        let (there, wanted) = (results.outputs.len(), outputs.len());
        return Err(Error::Request(format!("there is room for {there} outputs, but {wanted} are asked for")));
    }
    let lengths = results.outputs.iter().map(|column| column.len()).chain([results.statuses.len()]);
    if let Some(there) = lengths.into_iter().find(|length| *length != rows) {
        return Err(Error::Request(format!("there is room for {there} rows, but there are {rows}")));
    }
    let asked = AskedColumns { model, given: &given, inputs, outputs, options };
    let recorded = (rows >= ROWS_TO_RECORD).then(|| RecordedColumns::new(&asked)).flatten();
    let share = rows.div_ceil(options.threads.max(1)).max(ROWS_PER_THREAD);
    let share = share.div_ceil((share / ROWS_AT_A_TIME).max(1));
    let parts = parts(results, share);
    let threads = options.threads.max(1).min(parts.len());
    // Whoever is done takes the next part: another program may have the core of somebody else.
    let next = Mutex::new(parts.into_iter());
    let take = || next.lock().unwrap_or_else(PoisonError::into_inner).next();
    let refused = AtomicBool::new(false);
    on_threads(0..threads, |_| {
        let mut rooms = RecordedRooms::default();
        while let Some(part) = take() {
            let ends = asked.ends(part.rows());
            refused.fetch_or(!asked.accepts(&ends), Ordering::Relaxed);
            if refused.load(Ordering::Relaxed) {
                break;
            }
            match &recorded {
                Some(recorded) => recorded.evaluate(&asked, part, &ends, &mut rooms),
                None => asked.one_by_one(part),
            }
        }
    });
    if options.is_stopped() || refused.into_inner() { Err(Error::Stopped { kept: None }) } else { Ok(()) }
}

/// What is asked.
struct AskedColumns<'a> {
    model: &'a Model,
    /// Inputs with a column.
    given: &'a [(usize, &'a [f64])],
    /// Values of the others.
    inputs: &'a [f64],
    outputs: &'a [usize],
    options: &'a ManyOptions<'a>,
}

/// Rows of the result that one thread fills.
struct ResultPart<'a, S> {
    first: usize,
    results: ResultColumns<'a, S>,
}

impl<S> ResultPart<'_, S> {
    fn rows(&self) -> Range<usize> {
        self.first..self.first + self.results.statuses.len()
    }
}

/// The result in parts of so many rows.
fn parts<S>(results: ResultColumns<'_, S>, share: usize) -> Vec<ResultPart<'_, S>> {
    let mut outputs: Vec<_> = results.outputs.into_iter().map(|column| column.chunks_mut(share)).collect();
    let part = |(number, statuses)| {
        let outputs = outputs.iter_mut().filter_map(Iterator::next).collect();
        ResultPart { first: number * share, results: ResultColumns { statuses, outputs } }
    };
    results.statuses.chunks_mut(share).enumerate().map(part).collect()
}

impl AskedColumns<'_> {
    /// The ends of some rows of each column.
    fn ends(&self, rows: Range<usize>) -> Vec<ColumnEnds> {
        self.given.iter().map(|(_, values)| ends(&values[rows.clone()])).collect()
    }

    fn accepts(&self, ends: &[ColumnEnds]) -> bool {
        let accepts = |check: ColumnCheck<'_>| ends.iter().enumerate().all(|(column, &ends)| (check.0)(column, ends));
        self.options.check.is_none_or(accepts)
    }

    fn one_by_one<S: From<Status>>(&self, part: ResultPart<'_, S>) {
        let ResultPart { first, results: ResultColumns { statuses, mut outputs } } = part;
        let (asked, mut inputs) = (Set::of(self.outputs), self.inputs.to_vec());
        for (row, place) in statuses.iter_mut().enumerate() {
            if self.options.is_stopped() {
                return;
            }
            self.given.iter().for_each(|&(input, values)| inputs[input] = values[first + row]);
            let Evaluation { status, outputs: values } =
                if self.options.outputs.is_none() { evaluate(self.model, &inputs) } else { evaluate_asked(self.model, &inputs, asked) };
            *place = status.into();
            for (column, &output) in outputs.iter_mut().zip(self.outputs) {
                column[row] = values[output].unwrap_or(f64::NAN);
            }
        }
    }
}

fn no_such_input(model: &Model, name: &str) -> Error {
    let names: Vec<_> = model.inputs.iter().map(|it| it.name.as_str()).collect();
    Error::NoSuchInput { model: model.name.to_owned(), name: name.to_owned(), closest: closest(name, &names).map(str::to_owned) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_are_the_same_as_one_by_one_on_every_model() {
        for model in crate::models::all() {
            let rows = if model.name == "pulley" { 3 } else { 700 };
            let input = &model.inputs[0];
            let values: Vec<f64> = (0..rows).map(|row| input.default * (1.0 + 0.001 * f64::from(row))).collect();
            let found = evaluate_many(model, &[(&input.name, &values)]).expect("the names are the model's");
            let mut inputs = model.defaults();
            for (row, &value) in values.iter().enumerate() {
                inputs[0] = value;
                let one = evaluate(model, &inputs);
                assert_eq!(found.statuses[row], one.status);
                assert!(found.outputs.iter().zip(&one.outputs).all(|(column, value)| column[row] == *value), "{} {row}", model.name);
            }
        }
    }

    /// Values of every input that varies, over its usual range and some way beyond, such that words and conditions come and go.
    fn varied(model: &Model, rows: usize) -> Vec<(usize, Vec<f64>)> {
        let mut seed = 1_u64;
        let mut fraction = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        let column = |(number, input): (usize, &crate::models::Input)| {
            let (low, high) = input.usual;
            let value = |_| {
                let word = fraction();
                match &input.words[..] {
                    words if input.is_enumeration() || (!words.is_empty() && word < 0.3) => {
                        words[(fraction() * words.len() as f64) as usize].1
                    }
                    _ => {
                        let value = low + (high - low) * (1.2 * fraction() - 0.1);
                        if input.integer { value.round() } else { value }
                    }
                }
            };
            (number, (0..rows).map(value).collect())
        };
        model.inputs.iter().enumerate().map(column).collect()
    }

    #[test]
    fn over_columns_each_row_has_the_bits_that_it_has_alone() {
        for model in crate::models::all().iter().filter(|model| model.name != "pulley") {
            let columns = varied(model, 2 * ROWS_TO_RECORD + 77);
            let named: Vec<(&str, &[f64])> = columns.iter().map(|(input, values)| (&*model.inputs[*input].name, &values[..])).collect();
            let every = evaluate_columns(model, &named, &ManyOptions::default().threads(3)).expect("the names are the model's");
            let some: Vec<usize> = (0..model.outputs.len()).step_by(3).collect();
            let options = ManyOptions::default().outputs(&some).threads(1);
            let of_some = evaluate_columns(model, &named, &options).expect("the names are the model's");
            let mut kinds = std::collections::HashSet::new();
            for row in 0..every.statuses.len() {
                let inputs: Vec<f64> = columns.iter().map(|(_, values)| values[row]).collect();
                let alone = evaluate(model, &inputs);
                kinds.insert(format!("{:?}", alone.status));
                assert_eq!(every.statuses[row], alone.status, "{} {row}", model.name);
                assert_eq!(of_some.statuses[row], evaluate_asked(model, &inputs, Set::of(&some)).status, "{} {row}", model.name);
                for (output, &value) in alone.outputs.iter().enumerate() {
                    let bits = value.unwrap_or(f64::NAN).to_bits();
                    assert_eq!(every.outputs[output][row].to_bits(), bits, "{} {row} {}", model.name, model.outputs[output].name);
                    if let Some(place) = some.iter().position(|&it| it == output) {
                        assert_eq!(of_some.outputs[place][row].to_bits(), bits, "{} {row}", model.name);
                    }
                }
            }
            assert!(kinds.len() > 1, "{}: conditions fail in some rows", model.name);
        }
    }

    #[test]
    fn rows_beyond_what_a_sample_says_have_the_bits_that_they_have_alone() {
        for model in crate::models::all().iter().filter(|model| model.name != "pulley") {
            let mut columns = varied(model, 6000);
            // Rows that no sample has: of some numbers half as much again, and of one input nothing at all.
            let numbers = columns.iter_mut().filter(|(input, _)| model.inputs[*input].words.is_empty() && !model.inputs[*input].integer);
            for (place, (_, values)) in numbers.enumerate() {
                let row = 300 + place % 3;
                values[row] = if place == 5 { f64::NAN } else { 1.5 * values[row] };
                values[5000 + place % 3] *= 1.7;
            }
            let named: Vec<(&str, &[f64])> = columns.iter().map(|(input, values)| (&*model.inputs[*input].name, &values[..])).collect();
            let every = evaluate_columns(model, &named, &ManyOptions::default().threads(2)).expect("the names are the model's");
            for row in (0..6000).step_by(41).chain(295..310).chain(4995..5008) {
                let inputs: Vec<f64> = columns.iter().map(|(_, values)| values[row]).collect();
                let alone = evaluate(model, &inputs);
                assert_eq!(every.statuses[row], alone.status, "{} {row}", model.name);
                for (output, &value) in alone.outputs.iter().enumerate() {
                    let bits = value.unwrap_or(f64::NAN).to_bits();
                    assert_eq!(every.outputs[output][row].to_bits(), bits, "{} {row} {}", model.name, model.outputs[output].name);
                }
            }
        }
    }

    #[test]
    fn work_that_is_stopped_says_so() {
        let model = crate::models::find("metal-cvt").expect("it is a model");
        let values = vec![0.1; 5000];
        let stop = AtomicBool::new(true);
        let stopped = evaluate_columns(&model, &[("friction", &values)], &ManyOptions::default().stop(&stop));
        assert!(matches!(stopped, Err(Error::Stopped { kept: None })));
    }

    #[test]
    fn results_go_into_memory_of_the_same_size_only() {
        let model = crate::models::find("metal-cvt").expect("it is a model");
        let (wanted, rows) = ([3, 0], 2 * ROWS_TO_RECORD);
        let values: Vec<f64> = (0..rows).map(|row| 0.05 + 0.01 * row as f64).collect();
        let options = ManyOptions::default().outputs(&wanted);
        let found = evaluate_columns(&model, &[("friction", &values)], &options).expect("it is an input");
        let into = |codes: &mut [u16], columns: &mut [Vec<f64>]| {
            let results = ResultColumns { statuses: codes, outputs: columns.iter_mut().map(Vec::as_mut_slice).collect() };
            evaluate_into(&model, &[("friction", &values)], &options, results).map_err(|error| error.to_string())
        };
        let (mut codes, mut columns) = (vec![7; rows], vec![vec![1.0; rows]; 2]);
        assert_eq!(into(&mut codes, &mut columns), Ok(()));
        assert_eq!(codes, found.statuses.iter().map(|&status| u16::from(status)).collect::<Vec<_>>());
        assert!(codes.contains(&0) && codes.iter().any(|code| *code > 1), "some are ok, and some fail");
        let bits = |columns: &[Vec<f64>]| columns.concat().into_iter().map(f64::to_bits).collect::<Vec<_>>();
        assert_eq!(bits(&columns), bits(&found.outputs));
        let other = Err(format!("there is room for 5 rows, but there are {rows}"));
        assert_eq!(into(&mut codes[..5], &mut columns), other);
        columns[1].truncate(5);
        assert_eq!(into(&mut codes, &mut columns), other);
        assert_eq!(into(&mut codes, &mut columns[..1]), Err("there is room for 1 outputs, but 2 are asked for".to_owned()));
    }

    #[test]
    fn wrong_columns_are_named() {
        let model = crate::models::find("metal-cvt").expect("it is a model");
        let refused = |columns: &[(&str, &[f64])]| evaluate_many(&model, columns).expect_err("it is refused").to_string();
        assert_eq!(refused(&[("frictoin", &[0.1])]), "frictoin is no input of metal-cvt; did you mean friction?");
        assert_eq!(refused(&[("friction", &[0.1]), ("band_count", &[3.0, 4.0])]), "the column band_count has 2 rows, the first has 1");
        assert_eq!(refused(&[("friction", &[0.1]), ("friction", &[0.2])]), "there are two columns friction");
    }
}
