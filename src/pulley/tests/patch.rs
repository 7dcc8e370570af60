//! Patch tests: fields of constant stress on skewed meshes.

use super::{CellDivision, POISSON, grid, node, set, tractions};
use crate::pulley::element::Lame;
use crate::pulley::equations::{Equations, stiffness};
use crate::pulley::loads::EdgePoint;
use crate::pulley::mesh::Mesh;
use crate::pulley::recovery::surface_points;
use glam::DVec2;

/// A displacement field linear in z and r, and its constant strains (e_rr, e_zz, e_tt, g_rz, g_rt, g_zt).
struct PatchField {
    name: &'static str,
    order: usize,
    at: fn(DVec2) -> [f64; 3],
    strain: [f64; 6],
}

const fn field(name: &'static str, order: usize, at: fn(DVec2) -> [f64; 3], strain: [f64; 6]) -> PatchField {
    PatchField { name, order, at, strain }
}

/// In Cartesian axes each of them is linear, so its strains are constant there, and so are their amplitudes here.
const FIELDS: [PatchField; 9] = [
    field("axial", 0, |p| [0.0, p.x, 0.0], [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]),
    field("equibiaxial", 0, |p| [p.y, 0.0, 0.0], [1.0, 0.0, 1.0, 0.0, 0.0, 0.0]),
    field("shear across", 1, |p| [p.x, 0.0, -p.x], [0.0, 0.0, 0.0, 1.0, 0.0, -1.0]),
    field("shear along", 1, |p| [0.0, p.y, 0.0], [0.0, 0.0, 0.0, 1.0, 0.0, -1.0]),
    field("pure shear", 2, |p| [p.y, 0.0, -p.y], [1.0, 0.0, -1.0, 0.0, -2.0, 0.0]),
    field("axial shift", 0, |_| [0.0, 1.0, 0.0], [0.0; 6]),
    field("spin", 0, |p| [0.0, 0.0, p.y], [0.0; 6]),
    field("translation", 1, |_| [1.0, 0.0, -1.0], [0.0; 6]),
    field("tilt", 1, |p| [p.x, -p.y, -p.x], [0.0; 6]),
];

impl PatchField {
    /// Stresses (s_rr, s_zz, s_tt, t_rz, t_rt, t_zt) for a modulus.
    fn stress(&self, modulus: f64) -> [f64; 6] {
        let Lame { lambda, mu } = Lame::new(modulus, POISSON);
        let trace = lambda * (self.strain[0] + self.strain[1] + self.strain[2]);
        std::array::from_fn(|it| if it < 3 { trace + 2.0 * mu * self.strain[it] } else { mu * self.strain[it] })
    }

    /// Traction (r, z, circumference) on a face.
    fn traction(&self, point: &EdgePoint) -> [f64; 3] {
        let [rr, zz, _, rz, rt, zt] = self.stress(1.0);
        let out = point.out();
        [rr * out.y + rz * out.x, rz * out.y + zz * out.x, rt * out.y + zt * out.x]
    }

    fn nodal(&self, mesh: &Mesh) -> Vec<f64> {
        mesh.nodes.iter().flat_map(|&node| (self.at)(node)).collect()
    }
}

/// A patch of four by three elements of which no inner side is parallel to another.
fn skewed(division: CellDivision) -> Mesh {
    let wobble = |i: usize, j: usize| {
        let (i, j) = (i as f64, j as f64);
        DVec2::new((2.7 * i + 1.9 * j).sin(), (1.3 * i - 3.1 * j).cos())
    };
    grid((4, 3), division, |i, j| {
        let inner = (1..4).contains(&i) && (1..3).contains(&j);
        let amount = if inner { 0.35 } else { 0.0 };
        DVec2::new(-1.0 + 2.0 * i as f64, 10.0 + 2.0 * j as f64 + 0.3 * i as f64) + amount * wobble(i, j)
    })
}

/// The patch under the tractions of a field, with just enough fixed to stop rigid motions; and the two nodes that do it.
fn loaded(mesh: &Mesh, field: &PatchField) -> (Equations, [u32; 2]) {
    let ends = [node(mesh, -1.0, 10.0), node(mesh, 7.0, 17.2)];
    let mut fixed = vec![[false; 3]; mesh.nodes.len()];
    match field.order {
        0 => fixed[ends[0] as usize] = [false, true, true],
        1 => ends.into_iter().for_each(|node| fixed[node as usize][0] = true),
        _ => {}
    }
    let mut equations = Equations::new(mesh, POISSON, fixed);
    set(equations.loads(3)[0], &tractions(mesh, |_, point| field.traction(point)));
    (equations, ends)
}

#[test]
fn nodal_forces_of_constant_stress_are_those_of_its_tractions() {
    for division in [CellDivision::Whole, CellDivision::Split] {
        let mesh = skewed(division);
        let matrices = stiffness(&mesh, POISSON, &vec![[false; 3]; mesh.nodes.len()], Vec::new());
        for field in &FIELDS {
            let (forces, expected) = (matrices.times(field.order, &field.nodal(&mesh)), tractions(&mesh, |_, point| field.traction(point)));
            for (place, (force, expected)) in forces.iter().zip(&expected).enumerate() {
                // Rigid motions among them: no force and no energy.
                assert!((force - expected).abs() < 2e-12, "{division:?}, {}, {place}: {force} {expected}", field.name);
            }
        }
    }
}

#[test]
fn a_skewed_patch_under_its_tractions_has_the_linear_field() {
    for division in [CellDivision::Whole, CellDivision::Split] {
        let mesh = skewed(division);
        for field in FIELDS.iter().filter(|field| field.strain != [0.0; 6]) {
            let (mut equations, [a, b]) = loaded(&mesh, field);
            let answer = equations.solve(&[field.order]);
            let at = |node: u32| (field.at)(mesh.nodes[node as usize]);
            let (pa, pb) = (mesh.nodes[a as usize], mesh.nodes[b as usize]);
            // What was fixed takes a rigid motion off the field.
            let tilt = if field.order == 1 { (at(b)[0] - at(a)[0]) / (pb.x - pa.x) } else { 0.0 };
            let shift = if field.order == 1 { at(a)[0] - tilt * pa.x } else { 0.0 };
            let axial = if field.order == 0 { at(a)[1] } else { 0.0 };
            for number in 0..mesh.nodes.len() as u32 {
                let place = mesh.nodes[number as usize];
                let [r, z, theta] = at(number);
                let expected = [r - shift - tilt * place.x, z - axial + tilt * place.y, theta + shift + tilt * place.x];
                for (found, expected) in answer.of(number, 0).iter().zip(expected) {
                    let found = found[0];
                    assert!((found - expected).abs() < 1e-10, "{division:?}, {}, {place}: {found} {expected}", field.name);
                }
            }
        }
    }
}

#[test]
fn the_surface_of_a_skewed_patch_has_the_constant_stress() {
    for division in [CellDivision::Whole, CellDivision::Split] {
        let mesh = skewed(division);
        for field in FIELDS.iter().filter(|field| field.strain != [0.0; 6]) {
            let (mut equations, _) = loaded(&mesh, field);
            let answer = equations.solve(&[field.order]);
            let [rr, zz, tt, rz, rt, zt] = field.stress(1.0);
            for point in surface_points(&mesh).0 {
                let edge = mesh.surface.iter().find(|edge| edge.nodes[1] == point.node);
                // Middles of edges: corners belong to two of them.
                let Some(edge) = edge else { continue };
                let at = EdgePoint::new(mesh.edge(edge), 0.0);
                let (out, along) = (at.out(), at.along);
                let on = |a: DVec2, b: DVec2| rr * a.y * b.y + zz * a.x * b.x + rz * (a.x * b.y + a.y * b.x);
                let normal = on(out, out);
                let expected = [on(along, along) - normal, tt - normal, rt * along.y + zt * along.x];
                for (found, expected) in point.stresses(&answer, 0, POISSON, normal).iter().zip(expected) {
                    assert!((found[0] - expected).abs() < 1e-11, "{division:?}, {}, {}: {} {expected}", field.name, at.at, found[0]);
                }
            }
        }
    }
}
