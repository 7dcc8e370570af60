//! The picture of a Pareto front.

use super::colours::{BLUE, INK, SAMPLE, VERMILION};
use super::header::{Header, Mark, sentence};
use super::scatter_front::DrawnFront;
use super::scatter_grid::{ScatterGrid, dots};
use super::sheet::Sheet;
use super::thinning::{DRAWN_AT_MOST, thinned};
use super::{PlotGoal, PlotObjective, number};

/// Draws a Pareto front: for two objectives one scatter plot with the staircase that bounds what is feasible, for more of them a scatter
/// plot of every pair.
///
/// `points` are the designs of the front, `[point][objective]`, in the units of the objectives;
/// `knee` is the index of one of them and `ideal` the best value of each objective; both are
/// marked and named. Of more than 5000 points an even selection is drawn, with all extremes and
/// the knee, and the picture says so. No points: the picture says that no design is feasible. One
/// objective has a best value rather than a front; the picture states it.
pub fn front(title: &str, objectives: &[PlotObjective], points: &[Vec<f64>], knee: Option<usize>, ideal: Option<&[f64]>) -> String {
    front_over(title, objectives, points, knee, ideal, &[])
}

/// The same over a `sample` of the feasible designs, `[design][objective]`: light dots behind the front. Of more than 5000 an even
/// selection is drawn, and the picture says so.
pub fn front_over(
    title: &str,
    objectives: &[PlotObjective],
    points: &[Vec<f64>],
    knee: Option<usize>,
    ideal: Option<&[f64]>,
    sample: &[Vec<f64>],
) -> String {
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
    let front = DrawnFront {
        objectives,
        points: drawn.iter().map(|&i| rows[i]).collect(),
        knee: knee.map(|k| rows[k]),
        ideal: ideal.filter(|p| complete(p)),
        sample: evenly(sample.iter().map(Vec::as_slice).filter(|p| complete(p)).collect()),
    };
    let header = Header::new(title, front.legend(rows.len(), sample.len()));
    let grid = ScatterGrid::new(&front, header.height());
    let mut sheet = Sheet::new(grid.bottom);
    let pairs = sheet.draw(|area| {
        header.draw(area)?;
        grid.draw(area, &front)
    });
    for pair in &pairs {
        if !pair.sample.is_empty() {
            sheet.insert(&dots(&pair.sample, SAMPLE, front.sample_size()));
        }
        sheet.insert(&dots(&pair.dots, BLUE, front.dot_size()));
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

/// The designs that are drawn, evenly along the list.
fn evenly(points: Vec<&[f64]>) -> Vec<&[f64]> {
    let drawn = points.len().min(DRAWN_AT_MOST);
    (0..drawn).map(|k| points[k * points.len() / drawn]).collect()
}

/// One objective: the sentence that states its best value.
fn best_value(objective: &PlotObjective, rows: &[&[f64]]) -> String {
    let values = rows.iter().map(|row| row[0]);
    let (best, word) = match objective.goal {
        PlotGoal::Min => (values.fold(f64::INFINITY, f64::min), "lowest"),
        PlotGoal::Max => (values.fold(f64::NEG_INFINITY, f64::max), "highest"),
    };
    let label = objective.quantity.label();
    format!("{word} {label}: {}", number::significant(best, 6))
}

#[cfg(test)]
mod tests {
    use super::super::PlotQuantity;
    use super::super::sheet::tests::assert_svg;
    use super::*;

    const ALL_GOALS: [PlotGoal; 6] = [PlotGoal::Min, PlotGoal::Max, PlotGoal::Max, PlotGoal::Min, PlotGoal::Max, PlotGoal::Min];

    fn objectives(count: usize) -> Vec<PlotObjective> {
        let objective = |goal| PlotObjective { quantity: PlotQuantity::new("axial_force_N", "N"), goal };
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
        wide[1].quantity = PlotQuantity::new("word_".repeat(200), "x".repeat(200));
        let offset: Vec<Vec<f64>> = (0..9).map(|i| vec![1e6 + 0.01 * f64::from(i); 6]).collect();
        let svg = front(&"title ".repeat(100), &wide, &offset, None, None);
        assert_svg(&svg);
        let many: Vec<PlotObjective> = (0..9).flat_map(|_| objectives(6)).collect();
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
    fn a_sample_lies_behind_the_front_and_is_named() {
        let sample = points(7_001, 3);
        let over = |sample: &[Vec<f64>]| front_over("", &objectives(3), &points(20, 3), None, None, sample);
        let svg = over(&sample);
        assert_svg(&svg);
        // Dots in the same place are drawn once.
        assert!(dot_count(&svg) > 10_000 && svg.contains("sample of 7 001 feasible designs, 5 000 drawn"));
        let first = |colour: &str| svg.find(colour).unwrap_or_else(|| panic!("{colour} is not drawn"));
        assert!(svg.rfind("stroke=\"#BEBEBE\"") < svg.rfind("stroke=\"#0072B2\"") && first("#BEBEBE") > 0);
        assert!(over(&sample[..1]).contains("sample of 1 feasible design\n"));
        assert_eq!(over(&[]), front("", &objectives(3), &points(20, 3), None, None));
        // A design far away is within the frame.
        assert_ne!(over(&[vec![9e6; 3]]), over(&[vec![5e4; 3]]));
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
