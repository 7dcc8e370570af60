//! A walker that is wrong somewhere, or a bound that is, must be noticed by the comparison with the crate.

use super::asked::{parsed, walked};
use super::measure::bracket;
use super::tree::{Named, Tree};
use super::walk::{Slip, Walker};
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

/// Few random quotients come out just below a whole number: here many do.
#[test]
fn a_number_just_below_a_whole_one_that_is_not_taken_as_that_one_is_noticed() {
    let text = "model = \"timing-belt\"\n[design]\ntip_radius_mm = { from = 60, to = 70, count = 101 }\n\
                [formulas]\ntenths = \"floor(tip_radius_mm / 0.1[mm])\"\n[objectives]\ntenths = \"max\"\n[report]\nvariants = true\n";
    let study = parsed(text, ".".as_ref());
    let mut walker = Walker::new(beltspace::models::find("timing-belt").expect("it is a model"));
    // The first unit of length is the millimetre.
    let millimetre = bracket([0, 1, 0, 0, 0, 0], |limit| if limit == 4 { 1 } else { 0 });
    let quotient = Tree::binary('/', Tree::name("tip_radius_mm"), Tree::Number(0.1, millimetre));
    walker.formulas.push(Named { name: "tenths".to_owned(), tree: Tree::Call("floor", vec![quotient]) });
    assert_eq!(walker.formulas[0].tree.to_string(), "floor(tip_radius_mm / 0.1[mm])");
    let plan = Plan::new(parsed(text, ".".as_ref()));
    let pipeline = Pipeline::new(&plan, text);
    let folder = tempfile::tempdir().expect("a folder can be made");
    pipeline.write(pipeline.whole(&Settings::default()), 1, folder.path());
    let found = Answer::read(folder.path());
    let difference = |slip| Expected::new(&study, &walked(&study, &walker.with(0, slip))).answer.difference_beyond(TOLERANCE, &found);
    assert_eq!(difference(None), None);
    assert!(difference(Some(Slip::NearWhole)).is_some());
}
