//! Which files of a directory are this program's, and interrupted switches from one result to the next.

use super::{Contents, claim};
use crate::checkpoint::Checkpoint;
use crate::names::{MARK, RUN};
use crate::result_files::{is_ours, result_files};
use crate::study::Study;
use crate::tiles::Shard;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

const STUDY: &str = "model = \"metal-cvt\"\n[design]\nband_count = { from = 6, to = 14 }\n[objectives]\naxial_force_N = \"min\"\n";

fn study() -> Study {
    Study::parse_in(STUDY, "study.toml", Path::new(".")).expect("it is right")
}

fn summary() -> String {
    format!(r#"{{ "version": "0.1.0", "model": "metal-cvt", "title": "t", "study_hash": "{}", "designs": 9 }}"#, study().hash())
}

fn put(folder: &Path, files: &[(&str, &str)]) {
    for (name, text) in files {
        fs::create_dir_all(folder.join(name).parent().expect("it is in a folder")).expect("folders can be made");
        fs::write(folder.join(name), text).expect("files can be written");
    }
}

fn texts(folder: &Path) -> BTreeMap<String, String> {
    let entries = folder.read_dir().expect("it can be listed").map(|it| it.expect("it can be listed"));
    let files = entries.filter(|it| it.path().is_file());
    files.map(|it| (it.file_name().to_string_lossy().into_owned(), fs::read_to_string(it.path()).expect("it is text"))).collect()
}

#[test]
fn a_directory_is_ours_by_its_mark_and_what_it_lists() {
    let folder = tempfile::tempdir().expect("there is room");
    let own_files = |run: &str, mark: &str| {
        put(folder.path(), &[(MARK, mark), (RUN, run), ("front.csv", "x"), ("top.csv", "x"), ("notes.md", "x")]);
        Contents::of(folder.path()).expect("it is a folder").own_files().expect("it can be listed")
    };
    let older = ["front.csv", RUN, MARK, "top.csv"];
    assert_eq!(own_files("{}", &summary()), older, "an older result does not list its files");
    assert_eq!(
        own_files(r#"{"files": ["front.csv", "notes.md", "../x", "run.json", "summary.json"]}"#, &summary()),
        ["front.csv", RUN, MARK]
    );
    // Files of other programs, and damaged ones.
    for mark in ["{}", "[]", "", r#"{"coverage": 1}"#, &summary().replace("study_hash", "hash"), &summary()[1..]] {
        assert!(own_files("{}", mark).is_empty(), "{mark}");
    }
}

#[test]
fn every_file_of_a_result_has_a_name_of_one() {
    for model in crate::models::all() {
        let study = Study::parse_in(&model.starter, "study.toml", Path::new(".")).expect("it is right");
        let foreign: Vec<_> = result_files(&study).into_iter().filter(|name| !is_ours(name)).collect();
        assert!(foreign.is_empty(), "{foreign:?}");
    }
    // Quantities of models that the program does not know count too.
    assert!(["histogram-braking_share.csv", "map-braking_share-2.parquet", "map-feasible_share.svg"].iter().all(|name| is_ours(name)));
    assert!(!["histogram-.csv", "histogram-1.csv", "map-a b.csv", "map-../x.csv"].iter().any(|name| is_ours(name)));
}

#[cfg(unix)]
#[test]
fn what_is_in_the_way_is_named() {
    let folder = tempfile::tempdir().expect("there is room");
    put(folder.path(), &[("front.csv", "mine"), ("checkpoint/model.bin", "weights")]);
    std::os::unix::fs::symlink("elsewhere", folder.path().join("study.json")).expect("links can be made");
    let contents = || Contents::of(folder.path()).expect("it is a folder");
    let files = result_files(&study());
    for force in [false, true] {
        let refused = contents().refuse_to_overwrite(&files, force, true).expect_err("the checkpoint is foreign").to_string();
        assert!(refused.contains("checkpoint") && refused.contains("it has no manifest.json"), "{refused}");
    }
    fs::remove_dir_all(folder.path().join("checkpoint")).expect("it is there");
    for force in [false, true] {
        let refused = contents().refuse_to_overwrite(&files, force, true).expect_err("files are foreign").to_string();
        assert!(refused.contains("(study.json, front.csv)") && refused.contains("move them away"), "{refused}");
    }
    std::os::unix::fs::symlink("elsewhere", folder.path().join("checkpoint")).expect("links can be made");
    let refused = contents().refuse_to_overwrite(&files, true, false).expect_err("it is a link").to_string();
    assert!(refused.contains("a link"), "{refused}");
}

/// A result is put in place file by file; whenever that is interrupted, the next process completes it.
#[test]
fn an_interrupted_switch_is_finished_by_the_next_owner() {
    let old = [("study.toml", "old"), ("top.csv", "old"), ("front.csv", "old"), ("notes.md", "mine"), (RUN, "{}")];
    let new = ["study.toml", "front.csv", "front.svg", RUN];
    let study = study();
    // After so many steps the process is gone.
    for steps in 0..=7 {
        let folder = tempfile::tempdir().expect("there is room");
        let out = folder.path().join("out");
        put(&out, &old);
        put(&out, &[(MARK, &summary())]);
        let taken = claim(&out, "a test").expect("nobody has it");
        assert!(!taken.completed);
        let mut checkpoint = Checkpoint::create(&taken.claim, &study, STUDY, Shard::WHOLE, 9).expect("it can be made");
        for name in new.iter().chain([&MARK]) {
            let text = if *name == MARK { summary().replace("\"t\"", "\"new\"") } else { "new".to_owned() };
            checkpoint.stage(name, |file| file.write_all(text.as_bytes())).expect("it can be written");
        }
        let files: Vec<String> = new.iter().chain([&MARK]).map(|it| (*it).to_owned()).collect();
        let replaced = Contents::of(&out).and_then(|it| it.own_files()).expect("it can be listed");
        checkpoint.announce(files, replaced).expect("it can be written");
        let staged = |name: &str| (out.join("checkpoint/result").join(name), out.join(name));
        let step = |name: &str| {
            let (from, to) = staged(name);
            fs::rename(from, to).expect("it is waiting");
        };
        let all: [&dyn Fn(); 7] = [
            &|| fs::remove_file(out.join(MARK)).expect("it is there"),
            &|| step("study.toml"),
            &|| step("front.csv"),
            &|| step("front.svg"),
            &|| step(RUN),
            &|| fs::remove_file(out.join("top.csv")).expect("it is there"),
            &|| step(MARK),
        ];
        all.iter().take(steps).for_each(|step| step());
        drop((taken, checkpoint));
        assert!(claim(&out, "a test").expect("nobody has it").completed, "after {steps} steps");
        let found = texts(&out);
        let expected = [("front.csv", "new"), ("front.svg", "new"), ("notes.md", "mine"), (RUN, "new"), ("study.toml", "new")];
        assert_eq!(found.iter().filter(|(name, _)| *name != MARK).map(|(a, b)| (a.as_str(), b.as_str())).collect::<Vec<_>>(), expected);
        assert!(found[MARK].contains("\"new\"") && !out.join("checkpoint").exists(), "after {steps} steps");
        assert!(!claim(&out, "a test").expect("nobody has it").completed, "once is enough");
    }
}

#[test]
fn a_switch_with_forged_names_touches_nothing() {
    let folder = tempfile::tempdir().expect("there is room");
    let out = folder.path().join("out");
    put(folder.path(), &[("precious.txt", "mine"), ("out/notes.md", "mine")]);
    for name in ["../precious.txt", "notes.md", "checkpoint", "/etc/passwd"] {
        let taken = claim(&out, "a test").expect("nobody has it");
        let mut checkpoint = Checkpoint::create(&taken.claim, &study(), STUDY, Shard::WHOLE, 9).expect("it can be made");
        checkpoint.stage(MARK, |file| file.write_all(b"{}")).expect("it can be written");
        checkpoint.announce(vec![MARK.to_owned()], vec![name.to_owned()]).expect("it can be written");
        drop((taken, checkpoint));
        assert!(!claim(&out, "a test").expect("nobody has it").completed, "{name}");
        assert!(folder.path().join("precious.txt").exists() && out.join("notes.md").exists() && !out.join(MARK).exists(), "{name}");
    }
}

#[test]
fn what_is_not_ours_stays_in_a_checkpoint() {
    let folder = tempfile::tempdir().expect("there is room");
    let out = folder.path().join("out");
    let taken = claim(&out, "a test").expect("nobody has it");
    let checkpoint = Checkpoint::create(&taken.claim, &study(), STUDY, Shard::WHOLE, 9).expect("it can be made");
    put(&out, &[("checkpoint/notes.md", "mine"), ("checkpoint/result/notes.md", "mine"), (".front.csv.abc123.writing", "half")]);
    checkpoint.stage(MARK, |file| file.write_all(summary().as_bytes())).expect("it can be written");
    checkpoint.switch(vec![MARK.to_owned()], Vec::new()).expect("it can be put in place");
    assert_eq!(fs::read_to_string(out.join("checkpoint/notes.md")).expect("it stays"), "mine");
    assert_eq!(fs::read_to_string(out.join("checkpoint/result/notes.md")).expect("it stays"), "mine");
    assert!(!out.join("checkpoint/manifest.json").exists() && out.join(MARK).exists());
    drop(taken);
    drop(claim(&out, "a test").expect("nobody has it"));
    assert!(!out.join(".front.csv.abc123.writing").exists(), "what was being written is gone");
}
