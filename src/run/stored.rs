//! A result directory, read into memory.

use crate::error::{Error, Result};
use crate::files::{RESULT_BYTES, open, read_text};
use crate::names::MARK;
use crate::study::Study;
use crate::table::{Data, Table, TableColumn};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A result directory, read into memory.
///
/// ```no_run
/// let stored = beltspace::Stored::read("results/metal-cvt".as_ref())?;
/// println!("{} of {} designs are feasible", stored.feasible, stored.designs);
/// for row in 0..stored.front.rows() {
///     println!("{:?}", stored.front.number("axial_force_N", row));
/// }
/// # Ok::<(), beltspace::Error>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Stored {
    /// The study that the result is of.
    pub study: Study,
    /// Designs of the study.
    pub designs: u64,
    /// Designs that keep all constraints in all scenarios.
    pub feasible: u64,
    /// The Pareto front; no rows if the study has no objectives. Columns that are not a quantity of the model have no unit, role or
    /// description.
    pub front: Table,
    /// `summary.json` unchanged: one JSON object.
    pub summary: String,
}

const REMEDY: &str = "beltspace writes no file that large";

/// The error for a file that differs from what `beltspace sweep` writes.
fn changed(path: PathBuf, problem: String) -> Error {
    Error::Result { path, problem }
}

impl Stored {
    /// Reads the directory that a sweep has written.
    ///
    /// # Errors
    /// [`Error::Io`] if a file is missing or cannot be read, [`Error::Result`] if one has contents that beltspace does not write or that
    /// contradict the other files.
    pub fn read(folder: &Path) -> Result<Self> {
        let json = |name: &str| -> Result<Value> {
            let path = folder.join(name);
            serde_json::from_str(&read_text(&path, RESULT_BYTES, REMEDY)?).map_err(|error| changed(path, error.to_string()))
        };
        let (described, summary) = (json("study.json")?, json(MARK)?);
        let text = read_text(&folder.join(MARK), RESULT_BYTES, REMEDY)?;
        let study = Study::from_description(&described).map_err(|problem| changed(folder.join("study.json"), problem))?;
        let of_summary = |problem: &str| changed(folder.join(MARK), problem.to_owned());
        if summary["study_hash"] != study.hash().as_str() {
            return Err(of_summary("it belongs to another study than study.json"));
        }
        let count = |name: &str| summary[name].as_u64().ok_or_else(|| of_summary(&format!("there is no number \"{name}\"")));
        let front = if study.objectives.is_empty() { Table { columns: Vec::new() } } else { table(&folder.join("front.csv"), &study)? };
        let (designs, feasible) = (count("designs")?, count("feasible")?);
        if front.rows() as u64 != count("front")? {
            return Err(changed(folder.join("front.csv"), "its number of rows is not that of summary.json".to_owned()));
        }
        Ok(Self { designs, feasible, front, study, summary: text })
    }
}

/// A table of designs; the name of a column says what kind it is.
fn table(path: &Path, study: &Study) -> Result<Table> {
    let wrong = |error: csv::Error| changed(path.to_owned(), error.to_string());
    let mut reader = csv::Reader::from_reader(open(path).map_err(Error::io(path))?);
    let mut columns: Vec<TableColumn> = reader.headers().map_err(wrong)?.iter().map(|name| column(name, study)).collect();
    for (row, record) in reader.records().enumerate() {
        let record = record.map_err(wrong)?;
        for (column, cell) in columns.iter_mut().zip(&record) {
            push(&mut column.data, cell)
                .ok_or_else(|| changed(path.to_owned(), format!("row {}: \"{}\" is no value of {}", row + 1, cell, column.name)))?;
        }
    }
    columns.iter_mut().filter(|it| it.role == "design").for_each(as_numbers);
    Ok(Table { columns })
}

/// An input that may be a word, and is a number in every design.
fn as_numbers(column: &mut TableColumn) {
    if let Data::Text(words) = &column.data
        && let Ok(numbers) = words.iter().map(|word| word.parse().map(Some)).collect()
    {
        column.data = Data::Number(numbers);
    }
}

/// An empty column with this name.
fn column(name: &str, study: &Study) -> TableColumn {
    let model = &study.model;
    if name == "design_index" || name.ends_with("_scenario") {
        return TableColumn::index(name, "", []);
    }
    if study.labels.iter().any(|it| it.name == name) {
        return TableColumn::new(name, "label", "", Data::Text(Vec::new()));
    }
    if let Some(input) = model.input(name).map(|input| &model.inputs[input]) {
        let data = if input.words.is_empty() { Data::Number(Vec::new()) } else { Data::Text(Vec::new()) };
        return TableColumn { unit: input.unit.symbol.to_owned(), ..TableColumn::new(name, "design", &input.doc, data) };
    }
    let quantity = model.output(name.strip_suffix("_constrained").unwrap_or(name)).map(|output| &model.outputs[output]);
    let (unit, doc) = quantity.map_or(("", ""), |it| (it.unit.symbol, it.doc.as_str()));
    TableColumn { unit: unit.to_owned(), ..TableColumn::new(name, "", doc, Data::Number(Vec::new())) }
}

/// Adds a cell; `None` if it is not of the column's kind.
fn push(data: &mut Data, cell: &str) -> Option<()> {
    match data {
        Data::Whole(values) => values.push(if cell.is_empty() { None } else { Some(cell.parse().ok()?) }),
        Data::Number(values) => values.push(if cell.is_empty() { None } else { Some(cell.parse().ok()?) }),
        Data::Text(values) => values.push(cell.to_owned()),
    }
    Some(())
}
