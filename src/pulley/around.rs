//! Stresses of the check points around the circumference, as curves and as a table.

use super::field::degrees;
use super::response::CHECK_POINTS;
use super::turn::Turn;
use crate::models::{Profile, ProfileColumn};
use crate::units::{DEGREE, MEGAPASCAL};
use std::f64::consts::PI;

/// Angles of the curves: every degree, both ends of the turn included.
pub const STEPS: usize = 361;

/// The stress of one check point around the circumference.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Position of the check point in [`CHECK_POINTS`].
    pub number: usize,
    /// Von Mises stress at every degree, MPa.
    pub von_mises: Vec<f64>,
}

impl Curve {
    /// Name of the check point.
    pub fn name(&self) -> &'static str {
        CHECK_POINTS[self.number]
    }
}

/// The stresses of all check points that a section has.
#[derive(Clone, Debug, PartialEq)]
pub struct Around {
    /// One curve per check point.
    pub curves: Vec<Curve>,
    /// Wrap angle from the slack end, degrees.
    pub wrap_deg: f64,
    /// Angles of the bolts, degrees.
    pub bolts_deg: Vec<f64>,
}

impl Around {
    /// The stresses under a load case with the first bolt at `phase`, rad.
    pub fn new(turn: &Turn<'_>, phase: f64) -> Self {
        let view = turn.view();
        let curve = |number: usize| {
            let point = view.check_point(number)?;
            let von_mises = (0..STEPS).map(|step| turn.von_mises(point, angle(step), phase)).collect();
            Some(Curve { number, von_mises })
        };
        let wrap_deg = turn.case().wrap * 180.0 / PI;
        Self { curves: (0..CHECK_POINTS.len()).filter_map(curve).collect(), wrap_deg, bolts_deg: bolts_deg(turn, phase) }
    }

    /// The same as a table: the angle, then a column per check point.
    pub fn profile(&self) -> Profile {
        const COLUMNS: [&str; CHECK_POINTS.len()] = [
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
        let column = |curve: &Curve| ProfileColumn::new(COLUMNS[curve.number], MEGAPASCAL).drawn("stress_MPa", curve.name());
        let columns = std::iter::once(ProfileColumn::new("theta_deg", DEGREE)).chain(self.curves.iter().map(column));
        let row = |step: usize| std::iter::once(step as f64).chain(self.curves.iter().map(move |it| it.von_mises[step])).collect();
        Profile { columns: columns.collect(), rows: (0..STEPS).map(row).collect() }
    }
}

/// Angles of the bolts with the first at `phase`, degrees, in ascending order.
pub fn bolts_deg(turn: &Turn<'_>, phase: f64) -> Vec<f64> {
    let bolts = turn.view().bolts();
    let mut angles: Vec<f64> = (0..bolts).map(|bolt| degrees(phase + 2.0 * PI * bolt as f64 / bolts as f64)).collect();
    angles.sort_by(f64::total_cmp);
    angles
}

/// The angle of a step, rad.
fn angle(step: usize) -> f64 {
    2.0 * PI * step as f64 / (STEPS - 1) as f64
}

#[cfg(test)]
mod tests {
    use super::super::fixtures;
    use super::super::response::View;
    use super::super::section::Fineness;
    use super::*;

    #[test]
    fn curves_reach_the_reported_peaks_and_close_over_the_turn() {
        for (kind, dimensions) in fixtures::sections() {
            let (mesh, table) = fixtures::solved(kind, &dimensions, &Fineness::USUAL);
            let turn = Turn::new(View::new(&table), fixtures::case(&dimensions));
            let summary = turn.summary(None, [None; 2]);
            let around = Around::new(&turn, summary.largest.phase);
            let names: Vec<_> = around.curves.iter().map(Curve::name).collect();
            for name in CHECK_POINTS {
                assert_eq!(names.contains(&name), mesh.points.iter().any(|point| point.name == name), "{kind:?} {name}");
            }
            for curve in &around.curves {
                let peak = summary.check_points[curve.number].unwrap().stress;
                let most = curve.von_mises.iter().copied().fold(0.0, f64::max);
                assert!(most <= peak * (1.0 + 1e-9) && most > 0.99 * peak, "{kind:?} {}: {most} {peak}", curve.name());
                assert!((curve.von_mises[0] - curve.von_mises[360]).abs() < 1e-6);
            }
            let profile = around.profile();
            assert_eq!((profile.rows.len(), profile.columns.len()), (361, 1 + names.len()));
            assert_eq!(profile.rows[60][0], 60.0);
            assert_eq!(profile.rows[60][1], around.curves[0].von_mises[60]);
            assert_eq!(profile.columns[1].name, format!("stress_{}_MPa", names[0]));
            assert_eq!(around.bolts_deg.iter().map(|it| it.round()).collect::<Vec<_>>(), [44.0, 134.0, 224.0, 314.0]);
        }
    }
}
