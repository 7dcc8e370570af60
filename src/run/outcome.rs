//! The outcome of a study, as values in memory.

use super::device::{self, Wrong};
use super::judge::{How, Judged, judge, record_of};
use super::{Engine, Options, method};
use crate::contours::contours as lines_over;
use crate::error::Result;
#[cfg(feature = "pictures")]
use crate::export::FrontPicture;
use crate::export::{Certified, FeasibleRows, Knee, Summary, tables};
use crate::models::OVERFLOW;
use crate::parallel::to_be_had;
use crate::plan::Plan;
use crate::reduce::{Extreme, Histogram, histogram, map};
use crate::study::Study;
use crate::sweep::Settings;
use crate::sweep::costs::Speed;
use crate::table::Table;
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

/// The outcome of a study. Everything but [`Outcome::course`] is the same on every engine, by every method, on any number of threads.
///
/// Values in tables are in the unit that the column's name ends in. Of a quantity that differs between scenarios the table has the worst
/// value, and the scenario in a column of its own.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Outcome {
    /// The study.
    pub study: Study,
    /// How many designs there are, and how many of them are feasible.
    pub counts: Counts,
    /// The exact Pareto front, one row per design, sorted by the first objective, best first. Without objectives it has no rows.
    pub front: Table,
    /// The best designs by one quantity, best first, if the study asks for them.
    pub top: Option<Table>,
    /// A sample of the feasible designs in the order of their indices, if the study asks for it.
    pub sample: Option<Table>,
    /// Every design, feasible or not, if the study asks for it.
    pub variants: Option<Table>,
    /// All feasible designs in the order of their indices, if the study asks for them: block by block, as they may be longer than the
    /// memory.
    pub feasible: Option<Arc<FeasibleRows>>,
    /// The bins of each histogram with the name of its file without extension, in the order of the study.
    pub histograms: Vec<(String, Table)>,
    /// The cells of each map, row by row, named likewise.
    pub maps: Vec<(String, Table)>,
    /// The vertices of the contours of each map that has some, named likewise.
    pub contours: Vec<(String, Table)>,
    /// Highlights.
    pub summary: Highlights,
    /// The same in more detail: the text of `summary.json`, one JSON object.
    pub summary_json: String,
    /// The front over its objectives, as `front.svg` shows it.
    #[cfg(feature = "pictures")]
    pub front_picture: FrontPicture,
    /// How the designs were judged.
    pub course: Course,
}

/// Numbers of designs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Counts {
    /// Designs of the study.
    pub designs: u64,
    /// Scenarios in which each was judged.
    pub scenarios: u64,
    /// Designs that keep all constraints in all scenarios.
    pub feasible: u64,
    /// Designs on the front.
    pub front: u64,
}

/// Highlights of a study's designs.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Highlights {
    /// The best value of each objective on the front, as a rule of a different design each; empty without a front.
    pub ideal: Vec<Named>,
    /// Row in [`Outcome::front`] of the design nearest to the ideal, with objectives scaled to [0, 1] over the front.
    pub knee: Option<Knee>,
    /// Per objective, the least and largest worst value over all feasible designs; empty if none is feasible.
    pub spreads: Vec<Spread>,
    /// Designs of a fixed sample.
    pub sampled: u64,
    /// Feasible designs of the sample.
    pub feasible_of_sample: u64,
    /// What the other designs of the sample fail at; one design may fail at several things.
    pub limits: Vec<Limit>,
    /// What is worth knowing besides: how far off feasibility is where nothing is feasible, ends of axes on which the front stands,
    /// quantities below zero that no constraint forbids. One sentence each.
    pub findings: Vec<String>,
    /// Remarks on the study as a whole.
    pub notes: Vec<String>,
}

/// A value with the name of its quantity, which ends in its unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    /// Name of the quantity.
    pub name: String,
    /// Its value, in its unit.
    pub value: f64,
}

/// The range of an objective over the feasible designs.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Spread {
    /// Name of the objective.
    pub name: String,
    /// The least of its worst values, in its unit, and the design.
    pub least: Extreme,
    /// The largest of its worst values.
    pub largest: Extreme,
}

/// Something that designs fail at.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Limit {
    /// A status of the model, or a constraint with its bounds.
    pub what: String,
    /// Designs of the sample that fail at it in some scenario.
    pub designs: u64,
    /// For a constraint: those of them that fail at nothing else.
    pub only: Option<u64>,
}

/// How the designs were judged: the only part of an outcome that differs from run to run.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Course {
    /// The engine: [`Engine::Cpu`] or [`Engine::Gpu`].
    pub engine: Engine,
    /// `exhaustive`, `bounds`, or both if bounds were given up.
    pub method: &'static str,
    /// Why this method.
    pub why: String,
    /// How long it took.
    pub time: Duration,
    /// Remarks on the run, such as why a device was not taken.
    pub remarks: Vec<String>,
}

impl Study {
    /// Judges every design of the study in every scenario, keeps what the study asks for, and computes what is reported once more with the
    /// scalar f64 reference. No file is written.
    ///
    /// # Errors
    /// [`Error::Request`](crate::error::Error::Request) if engine, adapter and method of the options do not go together, or the method
    /// cannot serve the study; [`Error::NoAdapter`](crate::error::Error::NoAdapter), [`Error::CpuOnly`](crate::error::Error::CpuOnly) and
    /// [`Error::NotOnDevice`](crate::error::Error::NotOnDevice) if the GPU that is asked for is not there or cannot serve it;
    /// [`Error::FrontBudget`](crate::error::Error::FrontBudget) and [`Error::FrontMemory`](crate::error::Error::FrontMemory) if the front
    /// has too many points; [`Error::Gpu`](crate::error::Error::Gpu) and [`Error::ErrorBound`](crate::error::Error::ErrorBound) if a device fails
    /// or computes wrong values; [`Error::Stopped`](crate::error::Error::Stopped) after `control.stop` of the options;
    /// [`Error::Disagreement`](crate::error::Error::Disagreement) if the reference disagrees with the sweep, a bug in beltspace.
    pub fn sweep(&self, options: Options) -> Result<Outcome> {
        let plan = Plan::new(self.clone());
        let Options { engine, judging, adapter, threads, front_bytes, control } = options;
        let (adapter, threads) = (adapter.as_deref(), to_be_had(threads.max(1)));
        let mut remarks = Vec::new();
        let mut remark = |text: &str| remarks.push(text.to_owned());
        let on_a_device = device::is_expected(&plan, engine, adapter);
        let speed = || if on_a_device { device::about(Speed::quick(&plan, threads)) } else { Speed::quick(&plan, threads) };
        let method = method::choose(&plan, judging, engine, adapter, threads, speed)?;
        let asked = method.engine(engine, on_a_device);
        let device = device::choose_tried(&plan, asked, engine, adapter, Wrong::default(), &mut remark)?;
        let how = How::new(&method, device.as_ref(), engine, adapter);
        let settings = Settings { threads, front_bytes, ..Settings::default() };
        let Judged { time, certified, did, settler, .. } = judge(&plan, &settings, None, &control, true, how, &mut remark)?;
        let certified = certified.expect("a whole study is certified");
        let record = record_of(method.why, settler);
        let engine = if did.is_some() { Engine::Gpu } else { Engine::Cpu };
        let course = Course { engine, method: record.name, why: record.why, time, remarks };
        Ok(Outcome::new(&certified, threads, course))
    }
}

impl Outcome {
    fn new(certified: &Certified<'_>, threads: usize, course: Course) -> Self {
        let Certified { plan, state, .. } = certified;
        let study = &plan.study;
        let report = &study.report;
        let of_maps = map::names(study);
        let lines = report.maps.iter().zip(&of_maps).filter(|(spec, _)| !spec.contours.is_empty()).map(|(spec, name)| {
            let file = map::contours_name(name);
            (file.trim_end_matches(".csv").to_owned(), map::contours(study, spec, &lines_over(plan, spec, threads)))
        });
        let places = state.reported.places();
        let listed = |places: Range<usize>| certified.named[places].first().map(|rows| tables::designs(certified, rows));
        Self {
            counts: Counts {
                designs: plan.designs(),
                scenarios: plan.scenarios(),
                feasible: state.feasible,
                front: certified.front.len() as u64,
            },
            front: tables::designs(certified, &certified.front),
            top: listed(places.top),
            sample: listed(places.samples),
            variants: study.report.variants.then(|| tables::variants(certified, &certified.variants)),
            feasible: state.reported.all_feasible.first().map(|list| FeasibleRows::new(certified, list).into()),
            histograms: histogram::names(study).into_iter().zip(state.reported.histograms.iter().map(Histogram::table)).collect(),
            contours: lines.collect(),
            maps: {
                let cells = report.maps.iter().zip(&state.reported.maps).map(|(spec, map)| map::cells(plan, spec, map));
                of_maps.iter().cloned().zip(cells).collect()
            },
            summary: Highlights::new(certified),
            summary_json: format!("{:#}\n", Summary::new(certified).to_json()),
            #[cfg(feature = "pictures")]
            front_picture: FrontPicture::new(certified),
            course,
            study: study.clone(),
        }
    }
}

impl Highlights {
    fn new(certified: &Certified<'_>) -> Self {
        let Certified { plan, state, tally, .. } = certified;
        let study = &plan.study;
        let model = &study.model;
        let names = || study.objectives.iter().map(|objective| objective.name(model));
        let Summary { ideal, knee, .. } = Summary::new(certified);
        let ends = state.extremes.least.iter().zip(&state.extremes.largest);
        let spread = |(name, (least, largest)): (String, (&Option<Extreme>, &Option<Extreme>))| {
            Some(Spread { name, least: (*least)?, largest: (*largest)? })
        };
        let failed = |what: &str, designs: u64, only| Limit { what: what.to_owned(), designs, only };
        let mut limits: Vec<_> = tally.statuses(study).into_iter().map(|(reason, count)| failed(reason, count, None)).collect();
        limits.extend((tally.overflow > 0).then(|| failed(OVERFLOW, tally.overflow, None)));
        limits.extend(study.constraints.iter().zip(tally.constraints.iter().zip(&tally.only)).map(|(constraint, (&designs, &only))| {
            failed(&format!("{} {}", constraint.name(model), constraint.in_words()), designs, Some(only))
        }));
        Self {
            ideal: names().zip(ideal.unwrap_or_default()).map(|(name, value)| Named { name, value }).collect(),
            knee,
            spreads: names().zip(ends).filter_map(spread).collect(),
            sampled: tally.sampled,
            feasible_of_sample: tally.feasible,
            limits,
            findings: certified.findings.in_words(study),
            notes: study.remarks(),
        }
    }
}
