//! Tables that may be longer than the memory: computed block by block, as often as somebody reads them.

use crate::arrow_out;
use crate::column::Column;
use crate::errors::raised;
use crate::table::Table;
use crate::waiting::supervised;
use arrow_array::{RecordBatch, RecordBatchReader};
use arrow_schema::{ArrowError, SchemaRef};
use beltspace::Control;
use beltspace::run::{FeasibleCursor, FeasibleRows};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, PoisonError};

/// A table that is computed block by block while it is read; it may be read again and again.
#[pyclass(module = "beltspace", frozen)]
pub struct RowStream {
    rows: Arc<FeasibleRows>,
    threads: usize,
}

impl RowStream {
    pub fn new(rows: Arc<FeasibleRows>, threads: usize) -> Self {
        Self { rows, threads }
    }

    fn header(&self) -> Vec<Column> {
        self.rows.header().columns.into_iter().map(Column::new).collect()
    }
}

#[pymethods]
impl RowStream {
    /// Number of rows.
    #[getter]
    fn num_rows(&self) -> u64 {
        self.rows.rows()
    }

    /// Number of columns.
    #[getter]
    fn num_columns(&self) -> usize {
        self.rows.header().columns.len()
    }

    /// Names of the columns, which end in their units.
    #[getter]
    fn column_names(&self) -> Vec<String> {
        self.rows.header().columns.into_iter().map(|column| column.name).collect()
    }

    fn __len__(&self) -> usize {
        usize::try_from(self.rows.rows()).unwrap_or(usize::MAX)
    }

    /// The rows as tables of 65 536 rows, the last one shorter; each is computed when it is asked for.
    fn __iter__(&self) -> TableBatches {
        TableBatches { rows: self.rows.clone(), threads: self.threads, cursor: Mutex::new(self.rows.cursor()) }
    }

    /// All rows as a table, in memory.
    fn to_table(&self, py: Python<'_>) -> PyResult<Table> {
        let control = Control::default();
        let work = || self.rows.table(self.threads, &control);
        let whole = supervised(py, || control.stop.store(true, Ordering::Relaxed), |_| Ok(()), work)?;
        Table::new(py, whole.map_err(|error| raised(py, error))?)
    }

    /// All rows as a pandas DataFrame, in memory; pandas must be installed.
    fn to_pandas<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Py::new(py, self.to_table(py)?)?.bind(py).call_method0("to_pandas")
    }

    /// All rows as a polars DataFrame, in memory; polars must be installed.
    fn to_polars<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("polars")?.call_method1("DataFrame", (slf,))
    }

    /// All rows as a pyarrow Table, in memory; pyarrow must be installed.
    fn to_pyarrow<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("pyarrow")?.call_method1("table", (slf,))
    }

    /// The rows as a stream of Arrow batches, each computed when it is asked for. It may be called again and again.
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(&self, py: Python<'py>, requested_schema: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyCapsule>> {
        // What is asked for is a wish, and a producer may always give what it has.
        drop(requested_schema);
        let schema = arrow_out::schema(self.header().iter());
        let batches = ArrowBatches { rows: self.rows.clone(), threads: self.threads, cursor: self.rows.cursor(), schema };
        arrow_out::capsule(py, Box::new(batches))
    }

    /// Names and kinds of the columns as Arrow has them.
    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        arrow_out::schema_capsule(py, self.header().iter())
    }

    fn __repr__(&self) -> String {
        format!("<beltspace.RowStream: {} rows, {} columns, computed while they are read>", self.num_rows(), self.num_columns())
    }
}

/// The tables of a stream, one after the other.
#[pyclass(module = "beltspace", frozen)]
pub struct TableBatches {
    rows: Arc<FeasibleRows>,
    threads: usize,
    cursor: Mutex<FeasibleCursor>,
}

#[pymethods]
impl TableBatches {
    fn __iter__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<Table>> {
        let control = Control::default();
        // Two threads that share an iterator get different tables.
        let work = || self.rows.next(&mut self.cursor.lock().unwrap_or_else(PoisonError::into_inner), self.threads, &control);
        let next = supervised(py, || control.stop.store(true, Ordering::Relaxed), |_| Ok(()), work)?;
        next.map_err(|error| raised(py, error))?.map(|table| Table::new(py, table)).transpose()
    }
}

/// The same for Arrow, which asks without the interpreter.
struct ArrowBatches {
    rows: Arc<FeasibleRows>,
    threads: usize,
    cursor: FeasibleCursor,
    schema: SchemaRef,
}

impl Iterator for ArrowBatches {
    type Item = Result<RecordBatch, ArrowError>;

    fn next(&mut self) -> Option<Self::Item> {
        let next = self.rows.next(&mut self.cursor, self.threads, &Control::default());
        let table = next.map_err(|error| ArrowError::ExternalError(Box::new(error))).transpose()?;
        Some(table.and_then(|table| {
            let columns: Vec<Column> = table.columns.into_iter().map(Column::new).collect();
            arrow_out::batch(columns.iter(), columns.first().map_or(0, Column::rows))
        }))
    }
}

impl RecordBatchReader for ArrowBatches {
    fn schema(&self) -> SchemaRef {
        self.schema.clone()
    }
}
