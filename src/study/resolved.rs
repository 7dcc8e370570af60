//! The resolved study.

use super::axis::{Axis, Sample};
use super::drawn::{ConfirmedEnd, Drive, Probability};
use super::label::Label;
use super::quantity::Quantity;
use super::sensitivity::SensitivitySpec;
use super::spectrum::{OverScenarios, Spectrum, unit_over};
use crate::models::{Model, Worse};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Direction of an objective.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Goal {
    /// Less is better.
    Min,
    /// More is better.
    Max,
}

impl Goal {
    /// The worse end of the range of values under this goal.
    pub fn worse(self) -> Worse {
        match self {
            Self::Min => Worse::Higher,
            Self::Max => Worse::Lower,
        }
    }

    /// What values are compared by: less is better. The key of a key is the value.
    #[inline]
    pub(crate) fn key(self, value: f64) -> f64 {
        (if self == Self::Min { value } else { -value }) + 0.0
    }
}

/// An objective: a quantity that should be small or large in its worst scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Objective {
    /// What.
    pub quantity: Quantity,
    /// Which way.
    pub goal: Goal,
    /// Values in the same step of this width count as equal for dominance.
    pub resolution: Option<f64>,
    /// What becomes of its values over the scenarios.
    #[serde(default)]
    pub over: OverScenarios,
}

impl Objective {
    /// The name of its column.
    pub fn name(&self, model: &Model) -> String {
        self.over.column(self.quantity, model)
    }
}

/// A constraint: bounds that hold in every scenario; of a mean or sum, in every scenario of the other axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Constraint {
    /// What is bounded.
    pub quantity: Quantity,
    /// Least value, and whether it is itself excluded.
    pub low: Option<(f64, bool)>,
    /// Largest value, and whether it is itself excluded.
    pub high: Option<(f64, bool)>,
    /// What becomes of its values over the scenarios before the bounds are asked.
    #[serde(default)]
    pub over: OverScenarios,
}

impl Constraint {
    /// The name of what is bounded, as its column has it.
    pub fn name(&self, model: &Model) -> String {
        self.over.column(self.quantity, model)
    }

    /// Does the value satisfy the constraint? NaN never does.
    #[inline(always)]
    pub fn holds(&self, value: f64) -> bool {
        let low = self.low.is_none_or(|(bound, excluded)| if excluded { value > bound } else { value >= bound });
        let high = self.high.is_none_or(|(bound, excluded)| if excluded { value < bound } else { value <= bound });
        low && high && !value.is_nan()
    }

    /// The least and the largest finite value that satisfies it. An excluded bound is moved to the next number inside, so that one
    /// inclusive comparison serves both kinds.
    pub(crate) fn ends(&self) -> (f64, f64) {
        let low = self.low.map_or(f64::MIN, |(bound, excluded)| if excluded { bound.next_up() } else { bound });
        let high = self.high.map_or(f64::MAX, |(bound, excluded)| if excluded { bound.next_down() } else { bound });
        (low, high)
    }

    /// Signed distance to the nearest bound, negative outside, in the quantity's unit.
    pub fn margin(&self, value: f64) -> f64 {
        let low = self.low.map_or(f64::INFINITY, |(bound, _)| value - bound);
        let high = self.high.map_or(f64::INFINITY, |(bound, _)| bound - value);
        low.min(high)
    }
}

/// A further column of the tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct ReportColumn {
    /// Of which quantity.
    pub of: Quantity,
    /// What becomes of its values over the scenarios.
    pub over: OverScenarios,
    /// The end that counts as the worst; `None`: that of its objective if it has one, else that of the model.
    pub worst: Option<Worse>,
}

impl From<Quantity> for ReportColumn {
    fn from(of: Quantity) -> Self {
        Self { of, over: OverScenarios::Worst, worst: None }
    }
}

/// The best designs by one quantity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TopSpec {
    /// By which quantity.
    pub by: Quantity,
    /// Which way is best.
    pub goal: Goal,
    /// How many designs, at least 1.
    pub count: usize,
}

/// A histogram of a quantity's worst value over the feasible designs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HistogramSpec {
    /// Of which quantity.
    pub of: Quantity,
    /// Ends of the first and last bin; `None`: taken from the fixed sample.
    pub range: Option<(f64, f64)>,
    /// Number of bins, at least 1.
    pub bins: usize,
}

/// What a cell of a map shows of its designs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Best {
    /// The best worst-scenario value of a quantity over the cell's feasible designs.
    Value(Quantity, Goal),
    /// The share of the cell's designs that are feasible.
    Share,
}

/// A sample of the feasible designs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SampleSpec {
    /// How many designs, at least 1; all feasible ones if there are fewer.
    pub count: usize,
    /// Seed of the random order from which the first ones are taken.
    pub seed: u64,
}

/// The values at which a map has contours of a quantity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Thresholds {
    /// These values, in the quantity's unit.
    At(Vec<f64>),
    /// Every whole number that the quantity rises to somewhere on the map.
    Changes,
}

/// Contours of a map: where the worst value of a quantity over all scenarios reaches a threshold.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContourSpec {
    /// Of which quantity.
    pub of: Quantity,
    /// At which values.
    pub at: Thresholds,
}

/// A map over two design axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MapSpec {
    /// Position of the horizontal axis in `Study::design`.
    pub x: usize,
    /// Position of the vertical axis in `Study::design`.
    pub y: usize,
    /// What is shown.
    pub value: Best,
    /// Its contours, each quantity once, in file order. Only if `x` and `y` are the only design axes with more than one level.
    #[serde(default)]
    pub contours: Vec<ContourSpec>,
}

/// What else to report.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Report {
    /// Further columns of the tables.
    pub columns: Vec<ReportColumn>,
    /// The best designs by one quantity.
    pub top: Option<TopSpec>,
    /// Histograms, in file order.
    pub histograms: Vec<HistogramSpec>,
    /// Maps, in file order.
    pub maps: Vec<MapSpec>,
    /// A sample of the feasible designs.
    #[serde(default)]
    pub sample: Option<SampleSpec>,
    /// Most points that a front may have.
    pub front_budget: u64,
    /// Is every design to be listed, feasible or not?
    #[serde(default)]
    pub variants: bool,
    /// Are all feasible designs to be written?
    #[serde(default)]
    pub feasible: bool,
    /// Which input matters, if that is asked.
    #[serde(default)]
    pub sensitivity: Option<SensitivitySpec>,
}

impl Report {
    /// Quantities whose worst values the sweep must track for the report, with the end that is worst.
    pub(crate) fn followed(&self, study: &Study) -> Vec<(Quantity, Worse)> {
        let top = self.top.iter().map(|top| (top.by, top.goal.worse()));
        let histograms = self.histograms.iter().map(|it| (it.of, worst_end(study, it.of)));
        let maps = self.maps.iter().filter_map(|it| match it.value {
            Best::Value(quantity, goal) => Some((quantity, goal.worse())),
            Best::Share => None,
        });
        top.chain(histograms).chain(maps).collect()
    }

    /// Positions of the design axes over which a map is shown.
    pub(crate) fn axes(&self) -> Vec<usize> {
        self.maps.iter().flat_map(|map| [map.x, map.y]).collect()
    }
}

/// Which end of a quantity's range is the worst: that of its objective if it has one, else that of the model.
pub fn worst_end(study: &Study, quantity: Quantity) -> Worse {
    worst_end_over(study, quantity, OverScenarios::Worst)
}

/// The same of a mean or sum. An objective of the same kind comes first, then any other of the quantity.
pub fn worst_end_over(study: &Study, quantity: Quantity, over: OverScenarios) -> Worse {
    let of_quantity = || study.objectives.iter().filter(|objective| objective.quantity == quantity);
    let objective = of_quantity().find(|objective| objective.over == over).or_else(|| of_quantity().next());
    objective.map_or(quantity.worse(&study.model), |objective| objective.goal.worse())
}

/// A request: which designs to judge, over which scenarios, by what.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// The model.
    pub model: Arc<Model>,
    /// Title for people.
    pub title: String,
    /// Design axes in file order; the last varies fastest in the design index.
    pub design: Vec<Axis>,
    /// Text columns of the rows of joint design axes, carried along into every table of designs.
    pub labels: Vec<Label>,
    /// Sampled designs in place of the product.
    pub sample: Option<Sample>,
    /// Operation axes in file order.
    pub operation: Vec<Axis>,
    /// The operation axis that has weights, if one has.
    pub spectrum: Option<Spectrum>,
    /// Uncertainty axes in file order.
    pub uncertainty: Vec<Axis>,
    /// Inputs with distributions and what is asked of their draws, if there are such. Then operating cases and constraints of single
    /// draws stand there, and the model's outputs are yields and statistics.
    pub probability: Option<Arc<Probability>>,
    /// A value for every input, in its unit: that of `[fixed]`, else the default. Unused if an axis sets the input.
    pub fixed: Vec<f64>,
    /// Constraints in file order.
    pub constraints: Vec<Constraint>,
    /// Objectives in file order.
    pub objectives: Vec<Objective>,
    /// What else to report.
    pub report: Report,
    /// What was left out of catalogues because nothing uses it, in a sentence for each. Told when the study is read, and no part of its
    /// description.
    pub left_out: Vec<String>,
    /// Ranges whose steps end before `to`, in a sentence for each. Told when the study is read, and no part of its description.
    pub short_ranges: Vec<String>,
}

impl Study {
    /// The unit of a quantity's value over the scenarios, as text: that of a sum is multiplied by that of the weights.
    pub fn unit_over(&self, quantity: Quantity, over: OverScenarios) -> String {
        unit_over(quantity, over, &self.model, self.spectrum.as_ref())
    }

    /// What is told of chosen designs by this quantity, if it is of that kind.
    pub fn confirmed(&self, quantity: Quantity) -> Option<ConfirmedEnd> {
        self.probability.as_ref()?.confirmed(quantity)
    }

    /// Is it a proven bound of a yield?
    pub fn is_proven(&self, quantity: Quantity) -> bool {
        self.confirmed(quantity).is_some_and(ConfirmedEnd::is_proven)
    }

    /// The study of a single draw: the drive in its operating cases with the constraints that a draw must keep, and without objectives.
    /// Drawn inputs have their medians, or what the design says. The study itself if nothing is drawn.
    pub fn of_one_draw(&self) -> Self {
        let Some(probability) = &self.probability else { return self.clone() };
        let Drive { model, operation, spectrum, constraints } = probability.drive.clone();
        let report = Report { front_budget: self.report.front_budget, ..Report::default() };
        Self { model, operation, spectrum, constraints, objectives: Vec::new(), report, probability: None, ..self.clone() }
    }

    /// Does an objective or constraint ask for a mean or a sum?
    pub fn decides_by_spectrum(&self) -> bool {
        let objectives = self.objectives.iter().map(|it| it.over);
        objectives.chain(self.constraints.iter().map(|it| it.over)).any(|over| !over.is_worst())
    }

    /// Numbers in a row of a table of designs, at most: of what has a scenario, two.
    pub(crate) fn row_numbers(&self) -> u64 {
        let inputs = self.design.iter().map(|axis| axis.inputs().len()).sum::<usize>();
        let quantities = self.objectives.len() + self.constraints.len() + self.report.columns.len();
        (1 + self.labels.len() + inputs + 2 * quantities) as u64
    }

    /// What the model has to say of this study as a whole.
    pub fn remarks(&self) -> Vec<String> {
        let set_by_axes =
            |input: &usize| self.design.iter().chain(&self.operation).chain(&self.uncertainty).any(|axis| axis.inputs().contains(input));
        let fixed: Vec<_> = (0..self.fixed.len()).map(|input| (!set_by_axes(&input)).then_some(self.fixed[input])).collect();
        self.model.remarks.as_ref().map_or_else(Vec::new, |remarks| remarks(&fixed))
    }
}
