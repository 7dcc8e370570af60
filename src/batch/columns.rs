//! Rows that are in memory already, as columns.

use super::{BatchTarget, RowCell, refusal, value_of};
use crate::error::Result;
use crate::models::{ColumnEnds, Input, ManyOptions, ResultColumns, Status, ends, evaluate_into};
use crate::parallel::on_threads;
use crate::screen::Control;
use crate::table::Table;
use std::borrow::Cow;

/// Numbers from which on several threads check them.
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
}

/// Values of an input, checked.
#[derive(Clone, Debug)]
enum GivenValues<'a> {
    /// With its ends, if they are known.
    Each(Cow<'a, [f64]>, Option<ColumnEnds>),
    Same(f64),
}

impl GivenValues<'_> {
    /// The values, once if they are the same in all rows.
    fn different(&self) -> &[f64] {
        match self {
            Self::Each(values, _) => values,
            Self::Same(value) => std::slice::from_ref(value),
        }
    }
}

impl<'a> GivenColumns<'a> {
    /// Checks columns of the inputs that a target takes, on several threads; `target` is told which they are.
    ///
    /// # Errors
    /// [`Error::Request`](crate::Error::Request) that names the column, and the row from 0.
    pub fn new(target: &mut BatchTarget, columns: &'a [(String, ColumnCells<'_>)], threads: usize) -> Result<Self> {
        let length = |cells: &ColumnCells| match cells {
            ColumnCells::Numbers(it) => Some(it.len()),
            ColumnCells::Texts(it) => Some(it.len()),
            ColumnCells::Same(_) => None,
        };
        let first = columns.iter().find_map(|(name, cells)| Some((name, length(cells)?)));
        let rows = first.map_or(1, |(_, rows)| rows);
        let mut given = Self { rows, inputs: Vec::new(), values: Vec::new(), words: Vec::new() };
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
        let model = target.model();
        let checked: Vec<(&Input, &(String, ColumnCells<'_>))> =
            given.inputs.iter().map(|&input| &model.inputs[input]).zip(columns).collect();
        let share = if rows * columns.len() < MUCH { columns.len() } else { columns.len().div_ceil(threads.max(1)) };
        let values = on_threads(checked.chunks(share.max(1)), |part| {
            part.iter().map(|(input, (name, cells))| values_of(name, cells, input)).collect::<Result<Vec<_>>>()
        });
        given.values = values.into_iter().collect::<Result<Vec<_>>>()?.into_iter().flatten().collect();
        target.given(&given.inputs)?;
        target.refuse_replaced(&given.inputs, &given.values.iter().map(GivenValues::different).collect::<Vec<_>>())?;
        Ok(given)
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The columns; `room` holds those that have one value for all rows.
    fn slices<'s>(&'s self, room: &'s mut Vec<Vec<f64>>) -> Vec<&'s [f64]> {
        let same = |it: &GivenValues<'_>| if let GivenValues::Same(value) = it { Some(vec![*value; self.rows]) } else { None };
        *room = self.values.iter().filter_map(same).collect();
        let mut same = room.iter();
        let slice = |it: &'s GivenValues<'_>| match it {
            GivenValues::Each(values, _) => &**values,
            GivenValues::Same(_) => same.next().expect("there is one for each"),
        };
        self.values.iter().map(slice).collect()
    }
}

fn values_of<'a>(name: &str, cells: &'a ColumnCells<'_>, input: &Input) -> Result<GivenValues<'a>> {
    let wrong = |row: usize, why: String| refusal(format!("row {row}, column \"{name}\": {why}"));
    match cells {
        ColumnCells::Numbers(values) => {
            // What all numbers satisfy is asked in a way that is quick.
            let ends = ends(values);
            let surely = ends.numbers && [ends.low, ends.high].iter().all(|&it| input.valid.contains(it));
            let first = match surely && !input.is_enumeration() && (ends.whole || !input.integer) {
                true => None,
                false => values.iter().position(|&value| input.is_enumeration() || !input.accepts(value)),
            };
            let Some(first) = first else { return Ok(GivenValues::Each(Cow::Borrowed(values), Some(ends))) };
            let checked = |(row, &value)| value_of(&RowCell::Number(value), input).map_err(|why| wrong(row, why));
            let rest: Vec<f64> = values.iter().enumerate().skip(first).map(checked).collect::<Result<_>>()?;
            Ok(GivenValues::Each([&values[..first], &rest].concat().into(), None))
        }
        ColumnCells::Texts(texts) => {
            let value = |(row, text): (usize, &String)| value_of(&RowCell::Text(text.clone()), input).map_err(|why| wrong(row, why));
            Ok(GivenValues::Each(texts.iter().enumerate().map(value).collect::<Result<Vec<f64>>>()?.into(), None))
        }
        ColumnCells::Same(cell) => value_of(cell, input).map(GivenValues::Same).map_err(|why| refusal(format!("column \"{name}\": {why}"))),
    }
}

impl BatchTarget {
    /// Evaluates a model for every row.
    ///
    /// # Errors
    /// As [`evaluate_into`].
    ///
    /// # Panics
    /// If the target is a study.
    pub fn evaluate_each<S: From<Status> + Send>(
        &self,
        given: &GivenColumns<'_>,
        options: &ManyOptions<'_>,
        results: ResultColumns<'_, S>,
    ) -> Result<()> {
        let model = self.model();
        let mut base = self.base().expect("a model, no study").to_vec();
        let mut columns: Vec<(&str, &[f64])> = Vec::new();
        let mut ends: Vec<Option<ColumnEnds>> = Vec::new();
        for (&input, values) in given.inputs.iter().zip(&given.values) {
            match values {
                GivenValues::Each(values, known) => {
                    columns.push((&model.inputs[input].name, values));
                    ends.push(*known);
                }
                // What all rows share is computed once.
                GivenValues::Same(value) => base[input] = *value,
            }
        }
        // One row of values that stand alone has a column all the same.
        let alone = [base[given.inputs[0]]];
        if columns.is_empty() {
            columns.push((&model.inputs[given.inputs[0]].name, &alone));
            ends.push(None);
        }
        let options = ManyOptions { inputs: Some(&base), ends: Some(&ends), ..options.clone() };
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
