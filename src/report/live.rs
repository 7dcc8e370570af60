//! What the page of a study in work is told: as the page of a result has it, step by step, with the numbers as they are in memory.

use super::front::{ShownFront, of_rows};
use super::inputs::{drawn, inputs};
use super::{constraints_json, model_json, objectives_json, scenario_inputs};
use crate::certify::objective_columns;
use crate::export::ideal_and_knee;
use crate::live::{Live, LiveCounts, LiveFront};
use crate::models::OVERFLOW;
use crate::plan::Plan;
use crate::reading::sample::ShownSample;
use crate::study::{number, with_whole_paths};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::time::Duration;

pub use super::page::{LIVE_FILES, live_page};

/// What a front says, and its numbers: columns one after the other, each with its scenarios behind it where it has some.
pub fn front(found: &LiveFront<'_>) -> (Value, Vec<u8>) {
    let LiveFront { plan, columns, rows, .. } = *found;
    let study = &plan.study;
    let (shown, bytes) = of_rows(plan, columns, rows);
    let ShownFront { objectives, constraints, scenarios, json: mut front, .. } = shown;
    let places = objective_columns(study, columns);
    let value = |row: &crate::certify::Row, place: usize| row.columns[place].value.unwrap_or(f64::NAN);
    let points: Vec<Vec<f64>> = rows.iter().map(|row| places.iter().map(|&place| value(row, place)).collect()).collect();
    let indices: Vec<u64> = rows.iter().map(|row| row.index).collect();
    let (ideal, knee) = ideal_and_knee(&study.objectives, &points, &indices).map_or((None, None), |(ideal, knee)| (Some(ideal), knee));
    let names = study.objectives.iter().map(|it| it.name(&study.model));
    let ideal: Option<Map<_, _>> = ideal.map(|ideal| names.zip(ideal.into_iter().map(number)).collect());
    (front["knee"], front["ideal"]) = (knee.map(|it| it.row).into(), ideal.into());
    let json = json!({
        "objectives": objectives_json(study, &objectives),
        "constraints": constraints_json(study, &constraints),
        "scenarios": scenario_inputs(plan, &scenarios),
        "front": front,
        "looked_at": found.looked_at,
        "draws": found.draws,
        "in_scenarios": found.scenarios,
        "seconds": found.took.as_secs_f64(),
    });
    (json, bytes)
}

/// The same of a first front, and after how long the exact one may come.
pub fn coarse(found: &LiveFront<'_>, exact: Duration) -> (Value, Vec<u8>) {
    let (mut json, bytes) = front(found);
    json["exact_after"] = number(exact.as_secs_f64());
    (json, bytes)
}

/// The inputs of some scenarios.
pub fn scenarios(plan: &Plan, numbers: &BTreeSet<u64>) -> Value {
    scenario_inputs(plan, numbers)
}

/// What a study says of itself before it is answered.
pub fn study(live: &Live, plan: &Plan, text: &str, command: &str, evaluate: &str) -> Value {
    let study = &plan.study;
    json!({
        "program": concat!("beltspace ", env!("CARGO_PKG_VERSION")),
        "kind": "live",
        "title": study.title,
        "model": model_json(study),
        "study": {
            "file": live.file(), "text": text, "hash": study.hash(), "designs": plan.designs(), "scenarios": plan.scenarios(),
            "feasible": null,
            // Where its files are told from the root on, so that it can be saved anywhere.
            "saved": with_whole_paths(text, live.folder()),
        },
        "inputs": inputs(study),
        "drawn": drawn(study),
        "command": command,
        "evaluate": evaluate,
        "notes": study.remarks(),
    })
}

/// What every design says, and the numbers of a sample of the feasible ones.
pub fn counted(plan: &Plan, counted: &LiveCounts) -> (Value, Vec<u8>) {
    let LiveCounts { feasible, sample, tally, findings } = counted;
    let study = &plan.study;
    let model = &study.model;
    let mut status: Map<_, Value> = tally.statuses(study).into_iter().map(|(reason, count)| (reason.to_owned(), count.into())).collect();
    if tally.overflow > 0 {
        status.insert(OVERFLOW.to_owned(), tally.overflow.into());
    }
    let constraints = study.constraints.iter().zip(tally.constraints.iter().zip(&tally.only)).map(|(constraint, (violated, only))| {
        json!({ "of": constraint.name(model), "bounds": constraint.in_words(), "violated": violated, "only": only })
    });
    let designs: Vec<u64> = sample.iter().map(|row| row.index).collect();
    let columns = 0..crate::certify::columns(study).len();
    let values = columns.map(|at| sample.iter().map(|row| row.columns[at].value.unwrap_or(f64::NAN)).collect()).collect();
    let sample = (!sample.is_empty()).then(|| ShownSample::new(plan, &designs, values, designs.len() as u64));
    let bytes = sample.iter().flat_map(ShownSample::bytes).flatten().collect();
    let json = json!({
        "feasible": feasible,
        "sample": sample.as_ref().map(ShownSample::describe),
        "tally": {
            "sampled": tally.sampled, "feasible": tally.feasible, "status": status, "constraints": constraints.collect::<Vec<_>>(),
        },
        "findings": findings.in_words(study),
    });
    (json, bytes)
}
