//! Loops over columns of values, compiled for several instruction sets.
//!
//! A mask has all bits set where a design is still in, none where it is out. Only comparisons and copies happen here, so the
//! instruction set cannot change a result.

use crate::models::Worse;
use multiversion::multiversion;

const IN: u64 = u64::MAX;

/// All bits or none.
#[inline(always)]
pub fn mask(inside: bool) -> u64 {
    if inside { IN } else { 0 }
}

/// Keeps the designs whose condition margin is at least zero (`strict`: above zero).
pub fn keep_margin(alive: &mut [u64], margins: &[f64], strict: bool) {
    keep_between(alive, margins, if strict { f64::from_bits(1) } else { 0.0 }, f64::INFINITY);
}

/// Keeps the designs whose value is a finite number.
pub fn keep_finite(alive: &mut [u64], values: &[f64]) {
    keep_between(alive, values, f64::MIN, f64::MAX);
}

/// Keeps the designs with `low <= value <= high`; NaN never is.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub fn keep_between(alive: &mut [u64], values: &[f64], low: f64, high: f64) {
    for (alive, &value) in alive.iter_mut().zip(values) {
        *alive &= mask(value >= low) & mask(value <= high);
    }
}

/// Keeps the designs that are marked.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub fn keep_marked(alive: &mut [u64], marks: &[u64]) {
    alive.iter_mut().zip(marks).for_each(|(alive, mark)| *alive &= mark);
}

/// Counts once more each design that is in.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub fn add_one(counts: &mut [u64], alive: &[u64]) {
    counts.iter_mut().zip(alive).for_each(|(count, alive)| *count += alive & 1);
}

/// Of the designs that are ok: marks those whose value is not between two ends, which are ok no longer.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub fn mark_outside(ok: &mut [u64], marks: &mut [u64], values: &[f64], (low, high): (f64, f64)) {
    for ((ok, mark), &value) in ok.iter_mut().zip(marks).zip(values) {
        let inside = mask(value >= low) & mask(value <= high);
        *mark |= *ok & !inside;
        *ok &= inside;
    }
}

/// Of the designs that are ok: marks those whose finite value is not between two ends, and those whose value is not finite.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub fn mark_violations(ok: &[u64], marks: &mut [u64], overflow: &mut [u64], values: &[f64], (low, high): (f64, f64)) {
    for (((&ok, mark), overflow), &value) in ok.iter().zip(marks).zip(overflow).zip(values) {
        let is_finite = mask(value >= f64::MIN) & mask(value <= f64::MAX);
        *mark |= ok & is_finite & !(mask(value >= low) & mask(value <= high));
        *overflow |= ok & !is_finite;
    }
}

/// Of the designs that are ok: marks those whose value is not finite.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub fn mark_overflow(ok: &[u64], overflow: &mut [u64], values: &[f64]) {
    for ((&ok, overflow), &value) in ok.iter().zip(overflow).zip(values) {
        *overflow |= ok & !(mask(value >= f64::MIN) & mask(value <= f64::MAX));
    }
}

/// Lowers each worst value to the new one where that is less.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub fn lower(worst: &mut [f64], values: &[f64]) {
    for (worst, &value) in worst.iter_mut().zip(values) {
        *worst = if value < *worst { value } else { *worst };
    }
}

/// Raises each worst value to the new one where that is greater.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub fn raise(worst: &mut [f64], values: &[f64]) {
    for (worst, &value) in worst.iter_mut().zip(values) {
        *worst = if value > *worst { value } else { *worst };
    }
}

/// Takes the values of a scenario into the worst ones, which the first scenario begins.
pub fn worsen(worse: Worse, is_first: bool, worst: &mut [f64], values: &[f64]) {
    match worse {
        _ if is_first => worst.copy_from_slice(values),
        Worse::Higher => raise(worst, values),
        Worse::Lower => lower(worst, values),
    }
}

/// Number of designs still in.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub fn count(alive: &[u64]) -> u64 {
    alive.iter().map(|alive| alive & 1).sum()
}

/// Is any design still in?
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub fn any(alive: &[u64]) -> bool {
    alive.iter().fold(0, |any, alive| any | alive) != 0
}

/// What is out becomes a NaN, which no comparison takes.
#[inline(always)]
fn if_in(alive: u64, value: f64) -> f64 {
    f64::from_bits(value.to_bits() | !alive)
}

/// Least and largest value of the designs still in; infinite the wrong way round if there are none.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub fn ends(alive: &[u64], values: &[f64]) -> (f64, f64) {
    const WIDTH: usize = 16;
    let (mut least, mut largest) = ([f64::INFINITY; WIDTH], [f64::NEG_INFINITY; WIDTH]);
    let (alive_chunks, alive_rest) = alive.as_chunks::<WIDTH>();
    let (value_chunks, value_rest) = values.as_chunks::<WIDTH>();
    for (alive, values) in alive_chunks.iter().zip(value_chunks) {
        let mut present = *values;
        for lane in 0..WIDTH {
            present[lane] = if_in(alive[lane], values[lane]);
        }
        // One loop for each end: a common one is compiled to shuffles that cost more than both.
        for lane in 0..WIDTH {
            least[lane] = if present[lane] < least[lane] { present[lane] } else { least[lane] };
        }
        for lane in 0..WIDTH {
            largest[lane] = if present[lane] > largest[lane] { present[lane] } else { largest[lane] };
        }
    }
    for (lane, (&alive, &value)) in alive_rest.iter().zip(value_rest).enumerate() {
        let value = if_in(alive, value);
        least[lane] = if value < least[lane] { value } else { least[lane] };
        largest[lane] = if value > largest[lane] { value } else { largest[lane] };
    }
    (least.into_iter().fold(f64::INFINITY, f64::min), largest.into_iter().fold(f64::NEG_INFINITY, f64::max))
}

/// Least and largest of some values; `None` if one is no number.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub fn all_ends(values: &[f64]) -> Option<(f64, f64)> {
    const WIDTH: usize = 16;
    let (mut least, mut largest, mut none) = ([f64::INFINITY; WIDTH], [f64::NEG_INFINITY; WIDTH], [0; WIDTH]);
    let (chunks, rest) = values.as_chunks::<WIDTH>();
    for values in chunks {
        for lane in 0..WIDTH {
            least[lane] = if values[lane] < least[lane] { values[lane] } else { least[lane] };
        }
        for lane in 0..WIDTH {
            largest[lane] = if values[lane] > largest[lane] { values[lane] } else { largest[lane] };
        }
        for lane in 0..WIDTH {
            none[lane] |= mask(values[lane].is_nan());
        }
    }
    for (lane, &value) in rest.iter().enumerate() {
        least[lane] = if value < least[lane] { value } else { least[lane] };
        largest[lane] = if value > largest[lane] { value } else { largest[lane] };
        none[lane] |= mask(value.is_nan());
    }
    let ends = (least.into_iter().fold(f64::INFINITY, f64::min), largest.into_iter().fold(f64::NEG_INFINITY, f64::max));
    (none == [0; WIDTH]).then_some(ends)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{Constraint, OverScenarios, Quantity};

    #[test]
    fn the_columns_agree_with_the_scalar_definition() {
        let values = [-1.0, -0.0, 0.0, f64::MIN_POSITIVE, 1.0, 1.0f64.next_up(), f64::NAN, f64::INFINITY, 2.0];
        let bounds = [None, Some((0.0, false)), Some((0.0, true)), Some((1.0, false)), Some((1.0, true))];
        for low in bounds {
            for high in bounds {
                let constraint = Constraint { quantity: Quantity::Input(0), low, high, over: OverScenarios::Worst };
                let mut alive = [IN; 9];
                let (low, high) = constraint.ends();
                keep_between(&mut alive, &values, low, high);
                for (alive, value) in alive.iter().zip(values) {
                    assert_eq!(*alive != 0, constraint.holds(value) && value.is_finite(), "{value} in {low:?} {high:?}");
                }
            }
        }
    }

    #[test]
    fn ends_ignore_what_is_out() {
        assert_eq!(ends(&[IN, 0, IN], &[3.0, 9.0, 2.0]), (2.0, 3.0));
        assert_eq!(ends(&[0], &[3.0]), (f64::INFINITY, f64::NEG_INFINITY));
        assert_eq!(count(&[IN, 0, IN]), 2);
    }

    #[test]
    fn all_ends_are_those_of_all_values_wherever_they_stand() {
        for count in [1, 15, 16, 37] {
            for place in 0..count {
                let mut values = vec![1.5; count];
                assert_eq!(all_ends(&values), Some((1.5, 1.5)));
                values[place] = 2.0;
                assert_eq!(all_ends(&values).map(|it| it.1), Some(2.0), "{place} of {count}");
                values[place] = f64::NEG_INFINITY;
                assert_eq!(all_ends(&values).map(|it| it.0), Some(f64::NEG_INFINITY), "{place} of {count}");
                values[place] = f64::NAN;
                assert_eq!(all_ends(&values), None, "{place} of {count}");
            }
        }
        assert_eq!(all_ends(&[]), Some((f64::INFINITY, f64::NEG_INFINITY)));
    }
}
