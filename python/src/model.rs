//! Models: those of the program and those that a user writes.

use crate::column::{Column, Values};
use crate::errors::{of_study, raised, request};
use crate::memory::ColumnRoom;
use crate::rows::GivenTable;
use crate::table::Table;
use crate::threads;
use crate::waiting::supervised;
use beltspace::batch::{BatchTarget, GivenColumns};
use beltspace::models::{ManyOptions, Model as BeltModel, Models, ResultColumns, Status, all, find};
use beltspace::study::{parse_model, read_model};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyString, PyTuple};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A model: inputs, outputs and the formulas between them.
///
/// `Model("metal-cvt")` is one that comes with beltspace, `Model("my-drive.toml")` that of a file, and `Model(name, formulas, ...)` one of
/// formulas; the parts are those of a model's file (docs/models-in-a-file.md).
///
/// name: of the model, or the path of its file; a text without formulas is a path where it ends in ".toml".
/// formulas: texts by the name of what they give, which ends in its unit.
/// inputs: by name, which ends in the unit: `default`, `valid`, `doc` and what else a model's file says of an input.
/// outputs: names of the formulas that are outputs, None for all.
///
/// The other parts are `conditions`, `curves`, `presets`, `base`, `units`, `summary`, `source` and `limits`.
///
/// RequestError if parts are given without formulas or a base; StudyError tells all mistakes with line and column in the text that is made
/// of the parts; OSError if the file cannot be read.
#[pyclass(module = "beltspace", frozen)]
pub struct Model {
    pub model: Arc<BeltModel>,
    /// The text of its file; empty for a model of the program, and for that of a study.
    text: String,
    /// What paths in the text are relative to.
    folder: PathBuf,
}

impl Model {
    /// The model that is meant by a name or by the path of its file.
    fn read(name: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = name.py();
        if let Ok(text) = name.cast::<PyString>() {
            let name = text.extract::<String>()?;
            if let Some(model) = find(&name) {
                return Ok(model.into());
            }
            if !name.ends_with(".toml") {
                let names: Vec<&str> = all().iter().map(|model| model.name.as_str()).collect();
                return Err(request(py, format!("unknown model \"{name}\"; models are: {}", names.join(", "))));
            }
        }
        Self::from_file(py, name.extract()?)
    }

    /// The model that is meant by a name, a path or a model.
    fn meant(model: &Bound<'_, PyAny>) -> PyResult<Arc<BeltModel>> {
        match model.cast::<Self>() {
            Ok(model) => Ok(model.get().model.clone()),
            Err(_) => Ok(Self::read(model)?.model),
        }
    }
}

impl From<Arc<BeltModel>> for Model {
    fn from(model: Arc<BeltModel>) -> Self {
        Self { model, text: String::new(), folder: PathBuf::new() }
    }
}

#[pymethods]
impl Model {
    #[new]
    #[pyo3(signature = (name, /, formulas = None, **parts))]
    fn new(
        py: Python<'_>,
        name: &Bound<'_, PyAny>,
        formulas: Option<Bound<'_, PyAny>>,
        parts: Option<Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let given = PyDict::new(py);
        for (part, content) in parts.iter().flatten().chain(formulas.map(|it| (PyString::new(py, "formulas").into_any(), it))) {
            if !content.is_none() {
                given.set_item(part, content)?;
            }
        }
        // What is based on another model needs no formulas.
        if !given.contains("formulas")? && !given.contains("base")? {
            if given.is_empty() {
                return Self::read(name);
            }
            let parts: Vec<String> = given.keys().extract()?;
            let parts = parts.join(", ");
            let told = format!("Model({}) reads a model, which {parts} cannot change; give formulas, or base, to write one", name.repr()?);
            return Err(request(py, told));
        }
        let text: String = py.import("beltspace._toml")?.call_method1("text_of_model", (given,))?.extract()?;
        Self::from_toml(py, &text, &name.extract::<String>()?, None)
    }

    /// Reads the file of a model; its name is that of the file. StudyError tells all mistakes; OSError if it cannot be read.
    #[staticmethod]
    fn from_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let model = read_model(&path).map_err(|error| raised(py, error))?;
        let folder = path.parent().map(PathBuf::from).unwrap_or_default();
        Ok(Self { text: std::fs::read_to_string(&path)?, model, folder })
    }

    /// Reads a model from the text of a file, under that name; `folder` is what paths of CSV files are relative to, by default the current
    /// one. StudyError tells all mistakes.
    #[staticmethod]
    #[pyo3(signature = (text, name, folder = None))]
    fn from_toml(py: Python<'_>, text: &str, name: &str, folder: Option<PathBuf>) -> PyResult<Self> {
        let folder = folder.unwrap_or_default();
        let model = parse_model(&Models::new(), name, text, name, &folder).map_err(|errors| of_study(py, &errors))?;
        Ok(Self { model, text: text.to_owned(), folder })
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

    /// What the model does not say.
    #[getter]
    fn limits(&self) -> &str {
        &self.model.limits
    }

    /// The text of its file; empty for a model of the program, and for that of a study.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    /// By name: `unit`, `default`, `valid` (in words), `usual` (the range that its source covers), `integer`, `words`, `description`.
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

    /// By name: `unit`, `description`.
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

    /// For `pickle`: how it is made again. RequestError for a model of one's own that was taken from a study, whose text is not known.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let class = py.get_type::<Self>();
        let name = &self.model.name;
        if !self.text.is_empty() {
            let folder = std::path::absolute(self.folder.join("."))?;
            return Ok((class.getattr("from_toml")?, (&self.text, name, folder).into_pyobject(py)?));
        }
        if find(name).is_some() {
            return Ok((class.into_any(), (name,).into_pyobject(py)?));
        }
        Err(request(
            py,
            format!(
                "the model {name} was taken from a study, so that its text is not known; pickle the study, or the Model that it was given"
            ),
        ))
    }

    fn __repr__(&self) -> String {
        let model = &self.model;
        format!("<beltspace.Model {}: {} inputs, {} outputs>", model.name, model.inputs.len(), model.outputs.len())
    }
}

/// Names of the models that come with beltspace.
#[pyfunction]
pub fn models(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    PyList::new(py, all().iter().map(|model| model.name.as_str()))
}

/// Evaluates a model in f64 for every row of a table.
///
/// model: a `Model`, the name of one that comes with beltspace, or the path of a model's file.
/// table: columns named like inputs, in the units that the names end in: a dictionary of arrays, or a table of pandas, polars, pyarrow or
///     DuckDB. A single value stands for every row, and inputs without a column have their defaults. Texts such as "limit" or "0.25 in" are
///     read as in a study.
/// outputs: names of the outputs that are wanted, None for all; fewer take less time.
/// threads: 1 to 4096, None for one on each core.
///
/// Returns a table with a column for each output, in the unit that its name ends in, and `status`: "ok", "overflow", or the first condition
/// of the model that the row does not meet. A number that a failed condition invalidates is NaN (null in Arrow).
///
/// RequestError, with row and column, if a cell is empty (null, NaN, masked) or beyond the input's valid range, and if a name or the number
/// of threads is wrong. The interpreter lock is released meanwhile; Ctrl-C ends the work and raises KeyboardInterrupt.
#[pyfunction]
#[pyo3(signature = (model, table, *, outputs = None, threads = None))]
pub fn evaluate(
    py: Python<'_>,
    model: &Bound<'_, PyAny>,
    table: &Bound<'_, PyAny>,
    outputs: Option<Vec<String>>,
    threads: Option<Bound<'_, PyAny>>,
) -> PyResult<Table> {
    let model = Model::meant(model)?;
    let table = GivenTable::new(table)?;
    let wanted = outputs.map(|names| names.iter().map(|name| output(py, &model, name)).collect::<PyResult<Vec<_>>>()).transpose()?;
    let stop = AtomicBool::new(false);
    let (of_model, threads) = (model.clone(), threads::threads(threads.as_ref())?);
    let numbers: Vec<usize> = wanted.unwrap_or_else(|| (0..model.outputs.len()).collect());
    let work = || {
        let mut target = BatchTarget::of_model(of_model.clone(), of_model.defaults(), Vec::new()).without_options();
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
