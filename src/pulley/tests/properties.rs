//! Truncation, interpolation and symmetries of whole sections.

use super::{close, cup, every};
use crate::pulley::fixtures::sections;
use crate::pulley::loads::belt_harmonic;
use crate::pulley::response::{BELT, RIM, STRESSES, View, respond};
use crate::pulley::section::{Dimensions, Fineness, SectionKind, mesh};
use crate::pulley::turn::{Case, CaseSummary, Turn};
use std::f64::consts::PI;

/// The answers of a section.
fn table(kind: SectionKind, d: &Dimensions, fineness: &Fineness) -> Vec<f64> {
    let mesh = mesh(kind, d, fineness).unwrap();
    let orders = fineness.harmonics + 1;
    let mut table = vec![0.0; 64 + (2 * mesh.nodes.len() + 64) * (4 + STRESSES * (BELT + 1) * (orders + 1))];
    let length = respond(&mesh, kind, d, super::POISSON, fineness, &mut table);
    table.truncate(length);
    table
}

/// The load case of the reference numbers.
fn case() -> Case {
    Case {
        // R(0) R_b over the band's length.
        normal: 15.4418 * 60.0 * 18f64.to_radians().cos() / 9.0,
        along: 0.050_106,
        around: 0.050_106,
        growth: 0.140_481,
        wrap: 88f64.to_radians(),
        pressure: 105.6,
        phase: Some(44f64.to_radians()),
        spin: 7.85e-9 * (100.0 * PI) * (100.0 * PI),
        modulus: super::MODULUS,
    }
}

fn summary(table: &[f64], case: Case) -> CaseSummary {
    Turn::new(View::new(table), case).summary(None, [None; 2])
}

/// The largest relative difference of largest stress and of check points E and F (and D), against others.
fn differences(found: &CaseSummary, exact: &CaseSummary) -> (f64, f64) {
    let stress = |found: f64, exact: f64| (found / exact - 1.0).abs();
    let points = found.check_points.iter().zip(&exact.check_points).skip(6);
    let worst = points.filter_map(|(a, b)| Some(stress(a.as_ref()?.stress, b.as_ref()?.stress))).fold(0.0, f64::max);
    (stress(found.largest.stress, exact.largest.stress), worst)
}

#[test]
fn harmonics_up_to_24_are_enough() {
    let of = |harmonics: usize| summary(&table(SectionKind::PressedCup, &cup(1.8), &Fineness { harmonics, ..every() }), case());
    let exact = of(48);
    // Groove and largest stress: 0.07 % at most with 24 harmonics, 0.2 with 20, 0.3 with 16, 0.4 with 12, 3.4 with 8.
    for (harmonics, percent) in [(24, 0.08), (16, 0.4), (8, 4.0)] {
        let (largest, groove) = differences(&of(harmonics), &exact);
        assert!(largest.max(groove) < 0.01 * percent, "k <= {harmonics}: {largest} {groove}");
    }
    let (largest, groove) = differences(&of(8), &exact);
    assert!(largest.max(groove) > 0.01, "8 harmonics are too few: {largest} {groove}");
}

#[test]
fn harmonics_between_those_solved_are_interpolated_within_a_thousandth() {
    for (kind, d) in sections() {
        let scaled = Case { normal: case().normal * 0.9, ..case() };
        // A coarse mesh of the solid section: it is the harmonics that count here.
        let (usual, every) = (Fineness { solid: 3.2, ..Fineness::USUAL }, Fineness { solid: 3.2, ..every() });
        let (some, all) = (summary(&table(kind, &d, &usual), scaled), summary(&table(kind, &d, &every), scaled));
        close(some.largest.stress, all.largest.stress, 1e-3, kind.name());
        close(some.rim_displacement, all.rim_displacement, 1e-3, kind.name());
        for (some, all) in some.check_points.iter().zip(&all.check_points) {
            let (Some(some), Some(all)) = (some, all) else {
                assert_eq!(some.is_some(), all.is_some());
                continue;
            };
            assert!((some.stress - all.stress).abs() < 1e-3 * all.stress.max(20.0), "{}: {some:?} {all:?}", kind.name());
        }
    }
}

#[test]
fn a_mirrored_load_has_mirrored_stresses() {
    let table = table(SectionKind::PressedCup, &cup(1.8), &Fineness::USUAL);
    let case = case();
    let end = case.normal * (case.growth * case.wrap).exp();
    let phase = case.phase.map(|phase| (case.wrap - phase).rem_euclid(0.5 * PI));
    let mirrored = Case { normal: end, growth: -case.growth, around: -case.around, phase, ..case };
    let (one, other) = (summary(&table, case), summary(&table, mirrored));
    assert_eq!(one.largest.point, other.largest.point);
    // Angles at which a peak is looked for are not mirrored.
    close(other.largest.stress, one.largest.stress, 5e-5, "largest stress");
    assert!((other.largest.theta - (case.wrap - one.largest.theta)).abs() < 0.02, "{other:?} {one:?}");
    let turn = Turn::new(View::new(&table), case);
    let back = Turn::new(View::new(&table), mirrored);
    for point in (0..View::new(&table).points()).step_by(37) {
        for theta in [0.1, 0.9, 2.5, 4.4, 6.0] {
            let (a, b) = (turn.von_mises(point, theta, 0.2), back.von_mises(point, case.wrap - theta, case.wrap - 0.2));
            assert!((a - b).abs() < 1e-9 * one.largest.stress, "{point}, {theta}: {a} {b}");
        }
    }
}

#[test]
fn the_free_flank_opens() {
    let table = table(SectionKind::PressedCup, &cup(1.8), &Fineness::USUAL);
    let (view, case) = (View::new(&table), case());
    let theta = 48f64.to_radians();
    let rim = view.padded() + RIM;
    let displacement = |axis: usize| {
        let belt = |k: usize| {
            let (re, im) = belt_harmonic(case.growth, case.wrap, k);
            let unit = |load: usize| view.belt(k, load, axis)[rim];
            // X = A G (x1 + i x2), of which Re(X e^(i k theta)).
            let (x1, x2) = (unit(0) + case.along * unit(1), case.around * unit(2));
            let (sine, cosine) = (k as f64 * theta).sin_cos();
            case.normal * ((re * x1 - im * x2) * cosine - (im * x1 + re * x2) * sine)
        };
        let held = |clamp: usize| {
            let angle = (clamp * view.bolts()) as f64 * (theta - case.phase.unwrap_or(0.0));
            case.pressure * view.clamp(clamp, axis)[rim] * angle.cos()
        };
        let sum = (0..view.orders()).map(belt).sum::<f64>() + (0..view.clamps()).map(held).sum::<f64>();
        (sum + case.spin * view.spin(axis)[rim]) / case.modulus
    };
    // u_r -0.0607 mm, u_z +0.1951 mm in the middle of the rim's edge.
    close(displacement(0), -0.0607, 5e-3, "u_r");
    close(displacement(1), 0.1951, 5e-3, "u_z");
}

#[test]
fn the_number_of_bolts_does_not_touch_the_belts_part() {
    let free = Case { pressure: 0.0, spin: 0.0, ..case() };
    let fineness = every();
    let of = |bolts: f64| table(SectionKind::PressedCup, &Dimensions { bolt_count: bolts, ..cup(1.8) }, &fineness);
    let four = of(4.0);
    for bolts in [3.0, 5.0, 6.0] {
        let other = of(bolts);
        assert_eq!(View::new(&other).bolts(), bolts as usize);
        let (a, b) = (summary(&four, free), summary(&other, free));
        close(b.largest.stress, a.largest.stress, 1e-12, "largest stress");
        close(b.rim_displacement, a.rim_displacement, 1e-12, "rim displacement");
    }
}

#[test]
fn a_section_is_meshed_the_same_way_every_time() {
    for (kind, d) in sections() {
        let make = || mesh(kind, &d, &Fineness::USUAL).unwrap();
        assert_eq!(make(), make(), "{}", kind.name());
    }
}
