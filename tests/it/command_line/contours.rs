//! Contours of maps: every vertex is compared with the model in every scenario.

use super::{Csv, Files, ask, changed, files, folder_with, same_result};
use beltspace::models::{Worse, evaluate};
use beltspace::result_files::is_ours;
use beltspace::study::{Quantity, Study};
use std::path::Path;

/// A variator whose lines end where the belt slips, over scenarios of which now one, now another is the worst.
const VARIATOR: &str = r#"model = "metal-cvt"
title = "Slip and stress of a push belt"
[design]
traction         = { from = 0.2, to = 0.8, count = 31 }
groove_angle_deg = { from = 16, to = 32, count = 25 }
band_count       = [9]
[operation]
ratio     = { from = 0.5, to = 2.0, count = 4, spacing = "log" }
torque_Nm = [50, 150]
[uncertainty]
friction  = [0.065, 0.095]
[fixed]
strength_MPa = 760
[constraints]
slip_margin = { min = 0 }
[report]
maps = [
    { x = "traction", y = "groove_angle_deg", value = "slip_margin", best = "max", contours = [
        0, 0.1, "20 %", { of = "stress_margin", at = [0, 0.05] }, { of = "traction", at = [0.5] },
    ] },
    { x = "groove_angle_deg", y = "traction", best = "share", contours = [{ of = "axial_force_N", at = ["50 kN"] }] },
    { x = "groove_angle_deg", y = "traction", best = "share" },
]
"#;

/// A pulley with a logarithmic axis, one that is listed downwards, and a joint axis of duties.
const PULLEY: &str = r#"model = "pulley-load"
title = "Where the friction suffices"
[design]
mean_radius_mm  = { from = 30, to = 120, count = 40, spacing = "log" }
slack_tension_N = [900, 800, 650, 500, 350, 200, 100, 50]
[operation]
cases = [{ power_kW = 3.0, speed_rpm = 3000 }, { power_kW = 2.0, speed_rpm = 900 }]
wrap_angle_deg = [88, 110]
[uncertainty]
friction_direction_deg = [0, 22.5, 45]
[constraints]
friction_margin = { min = 0 }
[objectives]
resultant_force_N = "min"
[report]
maps = [{ x = "mean_radius_mm", y = "slack_tension_N", value = "resultant_force_N", contours = [{ of = "friction_margin", at = [0] }, 1500] }]
"#;

/// Whole numbers, as an axis and as what the lines are of.
const WHOLE: &str = r#"model = "metal-cvt"
[design]
band_count        = { from = 4, to = 14 }
band_thickness_mm = { from = 0.10, to = 0.30, count = 21 }
[operation]
ratio = [0.5, 2]
[constraints]
stress_margin = { min = 0 }
[report]
maps = [{ x = "band_count", y = "band_thickness_mm", value = "band_count", best = "min", contours = true },
        { x = "band_thickness_mm", y = "band_count", best = "share", contours = [{ of = "stress_margin", at = [0.1, 0] }] }]
"#;

/// A folder with the result of a study in `out`.
fn swept(text: &str) -> tempfile::TempDir {
    let folder = folder_with("study.toml", text);
    ask(folder.path(), "sweep study.toml --out out --threads 2").text();
    folder
}

/// The worst value of a quantity over all scenarios with two inputs set to other values.
fn worst(study: &Study, scenarios: &Csv, of: &str, set: [(&str, f64); 2]) -> Option<f64> {
    let model = &study.model;
    let quantity = model.output(of).map(Quantity::Output).or_else(|| model.input(of).map(Quantity::Input)).expect("it is known");
    let mut inputs = study.fixed.clone();
    for axis in study.design.iter().filter(|axis| axis.count() == 1) {
        inputs[axis.inputs()[0]] = axis.value(0, 0);
    }
    for (name, value) in set {
        inputs[model.input(name).expect("an axis is an input")] = value;
    }
    let mut worst: Option<f64> = None;
    for row in &scenarios.rows {
        for (name, cell) in scenarios.header.iter().zip(row).skip(1) {
            inputs[model.input(name).expect("a scenario sets inputs")] = cell.parse().expect("numbers");
        }
        let value = match quantity {
            Quantity::Output(output) => evaluate(model, &inputs).outputs[output]?,
            Quantity::Input(input) => inputs[input],
        };
        worst = Some(match (worst, quantity.worse(model)) {
            (None, _) => value,
            (Some(worst), Worse::Higher) => worst.max(value),
            (Some(worst), Worse::Lower) => worst.min(value),
        });
    }
    worst
}

/// The first row of a file of lines whose bracket does not have different answers at its two ends.
fn wrong_row(study: &Study, scenarios: &Csv, lines: &Csv) -> Option<usize> {
    let (x, y) = (lines.header[3].as_str(), lines.header[4].as_str());
    let wrong = |row: &Vec<String>| {
        let number = |column: usize| row[column].parse::<f64>().expect("numbers");
        let (at, half) = (number(1), 0.5 * number(5));
        let answer = |side: f64| {
            let moved = |name: &str, column: usize| number(column) + if row[6] == name { side * half } else { 0.0 };
            worst(study, scenarios, &row[0], [(x, moved(x, 3)), (y, moved(y, 4))]).map(|value| value >= at)
        };
        let answers = [answer(-1.0), answer(1.0)];
        answers.contains(&None) || answers[0] == answers[1] || half <= 0.0
    };
    lines.rows.iter().position(wrong)
}

struct Swept {
    study: Study,
    scenarios: Csv,
    lines: Vec<Csv>,
}

fn result(text: &str, names: &[&str]) -> Swept {
    let folder = swept(text);
    let out = folder.path().join("out");
    let found: Vec<_> = files(&out).into_keys().filter(|name| name.starts_with("contours-")).collect();
    assert_eq!(found, names);
    let lines = names.iter().map(|name| Csv::read(&out.join(name))).collect();
    let study = Study::parse_in(text, "study.toml", Path::new(".")).expect("it was swept");
    Swept { study, scenarios: Csv::read(&out.join("scenarios.csv")), lines }
}

/// Rows of a quantity at a threshold.
fn rows<'c>(lines: &'c Csv, of: &str, at: &str) -> Vec<&'c Vec<String>> {
    lines.rows.iter().filter(|row| row[0] == of && row[1] == at).collect()
}

#[test]
fn every_vertex_of_a_line_lies_between_different_answers() {
    let variator = result(VARIATOR, &["contours-feasible_share.csv", "contours-slip_margin.csv"]);
    let pulley = result(PULLEY, &["contours-resultant_force_N.csv"]);
    let whole = result(WHOLE, &["contours-band_count.csv", "contours-feasible_share.csv"]);
    for Swept { study, scenarios, lines } in [&variator, &pulley, &whole] {
        for lines in lines {
            assert_eq!(wrong_row(study, scenarios, lines), None, "{:?}", lines.header);
            assert!(lines.rows.len() > 9, "{:?}: there is something to look at", lines.header);
            let numbers: Vec<u64> = lines.column("line").iter().map(|cell| cell.parse().expect("a number")).collect();
            assert!(numbers[0] == 0 && numbers.windows(2).all(|pair| pair[1] == pair[0] || pair[1] == pair[0] + 1), "{numbers:?}");
        }
    }
    let slip = &variator.lines[1];
    assert_eq!(slip.header, ["of", "at", "line", "traction", "groove_angle_deg", "bracket", "along"]);
    for (of, at) in [("slip_margin", "0"), ("slip_margin", "0.1"), ("slip_margin", "0.2"), ("stress_margin", "0"), ("traction", "0.5")] {
        assert!(rows(slip, of, at).len() > 9, "{of} = {at}");
    }
    for (row, width) in slip.rows.iter().zip(slip.numbers("bracket")) {
        let range = if row[6] == "traction" { 0.6 } else { 16.0 };
        assert!(width <= 1e-9 * range, "{row:?}");
    }
    assert!(rows(&pulley.lines[0], "friction_margin", "0").len() > 9 && rows(&pulley.lines[0], "resultant_force_N", "1500").len() > 9);
}

#[test]
fn the_check_of_lines_objects_to_a_shifted_vertex() {
    for (text, name, column) in [(VARIATOR, "contours-slip_margin.csv", 3), (PULLEY, "contours-resultant_force_N.csv", 4)] {
        let folder = swept(text);
        let out = folder.path().join("out");
        let study = Study::parse_in(text, "study.toml", Path::new(".")).expect("it was swept");
        let (scenarios, mut lines) = (Csv::read(&out.join("scenarios.csv")), Csv::read(&out.join(name)));
        let row = lines.rows.iter().position(|row| row[6] == lines.header[column]).expect("some bracket lies along that axis");
        let shifted = lines.rows[row][column].parse::<f64>().expect("a number") + 2.0 * lines.rows[row][5].parse::<f64>().expect("a width");
        lines.rows[row][column] = shifted.to_string();
        assert_eq!(wrong_row(&study, &scenarios, &lines), Some(row), "{name}");
    }
}

#[test]
fn lines_end_where_their_quantity_has_no_value() {
    let variator = result(VARIATOR, &["contours-feasible_share.csv", "contours-slip_margin.csv"]);
    let slip = &variator.lines[1];
    let traction = |row: &Vec<String>| row[3].parse::<f64>().expect("a number");
    let value = |of: &str, row: &Vec<String>| {
        worst(
            &variator.study,
            &variator.scenarios,
            of,
            [("traction", traction(row)), ("groove_angle_deg", row[4].parse().expect("a number"))],
        )
    };
    let stress = rows(slip, "stress_margin", "0");
    assert!(stress.iter().all(|row| value("slip_margin", row) >= Some(0.0)), "there is no stress in a belt that slips");
    assert!(stress.len() > 9);
    let largest = stress.iter().map(|row| traction(row)).fold(0.0, f64::max);
    assert!(largest < 0.79, "{largest}: it ends before the edge of the map");
    // Constraints play no role.
    assert!(rows(slip, "traction", "0.5").iter().any(|row| value("slip_margin", row) < Some(0.0)));
}

#[test]
fn whole_numbers_change_half_way_between_their_levels() {
    let whole = result(WHOLE, &["contours-band_count.csv", "contours-feasible_share.csv"]);
    let steps = &whole.lines[0];
    let thresholds: std::collections::BTreeSet<u32> = steps.column("at").iter().map(|cell| cell.parse().expect("whole")).collect();
    assert!(thresholds.into_iter().eq(5..=14), "wherever the number rises");
    for row in &steps.rows {
        assert_eq!(
            (row[3].parse::<f64>().expect("a number"), &row[5][..], &row[6][..]),
            (row[1].parse::<f64>().expect("a number") - 0.5, "1", "band_count")
        );
    }
    let stress = &whole.lines[1];
    assert!(stress.column("along").contains(&"band_thickness_mm"));
    for row in stress.rows.iter().filter(|row| row[6] == "band_count") {
        assert!(row[5] == "1" && row[4].ends_with(".5"), "{row:?}");
    }
}

#[test]
fn a_map_with_lines_is_the_same_however_it_is_made() {
    let folder = folder_with("study.toml", VARIATOR);
    let run = |line: &str| ask(folder.path(), line).text();
    let read = |name: &str| -> Files { files(&folder.path().join(name)) };
    run("sweep study.toml --out one --threads 1");
    run("sweep study.toml --out three --threads 3");
    run("sweep study.toml --out a --shard 1/2");
    run("sweep study.toml --out b --shard 2/2");
    run("merge b a --out merged");
    for other in ["three", "merged"] {
        assert_eq!(same_result(&read("one"), &read(other)), Ok(()), "{other}");
    }
    let text = |name: &str| String::from_utf8(read("one")[name].clone().expect("a file")).expect("text");
    let described: serde_json::Value = serde_json::from_str(&text("study.json")).expect("JSON");
    let slip = serde_json::json!([
        { "of": "slip_margin", "at": [0, 0.1, 0.2] }, { "of": "stress_margin", "at": [0, 0.05] }, { "of": "traction", "at": [0.5] },
    ]);
    assert_eq!(described["maps"][0]["contours"], slip);
    assert!(described["maps"][2].get("contours").is_none());
    let picture = text("map-slip_margin.svg");
    assert!(picture.contains("slip margin = 0, 0.1, 0.2") && picture.contains("stress margin = 0, 0.05"), "the legend names the lines");
    assert!(!text("map-feasible_share-2.svg").contains("axial force"), "only the map that asked for lines has them");

    // Another study writes into the same directory: the files of the first one are removed.
    let none = changed(PULLEY, &["{ of = \"friction_margin\", at = [0] }, 1500"].map(|it| (it, "1e9")));
    super::write(folder.path(), "none.toml", &none);
    run("sweep none.toml --out one --force");
    let left = read("one");
    assert!(!left.contains_key("contours-slip_margin.csv"));
    let empty = left["contours-resultant_force_N.csv"].as_deref();
    assert_eq!(empty, Some(&b"of,at,line,mean_radius_mm,slack_tension_N,bracket,along\n"[..]), "nothing found: the header only");
    assert!(is_ours("contours-slip_margin.csv") && is_ours("contours-resultant_force_N-2.csv"));
    for foreign in ["contours-my notes.csv", "contours-slip_margin.svg", "contours.csv"] {
        assert!(!is_ours(foreign), "{foreign} is someone else's");
    }
}
