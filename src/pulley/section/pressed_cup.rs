//! Type 4: a one-piece pressed cup with a rolled rim.
//!
//! From the bore: flat hub, bend B, cup wall, bend C, radial wall, fold D, first flank, corner E, floor, corner F, second flank, rim.

use super::sheet::{self, Side, Stations};
use super::strip::{Corner, Piece, rounded};
use super::{Dimensions, Fineness, Flaw, Outline};
use crate::pulley::mesh::{CheckPoint, Face, Mesh};
use glam::DVec2;

/// The line of a one-sheet section, and what is where on it.
#[derive(Debug)]
pub(super) struct CupLine {
    pub pieces: Vec<Piece>,
    /// The straight hub.
    pub hub: usize,
    /// The straight flanks.
    pub flanks: Vec<usize>,
    /// Bends at which stress is read: names of the left and right side, and the piece.
    pub bends: Vec<([&'static str; 2], usize)>,
}

/// Names of the check points on both sides of a bend.
pub(super) fn sides(bend: &str) -> Option<[&'static str; 2]> {
    const NAMES: [(&str, [&str; 2]); 5] =
        [("B", ["Bl", "Br"]), ("C", ["Cl", "Cr"]), ("D", ["Dl", "Dr"]), ("E", ["El", "Er"]), ("F", ["Fl", "Fr"])];
    NAMES.iter().find(|(name, _)| *name == bend).map(|(_, sides)| *sides)
}

impl CupLine {
    /// Finds hub, flanks and bends among the pieces. `flanks` are the bends between which a flank lies, in order.
    pub fn new(pieces: Vec<Piece>, flanks: &[(&str, &str)]) -> Self {
        let name = |piece: Option<&Piece>| match piece {
            Some(Piece::Bend { name, .. }) => *name,
            _ => "end",
        };
        let is_flank = |&number: &usize| {
            let ends = (name(pieces.get(number.wrapping_sub(1))), name(pieces.get(number + 1)));
            matches!(pieces[number], Piece::Straight(..)) && flanks.contains(&ends)
        };
        let flanks = (0..pieces.len()).filter(is_flank).collect();
        let bends = pieces.iter().enumerate().filter_map(|(number, piece)| Some((sides(name(Some(piece)))?, number))).collect();
        Self { pieces, hub: 0, flanks, bends }
    }

    /// Checks hub and flanks.
    pub fn check(&self, dimensions: &Dimensions) -> Result<(), Flaw> {
        let flat = match self.pieces[self.hub] {
            Piece::Straight(_, to) => to.y,
            Piece::Bend { .. } => dimensions.bore_radius,
        };
        dimensions.bolts_on_flat(flat)?;
        for &flank in &self.flanks {
            if let Piece::Straight(from, to) = self.pieces[flank] {
                dimensions.band_on_flank(from.y.min(to.y), from.y.max(to.y))?;
            }
        }
        Ok(())
    }

    pub fn outline(&self, dimensions: &Dimensions) -> Outline {
        Outline { parts: vec![Outline::of_strip(&self.pieces, dimensions.thickness)] }
    }

    pub fn mesh(&self, dimensions: &Dimensions, fineness: &Fineness) -> Result<Mesh, Flaw> {
        let band = dimensions.band();
        let beside = dimensions.beside_bracket();
        let on_hub = |radius| (self.hub, sheet::share_at(&self.pieces[self.hub], radius));
        let mut cuts = vec![on_hub(beside), on_hub(dimensions.bracket_radius), on_hub(dimensions.head_edge())];
        for &flank in &self.flanks {
            cuts.extend([band.0, band.1].map(|radius| (flank, sheet::share_at(&self.pieces[flank], radius))));
        }
        let stations = Stations::new(&self.pieces, dimensions.thickness, &cuts, beside, fineness);
        let through = fineness.through;
        let count = stations.places.len();
        sheet::bounded(count - 1)?;
        let first: Vec<u32> = (0..count)
            .scan(0, |next, position| {
                *next += sheet::across(position, through) as u32;
                Some(*next - sheet::across(position, through) as u32)
            })
            .collect();
        let node = |position: usize, depth: usize| first[position] + depth as u32;
        let places = stations.places.iter().enumerate();
        let nodes = places.flat_map(|(position, place)| sheet::points(place, position, dimensions.thickness, through)).collect();
        let left = sheet::edges(&stations, Side::Left, through, node, |piece, radius| {
            if piece == self.hub && radius < dimensions.bracket_radius {
                Face::Bracket
            } else if self.flanks.contains(&piece) && radius > band.0 && radius < band.1 {
                Face::Band
            } else {
                Face::Free
            }
        });
        let right = sheet::edges(&stations, Side::Right, through, node, |piece, _| if piece == self.hub { Face::Seat } else { Face::Free });
        let points = self.bends.iter().flat_map(|&([left, right], bend)| {
            let position = stations.middle(bend);
            let last = sheet::across(position, through) - 1;
            [CheckPoint { name: left, node: node(position, 0) }, CheckPoint { name: right, node: node(position, last) }]
        });
        Ok(Mesh {
            nodes,
            elements: sheet::elements(count, through, node),
            surface: left.into_iter().chain(right).collect(),
            points: points.collect(),
            rim: node(count - 1, through),
            singular: Vec::new(),
        })
    }
}

fn line(d: &Dimensions) -> Result<CupLine, Flaw> {
    let tangent = libm::tan(d.half_angle);
    let fold = d.fold_radius * (1.0 + libm::cos(d.half_angle));
    // The fold ends at the groove's top, which places the groove.
    let mid_plane = d.wall_offset + fold + 0.5 * d.groove_width;
    let (floor, rim) = (d.floor_radius(), d.rim_radius());
    let corner = |name, z, r, radius| Corner { at: DVec2::new(z, r), radius, name };
    let corners = [
        corner("B", 0.0, d.cup_radius, d.hub_bend_radius),
        corner("C", d.wall_offset, d.wall_radius, d.web_bend_radius),
        corner("D", d.wall_offset, d.top_radius() + fold / tangent, d.fold_radius),
        corner("E", mid_plane - d.half_width(floor), floor, d.floor_bend_radius),
        corner("F", mid_plane + d.half_width(floor), floor, d.floor_bend_radius),
    ];
    let order = |larger, smaller, by| if by > 0.0 { Ok(()) } else { Err(Flaw::Order { larger, smaller, by }) };
    order("the groove's width at its floor", "0", 2.0 * d.half_width(floor))?;
    order("cup_diameter_mm", "bore_diameter_mm", d.cup_radius - d.bore_radius)?;
    order("wall_diameter_mm", "cup_diameter_mm", d.wall_radius - d.cup_radius)?;
    order("the groove's floor", "wall_diameter_mm", floor - d.wall_radius)?;
    let end = DVec2::new(mid_plane + d.half_width(rim), rim);
    let line = CupLine::new(rounded(DVec2::new(0.0, d.bore_radius), &corners, end, d.thickness)?, &[("D", "E"), ("F", "end")]);
    line.check(d)?;
    Ok(line)
}

pub(super) fn outline(dimensions: &Dimensions) -> Result<Outline, Flaw> {
    Ok(line(dimensions)?.outline(dimensions))
}

pub(super) fn mesh(dimensions: &Dimensions, fineness: &Fineness) -> Result<Mesh, Flaw> {
    line(dimensions)?.mesh(dimensions, fineness)
}
