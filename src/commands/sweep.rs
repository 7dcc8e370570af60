//! `beltspace sweep`: judges every design of a study and writes the result.

use super::check::{feasible_file, warn_of_days};
use super::{engine, read_study_with, report as page, sensitivity, tell_short_ranges, threads};
use crate::cli;
use crate::terminal::{self, progress::Bar, report};
use beltspace::checkpoint::{Checkpoint, Saved};
use beltspace::directory::{self, Contents};
use beltspace::error::{Error, Kept, Result};
use beltspace::export::RunRecord;
use beltspace::influence::InfluenceSubject;
use beltspace::names::{CHECKPOINT, PAGE};
use beltspace::plan::Plan;
use beltspace::result_files::result_files;
use beltspace::run::device;
use beltspace::run::judge::{How, Judged, judge, record_of};
use beltspace::run::method::{self, Chosen};
use beltspace::study::{Study, StudyEdits, StudyErrors};
use beltspace::sweep::costs::Speed;
use beltspace::sweep::{Control, Settings};
use beltspace::tiles::Shard;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Seconds that a sweep may take by what the model says, of which no measurement makes a day.
const SURELY_SHORT: f64 = 600.0;

pub fn run(request: &cli::SweepArgs) -> Result<()> {
    let shard = request.shard.unwrap_or(Shard::WHOLE);
    let out = request.out.clone().unwrap_or_else(|| default_out(&request.study, request.shard));
    let (study, text) = match read_study_with(&request.study, StudyEdits { set: &request.set, feasible: request.feasible }) {
        Err(Error::Study(errors)) if request.resume => kept_study(&request.study, &out, errors)?,
        read => read?,
    };
    let plan = Plan::new(study);
    let wrong = engine::wrong(&plan.study.model, &request.perturb)?;
    let threads = threads(request.threads);
    if let Some(file) = &request.emit_shader {
        return engine::emit_shader(&plan, &wrong, threads, file);
    }
    let on_a_device = device::is_expected(&plan, request.engine, request.adapter.as_deref());
    let speed = || if on_a_device { device::about(Speed::quick(&plan, threads)) } else { Speed::quick(&plan, threads) };
    let method = method::choose(&plan, request.method, request.engine, request.adapter.as_deref(), threads, speed)?;
    if !request.resume && !request.quiet {
        warn_if_long(&plan, &method, shard, threads, on_a_device);
    }
    // Claimed before anything is done, and held to the end.
    let taken = directory::claim(&out, &terminal::command_line())?;
    let contents = Contents::of(&out)?;
    if taken.completed && request.resume && contents.is_result_of(&plan.study) {
        return finish_interrupted(&plan, request, &out, threads);
    }
    let files = if request.shard.is_some() { Vec::new() } else { files_of(&plan, request.no_report) };
    contents.refuse_to_overwrite(&files, request.force, request.resume)?;
    let mut warn = |text: &str| terminal::remark("warning", text);
    plan.study.left_out.iter().for_each(|left_out| terminal::remark("note", left_out));
    tell_short_ranges(&plan.study);
    let engine = method.engine(request.engine, on_a_device);
    let device = device::choose_tried(&plan, engine, request.engine, request.adapter.as_deref(), wrong, &mut warn)?;
    let control = Arc::new(Control::default());
    stop_on_ctrl_c(&control);
    let mut checkpoint = if contents.is_unfinished() && request.resume {
        let mut checkpoint = Checkpoint::open(&taken.claim)?;
        // This is no failure: the request and the checkpoint do not fit together.
        checkpoint.adopt(&plan.study, &text, shard).map_err(|error| Error::Request(error.to_string()))?;
        checkpoint
    } else {
        Checkpoint::create(&taken.claim, &plan.study, &text, shard, plan.designs())?
    };
    if request.shard.is_some() && checkpoint.saved().is_finished() {
        return finish_shard(&plan, &out, shard, request.quiet);
    }
    let resumed = checkpoint.saved().has_progress();
    if let Some(size) = feasible_file(&plan).filter(|_| !request.quiet) {
        terminal::remark("note", &size);
    }
    if let Some(subject) = InfluenceSubject::of_report(&plan.study, 0)?.filter(|_| request.shard.is_none() && !request.quiet) {
        sensitivity::tell_cost(&subject, threads)?;
    }
    let front_bytes = request.front_memory << 20;
    let settings = Settings { threads, tile: request.tile, shard, front_bytes, ..Settings::default() };
    let bar = Bar::start(&control, shard.range(plan.designs()), request.quiet);
    let how = How::new(&method, device.as_ref(), request.engine, request.adapter.as_deref());
    let done = judge(&plan, &settings, Some(&mut checkpoint), &control, request.shard.is_none(), how, &mut warn);
    bar.finish();
    let Judged { time, designs, certified, did, settler } = done.map_err(|error| name_the_way_back(error, &out, request))?;
    let Some(outcome) = certified else {
        return finish_shard(&plan, &out, shard, request.quiet);
    };
    let origin = if resumed { "resumed from a checkpoint" } else { "one run" }.to_owned();
    let record = RunRecord {
        engine: if did.is_some() { "gpu" } else { "cpu" },
        threads: settings.threads,
        designs,
        scenarios: plan.scenarios(),
        time,
        origin,
        certified: outcome.certified(),
        device: device.zip(did).map(|(device, did)| device.describe(&did)),
        method: record_of(method.why, settler),
    };
    outcome.write(checkpoint, &text, &record, &control).map_err(|error| name_the_way_back(error, &out, request))?;
    let page =
        if request.no_report { None } else { Some(page::beside(&plan, &out, &named(request), record.time, settings.threads, &control)?) };
    if request.quiet { Ok(()) } else { terminal::tell(&report::summary(&outcome, &record, &out, page.as_ref())) }
}

/// Warns of a sweep that will take days.
#[allow(clippy::cast_precision_loss, reason = "an estimate")]
fn warn_if_long(plan: &Plan, method: &Chosen, shard: Shard, threads: usize, on_a_device: bool) {
    // Bounds that were asked for stay, and nobody knows how long they take.
    if method.bounds && method.leaves.is_none() {
        return;
    }
    let range = shard.range(plan.designs());
    let designs = range.end - range.start;
    let told = || Speed::told(plan);
    let measured = || if told().of(designs, threads) < SURELY_SHORT { told() } else { Speed::quick(plan, threads) };
    let speed = method.leaves.unwrap_or_else(|| if on_a_device { device::about(measured()) } else { measured() });
    warn_of_days(designs, speed.of(designs, threads), threads, method.bounds);
}

/// The study of the checkpoint in `out`, which has the rows and labels of every table that it names. It goes on where such a table is no
/// longer there, as long as the study file itself is the same.
fn kept_study(study: &Path, out: &Path, errors: StudyErrors) -> Result<(Study, String)> {
    let now = std::fs::read_to_string(study).ok();
    let kept = Saved::read(&out.join(CHECKPOINT)).ok().filter(|kept| now.as_deref() == Some(kept.study_text()));
    let Some(kept) = kept else { return Err(Error::Study(errors)) };
    let why = errors.problems.first().map_or(String::new(), |problem| format!(" ({problem})"));
    terminal::remark("note", &format!("a table that the study names has changed{why}; going on with the rows that the checkpoint holds"));
    Ok((kept.study().clone(), kept.study_text().to_owned()))
}

/// The study as words of a command line.
fn named(request: &cli::SweepArgs) -> String {
    let set = request.set.iter().map(|it| format!(" --set {}", terminal::quoted_word(it)));
    terminal::quoted(&request.study) + &set.collect::<String>()
}

/// `results/<study name>`, of a shard `results/<study name>-K-of-N`.
pub fn default_out(study: &Path, shard: Option<Shard>) -> PathBuf {
    let stem = study.file_stem().unwrap_or(study.as_os_str()).to_string_lossy();
    let suffix = shard.map_or(String::new(), |shard| format!("-{}-of-{}", shard.number, shard.of));
    Path::new("results").join(format!("{stem}{suffix}"))
}

/// The files that the result of a sweep has.
pub fn files_of(plan: &Plan, no_page: bool) -> Vec<String> {
    let mut files = result_files(&plan.study);
    files.retain(|name| !no_page || name != PAGE);
    files
}

/// A run was killed while it put its result in place; that has been completed. Only its page may be missing.
fn finish_interrupted(plan: &Plan, request: &cli::SweepArgs, out: &Path, threads: usize) -> Result<()> {
    let page = if request.no_report {
        None
    } else {
        Some(page::beside(plan, out, &named(request), Duration::ZERO, threads, &Control::default())?)
    };
    let page = page.map_or(String::new(), |page| format!("page   {}\n", page.display()));
    if request.quiet {
        Ok(())
    } else {
        terminal::print(&format!("the interrupted run had finished, and its result is now in place\nresult {}\n{page}", out.display()))
    }
}

/// The first Ctrl-C stops the sweep and saves its checkpoint, the second ends the program at once.
fn stop_on_ctrl_c(control: &Arc<Control>) {
    let control = Arc::clone(control);
    let handler = move || {
        if control.stop.swap(true, Ordering::Relaxed) {
            std::process::exit(1);
        }
    };
    if let Err(error) = ctrlc::set_handler(handler) {
        terminal::remark("warning", &format!("Ctrl-C will end the run at once, and --resume will continue from its last save: {error}"));
    }
}

fn name_the_way_back(error: Error, out: &Path, request: &cli::SweepArgs) -> Error {
    let shard = request.shard.map_or(String::new(), |shard| format!(" --shard {shard}"));
    let feasible = if request.feasible { " --feasible" } else { "" };
    let (study, folder) = (named(request) + feasible, terminal::quoted(out));
    let resume = format!("beltspace sweep {study} --out {folder}{shard} --resume");
    let checkpoint = out.join(CHECKPOINT).display().to_string();
    match error {
        Error::Stopped { .. } => Error::Stopped { kept: Some(Kept { checkpoint, resume }) },
        Error::Gpu { device, problem } => {
            Error::Gpu { device, problem: format!("{problem}; what is done is kept in {checkpoint}, go on with: {resume} --engine cpu") }
        }
        Error::FrontBudget { points, budget, example, .. } => {
            let resume = format!("; what is done is kept in {checkpoint}, with a larger front_budget go on with: {resume}");
            Error::FrontBudget { points, budget, example, resume }
        }
        Error::FrontMemory { points, megabytes, example, .. } => {
            let more = 2 * megabytes.max(1);
            let resume = format!("; what is done is kept in {checkpoint}, with more memory go on with: {resume} --front-memory {more}");
            Error::FrontMemory { points, megabytes, example, resume }
        }
        Error::Io { path, source } if out.join(CHECKPOINT).exists() => Error::Interrupted { path, source, checkpoint, resume },
        Error::ErrorBound(problem) => {
            Error::ErrorBound(format!("{problem}; what the GPU counted is discarded, go on with: {resume} --engine cpu"))
        }
        other => other,
    }
}

fn finish_shard(plan: &Plan, out: &Path, shard: Shard, quiet: bool) -> Result<()> {
    if quiet {
        return Ok(());
    }
    let range = shard.range(plan.designs());
    terminal::tell(&format!(
        "shard {shard} of \"{}\": {}, in {}\nmerge the shards with: beltspace merge DIR... --out DIR\n",
        terminal::told(&plan.study.title),
        terminal::counted(range.end - range.start, "design"),
        out.display(),
    ))
}
