//! What designs are compared by.

use crate::study::{Goal, Objective};
use multiversion::multiversion;
use serde::{Deserialize, Serialize};

/// What an objective becomes for the comparison: less is better, steps of the resolution count as one value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeyRule {
    goal: Goal,
    resolution: Option<f64>,
}

impl From<&Objective> for KeyRule {
    fn from(objective: &Objective) -> Self {
        Self { goal: objective.goal, resolution: objective.resolution }
    }
}

impl KeyRule {
    /// The number that is compared. Zero has one sign, so that equal values are equal bits.
    #[inline(always)]
    pub fn key(&self, value: f64) -> f64 {
        let step = match self.resolution {
            Some(resolution) => (value / resolution).floor(),
            None => value,
        };
        (if self.goal == Goal::Min { step } else { -step }) + 0.0
    }

    /// Do values that differ count as one?
    pub fn has_steps(&self) -> bool {
        self.resolution.is_some()
    }

    /// The key before it is rounded to whole steps.
    pub(crate) fn uncut(&self, value: f64) -> f64 {
        let steps = self.resolution.map_or(value, |resolution| value / resolution);
        if self.goal == Goal::Min { steps } else { -steps }
    }

    /// How far whole steps can take the key below [`Self::uncut`].
    pub(crate) fn most_cut(&self) -> f64 {
        // With `max`, rounding down makes the key larger.
        if self.resolution.is_some() && self.goal == Goal::Min { 1.0 } else { 0.0 }
    }

    /// The keys of a column of values, but for the sign of zero: the values themselves where they serve, else in `scratch`.
    pub(crate) fn keys<'a>(self, values: &'a [f64], scratch: &'a mut Vec<f64>) -> &'a [f64] {
        if self.resolution.is_none() && self.goal == Goal::Min {
            return values;
        }
        scratch.resize(values.len(), 0.0);
        match self.resolution {
            Some(_) => scratch.iter_mut().zip(values).for_each(|(key, &value)| *key = self.key(value)),
            None => negate(values, scratch),
        }
        scratch
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn negate(values: &[f64], keys: &mut [f64]) {
    for (key, &value) in keys.iter_mut().zip(values) {
        *key = -value;
    }
}

/// Designs of a front with what they are compared by: coordinates point after point, less is better.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Points {
    /// Coordinates.
    pub keys: Vec<f64>,
    /// Design indices.
    pub indices: Vec<u64>,
}

impl Points {
    /// Number of points.
    pub fn len(&self) -> usize {
        self.indices.len()
    }

    /// Are there none?
    pub fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }

    pub(crate) fn key(&self, point: usize, dimensions: usize) -> &[f64] {
        &self.keys[point * dimensions..][..dimensions]
    }

    /// Number of leading points whose first coordinate is at most `first`; the points must be sorted by it.
    pub(crate) fn not_beyond(&self, first: f64, dimensions: usize) -> usize {
        let (mut low, mut high) = (0, self.len());
        while low < high {
            let middle = (low + high) / 2;
            if self.keys[middle * dimensions] <= first { low = middle + 1 } else { high = middle }
        }
        low
    }

    pub(crate) fn push(&mut self, key: impl IntoIterator<Item = f64>, index: u64) {
        self.keys.extend(key);
        self.indices.push(index);
    }
}
