//! The drawing of a section: outline, bracket, bolts, contact band, check points and main dimensions.

use super::super::colours::{BLUE, GREY, HATCH, INK, VERMILION};
use super::super::header::{Header, Mark, sentence};
use super::super::number::significant;
use super::super::sheet::{Dash, Sheet, UNIT, WIDTH, stroked};
use super::drawing::{Box, Drawing, DrawingScale, filled, rounded};
use super::shape::{boundary, dense};
use crate::pulley::mesh::{Face, Mesh, MeshEdge};
use crate::pulley::section::{Dimensions, SectionKind, checked_outline};
use glam::DVec2;
use plotters::style::RGBColor;

const STEEL: RGBColor = RGBColor(222, 228, 234);
const BRACKET: RGBColor = RGBColor(240, 236, 226);
const BOLT: RGBColor = RGBColor(204, 204, 204);
/// Largest size of the section, axis included, in units of paper.
const LARGEST: (f64, f64) = (440.0 * UNIT as f64, 620.0 * UNIT as f64);
/// Distance of dimension lines beside each other.
const ROW: i32 = 27 * UNIT;

/// Draws a section with z to the right and r up, both to the same scale. `mesh` must be of the same dimensions. Dimensions that give
/// no section: the picture says why.
pub fn section(title: &str, kind: SectionKind, dimensions: &Dimensions, mesh: &Mesh) -> String {
    let outline = match checked_outline(kind, dimensions) {
        Ok(outline) => outline.parts,
        Err(flaw) => return sentence(title, &flaw.to_string()),
    };
    let header = Header::new(title, legend(dimensions));
    let plan = SectionPlan::new(kind, dimensions, mesh, header.height());
    let drawing = plan.drawing(&outline);
    let mut sheet = Sheet::new(plan.axis + 34 * UNIT);
    sheet.draw(|area| header.draw(area));
    drawing.finish(&mut sheet);
    sheet.finish()
}

fn legend(d: &Dimensions) -> Vec<(Mark, String)> {
    let (low, high) = d.band();
    let bolts = format!("{} bolts, heads ø {}, holes ø {}", d.bolt_count, mm(2.0 * d.bolt_head_radius), mm(2.0 * d.bolt_hole_radius));
    vec![
        (Mark::Line(VERMILION, Dash::Solid), format!("belt on the flank, r {} to {}", mm(low), mm(high))),
        (Mark::Box(BRACKET), "bracket".to_owned()),
        (Mark::Box(BOLT), bolts),
        (Mark::Dot(BLUE), "check points".to_owned()),
        (Mark::None, "dimensions in mm".to_owned()),
    ]
}

fn mm(value: f64) -> String {
    significant(value, 4)
}

fn diameter(radius: f64) -> String {
    format!("ø {}", mm(2.0 * radius))
}

/// Where everything stands.
struct SectionPlan<'a> {
    kind: SectionKind,
    d: &'a Dimensions,
    mesh: &'a Mesh,
    scale: DrawingScale,
    /// Height of the axis on the paper.
    axis: i32,
    /// Ends of the section along the axis, mm.
    ends: (f64, f64),
    /// Its largest radius, mm.
    top: f64,
    header: i32,
}

impl<'a> SectionPlan<'a> {
    fn new(kind: SectionKind, d: &'a Dimensions, mesh: &'a Mesh, header: i32) -> Self {
        let z = |pick: fn(f64, f64) -> f64, start| mesh.nodes.iter().map(|node| node.x).fold(start, pick);
        let ends = (z(f64::min, f64::INFINITY), z(f64::max, f64::NEG_INFINITY));
        let top = mesh.nodes.iter().map(|node| node.y).fold(0.0, f64::max);
        let per_mm = (LARGEST.0 / (ends.1 - ends.0)).min(LARGEST.1 / top);
        let roof = header + 2 * ROW + 44 * UNIT;
        let axis = roof + (per_mm * top).round() as i32;
        let origin = DVec2::new(f64::from(WIDTH / 2) - per_mm * 0.5 * (ends.0 + ends.1), f64::from(axis));
        Self { kind, d, mesh, scale: DrawingScale { origin, per_mm }, axis, ends, top, header }
    }

    fn drawing(&self, outline: &[Vec<DVec2>]) -> Drawing {
        let mut drawing = Drawing::on(Box([10 * UNIT, self.header, WIDTH - 10 * UNIT, self.axis + 30 * UNIT]));
        let path: String = outline.iter().map(|part| self.scale.polygon(part.iter().copied())).collect();
        self.bracket(&mut drawing);
        drawing.insert(&filled(&path, STEEL, "1"));
        self.bolt(&mut drawing);
        drawing.insert(&stroked(&path, INK, 12, Dash::Solid));
        if self.kind == SectionKind::WeldedDiscs {
            let weld = [self.d.bore_radius, self.d.weld_radius].map(|r| self.scale.place(DVec2::new(self.d.thickness, r)));
            drawing.insert(&stroked(&format!("M{} {}V{}", weld[0].0, weld[0].1, weld[1].1), INK, 36, Dash::Solid));
        }
        let band = self.mesh.surface.iter().filter(|edge| edge.face == Face::Band).map(|edge| self.mesh.edge(edge));
        drawing.insert(&stroked(&self.scale.curves(band), VERMILION, 40, Dash::Solid));
        let sides = boundary(self.mesh).into_iter().map(|nodes| nodes.map(|node| self.scale.exact(self.mesh.nodes[node as usize])));
        drawing.solid(dense(sides));
        self.dimensions(&mut drawing);
        self.check_points(&mut drawing);
        drawing
    }

    /// The bracket behind the hub, hatched.
    fn bracket(&self, drawing: &mut Drawing) {
        let (d, depth) = (self.d, 0.09 * self.top);
        let corners = [(-depth, d.bore_radius), (0.0, d.bore_radius), (0.0, d.bracket_radius), (-depth, d.bracket_radius)];
        let [a, _, c, _] = corners.map(|(z, r)| self.scale.place(DVec2::new(z, r)));
        let path = self.scale.polygon(corners.map(|(z, r)| DVec2::new(z, r)));
        drawing.insert(&filled(&path, BRACKET, "1"));
        let (width, height) = (c.0 - a.0, a.1 - c.1);
        let mut lines = String::new();
        for start in (-height..width).step_by((9 * UNIT) as usize) {
            let (from, to) = ((-start).max(0), height.min(width - start));
            if to > from {
                lines += &format!("M{} {}l{2} -{2}", a.0 + start + from, a.1 - from, to - from);
            }
        }
        drawing.insert(&stroked(&lines, HATCH, 6, Dash::Solid));
        drawing.insert(&stroked(&path, GREY, 8, Dash::Solid));
        drawing.take(Box([a.0, c.1, c.0, a.1]));
    }

    /// One bolt: its head on the hub's front, its hole and its axis.
    fn bolt(&self, drawing: &mut Drawing) {
        let (d, front) = (self.d, self.front());
        let head = front + 0.7 * d.bolt_head_radius;
        let rectangle = |(z0, z1): (f64, f64), reach: f64| {
            let (low, high) = (d.bolt_circle_radius - reach, d.bolt_circle_radius + reach);
            [(z0, low), (z1, low), (z1, high), (z0, high)].map(|(z, r)| DVec2::new(z, r))
        };
        let depth = 0.09 * self.top;
        let hole = self.scale.polygon(rectangle((-depth, front), d.bolt_hole_radius));
        drawing.insert(&filled(&hole, BOLT, "0.7"));
        drawing.insert(&stroked(&hole, GREY, 8, Dash::Dashed));
        let corners = rectangle((front, head), d.bolt_head_radius);
        let path = self.scale.polygon(corners);
        drawing.insert(&filled(&path, BOLT, "1"));
        drawing.insert(&stroked(&path, GREY, 10, Dash::Solid));
        let [a, _, c, _] = corners.map(|corner| self.scale.place(corner));
        drawing.take(Box([a.0, c.1, c.0, a.1]));
        let at = |z: f64| self.scale.place(DVec2::new(z, d.bolt_circle_radius));
        drawing.line((at(-depth).0 - 6 * UNIT, at(0.0).1), (at(head).0 + 10 * UNIT, at(0.0).1), GREY, Dash::Centre);
    }

    /// z of the hub's front, mm.
    fn front(&self) -> f64 {
        if self.kind == SectionKind::WeldedDiscs { 2.0 * self.d.thickness } else { self.d.thickness }
    }

    /// Middles of the grooves, mm.
    fn grooves(&self) -> Vec<f64> {
        let bands = self.mesh.surface.iter().filter(|edge| edge.face == Face::Band);
        let across = |edge: &MeshEdge| {
            let [start, _, end] = self.mesh.edge(edge);
            let mean = self.d.mean_radius;
            let share = (mean - start.y) / (end.y - start.y);
            (0.0..=1.0).contains(&share).then_some(start.x + share * (end.x - start.x))
        };
        let mut flanks: Vec<f64> = bands.filter_map(across).collect();
        flanks.sort_by(f64::total_cmp);
        flanks.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
        flanks.chunks_exact(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect()
    }

    fn dimensions(&self, drawing: &mut Drawing) {
        let (d, scale) = (self.d, &self.scale);
        let place = |z: f64, r: f64| scale.place(DVec2::new(z, r));
        let (left, right) = (place(self.ends.0.min(-0.09 * self.top), 0.0).0, place(self.ends.1, 0.0).0);
        drawing.line((left - 4 * ROW, self.axis), (right + 3 * ROW, self.axis), INK, Dash::Centre);
        let mut inner = vec![(d.bore_radius, 0.0), (d.bolt_circle_radius, -0.09 * self.top), (d.bracket_radius, -0.09 * self.top)];
        if self.kind == SectionKind::WeldedDiscs {
            inner.push((d.weld_radius, 0.0));
        }
        inner[..].sort_by(|a, b| a.0.total_cmp(&b.0));
        for (column, (radius, z)) in inner.into_iter().enumerate() {
            let words = if radius == d.weld_radius { format!("weld {}", diameter(radius)) } else { diameter(radius) };
            drawing.half_diameter(place(z, radius), left - (column as i32 + 1) * ROW, self.axis, &words);
        }
        let grooves = self.grooves();
        for &groove in &grooves {
            let half = d.half_width(d.mean_radius);
            drawing.line(place(groove - half, d.mean_radius), place(groove + half, d.mean_radius), GREY, Dash::Centre);
        }
        if let Some(last) = grooves.last() {
            let flank = last + d.half_width(d.mean_radius);
            drawing.half_diameter(place(flank, d.mean_radius), right + ROW, self.axis, &format!("mean {}", diameter(d.mean_radius)));
        }
        drawing.half_diameter(self.outermost(|node| node.y), right + 2 * ROW, self.axis, &diameter(self.top));
        let roof = place(0.0, self.top).1;
        if let Some(&first) = grooves.first() {
            let half = 0.5 * d.groove_width;
            drawing.across(place(first - half, d.top_radius()), place(first + half, d.top_radius()), roof - 24 * UNIT, &mm(d.groove_width));
            self.angle(drawing, first);
        }
        let (from, to) = (self.outermost(|node| -node.x), self.outermost(|node| node.x));
        drawing.across(from, to, roof - 24 * UNIT - ROW, &mm(self.ends.1 - self.ends.0));
        let words = match self.kind {
            SectionKind::WeldedDiscs => format!("2 × {}", mm(d.thickness)),
            _ => mm(d.thickness),
        };
        let below = place(0.0, d.bore_radius).1 + 22 * UNIT;
        drawing.across(place(0.0, d.bore_radius), place(self.front(), d.bore_radius), below, &words);
    }

    /// Of the nodes that are furthest out in a direction, the one with the largest radius, on the paper.
    fn outermost(&self, measure: impl Fn(&DVec2) -> f64) -> (i32, i32) {
        let most = self.mesh.nodes.iter().map(&measure).fold(f64::NEG_INFINITY, f64::max);
        let there = self.mesh.nodes.iter().filter(|node| measure(node) > most - 1e-6);
        let furthest = there.fold(DVec2::ZERO, |best, node| if node.y + 1e-9 * node.x > best.y + 1e-9 * best.x { *node } else { best });
        self.scale.place(furthest)
    }

    /// The groove's angle: an arc between its flanks near the top, with the value below.
    fn angle(&self, drawing: &mut Drawing, groove: f64) {
        let d = self.d;
        let apex = d.top_radius() - 0.5 * d.groove_width / libm::tan(d.half_angle);
        let reach = d.top_radius() - 0.1 * d.groove_height - apex;
        let (sine, cosine) = (libm::sin(d.half_angle), libm::cos(d.half_angle));
        let end = |side: f64| DVec2::new(groove + side * reach * sine, apex + reach * cosine);
        let [from, to] = [end(-1.0), end(1.0)].map(|at| self.scale.place(at));
        let radius = (reach * self.scale.per_mm).round() as i32;
        let arc = format!("M{} {}A{radius} {radius} 0 0 1 {} {}", from.0, from.1, to.0, to.1);
        drawing.insert(&stroked(&arc, GREY, 8, Dash::Solid));
        drawing.arrow(from, DVec2::new(-cosine, sine));
        drawing.arrow(to, DVec2::new(cosine, sine));
        let middle = self.scale.place(DVec2::new(groove, apex + reach));
        drawing.word(&format!("{}°", mm(2.0 * d.half_angle.to_degrees())), INK, (middle.0, middle.1 + 12 * UNIT), false);
    }

    fn check_points(&self, drawing: &mut Drawing) {
        for point in &self.mesh.points {
            let at = self.mesh.nodes[point.node as usize];
            drawing.label(point.name, BLUE, self.scale.exact(at), outwards(self.mesh, point.node));
        }
        for point in &self.mesh.points {
            let (x, y) = rounded(self.scale.exact(self.mesh.nodes[point.node as usize]));
            drawing.insert(&dot(x, y, BLUE));
        }
    }
}

/// A dot with a white rim.
fn dot(x: i32, y: i32, RGBColor(r, g, b): RGBColor) -> String {
    format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"36\" fill=\"#{r:02X}{g:02X}{b:02X}\" stroke=\"#FFFFFF\" stroke-width=\"12\"/>\n")
}

/// Direction on the paper away from the material at a node of the surface.
pub(super) fn outwards(mesh: &Mesh, node: u32) -> DVec2 {
    let edges = mesh.surface.iter().filter(|edge| edge.nodes.contains(&node));
    let sum: DVec2 = edges
        .map(|edge| {
            let [start, _, end] = mesh.edge(edge);
            let along = (end - start).normalize();
            // The material lies on the right; on the paper r is up.
            DVec2::new(-along.y, -along.x)
        })
        .sum();
    sum.try_normalize().unwrap_or(DVec2::X)
}

#[cfg(test)]
mod tests {
    use super::super::super::sheet::tests::assert_svg;
    use super::*;
    use crate::pulley::fixtures;
    use crate::pulley::section::{Fineness, mesh};

    #[test]
    fn every_type_shows_its_dimensions_and_check_points_side_by_side() {
        for (kind, d) in fixtures::sections() {
            let mesh = mesh(kind, &d, &Fineness::USUAL).unwrap();
            let svg = section("a <pulley>", kind, &d, &mesh);
            assert_svg(&svg);
            let shown = |words: &str| svg.matches(&format!("\n{words}\n")).count();
            for point in &mesh.points {
                assert_eq!(shown(point.name), 1, "{kind:?} {}", point.name);
            }
            let width = mesh.nodes.iter().map(|node| node.x).fold(f64::NEG_INFINITY, f64::max)
                - mesh.nodes.iter().map(|node| node.x).fold(f64::INFINITY, f64::min);
            let of = |radius: f64| significant(2.0 * radius, 4);
            for words in [
                format!("ø {}", of(d.bore_radius)),
                format!("ø {}", of(d.bolt_circle_radius)),
                format!("ø {}", of(d.bracket_radius)),
                format!("mean ø {}", of(d.mean_radius)),
                "36°".to_owned(),
                significant(d.groove_width, 4),
                significant(width, 4),
            ] {
                assert_eq!(shown(&words), 1, "{kind:?} {words}");
            }
            let plan = SectionPlan::new(kind, &d, &mesh, 0);
            assert_eq!(plan.drawing(&checked_outline(kind, &d).unwrap().parts).overlap(), None, "{kind:?}");
            assert_eq!(plan.grooves().len(), kind.grooves() as usize);
        }
    }

    #[test]
    fn an_impossible_section_says_why() {
        let (kind, d) = fixtures::sections()[3];
        let mesh = mesh(kind, &d, &Fineness::USUAL).unwrap();
        let svg = section("", kind, &Dimensions { floor_bend_radius: 0.0, ..d }, &mesh);
        assert_svg(&svg);
        assert!(svg.contains("inside radius of bend E"), "{svg}");
    }
}
