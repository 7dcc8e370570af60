//! Stress of every check point around the circumference.

use super::super::description::{Profile, ProfileColumn};
use super::super::evaluation::to_si;
use super::super::model::Model;
use super::{Design, answers};
use crate::pulley::response::CHECK_POINTS;
use crate::pulley::turn::Turn;
use crate::units::{DEGREE, MEGAPASCAL};

/// Outputs with the largest stress of each check point over the turn, in MPa; columns of the profile are named so too.
pub const CHECK_POINT_STRESSES: [&str; CHECK_POINTS.len()] = [
    "stress_Bl_MPa",
    "stress_Br_MPa",
    "stress_Cl_MPa",
    "stress_Cr_MPa",
    "stress_Dl_MPa",
    "stress_Dr_MPa",
    "stress_El_MPa",
    "stress_Er_MPa",
    "stress_Fl_MPa",
    "stress_Fr_MPa",
];

/// Von Mises stress of the check points that the section has, a row a degree from the belt's slack end. If the bolts' angle is open
/// it is the one of the largest stress. `inputs` are in their units and must have status ok.
pub(super) fn profile(model: &Model, inputs: &[f64]) -> Profile {
    let si = to_si(model, inputs);
    let prepared = model.kernel.prepared(&si);
    let design = Design::new(&si);
    let Some(view) = answers(&prepared) else {
        return Profile { columns: vec![ProfileColumn::new("theta_deg", DEGREE)], rows: Vec::new() };
    };
    let turn = Turn::new(view, design.case);
    let phase = design.case.phase.unwrap_or_else(|| turn.summary(None, [None; 2]).largest.phase);
    let mut columns = vec![ProfileColumn::new("theta_deg", DEGREE)];
    let mut rows: Vec<Vec<f64>> = (0..=360).map(|degree| vec![f64::from(degree)]).collect();
    for (number, name) in CHECK_POINT_STRESSES.into_iter().enumerate() {
        if let Some(point) = view.check_point(number) {
            columns.push(ProfileColumn::new(name, MEGAPASCAL).drawn("von Mises stress", CHECK_POINTS[number]));
            for (row, stress) in rows.iter_mut().zip(turn.by_degree(point, phase)) {
                row.push(stress);
            }
        }
    }
    Profile { columns, rows }
}
