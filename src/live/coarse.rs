//! The first idea of an answer that takes long: fewer designs, fewer draws of each, fewer scenarios.

use super::search::{FrontSearch, JudgedRows, WorkingSet, coarse_places};
use super::{Live, LiveAnswer, LiveFront, NOTICED, is_by_bounds};
use crate::certify::{Row, objective_columns};
use crate::error::Result;
use crate::keys::KeyRule;
use crate::plan::Plan;
use crate::reduce::{Points, beats};
use crate::screen::Control;
use std::time::{Duration, Instant};

/// Seconds that it may take.
const COARSELY: f64 = 0.02;
/// Most designs that it has; and fewest: of still fewer often none is feasible. With more threads each has one.
const FEW: u64 = 2000;
const FEWEST: u64 = 4;
/// Each further idea has so many times the designs of the one before, as long as the last is no more than a share of all.
const FINER: u64 = 8;
const MOST_SHARE: u64 = 16;
/// Draws of a design that it always has: so many are computed together.
const FEWEST_DRAWS: u64 = 256;
/// Seconds after which a page has drawn it.
const DRAWN: f64 = 0.1;
/// How many times as long as the engine the f64 reference takes for a design.
const REFERENCE: f64 = 4.0;

impl Live {
    /// Tells fronts of coarser grids, where the exact one takes `expected` seconds; false if there are none.
    pub(super) fn coarse(
        &self,
        search: &mut FrontSearch<'_>,
        set: &WorkingSet,
        expected: f64,
        start: Instant,
        control: &Control,
        tell: &mut dyn FnMut(LiveAnswer<'_>) -> Result<()>,
    ) -> Result<bool> {
        let plan = search.plan();
        let rest = Duration::try_from_secs_f64(expected).unwrap_or(Duration::MAX / 4) + to_be_seen(expected);
        let mut tell_of = |search: &FrontSearch<'_>, rows: &[Row], looked_at, draws| {
            let scenarios = set.count(plan.scenarios());
            let (plan, columns) = (search.plan(), search.columns());
            let front = LiveFront { plan, columns, rows, looked_at, draws, scenarios, took: start.elapsed() };
            tell(LiveAnswer::Coarse(front, start.elapsed() + rest))
        };
        if let Some((few_draws, draws, expected)) = with_few_draws(plan, expected) {
            let mut search = FrontSearch::new(&few_draws, self.threads, control, JudgedRows::default());
            let most = self.at_least(plan, expected).min(plan.designs());
            let (points, looked_at) = search.coarse(set, most)?;
            tell_of(&search, &search.in_few(set, &points)?, looked_at, Some(draws))?;
            return Ok(true);
        }
        let slowness = self.pace().slowness;
        let most = share(plan, COARSELY / (expected * slowness)).max(self.at_least(plan, expected));
        if most >= plan.designs() {
            return Ok(false);
        }
        // Where somebody waits for seconds, what is seen gets better meanwhile. Bounds take no longer for more designs.
        let largest = if is_by_bounds(plan, expected) { 0 } else { plan.designs() / MOST_SHARE };
        let mut size = most;
        loop {
            let is_last = size.saturating_mul(FINER) > largest;
            let (rows, looked_at) = if size <= self.fewest() {
                search.best_of_grid(set, size)?
            } else {
                let begun = Instant::now();
                // What the last one finds serves the exact front too.
                let (points, looked_at) = if is_last { search.coarse(set, size)? } else { search.coarse_grid(set, size)? };
                if size == most {
                    #[allow(clippy::cast_precision_loss, reason = "an estimate")]
                    let found = begun.elapsed().as_secs_f64() / (expected * looked_at as f64 / plan.designs() as f64);
                    // Halfway, so that a moment in which the machine has something else to do does not count in full.
                    self.change_pace(|pace| pace.slowness = (slowness * found).sqrt().clamp(1.0, 1e3));
                }
                (search.in_few(set, &points)?, looked_at)
            };
            tell_of(search, &rows, looked_at, None)?;
            if is_last {
                return Ok(true);
            }
            size *= FINER;
        }
    }

    /// The designs that a first idea has at least, where all of them take `expected` seconds.
    fn at_least(&self, plan: &Plan, expected: f64) -> u64 {
        share(plan, COARSELY / expected).clamp(self.fewest(), FEW)
    }

    fn fewest(&self) -> u64 {
        FEWEST.max(self.threads as u64).min(FEW)
    }
}

impl FrontSearch<'_> {
    /// The best of at most so many designs of a coarser grid, with their values in a working set, and how many were looked at. Each is
    /// judged only once: a single one may take long.
    ///
    /// # Errors
    /// [`Error::Stopped`](crate::error::Error::Stopped) after `control.stop`.
    pub(super) fn best_of_grid(&self, set: &WorkingSet, most: u64) -> Result<(Vec<Row>, u64)> {
        let plan = self.plan();
        let (slow, fast) = coarse_places(plan, most);
        let design = |&slow: &u64, fast: u64| plan.slow.source_index(slow) + plan.fast.source_index(fast);
        let indices: Vec<u64> = slow.iter().flat_map(|slow| fast.iter().map(move |&fast| design(slow, fast))).collect();
        let looked_at = indices.len() as u64;
        let mut rows = self.in_few(set, &Points { indices, keys: Vec::new() })?;
        rows.retain(|row| self.holds(row));
        let rules: Vec<_> = plan.study.objectives.iter().map(KeyRule::from).collect();
        let places = objective_columns(&plan.study, self.columns());
        let key = |row: &Row| -> Vec<f64> {
            rules.iter().zip(&places).map(|(rule, &place)| rule.key(row.columns[place].value.unwrap_or(f64::NAN))).collect()
        };
        let keys: Vec<(Vec<f64>, u64)> = rows.iter().map(|row| (key(row), row.index)).collect();
        let mut is_best = keys.iter().map(|own| !keys.iter().any(|other| beats(&other.0, other.1, &own.0, own.1)));
        rows.retain(|_| is_best.next().unwrap_or(true));
        Ok((rows, looked_at))
    }
}

/// A share of the designs of a plan.
#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "about so many")]
fn share(plan: &Plan, share: f64) -> u64 {
    (share * plan.designs() as f64) as u64
}

/// Seconds that all designs take where they are drawn, measured with few draws of a few; `None` if nothing is drawn.
#[allow(clippy::cast_precision_loss, reason = "an estimate")]
pub(super) fn drawn_seconds(plan: &Plan, threads: usize, control: &Control) -> Result<Option<f64>> {
    let Some(all) = plan.study.probability.as_ref().map(|it| it.draws) else { return Ok(None) };
    let Some((few, draws)) = few_draws(plan, FEWEST_DRAWS) else { return Ok(None) };
    let search = FrontSearch::new(&few, threads, control, JudgedRows::default());
    // The first draws of a study also record its formula.
    search.coarse_grid(&WorkingSet::all(), 1)?;
    let begun = Instant::now();
    let (_, looked_at) = search.coarse_grid(&WorkingSet::all(), FEWEST)?;
    Ok(Some(begun.elapsed().as_secs_f64() * (plan.designs() as f64 / looked_at as f64) * (all as f64 / draws as f64)))
}

/// The plan of the same study with so few draws that all its designs, if not too many, take no longer than what is noticed; how many draws
/// these are, and the seconds that all designs take then. `None` if nothing is drawn, or few draws.
#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "about so many")]
fn with_few_draws(plan: &Plan, expected: f64) -> Option<(Plan, u64, f64)> {
    let all = plan.study.probability.as_ref()?.draws;
    let draws = ((NOTICED.as_secs_f64() / expected * all as f64) as u64).max(FEWEST_DRAWS);
    let (few, draws) = few_draws(plan, draws)?;
    Some((few, draws, expected * draws as f64 / all as f64))
}

/// The plan with so many draws, and how many these are; `None` if it has hardly more.
fn few_draws(plan: &Plan, draws: u64) -> Option<(Plan, u64)> {
    let all = plan.study.probability.as_ref()?.draws;
    let few = (draws <= all / 2).then(|| plan.study.with_draws(draws)).flatten()?;
    Some((Plan::new(few), draws))
}

/// Designs that a first working set can be made from in time.
#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "about so many")]
pub(super) fn seeds(plan: &Plan, threads: usize) -> u64 {
    (COARSELY * threads as f64 / (REFERENCE * plan.seconds_per_design())) as u64
}

/// How long a search of so many seconds rests once it has told a coarse front: on a machine with few cores nobody draws it while all of
/// them search on.
pub(super) fn to_be_seen(expected: f64) -> Duration {
    Duration::from_secs_f64((0.1 * expected).min(DRAWN))
}
