//! A section's answer to unit loads, harmonic by harmonic: what a load case needs and nothing that depends on it.
//!
//! The answers to the belt's normal load, its two frictions, the bolt heads and the spin are independent of tension, power, wrap,
//! friction and phase, so one factored section serves any number of load cases. What is kept are the stresses on the surface,
//! recovered from the displacements there (stresses extrapolated from inside are a third too low in tight bends), and the rim's
//! displacement, which is kept like the stresses of one more point. They are laid out in one flat table, [`View`], for an elastic modulus of 1 MPa: stresses do not depend on it, and
//! displacements are divided by it.

use super::band::{Factors, Matrices, WIDTH, Wide};
use super::element::{Coupling, Lame, couple, samples};
use super::loads::{EdgePoint, Seat, belt_patterns};
use super::mesh::{Edge, Face, Mesh};
use super::section::{Dimensions, Fineness, Kind};
use super::spline;
use std::f64::consts::PI;

/// Unit loads of the belt: normal to the flanks, along them, around the circumference.
pub const BELT: usize = 3;
/// Stresses kept of a surface point: along the section and around, both less the normal stress, and the shear between them.
pub const STRESSES: usize = 3;
/// Numbers that points are padded to a multiple of.
pub const CHUNK: usize = 8;
/// Points kept once more after the others, so that they stand together: the check points and the rim.
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
struct Sizes {
    /// Points, padded.
    padded: usize,
    /// Harmonics, the zeroth included.
    orders: usize,
    /// Harmonics of the clamp.
    clamps: usize,
}

impl Sizes {
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
    Head::End as usize + padded * (Sizes::PLACES + STRESSES * (BELT * orders + orders + 1))
};

/// A section's answers in a flat table.
#[derive(Clone, Copy, Debug)]
pub struct View<'t> {
    table: &'t [f64],
    sizes: Sizes,
}

impl<'t> View<'t> {
    /// Reads a table that [`respond`] has written.
    pub fn new(table: &'t [f64]) -> Self {
        let orders = table[Head::Orders as usize] as usize;
        let bolts = table[Head::Bolts as usize] as usize;
        let padded = padded(table[Head::Points as usize] as usize);
        Self { table, sizes: Sizes { padded, orders, clamps: (orders - 1) / bolts + 1 } }
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

/// How strains at a surface point follow from the displacements of a node.
#[derive(Clone, Copy, Debug, Default)]
struct Stencil {
    node: u32,
    /// Of e_ss, by u_r and u_z.
    along: [f64; 2],
    /// N/r: of e_tt by u_r, and by k u_theta.
    around: f64,
    /// Of the shear, by u_theta.
    shear: f64,
    /// Of the shear, by -k u_r and -k u_z.
    lean: [f64; 2],
}

/// A point of the surface at which stress is recovered.
#[derive(Clone, Debug)]
struct SurfacePoint {
    node: u32,
    /// Share of its edges that the belt presses.
    pressed: f64,
    stencils: Vec<Stencil>,
}

/// Cosine of the turn between two edges up to which the surface counts as smooth at their node.
const SMOOTH: f64 = 0.8;

/// The points of the surface: each node of each smooth stretch. What strains are at the two Gauss points of an edge is extended
/// linearly to its nodes and averaged between the edges that meet. Second, the points of every edge.
fn surface_points(mesh: &Mesh) -> (Vec<SurfacePoint>, Vec<[usize; 3]>) {
    let mut points: Vec<SurfacePoint> = Vec::new();
    let mut of_edges = vec![[0; 3]; mesh.surface.len()];
    let mut open: Vec<(u32, usize, glam::DVec2)> = Vec::new();
    let mut edges_of: Vec<Vec<(usize, f64)>> = Vec::new();
    for (number, edge) in mesh.surface.iter().enumerate() {
        for (place, local) in [(0, -1.0), (1, 0.0), (2, 1.0)] {
            let node = edge.nodes[place];
            let along = EdgePoint::new(mesh.edge(edge), local).along;
            let met = (place != 1).then(|| open.iter().position(|(other, _, way)| *other == node && way.dot(along) > SMOOTH)).flatten();
            of_edges[number][place] = points.len();
            match met {
                Some(position) => {
                    let (_, point, _) = open.swap_remove(position);
                    edges_of[point].push((number, local));
                    of_edges[number][place] = point;
                }
                None => {
                    if place != 1 {
                        open.push((node, points.len(), along));
                    }
                    points.push(SurfacePoint { node, pressed: 0.0, stencils: Vec::new() });
                    edges_of.push(vec![(number, local)]);
                }
            }
        }
    }
    for (point, edges) in points.iter_mut().zip(&edges_of) {
        let share = 1.0 / edges.len() as f64;
        for &(number, local) in edges {
            let edge = &mesh.surface[number];
            point.pressed += if edge.face == Face::Band { share } else { 0.0 };
            add_stencils(&mut point.stencils, mesh, edge, local, share);
        }
    }
    (points, of_edges)
}

/// Numbers of the surface points at start, middle and end of every edge of the surface. Where the surface has a corner, the edges
/// that meet there have a point each.
pub fn points_of_edges(mesh: &Mesh) -> Vec<[usize; 3]> {
    surface_points(mesh).1
}

fn add_stencils(stencils: &mut Vec<Stencil>, mesh: &Mesh, edge: &Edge, local: f64, share: f64) {
    const GAUSS: f64 = 0.577_350_269_189_625_8;
    for side in [-1.0, 1.0] {
        let weight = share * 0.5 * (1.0 + side * local / GAUSS);
        let at = EdgePoint::new(mesh.edge(edge), side * GAUSS);
        for place in 0..3 {
            let node = edge.nodes[place];
            let position = stencils.iter().position(|it| it.node == node).unwrap_or_else(|| {
                stencils.push(Stencil { node, ..Stencil::default() });
                stencils.len() - 1
            });
            let stencil = &mut stencils[position];
            let (value, slope, r) = (weight * at.value[place], weight * at.slope[place], at.at.y);
            stencil.along[0] += slope * at.along.y;
            stencil.along[1] += slope * at.along.x;
            stencil.around += value / r;
            stencil.shear += slope - value * at.along.y / r;
            stencil.lean[0] += value / r * at.along.y;
            stencil.lean[1] += value / r * at.along.x;
        }
    }
}

/// The matrices of a section's stiffness, for a modulus of 1 MPa; what is fixed has the identity's rows.
fn stiffness(mesh: &Mesh, poisson: f64, fixed: &[bool]) -> Matrices {
    let mut matrices = Matrices::new(3 * mesh.nodes.len(), 3 * mesh.reach() + 2);
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
            for (j, &column_node) in nodes.iter().enumerate() {
                if row_node < column_node || fixed[row_node as usize] || fixed[column_node as usize] {
                    continue;
                }
                let axes = (0..9).map(|it| (it / 3, it % 3));
                for (a, b) in axes {
                    let (row, column) = (3 * row_node as usize + a, 3 * column_node as usize + b);
                    if row >= column {
                        let entry = matrices.entry(row, column);
                        for (power, entry) in entry.iter_mut().enumerate() {
                            *entry += couplings[i][j][power][a][b];
                        }
                    }
                }
            }
        }
    }
    for (node, _) in fixed.iter().enumerate().filter(|(_, fixed)| **fixed) {
        for axis in 0..3 {
            matrices.entry(3 * node + axis, 3 * node + axis)[0] = 1.0;
        }
    }
    matrices
}

/// Displacements of all nodes under unit loads in four harmonics: `values[(3 * node + axis) * sides + side]`, times the modulus.
pub struct Displacements<'s> {
    /// The harmonics.
    pub orders: [usize; WIDTH],
    /// How many of them count: the last may be repeated to fill the lanes.
    pub count: usize,
    /// Unit loads: the belt's three, the clamp's and, with the zeroth harmonic, the spin's.
    pub sides: usize,
    /// The displacements.
    pub values: &'s [Wide],
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

/// Solves a section for unit loads in the given harmonics, four at a time.
pub fn solve(mesh: &Mesh, dimensions: &Dimensions, poisson: f64, orders: &[usize], mut take: impl FnMut(&Displacements<'_>)) {
    let bolts = dimensions.bolt_count as usize;
    let fixed = mesh.fixed();
    let matrices = stiffness(mesh, poisson, &fixed);
    let patterns = belt_patterns(mesh);
    let seat = Seat::new(mesh, dimensions);
    let mut factors = Factors::default();
    let mut values: Vec<Wide> = Vec::new();
    // Harmonics of the clamp together: the others have a right side less.
    let mut orders = orders.to_vec();
    orders.sort_by_key(|order| (!order.is_multiple_of(bolts), *order));
    for batch in orders.chunks(WIDTH) {
        let lanes: [usize; WIDTH] = std::array::from_fn(|lane| batch[lane.min(batch.len() - 1)]);
        let (spins, clamps) = (lanes[0] == 0, lanes[0].is_multiple_of(bolts));
        let sides = BELT + usize::from(clamps) + usize::from(spins);
        values.clear();
        values.resize(matrices.rows() * sides, [0.0; WIDTH]);
        for (side, pattern) in patterns.iter().enumerate() {
            for (place, &load) in pattern.iter().enumerate().filter(|(_, load)| **load != 0.0) {
                values[place * sides + side] = [load; WIDTH];
            }
        }
        for (lane, &order) in lanes.iter().enumerate().filter(|(_, order)| clamps && order.is_multiple_of(bolts)) {
            seat.load(dimensions, order, |place, load| values[place * sides + CLAMP_SIDE][lane] += load);
        }
        if spins {
            for element in &mesh.elements {
                for sample in samples(mesh, element) {
                    for (shape, &node) in sample.shapes.iter().zip(element.nodes()) {
                        values[3 * node as usize * sides + SPIN_SIDE][0] += shape.value * sample.radius * sample.radius * sample.area;
                    }
                }
            }
        }
        for (node, _) in fixed.iter().enumerate().filter(|(_, fixed)| **fixed) {
            values[3 * node * sides..3 * (node + 1) * sides].fill([0.0; WIDTH]);
        }
        factors.solve(&matrices, lanes, &mut values, sides);
        take(&Displacements { orders: lanes, count: batch.len(), sides, values: &values });
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
pub fn respond(mesh: &Mesh, kind: Kind, dimensions: &Dimensions, poisson: f64, fineness: &Fineness, table: &mut [f64]) -> usize {
    let (points, _) = surface_points(mesh);
    let bolts = dimensions.bolt_count as usize;
    let orders = fineness.harmonics + 1;
    let sizes = Sizes { padded: padded(points.len()), orders, clamps: (orders - 1) / bolts + 1 };
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
    let rim = 3 * mesh.rim as usize;
    solve(mesh, dimensions, poisson, &solved, |answer| {
        for side in 0..answer.sides {
            for (number, point) in points.iter().enumerate() {
                let stresses = stresses(point, answer, side, poisson, mesh);
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
                        table[row + axis * sizes.padded + named + RIM] = answer.values[(rim + axis) * answer.sides + side][lane];
                    }
                }
            }
        }
    });
    spline::fill_between(&solved, sizes.orders, BELT * STRESSES * sizes.padded, &mut table[sizes.belt()..sizes.clamp()]);
    sizes.length()
}

/// Where the stresses of all points under a unit load in a harmonic stand, if they are kept.
fn row_of(sizes: &Sizes, order: usize, side: usize, bolts: usize) -> Option<usize> {
    match side {
        CLAMP_SIDE => order.is_multiple_of(bolts).then(|| sizes.clamp() + order / bolts * STRESSES * sizes.padded),
        SPIN_SIDE => (order == 0).then(|| sizes.spin()),
        load => Some(sizes.belt() + (order * BELT + load) * STRESSES * sizes.padded),
    }
}

/// Stresses at a surface point, recovered from the displacements of the surface and its normal load.
fn stresses(point: &SurfacePoint, answer: &Displacements<'_>, side: usize, poisson: f64, mesh: &Mesh) -> [Wide; STRESSES] {
    let (mut along, mut around, mut shear) = ([0.0; WIDTH], [0.0; WIDTH], [0.0; WIDTH]);
    let order = answer.orders.map(|it| it as f64);
    for stencil in &point.stencils {
        let place = 3 * stencil.node as usize * answer.sides + side;
        let [ur, uz, ut] = [0, 1, 2].map(|axis| &answer.values[place + axis * answer.sides]);
        for lane in 0..WIDTH {
            along[lane] += stencil.along[0] * ur[lane] + stencil.along[1] * uz[lane];
            around[lane] += stencil.around * (ur[lane] + order[lane] * ut[lane]);
            shear[lane] += stencil.shear * ut[lane] - order[lane] * (stencil.lean[0] * ur[lane] + stencil.lean[1] * uz[lane]);
        }
    }
    // Plane stress on a free surface; where the belt presses, the normal stress adds its share to both.
    let normal = if side == 0 { -point.pressed / mesh.nodes[point.node as usize].y } else { 0.0 };
    let share = (poisson / (1.0 - poisson) - 1.0) * normal;
    let plane = 1.0 / (1.0 - poisson * poisson);
    let twist = 0.5 / (1.0 + poisson);
    let mut stresses = [[0.0; WIDTH]; STRESSES];
    for lane in 0..WIDTH {
        stresses[0][lane] = plane * (along[lane] + poisson * around[lane]) + share;
        stresses[1][lane] = plane * (around[lane] + poisson * along[lane]) + share;
        stresses[2][lane] = twist * shear[lane];
    }
    stresses
}
