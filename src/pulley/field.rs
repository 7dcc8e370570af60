//! The whole section at one angle: displacements and von Mises stresses of all nodes, for pictures.
//!
//! [`super::response`] keeps only the surface. Here the displacements of all nodes under unit loads are kept, and a load case combines them
//! at one angle as [`super::turn`] does with stresses. On the surface the stresses are those that are reported; inside they are computed
//! from the strains at the points of integration, extended to the nodes and averaged.

use super::element::{Lame, samples, shares_at_nodes};
use super::mesh::{Face, Mesh};
use super::response::{BELT, CLAMP_SIDE, SPIN_SIDE, points_of_edges, solve, solved_orders};
use super::section::{Dimensions, Fineness};
use super::spline;
use super::turn::Turn;
use std::f64::consts::PI;

/// Displacements of all nodes of a section under unit loads, times the elastic modulus.
#[derive(Clone, Debug)]
pub struct UnitDisplacements {
    poisson: f64,
    bolts: usize,
    orders: usize,
    /// Displacements (r, z, theta) of all nodes, for each harmonic and each unit load of the belt.
    belt: Vec<f64>,
    /// The same for each harmonic of the bolt heads.
    clamp: Vec<f64>,
    /// The same for the spin.
    spin: Vec<f64>,
}

/// The section at one angle.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Angle from the slack end, rad.
    pub theta: f64,
    /// Angle of the first bolt, rad.
    pub phase: f64,
    /// Displacements (r, z, theta) of the nodes, mm.
    pub displacement: Vec<[f64; 3]>,
    /// Von Mises stresses of the nodes, MPa.
    pub von_mises: Vec<f64>,
}

/// Displacements of the nodes at an angle, and their derivatives by it.
struct Motion {
    value: Vec<[f64; 3]>,
    slope: Vec<[f64; 3]>,
}

impl Motion {
    /// Adds a share of unit answers: `(cosine, sine)` of `Re` and `Im` of `X exp(i k theta)`.
    fn add(&mut self, unit: &[f64], (cosine, sine): (f64, f64), order: usize) {
        let order = order as f64;
        for ((value, slope), unit) in self.value.iter_mut().zip(&mut self.slope).zip(unit.chunks_exact(3)) {
            for axis in 0..2 {
                value[axis] += cosine * unit[axis];
                slope[axis] -= order * sine * unit[axis];
            }
            value[2] += sine * unit[2];
            slope[2] += order * cosine * unit[2];
        }
    }
}

impl UnitDisplacements {
    /// Solves a section for unit loads, in the harmonics that [`super::response::respond`] solves with this fineness.
    pub fn new(mesh: &Mesh, dimensions: &Dimensions, poisson: f64, fineness: &Fineness) -> Self {
        let bolts = dimensions.bolt_count as usize;
        let (orders, row) = (fineness.harmonics + 1, 3 * mesh.nodes.len());
        let mut belt = vec![0.0; orders * BELT * row];
        let mut clamp = vec![0.0; ((orders - 1) / bolts + 1) * row];
        let mut spin = vec![0.0; row];
        let solved = solved_orders(fineness, bolts);
        solve(mesh, dimensions, poisson, &solved, |answer| {
            for (lane, &order) in answer.orders.iter().enumerate().take(answer.count) {
                for (side, values) in answer.sides.iter().enumerate() {
                    let place = match side {
                        CLAMP_SIDE if order.is_multiple_of(bolts) => &mut clamp[order / bolts * row..][..row],
                        SPIN_SIDE if order == 0 => &mut spin[..],
                        CLAMP_SIDE | SPIN_SIDE => continue,
                        load => &mut belt[(order * BELT + load) * row..][..row],
                    };
                    for (place, value) in place.iter_mut().zip(*values) {
                        *place = value[lane];
                    }
                }
            }
        });
        spline::fill_between(&solved, orders, BELT * row, &mut belt);
        Self { poisson, bolts, orders, belt, clamp, spin }
    }

    /// The section under a load case at an angle, with the first bolt at `phase`; angles in rad. `turn` must be of the same mesh.
    pub fn field(&self, mesh: &Mesh, turn: &Turn<'_>, theta: f64, phase: f64) -> Field {
        let motion = self.motion(turn, theta, phase);
        let mut von_mises = self.inside(mesh, &motion);
        self.recover_surface(mesh, turn, (theta, phase), &mut von_mises);
        let modulus = turn.case().modulus;
        let displacement = motion.value.iter().map(|value| value.map(|it| it / modulus)).collect();
        Field { theta, phase, displacement, von_mises }
    }

    /// Displacements (times the modulus) at an angle.
    fn motion(&self, turn: &Turn<'_>, theta: f64, phase: f64) -> Motion {
        let row = self.spin.len();
        let mut motion = Motion { value: vec![[0.0; 3]; row / 3], slope: vec![[0.0; 3]; row / 3] };
        let wave = |order: usize, angle: f64| (libm::cos(order as f64 * angle), libm::sin(order as f64 * angle));
        for order in 0..self.orders {
            let (cosine, sine) = wave(order, theta);
            for (load, (real, imaginary)) in turn.amplitudes(order).into_iter().enumerate() {
                let turned = (real * cosine - imaginary * sine, imaginary * cosine + real * sine);
                motion.add(&self.belt[(order * BELT + load) * row..][..row], turned, order);
            }
        }
        for (clamp, unit) in self.clamp.chunks_exact(row).enumerate() {
            let (cosine, sine) = wave(clamp * self.bolts, theta - phase);
            let pressure = turn.case().pressure;
            motion.add(unit, (pressure * cosine, pressure * sine), clamp * self.bolts);
        }
        motion.add(&self.spin, (turn.case().spin, 0.0), 0);
        motion
    }

    /// Von Mises stresses of the nodes from the strains inside the elements.
    fn inside(&self, mesh: &Mesh, motion: &Motion) -> Vec<f64> {
        let mut sums = vec![([0.0; 6], 0.0); mesh.nodes.len()];
        for element in &mesh.elements {
            let nodes = element.nodes();
            let mut stresses = [[0.0; 6]; 4];
            for (stress, sample) in stresses.iter_mut().zip(samples(mesh, element)) {
                // rr, zz, tt, rz, rt, zt; du is [by z, by r] of each axis.
                let (mut u, mut turned, mut du) = ([0.0; 3], [0.0; 3], [[0.0; 2]; 3]);
                for (shape, &node) in sample.shapes.iter().zip(nodes) {
                    let (value, slope) = (motion.value[node as usize], motion.slope[node as usize]);
                    for axis in 0..3 {
                        u[axis] += shape.value * value[axis];
                        turned[axis] += shape.value * slope[axis];
                        du[axis][0] += shape.slope.x * value[axis];
                        du[axis][1] += shape.slope.y * value[axis];
                    }
                }
                let r = sample.radius;
                let strain = [
                    du[0][1],
                    du[1][0],
                    (u[0] + turned[2]) / r,
                    du[0][0] + du[1][1],
                    turned[0] / r + du[2][1] - u[2] / r,
                    turned[1] / r + du[2][0],
                ];
                let Lame { lambda, mu } = Lame::new(1.0, self.poisson);
                let swell = lambda * (strain[0] + strain[1] + strain[2]);
                *stress = std::array::from_fn(|it| if it < 3 { swell + 2.0 * mu * strain[it] } else { mu * strain[it] });
            }
            for (&node, shares) in nodes.iter().zip(shares_at_nodes(element.corners())) {
                let (sum, count) = &mut sums[node as usize];
                for (stress, share) in stresses.iter().zip(shares) {
                    sum.iter_mut().zip(stress).for_each(|(sum, stress)| *sum += share * stress);
                }
                *count += 1.0;
            }
        }
        sums.into_iter().map(|(sum, count)| von_mises(sum.map(|it| it / count))).collect()
    }

    /// Inserts the stresses that are reported. On the fixed face and under the bolt heads the recovery is not valid; where edges meet in a
    /// corner, the larger of their stresses counts.
    fn recover_surface(&self, mesh: &Mesh, turn: &Turn<'_>, (theta, phase): (f64, f64), von_mises: &mut [f64]) {
        let view = turn.view();
        let mut recovered = vec![None; von_mises.len()];
        for (edge, points) in mesh.surface.iter().zip(points_of_edges(mesh)) {
            for (&node, point) in edge.nodes.iter().zip(points) {
                let held = matches!(edge.face, Face::Bracket | Face::Seat) && view.counted()[point] == 0.0;
                if !held {
                    let stress = turn.von_mises(point, theta, phase);
                    let place: &mut Option<f64> = &mut recovered[node as usize];
                    *place = Some(place.map_or(stress, |other| other.max(stress)));
                }
            }
        }
        for (own, recovered) in von_mises.iter_mut().zip(recovered) {
            *own = recovered.unwrap_or(*own);
        }
    }
}

/// Of the components rr, zz, tt, rz, rt, zt.
fn von_mises([rr, zz, tt, rz, rt, zt]: [f64; 6]) -> f64 {
    let normal = (rr - zz) * (rr - zz) + (zz - tt) * (zz - tt) + (tt - rr) * (tt - rr);
    (0.5 * normal + 3.0 * (rz * rz + rt * rt + zt * zt)).sqrt()
}

/// An angle between 0 and 360 degrees, in degrees.
pub fn degrees(angle: f64) -> f64 {
    let revolutions = angle / (2.0 * PI);
    360.0 * (revolutions - revolutions.floor())
}

#[cfg(test)]
mod tests {
    use super::super::fixtures;
    use super::super::response::View;
    use super::super::turn::{ANGLES, angle};
    use super::*;

    #[test]
    fn the_rim_moves_as_far_as_is_reported() {
        for (kind, dimensions) in fixtures::sections() {
            let fineness = Fineness::USUAL;
            let (mesh, table) = fixtures::solved(kind, &dimensions, &fineness);
            let turn = Turn::new(View::new(&table), fixtures::case(&dimensions));
            let reported = turn.summary(None, [None; 2]).rim_displacement;
            let answers = UnitDisplacements::new(&mesh, &dimensions, 0.29, &fineness);
            let phase = turn.case().phase.unwrap();
            let rim = |step: usize| {
                let motion = answers.motion(&turn, angle(step), phase);
                motion.value[mesh.rim as usize].iter().map(|it| it * it).sum::<f64>().sqrt() / turn.case().modulus
            };
            let largest = (0..ANGLES).map(rim).fold(0.0, f64::max);
            assert!((largest - reported).abs() < 1e-9 * reported, "{kind:?}: {largest} {reported}");
        }
    }

    #[test]
    fn the_surface_shows_what_is_reported_and_the_inside_agrees_with_it() {
        for (kind, dimensions) in fixtures::sections() {
            let fineness = Fineness { harmonics: 8, ..Fineness::FINE };
            let (mesh, table) = fixtures::solved(kind, &dimensions, &fineness);
            let turn = Turn::new(View::new(&table), fixtures::case(&dimensions));
            let largest = turn.summary(None, [None; 2]).largest;
            let answers = UnitDisplacements::new(&mesh, &dimensions, 0.29, &fineness);
            let field = answers.field(&mesh, &turn, largest.theta, largest.phase);
            assert!(field.von_mises.iter().all(|it| it.is_finite()));
            let inside = answers.inside(&mesh, &answers.motion(&turn, largest.theta, largest.phase));
            let mut most: f64 = 0.0;
            for (edge, points) in mesh.surface.iter().zip(points_of_edges(&mesh)) {
                // Middles of sides have one point only.
                let (node, point) = (edge.nodes[1] as usize, points[1]);
                let counted = turn.view().counted()[point] != 0.0;
                let reported = turn.von_mises(point, largest.theta, largest.phase);
                if counted {
                    assert_eq!(field.von_mises[node], reported, "{kind:?}");
                    most = most.max((inside[node] - reported).abs() / largest.stress);
                }
            }
            // Stresses extended from inside are low in tight bends.
            assert!(most < 0.2, "{kind:?}: {most}");
            let there = field.von_mises.iter().any(|it| (it - largest.stress).abs() < 1e-9);
            assert!(there, "{kind:?}: the largest stress is not in the field");
        }
    }
}
