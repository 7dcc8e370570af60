//! `sweep --method`: what bounds refuse, what `auto` says, and that the result files do not depend on the method.

use super::{Files, SMALL, ask, changed, files, folder_with, json_of, larger, same_result, write};
use std::path::Path;
#[cfg(unix)]
use std::process::Command;
use std::sync::OnceLock;
#[cfg(unix)]
use std::time::{Duration, Instant};

/// It with a sample of the feasible designs.
fn drawn() -> String {
    changed(SMALL, &[("[report]\n", "[report]\nsample = 60\n")])
}

/// The files of one undisturbed run of it, design by design.
fn one_by_one() -> &'static Files {
    static FILES: OnceLock<Files> = OnceLock::new();
    FILES.get_or_init(|| {
        let folder = folder_with("grid.toml", &drawn());
        ask(folder.path(), "sweep grid.toml --method exhaustive --out out").text();
        let run = json_of(&folder.path().join("out/run.json"));
        assert_eq!((&run["method"], &run["method_chosen"]), (&"exhaustive".into(), &"asked for".into()));
        assert!(run["certificate"].is_null(), "{run}");
        files(&folder.path().join("out"))
    })
}

#[test]
fn bounds_refuse_what_asks_for_every_design_and_say_what_to_do() {
    let plain = &SMALL[..SMALL.find("maps = ").expect("it has maps")];
    let report = |line: &str| changed(plain, &[("[report]\n", &format!("[report]\n{line}\n"))]);
    let sampled = |line: &str| changed(plain, &[("[design]\n", &format!("[sample]\n{line}\n[design]\n"))]);
    let cases = "cases = [{ band_count = 8, traction = 0.3 }, { band_count = 9, traction = 0.4 }]";
    let cases = changed(
        plain,
        &[("band_count        = { from = 6, to = 14 }", cases), ("traction          = { from = 0.30, to = 0.50, count = 5 }\n", "")],
    );
    let folder = folder_with("small.toml", SMALL);
    let pulley = ask(folder.path(), "models pulley --study").text();
    let refused = [
        (
            "sample in [report] takes the first feasible designs of a shuffled order, and bounds look up the places of 10000000000 designs at most",
            changed(&report("sample = 100"), &[("to = 30, count = 13", "to = 30, count = 13_000"), ("count = 21 }", "count = 21_000 }")]),
        ),
        ("variants in [report]", changed(&report("variants = true"), &[("to = 0.50, count = 5", "to = 0.50, count = 2")])),
        (
            "a map in [report] has more than 1048576 cells",
            changed(
                &report("maps = [{ x = \"band_thickness_mm\", y = \"groove_angle_deg\", best = \"share\" }]"),
                &[("to = 30, count = 13", "to = 30, count = 1025"), ("to = 0.30, count = 21", "to = 0.30, count = 1024")],
            ),
        ),
        ("groove_angle_deg has 2000000 levels, and bounds take 1048576 at most;", changed(plain, &[("count = 13", "count = 2000000")])),
        ("[sample]", sampled("method = \"sobol\"\ncount = 1000")),
        ("cases in [design]", cases),
        ("pulley is no formula", pulley),
    ];
    for (thing, study) in refused {
        write(folder.path(), "refused.toml", &study);
        let before = files(folder.path());
        let err = ask(folder.path(), "sweep refused.toml --method bounds --out out").refusal(2);
        assert!(err.contains("--method bounds cannot serve this study") && err.contains(thing), "{thing}: {err}");
        assert!(err.contains("use --method exhaustive, or change the study"), "{thing}: {err}");
        assert!(!err.contains("panicked"), "{err}");
        assert_eq!(files(folder.path()), before, "{thing}: a refusal writes nothing");
    }
    write(folder.path(), "grid.toml", SMALL);
    for (option, line) in [("--engine gpu", "--engine gpu"), ("--adapter llvmpipe", "--adapter llvmpipe")] {
        let err = ask(folder.path(), &format!("sweep grid.toml --method bounds {line} --out out")).refusal(2);
        assert!(err.contains("on the CPU") && err.contains(option) && err.contains("leave one of them out"), "{err}");
    }
    let err = ask(folder.path(), "sweep grid.toml --method guesses").refusal(2);
    assert!(err.contains("invalid value 'guesses' for '--method <METHOD>'"), "{err}");
    assert!(!folder.path().join("out").exists());
}

/// The counts of a certificate in `run.json`.
fn assert_certified(run: &serde_json::Value) {
    let number = |value: &serde_json::Value| value.as_u64().unwrap_or_else(|| panic!("{value} is no count in {run}"));
    let sum = |of: &serde_json::Value, rules: &[&str]| rules.iter().map(|rule| number(&of[*rule])).sum::<u64>();
    let (certificate, designs) = (&run["certificate"], number(&run["designs"]));
    let count = &certificate["count"];
    let rules = ["in_infeasible_boxes", "in_feasible_boxes", "in_products", "in_pairs_of_lists", "judged_in_f64"];
    assert_eq!((number(&count["designs"]), sum(count, &rules)), (designs, designs), "{run}");
    let searches = certificate["searches"].as_array().expect("there are searches");
    let names: Vec<_> = searches.iter().map(|it| it["for"].as_str().expect("they are named")).collect();
    let expected = [
        "front",
        "top",
        "least axial_force_N",
        "largest axial_force_N",
        "least stress_margin",
        "largest stress_margin",
        "least band_count",
        "largest band_count",
        "map of axial_force_N",
        "sample",
    ];
    assert_eq!(names, expected);
    let tallies = certificate["tallies"].as_array().expect("there are tallies");
    assert_eq!(
        tallies.iter().map(|it| it["for"].as_str()).collect::<Vec<_>>(),
        [Some("histogram of axial_force_N"), Some("map of feasible_share")]
    );
    for it in tallies {
        assert_eq!((number(&it["designs"]), sum(it, &rules)), (designs, designs), "{it}");
    }
    for it in searches {
        let settled = sum(it, &["in_infeasible_boxes", "in_beaten_boxes", "in_pairs_of_lists", "judged_in_f64"]);
        assert_eq!((number(&it["designs"]), settled), (designs, designs), "{it}");
    }
    for what in ["boxes", "evaluations"] {
        let all = number(&count[what]) + searches.iter().chain(tallies).map(|it| number(&it[what])).sum::<u64>();
        assert_eq!(number(&certificate[what]), all, "{what}");
    }
    assert!(number(&certificate["compared_one_by_one"]) > 0, "{run}");
}

#[test]
fn the_files_are_the_same_and_the_record_says_how_they_came_about() {
    let folder = folder_with("grid.toml", &drawn());
    for options in ["--threads 1", "--threads 3 --engine cpu", "--threads 2 --tile 7"] {
        ask(folder.path(), &format!("sweep grid.toml --method bounds --out out --force {options}")).text();
        let out = folder.path().join("out");
        assert_eq!(same_result(one_by_one(), &files(&out)), Ok(()), "{options}");
        let run = json_of(&out.join("run.json"));
        assert_eq!((&run["method"], &run["method_chosen"], &run["engine"]), (&"bounds".into(), &"asked for".into(), &"cpu".into()));
        assert_certified(&run);
    }
}

#[test]
fn auto_says_why() {
    let folder = folder_with("grid.toml", &drawn());
    write(folder.path(), "all.toml", &changed(SMALL, &[("[report]\n", "[report]\nfeasible = true\n")]));
    let chosen = |line: &str| {
        ask(folder.path(), &format!("sweep {line} --out out --force")).text();
        let run = json_of(&folder.path().join("out/run.json"));
        let word = |name: &str| run[name].as_str().expect("it is said").to_owned();
        assert_eq!(run["certificate"].is_null(), run["method"] == "exhaustive", "{run}");
        (word("method"), word("method_chosen"))
    };
    let small = ("exhaustive".to_owned(), "the study is small enough to judge every design".to_owned());
    assert_eq!(chosen("grid.toml"), small);
    assert_eq!(chosen("grid.toml --method auto"), small);
    let (method, why) = chosen("all.toml");
    assert!(method == "exhaustive" && why.starts_with("bounds cannot serve the study: feasible in [report]"), "{why}");
}

/// A drive of which bounds settle almost nothing, with this many friction values; judging it takes a second or two.
fn slow_by_bounds(frictions: u32) -> String {
    format!(
        r#"model = "timing-belt"
preset = "ohc-driven"
[design]
space_half_angle_deg = {{ from = 4.2, to = 6.3, count = 23 }}
friction = {{ from = 0.332, to = 0.436, count = {frictions} }}
pulley_speed_rpm = {{ from = 9030, to = 8510, count = 60 }}
[uncertainty]
tooth_compliance_um_per_N = [7.57, 7.2, 6.96]
teeth_in_mesh = {{ from = 22, to = 23 }}
[objectives]
least_tooth_load_N = {{ goal = "min", resolution = 0.05 }}
peak_tooth_load_N = {{ goal = "min", resolution = 0.02 }}
"#
    )
}

#[test]
fn auto_begins_by_bounds_and_leaves_them_where_they_do_not_pay() {
    // 1e12 designs, of which bounds find the best in a moment.
    let fine = include_str!("../../../studies/metal-grid.toml").replace("count = 37", "count = 560");
    let (designs, _) = fine.split_once("[constraints]").expect("it has constraints");
    let folder = folder_with("grid.toml", &format!("{designs}[objectives]\ntorque_capacity_Nm = \"max\"\n"));
    let run_of = |line: &str| {
        let answer = ask(folder.path(), &format!("sweep {line} --no-report --engine cpu --out out --force"));
        (answer.text().to_owned(), json_of(&folder.path().join("out/run.json")))
    };
    let (_, run) = run_of("grid.toml");
    let why = run["method_chosen"].as_str().expect("it is said");
    assert!(run["method"] == "bounds" && why.starts_with("judging every design would take about "), "{run}");
    assert!(run["bounds_left"].is_null() && run["certificate"].is_object(), "{run}");
    let check = |file: &str| ask(folder.path(), &format!("check {file}")).text().to_owned();
    assert!(
        check("grid.toml").contains("\nmethod         bounds; if they are not faster, every design after at most about "),
        "{}",
        check("grid.toml")
    );

    // As many friction values as take a little more than a second on one thread of this machine.
    let mut frictions = 20;
    let began = loop {
        write(folder.path(), "slow.toml", &slow_by_bounds(frictions));
        let (text, run) = run_of("slow.toml --threads 1");
        if run["method"] != "exhaustive" {
            break (text, run);
        }
        assert_eq!(run["method_chosen"], "the study is small enough to judge every design", "{run}");
        assert!(frictions < 100_000, "judging never takes a second: {run}");
        frictions *= 3;
    };
    let (text, run) = began;
    let (left, why) = (&run["bounds_left"], run["method_chosen"].as_str().expect("it is said"));
    assert!(run["method"] == "bounds, then exhaustive" && run["certificate"].is_null(), "{run}");
    assert!(why.contains(" bounds had done ") && why.contains("judging the rest one by one"), "{why}");
    let counted = left["designs_counted"].as_u64().expect("it is counted");
    assert_eq!(Some(counted + left["designs_judged"].as_u64().expect("it is counted")), run["designs"].as_u64(), "{run}");
    assert!(text.contains("\nbounds    given up after ") && text.contains(" were judged one by one"), "{text}");
    let found = files(&folder.path().join("out"));
    run_of("slow.toml --method exhaustive");
    assert_eq!(same_result(&files(&folder.path().join("out")), &found), Ok(()));
    write(folder.path(), "slow.toml", &slow_by_bounds(2));
    let small = "\nmethod         every design: the study is small enough to judge every design";
    assert!(check("slow.toml").contains(small), "{}", check("slow.toml"));
}

#[test]
fn shards_by_either_method_merge_to_the_same_files() {
    let folder = folder_with("grid.toml", &drawn());
    for methods in [["bounds"; 3], ["bounds", "exhaustive", "bounds"]] {
        let mut parts = Vec::new();
        for (at, method) in methods.iter().enumerate() {
            let part = format!("part-{}", at + 1);
            let line = format!("sweep grid.toml --shard {}/3 --out {part} --method {method} --threads {} --force", at + 1, 1 + at % 2);
            ask(folder.path(), &line).text();
            assert!(!folder.path().join(&part).join("summary.json").exists(), "a part is no result");
            parts.push(part);
        }
        parts.reverse();
        ask(folder.path(), &format!("merge {} --out whole --force", parts.join(" "))).text();
        assert_eq!(same_result(one_by_one(), &files(&folder.path().join("whole"))), Ok(()), "{methods:?}");
    }
    // A shard that one method has finished is finished for the other too.
    for method in ["bounds", "exhaustive"] {
        ask(folder.path(), &format!("sweep grid.toml --shard 1/3 --out part-1 --resume --method {method}")).text();
    }
}

/// Ctrl-C while boxes are bounded: the other method can continue from the checkpoint too.
#[cfg(unix)]
#[test]
fn a_run_by_bounds_that_is_interrupted_goes_on_design_by_design() {
    let folder = folder_with("large.toml", &larger(41));
    ask(folder.path(), "sweep large.toml --method exhaustive --out plain").text();
    let manifest = folder.path().join("out/checkpoint/manifest.json");
    // Before the boxes comes a sample, of which nothing is kept: then once more, and later.
    let mut patience = Duration::from_millis(200);
    loop {
        interrupt(folder.path(), &manifest, patience);
        if json_of(&manifest)["manifest"]["state"][0].is_string() {
            break;
        }
        patience += patience / 2;
    }
    ask(folder.path(), "sweep large.toml --method exhaustive --out out --resume").text();
    let run = json_of(&folder.path().join("out/run.json"));
    assert_eq!(run["method"], "exhaustive");
    assert_eq!(same_result(&files(&folder.path().join("plain")), &files(&folder.path().join("out"))), Ok(()));
}

/// Begins a run by bounds and interrupts it so long after its checkpoint is there.
#[cfg(unix)]
fn interrupt(folder: &Path, manifest: &Path, patience: Duration) {
    let words = ["sweep", "large.toml", "--method", "bounds", "--threads", "1", "--out", "out", "--force"];
    let _ = std::fs::remove_dir_all(folder.join("out"));
    let mut child = super::program(folder, &words).spawn().expect("the program starts");
    let begun = Instant::now();
    while !manifest.exists() && begun.elapsed() < Duration::from_secs(60) {
        assert!(child.try_wait().expect("it can be asked").is_none(), "it ended before it could be interrupted");
        std::thread::sleep(Duration::from_millis(1));
    }
    std::thread::sleep(patience);
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill can be run");
    assert!(sent.success(), "it ended before it could be interrupted");
    let err = super::Answer::from(child.wait_with_output().expect("the output can be read")).refusal(1);
    assert!(err.contains("stopped") && err.contains("--resume") && !folder.join("out/summary.json").exists(), "{err}");
}
