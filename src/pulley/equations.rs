//! The equations of a section: its stiffness in every harmonic, what is fixed, and displacements under loads.

use super::band::{Factors, Matrices, WIDTH, Wide};
use super::element::{Coupling, Lame, couple, samples};
use super::mesh::Mesh;
use std::sync::{Mutex, PoisonError};

/// Megabytes that are filled anew for every section: the factors, and the entries of the matrices.
#[derive(Clone, Debug, Default)]
struct EquationRoom {
    factors: Factors,
    entries: Vec<[f64; 3]>,
}

/// Unused memory: one block for each thread that has solved sections at the same time as others. Threads come and go during a run, and what
/// an allocator keeps for each would add up. It is memory only: whatever an earlier section has left in it is overwritten before it is
/// read, so no answer depends on what was solved earlier.
static ROOMS: Mutex<Vec<EquationRoom>> = Mutex::new(Vec::new());

/// The equations of a section, for an elastic modulus of 1 MPa. Harmonics without enough fixed to stop rigid motions have no solution.
#[derive(Clone, Debug)]
pub struct Equations {
    matrices: Matrices,
    factors: Factors,
    fixed: Vec<[bool; 3]>,
    values: Vec<Wide>,
    sides: usize,
}

impl Equations {
    /// The equations of a mesh; `fixed` says for every node which of its displacements along r, z and the circumference are zero in all
    /// harmonics.
    pub fn new(mesh: &Mesh, poisson: f64, fixed: Vec<[bool; 3]>) -> Self {
        let EquationRoom { factors, entries } = ROOMS.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default();
        Self { matrices: stiffness(mesh, poisson, &fixed, entries), factors, fixed, values: Vec::new(), sides: 0 }
    }

    /// Zero loads in so many right sides (three to five), to be filled: `loads[(3 * node + axis) * sides + side]`, N per rad; those of
    /// a density over the section include the factor r. Axes are r, z and the circumference.
    pub fn loads(&mut self, sides: usize) -> &mut [Wide] {
        self.sides = sides;
        self.values.clear();
        self.values.resize(self.matrices.rows() * sides, [0.0; WIDTH]);
        &mut self.values
    }

    /// Displacements under the loads that were filled in, in four harmonics of which the first `count` are wanted. Loads on what is
    /// fixed have no effect.
    pub fn solve(&mut self, orders: [usize; WIDTH], count: usize) -> Displacements<'_> {
        let sides = self.sides;
        for place in places(&self.fixed) {
            self.values[place * sides..(place + 1) * sides].fill([0.0; WIDTH]);
        }
        self.factors.solve(&self.matrices, orders, &mut self.values, sides);
        Displacements { orders, count, sides, values: &self.values }
    }
}

/// Bytes of the equations of a mesh with their factors and right sides.
pub fn bytes(mesh: &Mesh) -> u64 {
    let (size, half) = (3 * mesh.nodes.len() as u64, 3 * mesh.reach() as u64 + 2);
    let (parts, factors) = (size_of::<[f64; 3]>() as u64, size_of::<Wide>() as u64);
    size * (half + 1) * parts + size * (half + 4) * factors + size * MOST_SIDES * factors
}

/// Most right sides: three of the belt, one of the clamp, one of the spin.
const MOST_SIDES: u64 = 5;

impl Drop for Equations {
    fn drop(&mut self) {
        let room = EquationRoom { factors: std::mem::take(&mut self.factors), entries: self.matrices.take_entries() };
        ROOMS.lock().unwrap_or_else(PoisonError::into_inner).push(room);
    }
}

/// Displacements of all nodes under unit loads in four harmonics: `values[(3 * node + axis) * sides + side]`, times the modulus.
#[derive(Clone, Copy, Debug)]
pub struct Displacements<'s> {
    /// The harmonics.
    pub orders: [usize; WIDTH],
    /// How many of them count: the last may be repeated to fill the lanes.
    pub count: usize,
    /// How many loads there are.
    pub sides: usize,
    /// The displacements.
    pub values: &'s [Wide],
}

impl<'s> Displacements<'s> {
    /// Displacement of a node along r, z and the circumference, times the modulus.
    pub fn of(&self, node: u32, side: usize) -> [&'s Wide; 3] {
        let place = 3 * node as usize * self.sides + side;
        let [r, z, theta] = [place, place + self.sides, place + 2 * self.sides];
        [&self.values[r], &self.values[z], &self.values[theta]]
    }
}

/// Numbers of the degrees of freedom that are fixed.
fn places(fixed: &[[bool; 3]]) -> impl Iterator<Item = usize> + '_ {
    fixed.as_flattened().iter().enumerate().filter(|(_, fixed)| **fixed).map(|(place, _)| place)
}

/// The matrices of a section's stiffness, for a modulus of 1 MPa; what is fixed has the identity's rows.
///
/// `entries` is memory for them; its contents do not matter.
pub fn stiffness(mesh: &Mesh, poisson: f64, fixed: &[[bool; 3]], entries: Vec<[f64; 3]>) -> Matrices {
    let held = fixed.as_flattened();
    let mut matrices = Matrices::reusing(entries, 3 * mesh.nodes.len(), 3 * mesh.reach() + 2);
    let lame = Lame::new(1.0, poisson);
    for element in &mesh.elements {
        let nodes = element.nodes();
        let mut couplings = [[Coupling::default(); 8]; 8];
        for sample in samples(mesh, element) {
            let weight = sample.area * sample.radius;
            for i in 0..nodes.len() {
                for j in 0..nodes.len() {
                    if nodes[i] >= nodes[j] {
                        couple(&mut couplings[i][j], lame, &sample.shapes[i], &sample.shapes[j], sample.radius, weight);
                    }
                }
            }
        }
        for (i, &row_node) in nodes.iter().enumerate() {
            for (j, &column_node) in nodes.iter().enumerate().filter(|(_, column_node)| row_node >= **column_node) {
                let [k0, k1, k2] = &couplings[i][j];
                let (first_row, first_column) = (3 * row_node as usize, 3 * column_node as usize);
                for (b, column) in (first_column..first_column + 3).enumerate().filter(|(_, column)| !held[*column]) {
                    for (a, row) in (first_row..first_row + 3).enumerate().filter(|(_, row)| *row >= column && !held[*row]) {
                        let entry = matrices.entry(row, column);
                        entry[0] += k0[a][b];
                        entry[1] += k1[a][b];
                        entry[2] += k2[a][b];
                    }
                }
            }
        }
    }
    for place in places(fixed) {
        matrices.entry(place, place)[0] = 1.0;
    }
    matrices
}
