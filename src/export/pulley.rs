//! The pictures of one pulley: its section, its deformation and stresses, the stresses around it and over its surface.

use crate::models::{Design, Model, Status, evaluate};
use crate::pictures::pulley;
use crate::pulley::around::Around;
use crate::pulley::field::{Field, UnitDisplacements};
use crate::pulley::mesh::Mesh;
use crate::pulley::response::{LONGEST, View, respond};
use crate::pulley::section::mesh;
use crate::pulley::turn::{Peak, Turn};

/// Names of the pictures of a pulley, without `.svg`.
pub use crate::names::KNEE_PICTURES as PICTURES;

/// A short caption for such a picture.
pub fn caption(name: &str) -> &'static str {
    match name {
        "section" => "Section with its dimensions",
        "deformed" => "Von Mises stress on the deformed section, where it is largest",
        "around" => "Stresses at the check points around the turn",
        _ => "Von Mises stress over the unrolled surface",
    }
}

/// The pictures of a pulley, as SVG texts, in the order of [`PICTURES`]; none if the model is another one or the status is not ok.
/// `inputs` are in their units.
pub fn pictures(model: &Model, title: &str, inputs: &[f64]) -> Vec<(&'static str, String)> {
    let draw = |solved: &SolvedPulley<'_>| {
        let SolvedPulley { design: Design { kind, dimensions, yield_strength, .. }, mesh, turn, field, largest } = solved;
        let texts = [
            pulley::section(title, *kind, dimensions, mesh),
            pulley::deformed(title, mesh, turn, field),
            pulley::around(title, &Around::new(turn, largest.phase), Some(*yield_strength)),
            pulley::unrolled(title, mesh, turn, largest),
        ];
        PICTURES.into_iter().zip(texts).collect()
    };
    solve(model, inputs, draw).unwrap_or_default()
}

/// A node of a section at the angle of its largest stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeStress {
    /// Place (z, r) at rest, mm.
    pub place: [f64; 2],
    /// Displacement (z, r), mm.
    pub displacement: [f64; 2],
    /// Von Mises stress, MPa.
    pub von_mises: f64,
}

/// The deformed section at the angle of its largest stress: the picture and the values that it shows, node by node; `None` where
/// [`pictures()`] gives none.
pub fn deformed(model: &Model, title: &str, inputs: &[f64]) -> Option<(String, Vec<NodeStress>)> {
    solve(model, inputs, |SolvedPulley { mesh, turn, field, .. }| {
        let nodes = mesh.nodes.iter().zip(&field.displacement).zip(&field.von_mises);
        let values = nodes.map(|((at, moved), von_mises)| NodeStress {
            place: [at.x, at.y],
            displacement: [moved[1], moved[0]],
            von_mises: *von_mises,
        });
        (pulley::deformed(title, mesh, turn, field), values.collect())
    })
}

/// A pulley with its stresses at the angle of the largest one.
struct SolvedPulley<'t> {
    design: Design,
    mesh: Mesh,
    turn: Turn<'t>,
    field: Field,
    largest: Peak,
}

/// Solves a pulley and calls `look` with it; `None` if the model is another one or the status is not ok.
fn solve<T>(model: &Model, inputs: &[f64], look: impl FnOnce(&SolvedPulley<'_>) -> T) -> Option<T> {
    let design = model.pulley_of(inputs)?;
    let Design { kind, dimensions, poisson, fineness, case, .. } = design;
    let mesh = mesh(kind, &dimensions, &fineness).ok()?;
    if evaluate(model, inputs).status != Status::Ok {
        return None;
    }
    let mut table = vec![0.0; LONGEST];
    respond(&mesh, kind, &dimensions, poisson, &fineness, &mut table);
    let turn = Turn::new(View::new(&table), case);
    let largest = turn.summary(None, [None; 2]).largest;
    let field = UnitDisplacements::new(&mesh, &dimensions, poisson, &fineness).field(&mesh, &turn, largest.theta, largest.phase);
    Some(look(&SolvedPulley { design, mesh, turn, field, largest }))
}
