//! Three-valued decisions: what a number with a known error lets one conclude.
//!
//! Every discrete question of a sweep (is the status ok, does the constraint hold, does one design dominate another) is
//! asked of a signed margin and its error bound. A screening engine may act on a sure answer only; what is
//! [`Decision::Unsure`] goes to the f64 reference, whose bound is zero and which therefore always knows.

/// The answer to "is this margin at least zero?", given how far the margin may be off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decision {
    /// True whatever the error was.
    Yes,
    /// False whatever the error was.
    No,
    /// The error bound contains both answers.
    Unsure,
}

impl Decision {
    /// Is `margin` (known to within `±bound`) at least zero?
    ///
    /// A NaN margin or bound is never a yes: a formula that has lost its meaning must not make a design feasible. Unless the
    /// bound is 0 it may have lost it to rounding only, which is for the reference to say.
    pub fn at_least_zero(margin: f64, bound: f64) -> Self {
        if margin.is_nan() && bound == 0.0 {
            Self::No
        } else if !bound.is_finite() {
            Self::Unsure
        } else if margin >= bound {
            Self::Yes
        } else if margin < -bound {
            Self::No
        } else {
            Self::Unsure
        }
    }

    /// Is `margin` (known to within `±bound`) greater than zero?
    pub fn above_zero(margin: f64, bound: f64) -> Self {
        if margin.is_nan() && bound == 0.0 {
            Self::No
        } else if !bound.is_finite() {
            Self::Unsure
        } else if margin > bound {
            Self::Yes
        } else if margin <= -bound {
            Self::No
        } else {
            Self::Unsure
        }
    }

    /// Both must hold: a sure no wins over an unsure, an unsure over a yes.
    pub fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::No, _) | (_, Self::No) => Self::No,
            (Self::Yes, Self::Yes) => Self::Yes,
            _ => Self::Unsure,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exact_number_is_never_unsure() {
        for margin in [-1.0, -f64::MIN_POSITIVE, 0.0, f64::MIN_POSITIVE, 1.0] {
            assert_ne!(Decision::at_least_zero(margin, 0.0), Decision::Unsure);
            assert_ne!(Decision::above_zero(margin, 0.0), Decision::Unsure);
        }
        assert_eq!(Decision::at_least_zero(0.0, 0.0), Decision::Yes);
        assert_eq!(Decision::above_zero(0.0, 0.0), Decision::No);
    }

    #[test]
    fn a_bound_around_zero_is_unsure_and_nan_is_never_yes() {
        assert_eq!(Decision::at_least_zero(0.1, 0.2), Decision::Unsure);
        assert_eq!(Decision::at_least_zero(-0.2, 0.2), Decision::Unsure);
        assert_eq!(Decision::above_zero(-0.2, 0.2), Decision::No);
        assert_eq!(Decision::at_least_zero(f64::NAN, 0.0), Decision::No);
        assert_eq!(Decision::above_zero(1.0, f64::NAN), Decision::Unsure);
        assert_eq!(Decision::at_least_zero(f64::NAN, f64::INFINITY), Decision::Unsure, "lost to rounding, perhaps");
        assert_eq!(Decision::at_least_zero(f64::INFINITY, f64::INFINITY), Decision::Unsure, "an overflow says nothing");
        assert_eq!(Decision::above_zero(f64::NEG_INFINITY, f64::INFINITY), Decision::Unsure);
    }

    #[test]
    fn a_sure_no_decides_a_conjunction() {
        assert_eq!(Decision::No.and(Decision::Unsure), Decision::No);
        assert_eq!(Decision::Unsure.and(Decision::Yes), Decision::Unsure);
        assert_eq!(Decision::Yes.and(Decision::Yes), Decision::Yes);
    }
}
