//! The picture of a map.

use super::Map;
use super::shown::{has_words, value_of};
use crate::contours::{Contour, Vertex};
use crate::pictures::{self, Contours, Curve, MapDetails, PlotQuantity};
use crate::study::{Best, ContourSpec, MapSpec, Study, Thresholds};
use crate::table::written;
use crate::table::{Data, Table};

/// A map, from its table, with the lines that it asks for.
pub fn picture(study: &Study, spec: &MapSpec, map: &Map, table: &Table, contours: &[Contour]) -> String {
    let axis = |axis: usize| {
        let axis = &study.design[axis];
        let input = &study.model.inputs[axis.inputs()[0]];
        (PlotQuantity::new(&input.name, input.unit.symbol), (0..axis.count()).map(|level| axis.value(0, level)).collect::<Vec<_>>())
    };
    let (x, y) = (axis(spec.x), axis(spec.y));
    let words = |axis: usize, values: &[f64]| {
        let input = &study.model.inputs[study.design[axis].inputs()[0]];
        has_words(study, &study.design[axis]).then(|| values.iter().map(|&value| written(input, value)).collect())
    };
    let (name, unit) = value_of(study, spec);
    let Data::Number(cells) = &table.columns[2].data else { unreachable!("the third column of a map is its value") };
    debug_assert_eq!(cells.len() as u64, map.size().0 * map.size().1);
    let details = MapDetails {
        whole: matches!(spec.value, Best::Value(quantity, _) if quantity.is_whole(&study.model)),
        words: [words(spec.x, &x.1), words(spec.y, &y.1)],
        contours: (!spec.contours.is_empty()).then(|| spec.contours.iter().map(|it| lines(study, it, contours)).collect()),
    };
    pictures::heatmap(&study.title, (&x.0, &x.1), (&y.0, &y.1), &PlotQuantity::new(name, unit), cells, &details)
}

/// The lines of one of the quantities.
fn lines(study: &Study, spec: &ContourSpec, contours: &[Contour]) -> Contours {
    let point = |vertex: &Vertex| (vertex.x, vertex.y);
    let lines = |contour: &Contour| contour.lines.iter().map(|line| line.iter().map(point).collect()).collect();
    let curve = |contour: &Contour| Curve { at: contour.at, lines: lines(contour) };
    Contours {
        quantity: PlotQuantity::new(spec.of.name(&study.model), spec.of.unit(&study.model)),
        every_change: spec.at == Thresholds::Changes,
        curves: contours.iter().filter(|contour| contour.of == spec.of).map(curve).collect(),
    }
}
