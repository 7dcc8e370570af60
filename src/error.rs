//! What can go wrong, by what the user can do about it.
//!
//! Messages name the thing, the value, the limit and the remedy, in the user's own names and units.

use crate::study::StudyErrors;
use std::path::{Path, PathBuf};

/// An error of the library and the command line.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The study file asks for something that cannot be.
    #[error(transparent)]
    Study(#[from] StudyErrors),
    /// A request that cannot be met as it stands: a wrong name, value or combination of options.
    #[error("{0}")]
    Request(String),
    /// The run was stopped by the user; its checkpoint is kept.
    #[error("stopped; what is done is kept in {checkpoint}, go on with: {resume}")]
    Stopped {
        /// Where the checkpoint is.
        checkpoint: String,
        /// The command that resumes.
        resume: String,
    },
    /// More non-dominated designs than the study's budget.
    #[error(
        "the Pareto front has more than {budget} points; give objectives a resolution, such as {example}, drop an objective, or raise front_budget in [report]"
    )]
    FrontBudget {
        /// The budget.
        budget: u64,
        /// An objective of the study with a resolution.
        example: String,
    },
    /// A graphics device failed; the run's checkpoint is kept.
    #[error("{device}: {problem}")]
    Gpu {
        /// Name of the adapter.
        device: String,
        /// What went wrong.
        problem: String,
    },
    /// What a device computed is farther from f64 than promised: nothing that it says can be used.
    #[error("{0}")]
    Promise(String),
    /// A result is complete, but the page that shows it could not be made.
    #[error("{0}")]
    Page(String),
    /// What was computed twice does not agree: the program is wrong and says so rather than report it.
    #[error("{0}; this is a fault of the program, please report it with the study")]
    Certificate(String),
    /// A checkpoint or shard that cannot be used.
    #[error("{path}: {problem}")]
    Checkpoint {
        /// The folder.
        path: PathBuf,
        /// What is wrong with it and what to do.
        problem: String,
    },
    /// Reading or writing failed.
    #[error("{path}: {source}")]
    Io {
        /// Where.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

impl Error {
    /// Wraps an I/O error with the path it happened at; for `map_err`.
    pub fn io(path: &Path) -> impl FnOnce(std::io::Error) -> Self + '_ {
        move |source| Self::Io { path: path.to_owned(), source }
    }

    /// The process exit code: 2 for a wrong request, 1 for a failure while running.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Study(_) | Self::Request(_) => 2,
            Self::Io { .. }
            | Self::Stopped { .. }
            | Self::FrontBudget { .. }
            | Self::Gpu { .. }
            | Self::Promise(_)
            | Self::Page(_)
            | Self::Certificate(_)
            | Self::Checkpoint { .. } => 1,
        }
    }
}

/// What the library returns.
pub type Result<T> = std::result::Result<T, Error>;
