//! `labels`: text columns of catalogues that the study wants to be carried along.

use super::super::label::{Label, MOST_LABELS, flaw_of_name, flaw_of_text};
use super::table::{Problems, TomlNode, TomlTable, shortened};
use super::{Reader, text};
use crate::models::Model;
use std::cell::Cell;

/// A label that the study declares.
pub(super) struct DeclaredLabel {
    pub(super) name: String,
    /// Byte in the study file.
    pub(super) at: usize,
    /// Does some axis have it?
    pub(super) is_given: Cell<bool>,
}

/// The labels that the study declares, each once.
pub(super) fn read_labels(top: &TomlTable<'_>, problems: &Problems<'_>) -> Vec<DeclaredLabel> {
    let Some(entry) = top.get("labels") else { return Vec::new() };
    let Some(nodes) = entry.node.list() else {
        let found = entry.node.found();
        problems.add(entry.node.at, format!("labels: found {found}, wanted a list of columns such as [\"part_no\"]"));
        return Vec::new();
    };
    let mut labels: Vec<DeclaredLabel> = Vec::new();
    for node in nodes.take_while(|_| !problems.is_full()) {
        let Some(name) = text(node, problems, "labels") else { continue };
        if labels.iter().any(|it| it.name == name) {
            problems.add(node.at, format!("labels: \"{}\" is listed twice; drop one", shortened(&name)));
        } else if labels.len() == MOST_LABELS {
            problems.add(node.at, format!("labels: there are more than {MOST_LABELS}; drop some"));
            break;
        } else {
            labels.push(DeclaredLabel { name, at: node.at, is_given: Cell::new(false) });
        }
    }
    labels
}

/// Reports labels whose names cannot be those of a column.
pub(super) fn check_label_names(labels: &[DeclaredLabel], model: &Model, problems: &Problems<'_>) {
    for label in labels {
        if let Some(flaw) = flaw_of_name(&label.name, model) {
            problems.add(label.at, format!("label \"{}\": {flaw}", shortened(&label.name)));
        }
    }
}

impl Reader<'_> {
    /// The number of the declared label of that name.
    pub(super) fn label(&self, name: &str) -> Option<usize> {
        self.declared.iter().position(|label| label.name == name)
    }

    /// Takes note that an axis has this label; an error if another axis has it too.
    pub(super) fn claim_label(&self, number: usize) -> Result<(), String> {
        let DeclaredLabel { name, is_given, .. } = &self.declared[number];
        if is_given.replace(true) {
            return Err(format!(
                "the label \"{}\" has a column already; a label belongs to one axis, rename one of the two",
                shortened(name)
            ));
        }
        Ok(())
    }

    /// The text that a row of the study gives a label.
    pub(super) fn label_text(&self, node: TomlNode<'_>, name: &str, axis: &str) -> Option<String> {
        let Some(text) = node.value.as_str() else {
            let (name, found) = (shortened(name), node.found());
            self.problems.add(node.at, format!("{axis}: label \"{name}\": found {found}; a label is a text, write it in quotes"));
            return None;
        };
        let flaw = flaw_of_text(text);
        if let Some(flaw) = &flaw {
            self.problems.add(node.at, format!("{axis}: label \"{}\": {flaw}", shortened(name)));
        }
        flaw.is_none().then(|| text.to_owned())
    }

    /// Keeps the labels of design axis number `axis`, in the order in which the study declares them.
    pub(super) fn keep_labels(&self, axis: usize, mut columns: Vec<(usize, Vec<String>)>) {
        columns.sort_by_key(|(number, _)| *number);
        let label = |(number, texts): (usize, Vec<String>)| Label { name: self.declared[number].name.clone(), axis, texts };
        self.labels.borrow_mut().extend(columns.into_iter().map(label));
    }

    /// Reports labels that no axis has. What could not be read may have them.
    pub(super) fn check_labels(&self) {
        if self.unread.get() {
            return;
        }
        // A name that no label can have is told already.
        let missing = self.declared.iter().filter(|it| !it.is_given.get() && flaw_of_name(&it.name, self.model).is_none());
        for DeclaredLabel { name, at, .. } in missing {
            let name = shortened(name);
            self.problems.add_if_complete(
                *at,
                format!(
                    "label \"{name}\": no cases of [design] have such a column; name a column of their CSV file, or drop it from labels"
                ),
            );
        }
    }
}
