//! CSV files: a header with units, decimal points, the shortest numbers, empty cells for absent values.

use super::Table;
use csv::Writer;

const IN_MEMORY: &str = "writing into memory does not fail";

/// A table as CSV.
pub fn write(table: &Table) -> Vec<u8> {
    [header(table), rows(table)].concat()
}

/// The names of its columns, as the first line has them.
pub fn header(table: &Table) -> Vec<u8> {
    let mut writer = Writer::from_writer(Vec::new());
    writer.write_record(table.columns.iter().map(|column| column.name.as_str())).expect(IN_MEMORY);
    writer.into_inner().expect(IN_MEMORY)
}

/// Its rows.
pub fn rows(table: &Table) -> Vec<u8> {
    let mut writer = Writer::from_writer(Vec::new());
    for row in 0..table.rows() {
        writer.write_record(table.columns.iter().map(|column| column.data.text(row))).expect(IN_MEMORY);
    }
    writer.into_inner().expect(IN_MEMORY)
}
