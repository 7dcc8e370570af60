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

/// Bytes of matrices with so many nodes, `half` and reach as in [`Matrices`], and of their factors.
pub fn bytes(nodes: usize, half: usize, reach: &[usize]) -> u64 {
    (nodes * (half + 1) * size_of::<Coupling>() + panels(reach).length() * size_of::<Wide>()) as u64
}

/// Memory for factors grows by 40 MiB, of which the system gives a page when it is first written. Allocators take blocks of that size from
/// the system and give them back; of smaller ones, each a little larger than the last, they keep gaps.
const GROWTH: usize = (40 << 20) / size_of::<Wide>();

/// Memory for the factors of eight harmonics, reused from one solution to the next.
#[derive(Clone, Debug, Default)]
pub struct Factors {
    /// Of [`Wide`] from the first place that is aligned for it: only plain numbers are given without being written.
    entries: Vec<f64>,
}

impl Factors {
    /// Replaces right sides, which follow each other in `sides`, by the solutions in eight harmonics.
    ///
    /// The matrices must be positive definite; others give numbers that are not finite.
    pub fn solve(&mut self, matrices: &Matrices, orders: [usize; WIDTH], sides: &mut [Wide], count: usize) {
        assert_eq!(sides.len(), matrices.rows() * count, "one number per row and right side");
        let panels = matrices.panels();
        // Whatever a larger matrix has left is overwritten.
        if self.entries.len() < WIDTH * (panels.length() + 1) {
            self.entries = Vec::new();
            self.entries = vec![0.0; WIDTH * (panels.length() + 1).next_multiple_of(GROWTH)];
        }
        let (_, entries, _) = pod_align_to_mut::<f64, Wide>(&mut self.entries);
        let factors = &mut entries[..panels.length()];
        let orders = Wide(orders.map(|order| order as f64));
        let harmonics = Harmonics { couplings: &matrices.couplings, nodes: matrices.nodes, half: matrices.half, orders };
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
    let mut columns = sides.chunks_exact_mut(sides.len() / COUNT);
    let sides: [&mut [Wide]; COUNT] = std::array::from_fn(|_| columns.next().unwrap_or_default());
    Arch::new().dispatch(Solve { matrices, panels, factors, sides });
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

    #[test]
    fn solutions_are_the_same_to_the_bit_with_all_vectors() {
        let matrices = matrices(41, 9);
        let panels = matrices.panels();
        let orders = Wide(ORDERS.map(|order| order as f64));
        let harmonics = Harmonics { couplings: &matrices.couplings, nodes: matrices.nodes, half: matrices.half, orders };
        let rows = matrices.rows();
        let solution = |solve: &dyn Fn(Solve<'_, 3>)| {
            let load = |at: usize, lane: usize| if at < rows { ((at * 7 + lane) % 11) as f64 - 4.5 } else { (at % 2) as f64 };
            let mut sides: Vec<Wide> = (0..3 * rows).map(|at| Wide(std::array::from_fn(|lane| load(at, lane)))).collect();
            let mut factors = vec![Wide([f64::NAN; WIDTH]); panels.length()];
            let mut columns = sides.chunks_exact_mut(rows);
            let columns = std::array::from_fn(|_| columns.next().unwrap_or_default());
            solve(Solve { matrices: harmonics, panels: &panels, factors: &mut factors, sides: columns });
            sides.into_iter().flat_map(|side| side.0.map(f64::to_bits)).collect::<Vec<u64>>()
        };
        let expected = solution(&|work| Simd::vectorize(pulp::Scalar, work));
        assert!(expected.iter().all(|bits| f64::from_bits(*bits).is_finite()));
        assert_eq!(solution(&|work| Arch::new().dispatch(work)), expected, "the widest of this processor");
        #[cfg(target_arch = "x86_64")]
        if let Some(narrower) = pulp::x86::V3::try_new() {
            assert_eq!(solution(&|work| Simd::vectorize(narrower, work)), expected, "AVX2");
        }
    }
}
