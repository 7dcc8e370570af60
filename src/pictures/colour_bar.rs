//! The colours of a map: the bar that explains them, and the lines along its ticks.

use super::PlotQuantity;
use super::axis::{Numbers, PlotAxis, TICK_TEXT};
use super::colours::{GREY, INK, STEPS, step_of};
use super::contours::{Segment, contours};
use super::panel::{LABEL_TEXT, axis_label};
use super::raster::{NOTHING, image, index_of_step};
use super::sheet::{Area, Dash, Drawn, Frame, UNIT, stroked};
use super::words::{line_height, text, upward_lines};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use std::fmt::Write;

const BAR_WIDTH: i32 = 18 * UNIT;
/// Space between map and colour bar.
const BAR_GAP: i32 = 24 * UNIT;
/// Least number of levels per axis for contours: with fewer, they would be lines between a handful of points.
const FEWEST_FOR_CONTOURS: usize = 8;

/// The colour scale.
pub(super) struct ColourBar {
    low: f64,
    high: f64,
    axis: PlotAxis,
    label: Vec<String>,
}

impl ColourBar {
    /// Scale from the lowest to the highest value, to stand `height` units of paper tall; with whole numbers only.
    pub fn new((low, high): (f64, f64), value: &PlotQuantity, height: i32, whole: bool) -> Self {
        let axis = if whole { PlotAxis::whole((low, high), height) } else { PlotAxis::vertical((low, high), height, Numbers::Long) };
        let label = axis_label(value, &axis, height);
        Self { low, high, axis, label }
    }

    /// Space right of the panel that bar, ticks and label take.
    pub fn room(&self) -> i32 {
        let label = self.label.len() as i32 * line_height(LABEL_TEXT);
        BAR_GAP + BAR_WIDTH + 14 * UNIT + self.axis.label_width() + label
    }

    /// Palette indices of all cells, the top row first.
    pub fn indices(&self, cells: &[Option<f64>], columns: usize) -> Vec<u8> {
        let index = |cell: &Option<f64>| match cell {
            Some(value) => index_of_step(step_of(*value, self.low, self.high)),
            None => NOTHING,
        };
        cells.chunks(columns).rev().flatten().map(index).collect()
    }

    /// Contour lines at the ticks, if the map is fine enough for them.
    pub fn lines(&self, cells: &[Option<f64>], columns: usize, rows: usize) -> Option<Vec<ContourLine>> {
        let inside = |level: &f64| self.low < *level && *level < self.high;
        let levels: Vec<f64> = self.axis.ticks().map(|(at, _)| at).filter(inside).collect();
        if columns.min(rows) < FEWEST_FOR_CONTOURS {
            return None;
        }
        let lines = contours(cells, columns, &levels)?;
        let contour = |(pieces, level): (_, &f64)| ContourLine {
            pieces,
            // Light lines on the dark lower half of the colours, dark lines on the upper half.
            colour: match *level < 0.5 * (self.low + self.high) {
                true => WHITE,
                false => INK,
            },
        };
        let lines: Vec<ContourLine> = lines.into_iter().zip(&levels).map(contour).collect();
        lines.iter().any(|l| !l.pieces.is_empty()).then_some(lines)
    }

    /// The colours as an image beside a map in `frame`, the highest value on top.
    pub fn image(&self, frame: Frame) -> String {
        let steps: Vec<u8> = (0..STEPS).rev().map(index_of_step).collect();
        image(beside(frame), &steps, 1, STEPS)
    }

    /// Outline, ticks and label around that image.
    pub fn draw_ticks(&self, area: &Area<'_>, frame: Frame) -> Drawn {
        let bar = beside(frame);
        let stroke = GREY.stroke_width(UNIT as u32);
        area.draw(&Rectangle::new(bar.corners(), stroke))?;
        let style = text(TICK_TEXT, INK, HPos::Left, VPos::Center);
        for (at, label) in self.axis.ticks() {
            let share = (at - self.low) / (self.high - self.low);
            let y = bar.bottom() - (share * f64::from(bar.height)).round() as i32;
            let ends = [(bar.right(), y), (bar.right() + 4 * UNIT, y)];
            area.draw(&PathElement::new(ends, stroke))?;
            area.draw_text(label, &style, (bar.right() + 8 * UNIT, y))?;
        }
        let left = bar.right() + 14 * UNIT + self.axis.label_width();
        upward_lines(area, &self.label, (left, bar.middle().1), LABEL_TEXT)
    }
}

/// The line of one value through a map.
pub(super) struct ContourLine {
    pieces: Vec<Segment>,
    colour: RGBColor,
}

impl ContourLine {
    /// The line as an SVG element over a map in `frame`.
    pub fn path(&self, frame: Frame, columns: usize, rows: usize) -> String {
        let across = |x: f64| (x / columns as f64 * f64::from(frame.width)).round() as i32;
        let up = |y: f64| (y / rows as f64 * f64::from(frame.height)).round() as i32;
        let mut path = String::new();
        for piece in &self.pieces {
            let [from, to] = piece.map(|(x, y)| (frame.left + across(x), frame.bottom() - up(y)));
            let (dx, dy) = (to.0 - from.0, to.1 - from.1);
            write!(path, "M{} {}l{dx} {dy}", from.0, from.1).expect("writing into a string does not fail");
        }
        stroked(&path, self.colour, UNIT, Dash::Solid)
    }
}

/// Where the bar of a map in `frame` stands.
fn beside(frame: Frame) -> Frame {
    Frame { left: frame.right() + BAR_GAP, width: BAR_WIDTH, ..frame }
}
