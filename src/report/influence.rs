//! Which input matters: the pictures of a result, and a short table of the inputs that matter most.

use crate::error::Result;
use crate::influence::{InfluenceSubject, QuantityAsked};
use crate::names::MARK;
use crate::plan::Plan;
use crate::reading::{changed, picture_of};
use crate::study::{InfluenceOver, number};
use serde_json::{Value, json};
use std::path::Path;

/// What a page shows of it.
#[derive(Default)]
pub struct ShownInfluence {
    /// Pictures with their captions.
    pub figures: Vec<Value>,
    /// The table, if there is one.
    pub tables: Vec<Value>,
    /// Why there is none although the study asks for it.
    pub none: Value,
    /// Over what it was looked at, if it was.
    pub over: Value,
}

/// Reads what the summary and the pictures of a result say.
///
/// # Errors
/// [`Error::Request`](crate::error::Error::Request) if they cannot be of this study.
pub fn read(folder: &Path, plan: &Plan, summary: &Value) -> Result<ShownInfluence> {
    let told = &summary["sensitivity"];
    let wrong = |problem: &str| changed(&folder.join(MARK), &format!("its \"sensitivity\" {problem}"));
    let Some(spec) = &plan.study.report.sensitivity else {
        return if told.is_null() { Ok(ShownInfluence::default()) } else { Err(wrong("is not asked for by the study")) };
    };
    if told["over"] != spec.over.word() {
        return Err(wrong("does not belong to the study"));
    }
    if told["none"].is_string() {
        return Ok(ShownInfluence { none: told["none"].clone(), ..ShownInfluence::default() });
    }
    let design = match spec.over {
        InfluenceOver::Design => 0,
        InfluenceOver::Uncertainty => {
            told["design"].as_u64().filter(|&it| it < plan.designs()).ok_or_else(|| wrong("names no design of the study"))?
        }
    };
    let subject = InfluenceSubject::of_report(&plan.study, design)?.ok_or_else(|| wrong("is not asked for by the study"))?;
    let group = match spec.over {
        InfluenceOver::Design => "Which choice matters over the design".to_owned(),
        InfluenceOver::Uncertainty => format!("Which input matters for design {design}"),
    };
    let rows = rows(told, &subject).ok_or_else(|| wrong("does not belong to the study"))?;
    let mut figures = Vec::new();
    for quantity in &subject.quantities {
        for (name, title, caption, csv) in pictures(quantity, spec.over) {
            let file = folder.join(&name);
            if file.exists() {
                let id = name.trim_end_matches(".svg");
                let svg = picture_of(&file)?;
                figures.push(json!({ "id": id, "title": title, "caption": caption, "svg": svg, "csv": csv, "group": group }));
            }
        }
    }
    let (columns, rows) = without_empty(&rows);
    let mut caption =
        "Shares of the variance of each quantity: of an input alone (first order), with all that it does together with others \
                       (total), and shared out fairly (Shapley). With ± they are estimated, at a confidence of 95 %."
            .to_owned();
    if columns.contains(&"mu*") {
        caption.push_str(" mu* is the mean absolute effect of an input over its range.");
    }
    let table = json!({
        "id": "sensitivity", "title": "the largest indices", "group": group, "csv": "sensitivity.csv",
        "caption": caption, "columns": columns, "units": null, "rows": rows,
    });
    Ok(ShownInfluence {
        figures,
        tables: if rows.is_empty() { Vec::new() } else { vec![table] },
        none: Value::Null,
        over: spec.over.word().into(),
    })
}

/// The names of a quantity's pictures, each with its title, its caption and the file of its numbers.
fn pictures(quantity: &QuantityAsked, over: InfluenceOver) -> Vec<(String, String, String, &'static str)> {
    let name = &quantity.name;
    let shares = "How much of its variance comes from each input. First order: from this input alone; total: with all that it does together \
                  with others; Shapley effects add up to 1.";
    let of_holding = if over == InfluenceOver::Design { " The last are over the designs that hold." } else { "" };
    let mut pictures =
        vec![(quantity.shares_file(), format!("{name}: what its scatter comes from"), format!("{shares}{of_holding}"), "sensitivity.csv")];
    if over == InfluenceOver::Uncertainty {
        let ends = "Each input alone from its low to its high end, the others in the middle: from the lowest to the highest level, or from \
                    the 5 % to the 95 % quantile.";
        pictures.push((quantity.tornado_file(), format!("{name}: one input at a time"), ends.to_owned(), "tornado.csv"));
    }
    pictures
}

/// The columns that have something to say, by name, and the rows with these only.
fn without_empty(rows: &[Vec<String>]) -> (Vec<&'static str>, Vec<Vec<&str>>) {
    let names = ["quantity", "input", "first order", "total", "Shapley", "mu*"];
    let kept: Vec<usize> = (0..names.len()).filter(|&column| rows.iter().any(|row| !row[column].is_empty())).collect();
    let shown = rows.iter().map(|row| kept.iter().map(|&column| row[column].as_str()).collect()).collect();
    (kept.iter().map(|&column| names[column]).collect(), shown)
}

/// The rows of the table; `None` if they are not about quantities and inputs of the subject.
fn rows(told: &Value, subject: &InfluenceSubject) -> Option<Vec<Vec<String>>> {
    let quantities = told["quantities"].as_array()?;
    if !quantities.iter().map(|it| it["name"].as_str()).eq(subject.quantities.iter().map(|it| Some(it.name.as_str()))) {
        return None;
    }
    let mut rows = Vec::new();
    for quantity in quantities {
        for input in quantity["largest"].as_array()? {
            if !subject.factors.iter().any(|it| input["name"] == it.name.as_str()) {
                return None;
            }
            let name = |it: &Value| it["name"].as_str().unwrap_or_default().to_owned();
            let mut cells = vec![name(quantity), name(input)];
            cells.extend(["first", "total", "shapley"].map(|key| share(&input[key])));
            cells.push(input["mu_star"].as_f64().map_or(String::new(), |it| number(it).to_string()));
            rows.push(cells);
        }
    }
    Some(rows)
}

/// A share in three digits behind the point, with its interval.
fn share(told: &Value) -> String {
    // No minus in front of what is 0 in these digits.
    let digits = |value: f64| format!("{:.3}", (value * 1e3).round() / 1e3 + 0.0);
    let confidence = told["confidence"].as_f64().map_or(String::new(), |it| format!(" ± {}", digits(it)));
    told["value"].as_f64().map_or(String::new(), |it| format!("{}{confidence}", digits(it)))
}
