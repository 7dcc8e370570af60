//! A section on paper: equal scale on both axes, filled shapes, dimension lines, and words that keep clear of what is there.

use super::super::colours::{GREY, INK};
use super::super::sheet::{Dash, Drawn, Point, Sheet, UNIT, stroked};
use super::super::words::{line_height, text, text_width};
use glam::DVec2;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use std::fmt::Write;

/// Height of the words in a drawing, in pixels.
pub(super) const TEXT: i32 = 12;
const ARROW: f64 = 90.0;
/// Radius around a labelled place that its line leaves free for a mark.
const MARK: f64 = 50.0;

/// Where a place of the section, (z, r) in mm, stands on the paper.
#[derive(Clone, Copy, Debug)]
pub(super) struct DrawingScale {
    /// Paper of z = 0 on the axis.
    pub origin: DVec2,
    /// Units of paper per mm.
    pub per_mm: f64,
}

impl DrawingScale {
    pub fn exact(&self, at: DVec2) -> DVec2 {
        DVec2::new(self.origin.x + self.per_mm * at.x, self.origin.y - self.per_mm * at.y)
    }

    pub fn place(&self, at: DVec2) -> Point {
        rounded(self.exact(at))
    }

    /// Path data of a closed polygon.
    pub fn polygon(&self, points: impl IntoIterator<Item = DVec2>) -> String {
        let mut path = String::new();
        for (number, at) in points.into_iter().enumerate() {
            let (x, y) = self.place(at);
            write!(path, "{}{x} {y}", if number == 0 { 'M' } else { 'L' }).expect("writing into a string does not fail");
        }
        path + "Z"
    }

    /// Path data of curves through start, middle and end, each a parabola as sides of elements are.
    pub fn curves(&self, sides: impl IntoIterator<Item = [DVec2; 3]>) -> String {
        let mut path = String::new();
        let mut last = None;
        for [start, middle, end] in sides {
            let (from, to) = (self.place(start), self.place(end));
            let (x, y) = self.place(2.0 * middle - 0.5 * (start + end));
            if last != Some(from) {
                write!(path, "M{} {}", from.0, from.1).expect("writing into a string does not fail");
            }
            write!(path, "Q{x} {y} {} {}", to.0, to.1).expect("writing into a string does not fail");
            last = Some(to);
        }
        path
    }
}

pub(super) fn rounded(at: DVec2) -> Point {
    (at.x.round() as i32, at.y.round() as i32)
}

/// A path element filled with a colour.
pub(super) fn filled(path: &str, RGBColor(r, g, b): RGBColor, opacity: &str) -> String {
    format!("<path d=\"{path}\" fill=\"#{r:02X}{g:02X}{b:02X}\" fill-opacity=\"{opacity}\" fill-rule=\"evenodd\"/>\n")
}

/// A rectangle on the paper: left, top, right, bottom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Box(pub [i32; 4]);

impl Box {
    pub fn around(middle: Point, width: i32, height: i32) -> Self {
        let (left, top) = (middle.0 - width / 2, middle.1 - height / 2);
        Self([left, top, left + width, top + height])
    }
    pub fn meets(&self, other: &Self) -> bool {
        let ([a, b, c, d], [e, f, g, h]) = (self.0, other.0);
        a < g && e < c && b < h && f < d
    }
    fn holds(&self, at: DVec2) -> bool {
        let [left, top, right, bottom] = self.0.map(f64::from);
        left <= at.x && at.x <= right && top <= at.y && at.y <= bottom
    }
    fn middle(&self) -> DVec2 {
        let [left, top, right, bottom] = self.0.map(f64::from);
        DVec2::new(0.5 * (left + right), 0.5 * (top + bottom))
    }
    fn corners(&self) -> [DVec2; 4] {
        let [left, top, right, bottom] = self.0.map(f64::from);
        [DVec2::new(left, top), DVec2::new(right, top), DVec2::new(right, bottom), DVec2::new(left, bottom)]
    }
}

/// Words at a place of the paper.
#[derive(Clone, Debug)]
struct Word {
    text: String,
    colour: RGBColor,
    middle: Point,
    upwards: bool,
}

/// A drawing before it goes on a sheet.
#[derive(Default)]
pub(super) struct Drawing {
    elements: String,
    words: Vec<Word>,
    /// Where words and lines stand that others must not cover.
    taken: Vec<Box>,
    /// Outlines on the paper, closed.
    solid: Vec<Vec<DVec2>>,
    /// Outside of this no word is placed.
    paper: Option<Box>,
}

impl Drawing {
    /// Nothing yet, on a part of the paper.
    pub fn on(paper: Box) -> Self {
        Self { paper: Some(paper), ..Self::default() }
    }

    pub fn insert(&mut self, element: &str) {
        self.elements.push_str(element);
    }

    /// Declares a shape that labels keep clear of.
    pub fn solid(&mut self, outline: Vec<DVec2>) {
        self.solid.push(outline);
    }

    pub fn take(&mut self, taken: Box) {
        self.taken.push(taken);
    }

    /// A thin line that words keep clear of.
    pub fn line(&mut self, from: Point, to: Point, colour: RGBColor, dash: Dash) {
        let path = format!("M{} {}L{} {}", from.0, from.1, to.0, to.1);
        self.elements.push_str(&stroked(&path, colour, 8, dash));
        let steps = ((from.0 - to.0).abs().max((from.1 - to.1).abs()) / (6 * UNIT)).max(1);
        for step in 0..=steps {
            let at = (from.0 + (to.0 - from.0) * step / steps, from.1 + (to.1 - from.1) * step / steps);
            self.taken.push(Box::around(at, 2 * UNIT, 2 * UNIT));
        }
    }

    /// An arrow head with its tip at a place, pointing along `way`.
    pub fn arrow(&mut self, tip: Point, way: DVec2) {
        let (way, tip) = (way.normalize(), DVec2::new(f64::from(tip.0), f64::from(tip.1)));
        let base = tip - way * ARROW;
        let side = way.perp() * (0.3 * ARROW);
        let [a, b, c] = [tip, base + side, base - side].map(rounded);
        self.elements.push_str(&filled(&format!("M{} {}L{} {}L{} {}Z", a.0, a.1, b.0, b.1, c.0, c.1), INK, "1"));
    }

    /// A horizontal dimension at the height `y`, with extension lines from two places; the words stand above it, or to its right
    /// where there is no room between the arrows.
    pub fn across(&mut self, from: Point, to: Point, y: i32, words: &str) {
        for end in [from, to] {
            let beyond = if y < end.1 { -4 * UNIT } else { 4 * UNIT };
            self.line((end.0, end.1 + beyond / 2), (end.0, y + beyond), GREY, Dash::Solid);
        }
        let width = text_width(words, TEXT);
        if to.0 - from.0 > 3 * ARROW as i32 {
            self.line((from.0, y), (to.0, y), GREY, Dash::Solid);
            self.arrow((from.0, y), -DVec2::X);
            self.arrow((to.0, y), DVec2::X);
        } else {
            // Narrow: the arrows point from outside.
            self.line((from.0 - 20 * UNIT, y), (to.0 + 20 * UNIT, y), GREY, Dash::Solid);
            self.arrow((from.0, y), DVec2::X);
            self.arrow((to.0, y), -DVec2::X);
        }
        if to.0 - from.0 > width + 4 * UNIT {
            self.word(words, INK, ((from.0 + to.0) / 2, y - 9 * UNIT), false);
        } else {
            self.word(words, INK, (to.0 + 24 * UNIT + width / 2, y), false);
        }
    }

    /// Half a diameter: a line upwards from the axis at `x` to the height of a place, with an extension line from there.
    pub fn half_diameter(&mut self, to: Point, x: i32, axis: i32, words: &str) {
        let beyond = if x < to.0 { -4 * UNIT } else { 4 * UNIT };
        self.line((to.0 + beyond / 2, to.1), (x + beyond, to.1), GREY, Dash::Solid);
        self.line((x, axis), (x, to.1), GREY, Dash::Solid);
        self.arrow((x, to.1), -DVec2::Y);
        let room = axis - to.1;
        // Short lines have their words in the middle, longer ones all at the same height.
        let middle = axis - (room / 2).min(text_width(words, TEXT) / 2 + 40 * UNIT).max(text_width(words, TEXT) / 2);
        self.word(words, INK, (x - 9 * UNIT, middle), true);
    }

    /// Words around a place, where they are taken to have room.
    pub fn word(&mut self, words: &str, colour: RGBColor, middle: Point, upwards: bool) {
        let (width, height) = (text_width(words, TEXT) + 4 * UNIT, line_height(TEXT));
        let (width, height) = if upwards { (height, width) } else { (width, height) };
        self.taken.push(Box::around(middle, width, height));
        self.words.push(Word { text: words.to_owned(), colour, middle, upwards });
    }

    /// Words near a place with a line to it: as near as possible, rather towards `out`, clear of shapes, lines and other words.
    pub fn label(&mut self, words: &str, colour: RGBColor, at: DVec2, out: DVec2) {
        let (width, height) = (text_width(words, TEXT) + 4 * UNIT, line_height(TEXT));
        let mut best: Option<(f64, Box)> = None;
        for distance in [14, 20, 28, 38, 50, 64, 80, 98, 118, 140].map(|it| f64::from(it * UNIT)) {
            for turn in [0_i32, 20, -20, 40, -40, 60, -60, 85, -85, 110, -110, 140, -140] {
                let angle = f64::from(turn).to_radians();
                let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
                let way = DVec2::new(cosine * out.x - sine * out.y, sine * out.x + cosine * out.y);
                // The box touches the circle of this distance with its near side.
                let reach = distance + way.x.abs() * f64::from(width / 2) + way.y.abs() * f64::from(height / 2);
                let place = Box::around(rounded(at + way * reach), width, height);
                let cost = 1000.0 * self.burden(&place, at) + distance / f64::from(UNIT) + f64::from(turn.abs()) / 10.0;
                if best.is_none_or(|(least, _)| cost < least) {
                    best = Some((cost, place));
                }
            }
        }
        let Some((_, place)) = best else { return };
        let middle = place.middle();
        // The line ends at the box's edge.
        let way = middle - at;
        let share = (0.5 * f64::from(width) / way.x.abs().max(1.0)).min(0.5 * f64::from(height) / way.y.abs().max(1.0));
        let from = at + way.normalize_or_zero() * MARK;
        let (from, to) = (rounded(from), rounded(middle - way * share.min(1.0)));
        self.line(from, to, colour, Dash::Solid);
        self.word(words, colour, rounded(middle), false);
    }

    /// How many things a box with a line to a place would cover.
    fn burden(&self, place: &Box, at: DVec2) -> f64 {
        let mut burden = self.taken.iter().filter(|taken| taken.meets(place)).count() as f64;
        if let Some(Box([left, top, right, bottom])) = self.paper {
            let [a, b, c, d] = place.0;
            burden += if a < left || b < top || c > right || d > bottom { 50.0 } else { 0.0 };
        }
        for outline in &self.solid {
            let covered = outline.iter().filter(|point| place.holds(**point)).count();
            let hidden = place.corners().iter().chain([&place.middle()]).filter(|corner| inside(outline, **corner)).count();
            burden += (covered + hidden) as f64;
            let way = place.middle() - at;
            let length = way.length();
            // Right at the surface the line may start inside.
            for step in 1..=16 {
                let on = at + way * (f64::from(step) / 16.0);
                if length * f64::from(step) / 16.0 > 3.0 * f64::from(UNIT) && inside(outline, on) {
                    burden += 1.0;
                }
            }
        }
        let way = place.middle() - at;
        for step in 4..=12 {
            let on = rounded(at + way * (f64::from(step) / 12.0));
            let dot = Box::around(on, UNIT, UNIT);
            burden += 0.5 * self.taken.iter().filter(|taken| taken.meets(&dot)).count() as f64;
        }
        burden
    }

    /// Puts lines on the sheet, then words on a white halo so that lines do not run through them.
    pub fn finish(self, sheet: &mut Sheet) {
        sheet.insert(&self.elements);
        sheet.draw(|area| {
            for word in &self.words {
                let style = text(TEXT, word.colour, HPos::Center, VPos::Center);
                let style = if word.upwards { style.transform(FontTransform::Rotate270) } else { style };
                area.draw_text(&word.text, &style, word.middle)?;
            }
            Drawn::Ok(())
        });
    }

    /// Do any two words overlap?
    #[cfg(test)]
    pub fn overlap(&self) -> Option<(String, String)> {
        let boxes = self.words.iter().map(|word| {
            let (width, height) = (text_width(&word.text, TEXT), TEXT * UNIT);
            let (width, height) = if word.upwards { (height, width) } else { (width, height) };
            (Box::around(word.middle, width, height), &word.text)
        });
        let boxes: Vec<_> = boxes.collect();
        boxes.iter().enumerate().find_map(|(number, (own, text))| {
            let other = boxes[..number].iter().find(|(other, _)| own.meets(other))?;
            Some((other.1.clone(), (*text).clone()))
        })
    }
}

/// Is a point inside a closed polygon?
fn inside(outline: &[DVec2], at: DVec2) -> bool {
    let mut inside = false;
    for (number, a) in outline.iter().enumerate() {
        let b = outline[(number + 1) % outline.len()];
        if (a.y > at.y) != (b.y > at.y) && at.x < a.x + (b.x - a.x) * (at.y - a.y) / (b.y - a.y) {
            inside = !inside;
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_crowded_around_one_place_stay_apart_and_outside_the_shape() {
        let mut drawing = Drawing::default();
        let square = [(0.0, 0.0), (900.0, 0.0), (900.0, 900.0), (0.0, 900.0)].map(|(x, y)| DVec2::new(x, y));
        drawing.solid(square.to_vec());
        for name in ["Bl", "Br", "Cl", "Cr"] {
            drawing.label(name, INK, DVec2::new(900.0, 450.0), DVec2::X);
        }
        assert_eq!(drawing.overlap(), None);
        assert!(drawing.words.iter().all(|word| word.middle.0 > 900));
    }

    #[test]
    fn the_check_objects_to_words_on_top_of_each_other() {
        let mut drawing = Drawing::default();
        drawing.word("one", INK, (500, 500), false);
        drawing.word("two", INK, (560, 520), false);
        assert_eq!(drawing.overlap(), Some(("one".to_owned(), "two".to_owned())));
    }
}
