//! Studies.

use crate::errors::{raised, request};
use crate::model::Model;
use crate::result::SweepResult;
use crate::rows::GivenTable;
use crate::table::Table;
use crate::threads::threads;
use crate::waiting::{left_alone, stage, supervised};
use beltspace::batch::{BatchTarget, GivenColumns};
use beltspace::models::Models;
use beltspace::plan::Plan;
use beltspace::{Control, Engine, Judging, Options, Study as BeltStudy};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping, PyTuple};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// A study: what is chosen, what must be survived, what nobody knows exactly, and what is asked.
#[pyclass(module = "beltspace", frozen)]
pub struct Study {
    study: BeltStudy,
    designs: u64,
    scenarios: u64,
    text: String,
    source: Source,
}

/// Where a study comes from.
#[derive(Clone)]
struct Source {
    /// What messages call it.
    file: String,
    /// What paths of other files are relative to.
    folder: PathBuf,
    models: Models,
    /// The models of one's own.
    own: Arc<Vec<Py<Model>>>,
}

impl Study {
    fn parsed(py: Python<'_>, text: &str, source: Source, set: &[String]) -> PyResult<Self> {
        let Source { file, folder, models, .. } = &source;
        let (study, text) = BeltStudy::parse_set(models, text, file, folder, set).map_err(|error| raised(py, error))?;
        let plan = Plan::new(study.clone());
        Ok(Self { study, designs: plan.designs(), scenarios: plan.scenarios(), text, source })
    }
}

impl Source {
    /// With the models of one's own that the study may name.
    fn new(py: Python<'_>, file: String, folder: PathBuf, own: Option<Vec<Py<Model>>>) -> PyResult<Self> {
        let own = Arc::new(own.unwrap_or_default());
        let models = own.iter().try_fold(Models::new(), |known, model| known.with(model.get().model.clone()));
        Ok(Self { file, folder, models: models.map_err(|error| raised(py, error))?, own })
    }
}

/// One of a few words.
fn word<T: Copy>(py: Python<'_>, what: &str, given: &str, words: &[(&str, T)]) -> PyResult<T> {
    words.iter().find(|(word, _)| *word == given).map(|&(_, it)| it).ok_or_else(|| {
        let words: Vec<_> = words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
        request(py, format!("{what}: unknown word \"{given}\"; write {}", words.join(" or ")))
    })
}

/// A layer of Mesa's Vulkan drivers looks for a display and complains on standard error if there is none. It chooses among graphics cards,
/// which beltspace does itself, so it is switched off, as the program does. Python changes the environment: it alone may do so while there
/// are threads.
fn keep_the_loader_quiet(py: Python<'_>) -> PyResult<()> {
    if cfg!(target_os = "linux") {
        let environment = py.import("os")?.getattr("environ")?;
        if !environment.contains("XDG_RUNTIME_DIR")? && !environment.contains("NODEVICE_SELECT")? {
            environment.set_item("NODEVICE_SELECT", "1")?;
        }
    }
    Ok(())
}

#[pymethods]
impl Study {
    /// Reads a study file.
    ///
    /// path: of the file; paths in it are relative to its folder.
    /// models: models of one's own that it may name.
    ///
    /// StudyError tells all mistakes with line and column; OSError if the file cannot be read.
    #[staticmethod]
    #[pyo3(signature = (path, *, models = None))]
    fn from_file(py: Python<'_>, path: PathBuf, models: Option<Vec<Py<Model>>>) -> PyResult<Self> {
        // What cannot be read is told as of any study.
        let text = match std::fs::read(&path).map(String::from_utf8) {
            Ok(Ok(text)) => text,
            _ => return BeltStudy::read(&path).map_err(|error| raised(py, error)).map(|_| unreachable!("it could not be read")),
        };
        let folder = path.parent().map(PathBuf::from).unwrap_or_default();
        let source = Source::new(py, path.display().to_string(), folder, models)?;
        Self::parsed(py, &text, source, &[])
    }

    /// Reads a study from the text of a file.
    ///
    /// folder: what paths of other files are relative to, by default the current one.
    /// models: models of one's own that it may name.
    ///
    /// StudyError tells all mistakes with line and column; RequestError if it is the name of a file.
    #[staticmethod]
    #[pyo3(signature = (text, *, folder = None, models = None))]
    fn from_toml(py: Python<'_>, text: &str, folder: Option<PathBuf>, models: Option<Vec<Py<Model>>>) -> PyResult<Self> {
        if !text.contains(['\n', '=']) && text.trim_end().ends_with(".toml") {
            let name = text.trim_end();
            return Err(request(
                py,
                format!("from_toml takes the text of a study, and \"{name}\" is the name of a file; use Study.from_file"),
            ));
        }
        let folder = folder.unwrap_or_else(|| PathBuf::from("."));
        let source = Source::new(py, "study".to_owned(), folder, models)?;
        Self::parsed(py, text, source, &[])
    }

    /// Reads a study from a dictionary with the tables and keys of a study file.
    ///
    /// study: the order of its keys is that of the axes; its model may be a `Model`.
    /// folder: what paths of other files are relative to, by default the current one.
    /// models: models of one's own that it may name.
    ///
    /// StudyError tells all mistakes, with line and column in the text that is made of the dictionary; TypeError if a value has no form in
    /// a study.
    #[staticmethod]
    #[pyo3(signature = (study, *, folder = None, models = None))]
    fn from_dict(py: Python<'_>, study: &Bound<'_, PyMapping>, folder: Option<PathBuf>, models: Option<Vec<Py<Model>>>) -> PyResult<Self> {
        let mut models = models.unwrap_or_default();
        let study = py.import("builtins")?.getattr("dict")?.call1((study,))?.cast_into::<PyDict>()?;
        if let Some(model) = study.get_item("model")?
            && let Ok(model) = model.cast::<Model>()
        {
            let name = &model.get().model.name;
            study.set_item("model", name)?;
            if beltspace::models::find(name).is_none() {
                models.push(model.clone().unbind());
            }
        }
        let text: String = py.import("beltspace._toml")?.call_method1("text_of_study", (study,))?.extract()?;
        Self::from_toml(py, &text, folder, Some(models))
    }

    /// The same study with values in place of what gives some inputs: an axis, a fixed value or a formula.
    ///
    /// values: numbers in the unit that the input's name ends in, or texts as in a study file, such as "25 mm".
    ///
    /// RequestError if there is no such input or its value is wrong.
    #[pyo3(signature = (**values))]
    fn with_values(&self, py: Python<'_>, values: Option<Bound<'_, PyDict>>) -> PyResult<Self> {
        let mut set = Vec::new();
        for (name, value) in values.iter().flatten() {
            set.push(format!("{name}={}", value.str()?));
        }
        Self::parsed(py, &self.text, self.source.clone(), &set)
    }

    /// Its title.
    #[getter]
    fn title(&self) -> &str {
        &self.study.title
    }

    /// The text of its file.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    /// The hash of its content, as in the files of a result.
    #[getter]
    fn hash(&self) -> String {
        self.study.hash()
    }

    /// Its model.
    #[getter]
    fn model(&self, py: Python<'_>) -> PyResult<Py<Model>> {
        Py::new(py, Model::from(self.study.model.clone()))
    }

    /// How many designs it has.
    #[getter]
    fn designs(&self) -> u64 {
        self.designs
    }

    /// In how many scenarios each is judged.
    #[getter]
    fn scenarios(&self) -> u64 {
        self.scenarios
    }

    /// Names of the inputs that are chosen, in the order of the study.
    #[getter]
    fn design(&self) -> Vec<&str> {
        let inputs = self.study.design.iter().flat_map(|axis| axis.inputs());
        inputs.map(|&input| self.study.model.inputs[input].name.as_str()).collect()
    }

    /// What `beltspace check` tells, without running the study.
    ///
    /// threads: 1 to 4096, None for one on each core.
    ///
    /// Returns a dictionary: `designs`, `scenarios`, `evaluations`, `seconds` (about how long a sweep takes that judges each design),
    /// `method`, `memory_MB`, `front` (about how many designs) and `warnings`, a list of sentences.
    ///
    /// RequestError if the number of threads is wrong. Ctrl-C raises KeyboardInterrupt at once.
    #[pyo3(signature = (*, threads = None))]
    fn check<'py>(&self, py: Python<'py>, threads: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyDict>> {
        let threads = self::threads(threads.as_ref())?;
        let study = self.study.clone();
        let outlook = left_alone(py, move || study.outlook(threads))?;
        let told = PyDict::new(py);
        told.set_item("designs", outlook.designs)?;
        told.set_item("scenarios", outlook.scenarios)?;
        told.set_item("evaluations", outlook.evaluations)?;
        told.set_item("seconds", outlook.seconds)?;
        let why = outlook.why_every_design.map_or("bounds, then every design".to_owned(), |why| format!("every design: {why}"));
        told.set_item("method", why)?;
        told.set_item("memory_MB", outlook.memory.div_ceil(1_000_000))?;
        told.set_item("front", outlook.front)?;
        told.set_item("warnings", outlook.warnings)?;
        Ok(told)
    }

    /// Judges every design in every scenario, and computes what is reported once more in f64.
    ///
    /// progress: True shows a bar (of tqdm, if it is installed). A function is called every 50 ms with what is done, how much of it, and
    ///     how much there is, which is more than 0; what it raises ends the sweep.
    /// threads: 1 to 4096, None for one on each core.
    /// engine: "cpu", "gpu", or "auto", which takes a GPU where that is faster. The result is the same.
    /// method: "exhaustive" judges each design, "bounds" whole boxes of them, "auto" what is faster. The result is the same.
    /// adapter: a part of a GPU's name, where there are several.
    /// feasible: also keep every feasible design, as if the study asked for it.
    ///
    /// Returns the result, whose tables have the units that the names of their columns end in.
    ///
    /// RequestError if a word, the adapter or the number of threads is wrong, or the study cannot be served so; RunError if a front does
    /// not fit into memory or a GPU fails. The interpreter lock is released meanwhile; Ctrl-C ends the sweep, of which nothing is kept, and
    /// raises KeyboardInterrupt.
    #[pyo3(signature = (*, progress = None, threads = None, engine = "auto", method = "auto", adapter = None, feasible = false))]
    #[allow(clippy::too_many_arguments, reason = "each has a name in Python")]
    fn sweep(
        &self,
        py: Python<'_>,
        progress: Option<Bound<'_, PyAny>>,
        threads: Option<Bound<'_, PyAny>>,
        engine: &str,
        method: &str,
        adapter: Option<String>,
        feasible: bool,
    ) -> PyResult<SweepResult> {
        let engine = word(py, "engine", engine, &[("auto", Engine::Auto), ("cpu", Engine::Cpu), ("gpu", Engine::Gpu)])?;
        let methods = [("auto", Judging::Auto), ("exhaustive", Judging::Exhaustive), ("bounds", Judging::Bounds)];
        let method = word(py, "method", method, &methods)?;
        let threads = self::threads(threads.as_ref())?;
        if engine != Engine::Cpu {
            keep_the_loader_quiet(py)?;
        }
        let control = Arc::new(Control::default());
        let mut options = Options::default().engine(engine).judging(method).threads(threads).control(control.clone());
        options.adapter = adapter;
        let study = if feasible && !self.study.report.feasible {
            let mut study = self.study.clone();
            study.report.feasible = true;
            study.check().map_err(|problem| request(py, format!("feasible = True: {problem}")))?;
            study
        } else {
            self.study.clone()
        };
        let designs = self.designs;
        let follower = py.import("beltspace._progress")?.call_method1("follower", (progress,))?;
        let tell = |_: Python<'_>| {
            if follower.is_none() {
                return Ok(());
            }
            let (what, done, total) = stage(&control, designs);
            // Of a stage of which it is not known yet how much there is, nothing can be told.
            if total == 0 { Ok(()) } else { follower.call1((what, done, total)).map(drop) }
        };
        let stop = || control.stop.store(true, Ordering::Relaxed);
        let swept = supervised(py, stop, tell, || study.sweep(options));
        if !follower.is_none() {
            follower.call_method0("close")?;
        }
        SweepResult::new(py, swept?.map_err(|error| raised(py, error))?, threads)
    }

    /// Every scenario in which designs are judged: its number, its inputs in the units that their names end in, and its weight if the study
    /// has weights; as `scenarios.csv` of the program has them.
    ///
    /// RequestError if there are more than 2e7 scenarios.
    fn scenario_table(&self, py: Python<'_>) -> PyResult<Table> {
        let table = py.detach(|| self.study.scenario_table()).map_err(|error| raised(py, error))?;
        Table::new(py, table)
    }

    /// The worst of every row over the scenarios of the study, for an optimiser: a row is a design.
    ///
    /// table: a column for every input that the study chooses, in the unit that its name ends in, on the levels of the study or between
    ///     them. It takes the forms that `evaluate` takes.
    /// threads: 1 to 4096, None for one on each core.
    ///
    /// Returns a table with the given inputs; every objective, constraint and report column at its worst, with the scenario where that is;
    /// the margin of each constraint, negative where it is violated; `feasible` ("yes" or "no"); and `status`: "ok", or why not in the
    /// first scenario that fails. Numbers that there are none of are NaN (null in Arrow).
    ///
    /// RequestError, with row and column, if a cell is empty (null, NaN, masked) or beyond the input's valid range, and if a name or the
    /// number of threads is wrong. The interpreter lock is released meanwhile; Ctrl-C ends the work and raises KeyboardInterrupt.
    #[pyo3(signature = (table, *, threads = None))]
    fn worst(&self, py: Python<'_>, table: &Bound<'_, PyAny>, threads: Option<Bound<'_, PyAny>>) -> PyResult<Table> {
        let table = GivenTable::new(table)?;
        let control = Control::default();
        let threads = self::threads(threads.as_ref())?;
        let work = || {
            let mut target = BatchTarget::of_study(self.study.clone(), Vec::new()).without_options();
            let given = GivenColumns::new(&mut target, table.columns(), threads)?;
            target.worst_of_each(&given, threads, &control)
        };
        let found = supervised(py, || control.stop.store(true, Ordering::Relaxed), |_| Ok(()), work)?;
        Table::new(py, found.map_err(|error| raised(py, error))?)
    }

    /// For `pickle`, as worker processes need it: how it is made again.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let Source { file, folder, own, .. } = &self.source;
        // Another process may work in another folder.
        let folder = std::path::absolute(folder.join("."))?;
        let own: Vec<Bound<'py, Model>> = own.iter().map(|model| model.bind(py).clone()).collect();
        Ok((py.get_type::<Self>().getattr("_restored")?, (&self.text, file, folder, own).into_pyobject(py)?))
    }

    #[staticmethod]
    fn _restored(py: Python<'_>, text: &str, file: String, folder: PathBuf, own: Vec<Py<Model>>) -> PyResult<Self> {
        Self::parsed(py, text, Source::new(py, file, folder, Some(own))?, &[])
    }

    fn __repr__(&self) -> String {
        format!("<beltspace.Study \"{}\": {} designs, {} scenarios>", self.study.title, self.designs, self.scenarios)
    }
}
