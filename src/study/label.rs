//! Labels: text columns of catalogues, carried along with the designs and read by no formula.

use super::Study;
use super::axis::Axis;
use crate::models::Model;
use crate::names::YIELDS;

/// Most characters of a label's text.
pub const MOST_LABEL_CHARACTERS: usize = 200;
/// Most labels of a study.
pub const MOST_LABELS: usize = 20;
/// Names that tables of designs use themselves, and endings of such names.
const TAKEN: [&str; 4] = ["design_index", "feasible", "scenario", "status"];
const TAKEN_ENDINGS: [&str; 8] = ["_scenario", "_constrained", "_mean", "_sum", "_value", "_index", "_lowest", "_highest"];

/// A text for every row of a joint design axis, such as part numbers of a catalogue.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// Name of its column in tables.
    pub name: String,
    /// Position of the axis in `Study::design`.
    pub axis: usize,
    /// One text per row of the axis, as it stands in the catalogue.
    pub texts: Vec<String>,
}

impl Study {
    /// The labels of one of the study's own design axes.
    pub(crate) fn labels_of(&self, axis: &Axis) -> impl Iterator<Item = &Label> {
        let number = self.design.iter().position(|it| std::ptr::eq(it, axis));
        self.labels.iter().filter(move |it| Some(it.axis) == number)
    }
}

/// Why a label cannot have this name; the sentence follows the name.
pub fn flaw_of_name(name: &str, model: &Model) -> Option<String> {
    let is_plain = |name: &str| {
        name.starts_with(|c: char| c.is_ascii_alphabetic())
            && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
            && name.len() <= 80
    };
    if !is_plain(name) {
        return Some("a label's name has letters, digits and _, begins with a letter and is no longer than 80; rename it".to_owned());
    }
    let is_taken = TAKEN.contains(&name) || YIELDS.contains(&name);
    if is_taken || TAKEN_ENDINGS.iter().any(|ending| name.ends_with(ending)) {
        return Some("tables have columns of such names themselves; rename it".to_owned());
    }
    let is_formula = model.formulas().iter().any(|(formula, _)| *formula == name);
    let what = match () {
        () if model.input(name).is_some() => "an input or a variable",
        () if is_formula => "a formula",
        () if model.output(name).is_some() => "an output",
        () => return None,
    };
    Some(format!("it is {what} too, whose values are numbers; rename the label, or drop it from labels"))
}

/// Why a label cannot have this text; the sentence follows the name.
pub fn flaw_of_text(text: &str) -> Option<String> {
    if text.chars().any(char::is_control) {
        return Some("the text has a line end or another control character; write it on one line".to_owned());
    }
    let long = text.chars().nth(MOST_LABEL_CHARACTERS).is_some();
    long.then(|| format!("the text has {} characters, at most {MOST_LABEL_CHARACTERS} are carried along; shorten it", text.chars().count()))
}
