//! Rows of single designs: in a working set, over all scenarios, and by the f64 reference.

use super::{FrontSearch, UNKNOWN, WorkingSet};
use crate::certify::{self, AtWorst, Column, Role, Row};
use crate::error::{Error, Result};
use crate::live::followed::{followed, places_of, without_bounds};
use crate::live::lanes::ScenarioLanes;
use crate::parallel::on_threads;
use crate::plan::Plan;
use crate::reduce::Points;
use crate::screen::{CpuEngine, Tables};
use crate::study::{Constraint, Quantity};
use rustc_hash::FxHashSet;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// So many designs must be judged at a time for their pace to be known.
const TELLING: usize = 50;
/// Parts that the designs of a front are cut into, per thread.
const SCREENED_PARTS: usize = 6;
/// The same where each is judged over all scenarios at once; every part computes once more what all designs share.
const LANE_PARTS: usize = 4;

impl FrontSearch<'_> {
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
    pub(in crate::live) fn holds(&self, row: &Row) -> bool {
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

    /// Designs with their values over all scenarios, without those that have none in some; of feasible ones all are there.
    #[allow(clippy::cast_precision_loss, reason = "an estimate")]
    pub(super) fn judge_in_all(&mut self, designs: &[u64]) -> Result<Vec<Row>> {
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
}
