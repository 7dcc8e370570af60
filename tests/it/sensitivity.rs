//! Which input matters: exact shares against a decomposition by brute force, estimates against closed forms.

use beltspace::influence::{HOLDS, InfluenceMethod, InfluenceOver, InfluenceReport, InfluenceSubject, QuantityReport, QuantityVerdict};
use beltspace::models::{Status, evaluate};
use beltspace::plan::Plan;
use beltspace::study::Study;
use std::collections::HashMap;
use std::f64::consts::PI;

/// A grid of designs of which some hold; every quantity has a value everywhere.
const GRID: &str = r#"model = "metal-cvt"
title = "Grid"
[design]
groove_angle_deg  = [18, 22, 30]
band_thickness_mm = { from = 0.10, to = 0.30, count = 5 }
band_count        = { from = 6, to = 14, step = 2 }
clearance         = [1]
[operation]
ratio     = [0.5, 1, 2]
torque_Nm = [50, 150]
[uncertainty]
friction     = [0.095, 0.065, 0.08]
strength_MPa = [750, 800, 850, 900]
[constraints]
stress_margin = { min = 0 }
[objectives]
axial_force_N = "min"
[report]
columns = ["max_stress_MPa"]
[formulas]
half_clearance = "clearance / 2"
"#;

fn study(text: &str) -> Study {
    Study::parse(text).unwrap_or_else(|error| panic!("{error}"))
}

fn asked(text: &str, over: InfluenceOver, design: Option<u64>, of: &[&str]) -> InfluenceReport {
    let of: Vec<String> = of.iter().map(|it| (*it).to_owned()).collect();
    let subject = InfluenceSubject::new(&study(text), over, design, &of, 4096, 1).unwrap_or_else(|error| panic!("{error}"));
    subject.report(2).unwrap_or_else(|error| panic!("{error}"))
}

fn quantity<'r>(report: &'r InfluenceReport, name: &str) -> &'r QuantityReport {
    report.quantities.iter().find(|it| it.asked.name == name).unwrap_or_else(|| panic!("nothing is said of {name}"))
}

/// A point of a grid: the level of each factor, and the value.
type GridPoint = (Vec<u64>, f64);

/// The mean of each group of points with the same levels of the factors in `set`, and how many these are.
fn means(points: &[GridPoint], set: usize) -> HashMap<Vec<u64>, (f64, f64)> {
    let mut groups: HashMap<Vec<u64>, (f64, f64)> = HashMap::new();
    for (levels, value) in points {
        let key = levels.iter().enumerate().filter(|(factor, _)| set >> factor & 1 == 1).map(|it| *it.1).collect();
        let group = groups.entry(key).or_default();
        (group.0, group.1) = (group.0 + value, group.1 + 1.0);
    }
    groups.into_iter().map(|(key, (sum, count))| (key, (sum / count, count))).collect()
}

/// The parts of the variance on a full grid that belong to each set of factors and no smaller one: the squares of the functions of the
/// decomposition after Hoeffding, each a difference of means.
fn parts(points: &[GridPoint], factors: usize) -> Vec<f64> {
    let of_sets: Vec<_> = (0..1 << factors).map(|set| means(points, set)).collect();
    let mean_at = |levels: &[u64], set: usize| -> f64 {
        let key: Vec<u64> = levels.iter().enumerate().filter(|(factor, _)| set >> factor & 1 == 1).map(|it| *it.1).collect();
        of_sets[set][&key].0
    };
    let part = |set: usize| {
        let function = |levels: &[u64]| -> f64 {
            let subsets = (0..=set).filter(|it| it & !set == 0);
            subsets.map(|it| if (set ^ it).count_ones().is_multiple_of(2) { mean_at(levels, it) } else { -mean_at(levels, it) }).sum()
        };
        points.iter().map(|(levels, _)| function(levels).powi(2)).sum::<f64>() / points.len() as f64
    };
    (0..1 << factors).map(|set| if set == 0 { 0.0 } else { part(set) }).collect()
}

/// First-order index, total index and Shapley effect of each factor: a part that belongs to several is shared equally.
fn shares(points: &[GridPoint], factors: usize) -> Vec<[f64; 3]> {
    let parts = parts(points, factors);
    let whole: f64 = parts.iter().sum();
    let of_factor = |factor: usize| {
        let with = || (0..1usize << factors).filter(move |set| set >> factor & 1 == 1);
        let total: f64 = with().map(|set| parts[set]).sum();
        let shapley: f64 = with().map(|set| parts[set] / f64::from(set.count_ones())).sum();
        [parts[1 << factor], total, shapley].map(|it| it / whole)
    };
    (0..factors).map(of_factor).collect()
}

/// Shapley effects over points that are no full grid: by walking through all orders of three factors.
fn effects_by_orders(points: &[GridPoint]) -> [f64; 3] {
    let mean = points.iter().map(|it| it.1).sum::<f64>() / points.len() as f64;
    let explained = |set: usize| {
        let groups = means(points, set);
        groups.values().map(|(own, count)| count * (own - mean).powi(2)).sum::<f64>() / points.len() as f64
    };
    let mut effects = [0.0; 3];
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        let mut known = 0;
        for factor in order {
            effects[factor] += (explained(known | 1 << factor) - explained(known)) / 6.0;
            known |= 1 << factor;
        }
    }
    effects.map(|it| it / explained(7))
}

fn assert_near(found: f64, truth: f64, what: &str) {
    assert!((found - truth).abs() < 1e-9, "{what}: {found} in place of {truth}");
}

/// The counted shares of a quantity are these.
fn assert_shares(found: &QuantityReport, expected: &[[f64; 3]]) {
    assert_eq!(found.inputs.len(), expected.len());
    for (input, expected) in found.inputs.iter().zip(expected) {
        for (share, (truth, what)) in
            [input.first, input.total, input.shapley].iter().zip(expected.iter().zip(["first", "total", "Shapley"]))
        {
            let share = share.unwrap_or_else(|| panic!("{}: no share", input.name));
            assert_near(share.value, *truth, &format!("{} {} {what}", found.asked.name, input.name));
            assert_eq!(share.confidence, None, "it is counted");
        }
    }
}

/// Of all designs of [`GRID`]: levels, the worst values of the three quantities over all scenarios, and whether it holds.
fn designs_by_brute_force() -> Vec<(Vec<u64>, [f64; 3], bool)> {
    let plan = Plan::new(study(GRID));
    let model = &plan.study.model;
    let [force, stress, margin] =
        ["axial_force_N", "max_stress_MPa", "stress_margin"].map(|name| model.output(name).expect("the model has it"));
    let of_design = |design: u64| {
        let mut worst = [f64::NEG_INFINITY, f64::NEG_INFINITY, f64::INFINITY];
        let mut holds = true;
        for scenario in 0..plan.scenarios() {
            let evaluation = evaluate(model, &plan.space.inputs(design, scenario));
            let value = |output: usize| evaluation.outputs[output].expect("it has a value everywhere");
            worst = [worst[0].max(value(force)), worst[1].max(value(stress)), worst[2].min(value(margin))];
            holds &= evaluation.status == Status::Ok && value(margin) >= 0.0;
        }
        // Three axes of 3, 5 and 5 levels, the last fastest; the fourth has one.
        (vec![design / 25, design / 5 % 5, design % 5], worst, holds)
    };
    (0..75).map(of_design).collect()
}

#[test]
fn shares_over_the_design_are_those_of_the_decomposition() {
    let designs = designs_by_brute_force();
    let report = asked(GRID, InfluenceOver::Design, None, &[]);
    assert_eq!(report.method, InfluenceMethod::Grid { combinations: 75 });
    let names: Vec<&str> = report.quantities.iter().map(|it| it.asked.name.as_str()).collect();
    assert_eq!(names, ["axial_force_N", "stress_margin", "max_stress_MPa", HOLDS]);
    let holding = designs.iter().filter(|it| it.2).count();
    assert!((10..65).contains(&holding), "{holding}");
    assert_eq!(report.held_grid, Some((75, holding as u64)));
    for (name, place) in [("axial_force_N", 0), ("max_stress_MPa", 1), ("stress_margin", 2)] {
        let points: Vec<GridPoint> = designs.iter().map(|it| (it.0.clone(), it.1[place])).collect();
        let found = quantity(&report, name);
        assert_shares(found, &shares(&points, 3));
        let held: Vec<GridPoint> = designs.iter().filter(|it| it.2).map(|it| (it.0.clone(), it.1[place])).collect();
        for (input, truth) in found.inputs.iter().zip(effects_by_orders(&held)) {
            assert_near(input.within.expect("some designs hold").value, truth, &format!("{name} {} where it holds", input.name));
        }
        let mean = held.iter().map(|it| it.1).sum::<f64>() / held.len() as f64;
        assert!((found.within.expect("some hold").mean / mean - 1.0).abs() < 1e-12);
        assert!(found.tornado.is_none(), "that is of one design");
    }
    let points: Vec<GridPoint> = designs.iter().map(|it| (it.0.clone(), f64::from(u8::from(it.2)))).collect();
    assert_shares(quantity(&report, HOLDS), &shares(&points, 3));
    assert!(quantity(&report, HOLDS).within.is_none(), "of designs that hold, all hold");
}

#[test]
#[should_panic(expected = "stress_margin groove_angle_deg Shapley")]
fn a_comparison_with_the_decomposition_notices_a_wrong_share() {
    let points: Vec<GridPoint> = designs_by_brute_force().into_iter().map(|it| (it.0, it.1[2])).collect();
    let mut expected = shares(&points, 3);
    expected[0][2] += 1e-6;
    assert_shares(quantity(&asked(GRID, InfluenceOver::Design, None, &[]), "stress_margin"), &expected);
}

#[test]
#[should_panic(expected = "first")]
fn a_comparison_with_the_decomposition_notices_a_wrong_value() {
    let mut points: Vec<GridPoint> = designs_by_brute_force().into_iter().map(|it| (it.0, it.1[2])).collect();
    points[7].1 += 0.01;
    assert_shares(quantity(&asked(GRID, InfluenceOver::Design, None, &[]), "stress_margin"), &shares(&points, 3));
}

#[test]
fn shares_over_the_uncertainty_of_a_design_are_those_of_the_decomposition() {
    let (design, plan) = (37, Plan::new(study(GRID)));
    let model = &plan.study.model;
    let margin = model.output("stress_margin").expect("the model has it");
    // Scenarios are in file order, the last axis fastest: 6 operating cases outside, 3 frictions and 4 strengths inside.
    let worst = |level: u64| {
        let values = (0..6).map(|case| evaluate(model, &plan.space.inputs(design, case * 12 + level)).outputs[margin].expect("a value"));
        values.fold(f64::INFINITY, f64::min)
    };
    let points: Vec<GridPoint> = (0..12).map(|level| (vec![level / 4, level % 4], worst(level))).collect();
    let report = asked(GRID, InfluenceOver::Uncertainty, Some(design), &["stress_margin"]);
    assert_eq!((report.method, report.scenarios), (InfluenceMethod::Grid { combinations: 12 }, 6));
    let found = quantity(&report, "stress_margin");
    assert_shares(found, &shares(&points, 2));
    let mean = points.iter().map(|it| it.1).sum::<f64>() / 12.0;
    let sd = (points.iter().map(|it| (it.1 - mean).powi(2)).sum::<f64>() / 12.0).sqrt();
    assert!((found.mean.expect("it varies") - mean).abs() < 1e-12 && (found.sd.expect("it varies") - sd).abs() < 1e-12);
    // The tornado: friction is listed as 0.095, 0.065, 0.08, and the middle of four strengths is the second.
    let tornado = found.tornado.as_ref().expect("it is of one design");
    let at = |friction: u64, strength: u64| points[(friction * 4 + strength) as usize].1;
    let ends: Vec<_> = tornado.bars.iter().map(|it| (it.name.as_str(), it.low.as_str(), it.high.as_str())).collect();
    assert_eq!(ends, [("friction", "0.065", "0.095"), ("strength_MPa", "750", "900")]);
    assert_eq!(tornado.middle, Some(at(2, 1)));
    assert_eq!((tornado.bars[0].at_low, tornado.bars[0].at_high), (Some(at(1, 1)), Some(at(0, 1))));
    assert_eq!((tornado.bars[1].at_low, tornado.bars[1].at_high), (Some(at(2, 0)), Some(at(2, 3))));
}

/// The model of a file and a study that draws its inputs.
fn drawn_study(formula: &str, inputs: &[(&str, &str)], more: &str) -> (tempfile::TempDir, Study) {
    let folder = tempfile::tempdir().expect("a temporary directory");
    let declared: String = inputs.iter().map(|(name, _)| format!("{name} = {{ default = 0 }}\n")).collect();
    let model = format!("[inputs]\noffset = {{ default = 0 }}\n{declared}[formulas]\ny = \"{formula} + offset\"\n");
    std::fs::write(folder.path().join("function.toml"), model).expect("it can be written");
    let laws: String = inputs.iter().map(|(name, law)| format!("{name} = {law}\n")).collect();
    let text = format!(
        "model = \"function.toml\"\n[design]\noffset = [0, 1]\n[uncertainty]\n{laws}[probability]\ndraws = 64\nconfirm = 64\n{more}\
         [constraints]\ny = {{ min = -1000 }}\n[objectives]\nyield = \"max\"\ny = {{ goal = \"min\", over_draws = \"mean\" }}\n"
    );
    let study = Study::parse_in(&text, "study.toml", folder.path()).unwrap_or_else(|error| panic!("{error}\n{text}"));
    (folder, study)
}

/// The shares of `y` in design 0.
fn estimated(study: &Study, draws: u64) -> QuantityReport {
    let subject = InfluenceSubject::new(study, InfluenceOver::Uncertainty, Some(0), &[], draws, 1).expect("inputs are uncertain");
    quantity(&subject.report(2).expect("it has a value everywhere"), "y").clone()
}

/// Estimates are within their intervals of 95 %, made half as wide again since many are compared, and the intervals are narrow.
fn assert_estimates(found: &[Option<beltspace::influence::Estimate>], truth: &[f64], widest: f64) {
    assert_eq!(found.len(), truth.len());
    for (found, truth) in found.iter().zip(truth) {
        let found = found.expect("it is estimated");
        let confidence = found.confidence.unwrap_or(0.0);
        assert!(confidence < widest, "{found:?} is not narrow");
        assert!((found.value - truth).abs() <= 1.5 * confidence + 1e-9, "{found:?} in place of {truth}");
    }
}

fn shown(
    found: &QuantityReport,
    share: fn(&beltspace::influence::InputReport) -> Option<beltspace::influence::Estimate>,
) -> Vec<Option<beltspace::influence::Estimate>> {
    found.inputs.iter().map(share).collect()
}

#[test]
fn ishigami_has_the_shares_of_its_closed_form() {
    // Ishigami and Homma (1990), with a = 7 and b = 0.1.
    let (a, b) = (7.0, 0.1);
    let one = 0.5 * (1.0 + b * PI.powi(4) / 5.0).powi(2);
    let (two, both) = (a * a / 8.0, 8.0 * b * b * PI.powi(8) / 225.0);
    let variance = one + two + both;
    let formula = "sin(x1_rad) + 7 * sin(x2_rad) ^ 2 + 0.1 * (x3_rad / 1[rad]) ^ 4 * sin(x1_rad)";
    let law = format!("{{ uniform = [{}, {PI}] }}", -PI);
    let (_folder, study) = drawn_study(formula, &["x1_rad", "x2_rad", "x3_rad"].map(|name| (name, law.as_str())), "");
    let found = estimated(&study, 1 << 13);
    assert_eq!(found.verdict, QuantityVerdict::Shares);
    assert_estimates(&shown(&found, |it| it.first), &[one / variance, two / variance, 0.0], 0.03);
    assert_estimates(&shown(&found, |it| it.total), &[(one + both) / variance, two / variance, both / variance], 0.03);
    assert_estimates(&shown(&found, |it| it.shapley), &[(one + 0.5 * both) / variance, two / variance, 0.5 * both / variance], 0.03);
    let all: f64 = found.inputs.iter().map(|it| it.shapley.expect("it is estimated").value).sum();
    assert!((all - 1.0).abs() < 1e-12, "{all}");
    assert!((found.mean.expect("it varies") - 0.5 * a).abs() < 0.02 && (found.sd.expect("it varies") - variance.sqrt()).abs() < 0.02);
}

#[test]
#[should_panic(expected = "in place of 0.5")]
fn a_comparison_with_a_closed_form_notices_a_wrong_one() {
    let law = "{ normal = { mean = 0, sd = 1 } }";
    let (_folder, study) = drawn_study("x1 + x2 / 2", &[("x1", law), ("x2", law)], "");
    // The truth is 0.8 and 0.2.
    assert_estimates(&shown(&estimated(&study, 1024), |it| it.first), &[0.5, 0.5], 0.2);
}

#[test]
fn correlated_inputs_have_the_shapley_effects_of_the_closed_form_and_no_sobol_indices() {
    // Iooss and Prieur (2019): a sum of three normal numbers, of which the last two have the correlation r.
    let (sd3, r) = (2.0, 0.9);
    let (shared, half) = (r * sd3, 0.5 * r * r);
    let effects = [1.0, 1.0 + shared + half * (sd3 * sd3 - 1.0), sd3 * sd3 + shared + half * (1.0 - sd3 * sd3)];
    let variance: f64 = effects.iter().sum();
    let law = |sd: f64| format!("{{ normal = {{ mean = 0, sd = {sd} }} }}");
    let (own, wide) = (law(1.0), law(sd3));
    let inputs = [("x1", own.as_str()), ("x2", own.as_str()), ("x3", wide.as_str())];
    let (_folder, study) = drawn_study("x1 + x2 + x3", &inputs, "correlation = [[\"x2\", \"x3\", 0.9]]\n");
    let found = estimated(&study, 1 << 12);
    assert_estimates(&shown(&found, |it| it.shapley), &effects.map(|it| it / variance), 0.05);
    assert!(found.inputs.iter().all(|it| it.first.is_none() && it.total.is_none()));
    assert!((found.sd.expect("it varies") - variance.sqrt()).abs() < 0.05);
}

/// A sum of twelve inputs, each as many times as its number says.
fn weighted_sum() -> (String, Vec<String>) {
    let names: Vec<String> = (1..=12).map(|it| format!("x{it}")).collect();
    let formula = names.iter().enumerate().map(|(place, name)| format!("{} * {name}", place + 1)).collect::<Vec<_>>().join(" + ");
    (formula, names)
}

#[test]
fn many_inputs_are_screened_and_share_by_orders() {
    let (formula, names) = weighted_sum();
    let squares: f64 = (1..=12).map(|it| f64::from(it * it)).sum();
    let truth: Vec<f64> = (1..=12).map(|it| f64::from(it * it) / squares).collect();
    let laws: Vec<(&str, &str)> = names.iter().map(|name| (name.as_str(), "{ uniform = [0, 1] }")).collect();
    let (_folder, study) = drawn_study(&formula, &laws, "");
    let subject = InfluenceSubject::new(&study, InfluenceOver::Uncertainty, Some(0), &["y".to_owned()], 64, 1).expect("it is known");
    assert_eq!(subject.work().expect("there are factors").orders, Some(64));
    let report = subject.report(2).expect("it has a value everywhere");
    let found = quantity(&report, "y");
    assert_eq!((report.orders, report.walks), (Some(64), Some(20)));
    assert_estimates(&shown(found, |it| it.shapley), &truth, 0.2);
    for (place, input) in found.inputs.iter().enumerate() {
        let effects = input.screening.as_ref().expect("there are more than ten");
        // From the 5 % to the 95 % quantile of a uniform number lies nine tenths of its range.
        let slope = 0.9 * (place + 1) as f64;
        assert!((effects.mean - slope).abs() < 1e-9 && (effects.mean_absolute - slope).abs() < 1e-9 && effects.sd < 1e-9, "{effects:?}");
    }
    // With levels in place of distributions all 4096 combinations are counted, and in a sum every order says the same.
    let levels: Vec<(&str, &str)> = names.iter().map(|name| (name.as_str(), "[0, 1]")).collect();
    let (_folder, study) = levelled_study(&formula, &levels);
    let report = InfluenceSubject::new(&study, InfluenceOver::Uncertainty, Some(0), &["y".to_owned()], 64, 1).expect("it is known");
    let report = report.report(2).expect("it has a value everywhere");
    assert_eq!(report.method, InfluenceMethod::Grid { combinations: 4096 });
    for (input, truth) in quantity(&report, "y").inputs.iter().zip(&truth) {
        for share in [input.first, input.total, input.shapley] {
            assert_near(share.expect("it is counted").value, *truth, &input.name);
        }
        let slope = (truth * squares).sqrt();
        assert!((input.screening.as_ref().expect("there are more than ten").mean - slope).abs() < 1e-9);
    }
}

/// The same with levels.
fn levelled_study(formula: &str, inputs: &[(&str, &str)]) -> (tempfile::TempDir, Study) {
    let folder = tempfile::tempdir().expect("a temporary directory");
    let declared: String = inputs.iter().map(|(name, _)| format!("{name} = {{ default = 0 }}\n")).collect();
    let model = format!("[inputs]\noffset = {{ default = 0 }}\n{declared}[formulas]\ny = \"{formula} + offset\"\n");
    std::fs::write(folder.path().join("function.toml"), model).expect("it can be written");
    let axes: String = inputs.iter().map(|(name, levels)| format!("{name} = {levels}\n")).collect();
    let text = format!("model = \"function.toml\"\n[design]\noffset = [0, 1]\n[uncertainty]\n{axes}[objectives]\ny = \"min\"\n");
    let study = Study::parse_in(&text, "study.toml", folder.path()).unwrap_or_else(|error| panic!("{error}\n{text}"));
    (folder, study)
}

#[test]
fn a_large_grid_is_drawn_over_its_levels() {
    // 200^3 combinations of x + 2 y + 3 z with 200 levels each: parts of 1, 4 and 9.
    let axis = "{ from = 0, to = 1, count = 200 }";
    let (_folder, study) = levelled_study("x1 + 2 * x2 + 3 * x3", &[("x1", axis), ("x2", axis), ("x3", axis)]);
    let found = estimated(&study, 1 << 12);
    let truth = [1.0, 4.0, 9.0].map(|it| it / 14.0);
    for share in [shown(&found, |it| it.first), shown(&found, |it| it.total), shown(&found, |it| it.shapley)] {
        assert_estimates(&share, &truth, 0.03);
    }
}

#[test]
fn a_draw_that_cannot_be_built_does_not_hold_and_has_no_values() {
    let text = GRID.replace("friction     = [0.095, 0.065, 0.08]", "friction = { uniform = [-0.02, 0.1] }").replace(
        "[objectives]\naxial_force_N = \"min\"",
        "yield = { min = 0.1 }\n[objectives]\naxial_force_N = { goal = \"min\", over_draws = \"mean\" }",
    );
    let text = text.replace("[\"max_stress_MPa\"]", "[{ of = \"max_stress_MPa\", over_draws = \"mean\" }]");
    let report = asked(&text, InfluenceOver::Uncertainty, Some(37), &[HOLDS]);
    let holds = quantity(&report, HOLDS);
    assert_eq!(holds.verdict, QuantityVerdict::Shares);
    assert!(holds.mean.expect("it varies") < 5.0 / 6.0 + 0.01, "a sixth of the frictions is negative");
    let subject = InfluenceSubject::new(&study(&text), InfluenceOver::Uncertainty, Some(37), &["axial_force_N".to_owned()], 64, 1);
    let error = subject.expect("it is known").report(1).expect_err("it has no value in some draws").to_string();
    let said = error.strip_prefix("axial_force_N has no value in ").and_then(|it| it.split_once(" of 256 draws or levels"));
    let (absent, rest) = said.unwrap_or_else(|| panic!("{error}"));
    assert!(absent.parse::<u64>().is_ok_and(|it| (24..64).contains(&it)), "{error}");
    assert_eq!(rest, ", so it has no variance; ask --of holds, or narrow the inputs");
}
