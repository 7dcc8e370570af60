//! Contours of a map: the curves in the plane of its two axes where "the worst value over all scenarios is at least the threshold"
//! changes from true to false.
//!
//! The map's colours come from the sweep, level by level. A contour is finer than the levels: the model is evaluated in f64 on a grid of
//! levels, every edge of that grid whose ends have different answers is bisected down to a billionth of the axis, and the crossings are
//! linked to polylines. They depend on the plan only, so they are the same on every engine. Constraints play no role: a line continues
//! where designs are infeasible, and ends where the quantity has no value.

mod link;
mod side;
mod worst;

pub use link::Along;
pub use side::GridAxis;

use crate::models::Worse;
use crate::parallel::on_threads;
use crate::plan::{Plan, worst_end};
use crate::study::{Axis, Best, ContourSpec, MapSpec, Quantity, Study, Thresholds};
use link::Edge;
use worst::WorstOnPlane;

/// Most levels along an axis that become nodes of the grid.
const FINEST: u64 = 256;
/// Fewest nodes along an axis with that many levels, however many scenarios there are.
const COARSEST: u64 = 24;
/// Most evaluations on the grid; beyond that it is made coarser.
const MOST_EVALUATIONS: u64 = 4_000_000;
/// Most changes of a whole number that get a line.
const MOST_CHANGES: usize = 1000;

/// Where a contour crosses an edge of the grid: in a bracket along one axis, whose ends have different answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// On the horizontal axis, in its unit.
    pub x: f64,
    /// On the vertical axis, in its unit.
    pub y: f64,
    /// Width of the bracket, of which the vertex is the middle, in the unit of its axis.
    pub bracket: f64,
    /// The axis that was bisected; the other coordinate is a level's value.
    pub along: Along,
}

/// All lines of one quantity at one threshold.
#[derive(Clone, Debug, PartialEq)]
pub struct Contour {
    /// The quantity.
    pub of: Quantity,
    /// The threshold, in its unit.
    pub at: f64,
    /// Polylines, with "at least the threshold" on their left where the levels of x go right and those of y up. A closed one ends with
    /// its first vertex.
    pub lines: Vec<Vec<Vertex>>,
}

/// The contours of a map, in file order and by threshold.
pub fn contours(plan: &Plan, map: &MapSpec, threads: usize) -> Vec<Contour> {
    if map.contours.is_empty() {
        return Vec::new();
    }
    let study = &plan.study;
    let axes = [map.x, map.y].map(|axis| &study.design[axis]);
    let levels = axes.map(|axis| move |level: u64| axis.value(0, level));
    let most = most_nodes(axes.map(Axis::count), plan.scenarios());
    let divisible = |axis: usize| !study.model.inputs[axes[axis].inputs()[0]].integer;
    let [x, y] = [0, 1].map(|axis| GridAxis::new(axes[axis].count(), most, &levels[axis], divisible(axis)));
    let wanted: Vec<_> = map.contours.iter().map(|it| (it.of, end(study, map, it.of))).collect();
    let worst = WorstOnPlane::new(plan, axes.map(|axis| axis.inputs()[0]));
    let nodes: Vec<usize> = (0..x.nodes() * y.nodes()).collect();
    let values = in_parallel(&nodes, threads, |&node| worst.at(x.at(node % x.nodes()), y.at(node / x.nodes()), &wanted));
    let mut found = Vec::new();
    for (number, spec) in map.contours.iter().enumerate() {
        for at in thresholds(spec, values.iter().filter_map(|values| values[number])) {
            let answers: Vec<_> = values.iter().map(|values| values[number].map(|value| value >= at)).collect();
            let ask = |x: f64, y: f64| worst.at(x, y, &wanted[number..=number])[0].map(|value| value >= at);
            found.push(Contour { of: spec.of, at, lines: trace(&x, &y, &answers, &ask, threads) });
        }
    }
    found
}

/// The end that is worst. For the map's own quantity it is the end that the map shows, so that the lines divide its colours.
fn end(study: &Study, map: &MapSpec, of: Quantity) -> Worse {
    match map.value {
        Best::Value(shown, goal) if shown == of => goal.worse(),
        _ => worst_end(study, of),
    }
}

/// Most nodes along an axis, so that evaluating the grid in all scenarios does not take too long.
fn most_nodes(counts: [u64; 2], scenarios: u64) -> u64 {
    let affordable = |most: &u64| {
        let nodes = counts.map(|count| count.min(*most));
        (nodes[0] * nodes[1]).checked_mul(scenarios).is_some_and(|evaluations| evaluations <= MOST_EVALUATIONS)
    };
    (COARSEST..=FINEST).rev().find(affordable).unwrap_or(COARSEST)
}

/// The thresholds of a quantity that takes these values on the grid.
fn thresholds(spec: &ContourSpec, values: impl Iterator<Item = f64>) -> Vec<f64> {
    match &spec.at {
        Thresholds::At(values) => values.clone(),
        Thresholds::Changes => {
            let ends = values.fold(None, |ends: Option<(f64, f64)>, value| {
                let (low, high) = ends.unwrap_or((value, value));
                Some((low.min(value), high.max(value)))
            });
            let Some((low, high)) = ends else { return Vec::new() };
            // Too many lines to tell apart: take every n-th.
            let step = ((high - low) / MOST_CHANGES as f64).ceil().max(1.0);
            std::iter::successors(Some(low + 1.0), |at| Some(at + step)).take_while(|at| *at <= high).take(MOST_CHANGES).collect()
        }
    }
}

/// The polylines along which the answer changes, in an order that depends on the answers only.
///
/// `answers` are those at the nodes, row by row in `y`; `ask` gives the answer between them, or `None`. A line ends at the edge of the grid
/// and where one of its sides has no answer; a crossing that no line reaches is a line of one vertex.
pub fn trace<A>(x: &GridAxis<'_>, y: &GridAxis<'_>, answers: &[Option<bool>], ask: &A, threads: usize) -> Vec<Vec<Vertex>>
where
    A: Fn(f64, f64) -> Option<bool> + Sync,
{
    let grid = link::Grid { columns: x.nodes(), answers };
    let edges = grid.crossed();
    let vertices = in_parallel(&edges, threads, |&Edge { column, row, along }| match along {
        Along::X => {
            let found = x.narrow(column, |value| ask(value, y.at(row)))?;
            Some(Vertex { x: found.middle, y: y.at(row), bracket: found.width, along })
        }
        Along::Y => {
            let found = y.narrow(row, |value| ask(x.at(column), value))?;
            Some(Vertex { x: x.at(column), y: found.middle, bracket: found.width, along })
        }
    });
    let (edges, vertices): (Vec<_>, Vec<_>) = edges.into_iter().zip(vertices).filter_map(|(edge, vertex)| Some((edge, vertex?))).unzip();
    // Without an answer in the middle of a saddle, both courses of the lines are possible.
    let centre = |column: usize, row: usize| ask(x.centre(column)?, y.centre(row)?);
    let lines = grid.link(&edges, |column, row| centre(column, row).unwrap_or(false));
    lines.into_iter().map(|line| line.into_iter().map(|at| vertices[at]).collect()).collect()
}

/// Applies a function to every item, on several threads; the results are in the order of the items.
fn in_parallel<T: Sync, R: Send>(items: &[T], threads: usize, work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let share = items.len().div_ceil(threads.max(1)).max(1);
    on_threads(items.chunks(share), |part| part.iter().map(&work).collect::<Vec<_>>()).into_iter().flatten().collect()
}

#[cfg(test)]
mod tests;
