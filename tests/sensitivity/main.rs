//! Sensitivity against closed forms.

use beltspace::probability::{Distribution, ProbabilityProblem};
use beltspace::sensitivity::{morris_screening, shapley_effects, sobol_indices};
use std::f64::consts::PI;

const DRAWS: u64 = 1 << 16;

/// The indices are within five standard errors of the closed form, and these are small.
fn assert_indices(inputs: &[(&str, Distribution)], quantity: impl Fn(&[f64]) -> f64, first: &[f64], total: &[f64], error: f64) {
    let indices = sobol_indices(inputs, DRAWS, 3, quantity).unwrap();
    assert_eq!(indices.len(), first.len());
    for ((index, first), total) in indices.iter().zip(first).zip(total) {
        for (estimate, truth) in [(index.first, *first), (index.total, *total)] {
            let sigma = estimate.standard_error.unwrap_or(0.0);
            assert!(sigma < error, "{}: {estimate:?}", index.name);
            assert!((estimate.mean - truth).abs() <= 5.0 * sigma + 1e-4, "{}: {estimate:?} {truth}", index.name);
        }
    }
}

#[test]
fn indices_of_ishigami_are_those_of_the_closed_form() {
    let (a, b) = (7.0, 0.1);
    let angle = || Distribution::uniform(-PI, PI).unwrap();
    let one = 0.5 * (1.0 + b * PI.powi(4) / 5.0).powi(2);
    let (two, both) = (a * a / 8.0, 8.0 * b * b * PI.powi(8) / 225.0);
    let variance = one + two + both;
    let first = [one / variance, two / variance, 0.0];
    let total = [(one + both) / variance, two / variance, both / variance];
    let ishigami = |x: &[f64]| x[0].sin() + a * x[1].sin().powi(2) + b * x[2].powi(4) * x[0].sin();
    assert_indices(&[("x1", angle()), ("x2", angle()), ("x3", angle())], ishigami, &first, &total, 0.005);
}

#[test]
fn indices_of_the_g_function_are_those_of_the_closed_form() {
    let a = [0.0, 1.0, 4.5, 9.0, 99.0];
    let part = a.map(|a: f64| 1.0 / (3.0 * (1.0 + a).powi(2)));
    let all: f64 = part.iter().map(|part| 1.0 + part).product();
    let first = part.map(|part| part / (all - 1.0));
    let total = part.map(|part| part * all / (1.0 + part) / (all - 1.0));
    let names = ["x1", "x2", "x3", "x4", "x5"];
    let inputs = names.map(|name| (name, Distribution::uniform(0.0, 1.0).unwrap()));
    let g = |x: &[f64]| x.iter().zip(a).map(|(x, a)| ((4.0 * x - 2.0).abs() + a) / (1.0 + a)).product();
    assert_indices(&inputs, g, &first, &total, 0.01);
}

#[test]
fn indices_of_a_sum_are_the_shares_of_the_variances() {
    let inputs = [("a", Distribution::normal(1e3, 3.0).unwrap()), ("b", Distribution::normal(-50.0, 2.0).unwrap())];
    // Coefficients 2 and -1: variances 36 and 4.
    assert_indices(&inputs, |x| 2.0 * x[0] - x[1], &[0.9, 0.1], &[0.9, 0.1], 0.005);
}

#[test]
#[should_panic(expected = "0.85")]
fn a_comparison_with_a_closed_form_notices_a_wrong_one() {
    let inputs = [("a", Distribution::normal(0.0, 3.0).unwrap()), ("b", Distribution::normal(0.0, 1.0).unwrap())];
    assert_indices(&inputs, |x| x[0] + x[1], &[0.85, 0.1], &[0.9, 0.1], 0.005);
}

/// Var(E(Y | these)) of a sum of correlated normal numbers with coefficients 1: of Y = X1 + X2 + X3 after Iooss and Prieur (2019).
fn explained(set: u32, sd3: f64, r: f64) -> f64 {
    // X1 is independent with variance 1; X2 and X3 have the correlation r and the deviations 1 and sd3.
    let own = if set & 1 == 1 { 1.0 } else { 0.0 };
    own + match set >> 1 {
        0 => 0.0,
        1 => (1.0 + r * sd3).powi(2),
        2 => (sd3 + r).powi(2),
        _ => 1.0 + sd3 * sd3 + 2.0 * r * sd3,
    }
}

#[test]
fn shapley_effects_of_correlated_inputs_are_those_of_the_closed_form() {
    for (sd3, r) in [(2.0, 0.9), (2.0, -0.5), (1.0, 0.0)] {
        let effects = shapley_effects(3, |set| explained(set, sd3, r)).unwrap();
        // For this case: beta1^2 sigma1^2, and half of r^2 sigma^2 of the other goes over to each of the two.
        let shared = r * sd3;
        let half = 0.5 * r * r;
        let (two, three) = (1.0 + shared + half * (sd3 * sd3 - 1.0), sd3 * sd3 + shared + half * (1.0 - sd3 * sd3));
        for (effect, truth) in effects.iter().zip([1.0, two, three]) {
            assert!((effect - truth).abs() < 1e-12, "{effects:?}");
        }
        assert!((effects.iter().sum::<f64>() - explained(7, sd3, r)).abs() < 1e-12, "they add up");
    }
    // Of independent inputs an interaction is shared equally: Y = X1 X2 with means 0 explains nothing before both are known.
    assert_eq!(shapley_effects(2, |set| f64::from(u8::from(set == 3))).unwrap(), [0.5, 0.5]);
    // Twelve voters of whom seven decide have equal power.
    let power = shapley_effects(12, |set| f64::from(u8::from(set.count_ones() >= 7))).unwrap();
    assert!(power.iter().all(|it| (it - 1.0 / 12.0).abs() < 1e-12));
}

#[test]
fn morris_tells_slopes_interactions_and_what_does_nothing() {
    let inputs = [("friction", 0.1, 0.3), ("load_N", 400.0, 600.0), ("idle", -1.0, 1.0)];
    let linear = morris_screening(&inputs, 50, 1, |x| 20.0 * x[0] - 0.5 * x[1]).unwrap();
    for (effects, slope) in linear.iter().zip([4.0, -100.0, 0.0]) {
        assert!(
            (effects.mean - slope).abs() < 1e-10 && (effects.mean_absolute - slope.abs()).abs() < 1e-10 && effects.sd < 1e-10,
            "{effects:?}"
        );
    }
    // The effect of one is the value of the other, one of 0, 1/3, 2/3, 1: a mean of a half, a deviation of sqrt(5)/6.
    let product = morris_screening(&[("a", 0.0, 1.0), ("b", 0.0, 1.0)], 10_000, 1, |x| x[0] * x[1]).unwrap();
    for effects in product {
        assert!((effects.mean - 0.5).abs() < 0.02 && (effects.sd - 5f64.sqrt() / 6.0).abs() < 0.01, "{effects:?}");
    }
    // Effects of both signs cancel in the mean and not in the mean of their sizes: x (1 - x) over two thirds, from 0 or 1/3.
    let hump = &morris_screening(&[("a", 0.0, 1.0)], 10_000, 1, |x| x[0] * (1.0 - x[0])).unwrap()[0];
    assert!(hump.mean.abs() < 0.02 && (hump.mean_absolute - 1.0 / 3.0).abs() < 1e-12, "{hump:?}");
}

#[test]
fn what_has_no_answer_is_refused() {
    let unit = || Distribution::uniform(0.0, 1.0).unwrap();
    let said = |problem: ProbabilityProblem| problem.to_string();
    assert_eq!(
        said(sobol_indices(&[("a", unit())], 100, 1, |x| x[0]).unwrap_err()),
        "sobol: 100 draws cannot be divided into 16 replicates of a power of two each; take 128 draws"
    );
    assert_eq!(
        said(sobol_indices(&[("a", unit())], 16, 1, |_| 3.0).unwrap_err()),
        "the quantity is the same in all draws, so that no input can matter; name one that varies"
    );
    let absent = said(sobol_indices(&[("a", unit())], 16, 1, |_| f64::NAN).unwrap_err());
    assert_eq!(absent, "the quantity has no value in draw 0; name one that has a value in every draw, or narrow the inputs");
    assert!(matches!(morris_screening(&[("a", 0.0, 1.0)], 5, 1, |x| 1.0 / (x[0] - 1.0)), Err(ProbabilityProblem::Absent { .. })));
    assert_eq!(said(shapley_effects(21, |_| 0.0).unwrap_err()), "shapley: inputs is 21, and must be between 1 and 20");
    assert_eq!(
        said(morris_screening(&[("a", 0.0, 1.0)], 1, 1, |x| x[0]).unwrap_err()),
        "morris: trajectories is 1, and must be at least 2"
    );
    assert_eq!(
        said(morris_screening(&[("a", 1.0, 0.0)], 5, 1, |x| x[0]).unwrap_err()),
        "uniform: from is 1, and must be below to, which is 0"
    );
}
