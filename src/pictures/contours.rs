//! Lines of equal value over a map, by marching squares.

/// Most cells along an axis that are used; of a finer map every second, third, ... cell.
const FINEST: usize = 240;
/// Most line pieces: a map that would need more is noise, and lines would only hide it.
const MOST_PIECES: usize = 8_000;

/// A straight piece of a contour, in cells: the middle of the first cell is at (0.5, 0.5).
pub(super) type Segment = [(f64, f64); 2];

/// The pieces of every level, in the order of `levels`; `None` if there would be too many.
///
/// `cells` are `[y][x]` with `columns` cells in a row. No line comes near an absent cell.
pub(super) fn contours(cells: &[Option<f64>], columns: usize, levels: &[f64]) -> Option<Vec<Vec<Segment>>> {
    let rows = cells.len() / columns.max(1);
    let (across, up) = (places(columns), places(rows));
    let mut lines = vec![Vec::new(); levels.len()];
    let mut pieces = 0;
    for ys in up.windows(2) {
        for xs in across.windows(2) {
            let value = |x: usize, y: usize| cells[y * columns + x];
            let square = [
                (value(xs[0], ys[0]), xs[0], ys[0]),
                (value(xs[1], ys[0]), xs[1], ys[0]),
                (value(xs[1], ys[1]), xs[1], ys[1]),
                (value(xs[0], ys[1]), xs[0], ys[1]),
            ];
            let corners = square.map(|(v, x, y)| v.map(|v| (v, x as f64 + 0.5, y as f64 + 0.5)));
            let [Some(a), Some(b), Some(c), Some(d)] = corners else {
                continue;
            };
            for (line, &level) in lines.iter_mut().zip(levels) {
                let before = line.len();
                cross([a, b, c, d], level, line);
                pieces += line.len() - before;
            }
            if pieces > MOST_PIECES {
                return None;
            }
        }
    }
    Some(lines)
}

/// Adds the pieces of one level inside one square; its corners are given in order around it.
fn cross(corners: [(f64, f64, f64); 4], level: f64, line: &mut Vec<Segment>) {
    let edges = (0..4).map(|i| (corners[i], corners[(i + 1) % 4]));
    let crossed: Vec<(f64, f64)> = edges
        .filter(|(a, b)| (a.0 >= level) != (b.0 >= level))
        .map(|(a, b)| {
            let share = (level - a.0) / (b.0 - a.0);
            (a.1 + share * (b.1 - a.1), a.2 + share * (b.2 - a.2))
        })
        .collect();
    match crossed[..] {
        [p, q] => line.push([p, q]),
        // A saddle: the value in the middle decides which corners belong together.
        [p, q, r, s] => {
            let middle = corners.iter().map(|c| c.0 / 4.0).sum::<f64>();
            let first_apart = (middle >= level) != (corners[0].0 >= level);
            // p lies next to corner 0 on the edge that leaves it, s on the edge that returns to it.
            line.extend(match first_apart {
                true => [[s, p], [q, r]],
                false => [[p, q], [r, s]],
            });
        }
        _ => {}
    }
}

/// The cells used along an axis of `count`, first and last included.
fn places(count: usize) -> Vec<usize> {
    let stride = count.div_ceil(FINEST).max(1);
    let mut places: Vec<usize> = (0..count).step_by(stride).collect();
    if count > 0 && places.last() != Some(&(count - 1)) {
        places.push(count - 1);
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_has_one_straight_line() {
        let cells: Vec<Option<f64>> = (0..12).map(|i| Some(f64::from(i % 4))).collect();
        let lines = contours(&cells, 4, &[1.5]).expect("few pieces");
        assert_eq!(lines[0].len(), 2);
        for (x, y) in lines[0].iter().flatten() {
            assert_eq!(*x, 2.0);
            assert!((0.5..=2.5).contains(y));
        }
    }

    #[test]
    fn a_saddle_keeps_the_corners_that_belong_together() {
        let saddle = |high: f64| [Some(high), Some(0.0), Some(high), Some(0.0)];
        // Row by row: the high corners lie on a diagonal.
        let cells = |high| {
            let [a, b, c, d] = saddle(high);
            [a, b, d, c]
        };
        // The middle is high: the low corners are cut off.
        let cut = |high: f64, level: f64| contours(&cells(high), 2, &[level]).expect("few")[0].clone();
        let near = |piece: &Segment, corner: (f64, f64)| {
            let reach = |p: &(f64, f64)| (p.0 - corner.0).abs() + (p.1 - corner.1).abs() < 0.5;
            piece.iter().all(reach)
        };
        let low = cut(4.0, 1.0);
        assert!(low.iter().any(|p| near(p, (1.5, 0.5))) && low.iter().any(|p| near(p, (0.5, 1.5))));
        let high = cut(4.0, 3.0);
        assert!(high.iter().any(|p| near(p, (0.5, 0.5))) && high.iter().any(|p| near(p, (1.5, 1.5))));
    }

    #[test]
    fn lines_stay_away_from_absent_cells_and_noise() {
        let mut cells: Vec<Option<f64>> = (0..9).map(|i| Some(f64::from(i % 3))).collect();
        cells[4] = None;
        assert_eq!(contours(&cells, 3, &[0.5]), Some(vec![Vec::new()]));
        let noise: Vec<Option<f64>> = (0..40_000u64).map(|i| Some((i.wrapping_mul(2_654_435_761) % 1000) as f64)).collect();
        assert_eq!(contours(&noise, 200, &[500.0]), None);
    }
}
