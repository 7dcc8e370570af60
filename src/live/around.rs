//! What is around a design: along each input that is chosen, the values of objectives and constraints, all else as it is.

use crate::certify::{self, Column, Role, Row};
use crate::error::Result;
use crate::plan::Plan;
use crate::screen::Control;
use crate::study::{Axis, Levels, Report, Study};

/// Places along an input.
pub const PLACES: u64 = 33;

/// Designs that differ in one input.
#[derive(Debug)]
pub struct Slice {
    /// The input.
    pub input: usize,
    /// Its value in the design.
    pub own: f64,
    /// Its values, from the least.
    pub values: Vec<f64>,
    /// The design at each of them, by the f64 reference.
    pub rows: Vec<Row>,
}

/// The inputs that have a slice around a design, with their levels: axes of numbers.
pub fn sliced<'p>(plan: &'p Plan, inputs: &[f64]) -> Vec<(usize, &'p Levels)> {
    let study = &plan.study;
    let single = study.design.iter().filter_map(|axis| match axis {
        Axis::Single { input, levels } => Some((*input, levels)),
        _ => None,
    });
    let of_numbers = |&(input, levels): &(usize, &Levels)| {
        let table = &study.model.inputs[input];
        let has_words = (0..levels.count().min(1000)).any(|at| table.word_for(levels.value(at)).is_some());
        !has_words && table.word_for(inputs[input]).is_none()
    };
    single.filter(of_numbers).collect()
}

/// The slices around a design over its axes of numbers, each of about `most` places, and the columns of their rows: objectives and
/// constraints. What is only reported may cost more than all else, as fresh draws do.
///
/// # Errors
/// [`Error::Stopped`](crate::error::Error::Stopped) after `control.stop`.
pub fn around(plan: &Plan, design: u64, most: u64, threads: usize, control: &Control) -> Result<(Vec<Column>, Vec<Slice>)> {
    let study = &plan.study;
    let inputs = plan.space.inputs(design, 0);
    let mut slices = Vec::new();
    let columns: Vec<Column> = certify::columns(study).into_iter().filter(|it| it.role != Role::Report).collect();
    for (input, levels) in sliced(plan, &inputs) {
        let values = places(levels, study.model.inputs[input].integer, inputs[input], most);
        let line = Plan::new(along(study, &inputs, input, &values));
        let designs: Vec<u64> = (0..line.designs()).collect();
        let rows = certify::rows(&line, &columns, &designs, threads, control)?;
        slices.push(Slice { input, own: inputs[input], values, rows });
    }
    Ok((columns, slices))
}

/// The study of the designs that differ in one input.
fn along(study: &Study, inputs: &[f64], varied: usize, values: &[f64]) -> Study {
    let single = |&input: &usize| {
        let values = if input == varied { values.to_vec() } else { vec![inputs[input]] };
        Axis::Single { input, levels: Levels::List(values) }
    };
    Study {
        design: study.design.iter().flat_map(Axis::inputs).map(single).collect(),
        labels: Vec::new(),
        sample: None,
        report: Report { columns: study.report.columns.clone(), front_budget: study.report.front_budget, ..Report::default() },
        ..study.clone()
    }
}

/// Values between the ends of an axis, with that of the design among them.
#[allow(clippy::cast_precision_loss, reason = "a few places of a picture")]
fn places(levels: &Levels, integer: bool, own: f64, most: u64) -> Vec<f64> {
    let (low, high) = levels.ends();
    let is_log = matches!(levels, Levels::Even { log: true, .. } | Levels::Step { log: true, .. } | Levels::Continuous { log: true, .. });
    let place = |at: u64| {
        let t = at as f64 / (most - 1) as f64;
        match at {
            0 => low,
            at if at == most - 1 => high,
            _ if integer => (low + t * (high - low)).round(),
            _ if is_log => low * (high / low).powf(t),
            _ => low + t * (high - low),
        }
    };
    let mut values: Vec<f64> = (0..most).map(place).chain([own]).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}
