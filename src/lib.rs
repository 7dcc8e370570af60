//! Belt-drive designs by the billion: every combination of what the engineer may choose, judged in the worst of everything the
//! drive must survive, down to the exact Pareto front.
//!
//! A [`Study`] names a [model](models), which of its inputs the engineer chooses (the design), which the drive must survive (the
//! operation) and which nobody knows exactly (the uncertainty). [`Study::sweep`] judges every design in every scenario and gives an
//! [`Outcome`]:
//!
//! ```
//! use beltspace::{Options, Study};
//!
//! let text = r#"
//!     model = "metal-cvt"
//!     [design]
//!     band_thickness_mm = { from = 0.1, to = 0.4, count = 31 }
//!     band_count = { from = 4, to = 14 }
//!     [constraints]
//!     capacity_axial_force_N = { max = 30000 }
//!     [objectives]
//!     torque_capacity_Nm = "max"
//!     capacity_axial_force_N = "min"
//! "#;
//! let outcome = Study::parse(text)?.sweep(Options::default())?;
//! assert_eq!((outcome.counts.designs, outcome.counts.feasible), (341, 102));
//! let knee = outcome.summary.knee.expect("there is a front").row;
//! let torque = outcome.front.number("torque_capacity_Nm", knee).expect("an objective has a value");
//! assert!(torque > 0.0);
//! # Ok::<(), beltspace::Error>(())
//! ```
//!
//! # The doors
//!
//! - [`Study::parse`] and [`Study::read`] check a study, [`Study::sweep`] judges it; [`Options`] choose threads, engine and method, and
//!   change no result.
//! - [`models::evaluate`] and [`models::evaluate_many`] evaluate designs without a study.
//! - [`probability`] draws uncertain inputs from their distributions, and says how sure a count of draws is; [`sensitivity`] tells which of
//!   them matter.
//! - [`Stored::read`] reads the directory that `beltspace sweep` has written.
//! - `gpu::adapters` lists the GPUs of this machine, for [`Options::adapter`].
//!
//! Each has an example in `examples/`. Errors are variants of [`Error`], whose messages name the thing, the value, the limit and the
//! remedy.
//!
//! # Features
//!
//! All are on by default; without them the crate takes half as many packages, and sweeps all the same.
//!
//! - `cli`: the program. Implies `parquet` and `pictures`.
//! - `gpu`: sweeps on a GPU. Without it asking for one is an error.
//! - `parquet`: tables in Parquet in a result directory. Without it there are those in CSV.
//! - `pictures`: pictures, pages, and the papers' figures.
//!
//! # What is behind them
//!
//! ```text
//! study.toml -> study -> space, plan -> tiles -> screen -> reduce -> certify -> export -> report
//! ```
//!
//! `plan` splits the `space` of designs into what is slow and what is fast, `screen` judges it, eight designs at a time in f64 or on a
//! graphics device (`gpu`) in f32 with error bounds, `reduce` keeps what matters of it, `sweep` runs that with a `checkpoint`, `certify`
//! computes what is reported once more with the scalar f64 reference, `contours` finds the lines over maps, `export` writes it, and
//! `report` makes a page of it. `papers` computes the papers behind the models again, `run` puts it all together. A module imports only
//! what stands to its left, and `models`, `real`, `units` and `error`.
//!
//! These modules are public for the program and its tests only: they are not shown here, and may change with every version.

// The program is written as a user of the library.
extern crate self as beltspace;

#[doc(hidden)]
pub mod batch;
#[doc(hidden)]
pub mod bounds;
#[doc(hidden)]
pub mod certify;
#[doc(hidden)]
pub mod checkpoint;
#[cfg(feature = "cli")]
mod cli;
#[cfg(feature = "cli")]
mod commands;
#[doc(hidden)]
pub mod contours;
mod decimal;
#[doc(hidden)]
pub mod decision;
#[doc(hidden)]
pub mod directory;
pub mod error;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod explore;
#[doc(hidden)]
pub mod export;
#[doc(hidden)]
pub mod files;
#[doc(hidden)]
pub mod findings;
#[doc(hidden)]
pub mod formula;
#[cfg(feature = "gpu")]
pub mod gpu;
#[doc(hidden)]
pub mod influence;
mod interned;
#[doc(hidden)]
pub mod keys;
#[doc(hidden)]
pub mod likeness;
#[doc(hidden)]
pub mod live;
mod masks;
#[doc(hidden)]
pub mod memory;
#[doc(hidden)]
pub mod merge;
pub mod models;
#[doc(hidden)]
pub mod names;
#[cfg(feature = "pictures")]
#[doc(hidden)]
pub mod papers;
#[doc(hidden)]
pub mod parallel;
#[cfg(feature = "pictures")]
#[doc(hidden)]
pub mod pictures;
#[doc(hidden)]
pub mod plan;
pub mod probability;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod program;
#[doc(hidden)]
pub mod pulley;
#[cfg(feature = "pictures")]
mod reading;
pub mod real;
#[doc(hidden)]
pub mod reduce;
#[cfg(feature = "pictures")]
#[doc(hidden)]
pub mod report;
#[doc(hidden)]
pub mod result_files;
pub mod run;
mod sample;
#[doc(hidden)]
pub mod screen;
pub mod sensitivity;
#[doc(hidden)]
pub mod space;
mod spread;
pub mod study;
#[doc(hidden)]
pub mod sweep;
#[doc(hidden)]
pub mod table;
pub mod tape;
#[cfg(feature = "cli")]
mod terminal;
#[doc(hidden)]
pub mod tiles;
pub mod units;
#[cfg(feature = "gpu")]
#[doc(hidden)]
pub mod verify;

pub use error::{Error, Result};
pub use run::{Control, Engine, Judging, Options, Outcome, Stored};
pub use study::Study;
pub use table::{Data, Table, TableColumn};
