//! The picture of a histogram.

use super::axis::{Numbers, PlotAxis};
use super::colours::{BLUE, INK, LIGHT_BLUE};
use super::header::{Header, Mark, sentence};
use super::panel::{LABEL_TEXT, Panel, PanelPlan, axis_label, x_labels_height, y_labels_width};
use super::range::bounds;
use super::sheet::{Area, Drawn, Frame, Sheet, UNIT, WIDTH};
use super::words::text;
use super::{PlotQuantity, number};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// Height of the panel, in units of paper.
const HEIGHT: i32 = 380 * UNIT;
/// Gap between the bins and the bar for designs outside, and the width of that bar, as fractions of the range of the bins.
const GAP: f64 = 0.03;
const FLANK: f64 = 0.045;

/// Draws a histogram of `counts.len()` bins of equal width over `from` to `to`, in the unit of
/// `quantity`, and a lighter bar at either end for the designs `below` and `above` that range.
///
/// A bar at the end that would dwarf the bins is cut off; the legend gives its count. If nothing is counted at all, the picture says that
/// no design is feasible.
pub fn histogram(title: &str, quantity: &PlotQuantity, from: f64, to: f64, counts: &[u64], below: u64, above: u64) -> String {
    let total = counts.iter().chain([&below, &above]);
    let total = total.fold(0, |sum: u64, &c| sum.saturating_add(c));
    let Some((from, to)) = bounds([from, to].into_iter(), 0.0).filter(|_| total > 0) else {
        return sentence(title, "no feasible design");
    };
    let bars = Bars { from, to, counts, below, above };
    let header = Header::new(title, bars.legend(quantity, total));
    let designs = PlotQuantity::new("designs", "");
    let y = PlotAxis::counts(bars.top() * 1.04, HEIGHT);
    let y_label = axis_label(&designs, &y, HEIGHT);
    let left = 12 * UNIT + y_labels_width(y.label_width(), &y_label);
    let width = WIDTH - left - 30 * UNIT;
    let x = PlotAxis::horizontal(bars.range(), width, 20 * UNIT, Numbers::Long).within(from, to);
    let x_label = axis_label(quantity, &x, width * 3 / 4);
    let frame = Frame { left, top: header.height(), width, height: HEIGHT };
    let mut sheet = Sheet::new(frame.bottom() + x_labels_height(&x_label) + 14 * UNIT);
    sheet.draw(|area| {
        header.draw(area)?;
        let panel =
            PanelPlan { frame, x: &x, y: &y, x_label: Some(&x_label), y_label: Some(&y_label), tick_room: y.label_width(), grid: true };
        bars.draw(area, &panel.draw(area)?, frame)
    });
    sheet.finish()
}

struct Bars<'a> {
    from: f64,
    to: f64,
    counts: &'a [u64],
    below: u64,
    above: u64,
}

impl Bars<'_> {
    fn legend(&self, quantity: &PlotQuantity, total: u64) -> Vec<(Mark, String)> {
        let inside = self.counts.iter().fold(0, |sum: u64, &c| sum.saturating_add(c));
        let unit = match quantity.unit.is_empty() {
            true => String::new(),
            false => format!(" {}", quantity.plain_unit()),
        };
        let [from, to] = [self.from, self.to].map(|v| number::significant(v, 6));
        let entry = |name: String, count| format!("{name}: {}", number::count(count));
        vec![
            (Mark::Box(BLUE), entry(format!("{from} to {to}{unit}"), inside)),
            (Mark::Box(LIGHT_BLUE), entry("below".to_owned(), self.below)),
            (Mark::Box(LIGHT_BLUE), entry("above".to_owned(), self.above)),
            (Mark::None, entry("all designs".to_owned(), total)),
        ]
    }

    fn span(&self) -> f64 {
        self.to - self.from
    }

    /// Range of the axis: the bins and a flank at either end.
    fn range(&self) -> (f64, f64) {
        let outside = (2.0 * GAP + FLANK) * self.span();
        (self.from - outside, self.to + outside)
    }

    /// Height of the axis. Flanks may be up to twice as high as the highest bin.
    fn top(&self) -> f64 {
        let highest = self.counts.iter().copied().max().unwrap_or(0);
        let flank = self.below.max(self.above);
        if highest == 0 {
            return flank as f64;
        }
        highest.max(flank.min(highest.saturating_mul(2))) as f64
    }

    fn draw(&self, area: &Area<'_>, panel: &Panel<'_>, frame: Frame) -> Drawn {
        self.draw_bins(area, panel)?;
        let place = |x: f64, count: f64| panel.backend_coord(&(x, count));
        let (gap, flank) = (GAP * self.span(), FLANK * self.span());
        let style = text(LABEL_TEXT, INK, HPos::Center, VPos::Top);
        // On the line of the axis label, below the tick labels.
        let line = frame.bottom() + x_labels_height(&[]) + 3 * UNIT;
        for (start, count, name) in [(self.from - gap - flank, self.below, "below"), (self.to + gap, self.above, "above")] {
            let shown = (count as f64).min(self.top());
            let (left, right) = (place(start, shown), place(start + flank, 0.0));
            if count > 0 {
                // Even a single design is visible.
                let top = left.1.min(right.1 - UNIT);
                let corners = [(left.0, top), right];
                area.draw(&Rectangle::new(corners, LIGHT_BLUE.filled()))?;
            }
            if count as f64 > self.top() {
                // Two white slashes: the bar is cut off.
                let stroke = WHITE.stroke_width(3 * UNIT as u32);
                for down in [18 * UNIT, 26 * UNIT] {
                    let y = left.1 + down;
                    let ends = [(left.0 - UNIT, y), (right.0 + UNIT, y - 10 * UNIT)];
                    area.draw(&PathElement::new(ends, stroke))?;
                }
            }
            area.draw_text(name, &style, ((left.0 + right.0) / 2, line))?;
        }
        Ok(())
    }

    fn draw_bins(&self, area: &Area<'_>, panel: &Panel<'_>) -> Drawn {
        let bins = self.counts.len() as f64;
        let edge = |i: usize| self.from + self.span() * (i as f64 / bins);
        let place = |x: f64, count: f64| panel.backend_coord(&(x, count));
        if self.counts.is_empty() {
            return Ok(());
        }
        if place(edge(1), 0.0).0 - place(edge(0), 0.0).0 <= 5 * UNIT {
            // Narrow bars are drawn as one shape; otherwise each would have blurred edges.
            let tops = self.counts.iter().enumerate();
            let tops = tops.flat_map(|(i, &c)| [(edge(i), c as f64), (edge(i + 1), c as f64)]);
            let shape = std::iter::once((self.from, 0.0)).chain(tops);
            let shape = shape.chain([(self.to, 0.0)]).map(|(x, y)| place(x, y));
            return area.draw(&Polygon::new(shape.collect::<Vec<_>>(), BLUE.filled()));
        }
        for (i, &count) in self.counts.iter().enumerate().filter(|(_, c)| **c > 0) {
            let (left, right) = (place(edge(i), count as f64), place(edge(i + 1), 0.0));
            let gap = UNIT / 2;
            let corners = [(left.0 + gap, left.1), (right.0 - gap, right.1)];
            area.draw(&Rectangle::new(corners, BLUE.filled()))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::sheet::tests::assert_svg;
    use super::*;

    fn draw(range: (f64, f64), counts: &[u64], below: u64, above: u64) -> String {
        let force = PlotQuantity::new("axial_force_N", "N");
        let picture = || histogram("a < b", &force, range.0, range.1, counts, below, above);
        let svg = picture();
        assert_svg(&svg);
        assert_eq!(svg, picture());
        assert!(svg.contains("a &lt; b"));
        svg
    }

    /// Heights of the filled bars of a colour, in units of paper, without legend and paper.
    fn bars(svg: &str, RGBColor(r, g, b): RGBColor) -> Vec<i32> {
        let fill = format!("fill=\"#{r:02X}{g:02X}{b:02X}\"");
        let bars = svg.lines().filter(|line| line.starts_with("<rect") && line.contains(&fill));
        let height = |line: &str| line.split("height=\"").nth(1)?.split('"').next()?.parse().ok();
        let heights = bars.map(|line| height(line).expect("a height"));
        // The legend's box is 12 pixels high.
        heights.filter(|&h| h != 12 * UNIT).collect()
    }

    #[test]
    fn bars_are_as_high_as_their_counts() {
        let svg = draw((0.0, 3.0), &[10, 0, 20], 5, 15);
        let blue = bars(&svg, BLUE);
        assert_eq!(blue.len(), 2, "an empty bin has no bar");
        assert!((blue[1] - 2 * blue[0]).abs() <= 2);
        let light = bars(&svg, LIGHT_BLUE);
        assert!((light[1] - 3 * light[0]).abs() <= 3);
        assert!((light[0] * 2 - blue[0]).abs() <= 2);
        for text in ["0 to 3 N: 30", "below: 5", "above: 15", "all designs: 50"] {
            assert!(svg.contains(text), "{text}");
        }
    }

    #[test]
    fn a_flank_that_would_dwarf_the_bins_is_cut_openly() {
        let cut = draw((0.0, 3.0), &[10, 20], 0, 5000);
        assert_eq!(bars(&cut, LIGHT_BLUE).len(), 1);
        assert!(bars(&cut, LIGHT_BLUE)[0] < 3 * bars(&cut, BLUE)[1]);
        assert!(cut.contains("above: 5 000"));
        let slashes = |svg: &str| svg.matches("stroke=\"#FFFFFF\"").count();
        assert_eq!(slashes(&cut), 2);
        assert_eq!(slashes(&draw((0.0, 3.0), &[10, 20], 0, 40)), 0);
    }

    #[test]
    fn degenerate_histograms_give_a_picture() {
        for range in [(0.0, 0.0), (1e-12, 2e-12), (0.0, 1e12), (3.0, 1.0)] {
            for counts in [&[][..], &[0], &[1], &[u64::MAX, 0], &[1; 5000]] {
                for (below, above) in [(0, 0), (0, 1), (u64::MAX, u64::MAX)] {
                    let svg = draw(range, counts, below, above);
                    let empty = (below, above) == (0, 0) && counts.iter().all(|&c| c == 0);
                    assert_eq!(svg.contains("no feasible design"), empty);
                }
            }
        }
    }
}
