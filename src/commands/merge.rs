//! `beltspace merge`: merges shards into one result.

use super::sweep::files_of;
use super::{report as page, threads};
use crate::cli;
use crate::terminal::{self, report};
use beltspace::checkpoint::{Checkpoint, Saved};
use beltspace::directory::{self, Contents};
use beltspace::error::{Error, Result};
use beltspace::export::{Certified, MethodRecord, RunRecord};
use beltspace::files::Reading;
use beltspace::merge::{check_set, merge};
use beltspace::names::CHECKPOINT;
use beltspace::plan::Plan;
use beltspace::reduce::Reduction;
use beltspace::screen::{Control, Tables, Tally};
use beltspace::tiles::{Ranges, Shard};
use std::path::{Path, PathBuf};
use std::time::Instant;

pub fn run(request: &cli::MergeArgs) -> Result<()> {
    let start = Instant::now();
    let folders = request.shards.iter().map(|folder| checkpoint_in(folder)).collect::<Result<Vec<_>>>()?;
    refuse_twice(&request.shards, &folders)?;
    refuse_into_a_shard(&request.out, &folders)?;
    // Refuse what can be refused before reading shards. Claim the directory first: while another process works in it, its contents mean
    // nothing.
    let taken = directory::claim(&request.out, &terminal::command_line())?;
    Contents::of(&request.out)?.refuse_to_overwrite(&[], request.force, false)?;
    let mut shards = Vec::new();
    let mut reading = Vec::new();
    for (named, folder) in request.shards.iter().zip(&folders) {
        reading.push(Reading::without_trace(directory_of(named, folder))?);
        shards.push((named.clone(), Saved::read(folder)?));
    }
    check_set(&shards)?;
    // In order of their numbers, however they were named: the first shard's study file becomes that of the result.
    shards.sort_by_key(|(_, shard)| shard.shard().number);
    let first = &shards.first().ok_or_else(|| Error::Request("name the directories of the shards".to_owned()))?.1;
    let text = first.study_text().to_owned();
    let plan = Plan::new(first.study().clone());

    Contents::of(&request.out)?.refuse_to_overwrite(&files_of(&plan, request.no_report), request.force, false)?;
    let tables = Tables::new(&plan);
    let threads = threads(request.threads);
    let tally = Tally::new(&plan, &tables, threads);
    let reduction = Reduction::new(&plan, &tally.histogram_ranges(&plan));
    let count = shards.len();
    let state = merge(&plan, &reduction, shards)?;
    drop(reading);
    // The merged state is saved as that of a complete run: if this is interrupted from here on, `sweep --resume` finishes it.
    let mut checkpoint = Checkpoint::create(&taken.claim, &plan.study, &text, Shard::WHOLE, plan.designs())?;
    checkpoint.save(&Ranges::of(0..plan.designs()), &state)?;
    let control = Control::default();
    let outcome = Certified::certify(&plan, state, tally, threads, &control)?;
    let record = RunRecord {
        engine: "cpu",
        threads,
        designs: plan.designs(),
        scenarios: plan.scenarios(),
        time: start.elapsed(),
        origin: format!("merged from {}; the time is that of merging", terminal::counted(count as u64, "shard")),
        certified: outcome.certified(),
        device: None,
        method: MethodRecord {
            name: "merge",
            why: "the shards were judged before, each by its own method".to_owned(),
            certificate: None,
            left: None,
        },
    };
    outcome.write(checkpoint, &text, &record, &control)?;
    let page = if request.no_report {
        None
    } else {
        let study = terminal::quoted(&request.out.join("study.toml"));
        Some(page::beside(&plan, &request.out, &study, record.time, threads, &Control::default())?)
    };
    if request.quiet { Ok(()) } else { terminal::tell(&report::summary(&outcome, &record, &request.out, page.as_ref())) }
}

/// The checkpoint of a result directory, or the directory itself if it is one.
fn checkpoint_in(folder: &Path) -> Result<PathBuf> {
    let there = [folder.join(CHECKPOINT), folder.to_owned()].into_iter().find(|it| it.join("manifest.json").exists());
    there.ok_or_else(|| Error::Request(format!("{}: there is no checkpoint here", folder.display())))
}

/// The result directory of a checkpoint, which a run that uses it has locked.
fn directory_of<'a>(named: &'a Path, checkpoint: &'a Path) -> &'a Path {
    if named == checkpoint { checkpoint.parent().filter(|it| !it.as_os_str().is_empty()).unwrap_or(Path::new(".")) } else { named }
}

/// The shards are kept, so the result cannot take the place of one.
fn refuse_into_a_shard(out: &Path, folders: &[PathBuf]) -> Result<()> {
    let real = |path: &Path| path.canonicalize().ok();
    let own = real(&out.join(CHECKPOINT));
    if own.is_some() && folders.iter().any(|folder| real(folder) == own) {
        return Err(Error::Request(format!("cannot merge: {} is one of the shards; write to another --out", out.display())));
    }
    Ok(())
}

/// A directory named twice would look as if another run were using it.
fn refuse_twice(named: &[PathBuf], folders: &[PathBuf]) -> Result<()> {
    let real: Vec<_> = folders.iter().map(|folder| folder.canonicalize().unwrap_or_else(|_| folder.clone())).collect();
    for (at, folder) in real.iter().enumerate() {
        if let Some(first) = real[..at].iter().position(|it| it == folder) {
            return Err(Error::Request(format!("cannot merge: {} and {} are the same shard", named[first].display(), named[at].display())));
        }
    }
    Ok(())
}
