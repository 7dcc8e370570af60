//! Many rows of inputs, evaluated one by one: by a model, or as designs of a study in their worst scenarios.
//!
//! Rows are read, evaluated on every core and written block by block, so that no table is too long.

mod columns;
mod rows;
mod target;

pub use columns::{ColumnCells, GivenColumns};
pub use rows::{RawBlock, RowCell, RowReader};
pub use target::BatchTarget;

use crate::error::{Error, Result};
use crate::likeness::remedy;
use crate::models::Input;
use crate::study::input_text;
use crate::study::input_value_checked;
use crate::table::stream::TableStream;
use crate::table::{Data, Table, TableColumn, plain};

fn refusal(text: String) -> Error {
    Error::Request(text)
}

/// What a column of the rows is for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Use {
    /// It gives the input of this number.
    Input(usize),
    /// It stands in the result as it is.
    Carried,
}

/// Evaluates every row and writes the result: the given columns, those that are carried along, then what the target tells of each row.
/// Returns the number of rows.
///
/// # Errors
/// [`Error::Request`] that names the row and the column; those of `out`; [`Error::Stopped`] never.
pub fn evaluate_rows(
    rows: &mut RowReader,
    target: &mut BatchTarget,
    carry: &[String],
    threads: usize,
    out: &mut TableStream<'_>,
) -> Result<u64> {
    let uses = uses(rows, target, carry)?;
    let given: Vec<usize> = uses.iter().filter_map(|it| if let Use::Input(input) = it { Some(*input) } else { None }).collect();
    target.given(&given)?;
    let (mut count, mut is_first) = (0, true);
    loop {
        let block = rows.next_block()?;
        if block.places.is_empty() && !is_first {
            return Ok(count);
        }
        count += block.places.len() as u64;
        let table = of_block(rows, &block, &uses, &given, target, threads)?;
        if is_first && let Some(name) = table.doubled_name() {
            let told = format!("{}: the result would have two columns \"{name}\"; call the carried one otherwise", rows.name());
            return Err(refusal(told));
        }
        out.write(&table)?;
        is_first = false;
    }
}

/// The result of some rows.
fn of_block(rows: &RowReader, block: &RawBlock, uses: &[Use], given: &[usize], target: &BatchTarget, threads: usize) -> Result<Table> {
    let mut values = Vec::with_capacity(given.len());
    let mut carried = Vec::new();
    for (at, (it, cells)) in uses.iter().zip(&block.columns).enumerate() {
        match it {
            Use::Input(input) => {
                let input = &target.model().inputs[*input];
                let value = |(cell, &place): (&RowCell, &u64)| {
                    value_of(cell, input).map_err(|why| refusal(format!("{}: {why}", rows.place(place, at))))
                };
                values.push(cells.iter().zip(&block.places).map(value).collect::<Result<Vec<f64>>>()?);
            }
            Use::Carried => carried.push(carried_column(&rows.header()[at], rows.numeric[at], cells)),
        }
    }
    // Whether a column has words must be the same in every block.
    let has_words = |input: usize| {
        let column = uses.iter().position(|it| *it == Use::Input(input));
        let table = &target.model().inputs[input];
        table.is_enumeration() || (!table.words.is_empty() && column.is_none_or(|at| !rows.numeric[at]))
    };
    let values: Vec<&[f64]> = values.iter().map(Vec::as_slice).collect();
    let (mut columns, results) = target.evaluate(given, &values, &has_words, threads)?;
    columns.extend(carried);
    columns.extend(results);
    Ok(Table { columns })
}

fn value_of(cell: &RowCell, input: &Input) -> std::result::Result<f64, String> {
    match cell {
        RowCell::Number(value) if input.is_enumeration() => input_text(&plain(*value), input),
        // Adding zero turns -0 into 0, as in a study.
        RowCell::Number(value) => input_value_checked(*value + 0.0, input),
        RowCell::Text(text) if text.is_empty() => Err("the cell is empty; give a value".to_owned()),
        RowCell::Text(text) => match text.parse::<f64>() {
            Ok(value) if !input.is_enumeration() => input_value_checked(value + 0.0, input),
            _ => input_text(text, input),
        },
    }
}

fn carried_column(name: &str, numeric: bool, cells: &[RowCell]) -> TableColumn {
    let text = |cell: &RowCell| match cell {
        RowCell::Number(value) => plain(*value),
        RowCell::Text(text) => text.clone(),
    };
    let number = |cell: &RowCell| if let RowCell::Number(value) = cell { Some(*value).filter(|it| it.is_finite()) } else { None };
    let data = if numeric { Data::Number(cells.iter().map(number).collect()) } else { Data::Text(cells.iter().map(text).collect()) };
    TableColumn::new(name, "carried", "As it was given.", data)
}

/// What each column is for.
fn uses(rows: &RowReader, target: &BatchTarget, carry: &[String]) -> Result<Vec<Use>> {
    let header = rows.header();
    let mut problems: Vec<String> = Vec::new();
    for name in carry.iter().filter(|name| !header.contains(name)) {
        let names: Vec<&str> = header.iter().map(String::as_str).collect();
        let remedy = remedy(name, &names, || format!("its columns are {}", names.join(", ")));
        problems.push(format!("{}: there is no column \"{name}\" to carry; {remedy}", rows.name()));
    }
    let mut uses = Vec::new();
    for (at, name) in header.iter().enumerate() {
        if name.is_empty() {
            problems.push(format!("{}: column {} has no name; name the input whose values it holds", rows.name(), at + 1));
        } else if header[..at].contains(name) {
            problems.push(format!("{}: \"{name}\" has two columns; drop one", rows.name()));
        } else if carry.contains(name) {
            uses.push(Use::Carried);
        } else {
            match target.input(name) {
                Ok(input) => uses.push(Use::Input(input)),
                Err(why) => problems.push(format!("{}: column \"{name}\": {why}", rows.name())),
            }
        }
    }
    if problems.is_empty() { Ok(uses) } else { Err(refusal(problems.join("\n       "))) }
}
