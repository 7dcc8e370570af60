//! Files that were changed by accident or on purpose, and things that are not files, are refused quickly, with a short message that names
//! them.

use super::report::{columns_of, data_of};
use super::{Answer, SMALL, ask, changed, folder_with, json_of, program, read, write};
use std::path::Path;
use std::time::{Duration, Instant};

/// A study whose map has lines.
const LINES: &str = r#"model = "metal-cvt"
[design]
band_thickness_mm = { from = 0.10, to = 0.30, count = 5 }
groove_angle_deg  = { from = 18, to = 30, count = 4 }
[objectives]
axial_force_N = "min"
[report]
maps = [{ x = "band_thickness_mm", y = "groove_angle_deg", value = "axial_force_N", contours = [15500, 16500] }]
"#;

/// Refused with code 2, within the time, in at most so many bytes.
#[track_caller]
fn refused_soon(folder: &Path, line: &str) -> String {
    let start = Instant::now();
    let said = ask(folder, line).refusal(2);
    assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
    assert!(said.len() < 40_000, "{} bytes", said.len());
    said
}

#[cfg(unix)]
#[test]
fn what_is_no_file_is_no_study_but_what_the_shell_hands_over_is() {
    let folder = folder_with("small.toml", SMALL);
    let made = std::process::Command::new("mkfifo").arg(folder.path().join("pipe")).status().expect("mkfifo is there");
    assert!(made.success());
    for name in ["/dev/zero", "pipe"] {
        let said = refused_soon(folder.path(), &format!("check {name}"));
        assert!(said.contains(&format!("cannot read study {name}: it is a pipe or a device; name a file")), "{said}");
    }
    let said = refused_soon(folder.path(), "check .");
    assert!(said.contains("cannot read study .: is a directory"), "{said}");
    let from = |file: std::fs::File| -> Answer {
        program(folder.path(), &["check", "/dev/stdin"]).stdin(file).output().expect("the program starts").into()
    };
    from(std::fs::File::open(folder.path().join("small.toml")).expect("it is there")).text();
    let said = from(std::fs::File::open("/dev/zero").expect("it is there")).refusal(2);
    assert!(said.contains("it has more than 4 MiB; long lists of values go into a CSV file"), "{said}");
    // A table is a file too.
    write(folder.path(), "zero.toml", &changed(SMALL, &[("friction  = [0.065, 0.095]", "cases = { csv = \"/dev/zero\" }")]));
    let said = refused_soon(folder.path(), "check zero.toml");
    assert!(said.contains("is not a file; name a CSV file"), "{said}");
}

#[test]
fn errors_of_a_study_are_few_and_short_whatever_it_says() {
    let folder = folder_with("small.toml", SMALL);
    let check = |from: &str, to: &str| {
        write(folder.path(), "wrong.toml", &changed(SMALL, &[(from, to)]));
        refused_soon(folder.path(), "check wrong.toml")
    };
    let bad = "\"x\", ".repeat(100_000);
    let said = check("torque_Nm = [50, 150]", &format!("torque_Nm = [{bad}]"));
    assert!(said.contains("there may be more problems than these 100; correct them first"), "{said}");
    let digits = "9".repeat(400);
    for (from, to) in [
        ("friction  = [0.065, 0.095]", format!("friction = [{digits}]")),
        ("friction  = [0.065, 0.095]", format!("friction = [1e300, {digits}.5]")),
        ("strength_MPa = 800", format!("strength_MPa = [{digits}]")),
        ("slip_margin   = { min = 0 }", format!("slip_margin = {digits}")),
        ("columns = [\"max_stress_MPa\"]", format!("columns = [{digits}]")),
        ("bins = 40", format!("bins = {digits}")),
    ] {
        let said = check(from, &to);
        assert!(!said.contains(&digits[..100]), "{said}");
    }
    let nested = format!("friction = {}{}", "[".repeat(100_000), "]".repeat(100_000));
    check("friction  = [0.065, 0.095]", &nested);
    check("friction  = [0.065, 0.095]", &"[".repeat(100_000));
    let names: String = (0..100_000).map(|number| format!("nothing_{number} = 1\n")).collect();
    check("[fixed]\n", &format!("[fixed]\n{names}"));
    let axes: String = (0..100_000).map(|number| format!("cases_{number} = [{{ traction = \"limit\" }}]\n")).collect();
    check("[design]\n", &format!("[design]\n{axes}"));
    check("count = 13", "count = 1e18");
    let thresholds: String = (0..2000).map(|number| format!("{number}, ")).collect();
    write(folder.path(), "wrong.toml", &changed(LINES, &[("[15500, 16500]", &format!("[{thresholds}]"))]));
    let said = refused_soon(folder.path(), "check wrong.toml");
    assert!(said.contains("axial_force_N has more than 1000 lines; give fewer values"), "{said}");
    let maps = "{ x = \"band_thickness_mm\", y = \"band_count\", best = \"share\" },".repeat(101);
    let said = check("    { x = \"band_thickness_mm\", y = \"band_count\", best = \"share\" },", &maps);
    assert!(said.contains("there are 102; at most 100 fit on a page"), "{said}");
}

/// Neither a title nor a name can send control sequences to a terminal.
#[test]
fn what_a_terminal_would_obey_is_shown_instead() {
    let title = r#"title = "\u001b[31mred\u0007\u0000x\n\rline2\u202e""#;
    let folder = folder_with("small.toml", &changed(SMALL, &[("title = \"Small\"", title)]));
    let harmless = |text: &str| text.chars().all(|it| it == '\n' || !(it.is_control() || it == '\u{202e}'));
    for line in ["check small.toml", "sweep small.toml --out out", "slurm small.toml --out cluster"] {
        let said = ask(folder.path(), line).text();
        assert!(said.contains(r"\u{1b}[31mred\u{7}\u{0}x\n\rline2\u{202e}") && harmless(&said), "{line}: {said:?}");
    }
    let said = ask(folder.path(), "check \u{1b}[31m\u{7}.toml").refusal(2);
    assert!(harmless(&said), "{said:?}");
}

/// Every problem has its line number; finding it by reading the whole file for each row would take minutes.
#[test]
fn a_long_line_is_read_soon() {
    let cases: String = (1..=120_000).map(|torque| format!("{{ torque_Nm = {torque} }},")).collect();
    let blank = " ".repeat(1 << 20);
    let text = format!("model = \"metal-cvt\"\n[design]\ncases = [{cases}]\n[objectives]\naxial_force_N = \"min\"\n{blank}");
    let folder = folder_with("long.toml", &text);
    let start = Instant::now();
    let said = ask(folder.path(), "check long.toml").text();
    assert!(said.contains("120 000") && start.elapsed() < Duration::from_secs(20), "{:?}: {said}", start.elapsed());
}

#[test]
fn cells_that_no_result_has_are_refused() {
    let folder = folder_with("small.toml", SMALL);
    ask(folder.path(), "sweep small.toml --out r --no-report").text();
    let column = |table: &str, name: &str| table.split('\n').next().expect("it has a header").split(',').position(|it| it == name);
    let spoil = |file: &str, name: &str, to: &str| {
        let whole = read(&folder.path().join("r").join(file));
        let at = column(&whole, name).unwrap_or_else(|| panic!("{file} has no {name}"));
        let mut lines: Vec<String> = whole.lines().map(str::to_owned).collect();
        let mut cells: Vec<&str> = lines[2].split(',').collect();
        cells[at] = to;
        lines[2] = cells.join(",");
        write(folder.path(), &format!("r/{file}"), &(lines.join("\n") + "\n"));
        let said = ask(folder.path(), "report r --patience 0").refusal(2);
        write(folder.path(), &format!("r/{file}"), &whole);
        assert!(said.contains(&format!("r/{file}: ")) && said.contains("sweep the study again"), "{said}");
        said
    };
    let said = spoil("front.csv", "axial_force_N_scenario", "rubbish");
    assert!(said.contains("axial_force_N_scenario is not one of the study's 12 scenarios: design"), "{said}");
    for to in ["", "-1", "1.5", "03", "4294967297"] {
        spoil("front.csv", "axial_force_N_scenario", to);
    }
    let said = spoil("front.csv", "band_count", "+9");
    assert!(said.contains("band_count of design") && said.contains("is +9, and the study gives"), "{said}");
    for to in ["inf", "nan", "1e999", "1 "] {
        assert!(spoil("front.csv", "axial_force_N", to).contains("is not a number"));
    }
    spoil("top.csv", "design_index", "99999999");
    spoil("top.csv", "band_count", "8.5");
    spoil("top.csv", "stress_margin_scenario", "12");
    spoil("map-axial_force_N.csv", "axial_force_N", "rubbish");
    spoil("map-axial_force_N.csv", "design_index", "rubbish");
    spoil("map-axial_force_N.csv", "groove_angle_deg", "rubbish");
    spoil("histogram-axial_force_N.csv", "designs", "-0");
    spoil("histogram-axial_force_N.csv", "from", "rubbish");
    // The same design twice in place of another.
    let front = read(&folder.path().join("r/front.csv"));
    let lines: Vec<&str> = front.lines().collect();
    write(folder.path(), "r/front.csv", &front.replacen(lines[3], lines[2], 1));
    assert!(ask(folder.path(), "report r").refusal(2).contains("is there twice"));
    write(folder.path(), "r/front.csv", &front);
    ask(folder.path(), "report r").text();
}

#[test]
fn lines_over_a_map_with_other_columns_are_refused() {
    let folder = folder_with("lines.toml", LINES);
    ask(folder.path(), "sweep lines.toml --out r --no-report").text();
    let contours = read(&folder.path().join("r/contours-axial_force_N.csv"));
    let two: String = contours.lines().map(|line| line.split(',').take(2).collect::<Vec<_>>().join(",") + "\n").collect();
    for wrong in [two.as_str(), "", "of\n", &contours.replacen("axial_force_N", "nothing", 1), &contours.replacen(",15500,", ",x,", 1)] {
        write(folder.path(), "r/contours-axial_force_N.csv", wrong);
        let said = ask(folder.path(), "report r").refusal(2);
        assert!(said.contains("r/contours-axial_force_N.csv: ") && said.contains("sweep the study again"), "{said}");
    }
    write(folder.path(), "r/contours-axial_force_N.csv", &contours);
    ask(folder.path(), "report r").text();
}

/// A description that no study file could have, with the hash that goes with it.
#[test]
fn a_forged_description_is_held_to_what_a_study_file_is() {
    let text = changed(SMALL, &[("friction  = [0.065, 0.095]", "cases = [{ friction = 0.065 }, { friction = 0.095 }]")]);
    let folder = folder_with("small.toml", &text);
    ask(folder.path(), "sweep small.toml --out r --no-report").text();
    let whole = json_of(&folder.path().join("r/study.json"));
    let forge = |path: &str, to: serde_json::Value| {
        let mut described = whole.clone();
        *described.pointer_mut(path).unwrap_or_else(|| panic!("there is no {path}")) = to;
        write(folder.path(), "r/study.json", &described.to_string());
        let said = refused_soon(folder.path(), "report r");
        assert!(said.contains("r/study.json: this version does not understand its study: "), "{said}");
        said
    };
    let two_to_the_53 = serde_json::json!(1u64 << 53);
    assert!(forge("/uncertainty/0/rows", serde_json::json!([])).contains("axis \"friction\": it has no rows"));
    assert!(forge("/uncertainty/0/rows/0", serde_json::json!([])).contains("a row has another length"));
    assert!(forge("/uncertainty/0/rows/0/0", serde_json::json!(-1)).contains("a row is not one of values that its inputs take"));
    forge("/design/0/count", two_to_the_53);
    forge("/operation/0/count", serde_json::json!(1u64 << 40));
    forge("/design/0/count", serde_json::json!(0));
    forge("/objectives/1/of", serde_json::json!("axial_force_N"));
    forge("/histograms/0/bins", serde_json::json!(1u64 << 40));
    forge("/top/count", serde_json::json!(u64::MAX));
    forge("/maps/0/y", serde_json::json!("band_thickness_mm"));
    write(folder.path(), "r/study.json", &whole.to_string());
    ask(folder.path(), "report r").text();
    let summary = json_of(&folder.path().join("r/summary.json"));
    for (path, to) in [
        ("/front", serde_json::json!(u64::MAX)),
        ("/tally/constraints", serde_json::json!([])),
        ("/extremes/axial_force_N/least/design_index", serde_json::json!(u64::MAX)),
        ("/knee", serde_json::json!("middle")),
        ("/title", serde_json::json!("another")),
    ] {
        let mut forged = summary.clone();
        *forged.pointer_mut(path).unwrap_or_else(|| panic!("there is no {path}")) = to;
        write(folder.path(), "r/summary.json", &forged.to_string());
        let said = refused_soon(folder.path(), "report r");
        assert!(said.contains(if path == "/front" { "r/front.csv: " } else { "r/summary.json: its" }), "{path}: {said}");
    }
    write(folder.path(), "r/summary.json", &summary.to_string());
    for name in ["front.csv", "study.toml", "summary.json"] {
        let bytes = std::fs::read(folder.path().join("r").join(name)).expect("it is there");
        std::fs::write(folder.path().join("r").join(name), [&bytes[..20], b"\xff", &bytes[20..]].concat()).expect("it can be written");
        let refused = ask(folder.path(), "report r");
        assert!(refused.code != Some(0) && refused.err.contains(&format!("r/{name}: ")), "{}", refused.err);
        std::fs::write(folder.path().join("r").join(name), bytes).expect("it can be written");
    }
}

#[test]
fn a_checkpoint_that_does_not_fit_its_study_is_refused() {
    let folder = folder_with("small.toml", SMALL);
    ask(folder.path(), "sweep small.toml --shard 1/1 --out r").text();
    let checkpoint = folder.path().join("r/checkpoint");
    let whole = json_of(&checkpoint.join("manifest.json"));
    let state = checkpoint.join(whole["manifest"]["state"][0].as_str().expect("there is a state"));
    let good = std::fs::read(&state).expect("it is there");
    let seal = |mut sealed: serde_json::Value| {
        sealed["checksum"] = crc32fast::hash(sealed["manifest"].to_string().as_bytes()).into();
        write(&checkpoint, "manifest.json", &sealed.to_string());
    };
    let both = |expected: &str| {
        for line in ["sweep small.toml --out r --resume", "merge r --out whole"] {
            let said = ask(folder.path(), line).refusal(1);
            assert!(said.contains(expected), "{line}: {said}");
        }
    };
    // A state of other reducers and objectives, sealed as this study's.
    let forged: [fn(&mut beltspace::reduce::State); 10] = [
        |it| it.reported.samples.push(beltspace::reduce::FeasibleSample::new(5, 0)),
        |it| it.reported.top.clear(),
        |it| it.reported.histograms[0].counts.truncate(1),
        |it| it.reported.histograms[0].counts[0] = u64::MAX,
        |it| it.reported.histograms.clear(),
        |it| it.reported.maps.truncate(1),
        |it| it.front.keys.truncate(1),
        |it| it.front.indices[0] = u64::MAX,
        |it| it.extremes.least.clear(),
        |it| it.feasible = u64::MAX,
    ];
    for forge in forged {
        let mut state_of: beltspace::reduce::State = postcard::from_bytes(&good).expect("it was written so");
        forge(&mut state_of);
        let bytes = postcard::to_stdvec(&state_of).expect("it can be written");
        std::fs::write(&state, &bytes).expect("it can be written");
        let mut sealed = whole.clone();
        sealed["manifest"]["state"][1] = crc32fast::hash(&bytes).into();
        seal(sealed);
        both("the checkpoint does not fit its study (its ");
    }
    std::fs::write(&state, &good).expect("it can be written");
    for (path, to) in [
        ("/manifest/description/design/0/count", serde_json::json!(u64::MAX)),
        ("/manifest/description/design/0/input", serde_json::json!(1000)),
        ("/manifest/description/objectives/0/of", serde_json::json!("no_output")),
        ("/manifest/description/fixed", serde_json::json!([])),
        ("/manifest/description/maps/0/x", serde_json::json!("no_axis")),
        ("/manifest/study_hash", serde_json::json!("0")),
        ("/manifest/designs", serde_json::json!(7)),
        ("/manifest/saves", serde_json::json!(u64::MAX)),
    ] {
        let mut sealed = whole.clone();
        *sealed.pointer_mut(path).unwrap_or_else(|| panic!("there is no {path} in {whole:#}")) = to;
        seal(sealed);
        both("the manifest is damaged (");
    }
    seal(whole);
    ask(folder.path(), "merge r --out whole").text();
}

#[test]
fn a_picture_with_more_than_a_picture_is_refused() {
    let folder = folder_with("small.toml", SMALL);
    ask(folder.path(), "sweep small.toml --out r --no-report").text();
    let open = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"9\" height=\"9\">";
    for (inside, told) in [
        ("<image href=\"x\" onerror=\"document.documentElement.dataset.x='1'\"/>", "href of <image> is \"x\""),
        ("<rect onload=\"x()\"/>", "<rect> has an attribute onload"),
        ("<script>x()</script>", "it has an element <script>"),
    ] {
        write(folder.path(), "r/knee-section.svg", &format!("{open}{inside}</svg>\n"));
        let said = ask(folder.path(), "report r").refusal(2);
        assert!(said.contains("r/knee-section.svg: not a picture of this program: ") && said.contains(told), "{said}");
    }
    write(folder.path(), "r/knee-section.svg", &format!("{open}<rect x=\"1\" fill=\"#0072B2\"/></svg>\n"));
    ask(folder.path(), "report r").text();
}

/// More designs than an f64 or a signed number counts: the page has the last digit of their indices.
#[test]
fn indices_of_designs_are_exact_on_the_page() {
    let study = r#"model = "metal-cvt"
[design]
ratio = { from = 0.5, to = 2, count = 65536 }
friction = { from = 0.05, to = 0.09, count = 65536 }
groove_angle_deg = { from = 18, to = 30, count = 65535 }
torque_Nm = { from = 18, to = 30, count = 65535 }
[objectives]
ratio = "max"
friction = "max"
groove_angle_deg = "max"
torque_Nm = "max"
"#;
    let folder = folder_with("many.toml", study);
    ask(folder.path(), "sweep many.toml --out r --method bounds").text();
    let table = read(&folder.path().join("r/front.csv"));
    let index = table.lines().nth(1).and_then(|row| row.split(',').next()).expect("the front has a design").to_owned();
    assert!(index.parse::<u64>().expect("it is a number") > 1 << 63, "{index}");
    let page = data_of(&folder.path().join("r/report.html"));
    assert_eq!(page["front"]["columns"][0]["type"], "u64");
    assert!(columns_of(&page).contains_key("ratio"));
    let packed = super::report::unpacked(&page);
    assert_eq!(u64::from_le_bytes(packed[..8].try_into().expect("eight bytes")).to_string(), index);
}
