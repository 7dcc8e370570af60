//! The space of a study: designs and scenarios by index.
//!
//! A design is its index, in file order with the last axis fastest; so is a scenario (operation axes outside, uncertainty axes
//! inside). A [`Product`] is a set of dimensions walked together; the sweep splits the space into products of its own and asks
//! each for the index in the study's order.

use crate::sample::Sampler;
use crate::study::{Axis, Study};
use crate::tape::Set;
use std::sync::Arc;

/// One independent direction of a space.
#[derive(Debug)]
pub enum SpaceDimension {
    /// An axis of the study.
    Axis(Axis),
    /// Sampled designs: all design axes at once.
    Sampled(Sampler),
}

impl SpaceDimension {
    /// Number of levels, rows or samples.
    pub fn count(&self) -> u64 {
        match self {
            Self::Axis(axis) => axis.count(),
            Self::Sampled(sampler) => sampler.count(),
        }
    }

    /// The inputs that it sets.
    pub fn inputs(&self) -> &[usize] {
        match self {
            Self::Axis(axis) => axis.inputs(),
            Self::Sampled(sampler) => sampler.inputs(),
        }
    }

    /// The value of its input number `column` at `index`.
    pub fn value(&self, column: usize, index: u64) -> f64 {
        match self {
            Self::Axis(axis) => axis.value(column, index),
            Self::Sampled(sampler) => sampler.value(column, index),
        }
    }

    /// Least and largest value of its input number `column`.
    pub fn ends(&self, column: usize) -> (f64, f64) {
        match self {
            Self::Axis(axis) => axis.ends(column),
            Self::Sampled(sampler) => sampler.ends(column),
        }
    }
}

/// A dimension with its place in a product and in the study's order.
#[derive(Clone, Debug)]
struct PlacedDimension {
    dimension: Arc<SpaceDimension>,
    count: u64,
    /// Distance of two neighbours within this product.
    stride: u64,
    /// Distance of two neighbours in the study's index.
    source_stride: u64,
}

impl PlacedDimension {
    fn digit(&self, index: u64) -> u64 {
        index / self.stride % self.count
    }
}

/// All combinations of some dimensions; the last dimension varies fastest.
#[derive(Clone, Debug)]
pub struct Product {
    places: Vec<PlacedDimension>,
    count: u64,
}

impl Product {
    /// The product of whole dimensions in the study's order; `None` if there are more combinations than a u64 numbers.
    fn new(dimensions: impl DoubleEndedIterator<Item = SpaceDimension>) -> Option<Self> {
        let mut count = 1u64;
        let mut places = Vec::new();
        for dimension in dimensions.rev() {
            let own = dimension.count();
            places.push(PlacedDimension { dimension: Arc::new(dimension), count: own, stride: count, source_stride: count });
            count = count.checked_mul(own)?;
        }
        places.reverse();
        Some(Self { places, count })
    }

    /// Splits off the dimensions that set any of `inputs`: (those, the others), each in unchanged order.
    pub fn split(&self, inputs: Set) -> (Self, Self) {
        let sets = |place: &PlacedDimension| place.dimension.inputs().iter().any(|&input| inputs.contains(input));
        let (with, without): (Vec<_>, Vec<_>) = self.places.iter().cloned().partition(sets);
        (Self::of(with), Self::of(without))
    }

    /// Splits off the outer dimensions until at most `limit` combinations (or one dimension) remain: (those, the rest).
    pub fn narrow(&self, limit: u64) -> (Self, Self) {
        let mut inner = self.clone();
        let mut outer = Vec::new();
        while inner.count > limit && inner.places.len() > 1 {
            outer.push(inner.places.remove(0));
            inner = Self::of(inner.places);
        }
        (Self::of(outer), inner)
    }

    /// The product of this and further dimensions, which vary faster.
    pub fn with(&self, inner: &Self) -> Self {
        Self::of(self.places.iter().chain(&inner.places).cloned().collect())
    }

    fn of(mut places: Vec<PlacedDimension>) -> Self {
        let mut count = 1;
        for place in places.iter_mut().rev() {
            place.stride = count;
            count *= place.count;
        }
        Self { places, count }
    }

    /// Number of combinations; 1 without any dimension.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The inputs that it sets.
    pub fn inputs(&self) -> Set {
        self.places.iter().flat_map(|place| place.dimension.inputs()).collect()
    }

    /// At most `most` combinations on a coarser grid, in order: of every dimension so large a share of the levels, evenly spread with both ends
    /// among them, and two at least of those that have more than one, as long as so many fit.
    #[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "which levels is not critical")]
    pub fn coarse(&self, most: u64) -> Vec<u64> {
        let levels = |share: f64| -> Vec<u64> {
            self.places.iter().map(|place| ((place.count as f64 * share).round() as u64).clamp(place.count.min(2), place.count)).collect()
        };
        let size = |share: f64| levels(share).iter().fold(1, |size: u64, &count| size.saturating_mul(count));
        let (mut fits, mut exceeds) = (0.0, 1.0);
        if size(exceeds) <= most {
            fits = 1.0;
        }
        for _ in 0..f64::MANTISSA_DIGITS {
            let middle = 0.5 * (fits + exceeds);
            if size(middle) <= most { fits = middle } else { exceeds = middle }
        }
        let mut chosen = vec![0];
        for (place, count) in self.places.iter().zip(levels(fits)) {
            // Of very many dimensions not even two levels of each fit: the last ones stay where they begin.
            let count = if (chosen.len() as u64).saturating_mul(count) > most { 1 } else { count };
            let level =
                |step: u64| if count < 2 { 0 } else { (u128::from(step) * u128::from(place.count - 1) / u128::from(count - 1)) as u64 };
            chosen = chosen.iter().flat_map(|&before| (0..count).map(move |step| before + level(step) * place.stride)).collect();
        }
        chosen
    }

    /// The combinations that differ from one along a single dimension, by so many levels.
    pub fn beside(&self, index: u64, levels: u64) -> impl Iterator<Item = u64> {
        self.places.iter().flat_map(move |place| {
            let digit = place.digit(index);
            let others = [digit.checked_sub(levels), digit.checked_add(levels).filter(|&it| it < place.count)];
            others.into_iter().flatten().map(move |other| index - digit * place.stride + other * place.stride)
        })
    }

    /// The index of combination `index` in the study's order, less what the other dimensions contribute.
    pub fn source_index(&self, index: u64) -> u64 {
        self.places.iter().map(|place| place.digit(index) * place.source_stride).sum()
    }

    /// The combination that a study's index stands for in this product.
    pub fn index_of(&self, source: u64) -> u64 {
        self.places.iter().map(|place| source / place.source_stride % place.count * place.stride).sum()
    }

    /// Writes the values of combination `index` into the slots of their inputs.
    pub fn set(&self, index: u64, inputs: &mut [f64]) {
        for place in &self.places {
            let digit = place.digit(index);
            for (column, &input) in place.dimension.inputs().iter().enumerate() {
                inputs[input] = place.dimension.value(column, digit);
            }
        }
    }

    /// Its dimensions, outermost first, each with the distance of two neighbours in the study's index.
    pub(crate) fn dimensions(&self) -> impl ExactSizeIterator<Item = (&SpaceDimension, u64)> {
        self.places.iter().map(|place| (&*place.dimension, place.source_stride))
    }

    /// The position of combination `index` along each dimension, outermost first.
    #[cfg(feature = "gpu")]
    pub(crate) fn digits(&self, index: u64) -> Vec<u64> {
        self.places.iter().map(|place| place.digit(index)).collect()
    }

    /// Calls `each` with every input that is set and its least and largest value.
    pub fn for_each_range(&self, mut each: impl FnMut(usize, (f64, f64))) {
        for place in &self.places {
            for (column, &input) in place.dimension.inputs().iter().enumerate() {
                each(input, place.dimension.ends(column));
            }
        }
    }

    /// The position in the study's order that a design has along its dimension number `dimension`.
    pub fn digit(&self, dimension: usize, index: u64) -> u64 {
        self.places[dimension].digit(index)
    }
}

/// The designs and scenarios of a study.
#[derive(Clone, Debug)]
pub struct Space {
    /// All designs.
    pub designs: Product,
    /// All scenarios.
    pub scenarios: Product,
    fixed: Vec<f64>,
}

impl Space {
    /// The space of a study, whose products were checked to be numberable when it was read.
    pub fn new(study: &Study) -> Self {
        let numbered = "the size of the space is checked when the study is read";
        let designs = match study.sample {
            Some(sample) => Product::new(std::iter::once(SpaceDimension::Sampled(Sampler::new(sample, &study.design)))),
            None => Product::new(study.design.iter().cloned().map(SpaceDimension::Axis)),
        };
        let scenarios = Product::new(study.operation.iter().chain(&study.uncertainty).cloned().map(SpaceDimension::Axis));
        Self { designs: designs.expect(numbered), scenarios: scenarios.expect(numbered), fixed: study.fixed.clone() }
    }

    /// The level or row of design axis number `axis` in a design.
    pub fn level(&self, axis: usize, design: u64) -> u64 {
        match self.designs.dimensions().next() {
            Some((SpaceDimension::Sampled(sampler), _)) => sampler.level(axis, design),
            _ => self.designs.digit(axis, design),
        }
    }

    /// All inputs of one design in one scenario, in their units.
    pub fn inputs(&self, design: u64, scenario: u64) -> Vec<f64> {
        let mut inputs = self.fixed.clone();
        self.designs.set(design, &mut inputs);
        self.scenarios.set(scenario, &mut inputs);
        inputs
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Plan;
    use crate::study::{Levels, Study};

    #[test]
    fn combinations_beside_one_differ_along_one_dimension() {
        let axis = |input, count: u64| {
            SpaceDimension::Axis(Axis::Single { input, levels: Levels::List((0..count).map(|level| level as f64).collect()) })
        };
        let product = Product::new([axis(0, 3), axis(1, 5), axis(2, 1)].into_iter()).expect("so few fit");
        // Level 0 of the first and 3 of the second.
        let beside = |levels| product.beside(3, levels).collect::<Vec<_>>();
        assert_eq!([beside(1), beside(2), beside(4)], [vec![8, 2, 4], vec![13, 1], vec![]]);
    }

    #[test]
    fn a_coarser_grid_of_very_many_axes_is_no_larger() {
        let axis = |input| SpaceDimension::Axis(Axis::Single { input, levels: Levels::List(vec![0.0, 1.0]) });
        let designs = Product::new((0..60).map(axis)).expect("2^60 fit");
        let coarse = designs.coarse(1000);
        assert_eq!(coarse.len(), 512);
        assert!(coarse.is_sorted_by(|a, b| a < b) && coarse[511] < designs.count());
    }

    #[test]
    fn a_coarser_grid_has_the_ends_of_every_axis_and_no_more_than_asked() {
        let text = "model = \"metal-cvt\"\n[design]\nratio = { from = 0.5, to = 2, count = 31 }\nband_count = [6, 7, 9]\n\
                    friction = { from = 0.05, to = 0.09, count = 11 }\n[objectives]\naxial_force_N = \"min\"\n";
        let designs = Plan::new(Study::parse_in(text, "study.toml", ".".as_ref()).expect("it is a study")).space.designs;
        for most in [8, 9, 100, 500, 1022] {
            let coarse = designs.coarse(most);
            assert!(coarse.len() as u64 <= most && coarse.len() as u64 * 4 > most, "{} of {most}", coarse.len());
            assert!(coarse.is_sorted_by(|a, b| a < b) && coarse.ends_with(&[designs.count() - 1]) && coarse[0] == 0);
        }
        assert_eq!(designs.coarse(1), [0]);
        for most in 2..8 {
            assert!((2..=most).contains(&(designs.coarse(most).len() as u64)), "{most}");
        }
        for most in [1023, u64::MAX] {
            assert_eq!(designs.coarse(most), (0..designs.count()).collect::<Vec<_>>());
        }
    }
}
