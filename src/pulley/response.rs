//! A section's answer to unit loads, harmonic by harmonic: everything that load cases share.
//!
//! The answers to the belt's normal load, its two frictions, the bolt heads and the spin are independent of tension, power, wrap, friction
//! and phase, so one factored section serves any number of load cases. The table keeps the [recovered](super::recovery) stresses on the
//! surface, and the rim's displacement like the stresses of one more point. It is a flat table, [`View`], for an elastic modulus of 1 MPa:
//! stresses do not depend on it, and displacements are divided by it.

use super::element::samples;
use super::equations::{Displacements, Equations};
use super::loads::{Seat, belt_patterns, spin};
use super::mesh::Mesh;
pub use super::recovery::{STRESSES, points_of_edges};
use super::recovery::{SurfacePoint, surface_points};
use super::section::{Dimensions, Fineness, SectionKind};
use super::spline;
use super::wide::{WIDTH, Wide};
use std::f64::consts::PI;

/// Unit loads of the belt: normal to the flanks, along them, around the circumference.
pub const BELT: usize = 3;
/// Numbers that points are padded to a multiple of.
pub const CHUNK: usize = WIDTH;
/// Points that are stored a second time after the others, so that they are together: the check points and the rim.
pub const NAMED: usize = 2 * CHUNK;
/// The rim among the named points: its displacements along r, z and the circumference stand in place of stresses.
pub const RIM: usize = CHECK_POINTS.len();
/// Names of the check points, in the order of the outputs.
pub const CHECK_POINTS: [&str; 10] = ["Bl", "Br", "Cl", "Cr", "Dl", "Dr", "El", "Er", "Fl", "Fr"];

/// Where numbers stand at the start of a flat table.
#[derive(Clone, Copy, Debug)]
#[repr(usize)]
enum Head {
    Points,
    Orders,
    Bolts,
    Volume,
    Excluded,
    Check,
    End = Head::Check as usize + CHECK_POINTS.len(),
}

/// Places of so many surface points, the named ones included.
fn padded(points: usize) -> usize {
    points.next_multiple_of(CHUNK) + NAMED
}

/// Sizes of a flat table.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TableSizes {
    /// Points, padded.
    padded: usize,
    /// Harmonics, the zeroth included.
    orders: usize,
    /// Harmonics of the clamp.
    clamps: usize,
}

impl TableSizes {
    const PLACES: usize = 4;

    fn places(&self) -> usize {
        Head::End as usize
    }
    fn belt(&self) -> usize {
        self.places() + Self::PLACES * self.padded
    }
    fn clamp(&self) -> usize {
        self.belt() + self.orders * BELT * STRESSES * self.padded
    }
    fn spin(&self) -> usize {
        self.clamp() + self.clamps * STRESSES * self.padded
    }
    fn length(&self) -> usize {
        self.spin() + STRESSES * self.padded
    }
}

/// Longest flat table.
pub const LONGEST: usize = {
    let (padded, orders) = (super::section::SURFACE_POINTS + NAMED + CHUNK, Fineness::FINE.harmonics + 1);
    Head::End as usize + padded * (TableSizes::PLACES + STRESSES * (BELT * orders + orders + 1))
};

/// A section's answers in a flat table.
#[derive(Clone, Copy, Debug)]
pub struct View<'t> {
    table: &'t [f64],
    sizes: TableSizes,
}

impl<'t> View<'t> {
    /// Reads a table that [`respond`] has written.
    pub fn new(table: &'t [f64]) -> Self {
        let orders = table[Head::Orders as usize] as usize;
        let bolts = table[Head::Bolts as usize] as usize;
        let padded = padded(table[Head::Points as usize] as usize);
        Self { table, sizes: TableSizes { padded, orders, clamps: (orders - 1) / bolts + 1 } }
    }

    /// Numbers in the table.
    pub fn length(&self) -> usize {
        self.sizes.length()
    }

    /// Surface points.
    pub fn points(&self) -> usize {
        self.table[Head::Points as usize] as usize
    }
    /// Surface points and the padding, whose stresses are zero; the named points come after it.
    pub fn padded(&self) -> usize {
        self.sizes.padded - NAMED
    }
    /// Harmonics, the zeroth included.
    pub fn orders(&self) -> usize {
        self.sizes.orders
    }
    /// Bolts.
    pub fn bolts(&self) -> usize {
        self.table[Head::Bolts as usize] as usize
    }
    /// Harmonics of the clamp: multiples of the number of bolts.
    pub fn clamps(&self) -> usize {
        self.sizes.clamps
    }
    /// Volume, mm^3.
    pub fn volume(&self) -> f64 {
        self.table[Head::Volume as usize]
    }
    /// Radius inside which stress does not count as the largest, mm.
    pub fn excluded_radius(&self) -> f64 {
        self.table[Head::Excluded as usize]
    }
    /// The surface point of a check point, by its position in [`CHECK_POINTS`].
    pub fn check_point(&self, number: usize) -> Option<usize> {
        let point = self.table[Head::Check as usize + number];
        (point >= 0.0).then_some(point as usize)
    }
    fn place(&self, number: usize) -> &'t [f64] {
        &self.table[self.sizes.places() + number * self.sizes.padded..][..self.sizes.padded]
    }
    /// z of the points, mm.
    pub fn z(&self) -> &'t [f64] {
        self.place(0)
    }
    /// r of the points, mm.
    pub fn r(&self) -> &'t [f64] {
        self.place(1)
    }
    /// Pressure on the points under a normal load of 1 per ds dtheta: 1/r in the band, 0 elsewhere.
    pub fn pressed(&self) -> &'t [f64] {
        self.place(2)
    }
    /// 1 for points whose stress may be the largest, else 0.
    pub fn counted(&self) -> &'t [f64] {
        self.place(3)
    }
    /// Stress of all points under a unit load of the belt.
    pub fn belt(&self, order: usize, load: usize, stress: usize) -> &'t [f64] {
        let row = (order * BELT + load) * STRESSES + stress;
        &self.table[self.sizes.belt() + row * self.sizes.padded..][..self.sizes.padded]
    }
    /// Stress of all points under unit pressure of the bolt heads, in their harmonic number `clamp`.
    pub fn clamp(&self, clamp: usize, stress: usize) -> &'t [f64] {
        &self.table[self.sizes.clamp() + (clamp * STRESSES + stress) * self.sizes.padded..][..self.sizes.padded]
    }
    /// Stress of all points under a density times square of the speed of 1.
    pub fn spin(&self, stress: usize) -> &'t [f64] {
        &self.table[self.sizes.spin() + stress * self.sizes.padded..][..self.sizes.padded]
    }
}

/// The right side of the clamp, after the belt's.
pub const CLAMP_SIDE: usize = BELT;
/// The right side of the spin, which only the zeroth harmonic has.
pub const SPIN_SIDE: usize = BELT + 1;

/// Harmonics that are solved, for the given fineness and number of bolts; those between are interpolated.
pub fn solved_orders(fineness: &Fineness, bolts: usize) -> Vec<usize> {
    const SOLVED: [usize; 14] = [0, 1, 2, 3, 4, 5, 6, 8, 10, 12, 14, 16, 20, 24];
    // The clamp's load jumps from harmonic to harmonic: its own are never interpolated.
    let wanted = |order: &usize| fineness.every || order.is_multiple_of(bolts) || SOLVED.contains(order) || *order == fineness.harmonics;
    (0..=fineness.harmonics).filter(wanted).collect()
}

/// Solves a section for unit loads in the given harmonics, eight at a time.
pub fn solve(mesh: &Mesh, dimensions: &Dimensions, poisson: f64, orders: &[usize], mut take: impl FnMut(&Displacements<'_>)) {
    let bolts = dimensions.bolt_count as usize;
    let mut equations = Equations::new(mesh, poisson, mesh.fixed().into_iter().map(|fixed| [fixed; 3]).collect());
    let patterns = belt_patterns(mesh);
    let seat = Seat::new(mesh, dimensions);
    // Harmonics of the clamp together: the others have a right side less.
    let mut orders = orders.to_vec();
    orders.sort_by_key(|order| (!order.is_multiple_of(bolts), *order));
    for batch in orders.chunks(WIDTH) {
        let (spins, clamps) = (batch[0] == 0, batch[0].is_multiple_of(bolts));
        let sides = BELT + usize::from(clamps) + usize::from(spins);
        let mut values = equations.loads(sides);
        for (side, pattern) in patterns.iter().enumerate() {
            for (place, &load) in pattern.iter().enumerate().filter(|(_, load)| **load != 0.0) {
                values[side][place] = Wide([load; WIDTH]);
            }
        }
        for (lane, &order) in batch.iter().enumerate().filter(|(_, order)| clamps && order.is_multiple_of(bolts)) {
            seat.load(dimensions, order, |place, load| values[CLAMP_SIDE][place][lane] += load);
        }
        if spins {
            spin(mesh, |place, load| values[SPIN_SIDE][place][0] += load);
        }
        take(&equations.solve(batch));
    }
}

/// Volume of the ring that a section sweeps, mm^3.
pub fn volume(mesh: &Mesh) -> f64 {
    let ring = |element| samples(mesh, element).map(|sample| sample.area * sample.radius).sum::<f64>();
    2.0 * PI * mesh.elements.iter().map(ring).sum::<f64>()
}

/// Does the mesh fold over anywhere?
pub fn folds_over(mesh: &Mesh) -> bool {
    mesh.elements.iter().any(|element| samples(mesh, element).any(|sample| sample.area <= 0.0 || sample.radius <= 0.0))
}

/// Solves a section for unit loads and writes what load cases need into `table`, which has room for [`LONGEST`] numbers.
/// Returns how many were written.
pub fn respond(mesh: &Mesh, kind: SectionKind, dimensions: &Dimensions, poisson: f64, fineness: &Fineness, table: &mut [f64]) -> usize {
    let (points, _) = surface_points(mesh);
    let bolts = dimensions.bolt_count as usize;
    let orders = fineness.harmonics + 1;
    let sizes = TableSizes { padded: padded(points.len()), orders, clamps: (orders - 1) / bolts + 1 };
    let named = sizes.padded - NAMED;
    let table = &mut table[..sizes.length()];
    table.fill(0.0);
    let excluded = dimensions.excluded_radius(kind);
    table[Head::Points as usize] = points.len() as f64;
    table[Head::Orders as usize] = orders as f64;
    table[Head::Bolts as usize] = bolts as f64;
    table[Head::Volume as usize] = volume(mesh);
    table[Head::Excluded as usize] = excluded;
    for (number, name) in CHECK_POINTS.iter().enumerate() {
        let node = mesh.points.iter().find(|point| point.name == *name).map(|point| point.node);
        let point = node.and_then(|node| points.iter().position(|point| point.node == node));
        table[Head::Check as usize + number] = point.map_or(-1.0, |point| point as f64);
    }
    let copies: Vec<(usize, usize)> = (0..CHECK_POINTS.len())
        .filter(|number| table[Head::Check as usize + number] >= 0.0)
        .map(|number| (table[Head::Check as usize + number] as usize, named + number))
        .collect();
    for (number, point) in points.iter().enumerate() {
        let at = mesh.nodes[point.node as usize];
        let singular = at.y < excluded || mesh.singular.iter().any(|(place, distance)| at.distance(*place) <= distance * (1.0 + 1e-9));
        let values = [at.x, at.y, point.pressed / at.y, if singular { 0.0 } else { 1.0 }];
        for (place, value) in values.into_iter().enumerate() {
            table[sizes.places() + place * sizes.padded + number] = value;
        }
    }
    let solved = solved_orders(fineness, bolts);
    solve(mesh, dimensions, poisson, &solved, |answer| {
        for side in 0..answer.sides.len() {
            for (number, point) in points.iter().enumerate() {
                let stresses = point.stresses(answer, side, poisson, normal_stress(point, side, mesh));
                for lane in 0..answer.count {
                    if let Some(row) = row_of(&sizes, answer.orders[lane], side, bolts) {
                        for (stress, values) in stresses.iter().enumerate() {
                            table[row + stress * sizes.padded + number] = values[lane];
                        }
                    }
                }
            }
            for lane in 0..answer.count {
                if let Some(row) = row_of(&sizes, answer.orders[lane], side, bolts) {
                    for axis in 0..3 {
                        for &(point, copy) in &copies {
                            table[row + axis * sizes.padded + copy] = table[row + axis * sizes.padded + point];
                        }
                        table[row + axis * sizes.padded + named + RIM] = answer.of(mesh.rim, side)[axis][lane];
                    }
                }
            }
        }
    });
    spline::fill_between(&solved, sizes.orders, BELT * STRESSES * sizes.padded, &mut table[sizes.belt()..sizes.clamp()]);
    sizes.length()
}

/// Bytes of the table that [`respond`] writes, and those that it needs meanwhile.
pub fn bytes(mesh: &Mesh, dimensions: &Dimensions, fineness: &Fineness) -> (u64, u64) {
    let orders = fineness.harmonics + 1;
    let sizes =
        TableSizes { padded: padded(surface_points(mesh).0.len()), orders, clamps: (orders - 1) / dimensions.bolt_count as usize + 1 };
    (8 * sizes.length() as u64, super::equations::bytes(mesh))
}

/// Where the stresses of all points under a unit load in a harmonic stand, if they are kept.
fn row_of(sizes: &TableSizes, order: usize, side: usize, bolts: usize) -> Option<usize> {
    match side {
        CLAMP_SIDE => order.is_multiple_of(bolts).then(|| sizes.clamp() + order / bolts * STRESSES * sizes.padded),
        SPIN_SIDE => (order == 0).then(|| sizes.spin()),
        load => Some(sizes.belt() + (order * BELT + load) * STRESSES * sizes.padded),
    }
}

/// Stress normal to the surface at a point under a unit load: the belt's own presses with 1/r, as it acts per ds dtheta.
fn normal_stress(point: &SurfacePoint, side: usize, mesh: &Mesh) -> f64 {
    if side == 0 { -point.pressed / mesh.nodes[point.node as usize].y } else { 0.0 }
}
