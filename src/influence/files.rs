//! The files of an analysis: tables with the columns of SALib, JSON, pictures.

use super::results::{Estimate, InfluenceMethod, InfluenceReport, InputReport, QuantityReport, QuantityVerdict};
use super::subject::InfluenceSubject;
use crate::error::{Error, Result};
use crate::files::{Claim, MOVE, refuse_foreign, remove_if_there, replace, was_to_become};
use crate::study::{InfluenceOver, number};
use crate::table::{Data, Table, TableColumn, csv_text};
use serde_json::{Map, Value, json};
use std::path::Path;

const TABLE: &str = "sensitivity.csv";
const TORNADO: &str = "tornado.csv";
const JSON: &str = "sensitivity.json";
/// How the JSON file begins, so that it is recognised as written by this program.
const JSON_BEGINS: &str = "{\n  \"beltspace_sensitivity\":";

/// One row for each quantity and factor, with the columns of SALib.
pub fn table(report: &InfluenceReport) -> Table {
    let rows = || report.quantities.iter().flat_map(|quantity| quantity.inputs.iter().map(move |input| (quantity, input)));
    let text = |name: &str, doc: &str, of: &dyn Fn(&QuantityReport, &InputReport) -> String| {
        TableColumn::new(name, "index", doc, Data::Text(rows().map(|(quantity, input)| of(quantity, input)).collect()))
    };
    let value = |name: &str, doc: &str, of: &dyn Fn(&InputReport) -> Option<f64>| {
        TableColumn::new(name, "report", doc, Data::Number(rows().map(|(_, input)| of(input)).collect()))
    };
    let share = |name: &str, doc: &str, of: &dyn Fn(&InputReport) -> Option<Estimate>| {
        let confidence = format!("Half the width of the interval of 95 % confidence of {name}; empty where it is counted.");
        [value(name, doc, &|it| Some(of(it)?.value)), value(&format!("{name}_conf"), &confidence, &|it| of(it)?.confidence)]
    };
    let mut columns = vec![
        text("quantity", "What is asked about.", &|quantity, _| quantity.asked.name.clone()),
        text("names", "The input that varies.", &|_, input| input.name.clone()),
    ];
    columns
        .extend(share("S1", "First-order Sobol index: the share of the variance that goes if this input alone is known.", &|it| it.first));
    columns.extend(share("ST", "Total Sobol index: the share of the variance that stays if all others are known.", &|it| it.total));
    columns.extend(share("shapley", "Shapley effect, as a share of the variance: they add up to 1.", &|it| it.shapley));
    let within = "The same over the designs that hold.";
    columns.extend(share("shapley_holds", within, &|it| it.within));
    let screening =
        |name: &str, doc: &str, of: &dyn Fn(&crate::sensitivity::Effects) -> f64| value(name, doc, &|it| it.screening.as_ref().map(of));
    columns.push(screening("mu", "Mean effect of a step, per range of the input (Morris).", &|it| it.mean));
    columns.push(screening("mu_star", "Mean of the absolute effects.", &|it| it.mean_absolute));
    columns.push(screening("sigma", "Standard deviation of the effects.", &|it| it.sd));
    Table { columns }
}

/// One row for each quantity and factor: the quantity at both ends of the factor; `None` if no single design was looked at.
pub fn tornado_table(report: &InfluenceReport) -> Option<Table> {
    let rows = || report.quantities.iter().filter_map(|it| Some((it, it.tornado.as_ref()?)));
    rows().next()?;
    let bars = || rows().flat_map(|(quantity, tornado)| tornado.bars.iter().map(move |bar| (quantity, tornado, bar)));
    let text = |name: &str, doc: &str, values: Vec<String>| TableColumn::new(name, "index", doc, Data::Text(values));
    let value = |name: &str, doc: &str, values: Vec<Option<f64>>| TableColumn::new(name, "report", doc, Data::Number(values));
    let columns = vec![
        text("quantity", "What is asked about.", bars().map(|it| it.0.asked.name.clone()).collect()),
        text("names", "The input that varies.", bars().map(|it| it.2.name.clone()).collect()),
        text("low", "Its low end: the lowest level, or the 5 % quantile.", bars().map(|it| it.2.low.clone()).collect()),
        text("high", "Its high end: the highest level, or the 95 % quantile.", bars().map(|it| it.2.high.clone()).collect()),
        value("at_low", "The quantity at the low end, the other inputs in the middle.", bars().map(|it| it.2.at_low).collect()),
        value("at_middle", "The quantity with all inputs in the middle.", bars().map(|it| it.1.middle).collect()),
        value("at_high", "The quantity at the high end, the other inputs in the middle.", bars().map(|it| it.2.at_high).collect()),
    ];
    Some(Table { columns })
}

/// Everything that was found.
pub fn json(report: &InfluenceReport) -> Value {
    let method = match report.method {
        InfluenceMethod::Grid { combinations } => json!({ "kind": "grid", "combinations": combinations }),
        InfluenceMethod::Draws { draws, sets, seed, correlated } => {
            json!({ "kind": "draws", "draws": draws, "sets": sets, "seed": seed, "correlated": correlated })
        }
        InfluenceMethod::Screening => json!({ "kind": "screening" }),
    };
    let mut all = Map::new();
    all.insert("beltspace_sensitivity".to_owned(), json!(env!("CARGO_PKG_VERSION")));
    all.insert("title".to_owned(), json!(report.title));
    all.insert("over".to_owned(), json!(report.over.word()));
    all.insert("design".to_owned(), json!(report.design));
    all.insert("scenarios".to_owned(), json!(report.scenarios));
    all.insert("method".to_owned(), method);
    all.insert("orders".to_owned(), json!(report.orders));
    if let Some((combinations, hold)) = report.held_grid {
        all.insert("designs_that_hold".to_owned(), json!({ "looked_at": combinations, "hold": hold }));
    }
    all.insert("walks".to_owned(), json!(report.walks));
    all.insert("quantities".to_owned(), report.quantities.iter().map(|it| of_quantity(it, report.over)).collect());
    Value::Object(all)
}

/// A share with its interval; nothing where there is none.
pub(super) fn share(it: Option<Estimate>) -> Value {
    it.map_or(Value::Null, |it| json!({ "value": number(it.value), "confidence": it.confidence.map(number) }))
}

/// What is said of a quantity, in words.
pub(super) fn verdict(it: &QuantityReport, over: InfluenceOver) -> String {
    match it.verdict {
        QuantityVerdict::Shares => "varies".to_owned(),
        QuantityVerdict::Constant { .. } => "does not vary".to_owned(),
        QuantityVerdict::Absent { .. } => it.refusal(over),
        QuantityVerdict::None => "only screened".to_owned(),
    }
}

fn of_quantity(it: &QuantityReport, over: InfluenceOver) -> Value {
    let input = |input: &InputReport| {
        let screening = input.screening.as_ref();
        let screening = screening.map(|it| json!({ "mu": number(it.mean), "mu_star": number(it.mean_absolute), "sigma": number(it.sd) }));
        json!({
            "name": input.name, "first": share(input.first), "total": share(input.total), "shapley": share(input.shapley),
            "shapley_holds": share(input.within), "screening": screening,
        })
    };
    let tornado = it.tornado.as_ref().map(|tornado| {
        let bars = tornado.bars.iter().map(|bar| {
            json!({ "name": bar.name, "low": bar.low, "high": bar.high, "at_low": bar.at_low.map(number), "at_high": bar.at_high.map(number) })
        });
        json!({ "middle": tornado.middle.map(number), "bars": bars.collect::<Vec<_>>() })
    });
    json!({
        "name": it.asked.name, "unit": it.asked.unit, "description": it.asked.doc, "verdict": verdict(it, over),
        "mean": it.mean.map(number), "standard_deviation": it.sd.map(number),
        "over_designs_that_hold": it.within.map(|it| json!({ "mean": number(it.mean), "standard_deviation": number(it.sd) })),
        "inputs": it.inputs.iter().map(input).collect::<Vec<_>>(), "tornado": tornado,
    })
}

/// May an analysis have written a file of this name?
pub fn is_influence_file(name: &str) -> bool {
    let is_picture = |start: &str| name.strip_prefix(start).is_some_and(|it| it.ends_with(".svg") && it.len() > ".svg".len());
    [TABLE, TORNADO, JSON].contains(&name) || is_picture("sensitivity-") || is_picture("tornado-")
}

/// Is this the beginning of a file of an analysis of this name?
fn is_own(name: &str, head: &str) -> bool {
    match name {
        TABLE => head.starts_with("quantity,names,S1,"),
        TORNADO => head.starts_with("quantity,names,low,high,"),
        JSON => head.starts_with(JSON_BEGINS),
        _ => crate::names::is_picture(head),
    }
}

/// The files, with their names.
pub fn files(report: &InfluenceReport) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<(String, Vec<u8>)> = vec![(TABLE.to_owned(), csv_text(&table(report)))];
    files.push((JSON.to_owned(), format!("{:#}\n", json(report)).into_bytes()));
    if let Some(tornado) = tornado_table(report) {
        files.push((TORNADO.to_owned(), csv_text(&tornado)));
    }
    #[cfg(feature = "pictures")]
    files.extend(super::drawings::pictures(report).into_iter().map(|(name, text)| (name, text.into_bytes())));
    files
}

/// The names that the files of this subject may have, those of pictures last: of each quantity that of its shares, then its tornado.
pub fn files_of(subject: &InfluenceSubject) -> Vec<String> {
    let of_one_design = subject.over == InfluenceOver::Uncertainty;
    let mut names = vec![TABLE.to_owned(), JSON.to_owned()];
    if of_one_design {
        names.push(TORNADO.to_owned());
    }
    for quantity in &subject.quantities {
        names.push(quantity.shares_file());
        if of_one_design {
            names.push(quantity.tornado_file());
        }
    }
    names
}

/// Writes the files into a directory, which is made if it is not there, and removes those of an earlier analysis that this one does not have.
/// Other files are left alone. Gives the names of the files.
///
/// # Errors
/// [`Error::Request`] if a file is in the way that this program did not write; then nothing is written.
pub fn write(report: &InfluenceReport, folder: &Path, task: &str) -> Result<Vec<String>> {
    let _claim = Claim::new(folder, task)?;
    let files = files(report);
    let mut older = Vec::new();
    for entry in folder.read_dir().map_err(Error::io(folder))? {
        let name = entry.map_err(Error::io(folder))?.file_name().to_string_lossy().into_owned();
        let remains = was_to_become(&name).is_some_and(is_influence_file);
        if remains || (is_influence_file(&name) && !files.iter().any(|it| it.0 == name)) {
            older.push(name);
        }
    }
    for (name, _) in &files {
        refuse_foreign(&folder.join(name), MOVE, |head| is_own(name, head))?;
    }
    for (name, bytes) in &files {
        replace(&folder.join(name), bytes)?;
    }
    for name in older {
        let path = folder.join(&name);
        if was_to_become(&name).is_some() || refuse_foreign(&path, MOVE, |head| is_own(&name, head)).is_ok() {
            remove_if_there(&path)?;
        }
    }
    Ok(files.into_iter().map(|it| it.0).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_own_files_are_recognised() {
        for own in ["sensitivity.csv", "tornado.csv", "sensitivity.json", "sensitivity-axial_force_N.svg", "tornado-holds.svg"] {
            assert!(is_influence_file(own), "{own}");
        }
        for other in ["front.csv", "sensitivity.txt", "sensitivity-.svg", "tornado.svg", "my-tornado-holds.svg", "sensitivity-notes.md"] {
            assert!(!is_influence_file(other), "{other}");
        }
        assert!(is_own(TABLE, "quantity,names,S1,S1_conf,ST\n") && !is_own(TABLE, "names,S1\n"));
        assert!(
            is_own(JSON, "{\n  \"beltspace_sensitivity\": \"0.1.0\",\n")
                && !is_own(JSON, "{\"a\": 1}")
                && !is_own("tornado-a.svg", "<svg>")
        );
    }
}
