//! Study files: broken ones are refused with every problem and its position, good ones are understood correctly.

use beltspace::study::{
    Axis, Best, Constraint, Goal, HistogramSpec, Levels, MapSpec, Method, Objective, OverScenarios, Quantity, Report, Sample, Study,
    TopSpec,
};
use std::path::Path;

/// The example of the documentation.
const EXAMPLE: &str = r#"model = "metal-cvt"
title = "Push belt for 150 N m: every ratio, friction known to +-20 %"
[design]
groove_angle_deg  = { from = 18, to = 30, count = 61 }
band_thickness_mm = { from = 0.10, to = 0.30, step = 0.005 }
band_count        = { from = 6, to = 14 }                     # integer axis: step 1
traction          = { from = 0.30, to = 0.50, count = 11 }    # how hard the pulleys squeeze
[operation]
ratio     = { from = 0.5, to = 2.0, count = 31, spacing = "log" }
torque_Nm = [50, 150]
[uncertainty]
friction  = { from = 0.065, to = 0.095, count = 7 }
[fixed]
strength_MPa = 800
[constraints]                          # on outputs or numeric inputs; min, max inclusive; above, below strict
slip_margin   = { min = 0 }
stress_margin = { min = 0 }
[objectives]                           # on outputs or numeric inputs; order matters for row order
axial_force_N = "min"
stress_margin = "max"
slip_margin   = "max"
band_count    = "min"
[report]
columns = ["max_stress_MPa"]
top = { by = "axial_force_N", count = 20 }
histograms = [{ of = "axial_force_N", from = 0, to = 60000, bins = 60 }]
maps = [{ x = "band_thickness_mm", y = "groove_angle_deg", value = "axial_force_N" }]   # best feasible over the other axes
"#;

fn parse(text: &str) -> Result<Study, beltspace::study::StudyErrors> {
    Study::parse_in(text, "study.toml", Path::new("tests"))
}

/// All problems of a text, one per line, without the file's name.
fn problems(text: &str) -> Vec<String> {
    let Err(errors) = parse(text) else { return Vec::new() };
    errors.to_string().lines().map(|line| line.strip_prefix("study.toml:").unwrap_or(line).to_owned()).collect()
}

/// A study with other lines: `N| text` puts `text` in place of line N; a second one for the same N goes below.
fn edited(study: &str, edits: &[(usize, &str)]) -> String {
    let mut lines: Vec<Vec<&str>> = study.lines().map(|line| vec![line]).collect();
    for (index, &(number, text)) in edits.iter().enumerate() {
        let line = &mut lines[number - 1];
        if edits[..index].iter().all(|&(other, _)| other != number) {
            line.clear();
        }
        line.push(text);
    }
    lines.concat().iter().flat_map(|line| [line, "\n"]).collect()
}

/// Does a problem read as expected? `[..]` stands for anything: what the system says, or a long list.
fn reads_as(problem: &str, expected: &str) -> bool {
    match expected.split_once("[..]") {
        Some((start, end)) => problem.len() >= start.len() + end.len() && problem.starts_with(start) && problem.ends_with(end),
        None => problem == expected,
    }
}

#[test]
fn every_broken_study_is_refused_at_its_place_with_a_remedy() {
    refused(EXAMPLE, BROKEN, 50);
}

#[test]
fn every_wrong_distribution_is_refused_at_its_place_with_a_remedy() {
    assert_eq!(problems(DRAWN), Vec::<String>::new());
    refused(DRAWN, WRONG_DISTRIBUTIONS, 50);
}

/// Each block of `broken` has lines in place of those of the study, then the problems that this must give. There are so many blocks at least.
fn refused(study: &str, broken: &'static str, least: usize) {
    let mut tried = 0;
    let mut wrong = String::new();
    for block in broken.split("\n\n") {
        let lines = block.lines().filter(|line| !line.is_empty() && !line.starts_with('#'));
        let edit = |line: &'static str| {
            let (number, text) = line.split_once('|')?;
            Some((number.parse::<usize>().ok()?, text.strip_prefix(' ').unwrap_or(text)))
        };
        let (edits, expected): (Vec<_>, Vec<_>) = lines.partition(|line| edit(line).is_some());
        let edits: Vec<_> = edits.into_iter().filter_map(edit).collect();
        let found = problems(&edited(study, &edits));
        if found.len() != expected.len() || !found.iter().zip(&expected).all(|(found, expected)| reads_as(found, expected)) {
            wrong += &format!("{block}\n  but it says\n{}\n\n", found.join("\n"));
        }
        for problem in &found {
            let message = problem.splitn(3, ':').nth(2).unwrap_or("").trim_start();
            let remedy = message.contains("; ") || message.contains("wanted ") || message.contains("must be ");
            if !remedy || message.ends_with('.') || message.starts_with(char::is_uppercase) {
                wrong += &format!("no remedy, or no way to write a message: {problem}\n");
            }
        }
        tried += 1;
    }
    assert!(wrong.is_empty(), "{wrong}");
    assert!(tried >= least, "{tried}");
}

#[test]
fn a_preset_is_the_base_and_what_is_fixed_goes_before_it() {
    let study = |head: &str, fixed: &str| {
        let text = format!("model = \"timing-belt\"\n{head}\n[design]\ntight_tension_N = [100, 200]\n[fixed]\n{fixed}\n");
        parse(&(text + "[objectives]\ntight_tension_N = \"min\"\n")).expect("it is right")
    };
    let model = beltspace::models::find("timing-belt").expect("it is a model");
    let preset = model.preset("ohc-driver").expect("it is a preset");
    assert_eq!(study("preset = \"ohc-driver\"", "").fixed, preset);
    let teeth = model.input("teeth_in_mesh").expect("it is an input");
    let fixed = study("preset = \"ohc-driver\"", "teeth_in_mesh = 9").fixed;
    assert_eq!((fixed[teeth], fixed[0]), (9.0, 10_000.0));
    assert_eq!(study("", "").fixed, model.defaults());
    let described = study("preset = \"ohc-driver\"", "").describe();
    assert_eq!((&described["fixed"]["teeth_in_mesh"], described.get("preset")), (&11.into(), None), "as it resolves");
}

#[test]
fn all_problems_of_a_file_are_reported_in_file_order() {
    let text = edited(
        EXAMPLE,
        &[
            (2, "titel = \"x\""),
            (4, "groove_angel_deg = 20"),
            (5, "band_thickness_mm = { from = 0.10, to = \"0.3 N\", step = 0 }"),
            (6, "band_count = [6, 6.5, 7, 7]"),
            (9, "ratio = { from = 0.5, to = 2.0 }"),
            (10, "torque_Nm ="),
            (12, "friction = [0.08, -1, nan]"),
            (14, "traction = 0.4"),
            (16, "slip_margin = { min = 1, max = 0, least = 3 }"),
            (19, "axial_force_N = \"less\""),
            (24, "columns = [\"band_count\", \"x\"]"),
            (25, "top = { count = 0 }"),
            (26, "histograms = [{ of = \"axial_force_N\", to = 3 }, 7]"),
        ],
    );
    let found = problems(&text);
    let expected = [
        "2:1: unknown key \"titel\"",
        "4:1: axis \"groove_angel_deg\": metal-cvt has no input",
        "5:41: axis \"band_thickness_mm\": \"N\" measures a force",
        "5:57: axis \"band_thickness_mm\": the step 0",
        "6:18: axis \"band_count\": 6.5 is not a whole number",
        "6:26: axis \"band_count\": 7 is listed twice",
        "9:9: axis \"ratio\": a range needs count or step",
        "10:12: there is no value after",
        "12:19: axis \"friction\": -1 is out of range",
        "12:23: axis \"friction\": nan cannot be used",
        "14:1: \"traction\" is already set in [design], line 7",
        "16:26: constraint \"slip_margin\": no value is at least 1 and at most 0",
        "16:35: constraint \"slip_margin\": unknown key \"least\"",
        "19:17: objective \"axial_force_N\": unknown goal \"less\"",
        "24:12: columns: \"band_count\" is a design input",
        "24:26: columns: metal-cvt has no input or output \"x\"",
        "25:7: top: \"by\" is missing",
        "25:17: top: 0 is out of range",
        "26:39: histograms: only to is given",
        "26:49: histograms: found the number 7",
    ];
    let fits = found.len() == expected.len() && found.iter().zip(expected).all(|(found, expected)| found.starts_with(expected));
    assert!(fits, "{}", found.join("\n"));
}

#[test]
fn a_study_that_cannot_be_read_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("study.toml");
    assert!(matches!(Study::read(&path), Err(beltspace::error::Error::Io { .. })));
    std::fs::write(&path, b"model = \"metal-cvt\"\ntitle = \"\xe4\"\n").unwrap();
    let error = Study::read(&path).unwrap_err();
    assert!(error.to_string().ends_with("study.toml:2:10: this is not UTF-8 text; save the file in the encoding UTF-8"), "{error}");
    std::fs::write(&path, EXAMPLE).unwrap();
    assert_eq!(Study::read(&path).unwrap().1, EXAMPLE);
}

#[test]
fn problems_of_a_csv_file_name_its_line_and_field() {
    let folder = tempfile::tempdir().unwrap();
    let text = edited(EXAMPLE, &[(9, "cases = { csv = \"belts.csv\" }"), (10, "")]);
    let cases: &[(&str, &[&str])] = &[
        ("", &["1:1: there are no rows; the first line names inputs, such as [..]"]),
        ("ratio,torque_Nm\n", &["1:1: there are no rows; [..]"]),
        (
            "ratio,torqe_Nm\n1,2\n",
            &["1:2: metal-cvt has no input \"torqe_Nm\"; did you mean \"torque_Nm\"? unused = \"ok\" beside csv leaves the column out"],
        ),
        ("ratio,slip_margin\n1,2\n", &["1:2: slip_margin is an output; [..]"]),
        ("ratio,ratio\n1,2\n", &["1:2: \"ratio\" has two columns; drop one"]),
        ("ratio,\n1,2\n", &["1:2: the column has no name; [..]"]),
        ("ratio;torque_Nm\n1;2\n", &["1:1: the columns are not separated by commas; [..]"]),
        ("ratio,torque_Nm\n1,2\n\n1,x\n", &["4:2: column \"torque_Nm\": \"x\" is not a number with a unit; write for example \"12 Nm\""]),
        ("ratio,torque_Nm\n1,2\n,3\n", &["3:1: column \"ratio\": the field is empty; give a value"]),
        (
            "ratio,torque_Nm\n1,2\n0,\"12 mm\"\n",
            &["3:1: column \"ratio\": 0 is out of range; [..]", "3:2: column \"torque_Nm\": \"mm\" measures [..]"],
        ),
        ("ratio,torque_Nm\n1,2\n1\n1,2,3\n", &["3:2: the row has 1 fields, the header has 2; [..]", "4:3: the row has 3 fields, [..]"]),
        ("ratio,torque_Nm\n1,2\n2,2\n1.0,2000 Nmm\n", &["4:1: the row equals that of line 2; drop one"]),
        ("ratio,torque_Nm\n1,inf\n", &["2:2: column \"torque_Nm\": \"inf\" is not a number[..]"]),
    ];
    for (csv, expected) in cases {
        std::fs::write(folder.path().join("belts.csv"), csv).unwrap();
        let errors = Study::parse_in(&text, "study.toml", folder.path()).unwrap_err().to_string();
        let found: Vec<_> = errors.lines().map(|line| line.strip_prefix("belts.csv:").unwrap_or(line)).collect();
        let fits = found.len() == expected.len() && found.iter().zip(*expected).all(|(found, expected)| reads_as(found, expected));
        assert!(fits, "{csv:?}: {errors}");
    }
    // The path is relative to the user's folder, as that of the study.
    let errors = Study::parse_in(&text, "studies/study.toml", folder.path()).unwrap_err();
    assert_eq!(Path::new(&errors.problems[0].file), Path::new("studies/belts.csv"));
    // A file without any valid line is not reported line by line.
    std::fs::write(folder.path().join("belts.csv"), format!("ratio\n{}", "x\n".repeat(1000))).unwrap();
    assert!(Study::parse_in(&text, "study.toml", folder.path()).unwrap_err().problems.len() < 30);
}

/// A small random number generator, so that a seed is enough to see a failure again.
struct SplitMix64(u64);

impl SplitMix64 {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, limit: usize) -> usize {
        usize::try_from(self.next() % limit.max(1) as u64).unwrap()
    }
}

/// Words, numbers, spaces, and every other character alone.
fn tokens(text: &str) -> Vec<String> {
    let kind = |c: char| {
        if c.is_alphanumeric() || "_.-+".contains(c) {
            1
        } else if c == ' ' {
            2
        } else {
            0
        }
    };
    let mut tokens: Vec<String> = Vec::new();
    for c in text.chars() {
        match tokens.last_mut() {
            Some(last) if kind(c) != 0 && last.chars().next().map(kind) == Some(kind(c)) => last.push(c),
            _ => tokens.push(c.to_string()),
        }
    }
    tokens
}

/// What is inserted: tokens with a meaning at the wrong place, and tokens without a meaning.
const SALT: &[&str] = &[
    "[",
    "]",
    "{",
    "}",
    "=",
    ",",
    "\"",
    "'",
    "\"\"\"",
    "#",
    "\n",
    "\r\n",
    ".",
    "-",
    "0",
    "1e-300",
    "1e308",
    "-1e308",
    "nan",
    "inf",
    "true",
    "1979-05-27",
    "0x1F",
    "9007199254740993",
    "99999999999999999999",
    "\"limit\"",
    "\"12 lbf\"",
    "\"0.1 in\"",
    "count",
    "step",
    "from",
    "to",
    "spacing",
    "\"log\"",
    "cases",
    "csv",
    "ratio",
    "traction",
    "[sample]\n",
    "[design]\n",
    "[[report.maps]]\n",
    "é",
    "\u{feff}",
    "\u{0}",
    "\\",
    "best",
    "\"share\"",
    "method",
    "\"sobol\"",
];

/// Bytes that matter in TOML, and one that is no text.
const BYTES: &[u8] = b" \t\n\r[]{}=,.\"'#\\-+0123456789eE_x\x00\xff";

/// One to four changes of tokens or bytes.
fn mutated(text: &str, random: &mut SplitMix64) -> String {
    let mut text = text.to_owned();
    for _ in 0..=random.below(4) {
        if random.below(2) == 0 {
            let mut parts = tokens(&text);
            let (a, b) = (random.below(parts.len()), random.below(parts.len()));
            let salt = SALT[random.below(SALT.len())].to_owned();
            match random.below(5) {
                _ if parts.is_empty() => parts.push(salt),
                0 => drop(parts.remove(a)),
                1 => parts.insert(a, salt),
                2 => parts[a] = salt,
                3 => parts.insert(b, parts[a].clone()),
                _ => parts.swap(a, b),
            }
            text = parts.concat();
        } else {
            let mut bytes = text.into_bytes();
            let (a, b) = (random.below(bytes.len()), random.below(bytes.len()));
            let byte = BYTES[random.below(BYTES.len())];
            match random.below(6) {
                _ if bytes.is_empty() => bytes.push(byte),
                0 => drop(bytes.remove(a)),
                1 => bytes.insert(a, byte),
                2 => bytes[a] = byte,
                3 => bytes.insert(b, bytes[a]),
                4 => bytes.swap(a, b),
                _ => drop(bytes.drain(a.min(b)..(a.min(b) + 40).min(a.max(b)))),
            }
            text = String::from_utf8_lossy(&bytes).into_owned();
        }
    }
    text
}

#[test]
fn no_mutation_of_a_study_makes_the_reader_fail() {
    let sampled = edited(
        EXAMPLE,
        &[
            (1, "model = \"metal-cvt\"\n[sample]\nmethod = \"latin-hypercube\"\ncount = 1000\nseed = 7"),
            (2, ""),
            (4, "groove_angle_deg = { from = 18, to = 30 }"),
            (9, "cases = [{ ratio = 2, torque_Nm = 150 }, { ratio = 0.5, torque_Nm = \"60 Nm\" }]"),
            (10, "cases_2 = { csv = \"belts.csv\" }"),
            (19, "axial_force_N = { goal = \"min\", resolution = \"10 N\" }"),
            (27, ""),
        ],
    );
    for seed in 0..20_000 {
        let mut random = SplitMix64(seed);
        let base = if random.below(4) == 0 { &sampled } else { EXAMPLE };
        let text = mutated(base, &mut random);
        let result = std::panic::catch_unwind(|| parse(&text));
        let Ok(result) = result else { panic!("seed {seed}: panic on\n{text}") };
        let problems = match result {
            Ok(study) => {
                let count = |axes: &[Axis]| axes.iter().map(|axis| u128::from(axis.count())).product::<u128>();
                assert!((1..=u128::from(u64::MAX)).contains(&count(&study.design)), "seed {seed}:\n{text}");
                assert!(count(&study.operation) * count(&study.uncertainty) <= 1 << 32, "seed {seed}:\n{text}");
                for axis in study.design.iter().chain(&study.operation).chain(&study.uncertainty) {
                    for (column, &input) in axis.inputs().iter().enumerate() {
                        let (input, last) = (&study.model.inputs[input], axis.count() - 1);
                        let good = [0, last / 2, last].map(|index| input.accepts(axis.value(column, index)));
                        assert_eq!(good, [true; 3], "seed {seed}: {axis:?}\n{text}");
                    }
                }
                continue;
            }
            Err(errors) => errors.problems,
        };
        assert!(!problems.is_empty(), "seed {seed}:\n{text}");
        let lines: Vec<_> = text.split('\n').collect();
        let places: Vec<_> = problems.iter().map(|problem| (problem.line, problem.column)).collect();
        assert!(places.is_sorted(), "seed {seed}: {places:?}\n{text}");
        for problem in problems {
            let inside = problem.line >= 1 && problem.column >= 1 && problem.line <= lines.len();
            assert!(inside && problem.column <= lines[problem.line - 1].chars().count() + 1, "seed {seed}: {problem}\n{text}");
            assert!(!problem.message.is_empty() && !problem.message.contains(char::is_control), "seed {seed}: {problem}\n{text}");
            assert_eq!(problem.file, "study.toml");
        }
    }
}

#[test]
fn sizes_beyond_all_bounds_are_refused_at_once() {
    let start = std::time::Instant::now();
    for range in [
        "{ from = 0.1, to = 0.3, step = 1e-300 }",
        "{ from = 0.1, to = 0.3, step = 5e-324 }",
        "{ from = 1e-300, to = 1e300, step = 1e-9, spacing = \"log\" }",
        "{ from = 1e-5, to = 1e300, step = 1e-300, spacing = \"log\" }",
        "{ from = 1, to = 1e308, step = 1 }",
        "{ from = 1, to = 2, count = 18446744073709551615 }",
        "{ from = 1, to = 2, count = 99999999999999999999999999 }",
        "{ from = 1e307, to = 1e308, count = 9007199254740992 }",
    ] {
        let found = problems(&edited(EXAMPLE, &[(5, &format!("band_thickness_mm = {range}"))]));
        assert!(!found.is_empty() && found[0].starts_with("5:"), "{range}: {found:?}");
    }
    let deep = format!("model = {}", "[".repeat(100_000));
    assert!(!problems(&deep).is_empty());
    let long = format!("model = \"{}\"", "é".repeat(1_000_000));
    assert!(problems(&long).concat().len() < 1000);
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
}

/// An axis of one input.
fn single(study: &Study, name: &str, levels: Levels) -> Axis {
    Axis::Single { input: study.model.input(name).unwrap(), levels }
}

#[test]
fn the_example_means_what_it_says() {
    let study = parse(EXAMPLE).unwrap();
    assert_eq!(study.model.name, "metal-cvt");
    assert_eq!(study.title, "Push belt for 150 N m: every ratio, friction known to +-20 %");
    let designs: Vec<_> = study.design.iter().map(Axis::count).collect();
    let scenarios: Vec<_> = study.operation.iter().chain(&study.uncertainty).map(Axis::count).collect();
    assert_eq!((designs, scenarios), (vec![61, 41, 9, 11], vec![31, 2, 7]));
    assert_eq!(
        study.design,
        [
            single(&study, "groove_angle_deg", Levels::Even { from: 18.0, to: 30.0, count: 61, log: false }),
            single(&study, "band_thickness_mm", Levels::Step { from: 0.1, step: 0.005, count: 41, log: false }),
            single(&study, "band_count", Levels::Step { from: 6.0, step: 1.0, count: 9, log: false }),
            single(&study, "traction", Levels::Even { from: 0.3, to: 0.5, count: 11, log: false }),
        ]
    );
    let ratio = single(&study, "ratio", Levels::Even { from: 0.5, to: 2.0, count: 31, log: true });
    assert_eq!(study.operation, [ratio, single(&study, "torque_Nm", Levels::List(vec![50.0, 150.0]))]);
    assert_eq!(study.uncertainty, [single(&study, "friction", Levels::Even { from: 0.065, to: 0.095, count: 7, log: false })]);
    let mut fixed = study.model.defaults();
    fixed[study.model.input("strength_MPa").unwrap()] = 800.0;
    assert_eq!((study.fixed.clone(), study.sample), (fixed, None));
    let output = |name| Quantity::Output(study.model.output(name).unwrap());
    let (force, stress, slip) = (output("axial_force_N"), output("stress_margin"), output("slip_margin"));
    let constraint = |quantity| Constraint { quantity, low: Some((0.0, false)), high: None, over: OverScenarios::Worst };
    assert_eq!(study.constraints, [constraint(slip), constraint(stress)]);
    let objective = |quantity, goal| Objective { quantity, goal, resolution: None, over: OverScenarios::Worst };
    let bands = Quantity::Input(study.model.input("band_count").unwrap());
    let objectives = [(force, Goal::Min), (stress, Goal::Max), (slip, Goal::Max), (bands, Goal::Min)];
    assert_eq!(study.objectives, objectives.map(|(quantity, goal)| objective(quantity, goal)));
    assert_eq!(
        study.report,
        Report {
            variants: false,
            feasible: false,
            columns: vec![output("max_stress_MPa").into()],
            top: Some(TopSpec { by: force, goal: Goal::Min, count: 20 }),
            histograms: vec![HistogramSpec { of: force, range: Some((0.0, 60_000.0)), bins: 60 }],
            maps: vec![MapSpec { x: 1, y: 0, value: Best::Value(force, Goal::Min), contours: Vec::new() }],
            sample: None,
            front_budget: 1_000_000,
            sensitivity: None,
        }
    );
}

#[test]
fn axes_keep_the_order_of_the_file() {
    let names = ["torque_Nm", "band_count", "strength_MPa", "friction", "ratio"];
    let axes: String = names.iter().map(|name| format!("{name} = 1\n")).collect();
    let study = parse(&format!("model = \"metal-cvt\"\n[objectives]\nslip_margin = \"max\"\n[design]\n{axes}")).unwrap();
    let found: Vec<_> = study.design.iter().map(|axis| study.model.inputs[axis.inputs()[0]].name.as_str()).collect();
    assert_eq!(found, names);
    assert_eq!(study.title, study.model.summary);
}

#[test]
fn every_form_of_an_axis_is_understood() {
    let levels = |name: &str, form: &str| {
        let text = format!("model = \"metal-cvt\"\n[objectives]\nslip_margin = \"max\"\n[design]\n{name} = {form}\n");
        match parse(&text).map(|study| study.design[0].clone()) {
            Ok(Axis::Single { levels, .. }) => levels,
            other => panic!("{form}: {other:?}"),
        }
    };
    let list = |values: &[f64]| Levels::List(values.to_vec());
    assert_eq!(levels("band_width_mm", "9"), list(&[9.0]));
    assert_eq!(levels("band_width_mm", "\"0.25 in\""), list(&[6.35]));
    assert_eq!(levels("band_width_mm", "[9, 8.5, \"1 cm\"]"), list(&[9.0, 8.5, 10.0]));
    assert_eq!(levels("traction", "[\"limit\", 0.25, \"40 %\"]"), list(&[-1.0, 0.25, 0.4]));
    assert_eq!(levels("torque_Nm", "[-0.0, 0x10, 1_000]"), list(&[0.0, 16.0, 1000.0]));
    let even = |from, to, count, log| Levels::Even { from, to, count, log };
    assert_eq!(levels("band_width_mm", "{ from = \"1 cm\", to = 5, count = 6 }"), even(10.0, 5.0, 6, false));
    assert_eq!(levels("ratio", "{ count = 1, from = 2, to = 2.0, spacing = \"linear\" }"), even(2.0, 2.0, 1, false));
    assert_eq!(levels("ratio", "{ from = 2, to = 0.5, count = 3.0, spacing = \"log\" }"), even(2.0, 0.5, 3, true));
    assert_eq!(levels("band_count", "{ from = 14, to = 6, count = 5 }"), even(14.0, 6.0, 5, false));
    let step = |from, step, count, log| Levels::Step { from, step, count, log };
    assert_eq!(levels("band_count", "{ from = 6, to = 13, step = 3 }"), step(6.0, 3.0, 3, false));
    assert_eq!(levels("band_width_mm", "{ from = 0.1, to = 0.3, step = 0.1 }"), step(0.1, 0.1, 3, false));
    assert_eq!(levels("band_width_mm", "{ from = 5, to = 5, step = 1 }"), step(5.0, 1.0, 1, false));
    assert_eq!(levels("band_width_mm", "{ from = \"1 cm\", to = \"2 cm\", step = \"5 mm\" }"), step(10.0, 5.0, 3, false));
    assert_eq!(levels("band_width_mm", "{ from = 0.1, to = 100, step = 1, spacing = \"log\" }"), step(0.1, 1.0, 4, true));
    assert_eq!(levels("band_width_mm", "{ from = 1, to = 9.99, step = 0.5, spacing = \"log\" }"), step(1.0, 0.5, 2, true));
    // Rounding neither drops the last level of a step axis nor adds one.
    for count in 2..400_u32 {
        for width in [0.1, 0.05, 0.005, 1.0 / 3.0] {
            let to = 0.1 + f64::from(count - 1) * width;
            let counted = |to: f64| levels("band_width_mm", &format!("{{ from = 0.1, to = {to}, step = {width} }}")).count();
            assert_eq!((counted(to), counted(to - 1e-9)), (u64::from(count), u64::from(count - 1)));
        }
    }
}

#[test]
fn joint_axes_come_from_rows_and_from_a_csv_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("data")).unwrap();
    let csv = "\u{feff}belt_length_mm, centre_distance_mm ,traction\r\n\r\n613,156,limit\r\n\"25 in\",160,0.4\r\n";
    std::fs::write(folder.path().join("data/belts.csv"), csv).unwrap();
    let text = "model = \"metal-cvt\"\n[design]\nband_count = [8, 10]\ncases = { csv = \"data/belts.csv\" }\n[operation]\n\
                cases = [{ ratio = 2, torque_Nm = 150 }, { torque_Nm = \"60 Nm\", ratio = 0.5 }]\ncases_2 = [{ friction = 0.08 }]\n\
                [objectives]\nslip_margin = \"max\"\n";
    std::fs::write(folder.path().join("study.toml"), text).unwrap();
    let (study, read) = Study::read(&folder.path().join("study.toml")).unwrap();
    assert_eq!(read, text);
    let joint = |names: &[&str], rows: &[&[f64]]| Axis::Joint {
        inputs: names.iter().map(|name| study.model.input(name).unwrap()).collect(),
        rows: rows.iter().map(|row| row.to_vec()).collect(),
    };
    let belts = joint(&["belt_length_mm", "centre_distance_mm", "traction"], &[&[613.0, 156.0, -1.0], &[635.0, 160.0, 0.4]]);
    assert_eq!(study.design[1], belts);
    assert_eq!(study.operation, [joint(&["ratio", "torque_Nm"], &[&[2.0, 150.0], &[0.5, 60.0]]), joint(&["friction"], &[&[0.08]])]);
}

#[test]
fn sampled_designs_take_whole_ranges() {
    let study = parse(
        "model = \"metal-cvt\"\n[sample]\nmethod = \"latin-hypercube\"\ncount = 1e6\n\
         [design]\nratio = { from = 0.5, to = 2, spacing = \"log\" }\nband_count = { from = 6, to = 14 }\n\
         friction = { from = 0.06, to = 0.1, count = 5 }\n[report]\nhistograms = [{ of = \"slip_margin\" }]\n",
    );
    let study = study.unwrap();
    assert_eq!(study.sample, Some(Sample { method: Method::LatinHypercube, count: 1_000_000, seed: 0 }));
    let ratio = single(&study, "ratio", Levels::Continuous { from: 0.5, to: 2.0, log: true });
    let bands = single(&study, "band_count", Levels::Step { from: 6.0, step: 1.0, count: 9, log: false });
    assert_eq!(study.design[..2], [ratio, bands]);
    let of = Quantity::Output(study.model.output("slip_margin").unwrap());
    assert_eq!(study.report.histograms, [HistogramSpec { of, range: None, bins: 50 }]);
}

#[test]
fn constraints_objectives_and_reports_are_understood() {
    let study = parse(
        "model = \"metal-cvt\"\n[design]\nratio = [1, 2]\nband_count = [8, 9]\nbelt_length_mm = [613, 620]\n[constraints]\n\
         axial_force_N = { above = 0, max = \"20 kN\" }\nband_width_mm = { below = \"1 in\" }\n[objectives]\n\
         max_stress_MPa = { goal = \"min\", resolution = \"100 kPa\" }\n[report]\ntop = { by = \"slip_margin\", count = 3 }\n\
         maps = [{ x = \"belt_length_mm\", y = \"ratio\", value = \"max_stress_MPa\" }, \
         { x = \"ratio\", y = \"band_count\", best = \"share\" }, \
         { x = \"ratio\", y = \"band_count\", value = \"axial_force_N\", best = \"max\" }]\nfront_budget = 1e9\n",
    );
    let study = study.unwrap();
    let output = |name| Quantity::Output(study.model.output(name).unwrap());
    let width = Quantity::Input(study.model.input("band_width_mm").unwrap());
    let over = OverScenarios::Worst;
    let force = Constraint { quantity: output("axial_force_N"), low: Some((0.0, true)), high: Some((20_000.0, false)), over };
    assert_eq!(study.constraints, [force, Constraint { quantity: width, low: None, high: Some((25.4, true)), over }]);
    assert_eq!(study.objectives, [Objective { quantity: output("max_stress_MPa"), goal: Goal::Min, resolution: Some(0.1), over }]);
    // The goal follows from what is worse: a margin is best when large.
    assert_eq!(study.report.top, Some(TopSpec { by: output("slip_margin"), goal: Goal::Max, count: 3 }));
    let map = |x, y, value| MapSpec { x, y, value, contours: Vec::new() };
    let maps = [
        map(2, 0, Best::Value(output("max_stress_MPa"), Goal::Min)),
        map(0, 1, Best::Share),
        map(0, 1, Best::Value(output("axial_force_N"), Goal::Max)),
    ];
    assert_eq!((study.report.maps.as_slice(), study.report.front_budget), (maps.as_slice(), 1_000_000_000));
}

/// Broken studies. A block has the lines of the example that are changed (see [`edited`]) and then, one per line, every
/// problem with its position: `line:column: message`. `[..]` stands for anything.
const BROKEN: &str = include_str!("bad_studies/broken.txt");

/// A study with distributions, and wrong lines of it in the same form.
const DRAWN: &str = include_str!("bad_studies/drawn.toml");
const WRONG_DISTRIBUTIONS: &str = include_str!("bad_studies/drawn.txt");
