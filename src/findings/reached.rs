//! What designs reach.

/// A value that a design reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Reached {
    /// The worst value over the scenarios, in the quantity's unit.
    pub value: f64,
    /// The design.
    pub design: u64,
    /// Is it the best of all designs, or of the sample only?
    pub exact: bool,
}
