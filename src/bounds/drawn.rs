//! A sample of the feasible designs by bounds.
//!
//! The sample is the feasible designs that come first in a shuffled order of all (`reduce/sample`). Where a design stands in it is told by
//! its index alone, so of a box the designs are looked through for those that come early, and only these are judged. Bounds settle the boxes
//! without a feasible design before. How far the order must be looked at shows in the feasible designs that its start has.

use super::axes::Spans;
use super::open::{Decided, Open, all_open, decide, is_infeasible};
use super::shared::cut_for;
use super::sought::Searched;
use super::{BoundedStudy, SearchJob, Worker};
use crate::parallel::on_threads;
use crate::reduce::{FeasibleSample, Reducer, Reducers, Shuffle};
use std::ops::RangeInclusive;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

/// Most designs of a study: the place of every design is computed that stands in a box with feasible ones.
pub const MOST_DESIGNS: u64 = 10_000_000_000;
/// A box is looked through where so many of its designs are expected early in the order: bounds of its parts would take longer than
/// judging them.
const FEW: f64 = 4.0;
/// Most designs of a box that is looked through at once.
const MOST_AT_ONCE: u64 = 1 << 16;
/// Designs that are judged together: the more, the more of them share a row.
const TOGETHER: usize = 1 << 12;
/// Feasible designs from which on their number tells how far to look.
const TELLING: u64 = 30;
/// How many times as far is looked where there are fewer.
const FARTHER: f64 = 16.0;

/// A box that may have feasible designs, with the requirements that are not settled over it.
type OpenBox = (Spans, Vec<Open>);

/// One look at a stretch of the order.
struct OrderLook<'a> {
    layout: &'a BoundedStudy,
    job: SearchJob<'a>,
    shuffle: Shuffle,
    /// The stretch.
    places: RangeInclusive<u64>,
    /// A box of so few designs is looked through.
    at_once: u64,
    /// Is it likely the last? Then it settles what it looks through.
    is_last: bool,
    /// Designs of the range of which progress was not told yet.
    untold: &'a AtomicU64,
}

/// What came of a look, on one thread or all.
struct DrawnDesigns {
    sample: FeasibleSample,
    searched: Searched,
    /// Feasible designs that were found.
    feasible: u64,
}

/// How far the order of all designs is looked at.
struct OrderReach {
    /// Feasible designs that are wanted, and some more: the first look tells how many there are, the next one nearly always finds enough.
    wanted: f64,
    designs: u64,
    /// Share of the order that was looked at, and the feasible designs that it had.
    share: f64,
    feasible: u64,
}

#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "estimates")]
impl OrderReach {
    fn new(count: usize, designs: u64) -> Self {
        // Six standard deviations of how many of the first designs are feasible, at most.
        let wanted = count as f64 + 6.0 * (count as f64).sqrt();
        Self { wanted, designs, share: 0.0, feasible: 0 }
    }

    /// The share to be looked at next: all of the first designs may be feasible.
    fn next(&self) -> f64 {
        let share = match self.feasible {
            _ if self.share == 0.0 => self.wanted / self.designs as f64,
            0..TELLING => self.share * FARTHER,
            // Three standard deviations of the few that were found.
            found => self.share * self.wanted / (found as f64 - 3.0 * (found as f64).sqrt()),
        };
        share.min(1.0)
    }

    /// Will the next look very likely be the last?
    fn is_last(&self) -> bool {
        self.feasible >= TELLING || self.next() == 1.0
    }

    /// The places that are in one share of the order, and not in another.
    fn places(from: f64, to: f64) -> RangeInclusive<u64> {
        // 2 to the power of 64: a share of 1 has every place.
        let end = |share: f64| (share * 18_446_744_073_709_551_616.0) as u64;
        (if from == 0.0 { 0 } else { end(from) + 1 })..=end(to)
    }

    /// Designs of a box of which few have their places in a share of the order.
    fn at_once(share: f64) -> u64 {
        ((FEW / share) as u64).min(MOST_AT_ONCE)
    }
}

impl BoundedStudy {
    /// Draws the study's sample from a range of positions into what was found; how all designs of the range were settled. `None` if it was
    /// stopped, or no sample is asked for.
    pub fn draw(&self, job: SearchJob<'_>, workers: &mut [Worker<'_>], found: &mut Reducers) -> Option<Searched> {
        let SearchJob { plan, range, stop, progress, .. } = job;
        let asked = plan.study.report.sample?;
        let kept = found.reported.samples.first_mut()?;
        let size = range.end - range.start;
        let open = all_open(&self.requirements, &self.axes);
        let whole: Vec<OpenBox> = self.axes.boxes(range).into_iter().map(|spans| (spans, open.clone())).collect();
        let parts = cut_for(workers.len(), whole, &self.axes);
        let (mut reach, mut searched, untold) = (OrderReach::new(asked.count, size), Searched::default(), AtomicU64::new(size));
        while reach.feasible < asked.count as u64 && reach.share < 1.0 {
            let share = reach.next();
            let places = OrderReach::places(reach.share, share);
            let shuffle = Shuffle::new(asked.seed);
            let (at_once, is_last) = (OrderReach::at_once(share), reach.is_last());
            let look = OrderLook { layout: self, job, shuffle, places, at_once, is_last, untold: &untold };
            let taken = AtomicUsize::new(0);
            let looked = on_threads(workers.iter_mut(), |worker| {
                let sample = FeasibleSample::new(asked.count, asked.seed);
                let mut own = DrawnDesigns { sample, searched: Searched::default(), feasible: 0 };
                let mut early = Vec::new();
                while let Some(part) = parts.get(taken.fetch_add(1, Ordering::Relaxed)) {
                    look.through(part, worker, &mut early, &mut own);
                }
                look.judge(&mut early, worker, &mut own);
                own
            });
            if stop.load(Ordering::Relaxed) {
                return None;
            }
            // Each look has boxes of its own, smaller than those of the one before: the last one tells what became of the designs.
            (searched.infeasible, searched.evaluated) = (0, 0);
            for own in looked {
                kept.merge(own.sample);
                searched.add(&own.searched);
                reach.feasible += own.feasible;
            }
            reach.share = share;
        }
        // What is left comes later in the order than all of the sample, or was judged by an earlier look.
        searched.beaten = size - searched.infeasible - searched.evaluated;
        progress(untold.into_inner());
        Some(searched)
    }
}

impl OrderLook<'_> {
    /// Looks through a box for the designs that come `early`, and judges them.
    fn through(&self, root: &OpenBox, worker: &mut Worker<'_>, early: &mut Vec<u64>, own: &mut DrawnDesigns) {
        let BoundedStudy { axes, requirements, .. } = self.layout;
        let mut stack = vec![root.clone()];
        while let Some((spans, open)) = stack.pop() {
            if self.job.stop.load(Ordering::Relaxed) {
                return;
            }
            own.searched.boxes += 1;
            let size = axes.count(&spans);
            let is_infeasible = is_infeasible(requirements, &mut worker.bounder, axes, &spans, &open);
            match (!is_infeasible).then(|| decide(requirements, &mut worker.bounder, axes, &spans, &open)) {
                None | Some(Decided::Infeasible) => {
                    own.searched.infeasible += size;
                    self.tell(size);
                }
                Some(Decided::Open(open, ..)) if size <= self.at_once || open.is_empty() && size <= MOST_AT_ONCE => {
                    self.find(&spans, early);
                    self.tell(size);
                    if early.len() >= TOGETHER {
                        self.judge(early, worker, own);
                    }
                }
                Some(Decided::Open(open, pull, _)) => {
                    let longest = axes.longest(&spans);
                    let pulled = (0..axes.designs).filter(|&axis| !spans[axis].is_single() && pull[axis] > 0.0);
                    let axis = pulled.max_by(|a, b| pull[*a].total_cmp(&pull[*b])).unwrap_or(longest);
                    stack.extend(spans.halves(axis).map(|half| (half, open.clone())));
                }
            }
        }
    }

    /// The positions of the designs of a box that come early.
    fn find(&self, spans: &Spans, early: &mut Vec<u64>) {
        let SearchJob { plan, .. } = self.job;
        let (row, axes) = (plan.fast.count(), &self.layout.axes);
        let ((rows, places), (of_rows, of_places)) = (axes.rows(spans, row), axes.indices(spans, row));
        let of_rows = (rows.iter().map(|it| it * row).collect(), of_rows);
        // Many at a time: along the rows, or across them where a box has less of each.
        let (few, many) = if rows.len() <= places.len() { (of_rows, (places, of_places)) } else { ((places, of_places), of_rows) };
        for (position, index) in few.0.iter().zip(few.1) {
            self.shuffle.each_within(&self.places, index, &many.1, |at| early.push(position + many.0[at]));
        }
    }

    /// Judges the designs that come early, for the sample.
    fn judge(&self, early: &mut Vec<u64>, worker: &mut Worker<'_>, own: &mut DrawnDesigns) {
        early.sort_unstable();
        own.searched.evaluated += early.len() as u64;
        own.searched.evaluations += early.len() as u64;
        worker.engine.screen_some(early, |block| {
            own.feasible += block.feasible_count;
            own.sample.absorb(block);
        });
        early.clear();
    }

    /// Tells of settled designs, of each once, whatever looks there are.
    fn tell(&self, designs: u64) {
        if self.is_last {
            let less = |untold: u64| Some(untold.saturating_sub(designs));
            let untold = self.untold.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less).unwrap_or_default();
            (self.job.progress)(designs.min(untold));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::find;
    use crate::plan::Plan;
    use crate::reduce::Reduction;
    use crate::screen::{CpuEngine, Tables};
    use crate::study::study_of;
    use std::sync::atomic::AtomicBool;

    /// A study with scenarios of which few designs, some, most, all or none are feasible.
    fn plan(least: &str, sample: &str) -> Plan {
        let text = format!(
            "[design]\npower_kW = {{ from = 1, to = 3, count = 19 }}\nmean_radius_mm = {{ from = 30, to = 90, count = 21 }}\n\
             wrap_angle_deg = {{ from = 60, to = 200, count = 17 }}\n[operation]\nspeed_rpm = {{ from = 1000, to = 4000, count = 4 }}\n\
             [constraints]\nfriction_margin = {{ min = {least} }}\n[objectives]\nresultant_force_N = \"min\"\n[report]\nsample = {sample}\n"
        );
        Plan::new(study_of(&find("pulley-load").expect("it is a model"), &text).expect("the study is right"))
    }

    #[test]
    fn a_drawn_sample_is_that_of_judging_every_design() {
        let mut met = [false; 4];
        for (least, sample) in ["-9", "0.3", "0.15", "0.1", "0.05", "9"]
            .into_iter()
            .flat_map(|it| ["1", "20", "{ count = 700, seed = 3 }", "9000"].map(|sample| (it, sample)))
        {
            let plan = plan(least, sample);
            let layout = BoundedStudy::new(&plan).expect("bounds serve it");
            let (tables, stop, told) = (Tables::new(&plan), AtomicBool::new(false), AtomicU64::new(0));
            let reduction = Reduction::new(&plan, &[]);
            let half = plan.designs() / 2;
            for range in [0..plan.designs(), 100..half, half..half + 3, 5..5] {
                let progress = |designs| {
                    told.fetch_add(designs, Ordering::Relaxed);
                };
                let job = SearchJob { plan: &plan, reduction: &reduction, range: &range, stop: &stop, progress: &progress };
                let mut workers = vec![layout.worker(&plan, &tables, &stop), layout.worker(&plan, &tables, &stop)];
                let (mut found, mut every) = (reduction.start(), reduction.start());
                let searched = layout.draw(job, &mut workers, &mut found).expect("nobody stops it");
                CpuEngine::new(&plan, &tables).screen(range.clone(), |block| reduction.absorb(&mut every, block));
                assert_eq!(found.reported.samples, every.reported.samples, "{least} {sample} {range:?}");
                let size = range.end - range.start;
                assert_eq!((searched.designs(), told.swap(0, Ordering::Relaxed)), (size, size));
                let kinds = [searched.infeasible > 0, searched.beaten > 0, every.feasible == size, every.feasible == 0];
                met.iter_mut().zip(kinds).for_each(|(met, own)| *met |= own && size > 100);
            }
        }
        assert_eq!(met, [true; 4]);
    }

    #[test]
    fn who_stops_it_gets_no_sample() {
        // More than there are: the first look tells what it settles.
        let plan = plan("0.1", "9000");
        let layout = BoundedStudy::new(&plan).expect("bounds serve it");
        let (tables, stop, reduction) = (Tables::new(&plan), AtomicBool::new(true), Reduction::new(&plan, &[]));
        let range = 0..plan.designs();
        let job = SearchJob { plan: &plan, reduction: &reduction, range: &range, stop: &stop, progress: &|_| () };
        assert_eq!(layout.draw(job, &mut [layout.worker(&plan, &tables, &stop)], &mut reduction.start()), None);
        // In the middle: once it has settled something.
        stop.store(false, Ordering::Relaxed);
        let job = SearchJob { progress: &|_| stop.store(true, Ordering::Relaxed), ..job };
        assert_eq!(layout.draw(job, &mut [layout.worker(&plan, &tables, &stop)], &mut reduction.start()), None);
    }

    #[test]
    fn each_look_goes_farther_until_there_are_enough() {
        let mut reach = OrderReach::new(1000, 1_000_000);
        assert!(reach.next() > 0.001 && reach.next() < 0.0013 && !reach.is_last());
        for (share, feasible, next, is_last) in
            [(0.001, 0, 0.016, false), (0.016, 29, 0.256, false), (0.016, 400, 0.05598, true), (0.1, 3, 1.0, true)]
        {
            (reach.share, reach.feasible) = (share, feasible);
            assert!((reach.next() - next).abs() < 1e-4 && reach.is_last() == is_last, "{share} {feasible}: {}", reach.next());
        }
        // Even if nearly enough were found.
        (reach.share, reach.feasible) = (0.05, 999);
        assert!(reach.next() > 0.05);
    }

    #[test]
    fn of_too_many_designs_it_is_refused_and_says_so() {
        let text = "[design]\npower_kW = { from = 1, to = 3, count = 100_000 }\nspeed_rpm = { from = 1000, to = 4000, count = 100_001 }\n\
                    [objectives]\nresultant_force_N = \"min\"\n[report]\nsample = 20\n";
        let refused = |text: &str| {
            super::super::refusal(&Plan::new(study_of(&find("pulley-load").expect("it is a model"), text).expect("the study is right")))
        };
        assert!(refused(text).is_some_and(|why| why.contains("10000000000 designs at most")), "{:?}", refused(text));
        assert_eq!(refused(&text.replace("100_001", "100_000")), None);
    }

    #[test]
    fn every_place_is_in_one_look() {
        assert_eq!(OrderReach::places(0.0, 1.0), 0..=u64::MAX);
        let (first, second) = (OrderReach::places(0.0, 0.3), OrderReach::places(0.3, 1.0));
        assert_eq!((*first.start(), first.end() + 1, *second.end()), (0, *second.start(), u64::MAX));
    }
}
