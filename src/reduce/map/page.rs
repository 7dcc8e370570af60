//! Maps on the page, from their files.

use super::files::{CSV_CELLS, contours_name, names};
use super::shown::value_of as map_value;
use super::stripes::stripes;
use crate::error::Result;
use crate::plan::Plan;
use crate::reading::designs::design_of;
use crate::reading::packed::{Packed, packed};
use crate::reading::{Folder, changed, number, owned, picture_of, rows_of};
use crate::study::{Axis, Best, Goal, Levels, MapSpec, Study, Thresholds, value_of};
use crate::table::written;
use serde_json::{Map, Value, json};
use std::path::Path;

/// Stands for the design of a cell that has none.
const NO_DESIGN: u64 = u64::MAX;
/// Most vertices of the lines over a map.
const MOST_VERTICES: usize = 2_000_000;

/// All maps of a study.
pub fn maps(folder: &Folder<'_>, data: &mut Map<String, Value>) -> Result<()> {
    let study = &folder.plan.study;
    let all = study.report.maps.iter().zip(names(study)).map(|(spec, name)| map(folder.path, folder.plan, spec, &name));
    data.insert("maps".to_owned(), all.collect::<Result<Vec<_>>>()?.into());
    Ok(())
}

/// A map: its cells, or its picture where they are too many for a page, and the lines over it.
fn map(folder: &Path, plan: &Plan, spec: &MapSpec, name: &str) -> Result<Value> {
    let study = &plan.study;
    let model = &study.model;
    let shown = study.design[spec.x].count() * study.design[spec.y].count() <= CSV_CELLS;
    let axis = |position: usize| {
        let axis = &study.design[position];
        let input = axis.inputs()[0];
        let table = &model.inputs[input];
        let levels = if shown { axis.count() } else { 0 };
        let values: Vec<Value> = (0..levels).map(|level| value_of(model, input, axis.value(0, level))).collect();
        json!({ "name": table.name, "unit": table.unit.symbol, "doc": table.doc, "values": values })
    };
    let is_log = |position: usize| matches!(study.design[position], Axis::Single { levels: Levels::Even { log, .. } | Levels::Step { log, .. }, .. } if log);
    let (value, unit) = map_value(study, spec);
    let (best, doc) = match spec.value {
        Best::Value(quantity, goal) => (if goal == Goal::Min { "min" } else { "max" }, quantity.doc(model)),
        Best::Share => ("share", "Share of the cell's designs that are feasible."),
    };
    let mut striped = None;
    let (cells, picture) = if shown {
        let (file, columns) = (folder.join(format!("{name}.csv")), map_columns(study, spec));
        let size = study.design[spec.x].count() * study.design[spec.y].count();
        let rows = rows_of(&file, &columns, usize::try_from(size).unwrap_or(usize::MAX))?;
        if rows.len() as u64 != size {
            return Err(changed(&file, "it is no map of this study"));
        }
        let places = (0..study.design[spec.y].count()).flat_map(|y| (0..study.design[spec.x].count()).map(move |x| (x, y)));
        let elsewhere = |read: &str, axis: usize, level: u64| {
            let axis = &study.design[axis];
            *read != written(&model.inputs[axis.inputs()[0]], axis.value(0, level))
        };
        if places.zip(&rows).any(|((x, y), row)| elsewhere(&row[0], spec.x, x) || elsewhere(&row[1], spec.y, y)) {
            return Err(changed(&file, "its cells are not where the study's axes are"));
        }
        let values: Option<Vec<f64>> = rows.iter().map(|row| number(&row[2])).collect();
        let values = values.ok_or_else(|| changed(&file, "a cell is no number"))?;
        let mut parts = vec![Packed::F64(values.clone()).bytes()];
        let indices = columns.len() == 4;
        if indices {
            let design = |cell: &str| if cell.is_empty() { Some(NO_DESIGN) } else { design_of(cell, plan) };
            let designs: Option<Vec<u64>> = rows.iter().map(|row| design(&row[3])).collect();
            let designs = designs.ok_or_else(|| changed(&file, "a design_index is not one of the study"))?;
            let known: Vec<_> = designs.iter().map(|&it| (it != NO_DESIGN).then_some(it)).collect();
            striped = stripes(plan, spec, &values, &known);
            parts.push(Packed::U64(designs).bytes());
        }
        (Some(json!({ "indices": indices, "packed": packed(parts) })), None)
    } else {
        (None, Some(picture_of(&folder.join(format!("{name}.svg")))?))
    };
    let mut contours =
        if spec.contours.is_empty() || !shown { Vec::new() } else { contours(&folder.join(contours_name(name)), study, spec)? };
    // What was asked for and is nowhere on the map is said, too.
    for asked in &spec.contours {
        let Thresholds::At(values) = &asked.at else { continue };
        let of = asked.of.name(model);
        let missing = values.iter().filter(|value| contours.iter().all(|it| it["of"] != of || it["at"] != **value));
        let missing: Vec<Value> = missing.map(|value| json!({ "of": of, "at": value, "lines": [] })).collect();
        contours.extend(if shown { missing } else { Vec::new() });
    }
    let [x, y] = [axis(spec.x), axis(spec.y)];
    let name = |axis: &Value| axis["name"].as_str().unwrap_or_default().to_owned();
    Ok(json!({
        "title": format!("{value} over {} and {}", name(&x), name(&y)), "x": x, "y": y,
        "value": { "name": value, "unit": unit, "doc": doc }, "best": best, "log": [is_log(spec.x), is_log(spec.y)],
        "cells": cells, "picture": picture, "contours": contours, "stripes": striped,
    }))
}

/// The columns of the file of a map.
fn map_columns(study: &Study, spec: &MapSpec) -> Vec<String> {
    let [x, y] = [spec.x, spec.y].map(|axis| study.model.inputs[study.design[axis].inputs()[0]].name.as_str());
    let (value, _) = map_value(study, spec);
    let value = if [x, y].contains(&value) { format!("{value}_value") } else { value.to_owned() };
    let mut columns = vec![x.to_owned(), y.to_owned(), value];
    columns.extend((spec.value != Best::Share).then(|| "design_index".to_owned()));
    columns
}

/// The lines over a map, those of one quantity and threshold together.
fn contours(file: &Path, study: &Study, spec: &MapSpec) -> Result<Vec<Value>> {
    let names = [spec.x, spec.y].map(|axis| study.model.inputs[study.design[axis].inputs()[0]].name.as_str());
    let rows = rows_of(file, &owned(["of", "at", "line", names[0], names[1], "bracket", "along"]), MOST_VERTICES)?;
    let mut found: Vec<(String, f64, Vec<Vec<f64>>)> = Vec::new();
    let mut line = String::new();
    for row in rows {
        let finite = |at: usize| row[at].parse().ok().filter(|it: &f64| it.is_finite());
        let number = |at: usize| finite(at).ok_or_else(|| changed(file, "a vertex is no number"));
        let (of, at) = (&row[0], number(1)?);
        if !spec.contours.iter().any(|it| it.of.name(&study.model) == of) || row[2].parse::<u64>().is_err() {
            return Err(changed(file, "it has lines that the study does not ask for"));
        }
        if found.last().is_none_or(|it| it.0 != of || it.1.to_bits() != at.to_bits()) {
            found.push((of.to_owned(), at, Vec::new()));
            line.clear();
        }
        let lines = &mut found.last_mut().expect("one was put there").2;
        if line != row[2] || lines.is_empty() {
            row[2].clone_into(&mut line);
            lines.push(Vec::new());
        }
        lines.last_mut().expect("one was put there").extend([number(3)?, number(4)?]);
    }
    Ok(found.into_iter().map(|(of, at, lines)| json!({ "of": of, "at": at, "lines": lines })).collect())
}
