//! Histograms and maps of a result for the page, from their files.

use super::packed::{Packed, packed};
use super::{changed, text_of, unreadable};
use crate::error::Result;
use crate::export::{CSV_CELLS, contours_name, map_value};
use crate::study::{Axis, Best, Goal, HistogramSpec, Levels, MapSpec, Study, Thresholds, value_of};
use serde_json::{Value, json};
use std::path::Path;

/// A table of numbers; absent ones are NaN.
fn numbers(file: &Path) -> Result<Vec<Vec<f64>>> {
    let mut reader = csv::Reader::from_path(file).map_err(|error| unreadable(file, error))?;
    let number = |cell: &str| cell.parse().unwrap_or(f64::NAN);
    reader.records().map(|row| Ok(row.map_err(|error| unreadable(file, error))?.iter().map(number).collect())).collect()
}

/// A histogram of all feasible designs.
pub fn histogram(folder: &Path, study: &Study, spec: &HistogramSpec, name: &str, feasible: u64) -> Result<Value> {
    let file = folder.join(format!("{name}.csv"));
    let rows = numbers(&file)?;
    let ([below, bins @ .., above], true) = (&rows[..], rows.iter().all(|row| row.len() == 3)) else {
        return Err(changed(&file, "it is no histogram"));
    };
    #[allow(clippy::cast_precision_loss, reason = "designs are far fewer than 2^53")]
    if bins.len() != spec.bins || rows.iter().map(|row| row[2]).sum::<f64>() != feasible as f64 {
        return Err(changed(&file, "its bins or their designs are not those of the study"));
    }
    let column = |at: usize| bins.iter().map(|row| row[at]).collect::<Vec<_>>();
    Ok(json!({
        "of": spec.of.name(study.model), "unit": spec.of.unit(study.model), "doc": spec.of.doc(study.model),
        "from": column(0), "to": column(1), "designs": column(2), "below": below[2], "above": above[2],
    }))
}

/// A map: its cells, or its picture where they are too many for a page, and the lines over it.
pub fn map(folder: &Path, study: &Study, spec: &MapSpec, name: &str) -> Result<Value> {
    let model = study.model;
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
    let (cells, picture) = if shown {
        let file = folder.join(format!("{name}.csv"));
        let rows = numbers(&file)?;
        let width = if spec.value == Best::Share { 3 } else { 4 };
        if rows.len() as u64 != study.design[spec.x].count() * study.design[spec.y].count() || rows.iter().any(|row| row.len() != width) {
            return Err(changed(&file, "it is no map of this study"));
        }
        // Words are not numbers: such an axis is not compared.
        let places = (0..study.design[spec.y].count()).flat_map(|y| (0..study.design[spec.x].count()).map(move |x| (x, y)));
        let elsewhere = |read: f64, axis: usize, level: u64| read != study.design[axis].value(0, level) && !read.is_nan();
        if places.zip(&rows).any(|((x, y), row)| elsewhere(row[0], spec.x, x) || elsewhere(row[1], spec.y, y)) {
            return Err(changed(&file, "its cells are not where the study's axes are"));
        }
        let column = |at: usize| Packed::F64(rows.iter().map(|row| row[at]).collect()).bytes();
        (Some(json!({ "indices": width == 4, "packed": packed((2..width).map(column)) })), None)
    } else {
        (None, Some(text_of(folder, &format!("{name}.svg"))?))
    };
    let mut contours = if spec.contours.is_empty() || !shown { Vec::new() } else { contours(&folder.join(contours_name(name)))? };
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
        "cells": cells, "picture": picture, "contours": contours,
    }))
}

/// The lines over a map, those of one quantity and threshold together.
fn contours(file: &Path) -> Result<Vec<Value>> {
    let mut reader = csv::Reader::from_path(file).map_err(|error| unreadable(file, error))?;
    let mut found: Vec<(String, f64, Vec<Vec<f64>>)> = Vec::new();
    let mut line = String::new();
    for row in reader.records() {
        let row = row.map_err(|error| unreadable(file, error))?;
        let number = |at: usize| row.get(at).and_then(|it| it.parse::<f64>().ok()).ok_or_else(|| changed(file, "a vertex is no number"));
        let (of, at) = (&row[0], number(1)?);
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
