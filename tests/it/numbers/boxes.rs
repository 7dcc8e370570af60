//! Boxes of designs, and designs of a box.

use super::bounds::onto_a_boundary;
use super::si;
use crate::physics::{Region, draw};
use crate::random::Random;
use beltspace::models::{self, Input, Model, Set};
use beltspace::real::Real;
use beltspace::tape::Interval;
use beltspace::tape::{Known, List};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::{Mutex, PoisonError};

/// The least and the largest value of every input, in its unit. A word may lie below the numbers: then it is one of the values.
pub type Sides = Vec<(f64, f64)>;

/// The models that are formulas over any number type.
pub fn formulas() -> impl Iterator<Item = &'static Arc<Model>> {
    models::all().iter().filter(|model| model.kernel.formula().is_some())
}

/// A model's formula from its inputs to outputs and conditions, recorded once for each number of iterations that its whole numbers allow.
fn list(model: &Model, iterations: Vec<usize>) -> &'static List {
    static LISTS: Mutex<BTreeMap<(String, Vec<usize>), &'static List>> = Mutex::new(BTreeMap::new());
    let mut lists = LISTS.lock().unwrap_or_else(PoisonError::into_inner);
    // Studies with formulas have models of one name.
    let name = format!("{} {:?}", model.name, model.formulas());
    lists.entry((name, iterations.clone())).or_insert_with(|| {
        let formula = model.kernel.formula().expect("it is a formula");
        let known = |(input, &most): (&Input, &usize)| if input.integer { Known::Within(0.0, most as f64) } else { Known::ANY };
        let known: Vec<Known> = model.inputs.iter().zip(&iterations).map(known).collect();
        Box::leak(Box::new(formula.whole(&known, Set::ALL, Set::ALL).list(Set::ALL, Set::ALL)))
    })
}

/// Outputs and conditions over inputs of any number type, by the recorded formula.
pub fn run_over<R: Real<Shared = R>>(model: &Model, inputs: &[R]) -> (Vec<R>, Vec<R>) {
    let iterations = model.inputs.iter().zip(inputs).map(|(input, value)| if input.integer { value.iterations(60) } else { 0 }).collect();
    let mut outputs = list(model, iterations).run(inputs);
    let conditions = outputs.split_off(outputs.len() - model.kernel.sizes().conditions);
    (outputs, conditions)
}

/// A box around a design, as wide as `width` relative to every value; an input stays as it is where `width` is 0 or its value a word.
pub fn around(model: &Model, centre: &[f64], width: f64, random: &mut Random) -> Sides {
    let side = |(input, &value): (&Input, &f64)| {
        if input.word_for(value).is_some() || width == 0.0 {
            return (value, value);
        }
        let reach = value.abs().max(1e-3 * input.usual.1) * width * random.unit();
        let (low, high) = (value - reach, value + reach);
        let (low, high) = if input.integer { (low.ceil(), high.floor()) } else { (low, high) };
        let accepted = |end: f64| if input.valid.contains(end) { end } else { value };
        (accepted(low), accepted(high))
    };
    model.inputs.iter().zip(centre).map(side).collect()
}

/// As [`around`], about a design drawn from the region; some boxes take in a word beside numbers, or several whole numbers.
pub fn a_box(model: &Model, region: Region, width: f64, random: &mut Random) -> Sides {
    let mut sides = around(model, &draw(model, region, random), width, random);
    if width > 0.0 {
        for (side, input) in sides.iter_mut().zip(&model.inputs) {
            if let (Some(&(_, word)), true) = (input.words.first(), random.chance(0.1)) {
                let high = if input.is_enumeration() { input.words[input.words.len() - 1].1 } else { random.between(0.0, input.usual.1) };
                *side = (word.min(high), word.max(high));
            } else if input.integer && random.chance(0.1) {
                side.1 = (side.1 + random.whole(1, 3) as f64).min(input.usual.1.max(side.1));
            }
        }
    }
    sides
}

/// Everything that the inputs accept, about a few times beyond what is usual.
pub fn everything(model: &Model) -> Sides {
    let side = |input: &Input| {
        if input.is_enumeration() {
            return (input.words[0].1, input.words[input.words.len() - 1].1);
        }
        let low = if input.integer { input.usual.0 } else { 0.2 * input.usual.0 };
        let high = if input.integer { input.usual.1 } else { 2.0 * input.usual.1 };
        let accepted = |end: f64, usual: f64| if input.valid.contains(end) { end } else { usual };
        let low = input.words.iter().fold(accepted(low, input.usual.0), |low, &(_, word)| low.min(word));
        (low, accepted(high, input.usual.1))
    };
    model.inputs.iter().map(side).collect()
}

/// A box that the boundary of the designs with status ok goes through.
pub fn on_a_boundary(model: &Model, width: f64, random: &mut Random) -> Sides {
    let centre = std::iter::repeat_with(|| onto_a_boundary(model, random)).flatten().next().expect("every model has a boundary");
    around(model, &centre, width, random)
}

/// The box in SI units.
pub fn over(model: &Model, sides: &Sides) -> Vec<Interval> {
    let ends = |end: fn(&(f64, f64)) -> f64| si(model, &sides.iter().map(end).collect::<Vec<_>>());
    let (low, high) = (ends(|side| side.0), ends(|side| side.1));
    low.into_iter().zip(high).map(|(low, high)| Interval::new(low, high)).collect()
}

/// A design of the box: on one of its corners, inside, or on a face.
pub fn sample(model: &Model, sides: &Sides, random: &mut Random) -> Vec<f64> {
    let at_ends = random.pick(&[1.0, 0.5, 0.0]);
    let mut value = |(input, &(low, high)): (&Input, &(f64, f64))| {
        let word = input.words.iter().map(|&(_, word)| word).find(|word| (low..=high).contains(word));
        if let (Some(_), true) = (word, input.is_enumeration()) {
            return if random.chance(0.5) { low } else { high };
        }
        if let (Some(word), true) = (word, low == high || random.chance(0.4)) {
            return word;
        }
        let low = if word.is_some() { 0.0 } else { low };
        let share = if random.chance(at_ends) { random.pick(&[0.0, 1.0]) } else { random.unit() };
        let value = if share == 1.0 { high } else { (low + share * (high - low)).clamp(low, high) };
        if input.integer { value.round() } else { value }
    };
    model.inputs.iter().zip(sides).map(&mut value).collect()
}

/// The box a tenth as wide about the same middle; words and whole numbers stay.
pub fn inner(model: &Model, sides: &Sides) -> Sides {
    let side = |(input, &(low, high)): (&Input, &(f64, f64))| {
        let (middle, half) = (0.5 * (low + high), 0.05 * (high - low));
        if input.integer || !input.words.is_empty() { (low, high) } else { (middle - half, middle + half) }
    };
    model.inputs.iter().zip(sides).map(side).collect()
}
