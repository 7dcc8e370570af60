//! The formulas over intervals: no design of a box leaves what the box gives.

use super::interval::Interval;
use super::{meaningful_si, si};
use crate::physics::{Region, draw};
use crate::random::Random;
use beltspace::models::{CONDITIONS, Formula, INPUTS, MODELS, Model, OUTPUTS, Visitor, find, run, visit};
use beltspace::real::Real;

/// The models that are formulas over any number type.
fn formulas() -> impl Iterator<Item = &'static Model> {
    struct Any;
    impl Visitor for Any {
        type Output = ();
        fn visit<F: Formula>(self) {}
    }
    MODELS.iter().copied().filter(|model| visit(model.name, Any).is_some())
}

/// Both stages over a box.
struct OverBox([Interval; INPUTS]);

impl Visitor for OverBox {
    type Output = ([Interval; OUTPUTS], [Interval; CONDITIONS]);
    fn visit<F: Formula>(self) -> Self::Output {
        run::<F, Interval>(&self.0)
    }
}

/// A box of designs around one, in the inputs' units; a word stays what it is.
fn a_box(model: &Model, width: f64, random: &mut Random) -> Vec<(f64, f64)> {
    let centre = draw(model, Region::Usual, random);
    let side = |(input, value): (&beltspace::models::Input, f64)| {
        let reach = value * width * random.unit();
        if input.word_for(value).is_some() { (value, value) } else { (value - reach, (value + reach).min(input.valid.high)) }
    };
    model.inputs.iter().zip(centre).map(side).collect()
}

fn interval_outputs(model: &Model, sides: &[(f64, f64)]) -> [Interval; OUTPUTS] {
    let ends = |end: fn(&(f64, f64)) -> f64| si(model, &sides.iter().map(end).collect::<Vec<_>>());
    let (low, high) = (ends(|side| side.0), ends(|side| side.1));
    let mut inputs = [Interval::constant(0.0); INPUTS];
    for (input, (&low, &high)) in inputs.iter_mut().zip(low.iter().zip(&high)) {
        *input = Interval::new(low, high);
    }
    visit(model.name, OverBox(inputs)).expect("every model of the list can be visited").0
}

/// A design of the box: inside, or on one of its corners.
fn sample(sides: &[(f64, f64)], random: &mut Random) -> Vec<f64> {
    let corner = random.chance(0.5);
    let side = |&(low, high): &(f64, f64)| {
        let share = if corner { random.pick(&[0.0, 1.0]) } else { random.unit() };
        if share == 1.0 { high } else { (low + share * (high - low)).min(high) }
    };
    sides.iter().map(side).collect()
}

/// The first output of a design that is outside.
fn outside(model: &Model, inputs: &[f64], outputs: &[Interval; OUTPUTS]) -> Option<String> {
    let values = meaningful_si(model, inputs);
    let left = values.iter().zip(outputs).position(|(value, interval)| value.is_some_and(|value| !interval.contains(value)))?;
    Some(format!("{} = {:?} is not in {:?}: {inputs:?}", model.outputs[left].name, values[left], outputs[left]))
}

#[test]
fn no_design_of_a_box_leaves_the_intervals() {
    for model in formulas() {
        for width in [0.0, 1e-9, 1e-3, 0.05, 0.5] {
            let random = &mut Random::new(21);
            for _ in 0..500 {
                let sides = a_box(model, width, random);
                let outputs = interval_outputs(model, &sides);
                for _ in 0..20 {
                    let inputs = sample(&sides, random);
                    assert_eq!(outside(model, &inputs, &outputs), None, "{} in a box of width {width}: {sides:?}", model.name);
                }
            }
        }
    }
}

#[test]
fn the_intervals_of_small_boxes_are_narrow() {
    for model in formulas() {
        let random = &mut Random::new(22);
        let mut widths: Vec<f64> = Vec::new();
        for _ in 0..500 {
            let sides = a_box(model, 1e-9, random);
            let outputs = interval_outputs(model, &sides);
            let middle = sides.iter().map(|(low, high)| 0.5 * (low + high)).collect::<Vec<_>>();
            let present =
                meaningful_si(model, &middle).into_iter().zip(outputs).filter(|(value, _)| value.is_some_and(|value| value != 0.0));
            widths.extend(present.map(|(value, interval)| interval.width() / value.unwrap_or(1.0).abs()));
        }
        widths.sort_by(f64::total_cmp);
        let (median, most) = (widths[widths.len() / 2], widths[widths.len() * 95 / 100]);
        eprintln!("{}: relative widths {median:.1e} (median), {most:.1e} (95 %)", model.name);
        assert!(median < 1e-7 && most < 1e-4, "{}: {median:e} {most:e}", model.name);
    }
}

#[test]
fn designs_of_another_box_are_noticed() {
    for model in formulas() {
        let random = &mut Random::new(23);
        let mut noticed = 0;
        for _ in 0..200 {
            let sides = a_box(model, 0.05, random);
            // The intervals of a box a tenth as wide do not hold what the whole box has.
            let inner: Vec<_> = sides
                .iter()
                .map(|(low, high)| {
                    let (middle, half) = (0.5 * (low + high), 0.05 * (high - low));
                    (middle - half, middle + half)
                })
                .collect();
            let outputs = interval_outputs(model, &inner);
            noticed += usize::from((0..20).any(|_| outside(model, &sample(&sides, random), &outputs).is_some()));
        }
        assert!(noticed > 100, "{}: {noticed}", model.name);
    }
}

#[test]
fn a_visitor_reaches_every_model_and_no_other_name() {
    struct Name;
    impl Visitor for Name {
        type Output = [f64; OUTPUTS];
        fn visit<F: Formula>(self) -> Self::Output {
            let model = find("rubber-cvt").expect("it is a model");
            let inputs = si(model, &model.defaults());
            run::<F, f64>(&inputs).0
        }
    }
    let all: Vec<_> = formulas().map(|model| visit(model.name, Name).expect("it is a formula").map(f64::to_bits)).collect();
    // The same numbers mean something else to every model.
    assert!(all.iter().enumerate().all(|(at, outputs)| !all[..at].contains(outputs)));
    assert_eq!(visit("no-model", Name), None);
}
