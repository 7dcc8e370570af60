//! Pictures: plain data in, the text of one self-contained SVG file out.
//!
//! [`front`] draws a Pareto front, [`histogram()`] a histogram, [`heatmap()`] a map over two axes, [`curves()`] profiles over a common
//! abscissa and [`lines()`] a figure as papers print it; [`pulley`] draws pulleys. None of them reads or writes a file, and the same input
//! always gives the same bytes: no clock, no random names, no hash-map order, and no transcendental function of the system in a position
//! or a tick.
//!
//! A picture is 900 px wide on a white background, uses colours that colour-blind readers can distinguish, and loads nothing from
//! elsewhere, so it looks the same as a file in a browser and inside a page. Input without any data gives a picture that says so; values
//! that are not finite are left out.

mod axis;
mod bars;
mod colour_bar;
mod colours;
mod contours;
mod curves;
mod header;
mod heatmap;
mod histogram;
mod levels;
mod lines;
pub(crate) mod number;
mod overlay;
mod panel;
pub mod pulley;
mod range;
mod raster;
mod scatter;
mod scatter_front;
mod scatter_grid;
mod sheet;
mod staircase;
mod thinning;
mod words;

pub use bars::{BarGroup, PlotBar, Swing, bars, tornado};
pub use curves::curves;
pub use heatmap::heatmap;
pub use histogram::histogram;
pub use lines::{Guide, Line, Marker, Scale, Stroke, lines};
pub use scatter::{front, front_over};

/// One quantity on an axis.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlotQuantity {
    /// Name as in study files, with its unit as suffix: `axial_force_N`.
    pub name: String,
    /// Unit as in the suffix (`N_per_mm`) or written out (`N/mm`); empty for dimensionless ones.
    pub unit: String,
}

/// Which values of an objective are better.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlotGoal {
    /// Lower is better.
    Min,
    /// Higher is better.
    Max,
}

/// A quantity to be optimised.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlotObjective {
    /// What is optimised.
    pub quantity: PlotQuantity,
    /// In which direction.
    pub goal: PlotGoal,
}

/// One line in a panel of [`curves()`].
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend; the same label has the same colour in every panel.
    pub label: String,
    /// Abscissae, in the unit of the common quantity.
    pub x: Vec<f64>,
    /// Ordinates, in the unit of the panel's quantity; as many as `x`.
    pub y: Vec<f64>,
}

/// Details of a map besides its cells.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MapDetails {
    /// Are all values whole numbers? Then those of the colour bar are too.
    pub whole: bool,
    /// The texts of the levels of the two axes, if some are words.
    pub words: [Option<Vec<String>>; 2],
    /// Lines over the map, which replace those that [`heatmap()`] would draw by itself.
    pub contours: Option<Vec<Contours>>,
}

/// Lines of one quantity over a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Contours {
    /// The quantity, which need not be the map's.
    pub quantity: PlotQuantity,
    /// Are these lines all steps of a whole-number quantity?
    pub every_change: bool,
    /// One entry per value.
    pub curves: Vec<Curve>,
}

/// The lines at one value of a quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// The value, in the quantity's unit.
    pub at: f64,
    /// Polylines of at least one point, in the units of the map's axes.
    pub lines: Vec<Vec<(f64, f64)>>,
}

impl PlotQuantity {
    /// A quantity from its name and unit (empty if dimensionless).
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }

    /// Text for an axis: `axial force [N]` for `axial_force_N` in `N`.
    pub fn label(&self) -> String {
        self.label_in_powers_of_ten(0)
    }

    /// As [`label`](Self::label), for numbers given in units of a power of ten:
    /// `axial force [10⁶ N]`, never broken between power and unit.
    fn label_in_powers_of_ten(&self, exponent: i32) -> String {
        let name = self.plain_name();
        let unit = self.plain_unit();
        let power = match exponent {
            0 => String::new(),
            _ => format!("10{}", number::superscript(exponent)),
        };
        match (power.is_empty(), unit.is_empty()) {
            (true, true) => name,
            (true, false) => format!("{name} [{unit}]"),
            (false, true) => format!("{name} [{power}]"),
            (false, false) => format!("{name} [{power}\u{a0}{unit}]"),
        }
    }

    /// The unit as it is usually written: `N/mm`, `mm²`.
    fn plain_unit(&self) -> String {
        words::clean(&self.unit).replace("_per_", "/").replace("m2", "m²").replace("m3", "m³")
    }

    /// The name without its unit suffix, words separated by spaces.
    fn plain_name(&self) -> String {
        let suffix = unit_as_suffix(&self.unit);
        let stem = self
            .name
            .strip_suffix(&suffix)
            .and_then(|stem| stem.strip_suffix('_'))
            .filter(|stem| !suffix.is_empty() && !stem.is_empty())
            .unwrap_or(&self.name);
        words::clean(&spaced(stem))
    }
}

impl PlotGoal {
    /// Words for an axis label; the arrow points along the axis towards better values, also on a vertical axis, whose label reads upwards.
    fn words(self) -> &'static str {
        match self {
            PlotGoal::Min => "← lower is better",
            PlotGoal::Max => "higher is better →",
        }
    }

    /// Orders values, better ones first.
    fn better_first(self, a: f64, b: f64) -> std::cmp::Ordering {
        match self {
            PlotGoal::Min => a.total_cmp(&b),
            PlotGoal::Max => b.total_cmp(&a),
        }
    }
}

/// The words of a name, with the point of a quantile: `draw q99.9` of `draw_q99_9`.
pub(crate) fn spaced(name: &str) -> String {
    let is_number = |word: &str| !word.is_empty() && word.bytes().all(|it| it.is_ascii_digit());
    let mut words = String::new();
    let mut last = "";
    for word in name.split('_') {
        let is_fraction = last.strip_prefix('q').is_some_and(is_number) && is_number(word);
        if !words.is_empty() {
            words.push(if is_fraction { '.' } else { ' ' });
        }
        words.push_str(word);
        last = word;
    }
    words
}

/// A unit as names spell it, so that `N/mm` strips `_N_per_mm` and `°` strips `_deg`.
fn unit_as_suffix(unit: &str) -> String {
    unit.replace('/', "_per_").replace('²', "2").replace('³', "3").replace(['µ', 'μ'], "u").replace('°', "deg").replace([' ', '·'], "")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_carry_the_unit_once() {
        for (name, unit, label) in [
            ("axial_force_N", "N", "axial force [N]"),
            ("line_force_N_per_mm", "N/mm", "line force [N/mm]"),
            ("line_force_N_per_mm", "N_per_mm", "line force [N/mm]"),
            ("cord_area_mm2", "mm2", "cord area [mm²]"),
            ("driver_wrap_deg", "deg", "driver wrap [deg]"),
            ("torque_Nm", "N m", "torque [N m]"),
            ("stress_margin", "", "stress margin"),
            ("slip_margin_draw_q99_9", "", "slip margin draw q99.9"),
            ("force_draw_q99_N", "N", "force draw q99 [N]"),
            ("N", "N", "N [N]"),
            ("", "", ""),
        ] {
            assert_eq!(PlotQuantity::new(name, unit).label(), label);
        }
    }

    #[test]
    fn powers_of_ten_stand_in_front_of_the_unit() {
        let force = PlotQuantity::new("axial_force_N", "N");
        assert_eq!(force.label_in_powers_of_ten(6), "axial force [10⁶\u{a0}N]");
        let share = PlotQuantity::new("share", "");
        assert_eq!(share.label_in_powers_of_ten(-12), "share [10⁻¹²]");
    }
}
