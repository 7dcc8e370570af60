//! Answers while somebody asks: the exact front of a study that changes many times a second.
//!
//! [`Live`] takes a study and changes of it, and answers each in steps: a coarse front where the exact one takes longer than an eye notices,
//! then the exact one, and once nobody has asked for something else meanwhile, what takes every design: how many are feasible, and why the
//! others are not. [`search::FrontSearch`] finds the front without judging every design in every scenario.

pub mod around;
mod coarse;
mod followed;
#[cfg(feature = "pictures")]
pub mod given;
pub mod lanes;
pub mod search;
pub mod table;
#[cfg(test)]
mod tests;

use crate::bounds::refusal;
use crate::certify::{self, Column, Row};
use crate::error::{Error, Result};
use crate::findings::Findings;
use crate::models::Models;
use crate::plan::Plan;
use crate::reduce::Reduction;
use crate::screen::{Control, Tables, Tally};
use crate::study::Study;
use crate::sweep::costs::Speed;
use crate::sweep::{Leaving, Rule, Settings, sweep, sweep_auto};
use rustc_hash::FxHashMap;
use search::{FrontSearch, JudgedRows, SearchTimes, WorkingSet};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use toml::de::{DeTable, DeValue};

/// Where the exact front takes longer than this, a coarse one is told first.
pub const NOTICED: Duration = Duration::from_millis(50);
/// How many times as long a design of a coarser grid takes, as long as nothing else is known.
const SLOWNESS: f64 = 3.0;
/// Where all designs must still be judged in at most one of so many scenarios, the exact front comes soon.
const FEW_NEW: u64 = 4;
/// What takes every design waits this long, for somebody who drags a slider on.
const PAUSE: Duration = Duration::from_millis(250);
/// Seconds that counting feasible designs may take; beyond, the sample alone is told.
const COUNTED: f64 = 60.0;
/// Feasible designs of the sample that is told with their number.
const SAMPLED: usize = 2000;
/// Seconds that judging every design may take before bounds are thought of.
const LONG: f64 = 1.0;

/// A study that is asked again and again, with changes.
#[derive(Debug)]
pub struct Live {
    text: String,
    file: String,
    folder: PathBuf,
    threads: usize,
    /// By the numbers of levels of the scenario axes: the scenarios that decided last.
    sets: Mutex<FxHashMap<Vec<u64>, WorkingSet>>,
    /// Designs of the last front, over all scenarios.
    judged: Mutex<JudgedRows>,
    pace: Mutex<LivePace>,
}

/// How long things took of late.
#[derive(Clone, Copy, Debug)]
struct LivePace {
    /// Seconds that a thread took for one design in one scenario.
    swept: Option<f64>,
    /// Seconds that all threads took for one design of a front in one scenario.
    judged: Option<f64>,
    /// How many times as long a design of a coarser grid took: its rows are short, and its front is not known yet.
    slowness: f64,
}

/// A step of an answer.
pub enum LiveAnswer<'a> {
    /// The front of a few designs, in a few scenarios: a first idea; and how long the exact one may take from the question on.
    Coarse(LiveFront<'a>, Duration),
    /// The front of all designs in a few scenarios, most likely the exact one: it is being judged in all of them.
    Few(LiveFront<'a>),
    /// The exact front, each value over all scenarios.
    Exact(LiveFront<'a>),
    /// The same, computed once more by the f64 reference, which says in which scenario each value is the worst.
    Certified(LiveFront<'a>),
    /// What every design says.
    Counted(Box<LiveCounts>),
}

/// Designs of a front.
pub struct LiveFront<'a> {
    /// The plan of the study.
    pub plan: &'a Plan,
    /// The columns of the rows.
    pub columns: &'a [Column],
    /// The designs, best of the first objective first.
    pub rows: &'a [Row],
    /// Designs that were looked at, in how many draws each if that was not in all, and scenarios in which all of them were.
    pub looked_at: u64,
    /// Likewise.
    pub draws: Option<u64>,
    /// Likewise.
    pub scenarios: u64,
    /// How long it took.
    pub took: Duration,
}

/// What is known once every design was judged.
pub struct LiveCounts {
    /// Feasible designs; `None` where counting them would take too long.
    pub feasible: Option<u64>,
    /// A sample of them, where they were counted: in the columns of the study.
    pub sample: Vec<Row>,
    /// What the designs of the sample fail at.
    pub tally: Tally,
    /// What else a person should know.
    pub findings: Findings,
}

impl Live {
    /// For a study given as text, as [`Study::parse_in`] reads it.
    pub fn new(text: String, file: String, folder: PathBuf, threads: usize) -> Self {
        Self {
            text,
            file,
            folder,
            threads: threads.max(1),
            sets: Mutex::default(),
            judged: Mutex::default(),
            pace: Mutex::new(LivePace { swept: None, judged: None, slowness: SLOWNESS }),
        }
    }

    /// The study with changes, and its text.
    ///
    /// # Errors
    /// As [`Study::parse_set`]; [`Error::Request`] if it has no objective, so that there is no front.
    pub fn study(&self, set: &[String]) -> Result<(Study, String)> {
        let read = |text: &str| Study::parse_set(&Models::new(), text, &self.file, &self.folder, set);
        // A map may say no more what it shows once its objective does not count, or have too many cells. Nobody looks at maps here.
        let (study, text) = read(&self.text).or_else(|error| without_maps(&self.text).and_then(|text| read(&text).ok()).ok_or(error))?;
        if study.objectives.is_empty() {
            return Err(Error::Request(
                "the study has no objective, so that there is no front to look at; name one in [objectives]".to_owned(),
            ));
        }
        Ok((study, text))
    }

    /// The same for another text.
    #[must_use]
    pub fn with_text(self, text: String) -> Self {
        Self::new(text, self.file, self.folder, self.threads)
    }

    /// The text of the study.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The name of the file.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Where paths in it begin.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Worker threads.
    pub fn threads(&self) -> usize {
        self.threads
    }

    /// Answers for a plan, step by step; `control` stops it.
    ///
    /// # Errors
    /// [`Error::Stopped`] after `control.stop`, [`Error::FrontMemory`] and [`Error::FrontBudget`] if the front has too many designs, and
    /// those of `tell`.
    pub fn answer(&self, plan: &Plan, control: &Control, tell: &mut dyn FnMut(LiveAnswer<'_>) -> Result<()>) -> Result<()> {
        let start = Instant::now();
        let shape = shape(&plan.study);
        let held = |it: &Mutex<FxHashMap<Vec<u64>, WorkingSet>>| it.lock().unwrap_or_else(PoisonError::into_inner).get(&shape).cloned();
        let before = self.judged.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let mut search = FrontSearch::new(plan, self.threads, control, before);
        let seeds = coarse::seeds(plan, self.threads);
        let set = match held(&self.sets) {
            Some(set) => search.adopted(set, seeds)?,
            None => search.first_set(seeds)?,
        };
        let is_known = self.pace().swept.is_some();
        let drawn = if is_known { None } else { coarse::drawn_seconds(plan, self.threads, control)? };
        let expected = drawn.unwrap_or_else(|| self.expected(plan, set.count(plan.scenarios())));
        // Where only bounds have moved, the exact front comes soon.
        let is_soon = search.lacks(&set).is_some_and(|new| FEW_NEW * new <= set.count(plan.scenarios()));
        let is_long = expected > NOTICED.as_secs_f64() && !is_soon;
        if is_long && self.coarse(&mut search, &set, expected, start, control, tell)? {
            pause(control, coarse::to_be_seen(expected))?;
        }
        let designs = plan.designs();
        let (rows, set, next) = if is_by_bounds(plan, expected) {
            // Of very many designs most are settled in boxes.
            (search.feasible_of(&self.by_bounds(plan, control)?)?, WorkingSet::default(), WorkingSet::default())
        } else {
            search.exact(set, &mut |search, set, points, missing| {
                // The exact front comes before anybody has drawn this one.
                #[allow(clippy::cast_precision_loss, reason = "an estimate")]
                let work = (missing * plan.scenarios()) as f64;
                if self.pace().judged.is_some_and(|pace| pace * work < NOTICED.as_secs_f64()) {
                    return Ok(());
                }
                let (rows, scenarios) = (search.in_few(set, points)?, set.count(plan.scenarios()));
                let front = LiveFront {
                    plan,
                    columns: search.columns(),
                    rows: &rows,
                    looked_at: designs,
                    draws: None,
                    scenarios,
                    took: start.elapsed(),
                };
                tell(LiveAnswer::Few(front))
            })?
        };
        let scenarios = set.count(plan.scenarios());
        if scenarios > 0 {
            self.note(plan, search.times());
            self.sets.lock().unwrap_or_else(PoisonError::into_inner).insert(shape, next);
        }
        let front =
            LiveFront { plan, columns: search.columns(), rows: &rows, looked_at: designs, draws: None, scenarios, took: start.elapsed() };
        tell(LiveAnswer::Exact(front))?;
        *self.judged.lock().unwrap_or_else(PoisonError::into_inner) = search.judged();
        pause(control, PAUSE)?;
        // Now there is time for the reference, which also says in which scenario each value is the worst.
        let certified = search.certified(&rows)?;
        let front = LiveFront {
            plan,
            columns: search.columns(),
            rows: &certified,
            looked_at: plan.designs(),
            draws: None,
            scenarios,
            took: start.elapsed(),
        };
        tell(LiveAnswer::Certified(front))?;
        self.count(plan, &rows, control, tell)
    }

    /// The front by bounds, left where they do not pay.
    fn by_bounds(&self, plan: &Plan, control: &Control) -> Result<crate::reduce::Points> {
        let tables = Tables::new(plan);
        let ranges: Vec<_> = plan.study.report.histograms.iter().map(|it| it.range.unwrap_or((0.0, 1.0))).collect();
        let reduction = Reduction::new(plan, &ranges);
        let settings = Settings { threads: self.threads, ..Settings::default() };
        let rule = Rule { speed: Speed::quick(plan, self.threads), device: None, leaving: Leaving::WhereTheyDoNotPay };
        Ok(sweep_auto(plan, &tables, &reduction, &settings, None, control, &rule)?.swept.state.front)
    }

    /// Seconds that the front takes in so many scenarios.
    #[allow(clippy::cast_precision_loss, reason = "an estimate")]
    fn expected(&self, plan: &Plan, scenarios: u64) -> f64 {
        let told = plan.seconds_per_design() / plan.scenarios() as f64;
        let pace = self.pace().swept.unwrap_or(told);
        pace * plan.designs() as f64 * scenarios as f64 / self.threads as f64
    }

    #[allow(clippy::cast_precision_loss, reason = "an estimate")]
    fn note(&self, plan: &Plan, times: SearchTimes) {
        let of_thread = |scenarios: u64| self.threads as f64 / (plan.designs() as f64 * scenarios as f64);
        let swept = times.swept.map(|(took, scenarios)| took.as_secs_f64() * of_thread(scenarios));
        self.change_pace(|pace| {
            // A moment in which the machine has something else to do does not count in full.
            let last = pace.swept;
            pace.swept = swept.map(|now| last.map_or(now, |last| now.min((last * now).sqrt()))).or(last);
            pace.judged = times.judged.or(pace.judged);
        });
    }

    fn pace(&self) -> LivePace {
        *self.pace.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn change_pace(&self, change: impl FnOnce(&mut LivePace)) {
        change(&mut self.pace.lock().unwrap_or_else(PoisonError::into_inner));
    }

    /// What every design says. The front of the whole sweep must be the one that was told.
    fn count(&self, plan: &Plan, front: &[Row], control: &Control, tell: &mut dyn FnMut(LiveAnswer<'_>) -> Result<()>) -> Result<()> {
        let tables = Tables::new(plan);
        let tally = Tally::watched(plan, &tables, self.threads, control)?;
        #[allow(clippy::cast_precision_loss, reason = "an estimate")]
        let expected = plan.seconds_per_design() * plan.designs() as f64 / self.threads as f64;
        let mut feasible = front.is_empty().then_some(0);
        let mut sample = Vec::new();
        if feasible.is_none() && expected < COUNTED {
            let settings = Settings { threads: self.threads, ..Settings::default() };
            let state = sweep(plan, &tables, &Reduction::of_front_and_sample(plan, SAMPLED), &settings, None, control)?.state;
            let mut told: Vec<u64> = front.iter().map(|row| row.index).collect();
            let mut found = state.front.indices;
            told.sort_unstable();
            found.sort_unstable();
            if told != found {
                let problem = format!("the front in a few scenarios has {} designs, that of the whole sweep {}", told.len(), found.len());
                return Err(Error::Disagreement(problem));
            }
            feasible = Some(state.feasible);
            let designs = state.reported.samples.iter().flat_map(crate::reduce::FeasibleSample::indices).collect::<Vec<_>>();
            sample = certify::rows(plan, &certify::columns(&plan.study), &designs, self.threads, control)?;
        }
        let findings = Findings::of(plan, feasible.unwrap_or(1), front, self.threads, control)?;
        tell(LiveAnswer::Counted(Box::new(LiveCounts { feasible, sample, tally, findings })))
    }
}

/// Does the front come by bounds, where judging every design takes so many seconds?
fn is_by_bounds(plan: &Plan, expected: f64) -> bool {
    expected > LONG && refusal(plan).is_none()
}

/// The text of a study with no maps, if it has some.
fn without_maps(text: &str) -> Option<String> {
    let tree = DeTable::parse(text).ok()?;
    let DeValue::Table(report) = tree.get_ref().get("report")?.get_ref() else { return None };
    let (name, maps) = report.iter().find(|(name, _)| name.get_ref() == "maps")?;
    Some(format!("{}{}", &text[..name.span().start], &text[maps.span().end..]))
}

/// Waits for somebody who drags a slider on.
fn pause(control: &Control, duration: Duration) -> Result<()> {
    let begin = Instant::now();
    while begin.elapsed() < duration {
        if control.stop.load(Ordering::Relaxed) {
            return Err(Error::Stopped { kept: None });
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    Ok(())
}

/// The numbers of levels of the scenario axes.
fn shape(study: &Study) -> Vec<u64> {
    study.operation.iter().chain(&study.uncertainty).map(crate::study::Axis::count).collect()
}
