//! The picture of curves over a common abscissa.

use super::axis::{Numbers, PlotAxis};
use super::colours::{GREY, LINES};
use super::header::{Header, Mark, sentence};
use super::panel::{PanelPlan, axis_label, x_labels_height, y_labels_width};
use super::range::bounds;
use super::sheet::{Area, Dash, Drawn, Frame, Sheet, UNIT, WIDTH, stroked};
use super::words::{clean, text};
use super::{PlotQuantity, Series};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use std::fmt::Write;

const GAP: i32 = 18 * UNIT;

/// Draws curves over the abscissa `x` in panels below each other, one panel for each ordinate with its series.
///
/// A label has the same colour and dash throughout the picture and is in the legend once; points are joined in the given order. A panel
/// without values stays empty; without any value at all the picture says so.
pub fn curves(title: &str, x: &PlotQuantity, panels: &[(PlotQuantity, Vec<Series>)]) -> String {
    let all = panels.iter().flat_map(|(_, series)| series);
    let abscissae = all.clone().flat_map(|s| points(s).map(|(x, _)| x));
    let Some(range) = bounds(abscissae, 0.0) else {
        return sentence(title, "no values");
    };
    let labels = labels(all);
    let header = Header::new(title, legend(&labels));
    let height = match panels.len() {
        1 => 420 * UNIT,
        2 => 270 * UNIT,
        _ => 210 * UNIT,
    };
    let rows: Vec<CurveRow> = panels.iter().map(|p| CurveRow::new(p, height)).collect();
    let tick_room = rows.iter().map(|row| row.axis.label_width()).max().unwrap_or(0);
    let widths = rows.iter().map(|row| y_labels_width(tick_room, &row.label));
    let left = 12 * UNIT + widths.max().unwrap_or(0);
    let width = WIDTH - left - 30 * UNIT;
    let x_axis = PlotAxis::horizontal(range, width, 25 * UNIT, Numbers::Long);
    let x_label = axis_label(x, &x_axis, width);
    let top = header.height();
    let bottom = top + rows.len() as i32 * (height + GAP) - GAP;
    let mut sheet = Sheet::new(bottom + x_labels_height(&x_label) + 14 * UNIT);
    let lines = sheet.draw(|area| {
        header.draw(area)?;
        let mut lines = String::new();
        for (i, row) in rows.iter().enumerate() {
            let frame = Frame { left, top: top + i as i32 * (height + GAP), width, height };
            let panel = PanelPlan {
                frame,
                x: &x_axis,
                y: &row.axis,
                x_label: (i + 1 == rows.len()).then_some(&x_label),
                y_label: Some(&row.label),
                tick_room,
                grid: true,
            };
            lines += &row.draw(area, &panel, &labels)?;
        }
        Ok(lines)
    });
    sheet.insert(&lines);
    sheet.finish()
}

/// One panel.
struct CurveRow<'a> {
    series: &'a [Series],
    axis: PlotAxis,
    label: Vec<String>,
}

impl<'a> CurveRow<'a> {
    fn new((quantity, series): &'a (PlotQuantity, Vec<Series>), height: i32) -> Self {
        let ordinates = series.iter().flat_map(|s| points(s).map(|(_, y)| y));
        let axis = match bounds(ordinates, 0.06) {
            Some(range) => PlotAxis::vertical(range, height, Numbers::Long),
            None => PlotAxis::with_ticks((0.0, 1.0), std::iter::empty()),
        };
        let label = axis_label(quantity, &axis, height);
        Self { series, axis, label }
    }

    /// Draws the panel; returns the lines as SVG elements to insert.
    fn draw(&self, area: &Area<'_>, panel: &PanelPlan<'_>, labels: &[&str]) -> Drawn<String> {
        let context = panel.draw(area)?;
        let (mut empty, mut lines) = (true, String::new());
        for series in self.series {
            let (colour, dash) = look(labels, &series.label);
            let places: Vec<(i32, i32)> = points(series).map(|p| context.backend_coord(&p)).collect();
            empty &= places.is_empty();
            match places[..] {
                [] => {}
                [place] => Mark::Dot(colour).draw(area, place)?,
                _ => lines += &stroked(&path(&places), colour, 2 * UNIT, dash),
            }
        }
        if empty {
            let style = text(14, GREY, HPos::Center, VPos::Center);
            area.draw_text("no values", &style, panel.frame.middle())?;
        }
        Ok(lines)
    }
}

/// Path data of a line through points of the paper.
fn path(places: &[(i32, i32)]) -> String {
    let mut path = String::new();
    for (i, (x, y)) in places.iter().enumerate() {
        let command = if i == 0 { 'M' } else { 'L' };
        write!(path, "{command}{x} {y}").expect("writing into a string does not fail");
    }
    path
}

/// The points of a series that can be drawn.
fn points(series: &Series) -> impl Iterator<Item = (f64, f64)> + '_ {
    let pairs = series.x.iter().copied().zip(series.y.iter().copied());
    pairs.filter(|(x, y)| x.is_finite() && y.is_finite())
}

/// Every label once, in the order of first appearance.
fn labels<'a>(series: impl Iterator<Item = &'a Series>) -> Vec<&'a str> {
    let mut labels: Vec<&str> = Vec::new();
    for Series { label, .. } in series {
        if !labels.contains(&label.as_str()) {
            labels.push(label);
        }
    }
    labels
}

fn legend(labels: &[&str]) -> Vec<(Mark, String)> {
    let entry = |label: &&str| {
        let (colour, dash) = look(labels, label);
        (Mark::Line(colour, dash), clean(label))
    };
    let named = labels.iter().filter(|label| !clean(label).is_empty());
    named.map(entry).collect()
}

/// Colour and dash of a label. The dash changes when the colours are used up.
fn look(labels: &[&str], label: &str) -> (RGBColor, Dash) {
    let place = labels.iter().position(|l| *l == label).unwrap_or(0);
    let dash = match place / LINES.len() % 3 {
        0 => Dash::Solid,
        1 => Dash::Dashed,
        _ => Dash::Dotted,
    };
    (LINES[place % LINES.len()], dash)
}

#[cfg(test)]
mod tests {
    use super::super::sheet::tests::assert_svg;
    use super::*;

    fn series(label: &str, x: &[f64], y: &[f64]) -> Series {
        Series { label: label.to_owned(), x: x.to_vec(), y: y.to_vec() }
    }

    fn draw(panels: &[Vec<Series>]) -> String {
        let angle = PlotQuantity::new("wrap_angle_deg", "deg");
        let panel = |s: &Vec<Series>| (PlotQuantity::new("tension_N", "N"), s.clone());
        let panels: Vec<_> = panels.iter().map(panel).collect();
        let svg = curves("T & T", &angle, &panels);
        assert_svg(&svg);
        assert_eq!(svg, curves("T & T", &angle, &panels));
        assert!(svg.contains("T &amp; T"));
        svg
    }

    #[test]
    fn a_label_has_one_colour_and_one_legend_entry() {
        let [x, y] = [[0.0, 90.0], [700.0, 900.0]];
        let svg = draw(&[vec![series("driver", &x, &y), series("driven", &x, &y)], vec![series("driven", &x, &y)]]);
        assert_eq!(svg.matches("\ndriver\n").count(), 1);
        assert_eq!(svg.matches("\ndriven\n").count(), 1);
        let vermilion = "<path d=\"M";
        assert_eq!(svg.matches(vermilion).count(), 3);
        let lines = svg.lines().filter(|line| line.starts_with(vermilion));
        let vermilions = lines.filter(|line| line.contains("stroke=\"#D55E00\""));
        assert_eq!(vermilions.count(), 2);
        assert_eq!(svg.matches("\ntension [N]\n").count(), 2);
        assert_eq!(svg.matches("\nwrap angle [deg]\n").count(), 1);
    }

    #[test]
    fn every_line_looks_different() {
        let names: Vec<String> = (0..21).map(|i| i.to_string()).collect();
        let labels: Vec<&str> = names.iter().map(String::as_str).collect();
        let looks: Vec<_> = labels.iter().map(|label| look(&labels, label)).collect();
        for (i, one) in looks.iter().enumerate() {
            assert!(looks[..i].iter().all(|other| other != one));
        }
    }

    #[test]
    fn degenerate_curves_give_a_picture() {
        assert!(draw(&[]).contains("no values"));
        assert!(draw(&[vec![], vec![series("a", &[], &[])]]).contains("no values"));
        let half = draw(&[vec![series("a", &[1.0, 2.0], &[3.0, 4.0])], vec![]]);
        assert_eq!(half.matches("no values").count(), 1);
        for value in [0.0, 1e-12, 1e12, -5.0] {
            let dot = draw(&[vec![series("", &[value], &[value])]]);
            assert_eq!(dot.matches("<circle").count(), 1);
            let flat = draw(&[vec![series("a", &[value, 2.0 * value], &[value, value])]]);
            assert_eq!(flat.matches("<path").count(), 1);
        }
    }
}
