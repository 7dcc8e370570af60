//! Operations on one number after the other, none of which swaps the order of two numbers.
//!
//! Sums, differences, products, quotients, square roots, minima and maxima with a fixed other number rise or fall all the way, and so do
//! they in f64, because IEEE 754 rounds no two numbers past each other.

use super::{Binary, Unary};

/// One operation on a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// An operation on the number alone: a change of sign or a square root.
    Alone(Unary),
    /// The number, then the other of that place.
    First(Binary, usize),
    /// The other of that place, then the number.
    Second(Binary, usize),
}

/// Operations on a number, in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Steps(pub Vec<Step>);

impl Steps {
    /// What becomes of a number.
    #[inline(always)]
    pub fn value(&self, start: f64, others: &[f64]) -> f64 {
        self.0.iter().fold(start, |value, step| step.of(value, others))
    }

    /// What becomes of two numbers, between which the result rises or falls all the way; `None` where that is not sure: something on the
    /// way is not finite, or a divisor changes its sign.
    #[inline]
    pub fn ends(&self, low: f64, high: f64, others: &[f64]) -> Option<(f64, f64)> {
        let (mut a, mut b) = (low, high);
        for step in &self.0 {
            if let Step::Second(Binary::Div, _) = step
                && !(a > 0.0 && b > 0.0 || a < 0.0 && b < 0.0)
            {
                return None;
            }
            (a, b) = (step.of(a, others), step.of(b, others));
            if !a.is_finite() || !b.is_finite() {
                return None;
            }
        }
        Some((a, b))
    }
}

impl Step {
    #[inline(always)]
    fn of(self, value: f64, others: &[f64]) -> f64 {
        match self {
            Self::Alone(unary) => unary.of(value),
            Self::First(binary, other) => binary.of(value, others[other]),
            Self::Second(binary, other) => binary.of(others[other], value),
        }
    }
}
