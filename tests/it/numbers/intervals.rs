//! The formulas over intervals: the values of every design of a box are within those of the box, in f64 and exactly, and f64 is within its
//! error bound of the exact values.

use super::boxes::{Sides, a_box, around, everything, formulas, inner, on_a_boundary, over, run_over, sample};
use super::precise::Precise;
use super::{meaningful_si, outputs_si, si};
use crate::physics::{Region, draw};
use crate::random::Random;
use beltspace::models::{Model, Set, Status, evaluate};
use beltspace::tape::{EVERYTHING, Interval};

const REGIONS: [Region; 3] = [Region::Usual, Region::Wide, Region::Edges];
const WIDTHS: [f64; 6] = [0.0, 1e-12, 1e-9, 1e-3, 0.05, 0.5];

type Both = (Vec<Interval>, Vec<Interval>);

/// Is this what f64 may compute? A NaN only where nothing is known.
fn holds(interval: Interval, value: f64) -> bool {
    if value.is_nan() { interval == EVERYTHING } else { interval.contains(value) }
}

/// The first output or margin of a design that f64 computes outside.
fn outside(model: &Model, inputs: &[f64], intervals: &Both) -> Option<String> {
    let si = si(model, inputs);
    let margins = model.kernel.margins(&model.kernel.prepared(&si), &si);
    let outputs = outputs_si(model, &si);
    let outputs = model.outputs.iter().map(|output| &output.name).zip(&intervals.0).zip(outputs);
    let margins = model.conditions.iter().map(|condition| &condition.reason).zip(&intervals.1).zip(margins);
    let ((name, interval), value) = outputs.chain(margins).find(|&((_, interval), value)| !holds(*interval, value))?;
    Some(format!("{name} = {value:?} is not in {interval:?}: {inputs:?}"))
}

fn check(model: &Model, sides: &Sides, random: &mut Random) {
    let intervals = run_over(model, &over(model, sides));
    for _ in 0..20 {
        let inputs = sample(model, sides, random);
        assert_eq!(outside(model, &inputs, &intervals), None, "{} in {sides:?}", model.name);
    }
}

#[test]
fn no_design_of_a_box_leaves_the_intervals() {
    for model in formulas() {
        let random = &mut Random::new(21);
        for (region, width) in REGIONS.into_iter().flat_map(|region| WIDTHS.map(|width| (region, width))) {
            for _ in 0..100 {
                check(model, &a_box(model, region, width, random), random);
            }
        }
        for _ in 0..20 {
            check(model, &everything(model), random);
        }
    }
}

#[test]
fn no_design_about_a_boundary_leaves_the_intervals() {
    for model in formulas() {
        let random = &mut Random::new(24);
        for width in WIDTHS {
            for _ in 0..50 {
                check(model, &on_a_boundary(model, width, random), random);
            }
        }
    }
}

/// Middle and end of what was measured.
fn median_and_most(mut values: Vec<f64>) -> (f64, f64) {
    values.sort_by(f64::total_cmp);
    (values[values.len() / 2], values[values.len() * 95 / 100])
}

#[test]
fn the_intervals_of_small_boxes_are_narrow() {
    for model in formulas() {
        for (width, median_limit, most_limit) in [(0.0, 1e-12, 1e-9), (1e-9, 1e-7, 1e-4)] {
            let random = &mut Random::new(22);
            let mut widths: Vec<f64> = Vec::new();
            for _ in 0..500 {
                let sides = around(model, &draw(model, Region::Usual, random), width, random);
                let outputs = run_over(model, &over(model, &sides)).0;
                let middle = sides.iter().map(|(low, high)| 0.5 * (low + high)).collect::<Vec<_>>();
                let present =
                    meaningful_si(model, &middle).into_iter().zip(outputs).filter(|(value, _)| value.is_some_and(|value| value != 0.0));
                widths.extend(present.map(|(value, interval)| interval.width() / value.unwrap_or(1.0).abs()));
            }
            let (median, most) = median_and_most(widths);
            eprintln!("{}: relative widths {median:.1e} (median), {most:.1e} (95 %) of boxes of {width:e}", model.name);
            assert!(median < median_limit && most < most_limit, "{}: {median:e} {most:e}", model.name);
        }
    }
}

#[test]
fn designs_of_another_box_are_noticed() {
    for model in formulas() {
        let random = &mut Random::new(23);
        let mut noticed = 0;
        for _ in 0..200 {
            let sides = a_box(model, Region::Usual, 0.05, random);
            // The intervals of a box a tenth as wide do not hold what the whole box has.
            let intervals = run_over(model, &over(model, &inner(model, &sides)));
            noticed += usize::from((0..20).any(|_| outside(model, &sample(model, &sides, random), &intervals).is_some()));
        }
        assert!(noticed > 100, "{}: {noticed}", model.name);
    }
}

/// What the errors of many boxes look like beside those that f64 really has.
#[derive(Default)]
struct Errors {
    checked: usize,
    broken: usize,
    example: String,
    /// Bounds relative to the value.
    relative: Vec<f64>,
    /// Largest share of a bound that was used.
    used: f64,
}

impl Errors {
    /// Compares f64 with more precise values of designs of the box, with every bound divided by `shrink`.
    fn compare(&mut self, model: &Model, sides: &Sides, shrink: f64, random: &mut Random) {
        let (outputs, margins) = run_over(model, &over(model, sides));
        for _ in 0..4 {
            let inputs = sample(model, sides, random);
            let si = si(model, &inputs);
            let precise = run_over(model, &si.iter().copied().map(Precise::from).collect::<Vec<_>>());
            let reference = run_over(model, &si);
            let mut all: Vec<_> = (0..model.outputs.len()).map(|at| (outputs[at], reference.0[at], precise.0[at])).collect();
            let meaningful = meaningful_si(model, &inputs);
            for (at, value) in all.iter_mut().enumerate().filter(|(at, _)| meaningful[*at].is_none()) {
                // Without a meaning there may be no exact value: a radius beyond its bracket.
                value.2 = Precise::from(reference.0[at]);
            }
            if evaluate(model, &inputs).status == Status::Ok {
                all.extend((0..model.conditions.len()).map(|at| (margins[at], reference.1[at], precise.1[at])));
            }
            for (number, (interval, value, exact)) in all.into_iter().enumerate() {
                if value.is_nan() || !value.is_finite() {
                    continue;
                }
                self.checked += 1;
                let error = exact.distance(value);
                if error > interval.error / shrink || !interval.contains(exact.rounded()) {
                    self.broken += 1;
                    self.example = format!("number {number} is {value:e}, off by {error:e} of {interval:?}: {inputs:?} of {sides:?}");
                }
                if interval.error > 0.0 {
                    self.used = self.used.max(error / interval.error);
                }
                if value != 0.0 {
                    self.relative.push(interval.error / value.abs());
                }
            }
        }
    }
}

#[test]
fn f64_is_as_near_to_the_exact_value_as_the_error_says() {
    for model in formulas() {
        for region in REGIONS {
            let random = &mut Random::new(25);
            let mut errors = Errors::default();
            for width in WIDTHS {
                for _ in 0..40 {
                    let sides = a_box(model, region, width, random);
                    errors.compare(model, &sides, 1.0, random);
                }
                for _ in 0..10 {
                    let sides = on_a_boundary(model, width, random);
                    errors.compare(model, &sides, 1.0, random);
                }
            }
            assert_eq!(errors.broken, 0, "{} {region:?}: {} of {}, {}", model.name, errors.broken, errors.checked, errors.example);
            eprintln!("{} {region:?}: {} values, at most {:.3} of an error used", model.name, errors.checked, errors.used);
        }
        let random = &mut Random::new(26);
        let mut errors = Errors::default();
        for _ in 0..200 {
            let sides = a_box(model, Region::Usual, 1e-6, random);
            errors.compare(model, &sides, 1.0, random);
        }
        let (median, most) = median_and_most(errors.relative);
        eprintln!("{}: relative errors {median:.1e} (median), {most:.1e} (95 %)", model.name);
        assert!(median < 1e-10, "{}: {median:e}", model.name);
    }
}

#[test]
fn an_error_ten_thousand_times_too_small_is_noticed() {
    for model in formulas() {
        let random = &mut Random::new(27);
        let mut errors = Errors::default();
        for _ in 0..100 {
            let sides = a_box(model, Region::Usual, 0.0, random);
            errors.compare(model, &sides, 1e4, random);
        }
        assert!(errors.broken > errors.checked / 100, "{}: {} of {}", model.name, errors.broken, errors.checked);
    }
}

#[test]
fn the_recorded_formula_gives_the_bits_of_the_formula() {
    for model in formulas() {
        let random = &mut Random::new(28);
        let mut checked = 0;
        for region in [Region::Usual, Region::Wide, Region::Edges] {
            for _ in 0..300 {
                let inputs = si(model, &draw(model, region, random));
                let prepared = model.kernel.prepared(&inputs);
                let outputs = model.kernel.outputs(&prepared, &inputs, Set::ALL);
                let margins = model.kernel.margins(&prepared, &inputs);
                let (found, found_margins) = run_over(model, &inputs);
                for (number, (found, expected)) in found.iter().zip(outputs).chain(found_margins.iter().zip(margins)).enumerate() {
                    let same = found.to_bits() == expected.to_bits() || (found.is_nan() && expected.is_nan());
                    assert!(same, "{}: number {number} is {found:e}, the formula gives {expected:e}: {inputs:?}", model.name);
                    checked += 1;
                }
            }
        }
        assert!(checked > 900 * model.outputs.len(), "{}: {checked}", model.name);
    }
}
