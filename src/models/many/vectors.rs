//! Loops over columns of numbers, in the widest vectors that the processor has.

use crate::real::LANES;
use multiversion::multiversion;

/// What is known of a column of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ColumnEnds {
    /// The least number; infinity if there is none. NaN counts as none.
    pub low: f64,
    /// The largest number; negative infinity if there is none.
    pub high: f64,
    /// No NaN among them.
    pub numbers: bool,
    /// All are whole or infinite.
    pub whole: bool,
}

/// The ends of a column.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub(crate) fn ends(values: &[f64]) -> ColumnEnds {
    let (mut low, mut high) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
    let (mut nan, mut broken) = ([0_u64; LANES], [0_u64; LANES]);
    let (whole, rest) = values.as_chunks::<LANES>();
    // The rest with its last number again and again.
    let mut last = [rest.last().copied().unwrap_or_default(); LANES];
    last[..rest.len()].copy_from_slice(rest);
    for numbers in whole.iter().chain((!rest.is_empty()).then_some(&last)) {
        // A loop for each question: in one the compiler shuffles lanes, which takes four times as long.
        for (low, &it) in low.iter_mut().zip(numbers) {
            *low = if it < *low { it } else { *low };
        }
        for (high, &it) in high.iter_mut().zip(numbers) {
            *high = if it > *high { it } else { *high };
        }
        for (nan, it) in nan.iter_mut().zip(numbers) {
            *nan |= u64::from(it.is_nan());
        }
        for (broken, &it) in broken.iter_mut().zip(numbers) {
            *broken |= u64::from(it != it.trunc());
        }
    }
    ColumnEnds {
        low: low.into_iter().fold(f64::INFINITY, f64::min),
        high: high.into_iter().fold(f64::NEG_INFINITY, f64::max),
        numbers: nan == [0; LANES],
        whole: broken == [0; LANES],
    }
}

/// Numbers times the first factor, divided by the second: the bits of [`Unit::to_si`](crate::units::Unit::to_si), of whose factors one is
/// 1 as a rule. True if all of them are finite then.
pub(crate) fn converted(values: &[f64], (multiply, divide): (f64, f64), to: &mut [f64]) -> bool {
    match (multiply == 1.0, divide == 1.0) {
        (true, true) => copied(values, to),
        (false, true) => multiplied(values, multiply, to),
        (true, false) => divided(values, divide, to),
        (false, false) => both(values, multiply, divide, to),
    }
}

macro_rules! conversions {
    ($($name:ident($value:ident $(, $factor:ident)*) = $converted:expr;)*) => {$(
        #[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
        fn $name(values: &[f64] $(, $factor: f64)*, to: &mut [f64]) -> bool {
            let mut finite = true;
            for (to, &$value) in to.iter_mut().zip(values) {
                *to = $converted;
                finite &= to.is_finite();
            }
            finite
        }
    )*};
}

conversions! {
    copied(value) = value;
    multiplied(value, factor) = value * factor;
    divided(value, divisor) = value / divisor;
    both(value, factor, divisor) = value * factor / divisor;
}

/// Marks where a margin fails, which no number does too; true if one fails.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub(super) fn failures(margins: &[f64], strict: bool, failed: &mut [bool]) -> bool {
    let mut any = false;
    let mut mark = |failed: &mut bool, holds: bool| {
        *failed = !holds;
        any |= !holds;
    };
    let marked = failed.iter_mut().zip(margins);
    if strict {
        marked.for_each(|(failed, &margin)| mark(failed, margin > 0.0));
    } else {
        marked.for_each(|(failed, &margin)| mark(failed, margin >= 0.0));
    }
    any
}

/// Writes a number where there is a mark.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub(super) fn write_marked(numbers: &mut [u16], marks: &[bool], new: u16) {
    numbers.iter_mut().zip(marks).for_each(|(number, &mark)| *number = if mark { new } else { *number });
}

/// Adds marks to marks.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub(super) fn join(marks: &mut [bool], others: &[bool]) {
    marks.iter_mut().zip(others).for_each(|(mark, &other)| *mark |= other);
}

/// Takes away marked values and those that are not finite; true if one was not finite without a mark.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub(super) fn clear(column: &mut [f64], gone: &[bool]) -> bool {
    let mut overflown = false;
    for (value, &gone) in column.iter_mut().zip(gone) {
        let finite = value.is_finite();
        overflown |= !finite & !gone;
        *value = if gone | !finite { f64::NAN } else { *value };
    }
    overflown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_those_of_all_numbers() {
        let mut values: Vec<f64> = (0..37).map(f64::from).collect();
        let whole = ColumnEnds { low: 0.0, high: 36.0, numbers: true, whole: true };
        assert_eq!(ends(&values), whole);
        for place in [0, 7, 8, 31, 36] {
            let kept = values[place];
            values[place] = 99.5;
            assert_eq!((ends(&values).high, ends(&values).whole), (99.5, false), "{place}");
            values[place] = -1.0;
            assert_eq!(ends(&values).low, -1.0, "{place}");
            values[place] = f64::NAN;
            assert!(!ends(&values).numbers, "{place}");
            values[place] = kept;
        }
        assert_eq!(ends(&values), whole);
        assert_eq!(ends(&[]), ColumnEnds { low: f64::INFINITY, high: f64::NEG_INFINITY, numbers: true, whole: true });
    }

    #[test]
    fn a_factor_of_one_changes_no_bit() {
        let values = [0.1, -0.0, 1e300, 3.0, f64::MIN_POSITIVE];
        let mut to = [0.0; 5];
        assert!(!converted(&values, (1e10, 1.0), &mut to) && !converted(&values, (1.0, 1e-10), &mut to));
        assert!(!converted(&[1.0, f64::INFINITY], (1.0, 1.0), &mut to) && !converted(&[f64::NAN], (1.0, 3.0), &mut to));
        for (multiply, divide) in [(1.0, 1.0), (std::f64::consts::PI, 180.0), (1.0, 1000.0), (1e6, 1.0)] {
            assert!(converted(&values, (multiply, divide), &mut to));
            for (to, value) in to.iter().zip(values) {
                assert_eq!(to.to_bits(), (value * multiply / divide).to_bits());
            }
        }
    }
}
