//! The pictures of a result.

use super::{Certified, Summary};
use crate::pictures::{self, PlotQuantity};
use crate::study::Goal;

/// The front over its objectives, with ideal and knee.
pub fn front(outcome: &Certified<'_>) -> String {
    let study = &outcome.plan.study;
    let objectives: Vec<_> = study
        .objectives
        .iter()
        .map(|objective| pictures::PlotObjective {
            quantity: PlotQuantity::new(objective.name(&study.model), study.unit_over(objective.quantity, objective.over)),
            goal: if objective.goal == Goal::Min { pictures::PlotGoal::Min } else { pictures::PlotGoal::Max },
        })
        .collect();
    let summary = Summary::new(outcome);
    let points = summary.points();
    let (knee, ideal) = (summary.knee.as_ref().map(|knee| knee.row), summary.ideal.as_deref());
    pictures::front_over(&study.title, &objectives, &points, knee, ideal, &outcome.behind_the_front())
}
