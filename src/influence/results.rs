//! What was found: shares of the variance, effects, a tornado.

use super::subject::{InfluenceSubject, QuantityAsked};
use crate::error::Result;
use crate::probability::{Replicated, replicated};
use crate::sensitivity::Effects;
use crate::study::{InfluenceOver, TOGETHER};
use crate::table::short;

/// Standard errors on either side of an estimate that hold the truth with 95 %, if its error comes from 16 replicates: the 0.975 quantile
/// of Student's t with 15 degrees of freedom (`scipy.stats.t.ppf(0.975, 15)`).
const OF_REPLICATES: f64 = 2.131_449_545_559_323;
/// The same for 64 orders, 63 degrees of freedom.
const OF_ORDERS: f64 = 1.998_340_542_520_741_4;

/// A share, with how far off it may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The share.
    pub value: f64,
    /// Half the width of its interval of 95 % confidence; `None` where it is counted, or where the replicates all agree.
    pub confidence: Option<f64>,
}

impl Estimate {
    /// A share that is counted.
    pub(super) fn exact(value: f64) -> Self {
        Self { value, confidence: None }
    }

    /// A share that replicates gave.
    pub(super) fn of_replicated(it: Replicated) -> Self {
        Self { value: it.mean, confidence: it.standard_error.map(|error| OF_REPLICATES * error) }
    }

    /// The same with what the orders of the factors differ by, if it is from some orders only.
    pub(super) fn with_orders(self, error: f64, orders: Option<usize>) -> Self {
        if orders.is_none() {
            return self;
        }
        Self { confidence: Some(libm::hypot(self.confidence.unwrap_or(0.0), OF_ORDERS * error)), ..self }
    }
}

/// The mean of replicates with its interval.
pub(super) fn of_replicates(values: &[f64]) -> Result<Estimate> {
    Ok(Estimate::of_replicated(replicated(values)?))
}

/// A counted share, from all orders of the factors or from some.
pub(super) fn of_orders((value, error): (f64, f64), orders: Option<usize>) -> Estimate {
    Estimate::exact(value).with_orders(error, orders)
}

/// How the shares were found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InfluenceMethod {
    /// Counted over all combinations of levels.
    Grid {
        /// How many there are.
        combinations: u64,
    },
    /// Estimated.
    Draws {
        /// Draws in each set.
        draws: u64,
        /// Sets of draws.
        sets: u64,
        /// Their seed.
        seed: u64,
        /// Do inputs have correlations? Then there are Shapley effects only.
        correlated: bool,
    },
    /// There are too many factors for either: they were only screened.
    Screening,
}

/// What is said of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum QuantityVerdict {
    /// Shares of its variance.
    Shares,
    /// It does not vary.
    Constant {
        /// Its value.
        value: f64,
    },
    /// It has no value in some combinations or draws, so that it has no variance.
    Absent {
        /// How many.
        absent: u64,
        /// Of how many.
        of: u64,
    },
    /// Nothing: there are too many factors.
    None,
}

/// Everything that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct InfluenceReport {
    /// Which inputs vary.
    pub over: InfluenceOver,
    /// The design whose uncertainty was looked at.
    pub design: Option<u64>,
    /// Title of the study.
    pub title: String,
    /// Scenarios in each of which every combination was looked at.
    pub scenarios: u64,
    /// How the shares were found.
    pub method: InfluenceMethod,
    /// Orders of the factors that Shapley effects come from, if not all.
    pub orders: Option<usize>,
    /// Over the design: combinations of the grid on which designs that hold were looked for, and how many hold.
    pub held_grid: Option<(u64, u64)>,
    /// Walks of the screening, if there was one.
    pub walks: Option<u64>,
    /// Of each quantity.
    pub quantities: Vec<QuantityReport>,
}

/// What was found of a quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct QuantityReport {
    /// The quantity.
    pub asked: QuantityAsked,
    /// What can be said of it.
    pub verdict: QuantityVerdict,
    /// Mean over all combinations or draws.
    pub mean: Option<f64>,
    /// Standard deviation of the same.
    pub sd: Option<f64>,
    /// Over the designs that hold.
    pub within: Option<WithinHolding>,
    /// Of each factor, in their order.
    pub inputs: Vec<InputReport>,
    /// Each factor alone, if one design was looked at.
    pub tornado: Option<TornadoReport>,
}

/// A quantity over the designs that hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WithinHolding {
    /// Its mean.
    pub mean: f64,
    /// Its standard deviation.
    pub sd: f64,
}

/// What a factor does to a quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct InputReport {
    /// The factor.
    pub name: String,
    /// First-order Sobol index: the share of the variance that goes if this factor alone is known.
    pub first: Option<Estimate>,
    /// Total Sobol index: the share that stays if all others are known.
    pub total: Option<Estimate>,
    /// Shapley effect, as a share of the variance: those of all factors add up to 1.
    pub shapley: Option<Estimate>,
    /// The same over the designs that hold.
    pub within: Option<Estimate>,
    /// Effects of steps, after Morris.
    pub screening: Option<Effects>,
}

/// Each factor alone, the others in the middle.
#[derive(Clone, Debug, PartialEq)]
pub struct TornadoReport {
    /// The quantity with all factors in the middle.
    pub middle: Option<f64>,
    /// Of each factor.
    pub bars: Vec<TornadoBar>,
}

/// A factor from end to end.
#[derive(Clone, Debug, PartialEq)]
pub struct TornadoBar {
    /// The factor.
    pub name: String,
    /// Its low end: the lowest level, or the 5 % quantile.
    pub low: String,
    /// Its high end: the highest level, or the 95 % quantile.
    pub high: String,
    /// The quantity at the low end.
    pub at_low: Option<f64>,
    /// The quantity at the high end.
    pub at_high: Option<f64>,
}

impl TornadoBar {
    /// The ends as a person reads them: numbers with six digits.
    pub fn ends(&self) -> [String; 2] {
        let part = |part: &str| part.parse().map_or_else(|_| part.to_owned(), short);
        [&self.low, &self.high].map(|end| end.split(TOGETHER).map(part).collect::<Vec<_>>().join(TOGETHER))
    }

    /// How far apart the quantity is at the ends; without a value at one of them that is more than any.
    pub fn width(&self) -> f64 {
        self.at_low.zip(self.at_high).map_or(f64::INFINITY, |(low, high)| (high - low).abs())
    }
}

impl TornadoReport {
    /// The bars, the widest first.
    pub fn widest_first(&self) -> Vec<&TornadoBar> {
        let mut bars: Vec<&TornadoBar> = self.bars.iter().collect();
        bars.sort_by(|a, b| b.width().total_cmp(&a.width()));
        bars
    }

    /// Does any factor move the quantity?
    pub fn moves(&self) -> bool {
        self.bars.iter().any(|it| it.width() > 0.0)
    }
}

impl InfluenceReport {
    /// Nothing found yet.
    pub(super) fn new(subject: &InfluenceSubject) -> Self {
        let input =
            |name: &str| InputReport { name: name.to_owned(), first: None, total: None, shapley: None, within: None, screening: None };
        let quantity = |asked: &QuantityAsked| QuantityReport {
            asked: asked.clone(),
            verdict: QuantityVerdict::None,
            mean: None,
            sd: None,
            within: None,
            inputs: subject.factors.iter().map(|it| input(&it.name)).collect(),
            tornado: None,
        };
        Self {
            over: subject.over,
            design: subject.design,
            title: subject.title().to_owned(),
            scenarios: subject.scenarios(),
            method: InfluenceMethod::Screening,
            orders: subject.shapley_sets().ok().and_then(|it| it.orders()),
            held_grid: None,
            walks: None,
            quantities: subject.quantities.iter().map(quantity).collect(),
        }
    }
}

impl QuantityReport {
    /// Is there no number to show for it, because it has no value somewhere?
    pub(super) fn has_no_answer(&self) -> bool {
        let screened = self.inputs.iter().any(|it| it.screening.is_some());
        matches!(self.verdict, QuantityVerdict::Absent { .. }) && self.within.is_none() && !screened
    }

    /// Why it has no shares, and what to do; empty if it has.
    pub fn refusal(&self, over: InfluenceOver) -> String {
        let QuantityVerdict::Absent { absent, of } = self.verdict else { return String::new() };
        let what = if over == InfluenceOver::Design { "designs" } else { "draws or levels" };
        let name = &self.asked.name;
        format!("{name} has no value in {absent} of {of} {what}, so it has no variance; ask --of holds, or narrow the inputs")
    }
}
