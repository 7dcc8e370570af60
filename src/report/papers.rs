//! The page of the papers computed again: figures and comparisons instead of a front.

use super::page::page;
use crate::papers::{Paper, PaperTable, Reproduction, Verdict};
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
            "reason": it.explanation(),
        })
    });
    let legend = Verdict::ALL.into_iter().map(|verdict| format!("{}: {}", verdict.word(), verdict.meaning()));
    let notes = std::iter::once(reproduction.summary()).chain(legend);
    let item = |group: Paper, at: &str, text: &str| json!({ "group": group.name(), "at": at, "text": text });
    let data = json!({
        "program": concat!("beltspace ", env!("CARGO_PKG_VERSION")),
        "kind": "papers",
        "title": TITLE,
        "notes": notes.collect::<Vec<String>>(),
        "model": null, "study": null, "run": null, "front": null, "scenarios": null, "tally": null, "extremes": null, "top": null,
        "inputs": [], "objectives": [], "constraints": [], "histograms": [], "maps": [], "evaluate": "",
        "figures": figures.collect::<Vec<Value>>(),
        "comparison": comparison.collect::<Vec<Value>>(),
        "tables": reproduction.tables.iter().map(table).collect::<Vec<_>>(),
        "lists": [
            {
                "title": "Read differently than printed",
                "items": reproduction.repairs.iter().map(|it| item(it.group, it.at, it.words)).collect::<Vec<_>>(),
            },
            {
                "title": "What cannot be computed again",
                "items": reproduction.lost.iter().map(|it| item(it.group, it.what, it.why)).collect::<Vec<_>>(),
            },
        ],
    });
    page(TITLE, &data)
}

/// A table as text, with the units of its columns.
fn table(table: &PaperTable) -> Value {
    let columns = &table.table.columns;
    let rows = (0..table.table.rows()).map(|row| columns.iter().map(|column| column.data.text(row)).collect::<Vec<_>>());
    json!({
        "id": table.id, "title": table.title, "caption": table.caption, "group": table.group.name(), "csv": table.csv_name(),
        "columns": columns.iter().map(|column| &column.name).collect::<Vec<_>>(),
        "units": columns.iter().map(|column| &column.unit).collect::<Vec<_>>(),
        "rows": rows.collect::<Vec<_>>(),
    })
}
