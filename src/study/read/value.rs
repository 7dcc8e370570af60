//! Numbers, values with units and words.

use super::table::{Entry, Problems, TomlNode, shortened};
use crate::models::Input;
use crate::units::{Unit, parse_value};
use toml::de::DeValue;

/// A number in a message: as short as it can be, and never hundreds of digits.
pub(in super::super) fn shown(value: f64) -> String {
    if value == 0.0 || (1e-5..1e16).contains(&value.abs()) { value.to_string() } else { format!("{value:e}") }
}

/// A number with its unit in a message.
pub(super) fn shown_in(value: f64, unit: Unit) -> String {
    if unit.symbol.is_empty() { shown(value) } else { format!("{} {}", shown(value), unit.symbol) }
}

/// The number, if the value is one: `None` if it is something else, an error if it is not finite.
pub(super) fn number(node: TomlNode<'_>) -> Option<Result<f64, String>> {
    let value = match node.value {
        DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().unwrap_or(f64::NAN),
        #[allow(clippy::cast_precision_loss, reason = "an integer that is no f64 is rounded, as it would be in a float")]
        DeValue::Integer(integer) => i128::from_str_radix(integer.as_str(), integer.radix()).map_or(f64::NAN, |value| value as f64),
        DeValue::Float(float) => float.as_str().parse().unwrap_or(f64::NAN),
        _ => return None,
    };
    // Adding zero turns -0 into 0: the two must not be different levels or rows.
    Some(if value.is_finite() { Ok(value + 0.0) } else { Err(format!("{} cannot be used; give a finite number", written(node))) })
}

/// A number as it is written.
fn written(node: TomlNode<'_>) -> String {
    match node.value {
        DeValue::Integer(integer) => shortened(&integer.to_string()),
        DeValue::Float(float) => shortened(float.as_str()),
        _ => node.found(),
    }
}

/// A value in `unit`: a number, or a text with a unit. The error follows the name of the thing in a message.
pub(super) fn measured(node: TomlNode<'_>, unit: Unit) -> Result<f64, String> {
    match node.value {
        DeValue::String(text) => text_measured(text, unit),
        _ => number(node).unwrap_or_else(|| Err(format!("found {}, wanted {}", node.found(), wanted(unit)))),
    }
}

/// What a value in this unit looks like.
fn wanted(unit: Unit) -> String {
    if unit.symbol.is_empty() { "a number".to_owned() } else { format!("a number or a text with a unit such as \"12 {}\"", unit.symbol) }
}

/// A text with a unit.
fn text_measured(text: &str, unit: Unit) -> Result<f64, String> {
    let value = parse_value(&shortened(text), unit).map_err(|error| error.to_string())?;
    if value.is_finite() { Ok(value + 0.0) } else { Err(format!("\"{}\" is too large; give a finite number", shortened(text))) }
}

/// A value that an input can take, its words included.
pub(super) fn input_value(node: TomlNode<'_>, input: &Input) -> Result<f64, String> {
    match node.value {
        DeValue::String(text) => input_text(text, input),
        _ if input.is_enumeration() => Err(no_word(&node.found(), input)),
        _ => measured(node, input.unit).map_err(|error| or_word(error, input)).and_then(|value| checked(value, input)),
    }
}

/// A value that an input can take, given as text: a number, a number with a unit, or one of the input's words.
pub(crate) fn input_text(text: &str, input: &Input) -> Result<f64, String> {
    match input.value_of(text.trim()) {
        Some(encoded) => Ok(encoded),
        None if input.is_enumeration() => Err(no_word(&format!("\"{}\"", shortened(text)), input)),
        None => text_measured(text, input.unit).map_err(|error| or_word(error, input)).and_then(|value| checked(value, input)),
    }
}

/// A value that an input can take, its words not included.
pub(super) fn input_number(node: TomlNode<'_>, input: &Input) -> Result<f64, String> {
    let DeValue::String(text) = node.value else { return measured(node, input.unit).and_then(|value| checked(value, input)) };
    let word = text.trim();
    match input.value_of(word) {
        Some(_) => Err(format!("\"{word}\" is a word and no end of a range; use numbers, or list it: [\"{word}\", ...]")),
        None => text_measured(text, input.unit).and_then(|value| checked(value, input)),
    }
}

/// The message for a value of an input that takes words only, if it is none of them.
fn no_word(found: &str, input: &Input) -> String {
    format!("found {found}, but {} takes words only; write {}", input.name, input.words_listed().unwrap_or_default())
}

/// The message, with the words that would also be right.
fn or_word(error: String, input: &Input) -> String {
    match input.words_listed() {
        Some(words) => format!("{error}; or write {words}"),
        None => error,
    }
}

/// Is this a value that the input can take?
pub(crate) fn checked(value: f64, input: &Input) -> Result<f64, String> {
    if !input.valid.contains(value) {
        let mut unit = String::new();
        if !input.unit.symbol.is_empty() {
            unit = format!(" ({})", input.unit.symbol);
        }
        let words = input.words_listed().map_or(String::new(), |words| format!(", or {words}"));
        return Err(format!("{} is out of range; it must be {}{unit}{words}", shown(value), input.valid.in_words()));
    }
    if input.integer && value.fract() != 0.0 {
        let near: Vec<_> = [value.floor(), value.ceil()].into_iter().filter(|&near| input.valid.contains(near)).map(shown).collect();
        return Err(format!("{} is not a whole number; use {}", shown(value), near.join(" or ")));
    }
    Ok(value)
}

/// True or false, with a report if it is something else.
pub(super) fn truth(entry: &Entry<'_>, problems: &Problems<'_>, label: &str) -> Option<bool> {
    let value = if let DeValue::Boolean(value) = entry.node.value { Some(*value) } else { None };
    if value.is_none() {
        problems.add(entry.node.at, format!("{label}: found {}; {} must be true or false", entry.node.found(), entry.key));
    }
    value
}

/// A whole number between two ends, with a report if it is something else.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked to be whole, not negative and exact")]
pub(super) fn whole(entry: &Entry<'_>, problems: &Problems<'_>, label: &str, low: u64, high: u64) -> Option<u64> {
    let exact = match entry.node.value {
        DeValue::Integer(integer) => i128::from_str_radix(integer.as_str(), integer.radix()).ok(),
        DeValue::Float(float) => {
            float.as_str().parse::<f64>().ok().filter(|value| value.fract() == 0.0 && value.abs() < 1e15).map(|value| value as i128)
        }
        _ => None,
    };
    let value = exact.and_then(|value| u64::try_from(value).ok()).filter(|value| (low..=high).contains(value));
    if value.is_none() {
        let found =
            if exact.is_some() { format!("{} is out of range", written(entry.node)) } else { format!("found {}", entry.node.found()) };
        problems.add(entry.node.at, format!("{label}: {found}; {} must be a whole number from {low} to {high}", entry.key));
    }
    value
}
