//! A table of results.

use crate::arrow_out;
use crate::column::Column;
use crate::waiting::supervised;
use pyo3::exceptions::{PyIndexError, PyKeyError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyCapsule, PyDict, PyList};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

/// Rows and columns that a notebook shows at most.
const SHOWN: (usize, usize) = (10, 12);

/// Rows that become CSV before it is asked whether to stop.
const CSV_ROWS: usize = 8192;

/// Columns of equal length. It speaks the Arrow PyCapsule interface: `polars.DataFrame(table)`, `pyarrow.table(table)`.
#[pyclass(module = "beltspace", frozen)]
pub struct Table {
    columns: Vec<Py<Column>>,
    rows: usize,
}

impl Table {
    /// From a table of the library.
    pub fn new(py: Python<'_>, table: beltspace::Table) -> PyResult<Self> {
        Self::of(py, table.columns.into_iter().map(Column::new).collect())
    }

    /// From columns of equal length.
    pub fn of(py: Python<'_>, columns: Vec<Column>) -> PyResult<Self> {
        let rows = columns.first().map_or(0, Column::rows);
        Ok(Self { columns: columns.into_iter().map(|it| Py::new(py, it)).collect::<PyResult<_>>()?, rows })
    }

    fn find(&self, name: &str) -> PyResult<&Py<Column>> {
        let found = self.columns.iter().find(|column| column.get().name() == name);
        found.ok_or_else(|| {
            let names: Vec<&str> = self.columns.iter().map(|it| it.get().name()).collect();
            PyKeyError::new_err(format!("there is no column \"{name}\"; there are: {}", names.join(", ")))
        })
    }
}

#[pymethods]
impl Table {
    /// Number of rows.
    #[getter]
    pub fn num_rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    #[getter]
    fn num_columns(&self) -> usize {
        self.columns.len()
    }

    /// Names of the columns, which end in their units.
    #[getter]
    fn column_names(&self) -> Vec<&str> {
        self.columns.iter().map(|column| column.get().name()).collect()
    }

    /// The columns, each with its unit, role and description.
    #[getter]
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        PyList::new(py, self.columns.iter().map(|column| column.bind(py)))
    }

    /// The column of that name; KeyError if there is none.
    fn column(&self, py: Python<'_>, name: &str) -> PyResult<Py<Column>> {
        self.find(name).map(|column| column.clone_ref(py))
    }

    fn __len__(&self) -> usize {
        self.rows
    }

    fn __contains__(&self, name: &str) -> bool {
        self.find(name).is_ok()
    }

    /// The values of a column as a numpy array.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        self.find(name)?.bind(py).call_method0("to_numpy")
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        PyList::new(py, self.column_names())?.call_method0("__iter__")
    }

    /// A row as a dictionary; rows count from 0, negative ones from the end. IndexError beyond.
    fn row<'py>(&self, py: Python<'py>, row: isize) -> PyResult<Bound<'py, PyDict>> {
        let at = if row < 0 { row + self.rows as isize } else { row };
        if at < 0 || at as usize >= self.rows {
            return Err(PyIndexError::new_err(format!("there is no row {row}; the table has {} rows", self.rows)));
        }
        let dict = PyDict::new(py);
        for column in &self.columns {
            dict.set_item(column.get().name(), column.get().value(py, at as usize)?)?;
        }
        Ok(dict)
    }

    /// Every column as an array, by name.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for column in &self.columns {
            dict.set_item(column.get().name(), column.bind(py).call_method0("to_numpy")?)?;
        }
        Ok(dict)
    }

    /// As a pandas DataFrame; pandas must be installed. Index columns of which a cell is absent are floats.
    fn to_pandas<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("pandas")?.call_method1("DataFrame", (self.to_dict(py)?,))
    }

    /// As a polars DataFrame; polars must be installed.
    fn to_polars<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("polars")?.call_method1("DataFrame", (slf,))
    }

    /// As a pyarrow Table; pyarrow must be installed.
    fn to_pyarrow<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("pyarrow")?.call_method1("table", (slf,))
    }

    /// The bytes that the program writes for this table, as CSV: a header, the shortest numbers, nothing for absent values. The interpreter
    /// lock is released meanwhile; Ctrl-C raises KeyboardInterrupt.
    fn to_csv<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let columns: Vec<&Column> = self.columns.iter().map(Py::get).collect();
        let part =
            |rows: Range<usize>| beltspace::Table { columns: columns.iter().map(|it| it.table_column(rows.clone())).collect() }.csv();
        let stop = AtomicBool::new(false);
        let work = || {
            let mut bytes = part(0..0);
            let header = bytes.len();
            for first in (0..self.rows).step_by(CSV_ROWS) {
                if stop.load(Ordering::Relaxed) {
                    break;
                }
                bytes.extend_from_slice(&part(first..self.rows.min(first + CSV_ROWS))[header..]);
            }
            bytes
        };
        let bytes = supervised(py, || stop.store(true, Ordering::Relaxed), |_| Ok(()), work)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// The rows as a stream of Arrow batches. It may be called again and again.
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(&self, py: Python<'py>, requested_schema: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyCapsule>> {
        // What is asked for is a wish, and a producer may always give what it has.
        drop(requested_schema);
        arrow_out::stream(py, &self.columns, self.rows)
    }

    /// Names and kinds of the columns as Arrow has them.
    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        arrow_out::schema_capsule(py, self.columns.iter().map(Py::get))
    }

    fn __repr__(&self) -> String {
        let (rows, columns) = (self.rows.min(SHOWN.0), self.columns.len().min(SHOWN.1));
        let mut lines = vec![String::new(); rows + 1];
        for column in &self.columns[..columns] {
            let column = column.get();
            let cells: Vec<String> = std::iter::once(column.name().to_owned()).chain((0..rows).map(|row| column.cell(row))).collect();
            let width = cells.iter().map(|it| it.chars().count()).max().unwrap_or(0);
            lines.iter_mut().zip(cells).for_each(|(line, cell)| line.push_str(&format!("{cell:>width$}  ")));
        }
        let size = format!("<beltspace.Table: {} rows, {} columns>", self.rows, self.columns.len());
        let more = if rows < self.rows || columns < self.columns.len() { "\n..." } else { "" };
        format!("{size}\n{}{more}", lines.iter().map(|it| it.trim_end()).collect::<Vec<_>>().join("\n"))
    }

    #[pyo3(name = "_repr_html_")]
    pub fn html(&self) -> String {
        let rows = self.rows.min(SHOWN.0);
        let columns: Vec<&Column> = self.columns.iter().take(SHOWN.1).map(Py::get).collect();
        let cells = |tag: &str, texts: Vec<String>| {
            let cells: String = texts.iter().map(|it| format!("<{tag}>{}</{tag}>", escaped(it))).collect();
            format!("<tr>{cells}</tr>")
        };
        let head = cells("th", columns.iter().map(|it| it.name().to_owned()).collect());
        let body: String = (0..rows).map(|row| cells("td", columns.iter().map(|it| it.cell(row)).collect())).collect();
        let size = format!("{} rows, {} columns", self.rows, self.columns.len());
        format!("<table><thead>{head}</thead><tbody>{body}</tbody></table><p>{size}</p>")
    }
}

/// A text in a page.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
