//! Parquet files, without Arrow: row groups of 65 536 rows, compressed with snappy, no time stamps, so that equal tables are equal bytes.

use super::{Data, Table};
use crate::error::{Error, Result};
use parquet::basic::{Compression, Encoding, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{ColumnPath, Type};
use std::io::Write;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// Rows of a row group.
pub const GROUP: usize = 65_536;

/// A table as Parquet. The file's key-value metadata has unit, role, direction and description of every column, as
/// `<column>.unit` and so on.
///
/// # Errors
/// [`Error::Io`] if the writer refuses the table.
pub fn write(table: &Table) -> Result<Vec<u8>> {
    let mut stream = ParquetStream::new(table)?;
    stream.write(table)?;
    stream.finish()
}

fn failed(error: ParquetError) -> Error {
    Error::Io { path: PathBuf::from("Parquet table"), source: std::io::Error::other(error) }
}

/// Bytes that were written and have not been taken yet.
#[derive(Clone, Default)]
struct Pending(Arc<Mutex<Vec<u8>>>);

impl Pending {
    fn take(&self) -> Vec<u8> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Write for Pending {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// A table as Parquet, block of rows after block of rows; the bytes are taken as they come.
pub struct ParquetStream {
    writer: SerializedFileWriter<Pending>,
    pending: Pending,
}

impl ParquetStream {
    /// Starts a table with the columns of this one; its rows are not written yet.
    ///
    /// # Errors
    /// [`Error::Io`] if the writer refuses the columns.
    pub fn new(table: &Table) -> Result<Self> {
        let pending = Pending::default();
        let (schema, properties) = (schema(table).map_err(failed)?, properties(table));
        let writer = SerializedFileWriter::new(pending.clone(), schema, Arc::new(properties)).map_err(failed)?;
        Ok(Self { writer, pending })
    }

    /// Adds the rows of a table of the same columns. Blocks of [`GROUP`] rows give the file that the whole table would give.
    ///
    /// # Errors
    /// [`Error::Io`] if the writer refuses them.
    pub fn write(&mut self, table: &Table) -> Result<()> {
        for first in (0..table.rows()).step_by(GROUP) {
            write_group(&mut self.writer, table, first..table.rows().min(first + GROUP)).map_err(failed)?;
        }
        Ok(())
    }

    /// The bytes so far that have not been taken.
    pub fn take(&self) -> Vec<u8> {
        self.pending.take()
    }

    /// Ends the table: the rest of its bytes.
    ///
    /// # Errors
    /// [`Error::Io`] if the writer cannot end.
    pub fn finish(self) -> Result<Vec<u8>> {
        self.writer.close().map_err(failed)?;
        Ok(self.pending.take())
    }
}

fn schema(table: &Table) -> std::result::Result<Arc<Type>, ParquetError> {
    let fields = table.columns.iter().map(|column| {
        let (physical, repetition, logical) = match column.data {
            // A study may have more designs than a signed number can count.
            Data::Whole(_) => (Physical::INT64, Repetition::OPTIONAL, Some(LogicalType::integer(64, false))),
            Data::Number(_) => (Physical::DOUBLE, Repetition::OPTIONAL, None),
            Data::Text(_) => (Physical::BYTE_ARRAY, Repetition::REQUIRED, Some(LogicalType::String)),
        };
        let builder = Type::primitive_type_builder(&column.name, physical).with_repetition(repetition).with_logical_type(logical);
        builder.build().map(Arc::new)
    });
    let fields = fields.collect::<std::result::Result<Vec<_>, _>>()?;
    Type::group_type_builder("designs").with_fields(fields).build().map(Arc::new)
}

fn properties(table: &Table) -> WriterProperties {
    let metadata = table.columns.iter().flat_map(|column| {
        let about =
            [("unit", &column.unit), ("role", &column.role), ("direction", &column.direction), ("description", &column.description)];
        about.map(|(what, text)| KeyValue::new(format!("{}.{what}", column.name), text.clone()))
    });
    let mut properties = WriterProperties::builder()
        .set_created_by(concat!("beltspace ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_compression(Compression::SNAPPY)
        .set_key_value_metadata(Some(metadata.collect()));
    // Indices mostly count up, so their differences take little room; a dictionary would have an entry for every one.
    for column in table.columns.iter().filter(|column| matches!(column.data, Data::Whole(_))) {
        let path = ColumnPath::from(column.name.as_str());
        properties = properties.set_column_dictionary_enabled(path.clone(), false).set_column_encoding(path, Encoding::DELTA_BINARY_PACKED);
    }
    properties.build()
}

fn write_group(
    writer: &mut SerializedFileWriter<Pending>,
    table: &Table,
    rows: std::ops::Range<usize>,
) -> std::result::Result<(), ParquetError> {
    let mut group = writer.next_row_group()?;
    for column in &table.columns {
        let mut to = group.next_column()?.expect("the schema has this column");
        match &column.data {
            Data::Whole(values) => {
                let values = &values[rows.clone()];
                let present: Vec<i64> = values.iter().flatten().map(|value| value.cast_signed()).collect();
                to.typed::<Int64Type>().write_batch(&present, Some(&levels(values)), None)?;
            }
            Data::Number(values) => {
                let values = &values[rows.clone()];
                let present: Vec<f64> = values.iter().flatten().copied().collect();
                to.typed::<DoubleType>().write_batch(&present, Some(&levels(values)), None)?;
            }
            Data::Text(values) => {
                let values: Vec<ByteArray> = values[rows.clone()].iter().map(|value| ByteArray::from(value.as_str())).collect();
                to.typed::<ByteArrayType>().write_batch(&values, None, None)?;
            }
        }
        to.close()?;
    }
    group.close()?;
    Ok(())
}

/// Definition levels: which values of an optional column are present.
fn levels<T>(values: &[Option<T>]) -> Vec<i16> {
    values.iter().map(|value| i16::from(value.is_some())).collect()
}

#[cfg(test)]
mod tests {
    use super::super::TableColumn;
    use super::*;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::RowAccessor;

    #[test]
    fn a_table_reads_back_with_its_absent_values_and_metadata() {
        let numbers: Vec<_> = (0..70_000u32).map(|i| (i % 3 > 0).then_some(f64::from(i) / 7.0)).collect();
        let number = TableColumn {
            unit: "N".to_owned(),
            direction: "min".to_owned(),
            ..TableColumn::new("force_N", "objective", "A force.", Data::Number(numbers.clone()))
        };
        let words = (0..70_000).map(|i| format!("w{i}")).collect();
        let table = Table {
            columns: vec![
                TableColumn::index("index", "", (0..70_000).map(|i| Some(i + (u64::MAX - 70_000)))),
                number,
                TableColumn::new("word", "design", "", Data::Text(words)),
            ],
        };
        let bytes = write(&table).unwrap();
        assert_eq!(bytes, write(&table).unwrap(), "equal tables are equal bytes");
        let mut stream = ParquetStream::new(&table).unwrap();
        let mut in_pieces = Vec::new();
        for first in [0, GROUP] {
            stream.write(&table.part(first..(first + GROUP).min(70_000))).unwrap();
            in_pieces.extend(stream.take());
        }
        in_pieces.extend(stream.finish().unwrap());
        assert!(bytes == in_pieces, "a table in blocks is the same file");
        let reader = SerializedFileReader::new(bytes::Bytes::from(bytes)).unwrap();
        let metadata = reader.metadata();
        assert_eq!((metadata.num_row_groups(), metadata.file_metadata().num_rows()), (2, 70_000));
        let keys = metadata.file_metadata().key_value_metadata().unwrap();
        assert!(keys.contains(&KeyValue::new("force_N.unit".to_owned(), "N".to_owned())));
        for (i, row) in reader.get_row_iter(None).unwrap().enumerate() {
            let row = row.unwrap();
            assert_eq!(row.get_ulong(0).unwrap(), i as u64 + (u64::MAX - 70_000));
            assert_eq!(row.get_double(1).ok(), numbers[i]);
            assert_eq!(row.get_string(2).unwrap(), &format!("w{i}"));
        }
    }
}
