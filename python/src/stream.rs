//! Tables that may be longer than the memory: computed block by block, as often as somebody reads them.

use crate::arrow_out;
use crate::column::Column;
use crate::errors::raised;
use crate::table::Table;
use crate::waiting::{Interpreter, is_main_thread, note_main_thread, supervised};
use arrow_array::{RecordBatch, RecordBatchReader};
use arrow_schema::{ArrowError, SchemaRef};
use beltspace::Control;
use beltspace::run::{FeasibleCursor, FeasibleRows};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A table that may be longer than the memory. Its rows are computed while they are read, 65 536 at a time, and it may be read again and
/// again: `for table in rows`, `polars.DataFrame(rows)`, `pyarrow.RecordBatchReader.from_stream(rows)`. Ctrl-C ends the reading and raises
///     KeyboardInterrupt; who reads a stream of Arrow may tell an error of its own first.
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

    /// What another package makes of the rows. Where a signal has stopped them, that package can only tell that something went wrong.
    fn read_by<'py>(&self, py: Python<'py>, package: &str, maker: &str) -> PyResult<Bound<'py, PyAny>> {
        let raised = Raised::default();
        let reading = RowReading { rows: self.rows.clone(), threads: self.threads, raised: raised.clone() };
        let made = py.import(package)?.call_method1(maker, (reading,));
        made.map_err(|error| locked(&raised).take().unwrap_or(error))
    }

    fn arrow<'py>(&self, py: Python<'py>, raised: Option<Raised>) -> PyResult<Bound<'py, PyCapsule>> {
        note_main_thread(py)?;
        let schema = arrow_out::schema(self.header().iter());
        let batches = ArrowBatches { rows: self.rows.clone(), threads: self.threads, cursor: self.rows.cursor(), schema, raised };
        arrow_out::capsule(py, Box::new(batches))
    }
}

/// What a signal has raised while rows were read.
type Raised = Arc<Mutex<Option<PyErr>>>;

/// The rows for one reader in a method of ours, which raises what a signal has raised.
#[pyclass(module = "beltspace", frozen)]
struct RowReading {
    rows: Arc<FeasibleRows>,
    threads: usize,
    raised: Raised,
}

#[pymethods]
impl RowReading {
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(&self, py: Python<'py>, requested_schema: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyCapsule>> {
        drop(requested_schema);
        RowStream::new(self.rows.clone(), self.threads).arrow(py, Some(self.raised.clone()))
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

    /// The rows as tables of 65 536 rows, the last one shorter; each is computed when it is asked for. RuntimeError if the f64 reference
    /// does not agree with the sweep. Who reads on after Ctrl-C misses no rows.
    fn __iter__(&self) -> TableBatches {
        let cursor = Mutex::new(self.rows.cursor());
        TableBatches { rows: self.rows.clone(), threads: self.threads, cursor, returned: Mutex::default() }
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
        slf.get().read_by(slf.py(), "polars", "DataFrame")
    }

    /// All rows as a pyarrow Table, in memory; pyarrow must be installed.
    fn to_pyarrow<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.get().read_by(slf.py(), "pyarrow", "table")
    }

    /// The rows as a stream of Arrow batches, each computed when it is asked for. It may be called again and again.
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(&self, py: Python<'py>, requested_schema: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyCapsule>> {
        // What is asked for is a wish, and a producer may always give what it has.
        drop(requested_schema);
        self.arrow(py, None)
    }

    /// Names and kinds of the columns as Arrow has them.
    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        arrow_out::schema_capsule(py, self.header().iter())
    }

    fn __repr__(&self) -> String {
        format!("<beltspace.RowStream: {} rows, {} columns, computed while they are read>", self.num_rows(), self.num_columns())
    }
}

/// The tables of a `RowStream`, one after the other.
#[pyclass(module = "beltspace", frozen)]
pub struct TableBatches {
    rows: Arc<FeasibleRows>,
    threads: usize,
    cursor: Mutex<FeasibleCursor>,
    /// Tables that were ready when a signal came: the next ones.
    returned: Mutex<Vec<beltspace::Table>>,
}

#[pymethods]
impl TableBatches {
    fn __iter__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<Table>> {
        if let Some(table) = locked(&self.returned).pop() {
            return Table::new(py, table).map(Some);
        }
        let (control, made) = (Control::default(), Mutex::new(None));
        // Two threads that share an iterator get different tables.
        let work = || {
            let next = self.rows.next(&mut locked(&self.cursor), self.threads, &control);
            *locked(&made) = Some(next);
        };
        let ended = supervised(py, || control.stop.store(true, Ordering::Relaxed), |_| Ok(()), work);
        // A signal that came since the last look would take the rows away on their way back.
        let ended = ended.and_then(|()| py.check_signals());
        let next = made.into_inner().unwrap_or_else(PoisonError::into_inner);
        match (ended, next) {
            (Ok(()), Some(next)) => next.map_err(|error| raised(py, error))?.map(|table| Table::new(py, table)).transpose(),
            (Ok(()), None) => Ok(None),
            (Err(error), next) => {
                // Who goes on after Ctrl-C misses nothing.
                locked(&self.returned).extend(next.and_then(Result::ok).flatten());
                Err(error)
            }
        }
    }
}

/// The same for Arrow, which asks with the interpreter or without it, on whatever thread it likes.
struct ArrowBatches {
    rows: Arc<FeasibleRows>,
    threads: usize,
    cursor: FeasibleCursor,
    schema: SchemaRef,
    /// Where a method of ours waits for what a signal raises.
    raised: Option<Raised>,
}

impl ArrowBatches {
    /// The next rows. On the main thread signals are looked at, which nobody else can do meanwhile. Other threads never ask for the
    /// interpreter: the thread that has it may be waiting for these rows.
    fn next_table(&mut self) -> Result<Option<beltspace::Table>, ArrowError> {
        let Self { rows, threads, cursor, .. } = self;
        let control = Control::default();
        let mut work = || rows.next(cursor, *threads, &control);
        let next = if is_main_thread() {
            let interpreter = Interpreter::take();
            let py = interpreter.python();
            let stop = || control.stop.store(true, Ordering::Relaxed);
            // First those that came between two blocks, each of which may take less time than it is waited for.
            match py.check_signals().and_then(|()| supervised(py, stop, |_| Ok(()), work)) {
                Ok(next) => next,
                Err(error) => return Err(self.stopped(py, error)),
            }
        } else {
            work()
        };
        next.map_err(|error| ArrowError::ExternalError(Box::new(error)))
    }

    /// The reader is told that something went wrong. What was raised goes to who waits for it; without anybody Ctrl-C comes once more, as
    /// soon as Python runs again.
    fn stopped(&self, py: Python<'_>, error: PyErr) -> ArrowError {
        let told = ArrowError::ComputeError(format!("the rows were not read to their end: {error}"));
        match &self.raised {
            Some(raised) => *locked(raised) = Some(error),
            // SAFETY: it may be called at any time; the interpreter is held.
            None if error.is_instance_of::<PyKeyboardInterrupt>(py) => unsafe { ffi::PyErr_SetInterrupt() },
            None => {}
        }
        told
    }
}

impl Iterator for ArrowBatches {
    type Item = Result<RecordBatch, ArrowError>;

    fn next(&mut self) -> Option<Self::Item> {
        let table = self.next_table().transpose()?;
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
