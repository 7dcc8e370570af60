//! What the ranges of a study settle of a formula from text: no number and no failure is lost, and little is left to be asked.

use super::parsed;
use super::same::STUDIES;
use crate::random::Random;
use beltspace::models::Model;
use beltspace::real::Real;
use beltspace::tape::{Binary, Known, List, Loops, Operation, Reads, Recording, Set, SettledStages, StageLists, Trace, Whole};
use std::sync::Arc;

fn model(name: &str) -> Arc<Model> {
    let (_, text) = STUDIES.into_iter().find(|(model, _)| *model == name).expect("it is one of them");
    parsed(&format!("model = \"{name}-in-a-file.toml\"\n{text}")).model
}

/// All inputs of a model at their defaults, in SI.
fn defaults(model: &Model) -> Vec<f64> {
    model
        .inputs
        .iter()
        .map(|input| if input.word_for(input.default).is_some() { input.default } else { input.unit.to_si(input.default) })
        .collect()
}

fn settled(model: &Model, known: &[Known]) -> SettledStages {
    SettledStages::new(model.kernel.formula().expect("it is recorded"), known, Set::ALL, &all_conditions(model))
}

fn all_conditions(model: &Model) -> Vec<(usize, bool)> {
    model.conditions.iter().map(|it| it.strict).enumerate().collect()
}

/// Outputs and margins of lists as they are run one after the other.
fn run(lists: &StageLists, inputs: &[f64]) -> [Vec<f64>; 2] {
    let numbers = [inputs, &lists.first.run(inputs)].concat();
    [lists.finish.run(&numbers), lists.conditions.run(&numbers)]
}

/// Does a settled formula say something else of these inputs?
fn differs(model: &Model, whole: &StageLists, settled: &SettledStages, inputs: &[f64]) -> bool {
    let [outputs, margins] = run(whole, inputs);
    let [found, asked] = run(&settled.lists, inputs);
    let same = |a: f64, b: f64| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
    let holds = |number: usize, margin: f64| if model.conditions[number].strict { margin > 0.0 } else { margin >= 0.0 };
    let margin =
        |number: usize| if settled.open.contains(number) { same(margins[number], asked[number]) } else { holds(number, margins[number]) };
    !outputs.iter().zip(&found).all(|(&a, &b)| same(a, b)) || !(0..margins.len()).all(margin)
}

fn operations(lists: &StageLists) -> usize {
    [&lists.first, &lists.conditions, &lists.finish].iter().map(|list| list.operations.len()).sum()
}

#[test]
fn nothing_is_lost_in_any_range() {
    let random = &mut Random::new(7);
    let (mut closed, mut open, mut failed, mut passed) = (0, 0, 0, 0);
    for (name, _) in STUDIES {
        let model = model(name);
        let whole = StageLists::whole(model.kernel.formula().expect("it is recorded"), model.conditions.len());
        for _ in 0..60 {
            let spread = [0.02, 0.3, 3.0][random.below(3)];
            let range = |(input, &value): (usize, &f64)| {
                let is_word = model.inputs[input].word_for(model.inputs[input].default).is_some();
                match (random.below(3), is_word) {
                    (0, _) | (1, true) => Known::Fixed(value),
                    // A word is below all numbers that may stand in its place.
                    (_, true) => Known::Within(value.min(0.1), 0.6),
                    (_, false) => Known::Within(value / (1.0 + spread), value * (1.0 + spread) + if value == 0.0 { spread } else { 0.0 }),
                }
            };
            let known: Vec<Known> = defaults(&model).iter().enumerate().map(range).collect();
            let settled = settled(&model, &known);
            open += settled.open.len();
            closed += model.conditions.len() - settled.open.len();
            // The same, divided by which inputs change slowly.
            let slow: Set = (0..known.len()).filter(|_| random.below(2) == 0).collect();
            let formula = model.kernel.formula().expect("it is recorded");
            let divided = SettledStages::divided(formula, &known, Set::ALL, &all_conditions(&model), slow);
            let first_reads = Reads::of_lists(&divided.fields, &[&divided.lists.first]).inputs;
            assert!((first_reads - slow).is_empty(), "{name}: {first_reads:?} are not all among {slow:?}");
            assert!(divided.fields.prepared.iter().all(|it| it.starts_with('k')), "{name} is divided as it was written");
            passed += divided.lists.first.results.iter().flatten().count();
            for _ in 0..40 {
                let inputs: Vec<f64> = known
                    .iter()
                    .map(|it| match *it {
                        Known::Fixed(value) => value,
                        Known::Within(low, high) => [low, high, low + random.unit() * (high - low)][random.below(3)],
                    })
                    .collect();
                assert!(!differs(&model, &whole, &settled, &inputs), "{name}: {known:?} at {inputs:?}");
                assert!(!differs(&model, &whole, &divided, &inputs), "{name}, slow {slow:?}: {known:?} at {inputs:?}");
                let margins = &run(&whole, &inputs)[1];
                failed += margins.iter().filter(|margin| **margin < 0.0).count();
            }
        }
    }
    assert!(closed > 1000 && open > 300 && failed > 300, "{closed} conditions are sure, {open} are not, {failed} failed");
    assert!(passed > 1000, "{passed} numbers pass between the stages");
}

#[test]
fn of_one_design_everything_is_sure() {
    for (name, _) in STUDIES {
        let model = model(name);
        let known: Vec<Known> = defaults(&model).into_iter().map(Known::Fixed).collect();
        let settled = settled(&model, &known);
        let chooses = |list: &List| list.operations.iter().filter(|it| matches!(it, Operation::Select(..))).count();
        let lists = [&settled.lists.conditions, &settled.lists.finish];
        // What is exactly zero at the defaults, a slip margin, is not surely greater.
        assert!(settled.open.len() <= 2 && lists.into_iter().map(chooses).sum::<usize>() == 0, "{name}: {:?}", settled.open);
        let whole = StageLists::whole(model.kernel.formula().expect("it is recorded"), model.conditions.len());
        assert!(3 * operations(&settled.lists) < 2 * operations(&whole), "{name}");
    }
}

#[test]
fn beyond_its_ranges_a_settled_formula_is_wrong() {
    let model = model("metal-cvt");
    let whole = StageLists::whole(model.kernel.formula().expect("it is recorded"), model.conditions.len());
    let mut inputs = defaults(&model);
    let settled = settled(&model, &inputs.iter().copied().map(Known::Fixed).collect::<Vec<_>>());
    assert!(!differs(&model, &whole, &settled, &inputs));
    // A traction above zero in place of the word "limit", and a belt that is too short.
    for (name, value) in [("traction", 0.4), ("belt_length_mm", 0.2)] {
        let input = model.input(name).expect("it is an input");
        let before = std::mem::replace(&mut inputs[input], value);
        assert!(differs(&model, &whole, &settled, &inputs), "{name}");
        inputs[input] = before;
    }
}

/// A model, two of its outputs, and the ranges of some inputs.
type RangesOfStudy = (&'static str, [&'static str; 2], &'static [(&'static str, f64, f64)]);

/// Numbers that are computed, without inputs and constants.
fn computed(list: &List) -> usize {
    let is_computed = |it: &&Operation| matches!(it, Operation::Unary(..) | Operation::Binary(..) | Operation::Select(..));
    list.operations.iter().filter(is_computed).count()
}

/// In a study a model in a file asks a device for no more of a design than the same model of the program, for two objectives; and far
/// fewer conditions are left to be asked.
#[test]
fn little_is_left_to_be_asked_in_a_study() {
    let studies: [RangesOfStudy; 3] = [
        (
            "metal-cvt",
            ["axial_force_N", "stress_margin"],
            &[("groove_angle_deg", 18.0, 30.0), ("band_thickness_mm", 0.1, 0.3), ("band_count", 4.0, 14.0), ("ratio", 0.5, 2.0)],
        ),
        (
            "rubber-cvt",
            ["axial_force_N", "stress_margin"],
            &[("groove_angle_deg", 24.0, 34.0), ("belt_width_mm", 20.0, 50.0), ("belt_thickness_mm", 1.0, 3.0), ("ratio", 0.5, 2.0)],
        ),
        (
            "pulley-load",
            ["resultant_force_N", "friction_margin"],
            &[("groove_angle_deg", 34.0, 38.0), ("mean_radius_mm", 40.0, 80.0), ("slack_tension_N", 300.0, 900.0)],
        ),
    ];
    for (name, outputs, ranges) in studies {
        let lists = [beltspace::models::find(name).expect("it is a model"), model(name)].map(|model| {
            let mut known: Vec<Known> = defaults(&model).into_iter().map(Known::Fixed).collect();
            for &(input, low, high) in ranges {
                let number = model.input(input).expect("it is an input");
                let unit = &model.inputs[number].unit;
                known[number] = Known::Within(unit.to_si(low), unit.to_si(high));
            }
            let wanted: Set = outputs.iter().map(|output| model.output(output).expect("it is an output")).collect();
            let slow: Set = ["groove_angle_deg", "ratio"].into_iter().filter_map(|input| model.input(input)).collect();
            let any = vec![Known::ANY; known.len()];
            let formula = model.kernel.formula().expect("it is recorded");
            [known, any].map(|known| SettledStages::divided(formula, &known, wanted, &all_conditions(&model), slow))
        });
        let [[own, _], [in_file, asked_everything]] = &lists;
        let [most, found, before] = [own, in_file, asked_everything].map(|it| computed(&it.lists.finish));
        assert!(found <= most && before > found + 3, "{name}: {found} in place of {before}, the model of the program takes {most}");
        let open = in_file.open.len();
        let model = model(name);
        let asked: Vec<&str> = in_file.open.iter().map(|condition| &*model.conditions[condition].reason).collect();
        assert!(open <= 18 && asked_everything.open.len() > 2 * open, "{name}: of {} {asked:?}", asked_everything.open.len());
    }
}

/// The operations that are left of a formula of one input of this range.
fn settled_alone(range: Known, formula: impl FnOnce(Trace) -> Trace) -> Vec<Operation> {
    let (recording, outputs) = Recording::recorded(Loops::EveryIteration, &[range], |inputs| vec![formula(inputs[0])]);
    let whole = Whole { recording, prepared: Vec::new(), outputs, conditions: Vec::new() };
    whole.settled(&[range], &[0], []).operations
}

#[test]
fn what_may_be_no_number_settles_nothing_and_zero_takes_away_what_is_surely_a_number() {
    let is_kept = |range: Known, formula: fn(Trace) -> Trace, what: fn(&Operation) -> bool| settled_alone(range, formula).iter().any(what);
    let chooses = |operation: &Operation| matches!(operation, Operation::Binary(Binary::Max, ..));
    let formulas: [fn(Trace) -> Trace; 4] = [
        |x| x.sqrt().max(Trace::constant(-5.0)),
        |x| x.asin().max(Trace::constant(-5.0)),
        |x| (x.sqrt() - Trace::constant(0.5)).exp_m1().max(Trace::constant(-5.0)),
        |x| x.asin().sin().max(Trace::constant(-5.0)),
    ];
    for (number, formula) in formulas.into_iter().enumerate() {
        assert!(!is_kept(Known::Within(0.0, 0.9), formula, chooses), "{number} is a number everywhere");
        assert!(is_kept(Known::Within(-1.5, 0.9), formula, chooses), "{number} may be none");
    }
    let multiplies = |operation: &Operation| matches!(operation, Operation::Binary(Binary::Mul | Binary::Sub, ..));
    let without_mass: fn(Trace) -> Trace = |x| x - Trace::constant(0.0) * (x * Trace::constant(0.0)).squared();
    assert!(!is_kept(Known::Within(0.5, 2.0), without_mass, multiplies));
    for range in [Known::Within(-0.5, 2.0), Known::Within(0.0, 2.0), Known::ANY] {
        assert!(is_kept(range, without_mass, multiplies), "its zero may be a negative one, or no number: {range:?}");
    }
}
