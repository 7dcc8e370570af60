//! The pictures of a result.

use super::table::{Data, Table};
use super::tables::map_value;
use super::{Outcome, Summary};
use crate::pictures::{self, Quantity};
use crate::reduce::{Histogram, Map};
use crate::study::{Goal, HistogramSpec, MapSpec, Study};

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

/// A map, from its table.
pub fn map(study: &Study, spec: &MapSpec, map: &Map, table: &Table) -> String {
    let axis = |axis: usize| {
        let axis = &study.design[axis];
        let input = &study.model.inputs[axis.inputs()[0]];
        (Quantity::new(input.name, input.unit.symbol), (0..axis.count()).map(|level| axis.value(0, level)).collect::<Vec<_>>())
    };
    let (x, y) = (axis(spec.x), axis(spec.y));
    let (name, unit) = map_value(study, spec);
    let Data::Number(cells) = &table.columns[2].data else { unreachable!("the third column of a map is its value") };
    debug_assert_eq!(cells.len() as u64, map.size().0 * map.size().1);
    pictures::heatmap(&study.title, (&x.0, &x.1), (&y.0, &y.1), &Quantity::new(name, unit), cells)
}
