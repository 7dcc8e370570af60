//! The elementary functions over every number type: how accurate they are, and that no type says more of them than is true.

use super::precise::Precise;
use crate::random::Random;
use beltspace::real::{LANES, Lanes, Real};
use beltspace::tape::{Dual, EVERYTHING, Interval, Known, List, Operation, Recording, RunningError, Unary};

/// A function of one or two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Of {
    Exp,
    Ln,
    Log10,
    Tanh,
    Tan,
    Acos,
    Atan,
    Atan2,
    Hypot,
    Floor,
    Ceil,
    Round,
}

const ALL: [Of; 12] =
    [Of::Exp, Of::Ln, Of::Log10, Of::Tanh, Of::Tan, Of::Acos, Of::Atan, Of::Atan2, Of::Hypot, Of::Floor, Of::Ceil, Of::Round];

impl Of {
    fn of<R: Real>(self, x: R, y: R) -> R {
        match self {
            Self::Exp => R::exp(x),
            Self::Ln => R::ln(x),
            Self::Log10 => R::log10(x),
            Self::Tanh => R::tanh(x),
            Self::Tan => R::tan(x),
            Self::Acos => R::acos(x),
            Self::Atan => R::atan(x),
            Self::Atan2 => R::atan2(x, y),
            Self::Hypot => R::hypot(x, y),
            Self::Floor => R::floor(x),
            Self::Ceil => R::ceil(x),
            Self::Round => R::round(x),
        }
    }

    /// By other means.
    fn exact(self, x: f64, y: f64) -> f64 {
        match self {
            Self::Exp => libm::exp(x),
            Self::Ln => libm::log(x),
            Self::Log10 => libm::log10(x),
            Self::Tanh => libm::tanh(x),
            Self::Tan => libm::tan(x),
            Self::Acos => libm::acos(x),
            Self::Atan => libm::atan(x),
            Self::Atan2 => libm::atan2(x, y),
            Self::Hypot => libm::hypot(x, y),
            Self::Floor => libm::floor(x),
            Self::Ceil => libm::ceil(x),
            Self::Round => libm::floor(x + 0.5),
        }
    }

    fn is_step(self) -> bool {
        matches!(self, Self::Floor | Self::Ceil | Self::Round)
    }

    fn takes_two(self) -> bool {
        matches!(self, Self::Atan2 | Self::Hypot)
    }

    /// Where it has a value in f64.
    fn wide_domain(self) -> (f64, f64) {
        match self {
            Self::Exp => (-2000.0, 700.0),
            Self::Ln | Self::Log10 => (1e-300, 1e300),
            Self::Tanh | Self::Atan | Self::Atan2 | Self::Hypot => (-1e300, 1e300),
            Self::Floor | Self::Ceil | Self::Round => (-1e18, 1e18),
            Self::Acos | Self::Tan => self.domain(),
        }
    }

    /// Where it has a value, and f32 has arguments and the value.
    fn domain(self) -> (f64, f64) {
        match self {
            Self::Exp => (-86.0, 86.0),
            Self::Ln | Self::Log10 => (1e-30, 1e30),
            Self::Acos => (-1.0, 1.0),
            Self::Tan => (-50.0, 50.0),
            Self::Tanh | Self::Atan | Self::Atan2 | Self::Hypot => (-1e15, 1e15),
            Self::Floor | Self::Ceil | Self::Round => (-1e5, 1e5),
        }
    }

    /// An argument: of any size, near where something happens, or exactly there.
    fn argument(self, random: &mut Random) -> f64 {
        let (low, high) = self.domain();
        let place = random.pick(&[0.0, 0.0, 1.0, 1.0, -1.0, 0.5, 2.0, -0.5, std::f64::consts::FRAC_PI_2, 40.0, -17.0]);
        let sign = random.pick(&[1.0, -1.0]);
        let value = match random.below(5) {
            0 => place,
            1 => place + sign * random.log_between(1e-15, 1e-2),
            2 => sign * random.log_between(1e-25, high),
            3 => random.between(low.max(-10.0), high.min(10.0)),
            _ => random.between(low, high),
        };
        if value < low || value > high { random.between(low.max(0.01), high.min(10.0)) } else { value }
    }
}

/// The distance in ULP of the exact value; below the least normal number in ULP of that.
fn ulp_off(found: f64, exact: f64) -> f64 {
    if found == exact || (found.is_nan() && exact.is_nan()) {
        return 0.0;
    }
    let size = exact.abs().max(f64::MIN_POSITIVE);
    let off = (found - exact).abs() / (size.next_up() - size);
    if off.is_nan() { f64::INFINITY } else { off }
}

/// What numbers of these sizes, of either sign, and around 1 and multiples of pi/2, come to.
fn worst(of: Of, found: impl Fn(f64, f64) -> f64) -> (f64, f64, f64) {
    let random = &mut Random::new(41);
    let sizes: &[(f64, f64)] = match of {
        Of::Exp => &[(1e-300, 1e-3), (1e-3, 1.0), (1.0, 708.0)],
        Of::Tan => &[(1e-300, 1e-3), (1e-3, 1.5), (1.0, 1e5)],
        Of::Acos => &[(1e-300, 1e-3), (1e-3, 1.0)],
        _ => &[(1e-300, 1e-3), (1e-3, 1.0), (0.4, 2.5), (1.0, 100.0), (1.0, 1e300)],
    };
    let mut most = (0.0, f64::NAN, f64::NAN);
    for step in 0..400_000 {
        let mut draw = || {
            let (low, high) = random.pick(sizes);
            let size = random.log_between(low, high);
            let near_one = 1.0 - random.log_between(1e-16, 0.5);
            let size = if step % 4 == 0 { random.pick(&[near_one, if of == Of::Acos { near_one } else { 2.0 - near_one }]) } else { size };
            if matches!(of, Of::Ln | Of::Log10) { size } else { size * random.pick(&[1.0, -1.0]) }
        };
        let (x, y) = (draw(), draw());
        let off = ulp_off(found(x, y), of.exact(x, y));
        if off > most.0 {
            most = (off, x, y);
        }
    }
    most
}

/// ULP that each may be off by, the error of the other means included.
fn limit(of: Of) -> f64 {
    match of {
        Of::Hypot => 2.0,
        _ if of.is_step() => 0.0,
        _ => 4.0,
    }
}

#[test]
fn every_function_is_accurate_to_a_few_ulp() {
    for of in ALL {
        let (off, x, y) = worst(of, |x, y| of.of(x, y));
        eprintln!("{of:?}: at most {off:.2} ULP, at {x:e} {y:e}");
        assert!(off <= limit(of), "{of:?} is {off} ULP off at {x:e} {y:e}");
    }
}

#[test]
fn the_obvious_ways_to_write_them_are_not_as_accurate() {
    type Obvious = (Of, fn(f64, f64) -> f64);
    let obvious: [Obvious; 8] = [
        (Of::Exp, |x, _| libm::expm1(x) + 1.0),
        (Of::Ln, |x, _| if x >= 1.0 { libm::log1p(x - 1.0) } else { -libm::log1p(1.0 / x - 1.0) }),
        (Of::Tanh, |x, _| 1.0 - 2.0 / (libm::expm1(2.0 * x) + 2.0)),
        (Of::Acos, |x, _| 2.0 * libm::asin((0.5 * (1.0 - x)).sqrt())),
        (Of::Atan, |x, _| libm::asin(x / (1.0 + x * x).sqrt())),
        (Of::Atan2, |y, x| libm::atan(y / x)),
        (Of::Hypot, |x, y| (x * x + y * y).sqrt()),
        (Of::Round, |x, _| x.round()),
    ];
    for (of, function) in obvious {
        let (off, x, y) = worst(of, function);
        assert!(off > 4.0 * limit(of) + 1.0, "{of:?}: only {off} ULP at {x:e} {y:e}");
    }
}

#[test]
fn values_at_the_edges_are_the_known_ones() {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
    let close = |of: Of, x: f64, y: f64, expected: f64| {
        let found: f64 = of.of(x, y);
        assert!(ulp_off(found, expected) <= 1.0, "{of:?}({x:e}, {y:e}) is {found:e}, not {expected:e}");
    };
    for zero in [0.0, -0.0] {
        close(Of::Exp, zero, 0.0, 1.0);
        for of in [Of::Tanh, Of::Tan, Of::Atan, Of::Floor, Of::Ceil, Of::Round] {
            close(of, zero, 0.0, 0.0);
        }
        close(Of::Acos, zero, 0.0, FRAC_PI_2);
        for other in [0.0, -0.0] {
            close(Of::Atan2, zero, other, 0.0);
            close(Of::Hypot, zero, other, 0.0);
        }
        close(Of::Atan2, zero, 1.0, 0.0);
        close(Of::Atan2, zero, -1.0, PI);
        close(Of::Atan2, 1e-300, zero, FRAC_PI_2);
        close(Of::Atan2, -1e300, zero, -FRAC_PI_2);
        assert!(!Real::ln(zero).is_finite());
    }
    for tiny in [1e-300, -1e-300] {
        close(Of::Exp, tiny, 0.0, 1.0);
        for of in [Of::Tanh, Of::Tan, Of::Atan] {
            close(of, tiny, 0.0, tiny);
        }
        close(Of::Hypot, tiny, 0.0, 1e-300);
        close(Of::Hypot, tiny, 1e300, 1e300);
        close(Of::Atan2, tiny, 1e300, 0.0);
        close(Of::Atan2, tiny, tiny, if tiny > 0.0 { FRAC_PI_4 } else { -3.0 * FRAC_PI_4 });
        close(Of::Floor, tiny, 0.0, tiny.floor());
        close(Of::Ceil, tiny, 0.0, tiny.ceil());
    }
    close(Of::Ln, 1e-300, 0.0, libm::log(1e-300));
    close(Of::Ln, f64::MIN_POSITIVE, 0.0, libm::log(f64::MIN_POSITIVE));
    close(Of::Ln, f64::MAX, 0.0, libm::log(f64::MAX));
    close(Of::Ln, 1.0, 0.0, 0.0);
    for (of, x) in [(Of::Ln, -1.0), (Of::Log10, -1e-300), (Of::Acos, 1.5), (Of::Acos, -1.5)] {
        assert!(of.of(x, 0.0f64).is_nan(), "{of:?} of {x}");
    }
    for power in -307..=308 {
        let value: f64 = format!("1e{power}").parse().expect("it is a number");
        let found = Real::log10(value);
        let is_near = ulp_off(found, power.into()) <= if (0..=14).contains(&power) { 0.0 } else { limit(Of::Log10) };
        assert!(is_near, "log10 of {value:e} is {found:e}");
    }
    for huge in [1e300, f64::MAX, f64::INFINITY] {
        close(Of::Tanh, huge, 0.0, 1.0);
        close(Of::Tanh, -huge, 0.0, -1.0);
        close(Of::Atan, huge, 0.0, FRAC_PI_2);
        close(Of::Atan, -huge, 0.0, -FRAC_PI_2);
        close(Of::Exp, huge, 0.0, f64::INFINITY);
        let vanished: f64 = Of::Exp.of(-huge, 0.0);
        assert!(vanished <= 0.6 * f64::MIN_POSITIVE, "{vanished:e}");
        close(Of::Floor, huge, 0.0, huge);
    }
    close(Of::Hypot, 1e300, -1e300, 2f64.sqrt() * 1e300);
    close(Of::Atan2, 1e300, -1e300, 3.0 * FRAC_PI_4);
    close(Of::Atan2, f64::MAX, f64::MAX, FRAC_PI_4);
    close(Of::Acos, 1.0, 0.0, 0.0);
    close(Of::Acos, -1.0, 0.0, PI);
    for (x, floor, ceil, round) in [(2.5, 2.0, 3.0, 3.0), (-2.5, -3.0, -2.0, -2.0), (7.0, 7.0, 7.0, 7.0), (-0.5, -1.0, 0.0, 0.0)] {
        assert_eq!((Real::floor(x), Real::ceil(x), Real::round(x)), (floor, ceil, round), "{x}");
    }
    // What is no number stays none.
    for of in ALL {
        assert!(of.of(f64::NAN, 1.0).is_nan(), "{of:?}");
        assert!(!of.takes_two() || (of.of(1.0, f64::NAN).is_nan() && of.of(f64::NAN, f64::NAN).is_nan()), "{of:?}");
    }
}

/// All functions of two inputs, which may be known, as a list.
fn recorded(known: [Known; 2]) -> List {
    let (recording, results) = Recording::of(&known, |inputs| ALL.iter().map(|of| of.of(inputs[0], inputs[1])).collect());
    List::cut(&recording, &results.into_iter().map(Some).collect::<Vec<_>>())
}

/// The functions whose values differ in a bit between a list and f64.
fn differing(list: impl Fn(f64, f64) -> List) -> Vec<Of> {
    let random = &mut Random::new(48);
    let mut differing = Vec::new();
    for _ in 0..500 {
        let (x, y) = (random.between(-3.0, 3.0), random.between(-3.0, 3.0));
        for (&of, found) in ALL.iter().zip(list(x, y).run(&[x, y])) {
            let expected: f64 = of.of(x, y);
            if found.to_bits() != expected.to_bits() && !(found.is_nan() && expected.is_nan()) && !differing.contains(&of) {
                differing.push(of);
            }
        }
    }
    differing
}

#[test]
fn the_recorded_functions_have_the_bits_of_f64_and_those_of_constants_are_constants() {
    let all = recorded([Known::ANY; 2]);
    assert_eq!(differing(|_, _| all.clone()), []);
    let fixed = |x: f64, y: f64| recorded([Known::Fixed(x), Known::Fixed(y)]);
    assert_eq!(differing(fixed), []);
    assert!(fixed(2.5, -1.5).operations.iter().all(|operation| matches!(operation, Operation::Constant(_))));
    let mut wrong = all;
    for operation in &mut wrong.operations {
        if let Operation::Unary(of @ Unary::Floor, _) = operation {
            *of = Unary::Abs;
        }
    }
    assert_eq!(differing(|_, _| wrong.clone()), [Of::Floor, Of::Ceil, Of::Round]);
}

#[test]
fn lanes_have_the_bits_of_f64() {
    let random = &mut Random::new(42);
    for of in ALL {
        for _ in 0..3000 {
            let mut draw = || Lanes(std::array::from_fn::<_, LANES, _>(|_| of.argument(random)));
            let (x, y) = (draw(), draw());
            let together = of.of(x, y);
            for lane in 0..LANES {
                let alone = of.of(x.0[lane], y.0[lane]);
                assert_eq!(together.0[lane].to_bits(), alone.to_bits(), "{of:?} of {} {}", x.0[lane], y.0[lane]);
            }
        }
    }
}

/// Values in f32 with bounds divided by `shrink`, against f64: how many there are, how many have no bound, how many leave it.
fn bounded(of: Of, shrink: f64, floor: fn(RunningError) -> RunningError) -> (usize, usize, usize, String, Vec<f64>) {
    let random = &mut Random::new(43);
    let (mut all, mut unbounded, mut broken, mut example, mut relative) = (0, 0, 0, String::new(), Vec::new());
    for _ in 0..60_000 {
        let (x, y) = (of.argument(random), of.argument(random));
        let exact = of.of(x, y);
        let (in_x, in_y) = (RunningError::input(x), RunningError::input(y));
        let RunningError { value, bound } = if of == Of::Floor { floor(in_x) } else { of.of(in_x, in_y) };
        if !exact.is_finite() {
            continue;
        }
        all += 1;
        if bound.is_infinite() {
            unbounded += 1;
            continue;
        }
        let error = (f64::from(value) - exact).abs() - 1e-13 * exact.abs();
        if error > bound / shrink || error.is_nan() || bound.is_nan() {
            broken += 1;
            example = format!("{of:?}({x:e}, {y:e}) is {value:e}, in f64 {exact:e}, bound {bound:e}");
        }
        if exact != 0.0 {
            relative.push(bound / exact.abs());
        }
    }
    relative.sort_by(f64::total_cmp);
    (all, unbounded, broken, example, relative)
}

#[test]
fn f32_stays_within_bounds_that_are_of_use() {
    for of in ALL {
        let (all, unbounded, broken, example, relative) = bounded(of, 1.0, Real::floor);
        let median = relative[relative.len() / 2];
        eprintln!("{of:?}: {all} values, {unbounded} without a bound, median relative bound {median:.1e}");
        assert_eq!(broken, 0, "{example}");
        assert!(all > 50_000 && unbounded * 20 < all, "{of:?}: {unbounded} of {all} have no bound");
        assert!(median < 5e-6, "{of:?}: {median:e}");
    }
}

#[test]
fn bounds_that_are_too_small_are_noticed() {
    for of in ALL {
        let blind = |x: RunningError| RunningError { bound: 0.0, ..Real::floor(x) };
        let (all, _, broken, ..) = if of == Of::Floor { bounded(of, 1.0, blind) } else { bounded(of, 1e3, Real::floor) };
        assert!(broken > all / 1000, "{of:?}: {broken} of {all}");
    }
}

#[test]
fn floor_in_f32_is_exact_where_no_whole_number_is_within_the_bound() {
    let floor = |value: f32, bound: f64| {
        let found = Real::floor(RunningError { value, bound });
        (found.value, found.bound)
    };
    assert_eq!(floor(2.5, 0.4), (2.0, 0.0));
    assert_eq!(floor(2.5, 0.5), (2.0, 1.0));
    assert_eq!(floor(3.0, 0.0), (3.0, 0.0));
    assert_eq!(floor(3.0, 1e-30), (3.0, 1.0), "it may be a little less than 3");
    assert_eq!(floor(-1e-30, 1e-40).1, 1.0, "f64 does not tell it from the whole number above");
    assert_eq!(floor(1e-30, 1e-31), (0.0, 0.0));
    assert_eq!(floor(7.25, 2.5), (7.0, 3.0));
    assert_eq!(floor(7.25, f64::INFINITY).1, f64::INFINITY);
}

/// A box for a function, narrow or wide, that may include a jump, a kink or the origin.
fn side(of: Of, random: &mut Random) -> (f64, f64) {
    let (low, high) = of.domain();
    let centre = of.argument(random);
    let reach = if random.chance(0.1) { 0.0 } else { random.log_between(1e-15, 3.0) * random.pick(&[1.0, centre.abs(), 1e-3]) };
    ((centre - reach).max(low), (centre + reach).min(high))
}

fn inside((low, high): (f64, f64), random: &mut Random) -> f64 {
    let between = random.between(low, high).clamp(low, high);
    let whole = between.round().clamp(low, high);
    random.pick(&[low, high, between, between, whole])
}

/// What is wrong with intervals that are changed by `spoil`.
fn boxes(of: Of, boxes: usize, spoil: fn(Interval) -> Interval) -> (usize, usize, usize, String) {
    let random = &mut Random::new(44);
    let (mut checked, mut known, mut broken, mut example) = (0, 0, 0, String::new());
    for _ in 0..boxes {
        let mut draw = || {
            let ((low, high), (least, most)) = (side(of, random), of.wide_domain());
            // Sometimes far beyond what f32 has.
            let far = random.log_between(1.0, 1e300);
            if random.chance(0.1) { (low.min(high.min(-far)).max(least), high.max(far).min(most)) } else { (low, high) }
        };
        let (of_x, of_y) = (draw(), draw());
        let range = spoil(of.of(Interval::new(of_x.0, of_x.1), Interval::new(of_y.0, of_y.1)));
        for _ in 0..6 {
            let (x, y) = (inside(of_x, random), inside(of_y, random));
            let (found, exact) = (of.of(x, y), of.of(Precise::from(x), Precise::from(y)));
            // A jump of the formula in twice the digits may lie elsewhere, as far as half a digit of f64: there f64 is exact.
            let exact = if of == Of::Round { Precise::from(found) } else { exact };
            checked += 1;
            known += usize::from(range.is_finite());
            let holds = if found.is_nan() { range == EVERYTHING } else { range.contains(found) && range.contains(exact.rounded()) };
            let near = range.error == f64::INFINITY || exact.distance(found) <= range.error;
            if !(holds && near) {
                broken += 1;
                example = format!("{of:?}({x:e}, {y:e}) is {found:e}, exactly {exact:?}, not in {range:?} of {of_x:?} {of_y:?}");
            }
        }
    }
    (checked, known, broken, example)
}

#[test]
fn no_value_leaves_the_interval_of_its_box() {
    for of in ALL {
        let (checked, known, broken, example) = boxes(of, 20_000, |range| range);
        eprintln!("{of:?}: {known} of {checked} in intervals with ends");
        assert_eq!(broken, 0, "{broken} of {checked}: {example}");
        assert!(known * 10 > checked * if of == Of::Tan { 6 } else { 9 }, "{of:?}: {known} of {checked}");
    }
}

#[test]
fn intervals_that_are_too_narrow_are_noticed() {
    let narrowed = |range: Interval| {
        let part = 0.1 * range.width();
        if range.is_finite() { Interval { low: range.low + part, high: range.high - part, ..range } } else { range }
    };
    let sure = |range: Interval| Interval { error: 0.05 * range.error, ..range };
    for of in ALL {
        let (checked, _, broken, _) = boxes(of, 3000, narrowed);
        assert!(broken > checked / 20, "{of:?}: {broken} of {checked}");
        let (checked, _, broken, _) = boxes(of, 3000, sure);
        assert!(of.is_step() || broken > 0, "{of:?}: {broken} of {checked}");
    }
}

/// Intervals of wide boxes are not much wider than the function's range.
#[test]
fn intervals_of_monotone_functions_are_hardly_wider_than_their_values() {
    let random = &mut Random::new(45);
    for (of, factor) in
        [(Of::Exp, 1.0), (Of::Ln, 1.0), (Of::Log10, 1.0), (Of::Tanh, 1.0), (Of::Acos, 1.0), (Of::Atan, 2.5), (Of::Floor, 1.0)]
    {
        for _ in 0..2000 {
            let (low, high) = side(of, random);
            if of == Of::Atan && (low < -1.0 || high > 1.0) {
                continue;
            }
            let range = of.of(Interval::new(low, high), Interval::constant(0.0));
            let (a, b): (f64, f64) = (of.of(low, 0.0), of.of(high, 0.0));
            let width = (b - a).abs();
            // An end of acos or ln at a steep place is known less well.
            let doubt = 1e-13 * (a.abs() + b.abs() + 1e-7);
            assert!(range.width() <= factor * width + doubt, "{of:?}: {range:?} of {low:e} to {high:e}, {a:e} to {b:e}");
        }
    }
}

/// What is wrong with the slopes over boxes, changed by `spoil`: chords, and slopes at places of the box. Also how many are known, and how
/// many have a sure sign.
fn slopes(of: Of, boxes: usize, spoil: fn(Interval) -> Interval) -> ([usize; 4], String) {
    let random = &mut Random::new(46);
    let ([mut checked, mut known, mut signed, mut broken], mut example) = ([0; 4], String::new());
    for _ in 0..boxes {
        let sides = [side(of, random), side(of, random)];
        let [x, y] = sides.map(|(low, high)| Interval::new(low, high));
        let derived = of.of(Dual::<Interval, 2>::variable(x, 0), Dual::variable(y, 1));
        for _ in 0..4 {
            let from = sides.map(|side| inside(side, random));
            let direction = usize::from(of.takes_two() && random.chance(0.5));
            let slope = spoil(derived.slopes[direction]);
            let mut to = from;
            to[direction] = inside(sides[direction], random);
            let [a, b] = [from, to].map(|[x, y]| of.of(x, y));
            let step = to[direction] - from[direction];
            let here = of.of(Dual::<f64, 2>::variable(from[0], 0), Dual::variable(from[1], 1)).slopes[direction];
            checked += 1;
            known += usize::from(slope.is_finite());
            signed += usize::from(slope.low >= 0.0 || slope.high <= 0.0);
            let rounding = 1e-11 * here.abs() + 1e-300;
            let holds = here.is_nan() || (slope.low - rounding <= here && here <= slope.high + rounding);
            let doubt = 1e-15 * 8.0 * (a.abs() + b.abs()) / step.abs();
            let chord = (b - a) / step;
            let is_steep = step != 0.0 && (chord < slope.low - doubt || chord > slope.high + doubt);
            if !holds || is_steep {
                broken += 1;
                example = format!(
                    "{of:?} by {direction}: chord {chord:e} +- {doubt:e}, here {here:e}, slopes {slope:?}: {from:?} {to:?} of {sides:?}"
                );
            }
        }
    }
    ([checked, known, signed, broken], example)
}

#[test]
fn no_chord_and_no_slope_leaves_the_slopes_of_its_box() {
    for of in ALL {
        let ([checked, known, signed, broken], example) = slopes(of, 20_000, |slope| slope);
        eprintln!("{of:?}: {known} of {checked} slopes known, {signed} with a sign");
        assert_eq!(broken, 0, "{broken} of {checked}: {example}");
        assert!(known * 10 > checked * if of == Of::Tan || of.is_step() { 5 } else { 8 }, "{of:?}: {known} of {checked}");
    }
}

#[test]
fn slopes_of_the_wrong_sign_and_slopes_across_a_jump_are_noticed() {
    for of in ALL {
        let ([checked, .., broken], _) = slopes(of, 3000, |slope| if slope.is_finite() { -slope } else { Interval::constant(0.0) });
        assert!(broken > checked / 20, "{of:?}: {broken} of {checked}");
    }
}

#[test]
fn the_slope_at_a_design_is_the_functions_own() {
    let random = &mut Random::new(47);
    for of in ALL.into_iter().filter(|of| !of.is_step()) {
        for _ in 0..5000 {
            let (x, y) = (of.argument(random), of.argument(random));
            let Dual { value, slopes } = of.of(Dual::<f64, 2>::variable(x, 0), Dual::variable(y, 1));
            assert_eq!(value.to_bits(), of.of(x, y).to_bits());
            let h = x.hypot(y);
            let expected = match of {
                Of::Exp => [value, 0.0],
                Of::Ln => [1.0 / x, 0.0],
                Of::Log10 => [1.0 / (x * std::f64::consts::LN_10), 0.0],
                Of::Tanh => [1.0 / x.cosh().powi(2), 0.0],
                Of::Tan => [1.0 / x.cos().powi(2), 0.0],
                Of::Acos => [-1.0 / ((1.0 - x) * (1.0 + x)).sqrt(), 0.0],
                Of::Atan => [1.0 / (1.0 + x * x), 0.0],
                Of::Atan2 => [y / h / h, -x / h / h],
                _ => [x / h, y / h],
            };
            for (slope, expected) in slopes.iter().zip(expected).filter(|(_, expected)| expected.is_finite()) {
                let off = (slope - expected).abs();
                let size =
                    if of.takes_two() { expected.abs().max(1e-9 * if of == Of::Hypot { 1.0 } else { 1.0 / h }) } else { expected.abs() };
                // Where a hyperbolic tangent is 1 in most digits its slope is lost in rounding.
                let lost = if of == Of::Tanh { 1e-15 } else { 1e-25 };
                assert!(off <= 1e-6 * size + lost, "{of:?} at {x:e} {y:e}: {slope:e}, not {expected:e}");
            }
        }
    }
}
