//! Which inputs a value depends on, found by running the formula itself.
//!
//! Fixed inputs are known numbers and count as no dependence; a selection whose condition is known takes the dependence of
//! the chosen branch only. So `traction = 0.4` for every design is seen not to depend on the friction, and an axis of
//! numbers is seen never to ask for the slip limit. The answer may name too many inputs, never too few.

use super::{Real, bracketed_newton};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A set of inputs (bit `i` for input number `i` of the model) and what is known of the value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dependence {
    /// Bit `i` is set if the value may change with input `i`.
    pub inputs: u64,
    /// Least and largest value, where that is known: exact for fixed inputs and what follows from them alone, the ends of
    /// the axis for a varied input itself, lost by arithmetic on a varied input.
    range: Option<(f64, f64)>,
}

impl Dependence {
    /// An input that every design has the same value of.
    pub fn fixed(value: f64) -> Self {
        Self { inputs: 0, range: Some((value, value)) }
    }

    /// Input number `input`, which takes values in `[least, largest]`.
    pub fn varied(input: usize, least: f64, largest: f64) -> Self {
        Self { inputs: 1 << input, range: Some((least, largest)) }
    }

    /// A value that depends on `inputs` (a bit set) and lies in `[least, largest]`.
    pub fn within(inputs: u64, least: f64, largest: f64) -> Self {
        Self { inputs, range: Some((least, largest)) }
    }

    /// The same value, its dependence forgotten.
    #[must_use]
    pub fn without_inputs(self) -> Self {
        Self { inputs: 0, ..self }
    }

    /// The value, if it is the same for every design.
    pub fn known(self) -> Option<f64> {
        self.range.filter(|(low, high)| low == high && self.inputs == 0).map(|(low, _)| low)
    }

    fn map(self, function: impl Fn(f64) -> f64) -> Self {
        Self { inputs: self.inputs, range: self.known().map(|value| (function(value), function(value))) }
    }

    fn zip(self, other: Self, function: impl Fn(f64, f64) -> f64) -> Self {
        let value = self.known().zip(other.known()).map(|(a, b)| function(a, b));
        Self { inputs: self.inputs | other.inputs, range: value.map(|value| (value, value)) }
    }
}

macro_rules! union {
    ($trait:ident, $method:ident, $operator:tt) => {
        impl $trait for Dependence {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $operator b)
            }
        }
    };
}
union!(Add, add, +);
union!(Sub, sub, -);
union!(Mul, mul, *);
union!(Div, div, /);

impl Neg for Dependence {
    type Output = Self;
    fn neg(self) -> Self {
        Self { inputs: self.inputs, range: self.range.map(|(low, high)| (-high, -low)) }
    }
}

impl Real for Dependence {
    type Shared = Self;
    fn shared(value: Self) -> Self {
        value
    }
    fn plus_whole(self, other: Self) -> Self {
        self + other
    }
    fn turns(self, most: usize) -> usize {
        self.range.map_or(most, |(_, high)| high.turns(most))
    }
    fn is_zero(self) -> bool {
        self.known() == Some(0.0)
    }
    fn constant(value: f64) -> Self {
        Self::fixed(value)
    }
    fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }
    fn abs(self) -> Self {
        self.map(f64::abs)
    }
    fn min(self, other: Self) -> Self {
        self.zip(other, Real::min)
    }
    fn max(self, other: Self) -> Self {
        self.zip(other, Real::max)
    }
    fn exp_m1(self) -> Self {
        self.map(Real::exp_m1)
    }
    fn ln_1p(self) -> Self {
        self.map(Real::ln_1p)
    }
    fn sin(self) -> Self {
        self.map(Real::sin)
    }
    fn cos(self) -> Self {
        self.map(Real::cos)
    }
    fn asin(self) -> Self {
        self.map(Real::asin)
    }
    fn select(margin: Self, at_least_zero: Self, below_zero: Self) -> Self {
        match margin.range {
            Some((low, _)) if low >= 0.0 => at_least_zero,
            Some((_, high)) if high < 0.0 => below_zero,
            _ => Self { inputs: margin.inputs | at_least_zero.inputs | below_zero.inputs, range: None },
        }
    }
    fn monotone_root<const P: usize>(
        bracket: (Self, Self),
        start: Self,
        parameters: [Self; P],
        function: impl Fn([Self; P], Self) -> (Self, Self),
    ) -> Self {
        let asked = bracket.0 + bracket.1 + start;
        let (value, slope) = function(parameters, asked);
        if let (Some(low), Some(high), Some(first)) = (bracket.0.known(), bracket.1.known(), start.known())
            && value.known().is_some()
            && slope.known().is_some()
        {
            return Self::fixed(bracketed_newton((low, high), first, f64::EPSILON, |x| {
                let (value, slope) = function(parameters, Self::fixed(x));
                (value.known().unwrap_or(f64::NAN), slope.known().unwrap_or(f64::NAN))
            }));
        }
        Self { inputs: asked.inputs | value.inputs | slope.inputs, range: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_unites_and_a_known_condition_chooses() {
        let a = Dependence::varied(0, 1.0, 2.0);
        let b = Dependence::varied(3, -1.0, 1.0);
        let fixed = Dependence::fixed(5.0);
        assert_eq!((a * fixed + b).inputs, 0b1001);
        assert_eq!((fixed + fixed).known(), Some(10.0));
        assert_eq!(Real::select(a, fixed, b).inputs, 0, "the margin is at least 1 for every design");
        assert_eq!(Real::select(-a, fixed, b).inputs, 0b1000, "the margin is below zero for every design");
        assert_eq!(Real::select(b, fixed, a).inputs, 0b1001, "the sign is not known: margin and both branches");
    }

    #[test]
    fn a_root_depends_on_what_its_function_is_given_and_captures() {
        let target = Dependence::varied(2, 1.0, 4.0);
        let bracket = (Dependence::fixed(0.0), Dependence::fixed(9.0));
        let root = Real::monotone_root(bracket, Dependence::fixed(1.0), [], |[], x| (x * x - target, x + x));
        assert_eq!(root.inputs, 0b100);
        let root = Real::monotone_root(bracket, Dependence::fixed(1.0), [target], |[target], x| (x * x - target, x + x));
        assert_eq!(root.inputs, 0b100);
        let known = Real::monotone_root(bracket, Dependence::fixed(1.0), [], |[], x| (x * x - Dependence::fixed(4.0), x + x));
        assert_eq!(known.known(), Some(2.0));
    }
}
