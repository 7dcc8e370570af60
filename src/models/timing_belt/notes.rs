//! What a person should know of a study or of one evaluation besides its numbers.

use super::super::model::Model;
use super::super::status::{Evaluation, Status};
use super::super::to_si;
use super::{Inputs, OUT, pitch_mass};

/// Part of the pitch by which land, space and radius may be off before somebody is told.
const PITCH_OFF: f64 = 0.05;

/// The similarity law, where it holds.
pub(super) fn remarks(fixed: &[Option<f64>]) -> Vec<String> {
    let law = "without slack tension the boundary tooth depends on pitch_mass * tip_radius * speed^2 / tight_tension alone, for one belt \
               on one pulley";
    if fixed[Inputs::NUMBER.slack_tension] == Some(0.0) { vec![law.to_owned()] } else { Vec::new() }
}

/// Inputs that contradict each other: land and space at the pitch radius are a pitch of the belt.
pub(super) fn doubts(model: &Model, inputs: &[f64]) -> Vec<String> {
    let si = to_si(model, inputs);
    let i = Inputs::read(&si);
    let number = Inputs::NUMBER;
    let angle = 2.0 * (i.land_half_angle + i.space_half_angle);
    let of_pulley = angle * (i.tip_radius + i.pitch_line);
    let off = of_pulley / i.pitch - 1.0;
    if off.abs() <= PITCH_OFF {
        return Vec::new();
    }
    let shown = |input: usize| inputs[input];
    let in_pitch_unit = model.inputs[number.pitch].unit.from_si(of_pulley);
    vec![format!(
        "the pulley does not fit the belt: land and space of {:.4} degrees (land_half_angle_deg {}, space_half_angle_deg {}) at \
         tip_radius_mm {} and pitch_line_mm {} are a pitch of {in_pitch_unit:.4} mm, {:.1} % {} than pitch_mm {}; beyond {:.0} % one of these must be wrong",
        angle.to_degrees(),
        shown(number.land_half_angle),
        shown(number.space_half_angle),
        shown(number.tip_radius),
        shown(number.pitch_line),
        100.0 * off.abs(),
        if off > 0.0 { "more" } else { "less" },
        shown(number.pitch),
        100.0 * PITCH_OFF,
    )]
}

/// What a person should know of one evaluation besides its numbers.
pub(super) fn notes(model: &Model, inputs: &[f64], evaluation: &Evaluation) -> Vec<String> {
    let mut notes = doubts(model, inputs);
    if evaluation.status != Status::Ok {
        return notes;
    }
    if let Some(least) = evaluation.outputs[OUT.least_tooth_load].filter(|load| *load < 0.0) {
        notes.push(format!(
            "a tooth load is negative ({least:.3} N): that tooth is held by its other flank, which the model does not cover"
        ));
    }
    let si = to_si(model, inputs);
    let i = Inputs::read(&si);
    if i.slack_tension == 0.0 {
        let ratio = pitch_mass(&i) * i.tip_radius * i.pulley_speed * i.pulley_speed / i.tight_tension;
        notes.push(format!(
            "without slack tension the boundary depends on pitch_mass * tip_radius * speed^2 / tight_tension alone, here {ratio:.4}"
        ));
    }
    notes
}
