//! Rows that are in memory already, as columns.

use super::{BatchTarget, RowCell, refusal, value_of};
use crate::error::Result;
use crate::models::{EvaluatedColumns, Input, ManyOptions, evaluate_columns};
use crate::screen::Control;
use crate::table::Table;

/// Values that rows give an input.
#[derive(Clone, Debug, PartialEq)]
pub enum ColumnCells {
    /// One number per row, in the unit of the column's name.
    Numbers(Vec<f64>),
    /// One text per row: a word, or a number that may have a unit behind it.
    Texts(Vec<String>),
    /// The same in every row.
    Same(RowCell),
}

/// Columns that give inputs their values, checked.
#[derive(Clone, Debug)]
pub struct GivenColumns {
    rows: usize,
    /// The inputs, by number, with their values.
    inputs: Vec<usize>,
    values: Vec<Vec<f64>>,
    /// Which inputs are given as words.
    words: Vec<bool>,
}

impl GivenColumns {
    /// Checks columns of the inputs that a target takes; `target` is told which they are.
    ///
    /// # Errors
    /// [`Error::Request`](crate::Error::Request) that names the column, and the row from 0.
    pub fn new(target: &mut BatchTarget, columns: &[(String, ColumnCells)]) -> Result<Self> {
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
            given.values.push(values_of(name, cells, input, rows)?);
            given.inputs.push(number);
            let is_text = matches!(cells, ColumnCells::Texts(_) | ColumnCells::Same(RowCell::Text(_)));
            given.words.push(input.is_enumeration() || (is_text && !input.words.is_empty()));
        }
        target.given(&given.inputs)?;
        target.refuse_replaced(&given.inputs, &given.values)?;
        Ok(given)
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }
}

fn values_of(name: &str, cells: &ColumnCells, input: &Input, rows: usize) -> Result<Vec<f64>> {
    let wrong = |row: usize, why: String| refusal(format!("row {row}, column \"{name}\": {why}"));
    match cells {
        ColumnCells::Numbers(values) => match values.iter().position(|&value| input.is_enumeration() || !input.accepts(value)) {
            None => Ok(values.clone()),
            Some(first) => {
                let checked = |(row, &value)| value_of(&RowCell::Number(value), input).map_err(|why| wrong(row, why));
                let rest: Vec<f64> = values.iter().enumerate().skip(first).map(checked).collect::<Result<_>>()?;
                Ok([&values[..first], &rest].concat())
            }
        },
        ColumnCells::Texts(texts) => {
            let value = |(row, text): (usize, &String)| value_of(&RowCell::Text(text.clone()), input).map_err(|why| wrong(row, why));
            texts.iter().enumerate().map(value).collect()
        }
        ColumnCells::Same(cell) => {
            let value = value_of(cell, input).map_err(|why| refusal(format!("column \"{name}\": {why}")))?;
            Ok(vec![value; rows])
        }
    }
}

impl BatchTarget {
    /// Evaluates a model for every row.
    ///
    /// # Errors
    /// As [`evaluate_columns`].
    ///
    /// # Panics
    /// If the target is a study.
    pub fn evaluate_each(&self, given: &GivenColumns, options: &ManyOptions<'_>) -> Result<EvaluatedColumns> {
        let model = self.model();
        let names = given.inputs.iter().map(|&input| model.inputs[input].name.as_str());
        let columns: Vec<(&str, &[f64])> = names.zip(given.values.iter().map(Vec::as_slice)).collect();
        let base = self.base().expect("a model, no study").to_vec();
        let options = ManyOptions { inputs: Some(&base), ..options.clone() };
        evaluate_columns(model, &columns, &options)
    }

    /// The worst of every row over the scenarios of a study: the columns of its results, margins of its constraints, and whether and why
    /// not a design is feasible.
    ///
    /// # Errors
    /// [`Error::Stopped`](crate::Error::Stopped) after `control.stop`.
    ///
    /// # Panics
    /// If the target is a model.
    pub fn worst_of_each(&self, given: &GivenColumns, threads: usize, control: &Control) -> Result<Table> {
        let has_words = |input: usize| given.inputs.iter().zip(&given.words).any(|(&it, &words)| it == input && words);
        let (mut columns, results) = self.by_study(&given.inputs, &given.values, &has_words, threads, control)?;
        columns.extend(results);
        Ok(Table { columns })
    }
}
