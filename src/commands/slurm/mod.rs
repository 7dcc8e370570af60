//! `beltspace slurm`: the scripts that spread a study over a cluster.

mod scripts;
mod sizing;

use super::sweep::{default_out, files_of};
use super::{described, read_study_with};
use crate::cli::{self, Cli, Command};
use crate::terminal::{self, TextGrid, bold, counted, grouped, quoted, span};
use beltspace::checkpoint::Saved;
use beltspace::directory::Contents;
use beltspace::error::{Error, Result};
use beltspace::files::{Claim, MOVE, Reading, is_there, refuse_foreign, replace};
use beltspace::memory::Needs;
use beltspace::names::CHECKPOINT;
use beltspace::plan::Plan;
use beltspace::run::{Judging, method};
use beltspace::study::{Study, StudyEdits, differences};
use beltspace::sweep::costs::Speed;
use clap::Parser;
use scripts::{MERGE, SHARDS, SUBMIT};
use sizing::{Wish, Work};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// In the directory of the jobs: the folder of the study that they read, if it names other files.
const RESOLVED: &str = "study";
/// How long the speed is measured.
const TRIAL: Duration = Duration::from_secs(1);
/// Least memory in megabytes that jobs ask for: a shard, and the merge.
const LEAST_MEMORY: [u64; 2] = [1000, 2000];
/// Least time in seconds that the merge is expected to take: it writes the result, its pictures and its page.
const LEAST_MERGE: f64 = 300.0;

/// The scheduler that runs the jobs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheduler {
    Slurm,
    Pbs,
}

impl Scheduler {
    fn name(self) -> &'static str {
        match self {
            Self::Slurm => "Slurm",
            Self::Pbs => "PBS",
        }
    }

    /// Most jobs that it accepts in one array, unless its administrators have changed that.
    fn usual_limit(self) -> u64 {
        match self {
            Self::Slurm => 1000,
            Self::Pbs => 10_000,
        }
    }

    fn where_the_limit_is(self) -> &'static str {
        match self {
            Self::Slurm => "MaxArraySize of scontrol show config, less one",
            Self::Pbs => "max_array_size of qstat -Bf",
        }
    }
}

pub fn run(request: &cli::SlurmArgs) -> Result<()> {
    let scheduler = if request.pbs { Scheduler::Pbs } else { Scheduler::Slurm };
    let file = absolute(&request.study)?;
    let own = checked_options(&file, &request.sweep)?;
    let (study, text) = read_study_with(&request.study, StudyEdits { set: &own.set, feasible: own.feasible })?;
    let plan = Plan::new(study);
    let out = absolute(&request.out.clone().unwrap_or_else(|| default_out(&request.study, None)))?;
    let jobs = absolute(&request.jobs.clone().unwrap_or_else(|| jobs_beside(&out)))?;
    let program = program(request.program.as_deref())?;
    // Refuse what every shard would refuse, before anything is written.
    let mut speed = None;
    let mut measure = || *speed.get_or_insert_with(|| Speed::measured(&plan, 1, TRIAL));
    let method = method::choose(&plan, own.method, own.engine, own.adapter.as_deref(), request.cpus.into(), &mut measure)?;
    let options = request.option.iter().map(|it| one_line(it)).collect::<Result<Vec<_>>>()?;
    let time = request.time.as_deref().map(sizing::read_clock).transpose()?;
    let speed = measure();
    let work = work(&plan, speed.seconds, request.cpus);
    let wish = Wish { bounds: method.bounds, shards: request.shards, shortest: request.shortest, limit: request.array_limit };
    let shards = sizing::shards(&work, &wish, scheduler)?;
    // If another process is using it, name that process: the contents of the directory mean nothing meanwhile.
    let reading = Reading::without_trace(&out)?;
    Contents::of(&out)?.refuse_to_overwrite(&files_of(&plan, own.no_report), request.force, false)?;
    drop(reading);
    refuse_to_replace(&jobs, request.force)?;
    refuse_foreign_shards(&plan, &jobs, shards)?;

    let least = request.memory.map_or(LEAST_MEMORY, |asked| [asked; 2]);
    let needs = Needs::of(&plan, request.cpus.into(), !own.no_report);
    let wanted = [needs.shard, needs.merge].map(|bytes| (bytes + bytes / 2).div_ceil(1_000_000).next_multiple_of(100));
    let memory = [0, 1].map(|job| if request.memory.is_some() { least[job] } else { least[job].max(wanted[job]) });
    let limit = if method.bounds { sizing::limit_of_bounds(work.of_all()) } else { sizing::limit(work.of_shard(shards)) };
    let resolved = jobs.join(RESOLVED);
    // Jobs must not need files that lie where the study does. The study stands alone if it can be read from a folder that does not exist;
    // the folder of the jobs would not tell, as it may be the study's own.
    let is_alone = described::is_described(&file) || Study::parse_in(&text, "study.toml", &resolved.join("none")).is_ok();
    let (study, words) =
        if is_alone { (file, request.sweep.clone()) } else { (resolved.join("study.json"), without_edits(&request.sweep)) };
    if !is_alone {
        described::refuse_to_replace(&resolved, request.force)?;
    }
    let time = [limit, sizing::limit(LEAST_MERGE + work.of_merge())].map(|seconds| time.clone().unwrap_or_else(|| sizing::clock(seconds)));
    let scripts = scripts::ScriptContents {
        scheduler,
        title: terminal::told(&plan.study.title),
        name: job_name(&request.study),
        program: word(&program)?,
        study: word(&study)?,
        out: word(&out)?,
        jobs: word(&jobs)?,
        shards,
        cpus: request.cpus,
        memory,
        time,
        options,
        page: !own.no_report,
        sweep: words.iter().map(|it| terminal::quoted_word(it)).collect(),
    };
    let _claim = Claim::new(&jobs, &terminal::command_line())?;
    refuse_to_replace(&jobs, request.force)?;
    // Without the old submit.sh, a failure from here on leaves nothing to submit.
    let submit = jobs.join(SUBMIT);
    if submit.exists() {
        std::fs::remove_file(&submit).map_err(Error::io(&submit))?;
    }
    if !is_alone {
        described::write(&resolved, &plan.study, &text)?;
    }
    for (name, text) in scripts.scripts() {
        let path = jobs.join(name);
        replace(&path, text.as_bytes())?;
        make_executable(&path)?;
    }
    remark(&plan, &work, request, shards);
    if !request.quiet && method.bounds && own.method == Judging::Auto {
        let what = "bounds settle boxes of designs at once and may take only seconds; if they turn out slower, they are given up";
        let then = if shards == 1 {
            "one job is written, and `beltspace sweep` on this machine may be enough; --shards N splits the study all the same"
        } else {
            "every shard searches for the whole front; without --shards one job is written"
        };
        terminal::remark("note", &format!("{what}: {then}; -- --method exhaustive judges every design"));
    }
    if request.quiet { Ok(()) } else { terminal::tell(&summary(&plan, &work, (method.bounds, speed.how()), &scripts, &out, &jobs)) }
}

fn summary(plan: &Plan, work: &Work, (bounds, how): (bool, &str), scripts: &scripts::ScriptContents, out: &Path, jobs: &Path) -> String {
    let (shards, cpus) = (scripts.shards, scripts.cpus);
    let on = if cpus == 1 { "1 CPU".to_owned() } else { format!("{cpus} CPUs") };
    let each = if shards == 1 { "" } else { " each" };
    let mut facts = TextGrid::default();
    let mut fact = |what: &str, value: String| facts.row([bold(what), value]);
    fact("designs", grouped(plan.designs()));
    let long = span(work.of_shard(shards));
    let time = if bounds { format!("by bounds; every design would take about {long}") } else { format!("about {long}") };
    fact("shards", format!("{}, {time}{each} on {on}, {how}", grouped(shards)));
    fact(
        "asks for",
        format!(
            "{on}, {} MB, at most {}{each}; the merge {} MB, {}",
            scripts.memory[0], scripts.time[0], scripts.memory[1], scripts.time[1]
        ),
    );
    fact("jobs", format!("{SHARDS}, {MERGE} and {SUBMIT} in {}", jobs.display()));
    fact("result", format!("{}, after the merge", out.display()));
    format!("{}\n\n{}\nsubmit with: bash {}\n", bold(&terminal::told(&plan.study.title)), facts.indented(0), quoted(&jobs.join(SUBMIT)))
}

/// Remarks on what the user may not expect.
fn remark(plan: &Plan, work: &Work, request: &cli::SlurmArgs, shards: u64) {
    if let Some(asked) = request.shards.filter(|&asked| asked > shards) {
        let (short, long) = (span(work.of_own(asked)), span(work.of_own(shards)));
        let (them, fewer) = (grouped(asked), counted(shards, "shard"));
        terminal::remark(
            "warning",
            &format!("{them} shards would take about {short} each; {fewer} of about {long} written instead (--shortest 0 keeps {them})"),
        );
    } else if !request.quiet && work.of_all() < f64::from(request.shortest) {
        let whole = span(work.of_all());
        terminal::remark("note", &format!("a single job would take about {whole}: `beltspace sweep` on this machine is enough"));
    }
    if shards > 1 && work.sample > 0 {
        let open: Vec<_> = plan.study.report.histograms.iter().filter(|it| it.range.is_none()).collect();
        let names: Vec<_> = open.iter().map(|it| it.of.name(&plan.study.model)).collect();
        // With a fast model this takes no noticeable time.
        if work.of_shard(shards) > 1.1 * work.of_own(shards) {
            terminal::remark(
                "warning",
                &format!(
                    "histograms without from and to ({}): to find these, every shard judges {} more designs, which takes about {}; give both",
                    names.join(", "),
                    grouped(work.sample),
                    span(work.of_shard(shards) - work.of_own(shards))
                ),
            );
        }
    }
}

fn work(plan: &Plan, seconds: f64, cpus: u16) -> Work {
    let designs = plan.designs();
    let sample = designs.min(plan.study.model.sample);
    let listed = if plan.study.report.variants || plan.study.report.feasible { designs } else { 0 };
    Work { designs, seconds, sample: if plan.shards_sample() { sample } else { 0 }, again: sample + listed, cpus }
}

/// The options for the sweep, parsed as the shards will parse them, so that a mistake is reported now and not by every job.
fn checked_options(study: &Path, options: &[String]) -> Result<cli::SweepArgs> {
    let mut words: Vec<OsString> = ["beltspace", "sweep"].map(OsString::from).to_vec();
    words.push(study.into());
    words.extend(["--shard", "1/1", "--out", "shard", "--resume", "--quiet", "--threads", "1"].map(OsString::from));
    words.extend(options.iter().map(OsString::from));
    let wrong = |why: &str| {
        let why = why.strip_prefix("error: ").unwrap_or(why);
        Error::Request(format!(
            "options for the sweep: {why}; after -- give options of `beltspace sweep` except STUDY, --shard, --out, --resume, --force, --quiet, --threads"
        ))
    };
    match Cli::try_parse_from(words) {
        Ok(Cli { command: Command::Sweep(sweep) }) => Ok(sweep),
        Ok(_) => unreachable!("it began with sweep"),
        Err(error) => Err(wrong(error.to_string().lines().next().unwrap_or_default())),
    }
}

/// The options without those that the resolved study already follows.
fn without_edits(options: &[String]) -> Vec<String> {
    let mut left = Vec::new();
    let mut options = options.iter();
    while let Some(option) = options.next() {
        match option.as_str() {
            "--set" => drop(options.next()),
            "--feasible" => {}
            it if it.starts_with("--set=") => {}
            _ => left.push(option.clone()),
        }
    }
    left
}

/// An option for the scheduler, which becomes a line of a script.
fn one_line(option: &str) -> Result<String> {
    if !option.starts_with('-') || option.chars().any(char::is_control) {
        return Err(Error::Request(format!(
            "--option {option:?}: an option for the scheduler is one line that begins with a dash, such as --option=--partition=long"
        )));
    }
    Ok(option.to_owned())
}

/// The path of beltspace on the nodes. A name without a directory is kept, for the nodes to find in their PATH.
fn program(asked: Option<&Path>) -> Result<PathBuf> {
    match asked {
        None => beltspace::program::path()
            .map_err(|error| Error::Request(format!("cannot find the path of this program ({error}); give it with --program"))),
        Some(name) if name.components().count() == 1 => Ok(name.to_owned()),
        Some(path) => absolute(path),
    }
}

fn absolute(path: &Path) -> Result<PathBuf> {
    std::path::absolute(path).map_err(|error| Error::Request(format!("{}: {error}", path.display())))
}

/// A path as a word of a script.
fn word(path: &Path) -> Result<String> {
    match path.to_str() {
        Some(_) => Ok(quoted(path)),
        None => Err(Error::Request(format!("{}: a script takes names in UTF-8 only; rename it", path.display()))),
    }
}

/// `<result directory>-jobs`.
fn jobs_beside(out: &Path) -> PathBuf {
    let mut name = out.as_os_str().to_owned();
    name.push("-jobs");
    name.into()
}

/// The study's name in characters that every scheduler accepts.
fn job_name(study: &Path) -> String {
    let stem = study.file_stem().unwrap_or_default().to_string_lossy();
    let plain: String = stem.chars().map(|it| if it.is_ascii_alphanumeric() { it } else { '-' }).collect();
    let begins = plain.starts_with(|it: char| it.is_ascii_alphabetic());
    if begins { plain } else { format!("s{plain}") }
}

/// Existing scripts are only replaced with `--force`.
fn refuse_to_replace(jobs: &Path, force: bool) -> Result<()> {
    if jobs.exists() && !jobs.is_dir() {
        return Err(Error::Request(format!("{} is a file; name a directory with --jobs", jobs.display())));
    }
    for (name, first_line) in scripts::FIRST_LINES {
        let is_own = |head: &str| head.lines().nth(1).is_some_and(|line| line.starts_with(first_line));
        refuse_foreign(&jobs.join(name), MOVE, is_own)?;
    }
    match [SHARDS, MERGE, SUBMIT].into_iter().find(|name| is_there(&jobs.join(name))) {
        Some(name) if !force => Err(Error::Request(format!(
            "{} has a {name}; replace it with --force, or write to another directory with --jobs",
            jobs.display()
        ))),
        _ => Ok(()),
    }
}

/// Existing shards of another study would make every job fail.
fn refuse_foreign_shards(plan: &Plan, jobs: &Path, shards: u64) -> Result<()> {
    for number in 1..=shards {
        let folder = jobs.join(scripts::folder(&number.to_string(), shards));
        let checkpoint = folder.join(CHECKPOINT);
        if !is_there(&checkpoint) {
            continue;
        }
        let unusable = |error| Error::Request(format!("{error}; unless a job is at work there, remove {}", quoted(&folder)));
        let saved = Saved::read(&checkpoint).map_err(unusable)?;
        if saved.study_hash() != plan.study.hash() {
            let changed = differences(saved.description(), &plan.study.describe()).join("; ");
            return Err(Error::Request(format!(
                "{} is of another study ({changed}); restore the study, remove the directory of the jobs, or name another with --jobs",
                folder.display()
            )));
        }
        // One is enough: they were written together.
        return Ok(());
    }
    Ok(())
}

#[cfg(unix)]
fn make_executable(path: &Path) -> Result<()> {
    use std::os::unix::fs::PermissionsExt;
    let metadata = std::fs::metadata(path).map_err(Error::io(path))?;
    let mode = metadata.permissions().mode();
    // Executable for everybody who may read it.
    let permissions = std::fs::Permissions::from_mode(mode | (mode & 0o444) >> 2);
    std::fs::set_permissions(path, permissions).map_err(Error::io(path))
}

#[cfg(not(unix))]
fn make_executable(_: &Path) -> Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::without_edits;

    #[test]
    fn a_resolved_study_takes_no_edits_twice() {
        let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let left = without_edits(&words("--engine cpu --set a=1 --feasible --set=b=2 --method bounds --set c=3"));
        assert_eq!(left, words("--engine cpu --method bounds"));
    }
}
