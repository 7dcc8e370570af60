//! `beltspace sensitivity` as people run it: what it prints, which files it writes, and what it refuses.

use beltspace::models::evaluate;
use beltspace::plan::Plan;
use beltspace::study::Study;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// Levels and distributions, correlated or not.
const STUDY: &str = r#"model = "metal-cvt"
title = "Small"
[design]
groove_angle_deg = [18, 22, 30]
[operation]
torque_Nm = [50, 150]
[uncertainty]
friction          = { normal = { mean = 0.08, sd = 0.006 }, from = 0.05, to = 0.11 }
band_thickness_mm = { times = { uniform = [0.97, 1.03] } }
strength_MPa      = [750, 850, 800]
[probability]
draws = 256
confirm = 256
[constraints]
stress_margin = { min = 0.55 }
yield = { min = 0.1 }
[objectives]
axial_force_N = { goal = "min", over_draws = "mean" }
"#;

struct Ended {
    code: Option<i32>,
    out: String,
    err: String,
}

/// Runs the command in a folder that has the study.
fn run(folder: &Path, arguments: &[&str]) -> Ended {
    let output = Command::new(env!("CARGO_BIN_EXE_beltspace")).arg("sensitivity").args(arguments).current_dir(folder).output();
    let output = output.expect("the program starts");
    let text = |bytes| String::from_utf8(bytes).expect("text");
    Ended { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
}

fn folder(study: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary directory");
    std::fs::write(folder.path().join("study.toml"), study).expect("it can be written");
    folder
}

/// Every file of a directory.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = folder.read_dir().expect("it is there").map(|entry| entry.expect("it can be read"));
    entries.map(|it| (it.file_name().to_string_lossy().into_owned(), std::fs::read(it.path()).expect("it can be read"))).collect()
}

/// Rows of a CSV file, each by the names of its columns.
fn rows(bytes: &[u8]) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_reader(bytes);
    let names = reader.headers().expect("there is a header").clone();
    let row = |row: csv::StringRecord| names.iter().map(str::to_owned).zip(row.iter().map(str::to_owned)).collect();
    reader.records().map(|it| row(it.expect("a row"))).collect()
}

/// The widths of the bars of a colour: the boxes of the legend are 220 wide.
fn widths(svg: &str, colour: &str) -> Vec<f64> {
    let of = |line: &str| line.split("width=\"").nth(1).and_then(|it| it.split('"').next()).and_then(|it| it.parse().ok());
    let fill = format!("fill=\"{colour}\"");
    let bars = svg.lines().filter(|line| line.starts_with("<rect") && line.contains(&fill));
    bars.map(|line| of(line).expect("a width")).filter(|it| *it != 220.0).collect()
}

/// The bars of a colour are as long as these shares, in tenths of a pixel.
fn assert_bars(svg: &str, colour: &str, shares: &[f64]) {
    let widths = widths(svg, colour);
    assert_eq!(widths.len(), shares.len());
    let (largest, widest) = shares.iter().zip(&widths).max_by(|a, b| a.0.total_cmp(b.0)).expect("there are shares");
    for (share, width) in shares.iter().zip(&widths) {
        let expected = share.abs() / largest * widest;
        assert!((width - expected).abs() <= 11.0, "a bar of {width} for {share}, of {widest} for {largest}");
    }
}

#[test]
fn files_say_the_same_for_any_number_of_threads_and_read_back() {
    let folder = folder(STUDY);
    for threads in ["1", "2", "5"] {
        let ended = run(folder.path(), &["study.toml", "--design", "1", "--draws", "256", "--threads", threads, "--out", threads]);
        assert_eq!(ended.code, Some(0), "{}", ended.err);
        assert!(ended.out.contains("estimated: 8 sets of 256 draws, seed 1; with intervals of 95 %"), "{}", ended.out);
    }
    let [one, two, five] = ["1", "2", "5"].map(|name| files(&folder.path().join(name)));
    assert!(one == two && one == five);
    let names: Vec<&str> = one.keys().map(String::as_str).collect();
    let quantities = ["axial_force_N", "holds", "stress_margin"];
    let pictures = ["sensitivity", "tornado"].map(|kind| quantities.map(|it| format!("{kind}-{it}.svg")));
    let [shares, tornados] = pictures;
    let mut expected: Vec<String> = shares.to_vec();
    expected.extend(["sensitivity.csv", "sensitivity.json"].map(str::to_owned));
    expected.extend(tornados);
    expected.push("tornado.csv".to_owned());
    assert_eq!(names, expected);
    let json: Value = serde_json::from_slice(&one["sensitivity.json"]).expect("JSON");
    let table = rows(&one["sensitivity.csv"]);
    assert_eq!(table.len(), 9);
    for quantity in json["quantities"].as_array().expect("a list") {
        let name = quantity["name"].as_str().expect("a name");
        let own: Vec<_> = table.iter().filter(|row| row["quantity"] == name).collect();
        let number = |row: &BTreeMap<String, String>, column: &str| row[column].parse::<f64>().unwrap_or(f64::NAN);
        for (row, input) in own.iter().zip(quantity["inputs"].as_array().expect("a list")) {
            assert_eq!(row["names"], input["name"].as_str().expect("a name"));
            for (column, key) in [("S1", "first"), ("ST", "total"), ("shapley", "shapley")] {
                assert_eq!(Some(number(row, column)), input[key]["value"].as_f64(), "{name} {column}");
                assert_eq!(row[&format!("{column}_conf")].parse().ok(), input[key]["confidence"].as_f64(), "{name} {column}");
            }
            assert_eq!(["mu", "mu_star", "sigma", "shapley_holds"].map(|column| row[column].as_str()), [""; 4]);
        }
        let svg = String::from_utf8(one[&format!("sensitivity-{name}.svg")].clone()).expect("text");
        for (column, colour) in [("S1", "#0072B2"), ("ST", "#D55E00"), ("shapley", "#009E73")] {
            assert_bars(&svg, colour, &own.iter().map(|row| number(row, column)).collect::<Vec<_>>());
        }
        let shapley: f64 = own.iter().map(|row| number(row, "shapley")).sum();
        assert!((shapley - 1.0).abs() < 1e-12, "{name} {shapley}");
    }
}

#[test]
#[should_panic(expected = "a bar of")]
fn a_bar_of_another_length_is_noticed() {
    let bar = |top: u32, width: u32| format!("<rect x=\"0\" y=\"{top}\" width=\"{width}\" height=\"110\" fill=\"#0072B2\"/>\n");
    assert_bars(&format!("{}{}", bar(0, 1000), bar(200, 520)), "#0072B2", &[1.0, 0.5]);
}

/// The tornado of a design: every row is two evaluations with the other inputs in the middle.
#[test]
fn the_tornado_is_what_the_model_says() {
    let folder = folder(STUDY);
    let ended = run(folder.path(), &["study.toml", "--design", "1", "--draws", "16", "--out", "out"]);
    assert_eq!(ended.code, Some(0), "{}", ended.err);
    let table = rows(&files(&folder.path().join("out"))["tornado.csv"]);
    let plan = Plan::new(Study::parse(STUDY).expect("it is a study").of_one_draw());
    let model = &plan.study.model;
    let input = |name: &str| model.input(name).expect("the model has it");
    let force = model.output("axial_force_N").expect("the model has it");
    let margin = model.output("stress_margin").expect("the model has it");
    let thickness = plan.study.fixed[input("band_thickness_mm")];
    // The friction's quantiles of 5, 50 and 95 %: -1.64485, 0 and 1.64485 standard deviations from the mean; what is cut off is as much on
    // either side, and five of them away.
    let places = [
        ("friction", [0.08 - 1.644_853 * 0.006, 0.08, 0.08 + 1.644_853 * 0.006]),
        ("band_thickness_mm", [0.973 * thickness, thickness, 1.027 * thickness]),
        ("strength_MPa", [750.0, 800.0, 850.0]),
    ];
    let worst = |values: [f64; 3]| {
        let of_case = |torque: f64| {
            let mut inputs = plan.space.inputs(1, 0);
            inputs[input("torque_Nm")] = torque;
            places.iter().zip(values).for_each(|((name, _), value)| inputs[input(name)] = value);
            let outputs = evaluate(model, &inputs).outputs;
            (outputs[force].expect("it has a value"), outputs[margin].expect("it has a value"))
        };
        let (a, b) = (of_case(50.0), of_case(150.0));
        [a.0.max(b.0), a.1.min(b.1)]
    };
    let middle = places.map(|(_, ends)| ends[1]);
    let mut compared = 0;
    for row in &table {
        let Some(which) = ["axial_force_N", "stress_margin"].iter().position(|it| *it == row["quantity"]) else { continue };
        let place = places.iter().position(|(name, _)| *name == row["names"]).expect("it varies");
        let at = |end: usize| {
            let mut values = middle;
            values[place] = places[place].1[end];
            worst(values)[which]
        };
        for (column, truth) in [("at_low", at(0)), ("at_middle", at(1)), ("at_high", at(2))] {
            let found: f64 = row[column].parse().expect("a number");
            assert!((found / truth - 1.0).abs() < 1e-6, "{row:?} {column}: {truth}");
        }
        for (column, end) in [("low", 0), ("high", 2)] {
            let found: f64 = row[column].parse().expect("a number");
            assert!((found / places[place].1[end] - 1.0).abs() < 1e-6, "{row:?}");
        }
        compared += 1;
    }
    assert_eq!(compared, 6);
}

#[test]
fn requests_that_cannot_be_met_name_the_remedy() {
    let without = STUDY.replace("{ normal = { mean = 0.08, sd = 0.006 }, from = 0.05, to = 0.11 }", "[0.08]");
    let certain = "model = \"metal-cvt\"\n[design]\nband_count = [8]\n[objectives]\naxial_force_N = \"min\"\n";
    assert!(without.contains("friction          = [0.08]"));
    let cases: [(&str, &[&str], &str); 9] = [
        (STUDY, &[], "which design? name it by --design N, from 0 to 2, as in front.csv; or ask for --over design"),
        (STUDY, &["--design", "3"], "there is no design 3; the study's designs are 0 to 2"),
        (
            STUDY,
            &["--design", "1", "--over", "design"],
            "--design is of one design, and --over design looks at all of them; use one of the two",
        ),
        (
            STUDY,
            &["--design", "1", "--of", "axial_forc_N"],
            "--of axial_forc_N: there is no such quantity; did you mean \"axial_force_N\"?",
        ),
        (
            STUDY,
            &["--design", "1", "--of", "weather"],
            "--of weather: there is no such quantity; the study asks for: stress_margin, axial_force_N, holds",
        ),
        (
            STUDY,
            &["--design", "1", "--draws", "100"],
            "sobol: 100 draws cannot be divided into 16 replicates of a power of two each; take 128 draws",
        ),
        (certain, &[], "nothing varies over the design: give an axis of [design] more than one level"),
        (
            certain,
            &["--over", "uncertainty"],
            "nothing is uncertain: give inputs levels or distributions in [uncertainty], or ask for --over design",
        ),
        (
            "model = \"metal-cvt\"\n[design]\nband_count = [8, 9]\n[objectives]\nslip_marginn = \"max\"\n",
            &[],
            "did you mean \"slip_margin\"?",
        ),
    ];
    for (study, arguments, expected) in cases {
        let folder = folder(study);
        let ended = run(folder.path(), &[&["study.toml"], arguments].concat());
        assert_eq!((ended.code, ended.out.as_str()), (Some(2), ""), "{expected}: {}", ended.err);
        let said = ended.err.trim_end().strip_prefix("error: ").unwrap_or_else(|| panic!("{}", ended.err));
        assert!(said == expected || (study.contains("marginn") && said.ends_with(expected)), "{said}");
    }
}

#[test]
fn correlated_inputs_have_shapley_effects_and_are_told_why() {
    let folder = folder(&STUDY.replace("draws = 256", "correlation = [[\"friction\", \"band_thickness_mm\", 0.7]]\ndraws = 256"));
    let ended = run(folder.path(), &["study.toml", "--design", "1", "--draws", "64", "--of", "stress_margin", "--out", "out"]);
    assert_eq!(ended.code, Some(0), "{}", ended.err);
    assert!(ended.err.contains("inputs are correlated, so Sobol indices have no meaning; Shapley effects do"), "{}", ended.err);
    for row in rows(&files(&folder.path().join("out"))["sensitivity.csv"]) {
        assert_eq!((row["S1"].as_str(), row["ST"].as_str()), ("", ""));
        assert!(row["shapley"].parse::<f64>().is_ok());
    }
}

#[test]
fn files_of_others_stay_and_older_ones_of_its_own_go() {
    let folder = folder(STUDY);
    let out = folder.path().join("out");
    let own = |of: &[&str]| {
        let quantities: Vec<&str> = of.iter().flat_map(|it| ["--of", it]).collect();
        run(folder.path(), &[&["study.toml", "--design", "1", "--draws", "16", "--out", "out"], &quantities[..]].concat())
    };
    assert_eq!(own(&["axial_force_N"]).code, Some(0));
    std::fs::write(out.join("tornado-mine.svg"), "<svg>mine</svg>").expect("it can be written");
    std::fs::write(out.join("notes.md"), "mine").expect("it can be written");
    assert_eq!(own(&["stress_margin"]).code, Some(0));
    let names: Vec<String> = files(&out).into_keys().collect();
    let expected = [
        "notes.md",
        "sensitivity-stress_margin.svg",
        "sensitivity.csv",
        "sensitivity.json",
        "tornado-mine.svg",
        "tornado-stress_margin.svg",
        "tornado.csv",
    ];
    assert_eq!(names, expected, "the pictures of the other quantity are gone, other files are not");
    // In the way of one file nothing is written at all.
    std::fs::write(out.join("sensitivity.csv"), "names,S1\n").expect("it can be written");
    let before = files(&out);
    let refused = own(&["axial_force_N"]);
    assert_eq!(refused.code, Some(2));
    let expected = "error: out/sensitivity.csv: a file is there that this program did not write; move it away, or name another";
    assert_eq!(refused.err.trim_end(), expected);
    assert_eq!(files(&out), before);
}
