//! A sample of the feasible designs: its files, its dots behind the front, and changed files.

use super::report::{columns_of, data_of};
use super::{SMALL, ask, changed, folder_with, read, write};
use parquet::file::reader::{FileReader, SerializedFileReader};
use serde_json::{Value, json};
use std::collections::BTreeSet;

fn with_sample() -> String {
    changed(SMALL, &[("[report]\n", "[report]\nsample = { count = 60, seed = 5 }\n")])
}

#[test]
fn a_sample_is_written_and_shown_behind_the_front() {
    let folder = folder_with("small.toml", &with_sample());
    ask(folder.path(), "sweep small.toml --out r").text();
    let at = |name: &str| folder.path().join("r").join(name);
    let table = read(&at("sample.csv"));
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!((lines[0], lines.len()), (read(&at("front.csv")).lines().next().expect("it has a header"), 61));
    let indices: Vec<u64> =
        lines[1..].iter().map(|line| line.split(',').next().and_then(|it| it.parse().ok()).expect("a design")).collect();
    assert!(indices.windows(2).all(|pair| pair[0] < pair[1]), "{indices:?}");

    let parquet = SerializedFileReader::new(std::fs::File::open(at("sample.parquet")).expect("it is there")).expect("it can be read");
    let metadata = parquet.metadata().file_metadata();
    let names: Vec<_> = metadata.schema().get_fields().iter().map(|it| it.name().to_owned()).collect();
    assert_eq!((names.join(","), metadata.num_rows()), (lines[0].to_owned(), 60));
    assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), names.len(), "a name stands twice");
    let about = metadata.key_value_metadata().expect("columns are described");
    assert!(names.iter().all(|name| about.iter().any(|it| it.key == format!("{name}.unit"))));
    assert!(about.iter().any(|it| it.key == "axial_force_N.direction" && it.value.as_deref() == Some("min")));

    assert!(read(&at("front.svg")).contains("\nsample of 60 feasible designs\n"));
    let data = data_of(&at("report.html"));
    let sample = &data["sample"];
    assert_eq!((&sample["rows"], &sample["of"]), (&60.into(), &60.into()));
    // Every column of the study and every axis has the numbers of the table: objectives to the last digit, the others to six or more.
    let named = |it: &Value, key: &str| -> Vec<Value> { it[key].as_array().expect("a list").clone() };
    let mut axes = named(sample, "axes");
    assert_eq!(axes.iter().map(|it| it["levels"].as_u64()).collect::<Vec<_>>(), [13, 21, 9, 5].map(Some));
    axes.iter_mut().for_each(|it| it["name"] = format!("axis {}", it["name"].as_str().expect("a name")).into());
    let all = [named(sample, "columns"), axes].concat();
    let columns = columns_of(&json!({ "front": { "rows": 60, "columns": all, "packed": sample["packed"] } }));
    let header: Vec<&str> = lines[0].split(',').collect();
    assert_eq!(columns.len(), header.iter().filter(|it| it.ends_with("_scenario")).count() + 1 + 4, "band_count has no scenario");
    for (name, (values, _)) in &columns {
        let at = header.iter().position(|it| *it == name.trim_start_matches("axis ")).expect("the table has it");
        let exact = name.starts_with("axis") || ["axial_force_N", "stress_margin", "band_count"].contains(&name.as_str());
        for (value, line) in values.iter().zip(&lines[1..]) {
            let expected: f64 = line.split(',').nth(at).and_then(|it| it.parse().ok()).expect("a number");
            let same = if exact { *value == expected } else { (value - expected).abs() <= 1e-6 * expected.abs() };
            assert!(same, "{name}: {value}, in the table {expected}");
        }
    }
    // Another seed draws others; none of it is on the page of a study that does not ask.
    write(folder.path(), "other.toml", &changed(&with_sample(), &[("seed = 5", "seed = 6")]));
    ask(folder.path(), "sweep other.toml --out other").text();
    assert_ne!(read(&folder.path().join("other/sample.csv")), table);
    write(folder.path(), "without.toml", SMALL);
    ask(folder.path(), "sweep without.toml --out without").text();
    assert!(data_of(&folder.path().join("without/report.html")).get("sample").is_none());
    assert!(!folder.path().join("without/sample.csv").exists());
}

#[test]
fn shards_draw_the_same_sample() {
    let folder = folder_with("small.toml", &with_sample());
    let line = |line: &str| ask(folder.path(), line).text();
    line("sweep small.toml --out r --threads 1 --no-report");
    line("sweep small.toml --shard 1/3 --out a --tile 100");
    line("sweep small.toml --shard 2/3 --out b");
    line("sweep small.toml --shard 3/3 --out c --threads 3");
    line("merge c a b --out merged --no-report");
    for name in ["sample.csv", "sample.parquet", "front.svg", "summary.json"] {
        let bytes = |directory: &str| std::fs::read(folder.path().join(directory).join(name)).expect("it is there");
        assert_eq!(bytes("merged"), bytes("r"), "{name}");
    }
}

#[test]
fn a_sample_that_was_changed_is_refused() {
    let folder = folder_with("small.toml", &with_sample());
    ask(folder.path(), "sweep small.toml --out r").text();
    let at = folder.path().join("r/sample.csv");
    let good = read(&at);
    let lines: Vec<&str> = good.lines().collect();
    let swapped = [&lines[..1], &[lines[2], lines[1]], &lines[3..]].concat().join("\n");
    let short = lines[..60].join("\n");
    let first: Vec<&str> = lines[1].split(',').collect();
    let elsewhere = good.replacen(lines[1], &[&first[..1], &["19.123"], &first[2..]].concat().join(","), 1);
    for (text, told) in [(swapped, "is not in rising order"), (short, "it has 59 designs"), (elsewhere, "and the study gives")] {
        std::fs::write(&at, text + "\n").expect("it can be written");
        let said = ask(folder.path(), "report r").refusal(2);
        assert!(said.contains("sample.csv") && said.contains(told), "{said}");
    }
    std::fs::remove_file(&at).expect("it was there");
    assert!(ask(folder.path(), "report r").refusal(2).contains("sample.csv is missing from the result"));
}
