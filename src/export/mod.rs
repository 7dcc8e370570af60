//! The result directory: the same bytes whatever ran the study, but for `run.json`.

mod csv;
mod number;
mod parquet;
mod pictures;
pub mod pulley;
mod summary;
mod table;
mod tables;
#[cfg(test)]
mod tests;

pub use csv::write as csv_text;
pub use number::plain;
pub use summary::{Knee, MethodRecord, RunRecord, Summary};
pub use table::{Data, Table, TableColumn};
pub use tables::{map_value, written};

use crate::certify::{self, Column, Row};
use crate::checkpoint::replace;
use crate::contours::contours;
use crate::error::{Error, Result};
use crate::models::MODELS;
use crate::plan::Plan;
use crate::reduce::{State, Top};
use crate::screen::{Control, Tally};
use crate::study::Study;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::sync::atomic::Ordering;

/// Maps of more cells are written as Parquet rather than CSV.
pub const CSV_CELLS: u64 = 100_000;
/// The file whose presence makes a directory a result.
pub const MARK: &str = "summary.json";
/// Folder of the checkpoint within a result directory.
pub const CHECKPOINT: &str = "checkpoint";
/// The page that shows a result; like `run.json` it may differ from run to run.
pub const PAGE: &str = "report.html";

/// A finished, certified sweep: everything that the result directory says.
#[derive(Debug)]
pub struct Outcome<'p> {
    /// The study, laid out.
    pub plan: &'p Plan,
    /// What the sweep kept.
    pub state: State,
    /// What limits feasibility.
    pub tally: Tally,
    /// Columns of the tables.
    pub columns: Vec<Column>,
    /// The front, objectives best first, then index.
    pub front: Vec<Row>,
    /// The best designs by one quantity, best first.
    pub top: Vec<Row>,
    /// Every design, feasible or not, if the study asks for it.
    pub variants: Vec<Row>,
}

impl<'p> Outcome<'p> {
    /// Certifies what a sweep kept; seen and stopped by others.
    ///
    /// # Errors
    /// [`Error::Certificate`] if the f64 reference disagrees with the sweep; [`Error::Stopped`] after `control.stop`.
    pub fn certify(plan: &'p Plan, state: State, tally: Tally, threads: usize, control: &Control) -> Result<Self> {
        let columns = certify::columns(&plan.study);
        let best = state.top.as_ref().map_or(Vec::new(), Top::indices);
        let all: Vec<u64> = if plan.study.report.variants { (0..plan.designs()).collect() } else { Vec::new() };
        let reported = state.front.indices.len() + best.len() + all.len();
        control.reported.store(reported as u64, Ordering::Relaxed);
        let front = certify::front(plan, &columns, &state.front, threads, control)?;
        let top = certify::rows(plan, &columns, &best, threads, control)?;
        top.iter().try_for_each(certify::check_feasible)?;
        let variants = certify::rows(plan, &columns, &all, threads, control)?;
        let feasible = variants.iter().filter(|row| row.feasible).count() as u64;
        if plan.study.report.variants && feasible != state.feasible {
            let seen = state.feasible;
            return Err(Error::Certificate(format!("the sweep counted {seen} feasible designs, the f64 reference finds {feasible}")));
        }
        Ok(Self { plan, state, tally, columns, front, top, variants })
    }

    /// The files of the result, by name, in the order in which they are written; [`MARK`] last. The lines over maps are found here,
    /// on several threads: they depend on the plan alone, so no checkpoint need keep them.
    ///
    /// # Errors
    /// [`Error::Io`] from the table writers.
    fn files(&self, text: &str, threads: usize) -> Result<Vec<(String, Vec<u8>)>> {
        let study = &self.plan.study;
        let json = |value: &serde_json::Value| (format!("{value:#}") + "\n").into_bytes();
        let mut files = vec![
            ("study.toml".to_owned(), text.as_bytes().to_vec()),
            ("study.json".to_owned(), json(&study.describe())),
            ("scenarios.csv".to_owned(), csv::scenarios(self.plan)),
        ];
        if !study.objectives.is_empty() {
            let table = tables::designs(self, &self.front);
            files.push(("front.csv".to_owned(), csv::write(&table)));
            files.push(("front.parquet".to_owned(), parquet::write(&table)?));
            files.push(("front.svg".to_owned(), pictures::front(self).into_bytes()));
        }
        if study.report.top.is_some() {
            files.push(("top.csv".to_owned(), csv::write(&tables::designs(self, &self.top))));
        }
        if study.report.variants {
            files.push(("variants.csv".to_owned(), csv::write(&tables::variants(self, &self.variants))));
        }
        for (name, text) in self.knee_pictures() {
            files.push((format!("knee-{name}.svg"), text.into_bytes()));
        }
        let (histograms, maps) = table_names(study);
        for ((spec, histogram), name) in study.report.histograms.iter().zip(&self.state.histograms).zip(histograms) {
            files.push((format!("{name}.csv"), csv::write(&tables::histogram(histogram))));
            files.push((format!("{name}.svg"), pictures::histogram(study, spec, histogram).into_bytes()));
        }
        for ((spec, map), name) in study.report.maps.iter().zip(&self.state.maps).zip(maps) {
            let (width, height) = map.size();
            let table = tables::map(self.plan, spec, map);
            if width * height > CSV_CELLS {
                files.push((format!("{name}.parquet"), parquet::write(&table)?));
            } else {
                files.push((format!("{name}.csv"), csv::write(&table)));
            }
            let contours = contours(self.plan, spec, threads);
            if !spec.contours.is_empty() {
                files.push((contours_name(&name), csv::write(&tables::contours(study, spec, &contours))));
            }
            files.push((format!("{name}.svg"), pictures::map(study, spec, map, &table, &contours).into_bytes()));
        }
        files.push((MARK.to_owned(), json(&Summary::new(self).to_json())));
        Ok(files)
    }

    /// Pictures of the knee, in its most stressed scenario, for models that have such.
    fn knee_pictures(&self) -> Vec<(&'static str, String)> {
        let plan = self.plan;
        let summary = Summary::new(self);
        let Some(row) = summary.knee.as_ref().map(|knee| &self.front[knee.row]) else { return Vec::new() };
        // The largest stress is where the least margin against yield is, whichever of them the study reports.
        let stress = ["max_stress_MPa", "yield_safety", "fatigue_safety"];
        let worst = stress.iter().find_map(|name| self.columns.iter().position(|column| column.name == *name));
        let scenario = worst.map_or(0, |column| row.columns[column].scenario);
        let title = format!("{}: knee, design {}, scenario {scenario}", plan.study.title, row.index);
        pulley::pictures(plan.study.model, &title, &plan.space.inputs(row.index, scenario))
    }

    /// Writes the result directory. Each file is either whole or not there, and [`MARK`] comes last.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn write(&self, folder: &Path, text: &str, run: &RunRecord) -> Result<()> {
        fs::create_dir_all(folder).map_err(Error::io(folder))?;
        let files = self.files(text, run.threads)?;
        // An older result stops being one before its files are replaced, and none of its files outlives it.
        let keep: BTreeSet<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
        remove_if_there(&folder.join(MARK))?;
        for entry in fs::read_dir(folder).map_err(Error::io(folder))? {
            let entry = entry.map_err(Error::io(folder))?;
            let name = entry.file_name().to_string_lossy().into_owned();
            if !keep.contains(name.as_str()) && is_ours(&name) {
                remove_if_there(&entry.path())?;
            }
        }
        let (mark, others) = files.split_last().expect("a result has files");
        for (name, bytes) in others {
            replace(&folder.join(name), bytes)?;
        }
        replace(&folder.join("run.json"), (format!("{:#}", run.to_json()) + "\n").as_bytes())?;
        replace(&folder.join(&mark.0), &mark.1)
    }
}

/// Names of the tables of a study's histograms and of its maps, without their extension.
pub fn table_names(study: &Study) -> (Vec<String>, Vec<String>) {
    let mut names = BTreeSet::new();
    let mut unique = |name: String| {
        let candidates = std::iter::once(name.clone()).chain((2..).map(|n| format!("{name}-{n}")));
        candidates.into_iter().find(|name| names.insert(name.clone())).expect("numbers do not run out")
    };
    let histograms = study.report.histograms.iter().map(|spec| unique(format!("histogram-{}", spec.of.name(study.model)))).collect();
    let maps = study.report.maps.iter().map(|spec| unique(format!("map-{}", tables::map_value(study, spec).0))).collect();
    (histograms, maps)
}

/// File of the lines over the map of that name.
pub fn contours_name(map: &str) -> String {
    format!("{}.csv", map.replacen("map-", "contours-", 1))
}

/// Is this a name that a result directory may have, so that an older result's file may go?
fn is_ours(name: &str) -> bool {
    let name = name.strip_suffix(".writing").unwrap_or(name);
    let fixed = [
        "front.csv",
        "front.parquet",
        "front.svg",
        "top.csv",
        "variants.csv",
        "scenarios.csv",
        "study.toml",
        "study.json",
        "run.json",
        PAGE,
        MARK,
    ];
    let (stem, extension) = name.rsplit_once('.').unwrap_or((name, ""));
    let prefixes = [("histogram-", &["csv", "parquet", "svg"][..]), ("map-", &["csv", "parquet", "svg"]), ("contours-", &["csv"])];
    let of_quantity =
        |(prefix, extensions): &(&str, &[&str])| extensions.contains(&extension) && stem.strip_prefix(prefix).is_some_and(is_quantity);
    let knee = extension == "svg" && stem.strip_prefix("knee-").is_some_and(|it| pulley::PICTURES.contains(&it));
    knee || fixed.contains(&name) || prefixes.iter().any(of_quantity)
}

/// Is this the name of a quantity of some model, or of a feasible share, perhaps numbered?
fn is_quantity(name: &str) -> bool {
    let known =
        |name: &str| name == "feasible_share" || MODELS.iter().any(|model| model.input(name).is_some() || model.output(name).is_some());
    let number = |text: &str| !text.is_empty() && text.bytes().all(|it| it.is_ascii_digit());
    known(name) || name.rsplit_once('-').is_some_and(|(name, text)| number(text) && known(name))
}

/// Files of a folder whose names a result would take, in the order of their names.
///
/// # Errors
/// [`Error::Io`] if the folder is there and cannot be read.
pub fn in_the_way(folder: &Path) -> Result<Vec<String>> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(Error::io(folder))?,
    };
    let mut names = Vec::new();
    for entry in entries {
        let entry = entry.map_err(Error::io(folder))?;
        if entry.path().is_file() {
            names.push(entry.file_name().to_string_lossy().into_owned());
        }
    }
    names.retain(|name| is_ours(name));
    names.sort();
    Ok(names)
}

fn remove_if_there(path: &Path) -> Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(Error::io(path)(error)),
        _ => Ok(()),
    }
}
