//! The program as people run it: exit codes, messages, files, and what a killed run leaves behind.

/// The budget of a front.
mod budget;
/// Catalogues: labels, columns that nothing uses, presets as an axis.
mod catalogues;
/// Checkpoints and shards that must not be used.
mod checkpoints;
/// Contours of maps, compared with the models.
mod contours;
/// Every feasible design.
mod feasible;
/// Studies with formulas.
mod formulas;
/// Files that were changed, and things that are not files.
mod mangled;
/// Judging every design, or bounding boxes of them.
mod method;
/// `models` and `eval`.
mod models_and_eval;
/// Names of columns.
mod names;
/// Which process uses a directory, and which files in it are beltspace's.
mod ownership;
/// The page of a result.
mod presets;
/// Interrupted, divided and resumed runs.
mod recovery;
mod report;
/// Rows of a table, evaluated one by one.
mod rows;
/// A sample of the feasible designs.
mod sample;
/// `sensitivity` in `[report]`.
mod sensitivity;
/// Values in place of what a study says.
mod set;
/// Scripts for a cluster, run by programs that imitate its scheduler.
#[cfg(unix)]
mod slurm;
/// `check`, `sweep` and the result directory.
mod sweep;
/// Wrong requests.
mod wrong_requests;

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;
use tempfile::TempDir;

/// A study with everything that a result may have, swept in a moment.
const SMALL: &str = r#"model = "metal-cvt"
title = "Small"
[design]
groove_angle_deg  = { from = 18, to = 30, count = 13 }
band_thickness_mm = { from = 0.10, to = 0.30, count = 21 }
band_count        = { from = 6, to = 14 }
traction          = { from = 0.30, to = 0.50, count = 5 }
[operation]
ratio     = { from = 0.5, to = 2.0, count = 3, spacing = "log" }
torque_Nm = [50, 150]
[uncertainty]
friction  = [0.065, 0.095]
[fixed]
strength_MPa = 800
[constraints]
slip_margin   = { min = 0 }
stress_margin = { max = 0.95, min = 0 }
[objectives]
axial_force_N = "min"
stress_margin = "max"
band_count    = "min"
[report]
columns = ["max_stress_MPa"]
top = { by = "axial_force_N", count = 20 }
histograms = [{ of = "axial_force_N", bins = 40 }]
maps = [
    { x = "band_thickness_mm", y = "groove_angle_deg", value = "axial_force_N" },
    { x = "band_thickness_mm", y = "band_count", best = "share" },
]
"#;

/// The same on a grid that takes seconds: some 60 ms of one core for each level of traction.
fn larger(levels: u32) -> String {
    let traction = format!("to = 0.50, count = {levels}");
    let finer = [
        ("to = 30, count = 13", "to = 30, count = 241"),
        ("to = 0.30, count = 21", "to = 0.30, count = 161"),
        ("to = 0.50, count = 5", traction.as_str()),
        ("[0.065, 0.095]", "[0.065, 0.075, 0.085, 0.095]"),
        ("\"Small\"", "\"Large\""),
    ];
    changed(SMALL, &finer)
}

/// Large enough to be interrupted many times.
fn large() -> String {
    larger(41)
}

/// A study with some texts replaced, all of which must be there.
fn changed(study: &str, edits: &[(&str, &str)]) -> String {
    edits.iter().fold(study.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "the study has no {from}");
        text.replace(from, to)
    })
}

/// How a command ended.
#[derive(Debug)]
struct Answer {
    code: Option<i32>,
    out: String,
    err: String,
}

impl From<Output> for Answer {
    fn from(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).expect("the program writes UTF-8");
        Self { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
    }
}

impl Answer {
    /// What was printed by a command that must have succeeded.
    #[track_caller]
    fn text(self) -> String {
        assert_eq!(self.code, Some(0), "{}{}", self.out, self.err);
        self.out
    }

    /// The same as JSON.
    #[track_caller]
    fn json(self) -> serde_json::Value {
        serde_json::from_str(&self.text()).expect("--json prints JSON")
    }

    /// The message of a command that must have failed with `code` and printed no result.
    #[track_caller]
    fn refusal(self, code: i32) -> String {
        assert_eq!((self.code, self.out.as_str()), (Some(code), ""), "{}", self.err);
        self.err
    }
}

/// The program, in a folder, with nothing to read.
fn program(folder: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_beltspace"));
    command.args(words).current_dir(folder).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Runs the program with the words given.
fn ask_words(folder: &Path, words: &[&str]) -> Answer {
    program(folder, words).output().expect("the program starts").into()
}

/// Runs the program with the words of a line.
fn ask(folder: &Path, line: &str) -> Answer {
    ask_words(folder, &line.split_whitespace().collect::<Vec<_>>())
}

/// A folder with a file of this text.
fn folder_with(name: &str, text: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("there is room for temporary folders");
    write(folder.path(), name, text);
    folder
}

fn write(folder: &Path, name: &str, text: &str) {
    std::fs::write(folder.join(name), text).expect("temporary files can be written");
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn json_of(path: &Path) -> serde_json::Value {
    serde_json::from_str(&read(path)).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The files of a folder by name; a folder in it counts as a file of its own kind.
type Files = BTreeMap<String, Option<Vec<u8>>>;

fn files(folder: &Path) -> Files {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let read = |entry: std::io::Result<std::fs::DirEntry>| {
        let path = entry.expect("the folder can be listed").path();
        let name = path.file_name().expect("entries have names").to_string_lossy().into_owned();
        (name, (!path.is_dir()).then(|| std::fs::read(&path).expect("temporary files can be read")))
    };
    entries.map(read).collect()
}

/// Are these the same result? `run.json` and the page, which describe the run, may differ, but must be there.
fn same_result(a: &Files, b: &Files) -> Result<(), String> {
    let mut problems = Vec::new();
    for name in a.keys().chain(b.keys().filter(|name| !a.contains_key(*name))) {
        match (a.get(name), b.get(name)) {
            (Some(Some(_)), Some(Some(_))) if name == "run.json" || name == "report.html" => {}
            (Some(Some(a)), Some(Some(b))) if a == b => {}
            (Some(Some(a)), Some(Some(b))) => {
                let at = a.iter().zip(b).position(|(a, b)| a != b).unwrap_or(a.len().min(b.len()));
                problems.push(format!("{name} differs at byte {at}"));
            }
            (Some(None), _) | (_, Some(None)) => problems.push(format!("{name} is a folder")),
            (None, _) => problems.push(format!("{name} is only in the second")),
            (_, None) => problems.push(format!("{name} is only in the first")),
        }
    }
    for (files, which) in [(a, "first"), (b, "second")] {
        if !files.contains_key("summary.json") || !files.contains_key("run.json") {
            problems.push(format!("the {which} is not a finished result"));
        }
    }
    if problems.is_empty() { Ok(()) } else { Err(problems.join("; ")) }
}

/// The files of one undisturbed run of [`SMALL`].
fn small_result() -> &'static Files {
    static FILES: OnceLock<Files> = OnceLock::new();
    FILES.get_or_init(|| plain_run(SMALL))
}

/// The files of one undisturbed run of [`large`].
fn large_result() -> &'static Files {
    static FILES: OnceLock<Files> = OnceLock::new();
    FILES.get_or_init(|| plain_run(&large()))
}

fn plain_run(study: &str) -> Files {
    let folder = folder_with("study.toml", study);
    ask(folder.path(), "sweep study.toml --out plain").text();
    files(&folder.path().join("plain"))
}

/// A CSV file.
struct Csv {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Csv {
    fn read(path: &Path) -> Self {
        let mut reader = csv::Reader::from_path(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let header = reader.headers().expect("a table has a header").iter().map(str::to_owned).collect();
        let rows = reader.records().map(|row| row.expect("rows are as long as the header").iter().map(str::to_owned).collect()).collect();
        Self { header, rows }
    }

    /// The cells of a column.
    #[track_caller]
    fn column(&self, name: &str) -> Vec<&str> {
        let at = self.header.iter().position(|it| it == name).unwrap_or_else(|| panic!("no column {name} in {:?}", self.header));
        self.rows.iter().map(|row| row[at].as_str()).collect()
    }

    /// The numbers of a column without empty cells.
    #[track_caller]
    fn numbers(&self, name: &str) -> Vec<f64> {
        self.column(name).iter().map(|cell| cell.parse().unwrap_or_else(|_| panic!("{name} has the cell \"{cell}\""))).collect()
    }
}

#[test]
fn the_comparison_of_results_sees_a_changed_byte_and_a_missing_file() {
    let good = small_result();
    assert_eq!(same_result(good, good), Ok(()));
    let spoilt = |spoil: fn(&mut Files)| {
        let mut other = good.clone();
        spoil(&mut other);
        assert!(same_result(&other, good).is_err(), "it must object whichever comes first");
        same_result(good, &other).expect_err("the checker must object")
    };
    let byte = spoilt(|files| {
        let bytes = files.get_mut("front.csv").and_then(Option::as_mut).expect("there is a front");
        bytes[40] ^= 1;
    });
    assert_eq!(byte, "front.csv differs at byte 40");
    let cut = spoilt(|files| {
        let bytes = files.get_mut("top.csv").and_then(Option::as_mut).expect("there is a top list");
        bytes.pop();
    });
    assert!(cut.starts_with("top.csv differs at byte"), "{cut}");
    assert_eq!(spoilt(|files| drop(files.remove("front.parquet"))), "front.parquet is only in the first");
    assert_eq!(spoilt(|files| drop(files.insert(".x.writing".to_owned(), Some(Vec::new())))), ".x.writing is only in the second");
    assert_eq!(spoilt(|files| drop(files.insert("checkpoint".to_owned(), None))), "checkpoint is a folder");
    assert!(spoilt(|files| drop(files.remove("run.json"))).ends_with("the second is not a finished result"));
    let mut other = good.clone();
    other.insert("run.json".to_owned(), Some(b"other".to_vec()));
    assert_eq!(same_result(good, &other), Ok(()), "run.json may differ");
}
