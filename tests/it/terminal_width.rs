//! What commands print in a terminal of 80 columns: no line of a table or a sentence is wider. `script` (Debian: bsdutils) makes the
//! terminal.

use std::fs;
use std::path::Path;
use std::process::Command;

const WIDTH: usize = 80;

/// What a command prints on a terminal, without colours, progress and what it says of paths.
fn in_terminal(folder: &Path, columns: usize, words: &str) -> String {
    let program = env!("CARGO_BIN_EXE_beltspace");
    let line = format!("stty rows 24 cols {columns} && '{program}' {words} 2> errors");
    let output = Command::new("script").args(["-qec", &line, "/dev/null"]).current_dir(folder).output().expect("script is there");
    let errors = fs::read_to_string(folder.join("errors")).expect("a file");
    assert!(output.status.success(), "{words}: {} {errors}", String::from_utf8_lossy(&output.stdout));
    console::strip_ansi_codes(&String::from_utf8(output.stdout).expect("text")).replace('\r', "")
}

/// Lines that are wider than the terminal, but for those that hold a word that is too wide itself, as a path may be.
fn too_wide(text: &str) -> Vec<String> {
    let wide = text.lines().filter(|line| console::measure_text_width(line) > WIDTH);
    wide.filter(|line| line.split_whitespace().all(|word| word.len() < WIDTH - 10)).map(str::to_owned).collect()
}

/// What a command says on standard error where that is a terminal.
fn said_in_terminal(folder: &Path, columns: usize, words: &str) -> String {
    let program = env!("CARGO_BIN_EXE_beltspace");
    let line = format!("stty rows 24 cols {columns} && '{program}' {words} > told");
    let output = Command::new("script").args(["-qec", &line, "/dev/null"]).current_dir(folder).output().expect("script is there");
    assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stdout));
    console::strip_ansi_codes(&String::from_utf8(output.stdout).expect("text")).replace('\r', "")
}

#[test]
#[ignore = "needs a terminal: cargo test --test it -- --ignored terminal_width"]
fn notes_are_no_wider_than_the_terminal() {
    let folder = tempfile::tempdir().expect("there is room");
    let folder = folder.path();
    fs::write(folder.join("grooves.csv"), "band_count,where_it_was_found\n8,here\n9,there\n").expect("it can be written");
    let study =
        "model = \"metal-cvt\"\n[design]\ncases = { csv = \"grooves.csv\", unused = \"ok\" }\n[objectives]\nmax_stress_MPa = \"min\"\n";
    fs::write(folder.join("study.toml"), study).expect("it can be written");
    let words = "sweep study.toml --out r --force";
    let note = |columns| {
        let said = said_in_terminal(folder, columns, words);
        let begin = said.find("note: ").unwrap_or_else(|| panic!("no note: {said}"));
        // Behind it the line of the progress is drawn over and over.
        let end = said[begin..].find("out").unwrap_or_else(|| panic!("half a note: {said}"));
        said[begin..begin + end + "out".len()].to_owned()
    };
    let (wide, narrow) = (note(300), note(60));
    assert!(wide.lines().next().is_some_and(|line| line.len() > 60), "{wide}");
    assert!(narrow.lines().all(|line| console::measure_text_width(line) <= 60), "{narrow}");
    // No word is lost.
    assert_eq!(narrow.split_whitespace().collect::<Vec<_>>(), wide.split_whitespace().collect::<Vec<_>>());
}

const STUDY: &str = r#"model = "metal-cvt"
title = "A push belt with a title that is longer than a terminal is wide, so that it has to be broken between its words"
[design]
groove_angle_deg = { from = 18, to = 30, count = 7 }
band_count = { from = 6, to = 14 }
[operation]
ratio = { from = 0.5, to = 2.0, count = 9, spacing = "log" }
torque_Nm = [50, 150]
[fixed]
strength_MPa = 800
[formulas]
clamping_force_N = "1.4 * torque_Nm * (1 + ratio) / (2 * 47.9[mm]) * cos(groove_angle_deg / 2) / (2 * 0.08)"
[constraints]
clamping_utilisation = { max = 0.909 }
driver_axial_force_upper_N = { max = 75000 }
[objectives]
driver_axial_force_upper_N = "min"
driven_axial_force_upper_N = "min"
stress_margin = "max"
torque_coefficient_N_per_mm = "max"
band_count = "min"
"#;

#[test]
#[ignore = "needs a terminal: cargo test --test it -- --ignored terminal_width"]
fn nothing_is_wider_than_the_terminal() {
    let folder = tempfile::tempdir().expect("there is room");
    let folder = folder.path();
    fs::write(folder.join("study.toml"), STUDY).expect("it can be written");
    let commands = [
        "sweep study.toml --out r",
        "check study.toml",
        "eval study.toml --design 3",
        "eval metal-cvt",
        "eval pulley-load",
        "models",
        "models metal-cvt",
        "models rubber-cvt",
        "models timing-belt",
        "models flat-belt",
        "adapters",
        "sensitivity study.toml --over design --out s",
        "reproduce --out papers",
        "sweep study.toml --shard 1/2 --out a",
        "sweep study.toml --shard 2/2 --out b",
        "merge a b --out ab",
        "report r",
        "slurm study.toml --cpus 2 --shards 2",
        "eval study.toml --design 3 --scenario 1",
        "models pulley",
        "models pulley-load",
        "check yields.toml",
        "sweep yields.toml --out y",
        "sweep none.toml --out n",
        "sweep study.toml --method bounds --out m",
        "export study.toml --help",
    ];
    let helps: Vec<String> = [
        "",
        "models ",
        "eval ",
        "export ",
        "check ",
        "sweep ",
        "explore ",
        "sensitivity ",
        "merge ",
        "slurm ",
        "report ",
        "verify ",
        "adapters ",
        "reproduce ",
        "schema ",
        "man ",
        "completions ",
    ]
    .iter()
    .map(|it| format!("{it}--help"))
    .collect();
    fs::write(folder.join("none.toml"), STUDY.replace("max = 75000", "max = 75")).expect("it can be written");
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/push-belt-yield.toml");
    fs::copy(shipped, folder.join("yields.toml")).expect("it can be copied");
    let verify = if in_terminal(folder, WIDTH, "adapters").contains("passed") { &["verify metal-cvt --samples 2000"][..] } else { &[] };
    if verify.is_empty() {
        eprintln!("verify: NOT RUN, there is no adapter");
    }
    for words in commands.iter().chain(verify).copied().chain(helps.iter().map(String::as_str)) {
        let text = in_terminal(folder, WIDTH, words);
        assert!(!text.trim().is_empty(), "{words}");
        assert_eq!(too_wide(&text), Vec::<String>::new(), "{words}");
    }
    // In a wide terminal nothing is broken, and a pipe gets what it always got.
    let wide = in_terminal(folder, 600, "models metal-cvt");
    assert!(!too_wide(&wide).is_empty(), "a line that is too wide would go unseen");
    let piped = Command::new(env!("CARGO_BIN_EXE_beltspace")).args(["models", "metal-cvt"]).output().expect("it runs").stdout;
    assert_eq!(wide.trim_end(), String::from_utf8(piped).expect("text").trim_end());
    // No word is lost where lines are broken.
    let words = |text: &str| {
        let mut words: Vec<String> = text.split_whitespace().map(str::to_owned).collect();
        words.sort_unstable();
        words
    };
    assert_eq!(words(&in_terminal(folder, WIDTH, "models metal-cvt")), words(&wide));
}
