//! Sections and a load case that several tests use.

use super::loads::clamp_pressure;
use super::response::{LONGEST, respond};
use super::section::{Dimensions, Fineness, SectionKind, mesh};
use super::turn::Case;
use crate::models::find;
use crate::pulley::mesh::Mesh;
use std::f64::consts::PI;

/// One section of every type: the model's presets.
pub fn sections() -> [(SectionKind, Dimensions); 4] {
    let model = find("pulley").expect("there is such a model");
    SectionKind::ALL.map(|kind| {
        let inputs = model.preset(kind.name()).expect("every type has a preset");
        (kind, model.pulley_of(&inputs).expect("it is a pulley").dimensions)
    })
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
pub fn solved(kind: SectionKind, dimensions: &Dimensions, fineness: &Fineness) -> (Mesh, Vec<f64>) {
    let mesh = mesh(kind, dimensions, fineness).expect("the section is possible");
    let mut table = vec![0.0; LONGEST];
    let length = respond(&mesh, kind, dimensions, 0.29, fineness, &mut table);
    table.truncate(length);
    (mesh, table)
}
