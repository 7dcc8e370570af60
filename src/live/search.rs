//! The exact front of a plan, found in a few scenarios and proven in all.
//!
//! Most designs fail, or are beaten, in the few scenarios that are the worst for the best designs. So every design is judged in a working
//! set of scenarios only, and the front of that is computed by the f64 reference in all scenarios. A value over fewer scenarios is never
//! worse than over all. So where the designs of that front are feasible, with the same values, in all scenarios, no other design can be on
//! the front: it fails in the working set, or one of them beats it there, and over all scenarios it only gets worse. Where one is not, the
//! scenarios that say so join the working set, and the search goes on.

use crate::certify::{self, AtWorst, Column, Role, Row};
use crate::error::{Error, Result};
use crate::keys::KeyRule;
use crate::parallel::on_threads;
use crate::plan::{Plan, Tracked};
use crate::reduce::{Points, Reduction};
use crate::screen::{Control, CpuEngine, Tables};
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Scenarios that join a working set at a time: those that most designs ask for.
const MOST_NEW: usize = 24;
/// A working set larger than this fraction of all scenarios is not worth it.
const WORTH: f64 = 0.3;
/// Designs that a first working set is made from.
const SEEDS: u64 = 48;
/// Designs that say which scenarios are missing.
const MOST_ASKED: usize = 12;
/// Stands for a scenario that is not known.
const UNKNOWN: u64 = u64::MAX;
/// Parts that the designs are cut into, per thread.
const PARTS: usize = 24;

/// The scenarios in which every design is judged, sorted; none stands for all.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WorkingSet {
    scenarios: Vec<u64>,
    is_all: bool,
}

impl WorkingSet {
    /// All scenarios.
    fn all() -> Self {
        Self { scenarios: Vec::new(), is_all: true }
    }

    /// Number of scenarios, of so many.
    pub fn count(&self, of: u64) -> u64 {
        if self.is_all { of } else { self.scenarios.len() as u64 }
    }

    /// As slow and fast scenarios of a plan.
    fn chosen(&self, plan: &Plan) -> Vec<(u64, u64)> {
        let place = |&scenario: &u64| (plan.slow_scenarios.index_of(scenario), plan.fast_scenarios.index_of(scenario));
        let mut chosen: Vec<_> = self.scenarios.iter().map(place).collect();
        chosen.sort_unstable();
        chosen
    }

    /// Takes scenarios in; those that are asked for most often, if there are many. Tells whether there was a new one.
    fn take(&mut self, asked: &BTreeMap<u64, usize>, of: u64) -> bool {
        let mut new: Vec<_> = asked.iter().filter(|(scenario, _)| !self.scenarios.contains(scenario)).collect();
        new.sort_by_key(|&(&scenario, &count)| (std::cmp::Reverse(count), scenario));
        self.scenarios.extend(new.iter().take(MOST_NEW).map(|(scenario, _)| **scenario));
        self.scenarios.sort_unstable();
        #[allow(clippy::cast_precision_loss, reason = "a rule of thumb")]
        if self.scenarios.len() as f64 > WORTH * of as f64 {
            *self = Self::all();
        }
        !new.is_empty()
    }
}

/// Looks for the front of a plan.
#[derive(Debug)]
pub struct FrontSearch<'p> {
    plan: &'p Plan,
    tables: Tables,
    reduction: Reduction,
    columns: Vec<Column>,
    threads: usize,
    control: &'p Control,
    /// What the f64 reference says of designs.
    known: FxHashMap<u64, Row>,
    /// The plan that also follows what is shown, its tables, and of each column where its values stand.
    shown: Plan,
    shown_tables: Tables,
    places: Vec<Vec<usize>>,
}

/// Designs to judge: the same places of each row.
struct Part<'a> {
    rows: &'a [u64],
    places: &'a [u64],
}

impl<'p> FrontSearch<'p> {
    /// For a plan; `control` can stop it.
    pub fn new(plan: &'p Plan, threads: usize, control: &'p Control) -> Self {
        let columns = certify::columns(&plan.study);
        // What a study confirms with fresh draws is no output of the sweep.
        let is_output = |column: &&Column| plan.study.confirmed(column.quantity).is_none();
        let followed: Vec<Tracked> = columns.iter().filter(is_output).flat_map(Column::followed).collect();
        let shown = Plan::following(plan.study.clone(), &followed);
        let place = |wanted: &Tracked| shown.tracked.iter().position(|(it, _)| it == wanted);
        let places = columns.iter().map(|column| column.followed().iter().filter_map(place).collect()).collect();
        Self {
            plan,
            tables: Tables::new(plan),
            shown_tables: Tables::new(&shown),
            shown,
            places,
            reduction: Reduction::of_front(plan),
            columns,
            threads: threads.max(1),
            control,
            known: FxHashMap::default(),
        }
    }

    /// Does the front follow from single scenarios? Means, sums and draws need them all.
    pub fn allows_working_set(plan: &Plan) -> bool {
        !plan.study.decides_by_spectrum() && plan.study.probability.is_none()
    }

    /// The columns of the rows that it finds.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// The plan.
    pub fn plan(&self) -> &'p Plan {
        self.plan
    }

    /// The rows of the feasible ones of some designs, as [`FrontSearch::exact`] gives them.
    ///
    /// # Errors
    /// [`Error::Stopped`] after `control.stop`.
    pub fn feasible_of(&self, points: &Points) -> Result<Vec<Row>> {
        let mut judged = FxHashMap::default();
        self.judge_in_all(&points.indices, &mut judged)?;
        let mut rows: Vec<Row> = judged.into_values().collect();
        certify::sort_front(self.plan, &self.columns, &mut rows);
        Ok(rows)
    }

    /// The same rows by the f64 reference, with the scenario of each value.
    ///
    /// # Errors
    /// [`Error::Stopped`] after `control.stop`; [`Error::Disagreement`] if it finds another value.
    pub fn certified(&self, rows: &[Row]) -> Result<Vec<Row>> {
        let designs: Vec<u64> = rows.iter().map(|row| row.index).collect();
        let certified = certify::rows(self.plan, &self.columns, &designs, self.threads, self.control)?;
        for (seen, row) in rows.iter().zip(&certified) {
            certify::check_feasible(row)?;
            for ((column, seen), at) in self.columns.iter().zip(&seen.columns).zip(&row.columns) {
                if seen.value.is_some() && seen.value != at.value {
                    let name = &column.name;
                    return Err(Error::Disagreement(format!(
                        "{name} of design {}: the search found {:?}, the f64 reference gives {:?}",
                        row.index, seen.value, at.value
                    )));
                }
            }
        }
        Ok(certified)
    }

    /// A working set for a plan of which nothing is known: the scenarios that are the worst for some of its designs.
    ///
    /// # Errors
    /// [`Error::Stopped`] after `control.stop`.
    pub fn first_set(&mut self) -> Result<WorkingSet> {
        let of = self.plan.scenarios();
        let mut set = WorkingSet::default();
        if !Self::allows_working_set(self.plan) {
            return Ok(WorkingSet::all());
        }
        let designs: Vec<u64> = (0..SEEDS.min(self.plan.designs())).map(|step| self.plan.design_at(self.plan.spread(step))).collect();
        let asked = self.asked_by(&designs)?;
        set.take(&asked, of);
        Ok(set)
    }

    /// A working set that served a plan like this one, or another if it cannot serve this one.
    ///
    /// # Errors
    /// [`Error::Stopped`] after `control.stop`.
    pub fn adopted(&mut self, set: WorkingSet) -> Result<WorkingSet> {
        let fits = set.scenarios.last().is_some_and(|&last| last < self.plan.scenarios());
        if fits && Self::allows_working_set(self.plan) { Ok(set) } else { self.first_set() }
    }

    fn asked_by(&mut self, designs: &[u64]) -> Result<BTreeMap<u64, usize>> {
        self.look_up(designs)?;
        let mut asked = BTreeMap::new();
        for design in designs {
            self.worst_of(&self.known[design], &mut asked);
        }
        Ok(asked)
    }

    /// The scenarios in which a design is at its worst.
    fn worst_of(&self, row: &Row, asked: &mut BTreeMap<u64, usize>) {
        if let Some(scenario) = row.first_without {
            *asked.entry(scenario).or_default() += 1;
        }
        let judged = self.columns.iter().zip(&row.columns).filter(|(column, _)| column.role != Role::Report);
        for (_, at) in judged.filter(|(_, at)| at.value.is_some()) {
            *asked.entry(at.scenario).or_default() += 1;
        }
    }

    /// Computes designs by the f64 reference, unless that was done.
    fn look_up(&mut self, designs: &[u64]) -> Result<()> {
        let new: Vec<u64> = designs.iter().copied().filter(|design| !self.known.contains_key(design)).collect();
        let rows = certify::rows(self.plan, &self.columns, &new, self.threads, self.control)?;
        self.known.extend(rows.into_iter().map(|row| (row.index, row)));
        Ok(())
    }

    /// The front of some designs in a working set: rows of the slow axes and places of the fast ones; `seen` may be a part of it.
    fn front_in(&self, set: &WorkingSet, rows: &[u64], places: &[u64], seen: Points) -> Result<Points> {
        let chosen = set.chosen(self.plan);
        let parts = parts(rows, places, PARTS * self.threads);
        let (next, merged) = (AtomicUsize::new(0), Mutex::new(self.reduction.start_after(seen)));
        on_threads(0..self.threads, |_| {
            let mut engine = CpuEngine::new(self.plan, &self.tables).stopping_on(&self.control.stop);
            loop {
                let Some(part) = parts.get(next.fetch_add(1, Ordering::Relaxed)) else { return };
                if self.control.stop.load(Ordering::Relaxed) {
                    return;
                }
                let known = merged.lock().unwrap_or_else(PoisonError::into_inner).front.points().clone();
                let mut own = self.reduction.start_after(known);
                engine.screen_rows(part.rows, part.places, &chosen, |block| self.reduction.absorb(&mut own, block));
                merged.lock().unwrap_or_else(PoisonError::into_inner).merge(own.into_fresh());
            }
        });
        if self.control.stop.load(Ordering::Relaxed) {
            return Err(Error::Stopped { kept: None });
        }
        let mut merged = merged.into_inner().unwrap_or_else(PoisonError::into_inner);
        Ok(merged.front.points().clone())
    }

    /// The front of at most so many designs of a coarser grid in a working set.
    ///
    /// # Errors
    /// [`Error::Stopped`] after `control.stop`.
    pub fn coarse(&self, set: &WorkingSet, most: u64) -> Result<Points> {
        let fast = self.plan.fast.coarse(most.isqrt().max(most / self.plan.slow.count().max(1)));
        let slow = self.plan.slow.coarse((most / fast.len().max(1) as u64).max(1));
        self.front_in(set, &slow, &fast, Points::default())
    }

    /// The exact front, and the working set that has served to find it. Its values are those of the engine over all scenarios, of which it
    /// is not known which is the worst.
    ///
    /// # Errors
    /// [`Error::Stopped`] after `control.stop`.
    pub fn exact(&mut self, mut set: WorkingSet) -> Result<(Vec<Row>, WorkingSet)> {
        let rows: Vec<u64> = (0..self.plan.slow.count()).collect();
        let places: Vec<u64> = (0..self.plan.fast.count()).collect();
        let of = self.plan.scenarios();
        let mut judged = FxHashMap::default();
        loop {
            let t0 = std::time::Instant::now();
            let points = self.front_in(&set, &rows, &places, Points::default())?;
            if std::env::var_os("TIMES").is_some() { eprintln!("front_in {:?} {}", t0.elapsed(), set.count(of)); }
            let t0 = std::time::Instant::now();
            self.judge_in_all(&points.indices, &mut judged)?;
            let wrong = self.contradicted(&points, &judged);
            if std::env::var_os("TIMES").is_some() { eprintln!("judge {:?} wrong {}", t0.elapsed(), wrong.len()); }
            if wrong.is_empty() {
                let mut front: Vec<Row> = points.indices.iter().filter_map(|design| judged.remove(design)).collect();
                certify::sort_front(self.plan, &self.columns, &mut front);
                return Ok((front, set));
            }
            if set.is_all {
                let problem = format!("{} designs of the front have other values when they are judged alone", wrong.len());
                return Err(Error::Disagreement(problem));
            }
            // A few of them say which scenarios are missing.
            let step = wrong.len().div_ceil(MOST_ASKED);
            let some: Vec<u64> = wrong.into_iter().step_by(step).collect();
            if !set.take(&self.asked_by(&some)?, of) {
                set = WorkingSet::all();
            }
        }
    }

    /// Judges designs in all scenarios, unless that was done; the feasible ones are put among those that are `judged`.
    fn judge_in_all(&self, designs: &[u64], judged: &mut FxHashMap<u64, Row>) -> Result<()> {
        let mut positions: Vec<u64> =
            designs.iter().filter(|design| !judged.contains_key(design)).map(|&design| self.plan.position_of(design)).collect();
        positions.sort_unstable();
        let found = self.screened(&self.shown, &self.shown_tables, &positions, &self.places)?;
        judged.extend(found.into_iter().map(|row| (row.index, row)));
        positions.retain(|&position| !judged.contains_key(&self.plan.design_at(position)));
        if positions.is_empty() {
            return Ok(());
        }
        // Some columns may have no value for a design that is feasible all the same.
        let place = |wanted: &Tracked| self.plan.tracked.iter().position(|(it, _)| it == wanted);
        let places: Vec<Vec<usize>> = self.columns.iter().map(|column| column.followed().iter().filter_map(place).collect()).collect();
        let found = self.screened(self.plan, &self.tables, &positions, &places)?;
        judged.extend(found.into_iter().map(|row| (row.index, row)));
        Ok(())
    }

    /// The feasible ones of some designs at these sorted positions, with the values that a plan follows.
    fn screened(&self, plan: &Plan, tables: &Tables, positions: &[u64], places: &[Vec<usize>]) -> Result<Vec<Row>> {
        let share = positions.len().div_ceil(self.threads).max(1);
        let parts = on_threads(positions.chunks(share), |part| {
            let mut engine = CpuEngine::new(plan, tables).stopping_on(&self.control.stop);
            let mut rows = Vec::with_capacity(part.len());
            engine.screen_some(part, |block| {
                for lane in block.feasible() {
                    let value = |(column, places): (&Column, &Vec<usize>)| {
                        let values = places.iter().map(|&place| block.column(place)[lane] + 0.0);
                        AtWorst { value: column.worst_of(values), scenario: UNKNOWN }
                    };
                    let columns: Vec<_> = self.columns.iter().zip(places).map(value).collect();
                    rows.push(Row::seen(plan, block.index(lane), columns));
                }
            });
            rows
        });
        if self.control.stop.load(Ordering::Relaxed) {
            return Err(Error::Stopped { kept: None });
        }
        Ok(parts.into_iter().flatten().collect())
    }

    /// The designs of a front in a working set of which all scenarios say something else.
    fn contradicted(&self, points: &Points, judged: &FxHashMap<u64, Row>) -> Vec<u64> {
        let objectives = &self.plan.study.objectives;
        let rules: Vec<_> = objectives.iter().map(KeyRule::from).collect();
        let places = certify::objective_columns(&self.plan.study, &self.columns);
        let is_wrong = |(design, keys): &(&u64, &[f64])| {
            let same = |row: &Row| {
                let mut each = rules.iter().zip(&places).zip(*keys);
                each.all(|((rule, &place), &seen)| rule.key(row.columns[place].value.unwrap_or(f64::NAN)) == seen)
            };
            !judged.get(design).is_some_and(same)
        };
        let all = points.indices.iter().zip(points.keys.chunks(objectives.len().max(1)));
        all.filter(is_wrong).map(|(&design, _)| design).collect()
    }
}

/// Rows and places cut into about so many parts.
fn parts<'a>(rows: &'a [u64], places: &'a [u64], count: usize) -> Vec<Part<'a>> {
    let by_rows = rows.len().div_ceil(count).max(1);
    let cuts = count.div_ceil(rows.len().max(1)).max(1);
    let by_places = places.len().div_ceil(cuts).max(1);
    rows.chunks(by_rows).flat_map(|rows| places.chunks(by_places).map(move |places| Part { rows, places })).collect()
}
