//! Tolerances of `[uncertainty]` that become a part of the model: those of inputs that a formula gives or of which a formula asks what
//! the design says, and those with levels.

use super::super::axis::{Axis, Levels};
use super::super::quantity::Quantity;
use super::Reader;
use super::law::{has_levels, tolerance};
use super::roles::{AxisClaim, AxisRole};
use super::table::{Entry, Problems, TomlTable, shortened};
use crate::formula::{Expression, nominals_in};
use crate::models::{Extension, Model, ModelTolerance};
use crate::probability::Effect;

/// A tolerance that becomes a part of the model.
pub(super) struct ModelToleranceEntry {
    pub(super) name: String,
    pub(super) at: usize,
    effect: Effect,
}

impl ModelToleranceEntry {
    /// What becomes a part of the model.
    pub(super) fn tolerance(&self) -> ModelTolerance<'_> {
        ModelTolerance { of: &self.name, effect: self.effect }
    }
}

/// The tolerances that become a part of the model. Reports those whose names are taken.
pub(super) fn tolerances(model: &Model, extension: &Extension, top: &TomlTable<'_>, problems: &Problems<'_>) -> Vec<ModelToleranceEntry> {
    let asked: Vec<String> = extension
        .formulas
        .iter()
        .filter_map(|it| Expression::parse(&it.text).ok())
        .flat_map(|it| nominals_in(&it).into_iter().map(str::to_owned).collect::<Vec<_>>())
        .collect();
    let is_number = |name: &str| match model.input(name) {
        Some(input) => !model.inputs[input].is_enumeration() && !model.inputs[input].integer,
        None => extension.variables.iter().any(|it| it == name),
    };
    let is_given = |name: &str| extension.formulas.iter().any(|it| it.name == name);
    let of_entry = |entry: &Entry<'_>| {
        let (_, effect, _) = tolerance(&entry.node.table()?)?;
        let name = entry.key;
        let becomes = has_levels(entry) || is_given(name) || asked.iter().any(|it| it == name);
        (becomes && is_number(name)).then(|| ModelToleranceEntry { name: name.to_owned(), at: entry.key_at, effect })
    };
    let table = top.get("uncertainty").and_then(|entry| entry.node.table());
    let found: Vec<_> = table.iter().flat_map(|table| &table.entries).filter_map(of_entry).collect();
    let is_taken = |name: &str| {
        let own = extension.variables.iter().chain(extension.curves.iter().map(|it| &it.name));
        model.input(name).is_some() || model.output(name).is_some() || is_given(name) || own.into_iter().any(|it| it == name)
    };
    for it in &found {
        // The names of a tolerance are new ones.
        if let Some(name) = it.tolerance().names().iter().find(|name| is_taken(name)) {
            let of = shortened(&it.name);
            problems
                .add(it.at, format!("the tolerance of \"{of}\" makes the name {name}, which is taken; choose another name for that one"));
        }
    }
    found
}

impl Reader<'_> {
    /// Number of the factor or addend of an input whose tolerance is a part of the model.
    pub(super) fn change_of(&self, name: &str, effect: Effect) -> Option<usize> {
        let has_nominal = self.model.origin.as_ref().is_some_and(|it| it.extension.has_nominal(name));
        self.model.input(&ModelTolerance { of: name, effect }.change()).filter(|_| has_nominal)
    }

    /// The axis of a tolerance with levels.
    pub(super) fn levels_of_tolerance(&self, entry: &Entry<'_>) -> Option<Axis> {
        let label = format!("axis \"{}\"", shortened(entry.key));
        let table = entry.node.table()?;
        let (key, effect, inner) = tolerance(&table)?;
        let Some(number) = self.change_of(entry.key, effect) else {
            let input = &self.model.inputs[self.input(entry.key, entry.key_at, &label)?];
            let what = if input.integer { "whole numbers" } else { "words" };
            self.problems.add(entry.node.at, format!("{label}: it takes {what}, which have no tolerance; list its levels"));
            return None;
        };
        let input = &self.model.inputs[number];
        let known = table.check_keys(self.problems, &label, &[key]);
        let label = format!("{label}: {key}");
        let levels: Option<Levels> = match inner.table() {
            Some(range) => self.range(&range, input, &label, AxisRole::Uncertainty),
            None => self.list(inner, number, &label),
        };
        self.claims.borrow_mut().push(AxisClaim { input: number, role: AxisRole::Uncertainty, at: entry.key_at, single: true, word: None });
        self.toleranced.borrow_mut().push((entry.key.to_owned(), entry.key_at));
        Some(Axis::Single { input: number, levels: levels.filter(|_| known)? })
    }

    /// A tolerance is about a number that the design has.
    pub(super) fn check_toleranced(&self, name: &str, at: usize, fixed: &[f64]) {
        // What a formula gives is a number.
        let Some(input) = self.model.input(name) else { return };
        let claims = self.claims.borrow();
        let mut own = claims.iter().filter(|claim| claim.input == input).peekable();
        let word = match own.peek() {
            None => self.model.inputs[input].word_for(fixed[input]).map(str::to_owned),
            Some(_) => own.find_map(|claim| claim.word.clone()),
        };
        if let Some(word) = word {
            let message = format!("input \"{name}\": its value may be the word \"{word}\", which has no tolerance; give it numbers only");
            self.problems.add(at, message);
        }
    }

    /// The same quantity of what is built, where what the design says is told apart from it.
    pub(super) fn as_built(&self, quantity: Quantity) -> Quantity {
        let Quantity::Input(input) = quantity else { return quantity };
        let Some(extension) = self.model.origin.as_ref().map(|it| &it.extension).filter(|_| self.meanings.is_none()) else {
            return quantity;
        };
        let built = extension.output_name(&self.model.inputs[input].name);
        self.model.output(&built).map_or(quantity, Quantity::Output)
    }
}
