//! A part of a study that is given another value: `--set constraints.stress_margin.min=0.1`.
//!
//! The name says where the part stands: a table, an entry of it, and a key where the entry has several. What is there is replaced, what
//! is not there is added, and `off` takes an entry out. Nothing that names a file can be set so.

use super::place::{Edit, left_out};
use super::table::{Entry, TomlNode, TomlTable, shortened};
use crate::models::is_name;
use serde_json::{Map, Value};
use toml::de::DeTable;

/// Tables whose entries can be changed, and the keys of their entries.
const TABLES: [(&str, &[&str]); 6] = [
    ("design", AXIS),
    ("operation", AXIS),
    ("uncertainty", AXIS),
    ("fixed", &[]),
    ("constraints", &["min", "max", "above", "below"]),
    ("objectives", &["goal", "resolution"]),
];
const AXIS: &[&str] = &["from", "to", "count", "step", "spacing"];
/// What takes an entry out.
const OFF: &str = "off";

/// Where a value goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct StudyPart {
    pub(super) table: &'static str,
    pub(super) entry: String,
    key: Option<String>,
}

impl StudyPart {
    /// Reads `TABLE.ENTRY` or `TABLE.ENTRY.KEY`; `None` for a name without a dot, which is that of an input.
    pub(super) fn read(path: &str) -> Option<Result<Self, String>> {
        let (table, rest) = path.split_once('.')?;
        let (entry, key) = rest.split_once('.').map_or((rest, None), |(entry, key)| (entry, Some(key)));
        let Some((table, keys)) = TABLES.iter().find(|(name, _)| *name == table) else {
            let tables = TABLES.map(|(name, _)| name).join(", ");
            return Some(Err(format!("there is nothing to set in \"{}\"; parts of a study begin with one of {tables}", shortened(table))));
        };
        if !is_name(entry) {
            return Some(Err(format!("\"{}\" is no name; write {table}.NAME or {table}.NAME.KEY", shortened(entry))));
        }
        if let Some(key) = key.filter(|key| !keys.contains(key)) {
            let remedy = if keys.is_empty() { format!("write {table}.{entry}=VALUE") } else { format!("keys are {}", keys.join(", ")) };
            return Some(Err(format!("\"{}\" cannot be set; {remedy}", shortened(key))));
        }
        Some(Ok(Self { table, entry: entry.to_owned(), key: key.map(str::to_owned) }))
    }

    /// Is the whole entry to go?
    fn is_off(&self, value: &str) -> bool {
        value == OFF && self.key.is_none() && ["constraints", "objectives"].contains(&self.table)
    }

    /// The edit that gives it the value, as the study writes it. `None`: a new entry, which the caller writes.
    pub(super) fn edit(&self, value: &str, written: &str, number: usize, top: &TomlTable<'_>, text: &str) -> Result<Option<Edit>, String> {
        let table = top.get(self.table).and_then(|entry| entry.node.table());
        let found = table.and_then(|table| table.entries.into_iter().find(|entry| entry.key == self.entry));
        let here = |range, with| Ok(Some(Edit { range, with, writes: Some(number) }));
        let Self { table, entry: name, key } = self;
        let Some(entry) = found else {
            return match (*table, key) {
                _ if self.is_off(value) => Err(format!("the study has no {name} in [{table}]")),
                ("constraints", Some(_)) | ("objectives" | "fixed", None) => Ok(None),
                ("constraints", None) => Err(format!("write {table}.{name}.min=VALUE or {table}.{name}.max=VALUE")),
                _ => Err(format!("the study has no {name} in [{table}]")),
            };
        };
        if self.is_off(value) {
            return Ok(Some(left_out(&entry, text)));
        }
        let Some(key) = key else { return here(entry.node.at..entry.node.end, written.to_owned()) };
        let Some(inner) = entry.node.table() else { return Err(no_keys(&entry, table)) };
        match (inner.get(key), inner.entries.last()) {
            (Some(held), _) => here(held.node.at..held.node.end, written.to_owned()),
            (None, Some(last)) => here(last.node.end..last.node.end, format!(", {key} = {written}")),
            (None, None) => Err(no_keys(&entry, table)),
        }
    }

    /// A new entry with this part in it, or with several keys of it.
    pub(super) fn line(&self, written: &[(Option<&str>, String)]) -> String {
        let keys = written.iter().map(|(key, value)| key.map_or_else(|| value.clone(), |key| format!("{key} = {value}")));
        let keys = keys.collect::<Vec<_>>().join(", ");
        if self.key.is_some() { format!("{} = {{ {keys} }}", self.entry) } else { format!("{} = {keys}", self.entry) }
    }

    pub(super) fn key(&self) -> Option<&str> {
        self.key.as_deref()
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
        match &self.key {
            None => table.insert(self.entry.clone(), json),
            Some(key) => {
                let entry = table.entry(&self.entry).or_insert_with(|| Value::Object(Map::new()));
                entry.as_object_mut().and_then(|entry| entry.insert(key.clone(), json))
            }
        };
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
#[cfg(feature = "cli")]
pub(crate) fn entry_names(text: &str, table: &str) -> Vec<String> {
    let Ok(tree) = DeTable::parse(text) else { return Vec::new() };
    let top = TomlTable::new(tree.get_ref(), 0);
    let found = top.get(table).and_then(|entry| entry.node.table());
    found.map_or_else(Vec::new, |table| table.entries.iter().map(|entry| entry.key.to_owned()).collect())
}
