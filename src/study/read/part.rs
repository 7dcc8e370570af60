//! A part of a study that is given another value: `--set constraints.stress_margin.min=0.1`.
//!
//! The name says where the part stands: a table, an entry of it, and a key where the entry has several; of what is written as rows or lists
//! also the number of the row or the value, from 1, and of a distribution its keys: `operation.cases.2.torque_Nm`,
//! `uncertainty.friction.normal.mean`. What is there is replaced; entries, bounds and keys of axes that are not there are added; `off` takes
//! an entry out. Nothing that names a file can be set so.

#[cfg(feature = "cli")]
use super::is_model_file;
use super::place::{Edit, left_out};
use super::table::{Entry, TomlNode, TomlTable, shortened};
#[cfg(feature = "cli")]
use super::value::number;
use crate::models::is_name;
use serde_json::{Map, Value};
#[cfg(feature = "cli")]
use std::path::Path;
use toml::de::DeTable;

/// Tables whose entries can be changed, and the keys of their entries.
const TABLES: [(&str, &[&str]); 7] = [
    ("design", AXIS),
    ("operation", AXIS),
    ("uncertainty", AXIS),
    ("fixed", &[]),
    ("constraints", &["min", "max", "above", "below"]),
    ("objectives", &["goal", "resolution"]),
    ("probability", &[]),
];
/// Entries of `[probability]` that are numbers.
const DRAWING: &[&str] = &["draws", "confirm", "seed"];
/// What names a file.
const FILE: &str = "csv";
const AXIS: &[&str] = &["from", "to", "count", "step", "spacing"];
/// What takes an entry out.
pub(super) const OFF: &str = "off";
/// What that is for.
pub(super) const OFF_TAKES_OUT: &str = "\"off\" takes out a whole constraint or objective, as constraints.NAME=off";

/// Where a value goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct StudyPart {
    pub(super) table: &'static str,
    pub(super) entry: String,
    /// Keys and numbers that lead to it within the entry.
    keys: Vec<String>,
}

impl StudyPart {
    /// Reads `TABLE.ENTRY` or `TABLE.ENTRY.KEY`; `None` for a name without a dot, which is that of an input.
    pub(super) fn read(path: &str) -> Option<Result<Self, String>> {
        let mut names = dotted(path)?.into_iter();
        let (table, entry) = (names.next()?, names.next()?);
        let (table, entry) = (table.as_str(), entry.as_str());
        let inner: Vec<String> = names.collect();
        let Some((table, keys)) = TABLES.iter().find(|(name, _)| *name == table) else {
            let tables = TABLES.map(|(name, _)| name).join(", ");
            return Some(Err(format!("there is nothing to set in \"{}\"; parts of a study begin with one of {tables}", shortened(table))));
        };
        // Constraints may be called anything.
        if !is_name(entry) && *table != "constraints" {
            return Some(Err(format!("\"{}\" is no name; write {table}.NAME or {table}.NAME.KEY", shortened(entry))));
        }
        if *table == "constraints" && inner.len() > 1 {
            let (last, name) = (inner.last().map_or("", String::as_str), format!("{entry}.{}", inner[..inner.len() - 1].join(".")));
            let name = shortened(&name);
            return Some(Err(format!("a constraint has one key; if its name is \"{name}\", write {table}.\"{name}\".{last}")));
        }
        if *table == "probability" && !DRAWING.contains(&entry) {
            return Some(Err(format!("\"{}\" cannot be set; of [probability] these can: {}", shortened(entry), DRAWING.join(", "))));
        }
        // Rows, lists and distributions have parts that only the study knows.
        let wrong = match inner.as_slice() {
            [] => None,
            [key] if *keys != AXIS => Some(key).filter(|key| !keys.contains(&key.as_str())),
            [_, further, ..] if *keys != AXIS => Some(further),
            all => all.iter().find(|key| *key == FILE),
        };
        if let Some(key) = wrong {
            let remedy = if keys.is_empty() { format!("write {table}.{entry}=VALUE") } else { format!("keys are {}", keys.join(", ")) };
            return Some(Err(format!("\"{}\" cannot be set; {remedy}", shortened(key))));
        }
        Some(Ok(Self { table, entry: entry.to_owned(), keys: inner }))
    }

    /// The only key, if the part has no more.
    fn key(&self) -> Option<&str> {
        if let [key] = self.keys.as_slice() { Some(key) } else { None }
    }

    /// Is the whole entry to go?
    fn is_off(&self, value: &str) -> bool {
        value == OFF && self.keys.is_empty() && ["constraints", "objectives"].contains(&self.table)
    }

    /// The edit that gives it the value, as the study writes it. `None`: a new entry, which the caller writes.
    pub(super) fn edit(&self, value: &str, written: &str, number: usize, top: &TomlTable<'_>, text: &str) -> Result<Option<Edit>, String> {
        let table = top.get(self.table).and_then(|entry| entry.node.table());
        let found = table.and_then(|table| table.entries.into_iter().find(|entry| entry.key == self.entry));
        let here = |range, with| Ok(Some(Edit { range, with, writes: Some(number) }));
        let Self { table, entry: name, keys } = self;
        let Some(entry) = found else {
            return match (*table, self.key()) {
                _ if self.is_off(value) => Err(format!("the study has no {name} in [{table}]")),
                ("constraints", Some(_)) => Ok(None),
                ("objectives" | "fixed" | "probability", None) if keys.is_empty() => Ok(None),
                ("constraints", None) => Err(format!("write {table}.{name}.min=VALUE or {table}.{name}.max=VALUE")),
                _ => Err(format!("the study has no {name} in [{table}]")),
            };
        };
        if self.is_off(value) {
            if text[..entry.key_at].trim_end().ends_with(['[', '.']) && entry.node.table().is_some() {
                return Ok(Some(without_table(&entry, text)));
            }
            return Ok(Some(left_out(&entry, text)));
        }
        if value == OFF {
            let remedy = match *table {
                "constraints" | "objectives" => format!("write {table}.{}=off, or give {} another value", quoted_key(name), keys.join(".")),
                _ => "give another value".to_owned(),
            };
            return Err(format!("{OFF_TAKES_OUT}; {remedy}"));
        }
        if keys.is_empty() {
            return here(entry.node.at..entry.node.end, written.to_owned());
        }
        let addable = TABLES.iter().find(|(it, _)| it == table).map_or(&[][..], |(_, keys)| keys);
        if let (Some(key), Some(inner)) = (self.key(), entry.node.table())
            && inner.get(key).is_none()
            && addable.contains(&key)
            && let Some(last) = inner.entries.last()
        {
            return here(last.node.end..last.node.end, format!(", {key} = {written}"));
        }
        let node = within(&entry, table, keys)?;
        here(node.at..node.end, written.to_owned())
    }

    /// A new entry with this part in it, or with several keys of it.
    pub(super) fn line(&self, written: &[(Option<&str>, String)]) -> String {
        let keys = written.iter().map(|(key, value)| key.map_or_else(|| value.clone(), |key| format!("{key} = {value}")));
        let keys = keys.collect::<Vec<_>>().join(", ");
        let name = quoted_key(&self.entry);
        if self.keys.is_empty() { format!("{name} = {keys}") } else { format!("{name} = {{ {keys} }}") }
    }

    /// What leads a new entry's value within it.
    pub(super) fn new_key(&self) -> Option<&str> {
        self.key()
    }

    /// Is it of the same entry?
    pub(super) fn is_beside(&self, other: &Self) -> bool {
        (self.table, &self.entry) == (other.table, &other.entry)
    }

    /// What the whole file says once this part has the value: tables of entries, without places.
    pub(super) fn put(&self, value: &str, json: Value, tables: &mut Map<String, Value>) {
        let table = tables.entry(self.table).or_insert_with(|| Value::Object(Map::new()));
        let Some(table) = table.as_object_mut() else { return };
        if self.is_off(value) {
            table.shift_remove(&self.entry);
            return;
        }
        let mut at = table.entry(&self.entry).or_insert_with(|| Value::Object(Map::new()));
        for key in &self.keys {
            let next = match at {
                Value::Array(list) => number_of(key, list.len()).and_then(|it| list.get_mut(it)),
                Value::Object(inner) => Some(inner.entry(key).or_insert(Value::Null)),
                _ => None,
            };
            let Some(next) = next else { return };
            at = next;
        }
        *at = json;
    }
}

/// A table with a header of its own, such as `[constraints.slip_margin]`, as comments.
fn without_table(entry: &Entry<'_>, text: &str) -> Edit {
    let start = text[..entry.key_at].rfind('\n').map_or(0, |at| at + 1);
    let last = entry.node.table().and_then(|table| table.entries.last().map(|it| it.node.end));
    let end = last.unwrap_or(entry.key_at).max(entry.key_at);
    let range = start..text[end..].find('\n').map_or(text.len(), |at| end + at);
    Edit { with: format!("# {}", text[range.clone()].replace('\n', "\n# ")), range, writes: None }
}

/// The names and numbers of a path, which may be written as TOML writes a key: `constraints."a b".min`. `None` without a dot.
fn dotted(path: &str) -> Option<Vec<String>> {
    if !path.contains(['"', '\'']) {
        return path.contains('.').then(|| path.split('.').map(str::to_owned).collect());
    }
    let text = format!("{path} = 0");
    let tree = DeTable::parse(&text).ok()?;
    let mut names = Vec::new();
    let mut table = tree.get_ref();
    loop {
        let (name, value) = table.iter().next()?;
        names.push(name.get_ref().to_string());
        match value.get_ref().as_table() {
            Some(inner) => table = inner,
            None => return (names.len() > 1).then_some(names),
        }
    }
}

/// A key as a study file has it.
pub(crate) fn quoted_key(name: &str) -> String {
    let is_bare = !name.is_empty() && name.chars().all(|it| it.is_ascii_alphanumeric() || it == '_' || it == '-');
    if is_bare { name.to_owned() } else { Value::from(name).to_string() }
}

/// The place in a list of so many that a number from 1 stands for.
fn number_of(key: &str, count: usize) -> Option<usize> {
    key.parse::<usize>().ok().filter(|it| (1..=count).contains(it)).map(|it| it - 1)
}

/// What keys and numbers lead to within an entry: a value, or a list of values.
fn within<'n>(entry: &Entry<'n>, table: &str, keys: &[String]) -> Result<TomlNode<'n>, String> {
    let mut node = entry.node;
    for (depth, key) in keys.iter().enumerate() {
        let told = || shortened(key);
        if let Some(inner) = node.table() {
            if let Some(file) = inner.get(FILE) {
                return Err(format!("\"{}\" cannot be set: its rows are in {}; change them there", told(), file.node.found()));
            }
            // A range has further keys; what has parts, such as a distribution, has its own.
            let is_range = depth == 0 && inner.entries.iter().all(|it| it.node.table().is_none() && it.node.list().is_none());
            let own = inner.entries.iter().map(|it| it.key).filter(|it| !is_range || !AXIS.contains(it));
            let keys: Vec<&str> = if is_range { AXIS.iter().copied().chain(own).collect() } else { own.collect() };
            node = inner.get(key).map(|it| it.node).ok_or_else(|| format!("\"{}\" cannot be set; keys are {}", told(), keys.join(", ")))?;
        } else if let Some(mut list) = node.list() {
            let count = list.len();
            let place = number_of(key, count);
            let problem =
                || format!("\"{}\" cannot be set; {} of [{table}] has {count} values or rows, numbered from 1", told(), entry.key);
            node = place.and_then(|it| list.nth(it)).ok_or_else(problem)?;
        } else if depth == 0 {
            return Err(no_keys(entry, table));
        } else {
            return Err(format!("\"{}\" cannot be set: {} is {}", told(), keys[depth - 1], node.found()));
        }
    }
    let parts = node.table().map(|it| it.entries.iter().map(|it| it.key).collect::<Vec<_>>());
    match parts {
        Some(parts) => Err(format!("it has parts of its own, each of which can be set: {}", parts.join(", "))),
        None => Ok(node),
    }
}

fn no_keys(entry: &Entry<'_>, table: &str) -> String {
    format!("{} of [{table}] is {}, which has no keys; give all of it a new value", entry.key, entry.node.found())
}

/// A value as a study file has it: a number, a list of numbers or words, or a text.
///
/// # Errors
/// A sentence, if it begins like a list and is none.
pub(super) fn written(value: &str) -> Result<String, String> {
    match value.parse::<f64>() {
        Ok(number) if number.is_finite() => return Ok(format!("{number:?}").trim_end_matches(".0").to_owned()),
        _ if !value.starts_with('[') => return Ok(Value::from(value).to_string()),
        _ => {}
    }
    let text = format!("it = {value}");
    let tree = DeTable::parse(&text).ok();
    let is_plain = |node: TomlNode<'_>| {
        let scalar = |it: TomlNode<'_>| it.table().is_none() && it.list().is_none();
        node.list().is_some_and(|mut list| list.all(scalar))
    };
    let whole = tree.as_ref().map(|tree| TomlTable::new(tree.get_ref(), 0));
    let is_list = whole.is_some_and(|table| table.entries.len() == 1 && is_plain(table.entries[0].node));
    if is_list { Ok(value.to_owned()) } else { Err("write a list of numbers or words, such as [50, 150]".to_owned()) }
}

/// The names of the entries of a table, in file order.
#[cfg(feature = "pictures")]
pub(crate) fn entry_names(text: &str, table: &str) -> Vec<String> {
    let Ok(tree) = DeTable::parse(text) else { return Vec::new() };
    let top = TomlTable::new(tree.get_ref(), 0);
    let found = top.get(table).and_then(|entry| entry.node.table());
    found.map_or_else(Vec::new, |table| table.entries.iter().map(|entry| entry.key.to_owned()).collect())
}

/// A value of an entry, with the keys and numbers from 1 that lead to it.
#[cfg(feature = "cli")]
pub(crate) type EntryLeaf = (Vec<String>, Value);

/// What can be set of an entry of a table that is written as rows, lists or keys: numbers and texts, in file order. Nothing of what stands
/// in a file of its own.
#[cfg(feature = "cli")]
pub(crate) fn entry_leaves(text: &str, table: &str, entry: &str) -> Vec<EntryLeaf> {
    fn walk(node: TomlNode<'_>, keys: &mut Vec<String>, found: &mut Vec<EntryLeaf>) {
        let mut inside = |key: String, node: TomlNode<'_>| {
            keys.push(key);
            walk(node, keys, found);
            keys.pop();
        };
        if let Some(table) = node.table() {
            if table.get(FILE).is_none() {
                table.entries.iter().for_each(|it| inside(it.key.to_owned(), it.node));
            }
        } else if let Some(list) = node.list() {
            list.enumerate().for_each(|(at, node)| inside((at + 1).to_string(), node));
        } else if let Some(Ok(value)) = number(node) {
            found.push((keys.clone(), crate::study::number(value)));
        } else if let Some(word) = node.value.as_str() {
            found.push((keys.clone(), word.into()));
        }
    }
    let Ok(tree) = DeTable::parse(text) else { return Vec::new() };
    let top = TomlTable::new(tree.get_ref(), 0);
    let table = top.get(table).and_then(|entry| entry.node.table());
    let mut found = Vec::new();
    if let Some(entry) = table.as_ref().and_then(|table| table.get(entry)) {
        walk(entry.node, &mut Vec::new(), &mut found);
    }
    found
}

/// The text with the paths of the files that it names written out, from the root on, so that it can stand anywhere: the file of its model and
/// CSV files in `folder`.
#[cfg(feature = "cli")]
pub(crate) fn with_whole_paths(text: &str, folder: &Path) -> String {
    fn files<'n>(node: TomlNode<'n>, found: &mut Vec<TomlNode<'n>>) {
        if let Some(table) = node.table() {
            found.extend(table.get(FILE).map(|it| it.node).filter(|it| it.value.is_str()));
            table.entries.iter().for_each(|it| files(it.node, found));
        } else if let Some(list) = node.list() {
            list.for_each(|it| files(it, found));
        }
    }
    let Ok(tree) = DeTable::parse(text) else { return text.to_owned() };
    let top = TomlTable::new(tree.get_ref(), 0);
    let mut found: Vec<TomlNode<'_>> =
        top.get("model").map(|it| it.node).filter(|it| it.value.as_str().is_some_and(is_model_file)).into_iter().collect();
    top.entries.iter().for_each(|it| files(it.node, &mut found));
    found.sort_by_key(|it| it.at);
    let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
    let mut whole = text.to_owned();
    for node in found.into_iter().rev() {
        let path = folder.join(node.value.as_str().unwrap_or_default());
        // A path that is no text stays as it is.
        if let Some(path) = std::fs::canonicalize(&path).unwrap_or(path).to_str() {
            whole.replace_range(node.at..node.end, &Value::from(path).to_string());
        }
    }
    whole
}
