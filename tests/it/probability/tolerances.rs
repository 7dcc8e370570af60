//! Tolerances that are a part of the model: each study says the same as another that is written without them.

use super::random::parse;
use crate::bounds::ways;
use crate::pipeline::runs::Pipeline;
use beltspace::bounds::{YieldBounds, refusal};
use beltspace::models::{Status, evaluate};
use beltspace::plan::Plan;
use beltspace::probability::Enclosure;
use beltspace::study::Study;
use beltspace::sweep::{Control, Settings};

/// A study in two ways that must give the same.
pub struct TwoWays {
    pub label: &'static str,
    head: &'static str,
    tail: &'static str,
    /// What only one of them has, as lines behind the head.
    ways: [&'static str; 2],
    /// A piece of the first and what stands there in a study that gives something else.
    other: (&'static str, &'static str),
}

impl TwoWays {
    pub fn texts(&self) -> [String; 2] {
        self.ways.map(|way| format!("{}{way}\n{}", self.head, self.tail))
    }

    /// One that is not the same as the second.
    pub fn another(&self) -> String {
        let (piece, with) = self.other;
        let text = &self.texts()[0];
        assert_eq!(text.matches(piece).count(), 1, "{}: {piece}", self.label);
        text.replace(piece, with)
    }
}

/// Levels of a tolerance, and the same as an axis of a factor or an addend in a formula.
pub static LEVELS: [TwoWays; 4] = [
    TwoWays {
        label: "a factor on a design axis",
        head: "model = \"metal-cvt\"\n[operation]\nratio = [0.5, 1, 2]\n",
        tail: "[constraints]\nslip_margin = { min = 0 }\nstress_margin = { min = 0 }\nclamping_force_N = { max = 40000 }\n\
               [objectives]\naxial_force_N = \"min\"\nstress_margin = \"max\"\nband_count = \"min\"\n[fixed]\nstrength_MPa = 800\n",
        ways: [
            "[design]\nclamping_force_N = { from = 12000, to = 40000, count = 29 }\nband_count = { from = 6, to = 14 }\n\
             band_thickness_mm = { from = 0.1, to = 0.2, count = 11 }\n\
             [uncertainty]\nclamping_force_N = { times = [0.85, 1, 1.15] }\nfriction = [0.075, 0.085]",
            "[design]\nasked_N = { from = 12000, to = 40000, count = 29 }\nband_count = { from = 6, to = 14 }\n\
             band_thickness_mm = { from = 0.1, to = 0.2, count = 11 }\n\
             [formulas]\nclamping_force_N = \"asked_N * share\"\n[uncertainty]\nshare = [0.85, 1, 1.15]\nfriction = [0.075, 0.085]",
        ],
        other: ("[0.85, 1, 1.15]", "[0.85, 1, 1.05]"),
    },
    TwoWays {
        label: "an addend on what a formula gives, as a range",
        head: "model = \"metal-cvt\"\n[operation]\nratio = [0.5, 2]\ntorque_Nm = [60, 90]\n",
        tail: "[fixed]\ntraction = 0.35\nstrength_MPa = 700\n[constraints]\nslip_margin = { min = 0 }\nstress_margin = { min = 0 }\n\
               [objectives]\naxial_force_N = \"min\"\nstress_margin = \"max\"\npair_mm = \"min\"\nband_count = \"min\"\n",
        ways: [
            "[design]\npair_mm = { from = 0.2, to = 0.5, count = 21 }\nband_count = { from = 4, to = 16 }\n\
             [formulas]\nband_thickness_mm = \"pair_mm / 2\"\n\
             [uncertainty]\nband_thickness_mm = { plus = { from = -0.02, to = 0.02, count = 3 } }",
            "[design]\npair_mm = { from = 0.2, to = 0.5, count = 21 }\nband_count = { from = 4, to = 16 }\n\
             [formulas]\nband_thickness_mm = \"pair_mm / 2 + error_mm\"\n\
             [uncertainty]\nerror_mm = { from = -0.02, to = 0.02, count = 3 }",
        ],
        other: ("from = -0.02", "from = -0.03"),
    },
    TwoWays {
        label: "what the design says and what is built in formulas",
        head: "model = \"rubber-cvt\"\n[operation]\nratio = [0.6, 1.8]\n",
        tail: "[constraints]\nslip_margin = { min = 0 }\n[objectives]\nstress_margin = \"max\"\ndrawn_mm = \"min\"\nwaste_mm = \"min\"\n",
        ways: [
            "[design]\nbelt_width_mm = { from = 30, to = 60, count = 31 }\nbelt_thickness_mm = [8, 10, 12]\n\
             [formulas]\ndrawn_mm = \"nominal(belt_width_mm)\"\nwaste_mm = \"hypot(belt_width_mm - nominal(belt_width_mm), belt_width_mm)\"\n\
             [uncertainty]\nbelt_width_mm = { times = [0.95, 1, 1.02] }",
            "[design]\nasked_mm = { from = 30, to = 60, count = 31 }\nbelt_thickness_mm = [8, 10, 12]\n\
             [formulas]\nbelt_width_mm = \"asked_mm * share\"\ndrawn_mm = \"asked_mm\"\n\
             waste_mm = \"hypot(belt_width_mm - asked_mm, belt_width_mm)\"\n[uncertainty]\nshare = [0.95, 1, 1.02]",
        ],
        other: ("drawn_mm = \"nominal(belt_width_mm)\"", "drawn_mm = \"belt_width_mm\""),
    },
    TwoWays {
        label: "a tolerance of what only formulas read",
        head: "model = \"pulley-load\"\n[operation]\npower_kW = [2, 4]\n",
        tail: "[constraints]\nfriction_margin = { min = 0 }\n[objectives]\nresultant_force_N = \"min\"\nlength_mm = \"min\"\n",
        ways: [
            "[design]\nslack_tension_N = { from = 200, to = 1000, count = 81 }\nspan_mm = { from = 50, to = 70, count = 5 }\n\
             [formulas]\nmean_radius_mm = \"span_mm\"\nlength_mm = \"2 * nominal(span_mm) + span_mm\"\n\
             [uncertainty]\nspan_mm = { plus = [-0.5, 0, 0.5] }",
            "[design]\nslack_tension_N = { from = 200, to = 1000, count = 81 }\nasked_mm = { from = 50, to = 70, count = 5 }\n\
             [formulas]\nmean_radius_mm = \"asked_mm + error_mm\"\nlength_mm = \"2 * asked_mm + mean_radius_mm\"\n\
             [uncertainty]\nerror_mm = [-0.5, 0, 0.5]",
        ],
        other: ("[-0.5, 0, 0.5]", "[-0.5, 0, 0.6]"),
    },
];

/// Distributions of tolerances of what formulas give, and the same as tolerances of what the design sets, which the draws themselves take.
pub static DRAWN: [TwoWays; 2] = [
    TwoWays {
        label: "drawn factors and addends",
        head: "model = \"metal-cvt\"\nunits = [\"EUR\"]\n[operation]\nratio = [0.5, 2]\ntorque_Nm = [60, 90]\n",
        tail: "[fixed]\nstrength_MPa = 700\n[probability]\ndraws = 60\nconfirm = 500\n[constraints]\nslip_margin = { min = 0 }\n\
               stress_margin = { min = 0, yield = 0.5 }\nyield = { min = 0.1 }\n\
               [objectives]\naxial_force_N = { goal = \"min\", over_draws = \"mean\" }\nyield = \"max\"\nband_count = \"min\"\nstress_margin = { goal = \"max\", over_draws = \"worst\" }\n",
        ways: [
            "[design]\nasked_N = { from = 16000, to = 40000, count = 25 }\npair_mm = [0.2, 0.3, 0.4]\nband_count = { from = 6, to = 14 }\n\
             [formulas]\nclamping_force_N = \"asked_N\"\nband_thickness_mm = \"pair_mm / 2\"\n\
             [uncertainty]\nclamping_force_N = { times = { uniform = [0.85, 1.15] } }\n\
             band_thickness_mm = { plus = { uniform = [-0.11, 0.01] } }\nfriction = [0.075, 0.085]",
            "[design]\nclamping_force_N = { from = 16000, to = 40000, count = 25 }\nband_thickness_mm = [0.1, 0.15, 0.2]\n\
             band_count = { from = 6, to = 14 }\n\
             [uncertainty]\nclamping_force_N = { times = { uniform = [0.85, 1.15] } }\n\
             band_thickness_mm = { plus = { uniform = [-0.11, 0.01] } }\nfriction = [0.075, 0.085]",
        ],
        other: ("\"asked_N\"", "\"1.1 * asked_N\""),
    },
    TwoWays {
        label: "a cost of what stands on the drawing",
        head: "model = \"metal-cvt\"\nunits = [\"EUR\"]\n[operation]\nratio = [0.5, 2]\n",
        tail: "[probability]\ndraws = 64\nconfirm = 500\nmethod = \"latin-hypercube\"\nseed = 4\n[constraints]\nslip_margin = { min = 0 }\n\
               cost_EUR = { max = 36 }\n\
               [objectives]\ncost_EUR = \"min\"\nyield = \"max\"\naxial_force_N = { goal = \"min\", over_draws = \"mean\" }\n",
        ways: [
            "[design]\nclamping_force_N = { from = 16000, to = 40000, count = 25 }\n\
             [formulas]\ncost_EUR = \"0.001[EUR/N] * nominal(clamping_force_N)\"\n\
             [uncertainty]\nclamping_force_N = { times = { uniform = [0.85, 1.15] } }\nfriction = { normal = { mean = 0.08, sd = 0.004 } }",
            "[design]\nasked_N = { from = 16000, to = 40000, count = 25 }\n\
             [formulas]\nclamping_force_N = \"asked_N\"\ncost_EUR = \"0.001[EUR/N] * asked_N\"\n\
             [uncertainty]\nclamping_force_N = { times = { uniform = [0.85, 1.15] } }\nfriction = { normal = { mean = 0.08, sd = 0.004 } }",
        ],
        other: ("seed = 4", "seed = 5"),
    },
];

/// The first thing in which the results of two studies differ, as a sweep finds them and of single designs.
fn difference(a: &str, b: &str) -> Option<String> {
    let [a, b] = [a, b].map(|text| {
        let plan = Plan::new(parse(text));
        let swept = ways::one_by_one(&Pipeline::new(&plan, text), &Settings::default(), None, &Control::default());
        (swept.expect("the sweep ends").state, plan)
    });
    assert!(a.0.feasible > 0, "nothing is feasible");
    // Outputs that are objectives, and whether the status is ok.
    let all = |plan: &Plan| -> Vec<(bool, Vec<Option<f64>>)> {
        let Study { model, objectives, .. } = &plan.study;
        let at = |design: u64, scenario: u64| {
            let it = evaluate(model, &plan.space.inputs(design, scenario));
            (it.status == Status::Ok, objectives.iter().filter_map(|o| Some(it.outputs[o.quantity.output()?])).collect())
        };
        let scenarios = plan.scenarios();
        (0..plan.designs()).step_by(7).flat_map(|design| (0..scenarios).map(move |scenario| at(design, scenario))).collect()
    };
    ways::difference(&a.0, &b.0).or_else(|| (all(&a.1) != all(&b.1)).then(|| "single designs differ".to_owned()))
}

#[test]
fn tolerances_say_the_same_as_studies_without_them() {
    for pair in LEVELS.iter().chain(&DRAWN) {
        let [a, b] = pair.texts();
        assert_eq!(difference(&a, &b), None, "{}", pair.label);
        assert!(difference(&pair.another(), &b).is_some(), "{}: the checker sees nothing", pair.label);
    }
}

#[test]
fn bounds_serve_levels_of_tolerances() {
    for pair in &LEVELS {
        let [a, b] = pair.texts();
        let of = |text: &str| {
            let plan = Plan::new(parse(text));
            assert_eq!(refusal(&plan), None, "{}", pair.label);
            ways::whole(&Pipeline::new(&plan, text), 2).unwrap_or_else(|problem| panic!("{}: {problem}", pair.label)).0
        };
        let plan = Plan::new(parse(&b));
        let judged = ways::one_by_one(&Pipeline::new(&plan, &b), &Settings::default(), None, &Control::default()).expect("it ends").state;
        assert_eq!(ways::difference(&judged, &of(&a)), None, "{}", pair.label);
        assert!(ways::difference(&judged, &of(&pair.another())).is_some(), "{}: the checker sees nothing", pair.label);
    }
}

#[test]
fn what_is_described_is_the_same_study() {
    for text in LEVELS.iter().chain(&DRAWN).flat_map(TwoWays::texts) {
        let study = parse(&text);
        let again = Study::from_description(&study.describe()).unwrap_or_else(|problem| panic!("{problem}\n{text}"));
        assert_eq!(again.describe(), study.describe());
        assert_eq!(again.probability.map(|it| it.inputs.clone()), study.probability.map(|it| it.inputs.clone()));
    }
}

/// The first of the drawn studies for one drive: factor and addend stand in its formulas.
const ONE_DRIVE: &str = "model = \"metal-cvt\"\n\
    [design]\nasked_N = { from = 16000, to = 40000, count = 25 }\npair_mm = [0.2, 0.3, 0.4]\nband_count = { from = 6, to = 14 }\n\
    [operation]\nratio = [0.5, 2]\ntorque_Nm = [60, 90]\n[uncertainty]\nfriction = [0.075, 0.085]\n\
    [fixed]\nstrength_MPa = 700\nshare = 1\nerror_mm = 0\n\
    [formulas]\nclamping_force_N = \"asked_N * share\"\nband_thickness_mm = \"pair_mm / 2 + error_mm\"\n\
    [objectives]\naxial_force_N = \"min\"\n";

#[test]
fn every_draw_is_a_drive_with_a_factor_in_its_formula() {
    let plan = Plan::new(parse(&DRAWN[0].texts()[0]));
    let hand = Plan::new(parse(ONE_DRIVE));
    let probability = plan.study.probability.as_deref().expect("it has distributions");
    let columns = probability.choosing().expect("they can be drawn").columns(0..probability.draws);
    let number = |name: &str| hand.study.model.input(name).expect("it is an input");
    let [share, error] = ["share", "error_mm"].map(number);
    let [slip, stress, force] =
        ["slip_margin", "stress_margin", "axial_force_N"].map(|name| hand.study.model.output(name).expect("it is an output"));
    let of = |name: &str| plan.study.model.output(name).expect("it is asked for");
    let (mut several, mut broken) = (0, 0);
    for design in (0..plan.designs()).step_by(11) {
        // Operating cases are outside, levels of the friction inside.
        for level in 0..2 {
            let (mut kept, mut stressed, mut forces) = (0, 0, Vec::new());
            for (&factor, &addend) in columns[0].iter().zip(&columns[1]) {
                let cases: Vec<_> = (0..4)
                    .map(|case| {
                        let mut inputs = hand.space.inputs(design, 2 * case + level);
                        (inputs[share], inputs[error]) = (factor, addend);
                        evaluate(&hand.study.model, &inputs)
                    })
                    .collect();
                broken += cases.iter().filter(|it| it.status.reason(&hand.study.model).contains("out of range")).count();
                let margin = |output: usize| cases.iter().all(|it| it.outputs[output].is_some_and(|value| value >= 0.0));
                kept += u32::from(cases.iter().all(|it| it.status == Status::Ok) && margin(slip));
                stressed += u32::from(margin(stress));
                forces.push(
                    cases.iter().map(|it| it.outputs[force]).collect::<Option<Vec<f64>>>().map(|it| it.into_iter().fold(0.0, f64::max)),
                );
            }
            let told = evaluate(&plan.study.model, &plan.space.inputs(design, level)).outputs;
            let share_of = |count: u32| Some(f64::from(count) / columns[0].len() as f64);
            assert_eq!(told[of("yield_screened")], share_of(kept), "design {design}");
            assert_eq!(told[of("stress_margin_yield")], share_of(stressed), "design {design}");
            let forces: Option<Vec<f64>> = forces.into_iter().collect();
            let mean = forces.map(|it| it.iter().sum::<f64>() / it.len() as f64);
            match (told[of("axial_force_N_draw_mean")], mean) {
                (Some(told), Some(mean)) => assert!((told / mean - 1.0).abs() < 1e-13, "design {design}: {told} and {mean}"),
                (told, mean) => assert_eq!(told, mean, "design {design}"),
            }
            several += u32::from(kept > 0 && f64::from(kept) < columns[0].len() as f64);
        }
    }
    assert!(several > 20 && broken > 100, "{several} designs are between none and all, {broken} drives cannot be built");
}

#[test]
fn proven_bounds_of_yields_are_about_the_same_drives() {
    let [a, b] = DRAWN[0].texts();
    let bounds = [a, b, DRAWN[0].another()].map(|text| YieldBounds::new(&parse(&text)).expect("bounds can be proven"));
    let (mut told, mut differ) = (0, 0);
    for design in (0..675).step_by(61) {
        let [a, b, other] = bounds.each_ref().map(|it| it.of(design, 0.01, 200_000).expect("bounds are found"));
        let apart = |a: &Enclosure, b: &Enclosure| a.at_least > b.at_most || b.at_least > a.at_most;
        assert!(!apart(&a, &b) && a.width() <= 0.01, "design {design}: {a:?} and {b:?}");
        told += u32::from(a.at_least > 0.0 && a.at_most < 1.0);
        differ += u32::from(apart(&a, &other));
    }
    assert!(told > 2 && differ > 2, "{told} bounds tell something, {differ} of another study differ");
}

#[test]
fn mistakes_in_formulas_are_told_of_the_input_that_they_give() {
    for (formulas, told) in [
        ("band_width_mm = \"nominal(band_width_mm)\"", "4:18: formula \"band_width_mm\": band_width_mm reads itself"),
        ("band_width_mm = \"2 * band_width_mm\"", "4:22: formula \"band_width_mm\": band_width_mm reads itself"),
        (
            "band_width_mm = \"width_mm\"\nwidth_mm = \"band_width_mm\"",
            "4:18: formula \"band_width_mm\": these formulas read each other in a circle: band_width_mm -> width_mm -> band_width_mm",
        ),
        (
            "band_width_mm = \"optimum_thickness_mm\"",
            "4:18: formula \"band_width_mm\": band_width_mm is an input of the model, so it cannot depend on optimum_thickness_mm, which is \
             an output: the model is evaluated once",
        ),
        ("band_width_mm = \"9[N]\"", "4:18: formula \"band_width_mm\": the formula gives a force, but band_width_mm is a length"),
    ] {
        for tolerance in ["[0.9, 1.1]", "{ uniform = [0.9, 1.1] }"] {
            let text = format!(
                "model = \"metal-cvt\"\ndesign = {{ band_count = [8, 9] }}\n[formulas]\n{formulas}\n\
                 [uncertainty]\nband_width_mm = {{ times = {tolerance} }}\n[objectives]\naxial_force_N = \"min\"\n"
            );
            let errors = Study::parse_in(&text, "s.toml", ".".as_ref()).expect_err("it is wrong").to_string();
            assert_eq!(errors, format!("s.toml:{told}"));
        }
    }
}

#[test]
fn a_value_without_a_meaning_is_told_of_the_input() {
    let text = "model = \"metal-cvt\"\n[design]\nasked_mm = [0, 9]\n[formulas]\nband_width_mm = \"81[mm^2] / asked_mm\"\n\
                [uncertainty]\nband_width_mm = { times = [-1, 1] }\n[objectives]\naxial_force_N = \"min\"\n";
    let plan = Plan::new(parse(text));
    let model = &plan.study.model;
    let reason = |design: u64, scenario: u64| evaluate(model, &plan.space.inputs(design, scenario)).status.reason(model).to_owned();
    assert_eq!(reason(0, 1), "formula band_width_mm: division by zero");
    assert_eq!(reason(1, 0), "input band_width_mm out of range");
    assert_eq!(reason(1, 1), "ok");
}

#[test]
fn a_set_value_is_what_the_design_says() {
    let file = |text: &str| {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let path = folder.path().join("study.toml");
        std::fs::write(&path, text).expect("it is written");
        let set = Study::read_set(&path, &["clamping_force_N=30000".to_owned()]).unwrap_or_else(|error| panic!("{error}")).0;
        let what_if = Study::read_what_if(&path, &["clamping_force_N=30000".to_owned()]).unwrap_or_else(|error| panic!("{error}"));
        [set, what_if]
    };
    for study in file(&LEVELS[0].texts()[0]) {
        assert_eq!(study.uncertainty.iter().map(|axis| axis.count()).collect::<Vec<_>>(), [3, 2]);
        let plan = Plan::new(study);
        let model = &plan.study.model;
        let built = model.output("clamping_force_N_built").expect("it is an output");
        let forces: Vec<_> = (0..6).map(|scenario| evaluate(model, &plan.space.inputs(0, scenario)).outputs[built]).collect();
        assert_eq!(forces, [25500.0, 25500.0, 30000.0, 30000.0, 34500.0, 34500.0].map(Some));
    }
    for study in file(&DRAWN[0].texts()[1]) {
        let probability = study.probability.expect("it has distributions");
        assert!(probability.inputs.iter().any(|it| it.name == "clamping_force_N" && !it.in_model));
    }
}

#[test]
fn a_tolerance_is_about_what_a_preset_of_the_design_says() {
    for (tolerance, more) in [("times = [0.9, 1.1]", ""), ("times = { uniform = [0.9, 1.1] }", "[probability]\ndraws = 16\nconfirm = 1\n")]
    {
        let text = format!(
            "model = \"timing-belt\"\n[design]\npreset = [\"ohc-driven\", \"car-belt\"]\n{more}[uncertainty]\ntip_radius_mm = {{ {tolerance} }}\n\
             [constraints]\nboundary_tooth = {{ min = 5 }}\n[objectives]\n{} = \"max\"\n",
            if more.is_empty() { "boundary_tooth" } else { "yield" }
        );
        let plan = Plan::new(parse(&text));
        let radius = plan.study.model.input("tip_radius_mm").expect("it is an input");
        assert_eq!([0, 1].map(|design| plan.space.inputs(design, 0)[radius]), [66.32, 66.02], "{text}");
        // A word has no tolerance, also if a preset says it.
        let error = Study::parse_in(&text.replace("tip_radius_mm", "pitch_mass_g"), "s.toml", ".".as_ref()).expect_err("it is wrong");
        assert!(error.to_string().contains("its value may be the word \"from-belt\", which has no tolerance"), "{error}");
    }
}
