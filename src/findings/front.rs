//! What a front shows of its study: axes that should go on, quantities that nobody bounded.

use crate::certify::{Row, lowest_columns, rows};
use crate::error::Result;
use crate::models::Effort;
use crate::plan::Plan;
use crate::screen::Control;
use crate::study::{Axis, Quantity, Study, number};
use crate::table::{brief, short};
use serde_json::{Value, json};
use std::sync::atomic::Ordering;

/// Most designs of a front that are looked at for values below zero, and the seconds of one thread, by what the model says, that it may take.
const LOOKED_AT: usize = 1000;
const SECONDS: f64 = 0.5;

/// An end of a design axis on which half of the front or more stands.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FrontEnd {
    /// The input.
    pub input: usize,
    /// Is it the upper end?
    pub upper: bool,
    /// The end, in the input's unit.
    pub value: f64,
    /// Designs of the front there.
    pub designs: u64,
    /// Designs of the front.
    pub of: u64,
}

/// A quantity that falls below zero and has no constraint.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct BelowZero {
    /// The quantity.
    pub quantity: Quantity,
    /// Its least value over the designs and scenarios that were looked at, in its unit.
    pub least: f64,
    /// The design that has it.
    pub design: u64,
    /// Designs with a value below zero.
    pub designs: u64,
    /// Designs of the front that were looked at.
    pub of: u64,
}

impl FrontEnd {
    pub(super) fn in_words(&self, study: &Study) -> String {
        let input = &study.model.inputs[self.input];
        let end = if self.upper { "upper" } else { "lower" };
        let who = if self.designs == self.of { "all of it".to_owned() } else { format!("{} of {} designs", self.designs, self.of) };
        format!("the front stands on the {end} end of {}, {} ({who}): a wider range may hold better designs", input.name, short(self.value))
    }

    pub(super) fn to_json(self, study: &Study) -> Value {
        let end = if self.upper { "upper" } else { "lower" };
        json!({
            "of": study.model.inputs[self.input].name, "end": end, "value": number(self.value),
            "designs": self.designs, "front": self.of,
        })
    }
}

impl BelowZero {
    pub(super) fn in_words(&self, study: &Study) -> String {
        let name = self.quantity.name(&study.model);
        let unit = self.quantity.unit(&study.model);
        let least = format!("{} {unit}", brief(self.least));
        format!(
            "{name} falls below zero in {} of {} designs of the front (least {}, design {}), and no constraint forbids it",
            self.designs,
            self.of,
            least.trim_end(),
            self.design
        )
    }

    pub(super) fn to_json(self, study: &Study) -> Value {
        json!({
            "of": self.quantity.name(&study.model), "least": number(self.least), "design_index": self.design,
            "designs": self.designs, "looked_at": self.of,
        })
    }
}

/// Ends of axes on which at least half of the front stands. An end that is also that of the input's valid range is none: nothing lies
/// beyond.
pub(super) fn ends(plan: &Plan, front: &[Row]) -> Vec<FrontEnd> {
    let study = &plan.study;
    let inert = plan.inert_axes();
    let mut found = Vec::new();
    for (number, axis) in study.design.iter().enumerate() {
        let Axis::Single { input, .. } = *axis else { continue };
        let table = &study.model.inputs[input];
        if !axis.is_range() || inert.contains(&number) || table.is_enumeration() {
            continue;
        }
        let (low, high) = axis.ends(0);
        for (value, upper) in [(low, false), (high, true)] {
            let next = if upper { value + 1.0 } else { value - 1.0 };
            let is_limit = match table.integer {
                true => !table.valid.contains(next),
                false => value == if upper { table.valid.high } else { table.valid.low },
            };
            let designs = front.iter().filter(|row| row.inputs[input] == value).count() as u64;
            if low < high && !is_limit && table.word_for(value).is_none() && designs > 0 && 2 * designs >= front.len() as u64 {
                found.push(FrontEnd { input, upper, value, designs, of: front.len() as u64 });
            }
        }
    }
    found
}

/// Quantities without a constraint that fall below zero on the front: objectives, columns of the report, and margins of the model.
///
/// # Errors
/// [`Error::Stopped`](crate::error::Error::Stopped) after `control.stop`.
pub(super) fn below_zero(plan: &Plan, front: &[Row], threads: usize, control: &Control) -> Result<Vec<BelowZero>> {
    let study = &plan.study;
    let model = &study.model;
    // Of other outputs below zero may be as good as above it.
    let margins = (0..model.outputs.len()).filter(|&output| model.outputs[output].name.ends_with("margin")).map(Quantity::Output);
    let named = study.objectives.iter().map(|it| it.quantity).chain(study.report.columns.iter().map(|it| it.of));
    let mut asked: Vec<Quantity> = Vec::new();
    for quantity in named.filter(|it| it.output().is_some()).chain(margins) {
        let is_bounded = study.constraints.iter().any(|it| it.quantity == quantity);
        if !is_bounded && !asked.contains(&quantity) {
            asked.push(quantity);
        }
    }
    if asked.is_empty() || front.is_empty() {
        return Ok(Vec::new());
    }
    let Effort { prepare, finish } = plan.effort();
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count for which the rounding hardly matters")]
    let affordable = (SECONDS / (prepare + finish)) as usize;
    let count = front.len().min(LOOKED_AT).min(affordable.max(1));
    // Evenly over the front, whose designs stand in the order of the first objective.
    let designs: Vec<u64> = (0..count).map(|at| front[at * front.len() / count].index).collect();
    control.reported.fetch_add(count as u64, Ordering::Relaxed);
    let looked_at = rows(plan, &lowest_columns(study, &asked), &designs, threads, control)?;
    let of = |(column, &quantity): (usize, &Quantity)| {
        let values = looked_at.iter().filter_map(|row| Some((row.columns[column].value?, row.index)));
        let below: Vec<(f64, u64)> = values.filter(|(value, _)| *value < 0.0).collect();
        let &(least, design) = below.iter().min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
        Some(BelowZero { quantity, least, design, designs: below.len() as u64, of: count as u64 })
    };
    Ok(asked.iter().enumerate().filter_map(of).collect())
}
