// A number and a bound on its distance from exact arithmetic, as `RunningError` of src/tape/error_bound.rs.
//
// The bound grows by what WGSL permits, not by what one GPU does: sums and products rounded once (contraction rounds less),
// division 2.5 ULP by divisors from 2^-126 to 2^126 and anything by others (a reciprocal that is flushed makes them 0), square root
// 4.5 ULP, results below the least normal number flushed to zero. It is carried in f32 too: what rounds in the bound itself is
// covered by the thousandth that every rounding is raised by.

struct Real {
    value: f32,
    bound: f32,
}

// The errors that the operations may make (ROUNDING, DIVISION and so on) are declared in src/gpu/constants.rs.

const PI: f32 = 3.14159265;

fn constant(value: f32) -> Real {
    return Real(value, 0.0);
}

// A constant that f32 does not hold exactly.
fn near(value: f32) -> Real {
    return Real(value, abs(value) * ROUNDING);
}

// Any number between two others: the middle, with half of their distance as the bound, and a little more for what rounds in the bounds that
// are made of it.
fn between(a: Real, b: Real) -> Real {
    let reach = 0.5001 * abs(b.value - a.value) + 2.0 * ROUNDING * (abs(a.value) + abs(b.value)) + FLUSH;
    return Real(0.5 * a.value + 0.5 * b.value, reach + max(a.bound, b.bound));
}

fn rounded(value: f32, inherited: f32, relative: f32) -> Real {
    return Real(value, inherited + (abs(value) * relative + FLUSH));
}

fn add(a: Real, b: Real) -> Real {
    return rounded(a.value + b.value, a.bound + b.bound, ROUNDING);
}

fn sub(a: Real, b: Real) -> Real {
    return rounded(a.value - b.value, a.bound + b.bound, ROUNDING);
}

fn mul(a: Real, b: Real) -> Real {
    return rounded(a.value * b.value, abs(a.value) * b.bound + (abs(b.value) + b.bound) * a.bound, ROUNDING);
}

fn is_zero(a: Real) -> bool {
    return a.value == 0.0 && a.bound == 0.0;
}

// The same where a number may be exactly zero, and the product with it: a plateau is known to be one.
fn mul_or_zero(a: Real, b: Real) -> Real {
    let product = mul(a, b);
    // Not where the other one may have no value.
    let is_exact = (is_zero(a) && b.bound < infinity()) || (is_zero(b) && a.bound < infinity());
    return Real(product.value, select(product.bound, 0.0, is_exact));
}

fn square(a: Real) -> Real {
    return mul(a, a);
}

// A part of a bound over a divisor that lies between `least` and `most`; infinite where WGSL does not say how accurate the quotient is.
fn bound_over(part: f32, least: f32, most: f32) -> f32 {
    return select(infinity(), part / least, least >= FLUSH && most <= LARGEST_DIVISOR);
}

fn div(a: Real, b: Real) -> Real {
    let quotient = a.value / b.value;
    let size = abs(b.value);
    return rounded(quotient, bound_over(a.bound + abs(quotient) * b.bound, size - b.bound, size), DIVISION);
}

fn neg(a: Real) -> Real {
    return Real(-a.value, a.bound);
}

// Products with powers of two are exact, but for what is flushed to zero.
fn scaled_(a: Real, power: f32) -> Real {
    return Real(power * a.value, power * a.bound + select(0.0, FLUSH, power < 1.0));
}

fn twice(a: Real) -> Real {
    return scaled_(a, 2.0);
}

fn half(a: Real) -> Real {
    return scaled_(a, 0.5);
}

// A number, or nothing that is known of it.
fn if_known(known: bool, number: Real) -> Real {
    return Real(number.value, select(infinity(), number.bound, known));
}

// A whole number from 0 on as an index.
fn whole(a: Real) -> u32 {
    return u32(a.value + 0.5);
}

// Whole numbers that f32 holds exactly.
fn plus_whole(a: Real, b: Real) -> Real {
    return Real(a.value + b.value, a.bound + b.bound);
}

fn abs_(a: Real) -> Real {
    return Real(abs(a.value), a.bound);
}

// The one of two numbers that is the smaller or larger, with its own bound if it surely is: a clamp that surely holds is exact.
// Where it is not sure the sum of the bounds serves as their maximum would, and a bound that is no number stays one.
fn chosen(second: bool, a: Real, b: Real) -> Real {
    let both = a.bound + b.bound;
    let own = select(a.bound, b.bound, second);
    return Real(select(a.value, b.value, second), select(both, own, abs(a.value - b.value) > both));
}

fn min_(a: Real, b: Real) -> Real {
    return chosen(b.value < a.value, a, b);
}

fn max_(a: Real, b: Real) -> Real {
    return chosen(b.value > a.value, a, b);
}

// `at_least_zero` where `margin >= 0`, else `below_zero`; where that is not sure the bound covers both.
fn select_(margin: Real, at_least_zero: Real, below_zero: Real) -> Real {
    let positive = margin.value >= 0.0;
    let value = select(below_zero.value, at_least_zero.value, positive);
    let own = select(below_zero.bound, at_least_zero.bound, positive);
    let other = select(at_least_zero.bound, below_zero.bound, positive);
    let sure = margin.bound == 0.0 || abs(margin.value) > margin.bound;
    return Real(value, select(own + abs(at_least_zero.value - below_zero.value) + other, own, sure));
}

// What a square root and a division may be off by together, where they make a bound that holds with nothing to spare.
const ROOTED: f32 = 1.000002;

// |sqrt(a) - sqrt(x)| <= |a - x| / sqrt(x), and never more than sqrt(|a - x|).
fn sqrt_(a: Real) -> Real {
    let root = sqrt(max(a.value, 0.0));
    let steep = select(a.bound / root, infinity(), root == 0.0);
    return rounded(root, ROOTED * min(sqrt(a.bound), steep), SQUARE_ROOT);
}

fn exp_m1_(a: Real) -> Real {
    let value = exp_m1(a.value);
    // exp(x + d) - exp(x) <= exp(x) d (1 + d) for d up to 1.
    let inherited = (abs(value) + 1.0) * a.bound * (1.0 + a.bound);
    return rounded(value, select(infinity(), inherited, a.bound < 1.0), FUNCTION);
}

fn ln_1p_(a: Real) -> Real {
    let argument = 1.0 + a.value;
    return rounded(ln_1p(a.value), bound_over(a.bound, argument - a.bound - ROUNDING * abs(argument), argument), FUNCTION);
}

fn sin_(a: Real) -> Real {
    return rounded(sine(a.value), a.bound, FUNCTION);
}

fn cos_(a: Real) -> Real {
    return rounded(cosine(a.value), a.bound, FUNCTION);
}

// The slope is taken at the end of the argument's range that lies nearer to one. That end is rounded away from zero: beside one, half an
// ULP is a large part of what is left. And two arc sines are never farther apart than those of 1 and 1 - d, where d is the distance of
// their arguments: pi/2 sqrt(d) for d up to 1, pi/sqrt(2) sqrt(d) for d up to 2.
fn asin_(a: Real) -> Real {
    let end = (abs(a.value) + a.bound) * 1.00000024;
    let steep = a.bound / sqrt((1.0 - end) * (1.0 + end));
    let anywhere = select(f32(2.2215), 1.5708, a.bound <= 1.0) * sqrt(a.bound);
    let inherited = ROOTED * min(select(infinity(), steep, end < 1.0), anywhere);
    let value = arc_sine(a.value);
    return rounded(value, inherited + rooted_arc(a.value, value), FUNCTION);
}

// Beyond one half `arc_sine` takes a square root: what WGSL lets that be off by is 1.11 times as much, at most, of the angle to pi/2.
fn rooted_arc(at: f32, value: f32) -> f32 {
    return select(0.0, 1.11 * SQUARE_ROOT * (1.5708 - abs(value)), abs(at) > 0.5);
}

// Exact unless a whole number lies within the bound; then as many whole numbers off as the bound reaches over. Below zero the distance from
// the whole number below may be rounded up to 1, and that from the one above down to 0, which leaves nothing sure. A bound that is no number
// stays one.
fn floor_(a: Real) -> Real {
    let value = floor(a.value);
    let above = a.value - value;
    let sure = a.bound == 0.0 || (a.bound < above && a.bound < 1.0 - above);
    return Real(value, select(ceil(a.bound), 0.0, sure));
}

// The search for the root of an increasing function: Newton's steps inside a shrinking bracket, as in `bracketed_newton` of src/real.
struct Search {
    low: f32,
    high: f32,
    x: f32,
    last: f32,
    done: bool,
}

// NEWTON_STEPS, how many steps a search may take, is declared where a kernel is put together: what a search that was ended early missed
// stands in the bound of its root.
// Steps so small, relative to the place, are at the level of rounding: they end when they no longer shrink.
const AT_ROUNDING: f32 = 1.2e-3;
// Stands for the step before the first one, and for one that halved the bracket.
const NO_STEP: f32 = 3e38;

fn begin_search(low: f32, high: f32, start: f32) -> Search {
    return Search(low, high, min(max(start, low), high), NO_STEP, false);
}

fn newton_step(search: Search, value: f32, slope: f32) -> Search {
    return step_of(search, value, slope, false);
}

// The same of a smooth function: a step is about the square of the one before, times a number. The next one would be
// moved * (moved / last)^2, which is not taken where it would be below rounding.
fn smooth_newton_step(search: Search, value: f32, slope: f32) -> Search {
    return step_of(search, value, slope, true);
}

fn step_of(search: Search, value: f32, slope: f32, is_smooth: bool) -> Search {
    let low = select(search.x, search.low, value > 0.0);
    let high = select(search.high, search.x, value > 0.0);
    let newton = search.x - value / slope;
    let is_newton = newton >= low && newton <= high;
    let next = select(0.5 * (low + high), newton, is_newton);
    let moved = abs(next - search.x);
    let shrunk = moved / search.last;
    let is_near = is_newton && search.last <= 1e-4 * abs(search.x);
    let no_more = is_smooth && is_near && moved * shrunk * shrunk <= 0.125 * ROUNDING * abs(search.x);
    let done = moved == 0.0 || no_more || (moved <= AT_ROUNDING * abs(search.x) && moved >= 0.5 * search.last);
    return Search(low, high, next, select(moved, NO_STEP, is_smooth && !is_newton), done);
}

// The root of an increasing function that f32 steps ended at, from the value and slope there: the exact function is within
// `value.bound` of the f32 one. The slope varies little over a few ULP, for which a factor 2 is ample.
fn root(at: f32, value: Real, slope: Real) -> Real {
    let least_slope = 0.5 * (abs(slope.value) - slope.bound);
    return rounded(at, bound_over(abs(value.value) + value.bound, least_slope, least_slope), ROUNDING);
}
