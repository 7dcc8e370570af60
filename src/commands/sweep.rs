//! `beltspace sweep`: the main job.

use super::{engine, method, read_study, report as page, threads};
use crate::cli;
use crate::terminal::{self, progress::Bar, report};
use beltspace::bounds::Certificate;
use beltspace::checkpoint::{Checkpoint, replace};
use beltspace::error::{Error, Result};
use beltspace::export::{CHECKPOINT, MARK, MethodRecord, Outcome, RunRecord, in_the_way};
use beltspace::plan::Plan;
use beltspace::reduce::Reduction;
use beltspace::screen::gpu::{Wrong, kernel_of};
use beltspace::screen::{Tables, Tally};
use beltspace::sweep::{Control, DeviceRecord, OnDevice, Options, Swept, sweep, sweep_by_bounds, sweep_on_device};
use beltspace::tiles::Shard;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

pub fn run(request: &cli::Sweep) -> Result<()> {
    let (study, text) = read_study(&request.study)?;
    let shard = request.shard.unwrap_or(Shard::WHOLE);
    let out = request.out.clone().unwrap_or_else(|| default_out(&request.study, request.shard));
    // A checkpoint beside a finished result is an unfinished run that is to replace it.
    let goes_on = request.resume && Checkpoint::exists(&out.join(CHECKPOINT));
    refuse_to_overwrite(&out, request.force || goes_on)?;
    let plan = Plan::new(study);
    let wrong = Wrong { perturb: engine::perturbations(plan.study.model, &request.perturb)?, ..Wrong::default() };
    if let Some(file) = &request.emit_shader {
        return emit_shader(&plan, &wrong, threads(request.threads), file);
    }
    let threads = threads(request.threads);
    let method = method::choose(&plan, request.method, request.engine, request.adapter.as_deref(), threads)?;
    let on_a_device = if method.bounds { cli::Engine::Cpu } else { request.engine };
    let mut device = engine::choose(&plan, on_a_device, request.adapter.as_deref(), wrong)?;
    if let (cli::Engine::Auto, Some(chosen)) = (request.engine, &device)
        && let Err(error) = engine::try_out(&plan, chosen)
    {
        terminal::remark("warning", &format!("{error}; the processor judges the designs"));
        device = None;
    }
    let control = Arc::new(Control::default());
    stop_on_ctrl_c(&control)?;
    let mut checkpoint = open_checkpoint(&out, &plan, &text, shard, request)?;
    if request.shard.is_some() && checkpoint.is_finished() {
        return finish_shard(&plan, &out, &checkpoint, request.quiet);
    }
    let resumed = checkpoint.has_progress();
    let options = Options { threads, tile: request.tile, shard, ..Options::default() };
    let bar = Bar::start(&control, shard.range(plan.designs()), request.quiet);
    let how = match &device {
        _ if method.bounds => How::Bounds,
        Some(device) => How::Device(&device.on),
        None => How::Processor,
    };
    let done = judge(&plan, &options, &mut checkpoint, &control, request.shard.is_none(), how);
    bar.finish();
    let Judged { time, designs, outcome, did, certificate } = done.map_err(|error| name_the_way_back(error, &out, request))?;
    let Some(outcome) = outcome else {
        return finish_shard(&plan, &out, &checkpoint, request.quiet);
    };
    let origin = if resumed { "resumed from a checkpoint" } else { "one run" }.to_owned();
    let record = RunRecord {
        engine: if device.is_some() { "gpu" } else { "cpu" },
        threads: options.threads,
        designs,
        scenarios: plan.scenarios(),
        time,
        origin,
        certified: outcome.front.len() + outcome.top.len(),
        device: device.zip(did).map(|(device, did)| describe_device(&device, &did)),
        method: MethodRecord { name: if method.bounds { "bounds" } else { "exhaustive" }, why: method.why, certificate },
    };
    outcome.write(&out, &text, &record)?;
    checkpoint.remove()?;
    let page =
        if request.no_report { None } else { Some(page::beside(&plan, &out, &request.study, record.time, options.threads, &control)?) };
    if request.quiet { Ok(()) } else { terminal::print(&report::summary(&outcome, &record, &out, page.as_ref())) }
}

/// What judges the designs.
enum How<'a> {
    Processor,
    Device(&'a OnDevice),
    Bounds,
}

/// What came of it.
struct Judged<'p> {
    time: Duration,
    designs: u64,
    outcome: Option<Outcome<'p>>,
    did: Option<DeviceRecord>,
    certificate: Option<Certificate>,
}

/// Sweeps the study and, if it is `whole`, certifies what is to be reported; of a shard, the checkpoint is the result.
fn judge<'p>(
    plan: &'p Plan,
    options: &Options,
    checkpoint: &mut Checkpoint,
    control: &Control,
    whole: bool,
    how: How<'_>,
) -> Result<Judged<'p>> {
    let tables = Tables::new(plan);
    // Of a slow model the sample is a large part of the work, or all of it: a shard does without where it can.
    let sampled = whole || plan.shards_sample();
    let tally = if sampled { Tally::watched(plan, &tables, options.threads, control)? } else { Tally::empty(plan) };
    let reduction = Reduction::new(plan, &tally.histogram_ranges(plan));
    let (mut did, mut certificate) = (None, None);
    let Swept { state, designs, time } = match how {
        How::Processor => sweep(plan, &tables, &reduction, options, Some(checkpoint), control)?,
        How::Device(on) => {
            let (swept, record) = sweep_on_device(plan, &tables, &reduction, options, Some(checkpoint), control, on)?;
            did = Some(record);
            swept
        }
        How::Bounds => {
            let (swept, found) = sweep_by_bounds(plan, &tables, &reduction, options, Some(checkpoint), control)?;
            certificate = Some(found);
            swept
        }
    };
    let outcome = whole.then(|| Outcome::certify(plan, state, tally, options.threads, control)).transpose()?;
    Ok(Judged { time, designs, outcome, did, certificate })
}

/// The device, its driver and what it did, for `run.json`.
fn describe_device(device: &engine::Trusted, did: &DeviceRecord) -> Value {
    let mut record = did.to_json();
    let (adapter, self_test) = (&device.adapter, device.report.to_json());
    for (name, value) in [("adapter", &adapter.name), ("driver", &adapter.driver), ("backend", &adapter.backend)] {
        record[name] = value.clone().into();
    }
    record["self_test"] = self_test;
    record
}

/// Writes the kernel of a study.
fn emit_shader(plan: &Plan, wrong: &Wrong, threads: usize, file: &Path) -> Result<()> {
    engine::needs_a_twin(plan.study.model, "it has no shader to write; leave --emit-shader out")?;
    let ranges = Tally::new(plan, &Tables::new(plan), threads).histogram_ranges(plan);
    replace(file, kernel_of(plan, &ranges, &wrong.perturb)?.as_bytes())
}

/// `results/<study name>`, of a shard `results/<study name>-K-of-N`.
pub fn default_out(study: &Path, shard: Option<Shard>) -> PathBuf {
    let stem = study.file_stem().unwrap_or(study.as_os_str()).to_string_lossy();
    let suffix = shard.map_or(String::new(), |shard| format!("-{}-of-{}", shard.number, shard.of));
    Path::new("results").join(format!("{stem}{suffix}"))
}

/// A finished result stays unless `--force` says otherwise.
pub fn refuse_to_overwrite(out: &Path, force: bool) -> Result<()> {
    if out.is_file() {
        return Err(Error::Request(format!("{} is a file; name a directory with --out", out.display())));
    }
    if force {
        return Ok(());
    }
    if out.join(MARK).exists() {
        return Err(Error::Request(format!(
            "{} holds a finished result; replace it with --force, or write to another --out",
            out.display()
        )));
    }
    // A checkpoint says whose files these are: those of a run that was killed while it wrote its result.
    let files = if Checkpoint::exists(&out.join(CHECKPOINT)) { Vec::new() } else { in_the_way(out)? };
    if !files.is_empty() {
        return Err(Error::Request(format!(
            "{} has files that a result would replace ({}); write to another --out, or replace them with --force",
            out.display(),
            files.join(", ")
        )));
    }
    Ok(())
}

fn open_checkpoint(out: &Path, plan: &Plan, text: &str, shard: Shard, request: &cli::Sweep) -> Result<Checkpoint> {
    let folder = out.join(CHECKPOINT);
    if Checkpoint::exists(&folder) && !request.force {
        if !request.resume {
            return Err(Error::Request(format!(
                "{} holds an unfinished run; go on with --resume, or start again with --force",
                out.display()
            )));
        }
        let checkpoint = Checkpoint::open(&folder)?;
        // Nothing has failed: the request and the checkpoint do not go together.
        checkpoint.require(&plan.study, shard).map_err(|error| Error::Request(error.to_string()))?;
        return Ok(checkpoint);
    }
    Checkpoint::create(&folder, &plan.study, text, shard, plan.designs())
}

/// The first Ctrl-C ends the sweep in good order, the second at once.
fn stop_on_ctrl_c(control: &Arc<Control>) -> Result<()> {
    let control = Arc::clone(control);
    let handler = move || {
        if control.stop.swap(true, Ordering::Relaxed) {
            std::process::exit(1);
        }
    };
    ctrlc::set_handler(handler).map_err(|error| Error::Request(format!("cannot listen for Ctrl-C: {error}")))
}

fn name_the_way_back(error: Error, out: &Path, request: &cli::Sweep) -> Error {
    let shard = request.shard.map_or(String::new(), |shard| format!(" --shard {shard}"));
    let [study, folder] = [&request.study, out].map(terminal::quoted);
    let resume = format!("beltspace sweep {study} --out {folder}{shard} --resume");
    let checkpoint = out.join(CHECKPOINT).display().to_string();
    match error {
        Error::Stopped { .. } => Error::Stopped { checkpoint, resume },
        Error::Gpu { device, problem } => {
            Error::Gpu { device, problem: format!("{problem}; what is done is kept in {checkpoint}, go on with: {resume} --engine cpu") }
        }
        Error::Promise(problem) => Error::Promise(format!("{problem}; nothing that it counted is kept, go on with: {resume} --engine cpu")),
        other => other,
    }
}

fn finish_shard(plan: &Plan, out: &Path, checkpoint: &Checkpoint, quiet: bool) -> Result<()> {
    if quiet {
        return Ok(());
    }
    let shard = checkpoint.shard();
    let range = shard.range(plan.designs());
    terminal::print(&format!(
        "shard {shard} of \"{}\": {} designs, in {}\nput the shards together with: beltspace merge DIR... --out DIR\n",
        plan.study.title,
        terminal::grouped(range.end - range.start),
        out.display(),
    ))
}

#[cfg(test)]
mod tests {
    use super::super::unlike::on_the_processor_only;
    use super::*;

    #[test]
    fn a_model_without_a_twin_has_no_shader_to_write() {
        let text = beltspace::models::find("pulley-load").expect("it is a model").starter;
        let mut study = beltspace::study::Study::parse(text, "study.toml", ".".as_ref()).expect("the starter is right");
        study.model = on_the_processor_only();
        let refused = emit_shader(&Plan::new(study), &Wrong::default(), 1, Path::new("unwritten.wgsl")).expect_err("it has no twin");
        assert!(matches!(refused, Error::Request(_)));
        let expected = "no-twin is computed in f64 on the processor only; it has no shader to write; leave --emit-shader out";
        assert_eq!((refused.to_string().as_str(), Path::new("unwritten.wgsl").exists()), (expected, false));
    }
}
