//! Example pulleys of the four section types, as jobs for CalculiX.

use beltspace::pulley::calculix::Job;
use beltspace::pulley::loads::clamp_pressure;
use beltspace::pulley::section::{Dimensions, Fineness, Kind};
use beltspace::pulley::turn::Case;
use std::f64::consts::PI;

/// The example of the source: a cup of 1.8 mm.
pub fn cup() -> Dimensions {
    Dimensions {
        thickness: 1.8,
        bore_radius: 10.0,
        mean_radius: 60.0,
        half_angle: 18f64.to_radians(),
        groove_count: 1.0,
        groove_width: 13.0,
        groove_height: 5.0,
        floor_depth: 7.0,
        rim_height: 1.5,
        contact_height: 9.0,
        floor_bend_radius: 1.5,
        hub_bend_radius: 5.0,
        web_bend_radius: 3.0,
        fold_radius: 3.4,
        cup_radius: 33.0,
        wall_radius: 39.0,
        wall_offset: 10.0,
        bracket_radius: 27.5,
        bolt_count: 4.0,
        bolt_circle_radius: 22.5,
        bolt_head_radius: 6.0,
        bolt_hole_radius: 3.3,
        ..Default::default()
    }
}

/// What types 1 to 3 share.
fn wide() -> Dimensions {
    Dimensions { mean_radius: 55.5, groove_width: 12.7, groove_height: 4.5, rim_height: 1.0, ..cup() }
}

pub fn machined() -> Dimensions {
    Dimensions {
        thickness: 8.0,
        bore_radius: 12.5,
        floor_depth: 9.5,
        cup_radius: 37.0,
        wall_thickness: 6.0,
        rim_thickness: 5.0,
        lip_thickness: 4.0,
        fillet_radius: 1.5,
        groove_offset: 16.0,
        ..wide()
    }
}

pub fn discs() -> Dimensions {
    Dimensions { thickness: 1.6, bore_radius: 15.0, weld_radius: 33.0, ..wide() }
}

pub fn double() -> Dimensions {
    Dimensions {
        thickness: 2.3,
        bore_radius: 15.0,
        groove_count: 2.0,
        floor_depth: 8.5,
        rim_height: 2.5,
        cup_radius: 31.7,
        wall_radius: 35.7,
        wall_offset: 8.0,
        hub_bend_radius: 4.5,
        ridge_width: 6.0,
        ..wide()
    }
}

/// Of steel, t/mm^3.
const DENSITY: f64 = 7.85e-9;

/// 3 kW at 3000 rpm, 700 N of slack tension, 88 degrees of wrap, friction at 45 degrees, a belt of 0.11 kg/m, 8333 N on each bolt.
pub fn job(kind: Kind, dimensions: Dimensions, fineness: Fineness, sectors: usize) -> Job {
    let d = &dimensions;
    let omega = 3000.0 * PI / 30.0;
    let speed = d.mean_radius / 1000.0 * omega;
    let (slack, own, pull) = (700.0, 0.11 * speed * speed, 3000.0 / speed);
    let wrap = 88f64.to_radians();
    let growth = ((slack - own + pull) / (slack - own)).ln() / wrap;
    let (sine, cosine) = d.half_angle.sin_cos();
    let direction = 45f64.to_radians();
    let friction = growth * sine / (direction.cos() - growth * direction.sin() * cosine);
    let (along, around) = (friction * direction.sin(), friction * direction.cos());
    let normal = (slack - own) / (2.0 * d.groove_count * (sine + along * cosine)) / d.band_length();
    let pressure = clamp_pressure(d, 100_000.0 / 12.0);
    let phase = Some(44f64.to_radians());
    let case = Case { normal, along, around, growth, wrap, pressure, phase, spin: DENSITY * omega * omega, modulus: 206_000.0 };
    Job { kind, dimensions, fineness, case, poisson: 0.29, density: DENSITY, sectors }
}
