//! Stresses on the surface of a section, recovered from the displacements there.
//!
//! Stresses extrapolated from inside the elements are a third too low in tight bends. The strains in the plane of the surface follow
//! from its own displacements, and the stress normal to it is known, which leaves plane stress:
//!
//! ```text
//! e_ss = t . du/ds    e_tt = (u_r + k u_th)/r    g_st = du_th/ds - u_th t_r/r - k u_s/r
//! s_ss = E/(1-nu^2) (e_ss + nu e_tt) + nu/(1-nu) s_nn, s_tt alike, tau_st = G g_st
//! ```

use super::equations::Displacements;
use super::loads::EdgePoint;
use super::mesh::{Face, Mesh, MeshEdge};
use super::wide::{WIDTH, Wide};
use glam::DVec2;

/// Stresses kept of a surface point: along the section and around, both less the normal stress, and the shear between them.
pub const STRESSES: usize = 3;

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
pub struct SurfacePoint {
    /// Its node.
    pub node: u32,
    /// Share of its edges that the belt presses.
    pub pressed: f64,
    stencils: Vec<Stencil>,
}

/// Cosine of the turn between two edges up to which the surface counts as smooth at their node.
const SMOOTH: f64 = 0.8;

/// The points of the surface: each node of each smooth stretch. What strains are at the two Gauss points of an edge is extended
/// linearly to its nodes and averaged between the edges that meet. Second, the points of every edge.
pub fn surface_points(mesh: &Mesh) -> (Vec<SurfacePoint>, Vec<[usize; 3]>) {
    let mut points: Vec<SurfacePoint> = Vec::new();
    let mut of_edges = vec![[0; 3]; mesh.surface.len()];
    let mut open: Vec<(u32, usize, DVec2)> = Vec::new();
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

fn add_stencils(stencils: &mut Vec<Stencil>, mesh: &Mesh, edge: &MeshEdge, local: f64, share: f64) {
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

impl SurfacePoint {
    /// Stresses under one unit load in eight harmonics, for a modulus of 1 MPa. `normal` is the stress normal to the surface that the
    /// load makes there, MPa; a pressure is negative.
    pub fn stresses(&self, answer: &Displacements<'_>, side: usize, poisson: f64, normal: f64) -> [Wide; STRESSES] {
        let order = Wide(answer.orders.map(|order| order as f64));
        let [along, around, shear] = strains(&self.stencils, answer.sides[side].as_chunks().0, &order);
        // Plane stress; a stress normal to the surface adds its share to both.
        let share = (poisson / (1.0 - poisson) - 1.0) * normal;
        let plane = 1.0 / (1.0 - poisson * poisson);
        let twist = 0.5 / (1.0 + poisson);
        let mut stresses = [Wide::ZERO; STRESSES];
        for lane in 0..WIDTH {
            stresses[0][lane] = plane * (along[lane] + poisson * around[lane]) + share;
            stresses[1][lane] = plane * (around[lane] + poisson * along[lane]) + share;
            stresses[2][lane] = twist * shear[lane];
        }
        stresses
    }
}

/// Strains along the section and around, and the shear between them, of displacements (r, z, theta) of the nodes.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn strains(stencils: &[Stencil], displacements: &[[Wide; 3]], order: &Wide) -> [Wide; 3] {
    let (mut along, mut around, mut shear) = (Wide::ZERO, Wide::ZERO, Wide::ZERO);
    for stencil in stencils {
        let [ur, uz, ut] = &displacements[stencil.node as usize];
        for lane in 0..WIDTH {
            along[lane] += stencil.along[0] * ur[lane] + stencil.along[1] * uz[lane];
            around[lane] += stencil.around * (ur[lane] + order[lane] * ut[lane]);
            shear[lane] += stencil.shear * ut[lane] - order[lane] * (stencil.lean[0] * ur[lane] + stencil.lean[1] * uz[lane]);
        }
    }
    [along, around, shear]
}
