//! A panel: grid, frame, ticks and axis labels around a rectangle in which data are drawn.

use super::PlotQuantity;
use super::axis::{PlotAxis, TICK_TEXT};
use super::colours::{GREY, GRID, INK};
use super::sheet::{Area, Drawn, Frame, UNIT};
use super::words::{centred_lines, line_height, text, upward_lines, wrap};
use plotters::coord::cartesian::Cartesian2d;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// Height of axis labels, in pixels.
pub(super) const LABEL_TEXT: i32 = 13;
const TICK: i32 = 4 * UNIT;

pub(super) type Panel<'a> = ChartContext<'a, SVGBackend<'a>, Cartesian2d<PlotAxis, PlotAxis>>;

/// A frame with two axes, before it is drawn.
pub(super) struct PanelPlan<'a> {
    pub frame: Frame,
    pub x: &'a PlotAxis,
    pub y: &'a PlotAxis,
    /// Lines of text below the horizontal axis; `None`: no tick labels either.
    pub x_label: Option<&'a [String]>,
    /// Lines of text left of the vertical axis; `None`: no tick labels either.
    pub y_label: Option<&'a [String]>,
    /// Room for the tick labels of the vertical axis, common to panels below each other.
    pub tick_room: i32,
    pub grid: bool,
}

impl PanelPlan<'_> {
    /// Draws the panel and gives what data can be drawn with.
    pub fn draw<'b>(&self, area: &Area<'b>) -> Drawn<Panel<'b>> {
        let frame = self.frame;
        let (left, bottom) = (3 * TICK + self.y.label_width(), 3 * TICK + TICK_TEXT * UNIT);
        let corner = (frame.left - left, frame.top);
        let size = (frame.width + left, frame.height + bottom);
        let mut panel = ChartBuilder::on(&area.clone().shrink(corner, size))
            .x_label_area_size(bottom)
            .y_label_area_size(left)
            .build_cartesian_2d(self.x.clone(), self.y.clone())?;
        let mut mesh = panel.configure_mesh();
        mesh.bold_line_style(GRID.stroke_width(UNIT as u32))
            .axis_style(GREY.stroke_width(UNIT as u32))
            .label_style(text(TICK_TEXT, INK, HPos::Center, VPos::Center))
            .set_all_tick_mark_size(TICK);
        if !self.grid {
            mesh.disable_mesh();
        }
        if self.x_label.is_none() {
            mesh.disable_x_axis();
        }
        if self.y_label.is_none() {
            mesh.disable_y_axis();
        }
        mesh.draw()?;
        self.draw_frame(area)?;
        if let Some(lines) = self.x_label {
            let top = frame.bottom() + x_labels_height(&[]) + 3 * UNIT;
            centred_lines(area, lines, (frame.middle().0, top), LABEL_TEXT)?;
        }
        if let Some(lines) = self.y_label {
            let place = frame.left - y_labels_width(self.tick_room, lines);
            upward_lines(area, lines, (place, frame.middle().1), LABEL_TEXT)?;
        }
        Ok(panel)
    }

    fn draw_frame(&self, area: &Area<'_>) -> Drawn {
        let frame = self.frame;
        let (right, bottom) = (frame.right(), frame.bottom());
        let outline = [(frame.left, frame.top), (right, frame.top), (right, bottom), (frame.left, bottom), (frame.left, frame.top)];
        area.draw(&PathElement::new(outline, GREY.stroke_width(UNIT as u32)))
    }
}

/// Height below a frame that tick labels and these lines take, in units of paper.
pub(super) fn x_labels_height(lines: &[String]) -> i32 {
    3 * TICK + TICK_TEXT * UNIT + 2 * UNIT + lines.len() as i32 * line_height(LABEL_TEXT)
}

/// Width left of a frame that tick labels of a width and these lines take, in units of paper.
pub(super) fn y_labels_width(ticks: i32, lines: &[String]) -> i32 {
    2 * TICK + ticks + 6 * UNIT + lines.len() as i32 * line_height(LABEL_TEXT)
}

/// The label of an axis in as many lines as it needs for the length of the axis, but at most four:
/// an endless name must not push the data off the paper.
pub(super) fn axis_label(quantity: &PlotQuantity, axis: &PlotAxis, room: i32) -> Vec<String> {
    let label = quantity.label_in_powers_of_ten(axis.exponent);
    let mut lines = wrap(&label, LABEL_TEXT, room);
    lines.truncate(4);
    lines
}
