//! Symmetric banded equations for several harmonics at once: Cholesky factors and solutions, a harmonic per lane.
//!
//! Every lane does the same operations in the same order on every machine (no contraction, no reordering), so a solution has the
//! same bits whatever instructions the CPU has.

#![allow(clippy::needless_range_loop, reason = "loops over lanes, of constant length, are what the compiler makes vectors of")]

/// Harmonics that are solved together.
pub const WIDTH: usize = 4;

/// One number of each harmonic.
pub type Wide = [f64; WIDTH];

/// Columns that are eliminated together: their effect on the rest is applied in one pass.
const PANEL: usize = 4;

/// Symmetric banded matrices `K0 + k K1 + k^2 K2`, of which the diagonal and the band below it are kept, column by column.
#[derive(Clone, Debug)]
pub struct Matrices {
    size: usize,
    half: usize,
    /// Per column, `half + 1` triples (K0, K1, K2).
    entries: Vec<[f64; 3]>,
    /// Per column, one more than the last row with an entry.
    reach: Vec<usize>,
}

impl Matrices {
    /// Zero matrices of `size` rows and `half` diagonals below the main one; they reuse the memory of `entries`.
    pub fn reusing(mut entries: Vec<[f64; 3]>, size: usize, half: usize) -> Self {
        entries.clear();
        entries.resize(size * (half + 1), [0.0; 3]);
        Self { size, half, entries, reach: (1..=size).collect() }
    }

    /// Returns the entries, so that other matrices can reuse their memory.
    pub fn take_entries(&mut self) -> Vec<[f64; 3]> {
        std::mem::take(&mut self.entries)
    }

    /// The place of an entry on or below the diagonal.
    #[inline(always)]
    pub fn entry(&mut self, row: usize, column: usize) -> &mut [f64; 3] {
        self.reach[column] = self.reach[column].max(row + 1);
        &mut self.entries[column * (self.half + 1) + (row - column)]
    }

    /// Rows, rounded up to whole panels: right sides have as many.
    pub fn rows(&self) -> usize {
        self.size.next_multiple_of(PANEL)
    }

    /// For each panel, how many rows after it its elimination affects; later columns may fill what an earlier one affects.
    fn reached(&self) -> Vec<usize> {
        let mut last = 0;
        let panel = |first: usize| {
            let own = self.reach[first..self.size.min(first + PANEL)].iter().max().copied().unwrap_or(0);
            last = own.max(last).max(first + PANEL);
            last - first - PANEL
        };
        (0..self.rows()).step_by(PANEL).map(panel).collect()
    }
}

/// Memory for the factors of four harmonics, reused from one solution to the next.
#[derive(Clone, Debug, Default)]
pub struct Factors {
    entries: Vec<Wide>,
}

impl Factors {
    /// Replaces right sides, `sides[row * count + side]`, by the solutions in four harmonics.
    ///
    /// The matrices must be positive definite; others give numbers that are not finite.
    pub fn solve(&mut self, matrices: &Matrices, orders: [usize; WIDTH], sides: &mut [Wide], count: usize) {
        assert_eq!(sides.len(), matrices.rows() * count, "one number per row and right side");
        let stride = matrices.half + PANEL;
        // Whatever a larger matrix has left is overwritten.
        self.entries.resize(self.entries.len().max(matrices.rows() * stride), [0.0; WIDTH]);
        let order = orders.map(|order| order as f64);
        let (shape, reached) = ((matrices.size, matrices.half), matrices.reached());
        let entries = &mut self.entries[..matrices.rows() * stride];
        match count {
            3 => solve::<3>(&matrices.entries, entries, shape, &reached, order, sides.as_chunks_mut().0),
            4 => solve::<4>(&matrices.entries, entries, shape, &reached, order, sides.as_chunks_mut().0),
            5 => solve::<5>(&matrices.entries, entries, shape, &reached, order, sides.as_chunks_mut().0),
            _ => unreachable!("a section has three to five right sides"),
        }
    }
}

/// Writes a column of the matrix of four harmonics. Below the band it has room for as many zeros as a panel is wide, which the
/// elimination of a panel may read.
#[inline(always)]
fn build(matrices: &[[f64; 3]], (size, half): (usize, usize), order: Wide, number: usize, column: &mut [Wide]) {
    column[half + 1..].fill([0.0; WIDTH]);
    if number >= size {
        column[..=half].fill([0.0; WIDTH]);
        column[0] = [1.0; WIDTH];
        return;
    }
    let parts = &matrices[number * (half + 1)..][..=half];
    let column = &mut column[..=half];
    for i in 0..parts.len() {
        let [a, b, c] = parts[i];
        for lane in 0..WIDTH {
            column[i][lane] = a + order[lane] * (b + order[lane] * c);
        }
    }
}

/// Factors and solves in one pass down and one up: a column is made just before the elimination reaches it and used for the right
/// sides while it is at hand, so that only the factors go to memory and back.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn solve<const COUNT: usize>(
    matrices: &[[f64; 3]],
    entries: &mut [Wide],
    shape: (usize, usize),
    reached: &[usize],
    order: Wide,
    sides: &mut [[Wide; COUNT]],
) {
    let half = shape.1;
    let stride = half + PANEL;
    let rows = sides.len();
    let mut built = 0;
    // Right sides that are still zero need no work.
    let mut loaded = [false; COUNT];
    for first in (0..rows).step_by(PANEL) {
        let reach = reached[first / PANEL];
        while built < first + PANEL + reach {
            build(matrices, shape, order, built, &mut entries[built * stride..][..stride]);
            built += 1;
        }
        let (panel, rest) = entries[first * stride..].split_at_mut(PANEL * stride);
        for column in 0..PANEL {
            let (before, own) = panel.split_at_mut(column * stride);
            let length = PANEL - column + reach;
            let own = &mut own[..length];
            for earlier in 0..column {
                let below = &before[earlier * stride + (column - earlier)..][..length];
                let factor = below[0];
                for i in 0..own.len() {
                    for lane in 0..WIDTH {
                        own[i][lane] -= below[i][lane] * factor[lane];
                    }
                }
            }
            let mut inverse = own[0];
            for lane in 0..WIDTH {
                inverse[lane] = 1.0 / inverse[lane].sqrt();
            }
            own[0] = inverse;
            for i in 1..own.len() {
                for lane in 0..WIDTH {
                    own[i][lane] *= inverse[lane];
                }
            }
            // The right sides of this row are complete but for the panel's own columns.
            for side in 0..COUNT {
                let mut value = sides[first + column][side];
                for earlier in 0..column {
                    let factor = before[earlier * stride + (column - earlier)];
                    let known = sides[first + earlier][side];
                    for lane in 0..WIDTH {
                        value[lane] -= factor[lane] * known[lane];
                    }
                }
                for lane in 0..WIDTH {
                    value[lane] *= inverse[lane];
                }
                sides[first + column][side] = value;
                loaded[side] |= value[0] != 0.0 || value[1] != 0.0 || value[2] != 0.0 || value[3] != 0.0;
            }
        }
        // Two columns in one pass share what is loaded of the panel.
        for next in (0..reach - reach % 2).step_by(2) {
            let length = reach - next;
            let (column, after) = rest[next * stride..].split_at_mut(stride);
            let (column, after) = (&mut column[..length], &mut after[..length - 1]);
            let a = &panel[PANEL + next..][..length];
            let b = &panel[stride + PANEL + next - 1..][..length];
            let c = &panel[2 * stride + PANEL + next - 2..][..length];
            let d = &panel[3 * stride + PANEL + next - 3..][..length];
            let (fa, fb, fc, fd) = (a[0], b[0], c[0], d[0]);
            for lane in 0..WIDTH {
                column[0][lane] -= (a[0][lane] * fa[lane] + b[0][lane] * fb[lane]) + (c[0][lane] * fc[lane] + d[0][lane] * fd[lane]);
            }
            let (a, b, c, d) = (&a[1..], &b[1..], &c[1..], &d[1..]);
            let (ga, gb, gc, gd) = (a[0], b[0], c[0], d[0]);
            let column = &mut column[1..];
            for i in 0..after.len() {
                for lane in 0..WIDTH {
                    column[i][lane] -= (a[i][lane] * fa[lane] + b[i][lane] * fb[lane]) + (c[i][lane] * fc[lane] + d[i][lane] * fd[lane]);
                    after[i][lane] -= (a[i][lane] * ga[lane] + b[i][lane] * gb[lane]) + (c[i][lane] * gc[lane] + d[i][lane] * gd[lane]);
                }
            }
        }
        if reach % 2 == 1 {
            let next = reach - 1;
            let length = reach - next;
            let column = &mut rest[next * stride..][..length];
            let a = &panel[PANEL + next..][..length];
            let b = &panel[stride + PANEL + next - 1..][..length];
            let c = &panel[2 * stride + PANEL + next - 2..][..length];
            let d = &panel[3 * stride + PANEL + next - 3..][..length];
            let (fa, fb, fc, fd) = (a[0], b[0], c[0], d[0]);
            for i in 0..length {
                for lane in 0..WIDTH {
                    column[i][lane] -= (a[i][lane] * fa[lane] + b[i][lane] * fb[lane]) + (c[i][lane] * fc[lane] + d[i][lane] * fd[lane]);
                }
            }
        }
        let (above, below) = sides.split_at_mut(first + PANEL);
        let known = &above[first..];
        for side in (0..COUNT).filter(|&side| loaded[side]) {
            let (xa, xb, xc, xd) = (known[0][side], known[1][side], known[2][side], known[3][side]);
            let a = &panel[PANEL..][..reach];
            let b = &panel[stride + PANEL - 1..][..reach];
            let c = &panel[2 * stride + PANEL - 2..][..reach];
            let d = &panel[3 * stride + PANEL - 3..][..reach];
            let below = &mut below[..reach];
            for i in 0..reach {
                for lane in 0..WIDTH {
                    below[i][side][lane] -=
                        (a[i][lane] * xa[lane] + b[i][lane] * xb[lane]) + (c[i][lane] * xc[lane] + d[i][lane] * xd[lane]);
                }
            }
        }
    }
    // Two rows in one pass: the sums of one alone would wait for each other. Rows come in whole panels, an even number.
    for row in (0..rows).step_by(2).rev() {
        let panel = row - row % PANEL;
        let last = panel + PANEL + reached[panel / PANEL];
        let upper = &entries[row * stride..][..stride];
        let lower = &entries[(row + 1) * stride..][..stride];
        let (above, below) = sides.split_at_mut(row + 2);
        let (mut own, mut next) = (above[row], above[row + 1]);
        let count = last - row - 2;
        let (from_upper, from_lower, below) = (&upper[2..][..count], &lower[1..][..count], &below[..count]);
        for i in 0..count {
            for side in 0..COUNT {
                for lane in 0..WIDTH {
                    own[side][lane] -= from_upper[i][lane] * below[i][side][lane];
                    next[side][lane] -= from_lower[i][lane] * below[i][side][lane];
                }
            }
        }
        for side in 0..COUNT {
            for lane in 0..WIDTH {
                next[side][lane] *= lower[0][lane];
                own[side][lane] -= upper[1][lane] * next[side][lane];
                own[side][lane] *= upper[0][lane];
            }
        }
        above[row] = own;
        above[row + 1] = next;
    }
}

#[cfg(test)]
impl Matrices {
    /// Product with a vector in one harmonic.
    pub fn times(&self, order: usize, vector: &[f64]) -> Vec<f64> {
        let k = order as f64;
        let mut product = vec![0.0; self.size];
        for column in 0..self.size {
            for row in column..self.size.min(column + self.half + 1) {
                let [a, b, c] = self.entries[column * (self.half + 1) + (row - column)];
                let entry = a + k * (b + k * c);
                product[row] += entry * vector[column];
                if row != column {
                    product[column] += entry * vector[row];
                }
            }
        }
        product
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solutions_satisfy_the_equations_of_every_harmonic() {
        let (size, half) = (23, 7);
        let orders = [0, 1, 3, 8];
        let part = |row: usize, column: usize, part: usize| {
            let far = row.abs_diff(column);
            match (far, part) {
                (0, 0) => 10.0 + (row % 3) as f64,
                (0, 2) => 1.0,
                _ if far <= half => 0.3 / (far + part + 1) as f64 - if (row + column).is_multiple_of(2) { 0.1 } else { 0.0 },
                _ => 0.0,
            }
        };
        let mut matrices = Matrices::reusing(Vec::new(), size, half);
        for column in 0..size {
            for row in column..size.min(column + half + 1) {
                *matrices.entry(row, column) = std::array::from_fn(|it| part(row, column, it));
            }
        }
        let matrix = |row: usize, column: usize, lane: usize| {
            let k = orders[lane] as f64;
            part(row, column, 0) + k * (part(row, column, 1) + k * part(row, column, 2))
        };
        let wanted = |row: usize, side: usize, lane: usize| (row as f64 - 3.0 * side as f64) * (1.0 + lane as f64);
        let mut factors = Factors::default();
        for count in 3..=5 {
            let mut sides = vec![[0.0; WIDTH]; matrices.rows() * count];
            for row in 0..size {
                for side in 0..count {
                    sides[row * count + side] =
                        std::array::from_fn(|lane| (0..size).map(|column| matrix(row, column, lane) * wanted(column, side, lane)).sum());
                }
            }
            factors.solve(&matrices, orders, &mut sides, count);
            for row in 0..size {
                for side in 0..count {
                    for lane in 0..WIDTH {
                        let error = (sides[row * count + side][lane] - wanted(row, side, lane)).abs();
                        assert!(error < 1e-10, "row {row} side {side} lane {lane}: {error}");
                    }
                }
            }
        }
    }
}
