//! Axes: the values that inputs take, by index.

use crate::models::Model;
use serde::{Deserialize, Serialize};

/// What stands between inputs that vary together, and between their values.
pub(crate) const TOGETHER: &str = " + ";
/// Inputs of a joint axis that its name lists.
const NAMED: usize = 3;
/// Fewer levels than this are a choice between a few things, not a range that could go on.
const LEAST_OF_A_RANGE: u64 = 3;

/// The levels of one input, computed from their index: an axis of a billion levels takes no memory.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Levels {
    /// Values as listed.
    List(Vec<f64>),
    /// `count` values evenly spread from `from` to `to`, both included exactly.
    Even {
        /// First value.
        from: f64,
        /// Last value.
        to: f64,
        /// Number of values, at least 1 (then `from == to`).
        count: u64,
        /// Evenly in the logarithm.
        log: bool,
    },
    /// `from + i step`, `count` values.
    Step {
        /// First value.
        from: f64,
        /// Distance; decades per step if logarithmic.
        step: f64,
        /// Number of values.
        count: u64,
        /// Steps in the decimal logarithm.
        log: bool,
    },
    /// Any value of a range; for sampled designs only. Its levels, where needed, are its two ends.
    Continuous {
        /// One end.
        from: f64,
        /// The other end.
        to: f64,
        /// Evenly in the logarithm.
        log: bool,
    },
}

impl Levels {
    /// Number of levels.
    pub fn count(&self) -> u64 {
        match self {
            Self::List(values) => values.len() as u64,
            Self::Even { count, .. } | Self::Step { count, .. } => *count,
            Self::Continuous { .. } => 2,
        }
    }

    /// The value of level `index < count()`.
    #[allow(clippy::cast_precision_loss, reason = "an axis has far fewer than 2^53 levels; checked when the study is read")]
    pub fn value(&self, index: u64) -> f64 {
        let i = index as f64;
        match *self {
            Self::List(ref values) => values[usize::try_from(index).expect("a list is held in memory")],
            Self::Even { from, .. } if index == 0 => from,
            Self::Even { to, count, .. } if index == count - 1 => to,
            Self::Even { from, to, count, log: false } => from + i * (to - from) / (count - 1) as f64,
            Self::Even { from, to, count, log: true } => {
                let (low, high) = (libm::log(from), libm::log(to));
                libm::exp(low + i * (high - low) / (count - 1) as f64)
            }
            Self::Step { from, step, log: false, .. } => from + i * step,
            Self::Step { from, step, log: true, .. } => from * libm::exp10(i * step),
            Self::Continuous { from, to, .. } => [from, to][usize::from(index > 0)],
        }
    }

    /// Are the levels of a range apart by a factor?
    pub(crate) fn is_logarithmic(&self) -> bool {
        matches!(self, Self::Even { log: true, .. } | Self::Step { log: true, .. } | Self::Continuous { log: true, .. })
    }

    /// Least and largest value.
    pub fn ends(&self) -> (f64, f64) {
        match self {
            Self::List(values) => values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v))),
            _ => {
                let (first, last) = (self.value(0), self.value(self.count() - 1));
                (first.min(last), first.max(last))
            }
        }
    }
}

/// One axis of a space: an input with its levels, or several inputs that walk through rows together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// One input.
    Single {
        /// Number of the input.
        input: usize,
        /// Its values.
        levels: Levels,
    },
    /// Several inputs whose values belong together: a load spectrum, a catalogue.
    Joint {
        /// Numbers of the inputs.
        inputs: Vec<usize>,
        /// One row of values per level, in the order of `inputs`.
        rows: Vec<Vec<f64>>,
    },
}

impl Axis {
    /// Number of levels or rows.
    pub fn count(&self) -> u64 {
        match self {
            Self::Single { levels, .. } => levels.count(),
            Self::Joint { rows, .. } => rows.len() as u64,
        }
    }

    /// Is it a range of one input, which could go on? Rows are none, and fewer levels are a choice between a few things.
    pub(crate) fn is_range(&self) -> bool {
        matches!(self, Self::Single { levels, .. } if levels.count() >= LEAST_OF_A_RANGE || matches!(levels, Levels::Continuous { .. }))
    }

    /// The inputs that the axis sets.
    pub fn inputs(&self) -> &[usize] {
        match self {
            Self::Single { input, .. } => std::slice::from_ref(input),
            Self::Joint { inputs, .. } => inputs,
        }
    }

    /// The input, or the first inputs of an axis that sets several.
    pub(crate) fn name(&self, model: &Model) -> String {
        let names: Vec<&str> = self.inputs().iter().map(|&input| model.inputs[input].name.as_str()).collect();
        let first = names.iter().take(NAMED).copied().collect::<Vec<_>>().join(TOGETHER);
        if names.len() > NAMED { format!("{first} + {} more", names.len() - NAMED) } else { first }
    }

    /// The value that the axis gives its input number `column` at `index`.
    pub fn value(&self, column: usize, index: u64) -> f64 {
        match self {
            Self::Single { levels, .. } => levels.value(index),
            Self::Joint { rows, .. } => rows[usize::try_from(index).expect("rows are held in memory")][column],
        }
    }

    /// Is there such a value among those of its input number `column`? Of a range, which holds no word, the first one tells.
    pub(crate) fn has_number(&self, column: usize, is_number: impl Fn(f64) -> bool) -> bool {
        match self {
            Self::Single { levels: Levels::List(values), .. } => values.iter().any(|&value| is_number(value)),
            Self::Single { levels, .. } => is_number(levels.value(0)),
            Self::Joint { rows, .. } => rows.iter().any(|row| is_number(row[column])),
        }
    }

    /// Is it a range whose levels are apart by a factor?
    pub(crate) fn is_logarithmic(&self) -> bool {
        matches!(self, Self::Single { levels, .. } if levels.is_logarithmic())
    }

    /// Least and largest value of its input number `column`.
    pub fn ends(&self, column: usize) -> (f64, f64) {
        match self {
            Self::Single { levels, .. } => levels.ends(),
            Self::Joint { rows, .. } => {
                rows.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), row| (low.min(row[column]), high.max(row[column])))
            }
        }
    }
}

/// How sampled designs are spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Sobol sequence with a random digital shift.
    Sobol,
    /// Latin hypercube: every axis is cut into `count` strata, each hit once.
    LatinHypercube,
    /// Independent random numbers.
    Random,
}

/// Sampled designs in place of the product of the design axes.
///
/// Design `i` is a function of the study and `i` alone. Each design axis maps a number in [0, 1) to a value: a
/// [`Levels::Continuous`] to its whole range, every other axis to one of its levels or rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sample {
    /// How they are spread.
    pub method: Method,
    /// Number of designs.
    pub count: u64,
    /// Seed of the random numbers.
    pub seed: u64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_exact_and_steps_do_not_accumulate() {
        let even = Levels::Even { from: 0.1, to: 0.3, count: 7, log: false };
        assert_eq!((even.value(0), even.value(6)), (0.1, 0.3));
        let log = Levels::Even { from: 0.5, to: 2.0, count: 31, log: true };
        assert_eq!((log.value(0), log.value(30)), (0.5, 2.0));
        assert!((log.value(15) - 1.0).abs() < 1e-15);
        let step = Levels::Step { from: 0.1, step: 0.005, count: 41, log: false };
        assert_eq!(step.value(40), 0.1 + 40.0 * 0.005);
        assert_eq!(step.ends(), (0.1, step.value(40)));
    }
}
