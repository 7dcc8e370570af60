//! The surface of a section as lines with arc lengths, for the pictures of the unrolled surface.

use super::mesh::{Mesh, MeshEdge};
use super::response::points_of_edges;

/// A stretch of the surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// What it is: `left side`, `right side`, or `groove` between two discs.
    pub name: &'static str,
    /// Surface points in their order. Where the surface has a corner two points stand at the same arc length.
    pub points: Vec<usize>,
    /// Arc lengths of the points from the start of the stretch, mm.
    pub arc: Vec<f64>,
    /// Ranges of arc length that the belt touches, mm.
    pub bands: Vec<(f64, f64)>,
}

impl Stretch {
    /// Its length, mm.
    pub fn length(&self) -> f64 {
        self.arc.last().copied().unwrap_or(0.0)
    }

    /// Arc length of a surface point, mm, if it lies on this stretch.
    pub fn place_of(&self, point: usize) -> Option<f64> {
        self.points.iter().position(|&it| it == point).map(|at| self.arc[at])
    }
}

/// The surface of a section, from the bore outwards: the left side with the bracket face, the groove between two discs, the right
/// side with the bolt heads. A closed surface is parted at bore and rim.
pub fn stretches(mesh: &Mesh) -> Vec<Stretch> {
    let points = points_of_edges(mesh);
    // Walking with the material on the right goes from the bore out along the left side and back along the right one.
    let mut chains: Vec<Vec<usize>> = Vec::new();
    let starts_at = |edge: &MeshEdge, node: u32| edge.nodes[0] == node;
    let parts = |node: u32| node == mesh.rim || mesh.nodes[node as usize].y <= bore(mesh) + 1e-9;
    let has_before = |edge: &MeshEdge| mesh.surface.iter().any(|other| other.nodes[2] == edge.nodes[0]);
    for (first, edge) in mesh.surface.iter().enumerate().filter(|(_, edge)| !has_before(edge) || parts(edge.nodes[0])) {
        let mut chain = vec![first];
        let mut end = edge.nodes[2];
        while !parts(end) {
            let Some(next) = mesh.surface.iter().position(|edge| starts_at(edge, end)) else { break };
            chain.push(next);
            end = mesh.surface[next].nodes[2];
        }
        chains.push(chain);
    }
    let radius = |edge: usize, end: usize| mesh.nodes[mesh.surface[edge].nodes[end] as usize].y;
    // The wall of the bore of a solid section starts and ends at the bore: nothing to show.
    let in_bore = |chain: &[usize]| chain.iter().all(|&edge| radius(edge, 0).max(radius(edge, 2)) <= bore(mesh) + 1e-9);
    chains.retain(|chain| !in_bore(chain));
    let mut stretches: Vec<Stretch> = chains.iter().map(|chain| stretch(mesh, &points, chain)).collect();
    let order = |name: &str| ["left side", "groove", "right side"].iter().position(|it| *it == name);
    stretches.sort_by_key(|stretch| order(stretch.name));
    stretches
}

/// Radius of the bore, mm.
fn bore(mesh: &Mesh) -> f64 {
    mesh.nodes.iter().map(|node| node.y).fold(f64::INFINITY, f64::min)
}

fn stretch(mesh: &Mesh, points_of: &[[usize; 3]], chain: &[usize]) -> Stretch {
    let at_bore = |node: u32| mesh.nodes[node as usize].y <= bore(mesh) + 1e-9;
    let (first, last) = (mesh.surface[chain[0]].nodes[0], mesh.surface[chain[chain.len() - 1]].nodes[2]);
    let name = match (at_bore(first), at_bore(last)) {
        (true, _) => "left side",
        (false, true) => "right side",
        (false, false) => "groove",
    };
    let (mut points, mut arc, mut bands): (Vec<usize>, Vec<f64>, Vec<(f64, f64)>) = (Vec::new(), Vec::new(), Vec::new());
    let mut from = 0.0;
    for &number in chain {
        let edge = &mesh.surface[number];
        let [start, middle, end] = mesh.edge(edge);
        let half = start.distance(middle);
        let ends = (from, from + half + middle.distance(end));
        for (&point, at) in points_of[number].iter().zip([ends.0, from + half, ends.1]) {
            if points.last() != Some(&point) {
                points.push(point);
                arc.push(at);
            }
        }
        if edge.face == super::mesh::Face::Band {
            match bands.last_mut() {
                Some(band) if band.1 >= ends.0 - 1e-9 => band.1 = ends.1,
                _ => bands.push(ends),
            }
        }
        from = ends.1;
    }
    if name == "right side" {
        points.reverse();
        arc = arc.iter().rev().map(|at| from - at).collect();
        bands = bands.iter().rev().map(|(low, high)| (from - high, from - low)).collect();
    }
    Stretch { name, points, arc, bands }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures;
    use super::super::section::{Fineness, mesh};
    use super::*;

    #[test]
    fn every_surface_point_stands_on_one_stretch_and_starts_at_the_bore() {
        for (kind, dimensions) in fixtures::sections() {
            let mesh = mesh(kind, &dimensions, &Fineness::USUAL).unwrap();
            let stretches = stretches(&mesh);
            let names: Vec<_> = stretches.iter().map(|stretch| stretch.name).collect();
            let discs = kind == crate::pulley::section::SectionKind::WeldedDiscs;
            assert_eq!(names, if discs { vec!["left side", "groove", "right side"] } else { vec!["left side", "right side"] });
            for stretch in &stretches {
                assert!(stretch.arc.windows(2).all(|pair| pair[0] <= pair[1]), "{kind:?}");
                assert_eq!(stretch.arc.len(), stretch.points.len());
            }
            for (edge, points) in mesh.surface.iter().zip(points_of_edges(&mesh)) {
                let on = stretches.iter().filter(|stretch| stretch.points.contains(&points[1])).count();
                let radius = mesh.nodes[edge.nodes[1] as usize].y;
                assert_eq!(on, usize::from(radius > dimensions.bore_radius + 1e-9), "{kind:?} {radius}");
            }
            let touched: f64 = stretches.iter().flat_map(|stretch| &stretch.bands).map(|(low, high)| high - low).sum();
            let flanks = 2.0 * dimensions.groove_count * dimensions.band_length();
            assert!((touched - flanks).abs() < 1e-6, "{kind:?}: {touched} {flanks}");
        }
    }
}
