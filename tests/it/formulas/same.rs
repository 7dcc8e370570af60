//! Models of the program written again as files: a study of either has the same results, on every engine and by every method.

use super::parsed;
use beltspace::{Engine, Judging, Options, Outcome, Study};
use std::path::Path;
use std::time::Instant;

/// Studies of models that are also files: all axes, some of them words or joint, a report with all it may have.
pub(super) const STUDIES: [(&str, &str); 5] = [
    (
        "metal-cvt",
        r#"
title = "Metal"
[design]
groove_angle_deg  = { from = 18, to = 30, count = 4 }
band_thickness_mm = { from = 0.10, to = 0.30, step = 0.02 }
band_count        = { from = 6, to = 14, step = 2 }
traction          = ["limit", 0, 0.3, 0.5]
belt_length_mm    = [300, 500, 613, 640]
[operation]
ratio     = { from = 0.5, to = 2.0, count = 5, spacing = "log" }
torque_Nm = [0, 50, 150]
[uncertainty]
friction = { from = 0.065, to = 0.095, count = 3 }
[fixed]
strength_MPa = 800
[constraints]
slip_margin   = { min = 0 }
stress_margin = { min = 0 }
[objectives]
axial_force_N = "min"
stress_margin = "max"
band_count    = "min"
"#,
    ),
    (
        "metal-cvt",
        r#"
title = "Metal, clamped"
[design]
groove_angle_deg  = { from = 18, to = 30, count = 4 }
band_thickness_mm = { from = 0.10, to = 0.30, step = 0.04 }
clamping_force_N  = ["from-traction", 1e4, 2e4, 30000.1, 4e4]
[operation]
cases = [
    { ratio = 0.5, torque_Nm = 0, driver_speed_rpm = 700 }, { ratio = 1, torque_Nm = 150, driver_speed_rpm = 2500 },
    { ratio = 1.5, torque_Nm = 70, driver_speed_rpm = 6000 },
]
[uncertainty]
friction = { from = 0.065, to = 0.095, count = 3 }
[fixed]
strength_MPa       = 800
belt_mass_kg_per_m = 1.1
[constraints]
clamping_utilisation = { max = 0.9 }
[objectives]
axial_force_upper_N = "min"
stress_margin       = "max"
"#,
    ),
    (
        "rubber-cvt",
        r#"
title = "Rubber, clamped"
[design]
groove_angle_deg    = { from = 24, to = 34, count = 5 }
belt_width_mm       = { from = 20, to = 50, count = 7 }
bending_modulus_MPa = ["elastic-modulus", 60]
clamping_force_N    = { from = 400, to = 4000, count = 12 }
[operation]
cases = [{ ratio = 0.6, torque_Nm = 8 }, { ratio = 1, torque_Nm = 12 }, { ratio = 2.2, torque_Nm = 10 }]
[uncertainty]
friction = { from = 0.3, to = 0.45, count = 3 }
[fixed]
driver_speed_rpm   = 5000
belt_mass_kg_per_m = 0.4
[constraints]
clamping_utilisation = { max = 0.77 }
stress_margin        = { min = 0 }
[objectives]
axial_force_upper_N = "min"
slip_margin         = "max"
belt_width_mm       = "min"
"#,
    ),
    (
        "rubber-cvt",
        r#"
title = "Rubber"
[design]
groove_angle_deg  = { from = 24, to = 34, count = 5 }
belt_width_mm     = { from = 20, to = 50, count = 7 }
belt_thickness_mm = { from = 1, to = 3, count = 5 }
traction          = [0.4, 0.6, 0.8, "limit"]
[operation]
cases = [{ ratio = 0.6, torque_Nm = 8 }, { ratio = 1, torque_Nm = 12 }, { ratio = 2.2, torque_Nm = 10 }]
[uncertainty]
friction            = { from = 0.3, to = 0.45, count = 3 }
elastic_modulus_MPa = [500, 700]
[constraints]
slip_margin   = { min = 0 }
stress_margin = { min = 0 }
[objectives]
axial_force_N = "min"
stress_margin = "max"
belt_width_mm = "min"
"#,
    ),
    (
        "pulley-load",
        r#"
title = "Pulley"
[design]
tensioning       = ["slack", "fixed-centres"]
mean_radius_mm   = { from = 40, to = 80, step = 4 }
slack_tension_N  = { from = 100, to = 900, step = 50 }
groove_angle_deg = { from = 34, to = 38, count = 3 }
groove_count     = { from = 1, to = 3 }
[operation]
cases = [{ power_kW = 3.0, speed_rpm = 3000 }, { power_kW = 0, speed_rpm = 900 }, { power_kW = 4.0, speed_rpm = 6500 }]
wrap_angle_deg = [88, 110]
[uncertainty]
friction_direction_deg = [0, 22.5, 45]
belt_mass_kg_per_m     = [0.10, 0.12]
[constraints]
friction_margin = { min = 0 }
[objectives]
resultant_force_N              = "min"
mean_radius_mm                 = "min"
tight_end_flank_force_N_per_mm = "min"
"#,
    ),
];

/// A study of the model itself, and of the same in a file; with all its outputs in the tables and histograms, or with the front alone.
fn both(model: &str, text: &str, whole: bool) -> [Study; 2] {
    let known = beltspace::models::find(model).expect("it is a model");
    let names: Vec<String> = known.outputs.iter().map(|output| format!("\"{}\"", output.name)).collect();
    let first = &known.outputs[0].name;
    // Without a torque there is neither safety nor entry compression, and what a histogram needs must be there.
    let there = known.outputs.iter().filter(|output| !["clamping_safety", "entry_compression"].contains(&output.name.as_str()));
    let bins: Vec<String> = there.map(|output| format!("{{ of = \"{}\", bins = 9 }}", output.name)).collect();
    let columns = names.join(", ");
    let report = match whole {
        true => format!("[report]\ncolumns = [{columns}]\nhistograms = [{}]\ntop = {{ by = \"{first}\", count = 9 }}\n", bins.join(", ")),
        false => format!("[report]\ncolumns = [{columns}]\n"),
    };
    [model.to_owned(), format!("{model}-in-a-file.toml")].map(|name| parsed(&format!("model = \"{name}\"\n{text}{report}")))
}

/// Everything of an outcome that files hold, but for the names of statuses that never come up.
fn results(outcome: &Outcome) -> Vec<(String, String)> {
    let tables = outcome.histograms.iter().map(|(name, table)| (name.clone(), String::from_utf8_lossy(&table.csv()).into_owned()));
    let own = [("front", Some(&outcome.front)), ("top", outcome.top.as_ref())];
    let own = own.into_iter().filter_map(|(name, table)| Some((name.to_owned(), String::from_utf8_lossy(&table?.csv()).into_owned())));
    own.chain(tables).chain([("counts".to_owned(), format!("{:?}", outcome.counts))]).collect()
}

#[test]
fn a_model_written_again_as_a_file_gives_the_same_bytes() {
    let adapter = beltspace::gpu::adapters().into_iter().next().expect("the tests have an adapter").name;
    let cpu = || Options::default().engine(Engine::Cpu);
    for (model, text) in STUDIES {
        let [known, in_file] = both(model, text, true);
        let expected = known.sweep(cpu().judging(Judging::Exhaustive)).expect("it is swept");
        let counts = expected.counts;
        assert!(counts.feasible > 20 && counts.feasible < counts.designs && counts.front > 3, "{model}: {counts:?}");
        let expected = results(&expected);
        let gpu = Options::default().engine(Engine::Gpu).adapter(adapter.clone());
        for options in [cpu(), cpu().threads(1), gpu] {
            let found = results(&in_file.sweep(options.judging(Judging::Exhaustive)).expect("it is swept"));
            for (one, other) in expected.iter().zip(&found) {
                assert_eq!(one, other, "{model}");
            }
            assert_eq!(expected.len(), found.len(), "{model}");
        }
        let [known, in_file] = both(model, text, false);
        let by = |study: &Study, judging: Judging| results(&study.sweep(cpu().judging(judging)).expect("it is swept"));
        assert_eq!(by(&known, Judging::Exhaustive), by(&in_file, Judging::Bounds), "{model}");
    }
}

/// One operation in another order is seen.
#[test]
fn another_order_of_operations_gives_other_bytes() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/formulas/models");
    let text = std::fs::read_to_string(folder.join("pulley-load-in-a-file.toml")).expect("it is there");
    let other = text.replace("\"power_kW / belt_speed_m_per_s\"", "\"power_kW * (1 / belt_speed_m_per_s)\"");
    assert_ne!(text, other);
    let own = tempfile::tempdir().expect("there is room");
    std::fs::write(own.path().join("other.toml"), other).expect("it is written");
    let (_, study) = STUDIES[4];
    let [known, _] = both("pulley-load", study, true);
    let other = Study::parse_in(
        &format!("model = \"other.toml\"\n{study}[report]\ncolumns = [\"effective_tension_N\"]\n"),
        "study.toml",
        own.path(),
    );
    let options = || Options::default().engine(Engine::Cpu).judging(Judging::Exhaustive);
    let [known, other] = [known, other.expect("it is right")].map(|it| it.sweep(options()).expect("it is swept"));
    assert_ne!(known.front.csv(), other.front.csv());
}

/// Not a test of time, which depends on the machine: it prints the factor, and fails only where something is computed again and again.
#[test]
fn a_model_in_a_file_takes_about_as_long() {
    for (model, text) in STUDIES {
        // Levels enough that the time is that of the designs.
        let text =
            text.replace("step = 0.02 }", "step = 0.001 }").replace("count = 7 }", "count = 201 }").replace("step = 50 }", "step = 4 }");
        let [known, in_file] = both(model, &text, false).map(|study| {
            let options = || Options::default().engine(Engine::Cpu).judging(Judging::Exhaustive).threads(1);
            let time = |_| {
                let start = Instant::now();
                study.sweep(options()).expect("it is swept");
                start.elapsed().as_secs_f64()
            };
            (0..3).map(time).fold(f64::INFINITY, f64::min)
        });
        println!("{model}: {known:.3} s, in a file {in_file:.3} s, factor {:.2}", in_file / known);
        assert!(in_file < 20.0 * known, "{model}: {known} s, in a file {in_file} s");
    }
}

/// Formulas around a model of the program, in a file or in the study itself: one front, and a study's own formulas may stand around both.
#[test]
fn a_file_based_on_a_model_is_the_model_with_these_formulas() {
    let formulas = r#"
[formulas]
belt_mass_kg = "2 * band_count * band_width_mm * band_thickness_mm * belt_length_mm * 7850[kg/m^3]"
cost_EUR     = { is = "price_EUR_per_kg * belt_mass_kg + 0.8[EUR] * band_count", doc = "What the bands cost." }
"#;
    let study = r#"
[design]
band_thickness_mm = { from = 0.10, to = 0.30, count = 9 }
band_count        = { from = 6, to = 12 }
price_EUR_per_kg  = [12, 14]
[operation]
torque_Nm = [50, 150]
[constraints]
stress_margin = { min = 0 }
[objectives]
cost_EUR      = "min"
stress_margin = "max"
"#;
    let folder = tempfile::tempdir().expect("a folder can be made");
    let model =
        format!("base = \"metal-cvt\"\nunits = [\"EUR\"]\n[inputs]\nprice_EUR_per_kg = {{ default = 12, valid = [0, 100] }}\n{formulas}");
    std::fs::write(folder.path().join("priced.toml"), model).expect("a file can be written");
    let parse = |text: String| Study::parse_in(&text, "study.toml", folder.path()).unwrap_or_else(|error| panic!("{error}"));
    let own = parse(format!("model = \"metal-cvt\"\nunits = [\"EUR\"]\n{formulas}{study}"));
    let based = parse(format!("model = \"priced.toml\"\n{study}"));
    let around = study.replace("cost_EUR      = \"min\"", "twice_EUR = \"min\"");
    let around = parse(format!("model = \"priced.toml\"\n[formulas]\ntwice_EUR = \"2 * cost_EUR\"\n{around}"));
    let swept = |study: &Study, judging| study.sweep(Options::default().engine(Engine::Cpu).judging(judging)).expect("it is swept");
    let expected = swept(&own, Judging::Exhaustive);
    assert!(expected.counts.feasible > 20 && expected.counts.front > 1, "{:?}", expected.counts);
    for judging in [Judging::Exhaustive, Judging::Bounds] {
        let found = swept(&based, judging);
        assert_eq!((found.counts, found.front.csv()), (expected.counts, expected.front.csv()));
        let around = swept(&around, judging);
        let rows = |outcome: &Outcome| (0..outcome.front.rows()).filter_map(|row| outcome.front.design(row)).collect::<Vec<_>>();
        assert_eq!((around.counts, rows(&around)), (expected.counts, rows(&expected)));
        let doubled = around.front.number("twice_EUR", 0).zip(expected.front.number("cost_EUR", 0));
        assert!(doubled.is_some_and(|(twice, cost)| twice == 2.0 * cost), "{doubled:?}");
    }
}
