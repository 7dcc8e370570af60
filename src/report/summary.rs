//! Checks `summary.json` and `run.json` of a result before a page shows them: they must have the parts that this program writes.

use crate::models::Model;
use crate::plan::Plan;
use crate::study::{Constraint, Study};
use serde_json::{Map, Value};

/// Is this the summary of a result of this plan? Its numbers of designs are checked elsewhere.
///
/// # Errors
/// The part that is not as this program writes it.
pub fn check(summary: &Value, plan: &Plan) -> Result<(), String> {
    let study = &plan.study;
    let names: Vec<String> = study.objectives.iter().map(|it| it.name(&study.model)).collect();
    let design = |it: &Value| it.as_u64().is_some_and(|it| it < plan.designs());
    let by_name = |it: &Value, each: &dyn Fn(&Value) -> bool| {
        it.as_object().is_some_and(|it| it.iter().all(|(name, value)| names.contains(name) && each(value)))
    };
    let end = |it: &Value| it["value"].is_number() && design(&it["design_index"]);
    let knee = |it: &Value| design(&it["design_index"]) && it["distance"].is_number();
    let none = |it: &Value| it.is_null();
    let remarks = study.remarks();
    let notes = summary["notes"].as_array().map_or(&[][..], Vec::as_slice);
    let parts = [
        ("model", summary["model"] == study.model.name),
        ("title", summary["title"] == study.title.as_str()),
        ("scenarios", summary["scenarios"] == plan.scenarios()),
        ("notes", notes.iter().eq(remarks.iter()) && (summary["notes"].is_array() != remarks.is_empty())),
        ("ideal", none(&summary["ideal"]) || by_name(&summary["ideal"], &Value::is_number)),
        ("knee", none(&summary["knee"]) || knee(&summary["knee"])),
        ("extremes", by_name(&summary["extremes"], &|it| end(&it["least"]) && end(&it["largest"]))),
        ("tally", is_tally(&summary["tally"], &study.constraints, &study.model)),
        ("draws", are_draws(&summary["draws"], study)),
        ("findings", none(&summary["findings"]) || are_sentences(&summary["findings"]["in_words"])),
    ];
    match parts.into_iter().find(|(_, good)| !good) {
        Some((part, _)) => Err(format!("its \"{part}\" does not belong to the study")),
        None => Ok(()),
    }
}

/// Are these sentences, at least one?
fn are_sentences(sentences: &Value) -> bool {
    sentences.as_array().is_some_and(|it| !it.is_empty() && it.iter().all(Value::is_string))
}

/// Are these counts over draws, if the study has some? Results of older versions have none.
fn are_draws(draws: &Value, study: &Study) -> bool {
    let drive = study.probability.as_ref().map(|it| &it.drive);
    draws.is_null() || drive.is_some_and(|drive| draws["draws"].is_u64() && is_tally(draws, &drive.constraints, &drive.model))
}

/// Are these counts over the sample, with every constraint?
fn is_tally(tally: &Value, constraints_of_study: &[Constraint], model: &Model) -> bool {
    let Some(sampled) = tally["sampled"].as_u64() else { return false };
    let count = |it: &Value| it.as_u64().is_some_and(|it| it <= sampled);
    let Some(constraints) = tally["constraints"].as_array() else { return false };
    let of_study = |(it, constraint): (&Value, &(String, String))| {
        it["of"] == constraint.0.as_str() && it["bounds"] == constraint.1.as_str() && count(&it["violated"]) && count(&it["only"])
    };
    let expected: Vec<_> = constraints_of_study.iter().map(|it| (it.name(model), it.in_words())).collect();
    count(&tally["feasible"])
        && tally["status"].as_object().is_some_and(|it: &Map<_, _>| it.values().all(count))
        && constraints.len() == expected.len()
        && constraints.iter().zip(&expected).all(of_study)
}

/// Does this describe a run? Otherwise the page leaves it out.
pub fn is_run(run: &Value) -> bool {
    let text = ["program", "engine", "method", "origin", "platform"].iter().all(|key| run[key].is_string());
    let counts = ["threads", "designs", "scenarios", "certified_designs"].iter().all(|key| run[key].is_u64());
    let numbers = ["seconds", "designs_per_second"].iter().all(|key| run[key].is_number());
    let device = &run["device"];
    text && counts && numbers && (device.is_null() || device.is_object())
}
