//! What became of an evaluation.

/// What became of an evaluation: ok, or the first condition that failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The formula has a meaning.
    Ok,
    /// Number of the condition that failed.
    Failed(usize),
    /// A value is beyond what f64 holds, and absent.
    Overflow,
}

/// The reason of [`Status::Overflow`].
pub const OVERFLOW: &str = "overflow";

/// Status and outputs of one design in one scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// Ok, or why not.
    pub status: Status,
    /// One value per output of the model, in the output's unit; `None` where it has no meaning.
    pub outputs: Vec<Option<f64>>,
}
