//! Tolerances that are part of a model: the study's formulas change what the design says by a factor or an addend of its own.
//!
//! Of an input `NAME` with such a tolerance there are: what the design says, `nominal(NAME)`, an input that is called `NAME` or what a
//! formula gives; the factor or addend, an input; and a formula that gives the model `NAME` from both.

use super::source::{Extension, FormulaSource};
use crate::formula::nominal_name;
use crate::probability::Effect;

/// What the factor or addend of an input is called.
fn change_name(of: &str, effect: Effect) -> String {
    match effect {
        Effect::Is => of.to_owned(),
        Effect::Times => format!("{of}_times"),
        Effect::Plus => format!("{of}_plus"),
    }
}

/// The output that is the value of an input as it is built.
fn built_name(of: &str) -> String {
    format!("{of}_built")
}

/// A tolerance that is part of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModelTolerance<'n> {
    /// The input that has it.
    pub of: &'n str,
    /// What is done to what the design says.
    pub effect: Effect,
}

impl ModelTolerance<'_> {
    /// Name of the input that is its factor or addend.
    pub fn change(self) -> String {
        change_name(self.of, self.effect)
    }

    /// Names that nothing else may have: of the factor or addend, and of the value as built.
    pub fn names(self) -> [String; 2] {
        [self.change(), built_name(self.of)]
    }
}

impl Extension {
    /// Is what the design says of this input told apart from what is built?
    pub fn has_nominal(&self, of: &str) -> bool {
        let nominal = nominal_name(of);
        self.is_nominal_set(of) || self.formulas.iter().any(|it| it.name == nominal)
    }

    /// The same, where no formula gives what the design says.
    pub fn is_nominal_set(&self, of: &str) -> bool {
        self.variables.contains(&nominal_name(of))
    }

    /// The tolerance of which a variable is the factor or addend.
    pub fn tolerance_of<'n>(&self, variable: &'n str) -> Option<ModelTolerance<'n>> {
        let named = |effect: Effect, end: &str| variable.strip_suffix(end).map(|of| ModelTolerance { of, effect });
        let found = [named(Effect::Times, "_times"), named(Effect::Plus, "_plus")].into_iter().flatten();
        found.into_iter().find(|it| self.has_nominal(it.of))
    }

    /// What the output is called that a formula gives: an input keeps its name for what the design says of it.
    pub fn output_name(&self, formula: &str) -> String {
        if self.is_nominal_set(formula) { built_name(formula) } else { formula.to_owned() }
    }

    /// Makes a tolerance part of it.
    pub fn add_tolerance(&mut self, tolerance: ModelTolerance<'_>) {
        let (of, nominal) = (tolerance.of, nominal_name(tolerance.of));
        let sign = if tolerance.effect == Effect::Times { "*" } else { "+" };
        let built = FormulaSource::plain(of, format!("{nominal} {sign} {}", tolerance.change()));
        let built = match self.formulas.iter_mut().find(|it| it.name == of) {
            // What is said of the formula for people is said of what it comes to in the end.
            Some(own) => {
                let FormulaSource { text, integer, .. } = own.clone();
                let hidden = FormulaSource { name: nominal, text, integer, hidden: true, ..FormulaSource::default() };
                let said = std::mem::replace(own, hidden);
                FormulaSource { text: built.text, integer: false, ..said }
            }
            None => {
                match self.variables.iter_mut().find(|it| *it == of) {
                    Some(variable) => *variable = nominal,
                    None => self.variables.push(nominal),
                }
                FormulaSource { doc: format!("{of} as it is built: what the design says, with its tolerance."), ..built }
            }
        };
        self.formulas.push(built);
        self.variables.push(tolerance.change());
    }
}
