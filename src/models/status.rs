//! What became of an evaluation.

/// What became of an evaluation: ok, or the first condition that failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The formula has a meaning.
    Ok,
    /// Number of the condition that failed.
    Failed(u16),
    /// A value is beyond what f64 holds, and absent.
    Overflow,
}

impl Status {
    /// The condition of this number failed.
    #[inline]
    #[allow(clippy::cast_possible_truncation, reason = "no model has as many conditions")]
    pub fn failed(condition: usize) -> Self {
        Self::Failed(condition as u16)
    }

    /// Number of the condition that failed, if one did.
    #[inline]
    pub fn condition(self) -> Option<usize> {
        if let Self::Failed(condition) = self { Some(condition.into()) } else { None }
    }
}

impl Status {
    /// The status of a number, as [`u16::from`] gives it.
    #[inline]
    pub(crate) fn of_number(number: u16) -> Self {
        match number {
            0 => Self::Ok,
            1 => Self::Overflow,
            _ => Self::Failed(number - 2),
        }
    }
}

/// As a number: 0 for ok, 1 for an overflow, 2 and on for the conditions.
impl From<Status> for u16 {
    #[inline]
    fn from(status: Status) -> Self {
        match status {
            Status::Ok => 0,
            Status::Overflow => 1,
            Status::Failed(condition) => condition + 2,
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_status_is_that_of_its_number() {
        for (number, status) in [Status::Ok, Status::Overflow, Status::failed(0)].into_iter().enumerate() {
            assert_eq!((u16::from(status), Status::of_number(number as u16)), (number as u16, status));
        }
        assert_eq!(Status::of_number(u16::from(Status::failed(7))), Status::failed(7));
    }
}
