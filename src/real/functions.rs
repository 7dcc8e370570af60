//! Own elementary functions in f32: what the shaders compute, line by line the same as `shaders/common/functions.wgsl`.
//!
//! WGSL's built-in functions may be off by thousands of ULP (`asin`, `atan`, `log` near 1), and every driver has others. These
//! stay within [`FUNCTION_ULP`] of the exact value, which the tests below measure against
//! f64 and the self-test measures on every driver.

use std::f32::consts::{LN_2, LOG2_E};

/// ULP that an elementary function (exp, log, sin, ...) may be off by, beyond what its argument's error explains.
pub const FUNCTION_ULP: f64 = 4.0;

/// 2 to a whole power from -126 to 127.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number in range")]
fn power_of_two(power: f32) -> f32 {
    f32::from_bits(((power as i32 + 127) as u32) << 23)
}

/// `exp(x) - 1`, for `x` up to 88; infinite beyond.
pub fn exp_m1(x: f32) -> f32 {
    let power = (x * LOG2_E).round_ties_even().clamp(-126.0, 127.0);
    // ln 2 in two parts, so that the first product is exact.
    let r = (x - power * 0.693_359_4) - power * -2.121_944_4e-4;
    let series =
        r + r * r * (0.5 + r * (0.166_666_67 + r * (0.041_666_668 + r * (8.333_334e-3 + r * (1.388_888_9e-3 + r * 1.984_127e-4)))));
    // 2^k series + (2^k - 1), with one doubling at the end where 2^k itself is too large to be turned over.
    let last = if power > 126.0 { 1.0 } else { 0.0 };
    let scaled = power_of_two(power - last) * (series + (1.0 - power_of_two(last - power)));
    let value = if last > 0.0 { 2.0 * scaled } else { scaled };
    if x > 88.0 {
        f32::INFINITY
    } else if x < -80.0 {
        -1.0
    } else {
        value
    }
}

/// `log(1 + x)`, for `x > -1`.
#[allow(clippy::cast_possible_wrap, clippy::cast_precision_loss, reason = "the bits of an exponent")]
pub fn ln_1p(x: f32) -> f32 {
    if x <= -1.0 {
        return if x == -1.0 { f32::NEG_INFINITY } else { f32::NAN };
    }
    // 1 + x = 2^k m with m in [sqrt(1/2), sqrt(2)); near 0 that would lose the digits of x.
    let small = x > -0.29 && x < 0.415;
    let shifted = (1.0 + x).to_bits().wrapping_sub(0x3f35_04f3);
    let power = (shifted as i32 >> 23) as f32;
    let m = f32::from_bits((shifted & 0x007f_ffff).wrapping_add(0x3f35_04f3));
    // Twice the inverse hyperbolic tangent of s.
    let s = if small { x / (2.0 + x) } else { (m - 1.0) / (m + 1.0) };
    let z = s * s;
    let series = 2.0 * s + 2.0 * s * z * (0.333_333_34 + z * (0.2 + z * (0.142_857_15 + z * (0.111_111_11 + z * 0.090_909_09))));
    series + if small { 0.0 } else { power * LN_2 }
}

/// Of `x = n pi/2 + r` the number `n`.
fn quarter_turns(x: f32) -> f32 {
    (x * 0.636_619_75).round_ties_even()
}

/// Of `x = n pi/2 + r` the rest `r`, with pi/2 in four parts, the first three of which give exact products.
fn within_quarter(x: f32, n: f32) -> f32 {
    (((x - n * 1.570_312_5) - n * 0.000_483_751_3) - n * 7.549_533_6e-8) - n * 2.563_344e-12
}

/// `sin(n pi/2 + r)` for `|r|` up to pi/4.
fn turned(n: i32, r: f32) -> f32 {
    let z = r * r;
    let across = r + r * z * (-0.166_666_67 + z * (8.333_334e-3 + z * (-1.984_127e-4 + z * 2.755_731_9e-6)));
    let along = 1.0 + z * (-0.5 + z * (0.041_666_668 + z * (-1.388_888_9e-3 + z * (2.480_158_8e-5 + z * -2.755_732e-7))));
    let value = if n & 1 == 1 { along } else { across };
    if n & 2 == 2 { -value } else { value }
}

/// `sin(x)`, for `|x|` up to some hundred.
#[allow(clippy::cast_possible_truncation, reason = "a small whole number")]
pub fn sine(x: f32) -> f32 {
    let n = quarter_turns(x);
    turned(n as i32, within_quarter(x, n))
}

/// `cos(x)`, for `|x|` up to some hundred.
#[allow(clippy::cast_possible_truncation, reason = "a small whole number")]
pub fn cosine(x: f32) -> f32 {
    let n = quarter_turns(x);
    turned((n as i32).wrapping_add(1), within_quarter(x, n))
}

/// `asin(x)`, for `|x|` up to 1 (S. Moshier's polynomial in Cephes); NaN beyond.
pub fn arc_sine(x: f32) -> f32 {
    let a = x.abs();
    if a > 1.0 {
        return f32::NAN;
    }
    let large = a > 0.5;
    let z = if large { 0.5 * (1.0 - a) } else { a * a };
    let s = if large { z.max(0.0).sqrt() } else { a };
    let series = s + s * z * (0.166_667_52 + z * (0.074_953 + z * (0.045_470_025 + z * (0.024_181_312 + z * 0.042_163_2))));
    let value = if large { 1.570_796_4 - 2.0 * series } else { series };
    if x < 0.0 { -value } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest error of `function` in ULP of the result over `[low, high]`, ends included.
    #[allow(clippy::cast_possible_truncation)]
    fn worst(function: fn(f32) -> f32, exact: fn(f64) -> f64, low: f64, high: f64) -> f64 {
        let steps = 400_000;
        (0..=steps).fold(0.0, |worst, step| {
            let x = (low + (high - low) * f64::from(step) / f64::from(steps)) as f32;
            let exact = exact(f64::from(x));
            let ulp = f64::from(exact.abs() as f32).max(f64::from(f32::MIN_POSITIVE));
            let ulp = f64::from((ulp as f32).next_up()) - ulp;
            worst.max((f64::from(function(x)) - exact).abs() / ulp)
        })
    }

    /// Name, function, exact function, ranges.
    type Case = (&'static str, fn(f32) -> f32, fn(f64) -> f64, &'static [(f64, f64)]);

    #[test]
    #[allow(clippy::approx_constant, reason = "ranges around multiples of pi/2")]
    fn own_functions_stay_within_three_quarters_of_what_the_bounds_allow() {
        let cases: [Case; 5] = [
            ("exp_m1", exp_m1, libm::expm1, &[(-20.0, 20.0), (-1.0, 1.0), (-1e-3, 1e-3), (60.0, 88.0), (-80.0, -20.0)]),
            ("ln_1p", ln_1p, libm::log1p, &[(-0.999, 10.0), (-0.5, 0.5), (-1e-3, 1e-3), (0.0, 1e6), (1e6, 1e30)]),
            ("sine", sine, libm::sin, &[(-7.0, 7.0), (3.1415, 3.1417), (6.283, 6.2834), (-100.0, 100.0)]),
            ("cosine", cosine, libm::cos, &[(-7.0, 7.0), (1.5707, 1.5709), (4.7123, 4.7125), (-100.0, 100.0)]),
            ("arc_sine", arc_sine, libm::asin, &[(-1.0, 1.0), (0.499, 0.501), (0.999, 1.0), (-1e-3, 1e-3)]),
        ];
        for (name, function, exact, ranges) in cases {
            for &(low, high) in ranges {
                let worst = worst(function, exact, low, high);
                eprintln!("{name} on [{low}, {high}]: {worst:.2} ULP");
                assert!(worst <= 0.75 * FUNCTION_ULP, "{name} is {worst} ULP off on [{low}, {high}]");
            }
        }
    }

    #[test]
    fn beyond_their_range_they_say_so() {
        assert_eq!(exp_m1(89.0), f32::INFINITY);
        assert_eq!(exp_m1(-200.0), -1.0);
        assert_eq!(ln_1p(-1.0), f32::NEG_INFINITY);
        assert!(ln_1p(-2.0).is_nan() && arc_sine(1.1).is_nan());
        assert!(exp_m1(f32::NAN).is_nan() && sine(f32::NAN).is_nan() && cosine(f32::INFINITY).is_nan());
    }
}
