//! The `contours` of a map: the quantities and values at which lines are drawn.

use super::super::axis::{Axis, Levels};
use super::super::limits::MOST_THRESHOLDS;
use super::super::quantity::Quantity;
use super::super::resolved::{Best, ContourSpec, Thresholds};
use super::table::{Entry, TomlNode, TomlTable, list};
use super::value::{measured, shown, shown_in};
use super::{Reader, text};
use toml::de::DeValue;

const LABEL: &str = "contours";

/// What the reader of contours must know of the map.
pub(super) struct Plane<'a> {
    /// The design axes.
    pub(super) design: &'a [Axis],
    /// Position of the horizontal axis.
    pub(super) x: usize,
    /// Position of the vertical axis.
    pub(super) y: usize,
    /// The map's value; `None` if that has a problem of its own.
    pub(super) value: Option<Best>,
    /// Fixed inputs.
    pub(super) fixed: &'a [f64],
}

impl Reader<'_> {
    /// The contours of a map; none if something is wrong.
    pub(super) fn contours(&self, entry: &Entry<'_>, plane: &Plane<'_>) -> Vec<ContourSpec> {
        let before = self.problems.count();
        self.check_plane(entry, plane);
        let mut asked = Vec::new();
        if let Some(nodes) = entry.node.list() {
            if nodes.len() == 0 {
                self.problems.add(entry.node.at, format!("{LABEL}: the list is empty; write {} or drop it", self.contours_example()));
            }
            for node in nodes.take_while(|_| !self.problems.is_full()) {
                match node.table() {
                    Some(table) => self.contours_of_table(node, &table, plane, &mut asked),
                    None => self.own_quantity(node, plane).into_iter().for_each(|of| self.add_threshold(node, of, &mut asked)),
                }
            }
        } else if matches!(entry.node.value, DeValue::Boolean(true)) {
            self.own_quantity(entry.node, plane).into_iter().for_each(|of| self.add_changes(entry.node, of, &mut asked));
        } else {
            let (found, example) = (entry.node.found(), self.contours_example());
            self.problems.add(entry.node.at, format!("{LABEL}: found {found}, wanted true or a list such as {example}"));
        }
        if self.problems.count() == before { asked } else { Vec::new() }
    }

    fn contours_example(&self) -> String {
        format!("[0.1] or [{{ of = \"{}\", at = [0.1] }}]", self.some_output())
    }

    /// Contours need a plane: two axes of numbers in order, and no other design axis.
    fn check_plane(&self, entry: &Entry<'_>, plane: &Plane<'_>) {
        let model = &self.model;
        let others = plane.design.iter().enumerate().filter(|(at, axis)| ![plane.x, plane.y].contains(at) && axis.count() > 1);
        let names: Vec<_> = others.flat_map(|(_, axis)| axis.inputs()).map(|&input| model.inputs[input].name.as_str()).collect();
        if !names.is_empty() {
            let names = list(names);
            self.problems.add(
                entry.key_at,
                format!(
                    "{LABEL}: the map's axes must be the only design axes, but [design] also has {names}; \
                     give each a single value, move it to [operation] or [uncertainty], or drop contours"
                ),
            );
        }
        for axis in [plane.x, plane.y].map(|axis| &plane.design[axis]) {
            let Axis::Single { input, levels: Levels::List(values) } = axis else { continue };
            let input = &model.inputs[*input];
            let message = if let Some(word) = values.iter().find_map(|&value| input.word_for(value)) {
                format!("\"{}\" takes \"{word}\", and nothing lies between a word and a number; give it numbers only", input.name)
            } else if !values.is_sorted() && !values.iter().rev().is_sorted() {
                format!("the levels of \"{}\" are not in order; list them in rising or falling order", input.name)
            } else {
                continue;
            };
            self.problems.add(entry.key_at, format!("{LABEL}: {message}"));
        }
    }

    /// The quantity that the map shows, for contours that name none.
    fn own_quantity(&self, node: TomlNode<'_>, plane: &Plane<'_>) -> Option<Quantity> {
        match plane.value? {
            Best::Value(quantity, _) => Some(quantity),
            Best::Share => {
                let example = format!("[{{ of = \"{}\", at = [0.1] }}]", self.some_output());
                self.problems.add(node.at, format!("{LABEL}: the map shows a share, which has no contours; name a quantity: {example}"));
                None
            }
        }
    }

    /// `{ of, at }`.
    fn contours_of_table(&self, node: TomlNode<'_>, table: &TomlTable<'_>, plane: &Plane<'_>, asked: &mut Vec<ContourSpec>) {
        table.check_keys(self.problems, LABEL, super::keys::CONTOURS);
        let Some(of) = table.get("of") else {
            let example = format!("{{ of = \"{}\", at = [0.1] }}", self.some_output());
            self.problems.add(table.at, format!("{LABEL}: \"of\" is missing; write {example}"));
            return;
        };
        let Some(name) = text(of.node, self.problems, LABEL) else { return };
        let Some(of) = self.numeric(&name, of.node.at, LABEL, plane.fixed) else { return };
        let Some(at) = table.get("at") else { return self.add_changes(node, of, asked) };
        let Some(values) = at.node.list() else {
            self.problems.add(at.node.at, format!("{LABEL}: found {}, wanted a list of values such as [0.1]", at.node.found()));
            return;
        };
        if values.len() == 0 {
            self.problems.add(at.node.at, format!("{LABEL}: there are no values; give at least one, such as at = [0.1]"));
        }
        values.take_while(|_| !self.problems.is_full()).for_each(|value| self.add_threshold(value, of, asked));
    }

    /// `true`: every change of a whole number.
    fn add_changes(&self, node: TomlNode<'_>, of: Quantity, asked: &mut Vec<ContourSpec>) {
        let name = of.name(self.model);
        if !of.is_whole(self.model) {
            let values = if node.table().is_some() { format!("{{ of = \"{name}\", at = [0.1] }}") } else { "contours = [0.1]".to_owned() };
            self.problems
                .add(node.at, format!("{LABEL}: {name} is not a whole number, so it has no steps to draw; give values, such as {values}"));
        } else if asked.iter().any(|it| it.of == of) {
            self.problems.add(node.at, format!("{LABEL}: {name} is listed twice, with every change and otherwise; drop one"));
        } else {
            asked.push(ContourSpec { of, at: Thresholds::Changes });
        }
    }

    /// One value of a quantity.
    fn add_threshold(&self, node: TomlNode<'_>, of: Quantity, asked: &mut Vec<ContourSpec>) {
        let (name, unit) = (of.name(self.model), self.unit(of));
        let value = match measured(node, unit) {
            Ok(value) => value,
            Err(error) => return self.problems.add(node.at, format!("{LABEL}: {error}")),
        };
        match asked.iter_mut().find(|it| it.of == of).map(|it| &mut it.at) {
            None => asked.push(ContourSpec { of, at: Thresholds::At(vec![value]) }),
            Some(Thresholds::Changes) => {
                let message = format!("{LABEL}: {name} has a line at every change already; drop {}", shown(value));
                self.problems.add(node.at, message);
            }
            Some(Thresholds::At(values)) if values.contains(&value) => {
                self.problems.add(node.at, format!("{LABEL}: {name} = {} is listed twice; drop one", shown_in(value, unit)));
            }
            Some(Thresholds::At(values)) if values.len() == MOST_THRESHOLDS => {
                self.problems.add(node.at, format!("{LABEL}: {name} has more than {MOST_THRESHOLDS} lines; give fewer values"));
            }
            Some(Thresholds::At(values)) => values.push(value),
        }
    }
}
