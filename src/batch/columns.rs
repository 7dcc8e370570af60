//! Rows that are in memory already, as columns.

use super::{BatchTarget, RowCell, refusal, value_of};
use crate::error::Result;
use crate::models::{ColumnCheck, ColumnEnds, Input, ManyOptions, ResultColumns, Status, ends, evaluate_into};
use crate::parallel::on_threads;
use crate::screen::Control;
use crate::table::Table;
use std::borrow::Cow;
use std::sync::atomic::{AtomicBool, Ordering};

/// Numbers from which on several threads check them, or they are checked while they are evaluated.
const MUCH: usize = 100_000;

/// Values that rows give an input.
#[derive(Clone, Debug, PartialEq)]
pub enum ColumnCells<'a> {
    /// One number per row, in the unit of the column's name.
    Numbers(Cow<'a, [f64]>),
    /// One text per row: a word, or a number that may have a unit behind it.
    Texts(Vec<String>),
    /// The same in every row.
    Same(RowCell),
}

/// Columns that give inputs their values, checked.
#[derive(Clone, Debug)]
pub struct GivenColumns<'a> {
    rows: usize,
    /// The inputs, by number, with their values: one per row, or one for all.
    inputs: Vec<usize>,
    values: Vec<GivenValues<'a>>,
    /// Which inputs are given as words.
    words: Vec<bool>,
    /// As they were given.
    cells: &'a [(String, ColumnCells<'a>)],
}

/// Values of an input, checked.
#[derive(Clone, Debug)]
enum GivenValues<'a> {
    Each(Cow<'a, [f64]>),
    /// Numbers that are checked where they are evaluated, which saves reading them twice.
    Unchecked(&'a [f64]),
    Same(f64),
}

/// When numbers are checked.
#[derive(Clone, Copy, PartialEq)]
enum Checking {
    AtOnce,
    WhenEvaluated,
}

impl GivenValues<'_> {
    /// The values, once if they are the same in all rows.
    fn different(&self) -> &[f64] {
        match self {
            Self::Each(values) => values,
            Self::Unchecked(values) => values,
            Self::Same(value) => std::slice::from_ref(value),
        }
    }
}

impl<'a> GivenColumns<'a> {
    /// Checks columns of the inputs that a target takes, on several threads; `target` is told which they are. Many numbers for a model are
    /// checked by [`BatchTarget::evaluate_each`].
    ///
    /// # Errors
    /// [`Error::Request`](crate::Error::Request) that names the column, and the row from 0.
    pub fn new(target: &mut BatchTarget, columns: &'a [(String, ColumnCells<'a>)], threads: usize) -> Result<Self> {
        let length = |cells: &ColumnCells| match cells {
            ColumnCells::Numbers(it) => Some(it.len()),
            ColumnCells::Texts(it) => Some(it.len()),
            ColumnCells::Same(_) => None,
        };
        let first = columns.iter().find_map(|(name, cells)| Some((name, length(cells)?)));
        let rows = first.map_or(1, |(_, rows)| rows);
        let mut given = Self { rows, inputs: Vec::new(), values: Vec::new(), words: Vec::new(), cells: columns };
        for (name, cells) in columns {
            if let Some((other, there)) =
                first.zip(length(cells)).and_then(|((other, rows), there)| (there != rows).then_some((other, there)))
            {
                return Err(refusal(format!("the column {name} has {there} rows, the column {other} has {rows}")));
            }
            let number = target.input(name).map_err(|why| refusal(format!("column \"{name}\": {why}")))?;
            if given.inputs.contains(&number) {
                return Err(refusal(format!("there are two columns {name}")));
            }
            let input = &target.model().inputs[number];
            given.inputs.push(number);
            let is_text = matches!(cells, ColumnCells::Texts(_) | ColumnCells::Same(RowCell::Text(_)));
            given.words.push(input.is_enumeration() || (is_text && !input.words.is_empty()));
        }
        let checking = if target.base().is_some() && rows * columns.len() >= MUCH { Checking::WhenEvaluated } else { Checking::AtOnce };
        given.values = given.checked(target, checking, threads)?;
        target.given(&given.inputs)?;
        target.refuse_replaced(&given.inputs, &given.values.iter().map(GivenValues::different).collect::<Vec<_>>())?;
        Ok(given)
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The values of all columns.
    fn checked(&self, target: &BatchTarget, checking: Checking, threads: usize) -> Result<Vec<GivenValues<'a>>> {
        let model = target.model();
        let columns: Vec<(&Input, &'a (String, ColumnCells<'a>))> =
            self.inputs.iter().map(|&input| &model.inputs[input]).zip(self.cells).collect();
        let share = if self.rows * columns.len() < MUCH { columns.len() } else { columns.len().div_ceil(threads.max(1)) };
        let values = on_threads(columns.chunks(share.max(1)), |part| {
            part.iter().map(|(input, (name, cells))| values_of(name, cells, input, checking)).collect::<Result<Vec<_>>>()
        });
        Ok(values.into_iter().collect::<Result<Vec<_>>>()?.into_iter().flatten().collect())
    }

    /// The columns; `room` holds those that have one value for all rows.
    fn slices<'s>(&'s self, room: &'s mut Vec<Vec<f64>>) -> Vec<&'s [f64]> {
        let same = |it: &GivenValues<'_>| if let GivenValues::Same(value) = it { Some(vec![*value; self.rows]) } else { None };
        *room = self.values.iter().filter_map(same).collect();
        let mut same = room.iter();
        let slice = |it: &'s GivenValues<'_>| match it {
            GivenValues::Each(values) => &**values,
            GivenValues::Unchecked(values) => values,
            GivenValues::Same(_) => same.next().expect("there is one for each"),
        };
        self.values.iter().map(slice).collect()
    }
}

/// Does an input surely take all numbers of a column with these ends?
fn surely_takes(input: &Input, ends: ColumnEnds) -> bool {
    let is_valid = ends.numbers && [ends.low, ends.high].iter().all(|&it| input.valid.contains(it));
    is_valid && !input.is_enumeration() && (ends.whole || !input.integer)
}

fn values_of<'a>(name: &str, cells: &'a ColumnCells<'_>, input: &Input, checking: Checking) -> Result<GivenValues<'a>> {
    let wrong = |row: usize, why: String| refusal(format!("row {row}, column \"{name}\": {why}"));
    match cells {
        ColumnCells::Numbers(values) if checking == Checking::WhenEvaluated => Ok(GivenValues::Unchecked(values)),
        ColumnCells::Numbers(values) => {
            // What all numbers satisfy is asked in a way that is quick.
            let first = match surely_takes(input, ends(values)) {
                true => None,
                false => values.iter().position(|&value| input.is_enumeration() || !input.accepts(value)),
            };
            let Some(first) = first else { return Ok(GivenValues::Each(Cow::Borrowed(values))) };
            let checked = |(row, &value)| value_of(&RowCell::Number(value), input).map_err(|why| wrong(row, why));
            let rest: Vec<f64> = values.iter().enumerate().skip(first).map(checked).collect::<Result<_>>()?;
            Ok(GivenValues::Each([&values[..first], &rest].concat().into()))
        }
        ColumnCells::Texts(texts) => {
            let value = |(row, text): (usize, &String)| value_of(&RowCell::Text(text.clone()), input).map_err(|why| wrong(row, why));
            Ok(GivenValues::Each(texts.iter().enumerate().map(value).collect::<Result<Vec<f64>>>()?.into()))
        }
        ColumnCells::Same(cell) => value_of(cell, input).map(GivenValues::Same).map_err(|why| refusal(format!("column \"{name}\": {why}"))),
    }
}

impl BatchTarget {
    /// Evaluates a model for every row.
    ///
    /// # Errors
    /// As [`evaluate_into`] and [`GivenColumns::new`]; after any of them the results are incomplete.
    ///
    /// # Panics
    /// If the target is a study.
    pub fn evaluate_each<S: From<Status> + Send>(
        &self,
        given: &GivenColumns<'_>,
        options: &ManyOptions<'_>,
        results: ResultColumns<'_, S>,
    ) -> Result<()> {
        let ResultColumns { statuses, mut outputs } = results;
        let again = ResultColumns { statuses: &mut *statuses, outputs: outputs.iter_mut().map(|it| &mut **it).collect() };
        let refused = AtomicBool::new(false);
        let found = self.evaluate_checking(given, options, again, &refused);
        if !refused.into_inner() {
            return found;
        }
        // Which number is wrong is looked for now; or all are as they should be, which only looking at each of them shows.
        let values = given.checked(self, Checking::AtOnce, options.threads)?;
        let given = GivenColumns { values, ..given.clone() };
        self.evaluate_checking(&given, options, ResultColumns { statuses, outputs }, &AtomicBool::new(false))
    }

    /// The same; `refused` is set where a number that nobody had checked may be wrong.
    fn evaluate_checking<S: From<Status> + Send>(
        &self,
        given: &GivenColumns<'_>,
        options: &ManyOptions<'_>,
        results: ResultColumns<'_, S>,
        refused: &AtomicBool,
    ) -> Result<()> {
        let model = self.model();
        let mut base = self.base().expect("a model, no study").to_vec();
        let mut columns: Vec<(&str, &[f64])> = Vec::new();
        let mut unchecked: Vec<Option<&Input>> = Vec::new();
        for (&input, values) in given.inputs.iter().zip(&given.values) {
            let of_input = &model.inputs[input];
            match values {
                // What all rows share is computed once.
                GivenValues::Same(value) => base[input] = *value,
                each => {
                    columns.push((&of_input.name, each.different()));
                    unchecked.push(matches!(each, GivenValues::Unchecked(_)).then_some(of_input));
                }
            }
        }
        // One row of values that stand alone has a column all the same.
        let alone = [base[given.inputs[0]]];
        if columns.is_empty() {
            columns.push((&model.inputs[given.inputs[0]].name, &alone));
            unchecked.push(None);
        }
        let takes = |column: usize, ends: ColumnEnds| {
            let takes = unchecked[column].is_none_or(|input| surely_takes(input, ends));
            refused.fetch_or(!takes, Ordering::Relaxed);
            takes
        };
        let check = unchecked.iter().any(Option::is_some).then_some(ColumnCheck(&takes));
        let options = ManyOptions { inputs: Some(&base), check, ..options.clone() };
        evaluate_into(model, &columns, &options, results)
    }

    /// The worst of every row over the scenarios of a study: the columns of its results, margins of its constraints, and whether and why
    /// not a design is feasible.
    ///
    /// # Errors
    /// [`Error::Stopped`](crate::Error::Stopped) after `control.stop`.
    ///
    /// # Panics
    /// If the target is a model.
    pub fn worst_of_each(&self, given: &GivenColumns<'_>, threads: usize, control: &Control) -> Result<Table> {
        let has_words = |input: usize| given.inputs.iter().zip(&given.words).any(|(&it, &words)| it == input && words);
        let (mut columns, results) = self.by_study(&given.inputs, &given.slices(&mut Vec::new()), &has_words, threads, control)?;
        columns.extend(results);
        Ok(Table { columns })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::{self, EvaluatedColumns, evaluate_columns};

    /// Frictions of so many rows, with one in place of that of a row.
    fn frictions(rows: usize, row: usize, other: f64) -> Vec<(String, ColumnCells<'static>)> {
        let mut values: Vec<f64> = (0..rows).map(|row| 0.06 + 0.06 * row as f64 / rows as f64).collect();
        values[row] = other;
        vec![("friction".to_owned(), ColumnCells::Numbers(values.into()))]
    }

    fn evaluated(columns: &[(String, ColumnCells<'_>)]) -> Result<(Vec<u16>, Vec<f64>)> {
        let model = models::find("metal-cvt").expect("it is a model");
        let wanted = [model.output("axial_force_N").expect("it is an output")];
        let mut target = BatchTarget::of_model(model.clone(), model.defaults(), Vec::new()).without_options();
        let given = GivenColumns::new(&mut target, columns, 2)?;
        let (mut statuses, mut forces) = (vec![9; given.rows()], vec![0.0; given.rows()]);
        let options = ManyOptions::default().threads(2).outputs(&wanted);
        target.evaluate_each(&given, &options, ResultColumns { statuses: &mut statuses, outputs: vec![&mut forces] })?;
        Ok((statuses, forces))
    }

    #[test]
    fn a_wrong_number_is_named_whether_it_is_checked_before_or_while_rows_are_evaluated() {
        for rows in [1000, MUCH, 3 * MUCH + 17] {
            for row in [0, 700, rows - 1] {
                for wrong in [-0.1, f64::NAN] {
                    let refused = evaluated(&frictions(rows, row, wrong)).expect_err("it is refused").to_string();
                    assert!(refused.starts_with(&format!("row {row}, column \"friction\": ")), "{rows} {row}: {refused}");
                }
            }
        }
    }

    #[test]
    fn a_number_that_no_sample_of_the_column_has_changes_only_its_own_row() {
        let rows = MUCH + 50;
        let model = models::find("metal-cvt").expect("it is a model");
        let wanted = [model.output("axial_force_N").expect("it is an output")];
        // Far beyond all others: with it the wedge would need no axial force.
        let columns = frictions(rows, 5000, 6.5);
        let (statuses, forces) = evaluated(&columns).expect("it may be");
        assert_eq!(statuses.iter().filter(|status| **status != 0).count(), 1);
        assert!(statuses[5000] > 1 && forces[5000].is_nan());
        let ColumnCells::Numbers(values) = &columns[0].1 else { unreachable!("they are numbers") };
        for first in [0, 4800, 5001, rows - 400] {
            // Few rows are evaluated one by one.
            let few = [("friction", &values[first..first + 199])];
            let EvaluatedColumns { outputs, .. } =
                evaluate_columns(&model, &few, &ManyOptions::default().outputs(&wanted)).expect("they may be");
            let bits = |numbers: &[f64]| numbers.iter().map(|it| it.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&outputs[0]), bits(&forces[first..first + 199]), "{first}");
        }
    }
}
