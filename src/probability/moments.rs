//! Mean and standard deviation of a distribution.

use super::special::{normal_below, normal_density};

/// Mean and standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments {
    pub mean: f64,
    pub sd: f64,
}

impl Moments {
    /// Of values with weights; the mean is known before the squares are added, so that nothing cancels.
    pub fn of_weighted<I: Iterator<Item = (f64, f64)>>(pairs: impl Fn() -> I) -> Self {
        let total: f64 = pairs().map(|(_, weight)| weight).sum();
        let first = pairs().next().map_or(0.0, |(value, _)| value);
        let mean = first + pairs().map(|(value, weight)| weight / total * (value - first)).sum::<f64>();
        let variance: f64 = pairs().map(|(value, weight)| weight / total * ((value - mean) * (value - mean))).sum();
        Self { mean, sd: libm::sqrt(variance) }
    }

    /// Of a continuous distribution, by the value that has given probabilities below and above it. The integral runs over the normal
    /// score of the value, where the trapezoidal rule converges faster than any power of the step.
    pub fn of_values(value: impl Fn(f64, f64) -> f64) -> Self {
        const STEPS_PER_SCORE: i32 = 32;
        const LARGEST_SCORE: i32 = 37;
        let places: Vec<_> = (-LARGEST_SCORE * STEPS_PER_SCORE..=LARGEST_SCORE * STEPS_PER_SCORE)
            .map(|step| f64::from(step) / f64::from(STEPS_PER_SCORE))
            .map(|z| (value(normal_below(z), normal_below(-z)), normal_density(z)))
            .collect();
        Self::of_weighted(|| places.iter().copied())
    }

    /// Of a triangular distribution between `lowest` and `highest`. Three points of Gauss are exact for the cubic on either side of the
    /// mode.
    pub fn of_triangle([from, mode, to]: [f64; 3], lowest: f64, highest: f64) -> Self {
        const GAUSS: [(f64, f64); 3] = [(-0.774_596_669_241_483_4, 5.0), (0.0, 8.0), (0.774_596_669_241_483_4, 5.0)];
        let density = |x: f64| if x < mode { (x - from) / (mode - from) } else { (to - x) / (to - mode) };
        let pieces = [(lowest, highest.min(mode)), (lowest.max(mode), highest)];
        let points = pieces.into_iter().filter(|(low, high)| low < high).flat_map(|(low, high)| {
            let half = 0.5 * (high - low);
            GAUSS.map(|(place, weight)| (low + half * (1.0 + place), weight * half))
        });
        let pairs: Vec<_> = points.map(|(x, weight)| (x, weight * density(x))).collect();
        Self::of_weighted(|| pairs.iter().copied())
    }
}
