//! The result of a sweep.

use crate::json;
use crate::stream::RowStream;
use crate::table::{Table, escaped};
use beltspace::Outcome;
use beltspace::run::{Engine, FrontPicture};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The result of a sweep: the same on every engine, by every method, on any number of threads. In a notebook it shows the front.
#[pyclass(name = "Result", module = "beltspace", frozen)]
pub struct SweepResult {
    /// Designs of the study.
    #[pyo3(get)]
    designs: u64,
    /// Scenarios in which each was judged.
    #[pyo3(get)]
    scenarios: u64,
    /// Designs that keep all constraints in all scenarios.
    #[pyo3(get)]
    feasible_designs: u64,
    /// The exact Pareto front, best of the first objective first: inputs, and every objective, constraint and report column at its worst
    /// scenario. Without objectives it has no rows.
    #[pyo3(get)]
    front: Py<Table>,
    /// The best designs by one quantity, if the study asks for them.
    #[pyo3(get)]
    top: Option<Py<Table>>,
    /// A sample of the feasible designs, if the study asks for it.
    #[pyo3(get)]
    sample: Option<Py<Table>>,
    /// All feasible designs in the order of their indices, if the study or the sweep asks for them: a stream, as there may be more than the
    /// memory holds.
    #[pyo3(get)]
    feasible: Option<Py<RowStream>>,
    /// Every design, feasible or not, if the study asks for it.
    #[pyo3(get)]
    variants: Option<Py<Table>>,
    /// The bins of each histogram, by the name of its file.
    #[pyo3(get)]
    histograms: Py<PyDict>,
    /// The cells of each map, likewise.
    #[pyo3(get)]
    maps: Py<PyDict>,
    /// The vertices of the contours of each map that has some, likewise.
    #[pyo3(get)]
    contours: Py<PyDict>,
    /// What judged the designs.
    #[pyo3(get)]
    engine: &'static str,
    /// `exhaustive`, `bounds`, or both if bounds were given up.
    #[pyo3(get)]
    method: &'static str,
    /// How long the designs took, in s.
    #[pyo3(get)]
    seconds: f64,
    /// Remarks on the run, such as why a GPU was not taken.
    #[pyo3(get)]
    remarks: Vec<String>,
    /// Row of the knee in the front.
    knee: Option<usize>,
    title: String,
    summary_json: String,
    picture: FrontPicture,
}

impl SweepResult {
    pub fn new(py: Python<'_>, outcome: Outcome, threads: usize) -> PyResult<Self> {
        let table = |table: beltspace::Table| Py::new(py, Table::new(py, table)?);
        let optional = |it: Option<beltspace::Table>| it.map(table).transpose();
        let named = |tables: Vec<(String, beltspace::Table)>| {
            let dict = PyDict::new(py);
            tables.into_iter().try_for_each(|(name, it)| dict.set_item(name, table(it)?)).map(|()| dict.unbind())
        };
        Ok(Self {
            designs: outcome.counts.designs,
            scenarios: outcome.counts.scenarios,
            feasible_designs: outcome.counts.feasible,
            front: table(outcome.front)?,
            top: optional(outcome.top)?,
            sample: optional(outcome.sample)?,
            feasible: outcome.feasible.map(|rows| Py::new(py, RowStream::new(rows, threads))).transpose()?,
            variants: optional(outcome.variants)?,
            histograms: named(outcome.histograms)?,
            maps: named(outcome.maps)?,
            contours: named(outcome.contours)?,
            engine: if outcome.course.engine == Engine::Gpu { "gpu" } else { "cpu" },
            method: outcome.course.method,
            seconds: outcome.course.time.as_secs_f64(),
            remarks: outcome.course.remarks,
            knee: outcome.summary.knee.map(|knee| knee.row),
            title: outcome.study.title.clone(),
            summary_json: outcome.summary_json,
            picture: outcome.front_picture,
        })
    }
}

#[pymethods]
impl SweepResult {
    /// What `summary.json` says: counts, ideal, knee, extremes, what limits feasibility, findings.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let parsed = serde_json::from_str(&self.summary_json).map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        json::value(py, &parsed)
    }

    /// The text of `summary.json`.
    #[getter]
    fn summary_json(&self) -> &str {
        &self.summary_json
    }

    /// The design of the front that is nearest to the ideal; None without a front.
    #[getter]
    fn knee<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.knee.map(|row| self.front.bind(py).call_method1("row", (row,))).transpose()
    }

    /// The picture of the front; None if the study has no objectives.
    fn svg(&self, py: Python<'_>) -> Option<String> {
        py.detach(|| self.picture.svg())
    }

    fn __repr__(&self) -> String {
        let Self { designs, scenarios, feasible_designs, title, .. } = self;
        let front = self.front.get().num_rows();
        format!(
            "<beltspace.Result \"{title}\": {designs} designs in {scenarios} scenarios, {feasible_designs} feasible, {front} on the front>"
        )
    }

    fn _repr_html_(&self, py: Python<'_>) -> String {
        let Self { designs, scenarios, feasible_designs, title, .. } = self;
        let front = self.front.get();
        let counts = format!("{designs} designs in {scenarios} scenarios, {feasible_designs} feasible, {} on the front", front.num_rows());
        let shown = self.svg(py).unwrap_or_else(|| front.html());
        format!("<h4>{}</h4><p>{counts}</p>{shown}", escaped(title))
    }
}
