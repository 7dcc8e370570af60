//! The inputs that matter most, in short.

use super::files::{share, verdict};
use super::results::{InfluenceReport, InputReport, QuantityReport};
use crate::study::number;
use serde_json::{Value, json};

/// Inputs of each quantity that are named.
const NAMED: usize = 3;

impl InputReport {
    /// What inputs are ranked by: the total index; where inputs are correlated the Shapley effect, and where they were only screened the
    /// mean absolute effect.
    pub fn weight(&self) -> Option<f64> {
        let share = self.total.or(self.shapley).map(|it| it.value);
        share.or_else(|| self.screening.as_ref().map(|it| it.mean_absolute))
    }
}

impl QuantityReport {
    /// The inputs that matter most, the first one most; without those whose share may as well be none: it is no larger than its interval.
    pub fn leading(&self) -> Vec<&InputReport> {
        let is_told = |it: &&InputReport| {
            let share = it.total.or(it.shapley);
            share.is_none_or(|it| it.value > it.confidence.unwrap_or(0.0))
        };
        let told = self.inputs.iter().filter(is_told);
        let mut ranked: Vec<(f64, &InputReport)> = told.filter_map(|it| Some((it.weight()?, it))).collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        ranked.into_iter().take(NAMED).map(|it| it.1).collect()
    }
}

/// Of each quantity the inputs that matter most.
pub fn brief(report: &InfluenceReport) -> Value {
    let input = |it: &InputReport| {
        json!({
            "name": it.name, "first": share(it.first), "total": share(it.total), "shapley": share(it.shapley),
            "mu_star": it.screening.as_ref().map(|it| number(it.mean_absolute)),
        })
    };
    let quantity = |it: &QuantityReport| {
        json!({
            "name": it.asked.name, "unit": it.asked.unit, "verdict": verdict(it, report.over),
            "largest": it.leading().into_iter().map(input).collect::<Vec<_>>(),
        })
    };
    json!({
        "over": report.over.word(), "design": report.design,
        "quantities": report.quantities.iter().map(quantity).collect::<Vec<_>>(),
    })
}
