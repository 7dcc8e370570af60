//! Distributions of `[uncertainty]`.

use super::super::drawn::{LawText, NamedLaw, UncertainInput};
use super::csv_file::{csv_builder, csv_text, record_line};
use super::roles::{AxisClaim, AxisRole};
use super::table::{Entry, Lines, TomlNode, TomlTable, list, shortened};
use super::value::measured;
use super::{Reader, text};
use crate::likeness::closest;
use crate::probability::Effect;
use crate::units::{NONE, Unit};

/// The distributions as they are written.
pub(in super::super) const LAWS: [&str; 10] =
    ["uniform", "normal", "lognormal", "triangular", "beta", "weibull", "gumbel", "exponential", "discrete", "empirical"];
/// The parameters of each, in the order in which a list may give them; empty where they are no plain numbers.
pub(in super::super) const PARAMETERS: [&[&str]; 10] = [
    &["from", "to"],
    &["mean", "sd"],
    &["mean", "sd"],
    &["from", "mode", "to"],
    &["alpha", "beta", "from", "to"],
    &["shape", "scale", "from"],
    &["mode", "scale"],
    &["mean"],
    &[],
    &[],
];
/// Those whose parameters may be a list.
pub(in super::super) const LISTED: [&str; 2] = ["uniform", "triangular"];
/// The parameter that may be left out: where a Weibull distribution begins, 0.
pub(in super::super) const LEFT_OUT: (&str, &str) = ("weibull", "from");
/// The keys of a discrete distribution.
pub(in super::super) const DISCRETE: &[&str] = &["values", "weights"];
/// What a drawn number may do to what the design says.
const EFFECTS: [(&str, Effect); 2] = [("times", Effect::Times), ("plus", Effect::Plus)];

/// Does an entry of `[uncertainty]` give a distribution?
pub(super) fn is_law(entry: &Entry<'_>) -> bool {
    let has = |table: &TomlTable<'_>| LAWS.iter().any(|name| table.get(name).is_some()) || tolerance(table).is_some();
    entry.node.table().is_some_and(|table| has(&table)) && !has_levels(entry)
}

/// Keys of a range, as which levels may be given.
const OF_RANGES: [&str; 4] = ["from", "to", "count", "step"];

/// Does an entry of `[uncertainty]` give levels of a tolerance?
pub(super) fn has_levels(entry: &Entry<'_>) -> bool {
    let Some(table) = entry.node.table() else { return false };
    let Some((_, _, inner)) = tolerance(&table) else { return false };
    let is_range = |body: TomlTable<'_>| {
        let has = |names: &[&str]| names.iter().any(|name| body.get(name).is_some());
        has(&OF_RANGES) && !has(&LAWS)
    };
    inner.list().is_some() || inner.table().is_some_and(is_range)
}

/// What an entry says of a tolerance, if it is about one: the key, what it means, and what stands behind it.
pub(super) fn tolerance<'t>(table: &TomlTable<'t>) -> Option<(&'static str, Effect, TomlNode<'t>)> {
    EFFECTS.iter().find_map(|&(name, effect)| Some((name, effect, table.get(name)?.node)))
}

/// The distribution that was probably meant.
pub(super) fn likely_law(key: &str) -> Option<&'static str> {
    closest(key, &LAWS)
}

/// Parameters of a distribution, with their units.
struct LawParameters<'r, 't> {
    reader: &'r Reader<'r>,
    name: &'static str,
    label: String,
    unit: Unit,
    table: Option<TomlTable<'t>>,
    numbers: Vec<f64>,
    at: usize,
}

impl Reader<'_> {
    /// Reads an input with a distribution.
    pub(super) fn uncertain(&self, entry: &Entry<'_>) {
        let label = format!("input \"{}\"", shortened(entry.key));
        let Some(table) = entry.node.table() else { return };
        let effect = tolerance(&table);
        let change = effect.as_ref().and_then(|(_, effect, _)| self.change_of(entry.key, *effect));
        let Some(number) = change.or_else(|| self.input(entry.key, entry.key_at, &label)) else { return };
        let input = &self.model.inputs[number];
        let wrong = |at: usize, message: String| self.problems.add(at, format!("{label}: {message}"));
        if input.is_enumeration() || input.integer {
            let what = if input.integer { "whole numbers" } else { "words" };
            wrong(entry.node.at, format!("it takes {what}, which have no distribution; list its levels"));
            return;
        }
        let (effect, unit, body) = match effect {
            None => (Effect::Is, input.unit, table),
            Some((name, effect, inner)) => {
                let other = EFFECTS.iter().filter(|it| it.0 != name).find_map(|it| table.get(it.0));
                if let Some(other) = other {
                    wrong(other.key_at, format!("a tolerance is {} or {}, not both; drop one of the two", EFFECTS[0].0, EFFECTS[1].0));
                    return;
                }
                table.check_keys(self.problems, &label, &[name]);
                let Some(body) = inner.table() else {
                    let example = if effect == Effect::Times { "[0.9, 1.1]" } else { "[-0.1, 0.1]" };
                    let wanted = format!("wanted a distribution such as {{ uniform = {example} }}, or levels such as {example}");
                    wrong(inner.at, format!("{name}: found {}, {wanted}", inner.found()));
                    return;
                };
                (effect, if effect == Effect::Times { NONE } else { input.unit }, body)
            }
        };
        let Some(law) = self.law(&body, &label, unit) else { return };
        let distribution = match law.distribution() {
            Ok(distribution) => distribution,
            Err(problem) => return wrong(body.at, problem.to_string()),
        };
        let in_model = change.is_some();
        if in_model {
            let at = entry.key_at;
            self.claims.borrow_mut().push(AxisClaim { input: number, role: AxisRole::Uncertainty, at, single: true, word: None });
        }
        if effect == Effect::Is {
            let median = distribution.quantile(0.5).unwrap_or(f64::NAN);
            if !input.accepts(median) {
                return wrong(body.at, format!("the median {median} is out of range; it must be {}", input.valid.in_words()));
            }
            self.claims.borrow_mut().push(AxisClaim {
                input: number,
                role: AxisRole::Uncertainty,
                at: entry.key_at,
                single: true,
                word: None,
            });
        }
        let uncertain = UncertainInput { input: number, name: entry.key.to_owned(), effect, in_model, law, distribution };
        self.uncertain.borrow_mut().push((uncertain, entry.key_at));
    }

    fn law(&self, body: &TomlTable<'_>, label: &str, unit: Unit) -> Option<LawText> {
        let before = self.problems.count();
        let named: Vec<_> = LAWS.iter().filter_map(|name| Some((*name, body.get(name)?))).collect();
        let [(name, entry)] = named[..] else {
            let found =
                if named.is_empty() { "there is no distribution".to_owned() } else { format!("there are {} distributions", named.len()) };
            self.problems.add(body.at, format!("{label}: {found}; give one of {}", list(LAWS)));
            return None;
        };
        body.check_keys(self.problems, label, &[name, "from", "to"]);
        let label = format!("{label}: {name}");
        let number = |node: TomlNode<'_>, unit: Unit, what: &str| {
            measured(node, unit).map_err(|error| self.problems.add(node.at, format!("{label}: {what}: {error}"))).ok()
        };
        let numbers = |node: TomlNode<'_>, unit: Unit| -> Option<Vec<f64>> {
            let Some(nodes) = node.list() else {
                self.problems.add(node.at, format!("{label}: found {}, wanted a list of numbers", node.found()));
                return None;
            };
            let values: Vec<f64> = nodes.clone().filter_map(|it| number(it, unit, "value")).collect();
            (values.len() == nodes.len()).then_some(values)
        };
        let as_list = if LISTED.contains(&name) { entry.node.list().and_then(|_| numbers(entry.node, unit)) } else { None };
        let parameters = LawParameters {
            reader: self,
            name,
            label: label.clone(),
            unit,
            table: entry.node.table(),
            numbers: as_list.unwrap_or_default(),
            at: entry.node.at,
        };
        let names = LAWS.iter().position(|it| *it == name).map_or(&[][..], |at| PARAMETERS[at]);
        let law = match name {
            "uniform" => parameters.read(names, |it| NamedLaw::Uniform { from: it[0], to: it[1] }),
            "normal" => parameters.read(names, |it| NamedLaw::Normal { mean: it[0], sd: it[1] }),
            "lognormal" => parameters.read(names, |it| NamedLaw::Lognormal { mean: it[0], sd: it[1] }),
            "triangular" => parameters.read(names, |it| NamedLaw::Triangular { from: it[0], mode: it[1], to: it[2] }),
            "beta" => parameters.read(names, |it| NamedLaw::Beta { alpha: it[0], beta: it[1], from: it[2], to: it[3] }),
            "weibull" => parameters.read(names, |it| NamedLaw::Weibull { shape: it[0], scale: it[1], from: it[2] }),
            "gumbel" => parameters.read(names, |it| NamedLaw::Gumbel { mode: it[0], scale: it[1] }),
            "exponential" => parameters.read(names, |it| NamedLaw::Exponential { mean: it[0] }),
            "discrete" => self.table_of_law(entry, &label, "{ values = [...], weights = [...] }").and_then(|table| {
                table.check_keys(self.problems, &label, DISCRETE);
                let part = |key: &str| {
                    let found = table.get(key);
                    if found.is_none() {
                        self.problems.add(table.at, format!("{label}: \"{key}\" is missing; write {{ values = [...], weights = [...] }}"));
                    }
                    found
                };
                let (values, weights) = (part("values"), part("weights"));
                Some(NamedLaw::Discrete { values: numbers(values?.node, unit)?, weights: numbers(weights?.node, NONE)? })
            }),
            _ => self.measured_values(entry, &label, unit, &numbers).map(|values| NamedLaw::Empirical { values }),
        };
        let end = |key: &str| body.get(key).and_then(|entry| number(entry.node, unit, key));
        let law = LawText { law: law?, from: end("from"), to: end("to") };
        (self.problems.count() == before).then_some(law)
    }

    fn table_of_law<'n>(&self, entry: &Entry<'n>, label: &str, example: &str) -> Option<TomlTable<'n>> {
        let table = entry.node.table();
        if table.is_none() {
            self.problems.add(entry.node.at, format!("{label}: found {}, wanted {example}", entry.node.found()));
        }
        table
    }

    /// Measured values: a list, or a column of a CSV file.
    fn measured_values(
        &self,
        entry: &Entry<'_>,
        label: &str,
        unit: Unit,
        numbers: &impl Fn(TomlNode<'_>, Unit) -> Option<Vec<f64>>,
    ) -> Option<Vec<f64>> {
        if entry.node.list().is_some() {
            return numbers(entry.node, unit);
        }
        let example = "a list of values, or { csv = \"file.csv\", column = \"...\" }";
        let table = self.table_of_law(entry, label, example)?;
        table.check_keys(self.problems, label, super::keys::MEASURED);
        let (Some(file), Some(column)) = (table.get("csv"), table.get("column")) else {
            self.problems.add(table.at, format!("{label}: wanted {example}"));
            return None;
        };
        let (file, name) = (text(file.node, self.problems, label)?, text(column.node, self.problems, label)?);
        let content =
            csv_text(self.folder, &file, "study").map_err(|error| self.problems.add(table.at, format!("{label}: {error}"))).ok()?;
        let tell = |line: usize, message: String| {
            self.problems.add_in(table.at, &file, line, 1, format!("{label}: {message}"));
        };
        let lines = Lines::new(&content);
        let mut reader = csv_builder().from_reader(content.as_bytes());
        let header = reader.headers().map_err(|error| tell(1, format!("this is not CSV: {error}"))).ok()?.clone();
        let Some(place) = header.iter().position(|it| it == name) else {
            tell(1, format!("there is no column \"{}\"; its columns are {}", shortened(&name), list(header.iter())));
            return None;
        };
        let mut values = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| tell(1, format!("this is not CSV: {error}"))).ok()?;
            let line = record_line(&lines, &content, &record);
            match record[place].parse::<f64>() {
                Ok(value) if value.is_finite() => values.push(value + 0.0),
                _ => {
                    tell(line, format!("\"{}\" in column \"{}\" is no number", shortened(&record[place]), shortened(&name)));
                    return None;
                }
            }
        }
        Some(values)
    }
}

impl LawParameters<'_, '_> {
    fn may_be_left_out(&self, name: &str) -> bool {
        (self.name, name) == LEFT_OUT
    }

    /// The parameters of these names, from a table or, in this order, from a list. The first of a Weibull distribution's values is 0
    /// unless it is given.
    fn read(&self, names: &[&str], law: impl Fn(&[f64]) -> NamedLaw) -> Option<NamedLaw> {
        let problems = self.reader.problems;
        let example = || names.iter().map(|name| format!("{name} = ...")).collect::<Vec<_>>().join(", ");
        let Some(table) = &self.table else {
            if self.numbers.len() == names.len() {
                return Some(law(&self.numbers));
            }
            problems.add(self.at, format!("{}: wanted {{ {} }}", self.label, example()));
            return None;
        };
        table.check_keys(problems, &self.label, names);
        let value = |name: &&str| {
            let Some(entry) = table.get(name) else {
                if self.may_be_left_out(name) {
                    return Some(0.0);
                }
                problems.add(table.at, format!("{}: \"{name}\" is missing; write {{ {} }}", self.label, example()));
                return None;
            };
            let unit = if matches!(*name, "alpha" | "shape") || (*name == "beta" && names.len() == 4) { NONE } else { self.unit };
            let value = measured(entry.node, unit);
            value.map_err(|error| problems.add(entry.node.at, format!("{}: {name}: {error}", self.label))).ok()
        };
        let values: Vec<Option<f64>> = names.iter().map(value).collect();
        values.into_iter().collect::<Option<Vec<f64>>>().map(|values| law(&values))
    }
}
