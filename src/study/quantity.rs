//! What studies ask about: inputs and outputs of their model.

use crate::models::{Model, Worse};
use serde::{Deserialize, Serialize};

/// An input or output that a constraint, objective, column or picture uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Number of an input.
    Input(usize),
    /// Number of an output.
    Output(usize),
}

impl Quantity {
    /// Its name, with the unit.
    pub fn name(self, model: &Model) -> &str {
        match self {
            Self::Input(input) => &model.inputs[input].name,
            Self::Output(output) => &model.outputs[output].name,
        }
    }

    /// Its number, if it is an input.
    pub fn input(self) -> Option<usize> {
        if let Self::Input(input) = self { Some(input) } else { None }
    }

    /// Its number, if it is an output.
    pub fn output(self) -> Option<usize> {
        if let Self::Output(output) = self { Some(output) } else { None }
    }

    /// Which end is worse unless an objective or the report says otherwise. For an input it hardly matters; it is the larger one.
    pub fn worse(self, model: &Model) -> Worse {
        match self {
            Self::Input(_) => Worse::Higher,
            Self::Output(output) => model.outputs[output].worse,
        }
    }

    /// Are all its values whole numbers?
    pub fn is_whole(self, model: &Model) -> bool {
        match self {
            Self::Input(input) => model.inputs[input].integer,
            Self::Output(output) => model.outputs[output].integer,
        }
    }
}
