//! Load spectra: a scenario axis whose cases have weights, and what becomes of a quantity over the scenarios.

use super::quantity::Quantity;
use crate::models::Model;
use serde::{Deserialize, Serialize};

/// What becomes of a quantity's values over the scenarios.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OverScenarios {
    /// The worst of all scenarios.
    #[default]
    Worst,
    /// The weighted mean over the cases of the study's spectrum, in the worst scenario of the other axes.
    Mean,
    /// The sum of value times weight over the cases of the study's spectrum, in the worst scenario of the other axes.
    Sum,
}

impl OverScenarios {
    /// Is it the worst of all scenarios, so that no spectrum is needed?
    pub fn is_worst(self) -> bool {
        self == Self::Worst
    }

    /// As it is written in a study.
    pub fn word(self) -> &'static str {
        match self {
            Self::Worst => "worst",
            Self::Mean => "mean",
            Self::Sum => "sum",
        }
    }

    /// Name of the column of a quantity: `NAME`, `NAME_mean` or `NAME_sum`.
    pub fn column(self, quantity: Quantity, model: &Model) -> String {
        let name = quantity.name(model);
        if self.is_worst() { name.to_owned() } else { format!("{name}_{}", self.word()) }
    }
}

/// The weighted axis of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Position of the axis in `Study::operation`.
    pub axis: usize,
    /// Name of the axis, such as `duty`.
    pub name: String,
    /// Name of the column of weights, such as `duration_h`.
    pub weight: String,
    /// Unit of the weights, as the name says it: `h`; empty for plain numbers.
    pub unit: String,
    /// The weight of each case, in that unit: finite, at least 0, not all 0.
    pub weights: Vec<f64>,
}

impl Spectrum {
    /// The sum of the weights, in the order of the cases.
    pub fn total(&self) -> f64 {
        self.weights.iter().fold(0.0, |sum, weight| sum + weight)
    }

    /// The unit of a sum of values in this unit: the product of both. Hours of something per hour are just something.
    pub fn unit_of_sum(&self, unit: &str) -> String {
        match (unit, &self.unit[..]) {
            (unit, "") => unit.to_owned(),
            ("", weight) => weight.to_owned(),
            (unit, weight) => match unit.strip_suffix(weight).and_then(|above| above.strip_suffix('/')) {
                Some("1") => String::new(),
                Some(above) => above.to_owned(),
                None => format!("{unit} {weight}"),
            },
        }
    }
}

/// The unit of a quantity's value over the scenarios, as text; a sum is in the quantity's unit times that of the weights.
pub(crate) fn unit_over(quantity: Quantity, over: OverScenarios, model: &Model, spectrum: Option<&Spectrum>) -> String {
    let unit = quantity.unit(model);
    match (over, spectrum) {
        (OverScenarios::Sum, Some(spectrum)) => spectrum.unit_of_sum(unit),
        _ => unit.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unit_of_a_sum_is_the_product() {
        let spectrum = |unit: &str| Spectrum {
            axis: 0,
            name: "duty".to_owned(),
            weight: String::new(),
            unit: unit.to_owned(),
            weights: vec![0.5, 1.5],
        };
        let product = |unit: &str, weight: &str| spectrum(weight).unit_of_sum(unit);
        let products = [("N", "", "N"), ("", "h", "h"), ("1/h", "h", ""), ("EUR/h", "h", "EUR"), ("1/s", "h", "1/s h"), ("N", "s", "N s")];
        for (unit, weight, expected) in products {
            assert_eq!(product(unit, weight), expected, "{unit} times {weight}");
        }
        assert_eq!(spectrum("").total(), 2.0);
    }
}
