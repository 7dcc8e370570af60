//! The weights of an axis' cases.

use super::table::{Entry, TomlNode, TomlTable, shortened};
use super::value::{number, shown};
use std::cell::RefCell;

/// The column of a joint axis that has the weights, and what has been read of it.
pub(super) struct WeightColumn<'a> {
    /// Its name.
    pub(super) name: &'a str,
    /// The weights so far; NaN for one with a problem.
    pub(super) weights: RefCell<Vec<f64>>,
}

impl WeightColumn<'_> {
    /// Takes in the weight of the next case.
    ///
    /// # Errors
    /// Why it cannot be one.
    pub(super) fn take(&self, found: Result<f64, String>) -> Result<(), String> {
        let good = found.and_then(|weight| {
            let value = shown(weight);
            if weight >= 0.0 { Ok(weight) } else { Err(format!("the weight {value} cannot be used; give a number of at least 0")) }
        });
        self.weights.borrow_mut().push(*good.as_ref().unwrap_or(&f64::NAN));
        good.map(|_| ())
    }

    /// The same for what stands in a study file.
    pub(super) fn take_node(&self, node: TomlNode<'_>) -> Result<(), String> {
        let wrong = || Err(format!("found {}, wanted a number, in the unit of the column's name", node.found()));
        self.take(number(node).unwrap_or_else(wrong))
    }

    /// The same for what stands in a CSV file.
    pub(super) fn take_text(&self, cell: &str) -> Result<(), String> {
        let finite = cell.trim().parse::<f64>().ok().filter(|it| it.is_finite());
        self.take(finite.map(|it| it + 0.0).ok_or_else(|| format!("\"{}\" is no number; give the weight of the case", shortened(cell))))
    }
}

/// The cases of an axis that is written with weights, `{ cases = ..., weight = "..." }`.
pub(super) fn weighted_cases<'n>(entry: &Entry<'n>) -> Option<TomlTable<'n>> {
    entry.node.table().filter(|table| table.get("cases").is_some() || table.get("weight").is_some())
}
