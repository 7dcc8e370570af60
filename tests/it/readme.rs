//! The README and the pages of `docs/manual/` show what the program prints; only times may differ.

use beltspace::models;
use serde_json::Value;
use std::path::Path;
use std::process::Command;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Lines that a stranger reads first.
const MOST_LINES: usize = 250;

/// The README and the pages of the manual, with their paths.
fn pages() -> Vec<(String, String)> {
    let manual = std::fs::read_dir(root().join("docs/manual")).expect("there is a manual").map(|entry| entry.expect("a file").file_name());
    let mut paths: Vec<String> = manual.map(|name| format!("docs/manual/{}", name.to_string_lossy())).collect();
    paths.sort();
    paths.insert(0, "README.md".to_owned());
    let page = |path: String| {
        let text = std::fs::read_to_string(root().join(&path)).expect("text");
        (path, text)
    };
    paths.into_iter().map(page).collect()
}

/// All of them in one text.
fn readme() -> String {
    pages().into_iter().map(|(_, text)| text).collect::<Vec<_>>().join("\n\n")
}

/// The targets of the links of a text outside its blocks, without what stands in the network.
fn links(text: &str) -> Vec<String> {
    let prose: String = text.split("```").step_by(2).collect();
    let targets = prose.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target.to_owned());
    targets.filter(|target| !target.starts_with("https://")).collect()
}

/// A link that leads to nothing, if there is one.
fn lost_link(path: &str, text: &str) -> Option<String> {
    let folder = Path::new(path).parent().expect("a file is in a folder");
    links(text).into_iter().find(|target| !root().join(folder).join(target.split('#').next().unwrap_or_default()).exists())
}

#[test]
fn the_readme_is_short_and_leads_to_every_page() {
    let pages = pages();
    let (_, readme) = &pages[0];
    assert!(readme.lines().count() <= MOST_LINES, "the README has {} lines", readme.lines().count());
    for (path, text) in &pages {
        assert_eq!(lost_link(path, text), None, "{path}");
        assert!(path == "README.md" || links(readme).contains(path), "the README does not lead to {path}");
        assert!(text.split("```").count() % 2 == 1, "{path}: a block has no end");
    }
    assert_eq!(lost_link("docs/manual/x.md", "[a](../python.md) [b](papers.md) [c](nowhere.md)"), Some("nowhere.md".to_owned()));
}

fn run(arguments: &[&str]) -> (String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_beltspace")).args(arguments).current_dir(root()).output().expect("the program starts");
    (String::from_utf8(output.stdout).expect("text"), String::from_utf8(output.stderr).expect("text"))
}

/// Lines without those that tell a time or a place.
fn without_times(text: &str) -> Vec<&str> {
    text.lines()
        .filter(|line| !line.starts_with("designs ") && !line.starts_with("result ") && !line.starts_with("page "))
        .map(str::trim_end)
        .collect()
}

/// The fenced block of one of the pages that starts with this line.
fn block(start: &str) -> String {
    let readme = readme();
    let after = readme.split("```").find(|block| block.lines().nth(1) == Some(start));
    let block = after.unwrap_or_else(|| panic!("no page has a block that starts with: {start}"));
    block.lines().skip(2).collect::<Vec<_>>().join("\n")
}

#[test]
fn the_first_commands_work_in_an_empty_folder() {
    let folder = tempfile::tempdir().expect("a temporary directory");
    let shown = block("$ beltspace models metal-cvt --study > my-belt.toml");
    let (first, rest) = ("models metal-cvt --study", shown.lines().collect::<Vec<_>>());
    assert_eq!(rest, ["$ beltspace check my-belt.toml", "$ beltspace sweep my-belt.toml"]);
    std::fs::write(folder.path().join("my-belt.toml"), run(&first.split(' ').collect::<Vec<_>>()).0).expect("it can be written");
    for command in rest {
        let words = command.trim_start_matches("$ beltspace ").split(' ');
        let output = Command::new(env!("CARGO_BIN_EXE_beltspace")).args(words).current_dir(folder.path()).output().expect("it starts");
        assert!(output.status.success(), "{command}: {}", String::from_utf8_lossy(&output.stderr));
    }
    assert!(folder.path().join("results/my-belt/report.html").is_file());
}

#[test]
fn the_session_is_what_the_program_prints() {
    let out = tempfile::tempdir().expect("a temporary directory");
    let (printed, _) =
        run(&["sweep", "studies/metal-cvt.toml", "--out", out.path().join("my-belt").to_str().expect("a path of characters")]);
    let shown = block("$ beltspace sweep studies/metal-cvt.toml --out my-belt");
    assert_eq!(without_times(&shown), without_times(&printed));
}

#[test]
fn the_jobs_are_what_the_program_writes() {
    let out = tempfile::tempdir().expect("a temporary directory");
    let study = out.path().join("fine.toml");
    let readme = readme();
    let finer = readme.lines().find(|line| line.starts_with("$ sed ") && line.ends_with(" > fine.toml")).expect("it makes a study");
    let words: Vec<&str> = finer.split('\'').collect();
    let [from, to] = [1, 2].map(|at| words[1].split('/').nth(at).expect("sed replaces"));
    let coarse = std::fs::read_to_string(root().join("studies/metal-grid.toml")).expect("the study is shipped");
    assert!(coarse.contains(from), "{finer}");
    std::fs::write(&study, coarse.replace(from, to)).expect("it can be written");
    let [study, result] = [study, out.path().join("fine")].map(|it| it.display().to_string());
    let (printed, _) = run(&["slurm", &study, "--out", &result, "--cpus", "2", "--", "--method", "exhaustive"]);
    let shown = block(finer);
    let shown =
        shown.strip_prefix("$ beltspace slurm fine.toml --cpus 2 -- --method exhaustive\n").and_then(|it| it.split_once("\n$ bash "));
    let (shown, _) = shown.expect("the block shows both commands");
    // How long it takes decides how many there are and what they ask for; where they are is ours.
    let words = |text: &str| -> Vec<String> {
        let measured = ["shards ", "asks for ", "jobs ", "result ", "submit with:"];
        let word = |line: &str| measured.iter().find(|it| line.starts_with(**it)).map_or(line.to_owned(), |it| (*it).to_owned());
        text.trim_end().lines().map(word).collect()
    };
    assert_eq!(words(shown), words(&printed));
}

#[test]
fn the_evaluation_is_what_the_program_prints() {
    let (printed, note) = run(&["eval", "timing-belt"]);
    let shown = block("$ beltspace eval timing-belt --profile teeth.csv --plot teeth.svg");
    assert_eq!(without_times(&shown), without_times(&printed));
    assert!(note.contains("tight_tension alone"), "{note}");
}

#[test]
fn the_pulley_is_what_the_program_prints() {
    let (printed, note) = run(&["eval", "pulley"]);
    let shown = block("$ beltspace eval pulley | sed -n '/^outputs/,$p'");
    let outputs = printed.lines().skip_while(|line| *line != "outputs").collect::<Vec<_>>().join("\n");
    assert_eq!(without_times(&shown), without_times(&outputs));
    assert!(note.contains("the largest stress stands near check point Fl"), "{note}");
}

#[test]
fn the_study_is_the_shipped_one() {
    let study = std::fs::read_to_string(root().join("studies/metal-cvt.toml")).expect("the study is shipped");
    assert!(readme().contains(study.trim_end()), "the README shows another studies/metal-cvt.toml");
}

#[test]
fn the_errors_are_what_the_program_says_of_the_broken_study() {
    let folder = tempfile::tempdir().expect("a temporary directory");
    let broken = block("$ cat my.toml");
    let (study, said) = broken.split_once("$ beltspace check my.toml\n").expect("the block shows file and check");
    std::fs::write(folder.path().join("my.toml"), study).expect("the study can be written");
    let output =
        Command::new(env!("CARGO_BIN_EXE_beltspace")).args(["check", "my.toml"]).current_dir(folder.path()).output().expect("starts");
    assert_eq!(String::from_utf8_lossy(&output.stderr).trim_end(), said.trim_end());
}

#[test]
fn the_commands_are_those_of_the_help() {
    let (help, _) = run(&["--help"]);
    let commands = help.split("Commands:").nth(1).and_then(|rest| rest.split("\n\n").next()).expect("the help lists commands");
    for line in commands.lines().map(str::trim).filter(|line| !line.is_empty()) {
        assert!(readme().contains(line), "no page has: {line}");
    }
}

/// What is said that each model leaves out.
fn limits() -> String {
    let mut text = String::new();
    for model in models::all() {
        let mut line = format!("- `{}`:", model.name);
        for word in model.limits.split_whitespace() {
            if line.len() + 1 + word.len() > 132 {
                text += &format!("{line}\n");
                line = " ".to_owned();
            }
            line += &format!(" {word}");
        }
        text += &format!("{line}\n");
    }
    text
}

/// Run by `docs/write` it writes the list anew.
#[test]
fn every_model_and_what_it_leaves_out_is_named() {
    let path = root().join("docs/manual/models.md");
    let page = std::fs::read_to_string(&path).expect("the models have a page");
    let (before, rest) = page.split_once("<!-- models -->\n").map(|(a, b)| (a.to_owned(), b.to_owned())).expect("a list of the models");
    let (list, after) = rest.split_once("<!-- end of models -->").expect("the list ends");
    if std::env::var_os("BELTSPACE_WRITE_MODELS").is_some() {
        let text = format!("{before}<!-- models -->\n{}<!-- end of models -->{after}", limits());
        std::fs::write(path, text).expect("it can be written");
        return;
    }
    assert_eq!(list, limits(), "docs/write writes it");
}

/// First word and the words before the numbers of every line of a table.
fn names_of(table: &str) -> Vec<&str> {
    let rows = table.lines().filter(|line| line.starts_with("  ") && line.contains("e-"));
    rows.map(|line| line.trim().split("  ").next().unwrap_or_default()).collect()
}

#[test]
fn the_accuracy_table_has_the_outputs_that_verify_prints() {
    let shown = block("$ beltspace verify metal-cvt --samples 1000000");
    let (printed, error) = run(&["verify", "metal-cvt", "--samples", "20000"]);
    assert!(printed.contains("all error bounds hold"), "{printed}{error}");
    assert_eq!(names_of(&shown), names_of(&printed));
    assert!(names_of(&shown).len() > 30 && shown.contains("all error bounds hold"));
}

/// The cell of a method on a grid, as benches/scale writes it.
fn cell(row: &Value, designs: f64) -> String {
    let exponent = |text: String| {
        let (digits, power) = text.split_once('e').expect("written with an exponent");
        let power: i32 = power.parse().expect("a number");
        format!("{digits}e{}{:02}", if power < 0 { '-' } else { '+' }, power.abs())
    };
    match row["seconds"].as_f64() {
        None => format!("> {:.0} s", row["stopped_after"].as_f64().expect("a run ended or was stopped")),
        Some(seconds) => {
            let rate = exponent(format!("{:.1e}", designs / seconds));
            if seconds < 100.0 { format!("{seconds:.2} s, {rate}/s") } else { format!("{seconds:.0} s, {rate}/s") }
        }
    }
}

#[test]
fn the_scale_is_what_the_record_says() {
    let read = |name: &str| std::fs::read_to_string(root().join("results/bench").join(name)).expect("the record is committed");
    let page = read("scale.md");
    assert!(
        readme().contains(&page),
        "docs/manual/measured.md has another results/bench/scale.md: benches/scale --render --docs writes both"
    );
    let record: Value = serde_json::from_str(&read("scale.json")).expect("JSON");
    assert_eq!(record["problems"], Value::Array(Vec::new()), "committed with methods that disagree");
    let mut tables = page.split("| designs ").skip(1);
    for studies in ["grid", "cvt"] {
        let table = tables.next().expect("a table of times for each study");
        let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split('|').map(str::trim).collect()).collect();
        for (column, study) in record[studies].as_array().expect("sizes").iter().enumerate() {
            let designs = study["designs"].as_f64().expect("a number");
            let mut found = Vec::new();
            for (name, method) in study["methods"].as_object().expect("methods") {
                let row = rows.iter().find(|row| row.get(1) == Some(&name.as_str())).unwrap_or_else(|| panic!("no row of {name}"));
                assert_eq!(row[column + 2], cell(method, designs), "{name}, {designs} designs");
                found.extend(method.get("seconds").map(|_| (&method["feasible"], &method["front"])));
            }
            assert!(found.iter().all(|it| *it == found[0]), "{designs} designs: {found:?}");
        }
        for (method, quantities) in record["fits"][studies].as_object().expect("fits") {
            let Some(slope) = quantities["time"]["all"].as_f64() else { continue };
            let row = rows.iter().find(|row| row.get(1) == Some(&method.as_str())).expect("the method has a row");
            assert_eq!(row[row.len() - 3], format!("{slope:.2}"), "{method}");
        }
    }
}

#[test]
fn the_yields_are_what_the_record_says() {
    let text = std::fs::read_to_string(root().join("results/bench/probability.json")).expect("the record is committed");
    let record: Value = serde_json::from_str(&text).expect("JSON");
    let all = &record["all"];
    let number = |value: &Value| value.as_f64().expect("a number");
    let slowest = |inputs: u64| {
        let rows = record["enclosures"].as_array().expect("rows").iter().filter(|it| it["inputs"] == inputs);
        rows.map(|it| 1e3 * number(&it["seconds"])).fold(0.0, f64::max)
    };
    let page = readme();
    let paragraph = page.split("\n\n").find(|it| it.contains("bench/probability.json")).expect("a page has the times").replace('\n', " ");
    assert_eq!((&all["designs"], &all["draws"], &all["cases"]), (&100_000.into(), &4096.into(), &4.into()));
    let many = &record["many"];
    assert_eq!((&many["designs"], &many["draws"], &many["cases"]), (&1_000_000.into(), &100_000.into(), &1.into()));
    let (early, whole) = (&many["early_end"], &many["all_draws"]);
    for said in [
        format!("took {:.2} s on the two cores, numpy on one of them {:.1} s", number(&all["seconds"]), number(&all["numpy"]["seconds"])),
        format!("the peak memory was {:.0} MB", number(&all["peak_MB"])),
        format!("took {:.0} s where a yield of {} is asked for", number(&early["seconds"]), many["least_yield"]),
        format!("{:.1} % of them have, and {:.0} s", 100.0 * number(&early["feasible_share"]), number(&whole["seconds"])),
        format!("took up to {:.0}, {:.0} and {:.0} ms", slowest(2), slowest(3), slowest(4)),
    ] {
        assert!(paragraph.contains(&said), "no page says \"{said}\"");
    }
}

#[test]
fn what_python_takes_is_what_the_record_says() {
    let text = std::fs::read_to_string(root().join("results/bench/python.json")).expect("the record is committed");
    let record: Value = serde_json::from_str(&text).expect("JSON");
    let number = |value: &Value| value.as_f64().expect("a number");
    let (two, all) = (&record["two_outputs"], &record["all_outputs"]);
    assert_eq!((&two["outputs"], &all["outputs"], &record["rows"]), (&2.into(), &38.into(), &1_000_000.into()));
    let page = readme();
    let paragraph = page.split("\n\n").find(|it| it.contains("bench/python.json")).expect("a page has the times").replace('\n', " ");
    let of_each = |row: &Value| {
        let [ours, numpy, blocks] =
            ["processor_ns_per_row", "numpy_processor_ns_per_row", "numpy_in_blocks_processor_ns_per_row"].map(|it| number(&row[it]));
        format!("{ours:.0} ns of processor time a row, numpy {numpy:.0} and in blocks {blocks:.0}")
    };
    let ratio = |row: &Value| format!("{:.1} times", number(&row["numpy_processor_ns_per_row"]) / number(&row["processor_ns_per_row"]));
    for said in [
        of_each(two),
        of_each(all),
        format!("{} and {}", ratio(two), ratio(all)),
        format!("takes {:.1} times and {:.1} times as long", number(&two["times_numpy"]), number(&all["times_numpy"])),
        format!("{:.2} s of processor time", number(&record["worst_by_traction_processor_s"])),
        format!("{:.2} s with a clamping force", number(&record["worst_processor_s"])),
    ] {
        assert!(paragraph.contains(&said), "no page says \"{said}\"");
    }
}

#[test]
fn the_runs_on_a_gpu_are_what_the_record_says() {
    let text = std::fs::read_to_string(root().join("results/bench/gpu-h200.json")).expect("the record is committed");
    let record: Value = serde_json::from_str(&text).expect("JSON");
    let run = |command: &str| {
        let runs = record["runs"].as_array().expect("runs");
        runs.iter().find(|it| it["command"] == format!("beltspace sweep {command}")).unwrap_or_else(|| panic!("no run of {command}"))
    };
    let (device, bounds) = (run("metal-grid-560.toml --engine gpu"), run("metal-grid-560.toml --method bounds"));
    assert_eq!((&device["feasible"], &device["front"]), (&bounds["feasible"], &bounds["front"]));
    let grouped = |value: &Value| {
        let digits = value.to_string();
        let parts: Vec<&str> = digits.as_bytes().rchunks(3).rev().map(|part| std::str::from_utf8(part).expect("digits")).collect();
        parts.join(" ")
    };
    let seconds = |value: &Value| format!("{:.1} s", value.as_f64().expect("a number"));
    let rate = device["run"]["designs_per_second"].as_f64().expect("a number");
    let fine = run("metal-cvt-481.toml --engine gpu");
    let page = readme();
    let paragraph = page.split("\n\n").find(|it| it.contains("gpu-h200.json")).expect("a page has the runs").replace('\n', " ");
    for said in [
        format!("{} designs judged", grouped(&device["run"]["designs"])),
        format!("took {}, {rate:.2e} designs/s: {:.0} % of what", seconds(&device["wall_seconds"]), 100.0 * rate / 2.6e11),
        format!("For {} of it", seconds(&device["run"]["device"]["seconds_waiting"])),
        format!("into {} survivors", grouped(&device["run"]["device"]["survivors"])),
        format!("evaluated {}.", grouped(&device["run"]["device"]["survivors_evaluated_in_f64"])),
        format!("{} were unsure", grouped(&device["run"]["device"]["unsure_designs"])),
        format!("took {} on the same machine", seconds(&bounds["wall_seconds"])),
        format!("{} for {} designs", seconds(&fine["wall_seconds"]), grouped(&fine["run"]["designs"])),
    ] {
        assert!(paragraph.contains(&said), "no page says \"{said}\"");
    }
}
