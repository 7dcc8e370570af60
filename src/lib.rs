//! Belt-drive designs by the billion: every combination of what the engineer may choose, judged in the worst of everything the
//! drive must survive, down to the exact Pareto front.
//!
//! ```text
//! study.toml -> study -> space, plan -> tiles -> screen -> reduce -> certify -> export -> report
//! ```
//!
//! A [`study`] names a [model](models), which of its inputs the engineer chooses (the design), which the drive must survive (the
//! operation) and which nobody knows exactly (the uncertainty). The [`plan`] splits the [`space`] into what is slow and what is
//! fast, [`screen`] judges it, eight designs at a time in f64 or on a graphics device ([`gpu`]) in f32 with error bounds,
//! [`reduce`] keeps what matters of it, [`sweep`] runs that with a [`checkpoint`], [`certify`] computes what is reported once more
//! with the scalar f64 reference, [`contours`] finds the lines over maps, [`export`] writes it, and [`report`] makes a page of it.
//! [`papers`] computes the papers behind the models again.
//! A module imports only what stands to its left, and `models`, `real`, `units` and `error`.
//!
//! ```
//! use beltspace::{models, plan::Plan, reduce::Reduction, screen::Tables, study::Study, sweep};
//!
//! // One design of the paper's metal belt.
//! let model = models::find("metal-cvt").unwrap();
//! let evaluation = models::evaluate(model, &model.defaults());
//! let limit = model.output("traction_limit").unwrap();
//! assert!((evaluation.outputs[limit].unwrap() - 0.577).abs() < 5e-4, "the paper measured slip at 0.58");
//!
//! // A small study of it.
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
//! let plan = Plan::new(Study::parse(text, "example.toml", ".".as_ref())?);
//! let tables = Tables::new(&plan);
//! let reduction = Reduction::new(&plan, &[]);
//! let swept = sweep::sweep(&plan, &tables, &reduction, &sweep::Options::default(), None, &sweep::Control::default())?;
//! assert_eq!(plan.designs(), 341);
//! assert!(swept.state.feasible > 0 && !swept.state.front.is_empty());
//! # Ok::<(), beltspace::error::Error>(())
//! ```

pub mod bounds;
pub mod certify;
pub mod checkpoint;
pub mod contours;
pub mod decision;
pub mod error;
pub mod export;
pub mod gpu;
pub mod merge;
pub mod models;
pub mod papers;
pub mod pictures;
pub mod plan;
pub mod pulley;
pub mod real;
pub mod reduce;
pub mod report;
mod sample;
pub mod screen;
pub mod space;
pub mod study;
pub mod sweep;
pub mod tiles;
pub mod units;
pub mod verify;
