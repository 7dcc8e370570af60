//! A drive drawn many times: its draws, its operating cases, and what is asked of them.

use super::super::quantity::Quantity;
use super::super::resolved::Constraint;
use super::cases::OperatingCases;
use super::confirm::FreshDraws;
use super::statistic::Statistic;
use crate::models::{Dependencies, Effort, Model, input_to_si};
use crate::probability::Effect;
use crate::tape::{Known, Set};
use std::sync::{Arc, OnceLock};

/// What a draw must keep to hold.
pub struct Requirements(pub Vec<Constraint>);
/// What is asked of the draws, and of which fresh ones.
pub struct Asking(pub Vec<Statistic>, pub Option<FreshDraws>);

/// A drive drawn many times.
pub struct DrawnDrive {
    pub base: Arc<Model>,
    /// Inputs that are drawn, and what a drawn number does to them.
    pub drawn: Vec<(usize, Effect)>,
    /// Of each of them: its draws, in its unit or as factors.
    pub columns: Vec<Vec<f64>>,
    pub cases: OperatingCases,
    pub holds: Vec<Constraint>,
    pub statistics: Vec<Statistic>,
    /// Draws that judge what these have chosen.
    pub(super) fresh: Option<FreshDraws>,
    depends: OnceLock<Dependencies>,
    /// Outputs of the drive that are computed, and conditions that matter for them or for the status.
    pub(super) outputs: Vec<usize>,
    pub(super) conditions: Vec<usize>,
}

impl DrawnDrive {
    /// Draws (a column per drawn input) of a drive in its operating cases.
    pub fn new(
        base: Arc<Model>,
        drawn: Vec<(usize, Effect)>,
        columns: Vec<Vec<f64>>,
        cases: OperatingCases,
        Requirements(holds): Requirements,
        Asking(statistics, fresh): Asking,
    ) -> Self {
        let own = statistics.iter().filter_map(|it| it.kind.of());
        let (outputs, conditions) = needs(&base, holds.iter().map(|it| it.quantity).chain(own));
        let (outputs, conditions) = (outputs.iter().collect(), conditions.iter().collect());
        let depends = OnceLock::new();
        Self { drawn, columns, cases, holds, statistics, fresh, depends, outputs, conditions, base }
    }

    /// What depends on what in the drive, whatever its inputs.
    pub fn depends(&self) -> &Dependencies {
        self.depends.get_or_init(|| self.base.kernel.dependencies(&vec![Known::ANY; self.base.inputs.len()]))
    }

    /// Number of draws.
    pub fn draws(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// How long a thread takes for a design, roughly.
    pub fn effort(&self) -> Effort {
        let each = self.draws() as f64 * self.cases.rows.len() as f64;
        let Effort { prepare, finish } = self.base.effort;
        Effort { prepare: 1e-9, finish: each * (finish + prepare / 64.0) }
    }

    /// The inputs of one draw, given by input, in one case in SI units; false if a drawn value is not one that the input can have.
    pub fn turn(&self, drawn: &dyn Fn(usize) -> f64, case: usize, design: &[f64], si: &mut [f64]) -> bool {
        si.copy_from_slice(design);
        for (&input, &value) in self.cases.inputs.iter().zip(&self.cases.rows[case]) {
            si[input] = input_to_si(&self.base.inputs[input], value);
        }
        let mut fits = true;
        for (number, &(input, effect)) in self.drawn.iter().enumerate() {
            si[input] = self.actual((input, effect), si[input], drawn(number));
            fits &= self.fits(input, si[input]);
        }
        fits
    }

    /// The actual value of an input in SI units, from that of the design and the drawn number.
    pub(super) fn actual(&self, (input, effect): (usize, Effect), nominal: f64, drawn: f64) -> f64 {
        match effect {
            Effect::Times => nominal * drawn,
            Effect::Is => self.base.inputs[input].unit.to_si(drawn),
            Effect::Plus => nominal + self.base.inputs[input].unit.to_si(drawn),
        }
    }

    /// Can the input have this value, in SI units?
    pub fn fits(&self, input: usize, si: f64) -> bool {
        let input = &self.base.inputs[input];
        input.valid.contains(input.unit.from_si(si))
    }

    /// Statistics that may have no value, each of which has a condition.
    pub fn absentees(&self) -> impl Iterator<Item = usize> {
        (0..self.statistics.len()).filter(|&it| self.statistics[it].kind.may_be_absent())
    }
}

/// The outputs of a drive that are needed to know these quantities and the status, and the conditions that matter for either.
pub fn needs(base: &Model, quantities: impl Iterator<Item = Quantity>) -> (Set, Set) {
    let asked: Set = quantities.filter_map(Quantity::output).collect();
    let matters = |number: &usize| {
        let condition = &base.conditions[*number];
        !condition.quiet || condition.invalidates.iter().filter_map(|name| base.output(name)).any(|output| asked.contains(output))
    };
    (asked, (0..base.conditions.len()).filter(matters).collect())
}

/// The margin of the condition that a statistic has a value.
pub(super) fn margin_of(is_present: bool) -> f64 {
    if is_present { 1.0 } else { -1.0 }
}
