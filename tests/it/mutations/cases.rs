//! The cases: studies, tables, result directories and checkpoints are mangled; a case is identified by its kind, a seed and a number.

use super::{mutate, readers};
use crate::random::Random;
use beltspace::models;
use beltspace::reduce::State;
use beltspace::space::Space;
use beltspace::study::Study;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A small study with everything that a result may have.
const FULL: &str = r#"model = "metal-cvt"
title = "Mangled"
[design]
band_thickness_mm = { from = 0.10, to = 0.30, count = 5 }
band_count        = { from = 6, to = 14, step = 4 }
traction          = ["limit", 0.4]
[operation]
ratio     = { from = 0.5, to = 2.0, count = 3, spacing = "log" }
cases     = [{ torque_Nm = 50, friction = 0.08 }, { torque_Nm = "150 Nm", friction = 0.09 }]
[fixed]
strength_MPa = 800
[constraints]
slip_margin   = { above = -1 }
band_count    = { max = 13 }
[objectives]
axial_force_N = { goal = "min", resolution = 10 }
stress_margin = "max"
band_count    = "min"
[report]
columns = ["max_stress_MPa"]
top = { by = "axial_force_N", count = 5 }
sample = { count = 9, seed = 3 }
histograms = [{ of = "axial_force_N", bins = 6 }, { of = "stress_margin", from = -1, to = 1, bins = 4 }]
maps = [
    { x = "band_thickness_mm", y = "band_count", value = "axial_force_N" },
    { x = "band_count", y = "band_thickness_mm", best = "share" },
]
variants = true
"#;

/// One whose map has lines.
const LINES: &str = r#"model = "metal-cvt"
[design]
band_thickness_mm = { from = 0.10, to = 0.30, count = 5 }
groove_angle_deg  = { from = 18, to = 30, count = 4 }
[constraints]
slip_margin = { above = -1 }
[objectives]
axial_force_N = "min"
[report]
maps = [{ x = "band_thickness_mm", y = "groove_angle_deg", value = "axial_force_N", contours = [15500, 16500] }]
"#;

/// One that samples.
const SAMPLED: &str = "model = \"metal-cvt\"\n[sample]\nmethod = \"sobol\"\ncount = 64\nseed = 3\n[design]\n\
                       band_thickness_mm = { from = 0.1, to = 0.4, spacing = \"log\" }\nband_count = { from = 6, to = 14 }\n\
                       [objectives]\naxial_force_N = \"min\"\nslip_margin = \"max\"\n";

/// One with weights, labels and ends of columns.
const SPECTRUM: &str = "model = \"metal-cvt\"\n[design]\nband_thickness_mm = [0.1, 0.15, 0.2]\nband_count = { from = 6, to = 14 }\n\
                        [operation]\nduty = { cases = [{ torque_Nm = 50, time_h = 3 }, { torque_Nm = 90, time_h = 1.5 }, \
                        { torque_Nm = 95, time_h = 0 }], weight = \"time_h\" }\n[uncertainty]\nfriction = [0.07, 0.09]\n[constraints]\n\
                        most = { of = \"axial_force_N\", over_scenarios = \"sum\", max = 1e6 }\n[objectives]\n\
                        mean = { of = \"axial_force_N\", goal = \"min\", over_scenarios = \"mean\" }\nstress_margin = \"max\"\n\
                        [report]\ncolumns = [{ of = \"axial_force_N\", worst = \"lowest\" }]\nvariants = true\n";

const TABLE: &str = "\u{feff}ratio, torque_Nm,friction\r\n0.5,50,0.08\r\n\r\n1,\"60 Nm\",0.08\r\n2,150,9e-2\n2.0,151,0.1\n";

/// The file of a model.
const MODEL: &str = include_str!("../formulas/models/band-brake.toml");
const GRIP: &str = include_str!("../formulas/models/grip.csv");

/// The kinds of what is mangled.
pub const KINDS: [&str; 5] = ["study", "table", "model", "result", "checkpoint"];
/// One that breaks on purpose, by the number of the case.
pub const BITE: &str = "bite";

/// Makes what is mangled later, in a folder.
pub fn prepare(folder: &Path) {
    let sweep = |study: &str, words: &[&str]| {
        fs::write(folder.join("study.toml"), study).expect("it can be written");
        let mut command = Command::new(env!("CARGO_BIN_EXE_beltspace"));
        command.args(["sweep", "study.toml", "--quiet", "--threads", "1", "--engine", "cpu", "--method", "exhaustive"]);
        let output = command.args(words).current_dir(folder).output().expect("the program starts");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    };
    for (study, name) in [(FULL, "full"), (LINES, "lines"), (SAMPLED, "sampled"), (SPECTRUM, "spectrum")] {
        sweep(study, &["--no-report", "--out", &format!("result-{name}")]);
        sweep(study, &["--shard", "1/1", "--out", &format!("checkpoint-{name}-whole")]);
        sweep(study, &["--shard", "1/2", "--out", &format!("checkpoint-{name}-half")]);
    }
    let picture = Path::new(env!("CARGO_MANIFEST_DIR")).join("results");
    let knee = find(&picture, "knee-section.svg").expect("a picture of a knee is committed");
    fs::copy(knee, folder.join("result-full/knee-section.svg")).expect("it can be copied");
}

fn find(folder: &Path, name: &str) -> Option<PathBuf> {
    fs::read_dir(folder).ok()?.flatten().map(|it| it.path()).find_map(|path| match path.is_dir() {
        true => find(&path, name),
        false => (path.file_name()? == name).then_some(path),
    })
}

/// Runs a case; says whether what was mangled was understood all the same. `base` is what [`prepare`] made.
pub fn run(kind: &str, random: &mut Random, number: u64, base: &Path) -> bool {
    let folder = tempfile::tempdir().expect("there is room");
    match kind {
        "study" => {
            let text = study(random);
            readers::study(&String::from_utf8_lossy(&text), folder.path())
        }
        "table" => {
            let text = if random.chance(0.5) { mutate::table(random, TABLE).into_bytes() } else { TABLE.as_bytes().to_vec() };
            let gently = random.chance(0.5);
            let text = if gently { mutate::numbers(random, &text) } else { mutate::bytes(random, &text, FULL.as_bytes()) };
            readers::table(&text, folder.path())
        }
        "model" => {
            let gently = random.chance(0.5);
            let text =
                if gently { mutate::numbers(random, MODEL.as_bytes()) } else { mutate::bytes(random, MODEL.as_bytes(), FULL.as_bytes()) };
            fs::write(folder.path().join("grip.csv"), GRIP).expect("it can be written");
            readers::model(&text, folder.path())
        }
        "result" => {
            copy(
                &base.join(["result-full", "result-full", "result-lines", "result-sampled", "result-spectrum"][random.below(5)]),
                folder.path(),
            );
            result(random, folder.path());
            readers::result(folder.path())
        }
        "checkpoint" => {
            let (name, part) = (random.pick(&["full", "full", "lines", "sampled", "spectrum"]), random.pick(&["whole", "half"]));
            copy(&base.join(format!("checkpoint-{name}-{part}")), folder.path());
            checkpoint(random, &folder.path().join("checkpoint"));
            readers::checkpoint(folder.path())
        }
        BITE => {
            bite(number);
            true
        }
        other => panic!("there is no kind {other}"),
    }
}

/// What a reader must not do, to test that the harness notices it.
fn bite(number: u64) {
    match number {
        1 => panic!("a reader panics"),
        2 => loop {
            std::thread::sleep(std::time::Duration::from_millis(10));
        },
        3 => {
            let bytes = vec![1u8; std::hint::black_box(3 << 30)];
            assert!(std::hint::black_box(&bytes).iter().all(|&it| it == 1));
        }
        4 => std::process::exit(0),
        _ => {}
    }
}

/// A study text: those of the models, and some with what studies have besides.
fn study(random: &mut Random) -> Vec<u8> {
    let base = match random.below(7) {
        0 | 1 => FULL,
        2 => LINES,
        3 => SAMPLED,
        4 => SPECTRUM,
        _ => &models::all()[random.below(models::all().len())].starter,
    };
    let other = &models::all()[random.below(models::all().len())].starter;
    if random.chance(0.5) {
        return mutate::numbers(random, base.as_bytes());
    }
    mutate::bytes(random, base.as_bytes(), other.as_bytes())
}

/// Mangles a file of a result; in half of the cases so that seals do not give it away.
fn result(random: &mut Random, folder: &Path) {
    let mut names: Vec<PathBuf> = fs::read_dir(folder).expect("it can be listed").flatten().map(|it| it.path()).collect();
    names.sort();
    let path = match random.below(4) {
        0 => folder.join("study.json"),
        1 => folder.join("summary.json"),
        _ => names[random.below(names.len())].clone(),
    };
    let whole = fs::read(&path).expect("it can be read");
    let extension = path.extension().and_then(|it| it.to_str()).unwrap_or_default();
    let changed = match extension {
        "json" if random.chance(0.8) => {
            let mut value: Value = serde_json::from_slice(&whole).expect("it was written as JSON");
            mutate::json(random, &mut value);
            value.to_string().into_bytes()
        }
        "csv" if random.chance(0.7) => mutate::table(random, &String::from_utf8_lossy(&whole)).into_bytes(),
        _ => mutate::bytes(random, &whole, FULL.as_bytes()),
    };
    fs::write(&path, &changed).expect("it can be written");
    if path.ends_with("study.json") && random.chance(0.8) {
        let Ok(described) = serde_json::from_slice::<Value>(&changed) else { return };
        let summary = folder.join("summary.json");
        let mut sealed: Value = serde_json::from_slice(&fs::read(&summary).expect("it is there")).expect("it is JSON");
        // The same hash that the study has, if it is one.
        let Ok(study) = Study::from_description(&described) else { return };
        sealed["study_hash"] = study.hash().into();
        let space = Space::new(&study);
        if random.chance(0.8) {
            (sealed["designs"], sealed["scenarios"]) = (space.designs.count().into(), space.scenarios.count().into());
            (sealed["title"], sealed["model"]) = (study.title.clone().into(), study.model.name.clone().into());
        }
        fs::write(summary, sealed.to_string()).expect("it can be written");
        // A text that names a table which is elsewhere is not held against the description.
        fs::write(folder.join("study.toml"), "cases = { csv = \"elsewhere.csv\" }").expect("it can be written");
    }
}

/// Mangles a manifest or the state that belongs to it, and seals what came of it.
fn checkpoint(random: &mut Random, folder: &Path) {
    let path = folder.join("manifest.json");
    let mut sealed: Value = serde_json::from_slice(&fs::read(&path).expect("it is there")).expect("it is JSON");
    let manifest = &mut sealed["manifest"];
    let state = folder.join(manifest["state"][0].as_str().expect("there is a state"));
    match random.below(8) {
        0 => mutate::json(random, manifest),
        1 => mutate::json(random, &mut manifest["done"]),
        2..=4 => {
            mutate::json(random, &mut manifest["description"]);
            if let Ok(study) = Study::from_description(&manifest["description"]) {
                manifest["study_hash"] = study.hash().into();
                manifest["designs"] = Space::new(&study).designs.count().into();
            }
        }
        5 => {
            let bytes = fs::read(&state).expect("it is there");
            let mut value = serde_json::to_value(postcard::from_bytes::<State>(&bytes).expect("it was written so")).expect("it is finite");
            mutate::json(random, &mut value);
            let changed = serde_json::from_value::<State>(value).ok().and_then(|it| postcard::to_stdvec(&it).ok());
            changed.into_iter().for_each(|it| reseal(manifest, &state, &it));
        }
        _ => {
            let bytes = fs::read(&state).expect("it is there");
            let changed = mutate::bytes(random, &bytes, &bytes);
            reseal(manifest, &state, &changed);
        }
    }
    if random.chance(0.95) {
        sealed["checksum"] = json!(crc32fast::hash(sealed["manifest"].to_string().as_bytes()));
    }
    let text = sealed.to_string().into_bytes();
    let text = if random.chance(0.05) { mutate::bytes(random, &text, FULL.as_bytes()) } else { text };
    fs::write(path, text).expect("it can be written");
}

fn reseal(manifest: &mut Value, state: &Path, bytes: &[u8]) {
    fs::write(state, bytes).expect("it can be written");
    manifest["state"][1] = crc32fast::hash(bytes).into();
}

fn copy(from: &Path, to: &Path) {
    for entry in fs::read_dir(from).expect("it can be listed").flatten() {
        let (path, goal) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() {
            fs::create_dir_all(&goal).expect("folders can be made");
            copy(&path, &goal);
        } else {
            fs::copy(&path, &goal).expect("files can be copied");
        }
    }
}
