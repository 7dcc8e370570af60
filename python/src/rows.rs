//! Rows that a user gives: a dictionary of columns, or any table that speaks Arrow.

use crate::arrow_in;
use crate::errors::request;
use beltspace::batch::{ColumnCells, RowCell};
use pyo3::buffer::PyBuffer;
use pyo3::exceptions::PyImportError;
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
        let py = table.py();
        match arrow_in::columns(table) {
            Ok(Some(columns)) => return Ok(Self { columns, held: Vec::new() }),
            // pandas speaks Arrow by pyarrow alone. Without it the columns are arrays of numpy.
            Err(error) if error.is_instance_of::<PyImportError>(py) && table.hasattr("columns")? => {
                let mut given = Self { columns: Vec::new(), held: Vec::new() };
                for name in table.getattr("columns")?.try_iter()? {
                    let name = name?;
                    given.take(&name, &table.get_item(&name)?.call_method0("to_numpy")?)?;
                }
                return Ok(given);
            }
            Err(error) if error.is_instance_of::<PyImportError>(py) => return Err(no_table(table)),
            Err(error) => return Err(error),
            Ok(None) => {}
        }
        let Ok(mapping) = table.cast::<PyMapping>() else { return Err(no_table(table)) };
        let mut given = Self { columns: Vec::new(), held: Vec::new() };
        for item in mapping.items()?.iter() {
            let (name, values): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item.extract()?;
            given.take(&name, &values)?;
        }
        Ok(given)
    }

    fn take(&mut self, name: &Bound<'_, PyAny>, values: &Bound<'_, PyAny>) -> PyResult<()> {
        let Ok(text) = name.extract::<String>() else {
            return Err(request(name.py(), format!("a column is named by a text, not by {}", name.repr()?)));
        };
        let cells = self.cells(&text, values)?;
        self.columns.push((text, cells));
        Ok(())
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
        if let Some(row) = masked(&numpy, values)? {
            return Err(empty_cell(py, row, name));
        }
        let array = numpy.call_method1("asarray", (values,))?;
        let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
        let dimensions: usize = array.getattr("ndim")?.extract()?;
        if dimensions > 1 {
            return Err(request(py, format!("column \"{name}\" has {dimensions} dimensions; a column has one value per row")));
        }
        match (kind.as_str(), dimensions) {
            ("f" | "i" | "u" | "b", 0) => Ok(ColumnCells::Same(RowCell::Number(array.call_method0("item")?.extract()?))),
            ("f" | "i" | "u" | "b", _) => {
                // In one piece and aligned: what is so already is not copied.
                let numbers = numpy.call_method1("require", (array, "float64", ["C", "ALIGNED"]))?;
                let buffer = PyBuffer::<f64>::get(&numbers);
                self.borrowed(buffer.map_err(|error| request(py, format!("column \"{name}\" cannot be read: {error}")))?)
            }
            ("U" | "O", 1) => {
                let cells = array.call_method0("tolist")?;
                let texts: PyResult<Vec<String>> = cells.try_iter()?.enumerate().map(|(row, cell)| text(&cell?, row, name)).collect();
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

/// What is no table, and what would be one.
pub fn no_table(table: &Bound<'_, PyAny>) -> PyErr {
    let kind = table.get_type().name().map_or_else(|_| "value".to_owned(), |it| it.to_string());
    request(
        table.py(),
        format!(
            "a {kind} is no table, whose columns are named like inputs; give a dictionary of numpy arrays, or a table of pandas, polars, \
             pyarrow or DuckDB"
        ),
    )
}

/// A cell without a value.
pub fn empty_cell(py: Python<'_>, row: usize, column: &str) -> PyErr {
    request(py, format!("row {row}, column \"{column}\": the cell is empty; give a value"))
}

/// The first row that numpy has masked; a masked scalar is its own.
fn masked(numpy: &Bound<'_, PyModule>, values: &Bound<'_, PyAny>) -> PyResult<Option<usize>> {
    let ma = numpy.getattr("ma")?;
    if !ma.call_method1("is_masked", (values,))?.is_truthy()? {
        return Ok(None);
    }
    let mask = numpy.call_method1("ravel", (ma.call_method1("getmaskarray", (values,))?,))?;
    mask.call_method0("argmax")?.extract().map(Some)
}

/// A cell of an array of objects as a text.
fn text(cell: &Bound<'_, PyAny>, row: usize, column: &str) -> PyResult<String> {
    // The last two are what pandas has for absent values.
    if cell.is_none() || ["NAType", "NaTType"].contains(&cell.get_type().name()?.to_str()?) {
        return Err(empty_cell(cell.py(), row, column));
    }
    match cell.extract::<bool>() {
        Ok(truth) => Ok(u8::from(truth).to_string()),
        Err(_) => cell.str()?.extract(),
    }
}
