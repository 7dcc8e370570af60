//! When a box is judged by the ordinary engine, and in which scenarios.

use super::axes::Spans;
use super::bounder::AskedNumber;
use super::open::{each_scenario, scenarios};
use super::queue::Waiting;
use super::search::BoxSearch;

/// A box is judged by the engine where that takes about as long as a few more bounds: seconds, by what the model says.
const LEAF: f64 = 5e-5;
const ROW: f64 = 3e-4;
/// Seconds that a design takes besides, and a place of a row.
const DESIGN: f64 = 7e-9;
const PLACE: f64 = 7e-8;
/// And a scenario of a row.
const SCENARIO: f64 = 2e-7;
/// A box of a map's cells is judged by the engine where that takes at most so many seconds a cell, about as long as a few bounds of each,
/// and at most so many in all: one bound may settle many cells.
const CELL: f64 = 5e-4;
const CELLS: f64 = 1e-2;
/// Scenarios that may be the worst are bounded in parts, each by itself, in a box and again in every box cut from it; the engine drops
/// most designs after a few scenarios. For each part beyond the first a leaf may take so many times as long as the bounds of one part.
/// Factors of 16 to 256 took about the same time.
const FURTHER: f64 = 64.0;
/// Most scenarios of a leaf that are listed: of more, all are looked at.
const CHOSEN: u64 = 1 << 12;

/// Parts of the scenarios that are bounded one by one, beyond one for each number.
fn further_parts(waiting: &Waiting) -> usize {
    let of_open = waiting.open.iter().map(|it| it.cover.len());
    waiting.covers.iter().map(|it| it.len()).chain(of_open).map(|parts| parts.saturating_sub(1)).sum()
}

impl BoxSearch<'_> {
    /// Is a box judged whole? Bounds of its parts would take about as long.
    pub(super) fn is_leaf(&self, waiting: &Waiting) -> bool {
        let (rows, designs) = self.rows_and_designs(&waiting.spans);
        let time = self.time(rows, designs, self.chosen_count(waiting)) + self.places(&waiting.spans) as f64 * PLACE;
        // A single row has nothing in common with others that bounds could use.
        let own = if rows > 1.0 { LEAF } else { ROW };
        let of_cells = self.cells.map_or(0.0, |cells| (cells.count(&waiting.spans) as f64 * CELL).min(CELLS));
        designs == 1.0 || time <= own.max(self.bounding).max(of_cells).max(self.bounding * FURTHER * further_parts(waiting) as f64)
    }

    /// Is the box of a leaf judged for all searches at once? Yes, where that takes no longer than if each of them judged what is left of it.
    pub(super) fn is_judged_for_all(&self, left: &Waiting, spans: &Spans) -> bool {
        let time = |spans: &Spans, chosen| {
            let (rows, designs) = self.rows_and_designs(spans);
            self.time(rows, designs, chosen)
        };
        let searches = (1 + self.followers.map_or(0, |it| it.searches)) as f64;
        time(spans, self.plan.scenarios()) <= searches * time(&left.spans, self.chosen_count(left))
    }

    /// How many rows and designs a box has.
    fn rows_and_designs(&self, spans: &Spans) -> (f64, f64) {
        let size = self.axes.count(spans);
        ((size / self.places(spans)) as f64, size as f64)
    }

    /// How many designs of each row a box has.
    fn places(&self, spans: &Spans) -> u64 {
        self.axes.steps.iter().zip(&spans.0).filter(|(step, _)| **step < self.row).map(|(_, span)| span.count()).product()
    }

    /// Seconds that it takes to judge designs in some of the scenarios.
    fn time(&self, rows: f64, designs: f64, chosen: u64) -> f64 {
        let share = |all: u64| (chosen as f64 / all as f64).min(1.0);
        let prepare = self.effort.prepare * share(self.plan.slow_scenarios.count());
        let finish = self.effort.finish * share(self.plan.scenarios());
        rows * (prepare + chosen as f64 * SCENARIO) + designs * (finish + DESIGN)
    }

    /// How many scenarios of a leaf are looked at, at most.
    fn chosen_count(&self, waiting: &Waiting) -> u64 {
        let targets = self.targets.iter().zip(&waiting.covers).map(|(target, cover)| scenarios(cover, &target.asked, self.axes));
        let open = waiting.open.iter().map(|item| scenarios(&item.cover, &self.requirements[item.requirement].asked, self.axes));
        let chosen = targets.chain(open).fold(0, u64::saturating_add);
        if chosen > CHOSEN { self.plan.scenarios() } else { chosen.min(self.plan.scenarios()) }
    }

    /// The scenarios, slow and fast, that decide about the designs of a box: in which what is sought may be worst, or what is open be
    /// violated. None where it may be any.
    pub(super) fn chosen(&self, waiting: &Waiting) -> Vec<(u64, u64)> {
        if self.chosen_count(waiting) == self.plan.scenarios() {
            return Vec::new();
        }
        let mut chosen = Vec::new();
        let mut choose = |cover: &[Spans], asked: &AskedNumber| {
            each_scenario(cover, asked, self.axes, |scenario| {
                let index = self.axes.scenario_index(&scenario);
                chosen.push((self.plan.slow_scenarios.index_of(index), self.plan.fast_scenarios.index_of(index)));
            });
        };
        self.targets.iter().zip(&waiting.covers).for_each(|(target, cover)| choose(cover, &target.asked));
        waiting.open.iter().for_each(|item| choose(&item.cover, &self.requirements[item.requirement].asked));
        chosen.sort_unstable();
        chosen.dedup();
        chosen
    }
}
