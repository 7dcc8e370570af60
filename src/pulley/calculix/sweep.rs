//! The section's mesh swept around the axis: bricks of 20 nodes from quadrilaterals, wedges of 15 nodes from triangles.

use crate::pulley::mesh::{Element, Mesh};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// A point of the section (z, r) at an angle: x and y across the axis, z along it, mm.
pub fn turned(point: DVec2, theta: f64) -> DVec3 {
    DVec3::new(point.y * libm::cos(theta), point.y * libm::sin(theta), point.x)
}

/// Where each node of the section is in the three-dimensional model, around the whole circumference.
///
/// Sectors are bounded by full planes, which have every node of the section; halfway between two of them there are only the corners of its
/// elements. The last sector closes on the first plane.
#[derive(Clone, Debug)]
pub struct Sweep {
    sectors: usize,
    section: usize,
    /// Number of a node among the corners.
    corner: Vec<Option<usize>>,
    corners: usize,
}

impl Sweep {
    /// Sweeps a section through equal sectors.
    pub fn new(mesh: &Mesh, sectors: usize) -> Self {
        let mut corner = vec![None; mesh.nodes.len()];
        for element in &mesh.elements {
            for &node in &element.nodes()[..element.corners()] {
                corner[node as usize] = Some(0);
            }
        }
        let mut corners = 0;
        for number in corner.iter_mut().flatten() {
            *number = corners;
            corners += 1;
        }
        Self { sectors, section: mesh.nodes.len(), corner, corners }
    }

    /// Sectors around the axis.
    pub fn sectors(&self) -> usize {
        self.sectors
    }

    /// Nodes of the model.
    pub fn nodes(&self) -> usize {
        self.sectors * (self.section + self.corners)
    }

    /// The node, from 0, of a node of the section on the plane that starts a sector.
    pub fn on_plane(&self, sector: usize, node: u32) -> usize {
        sector % self.sectors * (self.section + self.corners) + node as usize
    }

    /// The node, from 0, of a corner of the section's elements in the middle of a sector; none for the middle of a side.
    pub fn between(&self, sector: usize, node: u32) -> Option<usize> {
        self.corner[node as usize].map(|corner| sector * (self.section + self.corners) + self.section + corner)
    }

    /// Angle at which a sector starts, rad; `part` of a sector further.
    pub fn angle(&self, sector: usize, part: f64) -> f64 {
        2.0 * PI * (sector as f64 + part) / self.sectors as f64
    }

    /// All nodes in the order of their numbers, mm.
    pub fn positions(&self, mesh: &Mesh) -> Vec<DVec3> {
        let mut positions = Vec::with_capacity(self.nodes());
        for sector in 0..self.sectors {
            let (start, middle) = (self.angle(sector, 0.0), self.angle(sector, 0.5));
            positions.extend(mesh.nodes.iter().map(|&point| turned(point, start)));
            let corners = mesh.nodes.iter().zip(&self.corner).filter(|(_, corner)| corner.is_some());
            positions.extend(corners.map(|(&point, _)| turned(point, middle)));
        }
        positions
    }

    /// The nodes, from 0, of an element of the section swept through a sector, in the order that CalculiX wants: corners of the
    /// first and the second face, middles of the sides of the first and the second face, middles of the sides between.
    pub fn element(&self, sector: usize, element: &Element) -> Vec<usize> {
        let (corners, middles) = element.nodes().split_at(element.corners());
        let on = |sector: usize, nodes: &[u32]| nodes.iter().map(|&node| self.on_plane(sector, node)).collect::<Vec<_>>();
        let mut nodes = [on(sector, corners), on(sector + 1, corners), on(sector, middles), on(sector + 1, middles)].concat();
        nodes.extend(corners.iter().filter_map(|&node| self.between(sector, node)));
        nodes
    }

    /// The nodes, from 0, that stand on a node of the section.
    pub fn ring(&self, node: u32) -> impl Iterator<Item = usize> + '_ {
        (0..self.sectors).flat_map(move |sector| std::iter::once(self.on_plane(sector, node)).chain(self.between(sector, node)))
    }
}

/// Nodes, from 0, and shape functions of the face that one edge sweeps through a sector, at local coordinates from -1 to 1 along the
/// edge and around the axis.
pub fn face(sweep: &Sweep, sector: usize, [start, middle, end]: [u32; 3], along: f64, around: f64) -> [(usize, f64); 8] {
    let corner = |s: f64, a: f64| 0.25 * (1.0 + s * along) * (1.0 + a * around) * (s * along + a * around - 1.0);
    let side = |a: f64| 0.5 * (1.0 - along * along) * (1.0 + a * around);
    let rib = |s: f64| 0.5 * (1.0 + s * along) * (1.0 - around * around);
    let at = |sector: usize, node: u32| sweep.on_plane(sector, node);
    // The ends of an edge are corners of its element.
    let between = |node: u32| sweep.between(sector, node).unwrap_or_else(|| at(sector, node));
    [
        (at(sector, start), corner(-1.0, -1.0)),
        (at(sector, end), corner(1.0, -1.0)),
        (at(sector + 1, start), corner(-1.0, 1.0)),
        (at(sector + 1, end), corner(1.0, 1.0)),
        (at(sector, middle), side(-1.0)),
        (at(sector + 1, middle), side(1.0)),
        (between(start), rib(-1.0)),
        (between(end), rib(1.0)),
    ]
}
