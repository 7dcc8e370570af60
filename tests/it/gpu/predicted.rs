//! The device against the recorded formula: the bounds that the list of operations gives hold for what the device computes, though the
//! device never saw them.

use super::{device, shipped};
use crate::every_function::{BOUND_FACTOR, arguments, every_function};
use crate::numbers::{meaningful_si, run_over, si};
use crate::physics::{Region, draw};
use crate::random::Random;
use beltspace::gpu::PointKernel;
use beltspace::models::{self, CONDITION_BOUND_FACTOR, Model};
use beltspace::plan::Plan;
use beltspace::study::Study;
use beltspace::tape::RunningError;
use beltspace::verify::compare;
use std::sync::Arc;

const DESIGNS: usize = 20_000;

/// What came of a comparison, over all outputs and conditions.
#[derive(Default)]
struct Compared {
    values: usize,
    /// Values that the device itself says nothing of: f64 decides about these.
    left_to_f64: usize,
    /// Others of which the list can say nothing.
    unbounded: usize,
    /// Values farther from f64 than the bound.
    broken: usize,
    /// The first of these, in words.
    example: Option<String>,
}

impl Compared {
    fn take(&mut self, name: &str, found: RunningError, exact: f64, bound: f64, inputs: &[f64]) {
        if found.bound.is_infinite() {
            self.left_to_f64 += 1;
            return;
        }
        self.values += 1;
        let found = found.value;
        if bound.is_infinite() {
            self.unbounded += 1;
            return;
        }
        // f64 rounds too, though nine orders of magnitude less.
        let error = (f64::from(found) - exact).abs() - 1e-13 * exact.abs();
        if error.is_nan() || error > bound {
            self.broken += 1;
            self.example.get_or_insert_with(|| format!("{name} is {found:e}, in f64 {exact:e}, bound {bound:e}: {inputs:?}"));
        }
    }
}

/// Compares a device with f64: each value may be off by the bound of the list, times what decisions allow for, over `divisor`.
fn compared(model: &Arc<Model>, designs: &[Vec<f64>], divisor: f64) -> Compared {
    compared_on(&PointKernel::new(&device().device, model, &[]).expect("the kernel compiles"), model, designs, divisor)
}

/// The same with this kernel.
fn compared_on(kernel: &PointKernel, model: &Arc<Model>, designs: &[Vec<f64>], divisor: f64) -> Compared {
    let points: Vec<_> = designs.iter().map(|inputs| si(model, inputs)).collect();
    let found = kernel.evaluate(&points).expect("the device works");
    let mut all = Compared::default();
    for ((inputs, point), (outputs, margins)) in designs.iter().zip(&points).zip(&found) {
        let (listed, listed_margins) = run_over(model, &point.iter().copied().map(RunningError::input).collect::<Vec<_>>());
        for (number, exact) in meaningful_si(model, inputs).into_iter().enumerate() {
            let output = &model.outputs[number];
            if let Some(exact) = exact.filter(|it| it.is_finite()) {
                all.take(&output.name, outputs[number], exact, listed[number].bound * output.bound_factor / divisor, inputs);
            }
        }
        let mut exact = vec![0.0; model.kernel.sizes().conditions];
        model.kernel.conditions(&model.kernel.prepared(point), point, &mut exact);
        for (number, condition) in model.conditions.iter().enumerate().filter(|(number, _)| exact[*number].is_finite()) {
            let bound = listed_margins[number].bound * CONDITION_BOUND_FACTOR / divisor;
            all.take(&condition.reason, margins[number], exact[number], bound, inputs);
        }
    }
    all
}

fn recorded() -> impl Iterator<Item = &'static Arc<Model>> {
    models::all().iter().filter(|model| model.on_device().is_ok())
}

/// Random designs of a model.
fn random_designs(model: &Model, region: Region, seed: u64) -> Vec<Vec<f64>> {
    let random = &mut Random::new(seed);
    (0..DESIGNS).map(|_| draw(model, region, random)).collect()
}

#[test]
fn what_a_device_computes_lies_within_the_bounds_of_the_recorded_formula() {
    for model in recorded() {
        for region in [Region::Usual, Region::Wide, Region::Edges] {
            let found = compared(model, &random_designs(model, region, 31), 1.0);
            assert_eq!((found.broken, found.example), (0, None), "{} {region:?}", model.name);
            assert!(found.values > DESIGNS * model.outputs.len() / 4, "{} {region:?}: only {} values", model.name, found.values);
            if region == Region::Usual {
                let (none, all) = (found.unbounded, found.values);
                assert!(found.left_to_f64 < all / 2, "{}: {} of {all} are left to f64", model.name, found.left_to_f64);
                assert!(none * 100 < all, "{}: {none} of {all} have no bound", model.name);
            }
        }
    }
}

#[test]
fn what_a_device_computes_of_the_shipped_studies_lies_within_the_bounds_of_the_recorded_formula() {
    let mut studies = 0;
    for path in shipped() {
        let (study, _) = Study::read(&path).expect("the study is right");
        if study.model.on_device().is_err() {
            continue;
        }
        studies += 1;
        let plan = Plan::new(study);
        let (model, random) = (&plan.study.model, &mut Random::new(32));
        let any = |random: &mut Random, count: u64| ((random.unit() * count as f64) as u64).min(count - 1);
        let designs: Vec<_> = (0..DESIGNS).map(|_| plan.space.inputs(any(random, plan.designs()), any(random, plan.scenarios()))).collect();
        let found = compared(model, &designs, 1.0);
        assert_eq!((found.broken, found.example), (0, None), "{}", path.display());
        assert!(found.values > 10 * found.unbounded, "{}: {} of {} have no bound", path.display(), found.unbounded, found.values);
    }
    assert!(studies >= 3, "{studies}");
}

#[test]
fn a_bound_a_thousand_times_too_small_is_noticed_on_a_device() {
    for model in recorded() {
        let found = compared(model, &random_designs(model, Region::Usual, 33), 1000.0);
        assert!(found.broken > found.values / 10, "{}: only {} of {}", model.name, found.broken, found.values);
    }
}

/// The kernel of the model with all elementary functions, with other pieces of text in place of some of its own.
fn with_functions(model: &Arc<Model>, pieces: &[(&str, &str)]) -> PointKernel {
    let mut source = PointKernel::source(model, &[]).expect("it has a kernel");
    for (piece, other) in pieces {
        assert!(source.contains(piece), "the kernel has no {piece}");
        source = source.replace(piece, other);
    }
    PointKernel::from_source(&device().device, model, &source).expect("the kernel compiles")
}

#[test]
fn elementary_functions_on_a_device_lie_within_the_bounds_of_the_list_and_their_own() {
    let model = every_function();
    let kernel = with_functions(&model, &[]);
    let designs = arguments(&model, 3 * DESIGNS, 34);
    // The bounds of the list are in f64 and hold as they are.
    let found = compared_on(&kernel, &model, &designs, BOUND_FACTOR);
    assert_eq!((found.broken, found.example), (0, None));
    let (all, values) = (designs.len() * (model.outputs.len() + 1), found.values);
    assert!(values * 20 > all * 19 && found.unbounded * 50 < values, "{values} of {all}, {} without a bound", found.unbounded);
    let report = compare(&kernel, &model, &[], &designs.into()).expect("the device works");
    for it in &report.outputs {
        eprintln!("{}: at most {:.3} of a bound, median bound {:.1e}", it.name, it.used, it.median_bound);
    }
    report.require().expect("the device's own bounds hold");
}

#[test]
fn wrong_elementary_functions_on_a_device_are_noticed() {
    let model = every_function();
    let designs = arguments(&model, DESIGNS, 35);
    // Their values, by the bounds of the list.
    for (piece, other) in [
        ("let value = floor(a.value);", "let value = round(a.value);"),
        ("let value = floor(a.value);", "let value = floor(a.value + 1e-4);"),
        ("constant(709.0)", "constant(60.0)"),
        ("constant(32.0)", "constant(2.0)"),
    ] {
        let found = compared_on(&with_functions(&model, &[(piece, other)]), &model, &designs, BOUND_FACTOR);
        assert!(found.broken > 50, "{piece} -> {other}: {}", found.broken);
    }
    let found = compared(&model, &designs, 1000.0);
    assert!(found.broken > found.values / 10, "only {} of {}", found.broken, found.values);
    // The bound that a device finds itself: a whole number within the bound of the argument must not be passed over.
    let blind = with_functions(&model, &[("select(ceil(a.bound), 0.0, sure)", "0.0")]);
    let report = compare(&blind, &model, &[], &designs.into()).expect("the device works");
    let broken: Vec<_> = report.outputs.iter().filter(|it| it.broken > 0).map(|it| it.name.as_str()).collect();
    assert!(["floor", "ceil", "round"].iter().all(|name| broken.contains(name)), "only {broken:?} object");
}
