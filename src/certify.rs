//! Certification: every reported design is computed again in f64 over every scenario.
//!
//! That also finds the worst scenario for each column. If a design turns out infeasible, or its objectives differ from those of the sweep,
//! the program stops. Many designs are computed together, by the recorded formula; then the scalar reference, which is the formula itself,
//! computes what is shown of each once more, and some designs in every scenario: the bits must be the same.

mod confirm;
mod reference;
mod worst_columns;
mod worst_lanes;

pub(crate) use worst_columns::room;
pub use worst_columns::{DesignColumns, rows_of_columns};

use crate::bounds::yields::{EnclosureProblem, YieldBounds};
use crate::error::{Error, Result};
use crate::keys::{KeyRule, Points};
use crate::models::{Status, Worse};
use crate::parallel::{on_threads, one_after_another};
use crate::plan::{Plan, Tracked};
use crate::screen::Control;
use crate::study::{Axis, ConfirmedEnd, Constraint, Objective, OverScenarios, Quantity, ReportColumn, Study, worst_end_over};
use reference::Reference;
use std::sync::atomic::Ordering;

/// Evaluations from which on designs are computed together.
const TOGETHER: u64 = 2000;

/// Whether so many designs are computed together: fewer are done before a formula is recorded.
pub(crate) fn pays_together(plan: &Plan, designs: u64) -> bool {
    designs.saturating_mul(plan.scenarios()) >= TOGETHER
}

/// Why a column is in the tables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Role {
    /// An objective (its number).
    Objective(usize),
    /// A constraint (its number).
    Constraint(usize),
    /// A column of the report.
    Report,
}

/// A column of the result tables: a quantity at its worst scenario, or its mean or sum over the cases of a spectrum.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name of the column: the quantity's, with `_mean` or `_sum` where it is one, and with `_constrained`, `_lowest` or `_highest` if a
    /// column before it has the other worst end.
    pub name: String,
    /// The quantity.
    pub quantity: Quantity,
    /// What becomes of its values over the scenarios.
    pub over: OverScenarios,
    /// Why the column is there; the first reason if there are several.
    pub role: Role,
    /// What makes a scenario worse.
    worst: Worst,
}

impl Column {
    /// Is it of this quantity, in this way? Several may be, and the first one is that of an objective, if there is one.
    pub fn is_of(&self, quantity: Quantity, over: OverScenarios) -> bool {
        self.quantity == quantity && self.over == over
    }

    /// Its unit, as text.
    pub fn unit(&self, study: &Study) -> String {
        study.unit_over(self.quantity, self.over)
    }

    /// What it is, in a sentence or two.
    pub fn doc(&self, study: &Study) -> String {
        let doc = self.quantity.doc(&study.model);
        match (self.over_words(study), self.role) {
            (Some(words), _) => format!("{doc} The {words}."),
            (None, Role::Report) if self.is_end_asked(study) => format!("{doc} The {} of the scenarios.", self.end_word()),
            (None, _) => doc.to_owned(),
        }
    }

    /// Of a mean or sum, and of a column that asks for one end: what it is of the scenarios, such as `mean over duty`.
    pub fn over_words(&self, study: &Study) -> Option<String> {
        let spectrum = study.spectrum.as_ref().filter(|_| !self.over.is_worst())?;
        let (word, name, weight) = (self.over.word(), &spectrum.name, &spectrum.weight);
        let others = study.operation.len() + study.uncertainty.len() > 1;
        let rest = if others { format!(", {} of the other scenarios", self.end_word()) } else { String::new() };
        Some(format!("{word} over {name}, weighted by {weight}{rest}"))
    }

    /// Does the report ask for the end that it shows?
    pub fn is_end_asked(&self, study: &Study) -> bool {
        let asks = |it: &&ReportColumn| self.is_of(it.of, it.over) && it.worst.is_some();
        self.role == Role::Report && study.report.columns.iter().any(|it| asks(&it) && it.worst == self.end())
    }

    fn end_word(&self) -> &'static str {
        self.end().map_or("worst", Worse::word)
    }

    /// The worst values that its value comes from: one, or those at both ends if it is the distance to two bounds.
    pub(crate) fn followed(&self) -> Vec<Tracked> {
        let worse = match self.worst {
            Worst::End(worse) => vec![worse],
            Worst::Margin(Constraint { low, high, .. }) => {
                let lower = (low.is_some() || high.is_none()).then_some(Worse::Lower);
                lower.into_iter().chain(high.map(|_| Worse::Higher)).collect()
            }
        };
        worse.into_iter().map(|worse| Tracked { quantity: self.quantity, worse, over: self.over }).collect()
    }

    /// Before any value was taken in.
    pub(crate) fn nothing() -> (f64, AtWorst) {
        (f64::NEG_INFINITY, AtWorst { value: None, scenario: 0 })
    }

    /// Takes the value of a scenario into the worst so far.
    #[inline]
    pub(crate) fn take(&self, worst: &mut (f64, AtWorst), value: f64, scenario: u64) {
        self.worst.take(worst, Some(value), scenario);
    }

    /// The value out of these.
    pub(crate) fn worst_of(&self, values: impl Iterator<Item = f64>) -> Option<f64> {
        values.max_by(|&a, &b| self.worst.badness(a).total_cmp(&self.worst.badness(b)))
    }

    /// Which end of the scenarios it shows, if that is one end and not the distance to two bounds.
    pub fn end(&self) -> Option<Worse> {
        self.worst.end()
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Worst {
    End(Worse),
    Margin(Constraint),
}

impl Worst {
    /// How bad a value is: the scenario with the largest badness is the worst.
    fn badness(self, value: f64) -> f64 {
        match self {
            Self::End(Worse::Higher) => value,
            Self::End(Worse::Lower) => -value,
            Self::Margin(constraint) => -constraint.margin(value),
        }
    }

    /// The end that is worse, if it is always the same.
    fn end(self) -> Option<Worse> {
        match self {
            Self::End(worse) => Some(worse),
            Self::Margin(Constraint { low: Some(_), high: None, .. }) => Some(Worse::Lower),
            Self::Margin(Constraint { low: None, high: Some(_), .. }) => Some(Worse::Higher),
            Self::Margin(_) => None,
        }
    }

    /// Takes in a value, if there is one; of equally bad ones that of the first scenario stays.
    #[inline]
    fn take(self, (badness, at): &mut (f64, AtWorst), value: Option<f64>, scenario: u64) {
        let Some(value) = value else { return };
        let this = self.badness(value);
        if at.value.is_none() || this > *badness || (this == *badness && scenario < at.scenario) {
            (*badness, *at) = (this, AtWorst { value: Some(value + 0.0), scenario });
        }
    }

    /// Do both choose the same scenario?
    fn same(self, other: Self) -> bool {
        self.end().is_some() && self.end() == other.end()
    }
}

/// The columns of a study's tables: objectives, constraints, report columns, in file order, each quantity once where one column
/// serves all.
pub fn columns(study: &Study) -> Vec<Column> {
    let model = &study.model;
    let mut columns: Vec<Column> = Vec::new();
    let objectives =
        study.objectives.iter().enumerate().map(|(n, it)| (it.quantity, it.over, Role::Objective(n), Worst::End(it.goal.worse()), None));
    let constraints =
        study.constraints.iter().enumerate().map(|(n, it)| (it.quantity, it.over, Role::Constraint(n), Worst::Margin(*it), None));
    let report = study.report.columns.iter().map(|it| {
        let end = it.worst.unwrap_or_else(|| worst_end_over(study, it.of, it.over));
        (it.of, it.over, Role::Report, Worst::End(end), it.worst)
    });
    for (quantity, over, role, worst, asked) in objectives.chain(constraints).chain(report) {
        let mut held = columns.iter().filter(|it| it.is_of(quantity, over)).peekable();
        let name = over.column(quantity, model);
        let is_first = held.peek().is_none();
        let is_held = held.any(|held| held.worst.same(worst));
        let name = match (role, asked) {
            _ if is_first => name,
            // A report column of a quantity that is there already is dropped, unless it asks for the other end. A constraint may have
            // another worst scenario, so it is kept.
            (Role::Report, None) => continue,
            _ if is_held => continue,
            (_, Some(end)) => format!("{name}_{}", end.word()),
            _ => name + "_constrained",
        };
        columns.push(Column { name, quantity, over, role, worst });
    }
    columns
}

/// The same with a column of every output that has none.
pub(crate) fn all_columns(study: &Study) -> Vec<Column> {
    let mut everything = study.clone();
    everything.report.columns.extend((0..everything.model.outputs.len()).map(|output| ReportColumn::from(Quantity::Output(output))));
    columns(&everything)
}

/// One column per constraint, in their order, each at the scenario that is nearest to breaking it, or breaks it most.
pub(crate) fn margin_columns(study: &Study) -> Vec<Column> {
    let column = |(n, it): (usize, &Constraint)| Column {
        name: it.name(&study.model),
        quantity: it.quantity,
        over: it.over,
        role: Role::Constraint(n),
        worst: Worst::Margin(*it),
    };
    study.constraints.iter().enumerate().map(column).collect()
}

/// One column per quantity, each at the scenario where it is lowest.
pub(crate) fn lowest_columns(study: &Study, quantities: &[Quantity]) -> Vec<Column> {
    let column = |&quantity: &Quantity| {
        let name = quantity.name(&study.model).to_owned();
        Column { name, quantity, over: OverScenarios::Worst, role: Role::Report, worst: Worst::End(Worse::Lower) }
    };
    quantities.iter().map(column).collect()
}

/// The column that has a constraint's worst value: its own, if an objective of the same quantity has the other worst end.
pub(crate) fn constraint_column(columns: &[Column], constraint: &Constraint, name: &str) -> Option<usize> {
    let constrained = format!("{name}_constrained");
    let is_its = |it: &&Column| it.is_of(constraint.quantity, constraint.over);
    let own = columns.iter().position(|it| is_its(&it) && it.name == constrained);
    own.or_else(|| columns.iter().position(|it| is_its(&it)))
}

/// Position of a quantity among the inputs that design axes set, in file order; `None` if it is not one of them. Such a quantity is the
/// same in every scenario, and its column is among the design inputs, even if it is also an objective or has a constraint.
pub fn design_input(study: &Study, quantity: Quantity) -> Option<usize> {
    study.design.iter().flat_map(Axis::inputs).position(|&input| quantity == Quantity::Input(input))
}

/// A value and its scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtWorst {
    /// The value, in its unit; `None` if it has no meaning in any scenario.
    pub value: Option<f64>,
    /// The scenario; of equally bad ones that with the lowest index. Of a mean or sum, that of its first case.
    pub scenario: u64,
}

/// A design with all its values in the tables.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Design index.
    pub index: u64,
    /// Does it keep all constraints, with status ok, in every scenario?
    pub feasible: bool,
    /// Scenarios in which it has no result: the status is not ok, or a value that the study asks for has no meaning.
    pub without_result: u64,
    /// The first of these scenarios.
    pub first_without: Option<u64>,
    /// The status in the first scenario in which it is not ok.
    pub status: Status,
    /// All inputs in their units; those that differ between scenarios have their values of scenario 0.
    pub inputs: Vec<f64>,
    /// One entry per column.
    pub columns: Vec<AtWorst>,
    /// Of each column: does its quantity have a value in every scenario?
    pub complete: Vec<bool>,
}

impl Row {
    /// A feasible design with values that an engine has seen.
    pub(crate) fn seen(plan: &Plan, index: u64, columns: Vec<AtWorst>) -> Self {
        let complete = columns.iter().map(|it| it.value.is_some()).collect();
        let inputs = plan.space.inputs(index, 0);
        Self { index, feasible: true, without_result: 0, first_without: None, status: Status::Ok, inputs, columns, complete }
    }
}

/// Computes the rows of designs, in the order given, on several threads. `control` shows the progress and can stop it.
///
/// # Errors
/// [`Error::Stopped`] after `control.stop`; [`Error::Disagreement`] if the scalar reference differs from what was computed in columns.
pub fn rows(plan: &Plan, columns: &[Column], designs: &[u64], threads: usize, control: &Control) -> Result<Vec<Row>> {
    let mut order: Vec<(u64, usize)> = designs.iter().enumerate().map(|(at, &design)| (plan.position_of(design), at)).collect();
    order.sort_unstable();
    let positions: Vec<u64> = order.iter().map(|&(position, _)| position).collect();
    let pays = pays_together(plan, designs.len() as u64);
    let together = || confirm::rows_together(plan, columns, &positions, threads, control);
    let computed = match pays.then(together).flatten() {
        Some(rows) => rows?,
        None => one_by_one(plan, columns, &positions, threads, control)?,
    };
    let mut rows: Vec<(usize, Row)> = order.into_iter().map(|(_, at)| at).zip(computed).collect();
    rows.sort_unstable_by_key(|(at, _)| *at);
    let mut rows: Vec<Row> = rows.into_iter().map(|(_, row)| row).collect();
    prove(plan, columns, &mut rows, threads, control)?;
    Ok(rows)
}

/// What differs by less, relative to itself, is the same number with other rounding errors.
const ROUNDING: f64 = 1e-9;

/// Where another scenario becomes the worst of rows in their order only by rounding, the one before stays.
pub(crate) fn keep_scenarios(plan: &Plan, columns: &[Column], rows: &mut [Row], control: &Control) {
    let mut reference = Reference::new(plan, columns, &control.stop);
    for (at, column) in columns.iter().enumerate().filter(|(_, it)| it.over.is_worst()) {
        let mut before = None;
        for (index, row) in rows.iter_mut().enumerate() {
            let AtWorst { value: Some(value), scenario } = row.columns[at] else { continue };
            if let Some(kept) = before.filter(|&kept| kept != scenario) {
                let (_, other) = reference.at(index as u64, kept);
                if other(column.quantity).is_some_and(|other| (other - value).abs() <= ROUNDING * value.abs()) {
                    row.columns[at].scenario = kept;
                }
            }
            before = Some(row.columns[at].scenario);
        }
    }
}

/// The rows of the designs at these positions by the scalar reference alone.
fn one_by_one(plan: &Plan, columns: &[Column], positions: &[u64], threads: usize, control: &Control) -> Result<Vec<Row>> {
    let begin = || Reference::new(plan, columns, &control.stop);
    let parts = one_after_another(plan.parts(positions, threads), threads, begin, |reference, part| {
        let certified = |&position: &u64| {
            let row = reference.row(position)?;
            control.certified.fetch_add(1, Ordering::Relaxed);
            Some(row)
        };
        part.iter().map_while(certified).collect::<Vec<_>>()
    });
    let rows: Vec<Row> = parts.into_iter().flatten().collect();
    if rows.len() < positions.len() {
        return Err(Error::Stopped { kept: None });
    }
    Ok(rows)
}

/// Fills in proven bounds of the yield, if they are among the columns.
fn prove(plan: &Plan, columns: &[Column], rows: &mut [Row], threads: usize, control: &Control) -> Result<()> {
    let study = &plan.study;
    let asked = columns.iter().enumerate().filter_map(|(at, it)| Some((at, study.confirmed(it.quantity).filter(|it| it.is_proven())?)));
    let asked: Vec<(usize, ConfirmedEnd)> = asked.collect();
    let refused = |problem: EnclosureProblem| Error::Request(problem.to_string());
    let Some(bounds) = YieldBounds::asked(study).map_err(refused)?.filter(|_| !asked.is_empty()) else { return Ok(()) };
    let share = rows.len().div_ceil(threads.max(1)).max(1);
    let parts = on_threads(rows.chunks_mut(share), |part| {
        for row in part {
            if control.stop.load(Ordering::Relaxed) {
                return Err(Error::Stopped { kept: None });
            }
            let found = bounds.of(row.index, bounds.width(), YieldBounds::BOXES).map_err(refused)?;
            for &(column, end) in &asked {
                let value = if end == ConfirmedEnd::AtLeast { found.at_least } else { found.at_most };
                (row.columns[column], row.complete[column]) = (AtWorst { value: Some(value), scenario: 0 }, true);
            }
        }
        Ok(())
    });
    parts.into_iter().collect()
}

/// Computes the rows of the front and compares each with the values of the sweep; sorted by the objectives, best first, then by index.
///
/// # Errors
/// [`Error::Disagreement`] if the reference disagrees; [`Error::Stopped`] after `control.stop`.
pub fn front(plan: &Plan, columns: &[Column], points: &Points, threads: usize, control: &Control) -> Result<Vec<Row>> {
    let mut rows = rows(plan, columns, &points.indices, threads, control)?;
    let objectives = &plan.study.objectives;
    let column_of = objective_columns(&plan.study, columns);
    for (row, keys) in rows.iter().zip(points.keys.chunks(objectives.len().max(1))) {
        check_feasible(row)?;
        for ((objective, &column), &seen) in objectives.iter().zip(&column_of).zip(keys) {
            let value = row.columns[column].value.unwrap_or(f64::NAN);
            if KeyRule::from(objective).key(value) != seen {
                let name = objective.name(&plan.study.model);
                return Err(Error::Disagreement(format!(
                    "{name} of design {}: the sweep found {seen}, the f64 reference gives {value}",
                    row.index
                )));
            }
        }
    }
    sort_front(plan, columns, &mut rows);
    Ok(rows)
}

/// Among the columns, that of each objective: they are the first ones, unless two objectives share a quantity.
pub(crate) fn objective_columns(study: &Study, columns: &[Column]) -> Vec<usize> {
    let column =
        |it: &Objective| columns.iter().position(|column| column.is_of(it.quantity, it.over)).expect("every objective has a column");
    study.objectives.iter().map(column).collect()
}

/// Sorts the rows of a front by the objectives, best first, then by index.
pub(crate) fn sort_front(plan: &Plan, columns: &[Column], rows: &mut [Row]) {
    let objectives = &plan.study.objectives;
    let column_of = objective_columns(&plan.study, columns);
    rows.sort_by(|a, b| {
        let by_objective = objectives.iter().zip(&column_of).map(|(objective, &column)| {
            let badness = |row: &Row| Worst::End(objective.goal.worse()).badness(row.columns[column].value.unwrap_or(f64::NAN));
            badness(a).total_cmp(&badness(b))
        });
        by_objective.into_iter().find(|ordering| ordering.is_ne()).unwrap_or_else(|| a.index.cmp(&b.index))
    });
}

/// The reference must agree that a reported design is feasible.
///
/// # Errors
/// [`Error::Disagreement`].
pub fn check_feasible(row: &Row) -> Result<()> {
    if row.feasible {
        return Ok(());
    }
    Err(Error::Disagreement(format!("design {}: the sweep found it feasible, the f64 reference does not", row.index)))
}
