//! The mesh of a pulley's section in the (z, r) half-plane: quadratic quadrilaterals and triangles.
//!
//! Points are [`DVec2`] with `x` = z (along the axis, from the bracket face) and `y` = r (from the axis), in mm.

use glam::DVec2;

/// A quadratic element: eight-node quadrilateral or six-node triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Element {
    /// Corner nodes counter-clockwise in (z, r), then the nodes in the middle of the sides that follow each corner.
    nodes: [u32; 8],
    corners: u8,
}

impl Element {
    /// A quadrilateral: four corners, then the middles of the sides 0-1, 1-2, 2-3, 3-0.
    pub fn quadrilateral(nodes: [u32; 8]) -> Self {
        Self { nodes, corners: 4 }
    }

    /// A triangle: three corners, then the middles of the sides 0-1, 1-2, 2-0.
    pub fn triangle([a, b, c, ab, bc, ca]: [u32; 6]) -> Self {
        Self { nodes: [a, b, c, ab, bc, ca, 0, 0], corners: 3 }
    }

    /// Its nodes.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes[..2 * usize::from(self.corners)]
    }

    /// How many corners it has.
    pub fn corners(&self) -> usize {
        usize::from(self.corners)
    }
}

/// The kind of a piece of the section's surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// Nothing touches it.
    Free,
    /// Back face inside the bracket diameter: fixed.
    Bracket,
    /// Front face of the hub, where the bolt heads sit.
    Seat,
    /// Flank inside the belt's contact band.
    Band,
}

/// A piece of the surface: one side of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshEdge {
    /// Start, middle and end; walking from start to end, with z to the right and r up, the material lies on the right.
    pub nodes: [u32; 3],
    /// What it is.
    pub face: Face,
}

/// A named place on the surface where stress is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CheckPoint {
    /// Its name, such as `Fl`.
    pub name: &'static str,
    /// The node that stands there.
    pub node: u32,
}

/// A meshed section.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Nodes, numbered so that neighbours have near numbers: what an element spans is the band of the equations.
    pub nodes: Vec<DVec2>,
    /// Elements.
    pub elements: Vec<Element>,
    /// The surface on which stress is recovered.
    pub surface: Vec<MeshEdge>,
    /// Check points.
    pub points: Vec<CheckPoint>,
    /// The node whose displacement is the rim's.
    pub rim: u32,
    /// Places beside which stress grows without limit as the mesh becomes finer, other than the hub's edges: (z, r), and the distance
    /// within which stress does not count as the largest, mm.
    pub singular: Vec<(DVec2, f64)>,
}

impl Mesh {
    /// The points of an edge.
    pub fn edge(&self, edge: &MeshEdge) -> [DVec2; 3] {
        edge.nodes.map(|node| self.nodes[node as usize])
    }

    /// Is each node fixed to the bracket?
    pub fn fixed(&self) -> Vec<bool> {
        let mut fixed = vec![false; self.nodes.len()];
        for edge in self.surface.iter().filter(|edge| edge.face == Face::Bracket) {
            edge.nodes.iter().for_each(|&node| fixed[node as usize] = true);
        }
        fixed
    }

    /// Largest difference between the numbers of two nodes of one element.
    pub fn reach(&self) -> usize {
        let spread = |element: &Element| {
            let nodes = element.nodes();
            nodes.iter().max().zip(nodes.iter().min()).map_or(0, |(most, least)| (most - least) as usize)
        };
        self.elements.iter().map(spread).max().unwrap_or(0)
    }
}
