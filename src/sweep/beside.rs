//! The front before a sweep on a device: what is near the designs that a coarse look has found.

use super::SweepJob;
use crate::reduce::Reducers;
use crate::screen::CpuEngine;
use std::collections::HashSet;
use std::ops::Range;
use std::sync::atomic::Ordering;
use std::time::Instant;

/// How many levels away, largest first.
const DISTANCES: [u64; 5] = [16, 8, 4, 2, 1];

/// Judges in f64 the rows near those of the front, and near those that are on it then, until none is better or so many seconds are over.
///
/// Until a device is told of a front, all that would be on it survives and comes back. A row costs little where it is judged at once.
pub(super) fn look_beside_front(job: SweepJob<'_>, whole: &Range<u64>, seconds: f64, seen: &mut Reducers) {
    let SweepJob { plan, tables, reduction, control, .. } = job;
    let width = plan.fast.count();
    if !tables.has_ordered_rows() {
        return;
    }
    let mut engine = CpuEngine::new(plan, tables).stopping_on(&control.stop);
    let (mut centres, mut met) = (HashSet::new(), HashSet::new());
    let start = Instant::now();
    loop {
        let mut rows: Vec<u64> = seen.front.points().indices.iter().map(|&design| plan.position_of(design) / width).collect();
        rows.sort_unstable();
        rows.dedup();
        rows.retain(|&row| centres.insert(row));
        if rows.is_empty() {
            return;
        }
        for row in DISTANCES.iter().flat_map(|&levels| rows.iter().flat_map(move |&row| plan.slow.beside(row, levels))) {
            let (first, last) = (row * width, row * width + (width - 1));
            if whole.contains(&first) && whole.contains(&last) && met.insert(row) {
                engine.screen_for(first..last + 1, reduction, seen);
            }
            if control.stop.load(Ordering::Relaxed) || start.elapsed().as_secs_f64() > seconds {
                return;
            }
        }
    }
}
