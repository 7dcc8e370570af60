//! What rows are evaluated by: a model, or a study.

use super::refusal;
use crate::certify::{self, Column, DesignColumns, Row};
use crate::error::Result;
use crate::export::tables::{input_column, of_rows};
use crate::likeness::remedy;
use crate::models::{EvaluatedColumns, ManyOptions, Model, evaluate_columns};
use crate::plan::Plan;
use crate::screen::Control;
use crate::study::{Axis, Constraint, Study};
use crate::table::{Data, TableColumn};
use std::sync::Arc;

/// What rows are evaluated by.
#[derive(Debug)]
pub struct BatchTarget {
    model: Arc<Model>,
    kind: BatchKind,
    /// Names that `--set` gives: no column may give them too.
    set: Vec<String>,
    /// Was it asked for on the command line, whose options messages may name?
    has_options: bool,
}

#[derive(Debug)]
enum BatchKind {
    /// With these values of the inputs that have no column.
    Model(Vec<f64>),
    /// In the worst of its scenarios; what the tables of its results have.
    Study(Box<Study>, Vec<Column>),
}

/// The given columns, and those of the results.
type RowColumns = (Vec<TableColumn>, Vec<TableColumn>);

impl BatchTarget {
    /// A model, where inputs without a column have these values; `set` names those of them that the user gave.
    pub fn of_model(model: Arc<Model>, inputs: Vec<f64>, set: Vec<String>) -> Self {
        Self { model, kind: BatchKind::Model(inputs), set, has_options: true }
    }

    /// A study, every row of which is a design; `set` names inputs whose values the user gave.
    pub fn of_study(study: Study, set: Vec<String>) -> Self {
        let columns = certify::columns(&study);
        Self { model: study.model.clone(), kind: BatchKind::Study(Box::new(study), columns), set, has_options: true }
    }

    /// The same for who has no command line: messages name no options of it.
    pub fn without_options(self) -> Self {
        Self { has_options: false, ..self }
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The input that a column of this name gives, or why it can give none.
    pub(super) fn input(&self, name: &str) -> std::result::Result<usize, String> {
        let model = &self.model;
        if self.set.iter().any(|it| it == name) {
            return Err("--set gives it too; keep one of the two".to_owned());
        }
        let Some(input) = model.input(name) else {
            let (carry, drop) = if self.has_options {
                let carry = format!("--carry {name} takes it along as it is");
                (carry.clone(), format!("drop the column, or {carry}"))
            } else {
                ("drop the column".to_owned(), "drop the column".to_owned())
            };
            if model.output(name).is_some() {
                return Err(format!("it is a result and no input; {drop}"));
            }
            let names: Vec<&str> = model.inputs.iter().map(|it| it.name.as_str()).collect();
            return Err(format!("{} has no such input; {}", model.name, remedy(name, &names, || carry.clone())));
        };
        let BatchKind::Study(study, _) = &self.kind else { return Ok(input) };
        for (role, axes) in [("operation", &study.operation), ("uncertainty", &study.uncertainty)] {
            if axes.iter().any(|axis| axis.inputs().contains(&input)) {
                return Err(format!("the study gives it in [{role}], and judges every row over all of that; drop the column"));
            }
        }
        Ok(input)
    }

    /// Says which inputs have a column.
    pub(super) fn given(&mut self, given: &[usize]) -> Result<()> {
        if given.is_empty() {
            let names = || self.model.inputs.iter().map(|it| it.name.as_str()).collect::<Vec<_>>().join(", ");
            let inputs = if self.has_options { format!("those of beltspace models {}", self.model.name) } else { names() };
            return Err(refusal(format!("there is no column with the values of an input; inputs are {inputs}")));
        }
        let BatchKind::Study(study, _) = &mut self.kind else { return Ok(()) };
        let mut missing = Vec::new();
        for axis in &study.design {
            for (column, &input) in axis.inputs().iter().enumerate().filter(|(_, input)| !given.contains(input)) {
                if axis.count() == 1 {
                    study.fixed[input] = axis.value(column, 0);
                } else {
                    missing.push(self.model.inputs[input].name.clone());
                }
            }
        }
        study.sample = None;
        match &missing[..] {
            [] => Ok(()),
            [first, ..] => {
                let option = if self.has_options { format!(", or give one value with --set {first}=...") } else { String::new() };
                let missing = missing.join(", ");
                Err(refusal(format!("the rows must say what the study chooses: there is no column {missing}; add it{option}")))
            }
        }
    }

    /// Evaluates rows: the values of the given inputs, column by column.
    pub(super) fn evaluate(
        &self,
        given: &[usize],
        values: &[&[f64]],
        has_words: &dyn Fn(usize) -> bool,
        threads: usize,
    ) -> Result<RowColumns> {
        self.refuse_replaced(given, values)?;
        match &self.kind {
            BatchKind::Model(inputs) => self.by_model(inputs, given, values, has_words, threads),
            BatchKind::Study(..) => self.by_study(given, values, has_words, threads, &Control::default()),
        }
    }

    /// Values of the inputs that have no column, if this is a model.
    pub(super) fn base(&self) -> Option<&[f64]> {
        match &self.kind {
            BatchKind::Model(inputs) => Some(inputs),
            BatchKind::Study(..) => None,
        }
    }

    /// The worst of rows over the scenarios of the study that this must be.
    pub(super) fn by_study(
        &self,
        given: &[usize],
        values: &[&[f64]],
        has_words: &dyn Fn(usize) -> bool,
        threads: usize,
        control: &Control,
    ) -> Result<RowColumns> {
        let BatchKind::Study(study, columns) = &self.kind else { panic!("this is a model, no study") };
        by_study(study, columns, given, values, has_words, threads, control)
    }

    /// Refuses rows that give an input although a number of another one takes its place.
    pub(super) fn refuse_replaced(&self, given: &[usize], values: &[&[f64]]) -> Result<()> {
        let model = &self.model;
        let fixed = match &self.kind {
            BatchKind::Model(inputs) => inputs,
            BatchKind::Study(study, _) => &study.fixed,
        };
        let is_number = |input: usize, value: f64| model.inputs[input].word_for(value).is_none();
        let column = |name: &str| given.iter().position(|&input| model.inputs[input].name == name);
        // What else the study or --set gives differs from what the model takes by itself, or makes no difference.
        let differs = |name: &str| {
            let other = model.input(name).filter(|&it| fixed[it] != model.inputs[it].default);
            other.filter(|_| matches!(self.kind, BatchKind::Study(..)) || self.set.iter().any(|it| it == name))
        };
        let gives_numbers = |name: &str| match column(name) {
            Some(column) => values[column].iter().any(|&value| is_number(given[column], value)),
            None => differs(name).is_some_and(|input| is_number(input, fixed[input])),
        };
        let gives = |name: &str| column(name).is_some() || differs(name).is_some();
        match model.contradiction(gives_numbers, gives) {
            None => Ok(()),
            Some((input, other)) => {
                let message = format!("{other} cannot be given beside {input}, which takes its place; drop the column of one of the two");
                Err(refusal(message))
            }
        }
    }

    fn by_model(
        &self,
        base: &[f64],
        given: &[usize],
        values: &[&[f64]],
        has_words: &dyn Fn(usize) -> bool,
        threads: usize,
    ) -> Result<RowColumns> {
        let model = &self.model;
        let names = given.iter().map(|&input| model.inputs[input].name.as_str());
        let columns: Vec<(&str, &[f64])> = names.zip(values.iter().copied()).collect();
        let options = ManyOptions::default().inputs(base).threads(threads);
        let EvaluatedColumns { statuses, outputs } = evaluate_columns(model, &columns, &options)?;
        let inputs =
            given.iter().zip(values).map(|(&input, values)| input_column(&model.inputs[input], values.iter().copied(), has_words(input)));
        let columns = model.outputs.iter().enumerate().map(|(number, output)| TableColumn {
            unit: output.unit.symbol.to_owned(),
            ..TableColumn::new(
                &output.name,
                "output",
                &output.doc,
                Data::Number(outputs[number].iter().map(|&value| (!value.is_nan()).then_some(value)).collect()),
            )
        });
        let status = statuses.iter().map(|it| it.reason(model).to_owned());
        let results = columns.chain([status_column("Is it ok, and if not, why?", status)]).collect();
        Ok((inputs.collect(), results))
    }
}

fn status_column(doc: &str, status: impl Iterator<Item = String>) -> TableColumn {
    TableColumn::new("status", "status", doc, Data::Text(status.collect()))
}

/// Rows as the designs of a study whose only axis is them.
fn by_study(
    study: &Study,
    columns: &[Column],
    given: &[usize],
    values: &[&[f64]],
    has_words: &dyn Fn(usize) -> bool,
    threads: usize,
    control: &Control,
) -> Result<RowColumns> {
    let model = &study.model;
    let count = values[0].len();
    let rows: Vec<Vec<f64>> = (0..count).map(|row| values.iter().map(|it| it[row]).collect()).collect();
    let mut own = study.clone();
    own.design = vec![Axis::Joint { inputs: given.to_vec(), rows }];
    // The rows are designs of their own, not those of a catalogue.
    own.labels.clear();
    let found = if count == 0 {
        Vec::new()
    } else {
        let plan = Plan::new(own.clone());
        let together = || certify::rows_of_columns(&plan, columns, DesignColumns { inputs: given, values }, threads, control);
        match certify::pays_together(&plan, count as u64).then(together).flatten() {
            Some(rows) => rows?,
            None => certify::rows(&plan, columns, &(0..count as u64).collect::<Vec<_>>(), threads, control)?,
        }
    };
    let mut table = of_rows(&own, &|_| Vec::new(), columns, &found, has_words).columns;
    // The rows have no number in the study.
    table.remove(0);
    let mut results = table.split_off(given.len());
    results.extend(study.constraints.iter().map(|constraint| margin_column(study, constraint, columns, &found)));
    let feasible = found.iter().map(|row| if row.feasible { "yes" } else { "no" }.to_owned());
    results.push(TableColumn::new("feasible", "feasible", "Does it satisfy everything in every scenario?", Data::Text(feasible.collect())));
    let status = found.iter().map(|row| row.status.reason(model).to_owned());
    results.push(status_column("Is it ok in every scenario, and if not, why not in the first?", status));
    Ok((table, results))
}

/// The least margin of a constraint over the scenarios.
fn margin_column(study: &Study, constraint: &Constraint, columns: &[Column], rows: &[Row]) -> TableColumn {
    let name = constraint.name(&study.model);
    let at = certify::constraint_column(columns, constraint, &name);
    let margin = |row: &Row| row.columns[at?].value.map(|value| constraint.margin(value));
    TableColumn {
        unit: study.unit_over(constraint.quantity, constraint.over),
        direction: constraint.in_words(),
        ..TableColumn::new(
            &format!("{name}_margin"),
            "margin",
            "The least distance to a bound of the constraint over the scenarios; negative where it is violated.",
            Data::Number(rows.iter().map(margin).collect()),
        )
    }
}
