//! What fresh draws say of the whole front.

use super::Certified;
use crate::certify::Row;
use crate::probability::simultaneous;
use crate::study::{ConfirmedEnd, Constraint, Quantity, StatisticKind, number};
use serde_json::{Value, json};

/// Confidence with which the lower ends of all designs of the front hold together.
const TOGETHER: f64 = 0.99;

/// Most designs that miss the wanted yield that are named in `summary.json`.
const MOST_NAMED: usize = 1000;

/// The front of a study with distributions as fresh draws judge it.
#[derive(Clone, Debug, PartialEq)]
pub struct Confirmed {
    /// Fresh draws.
    pub draws: u64,
    /// Designs of the front.
    pub designs: u64,
    /// The yield that the study asks for, and how many of the designs have it in these draws too.
    pub wanted: Option<(f64, u64)>,
    /// Those that do not have it, with the share that holds: they stay on the front, and are marked.
    pub missing: Vec<(u64, f64)>,
    /// With 99 % confidence the yields of all of them are at least this.
    pub together: f64,
}

impl Confirmed {
    /// Of an outcome; `None` without distributions or without a front.
    pub fn of(outcome: &Certified<'_>) -> Option<Self> {
        let study = &outcome.plan.study;
        let probability = study.probability.as_ref()?;
        let kind = |quantity: Quantity| Some(probability.statistics[quantity.output()?].kind);
        let column = outcome.columns.iter().position(|it| kind(it.quantity) == Some(StatisticKind::Confirmed(ConfirmedEnd::Share)))?;
        let share = |row: &Row| row.columns[column].value.unwrap_or(0.0);
        let designs = outcome.front.len() as u64;
        let low = |row: &Row| {
            let holds = (share(row) * probability.confirm as f64).round() as u64;
            simultaneous(holds, probability.confirm, TOGETHER, designs).map_or(0.0, |it| it.low)
        };
        // Where the yield is an objective alone, one draw must hold, which is no wanted yield.
        let is_wanted = |it: &&Constraint| kind(it.quantity) == Some(StatisticKind::Yield) && it.low.is_none_or(|low| low.0 > 0.0);
        let asked = study.constraints.iter().find(is_wanted);
        let misses = |row: &&Row| asked.is_some_and(|it| !it.holds(share(row)));
        let missing: Vec<(u64, f64)> = outcome.front.iter().filter(misses).map(|row| (row.index, share(row))).collect();
        let wanted = asked.map(|it| (it.low.map_or(0.0, |it| it.0), designs - missing.len() as u64));
        let together = outcome.front.iter().map(low).reduce(f64::min)?;
        Some(Self { draws: probability.confirm, designs, wanted, missing, together })
    }

    /// For `summary.json`.
    pub(super) fn to_json(&self) -> Value {
        let mut told = json!({ "draws": self.draws, "designs": self.designs, "least_yield_together_99": number(self.together) });
        if let Some((wanted, kept)) = self.wanted {
            told["wanted"] = number(wanted);
            told["keep_it"] = kept.into();
        }
        if !self.missing.is_empty() {
            told["miss_it"] = self.missing.iter().take(MOST_NAMED).map(|it| it.0).collect();
        }
        told
    }
}
