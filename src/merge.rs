//! Merges the shards of a study.

use crate::checkpoint::Saved;
use crate::error::{Error, Result, in_short};
use crate::plan::Plan;
use crate::reduce::{Reduction, State};
use crate::study::differences;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Checks that these are all shards of one study, each once.
///
/// # Errors
/// [`Error::NotMergeable`] with all shards that are missing, there twice, or of another study.
pub fn check_set(shards: &[(PathBuf, Saved)]) -> Result<()> {
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
        problems = missing_and_doubled(shards, of);
    }
    if problems.is_empty() { Ok(()) } else { Err(Error::NotMergeable { problems, remedy: None }) }
}

/// Which of `of` shards are missing or there more than once, in the order of their numbers.
fn missing_and_doubled(shards: &[(PathBuf, Saved)], of: u64) -> Vec<String> {
    let mut places: BTreeMap<u64, Vec<String>> = BTreeMap::new();
    for (path, shard) in shards {
        places.entry(shard.shard().number).or_default().push(path.display().to_string());
    }
    let mut problems = Vec::new();
    // There may be up to 2^64 shards, most of them missing: iterate over the gaps, not over the shards.
    let mut gap = |first: u64, last: u64| match last.wrapping_sub(first) {
        _ if first > last => {}
        0 => problems.push((first, format!("shard {first}/{of} is missing"))),
        _ => problems.push((first, format!("shards {first} to {last} of {of} are missing"))),
    };
    let mut next = 1;
    for &number in places.keys() {
        gap(next, number - 1);
        next = number.saturating_add(1);
    }
    if places.last_key_value().is_none_or(|(&last, _)| last < of) {
        gap(next, of);
    }
    let doubled = places.iter().filter(|(_, paths)| paths.len() > 1);
    problems.extend(doubled.map(|(&number, paths)| (number, format!("shard {number}/{of} is there more than once: {}", in_short(paths)))));
    problems.sort();
    problems.into_iter().map(|(_, problem)| problem).collect()
}

/// Merges the states of a complete set of shards.
///
/// # Errors
/// [`Error::NotMergeable`] if a shard has not finished; [`Error::Checkpoint`] if it does not fit the study; [`Error::Disagreement`] if the
/// shards together do not cover the study.
pub fn merge(plan: &Plan, reduction: &Reduction, shards: Vec<(PathBuf, Saved)>) -> Result<State> {
    let mut reducers = reduction.start();
    let mut unfinished = Vec::new();
    let mut covered = 0;
    for (path, mut checkpoint) in shards {
        let range = checkpoint.shard().range(plan.designs());
        let progress = checkpoint.take_progress(plan, reduction)?;
        let missing = progress.as_ref().map_or(range.end - range.start, |it| it.done.missing_from(range.clone()).count());
        if missing > 0 {
            unfinished.push(format!("{} (shard {}) has {missing} designs left to judge", path.display(), checkpoint.shard()));
        } else if let Some(progress) = progress {
            covered += progress.done.count();
            reducers.merge(progress.state);
        }
    }
    if !unfinished.is_empty() {
        return Err(Error::NotMergeable { problems: unfinished, remedy: Some("finish with sweep --resume".to_owned()) });
    }
    if covered != plan.designs() {
        return Err(Error::Disagreement(format!("the shards cover {covered} of {} designs", plan.designs())));
    }
    let state = reducers.state();
    crate::sweep::Settings::default().check_budget(plan, &state)?;
    Ok(state)
}
