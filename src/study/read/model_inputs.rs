//! `[inputs]` of the file of a model.

use super::model_file::ModelReader;
use super::table::{Entry, TomlNode, TomlTable, shortened};
use super::value::{input_value, measured, truth};
use super::{section, text};
use crate::formula::{Units, is_reserved};
use crate::models::{Input, Model, OnlyFor, Range, is_name, unit_of_name};
use crate::units::Unit;
use std::collections::HashSet;

impl ModelReader<'_> {
    /// The inputs of the file, in its order.
    pub(super) fn inputs(&self, units: &[String], base: &Model) -> Vec<Input> {
        let problems = self.problems;
        let Some(table) = section(&self.top, "inputs", problems) else { return Vec::new() };
        // What is wrong with units of its own is reported with the formulas.
        let units = Units::new(units).unwrap_or_default();
        let mut inputs: Vec<Input> = Vec::new();
        for entry in table.entries.iter().take_while(|_| !problems.is_full()) {
            if let Some(input) = self.input(entry, &units, base) {
                inputs.push(input);
            }
        }
        self.check_references(&table, base, &inputs);
        inputs
    }

    fn input(&self, entry: &Entry<'_>, units: &Units, base: &Model) -> Option<Input> {
        let (problems, name) = (self.problems, entry.key);
        let label = format!("input \"{}\"", shortened(name));
        if !is_name(name) || is_reserved(name) || name.len() > 80 {
            problems.add(
                entry.key_at,
                format!("{label}: this is no name; use up to 80 letters, digits and \"_\", a letter first, and no function's"),
            );
            return None;
        }
        if base.input(name).is_some() || base.output(name).is_some() {
            problems.add(entry.key_at, format!("{label}: {} has {name} already; choose another name", base.name));
        }
        let unit = unit_of_name(units, name).map_err(|error| problems.add(entry.key_at, format!("{label}: {error}"))).ok()?;
        let Some(parts) = entry.node.table() else {
            let found = entry.node.found();
            problems.add(entry.node.at, format!("{label}: found {found}, wanted {{ default = 1, valid = [0, 2], doc = \"...\" }}"));
            return None;
        };
        parts.check_keys(problems, &label, super::keys::INPUT);
        let words = self.word_list(&parts, "words", &label)?;
        let says_nothing = Range { low: f64::NEG_INFINITY, high: f64::INFINITY, includes_low: false, includes_high: false };
        let valid = match parts.get("valid") {
            Some(entry) => self.range(entry.node, unit, &label)?,
            None if words.is_empty() => says_nothing,
            None => Range::NONE,
        };
        let said = |key: &str| parts.get(key).and_then(|it| text(it.node, problems, &label)).unwrap_or_default();
        let integer = parts.get("integer").and_then(|it| truth(it, problems, &label)).unwrap_or(false);
        let usual = match parts.get("usual") {
            Some(entry) => self.ends(entry.node, unit, &format!("{label}: usual"))?,
            None => (f64::MIN, f64::MAX),
        };
        let mut input = Input::new(name, said("symbol"), unit, 0.0, usual, said("doc"), said("source")).valid(valid);
        input.integer = integer;
        input.words = match coded(words, &valid, unit) {
            Some(words) => words,
            None => {
                problems.add(parts.at, format!("{label}: numbers without an end leave no room for words; give valid = [..., ...]"));
                return None;
            }
        };
        input.only_for = self.only_for(&parts, &label)?;
        input.follows = parts.get("follows").and_then(|it| text(it.node, problems, &label));
        input.instead_of = parts.get("instead_of").and_then(|it| text(it.node, problems, &label));
        let Some(default) = parts.get("default") else {
            problems.add_if_complete(parts.at, format!("{label}: \"default\" is missing; it must be {}", input.valid_in_words()));
            return None;
        };
        let value = input_value(default.node, &input).map_err(|error| problems.add(default.node.at, format!("{label}: {error}")));
        input.default = value.ok()?;
        if input.instead_of.is_some() && input.word_for(input.default).is_none() {
            problems.add(
                default.node.at,
                format!("{label}: with instead_of the default must be a word, which says that the other input holds"),
            );
        }
        Some(input)
    }

    /// `only_for` names an input and words of it, `follows` and `instead_of` another input.
    fn check_references(&self, table: &TomlTable<'_>, base: &Model, inputs: &[Input]) {
        let problems = self.problems;
        let find = |name: &str| base.inputs.iter().chain(inputs).find(|it| it.name == name);
        for (input, entry) in inputs.iter().filter_map(|input| Some((input, table.get(&input.name)?))) {
            let label = format!("input \"{}\"", input.name);
            if let Some(OnlyFor { input: name, words }) = &input.only_for {
                let of = find(name);
                if of.is_none() {
                    problems.add(entry.node.at, format!("{label}: only_for names \"{}\", which is no input", shortened(name)));
                }
                for (of, word) in of.into_iter().flat_map(|of| words.iter().map(move |word| (of, word))) {
                    if of.value_of(word).is_none() {
                        let known = of.words_listed().map_or("no words".to_owned(), |words| format!("the words {words}"));
                        let word = shortened(word);
                        problems.add(entry.node.at, format!("{label}: only_for names \"{word}\" of {name}, which takes {known}"));
                    }
                }
            }
            if let Some(other) = input.follows.as_ref().filter(|other| find(other).is_none()) {
                problems.add(entry.node.at, format!("{label}: follows names \"{}\", which is no input", shortened(other)));
            }
            if let Some(other) = input.instead_of.as_ref().filter(|other| find(other).is_none()) {
                problems.add(entry.node.at, format!("{label}: instead_of names \"{}\", which is no input", shortened(other)));
            }
        }
    }

    /// `{ surface = ["rough"] }`: the words of an input for which another is read; `None` if it is something else.
    fn only_for(&self, parts: &TomlTable<'_>, label: &str) -> Option<Option<OnlyFor>> {
        let Some(entry) = parts.get("only_for") else { return Some(None) };
        let table = entry.node.table();
        let [of] = table.as_ref().map_or(&[][..], |table| &table.entries) else {
            let found = entry.node.found();
            let form = "only_for must be one input with words of it, such as { surface = [\"rough\"] }";
            self.problems.add(entry.node.at, format!("{label}: found {found}; {form}"));
            return None;
        };
        let words = self.word_list(table.as_ref()?, of.key, label)?;
        Some(Some(OnlyFor { input: of.key.to_owned(), words }))
    }

    /// A list of words, each once; `None` if it is no list.
    fn word_list(&self, parts: &TomlTable<'_>, key: &str, label: &str) -> Option<Vec<String>> {
        let problems = self.problems;
        let Some(entry) = parts.get(key) else { return Some(Vec::new()) };
        let Some(nodes) = entry.node.list() else {
            problems.add(
                entry.node.at,
                format!("{label}: found {}; {key} must be a list of words such as [\"smooth\", \"rough\"]", entry.node.found()),
            );
            return None;
        };
        let mut seen = HashSet::new();
        let mut words = Vec::new();
        for node in nodes {
            let Some(word) = text(node, problems, label) else { continue };
            if word.is_empty() || word.trim() != word || word.contains(['\'', '"', ',']) {
                problems.add(
                    node.at,
                    format!("{label}: \"{}\" is no word; write it without quotes, commas and spaces at its ends", shortened(&word)),
                );
            } else if !seen.insert(word.clone()) {
                problems.add(node.at, format!("{label}: the word \"{}\" stands twice; drop one of the two", shortened(&word)));
            } else {
                words.push(word);
            }
        }
        Some(words)
    }

    /// `[low, high]`, both included, or `{ above = low, max = high }` and the like.
    fn range(&self, node: TomlNode<'_>, unit: Unit, label: &str) -> Option<Range> {
        let problems = self.problems;
        let label = format!("{label}: valid");
        let range = if let Some(parts) = node.table() {
            parts.check_keys(problems, &label, super::keys::VALID);
            let end = |inclusive: &str, exclusive: &str, none: f64| -> Option<(f64, bool)> {
                let (inclusive, exclusive) = (parts.get(inclusive), parts.get(exclusive));
                if let (Some(one), Some(other)) = (inclusive, exclusive) {
                    problems.add(other.key_at, format!("{label}: {} and {} exclude each other; keep one", one.key, other.key));
                    return None;
                }
                let Some(entry) = inclusive.or(exclusive) else { return Some((none, false)) };
                let value = measured(entry.node, unit).map_err(|error| problems.add(entry.node.at, format!("{label}: {error}"))).ok()?;
                Some((value, inclusive.is_some()))
            };
            let (low, high) = (end("min", "above", f64::NEG_INFINITY), end("max", "below", f64::INFINITY));
            let ((low, includes_low), (high, includes_high)) = (low?, high?);
            Range { low, high, includes_low, includes_high }
        } else {
            let (low, high) = self.ends(node, unit, &label)?;
            Range { low, high, includes_low: true, includes_high: true }
        };
        if range.is_empty() {
            problems.add(node.at, format!("{label}: no number is {}; give a lower end below the upper one", range.in_words()));
            return None;
        }
        Some(range)
    }

    /// Two numbers.
    fn ends(&self, node: TomlNode<'_>, unit: Unit, label: &str) -> Option<(f64, f64)> {
        let problems = self.problems;
        let nodes: Vec<TomlNode<'_>> = node.list().map_or_else(Vec::new, Iterator::collect);
        let [low, high] = nodes[..] else {
            problems.add(node.at, format!("{label}: found {}, wanted two numbers [low, high] or {{ above = 0, max = 2 }}", node.found()));
            return None;
        };
        let value = |node: TomlNode<'_>| measured(node, unit).map_err(|error| problems.add(node.at, format!("{label}: {error}"))).ok();
        let (low, high) = (value(low), value(high));
        Some((low?, high?))
    }
}

/// Words with the numbers that encode them, which no valid value is, in the input's unit or in SI units; `None` if there are none such.
fn coded(words: Vec<String>, valid: &Range, unit: Unit) -> Option<Vec<(String, f64)>> {
    let [low, high] = [valid.low, valid.high].map(|end| (end, unit.to_si(end)));
    let least = low.0.min(low.1).min(0.0).floor();
    let largest = high.0.max(high.1).max(0.0).ceil();
    let code = |number: usize| {
        let step = 1.0 + number as f64;
        if valid.is_empty() || words.is_empty() {
            Some(step)
        } else if least.is_finite() {
            Some(least - step)
        } else {
            largest.is_finite().then_some(largest + step)
        }
    };
    let codes: Option<Vec<f64>> = (0..words.len()).map(code).collect();
    Some(words.into_iter().zip(codes?).collect())
}
