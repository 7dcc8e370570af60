//! How long histograms and maps take by boxes, tried on a part of them.
//!
//! Where a histogram has many bins, or a map small cells, boxes settle little, and judging every design is faster. That does not show in
//! the searches that come before.

use super::cells::CellAxes;
use super::open::all_open;
use super::{Binned, BoundedStudy, BoxTally, SearchJob, Sought, Worker};
use crate::bounds::axes::{Span, Spans};
use crate::reduce::Reducers;
use std::ops::Range;
use std::sync::atomic::Ordering;
use std::time::Instant;

impl BoundedStudy {
    /// Expected seconds of one thread for all histograms and maps of the job's range, by a share of each. Of what is counted only the part
    /// `left` is to be done; what is searched is searched again. What is tried is not kept. `None` if it was stopped.
    pub fn try_tallies(&self, job: SearchJob<'_>, worker: Worker<'_>, share: f64, left: f64) -> Option<f64> {
        let mut workers = [worker];
        let mut scratch = job.reduction.start();
        let mut expected = 0.0;
        for sought in Self::sought(job.plan) {
            let Sought::Cells(number) = sought else { continue };
            let start = Instant::now();
            let (parts, tried) = self.part_of_cells(self.maps[number], job.range, share);
            self.search_boxes(job, sought, &parts, None, &mut workers, &mut scratch)?;
            expected += start.elapsed().as_secs_f64() / tried;
        }
        for tally in Self::tallies(job.plan) {
            let start = Instant::now();
            let tried = self.try_tally(job, tally, share, &mut scratch)?;
            expected += start.elapsed().as_secs_f64() / tried * left;
        }
        (!job.stop.load(Ordering::Relaxed)).then_some(expected)
    }

    /// Counts a part of a tally; returns how large a share it was. `None` if it was stopped.
    #[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share")]
    fn try_tally(&self, job: SearchJob<'_>, tally: BoxTally, share: f64, scratch: &mut Reducers) -> Option<f64> {
        let mut counter = self.counter(job.stop).telling(job.progress);
        let open = all_open(&self.requirements, &self.axes);
        match tally {
            BoxTally::Histogram(number) => {
                let mut binned = Binned::new(&self.histograms[number], &scratch.reported.histograms[number]);
                let all = job.range.end - job.range.start;
                let middle = job.range.start + all / 2;
                let end = self.round(&(middle..job.range.end), (all as f64 * share) as u64);
                for spans in self.axes.boxes(&(middle..end)) {
                    counter.count_bins(&mut binned, &spans, &open)?;
                }
                Some((end - middle) as f64 / all as f64)
            }
            BoxTally::Map(number) => {
                let (parts, tried) = self.part_of_cells(self.maps[number], job.range, share);
                for spans in &parts {
                    counter.count_cells(self.maps[number], spans, &open, &mut |_, _| ())?;
                }
                Some(tried)
            }
        }
    }

    /// Of the boxes of a range those parts that lie in about a share of the cells of a map, with all of their designs; and how large a share
    /// of the range they are.
    #[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share")]
    fn part_of_cells(&self, cells: CellAxes, range: &Range<u64>, share: f64) -> (Vec<Spans>, f64) {
        let mut parts = self.axes.boxes(range);
        let middle = |span: Span| {
            let count = span.count();
            let levels = ((count as f64 * share.sqrt()).round() as u64).clamp(1, count);
            let low = span.low + ((count - levels) / 2) as u32;
            Span { low, high: low + (levels - 1) as u32 }
        };
        parts.iter_mut().for_each(|part| cells.axes().into_iter().for_each(|axis| part[axis] = middle(part[axis])));
        let tried: u64 = parts.iter().map(|part| self.axes.count(part)).sum();
        (parts, tried as f64 / (range.end - range.start) as f64)
    }
}

#[cfg(test)]
mod tests {
    use crate::bounds::BoundedStudy;
    use crate::plan::Plan;
    use crate::study::study_of;

    #[test]
    fn what_is_tried_lies_in_the_range_and_is_the_share_that_is_told() {
        let text = "[design]\npower_kW = { from = 1, to = 3, count = 9 }\nspeed_rpm = { from = 1000, to = 4000, count = 16 }\n\
                    friction_limit = { from = 0.2, to = 0.5, count = 5 }\n[objectives]\nfriction_margin = \"max\"\n[report]\n\
                    maps = [{ x = \"speed_rpm\", y = \"friction_limit\", best = \"share\" }]\n";
        let plan = Plan::new(study_of(&crate::models::find("pulley-load").expect("it is a model"), text).expect("the study is right"));
        let layout = BoundedStudy::new(&plan).expect("bounds serve it");
        let designs = plan.designs();
        for range in [0..designs, 0..designs / 4, designs / 2..designs, 7..designs / 3, 700..701] {
            for share in [1.0, 0.25, 1e-3] {
                let (parts, told) = layout.part_of_cells(layout.maps[0], &range, share);
                let positions: Vec<u64> = parts
                    .iter()
                    .flat_map(|part| {
                        let (rows, places) = layout.axes.rows(part, plan.fast.count());
                        rows.into_iter().flat_map(move |row| places.clone().into_iter().map(move |place| (row, place)))
                    })
                    .map(|(row, place)| row * plan.fast.count() + place)
                    .collect();
                assert!(positions.iter().all(|position| range.contains(position)), "{range:?}: {positions:?}");
                assert_eq!(told, positions.len() as f64 / (range.end - range.start) as f64, "{range:?}, {share}");
                assert!(share < 1.0 || told == 1.0, "{range:?}: {told}");
                assert!(share > 0.1 || told < 0.5 || range.end - range.start < designs / 4, "{range:?}: {told}");
            }
        }
    }
}
