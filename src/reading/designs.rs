//! Reads a result's tables of designs and checks that they are as this program writes them: the columns, and in every row the design, its
//! inputs and that numbers are numbers.

use super::{changed, table_reader, unreadable};
use crate::certify::{self, Column};
use crate::error::Result;
use crate::plan::Plan;
use crate::study::{Axis, Study};
use crate::table::written;
use serde_json::{Value, json};
use std::collections::HashSet;
use std::path::Path;

/// Most rows of a list on a page.
const MOST_LISTED: usize = 20_000;
/// The column of a list of all designs that says which are feasible.
const FEASIBLE: &str = "feasible";

/// The inputs that design axes set: axis, column of the axis, input.
pub fn inputs(study: &Study) -> impl Iterator<Item = (&Axis, usize, usize)> {
    study.design.iter().flat_map(|axis| axis.inputs().iter().enumerate().map(move |(column, &input)| (axis, column, input)))
}

/// The index of a design, if it is written as this program writes it.
pub fn design_of(text: &str, plan: &Plan) -> Option<u64> {
    text.parse().ok().filter(|&it: &u64| it < plan.designs() && it.to_string() == text)
}

/// The header of such a table.
pub fn header(study: &Study, columns: &[Column]) -> Vec<String> {
    let inputs = inputs(study).map(|(_, _, input)| study.model.inputs[input].name.to_owned());
    let columns = columns.iter().filter(|it| certify::design_input(study, it.quantity).is_none());
    let columns = columns.flat_map(|it| [it.name.clone(), format!("{}_scenario", it.name)]);
    let labels = study.labels.iter().map(|it| it.name.clone());
    std::iter::once("design_index".to_owned()).chain(labels).chain(inputs).chain(columns).collect()
}

/// Refuses a header that is not the expected one.
pub fn check_header(file: &Path, found: &csv::StringRecord, expected: &[String]) -> Result<()> {
    if *found == *expected {
        return Ok(());
    }
    let differs = expected.iter().zip(found.iter()).find(|(expected, found)| expected.as_str() != *found);
    let shown = |text: &str| text.chars().take(60).flat_map(char::escape_debug).collect::<String>();
    let differs = differs.map_or("their number".to_owned(), |(expected, found)| format!("\"{}\" in place of \"{expected}\"", shown(found)));
    Err(changed(file, &format!("its columns are not those of the study: {differs}")))
}

/// The design of a row. Its labels and inputs must be those of the study, its values numbers, its scenarios scenarios of the study.
pub fn check_row(file: &Path, row: &csv::StringRecord, plan: &Plan, header: &[String]) -> Result<u64> {
    let study = &plan.study;
    let design = design_of(&row[0], plan).ok_or_else(|| changed(file, "it has a design_index that the study does not have"))?;
    let own = plan.space.inputs(design, 0);
    let shown = |text: &str| text.chars().take(60).flat_map(char::escape_debug).collect::<String>();
    let mut at = 1;
    for (label, given) in study.labels.iter().zip(plan.labels(design)) {
        if row[at] != *given {
            let (name, found) = (&label.name, shown(&row[at]));
            return Err(changed(file, &format!("{name} of design {design} is {found}, and the study gives {given}")));
        }
        at += 1;
    }
    for (_, _, input) in inputs(study) {
        let (table, found) = (&study.model.inputs[input], &row[at]);
        let given = written(table, own[input]);
        if *found != given {
            let name = &table.name;
            return Err(changed(file, &format!("{name} of design {design} is {}, and the study gives {given}", shown(found))));
        }
        at += 1;
    }
    while at + 1 < header.len() {
        let (name, value, scenario) = (&header[at], &row[at], &row[at + 1]);
        if !value.is_empty() && !value.parse().is_ok_and(f64::is_finite) {
            return Err(changed(file, &format!("{name} of design {design} is not a number")));
        }
        let known = scenario.parse().is_ok_and(|it: u64| it < plan.scenarios() && it.to_string() == scenario);
        if !(known || (value.is_empty() && scenario.is_empty())) {
            let scenarios = plan.scenarios();
            let found = shown(scenario);
            let problem = format!("{name}_scenario is not one of the study's {scenarios} scenarios: design {design} has \"{found}\"");
            return Err(changed(file, &problem));
        }
        at += 2;
    }
    Ok(design)
}

/// A list of designs as text, with the units of its columns; a list of all designs also says which are feasible.
pub fn list(file: &Path, plan: &Plan, most: u64, all: bool) -> Result<Value> {
    let study = &plan.study;
    let model = &study.model;
    let of_study = certify::columns(study);
    let own = header(study, &of_study);
    let mut columns = own.clone();
    columns.extend(all.then(|| FEASIBLE.to_owned()));
    let mut reader = table_reader(file)?;
    check_header(file, reader.headers().map_err(|error| unreadable(file, error))?, &columns)?;
    let unit = |name: &String| {
        let column = of_study.iter().find(|it| it.name == *name).map(|it| it.unit(study));
        column.or_else(|| model.input(name).map(|it| model.inputs[it].unit.symbol.to_owned())).unwrap_or_default()
    };
    let units: Vec<_> = columns.iter().map(unit).collect();
    let (mut rows, mut known) = (Vec::new(), HashSet::new());
    for row in reader.records() {
        let row = row.map_err(|error| unreadable(file, error))?;
        let design = check_row(file, &row, plan, &own)?;
        if all && !["yes", "no"].contains(&&row[own.len()]) {
            return Err(changed(file, &format!("it does not say whether design {design} is feasible")));
        }
        if !known.insert(design) {
            return Err(changed(file, &format!("design {design} is there twice")));
        }
        if known.len() as u64 > most {
            return Err(changed(file, &format!("it has more than {most} designs")));
        }
        if rows.len() < MOST_LISTED {
            rows.push(row.iter().map(str::to_owned).collect::<Vec<_>>());
        }
    }
    if all && known.len() as u64 != most {
        return Err(changed(file, &format!("it has {} designs, not {most}", known.len())));
    }
    let mut list = json!({ "columns": columns, "units": units, "rows": rows, "of": known.len() });
    if !study.labels.is_empty() {
        list["labels"] = study.labels.iter().map(|it| it.name.as_str()).collect();
    }
    Ok(list)
}
