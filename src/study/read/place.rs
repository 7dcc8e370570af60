//! Where in the text of a study something is written.

use super::table::{Entry, TomlTable};
use std::ops::Range;

/// A part of the text that becomes another.
pub(super) struct Edit {
    pub(super) range: Range<usize>,
    pub(super) with: String,
    /// Number of the setting that it writes.
    pub(super) writes: Option<usize>,
}

/// A key with its value.
pub(super) fn span(entry: &Entry<'_>) -> Range<usize> {
    entry.key_at..entry.node.end
}

/// An entry that becomes a comment, or blank where others follow on its line.
pub(super) fn left_out(entry: &Entry<'_>, text: &str) -> Edit {
    let mut range = span(entry);
    // `design.ratio = ...`: the whole key.
    if text[..range.start].trim_end().ends_with('.') {
        range.start = text[..range.start].rfind(['\n', '{', ',']).map_or(0, |at| at + 1);
    }
    let line = text[..range.start].rfind('\n').map_or(0, |at| at + 1);
    if text[line..range.start].trim().is_empty() {
        return Edit { with: format!("# {}", text[range.clone()].replace('\n', "\n# ")), range, writes: None };
    }
    // Within braces, with one of the commas around it.
    let rest = &text[range.end..];
    if rest.trim_start().starts_with(',') {
        range.end += rest.len() - rest.trim_start().len() + 1;
    } else if text[..range.start].trim_end().ends_with(',') {
        range.start = text[..range.start].trim_end().len() - 1;
    }
    let blank = text[range.clone()].chars().map(|it| if it == '\n' { '\n' } else { ' ' }).collect();
    Edit { range, with: blank, writes: None }
}

/// Where a further entry of a table goes, and what goes before and after it: the first, and any other.
pub(super) fn place_in(name: &str, top: &TomlTable<'_>, text: &str) -> (usize, [String; 2], [String; 2]) {
    let both = |it: &str| [it.to_owned(), it.to_owned()];
    let next_line = |at: usize| text[at..].find('\n').map_or((text.len(), "\n"), |end| (at + end + 1, ""));
    let Some(table) = top.get(name) else {
        let start = if text.is_empty() || text.ends_with('\n') { "" } else { "\n" };
        return (text.len(), [format!("{start}\n[{name}]\n"), String::new()], both("\n"));
    };
    let header = text[..table.key_at].trim_end().ends_with('[');
    let entries = table.node.table().map_or(Vec::new(), |table| table.entries);
    match entries.last() {
        None if header => {
            let (at, start) = next_line(table.key_at);
            (at, [start.to_owned(), String::new()], both("\n"))
        }
        // Without a value `fixed = {}` is all there can be.
        None => (table.node.end.saturating_sub(1), [" ".to_owned(), ", ".to_owned()], both("")),
        Some(last) if header || text[..last.key_at].trim_end().ends_with('.') => {
            let (at, start) = next_line(last.node.end);
            let key = if header { String::new() } else { format!("{name}.") };
            (at, [format!("{start}{key}"), key], both("\n"))
        }
        Some(last) => (last.node.end, both(", "), both("")),
    }
}
