//! Tables by the Arrow PyCapsule interface.

use crate::column::Column;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{RecordBatch, RecordBatchIterator, RecordBatchOptions};
use arrow_schema::ffi::FFI_ArrowSchema;
use arrow_schema::{ArrowError, Schema, SchemaRef};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use std::sync::Arc;

/// Rows of a batch.
pub const BATCH: usize = 65_536;

pub fn schema<'c>(columns: impl Iterator<Item = &'c Column>) -> SchemaRef {
    Arc::new(Schema::new(columns.map(Column::field).collect::<Vec<_>>()))
}

/// All rows; the memory is the columns' own.
pub fn batch<'c>(columns: impl Iterator<Item = &'c Column> + Clone, rows: usize) -> Result<RecordBatch, ArrowError> {
    let arrays = columns.clone().map(Column::array).collect();
    RecordBatch::try_new_with_options(schema(columns), arrays, &RecordBatchOptions::new().with_row_count(Some(rows)))
}

/// The rows in batches, as whoever reads them asks for.
pub fn stream<'py>(py: Python<'py>, columns: &[Py<Column>], rows: usize) -> PyResult<Bound<'py, PyCapsule>> {
    let whole = batch(columns.iter().map(Py::get), rows).map_err(failed)?;
    let schema = whole.schema();
    let batches = (0..rows).step_by(BATCH).map(move |first| Ok(whole.slice(first, BATCH.min(rows - first))));
    capsule(py, Box::new(RecordBatchIterator::new(batches, schema)))
}

/// A stream of batches.
pub fn capsule<'py>(py: Python<'py>, batches: Box<dyn arrow_array::RecordBatchReader + Send>) -> PyResult<Bound<'py, PyCapsule>> {
    PyCapsule::new_with_value(py, FFI_ArrowArrayStream::new(batches), c"arrow_array_stream")
}

/// Names and kinds of the columns.
pub fn schema_capsule<'py, 'c>(py: Python<'py>, columns: impl Iterator<Item = &'c Column>) -> PyResult<Bound<'py, PyCapsule>> {
    let schema = FFI_ArrowSchema::try_from(&*schema(columns)).map_err(failed)?;
    PyCapsule::new_with_value(py, schema, c"arrow_schema")
}

fn failed(error: ArrowError) -> PyErr {
    PyRuntimeError::new_err(format!("the table cannot be given as Arrow: {error}"))
}
