//! Shape functions and stiffness of one element under displacements that vary as a harmonic around the axis.
//!
//! Of harmonic k, `u_r = a cos k theta`, `u_z = b cos k theta`, `u_theta = c sin k theta`; with the shape function N of a node the
//! strains are
//!
//! ```text
//! e_rr | dN/dr   0      0             cos
//! e_zz | 0       dN/dz  0             cos
//! e_tt | N/r     0      k N/r         cos
//! g_rz | dN/dz   dN/dr  0             cos
//! g_rt | -k N/r  0      dN/dr - N/r   sin
//! g_zt | 0       -k N/r dN/dz         sin
//! ```
//!
//! so that the stiffness is `K0 + k K1 + k^2 K2`. The factor pi (2 pi at k = 0) that the integral around the axis gives stands on
//! both sides of the equations and is left out.

use super::band::{Coupling, PARTS};
use super::mesh::{Element, Mesh};
use glam::DVec2;
use std::sync::LazyLock;

/// A node's shape function at a point: its value and its derivatives by z and by r.
#[derive(Clone, Copy, Debug, Default)]
pub struct Shape {
    /// N.
    pub value: f64,
    /// (dN/dz, dN/dr), per mm.
    pub slope: DVec2,
}

/// A point of integration: where in the element, and its weight there.
type Gauss = (DVec2, f64);

const THIRD: f64 = 0.577_350_269_189_625_8; // 1/sqrt(3)

/// Two by two points on the square: with more of them thin elements in bending are too stiff.
const SQUARE: [Gauss; 4] = [
    (DVec2::new(-THIRD, -THIRD), 1.0),
    (DVec2::new(THIRD, -THIRD), 1.0),
    (DVec2::new(THIRD, THIRD), 1.0),
    (DVec2::new(-THIRD, THIRD), 1.0),
];

/// Three points in the triangle.
const TRIANGLE: [Gauss; 3] = [
    (DVec2::new(1.0 / 6.0, 1.0 / 6.0), 1.0 / 6.0),
    (DVec2::new(2.0 / 3.0, 1.0 / 6.0), 1.0 / 6.0),
    (DVec2::new(1.0 / 6.0, 2.0 / 3.0), 1.0 / 6.0),
];

/// Values and slopes, in the element's own coordinates, of its shape functions.
fn local_shapes(corners: usize, at: DVec2) -> [Shape; 8] {
    let mut shapes = [Shape::default(); 8];
    if corners == 4 {
        const CORNERS: [(f64, f64); 4] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let (x, y) = (at.x, at.y);
        for (shape, (cx, cy)) in shapes.iter_mut().zip(CORNERS) {
            let (a, b) = (1.0 + x * cx, 1.0 + y * cy);
            shape.value = 0.25 * a * b * (x * cx + y * cy - 1.0);
            shape.slope = 0.25 * DVec2::new(cx * b * (2.0 * x * cx + y * cy), cy * a * (2.0 * y * cy + x * cx));
        }
        for (shape, side) in shapes[4..].iter_mut().zip([-1.0, 1.0, 1.0, -1.0].into_iter().enumerate()) {
            *shape = match side {
                (0 | 2, c) => {
                    let (a, b) = (1.0 - x * x, 1.0 + y * c);
                    Shape { value: 0.5 * a * b, slope: DVec2::new(-x * b, 0.5 * a * c) }
                }
                (_, c) => {
                    let (a, b) = (1.0 + x * c, 1.0 - y * y);
                    Shape { value: 0.5 * a * b, slope: DVec2::new(0.5 * c * b, -y * a) }
                }
            };
        }
    } else {
        let area = [1.0 - at.x - at.y, at.x, at.y];
        let slopes = [DVec2::new(-1.0, -1.0), DVec2::X, DVec2::Y];
        for i in 0..3 {
            shapes[i] = Shape { value: area[i] * (2.0 * area[i] - 1.0), slope: slopes[i] * (4.0 * area[i] - 1.0) };
            let j = (i + 1) % 3;
            shapes[3 + i] = Shape { value: 4.0 * area[i] * area[j], slope: 4.0 * (slopes[i] * area[j] + slopes[j] * area[i]) };
        }
    }
    shapes
}

/// Shape functions at the points of integration.
static SQUARE_SHAPES: LazyLock<[[Shape; 8]; 4]> = LazyLock::new(|| SQUARE.map(|(at, _)| local_shapes(4, at)));
static TRIANGLE_SHAPES: LazyLock<[[Shape; 8]; 3]> = LazyLock::new(|| TRIANGLE.map(|(at, _)| local_shapes(3, at)));

/// A point of integration in the section.
#[derive(Clone, Copy, Debug)]
pub struct IntegrationPoint {
    /// Shape functions there, one per node of the element.
    pub shapes: [Shape; 8],
    /// Distance from the axis, mm.
    pub radius: f64,
    /// Area that the point stands for, mm^2.
    pub area: f64,
}

/// The points of integration of an element; an area that is not positive means a mesh that folds over.
pub fn samples<'m>(mesh: &'m Mesh, element: &'m Element) -> impl Iterator<Item = IntegrationPoint> + 'm {
    let points: &[Gauss] = if element.corners() == 4 { &SQUARE } else { &TRIANGLE };
    let known: &[[Shape; 8]] = if element.corners() == 4 { &*SQUARE_SHAPES } else { &*TRIANGLE_SHAPES };
    points.iter().zip(known).map(|(&(_, weight), shapes)| {
        let mut shapes = *shapes;
        let (mut dz, mut dr) = (DVec2::ZERO, DVec2::ZERO);
        let mut radius = 0.0;
        for (shape, &node) in shapes.iter().zip(element.nodes()) {
            let place = mesh.nodes[node as usize];
            dz += shape.slope * place.x;
            dr += shape.slope * place.y;
            radius += shape.value * place.y;
        }
        let jacobian = dz.x * dr.y - dz.y * dr.x;
        for shape in &mut shapes {
            let own = shape.slope;
            shape.slope = DVec2::new(own.x * dr.y - own.y * dr.x, own.y * dz.x - own.x * dz.y) / jacobian;
        }
        IntegrationPoint { shapes, radius, area: jacobian * weight }
    })
}

/// A value inside an element at its own coordinates: from -1 to 1 each in a quadrilateral, of the corners (0, 0), (1, 0) and (0, 1)
/// in a triangle.
pub fn value_at(element: &Element, at: DVec2, value: impl Fn(usize) -> f64) -> f64 {
    let shapes = local_shapes(element.corners(), at);
    shapes.iter().zip(element.nodes()).map(|(shape, &node)| shape.value * value(node as usize)).sum()
}

/// Shares of the values at the points of integration in the value at each node: what is bilinear (linear in a triangle) extends to
/// the nodes.
pub fn shares_at_nodes(corners: usize) -> [[f64; 4]; 8] {
    let mut shares = [[0.0; 4]; 8];
    let ends = |node: usize| if node < corners { (node, node) } else { (node - corners, (node - corners + 1) % corners) };
    for (node, shares) in shares.iter_mut().enumerate().take(2 * corners) {
        let (a, b) = ends(node);
        if corners == 4 {
            let place = 0.5 * (SQUARE[a].0 + SQUARE[b].0) / (THIRD * THIRD);
            for (share, (point, _)) in shares.iter_mut().zip(SQUARE) {
                let corner = point / THIRD;
                *share = 0.25 * (1.0 + place.x * corner.x) * (1.0 + place.y * corner.y);
            }
        } else {
            for (point, share) in shares.iter_mut().enumerate().take(3) {
                let area = 0.5 * (f64::from(u8::from(point == a)) + f64::from(u8::from(point == b)));
                *share = 2.0 * area - 1.0 / 3.0;
            }
        }
    }
    shares
}

/// Elastic constants of an isotropic material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lame {
    /// Lame's first parameter.
    pub lambda: f64,
    /// Shear modulus.
    pub mu: f64,
}

impl Lame {
    /// From Young's modulus and Poisson's ratio.
    pub fn new(modulus: f64, poisson: f64) -> Self {
        Self { lambda: modulus * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), mu: modulus / (2.0 * (1.0 + poisson)) }
    }
}

/// Nodes whose couplings are computed together.
const FOUR: usize = 4;

/// How each two nodes of an element resist each other.
#[derive(Clone, Debug, Default)]
pub struct Couplings {
    /// Ascending.
    nodes: [u32; 8],
    /// Of each node with four others at a time, each of the [`PARTS`].
    values: [[[[f64; FOUR]; PARTS.len()]; 2]; 8],
}

impl Couplings {
    /// Computes those of an element.
    pub fn compute(&mut self, mesh: &Mesh, element: &Element, lame: Lame) {
        let nodes = element.nodes();
        // In the order of their numbers, so that the nodes before each are side by side.
        let mut order: [usize; 8] = std::array::from_fn(|place| place);
        order[..nodes.len()].sort_unstable_by_key(|&place| nodes[place]);
        self.nodes = order.map(|place| nodes.get(place).copied().unwrap_or_default());
        let mut points = [SortedPoint::default(); 4];
        let mut count = 0;
        for (point, sample) in points.iter_mut().zip(samples(mesh, element)) {
            *point = SortedPoint::new(&sample, &order);
            count += 1;
        }
        couple(&mut self.values, &points[..count], nodes.len(), lame);
    }

    /// The coupling of two nodes by their places in the order of their numbers, `j` no later than `i`: both nodes, and how they are coupled, in
    /// rows of the first and columns of the second.
    #[inline(always)]
    pub fn pair(&self, i: usize, j: usize) -> (usize, usize, Coupling) {
        (self.nodes[i] as usize, self.nodes[j] as usize, self.values[i][j / FOUR].map(|part| part[j % FOUR]))
    }
}

/// A point of integration with the element's nodes in the order of their numbers.
#[derive(Clone, Copy, Debug, Default)]
struct SortedPoint {
    weight: f64,
    /// dN/dz.
    z: [f64; 8],
    /// dN/dr.
    r: [f64; 8],
    /// N/r.
    n: [f64; 8],
    /// Shear in the (r, theta) plane of a displacement around the axis: dN/dr - N/r.
    q: [f64; 8],
}

impl SortedPoint {
    fn new(sample: &IntegrationPoint, order: &[usize; 8]) -> Self {
        let shapes = order.map(|place| sample.shapes[place]);
        let (r, n) = (shapes.map(|shape| shape.slope.y), shapes.map(|shape| shape.value / sample.radius));
        let q = std::array::from_fn(|node| r[node] - n[node]);
        Self { weight: sample.area * sample.radius, z: shapes.map(|shape| shape.slope.x), r, n, q }
    }
}

/// Adds up what the points of integration contribute to the couplings of each node with those before it.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn couple(values: &mut [[[[f64; FOUR]; PARTS.len()]; 2]; 8], points: &[SortedPoint], nodes: usize, Lame { lambda, mu }: Lame) {
    let stiff = lambda + 2.0 * mu;
    for (i, values) in values.iter_mut().enumerate().take(nodes) {
        for (group, values) in values.iter_mut().enumerate().take(i / FOUR + 1) {
            let mut sums = [[0.0; FOUR]; PARTS.len()];
            for point in points {
                let weight = point.weight;
                let (iz, ir, ni, qi) = (point.z[i], point.r[i], point.n[i], point.q[i]);
                let four = |of: &[f64; 8]| [of[group * FOUR], of[group * FOUR + 1], of[group * FOUR + 2], of[group * FOUR + 3]];
                let (z, r, n, q) = (four(&point.z), four(&point.r), four(&point.n), four(&point.q));
                for j in 0..FOUR {
                    let (jz, jr, nj, qj) = (z[j], r[j], n[j], q[j]);
                    sums[0][j] += weight * (stiff * (ir * jr + ni * nj) + lambda * (ir * nj + ni * jr) + mu * iz * jz);
                    sums[1][j] += weight * (lambda * (ir + ni) * jz + mu * iz * jr);
                    sums[2][j] += weight * (lambda * iz * (jr + nj) + mu * ir * jz);
                    sums[3][j] += weight * (stiff * iz * jz + mu * ir * jr);
                    sums[4][j] += weight * mu * (qi * qj + iz * jz);
                    sums[5][j] += weight * ((lambda * ir + stiff * ni) * nj - mu * ni * qj);
                    sums[6][j] += weight * (lambda * iz * nj - mu * ni * jz);
                    sums[7][j] += weight * ((lambda * jr + stiff * nj) * ni - mu * nj * qi);
                    sums[8][j] += weight * (lambda * jz * ni - mu * nj * iz);
                    let product = weight * ni * nj;
                    sums[9][j] += mu * product;
                    sums[10][j] += mu * product;
                    sums[11][j] += stiff * product;
                }
            }
            *values = sums;
        }
    }
}
