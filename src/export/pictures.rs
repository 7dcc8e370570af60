//! The pictures of a result.

use super::table::{Data, Table};
use super::tables::{has_words, map_value, written};
use super::{Outcome, Summary};
use crate::contours::{Contour, Vertex};
use crate::pictures::{self, Contours, Curve, MapDetails, Quantity};
use crate::reduce::{Histogram, Map};
use crate::study::{Best, ContourSpec, Goal, HistogramSpec, MapSpec, Study, Thresholds};

fn quantity(study: &Study, of: crate::study::Quantity) -> Quantity {
    Quantity::new(of.name(study.model), of.unit(study.model))
}

/// The front over its objectives, with ideal and knee.
pub fn front(outcome: &Outcome<'_>) -> String {
    let study = &outcome.plan.study;
    let objectives: Vec<_> = study
        .objectives
        .iter()
        .map(|objective| pictures::Objective {
            quantity: quantity(study, objective.quantity),
            goal: if objective.goal == Goal::Min { pictures::Goal::Min } else { pictures::Goal::Max },
        })
        .collect();
    let summary = Summary::new(outcome);
    let points = summary.points();
    pictures::front(&study.title, &objectives, &points, summary.knee.as_ref().map(|knee| knee.row), summary.ideal.as_deref())
}

/// A histogram.
pub fn histogram(study: &Study, spec: &HistogramSpec, histogram: &Histogram) -> String {
    let Histogram { from, to, counts, below, above, .. } = histogram;
    pictures::histogram(&study.title, &quantity(study, spec.of), *from, *to, counts, *below, *above)
}

/// A map, from its table, with the lines that it asks for.
pub fn map(study: &Study, spec: &MapSpec, map: &Map, table: &Table, contours: &[Contour]) -> String {
    let axis = |axis: usize| {
        let axis = &study.design[axis];
        let input = &study.model.inputs[axis.inputs()[0]];
        (Quantity::new(input.name, input.unit.symbol), (0..axis.count()).map(|level| axis.value(0, level)).collect::<Vec<_>>())
    };
    let (x, y) = (axis(spec.x), axis(spec.y));
    let words = |axis: usize, values: &[f64]| {
        let input = &study.model.inputs[study.design[axis].inputs()[0]];
        has_words(study, &study.design[axis]).then(|| values.iter().map(|&value| written(input, value)).collect())
    };
    let (name, unit) = map_value(study, spec);
    let Data::Number(cells) = &table.columns[2].data else { unreachable!("the third column of a map is its value") };
    debug_assert_eq!(cells.len() as u64, map.size().0 * map.size().1);
    let details = MapDetails {
        whole: matches!(spec.value, Best::Value(quantity, _) if quantity.is_whole(study.model)),
        words: [words(spec.x, &x.1), words(spec.y, &y.1)],
        contours: (!spec.contours.is_empty()).then(|| spec.contours.iter().map(|it| lines(study, it, contours)).collect()),
    };
    pictures::heatmap(&study.title, (&x.0, &x.1), (&y.0, &y.1), &Quantity::new(name, unit), cells, &details)
}

/// The lines of one of the quantities.
fn lines(study: &Study, spec: &ContourSpec, contours: &[Contour]) -> Contours {
    let point = |vertex: &Vertex| (vertex.x, vertex.y);
    let lines = |contour: &Contour| contour.lines.iter().map(|line| line.iter().map(point).collect()).collect();
    let curve = |contour: &Contour| Curve { at: contour.at, lines: lines(contour) };
    Contours {
        quantity: quantity(study, spec.of),
        every_change: spec.at == Thresholds::Changes,
        curves: contours.iter().filter(|contour| contour.of == spec.of).map(curve).collect(),
    }
}
