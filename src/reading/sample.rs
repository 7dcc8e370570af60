//! A sample of the feasible designs as a page shows it: their values in the study's columns, and where each design stands on every axis.

use super::designs::{check_header, check_row, header};
use super::packed::{Packed, packed};
use super::{changed, table_reader, unreadable};
use crate::certify::{self, Column, Role};
use crate::error::Result;
use crate::names::MOST_DOTS;
use crate::plan::Plan;
use crate::study::Axis;
use serde_json::{Value, json};
use std::path::Path;

/// Designs of a sample, column after column, then axis after axis.
pub struct ShownSample {
    rows: usize,
    of: u64,
    described: [Vec<Value>; 2],
    packed: Vec<Packed>,
}

impl ShownSample {
    /// Of `designs` with their `values`, `[column][design]` of the study's own columns; `of` is the size of the whole sample.
    pub fn new(plan: &Plan, designs: &[u64], values: Vec<Vec<f64>>, of: u64) -> Self {
        let study = &plan.study;
        let mut found = Self { rows: designs.len(), of, described: [Vec::new(), Vec::new()], packed: Vec::new() };
        for (column, values) in certify::columns(study).iter().zip(values) {
            // Dots stand where their designs are; what is only compared needs six digits.
            #[allow(clippy::cast_possible_truncation, reason = "shares of a variance do not need more digits")]
            let packed = match column.role {
                Role::Objective(_) => Packed::F64(values),
                Role::Constraint(_) | Role::Report => Packed::F32(values.into_iter().map(|it| it as f32).collect()),
            };
            found.described[0].push(json!({ "name": name_of(plan, column), "unit": column.unit(study), "type": packed.kind() }));
            found.packed.push(packed);
        }
        for (number, axis) in study.design.iter().enumerate() {
            let number_of = single_number(plan, axis);
            #[allow(clippy::cast_possible_truncation, reason = "of more levels than a u32 counts none has two designs of a sample")]
            let packed = match number_of {
                Some(input) => Packed::F64(designs.iter().map(|&design| plan.space.inputs(design, 0)[input]).collect()),
                None => Packed::U32(designs.iter().map(|&design| plan.space.level(number, design) as u32).collect()),
            };
            let name = axis.name(&study.model);
            found.described[1].push(json!({ "name": name, "type": packed.kind(), "ordered": number_of.is_some(), "levels": axis.count() }));
            found.packed.push(packed);
        }
        found
    }

    /// What a page is told about it, but for the numbers.
    pub fn describe(&self) -> Value {
        let [columns, axes] = &self.described;
        json!({ "rows": self.rows, "of": self.of, "columns": columns, "axes": axes })
    }

    /// The numbers.
    pub fn bytes(&self) -> impl Iterator<Item = Vec<u8>> {
        self.packed.iter().map(Packed::bytes)
    }
}

/// The name of a column on a page: of a design input its own.
fn name_of(plan: &Plan, column: &Column) -> String {
    let study = &plan.study;
    let own = certify::design_input(study, column.quantity).and_then(|own| study.design.iter().flat_map(Axis::inputs).nth(own));
    own.map_or_else(|| column.name.clone(), |&input| study.model.inputs[input].name.to_owned())
}

/// The input of an axis of one input without words, whose levels have an order.
fn single_number(plan: &Plan, axis: &Axis) -> Option<usize> {
    let &[input] = axis.inputs() else { return None };
    let table = &plan.study.model.inputs[input];
    (!table.is_enumeration() && !axis.has_number(0, |value| table.word_for(value).is_some())).then_some(input)
}

/// Reads the sample of a result: `all` designs, in rising order. Of more than a page shows an even part is taken.
pub fn read(file: &Path, plan: &Plan, all: u64) -> Result<Value> {
    let of_study = certify::columns(&plan.study);
    let columns = header(&plan.study, &of_study);
    let mut reader = table_reader(file)?;
    check_header(file, reader.headers().map_err(|error| unreadable(file, error))?, &columns)?;
    let place = |column: &Column| columns.iter().position(|it| *it == name_of(plan, column)).expect("the header has every column");
    let places: Vec<(usize, bool)> = of_study.iter().map(|it| (place(it), matches!(it.role, Role::Objective(_)))).collect();
    let taken = all.min(MOST_DOTS);
    let (mut designs, mut values) = (Vec::new(), vec![Vec::new(); places.len()]);
    let (mut seen, mut last) = (0, None);
    for row in reader.records() {
        let row = row.map_err(|error| unreadable(file, error))?;
        let design = check_row(file, &row, plan, &columns)?;
        if last.is_some_and(|last| last >= design) {
            return Err(changed(file, &format!("design {design} is not in rising order")));
        }
        last = Some(design);
        let shown = designs.len() as u64;
        if shown < taken && u128::from(seen) == u128::from(shown) * u128::from(all) / u128::from(taken) {
            designs.push(design);
            for (values, &(at, is_objective)) in values.iter_mut().zip(&places) {
                let value = row[at].parse().ok().filter(|it: &f64| it.is_finite());
                if is_objective && value.is_none() {
                    return Err(changed(file, &format!("{} of design {design} is not a number", columns[at])));
                }
                values.push(value.unwrap_or(f64::NAN));
            }
        }
        seen += 1;
    }
    if seen != all {
        return Err(changed(file, &format!("it has {seen} designs instead of {all}")));
    }
    let sample = ShownSample::new(plan, &designs, values, all);
    let mut told = sample.describe();
    told["packed"] = packed(sample.bytes()).into();
    Ok(told)
}
