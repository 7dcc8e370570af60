//! Every option of the command line.

#![allow(rustdoc::invalid_html_tags, reason = "these texts are the help of the command line")]

use beltspace::run::{Engine, Judging};
use beltspace::study::{InfluenceOver, SensitivitySpec};
use beltspace::tiles::Shard;
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// Explores belt-drive designs by the billion: every combination, judged in its worst case, down to the exact Pareto front.
#[derive(Debug, Parser)]
#[command(version, max_term_width = 110, arg_required_else_help = true, disable_help_subcommand = true)]
#[command(after_help = "Start with:  beltspace models metal-cvt --study > my.toml;  beltspace check my.toml;  beltspace sweep my.toml")]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// List the models, or one model's inputs, outputs, units, ranges and sources
    Models(ModelsArgs),
    /// Evaluate one design, or every row of a table: every input, output and margin
    Eval(EvalArgs),
    /// Export one design to another program: a pulley as a model for CalculiX
    Export(ExportArgs),
    /// Check a study without running it: size, axes without effect, memory, expected time
    Check(CheckArgs),
    /// Judge every design of a study and write the result directory
    Sweep(SweepArgs),
    /// Change a study with sliders in a browser, on a page that shows its front at once
    Explore(ExploreArgs),
    /// Tell which uncertain input or design choice matters for each quantity of a study
    Sensitivity(SensitivityArgs),
    /// Merge the shards of a study into the same result as that of one run
    Merge(MergeArgs),
    /// Write the job scripts that run a study on a cluster with Slurm or PBS
    Slurm(SlurmArgs),
    /// Write the page that shows a result: one HTML file for any browser
    Report(ReportArgs),
    /// Compare a GPU with f64: the error of each output, its error bound, wrong decisions
    #[cfg(feature = "gpu")]
    Verify(VerifyArgs),
    /// List the GPUs of this machine, their limits, and the self-test of their drivers
    #[cfg(feature = "gpu")]
    Adapters {
        /// Print JSON
        #[arg(long)]
        json: bool,
    },
    /// Compute the papers' tables and figures again, and say what agrees or differs and why
    Reproduce(ReproduceArgs),
    /// Print the form of study files for editors, as JSON Schema
    Schema {
        /// Print every key as a page in Markdown instead
        #[arg(long)]
        markdown: bool,
        /// The form of the file of a model in place of a study's
        #[arg(long, conflicts_with = "markdown")]
        model: bool,
    },
    /// Print the man page, or write one per command into a directory
    Man {
        /// Directory for the pages of all commands
        #[arg(value_name = "DIR")]
        dir: Option<PathBuf>,
    },
    /// Print a completion script for a shell
    Completions {
        /// Shell
        shell: clap_complete::Shell,
    },
}

/// Options of `models`.
#[derive(Debug, Args)]
pub struct ModelsArgs {
    /// Name of a model, or the file of one; without it, all are listed
    pub name: Option<String>,
    /// Print JSON
    #[arg(long, conflicts_with = "study")]
    pub json: bool,
    /// Print a study to start from
    #[arg(long, requires = "name")]
    pub study: bool,
}

/// Options of `check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Study file
    pub study: PathBuf,
    /// Set an input in place of its axis, fixed value or formula, or a part of the study such as constraints.NAME.max; may be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// As with sweep --feasible: also says how large the file of all feasible designs may become
    #[arg(long)]
    pub feasible: bool,
    /// Write the draws that choose designs, of a study with distributions, as CSV
    #[arg(long, value_name = "FILE.csv")]
    pub draws: Option<PathBuf>,
}

/// Options of `export`.
#[derive(Debug, Args)]
pub struct ExportArgs {
    /// The model `pulley`, or a study of it
    #[arg(value_name = "MODEL|STUDY", required_unless_present = "compare")]
    pub target: Option<String>,
    /// Directory for the CalculiX model (pulley.inp, and README.txt on how to run it)
    #[arg(long, value_name = "DIR")]
    pub calculix: PathBuf,
    /// Set an input; a unit may follow the number. May be repeated
    #[arg(long, value_name = "NAME=VALUE", conflicts_with = "design")]
    pub set: Vec<String>,
    /// Start from a named set of inputs instead of the defaults
    #[arg(long, conflicts_with = "design")]
    pub preset: Option<String>,
    /// Design of a study, by its index
    #[arg(long, value_name = "N", value_parser = design_number)]
    pub design: Option<u64>,
    /// Scenario of a study, by its index
    #[arg(long, value_name = "K", requires = "design")]
    pub scenario: Option<u64>,
    /// Elements around the axis
    #[arg(long, value_name = "N", default_value_t = 68, value_parser = clap::value_parser!(u16).range(8..=720))]
    pub sectors: u16,
    /// Once CalculiX has run in the directory: compare its results with those of beltspace
    #[arg(long, conflicts_with_all = ["target", "set", "preset", "design", "scenario"])]
    pub compare: bool,
}

/// Options of `eval`.
#[derive(Debug, Args)]
pub struct EvalArgs {
    /// Name or file of a model, or a study file
    #[arg(value_name = "MODEL|STUDY")]
    pub target: String,
    /// Set an input, of a study in place of its axis, fixed value or formula; a unit may follow the number ("0.25 in"). May be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// Start from a named set of inputs instead of the defaults
    #[arg(long, conflicts_with = "design")]
    pub preset: Option<String>,
    /// Design of a study, by its index
    #[arg(long, value_name = "N", value_parser = design_number)]
    pub design: Option<u64>,
    /// Scenario of a study, by its index; without it the worst over all scenarios
    #[arg(long, value_name = "K", requires = "design")]
    pub scenario: Option<u64>,
    /// Draw of a study with distributions, by its number, in the operating case --scenario; without it the medians
    #[arg(long, value_name = "N", requires = "design")]
    pub draw: Option<u64>,
    /// Evaluate every row of a table, CSV or .parquet, or CSV from standard input (-): columns give inputs; of a study, a row is a design
    #[arg(long, value_name = "ROWS", conflicts_with_all = ["design", "json", "profile", "plot"])]
    pub table: Option<PathBuf>,
    /// Where the rows and their results go: .csv or .parquet, or CSV on standard output (-)
    #[arg(long, value_name = "FILE", default_value = "-", requires = "table")]
    pub out: PathBuf,
    /// Take a column of the rows along as it is. May be repeated
    #[arg(long, value_name = "COLUMN", requires = "table")]
    pub carry: Vec<String>,
    /// Replace the file of --out
    #[arg(long, requires = "table")]
    pub force: bool,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
    /// Write the values along the belt as CSV
    #[arg(long, value_name = "FILE.csv")]
    pub profile: Option<PathBuf>,
    /// Draw the values along the belt as SVG
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
}

/// Options of `sweep`.
#[derive(Debug, Args)]
pub struct SweepArgs {
    /// Study file
    pub study: PathBuf,
    /// Set an input in place of its axis, fixed value or formula, or a part of the study such as constraints.NAME.max; may be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// Write every feasible design into feasible.parquet
    #[arg(long)]
    pub feasible: bool,
    /// Result directory [default: results/<study name>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// What judges the designs
    #[arg(long, value_enum, default_value = "auto")]
    pub engine: Engine,
    /// How designs are judged; the result is the same
    #[arg(long, value_enum, default_value = "auto")]
    pub method: Judging,
    /// GPU to use, by any part of its name [default: the best, see `adapters`]
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Worker threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub threads: Option<u16>,
    /// Continue an interrupted run from its checkpoint (start anew if there is none)
    #[arg(long)]
    pub resume: bool,
    /// Sweep only shard K of N; `merge` combines the shards
    #[arg(long, value_name = "K/N")]
    pub shard: Option<Shard>,
    /// Most memory in megabytes for the front during the sweep; it may be larger then than at the end
    #[arg(long, value_name = "MB", default_value_t = beltspace::reduce::FRONT_BYTES >> 20, value_parser = clap::value_parser!(u64).range(1..=1 << 30))]
    pub front_memory: u64,
    /// Do not write report.html, the page that shows the result
    #[arg(long)]
    pub no_report: bool,
    /// Print nothing but errors
    #[arg(long)]
    pub quiet: bool,
    /// Replace a result or checkpoint that beltspace wrote; other files are never touched
    #[arg(long, conflicts_with = "resume")]
    pub force: bool,
    /// For testing: designs that are judged between two checks of the clock; changes no result
    #[arg(long, hide = true, default_value_t = 65_536, value_parser = clap::value_parser!(u64).range(1..))]
    pub tile: u64,
    /// Write the GPU kernel of this study as WGSL instead of sweeping
    #[arg(long, value_name = "FILE", conflicts_with_all = ["resume", "force", "shard", "out"])]
    pub emit_shader: Option<PathBuf>,
    /// For testing: change the GPU's value of an output by this fraction; the sweep must notice and fail
    #[arg(long, value_name = "OUTPUT=FRACTION")]
    pub perturb: Vec<String>,
}

/// The part of an address behind its `#`. Characters that an address or a quoted word cannot have are refused.
fn page_view(text: &str) -> Result<String, String> {
    let text = text.trim_start_matches('#');
    match text.chars().find(|&it| !it.is_ascii_graphic() || "\"'<>`\\".contains(it)) {
        Some(wrong) => {
            Err(format!("a view cannot have {wrong:?} in it; copy the whole command with \"Copy view\" on the page, and keep its quotes"))
        }
        None => Ok(text.to_owned()),
    }
}

/// Options of `explore`.
#[derive(Debug, Args)]
#[command(after_help = "The page is served to this machine only, and asks for the token in its address. From another machine: \
    ssh -L 8000:127.0.0.1:8000 HOST beltspace explore STUDY --no-browser --port 8000")]
pub struct ExploreArgs {
    /// Study file
    pub study: PathBuf,
    /// Begin with this change. May be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// Open the page with the changes, ranges, pins, weights and columns that "Copy view" on the page copied
    #[arg(long, value_name = "VIEW", value_parser = page_view)]
    pub view: Option<String>,
    /// Port to listen on [default: any that is free]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub port: u16,
    /// Print the address instead of opening a browser
    #[arg(long)]
    pub no_browser: bool,
    /// Worker threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub threads: Option<u16>,
}

/// Options of `sensitivity`.
#[derive(Debug, Args)]
#[command(
    after_help = "Levels are taken to be equally likely. Few combinations are all looked at, and their shares are exact; else draws \
    estimate them. Shares are of the variance: first-order and total Sobol indices, and Shapley effects, which add up to 1 with \
    correlations, too, and over the designs that hold. More than ten inputs are also screened after Morris. The quantity holds is 1 where \
    every constraint is kept with status ok."
)]
pub struct SensitivityArgs {
    /// Study file
    pub study: PathBuf,
    /// Set an input in place of its axis, fixed value or formula, or a part of the study such as constraints.NAME.max; may be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// Design whose uncertainty is looked at, by its index [default: the only one]
    #[arg(long, value_name = "N", value_parser = design_number)]
    pub design: Option<u64>,
    /// What varies [default: uncertainty if the study has some]
    #[arg(long, value_enum)]
    pub over: Option<InfluenceOver>,
    /// Quantity to look at: a column of the result, an output, or holds. May be repeated [default: those of the study, and holds]
    #[arg(long, value_name = "QUANTITY")]
    pub of: Vec<String>,
    /// Directory for sensitivity.csv, with the columns of SALib, sensitivity.json, tornado.csv and pictures
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Draws of each set, 16 times a power of two, where there are too many combinations to look at all
    #[arg(long, value_name = "N", default_value_t = SensitivitySpec::DRAWS,
          value_parser = clap::value_parser!(u64).range(SensitivitySpec::DRAWS_FROM..=SensitivitySpec::DRAWS_TO))]
    pub draws: u64,
    /// Seed of the draws [default: that of the study's draws, else 1]
    #[arg(long, value_name = "S")]
    pub seed: Option<u64>,
    /// Worker threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub threads: Option<u16>,
    /// Print nothing but errors
    #[arg(long)]
    pub quiet: bool,
}

/// Options of `report`.
#[derive(Debug, Args)]
pub struct ReportArgs {
    /// Result directory
    pub dir: PathBuf,
    /// Where to write the page [default: report.html in the directory]
    #[arg(long, value_name = "FILE.html")]
    pub out: Option<PathBuf>,
    /// Replace the file even if it is not a page of beltspace
    #[arg(long)]
    pub force: bool,
    /// Worker threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub threads: Option<u16>,
    /// Time limit in whole seconds for computing the outputs that front.csv lacks
    #[arg(long, value_name = "SECONDS", default_value_t = 60, value_parser = clap::value_parser!(u32).range(0..=86_400))]
    pub patience: u32,
    /// Print nothing but errors
    #[arg(long)]
    pub quiet: bool,
}

/// Options of `verify`.
#[cfg(feature = "gpu")]
#[derive(Debug, Args)]
pub struct VerifyArgs {
    /// Study file, or name or file of a model
    #[arg(value_name = "STUDY|MODEL")]
    pub target: String,
    /// Points to compare
    #[arg(long, value_name = "N", default_value_t = 200_000, value_parser = clap::value_parser!(u64).range(8..=100_000_000))]
    pub samples: u64,
    /// Seed of the random points
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
    /// GPU to use, by any part of its name [default: the best, see `adapters`]
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    /// For testing: change the GPU's value of an output by this fraction; the comparison must notice and fail
    #[arg(long, value_name = "OUTPUT=FRACTION")]
    pub perturb: Vec<String>,
}

/// Options of `merge`.
#[derive(Debug, Args)]
pub struct MergeArgs {
    /// Directories of all shards of one study
    #[arg(required = true, value_name = "DIR")]
    pub shards: Vec<PathBuf>,
    /// Result directory
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Worker threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub threads: Option<u16>,
    /// Do not write report.html, the page that shows the result
    #[arg(long)]
    pub no_report: bool,
    /// Print nothing but errors
    #[arg(long)]
    pub quiet: bool,
    /// Replace an existing result
    #[arg(long)]
    pub force: bool,
}

/// Options of `slurm`.
#[derive(Debug, Args)]
#[command(after_help = "Submit with: bash DIR/submit.sh. After a failure submit again: finished shards are skipped, the others continue. \
    The study, the program and both directories must have the same paths on every node as here.")]
pub struct SlurmArgs {
    /// Study file
    pub study: PathBuf,
    /// Number of shards [default: one if bounds are used, else of ten minutes each]; fewer if one would take less than --shortest
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub shards: Option<u64>,
    /// Result directory [default: results/<study name>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Directory of the scripts, the shards and their logs [default: <result directory>-jobs]
    #[arg(long, value_name = "DIR")]
    pub jobs: Option<PathBuf>,
    /// Write for PBS (PBS Professional, OpenPBS) instead of Slurm
    #[arg(long)]
    pub pbs: bool,
    /// CPUs per job
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub cpus: u16,
    /// Memory per job in megabytes [default: estimated from the study, at least 1000]
    #[arg(long, value_name = "MB", value_parser = clap::value_parser!(u64).range(1..=100_000_000))]
    pub memory: Option<u64>,
    /// Time limit per job [default: four times the expected time, at least 00:10:00; with bounds at most 24:00:00]
    #[arg(long, value_name = "HH:MM:SS")]
    pub time: Option<String>,
    /// Any other option for the scheduler, such as --option=--partition=long or --option="-q long". May be repeated
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true)]
    pub option: Vec<String>,
    /// Least time of a shard in seconds: if need be, fewer shards than asked for are written; 0 writes as many as asked for
    #[arg(long, value_name = "SECONDS", default_value_t = 60, value_parser = clap::value_parser!(u32).range(0..=86_400))]
    pub shortest: u32,
    /// Most jobs that the scheduler accepts in one array [default: 1000, with --pbs 10000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub array_limit: Option<u64>,
    /// Path of beltspace on the nodes [default: the path of this program]
    #[arg(long, value_name = "PROGRAM")]
    pub program: Option<PathBuf>,
    /// Replace existing scripts and, when the shards are merged, an existing result; shards are kept and continue
    #[arg(long)]
    pub force: bool,
    /// Print nothing but errors and warnings
    #[arg(long)]
    pub quiet: bool,
    /// Options for the sweep of every shard, such as -- --engine cpu
    #[arg(last = true, value_name = "SWEEP OPTIONS")]
    pub sweep: Vec<String>,
}

/// Options of `reproduce`.
#[derive(Debug, Args)]
pub struct ReproduceArgs {
    /// Directory for the figures, tables and the comparison
    #[arg(long, value_name = "DIR", default_value = "results/papers")]
    pub out: PathBuf,
    /// Do not write report.html, the page that shows all of them
    #[arg(long)]
    pub no_report: bool,
    /// Replace existing files
    #[arg(long)]
    pub force: bool,
    /// Print nothing but errors
    #[arg(long)]
    pub quiet: bool,
}

/// The number of a design.
fn design_number(text: &str) -> Result<u64, String> {
    let wanted = "designs are named by their numbers: sweep prints that of the knee, and front.csv has them in the column design_index";
    text.parse().map_err(|_| wanted.to_owned())
}
