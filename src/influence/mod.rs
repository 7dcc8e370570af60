//! Which input of a study matters: what uncertain inputs do to a design, and what design choices do over all designs.
//!
//! A [`InfluenceSubject`] has the inputs that vary, its *factors*, and the quantities that are asked about, each in its worst operating case
//! (over the design: in its worst scenario), or as the mean or sum that the study asks for. One more quantity is `holds`: 1 where every
//! constraint is kept with status ok, else 0. How much of a quantity's variance comes from which factor is
//!
//! - counted exactly where all factors have levels and their combinations are few: each combination is as likely as any other;
//! - else estimated by draws, from the distributions of the factors, or over their levels.
//!
//! Nothing here depends on the number of threads.

mod brief;
#[cfg(feature = "pictures")]
mod drawings;
mod drawn;
mod evaluated;
mod factor;
mod files;
mod grid;
mod report;
mod results;
mod subject;
mod tornado;

pub use crate::study::{HOLDS, InfluenceOver};
pub use brief::brief;
pub use factor::InputFactor;
pub use files::{files, files_of, is_influence_file, json, table, tornado_table, write};
pub use results::{
    Estimate, InfluenceMethod, InfluenceReport, InputReport, QuantityReport, QuantityVerdict, TornadoBar, TornadoReport, WithinHolding,
};
pub use subject::{InfluenceSubject, InfluenceWork, QuantityAsked};
