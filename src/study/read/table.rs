//! Tables of the file in file order, positions in characters, and the list of problems.

use super::Problem;
use crate::likeness::remedy;
use std::cell::{Cell, RefCell};
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Where the lines of a text start.
pub(super) struct Lines<'t> {
    text: &'t str,
    starts: Vec<usize>,
    /// Where the last visible character ends.
    end: usize,
}

impl<'t> Lines<'t> {
    /// Finds the lines.
    pub(super) fn new(text: &'t str) -> Self {
        // A byte order mark is invisible in an editor and takes no column.
        let first = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        let starts = std::iter::once(first).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        Self { text, starts, end: text.trim_end().len() }
    }

    /// Index of the line that holds the byte `at`.
    pub(super) fn index(&self, at: usize) -> usize {
        self.starts.partition_point(|&start| start <= at).saturating_sub(1)
    }

    /// Number of lines; text that ends with a line end has an empty last one.
    pub(super) fn count(&self) -> usize {
        self.starts.len()
    }

    /// Byte range of a line, without its line end.
    pub(super) fn range(&self, index: usize) -> std::ops::Range<usize> {
        let end = self.starts.get(index + 1).map_or(self.text.len(), |next| next - 1);
        self.starts[index].min(end)..end
    }

    /// The line, without its line end.
    pub(super) fn line(&self, index: usize) -> &'t str {
        &self.text[self.range(index)]
    }

    /// The byte `at`, or the last visible character if it lies beyond.
    fn visible(&self, at: usize) -> usize {
        at.min(self.end).max(self.starts[0])
    }

    /// Line and column of the byte `at`, from 1, the column in characters. A byte after the last visible character of the text gets the
    /// place of that character, because an editor has no place beyond it.
    pub(super) fn position(&self, at: usize) -> (usize, usize) {
        let at = self.visible(at);
        let index = self.index(at);
        let before = &self.text.as_bytes()[self.starts[index]..at];
        // Continuation bytes of a character are not counted, so `at` need not be a character boundary.
        (index + 1, 1 + before.iter().filter(|&&byte| byte & 0xC0 != 0x80).count())
    }
}

/// Most problems that are reported of one study: nobody corrects more at a time, and finding the line of each takes time.
const MOST_PROBLEMS: usize = 100;
/// Most characters of a message.
const MOST_CHARACTERS: usize = 2000;

/// The problems found so far.
pub(super) struct Problems<'t> {
    pub(super) lines: Lines<'t>,
    file: &'t str,
    found: RefCell<Vec<(usize, Problem)>>,
    incomplete: Cell<bool>,
    /// Was anything left out or unread because there are too many?
    more: Cell<bool>,
}

impl<'t> Problems<'t> {
    /// An empty list for this text.
    pub(super) fn new(text: &'t str, file: &'t str) -> Self {
        Self { lines: Lines::new(text), file, found: RefCell::default(), incomplete: Cell::new(false), more: Cell::new(false) }
    }

    /// Adds a problem at a byte of the study file.
    pub(super) fn add(&self, at: usize, message: impl AsRef<str>) {
        if self.is_full() {
            return;
        }
        let (line, column) = self.lines.position(at);
        self.push(at, self.file.to_owned(), line, column, message.as_ref());
    }

    /// Adds a problem about something that is missing, unless a part of the file was not understood, which may contain it.
    pub(super) fn add_if_complete(&self, at: usize, message: impl AsRef<str>) {
        if !self.incomplete.get() {
            self.add(at, message);
        }
    }

    /// Adds a problem in a CSV file that the study names at the byte `at`.
    pub(super) fn add_in(&self, at: usize, csv: &str, line: usize, column: usize, message: impl AsRef<str>) {
        if self.is_full() {
            return;
        }
        // Named as the study itself is: relative to where the user is.
        self.push(at, self.beside(csv), line, column, message.as_ref());
    }

    fn push(&self, at: usize, file: String, line: usize, column: usize, message: &str) {
        // One problem is one line, even if a quoted text of the file has several.
        let plain = message.chars().flat_map(|c| if c.is_control() { c.escape_default().collect::<Vec<_>>() } else { vec![c] });
        let mut message: String = plain.take(MOST_CHARACTERS + 1).collect();
        if let Some((end, _)) = message.char_indices().nth(MOST_CHARACTERS) {
            message.replace_range(end.., "...");
        }
        self.found.borrow_mut().push((at, Problem { file, line, column, message }));
    }

    /// Adds the problems of a file that the study names at the byte `at`.
    pub(super) fn adopt(&self, at: usize, of_file: Vec<Problem>) {
        for problem in of_file.into_iter().take_while(|_| !self.is_full()) {
            self.found.borrow_mut().push((at, problem));
        }
    }

    /// A file as messages call it that has this path from the folder of this one.
    pub(super) fn beside(&self, file: &str) -> String {
        Path::new(self.file).parent().unwrap_or(Path::new("")).join(file).display().to_string()
    }

    /// Are there as many as are reported? Then the rest need not be read.
    pub(super) fn is_full(&self) -> bool {
        let full = self.found.borrow().len() >= MOST_PROBLEMS;
        self.more.set(full || self.more.get());
        full
    }

    /// Notes that parts of the file were not understood.
    pub(super) fn mark_incomplete(&self) {
        self.incomplete.set(true);
    }

    /// Was a part of the file not understood?
    pub(super) fn is_incomplete(&self) -> bool {
        self.incomplete.get()
    }

    /// Does this text stand in the file at that byte?
    pub(super) fn has(&self, at: usize, text: &str) -> bool {
        self.lines.text.get(at..).is_some_and(|rest| rest.starts_with(text))
    }

    /// Line number of a byte, for messages that point elsewhere.
    pub(super) fn line_number(&self, at: usize) -> usize {
        // Called for every row: finding the column too would read the whole line.
        self.lines.index(self.lines.visible(at)) + 1
    }

    /// Number of problems so far.
    pub(super) fn count(&self) -> usize {
        self.found.borrow().len()
    }

    /// All problems in file order.
    pub(super) fn into_sorted(self) -> Vec<Problem> {
        let mut found = self.found.into_inner();
        found.sort_by_key(|&(at, _)| at);
        let mut problems: Vec<_> = found.into_iter().map(|(_, problem)| problem).collect();
        problems.dedup();
        if let Some(last) = problems.last().filter(|_| self.more.get()) {
            let message = format!("there may be more problems than these {}; correct them first", problems.len());
            problems.push(Problem { message, ..last.clone() });
        }
        problems
    }
}

/// A value, where it starts and where it ends.
#[derive(Clone, Copy)]
pub(super) struct TomlNode<'a> {
    pub(super) value: &'a DeValue<'a>,
    pub(super) at: usize,
    pub(super) end: usize,
}

impl<'a> TomlNode<'a> {
    /// The value in the syntax tree.
    pub(super) fn new(value: &'a Spanned<DeValue<'a>>) -> Self {
        Self { value: value.get_ref(), at: value.span().start, end: value.span().end }
    }

    /// As a table.
    pub(super) fn table(self) -> Option<TomlTable<'a>> {
        self.value.as_table().map(|table| TomlTable::new(table, self.at))
    }

    /// As a list.
    pub(super) fn list(self) -> Option<impl ExactSizeIterator<Item = TomlNode<'a>> + Clone> {
        self.value.as_array().map(|array| array.iter().map(TomlNode::new))
    }

    /// What it is, in words.
    pub(super) fn found(self) -> String {
        match self.value {
            DeValue::String(text) => format!("the text \"{}\"", shortened(text)),
            DeValue::Integer(number) => format!("the number {}", shortened(&number.to_string())),
            DeValue::Float(number) => format!("the number {}", shortened(&number.to_string())),
            DeValue::Boolean(value) => value.to_string(),
            DeValue::Datetime(_) => "a date or time".to_owned(),
            DeValue::Array(_) => "a list".to_owned(),
            DeValue::Table(_) => "a table".to_owned(),
        }
    }
}

/// A key with its value.
pub(super) struct Entry<'a> {
    pub(super) key: &'a str,
    pub(super) key_at: usize,
    pub(super) node: TomlNode<'a>,
}

/// A table in file order.
pub(super) struct TomlTable<'a> {
    pub(super) entries: Vec<Entry<'a>>,
    pub(super) at: usize,
}

impl<'a> TomlTable<'a> {
    /// The table that starts at the byte `at`.
    pub(super) fn new(table: &'a DeTable<'a>, at: usize) -> Self {
        let entry = |(key, value): (&'a Spanned<_>, &'a Spanned<DeValue<'a>>)| {
            let name: &std::borrow::Cow<'a, str> = key.get_ref();
            Entry { key: name.as_ref(), key_at: key.span().start, node: TomlNode::new(value) }
        };
        let mut entries: Vec<_> = table.iter().map(entry).collect();
        entries.sort_by_key(|entry| entry.key_at);
        Self { entries, at }
    }

    /// The entry of that key.
    pub(super) fn get(&self, key: &str) -> Option<&Entry<'a>> {
        self.entries.iter().find(|entry| entry.key == key)
    }

    /// Entries whose key is none of these.
    pub(super) fn unknown(&self, allowed: &[&str]) -> impl Iterator<Item = &Entry<'a>> {
        self.entries.iter().filter(|entry| !allowed.contains(&entry.key))
    }

    /// Reports keys that are none of these; says whether there was none.
    pub(super) fn check_keys(&self, problems: &Problems<'_>, label: &str, allowed: &[&str]) -> bool {
        for entry in self.unknown(allowed).take_while(|_| !problems.is_full()) {
            let is = if allowed.len() == 1 { "is" } else { "are" };
            let similar = || remedy(entry.key, allowed, || format!("allowed {is} {}", list(allowed)));
            let remedy = if is_top_level(entry.key) { TOP_LEVEL_REMEDY.to_owned() } else { similar() };
            problems.add(entry.key_at, format!("{label}: unknown key \"{}\"; {remedy}", shortened(entry.key)));
        }
        self.unknown(allowed).next().is_none()
    }
}

/// Does the key belong above all tables?
pub(super) fn is_top_level(key: &str) -> bool {
    ["model", "title"].contains(&key)
}

/// What to do about such a key if it stands in a table.
pub(super) const TOP_LEVEL_REMEDY: &str = "it belongs above the first table";

/// Names, separated by commas.
pub(super) fn list<S: AsRef<str>>(names: impl IntoIterator<Item = S>) -> String {
    names.into_iter().map(|name| name.as_ref().to_owned()).collect::<Vec<_>>().join(", ")
}

/// A text of the user, cut off where it would fill the screen.
pub(super) fn shortened(text: &str) -> String {
    const MOST: usize = 60;
    if text.chars().nth(MOST).is_none() { text.to_owned() } else { text.chars().take(MOST).chain("...".chars()).collect() }
}
