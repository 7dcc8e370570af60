//! The Fourier coefficients of the loads against sums over the circumference.

use super::cup;
use crate::pulley::loads::{belt_harmonic, clamp_harmonic};
use crate::pulley::section::Dimensions;
use std::f64::consts::PI;

#[test]
fn the_belts_coefficients_are_those_of_its_load() {
    let steps = 12_000;
    for (growth, wrap) in [(0.140_481, 88f64.to_radians()), (0.0, 88f64.to_radians()), (0.9, 4.0), (1e-9, 2.0 * PI), (-0.3, 1.0)] {
        // Simpson's rule; sums of exp(growth theta) cos k theta and sin k theta by turning a pointer from step to step.
        let width = wrap / f64::from(steps);
        let weights: Vec<(f64, f64)> = (0..=steps)
            .map(|step| {
                let inner = if step % 2 == 1 { 4.0 } else { 2.0 };
                let weight = if step == 0 || step == steps { 1.0 } else { inner };
                let theta = width * f64::from(step);
                (theta, weight * width / 3.0 * (growth * theta).exp())
            })
            .collect();
        for k in 0..=60 {
            let sum = |wave: fn(f64) -> f64| weights.iter().map(|(theta, weight)| weight * wave(k as f64 * theta)).sum::<f64>();
            let scale = if k == 0 { 0.5 / PI } else { 1.0 / PI };
            // g = sum Re(G e^(ik theta)): cosines by the real part, sines by minus the imaginary one.
            let expected = (scale * sum(f64::cos), -scale * sum(f64::sin));
            let found = belt_harmonic(growth, wrap, k);
            let error = (found.0 - expected.0).hypot(found.1 - expected.1);
            assert!(error < 2e-8, "growth {growth}, wrap {wrap}, k {k}: {found:?} {expected:?}");
        }
    }
}

#[test]
fn the_clamps_coefficients_are_those_of_annuli_under_the_heads() {
    let steps = 60_000;
    for bolts in [4.0, 3.0] {
        let d = Dimensions { bolt_count: bolts, ..cup(1.8) };
        for radius in [17.5, 20.0, 22.5, 28.0] {
            let under = |theta: f64| {
                (0..d.bolt_count as usize).any(|bolt| {
                    let apart = theta - 2.0 * PI * bolt as f64 / d.bolt_count;
                    let square = radius * radius + d.bolt_circle_radius.powi(2) - 2.0 * radius * d.bolt_circle_radius * apart.cos();
                    (d.bolt_hole_radius.powi(2)..d.bolt_head_radius.powi(2)).contains(&square)
                })
            };
            let pressed: Vec<f64> =
                (0..steps).map(|step| 2.0 * PI * (f64::from(step) + 0.5) / f64::from(steps)).filter(|&theta| under(theta)).collect();
            for k in 0..=40 {
                let scale = if k == 0 { 1.0 } else { 2.0 } / f64::from(steps);
                let expected = scale * pressed.iter().map(|theta| (k as f64 * theta).cos()).sum::<f64>();
                let found = clamp_harmonic(&d, radius, k);
                assert!((found - expected).abs() < 2e-4, "{bolts} bolts, r {radius}, k {k}: {found} {expected}");
            }
        }
    }
}
