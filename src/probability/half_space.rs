//! The share of a unit cube on one side of a plane, with proven bounds.

/// Most dimensions of a cube.
pub const DIMENSIONS: usize = 4;

/// A coefficient below this share of the largest one is not integrated over but bounded: the exact formula divides by the product of all
/// of them, and rounding would be divided too. What this costs is at most this share of the cube.
const SMALL: f64 = 1.0 / 64.0;

/// Bounds of the share of the points s of the unit cube with `slopes` . s <= `at_most`. Numbers that are not finite leave it open.
///
/// The exact share is the sum of (-1)^|v| max(0, t - a . v)^d over the corners v, divided by d! and the product of the slopes a, which are
/// above zero once axes are turned round. Every term is off by at most d (d + 2) roundings of (|t| + sum of a)^d, and their sum by as many
/// more as there are terms; that is added.
pub fn share_below(slopes: &[f64], at_most: f64) -> (f64, f64) {
    let size: f64 = slopes.iter().map(|slope| slope.abs()).sum();
    if !size.is_finite() || !at_most.is_finite() {
        return (0.0, 1.0);
    }
    let largest = slopes.iter().fold(0.0, |most: f64, slope| most.max(slope.abs()));
    let mut positive = [0.0; DIMENSIONS];
    let mut count = 0;
    // What the threshold may be off by, below and above.
    let rounding = 32.0 * f64::EPSILON * (size + at_most.abs());
    let (mut low, mut high) = (at_most - rounding, at_most + rounding);
    for &slope in slopes {
        if slope.abs() > SMALL * largest {
            positive[count] = slope.abs();
            count += 1;
            if slope < 0.0 {
                (low, high) = (low - slope, high - slope);
            }
        } else {
            (low, high) = (low - slope.max(0.0), high - slope.min(0.0));
        }
    }
    let positive = &positive[..count];
    (exact(positive, low).0, exact(positive, high).1)
}

/// Bounds of the share for slopes above zero that are not too different.
fn exact(slopes: &[f64], at_most: f64) -> (f64, f64) {
    let size: f64 = slopes.iter().sum();
    if at_most < 0.0 {
        return (0.0, 0.0);
    }
    if slopes.is_empty() || at_most > size * (1.0 + 8.0 * f64::EPSILON) {
        return (1.0, 1.0);
    }
    let dimensions = slopes.len();
    let mut sum = 0.0;
    for corner in 0..1usize << dimensions {
        let chosen = || (0..dimensions).filter(|axis| corner >> axis & 1 == 1);
        let beyond = at_most - chosen().map(|axis| slopes[axis]).sum::<f64>();
        if beyond > 0.0 {
            let power = (1..dimensions).fold(beyond, |power, _| power * beyond);
            sum += if chosen().count() % 2 == 0 { power } else { -power };
        }
    }
    let product: f64 = slopes.iter().product();
    let factorial: f64 = (1..=dimensions).map(|it| it as f64).product();
    let reach = (0..dimensions).fold(1.0, |power, _| power * (size + at_most));
    let (dimensions, corners) = (dimensions as f64, f64::from(1u32 << dimensions));
    let error = 1.1 * corners * (dimensions * (dimensions + 2.0) + corners) * f64::EPSILON * reach / (factorial * product);
    let share = sum / (factorial * product);
    ((share - error).clamp(0.0, 1.0), (share + error).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_those_of_known_bodies() {
        // A corner of a cube: t^d / (d! a1 .. ad); half of it by symmetry; a prism.
        for (slopes, at_most, share) in [
            (vec![1.0], 0.25, 0.25),
            (vec![1.0, 1.0], 1.0, 0.5),
            (vec![2.0, 1.0], 0.5, 0.0625),
            (vec![1.0, 1.0, 1.0], 1.0, 1.0 / 6.0),
            (vec![1.0, 0.5, 0.25, 0.125], 0.9375, 0.5),
            (vec![1.0, 1.0, 1.0, 1.0], 3.0, 1.0 - 1.0 / 24.0),
            (vec![-1.0, 1.0, -1.0], -1.0, 1.0 / 6.0),
            (vec![-3.0], -0.75, 0.75),
        ] {
            let (low, high) = share_below(&slopes, at_most);
            assert!(low <= share && share <= high && high - low < 1e-9, "{slopes:?} {at_most}: {low} to {high}, not {share}");
        }
    }

    #[test]
    fn shares_hold_those_of_a_fine_grid_even_where_slopes_differ_much() {
        for (slopes, at_most) in [([1.0, 0.3, -0.001, 0.02], 0.4), ([0.02, 0.017, 1.0, -0.7], 0.1), ([1e-9, -1.0, 1e-3, 0.5], -0.2)] {
            let steps = 40;
            let place = |index: usize| (index as f64 + 0.5) / steps as f64;
            let mut inside = 0;
            for cell in 0..steps * steps * steps {
                // Exactly along the axis of the largest slope.
                let (a, b, c) = (place(cell % steps), place(cell / steps % steps), place(cell / steps / steps));
                for d in 0..steps {
                    let s = [a, b, c, place(d)];
                    inside += usize::from(slopes.iter().zip(s).map(|(a, s)| a * s).sum::<f64>() <= at_most);
                }
            }
            let share = inside as f64 / (steps * steps * steps * steps) as f64;
            let (low, high) = share_below(&slopes, at_most);
            assert!(low - 2e-3 < share && share < high + 2e-3 && high - low < 0.07, "{low} {share} {high}");
        }
    }

    #[test]
    fn what_is_not_finite_leaves_the_share_open() {
        assert_eq!(share_below(&[f64::INFINITY, 1.0], 0.5), (0.0, 1.0));
        assert_eq!(share_below(&[1.0], f64::NAN), (0.0, 1.0));
        assert_eq!((share_below(&[0.0, 0.0], 0.5), share_below(&[0.0], -0.5)), ((1.0, 1.0), (0.0, 0.0)));
    }
}
