//! Certification: every reported design is computed again by the scalar f64 reference.
//!
//! The reference evaluates every scenario of a design, so it also finds the worst scenario for each column. If it finds a design
//! infeasible, or its objectives differ from those of the sweep, the program stops.

use crate::error::{Error, Result};
use crate::keys::{KeyRule, Points};
use crate::models::{Latest, Set, Sizes, Status, Worse, fill_si, judge, shown};
use crate::parallel::on_threads;
use crate::plan::{Plan, worst_end};
use crate::screen::Control;
use crate::study::{Axis, Constraint, Quantity, Study};
use std::sync::atomic::{AtomicBool, Ordering};

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

/// A column of the result tables: a quantity at its worst scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name of the column: the quantity's, with `_constrained` added if an objective of the same quantity has the other worst end.
    pub name: String,
    /// The quantity.
    pub quantity: Quantity,
    /// Why the column is there; the first reason if there are several.
    pub role: Role,
    /// What makes a scenario worse.
    worst: Worst,
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

    /// Do both choose the same scenario?
    fn same(self, other: Self) -> bool {
        let end = |worst| match worst {
            Self::End(worse) => Some(worse),
            Self::Margin(Constraint { low: Some(_), high: None, .. }) => Some(Worse::Lower),
            Self::Margin(Constraint { low: None, high: Some(_), .. }) => Some(Worse::Higher),
            Self::Margin(_) => None,
        };
        end(self).is_some() && end(self) == end(other)
    }
}

/// The columns of a study's tables: objectives, constraints, report columns, in file order, each quantity once where one column
/// serves all.
pub fn columns(study: &Study) -> Vec<Column> {
    let model = &study.model;
    let mut columns: Vec<Column> = Vec::new();
    let objectives = study.objectives.iter().enumerate().map(|(n, it)| (it.quantity, Role::Objective(n), Worst::End(it.goal.worse())));
    let constraints = study.constraints.iter().enumerate().map(|(n, it)| (it.quantity, Role::Constraint(n), Worst::Margin(*it)));
    let report = study.report.columns.iter().map(|&it| (it, Role::Report, Worst::End(worst_end(study, it))));
    for (quantity, role, worst) in objectives.chain(constraints).chain(report) {
        let held = columns.iter().find(|it| it.quantity == quantity);
        let name = quantity.name(model).to_owned();
        match held {
            // A report column of a quantity that is there already is dropped. A constraint may have another worst scenario, so it is kept.
            Some(held) if role == Role::Report || held.worst.same(worst) => {}
            Some(_) => columns.push(Column { name: name + "_constrained", quantity, role, worst }),
            None => columns.push(Column { name, quantity, role, worst }),
        }
    }
    columns
}

/// The column that has a constraint's worst value: its own, if an objective of the same quantity has the other worst end.
pub(crate) fn constraint_column(columns: &[Column], quantity: Quantity, name: &str) -> Option<usize> {
    let constrained = format!("{name}_constrained");
    let own = columns.iter().position(|it| it.quantity == quantity && it.name == constrained);
    own.or_else(|| columns.iter().position(|it| it.quantity == quantity))
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
    /// The scenario; of equally bad ones that with the lowest index.
    pub scenario: u64,
}

/// A design with all its values in the tables.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Design index.
    pub index: u64,
    /// Does it keep all constraints, with status ok, in every scenario?
    pub feasible: bool,
    /// The status in the first scenario in which it is not ok.
    pub status: Status,
    /// All inputs in their units; those that differ between scenarios have their values of scenario 0.
    pub inputs: Vec<f64>,
    /// One entry per column.
    pub columns: Vec<AtWorst>,
}

/// Computes the rows of designs, in the order given, on several threads. `control` shows the progress and can stop it.
///
/// # Errors
/// [`Error::Stopped`] after `control.stop`.
pub fn rows(plan: &Plan, columns: &[Column], designs: &[u64], threads: usize, control: &Control) -> Result<Vec<Row>> {
    let mut order: Vec<(u64, usize)> = designs.iter().enumerate().map(|(at, &design)| (plan.position_of(design), at)).collect();
    order.sort_unstable();
    let share = order.len().div_ceil(threads.max(1)).max(1);
    let parts = on_threads(order.chunks(share), |part| {
        let mut reference = Reference::new(plan, columns, &control.stop);
        let certified = |&(position, at): &(u64, usize)| {
            let row = reference.row(position)?;
            control.certified.fetch_add(1, Ordering::Relaxed);
            Some((at, row))
        };
        part.iter().map_while(certified).collect::<Vec<_>>()
    });
    let mut rows: Vec<(usize, Row)> = parts.into_iter().flatten().collect();
    if rows.len() < designs.len() {
        return Err(Error::Stopped { kept: None });
    }
    rows.sort_unstable_by_key(|(at, _)| *at);
    Ok(rows.into_iter().map(|(_, row)| row).collect())
}

/// Computes the rows of the front and compares each with the values of the sweep; sorted by the objectives, best first, then by index.
///
/// # Errors
/// [`Error::Disagreement`] if the reference disagrees; [`Error::Stopped`] after `control.stop`.
pub fn front(plan: &Plan, columns: &[Column], points: &Points, threads: usize, control: &Control) -> Result<Vec<Row>> {
    let mut rows = rows(plan, columns, &points.indices, threads, control)?;
    let objectives = &plan.study.objectives;
    // Objectives are the first columns, unless two objectives share a quantity.
    let column_of: Vec<usize> = objectives
        .iter()
        .map(|objective| columns.iter().position(|it| it.quantity == objective.quantity).expect("every objective has a column"))
        .collect();
    for (row, keys) in rows.iter().zip(points.keys.chunks(objectives.len().max(1))) {
        check_feasible(row)?;
        for ((objective, &column), &seen) in objectives.iter().zip(&column_of).zip(keys) {
            let value = row.columns[column].value.unwrap_or(f64::NAN);
            if KeyRule::from(objective).key(value) != seen {
                let name = objective.quantity.name(&plan.study.model);
                return Err(Error::Disagreement(format!(
                    "{name} of design {}: the sweep found {seen}, the f64 reference gives {value}",
                    row.index
                )));
            }
        }
    }
    rows.sort_by(|a, b| {
        let by_objective = objectives.iter().zip(&column_of).map(|(objective, &column)| {
            let badness = |row: &Row| Worst::End(objective.goal.worse()).badness(row.columns[column].value.unwrap_or(f64::NAN));
            badness(a).total_cmp(&badness(b))
        });
        by_objective.into_iter().find(|ordering| ordering.is_ne()).unwrap_or_else(|| a.index.cmp(&b.index))
    });
    Ok(rows)
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

/// The scalar f64 evaluation of designs over all scenarios. It keeps the prepared numbers of one row, which depend on slow inputs only.
struct Reference<'p> {
    plan: &'p Plan,
    columns: &'p [Column],
    wanted: Set,
    /// Outputs that the study judges by: of these an overflow is a status.
    used: Vec<usize>,
    row: Option<u64>,
    /// The prepared numbers of the first slow scenarios, as many as there is room for.
    prepared: Vec<Vec<f64>>,
    /// The prepared numbers of another slow scenario.
    beyond: Vec<f64>,
    /// Rows that differ only in inputs that their section does not read share their prepared numbers.
    latest: Latest,
    stop: &'p AtomicBool,
}

impl<'p> Reference<'p> {
    fn new(plan: &'p Plan, columns: &'p [Column], stop: &'p AtomicBool) -> Self {
        let tracked = plan.tracked.iter().map(|(it, _)| it.quantity);
        let asked = columns.iter().map(|it| it.quantity).chain(plan.study.constraints.iter().map(|it| it.quantity)).chain(tracked);
        let wanted = asked.filter_map(Quantity::output).collect();
        let (model, used) = (&plan.study.model, plan.used_outputs());
        let used = (0..model.outputs.len()).filter(|&it| used.contains(it)).collect();
        Self { plan, columns, wanted, used, row: None, prepared: Vec::new(), beyond: Vec::new(), latest: Latest::new(model), stop }
    }

    /// The row of a design; `None` if it was stopped.
    fn row(&mut self, position: u64) -> Option<Row> {
        let plan = self.plan;
        let model = &plan.study.model;
        let index = plan.design_at(position);
        let mut inputs = plan.space.inputs(index, 0);
        let first = inputs.clone();
        let row = position / plan.fast.count();
        if self.row != Some(row) {
            self.row = Some(row);
            self.prepared.clear();
        }
        let Sizes { outputs, conditions, .. } = model.kernel.sizes();
        let [mut si, mut outputs, mut margins] = [inputs.len(), outputs, conditions].map(|length| vec![0.0; length]);
        let mut feasible = true;
        let mut first_not_ok = (u64::MAX, Status::Ok);
        let mut worst = vec![(f64::NEG_INFINITY, AtWorst { value: None, scenario: 0 }); self.columns.len()];
        for q in 0..plan.slow_scenarios.count() {
            plan.slow_scenarios.set(q, &mut inputs);
            for t in 0..plan.fast_scenarios.count() {
                if self.stop.load(Ordering::Relaxed) {
                    return None;
                }
                plan.fast_scenarios.set(t, &mut inputs);
                fill_si(model, &inputs, &mut si);
                let kept = q < plan.kept_scenarios();
                if t == 0 && (!kept || self.prepared.len() as u64 == q) {
                    let mut prepared = std::mem::take(&mut self.beyond);
                    prepared.resize(model.kernel.prepared_len(), 0.0);
                    self.latest.prepare(&si, self.wanted, &mut prepared);
                    if kept { self.prepared.push(prepared) } else { self.beyond = prepared }
                }
                let prepared = if kept { &self.prepared[q as usize] } else { &self.beyond };
                model.kernel.finish(prepared, &si, self.wanted, &mut outputs);
                model.kernel.conditions(prepared, &si, &mut margins);
                let (status, present) = judge(model, &margins);
                let scenario = plan.slow_scenarios.source_index(q) + plan.fast_scenarios.source_index(t);
                let value = |quantity| match quantity {
                    Quantity::Input(input) => Some(inputs[input]),
                    Quantity::Output(output) => shown(model, &outputs, present, output),
                };
                feasible &= status == Status::Ok;
                feasible &= plan.study.constraints.iter().all(|it| value(it.quantity).is_some_and(|value| it.holds(value)));
                // A tracked quantity without a value in some scenario makes a design infeasible, as in the sweep.
                feasible &= plan.tracked.iter().all(|(it, _)| value(it.quantity).is_some());
                // What no condition takes away and is absent all the same has overflowed.
                let overflown = |&it: &usize| present.contains(it) && shown(model, &outputs, present, it).is_none();
                let overflow = status == Status::Ok && self.used.iter().any(overflown);
                let status = if overflow { Status::Overflow } else { status };
                if status != Status::Ok && scenario < first_not_ok.0 {
                    first_not_ok = (scenario, status);
                }
                for (column, (badness, at)) in self.columns.iter().zip(&mut worst) {
                    let Some(value) = value(column.quantity) else { continue };
                    let this = column.worst.badness(value);
                    if at.value.is_none() || this > *badness || (this == *badness && scenario < at.scenario) {
                        (*badness, *at) = (this, AtWorst { value: Some(value + 0.0), scenario });
                    }
                }
            }
        }
        let columns = worst.into_iter().map(|(_, at)| at).collect();
        Some(Row { index, feasible, status: first_not_ok.1, inputs: first, columns })
    }
}
