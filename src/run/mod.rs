//! A study from beginning to end: what judges its designs is chosen, they are swept, and what is reported is certified.
//!
//! This is the door to the library: [`Study::sweep`](crate::study::Study::sweep) with [`Options`] gives an [`Outcome`], all in memory;
//! [`Stored`] is what a result directory says. The command line does the same in steps, with a checkpoint in between.

#[doc(hidden)]
#[cfg_attr(not(feature = "gpu"), path = "no_device.rs")]
pub mod device;
#[doc(hidden)]
pub mod judge;
#[doc(hidden)]
pub mod method;
mod options;
mod outcome;
mod stored;

pub use crate::export::Knee;
pub use crate::reduce::Extreme;
pub use crate::screen::Control;
pub use options::{Engine, Judging, Options};
pub use outcome::{Counts, Course, Highlights, Limit, Named, Outcome, Spread};
pub use stored::Stored;
