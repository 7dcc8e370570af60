//! Type 3: two grooves rolled from one sheet.
//!
//! From the bore: flat hub, bend B, cup wall, bend C, radial wall, ridge (D and a second bend), first groove (E, F), ridge, second
//! groove, rim.

use super::pressed_cup::CupLine;
use super::strip::{Corner, rounded};
use super::{Dimensions, Fineness, Flaw, Outline};
use crate::pulley::mesh::Mesh;
use glam::DVec2;

fn line(d: &Dimensions) -> Result<CupLine, Flaw> {
    let (floor, rim) = (d.floor_radius(), d.rim_radius());
    let (at_floor, at_rim) = (d.half_width(floor), d.half_width(rim));
    let order = |larger, smaller, by| if by > 0.0 { Ok(()) } else { Err(Flaw::Order { larger, smaller, by }) };
    order("the groove's width at its floor", "0", 2.0 * at_floor)?;
    order("cup_diameter_mm", "bore_diameter_mm", d.cup_radius - d.bore_radius)?;
    order("wall_diameter_mm", "cup_diameter_mm", d.wall_radius - d.cup_radius)?;
    order("the groove's floor", "wall_diameter_mm", floor - d.wall_radius)?;
    let corner = |name, z, r, radius| Corner { at: DVec2::new(z, r), radius, name };
    let first = d.wall_offset + d.ridge_width + at_rim;
    let second = first + 2.0 * at_rim + d.ridge_width;
    let corners = [
        corner("B", 0.0, d.cup_radius, d.hub_bend_radius),
        corner("C", d.wall_offset, d.wall_radius, d.web_bend_radius),
        corner("D", d.wall_offset, rim, d.fold_radius),
        corner("the first ridge's second bend", first - at_rim, rim, d.fold_radius),
        corner("E", first - at_floor, floor, d.floor_bend_radius),
        corner("F", first + at_floor, floor, d.floor_bend_radius),
        corner("the second ridge's first bend", first + at_rim, rim, d.fold_radius),
        corner("the second ridge's second bend", second - at_rim, rim, d.fold_radius),
        corner("the second groove's first corner", second - at_floor, floor, d.floor_bend_radius),
        corner("the second groove's second corner", second + at_floor, floor, d.floor_bend_radius),
    ];
    const FLANKS: [(&str, &str); 4] = [
        ("the first ridge's second bend", "E"),
        ("F", "the second ridge's first bend"),
        ("the second ridge's second bend", "the second groove's first corner"),
        ("the second groove's second corner", "end"),
    ];
    let end = DVec2::new(second + at_rim, rim);
    let line = CupLine::new(rounded(DVec2::new(0.0, d.bore_radius), &corners, end, d.thickness)?, &FLANKS);
    line.check(d)?;
    Ok(line)
}

pub(super) fn outline(dimensions: &Dimensions) -> Result<Outline, Flaw> {
    Ok(line(dimensions)?.outline(dimensions))
}

pub(super) fn mesh(dimensions: &Dimensions, fineness: &Fineness) -> Result<Mesh, Flaw> {
    line(dimensions)?.mesh(dimensions, fineness)
}
