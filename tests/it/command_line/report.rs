//! `report.html`: written by `sweep` and `merge`, written again by `report`, and consistent with the result's files.

use super::{SMALL, ask, changed, folder_with, read, write};
use base64::Engine;
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;

/// The data of a page.
pub(super) fn data_of(page: &Path) -> Value {
    let html = read(page);
    let start = html.find("id=\"data\">").expect("the page has data") + "id=\"data\">".len();
    let end = start + html[start..].find("</script>").expect("the data ends");
    serde_json::from_str(&html[start..end]).expect("it is JSON")
}

/// All columns of the front, as bytes.
pub(super) fn unpacked(data: &Value) -> Vec<u8> {
    let packed = data["front"]["packed"].as_str().expect("it is text");
    let packed = base64::engine::general_purpose::STANDARD.decode(packed).expect("it is base64");
    let mut bytes = Vec::new();
    flate2::read::ZlibDecoder::new(&packed[..]).read_to_end(&mut bytes).expect("it is compressed");
    bytes
}

/// Columns of the front by name, as numbers; and the scenarios of those that have some.
pub(super) fn columns_of(data: &Value) -> BTreeMap<String, (Vec<f64>, Vec<u32>)> {
    let front = &data["front"];
    let bytes = unpacked(data);
    let rows = front["rows"].as_u64().expect("a front has rows") as usize;
    let mut rest = &bytes[..];
    let mut take = |width: usize| {
        let (taken, after) = rest.split_at(width * rows);
        rest = after;
        taken.chunks(width)
    };
    let mut columns = BTreeMap::new();
    for column in front["columns"].as_array().expect("a front has columns") {
        let values = match column["type"].as_str().expect("a column has a type") {
            "f64" => take(8).map(|it| f64::from_le_bytes(it.try_into().expect("eight"))).collect(),
            "u64" => take(8).map(|it| u64::from_le_bytes(it.try_into().expect("eight")) as f64).collect(),
            "f32" => take(4).map(|it| f64::from(f32::from_le_bytes(it.try_into().expect("four")))).collect(),
            _ => take(4).map(|it| f64::from(u32::from_le_bytes(it.try_into().expect("four")))).collect(),
        };
        let scenarios = if column["scenario"] == true {
            take(4).map(|it| u32::from_le_bytes(it.try_into().expect("four"))).collect()
        } else {
            Vec::new()
        };
        let name = column["name"].as_str().expect("a column has a name").to_owned();
        assert!(columns.insert(name, (values, scenarios)).is_none(), "a name stands twice");
    }
    assert!(rest.is_empty(), "{} bytes are left over", rest.len());
    columns
}

#[test]
fn a_sweep_writes_a_page_that_says_what_the_tables_say() {
    let study = changed(SMALL, &[("[objectives]", "friction = { min = 0.06 }\n[objectives]")]);
    let folder = folder_with("small.toml", &study);
    let printed = ask(folder.path(), "sweep small.toml --out r").text();
    assert!(printed.ends_with("result r\npage   r/report.html\n"), "{printed}");
    let result = folder.path().join("r");
    let data = data_of(&result.join("report.html"));
    let columns = columns_of(&data);
    let table = read(&result.join("front.csv"));
    let mut table = csv::Reader::from_reader(table.as_bytes());
    let header = table.headers().expect("it has a header").clone();
    let rows: Vec<_> = table.records().map(|row| row.expect("rows are complete")).collect();
    assert!(rows.len() > 20 && data["front"]["rows"] == rows.len() && data["front"]["complete"] == true);
    for (at, name) in header.iter().enumerate() {
        let (of, scenario) = name.strip_suffix("_scenario").map_or((name, false), |name| (name, true));
        let (values, scenarios) = &columns[of];
        assert!(!scenario || !scenarios.is_empty(), "{of}");
        for (row, shown) in rows.iter().enumerate() {
            let written: f64 = shown[at].parse().expect("it is a number");
            let value = if scenario { f64::from(scenarios[row]) } else { values[row] };
            assert_eq!(value.to_bits(), written.to_bits(), "{name} of row {row}");
        }
    }
    // Every other output has the worst value that `eval` finds.
    let at = rows.len() / 2;
    let single = ask(folder.path(), &format!("eval small.toml --design {} --json", &rows[at][0])).json();
    let mut further = 0;
    for (name, worst) in single["outputs"].as_object().expect("outputs have names") {
        let Some((values, scenarios)) = columns.get(name).filter(|(_, scenarios)| !scenarios.is_empty()) else { continue };
        let value = worst["value"].as_f64().expect("it is a number");
        assert!((values[at] - value).abs() <= 6e-8 * value.abs(), "{name}: {} is not {value}", values[at]);
        assert_eq!(worst["scenario"], scenarios[at], "{name}");
        further += 1;
    }
    assert!(further > 20, "{further}");
    let command = data["evaluate"].as_str().expect("there is a command");
    assert_eq!(command, "beltspace eval r/study.toml --design {design}");
    for (place, constraint) in data["constraints"].as_array().expect("a list").iter().enumerate() {
        let column = &data["front"]["columns"][constraint["column"].as_u64().map_or(usize::MAX, |it| it as usize)];
        let expected = ["slip_margin", "stress_margin_constrained", "friction"][place];
        assert_eq!(column["name"], expected);
    }
    assert_eq!(data["maps"].as_array().map(Vec::len), Some(2));
    assert_eq!(data["front"]["knee"].as_u64().map(|row| rows[row as usize][0].to_owned()), {
        Some(data_of_summary(&result)["knee"]["design_index"].to_string())
    });

    // The page made again from the files alone, elsewhere, is the same page.
    let page = std::fs::read(result.join("report.html")).expect("it is there");
    std::fs::remove_file(result.join("report.html")).expect("it can go");
    ask(folder.path(), "report r").text();
    assert!(std::fs::read(result.join("report.html")).expect("it is there") == page);
}

fn data_of_summary(result: &Path) -> Value {
    super::json_of(&result.join("summary.json"))
}

#[test]
fn a_page_can_be_left_out_and_put_elsewhere() {
    let folder = folder_with("small.toml", SMALL);
    let printed = ask(folder.path(), "sweep small.toml --out r --no-report").text();
    assert!(printed.ends_with("result r\n"), "{printed}");
    assert!(!folder.path().join("r/report.html").exists());
    assert!(ask(folder.path(), "report r --out elsewhere.html").text().starts_with("elsewhere.html ("));
    assert!(!folder.path().join("r/report.html").exists() && folder.path().join("elsewhere.html").exists());
    let impatient = ask(folder.path(), "report r --patience 0");
    assert!(impatient.err.contains("raise --patience"), "{}", impatient.err);
    let data = data_of(&folder.path().join("r/report.html"));
    assert_eq!(data["front"]["complete"], false);
    assert!(columns_of(&data).keys().all(|name| name != "belt_force_N"));
    // The next sweep replaces the page with the rest.
    ask(folder.path(), "sweep small.toml --out r --force --no-report").text();
    assert!(!folder.path().join("r/report.html").exists(), "a page of an older result stays");
}

#[test]
fn merged_shards_have_a_page_and_tables_beside_the_study_are_not_needed() {
    let text = changed(SMALL, &[("friction  = [0.065, 0.095]", "cases = { csv = \"frictions.csv\" }")]);
    let folder = folder_with("small.toml", &text);
    write(folder.path(), "frictions.csv", "friction\n0.065\n0.095\n");
    for shard in ["1/2", "2/2"] {
        ask(folder.path(), &format!("sweep small.toml --shard {shard} --out s{}", &shard[..1])).text();
    }
    let printed = ask(folder.path(), "merge s1 s2 --out whole").text();
    assert!(printed.ends_with("page   whole/report.html\n"), "{printed}");
    std::fs::remove_file(folder.path().join("frictions.csv")).expect("it can go");
    ask(folder.path(), "report whole").text();
    let data = data_of(&folder.path().join("whole/report.html"));
    assert_eq!(data["scenarios"]["columns"][2]["name"], "friction");
}

#[test]
fn a_study_without_a_feasible_design_has_a_page_that_tells_what_limits_it() {
    let folder = folder_with("small.toml", &changed(SMALL, &[("strength_MPa = 800", "strength_MPa = 80")]));
    ask(folder.path(), "sweep small.toml --out r").text();
    let data = data_of(&folder.path().join("r/report.html"));
    assert_eq!((&data["front"]["rows"], &data["study"]["feasible"]), (&Value::from(0), &Value::from(0)));
    assert_eq!(data["tally"]["constraints"][1]["of"], "stress_margin");
    assert!(data["tally"]["constraints"][1]["violated"].as_u64() > Some(0));
}

#[test]
fn what_is_no_result_or_was_changed_is_refused_by_name() {
    let folder = folder_with("small.toml", SMALL);
    std::fs::create_dir(folder.path().join("empty")).expect("a folder can be made");
    let said = ask(folder.path(), "report empty").refusal(2);
    assert!(
        said.contains("empty is not a finished result: it has no summary.json; name the directory that `beltspace sweep` wrote"),
        "{said}"
    );
    let said = ask(folder.path(), "report nowhere").refusal(2);
    assert!(said.contains("nowhere is not a directory"), "{said}");

    ask(folder.path(), "sweep small.toml --out r --no-report").text();
    let front = folder.path().join("r/front.csv");
    let table = read(&front);
    let row = table.lines().nth(3).expect("the front has designs").to_owned();
    let cell = row.split(',').nth(5).expect("a row has objectives").to_owned();
    // Of seventeen digits the last may be another one and the number the same.
    let digits = cell.parse::<f64>().expect("it is a number").next_up().to_string();
    write(folder.path(), "r/front.csv", &table.replacen(&format!(",{cell},"), &format!(",{digits},"), 1));
    let said = ask(folder.path(), "report r").refusal(2);
    assert!(
        said.contains("r/front.csv: axial_force_N of design") && said.contains(&digits) && said.contains("sweep the study again"),
        "{said}"
    );
    write(folder.path(), "r/front.csv", &table.replacen("axial_force_N", "axial_farce_N", 1));
    let said = ask(folder.path(), "report r").refusal(2);
    assert!(said.contains("\"axial_farce_N\" in place of \"axial_force_N\""), "{said}");
    write(folder.path(), "r/front.csv", &table);
    let study = read(&folder.path().join("r/study.json"));
    write(folder.path(), "r/study.json", &study.replace("\"count\": 13", "\"count\": 14"));
    let said = ask(folder.path(), "report r").refusal(2);
    assert!(said.contains("summary.json: it belongs to another study"), "{said}");
    assert!(!folder.path().join("r/report.html").exists(), "nothing half-written");
}

#[test]
fn every_file_that_says_other_than_the_study_is_refused() {
    let folder = folder_with("small.toml", SMALL);
    ask(folder.path(), "sweep small.toml --out r --no-report").text();
    let text = |name: &str| read(&folder.path().join("r").join(name));
    let second = |table: &str| table.lines().nth(1).expect("a table has rows").to_owned();
    let front = text("front.csv");
    let row = second(&front);
    let cells: Vec<&str> = row.split(',').collect();
    let with = |at: usize, value: &str| {
        let mut cells = cells.clone();
        cells[at] = value;
        front.replacen(&row, &cells.join(","), 1)
    };
    let header: Vec<&str> = front.lines().next().expect("a table has a header").split(',').collect();
    let scenario = header.iter().position(|it| *it == "axial_force_N_scenario").expect("it is a column");
    let other = if cells[scenario] == "3" { "4" } else { "3" };
    let histogram = text("histogram-axial_force_N.csv");
    let last = histogram.lines().last().expect("it has bins").to_owned();
    let map = text("map-axial_force_N.csv");
    let summary = text("summary.json");
    let cases = [
        ("front.csv", with(1, "18.25"), "groove_angle_deg of design".to_owned()),
        ("front.csv", with(scenario, "99"), "axial_force_N_scenario is not one of the study's 12 scenarios".to_owned()),
        ("front.csv", with(scenario, other), format!("has scenario {other}, and the study gives {}", cells[scenario])),
        ("front.csv", front.replacen(&format!("{row}\n"), "", 1), "designs, and summary.json says".to_owned()),
        ("front.csv", front.replacen(&row, cells[0], 1), "line 2: 1 cells where there should be".to_owned()),
        ("histogram-axial_force_N.csv", histogram.replace(&last, ",,7"), "its bins or their designs".to_owned()),
        ("map-axial_force_N.csv", map.replacen("\n0.1,", "\n0.2,", 1), "its cells are not where".to_owned()),
        ("top.csv", String::new(), "its columns are not those of the study: their number".to_owned()),
        ("study.toml", String::new(), "it is not the study that study.json describes".to_owned()),
        ("study.toml", text("study.toml").replace("\"max\"", "\"min\""), "it is not the study".to_owned()),
        ("summary.json", summary.replace("\"feasible\": ", "\"feasible\": 9"), "its numbers of designs".to_owned()),
        ("summary.json", summary.replace("\"designs\": ", "\"designs\": 9"), "its numbers of designs".to_owned()),
    ];
    for (name, wrong, expected) in &cases {
        let right = text(name);
        assert_ne!(right, *wrong, "{name} was not changed");
        write(folder.path(), &format!("r/{name}"), wrong);
        let said = ask(folder.path(), "report r").refusal(2);
        assert!(said.contains(&format!("r/{name}: ")) && said.contains(expected), "{name}: {said} lacks {expected}");
        write(folder.path(), &format!("r/{name}"), &right);
    }
    for name in ["front.csv", "study.json", "study.toml", "top.csv", "map-axial_force_N.csv", "histogram-axial_force_N.csv"] {
        let right = text(name);
        std::fs::remove_file(folder.path().join("r").join(name)).expect("it can go");
        let said = ask(folder.path(), "report r").refusal(2);
        assert!(said.contains(&format!("{name} is missing from the result: sweep the study again")), "{said}");
        write(folder.path(), &format!("r/{name}"), &right);
    }
    ask(folder.path(), "report r").text();
}

#[test]
fn a_page_replaces_nothing_but_a_page_and_leaves_nothing_behind() {
    let folder = folder_with("small.toml", SMALL);
    ask(folder.path(), "sweep small.toml --out r --no-report").text();
    write(folder.path(), "mine.html", "<p>mine</p>");
    std::fs::create_dir(folder.path().join("folder.html")).expect("a folder can be made");
    for (out, expected) in [
        ("small.toml", "small.toml: a page is an HTML file; give it a name that ends in .html"),
        ("r/front.csv", "a page is an HTML file"),
        ("mine.html", "mine.html: a file is there that this program did not write; replace it with --force"),
        ("folder.html", "folder.html: it is a directory; name a file"),
        ("nowhere/x.html", "nowhere/x.html: there is no directory nowhere; make it, or name another file"),
    ] {
        let said = ask(folder.path(), &format!("report r --out {out}")).refusal(2);
        assert!(said.contains(expected), "{said}");
    }
    assert_eq!(read(&folder.path().join("mine.html")), "<p>mine</p>");
    ask(folder.path(), "report r --out mine.html --force").text();
    ask(folder.path(), "report r --out mine.html").text();
    // A failed write leaves no temporary file behind.
    std::fs::create_dir(folder.path().join("full")).expect("a folder can be made");
    std::os::unix::fs::symlink("/dev/full", folder.path().join("full/late.html")).expect("links can be made");
    let said = ask(folder.path(), "report r --out full/late.html").refusal(2);
    assert!(said.contains("it is a link or a device"), "{said}");
    // What is not finished says what to do.
    ask(folder.path(), "sweep small.toml --shard 1/2 --out shard").text();
    let said = ask(folder.path(), "report shard").refusal(2);
    assert!(said.contains("put the shards together with `beltspace merge`"), "{said}");
}
