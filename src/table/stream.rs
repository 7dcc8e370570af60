//! Tables that are too long for the memory: written block of rows after block of rows, in the form that the name of the file asks for.

#[cfg(feature = "parquet")]
use super::parquet::ParquetStream;
use super::{Table, csv};
use crate::error::{Error, Result};
use std::io::Write;
use std::path::Path;

/// Rows of a block: as many as a row group of a Parquet file has.
pub const BLOCK_ROWS: usize = 65_536;

/// How a table is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableForm {
    /// Text, with a header.
    Csv,
    /// Columns, compressed and described.
    #[cfg(feature = "parquet")]
    Parquet,
}

/// A table that is being written to `out`.
pub struct TableStream<'w> {
    form: TableForm,
    out: &'w mut dyn Write,
    path: &'w Path,
    begun: bool,
    #[cfg(feature = "parquet")]
    parquet: Option<ParquetStream>,
}

impl<'w> TableStream<'w> {
    /// Nothing is written yet; `path` is for messages.
    pub fn new(form: TableForm, out: &'w mut dyn Write, path: &'w Path) -> Self {
        Self {
            form,
            out,
            path,
            begun: false,
            #[cfg(feature = "parquet")]
            parquet: None,
        }
    }

    /// Adds rows: a table of the same columns every time, [`BLOCK_ROWS`] rows or fewer, fewer only in the last.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn write(&mut self, table: &Table) -> Result<()> {
        let bytes = match self.form {
            TableForm::Csv if self.begun => csv::rows(table),
            TableForm::Csv => csv::write(table),
            #[cfg(feature = "parquet")]
            TableForm::Parquet => {
                let mut stream = match self.parquet.take() {
                    Some(stream) => stream,
                    None => ParquetStream::new(table)?,
                };
                stream.write(table)?;
                self.parquet.insert(stream).take()
            }
        };
        self.begun = true;
        self.out.write_all(&bytes).map_err(Error::io(self.path))
    }

    /// Ends the table.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn finish(self) -> Result<()> {
        #[cfg(feature = "parquet")]
        if let Some(stream) = self.parquet {
            return self.out.write_all(&stream.finish()?).map_err(Error::io(self.path));
        }
        Ok(())
    }
}
