//! A factor: an input that varies, or inputs that vary together.

use crate::models::{Model, Range};
use crate::probability::{Distribution, Effect, ProbabilityProblem};
use crate::sample::value_at;
use crate::study::{Axis, Levels, TOGETHER, UncertainInput};
use crate::table::written;

/// A tornado and walks go from this probability to as much below 1.
const TAIL: f64 = 0.05;

/// Inputs that vary as one: an axis, or an input with a distribution.
#[derive(Clone, Debug)]
pub struct InputFactor {
    /// The input, or the first inputs of an axis that sets several.
    pub name: String,
    pub(super) kind: FactorKind,
}

#[derive(Clone, Debug)]
pub(super) enum FactorKind {
    /// Levels, each as likely as the others, or a range.
    Levels { axis: Axis, order: LevelOrder },
    /// A distribution, of the value or of what is done to it.
    Drawn { input: usize, valid: Range, effect: Effect, distribution: Distribution, nominal: f64 },
}

/// The order of an axis' levels from the lowest to the highest value. Words and rows of several inputs keep the order of the study.
#[derive(Clone, Debug)]
pub(super) enum LevelOrder {
    Rising,
    Falling,
    Listed(Vec<u64>),
}

/// Where in its range a factor is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FactorPlace {
    /// What would be drawn there.
    pub(super) drawn: f64,
    /// The place, from 0 to 1: of levels that of the nearest one.
    pub(super) place: f64,
}

impl InputFactor {
    /// Of an axis of more than one level.
    pub(super) fn of_axis(axis: &Axis, model: &Model) -> Self {
        Self { name: axis.name(model), kind: FactorKind::Levels { axis: axis.clone(), order: order_of(axis, model) } }
    }

    /// Of an input with a distribution, whose value would be `nominal` without it.
    pub(super) fn of_drawn(it: &UncertainInput, model: &Model, nominal: f64) -> Self {
        let valid = model.inputs[it.input].valid;
        let (effect, distribution) = (it.acts(), it.distribution.clone());
        Self { name: it.name.clone(), kind: FactorKind::Drawn { input: it.input, valid, effect, distribution, nominal } }
    }

    /// The inputs that it sets.
    pub(super) fn inputs(&self) -> &[usize] {
        match &self.kind {
            FactorKind::Levels { axis, .. } => axis.inputs(),
            FactorKind::Drawn { input, .. } => std::slice::from_ref(input),
        }
    }

    /// Its axis with single levels, if it has such.
    pub(super) fn levels(&self) -> Option<&Axis> {
        match &self.kind {
            FactorKind::Levels { axis: Axis::Single { levels: Levels::Continuous { .. }, .. }, .. } | FactorKind::Drawn { .. } => None,
            FactorKind::Levels { axis, .. } => Some(axis),
        }
    }

    /// An axis in its place with at most `count` levels where it has a range; `None` if it has a distribution.
    pub(super) fn as_levels(&self, count: u64) -> Option<Axis> {
        match &self.kind {
            &FactorKind::Levels { axis: Axis::Single { input, levels: Levels::Continuous { from, to, log } }, .. } => {
                Some(Axis::Single { input, levels: Levels::Even { from, to, count, log } })
            }
            FactorKind::Levels { axis, .. } => Some(axis.clone()),
            FactorKind::Drawn { .. } => None,
        }
    }

    /// What is drawn of it: of levels a number from 0 to 1 that says which.
    pub(super) fn distribution(&self) -> Result<Distribution, ProbabilityProblem> {
        match &self.kind {
            FactorKind::Levels { .. } => Distribution::uniform(0.0, 1.0),
            FactorKind::Drawn { distribution, .. } => Ok(distribution.clone()),
        }
    }

    /// The values of its inputs for a drawn number; `None` if an input cannot have its value.
    pub(super) fn values(&self, drawn: f64) -> Option<Vec<f64>> {
        match &self.kind {
            FactorKind::Levels { axis, .. } => Some((0..axis.inputs().len()).map(|column| value_at(axis, column, drawn)).collect()),
            FactorKind::Drawn { valid, effect, nominal, .. } => {
                let value = effect.of(*nominal, drawn);
                valid.contains(value).then(|| vec![value])
            }
        }
    }

    /// The drawn number at a place of its range: from the lowest to the highest level, or from the 5 % to the 95 % quantile.
    #[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "far fewer than 2^53 levels")]
    pub(super) fn at(&self, place: f64) -> Result<FactorPlace, ProbabilityProblem> {
        if let FactorKind::Drawn { distribution, .. } = &self.kind {
            return Ok(FactorPlace { drawn: distribution.quantile(TAIL + (1.0 - 2.0 * TAIL) * place)?, place });
        }
        let Some(axis) = self.levels() else { return Ok(FactorPlace { drawn: place, place }) };
        let last = axis.count() - 1;
        // Half a level away from the next, the lower one.
        let rank = ((place * last as f64 - 1e-9).round().max(0.0) as u64).min(last);
        Ok(FactorPlace { drawn: self.drawn_at_rank(rank), place: rank as f64 / last as f64 })
    }

    /// The drawn number that picks the level of this rank.
    #[allow(clippy::cast_precision_loss, reason = "far fewer than 2^53 levels")]
    fn drawn_at_rank(&self, rank: u64) -> f64 {
        let FactorKind::Levels { axis, order } = &self.kind else { return f64::NAN };
        let level = match order {
            LevelOrder::Rising => rank,
            LevelOrder::Falling => axis.count() - 1 - rank,
            LevelOrder::Listed(levels) => levels[rank as usize],
        };
        (level as f64 + 0.5) / axis.count() as f64
    }

    /// Its value for a drawn number, as a person writes it: of several inputs that of each.
    pub(super) fn told(&self, drawn: f64, model: &Model) -> String {
        let value = |(&input, value): (&usize, f64)| written(&model.inputs[input], value);
        let values = match &self.kind {
            FactorKind::Drawn { effect, nominal, .. } => vec![effect.of(*nominal, drawn)],
            FactorKind::Levels { axis, .. } => (0..axis.inputs().len()).map(|column| value_at(axis, column, drawn)).collect(),
        };
        self.inputs().iter().zip(values).map(value).collect::<Vec<_>>().join(TOGETHER)
    }
}

/// The order of an axis' levels.
fn order_of(axis: &Axis, model: &Model) -> LevelOrder {
    let Axis::Single { input, levels } = axis else { return LevelOrder::Rising };
    let (input, count) = (&model.inputs[*input], levels.count());
    match levels {
        Levels::List(values) if values.iter().any(|&value| input.word_for(value).is_some()) || values.is_sorted() => LevelOrder::Rising,
        Levels::List(values) => {
            let mut order: Vec<u64> = (0..count).collect();
            order.sort_by(|&a, &b| values[a as usize].total_cmp(&values[b as usize]));
            LevelOrder::Listed(order)
        }
        Levels::Even { .. } | Levels::Step { .. } if levels.value(0) > levels.value(count - 1) => LevelOrder::Falling,
        _ => LevelOrder::Rising,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factor(values: &[f64]) -> InputFactor {
        let model = crate::models::find("metal-cvt").expect("it is a model");
        let input = model.input("friction").expect("it has one");
        InputFactor::of_axis(&Axis::Single { input, levels: Levels::List(values.to_vec()) }, &model)
    }

    #[test]
    fn places_are_levels_from_the_lowest_to_the_highest() {
        let at = |factor: &InputFactor, place: f64| {
            let found = factor.at(place).expect("it has levels");
            (factor.values(found.drawn).expect("levels are valid")[0], found.place)
        };
        let unsorted = factor(&[0.09, 0.06, 0.08, 0.07]);
        assert_eq!([0.0, 0.5, 1.0].map(|place| at(&unsorted, place).0), [0.06, 0.07, 0.09], "of an even number the lower middle");
        assert_eq!(at(&unsorted, 2.0 / 3.0), (0.08, 2.0 / 3.0));
        let two = factor(&[0.06, 0.08]);
        assert_eq!([0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(|place| at(&two, place)), [(0.06, 0.0), (0.06, 0.0), (0.08, 1.0), (0.08, 1.0)]);
    }

    #[test]
    fn a_tolerance_is_about_the_nominal_value_and_may_leave_the_range() {
        let distribution = Distribution::uniform(-0.5, 1.5).expect("it is one");
        let model = crate::models::find("metal-cvt").expect("it is a model");
        let valid = model.inputs[model.input("friction").expect("it has one")].valid;
        let kind = FactorKind::Drawn { input: 0, valid, effect: Effect::Times, distribution, nominal: 0.08 };
        let drawn = InputFactor { name: "friction".to_owned(), kind };
        assert_eq!(drawn.values(1.25), Some(vec![0.1]));
        assert_eq!(drawn.values(-0.25), None, "a negative friction");
        let place = drawn.at(0.0).expect("it has quantiles");
        assert!((place.drawn + 0.4).abs() < 1e-12 && place.place == 0.0, "{place:?}");
    }
}
