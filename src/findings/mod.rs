//! What a person should know of an outcome besides its numbers: what stands in the way where nothing is feasible, and by how much; where
//! the front stands on the ends of axes; which quantities fall below zero and no constraint forbids it.

mod exact;
mod front;
mod infeasible;
mod reached;

pub use front::{BelowZero, FrontEnd};
pub use infeasible::{Infeasible, Nearest, Reach};
pub use reached::Reached;

use crate::certify::Row;
use crate::error::Result;
use crate::plan::Plan;
use crate::screen::Control;
use crate::study::{Axis, Study, number, value_of};
use crate::table::short;
use serde_json::{Map, Value, json};

/// What is worth knowing of an outcome. All of it is empty for most.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Findings {
    /// How far off feasibility is, if nothing is feasible.
    pub infeasible: Option<Infeasible>,
    /// Ends of design axes on which half of the front or more stands.
    pub ends: Vec<FrontEnd>,
    /// Quantities that fall below zero on the front without a constraint.
    pub below_zero: Vec<BelowZero>,
}

impl Findings {
    /// Looks at an outcome. Everything is computed in f64 from the study and its front alone, so it is the same however the study was
    /// judged.
    ///
    /// # Errors
    /// [`Error::Stopped`](crate::error::Error::Stopped) after `control.stop`.
    pub fn of(plan: &Plan, feasible: u64, front: &[Row], threads: usize, control: &Control) -> Result<Self> {
        if feasible == 0 {
            return Ok(Self { infeasible: Some(Infeasible::of(plan, threads, control)?), ..Self::default() });
        }
        let below_zero = front::below_zero(plan, front, threads, control)?;
        Ok(Self { infeasible: None, ends: front::ends(plan, front), below_zero })
    }

    /// Is there nothing to say?
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// One sentence per finding, the most important first.
    pub fn in_words(&self, study: &Study) -> Vec<String> {
        let infeasible = self.infeasible.iter().flat_map(|it| it.in_words(study));
        let below = self.below_zero.iter().map(|it| it.in_words(study));
        let ends = self.ends.iter().map(|it| it.in_words(study));
        infeasible.chain(below).chain(ends).collect()
    }

    /// As it stands in `summary.json`.
    pub fn to_json(&self, study: &Study) -> Value {
        let mut json = json!({ "in_words": self.in_words(study) });
        if let Some(infeasible) = &self.infeasible {
            json["infeasible"] = infeasible.to_json(study);
        }
        if !self.ends.is_empty() {
            json["front_at_ends"] = self.ends.iter().map(|it| it.to_json(study)).collect();
        }
        if !self.below_zero.is_empty() {
            json["below_zero"] = self.below_zero.iter().map(|it| it.to_json(study)).collect();
        }
        json
    }
}

/// The inputs that design axes set, by name, from a row of all inputs in their units.
fn design_inputs(study: &Study, inputs: &[f64]) -> Map<String, Value> {
    let chosen = study.design.iter().flat_map(Axis::inputs);
    chosen.map(|&input| (study.model.inputs[input].name.clone(), value_of(&study.model, input, inputs[input]))).collect()
}

/// The same in words.
fn design_in_words(study: &Study, inputs: &[f64]) -> String {
    let each = study.design.iter().flat_map(Axis::inputs).map(|&input| {
        let table = &study.model.inputs[input];
        format!("{} {}", table.name, table.word_for(inputs[input]).map_or_else(|| short(inputs[input]), str::to_owned))
    });
    each.collect::<Vec<_>>().join(", ")
}

/// A number that may be missing.
fn number_or_null(value: Option<f64>) -> Value {
    value.map_or(Value::Null, number)
}
