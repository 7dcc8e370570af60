use super::{ask, changed, files, folder_with, read, same_result, write};

const MEASURED: &str = include_str!("../formulas/measured.toml");
const CURVE: &str = include_str!("../formulas/slip.csv");
const COST: &str = include_str!("../formulas/cost.toml");

/// What a report may have, of quantities that formulas give.
const REPORT: &str = r#"
[report]
columns = ["friction", "band_speed_m_per_s"]
top = { by = "life", goal = "max", count = 5 }
histograms = [{ of = "life", bins = 10 }]
maps = [{ x = "band_thickness_mm", y = "driver_speed_rpm", value = "life", best = "max" }]
sample = { count = 20 }
"#;

#[test]
fn a_result_with_formulas_needs_no_other_file_and_is_the_same_in_shards() {
    let study = format!("{MEASURED}{REPORT}");
    let folder = folder_with("study.toml", &study);
    let at = folder.path();
    write(at, "slip.csv", CURVE);
    ask(at, "sweep study.toml --out one --engine cpu").text();
    for number in 1..=2 {
        ask(at, &format!("sweep study.toml --shard {number}/2 --out shard-{number} --tile 100")).text();
    }
    // From here on the study and its curve are known from what was written.
    std::fs::remove_file(at.join("slip.csv")).expect("it was there");
    ask(at, "merge shard-1 shard-2 --out two").text();
    let one = files(&at.join("one"));
    same_result(&one, &files(&at.join("two"))).unwrap_or_else(|problem| panic!("{problem}"));
    for name in ["histogram-life.csv", "map-life.csv", "top.csv", "sample.parquet", "front.svg"] {
        assert!(one.contains_key(name), "{name} is missing");
    }
    let header = read(&at.join("one/front.csv")).lines().next().expect("it has a header").to_owned();
    assert!(header.contains(",life,life_scenario,") && header.contains(",friction,friction_scenario,"), "{header}");
    ask(at, "report one").text();
    let page = read(&at.join("one/report.html"));
    assert!(page.contains("band_speed_m_per_s") && page.contains("m/s"));
}

#[test]
fn another_formula_is_another_study() {
    let folder = folder_with("study.toml", COST);
    let at = folder.path();
    let text = ask(at, "check study.toml").text();
    assert!(text.contains("formula  cost_EUR                 belt_price_EUR_per_kg * belt_mass_kg + 0.8[EUR] * band_count\n"), "{text}");
    ask(at, "sweep study.toml --out one --shard 1/2").text();
    write(at, "study.toml", &changed(COST, &[("0.8[EUR]", "0.9[EUR]")]));
    ask(at, "sweep study.toml --out two --shard 2/2").text();
    let refused = ask(at, "merge one two --out whole").refusal(2);
    assert!(refused.contains("0.8[EUR]") && refused.contains("0.9[EUR]") && !refused.contains("belt_mass_kg\",\"is"), "{refused}");
}

/// Edits of a right study, and what is said of each: line and column in the study, and the sentence.
const BROKEN: [(&str, &str, &str); 18] = [
    (
        "cost_EUR = \"belt",
        "axial_force_N_lowest = \"1\"\ncost_EUR = \"belt",
        r#"study.toml:21:1: "axial_force_N_lowest" is the name of a column that tables of results have beside "axial_force_N"; choose another name"#,
    ),
    (
        "cost_EUR = \"belt",
        "yield = \"1\"\ncost_EUR = \"belt",
        r#"study.toml:21:1: "yield" is the name of a column that tells the share of draws that hold; choose another name"#,
    ),
    (
        "cost_EUR = \"belt",
        "scenario = \"1\"\ncost_EUR = \"belt",
        r#"study.toml:21:1: "scenario" is the name of a column in tables of results; choose another name"#,
    ),
    (
        "cost_EUR = \"belt",
        "axial_force_N_scenario = \"1\"\ncost_EUR = \"belt",
        r#"study.toml:21:1: "axial_force_N_scenario" is the name of a column that tables of results have beside "axial_force_N"; choose another name"#,
    ),
    ("700[mm] * 7850", "700[mm] + 7850", r#"study.toml:20:17: formula "belt_mass_kg": a volume and a density cannot be added"#),
    (
        "axial_force_N / belt_mass_kg",
        "axial_force / belt_mass_kg",
        r#"study.toml:19:28: formula "force_per_mass_N_per_kg": unknown name "axial_force"; did you mean "axial_force_N"?"#,
    ),
    (
        "+ 0.8[EUR] * band_count",
        "+ 0.8[USD] * band_count",
        r#"study.toml:21:56: formula "cost_EUR": unknown unit "USD"; if it is one of your own, write units = ["USD"] at the top of the study"#,
    ),
    ("units = [\"EUR\"]", "units = [\"mm\"]", r#"study.toml:3:10: units: "mm" is known already; choose another name"#),
    ("units = [\"EUR\"]", "units = \"EUR\"", r#"study.toml:3:9: units: found the text "EUR", wanted a list of texts such as ["EUR"]"#),
    (
        "belt_price_EUR_per_kg = [12, 14]",
        "belt_prise_EUR_per_kg = [12, 14]",
        r#"study.toml:9:1: nothing reads "belt_prise_EUR_per_kg"; did you mean "belt_price_EUR_per_kg"?
study.toml:21:13: formula "cost_EUR": unknown name "belt_price_EUR_per_kg"; it is no input, output, variable, formula or curve"#,
    ),
    (
        "belt_price_EUR_per_kg = [12, 14]",
        "belt_price_EUR_per_kg = [12, 14]\ncost_EUR = [1, 2]",
        r#"study.toml:10:1: the name "cost_EUR" is given by a formula; drop one of the two"#,
    ),
    (
        "cost_EUR = \"belt",
        "cost_kg = \"belt",
        r#"study.toml:21:12: formula "cost_kg": the formula gives a quantity in EUR, but cost_kg is a mass"#,
    ),
    (
        "\"axial_force_N / belt_mass_kg\"",
        "7",
        r#"study.toml:19:27: formula "force_per_mass_N_per_kg": found the number 7, wanted a text in quotes"#,
    ),
    (
        "friction = [0.08, 0.1]",
        "friction = [0.08, 0.1]\nelastic_modulus_MPa = [1, 2]\nwear = [1, 2]",
        r#"study.toml:18:1: axis "wear": metal-cvt has no input "wear"; its inputs are friction, groove_angle_deg, ratio, belt_length_mm, centre_distance_mm, band_width_mm, band_thickness_mm, band_count, elastic_modulus_MPa, strength_MPa, traction, torque_Nm, clamping_force_N, driver_speed_rpm, belt_mass_kg_per_m, belt_price_EUR_per_kg"#,
    ),
    (
        "[constraints]",
        "traction = \"slip_margin\"\n[constraints]",
        r#"study.toml:23:13: formula "traction": traction is an input of the model, so it cannot depend on slip_margin, which is an output: the model is evaluated once"#,
    ),
    (
        "[constraints]",
        "a = \"b + 1\"\nb = \"a + 1\"\n[constraints]",
        r#"study.toml:23:6: formula "a": these formulas read each other in a circle: a -> b -> a"#,
    ),
    (
        "[constraints]",
        "band_count = \"band_thickness_mm / 0.05[mm]\"\n[constraints]",
        r#"study.toml:7:1: the input "band_count" is given by a formula; drop one of the two
study.toml:23:15: formula "band_count": band_count takes whole numbers; end the formula in round(...), floor(...) or ceil(...)"#,
    ),
    (
        "[formulas]",
        "[curves]\nwear = { csv = \"none.csv\", x = \"speed_m_per_s\", y = \"wear\" }\n[formulas]",
        r#"study.toml:19:8: curve "wear": cannot read "none.csv": No such file or directory (os error 2); paths are relative to the folder of the study"#,
    ),
];

#[test]
fn what_is_wrong_with_formulas_is_told_with_its_place() {
    let mut wrong = String::new();
    for (from, to, message) in BROKEN {
        let folder = folder_with("study.toml", &changed(COST, &[(from, to)]));
        let said = ask(folder.path(), "check study.toml").refusal(2);
        let said = said.trim_end().trim_start_matches("error: ");
        if said != message {
            wrong += &format!("{to}\n  is    {said}\n  wanted {message}\n");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

const BRAKE: &str = include_str!("../formulas/models/band-brake.toml");
const GRIP: &str = include_str!("../formulas/models/grip.csv");
const BRAKES: &str = include_str!("../formulas/models/brakes.toml");

#[test]
fn a_result_of_a_model_in_a_file_needs_neither_model_nor_curve() {
    let folder = folder_with("study.toml", BRAKES);
    let at = folder.path();
    write(at, "band-brake.toml", BRAKE);
    write(at, "grip.csv", GRIP);
    ask(at, "sweep study.toml --out one --engine cpu").text();
    for number in 1..=2 {
        ask(at, &format!("sweep study.toml --shard {number}/2 --out shard-{number} --tile 100")).text();
    }
    for name in ["band-brake.toml", "grip.csv"] {
        std::fs::remove_file(at.join(name)).expect("it was there");
    }
    ask(at, "merge shard-1 shard-2 --out two").text();
    same_result(&files(&at.join("one")), &files(&at.join("two"))).unwrap_or_else(|problem| panic!("{problem}"));
    ask(at, "report one").text();
    let refused = ask(at, "check study.toml").refusal(2);
    assert!(refused.starts_with("error: study.toml:1:9: model: ") && refused.contains("band-brake.toml"), "{refused}");
}

#[test]
fn commands_take_the_file_of_a_model_and_tell_it_from_a_study() {
    let folder = folder_with("brake.toml", BRAKE);
    let at = folder.path();
    write(at, "grip.csv", GRIP);
    write(at, "neither.toml", "title = \"Something\"\n");
    write(at, "study.toml", &changed(BRAKES, &[("band-brake.toml", "brake.toml")]));
    let page = ask(at, "models brake.toml").text();
    assert!(page.contains("grip_used") && page.contains("if(friction == 'measured', grip(rubbing_speed_m_per_s), friction)"), "{page}");
    let described: serde_json::Value = serde_json::from_str(&ask(at, "models brake.toml --json").text()).expect("it is JSON");
    assert_eq!((&described["name"], described["formulas"].as_array().map(Vec::len)), (&"brake".into(), Some(8)));
    let one = ask(at, "eval brake.toml --preset heavy --set friction=0.2 --json").text();
    let one: serde_json::Value = serde_json::from_str(&one).expect("it is JSON");
    assert_eq!((&one["model"], &one["inputs"]["rows"], &one["status"]), (&"brake".into(), &3.into(), &"ok".into()));
    let verified = ask(at, "verify brake.toml --samples 2000").text();
    assert!(verified.contains("all error bounds hold"), "{verified}");
    assert!(ask(at, "eval study.toml --design 780").text().contains("total_EUR"));
    assert!(ask(at, "models study.toml").refusal(2).contains("study.toml is a study"));
    for command in ["eval", "verify", "models"] {
        let refused = ask(at, &format!("{command} neither.toml")).refusal(2);
        assert!(
            refused.starts_with("error: neither.toml is neither a study, which names a model, nor a model, which has [formulas]"),
            "{refused}"
        );
    }
}
