//! Joint axes: several inputs that walk through rows together, written in the study or in a CSV file.

use super::super::axis::Axis;
use super::super::check::{MOST_ROWS, MOST_VALUES};
use super::Reader;
use super::axes::{AxisClaim, AxisRole};
use super::csv_file::csv_text;
use super::table::{Entry, Lines, TomlNode, TomlTable, list, shortened};
use super::value::input_text;
use std::collections::HashMap;
use std::collections::hash_map::Entry as Row;
use toml::de::DeValue;

/// Most problems that are reported of one CSV file.
const MOST_CSV_PROBLEMS: usize = 20;

impl Reader<'_> {
    /// A joint axis.
    pub(super) fn joint(&self, role: AxisRole, entry: &Entry<'_>) -> Option<Axis> {
        let label = format!("axis \"{}\"", shortened(entry.key));
        match entry.node.value {
            DeValue::Array(_) => self.rows(role, entry.node, &label),
            DeValue::Table(_) => entry.node.table().and_then(|table| self.csv(role, &table, &label)),
            _ => {
                let found = entry.node.found();
                self.problems.add(
                    entry.node.at,
                    format!("{label}: found {found}, wanted rows such as [{{ {} }}, ...] or {{ csv = \"file.csv\" }}", self.example_row()),
                );
                None
            }
        }
    }

    /// An example of a row.
    fn example_row(&self) -> String {
        list(self.model.inputs.iter().take(2).map(|input| format!("{} = ...", input.name)))
    }

    /// Rows as listed. The first row decides which inputs there are.
    fn rows(&self, role: AxisRole, node: TomlNode<'_>, label: &str) -> Option<Axis> {
        let problems = self.problems;
        let before = problems.count();
        let mut columns: Option<Vec<usize>> = None;
        let (mut rows, mut known) = (Vec::new(), HashMap::new());
        for node in node.list()?.take_while(|_| !problems.is_full()) {
            let Some(table) = node.table() else {
                problems.add(node.at, format!("{label}: found {}, wanted a row such as {{ {} }}", node.found(), self.example_row()));
                continue;
            };
            let first = columns.is_none();
            let inputs = columns.get_or_insert_with(|| self.columns(role, &table, label));
            if inputs.is_empty() {
                continue;
            }
            let mut row = vec![f64::NAN; inputs.len()];
            for entry in table.entries.iter().take_while(|_| !problems.is_full()) {
                match (self.model.input(entry.key), inputs.iter().position(|&input| self.model.inputs[input].name == entry.key)) {
                    (Some(number), Some(column)) => row[column] = self.input_value(entry.node, number, label).unwrap_or(f64::NAN),
                    (Some(_), None) => problems.add(
                        entry.key_at,
                        format!("{label}: \"{}\" is missing in the first row; give every row the same inputs", entry.key),
                    ),
                    (None, _) if !first => problems.add(entry.key_at, format!("{label}: {}", self.no_input(entry.key))),
                    (None, _) => {}
                }
            }
            let missing: Vec<_> =
                inputs.iter().map(|&input| self.model.inputs[input].name.as_str()).filter(|name| table.get(name).is_none()).collect();
            // A wrong name is probably the missing one misspelt.
            if !missing.is_empty() && table.entries.iter().all(|entry| self.model.input(entry.key).is_some()) {
                problems.add(table.at, format!("{label}: this row lacks {}; give every row the same inputs", list(missing)));
            }
            self.mark_words(inputs, &row);
            let line = problems.line_number(table.at);
            if let Some(first) = duplicate(&mut known, &row, line) {
                problems.add(table.at, format!("{label}: this row equals that of line {first}; drop one"));
            }
            rows.push(row);
        }
        if rows.is_empty() && problems.count() == before {
            problems.add(node.at, format!("{label}: there are no rows; write rows such as [{{ {} }}]", self.example_row()));
        }
        columns.filter(|_| problems.count() == before).map(|inputs| Axis::Joint { inputs, rows })
    }

    /// The inputs that the first row names.
    fn columns(&self, role: AxisRole, table: &TomlTable<'_>, label: &str) -> Vec<usize> {
        if table.entries.is_empty() {
            self.problems.add(table.at, format!("{label}: the row names no input; write {{ {} }}", self.example_row()));
        }
        let mut inputs = Vec::new();
        for entry in table.entries.iter().take_while(|_| !self.problems.is_full()) {
            if let Some(input) = self.input(entry.key, entry.key_at, label) {
                self.claims.borrow_mut().push(AxisClaim { input, role, at: entry.key_at, single: false, word: None });
                inputs.push(input);
            }
        }
        inputs
    }

    /// Notes which inputs take a word in this row.
    fn mark_words(&self, inputs: &[usize], row: &[f64]) {
        for (&number, &value) in inputs.iter().zip(row) {
            if let Some(word) = self.model.inputs[number].word_for(value) {
                self.claims
                    .borrow_mut()
                    .iter_mut()
                    .filter(|claim| claim.input == number)
                    .for_each(|claim| claim.word = Some(word.to_owned()));
            }
        }
    }

    /// Rows from a CSV file.
    fn csv(&self, role: AxisRole, table: &TomlTable<'_>, label: &str) -> Option<Axis> {
        let problems = self.problems;
        let known = table.check_keys(problems, label, &["csv"]);
        let Some(entry) = table.get("csv") else {
            if known {
                problems.add(
                    table.at,
                    format!("{label}: no file is named; write {{ csv = \"file.csv\" }} or rows [{{ {} }}]", self.example_row()),
                );
            }
            return None;
        };
        let name = super::text(entry.node, problems, label)?;
        let at = entry.node.at;
        let text = csv_text(self.folder, &name, "study").map_err(|error| problems.add(at, format!("{label}: {error}"))).ok()?;
        let before = problems.count();
        let axis = self.csv_rows(role, at, &name, &text);
        axis.filter(|_| known && problems.count() == before)
    }

    /// The rows of a CSV text. Its first line names the inputs.
    fn csv_rows(&self, role: AxisRole, at: usize, name: &str, text: &str) -> Option<Axis> {
        let lines = Lines::new(text);
        let before = self.problems.count();
        let problem = |line: usize, field: usize, message: String| self.problems.add_in(at, name, line, field, message);
        let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).trim(csv::Trim::All).from_reader(text.as_bytes());
        let mut columns: Option<Vec<Option<usize>>> = None;
        let (mut rows, mut known) = (Vec::new(), HashMap::new());
        for record in reader.records() {
            if self.problems.is_full() || self.problems.count() - before >= MOST_CSV_PROBLEMS {
                problem(lines.count(), 1, format!("there are at least {MOST_CSV_PROBLEMS} problems; the rest is not read"));
                return None;
            }
            let record = match record {
                Ok(record) => record,
                Err(error) => {
                    problem(1, 1, format!("this is not CSV: {error}"));
                    return None;
                }
            };
            let line = record_line(&lines, text, &record);
            let Some(columns) = &columns else {
                columns = Some(self.header(role, at, &record, |field, message| problem(line, field, message)));
                continue;
            };
            if record.len() != columns.len() {
                let field = record.len().min(columns.len()) + 1;
                problem(
                    line,
                    field,
                    format!("the row has {} fields, the header has {}; give every row the same", record.len(), columns.len()),
                );
                continue;
            }
            let cell = |(field, (text, column)): (usize, (&str, &Option<usize>))| {
                let input = &self.model.inputs[(*column)?];
                let value = if text.is_empty() { Err("the field is empty; give a value".to_owned()) } else { input_text(text, input) };
                Some(value.map_err(|error| problem(line, field + 1, format!("column \"{}\": {error}", input.name))).unwrap_or(f64::NAN))
            };
            if rows.len() >= MOST_ROWS || (rows.len() + 1) * columns.len() > MOST_VALUES {
                problem(line, 1, format!("there are more rows than {} of {} values each; split the file", rows.len(), columns.len()));
                return None;
            }
            let row: Vec<f64> = record.iter().zip(columns).enumerate().filter_map(cell).collect();
            self.mark_words(&columns.iter().flatten().copied().collect::<Vec<_>>(), &row);
            if let Some(first) = duplicate(&mut known, &row, line) {
                problem(line, 1, format!("the row equals that of line {first}; drop one"));
            }
            rows.push(row);
        }
        if rows.is_empty() && self.problems.count() == before {
            let inputs = list(self.model.inputs.iter().take(2).map(|input| input.name.as_str()));
            problem(1, 1, format!("there are no rows; the first line names inputs, such as {inputs}, every other line gives their values"));
        }
        let inputs = columns?.into_iter().collect::<Option<Vec<_>>>()?;
        Some(Axis::Joint { inputs, rows })
    }

    /// The inputs that a CSV header names; `None` for a column with a problem.
    fn header(&self, role: AxisRole, at: usize, record: &csv::StringRecord, problem: impl Fn(usize, String)) -> Vec<Option<usize>> {
        let mut inputs: Vec<Option<usize>> = Vec::new();
        for (index, name) in record.iter().enumerate().take_while(|_| !self.problems.is_full()) {
            let input = self.model.input(name);
            match input {
                None if name.contains(';') || name.contains('\t') => {
                    problem(index + 1, "the columns are not separated by commas; save the file with commas".to_owned())
                }
                None if name.is_empty() => problem(index + 1, "the column has no name; name the input whose values it holds".to_owned()),
                None => problem(index + 1, self.no_input(name)),
                Some(_) if inputs.contains(&input) => problem(index + 1, format!("\"{name}\" has two columns; drop one")),
                Some(input) => self.claims.borrow_mut().push(AxisClaim { input, role, at, single: false, word: None }),
            }
            inputs.push(input);
        }
        inputs
    }
}

/// The line of an earlier row with the same values. Rows with problems, marked by NaN, equal no other row.
fn duplicate(known: &mut HashMap<Vec<u64>, usize>, row: &[f64], line: usize) -> Option<usize> {
    if row.is_empty() || row.iter().any(|value| value.is_nan()) {
        return None;
    }
    match known.entry(row.iter().map(|value| value.to_bits()).collect()) {
        Row::Occupied(first) => Some(*first.get()),
        Row::Vacant(free) => {
            free.insert(line);
            None
        }
    }
}

/// Line number of a record, which starts after blank lines that the reader has skipped.
fn record_line(lines: &Lines<'_>, text: &str, record: &csv::StringRecord) -> usize {
    let start = record.position().map_or(0, |position| usize::try_from(position.byte()).unwrap_or(0)).min(text.len());
    let blank = text.as_bytes()[start..].iter().take_while(|byte| matches!(byte, b'\r' | b'\n')).count();
    lines.index(start + blank) + 1
}
