//! A root over every number type.

use super::{Dual, Interval, RunningError};
use crate::real::{LANES, Lanes, Real};

/// The cube root of 2, on every instance that has a value.
fn cube_root<R: Real>() -> R {
    let two = R::constant(2.0);
    R::monotone_root((R::constant(0.0), R::constant(10.0)), R::constant(9.0), [two], |[two], x| (x * x * x - two, R::constant(3.0) * x * x))
}

#[test]
fn the_root_of_a_monotone_function_is_found_to_rounding() {
    let exact = 2f64.powf(1.0 / 3.0);
    assert!((cube_root::<f64>() - exact).abs() <= 4.0 * f64::EPSILON);
    assert!((f64::from(cube_root::<f32>()) - exact).abs() <= 4.0 * f64::from(f32::EPSILON));
    assert_eq!(cube_root::<Lanes>().0, [cube_root::<f64>(); LANES], "lanes must round like the scalar");
    let bounded = cube_root::<RunningError>();
    assert!((f64::from(bounded.value) - exact).abs() <= bounded.bound);
    let over_all = cube_root::<Interval>();
    assert!(over_all.contains(exact) && over_all.contains(cube_root::<f64>()) && over_all.width() < 1e-13, "{over_all:?}");
    assert_eq!(cube_root::<Dual<f64, 1>>().value, cube_root::<f64>());
    assert!(bounded.bound < 1e-5, "the bound of a well-conditioned root is useful: {}", bounded.bound);
}

#[test]
fn without_a_root_the_result_stays_inside_the_bracket() {
    let x = f64::monotone_root((1.0, 3.0), 2.0, [1.0], |[one], x| (x + one, one));
    assert!((1.0..=3.0).contains(&x), "{x}");
}
