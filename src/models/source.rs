//! What a study, or a model in a file, is made of: formulas, curves, inputs and conditions as they are written.

use super::description::{Input, Preset, Worse};
use crate::formula::{FormulaKind, WrittenFormula};

/// A measured curve as a study gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveSource {
    /// What formulas call it.
    pub name: String,
    /// Name of what its argument is, which says the argument's unit.
    pub x: String,
    /// Name of what its value is.
    pub y: String,
    /// Points, in these units.
    pub points: Vec<(f64, f64)>,
}

/// A formula with what is said of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FormulaSource {
    /// Its name.
    pub name: String,
    /// What it says.
    pub text: String,
    /// The end of its values over scenarios that is shown as the worst, where that is said; else it is the highest.
    pub worst: Option<Worse>,
    /// Must all its values be whole numbers?
    pub integer: bool,
    /// Is it an intermediate value, which only other formulas read?
    pub hidden: bool,
    /// Its symbol; empty if it has none.
    pub symbol: String,
    /// What it is, in a sentence; empty if that is not said.
    pub doc: String,
    /// Where it comes from; empty if that is not said.
    pub source: String,
}

impl FormulaSource {
    /// A formula of which nothing else is said.
    pub fn plain(name: impl Into<String>, text: impl Into<String>) -> Self {
        Self { name: name.into(), text: text.into(), ..Self::default() }
    }

    fn written(&self) -> WrittenFormula {
        let kind = if self.integer { FormulaKind::Whole } else { FormulaKind::Quantity };
        WrittenFormula::new(&self.name, &self.text, kind)
    }
}

/// A condition of a model in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionSource {
    /// The status of a design that fails it.
    pub reason: String,
    /// The formula of its margin.
    pub margin: String,
    /// Must the margin be greater than zero, rather than at least zero?
    pub strict: bool,
    /// Does it leave the status as it is?
    pub quiet: bool,
    /// Outputs that it takes away.
    pub invalidates: Vec<String>,
    /// What it means, in a sentence; empty if that is not said.
    pub doc: String,
}

impl ConditionSource {
    /// What messages call its margin.
    pub fn label(&self) -> String {
        format!("condition \"{}\"", self.reason)
    }
}

/// What a model in a file has besides formulas.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FileSource {
    /// Its name: the file's, without what it ends in.
    pub name: String,
    /// The text of the file.
    pub text: String,
    /// One line on what it computes, where the file says it.
    pub summary: Option<String>,
    /// Where it comes from.
    pub source: Option<String>,
    /// What it does not cover.
    pub limits: Option<String>,
    /// Its inputs besides those of the model that it is based on.
    pub inputs: Vec<Input>,
    /// Its conditions, besides those too.
    pub conditions: Vec<ConditionSource>,
    /// The formulas that are outputs, in this order; `None` if all are that are not hidden.
    pub outputs: Option<Vec<String>>,
    /// Its named sets of inputs.
    pub presets: Vec<Preset>,
}

/// What is added to a model: by a study, or by the file of a model to the model that it is based on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Extension {
    /// Units of its own, such as `EUR`.
    pub units: Vec<String>,
    /// Numbers that axes and fixed values give, and formulas read.
    pub variables: Vec<String>,
    /// Measured curves.
    pub curves: Vec<CurveSource>,
    /// Formulas, in the order of the file.
    pub formulas: Vec<FormulaSource>,
    /// What only the file of a model has.
    pub file: Option<Box<FileSource>>,
}

impl Extension {
    /// Inputs of a model in a file.
    pub fn inputs(&self) -> &[Input] {
        self.file.as_ref().map_or(&[], |file| &file.inputs)
    }

    /// Conditions of a model in a file.
    pub fn conditions(&self) -> &[ConditionSource] {
        self.file.as_ref().map_or(&[], |file| &file.conditions)
    }

    /// All formulas, those of conditions last.
    pub fn written(&self) -> Vec<WrittenFormula> {
        let margin = |it: &ConditionSource| WrittenFormula::new(it.label(), &it.margin, FormulaKind::Margin);
        self.formulas.iter().map(FormulaSource::written).chain(self.conditions().iter().map(margin)).collect()
    }

    /// Numbers of the formulas that are outputs, in the order of the outputs.
    pub fn shown(&self) -> Vec<usize> {
        match self.file.as_ref().and_then(|file| file.outputs.as_ref()) {
            Some(outputs) => outputs.iter().filter_map(|name| self.formulas.iter().position(|it| it.name == *name)).collect(),
            None => (0..self.formulas.len()).filter(|&it| !self.formulas[it].hidden).collect(),
        }
    }

    /// Is it a formula that is no output?
    pub fn hides(&self, name: &str) -> bool {
        let formula = self.formulas.iter().position(|it| it.name == name);
        formula.is_some_and(|formula| !self.shown().contains(&formula))
    }
}
