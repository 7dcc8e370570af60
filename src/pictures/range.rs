//! The range of values that an axis has to cover.

/// Least and greatest of the values, widened by a share of their span at either end, and widened
/// anyway where all are equal, so that there is an axis to draw; `None` without a finite value.
pub(super) fn bounds(values: impl Iterator<Item = f64>, widen: f64) -> Option<(f64, f64)> {
    let finite = values.filter(|v| v.is_finite());
    let (low, high) = finite.fold(None, |seen: Option<(f64, f64)>, v| {
        let (low, high) = seen.unwrap_or((v, v));
        Some((low.min(v), high.max(v)))
    })?;
    // Beyond these no engineering quantity lies, but differences and quotients stay finite.
    let (low, high) = (low.clamp(-1e200, 1e200), high.clamp(-1e200, 1e200));
    let magnitude = low.abs().max(high.abs());
    if magnitude < 1e-200 {
        return Some((-1.0, 1.0));
    }
    if high - low < 1e-9 * magnitude {
        return Some((low - 0.1 * magnitude, high + 0.1 * magnitude));
    }
    let margin = widen * (high - low);
    Some((low - margin, high + margin))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_leave_an_axis_to_draw() {
        let of = |values: &[f64]| bounds(values.iter().copied(), 0.0);
        assert_eq!(of(&[]), None);
        assert_eq!(of(&[f64::NAN, f64::INFINITY]), None);
        assert_eq!(of(&[0.0]), Some((-1.0, 1.0)));
        assert_eq!(of(&[2.0, 1.0]), Some((1.0, 2.0)));
        for value in [1e-12, -3.0, 1e12, 1e300, 5e-324] {
            let (low, high) = of(&[value]).expect("a finite value");
            assert!(low < high && (high - low).is_finite());
        }
    }
}
