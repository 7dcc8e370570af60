//! What a draw fails at.

use super::kernel::DrawnKernel;
use crate::models::Status;
use crate::tape::Set;

/// Reason of a draw with a value that its input cannot have.
pub const NO_SUCH_DRIVE: &str = "a drawn value that its input cannot have";

/// What a draw of a design fails at, in any operating case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DrawFailures {
    /// Conditions of the drive's model that are the status in some case, by number.
    pub conditions: Set,
    /// Constraints of the drive that are not kept where their quantity has a value, by number.
    pub constraints: Set,
    /// A drawn value is none that its input can have.
    pub is_no_drive: bool,
}

impl DrawFailures {
    /// Those of both.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self {
            conditions: self.conditions | other.conditions,
            constraints: self.constraints | other.constraints,
            is_no_drive: self.is_no_drive || other.is_no_drive,
        }
    }

    /// Does the draw hold?
    pub fn is_none(self) -> bool {
        self == Self::default()
    }
}

impl DrawnKernel {
    /// What a draw of a design fails at, given the design's inputs in SI units.
    pub fn failures(&self, design: &[f64], draw: usize) -> DrawFailures {
        let cases = self.drawn_cases(design, draw);
        let mut failures = DrawFailures { is_no_drive: cases.iter().any(|it| it.status.is_none()), ..DrawFailures::default() };
        for case in &cases {
            if let Some(condition) = case.status.and_then(Status::condition) {
                failures.conditions.insert(self.base.first_of_reason(condition));
            }
        }
        for (number, constraint) in self.holds.iter().enumerate() {
            // Without a value in some case it is the status that fails.
            let has_values = cases.iter().all(|case| self.in_case(constraint.quantity, case).is_finite());
            if has_values && !self.keeps(constraint, &cases) {
                failures.constraints.insert(number);
            }
        }
        failures
    }
}
