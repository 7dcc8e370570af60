//! Studies with formulas, by brute force and by every engine.
//!
//! The second implementation of each formula is a closure in Rust, in other words than the formula, around the model as it stands.

mod broken_models;
mod files;
mod random;
mod same;
mod settled;

use beltspace::models::{Model, Status, evaluate, find};
use beltspace::plan::Plan;
use beltspace::study::Goal;
use beltspace::{Data, Engine, Judging, Options, Outcome, Study};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// A study whose model and curves stand in `models`.
fn parsed(text: &str) -> Study {
    Study::parse_in(text, "study.toml", "tests/it/formulas/models".as_ref()).unwrap_or_else(|error| panic!("{error}"))
}

/// Numbers by name.
type Numbers = BTreeMap<String, f64>;

/// A study with formulas and what they mean.
struct Case {
    study: &'static str,
    /// What formulas give to the model, from all inputs and variables; `None` if there is a formula without a value.
    before: fn(&mut Numbers) -> Option<()>,
    /// What formulas make of all of that and of the model's outputs, which may be absent.
    after: fn(&mut Numbers) -> Option<()>,
}

const CASES: [Case; 3] = [
    Case {
        study: include_str!("cost.toml"),
        before: |it| {
            let volume = 2.0 * it["band_count"] * it["band_width_mm"] * it["band_thickness_mm"] * 700.0;
            let mass = volume * 7850e-9;
            it.insert("belt_mass_kg".to_owned(), mass);
            it.insert("cost_EUR".to_owned(), it["belt_price_EUR_per_kg"] * mass + 0.8 * it["band_count"]);
            Some(())
        },
        after: |it| {
            it.insert("force_per_mass_N_per_kg".to_owned(), it["axial_force_N"] / it["belt_mass_kg"]);
            Some(())
        },
    },
    Case {
        study: include_str!("camshaft.toml"),
        before: |it| {
            let radius = it["pulley_teeth"] * 9.525 / (2.0 * PI) - 0.686;
            it.insert("tip_radius_mm".to_owned(), radius);
            it.insert("teeth_in_mesh".to_owned(), (it["pulley_teeth"] / 2.0).floor());
            let slack = it["tight_tension_N"] - 3000.0 / radius;
            it.insert("slack_tension_N".to_owned(), slack);
            (slack >= 0.0).then_some(())
        },
        after: |it| {
            let share = it.get("boundary_tension_N").copied().unwrap_or(0.0) / it["tight_tension_N"];
            it.insert("boundary_share".to_owned(), share);
            let peak = it.get("peak_tooth_load_N").copied();
            let rest = it["tight_tension_N"] / 100.0 - 1.6;
            let grade = match peak {
                Some(peak) if peak > 100.0 => peak / 100.0,
                Some(_) if rest >= 0.0 => rest.sqrt(),
                Some(_) => return None,
                None => f64::NAN,
            };
            it.insert("load_grade".to_owned(), grade);
            Some(())
        },
    },
    Case {
        study: include_str!("measured.toml"),
        before: |it| {
            let speed = it["driver_speed_rpm"] * 2.0 * PI / 60.0 * 0.06;
            it.insert("band_speed_m_per_s".to_owned(), speed);
            let points = [(0.0, 0.10), (5.0, 0.09), (20.0, 0.07), (35.0, 0.06)];
            let segment = points.windows(2).find(|pair| pair[0].0 <= speed && speed <= pair[1].0)?;
            let [from, to] = [segment[0], segment[1]];
            let measured = from.1 + (speed - from.0) / (to.0 - from.0) * (to.1 - from.1);
            it.insert("friction".to_owned(), measured * (it["band_count"] / 4.0).tanh());
            Some(())
        },
        after: |it| {
            it.insert("life".to_owned(), (500.0 / it["max_stress_MPa"]).powf(3.5));
            Some(())
        },
    },
];

impl Case {
    fn study(&self) -> Study {
        Study::parse_in(self.study, "study.toml", "tests/it/formulas".as_ref()).unwrap_or_else(|error| panic!("{error}"))
    }

    /// Everything that has a value in a design and scenario; `None` if the status is not ok.
    fn evaluated(&self, base: &Model, study: &Study, inputs: &[f64]) -> Option<Numbers> {
        let mut numbers: Numbers = study.model.inputs.iter().zip(inputs).map(|(input, &value)| (input.name.clone(), value)).collect();
        (self.before)(&mut numbers)?;
        let of_base: Vec<f64> = base.inputs.iter().map(|input| numbers[&input.name]).collect();
        if base.inputs.iter().zip(&of_base).any(|(input, &value)| input.word_for(value).is_none() && !input.valid.contains(value)) {
            return None;
        }
        let evaluation = evaluate(base, &of_base);
        for (output, value) in base.outputs.iter().zip(&evaluation.outputs) {
            if let Some(value) = value {
                numbers.insert(output.name.clone(), *value);
            }
        }
        (self.after)(&mut numbers)?;
        (evaluation.status == Status::Ok).then_some(numbers)
    }

    /// Feasible designs and the worst value of each objective, by brute force.
    fn feasible(&self) -> Vec<(u64, Vec<f64>)> {
        let study = self.study();
        let base = find(study.model.name.as_str()).expect("it is a model");
        let plan = Plan::new(study.clone());
        let mut found = Vec::new();
        for design in 0..plan.designs() {
            let scenarios: Option<Vec<Numbers>> =
                (0..plan.scenarios()).map(|scenario| self.evaluated(&base, &study, &plan.space.inputs(design, scenario))).collect();
            let Some(scenarios) = scenarios else { continue };
            let holds = study.constraints.iter().all(|constraint| {
                let name = constraint.quantity.name(&study.model);
                scenarios.iter().all(|numbers| numbers.get(name).is_some_and(|&value| constraint.holds(value)))
            });
            let worst = study.objectives.iter().map(|objective| {
                let values =
                    scenarios.iter().map(|numbers| numbers.get(objective.quantity.name(&study.model)).copied().unwrap_or(f64::NAN));
                values.reduce(|a, b| {
                    if a.is_nan() || b.is_nan() {
                        f64::NAN
                    } else if objective.goal == Goal::Min {
                        a.max(b)
                    } else {
                        a.min(b)
                    }
                })
            });
            let worst: Vec<f64> = worst.map(|it| it.expect("there is a scenario")).collect();
            if holds && worst.iter().all(|value| value.is_finite()) {
                found.push((design, worst));
            }
        }
        found
    }
}

/// The designs that no other beats, in the order of their indices; of equal ones the first. Values that differ by rounding only are equal.
fn front(study: &Study, feasible: &[(u64, Vec<f64>)]) -> Vec<u64> {
    let beats = |(a_design, a): &(u64, Vec<f64>), (b_design, b): &(u64, Vec<f64>)| {
        let signs = study.objectives.iter().zip(a).zip(b).map(|((objective, a), b)| {
            let near = (a - b).abs() <= 1e-12 * a.abs().max(b.abs());
            let less = if objective.goal == Goal::Min { a < b } else { a > b };
            if near {
                0
            } else if less {
                -1
            } else {
                1
            }
        });
        let signs: Vec<i32> = signs.collect();
        signs.iter().all(|&sign| sign <= 0) && (signs.contains(&-1) || a_design < b_design)
    };
    feasible.iter().filter(|it| !feasible.iter().any(|other| beats(other, it))).map(|(design, _)| *design).collect()
}

/// Indices of the front of an outcome, and each objective's values there.
fn told(outcome: &Outcome) -> BTreeMap<u64, Vec<f64>> {
    let table = &outcome.front;
    let number = |name: &str, row: usize| match &table.column(name).expect("the front has it").data {
        Data::Number(values) => values[row].expect("it has a value"),
        Data::Whole(values) => values[row].expect("it has a value") as f64,
        Data::Text(_) => panic!("{name} is text"),
    };
    let names: Vec<&str> = outcome.study.objectives.iter().map(|it| it.quantity.name(&outcome.study.model)).collect();
    (0..table.rows()).map(|row| (number("design_index", row) as u64, names.iter().map(|name| number(name, row)).collect())).collect()
}

#[test]
fn fronts_with_formulas_are_those_of_brute_force_on_every_engine_and_by_every_method() {
    for case in &CASES {
        let study = case.study();
        let title = &study.title;
        let feasible = case.feasible();
        let expected = front(&study, &feasible);
        assert!(feasible.len() > 50 && !expected.is_empty(), "{title}: {} feasible designs", feasible.len());
        let options = Options::default().engine(Engine::Cpu);
        let every = study.sweep(options.clone().judging(Judging::Exhaustive)).expect("it is swept");
        assert!(every.counts.feasible < every.counts.designs, "{title}: something must fail");
        assert_eq!(every.counts.feasible, feasible.len() as u64, "{title}");
        let found = told(&every);
        assert_eq!(found.keys().copied().collect::<Vec<_>>(), expected, "{title}");
        let worst: BTreeMap<u64, &Vec<f64>> = feasible.iter().map(|(design, values)| (*design, values)).collect();
        for (design, values) in &found {
            for (value, expected) in values.iter().zip(worst[design]) {
                assert!((value - expected).abs() <= 1e-9 * expected.abs(), "{title}: design {design} has {value}, not {expected}");
            }
        }
        let bounds = study.sweep(options.clone().judging(Judging::Bounds)).expect("bounds serve it");
        let alone = study.sweep(options.judging(Judging::Exhaustive).threads(1)).expect("it is swept");
        let adapter = beltspace::gpu::adapters().into_iter().next().expect("the tests have an adapter").name;
        let on_gpu = Options::default().engine(Engine::Gpu).adapter(adapter).judging(Judging::Exhaustive);
        let on_gpu = study.sweep(on_gpu).expect("it is swept");
        for other in [&bounds, &alone, &on_gpu] {
            assert_eq!(other.front.csv(), every.front.csv(), "{title}: {}", other.course.why);
            assert_eq!(other.counts, every.counts, "{title}");
        }
    }
}

/// Both ends of a valid range have the same status: a design counts once, whichever end it leaves. (Found by random study 194.)
#[test]
fn an_input_out_of_range_is_counted_at_either_end() {
    let text = "model = \"timing-belt\"\n[design]\ntight_tension_N = [50, 110, 300]\n[operation]\nshare = [1, 30]\n\
                [formulas]\nteeth_in_mesh = \"round(share * tight_tension_N / 50[N])\"\n[objectives]\neffective_tension_N = \"max\"\n";
    let study = Study::parse_in(text, "study.toml", ".".as_ref()).unwrap_or_else(|error| panic!("{error}"));
    let outcome = study.sweep(Options::default().engine(Engine::Cpu)).expect("it is swept");
    let limits: Vec<_> = outcome.summary.limits.iter().filter(|it| it.what == "input teeth_in_mesh out of range").collect();
    // 1 and 30 teeth, 2 and 66, 6 and 180.
    assert_eq!(limits.iter().map(|it| it.designs).collect::<Vec<_>>(), [3]);
}

#[test]
fn the_checker_notices_another_formula() {
    let wrong = Case {
        after: |it| it.insert("life".to_owned(), (500.0 / it["max_stress_MPa"]).powf(-3.5)).map(|_| ()).or(Some(())),
        ..copied(&CASES[2])
    };
    let study = wrong.study();
    let every = study.sweep(Options::default().engine(Engine::Cpu)).expect("it is swept");
    assert_ne!(told(&every).keys().copied().collect::<Vec<_>>(), front(&study, &wrong.feasible()));
}

fn copied(case: &Case) -> Case {
    Case { study: case.study, before: case.before, after: case.after }
}
