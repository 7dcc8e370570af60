//! Screening on a GPU, in f32 with bounds; what many designs share in f64 where the device has it.
//!
//! The device judges every design over all scenarios with three-valued decisions, counts what is surely feasible and hands back
//! the few designs that are unsure or may be part of an answer: those go to f64. Nothing that it computes is reported.

mod constants;
mod cut;
mod drawn;
mod engine;
mod held;
mod kernel;
mod known;
mod layout;
mod row_scenarios;
mod sorted;
mod texts;
mod wrong;

pub use crate::reduce::Answers;
pub use engine::{Checked, GpuEngine, InFlight, Survivor, Survivors, TileCounts, kernel_of, supports, supports_histograms};
pub(crate) use held::on_device;
pub(crate) use kernel::value_maps;
pub use wrong::Wrong;
