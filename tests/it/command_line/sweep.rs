//! `check`, `sweep` and the result directory.

use super::{Csv, SMALL, ask, changed, files, folder_with, json_of, program, read, same_result, small_result, write};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::RowAccessor;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Stdio;

/// Every cell is empty, a word, or the shortest text of a finite number.
fn assert_numbers_are_plain(folder: &Path) {
    let mut seen = 0;
    for name in files(folder).keys().filter(|name| name.ends_with(".csv")) {
        for cell in Csv::read(&folder.join(name)).rows.iter().flatten().filter(|cell| !cell.is_empty() && *cell != "limit") {
            let value: f64 = cell.parse().unwrap_or_else(|_| panic!("{name} has the cell \"{cell}\""));
            let digits = |text: &str| text.split('e').next().unwrap_or("").replace(['.', '-'], "").trim_matches('0').to_owned();
            assert!(value.is_finite() && cell != "-0" && digits(cell) == digits(&format!("{value:e}")), "{name} has the cell \"{cell}\"");
            seen += 1;
        }
    }
    assert!(seen > 0, "there were no numbers to look at");
}

#[test]
fn check_says_how_large_a_study_is_and_what_is_odd() {
    let odd = changed(SMALL, &[("strength_MPa = 800", "band_width_mm = 40"), ("[operation]", "strength_MPa = [800, 900]\n[operation]")]);
    let odd = changed(&odd, &[("stress_margin = { max = 0.95, min = 0 }\n", ""), ("stress_margin = \"max\"\n", "")]);
    let folder = folder_with("odd.toml", &odd);
    let text = ask(folder.path(), "check odd.toml").text();
    for expected in ["designs", "24 570", "scenarios", "12", "expected time", "memory", "groove_angle_deg", "18 to 30"] {
        assert!(text.contains(expected), "{expected} is missing in\n{text}");
    }
    assert!(text.contains("warning: strength_MPa changes nothing that the study asks for"), "{text}");
    assert!(text.contains("warning: band_width_mm = 40 lies outside 5 to 20"), "{text}");
    assert!(!folder.path().join("results").exists(), "a dry run writes nothing");
    let free = changed(SMALL, &[("slip_margin   = { min = 0 }\n", ""), ("stress_margin = { max = 0.95, min = 0 }\n", "")]);
    write(folder.path(), "free.toml", &free);
    let text = ask(folder.path(), "check free.toml").text();
    assert!(text.contains("warning: there are no constraints"), "{text}");
    write(folder.path(), "good.toml", SMALL);
    assert!(!ask(folder.path(), "check good.toml").text().contains("warning:"));
}

#[test]
fn steps_that_end_before_the_range_are_told_on_standard_error() {
    let study = |range: &str| changed(SMALL, &[("{ from = 0.10, to = 0.30, count = 21 }", range)]);
    let told = "note: band_thickness_mm: steps of 0.07 from 0.1 end at 0.24, before to = 0.3; use a step that divides the range, \
                count in place of step, or to = 0.24\n";
    for (range, note) in [
        ("{ from = 0.10, to = 0.30, step = 0.07 }", told),
        ("{ from = 0.10, to = 0.24, step = 0.07 }", ""),
        ("{ from = 0.10, to = 0.30, step = 0.005 }", ""),
        ("{ from = 0.10, to = 0.1000003, step = 0.0000001 }", ""),
        (
            "{ from = 0.10, to = 0.30, step = 0.2, spacing = \"log\" }",
            "note: band_thickness_mm: decades of 0.2 from 0.1 end at 0.251189, before to = 0.3; use a step that divides the decades of \
             the range, count in place of step, or to = 0.251189\n",
        ),
    ] {
        let folder = folder_with("small.toml", &study(range));
        for line in ["check small.toml", "sweep small.toml --no-report --out out"] {
            let answer = ask(folder.path(), line);
            assert_eq!((answer.code, answer.err.as_str()), (Some(0), note), "{line}, {range}");
        }
        let out = files(&folder.path().join("out"));
        for (name, bytes) in out {
            assert!(!String::from_utf8_lossy(&bytes.unwrap_or_default()).contains("before to ="), "{name}");
        }
    }
}

#[test]
fn a_run_of_days_is_warned_of_and_begins() {
    // Bounds, which nobody knows beforehand how long they take, cannot serve single designs.
    let cases = "cases = [{ traction = 0.3, band_width_mm = 9 }, { traction = 0.4, band_width_mm = 10 }]";
    let finer = [
        ("count = 13", "count = 1300000"),
        ("count = 21", "count = 2100000"),
        ("traction          = { from = 0.30, to = 0.50, count = 5 }", cases),
    ];
    let study = changed(&SMALL[..SMALL.find("maps = ").expect("it has maps")], &finer);
    let folder = folder_with("small.toml", &study);
    let begins = "warning: judging all 49 140 000 000 000 designs takes about ";
    let checked = ask(folder.path(), "check small.toml");
    let warned = |text: &str| text.starts_with(begins) && text.contains(" on ") && text.contains("; larger steps and narrower axes make");
    assert!(checked.code == Some(0) && warned(&checked.err), "{}", checked.err);
    let words = ["sweep", "small.toml", "--method", "exhaustive", "--no-report"];
    let mut sweep = program(folder.path(), &words).stderr(Stdio::piped()).stdout(Stdio::null()).spawn().expect("it starts");
    let mut line = String::new();
    BufReader::new(sweep.stderr.take().expect("it is piped")).read_line(&mut line).expect("it is text");
    assert!(sweep.try_wait().expect("it is a child").is_none(), "the sweep goes on");
    sweep.kill().and_then(|()| sweep.wait()).expect("it can be ended");
    assert!(warned(&line), "{line}");
    let short = folder_with("small.toml", SMALL);
    for line in ["check small.toml", "sweep small.toml --no-report"] {
        assert_eq!(ask(short.path(), line).err, "", "{line}");
    }
}

#[test]
fn what_there_is_one_of_is_said_so() {
    let one = "model = \"metal-cvt\"\n[design]\nband_count = [9]\nstrength_MPa = [800]\n[operation]\nratio = [1, 2]\n[fixed]\n\
               traction = 0.4\n[constraints]\nslip_margin = { min = 0 }\n[objectives]\naxial_force_N = \"min\"\n";
    let folder = folder_with("one.toml", one);
    for (line, expected) in [
        ("check one.toml", "about 1 design on the front"),
        ("check one.toml", "warning: strength_MPa changes nothing that the study asks for\n"),
        ("sweep one.toml --threads 1 --no-report", "front     1 design certified"),
        ("eval one.toml --design 0", "design 0, worst of 2 scenarios"),
        ("sweep one.toml --shard 1/1 --out shard", "1 design, in shard"),
    ] {
        let text = ask(folder.path(), line).text();
        assert!(text.contains(expected), "{line}: {text}");
        let plural = |name: &str| text.contains(&format!(" 1 {name}s"));
        assert!(!["design", "scenario", "thread", "level", "draw"].into_iter().any(plural), "{line}: {text}");
    }
}

#[test]
fn a_result_has_all_its_files_and_columns() {
    let folder = folder_with("small.toml", SMALL);
    let answer = ask(folder.path(), "sweep small.toml");
    assert_eq!(answer.err, "", "no progress where there is no terminal");
    let text = answer.text();
    let out = folder.path().join("results/small");
    assert!(text.contains("Small") && text.contains("what limits feasibility") && text.contains("knee"), "{text}");
    let names = "front.csv front.parquet front.svg histogram-axial_force_N.csv histogram-axial_force_N.svg map-axial_force_N.csv \
                 map-axial_force_N.svg map-feasible_share.csv map-feasible_share.svg report.html run.json scenarios.csv study.json study.toml \
                 summary.json top.csv";
    assert_eq!(files(&out).keys().map(String::as_str).collect::<Vec<_>>(), names.split_whitespace().collect::<Vec<_>>());
    assert_eq!(read(&out.join("study.toml")), SMALL);
    assert_numbers_are_plain(&out);

    let front = Csv::read(&out.join("front.csv"));
    let inputs = ["design_index", "groove_angle_deg", "band_thickness_mm", "band_count", "traction"].map(str::to_owned);
    // The objective band_count has its column among the design inputs.
    let judged = ["axial_force_N", "stress_margin", "slip_margin", "stress_margin_constrained", "max_stress_MPa"];
    let pairs = judged.iter().flat_map(|name| [(*name).to_owned(), format!("{name}_scenario")]);
    let header: Vec<_> = inputs.into_iter().chain(pairs).collect();
    assert_eq!(front.header, header);
    assert_eq!(Csv::read(&out.join("top.csv")).header, header);
    let parquet = std::fs::File::open(out.join("front.parquet")).expect("it is there");
    let parquet = SerializedFileReader::new(parquet).expect("it can be read");
    let fields = parquet.metadata().file_metadata().schema().get_fields();
    assert_eq!(fields.iter().map(|it| it.name().to_owned()).collect::<Vec<_>>(), header);
    let about = parquet.metadata().file_metadata().key_value_metadata().expect("columns are described");
    let said = |key: &str| about.iter().find(|it| it.key == key).and_then(|it| it.value.clone()).expect("it is described");
    assert_eq!([said("band_count.role"), said("band_count.direction")], ["design, objective", "min"]);

    // Objectives as "less is better": sorted, best first, then by index, and no design is dominated.
    let index = front.numbers("design_index");
    let minus: Vec<_> = front.numbers("stress_margin").iter().map(|it| -it).collect();
    let (force, bands) = (front.numbers("axial_force_N"), front.numbers("band_count"));
    let points: Vec<_> = (0..index.len()).map(|row| [force[row], minus[row], bands[row], index[row]]).collect();
    assert!(points.windows(2).all(|pair| pair[0] < pair[1]), "the front is not in order");
    let beats = |a: &[f64; 4], b: &[f64; 4]| a[..3] != b[..3] && a[..3].iter().zip(&b[..3]).all(|(a, b)| a <= b);
    assert!(!points.iter().any(|a| points.iter().any(|b| beats(a, b))), "a design of the front is dominated by another");

    let top = Csv::read(&out.join("top.csv"));
    assert!(top.rows.len() == 20 && top.numbers("axial_force_N").is_sorted());
    assert_eq!(top.numbers("axial_force_N")[0], force[0]);
    let scenarios = Csv::read(&out.join("scenarios.csv"));
    assert_eq!(scenarios.header, ["scenario", "ratio", "torque_Nm", "friction"]);
    assert_eq!(scenarios.rows.len(), 12);
    assert_eq!(scenarios.rows[1], ["1", "0.5", "50", "0.095"], "the last axis runs fastest");
}

#[test]
fn the_summary_agrees_with_the_tables() {
    let folder = folder_with("small.toml", SMALL);
    ask(folder.path(), "sweep small.toml --out small").text();
    let at = |name: &str| folder.path().join("small").join(name);
    let summary = json_of(&at("summary.json"));
    let keys: Vec<_> = summary.as_object().expect("an object").keys().map(String::as_str).collect();
    let expected = "version model title study_hash designs scenarios feasible front ideal knee extremes tally";
    assert_eq!(keys, expected.split_whitespace().collect::<Vec<_>>());
    let count = |name: &str| summary[name].as_u64().expect("a count");
    assert_eq!((count("designs"), count("scenarios")), (13 * 21 * 9 * 5, 12));
    let front = Csv::read(&at("front.csv"));
    assert_eq!(count("front"), front.rows.len() as u64);
    let bins = Csv::read(&at("histogram-axial_force_N.csv"));
    assert_eq!((bins.header.clone(), bins.rows.len()), (["from", "to", "designs"].map(str::to_owned).to_vec(), 42));
    assert_eq!(bins.numbers("designs").iter().sum::<f64>(), count("feasible") as f64);
    let share = Csv::read(&at("map-feasible_share.csv"));
    assert_eq!(share.rows.len(), 21 * 9);
    let feasible: f64 = share.numbers("feasible_share").iter().map(|share| share * (13 * 5) as f64).sum();
    assert!((feasible - count("feasible") as f64).abs() < 1e-6, "{feasible}");
    for (name, goal) in [("axial_force_N", 1.0), ("stress_margin", -1.0), ("band_count", 1.0)] {
        let best = front.numbers(name).into_iter().map(|it| it * goal).fold(f64::INFINITY, f64::min) * goal;
        assert_eq!(summary["ideal"][name].as_f64(), Some(best), "{name}");
        let end = if goal > 0.0 { "least" } else { "largest" };
        assert_eq!(summary["extremes"][name][end]["value"].as_f64(), Some(best), "{name}: what is best of all is on the front");
    }
    let knee = summary["knee"]["design_index"].to_string();
    let row = front.column("design_index").iter().position(|index| *index == knee).expect("the knee is on the front");
    assert_eq!(summary["knee"]["objectives"]["axial_force_N"].as_f64(), Some(front.numbers("axial_force_N")[row]));
    assert_eq!(summary["tally"]["sampled"], 13 * 21 * 9 * 5, "so few designs are all sampled");
    assert_eq!(summary["tally"]["feasible"], summary["feasible"]);
    let study = json_of(&at("study.json"));
    assert_eq!((&study["model"], &study["fixed"]["strength_MPa"]), (&summary["model"], &800.into()));
    let run = json_of(&at("run.json"));
    assert!(run["designs"] == summary["designs"] && run["threads"].is_u64() && run["seconds"].is_number(), "{run}");
}

#[test]
fn an_old_result_is_replaced_only_by_force_and_leaves_nothing_behind() {
    let plain = changed(
        SMALL,
        &[
            ("top = { by = \"axial_force_N\", count = 20 }\n", ""),
            ("    { x = \"band_thickness_mm\", y = \"band_count\", best = \"share\" },\n", ""),
        ],
    );
    let plain = changed(&plain, &[("histograms = [{ of = \"axial_force_N\", bins = 40 }]\n", "")]);
    let folder = folder_with("small.toml", SMALL);
    let out = folder.path().join("out");
    write(folder.path(), "plain.toml", &plain);
    ask(folder.path(), "sweep plain.toml --out new").text();
    ask(folder.path(), "sweep small.toml --out out").text();
    let own = [("notes.md", "mine"), ("front.png", "mine"), ("map.csv", "mine"), ("summary.txt", "mine")];
    own.iter().for_each(|(name, text)| write(&out, name, text));
    let before = files(&out);
    let err = ask(folder.path(), "sweep plain.toml --out out").refusal(2);
    assert!(err.contains("out holds a finished result; replace it with --force"), "{err}");
    assert_eq!(files(&out), before, "a refusal changes nothing");
    ask(folder.path(), "sweep plain.toml --out out --force").text();
    let mut after = files(&out);
    for (name, text) in own {
        assert_eq!(after.remove(name), Some(Some(text.as_bytes().to_vec())), "{name} is not ours");
    }
    assert!(!after.contains_key("top.csv") && !after.keys().any(|name| name.starts_with("histogram")));
    assert_eq!(same_result(&after, &files(&folder.path().join("new"))), Ok(()));
}

#[test]
fn files_that_no_result_has_are_the_users_own() {
    let folder = folder_with("small.toml", SMALL);
    let own = ["map-of-the-plant.svg", "histogram-2023.csv", "thesis.writing"];
    own.iter().for_each(|name| write(folder.path(), name, "mine"));
    ask(folder.path(), "sweep small.toml --out .").text();
    let lost: Vec<_> = own.into_iter().filter(|name| !folder.path().join(name).exists()).collect();
    assert!(lost.is_empty(), "a first run into a folder that held no result removed {lost:?}");
}

#[test]
fn a_quiet_run_prints_nothing() {
    let folder = folder_with("small.toml", SMALL);
    for line in ["sweep small.toml --quiet", "sweep small.toml --quiet --shard 1/1", "merge results/small-1-of-1 --out merged --quiet"] {
        let answer = ask(folder.path(), line);
        assert_eq!((answer.code, answer.out.as_str(), answer.err.as_str()), (Some(0), "", ""), "{line}");
    }
    for out in ["results/small", "merged"] {
        assert_eq!(same_result(small_result(), &files(&folder.path().join(out))), Ok(()), "{out}");
    }
}

#[test]
fn a_study_that_nothing_meets_says_what_limits() {
    let folder = folder_with("none.toml", &changed(SMALL, &[("slip_margin   = { min = 0 }", "slip_margin   = { min = 0.9 }")]));
    let text = ask(folder.path(), "sweep none.toml --out none").text();
    assert!(text.contains("feasible  0 (0 %)") && text.contains("what limits feasibility"), "{text}");
    assert!(text.lines().any(|line| line.contains("slip_margin at least 0.9") && line.contains("100.0 %")), "{text}");
    let at = |name: &str| folder.path().join("none").join(name);
    let summary = json_of(&at("summary.json"));
    assert_eq!((&summary["feasible"], &summary["front"], &summary["tally"]["feasible"]), (&0.into(), &0.into(), &0.into()));
    assert!(
        summary["ideal"].is_null() && summary["knee"].is_null() && summary["extremes"].as_object().is_some_and(serde_json::Map::is_empty)
    );
    let [front, top, bins, map, share] =
        ["front.csv", "top.csv", "histogram-axial_force_N.csv", "map-axial_force_N.csv", "map-feasible_share.csv"]
            .map(|name| Csv::read(&at(name)));
    assert!(front.rows.is_empty() && top.rows.is_empty() && front.header == Csv::read(&at("top.csv")).header && front.header.len() == 15);
    assert_eq!(bins.numbers("designs").iter().sum::<f64>(), 0.0);
    assert!(map.rows.len() == 21 * 13 && map.column("axial_force_N").iter().chain(&map.column("design_index")).all(|cell| cell.is_empty()));
    assert!(share.numbers("feasible_share").iter().all(|share| *share == 0.0));
    let parquet = std::fs::File::open(at("front.parquet")).expect("an empty front has its Parquet file too");
    assert_eq!(SerializedFileReader::new(parquet).expect("it can be read").metadata().file_metadata().num_rows(), 0);
    assert_numbers_are_plain(&folder.path().join("none"));
}

#[test]
fn one_objective_has_one_best_design_and_a_resolution_thins_a_front() {
    let single = changed(SMALL, &[("stress_margin = \"max\"\n", ""), ("band_count    = \"min\"\n", "")]);
    let coarse = changed(SMALL, &[("axial_force_N = \"min\"", "axial_force_N = { goal = \"min\", resolution = 1000 }")]);
    let folder = folder_with("single.toml", &single);
    write(folder.path(), "coarse.toml", &coarse);
    ask(folder.path(), "sweep single.toml --out single").text();
    let (front, top) = (Csv::read(&folder.path().join("single/front.csv")), Csv::read(&folder.path().join("single/top.csv")));
    assert_eq!(front.rows.len(), 1);
    assert_eq!(front.column("axial_force_N")[0], top.column("axial_force_N")[0]);
    // Bands change the stress but not the force: many designs are equal, and the one with the lowest index represents them.
    let ties = top.column("axial_force_N").iter().filter(|force| **force == front.column("axial_force_N")[0]).count();
    assert!(ties > 1, "there is nothing to break");
    assert_eq!(front.column("design_index")[0], top.column("design_index")[0]);
    assert!(top.numbers("design_index")[..ties].is_sorted());

    ask(folder.path(), "sweep coarse.toml --out coarse").text();
    let (fine, coarse) = (small_result()["front.csv"].as_deref().expect("a file"), Csv::read(&folder.path().join("coarse/front.csv")));
    let fine = String::from_utf8_lossy(fine).lines().count() - 1;
    assert!(!coarse.rows.is_empty() && coarse.rows.len() < fine, "{} of {fine}", coarse.rows.len());
    let steps: Vec<_> = coarse.numbers("axial_force_N").iter().map(|force| (force / 1000.0).floor()).collect();
    let (margin, bands) = (coarse.numbers("stress_margin"), coarse.numbers("band_count"));
    let beats = |a: usize, b: usize| a != b && steps[a] <= steps[b] && margin[a] >= margin[b] && bands[a] <= bands[b];
    assert!((0..steps.len()).all(|a| (0..steps.len()).all(|b| !beats(a, b))), "a design is dominated at this resolution");
}

#[test]
fn rows_of_a_csv_file_are_designs_or_scenarios() {
    let study = changed(
        SMALL,
        &[
            (
                "band_thickness_mm = { from = 0.10, to = 0.30, count = 21 }\nband_count        = { from = 6, to = 14 }\n",
                "cases = { csv = \"bands.csv\" }\n",
            ),
            (
                "ratio     = { from = 0.5, to = 2.0, count = 3, spacing = \"log\" }\ntorque_Nm = [50, 150]\n",
                "cases = { csv = \"loads.csv\" }\n",
            ),
        ],
    );
    let study = &study[..study.find("maps = [").expect("there are maps")];
    let folder = folder_with("rows.toml", study);
    write(folder.path(), "bands.csv", "band_count,band_thickness_mm\n8,0.2\n10,0.15\n12,0.12\n");
    write(folder.path(), "loads.csv", "torque_Nm,ratio\n150,2\n60,0.5\n");
    ask(folder.path(), "sweep rows.toml --out rows").text();
    let summary = json_of(&folder.path().join("rows/summary.json"));
    assert_eq!((&summary["designs"], &summary["scenarios"]), (&(13 * 3 * 5).into(), &4.into()));
    let front = Csv::read(&folder.path().join("rows/front.csv"));
    assert_eq!(front.header[..5], ["design_index", "groove_angle_deg", "band_count", "band_thickness_mm", "traction"]);
    assert!(!front.rows.is_empty());
    for row in &front.rows {
        assert!([["8", "0.2"], ["10", "0.15"], ["12", "0.12"]].iter().any(|pair| row[2..4] == *pair), "{row:?} is no row of bands.csv");
    }
    let scenarios = Csv::read(&folder.path().join("rows/scenarios.csv"));
    assert_eq!(scenarios.header, ["scenario", "torque_Nm", "ratio", "friction"]);
    assert_eq!(scenarios.rows[2], ["2", "60", "0.5", "0.065"]);
    write(folder.path(), "loads.csv", "torque_Nm,ratio\n150,2\n60,0.5 N\n");
    let err = ask(folder.path(), "sweep rows.toml --out again").refusal(2);
    assert!(err.contains("loads.csv:3:2") && err.contains("ratio"), "{err}");
    assert!(!folder.path().join("again").exists(), "a broken study leaves no trace");
}

#[test]
fn sampled_designs_depend_on_study_and_seed_only() {
    let sampled = |method: &str, seed: u32| {
        let study = changed(SMALL, &[(", count = 13", ""), (", count = 21", ""), (", count = 5 }", " }")]);
        let study = &study[..study.find("maps = [").expect("there are maps")];
        format!("{study}[sample]\nmethod = \"{method}\"\ncount = 5000\nseed = {seed}\n")
    };
    let folder = folder_with("x.toml", "");
    for method in ["sobol", "latin-hypercube", "random"] {
        for (name, seed) in [("one", 1), ("two", 2)] {
            write(folder.path(), &format!("{name}.toml"), &sampled(method, seed));
        }
        ask(folder.path(), "sweep one.toml --out a --force --threads 1").text();
        ask(folder.path(), "sweep one.toml --out b --force --threads 3 --tile 11").text();
        ask(folder.path(), "sweep two.toml --out c --force").text();
        let [a, b, c] = ["a", "b", "c"].map(|name| files(&folder.path().join(name)));
        assert_eq!(same_result(&a, &b), Ok(()), "{method}");
        assert_ne!(a["front.csv"], c["front.csv"], "{method}: the seed changes nothing");
        assert_eq!(json_of(&folder.path().join("a/summary.json"))["designs"], 5000);
        let front = Csv::read(&folder.path().join("a/front.csv"));
        assert!(front.numbers("groove_angle_deg").iter().all(|angle| (18.0..=30.0).contains(angle)) && front.rows.len() > 5, "{method}");
        assert!(front.numbers("band_count").iter().all(|bands| bands.fract() == 0.0), "{method}");
        assert_numbers_are_plain(&folder.path().join("a"));
    }
}

#[test]
fn a_map_of_more_than_a_hundred_thousand_cells_is_parquet() {
    let study = |angles: u32| {
        format!(
            "model = \"metal-cvt\"\n[design]\nband_thickness_mm = {{ from = 0.1, to = 0.5, count = 400 }}\n\
             groove_angle_deg = {{ from = 18, to = 30, count = {angles} }}\n[constraints]\ntorque_capacity_Nm = {{ above = 0 }}\n\
             [report]\nmaps = [{{ x = \"band_thickness_mm\", y = \"groove_angle_deg\", value = \"torque_capacity_Nm\", best = \"max\" }}]\n"
        )
    };
    let folder = folder_with("text.toml", &study(250));
    write(folder.path(), "binary.toml", &study(251));
    ask(folder.path(), "sweep text.toml --out out").text();
    let text = Csv::read(&folder.path().join("out/map-torque_capacity_Nm.csv"));
    assert!(text.rows.len() == 100_000 && !folder.path().join("out/map-torque_capacity_Nm.parquet").exists());
    ask(folder.path(), "sweep binary.toml --out out --force").text();
    assert!(!folder.path().join("out/map-torque_capacity_Nm.csv").exists(), "the old table is stale");
    let file = std::fs::File::open(folder.path().join("out/map-torque_capacity_Nm.parquet")).expect("there is a map");
    let reader = SerializedFileReader::new(file).expect("it is Parquet");
    assert_eq!(reader.metadata().file_metadata().num_rows(), 100_400);
    // The first row of cells is the same in both; a cell without a feasible design is absent in both.
    let mut absent = 0;
    for (row, cells) in reader.get_row_iter(None).expect("rows can be read").take(400).zip(&text.rows) {
        let row = row.expect("a row can be read");
        for (column, cell) in cells[..3].iter().enumerate() {
            assert_eq!(row.get_double(column).ok(), cell.parse().ok(), "{row}");
        }
        absent += usize::from(cells[2].is_empty());
    }
    assert!(absent > 0 && absent < 400, "{absent}");
    assert!(read(&folder.path().join("out/map-torque_capacity_Nm.svg")).len() < 5_000_000);
}

#[test]
fn the_starter_of_every_model_has_a_front_worth_reading() {
    for model in ask(Path::new("."), "models --json").json().as_array().expect("a list") {
        let model = model["name"].as_str().expect("a name");
        let folder = folder_with("my.toml", &ask(Path::new("."), &format!("models {model} --study")).text());
        ask(folder.path(), "sweep my.toml --out my --quiet").text();
        let front = json_of(&folder.path().join("my/summary.json"))["front"].as_u64();
        assert!(front >= Some(20), "the starter of {model} has {front:?} designs on its front");
    }
}

/// A value too large for f64 has a status of its own: it is in no file, and no design with it is feasible.
#[test]
fn a_value_that_overflows_is_a_status() {
    let study = "model = \"metal-cvt\"\n[design]\nelastic_modulus_MPa = [1e5, 1e290, 1e302, 1e305, 1.5e308]\n\
                 band_thickness_mm = [0.1, 1, 100, 1e10]\n[objectives]\ntorque_Nm = \"min\"\n[report]\n\
                 columns = [\"bending_stress_MPa\", \"max_stress_MPa\"]\n\
                 histograms = [{ of = \"bending_stress_MPa\", bins = 4 }, { of = \"max_stress_MPa\", bins = 4 }, { of = \"stress_margin\", bins = 3 }]\n\
                 maps = [{ x = \"elastic_modulus_MPa\", y = \"band_thickness_mm\", value = \"bending_stress_MPa\", best = \"min\" }]\n\
                 top = { by = \"stress_margin\", count = 30 }\nvariants = true\n";
    let folder = folder_with("overflow.toml", study);
    let text = ask(folder.path(), "sweep overflow.toml --out out").text();
    let out = folder.path().join("out");
    let summary = json_of(&out.join("summary.json"));
    let (feasible, tally) = (&summary["feasible"], &summary["tally"]);
    assert_eq!((tally["sampled"].as_u64(), &tally["feasible"]), (Some(20), feasible), "{summary}");
    let overflow = tally["status"]["overflow"].as_u64();
    assert_eq!(overflow, feasible.as_u64().map(|it| 20 - it), "{summary}");
    assert!(overflow > Some(0) && text.lines().any(|line| line.trim_start().starts_with("overflow")), "{text}");
    for name in ["histogram-bending_stress_MPa.csv", "histogram-max_stress_MPa.csv", "histogram-stress_margin.csv"] {
        let bins = Csv::read(&out.join(name));
        let (from, to) = (bins.column("from"), bins.column("to"));
        assert!(
            from.iter().chain(&to).all(|edge| edge.is_empty() || edge.parse::<f64>().is_ok_and(f64::is_finite)),
            "{name}: {from:?} {to:?}"
        );
        assert!(from[1..].windows(2).all(|pair| pair[0].parse::<f64>().ok() < pair[1].parse::<f64>().ok()), "{name}: {from:?}");
        assert_eq!(bins.numbers("designs").iter().sum::<f64>(), feasible.as_f64().expect("a number"), "{name}");
    }
    for (name, bytes) in files(&out).into_iter().filter(|(name, _)| name.ends_with(".csv")) {
        let text = String::from_utf8(bytes.expect("it is a file")).expect("it is text");
        assert!(!text.contains("NaN") && !text.contains("inf"), "{name}:\n{text}");
    }
    let one = ask(folder.path(), "eval metal-cvt --set elastic_modulus_MPa=1.5e308 --set band_thickness_mm=1e10 --json").json();
    assert_eq!(one["status"], "overflow");
    assert!(one["outputs"]["max_stress_MPa"].is_null() && one["outputs"]["driver_radius_mm"].is_number(), "{one}");
    let design = ask(folder.path(), "eval overflow.toml --design 19 --json").json();
    assert_eq!(design["status"], "overflow");
    assert_eq!(ask(folder.path(), "eval overflow.toml --design 0 --json").json()["status"], "ok");
}
