//! What each command does. A command reads its request, finds everything that is wrong with it, then works.

mod adapters;
mod check;
mod engine;
mod eval;
mod merge;
mod models;
mod sweep;
mod verify;

use crate::cli::{Cli, Command};
use crate::terminal;
use beltspace::error::{Error, Result};
use beltspace::models::{MODELS, Model};
use beltspace::study::Study;
use clap::CommandFactory;
use std::path::Path;

/// Runs a command.
pub fn run(command: Command) -> Result<()> {
    match command {
        Command::Models(request) => models::run(&request),
        Command::Eval(request) => eval::run(&request),
        Command::Check { study } => check::run(&study),
        Command::Sweep(request) => sweep::run(&request),
        Command::Merge(request) => merge::run(&request),
        Command::Verify(request) => verify::run(&request),
        Command::Adapters { json } => adapters::run(json),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "beltspace", &mut script);
            terminal::print(&String::from_utf8_lossy(&script))
        }
    }
}

/// The model of that name.
fn find_model(name: &str) -> Result<&'static Model> {
    beltspace::models::find(name).ok_or_else(|| {
        let names: Vec<_> = MODELS.iter().map(|model| model.name).collect();
        Error::Request(format!("unknown model \"{name}\"; models are: {}", names.join(", ")))
    })
}

/// Reads a study file; one that is not there is a wrong request.
fn read_study(path: &Path) -> Result<(Study, String)> {
    Study::read(path).map_err(|error| match error {
        Error::Io { path, source } => Error::Request(format!("cannot read study {}: {source}", path.display())),
        other => other,
    })
}

/// Number of threads asked for, or one per core.
fn threads(asked: Option<u16>) -> usize {
    asked.map_or_else(|| std::thread::available_parallelism().map_or(1, std::num::NonZero::get), usize::from)
}
