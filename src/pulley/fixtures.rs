//! Sections and a load case that several tests use.

use super::loads::clamp_pressure;
use super::response::{LONGEST, respond};
use super::section::{Dimensions, Fineness, Kind, mesh};
use super::turn::Case;
use crate::pulley::mesh::Mesh;
use std::f64::consts::PI;

/// One section of every type.
pub fn sections() -> [(Kind, Dimensions); 4] {
    let cup = Dimensions {
        thickness: 1.8,
        bore_radius: 10.0,
        mean_radius: 60.0,
        half_angle: 18.0 * PI / 180.0,
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
        ..Dimensions::default()
    };
    let small = Dimensions { mean_radius: 55.5, groove_width: 12.7, groove_height: 4.5, rim_height: 1.0, ..cup };
    let machined = Dimensions {
        thickness: 8.0,
        bore_radius: 12.5,
        floor_depth: 9.5,
        cup_radius: 37.0,
        wall_thickness: 6.0,
        rim_thickness: 5.0,
        lip_thickness: 4.0,
        fillet_radius: 1.5,
        groove_offset: 16.0,
        ..small
    };
    let discs = Dimensions { thickness: 1.6, bore_radius: 15.0, weld_radius: 33.0, ..small };
    let double = Dimensions {
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
        ..small
    };
    [(Kind::Machined, machined), (Kind::WeldedDiscs, discs), (Kind::DoubleGroove, double), (Kind::PressedCup, cup)]
}

/// Belt, bolts and spin on a section; the first bolt at 44 degrees.
pub fn case(dimensions: &Dimensions) -> Case {
    Case {
        normal: 90.0,
        along: 0.05,
        around: 0.05,
        growth: 0.14,
        wrap: 88.0 * PI / 180.0,
        pressure: clamp_pressure(dimensions, 8333.0),
        phase: Some(44.0 * PI / 180.0),
        spin: 7.85e-9 * 314.0 * 314.0,
        modulus: 206_000.0,
    }
}

/// A section's mesh and its answers.
pub fn solved(kind: Kind, dimensions: &Dimensions, fineness: &Fineness) -> (Mesh, Vec<f64>) {
    let mesh = mesh(kind, dimensions, fineness).expect("the section is possible");
    let mut table = vec![0.0; LONGEST];
    let length = respond(&mesh, kind, dimensions, 0.29, fineness, &mut table);
    table.truncate(length);
    (mesh, table)
}
