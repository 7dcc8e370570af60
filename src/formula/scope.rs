//! What the names in formulas stand for.

use super::unit::{QuantityUnit, Units};

/// Most points of a curve.
pub const MOST_POINTS: usize = 1000;

/// Where the number comes from that a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NameRole {
    /// An input of the model.
    Input,
    /// A number that an axis, a fixed value or a catalogue gives, which the model does not know.
    Variable,
    /// An output of the model.
    Output,
}

/// A name that formulas may read.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ScopeName {
    /// The name.
    pub name: String,
    /// Where its number comes from.
    pub role: NameRole,
    /// Its unit.
    pub measure: QuantityUnit,
    /// Are all its values whole numbers?
    pub whole: bool,
    /// Words that stand for values, each with the number that encodes it: such a name can be compared with a word and do nothing else.
    pub words: Vec<(String, f64)>,
    /// Is every value one of these words?
    pub only_words: bool,
    /// May there be no value, as of an output that a condition takes away?
    pub may_be_absent: bool,
}

impl ScopeName {
    /// A name for any numbers in this unit, always there.
    pub fn new(name: impl Into<String>, role: NameRole, measure: QuantityUnit) -> Self {
        Self { name: name.into(), role, measure, whole: false, words: Vec::new(), only_words: false, may_be_absent: false }
    }

    /// The same name, whose values are whole numbers.
    #[must_use]
    pub fn whole(self) -> Self {
        Self { whole: true, ..self }
    }

    /// The same name, which may have no value.
    #[must_use]
    pub fn maybe_absent(self) -> Self {
        Self { may_be_absent: true, ..self }
    }

    /// The same name, which may be one of these words too, or nothing else (`only`).
    #[must_use]
    pub fn words(self, words: Vec<(String, f64)>, only: bool) -> Self {
        Self { words, only_words: only, ..self }
    }
}

/// Measured data: straight lines between points. Formulas call it like a function.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredCurve {
    /// Its name.
    pub name: String,
    /// What its argument measures.
    pub x: QuantityUnit,
    /// What its value measures.
    pub y: QuantityUnit,
    /// In SI units.
    pub(super) points: Vec<(f64, f64)>,
}

impl MeasuredCurve {
    /// A curve through these points, given in the units `x` and `y`.
    ///
    /// # Errors
    /// A sentence, with the number of the point where one is to blame, if there are fewer than 2 points or more than 1000, or their x
    /// does not increase.
    pub fn new(name: impl Into<String>, x: QuantityUnit, y: QuantityUnit, points: &[(f64, f64)]) -> Result<Self, (Option<usize>, String)> {
        if !(2..=MOST_POINTS).contains(&points.len()) {
            return Err((None, format!("a curve has 2 to {MOST_POINTS} points, this one has {}", points.len())));
        }
        let converted: Vec<_> = points.iter().map(|&(at, value)| (x.to_si(at), y.to_si(value))).collect();
        if let Some(bad) = converted.iter().position(|(x, y)| !(x.is_finite() && y.is_finite())) {
            return Err((Some(bad), format!("({}, {}) is no point of a curve; both numbers must be finite", points[bad].0, points[bad].1)));
        }
        for (at, pair) in converted.windows(2).enumerate() {
            if pair[0].0 >= pair[1].0 {
                let message = format!("x must increase from point to point, but {} follows {}", points[at + 1].0, points[at].0);
                return Err((Some(at + 1), message));
            }
            if !slope(pair[0], pair[1]).is_finite() {
                return Err((Some(at + 1), format!("the curve is too steep between x = {} and x = {}", points[at].0, points[at + 1].0)));
            }
        }
        Ok(Self { name: name.into(), x, y, points: converted })
    }

    /// The points in SI units.
    pub fn points(&self) -> &[(f64, f64)] {
        &self.points
    }
}

/// Slope of the line between two points.
pub(super) fn slope(from: (f64, f64), to: (f64, f64)) -> f64 {
    (to.1 - from.1) / (to.0 - from.0)
}

/// What formulas may read: names, curves and units.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Scope {
    /// The units that numbers and names may be in.
    pub units: Units,
    /// The names; the position is the name's slot, see [`Formulas`](super::Formulas).
    pub names: Vec<ScopeName>,
    /// Curves that are called like functions.
    pub curves: Vec<MeasuredCurve>,
}

impl Scope {
    /// These names, curves and units.
    pub fn new(units: Units, names: Vec<ScopeName>, curves: Vec<MeasuredCurve>) -> Self {
        Self { units, names, curves }
    }

    /// The slot of a name.
    pub fn slot(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|known| known.name == name)
    }
}
