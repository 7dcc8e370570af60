use crate::golden::{distribution, number, rows};
use beltspace::Error;
use beltspace::probability::{Distribution, ProbabilityProblem};

/// As near as SciPy itself is: it computes quantiles of the upper tail from 1 - p, and the beta distribution to 12 digits or so.
const TOLERANCE: f64 = 1e-11;

/// The largest difference to `golden`, relative to the size of the numbers.
fn difference(value: f64, golden: f64) -> f64 {
    (value - golden).abs() / golden.abs().max(1e-300)
}

#[test]
fn quantiles_and_moments_are_those_of_scipy() {
    for row in rows("quantile") {
        let [name, from, to, p, golden] = row[..] else { panic!("{row:?}") };
        let (law, p, golden) = (distribution(name, from, to), number(p), number(golden));
        let value = law.quantile(p).unwrap();
        // What one rounding of p moves the value by: the median of a symmetric distribution can be no nearer to 0 than that.
        let blur = (law.quantile((p + 2e-16).min(1.0 - 1e-16)).unwrap() - law.quantile(p - 2e-16).unwrap()).abs();
        assert!(
            difference(value, golden) < TOLERANCE || (value - golden).abs() < 2.0 * blur,
            "{name} {from}..{to} at {p}: {value}, {golden}"
        );
        // The way back, by the other function.
        let back = law.cdf(value);
        assert!((back - p).abs() < 1e-13 || difference(back, p) < 1e-9, "{name} {from}..{to}: {p} came back as {back}");
    }
    for row in rows("moments") {
        let [name, from, to, mean, sd] = row[..] else { panic!("{row:?}") };
        let law = distribution(name, from, to);
        assert!(difference(law.mean(), number(mean)) < TOLERANCE, "{name} {from}..{to}: mean {}, {mean}", law.mean());
        assert!(difference(law.sd(), number(sd)) < TOLERANCE, "{name} {from}..{to}: sd {}, {sd}", law.sd());
    }
}

#[test]
fn a_comparison_with_scipy_notices_a_wrong_digit() {
    let row = rows("quantile").into_iter().find(|row| row[0] == "gumbel 150 12").expect("there is one");
    let value = distribution(row[0], row[1], row[2]).quantile(number(row[3])).unwrap();
    assert!(difference(value * (1.0 + 1e-10), number(row[4])) > TOLERANCE);
}

#[test]
fn closed_moments_are_the_integrals_that_a_truncation_takes() {
    // A truncation far outside keeps everything, but goes by the integral where there is no truncation by a closed form.
    let wide = [
        (Distribution::normal(3.0, 0.5), -20.0, 30.0),
        (Distribution::lognormal(2.0, 0.4), 1e-6, 1e6),
        (Distribution::beta(2.0, 3.5, 1.0, 2.0), 0.0, 3.0),
        (Distribution::gumbel(150.0, 12.0), -1e5, 1e5),
    ];
    for (law, from, to) in wide {
        let law = law.unwrap();
        let cut = law.clone().truncated(from, to).unwrap();
        assert!(difference(cut.mean(), law.mean()) < 1e-12, "{law:?}: {} {}", cut.mean(), law.mean());
        assert!(difference(cut.sd(), law.sd()) < 1e-12, "{law:?}: {} {}", cut.sd(), law.sd());
    }
}

#[test]
fn every_quantile_rises_and_stays_within_the_truncation() {
    for row in rows("moments") {
        let law = distribution(row[0], row[1], row[2]);
        let values: Vec<_> = (1..2000).map(|i| law.quantile(f64::from(i) / 2000.0).unwrap()).collect();
        assert!(values.windows(2).all(|pair| pair[0] <= pair[1]), "{}", row[0]);
        if !row[1].is_empty() {
            let (from, to) = (number(row[1]), number(row[2]));
            assert!(values.iter().all(|value| (from..=to).contains(value)), "{}", row[0]);
            assert_eq!((law.cdf(from - 1e-3 * from.abs()), law.cdf(to)), (0.0, 1.0), "{}", row[0]);
        }
    }
}

#[test]
fn discrete_values_are_taken_by_their_weights_and_measured_ones_equally() {
    let bolts = Distribution::discrete(&[8.0, 6.0, 10.0, 6.0, 12.0], &[3.0, 1.0, 4.0, 1.0, 0.0]).unwrap();
    for (p, value) in [(0.0, 6.0), (0.2222, 6.0), (0.2223, 8.0), (0.5555, 8.0), (0.5556, 10.0), (1.0, 10.0)] {
        assert_eq!(bolts.quantile(p).unwrap(), value, "{p}");
    }
    assert_eq!([5.9, 6.0, 9.9, 10.0].map(|x| bolts.cdf(x)), [0.0, 2.0 / 9.0, 5.0 / 9.0, 1.0]);
    let mean = (2.0 * 6.0 + 3.0 * 8.0 + 4.0 * 10.0) / 9.0;
    let variance = (2.0 * 6f64.powi(2) + 3.0 * 8f64.powi(2) + 4.0 * 10f64.powi(2)) / 9.0 - mean * mean;
    assert!(difference(bolts.mean(), mean) < 1e-15 && difference(bolts.sd(), variance.sqrt()) < 1e-13);
    let large = bolts.truncated(8.0, 10.0).unwrap();
    assert_eq!([0.42, 0.43].map(|p| large.quantile(p).unwrap()), [8.0, 10.0]);

    let measured = Distribution::empirical(&[0.31, 0.28, 0.35, 0.28]).unwrap();
    assert_eq!([0.5, 0.51, 0.76].map(|p| measured.quantile(p).unwrap()), [0.28, 0.31, 0.35]);
    assert_eq!(measured, Distribution::empirical(&[0.28, 0.35, 0.28, 0.31]).unwrap(), "the order of rows does not matter");
}

#[test]
fn truncated_twice_is_truncated_to_what_both_keep() {
    let once = Distribution::normal(0.0, 1.0).unwrap().truncated(-1.0, 0.5).unwrap();
    let twice = Distribution::normal(0.0, 1.0).unwrap().truncated(-1.0, 2.0).unwrap().truncated(-3.0, 0.5).unwrap();
    assert_eq!(once, twice);
    assert_eq!(Distribution::uniform(0.0, 4.0).unwrap().truncated(1.0, 9.0), Distribution::uniform(1.0, 4.0));
}

#[test]
fn a_wrong_distribution_is_named_with_its_value_and_limit() {
    let normal = || Distribution::normal(0.08, 0.006).unwrap();
    let inf = f64::INFINITY;
    let cases: [(Result<Distribution, ProbabilityProblem>, &str); 22] = [
        (Distribution::normal(0.08, -0.006), "normal: sd is -0.006, and must be above 0 (1e-150 to 1e150)"),
        (Distribution::normal(0.08, 0.0), "normal: sd is 0, and must be above 0 (1e-150 to 1e150)"),
        (Distribution::normal(f64::NAN, 1.0), "normal: mean is NaN, and must be a number between -1e150 and 1e150"),
        (Distribution::uniform(1.15, 0.85), "uniform: from is 1.15, and must be below to, which is 0.85"),
        (Distribution::uniform(1.0, 1.0), "uniform: from is 1, and must be below to, which is 1"),
        (Distribution::uniform(-inf, 1.0), "uniform: from is -inf, and must be a number between -1e150 and 1e150"),
        (Distribution::lognormal(-1.0, 1.0), "lognormal: mean is -1, and must be above 0 (1e-150 to 1e150)"),
        (Distribution::lognormal(0.001, 2.0), "lognormal: sd is 2, and must be at most 1000 times the mean"),
        (Distribution::triangular(0.9, 1.2, 1.1), "triangular: mode is 1.2, and must be between from and to"),
        (Distribution::beta(0.0, 1.0, 0.0, 1.0), "beta: alpha is 0, and must be between 0.01 and 1e6"),
        (Distribution::beta(1.0, 2e6, 0.0, 1.0), "beta: beta is 2000000, and must be between 0.01 and 1e6"),
        (Distribution::weibull(0.01, 1.0, 0.0), "weibull: shape is 0.01, and must be between 0.1 and 1000"),
        (Distribution::gumbel(150.0, inf), "gumbel: scale is inf, and must be above 0 (1e-150 to 1e150)"),
        (Distribution::exponential(-2.0), "exponential: mean is -2, and must be above 0 (1e-150 to 1e150)"),
        (Distribution::discrete(&[1.0, 2.0, 3.0], &[1.0, 2.0]), "discrete: 3 values but 2 weights; give each value one weight"),
        (Distribution::discrete(&[1.0, 2.0], &[0.0, 0.0]), "discrete: all weights are 0; at least one must be above 0"),
        (Distribution::discrete(&[1.0], &[-1.0]), "discrete: weight is -1, and must be between 0 and 1e150"),
        (Distribution::empirical(&[]), "empirical: there are no values; give at least one"),
        (normal().truncated(0.11, 0.05), "normal: from is 0.11, and must be below to, which is 0.05"),
        (
            normal().truncated(0.8, 1.1),
            "normal: from 0.8 to 1.1 lies a probability of 0, and it must be at least 1e-9; widen from and to, or check the units",
        ),
        (
            normal().truncated(0.12, 0.2),
            "normal: from 0.12 to 0.2 lies a probability of 1.30839e-11, and it must be at least 1e-9; widen from and to, or check the units",
        ),
        (
            Distribution::discrete(&[1.0, 2.0], &[1.0, 1.0]).unwrap().truncated(1.2, 1.8),
            "discrete: from 1.2 to 1.8 lies a probability of 0, and it must be at least 1e-9; widen from and to, or check the units",
        ),
    ];
    for (made, message) in cases {
        let error = made.expect_err(message);
        assert_eq!(error.to_string(), message);
        assert_eq!(Error::from(error).exit_code(), 2);
    }
    let place = normal().quantile(1.5).expect_err("there is no such probability");
    assert_eq!(place.to_string(), "quantile: probability is 1.5, and must be between 0 and 1");
}
