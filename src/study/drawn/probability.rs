//! What a study says of its draws.

use super::super::axis::Axis;
use super::super::quantity::Quantity;
use super::super::resolved::Constraint;
use super::super::spectrum::{Spectrum, unit_over};
use super::confirm::FreshDraws;
use super::lanes::most_kept;
use super::law::LawText;
use super::statistic::{ConfirmedEnd, OverDraws, Statistic, StatisticKind};
use crate::models::Model;
use crate::probability::{Distribution, Draws, Effect, ProbabilityProblem, Sampling};
use crate::table::short;
use crate::tape::Set;
use std::sync::Arc;

/// Replicates of a Latin hypercube or of Sobol points: their differences give the standard error.
pub const REPLICATES: u64 = 16;
/// Most draws that choose, most that judge, and most operating cases of a draw.
pub const MOST_DRAWS: u64 = 10_000_000;
pub const MOST_CONFIRM: u64 = 1_000_000_000;
pub const MOST_CASES: u64 = 100_000;

/// Bytes that it takes to record what depends on what in a formula that fills tables, its loops written out.
const WRITTEN_OUT: u64 = 22_000_000;

/// Uncertain inputs of a study, how they are drawn, and what is asked of the draws.
#[derive(Clone, Debug, PartialEq)]
pub struct Probability {
    /// Inputs with a distribution, in file order.
    pub inputs: Vec<UncertainInput>,
    /// Correlations of pairs of them, by position.
    pub correlation: Vec<(usize, usize, f64)>,
    /// Draws that choose designs.
    pub draws: u64,
    /// Fresh draws that judge what is reported.
    pub confirm: u64,
    /// Seed of both.
    pub seed: u64,
    /// How the draws that choose are spread.
    pub sampling: Sampling,
    /// Uncertainty levels, at each of which all draws are judged.
    pub levels: u64,
    /// Are bounds of the yield to be proven?
    pub enclosure: bool,
    /// The drive that is drawn.
    pub drive: Drive,
    /// The outputs of the study, in their order.
    pub statistics: Vec<Statistic>,
}

/// An input with a distribution.
#[derive(Clone, Debug, PartialEq)]
pub struct UncertainInput {
    /// Number of the input.
    pub input: usize,
    /// Its name.
    pub name: String,
    /// What a drawn number does to the value that the design says.
    pub effect: Effect,
    /// Is the tolerance a part of the model? Then `input` is its factor or addend.
    pub in_model: bool,
    /// The distribution as it is written.
    pub law: LawText,
    /// The distribution.
    pub distribution: Distribution,
}

/// A mean that is this small beside the standard deviation is what rounding leaves of zero.
const ROUNDING: f64 = 1e-12;

impl UncertainInput {
    /// The mean of what is drawn; 0 where numbers that cancel leave a rest of their rounding errors.
    pub(crate) fn mean(&self) -> f64 {
        let mean = self.distribution.mean();
        if mean.abs() < ROUNDING * self.distribution.sd() { 0.0 } else { mean }
    }

    /// The distribution in words: its name, where it is cut off, its mean and standard deviation.
    pub fn in_words(&self) -> String {
        let (mean, sd) = (self.mean(), self.distribution.sd());
        let law = format!("{}{}: mean {}, sd {}", self.law.name(), self.law.cut_in_words(), short(mean), short(sd));
        self.effect.in_words_with(&law)
    }

    /// The distribution as the study gives it: its name, its parameters and where it is cut off.
    pub fn as_given(&self) -> String {
        let law = format!("{} {}{}", self.law.name(), self.law.law.parameters(), self.law.cut_in_words());
        self.effect.in_words_with(&law)
    }

    /// What a drawn number does to the value of `input`.
    pub fn acts(&self) -> Effect {
        if self.in_model { Effect::Is } else { self.effect }
    }
}

/// The drive of a single draw: an ordinary study but for its objectives.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    /// Its model.
    pub model: Arc<Model>,
    /// Operating cases, all of which a draw must survive.
    pub operation: Vec<Axis>,
    /// The operation axis that has weights, if one has.
    pub spectrum: Option<Spectrum>,
    /// Constraints that a draw must keep to hold.
    pub constraints: Vec<Constraint>,
}

impl Drive {
    /// The unit of what a constraint is on, as text.
    pub fn unit_of(&self, constraint: &Constraint) -> String {
        unit_over(constraint.quantity, constraint.over, &self.model, self.spectrum.as_ref())
    }
}

impl Probability {
    /// What a study file could not have said.
    pub(super) fn flaw(&self) -> Option<String> {
        let Drive { operation, spectrum, .. } = &self.drive;
        if self.draws > MOST_DRAWS || self.confirm > MOST_CONFIRM {
            return Some(format!("there are {} and {} draws, at most {MOST_DRAWS} and {MOST_CONFIRM}", self.draws, self.confirm));
        }
        let cases = operation.iter().map(Axis::count).try_fold(1, u64::checked_mul);
        if cases.is_none_or(|cases| cases > MOST_CASES) {
            return Some(format!("a draw has more than {MOST_CASES} operating cases"));
        }
        let fits = |it: &Spectrum| operation.get(it.axis).is_some_and(|axis| axis.count() == it.weights.len() as u64);
        spectrum.as_ref().is_some_and(|it| !fits(it)).then(|| "the weights do not fit the operating cases".to_owned())
    }

    /// Is it the share of the draws that hold, or that keep one constraint?
    pub(crate) fn is_share(&self, quantity: Quantity) -> bool {
        let kind = quantity.output().map(|it| self.statistics[it].kind);
        matches!(kind, Some(StatisticKind::Yield | StatisticKind::YieldOf(_)))
    }

    /// What is told of chosen designs by this output, if it is of that kind.
    pub fn confirmed(&self, quantity: Quantity) -> Option<ConfirmedEnd> {
        match self.statistics.get(quantity.output()?)?.kind {
            StatisticKind::Confirmed(end) => Some(end),
            _ => None,
        }
    }

    /// Evaluations of the drive for one design at one level.
    pub fn evaluations(&self) -> u64 {
        self.drive.operation.iter().map(Axis::count).fold(self.draws, u64::saturating_mul)
    }

    /// Bytes that the draws take on so many threads, which judge so many designs at a time by these of the statistics. What the draws of a
    /// single design take besides, the footprint of its kernel tells.
    pub(crate) fn bytes(&self, threads: u64, designs: u64, used: Set) -> u64 {
        let inputs = self.inputs.len() as u64;
        let own = 8 * inputs * (self.draws + FreshDraws::kept(self.confirm, inputs));
        let needs_all = |it: &Statistic| matches!(it.kind, StatisticKind::Over(_, OverDraws::Sd | OverDraws::Quantile(_)));
        let all = self.statistics.iter().enumerate().filter(|(number, it)| used.contains(*number) && needs_all(it)).count() as u64;
        let has_tables = self.drive.model.kernel.formula().is_some_and(|it| !it.fields().tables.is_empty());
        own + threads * 8 * most_kept(self.draws, all, designs) + if has_tables { WRITTEN_OUT } else { 0 }
    }

    /// The draws that choose.
    ///
    /// # Errors
    /// As [`Draws::new`] and [`Draws::correlated`].
    pub fn choosing(&self) -> Result<Draws, ProbabilityProblem> {
        let inputs: Vec<_> = self.inputs.iter().map(|it| (it.name.as_str(), it.distribution.clone())).collect();
        let pairs: Vec<_> = self.correlation.iter().map(|&(a, b, value)| (inputs[a].0, inputs[b].0, value)).collect();
        Draws::new(&inputs, self.draws, self.sampling, self.seed)?.correlated(&pairs)
    }

    /// Fresh draws that judge what the others have chosen.
    ///
    /// # Errors
    /// As [`Probability::choosing`].
    pub fn confirming(&self) -> Result<Draws, ProbabilityProblem> {
        self.choosing()?.confirming(self.confirm)
    }
}
