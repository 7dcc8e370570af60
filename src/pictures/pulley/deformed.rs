//! The deformed section in the colours of von Mises stress.

use super::super::PlotQuantity;
use super::super::axis::{Numbers, PlotAxis};
use super::super::colour_bar::ColourBar;
use super::super::colours::{GREY, HATCH, INK, VERMILION};
use super::super::header::{Header, Mark};
use super::super::number::{power_of_ten, scientific, significant};
use super::super::panel::{PanelPlan, axis_label, x_labels_height, y_labels_width};
use super::super::sheet::{Dash, Frame, Sheet, UNIT, WIDTH, stroked};
use super::drawing::{Box, Drawing, DrawingScale, filled};
use super::section::outwards;
use super::shape::{boundary, coloured, dense};
use crate::pulley::field::{Field, degrees};
use crate::pulley::mesh::Mesh;
use crate::pulley::response::points_of_edges;
use crate::pulley::turn::Turn;
use glam::DVec2;
use plotters::style::RGBColor;

const HEIGHT: i32 = 600 * UNIT;
/// Share of the section's size that the largest displacement is drawn with, at most.
const SHARE: f64 = 0.05;

/// Draws the section at the angle of a field, displaced with a magnification that the picture states, over its outline at rest. The
/// colours go up to the largest stress outside the clamped zone; inside, where stresses depend on the mesh, they end there.
pub fn deformed(title: &str, mesh: &Mesh, turn: &Turn<'_>, field: &Field) -> String {
    let factor = magnification(mesh, field);
    let places: Vec<DVec2> = mesh.nodes.iter().zip(&field.displacement).map(|(at, u)| *at + factor * DVec2::new(u[1], u[0])).collect();
    let largest = Largest::new(mesh, turn, field);
    let header = Header::new(title, legend(factor, field, turn.view().excluded_radius(), mesh));
    let value = PlotQuantity::new("von Mises stress", "MPa");
    let range = (0.0, if largest.stress > 0.0 { largest.stress } else { 1.0 });
    let bar = ColourBar::new(range, &value, HEIGHT, false);
    let layout = DeformedLayout::new(mesh, &places, &bar, header.height());
    let mut sheet = Sheet::new(layout.bottom());
    sheet.draw(|area| header.draw(area));
    let (frame, scale) = (layout.frame, &layout.scale);
    let sides = boundary(mesh);
    let lines = |places: &[DVec2]| scale.curves(sides.iter().map(|nodes| nodes.map(|node| places[node as usize])));
    sheet.insert(&stroked(&lines(&mesh.nodes), HATCH, 10, Dash::Solid));
    sheet.insert(&coloured(mesh, &places, &field.von_mises, range, scale));
    sheet.insert(&stroked(&lines(&places), INK, 7, Dash::Solid));
    let mut drawing = Drawing::on(Box([frame.left, frame.top, frame.right(), frame.bottom()]));
    drawing.solid(dense(sides.iter().map(|nodes| nodes.map(|node| scale.exact(places[node as usize])))));
    drawing.solid(dense(sides.iter().map(|nodes| nodes.map(|node| scale.exact(mesh.nodes[node as usize])))));
    exclude(&mut drawing, frame, scale, turn.view().excluded_radius());
    for &(place, distance) in &mesh.singular {
        let ((x, y), radius) = (scale.place(place), (scale.per_mm * distance).round());
        drawing.insert(&format!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"#FFFFFF\" fill-opacity=\"0.35\" stroke=\"#6E6E6E\" stroke-width=\"8\" stroke-dasharray=\"70 40\"/>\n"
        ));
    }
    if let Some(node) = largest.node {
        let at = scale.exact(places[node as usize]);
        let words = format!("{} MPa{}", significant(largest.stress, 4), largest.near(mesh));
        drawing.label(&words, VERMILION, at, outwards(mesh, node));
        drawing.insert(&ring(at.x.round() as i32, at.y.round() as i32, VERMILION));
    }
    drawing.finish(&mut sheet);
    sheet.insert(&bar.image(frame));
    sheet.draw(|area| {
        layout.panel().draw(area)?;
        bar.draw_ticks(area, frame)
    });
    sheet.finish()
}

fn legend(factor: f64, field: &Field, excluded: f64, mesh: &Mesh) -> Vec<(Mark, String)> {
    let angle = |angle: f64| significant((degrees(angle) * 10.0).round() / 10.0, 5);
    let crack = if mesh.singular.is_empty() { "" } else { " and in the circle" };
    vec![
        (Mark::None, format!("θ = {}° from the slack end", angle(field.theta))),
        (Mark::None, format!("first bolt at {}°", angle(field.phase))),
        (Mark::None, format!("displacements × {}", significant(factor, 3))),
        (Mark::Line(HATCH, Dash::Solid), "at rest".to_owned()),
        (Mark::Dot(VERMILION), "largest stress".to_owned()),
        (Mark::Hatched, format!("left out of the largest stress: r < {} mm{crack}", significant(excluded, 4))),
    ]
}

/// A ring that leaves the colours inside visible.
fn ring(x: i32, y: i32, RGBColor(r, g, b): RGBColor) -> String {
    let circle = |colour: &str, width: i32| {
        format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"55\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"/>\n")
    };
    circle("#FFFFFF", 36) + &circle(&format!("#{r:02X}{g:02X}{b:02X}"), 16)
}

/// The factor of displacements: 1, 2 or 5 times a power of ten.
fn magnification(mesh: &Mesh, field: &Field) -> f64 {
    let most = field.displacement.iter().map(|u| u[0] * u[0] + u[1] * u[1]).fold(0.0, f64::max).sqrt();
    let (low, high) = bounds(&mesh.nodes);
    let wanted = SHARE * (high - low).max_element() / most;
    if most == 0.0 || !wanted.is_finite() {
        return 1.0;
    }
    let (mantissa, exponent) = scientific(wanted);
    let round = if mantissa < 2.0 {
        1.0
    } else if mantissa < 5.0 {
        2.0
    } else {
        5.0
    };
    round * power_of_ten(exponent)
}

fn bounds(places: &[DVec2]) -> (DVec2, DVec2) {
    let start = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    places.iter().fold(start, |(low, high), at| (low.min(*at), high.max(*at)))
}

/// The largest stress of the field outside the clamped zone.
struct Largest {
    stress: f64,
    node: Option<u32>,
}

impl Largest {
    fn new(mesh: &Mesh, turn: &Turn<'_>, field: &Field) -> Self {
        let view = turn.view();
        let mut largest = Self { stress: 0.0, node: None };
        for (edge, points) in mesh.surface.iter().zip(points_of_edges(mesh)) {
            for (&node, point) in edge.nodes.iter().zip(points) {
                let stress = field.von_mises[node as usize];
                if view.counted()[point] != 0.0 && stress > largest.stress {
                    largest = Self { stress, node: Some(node) };
                }
            }
        }
        largest
    }

    /// The check point at its place or beside it.
    fn near(&self, mesh: &Mesh) -> String {
        let Some(at) = self.node.map(|node| mesh.nodes[node as usize]) else { return String::new() };
        let distance = |node: u32| mesh.nodes[node as usize].distance(at);
        let nearest = mesh.points.iter().min_by(|a, b| distance(a.node).total_cmp(&distance(b.node)));
        match nearest {
            Some(point) if distance(point.node) < 1e-6 => format!(" at {}", point.name),
            Some(point) if distance(point.node) < 3.0 => format!(" beside {}", point.name),
            _ => format!(" at z {}, r {} mm", significant(at.x, 4), significant(at.y, 4)),
        }
    }
}

/// Tints and hatches the clamped zone and names it.
fn exclude(drawing: &mut Drawing, frame: Frame, scale: &DrawingScale, radius: f64) {
    let top = scale.place(DVec2::new(0.0, radius)).1.clamp(frame.top, frame.bottom());
    let (left, right, bottom) = (frame.left, frame.right(), frame.bottom());
    if top >= bottom {
        return;
    }
    drawing.insert(&filled(&format!("M{left} {top}H{right}V{bottom}H{left}Z"), GREY, "0.12"));
    let (width, height) = (frame.width, bottom - top);
    let mut lines = String::new();
    for start in (-height..width).step_by((14 * UNIT) as usize) {
        let (from, to) = ((-start).max(0), height.min(width - start));
        lines += &format!("M{} {}l{2} -{2}", left + start + from, bottom - from, to - from);
    }
    drawing.insert(&stroked(&lines, HATCH, 4, Dash::Solid));
    drawing.insert(&stroked(&format!("M{left} {top}H{right}"), GREY, 8, Dash::Dashed));
}

/// Where panel and colour bar stand.
struct DeformedLayout {
    frame: Frame,
    scale: DrawingScale,
    z: PlotAxis,
    r: PlotAxis,
    labels: [Vec<String>; 2],
}

impl DeformedLayout {
    fn new(mesh: &Mesh, places: &[DVec2], bar: &ColourBar, top: i32) -> Self {
        let (rest, moved) = (bounds(&mesh.nodes), bounds(places));
        let (low, high) = (rest.0.min(moved.0), rest.1.max(moved.1));
        let left = 80 * UNIT;
        let width = (WIDTH - left - 20 * UNIT - bar.room()).min(620 * UNIT);
        // Room for words beside the section.
        let size = (high - low) * DVec2::new(1.5, 1.08);
        let per_mm = (f64::from(width) / size.x).min(f64::from(HEIGHT) / size.y);
        let half = DVec2::new(f64::from(width), f64::from(HEIGHT)) / (2.0 * per_mm);
        let middle = 0.5 * (low + high);
        let (z, r) = ((middle.x - half.x, middle.x + half.x), (middle.y - half.y, middle.y + half.y));
        let z_axis = PlotAxis::horizontal(z, width, 25 * UNIT, Numbers::Long);
        let r_axis = PlotAxis::vertical(r, HEIGHT, Numbers::Long);
        let labels =
            [axis_label(&PlotQuantity::new("z", "mm"), &z_axis, width), axis_label(&PlotQuantity::new("r", "mm"), &r_axis, HEIGHT)];
        let left = left.max(12 * UNIT + y_labels_width(r_axis.label_width(), &labels[1]));
        let frame = Frame { left, top, width, height: HEIGHT };
        let origin = DVec2::new(f64::from(left) - per_mm * z.0, f64::from(frame.bottom()) + per_mm * r.0);
        Self { frame, scale: DrawingScale { origin, per_mm }, z: z_axis, r: r_axis, labels }
    }

    fn bottom(&self) -> i32 {
        self.frame.bottom() + x_labels_height(&self.labels[0]) + 14 * UNIT
    }

    fn panel(&self) -> PanelPlan<'_> {
        PanelPlan {
            frame: self.frame,
            x: &self.z,
            y: &self.r,
            x_label: Some(&self.labels[0]),
            y_label: Some(&self.labels[1]),
            tick_room: self.r.label_width(),
            grid: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::sheet::tests::assert_svg;
    use super::*;
    use crate::pulley::field::UnitDisplacements;
    use crate::pulley::fixtures;
    use crate::pulley::response::View;
    use crate::pulley::section::Fineness;

    #[test]
    fn the_reported_stress_is_marked_and_the_magnification_is_round() {
        for (kind, dimensions) in fixtures::sections() {
            let fineness = Fineness::USUAL;
            let (mesh, table) = fixtures::solved(kind, &dimensions, &fineness);
            let turn = Turn::new(View::new(&table), fixtures::case(&dimensions));
            let largest = turn.summary(None, [None; 2]).largest;
            let answers = UnitDisplacements::new(&mesh, &dimensions, 0.29, &fineness);
            let field = answers.field(&mesh, &turn, largest.theta, largest.phase);
            let svg = deformed("a & b", &mesh, &turn, &field);
            assert_svg(&svg);
            assert!(svg.contains(&format!("\n{} MPa ", significant(largest.stress, 4))), "{kind:?}");
            let factor = magnification(&mesh, &field);
            assert!(svg.contains(&format!("displacements × {}", significant(factor, 3))), "{kind:?}");
            assert!(["1", "2", "5"].contains(&&format!("{factor:e}")[..1]));
            let most = field.displacement.iter().map(|u| u[0] * u[0] + u[1] * u[1]).fold(0.0, f64::max).sqrt() * factor;
            let (low, high) = bounds(&mesh.nodes);
            let share = most / (high - low).max_element();
            assert!(share <= SHARE && share > 0.3 * SHARE, "{kind:?}: {share}");
        }
    }
}
