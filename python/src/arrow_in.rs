//! Tables of others by the Arrow PyCapsule interface.

use crate::errors::request;
use crate::rows::{empty_cell, no_table};
use arrow_array::cast::AsArray;
use arrow_array::ffi::{FFI_ArrowArray, from_ffi};
use arrow_array::ffi_stream::{FFI_ArrowArrayStream, RecordBatchStreamReader};
use arrow_array::types::{
    ArrowPrimitiveType, Decimal32Type, Decimal64Type, Decimal128Type, Decimal256Type, DecimalType, Float16Type, Float32Type, Float64Type,
    Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, RecordBatch, StructArray};
use arrow_schema::ffi::FFI_ArrowSchema;
use arrow_schema::{ArrowError, DataType, Schema};
use beltspace::batch::ColumnCells;
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use std::ffi::CStr;

/// What pandas calls the column of an index that has no name.
const INDEX: &str = "__index_level_";

fn failed(py: Python<'_>, error: &ArrowError) -> PyErr {
    request(py, format!("the table cannot be read as Arrow: {error}"))
}

/// What a capsule of that name holds, taken out of it: what is left is marked as released.
///
/// # Safety
/// A capsule of that name must hold a `T` that may be moved out once `empty` is put in its place, as the Arrow interface says of its names.
unsafe fn taken<T>(capsule: &Bound<'_, PyCapsule>, name: &'static CStr, empty: T) -> PyResult<T> {
    let place = capsule.pointer_checked(Some(name))?.cast::<T>();
    // SAFETY: the caller's.
    Ok(unsafe { place.replace(empty) })
}

/// The columns of an object that speaks Arrow; `None` if it does not.
pub fn columns(table: &Bound<'_, PyAny>) -> PyResult<Option<Vec<(String, ColumnCells<'static>)>>> {
    let py = table.py();
    if table.hasattr("__arrow_c_stream__")? {
        let capsule = table.call_method0("__arrow_c_stream__")?.cast_into::<PyCapsule>()?;
        // SAFETY: the interface says that a capsule of this name holds such a stream, which the consumer moves out.
        let stream = unsafe { taken(&capsule, c"arrow_array_stream", FFI_ArrowArrayStream::empty())? };
        // Only what has columns has a schema: a stream of an array, such as a Series, has none.
        let mut reader = RecordBatchStreamReader::try_new(stream).map_err(|_| no_table(table))?;
        let schema = arrow_array::RecordBatchReader::schema(&reader);
        let mut columns = empty_columns(&schema)?;
        let mut first_row = 0;
        for batch in &mut reader {
            let batch = batch.map_err(|error| failed(py, &error))?;
            append(py, &mut columns, &batch, first_row)?;
            first_row += batch.num_rows();
        }
        columns.retain(|(name, _)| !name.starts_with(INDEX));
        return Ok(Some(columns));
    }
    if table.hasattr("__arrow_c_array__")? {
        let (schema, array): (Bound<'_, PyCapsule>, Bound<'_, PyCapsule>) = table.call_method0("__arrow_c_array__")?.extract()?;
        // SAFETY: as above, of the two capsules of an array.
        let (schema, array) = unsafe {
            (taken(&schema, c"arrow_schema", FFI_ArrowSchema::empty())?, taken(&array, c"arrow_array", FFI_ArrowArray::empty())?)
        };
        // SAFETY: both come from one producer, who promises that they belong together.
        let data = unsafe { from_ffi(array, &schema) }.map_err(|error| failed(py, &error))?;
        if !matches!(data.data_type(), DataType::Struct(_)) {
            return Err(no_table(table));
        }
        let batch = RecordBatch::from(StructArray::from(data));
        let mut columns = empty_columns(&batch.schema())?;
        append(py, &mut columns, &batch, 0)?;
        return Ok(Some(columns));
    }
    Ok(None)
}

fn is_text(kind: &DataType) -> bool {
    match kind {
        DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View => true,
        DataType::Dictionary(_, values) => is_text(values),
        _ => false,
    }
}

fn empty_columns(schema: &Schema) -> PyResult<Vec<(String, ColumnCells<'static>)>> {
    let cells = |kind: &DataType| if is_text(kind) { ColumnCells::Texts(Vec::new()) } else { ColumnCells::Numbers(Vec::new().into()) };
    Ok(schema.fields().iter().map(|field| (field.name().clone(), cells(field.data_type()))).collect())
}

fn append(py: Python<'_>, columns: &mut [(String, ColumnCells<'static>)], batch: &RecordBatch, first_row: usize) -> PyResult<()> {
    for ((name, cells), array) in columns.iter_mut().zip(batch.columns()).filter(|((name, _), _)| !name.starts_with(INDEX)) {
        // A dictionary of no words has no rows.
        if array.is_empty() {
            continue;
        }
        // NaN stands for absent too, and is refused with its place where an input is wanted.
        if array.logical_null_count() > 0 {
            let row = (0..array.len()).find(|&row| array.logical_nulls().is_some_and(|nulls| nulls.is_null(row))).unwrap_or(0);
            return Err(empty_cell(py, first_row + row, name));
        }
        match cells {
            ColumnCells::Texts(texts) => texts.extend(texts_of(array)),
            ColumnCells::Numbers(numbers) => {
                let found = numbers_of(array)
                    .ok_or_else(|| request(py, format!("column \"{name}\": {} is neither a number nor a text", array.data_type())))?;
                numbers.to_mut().extend(found);
            }
            ColumnCells::Same(_) => {}
        }
    }
    Ok(())
}

fn texts_of(array: &dyn Array) -> Vec<String> {
    let owned = |text: Option<&str>| text.unwrap_or_default().to_owned();
    match array.data_type() {
        DataType::Utf8 => array.as_string::<i32>().iter().map(owned).collect(),
        DataType::LargeUtf8 => array.as_string::<i64>().iter().map(owned).collect(),
        DataType::Utf8View => array.as_string_view().iter().map(owned).collect(),
        _ => {
            let dictionary = array.as_any_dictionary();
            let words = texts_of(dictionary.values());
            dictionary.normalized_keys().into_iter().map(|key| words[key].clone()).collect()
        }
    }
}

#[allow(clippy::cast_precision_loss, reason = "an integer that is no f64 is rounded, as in a study")]
fn numbers_of(array: &dyn Array) -> Option<Vec<f64>> {
    fn of<T: ArrowPrimitiveType>(array: &dyn Array, number: impl Fn(T::Native) -> f64) -> Vec<f64> {
        array.as_primitive::<T>().values().iter().map(|&value| number(value)).collect()
    }
    // By way of its digits, which gives the nearest number.
    fn of_decimals<T: DecimalType + ArrowPrimitiveType>(array: &dyn Array) -> Option<Vec<f64>> {
        let array = array.as_primitive::<T>();
        (0..array.len()).map(|row| array.value_as_string(row).parse().ok()).collect()
    }
    Some(match array.data_type() {
        DataType::Float64 => array.as_primitive::<Float64Type>().values().to_vec(),
        DataType::Float32 => of::<Float32Type>(array, f64::from),
        DataType::Int8 => of::<Int8Type>(array, f64::from),
        DataType::Int16 => of::<Int16Type>(array, f64::from),
        DataType::Int32 => of::<Int32Type>(array, f64::from),
        DataType::Int64 => of::<Int64Type>(array, |it| it as f64),
        DataType::UInt8 => of::<UInt8Type>(array, f64::from),
        DataType::UInt16 => of::<UInt16Type>(array, f64::from),
        DataType::UInt32 => of::<UInt32Type>(array, f64::from),
        DataType::UInt64 => of::<UInt64Type>(array, |it| it as f64),
        DataType::Float16 => of::<Float16Type>(array, |it| it.to_f64()),
        DataType::Boolean => array.as_boolean().values().iter().map(|it| f64::from(u8::from(it))).collect(),
        DataType::Decimal32(..) => of_decimals::<Decimal32Type>(array)?,
        DataType::Decimal64(..) => of_decimals::<Decimal64Type>(array)?,
        DataType::Decimal128(..) => of_decimals::<Decimal128Type>(array)?,
        DataType::Decimal256(..) => of_decimals::<Decimal256Type>(array)?,
        DataType::Dictionary(..) => {
            let dictionary = array.as_any_dictionary();
            let words = numbers_of(dictionary.values())?;
            dictionary.normalized_keys().into_iter().map(|key| words.get(key).copied()).collect::<Option<_>>()?
        }
        _ => return None,
    })
}
