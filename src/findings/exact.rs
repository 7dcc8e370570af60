//! The best that any design reaches of one constraint, found as the front of a study with that one objective.

use super::reached::Reached;
use crate::bounds::{BoundedStudy, SearchJob, Sought};
use crate::certify::{columns, rows};
use crate::error::{Error, Result};
use crate::plan::Plan;
use crate::reduce::{Points, Reduction};
use crate::screen::{Control, Tables};
use crate::study::{Goal, Objective, Report, Study};
use crate::sweep::{Settings, sweep};
use std::sync::atomic::Ordering;

/// Seconds of one thread, by what the model says, that judging every design may take for one such number.
const SECONDS: f64 = 1.0;
/// Boxes that bounds may look at for one such number. They are counted, not timed: a finding is the same on every machine.
const BOXES: u64 = 20_000;
/// Most constraints of a study whose numbers are found exactly.
const CONSTRAINTS: usize = 8;

/// May the designs break the other constraints?
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Alone {
    /// Yes: what is the best at all?
    Yes,
    /// No: what is the best of those that keep the others?
    No,
}

/// The best worst value of a constraint's quantity over all designs that have a result in every scenario: `Some(None)` if there is no such
/// design, `None` if that would take too long to find out.
///
/// # Errors
/// [`Error::Stopped`] after `control.stop`.
pub(super) fn best(plan: &Plan, constraint: usize, alone: Alone, threads: usize, control: &Control) -> Result<Option<Option<Reached>>> {
    let Some(study) = study_of(&plan.study, constraint, alone) else { return Ok(None) };
    let plan = Plan::new(study);
    let tables = Tables::new(&plan);
    let reduction = Reduction::new(&plan, &[]);
    #[allow(clippy::cast_precision_loss, reason = "an estimate")]
    let seconds = plan.seconds_per_design() * plan.designs() as f64;
    let points = if seconds <= SECONDS {
        let settings = Settings { threads, ..Settings::default() };
        Some(sweep(&plan, &tables, &reduction, &settings, None, &Control::default())?.state.front)
    } else {
        by_bounds(&plan, &tables, &reduction, control)
    };
    if control.stop.load(Ordering::Relaxed) {
        return Err(Error::Stopped { kept: None });
    }
    let Some(points) = points else { return Ok(None) };
    // Of equally good designs the front has the one with the lowest index only.
    let Some(&design) = points.indices.iter().min() else { return Ok(Some(None)) };
    let row = rows(&plan, &columns(&plan.study), &[design], 1, control)?;
    let value = row.first().and_then(|row| row.columns.first()).and_then(|column| column.value);
    Ok(Some(value.map(|value| Reached { value, design, exact: true })))
}

/// The study with one objective in place of a constraint; `None` if there is no such.
fn study_of(study: &Study, constraint: usize, alone: Alone) -> Option<Study> {
    let bounded = &study.constraints[constraint];
    let goal = match (bounded.low, bounded.high) {
        (Some(_), None) => Goal::Max,
        (None, Some(_)) => Goal::Min,
        // Of two bounds the nearer one counts, which is no objective.
        _ => return None,
    };
    if study.constraints.len() > CONSTRAINTS {
        return None;
    }
    let others = study.constraints.iter().enumerate().filter(|&(other, _)| other != constraint && alone == Alone::No).map(|(_, it)| *it);
    Some(Study {
        objectives: vec![Objective { quantity: bounded.quantity, over: bounded.over, goal, resolution: None }],
        constraints: others.collect(),
        report: Report { front_budget: u64::MAX, ..Report::default() },
        ..study.clone()
    })
}

/// The best design by bounds; `None` if they cannot serve the study, take too many boxes or were stopped.
fn by_bounds(plan: &Plan, tables: &Tables, reduction: &Reduction, control: &Control) -> Option<Points> {
    let mut layout = BoundedStudy::new(plan)?;
    layout.most_boxes = BOXES;
    let mut found = reduction.start();
    // One thread: then the boxes are the same ones on every machine.
    let mut workers = vec![layout.worker(plan, tables, &control.stop)];
    let all = 0..plan.designs();
    let job = SearchJob { plan, reduction, range: &all, stop: &control.stop, progress: &|_| {} };
    layout.search(job, Sought::Front, &mut workers, &mut found)?;
    Some(found.front.points().clone())
}
