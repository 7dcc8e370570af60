//! The picture of a Pareto front.

use super::axis::Axis;
use super::colours::{BLUE, INK, VERMILION};
use super::header::{Header, Mark, sentence};
use super::panel::axis_label;
use super::range::bounds;
use super::scatter_grid::{Grid, dots};
use super::sheet::Sheet;
use super::staircase::staircase;
use super::thinning::thinned;
use super::{Goal, Objective, number};

/// Draws a Pareto front: for two objectives one scatter with the staircase that bounds what is
/// feasible, for more of them a scatter of every pair.
///
/// `points` are the designs of the front, `[point][objective]`, in the units of the objectives;
/// `knee` is the index of one of them and `ideal` the best value of each objective; both are
/// marked and named. Of more than 5000 points an even selection is drawn, with all extremes and
/// the knee, and the picture says so. No points: the picture says that no design is feasible. One
/// objective has a best value rather than a front; the picture states it.
pub fn front(title: &str, objectives: &[Objective], points: &[Vec<f64>], knee: Option<usize>, ideal: Option<&[f64]>) -> String {
    let complete = |p: &[f64]| p.len() == objectives.len() && p.iter().all(|v| v.is_finite());
    let usable: Vec<usize> = (0..points.len()).filter(|&i| complete(&points[i])).collect();
    let rows: Vec<&[f64]> = usable.iter().map(|&i| &points[i][..]).collect();
    match objectives {
        [] => return sentence(title, "no objective"),
        _ if rows.is_empty() => return sentence(title, "no feasible design"),
        [only] => return sentence(title, &best_value(only, &rows)),
        _ => {}
    }
    let knee = knee.and_then(|k| usable.binary_search(&k).ok());
    let drawn = thinned(&rows, knee);
    let front = Front {
        objectives,
        points: drawn.iter().map(|&i| rows[i]).collect(),
        knee: knee.map(|k| rows[k]),
        ideal: ideal.filter(|p| complete(p)),
    };
    let header = Header::new(title, front.legend(rows.len()));
    let grid = Grid::new(&front, header.height());
    let mut sheet = Sheet::new(grid.bottom);
    let pairs = sheet.draw(|area| {
        header.draw(area)?;
        grid.draw(area, &front)
    });
    for pair in &pairs {
        sheet.insert(&dots(&pair.dots, front.dot_size()));
    }
    sheet.draw(|area| {
        for pair in &pairs {
            if let Some(place) = pair.ideal {
                Mark::Plus(INK).draw(area, place)?;
            }
            if let Some(place) = pair.knee {
                Mark::Diamond(VERMILION).draw(area, place)?;
            }
        }
        Ok(())
    });
    sheet.finish()
}

/// What is drawn, thinned already.
pub(super) struct Front<'a> {
    pub objectives: &'a [Objective],
    pub points: Vec<&'a [f64]>,
    pub knee: Option<&'a [f64]>,
    pub ideal: Option<&'a [f64]>,
}

impl Front<'_> {
    fn legend(&self, total: usize) -> Vec<(Mark, String)> {
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
        legend
    }

    /// Range of one objective, wide enough that no mark touches the frame.
    pub fn bounds(&self, objective: usize) -> (f64, f64) {
        let shown = self.points.iter().chain(&self.ideal);
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

    /// The staircase of the first two objectives.
    pub fn staircase(&self) -> Vec<(f64, f64)> {
        let goals = (self.objectives[0].goal, self.objectives[1].goal);
        staircase(goals, self.points.iter().map(|p| (p[0], p[1])))
    }

    /// Lines of text for the axis of an objective.
    pub fn label(&self, objective: usize, axis: &Axis, room: i32) -> Vec<String> {
        let Objective { quantity, goal } = &self.objectives[objective];
        let mut lines = axis_label(quantity, axis, room);
        lines.push(goal.words().to_owned());
        lines
    }
}

/// One objective: the sentence that states its best value.
fn best_value(objective: &Objective, rows: &[&[f64]]) -> String {
    let values = rows.iter().map(|row| row[0]);
    let (best, word) = match objective.goal {
        Goal::Min => (values.fold(f64::INFINITY, f64::min), "lowest"),
        Goal::Max => (values.fold(f64::NEG_INFINITY, f64::max), "highest"),
    };
    let label = objective.quantity.label();
    format!("{word} {label}: {}", number::significant(best, 6))
}

#[cfg(test)]
mod tests {
    use super::super::Quantity;
    use super::super::sheet::tests::assert_svg;
    use super::*;

    const ALL_GOALS: [Goal; 6] = [Goal::Min, Goal::Max, Goal::Max, Goal::Min, Goal::Max, Goal::Min];

    fn objectives(count: usize) -> Vec<Objective> {
        let objective = |goal| Objective { quantity: Quantity::new("axial_force_N", "N"), goal };
        ALL_GOALS[..count].iter().copied().map(objective).collect()
    }

    fn points(count: u64, objectives: u64) -> Vec<Vec<f64>> {
        let value = |i: u64, j: u64| (i * (7919 + 104_730 * j) % 100_003) as f64;
        let row = |i| (0..objectives).map(|j| value(i, j)).collect();
        (0..count).map(row).collect()
    }

    fn dot_count(svg: &str) -> usize {
        svg.matches("h0").count()
    }

    #[test]
    fn every_number_of_objectives_and_points_gives_a_picture() {
        for n in 0..=7 {
            let objectives = objectives(n.min(6));
            for count in [0, 1, 2, 50] {
                let points = points(count, n as u64);
                let ideal = vec![0.0; n];
                let draw = || front("<T> & \"t\"", &objectives, &points, Some(1), Some(&ideal));
                let svg = draw();
                assert_svg(&svg);
                assert_eq!(svg, draw());
                assert!(svg.contains("&lt;T&gt; &amp; &quot;t&quot;"));
                let none = count == 0 && (1..=6).contains(&n);
                assert_eq!(svg.contains("no feasible design") && n <= 6, none);
            }
        }
    }

    #[test]
    fn equal_tiny_and_huge_points_give_a_picture() {
        for value in [0.0, 1e-12, 1e12, -5.0] {
            for count in [1, 3] {
                let points = vec![vec![value; 3]; count];
                assert_svg(&front("", &objectives(3), &points, Some(0), None));
            }
        }
        let wide = [vec![1e-12, 1e12], vec![1e12, 1e-12]];
        let svg = front("", &objectives(2), &wide, None, None);
        assert_svg(&svg);
        assert_eq!(dot_count(&svg), 2);
    }

    #[test]
    fn endless_names_and_many_objectives_give_a_picture() {
        let mut wide = objectives(6);
        wide[1].quantity = Quantity::new("word_".repeat(200), "x".repeat(200));
        let offset: Vec<Vec<f64>> = (0..9).map(|i| vec![1e6 + 0.01 * f64::from(i); 6]).collect();
        let svg = front(&"title ".repeat(100), &wide, &offset, None, None);
        assert_svg(&svg);
        let many: Vec<Objective> = (0..9).flat_map(|_| objectives(6)).collect();
        assert_svg(&front("", &many, &points(3, 54), None, None));
    }

    #[test]
    fn each_pair_of_objectives_is_drawn_once_with_directions() {
        let svg = front("", &objectives(4), &points(20, 4), Some(3), Some(&[0.0; 4]));
        assert_eq!(dot_count(&svg), 6 * 20);
        assert_eq!(svg.matches("lower is better").count(), 2);
        assert_eq!(svg.matches("higher is better").count(), 4);
        assert!(svg.contains("\nknee\n") && svg.contains("ideal: best of each"));
        let bare = front("", &objectives(4), &points(20, 4), Some(20), None);
        assert!(!bare.contains("knee") && !bare.contains("ideal"));
    }

    #[test]
    fn large_fronts_are_thinned_openly_and_stay_small() {
        let svg = front("", &objectives(6), &points(100_000, 6), Some(77), None);
        assert!(svg.len() < 2_000_000, "{} bytes", svg.len());
        assert!(svg.contains("5 000 of 100 000 points drawn"));
        assert!(svg.contains("front of 100 000 designs"));
        let small = front("", &objectives(2), &points(5_000, 2), None, None);
        assert!(!small.contains("points drawn"));
    }

    #[test]
    fn incomplete_points_do_not_move_the_knee() {
        let objectives = objectives(2);
        let whole = [vec![1.0, 5.0], vec![2.0, 6.0], vec![3.0, 9.0]];
        let holed = [vec![1.0, 5.0], vec![f64::NAN, 1.0], vec![2.0, 6.0], vec![], vec![3.0, 9.0]];
        assert_eq!(front("", &objectives, &whole, Some(1), None), front("", &objectives, &holed, Some(2), None));
    }

    #[test]
    fn one_objective_states_its_best_value() {
        let svg = front("", &objectives(1), &[vec![12_345.0], vec![99.5]], None, None);
        assert!(svg.contains("lowest axial force [N]: 99.5"));
    }
}
