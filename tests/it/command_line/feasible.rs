//! `sweep --feasible`: every feasible design, whoever judges it.

use super::report::data_of;
use super::{SMALL, ask, changed, files, folder_with, json_of, larger, program, read, same_result, write};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use std::path::Path;
use std::time::Duration;

/// A Parquet table: its columns, and its cells as CSV has them.
pub fn parquet(path: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let reader = SerializedFileReader::new(std::fs::File::open(path).expect("it is there")).expect("it is Parquet");
    let names = reader.metadata().file_metadata().schema().get_fields().iter().map(|it| it.name().to_owned()).collect();
    let cell = |field: &Field| match field {
        Field::Null => String::new(),
        Field::Double(value) => format!("{value}"),
        Field::Str(text) => text.clone(),
        other => other.to_string(),
    };
    let rows = reader.get_row_iter(None).expect("it has rows");
    (names, rows.map(|row| row.expect("a row").get_column_iter().map(|(_, field)| cell(field)).collect()).collect())
}

/// A study small enough for a list of all designs.
fn listed() -> String {
    changed(SMALL, &[("to = 30, count = 13", "to = 30, count = 5"), ("[report]\n", "[report]\nvariants = true\n")])
}

#[test]
fn it_has_what_the_list_of_all_designs_calls_feasible() {
    let folder = folder_with("study.toml", &listed());
    let at = folder.path();
    let said = ask(at, "sweep study.toml --feasible --out r");
    assert_eq!(said.err, "note: feasible.parquet, at most 4725 designs x 136 bytes = 1 MB\n");
    said.text();
    let (names, rows) = parquet(&at.join("r/feasible.parquet"));
    let variants = read(&at.join("r/variants.csv"));
    let mut lines = variants.lines();
    assert_eq!(format!("{},feasible", names.join(",")), lines.next().expect("it has a header"));
    let expected: Vec<&str> = lines.filter_map(|line| line.strip_suffix(",yes")).collect();
    let count = json_of(&at.join("r/summary.json"))["feasible"].as_u64().expect("a count");
    assert_eq!((rows.len(), rows.len() as u64), (expected.len(), count));
    for (row, line) in rows.iter().zip(expected) {
        assert_eq!(row.join(","), line);
    }
    let data = data_of(&at.join("r/report.html"));
    assert_eq!(data["feasible_file"], "feasible.parquet");
    let text = data["study"]["text"].as_str().expect("the page has the study");
    assert!(text.ends_with("\nfeasible = true\n"), "{text}");
    // Its key in the study asks for the same, and a study without it has none.
    ask(at, "sweep r/study.toml --out by-key --no-report").text();
    ask(at, "sweep study.toml --out without").text();
    let bytes = |name: &str| std::fs::read(at.join(name).join("feasible.parquet")).ok();
    assert_eq!(bytes("by-key"), bytes("r"));
    assert_eq!(bytes("without"), None);
    assert!(
        !read(&at.join("without/study.json")).contains("\"feasible\"")
            && data_of(&at.join("without/report.html")).get("feasible_file").is_none()
    );
    std::fs::remove_file(at.join("r/feasible.parquet")).expect("it was there");
    assert!(ask(at, "report r").refusal(2).contains("feasible.parquet is missing from the result"));
}

#[test]
fn it_is_the_same_in_tiles_and_shards_and_by_any_engine() {
    let folder = folder_with("study.toml", SMALL);
    let at = folder.path();
    let line = |line: &str| ask(at, line).text();
    line("sweep study.toml --feasible --out r --threads 1 --engine cpu --quiet");
    let plain = files(&at.join("r"));
    assert!(plain.contains_key("feasible.parquet"));
    let same = |name: &str| same_result(&files(&at.join(name)), &plain).unwrap_or_else(|problem| panic!("{name}: {problem}"));
    line("sweep study.toml --feasible --out tiles --tile 7 --threads 3 --engine cpu --quiet");
    same("tiles");
    for shard in 1..=3 {
        line(&format!("sweep study.toml --feasible --shard {shard}/3 --out s{shard} --tile 100 --quiet"));
    }
    line("merge s3 s1 s2 --out merged --quiet");
    same("merged");
    #[cfg(feature = "gpu")]
    {
        line("sweep study.toml --feasible --out device --engine gpu --quiet");
        same("device");
    }
}

#[test]
fn a_run_that_was_killed_goes_on_to_the_same_file() {
    let study = larger(3);
    let folder = folder_with("study.toml", &study);
    let at = folder.path();
    ask(at, "sweep study.toml --feasible --out plain --engine cpu --no-report --quiet").text();
    let mut killed = 0;
    for _ in 0..40 {
        let words = "sweep study.toml --feasible --out r --engine cpu --threads 1 --tile 500 --no-report --quiet --resume";
        let mut child = program(at, &words.split_whitespace().collect::<Vec<_>>()).spawn().expect("the program starts");
        std::thread::sleep(Duration::from_millis(250));
        let ended = child.try_wait().expect("it can be asked").is_some();
        let _ = child.kill();
        child.wait().expect("it can be waited for");
        if ended {
            break;
        }
        killed += 1;
    }
    ask(at, "sweep study.toml --feasible --out r --engine cpu --no-report --quiet --resume").text();
    assert!(killed > 0, "the run was too short to be killed");
    same_result(&files(&at.join("r")), &files(&at.join("plain"))).expect("it is the same");
}

#[test]
fn what_cannot_give_it_says_so() {
    let plain = "model = \"metal-cvt\"\n[design]\nband_count = [6, 9]\ngroove_angle_deg = { from = 18, to = 30, count = 61 }\n[objectives]\naxial_force_N = \"min\"\n";
    let folder = folder_with("study.toml", plain);
    let at = folder.path();
    ask(at, "sweep study.toml --method bounds --out b --quiet").text();
    let said = ask(at, "sweep study.toml --method bounds --feasible --out r").refusal(2);
    assert_eq!(
        said,
        "error: --method bounds cannot serve this study: feasible in [report] asks for every feasible design; use --method exhaustive, \
         or change the study\n"
    );
    let checked = ask(at, "check study.toml --feasible").text();
    assert!(checked.contains("\nfeasible file  feasible.parquet, at most 122 designs x 40 bytes = 1 MB\n"), "{checked}");
    write(at, "study.toml", &changed(plain, &[("count = 61", "count = 61_000_000")]));
    for command in ["check", "sweep"] {
        let said = ask(at, &format!("{command} study.toml --feasible")).refusal(2);
        let told = "this study has 122000000 designs; all feasible ones are written of at most 100000000: use a sample of them (sample = 100000), or fewer levels";
        assert_eq!(said, format!("error: --feasible: {told}\n"));
    }
}
