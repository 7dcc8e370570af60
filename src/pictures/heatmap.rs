//! The picture of a map over two axes.

use super::axis::PlotAxis;
use super::colour_bar::ColourBar;
use super::colours::{ABSENT, HATCH, INK};
use super::header::{Header, Mark, sentence};
use super::panel::{PanelPlan, axis_label, x_labels_height, y_labels_width};
use super::range::bounds;
use super::raster::image;
use super::sheet::{Area, Dash, Drawn, Frame, Sheet, UNIT, WIDTH, stroked};
use super::{MapDetails, PlotQuantity, levels, number, overlay};
use plotters::prelude::*;
use std::fmt::Write;

/// Height of the panel and of the colour bar, in units of paper.
const HEIGHT: i32 = 520 * UNIT;
/// Draws a map: one coloured cell for each pair of levels, in one embedded PNG image.
///
/// `x` and `y` are the axes with their level values, which may be irregular: an axis counts levels, and its ticks show their values.
/// `cells` are the values, `[y][x]`, `None` where there is no feasible design, which is hatched. Over them the lines of `details` are
/// drawn; without any, maps that are fine and smooth enough get contour lines at the ticks of the colour bar. Without any cell the picture
/// says that no design is feasible.
pub fn heatmap(
    title: &str,
    x: (&PlotQuantity, &[f64]),
    y: (&PlotQuantity, &[f64]),
    value: &PlotQuantity,
    cells: &[Option<f64>],
    details: &MapDetails,
) -> String {
    let (columns, rows) = (x.1.len(), y.1.len());
    if columns == 0 || rows == 0 {
        return sentence(title, "no feasible design");
    }
    // Cells that are missing or not finite are absent like the others.
    let cell = |i: usize| cells.get(i).copied().flatten().filter(|v| v.is_finite());
    let cells: Vec<Option<f64>> = (0..columns * rows).map(cell).collect();
    let bar = bounds(cells.iter().flatten().copied(), 0.0).map(|range| ColourBar::new(range, value, HEIGHT, details.whole));
    let automatic = bar.as_ref().filter(|_| details.contours.is_none());
    let lines = automatic.and_then(|bar| bar.lines(&cells, columns, rows));
    let given = details.contours.as_deref().unwrap_or_default();
    let mut entries = legend(&cells, value, lines.is_some());
    entries.extend(overlay::legend(given));
    let header = Header::new(title, entries);
    let layout = HeatmapLayout::new(x, y, &details.words, bar.as_ref(), header.height());
    let frame = layout.frame;

    let mut sheet = Sheet::new(layout.bottom());
    sheet.draw(|area| {
        header.draw(area)?;
        area.draw(&Rectangle::new(frame.corners(), ABSENT.filled()))
    });
    if cells.iter().any(Option::is_none) {
        sheet.insert(&hatching(frame));
    }
    if let Some(bar) = &bar {
        sheet.insert(&image(frame, &bar.indices(&cells, columns), columns, rows));
        sheet.insert(&bar.image(frame));
    }
    for line in lines.unwrap_or_default() {
        sheet.insert(&line.path(frame, columns, rows));
    }
    overlay::draw(&mut sheet, given, (x.1, y.1), frame);
    sheet.draw(|area| {
        layout.draw_axes(area)?;
        bar.iter().try_for_each(|bar| bar.draw_ticks(area, frame))
    });
    sheet.finish()
}

fn legend(cells: &[Option<f64>], value: &PlotQuantity, contours: bool) -> Vec<(Mark, String)> {
    let mut legend = Vec::new();
    let found = cells.iter().flatten();
    let extremes = found.fold(None, |seen: Option<(f64, f64)>, &v| {
        let (low, high) = seen.unwrap_or((v, v));
        Some((low.min(v), high.max(v)))
    });
    if let Some((low, high)) = extremes {
        let (name, unit) = (value.plain_name(), value.plain_unit());
        let [from, to] = [low, high].map(|v| number::significant(v, 5));
        legend.push((
            Mark::None,
            match low < high {
                true => format!("{name} from {from} to {to} {unit}"),
                false => format!("{name} {to} {unit} everywhere"),
            },
        ));
    }
    let absent = cells.iter().filter(|cell| cell.is_none()).count();
    if absent > 0 {
        let [absent, all] = [absent, cells.len()].map(|n| number::count(n as u64));
        let name = format!("no feasible design ({absent} of {all} cells)");
        legend.push((Mark::Hatched, name));
    }
    if contours {
        let name = "contours at the ticks of the colour bar".to_owned();
        legend.push((Mark::Line(INK, Dash::Solid), name));
    }
    legend
}

/// The positions of panel and colour bar.
struct HeatmapLayout {
    frame: Frame,
    x: PlotAxis,
    y: PlotAxis,
    x_label: Vec<String>,
    y_label: Vec<String>,
}

impl HeatmapLayout {
    fn new(
        x: (&PlotQuantity, &[f64]),
        y: (&PlotQuantity, &[f64]),
        [x_words, y_words]: &[Option<Vec<String>>; 2],
        bar: Option<&ColourBar>,
        top: i32,
    ) -> Self {
        let y_axis = y_words.as_ref().map_or_else(|| levels::upwards(y.1, HEIGHT), |words| levels::words_upwards(words, HEIGHT));
        let y_label = axis_label(y.0, &y_axis, HEIGHT);
        let left = 12 * UNIT + y_labels_width(y_axis.label_width(), &y_label);
        let right = 20 * UNIT + bar.map_or(0, ColourBar::room);
        let width = WIDTH - left - right;
        let x_axis = x_words.as_ref().map_or_else(|| levels::across(x.1, width), |words| levels::words_across(words, width));
        let x_label = axis_label(x.0, &x_axis, width);
        let frame = Frame { left, top, width, height: HEIGHT };
        Self { frame, x: x_axis, y: y_axis, x_label, y_label }
    }

    fn bottom(&self) -> i32 {
        self.frame.bottom() + x_labels_height(&self.x_label) + 14 * UNIT
    }

    fn draw_axes(&self, area: &Area<'_>) -> Drawn {
        let panel = PanelPlan {
            frame: self.frame,
            x: &self.x,
            y: &self.y,
            x_label: Some(&self.x_label),
            y_label: Some(&self.y_label),
            tick_room: self.y.label_width(),
            grid: false,
        };
        panel.draw(area).map(drop)
    }
}

/// Hatching over a frame, visible where cells are absent, also in print. It is drawn with lines rather than an SVG pattern, which would
/// need a name that is unique in the page around the picture.
fn hatching(frame: Frame) -> String {
    let mut path = String::new();
    for start in (-frame.height..frame.width).step_by((7 * UNIT) as usize) {
        let from = (-start).max(0);
        let to = frame.height.min(frame.width - start);
        let (x, y) = (frame.left + start + from, frame.bottom() - from);
        write!(path, "M{x} {y}l{0} -{0}", to - from).expect("writing into a string does not fail");
    }
    stroked(&path, HATCH, UNIT, Dash::Solid)
}

#[cfg(test)]
mod tests {
    use super::super::colours::{STEPS, step_colour};
    use super::super::raster::tests::decoded;
    use super::super::sheet::tests::assert_svg;
    use super::super::{Contours, Curve};
    use super::*;

    fn draw(x: &[f64], y: &[f64], cells: &[Option<f64>]) -> String {
        let [across, up] = ["ratio", "band_thickness_mm"];
        let [across, up] = [PlotQuantity::new(across, ""), PlotQuantity::new(up, "mm")];
        let value = PlotQuantity::new("axial_force_N", "N");
        let picture = || heatmap("\"map\" <1>", (&across, x), (&up, y), &value, cells, &MapDetails::default());
        let svg = picture();
        assert_eq!(svg, picture());
        svg
    }

    #[test]
    fn a_small_map_decodes_to_the_colours_of_its_values() {
        // Row by row from the lowest level of y: 0 absent 1 / 2 3 4.
        let cells = [Some(0.0), None, Some(1.0), Some(2.0), Some(3.0), Some(4.0)];
        let svg = draw(&[1.0, 2.0, 3.0], &[10.0, 20.0], &cells);
        assert_svg(&svg);
        assert!(svg.contains("no feasible design (1 of 6 cells)"));
        assert!(svg.contains("image-rendering:pixelated"));
        assert!(svg.contains("&quot;map&quot; &lt;1&gt;"));
        let (width, height, pixels) = decoded(&svg, 0);
        assert_eq!((width, height), (3, 2));
        let colour = |value: f64| {
            let RGBColor(r, g, b) = step_colour((value / 4.0 * 126.0).round() as usize);
            [r, g, b, 255]
        };
        // The image has its top row first.
        let expected = [2.0, 3.0, 4.0, 0.0, f64::NAN, 1.0].map(|v| match v.is_nan() {
            true => [0, 0, 0, 0],
            false => colour(v),
        });
        assert_eq!(pixels, expected);
        assert_ne!(pixels[4], pixels[3], "absent is not the lowest value");
        assert_eq!(pixels[2], [253, 231, 37, 255]);
        assert_eq!(pixels[3], [68, 1, 84, 255]);
    }

    #[test]
    fn the_colour_bar_runs_from_lowest_to_highest_upwards() {
        let svg = draw(&[1.0, 2.0], &[1.0], &[Some(-3.0), Some(7.0)]);
        let (width, height, pixels) = decoded(&svg, 1);
        assert_eq!((width, height as usize), (1, STEPS));
        assert_eq!(pixels[0], [253, 231, 37, 255]);
        assert_eq!(pixels[STEPS - 1], [68, 1, 84, 255]);
    }

    #[test]
    fn degenerate_maps_give_a_picture() {
        assert!(draw(&[], &[1.0], &[]).contains("no feasible design"));
        for value in [0.0, 1e-12, 1e12, -5.0] {
            for cells in [&[Some(value)][..], &[Some(value); 4], &[None, Some(value)], &[]] {
                for (x, y) in [(&[1.0][..], &[2.0][..]), (&[1e-12, 1e12], &[0.5, 0.25])] {
                    let svg = draw(x, y, cells);
                    assert_svg(&svg);
                    let absent = x.len() * y.len() > cells.len() || cells.contains(&None);
                    let cut = cells.first() == Some(&None) || x.len() * y.len() > cells.len();
                    assert_eq!(svg.contains("no feasible design"), absent && cut);
                }
            }
        }
    }

    #[test]
    fn endless_names_give_a_picture() {
        let long = PlotQuantity::new("word_".repeat(200), "x".repeat(200));
        let map = heatmap("", (&long, &[1.0]), (&long, &[2.0]), &long, &[Some(1e-9)], &MapDetails::default());
        assert_svg(&map);
    }

    #[test]
    fn an_empty_map_has_no_colour_bar() {
        let svg = draw(&[1.0, 2.0], &[1.0], &[None, None]);
        assert_svg(&svg);
        assert!(svg.contains("2 of 2 cells") && !svg.contains("<image"));
    }

    #[test]
    fn smooth_maps_carry_contours() {
        let levels: Vec<f64> = (0..20).map(f64::from).collect();
        let smooth: Vec<_> = (0..400).map(|i| Some(f64::from(i % 20 + i / 20))).collect();
        assert!(draw(&levels, &levels, &smooth).contains("contours"));
        assert!(!draw(&levels, &levels, &[Some(1.0); 400]).contains("contours"));
        assert!(!draw(&levels, &levels[..2], &smooth[..40]).contains("contours"));
    }

    #[test]
    fn levels_that_are_words_stand_at_the_axes_as_such() {
        let [x, y, value] = ["section", "ratio", "force"].map(|name| PlotQuantity::new(name, ""));
        let words = |words: &[&str]| Some(words.iter().map(|word| (*word).to_owned()).collect());
        let details = MapDetails { words: [words(&["machined", "pressed-cup"]), words(&["limit", "0.5"])], ..MapDetails::default() };
        let svg = heatmap("", (&x, &[1.0, 4.0]), (&y, &[-1.0, 0.5]), &value, &[Some(1.0); 4], &details);
        assert_svg(&svg);
        for text in ["machined", "pressed-cup", "limit", "0.5"] {
            assert!(svg.contains(&format!("\n{text}\n")), "{text} is missing");
        }
        assert!(!svg.contains("−1"), "the number that stands for a word means nothing outside");
    }

    #[test]
    fn given_lines_replace_the_automatic_ones() {
        let levels: Vec<f64> = (0..20).map(f64::from).collect();
        let cells: Vec<_> = (0..400).map(|i| Some(f64::from(i % 20))).collect();
        let line = |at: f64| Curve { at, lines: vec![vec![(at, 0.0), (at, 19.0)]] };
        let drawn = |quantity: &str, every_change: bool, curves: Vec<Curve>| {
            let contours = vec![Contours { quantity: PlotQuantity::new(quantity, "N"), every_change, curves }];
            let [x, y, value] = ["ratio", "torque", "tooth"].map(|name| PlotQuantity::new(name, ""));
            let details = MapDetails { whole: true, contours: Some(contours), ..MapDetails::default() };
            let svg = heatmap("", (&x, &levels), (&y, &levels), &value, &cells, &details);
            assert_svg(&svg);
            assert!(!svg.contains("ticks of the colour bar"));
            svg
        };
        let one = drawn("axial_force_N", false, vec![line(7.0)]);
        assert!(one.contains("axial force = 7 N") && one.matches("<rect").count() == drawn("", false, Vec::new()).matches("<rect").count());
        let several = drawn("tooth_number", true, (5..15).map(|at| line(f64::from(at))).collect());
        assert!(several.contains("tooth number rises to the number on the line"));
        assert_eq!(several.matches("rx=\"30\"").count(), 10, "each line has its number");
        assert!(drawn("a", false, vec![Curve { at: 3.0, lines: Vec::new() }]).contains("a = 3 N (nowhere here)"));
        assert!(drawn("a", true, Vec::new()).contains("a changes nowhere here"));
    }

    #[test]
    fn the_colour_bar_of_whole_numbers_has_whole_ticks() {
        let ticks = |cells: &[Option<f64>], whole: bool| {
            let [x, y] = ["ratio", "torque"].map(|name| PlotQuantity::new(name, ""));
            let levels: Vec<f64> = (0..cells.len()).map(|i| i as f64).collect();
            let details = MapDetails { whole, ..MapDetails::default() };
            heatmap("", (&x, &levels), (&y, &[1.0]), &PlotQuantity::new("tooth", ""), cells, &details)
        };
        let cells = [Some(3.0), Some(4.0), Some(5.0)];
        assert!(ticks(&cells, false).contains("\n3.4\n") && !ticks(&cells, true).contains("\n3.4\n"));
        assert!(ticks(&cells, true).contains("\n4\n"));
        assert!(!ticks(&[Some(1.0)], true).contains("\n1.0\n"), "also where all values are the same");
    }

    #[test]
    fn four_million_cells_of_noise_stay_below_five_megabytes() {
        let levels: Vec<f64> = (0..2000).map(f64::from).collect();
        let mut state = 88_172_645_463_325_252_u64;
        let noise = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            Some((state >> 40) as f64)
        };
        let cells: Vec<_> = std::iter::repeat_with(noise).take(4_000_000).collect();
        let [x, y, value] = ["ratio", "torque", "force"].map(|name| PlotQuantity::new(name, ""));
        let svg = heatmap("", (&x, &levels), (&y, &levels), &value, &cells, &MapDetails::default());
        assert!(svg.len() < 5_000_000, "{} bytes", svg.len());
    }
}
