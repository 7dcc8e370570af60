//! `units`, `[curves]` and `[formulas]`: what a study adds to its model, and which names are variables.
//!
//! The file of a model has the same three.

use super::csv_file::{csv_builder, csv_text, record_line};
use super::labels::DeclaredLabel;
use super::roles::PRESET;
use super::table::{Entry, Lines, Problems, TomlNode, TomlTable, list, shortened};
use super::tolerance::{ModelToleranceEntry, tolerances};
use super::value::truth;
use super::weights::weighted_cases;
use super::{choice, section, text};
use crate::formula::{Expression, meant, nominal_of};
use crate::models::{CurveSource, Extension, ExtensionProblem, FormulaSource, Model, Worse, extended};
use crate::names::column_of_tables;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

/// Where the parts of an extension stand in the file.
#[derive(Default)]
pub(super) struct ExtensionPlaces {
    units: Vec<usize>,
    /// Of each curve: where it stands, its file and the first line of each of its rows.
    curves: Vec<CurvePlace>,
    /// Of each formula, those of conditions last: where its text starts, and does a byte of it stand for one of the file?
    formulas: Vec<(usize, bool)>,
}

/// Where the points of curves come from.
#[derive(Clone, Copy)]
pub(in super::super) enum CurvePoints<'a> {
    /// From files in the folder of a study or a model.
    Folder(&'a Path, &'static str),
    /// They are known already, by the name of the curve.
    Known(&'a [CurveSource]),
}

struct CurvePlace {
    at: usize,
    file: String,
    lines: Vec<usize>,
}

/// The model with what the study adds to it; `None` if a problem was reported that leaves none.
pub(super) fn with_formulas(
    model: Arc<Model>,
    top: &TomlTable<'_>,
    labels: &[DeclaredLabel],
    problems: &Problems<'_>,
    folder: &Path,
) -> Option<Arc<Model>> {
    let before = problems.count();
    let mut places = ExtensionPlaces::default();
    let mut extension = Extension {
        units: read_units(top, problems, &mut places),
        variables: Vec::new(),
        curves: read_curves(top, problems, CurvePoints::Folder(folder, "study"), &mut places),
        formulas: read_formulas(top, problems, &mut places),
        file: None,
    };
    if problems.count() > before {
        return None;
    }
    if extension != Extension::default() {
        extension.variables = variables(&model, &extension, labels, top, folder);
    }
    let tolerances = tolerances(&model, &extension, top, problems);
    if problems.count() > before {
        return None;
    }
    if extension == Extension::default() && tolerances.is_empty() {
        return Some(model);
    }
    if are_labels_read(&extension, labels, problems) {
        return None;
    }
    refuse_twice_given(&model, &extension, &tolerances, top, problems);
    refuse_names_of_columns(&model, &extension, top, problems);
    let unread = extension.clone();
    for it in &tolerances {
        let of_formula = extension.formulas.iter().position(|formula| formula.name == it.name);
        places.formulas.push(of_formula.map_or((it.at, true), |formula| places.formulas[formula]));
        extension.add_tolerance(it.tolerance());
    }
    match extended(&model, extension) {
        Ok(model) if problems.count() == before => Some(Arc::new(model)),
        Ok(_) => None,
        // What a file that cannot be read would have given is unknown, so that formulas may be right.
        Err(_) if report_unreadable(top, problems, folder) => None,
        Err(found) => {
            report_unused(&model, &unread, labels, top, problems, folder);
            found.into_iter().for_each(|problem| tell(problem, &places, top, problems));
            None
        }
    }
}

pub(super) fn read_units(top: &TomlTable<'_>, problems: &Problems<'_>, places: &mut ExtensionPlaces) -> Vec<String> {
    let Some(entry) = top.get("units") else { return Vec::new() };
    let Some(list) = entry.node.list() else {
        let found = entry.node.found();
        problems.add(entry.node.at, format!("units: found {found}, wanted a list of texts such as [\"EUR\"]"));
        return Vec::new();
    };
    let units = list.filter_map(|node| {
        places.units.push(node.at);
        text(node, problems, "units")
    });
    units.collect()
}

pub(super) fn read_formulas(top: &TomlTable<'_>, problems: &Problems<'_>, places: &mut ExtensionPlaces) -> Vec<FormulaSource> {
    let Some(table) = section(top, "formulas", problems) else { return Vec::new() };
    let formula = |entry: &Entry<'_>| {
        let label = format!("formula \"{}\"", shortened(entry.key));
        let Some(parts) = entry.node.table() else {
            return Some(FormulaSource::plain(entry.key, formula_text(entry.node, problems, &label, places)?));
        };
        parts.check_keys(problems, &label, super::keys::FORMULA);
        let Some(is) = parts.get("is") else {
            problems.add_if_complete(parts.at, format!("{label}: \"is\" is missing; write {{ is = \"...\", doc = \"...\" }}"));
            return None;
        };
        let text = formula_text(is.node, problems, &label, places);
        let source = FormulaSource { name: entry.key.to_owned(), text: text.unwrap_or_default(), ..FormulaSource::default() };
        let [integer, hidden] = ["integer", "hidden"].map(|key| parts.get(key).and_then(|it| truth(it, problems, &label)).unwrap_or(false));
        Some(FormulaSource { integer, hidden, ..words_of(&parts, problems, &label, source) })
    };
    table.entries.iter().take_while(|_| !problems.is_full()).filter_map(formula).collect()
}

/// The text of a formula, whose place is kept.
pub(super) fn formula_text(node: TomlNode<'_>, problems: &Problems<'_>, label: &str, places: &mut ExtensionPlaces) -> Option<String> {
    let text = text(node, problems, label)?;
    // A text in quotes without escapes stands in the file as it is, one byte behind its quote.
    let plain = problems.has(node.at + 1, &text);
    places.formulas.push((if plain { node.at + 1 } else { node.at }, plain));
    Some(text)
}

/// A formula with what a table says of it for people.
pub(super) fn words_of(parts: &TomlTable<'_>, problems: &Problems<'_>, label: &str, formula: FormulaSource) -> FormulaSource {
    let ends = [("lowest", Worse::Lower), ("highest", Worse::Higher)];
    let said = |key: &str, otherwise: String| parts.get(key).and_then(|it| text(it.node, problems, label)).unwrap_or(otherwise);
    FormulaSource {
        worst: parts.get("worst").and_then(|it| choice(it, problems, label, &ends)).or(formula.worst),
        symbol: said("symbol", formula.symbol),
        doc: said("doc", formula.doc),
        source: said("source", formula.source),
        ..formula
    }
}

pub(super) fn read_curves(
    top: &TomlTable<'_>,
    problems: &Problems<'_>,
    points_from: CurvePoints<'_>,
    places: &mut ExtensionPlaces,
) -> Vec<CurveSource> {
    let Some(table) = section(top, "curves", problems) else { return Vec::new() };
    let curve = |entry: &Entry<'_>| {
        let label = format!("curve \"{}\"", shortened(entry.key));
        let Some(parts) = entry.node.table() else {
            let found = entry.node.found();
            problems.add(entry.node.at, format!("{label}: found {found}, wanted {{ csv = \"file.csv\", x = \"...\", y = \"...\" }}"));
            return None;
        };
        parts.check_keys(problems, &label, super::keys::CURVE);
        let part = |key: &str| {
            let Some(entry) = parts.get(key) else {
                problems.add(parts.at, format!("{label}: \"{key}\" is missing; write {{ csv = \"file.csv\", x = \"...\", y = \"...\" }}"));
                return None;
            };
            text(entry.node, problems, &label)
        };
        let (file, x, y) = (part("csv"), part("x"), part("y"));
        let (file, x, y) = (file?, x?, y?);
        let (folder, whose) = match points_from {
            CurvePoints::Folder(folder, whose) => (folder, whose),
            CurvePoints::Known(known) => return known.iter().find(|it| it.name == entry.key).cloned(),
        };
        let text = csv_text(folder, &file, whose).map_err(|error| problems.add(entry.node.at, format!("{label}: {error}"))).ok()?;
        let tell = |line: usize, message: String| problems.add_in(entry.node.at, &file, line, 1, format!("{label}: {message}"));
        let (points, lines) = points(&text, &x, &y).map_err(|(line, message)| tell(line, message)).ok()?;
        places.curves.push(CurvePlace { at: entry.node.at, file, lines });
        Some(CurveSource { name: entry.key.to_owned(), x, y, points })
    };
    table.entries.iter().take_while(|_| !problems.is_full()).filter_map(curve).collect()
}

/// The points of a curve, and the line of each.
type PointsWithLines = (Vec<(f64, f64)>, Vec<usize>);

/// The points of a curve, or a line and what is wrong there.
fn points(text: &str, x: &str, y: &str) -> Result<PointsWithLines, (usize, String)> {
    let mut reader = csv_builder().from_reader(text.as_bytes());
    let ends = Lines::new(text);
    let wrong = |error: csv::Error| (error.position().map_or(1, |position| position.line() as usize), format!("this is not CSV: {error}"));
    let header = reader.headers().map_err(wrong)?.clone();
    let column = |name: &str| {
        let known = || format!("its columns are {}", list(header.iter()));
        header.iter().position(|it| it == name).ok_or_else(|| (1, format!("there is no column \"{}\"; {}", shortened(name), known())))
    };
    let (x, y) = (column(x)?, column(y)?);
    let (mut points, mut lines) = (Vec::new(), Vec::new());
    for record in reader.records() {
        let record = record.map_err(wrong)?;
        let line = record_line(&ends, text, &record);
        let number = |column: usize| {
            let cell = &record[column];
            cell.parse::<f64>().map_err(|_| (line, format!("\"{}\" in column \"{}\" is no number", shortened(cell), &header[column])))
        };
        points.push((number(x)?, number(y)?));
        lines.push(line);
    }
    Ok((points, lines))
}

/// Tables of a study whose keys are inputs or variables.
pub(super) const GIVING: [&str; 4] = ["design", "operation", "uncertainty", "fixed"];

/// Every name that the study gives numbers to, with its place.
pub(super) fn given(top: &TomlTable<'_>, folder: &Path) -> Vec<(String, usize)> {
    let mut names = Vec::new();
    for table in GIVING.iter().filter_map(|name| top.get(name)).filter_map(|entry| entry.node.table()) {
        for entry in table.entries {
            let weighted = weighted_cases(&entry);
            let cases = weighted.as_ref().map_or(Some(entry.node), |table| table.get("cases").map(|entry| entry.node));
            if weighted.is_none() {
                names.push((entry.key.to_owned(), entry.key_at));
                if !entry.key.starts_with("cases") {
                    continue;
                }
            }
            if let Some(rows) = cases.and_then(TomlNode::list) {
                let first = rows.filter_map(|row| row.table()).next();
                names.extend(first.into_iter().flat_map(|row| row.entries).map(|cell| (cell.key.to_owned(), cell.key_at)));
            }
            // What cannot be read is reported when the axis is.
            if let Some(text) = cases.and_then(csv_of_cases).and_then(|(file, _)| csv_text(folder, &file, "study").ok()) {
                let header = csv_builder().from_reader(text.as_bytes()).headers().cloned().unwrap_or_default();
                names.extend(header.iter().map(|name| (name.to_owned(), entry.key_at)));
            }
        }
    }
    names
}

/// The CSV file of cases, and its place.
fn csv_of_cases(cases: TomlNode<'_>) -> Option<(String, usize)> {
    let node = cases.table()?.get("csv")?.node;
    Some((node.value.as_str()?.to_owned(), node.at))
}

/// Reports CSV files of cases that cannot be read; says whether there is one.
fn report_unreadable(top: &TomlTable<'_>, problems: &Problems<'_>, folder: &Path) -> bool {
    let before = problems.count();
    let tables = GIVING.iter().filter_map(|name| top.get(name)).filter_map(|entry| entry.node.table());
    for entry in tables.flat_map(|table| table.entries) {
        let weighted = weighted_cases(&entry).and_then(|table| table.get("cases").map(|entry| entry.node));
        let plain = entry.key.starts_with("cases").then_some(entry.node);
        let Some((file, at)) = weighted.or(plain).and_then(csv_of_cases) else { continue };
        if let Err(error) = csv_text(folder, &file, "study") {
            problems.add(at, format!("axis \"{}\": {error}", shortened(entry.key)));
        }
    }
    problems.count() > before
}

/// The names that formulas read.
fn names_read(extension: &Extension) -> BTreeSet<String> {
    let parsed = extension.formulas.iter().filter_map(|it| Expression::parse(&it.text).ok());
    parsed.flat_map(|it| it.names().into_iter().map(|(name, _)| name.to_owned()).collect::<Vec<_>>()).collect()
}

/// Reports labels that a formula reads, for texts have no value; says whether there are such.
fn are_labels_read(extension: &Extension, labels: &[DeclaredLabel], problems: &Problems<'_>) -> bool {
    let before = problems.count();
    let read = names_read(extension);
    for label in labels.iter().filter(|label| read.contains(&label.name)) {
        let message = "a formula reads it, and a label is a text that is only carried along; drop it from labels if its column has numbers";
        problems.add(label.at, format!("label \"{}\": {message}", shortened(&label.name)));
    }
    problems.count() > before
}

/// The names that formulas read and axes or fixed values give, which neither the model nor a formula has.
fn variables(model: &Model, extension: &Extension, labels: &[DeclaredLabel], top: &TomlTable<'_>, folder: &Path) -> Vec<String> {
    let read = names_read(extension);
    let is_known =
        |name: &str| model.input(name).is_some() || model.output(name).is_some() || extension.formulas.iter().any(|it| it.name == name);
    let mut variables: Vec<String> = Vec::new();
    for (name, _) in given(top, folder) {
        let is_label = labels.iter().any(|label| label.name == name);
        if read.contains(&name) && !is_known(&name) && !is_label && !variables.contains(&name) {
            variables.push(name);
        }
    }
    variables
}

/// Reports names that axes or fixed values give and nothing reads, which formulas may have meant under another name.
fn report_unused(
    model: &Model,
    extension: &Extension,
    labels: &[DeclaredLabel],
    top: &TomlTable<'_>,
    problems: &Problems<'_>,
    folder: &Path,
) {
    for (name, at) in given(top, folder) {
        let is_case = name.starts_with("cases") || name == PRESET || labels.iter().any(|label| label.name == name);
        let is_unused = model.input(&name).is_none() && !extension.variables.contains(&name) && !is_case;
        if let Some(meant) = meant(&name, extension.formulas.iter().map(|it| &*it.text)).filter(|_| is_unused) {
            problems.add(at, format!("nothing reads \"{}\"; did you mean \"{meant}\"?", shortened(&name)));
        }
    }
}

/// Reports inputs that a formula gives and an axis or a fixed value too.
fn refuse_twice_given(
    model: &Model,
    extension: &Extension,
    tolerances: &[ModelToleranceEntry],
    top: &TomlTable<'_>,
    problems: &Problems<'_>,
) {
    for table in GIVING.iter().filter_map(|name| top.get(name)).filter_map(|entry| entry.node.table()) {
        let is_given = |name: &str| extension.formulas.iter().any(|it| it.name == name);
        let is_tolerance = |at: usize| tolerances.iter().any(|it| it.at == at);
        for entry in table.entries.iter().filter(|entry| is_given(entry.key) && !is_tolerance(entry.key_at)) {
            let what = if model.input(entry.key).is_some() { "input" } else { "name" };
            problems.add(entry.key_at, format!("the {what} \"{}\" is given by a formula; drop one of the two", shortened(entry.key)));
        }
    }
}

/// Reports variables and formulas whose column in a table of the result would have the name of another one.
fn refuse_names_of_columns(model: &Model, extension: &Extension, top: &TomlTable<'_>, problems: &Problems<'_>) {
    let own: Vec<&str> = extension.variables.iter().chain(extension.formulas.iter().map(|it| &it.name)).map(String::as_str).collect();
    let is_known = |name: &str| model.input(name).is_some() || model.output(name).is_some() || own.contains(&name);
    let tables = || GIVING.iter().chain(&["formulas"]).filter_map(|name| top.get(name)?.node.table());
    for name in own.iter().filter(|name| model.input(name).is_none()) {
        let Some(column) = column_of_tables(name, is_known) else { continue };
        let at = tables().flat_map(|table| table.entries).find(|entry| entry.key == *name).map_or(0, |entry| entry.key_at);
        problems.add(at, format!("\"{}\" is the name of a column {column}; choose another name", shortened(name)));
    }
}

/// Reports a problem of an extension where it stands in the file.
pub(super) fn tell(problem: ExtensionProblem, places: &ExtensionPlaces, top: &TomlTable<'_>, problems: &Problems<'_>) {
    match problem {
        ExtensionProblem::Whole(message) => {
            problems
                .add(top.get("formulas").map_or(0, |entry| entry.key_at), format!("with these formulas the model cannot be: {message}"));
        }
        ExtensionProblem::Unit(number, message) => problems.add(places.units[number], format!("units: {message}")),
        ExtensionProblem::Variable(name, message) => {
            let tables = GIVING.iter().filter_map(|table| top.get(table)).filter_map(|entry| entry.node.table());
            let at = tables.flat_map(|table| table.entries).find(|entry| entry.key == name).map_or(0, |entry| entry.key_at);
            problems.add(at, format!("variable \"{}\": {message}", shortened(&name)));
        }
        ExtensionProblem::Curve(number, point, message) => {
            let CurvePlace { at, file, lines } = &places.curves[number];
            match point.and_then(|point| lines.get(point)) {
                Some(&line) => problems.add_in(*at, file, line, 1, message),
                None => problems.add(*at, format!("curve: {message}")),
            }
        }
        ExtensionProblem::Formula(problem) => match places.formulas.get(problem.formula) {
            Some(&(at, plain)) => {
                let place = if plain { String::new() } else { format!(" (line {}, column {} of its text)", problem.line, problem.column) };
                let at = if plain { at + problem.at } else { at };
                // What conditions call their margins is no name.
                let label = shortened(nominal_of(&problem.name).unwrap_or(&problem.name));
                let label = if label.starts_with("condition ") { label } else { format!("formula \"{label}\"") };
                problems.add(at, format!("{label}{place}: {}", problem.message));
            }
            None => problems.add(0, problem.message),
        },
    }
}
