//! One value in place of whatever a study gives an input, `--set NAME=VALUE`, or of a part of it, `--set TABLE.NAME.KEY=VALUE`.
//!
//! The text of the study is edited, and then read like any other: an axis or a formula of that name becomes a comment, the value goes into
//! `[fixed]`. So the study is the same as one that was written so by hand, and the text that a result keeps says what was judged. Lines
//! keep their order; where a line is put in, problems in the lines after it are told at their place in the user's file.

use super::csv_file::csv_text;
use super::formulas::{GIVING, given};
use super::law::tolerance;
use super::part::{OFF, OFF_TAKES_OUT, StudyPart, written};
use super::place::{Edit, left_out, place_in, span};
use super::table::{Entry, Lines, TomlNode, TomlTable, shortened};
use super::weights::weighted_cases;
use super::{Problem, StudyErrors};
use crate::error::{Error, Result};
use crate::models::{Model, Models, is_name};
use crate::study::Study;
use serde_json::{Map, Value};
use std::ops::Range;
use std::path::Path;
use toml::de::{DeTable, DeValue};

/// A value that replaces what the study says.
struct StudySetting {
    table: &'static str,
    name: String,
    value: String,
    /// Where the value goes, if that is said.
    part: Option<StudyPart>,
}

/// What is asked of a study besides what its file says.
#[derive(Clone, Copy, Debug, Default)]
pub struct StudyEdits<'a> {
    /// Values in place of what it gives some inputs, each as `NAME=VALUE`, or of parts of it, as `TABLE.NAME.KEY=VALUE`.
    pub set: &'a [String],
    /// `feasible = true` in its `[report]`.
    pub feasible: bool,
}

impl StudySetting {
    /// Takes `NAME=VALUE` apart.
    fn new(assignment: &str) -> std::result::Result<Self, String> {
        let parts = assignment.split_once('=').map(|(name, value)| (name.trim(), value.trim()));
        let Some((name, value)) = parts.filter(|(name, value)| !name.is_empty() && !value.is_empty()) else {
            return Err(format!("--set \"{}\": write NAME=VALUE", shortened(assignment)));
        };
        let mut setting = Self { table: "fixed", name: name.to_owned(), value: value.to_owned(), part: None };
        if let Some(part) = StudyPart::read(name) {
            let told = |why| format!("{}: {why}", setting.told());
            let part = part.map_err(told)?;
            written(value).map_err(told)?;
            setting.table = part.table;
            setting.part = Some(part);
        }
        Ok(setting)
    }

    /// `feasible = true` in `[report]`.
    fn feasible() -> Self {
        Self { table: "report", name: "feasible".to_owned(), value: "true".to_owned(), part: None }
    }

    fn is_of_report(&self) -> bool {
        self.table == "report"
    }

    /// The value as a study file has it: a number, else a text.
    fn in_toml(&self) -> String {
        if self.is_of_report() {
            return self.value.clone();
        }
        // A list has been looked at when the setting was read; anything else has a form.
        let plain = || Value::from(self.value.as_str()).to_string();
        if self.part.is_none() && self.value.starts_with('[') { plain() } else { written(&self.value).unwrap_or_else(|_| plain()) }
    }

    /// The same as [`unplaced`] gives it.
    fn in_json(&self) -> Value {
        let text = self.in_toml();
        if self.is_of_report() {
            return Value::from(true);
        }
        if text.starts_with('[') {
            let tree = format!("it = {text}");
            let tree = DeTable::parse(&tree).ok();
            return tree.and_then(|tree| Some(unplaced(tree.get_ref().get("it")?.get_ref()))).unwrap_or_default();
        }
        if text.starts_with('"') { Value::from(self.value.as_str()) } else { Value::from(text) }
    }

    /// Is it the first of those that make one new entry?
    fn leads(&self, settings: &[Self], new: &[usize]) -> bool {
        let Some(part) = &self.part else { return true };
        let first = new.iter().map(|&it| &settings[it]).find(|it| it.part.as_ref().is_some_and(|it| it.is_beside(part)));
        first.is_some_and(|it| it.name == self.name)
    }

    /// Why an input cannot be given what is not one value of it.
    fn beyond_one_value<'n>(&self, entry: &dyn Fn(&str) -> Option<Entry<'n>>, model: Option<&Model>) -> Option<String> {
        let Self { name, value, .. } = self;
        if value.starts_with('[') {
            let axis = GIVING.iter().find(|table| entry(table).is_some_and(|it| !is_tolerance(&it)));
            let remedy = match axis.filter(|it| **it != "fixed") {
                Some(table) => format!("--set {table}.{name}={}", shortened(value)),
                None => format!("{name} = {} in [operation] or [design] of the study", shortened(value)),
            };
            return Some(format!("a name alone takes one value, and several are an axis; write {remedy}"));
        }
        let is_word = || model.is_some_and(|it| it.input(name).is_some_and(|at| it.inputs[at].value_of(value).is_some()));
        (value == OFF && !is_word()).then(|| format!("{OFF_TAKES_OUT}; an input needs a value"))
    }

    fn told(&self) -> String {
        if self.is_of_report() {
            return "--feasible".to_owned();
        }
        format!("--set {}={}", shortened(&self.name), shortened(&self.value))
    }
}

/// What becomes of a design axis whose input is set.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum SetAxes {
    /// It goes: the study is one of fewer axes.
    Go,
    /// It stays with that one value, for what only one design is asked of: maps keep their axes.
    Stay,
}

/// The study's text with all settings in it.
struct EditedText {
    text: String,
    /// Of each setting: where it stands.
    places: Vec<Range<usize>>,
    /// Of each edit the line where it ends, and how many lines there are more than before.
    lines: Vec<(usize, isize)>,
}

impl Study {
    /// Checks a study given as text, with values in place of what it gives some inputs, each as `NAME=VALUE`. Returns the study and its
    /// text with these values. `models`, `file` and `folder` are as for [`Study::parse_with`].
    ///
    /// # Errors
    /// [`Error::Request`] for what is wrong with the values, [`Error::Study`] for what is wrong with the study, in file order.
    pub fn parse_set(models: &Models, text: &str, file: &str, folder: &Path, set: &[String]) -> Result<(Self, String)> {
        Self::parse_edited(models, text, file, folder, StudyEdits { set, feasible: false }, SetAxes::Go)
    }

    /// The same, where design axes go or stay.
    pub(super) fn parse_edited(
        models: &Models,
        text: &str,
        file: &str,
        folder: &Path,
        edits: StudyEdits<'_>,
        axes: SetAxes,
    ) -> Result<(Self, String)> {
        let mut settings = read_settings(edits.set)?;
        settings.extend(edits.feasible.then(StudySetting::feasible));
        // What is wrong with the syntax is told first.
        let tree = if settings.is_empty() { None } else { DeTable::parse(text).ok() };
        let Some(tree) = tree else {
            return Ok((Self::parse_with(models, text, file, folder)?, text.to_owned()));
        };
        let top = TomlTable::new(tree.get_ref(), 0);
        let edited = edited(&settings, &top, text, models, folder, axes)?;
        match Self::parse_with(models, &edited.text, file, folder) {
            Ok(study) => Ok((study, edited.text)),
            Err(errors) => {
                let right = Self::parse_with(models, text, file, folder).is_ok();
                Err(explained(errors, file, &settings, &edited, right))
            }
        }
    }
}

fn read_settings(set: &[String]) -> Result<Vec<StudySetting>> {
    let (mut settings, mut problems): (Vec<StudySetting>, _) = (Vec::new(), Vec::new());
    for assignment in set {
        match StudySetting::new(assignment) {
            Ok(it) if settings.iter().any(|other| other.name == it.name) => {
                problems.push(format!("--set gives {} twice; keep one of the two", shortened(&it.name)));
            }
            Ok(it) => settings.push(it),
            Err(problem) => problems.push(problem),
        }
    }
    if problems.is_empty() { Ok(settings) } else { Err(refusal(problems)) }
}

fn refusal(problems: Vec<String>) -> Error {
    Error::Request(problems.join("\n       "))
}

/// Puts the settings into the text.
fn edited(settings: &[StudySetting], top: &TomlTable<'_>, text: &str, models: &Models, folder: &Path, axes: SetAxes) -> Result<EditedText> {
    let model = top.get("model").and_then(|entry| models.find(entry.node.value.as_str()?));
    let is_input = |name: &str| model.as_ref().is_some_and(|model| model.input(name).is_some());
    let (mut edits, mut new, mut problems) = (Vec::new(), Vec::new(), Vec::new());
    let lines = Lines::new(text);
    let replaced: Vec<&str> = settings.iter().filter(|it| it.part.is_none()).map(|it| it.name.as_str()).collect();
    for (number, setting) in settings.iter().enumerate() {
        let name = setting.name.as_str();
        let entry = |table: &str| top.get(table)?.node.table()?.entries.into_iter().find(|entry| entry.key == name);
        let in_place = |entry: Entry<'_>| Edit { range: span(&entry), with: line_of(setting), writes: Some(number) };
        if setting.is_of_report() {
            match entry("report") {
                Some(entry) => edits.push(in_place(entry)),
                None => new.push(number),
            }
            continue;
        }
        if let Some(part) = &setting.part {
            match part.edit(&setting.value, &setting.in_toml(), number, top, text) {
                Ok(Some(edit)) => edits.push(edit),
                Ok(None) => new.push(number),
                Err(why) => problems.push(format!("{}: {why}", setting.told())),
            }
            continue;
        }
        if let Some((table, axis, file)) = joint_axis(name, top, folder, &is_input) {
            let why = format!("{} is set by the rows of \"{axis}\" in [{table}]", setting.name);
            if let Some(file) = file {
                problems.push(format!(
                    "{}: {why}; --set replaces the axis of one input: change the rows in \"{}\"",
                    setting.told(),
                    shortened(&file)
                ));
                continue;
            }
            problems.push(format!(
                "{}: {why}; --set replaces the axis of one input: give each row its value, as {table}.{axis}.1.{name}",
                setting.told()
            ));
            continue;
        }
        if let Some(formula) = entry("formulas") {
            let line = lines.position(formula.key_at).0;
            if !is_input(name) {
                problems.push(format!(
                    "{}: {name} is what the formula in line {line} gives; only inputs and variables can be set: change the formula, or set what it reads",
                    setting.told()
                ));
                continue;
            }
            if let Some(why) = left_without_reader(top, folder, &lines, &replaced, &is_input) {
                problems.push(format!("{}: the formula in line {line} gives {name}, and {why}", setting.told()));
                continue;
            }
        }
        if let Some(why) = setting.beyond_one_value(&entry, model.as_deref()) {
            problems.push(format!("{}: {why}", setting.told()));
            continue;
        }
        if !is_name(name) {
            problems.push(format!("{}: there is no input of that name; names have letters, digits and \"_\"", setting.told()));
            continue;
        }
        if let Some(axis) = entry("design").filter(|_| axes == SetAxes::Stay) {
            edits.push(in_place(axis));
            continue;
        }
        for table in ["design", "operation", "uncertainty", "formulas"] {
            // What is set is what the design says, and a tolerance is about that.
            let values = entry(table).filter(|entry| !is_tolerance(entry));
            edits.extend(values.map(|entry| Edit { writes: None, ..left_out(&entry, text) }));
        }
        match entry("fixed") {
            Some(entry) => edits.push(in_place(entry)),
            None => new.push(number),
        }
    }
    if !problems.is_empty() {
        return Err(refusal(problems));
    }
    for table in ["fixed", "constraints", "objectives", "probability", "report"] {
        let (at, before, after) = place_in(table, top, text);
        let of_table = new.iter().filter(|&&number| settings[number].table == table && settings[number].leads(settings, &new));
        for (count, &number) in of_table.enumerate() {
            let [before, after] = [&before, &after].map(|it| &it[count.min(1)]);
            let line = new_line(number, settings, &new);
            edits.push(Edit { range: at..at, with: format!("{before}{line}{after}"), writes: Some(number) });
        }
    }
    let unread = unread(settings, top, &is_input);
    edits.extend(unread.iter().map(|entry| Edit { writes: None, ..left_out(entry, text) }));
    edits.sort_by_key(|edit| edit.range.start);
    if edits.windows(2).any(|pair| pair[0].range.end > pair[1].range.start) {
        let told = settings.iter().map(StudySetting::told).collect::<Vec<_>>().join(" and ");
        return Err(refusal(vec![format!("{told}: one of them is a part of what another sets; keep one of the two")]));
    }
    let edited = applied(edits, text, settings.len());
    let gone: Vec<&str> = unread.iter().map(|entry| entry.key).collect();
    if is_as_meant(&edited.text, top, settings, &gone) {
        return Ok(edited);
    }
    let told = settings.iter().map(StudySetting::told).collect::<Vec<_>>().join(" ");
    Err(refusal(vec![format!("{told}: the study is written in a way that cannot be edited; give the value in its [fixed]")]))
}

/// Fixed variables that nothing reads but formulas which a setting replaces: they go with these.
fn unread<'n>(settings: &[StudySetting], top: &TomlTable<'n>, is_input: &dyn Fn(&str) -> bool) -> Vec<Entry<'n>> {
    let is_set = |name: &str| settings.iter().any(|it| it.name == name);
    let replaced: Vec<&str> = settings.iter().map(|it| it.name.as_str()).collect();
    let is_unread = |entry: &Entry<'_>| !is_set(entry.key) && !is_input(entry.key) && read_by_none_but(top, &replaced, entry.key);
    entries_of(top, "fixed").into_iter().filter(is_unread).collect()
}

fn entries_of<'n>(top: &TomlTable<'n>, table: &str) -> Vec<Entry<'n>> {
    top.get(table).and_then(|entry| entry.node.table()).map_or_else(Vec::new, |table| table.entries)
}

/// Do some of these formulas read a name, and no other one?
fn read_by_none_but(top: &TomlTable<'_>, formulas: &[&str], name: &str) -> bool {
    let formula_text = |entry: &Entry<'_>| {
        let node = entry.node.table().and_then(|parts| parts.get("is").map(|it| it.node)).unwrap_or(entry.node);
        node.value.as_str().unwrap_or_default().to_owned()
    };
    let reads = |entry: &Entry<'_>| formula_text(entry).split(|it: char| !it.is_ascii_alphanumeric() && it != '_').any(|it| it == name);
    let (of_them, others): (Vec<_>, Vec<_>) =
        entries_of(top, "formulas").into_iter().filter(reads).partition(|it| formulas.contains(&it.key));
    !of_them.is_empty() && others.is_empty()
}

/// What is wrong with replacing these formulas: the study varies something that nothing would read any more.
fn left_without_reader(
    top: &TomlTable<'_>,
    folder: &Path,
    lines: &Lines<'_>,
    replaced: &[&str],
    is_input: &dyn Fn(&str) -> bool,
) -> Option<String> {
    let is_fixed = |name: &str| entries_of(top, "fixed").iter().any(|it| it.key == name);
    let lost = |(name, _): &(String, usize)| !is_input(name) && !is_fixed(name) && read_by_none_but(top, replaced, name);
    let (name, at) = given(top, folder).into_iter().find(lost)?;
    let line = lines.position(at).0;
    let own = GIVING.iter().find(|table| entries_of(top, table).iter().any(|it| it.key == name));
    let instead = own.map_or(String::new(), |table| format!("set {table}.{name}=[VALUE] instead, or "));
    Some(format!("nothing else reads {name} of line {line}; {instead}take that formula and {name} out of the study"))
}

/// The line of a new entry, which may have several keys.
fn new_line(number: usize, settings: &[StudySetting], new: &[usize]) -> String {
    let Some(part) = &settings[number].part else { return line_of(&settings[number]) };
    let beside = new.iter().filter_map(|&it| Some((settings[it].part.as_ref()?, &settings[it])));
    let keys: Vec<_> = beside.filter(|(it, _)| it.is_beside(part)).map(|(it, setting)| (it.new_key(), setting.in_toml())).collect();
    part.line(&keys)
}

fn line_of(setting: &StudySetting) -> String {
    format!("{} = {}", setting.name, setting.in_toml())
}

/// The CSV file that cases take their rows from.
fn file_of(cases: TomlNode<'_>) -> Option<String> {
    cases.table().and_then(|table| Some(table.get("csv")?.node.value.as_str()?.to_owned()))
}

/// The table and the path of the rows that set an input, and the file that they stand in if they do.
fn joint_axis<'n>(
    name: &str,
    top: &TomlTable<'n>,
    folder: &Path,
    is_input: &dyn Fn(&str) -> bool,
) -> Option<(&'static str, String, Option<String>)> {
    // Cases with weights stand within their axis.
    let cases_of = |entry: &Entry<'n>| match weighted_cases(entry) {
        Some(weighted) => Some((format!("{}.cases", entry.key), weighted.get("cases")?.node)),
        None => entry.key.starts_with("cases").then(|| (entry.key.to_owned(), entry.node)),
    };
    let names_it = |cases: TomlNode<'_>| {
        if let Some(mut rows) = cases.list() {
            return rows.any(|row| row.table().is_some_and(|row| row.get(name).is_some()));
        }
        let file = file_of(cases);
        // A file that cannot be read is reported when the study is.
        let Some(text) = file.and_then(|file| csv_text(folder, &file, "study").ok()) else { return false };
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
        reader.headers().is_ok_and(|header| header.iter().any(|it| it == name))
    };
    GIVING.iter().find_map(|&table| {
        let entries = top.get(table)?.node.table()?.entries;
        let joint = entries.into_iter().filter(|it| !is_input(it.key)).filter_map(|it| cases_of(&it));
        let (path, cases) = joint.into_iter().find(|(_, cases)| names_it(*cases))?;
        Some((table, path, file_of(cases)))
    })
}

/// Makes edits that are in order; where several are put in at one place they keep theirs.
fn applied(edits: Vec<Edit>, text: &str, settings: usize) -> EditedText {
    let mut edited = EditedText { text: String::new(), places: vec![0..0; settings], lines: Vec::new() };
    let mut done = 0;
    for Edit { range, with, writes } in edits {
        edited.text.push_str(&text[done..range.start]);
        let start = edited.text.len();
        let count = |text: &str| text.matches('\n').count();
        edited.text.push_str(&with);
        #[allow(clippy::cast_possible_wrap, reason = "a text has no more lines than bytes")]
        edited.lines.push((count(&edited.text), count(&with) as isize - count(&text[range.clone()]) as isize));
        if let Some(setting) = writes {
            edited.places[setting] = start..edited.text.len();
        }
        done = range.end;
    }
    edited.text.push_str(&text[done..]);
    edited
}

/// Does the edited text say what the other said, but for the settings and fixed values that are gone?
fn is_as_meant(text: &str, top: &TomlTable<'_>, settings: &[StudySetting], gone: &[&str]) -> bool {
    let Ok(tree) = DeTable::parse(text) else { return false };
    let own = TomlTable::new(tree.get_ref(), 0);
    let whole = |top: &TomlTable<'_>| -> Map<String, Value> {
        top.entries.iter().map(|entry| (entry.key.to_owned(), unplaced(entry.node.value))).collect()
    };
    let (mut wanted, found) = (whole(top), whole(&own));
    if let Some(fixed) = wanted.get_mut("fixed").and_then(Value::as_object_mut) {
        gone.iter().for_each(|name| drop(fixed.shift_remove(*name)));
    }
    let tolerances =
        |name: &str| top.get("uncertainty").and_then(|it| it.node.table()).is_some_and(|it| it.get(name).is_some_and(is_tolerance));
    for setting in settings {
        if let Some(part) = &setting.part {
            part.put(&setting.value, setting.in_json(), &mut wanted);
            continue;
        }
        // An input that is set has one place, whichever that is; a tolerance is about that.
        let stays = |table: &str| found.get(table).is_some_and(|it| it.get(&setting.name).is_some_and(|it| *it == setting.in_json()));
        let place = ["design", setting.table].into_iter().find(|it| stays(it)).unwrap_or(setting.table);
        for table in GIVING.iter().chain(&["formulas"]).filter(|it| **it != place && !(**it == "uncertainty" && tolerances(&setting.name)))
        {
            wanted.get_mut(*table).and_then(Value::as_object_mut).map(|it| it.shift_remove(&setting.name));
        }
        let table = wanted.entry(place).or_insert_with(|| Value::Object(Map::new()));
        table.as_object_mut().map(|it| it.insert(setting.name.clone(), setting.in_json()));
    }
    // Tables and their entries have no order here.
    wanted == found
}

/// Is it about what the design says, rather than a value?
fn is_tolerance(entry: &Entry<'_>) -> bool {
    entry.node.table().is_some_and(|table| tolerance(&table).is_some())
}

/// A value without its place.
fn unplaced(value: &DeValue<'_>) -> Value {
    match value {
        DeValue::String(text) => Value::from(text.as_ref()),
        DeValue::Integer(it) => Value::from(it.to_string()),
        DeValue::Float(it) => Value::from(it.to_string()),
        DeValue::Boolean(it) => Value::from(*it),
        DeValue::Datetime(it) => Value::from(it.to_string()),
        DeValue::Array(it) => it.iter().map(|it| unplaced(it.get_ref())).collect(),
        DeValue::Table(it) => it.iter().map(|(key, value)| (key.get_ref().to_string(), unplaced(value.get_ref()))).collect(),
    }
}

/// A message with other numbers of the lines that it names.
fn with_lines(message: &str, other: impl Fn(usize) -> usize) -> String {
    const LINE: &str = " line ";
    let mut parts = message.split(LINE);
    let mut told = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let digits = part.find(|it: char| !it.is_ascii_digit()).unwrap_or(part.len());
        let line = part[..digits].parse().map_or_else(|_| part[..digits].to_owned(), |line| other(line).to_string());
        told.push_str(&format!("{LINE}{line}{}", &part[digits..]));
    }
    told
}

/// Problems of the edited text, told where the user can change them: those of a setting by its name, others at their place in the file.
fn explained(errors: StudyErrors, file: &str, settings: &[StudySetting], edited: &EditedText, right: bool) -> Error {
    let lines = Lines::new(&edited.text);
    let places: Vec<_> = edited.places.iter().map(|it| (lines.position(it.start), lines.position(it.end))).collect();
    let told = settings.iter().map(StudySetting::told).collect::<Vec<_>>().join(" ");
    let (mut of_settings, mut of_file) = (Vec::new(), Vec::new());
    let own_line = |line: usize| {
        let put_in = edited.lines.iter().filter(|(end, _)| *end < line).map(|it| it.1).sum::<isize>();
        line.saturating_add_signed(-put_in)
    };
    for problem in errors.problems {
        let at = (problem.line, problem.column);
        // A CSV file has its own lines.
        let is_own = problem.file == file;
        let problem = if is_own { Problem { message: with_lines(&problem.message, own_line), ..problem } } else { problem };
        if let Some(number) = places.iter().position(|(from, to)| is_own && (from..=to).contains(&&at)) {
            let name = settings[number].part.as_ref().map_or(&settings[number].name, |part| &part.entry);
            let labels = ["fixed input", "axis", "constraint", "objective"].map(|what| format!("{what} \"{name}\": "));
            let labels = labels.iter().map(String::as_str).chain(["feasible: "]);
            let message = labels.into_iter().find_map(|label| problem.message.strip_prefix(label)).unwrap_or(&problem.message);
            of_settings.push(format!("{}: {message}", settings[number].told()));
            continue;
        }
        let line = if is_own { own_line(problem.line) } else { problem.line };
        let is_lost_axis =
            |it: &&StudySetting| it.part.is_none() && problem.message.contains(&format!("\"{}\" is no design axis", it.name));
        let axis = settings.iter().find(is_lost_axis);
        let stays = axis.map_or(String::new(), |it| format!("; --set design.{}=[{}] keeps it as an axis", it.name, shortened(&it.value)));
        let message = if right { format!("{}; without {told} the study is right{stays}", problem.message) } else { problem.message };
        of_file.push(Problem { line, message, ..problem });
    }
    if of_settings.is_empty() { StudyErrors { problems: of_file }.into() } else { refusal(of_settings) }
}
