//! The slopes with which roots are found.

use super::super::evaluate::at;
use super::super::typed::Typed;
use super::*;
use crate::real::Smoothness;

#[test]
fn slopes_are_those_of_difference_quotients() {
    let bodies = [
        "r + 2 * r - 3 - -r",
        "r * r * r",
        "1 / r",
        "(r + 1) / (r^2 + 1)",
        "r^3",
        "r^8",
        "r^-2",
        "r^2.5",
        "r^-0.7",
        "2^r",
        "r^r",
        "sqrt(r)",
        "exp(r)",
        "exp_m1(r)",
        "ln(r)",
        "log10(r)",
        "ln_1p(r)",
        "tanh(r)",
        "sin(r * 2[rad])",
        "cos(r * 2[rad])",
        "tan(r * 1[rad])",
        "asin(r / 3) / 1[rad]",
        "acos(r / 3) / 1[rad]",
        "atan(r) / 1[rad]",
        "atan2(r, 2 - r) / 1[rad]",
        "atan2(-r, r - 4) / 1[rad]",
        "hypot(r, 2 * r - 1)",
        "min(r, 2 - r, 3)",
        "max(r, 2 - r, 0.5)",
        "clamp(r^2, 0.2, 2)",
        "abs(r - 1)",
        "if(r < 1, r^2, 3 * r)",
        "if(1 >= r, r^2, 3 * r)",
        "slip(r * 8[m/s])",
        "default(r^2, 3)",
        "r + floor(3.5) * r",
    ];
    let scope = scope();
    let mut compared = 0;
    for body in bodies {
        let text = format!("root(r, 0, 10, {body})");
        let formulas = Formulas::new(&scope, &sources(&[("it", &text)])).unwrap_or_else(|problems| panic!("{text}: {}", problems[0]));
        let of = |x: f64| at(&formulas.all()[0].typed, &scope.curves, x);
        for x in [0.3, 0.77, 1.1, 1.6, 2.2] {
            let (_, slope) = of(x);
            let quotient = (of(x + 1e-6).0 - of(x - 1e-6).0) / 2e-6;
            assert!((slope - quotient).abs() <= 1e-7 * (1.0 + quotient.abs()), "{body} at {x}: {slope} and {quotient}");
            compared += usize::from(slope != 0.0);
        }
    }
    assert!(compared > 150, "{compared}");
}

#[test]
fn an_expression_is_smooth_where_nothing_of_the_unknown_has_a_corner() {
    let scope = scope();
    let is_smooth = |body: &str| {
        let text = format!("root(r, 0, 10, {body})");
        let formulas = Formulas::new(&scope, &sources(&[("it", &text)])).unwrap_or_else(|problems| panic!("{text}: {}", problems[0]));
        let Typed::Root(.., smoothness) = &formulas.all()[0].typed else { panic!("{text} is no root") };
        *smoothness == Smoothness::Smooth
    };
    for body in
        ["r^3 - 2", "exp_m1(r) - 1 / r", "sqrt(r) * asin(r / 11) / 1[rad] - max(2, 3) * r", "r + floor(3.5) * r", "ln_1p(r) - abs(-2)"]
    {
        assert!(is_smooth(body), "{body}");
    }
    for body in [
        "max(r, 2 * r - 1) - 3",
        "r + exp(min(r, 1))",
        "r - 2 + abs(r - 1) / 2",
        "clamp(r, 1, 2) + r",
        "if(r < 1, r, 2 * r - 1) - 2",
        "r + slip(r * 8[m/s])",
        "r + default(r, 1)",
    ] {
        assert!(!is_smooth(body), "{body}");
    }
}
