//! What is wrong with a formula, and where.

use std::fmt::{self, Display, Formatter};

/// A problem at a byte of one formula's text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fault {
    pub(super) at: usize,
    pub(super) message: String,
}

impl Fault {
    pub(super) fn new(at: usize, message: impl Into<String>) -> Self {
        Self { at, message: message.into() }
    }
}

/// What is wrong with a formula, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct FormulaProblem {
    /// Number of the formula, in the order given; of a curve that cannot be, the number of formulas.
    pub formula: usize,
    /// Its name.
    pub name: String,
    /// Byte of the formula's text.
    pub at: usize,
    /// Line of that byte within the formula's text, from 1.
    pub line: usize,
    /// Column of that byte, in characters, from 1.
    pub column: usize,
    /// What is wrong, and what to do about it.
    pub message: String,
}

impl FormulaProblem {
    pub(super) fn new(formula: usize, name: &str, text: &str, fault: Fault) -> Self {
        let at = (0..=fault.at.min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0);
        let before = &text[..at];
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
        Self { formula, name: name.to_owned(), at, line, column, message: fault.message }
    }
}

impl Display for FormulaProblem {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        let Self { name, line, column, message, .. } = self;
        write!(out, "{name}, line {line}, column {column}: {message}")
    }
}
