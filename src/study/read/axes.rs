//! Axes of one input, fixed inputs, and who sets which input.

use super::super::axis::{Axis, Levels};
use super::Reader;
use super::law::{has_levels, is_law};
use super::roles::{AxisClaim, AxisRole, PRESET};
use super::table::{Entry, TOP_LEVEL_REMEDY, TomlNode, TomlTable, is_top_level, shortened};
use super::value::{input_value, shown};
use super::weights::weighted_cases;
use crate::likeness::remedy;
use std::collections::HashSet;
use toml::de::DeValue;

impl Reader<'_> {
    /// The axes of a table, in file order. Those with problems are left out.
    pub(super) fn axes(&self, role: AxisRole, table: &TomlTable<'_>) -> Vec<Axis> {
        let most = self.model.inputs.len();
        if let Some(extra) = table.entries.get(most) {
            let message = format!("[{}] has {} axes, but {} has {most} inputs", role.name(), table.entries.len(), self.model.name);
            self.problems.add(extra.key_at, format!("{message}; every input has one axis at most, drop the others"));
        }
        let mut axes = Vec::new();
        for entry in table.entries.iter().take(most).take_while(|_| !self.problems.is_full()) {
            if role == AxisRole::Uncertainty && has_levels(entry) {
                axes.extend(self.levels_of_tolerance(entry));
                continue;
            }
            if role == AxisRole::Uncertainty && is_law(entry) {
                self.has_laws.set(true);
                self.uncertain(entry);
                continue;
            }
            let is_input = self.model.input(entry.key).is_some();
            let weighted = weighted_cases(entry).filter(|_| !is_input);
            let axis = match entry.key {
                _ if weighted.is_some() => weighted.and_then(|table| self.weighted(role, axes.len(), entry, &table)),
                key if key.starts_with("cases") && !is_input => self.joint(role, entry, axes.len()),
                PRESET if !is_input => self.preset_axis(role, entry, axes.len()),
                _ => self.single(role, entry),
            };
            axes.extend(axis);
        }
        axes
    }

    /// The value of every input: fixed, of the preset, or default.
    pub(super) fn fixed(&self, table: Option<&TomlTable<'_>>) -> Vec<f64> {
        let mut values = self.base.clone();
        for entry in table.iter().flat_map(|table| &table.entries).take_while(|_| !self.problems.is_full()) {
            let label = format!("fixed input \"{}\"", shortened(entry.key));
            let Some(number) = self.input(entry.key, entry.key_at, &label) else { continue };
            let input = &self.model.inputs[number];
            let value = match entry.node.value {
                DeValue::Array(_) | DeValue::Table(_) => Err(format!(
                    "found {}, but a fixed input has one value; several belong into [design], [operation] or [uncertainty]",
                    entry.node.found()
                )),
                _ => input_value(entry.node, input),
            };
            let value = value.map_err(|error| self.problems.add(entry.node.at, format!("{label}: {error}"))).ok();
            let word = value.and_then(|value| input.word_for(value)).map(str::to_owned);
            self.claims.borrow_mut().push(AxisClaim { input: number, role: AxisRole::Fixed, at: entry.key_at, single: false, word });
            values[number] = value.unwrap_or(values[number]);
        }
        values
    }

    /// Number of the input of that name, with a report if there is none.
    pub(super) fn input(&self, name: &str, at: usize, label: &str) -> Option<usize> {
        let found = self.model.input(name);
        if found.is_none() {
            self.problems.add(at, format!("{label}: {}", self.no_input(name)));
            self.misnamed.set(true);
        }
        found
    }

    /// Why there is no input of that name.
    pub(super) fn no_input(&self, name: &str) -> String {
        if self.model.output(name).is_some() {
            return format!(
                "{name} is an output; outputs can be constrained, made an objective or reported, only inputs can be given values"
            );
        }
        let names: Vec<_> = self.model.inputs.iter().map(|input| input.name.as_str()).collect();
        let similar = || remedy(name, &names, || format!("its inputs are {}", names.join(", ")));
        let remedy = if is_top_level(name) { TOP_LEVEL_REMEDY.to_owned() } else { similar() };
        format!("{} has no input \"{}\"; {remedy}", self.model.name, shortened(name))
    }

    /// An axis of one input.
    fn single(&self, role: AxisRole, entry: &Entry<'_>) -> Option<Axis> {
        let label = format!("axis \"{}\"", shortened(entry.key));
        let number = self.input(entry.key, entry.key_at, &label)?;
        let input = &self.model.inputs[number];
        let levels = match entry.node.value {
            DeValue::Array(_) => self.list(entry.node, number, &label),
            DeValue::Table(_) if input.is_enumeration() => {
                let words: Vec<_> = input.words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
                let message = format!("{label}: found a range, but {} takes words only; list them: [{}]", input.name, words.join(", "));
                self.problems.add(entry.node.at, message);
                None
            }
            DeValue::Table(_) => entry.node.table().and_then(|table| self.range(&table, input, &label, role)),
            DeValue::Boolean(_) | DeValue::Datetime(_) if !input.is_enumeration() => {
                let found = entry.node.found();
                let message = format!(
                    "{label}: found {found}, wanted a value, a list of values, or a range such as {{ from = 1, to = 2, count = 11 }}"
                );
                self.problems.add(entry.node.at, message);
                None
            }
            _ => self.input_value(entry.node, number, &label).map(|value| Levels::List(vec![value])),
        };
        let word = match &levels {
            Some(Levels::List(values)) => values.iter().find_map(|&value| input.word_for(value)).map(str::to_owned),
            _ => None,
        };
        self.claims.borrow_mut().push(AxisClaim { input: number, role, at: entry.key_at, single: true, word });
        Some(Axis::Single { input: number, levels: levels? })
    }

    /// A value of an input, with a report if it is none.
    pub(super) fn input_value(&self, node: TomlNode<'_>, number: usize, label: &str) -> Option<f64> {
        let value = input_value(node, &self.model.inputs[number]);
        value.map_err(|error| self.problems.add(node.at, format!("{label}: {error}"))).ok()
    }

    /// Levels as listed.
    pub(super) fn list(&self, node: TomlNode<'_>, number: usize, label: &str) -> Option<Levels> {
        let nodes = node.list()?;
        if nodes.len() == 0 {
            self.problems.add(node.at, format!("{label}: the list is empty; give at least one value"));
        }
        let (mut values, mut known) = (Vec::new(), HashSet::new());
        for element in nodes.clone().take_while(|_| !self.problems.is_full()) {
            let Some(value) = self.input_value(element, number, label) else { continue };
            if !known.insert(value.to_bits()) {
                let input = &self.model.inputs[number];
                let value = input.word_for(value).map_or_else(|| shown(value), |word| format!("\"{word}\""));
                self.problems.add(element.at, format!("{label}: {value} is listed twice; drop one"));
            }
            values.push(value);
        }
        (values.len() == nodes.len() && !values.is_empty()).then_some(Levels::List(values))
    }

    /// Reports inputs that are given values in more than one place, at every place but the first.
    pub(super) fn check_claims(&self) {
        let mut claims = self.claims.borrow_mut();
        claims.sort_by_key(|claim| claim.at);
        for (index, claim) in claims.iter().enumerate().take_while(|_| !self.problems.is_full()) {
            if let Some(first) = claims[..index].iter().find(|first| first.input == claim.input) {
                let name = &self.model.inputs[claim.input].name;
                let line = self.problems.line_number(first.at);
                let message = format!("\"{name}\" is already set in [{}], line {line}; keep one of the two", first.role.name());
                self.problems.add(claim.at, message);
            }
        }
    }

    /// Reports an input that is given although a number of another one takes its place.
    pub(super) fn check_replaced(&self, axes: [&Vec<Axis>; 3], fixed: &[f64], top: &TomlTable<'_>) {
        let claims = self.claims.borrow();
        let claim = |name: &str| {
            let number = self.model.input(name)?;
            claims.iter().find(|claim| claim.input == number)
        };
        let is_number = |input: usize, value: f64| self.model.inputs[input].word_for(value).is_none();
        let gives_numbers = |name: &str| {
            claim(name).is_some_and(|claim| match claim.role {
                AxisRole::Fixed => is_number(claim.input, fixed[claim.input]),
                _ => axes.iter().flat_map(|axes| axes.iter()).any(|axis| {
                    let column = axis.inputs().iter().position(|&it| it == claim.input);
                    column.is_some_and(|column| axis.has_number(column, |value| is_number(claim.input, value)))
                }),
            })
        };
        let Some((input, other)) = self.model.contradiction(gives_numbers, |name| claim(name).is_some()) else { return };
        let by_formula = |name: &str| top.get("formulas")?.node.table()?.get(name).map(|entry| entry.key_at);
        let place = |name: &str| claim(name).map(|claim| claim.at).or_else(|| by_formula(name));
        let beside = match place(&input) {
            Some(at) if by_formula(&input) == Some(at) => {
                format!("{input}, which the formula in line {} gives and", self.problems.line_number(at))
            }
            Some(at) => format!("{input}, line {},", self.problems.line_number(at)),
            None => format!("{input}, which the model gives and"),
        };
        let at = place(&other).or_else(|| place(&input)).unwrap_or(0);
        self.problems.add(at, format!("\"{other}\" cannot be given beside {beside} which takes its place; drop one of the two"));
    }
}
