//! The picture of lines and marks in one pair of axes, each line with its own style, as printed figures need it.

use super::PlotQuantity;
use super::axis::{Numbers, PlotAxis};
use super::colours::LINES;
pub use super::header::Marker;
use super::header::{Header, Mark, sentence};
use super::panel::{PanelPlan, axis_label, x_labels_height, y_labels_width};
use super::range::bounds;
use super::sheet::{Area, Dash, Drawn, Frame, Sheet, UNIT, WIDTH, stroked};
use super::words::{clean, text, text_width};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use std::fmt::Write;

const HEIGHT: i32 = 440 * UNIT;
/// Height of words at a guide, in pixels.
const GUIDE_TEXT: i32 = 12;
const GUIDE_ROW: i32 = 17 * UNIT;

/// How the points of a [`Line`] are joined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// By a solid line.
    Solid,
    /// By a dashed line.
    Dashed,
    /// By a dotted line.
    Dotted,
    /// Not at all: only marks are drawn.
    None,
}

/// One line of [`lines()`].
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Name in the legend; without one the line is not in it.
    pub label: String,
    /// Abscissae.
    pub x: Vec<f64>,
    /// Ordinates, as many as `x`.
    pub y: Vec<f64>,
    /// Number of the colour: lines that belong together have the same.
    pub colour: usize,
    /// How its points are joined.
    pub stroke: Stroke,
    /// The marks at its points.
    pub marker: Marker,
}

/// A straight line across the panel, with a label.
#[derive(Debug, Clone, PartialEq)]
pub struct Guide {
    /// Where it crosses its axis.
    pub at: f64,
    /// Is it vertical, at an abscissa, rather than horizontal, at an ordinate?
    pub upright: bool,
    /// Its label.
    pub words: String,
    /// Number of the colour, as of [`Line::colour`]; `None`: the colour of text.
    pub colour: Option<usize>,
}

/// An axis of [`lines()`].
#[derive(Debug, Clone, PartialEq)]
pub struct Scale {
    /// Its quantity.
    pub quantity: PlotQuantity,
    /// Its ends; without them they are those of the data.
    pub range: Option<(f64, f64)>,
}

/// Draws lines in one panel, with guides across it. Points are joined in the order given; values that are not finite are left out.
pub fn lines(title: &str, x: &Scale, y: &Scale, lines: &[Line], guides: &[Guide]) -> String {
    let xs = lines.iter().flat_map(|line| points(line).map(|(x, _)| x));
    let ys = lines.iter().flat_map(|line| points(line).map(|(_, y)| y));
    let (Some(x_range), Some(y_range)) = (x.range.or_else(|| bounds(xs, 0.0)), y.range.or_else(|| bounds(ys, 0.06))) else {
        return sentence(title, "no values");
    };
    let entry = |line: &Line| (Mark::Styled(colour(line.colour), dash(line.stroke), line.marker), clean(&line.label));
    let header = Header::new(title, lines.iter().map(entry).filter(|(_, label)| !label.is_empty()).collect());
    let y_axis = PlotAxis::vertical(y_range, HEIGHT, Numbers::Long);
    let y_label = axis_label(&y.quantity, &y_axis, HEIGHT);
    let left = 12 * UNIT + y_labels_width(y_axis.label_width(), &y_label);
    let frame = Frame { left, top: header.height(), width: WIDTH - left - 30 * UNIT, height: HEIGHT };
    let x_axis = PlotAxis::horizontal(x_range, frame.width, 25 * UNIT, Numbers::Long);
    let x_label = axis_label(&x.quantity, &x_axis, frame.width);
    let mut sheet = Sheet::new(frame.bottom() + x_labels_height(&x_label) + 14 * UNIT);
    let panel = PanelPlan {
        frame,
        x: &x_axis,
        y: &y_axis,
        x_label: Some(&x_label),
        y_label: Some(&y_label),
        tick_room: y_axis.label_width(),
        grid: true,
    };
    sheet.draw(|area| {
        header.draw(area)?;
        panel.draw(area).map(drop)
    });
    let place = |at: (f64, f64)| place(frame, x_range, y_range, at);
    let across = |guide: &Guide| if guide.upright { place((guide.at, y_range.0)).0 } else { place((x_range.0, guide.at)).1 };
    sheet.insert(&strokes(frame, lines, guides, place, across));
    sheet.draw(|area| {
        for line in lines.iter().filter(|line| line.marker != Marker::None) {
            for point in points(line) {
                Mark::Ring(colour(line.colour), line.marker == Marker::Filled).draw(area, place(point))?;
            }
        }
        words(area, frame, guides, across)
    });
    sheet.finish()
}

/// A point on the paper.
fn place(frame: Frame, x: (f64, f64), y: (f64, f64), at: (f64, f64)) -> (i32, i32) {
    let share = |value: f64, (low, high): (f64, f64)| ((value - low) / (high - low)).clamp(-1.0, 2.0);
    let across = share(at.0, x) * f64::from(frame.width);
    let up = share(at.1, y) * f64::from(frame.height);
    (frame.left + across.round() as i32, frame.bottom() - up.round() as i32)
}

fn points(line: &Line) -> impl Iterator<Item = (f64, f64)> + '_ {
    let pairs = line.x.iter().copied().zip(line.y.iter().copied());
    pairs.filter(|(x, y)| x.is_finite() && y.is_finite())
}

/// Guides and lines as SVG elements.
fn strokes(
    frame: Frame,
    lines: &[Line],
    guides: &[Guide],
    place: impl Fn((f64, f64)) -> (i32, i32),
    across: impl Fn(&Guide) -> i32,
) -> String {
    let mut elements = String::new();
    for guide in guides {
        let at = across(guide);
        let path = if guide.upright {
            format!("M{at} {}V{}", frame.top, frame.bottom())
        } else {
            format!("M{} {at}H{}", frame.left, frame.right())
        };
        elements += &stroked(&path, guide_colour(guide), UNIT, Dash::Centre);
    }
    for line in lines {
        let Some(dash) = dash(line.stroke) else { continue };
        let mut path = String::new();
        for (number, point) in points(line).enumerate() {
            let (x, y) = place(point);
            let command = if number == 0 { 'M' } else { 'L' };
            write!(path, "{command}{x} {y}").expect("writing into a string does not fail");
        }
        elements += &stroked(&path, colour(line.colour), 2 * UNIT, dash);
    }
    elements
}

/// The labels of the guides: at vertical ones below each other from the top, so that neighbours do not overlap.
fn words(area: &Area<'_>, frame: Frame, guides: &[Guide], across: impl Fn(&Guide) -> i32) -> Drawn {
    let mut row = 0;
    for guide in guides {
        let words = clean(&guide.words);
        let (at, width) = (across(guide), text_width(&words, GUIDE_TEXT));
        if guide.upright {
            let beside = at + 6 * UNIT + width <= frame.right();
            let (side, x) = if beside { (HPos::Left, at + 6 * UNIT) } else { (HPos::Right, at - 6 * UNIT) };
            let y = frame.top + 8 * UNIT + row * GUIDE_ROW;
            // With a background of their own, because they may lie over other guides.
            let left = if beside { x } else { x - width };
            let ground = [(left - 3 * UNIT, y - UNIT), (left + width + 3 * UNIT, y + GUIDE_TEXT * UNIT + 3 * UNIT)];
            area.draw(&Rectangle::new(ground, WHITE.filled()))?;
            area.draw_text(&words, &text(GUIDE_TEXT, guide_colour(guide), side, VPos::Top), (x, y))?;
            row += 1;
        } else {
            let style = text(GUIDE_TEXT, guide_colour(guide), HPos::Right, VPos::Bottom);
            area.draw_text(&words, &style, (frame.right() - 8 * UNIT, at - 4 * UNIT))?;
        }
    }
    Ok(())
}

fn colour(number: usize) -> RGBColor {
    LINES[number % LINES.len()]
}

fn guide_colour(guide: &Guide) -> RGBColor {
    guide.colour.map_or(super::colours::INK, colour)
}

fn dash(stroke: Stroke) -> Option<Dash> {
    match stroke {
        Stroke::Solid => Some(Dash::Solid),
        Stroke::Dashed => Some(Dash::Dashed),
        Stroke::Dotted => Some(Dash::Dotted),
        Stroke::None => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::sheet::tests::assert_svg;
    use super::*;

    fn line(label: &str, y: &[f64], marker: Marker) -> Line {
        let x = (0..y.len()).map(|x| x as f64).collect();
        Line { label: label.to_owned(), x, y: y.to_vec(), colour: 1, stroke: Stroke::Dashed, marker }
    }

    fn scale(name: &str, range: Option<(f64, f64)>) -> Scale {
        Scale { quantity: PlotQuantity::new(name, "N"), range }
    }

    #[test]
    fn every_line_guide_and_mark_is_drawn_once() {
        let drawn = [line("a & b", &[1.0, 2.0, f64::NAN, 3.0], Marker::Open), line("c", &[3.0, 2.0], Marker::None)];
        let guides = [true, false].map(|upright| Guide { at: 1.5, upright, words: format!("guide {upright}"), colour: None });
        let svg = lines("a title", &scale("x", None), &scale("y", Some((0.0, 4.0))), &drawn, &guides);
        assert_svg(&svg);
        // Two lines and two guides; three marks and one in the legend.
        assert_eq!(svg.matches("<path").count(), 4);
        assert_eq!(svg.matches("<circle").count(), 2 * 4);
        for words in ["a &amp; b", "c", "guide true", "guide false", "x [N]", "y [N]"] {
            assert_eq!(svg.matches(&format!("\n{words}\n")).count(), 1, "{words}");
        }
    }

    #[test]
    fn marks_stand_on_their_line() {
        let frame = Frame { left: 100, top: 50, width: 1000, height: 400 };
        assert_eq!(place(frame, (0.0, 10.0), (0.0, 4.0), (5.0, 1.0)), (600, 350));
    }

    #[test]
    fn without_values_the_picture_says_so() {
        let svg = lines("t", &scale("x", None), &scale("y", None), &[], &[]);
        assert_svg(&svg);
        assert!(svg.contains("no values"));
    }
}
