//! Loops of formulas: over how many places, in which order, and a place on the way.
//!
//! A formula does not write `for` where the number of iterations is one of its numbers, but asks [`Real::fold`]; so a loop can be run, or
//! be recorded: either every iteration for itself, or, for a shader, once.

use super::Real;

/// A place in a table: a number, counted from the place that a recorded loop is at, if it is one of such a loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Place {
    /// The number itself, or how far it is from the loop's.
    pub number: i32,
    /// The recorded loop that it follows.
    pub of: Option<u8>,
}

impl Place {
    /// A place that is the same in every iteration.
    #[inline(always)]
    #[allow(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "tables are short")]
    pub const fn at(number: usize) -> Self {
        Self { number: number as i32, of: None }
    }

    /// The place behind this one.
    #[inline(always)]
    #[must_use]
    pub const fn next(self) -> Self {
        Self { number: self.number + 1, of: self.of }
    }

    /// The number of a place that is known.
    #[inline(always)]
    #[allow(clippy::cast_sign_loss, reason = "places count from 0")]
    pub(crate) fn known(self) -> usize {
        debug_assert!(self.of.is_none() && self.number >= 0, "{self:?} is only known while a recorded loop runs");
        self.number as usize
    }

    /// The number of a place while the loop that it follows is at `at`.
    #[allow(clippy::cast_sign_loss, clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "tables are short")]
    pub(crate) fn within(self, at: usize) -> usize {
        let from = if self.of.is_some() { at as i32 } else { 0 };
        (from + self.number) as usize
    }
}

/// The places of a loop, from `first` to one below `end`, and whether it may end early.
#[derive(Clone, Copy, Debug)]
pub struct Loop<R> {
    pub(crate) first: usize,
    pub(crate) end: R,
    pub(crate) most: usize,
    pub(crate) backwards: bool,
    pub(crate) until_zero: Option<usize>,
    pub(crate) names: &'static [&'static str],
}

impl<R: Real> Loop<R> {
    /// Places 0 to `end - 1`; `end` is a whole number of at most `most`. Where a number stands for many designs the loop goes as far as
    /// any of them asks for: iterations beyond a design's own must change nothing for it.
    #[inline(always)]
    pub fn to(end: R, most: usize) -> Self {
        Self { first: 0, end, most, backwards: false, until_zero: None, names: &[] }
    }

    /// The same without the places before `first`.
    #[inline(always)]
    #[must_use]
    pub fn from(self, first: usize) -> Self {
        Self { first, ..self }
    }

    /// The same from the last place to the first.
    #[inline(always)]
    #[must_use]
    pub fn backwards(self) -> Self {
        Self { backwards: true, ..self }
    }

    /// The same, but it may end as soon as this number of the state is zero: further iterations must then change nothing.
    #[inline(always)]
    #[must_use]
    pub fn until_zero(self, number: usize) -> Self {
        Self { until_zero: Some(number), ..self }
    }

    /// The same, with what the numbers of its state are called in what is written of the formula.
    #[inline(always)]
    #[must_use]
    pub fn named(self, names: &'static [&'static str]) -> Self {
        Self { names, ..self }
    }

    /// Runs it, iteration by iteration.
    #[inline(always)]
    pub(crate) fn run<const S: usize>(self, mut state: [R; S], mut body: impl FnMut(Place, [R; S]) -> [R; S]) -> [R; S] {
        let end = self.end.iterations(self.most);
        let mut done = self.first;
        while done < end {
            let place = if self.backwards { end - 1 - (done - self.first) } else { done };
            state = body(Place::at(place), state);
            if let Some(number) = self.until_zero
                && state[number].is_zero()
            {
                break;
            }
            done += 1;
        }
        state
    }
}
