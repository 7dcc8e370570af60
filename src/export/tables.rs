//! The tables of designs of a result.

use super::Certified;
use crate::certify::{self, Role, Row};
use crate::models::Worse;
use crate::study::{Axis, Goal};
use crate::table::written;
use crate::table::{Data, Table, TableColumn};

/// What a label is.
pub const LABEL: &str = "As the catalogue has it.";

/// A table of designs: index, labels, design inputs, then the worst value of every other column and its scenario. A design input that is also an
/// objective or has a constraint stands once, in all its roles.
pub fn designs(outcome: &Certified<'_>, rows: &[Row]) -> Table {
    let study = &outcome.plan.study;
    let model = &study.model;
    let mut columns = vec![TableColumn::index("design_index", "Index of the design in the study.", rows.iter().map(|row| Some(row.index)))];
    for (number, label) in study.labels.iter().enumerate() {
        let texts = rows.iter().filter_map(|row| outcome.plan.labels(row.index).nth(number)).map(str::to_owned);
        columns.push(TableColumn::new(&label.name, "label", LABEL, Data::Text(texts.collect())));
    }
    for &input in study.design.iter().flat_map(Axis::inputs) {
        let table = &model.inputs[input];
        let values = rows.iter().map(|row| row.inputs[input]);
        let words = table.is_enumeration() || values.clone().any(|value| table.word_for(value).is_some());
        let data =
            if words { Data::Text(values.map(|value| written(table, value)).collect()) } else { Data::Number(values.map(Some).collect()) };
        let column = TableColumn::new(&table.name, "design", &table.doc, data);
        columns.push(TableColumn { unit: table.unit.symbol.to_owned(), ..column });
    }
    let first_input = 1 + study.labels.len();
    for (at, column) in outcome.columns.iter().enumerate() {
        let (role, direction) = match column.role {
            Role::Objective(objective) => {
                ("objective", if study.objectives[objective].goal == Goal::Min { "min".to_owned() } else { "max".to_owned() })
            }
            Role::Constraint(constraint) => ("constraint", study.constraints[constraint].in_words()),
            Role::Report if column.is_end_asked(study) => {
                ("report", format!("{} of the scenarios", column.end().map_or("worst", Worse::word)))
            }
            Role::Report => ("report", String::new()),
        };
        let direction = match column.over_words(study) {
            Some(words) if direction.is_empty() => words,
            Some(words) => format!("{direction}, {words}"),
            None => direction,
        };
        if let Some(input) = certify::design_input(study, column.quantity) {
            let held = &mut columns[first_input + input];
            held.role = format!("{}, {role}", held.role);
            held.direction = if held.direction.is_empty() { direction } else { format!("{}, {direction}", held.direction) };
            continue;
        }
        columns.push(TableColumn {
            unit: column.unit(study),
            direction,
            ..TableColumn::new(&column.name, role, &column.doc(study), Data::Number(rows.iter().map(|row| row.columns[at].value).collect()))
        });
        let scenarios = rows.iter().map(|row| row.columns[at].value.map(|_| row.columns[at].scenario));
        let what = if column.over.is_worst() {
            "The scenario in which it is the worst."
        } else {
            "The scenario of the other axes in which it is the worst: that of its first case."
        };
        columns.push(TableColumn::index(&format!("{}_scenario", column.name), what, scenarios));
    }
    Table { columns }
}

/// Every design, feasible or not.
pub fn variants(outcome: &Certified<'_>, rows: &[Row]) -> Table {
    let mut table = designs(outcome, rows);
    let words = rows.iter().map(|row| if row.feasible { "yes" } else { "no" }.to_owned()).collect();
    table.columns.push(TableColumn::new("feasible", "feasible", "Does it satisfy everything in every scenario?", Data::Text(words)));
    table
}
