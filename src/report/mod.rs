//! `report.html`: one page that shows a result, opens by double click, and needs no network.
//!
//! The page is assembled from the files of a result directory and from what the study says of them; what it shows of a design is
//! what `front.csv` says of it, checked against the study, and every other output at its worst scenario.

mod front;
mod maps;
mod packed;
mod page;
mod papers;

pub use page::GENERATOR;
pub use papers::of_papers;

use crate::checkpoint::Checkpoint;
use crate::error::{Error, Result};
use crate::export::{CHECKPOINT, MARK, pulley, table_names, written};
use crate::plan::Plan;
use crate::screen::Control;
use crate::study::{Axis, Study, number, value_of};
use serde_json::{Map, Value, json};
use std::fs;
use std::path::Path;
use std::time::Duration;

/// What a page is made from, and how.
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
    /// How long the outputs that the result's tables do not have may take; after it the page does without them.
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
            () if !folder.is_dir() => "is no directory; name the one that `beltspace sweep` wrote".to_owned(),
            () if Checkpoint::exists(&folder.join(CHECKPOINT)) || Checkpoint::exists(folder) => {
                "holds an unfinished sweep or a shard; go on with `beltspace sweep --resume`, or put the shards together with \
                 `beltspace merge`"
                    .to_owned()
            }
            () => format!("is no finished result: it has no {MARK}; name the directory that `beltspace sweep` wrote"),
        };
        return Err(Error::Request(format!("{} {hint}", folder.display())));
    }
    let (described, summary) = (json_of(folder, "study.json")?, json_of(folder, MARK)?);
    let study = Study::from_description(&described)
        .map_err(|problem| changed(&folder.join("study.json"), &format!("not a study that this version describes: {problem}")))?;
    if summary["study_hash"] != study.hash().as_str() {
        return Err(changed(&folder.join(MARK), "it is the summary of another study than study.json"));
    }
    // The text may name tables that are elsewhere; then it cannot be read from here.
    let (file, text) = (folder.join("study.toml"), text_of(folder, "study.toml")?);
    match Study::parse(&text, "study.toml", folder) {
        Ok(written) if written.hash() == study.hash() => {}
        Err(_) if text.contains("csv") => {}
        _ => return Err(changed(&file, "it is not the study that study.json describes")),
    }
    Ok(study)
}

/// The page of a result.
///
/// # Errors
/// [`Error::Request`] where a file is missing or says other than the study; [`Error::Io`] where one cannot be read.
pub fn of_result(request: &Request<'_>, control: &Control) -> Result<Page> {
    let Request { folder, plan, evaluate, threads, patience } = *request;
    let study = &plan.study;
    let model = study.model;
    let summary = json_of(folder, MARK)?;
    let feasible = summary["feasible"].as_u64().filter(|&it| it <= plan.designs() && summary["designs"] == plan.designs());
    let feasible = feasible.ok_or_else(|| changed(&folder.join(MARK), "its numbers of designs are not those of the study"))?;
    let front = if study.objectives.is_empty() {
        None
    } else {
        let all = summary["front"].as_u64().and_then(|it| usize::try_from(it).ok());
        let all = all.ok_or_else(|| changed(&folder.join(MARK), "it does not say how many designs the front has"))?;
        Some(front::read(&folder.join("front.csv"), all, plan, threads, patience, control)?)
    };
    let (objectives, constraints, scenarios) =
        front.as_ref().map_or((&[][..], &[][..], None), |it| (&it.objectives[..], &it.constraints[..], Some(&it.scenarios)));
    let objectives = study
        .objectives
        .iter()
        .zip(objectives)
        .map(|(it, column)| json!({ "of": it.quantity.name(model), "column": column, "goal": it.goal, "resolution": it.resolution }));
    let constraints = study.constraints.iter().enumerate().map(|(at, it)| {
        let mut constraint = json!({ "of": it.quantity.name(model), "column": constraints.get(at), "bounds": it.in_words() });
        for (bound, inclusive, exclusive) in [(it.low, "min", "above"), (it.high, "max", "below")] {
            if let Some((bound, excluded)) = bound {
                constraint[if excluded { exclusive } else { inclusive }] = number(bound);
            }
        }
        constraint
    });
    let (histograms, maps) = table_names(study);
    let histograms =
        study.report.histograms.iter().zip(histograms).map(|(spec, name)| maps::histogram(folder, study, spec, &name, feasible));
    let maps = study.report.maps.iter().zip(maps).map(|(spec, name)| maps::map(folder, study, spec, &name));
    let data = json!({
        "program": concat!("beltspace ", env!("CARGO_PKG_VERSION")),
        "kind": "result",
        "title": study.title,
        "model": { "name": model.name, "summary": model.summary, "source": model.source, "limits": model.limits },
        "study": {
            "file": "study.toml", "text": text_of(folder, "study.toml")?, "hash": summary["study_hash"],
            "designs": plan.designs(), "scenarios": plan.scenarios(), "feasible": feasible,
        },
        "run": json_of(folder, "run.json").ok(),
        "inputs": inputs(study),
        "objectives": objectives.collect::<Vec<_>>(),
        "constraints": constraints.collect::<Vec<_>>(),
        "front": front.as_ref().map(|it| with_knee(it, &summary)),
        "scenarios": scenarios.map(|numbers| scenario_inputs(plan, numbers)),
        "evaluate": evaluate,
        "tally": summary["tally"],
        "extremes": summary["extremes"],
        "notes": summary["notes"],
        "histograms": histograms.collect::<Result<Vec<_>>>()?,
        "maps": maps.collect::<Result<Vec<_>>>()?,
        "figures": figures(folder),
        "top": top(folder, study)?,
        "variants": variants(folder, study)?,
    });
    let rows = |key: &str| data["front"][key].as_u64().map_or(0, |it| usize::try_from(it).unwrap_or(usize::MAX));
    Ok(Page { html: page::page(&study.title, &data), designs: rows("rows"), of: rows("of"), complete: data["front"]["complete"] != false })
}

/// The row of the knee is known by its design.
fn with_knee(front: &front::Front, summary: &Value) -> Value {
    let knee = summary["knee"]["design_index"].as_u64();
    let mut json = front.json.clone();
    json["knee"] = knee.and_then(|knee| front.designs.iter().position(|&it| it == knee)).into();
    json["ideal"] = summary["ideal"].clone();
    json
}

/// Every input with its part in the study; the value of those that no axis sets.
fn inputs(study: &Study) -> Vec<Value> {
    let model = study.model;
    let sets = |axes: &[Axis], input: usize| axes.iter().any(|axis| axis.inputs().contains(&input));
    let role = |input| match () {
        () if sets(&study.design, input) => "design",
        () if sets(&study.operation, input) => "operation",
        () if sets(&study.uncertainty, input) => "uncertainty",
        () => "fixed",
    };
    let described = |(number, input): (usize, &crate::models::Input)| {
        let mut described = json!({
            "name": input.name, "unit": input.unit.symbol, "symbol": input.symbol, "doc": input.doc, "role": role(number),
            "only_for": input.only_for,
        });
        match role(number) {
            "fixed" => described["value"] = value_of(model, number, study.fixed[number]),
            _ => described["over"] = over(study, number).into(),
        }
        described
    };
    model.inputs.iter().enumerate().map(described).collect()
}

/// What an axis gives an input, in words: its ends, or the words.
fn over(study: &Study, input: usize) -> String {
    let axes = study.design.iter().chain(&study.operation).chain(&study.uncertainty);
    let found = axes.filter_map(|axis| Some((axis, axis.inputs().iter().position(|&it| it == input)?))).next();
    let Some((axis, column)) = found else { return String::new() };
    let table = &study.model.inputs[input];
    let (least, largest) = axis.ends(column);
    if table.is_enumeration() {
        let mut words: Vec<_> = (0..axis.count()).map(|level| written(table, axis.value(column, level))).collect();
        words.dedup();
        return words.join(", ");
    }
    if least == largest { written(table, least) } else { format!("{} to {}", written(table, least), written(table, largest)) }
}

/// What the inputs are in some scenarios.
fn scenario_inputs<'s>(plan: &Plan, numbers: impl IntoIterator<Item = &'s u64>) -> Value {
    let study = &plan.study;
    let inputs: Vec<usize> = study.operation.iter().chain(&study.uncertainty).flat_map(Axis::inputs).copied().collect();
    let columns = inputs.iter().map(|&input| {
        let input = &study.model.inputs[input];
        json!({ "name": input.name, "unit": input.unit.symbol, "doc": input.doc })
    });
    let mut values = study.fixed.clone();
    let rows = numbers.into_iter().map(|&number| {
        plan.space.scenarios.set(number, &mut values);
        (number.to_string(), inputs.iter().map(|&input| value_of(study.model, input, values[input])).collect::<Value>())
    });
    let rows: Map<_, _> = rows.collect();
    json!({ "columns": columns.collect::<Vec<_>>(), "rows": rows })
}

/// The pictures of the knee, for models that have such.
fn figures(folder: &Path) -> Vec<Value> {
    let picture = |name: &&str| {
        let svg = fs::read_to_string(folder.join(format!("knee-{name}.svg"))).ok()?;
        Some(
            json!({ "id": format!("knee-{name}"), "title": pulley::caption(name), "caption": "", "svg": svg, "csv": null, "group": "The knee" }),
        )
    };
    pulley::PICTURES.iter().filter_map(picture).collect()
}

/// The list of the best designs, as it was written.
fn top(folder: &Path, study: &Study) -> Result<Option<Value>> {
    let Some(top) = study.report.top else { return Ok(None) };
    let mut table = table(&folder.join("top.csv"), study)?;
    (table["by"], table["goal"]) = (top.by.name(study.model).into(), json!(top.goal));
    Ok(Some(table))
}

/// Every design, feasible or not, if the study lists them.
fn variants(folder: &Path, study: &Study) -> Result<Option<Value>> {
    study.report.variants.then(|| table(&folder.join("variants.csv"), study)).transpose()
}

/// A table of designs as text, with the units of its columns.
fn table(file: &Path, study: &Study) -> Result<Value> {
    let mut reader = csv::Reader::from_path(file).map_err(|error| unreadable(file, error))?;
    let columns: Vec<String> = reader.headers().map_err(|error| unreadable(file, error))?.iter().map(str::to_owned).collect();
    let model = study.model;
    let unit = |name: &String| {
        let name = name.strip_suffix("_constrained").unwrap_or(name);
        let input = model.input(name).map(|it| model.inputs[it].unit.symbol);
        input.or_else(|| model.output(name).map(|it| model.outputs[it].unit.symbol)).unwrap_or_default()
    };
    if columns.first().is_none_or(|it| it != "design_index") {
        return Err(changed(file, "it is no table of designs"));
    }
    let units: Vec<_> = columns.iter().map(unit).collect();
    let rows: std::result::Result<Vec<Vec<String>>, _> =
        reader.records().map(|row| row.map(|row| row.iter().map(str::to_owned).collect())).collect();
    let rows = rows.map_err(|error| unreadable(file, error))?;
    Ok(json!({ "columns": columns, "units": units, "rows": rows }))
}

fn unreadable(file: &Path, error: csv::Error) -> Error {
    match error.into_kind() {
        csv::ErrorKind::Io(source) => unreadable_file(file, source),
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
            let line = pos.map_or(String::new(), |pos| format!("line {}: ", pos.line()));
            changed(file, &format!("{line}{len} cells where there should be {expected_len}"))
        }
        csv::ErrorKind::Utf8 { .. } => changed(file, "it is no text"),
        _ => changed(file, "it cannot be read as a table"),
    }
}

fn text_of(folder: &Path, name: &str) -> Result<String> {
    let path = folder.join(name);
    fs::read_to_string(&path).map_err(|source| unreadable_file(&path, source))
}

/// A file that is not there is as good as one that was changed.
fn unreadable_file(file: &Path, source: std::io::Error) -> Error {
    if source.kind() == std::io::ErrorKind::NotFound {
        return Error::Request(format!("{} is missing from the result: sweep the study again", file.display()));
    }
    Error::io(file)(source)
}

fn json_of(folder: &Path, name: &str) -> Result<Value> {
    serde_json::from_str(&text_of(folder, name)?).map_err(|error| changed(&folder.join(name), &format!("it is no JSON: {error}")))
}

/// A file of a result that this version would not have written.
fn changed(file: &Path, problem: &str) -> Error {
    Error::Request(format!(
        "{}: {problem}; the file was changed or comes from another version of the program: sweep the study again",
        file.display()
    ))
}
