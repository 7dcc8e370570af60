//! Inputs and outputs that a study is about: constraints and objectives.

use super::super::drawn::{OVER_DRAWS, SCREENED, YIELD};
use super::super::quantity::Quantity;
use super::super::resolved::{Constraint, Goal, Objective};
use super::super::spectrum::OverScenarios;
use super::roles::AxisRole;
use super::table::{Entry, TomlTable, shortened};
use super::value::measured;
use super::{Reader, choice, text};
use crate::likeness::remedy;
use crate::units::Unit;
use toml::de::DeValue;

/// Most objectives of a study.
pub(in super::super) const MOST_OBJECTIVES: usize = 6;
/// The two directions as they are written.
pub(super) const GOALS: &[(&str, Goal)] = &[("min", Goal::Min), ("max", Goal::Max)];

impl Reader<'_> {
    /// The input or output of that name.
    pub(super) fn find_quantity(&self, name: &str) -> Option<Quantity> {
        self.model.output(name).map(Quantity::Output).or_else(|| self.model.input(name).map(Quantity::Input))
    }

    /// The input or output of that name, with a report if there is none.
    pub(super) fn quantity(&self, name: &str, at: usize, label: &str) -> Option<Quantity> {
        let found = self.find_quantity(name);
        if found.is_none() && self.model.hides(name) {
            let message = format!("{label}: {name} is a hidden formula, an intermediate value; drop hidden, or name it among the outputs");
            self.problems.add(at, message);
        } else if found.is_none() {
            let names: Vec<_> = self
                .model
                .outputs
                .iter()
                .map(|output| output.name.as_str())
                .chain(self.model.inputs.iter().map(|input| input.name.as_str()))
                .collect();
            let remedy = remedy(name, &names, || format!("beltspace models {} lists them", self.model.name));
            self.problems.add(at, format!("{label}: {} has no input or output \"{}\"; {remedy}", self.model.name, shortened(name)));
        }
        found
    }

    /// The input or output of that name, if all its values are numbers; reports otherwise.
    pub(super) fn numeric(&self, name: &str, at: usize, label: &str, fixed: &[f64]) -> Option<Quantity> {
        if let Some(meaning) = self.meanings.as_ref().and_then(|(meanings, _)| meanings.get(&at)) {
            return *meaning;
        }
        let quantity = self.quantity(name, at, label)?;
        let Quantity::Input(number) = quantity else { return Some(quantity) };
        let input = &self.model.inputs[number];
        let claims = self.claims.borrow();
        let mut claimed = claims.iter().filter(|claim| claim.input == number).peekable();
        let default = claimed.peek().is_none();
        if input.is_enumeration() {
            let message = format!("{label}: the values of \"{name}\" are words, which have no order; name an input or output of numbers");
            self.problems.add(at, message);
            return None;
        }
        if let Some(word) = input.word_for(fixed[number]).filter(|_| default) {
            if self.misnamed.get() {
                return None;
            }
            let whose = if fixed[number] == input.default { "its default" } else { "the preset's" };
            let message =
                format!("{label}: \"{name}\" has {whose} \"{word}\", which is no number; give it numbers as an axis or in [fixed]");
            self.problems.add_if_complete(at, message);
            return None;
        }
        if let Some((claim, word)) = claimed.find_map(|claim| Some((claim, claim.word.as_ref()?))) {
            let place = format!("[{}], line {}", claim.role.name(), self.problems.line_number(claim.at));
            self.problems.add(at, format!("{label}: \"{name}\" takes \"{word}\" in {place}, which is no number; give it numbers only"));
            return None;
        }
        // Of what is chosen it is what the design says that is told.
        Some(if self.is_chosen(number) { quantity } else { self.as_built(quantity) })
    }

    /// The quantity that an entry of `[constraints]` or `[objectives]` is about: its key, or what stands behind `of`.
    fn asked(&self, entry: &Entry<'_>, label: &str, fixed: &[f64]) -> Option<Quantity> {
        let table = entry.node.table();
        let Some(of) = table.as_ref().and_then(|table| table.get("of")) else {
            return self.numeric(entry.key, entry.key_at, label, fixed);
        };
        let name = text(of.node, self.problems, label)?;
        if name != entry.key && self.find_quantity(entry.key).is_some() {
            let key = shortened(entry.key);
            self.problems.add(entry.key_at, format!("{label}: {key} is a quantity itself; choose another label, or drop of"));
            return None;
        }
        self.numeric(&name, of.node.at, label, fixed)
    }

    /// Reports entries that are about the same as one before; the others are left.
    fn single_ones<T: Copy>(
        &self,
        table: &TomlTable<'_>,
        what: &str,
        remedy: &str,
        read: impl Fn(&Entry<'_>) -> Option<T>,
        same: impl Fn(&T, &T) -> bool,
    ) -> Vec<T> {
        let mut held: Vec<(T, usize)> = Vec::new();
        for entry in table.entries.iter().take_while(|_| !self.problems.is_full()) {
            let Some(one) = read(entry) else { continue };
            if let Some((_, first)) = held.iter().find(|(other, _)| same(other, &one)) {
                let line = self.problems.line_number(*first);
                let key = shortened(entry.key);
                self.problems.add(entry.key_at, format!("{what} \"{key}\": line {line} asks for the same; {remedy}"));
                continue;
            }
            held.push((one, entry.key_at));
        }
        held.into_iter().map(|(one, _)| one).collect()
    }

    /// The unit of a quantity.
    pub(super) fn unit(&self, quantity: Quantity) -> Unit {
        // A statistic is in the unit of what it is of.
        let of_drive = self.meanings.as_ref().and_then(|(_, probability)| {
            let asked = probability.statistics[quantity.output()?].kind.asked()?;
            Some((asked.quantity, &probability.drive.model)).filter(|_| asked.over != OverScenarios::Sum)
        });
        match of_drive.unwrap_or((quantity, self.model)) {
            (Quantity::Input(number), model) => model.inputs[number].unit,
            (Quantity::Output(number), model) => model.outputs[number].unit,
        }
    }

    /// A value in a quantity's unit, with a report if it is none.
    pub(super) fn quantity_value(&self, entry: &Entry<'_>, quantity: Quantity, label: &str) -> Option<f64> {
        let value = measured(entry.node, self.unit(quantity));
        value.map_err(|error| self.problems.add(entry.node.at, format!("{label}: {error}"))).ok()
    }

    /// Is the input a design axis?
    pub(super) fn is_chosen(&self, number: usize) -> bool {
        self.claims.borrow().iter().any(|claim| claim.input == number && claim.role == AxisRole::Design)
    }

    /// The `[constraints]` table.
    pub(super) fn constraints(&self, table: &TomlTable<'_>, fixed: &[f64]) -> Vec<Constraint> {
        let same = |a: &Constraint, b: &Constraint| (a.quantity, a.over) == (b.quantity, b.over);
        let read = |entry: &Entry<'_>| {
            if self.meanings.is_some() { self.constraint_of_draws(entry, fixed) } else { self.constraint(entry, fixed) }
        };
        self.single_ones(table, "constraint", "give all bounds in one entry", read, same)
    }

    /// Of a study with distributions: what is asked of all draws; `None` for what a single draw must keep.
    fn constraint_of_draws(&self, entry: &Entry<'_>, fixed: &[f64]) -> Option<Constraint> {
        let table = entry.node.table();
        let at = table.as_ref().and_then(|table| table.get("of")).map_or(entry.key_at, |of| of.node.at);
        let quantity = (*self.meanings.as_ref()?.0.get(&at)?)?;
        match table?.get(YIELD) {
            Some(wanted) => {
                let least = self.quantity_value(wanted, quantity, &format!("constraint \"{}\"", shortened(entry.key)))?;
                Some(Constraint { quantity, low: Some((least, false)), high: None, over: OverScenarios::Worst })
            }
            None => self.constraint(entry, fixed),
        }
    }

    /// Of a study with distributions that has the yield as an objective only: one draw that holds makes a design feasible.
    pub(super) fn one_draw_at_least(&self, constraints: &[Constraint]) -> Option<Constraint> {
        self.meanings.as_ref()?;
        let quantity = Quantity::Output(self.model.output(SCREENED)?);
        let is_asked = constraints.iter().any(|it| it.quantity == quantity);
        (!is_asked).then_some(Constraint { quantity, low: Some((0.0, true)), high: None, over: OverScenarios::Worst })
    }

    /// A constraint as it is written.
    pub(super) fn constraint(&self, entry: &Entry<'_>, fixed: &[f64]) -> Option<Constraint> {
        let problems = self.problems;
        let label = format!("constraint \"{}\"", shortened(entry.key));
        let quantity = self.as_built(self.asked(entry, &label, fixed)?);
        let Some(table) = entry.node.table() else {
            let found = entry.node.found();
            problems.add(entry.node.at, format!("{label}: found {found}, wanted bounds such as {{ min = 0 }}"));
            return None;
        };
        let known = table.check_keys(problems, &label, &self.with_draws(super::keys::CONSTRAINT, &[YIELD]));
        let over = self.over(&table, quantity, &label)?;
        let is_bounded = ["min", "max", "above", "below"].iter().any(|key| table.get(key).is_some());
        if !is_bounded && known {
            problems.add(table.at, format!("{label}: there are no bounds; give min, max, above or below"));
        }
        let bound = |inclusive: &str, strict: &str| -> Option<Option<(f64, bool, usize)>> {
            let (entry, excluded) = match (table.get(inclusive), table.get(strict)) {
                (Some(first), Some(second)) => {
                    let at = first.key_at.max(second.key_at);
                    problems.add(at, format!("{label}: {inclusive} and {strict} are both given; keep one of the two"));
                    return None;
                }
                (Some(entry), None) => (entry, false),
                (None, Some(entry)) => (entry, true),
                (None, None) => return Some(None),
            };
            self.value_over(entry, quantity, over, &label).map(|value| Some((value, excluded, entry.key_at)))
        };
        let (low, high) = (bound("min", "above"), bound("max", "below"));
        let (low, high) = (low?, high?);
        if let (Some((least, no_least, at_least)), Some((most, no_most, at_most))) = (low, high)
            && (least > most || (least == most && (no_least || no_most)))
        {
            let shown = |value: f64| self.shown_over(value, quantity, over);
            let low = format!("{} {}", if no_least { "above" } else { "at least" }, shown(least));
            let high = format!("{} {}", if no_most { "below" } else { "at most" }, shown(most));
            problems.add(at_least.max(at_most), format!("{label}: no value is {low} and {high}; swap or widen the bounds"));
            return None;
        }
        let side = |bound: Option<(f64, bool, usize)>| bound.map(|(value, excluded, _)| (value, excluded));
        (known && is_bounded).then_some(Constraint { quantity, low: side(low), high: side(high), over })
    }

    /// Keys that are allowed, with those that tell of draws where there are such.
    pub(super) fn with_draws(&self, keys: &[&'static str], besides: &[&'static str]) -> Vec<&'static str> {
        let drawn: &[&str] = if self.has_laws.get() { &[OVER_DRAWS] } else { &[] };
        let besides = if drawn.is_empty() { &[] } else { besides };
        [keys, drawn, besides].concat()
    }

    /// The `[objectives]` table.
    pub(super) fn objectives(&self, table: &TomlTable<'_>, fixed: &[f64]) -> Vec<Objective> {
        if let Some(extra) = table.entries.get(MOST_OBJECTIVES) {
            let number = table.entries.len();
            self.problems.add(
                extra.key_at,
                format!(
                    "the study has {number} objectives, at most {MOST_OBJECTIVES} are possible; \
                     make the others constraints or columns of [report]"
                ),
            );
        }
        let same = |a: &Objective, b: &Objective| (a.quantity, a.over) == (b.quantity, b.over);
        self.single_ones(table, "objective", "drop one", |entry| self.objective(entry, fixed), same)
    }

    fn objective(&self, entry: &Entry<'_>, fixed: &[f64]) -> Option<Objective> {
        let problems = self.problems;
        let label = format!("objective \"{}\"", shortened(entry.key));
        let quantity = self.asked(entry, &label, fixed);
        let goal_of = |text: &Entry<'_>| choice(&Entry { key: "goal", key_at: text.key_at, node: text.node }, problems, &label, GOALS);
        let Some(table) = entry.node.table() else {
            if !matches!(entry.node.value, DeValue::String(_)) {
                let found = entry.node.found();
                problems.add(
                    entry.node.at,
                    format!("{label}: found {found}, wanted \"min\", \"max\" or {{ goal = \"min\", resolution = 10 }}"),
                );
                return None;
            }
            return Some(Objective { goal: goal_of(entry)?, quantity: quantity?, resolution: None, over: OverScenarios::Worst });
        };
        let known = table.check_keys(problems, &label, &self.with_draws(super::keys::OBJECTIVE, &[]));
        let goal = match table.get("goal") {
            Some(entry) => goal_of(entry),
            None => {
                if known {
                    problems.add(table.at, format!("{label}: there is no goal; write goal = \"min\" or goal = \"max\""));
                }
                None
            }
        };
        let quantity = quantity?;
        let over = self.over(&table, quantity, &label)?;
        let resolution = match table.get("resolution") {
            None => None,
            Some(entry) => {
                let value = self.value_over(entry, quantity, over, &label)?;
                if value <= 0.0 {
                    let value = self.shown_over(value, quantity, over);
                    problems.add(entry.node.at, format!("{label}: the resolution {value} cannot be used; it must be greater than 0"));
                    return None;
                }
                Some(value)
            }
        };
        Some(Objective { quantity, goal: goal.filter(|_| known)?, resolution, over })
    }
}
