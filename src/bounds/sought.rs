//! What a search is for, the numbers that it is about, and how it settled the designs.

use super::bounder::AskedNumber;
use crate::reduce::KeyRule;

/// What is searched for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sought {
    /// The Pareto front.
    Front,
    /// The best by one quantity.
    Top,
    /// The best of every cell of the map with this number.
    Cells(usize),
    /// The least (or largest) worst value of an objective.
    Extreme {
        /// Number of the objective.
        objective: usize,
        /// The largest?
        largest: bool,
    },
}

/// A number whose worst value is bounded, and how.
#[derive(Debug)]
pub struct Target {
    /// The number, worse in the direction of its goal.
    pub asked: AskedNumber,
    /// What it is compared by.
    pub rule: KeyRule,
    /// Is it an extreme that is sought at its bad end?
    pub at_the_bad_end: bool,
    /// What limits it through a number that it shares factors with.
    pub limits: Vec<QuotientLimit>,
}

/// A requirement that limits a number through their quotient, without the factors that cancel.
#[derive(Debug)]
pub struct QuotientLimit {
    /// The quotient, of the better over the worse.
    pub quotient: AskedNumber,
    /// What the requirement is about.
    pub limited: AskedNumber,
    /// Its bound, times what takes the quotient from SI to the units of both.
    pub bound: f64,
}

/// The product of both objectives, without the factors that cancel: larger where better.
#[derive(Debug)]
pub struct ObjectiveProduct {
    /// In SI.
    pub asked: AskedNumber,
    /// What takes it to the units of both.
    pub unit: f64,
    /// Which objectives are to be large.
    pub largest: [bool; 2],
}

/// How the designs of a search were settled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Searched {
    /// In boxes that surely violate a requirement.
    pub infeasible: u64,
    /// In boxes that cannot hold what is sought. Of a sample: all that its last look at the order had no need to judge.
    pub beaten: u64,
    /// In boxes of two groups of axes.
    pub pairs: u64,
    /// Judged in f64.
    pub evaluated: u64,
    /// Boxes looked at.
    pub boxes: u64,
    /// Designs judged in f64, those that were tried as rivals among them.
    pub evaluations: u64,
    /// The feasible designs, where all of them were counted on the way.
    pub counted: Option<u64>,
}

impl Searched {
    /// All designs that were settled.
    pub fn designs(&self) -> u64 {
        self.infeasible + self.beaten + self.pairs + self.evaluated
    }

    /// Adds what another search settled.
    pub(super) fn add(&mut self, other: &Self) {
        self.infeasible += other.infeasible;
        self.beaten += other.beaten;
        self.pairs += other.pairs;
        self.evaluated += other.evaluated;
        self.boxes += other.boxes;
        self.evaluations += other.evaluations;
    }
}
