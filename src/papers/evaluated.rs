//! A model with inputs, asked by name.

use crate::models::{Model, Status, evaluate, find};
use std::sync::Arc;

/// Inputs of a model.
#[derive(Clone)]
pub(super) struct Inputs {
    pub model: Arc<Model>,
    pub values: Vec<f64>,
}

impl Inputs {
    /// The defaults of a model, which are its paper's data as far as it prints them.
    pub fn of(model: &str) -> Self {
        let model = find(model).expect("there is such a model");
        Self { values: model.defaults(), model }
    }

    /// A preset of a model.
    pub fn preset(model: &str, preset: &str) -> Self {
        let model = find(model).expect("there is such a model");
        Self { values: model.preset(preset).expect("the model has it"), model }
    }

    /// The same with these values, in the inputs' units.
    pub fn with(&self, changes: &[(&str, f64)]) -> Self {
        let mut changed = self.clone();
        for (name, value) in changes {
            changed.values[self.model.input(name).expect("the model has this input")] = *value;
        }
        changed
    }

    /// The same with a word for an input.
    pub fn with_word(&self, name: &str, word: &str) -> Self {
        let input = self.model.input(name).expect("the model has this input");
        self.with(&[(name, self.model.inputs[input].value_of(word).expect("the input has this word"))])
    }

    pub fn input(&self, name: &str) -> f64 {
        self.values[self.model.input(name).expect("the model has this input")]
    }

    /// Every output by name.
    pub fn outputs(&self) -> Outputs {
        let evaluation = evaluate(&self.model, &self.values);
        Outputs { model: self.model.clone(), status: evaluation.status, values: evaluation.outputs }
    }

    /// One output that must have a value.
    pub fn output(&self, name: &str) -> f64 {
        self.outputs().get(name)
    }

    /// A column of the values along the belt.
    pub fn column(&self, name: &str) -> Vec<f64> {
        let profile = self.model.along_the_belt(&self.values).expect("the model has values along the belt");
        let at = profile.columns.iter().position(|column| column.name == name).expect("there is such a column");
        profile.rows.iter().map(|row| row[at]).collect()
    }
}

/// Outputs of a model.
pub(super) struct Outputs {
    model: Arc<Model>,
    pub status: Status,
    values: Vec<Option<f64>>,
}

impl Outputs {
    /// An output, absent where it has no meaning.
    pub fn find(&self, name: &str) -> Option<f64> {
        self.values[self.model.output(name).expect("the model has this output")]
    }

    /// An output that must have a value.
    pub fn get(&self, name: &str) -> f64 {
        self.find(name).unwrap_or_else(|| panic!("{name} of {}: {}", self.model.name, self.status.reason(&self.model)))
    }
}
