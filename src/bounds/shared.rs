//! What several searches of the same designs share.
//!
//! Where bounds settle little, each search would judge the same designs again. So a search judges its last boxes for all that follow, in
//! every scenario, where that takes no longer than each of them judging such a box in the few that decide for it; it notes which boxes are
//! left. The next ones, and the count of feasible designs, look at those only.

use super::axes::{Axes, Span, Spans};
use super::sought::Searched;
use super::{BoundedStudy, SearchJob, Settled, Sought, Worker};
use crate::bounds::open::all_open;
use crate::parallel::on_threads;
use crate::plan::Plan;
use crate::reduce::Reducers;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Boxes that are noted. Where there are more, bounds settle many designs, and the next search is as soon done from the start.
const MOST_BOXES: usize = 1 << 10;

/// What the searches of a study have in common.
#[derive(Debug, Default)]
pub struct Shared {
    /// Searches that are to come and look for something in the same designs.
    pub searches: u64,
    /// What those before have left.
    pub(super) rest: Option<Rest>,
}

/// What a search leaves to those that follow.
#[derive(Clone, Debug, Default)]
pub(super) struct Rest {
    /// Boxes that may hold something that it did not look for.
    pub boxes: Vec<Spans>,
    /// Designs of boxes that surely violate a requirement.
    pub infeasible: u64,
    /// Designs that were judged for all, and the feasible ones among them.
    pub judged: u64,
    pub feasible: u64,
}

impl Rest {
    /// Adds what another thread has left.
    pub fn add(&mut self, other: &Self) {
        self.boxes.extend(&other.boxes);
        self.infeasible += other.infeasible;
        self.judged += other.judged;
        self.feasible += other.feasible;
    }

    /// Adds what an earlier search settled.
    pub fn take_over(&mut self, earlier: Option<&Self>) {
        let Some(earlier) = earlier else { return };
        self.infeasible += earlier.infeasible;
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

    /// Are there too many boxes to be of use?
    pub fn is_too_much(&self) -> bool {
        self.boxes.len() > MOST_BOXES
    }

    /// Designs that are left.
    pub fn left(&self, axes: &Axes) -> u64 {
        self.boxes.iter().map(|spans| axes.count(spans)).sum()
    }

    /// What the first search settled for one that follows.
    pub fn settled(&self) -> Searched {
        Searched { infeasible: self.infeasible, evaluated: self.judged, ..Searched::default() }
    }
}

impl BoundedStudy {
    /// What the searches of a study have in common: each of them judges designs for those that follow.
    pub fn shared(plan: &Plan) -> Shared {
        let searches = Self::sought(plan).into_iter().filter(|it| !matches!(it, Sought::Cells(_))).count() as u64;
        Shared { searches, rest: None }
    }

    /// As [`BoundedStudy::search`], one after the other with what they share.
    pub fn search_sharing(
        &self,
        job: SearchJob<'_>,
        sought: Sought,
        shared: &mut Shared,
        workers: &mut [Worker<'_>],
        found: &mut Reducers,
    ) -> Option<Searched> {
        let SearchJob { plan, range, stop, progress, .. } = job;
        let mut roots = self.axes.boxes(range);
        if matches!(sought, Sought::Cells(_)) {
            // Maps are large: they are not carried along by another search.
            return Some(self.search_boxes(job, sought, &roots, 0, workers, found)?.0);
        }
        shared.searches = shared.searches.saturating_sub(1);
        let (mut settled, mut feasible) = (Searched::default(), 0);
        if let Some(rest) = &shared.rest {
            (settled, feasible) = (rest.settled(), rest.feasible);
            roots.clone_from(&rest.boxes);
            progress(settled.designs());
            if roots.is_empty() {
                return (!stop.load(Ordering::Relaxed)).then_some(settled);
            }
        }
        if let Some(mut searched) = self.extreme_of_pairs(job, sought, &self.targets(plan, sought)[0], &roots, workers, found) {
            progress(range.end - range.start - settled.designs());
            searched.add(&settled);
            searched.counted = searched.counted.map(|counted| counted + feasible);
            return (!stop.load(Ordering::Relaxed)).then_some(searched);
        }
        let (mut searched, rest) = self.search_boxes(job, sought, &roots, shared.searches, workers, found)?;
        searched.add(&settled);
        if let Some(mut rest) = rest {
            rest.take_over(shared.rest.as_ref());
            searched.counted = rest.boxes.is_empty().then_some(rest.feasible);
            // Where most is left, the whole is as soon searched as its parts.
            if rest.left(&self.axes) <= (range.end - range.start) / 2 {
                shared.rest = Some(rest);
            }
        }
        Some(searched)
    }

    /// Have searches judged at least as many designs as they have left? Then bounds settle little.
    pub fn has_judged_most(&self, shared: &Shared) -> bool {
        shared.rest.as_ref().is_some_and(|rest| rest.left(&self.axes) <= rest.judged)
    }

    /// The feasible designs: those that searches have judged, and those of what they have left, which is counted. `None` if they left more
    /// than they judged, which parts of a range had better be counted of, or it was stopped.
    pub fn count_rest(&self, shared: &Shared, threads: usize, stop: &AtomicBool) -> Option<(u64, Settled)> {
        let rest = shared.rest.as_ref().filter(|_| self.has_judged_most(shared))?;
        let taken = AtomicUsize::new(0);
        let counted = on_threads(0..threads, |_| {
            let (mut counter, mut total) = (self.counter(stop), 0);
            while let Some(spans) = rest.boxes.get(taken.fetch_add(1, Ordering::Relaxed)) {
                total += counter.count(spans, &all_open(&self.requirements, &self.axes))?;
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
}
