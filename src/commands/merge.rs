//! `beltspace merge`: shards into one result.

use super::sweep::{CHECKPOINT, refuse_to_overwrite};
use super::threads;
use crate::cli;
use crate::terminal::{self, report};
use beltspace::checkpoint::Checkpoint;
use beltspace::error::{Error, Result};
use beltspace::export::{Outcome, RunRecord};
use beltspace::merge::{check_set, merge};
use beltspace::plan::Plan;
use beltspace::reduce::Reduction;
use beltspace::screen::{Tables, Tally};
use std::time::Instant;

pub fn run(request: &cli::Merge) -> Result<()> {
    refuse_to_overwrite(&request.out, request.force)?;
    let start = Instant::now();
    let open = |folder: &std::path::PathBuf| {
        let inside = folder.join(CHECKPOINT);
        let checkpoint = Checkpoint::open(if Checkpoint::exists(&inside) { &inside } else { folder })?;
        Ok((folder.clone(), checkpoint))
    };
    let shards = request.shards.iter().map(open).collect::<Result<Vec<_>>>()?;
    check_set(&shards)?;
    let first = &shards.first().ok_or_else(|| Error::Request("name the directories of the shards".to_owned()))?.1;
    let text = first.study_text().to_owned();
    let plan = Plan::new(first.study().clone());
    let tables = Tables::new(&plan);
    let threads = threads(request.threads);
    let tally = Tally::new(&plan, &tables, threads);
    let reduction = Reduction::new(&plan, &tally.histogram_ranges(&plan));
    let count = shards.len();
    let state = merge(&plan, &reduction, shards)?;
    let outcome = Outcome::certify(&plan, state, tally, threads)?;
    let record = RunRecord {
        engine: "cpu",
        threads,
        designs: plan.designs(),
        scenarios: plan.scenarios(),
        time: start.elapsed(),
        origin: format!("merged from {count} shards; the time is that of merging"),
        certified: outcome.front.len() + outcome.top.len(),
    };
    outcome.write(&request.out, &text, &record)?;
    if request.quiet { Ok(()) } else { terminal::print(&report::summary(&outcome, &record, &request.out)) }
}
