//! Tension, load and margin of every tooth: what a person looks at.

use super::super::description::{Profile, ProfileColumn};
use super::super::model::Model;
use super::super::to_si;
use super::{Inputs, OUT, TEETH, centrifugal_tension, mesh};
use crate::real::Real;
use crate::tape::Set;
use crate::units::{NEWTON, NONE};

/// A row per tooth, from the tight side. `inputs` are in their units and must have status ok.
pub fn profile(model: &Model, inputs: &[f64]) -> Profile {
    let si = to_si(model, inputs);
    let i = Inputs::read(&si);
    let outputs = model.kernel.outputs(&model.kernel.prepared(&si), &si, Set::ALL);
    let j = outputs[OUT.boundary_tooth];
    let rows = mesh::RowCoefficients::new(&i);
    let complete = mesh::complete(&rows, &mesh::Elimination::new(&rows));
    let solved = mesh::solve(&rows, i.tight_tension, i.slack_tension, j, i.centrifugal_land_friction, centrifugal_tension(&i));
    let of_both = |value: mesh::Linear<f64>| value.tight * i.tight_tension + value.slack * i.slack_tension;
    let row = |at: usize| {
        let number = at as f64 + 1.0;
        vec![
            number,
            of_both(complete.tension[at]),
            solved.tension[at],
            of_both(complete.load[at]),
            solved.load[at],
            of_both(complete.inward[at]) - outputs[OUT.centrifugal_force],
            if number < j { 0.0 } else { 1.0 },
        ]
    };
    let (complete_mesh, incomplete_mesh) = ("complete mesh", "incomplete mesh");
    Profile {
        columns: vec![
            ProfileColumn::new("tooth", NONE),
            ProfileColumn::new("tension_complete_N", NEWTON).drawn("tension_N", complete_mesh),
            ProfileColumn::new("tension_N", NEWTON).drawn("tension_N", incomplete_mesh),
            ProfileColumn::new("tooth_load_complete_N", NEWTON).drawn("tooth_load_N", complete_mesh),
            ProfileColumn::new("tooth_load_N", NEWTON).drawn("tooth_load_N", incomplete_mesh),
            ProfileColumn::new("margin_N", NEWTON),
            ProfileColumn::new("lifted", NONE).hidden(),
        ],
        rows: (0..i.teeth_in_mesh.iterations(TEETH)).map(row).collect(),
    }
}
