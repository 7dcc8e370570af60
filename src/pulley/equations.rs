//! The equations of a section: its stiffness in every harmonic, what is fixed, and displacements under loads.

use super::band::{self, Coupling, Factors, Matrices, PARTS};
use super::element::{Couplings, Lame};
use super::mesh::Mesh;
use super::wide::{WIDTH, Wide};
use std::sync::{Mutex, PoisonError};

/// Megabytes that are filled anew for every section: the factors, the couplings of the matrices, and the right sides.
#[derive(Clone, Debug, Default)]
struct EquationRoom {
    factors: Factors,
    couplings: Vec<Coupling>,
    values: Vec<Wide>,
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
        let EquationRoom { factors, couplings, values } = ROOMS.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default();
        Self { matrices: stiffness(mesh, poisson, &fixed, couplings), factors, fixed, values, sides: 0 }
    }

    /// Zero loads in so many right sides (three to five), to be filled: `loads[side][3 * node + axis]`, N per rad; those of a density over
    /// the section include the factor r. Axes are r, z and the circumference.
    pub fn loads(&mut self, sides: usize) -> Vec<&mut [Wide]> {
        self.sides = sides;
        self.values.clear();
        self.values.resize(self.matrices.rows() * sides, Wide::ZERO);
        self.values.chunks_exact_mut(self.matrices.rows()).collect()
    }

    /// Displacements under the loads that were filled in, in one to eight harmonics. Loads on what is fixed have no effect.
    pub fn solve(&mut self, orders: &[usize]) -> Displacements<'_> {
        let count = orders.len();
        assert!((1..=WIDTH).contains(&count), "{count} harmonics at a time");
        let orders = std::array::from_fn(|lane| orders[lane.min(count - 1)]);
        let rows = self.matrices.rows();
        for side in self.values.chunks_exact_mut(rows) {
            places(&self.fixed).for_each(|place| side[place] = Wide::ZERO);
        }
        self.factors.solve(&self.matrices, orders, &mut self.values, self.sides);
        Displacements { orders, count, sides: self.values.chunks_exact(rows).collect() }
    }
}

/// Bytes of the equations of a mesh with their factors and right sides, if nothing is fixed.
pub fn bytes(mesh: &Mesh) -> u64 {
    let nodes = mesh.nodes.len();
    let mut reach: Vec<usize> = (1..=3 * nodes).collect();
    for element in &mesh.elements {
        let places = || element.nodes().iter().flat_map(|&node| (3 * node as usize..).take(3));
        let end = places().max().map_or(0, |last| last + 1);
        places().for_each(|place| reach[place] = reach[place].max(end));
    }
    band::bytes(nodes, mesh.reach(), &reach) + 3 * nodes as u64 * MOST_SIDES * size_of::<Wide>() as u64
}

/// Most right sides: three of the belt, one of the clamp, one of the spin.
const MOST_SIDES: u64 = 5;

impl Drop for Equations {
    fn drop(&mut self) {
        let (factors, values) = (std::mem::take(&mut self.factors), std::mem::take(&mut self.values));
        let room = EquationRoom { factors, couplings: self.matrices.take_couplings(), values };
        ROOMS.lock().unwrap_or_else(PoisonError::into_inner).push(room);
    }
}

/// Displacements of all nodes under unit loads in eight harmonics, times the modulus.
#[derive(Clone, Debug)]
pub struct Displacements<'s> {
    /// The harmonics.
    pub orders: [usize; WIDTH],
    /// How many of them count. What stands in the other lanes does not matter.
    pub count: usize,
    /// The displacements under each load, `sides[side][3 * node + axis]`.
    pub sides: Vec<&'s [Wide]>,
}

impl<'s> Displacements<'s> {
    /// Displacement of a node along r, z and the circumference, times the modulus.
    pub fn of(&self, node: u32, side: usize) -> &'s [Wide; 3] {
        &self.sides[side].as_chunks().0[node as usize]
    }
}

/// Numbers of the degrees of freedom that are fixed.
fn places(fixed: &[[bool; 3]]) -> impl Iterator<Item = usize> + '_ {
    fixed.as_flattened().iter().enumerate().filter(|(_, fixed)| **fixed).map(|(place, _)| place)
}

/// The matrices of a section's stiffness, for a modulus of 1 MPa; what is fixed has the identity's rows.
///
/// `couplings` is memory for them; its contents do not matter.
pub fn stiffness(mesh: &Mesh, poisson: f64, fixed: &[[bool; 3]], couplings: Vec<Coupling>) -> Matrices {
    let held = fixed.as_flattened();
    let mut matrices = Matrices::reusing(couplings, mesh.nodes.len(), mesh.reach());
    let lame = Lame::new(1.0, poisson);
    let mut element_couplings = Couplings::default();
    for element in &mesh.elements {
        element_couplings.compute(mesh, element, lame);
        let free = || element.nodes().iter().flat_map(|&node| (3 * node as usize..).take(3)).filter(|&place| !held[place]);
        let last = free().max().unwrap_or_default();
        free().for_each(|place| matrices.reaches(place, last));
        let all_free = free().count() == 3 * element.nodes().len();
        for i in 0..element.nodes().len() {
            for j in 0..=i {
                let (row, column, mut coupling) = element_couplings.pair(i, j);
                if !all_free {
                    for ((a, b, _), part) in PARTS.into_iter().zip(&mut coupling) {
                        *part = if held[3 * row + a] || held[3 * column + b] { 0.0 } else { *part };
                    }
                }
                for (sum, part) in matrices.coupling(row, column).iter_mut().zip(coupling) {
                    *sum += part;
                }
            }
        }
    }
    // The identity's rows: of the diagonal the part that no harmonic multiplies.
    for place in places(fixed) {
        let diagonal = PARTS.iter().position(|part| *part == (place % 3, place % 3, 0)).expect("every diagonal has a part");
        matrices.coupling(place / 3, place / 3)[diagonal] = 1.0;
    }
    matrices
}
