//! Uncertain inputs: how likely their values are, draws of them, and how sure a count of draws is.
//!
//! A [`Distribution`] says how likely the values of an input are: friction, a tolerance, a load. [`Draws`] take values of all uncertain
//! inputs from their distributions, with correlations, each draw standing for one drive as built. Numbers are in the unit of the input,
//! and everything is computed in f64 with the same result on every machine. A wrong parameter is a [`ProbabilityProblem`] whose message names it, its
//! value and its limit.
//!
//! ```
//! use beltspace::probability::Distribution;
//!
//! // Friction as measured, cut off where no belt has ever been.
//! let friction = Distribution::normal(0.08, 0.006)?.truncated(0.07, 0.11)?;
//! assert!((friction.quantile(0.05)? - 0.07215).abs() < 1e-5);
//! assert!((friction.mean() - 0.08063).abs() < 1e-5 && friction.sd() < 0.006);
//! # Ok::<(), beltspace::Error>(())
//! ```

mod cells;
mod confidence;
mod correlation;
mod distribution;
mod draws;
mod enclosure;
mod half_space;
mod moments;
mod outward;
mod paired;
mod problem;
mod slabs;
mod special;
mod statistics;

pub(crate) use cells::{DrawCell, DrawCells, DrawnPoint};
pub use confidence::{ConfidenceInterval, clopper_pearson, simultaneous};
pub use distribution::Distribution;
pub use draws::{Draws, Effect, Sampling};
pub use enclosure::Enclosure;
pub(crate) use enclosure::{CellVerdict, Judge, enclose};
pub(crate) use half_space::DIMENSIONS;
pub(crate) use paired::{PairedDraws, REPLICATES};
pub use problem::ProbabilityProblem;
pub(crate) use slabs::{Margin, Slabs};
pub use statistics::{Replicated, mean, pearson, quantile, replicated, sd, spearman, worst};
