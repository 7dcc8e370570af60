//! The result directory. Except for `run.json` its files have the same bytes however the study was run.
//!
//! Without the feature `pictures` it has no pictures and no page, without `parquet` no tables in Parquet: `front.csv` has the same values
//! as `front.parquet`, and maps of any size are CSV. All other files have the same bytes.

mod confirmed;
mod drawn_tally;
pub(crate) mod feasible;
mod influence;
#[cfg(feature = "pictures")]
mod pictures;
#[cfg(feature = "pictures")]
pub mod pulley;
mod scenarios;
mod summary;
pub(crate) mod tables;
#[cfg(test)]
mod tests;

pub use confirmed::Confirmed;
pub use drawn_tally::DrawnTally;
pub use feasible::FeasibleRows;
#[cfg(feature = "pictures")]
pub use pictures::FrontPicture;
#[cfg(feature = "cli")]
pub(crate) use summary::ideal_and_knee;
pub use summary::{Knee, MethodRecord, RunRecord, Summary};

use crate::certify::{self, Column, Row};
use crate::checkpoint::Checkpoint;
use crate::directory::Contents;
use crate::error::{Error, Result};
use crate::findings::Findings;
use crate::influence::{InfluenceReport, files as influence_files};
#[cfg(feature = "pictures")]
use crate::names::knee_name;
use crate::names::{MARK, RUN};
use crate::plan::Plan;
use crate::reduce::{FEASIBLE_FILE, FeasibleList, State};
use crate::screen::{Control, Tally};
#[cfg(feature = "parquet")]
use crate::table::parquet;
use crate::table::{Table, csv};
use rustc_hash::{FxHashMap, FxHashSet};
use std::io::Write;
use std::path::Path;
use std::sync::atomic::Ordering;

/// A finished, certified sweep: everything that the result directory contains.
#[derive(Debug)]
pub struct Certified<'p> {
    /// The study and its plan.
    pub plan: &'p Plan,
    /// The state at the end of the sweep.
    pub state: State,
    /// What limits feasibility, counted over the sample.
    pub tally: Tally,
    /// Columns of the tables.
    pub columns: Vec<Column>,
    /// The front, objectives best first, then index.
    pub front: Vec<Row>,
    /// The designs that each reducer of the report names, in the order of its table.
    pub named: Vec<Vec<Row>>,
    /// Every design, feasible or not, if the study asks for it.
    pub variants: Vec<Row>,
    /// What a person should know of it besides.
    pub findings: Findings,
    /// Why draws fail, if the study has distributions.
    pub drawn: Option<DrawnTally>,
    /// Which input matters, if the study asks for it and there is a design to look at.
    pub influence: Option<InfluenceReport>,
}

/// The rows of designs: those certified `before` are copied, `certify` makes the others.
fn rows_after<'r>(
    before: impl Iterator<Item = &'r Vec<Row>>,
    designs: &[u64],
    control: &Control,
    certify: impl FnOnce(&[u64]) -> Result<Vec<Row>>,
) -> Result<Vec<Row>> {
    // The front may be far longer than the list: only what is listed is looked up.
    let listed: FxHashSet<u64> = designs.iter().copied().collect();
    let known: FxHashMap<u64, &Row> = before.flatten().filter(|row| listed.contains(&row.index)).map(|row| (row.index, row)).collect();
    let missing: Vec<u64> = designs.iter().copied().filter(|design| !known.contains_key(design)).collect();
    control.certified.fetch_add((designs.len() - missing.len()) as u64, Ordering::Relaxed);
    let mut certified = certify(&missing)?.into_iter();
    let row = |design: &u64| known.get(design).map_or_else(|| certified.next().expect("every design has a row"), |&row| row.clone());
    Ok(designs.iter().map(row).collect())
}

impl<'p> Certified<'p> {
    /// Certifies the state of a sweep; `control` shows the progress and can stop it.
    ///
    /// # Errors
    /// [`Error::Disagreement`] if the f64 reference disagrees with the sweep; [`Error::Stopped`] after `control.stop`.
    pub fn certify(plan: &'p Plan, state: State, tally: Tally, threads: usize, control: &Control) -> Result<Self> {
        let columns = certify::columns(&plan.study);
        let designs = state.reported.designs();
        let all: Vec<u64> = if plan.study.report.variants { (0..plan.designs()).collect() } else { Vec::new() };
        let reported = state.front.indices.len() + designs.iter().map(Vec::len).sum::<usize>() + all.len();
        control.reported.store(reported as u64, Ordering::Relaxed);
        state.reported.all_feasible.iter().try_for_each(|list| feasible::check_count(list, state.feasible))?;
        let front = certify::front(plan, &columns, &state.front, threads, control)?;
        let mut named: Vec<Vec<Row>> = Vec::new();
        for (designs, all) in designs.iter().zip(state.reported.designs_of(state.feasible)) {
            let before = named.iter().chain([&front]);
            let rows = rows_after(before, designs, control, |missing| certify::rows(plan, &columns, missing, threads, control))?;
            rows.iter().try_for_each(certify::check_feasible)?;
            if let Some(all) = all.filter(|&all| all != rows.len() as u64) {
                let (found, feasible) = (rows.len(), state.feasible);
                return Err(Error::Disagreement(format!(
                    "the sweep kept {found} of the {feasible} feasible designs where it must keep {all}"
                )));
            }
            named.push(rows);
        }
        let before = named.iter().chain([&front]);
        let variants = rows_after(before, &all, control, |missing| certify::rows(plan, &columns, missing, threads, control))?;
        let feasible = variants.iter().filter(|row| row.feasible).count() as u64;
        if plan.study.report.variants && feasible != state.feasible {
            let seen = state.feasible;
            return Err(Error::Disagreement(format!("the sweep counted {seen} feasible designs, the f64 reference finds {feasible}")));
        }
        let findings = Findings::of(plan, state.feasible, &front, threads, control)?;
        let mut outcome = Self { plan, state, tally, columns, front, named, variants, findings, drawn: None, influence: None };
        outcome.drawn = DrawnTally::new(plan, threads, control)?;
        outcome.influence = outcome.look_at_influence(threads, control)?;
        Ok(outcome)
    }

    /// Number of reported designs that were certified, without those of a list of all designs; one that is in two lists counts twice.
    pub fn certified(&self) -> usize {
        self.front.len() + self.named.iter().map(Vec::len).sum::<usize>()
    }

    /// Makes the files of the result, one after the other in the order in which they are written, [`MARK`] last. `run.json` is left to the
    /// caller. `control` can stop what is still to be certified.
    ///
    /// # Errors
    /// Those of `put`; [`Error::Io`] from the table writers.
    fn make_files(&self, text: &str, threads: usize, control: &Control, put: &mut dyn FnMut(&str, Part<'_>) -> Result<()>) -> Result<()> {
        let study = &self.plan.study;
        let json = |value: &serde_json::Value| Part::Bytes((format!("{value:#}") + "\n").into_bytes());
        #[cfg(feature = "pictures")]
        let svg = |text: String| Part::Bytes(text.into_bytes());
        let csv = |table: &Table| Part::Bytes(csv::write(table));
        put("study.toml", Part::Bytes(text.as_bytes().to_vec()))?;
        put("study.json", json(&study.describe()))?;
        put("scenarios.csv", Part::Scenarios(self.plan))?;
        if !study.objectives.is_empty() {
            let table = tables::designs(self, &self.front);
            put("front.csv", csv(&table))?;
            #[cfg(feature = "parquet")]
            put("front.parquet", Part::Bytes(parquet::write(&table)?))?;
            #[cfg(feature = "pictures")]
            if let Some(picture) = FrontPicture::new(self).svg() {
                put("front.svg", svg(picture))?;
            }
        }
        let table = |place: usize| tables::designs(self, &self.named[place]);
        self.state.reported.write(self.plan, threads, &table, &mut |name, bytes| put(name, Part::Bytes(bytes)))?;
        for list in &self.state.reported.all_feasible {
            put(FEASIBLE_FILE, Part::Feasible(self, list, threads, control))?;
        }
        if study.report.variants {
            put("variants.csv", csv(&tables::variants(self, &self.variants)))?;
        }
        for (name, bytes) in self.influence.iter().flat_map(influence_files) {
            put(&name, Part::Bytes(bytes))?;
        }
        #[cfg(feature = "pictures")]
        for (name, text) in self.knee_pictures() {
            put(&knee_name(name), svg(text))?;
        }
        put(MARK, json(&Summary::new(self).to_json()))
    }

    /// Pictures of the knee in its most stressed scenario, for models that have some.
    #[cfg(feature = "pictures")]
    fn knee_pictures(&self) -> Vec<(&'static str, String)> {
        let plan = self.plan;
        let summary = Summary::new(self);
        let Some(row) = summary.knee.as_ref().map(|knee| &self.front[knee.row]) else { return Vec::new() };
        // The scenario of the largest stress is that of the least yield safety; the study may report either.
        let stress = ["max_stress_MPa", "yield_safety", "fatigue_safety"];
        let worst = stress.iter().find_map(|name| self.columns.iter().position(|column| column.name == *name));
        let scenario = worst.map_or(0, |column| row.columns[column].scenario);
        let title = format!("{}: knee, design {}, scenario {scenario}", plan.study.title, row.index);
        pulley::pictures(&plan.study.model, &title, &plan.space.inputs(row.index, scenario))
    }

    /// Writes the result into the directory of a checkpoint, replaces an older result there, and removes the checkpoint. At any moment the
    /// directory holds the old result, or the checkpoint with all of the new one, or the new one. `control` can stop it before that.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Stopped`]; [`Error::Disagreement`] if the f64 reference finds one of all feasible designs infeasible; [`Error::Request`] if something that this program did not write has the name of one of the files.
    pub fn write(&self, checkpoint: Checkpoint, text: &str, run: &RunRecord, control: &Control) -> Result<()> {
        let mut files: Vec<String> = Vec::new();
        self.make_files(text, run.threads, control, &mut |name, part| {
            files.push(name.to_owned());
            let mut failure = None;
            let staged = checkpoint.stage(name, |out| {
                part.write(out).map_err(|error| {
                    failure = Some(error);
                    std::io::ErrorKind::Other.into()
                })
            });
            // What is wrong with the rows says more than that they could not be written; a full disk is told with the file's path.
            match failure {
                Some(Error::Io { source, .. }) => staged.map_err(|error| match error {
                    Error::Io { path, .. } => Error::Io { path, source },
                    other => other,
                }),
                Some(error) => Err(error),
                None => staged,
            }
        })?;
        files.insert(files.len() - 1, RUN.to_owned());
        let run = format!("{:#}\n", run.to_json(&files));
        checkpoint.stage(RUN, |out| out.write_all(run.as_bytes()))?;
        let contents = Contents::of(checkpoint.directory().path())?;
        contents.refuse_foreign(&files)?;
        checkpoint.switch(files, contents.own_files()?)
    }
}

/// The contents of a file of a result.
enum Part<'a> {
    Bytes(Vec<u8>),
    /// The table of scenarios, which may be too large for the memory.
    Scenarios(&'a Plan),
    /// The table of feasible designs, likewise.
    Feasible(&'a Certified<'a>, &'a FeasibleList, usize, &'a Control),
}

impl Part<'_> {
    fn write(&self, out: &mut dyn Write) -> Result<()> {
        match self {
            Self::Bytes(bytes) => out.write_all(bytes).map_err(Error::io(Path::new("result"))),
            Self::Scenarios(plan) => scenarios::write(plan, out).map_err(Error::io(Path::new("result"))),
            Self::Feasible(outcome, list, threads, control) => feasible::write(outcome, list, *threads, control, out),
        }
    }
}
