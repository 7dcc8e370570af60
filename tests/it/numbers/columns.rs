//! Eight designs at a time must give the same bits as one at a time.

use super::si;
use crate::effort::evaluations;
use crate::physics::{Region, draw, slow_inputs};
use crate::random::Random;
use beltspace::models::{self, Columns, Model, Scratch, Set};
use beltspace::real::LANES;

/// Inputs that may differ between designs that share what is prepared.
fn fast_inputs(model: &Model) -> Vec<usize> {
    let slow = slow_inputs(model);
    (0..model.inputs.len()).filter(|&input| !slow.contains(input)).collect()
}

/// The first value of a batch that differs from the scalar one, with every scalar value changed by `spoil`.
fn differing(model: &Model, count: usize, scratch: &mut Scratch, random: &mut Random, spoil: fn(f64) -> f64) -> Option<String> {
    let region = random.pick(&[Region::Usual, Region::Edges, Region::Wide]);
    let shared = si(model, &draw(model, region, random));
    let mut fast = fast_inputs(model);
    random.shuffle(&mut fast);
    // Often one only: a model may keep what the designs of a batch have in common.
    fast.truncate(if random.chance(0.3) { 1 } else { random.whole(1, fast.len()) });
    let designs: Vec<_> = (0..count)
        .map(|_| {
            let other = si(model, &draw(model, region, random));
            let mut design = shared.clone();
            fast.iter().for_each(|&input| design[input] = other[input]);
            design
        })
        .collect();
    let padded = count.next_multiple_of(LANES);
    let column = |input: usize| (0..padded).map(|lane| designs[lane.min(count - 1)][input]).collect();
    let varying: Vec<(usize, Vec<f64>)> = fast.iter().map(|&input| (input, column(input))).collect();
    let mut outputs: Vec<usize> = (0..model.outputs.len()).collect();
    random.shuffle(&mut outputs);
    outputs.truncate(random.below(outputs.len() + 1));
    let conditions: Vec<usize> = (0..model.conditions.len()).filter(|_| random.chance(0.5)).collect();
    let prepared = model.kernel.prepared(&shared);
    let mut results = vec![vec![f64::NAN; padded]; outputs.len() + conditions.len()];
    let columns = Columns { count, varying: &varying, outputs: &outputs, conditions: &conditions };
    model.kernel.finish_columns(&prepared, &shared, &columns, scratch, &mut results);
    columns.to_units(&model.outputs, &mut results);
    let wanted = Set::of(&outputs);
    for (lane, design) in designs.iter().enumerate() {
        let scalar = model.kernel.outputs(&prepared, design, wanted);
        let margins = model.kernel.margins(&prepared, design);
        let of_outputs = outputs.iter().map(|&output| (&model.outputs[output].name, model.outputs[output].unit.from_si(scalar[output])));
        let of_conditions = conditions.iter().map(|&condition| (&model.conditions[condition].reason, margins[condition]));
        for ((name, expected), found) in of_outputs.chain(of_conditions).zip(&results) {
            let (expected, found) = (spoil(expected), found[lane]);
            if expected.to_bits() != found.to_bits() && !(expected.is_nan() && found.is_nan()) {
                return Some(format!("{}: {name} of lane {lane} of {count} is {found:e}, alone {expected:e}", model.name));
            }
        }
    }
    None
}

#[test]
fn a_batch_has_the_same_bits_as_its_designs_alone() {
    // What one batch leaves behind must not show in the next.
    let mut scratches: Vec<_> = models::all().iter().map(|model| Scratch::new(model.inputs.len(), &*model.kernel)).collect();
    let random = &mut Random::new(51);
    let counts: Vec<usize> = (0..40).flat_map(|_| 1..=17).collect();
    for (done, &count) in counts.iter().enumerate() {
        for (model, scratch) in models::all().iter().zip(&mut scratches) {
            // Of a slow model some batches, of all lengths.
            let every = counts.len() as u64 / evaluations(model, counts.len() as u64);
            if (done as u64).is_multiple_of(every) {
                assert_eq!(differing(model, count, scratch, random, |value| value), None);
            }
        }
    }
}

#[test]
fn a_last_bit_is_noticed_in_a_batch() {
    let random = &mut Random::new(52);
    for model in models::all() {
        let tried = evaluations(model, 50);
        let noticed = (0..tried)
            .filter(|_| differing(model, 9, &mut Scratch::new(model.inputs.len(), &*model.kernel), random, f64::next_up).is_some())
            .count();
        assert!(noticed as u64 * 5 > tried * 4, "{}: {noticed} of {tried}", model.name);
    }
}

#[test]
fn every_model_has_inputs_that_its_first_stage_does_not_read() {
    for model in models::all() {
        assert!(!fast_inputs(model).is_empty(), "{}", model.name);
    }
}
