//! A root over every number type.

use super::{ColumnValue, Dual, Interval, Known, LIST_CHUNK, List, ListColumns, Loops, Operation, Recording, RunningError, Set};
use crate::models;
use crate::real::{LANES, Lanes, ROOT_PARAMETERS, Real, RootFunction, RootSearch, RootStep, Smoothness, newton_step, root_step};

/// The cube root of 2, on every instance that has a value.
fn cube_root<R: Real>() -> R {
    let two = R::constant(2.0);
    R::monotone_root((R::constant(0.0), R::constant(10.0)), R::constant(9.0), Smoothness::Unknown, [two], |[two], x| {
        (x * x * x - two, R::constant(3.0) * x * x)
    })
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
    let x = f64::monotone_root((1.0, 3.0), 2.0, Smoothness::Unknown, [1.0], |[one], x| (x + one, one));
    assert!((1.0..=3.0).contains(&x), "{x}");
}

/// The root of `x^2/2 = half_square`: the slope is the argument itself.
fn of_half_square<R: Real>(half_square: R) -> R {
    let ten = R::constant(10.0);
    R::monotone_root((R::constant(0.0), ten), ten, Smoothness::Unknown, [half_square], |[half_square], x| {
        (R::constant(0.5) * x * x - half_square, x)
    })
}

#[test]
fn over_columns_a_root_whose_slope_is_the_argument_has_the_bits_that_it_has_alone() {
    let (recording, results) =
        Recording::recorded(Loops::EveryIteration, &[Known::Within(0.1, 40.0)], |inputs| vec![of_half_square(inputs[0])]);
    let list = List::cut(&recording, &[Some(results[0])]);
    let values: Vec<f64> = (1..=2 * LIST_CHUNK + 5).map(|row| 0.05 * row as f64).collect();
    each_has_the_bits_that_it_has_alone(&list, &[&values], |row| of_half_square(values[row]));
}

/// Compares the first result of a list over columns with what each row gives alone.
fn each_has_the_bits_that_it_has_alone(list: &List, inputs: &[&[f64]], alone: impl Fn(usize) -> f64) {
    let mut columns = ListColumns::new(list);
    columns.turn_to(list, 0..1, |_| true);
    let mut rows = 0;
    columns.run(
        list,
        inputs[0].len(),
        |input| ColumnValue::Each(inputs[usize::from(input)]),
        |columns, first, length| {
            for lane in 0..length {
                let (found, alone) = (columns.result(list, 0).at(lane), alone(first + lane));
                assert!(
                    found.to_bits() == alone.to_bits() || found.is_nan() && alone.is_nan(),
                    "row {}: {found:e}, {alone:e}",
                    first + lane
                );
                rows += 1;
            }
        },
    );
    assert_eq!(rows, inputs[0].len());
}

/// `asin(a x) + log(1 + b x) + c x`, less `d`.
struct Mixed;

impl RootFunction for Mixed {
    fn at<R: Real>([a, b, c, d]: [R; ROOT_PARAMETERS], x: R) -> (R, R) {
        let one = R::constant(1.0);
        let sine = (a * x).min(one).max(-one);
        (sine.asin() + (b * x).ln_1p() + c * x - d, a + b / (one + b * x) + c)
    }

    fn in_columns() -> Option<RootStep> {
        root_step!(Mixed)
    }
}

fn of_mixed<R: Real>(inputs: &[R]) -> R {
    let [a, b, c, d, start] = [0, 1, 2, 3, 4].map(|it| inputs[it]);
    R::root_of::<Mixed>((R::constant(0.0), R::constant(1.0)), start, [a, b, c, d])
}

#[test]
fn a_function_that_is_compiled_gives_the_bits_that_its_operations_give() {
    let (recording, results) = Recording::recorded(Loops::EveryIteration, &[Known::Within(0.0, 2.0); 5], |inputs| vec![of_mixed(inputs)]);
    let list = List::cut(&recording, &[Some(results[0])]);
    assert!(list.roots[0].root.function.is_some());
    let mut plain = list.clone();
    plain.roots[0].root.function = None;
    // In the first chunk the arc sine is never rare, in the second at the start, in the third after some steps, and in the last one there
    // are rows without a root, and without numbers.
    let chunks: [(f64, f64, f64); 4] = [(0.4, 0.5, 0.9), (0.9, 0.1, 1.0), (0.9, 1.6, 0.0), (0.4, 3.0, 0.5)];
    let rows = 4 * LIST_CHUNK;
    let of_row = |row: usize| (chunks[row / LIST_CHUNK], (row % LIST_CHUNK) as f64 / LIST_CHUNK as f64);
    let column = |value: &dyn Fn((f64, f64, f64), f64) -> f64| -> Vec<f64> {
        (0..rows)
            .map(|row| {
                let (chunk, fraction) = of_row(row);
                value(chunk, fraction)
            })
            .collect()
    };
    let mut inputs = [
        column(&|(a, ..), it| a * (1.0 - 0.1 * it)),
        column(&|_, it| 0.3 + it),
        column(&|_, it| 1.0 - 0.7 * it),
        column(&|(_, d, _), it| d * (0.5 + it)),
        column(&|(.., start), it| start * (1.0 - 0.2 * it)),
    ];
    inputs[3][rows - 7] = f64::NAN;
    let inputs: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
    let alone = |row: usize| of_mixed(&inputs.iter().map(|it| it[row]).collect::<Vec<_>>());
    each_has_the_bits_that_it_has_alone(&list, &inputs, alone);
    each_has_the_bits_that_it_has_alone(&plain, &inputs, alone);
}

#[test]
fn a_compiled_function_tells_that_it_takes_a_rare_way() {
    let step = Mixed::in_columns().expect("it is compiled");
    let taken = |x: f64| {
        let (ones, mut next) = ([1.0; 9], RootSearch { x: [0.0; 9], low: [0.0; 9], high: [0.0; 9], last_step: [0.0; 9] });
        let mut asked = [0.1; 9];
        asked[5] = x;
        let at = RootSearch { x: &asked[..], low: &[0.0; 9], high: &ones, last_step: &ones };
        let RootSearch { x, low, high, last_step } = &mut next;
        let left = step([&ones, &ones, &ones, &ones], at, RootSearch { x, low, high, last_step });
        left.map(|left| (left, next.x))
    };
    let (left, next) = taken(0.2).expect("nothing is rare");
    let (value, slope) = Mixed::at([1.0; ROOT_PARAMETERS], 0.2);
    let at = RootSearch { x: 0.2, low: 0.0, high: 1.0, last_step: 1.0 };
    let expected = newton_step(at, value, slope, f64::EPSILON, Smoothness::Smooth).x;
    assert_eq!((left, next[5]), (9, expected));
    assert!((expected - (0.2 - value / slope)).abs() < 1e-9, "{expected}");
    assert_eq!(taken(0.6), None);
}

/// The root of `x = a`, which leaves three parameters unread.
struct Unread;

impl RootFunction for Unread {
    fn at<R: Real>([a, ..]: [R; ROOT_PARAMETERS], x: R) -> (R, R) {
        (x - a, R::constant(1.0))
    }

    fn in_columns() -> Option<RootStep> {
        root_step!(Unread)
    }
}

#[test]
fn where_a_list_names_a_function_its_steps_are_taken() {
    let (recording, results) = Recording::recorded(Loops::EveryIteration, &[Known::Within(0.0, 1.0); 5], |inputs| vec![of_mixed(inputs)]);
    let mut list = List::cut(&recording, &[Some(results[0])]);
    // Of another function than its operations are: what comes of it tells which was asked.
    list.roots[0].root.function.as_mut().expect("it is compiled").step = Unread::in_columns().expect("it is compiled");
    let column: Vec<f64> = (0..LIST_CHUNK + 50).map(|row| 0.001 * row as f64).collect();
    let alone = |row: usize| {
        let a = column[row];
        f64::root_of::<Unread>((0.0, 1.0), a, [a; ROOT_PARAMETERS])
    };
    each_has_the_bits_that_it_has_alone(&list, &[&column[..]; 5], alone);
}

/// `x + x^3`, less the sum of twice the parameters: operations read these only where they are doubled.
struct Doubled;

impl RootFunction for Doubled {
    fn at<R: Real>(parameters: [R; ROOT_PARAMETERS], x: R) -> (R, R) {
        let [one, two, three] = [1.0, 2.0, 3.0].map(R::constant);
        let [a, b, c, d] = parameters.map(|it| two * it);
        (x + x * x * x - (a + b + c + d), one + three * x * x)
    }

    fn in_columns() -> Option<RootStep> {
        root_step!(Doubled)
    }
}

/// The parameters are computed, and after them where the search begins.
fn of_doubled<R: Real>(inputs: &[R]) -> R {
    let parameters = std::array::from_fn(|it| inputs[it] * inputs[it + 1]);
    let start = ((inputs[0] + inputs[2]) * (inputs[1] + inputs[3])).sqrt() / R::constant(9.0);
    R::root_of::<Doubled>((R::constant(0.0), R::constant(9.0)), start, parameters)
}

#[test]
fn parameters_stay_as_they_are_until_the_root_is_found() {
    let (recording, results) = Recording::recorded(Loops::EveryIteration, &[Known::Within(0.1, 1.0); 5], |inputs| vec![of_doubled(inputs)]);
    let list = List::cut(&recording, &[Some(results[0])]);
    assert!(list.roots[0].root.function.is_some());
    let columns: Vec<Vec<f64>> =
        (0..5_u32).map(|input| (0..300_u32).map(|row| 0.1 + f64::from((row * (7 + 2 * input)) % 300) / 400.0).collect()).collect();
    let inputs: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    each_has_the_bits_that_it_has_alone(&list, &inputs, |row| of_doubled(&inputs.iter().map(|it| it[row]).collect::<Vec<_>>()));
}

#[test]
fn a_function_whose_parameters_nobody_computes_is_left_to_its_operations() {
    let (recording, results) = Recording::recorded(Loops::EveryIteration, &[Known::Within(0.0, 1.0); 4], |inputs| {
        let parameters = std::array::from_fn(|it| inputs[it]);
        vec![Real::root_of::<Unread>((Real::constant(0.0), Real::constant(1.0)), inputs[0], parameters), inputs[3]]
    });
    let list = List::cut(&recording, &[Some(results[0]), Some(results[1])]);
    assert_eq!((list.roots.len(), list.roots[0].root.function), (1, None));
    let column: Vec<f64> = (0..50).map(|row| 0.02 * f64::from(row)).collect();
    each_has_the_bits_that_it_has_alone(&list, &[&column[..]; 4], |row| column[row]);
}

#[test]
fn the_roots_of_the_variators_are_compiled() {
    for name in ["metal-cvt", "rubber-cvt"] {
        let model = models::find(name).expect("it is there");
        let known = vec![Known::ANY; model.inputs.len()];
        let (outputs, conditions) = (Set::between(0, model.outputs.len()), Set::between(0, model.conditions.len()));
        let formula = model.kernel.formula().expect("it is recorded");
        let list = formula.whole(&known, outputs, conditions).list(outputs, conditions);
        let roots: Vec<u8> =
            list.operations.iter().filter_map(|it| if let Operation::Root(number) = it { Some(*number) } else { None }).collect();
        assert_eq!(roots.len(), 2, "{name}: the driver's radius and the slack side's force");
        assert!(roots.iter().all(|&it| list.roots[usize::from(it)].root.function.is_some()), "{name}");
    }
}
