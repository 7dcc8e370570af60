//! A study from beginning to end: chooses engine and method, sweeps the designs, certifies what is reported.
//!
//! [`Study::sweep`](crate::study::Study::sweep) with [`Options`] gives an [`Outcome`] in memory; [`Stored`] reads one back from a result
//! directory. The command line does the same in steps, with a checkpoint in between.

#[doc(hidden)]
#[cfg_attr(not(feature = "gpu"), path = "no_device.rs")]
pub mod device;
#[doc(hidden)]
pub mod judge;
#[doc(hidden)]
pub mod method;
mod options;
mod outcome;
mod outlook;
mod stored;

pub use crate::export::FeasibleRows;
#[cfg(feature = "pictures")]
pub use crate::export::FrontPicture;
pub use crate::export::Knee;
pub use crate::reduce::{Extreme, FeasibleCursor};
pub use crate::screen::Control;
pub use options::{Engine, Judging, Options};
pub use outcome::{Counts, Course, Highlights, Limit, Named, Outcome, Spread};
pub use outlook::Outlook;
#[doc(hidden)]
pub use outlook::warnings;
pub use stored::Stored;
