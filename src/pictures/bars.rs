//! The pictures of shares and of a tornado: bars beside each other from left to right, one row for each input.

use super::axis::{Numbers, PlotAxis, TICK_TEXT};
use super::colours::{BLUE, GREY, INK, LINES, VERMILION};
use super::header::{Header, Mark, sentence};
use super::panel::{Panel, PanelPlan, axis_label, x_labels_height, y_labels_width};
use super::range::bounds;
use super::sheet::{Area, Dash, Drawn, Frame, Sheet, UNIT, WIDTH};
use super::words::{clean, shortened, text};
use super::{PlotQuantity, number};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// Height of a bar and the space between rows, in units of paper.
const BAR: i32 = 13 * UNIT;
const BETWEEN: i32 = 14 * UNIT;
/// Most room for the name of a row.
const NAMES: i32 = 240 * UNIT;

/// Bars of one input.
#[derive(Debug, Clone, PartialEq)]
pub struct BarGroup {
    /// Its name.
    pub name: String,
    /// One bar of each series, if it has one.
    pub bars: Vec<Option<PlotBar>>,
}

/// A bar from 0 to a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlotBar {
    /// Where it ends.
    pub value: f64,
    /// How far off that may be to either side.
    pub whisker: Option<f64>,
}

/// A quantity while one input goes from end to end.
#[derive(Debug, Clone, PartialEq)]
pub struct Swing {
    /// The input.
    pub name: String,
    /// Its low end, in words.
    pub low: String,
    /// Its high end, in words.
    pub high: String,
    /// The quantity at the low end, if it has a value there.
    pub at_low: Option<f64>,
    /// The quantity at the high end, if it has a value there.
    pub at_high: Option<f64>,
}

/// Draws groups of bars below each other, from 0 along the axis of `quantity`; each group has at most one bar of each of the `series`.
pub fn bars(title: &str, quantity: &PlotQuantity, series: &[String], groups: &[BarGroup]) -> String {
    let all = || groups.iter().flat_map(|group| group.bars.iter().flatten());
    let ends = all().flat_map(|bar| [bar.value - bar.whisker.unwrap_or(0.0), bar.value + bar.whisker.unwrap_or(0.0)]);
    let Some(range) = bounds(ends.chain([0.0]), 0.03).filter(|_| all().next().is_some()) else { return sentence(title, "no values") };
    let colour = |number: usize| LINES[number % LINES.len()];
    let legend = series.iter().enumerate().map(|(number, name)| (Mark::Box(colour(number)), clean(name))).collect();
    let height = series.len() as i32 * BAR + BETWEEN;
    let names = groups.iter().map(|it| it.name.as_str());
    rows(title, legend, quantity, (range.0.min(0.0), range.1), height, names, |area, panel, row, middle| {
        let group = &groups[row];
        let place = |value: f64| panel.backend_coord(&(value, 0.0)).0;
        for (number, bar) in group.bars.iter().enumerate() {
            let Some(bar) = bar.filter(|bar| bar.value.is_finite()) else { continue };
            let top = middle - series.len() as i32 * BAR / 2 + number as i32 * BAR;
            let (from, to) = (place(0.0), place(bar.value));
            // Even a share of nothing can be seen.
            let corners = [(from.min(to), top + UNIT), (from.max(to).max(from.min(to) + UNIT), top + BAR - UNIT)];
            area.draw(&Rectangle::new(corners, colour(number).filled()))?;
            if let Some(whisker) = bar.whisker.filter(|it| it.is_finite()) {
                let (low, high, y) = (place(bar.value - whisker), place(bar.value + whisker), top + BAR / 2);
                let stroke = INK.stroke_width(UNIT as u32);
                area.draw(&PathElement::new([(low, y), (high, y)], stroke))?;
                for end in [low, high] {
                    area.draw(&PathElement::new([(end, y - 3 * UNIT), (end, y + 3 * UNIT)], stroke))?;
                }
            }
        }
        Ok(())
    })
}

/// Draws a tornado in the order given: from each row's value at the low end of its input to that at the high end, across the line of the
/// value in the `middle`.
pub fn tornado(title: &str, quantity: &PlotQuantity, middle: Option<f64>, swings: &[Swing]) -> String {
    let ends = swings.iter().flat_map(|it| [it.at_low, it.at_high]).flatten();
    let Some(range) = bounds(ends.chain(middle), 0.16) else { return sentence(title, "no values") };
    let mut legend = vec![(Mark::Box(BLUE), "low end".to_owned()), (Mark::Box(VERMILION), "high end".to_owned())];
    if let Some(middle) = middle {
        let value = format!("all in the middle: {} {}", number::significant(middle, 5), quantity.plain_unit());
        legend.push((Mark::Line(GREY, Dash::Solid), value.trim_end().to_owned()));
    }
    let names = swings.iter().map(|it| it.name.as_str());
    rows(title, legend, quantity, range, 2 * BAR + BETWEEN, names, |area, panel, row, at| {
        let swing = &swings[row];
        let place = |value: f64| panel.backend_coord(&(value, 0.0)).0;
        let sides = [(swing.at_low, &swing.low, BLUE), (swing.at_high, &swing.high, VERMILION)];
        for (number, (value, words, colour)) in sides.into_iter().enumerate() {
            let top = at - BAR + number as i32 * BAR;
            let Some(value) = value.filter(|it| it.is_finite()) else {
                let style = text(TICK_TEXT, GREY, HPos::Center, VPos::Center);
                let x = middle.map_or((place(range.0) + place(range.1)) / 2, place);
                area.draw_text(&format!("no value at {words}"), &style, (x, top + BAR / 2))?;
                continue;
            };
            // Without a value in the middle only the end itself is marked.
            let (from, to) = (place(middle.unwrap_or(value)), place(value));
            let corners = [(from.min(to), top + UNIT), (from.max(to).max(from.min(to) + UNIT), top + BAR - UNIT)];
            area.draw(&Rectangle::new(corners, colour.filled()))?;
            let (side, gap) = if to < from { (HPos::Right, -4 * UNIT) } else { (HPos::Left, 4 * UNIT) };
            let words = shortened(&clean(words), TICK_TEXT, 90 * UNIT);
            area.draw_text(&words, &text(TICK_TEXT, INK, side, VPos::Center), (to + gap, top + BAR / 2))?;
        }
        if let Some(middle) = middle {
            let (x, half) = (place(middle), BAR + BETWEEN / 2);
            area.draw(&PathElement::new([(x, at - half), (x, at + half)], GREY.stroke_width(UNIT as u32)))?;
        }
        Ok(())
    })
}

/// Rows below each other with their names at the left; `draw` draws each, around the height of its middle.
fn rows<'n>(
    title: &str,
    legend: Vec<(Mark, String)>,
    quantity: &PlotQuantity,
    range: (f64, f64),
    height: i32,
    names: impl Iterator<Item = &'n str>,
    draw: impl Fn(&Area<'_>, &Panel<'_>, usize, i32) -> Drawn,
) -> String {
    let header = Header::new(title, legend);
    let names: Vec<String> = names.map(|name| shortened(&clean(name), TICK_TEXT, NAMES)).collect();
    let count = names.len() as f64;
    let y = PlotAxis::with_ticks((0.0, count), names.iter().enumerate().map(|(row, name)| (count - row as f64 - 0.5, name.clone())));
    let left = 12 * UNIT + y_labels_width(y.label_width(), &[]);
    let width = WIDTH - left - 30 * UNIT;
    let x = PlotAxis::horizontal(range, width, 20 * UNIT, Numbers::Long);
    let x_label = axis_label(quantity, &x, width);
    let frame = Frame { left, top: header.height(), width, height: names.len() as i32 * height };
    let mut sheet = Sheet::new(frame.bottom() + x_labels_height(&x_label) + 14 * UNIT);
    sheet.draw(|area| {
        header.draw(area)?;
        let panel = PanelPlan { frame, x: &x, y: &y, x_label: Some(&x_label), y_label: Some(&[]), tick_room: y.label_width(), grid: true };
        let panel = panel.draw(area)?;
        (0..names.len()).try_for_each(|row| draw(area, &panel, row, frame.top + row as i32 * height + height / 2))
    });
    sheet.finish()
}

#[cfg(test)]
mod tests {
    use super::super::sheet::tests::assert_svg;
    use super::*;

    /// Left end and width of the filled rectangles of a colour in the panel, in units of paper: those of the legend are 22 pixels wide.
    fn boxes(svg: &str, RGBColor(r, g, b): RGBColor) -> Vec<(i32, i32)> {
        let fill = format!("fill=\"#{r:02X}{g:02X}{b:02X}\"");
        let of = |line: &str, name: &str| -> i32 {
            let value = line.split(&format!("{name}=\"")).nth(1).and_then(|it| it.split('"').next());
            value.and_then(|it| it.parse().ok()).expect("a rectangle has one")
        };
        let boxes = svg.lines().filter(|line| line.starts_with("<rect") && line.contains(&fill));
        boxes.map(|line| (of(line, " x"), of(line, "width"))).filter(|it| it.1 != 22 * UNIT).collect()
    }

    fn group(name: &str, values: &[f64]) -> BarGroup {
        let bar = |&value: &f64| Some(PlotBar { value, whisker: Some(0.05) });
        BarGroup { name: name.to_owned(), bars: values.iter().map(bar).collect() }
    }

    #[test]
    fn bars_are_as_long_as_their_values() {
        let share = PlotQuantity::new("share of the variance", "");
        let series = ["first order".to_owned(), "total".to_owned()];
        let groups = [group("friction", &[0.2, 0.4]), group("a & b", &[0.6, 0.0])];
        let svg = bars("t", &share, &series, &groups);
        assert_svg(&svg);
        assert_eq!(svg, bars("t", &share, &series, &groups));
        let (first, total) = (boxes(&svg, LINES[0]), boxes(&svg, LINES[1]));
        assert_eq!((first.len(), total.len()), (2, 2));
        assert!((first[1].1 - 3 * first[0].1).abs() <= 3 && (total[0].1 - 2 * first[0].1).abs() <= 2 && total[1].1 <= UNIT);
        assert!(first[0].0 == total[0].0, "all begin at 0");
        for words in ["friction", "a &amp; b", "first order", "total", "share of the variance"] {
            assert!(svg.contains(&format!("\n{words}\n")), "{words}");
        }
    }

    #[test]
    fn swings_go_from_the_middle_to_both_ends() {
        let swing =
            |at_low, at_high| Swing { name: "friction".to_owned(), low: "0.06".to_owned(), high: "0.1".to_owned(), at_low, at_high };
        let force = PlotQuantity::new("axial_force_N", "N");
        let svg = tornado("t", &force, Some(100.0), &[swing(Some(160.0), Some(80.0)), swing(None, Some(110.0))]);
        assert_svg(&svg);
        let (low, high) = (boxes(&svg, BLUE), boxes(&svg, VERMILION));
        assert_eq!((low.len(), high.len()), (1, 2));
        // 60 above the middle, 20 below and 10 above.
        assert!((low[0].1 - 3 * high[0].1).abs() <= 3 && (high[0].1 - 2 * high[1].1).abs() <= 2);
        assert!(high[0].0 < low[0].0 && high[1].0 == low[0].0);
        for words in ["no value at 0.06", "all in the middle: 100 N", "axial force [N]"] {
            assert!(svg.contains(words), "{words}");
        }
    }

    #[test]
    fn without_values_the_picture_says_so() {
        let axis = PlotQuantity::new("x", "");
        for svg in [bars("t", &axis, &[], &[]), tornado("t", &axis, None, &[])] {
            assert_svg(&svg);
            assert!(svg.contains("no values"));
        }
    }
}
