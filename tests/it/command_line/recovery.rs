//! Runs that are divided, interrupted and resumed always give the same result.

use super::{
    Files, SMALL, ask, ask_words, files, folder_with, json_of, large, large_result, larger, plain_run, program, same_result, small_result,
    write,
};
use crate::random::Random;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// Longest time that anything here may take before the test gives up.
const PATIENCE: Duration = Duration::from_secs(120);

/// Starts the program and does not wait for it.
fn start(folder: &Path, line: &str) -> Child {
    program(folder, &line.split_whitespace().collect::<Vec<_>>()).spawn().expect("the program starts")
}

/// Waits until `is_so`, or until the process has ended; says which.
fn wait_until(child: &mut Child, is_so: impl Fn() -> bool) -> bool {
    let start = Instant::now();
    while start.elapsed() < PATIENCE {
        if is_so() {
            return true;
        }
        if child.try_wait().expect("the process can be asked").is_some() {
            return false;
        }
        std::thread::sleep(Duration::from_micros(200));
    }
    panic!("nothing happened for {PATIENCE:?}");
}

/// SIGKILL, or the equivalent of the system.
fn kill(child: &mut Child) {
    // It is no error if the process has just ended.
    let _ = child.kill();
    child.wait().expect("the process can be waited for");
}

/// Is this the name of something that was being written?
fn is_writing(name: &str) -> bool {
    name.starts_with('.') && name.ends_with(".writing")
}

/// What a killed run may leave in its result directory: complete files, the mark of a finished result last.
fn assert_nothing_is_half_written(out: &Path, plain: &Files) {
    let Ok(entries) = out.read_dir() else { return };
    let left: Files = if entries.count() > 0 { files(out) } else { return };
    let visible = || left.iter().filter(|(name, _)| name.as_str() != "checkpoint" && !is_writing(name));
    // These two say how a run went, and differ from run to run.
    let told = |name: &str| name == "run.json" || name == "report.html";
    for (name, bytes) in visible().filter(|(name, _)| !told(name)) {
        assert!(plain.get(name) == Some(bytes), "{name} is visible and not whole");
    }
    if let Some(page) = left.get("report.html") {
        let text = page.as_deref().unwrap_or_default().trim_ascii_end();
        assert!(text.ends_with(b"</html>"), "report.html is visible and not whole");
    }
    if left.contains_key("run.json") {
        json_of(&out.join("run.json"));
    }
    if left.contains_key("summary.json") {
        // The page is made of the finished result, so it comes after the mark.
        let result = |files: &Files| files.keys().filter(|name| name.as_str() != "report.html").count();
        let seen = visible().filter(|(name, _)| name.as_str() != "report.html").count();
        assert_eq!(seen, result(plain), "there is a summary.json, but the result is not complete");
    }
    let manifest = out.join("checkpoint/manifest.json");
    if manifest.exists() && !left.contains_key("summary.json") {
        let state = json_of(&manifest)["manifest"]["state"][0].as_str().map(str::to_owned);
        assert!(state.is_none_or(|name| out.join("checkpoint").join(name).exists()), "the manifest names a state that is not there");
    }
}

#[test]
fn threads_and_tiles_do_not_change_a_result() {
    let folder = folder_with("small.toml", SMALL);
    for options in ["--threads 1", "--threads 2", "--threads 3", "--tile 1", "--tile 7 --threads 3", "--tile 1000", "--engine cpu"] {
        ask(folder.path(), &format!("sweep small.toml --out out --force {options}")).text();
        assert_eq!(same_result(small_result(), &files(&folder.path().join("out"))), Ok(()), "{options}");
    }
}

#[test]
fn shards_merge_to_the_same_result_in_any_order() {
    let folder = folder_with("small.toml", SMALL);
    let mut random = Random::new(0x5ea1);
    for of in 1..=5 {
        let mut shards: Vec<String> = Vec::new();
        for number in 1..=of {
            let shard = format!("part-{number}-of-{of}");
            let (threads, tile) = (random.whole(1, 3), random.whole(1, 2000));
            let line = format!("sweep small.toml --shard {number}/{of} --out {shard} --threads {threads} --tile {tile}");
            ask(folder.path(), &line).text();
            assert!(!folder.path().join(&shard).join("summary.json").exists(), "a part is no result");
            shards.push(shard);
        }
        for order in 0..3 {
            // Fisher and Yates.
            (1..shards.len()).rev().for_each(|last| shards.swap(last, random.below(last + 1)));
            let line = format!("merge {} --out whole --force", shards.join(" "));
            ask(folder.path(), &line).text();
            assert_eq!(same_result(small_result(), &files(&folder.path().join("whole"))), Ok(()), "{line} ({order})");
        }
        assert!(shards.iter().all(|shard| folder.path().join(shard).join("checkpoint").exists()), "merging keeps the shards");
    }
}

#[test]
fn a_shard_goes_where_its_name_says() {
    let folder = folder_with("small.toml", SMALL);
    for number in 1..=2 {
        ask(folder.path(), &format!("sweep small.toml --shard {number}/2")).text();
    }
    ask(folder.path(), "merge results/small-2-of-2 results/small-1-of-2/checkpoint --out whole").text();
    assert_eq!(same_result(small_result(), &files(&folder.path().join("whole"))), Ok(()));
    let err = ask(folder.path(), "merge results/small-1-of-2 results/small-2-of-2 --out whole").refusal(2);
    assert!(err.contains("whole holds a finished result; replace it with --force"), "{err}");
}

#[test]
fn a_run_killed_again_and_again_ends_with_the_same_result() {
    let folder = folder_with("large.toml", &large());
    let out = folder.path().join("out");
    let plain = large_result();
    // Machines differ in speed: a run is killed after a fraction of the time that a whole one takes here and now.
    let begun = Instant::now();
    plain_run(&large());
    let whole = begun.elapsed().as_millis() as usize;
    let mut random = Random::new(0xdead);
    let (mut kills, mut resumed) = (0, 0);
    let cut_short = loop {
        let (threads, tile) = (1 + kills % 2, [65_536, 1000, 4096][kills % 3]);
        let mut child = start(folder.path(), &format!("sweep large.toml --out out --resume --threads {threads} --tile {tile}"));
        // The first run hardly starts, every other one may save nothing; later ones live longer, so that the loop ends.
        let patience = match kills {
            0 => random.whole(0, whole / 20),
            odd if odd % 2 == 1 => random.whole(whole / 6, whole / 5) + whole / 20 * kills,
            _ => random.whole(whole / 20, whole / 8),
        };
        let deadline = Instant::now() + Duration::from_millis(patience as u64);
        if !wait_until(&mut child, || Instant::now() >= deadline) {
            let answer = super::Answer::from(child.wait_with_output().expect("the output can be read"));
            assert_eq!(answer.code, Some(0), "after {kills} kills: {}", answer.err);
            break false;
        }
        kill(&mut child);
        kills += 1;
        assert_nothing_is_half_written(&out, plain);
        let manifest = out.join("checkpoint/manifest.json");
        resumed += u32::from(manifest.exists() && json_of(&manifest)["manifest"]["done"].as_array().is_some_and(|done| !done.is_empty()));
        assert!(kills < 200, "no progress in {kills} runs");
        if out.join("summary.json").exists() {
            break true;
        }
    };
    assert!(kills >= 3 && resumed >= 1, "{kills} kills, {resumed} of them with something to resume");
    let run = json_of(&out.join("run.json"));
    assert_eq!(run["origin"], "resumed from a checkpoint");
    assert!(run["designs"].as_u64() < json_of(&out.join("summary.json"))["designs"].as_u64(), "it began anew: {run}");
    let (mut expected, mut result) = (plain.clone(), files(&out));
    // A kill after the mark was written leaves a finished result, perhaps still with the checkpoint, or without the page.
    if cut_short {
        result.retain(|name, _| name != "checkpoint" && !is_writing(name));
        if !result.contains_key("report.html") {
            expected.remove("report.html");
        }
    }
    assert_eq!(same_result(&expected, &result), Ok(()));
}

#[test]
fn a_run_killed_while_it_writes_its_result_shows_nothing_half_written() {
    let folder = folder_with("small.toml", SMALL);
    let out = folder.path().join("out");
    let mut random = Random::new(0xf11e);
    let early =
        ["checkpoint/result", "checkpoint/result/front.csv", "study.toml", "scenarios.csv", "front.parquet", "map-axial_force_N.csv"];
    let mut hits = 0;
    for round in 0..60 {
        let seen = out.join(random.pick(&early));
        let mut child = start(folder.path(), "sweep small.toml --out out --resume --tile 1000");
        let alive = wait_until(&mut child, || seen.exists());
        kill(&mut child);
        assert_nothing_is_half_written(&out, small_result());
        let hit = alive && !out.join("summary.json").exists();
        hits += u32::from(hit);
        if hit {
            ask(folder.path(), "sweep small.toml --out out --resume").text();
            assert_eq!(same_result(small_result(), &files(&out)), Ok(()), "round {round}");
        }
        std::fs::remove_dir_all(&out).expect("the folder can be removed");
        if hits == 4 {
            break;
        }
    }
    assert!(hits > 0, "no kill came while the result was being written");
}

#[test]
fn a_result_that_cannot_be_written_can_be_resumed() {
    let folder = folder_with("large.toml", &large());
    let out = folder.path().join("out");
    let in_the_way = out.join("map-axial_force_N.svg");
    let mut child = start(folder.path(), "sweep large.toml --out out");
    assert!(wait_until(&mut child, || out.join("checkpoint/manifest.json").exists()), "it ended before it could be disturbed");
    // A folder in the place of a picture, which was not there when the run began.
    std::fs::create_dir(&in_the_way).expect("folders can be made");
    let err = super::Answer::from(child.wait_with_output().expect("the output can be read")).refusal(2);
    assert!(err.contains("map-axial_force_N.svg") && err.contains("did not write"), "{err}");
    assert!(!out.join("summary.json").exists() && !out.join("front.csv").exists(), "nothing is in place");
    let err = ask(folder.path(), "sweep large.toml --out out --resume").refusal(2);
    assert!(err.contains("map-axial_force_N.svg"), "{err}");
    std::fs::remove_dir(&in_the_way).expect("it is empty");
    ask(folder.path(), "sweep large.toml --out out --resume").text();
    assert_eq!(json_of(&out.join("run.json"))["designs"], 0, "nothing is judged again");
    assert_eq!(same_result(large_result(), &files(&out)), Ok(()));
}

#[test]
fn a_replacement_that_was_killed_can_be_resumed() {
    let folder = folder_with("large.toml", &larger(11));
    let out = folder.path().join("out");
    super::write(folder.path(), "small.toml", SMALL);
    ask(folder.path(), "sweep small.toml --out out").text();
    let mut child = start(folder.path(), "sweep large.toml --out out --force");
    let manifest = out.join("checkpoint/manifest.json");
    assert!(wait_until(&mut child, || manifest.exists()), "it ended before it could be killed");
    kill(&mut child);
    let mut old = files(&out);
    old.remove("checkpoint");
    assert_eq!(same_result(small_result(), &old), Ok(()), "the old result stays until there is a new one");
    ask(folder.path(), "sweep large.toml --out out --resume").text();
    assert_eq!(same_result(&plain_run(&larger(11)), &files(&out)), Ok(()));
}

#[test]
fn resuming_without_a_checkpoint_starts_from_the_beginning() {
    let folder = folder_with("small.toml", SMALL);
    ask(folder.path(), "sweep small.toml --out out --resume").text();
    assert_eq!(same_result(small_result(), &files(&folder.path().join("out"))), Ok(()));
    assert_eq!(json_of(&folder.path().join("out/run.json"))["origin"], "one run");
}

#[cfg(unix)]
#[test]
fn ctrl_c_stops_in_good_order_and_names_the_way_back() {
    let folder = folder_with("my large.toml", &large());
    // Bounds that are left at once save a front before any design is done.
    let words = ["sweep", "my large.toml", "--out", "my results/it's here", "--threads", "1", "--method", "exhaustive"];
    let mut child = program(folder.path(), &words).spawn().expect("the program starts");
    let out = folder.path().join("my results/it's here");
    let saved = || files_of_kind(&out.join("checkpoint"), "bin") > 0;
    assert!(wait_until(&mut child, saved), "it ended before it could be interrupted");
    let interrupt = program_named("kill").args(["-INT", &child.id().to_string()]).status().expect("kill can be run");
    assert!(interrupt.success());
    let answer = super::Answer::from(child.wait_with_output().expect("the output can be read"));
    let err = answer.refusal(1);
    assert!(err.contains("stopped") && !out.join("summary.json").exists(), "{err}");
    let done = json_of(&out.join("checkpoint/manifest.json"))["manifest"]["done"][0]["end"].as_u64();
    assert!(done > Some(0), "{done:?}");
    // The command is meant to be pasted into a shell.
    let command = err.split_once("go on with: ").map(|(_, command)| command.trim()).expect("the message names a command");
    let folder_of_program = Path::new(env!("CARGO_BIN_EXE_beltspace")).parent().expect("it lies in a folder");
    let path = format!("{}:{}", folder_of_program.display(), std::env::var("PATH").unwrap_or_default());
    let shell = program_named("sh").args(["-c", command]).env("PATH", path).current_dir(folder.path()).output().expect("sh can be run");
    super::Answer::from(shell).text();
    assert_eq!(json_of(&out.join("run.json"))["origin"], "resumed from a checkpoint");
    assert_eq!(same_result(large_result(), &files(&out)), Ok(()));
}

#[cfg(unix)]
fn program_named(name: &str) -> std::process::Command {
    let mut command = std::process::Command::new(name);
    command.stdin(Stdio::null());
    command
}

/// Number of files in a folder with this extension.
#[cfg(unix)]
fn files_of_kind(folder: &Path, extension: &str) -> usize {
    let entries = folder.read_dir().into_iter().flatten().flatten();
    entries.filter(|entry| entry.path().extension().is_some_and(|it| it == extension)).count()
}

#[test]
fn two_runs_cannot_share_a_folder() {
    // It must outlast five commands on a busy machine.
    let folder = folder_with("large.toml", &larger(401));
    let manifest = folder.path().join("out/checkpoint/manifest.json");
    let mut child = start(folder.path(), "sweep large.toml --out out --threads 1");
    assert!(wait_until(&mut child, || manifest.exists()), "it ended before it could be disturbed");
    let who = format!("process {} on ", child.id());
    for line in [
        "sweep large.toml --out out",
        "sweep large.toml --out ./out/../out --resume",
        "sweep large.toml --out out --force",
        "merge out --out whole",
        "report out",
    ] {
        let err = ask_words(folder.path(), &line.split_whitespace().collect::<Vec<_>>()).refusal(1);
        assert!(err.contains("another beltspace is using this directory") && err.contains(&who), "{line}: {err}");
        assert!(err.contains("beltspace sweep large.toml --out out --threads 1); wait for it"), "{line}: {err}");
    }
    assert!(child.try_wait().expect("it can be asked").is_none(), "the first run must go on");
    assert!(manifest.exists() && !folder.path().join("whole").exists());
    kill(&mut child);
    let unfinished = ask(folder.path(), "sweep large.toml --out out").refusal(2);
    assert!(unfinished.contains("out holds an unfinished run"), "{unfinished}");
    // A directory is free when its process is gone.
    let err = ask(folder.path(), "merge out --out whole").refusal(2);
    assert!(err.contains("designs left to judge"), "{err}");
}

/// If not all threads can be started, because processes or memory are limited, the others do the work.
#[cfg(target_os = "linux")]
#[test]
fn threads_that_cannot_be_had_are_done_without() {
    let folder = folder_with("small.toml", SMALL);
    // Stacks of 64 MB in an address space of 1 GB.
    let limited = |options: &str| {
        let line = format!("ulimit -v 1000000; RUST_MIN_STACK=67108864 exec \"$0\" sweep {options} --threads 64 --engine cpu");
        let run = program_named("sh").args(["-c", &line, env!("CARGO_BIN_EXE_beltspace")]).current_dir(folder.path()).output();
        super::Answer::from(run.expect("sh can be run"))
    };
    let answer = limited("small.toml --out out");
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    assert!(answer.err.contains("warning: 64 threads were asked for, but only ") && !answer.err.contains("panicked"), "{}", answer.err);
    let out = folder.path().join("out");
    let threads = json_of(&out.join("run.json"))["threads"].as_u64();
    assert!(threads.is_some_and(|it| (1..20).contains(&it)), "{threads:?}");
    assert_eq!(same_result(small_result(), &files(&out)), Ok(()));
    // By bounds too.
    let grid = include_str!("../../../studies/metal-grid.toml").replace("count = 37", "count = 9");
    write(folder.path(), "grid.toml", &grid);
    let answer = limited("grid.toml --out bounds --method bounds");
    assert!(answer.code == Some(0) && !answer.err.contains("panicked"), "{}", answer.err);
    ask(folder.path(), "sweep grid.toml --out plain --method exhaustive").text();
    assert_eq!(same_result(&files(&folder.path().join("plain")), &files(&folder.path().join("bounds"))), Ok(()));
}
