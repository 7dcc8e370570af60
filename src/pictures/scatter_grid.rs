//! The panels of a Pareto front and what lies in them.

use super::axis::{Numbers, PlotAxis};
use super::colours::LIGHT_BLUE;
use super::panel::{PanelPlan, x_labels_height, y_labels_width};
use super::scatter_front::DrawnFront;
use super::sheet::{Area, Dash, Drawn, Frame, Point, UNIT, WIDTH, stroked};
use plotters::prelude::*;
use std::fmt::Write;

/// Where the data of one pair of objectives lie on the paper.
pub(super) struct Pair {
    pub dots: Vec<Point>,
    pub sample: Vec<Point>,
    pub knee: Option<Point>,
    pub ideal: Option<Point>,
}

/// The panels of a front: objective `j` across and `i` up for all `j < i`.
pub(super) struct ScatterGrid {
    /// One per objective; the first has no vertical axis, the last no horizontal one.
    across: Vec<PlotAxis>,
    up: Vec<PlotAxis>,
    /// Room that the tick labels of the vertical axes take.
    tick_room: i32,
    panel: Frame,
    gap: i32,
    /// Height of the whole picture.
    pub bottom: i32,
}

impl ScatterGrid {
    pub fn new(front: &DrawnFront<'_>, top: i32) -> Self {
        let columns = front.objectives.len() as i32 - 1;
        let gap = if columns > 3 { 16 * UNIT } else { 24 * UNIT };
        // In a column, labels may meet those of the next column half way.
        let (overhang, numbers) = match columns {
            1 => (20 * UNIT, Numbers::Long),
            2 => (gap / 2 - UNIT, Numbers::Long),
            _ => (gap / 2 - UNIT, Numbers::Short),
        };
        let all = 0..front.objectives.len();
        let height = match columns {
            1 => 480 * UNIT,
            2 => 300 * UNIT,
            3 => 220 * UNIT,
            4 => 170 * UNIT,
            _ => 150 * UNIT,
        };
        let up: Vec<PlotAxis> = all.clone().map(|i| PlotAxis::vertical(front.bounds(i), height, numbers)).collect();
        let labels = |i: usize| front.label(i, &up[i], height);
        let tick_room = up[1..].iter().map(PlotAxis::label_width).max().unwrap_or(0);
        let widths = (1..up.len()).map(|i| y_labels_width(tick_room, &labels(i)));
        let left = 12 * UNIT + widths.max().unwrap_or(0);
        let width = (WIDTH - left - 24 * UNIT - gap * (columns - 1)) / columns;
        let width = width.max(10 * UNIT);
        let across: Vec<PlotAxis> = all.map(|j| PlotAxis::horizontal(front.bounds(j), width, overhang, numbers)).collect();
        let below = (0..across.len() - 1).map(|j| x_labels_height(&front.label(j, &across[j], width))).max();
        let bottom = top + columns * height + (columns - 1) * gap + below.unwrap_or(0);
        let panel = Frame { left, top, width, height };
        Self { across, up, tick_room, panel, gap, bottom: bottom + 14 * UNIT }
    }

    pub fn draw(&self, area: &Area<'_>, front: &DrawnFront<'_>) -> Drawn<Vec<Pair>> {
        let mut pairs = Vec::new();
        for i in 1..self.up.len() {
            for j in 0..i {
                pairs.push(self.draw_pair(area, front, i, j)?);
            }
        }
        Ok(pairs)
    }

    fn draw_pair(&self, area: &Area<'_>, front: &DrawnFront<'_>, i: usize, j: usize) -> Drawn<Pair> {
        let Frame { width, height, .. } = self.panel;
        let frame = Frame {
            left: self.panel.left + j as i32 * (width + self.gap),
            top: self.panel.top + (i as i32 - 1) * (height + self.gap),
            ..self.panel
        };
        let (x, y) = (&self.across[j], &self.up[i]);
        let x_label = (i == self.up.len() - 1).then(|| front.label(j, x, width));
        let y_label = (j == 0).then(|| front.label(i, y, height));
        let panel =
            PanelPlan { frame, x, y, x_label: x_label.as_deref(), y_label: y_label.as_deref(), tick_room: self.tick_room, grid: true };
        let mut panel = panel.draw(area)?;
        if front.objectives.len() == 2 {
            let stroke = LIGHT_BLUE.stroke_width(2 * UNIT as u32);
            panel.draw_series(LineSeries::new(front.staircase(), stroke))?;
        }
        let place = |p: &[f64]| panel.backend_coord(&(p[j], p[i]));
        let places = |points: &[&[f64]]| points.iter().map(|p| place(p)).collect();
        Ok(Pair { dots: places(&front.points), sample: places(&front.sample), knee: front.knee.map(place), ideal: front.ideal.map(place) })
    }
}

/// Many dots as one path: each is a line of no length with a round end, placed relative to the
/// one before. An element each would take ten times the room.
pub(super) fn dots(places: &[Point], colour: RGBColor, size: i32) -> String {
    let mut places = places.to_vec();
    places.sort_unstable();
    places.dedup();
    let mut path = String::new();
    let mut last = (0, 0);
    for (x, y) in places {
        let sign = if y < last.1 { "" } else { " " };
        write!(path, "m{}{sign}{}h0", x - last.0, y - last.1).expect("writing into a string does not fail");
        last = (x, y);
    }
    stroked(&path, colour, size, Dash::Solid)
}

#[cfg(test)]
mod tests {
    use super::super::colours::BLUE;
    use super::*;

    #[test]
    fn dots_are_placed_relative_to_each_other_and_drawn_once() {
        let path = dots(&[(30, 5), (10, 20), (30, 5), (10, 7)], BLUE, 40);
        assert!(path.contains("d=\"m10 7h0m0 13h0m20-15h0\""), "{path}");
    }
}
