// Own elementary functions in plain f32, within FUNCTION_ULP of the exact value: the built-in ones may be off by thousands of
// ULP. Line by line the same as src/real/functions.rs, whose tests measure them.

const LN_2: f32 = 0.693147182;
const LOG2_E: f32 = 1.44269502;

// Infinity cannot be written as a literal.
fn infinity() -> f32 {
    return bitcast<f32>(0x7f800000u);
}

// A comparison of a NaN with itself may be folded away; its bits may not.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

// 2^power for whole numbers from -126 to 127.
fn power_of_two(power: f32) -> f32 {
    return bitcast<f32>(u32(i32(power) + 127) << 23u);
}

// A whole number as it is, in a way that keeps a compiler from regrouping n a + n b into n (a + b), which would undo that a
// constant stands in two parts.
fn same(n: f32) -> f32 {
    return f32(i32(n));
}

// exp(x) - 1, for x up to 88; infinite beyond.
fn exp_m1(x: f32) -> f32 {
    let power = clamp(round(x * LOG2_E), -126.0, 127.0);
    // ln 2 in two parts, so that the first product is exact.
    let r = (x - power * 0.693359375) - same(power) * -2.12194442e-4;
    let series = r + r * r * (0.5 + r * (0.166666672 + r * (0.0416666679 + r * (8.33333377e-3 + r * (1.38888892e-3 + r * 1.98412701e-4)))));
    // 2^k series + (2^k - 1), with one doubling at the end where 2^k itself is too large to be turned over.
    let last = select(0.0, 1.0, power > 126.0);
    let scaled = power_of_two(power - last) * (series + (1.0 - power_of_two(last - power)));
    let value = select(scaled, 2.0 * scaled, last > 0.0);
    return select(select(value, -1.0, x < -80.0), infinity(), x > 88.0);
}

// log(1 + x), for x > -1.
fn ln_1p(x: f32) -> f32 {
    // 1 + x = 2^k m with m in [sqrt(1/2), sqrt(2)); near 0 that would lose the digits of x.
    let small = x > -0.29 && x < 0.415;
    let shifted = bitcast<u32>(1.0 + x) - 0x3f3504f3u;
    let power = f32(bitcast<i32>(shifted) >> 23u);
    let m = bitcast<f32>((shifted & 0x007fffffu) + 0x3f3504f3u);
    // Twice the inverse hyperbolic tangent of s.
    let s = select((m - 1.0) / (m + 1.0), x / (2.0 + x), small);
    let z = s * s;
    let series = 2.0 * s + 2.0 * s * z * (0.333333343 + z * (0.2 + z * (0.142857149 + z * (0.111111112 + z * 0.0909090936))));
    return series + select(power * LN_2, 0.0, small);
}

// Of x = n pi/2 + r: the number n, and r with pi/2 in four parts, the first three of which give exact products.
fn quarter_turns(x: f32) -> f32 {
    return round(x * 0.636619747);
}

fn within_quarter(x: f32, n: f32) -> f32 {
    let near = ((x - n * 1.5703125) - same(n) * 0.000483751297) - 0.5 * same(n + n) * 7.54953362e-08;
    return near - 0.25 * same(4.0 * n) * 2.56334407e-12;
}

// sin(n pi/2 + r) for |r| up to pi/4.
fn turned(n: i32, r: f32) -> f32 {
    let z = r * r;
    let across = r + r * z * (-0.166666672 + z * (8.33333377e-3 + z * (-1.98412701e-4 + z * 2.75573188e-6)));
    let along = 1.0 + z * (-0.5 + z * (0.0416666679 + z * (-1.38888892e-3 + z * (2.48015876e-5 + z * -2.75573188e-7))));
    let value = select(across, along, (n & 1) == 1);
    return select(value, -value, (n & 2) == 2);
}

// sin(x), for |x| up to some hundred.
fn sine(x: f32) -> f32 {
    let n = quarter_turns(x);
    return turned(i32(n), within_quarter(x, n));
}

// cos(x), for |x| up to some hundred.
fn cosine(x: f32) -> f32 {
    let n = quarter_turns(x);
    return turned(i32(n) + 1, within_quarter(x, n));
}

// asin(x), for |x| up to 1 (S. Moshier's polynomial in Cephes).
fn arc_sine(x: f32) -> f32 {
    let a = abs(x);
    let large = a > 0.5;
    let z = select(a * a, 0.5 * (1.0 - a), large);
    let s = select(a, sqrt(max(z, 0.0)), large);
    let series = s + s * z * (0.166667521 + z * (0.0749530047 + z * (0.0454700254 + z * (0.0241813120 + z * 0.0421631992))));
    let value = select(series, 1.57079637 - 2.0 * series, large);
    return select(value, -value, x < 0.0);
}
