//! The front of several fronts.

use super::{Front, Points};
use crate::parallel::on_threads;

/// The front of what several fronts under the same objectives have seen: the points of each that no other front beats, sorted as a front sorts
/// its own. Points that several have, such as those they started with, come once.
///
/// Each front is compared with the others on a thread of its own. To merge one into another would compare all points again, on one thread.
pub fn together(mut fronts: Vec<Front>) -> Points {
    on_threads(&mut fronts, Front::merge_waiting);
    let dimensions = fronts.first().map_or(0, |front| front.rules.len());
    let stays = |own: usize| {
        let points = &fronts[own].points;
        let beaten = |point: usize| {
            let others = fronts.iter().enumerate().filter(|(other, _)| *other != own);
            others.into_iter().any(|(_, other)| other.beats_from(points.key(point, dimensions), points.indices[point]))
        };
        (0..points.len()).filter(|&point| !beaten(point)).map(|point| (own, point)).collect::<Vec<_>>()
    };
    let mut places: Vec<(usize, usize)> = on_threads(0..fronts.len(), stays).concat();
    let at = |(front, point): (usize, usize)| (fronts[front].points.key(point, dimensions), fronts[front].points.indices[point]);
    // A stable sort takes what each front has as one run.
    places.sort_by(|&a, &b| {
        let ((a, a_index), (b, b_index)) = (at(a), at(b));
        let by_key = a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|ordering| ordering.is_ne());
        by_key.unwrap_or_else(|| a_index.cmp(&b_index))
    });
    places.dedup_by_key(|place| at(*place).1);
    let mut points = Points::default();
    for (key, index) in places.into_iter().map(at) {
        points.push(key.iter().copied(), index);
    }
    points
}
