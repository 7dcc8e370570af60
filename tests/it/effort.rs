//! How many evaluations a test may make of a model: thousands of a formula, a few of a solver.

use beltspace::models::{self, Model};

/// Seconds that the repeated evaluations of one test may take, by the model's own figures.
const SECONDS: f64 = 0.2;

/// As many evaluations as wanted, or as many as there is time for.
pub fn evaluations(model: &Model, wanted: u64) -> u64 {
    let affordable = SECONDS / (model.effort.prepare + model.effort.finish);
    wanted.min(affordable as u64)
}

/// Is the model too slow to be evaluated thousands of times?
pub fn is_slow(model: &Model) -> bool {
    evaluations(model, 1000) < 1000
}

#[test]
fn formulas_are_tried_as_often_as_wanted_and_solvers_less() {
    for model in models::all() {
        assert_eq!(is_slow(model), !model.on_gpu, "{}", model.name);
        assert!(evaluations(model, 20_000) == 20_000 || is_slow(model), "{}", model.name);
        assert!(evaluations(model, 10) == 10, "{}: too slow for any test", model.name);
    }
}
