//! Cylinders, discs and rings with exact solutions. Numbers of the cases for a modulus of 206 GPa and a Poisson's ratio of 0.29.

use super::{CellDivision, MODULUS, POISSON, close, grid, node, set, tractions};
use crate::pulley::equations::Equations;
use crate::pulley::loads::spin;
use crate::pulley::mesh::{Face, Mesh};
use crate::pulley::recovery::surface_points;
use crate::pulley::wide::Wide;
use glam::DVec2;

/// A ring of one element along the axis and `count` from radius a to b, whose lengths grow in proportion to the radius.
fn ring(a: f64, b: f64, thickness: f64, count: usize) -> Mesh {
    grid((1, count), CellDivision::Whole, |i, j| DVec2::new(thickness * i as f64, a * (b / a).powf(j as f64 / count as f64)))
}

/// What a ring does halfway along its faces: displacements in mm and stresses in MPa.
struct Answer {
    /// Radial displacement of the inner and the outer face.
    radial: [Wide; 2],
    /// Stress around, less the stress normal to the face, of the inner and the outer face.
    around: [Wide; 2],
}

/// Solves a ring in some harmonics; `normal` is the stress normal to its inner and outer face, MPa.
fn solve(mesh: &Mesh, fixed: impl Fn(&DVec2) -> [bool; 3], orders: &[usize], loads: &[f64], normal: [f64; 2]) -> Answer {
    let mut equations = Equations::new(mesh, POISSON, mesh.nodes.iter().map(fixed).collect());
    set(equations.loads(3)[0], loads);
    let answer = equations.solve(orders);
    let radii = mesh.nodes.iter().map(|node| node.y);
    let ends = [radii.clone().fold(f64::MAX, f64::min), radii.fold(0.0, f64::max)];
    let middle = 0.5 * mesh.nodes.iter().map(|node| node.x).fold(0.0, f64::max);
    let faces = ends.map(|radius| node(mesh, middle, radius));
    let (points, _) = surface_points(mesh);
    let around = |face: usize| {
        let point = points.iter().find(|point| point.node == faces[face]).expect("the surface is all around");
        point.stresses(&answer, 0, POISSON, normal[face])[1]
    };
    Answer { radial: faces.map(|face| Wide(answer.of(face, 0)[0].0.map(|value| value / MODULUS))), around: [around(0), around(1)] }
}

/// Plane strain, no torsion.
fn plane(_: &DVec2) -> [bool; 3] {
    [false, true, true]
}

#[test]
fn a_thick_cylinder_under_pressure_is_lames() {
    let (a, b, pressure) = (10.0, 20.0, 100.0);
    let inside = pressure * (b * b + a * a) / (b * b - a * a);
    close(inside, 166.6667, 1e-6, "inside");
    let outside = 2.0 * pressure * a * a / (b * b - a * a);
    // u_r(a) = (1+nu)/E a p/(b^2-a^2) ((1-2nu) a^2 + b^2)
    let radial = (1.0 + POISSON) / MODULUS * a * pressure / (b * b - a * a) * ((1.0 - 2.0 * POISSON) * a * a + b * b);
    close(radial, 0.009_226_21, 1e-6, "displacement");
    for (count, of_u, of_stress) in [(2, 2e-3, 2e-2), (4, 1e-4, 3e-3), (8, 1e-5, 3e-4), (16, 1e-6, 3e-5)] {
        let mesh = ring(a, b, 1.0, count);
        let loads = tractions(&mesh, |face, _| if face == Face::Bracket { [pressure, 0.0, 0.0] } else { [0.0; 3] });
        let answer = solve(&mesh, plane, &[0], &loads, [-pressure, 0.0]);
        close(answer.radial[0][0], radial, of_u, "displacement inside");
        close(answer.around[0][0] - pressure, inside, of_stress, "stress inside");
        close(answer.around[1][0], outside, of_stress, "stress outside");
    }
}

/// Stress around a rotating annular disc at its inner and outer face, with Poisson's ratio v of plane stress, MPa.
fn rotating(a: f64, b: f64, force: f64, v: f64) -> [f64; 2] {
    [(a, b), (b, a)].map(|(own, other)| 0.25 * force * ((3.0 + v) * other * other + (1.0 - v) * own * own))
}

#[test]
fn a_rotating_disc_is_as_in_plane_strain_and_in_plane_stress() {
    // 7850 kg/m^3 at 1000 rad/s, N/mm^4.
    let (a, b, force) = (10.0, 60.0, 7.85e-9 * 1e6);
    let cases = [
        (true, 1.0, rotating(a, b, force, POISSON / (1.0 - POISSON)), [24.1968, 4.8482]),
        // Half of a thin disc: its middle plane stays where it is, and it is free to become thinner.
        (false, 0.5, rotating(a, b, force, POISSON), [23.383_19, 5.661_81]),
    ];
    for (strain, thickness, exact, golden) in cases {
        close(exact[0], golden[0], 3e-6, "inside");
        close(exact[1], golden[1], 1e-5, "outside");
        for (count, tolerance) in [(8, 1.5e-3), (16, 2e-4)] {
            let mesh = ring(a, b, thickness, count);
            let mut loads = vec![0.0; 3 * mesh.nodes.len()];
            spin(&mesh, |place, load| loads[place] += force * load);
            let answer = solve(&mesh, |node| [false, strain || node.x == 0.0, true], &[0], &loads, [0.0; 2]);
            for (face, radius) in [a, b].into_iter().enumerate() {
                close(answer.around[face][0], exact[face], tolerance, "stress around");
                // Nothing else acts on the faces, along the axis but in plane strain.
                let stretched = exact[face] * radius / MODULUS * if strain { 1.0 - POISSON * POISSON } else { 1.0 };
                close(answer.radial[face][0], stretched, 3e-4, "displacement");
            }
        }
    }
}

/// A ring in plane strain whose outer face is pulled with `s_rr = cos k theta`: radial displacement and stress around of the inner
/// face. The stress function is `(A r^k + B r^-k + C r^(k+2) + D r^(2-k)) cos k theta`, lengths in units of b.
fn michell(a: f64, b: f64, k: f64) -> (f64, f64) {
    let powers = [k, -k, k + 2.0, 2.0 - k];
    let radial = |m: f64, r: f64| (m - k * k) * r.powf(m - 2.0);
    let shear = |m: f64, r: f64| k * (m - 1.0) * r.powf(m - 2.0);
    let inner = a / b;
    let mut rows = [
        (powers.map(|m| radial(m, inner)), 0.0),
        (powers.map(|m| shear(m, inner)), 0.0),
        (powers.map(|m| radial(m, 1.0)), 1.0),
        (powers.map(|m| shear(m, 1.0)), 0.0),
    ];
    for pivot in 0..4 {
        let best = (pivot..4).max_by(|&i, &j| rows[i].0[pivot].abs().total_cmp(&rows[j].0[pivot].abs())).unwrap();
        rows.swap(pivot, best);
        let own = rows[pivot];
        for (number, row) in rows.iter_mut().enumerate().filter(|(number, _)| *number != pivot) {
            let factor = row.0[pivot] / own.0[pivot];
            debug_assert!(number < 4);
            row.0.iter_mut().zip(own.0).for_each(|(value, other)| *value -= factor * other);
            row.1 -= factor * own.1;
        }
    }
    let factors: [f64; 4] = std::array::from_fn(|it| rows[it].1 / rows[it].0[it]);
    // 2 G u_r = (kappa - 1 - k) C r^(k+1) + (kappa - 1 + k) D r^(1-k) - k A r^(k-1) + k B r^(-k-1), kappa = 3 - 4 nu
    let kappa = 3.0 - 4.0 * POISSON;
    let shares = [-k, k, kappa - 1.0 - k, kappa - 1.0 + k];
    let shear_modulus = 0.5 * MODULUS / (1.0 + POISSON);
    let sum = |each: &dyn Fn(usize) -> f64| (0..4).map(|it| factors[it] * each(it)).sum::<f64>();
    let displacement = b * sum(&|it| shares[it] * inner.powf(powers[it] - 1.0)) / (2.0 * shear_modulus);
    (displacement, sum(&|it| powers[it] * (powers[it] - 1.0) * inner.powf(powers[it] - 2.0)))
}

#[test]
fn a_ring_pulled_in_a_harmonic_is_michells() {
    let (a, b, orders) = (58.0, 62.0, [2, 4, 8, 16]);
    let golden = [(1.244_597, -481.034), (0.050_310_55, -96.3755), (2.969_706e-3, -23.0999), (2.082_341e-4, -5.8312)];
    // Of two elements through the ring; those of four are an order of magnitude smaller.
    let errors = [(2e-5, 2e-5), (1.3e-4, 1.3e-4), (5.6e-4, 5.8e-4), (2.04e-3, 2.31e-3)];
    for (count, better) in [(2, 1.0), (4, 0.12)] {
        let mesh = ring(a, b, 1.0, count);
        let loads = tractions(&mesh, |face, _| if face == Face::Band { [1.0, 0.0, 0.0] } else { [0.0; 3] });
        let answer = solve(&mesh, |_| [false, true, false], &orders, &loads, [0.0, 1.0]);
        for (lane, &k) in orders.iter().enumerate() {
            let (displacement, stress) = michell(a, b, k as f64);
            close(displacement, golden[lane].0, 3e-7, "displacement of the stress function");
            close(stress, golden[lane].1, 8e-6, "stress of the stress function");
            let (of_u, of_stress) = errors[lane];
            close(answer.radial[0][lane], displacement, better * 1.3 * of_u, "displacement");
            close(answer.around[0][lane], stress, better * 1.3 * of_stress, "stress");
        }
    }
}

#[test]
fn a_thin_ring_bends_like_a_beam() {
    let (radius, depth, pull) = (60.0f64, 4.0f64, 62.0 / 60.0);
    let mesh = ring(58.0, 62.0, 1.0, 2);
    let loads = tractions(&mesh, |face, _| if face == Face::Band { [1.0, 0.0, 0.0] } else { [0.0; 3] });
    let orders = [2, 4, 8];
    let answer = solve(&mesh, |_| [false, true, false], &orders, &loads, [0.0, 1.0]);
    // A beam knows no shear: it is too stiff, the more the shorter the waves.
    for (lane, tolerance) in [(0, 0.004), (1, 0.015), (2, 0.054)] {
        let stiff = (orders[lane] * orders[lane] - 1) as f64;
        let inertia = depth * depth * depth / 12.0;
        let displacement = pull * radius.powi(4) * (1.0 - POISSON * POISSON) / (MODULUS * inertia * stiff * stiff);
        let mean = 0.5 * (answer.radial[0][lane] + answer.radial[1][lane]);
        close(displacement, mean, tolerance, "displacement");
        assert!(mean > displacement);
        if lane == 0 {
            close(displacement, 1.240_467, 1e-6, "displacement of the beam");
            // Moment q R^2/(k^2-1) = 1240 N, over t^2/6.
            let stress = 6.0 * pull * radius * radius / stiff / (depth * depth);
            close(stress, 465.0, 1e-9, "stress of the beam");
        }
    }
}

#[test]
fn a_long_cylinder_loaded_at_its_edge_is_a_beam_on_elastic_foundation() {
    let (radius, thickness, length) = (50.0, 1.0, 40.0);
    let mesh = grid((40, 1), CellDivision::Whole, |i, j| DVec2::new(length * i as f64 / 40.0, radius - 0.5 + thickness * j as f64));
    // 1 N per mm of the mean circumference, over the end face.
    let loads = tractions(&mesh, |face, point| if face == Face::Seat { [radius / (thickness * point.at.y), 0.0, 0.0] } else { [0.0; 3] });
    let fixed = mesh.nodes.iter().map(|node| [false, node.x == length, true]).collect();
    let mut equations = Equations::new(&mesh, POISSON, fixed);
    set(equations.loads(3)[0], &loads);
    let answer = equations.solve(&[0]);
    let edge = answer.of(node(&mesh, 0.0, radius), 0)[0][0] / MODULUS;
    let stiffness = MODULUS * thickness.powi(3) / (12.0 * (1.0 - POISSON * POISSON));
    let decay = (3.0 * (1.0 - POISSON * POISSON)).powf(0.25) / (radius * thickness).sqrt();
    let shell = 1.0 / (2.0 * decay.powi(3) * stiffness);
    close(shell, 4.419_367e-3, 1e-6, "the shell");
    // The shell's own error is +0.27 %.
    close(edge, 1.0027 * shell, 1e-3, "the edge");
}
