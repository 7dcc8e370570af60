//! Files of models with a mistake each, and what is said of them.

use beltspace::study::read_model;

const MODEL: &str = include_str!("models/band-brake.toml");
const GRIP: &str = include_str!("models/grip.csv");

/// Edits of a right model, and what is said of each: line and column, and the sentence.
const BROKEN: [(&str, &str, &str); 54] = [
    (
        r#"gain         = "tight_N"#,
        "tight_N_scenario = \"tight_N\"\ngain         = \"tight_N",
        r#"26:1: "tight_N_scenario" is the name of a column that tables of results have beside "tight_N"; choose another name"#,
    ),
    (
        r#"rows           = {"#,
        "status = { default = 1, valid = [0, 2], doc = \"A state.\" }\nrows           = {",
        r#"13:1: "status" is the name of a column in tables of results; choose another name"#,
    ),
    (
        r#"gain         = "tight_N"#,
        "yield = \"2\"\ngain         = \"tight_N",
        r#"26:1: "yield" is the name of a column that tells the share of draws that hold; choose another name"#,
    ),
    (r#"summary = "Band"#, "summary = 7 #", "1:11: summary: found the number 7, wanted a text in quotes"),
    ("limits = ", "limit = ", r#"3:1: unknown key "limit"; did you mean "limits"?"#),
    (
        r#"units = ["EUR"]"#,
        r#"base = "metal"
units = ["EUR"]"#,
        r#"4:8: base: there is no model "metal"; models are: rubber-cvt, metal-cvt, timing-belt, pulley-load, pulley, flat-belt"#,
    ),
    (r#"units = ["EUR"]"#, r#"units = ["N"]"#, r#"4:10: units: "N" is known already; choose another name"#),
    ("[inputs]", "[imputs]", r#"6:2: unknown key "imputs"; did you mean "inputs"?"#),
    (
        "{ default = 100, valid = [20, 500]",
        "{ valid = [20, 500]",
        r#"7:18: input "drum_radius_mm": "default" is missing; it must be at least 20 and at most 500"#,
    ),
    (
        "{ default = 100, valid",
        "{ default = 1000, valid",
        r#"7:30: input "drum_radius_mm": 1000 is out of range; it must be at least 20 and at most 500 (mm)"#,
    ),
    (
        "{ default = 100, valid = [20, 500]",
        "{ default = 100, valid = [500, 20]",
        r#"7:43: input "drum_radius_mm": valid: no number is at least 500 and at most 20; give a lower end below the upper one"#,
    ),
    (
        "valid = [20, 500]",
        "valid = 20",
        r#"7:43: input "drum_radius_mm": valid: found the number 20, wanted two numbers [low, high] or { above = 0, max = 2 }"#,
    ),
    (
        "valid = [20, 500]",
        r#"valid = [20, "a"]"#,
        r#"7:48: input "drum_radius_mm": valid: "a" is not a number with a unit; write for example "12 mm""#,
    ),
    (
        "{ above = 0, max = 360 }",
        "{ above = 0, min = 0, max = 360 }",
        r#"8:45: input "wrap_deg": valid: min and above exclude each other; keep one"#,
    ),
    (
        "{ above = 0, max = 360 }",
        "{ above = 0, most = 360 }",
        r#"8:56: input "wrap_deg": valid: unknown key "most"; allowed are min, above, max, below"#,
    ),
    (
        r#"pull_N         = { default = 300, valid = { min = 0 }, doc = "Pull at the lever." }"#,
        "pull_N = 300",
        r#"9:10: input "pull_N": found the number 300, wanted { default = 1, valid = [0, 2], doc = "..." }"#,
    ),
    (
        "pull_N         =",
        r#""pull N" ="#,
        r#"9:1: input "pull N": this is no name; use up to 80 letters, digits and "_", a letter first, and no function's"#,
    ),
    (
        "pull_N         =",
        "sqrt =",
        r#"9:1: input "sqrt": this is no name; use up to 80 letters, digits and "_", a letter first, and no function's"#,
    ),
    (
        r#"words = ["smooth", "rough"]"#,
        r#"words = "smooth""#,
        r#"11:48: input "surface": found the text "smooth"; words must be a list of words such as ["smooth", "rough"]"#,
    ),
    (
        r#"words = ["smooth", "rough"]"#,
        r#"words = ["smooth", "smooth", "rough"]"#,
        r#"11:59: input "surface": the word "smooth" stands twice; drop one of the two"#,
    ),
    (
        r#"default = "smooth""#,
        r#"default = "smoth""#,
        r#"11:30: input "surface": found "smoth", but surface takes words only; write "smooth" or "rough""#,
    ),
    (
        r#"default = "measured", valid = { above = 0, max = 2 }"#,
        r#"default = "measured", valid = { }"#,
        r#"12:18: input "friction": numbers without an end leave no room for words; give valid = [..., ...]"#,
    ),
    (
        r#"integer = true, doc = "Rows"#,
        r#"integer = 1, doc = "Rows"#,
        r#"13:59: input "rows": found the number 1; integer must be true or false"#,
    ),
    ("default = 2, valid = [1, 9]", "default = 2.5, valid = [1, 9]", r#"13:30: input "rows": 2.5 is not a whole number; use 2 or 3"#),
    (
        "rows           = { default",
        r#"rows           = { only_for = { surface = ["cast"] }, default"#,
        r#"13:18: input "rows": only_for names "cast" of surface, which takes the words "smooth" or "rough""#,
    ),
    (
        "rows           = { default",
        r#"rows           = { only_for = { finish = ["cast"] }, default"#,
        r#"13:18: input "rows": only_for names "finish", which is no input"#,
    ),
    (
        "rows           = { default",
        r#"rows           = { only_for = { speed_rpm = ["cast"] }, default"#,
        r#"13:18: input "rows": only_for names "cast" of speed_rpm, which takes no words"#,
    ),
    (
        "rows           = { default",
        r#"rows           = { only_for = ["rough"], default"#,
        r#"13:31: input "rows": found a list; only_for must be one input with words of it, such as { surface = ["rough"] }"#,
    ),
    (
        "rows           = { default",
        r#"rows           = { follows = "columns", default"#,
        r#"13:18: input "rows": follows names "columns", which is no input"#,
    ),
    (
        "grip.csv",
        "grap.csv",
        r#"16:8: curve "grip": cannot read "grap.csv": No such file or directory (os error 2); paths are relative to the folder of the model"#,
    ),
    (
        r#"x = "speed_m_per_s""#,
        r#"x = "speed""#,
        r#"grip.csv:1:1: curve "grip": there is no column "speed"; its columns are speed_m_per_s, friction"#,
    ),
    (
        r#"rubbing_speed_m_per_s = "speed_rpm"#,
        r#"speed_rpm = "1[rpm]"
rubbing_speed_m_per_s = "speed_rpm"#,
        "19:1: speed_rpm is an input of this model already; choose another name",
    ),
    (
        r#"{ is = "if(surface == 'rough', 1.3, 1)", hidden = true }"#,
        "{ hidden = true }",
        r#"20:16: formula "rough_factor": "is" is missing; write { is = "...", doc = "..." }"#,
    ),
    (
        r#""if(surface == 'rough', 1.3, 1)""#,
        r#""surface * 2""#,
        r#"20:24: formula "rough_factor": surface is a word, and no number can be computed from it; write if(surface == 'smooth', x, y)"#,
    ),
    (
        r#"1.3, 1)", hidden = true"#,
        r#"1.3, 1)", hidden = "yes""#,
        r#"20:66: formula "rough_factor": found the text "yes"; hidden must be true or false"#,
    ),
    (
        ", friction) * rough",
        ", 1) * friction * rough",
        r#"21:85: formula "grip_used": friction may be a word, and no number can be computed from it; write if(friction == 'measured', x, y)"#,
    ),
    (r#"worst = "lowest""#, r#"worst = "least""#, r#"23:70: formula "torque_Nm": unknown worst "least"; write "lowest" or "highest""#),
    (r#"worst = "lowest""#, r#"wurst = "lowest""#, r#"23:62: formula "torque_Nm": unknown key "wurst"; did you mean "worst"?"#),
    (
        r#""rows * ceil(tight_N / 400[N])""#,
        r#""rows * tight_N / 400[N]""#,
        r#"24:24: formula "rivets": rivets is said to be whole, but this may give other numbers; end the formula in round(...), floor(...) or ceil(...), or drop integer"#,
    ),
    (r#""tight_N / pull_N""#, r#""tight_N / pul_N""#, r#"26:27: formula "gain": unknown name "pul_N"; did you mean "pull_N"?"#),
    (r#""tight_N / pull_N""#, r#""tight_N + drum_radius_mm""#, r#"26:17: formula "gain": a force and a length cannot be added"#),
    (r#""tight_N / pull_N""#, "7", r#"26:16: formula "gain": found the number 7, wanted a text in quotes"#),
    (
        r#"margin = "25[m/s] - rubbing_speed_m_per_s""#,
        r#"margin = "25[m/s] - tight_N""#,
        r#"29:31: condition "too fast": a force cannot be subtracted from a speed"#,
    ),
    (
        r#"margin = "25[m/s] - rubbing_speed_m_per_s", strict"#,
        "strict",
        r#"29:19: condition "too fast": "margin" is missing; write margin = "...", at least 0 where all is well"#,
    ),
    (
        r#"margin = "25[m/s] - rubbing_speed_m_per_s", strict = true"#,
        r#"margin = "25[m/s] - rubbing_speed_m_per_s", strict = "no""#,
        r#"29:74: condition "too fast": found the text "no"; strict must be true or false"#,
    ),
    (
        r#"invalidates = ["torque_Nm", "gain"]"#,
        r#"invalidates = ["torque_Nm", "grip_used"]"#,
        r#"30:79: condition "band breaks": there is no output "grip_used"; name outputs of this model"#,
    ),
    (
        r#"invalidates = ["torque_Nm", "gain"]"#,
        r#"invalidates = "torque_Nm""#,
        r#"30:65: condition "band breaks": found the text "torque_Nm"; invalidates must be a list of outputs"#,
    ),
    (
        r#"quiet = true, invalidates = ["gain"]"#,
        "quiet = true",
        r#"31:19: condition "small drum": a quiet condition only takes outputs away; name them: invalidates = ["..."]"#,
    ),
    (r#""band breaks"   = {"#, "ok = {", r#"30:1: condition "ok": there is such a status already; choose another"#),
    (
        r#""band breaks"   = { margin = "4000[N] - tight_N", invalidates = ["torque_Nm", "gain"] }"#,
        r#""band breaks" = "4000[N] - tight_N""#,
        r#"30:17: condition "band breaks": found the text "4000[N] - tight_N", wanted { margin = "...", doc = "..." }"#,
    ),
    (
        "[presets]",
        r#"[outputs]
torque_Nm = "Torque."
grip_used = "Friction."
weight = "Mass."
gain = 7
[presets]"#,
        r#"35:1: output "grip_used": the formula is hidden; drop that, or this line
36:1: output "weight": there is no such formula; write a formula of that name in [formulas]
37:8: output "gain": found the number 7, wanted a sentence or { doc = "..." }"#,
    ),
    (
        r#"drum_radius_mm = "0.2 m""#,
        r#"drum_radius_mm = "0.2 kg""#,
        r#"34:28: preset "heavy", drum_radius_mm: "kg" measures a mass, but a length is wanted; use mm, um, cm, m, in, ft"#,
    ),
    ("rows = 3 }", "row = 3 }", r#"34:56: preset "heavy": there is no input "row"; did you mean "rows"?"#),
    ("heavy = {", "heavy = 3 #", r#"34:9: preset "heavy": found the number 3, wanted { INPUT = VALUE, ... }"#),
];

/// The text with these edits, each made once.
fn changed(text: &str, edits: &[(&str, &str)]) -> String {
    edits.iter().fold(text.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "the model has no {from}");
        text.replacen(from, to, 1)
    })
}

/// What is said of this text, line by line, without the names of folders.
fn problems(text: &str) -> Vec<String> {
    let folder = tempfile::tempdir().expect("there is room");
    let path = folder.path().join("brake.toml");
    std::fs::write(&path, text).expect("it can be written");
    std::fs::write(folder.path().join("grip.csv"), GRIP).expect("it can be written");
    let Err(error) = read_model(&path) else { return Vec::new() };
    let start = format!("{}/", folder.path().display());
    error.to_string().lines().map(|line| line.strip_prefix(&start).unwrap_or(line).replace("brake.toml:", "")).collect()
}

#[test]
fn every_broken_model_is_refused_at_its_place_with_a_remedy() {
    assert_eq!(problems(MODEL), [""; 0]);
    let mut wrong = String::new();
    for (from, to, message) in BROKEN {
        let found = problems(&changed(MODEL, &[(from, to)]));
        if found != message.lines().collect::<Vec<_>>() {
            wrong += &format!("{to}\n  is    {}\n  wanted {message}\n", found.join("\n"));
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn all_mistakes_of_a_model_are_told_at_once_in_the_order_of_the_file() {
    let edits = [
        ("default = 100,", "default = 1000,"),
        ("hidden = true }\ngrip_used", "hidden = 1 }\ngrip_used"),
        ("strict = true", "strict = 1"),
        ("rows = 3", "rows = 99"),
    ];
    let places: Vec<String> =
        problems(&changed(MODEL, &edits)).iter().map(|it| it.split(": ").next().unwrap_or_default().to_owned()).collect();
    assert_eq!(places, ["7:30", "20:66", "29:74", "34:63"]);
    // Formulas are checked where everything that they read is known.
    let edits = [("tight_N / pull_N", "tight_N / pul_N"), ("strict = true", "strict = 1"), ("rows = 3", "row = 3")];
    let places: Vec<String> =
        problems(&changed(MODEL, &edits)).iter().map(|it| it.split(": ").next().unwrap_or_default().to_owned()).collect();
    assert_eq!(places, ["26:27", "29:74", "34:56"]);
}

#[test]
fn a_file_that_is_named_as_a_model_of_the_program_or_as_none_is_refused() {
    let folder = tempfile::tempdir().expect("there is room");
    for (name, said) in [
        ("pulley.toml", "1:1: there is a model \"pulley\" already; choose another name for the file"),
        ("my brake.toml", "1:1: \"my brake\" is no name of a model; name the file with letters, digits, \"-\" and \"_\""),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, MODEL).expect("it can be written");
        std::fs::write(folder.path().join("grip.csv"), GRIP).expect("it can be written");
        let error = read_model(&path).expect_err("the name is wrong").to_string();
        assert_eq!(error, format!("{}:{said}", path.display()));
    }
}
