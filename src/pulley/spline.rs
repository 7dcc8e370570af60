//! Cubic splines over the harmonics: values that are smooth in k need not be solved for every k.

/// Fills the rows of `table` (one block of numbers per harmonic `0..orders`) that were not solved by a not-a-knot cubic spline through
/// those that were. `solved` is ascending, starts with 0 and ends with `orders - 1`.
pub fn fill_between(solved: &[usize], orders: usize, block: usize, table: &mut [f64]) {
    let weights = weights(solved, orders);
    for order in (0..orders).filter(|order| !solved.contains(order)) {
        let (before, rest) = table.split_at_mut(order * block);
        let (own, after) = rest.split_at_mut(block);
        let knots = solved.iter().zip(&weights[order]).filter(|(_, weight)| **weight != 0.0);
        let knots: Vec<(&[f64], f64)> = knots
            .map(|(&knot, &weight)| match knot < order {
                true => (&before[knot * block..][..block], weight),
                false => (&after[(knot - order - 1) * block..][..block], weight),
            })
            .collect();
        add_up(own, &knots);
    }
}

/// Adds columns times their weights, one column after the other in every number.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn add_up(own: &mut [f64], columns: &[(&[f64], f64)]) {
    /// Numbers whose sums stay in registers.
    const TILE: usize = 16;
    let (tiles, rest) = own.as_chunks_mut::<TILE>();
    let whole = tiles.len() * TILE;
    for (number, tile) in tiles.iter_mut().enumerate() {
        let mut sums = *tile;
        for (column, weight) in columns {
            let column = &column[number * TILE..][..TILE];
            for place in 0..TILE {
                sums[place] += weight * column[place];
            }
        }
        *tile = sums;
    }
    for (column, weight) in columns {
        for (sum, value) in rest.iter_mut().zip(&column[whole..]) {
            *sum += weight * value;
        }
    }
}

/// `weights(..)[order][knot]`: share of the value at a knot in the spline's value at an order.
fn weights(knots: &[usize], orders: usize) -> Vec<Vec<f64>> {
    let count = knots.len();
    if count < 4 {
        return (0..orders).map(|order| knots.iter().map(|&knot| if knot == order { 1.0 } else { 0.0 }).collect()).collect();
    }
    let x: Vec<f64> = knots.iter().map(|&knot| knot as f64).collect();
    let step = |i: usize| x[i + 1] - x[i];
    // Second derivatives m at the knots: A m = B y.
    let mut a = vec![vec![0.0; count]; count];
    let mut b = vec![vec![0.0; count]; count];
    for i in 1..count - 1 {
        let (left, right) = (step(i - 1), step(i));
        (a[i][i - 1], a[i][i], a[i][i + 1]) = (left, 2.0 * (left + right), right);
        (b[i][i - 1], b[i][i], b[i][i + 1]) = (6.0 / left, -6.0 / left - 6.0 / right, 6.0 / right);
    }
    // Not a knot: the third derivative does not jump at the second knot and the last but one.
    for (row, i) in [(0, 1), (count - 1, count - 2)] {
        (a[row][i - 1], a[row][i], a[row][i + 1]) = (step(i), -(step(i - 1) + step(i)), step(i - 1));
    }
    solve(&mut a, &mut b);
    let weight = |order: usize| {
        let mut weights = vec![0.0; count];
        let at = order as f64;
        let i = x.iter().rposition(|&knot| knot <= at).unwrap_or(0).min(count - 2);
        let h = step(i);
        let (low, high) = ((x[i + 1] - at) / h, (at - x[i]) / h);
        weights[i] += low;
        weights[i + 1] += high;
        for (weight, (m0, m1)) in weights.iter_mut().zip(b[i].iter().zip(&b[i + 1])) {
            *weight += h * h / 6.0 * ((low * low * low - low) * m0 + (high * high * high - high) * m1);
        }
        weights
    };
    (0..orders).map(weight).collect()
}

/// Gauss with partial pivoting; `b` becomes the solutions.
fn solve(a: &mut [Vec<f64>], b: &mut [Vec<f64>]) {
    let count = a.len();
    for column in 0..count {
        let pivot = (column..count).max_by(|&i, &j| a[i][column].abs().total_cmp(&a[j][column].abs())).unwrap_or(column);
        a.swap(column, pivot);
        b.swap(column, pivot);
        for row in (0..count).filter(|&row| row != column) {
            let factor = a[row][column] / a[column][column];
            if factor != 0.0 {
                for place in 0..count {
                    a[row][place] -= factor * a[column][place];
                    b[row][place] -= factor * b[column][place];
                }
            }
        }
    }
    for row in 0..count {
        let pivot = a[row][row];
        b[row].iter_mut().for_each(|value| *value /= pivot);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_interpolated_exactly() {
        // Some numbers are added up in tiles, the last ones are not.
        const BLOCK: usize = 37;
        let knots = [0, 1, 2, 4, 7, 12];
        let cubic = |k: usize, number: usize| {
            let (k, number) = (k as f64, number as f64);
            1.0 + number - k + 0.5 * k * k - 0.03 * (1.0 + 0.1 * number) * k * k * k
        };
        let mut table = vec![0.0; 13 * BLOCK];
        for knot in knots {
            for number in 0..BLOCK {
                table[BLOCK * knot + number] = cubic(knot, number);
            }
        }
        fill_between(&knots, 13, BLOCK, &mut table);
        for order in 0..13 {
            for (number, found) in table[BLOCK * order..][..BLOCK].iter().enumerate() {
                let exact = cubic(order, number);
                assert!((found - exact).abs() < 1e-11 * (1.0 + exact.abs()), "order {order}, number {number}: {found} {exact}");
            }
        }
    }
}
