//! The designs that a page shows: the result's front table, completed with every other output of the model.

use crate::certify::{self, Column, Role, Row};
use crate::error::Result;
use crate::export::tables::LABEL;
use crate::models::Worse;
use crate::names::MOST_ON_PAGE;
use crate::parallel::with_beside;
use crate::plan::Plan;
use crate::reading::designs::{check_header, check_row, header, inputs};
use crate::reading::packed::{Packed, packed};
use crate::reading::{changed, table_reader, unreadable};
use crate::screen::Control;
use crate::study::{Axis, Constraint, Goal, OverScenarios, Quantity, Study};
use crate::table::written;
use serde_json::{Value, json};
use std::collections::{BTreeSet, HashSet};
use std::path::Path;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Most scenarios whose inputs a page lists.
const MOST_SCENARIOS: usize = 20_000;
/// Stands for a scenario where the value is absent.
const NOWHERE: u32 = u32::MAX;

/// The part of the front that is shown.
pub struct ShownFront {
    /// Their indices.
    pub designs: Vec<u64>,
    /// Position in `json["columns"]` of what each of the study's objectives and constraints is about.
    pub objectives: Vec<usize>,
    pub constraints: Vec<usize>,
    /// Every scenario that is the worst of some value, unless there are too many for the page.
    pub scenarios: BTreeSet<u64>,
    /// For the page.
    pub json: Value,
}

/// Values at their worst scenarios, design by design.
struct Shown {
    name: String,
    unit: String,
    doc: String,
    role: &'static str,
    direction: String,
    /// Which end of the scenarios it is, if it is one: a bound on the quantity is one on this value only where it has the same end.
    end: Option<Worse>,
    words: Option<Vec<String>>,
    values: Packed,
    scenarios: Option<Vec<u32>>,
}

/// Reads the front table of a result, which has `all` designs, and completes it, if that takes no longer than `patience`.
///
/// # Errors
/// As [`super::of_result`], if the table is missing or contradicts the study.
pub fn read(file: &Path, all: usize, plan: &Plan, threads: usize, patience: Duration, control: &Control) -> Result<ShownFront> {
    let study = &plan.study;
    let columns = certify::columns(study);
    let taken = all.min(MOST_ON_PAGE);
    let (rows, designs) = rows_of(file, plan, &columns, all, taken)?;
    let mut shown = vec![index_column(&designs)];
    for label in &study.labels {
        let at = shown.len();
        shown.push(label_column(&label.name, rows.iter().map(|row| &row[at])));
    }
    let first_input = shown.len();
    for (axis, column, input) in inputs(study) {
        let at = shown.len();
        shown.push(input_column(study, axis, column, input, rows.iter().map(|row| &row[at])));
    }
    let design_inputs = shown.len();
    // A quantity that is a design input has its column there.
    let mut place = Vec::new();
    let mut further = 0;
    for column in &columns {
        if let Some(own) = certify::design_input(study, column.quantity) {
            let own = own + first_input;
            place.push(own);
            if shown[own].direction.is_empty() {
                shown[own].direction = direction(study, column);
            }
            continue;
        }
        place.push(shown.len());
        let cell = design_inputs + 2 * further;
        further += 1;
        let number = |text: &str| if text.is_empty() { Some(f64::NAN) } else { text.parse().ok() };
        let values: Option<Vec<f64>> = rows.iter().map(|row| number(&row[cell])).collect();
        let scenarios: Vec<u32> = rows.iter().map(|row| row[cell + 1].parse().unwrap_or(NOWHERE)).collect();
        let values = values.ok_or_else(|| changed(file, &format!("{} has a value that is not a number", column.name)))?;
        shown.push(Shown::of(study, column, Packed::F64(values), scenarios));
    }
    let complete = complete(plan, &columns, &designs, threads, patience, control);
    if let Some((further, certified)) = &complete {
        check(file, &shown, &place, certified, columns.len())?;
        for (at, column) in further.iter().enumerate() {
            let value = |row: &Row| row.columns[columns.len() + at];
            #[allow(clippy::cast_possible_truncation, reason = "shown to six digits")]
            let values = certified.iter().map(|row| value(row).value.map_or(f32::NAN, |it| it as f32)).collect();
            let scenarios = certified.iter().map(|row| value(row).value.map_or(NOWHERE, |_| scenario_number(value(row).scenario)));
            shown.push(Shown { role: "output", ..Shown::of(study, column, Packed::F32(values), scenarios.collect()) });
        }
    }
    let scenarios = shown.iter().filter_map(|it| it.scenarios.as_ref()).flatten().filter(|&&it| it != NOWHERE);
    Ok(ShownFront {
        designs,
        objectives: objectives_at(study, &columns, &place),
        constraints: constraints_at(study, &columns, &place),
        scenarios: scenarios.map(|&it| u64::from(it)).collect::<BTreeSet<_>>().into_iter().take(MOST_SCENARIOS).collect(),
        json: json!({
            "rows": taken,
            "of": all,
            "columns": shown.iter().map(Shown::describe).collect::<Vec<_>>(),
            "packed": packed(shown.iter().flat_map(|it| std::iter::once(it.values.bytes()).chain(it.scenarios.as_deref().map(bytes_of)))),
            "complete": complete.is_some(),
        }),
    })
}

/// Where the column of each objective stands, if `place` says where those of the tables do.
fn objectives_at(study: &Study, columns: &[Column], place: &[usize]) -> Vec<usize> {
    study.objectives.iter().filter_map(|it| position(columns, it.quantity, it.over).map(|at| place[at])).collect()
}

/// The same of each constraint. If the objective has another worst scenario, the constraint has a column of its own.
fn constraints_at(study: &Study, columns: &[Column], place: &[usize]) -> Vec<usize> {
    let of_constraint = |(number, it): (usize, &Constraint)| {
        let own = columns.iter().position(|it| it.role == Role::Constraint(number));
        own.or_else(|| position(columns, it.quantity, it.over)).map(|at| place[at])
    };
    study.constraints.iter().enumerate().filter_map(of_constraint).collect()
}

fn position(columns: &[Column], quantity: Quantity, over: OverScenarios) -> Option<usize> {
    columns.iter().position(|it| it.is_of(quantity, over))
}

/// The designs of a front that was not read from a file: description and numbers, which stand one column after the other.
#[cfg(feature = "cli")]
pub fn of_rows(plan: &Plan, columns: &[Column], rows: &[Row]) -> (ShownFront, Vec<u8>) {
    let study = &plan.study;
    let designs: Vec<u64> = rows.iter().map(|row| row.index).collect();
    let mut shown = vec![index_column(&designs)];
    for (at, label) in study.labels.iter().enumerate() {
        let cells: Vec<&str> = designs.iter().map(|&design| plan.labels(design).nth(at).unwrap_or_default()).collect();
        shown.push(label_column(&label.name, cells.iter().copied()));
    }
    let first_input = shown.len();
    for (axis, column, input) in inputs(study) {
        let cells: Vec<String> = rows.iter().map(|row| written(&study.model.inputs[input], row.inputs[input])).collect();
        shown.push(input_column(study, axis, column, input, cells.iter().map(String::as_str)));
    }
    let mut place = Vec::new();
    for (at, column) in columns.iter().enumerate() {
        if let Some(own) = certify::design_input(study, column.quantity) {
            place.push(own + first_input);
            if shown[own + first_input].direction.is_empty() {
                shown[own + first_input].direction = direction(study, column);
            }
            continue;
        }
        place.push(shown.len());
        let values = rows.iter().map(|row| row.columns[at].value.unwrap_or(f64::NAN)).collect();
        let scenarios = rows.iter().map(|row| row.columns[at].value.map_or(NOWHERE, |_| scenario_number(row.columns[at].scenario)));
        shown.push(Shown::of(study, column, Packed::F64(values), scenarios.collect()));
    }
    let (objectives, constraints) = (objectives_at(study, columns, &place), constraints_at(study, columns, &place));
    let named = shown.iter().filter_map(|it| it.scenarios.as_ref()).flatten().filter(|&&it| it != NOWHERE);
    let scenarios = named.map(|&it| u64::from(it)).collect::<BTreeSet<_>>().into_iter().take(MOST_SCENARIOS).collect();
    let json = json!({
        "rows": rows.len(), "of": rows.len(), "complete": true, "columns": shown.iter().map(Shown::describe).collect::<Vec<_>>(),
    });
    let bytes = shown.iter().flat_map(|it| std::iter::once(it.values.bytes()).chain(it.scenarios.as_deref().map(bytes_of)));
    let bytes = bytes.flatten().collect();
    (ShownFront { designs, objectives, constraints, scenarios, json }, bytes)
}

fn bytes_of(numbers: &[u32]) -> Vec<u8> {
    numbers.iter().flat_map(|it| it.to_le_bytes()).collect()
}

fn scenario_number(scenario: u64) -> u32 {
    u32::try_from(scenario).unwrap_or(NOWHERE)
}

/// The rows of the front table that a page shows, as text, with their designs: `taken` of `all`, evenly spread.
fn rows_of(file: &Path, plan: &Plan, columns: &[Column], all: usize, taken: usize) -> Result<(Vec<csv::StringRecord>, Vec<u64>)> {
    let mut reader = table_reader(file)?;
    let expected = header(&plan.study, columns);
    check_header(file, reader.headers().map_err(|error| unreadable(file, error))?, &expected)?;
    let (mut rows, mut designs, mut known, mut seen) = (Vec::new(), Vec::new(), HashSet::new(), 0);
    for row in reader.into_records() {
        let row = row.map_err(|error| unreadable(file, error))?;
        if rows.len() < taken && seen as u128 == rows.len() as u128 * all as u128 / taken as u128 {
            let design = check_row(file, &row, plan, &expected)?;
            if !known.insert(design) {
                return Err(changed(file, &format!("design {design} is there twice")));
            }
            designs.push(design);
            rows.push(row);
        }
        seen += 1;
    }
    if seen == all { Ok((rows, designs)) } else { Err(changed(file, &format!("it has {seen} designs, and summary.json says {all}"))) }
}

fn index_column(designs: &[u64]) -> Shown {
    Shown {
        name: "design_index".to_owned(),
        unit: String::new(),
        doc: "Index of the design in the study.".to_owned(),
        role: "index",
        direction: String::new(),
        end: None,
        words: None,
        values: Packed::U64(designs.to_vec()),
        scenarios: None,
    }
}

/// A label, with its texts in alphabetic order.
fn label_column<'r>(name: &str, cells: impl Iterator<Item = &'r str> + Clone) -> Shown {
    let words: Vec<&str> = cells.clone().collect::<BTreeSet<_>>().into_iter().collect();
    let place = |cell: &str| words.binary_search(&cell).map_or(NOWHERE, |at| scenario_number(at as u64));
    Shown {
        name: name.to_owned(),
        unit: String::new(),
        doc: LABEL.to_owned(),
        role: "label",
        direction: String::new(),
        end: None,
        values: Packed::U32(cells.map(place).collect()),
        words: Some(words.into_iter().map(str::to_owned).collect()),
        scenarios: None,
    }
}

/// A design input; where one of its values is a word, all are taken by name.
fn input_column<'r>(study: &Study, axis: &Axis, column: usize, input: usize, cells: impl Iterator<Item = &'r str> + Clone) -> Shown {
    let table = &study.model.inputs[input];
    let numbers: Option<Vec<f64>> = cells.clone().map(|cell| cell.parse().ok()).collect();
    let (words, values) = match numbers {
        Some(numbers) => (None, Packed::F64(numbers)),
        None => {
            let mut words: Vec<String> = Vec::new();
            for level in 0..axis.count() {
                let word = written(table, axis.value(column, level));
                if !words.contains(&word) {
                    words.push(word);
                }
            }
            let place = |cell: &str| words.iter().position(|word| word == cell).map_or(NOWHERE, |at| scenario_number(at as u64));
            let places = cells.map(place).collect();
            (Some(words), Packed::U32(places))
        }
    };
    Shown {
        name: table.name.to_owned(),
        unit: table.unit.symbol.to_owned(),
        doc: table.doc.clone(),
        role: "design",
        direction: String::new(),
        end: None,
        words,
        values,
        scenarios: None,
    }
}

fn direction(study: &Study, column: &Column) -> String {
    match column.role {
        Role::Objective(objective) => if study.objectives[objective].goal == Goal::Min { "min" } else { "max" }.to_owned(),
        Role::Constraint(constraint) => study.constraints[constraint].in_words(),
        Role::Report => String::new(),
    }
}

impl Shown {
    fn of(study: &Study, column: &Column, values: Packed, scenarios: Vec<u32>) -> Self {
        Self {
            name: column.name.clone(),
            unit: column.unit(study),
            // What asks for one end says so itself.
            doc: match column.end().filter(|_| column.over.is_worst() && !column.is_end_asked(study)) {
                Some(end) => format!("{} Shown: the {} of the scenarios.", column.doc(study), end.word()),
                None => column.doc(study),
            },
            role: match column.role {
                Role::Objective(_) => "objective",
                Role::Constraint(_) => "constraint",
                Role::Report => "report",
            },
            direction: direction(study, column),
            end: column.end().filter(|_| column.over.is_worst()),
            words: None,
            values,
            scenarios: Some(scenarios),
        }
    }

    fn describe(&self) -> Value {
        json!({
            "name": self.name, "unit": self.unit, "doc": self.doc, "role": self.role, "direction": self.direction,
            "end": self.end.map(Worse::word), "type": self.values.kind(), "words": self.words, "scenario": self.scenarios.is_some(),
        })
    }
}

/// All other outputs of the designs, each at its worst scenario: their columns, and rows in which they come after `columns`. `None`
/// if that would take longer than `patience`, or was stopped.
fn complete(
    plan: &Plan,
    columns: &[Column],
    designs: &[u64],
    threads: usize,
    patience: Duration,
    control: &Control,
) -> Option<(Vec<Column>, Vec<Row>)> {
    let all = certify::all_columns(&plan.study);
    // A high estimate of the time, by the model's own figures: if it is hopeless, the work is not begun.
    #[allow(clippy::cast_precision_loss, reason = "an estimate")]
    let expected = plan.seconds_per_design() * designs.len() as f64 / threads.max(1) as f64;
    if expected > 10.0 * patience.as_secs_f64() {
        return None;
    }
    let own = Control::default();
    let (finished, waiting) = channel::<()>();
    let own = &own;
    let look = move || {
        let start = Instant::now();
        // Ends when the work is done, when `patience` is over, or when everything is to stop.
        while waiting.recv_timeout(Duration::from_millis(20)) == Err(RecvTimeoutError::Timeout) {
            if start.elapsed() > patience || control.stop.load(Ordering::Relaxed) {
                own.stop.store(true, Ordering::Relaxed);
                return;
            }
        }
    };
    let rows = with_beside(look, |is_watched| {
        // It goes when the work ends, also in a panic.
        let _finished = finished;
        // Without a thread that watches the clock it might take for ever.
        if !is_watched {
            return None;
        }
        certify::rows(plan, &all, designs, threads, own).ok()
    });
    Some((all[columns.len()..].to_vec(), rows?))
}

/// The values in the table must be those that the study gives.
fn check(file: &Path, shown: &[Shown], place: &[usize], certified: &[Row], columns: usize) -> Result<()> {
    for (at, row) in certified.iter().enumerate() {
        for (column, &place) in row.columns[..columns].iter().zip(place) {
            let Packed::F64(values) = &shown[place].values else { continue };
            let scenario = shown[place].scenarios.as_ref().map_or(NOWHERE, |it| it[at]);
            if scenario != NOWHERE && u64::from(scenario) != column.scenario {
                let (name, worst) = (&shown[place].name, column.scenario);
                return Err(changed(file, &format!("{name} of design {} has scenario {scenario}, and the study gives {worst}", row.index)));
            }
            let (value, seen) = (column.value.unwrap_or(f64::NAN), values[at]);
            if value.to_bits() != seen.to_bits() && !(value.is_nan() && seen.is_nan()) {
                let name = &shown[place].name;
                return Err(changed(file, &format!("{name} of design {} is {seen}, and the study gives {value}", row.index)));
            }
        }
    }
    Ok(())
}
