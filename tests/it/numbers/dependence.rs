//! What depends on what, as the formula itself says, against trying it out.

use super::{outputs_si, si};
use crate::physics::{Region, draw};
use crate::random::Random;
use beltspace::models::{CONDITIONS, INPUTS, MODELS, Model, OUTPUTS, Reach, find};
use beltspace::real::Dependence;
use std::collections::BTreeSet;

/// Everything that a formula computes of a design, by its bits.
struct Parts {
    prepared: Vec<u64>,
    outputs: [u64; OUTPUTS],
    conditions: [u64; CONDITIONS],
}

impl Parts {
    fn new(model: &Model, si: &[f64; INPUTS]) -> Self {
        let prepared = model.kernel.prepared(si);
        Self {
            outputs: outputs_si(model, si).map(f64::to_bits),
            conditions: model.kernel.conditions(&prepared, si).map(f64::to_bits),
            prepared: prepared.into_iter().map(f64::to_bits).collect(),
        }
    }
}

/// Inputs that change something that the reach does not say, and the pairs of input and output that were seen to change.
fn missed(
    model: &Model,
    reach: &Reach,
    input: usize,
    before: &Parts,
    after: &Parts,
    seen: &mut BTreeSet<(usize, usize)>,
) -> Option<String> {
    let names = |set: u64| set >> input & 1 == 1;
    let by = model.inputs[input].name;
    if before.prepared != after.prepared && !names(reach.prepared) {
        return Some(format!("{}: {by} changes what is prepared", model.name));
    }
    for (number, output) in model.outputs.iter().enumerate().filter(|(number, _)| before.outputs[*number] != after.outputs[*number]) {
        seen.insert((input, number));
        if !names(reach.outputs[number]) {
            return Some(format!("{}: {by} changes {}", model.name, output.name));
        }
    }
    let changed = (0..model.conditions.len()).find(|&it| before.conditions[it] != after.conditions[it] && !names(reach.conditions[it]));
    changed.map(|condition| format!("{}: {by} changes the condition \"{}\"", model.name, model.conditions[condition].reason))
}

/// Tries changes of single inputs; `varied` says which inputs the reach is told to vary.
fn try_changes(
    model: &Model,
    seed: u64,
    varied: impl Fn(usize, &mut Random) -> bool,
    spoil: u64,
) -> (Option<String>, BTreeSet<(usize, usize)>, Vec<Reach>) {
    let random = &mut Random::new(seed);
    let mut seen = BTreeSet::new();
    let mut reaches = Vec::new();
    for _ in 0..400 {
        // Two designs span the ranges that the inputs vary over.
        let region = random.pick(&[Region::Usual, Region::Usual, Region::Edges]);
        let ends = [draw(model, region, random), draw(model, region, random)].map(|inputs| si(model, &inputs));
        let mut inputs = [Dependence::fixed(0.0); INPUTS];
        let mut free = Vec::new();
        for input in 0..model.inputs.len() {
            let (low, high) = (ends[0][input].min(ends[1][input]), ends[0][input].max(ends[1][input]));
            inputs[input] = Dependence::fixed(ends[0][input]);
            if varied(input, random) {
                inputs[input] = Dependence::varied(input, low, high);
                free.push(input);
            }
        }
        let mut reach = model.kernel.reach(&inputs);
        reach.outputs.iter_mut().for_each(|set| *set &= !spoil);
        let mut design = ends[0];
        for _ in 0..4 * free.len() {
            let input = random.pick(&free);
            let before = Parts::new(model, &design);
            // An end, or between the ends where both are numbers rather than the word for one.
            let between = ends[0][input].min(ends[1][input]) >= 0.0;
            design[input] = match random.below(3) {
                0 if between => random.between(ends[0][input].min(ends[1][input]), ends[0][input].max(ends[1][input])),
                choice => ends[choice % 2][input],
            };
            if let Some(problem) = missed(model, &reach, input, &before, &Parts::new(model, &design), &mut seen) {
                return (Some(problem), seen, reaches);
            }
        }
        reaches.push(reach);
    }
    (None, seen, reaches)
}

#[test]
fn what_an_input_changes_is_always_named() {
    for model in MODELS {
        assert_eq!(try_changes(model, 31, |_, _| true, 0).0, None, "all inputs vary");
        assert_eq!(try_changes(model, 32, |_, random| random.chance(0.5), 0).0, None, "half of the inputs vary");
        for input in 0..model.inputs.len() {
            assert_eq!(try_changes(model, 33, |it, _| it == input, 0).0, None, "only {} varies", model.inputs[input].name);
        }
    }
}

#[test]
fn little_is_named_that_nothing_changes() {
    for model in MODELS {
        let (_, seen, reaches) = try_changes(model, 34, |_, _| true, 0);
        let mut idle = Vec::new();
        let mut named = 0;
        for (number, output) in model.outputs.iter().enumerate() {
            for (input, table) in model.inputs.iter().enumerate() {
                if reaches.iter().any(|reach| reach.outputs[number] >> input & 1 == 1) {
                    named += 1;
                    if !seen.contains(&(input, number)) {
                        idle.push(format!("{} -> {}", table.name, output.name));
                    }
                }
            }
        }
        eprintln!("{}: {named} pairs are named, these were not seen to change: {idle:?}", model.name);
        assert!(idle.len() * 10 < named, "{}: {idle:?}", model.name);
    }
}

#[test]
fn an_input_that_is_not_named_is_noticed() {
    for model in MODELS {
        for input in 0..model.inputs.len() {
            let problem = try_changes(model, 35, |_, _| true, 1 << input).0;
            assert!(problem.is_some(), "{}: nobody misses {}", model.name, model.inputs[input].name);
        }
    }
}

#[test]
fn a_traction_that_is_a_number_keeps_friction_out_of_the_torque_coefficient() {
    for name in ["rubber-cvt", "metal-cvt"] {
        let model = find(name).expect("it is a model");
        let [friction, traction] = ["friction", "traction"].map(|name| model.input(name).expect("it is an input"));
        let coefficient = model.output("torque_coefficient_N_per_mm").expect("it is an output");
        let names_friction = |given: Dependence| {
            let mut inputs = si(model, &model.defaults()).map(Dependence::fixed);
            inputs[friction] = Dependence::varied(friction, 0.05, 0.5);
            inputs[traction] = given;
            model.kernel.reach(&inputs).outputs[coefficient] >> friction & 1 == 1
        };
        assert!(!names_friction(Dependence::fixed(0.4)), "{name}");
        assert!(!names_friction(Dependence::varied(traction, 0.1, 0.5)), "{name}: all values are numbers");
        assert!(names_friction(Dependence::fixed(-1.0)), "{name}: the limit hangs on friction");
        assert!(names_friction(Dependence::varied(traction, -1.0, 0.5)), "{name}: one of the values is the limit");
    }
}
