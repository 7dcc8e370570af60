//! The scenarios in which every design is judged: which of them, and how they become more.

use super::FrontSearch;
use crate::certify::{self, Role, Row};
use crate::error::Result;
use crate::plan::Plan;
use std::collections::BTreeMap;

/// Scenarios that join a working set at a time: those that most designs ask for.
const MOST_NEW: usize = 24;
/// A working set larger than this fraction of all scenarios is not worth it.
const WORTH: f64 = 0.3;
/// Designs that a first working set is made from.
const SEEDS: u64 = 48;
/// Fewer say nothing.
const FEWEST_SEEDS: u64 = 4;

/// The scenarios in which every design is judged, sorted; none stands for all.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WorkingSet {
    scenarios: Vec<u64>,
    is_all: bool,
}

impl WorkingSet {
    /// All scenarios.
    pub(in crate::live) fn all() -> Self {
        Self { scenarios: Vec::new(), is_all: true }
    }

    /// Are these all scenarios?
    pub(super) fn is_all(&self) -> bool {
        self.is_all
    }

    /// Number of scenarios, of so many.
    pub fn count(&self, of: u64) -> u64 {
        if self.is_all { of } else { self.scenarios.len() as u64 }
    }

    /// As slow and fast scenarios of a plan.
    pub(in crate::live) fn chosen(&self, plan: &Plan) -> Vec<(u64, u64)> {
        let place = |&scenario: &u64| (plan.slow_scenarios.index_of(scenario), plan.fast_scenarios.index_of(scenario));
        let mut chosen: Vec<_> = self.scenarios.iter().map(place).collect();
        chosen.sort_unstable();
        chosen
    }

    /// What it has beyond a smaller one; `None` if it lacks some of that, or either is all scenarios.
    pub(in crate::live) fn beyond(&self, smaller: &Self) -> Option<Self> {
        let has_all = smaller.scenarios.iter().all(|it| self.scenarios.binary_search(it).is_ok());
        let scenarios = || self.scenarios.iter().copied().filter(|it| smaller.scenarios.binary_search(it).is_err()).collect();
        (has_all && !self.is_all && !smaller.is_all).then(|| Self { scenarios: scenarios(), is_all: false })
    }

    /// Together with others.
    pub(in crate::live) fn joined_by(&self, others: &Self) -> Self {
        let mut scenarios = [&self.scenarios[..], &others.scenarios].concat();
        scenarios.sort_unstable();
        Self { scenarios, is_all: false }
    }

    /// Takes scenarios in; those that are asked for most often, if there are many. Tells whether there was a new one.
    pub(super) fn take(&mut self, asked: &BTreeMap<u64, usize>, of: u64) -> bool {
        if self.is_all {
            return false;
        }
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

impl FrontSearch<'_> {
    /// Does the front follow from single scenarios? Means, sums and draws need them all.
    pub fn allows_working_set(plan: &Plan) -> bool {
        !plan.study.decides_by_spectrum() && plan.study.probability.is_none()
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
    pub(in crate::live) fn only(&self, scenario: u64) -> WorkingSet {
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

    pub(super) fn asked_by(&mut self, designs: &[u64]) -> Result<BTreeMap<u64, usize>> {
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
}

/// A few scenarios of a plan: first and last levels of its axes, as far as they fit.
fn coarse_scenarios(plan: &Plan) -> impl Iterator<Item = u64> {
    let fast = plan.fast_scenarios.coarse(MOST_NEW.isqrt() as u64);
    let slow = plan.slow_scenarios.coarse((MOST_NEW / fast.len()) as u64);
    let number = |slow: u64, fast: u64| plan.slow_scenarios.source_index(slow) + plan.fast_scenarios.source_index(fast);
    slow.into_iter().flat_map(move |slow| fast.clone().into_iter().map(move |fast| number(slow, fast)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_of_too_many_scenarios_is_all_of_them_and_stays_so() {
        let asked = |scenarios: std::ops::Range<u64>| -> BTreeMap<u64, usize> { scenarios.map(|it| (it, 1)).collect() };
        let mut set = WorkingSet::default();
        assert!(set.take(&asked(0..24), 104) && set.count(104) == 24 && !set.is_all());
        assert!(!set.take(&asked(3..9), 104) && set.count(104) == 24);
        assert!(set.take(&asked(20..32), 104) && set == WorkingSet::all());
        assert!(!set.take(&asked(40..45), 104) && set == WorkingSet::all());
    }
}
