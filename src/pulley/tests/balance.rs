//! Force and moment of the loads on the nodes, against the pull of the belt's strands and the bolts.

use super::{close, cup};
use crate::pulley::fixtures::sections;
use crate::pulley::loads::{EdgePoint, Seat, belt_harmonic, belt_patterns, clamp_pressure};
use crate::pulley::mesh::{Face, Mesh};
use crate::pulley::section::{Dimensions, Fineness, SectionKind, mesh};
use glam::DVec2;
use std::f64::consts::PI;

/// Force (N) and moment about the origin (N mm); the slack end is on the x axis, z is the pulley's axis.
#[derive(Clone, Copy, Debug)]
struct Resultant {
    force: [f64; 3],
    moment: [f64; 3],
}

/// The belt of the reference numbers: 700 N slack, 88 degrees, 3 kW, 3000 rpm, R_b 60 mm, 0.11 kg/m, one groove of 36 degrees.
#[derive(Clone, Copy, Debug)]
struct ReferenceBelt {
    /// Slack and tight tension less the centrifugal part, N.
    pressing: [f64; 2],
    wrap: f64,
    radius: f64,
    half: f64,
    grooves: f64,
    /// Direction of friction, from around the circumference to along the flank, rad.
    direction: f64,
}

impl ReferenceBelt {
    fn new(d: &Dimensions, direction: f64) -> Self {
        let speed = PI * 0.06 * 3000.0 / 30.0;
        let (slack, tight, lost) = (700.0, 700.0 + 3000.0 / speed, 0.11 * speed * speed);
        let wrap = 88f64.to_radians();
        Self { pressing: [slack - lost, tight - lost], wrap, radius: 60.0, half: d.half_angle, grooves: d.groove_count, direction }
    }

    /// mu'.
    fn growth(&self) -> f64 {
        (self.pressing[1] / self.pressing[0]).ln() / self.wrap
    }

    /// Friction along the flank and around the circumference, over the normal force.
    fn friction(&self) -> [f64; 2] {
        let (sine, cosine) = self.direction.sin_cos();
        let total = self.growth() * self.half.sin() / (cosine - self.growth() * sine * self.half.cos());
        [total * sine, total * cosine]
    }

    /// Normal force on a flank per length of the belt at the slack end, N/mm.
    fn normal(&self) -> f64 {
        let line = self.pressing[0] / self.radius;
        line / (2.0 * self.grooves * (self.half.sin() + self.friction()[0] * self.half.cos()))
    }

    /// What nodal loads (r, z and circumference of each node) add up to that grow over the wrap like the belt's. `length` is that of
    /// the band on a flank. Only harmonics 0 and 1 carry a force or a moment.
    fn resultant(&self, mesh: &Mesh, loads: &[f64], length: f64) -> Resultant {
        let amplitude = PI * self.normal() * self.radius / length;
        let (mean, _) = belt_harmonic(self.growth(), self.wrap, 0);
        let (re, im) = belt_harmonic(self.growth(), self.wrap, 1);
        let mut sum = Resultant { force: [0.0; 3], moment: [0.0; 3] };
        for (node, load) in mesh.nodes.iter().zip(loads.as_chunks::<3>().0) {
            let [radial, axial, around] = load.map(|load| amplitude * load);
            // The integrals over the turn with cos theta and with sin theta.
            let x = re * radial + im * around;
            let y = -im * radial + re * around;
            sum.force[0] += x;
            sum.force[1] += y;
            sum.force[2] += 2.0 * mean * axial;
            sum.moment[0] += -im * node.y * axial - node.x * y;
            sum.moment[1] += node.x * x - re * node.y * axial;
            sum.moment[2] += 2.0 * mean * node.y * around;
        }
        sum
    }

    /// What the strands pull with at the groove's middle (mean of several).
    fn strands(&self, middle: f64) -> Resultant {
        let [slack, tight] = self.pressing;
        let (sine, cosine) = self.wrap.sin_cos();
        let force = [-tight * sine, tight * cosine - slack, 0.0];
        Resultant { force, moment: [-middle * force[1], middle * force[0], (tight - slack) * self.radius] }
    }
}

/// The belt's loads with some shares of the normal load and the two frictions.
fn combined(mesh: &Mesh, [normal, along, around]: [f64; 3]) -> Vec<f64> {
    let [n, m, c] = belt_patterns(mesh);
    n.iter().zip(&m).zip(&c).map(|((n, m), c)| normal * n + along * m + around * c).collect()
}

/// Loads of the section's band made of a density at each of its points: (r, z, circumference) by the direction out of the material
/// and the radius.
fn spread(mesh: &Mesh, density: impl Fn(DVec2, f64) -> [f64; 3]) -> Vec<f64> {
    let mut loads = vec![0.0; 3 * mesh.nodes.len()];
    for edge in mesh.surface.iter().filter(|edge| edge.face == Face::Band) {
        for point in EdgePoint::three(mesh.edge(edge)) {
            let density = density(point.out(), point.at.y);
            for (&node, value) in edge.nodes.iter().zip(point.value) {
                for axis in 0..3 {
                    loads[3 * node as usize + axis] += value * point.length * density[axis];
                }
            }
        }
    }
    loads
}

/// Lengths of force in the plane, and the torque: found over expected, less 1.
fn errors(found: &Resultant, expected: &Resultant) -> (f64, f64) {
    let length = |it: &Resultant| it.force[0].hypot(it.force[1]);
    (length(found) / length(expected) - 1.0, found.moment[2] / expected.moment[2] - 1.0)
}

/// z of the middle between all flanks.
fn middle(mesh: &Mesh) -> f64 {
    let (mut moment, mut length) = (0.0, 0.0);
    for point in mesh.surface.iter().filter(|edge| edge.face == Face::Band).flat_map(|edge| EdgePoint::three(mesh.edge(edge))) {
        moment += point.length * point.at.x;
        length += point.length;
    }
    moment / length
}

#[test]
fn the_belts_loads_balance_strands_and_torque_on_every_type() {
    for (kind, d) in sections() {
        let mesh = mesh(kind, &d, &Fineness::USUAL).unwrap();
        for direction in [0.0, 30.0, 45.0] {
            let belt = ReferenceBelt { radius: d.mean_radius, ..ReferenceBelt::new(&d, f64::to_radians(direction)) };
            let [along, around] = belt.friction();
            let found = belt.resultant(&mesh, &combined(&mesh, [1.0, along, around]), d.band_length());
            let expected = belt.strands(middle(&mesh));
            for axis in 0..3 {
                let force = (found.force[axis] - expected.force[axis]).abs();
                let moment = (found.moment[axis] - expected.moment[axis]).abs();
                assert!(force < 1e-9, "{kind:?}, {direction}: force {axis} {found:?} {expected:?}");
                assert!(moment < 1e-7, "{kind:?}, {direction}: moment {axis} {found:?} {expected:?}");
            }
        }
    }
}

#[test]
fn the_example_has_the_reference_resultant() {
    let d = cup(1.8);
    let mesh = mesh(SectionKind::PressedCup, &d, &Fineness::USUAL).unwrap();
    // The groove's middle: z 10 + R_D + R_D cos(beta/2) + half the width.
    close(middle(&mesh), 23.1336, 1e-5, "middle");
    for (direction, normal) in [(45.0, 15.4418), (30.0, 16.448), (0.0, 17.823)] {
        close(ReferenceBelt::new(&d, f64::to_radians(direction)).normal(), normal, 4e-5, "R(0)");
    }
    let belt = ReferenceBelt::new(&d, 45f64.to_radians());
    close(belt.growth(), 0.140_481, 4e-6, "mu'");
    close(belt.friction()[0], 0.050_106, 1e-5, "mu");
    let found = belt.resultant(&mesh, &combined(&mesh, [1.0, belt.friction()[0], belt.friction()[1]]), d.band_length());
    close(found.force[0], -819.572, 1e-6, "x");
    close(found.force[1], -632.296, 1e-6, "y");
    close(found.moment[2], 9549.297, 1e-6, "torque");
    // Axially the flanks press apart.
    let loads = combined(&mesh, [1.0, belt.friction()[0], 0.0]);
    let apart: f64 = loads.as_chunks::<3>().0.iter().map(|load| load[1].abs()).sum();
    let (mean, _) = belt_harmonic(belt.growth(), belt.wrap, 0);
    close(0.5 * apart * 2.0 * PI * mean * belt.normal() * belt.radius / d.band_length(), 1485.9, 5e-5, "axial force on a flank");
}

#[test]
fn the_balance_objects_to_other_conventions() {
    let d = cup(1.8);
    let section = mesh(SectionKind::PressedCup, &d, &Fineness::USUAL).unwrap();
    let belt = ReferenceBelt::new(&d, 45f64.to_radians());
    let [along, around] = belt.friction();
    let expected = belt.strands(middle(&section));
    let error = |loads: &[f64]| errors(&belt.resultant(&section, loads, d.band_length()), &expected);
    let inwards = |out: DVec2| if out.x > 0.0 { DVec2::new(out.y, -out.x) } else { DVec2::new(-out.y, out.x) };
    let density = |out: DVec2, scale: f64| {
        let force = scale * (along * inwards(out) - out);
        [force.y, force.x, scale * around]
    };
    // What the other conventions are made with is what the patterns are made with.
    let same = error(&spread(&section, |out, _| density(out, 1.0)));
    assert!(same.0.abs() < 1e-12 && same.1.abs() < 1e-12, "{same:?}");

    let literal = error(&spread(&section, |out, _| [-out.y - along, -out.x, around]));
    assert!((literal.0 - 0.006_74).abs() < 5e-6 && literal.1.abs() < 1e-12, "friction in the global radial direction: {literal:?}");

    let pressure = error(&spread(&section, |out, radius| density(out, radius / d.mean_radius)));
    assert!(pressure.0.abs() < 1e-12 && (pressure.1 - 0.001_88).abs() < 6e-6, "pressure constant over the flank: {pressure:?}");
    close(pressure.1, 81.0 / (12.0 * 3600.0), 1e-9, "h^2/12R_b^2");

    let outwards = error(&combined(&section, [1.0, -along, around]));
    assert!((outwards.0 + 0.261).abs() < 5e-4 && outwards.1.abs() < 1e-12, "seating friction outwards: {outwards:?}");

    let backwards = belt.resultant(&section, &combined(&section, [1.0, along, -around]), d.band_length());
    let (length, torque) = errors(&backwards, &expected);
    assert!(length.abs() < 1e-12 && (torque + 2.0).abs() < 1e-12, "circumferential friction to the slack end: {backwards:?}");
    assert!((backwards.force[0] - expected.force[0]).hypot(backwards.force[1] - expected.force[1]) > 100.0, "its direction is wrong");

    let circumferential = ReferenceBelt::new(&d, 0.0);
    let loads = combined(&section, [1.0, circumferential.friction()[0], circumferential.friction()[1]]);
    let (length, torque) = errors(&circumferential.resultant(&section, &loads, d.band_length()), &expected);
    assert!(length.abs() < 1e-12 && torque.abs() < 1e-12, "friction around the circumference alone balances too");

    // The same groove with its band 1 mm higher.
    let raised = Dimensions { mean_radius: 61.0, groove_height: 4.0, floor_depth: 8.0, contact_height: 8.0, ..d };
    let higher = mesh(SectionKind::PressedCup, &raised, &Fineness::USUAL).unwrap();
    let found = belt.resultant(&higher, &combined(&higher, [1.0, along, around]), raised.band_length());
    let (length, torque) = errors(&found, &expected);
    assert!(length.abs() < 1e-12 && (torque - 0.016_67).abs() < 5e-6, "band centred 1 mm above: {length} {torque}");
}

#[test]
fn the_clamp_presses_with_the_bolts_force_and_no_moment() {
    for (kind, d) in sections() {
        let mesh = mesh(kind, &d, &Fineness::USUAL).unwrap();
        let seat = Seat::new(&mesh, &d);
        let force = 8333.333;
        let pressure = clamp_pressure(&d, force);
        let sum = |k: usize| {
            let mut sums = [0.0; 3];
            seat.load(&d, k, |place, load| sums[place % 3] += pressure * load);
            sums
        };
        let [radial, axial, around] = sum(0);
        assert_eq!((radial, around), (0.0, 0.0), "heads press along the axis");
        // The edges of the annuli lie inside elements, where their integral is not exact.
        close(2.0 * PI * axial, -4.0 * force, 2e-3, "all bolts together");
        assert_eq!(sum(1), [0.0; 3], "bolts all around have no moment");
    }
    close(clamp_pressure(&cup(1.8), 8333.333), 105.6, 5e-4, "pressure under a head");
}
