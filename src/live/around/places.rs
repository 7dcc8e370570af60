//! Places along an axis, and where between them what is feasible ends.

use crate::certify::Row;
use crate::error::Result;
use crate::study::Levels;

/// Times that the end of what is feasible is looked for between two places: of 33 places over 1e6 levels that finds the very level.
pub(super) const HALVINGS: usize = 16;
/// The same where an axis has no levels.
const HALVINGS_BETWEEN: usize = 6;
/// Axes with more levels are taken for ranges.
const MOST_LEVELS: u64 = 1 << 20;

/// Some places of an axis, the ends of what is feasible to either side of the own one among them, and the design at each.
pub(super) fn along_places(
    places: &AxisPlaces,
    own: f64,
    most: u64,
    judged: impl Fn(&[f64]) -> Result<Vec<Row>>,
) -> Result<(Vec<f64>, Vec<Row>)> {
    let mut values = places.some(most);
    let mut rows = judged(&values)?;
    for _ in 0..places.halvings() {
        let here = values.iter().position(|it| *it == own).unwrap_or(0);
        let further: Vec<f64> =
            edges(&rows, here).into_iter().flatten().filter_map(|(a, b)| places.between(values[a], values[b])).collect();
        if further.is_empty() {
            break;
        }
        let found = judged(&further)?;
        let mut all: Vec<(f64, Row)> = values.into_iter().zip(rows).chain(further.into_iter().zip(found)).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        (values, rows) = all.into_iter().unzip();
    }
    Ok((values, rows))
}

/// The last feasible place to either side of a feasible one, with the next one, if there is one.
pub(super) fn edges(rows: &[Row], here: usize) -> [Option<(usize, usize)>; 2] {
    if !rows[here].feasible {
        return [None, None];
    }
    let down = (0..here).rev().find(|&at| !rows[at].feasible).map(|at| (at, at + 1));
    let up = (here + 1..rows.len()).find(|&at| !rows[at].feasible).map(|at| (at - 1, at));
    [down, up]
}

/// About `most` of `count` rows evenly, the own one among them.
pub(super) fn spread(count: usize, most: u64, own: usize) -> Vec<usize> {
    let most = (most as usize).min(count);
    let even = |at: usize| if most > 1 { (at * (count - 1) + (most - 1) / 2) / (most - 1) } else { 0 };
    let mut chosen: Vec<usize> = (0..most).map(even).chain([own]).collect();
    chosen.sort_unstable();
    chosen.dedup();
    chosen
}

/// Where a design may stand on an axis of numbers.
pub(super) enum AxisPlaces {
    /// On one of these, from the least.
    Levels { levels: Vec<f64>, own: usize },
    /// Anywhere.
    Between { low: f64, high: f64, log: bool, own: f64 },
}

impl AxisPlaces {
    pub(super) fn new(levels: &Levels, own: f64) -> Self {
        if levels.count() > MOST_LEVELS || matches!(levels, Levels::Continuous { .. }) {
            let (low, high) = levels.ends();
            return Self::Between { low: low.min(high), high: low.max(high), log: levels.is_logarithmic(), own };
        }
        let mut all: Vec<f64> = (0..levels.count()).map(|level| levels.value(level)).chain([own]).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        let place = all.iter().position(|it| *it == own).unwrap_or(0);
        Self::Levels { levels: all, own: place }
    }

    /// About so many of them: the ends, the own one, and its neighbours.
    #[allow(clippy::cast_precision_loss, reason = "a few places of a picture")]
    pub(super) fn some(&self, most: u64) -> Vec<f64> {
        match self {
            Self::Levels { levels, own } => {
                let mut chosen = spread(levels.len(), most, *own);
                chosen.extend([own.saturating_sub(1), (own + 1).min(levels.len() - 1)]);
                chosen.sort_unstable();
                chosen.dedup();
                chosen.into_iter().map(|at| levels[at]).collect()
            }
            Self::Between { low, high, log, own } => {
                let place = |at: u64| {
                    let t = at as f64 / (most - 1) as f64;
                    match at {
                        0 => *low,
                        at if at == most - 1 => *high,
                        _ if *log => low * (high / low).powf(t),
                        _ => low + t * (high - low),
                    }
                };
                let mut values: Vec<f64> = (0..most).map(place).chain([*own]).collect();
                values.sort_by(f64::total_cmp);
                values.dedup();
                values
            }
        }
    }

    fn halvings(&self) -> usize {
        if matches!(self, Self::Levels { .. }) { HALVINGS } else { HALVINGS_BETWEEN }
    }

    /// One in the middle between two, if there is one.
    pub(super) fn between(&self, a: f64, b: f64) -> Option<f64> {
        match self {
            Self::Levels { levels, .. } => {
                let at = |value: f64| levels.partition_point(|it| *it < value);
                let (a, b) = (at(a), at(b));
                (b > a + 1).then(|| levels[(a + b) / 2])
            }
            Self::Between { log, .. } => Some(if *log { (a * b).sqrt() } else { 0.5 * (a + b) }).filter(|it| a < *it && *it < b),
        }
    }
}
