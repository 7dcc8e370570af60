//! The boundary of the values that a front of two objectives reaches.

use super::PlotGoal;

/// Corners of the staircase through the best of the `points`, from the best first objective to the
/// best second one: beyond it, no design is feasible. Dominated points do not matter.
pub(super) fn staircase(goals: (PlotGoal, PlotGoal), points: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut order: Vec<(f64, f64)> = points.collect();
    order.sort_by(|a, b| goals.0.better_first(a.0, b.0).then(goals.1.better_first(a.1, b.1)));
    let mut corners: Vec<(f64, f64)> = Vec::new();
    for (x, y) in order {
        match corners.last() {
            Some(&(_, reached)) if goals.1.better_first(y, reached).is_ge() => continue,
            Some(&(_, reached)) => corners.extend([(x, reached), (x, y)]),
            None => corners.push((x, y)),
        }
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_staircase_bounds_what_the_points_reach() {
        let points = [(1.0, 5.0), (3.0, 2.0), (2.0, 4.0), (2.5, 9.0), (1.0, 7.0)];
        let corners = |first, second| staircase((first, second), points.into_iter());
        let falling = [(1.0, 5.0), (2.0, 5.0), (2.0, 4.0), (3.0, 4.0), (3.0, 2.0)];
        assert_eq!(corners(PlotGoal::Min, PlotGoal::Min), falling);
        let rising = [(3.0, 2.0), (2.5, 2.0), (2.5, 9.0)];
        assert_eq!(corners(PlotGoal::Max, PlotGoal::Max), rising);
        assert_eq!(corners(PlotGoal::Max, PlotGoal::Min), [(3.0, 2.0)]);
        let mixed = [(1.0, 7.0), (2.5, 7.0), (2.5, 9.0)];
        assert_eq!(corners(PlotGoal::Min, PlotGoal::Max), mixed);
        assert!(staircase((PlotGoal::Min, PlotGoal::Min), std::iter::empty()).is_empty());
    }
}
