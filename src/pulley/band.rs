//! Symmetric banded equations for several harmonics at once: Cholesky factors and solutions, a harmonic per lane.
//!
//! Every lane does the same operations in the same order on every machine (no contraction, no reordering), so a solution has the
//! same bits whatever instructions the processor has.

/// Harmonics that are solved together.
pub const WIDTH: usize = 4;

/// One number of each harmonic.
pub type Wide = [f64; WIDTH];

/// Columns that are eliminated together: what they do to the rest is done in one pass.
const PANEL: usize = 4;

/// A symmetric positive definite matrix per harmonic, of which the band on and below the diagonal is kept, column by column.
#[derive(Clone, Debug)]
pub struct Band {
    size: usize,
    half: usize,
    entries: Vec<Wide>,
}

impl Band {
    /// A zero matrix of `size` rows (rounded up to whole panels; the rows added are those of the identity) and `half` diagonals
    /// below the main one.
    pub fn new(size: usize, half: usize) -> Self {
        let mut band = Self { size: size.next_multiple_of(PANEL), half, entries: Vec::new() };
        band.entries.resize(band.size * band.stride(), [0.0; WIDTH]);
        for row in size..band.size {
            *band.entry(row, row) = [1.0; WIDTH];
        }
        band
    }

    /// Rows, those of the identity included.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Columns have room for as many zeros below the band as a panel is wide, which its elimination may read.
    fn stride(&self) -> usize {
        self.half + PANEL
    }

    /// The place of an entry on or below the diagonal.
    #[inline(always)]
    pub fn entry(&mut self, row: usize, column: usize) -> &mut Wide {
        let stride = self.stride();
        &mut self.entries[column * stride + (row - column)]
    }

    /// All entries, a column of `half + 1` numbers (and the zeros after it) at a time, with the number of the column.
    pub fn columns_mut(&mut self) -> impl Iterator<Item = (usize, &mut [Wide])> {
        let (stride, used) = (self.stride(), self.half + 1);
        self.entries.chunks_exact_mut(stride).map(move |column| &mut column[..used]).enumerate()
    }

    /// Replaces the matrix by its Cholesky factor, with the inverse of the diagonal on the diagonal.
    pub fn factor(&mut self) {
        let stride = self.stride();
        factor(&mut self.entries, self.size, stride);
    }

    /// Replaces right sides by solutions: `sides[row * count + side]`.
    pub fn solve(&self, sides: &mut [Wide], count: usize) {
        assert_eq!(sides.len(), self.size * count, "one number per row and right side");
        match count {
            4 => solve::<4>(&self.entries, self.stride(), self.half, sides),
            5 => solve::<5>(&self.entries, self.stride(), self.half, sides),
            _ => unreachable!("a section has four or five right sides"),
        }
    }
}

#[inline(always)]
fn each(mut function: impl FnMut(usize) -> f64) -> Wide {
    let mut wide = [0.0; WIDTH];
    for (lane, value) in wide.iter_mut().enumerate() {
        *value = function(lane);
    }
    wide
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn factor(entries: &mut [Wide], size: usize, stride: usize) {
    let half = stride - PANEL;
    for first in (0..size).step_by(PANEL) {
        let (panel, rest) = entries[first * stride..].split_at_mut(PANEL * stride);
        for column in 0..PANEL {
            let (before, own) = panel.split_at_mut(column * stride);
            let own = &mut own[..=half];
            for (earlier, factors) in before.chunks_exact(stride).enumerate() {
                let below = &factors[column - earlier..];
                let factor = below[0];
                for (value, other) in own.iter_mut().zip(below) {
                    *value = each(|lane| value[lane] - other[lane] * factor[lane]);
                }
            }
            let inverse = each(|lane| 1.0 / own[0][lane].sqrt());
            own[0] = inverse;
            for value in &mut own[1..] {
                *value = each(|lane| value[lane] * inverse[lane]);
            }
        }
        // The rest of the matrix that the panel reaches: rows and columns up to `half` after its last column.
        let reached = half.min(size - first - PANEL);
        for (next, column) in rest.chunks_exact_mut(stride).take(reached).enumerate() {
            let length = half - next;
            let place = |number: usize| &panel[number * stride + PANEL + next - number..][..length];
            let [a, b, c, d] = [place(0), place(1), place(2), place(3)];
            let [fa, fb, fc, fd] = [a[0], b[0], c[0], d[0]];
            for ((((value, a), b), c), d) in column[..length].iter_mut().zip(a).zip(b).zip(c).zip(d) {
                *value = each(|w| value[w] - ((a[w] * fa[w] + b[w] * fb[w]) + (c[w] * fc[w] + d[w] * fd[w])));
            }
        }
    }
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn solve<const COUNT: usize>(entries: &[Wide], stride: usize, half: usize, sides: &mut [Wide]) {
    let (sides, _) = sides.as_chunks_mut::<COUNT>();
    let size = sides.len();
    for (row, column) in entries.chunks_exact(stride).enumerate() {
        let (own, below) = sides[row..].split_first_mut().expect("a row per column");
        let inverse = column[0];
        for value in own.iter_mut() {
            *value = each(|lane| value[lane] * inverse[lane]);
        }
        for (factor, below) in column[1..=half].iter().zip(below) {
            for (value, own) in below.iter_mut().zip(&*own) {
                *value = each(|lane| value[lane] - factor[lane] * own[lane]);
            }
        }
    }
    for row in (0..size).rev() {
        let column = &entries[row * stride..][..=half];
        let (own, below) = sides[row..].split_first_mut().expect("a row per column");
        for (factor, below) in column[1..].iter().zip(&*below) {
            for (value, below) in own.iter_mut().zip(below) {
                *value = each(|lane| value[lane] - factor[lane] * below[lane]);
            }
        }
        for value in own.iter_mut() {
            *value = each(|lane| value[lane] * column[0][lane]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solutions_satisfy_the_equations_in_every_lane() {
        let (size, half) = (23, 7);
        let matrix = |row: usize, column: usize, lane: usize| {
            let far = row.abs_diff(column);
            match far {
                0 => 10.0 + (lane + row % 3) as f64,
                _ if far <= half => 1.0 / (far + lane + 1) as f64 - if (row + column) % 2 == 0 { 0.3 } else { 0.0 },
                _ => 0.0,
            }
        };
        let mut band = Band::new(size, half);
        for column in 0..size {
            for row in column..size.min(column + half + 1) {
                *band.entry(row, column) = std::array::from_fn(|lane| matrix(row, column, lane));
            }
        }
        let wanted = |row: usize, side: usize, lane: usize| (row as f64 - 3.0 * side as f64) * (1.0 + lane as f64);
        let mut sides = vec![[0.0; WIDTH]; band.size() * 4];
        for row in 0..size {
            for side in 0..4 {
                sides[row * 4 + side] =
                    std::array::from_fn(|lane| (0..size).map(|column| matrix(row, column, lane) * wanted(column, side, lane)).sum());
            }
        }
        band.factor();
        band.solve(&mut sides, 4);
        for row in 0..size {
            for side in 0..4 {
                for lane in 0..WIDTH {
                    assert!((sides[row * 4 + side][lane] - wanted(row, side, lane)).abs() < 1e-11, "row {row} side {side} lane {lane}");
                }
            }
        }
    }
}
