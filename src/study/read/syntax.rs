//! TOML syntax: explains in plain words what is wrong, and continues with the rest of the file.
//!
//! The parser recovers from an error as well as it can, but after an unclosed bracket it sees errors everywhere. So only the first error
//! is reported, its statement is replaced by blanks, and the text is parsed again. An error that the original text did not have is caused
//! by the blanks and ends the search.

use super::table::{Lines, Problems, TomlNode, TomlTable, shortened};
use std::borrow::Cow;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// Most syntax errors that are reported.
const MOST_ERRORS: usize = 25;
/// Of a text with more bytes only the first error is reported: a large file that is no TOML, such as a table of values, may have an error
/// for every byte, and each takes memory and time.
const LARGE: usize = 1 << 16;

/// Reports the syntax errors of a text. Returns the text with the wrong statements replaced by blanks, so that every other byte keeps its
/// place, or `None` if the rest cannot be parsed either.
pub(super) fn understandable<'t>(text: &'t str, problems: &Problems<'_>) -> Option<Cow<'t, str>> {
    if text.len() > LARGE {
        return match DeTable::parse(text) {
            Ok(_) => Some(Cow::Borrowed(text)),
            Err(error) => {
                problems.mark_incomplete();
                problems.add(start(&error), explained(&error, text));
                None
            }
        };
    }
    let (_, errors) = DeTable::parse_recoverable(text);
    if errors.is_empty() {
        return Some(Cow::Borrowed(text));
    }
    problems.mark_incomplete();
    let seen: Vec<usize> = errors.iter().map(start).collect();
    let mut rest = text.to_owned();
    for _ in 0..MOST_ERRORS {
        let (tree, errors) = DeTable::parse_recoverable(&rest);
        let Some(error) = errors.iter().min_by_key(|error| start(error)) else {
            return Some(Cow::Owned(rest));
        };
        if !seen.contains(&start(error)) {
            return None;
        }
        let lines = Lines::new(&rest);
        let at = blamed(error, &rest, &lines);
        let moved = at < start(error).min(rest.len());
        problems.add(at, if moved { UNCLOSED.to_owned() } else { explained(error, &rest) });
        let broken = statement(&TomlTable::new(tree.get_ref(), 0), &rest, &lines, at, start(error));
        rest = blanked(&rest, broken);
    }
    None
}

/// The message for a bracket that is not closed.
const UNCLOSED: &str = "a comma or a closing bracket is missing; write [1, 2] or { from = 1, to = 2 }";

/// Where the error starts; the end of the text if the parser does not say.
fn start(error: &toml::de::Error) -> usize {
    error.span().map_or(usize::MAX, |span| span.start)
}

/// The place of the mistake. If a line cannot continue something that the line before left open, that is the end of the line before.
fn blamed(error: &toml::de::Error, text: &str, lines: &Lines<'_>) -> usize {
    let at = start(error).min(text.len());
    let line = lines.range(lines.index(at));
    let first_in_line = text.as_bytes()[line.start.min(at)..at].trim_ascii().is_empty();
    let suspicious = first_in_line && error.message().starts_with("missing comma")
        || error.message().starts_with("unexpected `=`")
        || is_header(&text[line.clone()]);
    let says_something = |index: &usize| !matches!(lines.line(*index).trim_start().as_bytes().first(), None | Some(b'#'));
    let before =
        (0..lines.index(at)).rev().find(says_something).map_or(0, |index| lines.range(index).start + lines.line(index).trim_end().len());
    if suspicious && before > 0 && unclosed(text, lines, before) { before } else { at }
}

/// Does the text up to here leave a bracket open? The parser says so if it gets only this text.
fn unclosed(text: &str, lines: &Lines<'_>, end: usize) -> bool {
    let header = (0..=lines.index(end)).rev().map(|index| lines.range(index).start).find(|&start| is_header(&text[start..]));
    let (_, errors) = DeTable::parse_recoverable(&text[header.unwrap_or(0)..end]);
    errors.iter().any(|error| error.message().starts_with("unclosed"))
}

/// Does the line start a table?
fn is_header(line: &str) -> bool {
    let name = line.trim_start().trim_start_matches('[');
    line.trim_start().starts_with('[') && name.starts_with(|c: char| c.is_ascii_alphabetic()) && !line.trim_start().starts_with("[ ")
}

/// The lines of the statement with the error: from its key to the place of the mistake; if the header of a table is wrong, the whole table,
/// since nobody knows where its keys belong.
fn statement(top: &TomlTable<'_>, text: &str, lines: &Lines<'_>, blame: usize, error: usize) -> Range<usize> {
    let last = lines.index(blame.min(text.len()));
    let first = key_at(top, text, blame, error).map_or(last, |key| lines.index(key).min(last));
    let line = lines.line(first);
    let headless = is_header(line) || !(line.contains('=') || first < last);
    let last = if headless {
        (last + 1..lines.count()).find(|&index| is_header(lines.line(index))).map_or(lines.count(), |next| next) - 1
    } else {
        last
    };
    lines.range(first).start..lines.range(last.max(first)).end
}

/// Where the key starts whose value contains the place of the mistake.
fn key_at(table: &TomlTable<'_>, text: &str, blame: usize, error: usize) -> Option<usize> {
    let below = |node: TomlNode<'_>| match node.value {
        DeValue::Table(_) => node.table().and_then(|table| key_at(&table, text, blame, error)),
        _ => None,
    };
    // A table with a header is not a statement, but contains some.
    let has_header = |at: usize| is_header(text.get(at..).unwrap_or(""));
    table.entries.iter().rev().find_map(|entry| match entry.node.value {
        DeValue::Table(_) if has_header(entry.node.at) || entry.node.at == entry.key_at => below(entry.node),
        DeValue::Array(_) if has_header(entry.node.at) => entry.node.list().into_iter().flatten().filter_map(below).last(),
        _ => (entry.key_at <= blame && blame <= entry.node.at.max(error)).then_some(entry.key_at),
    })
}

/// The text with spaces in place of a range, so that the rest keeps its place.
fn blanked(text: &str, range: Range<usize>) -> String {
    let spaces = text[range.clone()].bytes().map(|byte| if byte == b'\n' { '\n' } else { ' ' });
    text[..range.start].chars().chain(spaces).chain(text[range.end..].chars()).collect()
}

/// The parser's message in words for people who do not know the grammar.
fn explained(error: &toml::de::Error, text: &str) -> String {
    let message = error.message();
    let at = error.span().and_then(|span| text.get(span)).unwrap_or("").trim();
    let at = shortened(at);
    let is = |start: &str| message.starts_with(start);
    if is("duplicate key") {
        format!("\"{at}\" is given twice; keep one of the two")
    } else if is("string values must be quoted") || is("invalid boolean") {
        let behind = error.span().and_then(|span| text.get(span.end..)).unwrap_or("").trim_start();
        unquoted(&at, behind.starts_with('='))
    } else if is("key with no value") {
        "this is neither a table nor a value; write [table] or name = value".to_owned()
    } else if is("missing comma") {
        UNCLOSED.to_owned()
    } else if is("extra comma") {
        "there is nothing between two commas; drop one".to_owned()
    } else if is("extra assignment") {
        "a comma is missing in front of this \"=\"; write { from = 1, to = 2 }".to_owned()
    } else if is("unclosed inline table") {
        "a table is not closed; add \"}\"".to_owned()
    } else if is("unclosed array") {
        "a list is not closed; add \"]\"".to_owned()
    } else if is("unclosed table") {
        "a table's name is not closed; add \"]\"".to_owned()
    } else if is("invalid basic string") || is("invalid literal string") || is("invalid multi-line") {
        "a text is not closed; add the quote it starts with".to_owned()
    } else if is("unexpected leading zero") {
        "a number does not start with 0; drop it".to_owned()
    } else if is("invalid fraction") || is("invalid mantissa") {
        "a number needs digits on both sides of its point; write 0.5 or 5.0".to_owned()
    } else if is("invalid unquoted key") || is("unquoted keys") {
        "a name has letters, digits, \"_\" and \"-\" only and is followed by \"=\"; write name = value".to_owned()
    } else if is("missing escaped value") || is("invalid escape") {
        "a backslash in a text starts a code; write two of them, or put the text in single quotes".to_owned()
    } else if is("unexpected key or value") {
        "there is more text after the value; start a new line, and write decimals with a point".to_owned()
    } else {
        format!("this is not TOML: {}", shortened(message))
    }
}

/// The message for something that is no value: a number with a unit or a word needs quotes, two numbers need a comma.
fn unquoted(text: &str, key_follows: bool) -> String {
    let second = text.split_whitespace().nth(1).unwrap_or("");
    if text.is_empty() {
        "there is no value after \"=\"; write one".to_owned()
    } else if key_follows || second.starts_with(|c: char| c.is_ascii_digit()) {
        "a comma is missing between two values; write [1, 2] or { from = 1, to = 2 }".to_owned()
    } else {
        format!("a text must be in quotes; write \"{}\"", text.trim_matches(['"', '\'']))
    }
}
