//! Rows that a user gives: a dictionary of columns, or any table that speaks Arrow.

use crate::arrow_in;
use crate::errors::request;
use beltspace::batch::{ColumnCells, RowCell};
use pyo3::buffer::PyBuffer;
use pyo3::prelude::*;
use pyo3::types::{PyMapping, PyString};

/// The columns of a table, by name.
pub fn columns(table: &Bound<'_, PyAny>) -> PyResult<Vec<(String, ColumnCells)>> {
    let py = table.py();
    if let Some(columns) = arrow_in::columns(table)? {
        return Ok(columns);
    }
    let Ok(mapping) = table.cast::<PyMapping>() else {
        let kind = table.get_type().name()?;
        return Err(request(
            py,
            format!("a {kind} is no table; give a dictionary of numpy arrays, or a table of pandas, polars, pyarrow or DuckDB"),
        ));
    };
    let mut columns = Vec::new();
    for item in mapping.items()?.iter() {
        let (name, values): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item.extract()?;
        let Ok(name) = name.extract::<String>() else {
            return Err(request(py, format!("a column is named by a text, not by {}", name.repr()?)));
        };
        let cells = cells(&name, &values)?;
        columns.push((name, cells));
    }
    Ok(columns)
}

fn cells(name: &str, values: &Bound<'_, PyAny>) -> PyResult<ColumnCells> {
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
            let numbers = numpy.call_method1("asarray", (array, "float64"))?;
            Ok(ColumnCells::Numbers(PyBuffer::<f64>::get(&numbers)?.to_vec(py)?))
        }
        ("U" | "O", 1) => {
            let texts: PyResult<Vec<String>> = array.call_method0("tolist")?.try_iter()?.map(|it| it?.str()?.extract()).collect();
            Ok(ColumnCells::Texts(texts?))
        }
        _ => Err(request(py, format!("column \"{name}\": {} is neither numbers nor texts", array.getattr("dtype")?))),
    }
}
