//! The outline of a section as closed polygons, for drawing and for finding where it crosses itself.

use super::strip::{Piece, Station};
use glam::DVec2;

/// Closed polygons (z, r) in mm: one per part.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// The parts; the last point is joined to the first.
    pub parts: Vec<Vec<DVec2>>,
}

/// Points on a bend: enough that the chords cannot be told from the arc.
const CHORDS: usize = 12;

impl Outline {
    /// The outline of one strip.
    pub fn of_strip(pieces: &[Piece], thickness: f64) -> Vec<DVec2> {
        let stations: Vec<Station> = pieces
            .iter()
            .flat_map(|piece| {
                let chords = if matches!(piece, Piece::Bend { .. }) { CHORDS } else { 1 };
                (0..=chords).map(move |chord| piece.station(chord as f64 / chords as f64))
            })
            .collect();
        let right = stations.iter().rev().map(|station| station.left + station.through * thickness);
        let mut points: Vec<DVec2> = stations.iter().map(|station| station.left).chain(right).collect();
        points.dedup_by(|a, b| a.distance(*b) < 1e-9);
        points
    }

    /// A place where the outline of a part crosses itself, if there is one.
    pub fn crossing(&self) -> Option<(f64, f64)> {
        self.parts.iter().find_map(|part| crossing(part))
    }
}

/// Twice the area of a triangle, positive if it is counter-clockwise.
fn side(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

fn crossing(points: &[DVec2]) -> Option<(f64, f64)> {
    let count = points.len();
    let line = |i: usize| (points[i], points[(i + 1) % count]);
    for i in 0..count {
        let (a, b) = line(i);
        let (low, high) = (a.min(b), a.max(b));
        for j in i + 2..count {
            if i == 0 && j == count - 1 {
                continue;
            }
            let (c, d) = line(j);
            if c.x.max(d.x) < low.x || c.x.min(d.x) > high.x || c.y.max(d.y) < low.y || c.y.min(d.y) > high.y {
                continue;
            }
            if side(a, b, c) * side(a, b, d) <= 0.0 && side(c, d, a) * side(c, d, b) <= 0.0 {
                return Some((0.5 * (c.x + d.x), 0.5 * (c.y + d.y)));
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bow_tie_crosses_itself_and_a_square_does_not() {
        let points = |places: &[(f64, f64)]| Outline { parts: vec![places.iter().map(|&(z, r)| DVec2::new(z, r)).collect()] };
        assert_eq!(points(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]).crossing(), None);
        assert!(points(&[(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)]).crossing().is_some());
    }
}
