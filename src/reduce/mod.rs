//! Reducers: what remains of billions of designs.
//!
//! Each takes in blocks in any order, merges with another that took in other blocks, and ends up the same whatever the split:
//! counts are integers, ties go to the lowest design index, and no floats are added. Memory is bounded by the front, the best
//! K, the bins and the map cells.
//!
//! What `[report]` asks for are [`Reducer`]s, see there for what a new one takes; the front and the extremes, which every engine is
//! built around, are not.

mod answers;
mod dominance;
mod extremes;
mod feasible;
mod front;
pub(crate) mod histogram;
mod list;
pub(crate) mod map;
mod naming;
mod reducer;
mod sample;
mod top;

pub use answers::Answers;
pub use dominance::{Dominance, beats};
pub use extremes::{Extreme, Extremes};
pub use feasible::{FEASIBLE_FILE, FeasibleCursor, FeasibleList};
pub use front::{FRONT_BYTES, FreeObjectives, Front, KeyRule, KnownFront, MOST_OBJECTIVES, Points, most_points, slice_bytes};
pub use histogram::Histogram;
pub use list::{Places, Reported};
pub use map::{CSV_CELLS, Cell, Map};
pub use reducer::{Put, Reducer, ReducerNeeds, ReducerResults, ReducerRoom};
pub use sample::{FeasibleSample, ROUNDS, Shuffle};
pub use top::Top;

use crate::plan::Plan;
use crate::screen::Block;
use serde::{Deserialize, Serialize};

/// Where each reducer finds its values in a block, and how it starts.
#[derive(Debug)]
pub struct Reduction {
    rules: Vec<KeyRule>,
    objectives: Vec<usize>,
    reported: Reported,
}

impl Reduction {
    /// The reducers that a plan asks for; `ranges` has the range of every histogram.
    pub fn new(plan: &Plan, ranges: &[(f64, f64)]) -> Self {
        Self {
            rules: plan.study.objectives.iter().map(KeyRule::from).collect(),
            objectives: plan.objectives.clone(),
            reported: Reported::new(plan, ranges),
        }
    }

    /// Those of the front and the extremes only: nothing that the report asks for is kept.
    pub(crate) fn of_front(plan: &Plan) -> Self {
        let rules = plan.study.objectives.iter().map(KeyRule::from).collect();
        Self { rules, objectives: plan.objectives.clone(), reported: Reported::default() }
    }

    /// The same with a sample of the feasible designs.
    pub(crate) fn of_front_and_sample(plan: &Plan, count: usize) -> Self {
        let reported = Reported { samples: vec![FeasibleSample::new(count, 0)], ..Reported::default() };
        Self { reported, ..Self::of_front(plan) }
    }

    /// The range of every histogram.
    pub fn histogram_ranges(&self) -> Vec<(f64, f64)> {
        self.reported.histograms.iter().map(|histogram| (histogram.from, histogram.to)).collect()
    }

    /// How objectives are compared.
    pub fn rules(&self) -> &[KeyRule] {
        &self.rules
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
            extremes: Extremes::new(self.objectives.len()),
            reported: self.reported.clone(),
        }
    }

    /// The front of what several reducers have seen, each of other designs.
    pub fn front_together(&self, reducers: Vec<Reducers>) -> Points {
        front::together(reducers.into_iter().map(|it| it.front).collect())
    }

    /// Takes in a block.
    pub fn absorb(&self, reducers: &mut Reducers, block: &Block<'_>) {
        reducers.feasible += block.feasible_count;
        self.absorb_objectives(reducers, block);
        reducers.reported.absorb(block);
    }

    /// Takes in a block of designs that were counted elsewhere: for the front, the extremes and what asks for candidates.
    pub fn absorb_counted(&self, reducers: &mut Reducers, block: &Block<'_>) {
        self.absorb_objectives(reducers, block);
        reducers.reported.absorb_counted(block);
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
        reducers.reported.top.iter_mut().for_each(|top| top.absorb(block));
    }

    /// Takes in a block of which the values of one map are known: for the best of its cells.
    pub fn absorb_cells(&self, reducers: &mut Reducers, block: &Block<'_>, map: usize) {
        reducers.reported.maps[map].absorb_counted(block);
    }

    /// Adds counts that were made elsewhere: feasible designs, and those that each reducer asks a device for.
    pub fn add_counts(&self, reducers: &mut Reducers, feasible: u64, counts: &[Vec<u32>]) {
        reducers.feasible += feasible;
        reducers.reported.add_counts(counts);
    }

    /// Can this be what remains of at most `met` designs, all of them below `designs`? A state that was read may have been changed.
    ///
    /// # Errors
    /// The part that cannot be.
    pub fn check(&self, state: &State, met: u64, designs: u64) -> Result<(), String> {
        let State { feasible, front, extremes, reported } = state;
        let objectives = self.objectives.len();
        let whole_points = front.indices.len().checked_mul(objectives) == Some(front.keys.len());
        let no_front = objectives > 0 || front.indices.is_empty();
        let parts = [
            ("number of feasible designs", *feasible <= met),
            ("front", whole_points && no_front && front.keys.iter().all(|key| !key.is_nan())),
            ("front's designs", front.indices.iter().all(|&index| index < designs)),
            ("extremes", extremes.fits(objectives, designs)),
        ];
        let misfit = parts.into_iter().find(|(_, fits)| !fits).map(|(part, _)| part);
        match misfit.or_else(|| reported.misfit(&self.reported, met, designs)) {
            Some(part) => Err(format!("its {part} cannot be of this study")),
            None => Ok(()),
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
    /// Least and largest objective values.
    pub extremes: Extremes,
    /// What the report asks for.
    pub reported: Reported,
}

/// The same as plain data: what a chunk hands over and a checkpoint keeps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Number of feasible designs.
    pub feasible: u64,
    /// Points of the front.
    pub front: Points,
    /// Least and largest objective values.
    pub extremes: Extremes,
    /// What the report asks for.
    pub reported: Reported,
}

impl State {
    /// Does this name designs as `fuller` does, which has taken in all that this has and more? Else this has missed some.
    pub fn names_all_of(&self, fuller: &Self) -> bool {
        self.front == fuller.front && self.extremes == fuller.extremes && self.reported.lacks(&fuller.reported).is_none()
    }
}

impl Reducers {
    /// What a chunk hands over: all but the front points that it was given.
    pub fn into_fresh(self) -> State {
        let Self { feasible, front, extremes, reported } = self;
        State { feasible, front: front.into_fresh(), extremes, reported }
    }

    /// A copy of everything.
    pub fn state(&mut self) -> State {
        State {
            feasible: self.feasible,
            front: self.front.points().clone(),
            extremes: self.extremes.clone(),
            reported: self.reported.state(),
        }
    }

    /// Takes in what was made of other designs.
    pub fn merge(&mut self, other: State) {
        self.feasible += other.feasible;
        self.front.merge(other.front);
        self.extremes.merge(&other.extremes);
        self.reported.merge(other.reported);
    }
}
