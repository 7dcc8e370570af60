//! How many threads work.

use crate::errors::request;
use pyo3::exceptions::PyOverflowError;
use pyo3::prelude::*;

/// Most threads, as on the command line.
const MOST: i64 = 4096;

/// The number that is given, or one for each core.
pub fn threads(given: Option<&Bound<'_, PyAny>>) -> PyResult<usize> {
    let Some(given) = given else {
        return Ok(std::thread::available_parallelism().map_or(1, std::num::NonZero::get));
    };
    let number = match given.extract::<i64>() {
        Err(error) if !error.is_instance_of::<PyOverflowError>(given.py()) => return Err(error),
        number => number.ok(),
    };
    number.filter(|it| (1..=MOST).contains(it)).and_then(|it| usize::try_from(it).ok()).ok_or_else(|| {
        request(given.py(), format!("threads = {given}: write a whole number from 1 to {MOST}, or None for one on each core"))
    })
}
