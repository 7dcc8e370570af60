//! What the device is told of the answers so far, so that it can leave out what cannot be part of them.

use super::constants::DOMINATORS;
use super::held::on_device;
use super::kernel::{Coordinate, bins, looks_through_front, round_up, threshold, uses_table};
use super::layout::{LIST, POINTS, sign};
use crate::plan::Plan;
use crate::reduce::{Answers, MOST_OBJECTIVES};
use crate::study::{Goal, Quantity};
use bytemuck::{Pod, Zeroable};
use std::mem::offset_of;

/// The uniform `Known` of the kernel.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct KnownUniform {
    dominators: [[f32; 8]; DOMINATORS],
    top: [f32; 4],
    top_index: [u32; 4],
    extremes: [[f32; 4]; MOST_OBJECTIVES],
    extreme_indices: [[u32; 4]; MOST_OBJECTIVES],
    table: [f32; 4],
    last_place: [u32; 4],
    points: [u32; 4],
}

impl KnownUniform {
    /// Its members as the kernel must have them.
    pub(super) const MEMBERS: [(&'static str, usize); 8] = [
        ("dominators", offset_of!(KnownUniform, dominators)),
        ("top", offset_of!(KnownUniform, top)),
        ("top_index", offset_of!(KnownUniform, top_index)),
        ("extremes", offset_of!(KnownUniform, extremes)),
        ("extreme_indices", offset_of!(KnownUniform, extreme_indices)),
        ("table", offset_of!(KnownUniform, table)),
        ("last_place", offset_of!(KnownUniform, last_place)),
        ("points", offset_of!(KnownUniform, points)),
    ];
}

fn halves(index: u64) -> [u32; 2] {
    [index as u32, (index >> 32) as u32]
}

/// An f32 that reads back as `value`?
#[allow(clippy::cast_possible_truncation, reason = "the question is what rounding loses")]
fn is_held(value: f64) -> bool {
    f64::from(value as f32) == value
}

/// One side's threshold: the value as the device has it, rounded away from the better side, whether it is exact, and the index.
#[allow(clippy::cast_possible_truncation, reason = "rounding to f32 is the point")]
fn end(plan: &Plan, exact: bool, quantity: Quantity, held: Option<(f64, u64)>, towards: f64) -> (f32, f32, [u32; 2]) {
    match held {
        None => (f32::INFINITY * towards as f32, 0.0, [0; 2]),
        Some((value, index)) if exact => (value as f32, 1.0, halves(index)),
        Some((value, index)) => {
            let on_device = on_device(plan, quantity, value);
            // The unit's conversion rounds in f64; zero stays zero.
            let widened = on_device * towards + on_device.abs() * 1e-15;
            let known = f32::from(is_held(on_device) && value == 0.0);
            (round_up(widened) * towards as f32, known, halves(index))
        }
    }
}

/// The uniform and the list or table that stand for the answers so far.
pub fn known(plan: &Plan, coordinates: &[Coordinate], is_exact: impl Fn(Quantity) -> bool, answers: &Answers) -> (KnownUniform, Vec<f32>) {
    let objectives = &plan.study.objectives;
    let dimensions = objectives.len();
    let mut known = KnownUniform::zeroed();
    known.dominators = [[f32::INFINITY; 8]; DOMINATORS];
    // Sorted by the first coordinate, as the front is: the kernel relies on it where there are two.
    let thresholds = answers
        .front
        .chunks(dimensions.max(1))
        .flat_map(|key| key.iter().zip(objectives).zip(coordinates).map(|((&key, it), &coordinate)| threshold(plan, it, coordinate, key)));
    let thresholds: Vec<f32> = thresholds.collect();
    let points: Vec<&[f32]> = thresholds.chunks(dimensions.max(1)).collect();
    for (dominator, point) in known.dominators.iter_mut().zip(chosen(&points, DOMINATORS)) {
        dominator[..dimensions].copy_from_slice(point);
    }
    known.top = [f32::INFINITY, 0.0, 0.0, 0.0];
    if let (Some(top), Some((key, index))) = (plan.study.report.top, answers.top) {
        let side = sign(top.goal);
        let (value, exact, index) = end(plan, is_exact(top.by), top.by, Some((side * key, index)), side);
        // As a key: less is better whatever the goal.
        known.top = [value * side as f32, exact, 0.0, 0.0];
        known.top_index[..2].copy_from_slice(&index);
    }
    for ((extreme, indices), (objective, held)) in
        known.extremes.iter_mut().zip(&mut known.extreme_indices).zip(objectives.iter().zip(&answers.extremes))
    {
        let exact = is_exact(objective.quantity);
        let (least, least_exact, least_index) = end(plan, exact, objective.quantity, held[0], 1.0);
        let (largest, largest_exact, largest_index) = end(plan, exact, objective.quantity, held[1], -1.0);
        *extreme = [least, largest, least_exact, largest_exact];
        *indices = [least_index[0], least_index[1], largest_index[0], largest_index[1]];
    }
    known.last_place[..2].copy_from_slice(&halves(answers.last_place.unwrap_or(u64::MAX)));
    let list = if uses_table(coordinates) {
        let (place, mut cells) = table(&points, bins(coordinates) as usize, dimensions);
        known.table = place;
        if looks_through_front(coordinates) {
            let listed = chosen(&points, POINTS);
            known.points[0] = listed.len() as u32;
            cells.extend(listed.into_iter().flatten());
        }
        cells
    } else {
        let mut list = vec![f32::INFINITY; LIST * dimensions.max(1)];
        for (to, point) in list.chunks_mut(dimensions.max(1)).zip(chosen(&points, LIST)) {
            to.copy_from_slice(point);
        }
        list
    };
    (known, list)
}

/// Most numbers that [`known`] gives beside the uniform.
pub fn room(coordinates: &[Coordinate]) -> u64 {
    let dimensions = coordinates.len().max(1);
    let points = if looks_through_front(coordinates) { POINTS } else { 0 };
    let table = if uses_table(coordinates) { bins(coordinates).pow(dimensions as u32 - 1) } else { (LIST * dimensions) as u64 };
    table + (points * dimensions) as u64
}

/// Points spread over the front: for each coordinate in turn those at even ranks of it, so that none lies far from one of them.
fn chosen<'a>(points: &[&'a [f32]], count: usize) -> Vec<&'a [f32]> {
    let dimensions = points.first().map_or(0, |point| point.len());
    if points.len() <= count {
        return points.to_vec();
    }
    // On a curve one coordinate says where a point is; on a surface every coordinate gets its share.
    let ranked = if dimensions == 2 { 1 } else { dimensions };
    let mut chosen: Vec<&[f32]> = Vec::with_capacity(count);
    let mut order: Vec<usize> = (0..points.len()).collect();
    for dimension in 0..ranked {
        order.sort_by(|&a, &b| points[a][dimension].total_cmp(&points[b][dimension]));
        let share = count / ranked + usize::from(dimension < count % ranked);
        for place in 0..share {
            chosen.push(points[order[(2 * place + 1) * points.len() / (2 * share)]]);
        }
    }
    chosen
}

/// The table: per bin (or pair of bins) the least last coordinate of the points that are certainly better in the others. A point
/// counts from two bins above its own, so that no rounding of the bins' places on either side matters.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss, reason = "bins are few")]
fn table(points: &[&[f32]], bins: usize, dimensions: usize) -> ([f32; 4], Vec<f32>) {
    let binned = dimensions - 1;
    let size = bins.pow(binned as u32);
    let mut cells = vec![f32::INFINITY; size];
    let mut place = [0.0; 4];
    for dimension in 0..binned {
        let values = || points.iter().map(|point| point[dimension]);
        let (low, high) = (values().fold(f32::INFINITY, f32::min), values().fold(f32::NEG_INFINITY, f32::max));
        let scale = if high > low { (bins - 3) as f32 / (high - low) } else { 0.0 };
        place[2 * dimension] = if low.is_finite() { low } else { 0.0 };
        place[2 * dimension + 1] = if scale.is_finite() { scale } else { 0.0 };
    }
    let bin = |point: &[f32], dimension: usize| {
        let place = (point[dimension] - place[2 * dimension]) * place[2 * dimension + 1];
        place.clamp(0.0, (bins - 1) as f32) as usize + 2
    };
    for point in points {
        let at = (0..binned).map(|dimension| bin(point, dimension));
        if at.clone().all(|bin| bin < bins) {
            let cell = at.fold(0, |cell, bin| cell * bins + bin);
            cells[cell] = cells[cell].min(point[dimensions - 1]);
        }
    }
    // The least of all cells at or below in every coordinate.
    for dimension in 0..binned {
        let stride = bins.pow((binned - 1 - dimension) as u32);
        for cell in 0..size {
            if !(cell / stride).is_multiple_of(bins) {
                cells[cell] = cells[cell].min(cells[cell - stride]);
            }
        }
    }
    (place, cells)
}

/// The best keys of the cells of all maps of values, as ordered numbers.
pub fn cells(plan: &Plan, answers: &Answers) -> Vec<u32> {
    let maps = plan.study.report.maps.iter().filter_map(|spec| match spec.value {
        crate::study::Best::Value(quantity, goal) => Some((quantity, goal)),
        crate::study::Best::Share => None,
    });
    let keys = maps.zip(&answers.cells).flat_map(|((quantity, goal), cells)| {
        let side = if goal == Goal::Min { 1.0 } else { -1.0 };
        cells.iter().map(move |&key| ordered(round_up(side * on_device(plan, quantity, side * key)).next_up()))
    });
    keys.collect()
}

/// The bits of an f32 as a number of the same order, as in the kernel.
fn ordered(value: f32) -> u32 {
    let bits = value.to_bits();
    if bits >> 31 == 1 { !bits } else { bits | 0x8000_0000 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_bits_is_the_order_of_numbers() {
        let values = [f32::NEG_INFINITY, -2.0, -1e-30, 0.0, 1e-30, 1.0, f32::INFINITY];
        assert!(values.windows(2).all(|pair| ordered(pair[0]) < ordered(pair[1])));
    }

    #[test]
    fn the_table_never_beats_a_point_of_the_front_and_beats_most_of_what_lies_behind() {
        for dimensions in [2, 3] {
            let mix = |i: u64| crate::sample::mix(i) as f32 / u64::MAX as f32;
            let all: Vec<Vec<f32>> = (0..3000u64).map(|i| (0..dimensions).map(|d| mix(8 * i + d) - 0.5).collect()).collect();
            let beats = |a: &[f32], b: &[f32]| a.iter().zip(b).all(|(a, b)| a < b);
            let front: Vec<Vec<f32>> = all.iter().filter(|b| !all.iter().any(|a| beats(a, b))).cloned().collect();
            let bins = BINS_FOR_TEST[dimensions as usize - 2];
            let points: Vec<&[f32]> = front.iter().map(Vec::as_slice).collect();
            let (place, cells) = table(&points, bins, dimensions as usize);
            let beaten = |point: &[f32]| {
                let bin = |d: usize| (((point[d] - place[2 * d]) * place[2 * d + 1]) as usize).min(bins - 1);
                let cell = (0..dimensions as usize - 1).fold(0, |cell, d| cell * bins + bin(d));
                cells[cell] < point[dimensions as usize - 1]
            };
            assert!(!front.iter().any(|point| beaten(point)), "{dimensions}");
            assert!(all.iter().filter(|point| beaten(point)).all(|point| front.iter().any(|it| beats(it, point))));
            let behind = all.len() - front.len();
            assert!(all.iter().filter(|point| beaten(point)).count() * 10 > behind * 8, "{dimensions}: too few are beaten");
        }
    }

    const BINS_FOR_TEST: [usize; 2] = [65_536, 256];
}
