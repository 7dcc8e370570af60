//! Type 2: two pressed discs that are mirror images, bonded over the hub out to the weld circle and free beyond.
//!
//! Contact between the discs beyond the weld is not modelled. B is the bend of the disc on the bracket and C that of the other; D
//! and E are their flanks at the mean radius. There is no F.

use super::sheet::{self, Side, Stations};
use super::strip::{Corner, Piece, rounded};
use super::{Dimensions, Fineness, Flaw, Outline};
use crate::pulley::mesh::{CheckPoint, Element, Face, Mesh, MeshEdge};
use glam::DVec2;

/// The left side of the disc on the bracket: hub, bend, flank. The groove is on its right side.
fn line(d: &Dimensions) -> Result<Vec<Piece>, Flaw> {
    // The two flanks would meet where the groove has no width; the back's corner lies half the sheet's shift further in.
    let apex = d.top_radius() - 0.5 * d.groove_width / libm::tan(d.half_angle);
    let corner = Corner { at: DVec2::new(0.0, apex - d.thickness * libm::tan(0.5 * d.half_angle)), radius: d.hub_bend_radius, name: "B" };
    let (sine, cosine) = (libm::sin(d.half_angle), libm::cos(d.half_angle));
    let order = |larger, smaller, by| if by > 0.0 { Ok(()) } else { Err(Flaw::Order { larger, smaller, by }) };
    order("where the groove's flanks meet", "bore_diameter_mm", corner.at.y - d.bore_radius)?;
    let length = (d.rim_radius() - d.thickness * sine - corner.at.y) / cosine;
    order("the rim's edge", "where the groove's flanks meet", length)?;
    let end = corner.at + DVec2::new(-sine, cosine) * length;
    let pieces = rounded(DVec2::new(0.0, d.bore_radius), &[corner], end, d.thickness)?;
    let [Piece::Straight(_, flat), _, Piece::Straight(from, _)] = pieces[..] else {
        return Err(Flaw::Room { before: "start", after: "B", room: 0.0 });
    };
    d.bolts_on_flat(flat.y)?;
    order("weld_diameter_mm", "the outer edge of bracket and bolt heads", d.weld_radius - d.held_radius())?;
    order("the flat hub", "weld_diameter_mm", flat.y - d.weld_radius)?;
    // The groove's side of the flank stands a little further out than the back.
    d.band_on_flank(from.y + d.thickness * sine, d.rim_radius())?;
    Ok(pieces)
}

pub(super) fn outline(d: &Dimensions) -> Result<Outline, Flaw> {
    let disc = Outline::of_strip(&line(d)?, d.thickness);
    let other = disc.iter().rev().map(|&point| mirrored(point, d.thickness)).collect();
    Ok(Outline { parts: vec![disc, other] })
}

/// The mirror image of a point on the other disc.
fn mirrored(point: DVec2, thickness: f64) -> DVec2 {
    DVec2::new(2.0 * thickness - point.x, point.y)
}

pub(super) fn mesh(d: &Dimensions, fineness: &Fineness) -> Result<Mesh, Flaw> {
    let pieces = line(d)?;
    let (hub, bend, flank) = (0, 1, 2);
    let band = d.band();
    // Radii of the groove's side, as the line's left side sees them.
    let lift = d.thickness * libm::sin(d.half_angle);
    let flank_cuts = [band.0, d.mean_radius, band.1].map(|radius| (flank, sheet::share_at(&pieces[flank], radius - lift)));
    let beside = d.beside_bracket();
    let hub_cuts = [beside, d.bracket_radius, d.head_edge(), d.weld_radius].map(|radius| (hub, sheet::share_at(&pieces[hub], radius)));
    let stations = Stations::new(&pieces, d.thickness, &[&hub_cuts[..], &flank_cuts[..]].concat(), beside, fineness);
    let through = fineness.through;
    let count = stations.places.len();
    sheet::bounded(2 * count)?;
    // Out to the weld, which is the station at its cut, the discs share the nodes between them.
    let weld = stations.places.iter().position(|place| place.station.left.y >= d.weld_radius - 1e-9).unwrap_or(0);
    let across = |position| sheet::across(position, through);
    let mut first = Vec::with_capacity(count);
    let mut nodes = Vec::new();
    for (position, place) in stations.places.iter().enumerate() {
        first.push(nodes.len() as u32);
        let own: Vec<DVec2> = sheet::points(place, position, d.thickness, through).collect();
        let shared = usize::from(position <= weld);
        nodes.extend(&own);
        nodes.extend(own.iter().rev().skip(shared).map(|&point| mirrored(point, d.thickness)));
    }
    let node = |position: usize, depth: usize| first[position] + depth as u32;
    // In the other disc too, depth counts from its own back.
    let mirrored = |position: usize, depth: usize| {
        let last = 2 * across(position) - 1 - usize::from(position <= weld);
        first[position] + (last - depth) as u32
    };
    let mut elements = sheet::elements(count, through, node);
    elements.extend(sheet::elements(count, through, mirrored).iter().map(flipped));
    let back = |piece, radius| if piece == hub && radius < d.bracket_radius { Face::Bracket } else { Face::Free };
    let front = |piece, _| if piece == hub { Face::Seat } else { Face::Free };
    let groove = |piece, radius: f64| {
        if piece == flank && radius + lift > band.0 && radius + lift < band.1 { Face::Band } else { Face::Free }
    };
    let inside = |edge: &MeshEdge| {
        let place = edge.nodes[1];
        (0..count).step_by(2).take_while(|&position| position < weld).any(|position| node(position + 1, across(position + 1) - 1) == place)
    };
    let mut surface = sheet::edges(&stations, Side::Left, through, node, back);
    surface.extend(sheet::edges(&stations, Side::Right, through, node, groove).into_iter().filter(|edge| !inside(edge)));
    let others =
        [sheet::edges(&stations, Side::Left, through, mirrored, front), sheet::edges(&stations, Side::Right, through, mirrored, groove)];
    let reversed = |edge: MeshEdge| MeshEdge { nodes: [edge.nodes[2], edge.nodes[1], edge.nodes[0]], ..edge };
    surface.extend(others.into_iter().flatten().map(reversed).filter(|edge| !inside(edge)));
    let mean = stations.places.iter().position(|place| place.piece == flank && place.station.left.y + lift >= d.mean_radius - 1e-9);
    let (at_bend, at_mean) = (stations.middle(bend), mean.unwrap_or(count - 1));
    let point = |name, node| CheckPoint { name, node };
    let points = vec![
        point("Bl", node(at_bend, 0)),
        point("Br", node(at_bend, across(at_bend) - 1)),
        point("Cl", mirrored(at_bend, across(at_bend) - 1)),
        point("Cr", mirrored(at_bend, 0)),
        point("Dl", node(at_mean, 0)),
        point("Dr", node(at_mean, across(at_mean) - 1)),
        point("El", mirrored(at_mean, across(at_mean) - 1)),
        point("Er", mirrored(at_mean, 0)),
    ];
    // The gap between the discs ends at the weld like a crack.
    let singular = vec![(DVec2::new(d.thickness, d.weld_radius), d.thickness)];
    Ok(Mesh { nodes, elements, surface, points, rim: node(count - 1, through), singular })
}

/// The same element with its nodes the other way round: a mirror image runs clockwise.
fn flipped(element: &Element) -> Element {
    let n = element.nodes();
    Element::quadrilateral([n[1], n[0], n[3], n[2], n[4], n[7], n[6], n[5]])
}
