//! `front_budget` limits the final front only; during the sweep only the memory is limited.

use super::{ask, changed, files, folder_with, json_of, same_result, write};
use std::path::Path;

/// Rows of torque and strength of which none beats another, in this order, but for the last, which beats all of them.
fn rows(folder: &Path, count: u32) {
    let others: String = (0..count).map(|i| format!("{},{}\n", i + 10, i + 10)).collect();
    write(folder, "cases.csv", &format!("torque_Nm,strength_MPa\n1,{}\n{others}", count + 100));
}

const STUDY: &str = "model = \"metal-cvt\"\n[design]\ncases = { csv = \"cases.csv\" }\n[objectives]\ntorque_Nm = \"min\"\nstrength_MPa = \"max\"\n\
                     [report]\nfront_budget = 1000\n";

#[test]
fn a_shard_may_have_a_larger_front_than_the_whole() {
    let folder = folder_with("s.toml", STUDY);
    rows(folder.path(), 20_000);
    for engine in ["cpu", "gpu"] {
        ask(folder.path(), &format!("sweep s.toml --out whole-{engine} --engine {engine}")).text();
        for number in 1..=2 {
            ask(folder.path(), &format!("sweep s.toml --shard {number}/2 --out part-{number} --engine {engine} --force")).text();
        }
        ask(folder.path(), &format!("merge part-1 part-2 --out merged-{engine}")).text();
        let [whole, merged] = ["whole", "merged"].map(|name| folder.path().join(format!("{name}-{engine}")));
        assert_eq!(json_of(&whole.join("summary.json"))["front"], 1);
        assert_eq!(same_result(&files(&whole), &files(&merged)), Ok(()), "{engine}");
    }
}

#[test]
fn a_front_beyond_the_budget_is_kept_and_a_larger_budget_goes_on() {
    let text = changed(
        STUDY,
        &[("front_budget = 1000", "front_budget = 500"), ("strength_MPa = \"max\"", "strength_MPa = \"max\"\nfriction = \"max\"")],
    );
    let text = changed(&text, &[("[objectives]", "friction = { from = 0.05, to = 0.09, count = 600 }\n[objectives]")]);
    // The better the friction, the worse the torque: no design beats another.
    let folder = folder_with("s.toml", &text);
    let lines: String = (0..600).map(|i| format!("{},{}\n", i + 10, i + 10)).collect();
    write(folder.path(), "cases.csv", &format!("torque_Nm,strength_MPa\n{lines}"));
    for option in ["", "--shard 1/1"] {
        let out = if option.is_empty() { "out" } else { "shard" };
        let line = format!("sweep s.toml --out {out} {option}");
        if option.is_empty() {
            let err = ask(folder.path(), &line).refusal(1);
            assert!(err.contains("the Pareto front has 600 points, more than front_budget = 500 allows"), "{err}");
            assert!(err.contains("with a larger front_budget go on with: beltspace sweep s.toml --out out --resume"), "{err}");
        } else {
            // The whole study in one shard: the size of its front is known when it is merged.
            ask(folder.path(), &line).refusal(1);
        }
    }
    write(folder.path(), "s.toml", &changed(&text, &[("front_budget = 500", "front_budget = 600")]));
    for out in ["out", "shard"] {
        let option = if out == "out" { "" } else { "--shard 1/1" };
        ask(folder.path(), &format!("sweep s.toml --out {out} {option} --resume")).text();
    }
    assert_eq!(json_of(&folder.path().join("out/summary.json"))["front"], 600);
    assert_eq!(json_of(&folder.path().join("out/run.json"))["designs"], 0, "nothing is judged again");
    ask(folder.path(), "merge shard --out merged").text();
    assert_eq!(same_result(&files(&folder.path().join("out")), &files(&folder.path().join("merged"))), Ok(()));
}

#[test]
fn a_front_that_outgrows_its_memory_says_so_and_can_go_on() {
    let text = changed(STUDY, &[("strength_MPa = \"max\"", "strength_MPa = \"max\"\nfriction = \"max\"\nband_width_mm = \"min\"")]);
    let folder = folder_with("s.toml", &text);
    // Four objectives: 240 bytes a point with its copies, some 4 000 points a megabyte.
    let lines: String = (0..30_000).map(|i| format!("{},{}\n", i + 10, i + 10)).collect();
    write(folder.path(), "cases.csv", &format!("torque_Nm,strength_MPa\n{lines}"));
    let err = ask(folder.path(), "sweep s.toml --out out --front-memory 1 --engine cpu --threads 1").refusal(1);
    assert!(err.contains("points, more than fit into 1 MB") && err.contains("--resume --front-memory 2"), "{err}");
    assert!(!err.contains("front_budget"), "{err}");
    let done = json_of(&folder.path().join("out/checkpoint/manifest.json"))["manifest"]["done"][0]["end"].as_u64();
    assert!(done > Some(0), "what was judged is kept");
    let text = changed(&text, &[("front_budget = 1000", "front_budget = 100000")]);
    write(folder.path(), "s.toml", &text);
    ask(folder.path(), "sweep s.toml --out out --resume").text();
    ask(folder.path(), "sweep s.toml --out plain").text();
    let [out, plain] = ["out", "plain"].map(|name| files(&folder.path().join(name)));
    assert_eq!(same_result(&out, &plain), Ok(()));
    assert_eq!(json_of(&folder.path().join("out/run.json"))["origin"], "resumed from a checkpoint");
}
