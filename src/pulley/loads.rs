//! The loads on a pulley as Fourier series around the axis.
//!
//! The belt presses over the wrap, from its slack end at theta = 0, with `exp(mu' theta)`; bolt heads press on annuli of their own.

use super::element::samples;
use super::mesh::{Face, Mesh, MeshEdge};
use super::section::Dimensions;
use crate::real::Real;
use glam::DVec2;
use std::f64::consts::PI;

/// Real and imaginary part.
pub type Complex = (f64, f64);

/// Coefficient of harmonic `k` of `exp(growth theta)` on `[0, wrap]`, zero elsewhere: the function is the sum over k of
/// `Re(G_k exp(i k theta))`. Angles in rad.
pub fn belt_harmonic(growth: f64, wrap: f64, k: usize) -> Complex {
    let order = k as f64;
    let scale = if k == 0 { 0.5 / PI } else { 1.0 / PI };
    if k == 0 && growth == 0.0 {
        return (scale * wrap, 0.0);
    }
    // (exp(w wrap) - 1)/w with w = growth - i k; the real part of the numerator keeps its digits where both are small.
    let half = libm::sin(0.5 * order * wrap);
    let swell = libm::expm1(growth * wrap);
    let (re, im) = (swell * libm::cos(order * wrap) - 2.0 * half * half, -(swell + 1.0) * libm::sin(order * wrap));
    let square = growth * growth + order * order;
    (scale * (re * growth - im * order) / square, scale * (re * order + im * growth) / square)
}

/// Coefficient of harmonic `k` of unit pressure on the annuli under the bolt heads at radius `r`, with the first bolt at theta = 0;
/// zero unless the number of bolts divides k.
pub fn clamp_harmonic(d: &Dimensions, r: f64, k: usize) -> f64 {
    let bolts = d.bolt_count;
    if !k.is_multiple_of(bolts as usize) {
        return 0.0;
    }
    let circle = d.bolt_circle_radius;
    let reach = |radius: f64| libm::acos(((r * r + circle * circle - radius * radius) / (2.0 * r * circle)).clamp(-1.0, 1.0));
    let (head, hole) = (reach(d.bolt_head_radius), reach(d.bolt_hole_radius));
    if k == 0 {
        return bolts * (head - hole) / PI;
    }
    let order = k as f64;
    2.0 * bolts / (PI * order) * (libm::sin(order * head) - libm::sin(order * hole))
}

/// A point of integration on an edge: shape functions of its nodes, their slopes along the edge (per mm), its weight (mm), the place
/// and the direction from start to end.
#[derive(Clone, Copy, Debug)]
pub struct EdgePoint {
    /// Shape functions.
    pub value: [f64; 3],
    /// Derivatives along the edge, per mm.
    pub slope: [f64; 3],
    /// Length that the point stands for, mm; of weight 1.
    pub length: f64,
    /// Where.
    pub at: DVec2,
    /// Unit vector along the edge.
    pub along: DVec2,
}

impl EdgePoint {
    /// At a local coordinate from -1 to 1.
    pub fn new(points: [DVec2; 3], local: f64) -> Self {
        let value = [0.5 * local * (local - 1.0), 1.0 - local * local, 0.5 * local * (local + 1.0)];
        let slope = [local - 0.5, -2.0 * local, local + 0.5];
        let sum = |factors: [f64; 3]| points[0] * factors[0] + points[1] * factors[1] + points[2] * factors[2];
        let tangent = sum(slope);
        let length = tangent.length();
        Self { value, slope: slope.map(|it| it / length), length, at: sum(value), along: tangent / length }
    }

    /// Three points that integrate over an edge; their lengths add up to the edge's.
    pub fn three(points: [DVec2; 3]) -> [Self; 3] {
        GAUSS_3.map(|(local, weight)| {
            let point = Self::new(points, local);
            Self { length: point.length * weight, ..point }
        })
    }

    /// Unit vector out of the material.
    pub fn out(&self) -> DVec2 {
        DVec2::new(-self.along.y, self.along.x)
    }
}

/// Points of Gauss and their weights.
pub(super) const GAUSS_3: [(f64, f64); 3] = [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Half of the twelve points of Gauss and their weights: the others are their mirror images.
const GAUSS_12: [(f64, f64); 6] = [
    (0.125_233_408_511_468_9, 0.249_147_045_813_402_8),
    (0.367_831_498_998_180_2, 0.233_492_536_538_354_8),
    (0.587_317_954_286_617_4, 0.203_167_426_723_065_9),
    (0.769_902_674_194_304_7, 0.160_078_328_543_346_2),
    (0.904_117_256_370_474_9, 0.106_939_325_995_318_4),
    (0.981_560_634_246_719_3, 0.047_175_336_386_511_8),
];

/// Unit loads of the belt on the degrees of freedom (r, z, theta of each node): normal to both flanks, along them towards the
/// groove's floor, and around the circumference. Per ds dtheta, so without the factor r.
pub fn belt_patterns(mesh: &Mesh) -> [Vec<f64>; 3] {
    let mut patterns = [(); 3].map(|()| vec![0.0; 3 * mesh.nodes.len()]);
    for edge in mesh.surface.iter().filter(|edge| edge.face == Face::Band) {
        for point in EdgePoint::three(mesh.edge(edge)) {
            let out = point.out();
            let inwards = if point.along.y < 0.0 { point.along } else { -point.along };
            for (&node, value) in edge.nodes.iter().zip(point.value) {
                let share = value * point.length;
                let place = 3 * node as usize;
                patterns[0][place] -= out.y * share;
                patterns[0][place + 1] -= out.x * share;
                patterns[1][place] += inwards.y * share;
                patterns[1][place + 1] += inwards.x * share;
                patterns[2][place + 2] += share;
            }
        }
    }
    patterns
}

/// The points of Gauss on an interval, with their weights.
pub(super) fn gauss(from: f64, to: f64) -> impl Iterator<Item = (f64, f64)> {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    GAUSS_12.into_iter().flat_map(move |(local, weight)| [(middle - half * local, half * weight), (middle + half * local, half * weight)])
}

/// Points for integrals of the bolt heads' pressure along an edge of the seat: local coordinates and weights.
///
/// Where heads and holes begin and end, the share of the circumference that they take rises like a square root: the edge is cut
/// there, and a cosine draws the points together at the cuts.
pub(super) fn seat_points([start, _, end]: [DVec2; 3], d: &Dimensions) -> Vec<(f64, f64)> {
    let offsets = [-d.bolt_head_radius, -d.bolt_hole_radius, d.bolt_hole_radius, d.bolt_head_radius];
    let cuts = offsets.map(|offset| 2.0 * (d.bolt_circle_radius + offset - start.y) / (end.y - start.y) - 1.0);
    let mut ends = vec![-1.0, 1.0];
    ends.extend(cuts.into_iter().filter(|cut| cut.abs() < 1.0));
    ends.sort_by(f64::total_cmp);
    let mut points = Vec::new();
    for range in ends.windows(2) {
        let (middle, half) = (0.5 * (range[0] + range[1]), 0.5 * (range[1] - range[0]));
        points.extend(gauss(0.0, PI).map(|(part, weight)| (middle - half * libm::cos(part), half * libm::sin(part) * weight)));
    }
    points
}

/// Points at which the pressure of the bolt heads is integrated.
#[derive(Clone, Debug)]
pub struct Seat {
    points: Vec<([u32; 3], [f64; 3], f64)>,
}

impl Seat {
    /// On the seats of a mesh, as far as heads reach.
    pub fn new(mesh: &Mesh, d: &Dimensions) -> Self {
        let inner = d.bolt_circle_radius - d.bolt_head_radius;
        let outer = d.bolt_circle_radius + d.bolt_head_radius;
        let near = |edge: &&MeshEdge| {
            let [start, _, end] = mesh.edge(edge);
            edge.face == Face::Seat && start.y.max(end.y) > inner && start.y.min(end.y) < outer
        };
        let mut points = Vec::new();
        for edge in mesh.surface.iter().filter(near) {
            for (local, weight) in seat_points(mesh.edge(edge), d) {
                let point = EdgePoint::new(mesh.edge(edge), local);
                points.push((edge.nodes, point.value.map(|value| value * point.length * weight * point.at.y), point.at.y));
            }
        }
        Self { points }
    }

    /// Adds the load of unit pressure in harmonic `k` to the degrees of freedom, through `add(degree of freedom, load)`.
    pub fn load(&self, d: &Dimensions, k: usize, mut add: impl FnMut(usize, f64)) {
        for (nodes, shares, radius) in &self.points {
            let pressure = clamp_harmonic(d, *radius, k);
            for (&node, share) in nodes.iter().zip(shares) {
                add(3 * node as usize + 1, -pressure * share);
            }
        }
    }
}

/// Adds the load of a density times square of the speed of 1 to the degrees of freedom, through `add(degree of freedom, load)`.
pub fn spin(mesh: &Mesh, mut add: impl FnMut(usize, f64)) {
    for element in &mesh.elements {
        for sample in samples(mesh, element) {
            for (shape, &node) in sample.shapes.iter().zip(element.nodes()) {
                add(3 * node as usize, shape.value * sample.radius * sample.radius * sample.area);
            }
        }
    }
}

/// Pressure under the bolt heads, MPa, of a force per bolt in N.
pub fn clamp_pressure<R: Real>(d: &Dimensions<R>, force: R) -> R {
    force / (R::constant(PI) * (d.bolt_head_radius * d.bolt_head_radius - d.bolt_hole_radius * d.bolt_hole_radius))
}
