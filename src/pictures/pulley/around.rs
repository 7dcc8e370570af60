//! Curves of the check points' stress around the circumference.

use super::super::axis::PlotAxis;
use super::super::colours::{GREY, INK, LINES};
use super::super::header::{Header, Mark, sentence};
use super::super::number::significant;
use super::super::panel::{PanelPlan, axis_label, x_labels_height, y_labels_width};
use super::super::range::bounds;
use super::super::sheet::{Area, Dash, Drawn, Frame, Sheet, UNIT, WIDTH, stroked};
use super::super::words::{text, text_width};
use super::super::{PlotQuantity, axis::Numbers};
use super::drawing::filled;
use crate::pulley::around::{Around, StressCurve};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use std::fmt::Write;

const HEIGHT: i32 = 440 * UNIT;
/// Ground of the wrap.
const WRAP: RGBColor = RGBColor(238, 242, 247);

/// Draws the stress of every check point around the circumference, left sides of the sheet as lines, right sides dashed, with the
/// wrap, the bolts and, if given, the yield strength (MPa), as a line unless it is far above.
pub fn around(title: &str, around: &Around, yield_strength: Option<f64>) -> String {
    let values = around.curves.iter().flat_map(|curve| curve.von_mises.iter().copied());
    let Some((_, most)) = bounds(values, 0.0) else {
        return sentence(title, "no check points");
    };
    // Far above all curves the line would only press them flat.
    let drawn = yield_strength.filter(|strength| *strength < 2.0 * most);
    let header = Header::new(title, legend(around, yield_strength, drawn.is_some()));
    let most = drawn.map_or(most, |strength| strength.max(most));
    let y = PlotAxis::vertical((0.0, 1.06 * most), HEIGHT, Numbers::Long);
    let y_label = axis_label(&PlotQuantity::new("von_Mises_stress_MPa", "MPa"), &y, HEIGHT);
    let left = 12 * UNIT + y_labels_width(y.label_width(), &y_label);
    let frame = Frame { left, top: header.height() + 16 * UNIT, width: WIDTH - left - 30 * UNIT, height: HEIGHT };
    let x = turn_axis();
    let x_label = turn_label(&x, frame.width);
    let across = |degrees: f64| frame.left + (degrees / 360.0 * f64::from(frame.width)).round() as i32;
    let up = |stress: f64| frame.bottom() - (stress / (1.06 * most) * f64::from(frame.height)).round() as i32;

    let mut sheet = Sheet::new(frame.bottom() + x_labels_height(&x_label) + 14 * UNIT);
    let wrap = around.wrap_deg.clamp(0.0, 360.0);
    sheet.insert(&filled(&format!("M{} {}H{}V{}H{}Z", frame.left, frame.top, across(wrap), frame.bottom(), frame.left), WRAP, "1"));
    sheet.draw(|area| {
        header.draw(area)?;
        let plan =
            PanelPlan { frame, x: &x, y: &y, x_label: Some(&x_label), y_label: Some(&y_label), tick_room: y.label_width(), grid: true };
        plan.draw(area)?;
        name_bolts(area, &around.bolts_deg, frame)
    });
    for &bolt in &around.bolts_deg {
        sheet.insert(&stroked(&format!("M{0} {1}V{2}", across(bolt), frame.top, frame.bottom()), GREY, 8, Dash::Centre));
    }
    if let Some(strength) = drawn {
        sheet.insert(&stroked(&format!("M{} {}H{}", frame.left, up(strength), frame.right()), INK, 12, Dash::Dotted));
    }
    for curve in &around.curves {
        let mut path = String::new();
        let last = (curve.von_mises.len() - 1).max(1) as f64;
        for (step, stress) in curve.von_mises.iter().enumerate() {
            let command = if step == 0 { 'M' } else { 'L' };
            write!(path, "{command}{} {}", across(360.0 * step as f64 / last), up(*stress)).expect("writing into a string does not fail");
        }
        let (colour, dash) = look(curve);
        sheet.insert(&stroked(&path, colour, 20, dash));
    }
    sheet.finish()
}

/// Names the bolts above a frame, as many as have room.
pub(super) fn name_bolts(area: &Area<'_>, bolts_deg: &[f64], frame: Frame) -> Drawn {
    const SIZE: i32 = 11;
    let style = text(SIZE, GREY, HPos::Center, VPos::Center);
    let room = text_width("bolt", SIZE) + 6 * UNIT;
    let mut last = frame.left - room;
    for bolt in bolts_deg {
        let x = frame.left + (bolt / 360.0 * f64::from(frame.width)).round() as i32;
        if x - last > room {
            area.draw_text("bolt", &style, (x, frame.top - 9 * UNIT))?;
            last = x;
        }
    }
    Ok(())
}

/// The axis of a turn.
pub(super) fn turn_axis() -> PlotAxis {
    PlotAxis::with_ticks((0.0, 360.0), (0..=12).map(|tick| (30.0 * f64::from(tick), (30 * tick).to_string())))
}

/// Its label.
pub(super) fn turn_label(axis: &PlotAxis, room: i32) -> Vec<String> {
    axis_label(&PlotQuantity::new("θ from the slack end", "°"), axis, room)
}

fn legend(around: &Around, yield_strength: Option<f64>, drawn: bool) -> Vec<(Mark, String)> {
    let entry = |curve: &StressCurve| {
        let (colour, dash) = look(curve);
        let most = curve.von_mises.iter().copied().fold(0.0, f64::max);
        (Mark::Line(colour, dash), format!("{} up to {} MPa", curve.name(), significant(most, 3)))
    };
    let mut legend: Vec<_> = around.curves.iter().map(entry).collect();
    if let Some(strength) = yield_strength {
        let words = format!("yield strength {} MPa", significant(strength, 4));
        legend.push(if drawn { (Mark::Line(INK, Dash::Dotted), words) } else { (Mark::None, format!("{words}, far above")) });
    }
    legend.push((Mark::Box(WRAP), format!("wrap {}°", significant(around.wrap_deg, 4))));
    legend
}

/// A colour per bend, a dash per side.
fn look(curve: &StressCurve) -> (RGBColor, Dash) {
    (LINES[curve.number / 2], if curve.number.is_multiple_of(2) { Dash::Solid } else { Dash::Dashed })
}

#[cfg(test)]
mod tests {
    use super::super::super::sheet::tests::assert_svg;
    use super::*;
    use crate::pulley::fixtures;
    use crate::pulley::response::View;
    use crate::pulley::section::Fineness;
    use crate::pulley::turn::Turn;

    #[test]
    fn every_check_point_has_a_line_of_its_own_and_its_largest_value() {
        for (kind, dimensions) in fixtures::sections() {
            let (_, table) = fixtures::solved(kind, &dimensions, &Fineness::USUAL);
            let turn = Turn::new(View::new(&table), fixtures::case(&dimensions));
            let data = Around::new(&turn, 0.7);
            let svg = around("turn", &data, Some(270.0));
            assert_svg(&svg);
            for curve in &data.curves {
                let most = curve.von_mises.iter().copied().fold(0.0, f64::max);
                assert_eq!(svg.matches(&format!("\n{} up to {} MPa\n", curve.name(), significant(most, 3))).count(), 1);
                let alike = data.curves.iter().filter(|other| look(other) == look(curve));
                assert_eq!(alike.count(), 1, "{kind:?} {}", curve.name());
            }
            assert!(svg.contains("yield strength 270 MPa"));
            assert_eq!(svg.matches("\nbolt\n").count(), 4);
        }
        assert!(around("", &Around { curves: vec![], wrap_deg: 90.0, bolts_deg: vec![] }, None).contains("no check points"));
    }
}
