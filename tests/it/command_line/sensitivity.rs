//! `sensitivity` in `[report]`: the same files as of the command, whoever sweeps, and what the page and the terminal say of it.

use super::{SMALL, ask, changed, files, folder_with, json_of, read, same_result, write};

/// Some drives differ by friction and by the thickness of their bands.
const DRAWN: &str = r#"model = "metal-cvt"
title = "Drawn"
[design]
groove_angle_deg = [18, 22, 30]
[operation]
torque_Nm = [50, 150]
[uncertainty]
friction          = { normal = { mean = 0.08, sd = 0.006 }, from = 0.05, to = 0.11 }
band_thickness_mm = { times = { uniform = [0.97, 1.03] } }
[probability]
draws   = 256
confirm = 256
[constraints]
stress_margin = { min = 0.3 }
yield         = { min = 0.1 }
[objectives]
axial_force_N = { goal = "min", over_draws = "mean" }
[report]
sensitivity = { draws = 256 }
"#;

#[test]
fn a_result_has_the_files_that_the_command_writes_for_its_knee() {
    let folder = folder_with("study.toml", DRAWN);
    let page = ask(folder.path(), "sweep study.toml --out out").text();
    assert!(page.contains("what matters of what is uncertain about design 1, by total indices: sensitivity.csv"), "{page}");
    assert_eq!(json_of(&folder.path().join("out/summary.json"))["sensitivity"]["design"], 1);
    ask(folder.path(), "sensitivity study.toml --design 1 --draws 256 --out alone").text();
    let (result, alone) = (files(&folder.path().join("out")), files(&folder.path().join("alone")));
    assert!(alone.len() >= 6, "{:?}", alone.keys());
    for (name, bytes) in &alone {
        assert_eq!(result.get(name), Some(bytes), "{name}");
    }
    // Most of a force's scatter comes from friction, and the summary says so.
    let told = json_of(&folder.path().join("out/summary.json"))["sensitivity"].clone();
    let force = told["quantities"].as_array().and_then(|all| all.iter().find(|it| it["name"] == "axial_force_N")).expect("it is told");
    assert_eq!(force["largest"][0]["name"], "friction", "{told}");
    let page = read(&folder.path().join("out/report.html"));
    assert!(page.contains("Which input matters for design 1") && page.contains("sensitivity-axial_force_N"));
    // The files of the result are its own.
    let refused = ask(folder.path(), "sensitivity study.toml --design 1 --out out").refusal(2);
    assert!(refused.contains("belongs to the result there, which [report] asked for it; name another --out"), "{refused}");
}

#[test]
fn shards_and_other_engines_write_the_same() {
    let folder = folder_with("study.toml", DRAWN);
    ask(folder.path(), "sweep study.toml --out whole").text();
    for shard in 1..=2 {
        ask(folder.path(), &format!("sweep study.toml --out parts/{shard} --shard {shard}/2")).text();
        assert!(!folder.path().join(format!("parts/{shard}/sensitivity.csv")).exists(), "a shard has no knee");
    }
    ask(folder.path(), "merge parts/1 parts/2 --out merged").text();
    ask(folder.path(), "sweep study.toml --out one --threads 1 --tile 64").text();
    let whole = files(&folder.path().join("whole"));
    for other in ["merged", "one"] {
        assert_eq!(same_result(&whole, &files(&folder.path().join(other))), Ok(()), "{other}");
    }
}

#[test]
fn over_the_design_it_tells_which_choice_matters() {
    let study = changed(SMALL, &[("columns = [", "sensitivity = { over = \"design\", of = [\"axial_force_N\"] }\ncolumns = [")]);
    let folder = folder_with("study.toml", &study);
    let page = ask(folder.path(), "sweep study.toml --out out").text();
    assert!(page.contains("what matters over the design, by total indices: sensitivity.csv"), "{page}");
    ask(folder.path(), "sensitivity study.toml --over design --of axial_force_N --out alone").text();
    for (name, bytes) in files(&folder.path().join("alone")) {
        assert_eq!(files(&folder.path().join("out")).get(&name), Some(&bytes), "{name}");
    }
}

#[test]
fn without_a_feasible_design_the_result_says_why_there_is_none() {
    let folder = folder_with("study.toml", &changed(DRAWN, &[("min = 0.3", "min = 1.3")]));
    let page = ask(folder.path(), "sweep study.toml --out out").text();
    let why = "no design is feasible, so there is none whose uncertainty could be looked at";
    assert!(page.contains(&format!("what matters: {why}")), "{page}");
    assert_eq!(json_of(&folder.path().join("out/summary.json"))["sensitivity"]["none"], why);
    assert!(!folder.path().join("out/sensitivity.csv").exists());
    assert!(read(&folder.path().join("out/report.html")).contains(why));
}

#[test]
fn a_summary_that_tells_of_other_inputs_is_refused() {
    let folder = folder_with("study.toml", DRAWN);
    ask(folder.path(), "sweep study.toml --out out --no-report").text();
    let path = folder.path().join("out/summary.json");
    write(folder.path(), "out/summary.json", &read(&path).replace("\"name\": \"friction\"", "\"name\": \"weather\""));
    let refused = ask(folder.path(), "report out").refusal(2);
    assert!(refused.contains("its \"sensitivity\" does not belong to the study"), "{refused}");
}

#[test]
fn wrong_requests_are_named_with_their_remedy() {
    let line = "sensitivity = { draws = 256 }";
    let cases = [
        (
            line,
            "sensitivity = 5",
            "19:15: sensitivity: found the number 5, wanted true, false or a table, such as sensitivity = true or { over = \"design\" }",
        ),
        (line, "sensitivity = { over = \"time\" }", "19:24: sensitivity: unknown over \"time\"; write \"design\" or \"uncertainty\""),
        (
            line,
            "sensitivity = { draws = 100 }",
            "19:15: sensitivity: sobol: 100 draws cannot be divided into 16 replicates of a power of two each; take 128 draws",
        ),
        (line, "sensitivity = { draws = 8 }", "19:25: sensitivity: 8 is out of range; draws must be a whole number from 16 to 16777216"),
        (
            line,
            "sensitivity = { of = [] }",
            "19:22: sensitivity: of: found an empty list, wanted a list of names such as [\"holds\"]; drop it for all",
        ),
        (
            line,
            "sensitivity = { of = [\"weather\"] }",
            "19:23: sensitivity: there is no quantity \"weather\"; the study asks for stress_margin, axial_force_N, holds",
        ),
        (line, "sensitivity = { of = [\"holds\", \"holds\"] }", "19:32: sensitivity: \"holds\" is listed twice; drop one"),
        ("[18, 22, 30]", "[22]", "nothing varies over the design; give an axis of [design] more than one level"),
    ];
    for (from, to, expected) in cases {
        let mut study = changed(DRAWN, &[(from, to)]);
        if from != line {
            study = changed(&study, &[(line, "sensitivity = { over = \"design\" }")]);
        }
        let folder = folder_with("study.toml", &study);
        let refused = ask(folder.path(), "check study.toml").refusal(2);
        assert!(refused.trim_end().ends_with(expected), "{to}: {refused}");
    }
    // What varies is asked of the whole study.
    let certain = "model = \"metal-cvt\"\n[design]\nband_count = [8, 9]\n[objectives]\naxial_force_N = \"min\"\n[report]\nsensitivity = { over = \"uncertainty\" }\n";
    let refused = ask(folder_with("study.toml", certain).path(), "check study.toml").refusal(2);
    assert!(
        refused.contains("nothing is uncertain; give inputs levels or distributions in [uncertainty], or write over = \"design\""),
        "{refused}"
    );
}
