//! The surface of a pulley unrolled: von Mises stress over the angle and the arc length, one map per side.

use super::super::PlotQuantity;
use super::super::axis::{Numbers, PlotAxis};
use super::super::colour_bar::ColourBar;
use super::super::colours::{GREY, HATCH, INK, STEPS, VERMILION, step_of};
use super::super::header::{Header, Mark};
use super::super::number::significant;
use super::super::panel::{PanelPlan, axis_label, x_labels_height, y_labels_width};
use super::super::raster::{image, index_of_step};
use super::super::sheet::{Dash, Frame, Sheet, UNIT, WIDTH, stroked};
use super::super::words::text;
use super::around::{name_bolts, turn_axis, turn_label};
use super::drawing::filled;
use crate::pulley::around::bolts_deg;
use crate::pulley::field::degrees;
use crate::pulley::mesh::Mesh;
use crate::pulley::response::CHECK_POINTS;
use crate::pulley::surface::{Stretch, stretches};
use crate::pulley::turn::{Peak, Turn};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use std::f64::consts::PI;

/// Cells around the circumference, a degree each.
const COLUMNS: usize = 360;
/// Rows of all maps together, shared out by their length.
const ROWS: f64 = 560.0;
/// Height of all maps together.
const HEIGHT: f64 = 680.0 * UNIT as f64;
/// Space between two maps, with the names of wrap and bolts.
const GAP: i32 = 34 * UNIT;

/// Draws the stresses of the whole surface under a load case with the first bolt at the phase of `largest`, the largest of them.
pub fn unrolled(title: &str, mesh: &Mesh, turn: &Turn<'_>, largest: &Peak) -> String {
    let stretches = stretches(mesh);
    let whole: f64 = stretches.iter().map(Stretch::length).sum();
    let header = Header::new(title, legend(largest, turn.case().wrap * 180.0 / PI));
    let top = header.height() + 16 * UNIT;
    let count = stretches.len() as i32;
    let share = |stretch: &Stretch| stretch.length() / whole;
    let heights: Vec<i32> = stretches.iter().map(|it| ((HEIGHT * share(it)).round() as i32).max(90 * UNIT)).collect();
    let bottom = top + heights.iter().sum::<i32>() + (count - 1) * GAP;
    let range = (0.0, if largest.stress > 0.0 { largest.stress } else { 1.0 });
    let bar = ColourBar::new(range, &PlotQuantity::new("von Mises stress", "MPa"), bottom - top, false);
    let axes: Vec<PlotAxis> =
        stretches.iter().zip(&heights).map(|(it, height)| PlotAxis::vertical((0.0, it.length()), *height, Numbers::Long)).collect();
    let labels: Vec<Vec<String>> = stretches.iter().zip(&axes).zip(&heights).map(|((it, axis), height)| label(it, axis, *height)).collect();
    let tick_room = axes.iter().map(PlotAxis::label_width).max().unwrap_or(0);
    let left = 12 * UNIT + labels.iter().map(|label| y_labels_width(tick_room, label)).max().unwrap_or(0);
    let width = WIDTH - left - 20 * UNIT - bar.room();
    let x = turn_axis();
    let x_label = turn_label(&x, width);
    let mut sheet = Sheet::new(bottom + x_labels_height(&x_label) + 14 * UNIT);
    sheet.draw(|area| header.draw(area));
    let mut y = top;
    for (number, stretch) in stretches.iter().enumerate() {
        let frame = Frame { left, top: y, width, height: heights[number] };
        let map = UnrolledMap { turn, largest, stretch, frame };
        let rows = ((ROWS * share(stretch)).round() as usize).max(40);
        sheet.insert(&image(frame, &map.indices(rows, range), COLUMNS, rows));
        map.draw(&mut sheet);
        sheet.draw(|area| {
            let last = number + 1 == stretches.len();
            let plan = PanelPlan {
                frame,
                x: &x,
                y: &axes[number],
                x_label: last.then_some(&x_label),
                y_label: Some(&labels[number]),
                tick_room,
                grid: false,
            };
            plan.draw(area)?;
            name_bolts(area, &bolts_deg(turn, largest.phase), frame)
        });
        y = frame.bottom() + GAP;
    }
    let frame = Frame { left, top, width, height: bottom - top };
    sheet.insert(&bar.image(frame));
    sheet.draw(|area| bar.draw_ticks(area, frame));
    sheet.finish()
}

fn legend(largest: &Peak, wrap_deg: f64) -> Vec<(Mark, String)> {
    let at = significant((degrees(largest.theta) * 10.0).round() / 10.0, 4);
    vec![
        (Mark::Plus(VERMILION), format!("largest stress {} MPa at {at}°", significant(largest.stress, 4))),
        (Mark::Line(INK, Dash::Solid), format!("touched by the belt, wrap {}°", significant(wrap_deg, 4))),
        (Mark::Line(GREY, Dash::Centre), "bolts".to_owned()),
        (Mark::Hatched, "left out of the largest stress".to_owned()),
    ]
}

fn label(stretch: &Stretch, axis: &PlotAxis, room: i32) -> Vec<String> {
    let from = if stretch.name == "groove" { "rim" } else { "bore" };
    let mut lines = vec![stretch.name.to_owned()];
    lines.extend(axis_label(&PlotQuantity::new(format!("arc length from the {from}"), "mm"), axis, room));
    lines
}

/// Stress of a point in the middle of every cell of a row, MPa.
fn by_cell(turn: &Turn<'_>, point: usize, phase: f64) -> Vec<f64> {
    turn.by_degree(point, phase).windows(2).map(|ends| 0.5 * (ends[0] + ends[1])).collect()
}

/// The map of one stretch.
struct UnrolledMap<'a> {
    turn: &'a Turn<'a>,
    largest: &'a Peak,
    stretch: &'a Stretch,
    frame: Frame,
}

impl UnrolledMap<'_> {
    /// Palette indices of the cells, the top row first.
    fn indices(&self, rows: usize, (low, high): (f64, f64)) -> Vec<u8> {
        let stress = |point: &usize| by_cell(self.turn, *point, self.largest.phase);
        let stresses: Vec<Vec<f64>> = self.stretch.points.iter().map(stress).collect();
        let arc = &self.stretch.arc;
        let mut indices = Vec::with_capacity(rows * COLUMNS);
        for row in (0..rows).rev() {
            let at = self.stretch.length() * (row as f64 + 0.5) / rows as f64;
            let next = arc.partition_point(|it| *it < at).clamp(1, arc.len() - 1);
            let part = ((at - arc[next - 1]) / (arc[next] - arc[next - 1])).clamp(0.0, 1.0);
            for (before, after) in stresses[next - 1].iter().zip(&stresses[next]) {
                indices.push(index_of_step(step_of(before + part * (after - before), low, high).min(STEPS - 1)));
            }
        }
        indices
    }

    fn across(&self, degrees: f64) -> i32 {
        self.frame.left + (degrees / 360.0 * f64::from(self.frame.width)).round() as i32
    }

    fn up(&self, arc: f64) -> i32 {
        self.frame.bottom() - (arc / self.stretch.length() * f64::from(self.frame.height)).round() as i32
    }

    /// What stands over the cells: clamped zone, bolts, belt, check points, the largest stress.
    fn draw(&self, sheet: &mut Sheet) {
        let frame = self.frame;
        self.exclude(sheet);
        for bolt in bolts_deg(self.turn, self.largest.phase) {
            sheet.insert(&stroked(&format!("M{} {}V{}", self.across(bolt), frame.top, frame.bottom()), GREY, 8, Dash::Centre));
        }
        let wrap = self.turn.case().wrap * 180.0 / PI;
        sheet.insert(&stroked(&format!("M{} {}V{}", self.across(wrap.min(360.0)), frame.top, frame.bottom()), WHITE, 8, Dash::Dashed));
        for &(low, high) in &self.stretch.bands {
            let path = format!("M{} {}H{}V{}H{0}Z", frame.left, self.up(low), self.across(wrap.min(360.0)), self.up(high));
            for (colour, width) in [(WHITE, 34), (INK, 14)] {
                sheet.insert(&stroked(&path, colour, width, Dash::Solid));
            }
        }
        let names = self.names();
        for (name, at, label) in &names {
            let y = self.up(*at);
            sheet.insert(&stroked(&format!("M{} {y}H{}", frame.left, frame.right()), WHITE, 8, Dash::Dotted));
            let right = frame.right();
            sheet.insert(&stroked(&format!("M{right} {y}l{} {}", 5 * UNIT, label - y), GREY, 8, Dash::Solid));
            sheet.draw(|area| area.draw_text(name, &text(11, INK, HPos::Left, VPos::Center), (right + 6 * UNIT, *label)));
        }
        if let Some(arc) = self.stretch.place_of(self.largest.point) {
            let at = (self.across(degrees(self.largest.theta)), self.up(arc));
            sheet.draw(|area| Mark::Plus(VERMILION).draw(area, at));
        }
    }

    /// Check points on this stretch: names, arc lengths, and where the names stand, apart from each other.
    fn names(&self) -> Vec<(&'static str, f64, i32)> {
        let view = self.turn.view();
        let place = |number: usize| Some((CHECK_POINTS[number], self.stretch.place_of(view.check_point(number)?)?));
        let mut names: Vec<(&str, f64)> = (0..CHECK_POINTS.len()).filter_map(place).collect();
        names.sort_by(|a, b| a.1.total_cmp(&b.1));
        let mut last = i32::MAX;
        let spread = names.into_iter().map(|(name, at)| {
            let y = self.up(at).min(last.saturating_sub(12 * UNIT));
            last = y;
            (name, at, y)
        });
        spread.collect()
    }

    /// Tints what does not count for the largest stress.
    fn exclude(&self, sheet: &mut Sheet) {
        // A single point has no width to tint.
        for (low, high) in self.excluded().into_iter().filter(|(low, high)| low < high) {
            self.tint(sheet, low, high);
        }
    }

    /// Ranges of arc length whose points do not count.
    fn excluded(&self) -> Vec<(f64, f64)> {
        let counted = self.turn.view().counted();
        let mut ranges: Vec<(f64, f64)> = Vec::new();
        let mut open = false;
        for (&point, &arc) in self.stretch.points.iter().zip(&self.stretch.arc) {
            let excluded = counted[point] == 0.0;
            match ranges.last_mut() {
                Some(range) if open && excluded => range.1 = arc,
                _ if excluded => ranges.push((arc, arc)),
                _ => {}
            }
            open = excluded;
        }
        ranges
    }

    fn tint(&self, sheet: &mut Sheet, low: f64, high: f64) {
        let (frame, top, bottom) = (self.frame, self.up(high), self.up(low));
        sheet.insert(&filled(&format!("M{} {top}H{}V{bottom}H{0}Z", frame.left, frame.right()), WHITE, "0.55"));
        let height = bottom - top;
        let mut lines = String::new();
        for start in (-height..frame.width).step_by((14 * UNIT) as usize) {
            let (from, to) = ((-start).max(0), height.min(frame.width - start));
            lines += &format!("M{} {}l{2} -{2}", frame.left + start + from, bottom - from, to - from);
        }
        sheet.insert(&stroked(&lines, HATCH, 5, Dash::Solid));
        for (end, y) in [(low, bottom), (high, top)] {
            if end > 0.0 && end < self.stretch.length() {
                sheet.insert(&stroked(&format!("M{} {y}H{}", frame.left, frame.right()), GREY, 8, Dash::Dashed));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::colours::step_colour;
    use super::super::super::raster::tests::decoded;
    use super::super::super::sheet::tests::assert_svg;
    use super::*;
    use crate::pulley::fixtures;
    use crate::pulley::response::View;
    use crate::pulley::section::{Fineness, SectionKind};

    #[test]
    fn maps_show_the_stress_of_the_surface_and_name_every_check_point() {
        for (kind, dimensions) in fixtures::sections() {
            let (mesh, table) = fixtures::solved(kind, &dimensions, &Fineness::USUAL);
            let turn = Turn::new(View::new(&table), fixtures::case(&dimensions));
            let largest = turn.summary(None, [None; 2]).largest;
            let svg = unrolled("surface", &mesh, &turn, &largest);
            assert_svg(&svg);
            for point in &mesh.points {
                assert_eq!(svg.matches(&format!("\n{}\n", point.name)).count(), 1, "{kind:?} {}", point.name);
            }
            assert!(svg.contains(&format!("largest stress {} MPa", significant(largest.stress, 4))));
            let maps = if kind == SectionKind::WeldedDiscs { 3 } else { 2 };
            assert_eq!(svg.matches("<image").count(), maps + 1);
            // The colour of a cell is that of its stress.
            let stretch = &stretches(&mesh)[0];
            let (width, height, pixels) = decoded(&svg, 0);
            let (row, column) = (height as usize / 2, width as usize / 8);
            let at = stretch.length() * ((height as usize - 1 - row) as f64 + 0.5) / f64::from(height);
            let after = stretch.arc.iter().position(|it| *it >= at).unwrap();
            let [before, after] = [after - 1, after].map(|it| by_cell(&turn, stretch.points[it], largest.phase)[column]);
            let steps = [before.min(after), before.max(after)].map(|stress| step_of(stress, 0.0, largest.stress));
            let pixel = pixels[row * width as usize + column];
            let found = (steps[0]..=steps[1]).any(|step| {
                let colour = step_colour(step);
                [colour.0, colour.1, colour.2] == pixel[..3]
            });
            assert!(found, "{kind:?}: {pixel:?} is no colour of {before} to {after} MPa");
        }
    }
}
