//! The Python module `beltspace._beltspace`: what `beltspace/` shows to users, with the types that `_beltspace.pyi` declares.

mod arrow_in;
mod arrow_out;
mod column;
mod errors;
mod json;
mod memory;
mod model;
mod result;
mod rows;
mod stream;
mod study;
mod table;
mod threads;
mod waiting;

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs the command line with these words, the path of the command first; returns the exit code.
#[pyfunction]
fn run_program(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| beltspace::program::main_with(words))
}

/// The module.
#[pymodule]
fn _beltspace(module: &Bound<'_, PyModule>) -> PyResult<()> {
    waiting::note_main_thread(module.py())?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<column::Column>()?;
    module.add_class::<model::Model>()?;
    module.add_class::<result::SweepResult>()?;
    module.add_class::<stream::RowStream>()?;
    module.add_class::<stream::TableBatches>()?;
    module.add_class::<study::Study>()?;
    module.add_class::<table::Table>()?;
    module.add_function(wrap_pyfunction!(model::evaluate, module)?)?;
    module.add_function(wrap_pyfunction!(model::models, module)?)?;
    module.add_function(wrap_pyfunction!(run_program, module)?)
}
