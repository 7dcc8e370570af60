//! Checkpoints and shards that are damaged, foreign or incomplete are refused by name.

use super::{SMALL, ask, changed, files, folder_with, json_of, large, program, read, same_result, small_result, write};
use crate::random::Random;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A folder with a study and a finished first half of it, whose checkpoint is what an interrupted run leaves.
fn half() -> (TempDir, PathBuf) {
    let folder = folder_with("small.toml", SMALL);
    ask(folder.path(), "sweep small.toml --shard 1/2 --out half").text();
    let checkpoint = folder.path().join("half/checkpoint");
    (folder, checkpoint)
}

const RESUME: &str = "sweep small.toml --shard 1/2 --out half --resume";

fn state_of(checkpoint: &Path) -> PathBuf {
    let name = json_of(&checkpoint.join("manifest.json"))["manifest"]["state"][0].as_str().expect("there is a state").to_owned();
    checkpoint.join(name)
}

#[test]
fn a_changed_study_is_refused_by_what_changed() {
    let (folder, checkpoint) = half();
    let before = files(&checkpoint);
    let edits: [(&str, &str, &[&str]); 7] = [
        ("strength_MPa = 800", "strength_MPa = 801", &["fixed", "\"strength_MPa\":800", "\"strength_MPa\":801"]),
        ("title = \"Small\"", "title = \"Tiny\"", &["title: was \"Small\", is \"Tiny\""]),
        ("count = 13", "count = 14", &["design: was", "groove_angle_deg", "\"count\":13", "\"count\":14"]),
        ("torque_Nm = [50, 150]", "torque_Nm = [50, 151]", &["operation: was", "[50,150]", "[50,151]"]),
        ("band_count    = \"min\"", "band_count    = \"max\"", &["objectives: was", "band_count"]),
        ("slip_margin   = { min = 0 }", "slip_margin   = { above = 0 }", &["constraints: was", "slip_margin"]),
        ("bins = 40", "bins = 41", &["histograms: was", "\"bins\":41"]),
    ];
    for (from, to, expected) in edits {
        write(folder.path(), "small.toml", &changed(SMALL, &[(from, to)]));
        let err = ask(folder.path(), RESUME).refusal(2);
        assert!(err.contains("the checkpoint is of another study") && err.contains("--force"), "{err}");
        assert!(expected.iter().all(|part| err.contains(part)), "{to}: {err}");
    }
    assert_eq!(files(&checkpoint), before, "a refusal changes nothing");
    // Comments and layout are not the study.
    write(folder.path(), "small.toml", &format!("# A comment.\n\n{}", changed(SMALL, &[("count = 13", "count  =  13")])));
    ask(folder.path(), RESUME).text();
    for line in ["sweep small.toml --out half --resume", "sweep small.toml --shard 2/2 --out half --resume"] {
        let err = ask(folder.path(), line).refusal(2);
        assert!(err.contains("the checkpoint is of shard 1/2, not") && err.contains("use --shard 1/2"), "{err}");
    }
}

#[test]
fn a_damaged_state_is_refused_by_name() {
    let (folder, checkpoint) = half();
    let state = state_of(&checkpoint);
    let name = state.file_name().expect("it has a name").to_string_lossy().into_owned();
    let whole = std::fs::read(&state).expect("the state can be read");
    let mut random = Random::new(0xb17e);
    let mut spoilt: Vec<Vec<u8>> = vec![Vec::new(), whole[..whole.len() - 1].to_vec(), [&whole[..], b"x"].concat()];
    for _ in 0..10 {
        let mut bytes = whole.clone();
        bytes[random.below(whole.len())] ^= 1 << random.below(8);
        spoilt.push(bytes);
    }
    for bytes in spoilt {
        std::fs::write(&state, bytes).expect("the state can be written");
        for line in [RESUME, "merge half --out whole"] {
            let err = ask(folder.path(), line).refusal(1);
            assert!(err.contains(&name) && err.contains("checksum"), "{line}: {err}");
        }
    }
    std::fs::remove_file(&state).expect("the state can be removed");
    let err = ask(folder.path(), RESUME).refusal(1);
    assert!(err.contains(&name), "{err}");
    ask(folder.path(), "sweep small.toml --shard 1/2 --out half --force").text();
    ask(folder.path(), "sweep small.toml --shard 2/2 --out other").text();
    ask(folder.path(), "merge half other --out whole").text();
    assert_eq!(same_result(small_result(), &files(&folder.path().join("whole"))), Ok(()), "--force starts again");
}

#[test]
fn a_damaged_manifest_is_refused() {
    let (folder, checkpoint) = half();
    let manifest = checkpoint.join("manifest.json");
    let whole = read(&manifest);
    for text in ["", "{}", "[]", &whole[..whole.len() / 2], &whole[1..]] {
        write(&checkpoint, "manifest.json", text);
        for (line, code) in [(RESUME, 2), ("merge half --out whole", 1)] {
            let err = ask(folder.path(), line).refusal(code);
            let told = if line == RESUME { "its manifest.json was not written by this program" } else { "the manifest is damaged" };
            assert!(err.contains(told) && err.contains("half"), "{line}: {err}");
        }
    }
    for other in ["\"version\": 3", "\"version\": 999"] {
        write(&checkpoint, "manifest.json", &changed(&whole, &[("\"version\": 4", other)]));
        let err = ask(folder.path(), RESUME).refusal(1);
        assert!(err.contains("another version of beltspace"), "{err}");
    }
}

/// With a wrong digit the file is still readable, but designs would silently be counted twice, left out or judged by another study.
#[test]
fn a_manifest_with_a_wrong_digit_never_leads_to_a_wrong_result() {
    let (folder, _) = half();
    ask(folder.path(), "sweep small.toml --shard 2/2 --out other").text();
    // Shard 1/1 is the whole study, which a sweep can finish.
    ask(folder.path(), "sweep small.toml --shard 1/1 --out all").text();
    copy_folder(&folder.path().join("all/checkpoint"), &folder.path().join("kept"));
    let mut random = Random::new(0xd161);
    let mut wrong = Vec::new();
    for (spoilt, line, tries) in [("half", "merge half other --out whole --force", 30), ("all", "sweep small.toml --out all --resume", 6)] {
        let checkpoint = folder.path().join(spoilt).join("checkpoint");
        let whole = read(&checkpoint.join("manifest.json"));
        let digits: Vec<usize> = (0..whole.len()).filter(|&at| whole.as_bytes()[at].is_ascii_digit()).collect();
        let done = whole.find("\"done\"").expect("a manifest says what is done");
        let of_done = digits.iter().copied().filter(|&at| at > done).take(6);
        let anywhere = (0..tries).map(|_| random.pick(&digits));
        for at in of_done.chain(anywhere).collect::<Vec<_>>() {
            let mut bytes = whole.clone().into_bytes();
            let other = random.whole(1, 9) as u8;
            bytes[at] = b'0' + (bytes[at] - b'0' + other) % 10;
            if !checkpoint.exists() {
                copy_folder(&folder.path().join("kept"), &checkpoint);
            }
            std::fs::write(checkpoint.join("manifest.json"), bytes).expect("it can be written");
            let answer = ask(folder.path(), line);
            let out = folder.path().join(if spoilt == "all" { "all" } else { "whole" });
            let same = || same_result(small_result(), &files(&out));
            if !matches!(answer.code, Some(1 | 2)) && (answer.code != Some(0) || same().is_err()) {
                wrong.push(format!("{} (exit {:?} of {line})", digit_of(&whole, at), answer.code));
            }
        }
    }
    assert!(wrong.is_empty(), "a wrong digit was not noticed in\n{}", wrong.join("\n"));
}

/// Designs that were judged already would be counted twice, and designs that were not left out.
#[test]
fn a_manifest_that_claims_other_designs_is_refused() {
    let folder = folder_with("small.toml", SMALL);
    ask(folder.path(), "sweep small.toml --shard 1/1 --out all").text();
    let manifest = folder.path().join("all/checkpoint/manifest.json");
    let whole = read(&manifest);
    for (from, to) in [("\"end\": 12285", "\"end\": 6000"), ("\"start\": 0", "\"start\": 6000"), ("\"end\": 12285", "\"end\": 99999")] {
        std::fs::write(&manifest, changed(&whole, &[(from, to)])).expect("it can be written");
        let answer = ask(folder.path(), "sweep small.toml --out all --resume");
        assert_eq!(answer.code, Some(2), "{to} in place of {from} was believed:\n{}{}", answer.out, answer.err);
        assert!(answer.err.contains("manifest") && !folder.path().join("all/summary.json").exists(), "{}", answer.err);
    }
    std::fs::write(&manifest, whole).expect("it can be written");
    ask(folder.path(), "sweep small.toml --out all --resume").text();
    assert_eq!(same_result(small_result(), &files(&folder.path().join("all"))), Ok(()));
}

/// Where a digit stands: what is around it in its line.
fn digit_of(text: &str, at: usize) -> String {
    let line = text[..at].matches('\n').count() + 1;
    let around: String = text[at.saturating_sub(20)..].chars().take(40).map(|c| if c == '\n' { ' ' } else { c }).collect();
    format!("line {line}: ...{around}...")
}

#[test]
fn an_incomplete_or_mixed_set_of_shards_is_refused() {
    let folder = folder_with("small.toml", SMALL);
    write(folder.path(), "other.toml", &changed(SMALL, &[("strength_MPa = 800", "strength_MPa = 700")]));
    for number in 1..=3 {
        ask(folder.path(), &format!("sweep small.toml --shard {number}/3 --out s{number}")).text();
    }
    ask(folder.path(), "sweep other.toml --shard 2/3 --out foreign").text();
    ask(folder.path(), "sweep small.toml --shard 2/2 --out halved").text();
    let cases: [(&str, &[&str]); 10] = [
        ("s1 s3", &["shard 2/3 is missing"]),
        ("s2", &["shard 1/3 is missing", "shard 3/3 is missing"]),
        ("s1 s2 s3 s1", &["s1 and s1 are the same shard"]),
        ("s1 s2 s3 foreign", &["foreign is of another study than s1", "700", "800"]),
        ("foreign s1 s3", &["s1 is of another study than foreign", "s3 is of another study than foreign"]),
        ("s1 halved s3", &["halved is shard 2/2, but s1 is one of 3"]),
        ("s1 s2 nothing", &["nothing", "there is no checkpoint here"]),
        ("s1 s2 .", &["there is no checkpoint here"]),
        ("s1 s2 small.toml", &["small.toml", "there is no checkpoint here"]),
        ("s1 s2 s3 s3/checkpoint", &["s3 and s3/checkpoint are the same shard"]),
    ];
    for (shards, expected) in cases {
        let answer = ask(folder.path(), &format!("merge {shards} --out whole"));
        assert!(expected.iter().all(|part| answer.err.contains(part)), "{shards}: {}", answer.err);
        assert_eq!((answer.code, answer.out.as_str()), (Some(2), ""), "{shards}: {}", answer.err);
        assert!(!folder.path().join("whole").exists(), "{shards}");
    }
    copy_folder(&folder.path().join("s2/checkpoint"), &folder.path().join("copy"));
    let err = ask(folder.path(), "merge s1 s2 copy s3 --out whole").refusal(2);
    assert!(err.contains("shard 2/3 is there more than once: s2; copy"), "{err}");
}

fn copy_folder(from: &Path, to: &Path) {
    std::fs::create_dir(to).expect("folders can be made");
    for (name, bytes) in files(from) {
        std::fs::write(to.join(name), bytes.expect("a checkpoint has no folders")).expect("files can be written");
    }
}

#[test]
fn an_unfinished_shard_is_refused_until_it_is_finished() {
    let folder = folder_with("large.toml", &large());
    let words = ["sweep", "large.toml", "--shard", "1/1", "--out", "s"];
    let mut child = program(folder.path(), &words).spawn().expect("the program starts");
    let manifest = folder.path().join("s/checkpoint/manifest.json");
    let start = std::time::Instant::now();
    while !manifest.exists() && start.elapsed().as_secs() < 60 {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    child.kill().expect("it is still running");
    child.wait().expect("it can be waited for");
    let err = ask(folder.path(), "merge s --out whole").refusal(2);
    assert!(err.contains("s (shard 1/1) has") && err.contains("designs left to judge") && err.contains("--resume"), "{err}");
    assert!(!folder.path().join("whole").exists());
}

/// The number of shards may be as large as a number can be; the message about missing ones is short all the same.
#[test]
fn a_set_that_lacks_most_of_its_shards_is_refused_in_a_few_words() {
    let folder = folder_with(
        "small.toml",
        &changed(
            SMALL,
            &[("count = 13", "count = 2"), ("count = 21", "count = 2"), ("count = 40", "count = 4")]
                .map(|(from, to)| if from == "count = 40" { ("bins = 40", "bins = 4") } else { (from, to) }),
        ),
    );
    let most = u64::MAX;
    let cases = [
        (1, most, format!("cannot merge: shards 2 to {most} of {most} are missing")),
        (most, most, format!("cannot merge: shards 1 to {} of {most} are missing", most - 1)),
        (7, 1_000_000, "cannot merge: shards 1 to 6 of 1000000 are missing; shards 8 to 1000000 of 1000000 are missing".to_owned()),
        (2, 3, "cannot merge: shard 1/3 is missing; shard 3/3 is missing".to_owned()),
    ];
    for (number, of, told) in cases {
        ask(folder.path(), &format!("sweep small.toml --shard {number}/{of} --out one --quiet --force")).text();
        let err = ask(folder.path(), "merge one --out all").refusal(2);
        assert_eq!(err.trim_end(), format!("error: {told}"));
    }
}
