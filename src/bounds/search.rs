//! The designs that a result names, found without looking at all: the front, the best by one quantity, the best of every cell of a map, the
//! extremes.
//!
//! Boxes wait in batches. Of each the best that it might hold is bounded: if no design of it can be on the front any more (or among the
//! best, or an extreme), it is settled; a small one is judged by the ordinary engine; the others are cut in two, and one promising
//! design of each is judged at once, so that the next batch meets better rivals.

use super::axes::{AXES, Axes, Span, Spans};
use super::bounder::{Bounder, Bounds, Wanted};
use super::cells::CellAxes;
use super::count::varying;
use super::open::{BetterEnds, Bounded, Decided, add_pull, all_open, decide, is_infeasible, over, worst_of};
use super::queue::{Queue, Waiting};
use super::rival::Rival;
use super::shared::{Followers, Rest};
use super::sought::{ObjectiveProduct, QuotientLimit, Searched, Sought, Target};
use super::staircase::Fit;
use crate::models::Effort;
use crate::parallel::on_threads;
use crate::plan::Plan;
use crate::reduce::{MOST_OBJECTIVES, Reducers, Reduction};
use crate::screen::CpuEngine;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Boxes that are looked at before what was found in them counts against others: more where it takes longer to sort that in.
const BATCH: std::ops::RangeInclusive<usize> = 1 << 10..=1 << 14;
/// Designs of a box above which single ones are tried: smaller ones are soon judged whole.
const WORTH_A_TRY: u64 = 1 << 22;
/// Most boxes that a thread takes at a time.
const SHARE: usize = 64;
/// A batch this small is one of the first: of what is tried there, the whole row is.
const FIRST_BATCHES: usize = 64;
/// More than rounding can make of a product of a few numbers.
const OUTWARD: f64 = 1.0 + 256.0 * f64::EPSILON;

/// What came of a box.
enum Fate {
    Infeasible,
    Beaten,
    /// What is left of it is to be judged design by design.
    Leaf(Waiting),
    /// What is left of it is cut in two; with designs to try.
    Cut(Box<[Waiting; 2]>, [u64; 2]),
}

/// What all threads of a search share.
pub struct BoxSearch<'a> {
    /// The axes.
    pub axes: &'a Axes,
    /// The positions that are searched.
    pub range: &'a Range<u64>,
    /// What a design must satisfy.
    pub requirements: &'a [Bounded],
    /// How designs are reduced.
    pub reduction: &'a Reduction,
    /// Set to end the search.
    pub stop: &'a AtomicBool,
    /// Told how many designs were settled.
    pub progress: &'a (dyn Fn(u64) + Sync),
    /// What is sought, and the numbers that it is about.
    pub sought: Sought,
    /// One for an extreme, the best or the cells of a map, one per objective for the front.
    pub targets: Vec<Target>,
    /// The axes of the map whose cells are sought.
    pub cells: Option<CellAxes>,
    /// For a front of two objectives.
    pub product: Option<ObjectiveProduct>,
    /// The study.
    pub plan: &'a Plan,
    /// How long a design takes: the first stage of a row, the second of a design, over all scenarios.
    pub effort: Effort,
    /// Seconds that the bounds of a box take, about.
    pub bounding: f64,
    /// Designs of a row.
    pub row: u64,
    /// Points of a front at which it is given up.
    pub most_points: u64,
    /// Boxes at which it is given up.
    pub most_boxes: u64,
    /// Searches that follow and look for something in the same designs.
    pub followers: Option<Followers<'a>>,
}

/// What a thread works with.
pub struct Worker<'t> {
    /// Bounds boxes.
    pub bounder: Bounder<'t>,
    /// Judges designs.
    pub engine: CpuEngine<'t>,
}

/// What the bounds of all that is open and sought say of a box.
struct BoxView {
    /// How much every axis moves it.
    pull: [f64; AXES],
    /// Which ends of axes make the rest superfluous.
    ends: BetterEnds,
    /// Which end of every axis all that is sought agrees to be better: `None` where it does not.
    better: [Option<Option<bool>>; AXES],
    /// Is it known already what must be cut?
    is_steered: bool,
}

impl BoxView {
    /// Takes in one more number.
    fn agree(&mut self, bounds: &Bounds, worse_is_sought: bool, designs: usize) {
        for (axis, better) in self.better.iter_mut().enumerate().take(designs) {
            let own = bounds.better_up(axis).map(|up| up != worse_is_sought);
            if own.is_some() {
                *better = match *better {
                    Some(None) => Some(own),
                    Some(held) if held == own => Some(held),
                    _ => None,
                };
            } else if bounds.spread[axis] > 0.0 {
                *better = None;
            }
        }
    }
}

/// The box that was cut in two.
fn cut_into([first, second]: &[Waiting; 2]) -> Spans {
    let mut spans = first.spans;
    spans.0.iter_mut().zip(&second.spans.0).for_each(|(span, other)| span.high = other.high);
    spans
}

impl BoxSearch<'_> {
    /// Searches boxes and takes what it finds into `found`. Returns besides what it leaves to the searches that follow; nothing if none do, or
    /// if that is too many boxes. `None` if it was stopped or given up.
    pub fn run(&self, roots: &[Spans], workers: &mut [Worker<'_>], found: &mut Reducers) -> Option<(Searched, Option<Rest>)> {
        let root = |spans: &Spans| Waiting {
            spans: *spans,
            open: all_open(self.requirements, self.axes),
            covers: self.targets.iter().map(|_| [self.axes.whole()].into()).collect(),
            surplus: f64::INFINITY,
        };
        let mut queue = Queue::new();
        roots.iter().map(root).for_each(|root| queue.push(root));
        let mut total = Searched::default();
        let mut rest = self.followers.map(|_| Rest::default());
        while !queue.is_empty() {
            let batch = queue.pop((found.front.len() / 4).clamp(*BATCH.start(), *BATCH.end()));
            let (next, settled) = self.look_at(&batch, workers, found, &mut rest);
            rest = rest.filter(|rest| self.followers.is_some_and(|it| rest.boxes.len() <= it.most_boxes));
            if self.stop.load(Ordering::Relaxed) || found.front.len() as u64 > self.most_points {
                return None;
            }
            total.add(&settled);
            if total.boxes > self.most_boxes {
                return None;
            }
            next.into_iter().for_each(|part| queue.push(part));
        }
        Some((total, rest))
    }

    /// Looks at a batch of boxes on all threads; returns their parts. What is left to others is added to `rest`, if that is kept.
    fn look_at(
        &self,
        batch: &[Waiting],
        workers: &mut [Worker<'_>],
        found: &mut Reducers,
        rest: &mut Option<Rest>,
    ) -> (Vec<Waiting>, Searched) {
        let known = found.front.points().clone();
        let rival = Rival::new(self, found);
        // Threads take boxes a share at a time, each starting with what is known: it drops most of what it judges there and then.
        let shares: Vec<&[Waiting]> = batch.chunks((batch.len() / (8 * workers.len())).clamp(1, SHARE)).collect();
        let taken = AtomicUsize::new(0);
        let is_first = batch.len() <= FIRST_BATCHES;
        let start = || {
            let mut own = self.reduction.start_after(known.clone());
            // Nothing is counted here, and maps are large.
            own.reported.histograms.clear();
            own.reported.samples.clear();
            if self.cells.is_none() {
                own.reported.maps.clear();
            }
            own
        };
        let mut reducers: Vec<Reducers> = workers.iter().take(shares.len()).map(|_| start()).collect();
        let is_shared = rest.is_some();
        let parts = on_threads(workers.iter_mut().zip(&mut reducers), |(worker, reducers)| {
            let mut own = Vec::new();
            loop {
                let share = taken.fetch_add(1, Ordering::Relaxed);
                let Some(part) = shares.get(share) else { return own };
                let mut left = is_shared.then(Rest::default);
                let (next, settled) = self.look_at_part(part, worker, &rival, reducers, is_first, left.as_mut());
                (self.progress)(settled.designs());
                if let (Some(followers), Some(left)) = (self.followers, &left) {
                    (followers.told)(left.settled());
                }
                own.push((share, (next, settled, left)));
            }
        });
        let mut parts: Vec<_> = parts.into_iter().flatten().collect();
        // In the order of the boxes, whoever took them.
        parts.sort_unstable_by_key(|(share, _)| *share);
        let (mut next, mut settled) = (Vec::new(), Searched::default());
        for (_, (parts, own, left)) in parts {
            next.extend(parts);
            settled.add(&own);
            if let (Some(rest), Some(left)) = (rest.as_mut(), &left) {
                rest.add(left);
            }
        }
        for reducers in reducers {
            found.merge(reducers.into_fresh());
        }
        (next, settled)
    }

    fn look_at_part(
        &self,
        part: &[Waiting],
        worker: &mut Worker<'_>,
        rival: &Rival<'_>,
        reducers: &mut Reducers,
        is_first: bool,
        mut rest: Option<&mut Rest>,
    ) -> (Vec<Waiting>, Searched) {
        let mut settled = Searched::default();
        let mut next = Vec::new();
        let (mut positions, mut rows) = (Vec::new(), Vec::new());
        for waiting in part {
            if self.stop.load(Ordering::Relaxed) {
                break;
            }
            settled.boxes += 1;
            let size = self.axes.count(&waiting.spans);
            match self.fate(waiting, rival, &mut worker.bounder) {
                Fate::Infeasible => {
                    settled.infeasible += size;
                    rest.iter_mut().for_each(|rest| rest.add_infeasible(&waiting.spans, size));
                }
                Fate::Beaten => {
                    settled.beaten += size;
                    rest.iter_mut().for_each(|rest| rest.boxes.push(waiting.spans));
                }
                Fate::Leaf(left) => match &mut rest {
                    Some(rest) if self.is_judged_for_all(&left, &waiting.spans) => {
                        settled.evaluated += size;
                        settled.evaluations += size;
                        rest.judged += size;
                        rest.feasible += self.judge_for_all(&waiting.spans, worker, reducers);
                    }
                    _ => {
                        rest.iter_mut().for_each(|rest| rest.boxes.push(waiting.spans));
                        let own = self.axes.count(&left.spans);
                        settled.evaluated += own;
                        settled.evaluations += own;
                        settled.beaten += size - own;
                        self.judge(&left, worker, reducers);
                    }
                },
                Fate::Cut(parts, tries) => {
                    settled.beaten += size - parts.iter().map(|part| self.axes.count(&part.spans)).sum::<u64>();
                    rest.iter_mut().for_each(|rest| rest.add_all_but(&cut_into(&parts), &waiting.spans, self.axes));
                    if is_first {
                        rows.extend(tries.map(|position| position / self.row));
                    } else if size > WORTH_A_TRY {
                        positions.extend(tries);
                    }
                    next.extend(*parts);
                }
            }
        }
        positions.sort_unstable();
        positions.dedup();
        settled.evaluations += positions.len() as u64;
        worker.engine.screen_some(&positions, |block| self.reduction.absorb_counted(reducers, block));
        rows.sort_unstable();
        rows.dedup();
        for row in rows {
            // What stands in another shard is another shard's to find.
            let range = (row * self.row).max(self.range.start)..((row + 1) * self.row).min(self.range.end);
            settled.evaluations += range.end - range.start;
            worker.engine.screen(range, |block| self.reduction.absorb_counted(reducers, block));
        }
        (next, settled)
    }

    /// Judges the designs of a leaf in the scenarios that decide about what is sought.
    fn judge(&self, leaf: &Waiting, worker: &mut Worker<'_>, reducers: &mut Reducers) {
        let (rows, places) = self.axes.rows(&leaf.spans, self.row);
        let chosen = self.chosen(leaf);
        worker.engine.screen_rows(&rows, &places, &chosen, |block| match self.sought {
            _ if chosen.is_empty() => self.reduction.absorb_counted(reducers, block),
            // Of anything else the block may not hold the worst.
            Sought::Front => self.reduction.absorb_objectives(reducers, block),
            Sought::Top => self.reduction.absorb_top(reducers, block),
            Sought::Cells(number) => self.reduction.absorb_cells(reducers, block, number),
            Sought::Extreme { objective, .. } => self.reduction.absorb_objective(reducers, block, objective),
        });
    }

    /// Judges the designs of a box in every scenario, for all searches; how many are feasible.
    fn judge_for_all(&self, spans: &Spans, worker: &mut Worker<'_>, reducers: &mut Reducers) -> u64 {
        let (rows, places) = self.axes.rows(spans, self.row);
        let mut feasible = 0;
        worker.engine.screen_rows(&rows, &places, &[], |block| {
            feasible += block.feasible_count;
            self.reduction.absorb_counted(reducers, block);
        });
        feasible
    }

    /// What is to be done with a box.
    fn fate(&self, waiting: &Waiting, rival: &Rival<'_>, bounder: &mut Bounder<'_>) -> Fate {
        // First what is cheap: bounds without derivatives settle many boxes.
        if is_infeasible(self.requirements, bounder, self.axes, &waiting.spans, &waiting.open) {
            return Fate::Infeasible;
        }
        if self.is_hopeless(waiting, rival, bounder) {
            return Fate::Beaten;
        }
        let mut now = waiting.clone();
        loop {
            let mut view = BoxView { pull: [0.0; AXES], ends: BetterEnds::ANY, better: [Some(None); AXES], is_steered: false };
            if self.has_no_hope(&mut now, rival, bounder, &mut view) {
                return Fate::Beaten;
            }
            match decide(self.requirements, bounder, self.axes, &now.spans, &now.open) {
                Decided::Infeasible => return Fate::Infeasible,
                Decided::Open(open, pull, ends) => {
                    now.open = open;
                    view.ends.first &= ends.first;
                    view.ends.last &= ends.last;
                    if !view.is_steered {
                        view.pull.iter_mut().zip(pull).for_each(|(all, own)| *all += own);
                    }
                }
            }
            if let Some(cells) = self.cells {
                // Every cell has a best of its own.
                view.ends.keep(cells.set());
            }
            // What another design of the box makes superfluous need not be looked at.
            let left = if self.sought == Sought::Top { now.spans } else { view.ends.collapse(&now.spans, self.axes) };
            if left == now.spans {
                return self.leaf_or_cut(now, &view);
            }
            now.spans = left;
        }
    }

    /// The same by bounds without derivatives, but for the product of both objectives.
    fn is_hopeless(&self, waiting: &Waiting, rival: &Rival<'_>, bounder: &mut Bounder<'_>) -> bool {
        let mut hopes = [0.0; MOST_OBJECTIVES];
        for ((target, cover), hope) in self.targets.iter().zip(&waiting.covers).zip(&mut hopes) {
            let is_low_sought = target.asked.higher_is_worse != target.at_the_bad_end;
            let ranges = cover.iter().map(|part| bounder.range(&target.asked, &over(&waiting.spans, part, self.axes)));
            *hope = if is_low_sought {
                ranges.fold(f64::INFINITY, |hope, (low, _)| hope.min(low))
            } else {
                ranges.fold(f64::NEG_INFINITY, |hope, (_, high)| hope.max(high))
            };
        }
        let hopes = &hopes[..self.targets.len()];
        if rival.beats(self, hopes, &waiting.spans) {
            return true;
        }
        self.fit(hopes, rival, &waiting.spans, bounder).is_some_and(|(fit, _)| fit == Fit::None)
    }

    /// Into how many notches of the front the product of both objectives fits, with its bounds.
    fn fit(&self, hopes: &[f64], rival: &Rival<'_>, spans: &Spans, bounder: &mut Bounder<'_>) -> Option<(Fit, Bounds)> {
        let (Rival::Front(_, Some(staircase)), Some(product)) = (rival, &self.product) else { return None };
        let bounds = bounder.bounds(&product.asked, spans, Wanted::Most);
        // What is to be small must not be negative: then its inverse would be no measure of it.
        let is_measure = (0..2).all(|at| product.largest[at] || hopes[at] >= 0.0);
        let lower = [0, 1].map(|at| self.targets[at].rule.key(hopes[at]));
        Some((if is_measure { staircase.fit(lower, bounds.most * product.unit) } else { Fit::Few(f64::INFINITY) }, bounds))
    }

    /// Can no design of a box be what is sought, by the best that it may have?
    fn has_no_hope(&self, now: &mut Waiting, rival: &Rival<'_>, bounder: &mut Bounder<'_>, view: &mut BoxView) -> bool {
        let mut hopes = [0.0; MOST_OBJECTIVES];
        for ((target, cover), hope) in self.targets.iter().zip(&mut now.covers).zip(&mut hopes) {
            let (least, most) = self.worst(target, bounder, &now.spans, cover, view);
            let badness = if target.at_the_bad_end { most } else { least };
            *hope = if target.asked.higher_is_worse { badness } else { -badness };
            for limit in &target.limits {
                let bounds = bounder.bounds(&limit.quotient, &now.spans, Wanted::Most);
                *hope = self.limited(target, limit, *hope, bounds.most, bounder, &now.spans);
            }
        }
        if rival.beats(self, &hopes[..self.targets.len()], &now.spans) {
            return true;
        }
        match self.fit(&hopes[..self.targets.len()], rival, &now.spans, bounder) {
            Some((Fit::None, _)) => return true,
            Some((Fit::Few(surplus), _)) => now.surplus = surplus,
            // It is the product that must come down, wherever on the stairs the designs are.
            Some((Fit::Many(surplus), bounds)) => {
                now.surplus = surplus;
                let mut pull = [0.0; AXES];
                add_pull(&mut pull, &bounds, &now.spans, self.axes);
                if pull.iter().any(|&it| it > 0.0) {
                    view.pull = pull;
                    view.is_steered = true;
                }
            }
            None => {}
        }
        false
    }

    fn leaf_or_cut(&self, now: Waiting, view: &BoxView) -> Fate {
        if self.is_leaf(&now) {
            return Fate::Leaf(now);
        }
        let axis = self.axis_to_cut(&now.spans, &view.pull);
        let tries = self.tries(&now.spans, &view.better);
        let [first, second] = now.spans.halves(axis);
        let other = Waiting { spans: second, ..now.clone() };
        Fate::Cut(Box::new([Waiting { spans: first, ..now }, other]), tries)
    }

    /// The best that a number may be, given what limits it.
    fn limited(&self, target: &Target, limit: &QuotientLimit, hope: f64, most: f64, bounder: &mut Bounder<'_>, spans: &Spans) -> f64 {
        let is_large_sought = target.asked.higher_is_worse == target.at_the_bad_end;
        // Both numbers must be of one sign, or their quotient limits nothing.
        let least = if is_large_sought { bounder.range(&limit.limited, spans).0 } else { hope };
        if !(least >= 0.0 && most > 1e-100 && most < 1e100) {
            return hope;
        }
        if is_large_sought { hope.min(most * limit.bound * OUTWARD) } else { hope.max(limit.bound / most / OUTWARD) }
    }

    /// Bounds of the worst value over all scenarios, as badness; the cover becomes the scenarios that may be worst.
    fn worst(&self, target: &Target, bounder: &mut Bounder<'_>, spans: &Spans, cover: &mut Arc<[Spans]>, view: &mut BoxView) -> (f64, f64) {
        let wanted = if target.at_the_bad_end { Wanted::Most } else { Wanted::Least };
        worst_of(&target.asked, bounder, self.axes, spans, cover, wanted, |it, whole| {
            add_pull(&mut view.pull, it, whole, self.axes);
            view.ends.narrow(&target.asked, it, target.at_the_bad_end, !target.rule.has_steps() || target.at_the_bad_end);
            view.agree(it, target.at_the_bad_end, self.axes.designs);
        })
    }

    /// The axis along which what is open and what is sought differ most.
    fn axis_to_cut(&self, spans: &Spans, pull: &[f64; AXES]) -> usize {
        // Rivals are those of a cell: cells come apart first.
        let first = self.cells.map_or(0, |cells| cells.set() & varying(spans, self.axes));
        let is_candidate = |axis: usize| if first > 0 { first >> axis & 1 == 1 } else { !spans[axis].is_single() };
        let candidates = (0..self.axes.designs).filter(|&axis| is_candidate(axis));
        let by = |a: &usize, b: &usize| pull[*a].total_cmp(&pull[*b]).then(spans[*a].count().cmp(&spans[*b].count()));
        candidates.max_by(by).expect("a box of more than one design has such an axis")
    }

    /// Positions of two designs to try: where all that is sought agrees to be better, else in the middle; and the middle of all.
    fn tries(&self, spans: &Spans, better: &[Option<Option<bool>>; AXES]) -> [u64; 2] {
        let (mut best, mut middle) = (*spans, *spans);
        for axis in 0..self.axes.designs {
            let Span { low, high } = spans[axis];
            let half = low + (high - low) / 2;
            middle[axis] = Span::at(half);
            best[axis] = Span::at(match better[axis] {
                Some(Some(true)) => high,
                Some(Some(false) | None) => low,
                None => half,
            });
        }
        [self.axes.first_position(&best), self.axes.first_position(&middle)]
    }
}
