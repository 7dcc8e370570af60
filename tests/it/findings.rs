//! What a result says of studies without a feasible design, of axes that should go on and of quantities that nobody bounded, against brute
//! force over the scalar evaluation.

use beltspace::findings::{Findings, Infeasible};
use beltspace::models::{Status, evaluate};
use beltspace::plan::Plan;
use beltspace::screen::Control;
use beltspace::study::{Constraint, Goal, Objective, Quantity};
use beltspace::{Engine, Judging, Options, Study};

const TOO_MUCH: &str = r#"
    model = "metal-cvt"
    [design]
    band_thickness_mm = { from = 0.10, to = 0.30, count = 21 }
    band_count        = { from = 6, to = 12 }
    groove_angle_deg  = { from = 18, to = 30, count = 13 }
    [operation]
    ratio     = [0.6, 1, 1.7]
    torque_Nm = [50, 150]
    [fixed]
    strength_MPa = 600
    [constraints]
    stress_margin = { min = 0.1 }
    axial_force_N = { max = 20000 }
    [objectives]
    axial_force_N = "min"
"#;

fn findings(study: &Study) -> Findings {
    let plan = Plan::new(study.clone());
    Findings::of(&plan, 0, &[], 2, &Control::default()).expect("nobody stops it")
}

fn infeasible(text: &str) -> (Study, Infeasible) {
    let study = Study::parse(text).unwrap_or_else(|error| panic!("{error}"));
    let found = findings(&study).infeasible.expect("nothing is feasible");
    (study, found)
}

/// Per design: its worst value of each constraint, if it has a result in every scenario.
fn worst_values(study: &Study) -> Vec<Option<Vec<f64>>> {
    let plan = Plan::new(study.clone());
    let of = |design: u64| {
        let mut worst: Vec<Option<f64>> = vec![None; study.constraints.len()];
        for scenario in 0..plan.scenarios() {
            let inputs = plan.space.inputs(design, scenario);
            let evaluation = evaluate(&study.model, &inputs);
            if evaluation.status != Status::Ok {
                return None;
            }
            for (worst, constraint) in worst.iter_mut().zip(&study.constraints) {
                let value = match constraint.quantity {
                    Quantity::Input(input) => inputs[input],
                    Quantity::Output(output) => evaluation.outputs[output]?,
                };
                let is_worse = worst.is_none_or(|held| constraint.margin(value) < constraint.margin(held));
                *worst = Some(if is_worse { value } else { worst.unwrap_or(value) });
            }
        }
        worst.into_iter().collect()
    };
    (0..plan.designs()).map(of).collect()
}

/// The best of some designs by a constraint's margin, of equals the first.
fn best<'a>(constraint: &Constraint, designs: impl Iterator<Item = (u64, &'a Vec<f64>)>, number: usize) -> Option<(u64, f64)> {
    designs
        .map(|(design, worst)| (design, worst[number]))
        .reduce(|held, next| if constraint.margin(next.1) > constraint.margin(held.1) { next } else { held })
}

#[test]
fn what_designs_reach_of_each_constraint_is_that_of_brute_force() {
    let two_sided = TOO_MUCH.replace("{ max = 20000 }", "{ max = 20000, min = 19000 }");
    for text in [TOO_MUCH, &TOO_MUCH.replace("{ min = 0.1 }", "{ min = 5 }"), &two_sided] {
        let (study, found) = infeasible(text);
        let worst = worst_values(&study);
        assert_eq!((found.sampled, found.with_result), (worst.len() as u64, worst.iter().flatten().count() as u64));
        let all = || worst.iter().enumerate().filter_map(|(design, worst)| Some((design as u64, worst.as_ref()?)));
        for (number, (constraint, reach)) in study.constraints.iter().zip(&found.reach).enumerate() {
            let keeps_others = |worst: &Vec<f64>| {
                let mut others = study.constraints.iter().zip(worst).enumerate().filter(|(other, _)| *other != number);
                others.all(|(_, (constraint, &value))| constraint.holds(value))
            };
            for (reached, expected) in [
                (reach.best, best(constraint, all(), number)),
                (reach.first, best(constraint, all().filter(|(_, worst)| keeps_others(worst)), number)),
            ] {
                assert!(reached.is_none_or(|it| it.exact), "{text}: {reached:?}");
                assert_eq!(reached.map(|it| (it.design, it.value)), expected, "{text}");
            }
        }
        let spread = |number: usize| {
            let values = || worst.iter().flatten().map(|it| it[number]);
            values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
        };
        let distance = |worst: &Vec<f64>| -> f64 {
            let each = study.constraints.iter().zip(worst).enumerate();
            each.map(|(number, (it, &value))| if it.holds(value) { 0.0 } else { -it.margin(value) / spread(number) }).sum()
        };
        let nearest = all().map(|(design, worst)| (distance(worst), design)).reduce(|a, b| if b.0 < a.0 { b } else { a });
        assert_eq!(found.nearest.map(|it| it.design), nearest.map(|it| it.1), "{text}");
    }
}

/// What fails most of the designs, but not all, is not told as if no design kept it.
#[test]
fn a_bound_that_some_designs_keep_is_told_so() {
    let apart = TOO_MUCH.replace("min = 0.1", "min = 0.2").replace("max = 20000", "max = 30000");
    let told = |text: &str, name: &str| {
        let study = infeasible(text).0;
        findings(&study).in_words(&study).into_iter().find(|it| it.starts_with(name)).unwrap_or_default()
    };
    for name in ["stress_margin at least 0.2: ", "axial_force_N at most 30000 N: "] {
        let said = told(&apart, name);
        assert!(said.contains(": some designs keep it, but none of them keeps all else; a bound of "), "{said}");
    }
    let said = told(TOO_MUCH, "axial_force_N at most 20000 N: ");
    assert!(said.contains("the best of all designs has") && !said.contains("some designs keep it"), "{said}");
}

#[test]
fn a_bound_in_the_words_lets_the_first_design_through_and_no_tighter_one_does() {
    let (study, found) = infeasible(TOO_MUCH);
    let words = findings(&study).in_words(&study).join("\n");
    let first = found.reach[1].first.expect("some designs keep the other constraint").value;
    let (_, rest) = words.split_once("a bound of ").expect("the words name a bound");
    let bound: f64 = rest.split(' ').next().and_then(|it| it.parse().ok()).expect("it is a number");
    // Above a thousand sentences have whole numbers: the next one.
    assert_eq!(bound, first.ceil());
    let feasible = |bound: f64| {
        let text = TOO_MUCH.replace("max = 20000", &format!("max = {bound}"));
        let study = Study::parse(&text).expect("it is right");
        study.sweep(Options::default()).expect("it runs").counts.feasible
    };
    assert_eq!((feasible(first * 0.999_999), feasible(bound) > 0), (0, true));
}

/// Bounds find what judging every design finds, where that would take long.
#[test]
fn in_a_large_study_bounds_find_the_exact_best() {
    let text = TOO_MUCH.replace("count = 21", "count = 2001").replace("count = 13", "count = 2001");
    let text = text.replace("stress_margin = { min = 0.1 }", "stress_margin = { min = 5 }").replace("axial_force_N = { max = 20000 }", "");
    let (study, found) = infeasible(&text);
    let first = found.reach[0].first.expect("designs have a value");
    assert!(first.exact && found.reach[0].best == Some(first), "{first:?}");
    let quantity = study.constraints[0].quantity;
    let alone = Study {
        constraints: Vec::new(),
        objectives: vec![Objective { quantity, over: Default::default(), goal: Goal::Max, resolution: None }],
        report: beltspace::study::Report { front_budget: 1, ..Default::default() },
        ..study
    };
    let mut options = Options::default();
    (options.judging, options.engine) = (Judging::Exhaustive, Engine::Cpu);
    let front = alone.sweep(options).expect("it runs").front;
    assert_eq!((front.design(0), front.number("stress_margin", 0)), (Some(first.design), Some(first.value)));
    // The sample alone would have said something else, or this shows nothing.
    assert!(found.nearest.is_some_and(|it| it.values[0] < Some(first.value)));
}

#[test]
fn where_no_design_has_a_result_the_one_that_fails_in_the_fewest_scenarios_is_nearest() {
    let text = r#"
        model = "timing-belt"
        [design]
        tight_tension_N = { from = 100, to = 200, count = 11 }
        [operation]
        slack_tension_N = [150, 190, 250]
        [constraints]
        boundary_tension_N = { max = 100 }
        [objectives]
        boundary_tension_N = "min"
    "#;
    let (study, found) = infeasible(text);
    let plan = Plan::new(study.clone());
    let failing = |design: u64| {
        let values = (0..plan.scenarios()).map(|scenario| evaluate(&study.model, &plan.space.inputs(design, scenario)));
        let without = |it: &beltspace::models::Evaluation| it.status != Status::Ok || it.outputs[output(&study)].is_none();
        values.filter(without).count() as u64
    };
    let least = (0..plan.designs()).map(|design| (failing(design), design)).min().expect("there are designs");
    let nearest = found.nearest.expect("there is a sample");
    assert!(least.0 > 0, "a design has results: this shows nothing");
    assert_eq!((nearest.without_result, found.with_result), (least.0, 0));
    assert_eq!(failing(nearest.design), least.0);
    let words = findings(&study).in_words(&study).join("\n");
    assert!(words.contains("no design of the sample of 11 has a result in every scenario"), "{words}");
}

fn output(study: &Study) -> usize {
    study.constraints[0].quantity.output().expect("it is an output")
}

#[test]
fn a_front_on_the_end_of_an_axis_and_a_margin_below_zero_are_told() {
    let text = TOO_MUCH.replace("stress_margin = { min = 0.1 }", "").replace("max = 20000", "max = 1e6");
    let text = text.replace("strength_MPa = 600", "strength_MPa = 350");
    let outcome = Study::parse(&text).expect("it is right").sweep(Options::default()).expect("it runs");
    let said = outcome.summary.findings.join("\n");
    let rows_of_front: Vec<u64> = (0..outcome.front.rows()).filter_map(|row| outcome.front.design(row)).collect();
    let plan = Plan::new(outcome.study.clone());
    let model = &outcome.study.model;
    let number = |name: &str| model.output(name).expect("it is an output");
    let lowest = |design: u64, output: usize| {
        let values = (0..plan.scenarios()).filter_map(|it| evaluate(model, &plan.space.inputs(design, it)).outputs[output]);
        values.fold(f64::INFINITY, f64::min)
    };
    let margins: Vec<f64> = rows_of_front.iter().map(|&design| lowest(design, number("stress_margin"))).collect();
    let below = margins.iter().filter(|it| **it < 0.0).count();
    assert!(below > 0, "the study shows nothing: {margins:?}");
    let expected = format!("stress_margin falls below zero in {below} of {} designs of the front", rows_of_front.len());
    assert!(said.contains(&expected), "{said}");
    let angle = model.input("groove_angle_deg").expect("it is an input");
    let at_end = rows_of_front.iter().filter(|&&design| plan.space.inputs(design, 0)[angle] == 30.0).count();
    assert_eq!(said.contains("upper end of groove_angle_deg, 30 "), 2 * at_end >= rows_of_front.len(), "{said}");
    assert!(2 * at_end >= rows_of_front.len(), "the study shows nothing");
    // With a constraint on it nothing is said of the margin, and an axis with its best in the middle is not named.
    let bounded = Study::parse(&text.replace("[constraints]", "[constraints]\n    stress_margin = { min = -100 }")).expect("it is right");
    let said = bounded.sweep(Options::default()).expect("it runs").summary.findings.join("\n");
    assert!(!said.contains("stress_margin falls"), "{said}");
}
