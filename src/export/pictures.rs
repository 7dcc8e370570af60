//! The pictures of a result.

use super::{Certified, Summary};
use crate::pictures::{self, PlotQuantity};
use crate::study::Goal;

/// What is drawn of a front: its designs over the objectives, ideal and knee, and feasible designs behind it.
#[derive(Clone, Debug)]
pub struct FrontPicture {
    title: String,
    objectives: Vec<pictures::PlotObjective>,
    points: Vec<Vec<f64>>,
    knee: Option<usize>,
    ideal: Option<Vec<f64>>,
    behind: Vec<Vec<f64>>,
}

impl FrontPicture {
    /// Of an outcome.
    pub(crate) fn new(outcome: &Certified<'_>) -> Self {
        let study = &outcome.plan.study;
        let objectives = study
            .objectives
            .iter()
            .map(|objective| pictures::PlotObjective {
                quantity: PlotQuantity::new(objective.name(&study.model), study.unit_over(objective.quantity, objective.over)),
                goal: if objective.goal == Goal::Min { pictures::PlotGoal::Min } else { pictures::PlotGoal::Max },
            })
            .collect();
        let summary = Summary::new(outcome);
        Self {
            title: study.title.clone(),
            objectives,
            points: summary.points(),
            knee: summary.knee.as_ref().map(|knee| knee.row),
            ideal: summary.ideal,
            behind: outcome.behind_the_front(),
        }
    }

    /// The picture: the bytes of `front.svg`. `None` where the study has no objectives.
    pub fn svg(&self) -> Option<String> {
        let Self { title, objectives, points, knee, ideal, behind } = self;
        (!objectives.is_empty()).then(|| pictures::front_over(title, objectives, points, *knee, ideal.as_deref(), behind))
    }
}
