//! A column of a table: its numbers stand in memory once, for numpy and for Arrow.

use arrow_array::{ArrayRef, Float64Array, StringArray, UInt64Array};
use arrow_buffer::{NullBuffer, ScalarBuffer};
use arrow_schema::{DataType, Field};
use beltspace::{Data, TableColumn};
use pyo3::exceptions::PyBufferError;
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::types::{PyList, PyString};
use std::collections::HashMap;
use std::ffi::{CStr, c_int, c_void};
use std::ops::Range;
use std::sync::Arc;

/// Values of a column.
pub enum Values {
    /// Numbers; NaN where there is none.
    Numbers(ScalarBuffer<f64>),
    /// Indices and counts, and which are there if not all are.
    Whole(ScalarBuffer<u64>, Option<NullBuffer>),
    /// Texts.
    Texts(Vec<String>),
    /// Texts of which there are few: number of each row's.
    Words(Vec<u16>, Vec<String>),
}

impl Values {
    pub fn rows(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Whole(values, _) => values.len(),
            Self::Texts(values) => values.len(),
            Self::Words(values, _) => values.len(),
        }
    }

    /// The text of a row, if these are texts.
    fn text(&self, row: usize) -> Option<&str> {
        match self {
            Self::Texts(values) => values.get(row).map(String::as_str),
            Self::Words(codes, words) => words.get(usize::from(*codes.get(row)?)).map(String::as_str),
            Self::Numbers(_) | Self::Whole(..) => None,
        }
    }
}

/// A column of a table. `numpy.asarray(column)` is a view of its memory.
#[pyclass(module = "beltspace", frozen)]
pub struct Column {
    /// Its name, which ends in its unit, such as `axial_force_N`.
    #[pyo3(get)]
    name: String,
    /// Its unit, such as `N`; empty for plain numbers and texts.
    #[pyo3(get)]
    unit: String,
    /// `design`, `objective`, `constraint`, `report`, `label`, `index`, `output`, ...; several with commas between them.
    #[pyo3(get)]
    role: String,
    /// `min` or `max` for an objective, the bounds in words for a constraint, else empty.
    #[pyo3(get)]
    direction: String,
    /// What it is, in a sentence.
    #[pyo3(get)]
    description: String,
    values: Values,
    /// Length and step in bytes, where a buffer's view finds them.
    shape: Box<[isize; 2]>,
}

impl Column {
    /// From a table of the library.
    pub fn new(column: TableColumn) -> Self {
        let TableColumn { name, unit, role, direction, description, data } = column;
        let values = match data {
            Data::Number(values) => Values::Numbers(values.into_iter().map(|it| it.unwrap_or(f64::NAN)).collect()),
            Data::Whole(values) => {
                let nulls = values.iter().any(Option::is_none).then(|| values.iter().map(Option::is_some).collect());
                Values::Whole(values.into_iter().map(Option::unwrap_or_default).collect(), nulls)
            }
            Data::Text(values) => Values::Texts(values),
        };
        Self::of(name, values).described(unit, role, direction, description)
    }

    /// A column that has nothing but values.
    pub fn of(name: String, values: Values) -> Self {
        let shape = Box::new([values.rows() as isize, 8]);
        let [unit, role, direction, description] = [const { String::new() }; 4];
        Self { name, unit, role, direction, description, values, shape }
    }

    /// The same with its description.
    pub fn described(self, unit: String, role: String, direction: String, description: String) -> Self {
        Self { unit, role, direction, description, ..self }
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    pub fn rows(&self) -> usize {
        self.values.rows()
    }

    /// Its Arrow field, with unit, role, direction and description as metadata.
    pub fn field(&self) -> Field {
        let (kind, nullable) = match &self.values {
            Values::Numbers(_) => (DataType::Float64, true),
            Values::Whole(..) => (DataType::UInt64, true),
            Values::Texts(_) | Values::Words(..) => (DataType::Utf8, false),
        };
        let about = [("unit", &self.unit), ("role", &self.role), ("direction", &self.direction), ("description", &self.description)];
        let about = about.into_iter().filter(|(_, text)| !text.is_empty());
        let metadata: HashMap<String, String> = about.map(|(what, text)| (what.to_owned(), text.clone())).collect();
        Field::new(&self.name, kind, nullable).with_metadata(metadata)
    }

    /// As Arrow has it: numbers and indices are shared, and absent where they are NaN.
    pub fn array(&self) -> ArrayRef {
        match &self.values {
            Values::Numbers(values) => {
                let absent = values.iter().any(|it| it.is_nan());
                let nulls = absent.then(|| values.iter().map(|it| !it.is_nan()).collect());
                Arc::new(Float64Array::new(values.clone(), nulls))
            }
            Values::Whole(values, nulls) => Arc::new(UInt64Array::new(values.clone(), nulls.clone())),
            texts => Arc::new(StringArray::from_iter_values((0..texts.rows()).map(|row| texts.text(row).unwrap_or_default()))),
        }
    }

    /// A cell for people: numbers in a few digits.
    pub fn cell(&self, row: usize) -> String {
        match &self.values {
            Values::Numbers(values) if values[row].is_nan() => String::new(),
            Values::Numbers(values) => beltspace::table::short(values[row]),
            Values::Whole(_, Some(nulls)) if nulls.is_null(row) => String::new(),
            Values::Whole(values, _) => values[row].to_string(),
            texts => texts.text(row).unwrap_or_default().to_owned(),
        }
    }

    /// A cell as a Python value; None if it is absent.
    pub fn value<'py>(&self, py: Python<'py>, row: usize) -> PyResult<Bound<'py, PyAny>> {
        Ok(match &self.values {
            Values::Numbers(values) => Some(values[row]).filter(|it| !it.is_nan()).into_pyobject(py)?,
            Values::Whole(_, Some(nulls)) if nulls.is_null(row) => py.None().into_bound(py),
            Values::Whole(values, _) => values[row].into_pyobject(py)?.into_any(),
            texts => texts.text(row).into_pyobject(py)?,
        })
    }

    /// Some of its rows, as the library has them.
    pub fn table_column(&self, rows: Range<usize>) -> TableColumn {
        let data = match &self.values {
            Values::Numbers(values) => Data::Number(values[rows].iter().map(|it| (!it.is_nan()).then_some(*it)).collect()),
            Values::Whole(values, nulls) => {
                let present = |row: usize| nulls.as_ref().is_none_or(|nulls| nulls.is_valid(row));
                Data::Whole(rows.map(|row| present(row).then_some(values[row])).collect())
            }
            texts => Data::Text(rows.map(|row| texts.text(row).unwrap_or_default().to_owned()).collect()),
        };
        TableColumn {
            unit: self.unit.clone(),
            direction: self.direction.clone(),
            ..TableColumn::new(&self.name, &self.role, &self.description, data)
        }
    }

    fn address(&self) -> Option<(*const c_void, &'static CStr)> {
        match &self.values {
            Values::Numbers(values) => Some((values.as_ptr().cast(), c"d")),
            Values::Whole(values, None) => Some((values.as_ptr().cast(), c"Q")),
            _ => None,
        }
    }
}

#[pymethods]
impl Column {
    fn __len__(&self) -> usize {
        self.rows()
    }

    fn __repr__(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(", unit {}", self.unit) };
        format!("<beltspace.Column {}: {} rows{unit}>", self.name, self.rows())
    }

    /// The values as an array: a read-only view of numbers and indices; a copy of texts, and of indices of which some are absent (then
    /// NaN).
    fn to_numpy<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let numpy = py.import("numpy")?;
        match &slf.get().values {
            Values::Whole(values, Some(nulls)) => {
                let value = |(row, &value): (usize, &u64)| if nulls.is_null(row) { f64::NAN } else { value as f64 };
                let values: Vec<f64> = values.iter().enumerate().map(value).collect();
                numpy.call_method1("asarray", (Self::of(String::new(), Values::Numbers(values.into())),))
            }
            Values::Numbers(_) | Values::Whole(_, None) => numpy.call_method1("asarray", (slf,)),
            _ => numpy.call_method1("array", (Self::to_list(slf)?, "O")),
        }
    }

    /// The values as a list; None where there is none.
    fn to_list<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyList>> {
        let py = slf.py();
        match &slf.get().values {
            Values::Numbers(values) => PyList::new(py, values.iter().map(|it| (!it.is_nan()).then_some(*it))),
            Values::Whole(values, nulls) => {
                let present = |row: usize| nulls.as_ref().is_none_or(|nulls| nulls.is_valid(row));
                PyList::new(py, values.iter().enumerate().map(|(row, it)| present(row).then_some(*it)))
            }
            Values::Texts(values) => PyList::new(py, values),
            Values::Words(codes, words) => {
                let words: Vec<Bound<'py, PyString>> = words.iter().map(|it| PyString::new(py, it)).collect();
                PyList::new(py, codes.iter().map(|code| &words[usize::from(*code)]))
            }
        }
    }

    /// Gives numpy and others the column's memory, to be read.
    ///
    /// # Safety
    /// The interpreter calls it with a view to fill.
    unsafe fn __getbuffer__(slf: Bound<'_, Self>, view: *mut ffi::Py_buffer, flags: c_int) -> PyResult<()> {
        let column = slf.get();
        let Some((address, format)) = column.address() else {
            return Err(PyBufferError::new_err(format!("the column {} is no plain numbers; use to_numpy() or to_list()", column.name)));
        };
        if flags & ffi::PyBUF_WRITABLE == ffi::PyBUF_WRITABLE {
            return Err(PyBufferError::new_err("the column is read-only; copy it first"));
        }
        let shape = column.shape.as_ptr().cast_mut();
        let asks = |flag: c_int| flags & flag == flag;
        // SAFETY: the interpreter owns the view. It holds the column, which is frozen and outlives it, and with that its memory and shape.
        unsafe {
            (*view).buf = address.cast_mut();
            (*view).len = column.shape[0] * 8;
            (*view).readonly = 1;
            (*view).itemsize = 8;
            (*view).format = if asks(ffi::PyBUF_FORMAT) { format.as_ptr().cast_mut() } else { std::ptr::null_mut() };
            (*view).ndim = 1;
            (*view).shape = if asks(ffi::PyBUF_ND) { shape } else { std::ptr::null_mut() };
            (*view).strides = if asks(ffi::PyBUF_STRIDES) { shape.add(1) } else { std::ptr::null_mut() };
            (*view).suboffsets = std::ptr::null_mut();
            (*view).internal = std::ptr::null_mut();
            (*view).obj = slf.into_any().into_ptr();
        }
        Ok(())
    }
}
