//! What several searches of the same designs share.
//!
//! Where bounds settle little, each search would judge the same designs again. So the search for an extreme judges its last boxes for all that
//! follow, in every scenario, where that takes no longer than if each of them judged such a box in the few that decide for it; it notes which
//! boxes are left. The next ones, and the count of feasible designs, look at those only. The search for the front comes first and judges
//! for itself: it judges many designs that the others settle by bounds.

use super::axes::{Axes, Span, Spans};
use super::open::all_open;
use super::sought::Searched;
use super::{BoundedStudy, SearchJob, Settled, Sought, Worker};
use crate::parallel::on_threads;
use crate::plan::Plan;
use crate::reduce::Reducers;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};

/// Boxes that are noted. Where there are more, bounds settle many designs, and the next search is as soon done from the start.
const MOST_BOXES: usize = 1 << 10;
/// What searches have left is counted in one piece, which is lost if it is stopped, only where it is at most one in so many designs.
const COUNTED_SHARE: u64 = 4;
/// Boxes that surely violate a requirement of which designs are judged all the same, and designs of each.
const SAMPLED: usize = 64;
/// Boxes that the rest is cut into, per thread, to be counted.
const PARTS: usize = 8;

/// What the searches of a study have in common.
#[derive(Debug)]
pub struct Shared {
    /// Searches to come that look for something in the same designs.
    searches: u64,
    /// What those before have left, and the most boxes of that.
    pub(super) rest: Option<Rest>,
    pub(super) most_boxes: usize,
    /// Designs of which progress was told for each search to come: it need not tell them again.
    ahead: u64,
}

/// The searches that follow one which judges designs for them too.
#[derive(Clone, Copy)]
pub struct Followers<'a> {
    /// How many searches follow.
    pub searches: u64,
    /// Most boxes that are noted for them.
    pub most_boxes: usize,
    /// Is told how many designs were settled for each of them.
    pub told: &'a (dyn Fn(u64) + Sync),
}

impl Shared {
    /// For all searches of a plan.
    pub fn new(plan: &Plan) -> Self {
        let searches = BoundedStudy::sought(plan).into_iter().filter(|it| shares(*it)).count() as u64;
        Self { searches, ..Self::alone() }
    }

    /// For a search by itself.
    pub fn alone() -> Self {
        Self { searches: 0, rest: None, most_boxes: MOST_BOXES, ahead: 0 }
    }
}

/// Does a search share what it judges? Maps are too large to be carried along.
fn shares(sought: Sought) -> bool {
    matches!(sought, Sought::Top | Sought::Extreme { .. })
}

/// What searches leave to those that follow.
#[derive(Clone, Debug, Default)]
pub(super) struct Rest {
    /// Boxes that may hold something that was not looked for.
    pub boxes: Vec<Spans>,
    /// Designs of boxes that surely violate a requirement, and some of these boxes.
    pub infeasible: u64,
    violating: Vec<Spans>,
    /// Designs that were judged for all, and the feasible ones among them.
    pub judged: u64,
    pub feasible: u64,
}

impl Rest {
    /// Adds a box that surely violates a requirement.
    pub fn add_infeasible(&mut self, spans: &Spans, designs: u64) {
        self.infeasible += designs;
        if self.violating.len() < SAMPLED {
            self.violating.push(*spans);
        }
    }

    /// Adds what another part of a search has left.
    pub fn add(&mut self, other: &Self) {
        self.boxes.extend(&other.boxes);
        self.add_settled(other);
    }

    /// Adds what an earlier search has settled.
    fn add_settled(&mut self, earlier: &Self) {
        self.infeasible += earlier.infeasible;
        let room = SAMPLED.saturating_sub(self.violating.len());
        self.violating.extend(earlier.violating.iter().take(room));
        self.judged += earlier.judged;
        self.feasible += earlier.feasible;
    }

    /// Adds those designs of a box that are not in a part of it.
    pub fn add_all_but(&mut self, part: &Spans, spans: &Spans, axes: &Axes) {
        let mut left = *spans;
        for axis in 0..axes.designs {
            let (all, kept) = (left[axis], part[axis]);
            let mut beside = |span| {
                let mut own = left;
                own[axis] = span;
                self.boxes.push(own);
            };
            if all.low < kept.low {
                beside(Span { low: all.low, high: kept.low - 1 });
            }
            if kept.high < all.high {
                beside(Span { low: kept.high + 1, high: all.high });
            }
            left[axis] = kept;
        }
    }

    /// Designs that nobody needs to look at any more.
    pub fn settled(&self) -> u64 {
        self.infeasible + self.judged
    }

    /// Designs that are left.
    fn left(&self, axes: &Axes) -> u64 {
        self.boxes.iter().map(|spans| axes.count(spans)).sum()
    }
}

/// Boxes, each with what belongs to it, the large ones cut so that all threads have work until the end.
pub(super) fn cut_for<T: Clone>(threads: usize, mut boxes: Vec<(Spans, T)>, axes: &Axes) -> Vec<(Spans, T)> {
    while boxes.len() < PARTS * threads {
        let Some(at) = (0..boxes.len()).max_by_key(|&at| axes.count(&boxes[at].0)).filter(|&at| axes.count(&boxes[at].0) > 1) else {
            break;
        };
        let (spans, own) = boxes.swap_remove(at);
        boxes.extend(spans.halves(axes.longest(&spans)).map(|half| (half, own.clone())));
    }
    boxes
}

impl BoundedStudy {
    /// As [`BoundedStudy::search`], for all that is sought in turn: what one search has judged for others is in `shared`.
    pub fn search_sharing(
        &self,
        job: SearchJob<'_>,
        sought: Sought,
        shared: &mut Shared,
        workers: &mut [Worker<'_>],
        found: &mut Reducers,
    ) -> Option<Searched> {
        let SearchJob { plan, range, stop, .. } = job;
        let whole = self.axes.boxes(range);
        if !shares(sought) {
            return Some(self.search_boxes(job, sought, &whole, None, workers, found)?.0);
        }
        shared.searches = shared.searches.saturating_sub(1);
        // Every search tells of all designs once, some of them ahead.
        let size = range.end - range.start;
        let already = AtomicU64::new(shared.ahead);
        let told = |designs: u64| {
            let less = |already: u64| Some(already - already.min(designs));
            let already = already.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less).unwrap_or_else(|already| already);
            (job.progress)(designs - already.min(designs));
        };
        let telling = SearchJob { progress: &told, ..job };
        let going_on = |searched: Searched| (!stop.load(Ordering::Relaxed)).then_some(searched);
        let earlier = shared.rest.clone().unwrap_or_default();
        let settled = Searched { infeasible: earlier.infeasible, evaluated: earlier.judged, ..Searched::default() };
        let roots = if shared.rest.is_some() { &earlier.boxes } else { &whole };
        if roots.is_empty() {
            told(size);
            return going_on(settled);
        }
        // The whole may be pairs although its parts are not.
        if let Some(searched) = self.extreme_of_pairs(telling, sought, &self.targets(plan, sought)[0], &whole, workers, found) {
            told(size);
            return going_on(searched);
        }
        told(settled.designs());
        let (searches, ahead) = (shared.searches, AtomicU64::new(shared.ahead));
        let tell_ahead = |designs: u64| {
            let more = |ahead: u64| Some(size.min(ahead.saturating_add(designs)));
            let ahead = ahead.fetch_update(Ordering::Relaxed, Ordering::Relaxed, more).unwrap_or_else(|ahead| ahead);
            (0..searches).for_each(|_| (job.progress)(designs.min(size - ahead)));
        };
        let followers = (searches > 0).then_some(Followers { searches, most_boxes: shared.most_boxes, told: &tell_ahead });
        let (mut searched, rest) = self.search_boxes(telling, sought, roots, followers, workers, found)?;
        shared.ahead = ahead.into_inner();
        searched.add(&settled);
        if let Some(mut rest) = rest {
            rest.add_settled(&earlier);
            searched.counted = rest.boxes.is_empty().then_some(rest.feasible);
            // Where most is left, the whole is as soon searched as its parts.
            if rest.left(&self.axes) <= size / 2 {
                shared.rest = Some(rest);
            }
        }
        Some(searched)
    }

    /// Have searches judged at least half of the designs of a range one by one?
    pub fn has_judged_most(&self, shared: &Shared, range: &Range<u64>) -> bool {
        shared.rest.as_ref().is_some_and(|rest| rest.judged >= (range.end - range.start).div_ceil(2))
    }

    /// The feasible designs of a range: those that searches have judged, and those of what they have left, which is counted; `told` is told how
    /// many designs that settles. `None` if so much is left that it is better counted piece by piece, or if it was stopped.
    pub fn count_rest(
        &self,
        shared: &Shared,
        range: &Range<u64>,
        threads: usize,
        stop: &AtomicBool,
        told: &(dyn Fn(u64) + Sync),
    ) -> Option<(u64, Settled)> {
        let most = (range.end - range.start) / COUNTED_SHARE;
        let rest = shared.rest.as_ref().filter(|rest| rest.left(&self.axes) <= rest.judged.min(most))?;
        let boxes = cut_for(threads, rest.boxes.iter().map(|spans| (*spans, ())).collect(), &self.axes);
        let taken = AtomicUsize::new(0);
        let counted = on_threads(0..threads, |_| {
            let (mut counter, mut total) = (self.counter(stop), 0);
            while let Some((spans, ())) = boxes.get(taken.fetch_add(1, Ordering::Relaxed)) {
                total += counter.count(spans, &all_open(&self.requirements, &self.axes))?;
                told(self.axes.count(spans));
            }
            Some((total, counter.settled))
        });
        let mut settled = Settled { infeasible: rest.infeasible, evaluated: rest.judged, ..Settled::default() };
        let mut feasible = rest.feasible;
        for counted in counted {
            let (own, how) = counted?;
            feasible += own;
            settled.add(&how);
        }
        Some((feasible, settled))
    }

    /// Positions of some designs that searches have settled as infeasible for all.
    pub fn sample_of_infeasible(&self, shared: &Shared) -> Vec<u64> {
        let boxes = shared.rest.iter().flat_map(|rest| &rest.violating);
        let mut positions: Vec<u64> = boxes
            .flat_map(|spans| {
                let size = self.axes.count(spans);
                let some = size.min(SAMPLED as u64);
                (0..some).map(move |it| self.axes.first_position(&spans.at(0..self.axes.designs, it * (size / some))))
            })
            .collect();
        positions.sort_unstable();
        positions.dedup();
        positions
    }
}
