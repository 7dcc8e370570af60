//! The dependencies of the recorded formula, compared with trying changes of the inputs.

use super::si;
use crate::effort::is_slow;
use crate::physics::{Region, draw};
use crate::random::Random;
use beltspace::models::{self, Dependencies, Model, Set, find};
use beltspace::tape::Known;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Everything that a formula computes of a design, by its bits.
struct Parts {
    prepared: Vec<u64>,
    outputs: Vec<u64>,
    conditions: Vec<u64>,
}

impl Parts {
    fn new(model: &Model, si: &[f64]) -> Self {
        Self::wanted(model, si, Set::ALL)
    }

    fn wanted(model: &Model, si: &[f64], wanted: Set) -> Self {
        let mut prepared = vec![0.0; model.kernel.prepared_len()];
        model.kernel.prepare(si, wanted, &mut prepared);
        let bits = |numbers: Vec<f64>| numbers.into_iter().map(f64::to_bits).collect();
        Self {
            outputs: bits(model.kernel.outputs(&prepared, si, wanted)),
            conditions: bits(model.kernel.margins(&prepared, si)),
            prepared: bits(prepared),
        }
    }
}

/// Inputs that change something although the dependencies do not say so, and the pairs of input and output that were seen to change.
fn missed(
    model: &Model,
    dependencies: &Dependencies,
    input: usize,
    before: &Parts,
    after: &Parts,
    seen: &mut BTreeSet<(usize, usize)>,
) -> Option<String> {
    let names = |set: Set| set.contains(input);
    let by = &model.inputs[input].name;
    if before.prepared != after.prepared && !names(dependencies.prepared) {
        return Some(format!("{}: {by} changes what is prepared", model.name));
    }
    for (number, output) in model.outputs.iter().enumerate().filter(|(number, _)| before.outputs[*number] != after.outputs[*number]) {
        seen.insert((input, number));
        if !names(dependencies.outputs[number]) {
            return Some(format!("{}: {by} changes {}", model.name, output.name));
        }
    }
    let changed =
        (0..model.conditions.len()).find(|&it| before.conditions[it] != after.conditions[it] && !names(dependencies.conditions[it]));
    changed.map(|condition| format!("{}: {by} changes the condition \"{}\"", model.name, model.conditions[condition].reason))
}

/// Tries changes of single inputs; `varied` are the inputs that vary when the dependencies are determined.
fn try_changes(
    model: &Model,
    seed: u64,
    varied: impl Fn(usize, &mut Random) -> bool,
    spoil: Set,
) -> (Option<String>, BTreeSet<(usize, usize)>, Vec<Dependencies>) {
    let random = &mut Random::new(seed);
    let mut seen = BTreeSet::new();
    let mut all_dependencies = Vec::new();
    for _ in 0..400 {
        // Two designs span the ranges that the inputs vary over.
        let region = random.pick(&[Region::Usual, Region::Usual, Region::Edges]);
        let ends = [draw(model, region, random), draw(model, region, random)].map(|inputs| si(model, &inputs));
        let mut inputs = vec![Known::Fixed(0.0); model.inputs.len()];
        let mut free = Vec::new();
        for input in 0..model.inputs.len() {
            let (low, high) = (ends[0][input].min(ends[1][input]), ends[0][input].max(ends[1][input]));
            inputs[input] = Known::Fixed(ends[0][input]);
            if varied(input, random) {
                inputs[input] = Known::Within(low, high);
                free.push(input);
            }
        }
        let mut dependencies = model.kernel.dependencies(&inputs);
        dependencies.outputs.iter_mut().for_each(|set| *set = *set - spoil);
        let mut design = ends[0].clone();
        let mut before = Parts::new(model, &design);
        for _ in 0..4 * free.len() {
            let input = random.pick(&free);
            // An end, or between the ends where both are numbers rather than the word for one.
            let between = ends[0][input].min(ends[1][input]) >= 0.0;
            design[input] = match random.below(3) {
                0 if between => random.between(ends[0][input].min(ends[1][input]), ends[0][input].max(ends[1][input])),
                choice => ends[choice % 2][input],
            };
            let after = Parts::new(model, &design);
            if let Some(problem) = missed(model, &dependencies, input, &before, &after, &mut seen) {
                return (Some(problem), seen, all_dependencies);
            }
            before = after;
        }
        all_dependencies.push(dependencies);
    }
    (None, seen, all_dependencies)
}

/// Models that are quick enough for a walk of many steps; of the others each input is changed once, around each of their presets.
fn walked() -> impl Iterator<Item = &'static Arc<Model>> {
    models::all().iter().filter(|model| !is_slow(model))
}

/// Another value of an input, so near that the design stays what it is.
fn nudged(model: &Model, input: usize, value: f64) -> f64 {
    let table = &model.inputs[input];
    match table.words.iter().find(|(_, word)| *word != value) {
        Some((_, word)) if table.is_enumeration() => *word,
        _ if table.word_for(value).is_some() => table.usual.0.midpoint(table.usual.1),
        _ if table.integer => value + 1.0,
        // To another point of the surface.
        _ if table.name.starts_with("point_") => value + 5.0,
        _ => value * 1.003 + f64::from(u8::from(value == 0.0)),
    }
}

/// The dependencies where the inputs that `varied` names take every value and the others those of `si`.
fn dependencies_of(model: &Model, si: &[f64], varied: impl Fn(usize) -> bool) -> Dependencies {
    let mut inputs: Vec<Known> = si.iter().map(|&value| Known::Fixed(value)).collect();
    for (input, table) in model.inputs.iter().enumerate().filter(|(input, _)| varied(*input)) {
        let least = table.words.iter().fold(0.0, |least, (_, word)| word.min(least));
        inputs[input] = Known::Within(least, 1e9);
    }
    model.kernel.dependencies(&inputs)
}

/// Changes every input of a preset but the one that says which section it is. Of `wanted` outputs: how many pairs of input and
/// output are named that were not seen to change, how many in all, and which inputs were seen to change anything.
fn changed_one_by_one(model: &Model, preset: &str, wanted: Set) -> (Vec<String>, usize, BTreeSet<usize>) {
    let [section, tensioning] = ["section", "tensioning"].map(|name| model.input(name).expect("it is an input"));
    let mut inputs = model.preset(preset).expect("it is a preset");
    // What is read in one case only is read.
    for (name, value) in [("clamp_force_N", -1.0), ("point_1_r_mm", 40.0), ("point_2_r_mm", 58.0), ("point_2_z_mm", 12.0)] {
        inputs[model.input(name).expect("it is an input")] = value;
    }
    if preset == "paper" {
        inputs[tensioning] = model.inputs[tensioning].value_of("fixed-centres").expect("it is a word");
    }
    let base = si(model, &inputs);
    let before = Parts::wanted(model, &base, wanted);
    let of_section = dependencies_of(model, &base, |input| input != section && input != tensioning);
    let every = dependencies_of(model, &base, |_| true);
    let (mut seen, mut changing) = (BTreeSet::new(), BTreeSet::new());
    for input in (0..model.inputs.len()).filter(|input| *input != section) {
        let mut other = inputs.clone();
        other[input] = nudged(model, input, inputs[input]);
        let after = Parts::wanted(model, &si(model, &other), wanted);
        let alone = dependencies_of(model, &base, |it| it == input);
        let ways = [("its words fixed", &of_section), ("all inputs vary", &every), ("it alone varies", &alone)];
        for (what, dependencies) in ways.into_iter().skip(usize::from(input == tensioning)) {
            assert_eq!(missed(model, dependencies, input, &before, &after, &mut seen), None, "{preset}, {what}");
        }
        let silent = Dependencies {
            prepared: Set::EMPTY,
            outputs: vec![Set::EMPTY; before.outputs.len()],
            conditions: vec![Set::EMPTY; before.conditions.len()],
        };
        if missed(model, &silent, input, &before, &after, &mut BTreeSet::new()).is_some() {
            changing.insert(input);
        }
    }
    // Where the largest stress stands jumps from point to point, which a small change rarely causes.
    let jumps = |name: &str| ["max_stress_r_mm", "max_stress_z_mm", "max_stress_theta_deg"].contains(&name);
    let fails = |number: &usize| f64::from_bits(before.conditions[*number]) < 0.0;
    let absent: BTreeSet<_> =
        (0..model.conditions.len()).filter(fails).flat_map(|number| &model.conditions[number].invalidates).map(String::as_str).collect();
    let counts = |name: &str| !jumps(name) && !absent.contains(name);
    let outputs = (0..model.outputs.len()).filter(|&number| wanted.contains(number) && counts(&model.outputs[number].name));
    let pairs = outputs.flat_map(|number| (0..model.inputs.len()).map(move |input| (input, number)));
    let named: Vec<_> = pairs.filter(|(input, number)| of_section.outputs[*number].contains(*input)).collect();
    let idle = named.iter().filter(|pair| !seen.contains(pair));
    let idle = idle.map(|&(input, number)| format!("{} -> {}", model.inputs[input].name, model.outputs[number].name)).collect();
    (idle, named.len(), changing)
}

#[test]
fn what_an_input_of_a_slow_model_changes_is_named_for_every_section_and_little_else() {
    for model in models::all().iter().filter(|model| is_slow(model)) {
        let section = model.input("section").expect("it has sections");
        let mut changing = BTreeSet::from([section]);
        for preset in model.presets.iter().map(|it| it.name.as_str()) {
            // A solid section takes seconds to solve. What its inputs do to loads, outline and mesh shows without; how stresses follow
            // from a mesh is the same for all sections.
            let solved = preset != "machined";
            let cheap = ["volume_mm3", "mass_g", "excluded_radius_mm", "seat_pressure_MPa", "bolt_utilisation", "joint_slip_safety"];
            let loads = model.output("max_stress_MPa").expect("it is an output");
            let wanted = |number: &usize| solved || *number < loads || cheap.contains(&model.outputs[*number].name.as_str());
            let wanted = (0..model.outputs.len()).filter(wanted).collect();
            let (idle, named, seen) = changed_one_by_one(model, preset, wanted);
            eprintln!("{preset}: {named} pairs are named, these {} were not seen to change: {idle:?}", idle.len());
            assert!(idle.len() * 10 < named || !solved, "{preset}: {named}, {idle:?}");
            changing.extend(seen);
        }
        assert_eq!(changing.len(), model.inputs.len(), "{}: only {changing:?} change anything", model.name);
    }
}

#[test]
fn the_section_changes_all_but_the_loads() {
    for model in models::all().iter().filter(|model| is_slow(model)) {
        let section = model.input("section").expect("it has sections");
        let before = Parts::new(model, &si(model, &model.defaults()));
        let every = dependencies_of(model, &si(model, &model.defaults()), |input| input == section);
        let mut seen = BTreeSet::new();
        // With the dimensions of another section these fail or stand, and either shows.
        for (_, word) in model.inputs[section].words.iter().filter(|(name, _)| *name != "machined") {
            let mut inputs = si(model, &model.defaults());
            inputs[section] = *word;
            assert_eq!(missed(model, &every, section, &before, &Parts::new(model, &inputs), &mut seen), None);
        }
        let loads = model.output("max_stress_MPa").expect("it is an output");
        assert!(seen.iter().all(|(_, output)| *output >= loads) && seen.len() > 20, "{seen:?}");
    }
}

#[test]
fn what_an_input_changes_is_always_named() {
    for model in walked() {
        assert_eq!(try_changes(model, 31, |_, _| true, Set::EMPTY).0, None, "all inputs vary");
        assert_eq!(try_changes(model, 32, |_, random| random.chance(0.5), Set::EMPTY).0, None, "half of the inputs vary");
        for input in 0..model.inputs.len() {
            assert_eq!(try_changes(model, 33, |it, _| it == input, Set::EMPTY).0, None, "only {} varies", model.inputs[input].name);
        }
    }
}

#[test]
fn little_is_named_that_nothing_changes() {
    for model in walked() {
        let (_, seen, all_dependencies) = try_changes(model, 34, |_, _| true, Set::EMPTY);
        let mut idle = Vec::new();
        let mut named = 0;
        for (number, output) in model.outputs.iter().enumerate() {
            for (input, table) in model.inputs.iter().enumerate() {
                if all_dependencies.iter().any(|dependencies| dependencies.outputs[number].contains(input)) {
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
    for model in walked() {
        for input in 0..model.inputs.len() {
            let problem = try_changes(model, 35, |_, _| true, Set::one(input)).0;
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
        let names_friction = |given: Known| {
            let mut inputs: Vec<_> = si(&model, &model.defaults()).into_iter().map(Known::Fixed).collect();
            inputs[friction] = Known::Within(0.05, 0.5);
            inputs[traction] = given;
            model.kernel.dependencies(&inputs).outputs[coefficient].contains(friction)
        };
        assert!(!names_friction(Known::Fixed(0.4)), "{name}");
        assert!(!names_friction(Known::Within(0.1, 0.5)), "{name}: all values are numbers");
        assert!(names_friction(Known::Fixed(-1.0)), "{name}: the limit hangs on friction");
        assert!(names_friction(Known::Within(-1.0, 0.5)), "{name}: one of the values is the limit");
    }
}
