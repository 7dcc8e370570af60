//! The exact front of a plan, found in a few scenarios and proven in all.
//!
//! Most designs fail, or are beaten, in the few scenarios that are the worst for the best designs. So every design is judged in a working
//! set of scenarios only, and the front of that is computed by the f64 reference in all scenarios. A value over fewer scenarios is never
//! worse than over all. So where the designs of that front are feasible, with the same values, in all scenarios, no other design can be on
//! the front: it fails in the working set, or one of them beats it there, and over all scenarios it only gets worse. Where one is not, it
//! counts with its values in all scenarios from then on, and the search goes on; after a few times the scenarios that say so join the
//! working set.

mod judging;
mod working_set;

pub use working_set::WorkingSet;

use super::followed::{followed, places_of, without_bounds};
use super::lanes::ScenarioLanes;
use super::table::{TableBeside, WorstTable, free_plan, is_kept};
use crate::certify::{self, Column, Row};
use crate::error::{Error, Result};
use crate::keys::KeyRule;
use crate::parallel::on_threads;
use crate::plan::Plan;
use crate::reduce::{Points, Reduction};
use crate::screen::{BLOCK, Block, Control, CpuEngine, Tables};
use rustc_hash::{FxHashMap, FxHashSet};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

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
/// Most designs that are kept for the next study.
const MOST_KEPT: usize = 100_000;
/// How often the front is found again with the values that its designs have in all scenarios, before scenarios join the working set.
const ROUNDS: usize = 3;
/// Parts that the designs are cut into, per thread.
const PARTS: usize = 24;

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
    /// The last look at every design, unless an older table served, and in how many scenarios.
    pub swept: Option<(Duration, u64)>,
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

impl JudgedRows {
    /// Is there nothing that serves?
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }
}

/// Designs that were judged in all scenarios while the front was looked for. Some of them have worse values there than in the working set:
/// what only these had beaten may be on the front after all. What the others beat stays beaten, as more scenarios make no value better.
#[derive(Debug, Default)]
struct JudgedMeanwhile {
    /// How often some of a front have turned out to be worse.
    rounds: usize,
    designs: FxHashSet<u64>,
    /// Those that are feasible.
    rows: Vec<Row>,
}

impl JudgedMeanwhile {
    /// Takes in the designs of a front, of which these are feasible in all scenarios.
    fn take(&mut self, designs: &[u64], feasible: Vec<Row>) {
        self.rounds += 1;
        self.rows.extend(feasible.into_iter().filter(|row| !self.designs.contains(&row.index)));
        self.designs.extend(designs);
    }
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

    /// In how many scenarios of a working set designs must still be judged, where every design is known in the others: in none if the last
    /// study differed in nothing but bounds.
    pub fn lacks(&self, set: &WorkingSet) -> Option<u64> {
        let ((free, _), table) = (self.free.as_ref()?, self.table.as_ref().filter(|it| it.is_whole())?);
        if table.serves(free, set) { Some(0) } else { table.lacks(free, set).map(|new| new.count(self.plan.scenarios())) }
    }

    /// The plan.
    pub fn plan(&self) -> &'p Plan {
        self.plan
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
        if let Some((table, new)) = self.table.as_ref().and_then(|it| Some((it, it.lacks(free, set)?))) {
            self.table = table.joined_by(free, tables, &new, self.threads, stop).map(Arc::new);
        } else if !self.table.as_ref().is_some_and(|it| it.serves(free, set)) {
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

    /// The exact front, the working set that has served to find it, and the one that may serve the next study better. `few` is told the front
    /// in the working set where some of it, of which it is told the number, must still be judged in all scenarios. Its values are those of
    /// the engine over all scenarios, of which it is not known which is the worst.
    ///
    /// # Errors
    /// [`Error::Stopped`] after `control.stop`.
    pub fn exact(
        &mut self,
        mut set: WorkingSet,
        few: &mut dyn FnMut(&Self, &WorkingSet, &Points, u64) -> Result<()>,
    ) -> Result<(Vec<Row>, WorkingSet, WorkingSet)> {
        let rows: Vec<u64> = (0..self.plan.slow.count()).collect();
        let places: Vec<u64> = (0..self.plan.fast.count()).collect();
        let of = self.plan.scenarios();
        let mut next = set.clone();
        let mut meanwhile = JudgedMeanwhile::default();
        loop {
            let start = Instant::now();
            // The time of a few scenarios says nothing of all.
            let is_known = self.lacks(&set).is_some();
            let points = match self.front_by_table(&set, &meanwhile)? {
                Some(points) => points,
                None => {
                    // What a few designs leave nothing of need not be kept until the end.
                    let (seen, _) = self.coarse_grid(&set, FEW)?;
                    self.front_in(&set, &rows, &places, seen)?
                }
            };
            let begun = self.begun.take().map_or(Duration::ZERO, |(.., took)| took);
            if !is_known {
                self.times.swept = Some((begun + start.elapsed(), set.count(of)));
            }
            let missing = points.indices.iter().filter(|&&design| self.judged_row(design).is_none()).count();
            // From the second time on some designs count with their values in all scenarios; those in a few would show another front.
            if missing > 0 && meanwhile.rounds == 0 {
                few(self, &set, &points, missing as u64)?;
            }
            let mut front = self.judge_in_all(&points.indices)?;
            front.retain(|row| self.holds(row));
            let wrong = self.contradicted(&points, &front);
            if wrong.is_empty() {
                certify::sort_front(self.plan, &self.columns, &mut front);
                return Ok((front, set, next));
            }
            if set.is_all() {
                let problem = format!("{} designs of the front have other values when they are judged alone", wrong.len());
                return Err(Error::Disagreement(problem));
            }
            // A few of them say which scenarios are missing.
            let step = wrong.len().div_ceil(MOST_ASKED);
            let some: Vec<u64> = wrong.into_iter().step_by(step).collect();
            let is_new = next.take(&self.asked_by(&some)?, of);
            if self.lacks(&set) == Some(0) && meanwhile.rounds < ROUNDS {
                meanwhile.take(&points.indices, front);
                continue;
            }
            if !is_new && next == set {
                next = WorkingSet::all();
            }
            (set, meanwhile) = (next.clone(), JudgedMeanwhile::default());
        }
    }

    /// The front of all designs in a working set out of the table, which is made if need be; `None` if it would be too large. Designs that
    /// were judged in all scenarios meanwhile count with what these say.
    fn front_by_table(&mut self, set: &WorkingSet, meanwhile: &JudgedMeanwhile) -> Result<Option<Points>> {
        if self.free.is_none() {
            return Ok(None);
        }
        if let (Some((free, _)), Some(table), true) = (&self.free, &self.table, meanwhile.rounds > 0) {
            let known = self.front_of(free, &meanwhile.rows);
            let beside = TableBeside { points: known, without: Some(&meanwhile.designs) };
            let points = table.front_beside(beside, free, &self.plan.study, self.threads, &self.control.stop);
            self.go_on()?;
            return Ok(points);
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

    /// The front of some designs by the values in these rows.
    fn front_of(&self, free: &Plan, rows: &[Row]) -> Points {
        let reduction = Reduction::of_front(free);
        let places = certify::objective_columns(&self.plan.study, &self.columns);
        let mut reducers = reduction.start();
        let mut values = vec![Vec::new(); free.tracked.len()];
        for rows in rows.chunks(BLOCK) {
            for (&column, &place) in free.objectives.iter().zip(&places) {
                values[column] = rows.iter().map(|row| row.columns[place].value.unwrap_or(f64::NAN)).collect();
            }
            let offsets: Vec<u64> = rows.iter().map(|row| row.index).collect();
            let alive = vec![u64::MAX; rows.len()];
            let feasible_count = rows.len() as u64;
            reduction.absorb_objectives(
                &mut reducers,
                &Block { row_index: 0, offsets: &offsets, feasible_count, alive: &alive, values: &values },
            );
        }
        reduction.front_together(vec![reducers])
    }

    fn go_on(&self) -> Result<()> {
        if self.control.stop.load(Ordering::Relaxed) { Err(Error::Stopped { kept: None }) } else { Ok(()) }
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
