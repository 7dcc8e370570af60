//! What a user of the library may say about a sweep.

use crate::reduce::FRONT_BYTES;
use crate::screen::Control;
use std::num::NonZero;
use std::sync::Arc;

/// What judges the designs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[non_exhaustive]
pub enum Engine {
    /// A GPU if there is one and the study is large enough for it, else the CPU
    #[default]
    Auto,
    /// A GPU, or a software driver; what it cannot decide the CPU decides in f64
    Gpu,
    /// The CPU, in f64
    Cpu,
}

/// How designs are judged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[non_exhaustive]
pub enum Judging {
    /// Bounds if the study allows them and judging every design would take a second or more; given up if they are slower
    #[default]
    Auto,
    /// Every design, one by one
    Exhaustive,
    /// Whole boxes of designs, by bounds of the formulas; run.json then says which rules settled how many designs
    Bounds,
}

/// How a study is swept. Nothing here changes a result.
///
/// ```
/// use beltspace::{Engine, Options};
///
/// let options = Options::default().engine(Engine::Cpu).threads(2);
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Options {
    /// What judges the designs.
    pub engine: Engine,
    /// How they are judged.
    pub judging: Judging,
    /// The GPU to use, by any part of its name in upper or lower case. `None`: the best.
    pub adapter: Option<String>,
    /// Worker threads, at least 1. By default one per core.
    pub threads: usize,
    /// Most bytes for the front during the sweep. By default 4 GiB.
    pub front_bytes: u64,
    /// Shows the progress of the sweep, and stops it.
    pub control: Arc<Control>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            engine: Engine::Auto,
            judging: Judging::Auto,
            adapter: None,
            threads: std::thread::available_parallelism().map_or(1, NonZero::get),
            front_bytes: FRONT_BYTES,
            control: Arc::default(),
        }
    }
}

impl Options {
    /// The same with another engine.
    #[must_use]
    pub fn engine(self, engine: Engine) -> Self {
        Self { engine, ..self }
    }

    /// The same with another method.
    #[must_use]
    pub fn judging(self, judging: Judging) -> Self {
        Self { judging, ..self }
    }

    /// The same on the GPU whose name contains this, in upper or lower case.
    #[must_use]
    pub fn adapter(self, name: impl Into<String>) -> Self {
        Self { adapter: Some(name.into()), ..self }
    }

    /// The same with this many threads, at least 1.
    #[must_use]
    pub fn threads(self, threads: usize) -> Self {
        Self { threads: threads.max(1), ..self }
    }

    /// The same with this many bytes for the front during the sweep.
    #[must_use]
    pub fn front_bytes(self, front_bytes: u64) -> Self {
        Self { front_bytes, ..self }
    }

    /// The same with a control, through which its other holders follow and stop the sweep.
    #[must_use]
    pub fn control(self, control: Arc<Control>) -> Self {
        Self { control, ..self }
    }
}
