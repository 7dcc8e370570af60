//! The page that a reproduction is read from.

use super::comparison::digits;
use super::{Comparison, Lost, Paper, Repair, Reproduction, Verdict};
use crate::table::{Data, Table};

const INTRODUCTION: &str = "\
Written by `beltspace reproduce`; a test writes it again and compares every byte. All numbers come from the models and their equations,
evaluated with the papers' data. Where a model has no answer because the printed numbers lie beyond what it allows, or looks at more than
the paper does, the printed equation itself is evaluated. Nothing is adjusted to agree without being named. All numbers in full are in
[comparison.csv](comparison.csv). Every verdict follows from the two numbers and from what the computed one rests on:
";

/// The page as Markdown.
pub(super) fn page(all: &Reproduction) -> String {
    let mut text = format!("# The papers, computed again\n\n{INTRODUCTION}\n");
    for verdict in Verdict::ALL {
        text += &format!("- *{}*: {}\n", verdict.word(), verdict.meaning());
    }
    text += &format!("\n{}.\n", all.summary());
    for paper in Paper::ALL {
        text += &format!("\n## {}\n\n{}.\n", paper.name(), paper.citation());
        text += "\n| where | what | printed | computed | difference | verdict | reason |\n|---|---|---|---|---|---|---|\n";
        for row in all.comparisons.iter().filter(|row| row.group == paper) {
            text += &line(row);
        }
        for table in all.tables.iter().filter(|table| table.group == paper) {
            text += &format!("\n### {}\n\n{} Values in full: [{2}]({2}).\n", table.title, table.caption, table.csv_name());
            text += &cells(&table.table);
        }
        for figure in all.figures.iter().filter(|figure| figure.group == paper) {
            let (svg, csv) = (figure.svg_name(), figure.csv_name());
            text += &format!("\n### {0}\n\n![{0}]({svg})\n\n{1} Values: [{csv}]({csv}).\n", figure.title, figure.caption);
        }
        text += "\n### What is read otherwise than printed\n\n";
        for Repair { at, words, .. } in all.repairs.iter().filter(|repair| repair.group == paper) {
            text += &format!("- {}: {words}\n", capitalised(at));
        }
        let lost: Vec<&Lost> = all.lost.iter().filter(|lost| lost.group == paper).collect();
        if !lost.is_empty() {
            text += "\n### What cannot be computed again\n\n";
            for Lost { what, why, .. } in lost {
                text += &format!("- {}: {why}\n", capitalised(what));
            }
        }
    }
    text
}

fn line(row: &Comparison) -> String {
    let with_unit = |number: &str| {
        let bare = row.unit.is_empty() || number == "-";
        cell(&if bare { number.to_owned() } else { format!("{number} {}", row.unit) })
    };
    let cells = [cell(row.at), cell(&row.what), with_unit(&row.printed), with_unit(&row.computed), cell(&row.difference)];
    format!("| {} | {} | {} |\n", cells.join(" | "), row.verdict.word(), cell(&row.explanation()))
}

/// A table with numbers for people.
fn cells(table: &Table) -> String {
    let header: Vec<_> = table.columns.iter().map(|column| cell(&column.name.replace('_', " "))).collect();
    let mut text = format!("\n| {} |\n|{}\n", header.join(" | "), "---|".repeat(header.len()));
    for row in 0..table.rows() {
        let shown = table.columns.iter().map(|column| match &column.data {
            Data::Whole(values) => values[row].map_or(String::new(), |value| value.to_string()),
            Data::Number(values) => values[row].map_or(String::new(), digits),
            Data::Text(values) => cell(&values[row]),
        });
        text += &format!("| {} |\n", shown.collect::<Vec<_>>().join(" | "));
    }
    text
}

/// Text that cannot end its cell.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

fn capitalised(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or_else(String::new, |first| first.to_uppercase().collect::<String>() + characters.as_str())
}
