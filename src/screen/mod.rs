//! Screening: every design judged over every scenario, a block of designs of one row at a time.
//!
//! An engine turns a range of positions into [`Block`]s; the reducers absorb them and never know where they came from.

mod cpu;
mod decisive;
#[cfg(feature = "gpu")]
pub mod gpu;
mod judged;
mod kept_rows;
mod ordered;
mod row_list;
mod rows_together;
mod spectrum;
mod tables;
mod tally;
mod turned_list;

pub use cpu::CpuEngine;
pub use judged::JudgedDesigns;
pub use ordered::{SortedDesigns, SortedRow};
pub use tables::{BLOCK, Tables};
pub use tally::Tally;
pub(crate) use tally::sample;

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// What others may see and do while designs are judged.
#[derive(Debug, Default)]
pub struct Control {
    /// Designs of the sample, once it is known how many they are.
    pub sample: AtomicU64,
    /// Of these, designs looked at so far.
    pub sampled: AtomicU64,
    /// Designs judged so far, those of a resumed checkpoint included; while the sample judges all designs for the sweep, those of the sample.
    /// By bounds: the settled share, over all that is searched for.
    pub done: AtomicU64,
    /// By bounds: what boxes are being settled for.
    pub settling: Mutex<Option<String>>,
    /// Designs that are reported, once it is known how many they are; one that stands in two lists counts twice.
    pub reported: AtomicU64,
    /// Of these, designs certified so far.
    pub certified: AtomicU64,
    /// Set to end the work as soon as may be, keeping the checkpoint.
    pub stop: AtomicBool,
}

impl Control {
    /// What boxes are being settled for, if bounds judge them.
    pub fn settled_for(&self) -> Option<String> {
        self.settling.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Says so.
    pub(crate) fn settles(&self, what: String) {
        *self.settling.lock().unwrap_or_else(PoisonError::into_inner) = Some(what);
    }

    /// Says that bounds are left: from now on designs are judged, so many of which are done.
    pub(crate) fn judges(&self, done: u64) {
        *self.settling.lock().unwrap_or_else(PoisonError::into_inner) = None;
        self.done.store(done, Ordering::Relaxed);
    }
}

/// Judged designs: who is feasible, and the worst values of what the plan tracks.
#[derive(Clone, Copy, Debug)]
pub struct Block<'a> {
    /// Part of the design index that the row contributes; zero where the designs are of several rows.
    pub row_index: u64,
    /// Part of the design index that each lane contributes.
    pub offsets: &'a [u64],
    /// Number of feasible designs, at least 1.
    pub feasible_count: u64,
    /// All ones for a feasible design, else zero; one entry per design.
    pub alive: &'a [u64],
    /// One column per tracked quantity, in its unit; may be longer; meaningful for feasible designs only.
    pub values: &'a [Vec<f64>],
}

impl<'a> Block<'a> {
    /// Number of designs.
    pub fn count(&self) -> usize {
        self.alive.len()
    }

    /// The values of one tracked quantity.
    pub fn column(&self, column: usize) -> &'a [f64] {
        &self.values[column][..self.alive.len()]
    }

    /// Lanes of feasible designs.
    pub fn feasible(&self) -> impl Iterator<Item = usize> + use<'a> {
        let alive = self.alive;
        (0..alive.len()).filter(|&lane| alive[lane] != 0)
    }

    /// Design index of a lane.
    pub fn index(&self, lane: usize) -> u64 {
        self.row_index + self.offsets[lane]
    }
}
