//! Which input matters, as `[report]` asks for it.

use serde::{Deserialize, Serialize};

/// The quantity that tells whether all constraints are kept.
pub const HOLDS: &str = "holds";

/// Which inputs vary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum InfluenceOver {
    /// The design axes: which choice matters, over all designs
    Design,
    /// What is uncertain about one design
    Uncertainty,
}

impl InfluenceOver {
    /// As it is written.
    pub fn word(self) -> &'static str {
        match self {
            Self::Design => "design",
            Self::Uncertainty => "uncertainty",
        }
    }
}

/// Which input matters for the design that a result names first, or over all designs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SensitivitySpec {
    /// Which inputs vary.
    pub over: InfluenceOver,
    /// The quantities that are asked about; none: those of the study, and whether all is kept.
    pub of: Vec<String>,
    /// Draws of each set, where there are too many combinations to look at all.
    pub draws: u64,
}

impl SensitivitySpec {
    /// Draws of each set, unless something else is said.
    pub const DRAWS: u64 = 4096;
    /// Least number of draws of each set.
    pub const DRAWS_FROM: u64 = 16;
    /// Largest number of draws of each set.
    pub const DRAWS_TO: u64 = 1 << 24;
}
