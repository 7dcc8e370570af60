//! Shards of one study, put together.

use crate::checkpoint::Checkpoint;
use crate::error::{Error, Result};
use crate::plan::Plan;
use crate::reduce::{Reduction, State};
use crate::study::differences;
use std::path::PathBuf;

/// Checks that these are all shards of one study, each once.
///
/// # Errors
/// [`Error::Request`] that names what is missing, doubled or foreign, all of it at once.
pub fn check_set(shards: &[(PathBuf, Checkpoint)]) -> Result<()> {
    let Some((_, first)) = shards.first() else {
        return Err(Error::Request("there are no shards to merge".to_owned()));
    };
    let of = first.shard().of;
    let mut problems = Vec::new();
    for (path, shard) in &shards[1..] {
        if shard.study_hash() != first.study_hash() {
            let changed = differences(first.description(), shard.description()).join("; ");
            problems.push(format!("{} is of another study than {}: {changed}", path.display(), shards[0].0.display()));
        } else if shard.shard().of != of {
            problems.push(format!("{} is shard {}, but {} is one of {of}", path.display(), shard.shard(), shards[0].0.display()));
        }
    }
    if problems.is_empty() {
        for number in 1..=of {
            let same: Vec<_> =
                shards.iter().filter(|(_, it)| it.shard().number == number).map(|(path, _)| path.display().to_string()).collect();
            match same.as_slice() {
                [] => problems.push(format!("shard {number}/{of} is missing")),
                [_] => {}
                several => problems.push(format!("shard {number}/{of} is there more than once: {}", several.join(", "))),
            }
        }
    }
    if problems.is_empty() { Ok(()) } else { Err(Error::Request(format!("cannot merge: {}", problems.join("; ")))) }
}

/// Merges the states of a complete set of shards.
///
/// # Errors
/// [`Error::Request`] if a shard has not finished; [`Error::Certificate`] if the shards together do not cover the study.
pub fn merge(plan: &Plan, reduction: &Reduction, shards: Vec<(PathBuf, Checkpoint)>) -> Result<State> {
    let mut reducers = reduction.start();
    let mut unfinished = Vec::new();
    let mut covered = 0;
    for (path, mut checkpoint) in shards {
        let range = checkpoint.shard().range(plan.designs());
        let progress = checkpoint.take_progress();
        let missing = progress.as_ref().map_or(range.end - range.start, |it| it.done.missing_from(range.clone()).count());
        if missing > 0 {
            unfinished.push(format!("{} (shard {}) has {missing} designs to go", path.display(), checkpoint.shard()));
        } else if let Some(progress) = progress {
            covered += progress.done.count();
            reducers.merge(progress.state);
        }
    }
    if !unfinished.is_empty() {
        return Err(Error::Request(format!("cannot merge: {}; finish with sweep --resume", unfinished.join("; "))));
    }
    if covered != plan.designs() {
        return Err(Error::Certificate(format!("the shards cover {covered} of {} designs", plan.designs())));
    }
    let state = reducers.state();
    crate::sweep::check_budget(plan, &state)?;
    Ok(state)
}
