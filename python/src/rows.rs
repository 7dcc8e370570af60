//! Rows that a user gives: a dictionary of columns, or any table that speaks Arrow.

use crate::arrow_in;
use crate::errors::request;
use beltspace::batch::{ColumnCells, RowCell};
use pyo3::buffer::PyBuffer;
use pyo3::prelude::*;
use pyo3::types::{PyMapping, PyString};

/// The columns of a table, by name; those of numpy arrays are read where they stand.
pub struct GivenTable {
    columns: Vec<(String, ColumnCells<'static>)>,
    /// What the columns borrow from: dropped after them.
    held: Vec<PyBuffer<f64>>,
}

impl GivenTable {
    /// Reads a table.
    pub fn new(table: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Some(columns) = arrow_in::columns(table)? {
            return Ok(Self { columns, held: Vec::new() });
        }
        let py = table.py();
        let Ok(mapping) = table.cast::<PyMapping>() else {
            let kind = table.get_type().name()?;
            return Err(request(
                py,
                format!("a {kind} is no table; give a dictionary of numpy arrays, or a table of pandas, polars, pyarrow or DuckDB"),
            ));
        };
        let mut given = Self { columns: Vec::new(), held: Vec::new() };
        for item in mapping.items()?.iter() {
            let (name, values): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item.extract()?;
            let Ok(name) = name.extract::<String>() else {
                return Err(request(py, format!("a column is named by a text, not by {}", name.repr()?)));
            };
            let cells = given.cells(&name, &values)?;
            given.columns.push((name, cells));
        }
        Ok(given)
    }

    /// The columns, which borrow from this.
    pub fn columns(&self) -> &[(String, ColumnCells<'_>)] {
        &self.columns
    }

    fn cells(&mut self, name: &str, values: &Bound<'_, PyAny>) -> PyResult<ColumnCells<'static>> {
        let py = values.py();
        if let Ok(text) = values.cast::<PyString>() {
            return Ok(ColumnCells::Same(RowCell::Text(text.extract()?)));
        }
        let numpy = py.import("numpy")?;
        let array = numpy.call_method1("asarray", (values,))?;
        let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
        let dimensions: usize = array.getattr("ndim")?.extract()?;
        if dimensions > 1 {
            return Err(request(py, format!("column \"{name}\" has {dimensions} dimensions; a column has one value per row")));
        }
        match (kind.as_str(), dimensions) {
            ("f" | "i" | "u" | "b", 0) => Ok(ColumnCells::Same(RowCell::Number(array.call_method0("item")?.extract()?))),
            ("f" | "i" | "u" | "b", _) => {
                let numbers = numpy.call_method1("ascontiguousarray", (array, "float64"))?;
                self.borrowed(PyBuffer::<f64>::get(&numbers)?)
            }
            ("U" | "O", 1) => {
                let texts: PyResult<Vec<String>> = array.call_method0("tolist")?.try_iter()?.map(|it| it?.str()?.extract()).collect();
                Ok(ColumnCells::Texts(texts?))
            }
            _ => Err(request(py, format!("column \"{name}\": {} is neither numbers nor texts", array.getattr("dtype")?))),
        }
    }

    fn borrowed(&mut self, buffer: PyBuffer<f64>) -> PyResult<ColumnCells<'static>> {
        let (start, count) = (buffer.buf_ptr().cast::<f64>().cast_const(), buffer.item_count());
        self.held.push(buffer);
        if count == 0 {
            return Ok(ColumnCells::Numbers(Vec::new().into()));
        }
        // SAFETY: the buffer is one contiguous block of `count` numbers, aligned as its type is; it is held as long as the columns, which
        // leave this only by a borrow of it. As with every function of numpy that releases the interpreter's lock, nobody may write to the
        // array while it is evaluated; who does gets rows of both, from arithmetic alone.
        let numbers: &'static [f64] = unsafe { std::slice::from_raw_parts(start, count) };
        Ok(ColumnCells::Numbers(numbers.into()))
    }
}
