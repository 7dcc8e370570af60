//! What people look at of one pulley: its section, deformed and stressed, the stresses around it and over its surface.

use crate::models::{Design, Model, Status, evaluate, pulley_design};
use crate::pictures::pulley;
use crate::pulley::around::Around;
use crate::pulley::field::Answers;
use crate::pulley::response::{LONGEST, View, respond};
use crate::pulley::section::mesh;
use crate::pulley::turn::Turn;

/// Names of the pictures of a pulley, without `.svg`.
pub const PICTURES: [&str; 4] = ["section", "deformed", "around", "surface"];

/// What such a picture shows, in a few words.
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
    let Some(Design { kind, dimensions, poisson, fineness, case, yield_strength, .. }) = pulley_design(model, inputs) else {
        return Vec::new();
    };
    let Ok(mesh) = mesh(kind, &dimensions, &fineness) else { return Vec::new() };
    if evaluate(model, inputs).status != Status::Ok {
        return Vec::new();
    }
    let mut table = vec![0.0; LONGEST];
    respond(&mesh, kind, &dimensions, poisson, &fineness, &mut table);
    let turn = Turn::new(View::new(&table), case);
    let largest = turn.summary(None, [None; 2]).largest;
    let field = Answers::new(&mesh, &dimensions, poisson, &fineness).field(&mesh, &turn, largest.theta, largest.phase);
    let texts = [
        pulley::section(title, kind, &dimensions, &mesh),
        pulley::deformed(title, &mesh, &turn, &field),
        pulley::around(title, &Around::new(&turn, largest.phase), Some(yield_strength)),
        pulley::unrolled(title, &mesh, &turn, &largest),
    ];
    PICTURES.into_iter().zip(texts).collect()
}
