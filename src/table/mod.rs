//! A table of results, before it is written as CSV or Parquet.

pub(crate) mod csv;
mod number;
#[cfg(feature = "parquet")]
pub(crate) mod parquet;
pub mod stream;

pub use csv::write as csv_text;
pub use number::{brief, counted, grouped, plain, short, written};

/// Values of one column.
#[derive(Clone, Debug, PartialEq)]
pub enum Data {
    /// Indices and counts; `None` if there is none.
    Whole(Vec<Option<u64>>),
    /// Numbers; `None` where they have no meaning.
    Number(Vec<Option<f64>>),
    /// Words.
    Text(Vec<String>),
}

impl Data {
    /// A cell as it is written: the shortest number, nothing for an absent value.
    pub fn text(&self, row: usize) -> String {
        match self {
            Self::Whole(values) => values[row].map_or(String::new(), |value| value.to_string()),
            Self::Number(values) => values[row].map_or(String::new(), plain),
            Self::Text(values) => values[row].clone(),
        }
    }
}

/// A column and its description.
#[derive(Clone, Debug, PartialEq)]
pub struct TableColumn {
    /// Name, with the unit.
    pub name: String,
    /// Unit; empty for plain numbers.
    pub unit: String,
    /// `design`, `objective`, `constraint`, `report`, `index`, ...; several, with commas between them, if a design input is also an
    /// objective or has a constraint.
    pub role: String,
    /// `min` or `max` for an objective, the bounds in words for a constraint, else empty.
    pub direction: String,
    /// What it is, in a sentence.
    pub description: String,
    /// One value per row.
    pub data: Data,
}

impl TableColumn {
    /// A column that needs only a name and a description.
    pub fn index(name: &str, description: &str, values: impl IntoIterator<Item = Option<u64>>) -> Self {
        Self::new(name, "index", description, Data::Whole(values.into_iter().collect()))
    }

    /// A column without unit and direction.
    pub fn new(name: &str, role: &str, description: &str, data: Data) -> Self {
        Self {
            name: name.to_owned(),
            unit: String::new(),
            role: role.to_owned(),
            direction: String::new(),
            description: description.to_owned(),
            data,
        }
    }
}

/// Columns of equal length.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The columns.
    pub columns: Vec<TableColumn>,
}

impl Table {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| match &column.data {
            Data::Whole(values) => values.len(),
            Data::Number(values) => values.len(),
            Data::Text(values) => values.len(),
        })
    }

    /// Some of its rows.
    #[cfg(all(test, feature = "parquet"))]
    pub(crate) fn part(&self, rows: std::ops::Range<usize>) -> Self {
        let part = |data: &Data| match data {
            Data::Whole(values) => Data::Whole(values[rows.clone()].to_vec()),
            Data::Number(values) => Data::Number(values[rows.clone()].to_vec()),
            Data::Text(values) => Data::Text(values[rows.clone()].to_vec()),
        };
        Self { columns: self.columns.iter().map(|it| TableColumn { data: part(&it.data), ..it.clone() }).collect() }
    }

    /// Adds the rows of a table of the same columns.
    pub(crate) fn append(&mut self, other: Self) {
        for (own, other) in self.columns.iter_mut().zip(other.columns) {
            match (&mut own.data, other.data) {
                (Data::Whole(own), Data::Whole(other)) => own.extend(other),
                (Data::Number(own), Data::Number(other)) => own.extend(other),
                (Data::Text(own), Data::Text(other)) => own.extend(other),
                _ => unreachable!("columns of the same table are of one kind"),
            }
        }
    }

    /// The first name that two of its columns have.
    pub(crate) fn doubled_name(&self) -> Option<&str> {
        let mut known = std::collections::HashSet::new();
        self.columns.iter().map(|column| column.name.as_str()).find(|name| !known.insert(*name))
    }

    /// The table as CSV, as in a result directory: a header, decimal points, the shortest numbers that read back as the same f64, nothing
    /// for absent values.
    pub fn csv(&self) -> Vec<u8> {
        csv::write(self)
    }

    /// The column of that name.
    pub fn column(&self, name: &str) -> Option<&TableColumn> {
        self.columns.iter().find(|column| column.name == name)
    }

    /// The number in a row of the column of that name, in the column's unit; `None` if there is no such row or column, the cell is empty
    /// or holds a word. Rows count from 0.
    pub fn number(&self, name: &str, row: usize) -> Option<f64> {
        match &self.column(name)?.data {
            #[allow(clippy::cast_precision_loss, reason = "who asks for a number takes the nearest")]
            Data::Whole(values) => values.get(row).copied().flatten().map(|value| value as f64),
            Data::Number(values) => values.get(row).copied().flatten(),
            Data::Text(_) => None,
        }
    }

    /// The index of the design in a row of a table of designs; `None` if there is no such row, or this is another kind of table.
    pub fn design(&self, row: usize) -> Option<u64> {
        match &self.column("design_index")?.data {
            Data::Whole(values) => values.get(row).copied().flatten(),
            Data::Number(_) | Data::Text(_) => None,
        }
    }
}
