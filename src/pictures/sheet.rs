//! The sheet of paper that a picture is drawn on.
//!
//! plotters places everything on whole pixels, which makes smooth curves look like stairs. So a sheet is drawn in tenths of a pixel
//! ([`UNIT`]) and shown at a tenth of that size by its view box. plotters writes each layer; what it cannot draw (thousands of dots in
//! one path, an image without smoothing) is inserted between layers as SVG text.

use plotters::coord::Shift;
use plotters::prelude::*;

/// Units of paper in a pixel.
pub(super) const UNIT: i32 = 10;
/// Width of every picture, in units of paper.
pub(super) const WIDTH: i32 = 900 * UNIT;

/// A point on the paper, in its units.
pub(super) type Point = (i32, i32);
pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type Drawn<T = ()> = Result<T, DrawingAreaErrorKind<std::io::Error>>;

/// A rectangle on the paper, in its units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub left: i32,
    pub top: i32,
    pub width: i32,
    pub height: i32,
}

impl Frame {
    pub fn right(self) -> i32 {
        self.left + self.width
    }
    pub fn bottom(self) -> i32 {
        self.top + self.height
    }
    pub fn corners(self) -> [(i32, i32); 2] {
        [(self.left, self.top), (self.right(), self.bottom())]
    }
    pub fn middle(self) -> (i32, i32) {
        (self.left + self.width / 2, self.top + self.height / 2)
    }
}

/// A picture that grows layer by layer.
pub(super) struct Sheet {
    height: i32,
    body: String,
}

impl Sheet {
    /// White paper, `height` in units.
    pub fn new(height: i32) -> Self {
        let body = String::new();
        let mut sheet = Self { height, body };
        sheet.draw(|area| area.fill(&WHITE));
        sheet
    }

    /// Adds what `layer` draws with plotters on top of what is there.
    pub fn draw<T>(&mut self, layer: impl FnOnce(&Area<'_>) -> Drawn<T>) -> T {
        let mut text = String::new();
        let size = (WIDTH as u32, self.height as u32);
        let area = SVGBackend::with_string(&mut text, size).into_drawing_area();
        let drawn = layer(&area).expect("writing into a string does not fail");
        drop(area);
        // Each layer is a document of its own; only its contents become part of the picture.
        let inside = text
            .split_once(">\n")
            .and_then(|(_, rest)| rest.strip_suffix("</svg>\n"))
            .expect("plotters wraps its elements in one svg element");
        self.body.push_str(inside);
        drawn
    }

    /// Adds SVG elements as they are.
    pub fn insert(&mut self, elements: &str) {
        self.body.push_str(elements);
    }

    /// The whole file.
    pub fn finish(self) -> String {
        let (width, height) = (WIDTH, self.height);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" \
             viewBox=\"0 0 {width} {height}\">\n{}</svg>\n",
            width / UNIT,
            height / UNIT,
            self.body,
        )
    }
}

/// Solid or dashed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Dash {
    Solid,
    Dashed,
    Dotted,
    /// Long and short strokes, as of axes and middle lines.
    Centre,
}

impl Dash {
    /// Lengths of strokes and gaps, in units of paper. plotters can break lines too, but into an
    /// element for each stroke, and it measures them with the system's `hypot`.
    fn attributes(self) -> &'static str {
        match self {
            Dash::Solid => "stroke-linecap=\"round\"",
            Dash::Dashed => "stroke-dasharray=\"70 40\"",
            Dash::Dotted => "stroke-dasharray=\"20 30\"",
            Dash::Centre => "stroke-dasharray=\"160 40 20 40\"",
        }
    }
}

/// A path element from its path data, for [`Sheet::insert`]; `width` in units of paper.
pub(super) fn stroked(path: &str, colour: RGBColor, width: i32, dash: Dash) -> String {
    let (RGBColor(r, g, b), dash) = (colour, dash.attributes());
    format!(
        "<path d=\"{path}\" fill=\"none\" stroke=\"#{r:02X}{g:02X}{b:02X}\" \
         stroke-width=\"{width}\" {dash} stroke-linejoin=\"round\"/>\n"
    )
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Panics unless the text is a well-formed, self-contained SVG document, as far as a few lines can check: tags closed in order, no
    /// stray markup, no unknown entity.
    pub fn assert_svg(svg: &str) {
        let mut open = Vec::new();
        let mut rest = svg;
        while let Some(start) = rest.find('<') {
            let (before, after) = rest.split_at(start);
            assert_text(before);
            let end = after.find('>').expect("every tag ends");
            let tag = &after[1..end];
            assert!(!tag.contains('<'), "markup inside a tag: {tag}");
            match tag.strip_prefix('/') {
                Some(name) => assert_eq!(open.pop(), Some(name)),
                None if tag.ends_with('/') => {}
                None => open.push(tag.split(' ').next().expect("a tag has a name")),
            }
            assert_eq!(tag.matches('"').count() % 2, 0, "quotes in {tag}");
            assert_text(tag);
            rest = &after[end + 1..];
        }
        assert!(open.is_empty(), "left open: {open:?}");
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
        assert!(!svg.contains("NaN") && !svg.contains("inf\""));
        let own = svg.replace("http://www.w3.org/2000/svg", "");
        assert!(!own.contains("http"), "loads something from elsewhere");
    }

    fn assert_text(text: &str) {
        assert!(!text.contains(|c: char| c.is_control() && c != '\n'));
        for (at, _) in text.match_indices('&') {
            let entities = ["&lt;", "&gt;", "&amp;", "&quot;", "&apos;"];
            assert!(entities.iter().any(|entity| text[at..].starts_with(entity)));
        }
    }

    #[test]
    fn the_check_objects_to_broken_documents() {
        let broken = |svg: &'static str| std::panic::catch_unwind(move || assert_svg(svg)).is_err();
        assert!(!broken("<svg x=\"1\"><g/></svg>\n"));
        assert!(broken("<svg x=\"1\"><g></svg>\n"));
        assert!(broken("<svg x=\"1\">a & b</svg>\n"));
        assert!(broken("<svg x=\"1\">a\u{1}</svg>\n"));
        assert!(broken("<svg x=\"1\"><a href=\"https://e.org\"/></svg>\n"));
    }

    #[test]
    fn layers_join_in_order_on_paper_in_tenths_of_a_pixel() {
        let mut sheet = Sheet::new(50 * UNIT);
        sheet.insert("<g/>\n");
        sheet.draw(|area| area.draw(&Circle::new((7, 8), 9, BLACK.filled())));
        let svg = sheet.finish();
        assert_svg(&svg);
        assert!(svg.contains("width=\"900\" height=\"50\" viewBox=\"0 0 9000 500\""));
        let place = |text| svg.find(text).expect("drawn");
        assert!(place("<rect") < place("<g/>") && place("<g/>") < place("<circle cx=\"7\""));
    }
}
