//! Figs 1, 2, 7, 9 and the first conclusion.

use super::super::{Figure, Inputs, Paper, numbers};
use super::{PaperCurve, metal, rubber};
use crate::pictures::{Guide, Line, Marker, PlotQuantity, Scale, Stroke, lines};
use crate::table::Table;

/// Every figure of the paper that has something to compute.
pub(super) fn all() -> Vec<Figure> {
    vec![figure_1(), figure_2(), figure_7(), figure_9(), conclusion_1()]
}

const RATIOS: [(&str, f64); 3] = [("R = 1", 1.0), ("R = 2", 2.0), ("R = 1/2", 0.5)];

fn figure_1() -> Figure {
    let belts = RATIOS.map(|(label, ratio)| (label.to_owned(), ratio, rubber().with(&[("ratio", ratio)])));
    ForceFigure {
        id: "cvt-fig-1",
        title: "Fig. 1: nondimensional axial force of the rubber V-belt variator",
        caption: "(4) and (5) with the paper's data: friction 0.4, groove angle 30°, belt length 1066 mm, centre distance 260 mm. \
                  R is driven over driver radius, which the paper does not define. Each curve ends where the belt slips on the driven pulley.",
        force: "axial force per sum of tensions F/(T₁ + T₂)",
        parameter: ("ratio", "Driven over driver radius."),
        belts: &belts,
        guides: &[],
    }
    .figure()
}

fn figure_2() -> Figure {
    let belts = [0.35, 0.4, 0.45].map(|friction| (format!("μ = {friction:.2}"), friction, rubber().with(&[("friction", friction)])));
    ForceFigure {
        id: "cvt-fig-2",
        title: "Fig. 2: axial force of the rubber V-belt variator at R = 1, theory",
        caption: "(4) and (5) at R = 1 for the paper's three coefficients of friction. The measured points are lost in the scan; they ended \
                  at the marked traction, where the belt slipped, which the theory does not predict.",
        force: "axial force per sum of tensions F/(T₁ + T₂)",
        parameter: ("friction", "Coefficient of friction."),
        belts: &belts,
        guides: &[upright(0.8, "slip measured at λ = 0.8")],
    }
    .figure()
}

fn figure_7() -> Figure {
    let belts = RATIOS.map(|(label, ratio)| (label.to_owned(), ratio, metal().with(&[("friction", 0.1), ("ratio", ratio)])));
    ForceFigure {
        id: "cvt-fig-7",
        title: "Fig. 7: nondimensional axial force of the metal V-belt variator",
        caption: "(15) and (16) with the paper's data: friction 0.1, groove angle 22°, belt length 613 mm, centre distance 156 mm. As in the \
                  paper the curves end where the active arc is the whole wrap of the driven pulley.",
        force: "axial force per sum of belt forces S/(2T − P₂)",
        parameter: ("ratio", "Driven over driver radius."),
        belts: &belts,
        guides: &[],
    }
    .figure()
}

fn figure_9() -> Figure {
    let belts = [0.08, 0.11, 0.14].map(|friction| (format!("μ = {friction:.2}"), friction, metal().with(&[("friction", friction)])));
    ForceFigure {
        id: "cvt-fig-9",
        title: "Fig. 9: axial force of the metal V-belt variator at R = 1, theory",
        caption: "(15) and (16) at R = 1 for the paper's three coefficients of friction, each up to its slip limit. The measured points are lost \
                  in the scan; they followed μ = 0.11 and ended at the marked traction, where the belt slipped; with that friction the theory lets it \
                  run on to 0.72.",
        force: "axial force per sum of belt forces S/(2T − P₂)",
        parameter: ("friction", "Coefficient of friction."),
        belts: &belts,
        guides: &[upright(0.58, "slip measured at λ = 0.58")],
    }
    .figure()
}

fn upright(at: f64, words: &str) -> Guide {
    Guide { at, upright: true, words: words.to_owned(), colour: None }
}

/// Axial forces over the traction for some values of a parameter.
struct ForceFigure<'a> {
    id: &'static str,
    title: &'a str,
    caption: &'a str,
    /// Words of the ordinate.
    force: &'a str,
    /// Name of the parameter and what it is.
    parameter: (&'a str, &'a str),
    /// Its values, each with its words and its belt.
    belts: &'a [(String, f64, Inputs)],
    guides: &'a [Guide],
}

impl ForceFigure<'_> {
    fn figure(&self) -> Figure {
        let curves: Vec<_> = self.belts.iter().map(|(label, value, belt)| (label, *value, PaperCurve::of(belt))).collect();
        let line = |label: String, curve: &PaperCurve, y: &[f64], colour, stroke| Line {
            label,
            x: curve.traction.clone(),
            y: y.to_vec(),
            colour,
            stroke,
            marker: Marker::None,
        };
        let driver = |(colour, (label, _, curve)): (usize, &(&String, f64, PaperCurve))| {
            line(format!("{label}, driver"), curve, &curve.driver, colour, Stroke::Solid)
        };
        let driven = |(colour, (label, _, curve)): (usize, &(&String, f64, PaperCurve))| {
            line(format!("{label}, driven"), curve, &curve.driven, colour, Stroke::Dashed)
        };
        let drawn: Vec<Line> = curves.iter().enumerate().map(driver).chain(curves.iter().enumerate().map(driven)).collect();
        let x = Scale { quantity: PlotQuantity::new("traction coefficient λ", "–"), range: Some((0.0, 1.0)) };
        let y = Scale { quantity: PlotQuantity::new(self.force, "–"), range: Some((0.0, from_zero(&drawn))) };
        let along = |of: fn(&PaperCurve) -> &[f64]| curves.iter().flat_map(move |(_, _, curve)| of(curve).iter().copied().map(Some));
        let parameter = curves.iter().flat_map(|(_, value, curve)| curve.traction.iter().map(|_| Some(*value)));
        Figure {
            id: self.id,
            title: self.title.to_owned(),
            caption: self.caption.to_owned(),
            group: Paper::Cvt,
            svg: lines(self.title, &x, &y, &drawn, self.guides),
            table: Table {
                columns: vec![
                    numbers(self.parameter.0, "", self.parameter.1, parameter),
                    numbers("traction", "", "Traction coefficient.", along(|curve| &curve.traction)),
                    numbers("driver_axial_coefficient", "", "Driver force per sum of belt forces.", along(|curve| &curve.driver)),
                    numbers("driven_axial_coefficient", "", "Driven force per sum of belt forces.", along(|curve| &curve.driven)),
                ],
            },
        }
    }
}

/// Upper end of an axis from 0 that holds these lines.
fn from_zero(lines: &[Line]) -> f64 {
    1.06 * lines.iter().flat_map(|line| &line.y).copied().fold(0.0, f64::max)
}

/// Belt forces at constant pretension: the driver's force, N, over the transmitted force, N.
pub(super) struct Pretension {
    pub load: Vec<f64>,
    pub rubber: Vec<f64>,
    pub metal: Vec<f64>,
}

/// Sum of tensions of the rubber belt, N: 2000 N at a traction of 0.8, as in Table 2.
pub(super) const RUBBER_SUM: f64 = 2500.0;
/// Band tension of the metal belt, N, as printed in Table 2.
pub(super) const BAND_TENSION: f64 = 2800.0;

/// Driver force S~ (F1 + F2) over the load P = F1 - F2: T1 + T2 is constant on rubber; on metal the band tension T is, F1 = T and
/// F2 = T - P.
pub(super) fn at_constant_pretension() -> Pretension {
    let load: Vec<f64> = (0..=40).map(|step| 50.0 * f64::from(step)).collect();
    let force = |belt: &Inputs, load: f64, sum: f64| belt.with(&[("traction", load / sum)]).output("driver_axial_coefficient") * sum;
    let (rubber_belt, metal_belt) = (rubber(), metal());
    let rubber = load.iter().map(|&load| force(&rubber_belt, load, RUBBER_SUM)).collect();
    let metal = load.iter().map(|&load| force(&metal_belt, load, 2.0 * BAND_TENSION - load)).collect();
    Pretension { load, rubber, metal }
}

fn conclusion_1() -> Figure {
    let Pretension { load, rubber, metal } = at_constant_pretension();
    let column = |values: &[f64]| values.iter().copied().map(Some).collect::<Vec<_>>();
    let line = |label: String, y: &[f64], colour| Line {
        label,
        x: load.clone(),
        y: y.to_vec(),
        colour,
        stroke: Stroke::Solid,
        marker: Marker::None,
    };
    let drawn = [
        line(format!("rubber belt, T₁ + T₂ = {RUBBER_SUM} N constant"), &rubber, 0),
        line(format!("metal belt, band tension T = {BAND_TENSION} N constant"), &metal, 1),
    ];
    let title = "Conclusion (1): driver axial force against load at constant pretension";
    let x = Scale { quantity: PlotQuantity::new("transmitted force P", "N"), range: Some((0.0, 2000.0)) };
    let y = Scale { quantity: PlotQuantity::new("driver axial force", "N"), range: Some((0.0, from_zero(&drawn))) };
    Figure {
        id: "cvt-conclusion-1",
        title: title.to_owned(),
        caption:
            "The paper says it in words only. A rubber belt transmits by the difference of its tensions, so at constant T₁ + T₂ the tight \
                  side and with it the driver force rise with the load; a metal belt transmits by block compression and its band tension \
                  stays, so the driver force is constant. R = 1; pretensions from Table 2."
                .to_owned(),
        group: Paper::Cvt,
        svg: lines(title, &x, &y, &drawn, &[]),
        table: Table {
            columns: vec![
                numbers("belt_force_N", "N", "Transmitted force.", column(&load)),
                numbers("rubber_driver_axial_force_N", "N", "Driver force of the rubber belt.", column(&rubber)),
                numbers("metal_driver_axial_force_N", "N", "Driver force of the metal belt.", column(&metal)),
            ],
        },
    }
}
