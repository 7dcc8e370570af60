//! What a person should know of a pulley besides its numbers.

use super::super::evaluation::to_si;
use super::super::model::Model;
use super::super::status::{Evaluation, Status};
use super::fields::{Inputs, OUT};
use super::{Design, design};
use crate::pulley::section::{self, Dimensions, SectionKind};

/// Sentences on one evaluation, for inputs in their units.
pub(super) fn notes(model: &Model, inputs: &[f64], evaluation: &Evaluation) -> Vec<String> {
    let si = to_si(model, inputs);
    let (kind, dimensions) = (design::kind(&si), design::dimensions(&si));
    if let Err(flaw) = section::checked_outline(kind, &dimensions) {
        return vec![flaw.to_string()];
    }
    let mut notes = bolts(model, inputs, evaluation);
    if evaluation.status != Status::Ok {
        return notes;
    }
    notes.extend(place(model, &Design::new(&si), evaluation));
    notes.extend(tight_bends(kind, &dimensions));
    let overhang = dimensions.bolt_circle_radius + dimensions.bolt_head_radius - dimensions.bracket_radius;
    if overhang > 0.0 {
        notes.push(format!("the bolt heads overhang the bracket by {} mm: the hub bends there", rounded(overhang)));
    }
    let gamma = si[Inputs::NUMBER.friction_direction].to_degrees();
    if gamma > 0.0 {
        notes.push(format!(
            "friction at {} degrees from the circumference: at 0, which is customary for V-belts, the stress is higher",
            rounded(gamma)
        ));
    }
    notes
}

fn rounded(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}

/// Bolts that are tightened beyond what they or the sheet under their heads bear.
fn bolts(model: &Model, inputs: &[f64], evaluation: &Evaluation) -> Vec<String> {
    let value = |output: usize| evaluation.outputs[output].unwrap_or(0.0);
    let [proof, yielding] =
        [Inputs::NUMBER.bolt_proof_strength, Inputs::NUMBER.yield_strength].map(|input| (&model.inputs[input].name, inputs[input]));
    let mut notes = Vec::new();
    let (pressure, utilisation) = (value(OUT.seat_pressure), value(OUT.bolt_utilisation));
    if pressure > yielding.1 {
        notes.push(format!(
            "the bolt heads press with {} MPa, more than {} {}: the sheet gives way under them; use a larger bolt_head_mm (washers) or a \
             smaller force",
            rounded(pressure.round()),
            yielding.0,
            yielding.1
        ));
    }
    if utilisation > 1.0 {
        notes.push(format!(
            "the bolts are tightened to {} MPa, more than {} {}: they stretch for good; use stronger or thicker bolts or a smaller force",
            rounded((utilisation * proof.1).round()),
            proof.0,
            proof.1
        ));
    }
    notes
}

/// Where the largest stress stands.
fn place(model: &Model, design: &Design, evaluation: &Evaluation) -> Option<String> {
    let value = |output: usize| evaluation.outputs[output];
    let (stress, theta) = (value(OUT.max_stress)?, value(OUT.max_stress_theta)?);
    let points = OUT.bl..=OUT.fr;
    let near = points.filter_map(|output| Some((output, value(output)?))).max_by(|a, b| a.1.total_cmp(&b.1));
    let beside = match near {
        // A check point within a tenth is the same place for a reader.
        Some((output, at)) if at > 0.9 * stress => {
            let name = &model.outputs[output].name;
            format!("near check point {}", name.trim_start_matches("stress_").trim_end_matches("_MPa"))
        }
        _ => "away from the check points".to_owned(),
    };
    let wrap = design.case.wrap.to_degrees();
    let seen = if theta <= wrap {
        format!("under the belt, {} degrees before its tight end", rounded((wrap - theta).round()))
    } else {
        format!("outside the wrap, {} degrees after the belt's tight end", rounded((theta - wrap).round()))
    };
    Some(format!("the largest stress stands {beside}, {seen}"))
}

/// Bends that are tighter than the sheet is thick: pressing thins and hardens them, which the model does not know.
fn tight_bends(kind: SectionKind, d: &Dimensions) -> Option<String> {
    let outer = |radius: f64| radius - d.thickness;
    let bends: &[(&str, f64)] = match kind {
        SectionKind::Machined => &[],
        SectionKind::WeldedDiscs => &[("B", d.hub_bend_radius)],
        SectionKind::DoubleGroove | SectionKind::PressedCup => {
            &[("B", outer(d.hub_bend_radius)), ("C", d.web_bend_radius), ("D", outer(d.fold_radius)), ("E and F", d.floor_bend_radius)]
        }
    };
    let tight: Vec<_> = bends.iter().filter(|(_, inside)| *inside < d.thickness).map(|(name, _)| *name).collect();
    (!tight.is_empty()).then(|| {
        format!(
            "the inside radius of bend {} is below the sheet's thickness of {} mm: forming thins such bends",
            tight.join(", "),
            rounded(d.thickness)
        )
    })
}
