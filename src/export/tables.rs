//! The tables of designs of a result.

use super::Certified;
use crate::certify::{self, Column, Role, Row};
use crate::models::{Input, Worse};
use crate::plan::Plan;
use crate::study::{Axis, Goal, Study};
use crate::table::written;
use crate::table::{Data, Table, TableColumn};

/// What a label is.
pub const LABEL: &str = "As the catalogue has it.";

/// A table of designs: index, labels, design inputs, then the worst value of every other column and its scenario. A design input that is also an
/// objective or has a constraint stands once, in all its roles.
pub fn designs(outcome: &Certified<'_>, rows: &[Row]) -> Table {
    let has_words = |input: usize| {
        let table = &outcome.plan.study.model.inputs[input];
        table.is_enumeration() || rows.iter().any(|row| table.word_for(row.inputs[input]).is_some())
    };
    of_rows(&outcome.plan.study, &label_texts(outcome.plan), &outcome.columns, rows, &has_words)
}

/// The texts of the labels of a design, in the order of the study's labels.
pub type LabelTexts<'t> = dyn Fn(u64) -> Vec<String> + 't;

/// Those of the designs of a study.
pub fn label_texts(plan: &Plan) -> impl Fn(u64) -> Vec<String> + '_ {
    |design| plan.labels(design).map(str::to_owned).collect()
}

/// The same where it is known which inputs have words in the table, some rows of which these may be.
pub fn of_rows(study: &Study, labels: &LabelTexts<'_>, columns_of: &[Column], rows: &[Row], has_words: &dyn Fn(usize) -> bool) -> Table {
    let model = &study.model;
    let mut columns = vec![TableColumn::index("design_index", "Index of the design in the study.", rows.iter().map(|row| Some(row.index)))];
    let mut texts = vec![Vec::with_capacity(rows.len()); study.labels.len()];
    if !texts.is_empty() {
        rows.iter().for_each(|row| texts.iter_mut().zip(labels(row.index)).for_each(|(column, text)| column.push(text)));
    }
    for (label, texts) in study.labels.iter().zip(texts) {
        columns.push(TableColumn::new(&label.name, "label", LABEL, Data::Text(texts)));
    }
    for &input in study.design.iter().flat_map(Axis::inputs) {
        columns.push(input_column(&model.inputs[input], rows.iter().map(|row| row.inputs[input]), has_words(input)));
    }
    let first_input = 1 + study.labels.len();
    for (at, column) in columns_of.iter().enumerate() {
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

/// The column of an input.
pub fn input_column(input: &Input, values: impl Iterator<Item = f64>, words: bool) -> TableColumn {
    let data = if words { Data::Text(values.map(|it| written(input, it)).collect()) } else { Data::Number(values.map(Some).collect()) };
    TableColumn { unit: input.unit.symbol.to_owned(), ..TableColumn::new(&input.name, "design", &input.doc, data) }
}

/// Every design, feasible or not.
pub fn variants(outcome: &Certified<'_>, rows: &[Row]) -> Table {
    let mut table = designs(outcome, rows);
    let words = rows.iter().map(|row| if row.feasible { "yes" } else { "no" }.to_owned()).collect();
    table.columns.push(TableColumn::new("feasible", "feasible", "Does it satisfy everything in every scenario?", Data::Text(words)));
    table
}
