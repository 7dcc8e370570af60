//! The error bounds: at least four times as large as the errors, small enough to be of use, and checks that notice violations.

use super::{device, shipped};
use crate::physics::{Region, draw};
use crate::random::Random;
use beltspace::gpu::PointKernel;
use beltspace::models::{self, Model};
use beltspace::plan::Plan;
use beltspace::study::Study;
use beltspace::verify::{VerifyReport, compare, points_of_model, points_of_study};
use std::sync::Arc;

/// The largest fraction of its bound that an error may reach.
const SPARE: f64 = 0.25;

fn kernel(model: &Arc<Model>) -> PointKernel {
    PointKernel::new(&device().device, model, &[]).expect("the kernel compiles")
}

fn assert_kept(report: &VerifyReport, what: &str) {
    assert_eq!((report.flips, &report.flip), (0, &None), "{what}");
    let each = || report.outputs.iter().chain(&report.conditions);
    let broken: Vec<_> = each().filter_map(|it| it.example.clone()).collect();
    assert_eq!(broken, Vec::<String>::new(), "{what}");
    let close: Vec<_> = each().filter(|it| it.used > SPARE).map(|it| format!("{} takes {:.3}", it.name, it.used)).collect();
    assert_eq!(close, Vec::<String>::new(), "{what}: more than a quarter of the error bound");
}

#[test]
fn no_error_of_any_output_exceeds_a_quarter_of_its_bound() {
    for model in models::all().iter().filter(|model| model.on_gpu) {
        let kernel = kernel(model);
        let report = compare(&kernel, model, &[], &points_of_model(model, 200_000, 1)).expect("the device works");
        assert_kept(&report, &model.name);
        for it in &report.outputs {
            assert!(it.values > 10_000, "{}: only {} values of {}", model.name, it.values, it.name);
            // A quarter of the points lie on a boundary, where some things become infinite.
            assert!(it.unbounded * 20 < it.values, "{}: {} of {} have no bound", model.name, it.unbounded, it.name);
            assert!(it.median_bound < 1e-4, "{}: the error bound of {} is {:e}", model.name, it.name, it.median_bound);
        }
        assert!(report.unsure * 10 < report.points, "{}: {} unsure of {}", model.name, report.unsure, report.points);
        assert!(report.unsure > 100, "{}: points on both sides of a boundary are unsure", model.name);
        // Far beyond the usual ranges bounds may be wide, but never wrong.
        for region in [Region::Wide, Region::Edges] {
            let random = &mut Random::new(21);
            let points: Vec<_> = (0..20_000).map(|_| draw(model, region, random)).collect();
            let report = compare(&kernel, model, &[], &points.into()).expect("the device works");
            assert_kept(&report, &format!("{} {region:?}", model.name));
        }
    }
}

#[test]
fn the_shipped_studies_are_decided_as_in_f64_on_both_sides_of_their_constraints() {
    for path in shipped() {
        let (study, _) = Study::read(&path).expect("the study is right");
        let plan = Plan::new(study);
        let kernel = kernel(&plan.study.model);
        let report = compare(&kernel, &plan.study.model, &plan.study.constraints, &points_of_study(&plan, 40_000, 2)).expect("it works");
        assert_kept(&report, &path.display().to_string());
        let bounded = !plan.study.constraints.is_empty();
        assert!((report.unsure > 0) == bounded && report.unsure * 4 < report.points, "{}: {} unsure", path.display(), report.unsure);
    }
}

#[test]
fn more_teeth_than_a_table_holds_touch_no_other_point() {
    // Up to 100 teeth in mesh by the formula, in tables of 61 numbers: such a point has no value, and what it writes must stay its own.
    let text = include_str!("../formulas/camshaft.toml");
    let text = with(text, "to = 40", "to = 200");
    let plan = Plan::new(Study::parse_in(&text, "study.toml", "tests/it/formulas".as_ref()).unwrap_or_else(|errors| panic!("{errors}")));
    let kernel = kernel(&plan.study.model);
    let points = points_of_study(&plan, 40_000, 2);
    let report = compare(&kernel, &plan.study.model, &plan.study.constraints, &points).expect("the device works");
    report.require().unwrap_or_else(|error| panic!("{error}"));
    let source = PointKernel::source(&plan.study.model, &[]).expect("it has a kernel");
    let is_write = |line: &str| line.trim_start().starts_with("set_") && line.contains("(min(whole(");
    let unlimited = |line: &str| if is_write(line) { line.replace(", 60u)", ", 9999u)") } else { line.to_owned() };
    let beyond: Vec<String> = source.lines().map(unlimited).collect();
    let beyond = beyond.join("\n");
    assert_ne!(beyond.trim_end(), source.trim_end());
    let kernel = PointKernel::from_source(&device().device, &plan.study.model, &beyond).expect("it compiles all the same");
    let report = compare(&kernel, &plan.study.model, &plan.study.constraints, &points).expect("the device works");
    assert!(report.require().is_err(), "nobody notices that other points are written over");
}

/// The text with one piece replaced.
fn with(text: &str, piece: &str, other: &str) -> String {
    assert!(text.contains(piece), "the shader has no {piece}");
    text.replace(piece, other)
}

#[test]
fn a_device_that_flushes_reciprocals_keeps_the_error_bounds() {
    // As some hardware divides: by a product with the reciprocal, which is flushed to zero for divisors above 2^126. No model comes
    // near the other end, 2^-126, for which src/tape/error_bound.rs has a test.
    let flushed = "let inverse = 1.0 / b.value;\n    let quotient = a.value * select(inverse, 0.0, abs(inverse) < FLUSH);";
    for model in models::all().iter().filter(|model| model.on_gpu) {
        let source = with(&PointKernel::source(model, &[]).expect("it has a kernel"), "let quotient = a.value / b.value;", flushed);
        let compared = |source: &str| {
            let kernel = PointKernel::from_source(&device().device, model, source).expect("the kernel compiles");
            let random = &mut Random::new(21);
            let points: Vec<_> = (0..20_000).map(|_| draw(model, Region::Wide, random)).collect();
            compare(&kernel, model, &[], &points.into()).expect("the device works")
        };
        assert_kept(&compared(&source), &model.name);
        if model.name == "rubber-cvt" {
            let blind = with(&source, "const LARGEST_DIVISOR: f32 = 8.507059e37;", "const LARGEST_DIVISOR: f32 = 3.4e38;");
            assert!(compared(&blind).flips > 0, "a bound that trusts such a division is wrong, and nobody notices");
        }
    }
}
