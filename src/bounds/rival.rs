//! The best that a search has found so far: what a box must hold to be looked at further.

use super::axes::Spans;
use super::cells::CellAxes;
use super::search::BoxSearch;
use super::sought::Sought;
use super::staircase::Staircase;
use crate::reduce::{Extreme, Front, MOST_OBJECTIVES, Map, Reducers, Top};

/// Most cells of a map that are looked at to settle a box of several.
const LOOKED_AT: u64 = 64;

/// The best so far, while a batch is looked at.
pub enum Rival<'a> {
    /// The front, with its stairs where two objectives have a product.
    Front(&'a Front, Option<Staircase>),
    /// Key and index of the last of the best K, once there are K.
    Top(Option<(f64, u64)>),
    /// The best of every cell, and the axes of the map.
    Cells(&'a Map, CellAxes),
    /// The extreme.
    Extreme(Option<Extreme>),
}

impl<'a> Rival<'a> {
    /// That of a search among what was found.
    pub fn new(search: &BoxSearch<'_>, found: &'a mut Reducers) -> Self {
        match search.sought {
            Sought::Front => {
                let points = found.front.points();
                let staircase = search.product.as_ref().map(|product| Staircase::new(points, product.largest));
                Self::Front(&found.front, staircase)
            }
            Sought::Top => Self::Top(found.reported.top.first_mut().and_then(Top::worst)),
            Sought::Cells(number) => Self::Cells(&found.reported.maps[number], search.cells.expect("the map has axes")),
            Sought::Extreme { objective, largest } => {
                Self::Extreme(if largest { found.extremes.largest[objective] } else { found.extremes.least[objective] })
            }
        }
    }

    /// Can no design of a box be what is sought, given the best that it may have?
    pub fn beats(&self, search: &BoxSearch<'_>, hopes: &[f64], spans: &Spans) -> bool {
        let least_index = search.axes.least_index(spans);
        match self {
            Rival::Front(front, _) => {
                let mut keys = [0.0; MOST_OBJECTIVES];
                for ((key, hope), target) in keys.iter_mut().zip(hopes).zip(&search.targets) {
                    *key = target.rule.key(*hope);
                }
                let keys = &keys[..hopes.len()];
                !keys.iter().any(|key| key.is_nan()) && front.beats_from(keys, least_index)
            }
            Rival::Top(last) => {
                let key = search.targets[0].rule.key(hopes[0]);
                last.is_some_and(|(worst, index)| worst < key || worst == key && index < least_index)
            }
            Rival::Cells(map, cells) => {
                let key = search.targets[0].rule.key(hopes[0]);
                cells.count(spans) <= LOOKED_AT && cells.of(spans).all(|cell| map.beats(cell, key, least_index))
            }
            Rival::Extreme(held) => held.is_some_and(|held| {
                let Sought::Extreme { largest, .. } = search.sought else { return false };
                let beyond = if largest { held.value > hopes[0] } else { held.value < hopes[0] };
                beyond || held.value == hopes[0] && held.index < least_index
            }),
        }
    }
}
