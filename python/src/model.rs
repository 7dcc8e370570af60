//! Models: those of the program and those that a user writes.

use crate::column::{Column, Values};
use crate::errors::{of_study, raised, request};
use crate::memory::ColumnRoom;
use crate::rows::GivenTable;
use crate::table::Table;
use crate::waiting::supervised;
use beltspace::batch::{BatchTarget, GivenColumns};
use beltspace::models::{ManyOptions, Model as BeltModel, Models, ResultColumns, Status, all, find};
use beltspace::study::{parse_model, read_model};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyString};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A model: inputs, outputs and the formulas between them.
#[pyclass(module = "beltspace", frozen)]
pub struct Model {
    pub model: Arc<BeltModel>,
    /// The text of its file; empty for a model of the program.
    text: String,
}

impl Model {
    pub fn named(py: Python<'_>, name: &str) -> PyResult<Arc<BeltModel>> {
        if let Some(model) = find(name) {
            return Ok(model);
        }
        if name.ends_with(".toml") {
            return read_model(Path::new(name)).map_err(|error| raised(py, error));
        }
        let names: Vec<&str> = all().iter().map(|model| model.name.as_str()).collect();
        Err(request(py, format!("unknown model \"{name}\"; models are: {}", names.join(", "))))
    }

    /// The model that is meant by a name, a path or a model.
    fn meant(model: &Bound<'_, PyAny>) -> PyResult<Arc<BeltModel>> {
        if let Ok(model) = model.cast::<Self>() {
            return Ok(model.get().model.clone());
        }
        match model.cast::<PyString>() {
            Ok(name) => Self::named(model.py(), &name.extract::<String>()?),
            Err(_) => {
                let path: PathBuf = model.extract()?;
                read_model(&path).map_err(|error| raised(model.py(), error))
            }
        }
    }
}

impl From<Arc<BeltModel>> for Model {
    fn from(model: Arc<BeltModel>) -> Self {
        Self { model, text: String::new() }
    }
}

#[pymethods]
impl Model {
    #[new]
    #[pyo3(signature = (name, formulas = None, /, **parts))]
    fn new(py: Python<'_>, name: &str, formulas: Option<Bound<'_, PyAny>>, parts: Option<Bound<'_, PyDict>>) -> PyResult<Self> {
        let Some(formulas) = formulas else {
            return Ok(Self { model: Self::named(py, name)?, text: String::new() });
        };
        let parts = parts.unwrap_or_else(|| PyDict::new(py));
        parts.set_item("formulas", formulas)?;
        let text: String = py.import("beltspace._toml")?.call_method1("text_of_model", (parts,))?.extract()?;
        Self::from_toml(py, &text, name, None)
    }

    /// Reads the file of a model; its name is that of the file.
    #[staticmethod]
    fn from_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let model = read_model(&path).map_err(|error| raised(py, error))?;
        Ok(Self { text: std::fs::read_to_string(&path)?, model })
    }

    /// Reads a model from the text of a file; `folder` is what paths of CSV files are relative to.
    #[staticmethod]
    #[pyo3(signature = (text, name, folder = None))]
    fn from_toml(py: Python<'_>, text: &str, name: &str, folder: Option<PathBuf>) -> PyResult<Self> {
        let folder = folder.unwrap_or_default();
        let model = parse_model(&Models::new(), name, text, name, &folder).map_err(|errors| of_study(py, &errors))?;
        Ok(Self { model, text: text.to_owned() })
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.model.name
    }

    /// What it is, in a sentence.
    #[getter]
    fn summary(&self) -> &str {
        &self.model.summary
    }

    /// What it does not say.
    #[getter]
    fn limits(&self) -> &str {
        &self.model.limits
    }

    /// The text of its file; empty for a model of the program.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    /// Its inputs by name: unit, default, valid range, the range that its source covers, words, description.
    #[getter]
    fn inputs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for input in &self.model.inputs {
            let about = PyDict::new(py);
            about.set_item("unit", input.unit.symbol)?;
            match input.word_for(input.default) {
                Some(word) => about.set_item("default", word)?,
                None => about.set_item("default", input.default)?,
            }
            about.set_item("valid", input.valid_in_words())?;
            about.set_item("usual", input.usual)?;
            about.set_item("integer", input.integer)?;
            about.set_item("words", input.words.iter().map(|(word, _)| word.as_str()).collect::<Vec<_>>())?;
            about.set_item("description", &input.doc)?;
            dict.set_item(&input.name, about)?;
        }
        Ok(dict)
    }

    /// Its outputs by name: unit and description.
    #[getter]
    fn outputs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for output in &self.model.outputs {
            let about = PyDict::new(py);
            about.set_item("unit", output.unit.symbol)?;
            about.set_item("description", &output.doc)?;
            dict.set_item(&output.name, about)?;
        }
        Ok(dict)
    }

    fn __repr__(&self) -> String {
        let model = &self.model;
        format!("<beltspace.Model {}: {} inputs, {} outputs>", model.name, model.inputs.len(), model.outputs.len())
    }
}

/// The models that come with beltspace.
#[pyfunction]
pub fn models(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    PyList::new(py, all().iter().map(|model| model.name.as_str()))
}

/// Evaluates a model for every row of a table.
#[pyfunction]
#[pyo3(signature = (model, table, *, outputs = None, threads = None))]
pub fn evaluate(
    py: Python<'_>,
    model: &Bound<'_, PyAny>,
    table: &Bound<'_, PyAny>,
    outputs: Option<Vec<String>>,
    threads: Option<usize>,
) -> PyResult<Table> {
    let model = Model::meant(model)?;
    let table = GivenTable::new(table)?;
    let wanted = outputs.map(|names| names.iter().map(|name| output(py, &model, name)).collect::<PyResult<Vec<_>>>()).transpose()?;
    let stop = AtomicBool::new(false);
    let (of_model, threads) = (model.clone(), threads.unwrap_or_else(cores));
    let numbers: Vec<usize> = wanted.unwrap_or_else(|| (0..model.outputs.len()).collect());
    let work = || {
        let mut target = BatchTarget::of_model(of_model.clone(), of_model.defaults(), Vec::new());
        let given = GivenColumns::new(&mut target, table.columns(), threads)?;
        let options = ManyOptions::default().threads(threads).stop(&stop).outputs(&numbers);
        let mut statuses = vec![0_u16; given.rows()];
        let mut rooms: Vec<ColumnRoom> = numbers.iter().map(|_| ColumnRoom::new(given.rows())).collect();
        let outputs = rooms.iter_mut().map(ColumnRoom::numbers).collect();
        target.evaluate_each(&given, &options, ResultColumns { statuses: &mut statuses, outputs })?;
        Ok((statuses, rooms))
    };
    let (statuses, rooms) = supervised(py, || stop.store(true, Ordering::Relaxed), |_| Ok(()), work)?.map_err(|error| raised(py, error))?;
    let column = |(&number, room): (&usize, ColumnRoom)| {
        let output = &model.outputs[number];
        let (unit, role) = (output.unit.symbol.to_owned(), "output".to_owned());
        Column::of(output.name.clone(), Values::Numbers(room.into_buffer())).described(unit, role, String::new(), output.doc.clone())
    };
    let mut columns: Vec<Column> = numbers.iter().zip(rooms).map(column).collect();
    columns.push(status_column(&model, statuses));
    Table::of(py, columns)
}

/// The number of an output, or which one may be meant.
fn output(py: Python<'_>, model: &BeltModel, name: &str) -> PyResult<usize> {
    model.output(name).ok_or_else(|| {
        let names: Vec<&str> = model.outputs.iter().map(|it| it.name.as_str()).collect();
        request(py, format!("{} has no output \"{name}\"; outputs are: {}", model.name, names.join(", ")))
    })
}

/// The column of statuses, from their numbers.
fn status_column(model: &BeltModel, statuses: Vec<u16>) -> Column {
    let conditions = (0..model.conditions.len()).map(Status::failed);
    let words = [Status::Ok, Status::Overflow].into_iter().chain(conditions).map(|it| it.reason(model).to_owned()).collect();
    let values = Values::Words(statuses, words);
    Column::of("status".to_owned(), values).described(
        String::new(),
        "status".to_owned(),
        String::new(),
        "Is it ok, and if not, why?".to_owned(),
    )
}

/// Threads if nobody says how many.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}
