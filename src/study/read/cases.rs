//! Joint axes: several inputs that walk through rows together, written in the study or in a CSV file.

use super::super::axis::Axis;
use super::super::check::{MOST_ROWS, MOST_VALUES};
use super::Reader;
use super::axes::{AxisClaim, AxisRole};
use super::csv_file::csv_text;
use super::spectrum::WeightColumn;
use super::table::{Entry, Lines, TomlNode, TomlTable, list, shortened};
use super::value::input_text;
use crate::likeness::closest;
use std::collections::HashMap;
use std::collections::hash_map::Entry as Row;
use toml::de::DeValue;

/// Most problems that are reported of one CSV file.
const MOST_CSV_PROBLEMS: usize = 20;

/// Reads the cases of one joint axis.
pub(super) struct CaseReader<'r, 'a> {
    /// What is known of the study.
    pub(super) reader: &'r Reader<'a>,
    /// The table that the axis stands in.
    pub(super) role: AxisRole,
    /// The column of its weights, if it has some.
    pub(super) weight: Option<&'r WeightColumn<'r>>,
}

/// A column of a CSV file; one with a problem is neither.
#[derive(Clone, Copy)]
struct CaseColumn {
    /// The input whose values it holds.
    input: Option<usize>,
    /// Does it hold the weights?
    is_weight: bool,
}

impl<'a> std::ops::Deref for CaseReader<'_, 'a> {
    type Target = Reader<'a>;

    fn deref(&self) -> &Reader<'a> {
        self.reader
    }
}

impl Reader<'_> {
    /// A joint axis.
    pub(super) fn joint(&self, role: AxisRole, entry: &Entry<'_>) -> Option<Axis> {
        CaseReader { reader: self, role, weight: None }.cases(entry.node, &format!("axis \"{}\"", shortened(entry.key)))
    }
}

impl CaseReader<'_, '_> {
    /// The axis of these cases.
    pub(super) fn cases(&self, node: TomlNode<'_>, label: &str) -> Option<Axis> {
        match node.value {
            DeValue::Array(_) => self.rows(node, label),
            DeValue::Table(_) => node.table().and_then(|table| self.csv(&table, label)),
            _ => {
                let found = node.found();
                self.problems.add(
                    node.at,
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
    fn rows(&self, node: TomlNode<'_>, label: &str) -> Option<Axis> {
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
            let inputs = columns.get_or_insert_with(|| self.columns(&table, label));
            if inputs.is_empty() {
                continue;
            }
            let mut row = vec![f64::NAN; inputs.len()];
            let known_name = |name: &str| self.model.input(name).is_some() || self.is_weight(name);
            for entry in table.entries.iter().take_while(|_| !problems.is_full()) {
                if let Some(weight) = self.weight.filter(|weight| weight.name == entry.key)
                    && let Err(error) = weight.take_node(entry.node)
                {
                    problems.add(entry.node.at, format!("{label}: {error}"));
                }
                match (self.model.input(entry.key), inputs.iter().position(|&input| self.model.inputs[input].name == entry.key)) {
                    (Some(number), Some(column)) => row[column] = self.input_value(entry.node, number, label).unwrap_or(f64::NAN),
                    (Some(_), None) => problems.add(
                        entry.key_at,
                        format!("{label}: \"{}\" is missing in the first row; give every row the same inputs", entry.key),
                    ),
                    (None, _) if !first && !self.is_weight(entry.key) => {
                        problems.add(entry.key_at, format!("{label}: {}", self.no_input(entry.key)))
                    }
                    (None, _) => {}
                }
            }
            let names = inputs.iter().map(|&input| self.model.inputs[input].name.as_str());
            // A weight that formulas read is an input as well.
            let weight = self.weight.map(|weight| weight.name).filter(|name| self.model.input(name).is_none());
            let missing: Vec<_> = names.chain(weight).filter(|name| table.get(name).is_none()).collect();
            // A wrong name is probably the missing one misspelt.
            if !missing.is_empty() && table.entries.iter().all(|entry| known_name(entry.key)) {
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

    /// Why there is no input of that name; it may be the column of the weights misspelt.
    fn no_input(&self, name: &str) -> String {
        let meant = self.weight.and_then(|weight| closest(name, &[weight.name]));
        let of_weight = meant.map(|weight| format!("there is no input \"{}\"; did you mean \"{weight}\"?", shortened(name)));
        of_weight.unwrap_or_else(|| self.reader.no_input(name))
    }

    /// Is it the column of the weights?
    fn is_weight(&self, name: &str) -> bool {
        self.weight.is_some_and(|weight| weight.name == name)
    }

    /// The inputs that the first row names.
    fn columns(&self, table: &TomlTable<'_>, label: &str) -> Vec<usize> {
        if table.entries.iter().all(|entry| self.is_weight(entry.key) && self.model.input(entry.key).is_none()) {
            self.problems.add(table.at, format!("{label}: the row names no input; write {{ {} }}", self.example_row()));
        }
        let mut inputs = Vec::new();
        let named = table.entries.iter().filter(|entry| !self.is_weight(entry.key) || self.model.input(entry.key).is_some());
        for entry in named.take_while(|_| !self.problems.is_full()) {
            let Some(input) = self.model.input(entry.key) else {
                self.problems.add(entry.key_at, format!("{label}: {}", self.no_input(entry.key)));
                self.misnamed.set(true);
                continue;
            };
            self.claims.borrow_mut().push(AxisClaim { input, role: self.role, at: entry.key_at, single: false, word: None });
            inputs.push(input);
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
    fn csv(&self, table: &TomlTable<'_>, label: &str) -> Option<Axis> {
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
        let text = csv_text(self.folder, &name).map_err(|error| problems.add(at, format!("{label}: {error}"))).ok()?;
        let before = problems.count();
        let axis = self.csv_rows(at, &name, &text);
        axis.filter(|_| known && problems.count() == before)
    }

    /// The rows of a CSV text. Its first line names the inputs.
    fn csv_rows(&self, at: usize, name: &str, text: &str) -> Option<Axis> {
        let lines = Lines::new(text);
        let before = self.problems.count();
        let problem = |line: usize, field: usize, message: String| self.problems.add_in(at, name, line, field, message);
        let mut builder = csv::ReaderBuilder::new();
        let mut reader = builder.has_headers(false).flexible(true).trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
        let mut columns: Option<Vec<CaseColumn>> = None;
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
                columns = Some(self.header(at, &record, |field, message| problem(line, field, message)));
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
            let cell = |(field, (text, column)): (usize, (&str, &CaseColumn))| {
                if let Some(weight) = self.weight.filter(|_| column.is_weight)
                    && let Err(error) = weight.take_text(text)
                {
                    problem(line, field + 1, format!("column \"{}\": {error}", weight.name));
                }
                let input = &self.model.inputs[column.input?];
                let value = if text.is_empty() { Err("the field is empty; give a value".to_owned()) } else { input_text(text, input) };
                Some(value.map_err(|error| problem(line, field + 1, format!("column \"{}\": {error}", input.name))).unwrap_or(f64::NAN))
            };
            if rows.len() >= MOST_ROWS || (rows.len() + 1) * columns.len() > MOST_VALUES {
                problem(line, 1, format!("there are more rows than {} of {} values each; split the file", rows.len(), columns.len()));
                return None;
            }
            let row: Vec<f64> = record.iter().zip(columns).enumerate().filter_map(cell).collect();
            self.mark_words(&columns.iter().filter_map(|column| column.input).collect::<Vec<_>>(), &row);
            if let Some(first) = duplicate(&mut known, &row, line) {
                problem(line, 1, format!("the row equals that of line {first}; drop one"));
            }
            rows.push(row);
        }
        if rows.is_empty() && self.problems.count() == before {
            let inputs = list(self.model.inputs.iter().take(2).map(|input| input.name.as_str()));
            problem(1, 1, format!("there are no rows; the first line names inputs, such as {inputs}, every other line gives their values"));
        }
        let columns = columns?;
        let is_good = columns.iter().all(|column| column.is_weight || column.input.is_some());
        is_good.then(|| Axis::Joint { inputs: columns.iter().filter_map(|column| column.input).collect(), rows })
    }

    /// What the columns of a CSV header hold.
    fn header(&self, at: usize, record: &csv::StringRecord, problem: impl Fn(usize, String)) -> Vec<CaseColumn> {
        let mut columns: Vec<CaseColumn> = Vec::new();
        for (index, name) in record.iter().enumerate().take_while(|_| !self.problems.is_full()) {
            let input = self.model.input(name);
            let is_weight = self.is_weight(name);
            match input {
                _ if record.iter().take(index).any(|before| before == name) && (is_weight || input.is_some()) => {
                    problem(index + 1, format!("\"{name}\" has two columns; drop one"))
                }
                None if is_weight => {}
                None if name.contains(';') || name.contains('\t') => {
                    problem(index + 1, "the columns are not separated by commas; save the file with commas".to_owned())
                }
                None if name.is_empty() => problem(index + 1, "the column has no name; name the input whose values it holds".to_owned()),
                None => problem(index + 1, self.no_input(name)),
                Some(input) => self.claims.borrow_mut().push(AxisClaim { input, role: self.role, at, single: false, word: None }),
            }
            columns.push(CaseColumn { input, is_weight });
        }
        let names = || list(record.iter().map(|name| format!("\"{}\"", shortened(name))));
        if let Some(weight) = self.weight.filter(|weight| !record.iter().any(|name| name == weight.name)) {
            problem(1, format!("there is no column \"{}\" with the weights; the columns are {}", shortened(weight.name), names()));
        } else if !columns.is_empty() && columns.iter().all(|column| column.is_weight && column.input.is_none()) {
            problem(1, format!("there are only weights; name an input in the first line, such as {}", self.model.inputs[0].name));
        }
        columns
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

/// Line number of a record, which starts after blank lines and comments that the reader has skipped.
fn record_line(lines: &Lines<'_>, text: &str, record: &csv::StringRecord) -> usize {
    let start = record.position().map_or(0, |position| usize::try_from(position.byte()).unwrap_or(0)).min(text.len());
    let mut rest = &text.as_bytes()[start..];
    // Comments are skipped as well.
    while let [first @ (b'\r' | b'\n' | b'#'), ..] = rest {
        let length = if *first == b'#' { rest.iter().take_while(|&&byte| byte != b'\n').count() } else { 1 };
        rest = &rest[length..];
    }
    lines.index(text.len() - rest.len()) + 1
}
