//! Symmetric banded equations for several harmonics at once: Cholesky factors and solutions, a harmonic per lane.
//!
//! Every lane does the same operations in the same order on every machine (no contraction, no reordering), so a solution has the
//! same bits whatever instructions the CPU has.

mod panels;

use super::wide::{WIDTH, Wide};
use bytemuck::pod_align_to_mut;
use panels::{Harmonics, PANEL, Panels, Solve};
use pulp::Arch;

/// How two nodes resist each other: the numbers that are not zero, in the order of [`PARTS`].
pub type Coupling = [f64; PARTS.len()];

/// Where the numbers of a [`Coupling`] stand: row and column among the displacements (r, z, theta) of the two nodes, and the power of the
/// harmonic. What is symmetric around the axis couples r and z with theta by the first power only, everything else by the others.
pub const PARTS: [(usize, usize, usize); 12] =
    [(0, 0, 0), (0, 1, 0), (1, 0, 0), (1, 1, 0), (2, 2, 0), (0, 2, 1), (1, 2, 1), (2, 0, 1), (2, 1, 1), (0, 0, 2), (1, 1, 2), (2, 2, 2)];

/// Symmetric banded matrices `K0 + k K1 + k^2 K2`, of which the diagonal and the band below it are kept, node by node.
#[derive(Clone, Debug)]
pub struct Matrices {
    nodes: usize,
    half: usize,
    /// Per node, its coupling with itself and `half` nodes after it: rows are theirs, columns its own.
    couplings: Vec<Coupling>,
    /// Per column, one more than the last row with an entry.
    reach: Vec<usize>,
}

impl Matrices {
    /// Zero matrices of so many nodes, of which each may be coupled with `half` nodes after it; they reuse the memory of `couplings`.
    pub fn reusing(mut couplings: Vec<Coupling>, nodes: usize, half: usize) -> Self {
        couplings.clear();
        couplings.resize(nodes * (half + 1), [0.0; PARTS.len()]);
        Self { nodes, half, couplings, reach: (1..=3 * nodes).collect() }
    }

    /// Returns the couplings, so that other matrices can reuse their memory.
    pub fn take_couplings(&mut self) -> Vec<Coupling> {
        std::mem::take(&mut self.couplings)
    }

    /// The coupling of a node with itself or one before it. Of a node with itself, what stands above the diagonal is not read.
    /// [`reaches`](Self::reaches) must be told of what is entered.
    #[inline(always)]
    pub fn coupling(&mut self, row_node: usize, column_node: usize) -> &mut Coupling {
        &mut self.couplings[column_node * (self.half + 1) + (row_node - column_node)]
    }

    /// A column has entries down to a row.
    pub fn reaches(&mut self, column: usize, row: usize) {
        self.reach[column] = self.reach[column].max(row + 1);
    }

    /// Rows of the matrix: three of each node.
    fn size(&self) -> usize {
        3 * self.nodes
    }

    /// Rows, rounded up to whole panels: right sides have as many.
    pub fn rows(&self) -> usize {
        self.size().next_multiple_of(PANEL)
    }

    /// The matrices in some harmonics.
    fn harmonics(&self, orders: [usize; WIDTH]) -> Harmonics<'_> {
        let orders = Wide(orders.map(|order| order as f64));
        Harmonics { couplings: &self.couplings, nodes: self.nodes, half: self.half, orders }
    }

    /// The panels of the factors.
    fn panels(&self) -> Panels {
        panels(&self.reach)
    }
}

/// The panels of the factors, from `reach` as in [`Matrices`]; later columns may fill what an earlier one affects.
fn panels(reach: &[usize]) -> Panels {
    let mut last = 0;
    Panels::new((0..reach.len().next_multiple_of(PANEL)).step_by(PANEL).map(|first| {
        let own = reach[first..reach.len().min(first + PANEL)].iter().max().copied().unwrap_or(0);
        last = own.max(last).max(first + PANEL);
        last - first
    }))
}

/// Bytes of matrices with so many nodes, `half` and reach as in [`Matrices`], and of their factors as far as they are written.
pub fn bytes(nodes: usize, half: usize, reach: &[usize]) -> u64 {
    (nodes * (half + 1) * size_of::<Coupling>() + panels(reach).length() * size_of::<Wide>()) as u64
}

/// Factors get memory in steps of 40 MiB: more than the 32 MiB up to which glibc may serve blocks from its heap, where each section a
/// little larger than the last leaves a gap. Memory that is never written costs nothing on 64-bit Unix; other systems get steps of 1 MiB.
const GROWTH: usize = (if cfg!(all(unix, target_pointer_width = "64")) { 40 } else { 1 } << 20) / size_of::<Wide>();

/// Memory for the factors of eight harmonics, reused from one solution to the next.
#[derive(Clone, Debug, Default)]
pub struct Factors {
    /// [`Wide`] from the first place that is aligned for it: of plain numbers a vector asks the system for zeroed memory, and writes none.
    entries: Vec<f64>,
}

impl Factors {
    /// Replaces right sides, which follow each other in `sides`, by the solutions in eight harmonics.
    ///
    /// The matrices must be positive definite; others give numbers that are not finite.
    pub fn solve(&mut self, matrices: &Matrices, orders: [usize; WIDTH], sides: &mut [Wide], count: usize) {
        assert_eq!(sides.len(), matrices.rows() * count, "one number per row and right side");
        let panels = matrices.panels();
        if self.entries.len() < WIDTH * (panels.length() + 1) {
            self.entries = Vec::new();
            self.entries = vec![0.0; WIDTH * (panels.length() + 1).next_multiple_of(GROWTH)];
        }
        let (_, entries, _) = pod_align_to_mut::<f64, Wide>(&mut self.entries);
        // Whatever a larger matrix has left is overwritten.
        let factors = &mut entries[..panels.length()];
        let harmonics = matrices.harmonics(orders);
        match count {
            3 => solve::<3>(harmonics, &panels, factors, sides),
            4 => solve::<4>(harmonics, &panels, factors, sides),
            5 => solve::<5>(harmonics, &panels, factors, sides),
            _ => unreachable!("a section has three to five right sides"),
        }
    }
}

/// Factors and solves with the processor's vectors; right sides follow each other in `sides`.
fn solve<const COUNT: usize>(matrices: Harmonics<'_>, panels: &Panels, factors: &mut [Wide], sides: &mut [Wide]) {
    Arch::new().dispatch(Solve { matrices, panels, factors, sides: columns::<COUNT>(sides) });
}

/// Right sides that follow each other.
fn columns<const COUNT: usize>(sides: &mut [Wide]) -> [&mut [Wide]; COUNT] {
    let mut columns = sides.chunks_exact_mut(sides.len() / COUNT);
    std::array::from_fn(|_| columns.next().unwrap_or_default())
}

#[cfg(test)]
impl Matrices {
    /// Product with a vector in one harmonic.
    pub fn times(&self, order: usize, vector: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; self.size()];
        for column_node in 0..self.nodes {
            for row_node in column_node..self.nodes.min(column_node + self.half + 1) {
                let coupling = &self.couplings[column_node * (self.half + 1) + (row_node - column_node)];
                for ((a, b, power), part) in PARTS.into_iter().zip(coupling) {
                    let (row, column, entry) = (3 * row_node + a, 3 * column_node + b, part * (order as f64).powi(power as i32));
                    if row >= column {
                        product[row] += entry * vector[column];
                    }
                    if row > column {
                        product[column] += entry * vector[row];
                    }
                }
            }
        }
        product
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pulp::Simd;

    const ORDERS: [usize; WIDTH] = [0, 1, 3, 8, 2, 5, 4, 13];

    /// Matrices of so many nodes. Their rows fill no whole number of panels, and nodes that are `half` apart are coupled at one place only.
    fn matrices(nodes: usize, half: usize) -> Matrices {
        let part = |row: usize, column: usize, power: usize| match (row.abs_diff(column), power) {
            (0, 0) => 10.0 + (row % 3) as f64,
            (0, 2) => 1.0,
            (far, _) => 0.3 / (far + power + 1) as f64 - if (row + column).is_multiple_of(2) { 0.1 } else { 0.0 },
        };
        let mut matrices = Matrices::reusing(Vec::new(), nodes, half);
        for column_node in 0..nodes {
            for row_node in
                (column_node..nodes).filter(|row_node| row_node - column_node < half || (*row_node, column_node) == (half + 2, 2))
            {
                for ((a, b, power), entry) in PARTS.into_iter().zip(matrices.coupling(row_node, column_node)) {
                    *entry = part(3 * row_node + a, 3 * column_node + b, power);
                }
                (0..3).for_each(|axis| matrices.reaches(3 * column_node + axis, 3 * row_node + 2));
            }
        }
        matrices
    }

    #[test]
    fn solutions_satisfy_the_equations_of_every_harmonic() {
        // The second has more panels than stand in one block, and panels that reach into several.
        for (nodes, half) in [(7, 3), (41, 9)] {
            solution_is_found(&matrices(nodes, half));
        }
    }

    fn solution_is_found(matrices: &Matrices) {
        let wanted = |row: usize, side: usize, lane: usize| (row as f64 - 3.0 * side as f64) * (1.0 + lane as f64);
        let (size, rows) = (matrices.size(), matrices.rows());
        let mut factors = Factors::default();
        for count in 3..=5 {
            let mut sides = vec![Wide::ZERO; rows * count];
            for side in 0..count {
                for (lane, &order) in ORDERS.iter().enumerate() {
                    let solution: Vec<f64> = (0..size).map(|row| wanted(row, side, lane)).collect();
                    for (row, load) in matrices.times(order, &solution).into_iter().enumerate() {
                        sides[side * rows + row][lane] = load;
                    }
                }
            }
            factors.solve(matrices, ORDERS, &mut sides, count);
            for row in 0..size {
                for side in 0..count {
                    for (lane, found) in sides[side * rows + row].0.into_iter().enumerate() {
                        let error = (found - wanted(row, side, lane)).abs();
                        assert!(error < 1e-10, "row {row} side {side} lane {lane}: {error}");
                    }
                }
            }
        }
    }

    /// The solution of one right side in one harmonic by Cholesky's factors, number by number in the order that the solver keeps: what a
    /// panel of earlier columns takes out of a number is summed in pairs first; columns of the same panel follow one after the other.
    fn solved_plainly(matrices: &Matrices, order: usize, side: &[f64]) -> Vec<f64> {
        let (rows, size) = (matrices.rows(), matrices.size());
        let mut factor = vec![vec![0.0; rows]; rows];
        (size..rows).for_each(|row| factor[row][row] = 1.0);
        for column_node in 0..matrices.nodes {
            for row_node in column_node..matrices.nodes.min(column_node + matrices.half + 1) {
                let coupling = &matrices.couplings[column_node * (matrices.half + 1) + row_node - column_node];
                for (a, b) in (0..3).flat_map(|a| (0..3).map(move |b| (a, b))) {
                    let of = |power| PARTS.iter().position(|part| *part == (a, b, power)).map_or(0.0, |it| coupling[it]);
                    let k = order as f64;
                    factor[3 * row_node + a][3 * column_node + b] = of(0) + k * of(1) + k * (k * of(2));
                }
            }
        }
        let mut values = side.to_vec();
        values.resize(rows, 0.0);
        let four = |a: &[f64], b: &[f64]| (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3]);
        for row in 0..rows {
            for column in 0..=row {
                let (first, mut value) = (column / PANEL * PANEL, factor[row][column]);
                for panel in (0..first).step_by(PANEL) {
                    value -= four(&factor[row][panel..panel + PANEL], &factor[column][panel..panel + PANEL]);
                }
                (first..column).for_each(|earlier| value -= factor[row][earlier] * factor[column][earlier]);
                // Diagonals hold their inverse.
                factor[row][column] = if row == column { 1.0 / value.sqrt() } else { value * factor[column][column] };
            }
            let first = row / PANEL * PANEL;
            for panel in (0..first).step_by(PANEL) {
                values[row] -= four(&factor[row][panel..panel + PANEL], &values[panel..panel + PANEL]);
            }
            for earlier in first..row {
                values[row] -= factor[row][earlier] * values[earlier];
            }
            values[row] *= factor[row][row];
        }
        for row in (0..rows).rev() {
            // Of two rows the upper takes what follows both first, then the lower.
            let (pair, after) = (row / 2 * 2 + 1, row / 2 * 2 + 2);
            let later = (after..rows).chain((row < pair).then_some(pair));
            later.for_each(|later| values[row] -= factor[later][row] * values[later]);
            values[row] *= factor[row][row];
        }
        values
    }

    /// Bits of the solutions of so many right sides. The first is loaded everywhere, the second from the middle on in one harmonic only,
    /// the others here and there.
    fn solved<const COUNT: usize>(matrices: &Matrices, solve: &dyn Fn(Solve<'_, COUNT>)) -> Vec<u64> {
        let (rows, panels) = (matrices.rows(), matrices.panels());
        let mut sides: Vec<Wide> = (0..COUNT * rows).map(|at| Wide(std::array::from_fn(|lane| load(matrices, at, lane)))).collect();
        let mut factors = vec![Wide([f64::NAN; WIDTH]); panels.length()];
        solve(Solve { matrices: matrices.harmonics(ORDERS), panels: &panels, factors: &mut factors, sides: columns::<COUNT>(&mut sides) });
        sides.into_iter().flat_map(|side| side.0.map(f64::to_bits)).collect()
    }

    fn load(matrices: &Matrices, at: usize, lane: usize) -> f64 {
        let (side, row) = (at / matrices.rows(), at % matrices.rows());
        match side {
            _ if row >= matrices.size() => 0.0,
            0 => ((row * 7 + lane) % 11) as f64 - 4.5,
            1 if row > matrices.size() / 2 && lane == 6 => 2.5,
            1 => 0.0,
            _ => ((row + side) % 3) as f64,
        }
    }

    fn same_with_all_vectors<const COUNT: usize>(matrices: &Matrices) {
        let rows = matrices.rows();
        let mut expected = vec![0; COUNT * rows * WIDTH];
        for (side, (lane, order)) in (0..COUNT).flat_map(|side| ORDERS.into_iter().enumerate().map(move |it| (side, it))) {
            let loads: Vec<f64> = (0..rows).map(|row| load(matrices, side * rows + row, lane)).collect();
            for (row, value) in solved_plainly(matrices, order, &loads).into_iter().enumerate() {
                assert!(value.is_finite());
                expected[(side * rows + row) * WIDTH + lane] = value.to_bits();
            }
        }
        let what = format!("{} nodes, {COUNT} right sides", matrices.nodes);
        assert_eq!(solved::<COUNT>(matrices, &|work| Simd::vectorize(pulp::Scalar, work)), expected, "one number at a time, {what}");
        assert_eq!(solved::<COUNT>(matrices, &|work| Arch::new().dispatch(work)), expected, "the widest vectors, {what}");
        #[cfg(target_arch = "x86_64")]
        if let Some(narrower) = pulp::x86::V3::try_new() {
            assert_eq!(solved::<COUNT>(matrices, &|work| Simd::vectorize(narrower, work)), expected, "AVX2, {what}");
        }
    }

    #[test]
    fn solutions_are_those_of_plain_arithmetic_to_the_bit_with_all_vectors() {
        for (nodes, half) in [(7, 3), (41, 9), (30, 1), (23, 2)] {
            let matrices = matrices(nodes, half);
            same_with_all_vectors::<3>(&matrices);
            same_with_all_vectors::<4>(&matrices);
            same_with_all_vectors::<5>(&matrices);
        }
    }
}
