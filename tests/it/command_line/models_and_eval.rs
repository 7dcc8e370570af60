//! `models` and `eval`: the list of models, and single designs.

use super::{Csv, SMALL, ask, ask_words, folder_with, json_of, read, write};
use beltspace::models::{self, Input, Model};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use tempfile::tempdir;

/// Name, inputs with their defaults, outputs: what the interface promises of these models.
const MODELS: [(&str, &str, &str); 5] = [
    (
        "rubber-cvt",
        r#"{"friction":0.4,"groove_angle_deg":30,"ratio":1,"belt_length_mm":1066,"centre_distance_mm":260,"belt_width_mm":50,
            "belt_thickness_mm":10,"elastic_modulus_MPa":600,"strength_MPa":18,"traction":0.8,"torque_Nm":50,
            "clamping_force_N":"from-traction","driver_speed_rpm":0,"belt_mass_kg_per_m":0,"bending_modulus_MPa":600}"#,
        VARIATOR_OUTPUTS,
    ),
    (
        "metal-cvt",
        r#"{"friction":0.08,"groove_angle_deg":22,"ratio":1,"belt_length_mm":613,"centre_distance_mm":156,"band_width_mm":9,
            "band_thickness_mm":0.2,"band_count":10,"elastic_modulus_MPa":210000,"strength_MPa":500,"traction":"limit","torque_Nm":100,
            "clamping_force_N":"from-traction","driver_speed_rpm":0,"belt_mass_kg_per_m":0}"#,
        METAL_OUTPUTS,
    ),
    (
        "timing-belt",
        r#"{"pulley_speed_rpm":5000,"tight_tension_N":196,"slack_tension_N":0,"teeth_in_mesh":23,"friction":0.45,
            "tooth_compliance_um_per_N":2.55,"cord_modulus_GPa":78.4,"cord_area_mm2":21.5,"tip_radius_mm":66.32,
            "land_half_angle_deg":1.473,"space_half_angle_deg":2.618,"tooth_length_mm":6.10,"pressure_angle_deg":20,
            "tight_span_angle_deg":6,"slack_span_angle_deg":6,"pitch_mass_g":0.411,"lift_angle_deg":2.618,"pitch_mm":9.525,
            "centrifugal_land_friction":0,"pitch_line_mm":0.686,"belt_width_mm":12.7,"tooth_area_mm2":7.54,"land_area_mm2":8.23,
            "gross_cord_area_mm2":10.52,"rubber_density_kg_per_m3":1300,"cord_density_kg_per_m3":1500}"#,
        "centrifugal_force_N boundary_tooth boundary_position incomplete_teeth lift_speed_rpm boundary_tension_N peak_tooth_load_N \
         peak_tooth_load_complete_N least_tooth_load_N effective_tension_N torque_Nm pitch_mass_used_g",
    ),
    (
        "pulley-load",
        r#"{"power_kW":3,"speed_rpm":3000,"tensioning":"slack","slack_tension_N":700,"installed_tension_N":800,
            "wrap_angle_deg":88,"mean_radius_mm":60,"groove_angle_deg":36,"groove_count":1,"belt_mass_kg_per_m":0.11,"friction_limit":0.3,"friction_direction_deg":0}"#,
        "belt_speed_m_per_s slack_tension_used_N tight_tension_N effective_tension_N centrifugal_tension_N effective_friction \
         friction_used friction_margin torque_Nm resultant_force_N slack_end_line_force_N_per_mm tight_end_line_force_N_per_mm slack_end_flank_force_N_per_mm \
         tight_end_flank_force_N_per_mm",
    ),
    (
        "pulley",
        r#"{"power_kW":3,"speed_rpm":3000,"tensioning":"slack","slack_tension_N":700,"installed_tension_N":800,
            "wrap_angle_deg":88,"mean_radius_mm":60,"groove_angle_deg":36,"groove_count":1,"belt_mass_kg_per_m":0.11,"friction_limit":0.3,"friction_direction_deg":0,"section":"pressed-cup",
            "accuracy":"usual","thickness_mm":1.8,"bore_diameter_mm":20,"cup_diameter_mm":66,"wall_diameter_mm":78,
            "wall_offset_mm":10,"hub_bend_radius_mm":5,"web_bend_radius_mm":3,"fold_radius_mm":3.4,"ridge_width_mm":6,
            "weld_diameter_mm":66,"wall_thickness_mm":6,"rim_thickness_mm":5,"lip_thickness_mm":4,"fillet_radius_mm":1.5,
            "groove_offset_mm":16,"groove_width_mm":13,"groove_height_mm":5,"floor_depth_mm":7,"floor_bend_radius_mm":1.5,
            "rim_height_mm":1.5,"contact_height_mm":9,"bracket_diameter_mm":55,"bolt_count":4,"bolt_circle_mm":45,
            "bolt_hole_mm":6.6,"bolt_head_mm":12,"bolt_angle_deg":44,"clamp_force_N":8333.333,"tightening_torque_Nm":10,
            "bolt_friction":0.15,"bolt_pitch_mm":1,"bolt_pitch_diameter_mm":5.35,
            "bolt_proof_strength_MPa":580,"joint_friction":0.15,"elastic_modulus_MPa":206000,
            "poisson_ratio":0.29,"density_kg_per_m3":7850,"yield_strength_MPa":270,"tensile_strength_MPa":370,
            "endurance_limit_MPa":"from-tensile","point_1_r_mm":"none","point_1_z_mm":0,"point_2_r_mm":"none","point_2_z_mm":0}"#,
        "belt_speed_m_per_s slack_tension_used_N tight_tension_N effective_tension_N centrifugal_tension_N effective_friction \
         friction_used friction_margin torque_Nm resultant_force_N slack_end_line_force_N_per_mm tight_end_line_force_N_per_mm \
         slack_end_flank_force_N_per_mm tight_end_flank_force_N_per_mm max_stress_MPa max_stress_r_mm max_stress_z_mm \
         max_stress_theta_deg stress_Bl_MPa stress_Br_MPa stress_Cl_MPa stress_Cr_MPa stress_Dl_MPa stress_Dr_MPa stress_El_MPa \
         stress_Er_MPa stress_Fl_MPa stress_Fr_MPa stress_P1_MPa stress_P2_MPa rim_displacement_mm volume_mm3 mass_g \
         yield_safety fatigue_safety fatigue_amplitude_MPa fatigue_mean_MPa excluded_radius_mm \
         seat_pressure_MPa bolt_utilisation joint_slip_safety",
    ),
];
const VARIATOR_OUTPUTS: &str = "driver_radius_mm driven_radius_mm driver_wrap_deg driven_wrap_deg effective_friction traction_limit driven_traction_limit \
    driver_traction_limit traction_used slip_margin active_arc_deg driver_axial_coefficient driven_axial_coefficient belt_force_N \
    tight_force_N slack_force_N driver_axial_force_N driven_axial_force_N axial_force_N driver_axial_force_upper_N \
    driven_axial_force_upper_N axial_force_upper_N clamping_safety clamping_utilisation thrust_ratio belt_speed_m_per_s \
    centrifugal_force_N power_kW tensile_stress_MPa bending_stress_MPa max_stress_MPa stress_margin optimum_thickness_mm \
    torque_coefficient_N_per_mm torque_capacity_Nm capacity_axial_force_N flank_pressure_MPa";
const METAL_OUTPUTS: &str = "driver_radius_mm driven_radius_mm driver_wrap_deg driven_wrap_deg effective_friction traction_limit driven_traction_limit \
    driver_traction_limit traction_used slip_margin active_arc_deg driver_axial_coefficient driven_axial_coefficient belt_force_N \
    tight_force_N slack_force_N driver_axial_force_N driven_axial_force_N axial_force_N driver_axial_force_upper_N \
    driven_axial_force_upper_N axial_force_upper_N clamping_safety clamping_utilisation thrust_ratio belt_speed_m_per_s \
    centrifugal_force_N power_kW tensile_stress_MPa bending_stress_MPa max_stress_MPa stress_margin optimum_thickness_mm \
    torque_coefficient_N_per_mm torque_capacity_Nm capacity_axial_force_N printed_torque_coefficient_N_per_mm entry_compression";

/// Outputs that the defaults do not ask for.
const NOT_ASKED: [&str; 2] = ["stress_P1_MPa", "stress_P2_MPa"];

/// Name, inputs with their defaults, outputs of every model: what is promised, or else what the library says.
fn all_models() -> Vec<(&'static str, Value, Vec<&'static str>)> {
    let of = |model: &'static Arc<Model>| match MODELS.into_iter().find(|(name, ..)| *name == model.name) {
        Some((name, inputs, outputs)) => {
            (name, serde_json::from_str(inputs).expect("the table is JSON"), outputs.split_whitespace().collect())
        }
        None => {
            let default = |it: &Input| it.word_for(it.default).map_or_else(|| shortest(it.default), |word| json!(word));
            let inputs = model.inputs.iter().map(|it| (it.name.clone(), default(it))).collect::<serde_json::Map<_, _>>();
            (model.name.as_str(), Value::Object(inputs), model.outputs.iter().map(|it| it.name.as_str()).collect())
        }
    };
    assert!(MODELS.iter().all(|(name, ..)| models::find(name).is_some()), "a model is gone");
    models::all().iter().map(of).collect()
}

/// A number as JSON has it: a whole one without a point.
fn shortest(value: f64) -> Value {
    serde_json::from_str(&value.to_string()).expect("it is a number")
}

fn here() -> &'static Path {
    Path::new(".")
}

fn keys(object: &Value) -> Vec<&str> {
    object.as_object().expect("an object").keys().map(String::as_str).collect()
}

#[test]
fn models_are_listed_and_described_in_full() {
    let list = ask(here(), "models").text();
    let all = ask(here(), "models --json").json();
    assert_eq!(all.as_array().map(Vec::len), Some(models::all().len()));
    for (at, (model, inputs, outputs)) in all_models().into_iter().enumerate() {
        assert!(list.contains(model), "{list}");
        let described = ask(here(), &format!("models {model} --json")).json();
        assert_eq!(described, all[at]);
        assert_eq!(described["name"], model);
        let defaults: BTreeMap<String, Value> = serde_json::from_value(inputs).expect("it is an object");
        let of_input = |input: &Value| (input["name"].as_str().expect("a name").to_owned(), input["default"].clone());
        assert_eq!(described["inputs"].as_array().expect("inputs").iter().map(of_input).collect::<BTreeMap<_, _>>(), defaults);
        let names: Vec<_> = described["outputs"].as_array().expect("outputs").iter().map(|it| it["name"].as_str().expect("name")).collect();
        assert_eq!(names, outputs);
        let page = ask(here(), &format!("models {model}")).text();
        for name in defaults.keys().map(String::as_str).chain(names) {
            assert!(page.contains(name), "{name} is missing in\n{page}");
        }
        for list in ["inputs", "outputs"] {
            for entry in described[list].as_array().expect("a list") {
                // The unit at the end of the name is the unit of the values.
                let (name, unit) = (entry["name"].as_str().expect("a name"), entry["unit"].as_str().expect("a unit").replace('/', "_per_"));
                assert!(unit.is_empty() || name.ends_with(&format!("_{unit}")), "{name} in {unit}");
                for what in ["doc", "source"] {
                    let text = entry[what].as_str().expect("a text");
                    assert!(!text.is_empty() && page.contains(text), "{what} of {name}: \"{text}\" is missing in\n{page}");
                }
            }
        }
        for what in ["status", "Not in the model:", "default", "usual", "valid", "equation"] {
            assert!(page.contains(what), "{what} is missing in\n{page}");
        }
    }
}

#[test]
fn the_starter_study_of_every_model_passes_check() {
    for model in models::all().iter().map(|model| model.name.as_str()) {
        let study = ask(here(), &format!("models {model} --study")).text();
        let folder = folder_with("my.toml", &study);
        let text = ask(folder.path(), "check my.toml").text();
        assert!(text.contains(model) && text.contains("designs") && text.contains("scenarios"), "{text}");
        assert!(!text.contains("warning:"), "a starter has nothing to warn of:\n{text}");
    }
}

#[test]
fn a_design_of_defaults_has_every_output() {
    for (model, inputs, outputs) in all_models() {
        let object = ask(here(), &format!("eval {model} --json")).json();
        assert_eq!(keys(&object), ["model", "inputs", "outputs", "status"]);
        assert_eq!((&object["model"], &object["status"]), (&json!(model), &json!("ok")));
        assert_eq!(object["inputs"], inputs);
        let asked = |name: &&str| !NOT_ASKED.contains(name);
        assert_eq!(keys(&object["outputs"]), outputs.into_iter().filter(asked).collect::<Vec<_>>());
        assert!(object["outputs"].as_object().expect("an object").values().all(Value::is_number));
        let table = ask(here(), &format!("eval {model}")).text();
        assert!(keys(&object["outputs"]).into_iter().all(|name| table.contains(name)), "{table}");
        assert!(table.ends_with("status ok\n"), "{table}");
    }
}

#[test]
fn outputs_without_a_meaning_are_absent() {
    let slip = ask(here(), "eval metal-cvt --set traction=0.9 --json").json();
    assert_eq!(slip["status"], "slip on the driven pulley");
    let kept = "driver_radius_mm driven_radius_mm driver_wrap_deg driven_wrap_deg effective_friction traction_limit \
                driven_traction_limit driver_traction_limit traction_used slip_margin belt_speed_m_per_s centrifugal_force_N power_kW \
                bending_stress_MPa optimum_thickness_mm";
    assert_eq!(keys(&slip["outputs"]), kept.split_whitespace().collect::<Vec<_>>());
    assert!(slip["outputs"]["slip_margin"].as_f64().is_some_and(|margin| margin < 0.0));
    let impossible = [
        ("centre_distance_mm=600", "belt too short"),
        ("belt_length_mm=3000", "pulleys overlap"),
        ("belt_length_mm=5000 --set ratio=3", "no geometry"),
    ];
    for (set, status) in impossible {
        let none = ask(here(), &format!("eval rubber-cvt --set {set} --json")).json();
        assert_eq!((&none["status"], keys(&none["outputs"])), (&json!(status), vec!["effective_friction", "power_kW"]), "{set}");
        let table = ask(here(), &format!("eval rubber-cvt --set {set}")).text();
        assert!(table.contains(&format!("status {status}")), "{table}");
        assert!(table.lines().any(|line| line.trim_start().starts_with("axial_force_N") && line.contains(" - ")), "{table}");
        assert!(!table.contains("NaN") && !table.contains("inf "), "{table}");
    }
    let lifted = ask(here(), "eval pulley-load --set slack_tension_N=20 --json").json();
    assert_eq!(lifted["status"], "belt lifts");
    let kept =
        ["belt_speed_m_per_s", "slack_tension_used_N", "tight_tension_N", "effective_tension_N", "centrifugal_tension_N", "torque_Nm"];
    assert_eq!(keys(&lifted["outputs"]), kept);
    let loose = ask(here(), "eval pulley-load --set tensioning=fixed-centres --set installed_tension_N=110 --json").json();
    assert_eq!((&loose["status"], keys(&loose["outputs"])), (&json!("slack belt"), kept.to_vec()));
    // With an impossible section only the belt's outputs have values, and a note says what is wrong.
    let bent = ask(here(), "eval pulley --set fold_radius_mm=1.8 --json");
    assert!(bent.err.contains("the inside radius of bend D would be 0 mm"), "{}", bent.err);
    let bent = bent.json();
    assert_eq!((&bent["status"], keys(&bent["outputs"]).len()), (&json!("no section"), 14));
    // A belt that slips has its tensions and a negative margin, and does to the pulley nobody knows what.
    let weak = ask(here(), "eval pulley-load --set friction_limit=0.01 --json").json();
    assert!(weak["status"] == "slip" && weak["outputs"]["friction_margin"].as_f64().is_some_and(|margin| margin < 0.0), "{weak}");
    let kept = [&kept[..5], &["effective_friction", "friction_used", "friction_margin", "torque_Nm"]].concat();
    assert_eq!(keys(&weak["outputs"]), kept);
    let sliding = ask(here(), "eval pulley --set friction_limit=0.01 --json").json();
    let section = ["volume_mm3", "mass_g", "excluded_radius_mm", "seat_pressure_MPa", "bolt_utilisation", "joint_slip_safety"];
    assert_eq!((&sliding["status"], keys(&sliding["outputs"])), (&json!("slip"), [&kept[..], &section].concat()));
    // Without torque nothing could slip at the bolts.
    let idle = ask(here(), "eval pulley --set power_kW=0 --json").json();
    assert!(idle["status"] == "ok" && idle["outputs"].get("joint_slip_safety").is_none(), "{idle}");
}

#[test]
fn values_may_be_set_in_other_units_and_words() {
    let words =
        ["eval", "metal-cvt", "--json", "--set", "band_width_mm=0.25 in", "--set", "torque_Nm = 10 lbf ft", "--set", "strength_MPa=1GPa"];
    let object = ask_words(here(), &words).json();
    assert_eq!(object["inputs"]["band_width_mm"], json!(6.35));
    assert_eq!(object["inputs"]["strength_MPa"], json!(1000));
    assert!(object["inputs"]["torque_Nm"].as_f64().is_some_and(|torque| (torque - 13.558_179_483_314).abs() < 1e-9));
    let set = ask(here(), "eval rubber-cvt --json --set traction=limit").json();
    assert_eq!(set["inputs"]["traction"], "limit");
    assert_eq!(set["outputs"]["slip_margin"], 0);
    let table = ask(here(), "eval rubber-cvt --set traction=limit").text();
    assert!(table.lines().any(|line| line.split_whitespace().take(2).eq(["traction", "limit"])), "{table}");
    // Outside of the range that the source covers the program computes, with a note.
    let far = ask(here(), "eval rubber-cvt --set friction=0.9");
    assert!(far.err.contains("friction = 0.9 lies outside 0.3 to 0.5"), "{}", far.err);
    assert_eq!(far.code, Some(0));
}

#[test]
fn all_wrong_settings_are_named_at_once() {
    let words =
        ["eval", "metal-cvt", "--set", "ratio=-1", "--set", "grove_angle_deg=3", "--set", "band_count=2.5", "--set", "torque_Nm=3 lbf"];
    let err = ask_words(here(), &[&words[..], &["--set", "slip_margin=1", "--set", "x", "--set", "traction=-1"]].concat()).refusal(2);
    for expected in [
        "ratio = -1 is out of range; it must be greater than 0",
        "grove_angle_deg is no input of metal-cvt; did you mean groove_angle_deg?",
        "band_count = 2.5 must be a whole number",
        "torque_Nm: \"lbf\" measures a force, but a torque is wanted",
        "slip_margin is an output of metal-cvt",
        "--set \"x\": write NAME=VALUE",
        // The number that stands for the word inside the program means nothing outside.
        "traction = -1 is out of range; it must be at least 0 and less than 1, or \"limit\"",
    ] {
        assert!(err.contains(expected), "{expected} is missing in\n{err}");
    }
    let far = ask(here(), "eval metal-cvt --set colour=3").refusal(2);
    assert!(!far.contains("did you mean") && far.contains("beltspace models metal-cvt"), "nothing is near enough to suggest: {far}");
}

/// Do the tags of an XML text open and close as they should?
fn nests(xml: &str) -> bool {
    let mut open = Vec::new();
    for part in xml.split('<').skip(1) {
        let Some((tag, _)) = part.split_once('>') else { return false };
        let name = tag.split_whitespace().next().unwrap_or_default();
        match (name.strip_prefix('/'), tag.ends_with('/')) {
            (Some(closed), _) if open.pop() != Some(closed) => return false,
            (None, false) if !tag.starts_with(['?', '!']) => open.push(name),
            _ => {}
        }
        if tag.matches('"').count() % 2 == 1 {
            return false;
        }
    }
    open.is_empty() && xml.starts_with("<svg") && !xml.contains("NaN")
}

#[test]
fn values_along_the_belt_rise_from_slack_to_tight() {
    assert!(
        nests("<svg><a x=\"1\"/><b>t</b></svg>") && !nests("<svg><b></svg>") && !nests("<svg><b></c></svg>") && !nests("<svg a=\"></svg>")
    );
    let folder = tempdir().expect("there is room");
    let object = ask(folder.path(), "eval pulley-load --profile belt.csv --plot belt.svg --json").json();
    let belt = Csv::read(&folder.path().join("belt.csv"));
    assert_eq!(belt.header, ["wrap_position_deg", "tension_N", "line_force_N_per_mm", "flank_force_N_per_mm"]);
    let (angle, tension) = (belt.numbers("wrap_position_deg"), belt.numbers("tension_N"));
    assert!(angle.len() > 20 && angle.is_sorted() && angle.first() == Some(&0.0) && angle.last() == Some(&88.0), "{angle:?}");
    assert!(tension.windows(2).all(|pair| pair[0] < pair[1]), "{tension:?}");
    let output = |name: &str| object["outputs"][name].as_f64().expect("a number");
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * b.abs();
    assert!(near(tension[0], 700.0) && near(tension[tension.len() - 1], output("tight_tension_N")));
    for (column, name) in [("line_force_N_per_mm", "line"), ("flank_force_N_per_mm", "flank")] {
        let force = belt.numbers(column);
        assert!(near(force[0], output(&format!("slack_end_{name}_force_N_per_mm"))));
        assert!(near(force[force.len() - 1], output(&format!("tight_end_{name}_force_N_per_mm"))));
    }
    let svg = read(&folder.path().join("belt.svg"));
    assert!(nests(&svg) && svg.contains("tension"), "{}", &svg[..svg.len().min(400)]);
    for model in ["metal-cvt", "rubber-cvt"] {
        let err = ask(folder.path(), &format!("eval {model} --profile none.csv")).refusal(2);
        assert!(err.contains("models that have them: timing-belt, pulley-load"), "{err}");
    }
    let err = ask(folder.path(), "eval pulley-load --set slack_tension_N=20 --plot none.svg").refusal(2);
    assert!(err.contains("belt lifts") && !folder.path().join("none.svg").exists(), "{err}");
}

/// A load whose stresses are beyond what f64 holds has no picture.
#[test]
fn a_picture_of_what_overflows_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary directory");
    let said = ask(folder.path(), "eval pulley --preset double-groove --set clamp_force_N=1e160 --plot p.svg").refusal(2);
    assert!(said.contains("the status is \"overflow\"") && !folder.path().join("p.svg").exists(), "{said}");
}

#[test]
fn a_design_of_a_study_is_what_the_front_says() {
    let folder = folder_with("small.toml", SMALL);
    let at = folder.path();
    ask(at, "sweep small.toml --out small").text();
    let front = Csv::read(&at.join("small/front.csv"));
    let summary = json_of(&at.join("small/summary.json"));
    assert!(front.rows.len() > 20, "{}", front.rows.len());
    let columns = ["axial_force_N", "stress_margin", "band_count", "slip_margin", "stress_margin_constrained", "max_stress_MPa"];
    for row in [0, 7, front.rows.len() - 1] {
        let design = front.column("design_index")[row];
        let object = ask(at, &format!("eval small.toml --design {design} --json")).json();
        assert_eq!((&object["feasible"], &object["status"]), (&json!(true), &json!("ok")));
        for name in columns {
            let said = |column: &str| front.column(column)[row];
            let worst = &object["outputs"][name];
            // A design input is the same in every scenario and needs no column for it.
            let scenario = if name == "band_count" { "0" } else { said(&format!("{name}_scenario")) };
            let value = said(name).parse::<f64>().expect("a number");
            assert_eq!(worst["value"].as_f64().map(f64::to_bits), Some(value.to_bits()), "{name} of design {design}");
            assert_eq!(worst["scenario"].to_string(), scenario, "{name} of design {design}");
            // The same design in that scenario alone takes that value there.
            let one = ask(at, &format!("eval small.toml --design {design} --scenario {scenario} --json")).json();
            let single = one["outputs"].get(name.trim_end_matches("_constrained")).unwrap_or(&one["inputs"]["band_count"]);
            assert_eq!(single.as_f64().map(f64::to_bits), Some(value.to_bits()), "{name} of design {design} in scenario {scenario}");
        }
        for name in ["groove_angle_deg", "band_thickness_mm", "traction"] {
            assert_eq!(object["inputs"][name].as_f64(), front.column(name)[row].parse().ok());
        }
        let table = ask(at, &format!("eval small.toml --design {design}")).text();
        assert!(table.contains("feasible yes") && table.contains("axial_force_N") && table.contains("holds"), "{table}");
    }
    let last = summary["designs"].as_u64().expect("a count") - 1;
    assert_eq!(last + 1, 13 * 21 * 9 * 5);
    ask(at, &format!("eval small.toml --design {last}")).text();
    let err = ask(at, &format!("eval small.toml --design {}", last + 1)).refusal(2);
    assert!(err.contains(&format!("there is no design {}; the study's designs are 0 to {last}", last + 1)), "{err}");
    ask(at, "eval small.toml --design 0 --scenario 11").text();
    let err = ask(at, "eval small.toml --design 0 --scenario 12").refusal(2);
    assert!(err.contains("there is no scenario 12; the study's scenarios are 0 to 11"), "{err}");
    // Traction 0.5 slips at the lower friction: not feasible, and the reader is told where.
    let bad = ask(at, &format!("eval small.toml --design {last} --json")).json();
    assert_eq!((&bad["feasible"], &bad["status"]), (&json!(false), &json!("slip on the driven pulley")), "{bad}");
    assert!(bad["scenarios_not_ok"].as_u64().is_some_and(|count| 0 < count && count < 12), "{bad}");
    assert_eq!((&bad["constraints"][0]["of"], &bad["constraints"][0]["holds"]), (&json!("slip_margin"), &json!(false)));
    let table = ask(at, &format!("eval small.toml --design {last}")).text();
    assert!(
        table.contains("feasible no") && table.contains("status slip on the driven pulley in scenario 0") && table.contains("violated"),
        "{table}"
    );
}

/// A share of draws that is too small says nothing of what fails, and a case of a draw has its number in no file.
#[test]
fn a_design_whose_draws_fail_says_at_what_and_in_which_cases_it_can_be_looked_at() {
    let study = "model = \"metal-cvt\"\n[design]\nband_count = [8, 9]\n[operation]\ncases = [{ ratio = 1, torque_Nm = 60 }, { ratio = 2, \
        torque_Nm = 80 }]\n[uncertainty]\nfriction = { normal = { mean = 0.08, sd = 0.005 }, from = 0.06, to = 0.1 }\n[probability]\n\
        draws = 512\nconfirm = 1000\n[fixed]\nclamping_force_N = 20000\nstrength_MPa = 650\n[constraints]\nslip_margin = { min = 0.1 }\n\
        stress_margin = { min = 0 }\nyield = { min = 0.99 }\n[objectives]\nyield = \"max\"\n";
    let folder = folder_with("study.toml", study);
    let found = ask(folder.path(), "eval study.toml --design 0 --json").json();
    let failing = &found["draws_fail_at"];
    let count = |of: &Value| of.as_u64().expect("a count");
    assert_eq!((count(&failing["draws"]), count(&failing["sampled"])), (512, 512));
    let screened = found["outputs"]["yield_screened"]["value"].as_f64().expect("a yield");
    assert_eq!(count(&failing["feasible"]) as f64 / 512.0, screened);
    let slipping = failing["constraints"].as_array().expect("constraints").iter().find(|it| it["of"] == "slip_margin").expect("it is one");
    let share = 100.0 * count(&slipping["violated"]) as f64 / 512.0;
    assert!(share > 0.0 && share < 100.0 && screened > 0.0 && screened < 0.99, "{failing}");
    let text = ask(folder.path(), "eval study.toml --design 0").text();
    let after = text.split_once("what draws fail at, of all draws\n").expect("it says so").1;
    let line = after.lines().find(|line| line.trim_start().starts_with("slip_margin at least 0.1")).expect("it is named");
    assert!(line.contains(&format!("fails {share:.1} %")), "{line}");
    // A case has the number by which it is shown.
    let cases = found["cases_of_a_draw"].as_array().expect("cases");
    assert_eq!(cases.len(), 2);
    for (number, case) in cases.iter().enumerate() {
        let shown = ask(folder.path(), &format!("eval study.toml --design 0 --scenario {number} --json")).json();
        for name in ["ratio", "torque_Nm"] {
            assert_eq!(case["inputs"][name], shown["inputs"][name], "{case}");
        }
    }
    assert!(after.contains("operating cases of a draw, of which --scenario K shows one\n"), "{after}");
    let rows: Vec<Vec<&str>> = after.lines().map(|line| line.split_whitespace().collect()).collect();
    assert!(rows.contains(&vec!["ratio", "torque_Nm"]) && rows.contains(&vec!["1", "2", "80"]), "{after}");
}

#[test]
fn an_input_that_is_not_read_says_so() {
    let model = ask(here(), "models pulley --json").json();
    let text = ask(here(), "eval pulley --set section=machined").text();
    let mut unread = 0;
    let inputs = model["inputs"].as_array().expect("inputs");
    for input in inputs {
        let name = input["name"].as_str().expect("a name");
        let line = text.lines().find(|line| line.split_whitespace().next() == Some(name)).expect("it is listed");
        let deciding = inputs.iter().find(|it| it["name"] == input["only_for"]["input"]);
        let word = deciding.map(|it| if it["name"] == "section" { "machined".into() } else { it["default"].clone() });
        let words = input["only_for"]["words"].as_array();
        let expected = words.zip(word).is_some_and(|(words, word)| !words.contains(&word));
        assert_eq!(line.contains("Not read here."), expected, "{line}");
        unread += usize::from(expected);
    }
    assert!(unread > 2, "some inputs are for other sections");
}

#[test]
fn a_profile_of_a_study_wants_a_scenario() {
    let study = ask(here(), "models pulley-load --study").text();
    let folder = folder_with("load.toml", &study);
    write(folder.path(), "belt.csv", "old");
    let err = ask(folder.path(), "eval load.toml --design 90000 --profile belt.csv").refusal(2);
    assert!(err.contains("add --scenario K, from 0 to 35") && read(&folder.path().join("belt.csv")) == "old", "{err}");
    let err = ask(folder.path(), "eval load.toml --design 90000 --scenario 0 --profile belt.csv").refusal(2);
    assert!(err.contains("belt.csv: a file is there that this program did not write"), "{err}");
    std::fs::remove_file(folder.path().join("belt.csv")).expect("it is there");
    ask(folder.path(), "eval load.toml --design 90000 --scenario 0 --profile belt.csv").text();
    assert!(Csv::read(&folder.path().join("belt.csv")).numbers("tension_N").is_sorted());
}
