//! A model with all elementary functions, for the tests of what is made of a recorded formula: its shader, and what a device computes.

use crate::random::Random;
use beltspace::models::{Condition, Fields, Formula, Input, Model, Output, Range, Set, Worse};
use beltspace::real::{Real, Smoothness};
use beltspace::record;
use beltspace::units::NONE;
use std::sync::Arc;

record!(Inputs { exponent, positive, fraction, x, y, step });
record!(Prepared { turned, whole });
record!(Outputs { exp, ln, log10, tanh, tan, acos, atan, atan2, hypot, floor, ceil, round, root });

/// How far its outputs may be off, in units of their error bounds.
pub const BOUND_FACTOR: f64 = 4.0;

struct EveryFunction;

impl Formula for EveryFunction {
    const FIELDS: Fields = Fields::new(Inputs::NAMES, Prepared::NAMES, Outputs::NAMES, 1);

    fn prepare<R: Real>(inputs: &[R], _wanted: Set, prepared: &mut [R]) {
        let i = Inputs::read(inputs);
        Prepared { turned: i.fraction.acos(), whole: (i.step + R::constant(100.0)).floor() }.write(prepared);
    }

    fn conditions<R: Real>(_prepared: &[R::Shared], inputs: &[R], _wanted: Set, margins: &mut [R]) {
        margins[0] = Inputs::read(inputs).positive;
    }

    fn finish<R: Real>(prepared: &[R::Shared], inputs: &[R], _wanted: Set, outputs: &mut [R]) {
        let (i, p) = (Inputs::read(inputs), Prepared::<R>::shared(prepared));
        // The function of this root has a floor of its own, which is zero in the whole bracket: in the search it stands in plain f32.
        let root =
            R::monotone_root((R::constant(1.0), R::constant(1000.0)), R::constant(10.0), Smoothness::Unknown, [p.whole], |[whole], at| {
                (at + (at / R::constant(1048576.0)).floor() - whole, R::constant(1.0))
            });
        Outputs {
            exp: i.exponent.exp(),
            ln: i.positive.ln(),
            log10: i.positive.log10(),
            tanh: i.x.tanh(),
            tan: i.fraction.tan(),
            acos: p.turned,
            atan: i.x.atan(),
            atan2: i.y.atan2(i.x),
            hypot: i.x.hypot(i.y),
            floor: i.step.floor(),
            ceil: i.step.ceil(),
            round: i.step.round(),
            root: root + i.step.floor(),
        }
        .write(outputs);
    }
}

/// The model.
pub fn every_function() -> Arc<Model> {
    let input = |name: &str, low: f64, high: f64| {
        Input::new(name, name, NONE, 0.5, (low, high), "An argument.", "chosen").valid(Range::between(-1e6, 1e6))
    };
    // A function of an input alone may use up the error bound of its argument, so that what rounds in the bound itself shows.
    let output = |name: &&str| Output::new(*name, *name, NONE, Worse::Higher, "its name", "A function.").with_bound_factor(BOUND_FACTOR);
    let model = Model::new("every-function", EveryFunction)
        .inputs([
            input("exponent", -80.0, 80.0),
            input("positive", 1e-3, 1e3),
            input("fraction", -1.0, 1.0),
            input("x", -4.0, 4.0),
            input("y", -4.0, 4.0),
            input("step", -30.0, 30.0),
        ])
        .outputs(Outputs::NAMES.iter().map(output).collect::<Vec<_>>())
        .conditions([Condition::new("not positive", true, &["ln", "log10"], "A logarithm is taken of what is above zero.")]);
    Arc::new(model)
}

/// Arguments all over their ranges, many of them at or near whole numbers, at ends and kinks.
pub fn arguments(model: &Model, count: usize, seed: u64) -> Vec<Vec<f64>> {
    let random = &mut Random::new(seed);
    let one = |input: &Input, random: &mut Random| {
        let (low, high) = input.usual;
        let value = if low > 0.0 { random.log_between(low, high) } else { random.between(low, high) };
        let beside = random.log_between(1e-12, 1e-3) * random.pick(&[1.0, -1.0]);
        match random.below(6) {
            0 => value.round().clamp(low, high),
            1 => (value.round() + beside).clamp(low, high),
            2 => ((2.0 * value).round() / 2.0 + beside).clamp(low, high),
            3 if low < 0.0 => beside,
            _ => value,
        }
    };
    (0..count).map(|_| model.inputs.iter().map(|input| one(input, random)).collect()).collect()
}
