//! `beltspace merge`: shards into one result.

use super::sweep::refuse_to_overwrite;
use super::{report as page, threads};
use crate::cli;
use crate::terminal::{self, report};
use beltspace::checkpoint::Checkpoint;
use beltspace::error::{Error, Result};
use beltspace::export::{CHECKPOINT, MethodRecord, Outcome, RunRecord};
use beltspace::merge::{check_set, merge};
use beltspace::plan::Plan;
use beltspace::reduce::Reduction;
use beltspace::screen::{Control, Tables, Tally};
use std::path::{Path, PathBuf};
use std::time::Instant;

pub fn run(request: &cli::Merge) -> Result<()> {
    refuse_to_overwrite(&request.out, request.force)?;
    let start = Instant::now();
    let folders = request.shards.iter().map(|folder| checkpoint_in(folder)).collect::<Result<Vec<_>>>()?;
    refuse_twice(&request.shards, &folders)?;
    let open = |(named, folder): (&PathBuf, &PathBuf)| Ok((named.clone(), Checkpoint::open(folder)?));
    let mut shards = request.shards.iter().zip(&folders).map(open).collect::<Result<Vec<_>>>()?;
    check_set(&shards)?;
    // Whatever the order they are named in: the first shard's study file becomes the result's.
    shards.sort_by_key(|(_, shard)| shard.shard().number);
    let first = &shards.first().ok_or_else(|| Error::Request("name the directories of the shards".to_owned()))?.1;
    let text = first.study_text().to_owned();
    let plan = Plan::new(first.study().clone());
    let tables = Tables::new(&plan);
    let threads = threads(request.threads);
    let tally = Tally::new(&plan, &tables, threads);
    let reduction = Reduction::new(&plan, &tally.histogram_ranges(&plan));
    let count = shards.len();
    let state = merge(&plan, &reduction, shards)?;
    let outcome = Outcome::certify(&plan, state, tally, threads, &Control::default())?;
    let record = RunRecord {
        engine: "cpu",
        threads,
        designs: plan.designs(),
        scenarios: plan.scenarios(),
        time: start.elapsed(),
        origin: format!("merged from {count} shards; the time is that of merging"),
        certified: outcome.front.len() + outcome.top.len(),
        device: None,
        method: MethodRecord { name: "merge", why: "the shards were judged before, each by its own method".to_owned(), certificate: None },
    };
    outcome.write(&request.out, &text, &record)?;
    let page = if request.no_report {
        None
    } else {
        let study = request.out.join("study.toml");
        Some(page::beside(&plan, &request.out, &study, record.time, threads, &Control::default())?)
    };
    if request.quiet { Ok(()) } else { terminal::print(&report::summary(&outcome, &record, &request.out, page.as_ref())) }
}

/// The checkpoint of a result directory, or the directory itself if it is one.
fn checkpoint_in(folder: &Path) -> Result<PathBuf> {
    let found = [folder.join(CHECKPOINT), folder.to_owned()].into_iter().find(|it| Checkpoint::exists(it));
    found.ok_or_else(|| Error::Request(format!("{}: there is no checkpoint here", folder.display())))
}

/// A directory named twice would look like one that another run is using.
fn refuse_twice(named: &[PathBuf], folders: &[PathBuf]) -> Result<()> {
    let real: Vec<_> = folders.iter().map(|folder| folder.canonicalize().unwrap_or_else(|_| folder.clone())).collect();
    for (at, folder) in real.iter().enumerate() {
        if let Some(first) = real[..at].iter().position(|it| it == folder) {
            return Err(Error::Request(format!("cannot merge: {} and {} are the same shard", named[first].display(), named[at].display())));
        }
    }
    Ok(())
}
