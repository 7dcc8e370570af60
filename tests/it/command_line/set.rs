//! `--set` with a study: the same study as one written so by hand, and clear words where that cannot be.

use super::report::data_of;
use super::{SMALL, ask, ask_words, changed, files, folder_with, json_of, read, same_result, write};

const COST: &str = include_str!("../formulas/cost.toml");
const MEASURED: &str = include_str!("../formulas/measured.toml");
const CURVE: &str = include_str!("../formulas/slip.csv");

/// The description of the study that a sweep was of.
fn described(folder: &std::path::Path, words: &[&str]) -> String {
    ask_words(folder, &[&["sweep", "study.toml", "--out", "described", "--force", "--quiet", "--no-report"], words].concat()).text();
    read(&folder.join("described/study.json"))
}

#[test]
fn a_set_study_is_the_one_written_so_by_hand() {
    let by_hand = |text: &str| described(folder_with("study.toml", text).path(), &[]);
    let no_traction = ("traction          = { from = 0.30, to = 0.50, count = 5 }\n", "");
    for (set, edits) in [
        // In place of a fixed value, also in another unit.
        (&["strength_MPa=700"][..], &[("strength_MPa = 800", "strength_MPa = 700")][..]),
        (&["strength_MPa=0.7 GPa"], &[("strength_MPa = 800", "strength_MPa = \"0.7 GPa\"")]),
        // Of an axis of scenarios; of a default.
        (&["friction=0.08"], &[("friction  = [0.065, 0.095]", ""), ("strength_MPa = 800", "strength_MPa = 800\nfriction = 0.08")]),
        (&["band_width_mm = 9.5"], &[("strength_MPa = 800", "strength_MPa = 800\nband_width_mm = 9.5")]),
        // Of a design axis, by a word.
        (&["traction=limit"], &[no_traction, ("strength_MPa = 800", "strength_MPa = 800\ntraction = \"limit\"")]),
        (
            &["traction=0.4", "ratio=1"],
            &[
                no_traction,
                ("ratio     = { from = 0.5, to = 2.0, count = 3, spacing = \"log\" }\n", ""),
                ("strength_MPa = 800", "strength_MPa = 800\ntraction = 0.4\nratio = 1"),
            ],
        ),
    ] {
        let folder = folder_with("study.toml", SMALL);
        let words: Vec<&str> = set.iter().flat_map(|it| ["--set", it]).collect();
        assert_eq!(described(folder.path(), &words), by_hand(&changed(SMALL, edits)), "{set:?}");
    }
}

#[test]
fn every_way_to_write_a_table_can_be_set() {
    let rest = "[objectives]\naxial_force_N = \"min\"\n";
    let expected = described(
        folder_with(
            "study.toml",
            &format!("model = \"metal-cvt\"\n[design]\nband_count = [6, 9]\n[fixed]\nratio = 2\nfriction = 0.1\n{rest}"),
        )
        .path(),
        &[],
    );
    for head in [
        "design.band_count = [6, 9]\ndesign.friction = [0.1, 0.2]\nfixed.ratio = 2\n",
        "design = { friction = [0.1, 0.2], band_count = [6, 9] }\nfixed = { ratio = 2 }\n",
        "design = { band_count = [6, 9], friction = [0.1, 0.2] }\nfixed = {}\noperation = { ratio = [1, 2] } # both\n",
        "[design]\nband_count = [6, 9]\nfriction = [ # as measured\n  0.1,\n  0.2,\n]\n[fixed]\nratio = 1 # for now\n",
        "[fixed]\nratio = 1\n[design]\nband_count = [6, 9]\n[operation]\nfriction = { from = 0.1, to = 0.2, count = 3 }\n",
    ] {
        let folder = folder_with("study.toml", &format!("model = \"metal-cvt\"\n{head}{rest}"));
        assert_eq!(described(folder.path(), &["--set", "friction=0.1", "--set", "ratio=2"]), expected, "{head}");
    }
    // What cannot be edited is refused, and says what to do.
    let folder = folder_with(
        "study.toml",
        &format!("model = \"metal-cvt\"\n[design]\nratio = [1, 2]\n[design.friction]\nfrom = 0.1\nto = 0.2\ncount = 2\n{rest}"),
    );
    let said = ask(folder.path(), "check study.toml --set friction=0.1").refusal(2);
    assert_eq!(said, "error: --set friction=0.1: the study is written in a way that cannot be edited; give the value in its [fixed]\n");
}

#[test]
fn a_formula_that_gives_an_input_goes_and_a_variable_stays_one() {
    let folder = folder_with("study.toml", MEASURED);
    write(folder.path(), "slip.csv", CURVE);
    let own = described(folder.path(), &["--set", "friction=0.09"]);
    let by_hand = changed(
        MEASURED,
        &[
            ("friction = \"friction_of_speed(band_speed_m_per_s) * tanh(band_count / 4)\"\n", ""),
            ("[formulas]", "[fixed]\nfriction = 0.09\n[formulas]"),
        ],
    );
    write(folder.path(), "study.toml", &by_hand);
    assert_eq!(own, described(folder.path(), &[]));
    let folder = folder_with("study.toml", COST);
    let own = described(folder.path(), &["--set", "belt_price_EUR_per_kg=13"]);
    assert!(own.contains("\"belt_price_EUR_per_kg\": 13"), "{own}");
    let said = ask(folder.path(), "check study.toml --set cost_EUR=3").refusal(2);
    let line = 1 + COST[..COST.find("\ncost_EUR").expect("it is a formula")].matches('\n').count() + 1;
    let told = format!(
        "cost_EUR is what the formula in line {line} gives; only inputs and variables can be set: change the formula, or set what it reads"
    );
    assert_eq!(said, format!("error: --set cost_EUR=3: {told}\n"));
}

#[test]
fn what_only_a_formula_read_goes_with_it() {
    let study = |fixed: &str, formulas: &str| {
        format!(
            "model = \"metal-cvt\"\n[design]\nband_count = [8, 9]\n{fixed}[formulas]\n{formulas}[objectives]\naxial_force_N = \"min\"\n"
        )
    };
    let folder = folder_with("study.toml", &study("[fixed]\nshare = 2 # of it\nstrength_MPa = 700\n", "torque_Nm = \"20[N m] * share\"\n"));
    let own = described(folder.path(), &["--set", "torque_Nm=50"]);
    write(folder.path(), "study.toml", &study("[fixed]\nstrength_MPa = 700\ntorque_Nm = 50\n", ""));
    assert_eq!(own, described(folder.path(), &[]));
    // Wherever else the name stands in the text.
    let noted = study("[fixed]\nshare = 2\n", "# torque and its share\ntorque_Nm = { is = \"20[N m] * share\" }\n");
    write(folder.path(), "study.toml", &noted);
    assert!(!described(folder.path(), &["--set", "torque_Nm=50"]).contains("share"));
    // What another formula reads stays.
    let formulas = "torque_Nm = \"20[N m] * share\"\nlost_W = \"share * 3[W]\"\n";
    write(folder.path(), "study.toml", &study("[fixed]\nshare = 2\n", formulas));
    assert!(described(folder.path(), &["--set", "torque_Nm=50"]).contains("\"share\": 2"));
}

#[test]
fn a_formula_without_which_an_axis_means_nothing_stays() {
    let folder = folder_with("study.toml", include_str!("../../../studies/metal-cvt.toml"));
    let line = |start: &str| {
        let text = read(&folder.path().join("study.toml"));
        1 + text.lines().position(|it| it.starts_with(start)).expect("it has such a line")
    };
    let (formula, axis) = (line("clamping_force_N ="), line("reserve "));
    let told = format!(
        "the formula in line {formula} gives clamping_force_N, and nothing else reads reserve of line {axis}; set design.reserve=[VALUE] \
         instead, or take that formula and reserve out of the study"
    );
    for line in ["check study.toml", "eval study.toml --design 5"] {
        let said = ask(folder.path(), &format!("{line} --set clamping_force_N=20000")).refusal(2);
        assert_eq!(said, format!("error: --set clamping_force_N=20000: {told}\n"));
    }
    // What it advises works, and keeps the map over that axis.
    ask(folder.path(), "check study.toml --set design.reserve=[1.4]").text();
    let said = ask(folder.path(), "check study.toml --set traction=0.4").refusal(2);
    let beside = format!("clamping_force_N, which the formula in line {formula} gives and which takes its place; drop one of the two");
    assert_eq!(said, format!("error: --set traction=0.4: \"traction\" cannot be given beside {beside}\n"));
}

/// What is set in [`SMALL`], and all that is said of it.
const WRONG: [(&str, &str); 14] = [
    ("ratio", "--set \"ratio\": write NAME=VALUE"),
    ("ratio=", "--set \"ratio=\": write NAME=VALUE"),
    ("frictoin=0.1", "--set frictoin=0.1: metal-cvt has no input \"frictoin\"; did you mean \"friction\"?"),
    ("a b=0.1", "--set a b=0.1: there is no input of that name; names have letters, digits and \"_\""),
    (
        "slip_margin=2",
        "--set slip_margin=2: slip_margin is an output; outputs can be constrained, made an objective or reported, only inputs can be given values",
    ),
    ("friction=-1", "--set friction=-1: -1 is out of range; it must be greater than 0"),
    ("friction=3 N", "--set friction=3 N: \"N\" measures a force, but a plain number is wanted; use %"),
    ("traction=foo", "--set traction=foo: \"foo\" is not a number with a unit; write for example \"12\"; or write \"limit\""),
    ("strength_MPa=-1", "--set strength_MPa=-1: -1 is out of range; it must be greater than 0 (MPa)"),
    ("band_count=7.5", "--set band_count=7.5: 7.5 is not a whole number; use 7 or 8"),
    (
        "band_count=9",
        "study.toml:28:36: maps: \"band_count\" is no design axis; choose one of [design], or put it there; without --set band_count=9 the study is right; --set design.band_count=[9] keeps it as an axis",
    ),
    (
        "torque_Nm=[150,160]",
        "--set torque_Nm=[150,160]: a name alone takes one value, and several are an axis; write --set operation.torque_Nm=[150,160]",
    ),
    (
        "strength_MPa=[700,800]",
        "--set strength_MPa=[700,800]: a name alone takes one value, and several are an axis; write strength_MPa = [700,800] in [operation] or [design] of the study",
    ),
    (
        "friction=off",
        "--set friction=off: \"off\" takes out a whole constraint or objective, as constraints.NAME=off; an input needs a value",
    ),
];

#[test]
fn what_cannot_be_set_is_told_by_its_name() {
    let folder = folder_with("study.toml", SMALL);
    for (set, told) in WRONG {
        for command in ["check", "sweep"] {
            assert_eq!(ask_words(folder.path(), &[command, "study.toml", "--set", set]).refusal(2), format!("error: {told}\n"));
        }
    }
    let twice = ask(folder.path(), "check study.toml --set ratio=1 --set ratio=2").refusal(2);
    assert_eq!(twice, "error: --set gives ratio twice; keep one of the two\n");
    // What is wrong with the study itself is told at its place, though lines were put in.
    write(folder.path(), "study.toml", &changed(SMALL, &[("axial_force_N = \"min\"", "axial_farce_N = \"min\"")]));
    let broken = ask(folder.path(), "check study.toml --set ratio=1 --set band_width_mm=9 --feasible").refusal(2);
    assert!(broken.starts_with("error: study.toml:19:1: objective \"axial_farce_N\"") && !broken.contains("without --set"), "{broken}");
    let alone = "model = \"metal-cvt\"\n[design]\nfriction = [0.08, 0.09]\n[objectives]\naxial_force_N = \"min\"\n";
    write(folder.path(), "study.toml", alone);
    let none = ask(folder.path(), "check study.toml --set friction=0.1").refusal(2);
    assert_eq!(
        none,
        "error: study.toml:2:1: there is nothing to choose; name at least one input in [design], such as friction = [...]; \
         without --set friction=0.1 the study is right\n"
    );
    let joint = "model = \"metal-cvt\"\n[design]\nband_count = [6, 7]\n[operation]\ncases = [{ ratio = 1, torque_Nm = 50 }, { ratio = 2, torque_Nm = 60 }]\n[objectives]\naxial_force_N = \"min\"\n";
    write(folder.path(), "study.toml", joint);
    let said = ask(folder.path(), "check study.toml --set torque_Nm=70").refusal(2);
    let told = "torque_Nm is set by the rows of \"cases\" in [operation]; --set replaces the axis of one input: give each row its value, as operation.cases.1.torque_Nm";
    assert_eq!(said, format!("error: --set torque_Nm=70: {told}\n"));
    write(folder.path(), "loads.csv", "ratio,torque_Nm\n1,50\n2,60\n");
    write(
        folder.path(),
        "study.toml",
        &changed(joint, &[("[{ ratio = 1, torque_Nm = 50 }, { ratio = 2, torque_Nm = 60 }]", "{ csv = \"loads.csv\" }")]),
    );
    let told =
        "torque_Nm is set by the rows of \"cases\" in [operation]; --set replaces the axis of one input: change the rows in \"loads.csv\"";
    assert_eq!(ask(folder.path(), "check study.toml --set torque_Nm=70").refusal(2), format!("error: --set torque_Nm=70: {told}\n"));
    write(
        folder.path(),
        "study.toml",
        &changed(joint, &[("cases = [", "duty = { weight = \"h\", cases = ["), ("60 }]", "60, h = 2 }] }"), ("50 }", "50, h = 1 }")]),
    );
    let told = "torque_Nm is set by the rows of \"duty.cases\" in [operation]; --set replaces the axis of one input: give each row its value, as operation.duty.cases.1.torque_Nm";
    assert_eq!(ask(folder.path(), "check study.toml --set torque_Nm=70").refusal(2), format!("error: --set torque_Nm=70: {told}\n"));
    ask(folder.path(), "check study.toml --set operation.duty.cases.1.torque_Nm=70 --set operation.duty.cases.1.h=3").text();
    let by_file = changed(joint, &[("[{ ratio = 1, torque_Nm = 50 }, { ratio = 2, torque_Nm = 60 }]", "{ csv = \"loads.csv\" }")]);
    write(folder.path(), "study.toml", &by_file);
    let said = ask(folder.path(), "check study.toml --set operation.cases.1.torque_Nm=70").refusal(2);
    assert!(said.contains("\"1\" cannot be set: its rows are in the text \"loads.csv\"; change them there"), "{said}");
}

/// Parts of the study: what is set, and what a person would write in its place.
#[test]
fn a_part_of_a_study_that_is_set_is_as_if_it_was_written_so() {
    let by_hand = |text: &str| described(folder_with("study.toml", text).path(), &[]);
    let margins = "stress_margin = { max = 0.95, min = 0 }";
    for (set, edits) in [
        (&["constraints.slip_margin.min=0.1"][..], &[("slip_margin   = { min = 0 }", "slip_margin   = { min = 0.1 }")][..]),
        (
            &["constraints.stress_margin.max=0.9", "constraints.stress_margin.min=-0.1"],
            &[(margins, "stress_margin = { max = 0.9, min = -0.1 }")],
        ),
        // A key that the entry does not have; an entry that the table does not have, of one key and of two.
        (&["constraints.slip_margin.max=0.4"], &[("slip_margin   = { min = 0 }", "slip_margin   = { min = 0, max = 0.4 }")]),
        (&["constraints.max_stress_MPa.max=700"], &[(margins, "stress_margin = { max = 0.95, min = 0 }\nmax_stress_MPa = { max = 700 }")]),
        (
            &["constraints.max_stress_MPa.min=100", "constraints.max_stress_MPa.max=700"],
            &[(margins, "stress_margin = { max = 0.95, min = 0 }\nmax_stress_MPa = { min = 100, max = 700 }")],
        ),
        // Without a constraint; an objective turned, taken out and added.
        (&["constraints.slip_margin=off"], &[("slip_margin   = { min = 0 }\n", "")]),
        (&["objectives.stress_margin=min"], &[("stress_margin = \"max\"", "stress_margin = \"min\"")]),
        (&["objectives.band_count=off"], &[("band_count    = \"min\"\n", "")]),
        (&["objectives.slip_margin=max"], &[("band_count    = \"min\"", "band_count    = \"min\"\nslip_margin = \"max\"")]),
        // Ends of axes, their levels, and a list of loads.
        (
            &["design.groove_angle_deg.to=29", "operation.ratio.count=4"],
            &[("to = 30", "to = 29"), ("to = 2.0, count = 3", "to = 2.0, count = 4")],
        ),
        (&["operation.torque_Nm=[50, 140]"], &[("[50, 150]", "[50, 140]")]),
        (&["operation.torque_Nm.2=140"], &[("[50, 150]", "[50, 140]")]),
        (&["uncertainty.friction=[0.07]", "fixed.strength_MPa=700"], &[("[0.065, 0.095]", "[0.07]"), ("= 800", "= 700")]),
        // Together with an input.
        (&["strength_MPa=700", "design.band_count.from=7"], &[("= 800", "= 700"), ("from = 6", "from = 7")]),
    ] {
        let folder = folder_with("study.toml", SMALL);
        let words: Vec<&str> = set.iter().flat_map(|it| ["--set", it]).collect();
        assert_eq!(described(folder.path(), &words), by_hand(&changed(SMALL, edits)), "{set:?}");
    }
}

/// Rows of cases, parameters of distributions and the number of draws.
#[test]
fn rows_and_distributions_have_parts_too() {
    let drawn = "model = \"metal-cvt\"\n[design]\nband_count = [8, 9]\ntraction = [0.4, 0.5]\n[operation]\ncases = [{ ratio = 1, torque_Nm = 50 }, { ratio = 2, torque_Nm = 60 }]\n\
        [uncertainty]\nfriction = { normal = { mean = 0.08, sd = 0.005 }, from = 0.06, to = 0.1 }\nbelt_length_mm = { plus = { triangular = [-1, 0, 1] } }\n\
        [probability]\ndraws = 512\nconfirm = 1000\n[constraints]\nslip_margin = { min = 0 }\n[objectives]\nyield = \"max\"\nband_count = \"min\"\n";
    let by_hand = |text: &str| described(folder_with("study.toml", text).path(), &[]);
    for (set, edits) in [
        (&["operation.cases.2.torque_Nm=65"][..], &[("torque_Nm = 60", "torque_Nm = 65")][..]),
        (
            &["operation.cases.1.ratio=0.8", "operation.cases.1.torque_Nm=55"],
            &[("ratio = 1, torque_Nm = 50", "ratio = 0.8, torque_Nm = 55")],
        ),
        (
            &["uncertainty.friction.normal.sd=0.004", "uncertainty.friction.to=0.09"],
            &[("sd = 0.005", "sd = 0.004"), ("to = 0.1", "to = 0.09")],
        ),
        (&["uncertainty.belt_length_mm.plus.triangular.3=2"], &[("[-1, 0, 1]", "[-1, 0, 2]")]),
        (&["probability.draws=1024", "probability.seed=7"], &[("draws = 512\nconfirm = 1000", "draws = 1024\nconfirm = 1000\nseed = 7")]),
    ] {
        let folder = folder_with("study.toml", drawn);
        let words: Vec<&str> = set.iter().flat_map(|it| ["--set", it]).collect();
        assert_eq!(described(folder.path(), &words), by_hand(&changed(drawn, edits)), "{set:?}");
    }
    let folder = folder_with("study.toml", drawn);
    for (set, told) in [
        ("operation.cases.3.ratio=1", "\"3\" cannot be set; cases of [operation] has 2 values or rows, numbered from 1"),
        ("operation.cases.1.friction=1", "\"friction\" cannot be set; keys are ratio, torque_Nm"),
        ("operation.cases.1=1", "it has parts of its own, each of which can be set: ratio, torque_Nm"),
        ("operation.cases.1.ratio.from=1", "\"from\" cannot be set: ratio is the number 1"),
        ("uncertainty.friction.normal.mode=1", "\"mode\" cannot be set; keys are mean, sd"),
        ("uncertainty.friction.csv=a.csv", "\"csv\" cannot be set"),
        ("uncertainty.friction.sd=0.1", "\"sd\" cannot be set; keys are normal, from, to"),
        (
            "constraints.slip.margin.min=1",
            "a constraint has one key; if its name is \"slip.margin\", write constraints.\"slip.margin\".min",
        ),
    ] {
        let said = ask_words(folder.path(), &["check", "study.toml", "--set", set]).refusal(2);
        assert!(said.starts_with(&format!("error: --set {set}: ")) && said.contains(told), "{set}: {said}");
    }
}

/// Constraints may be called anything, and stand under a header of their own.
#[test]
fn constraints_of_every_name_and_form_can_be_set() {
    let by_hand = |text: &str| described(folder_with("study.toml", text).path(), &[]);
    let labelled = changed(
        SMALL,
        &[(
            "slip_margin   = { min = 0 }",
            "no-slip = { of = \"slip_margin\", min = 0 }\n\"größte Kraft\" = { of = \"axial_force_N\", max = 90000 }\n\"a.b\" = { of = \"max_stress_MPa\", max = 900 }",
        )],
    );
    for (set, from, to) in [
        ("constraints.no-slip.min=0.1", "of = \"slip_margin\", min = 0", "of = \"slip_margin\", min = 0.1"),
        ("constraints.\"größte Kraft\".max=80000", "max = 90000", "max = 80000"),
        ("constraints.\"a.b\".max=850", "max = 900 }", "max = 850 }"),
    ] {
        let folder = folder_with("study.toml", &labelled);
        assert_eq!(described(folder.path(), &["--set", set]), by_hand(&changed(&labelled, &[(from, to)])), "{set}");
    }
    // Under a header, with a comment behind it.
    let table = SMALL.replace("slip_margin   = { min = 0 }\n", "") + "\n[constraints.slip_margin]\nmin = 0\n# the end\n";
    let folder = folder_with("study.toml", &table);
    let without = by_hand(&SMALL.replace("slip_margin   = { min = 0 }\n", ""));
    assert_eq!(described(folder.path(), &["--set", "constraints.slip_margin=off"]), without);
    // Lines after a list that was longer keep their numbers.
    let long = changed(
        SMALL,
        &[("torque_Nm = [50, 150]", "torque_Nm = [\n  50,\n  150,\n]"), ("axial_force_N = \"min\"", "axial_farce_N = \"min\"")],
    );
    write(folder.path(), "study.toml", &long);
    let at = 1 + long[..long.find("axial_farce").expect("it is there")].matches('\n').count();
    let said = ask(folder.path(), "check study.toml --set operation.torque_Nm=[60]").refusal(2);
    assert!(said.starts_with(&format!("error: study.toml:{at}:1: ")), "{at}: {said}");
}

#[test]
fn a_part_that_cannot_be_set_is_told_by_its_name() {
    let folder = folder_with("study.toml", SMALL);
    for (set, told) in [
        (
            "report.top=1",
            "there is nothing to set in \"report\"; parts of a study begin with one of design, operation, uncertainty, fixed, constraints, objectives, probability",
        ),
        ("design.ratio.to=3", "the study has no ratio in [design]"),
        ("design.band_count.csv=rows.csv", "\"csv\" cannot be set; keys are from, to, count, step, spacing"),
        ("design.band_count={ csv = \"rows.csv\" }", "\"{ csv = \"rows.csv\" }\" is not a number with a unit; write for example \"12\""),
        ("operation.torque_Nm=[[1]]", "write a list of numbers or words, such as [50, 150]"),
        ("operation.torque_Nm=[1], x = [2", "write a list of numbers or words, such as [50, 150]"),
        ("operation.torque_Nm.from=1", "\"from\" cannot be set; torque_Nm of [operation] has 2 values or rows, numbered from 1"),
        ("constraints.slip_margin=3", "wanted bounds such as { min = 0 }"),
        ("constraints.axial_force_N=off", "the study has no axial_force_N in [constraints]"),
        ("constraints.slip_margin.min=x", "\"x\""),
        ("constraints.slip_margin.min=off", "write constraints.slip_margin=off, or give min another value"),
        ("operation.ratio=off", "\"off\" takes out a whole constraint or objective, as constraints.NAME=off; give another value"),
        ("objectives.stress_margin=up", "unknown goal \"up\""),
        ("operation.torque_Nm.3=160", "\"3\" cannot be set; torque_Nm of [operation] has 2 values or rows, numbered from 1"),
        ("design.band_count.spacingg=log", "\"spacingg\" cannot be set; keys are from, to, count, step, spacing"),
        ("probability.method=sobol", "\"method\" cannot be set; of [probability] these can: draws, confirm, seed"),
        ("probability.draws=1000", "[probability]"),
        ("fixed.strength_MPa.min=1", "\"min\" cannot be set; write fixed.strength_MPa=VALUE"),
    ] {
        let said = ask_words(folder.path(), &["check", "study.toml", "--set", set]).refusal(2);
        assert!(said.starts_with(&format!("error: --set {set}: ")) && said.contains(told), "{set}: {said}");
    }
    let twice = ask(folder.path(), "check study.toml --set design.band_count.to=9 --set design.band_count.to=10").refusal(2);
    assert_eq!(twice, "error: --set gives design.band_count.to twice; keep one of the two\n");
    for (whole, part) in [("operation.torque_Nm=[60]", "operation.torque_Nm.1=70"), ("friction=0.08", "uncertainty.friction.1=0.07")] {
        let said = ask_words(folder.path(), &["check", "study.toml", "--set", whole, "--set", part]).refusal(2);
        let told = format!("--set {whole} and --set {part}: one of them is a part of what another sets; keep one of the two");
        assert_eq!(said, format!("error: {told}\n"));
    }
    // A bound that leaves nothing is told where it was set.
    let said = ask(folder.path(), "check study.toml --set constraints.stress_margin.min=2").refusal(2);
    assert!(said.contains("without --set constraints.stress_margin.min=2 the study is right"), "{said}");
}

#[test]
fn a_result_says_what_was_set_and_another_setting_is_another_study() {
    let folder = folder_with("study.toml", SMALL);
    let at = folder.path();
    ask(at, "sweep study.toml --set friction=0.08 --out r").text();
    let data = data_of(&at.join("r/report.html"));
    let text = data["study"]["text"].as_str().expect("the page has the study");
    assert!(text.contains("\n# friction  = [0.065, 0.095]\n") && text.contains("\nfriction = 0.08\n"), "{text}");
    // The page's command evaluates a design of that study.
    assert_eq!(data["evaluate"], "beltspace eval r/study.toml --design {design}");
    let knee = json_of(&at.join("r/summary.json"))["knee"].clone();
    let one = ask(at, &format!("eval r/study.toml --design {} --json", knee["design_index"])).json();
    assert_eq!(one["outputs"]["axial_force_N"]["value"], knee["objectives"]["axial_force_N"]);
    // Its own study, swept again, gives the same result; so do its shards.
    ask(at, "sweep r/study.toml --out again").text();
    same_result(&files(&at.join("again")), &files(&at.join("r"))).expect("it is the same");
    ask(at, "sweep study.toml --set friction=0.08 --shard 1/2 --out a").text();
    ask(at, "sweep study.toml --set friction=0.08 --shard 2/2 --out b").text();
    ask(at, "merge a b --out m").text();
    same_result(&files(&at.join("m")), &files(&at.join("r"))).expect("it is the same");
    let other = ask(at, "sweep study.toml --set friction=0.09 --shard 2/2 --out a --resume").refusal(2);
    assert!(other.contains("the checkpoint is of another study (fixed: was ") && other.contains("start again with --force"), "{other}");
}

#[test]
fn what_if_evaluates_a_design_with_other_inputs() {
    let folder = folder_with("study.toml", SMALL);
    let at = folder.path();
    let plain = ask(at, "eval study.toml --design 500 --json").json();
    // A design axis, though a map is over it; the design keeps all else.
    let what_if = ask(at, "eval study.toml --design 500 --set band_count=14 --json").json();
    let mut expected = plain["inputs"].clone();
    expected["band_count"] = 14.into();
    assert_eq!((&what_if["inputs"], &what_if["design"], &what_if["set"]), (&expected, &500.into(), &serde_json::json!(["band_count=14"])));
    let axes = ["band_thickness_mm", "groove_angle_deg", "traction", "band_count"];
    let number = |name: &str| what_if["inputs"][name].as_f64().expect("a number");
    // It is the design of the grid that has these inputs: groove angle, thickness, count, traction, the last one fastest.
    let level = |name: &str, from: f64, step: f64| ((number(name) - from) / step).round() as u64;
    let [thickness, angle, traction, count] =
        [level(axes[0], 0.1, 0.01), level(axes[1], 18.0, 1.0), level(axes[2], 0.3, 0.05), level(axes[3], 6.0, 1.0)];
    let same = ((angle * 21 + thickness) * 9 + count) * 5 + traction;
    let there = ask(at, &format!("eval study.toml --design {same} --json")).json();
    assert_eq!((&what_if["outputs"], &what_if["constraints"]), (&there["outputs"], &there["constraints"]));
    assert_ne!(what_if["outputs"], plain["outputs"]);
    // An input of the scenarios: what is left are those of the others.
    let sure = ask(at, "eval study.toml --design 500 --set friction=0.065 --json").json();
    assert_eq!(sure["scenarios"], 6);
    let told = ask(at, "eval study.toml --design 500 --set friction=0.065").text();
    assert!(told.starts_with("design 500 with friction=0.065, worst of 6 scenarios\n"), "{told}");
    assert!(ask(at, "eval study.toml --design 500 --set friction=0").refusal(2).contains("--set friction=0: 0 is out of range"));
}

/// A traction and a clamping force contradict each other, whoever gives them.
#[test]
fn what_takes_the_place_of_an_input_cannot_be_given_beside_it() {
    let folder = folder_with("study.toml", SMALL);
    let at = folder.path();
    let line = SMALL.lines().position(|line| line.starts_with("traction")).expect("there is an axis") + 1;
    let told = "which takes its place; drop one of the two";
    let said = ask(at, "check study.toml --set clamping_force_N=30000").refusal(2);
    assert!(
        said.contains(&format!("study.toml:{line}:1: \"traction\" cannot be given beside clamping_force_N")) && said.contains(told),
        "{said}"
    );
    // The word says that the traction is given.
    ask(at, "check study.toml --set clamping_force_N=from-traction").text();
    let by_formula = format!("{SMALL}[formulas]\nclamping_force_N = \"200[1/m] * torque_Nm\"\n");
    write(at, "study.toml", &by_formula);
    let given = by_formula.lines().position(|line| line.starts_with("clamping_force_N")).expect("there is a formula") + 1;
    let said = ask(at, "check study.toml").refusal(2);
    let beside = format!("clamping_force_N, which the formula in line {given} gives and {told}");
    let expected = format!("error: study.toml:{line}:1: \"traction\" cannot be given beside {beside}\n");
    assert_eq!(said, expected);
    // The other way about, and in a row of cases.
    write(at, "study.toml", &changed(&by_formula, &[("traction          = { from = 0.30, to = 0.50, count = 5 }\n", "")]));
    let said = ask(at, "check study.toml --set traction=0.4").refusal(2);
    assert!(said.contains("\"traction\" cannot be given beside clamping_force_N") && said.contains(told), "{said}");
    let cases = "model = \"metal-cvt\"\n[design]\ncases = [{ traction = 0.3, clamping_force_N = \"from-traction\" }, \
                 { traction = 0.3, clamping_force_N = 2e4 }]\n[objectives]\naxial_force_N = \"min\"\n";
    write(at, "study.toml", cases);
    assert!(ask(at, "check study.toml").refusal(2).contains("\"traction\" cannot be given beside clamping_force_N, line 3"));
    // Of a model, and of rows.
    let said = ask(at, "eval metal-cvt --set traction=0.4 --set clamping_force_N=3e4").refusal(2);
    assert_eq!(said, format!("error: traction cannot be set beside clamping_force_N, {told}\n"));
    ask(at, "eval metal-cvt --set traction=0.4 --set clamping_force_N=from-traction").text();
    write(at, "rows.csv", "traction,clamping_force_N\n0.3,from-traction\n0.3,25000\n");
    let said = ask(at, "eval metal-cvt --table rows.csv --out out.csv").refusal(2);
    assert!(said.contains("traction cannot be given beside clamping_force_N, which takes its place; drop the column"), "{said}");
    write(at, "rows.csv", "traction,clamping_force_N\n0.3,from-traction\n0.4,from-traction\n");
    ask(at, "eval metal-cvt --table rows.csv --out out.csv").text();
    let shown = ask(at, "eval metal-cvt --set clamping_force_N=25000").text();
    assert!(shown.lines().any(|line| line.trim_start().starts_with("traction ") && line.contains("  -  ")), "{shown}");
}
