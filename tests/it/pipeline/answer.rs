//! What a result directory says, as cells that are compared bit by bit.

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use std::collections::BTreeMap;
use std::path::Path;

/// A cell of a table or a value of the summary.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    Absent,
    /// The bits of a number.
    Number(u64),
    Text(String),
}

impl Cell {
    pub fn number(value: f64) -> Self {
        Self::Number((value + 0.0).to_bits())
    }

    fn parse(text: &str) -> Self {
        match text.parse::<f64>() {
            _ if text.is_empty() => Self::Absent,
            Ok(value) => Self::Number(value.to_bits()),
            Err(_) => Self::Text(text.to_owned()),
        }
    }

    /// Is it the same, or a number that differs by at most this, relative to the larger one?
    fn is_like(&self, other: &Self, tolerance: f64) -> bool {
        match (self, other) {
            _ if self == other => true,
            (Self::Number(a), Self::Number(b)) if tolerance > 0.0 => {
                let [a, b] = [*a, *b].map(f64::from_bits);
                (a - b).abs() <= tolerance * a.abs().max(b.abs())
            }
            _ => false,
        }
    }

    fn shown(&self) -> String {
        match self {
            Self::Absent => "nothing".to_owned(),
            Self::Number(bits) => format!("{:?}", f64::from_bits(*bits)),
            Self::Text(text) => format!("{text:?}"),
        }
    }
}

/// A count or an index.
pub fn whole(value: u64) -> Cell {
    Cell::number(value as f64)
}

/// Header and rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    pub header: Vec<String>,
    pub rows: Vec<Vec<Cell>>,
}

/// All tables by file name, and the summary by path.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Answer {
    pub tables: BTreeMap<String, Table>,
    pub summary: BTreeMap<String, Cell>,
}

impl Answer {
    /// The first thing in which two answers differ.
    pub fn difference(&self, found: &Self) -> Option<String> {
        self.difference_beyond(0.0, found)
    }

    /// The first thing in which two answers differ by more than this, relative. Counts and indices below a million never differ by less
    /// than a millionth.
    pub fn difference_beyond(&self, tolerance: f64, found: &Self) -> Option<String> {
        let (expected_names, names): (Vec<_>, Vec<_>) = (self.tables.keys().collect(), found.tables.keys().collect());
        if expected_names != names {
            return Some(format!("expected the tables {expected_names:?}, found {names:?}"));
        }
        for (name, expected) in &self.summary {
            let found = found.summary.get(name).unwrap_or(&Cell::Absent);
            if !found.is_like(expected, tolerance) {
                return Some(format!("summary.json: {name} should be {}, is {}", expected.shown(), found.shown()));
            }
        }
        for (name, expected) in &self.tables {
            let found = &found.tables[name];
            if expected.header != found.header {
                return Some(format!("{name}: expected the columns {:?}, found {:?}", expected.header, found.header));
            }
            for (row, (expected, found)) in expected.rows.iter().zip(&found.rows).enumerate() {
                for (column, (expected, cell)) in self.tables[name].header.iter().zip(expected.iter().zip(found)) {
                    if !expected.is_like(cell, tolerance) {
                        return Some(format!("{name}, row {row}: {column} should be {}, is {}", expected.shown(), cell.shown()));
                    }
                }
            }
            if expected.rows.len() != found.rows.len() {
                return Some(format!("{name}: expected {} rows, found {}", expected.rows.len(), found.rows.len()));
            }
        }
        None
    }

    /// What a result directory says.
    pub fn read(folder: &Path) -> Self {
        let mut answer = Self::default();
        for entry in std::fs::read_dir(folder).expect("there is a result") {
            let path = entry.expect("it can be listed").path();
            let name = path.file_name().expect("a file has a name").to_string_lossy().into_owned();
            if name.ends_with(".csv") {
                let mut reader = csv::Reader::from_path(&path).expect("it can be opened");
                let header = reader.headers().expect("a table has a header").iter().map(str::to_owned).collect();
                let rows = reader.records().map(|row| row.expect("rows are complete").iter().map(Cell::parse).collect());
                answer.tables.insert(name, Table { header, rows: rows.collect() });
            } else if name == "feasible.parquet" {
                answer.tables.insert(name, in_parquet(&path));
            }
        }
        let summary = std::fs::read_to_string(folder.join("summary.json")).expect("there is a summary");
        flatten("", &serde_json::from_str(&summary).expect("it is JSON"), &mut answer.summary);
        answer
    }
}

/// A table in Parquet, read by a reader of its own.
fn in_parquet(path: &Path) -> Table {
    let reader = SerializedFileReader::new(std::fs::File::open(path).expect("it can be opened")).expect("it is Parquet");
    let header = reader.metadata().file_metadata().schema().get_fields().iter().map(|field| field.name().to_owned()).collect();
    let cell = |field: &Field| match field {
        Field::Null => Cell::Absent,
        Field::Double(value) => Cell::number(*value),
        Field::ULong(value) => Cell::parse(&value.to_string()),
        other => Cell::parse(other.to_string().trim_matches('"')),
    };
    let rows = reader.get_row_iter(None).expect("it has rows").map(|row| {
        let row = row.expect("a row can be read");
        row.get_column_iter().map(|(_, field)| cell(field)).collect()
    });
    Table { header, rows: rows.collect() }
}

fn flatten(path: &str, value: &serde_json::Value, into: &mut BTreeMap<String, Cell>) {
    use serde_json::Value;
    let join = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    let cell = match value {
        Value::Object(map) => return map.iter().for_each(|(key, value)| flatten(&join(key), value, into)),
        Value::Array(list) => return list.iter().enumerate().for_each(|(key, value)| flatten(&join(&key.to_string()), value, into)),
        Value::Null => Cell::Absent,
        Value::Number(number) => Cell::number(number.as_f64().expect("numbers of a summary are f64")),
        Value::String(text) => Cell::Text(text.clone()),
        Value::Bool(value) => Cell::Text(value.to_string()),
    };
    into.insert(path.to_owned(), cell);
}
