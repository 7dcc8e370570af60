//! The recorded formula in f32 with error bounds, compared with f64.

use super::boxes::run_over;
use super::{meaningful_si, si};
use crate::physics::{Region, draw};
use crate::random::Random;
use beltspace::decision::Decision;
use beltspace::models::{self, Model, Status, evaluate, find};
use beltspace::tape::RunningError;
use std::sync::Arc;

const DESIGNS: usize = 20_000;

/// The models with a GPU implementation.
fn on_a_device() -> impl Iterator<Item = &'static Arc<Model>> {
    models::all().iter().filter(|model| model.on_gpu)
}

/// A design in f32 arithmetic: is its status ok, and each output with its error bound in SI units.
fn decided(model: &Model, inputs: &[f64]) -> (Decision, Vec<RunningError>) {
    let (outputs, margins) = run_over(model, &si(model, inputs).into_iter().map(RunningError::input).collect::<Vec<_>>());
    let decision = |number: usize| {
        let RunningError { value, bound } = margins[number];
        let value = f64::from(value);
        if model.conditions[number].strict { Decision::above_zero(value, bound) } else { Decision::at_least_zero(value, bound) }
    };
    let counts = |number: &usize| !model.conditions[*number].quiet;
    ((0..model.conditions.len()).filter(counts).fold(Decision::Yes, |all, number| all.and(decision(number))), outputs)
}

/// What the bounds of many designs look like.
#[derive(Default)]
struct Bounds {
    checked: usize,
    /// Values farther from f64 than their bound: how many, and the first.
    broken: usize,
    example: String,
    infinite: usize,
    /// Per output: bounds relative to the value.
    relative: Vec<Vec<f64>>,
    /// Largest share of a bound that was used.
    used: f64,
}

/// Compares f32 values with f64 ones, with every bound divided by `shrink`.
fn compare(model: &Model, region: Region, shrink: f64) -> Bounds {
    let random = &mut Random::new(12);
    let mut found = Bounds { relative: vec![Vec::new(); model.outputs.len()], ..Bounds::default() };
    for _ in 0..DESIGNS {
        let inputs = draw(model, region, random);
        let outputs = decided(model, &inputs).1;
        for (number, exact) in meaningful_si(model, &inputs).into_iter().enumerate() {
            let Some(exact) = exact else { continue };
            let RunningError { value, bound } = outputs[number];
            found.checked += 1;
            if bound.is_infinite() {
                found.infinite += 1;
                continue;
            }
            // f64 rounds too, though nine orders of magnitude less.
            let error = (f64::from(value) - exact).abs() - 1e-13 * exact.abs();
            if error > bound / shrink || value.is_nan() {
                found.broken += 1;
                if found.example.is_empty() {
                    found.example = format!("{} is {value:e}, exactly {exact:e}, bound {bound:e}: {inputs:?}", model.outputs[number].name);
                }
            }
            found.used = found.used.max(error / bound);
            if exact != 0.0 {
                found.relative[number].push(bound / exact.abs());
            }
        }
    }
    found
}

#[test]
fn an_f32_value_lies_within_its_bound_of_the_f64_value_and_the_bound_is_useful() {
    for model in on_a_device() {
        for region in [Region::Usual, Region::Wide, Region::Edges] {
            let mut found = compare(model, region, 1.0);
            eprintln!(
                "{} {region:?}: {} values, {} without a bound, at most {:.3} of a bound used",
                model.name, found.checked, found.infinite, found.used
            );
            assert_eq!(found.broken, 0, "{} {region:?}: {}", model.name, found.example);
            assert!(found.checked * 4 > DESIGNS * model.outputs.len(), "{}: only {} values", model.name, found.checked);
            if region != Region::Usual {
                continue;
            }
            assert!(found.infinite * 1000 < found.checked, "{}: {} of {} have no bound", model.name, found.infinite, found.checked);
            for (output, bounds) in model.outputs.iter().zip(&mut found.relative) {
                bounds.sort_by(f64::total_cmp);
                assert!(bounds.len() > 1000, "{}: {} is hardly ever anything but 0", model.name, output.name);
                let median = bounds[bounds.len() / 2];
                eprintln!("  {}: median relative bound {median:.1e}", output.name);
                assert!(median < 1e-4, "{}: the median relative bound of {} is {median:e}", model.name, output.name);
            }
        }
    }
}

#[test]
fn a_bound_ten_thousand_times_too_small_is_noticed() {
    for model in on_a_device() {
        let found = compare(model, Region::Usual, 1e4);
        assert!(found.broken > found.checked / 100, "{}: {} of {}", model.name, found.broken, found.checked);
    }
}

/// How many decisions were sure, wrong though sure, and unsure.
#[derive(Debug, Default)]
struct Decisions {
    yes: usize,
    no: usize,
    unsure: usize,
    wrong: Option<String>,
}

fn decide(model: &Model, designs: impl Iterator<Item = Vec<f64>>) -> Decisions {
    let mut found = Decisions::default();
    for inputs in designs {
        let ok = evaluate(model, &inputs).status == Status::Ok;
        let decision = decided(model, &inputs).0;
        match decision {
            Decision::Yes => found.yes += 1,
            Decision::No => found.no += 1,
            Decision::Unsure => found.unsure += 1,
        }
        if decision == if ok { Decision::No } else { Decision::Yes } {
            found.wrong.get_or_insert_with(|| format!("{decision:?}, though f64 says ok = {ok}: {inputs:?}"));
        }
    }
    found
}

#[test]
fn a_sure_decision_is_the_f64_one_and_most_decisions_are_sure() {
    for model in on_a_device() {
        for region in [Region::Usual, Region::Wide, Region::Edges] {
            let random = &mut Random::new(13);
            let found = decide(model, (0..DESIGNS).map(|_| draw(model, region, random)));
            eprintln!("{} {region:?}: {found:?}", model.name);
            assert_eq!(found.wrong, None, "{} {region:?}", model.name);
            if region == Region::Usual {
                assert!(found.unsure * 200 < DESIGNS, "{}: {found:?}", model.name);
                assert!(found.yes > DESIGNS / 3 && found.no > 100, "{}: {found:?}", model.name);
            }
        }
    }
}

/// Moves one input of a design with another status than its neighbour onto the boundary between them.
pub fn onto_a_boundary(model: &Model, random: &mut Random) -> Option<Vec<f64>> {
    let inputs = draw(model, Region::Usual, random);
    let status = |inputs: &[f64]| evaluate(model, inputs).status == Status::Ok;
    let input = random.below(model.inputs.len());
    let table = &model.inputs[input];
    if table.integer || table.word_for(inputs[input]).is_some() {
        return None;
    }
    let (mut here, mut there) = (inputs.clone(), inputs);
    there[input] = random.between(table.usual.0, table.usual.1);
    if status(&here) == status(&there) {
        return None;
    }
    while (here[input] - there[input]).abs() > 1e-12 * here[input].abs() {
        let mut middle = here.clone();
        middle[input] = 0.5 * (here[input] + there[input]);
        if status(&middle) == status(&here) { here = middle } else { there = middle }
    }
    Some(here)
}

#[test]
fn on_a_boundary_the_decision_is_unsure() {
    for model in on_a_device() {
        let random = &mut Random::new(14);
        let designs: Vec<_> = std::iter::repeat_with(|| onto_a_boundary(model, random)).flatten().take(500).collect();
        let found = decide(model, designs.into_iter());
        assert_eq!(found.wrong, None, "{}", model.name);
        assert!(found.unsure > 480, "{}: {found:?}", model.name);
    }
}

#[test]
fn a_traction_at_its_limit_surely_does_not_slip_and_has_no_margin() {
    for model in models::all().iter().filter(|model| model.input("traction").is_some()) {
        let random = &mut Random::new(15);
        let margin = model.output("slip_margin").expect("it is an output");
        let mut sure = 0;
        for _ in 0..1000 {
            let mut inputs = draw(model, Region::Usual, random);
            inputs[model.input("traction").expect("it is an input")] = -1.0;
            inputs[model.input("clamping_force_N").expect("it is an input")] = -1.0;
            let (decision, outputs) = decided(model, &inputs);
            sure += usize::from(decision != Decision::Unsure);
            if decision == Decision::Yes {
                assert_eq!((outputs[margin].value, outputs[margin].bound), (0.0, 0.0), "{}: {inputs:?}", model.name);
            }
        }
        assert!(sure > 990, "{}: {sure}", model.name);
    }
}

#[test]
fn a_traction_or_torque_of_exactly_zero_is_no_borderline_case() {
    for model in models::all().iter().filter(|model| model.input("traction").is_some()) {
        let decision = |traction: f64, torque: f64| {
            let mut inputs = model.defaults();
            inputs[model.input("traction").expect("it is an input")] = traction;
            inputs[model.input("torque_Nm").expect("it is an input")] = torque;
            decided(model, &inputs).0
        };
        assert_eq!(decision(0.0, 0.0), Decision::Yes, "{}", model.name);
        assert_eq!(decision(0.0, 50.0), Decision::No, "{}", model.name);
        assert_eq!(decision(0.3, 0.0), Decision::Yes, "{}", model.name);
    }
}

#[test]
fn a_capacity_of_zero_is_known_to_be_zero() {
    let model = find("rubber-cvt").expect("it is a model");
    let mut inputs = model.defaults();
    inputs[model.input("belt_thickness_mm").expect("it is an input")] = 40.0;
    let outputs = decided(&model, &inputs).1;
    for name in ["torque_capacity_Nm", "capacity_axial_force_N"] {
        let capacity = outputs[model.output(name).expect("it is an output")];
        // Nothing but what may be flushed to zero.
        assert!(capacity.value == 0.0 && capacity.bound < 1e-30, "{name}: {capacity:?}");
    }
}
