//! The exact front of a plan, found in a few scenarios and proven in all.
//!
//! Most designs fail, or are beaten, in the few scenarios that are the worst for the best designs. So every design is judged in a working
//! set of scenarios only, and the front of that is computed by the f64 reference in all scenarios. A value over fewer scenarios is never
//! worse than over all. So where the designs of that front are feasible, with the same values, in all scenarios, no other design can be on
//! the front: it fails in the working set, or one of them beats it there, and over all scenarios it only gets worse. Where one is not, the
//! scenarios that say so join the working set, and the search goes on.

use super::followed::{followed, places_of, without_bounds};
use super::lanes::ScenarioLanes;
use super::table::{WorstTable, free_plan, is_kept};
use crate::certify::{self, AtWorst, Column, Role, Row};
use crate::error::{Error, Result};
use crate::keys::KeyRule;
use crate::parallel::on_threads;
use crate::plan::Plan;
use crate::reduce::{Points, Reduction};
use crate::screen::{Control, CpuEngine, Tables};
use crate::study::{Constraint, Quantity};
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

/// Scenarios that join a working set at a time: those that most designs ask for.
const MOST_NEW: usize = 24;
/// A working set larger than this fraction of all scenarios is not worth it.
const WORTH: f64 = 0.3;
/// Designs that a first working set is made from.
const SEEDS: u64 = 48;
/// Fewer say nothing.
const FEWEST_SEEDS: u64 = 4;
/// Designs that say which scenarios are missing.
const MOST_ASKED: usize = 12;
/// Stands for a scenario that is not known.
pub(super) const UNKNOWN: u64 = u64::MAX;
/// Designs of a front that others are compared with first.
const FEW: u64 = 2000;
/// A grid has so many times the designs of the one whose front comes before its own.
const COARSER: u64 = 32;
/// The coarse grid of a table has at most one of so many rows.
const COARSE_SHARE: u64 = 8;
/// So many designs must be judged at a time for their pace to be known.
const TELLING: usize = 50;
/// Most designs that are kept for the next study.
const MOST_KEPT: usize = 100_000;
/// Parts that the designs are cut into, per thread.
const PARTS: usize = 24;
/// Parts that the designs of a front are cut into, per thread.
const SCREENED_PARTS: usize = 6;
/// The same where each is judged over all scenarios at once; every part computes once more what all designs share.
const LANE_PARTS: usize = 4;

/// The scenarios in which every design is judged, sorted; none stands for all.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WorkingSet {
    scenarios: Vec<u64>,
    is_all: bool,
}

impl WorkingSet {
    /// All scenarios.
    pub(super) fn all() -> Self {
        Self { scenarios: Vec::new(), is_all: true }
    }

    /// Number of scenarios, of so many.
    pub fn count(&self, of: u64) -> u64 {
        if self.is_all { of } else { self.scenarios.len() as u64 }
    }

    /// As slow and fast scenarios of a plan.
    pub(super) fn chosen(&self, plan: &Plan) -> Vec<(u64, u64)> {
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

impl JudgedRows {
    /// Is there nothing that serves?
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
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
    /// The plan that also follows what is shown, without the bounds that a value of one design can be held against later; its tables, and of
    /// each column where its values stand.
    shown: Plan,
    shown_tables: Tables,
    places: Vec<Vec<usize>>,
    /// The same without what is only reported, which may have no value for a design that is feasible all the same.
    judging: OnceLock<(Plan, Tables, Vec<Vec<usize>>)>,
    /// Judges single designs, where the formula allows it.
    lanes: Option<ScenarioLanes>,
    /// Designs with their values over all scenarios, whether they keep those bounds or not: of the study before, and new ones.
    judged_before: Arc<FxHashMap<u64, Row>>,
    judged: FxHashMap<u64, Row>,
    /// The plan without bounds, where its table is kept, its tables, and that table.
    free: Option<(Plan, Tables)>,
    table: Option<Arc<WorstTable>>,
    /// The front of the table's coarse grid in a working set, and how long it took.
    begun: Option<(WorkingSet, Points, Duration)>,
    times: SearchTimes,
}

/// How long a search took.
#[derive(Clone, Copy, Debug, Default)]
pub struct SearchTimes {
    /// The last look at every design, unless an older table served.
    pub swept: Option<Duration>,
    /// Seconds for one design of the front in one scenario, if enough were judged.
    pub judged: Option<f64>,
}

/// Designs that were judged in all scenarios, for the next study that differs in nothing but bounds.
#[derive(Clone, Debug, Default)]
pub struct JudgedRows {
    /// Of the study without these bounds.
    hash: String,
    rows: Arc<FxHashMap<u64, Row>>,
    /// What all designs are worth in the scenarios that decided.
    table: Option<Arc<WorstTable>>,
}

/// Designs to judge: the same places of each row.
struct SearchPart<'a> {
    rows: &'a [u64],
    places: &'a [u64],
}

impl<'p> FrontSearch<'p> {
    /// For a plan; `control` can stop it. What was judged before serves again if it fits.
    pub fn new(plan: &'p Plan, threads: usize, control: &'p Control, before: JudgedRows) -> Self {
        let columns = certify::columns(&plan.study);
        // What a study confirms with fresh draws is no output of the sweep.
        let shown = Plan::following(without_bounds(&plan.study), &followed(plan, &columns, |_| true));
        let free = Some(free_plan(&plan.study)).filter(|free| Self::allows_working_set(plan) && is_kept(free));
        let free = free.map(|free| {
            let tables = Tables::new(&free);
            (free, tables)
        });
        let table = before.table;
        let judged_before = if before.hash == shown.study.hash() { before.rows } else { Arc::default() };
        let places = places_of(&shown, &columns);
        Self {
            plan,
            tables: Tables::new(plan),
            shown_tables: Tables::new(&shown),
            lanes: ScenarioLanes::new(&shown),
            shown,
            places,
            judging: OnceLock::new(),
            reduction: Reduction::of_front(plan),
            columns,
            threads: threads.max(1),
            control,
            known: FxHashMap::default(),
            judged_before,
            judged: FxHashMap::default(),
            free,
            table,
            begun: None,
            times: SearchTimes::default(),
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

    /// What was judged, to be used again.
    pub fn judged(&self) -> JudgedRows {
        let mut rows = Arc::clone(&self.judged_before);
        if rows.len() + self.judged.len() > MOST_KEPT {
            rows = Arc::default();
        } else if !self.judged.is_empty() {
            Arc::make_mut(&mut rows).extend(self.judged.iter().map(|(&design, row)| (design, row.clone())));
        }
        JudgedRows { hash: self.shown.study.hash(), rows, table: self.table.clone() }
    }

    /// What all scenarios say of a design, if it was judged in them.
    fn judged_row(&self, design: u64) -> Option<&Row> {
        self.judged.get(&design).or_else(|| self.judged_before.get(&design))
    }

    /// How long it took.
    pub fn times(&self) -> SearchTimes {
        self.times
    }

    /// Is every design known in a working set, as in the last study that differed in nothing but bounds?
    pub fn knows_all_in(&self, set: &WorkingSet) -> bool {
        self.free.as_ref().is_some_and(|(free, _)| self.table.as_ref().is_some_and(|it| it.is_whole() && it.serves(free, set)))
    }

    /// The plan.
    pub fn plan(&self) -> &'p Plan {
        self.plan
    }

    /// The rows of the feasible ones of some designs, as [`FrontSearch::exact`] gives them.
    ///
    /// # Errors
    /// [`Error::Stopped`] after `control.stop`.
    pub fn feasible_of(&mut self, points: &Points) -> Result<Vec<Row>> {
        let mut rows = self.judge_in_all(&points.indices)?;
        rows.retain(|row| self.holds(row));
        certify::sort_front(self.plan, &self.columns, &mut rows);
        Ok(rows)
    }

    /// The front in a working set, with the values there.
    ///
    /// # Errors
    /// [`Error::Stopped`] after `control.stop`.
    pub fn in_few(&self, set: &WorkingSet, points: &Points) -> Result<Vec<Row>> {
        let chosen = set.chosen(self.plan);
        let mut rows = self.screened(&self.shown, &self.shown_tables, &chosen, &points.indices, &self.places)?;
        if rows.len() < points.indices.len() {
            let found: FxHashSet<u64> = rows.iter().map(|row| row.index).collect();
            let missing: Vec<u64> = points.indices.iter().copied().filter(|design| !found.contains(design)).collect();
            rows.extend(self.judged_without_report(&chosen, &missing)?);
        }
        certify::sort_front(self.plan, &self.columns, &mut rows);
        Ok(rows)
    }

    /// Designs of which a column of the report has no value in some scenario, without these columns.
    fn judged_without_report(&self, chosen: &[(u64, u64)], designs: &[u64]) -> Result<Vec<Row>> {
        let (plan, tables, places) = self.judging.get_or_init(|| {
            let followed = followed(self.plan, &self.columns, |column| column.role != Role::Report);
            let plan = Plan::following(without_bounds(&self.plan.study), &followed);
            let (tables, places) = (Tables::new(&plan), places_of(&plan, &self.columns));
            (plan, tables, places)
        });
        self.screened(plan, tables, chosen, designs, places)
    }

    /// Does a design keep the bounds of the study?
    pub(super) fn holds(&self, row: &Row) -> bool {
        let place = |it: &Constraint| certify::constraint_column(&self.columns, it, &it.name(&self.plan.study.model));
        self.plan.study.constraints.iter().all(|it| {
            let value = match (certify::design_input(&self.plan.study, it.quantity), it.quantity) {
                (Some(_), Quantity::Input(input)) => Some(row.inputs[input]),
                _ => place(it).and_then(|place| row.columns[place].value),
            };
            value.is_some_and(|value| it.holds(value))
        })
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

    /// A working set for a plan of which nothing is known: the scenarios that are the worst for some of its designs, at most so many; where
    /// too few would say anything, a coarse grid of scenarios.
    ///
    /// # Errors
    /// [`Error::Stopped`] after `control.stop`.
    pub fn first_set(&mut self, seeds: u64) -> Result<WorkingSet> {
        let of = self.plan.scenarios();
        let mut set = WorkingSet::default();
        if !Self::allows_working_set(self.plan) {
            return Ok(WorkingSet::all());
        }
        let count = SEEDS.min(self.plan.designs());
        let asked = if seeds < FEWEST_SEEDS.min(count) {
            coarse_scenarios(self.plan).map(|scenario| (scenario, 1)).collect()
        } else {
            let designs: Vec<u64> = (0..count.min(seeds)).map(|step| self.plan.design_at(self.plan.spread(step))).collect();
            self.asked_by(&designs)?
        };
        set.take(&asked, of);
        Ok(set)
    }

    /// One scenario as the working set.
    #[cfg(test)]
    pub(super) fn only(&self, scenario: u64) -> WorkingSet {
        WorkingSet { scenarios: vec![scenario], is_all: false }
    }

    /// A working set that served a plan like this one, or a first one of so many designs if it cannot serve this one.
    ///
    /// # Errors
    /// [`Error::Stopped`] after `control.stop`.
    pub fn adopted(&mut self, set: WorkingSet, seeds: u64) -> Result<WorkingSet> {
        let fits = set.scenarios.last().is_some_and(|&last| last < self.plan.scenarios());
        if fits && Self::allows_working_set(self.plan) { Ok(set) } else { self.first_set(seeds) }
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
        let next = AtomicUsize::new(0);
        let found = on_threads(0..self.threads, |_| {
            let mut engine = CpuEngine::new(self.plan, &self.tables).stopping_on(&self.control.stop);
            let mut own = self.reduction.start_after(seen.clone());
            while let Some(part) = parts.get(next.fetch_add(1, Ordering::Relaxed)) {
                if self.control.stop.load(Ordering::Relaxed) {
                    break;
                }
                engine.screen_rows(part.rows, part.places, &chosen, |block| self.reduction.absorb(&mut own, block));
            }
            own
        });
        self.go_on()?;
        Ok(self.reduction.front_together(found))
    }

    /// The front of at most so many designs of a coarser grid in a working set, and how many these are. What a table needs anyhow comes out of
    /// that.
    ///
    /// # Errors
    /// [`Error::Stopped`] after `control.stop`.
    pub fn coarse(&mut self, set: &WorkingSet, most: u64) -> Result<(Points, u64)> {
        match self.free.as_ref().map(|(free, _)| free.fast.count()) {
            Some(width) if width <= most => self.begin_table(set, most / width),
            _ => self.coarse_grid(set, most),
        }
    }

    /// The same without a table.
    ///
    /// Most of the time goes into designs that enter a front and are beaten later; so the front of a grid that is coarser still comes first.
    pub(super) fn coarse_grid(&self, set: &WorkingSet, most: u64) -> Result<(Points, u64)> {
        let seen = if most / COARSER < FEW { Points::default() } else { self.coarse_grid(set, most / COARSER)?.0 };
        let (slow, fast) = coarse_places(self.plan, most);
        Ok((self.front_in(set, &slow, &fast, seen)?, (slow.len() * fast.len()) as u64))
    }

    /// The front of a coarse grid of at most so many rows out of the table, which is begun if need be, and how many designs these are; none
    /// without a table.
    fn begin_table(&mut self, set: &WorkingSet, rows: u64) -> Result<(Points, u64)> {
        let Some((free, tables)) = &self.free else { return Ok((Points::default(), 0)) };
        let stop = &self.control.stop;
        let start = Instant::now();
        if !self.table.as_ref().is_some_and(|it| it.serves(free, set)) {
            let rows = rows.min(free.slow.count().div_ceil(COARSE_SHARE));
            self.table = WorstTable::begin(free, tables, set, rows, self.threads, stop).map(Arc::new);
        }
        let table = self.table.as_ref();
        let points = table.and_then(|it| it.coarse_front(free, &self.plan.study, self.threads, stop)).unwrap_or_default();
        let designs = table.map_or(0, |it| it.begun(free));
        self.go_on()?;
        self.begun = Some((set.clone(), points.clone(), start.elapsed()));
        Ok((points, designs))
    }

    /// The exact front, and the working set that has served to find it. `few` is told the front in the working set where some of it, of which
    /// it is told the number, must still be judged in all scenarios. Its values are those of the engine over all scenarios, of which it
    /// is not known which is the worst.
    ///
    /// # Errors
    /// [`Error::Stopped`] after `control.stop`.
    pub fn exact(
        &mut self,
        mut set: WorkingSet,
        few: &mut dyn FnMut(&Self, &WorkingSet, &Points, u64) -> Result<()>,
    ) -> Result<(Vec<Row>, WorkingSet)> {
        let rows: Vec<u64> = (0..self.plan.slow.count()).collect();
        let places: Vec<u64> = (0..self.plan.fast.count()).collect();
        let of = self.plan.scenarios();
        loop {
            let start = Instant::now();
            let is_known = self.knows_all_in(&set);
            let points = match self.front_by_table(&set)? {
                Some(points) => points,
                None => {
                    // What a few designs leave nothing of need not be kept until the end.
                    let (seen, _) = self.coarse_grid(&set, FEW)?;
                    self.front_in(&set, &rows, &places, seen)?
                }
            };
            let begun = self.begun.take().map_or(Duration::ZERO, |(.., took)| took);
            self.times.swept = (!is_known).then(|| begun + start.elapsed());
            let missing = points.indices.iter().filter(|&&design| self.judged_row(design).is_none()).count();
            if missing > 0 {
                few(self, &set, &points, missing as u64)?;
            }
            let mut front = self.judge_in_all(&points.indices)?;
            front.retain(|row| self.holds(row));
            let wrong = self.contradicted(&points, &front);
            if wrong.is_empty() {
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

    /// The front of all designs in a working set out of the table, which is made if need be; `None` if it would be too large.
    fn front_by_table(&mut self, set: &WorkingSet) -> Result<Option<Points>> {
        if self.free.is_none() {
            return Ok(None);
        }
        if !self.begun.as_ref().is_some_and(|it| it.0 == *set) {
            self.begin_table(set, u64::MAX)?;
        }
        let (Some((free, tables)), Some((_, coarse, _))) = (&self.free, &self.begun) else { return Ok(None) };
        let stop = &self.control.stop;
        if let Some(begun) = self.table.take_if(|it| !it.is_whole()) {
            self.table = begun.finish(free, tables, self.threads, stop).map(Arc::new);
        }
        let points = self.table.as_ref().and_then(|it| it.front(coarse.clone(), free, &self.plan.study, self.threads, stop));
        self.go_on()?;
        Ok(points)
    }

    /// Designs with their values over all scenarios, without those that have none in some; of feasible ones all are there.
    #[allow(clippy::cast_precision_loss, reason = "an estimate")]
    fn judge_in_all(&mut self, designs: &[u64]) -> Result<Vec<Row>> {
        let new = |it: &Self| -> Vec<u64> { designs.iter().copied().filter(|&design| it.judged_row(design).is_none()).collect() };
        let missing = new(self);
        let start = Instant::now();
        let found = match &self.lanes {
            Some(lanes) => self.in_lanes(lanes, &missing)?,
            None => self.screened(&self.shown, &self.shown_tables, &[], &missing, &self.places)?,
        };
        if missing.len() >= TELLING {
            self.times.judged = Some(start.elapsed().as_secs_f64() / (missing.len() as f64 * self.plan.scenarios() as f64));
        }
        self.judged.extend(found.into_iter().map(|row| (row.index, row)));
        let mut rows: Vec<Row> = designs.iter().filter_map(|&design| self.judged_row(design).cloned()).collect();
        let missing = new(self);
        if !missing.is_empty() {
            let found = self.judged_without_report(&[], &missing)?;
            self.judged.extend(found.iter().map(|row| (row.index, row.clone())));
            rows.extend(found);
        }
        Ok(rows)
    }

    /// The feasible ones of some designs, each over all scenarios at once.
    fn in_lanes(&self, lanes: &ScenarioLanes, designs: &[u64]) -> Result<Vec<Row>> {
        let mut positions: Vec<u64> = designs.iter().map(|&design| self.shown.position_of(design)).collect();
        positions.sort_unstable();
        let designs: Vec<u64> = positions.into_iter().map(|position| self.shown.design_at(position)).collect();
        self.in_parts(&designs, LANE_PARTS, |parts| {
            parts.flat_map(|part| lanes.judge(&self.shown, &self.columns, part, &self.control.stop)).collect()
        })
    }

    fn go_on(&self) -> Result<()> {
        if self.control.stop.load(Ordering::Relaxed) { Err(Error::Stopped { kept: None }) } else { Ok(()) }
    }

    /// The feasible ones of some designs, with the values that a plan follows.
    fn screened(&self, plan: &Plan, tables: &Tables, chosen: &[(u64, u64)], designs: &[u64], places: &[Vec<usize>]) -> Result<Vec<Row>> {
        // Designs of a row, and rows that share much, next to each other.
        let mut positions: Vec<u64> = designs.iter().map(|&design| plan.position_of(design)).collect();
        positions.sort_unstable();
        self.in_parts(&positions, SCREENED_PARTS, |parts| {
            let mut engine = CpuEngine::new(plan, tables).stopping_on(&self.control.stop);
            let mut rows = Vec::new();
            for part in parts {
                engine.screen_some_in(chosen, part, |block| {
                    for lane in block.feasible() {
                        let value = |(column, places): (&Column, &Vec<usize>)| {
                            let values = places.iter().map(|&place| block.column(place)[lane] + 0.0);
                            AtWorst { value: column.worst_of(values), scenario: UNKNOWN }
                        };
                        let columns: Vec<_> = self.columns.iter().zip(places).map(value).collect();
                        rows.push(Row::seen(plan, block.index(lane), columns));
                    }
                });
            }
            rows
        })
    }

    /// What `work` makes of some designs, or positions of designs, cut into so many parts per thread: it is given those that one thread
    /// takes, one after the other, so that no thread waits long for another one.
    fn in_parts<'a>(
        &self,
        designs: &'a [u64],
        count: usize,
        work: impl Fn(&mut dyn Iterator<Item = &'a [u64]>) -> Vec<Row> + Sync,
    ) -> Result<Vec<Row>> {
        let parts: Vec<&[u64]> = designs.chunks(designs.len().div_ceil(count * self.threads).max(1)).collect();
        let (next, stop) = (AtomicUsize::new(0), &self.control.stop);
        let take = || parts.get(next.fetch_add(1, Ordering::Relaxed)).filter(|_| !stop.load(Ordering::Relaxed)).copied();
        let found = on_threads(0..self.threads, |_| work(&mut std::iter::from_fn(take)));
        self.go_on()?;
        Ok(found.into_iter().flatten().collect())
    }

    /// The designs of a front in a working set of which all scenarios say something else.
    fn contradicted(&self, points: &Points, front: &[Row]) -> Vec<u64> {
        let judged: FxHashMap<u64, &Row> = front.iter().map(|row| (row.index, row)).collect();
        let objectives = &self.plan.study.objectives;
        let rules: Vec<_> = objectives.iter().map(KeyRule::from).collect();
        let places = certify::objective_columns(&self.plan.study, &self.columns);
        let is_wrong = |(design, keys): &(&u64, &[f64])| {
            let same = |row: &Row| {
                let mut each = rules.iter().zip(&places).zip(*keys);
                each.all(|((rule, &place), &seen)| rule.key(row.columns[place].value.unwrap_or(f64::NAN)) == seen)
            };
            !judged.get(design).copied().is_some_and(same)
        };
        let all = points.indices.iter().zip(points.keys.chunks(objectives.len().max(1)));
        all.filter(is_wrong).map(|(&design, _)| design).collect()
    }
}

/// A few scenarios of a plan: first and last levels of its axes, as far as they fit.
fn coarse_scenarios(plan: &Plan) -> impl Iterator<Item = u64> {
    let fast = plan.fast_scenarios.coarse(MOST_NEW.isqrt() as u64);
    let slow = plan.slow_scenarios.coarse((MOST_NEW / fast.len()) as u64);
    let number = |slow: u64, fast: u64| plan.slow_scenarios.source_index(slow) + plan.fast_scenarios.source_index(fast);
    slow.into_iter().flat_map(move |slow| fast.clone().into_iter().map(move |fast| number(slow, fast)))
}

/// The rows and places of a grid of at most so many designs.
pub(super) fn coarse_places(plan: &Plan, most: u64) -> (Vec<u64>, Vec<u64>) {
    let fast = plan.fast.coarse(most.isqrt().max(most / plan.slow.count().max(1)));
    let slow = plan.slow.coarse((most / fast.len().max(1) as u64).max(1));
    (slow, fast)
}

/// Rows and places cut into about so many parts.
fn parts<'a>(rows: &'a [u64], places: &'a [u64], count: usize) -> Vec<SearchPart<'a>> {
    let by_rows = rows.len().div_ceil(count).max(1);
    let cuts = count.div_ceil(rows.len().max(1)).max(1);
    let by_places = places.len().div_ceil(cuts).max(1);
    rows.chunks(by_rows).flat_map(|rows| places.chunks(by_places).map(move |places| SearchPart { rows, places })).collect()
}
