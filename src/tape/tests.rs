//! A root over every number type.

use super::{ColumnValue, Dual, Interval, Known, LIST_CHUNK, List, ListColumns, Loops, Recording, RunningError};
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

/// The root of `x^2/2 = half_square`: the slope is the argument itself.
fn of_half_square<R: Real>(half_square: R) -> R {
    let ten = R::constant(10.0);
    R::monotone_root((R::constant(0.0), ten), ten, [half_square], |[half_square], x| (R::constant(0.5) * x * x - half_square, x))
}

#[test]
fn over_columns_a_root_whose_slope_is_the_argument_has_the_bits_that_it_has_alone() {
    let (recording, results) =
        Recording::recorded(Loops::EveryIteration, &[Known::Within(0.1, 40.0)], |inputs| vec![of_half_square(inputs[0])]);
    let list = List::cut(&recording, &[Some(results[0])]);
    let mut columns = ListColumns::new(&list);
    columns.turn_to(&list, 0..1, |_| true);
    let values: Vec<f64> = (1..=2 * LIST_CHUNK + 5).map(|row| 0.05 * row as f64).collect();
    let mut rows = 0;
    columns.run(
        &list,
        values.len(),
        |_| ColumnValue::Each(&values),
        |columns, first, length| {
            for lane in 0..length {
                let (found, alone) = (columns.result(&list, 0).at(lane), of_half_square(values[first + lane]));
                assert_eq!(found.to_bits(), alone.to_bits(), "row {}", first + lane);
                rows += 1;
            }
        },
    );
    assert_eq!(rows, values.len());
}
