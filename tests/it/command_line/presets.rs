//! Presets of a model as an axis of a study.

use super::catalogues::says;
use super::{Csv, ask, changed, folder_with, json_of, read, write};

/// A study over presets, and the same by hand.
const PRESETS: &str = r#"model = "timing-belt"
title = "Either pulley"
[design]
preset = ["ohc-driven", "ohc-driver"]
tight_tension_N = { from = 150, to = 600, count = 46 }
[objectives]
tight_tension_N = "min"
peak_tooth_load_N = "min"
[report]
variants = true
"#;

#[test]
fn an_axis_over_presets_is_the_same_study_by_hand() {
    let by_hand = changed(
        PRESETS,
        &[
            ("[design]", "labels = [\"preset\"]\n[design]"),
            (
                "preset = [\"ohc-driven\", \"ohc-driver\"]",
                "cases = [\n\
                 { preset = \"ohc-driven\", pulley_speed_rpm = 5000, teeth_in_mesh = 23, tip_radius_mm = 66.32, land_half_angle_deg = 1.473, \
                 space_half_angle_deg = 2.618 },\n\
                 { preset = \"ohc-driver\", pulley_speed_rpm = 10000, teeth_in_mesh = 11, tip_radius_mm = 32.97, \
                 land_half_angle_deg = 2.945, space_half_angle_deg = 5.236 },\n]",
            ),
        ],
    );
    let folder = folder_with("presets.toml", PRESETS);
    let at = folder.path();
    write(at, "by-hand.toml", &by_hand);
    for study in ["presets", "by-hand"] {
        ask(at, &format!("sweep {study}.toml --out {study}")).text();
    }
    let front = read(&at.join("presets/front.csv"));
    assert!(front.starts_with("design_index,preset,pulley_speed_rpm,"), "{front}");
    assert!(front.contains(",ohc-driver,10000,") || front.contains(",ohc-driven,5000,"), "{front}");
    for name in ["front.csv", "variants.csv", "front.parquet"] {
        let [one, other] = ["presets", "by-hand"].map(|it| std::fs::read(at.join(it).join(name)).expect("it is there"));
        assert!(one == other, "{name}");
    }
    let single = |preset: &str| {
        let text = PRESETS.replace("preset = [\"ohc-driven\", \"ohc-driver\"]\n", "");
        write(at, "one.toml", &text.replace("[design]", &format!("preset = \"{preset}\"\n[design]")));
        ask(at, "sweep one.toml --out one --force").text();
        Csv::read(&at.join("one/variants.csv")).column("peak_tooth_load_N").iter().map(|it| (*it).to_owned()).collect::<Vec<_>>()
    };
    let both = Csv::read(&at.join("presets/variants.csv"));
    assert_eq!(both.column("peak_tooth_load_N"), [single("ohc-driven"), single("ohc-driver")].concat());

    // What is set elsewhere goes over the presets: by an axis, a fixed value, or cases.
    write(at, "over.toml", &changed(PRESETS, &[("[objectives]", "[fixed]\nteeth_in_mesh = 9\n[objectives]")]));
    ask(at, "sweep over.toml --out over").text();
    let over = read(&at.join("over/front.csv"));
    assert!(over.starts_with("design_index,preset,pulley_speed_rpm,tip_radius_mm,"), "{over}");
    assert_eq!(json_of(&at.join("over/study.json"))["fixed"]["teeth_in_mesh"], 9);
    // In scenarios, without a label.
    let scenario = changed(
        PRESETS,
        &[
            ("preset = [\"ohc-driven\", \"ohc-driver\"]\n", ""),
            ("[objectives]", "[operation]\npreset = [\"ohc-driven\", \"ohc-driver\"]\n[objectives]"),
        ],
    );
    write(at, "scenarios.toml", &scenario);
    ask(at, "sweep scenarios.toml --out scenarios").text();
    assert_eq!(Csv::read(&at.join("scenarios/scenarios.csv")).column("teeth_in_mesh"), ["23", "11"]);
    // The pulley's presets have words among their values.
    let pulley = "model = \"pulley\"\n[design]\npreset = [\"machined\", \"pressed-cup\"]\n[objectives]\nmass_g = \"min\"\n";
    write(at, "pulley.toml", pulley);
    let text = ask(at, "check pulley.toml").text();
    assert!(text.contains("machined or pressed-cup"), "{text}");
}

#[test]
fn broken_preset_axes_are_refused() {
    let all = "pulley_speed_rpm = 5000\nteeth_in_mesh = 9\ntip_radius_mm = 60\nland_half_angle_deg = 1.5\nspace_half_angle_deg = 2.6";
    let listed = "[\"ohc-driven\", \"ohc-driver\"]";
    let cases = [
        (listed, "[\"ohc\"]", "", "4:11: axis \"preset\": timing-belt has no preset \"ohc\"; presets are: [..]"),
        (listed, "[\"ohc-driven\", \"ohc-driven\"]", "", "4:25: axis \"preset\": \"ohc-driven\" is listed twice; drop one"),
        (listed, "[]", "", "4:10: axis \"preset\": the list is empty; name presets such as [..]"),
        (listed, "[3]", "", "4:11: axis \"preset\": found the number 3, wanted a text in quotes"),
        (
            listed,
            "\"ohc-driven\"",
            "",
            "4:10: axis \"preset\": found the text \"ohc-driven\", wanted a list such as [..]; one preset for all belongs above the first table",
        ),
        (listed, listed, all, "4:1: axis \"preset\": everything that these presets set is set elsewhere in the study; drop the axis"),
        (
            "[design]",
            "labels = [\"preset\"]\n[design]",
            "",
            "3:11: label \"preset\": the axis over presets has this label already; drop it from labels",
        ),
    ];
    for (from, to, fixed, expected) in cases {
        let fixed = format!("[fixed]\n{fixed}\n[objectives]");
        let folder = folder_with("study.toml", &changed(PRESETS, &[(from, to), ("[objectives]", &fixed)]));
        let refused = ask(folder.path(), "check study.toml").refusal(2);
        assert!(says(&refused, &format!("study.toml:{expected}")), "{to}: wanted\n{expected}\nand it says\n{refused}");
    }
    // Two presets that differ in one input only, which is fixed.
    let model = beltspace::models::find("pulley").expect("it is a model");
    assert!(model.presets.len() >= 2);
    let names: Vec<_> = model.presets.iter().map(|it| it.name.as_str()).collect();
    let set: std::collections::BTreeSet<_> = model.presets[..2].iter().flat_map(|it| &it.changes).map(|(name, _)| name.as_str()).collect();
    let same: Vec<_> = {
        let [one, other] = [0, 1].map(|at| model.preset(names[at]).expect("it is a preset"));
        let equal = |name: &&&str| model.input(name).is_some_and(|at| one[at] == other[at]);
        set.iter().filter(equal).copied().collect()
    };
    assert!(!same.is_empty(), "the first two presets of the pulley share something");
    let words = |name: &str| name == "section";
    let fixed: String = set
        .iter()
        .filter(|name| !same.contains(*name))
        .map(|name| {
            if words(name) {
                format!("{name} = \"machined\"\n")
            } else {
                format!("{name} = {}\n", model.defaults()[model.input(name).expect("an input")])
            }
        })
        .collect();
    let study = format!(
        "model = \"pulley\"\n[design]\npreset = [\"{}\", \"{}\"]\n[fixed]\n{fixed}[objectives]\nmass_g = \"min\"\n",
        names[0], names[1]
    );
    let folder = folder_with("study.toml", &study);
    let refused = ask(folder.path(), "check study.toml").refusal(2);
    let expected = format!(
        "study.toml:3:1: axis \"preset\": \"{}\" and \"{}\" are the same here, as everything in which they differ is set elsewhere in the study; drop one",
        names[0], names[1]
    );
    assert!(says(&refused, &expected), "{refused}");
}
