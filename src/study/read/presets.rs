//! `preset = [...]` as an axis: the inputs that some presets of the model set, jointly.

use super::super::axis::Axis;
use super::super::label::Label;
use super::Reader;
use super::formulas::given;
use super::law::tolerance;
use super::roles::{AxisClaim, AxisRole, PRESET};
use super::table::{Entry, list, shortened};
use super::text;
use std::collections::{HashMap, HashSet};

impl Reader<'_> {
    /// The places of tolerances in `[uncertainty]`.
    fn tolerances_at(&self) -> HashSet<usize> {
        let table = self.top.get("uncertainty").and_then(|entry| entry.node.table());
        let is_tolerance = |entry: &Entry<'_>| entry.node.table().is_some_and(|table| tolerance(&table).is_some());
        table.into_iter().flat_map(|table| table.entries).filter(is_tolerance).map(|entry| entry.key_at).collect()
    }

    /// The axis over the presets that the entry lists; `number` is its position among the design axes. What axes and `[fixed]` give goes
    /// over the presets; what a preset does not set has the value that it has without one.
    pub(super) fn preset_axis(&self, role: AxisRole, entry: &Entry<'_>, number: usize) -> Option<Axis> {
        let problems = self.problems;
        let before = problems.count();
        let example = || list(self.model.presets.iter().take(2).map(|it| format!("\"{}\"", it.name)));
        let Some(nodes) = entry.node.list() else {
            let found = entry.node.found();
            let remedy = format!("wanted a list such as [{}]; one preset for all belongs above the first table", example());
            problems.add(entry.node.at, format!("axis \"preset\": found {found}, {remedy}"));
            return None;
        };
        let mut names: Vec<String> = Vec::new();
        for node in nodes.take_while(|_| !problems.is_full()) {
            let Some(name) = text(node, problems, "axis \"preset\"") else { continue };
            if let Err(error) = self.model.preset(&shortened(&name)) {
                problems.add(node.at, format!("axis \"preset\": {error}"));
            } else if names.contains(&name) {
                problems.add(node.at, format!("axis \"preset\": \"{name}\" is listed twice; drop one"));
            } else {
                names.push(name);
            }
        }
        if names.is_empty() && problems.count() == before {
            problems.add(entry.node.at, format!("axis \"preset\": the list is empty; name presets such as {}", example()));
        }
        if problems.count() > before {
            return None;
        }
        let presets: Vec<_> = names.iter().filter_map(|name| self.model.presets.iter().find(|it| it.name == *name)).collect();
        let set = |name: &str| presets.iter().any(|it| it.changes.iter().any(|(changed, _)| changed == name));
        let all = &self.model.inputs;
        // A tolerance is about what the presets say, and goes over nothing.
        let tolerances: HashSet<usize> = self.tolerances_at();
        let given = given(self.top, self.folder).into_iter().filter(|(_, at)| !tolerances.contains(at));
        let given: HashSet<String> = given.map(|(name, _)| name).collect();
        let inputs: Vec<usize> = (0..all.len()).filter(|&it| set(&all[it].name) && !given.contains(&all[it].name)).collect();
        if inputs.is_empty() {
            let message = "axis \"preset\": everything that these presets set is set elsewhere in the study; drop the axis";
            problems.add(entry.key_at, message);
            return None;
        }
        let (mut rows, mut known) = (Vec::new(), HashMap::new());
        for (name, preset) in names.iter().zip(&presets) {
            let value = |&input: &usize| {
                let change = preset.changes.iter().find(|(changed, _)| *changed == all[input].name);
                change.map_or(self.base[input], |(_, value)| *value)
            };
            let row: Vec<f64> = inputs.iter().map(value).collect();
            if let Some(same) = known.insert(row.iter().map(|it| it.to_bits()).collect::<Vec<_>>(), name) {
                let what = "everything in which they differ is set elsewhere in the study";
                problems.add(entry.key_at, format!("axis \"preset\": \"{same}\" and \"{name}\" are the same here, as {what}; drop one"));
            }
            rows.push(row);
        }
        for &input in &inputs {
            self.claims.borrow_mut().push(AxisClaim { input, role, at: entry.key_at, single: false, word: None });
        }
        rows.iter().for_each(|row| self.mark_words(&inputs, row));
        if role == AxisRole::Design {
            if self.label(PRESET).is_some() {
                let message = "label \"preset\": the axis over presets has this label already; drop it from labels";
                problems.add(self.declared[self.label(PRESET)?].at, message);
                return None;
            }
            self.labels.borrow_mut().push(Label { name: PRESET.to_owned(), axis: number, texts: names });
        }
        (problems.count() == before).then_some(Axis::Joint { inputs, rows })
    }
}
