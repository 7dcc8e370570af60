//! The loads on the three-dimensional model as forces on its nodes.
//!
//! Belt and bolt heads press on parts of the faces, with jumps at their ends: the integrals are split there.

use super::sweep::{Sweep, face, turned};
use crate::pulley::loads::{EdgePoint, GAUSS_3, gauss, seat_points};
use crate::pulley::mesh::{Face, Mesh, MeshEdge};
use crate::pulley::section::Dimensions;
use crate::pulley::turn::Case;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Forces on the nodes of a model, N.
#[derive(Clone, Debug)]
pub struct Forces {
    /// By node.
    pub nodes: Vec<DVec3>,
}

/// A force and its moment about the origin, which lies on the axis in the bracket face.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Force, N.
    pub force: DVec3,
    /// Moment, N mm.
    pub moment: DVec3,
}

impl Wrench {
    /// Sum of forces at positions.
    pub fn of(pairs: impl Iterator<Item = (DVec3, DVec3)>) -> Self {
        pairs.fold(Self::default(), |sum, (position, force)| Self { force: sum.force + force, moment: sum.moment + position.cross(force) })
    }
}

impl Forces {
    /// Forces of the belt and the bolt heads. The case's phase is taken as 0 if it is open.
    pub fn new(mesh: &Mesh, sweep: &Sweep, dimensions: &Dimensions, case: &Case) -> Self {
        let mut forces = Self { nodes: vec![DVec3::ZERO; sweep.nodes()] };
        for edge in &mesh.surface {
            match edge.face {
                Face::Band => forces.belt(mesh, sweep, edge, case),
                Face::Seat => forces.heads(mesh, sweep, edge, dimensions, case),
                Face::Free | Face::Bracket => (),
            }
        }
        forces
    }

    /// Adds a force per angle, of an angle, on a point of an edge between two angles within a sector.
    fn add(&mut self, sweep: &Sweep, sector: usize, edge: &MeshEdge, local: f64, range: (f64, f64), force: impl Fn(f64) -> DVec3) {
        let (start, width) = (sweep.angle(sector, 0.0), sweep.angle(1, 0.0));
        let (from, to) = (range.0.max(start), range.1.min(start + width));
        if from >= to {
            return;
        }
        for (theta, weight) in gauss(from, to) {
            let load = force(theta) * weight;
            for (node, share) in face(sweep, sector, edge.nodes, local, 2.0 * (theta - start) / width - 1.0) {
                self.nodes[node] += load * share;
            }
        }
    }

    /// The belt: normal to the flank, along it and around, from angle 0 to the wrap.
    fn belt(&mut self, mesh: &Mesh, sweep: &Sweep, edge: &MeshEdge, case: &Case) {
        for (local, weight) in GAUSS_3 {
            let point = EdgePoint::new(mesh.edge(edge), local);
            let out = DVec2::new(-point.along.y, point.along.x);
            let inwards = if point.along.y < 0.0 { point.along } else { -point.along };
            let in_plane = (inwards * case.along - out) * (case.normal * point.length * weight);
            let around = case.around * case.normal * point.length * weight;
            let force = |theta: f64| {
                let circumference = DVec3::new(-libm::sin(theta), libm::cos(theta), 0.0);
                (turned(in_plane, theta) + circumference * around) * libm::exp(case.growth * theta)
            };
            for sector in 0..sweep.sectors() {
                self.add(sweep, sector, edge, local, (0.0, case.wrap), force);
            }
        }
    }

    /// Pressure of the bolt heads, between hole and head.
    fn heads(&mut self, mesh: &Mesh, sweep: &Sweep, edge: &MeshEdge, d: &Dimensions, case: &Case) {
        let circle = d.bolt_circle_radius;
        for (local, weight) in seat_points(mesh.edge(edge), d) {
            let point = EdgePoint::new(mesh.edge(edge), local);
            let r = point.at.y;
            let reach = |radius: f64| libm::acos(((r * r + circle * circle - radius * radius) / (2.0 * r * circle)).clamp(-1.0, 1.0));
            let (head, hole) = (reach(d.bolt_head_radius), reach(d.bolt_hole_radius));
            let force = DVec3::new(0.0, 0.0, -case.pressure * r * point.length * weight);
            for bolt in 0..d.bolt_count as usize {
                let middle = case.phase.unwrap_or(0.0) + 2.0 * PI * bolt as f64 / d.bolt_count;
                for (from, to) in [(middle - head, middle - hole), (middle + hole, middle + head)] {
                    // The part of the turn that holds it may be one before or after.
                    for turn in [-2.0 * PI, 0.0, 2.0 * PI] {
                        let first = ((from + turn) / sweep.angle(1, 0.0)).floor().max(0.0) as usize;
                        for sector in first..sweep.sectors() {
                            if sweep.angle(sector, 0.0) >= to + turn {
                                break;
                            }
                            self.add(sweep, sector, edge, local, (from + turn, to + turn), |_| force);
                        }
                    }
                }
            }
        }
    }

    /// Sum of all forces, and of their moments about the origin.
    pub fn total(&self, positions: &[DVec3]) -> Wrench {
        Wrench::of(positions.iter().copied().zip(self.nodes.iter().copied()))
    }
}

/// What the loads of a case add up to, in closed form: the pull of the two strands in the belt's plane, the torque, and the force of
/// the bolts. The moments about x and y depend on where the groove stands and are left out.
pub fn closed_form(dimensions: &Dimensions, case: &Case) -> Wrench {
    let (sine, cosine) = (libm::sin(dimensions.half_angle), libm::cos(dimensions.half_angle));
    let flanks = 2.0 * dimensions.groove_count * case.normal * dimensions.band_length();
    let (inwards, around) = (flanks * (sine + case.along * cosine), flanks * case.around);
    // Integrals of exp(growth theta) times 1, cos and sin, over the wrap.
    let whole = if case.growth == 0.0 { case.wrap } else { libm::expm1(case.growth * case.wrap) / case.growth };
    let (g, w) = (case.growth, case.wrap);
    let (swell, square) = (libm::exp(g * w), 1.0 + g * g);
    let cosines = (swell * (g * libm::cos(w) + libm::sin(w)) - g) / square;
    let sines = (swell * (g * libm::sin(w) - libm::cos(w)) + 1.0) / square;
    let heads = dimensions.bolt_head_radius * dimensions.bolt_head_radius - dimensions.bolt_hole_radius * dimensions.bolt_hole_radius;
    let bolts = PI * heads * case.pressure * dimensions.bolt_count;
    Wrench {
        force: DVec3::new(-inwards * cosines - around * sines, -inwards * sines + around * cosines, -bolts),
        moment: DVec3::new(0.0, 0.0, around * whole * dimensions.mean_radius),
    }
}
