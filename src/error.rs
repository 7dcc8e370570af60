//! What can go wrong, by what the user can do about it.
//!
//! Messages name the thing, the value, the limit and the remedy, in the user's own names and units.

use crate::study::StudyErrors;
use std::path::{Path, PathBuf};

/// An error of the library and the command line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The study file has mistakes.
    #[error(transparent)]
    Study(#[from] StudyErrors),
    /// A mistake in a distribution, in draws, or in a statement about them.
    #[error(transparent)]
    Probability(#[from] crate::probability::ProbabilityProblem),
    /// A wrong value or combination of options; the text says which and what to do.
    #[error("{0}")]
    Request(String),
    /// A model has no input of that name.
    #[error("{name} is no input of {model}{}", did_you_mean(.closest))]
    NoSuchInput {
        /// The model.
        model: String,
        /// The name that it does not have.
        name: String,
        /// The name that was probably meant.
        closest: Option<String>,
    },
    /// Columns of inputs that do not fit together.
    #[error("{}", columns(name, *rows, *expected))]
    Columns {
        /// The input.
        name: String,
        /// Rows of its column.
        rows: usize,
        /// Rows of the first column; as many as `rows` if the input has two columns.
        expected: usize,
    },
    /// No adapter has a name that contains what was asked for, or there is no adapter at all.
    #[error("{}", no_adapter(.name.as_deref(), there))]
    NoAdapter {
        /// What was asked for.
        name: Option<String>,
        /// Names of the adapters of this machine.
        there: Vec<String>,
    },
    /// The model is computed in f64 on the CPU only.
    #[error("{model} is computed in f64 on the CPU only{}", after("; ", .remedy))]
    CpuOnly {
        /// The model.
        model: String,
        /// What to do about it.
        remedy: Option<String>,
    },
    /// A device cannot serve the study.
    #[error("this study cannot be screened on a GPU: {why}; use --engine cpu")]
    NotOnDevice {
        /// Why not.
        why: String,
    },
    /// Bounds cannot serve the study.
    #[error("bounds cannot serve this study: {why}")]
    NotByBounds {
        /// Why not.
        why: String,
    },
    /// Directories that are not all the shards of one study.
    #[error("cannot merge: {}{}", in_short(problems), after("; ", .remedy))]
    NotMergeable {
        /// Which shards are missing, there twice, unfinished or of another study; at least one.
        problems: Vec<String>,
        /// What to do about it.
        remedy: Option<String>,
    },
    /// The result directory holds something that the result would replace.
    #[error("{path} {by}")]
    Occupied {
        /// The directory.
        path: PathBuf,
        /// What is there.
        by: Occupant,
    },
    /// The run was stopped by the user.
    #[error("stopped{}", way_back(.kept))]
    Stopped {
        /// What is kept, if there is a checkpoint.
        kept: Option<Kept>,
    },
    /// The front has more designs than the study's `front_budget`.
    #[error(
        "the Pareto front has {points} points, more than front_budget = {budget} allows; give objectives a resolution, such as {example}, drop an objective, or raise front_budget in [report]{resume}"
    )]
    FrontBudget {
        /// The points.
        points: u64,
        /// The budget.
        budget: u64,
        /// An objective of the study with a resolution.
        example: String,
        /// How to go on without judging the designs again.
        resume: String,
    },
    /// The front takes too much memory before the sweep has ended.
    #[error(
        "the front so far has {points} points, more than fit into {megabytes} MB; give objectives a resolution, such as {example}, or drop an objective{resume}"
    )]
    FrontMemory {
        /// The points.
        points: u64,
        /// The memory that they may take.
        megabytes: u64,
        /// An objective of the study with a resolution.
        example: String,
        /// How to go on without judging the designs again.
        resume: String,
    },
    /// A GPU failed; the run's checkpoint is kept.
    #[error("{device}: {problem}")]
    Gpu {
        /// Name of the adapter.
        device: String,
        /// What went wrong.
        problem: String,
    },
    /// A GPU broke an error bound or contradicts f64: nothing that it computed can be used.
    #[error("{0}")]
    ErrorBound(String),
    /// A result is complete, but the page that shows it could not be made.
    #[error("the result in {path} is complete, but its page could not be made ({why}); try: {again}")]
    Page {
        /// The result directory.
        path: PathBuf,
        /// Why not.
        why: Box<Error>,
        /// The command that makes the page.
        again: String,
    },
    /// Two computations of the same thing disagree. The program is wrong, and stops rather than report either.
    #[error("{0}; this is a bug in beltspace, please report it with the study")]
    Disagreement(String),
    /// A checkpoint or shard that cannot be used.
    #[error("{path}: {problem}")]
    Checkpoint {
        /// The folder.
        path: PathBuf,
        /// What is wrong with it and what to do.
        problem: String,
    },
    /// Reading or writing failed; the run's checkpoint is kept.
    #[error("{path}: {source}; what is done is kept in {checkpoint}, go on with: {resume}")]
    Interrupted {
        /// Where.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
        /// Where the checkpoint is.
        checkpoint: String,
        /// The command that resumes.
        resume: String,
    },
    /// A file of a result directory has contents that beltspace does not write.
    #[error("{path}: {problem}")]
    Result {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// Another process is using the directory.
    #[error("{path}: another beltspace is using this directory ({holder}); wait for it, or use another directory")]
    Busy {
        /// The directory.
        path: PathBuf,
        /// Which process it is, as far as that is known.
        holder: String,
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

/// The checkpoint of a run that was stopped.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kept {
    /// Where the checkpoint is.
    pub checkpoint: String,
    /// The command that resumes.
    pub resume: String,
}

/// What stands in the way of a new result.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Occupant {
    /// The directory is a file.
    #[error("is a file; name a directory with --out")]
    File,
    /// A finished result.
    #[error("holds a finished result; replace it with --force, or write to another --out")]
    Finished,
    /// An unfinished run.
    #[error("holds an unfinished run; go on with --resume, or start again with --force")]
    Unfinished,
    /// Files and folders that this program did not write.
    #[error("{}", foreign(.0))]
    Foreign(Vec<String>),
}

fn foreign(names: &[String]) -> String {
    let (it, them) = if names.len() == 1 { ("a file or folder", "it") } else { ("files or folders", "them") };
    let names = names.join(", ");
    format!("has {it} that this program did not write and a result would replace ({names}); move {them} away, or write to another --out")
}

fn after(sign: &str, text: &Option<String>) -> String {
    text.as_ref().map_or(String::new(), |text| format!("{sign}{text}"))
}

fn did_you_mean(closest: &Option<String>) -> String {
    closest.as_ref().map_or(String::new(), |closest| format!("; did you mean {closest}?"))
}

fn columns(name: &str, rows: usize, expected: usize) -> String {
    if rows == expected {
        return format!("there are two columns {name}");
    }
    format!("the column {name} has {rows} rows, the first has {expected}")
}

fn no_adapter(name: Option<&str>, there: &[String]) -> String {
    if there.is_empty() {
        return "no GPU driver was found; install one (in software: the Debian package mesa-vulkan-drivers), or use --engine cpu"
            .to_owned();
    }
    let there: Vec<_> = there.iter().map(|name| format!("\"{name}\"")).collect();
    format!("no adapter's name contains \"{}\"; there is: {}", name.unwrap_or_default(), there.join(", "))
}

fn way_back(kept: &Option<Kept>) -> String {
    let said = |Kept { checkpoint, resume }: &Kept| format!("; what is done is kept in {checkpoint}, go on with: {resume}");
    kept.as_ref().map_or(String::new(), said)
}

/// The first items of a list, and how many more there are.
pub(crate) fn in_short(words: &[String]) -> String {
    const MOST: usize = 20;
    let more = if words.len() > MOST { format!("; and {} more", words.len() - MOST) } else { String::new() };
    words.iter().take(MOST).cloned().collect::<Vec<_>>().join("; ") + &more
}

/// Text from a file, for a message: on one line and cut to a readable length.
pub fn brief(text: &str) -> String {
    const MOST: usize = 500;
    let mut plain: String =
        text.chars().take(MOST).flat_map(|c| if c.is_control() { c.escape_default().collect() } else { vec![c] }).collect();
    if text.chars().nth(MOST).is_some() {
        plain.push_str("...");
    }
    plain
}

impl Error {
    /// Wraps an I/O error with the path it happened at; for `map_err`.
    pub fn io(path: &Path) -> impl FnOnce(std::io::Error) -> Self + '_ {
        move |source| Self::Io { path: path.to_owned(), source }
    }

    /// The process exit code: 2 for a wrong request, 1 for a failure while running.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Study(_)
            | Self::Probability(_)
            | Self::Request(_)
            | Self::NoSuchInput { .. }
            | Self::Columns { .. }
            | Self::NoAdapter { .. }
            | Self::CpuOnly { .. }
            | Self::NotOnDevice { .. }
            | Self::NotByBounds { .. }
            | Self::NotMergeable { .. }
            | Self::Occupied { .. } => 2,
            Self::Io { .. }
            | Self::Stopped { .. }
            | Self::FrontBudget { .. }
            | Self::FrontMemory { .. }
            | Self::Gpu { .. }
            | Self::ErrorBound(_)
            | Self::Page { .. }
            | Self::Disagreement(_)
            | Self::Interrupted { .. }
            | Self::Busy { .. }
            | Self::Result { .. }
            | Self::Checkpoint { .. } => 1,
        }
    }
}

/// What the library returns.
pub type Result<T> = std::result::Result<T, Error>;
