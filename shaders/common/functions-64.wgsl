// Elementary functions in f64, for the first stage of a sweep on devices that have it: WGSL's built-in ones exist for f32 only, and what a
// driver makes of them in f64 is garbage. Within FUNCTION_64 of the exact value, which the self-test measures; numbers.wgsl says the rest,
// in both precisions.

fn infinity_64() -> f64 {
    return f64(infinity());
}

// x less a multiple of a number whose digits stand in two parts. In fused operations, since some drivers regroup sums of products, which
// would undo that there are parts; where a driver does not fuse them, the products with the first part are exact.
fn less_parts_64(x: f64, times: f64, leading: f64, behind: f64) -> f64 {
    return fma(-times, behind, fma(-times, leading, x));
}

// 2^power for whole numbers from -126 to 127.
fn power_of_two_64(power: f64) -> f64 {
    return f64(power_of_two(f32(power)));
}

// exp(x) - 1, for x up to 88; infinite beyond. The series ends where its next term is below half an ULP for |r| <= ln(2) / 2.
fn exp_m1_64(x: f64) -> f64 {
    let power = clamp(round(x * 1.4426950408889634), -126.0, 127.0);
    // ln 2 in two parts, so that the first product is exact.
    let r = less_parts_64(x, power, 0.6931471803691238, 1.9082149292705877e-10);
    let last = 1.0 / 39916800.0 + r * (1.0 / 479001600.0 + r * (1.0 / 6227020800.0));
    let far = 1.0 / 40320.0 + r * (1.0 / 362880.0 + r * (1.0 / 3628800.0 + r * last));
    let near = 1.0 / 6.0 + r * (1.0 / 24.0 + r * (1.0 / 120.0 + r * (1.0 / 720.0 + r * (1.0 / 5040.0 + r * far))));
    let series = r + r * r * (0.5 + r * near);
    let value = power_of_two_64(power) * (series + (1.0 - power_of_two_64(-power)));
    return select(select(value, -1.0, x < -80.0), infinity_64(), x > 88.0);
}

// log(1 + x), for x > -1.
fn ln_1p_64(x: f64) -> f64 {
    // 1 + x = 2^k m with m in [sqrt(1/2), sqrt(2)); near 0 that would lose the digits of x.
    let small = x > -0.29 && x < 0.415;
    let power = f64(bitcast<i32>(bitcast<u32>(f32(1.0 + x)) - 0x3f3504f3u) >> 23u);
    let m = (1.0 + x) * power_of_two_64(clamp(-power, -126.0, 127.0));
    // Twice the inverse hyperbolic tangent of s.
    let s = select((m - 1.0) / (m + 1.0), x / (2.0 + x), small);
    let z = s * s;
    let far = 1.0 / 15.0 + z * (1.0 / 17.0 + z * (1.0 / 19.0 + z * (1.0 / 21.0 + z * (1.0 / 23.0))));
    let near = 1.0 / 3.0 + z * (0.2 + z * (1.0 / 7.0 + z * (1.0 / 9.0 + z * (1.0 / 11.0 + z * (1.0 / 13.0 + z * far)))));
    let series = 2.0 * s + 2.0 * s * z * near;
    return select(fma(power, 0.6931471803691238, fma(power, 1.9082149292705877e-10, series)), series, small);
}

// Of x = n pi/2 + r: the number n, and r with pi/2 in three parts, the first two of which give exact products.
fn quarter_turns_64(x: f64) -> f64 {
    return round(x * 0.6366197723675814);
}

fn within_quarter_64(x: f64, n: f64) -> f64 {
    return fma(-n, 2.0222662487959506e-21, less_parts_64(x, n, 1.5707963267341256, 6.0771005063039660e-11));
}

// sin(n pi/2 + r) for |r| up to pi/4.
fn turned_64(n: i32, r: f64) -> f64 {
    let z = r * r;
    let sine = 1.0 / 6227020800.0 + z * (-1.0 / 1307674368000.0 + z * (1.0 / 355687428096000.0));
    let far = 1.0 / 362880.0 + z * (-1.0 / 39916800.0 + z * sine);
    let across = r + r * z * (-1.0 / 6.0 + z * (1.0 / 120.0 + z * (-1.0 / 5040.0 + z * far)));
    let cosine = z * (-1.0 / 3628800.0 + z * (1.0 / 479001600.0 + z * (-1.0 / 87178291200.0 + z * (1.0 / 20922789888000.0))));
    let along = 1.0 + z * (-0.5 + z * (1.0 / 24.0 + z * (-1.0 / 720.0 + z * (1.0 / 40320.0 + cosine))));
    let value = select(across, along, (n & 1) == 1);
    return select(value, -value, (n & 2) == 2);
}

// sin(x), for |x| up to some hundred.
fn sine_64(x: f64) -> f64 {
    let n = quarter_turns_64(x);
    return turned_64(i32(n), within_quarter_64(x, n));
}

// cos(x), for |x| up to some hundred.
fn cosine_64(x: f64) -> f64 {
    let n = quarter_turns_64(x);
    return turned_64(i32(n) + 1, within_quarter_64(x, n));
}

// asin(x), for |x| up to 1. The rational function's coefficients are those of FreeBSD's msun (e_asin.c).
fn arc_sine_64(x: f64) -> f64 {
    let a = abs(x);
    let large = a > 0.5;
    let z = select(a * a, 0.5 * (1.0 - a), large);
    let s = select(a, sqrt(max(z, 0.0)), large);
    let last = -0.04005553450067941 + z * (0.0007915349942898145 + z * 3.479331075960212e-5);
    let over = 0.16666666666666666 + z * (-0.3255658186224009 + z * (0.20121253213486293 + z * last));
    let under = 1.0 + z * (-2.403394911734414 + z * (2.0209457602335057 + z * (-0.6882839716054533 + z * 0.07703815055590194)));
    let series = s + s * (z * over / under);
    let value = select(series, 1.5707963267948966 - (2.0 * series - 6.123233995736766e-17), large);
    return select(value, -value, x < 0.0);
}
