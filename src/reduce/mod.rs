//! Reducers: what remains of billions of designs.
//!
//! Each takes in blocks in any order, merges with another that took in other blocks, and ends up the same whatever the split:
//! counts are integers, ties go to the lowest design index, and no floats are added. Memory is bounded by the front, the best
//! K, the bins and the map cells.

mod dominance;
mod extremes;
mod front;
mod histogram;
mod map;
mod top;

pub use dominance::{Dominance, beats};
pub use extremes::{Extreme, Extremes};
pub use front::{Front, KeyRule, MOST_OBJECTIVES, Points};
pub use histogram::Histogram;
pub(crate) use map::DENSE;
pub use map::{Cell, Map};
pub use top::Top;

use crate::plan::{Plan, Tracked, worst_end};
use crate::screen::Block;
use crate::study::{Best, Quantity};
use serde::{Deserialize, Serialize};

/// Where each reducer finds its values in a block, and how it starts.
#[derive(Debug)]
pub struct Reduction {
    rules: Vec<KeyRule>,
    objectives: Vec<usize>,
    top: Option<(usize, Top)>,
    histograms: Vec<(usize, Histogram)>,
    maps: Vec<(Option<usize>, Map)>,
}

impl Reduction {
    /// The reducers that a plan asks for; `ranges` has the range of every histogram.
    pub fn new(plan: &Plan, ranges: &[(f64, f64)]) -> Self {
        let study = &plan.study;
        let column = |quantity: Quantity, worse| {
            let wanted = Tracked { quantity, worse };
            plan.tracked.iter().position(|(it, _)| *it == wanted).expect("the plan tracks what the report asks for")
        };
        let histograms = study.report.histograms.iter().zip(ranges);
        Self {
            rules: study.objectives.iter().map(KeyRule::from).collect(),
            objectives: plan.objectives.clone(),
            top: study.report.top.map(|top| (column(top.by, top.goal.worse()), Top::new(top.goal, top.count))),
            histograms: histograms
                .map(|(spec, &range)| (column(spec.of, worst_end(study, spec.of)), Histogram::new(range, spec.bins)))
                .collect(),
            maps: study
                .report
                .maps
                .iter()
                .map(|spec| {
                    let column = match spec.value {
                        Best::Value(quantity, goal) => Some(column(quantity, goal.worse())),
                        Best::Share => None,
                    };
                    (column, Map::new(plan, spec))
                })
                .collect(),
        }
    }

    /// The range of every histogram.
    pub fn histogram_ranges(&self) -> Vec<(f64, f64)> {
        self.histograms.iter().map(|(_, histogram)| (histogram.from, histogram.to)).collect()
    }

    /// Reducers that have seen nothing.
    pub fn start(&self) -> Reducers {
        self.start_after(Points::default())
    }

    /// Reducers that have seen nothing, whose front may drop what these points of another front beat.
    pub fn start_after(&self, known: Points) -> Reducers {
        Reducers {
            feasible: 0,
            front: Front::seeded(&self.rules, known),
            top: self.top.as_ref().map(|(_, top)| top.clone()),
            extremes: Extremes::new(self.objectives.len()),
            histograms: self.histograms.iter().map(|(_, histogram)| histogram.clone()).collect(),
            maps: self.maps.iter().map(|(_, map)| map.clone()).collect(),
        }
    }

    /// Takes in a block.
    pub fn absorb(&self, reducers: &mut Reducers, block: &Block<'_>) {
        reducers.feasible += block.feasible_count;
        reducers.front.absorb(block, &self.objectives);
        reducers.extremes.absorb(block, self.objectives.iter().copied().enumerate());
        if let (Some((column, _)), Some(top)) = (&self.top, &mut reducers.top) {
            top.absorb(block, *column);
        }
        for ((column, _), histogram) in self.histograms.iter().zip(&mut reducers.histograms) {
            histogram.absorb(block, *column);
        }
        for ((column, _), map) in self.maps.iter().zip(&mut reducers.maps) {
            map.absorb(block, *column);
        }
    }

    /// Takes in a block of designs that were counted elsewhere: for the front, the extremes, the top list and the maps' best only.
    pub fn absorb_counted(&self, reducers: &mut Reducers, block: &Block<'_>) {
        self.absorb_objectives(reducers, block);
        self.absorb_top(reducers, block);
        for ((column, _), map) in self.maps.iter().zip(&mut reducers.maps) {
            if column.is_some() {
                map.absorb(block, *column);
            }
        }
    }

    /// Takes in a block of which only the objectives are known: for the front and the extremes.
    pub fn absorb_objectives(&self, reducers: &mut Reducers, block: &Block<'_>) {
        reducers.front.absorb(block, &self.objectives);
        reducers.extremes.absorb(block, self.objectives.iter().copied().enumerate());
    }

    /// Takes in a block of which one objective is known: for its extremes.
    pub fn absorb_objective(&self, reducers: &mut Reducers, block: &Block<'_>, objective: usize) {
        reducers.extremes.absorb(block, std::iter::once((objective, self.objectives[objective])));
    }

    /// Takes in a block of which what the top list is by is known: for that.
    pub fn absorb_top(&self, reducers: &mut Reducers, block: &Block<'_>) {
        if let (Some((column, _)), Some(top)) = (&self.top, &mut reducers.top) {
            top.absorb(block, *column);
        }
    }

    /// Adds counts that were made elsewhere: feasible designs, per histogram below, bins and above, per map of shares its cells.
    pub fn add_counts(&self, reducers: &mut Reducers, feasible: u64, histograms: &[Vec<u32>], shares: &[Vec<u32>]) {
        reducers.feasible += feasible;
        for (histogram, counts) in reducers.histograms.iter_mut().zip(histograms) {
            histogram.add(counts);
        }
        let of_shares = self.maps.iter().zip(&mut reducers.maps).filter(|((column, _), _)| column.is_none());
        for ((_, map), counts) in of_shares.zip(shares) {
            map.add(counts);
        }
    }

    /// Reducers from what a checkpoint kept.
    pub fn restore(&self, state: State) -> Reducers {
        let mut reducers = self.start();
        reducers.merge(state);
        reducers
    }
}

/// Everything that is kept of the designs seen so far.
#[derive(Debug)]
pub struct Reducers {
    /// Number of feasible designs.
    pub feasible: u64,
    /// The Pareto front.
    pub front: Front,
    /// The best by one quantity.
    pub top: Option<Top>,
    /// Least and largest objective values.
    pub extremes: Extremes,
    /// Histograms.
    pub histograms: Vec<Histogram>,
    /// Maps.
    pub maps: Vec<Map>,
}

/// The same as plain data: what a chunk hands over and a checkpoint keeps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Number of feasible designs.
    pub feasible: u64,
    /// Points of the front.
    pub front: Points,
    /// The best by one quantity.
    pub top: Option<Top>,
    /// Least and largest objective values.
    pub extremes: Extremes,
    /// Histograms.
    pub histograms: Vec<Histogram>,
    /// Maps.
    pub maps: Vec<Map>,
}

impl Reducers {
    /// What a chunk hands over: all but the front points that it was given.
    pub fn into_fresh(self) -> State {
        let Self { feasible, front, top, extremes, histograms, maps } = self;
        State { feasible, front: front.into_fresh(), top, extremes, histograms, maps }
    }

    /// A copy of everything.
    pub fn state(&mut self) -> State {
        State {
            feasible: self.feasible,
            front: self.front.points().clone(),
            top: self.top.clone(),
            extremes: self.extremes.clone(),
            histograms: self.histograms.clone(),
            maps: self.maps.clone(),
        }
    }

    /// Takes in what was made of other designs.
    pub fn merge(&mut self, other: State) {
        self.feasible += other.feasible;
        self.front.merge(other.front);
        if let (Some(top), Some(other)) = (&mut self.top, other.top) {
            top.merge(other);
        }
        self.extremes.merge(&other.extremes);
        for (histogram, other) in self.histograms.iter_mut().zip(&other.histograms) {
            histogram.merge(other);
        }
        for (map, other) in self.maps.iter_mut().zip(other.maps) {
            map.merge(other);
        }
    }
}
