//! Which input matters: how much of the variation of a quantity comes from each of its uncertain inputs.
//!
//! Every function takes the quantity as a closure over the values of the inputs, in the order in which these are given.
//!
//! - [`sobol_indices`]: shares of the variance by each input alone and with others, for independent inputs.
//! - [`shapley_effects`]: shares that add up to one also where inputs are correlated, from the variance that each set of inputs explains.
//! - [`morris_screening`]: which of many inputs do nothing, by few evaluations.
//!
//! ```
//! use beltspace::probability::Distribution;
//! use beltspace::sensitivity::sobol_indices;
//!
//! // The torque of a drive at the edge of slip, by Eytelwein: friction matters more than the tension.
//! let inputs = [("friction", Distribution::normal(0.3, 0.03)?), ("tension_N", Distribution::uniform(450.0, 550.0)?)];
//! let indices = sobol_indices(&inputs, 4096, 1, |x| x[1] * (1.0 - (-3.0 * x[0]).exp()) * 0.05)?;
//! assert!(indices[0].first.mean > indices[1].first.mean);
//! # Ok::<(), beltspace::Error>(())
//! ```

mod morris;
mod shapley;
mod sobol;
mod tally;

pub(crate) use morris::MorrisWalks;
pub use morris::{Effects, morris_screening};
pub(crate) use shapley::ShapleySets;
pub use shapley::shapley_effects;
pub use sobol::{Indices, sobol_indices};
pub(crate) use sobol::{PairedValues, all_but, all_of};
pub(crate) use tally::GridTally;
