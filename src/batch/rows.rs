//! Rows of a table that somebody wrote: CSV or Parquet, read block by block.

use super::refusal;
use crate::error::Result;
#[cfg(feature = "parquet")]
use crate::error::brief;
use crate::table::stream::BLOCK_ROWS;
use std::io::{BufRead, BufReader, Read};

/// A cell as it was read.
#[derive(Clone, Debug, PartialEq)]
pub enum RowCell {
    /// A number of a column of numbers.
    Number(f64),
    /// Text, which may be that of a number; empty where nothing is there.
    Text(String),
}

/// Some rows, column by column, and where each stands: its line in a CSV file, else its number.
#[derive(Debug, Default)]
pub struct RawBlock {
    pub(super) places: Vec<u64>,
    pub(super) columns: Vec<Vec<RowCell>>,
}

/// A table that is read row by row.
pub struct RowReader {
    name: String,
    header: Vec<String>,
    /// Which columns hold numbers only, by the file's own word.
    pub(super) numeric: Vec<bool>,
    source: RowSource,
}

enum RowSource {
    /// With the lines that its positions lag behind.
    Csv(csv::Reader<Box<dyn Read>>, u64),
    #[cfg(feature = "parquet")]
    Parquet(Box<parquet::record::reader::RowIter<'static>>, u64),
}

impl RowReader {
    /// Rows of CSV: the first line names the columns, lines that start with `#` are comments. `name` is the file's in messages.
    ///
    /// # Errors
    /// [`Error::Request`](crate::Error::Request) if this is no CSV.
    pub fn csv(name: &str, text: Box<dyn Read>) -> Result<Self> {
        let mut text = BufReader::new(text);
        // With line ends of Windows a record begins, for the reader, between the two bytes of the one before.
        let lag =
            u64::from(text.fill_buf().is_ok_and(|begin| begin.split(|it| *it == b'\n').next().is_some_and(|line| line.ends_with(b"\r"))));
        let text: Box<dyn Read> = Box::new(text);
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text);
        let header: Vec<String> = reader.headers().map_err(|error| broken(name, 0, error))?.iter().map(str::to_owned).collect();
        // Spreadsheets begin a file with a mark that nobody sees.
        let header: Vec<String> = header.iter().map(|it| it.trim_start_matches('\u{feff}').to_owned()).collect();
        if header.iter().any(|it| it.contains([';', '\t'])) {
            return Err(refusal(format!("{name}:1: the columns are not separated by commas; save the file with commas")));
        }
        let numeric = vec![false; header.len()];
        Ok(Self { name: name.to_owned(), header, numeric, source: RowSource::Csv(reader, lag) })
    }

    /// Rows of a Parquet file.
    ///
    /// # Errors
    /// [`Error::Request`](crate::Error::Request) if this is no Parquet file, or has columns within columns.
    #[cfg(feature = "parquet")]
    pub fn parquet(name: &str, file: std::fs::File) -> Result<Self> {
        use parquet::basic::Type as Physical;
        use parquet::file::reader::{FileReader, SerializedFileReader};
        let wrong = |error: parquet::errors::ParquetError| refusal(format!("{name}: this is not Parquet: {}", brief(&error.to_string())));
        let reader = SerializedFileReader::new(file).map_err(wrong)?;
        let (mut header, mut numeric) = (Vec::new(), Vec::new());
        for field in reader.metadata().file_metadata().schema().get_fields() {
            if !field.is_primitive() {
                return Err(refusal(format!("{name}: the column \"{}\" has columns in it; write plain columns", field.name())));
            }
            header.push(field.name().to_owned());
            numeric.push(matches!(field.get_physical_type(), Physical::INT32 | Physical::INT64 | Physical::FLOAT | Physical::DOUBLE));
        }
        Ok(Self { name: name.to_owned(), header, numeric, source: RowSource::Parquet(Box::new(reader.into_iter()), 0) })
    }

    /// The names of its columns.
    pub fn header(&self) -> &[String] {
        &self.header
    }

    /// The next rows, a whole block as long as there are so many; none at the end.
    ///
    /// # Errors
    /// [`Error::Request`](crate::Error::Request) that names the row.
    pub fn next_block(&mut self) -> Result<RawBlock> {
        let mut block = RawBlock { places: Vec::new(), columns: vec![Vec::new(); self.header.len()] };
        while block.places.len() < BLOCK_ROWS {
            match &mut self.source {
                RowSource::Csv(reader, lag) => {
                    let mut record = csv::StringRecord::new();
                    if !reader.read_record(&mut record).map_err(|error| broken(&self.name, *lag, error))? {
                        break;
                    }
                    block.places.push(*lag + record.position().map_or(0, csv::Position::line));
                    for (column, cell) in block.columns.iter_mut().zip(&record) {
                        column.push(RowCell::Text(cell.to_owned()));
                    }
                }
                #[cfg(feature = "parquet")]
                RowSource::Parquet(rows, count) => {
                    let Some(row) = rows.next() else { break };
                    *count += 1;
                    let place = |what: &str| format!("{}: row {count}{what}", self.name);
                    let row = row.map_err(|error| refusal(format!("{}: {}", place(""), brief(&error.to_string()))))?;
                    block.places.push(*count);
                    for (column, (name, field)) in block.columns.iter_mut().zip(row.get_column_iter()) {
                        let cell = cell_of(field);
                        column.push(
                            cell.ok_or_else(|| {
                                refusal(format!("{}: neither a number nor a text", place(&format!(", column \"{name}\""))))
                            })?,
                        );
                    }
                }
            }
        }
        Ok(block)
    }

    /// A cell's place, for messages.
    pub(super) fn place(&self, place: u64, column: usize) -> String {
        let name = &self.header[column];
        match self.source {
            RowSource::Csv(..) => format!("{}:{place}: column \"{name}\"", self.name),
            #[cfg(feature = "parquet")]
            RowSource::Parquet(..) => format!("{}: row {place}, column \"{name}\"", self.name),
        }
    }

    /// The file's name, for messages.
    pub(super) fn name(&self) -> &str {
        &self.name
    }
}

fn broken(name: &str, lag: u64, error: csv::Error) -> crate::Error {
    let line = lag + error.position().map_or(1, csv::Position::line);
    let why = match error.into_kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("the row has {len} cells, the header {expected_len}; give every row the same")
        }
        csv::ErrorKind::Utf8 { .. } => "this is not UTF-8 text; save the file in the encoding UTF-8".to_owned(),
        csv::ErrorKind::Io(error) => error.to_string(),
        _ => "this is not CSV".to_owned(),
    };
    refusal(format!("{name}:{line}: {why}"))
}

/// A cell of a Parquet file; `None` if it is neither a number nor a text.
#[cfg(feature = "parquet")]
#[allow(clippy::cast_precision_loss, reason = "an integer that is no f64 is rounded, as in a study")]
fn cell_of(field: &parquet::record::Field) -> Option<RowCell> {
    use parquet::record::Field;
    Some(match field {
        Field::Null => RowCell::Text(String::new()),
        Field::Bool(it) => RowCell::Text(if *it { "yes" } else { "no" }.to_owned()),
        Field::Byte(it) => RowCell::Number((*it).into()),
        Field::Short(it) => RowCell::Number((*it).into()),
        Field::Int(it) => RowCell::Number((*it).into()),
        Field::Long(it) => RowCell::Number(*it as f64),
        Field::UByte(it) => RowCell::Number((*it).into()),
        Field::UShort(it) => RowCell::Number((*it).into()),
        Field::UInt(it) => RowCell::Number((*it).into()),
        Field::ULong(it) => RowCell::Number(*it as f64),
        Field::Float(it) => RowCell::Number((*it).into()),
        Field::Double(it) => RowCell::Number(*it),
        Field::Str(it) => RowCell::Text(it.clone()),
        _ => return None,
    })
}
