//! Derivatives of the formulas: at a design, and bounds of them over a box.

use super::boxes::{Sides, a_box, around, formulas, over, run_over, sample};
use super::{meaningful_si, si};
use crate::physics::{Region, draw};
use crate::random::Random;
use beltspace::models::Model;
use beltspace::real::Real;
use beltspace::tape::{Dual, Interval};

/// More directions than any formula has inputs.
const DIRECTIONS: usize = 32;
type Slopes = (Vec<Dual<Interval, DIRECTIONS>>, Vec<Dual<Interval, DIRECTIONS>>);

/// Values and slopes with every input's own direction.
fn derived<T: Real<Shared = T>>(model: &Model, inputs: Vec<T>) -> (Vec<Dual<T, DIRECTIONS>>, Vec<Dual<T, DIRECTIONS>>) {
    assert!(model.inputs.len() <= DIRECTIONS);
    run_over(model, &inputs.into_iter().enumerate().map(|(input, value)| Dual::variable(value, input)).collect::<Vec<_>>())
}

/// Is the status surely ok all over the box?
fn surely_ok(model: &Model, margins: &[Dual<Interval, DIRECTIONS>]) -> bool {
    model
        .conditions
        .iter()
        .zip(margins)
        .all(|(condition, margin)| condition.quiet || margin.value.low > 0.0 || !condition.strict && margin.value.low >= 0.0)
}

/// Inputs that are numbers all over the box: a word is no place to go from.
fn movable(model: &Model, sides: &Sides) -> Vec<usize> {
    let is_movable = |input: &usize| {
        let (low, high) = sides[*input];
        let table = &model.inputs[*input];
        low < high && !table.integer && table.words.iter().all(|&(_, word)| !(low..=high).contains(&word))
    };
    (0..sides.len()).filter(is_movable).collect()
}

/// What chords of the box say of its slopes.
#[derive(Default, Debug)]
struct Chords {
    checked: usize,
    finite: usize,
    /// Chords of outputs that surely grow or fall.
    signed: usize,
    broken: usize,
    example: String,
}

impl Chords {
    /// Two designs that differ in one input differ in an output by as much as some slope between says. `turned`: with slopes of the
    /// wrong sign, which must be noticed.
    fn check(&mut self, model: &Model, sides: &Sides, slopes: &Slopes, turned: bool, random: &mut Random) {
        let inputs = movable(model, sides);
        if inputs.is_empty() {
            return;
        }
        for _ in 0..10 {
            let mut ends = [sample(model, sides, random), sample(model, sides, random)];
            let input = random.pick(&inputs);
            ends[1] = ends[0].clone();
            let (low, high) = sides[input];
            let inside = random.between(low, high);
            ends[1][input] = random.pick(&[low, high, inside]);
            let [from, to] = ends.each_ref().map(|end| (si(model, end)[input], meaningful_si(model, end)));
            let step = to.0 - from.0;
            if step == 0.0 {
                continue;
            }
            for (number, values) in from.1.iter().zip(&to.1).enumerate() {
                let (Some(a), Some(b)) = values else { continue };
                let Interval { error, .. } = slopes.0[number].value;
                let slope = slopes.0[number].slopes[input];
                let slope = if turned { -slope } else { slope };
                self.checked += 1;
                self.finite += usize::from(slope.is_finite());
                self.signed += usize::from(slope.low > 0.0 || slope.high < 0.0);
                // The chord itself is computed from what f64 rounds.
                let doubt = (2.0 * error + 4.0 * f64::EPSILON * (a.abs() + b.abs())) / step.abs();
                let chord = (b - a) / step;
                let is_ordered = slope.low < 0.0 || (b - a) * step.signum() >= -2.0 * error;
                if chord < slope.low - doubt || chord > slope.high + doubt || !is_ordered {
                    self.broken += 1;
                    self.example = format!(
                        "{} by {}: a chord of {chord:e} +- {doubt:e}, slopes {slope:?}: {ends:?} of {sides:?}",
                        model.outputs[number].name, model.inputs[input].name
                    );
                }
            }
        }
    }
}

#[test]
fn every_chord_of_a_box_is_as_steep_as_some_slope() {
    for model in formulas() {
        for width in [1e-6, 1e-3, 0.05, 0.5] {
            let random = &mut Random::new(31);
            let (mut chords, mut boxes) = (Chords::default(), 0);
            for at in 0..300 {
                let region = [Region::Usual, Region::Wide, Region::Edges][at % 3];
                let sides = a_box(model, region, width, random);
                let slopes = derived(model, over(model, &sides));
                if surely_ok(model, &slopes.1) {
                    boxes += 1;
                    chords.check(model, &sides, &slopes, false, random);
                }
            }
            eprintln!("{} {width:e}: {boxes} boxes, {chords:?}", model.name);
            assert_eq!(chords.broken, 0, "{}: {}", model.name, chords.example);
            if width <= 1e-3 {
                assert!(boxes > 50 && chords.finite * 10 > chords.checked * 8, "{} {width:e}: {boxes} {chords:?}", model.name);
            }
        }
    }
}

#[test]
fn slopes_of_the_wrong_sign_are_noticed() {
    for model in formulas() {
        let random = &mut Random::new(32);
        let mut chords = Chords::default();
        for _ in 0..100 {
            let sides = around(model, &draw(model, Region::Usual, random), 1e-3, random);
            let slopes = derived(model, over(model, &sides));
            if surely_ok(model, &slopes.1) {
                chords.check(model, &sides, &slopes, true, random);
            }
        }
        assert!(chords.broken * 10 > chords.signed * 9 && chords.signed > 100, "{}: {chords:?}", model.name);
    }
}

#[test]
fn the_slopes_at_designs_are_among_those_of_their_box_and_close_to_those_of_a_small_one() {
    for model in formulas() {
        let random = &mut Random::new(33);
        let (mut close, mut all) = (0, 0);
        for width in [0.0, 1e-6, 1e-3, 0.05] {
            for _ in 0..100 {
                let sides = around(model, &draw(model, Region::Usual, random), width, random);
                let slopes = derived(model, over(model, &sides));
                if !surely_ok(model, &slopes.1) {
                    continue;
                }
                for _ in 0..5 {
                    let inputs = sample(model, &sides, random);
                    let here = derived(model, si(model, &inputs)).0;
                    for (number, value) in meaningful_si(model, &inputs).iter().enumerate() {
                        for direction in (0..model.inputs.len()).filter(|_| value.is_some()) {
                            let (slope, bounds) = (here[number].slopes[direction], slopes.0[number].slopes[direction]);
                            let rounding = 1e-12 * slope.abs();
                            assert!(
                                bounds.low - rounding <= slope && slope <= bounds.high + rounding,
                                "{}: {} by {} is {slope:e}, not in {bounds:?}: {inputs:?} of {sides:?}",
                                model.name,
                                model.outputs[number].name,
                                model.inputs[direction].name
                            );
                            if width == 0.0 && slope != 0.0 {
                                all += 1;
                                close += usize::from(bounds.width() <= 1e-8 * slope.abs());
                            }
                        }
                    }
                }
            }
        }
        eprintln!("{}: {close} of {all} slopes at designs are known well", model.name);
        assert!(all > 1000 && close * 10 > all * 9, "{}: {close} of {all}", model.name);
    }
}

/// The difference quotient about a design, where no condition and no choice is near.
#[test]
fn the_slopes_at_a_design_are_its_difference_quotients() {
    for model in formulas() {
        let random = &mut Random::new(34);
        let (mut checked, mut wrong) = (0, 0);
        for _ in 0..200 {
            let inputs = draw(model, Region::Usual, random);
            let here = derived(model, si(model, &inputs)).0;
            let input = random.below(inputs.len());
            if model.inputs[input].integer || model.inputs[input].word_for(inputs[input]).is_some() || inputs[input] <= 0.0 {
                continue;
            }
            let beside = |factor: f64| {
                let mut beside = inputs.clone();
                beside[input] *= factor;
                (si(model, &beside)[input], meaningful_si(model, &beside))
            };
            let (from, to) = (beside(1.0 - 1e-5), beside(1.0 + 1e-5));
            for (number, values) in from.1.iter().zip(&to.1).enumerate() {
                let (Some(a), Some(b)) = values else { continue };
                let slope = here[number].slopes[input];
                let quotient = (b - a) / (to.0 - from.0);
                checked += 1;
                let doubt = 1e-5 * (slope.abs() + quotient.abs()) + 1e-9 * (a.abs() + b.abs()) / (to.0 + from.0).abs();
                wrong += usize::from((slope - quotient).abs() > doubt);
            }
        }
        eprintln!("{}: {wrong} of {checked} slopes are none of a quotient", model.name);
        // A design beside a jump or a kink, of which there are few.
        assert!(checked > 500 && wrong * 50 < checked, "{}: {wrong} of {checked}", model.name);
    }
}
