//! The page of the papers computed again: figures and comparisons in place of a front.

use super::page::page;
use crate::papers::Reproduction;
use serde_json::{Value, json};

/// What the page is called.
const TITLE: &str = "Three papers on belt drives, computed again";

/// One HTML file with every figure and comparison of a reproduction.
pub fn of_papers(reproduction: &Reproduction) -> String {
    let figures = reproduction.figures.iter().map(|it| {
        json!({
            "id": it.id, "title": it.title, "caption": it.caption, "svg": it.svg, "csv": it.csv_name(), "group": it.group.name(),
        })
    });
    let comparison = reproduction.comparisons.iter().map(|it| {
        json!({
            "group": format!("{}: {}", it.group.name(), it.group.citation()), "at": it.at, "what": it.what, "unit": it.unit,
            "printed": it.printed, "computed": it.computed, "difference": it.difference, "verdict": it.verdict.word(),
            "reason": it.reason,
        })
    });
    let data = json!({
        "program": concat!("beltspace ", env!("CARGO_PKG_VERSION")),
        "kind": "papers",
        "title": TITLE,
        "notes": [reproduction.summary()],
        "model": null, "study": null, "run": null, "front": null, "scenarios": null, "tally": null, "extremes": null, "top": null,
        "inputs": [], "objectives": [], "constraints": [], "histograms": [], "maps": [], "evaluate": "",
        "figures": figures.collect::<Vec<Value>>(),
        "comparison": comparison.collect::<Vec<Value>>(),
    });
    page(TITLE, &data)
}
