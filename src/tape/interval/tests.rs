//! Intervals against the functions themselves.

use super::*;
use crate::real::{Real, Smoothness};
use std::cell::Cell;
use std::f64::consts::PI;

fn between(low: f64, high: f64) -> Interval {
    Interval::new(low, high)
}

#[test]
fn ends_are_moved_outwards_by_hardly_anything() {
    let third = between(1.0, 1.0) / between(3.0, 3.0);
    assert!(third.low < 1.0 / 3.0 && 1.0 / 3.0 < third.high && third.width() < 2e-16, "{third:?}");
    assert!(third.error > 1e-17 && third.error < 1e-16, "{third:?}");
    let product = between(-2.0, 3.0) * between(-5.0, 1.0);
    assert!(product.low <= -15.0 && product.high >= 10.0 && product.width() < 25.1);
}

#[test]
fn what_has_no_meaning_is_everything() {
    assert_eq!(between(1.0, 2.0) / between(-1.0, 1.0), EVERYTHING);
    assert_eq!(Interval::constant(0.0) * EVERYTHING, EVERYTHING);
    assert_eq!((EVERYTHING - EVERYTHING).min(Interval::constant(1.0)), EVERYTHING, "f64 keeps a NaN that comes first");
    assert_eq!(Real::sqrt(between(-2.0, -1.0)), EVERYTHING);
    assert_eq!((Real::sqrt(EVERYTHING), Real::abs(EVERYTHING)), (EVERYTHING, EVERYTHING), "a NaN stays one");
    assert_eq!(Real::ln_1p(between(-2.0, 1.0)), EVERYTHING);
    assert_eq!(Interval::point(f64::NAN), EVERYTHING);
}

#[test]
fn zero_stays_zero_and_signs_are_kept() {
    let zero = Interval::constant(0.0);
    assert!((zero * between(-1.0, 2.0)).is_zero() && (zero / between(1.0, 2.0)).is_zero() && (zero + zero).is_zero());
    assert_eq!((between(0.0, 1.0) * between(2.0, 3.0)).low, 0.0);
    assert_eq!(between(-1.0, 2.0).squared().low, 0.0);
    let tiny = Interval::constant(1e-200);
    assert!((tiny * tiny).low <= 0.0 && (tiny * tiny).high > 0.0, "it underflows to zero, but is none");
    assert!((tiny * -tiny).high <= 0.0);
}

#[test]
fn waves_reach_their_peaks() {
    let cosine = Real::cos(between(3.0, 3.5));
    assert_eq!(cosine.low, -1.0);
    assert!((cosine.high - 3.5f64.cos()).abs() < 1e-15);
    assert_eq!((Real::sin(between(1.0, 2.0)).high, Real::sin(between(-2.0, -1.0)).low), (1.0, -1.0));
    assert_eq!((Real::cos(between(-1.0, 7.0)).low, Real::cos(between(-1.0, 7.0)).high), (-1.0, 1.0));
    let steep = Real::sin(between(0.1, 0.2));
    assert!((steep.low - 0.1f64.sin()).abs() < 1e-15 && (steep.high - 0.2f64.sin()).abs() < 1e-15);
    assert!(Real::cos(between(PI, PI)).contains(-1.0));
}

#[test]
fn f64_may_choose_the_other_branch_only_where_the_margin_has_an_error() {
    let (one, three) = (Interval::constant(1.0), Interval::constant(3.0));
    let exact = Real::select(between(-1.0, 1.0), one, three);
    assert_eq!((exact.low, exact.high, exact.error), (1.0, 3.0, 0.0));
    let rounded = Real::select(between(-1.0, 1.0) + Interval::constant(0.1), one, three);
    assert!(rounded.error >= 2.0, "{rounded:?}");
    assert_eq!(Real::select(between(0.0, 1.0), one, three), one);
    assert_eq!(Interval::select_slope(between(-1.0, 1.0), one, one, three), EVERYTHING, "the choice changes on the way");
    assert_eq!(Interval::select_slope(between(-1.0, 1.0), Interval::constant(0.0), one, three).high, 3.0);
}

#[test]
fn a_root_takes_few_evaluations_and_is_tight() {
    for width in [0.0, 1e-12, 1e-6, 1e-2, 0.5] {
        let count = Cell::new(0);
        let target = between(2.0 - width, 2.0 + width);
        let root = Interval::monotone_root(
            (Interval::constant(0.0), Interval::constant(10.0)),
            Interval::constant(9.0),
            Smoothness::Unknown,
            [target],
            |[target], x| {
                count.set(count.get() + 1);
                (x * x * x - target, Interval::constant(3.0) * x * x)
            },
        );
        let (low, high) = ((2.0 - width).cbrt(), (2.0 + width).cbrt());
        assert!(root.contains(low) && root.contains(high), "{root:?} holds {low} and {high}");
        assert!(root.width() <= 1.01 * (high - low) + 1e-13, "{root:?} is as wide as {low} to {high}");
        assert!(root.error < 1e-13 && count.get() <= 20, "{root:?} after {} evaluations", count.get());
    }
}

#[test]
fn where_some_have_no_root_everything_in_the_bracket_above_the_others_is_possible() {
    let at = |target: Interval| {
        Interval::monotone_root(
            (Interval::constant(0.0), Interval::constant(10.0)),
            Interval::constant(5.0),
            Smoothness::Unknown,
            [target],
            |[target], x| (x - target, Interval::constant(1.0)),
        )
    };
    let some = at(between(4.0, 12.0));
    assert!(some.low > 3.9 && some.low <= 4.0 && some.high == 10.0, "{some:?}");
    let none = at(between(11.0, 12.0));
    assert!(none.low >= 5.0 && none.high == 10.0, "{none:?}");
}
