//! Reads the files of a result, which may have been changed since they were written.

pub mod designs;
pub mod packed;
mod picture;
pub mod sample;

use crate::error::{Error, Result, brief};
use crate::files::{RESULT_BYTES, ROW_BYTES, ShortLines, open, read_text};
use crate::plan::Plan;
use designs::check_header;
use serde_json::Value;
use std::fs::File;
use std::path::Path;

/// The files of a result, and what is known about it.
#[derive(Clone, Copy, Debug)]
pub struct Folder<'a> {
    /// The result directory.
    pub path: &'a Path,
    /// The study that it is of.
    pub plan: &'a Plan,
    /// Feasible designs, by its summary.
    pub feasible: u64,
}

/// Reads a picture, which must be one that this program could have drawn.
pub fn picture_of(file: &Path) -> Result<String> {
    let svg = read_text(file, RESULT_BYTES, TOO_LARGE).map_err(|error| missing(file, error))?;
    picture::check(&svg).map_err(|problem| changed(file, &format!("not a picture of this program: {problem}")))?;
    Ok(svg)
}

/// Reads a table of a result row by row. Only labels are quoted, where they have a comma or a quote, and none has a line end: every row is
/// one line.
pub fn table_reader(file: &Path) -> Result<csv::Reader<ShortLines<File>>> {
    let opened = open(file).map_err(|source| unreadable_file(file, source))?;
    Ok(csv::Reader::from_reader(ShortLines::new(opened, ROW_BYTES)))
}

/// The error for a file that the CSV reader refuses.
pub fn unreadable(file: &Path, error: csv::Error) -> Error {
    match error.into_kind() {
        csv::ErrorKind::Io(source) => unreadable_file(file, source),
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
            let line = pos.map_or(String::new(), |pos| format!("line {}: ", pos.line()));
            changed(file, &format!("{line}{len} cells where there should be {expected_len}"))
        }
        csv::ErrorKind::Utf8 { .. } => changed(file, "it is not text"),
        _ => changed(file, "it cannot be read as a table"),
    }
}

/// A file of the result as text.
pub fn text_of(folder: &Path, name: &str) -> Result<String> {
    let path = folder.join(name);
    let most = if name == STUDY { STUDY_JSON_BYTES } else { RESULT_BYTES };
    read_text(&path, most, TOO_LARGE).map_err(|error| missing(&path, error))
}

/// The description of the study, and its largest size: it has every row of the tables that the study names.
pub const STUDY: &str = "study.json";
const STUDY_JSON_BYTES: u64 = 4 * RESULT_BYTES;
/// The remedy for a file that is too large to be that of a result.
const TOO_LARGE: &str = "beltspace writes no file that large: sweep the study again";

/// The error for a file that cannot be read.
pub fn missing(file: &Path, error: Error) -> Error {
    match error {
        Error::Io { source, .. } => unreadable_file(file, source),
        other => other,
    }
}

/// A missing file is treated like one that was changed.
fn unreadable_file(file: &Path, source: std::io::Error) -> Error {
    if source.kind() == std::io::ErrorKind::NotFound {
        return Error::Request(format!("{} is missing from the result: sweep the study again", file.display()));
    }
    Error::io(file)(source)
}

/// A file of the result as JSON.
pub fn json_of(folder: &Path, name: &str) -> Result<Value> {
    serde_json::from_str(&text_of(folder, name)?).map_err(|error| changed(&folder.join(name), &format!("it is not JSON: {error}")))
}

/// The error for a file that this version would not have written.
pub fn changed(file: &Path, problem: &str) -> Error {
    Error::Request(format!(
        "{}: {}; the file was changed or comes from another version of the program: sweep the study again",
        file.display(),
        brief(problem)
    ))
}

/// The rows of a table with these columns, `most` of them at most.
pub fn rows_of(file: &Path, columns: &[String], most: usize) -> Result<Vec<csv::StringRecord>> {
    let mut reader = table_reader(file)?;
    check_header(file, reader.headers().map_err(|error| unreadable(file, error))?, columns)?;
    let mut rows = Vec::new();
    for row in reader.records() {
        rows.push(row.map_err(|error| unreadable(file, error))?);
        if rows.len() > most {
            return Err(changed(file, &format!("it has more than {most} rows")));
        }
    }
    Ok(rows)
}

/// A number, NaN where there is none; `None` if it is something else.
pub fn number(cell: &str) -> Option<f64> {
    if cell.is_empty() { Some(f64::NAN) } else { cell.parse().ok().filter(|it: &f64| it.is_finite()) }
}

/// Names of columns.
pub fn owned<const N: usize>(names: [&str; N]) -> Vec<String> {
    names.map(str::to_owned).to_vec()
}
