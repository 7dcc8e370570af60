//! One process at a time uses a directory, and no file that beltspace did not write is touched.

use super::{Answer, SMALL, ask, ask_words, files, folder_with, json_of, larger, program, read, same_result, small_result, write};
use crate::random::Random;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, Instant};

/// Studies that end in a moment and whose results have different fronts.
const RACERS: u32 = 6;
/// Processes that compete for one directory in a round.
const CROWD: usize = 14;

/// Everything below a folder: links as what they point to, folders as nothing, files as what is in them.
fn tree(folder: &Path) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for entry in folder.read_dir().expect("it can be listed") {
        let path = entry.expect("it can be listed").path();
        let name = path.file_name().expect("it has one").to_string_lossy().into_owned();
        if let Ok(target) = path.read_link() {
            found.insert(name, format!("-> {}", target.display()));
        } else if path.is_dir() {
            found.extend(tree(&path).into_iter().map(|(below, text)| (format!("{name}/{below}"), text)));
            found.insert(name, String::new());
        } else {
            found.insert(name, String::from_utf8_lossy(&std::fs::read(&path).expect("it can be read")).into_owned());
        }
    }
    found
}

#[cfg(unix)]
#[test]
fn a_folder_named_checkpoint_that_is_not_ours_is_never_touched() {
    let folder = folder_with("small.toml", SMALL);
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir_all(at("project/checkpoint/epoch-9")).expect("folders can be made");
    write(&at("project"), "checkpoint/epoch-9/model.bin", "weights");
    std::fs::create_dir_all(at("elsewhere")).expect("folders can be made");
    write(&at("elsewhere"), "keep.txt", "precious");
    write(&at("elsewhere"), "manifest.json", "{\"name\": \"web app\"}");
    for (name, target) in [("linked", "../elsewhere"), ("dangling", "../nowhere")] {
        std::fs::create_dir(at(name)).expect("folders can be made");
        std::os::unix::fs::symlink(target, at(name).join("checkpoint")).expect("links can be made");
    }
    std::fs::create_dir(at("web")).expect("folders can be made");
    std::fs::rename(at("elsewhere"), at("web/checkpoint")).expect("it can be moved");
    std::fs::create_dir(at("elsewhere")).expect("folders can be made");
    write(&at("elsewhere"), "keep.txt", "precious");
    let before = tree(folder.path());
    for out in ["project", "linked", "dangling", "web"] {
        for option in ["", "--force", "--resume", "--shard 1/2", "--shard 1/2 --force"] {
            let err = ask(folder.path(), &format!("sweep small.toml --out {out} {option}")).refusal(2);
            let told = format!("{out}/checkpoint is where the checkpoint would be, but this program did not write it");
            assert!(err.contains(&told) && err.contains("move it away"), "{out} {option}: {err}");
        }
        assert_eq!(tree(folder.path()), before, "{out}");
    }
    ask(folder.path(), "sweep small.toml --shard 1/1 --out shard").text();
    let err = ask(folder.path(), "merge shard --out project --force").refusal(2);
    assert!(err.contains("project/checkpoint is where the checkpoint would be"), "{err}");
}

#[cfg(unix)]
#[test]
fn files_of_others_are_never_replaced_not_even_by_force() {
    let folder = folder_with("small.toml", SMALL);
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir_all(at("mine/study.json")).expect("folders can be made");
    for (name, text) in [("front.csv", "thesis"), ("summary.json", "{\"coverage\": 93}"), ("report.html", "<p>mine</p>")] {
        write(&at("mine"), name, text);
    }
    std::os::unix::fs::symlink("../small.toml", at("mine/top.csv")).expect("links can be made");
    let before = tree(folder.path());
    for option in ["", "--force", "--resume"] {
        let err = ask(folder.path(), &format!("sweep small.toml --out mine {option}")).refusal(2);
        let names = "(study.json, front.csv, top.csv, report.html, summary.json)";
        assert!(err.contains("did not write") && err.contains(names), "{option}: {err}");
        assert_eq!(tree(folder.path()), before, "{option}");
    }
    // A file of another program may have been put into a result since.
    let plain = super::changed(SMALL, &[("top = { by = \"axial_force_N\", count = 20 }\n", "")]);
    write(folder.path(), "plain.toml", &plain);
    ask(folder.path(), "sweep plain.toml --out result").text();
    write(&at("result"), "top.csv", "mine");
    let before = tree(&at("result"));
    let err = ask(folder.path(), "sweep small.toml --out result --force").refusal(2);
    assert!(err.contains("result has a file or folder that this program did not write and a result would replace (top.csv)"), "{err}");
    assert_eq!(tree(&at("result")), before);
    ask(folder.path(), "sweep plain.toml --out result --force").text();
    assert_eq!(read(&at("result/top.csv")), "mine", "it is in nobody's way");
}

#[test]
fn files_that_are_named_are_replaced_only_where_they_are_ours() {
    let folder = folder_with("small.toml", SMALL);
    let at = |name: &str| folder.path().join(name);
    ask(folder.path(), "export pulley --calculix deck --sectors 8").text();
    ask(folder.path(), "slurm small.toml --jobs jobs --quiet").text();
    let lines = [
        ("eval pulley --plot own.svg", "own-surface.svg"),
        ("eval timing-belt --plot own.svg --profile own.csv", "own.svg"),
        ("eval pulley-load --profile own.csv", "own.csv"),
        ("sweep small.toml --emit-shader own.wgsl", "own.wgsl"),
        ("export pulley --calculix deck --sectors 8", "deck/README.txt"),
        ("export pulley --calculix deck --sectors 9", "deck/pulley.inp"),
        ("slurm small.toml --jobs jobs --quiet --force", "jobs/merge.sh"),
        ("slurm small.toml --jobs jobs --quiet --force", "jobs/submit.sh"),
    ];
    for (line, name) in lines {
        ask(folder.path(), line).text();
        ask(folder.path(), line).text();
        let own = read(&at(name));
        write(folder.path(), name, "<svg>mine</svg>");
        let before = tree(folder.path());
        let err = ask(folder.path(), line).refusal(2);
        assert!(err.contains(&format!("{name}: a file is there that this program did not write; move it away")), "{line}: {err}");
        assert_eq!(tree(folder.path()), before, "{line}");
        write(folder.path(), name, &own);
    }
}

#[test]
fn a_reproduction_replaces_nothing_but_a_reproduction() {
    let folder = folder_with("README.md", "mine");
    for force in ["", "--force"] {
        let err = ask(folder.path(), &format!("reproduce --out . --quiet --no-report {force}")).refusal(2);
        assert!(err.contains(". has files that would be replaced (README.md); beltspace did not write them"), "{err}");
    }
    assert_eq!(tree(folder.path()), BTreeMap::from([("README.md".to_owned(), "mine".to_owned())]));
}

#[test]
fn a_merge_only_reads_its_shards() {
    let folder = folder_with("small.toml", SMALL);
    for number in 1..=2 {
        ask(folder.path(), &format!("sweep small.toml --shard {number}/2 --out shards/s{number}")).text();
    }
    let before = tree(&folder.path().join("shards"));
    ask(folder.path(), "merge shards/s1 shards/s2 --out whole").text();
    assert_eq!(same_result(small_result(), &files(&folder.path().join("whole"))), Ok(()));
    assert_eq!(tree(&folder.path().join("shards")), before);
    let err = ask(folder.path(), "merge shards/s1 shards/s2 --out shards/s1 --force").refusal(2);
    assert!(err.contains("cannot merge: shards/s1 is one of the shards; write to another --out"), "{err}");
    assert_eq!(tree(&folder.path().join("shards")), before);
}

#[test]
fn a_bad_place_for_a_result_is_named_with_what_to_do() {
    let folder = folder_with("small.toml", SMALL);
    let long = "x".repeat(250);
    let cases = [
        ("small.toml/out", "the directory small.toml/out cannot be made: not a directory"),
        ("/proc/nothing/out", "the directory /proc/nothing/out cannot be made: "),
        ("/", "/ has no parent directory for its lock"),
        (long.as_str(), "(File name too long"),
    ];
    for (out, told) in cases.into_iter().filter(|_| cfg!(target_os = "linux")) {
        let err = ask_words(folder.path(), &["sweep", "small.toml", "--out", out]).refusal(2);
        assert!(err.contains(told) && (err.contains("; name a") || err.contains("; choose a shorter name")), "{out}: {err}");
    }
    assert_eq!(tree(folder.path()).keys().collect::<Vec<_>>(), ["small.toml"], "nothing is left behind");
}

#[test]
fn a_directory_that_disappears_during_a_run_is_told() {
    let folder = folder_with("large.toml", &larger(41));
    let out = folder.path().join("results/large");
    let mut child = program(folder.path(), &["sweep", "large.toml"]).spawn().expect("the program starts");
    while !out.join("checkpoint/manifest.json").exists() {
        assert!(child.try_wait().expect("it can be asked").is_none(), "it ended before it could be disturbed");
        std::thread::sleep(Duration::from_millis(1));
    }
    std::fs::rename(&out, folder.path().join("moved")).expect("it can be moved");
    let err = Answer::from(child.wait_with_output().expect("the output can be read")).refusal(1);
    assert!(err.contains("results/large: it was removed or moved while this program was writing to it"), "{err}");
    assert!(!out.exists() && folder.path().join("moved/checkpoint/manifest.json").exists(), "what was moved is whole");
}

#[test]
fn locks_are_gone_when_nobody_holds_them() {
    let folder = folder_with("small.toml", SMALL);
    for line in ["sweep small.toml --out a/b/out", "report a/b/out", "sweep small.toml --out a/b/out --force", "eval small.toml --design 3"]
    {
        ask(folder.path(), line).text();
        assert!(tree(folder.path()).keys().all(|name| !name.contains("lock")), "{line}");
    }
    // A refusal removes the directories that were made for it.
    ask(folder.path(), "sweep small.toml --out c/d --perturb axial_force_N=1 --engine cpu").refusal(2);
    assert!(!folder.path().join("c").exists());
}

/// A run without `--force` replaces nothing, even if another run has finished just before it.
#[test]
fn a_result_that_was_finished_meanwhile_is_not_replaced_without_force() {
    let folder = folder_with("one.toml", SMALL);
    write(folder.path(), "two.toml", &super::changed(SMALL, &[("\"Small\"", "\"Two\"")]));
    let mut random = Random::new(0x0ace);
    let (mut first, mut second) = (0, 0);
    for round in 0..20 {
        let out = folder.path().join("out");
        let _ = std::fs::remove_dir_all(&out);
        let words = |study| ["sweep", study, "--out", "out", "--quiet", "--no-report"];
        let begun = program(folder.path(), &words("two.toml")).spawn().expect("the program starts");
        std::thread::sleep(Duration::from_millis(random.below(20) as u64));
        let one = ask_words(folder.path(), &words("one.toml"));
        let two = Answer::from(begun.wait_with_output().expect("the output can be read"));
        let title = json_of(&out.join("summary.json"))["title"].clone();
        let (won, lost, name) = if one.code == Some(0) { (one, two, "Small") } else { (two, one, "Two") };
        assert_eq!((won.code, title), (Some(0), name.into()), "round {round}: {}", won.err);
        assert_ne!(lost.code, Some(0), "round {round}: both have finished");
        assert!(
            lost.err.contains("is using this directory") || lost.err.contains("holds a finished result"),
            "round {round}: {}",
            lost.err
        );
        first += u32::from(name == "Small");
        second += u32::from(name == "Two");
    }
    println!("the run that began later won {first} times, the other {second}");
}

/// A crowd of sweeps, merges and reports on one directory: at any time one of them writes, the others say who it is, and what is there
/// in the end is one whole result of one study.
#[test]
fn a_crowd_on_one_directory_leaves_one_whole_result() {
    let rounds: usize = std::env::var("BELTSPACE_RACE_ROUNDS").ok().map_or(3, |it| it.parse().expect("a number of rounds"));
    let seed = 0xc0de;
    println!("{rounds} rounds of {CROWD} processes, seed {seed:#x}");
    let folder = tempfile::tempdir().expect("there is room");
    for racer in 0..RACERS {
        let levels = 20 + 5 * racer;
        let text = format!(
            "model = \"metal-cvt\"\ntitle = \"t{racer}\"\n[design]\nratio = {{ from = 0.5, to = 2, count = 60 }}\n\
             friction = {{ from = 0.05, to = 0.09, count = {levels} }}\n[objectives]\naxial_force_N = \"min\"\ntorque_capacity_Nm = \"max\"\n"
        );
        write(folder.path(), &format!("t{racer}.toml"), &text);
        for number in 1..=2 {
            ask(folder.path(), &format!("sweep t{racer}.toml --shard {number}/2 --out shards/{racer}-{number}")).text();
        }
    }
    let mut random = Random::new(seed);
    let mut seen = BTreeMap::<&str, u32>::new();
    for round in 0..rounds {
        let out = folder.path().join("out");
        let _ = std::fs::remove_dir_all(&out);
        let mut crowd = Vec::new();
        for _ in 0..CROWD {
            let racer = random.below(RACERS as usize);
            let line = match random.below(8) {
                0 => "report out --quiet".to_owned(),
                1 => format!("merge shards/{racer}-1 shards/{racer}-2 --out out --force --quiet"),
                2 => format!("sweep t{racer}.toml --out out --quiet --engine cpu --resume"),
                _ => format!("sweep t{racer}.toml --out out --quiet --engine cpu --force --no-report"),
            };
            let child = program(folder.path(), &line.split_whitespace().collect::<Vec<_>>()).spawn().expect("the program starts");
            let started = Instant::now();
            let ended = std::thread::spawn(move || {
                let answer = Answer::from(child.wait_with_output().expect("the output can be read"));
                (answer, Instant::now())
            });
            crowd.push((line, started, ended));
            std::thread::sleep(Duration::from_micros(random.below(20_000) as u64));
        }
        let crowd: Vec<_> = crowd.into_iter().map(|(line, started, ended)| (line, started, ended.join().expect("it ends"))).collect();
        let is_writer = |line: &str, answer: &Answer| answer.code == Some(0) && !line.starts_with("report");
        let first_result = crowd.iter().filter(|(line, _, (answer, _))| is_writer(line, answer)).map(|(_, _, (_, ended))| *ended).min();
        let mut finished = 0;
        for (line, started, (answer, _)) in crowd {
            // Possible messages: another process is using the directory, or what was there when this process got it.
            let told = [
                (1, "another beltspace is using this directory"),
                (2, "holds a finished result; replace it with --force"),
                (2, "is not a directory; name the one that"),
            ];
            // Between the moment in which the first writer makes the directory and that in which it has it for itself, it is empty.
            let empty = "is not a finished result: it has no summary.json";
            let may_be_empty = line.starts_with("report") && first_result.is_some_and(|ended| started < ended);
            let how = match answer.code {
                Some(0) => "done",
                Some(2) if may_be_empty && answer.err.contains(empty) => empty,
                code => told.iter().find(|(it, words)| code == Some(*it) && answer.err.contains(words)).map_or("", |(_, words)| words),
            };
            assert!(!how.is_empty(), "round {round}: {line}: exit {:?}: {}", answer.code, answer.err);
            finished += u32::from(how == "done" && !line.starts_with("report"));
            *seen.entry(how).or_default() += 1;
        }
        assert!(finished > 0, "round {round}: nobody has finished");
        whole_result_of_one_study(folder.path(), round);
    }
    println!("{seen:?}");
    assert!(seen.len() >= 2, "nobody was in anybody's way: {seen:?}");
}

/// All files of the result directory belong to the same result.
fn whole_result_of_one_study(folder: &Path, round: usize) {
    let out = folder.join("out");
    let summary = json_of(&out.join("summary.json"));
    let title = summary["title"].as_str().expect("it has one").to_owned();
    let said = |what: String| format!("round {round}: {title}: {what}");
    assert_eq!(json_of(&out.join("study.json"))["title"], summary["title"], "{}", said("study.json".to_owned()));
    assert_eq!(read(&out.join("study.toml")), read(&folder.join(format!("{title}.toml"))), "{}", said("study.toml".to_owned()));
    let rows = read(&out.join("front.csv")).lines().count() as u64 - 1;
    assert_eq!(Some(rows), summary["front"].as_u64(), "{}", said("front.csv".to_owned()));
    ask(folder, "report out --quiet").text();
    let page = read(&out.join("report.html"));
    assert!(page.contains(&format!("<title>{title}")), "{}", said("report.html".to_owned()));
    let listed = json_of(&out.join("run.json"))["files"].clone();
    let mut there: Vec<String> = files(&out).into_keys().filter(|name| name != "report.html").collect();
    let mut listed: Vec<String> = serde_json::from_value(listed).expect("they are names");
    there.sort();
    listed.sort();
    assert_eq!(there, listed, "{}", said("files".to_owned()));
    assert!(!folder.join(".out.beltspace-lock").exists(), "{}", said("the lock is still there".to_owned()));
}
