//! Stresses of the check points around the circumference, with the positions of the wrap and the bolts.

use super::field::degrees;
use super::response::CHECK_POINTS;
use super::turn::Turn;
use std::f64::consts::PI;

/// The stress of one check point around the circumference.
#[derive(Clone, Debug, PartialEq)]
pub struct StressCurve {
    /// Position of the check point in [`CHECK_POINTS`].
    pub number: usize,
    /// Von Mises stress at every degree, both ends of the turn included, MPa.
    pub von_mises: Vec<f64>,
}

impl StressCurve {
    /// Name of the check point.
    pub fn name(&self) -> &'static str {
        CHECK_POINTS[self.number]
    }
}

/// The stresses of all check points that a section has.
#[derive(Clone, Debug, PartialEq)]
pub struct Around {
    /// One curve per check point.
    pub curves: Vec<StressCurve>,
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
            Some(StressCurve { number, von_mises: turn.by_degree(point, phase) })
        };
        let wrap_deg = turn.case().wrap * 180.0 / PI;
        Self { curves: (0..CHECK_POINTS.len()).filter_map(curve).collect(), wrap_deg, bolts_deg: bolts_deg(turn, phase) }
    }
}

/// Angles of the bolts with the first at `phase`, degrees, in ascending order.
pub fn bolts_deg(turn: &Turn<'_>, phase: f64) -> Vec<f64> {
    let bolts = turn.view().bolts();
    let mut angles: Vec<f64> = (0..bolts).map(|bolt| degrees(phase + 2.0 * PI * bolt as f64 / bolts as f64)).collect();
    angles.sort_by(f64::total_cmp);
    angles
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
            let names: Vec<_> = around.curves.iter().map(StressCurve::name).collect();
            for name in CHECK_POINTS {
                assert_eq!(names.contains(&name), mesh.points.iter().any(|point| point.name == name), "{kind:?} {name}");
            }
            for curve in &around.curves {
                let peak = summary.check_points[curve.number].unwrap().stress;
                let most = curve.von_mises.iter().copied().fold(0.0, f64::max);
                assert!(most < 1.001 * peak && most > 0.99 * peak, "{kind:?} {}: {most} {peak}", curve.name());
                assert!((curve.von_mises[0] - curve.von_mises[360]).abs() < 1e-6);
                let point = turn.view().check_point(curve.number).unwrap();
                let exact = turn.von_mises(point, 60.0 * PI / 180.0, summary.largest.phase);
                assert!((curve.von_mises[60] - exact).abs() < 1e-6, "{kind:?} {}", curve.name());
            }
            assert_eq!(around.bolts_deg.iter().map(|it| it.round()).collect::<Vec<_>>(), [44.0, 134.0, 224.0, 314.0]);
        }
    }
}
