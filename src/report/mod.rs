//! `report.html`: one page that shows a result, opens by double click, and needs no network.
//!
//! The page is assembled from the files of a result directory and the study. Of each design it shows the values in `front.csv`, checked
//! against the study, and every other output at its worst scenario.

mod front;
pub(crate) mod givens;
mod influence;
pub(crate) mod inputs;
#[cfg(feature = "cli")]
pub mod live;
mod page;
mod papers;
pub(crate) mod sections;
pub mod slices;
mod summary;

pub use papers::of_papers;

use crate::checkpoint::{Found, found};
use crate::error::{Error, Result};
use crate::export::pulley;
use crate::models::Model;
use crate::names::{CHECKPOINT, MARK, RUN};
use crate::plan::Plan;
use crate::reading::{Folder, STUDY, changed, json_of, picture_of, text_of};
use crate::reduce::Reported;
use crate::screen::Control;
use crate::study::{Axis, Study, number, value_of};
use inputs::{axes, drawn, inputs};
use rustc_hash::FxHashSet;
use serde_json::{Map, Value, json};
use std::path::Path;
use std::time::Duration;

/// From what a page is made, and how.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// The result directory.
    pub folder: &'a Path,
    /// The study that it is of.
    pub plan: &'a Plan,
    /// The command that evaluates one design again; `{design}` stands for its index.
    pub evaluate: &'a str,
    /// Worker threads.
    pub threads: usize,
    /// Time limit for computing the outputs that the result's tables lack; beyond it the page does without them.
    pub patience: Duration,
}

/// A page.
#[derive(Debug)]
pub struct Page {
    /// The file.
    pub html: String,
    /// Designs of the front on it.
    pub designs: usize,
    /// Designs of the front.
    pub of: usize,
    /// Does it have every output of its designs?
    pub complete: bool,
}

/// The study that a result directory is of, as its `study.json` describes it.
///
/// # Errors
/// [`Error::Request`] if this is no result, or one that this version of the program does not understand.
pub fn study_of(folder: &Path) -> Result<Study> {
    if !folder.join(MARK).exists() {
        let hint = match () {
            () if !folder.is_dir() => "is not a directory; name the one that `beltspace sweep` wrote".to_owned(),
            () if [folder.join(CHECKPOINT).as_path(), folder].iter().any(|it| matches!(found(it), Found::Checkpoint)) => {
                "holds an unfinished sweep or a shard; go on with `beltspace sweep --resume`, or put the shards together with \
                 `beltspace merge`"
                    .to_owned()
            }
            () => format!("is not a finished result: it has no {MARK}; name the directory that `beltspace sweep` wrote"),
        };
        return Err(Error::Request(format!("{} {hint}", folder.display())));
    }
    let (described, summary) = (json_of(folder, STUDY)?, json_of(folder, MARK)?);
    let study = Study::from_description(&described)
        .map_err(|problem| changed(&folder.join(STUDY), &format!("this version does not understand its study: {problem}")))?;
    if summary["study_hash"] != study.hash().as_str() {
        return Err(changed(&folder.join(MARK), "it belongs to another study than study.json"));
    }
    // The text may name tables or a model that are elsewhere; then it cannot be read here.
    let (file, text) = (folder.join("study.toml"), text_of(folder, "study.toml")?);
    match Study::parse_in(&text, "study.toml", folder) {
        Ok(written) if written.hash() == study.hash() => {}
        Err(_) if text.contains("csv") || described["model_file"].is_object() => {}
        _ => return Err(changed(&file, "it is not the study that study.json describes")),
    }
    Ok(study)
}

/// The page of a result.
///
/// # Errors
/// [`Error::Request`] if a file is missing or contradicts the study; [`Error::Io`] if one cannot be read.
pub fn of_result(request: &Request<'_>, control: &Control) -> Result<Page> {
    let Request { folder, plan, evaluate, threads, patience } = *request;
    let study = &plan.study;
    let summary = json_of(folder, MARK)?;
    let feasible = summary["feasible"].as_u64().filter(|&it| it <= plan.designs() && summary["designs"] == plan.designs());
    let feasible = feasible.ok_or_else(|| changed(&folder.join(MARK), "its numbers of designs are not those of the study"))?;
    summary::check(&summary, plan).map_err(|problem| changed(&folder.join(MARK), &problem))?;
    let front = if study.objectives.is_empty() {
        None
    } else {
        let all = summary["front"].as_u64().and_then(|it| usize::try_from(it).ok());
        let all = all.ok_or_else(|| changed(&folder.join(MARK), "it does not say how many designs the front has"))?;
        Some(front::read(&folder.join("front.csv"), all, plan, threads, patience, control)?)
    };
    let (objectives, constraints, scenarios) =
        front.as_ref().map_or((&[][..], &[][..], None), |it| (&it.objectives[..], &it.constraints[..], Some(&it.scenarios)));
    let objectives = objectives_json(study, objectives);
    let constraints = constraints_json(study, constraints);
    let influence = influence::read(folder, plan, &summary)?;
    let knee = summary["knee"]["design_index"].as_u64().filter(|&it| it < plan.designs());
    let text = text_of(folder, "study.toml")?;
    let around = knee.map(|knee| slices::of_knee(plan, &text, knee, threads, control)).transpose()?;
    let figures = [figures(folder)?, influence.figures].concat();
    let mut data = json!({
        "program": concat!("beltspace ", env!("CARGO_PKG_VERSION")),
        "kind": "result",
        "title": study.title,
        "model": model_json(study),
        "study": {
            "file": "study.toml", "text": text, "hash": summary["study_hash"],
            "designs": plan.designs(), "scenarios": plan.scenarios(), "feasible": feasible,
        },
        "run": json_of(folder, RUN).ok().filter(summary::is_run),
        "inputs": inputs(study),
        "axes": axes(study),
        "drawn": drawn(study),
        "objectives": objectives,
        "constraints": constraints,
        "front": front.as_ref().map(|it| with_knee(it, &summary)),
        "around": around,
        "scenarios": scenarios.map(|numbers| scenario_inputs(plan, numbers)),
        "evaluate": evaluate,
        "tally": summary["tally"],
        "draws": summary["draws"],
        "extremes": summary["extremes"],
        "findings": summary["findings"]["in_words"],
        "notes": summary["notes"],
        "figures": figures,
        "tables": influence.tables,
        "sensitivity": influence.none,
        "sensitivity_over": influence.over,
        "variants": variants(folder, plan)?,
    });
    Reported::page(&Folder { path: folder, plan, feasible }, data.as_object_mut().expect("it is one"))?;
    let pictured = pictured_designs(front.as_ref(), &[&data["top"], &data["variants"]]);
    (data["givens"], data["sections"]) = (givens::of_designs(plan, &pictured), sections::of_designs(plan, &pictured));
    let rows = |key: &str| data["front"][key].as_u64().map_or(0, |it| usize::try_from(it).unwrap_or(usize::MAX));
    Ok(Page { html: page::page(&study.title, &data), designs: rows("rows"), of: rows("of"), complete: data["front"]["complete"] != false })
}

/// The designs whose cards have drawings: those of the front, and behind them those of the lists, each once.
fn pictured_designs(front: Option<&front::ShownFront>, lists: &[&Value]) -> Vec<u64> {
    let of_list = |list: &&Value| -> Vec<u64> {
        let place = list["columns"].as_array().and_then(|it| it.iter().position(|name| name == "design_index"));
        let rows = list["rows"].as_array().into_iter().flatten();
        place.map_or_else(Vec::new, |place| rows.filter_map(|row| row[place].as_str()?.parse().ok()).collect())
    };
    let mut known = FxHashSet::default();
    let all = front.into_iter().flat_map(|it| it.designs.iter().copied()).chain(lists.iter().flat_map(of_list));
    all.filter(|&design| known.insert(design)).collect()
}

fn model_json(study: &Study) -> Value {
    let model = &study.model;
    json!({ "name": model.name, "summary": model.summary, "source": model.source, "limits": model.limits, "drive": drive(model) })
}

/// The model of the program that this one is, or that its formulas stand around: the page knows what its drive looks like.
fn drive(model: &Model) -> Option<&str> {
    let innermost = model.base().unwrap_or(model);
    crate::models::all().iter().find(|it| std::ptr::eq(&***it, innermost)).map(|it| it.name.as_str())
}

/// The objectives with the positions of their columns.
fn objectives_json(study: &Study, columns: &[usize]) -> Value {
    let each = study.objectives.iter().zip(columns);
    each.map(|(it, column)| json!({ "of": it.name(&study.model), "column": column, "goal": it.goal, "resolution": it.resolution }))
        .collect()
}

/// The constraints with the positions of their columns, if they have some, and their bounds.
fn constraints_json(study: &Study, columns: &[usize]) -> Value {
    let each = study.constraints.iter().enumerate().map(|(at, it)| {
        let unit = study.unit_over(it.quantity, it.over);
        let mut constraint = json!({ "of": it.name(&study.model), "column": columns.get(at), "bounds": it.in_words(), "unit": unit });
        for (bound, inclusive, exclusive) in [(it.low, "min", "above"), (it.high, "max", "below")] {
            if let Some((bound, excluded)) = bound {
                constraint[if excluded { exclusive } else { inclusive }] = number(bound);
            }
        }
        constraint
    });
    each.collect()
}

/// The row of the knee, found by its design.
fn with_knee(front: &front::ShownFront, summary: &Value) -> Value {
    let knee = summary["knee"]["design_index"].as_u64();
    let mut json = front.json.clone();
    json["knee"] = knee.and_then(|knee| front.designs.iter().position(|&it| it == knee)).into();
    json["ideal"] = summary["ideal"].clone();
    json
}

/// The inputs of some scenarios.
fn scenario_inputs<'s>(plan: &Plan, numbers: impl IntoIterator<Item = &'s u64>) -> Value {
    let study = &plan.study;
    let inputs: Vec<usize> = study.operation.iter().chain(&study.uncertainty).flat_map(Axis::inputs).copied().collect();
    let columns = inputs.iter().map(|&input| {
        let input = &study.model.inputs[input];
        json!({ "name": input.name, "unit": input.unit.symbol, "doc": input.doc })
    });
    let weights = plan.listed_weights();
    let of_weights =
        weights.map(|(it, _)| json!({ "name": it.weight, "unit": it.unit, "doc": format!("Weight of the case of {}.", it.name) }));
    let columns = columns.chain(of_weights);
    let mut values = study.fixed.clone();
    let rows = numbers.into_iter().map(|&scenario| {
        plan.space.scenarios.set(scenario, &mut values);
        (
            scenario.to_string(),
            inputs
                .iter()
                .map(|&input| value_of(&study.model, input, values[input]))
                .chain(weights.map(|(_, it)| number(it.weight_of(scenario))))
                .collect::<Value>(),
        )
    });
    let rows: Map<_, _> = rows.collect();
    json!({ "columns": columns.collect::<Vec<_>>(), "rows": rows })
}

/// The pictures of the knee, for models that have such.
fn figures(folder: &Path) -> Result<Vec<Value>> {
    let mut figures = Vec::new();
    for name in pulley::PICTURES {
        let file = folder.join(format!("knee-{name}.svg"));
        if !file.exists() {
            continue;
        }
        let svg = picture_of(&file)?;
        figures.push(
            json!({ "id": format!("knee-{name}"), "title": pulley::caption(name), "caption": "", "svg": svg, "csv": null, "group": "The knee" }),
        );
    }
    Ok(figures)
}

/// Every design, feasible or not, if the study lists them.
fn variants(folder: &Path, plan: &Plan) -> Result<Option<Value>> {
    plan.study.report.variants.then(|| crate::reading::designs::list(&folder.join("variants.csv"), plan, plan.designs(), true)).transpose()
}
