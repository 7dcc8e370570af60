//! The commands. Each checks its whole request first, and only then starts to work.

#[cfg(feature = "gpu")]
mod adapters;
mod check;
mod described;
mod draws;
#[cfg_attr(not(feature = "gpu"), path = "no_engine.rs")]
mod engine;
mod eval;
mod explore;
mod export;
mod man;
mod merge;
mod models;
mod report;
mod reproduce;
mod rows;
mod sensitivity;
mod settings;
mod slurm;
mod sweep;
#[cfg(feature = "gpu")]
mod verify;

use crate::cli::{Cli, Command};
use crate::terminal;
use beltspace::error::{Error, Result};
use beltspace::models::Model;
use beltspace::names::MARK;
use beltspace::parallel::to_be_had;
use beltspace::study::{FileKind, Study, StudyEdits, file_kind, read_model};
use clap::CommandFactory;
use std::path::Path;
use std::sync::Arc;

/// Runs a command.
pub fn run(command: Command) -> Result<()> {
    match command {
        Command::Models(request) => models::run(&request),
        Command::Eval(request) => eval::run(&request),
        Command::Export(request) => export::run(&request),
        Command::Check(request) => check::run(&request),
        Command::Sweep(request) => sweep::run(&request),
        Command::Explore(request) => explore::run(&request),
        Command::Sensitivity(request) => sensitivity::run(&request),
        Command::Merge(request) => merge::run(&request),
        Command::Slurm(request) => slurm::run(&request),
        Command::Report(request) => report::run(&request),
        #[cfg(feature = "gpu")]
        Command::Verify(request) => verify::run(&request),
        Command::Reproduce(request) => reproduce::run(&request),
        #[cfg(feature = "gpu")]
        Command::Adapters { json } => adapters::run(json),
        Command::Schema { markdown: true, .. } => terminal::print(&beltspace::study::study_reference()),
        Command::Schema { model: true, .. } => terminal::print(&beltspace::study::model_schema()),
        Command::Schema { .. } => terminal::print(&beltspace::study::study_schema()),
        Command::Man { dir } => man::run(dir.as_deref()),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "beltspace", &mut script);
            terminal::print(&String::from_utf8_lossy(&script))
        }
    }
}

/// What a person probably meant who named a file where a command stands.
pub fn meant_by(word: &str) -> Option<String> {
    let path = Path::new(word);
    if path.extension().is_none_or(|it| it != "toml") && !path.is_file() {
        return None;
    }
    let file = terminal::quoted(path);
    // Whatever was named, a hint must not wait for it or fill the memory.
    let is_small = std::fs::metadata(path).is_ok_and(|it| it.is_file() && it.len() < 1 << 20);
    let is_model = is_small && std::fs::read_to_string(path).is_ok_and(|text| file_kind(&text) == FileKind::Model);
    let command = if is_model { "models" } else { "sweep" };
    Some(format!("a command comes first: beltspace {command} {file}"))
}

/// The model of that name.
fn find_model(name: &str) -> Result<Arc<Model>> {
    beltspace::models::find(name).ok_or_else(|| {
        let names: Vec<_> = beltspace::models::all().iter().map(|model| model.name.as_str()).collect();
        Error::Request(format!("unknown model \"{name}\"; models are: {}", names.join(", ")))
    })
}

/// What a command works on: a model by name or from a file, or a study.
enum CommandTarget<'t> {
    Model(Arc<Model>),
    Study(&'t Path),
}

/// The model or study that is meant: files are told apart by what stands in them.
fn target(named: &str) -> Result<CommandTarget<'_>> {
    let path = Path::new(named);
    if beltspace::models::find(named).is_some() || !(path.extension().is_some_and(|it| it == "toml") || path.exists()) {
        return find_model(named).map(CommandTarget::Model);
    }
    // What cannot be read is told as of a study.
    let kind = std::fs::read_to_string(path).map_or(FileKind::Study, |text| file_kind(&text));
    match kind {
        FileKind::Study => Ok(CommandTarget::Study(path)),
        FileKind::Model => read_model(path).map(CommandTarget::Model),
        FileKind::Other => Err(Error::Request(format!(
            "{named} is neither a study, which names a model, nor a model, which has [formulas]; \
             beltspace models NAME --study shows a study"
        ))),
    }
}

/// The model of that name, or in the file of that name.
fn model_of(named: &str) -> Result<Arc<Model>> {
    match target(named)? {
        CommandTarget::Model(model) => Ok(model),
        CommandTarget::Study(path) if path.exists() => {
            Err(Error::Request(format!("{named} is a study; name a model, or a file that has [formulas] and no model")))
        }
        CommandTarget::Study(path) => read_model(path),
    }
}

/// Reads a study file; if there is none of this name, the request is wrong.
fn read_study(path: &Path) -> Result<(Study, String)> {
    read_study_with(path, StudyEdits::default())
}

/// The same with what else is asked of it.
fn read_study_with(path: &Path, edits: StudyEdits<'_>) -> Result<(Study, String)> {
    if described::is_described(path) {
        return described::read(path, edits);
    }
    Study::read_with(path, edits).map_err(unreadable)
}

/// The same where a design axis that is set stays, with that value only.
fn read_study_what_if(path: &Path, set: &[String]) -> Result<Study> {
    Study::read_what_if(path, set).map_err(unreadable)
}

/// Tells ranges of a study whose steps end before they do.
fn tell_short_ranges(study: &Study) {
    study.short_ranges.iter().for_each(|it| terminal::remark("note", it));
}

fn unreadable(error: Error) -> Error {
    match error {
        Error::Io { path, .. } if path.join(MARK).is_file() => {
            let named = |name: &str| terminal::quoted(&path.join(name));
            Error::Request(format!(
                "cannot read study {}: it is the directory of a result; give the study in it, {}, or {} with --set; beltspace report {} \
                 writes its page again",
                path.display(),
                named("study.json"),
                named("study.toml"),
                terminal::quoted(&path),
            ))
        }
        Error::Io { path, source } => Error::Request(format!("cannot read study {}: {source}", path.display())),
        other => other,
    }
}

/// The number of threads asked for, or one per core; fewer if the system does not let so many be started.
fn threads(asked: Option<u16>) -> usize {
    let wanted = asked.map_or_else(|| std::thread::available_parallelism().map_or(1, std::num::NonZero::get), usize::from);
    let had = to_be_had(wanted);
    if had < wanted {
        terminal::remark("warning", &format!("{wanted} threads were asked for, but only {had} can be started here"));
    }
    had
}

/// Models for tests of what no shipped model has.
#[cfg(test)]
mod unlike {
    use beltspace::models::{Input, Model, Preset, find};
    use std::sync::Arc;

    const SECTIONS: &[(&str, f64)] = &[("machined", 1.0), ("welded-discs", 2.0), ("pressed-cup", 4.0)];

    /// Computed on the CPU only.
    pub fn cpu_only() -> Arc<Model> {
        let mut model = Model::clone(&find("pulley-load").expect("it is a model"));
        (model.name, model.on_gpu) = ("cpu-only".into(), false);
        Arc::new(model)
    }

    /// With an input that takes words only, and one that is read for some of these words only.
    pub fn with_a_section() -> Arc<Model> {
        let mut model = Model::clone(&find("pulley-load").expect("it is a model"));
        let section = Input::enumeration("section", "", SECTIONS, 4.0, "How the pulley is made.", "chosen");
        let mass = Input::new("disc_mass_g", "", beltspace::units::GRAM, 10.0, (1.0, 100.0), "Mass of a disc.", "chosen");
        let mass = mass.read_only_for("section", &["machined", "welded-discs"]);
        model.name = "sections".into();
        model.inputs.extend([section, mass]);
        model.presets = vec![Preset::new("welded", &[("section", 2.0)])];
        Arc::new(model)
    }
}
