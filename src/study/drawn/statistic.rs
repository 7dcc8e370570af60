//! What is asked of the draws: shares that hold, and statistics of quantities.

use super::super::quantity::Quantity;
use super::super::resolved::Constraint;
use super::super::spectrum::OverScenarios;
use crate::models::{Model, Worse};
use serde::{Deserialize, Serialize};

/// What becomes of a quantity's values over the draws.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OverDraws {
    /// The mean of all draws.
    Mean,
    /// The standard deviation of these draws themselves.
    Sd,
    /// The worst of these draws, which is no bound.
    Worst,
    /// What this share of the draws is at least as good as.
    Quantile(f64),
}

impl OverDraws {
    /// The end of a column's name: `_draw_q99_9` for the quantile 0.999.
    pub fn suffix(self) -> String {
        match self {
            Self::Mean => "_draw_mean".to_owned(),
            Self::Sd => "_draw_sd".to_owned(),
            Self::Worst => "_draw_worst".to_owned(),
            Self::Quantile(share) => format!("_draw_q{}", percent(share).replace('.', "_")),
        }
    }

    /// The worse end of the statistic of a quantity with this worse end: of levels, the worst is the one whose draws differ most.
    pub fn worse(self, of_quantity: Worse) -> Worse {
        if self == Self::Sd { Worse::Higher } else { of_quantity }
    }

    /// In words.
    pub fn words(self) -> String {
        match self {
            Self::Mean => "mean over the draws".to_owned(),
            Self::Sd => "standard deviation over the draws".to_owned(),
            Self::Worst => "worst of the draws".to_owned(),
            Self::Quantile(share) => format!("value that {} % of the draws are at least as good as", percent(share)),
        }
    }
}

/// A share in per cent, as short as it can be: `99.9`.
fn percent(share: f64) -> String {
    let exact = share * 100.0;
    // 0.999 is 99.9 per cent, whatever the product rounds to.
    let short = format!("{exact:.10}");
    short.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A quantity over the operating cases.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AskedQuantity {
    /// Of the drive.
    pub quantity: Quantity,
    /// What becomes of its values over the operating cases.
    pub over: OverScenarios,
    /// Its worse end: over the cases, the draws and the levels.
    pub worse: Worse,
}

/// One output of a study with distributions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Statistic {
    /// Name of the output.
    pub name: String,
    /// What it is.
    pub kind: StatisticKind,
}

/// What a statistic is of.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StatisticKind {
    /// The share of draws that hold, of those that choose designs.
    Yield,
    /// What is told of chosen designs: by fresh draws, or proven.
    Confirmed(ConfirmedEnd),
    /// The share of draws that keep this constraint in all cases.
    YieldOf(Constraint),
    /// A quantity that does not depend on the draws.
    Plain(AskedQuantity),
    /// A quantity over the draws.
    Over(AskedQuantity, OverDraws),
}

/// What is told of the yield of designs that were chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ConfirmedEnd {
    /// The share that holds.
    Share,
    /// The lower end of its interval, 95 %.
    Low,
    /// The upper end.
    High,
    /// The lower one of two proven bounds of the yield, which no draws have a part in.
    AtLeast,
    /// The upper one.
    AtMost,
    /// The standard error of the share of the draws that choose, from replicates of a Latin hypercube or of Sobol points; none where all
    /// replicates agree.
    StandardError,
}

impl ConfirmedEnd {
    /// All of it, in the order of the columns.
    pub const ALL: [Self; 6] = [Self::StandardError, Self::Share, Self::Low, Self::High, Self::AtLeast, Self::AtMost];

    /// Is it proven instead of drawn?
    pub fn is_proven(self) -> bool {
        matches!(self, Self::AtLeast | Self::AtMost)
    }

    /// Name of the column.
    pub fn name(self) -> &'static str {
        match self {
            Self::Share => YIELD,
            Self::Low => "yield_low",
            Self::High => "yield_high",
            Self::AtLeast => "yield_at_least",
            Self::AtMost => "yield_at_most",
            Self::StandardError => "yield_screened_standard_error",
        }
    }
}

/// The reserved name of the share of draws that hold. As a column it is that of fresh draws.
pub const YIELD: &str = "yield";
/// The key that tells what becomes of a quantity over the draws.
pub const OVER_DRAWS: &str = "over_draws";
/// The column of the share of those draws that choose designs.
pub const SCREENED: &str = "yield_screened";
/// Confidence of the interval of a yield.
pub const CONFIDENCE: f64 = 0.95;

impl AskedQuantity {
    /// The name of a statistic of it: `axial_force_N_draw_mean`.
    pub fn name(&self, draws: Option<OverDraws>, model: &Model) -> String {
        let over = self.over.column(self.quantity, model);
        draws.map_or(over.clone(), |draws| over + &draws.suffix())
    }
}

impl StatisticKind {
    /// The quantity that it is of, if it is of one.
    pub fn asked(&self) -> Option<AskedQuantity> {
        match *self {
            Self::Plain(asked) | Self::Over(asked, _) => Some(asked),
            Self::Yield | Self::Confirmed(_) | Self::YieldOf(_) => None,
        }
    }

    /// The quantity of the drive that it reads; whether a draw holds is not one.
    pub fn of(&self) -> Option<Quantity> {
        match *self {
            Self::YieldOf(constraint) => Some(constraint.quantity),
            _ => self.asked().map(|it| it.quantity),
        }
    }

    /// Must there be a value in every draw, or in one at least, for it to have a value? A share always has one.
    pub fn may_be_absent(&self) -> bool {
        self.asked().is_some()
    }
}
