//! A pulley with its loads and strengths: what a solve is asked for.

use super::section::{Dimensions, Fineness, SectionKind};
use super::turn::{Case, Strength};

/// A pulley: its section and how it is loaded and how strong it is, in mm, N, MPa and rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Design {
    /// Type of the section.
    pub kind: SectionKind,
    /// Its dimensions.
    pub dimensions: Dimensions,
    /// Poisson's ratio.
    pub poisson: f64,
    /// How fine it is meshed.
    pub fineness: Fineness,
    /// Its loads.
    pub case: Case,
    /// Yield strength, MPa.
    pub yield_strength: f64,
    /// Strength against fatigue.
    pub strength: Strength,
    /// Density, kg/m^3.
    pub density: f64,
    /// Places (z, r) whose stress is asked for, mm.
    pub own_points: [Option<(f64, f64)>; 2],
}
