//! What formulas come to: precedence, functions, statuses, absence.

use super::*;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, FRAC_PI_6, PI};

#[test]
fn operators_bind_as_in_mathematics() {
    let cases = [
        ("-3^2", -9.0),
        ("(-3)^2", 9.0),
        ("2^3^2", 512.0),
        ("2^-1", 0.5),
        ("-2^-2", -0.25),
        ("2 - 3 - 4", -5.0),
        ("2 / 4 / 2", 0.25),
        ("2 + 3 * 4", 14.0),
        ("-2 * -3", 6.0),
        ("2 * -3 + 1", -5.0),
        ("6 / 2 * 3", 9.0),
        ("1 - -1", 2.0),
        ("--2", 2.0),
        ("2 * 3^2", 18.0),
        ("4^0.5", 2.0),
        ("1.5e2 + .5 + 2.", 152.5),
        ("5 − 3", 2.0),
        ("50[%]", 0.5),
        ("0^2.5", 0.0),
        ("2^0", 1.0),
    ];
    for (text, wanted) in cases {
        let got = value("it", text, &[]);
        assert!((got - wanted).abs() <= 1e-15 * wanted.abs(), "{text} is {got}, not {wanted}");
    }
}

#[test]
fn functions_are_the_mathematical_ones() {
    // To 16 digits from tables and by hand.
    let cases = [
        ("sin(30[deg])", 0.5),
        ("cos(60[deg])", 0.5),
        ("tan(45[deg])", 1.0),
        ("sin(pi / 2 * 1[rad])", 1.0),
        ("asin(0.5) / 1[rad]", FRAC_PI_6),
        ("acos(0.5) / 1[deg]", 60.0),
        ("atan(1) / 1[rad]", FRAC_PI_4),
        ("atan2(1[mm], 1[m] - 999[mm]) / 1[rad]", FRAC_PI_4),
        ("atan2(1, -1) / 1[rad]", 0.75 * PI),
        ("atan2(-1, -1) / 1[rad]", -0.75 * PI),
        ("atan2(1, 0) / 1[rad]", FRAC_PI_2),
        ("atan2(0, 0) / 1[rad]", 0.0),
        ("hypot(3[mm], 4[mm]) / 1[mm]", 5.0),
        ("hypot(0, 0)", 0.0),
        ("exp(1)", std::f64::consts::E),
        ("ln(10)", std::f64::consts::LN_10),
        ("log10(1000)", 3.0),
        ("exp_m1(1e-10)", 1.000_000_000_05e-10),
        ("ln_1p(1e-10)", 9.999_999_999_5e-11),
        ("tanh(0.5)", 0.462_117_157_260_009_8),
        ("tanh(-0.5)", -0.462_117_157_260_009_8),
        ("abs(-2)", 2.0),
        ("min(3, 1, 2)", 1.0),
        ("max(3, 5, 4)", 5.0),
        ("clamp(5, 1, 3)", 3.0),
        ("clamp(-5, 1, 3)", 1.0),
        ("sqrt(16[mm^2]) / 1[mm]", 4.0),
        ("(8[mm^3])^(1/3) / 1[mm]", 2.0),
        ("round(2.5)", 3.0),
        ("round(-2.5)", -2.0),
        ("round(3.5)", 4.0),
        ("floor(2.7)", 2.0),
        ("floor(-2.2)", -3.0),
        ("ceil(2.2)", 3.0),
        ("ceil(-2.7)", -2.0),
        ("floor(2.9999999999)", 3.0),
        ("floor(2.999999)", 2.0),
        ("ceil(3.0000000001)", 3.0),
        ("ceil(3.000001)", 4.0),
        ("floor(0.3[mm] / 0.1[mm])", 3.0),
        ("ceil(0)", 0.0),
        ("if(1 < 2, 3, 4)", 3.0),
        ("if(2 < 2, 3, 4)", 4.0),
        ("if(2 <= 2, 3, 4)", 3.0),
        ("if(2 > 2, 3, 4)", 4.0),
        ("if(2 >= 2, 3, 4)", 3.0),
        ("if(round(2.2) == 2, 3, 4)", 3.0),
        ("if(3 == 2, 3, 4)", 4.0),
        ("root(r, 0, 10, r^3 - 2)", 1.259_921_049_894_873_2),
        ("root(r, 0[mm], 10[m], r^2 - 4[m^2]) / 1[m]", 2.0),
        ("root(r, 0[deg], 90[deg], sin(r) - 0.5) / 1[deg]", 30.0),
    ];
    for (text, wanted) in cases {
        let (got, status) = evaluated("it", text, &[]);
        assert_eq!(status, None, "{text}");
        assert!((got - wanted).abs() <= 4e-15 * wanted.abs().max(1e-3), "{text} is {got}, not {wanted}");
    }
}

#[test]
fn what_has_no_value_is_a_status_and_a_harmless_number() {
    let cases = [
        ("1 / (friction - 1)", "division by zero"),
        ("(friction - 1)^-2", "division by zero"),
        ("sqrt(friction - 2)", "root of a negative number"),
        ("ln(friction - 1)", "logarithm of a number that is not positive"),
        ("log10(friction - 1)", "logarithm of a number that is not positive"),
        ("ln_1p(friction - 2)", "logarithm of a number that is not positive"),
        ("asin(friction + 1) / 1[rad]", "arc sine of a number beyond -1 to 1"),
        ("acos(-1 - friction) / 1[rad]", "arc cosine of a number beyond -1 to 1"),
        ("(friction - 2)^0.5", "power of a negative number"),
        ("(friction - 2)^10", "power of a negative number"),
        ("(friction - 1)^-0.5", "power of a number that is not positive"),
        ("(friction - 1)^friction", "power of a number that is not positive"),
        ("exp(1000 * friction)", "exponent beyond 700"),
        ("exp_m1(1000 * friction)", "exponent beyond 700"),
        ("(10 * friction)^400", "exponent beyond 700"),
        ("slip((friction - 2) * 1[m/s])", "slip beyond its ends"),
        ("slip(friction * 21[m/s])", "slip beyond its ends"),
        ("root(r, 0, 10, r + friction)", "no root between its ends"),
        ("root(r, 0, 10, r - 11 * friction)", "no root between its ends"),
        ("root(r, 0, 10, friction - r)", "no root between its ends"),
        ("root(r, 10 * friction, 0, r - 5)", "no root between its ends"),
        ("root(r, 0, 10, r - 5 + 1 / (friction - 1))", "division by zero"),
    ];
    for (text, reason) in cases {
        let (value, status) = evaluated("it", text, &[("friction", 1.0)]);
        assert_eq!(status.as_deref(), Some(format!("formula it: {reason}").as_str()), "{text}");
        assert!(value.is_finite(), "{text} is {value}");
    }
    // The same expressions where they have a value.
    for (text, at, wanted) in [
        ("1 / (friction - 1)", 3.0, 0.5),
        ("(friction - 1)^-2", 3.0, 0.25),
        ("sqrt(friction - 1)", 1.0, 0.0),
        ("sqrt(friction - 2)", 6.0, 2.0),
        ("(friction - 2)^0.5", 2.0, 0.0),
        ("slip(friction * 10[m/s])", 0.0, 0.1),
        ("slip(friction * 10[m/s])", 0.5, 0.15),
        ("slip(friction * 10[m/s])", 1.0, 0.2),
        ("slip(friction * 10[m/s])", 1.5, 0.175),
        ("slip(friction * 10[m/s])", 2.0, 0.15),
        ("root(r, 0, 10, r - friction)", 0.0, 0.0),
        ("root(r, 0, 10, r - friction)", 10.0, 10.0),
        ("root(r, 0, 10, slip(r * 1[m/s]) + r - friction)", 2.12, 2.0),
    ] {
        let (value, status) = evaluated("it", text, &[("friction", at)]);
        assert_eq!(status, None, "{text}");
        assert!((value - wanted).abs() <= 1e-14, "{text} is {value}, not {wanted}");
    }
}

#[test]
fn a_branch_that_is_not_taken_gives_no_status() {
    let text = "if(friction > 1, 1 / (friction - 1), if(friction < 0, sqrt(friction), 7))";
    assert_eq!(evaluated("it", text, &[("friction", 1.0)]), (7.0, None));
    assert_eq!(evaluated("it", text, &[("friction", 2.0)]), (1.0, None));
    assert_eq!(evaluated("it", text, &[("friction", -1.0)]).1.as_deref(), Some("formula it: root of a negative number"));
    let both = "if(friction >= 1, sqrt(1 - friction), 1) + if(friction >= 1, 1, sqrt(friction - 1))";
    assert_eq!(evaluated("it", both, &[("friction", 1.0)]).1, None);
    assert!(evaluated("it", both, &[("friction", 2.0)]).1.is_some(), "the least margin of all occurrences counts");
    assert!(evaluated("it", both, &[("friction", 0.0)]).1.is_some());
}

#[test]
fn words_are_compared_by_their_code() {
    for (code, wanted) in [(0.0, 3.0), (1.0, 5.0)] {
        assert_eq!(value("it", "if(section == 'machined', 3, 5)", &[("section", code)]), wanted);
        assert_eq!(value("it", "if(\"pressed-cup\" == section, 5, 3)", &[("section", code)]), wanted);
    }
    for (code, wanted) in [(-1.0, 3.0), (-0.9, 5.0), (0.5, 5.0)] {
        assert_eq!(value("it", "if(traction == 'limit', 3, 5)", &[("traction", code)]), wanted);
    }
}

#[test]
fn absence_goes_on_until_a_default() {
    let scope = scope();
    let formulas = Formulas::new(
        &scope,
        &sources(&[
            ("twice", "2 * slip_margin"),
            ("either", "default(twice, 7)"),
            ("chosen", "if(friction > 0.5, slip_margin, 3)"),
            ("failing", "1 / (slip_margin * 0 + friction - friction)"),
            ("guarded", "default(slip_margin, 1 / (friction - 1))"),
            ("both_N", "force_N * default(slip_margin, 1)"),
        ]),
    )
    .expect("right");
    let (margin, force) = (scope.slot("slip_margin").unwrap(), scope.slot("force_N").unwrap());
    let names: Vec<_> = formulas.all().iter().map(|it| it.absent_with.clone()).collect();
    assert_eq!(names, [vec![margin], vec![], vec![margin], vec![margin], vec![], vec![force]]);
    let run = |there: f64, friction: f64| {
        let mut slots = vec![1.0; formulas.slots()];
        slots[margin] = 0.25;
        slots[scope.slot("friction").unwrap()] = friction;
        let mut present = vec![None; formulas.slots()];
        present[margin] = Some(there);
        present[force] = Some(1.0);
        let mut margins = vec![0.0; formulas.requirements().len()];
        formulas.evaluate_all(&mut slots, &mut present, &mut margins);
        let values: Vec<_> =
            formulas.all().iter().map(|it| present[it.slot].is_none_or(|present| present >= 0.0).then_some(slots[it.slot])).collect();
        let broken = |(it, margin): (&FormulaRequirement, &f64)| (*margin <= 0.0).then(|| it.status.clone());
        (values, formulas.requirements().iter().zip(&margins).filter_map(broken).collect::<Vec<_>>())
    };
    let (values, broken) = run(1.0, 1.0);
    assert_eq!(values, [Some(0.5), Some(0.5), Some(0.25), Some(1.0), Some(0.25), Some(0.25)]);
    assert_eq!(broken, ["formula failing: division by zero"]);
    let (values, broken) = run(-1.0, 1.0);
    assert_eq!(values, [None, Some(7.0), None, None, Some(1.0), Some(1.0)]);
    assert_eq!(broken, ["formula guarded: division by zero"], "what is absent fails in nothing, and its default may");
    assert_eq!(run(-1.0, 0.25).0[2], Some(3.0), "what is not taken is not missed");
}

#[test]
fn the_example_of_the_documentation_by_hand() {
    // 2 * 10 * 10 mm * 0.18 mm * 700 mm * 7850 kg/m^3 = 0.197820 kg.
    let mass =
        value("belt_mass_kg", "2 * band_count * 10[mm] * 0.18[mm] * radius_mm * 7850[kg/m^3]", &[("band_count", 10.0), ("radius_mm", 0.7)]);
    assert!((mass - 0.197_82).abs() < 1e-15);
    // 1.3 * 100 N m * cos(11 deg) / (2 * 0.08 * 50 mm)
    let force = value("clamping_force_N", "1.3 * torque_Nm * cos(22[deg] / 2) / (2 * 0.08 * 50[mm])", &[("torque_Nm", 100.0)]);
    assert!((force - 15_951.441_7).abs() < 1e-3, "{force}");
    let power = value("power_kW", "torque_Nm * speed_rpm / 1[rad]", &[("torque_Nm", 100.0), ("speed_rpm", 1500.0 * PI / 30.0)]);
    assert!((power - 15_707.963_267_948_966).abs() < 1e-9);
}

/// Where what is compared is absent neither branch is taken, and what fails in one is no status. (Found by random study 59.)
#[test]
fn of_an_absent_comparison_neither_branch_fails() {
    let scope = scope();
    let formulas = Formulas::new(&scope, &sources(&[("it", "if(force_N > 1[N], sqrt(friction), ln(friction))")])).expect("it is right");
    let force = scope.slot("force_N").expect("a name");
    for (value, present) in [(0.0, 1.0), (2.0, 1.0), (0.0, -1.0), (2.0, -1.0)] {
        let mut slots = vec![-1.0; formulas.slots()];
        slots[force] = value;
        let mut presence = vec![None; formulas.slots()];
        presence[force] = Some(present);
        let mut margins = vec![0.0; formulas.requirements().len()];
        formulas.evaluate_all(&mut slots, &mut presence, &mut margins);
        assert_eq!(margins.iter().any(|margin| *margin < 0.0), present >= 0.0, "{value} {present}: {margins:?}");
    }
}
