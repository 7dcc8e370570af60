//! Least and largest worst-scenario value of each objective over the feasible designs.

use crate::masks::ends;
use crate::screen::Block;
use serde::{Deserialize, Serialize};

/// A value and the design that has it; of equal values the lowest index.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Extreme {
    /// The value, in its unit.
    pub value: f64,
    /// The design.
    pub index: u64,
}

/// Least and largest value per objective; `None` before the first feasible design.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Extremes {
    /// Per objective.
    pub least: Vec<Option<Extreme>>,
    /// Per objective.
    pub largest: Vec<Option<Extreme>>,
}

/// Replaces `held` if `offered` lies further in the direction of `further`, or ties with a lower index.
fn update(held: &mut Option<Extreme>, offered: Extreme, further: impl Fn(f64, f64) -> bool) {
    let take = held.is_none_or(|held| further(offered.value, held.value) || (offered.value == held.value && offered.index < held.index));
    if take {
        *held = Some(offered);
    }
}

impl Extremes {
    /// Nothing seen yet.
    pub fn new(objectives: usize) -> Self {
        Self { least: vec![None; objectives], largest: vec![None; objectives] }
    }

    /// Takes in a block; `columns` are objectives and their positions among its values.
    pub fn absorb(&mut self, block: &Block<'_>, columns: impl Iterator<Item = (usize, usize)>) {
        let lowest_index = || block.row_index + block.offsets.iter().min().copied().unwrap_or(0);
        for (objective, column) in columns {
            let values = block.column(column);
            let (low, high) = ends(block.alive, values);
            // Which design it is matters only where the value is new, or old with a chance of a lower index.
            let sides =
                [(&mut self.least[objective], low, f64::lt as fn(&f64, &f64) -> bool), (&mut self.largest[objective], high, f64::gt)];
            for (held, value, further) in sides {
                if value.is_finite() && held.is_none_or(|it| further(&value, &it.value) || (value == it.value && lowest_index() < it.index))
                {
                    let lanes = block.feasible().filter(|&lane| values[lane] == value);
                    let index = lanes.map(|lane| block.index(lane)).min().expect("the end of a set is one of its members");
                    update(held, Extreme { value: value + 0.0, index }, |a, b| further(&a, &b));
                }
            }
        }
    }

    /// Might a design with this value of an objective, and no lower an index than this, be an extreme?
    pub fn may_take(&self, objective: usize, value: f64, least_index: u64) -> bool {
        let takes = |held: &Option<Extreme>, further: fn(f64, f64) -> bool| {
            held.is_none_or(|held| further(value, held.value) || value == held.value && least_index < held.index)
        };
        takes(&self.least[objective], |a, b| a < b) || takes(&self.largest[objective], |a, b| a > b)
    }

    /// Can these be the extremes of so many designs under so many objectives?
    pub(super) fn fits(&self, objectives: usize, designs: u64) -> bool {
        let good = |ends: &[Option<Extreme>]| {
            ends.len() == objectives && ends.iter().flatten().all(|end| end.value.is_finite() && end.index < designs)
        };
        good(&self.least) && good(&self.largest)
    }

    /// Takes in the extremes of other designs.
    pub fn merge(&mut self, other: &Self) {
        for (held, offered) in self.least.iter_mut().zip(&other.least) {
            offered.iter().for_each(|offered| update(held, *offered, |a, b| a < b));
        }
        for (held, offered) in self.largest.iter_mut().zip(&other.largest) {
            offered.iter().for_each(|offered| update(held, *offered, |a, b| a > b));
        }
    }
}
