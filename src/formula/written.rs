//! Formulas as they are given, before they are checked.

/// What a formula is for, and so what is asked of its value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FormulaKind {
    /// A quantity of the unit that its name ends in.
    #[default]
    Quantity,
    /// The same, whose values are all whole numbers.
    Whole,
    /// The margin of a condition, in any unit. Its name is what messages call it, and no formula can read it.
    Margin,
}

/// A formula as it is given.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct WrittenFormula {
    /// Its name.
    pub name: String,
    /// What it says.
    pub text: String,
    /// What it is for.
    pub kind: FormulaKind,
}

impl WrittenFormula {
    /// A formula for this.
    pub fn new(name: impl Into<String>, text: impl Into<String>, kind: FormulaKind) -> Self {
        Self { name: name.into(), text: text.into(), kind }
    }
}
