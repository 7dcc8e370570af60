//! A walker that is wrong somewhere, or a bound that is, must be noticed by the comparison with the crate.

use super::asked::{parsed, walked};
use super::walk::Slip;
use super::{Drawn, TOLERANCE, drawn};
use crate::pipeline::answer::Answer;
use crate::pipeline::expected::Expected;
use crate::pipeline::runs::Pipeline;
use beltspace::plan::Plan;
use beltspace::study::Study;
use beltspace::sweep::Settings;

/// Most studies that are looked through for one that a mistake matters in.
const MOST: u64 = 60;

/// What the crate says of a study.
fn found(drawn: &Drawn) -> Answer {
    let plan = Plan::new(parsed(&drawn.whole.text, drawn.folder.path()));
    let pipeline = Pipeline::new(&plan, &drawn.whole.text);
    let folder = tempfile::tempdir().expect("a folder can be made");
    pipeline.write(pipeline.whole(&Settings::default()), 1, folder.path());
    Answer::read(folder.path())
}

#[test]
fn a_wrong_operator_function_curve_or_status_is_noticed() {
    let slips = [
        Slip::Function("max", "min"),
        Slip::Function("tanh", "atan"),
        Slip::Function("floor", "ceil"),
        Slip::Operator('+', '-'),
        Slip::Operator('*', '/'),
        Slip::CurveEnd,
        Slip::NearWhole,
        Slip::AbsentIsZero,
        Slip::NoRanges,
    ];
    let mut left = slips.to_vec();
    for seed in 1..=MOST {
        let drawn = drawn(seed);
        let of = |slip: Slip| Expected::new(&drawn.whole.study, &walked(&drawn.whole.study, &drawn.around.walker.with(0, Some(slip))));
        let matter = |slip: &Slip| of(*slip).answer.difference_beyond(TOLERANCE, &drawn.expected.answer).is_some();
        let here: Vec<Slip> = left.iter().copied().filter(matter).collect();
        if here.is_empty() {
            continue;
        }
        let found = found(&drawn);
        assert_eq!(drawn.expected.answer.difference_beyond(TOLERANCE, &found), None, "seed {seed}");
        for slip in here {
            assert!(of(slip).answer.difference_beyond(TOLERANCE, &found).is_some(), "seed {seed}: {slip:?} is not noticed");
            left.retain(|it| *it != slip);
        }
        if left.is_empty() {
            break;
        }
    }
    assert!(left.is_empty(), "no study is another with {left:?}");
}

#[test]
fn a_bound_that_is_off_is_noticed() {
    // The worst feasible value becomes the bound, and no longer keeps it.
    let shifted = |drawn: &Drawn| -> Option<Study> {
        let mut study = drawn.whole.study.clone();
        let constraint = study.constraints.iter_mut().find(|it| it.high.is_some())?;
        let feasible = drawn.expected.feasible.iter();
        let values = feasible.flat_map(|&design| drawn.whole.evaluated.cases(design)).filter_map(|case| case.value(constraint.quantity));
        let largest = values.fold(f64::NEG_INFINITY, f64::max);
        constraint.high = Some((largest, true));
        largest.is_finite().then_some(study)
    };
    let (drawn, study) = (1..).map(drawn).find_map(|drawn| shifted(&drawn).map(|study| (drawn, study))).expect("some study has a bound");
    let other = Expected::new(&study, &drawn.whole.evaluated);
    assert!(other.feasible.len() < drawn.expected.feasible.len());
    let found = found(&drawn);
    assert_eq!(drawn.expected.answer.difference_beyond(TOLERANCE, &found), None);
    assert!(other.answer.difference_beyond(TOLERANCE, &found).is_some());
}
