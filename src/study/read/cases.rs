//! Joint axes: several inputs that walk through rows together, written in the study or in a CSV file such as a catalogue, with labels.

use super::super::axis::Axis;
use super::super::label::flaw_of_text;
use super::super::limits::{MOST_ROWS, MOST_VALUES};
use super::Reader;
use super::csv_file::{csv_builder, csv_text, record_line};
use super::roles::{AxisClaim, AxisRole};
use super::table::{Entry, Lines, TomlNode, TomlTable, list, shortened};
use super::value::input_text;
use super::weights::WeightColumn;
use super::{choice, text};
use crate::likeness::{closest, remedy};
use std::collections::HashMap;
use std::collections::hash_map::Entry as Row;
use toml::de::DeValue;

/// Most problems that are reported of one CSV file.
const MOST_CSV_PROBLEMS: usize = 20;

/// What a column of cases gives.
#[derive(Clone, Copy, PartialEq, Eq)]
enum CaseColumn {
    /// The input of that number.
    Input(usize),
    /// The declared label of that number.
    Label(usize),
    /// The weight of the case, and nothing else.
    Weight,
    /// Nothing that the study uses, or nothing because of a problem that is reported.
    Nothing,
}

/// Where a joint axis stands, and what a CSV file may have.
pub(super) struct CasesPlace<'c> {
    pub(super) role: AxisRole,
    /// Its position among the axes of its table.
    pub(super) number: usize,
    /// Byte in the study file.
    pub(super) at: usize,
    /// The CSV file, and whether its columns that nothing uses are left out.
    pub(super) csv: &'c str,
    pub(super) leaves_out: bool,
    /// The column of its weights, if it has some.
    pub(super) weight: Option<&'c WeightColumn<'c>>,
}

impl CasesPlace<'_> {
    /// Is it the column of the weights? It may be an input as well, if a formula reads it.
    fn is_weight(&self, name: &str) -> bool {
        self.weight.is_some_and(|weight| weight.name == name)
    }
}

/// The rows of a joint axis so far.
#[derive(Default)]
struct Cases {
    inputs: Vec<usize>,
    rows: Vec<Vec<f64>>,
    /// The texts of each label.
    labels: Vec<(usize, Vec<String>)>,
    /// Lines of the rows known so far, by their values and texts.
    known: HashMap<(Vec<u64>, Vec<String>), usize>,
}

impl Cases {
    fn new(columns: &[CaseColumn]) -> Self {
        let mut cases = Self::default();
        for column in columns {
            match *column {
                CaseColumn::Input(input) => cases.inputs.push(input),
                CaseColumn::Label(label) => cases.labels.push((label, Vec::new())),
                CaseColumn::Weight | CaseColumn::Nothing => {}
            }
        }
        cases
    }

    /// Adds a row that stands in that line. Returns the line of an earlier row that equals it, if no label tells the two apart. Rows with
    /// problems, marked by NaN, equal no other row.
    fn add(&mut self, row: Vec<f64>, texts: Vec<String>, line: usize) -> Option<usize> {
        let is_whole = !row.is_empty() && row.iter().all(|value| !value.is_nan());
        let key = is_whole.then(|| (row.iter().map(|value| value.to_bits()).collect(), texts.clone()));
        self.rows.push(row);
        self.labels.iter_mut().zip(texts).for_each(|((_, column), text)| column.push(text));
        match self.known.entry(key?) {
            Row::Occupied(first) => Some(*first.get()),
            Row::Vacant(free) => {
                free.insert(line);
                None
            }
        }
    }
}

impl Reader<'_> {
    /// A joint axis, number `number` of its table.
    pub(super) fn joint(&self, role: AxisRole, entry: &Entry<'_>, number: usize) -> Option<Axis> {
        let label = format!("axis \"{}\"", shortened(entry.key));
        let at = entry.node.at;
        self.cases(CasesPlace { role, number, at, csv: "", leaves_out: false, weight: None }, entry.node, &label)
    }

    /// The axis of these cases.
    pub(super) fn cases(&self, place: CasesPlace<'_>, node: TomlNode<'_>, label: &str) -> Option<Axis> {
        match node.value {
            DeValue::Array(_) => self.rows(&place, node, label),
            DeValue::Table(_) => node.table().and_then(|table| self.csv(place, &table, label)),
            _ => {
                let found = node.found();
                self.problems.add(
                    place.at,
                    format!("{label}: found {found}, wanted rows such as [{{ {} }}, ...] or {{ csv = \"file.csv\" }}", self.example_row()),
                );
                None
            }
        }
    }

    /// The axis of these cases, whose labels are kept.
    fn axis_of(&self, cases: Cases, place: &CasesPlace<'_>) -> Axis {
        self.keep_labels(place.number, cases.labels);
        Axis::Joint { inputs: cases.inputs, rows: cases.rows }
    }

    /// The name of a column.
    fn column_name(&self, column: CaseColumn) -> &str {
        match column {
            CaseColumn::Input(input) => &self.model.inputs[input].name,
            CaseColumn::Label(label) => &self.declared[label].name,
            CaseColumn::Weight | CaseColumn::Nothing => "",
        }
    }

    /// The column of that name; `None` if the study knows no such name.
    fn column(&self, place: &CasesPlace<'_>, name: &str) -> Option<CaseColumn> {
        let weight = || place.is_weight(name).then_some(CaseColumn::Weight);
        self.model.input(name).map(CaseColumn::Input).or_else(weight).or_else(|| self.label(name).map(CaseColumn::Label))
    }

    /// That the column of the weights may have been meant by a name.
    fn weight_meant(place: &CasesPlace<'_>, name: &str) -> Option<String> {
        let meant = place.weight.and_then(|weight| closest(name, &[weight.name]))?;
        Some(format!("there is no input \"{}\"; did you mean \"{meant}\"?", shortened(name)))
    }

    /// Takes note that a column gives values; an error if it cannot.
    fn claim_column(&self, column: CaseColumn, role: AxisRole, at: usize) -> Result<(), String> {
        match column {
            CaseColumn::Input(input) => self.claims.borrow_mut().push(AxisClaim { input, role, at, single: false, word: None }),
            CaseColumn::Label(label) if role == AxisRole::Design => return self.claim_label(label),
            CaseColumn::Label(label) => {
                let (name, role) = (shortened(&self.declared[label].name), role.name());
                return Err(format!("the label \"{name}\" cannot be in [{role}]: labels are carried along with designs; drop the column"));
            }
            CaseColumn::Weight | CaseColumn::Nothing => {}
        }
        Ok(())
    }

    /// An example of a row.
    fn example_row(&self) -> String {
        list(self.model.inputs.iter().take(2).map(|input| format!("{} = ...", input.name)))
    }

    /// Rows as listed. The first row decides which columns there are.
    fn rows(&self, place: &CasesPlace<'_>, node: TomlNode<'_>, label: &str) -> Option<Axis> {
        let problems = self.problems;
        let before = problems.count();
        let mut first: Option<(Vec<CaseColumn>, Cases)> = None;
        for node in node.list()?.take_while(|_| !problems.is_full()) {
            let Some(table) = node.table() else {
                problems.add(node.at, format!("{label}: found {}, wanted a row such as {{ {} }}", node.found(), self.example_row()));
                continue;
            };
            let is_first = first.is_none();
            let (columns, cases) = first.get_or_insert_with(|| {
                let columns = self.columns_of_row(place, &table, label);
                let cases = Cases::new(&columns);
                (columns, cases)
            });
            if cases.inputs.is_empty() {
                continue;
            }
            let mut row = vec![f64::NAN; cases.inputs.len()];
            let mut texts = vec![String::new(); cases.labels.len()];
            for entry in table.entries.iter().take_while(|_| !problems.is_full()) {
                if let Some(weight) = place.weight.filter(|weight| weight.name == entry.key)
                    && let Err(error) = weight.take_node(entry.node)
                {
                    problems.add(entry.node.at, format!("{label}: {error}"));
                }
                match self.column(place, entry.key).map(|column| (column, columns.contains(&column))) {
                    Some((CaseColumn::Weight, _)) => {}
                    Some((CaseColumn::Input(input), true)) => {
                        let place = cases.inputs.iter().position(|&it| it == input)?;
                        row[place] = self.input_value(entry.node, input, label).unwrap_or(f64::NAN);
                    }
                    Some((CaseColumn::Label(number), true)) => {
                        let place = cases.labels.iter().position(|(it, _)| *it == number)?;
                        texts[place] = self.label_text(entry.node, entry.key, label).unwrap_or_default();
                    }
                    Some(_) if is_first => {}
                    Some(_) => problems.add(
                        entry.key_at,
                        format!("{label}: \"{}\" is missing in the first row; give every row the same inputs", entry.key),
                    ),
                    None if !is_first => {
                        let why = Self::weight_meant(place, entry.key).unwrap_or_else(|| self.no_input(entry.key));
                        problems.add(entry.key_at, format!("{label}: {why}"));
                    }
                    None => {}
                }
            }
            let named = columns.iter().filter(|it| **it != CaseColumn::Weight).map(|&it| self.column_name(it));
            // A weight that formulas read is an input as well.
            let weight = place.weight.map(|weight| weight.name).filter(|name| self.model.input(name).is_none());
            let missing: Vec<_> = named.chain(weight).filter(|name| table.get(name).is_none()).collect();
            // A wrong name is probably the missing one misspelt.
            if !missing.is_empty() && table.entries.iter().all(|entry| self.column(place, entry.key).is_some()) {
                problems.add(table.at, format!("{label}: this row lacks {}; give every row the same inputs", list(missing)));
            }
            self.mark_words(&cases.inputs, &row);
            if let Some(first) = cases.add(row, texts, problems.line_number(table.at)) {
                problems.add(table.at, format!("{label}: this row equals that of line {first}; drop one"));
            }
        }
        if first.is_none() && problems.count() == before {
            problems.add(node.at, format!("{label}: there are no rows; write rows such as [{{ {} }}]", self.example_row()));
        }
        first.filter(|_| problems.count() == before).map(|(_, cases)| self.axis_of(cases, place))
    }

    /// The columns that the first row names.
    fn columns_of_row(&self, place: &CasesPlace<'_>, table: &TomlTable<'_>, label: &str) -> Vec<CaseColumn> {
        if table.entries.iter().all(|entry| self.column(place, entry.key) == Some(CaseColumn::Weight)) {
            self.problems.add(table.at, format!("{label}: the row names no input; write {{ {} }}", self.example_row()));
        }
        let mut columns = Vec::new();
        for entry in table.entries.iter().take_while(|_| !self.problems.is_full()) {
            match self.column(place, entry.key) {
                Some(column) => match self.claim_column(column, place.role, entry.key_at) {
                    Ok(()) => columns.push(column),
                    Err(error) => self.problems.add(entry.key_at, format!("{label}: {error}")),
                },
                None => {
                    let why = Self::weight_meant(place, entry.key).unwrap_or_else(|| self.no_input(entry.key));
                    self.problems.add(entry.key_at, format!("{label}: {why}"));
                    self.misnamed.set(true);
                }
            }
        }
        let has_input = columns.iter().any(|it| matches!(it, CaseColumn::Input(_)));
        if !has_input && table.entries.iter().all(|entry| self.label(entry.key).is_some()) && !columns.is_empty() {
            let message = format!("{label}: the row has labels only; name an input, such as {{ {} }}", self.example_row());
            self.problems.add(table.at, message);
        }
        columns
    }

    /// Notes which inputs take a word in this row.
    pub(super) fn mark_words(&self, inputs: &[usize], row: &[f64]) {
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
    fn csv(&self, place: CasesPlace<'_>, table: &TomlTable<'_>, label: &str) -> Option<Axis> {
        let problems = self.problems;
        let before = problems.count();
        let known = table.check_keys(problems, label, super::keys::CSV_ROWS);
        // A key that is wrong is told once, and not again by every column that it was meant for.
        let leaves_out = table.get("unused").map(|entry| choice(entry, problems, label, &[("ok", ())])).is_some() || !known;
        let Some(entry) = table.get("csv") else {
            if known {
                problems.add(
                    table.at,
                    format!("{label}: no file is named; write {{ csv = \"file.csv\" }} or rows [{{ {} }}]", self.example_row()),
                );
            }
            self.unread.set(true);
            return None;
        };
        // A file that is not read may have any label.
        let before_it = self.unread.replace(true);
        let name = text(entry.node, problems, label)?;
        let at = entry.node.at;
        let text = csv_text(self.folder, &name, "study").map_err(|error| problems.add(at, format!("{label}: {error}"))).ok()?;
        self.unread.set(before_it);
        let axis = self.csv_rows(&CasesPlace { at, csv: &name, leaves_out, ..place }, &text);
        axis.filter(|_| known && problems.count() == before)
    }

    /// The rows of a CSV text. Its first line that is no comment names the columns.
    fn csv_rows(&self, place: &CasesPlace<'_>, text: &str) -> Option<Axis> {
        let lines = Lines::new(text);
        let before = self.problems.count();
        let problem = |line: usize, field: usize, message: String| self.problems.add_in(place.at, place.csv, line, field, message);
        let mut reader = csv_builder().has_headers(false).flexible(true).from_reader(text.as_bytes());
        let mut found: Option<(Vec<CaseColumn>, Cases)> = None;
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
            let Some((columns, cases)) = &mut found else {
                let columns = self.header(place, &record, |field, message| problem(line, field, message));
                let cases = Cases::new(&columns);
                found = Some((columns, cases));
                continue;
            };
            // A line of spaces is a blank one.
            if record.len() == 1 && record[0].is_empty() && columns.len() > 1 {
                continue;
            }
            if record.len() != columns.len() {
                let field = record.len().min(columns.len()) + 1;
                problem(
                    line,
                    field,
                    format!("the row has {} fields, the header has {}; give every row the same", record.len(), columns.len()),
                );
                continue;
            }
            if cases.rows.len() >= MOST_ROWS || (cases.rows.len() + 1) * columns.len() > MOST_VALUES {
                let (rows, columns) = (cases.rows.len(), columns.len());
                problem(line, 1, format!("there are more rows than {rows} of {columns} values each; split the file"));
                return None;
            }
            let (mut row, mut texts) = (Vec::with_capacity(cases.inputs.len()), Vec::new());
            for (field, (cell, column)) in record.iter().zip(columns.iter()).enumerate() {
                let wrong = |error: String| problem(line, field + 1, format!("column \"{}\": {error}", self.column_name(*column)));
                if let Some(weight) = place.weight.filter(|it| *column == CaseColumn::Weight || it.name == self.column_name(*column))
                    && let Err(error) = weight.take_text(cell)
                {
                    problem(line, field + 1, format!("column \"{}\": {error}", weight.name));
                }
                match *column {
                    CaseColumn::Input(input) => {
                        let input = &self.model.inputs[input];
                        let empty = || Err("the field is empty; give a value".to_owned());
                        let value = if cell.is_empty() { empty() } else { input_text(cell, input) };
                        row.push(value.map_err(wrong).unwrap_or(f64::NAN));
                    }
                    CaseColumn::Label(_) => {
                        flaw_of_text(cell).map(wrong);
                        texts.push(cell.to_owned());
                    }
                    CaseColumn::Weight | CaseColumn::Nothing => {}
                }
            }
            self.mark_words(&cases.inputs, &row);
            if let Some(first) = cases.add(row, texts, line) {
                problem(line, 1, format!("the row equals that of line {first}; drop one"));
            }
        }
        let example = || list(self.model.inputs.iter().take(2).map(|input| input.name.as_str()));
        if found.as_ref().is_none_or(|(_, cases)| cases.rows.is_empty()) && self.problems.count() == before {
            let example = example();
            problem(
                1,
                1,
                format!("there are no rows; the first line names inputs, such as {example}, every other line gives their values"),
            );
        }
        let (_, cases) = found?;
        if cases.inputs.is_empty() && self.problems.count() == before {
            problem(1, 1, format!("no column is an input or a variable; name at least one, such as {}", example()));
        }
        Some(self.axis_of(cases, place))
    }

    /// What the columns of a CSV header give.
    fn header(&self, place: &CasesPlace<'_>, record: &csv::StringRecord, problem: impl Fn(usize, String)) -> Vec<CaseColumn> {
        let mut columns: Vec<CaseColumn> = Vec::new();
        let mut left_out: Vec<String> = Vec::new();
        for (index, name) in record.iter().enumerate().take_while(|_| !self.problems.is_full()) {
            let found = self.column(place, name);
            // A catalogue may serve scenarios too, which have no labels.
            let found = found.filter(|it| !(place.leaves_out && place.role != AxisRole::Design && matches!(it, CaseColumn::Label(_))));
            let column = match found {
                None if name.contains(';') || name.contains('\t') => {
                    Err("the columns are not separated by commas; save the file with commas".to_owned())
                }
                None if name.is_empty() => Err("the column has no name; name the input whose values it holds".to_owned()),
                None if place.leaves_out => {
                    left_out.push(self.left_out_as(name));
                    Ok(CaseColumn::Nothing)
                }
                None => Err(Self::weight_meant(place, name).unwrap_or_else(|| self.no_column(name, place.role))),
                Some(column) if columns.contains(&column) => Err(format!("\"{name}\" has two columns; drop one")),
                Some(column) => self.claim_column(column, place.role, place.at).map(|()| column),
            };
            columns.push(column.unwrap_or_else(|message| {
                problem(index + 1, message);
                CaseColumn::Nothing
            }));
        }
        let names = || list(record.iter().map(|name| format!("\"{}\"", shortened(name))));
        if let Some(weight) = place.weight.filter(|weight| !record.iter().any(|name| name == weight.name)) {
            problem(1, format!("there is no column \"{}\" with the weights; the columns are {}", shortened(weight.name), names()));
        } else if !columns.is_empty() && columns.iter().all(|column| *column == CaseColumn::Weight) {
            problem(1, format!("there are only weights; name an input in the first line, such as {}", self.model.inputs[0].name));
        }
        if !left_out.is_empty() {
            self.left_out.borrow_mut().push(format!("{}: nothing uses the columns {}; they are left out", place.csv, list(left_out)));
        }
        columns
    }

    /// A column that is left out, with the name that may have been meant.
    fn left_out_as(&self, name: &str) -> String {
        let meant = remedy(name, &self.names(), String::new);
        let meant = if meant.is_empty() { meant } else { format!(" ({meant})") };
        format!("\"{}\"{meant}", shortened(name))
    }

    /// Names that a column may have.
    fn names(&self) -> Vec<&str> {
        let labels = self.declared.iter().map(|it| it.name.as_str());
        self.model.inputs.iter().map(|input| input.name.as_str()).chain(labels).collect()
    }

    /// Why there is no column of that name.
    fn no_column(&self, name: &str, role: AxisRole) -> String {
        let otherwise = || {
            let label = if role == AxisRole::Design { "list it in labels to carry it along as a text; " } else { "" };
            format!("{label}its inputs are {}", list(self.model.inputs.iter().map(|input| input.name.as_str())))
        };
        let told = match self.model.output(name) {
            Some(_) => self.no_input(name),
            None => format!("{} has no input \"{}\"; {}", self.model.name, shortened(name), remedy(name, &self.names(), otherwise)),
        };
        let then = if told.ends_with('?') { "" } else { ";" };
        format!("{told}{then} unused = \"ok\" beside csv leaves the column out")
    }
}
