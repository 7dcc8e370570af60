//! Which of very many points are drawn.

use std::collections::BTreeSet;

/// Most points that are drawn. More could not be distinguished and would only enlarge the file.
pub(super) const DRAWN_AT_MOST: usize = 5_000;

/// Indices of the points to draw, ascending: all of them, or [`DRAWN_AT_MOST`] that contain the
/// best and worst point of every objective and the one to `keep`, the others evenly spread.
///
/// `points` are rows of as many values as there are objectives.
pub(super) fn thinned(points: &[&[f64]], keep: Option<usize>) -> Vec<usize> {
    if points.len() <= DRAWN_AT_MOST {
        return (0..points.len()).collect();
    }
    let mut kept: BTreeSet<usize> = keep.filter(|&k| k < points.len()).into_iter().collect();
    for objective in 0..points[0].len() {
        let value = |i: usize| points[i][objective];
        let (mut least, mut greatest) = (0, 0);
        for i in 1..points.len() {
            if value(i) < value(least) {
                least = i;
            }
            if value(i) > value(greatest) {
                greatest = i;
            }
        }
        kept.extend([least, greatest]);
    }
    let others: Vec<usize> = (0..points.len()).filter(|i| !kept.contains(i)).collect();
    let wanted = DRAWN_AT_MOST.saturating_sub(kept.len());
    kept.extend((0..wanted).map(|k| others[k * others.len() / wanted]));
    kept.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_points_are_all_drawn() {
        let rows = vec![[1.0, 2.0]; DRAWN_AT_MOST];
        let points: Vec<&[f64]> = rows.iter().map(|r| &r[..]).collect();
        assert_eq!(thinned(&points, None).len(), DRAWN_AT_MOST);
    }

    #[test]
    fn extremes_and_the_kept_point_survive() {
        let value = |i: usize| [(i * 7919 % 100_003) as f64, (i * 104_729 % 100_003) as f64];
        let rows: Vec<[f64; 2]> = (0..100_003).map(value).collect();
        let points: Vec<&[f64]> = rows.iter().map(|r| &r[..]).collect();
        let drawn = thinned(&points, Some(54_321));
        assert_eq!(drawn.len(), DRAWN_AT_MOST);
        assert!(drawn.windows(2).all(|pair| pair[0] < pair[1]));
        assert!(drawn.contains(&54_321));
        for extreme in [0.0, 100_002.0] {
            assert!(drawn.iter().any(|&i| rows[i][0] == extreme));
            assert!(drawn.iter().any(|&i| rows[i][1] == extreme));
        }
        // Evenly spread: every tenth of the rows is drawn about equally often.
        for tenth in 0..10 {
            let inside = drawn.iter().filter(|&&i| i / 10_001 == tenth).count();
            assert!((450..550).contains(&inside));
        }
    }
}
