//! The drive drawn to scale in a design's card, and the slices around the knee, in Chromium.

use crate::browser::Browser;
use crate::report_page::{Swept, beltspace};
use serde_json::Value;
use std::path::Path;

/// What is drawn, in millimetres by the scale bar: its length on paper over the length that it names.
const MEASURED: &str = "(() => { const svg = document.querySelector('#card svg.drive'); const bar = svg.querySelector('.scale-bar').getBBox(); \
     const [number, unit] = svg.querySelector('.scale-text').textContent.split(' '); \
     const scale = bar.width / (Number(number) * (unit === 'm' ? 1000 : 1)); \
     const circles = [...svg.querySelectorAll('circle.pulley-body')].map((it) => ({ x: it.cx.baseVal.value / scale, r: it.r.baseVal.value / scale })); \
     const box = (it) => { const b = it.getBBox(); return { width: b.width / scale, height: b.height / scale }; }; \
     return { scale, circles, ghosts: [...svg.querySelectorAll('circle.ghost-circle')].map((it) => it.r.baseVal.value / scale), \
     belts: [...svg.querySelectorAll('.belt')].map(box), bodies: [...svg.querySelectorAll('.pulley-body')].map(box), \
     title: svg.querySelector('title').textContent, text: svg.querySelector('desc').textContent, named: svg.getAttribute('aria-labelledby').split(' ') \
     .every((id) => document.getElementById(id)), teeth: svg.querySelectorAll('.belt-tooth').length, \
     notes: document.querySelector('[data-testid=drive-notes]').textContent }; })()";

fn drawn(browser: &mut Browser, row: usize) -> Value {
    browser.evaluate(&format!("beltspace.openCard({row})"));
    let found = browser.evaluate(MEASURED);
    assert_eq!(found["named"], true, "title and description: {found}");
    assert!(found["title"].as_str().is_some_and(|it| it.ends_with("to scale") || it.contains("at ratio")), "{found}");
    found
}

/// Numbers under a pointer of some JSON, such as `/circles/0/r`.
fn at(found: &Value, pointer: &str) -> f64 {
    found.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("no {pointer} in {found}"))
}

fn near(a: f64, b: f64, within: f64) -> bool {
    (a - b).abs() <= within * b.abs()
}

/// Outputs of a model by the reference.
fn evaluated(model: &str, set: &[&str]) -> Value {
    let words: Vec<&str> = ["eval", model, "--json"].into_iter().chain(set.iter().flat_map(|it| ["--set", it])).collect();
    serde_json::from_str(&beltspace(&words)).expect("--json prints JSON")
}

fn variator(model: &str, further: &str) -> String {
    format!(
        "model = \"{model}\"\n[design]\n{further}\n[operation]\nratio = {{ from = 0.5, to = 2.0, count = 5, spacing = \"log\" }}\n\
         [objectives]\nmax_stress_MPa = \"min\"\naxial_force_N = \"min\"\n"
    )
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn variators_are_drawn_to_scale_at_every_ratio() {
    let cases = [
        ("metal-cvt", "band_count = [8, 10]\ngroove_angle_deg = [20, 24]", 613.0, 156.0),
        ("rubber-cvt", "belt_thickness_mm = [8, 10, 12]", 1066.0, 260.0),
    ];
    for (model, design, _, centres) in cases {
        let swept = Swept::text(&variator(model, design));
        let mut browser = Browser::open(&swept.page(), "");
        let row = swept.front().len() - 1;
        let found = drawn(&mut browser, row);
        let radii = |ratio: &str| {
            let outputs = &evaluated(model, &[&format!("ratio={ratio}")])["outputs"];
            ["driver_radius_mm", "driven_radius_mm"].map(|name| outputs[name].as_f64().expect("a radius"))
        };
        // It begins at ratio 1, with dashed circles at both ends.
        for (ratio, step) in [("1", None), ("0.5", Some(0)), ("2", Some(200))] {
            if let Some(step) = step {
                let slide = format!(
                    "(() => {{ const e = document.querySelector('#drive-ratio'); e.value = {step}; e.dispatchEvent(new Event('input')); }})()"
                );
                browser.evaluate(&slide);
            }
            let found = browser.evaluate(MEASURED);
            let wanted = radii(ratio);
            for (pulley, &wanted) in wanted.iter().enumerate() {
                let radius = at(&found, &format!("/circles/{pulley}/r"));
                assert!(near(radius, wanted, 1e-3), "{model} at {ratio}: pulley {pulley} has {radius}, the model {wanted}");
            }
            assert!(near(at(&found, "/circles/1/x") - at(&found, "/circles/0/x"), centres, 1e-3), "{model} at {ratio}: {found}");
        }
        let [ends, others] = [radii("0.5"), radii("2")];
        for (circle, wanted) in [ends, others].concat().into_iter().enumerate() {
            assert!(near(at(&found, &format!("/ghosts/{circle}")), wanted, 1e-3), "{model}: {found}");
        }
        // The belt reaches from pulley to pulley and half its thickness further, on either side.
        let thickness = browser.number(&format!(
            "(() => {{ const of = (name) => beltspace.page.quantityOf(name, {row}).value; \
             return '{model}' === 'metal-cvt' ? of('band_count') * of('band_thickness_mm') : of('belt_thickness_mm'); }})()"
        ));
        let across = centres + radii("1").iter().sum::<f64>() + thickness;
        assert!(near(at(&found, "/belts/0/width"), across, 2e-3), "{model}: {} for {across}", at(&found, "/belts/0/width"));
        // A belt of another thickness would be seen: what is drawn follows the design.
        assert!(!near(at(&found, "/belts/0/width"), across + thickness, 2e-3));
        let said = found["notes"].as_str().expect("a text");
        assert!(said.contains("Not to scale: ") && said.contains("sheaves"), "{said}");
        browser.picture(&format!("drawn-{model}"));
        assert_eq!(browser.complaints, Vec::<String>::new());
    }
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn belts_and_pulleys_without_a_ratio_are_drawn_to_scale() {
    let flat = "model = \"flat-belt\"\n[design]\ndriver_diameter_mm = [150, 200]\ncentre_distance_mm = [900, 1100]\n\
                [objectives]\nshaft_load_N = \"min\"\nbelt_stress_MPa = \"min\"\nslip_margin = \"max\"\ncentre_distance_mm = \"min\"\n";
    let swept = Swept::text(flat);
    let mut browser = Browser::open(&swept.page(), "");
    for (row, front) in swept.front().iter().enumerate() {
        let found = drawn(&mut browser, row);
        let wanted = |name: &str| front[name].parse::<f64>().expect("a number");
        assert!(near(2.0 * at(&found, "/circles/0/r"), wanted("driver_diameter_mm"), 1e-3), "{found}");
        assert!(near(2.0 * at(&found, "/circles/1/r"), 450.0, 1e-3), "{found}");
        let apart = at(&found, "/circles/1/x") - at(&found, "/circles/0/x");
        assert!(near(apart, wanted("centre_distance_mm"), 1e-3), "{found}");
        assert!(found["notes"].as_str().is_some_and(|it| it.contains("3.3 mm is drawn as a line")), "{found}");
    }
    browser.picture("drawn-flat-belt");

    let timing = "model = \"timing-belt\"\n[design]\ntip_radius_mm = [40, 66.32]\nteeth_in_mesh = [12, 23]\n\
                  [objectives]\npeak_tooth_load_N = \"min\"\ntip_radius_mm = \"min\"\nteeth_in_mesh = \"max\"\n";
    let swept = Swept::text(timing);
    let mut browser = Browser::open(&swept.page(), "");
    for (row, front) in swept.front().iter().enumerate() {
        let found = drawn(&mut browser, row);
        assert_eq!(found["teeth"].as_f64(), front["teeth_in_mesh"].parse().ok(), "{found}");
        // The corners of the teeth lie on the tip circle: none of 44 teeth is quite at its ends.
        let wide = at(&found, "/bodies/0/width") / 2.0;
        assert!(near(wide, front["tip_radius_mm"].parse().expect("a number"), 4e-3), "{wide}: {found}");
    }
    browser.picture("drawn-timing-belt");

    let load = "model = \"pulley-load\"\n[design]\nmean_radius_mm = [50, 60]\ngroove_count = [1, 3]\n\
                [objectives]\nresultant_force_N = \"min\"\nmean_radius_mm = \"min\"\ntight_end_flank_force_N_per_mm = \"min\"\n";
    let swept = Swept::text(load);
    let mut browser = Browser::open(&swept.page(), "");
    for (row, front) in swept.front().iter().enumerate() {
        let found = drawn(&mut browser, row);
        assert!(near(at(&found, "/ghosts/0"), front["mean_radius_mm"].parse().expect("a number"), 1e-3), "{found}");
        // One arc of contact and one belt in each groove, above and below the axis.
        let grooves: usize = front["groove_count"].parse().expect("a whole number");
        assert_eq!(found["belts"].as_array().map(Vec::len), Some(1 + 2 * grooves), "{found}");
    }
    browser.picture("drawn-pulley-load");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

/// What formulas of the study give stands nowhere on the page but for this; also where tolerances are drawn.
#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn a_drive_whose_dimensions_follow_from_formulas_is_drawn() {
    let plain = "model = \"timing-belt\"\n[design]\npulley_teeth = [36, 44]\ntight_tension_N = [400, 440]\n[operation]\npulley_speed_rpm = [800, 5000]\n\
        [formulas]\ntip_radius_mm = \"pulley_teeth * pitch_mm / (2 * pi) - pitch_line_mm\"\nteeth_in_mesh = \"floor(pulley_teeth / 2)\"\n\
        land_half_angle_deg = \"64.8[deg] / pulley_teeth\"\nspace_half_angle_deg = \"115.2[deg] / pulley_teeth\"\n\
        [objectives]\npulley_teeth = \"min\"\n";
    let drawn_too = plain.replace(
        "[formulas]",
        "[uncertainty]\nfriction = { uniform = [0.3, 0.55] }\n[probability]\ndraws = 256\nconfirm = 500\n[formulas]",
    );
    for text in [plain.to_owned() + "tight_tension_N = \"max\"\n", drawn_too + "yield = \"max\"\n"] {
        let swept = Swept::text(&text);
        let mut browser = Browser::open(&swept.page(), "");
        let found = drawn(&mut browser, 0);
        let teeth = browser.number("beltspace.page.front.byName.get('pulley_teeth').values[0]");
        let tip = teeth * 9.525 / std::f64::consts::TAU - 0.686;
        let told = browser.text("document.querySelector('#card svg.drive').textContent");
        let shown = browser.text(&format!("beltspace.page.short({tip})"));
        assert!(told.contains(&format!("tip r {shown} mm")), "{teeth} teeth: {told}");
        assert!(found["text"].as_str().is_some_and(|it| it.contains(&format!("{} teeth in mesh", (teeth / 2.0).floor()))), "{found}");
    }
}

const OWN: &str = r#"summary = "Two rollers"
source = "geometry"
[inputs]
width_mm = { default = 10, valid = [1, 100], doc = "Width." }
[formulas]
area_mm2 = { is = "width_mm * width_mm", worst = "highest", doc = "Area." }
"#;

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn a_model_of_its_own_has_no_drawing_and_one_with_a_base_has_that_of_its_base() {
    let folder = tempfile::tempdir().expect("there is room");
    std::fs::write(folder.path().join("own.toml"), OWN).expect("it can be written");
    let study = "model = \"own.toml\"\n[design]\nwidth_mm = [10, 20]\n[objectives]\narea_mm2 = \"min\"\nwidth_mm = \"max\"\n";
    std::fs::write(folder.path().join("study.toml"), study).expect("it can be written");
    let swept = Swept::of(folder.path().join("study.toml").to_str().expect("a path of characters"));
    let mut browser = Browser::open(&swept.page(), "");
    browser.evaluate("beltspace.openCard(0)");
    assert_eq!(browser.number("document.querySelectorAll('#card [data-testid=drive]').length"), 0.0);
    assert_eq!(browser.evaluate("beltspace.data.model.drive"), Value::Null);

    std::fs::write(folder.path().join("own.toml"), "base = \"metal-cvt\"\n[formulas]\nweight_N = \"2[N] * band_count\"\n")
        .expect("it can be written");
    let study = "model = \"own.toml\"\n[design]\nband_count = [8, 10]\n[objectives]\nweight_N = \"min\"\nmax_stress_MPa = \"min\"\n";
    std::fs::write(folder.path().join("study.toml"), study).expect("it can be written");
    let swept = Swept::of(folder.path().join("study.toml").to_str().expect("a path of characters"));
    let mut browser = Browser::open(&swept.page(), "");
    let found = drawn(&mut browser, 0);
    assert!(found["title"].as_str().is_some_and(|it| it.starts_with("Push belt")), "{found}");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn the_knee_has_slices_and_words_that_hold() {
    let swept = Swept::shipped("metal-cvt");
    let mut browser = Browser::open(&swept.page(), "");
    let around = browser.evaluate("beltspace.data.around");
    let knee = browser.number("beltspace.data.front.knee") as usize;
    let front = &swept.front()[knee];
    assert_eq!(around["design"], front["design_index"].as_str());
    let slices = around["slices"].as_array().expect("slices");
    let count = |name: &str| around[name].as_u64().expect("a number") as usize;
    let names: Vec<_> = slices.iter().map(|it| it["input"].as_str().expect("a name")).collect();
    assert_eq!(names[..4], ["groove_angle_deg", "band_thickness_mm", "band_count", "reserve"]);
    // Then what the study says of loads, of friction and of the strength.
    let said = [
        "ratio, the least",
        "ratio, the largest",
        "torque_Nm, the least",
        "torque_Nm, the largest",
        "friction, the least",
        "friction, the largest",
        "strength_MPa",
    ];
    assert_eq!(names[4..], said);
    assert!(count("defaults") == 0 && count("given") == said.len(), "{names:?}");
    for slice in slices {
        let own =
            slice["at"].as_array().and_then(|places| places.iter().position(|it| *it == slice["own"])).expect("its own value is a place");
        assert_eq!(slice["feasible"][own], true);
        for (column, line) in around["columns"].as_array().expect("columns").iter().zip(slice["lines"].as_array().expect("lines")) {
            let name = column["name"].as_str().expect("a name");
            assert_eq!(line["values"][own].as_f64(), front[name].parse().ok(), "{name} of the knee");
        }
    }
    // What it says of one input, judged again by the program: feasible up to there, and not at the next place.
    let input = |name: &str| format!("{name} = [{}]\n", front[name]);
    let judged = |thickness: f64| {
        let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/metal-cvt.toml")).expect("a study");
        let (head, rest) = text.split_once("[design]").expect("a design");
        let rest = &rest[rest.find("[operation]").expect("an operation")..];
        let design = format!("{}band_thickness_mm = [{thickness}]\n{}{}", input("groove_angle_deg"), input("band_count"), input("reserve"));
        let file = swept.folder.path().join("one.toml");
        // A map needs axes of several levels.
        let rest: String = rest.lines().filter(|it| !it.starts_with("maps")).map(|it| format!("{it}\n")).collect();
        std::fs::write(&file, format!("{head}[design]\n{design}{rest}")).expect("it can be written");
        let told = beltspace(&["eval", file.to_str().expect("a path of characters"), "--design", "0", "--json"]);
        serde_json::from_str::<Value>(&told).expect("JSON")
    };
    let slice = slices.iter().find(|it| it["input"] == "band_thickness_mm").expect("a slice of the thickness");
    let places: Vec<f64> = serde_json::from_value(slice["at"].clone()).expect("places");
    let feasible: Vec<bool> = serde_json::from_value(slice["feasible"].clone()).expect("verdicts");
    let last = feasible.iter().rposition(|&it| it).expect("the knee is feasible");
    assert!(last + 1 < places.len(), "the slice ends before the axis");
    for at in [last, last + 1] {
        let told = judged(places[at]);
        assert_eq!(told["feasible"].as_bool(), Some(feasible[at]), "{}: {told}", places[at]);
        let of = around["columns"].as_array().and_then(|it| it.iter().position(|it| it["name"] == "stress_margin")).expect("a column");
        assert_eq!(told["outputs"]["stress_margin"]["value"], slice["lines"][of]["values"][at]);
    }
    let said = browser.text("document.querySelector('#around').innerText");
    assert!(said.contains("stress_margin is too low") && said.contains("the end of its axis"), "{said}");
    assert!(said.contains("beltspace explore"), "{said}");
    assert!(browser.number("document.querySelectorAll('#around svg.slice .limit').length") >= 4.0);
    // A limit that a chart does not reach is an arrow at its edge.
    let limits = "(() => { const { page } = beltspace; const box = document.createElement('div'); \
         const [column] = page.front.constraints.filter((it) => it.column && it.column.name === 'stress_margin').map((it) => it.column); \
         const draw = (values) => { page.drawSlices(box, { columns: [column], slices: [{ input: 'ratio', unit: '', own: 1, words: null, at: [0, 1], \
         feasible: [true, true], status: [null, null], lines: [{ values, scenarios: [0, 0] }] }] }); \
         return [box.querySelectorAll('.limit').length, box.querySelectorAll('.limit-beyond').length, box.textContent.includes('(limit ')]; }; \
         return [draw([1e6, 1.1e6]), draw([-1, 1]), draw([3, 3])]; })()";
    assert_eq!(browser.evaluate(limits), serde_json::json!([[0, 1, false], [1, 0, false], [0, 0, true]]));
    // Infeasible places that touch are one band, with one line below it.
    let bands = "(() => { const { page } = beltspace; const box = document.createElement('div'); const [column] = page.front.objectives.map((it) => it.column); \
         page.drawSlices(box, { columns: [column], slices: [{ input: 'ratio', unit: '', own: 1, words: null, at: [0, 1, 2, 3, 4], \
         feasible: [false, true, false, false, true], status: [null, null, null, null, null], lines: [{ values: [1, 2, 3, 4, 5], scenarios: [0, 0, 0, 0, 0] }] }] }); \
         return ['no-go', 'no-go-line'].map((name) => [...box.querySelectorAll(`.${name}`)].map((it) => Number(it.getAttribute('width')) > 0)); })()";
    assert_eq!(browser.evaluate(bands), serde_json::json!([[true, true], [true, true]]));
    let words = "['slip_margin_draw_q99_9', 'force_draw_q99_N', 'a_q1_2nd'].map((name) => beltspace.page.axisWords(name, name.endsWith('_N') ? 'N' : ''))";
    assert_eq!(browser.evaluate(words), serde_json::json!(["slip margin draw q99.9", "force draw q99", "a q1 2nd"]));
    let units = "['N/mm2', 'kg/m3', 'cm3', 'um', 'Nm', 'deg', 'm2/s', 'm/s', 'team2'].map(beltspace.page.unit)";
    assert_eq!(browser.evaluate(units), serde_json::json!(["N/mm²", "kg/m³", "cm³", "µm", "N m", "°", "m²/s", "m/s", "team2"]));
    // Where scenarios change places by rounding only, no switch is drawn; a timing belt has real ones.
    assert_eq!(browser.number("document.querySelectorAll('#around svg.slice .switch').length"), 0.0);
    browser.evaluate("document.querySelector('#around').scrollIntoView()");
    browser.picture("metal-cvt-slices");
    assert_eq!(browser.complaints, Vec::<String>::new());

    assert_eq!(browser.number("document.querySelectorAll('[data-testid=stripes]').length"), 0.0, "its map has no stripes");

    // The same bytes on any number of threads, from a result directory alone.
    let folder = swept.folder.path().join("r");
    let pages = ["1", "3"].map(|threads| {
        beltspace(&["report", folder.to_str().expect("a path of characters"), "--threads", threads, "--force"]);
        std::fs::read(swept.page()).expect("a page")
    });
    assert!(pages[0] == pages[1]);
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn a_map_that_shows_the_levels_of_another_axis_says_so() {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/metal-cvt.toml")).expect("a study");
    let other = text.replace("maps = [{ x = \"reserve\"", "maps = [{ x = \"band_thickness_mm\"");
    assert!(other != text, "the map of the study has another axis");
    let mut browser = Browser::open(&Swept::text(&other).page(), "");
    let striped = browser.text("document.querySelector('[data-testid=stripes]').textContent");
    assert!(striped.contains("along groove_angle_deg the value jumps back at 18.6, 27.4"), "{striped}");
    assert!(striped.contains("11 levels of reserve"), "{striped}");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
#[ignore = "drives the page in Chromium: cargo test --test it -- --ignored report_page --test-threads 1"]
fn slices_that_take_too_long_are_left_out_and_the_page_says_where_they_are() {
    let swept = Swept::text(
        "model = \"pulley\"\n[design]\nthickness_mm = [1.8, 2.0]\n[operation]\npower_kW = { from = 1, to = 3, count = 30 }\n\
         speed_rpm = { from = 2000, to = 4000, count = 30 }\n         [objectives]\nmass_g = \"min\"\nyield_safety = \"max\"\n",
    );
    let mut browser = Browser::open(&swept.page(), "");
    assert_eq!(browser.evaluate("beltspace.data.around.left_out"), true);
    let said = browser.text("document.querySelector('#around').innerText");
    assert!(said.contains("take too long") && said.contains("beltspace explore"), "{said}");
    let found = drawn(&mut browser, 0);
    assert!(near(at(&found, "/ghosts/0"), 60.0, 1e-3), "{found}");
    assert!(near(at(&found, "/circles/0/r"), 66.5, 1e-3), "{found}");
    browser.picture("drawn-pulley");
    assert_eq!(browser.complaints, Vec::<String>::new());
}
