//! Lines over a map: visible on every colour, each with a label if there is room.

use super::colours::INK;
use super::header::Mark;
use super::sheet::{Dash, Drawn, Frame, Point, Sheet, UNIT, stroked};
use super::words::{text, text_width};
use super::{Contours, number};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use std::fmt::Write;

const LINE_WIDTH: i32 = 14;
/// White below a line, which is what is visible on dark colours.
const HALO_WIDTH: i32 = 36;
const LABEL_TEXT: i32 = 11;
const LABEL_HEIGHT: i32 = 14 * UNIT;
/// Side of the blocks in which room for labels is searched.
const BLOCK: i32 = 4 * UNIT;
/// Distance of two places along a line that are tried for its label.
const STEP: f64 = 60.0;
/// Most thresholds that the legend lists.
const MOST_LISTED: usize = 6;

/// Dashes that distinguish the lines of the quantities.
fn dash(number: usize) -> Dash {
    [Dash::Solid, Dash::Dashed, Dash::Dotted][number % 3]
}

/// The legend of the lines: one entry per quantity.
pub(super) fn legend(contours: &[Contours]) -> Vec<(Mark, String)> {
    let entry = |(at, it): (usize, &Contours)| {
        let (name, unit) = (it.quantity.plain_name(), it.quantity.plain_unit());
        let found = it.curves.iter().any(|curve| !curve.lines.is_empty());
        let mut values: Vec<String> = it.curves.iter().map(|curve| number::significant(curve.at, 5)).collect();
        let words = match (found, it.every_change, values.len()) {
            (false, true, _) => format!("{name} changes nowhere here"),
            (true, true, 1) => format!("{name} rises to {}", values[0]),
            (true, true, _) => format!("{name} rises to the number on the line"),
            (..) => {
                if values.len() > MOST_LISTED {
                    values.splice(MOST_LISTED - 1..values.len() - 1, ["…".to_owned()]);
                }
                let nowhere = if found { "" } else { " (nowhere here)" };
                format!("{name} = {} {unit}", values.join(", ")).trim_end().to_owned() + nowhere
            }
        };
        (Mark::Line(INK, dash(at)), words)
    };
    contours.iter().enumerate().map(entry).collect()
}

/// Draws lines and labels over a map in `frame`, whose axes count the levels.
pub(super) fn draw(sheet: &mut Sheet, contours: &[Contours], (x, y): (&[f64], &[f64]), frame: Frame) {
    let place = |&(u, v): &(f64, f64)| {
        let across = position(x, u) / x.len() as f64 * f64::from(frame.width);
        let up = position(y, v) / y.len() as f64 * f64::from(frame.height);
        (frame.left + across.round() as i32, frame.bottom() - up.round() as i32)
    };
    let mut lines: Vec<OverlayLine> = Vec::new();
    for (dash, it) in contours.iter().enumerate().map(|(number, it)| (dash(number), it)) {
        let several = it.curves.iter().filter(|curve| !curve.lines.is_empty()).count() > 1;
        for curve in &it.curves {
            let label = several.then(|| number::significant(curve.at, 5));
            let placed = curve.lines.iter().filter(|line| !line.is_empty()).map(|line| line.iter().map(place).collect());
            lines.extend(placed.map(|points| OverlayLine { points, dash, label: label.clone() }));
        }
    }
    for (width, halo) in [(HALO_WIDTH, true), (LINE_WIDTH, false)] {
        for line in &lines {
            let (colour, dash) = if halo { (WHITE, Dash::Solid) } else { (INK, line.dash) };
            sheet.insert(&stroked(&line.path(), colour, width, dash));
        }
    }
    let labels = labels(&lines, frame);
    for (at, label) in &labels {
        let width = label_width(label);
        let (left, top) = (at.0 - width / 2, at.1 - LABEL_HEIGHT / 2);
        sheet.insert(&format!(
            "<rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{LABEL_HEIGHT}\" rx=\"30\" fill=\"#FFFFFF\" fill-opacity=\"0.85\"/>\n"
        ));
    }
    sheet.draw(|area| {
        let style = text(LABEL_TEXT, INK, HPos::Center, VPos::Center);
        labels.iter().try_for_each(|(at, label)| -> Drawn { area.draw_text(label, &style, *at) })
    });
}

/// The position of a value on an axis that counts levels, with the first level in the middle of the first cell: interpolated between two
/// levels.
fn position(levels: &[f64], value: f64) -> f64 {
    let [first, .., last] = levels else { return 0.5 };
    let falling = first > last;
    let before = |&level: &f64| if falling { level > value } else { level < value };
    let next = levels.partition_point(before).clamp(1, levels.len() - 1);
    let (from, to) = (levels[next - 1], levels[next]);
    next as f64 - 0.5 + ((value - from) / (to - from)).clamp(0.0, 1.0)
}

/// A line on the paper.
struct OverlayLine {
    points: Vec<Point>,
    dash: Dash,
    label: Option<String>,
}

impl OverlayLine {
    fn path(&self) -> String {
        let mut path = String::new();
        let mut last = self.points[0];
        // A line of one vertex is a dot: a line of zero length with round ends.
        write!(path, "M{} {}l0 0", last.0, last.1).expect("writing into a string does not fail");
        for &point in &self.points[1..] {
            if point != last {
                write!(path, "l{} {}", point.0 - last.0, point.1 - last.1).expect("writing into a string does not fail");
            }
            last = point;
        }
        path
    }

    /// Places along the line, at most this far apart.
    fn places(&self, apart: f64) -> Vec<Point> {
        let mut places = vec![self.points[0]];
        for pair in self.points.windows(2) {
            let (dx, dy) = (f64::from(pair[1].0 - pair[0].0), f64::from(pair[1].1 - pair[0].1));
            let steps = ((dx * dx + dy * dy).sqrt() / apart).ceil().max(1.0) as i32;
            for step in 1..=steps {
                let share = f64::from(step) / f64::from(steps);
                places.push((pair[0].0 + (share * dx).round() as i32, pair[0].1 + (share * dy).round() as i32));
            }
        }
        places
    }

    fn length(&self) -> f64 {
        let pieces = self.points.windows(2).map(|pair| {
            let (dx, dy) = (f64::from(pair[1].0 - pair[0].0), f64::from(pair[1].1 - pair[0].1));
            (dx * dx + dy * dy).sqrt()
        });
        pieces.sum()
    }
}

fn label_width(label: &str) -> i32 {
    text_width(label, LABEL_TEXT) + 6 * UNIT
}

/// The labels for which there is room, each on its line, as near to its middle as possible: a label touches no other label or line.
fn labels(lines: &[OverlayLine], frame: Frame) -> Vec<(Point, String)> {
    let mut room = OverlayRoom::new(frame);
    for (owner, line) in lines.iter().enumerate() {
        line.places(f64::from(BLOCK / 2)).into_iter().for_each(|place| room.take(place, owner));
    }
    let mut labels = Vec::new();
    for (owner, line) in lines.iter().enumerate() {
        let Some(label) = &line.label else { continue };
        let (width, places) = (label_width(label), line.places(STEP));
        // A line that its label would hide has no label.
        if line.length() < f64::from(2 * width) {
            continue;
        }
        let middle = places.len() / 2;
        let outwards = (0..=middle).flat_map(|away| [middle - away, middle + away]);
        let free = outwards.filter_map(|at| places.get(at)).find(|&&place| room.is_free(place, width, owner));
        if let Some(&place) = free {
            room.fill(place, width);
            labels.push((place, label.clone()));
        }
    }
    labels
}

/// Which blocks of the map are taken, and by which line.
struct OverlayRoom {
    frame: Frame,
    columns: i32,
    owners: Vec<usize>,
}

/// A block that nothing has touched.
const FREE: usize = usize::MAX;
/// A block of a label, or of several lines.
const SHARED: usize = usize::MAX - 1;

impl OverlayRoom {
    fn new(frame: Frame) -> Self {
        let (columns, rows) = (frame.width / BLOCK + 1, frame.height / BLOCK + 1);
        Self { frame, columns, owners: vec![FREE; (columns * rows) as usize] }
    }

    fn block(&self, (x, y): Point) -> Option<usize> {
        let (x, y) = (x - self.frame.left, y - self.frame.top);
        let inside = (0..=self.frame.width).contains(&x) && (0..=self.frame.height).contains(&y);
        inside.then(|| (y / BLOCK * self.columns + x / BLOCK) as usize)
    }

    fn take(&mut self, place: Point, owner: usize) {
        if let Some(block) = self.block(place) {
            let held = &mut self.owners[block];
            *held = if [FREE, owner].contains(held) { owner } else { SHARED };
        }
    }

    /// The blocks that a label around `place` touches; `None` if it sticks out of the map.
    fn blocks(&self, (x, y): Point, width: i32) -> Option<Vec<usize>> {
        let (left, right) = (x - width / 2, x + width / 2);
        let (top, bottom) = (y - LABEL_HEIGHT / 2, y + LABEL_HEIGHT / 2);
        let ends = [(left - BLOCK, top - BLOCK), (right + BLOCK, bottom + BLOCK)].map(|corner| self.block(corner));
        let [Some(first), Some(last)] = ends else { return None };
        let columns = self.columns as usize;
        let (from, to) = (first % columns, last % columns);
        Some((first / columns..=last / columns).flat_map(|row| (from..=to).map(move |column| row * columns + column)).collect())
    }

    fn is_free(&self, place: Point, width: i32, owner: usize) -> bool {
        let free = |block: &usize| [FREE, owner].contains(&self.owners[*block]);
        self.blocks(place, width).is_some_and(|blocks| blocks.iter().all(free))
    }

    fn fill(&mut self, place: Point, width: i32) {
        for block in self.blocks(place, width).into_iter().flatten() {
            self.owners[block] = SHARED;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Frame = Frame { left: 500, top: 300, width: 6000, height: 4000 };

    fn line(points: &[Point], label: &str) -> OverlayLine {
        OverlayLine { points: points.to_vec(), dash: Dash::Solid, label: Some(label.to_owned()) }
    }

    /// Box of a label: left, top, right, bottom.
    fn corners(((x, y), label): &(Point, String)) -> [i32; 4] {
        let half = label_width(label) / 2;
        [x - half, y - LABEL_HEIGHT / 2, x + half, y + LABEL_HEIGHT / 2]
    }

    #[test]
    fn values_stand_between_their_levels() {
        let levels = [1.0, 2.0, 10.0];
        for (value, expected) in [(1.0, 0.5), (1.5, 1.0), (2.0, 1.5), (6.0, 2.0), (10.0, 2.5), (0.0, 0.5), (11.0, 2.5)] {
            assert_eq!(position(&levels, value), expected, "{value}");
            let falling: Vec<f64> = levels.iter().rev().copied().collect();
            assert_eq!(position(&falling, value), 3.0 - expected, "{value}, falling");
        }
        assert_eq!((position(&[7.0], 7.0), position(&[], 7.0)), (0.5, 0.5));
    }

    #[test]
    fn labels_touch_no_other_label_and_no_other_line() {
        // Lines that come ever closer, and one across them all.
        let mut lines: Vec<OverlayLine> =
            (0..40).map(|n| line(&[(700 + 3 * n * n, 400), (700 + 3 * n * n, 4200)], &n.to_string())).collect();
        lines.push(line(&[(600, 2300), (6400, 2300)], "across"));
        let labels = labels(&lines, FRAME);
        assert!(labels.len() > 8 && labels.len() < 35, "{}: some have room and some have not", labels.len());
        for (at, label) in labels.iter().enumerate() {
            let [left, top, right, bottom] = corners(label);
            assert!(left >= FRAME.left && right <= FRAME.right() && top >= FRAME.top && bottom <= FRAME.bottom());
            for other in &labels[..at] {
                let [l, t, r, b] = corners(other);
                assert!(right < l || r < left || bottom < t || b < top, "{label:?} overlaps {other:?}");
            }
            for line in lines.iter().filter(|line| line.label.as_ref() != Some(&label.1)) {
                let inside = |&(x, y): &Point| (left..=right).contains(&x) && (top..=bottom).contains(&y);
                assert!(!line.places(5.0).iter().any(inside), "{label:?} hides a line");
            }
        }
    }

    #[test]
    fn short_lines_and_crowded_ones_have_no_label() {
        assert_eq!(labels(&[line(&[(1000, 1000), (1200, 1000)], "12")], FRAME), []);
        assert_eq!(labels(&[line(&[(1000, 1000), (3000, 1000)], "12")], FRAME), [((2000, 1000), "12".to_owned())]);
        let crowd: Vec<OverlayLine> = (0..30).map(|n| line(&[(1000, 1000 + 50 * n), (5000, 1000 + 50 * n)], "12")).collect();
        assert_eq!(labels(&crowd, FRAME), []);
    }
}
