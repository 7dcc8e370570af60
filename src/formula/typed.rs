//! A formula that has been checked: names are slots, units are factors, and what can fail has a number.

use super::function::Function;
use crate::real::Smoothness;

/// Most names that the expression of a root may read.
pub(super) const MOST_PARAMETERS: usize = 16;

/// A formula with everything looked up, in SI units.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Typed {
    Constant(f64),
    /// What a name stands for.
    Slot(usize),
    /// What a name stands for, in the expression of a root: its number among the root's parameters.
    Parameter(usize),
    /// The unknown of the root around it.
    Unknown,
    Negative(Box<Typed>),
    Sum(Box<[Typed; 2]>),
    Difference(Box<[Typed; 2]>),
    Product(Box<[Typed; 2]>),
    /// With the condition that the divisor is not zero, unless it is a constant.
    Quotient(Box<[Typed; 2]>, Option<usize>),
    /// A whole power from -8 to 8; a negative one with the condition that its base is not zero.
    WholePower(Box<Typed>, i8, Option<usize>),
    /// Any other power, with the conditions on its base and on its size. A power that is surely positive may have zero as its base.
    Power {
        parts: Box<[Typed; 2]>,
        of_zero: bool,
        base: usize,
        size: Option<usize>,
    },
    /// A function, with the condition on its argument if it has one.
    Apply(Function, Vec<Typed>, Option<usize>),
    /// What is compared, then the two values.
    If(IfTest, Box<[Typed; 4]>),
    /// A curve by number, with the condition that the argument lies between its ends.
    Curve(usize, Box<Typed>, usize),
    /// From, to and expression, where the search starts if that is said, the slots of its parameters, the condition that there is a root,
    /// and what is known of the expression.
    Root(Box<[Typed; 3]>, Option<Box<Typed>>, Vec<usize>, usize, Smoothness),
}

impl Typed {
    /// Is it this number?
    pub(super) fn constant(&self) -> Option<f64> {
        match self {
            Self::Constant(value) => Some(*value),
            _ => None,
        }
    }

    fn parts(&self) -> Vec<&Self> {
        match self {
            Self::Constant(_) | Self::Slot(_) | Self::Parameter(_) | Self::Unknown => Vec::new(),
            Self::Negative(of) | Self::WholePower(of, ..) | Self::Curve(_, of, _) => vec![of],
            Self::Sum(parts) | Self::Difference(parts) | Self::Product(parts) | Self::Quotient(parts, _) | Self::Power { parts, .. } => {
                parts.iter().collect()
            }
            Self::Apply(_, parts, _) => parts.iter().collect(),
            Self::If(_, parts) => parts.iter().collect(),
            Self::Root(parts, start, ..) => parts.iter().chain(start.as_deref()).collect(),
        }
    }

    fn reads_unknown(&self) -> bool {
        matches!(self, Self::Unknown) || self.parts().into_iter().any(Self::reads_unknown)
    }

    /// Of the expression of a root: is it free of corners and jumps over the unknown?
    pub(super) fn smoothness(&self) -> Smoothness {
        let has_corners = match self {
            Self::If(..) | Self::Curve(..) | Self::Root(..) => true,
            Self::Apply(function, ..) => function.has_corners(),
            _ => false,
        };
        let is_smooth = |part: &Self| part.smoothness() == Smoothness::Smooth;
        let smooth = !self.reads_unknown() || (!has_corners && self.parts().into_iter().all(is_smooth));
        if smooth { Smoothness::Smooth } else { Smoothness::Unknown }
    }
}

/// How an `if` compares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum IfTest {
    Less,
    AtMost,
    Greater,
    AtLeast,
    /// Of whole numbers: half a step of room on either side.
    EqualWhole,
    /// Of a number and the code of a word.
    EqualWord,
}

/// What a formula needs beside its operands having a value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Need {
    /// What is said of a design that breaks it.
    pub(super) reason: String,
    /// Must the margin be greater than zero, rather than at least zero?
    pub(super) strict: bool,
}
