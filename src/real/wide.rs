//! Elementary functions of f64 over columns: the bits of `libm`, many at a time.
//!
//! Each function does what `libm` does, the operations in the same order, but without branches: what these choose among is computed
//! in every lane and selected. A lane in which `libm` takes a rare way (no number, out of range, arguments that need a long reduction) is
//! left to `libm` itself. The algorithms are those of FreeBSD's msun: Copyright (C) 1993 by Sun Microsystems, Inc. All rights reserved.
//! Developed at SunSoft, a Sun Microsystems, Inc. business. Permission to use, copy, modify, and distribute this software is freely
//! granted, provided that this notice is preserved.

#![allow(clippy::excessive_precision, clippy::approx_constant, reason = "the constants as they are published")]
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_possible_wrap, reason = "parts of the bits of a number")]

use multiversion::multiversion;

const LN2_HI: f64 = 6.931_471_803_691_238_164_90e-01;
const LN2_LO: f64 = 1.908_214_929_270_587_700_02e-10;

/// The sign and exponent of a number, with the upper bits of its mantissa.
#[inline(always)]
fn high(x: f64) -> u64 {
    x.to_bits() >> 32
}

/// The same without the sign.
#[inline(always)]
fn high_abs(x: f64) -> u64 {
    high(x) & 0x7fff_ffff
}

/// `log(1 + x)` for x > -1 that is finite.
#[inline(always)]
pub(super) fn ln_1p_of(x: f64) -> f64 {
    const LG: [f64; 7] = [
        6.666_666_666_666_735_130e-01,
        3.999_999_999_940_941_908e-01,
        2.857_142_874_366_239_149e-01,
        2.222_219_843_214_978_396e-01,
        1.818_357_216_161_805_012e-01,
        1.531_383_769_920_937_332e-01,
        1.479_819_860_511_658_591e-01,
    ];
    let hx = high(x);
    let is_near = hx < 0x3fda_827a || (0x8000_0000..=0xbfd2_bec4).contains(&hx);
    let u = 1.0 + x;
    let hu = high(u) + (0x3ff0_0000 - 0x3fe6_a09e);
    let k = (hu >> 20) as i32 - 0x3ff;
    let c = if k >= 2 { 1.0 - (u - x) } else { x - (u - 1.0) } / u;
    let c = if k < 54 { c } else { 0.0 };
    let reduced = f64::from_bits((((hu & 0x000f_ffff) + 0x3fe6_a09e) << 32) | (u.to_bits() & 0xffff_ffff));
    let (f, c, k) = if is_near { (x, 0.0, 0) } else { (reduced - 1.0, c, k) };
    let hfsq = 0.5 * f * f;
    let s = f / (2.0 + f);
    let z = s * s;
    let w = z * z;
    let t1 = w * (LG[1] + w * (LG[3] + w * LG[5]));
    let t2 = z * (LG[0] + w * (LG[2] + w * (LG[4] + w * LG[6])));
    let r = t2 + t1;
    let dk = f64::from(k);
    let value = s * (hfsq + r) + (dk * LN2_LO + c) - hfsq + f + dk * LN2_HI;
    if high_abs(x) < 0x3ca0_0000 { x } else { value }
}

#[inline(always)]
pub(super) fn ln_1p_is_rare(x: f64) -> bool {
    !(x > -1.0 && x < f64::INFINITY)
}

/// `exp(x) - 1` for x from -38.8 to 708.
#[inline(always)]
pub(super) fn exp_m1_of(x: f64) -> f64 {
    // Where the bits' upper half says so: about log 2 / 2, 3 log 2 / 2 and 2^-54.
    const UNSHIFTED: f64 = f64::from_bits(0x3fd6_2e43 << 32);
    const BY_ONE: f64 = f64::from_bits(0x3ff0_a2b2 << 32);
    const TINY: f64 = f64::from_bits(0x3c90_0000 << 32);
    /// Added to a whole number it leaves that number in the last bits.
    const WHOLE: f64 = 6_755_399_441_055_744.0;
    const INVLN2: f64 = 1.442_695_040_888_963_387_00;
    const Q: [f64; 5] = [
        -3.333_333_333_333_313_164_28e-02,
        1.587_301_587_254_814_601_65e-03,
        -7.936_507_578_674_879_424_73e-05,
        4.008_217_827_329_362_395_52e-06,
        -2.010_992_181_836_243_713_26e-07,
    ];
    let size = x.abs();
    let (half, one) = if x < 0.0 { (-0.5, -1.0) } else { (0.5, 1.0) };
    // A whole number all along: two vectors of 32 bits would have to be widened again and again.
    let shift = if size >= UNSHIFTED { if size < BY_ONE { one } else { (INVLN2 * x + half).trunc() } } else { 0.0 };
    let hi = x - shift * LN2_HI;
    let lo = shift * LN2_LO;
    let r = hi - lo;
    let c = (hi - r) - lo;
    let hfx = 0.5 * r;
    let hxs = r * hfx;
    let r1 = 1.0 + hxs * (Q[0] + hxs * (Q[1] + hxs * (Q[2] + hxs * (Q[3] + hxs * Q[4]))));
    let t = 3.0 - r1 * hfx;
    let e = hxs * ((r1 - t) / (6.0 - r * t));
    let unscaled = r - (r * e - hxs);
    let e = r * (e - c) - c - hxs;
    let k = (shift + WHOLE).to_bits().wrapping_sub(WHOLE.to_bits());
    let power = |k: u64| f64::from_bits(0x3ff_u64.wrapping_add(k) << 52);
    let (twopk, uf) = (power(k), power(k.wrapping_neg()));
    let below = 0.5 * (r - e) - 0.5;
    let above = if r < -0.25 { -2.0 * (e - (r + 0.5)) } else { 1.0 + 2.0 * (r - e) };
    let far = (r - e + 1.0) * twopk - 1.0;
    let small = (r - e + (1.0 - uf)) * twopk;
    let large = (r - (e + uf) + 1.0) * twopk;
    let scaled = if shift < 20.0 { small } else { large };
    let scaled = if (0.0..=56.0).contains(&shift) { scaled } else { far };
    let scaled = if shift == 1.0 { above } else { scaled };
    let scaled = if shift == -1.0 { below } else { scaled };
    let scaled = if shift == 0.0 { unscaled } else { scaled };
    if size < TINY { x } else { scaled }
}

#[inline(always)]
pub(super) fn exp_m1_is_rare(x: f64) -> bool {
    // What is -1 to the last bit, and what is next to an overflow or beyond it.
    !(x > -38.8 && x < 708.0)
}

const PIO2_HI: f64 = 1.570_796_326_794_896_558_00;
const PIO2_LO: f64 = 6.123_233_995_736_766_035_87e-17;

/// What [`asin_of`] adds to a number times the number, given its square.
#[inline(always)]
fn asin_rest(z: f64) -> f64 {
    const P: [f64; 6] = [
        1.666_666_666_666_666_574_15e-01,
        -3.255_658_186_224_009_154_05e-01,
        2.012_125_321_348_629_258_81e-01,
        -4.005_553_450_067_941_140_27e-02,
        7.915_349_942_898_145_321_76e-04,
        3.479_331_075_960_211_675_70e-05,
    ];
    const Q: [f64; 4] = [
        -2.403_394_911_734_414_218_78e+00,
        2.020_945_760_233_505_694_71e+00,
        -6.882_839_716_054_532_930_30e-01,
        7.703_815_055_590_193_527_91e-02,
    ];
    let p = z * (P[0] + z * (P[1] + z * (P[2] + z * (P[3] + z * (P[4] + z * P[5])))));
    let q = 1.0 + z * (Q[0] + z * (Q[1] + z * (Q[2] + z * Q[3])));
    p / q
}

/// Arc sine for |x| below 1/2.
#[inline(always)]
pub(super) fn asin_near(x: f64) -> f64 {
    let tiny = (0x0010_0000..0x3e50_0000).contains(&high_abs(x));
    if tiny { x } else { x + x * asin_rest(x * x) }
}

/// Is [`asin_near`] the arc sine?
#[inline(always)]
pub(super) fn is_asin_near(x: f64) -> bool {
    x.abs() < 0.5
}

/// Arc sine for |x| below 1.
#[inline(always)]
fn asin_of(x: f64) -> f64 {
    let ix = high_abs(x);
    let is_small = ix < 0x3fe0_0000;
    let far = (1.0 - x.abs()) * 0.5;
    let r = asin_rest(if is_small { x * x } else { far });
    let s = far.sqrt();
    let f = f64::from_bits(s.to_bits() & 0xffff_ffff_0000_0000);
    let c = (far - f * f) / (s + f);
    let middle = 0.5 * PIO2_HI - (2.0 * s * r - (PIO2_LO - 2.0 * c) - (0.5 * PIO2_HI - 2.0 * f));
    let end = PIO2_HI - (2.0 * (s + s * r) - PIO2_LO);
    let large = if ix >= 0x3fef_3333 { end } else { middle };
    let large = if x < 0.0 { -large } else { large };
    let tiny = (0x0010_0000..0x3e50_0000).contains(&ix);
    let small = if tiny { x } else { x + x * r };
    if is_small { small } else { large }
}

#[inline(always)]
fn asin_is_rare(x: f64) -> bool {
    high_abs(x) >= 0x3ff0_0000
}

/// Sine for |x| up to pi/4.
#[inline(always)]
pub(super) fn sin_of(x: f64) -> f64 {
    const S: [f64; 6] = [
        -1.666_666_666_666_663_243_48e-01,
        8.333_333_333_322_489_461_24e-03,
        -1.984_126_982_985_794_931_34e-04,
        2.755_731_370_707_006_767_89e-06,
        -2.505_076_025_340_686_341_95e-08,
        1.589_690_995_211_550_102_21e-10,
    ];
    let z = x * x;
    let w = z * z;
    let r = S[1] + z * (S[2] + z * S[3]) + z * w * (S[4] + z * S[5]);
    let v = z * x;
    let value = x + v * (S[0] + z * r);
    if high_abs(x) < 0x3e50_0000 { x } else { value }
}

/// Cosine for |x| up to pi/4.
#[inline(always)]
pub(super) fn cos_of(x: f64) -> f64 {
    const C: [f64; 6] = [
        4.166_666_666_666_660_190_37e-02,
        -1.388_888_888_887_410_957_49e-03,
        2.480_158_728_947_672_941_78e-05,
        -2.755_731_435_139_066_330_35e-07,
        2.087_572_321_298_174_827_90e-09,
        -1.135_964_755_778_819_482_65e-11,
    ];
    let z = x * x;
    let w = z * z;
    let r = z * (C[0] + z * (C[1] + z * C[2])) + w * w * (C[3] + z * (C[4] + z * C[5]));
    let hz = 0.5 * z;
    let w = 1.0 - hz;
    let value = w + (((1.0 - w) - hz) + (z * r - x * 0.0));
    if high_abs(x) < 0x3e46_a09e { 1.0 } else { value }
}

#[inline(always)]
pub(super) fn turn_is_rare(x: f64) -> bool {
    high_abs(x) > 0x3fe9_21fb
}

macro_rules! over_columns {
    ($($(#[$doc:meta])* $visible:vis $name:ident = $of:ident, $is_rare:ident, $exact:path;)*) => {$(
        $(#[$doc])*
        $visible fn $name(a: &[f64], column: &mut [f64]) {
            #[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
            fn common(a: &[f64], column: &mut [f64]) -> bool {
                let mut rare = false;
                for (it, &a) in column.iter_mut().zip(a) {
                    *it = $of(a);
                    rare |= $is_rare(a);
                }
                rare
            }
            if common(a, column) {
                for (it, &a) in column.iter_mut().zip(a).filter(|(_, a)| $is_rare(**a)) {
                    *it = $exact(a);
                }
            }
        }
    )*};
}

over_columns! {
    /// `log(1 + a)` of a column.
    pub ln_1p = ln_1p_of, ln_1p_is_rare, libm::log1p;
    /// `exp(a) - 1` of a column.
    pub exp_m1 = exp_m1_of, exp_m1_is_rare, libm::expm1;
    /// Arc sine of a column.
    any_asin = asin_of, asin_is_rare, libm::asin;
    /// Sine of a column.
    pub sin = sin_of, turn_is_rare, libm::sin;
    /// Cosine of a column.
    pub cos = cos_of, turn_is_rare, libm::cos;
}

/// Arc sine of a column: in half the time where all numbers are below 1/2, as the sine of a belt's lean is.
pub fn asin(a: &[f64], column: &mut [f64]) {
    #[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
    fn all_near(a: &[f64]) -> bool {
        a.iter().fold(true, |all, a| all & is_asin_near(*a))
    }
    #[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
    fn near(a: &[f64], column: &mut [f64]) {
        column.iter_mut().zip(a).for_each(|(it, &a)| *it = asin_near(a));
    }
    if all_near(a) { near(a, column) } else { any_asin(a, column) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of every size and sign, those about which a way changes, and what is no number.
    fn numbers() -> Vec<f64> {
        let mut seed = 7_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed ^ (seed >> 29)).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        };
        let mut numbers: Vec<f64> = (0..300_000).map(|_| f64::from_bits(random())).collect();
        let fraction = |bits: u64| (bits >> 11) as f64 / (1_u64 << 53) as f64;
        for scale in [1e-9, 0.1, 0.5, 1.0, 2.0, 40.0, 800.0] {
            numbers.extend((0..100_000).map(|_| scale * (2.0 * fraction(random()) - 1.0)));
        }
        let ends = [
            0.0,
            f64::MIN_POSITIVE,
            1e-310,
            0.25,
            0.29,
            0.3466,
            0.4142,
            0.5,
            0.7071,
            0.78539,
            0.975,
            1.0,
            1.0397,
            1.5,
            2.0,
            38.8,
            709.78,
            f64::MAX,
        ];
        for high in [
            0x3fda_827a_u64,
            0x3fd2_bec4,
            0x3ff0_0000,
            0x3ca0_0000,
            0x3fd6_2e42,
            0x3ff0_a2b2,
            0x3c90_0000,
            0x4043_687a,
            0x3fe0_0000,
            0x3fef_3333,
            0x3e50_0000,
            0x0010_0000,
            0x3fe9_21fb,
            0x3e46_a09e,
            0x7ff0_0000,
        ] {
            for low in [0_u64, 1, 0xffff_ffff] {
                for high in [high - 1, high, high + 1] {
                    let it = f64::from_bits((high << 32) | low);
                    numbers.extend([it, -it]);
                }
            }
        }
        for end in ends {
            let mut near = end;
            for _ in 0..50 {
                numbers.extend([near, -near]);
                near = near.next_up();
            }
        }
        numbers.extend([f64::INFINITY, f64::NEG_INFINITY, f64::NAN]);
        numbers
    }

    #[test]
    fn a_column_has_the_bits_that_each_number_has_alone() {
        type Column = fn(&[f64], &mut [f64]);
        type Alone = fn(f64) -> f64;
        let functions: [(&str, Column, Alone); 5] = [
            ("ln_1p", ln_1p, libm::log1p),
            ("exp_m1", exp_m1, libm::expm1),
            ("asin", asin, libm::asin),
            ("sin", sin, libm::sin),
            ("cos", cos, libm::cos),
        ];
        // A column of its own for numbers of one size: some ways are taken for whole columns.
        let all = numbers();
        let near: Vec<f64> = all.iter().copied().filter(|it| it.abs() < 0.5).collect();
        for (name, of_column, alone) in functions {
            for numbers in [&all, &near] {
                let mut column = vec![0.0; numbers.len()];
                of_column(numbers, &mut column);
                for (&x, &found) in numbers.iter().zip(&column) {
                    let exact = alone(x);
                    let same = found.to_bits() == exact.to_bits() || (found.is_nan() && exact.is_nan());
                    assert!(same, "{name}({x:e}): {found:e} in a column, {exact:e} alone");
                }
            }
        }
    }
}
