//! Axes whose cases have weights, and `over_scenarios`.

use super::super::axis::Axis;
use super::super::quantity::Quantity;
use super::super::spectrum::{OverScenarios, Spectrum, unit_over};
use super::cases::CasesPlace;
use super::roles::AxisRole;
use super::table::{Entry, TomlTable, shortened};
use super::value::{number, shown, shown_in};
use super::weights::WeightColumn;
use super::{Reader, choice, text};
use crate::formula::Units;
use std::cell::RefCell;

/// How weights are given, for messages.
const EXAMPLE: &str = "duty = { cases = { csv = \"duty.csv\" }, weight = \"share\" }";
/// The statistics as they are written.
const OVER: &[(&str, OverScenarios)] = &[("worst", OverScenarios::Worst), ("mean", OverScenarios::Mean), ("sum", OverScenarios::Sum)];

impl Reader<'_> {
    /// A joint axis with weights: number `position` of its table.
    pub(super) fn weighted(&self, role: AxisRole, position: usize, entry: &Entry<'_>, table: &TomlTable<'_>) -> Option<Axis> {
        let problems = self.problems;
        let label = format!("axis \"{}\"", shortened(entry.key));
        let first = self.weighted_at.replace(Some(entry.key_at));
        if role != AxisRole::Operation {
            let message = format!("{label}: cases have weights in [operation] only; move the axis there, or write it as cases = [...]");
            problems.add(entry.key_at, message);
            return None;
        }
        if let Some(first) = first {
            let line = problems.line_number(first);
            problems.add(entry.key_at, format!("{label}: the axis in line {line} has weights already; only one axis of a study may"));
            return None;
        }
        let known = table.check_keys(problems, &label, super::keys::SPECTRUM);
        let part = |key: &str| {
            let found = table.get(key);
            if found.is_none() && known {
                problems.add(table.at, format!("{label}: \"{key}\" is missing; write {EXAMPLE}"));
            }
            found
        };
        let (cases, weight) = (part("cases"), part("weight"));
        let name = weight.and_then(|entry| Some((text(entry.node, problems, &label)?, entry.node.at)));
        let (cases, (name, at)) = (cases?, name?);
        let unit = self.weight_unit(&name).map_err(|error| problems.add(at, format!("{label}: {error}"))).ok()?;
        let column = WeightColumn { name: &name, weights: RefCell::default() };
        let place = CasesPlace { role, number: position, at: cases.node.at, csv: "", leaves_out: false, weight: Some(&column) };
        let axis = self.cases(place, cases.node, &label)?;
        let weights = column.weights.into_inner();
        let spectrum = Spectrum { axis: position, name: entry.key.to_owned(), weight: name.clone(), unit, weights };
        if spectrum.total() <= 0.0 {
            problems.add(at, format!("{label}: all weights in \"{}\" are 0; give one case a weight at least", shortened(&name)));
            return None;
        }
        if !spectrum.total().is_finite() {
            problems.add(at, format!("{label}: the weights in \"{}\" add up beyond any number; use a larger unit", shortened(&name)));
            return None;
        }
        *self.spectrum.borrow_mut() = Some(spectrum);
        known.then_some(axis)
    }

    /// The unit of the weights in a column of that name, or why it can have none.
    fn weight_unit(&self, name: &str) -> Result<String, String> {
        let shown = shortened(name);
        let is_own = self.model.input(name).is_some() && !self.is_variable(name);
        if is_own || self.model.output(name).is_some() {
            let what = if is_own { "input" } else { "output" };
            return Err(format!("the weights cannot be \"{shown}\", which is an {what}; give them a column of their own, such as share"));
        }
        let own: &[String] = self.model.origin.as_ref().map_or(&[], |origin| &origin.extension.units);
        let units = Units::new(own).map_err(|_| "the units of the study are wrong".to_owned())?;
        units.symbol_of_name(name).map_err(|error| format!("the weights cannot be \"{shown}\": {error}"))
    }

    /// Is it an input only because a formula of the study reads it?
    pub(super) fn is_variable(&self, name: &str) -> bool {
        self.model.origin.as_ref().is_some_and(|origin| {
            let own = &origin.extension;
            let is_designed = own.is_nominal_set(name) && origin.base.input(name).is_none();
            own.tolerance_of(name).is_none() && (is_designed || own.variables.iter().any(|it| it == name))
        })
    }

    /// What becomes of a quantity over the scenarios, as a table says it.
    pub(super) fn over(&self, table: &TomlTable<'_>, quantity: Quantity, label: &str) -> Option<OverScenarios> {
        let Some(entry) = table.get("over_scenarios") else { return Some(OverScenarios::Worst) };
        if self.meanings.is_some() {
            // What becomes of the cases is part of the statistic.
            return Some(OverScenarios::Worst);
        }
        let problems = self.problems;
        let over = choice(entry, problems, label, OVER)?;
        if over.is_worst() {
            return Some(over);
        }
        let at = entry.node.at;
        let word = over.word();
        if self.spectrum.borrow().is_none() {
            if self.weighted_at.get().is_none() {
                let remedy = format!("give the cases of an axis weights, such as {EXAMPLE} in [operation]");
                problems.add_if_complete(at, format!("{label}: over_scenarios = \"{word}\" needs weights; {remedy}"));
            }
            return None;
        }
        let name = quantity.name(self.model);
        if matches!(quantity, Quantity::Input(number) if self.is_chosen(number)) {
            problems.add(at, format!("{label}: \"{name}\" is a design input, the same in every case; drop over_scenarios"));
            return None;
        }
        let column = over.column(quantity, self.model);
        if self.find_quantity(&column).is_some() {
            let message = format!("{label}: the {word} would be the column {column}, but that is another quantity; rename the other");
            problems.add(at, message);
            return None;
        }
        Some(over)
    }

    /// The unit of what becomes of a quantity over the scenarios, as text.
    pub(super) fn unit_over(&self, quantity: Quantity, over: OverScenarios) -> String {
        unit_over(quantity, over, self.model, self.spectrum.borrow().as_ref())
    }

    /// A value in that unit as text.
    pub(super) fn shown_over(&self, value: f64, quantity: Quantity, over: OverScenarios) -> String {
        let unit = self.unit_over(quantity, over);
        if unit == self.unit(quantity).symbol {
            return shown_in(value, self.unit(quantity));
        }
        format!("{} {unit}", shown(value)).trim_end().to_owned()
    }

    /// A value in that unit, with a report if it is none. Values in a product of units are plain numbers.
    pub(super) fn value_over(&self, entry: &Entry<'_>, quantity: Quantity, over: OverScenarios, label: &str) -> Option<f64> {
        let unit = self.unit_over(quantity, over);
        if unit == self.unit(quantity).symbol {
            return self.quantity_value(entry, quantity, label);
        }
        let place = if unit.is_empty() { String::new() } else { format!(" in {unit}") };
        let wrong = || Err(format!("found {}, wanted a number{place}", entry.node.found()));
        number(entry.node).unwrap_or_else(wrong).map_err(|error| self.problems.add(entry.node.at, format!("{label}: {error}"))).ok()
    }
}
