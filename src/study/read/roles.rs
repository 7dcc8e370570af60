//! Who gives inputs values: the tables of a study, and their places in it.

/// The tables that give inputs values.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum AxisRole {
    /// What the engineer chooses.
    Design,
    /// What the drive must survive.
    Operation,
    /// What nobody knows exactly.
    Uncertainty,
    /// What is settled.
    Fixed,
}

impl AxisRole {
    /// Name of the table.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Design => "design",
            Self::Operation => "operation",
            Self::Uncertainty => "uncertainty",
            Self::Fixed => "fixed",
        }
    }
}

/// The key of an axis over presets of the model, and the name of its label.
pub(super) const PRESET: &str = "preset";

/// A place in the file that gives an input values.
pub(super) struct AxisClaim {
    /// Number of the input.
    pub(super) input: usize,
    /// The table.
    pub(super) role: AxisRole,
    /// Byte in the study file.
    pub(super) at: usize,
    /// Is it an axis of this input alone?
    pub(super) single: bool,
    /// A word that is among the values.
    pub(super) word: Option<String>,
}
