//! A Pareto front as it is drawn: its points, their ranges and labels.

use super::axis::PlotAxis;
use super::colours::{BLUE, INK, SAMPLE, VERMILION};
use super::header::Mark;
use super::panel::axis_label;
use super::range::bounds;
use super::staircase::staircase;
use super::{PlotObjective, number};

/// What is drawn, thinned already.
pub(super) struct DrawnFront<'a> {
    pub objectives: &'a [PlotObjective],
    pub points: Vec<&'a [f64]>,
    pub knee: Option<&'a [f64]>,
    pub ideal: Option<&'a [f64]>,
    pub sample: Vec<&'a [f64]>,
}

impl DrawnFront<'_> {
    /// Marks and words of the legend: `total` designs on the front, `sampled` ones in the sample.
    pub fn legend(&self, total: usize, sampled: usize) -> Vec<(Mark, String)> {
        let designs = if total == 1 { "design" } else { "designs" };
        let count = number::count(total as u64);
        let name = format!("front of {count} {designs}");
        let mut legend = vec![(Mark::Dot(BLUE), name)];
        if self.knee.is_some() {
            legend.push((Mark::Diamond(VERMILION), "knee".to_owned()));
        }
        if self.ideal.is_some() {
            let name = "ideal: best of each objective".to_owned();
            legend.push((Mark::Plus(INK), name));
        }
        if self.points.len() < total {
            let some = number::count(self.points.len() as u64);
            legend.push((Mark::None, format!("{some} of {count} points drawn")));
        }
        if !self.sample.is_empty() {
            let (count, some) = (number::count(sampled as u64), number::count(self.sample.len() as u64));
            let drawn = if self.sample.len() < sampled { format!(", {some} drawn") } else { String::new() };
            let designs = if sampled == 1 { "design" } else { "designs" };
            legend.push((Mark::Dot(SAMPLE), format!("sample of {count} feasible {designs}{drawn}")));
        }
        legend
    }

    /// Range of one objective, wide enough that no mark touches the frame.
    pub fn bounds(&self, objective: usize) -> (f64, f64) {
        let shown = self.points.iter().chain(&self.ideal).chain(&self.sample);
        // Marks are as large in small panels.
        let margin = if self.objectives.len() > 3 { 0.09 } else { 0.05 };
        bounds(shown.map(|p| p[objective]), margin).unwrap_or((0.0, 1.0))
    }

    /// Diameter of a dot, in units of paper: large while there are few.
    pub fn dot_size(&self) -> i32 {
        let size = match self.points.len() {
            0..=60 => 70,
            61..=400 => 55,
            401..=1500 => 42,
            _ => 32,
        };
        match self.objectives.len() {
            2 => size,
            3 | 4 => size * 4 / 5,
            _ => size * 3 / 5,
        }
    }

    /// Diameter of a dot of the sample: a cloud, in which single dots matter less.
    pub fn sample_size(&self) -> i32 {
        let size = if self.sample.len() > 1000 { 22 } else { 30 };
        if self.objectives.len() > 4 { size * 3 / 5 } else { size }
    }

    /// The staircase of the first two objectives.
    pub fn staircase(&self) -> Vec<(f64, f64)> {
        let goals = (self.objectives[0].goal, self.objectives[1].goal);
        staircase(goals, self.points.iter().map(|p| (p[0], p[1])))
    }

    /// Lines of text for the axis of an objective.
    pub fn label(&self, objective: usize, axis: &PlotAxis, room: i32) -> Vec<String> {
        let PlotObjective { quantity, goal } = &self.objectives[objective];
        let mut lines = axis_label(quantity, axis, room);
        lines.push(goal.words().to_owned());
        lines
    }
}
