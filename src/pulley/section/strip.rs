//! Sheet sections: a strip of constant thickness that follows a line with rounded corners.
//!
//! The line is the strip's left side, walking with z to the right and r up; the sheet lies on its right. It never moves when the
//! thickness changes, so the face on the bracket and the flanks that the belt touches stay where they are.

use super::Flaw;
use glam::DVec2;

/// A corner of the line before rounding.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// Where the straight pieces would meet.
    pub at: DVec2,
    /// Radius of the left side of the bend, mm.
    pub radius: f64,
    /// Letter of the bend; none for a corner that stays sharp, whose radius is not read.
    pub name: &'static str,
}

/// A piece of the rounded line.
#[derive(Clone, Copy, Debug)]
pub enum Piece {
    /// Straight from one point to another.
    Straight(DVec2, DVec2),
    /// An arc.
    Bend {
        /// Letter of the bend.
        name: &'static str,
        /// Centre of the arc.
        centre: DVec2,
        /// From the centre to the start of the arc.
        arm: DVec2,
        /// Angle that the line turns through, positive counter-clockwise, rad.
        turn: f64,
    },
}

/// A place along the line: the point on the left side and the direction through the sheet.
#[derive(Clone, Copy, Debug)]
pub struct Station {
    /// On the left side.
    pub left: DVec2,
    /// Unit vector from the left side to the right one.
    pub through: DVec2,
}

fn turned(vector: DVec2, angle: f64) -> DVec2 {
    let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
    DVec2::new(cosine * vector.x - sine * vector.y, sine * vector.x + cosine * vector.y)
}

/// Right of a direction.
fn right_of(direction: DVec2) -> DVec2 {
    DVec2::new(direction.y, -direction.x)
}

impl Piece {
    /// Its length on the left side, mm.
    pub fn length(&self) -> f64 {
        match self {
            Self::Straight(from, to) => from.distance(*to),
            Self::Bend { arm, turn, .. } => arm.length() * turn.abs(),
        }
    }

    /// The place at a share of its length.
    pub fn station(&self, share: f64) -> Station {
        match *self {
            Self::Straight(from, to) => Station { left: from + (to - from) * share, through: right_of((to - from).normalize()) },
            Self::Bend { centre, arm, turn, .. } => {
                let arm = turned(arm, turn * share);
                // Turning left, the centre is on the left: away from it is through the sheet.
                Station { left: centre + arm, through: arm.normalize() * turn.signum() }
            }
        }
    }
}

/// The line with its corners rounded, or what is wrong with it first.
///
/// # Errors
/// Bends whose inside radius is not positive, and corners that leave no room between them.
pub fn rounded(start: DVec2, corners: &[Corner], end: DVec2, thickness: f64) -> Result<Vec<Piece>, Flaw> {
    let mut pieces = Vec::with_capacity(2 * corners.len() + 1);
    let mut from = start;
    let mut last: Option<&Corner> = None;
    for (number, corner) in corners.iter().enumerate() {
        let before = if number == 0 { start } else { corners[number - 1].at };
        let after = corners.get(number + 1).map_or(end, |next| next.at);
        let (into, out) = ((corner.at - before).normalize(), (after - corner.at).normalize());
        let turn = libm::atan2(into.perp_dot(out), into.dot(out));
        if corner.name.is_empty() {
            pieces.push(Piece::Straight(from, corner.at));
            (from, last) = (corner.at, None);
            continue;
        }
        let inside = if turn > 0.0 { corner.radius } else { corner.radius - thickness };
        if inside <= 0.0 || inside.is_nan() {
            return Err(Flaw::Bend { name: corner.name, inside });
        }
        let tangent = corner.radius * libm::tan(0.5 * turn.abs());
        let (to, next) = (corner.at - into * tangent, corner.at + out * tangent);
        let room = (to - from).dot(into);
        if room < 0.0 || room.is_nan() {
            return Err(Flaw::Room { before: last.map_or("start", |it| it.name), after: corner.name, room });
        }
        if room > SHORT {
            pieces.push(Piece::Straight(from, to));
        }
        let arm = right_of(into) * corner.radius * turn.signum();
        pieces.push(Piece::Bend { name: corner.name, centre: to - arm, arm, turn });
        (from, last) = (next, Some(corner));
    }
    let into = (end - last.map_or(start, |it| it.at)).normalize();
    let room = (end - from).dot(into);
    if room <= SHORT || room.is_nan() {
        return Err(Flaw::Room { before: last.map_or("start", |it| it.name), after: "end", room });
    }
    pieces.push(Piece::Straight(from, end));
    Ok(pieces)
}

/// Straight pieces shorter than this are left out: bends may follow each other directly. mm
pub const SHORT: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rounded_corner_touches_both_sides_and_keeps_its_radius() {
        let corner = Corner { at: DVec2::new(0.0, 33.0), radius: 5.0, name: "B" };
        let pieces = rounded(DVec2::new(0.0, 10.0), &[corner], DVec2::new(10.0, 39.0), 1.8).unwrap();
        assert_eq!(pieces.len(), 3);
        let (bend, after) = (pieces[1], pieces[2]);
        let Piece::Bend { centre, turn, .. } = bend else { panic!("{bend:?}") };
        assert!(turn < 0.0, "from up to the right is a turn to the right");
        assert!((centre.x - 5.0).abs() < 1e-12, "the centre lies a radius to the right of the web: {centre}");
        for share in [0.0, 0.3, 1.0] {
            let station = bend.station(share);
            assert!((station.left.distance(centre) - 5.0).abs() < 1e-12);
            assert!(((station.left + station.through * 1.8).distance(centre) - 3.2).abs() < 1e-12, "the right side is the inside");
        }
        assert!(bend.station(1.0).left.distance(after.station(0.0).left) < 1e-12);
        assert!((bend.station(1.0).through - after.station(0.0).through).length() < 1e-12, "no kink");
    }

    #[test]
    fn a_bend_tighter_than_the_sheet_and_bends_without_room_are_flaws() {
        let bend = |radius| Corner { at: DVec2::new(0.0, 33.0), radius, name: "B" };
        let (start, end) = (DVec2::new(0.0, 10.0), DVec2::new(10.0, 39.0));
        assert!(matches!(rounded(start, &[bend(1.8)], end, 1.8), Err(Flaw::Bend { name: "B", inside: 0.0 })));
        assert!(matches!(rounded(start, &[bend(60.0)], end, 1.8), Err(Flaw::Room { before: "start", after: "B", .. })));
        let close = Corner { at: DVec2::new(1.0, 33.5), radius: 3.0, name: "C" };
        assert!(matches!(rounded(start, &[bend(5.0), close], end, 1.8), Err(Flaw::Room { before: "B", after: "C", .. })));
    }
}
