//! Type 1: a machined or cast pulley with one groove.
//!
//! A hub plate, a cup's wall, a web at the groove's middle and a rim. Inner corners have fillets: sharp ones are singular. The check
//! points are the fillets: B between hub plate and wall, C between wall and web, D between web and rim on both sides, E and F in the
//! groove; each has one surface, so `Bl`, `Cr`, `Er` and `Fr` do not exist. The mesh is a constrained Delaunay triangulation.

use super::strip::{Corner, Piece, rounded};
use super::{Dimensions, Fineness, Flaw, Outline, sheet};
use crate::pulley::mesh::{CheckPoint, Element, Face, Mesh, MeshEdge};
use crate::pulley::numbering;
use glam::DVec2;
use spade::{AngleLimit, ConstrainedDelaunayTriangulation, Point2, RefinementParameters, Triangulation};
use std::collections::{HashMap, HashSet};

/// Straight pieces of the line by their place in the outline, counted from the hub's back.
const BACK: usize = 0;

fn line(d: &Dimensions) -> Result<Vec<Piece>, Flaw> {
    let (floor, rim) = (d.floor_radius(), d.rim_radius());
    let under = floor - d.rim_thickness;
    let inner = d.cup_radius - d.wall_thickness;
    let half_web = 0.5 * d.thickness;
    let (web_left, web_right) = (d.groove_offset - half_web, d.groove_offset + half_web);
    let half_rim = d.half_width(rim) + d.lip_thickness;
    let (rim_left, rim_right) = (d.groove_offset - half_rim, d.groove_offset + half_rim);
    let order = |larger, smaller, by| if by > 0.0 { Ok(()) } else { Err(Flaw::Order { larger, smaller, by }) };
    order("the groove's width at its floor", "0", 2.0 * d.half_width(floor))?;
    order("the wall's inside", "bore_diameter_mm", inner - d.bore_radius)?;
    order("the rim's underside", "cup_diameter_mm", under - d.cup_radius)?;
    order("the web's left face", "the hub plate's right face", web_left - d.thickness)?;
    order("the rim's width", "the web's thickness", half_rim - half_web)?;
    let corner = |name, z, r, radius| Corner { at: DVec2::new(z, r), radius, name };
    let sharp = |z, r| corner("", z, r, 0.0);
    let corners = [
        sharp(0.0, d.cup_radius),
        corner("Cl", web_left, d.cup_radius, d.fillet_radius),
        corner("Dl", web_left, under, d.fillet_radius),
        sharp(rim_left, under),
        sharp(rim_left, rim),
        sharp(d.groove_offset - d.half_width(rim), rim),
        corner("El", d.groove_offset - d.half_width(floor), floor, d.floor_bend_radius),
        corner("Fl", d.groove_offset + d.half_width(floor), floor, d.floor_bend_radius),
        sharp(d.groove_offset + d.half_width(rim), rim),
        sharp(rim_right, rim),
        sharp(rim_right, under),
        corner("Dr", web_right, under, d.fillet_radius),
        sharp(web_right, inner),
        corner("Br", d.thickness, inner, d.fillet_radius),
    ];
    let (start, end) = (DVec2::new(0.0, d.bore_radius), DVec2::new(d.thickness, d.bore_radius));
    let mut pieces = rounded(start, &corners, end, 0.0)?;
    d.bolts_on_flat((inner - d.fillet_radius).min(d.cup_radius))?;
    for piece in &pieces {
        if let Some((from, to)) = flank(d, piece) {
            d.band_on_flank(from.y.min(to.y), from.y.max(to.y))?;
        }
    }
    pieces.push(Piece::Straight(end, start));
    Ok(pieces)
}

/// The ends of a piece that is a flank of the groove.
fn flank(d: &Dimensions, piece: &Piece) -> Option<(DVec2, DVec2)> {
    match piece {
        Piece::Straight(from, to) => {
            let off = |point: &DVec2| ((point.x - d.groove_offset).abs() - d.half_width(point.y)).abs();
            (off(from) < 1e-9 && off(to) < 1e-9 && (from.y - to.y).abs() > 1e-9).then_some((*from, *to))
        }
        Piece::Bend { .. } => None,
    }
}

pub(super) fn outline(d: &Dimensions) -> Result<Outline, Flaw> {
    let mut points = Outline::of_strip(&line(d)?, 0.0);
    // Of a strip without thickness the way back is the way there.
    points.truncate(points.len() / 2);
    Ok(Outline { parts: vec![points] })
}

/// A side of the boundary: its start, its middle and what it is.
struct Chord {
    start: DVec2,
    middle: DVec2,
    face: Face,
    /// The check point that stands in its middle or at its start, by name and whether in the middle.
    point: Option<(&'static str, bool)>,
}

fn boundary(d: &Dimensions, pieces: &[Piece], fineness: &Fineness) -> Vec<Chord> {
    let band = d.band();
    let scale = (d.mean_radius / 55.5).max(1.0);
    let mut chords = Vec::new();
    for (number, piece) in pieces.iter().enumerate() {
        let mut ends = vec![0.0, 1.0];
        if number == BACK {
            ends.push(sheet::share_at(piece, d.bracket_radius));
        }
        let on_flank = flank(d, piece).is_some();
        if on_flank {
            ends.extend([band.0, band.1].map(|radius| sheet::share_at(piece, radius)));
        }
        ends.retain(|share| (0.0..=1.0).contains(share));
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        let seat = matches!(piece, Piece::Straight(from, to) if from.x == d.thickness && to.x == d.thickness && to.y == d.bore_radius);
        let size = match piece {
            Piece::Straight(..) => fineness.solid * scale,
            Piece::Bend { turn, .. } => (0.5 * fineness.bend).max(piece.length() / 16.0).min(piece.length() / (turn.abs() * 4.0)),
        };
        for range in ends.windows(2) {
            let mut count = (piece.length() * (range[1] - range[0]) / size).ceil().max(1.0) as usize;
            let name = match piece {
                Piece::Bend { name, .. } => {
                    // The check point stands where two sides meet.
                    count = count.next_multiple_of(2);
                    Some(*name)
                }
                Piece::Straight(..) => None,
            };
            for chord in 0..count {
                let at = |part: f64| piece.station(range[0] + (range[1] - range[0]) * (part / count as f64)).left;
                let (start, middle) = (at(chord as f64), at(chord as f64 + 0.5));
                let face = if number == BACK && middle.y < d.bracket_radius {
                    Face::Bracket
                } else if seat {
                    Face::Seat
                } else if on_flank && middle.y > band.0 && middle.y < band.1 {
                    Face::Band
                } else {
                    Face::Free
                };
                let point = name.filter(|_| 2 * chord == count).map(|name| (name, false));
                chords.push(Chord { start, middle, face, point });
            }
        }
    }
    chords
}

pub(super) fn mesh(d: &Dimensions, fineness: &Fineness) -> Result<Mesh, Flaw> {
    let chords = boundary(d, &line(d)?, fineness);
    sheet::bounded(chords.len())?;
    const FAILED: Flaw = Flaw::Mesh { reason: "the outline could not be triangulated" };
    let mut triangulation = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let corners: Result<Vec<_>, _> = chords.iter().map(|chord| triangulation.insert(Point2::new(chord.start.x, chord.start.y))).collect();
    let corners = corners.map_err(|_| FAILED)?;
    for (number, &corner) in corners.iter().enumerate() {
        triangulation.add_constraint(corner, corners[(number + 1) % corners.len()]);
    }
    let size = fineness.solid * (d.mean_radius / 55.5).max(1.0);
    let parameters = RefinementParameters::<f64>::new()
        .exclude_outer_faces(true)
        .keep_constraint_edges()
        .with_angle_limit(AngleLimit::from_radius_to_shortest_edge_ratio(1.1))
        .with_max_allowed_area(0.6 * size * size)
        .with_max_additional_vertices(20_000);
    let refined = triangulation.refine(parameters);
    if !refined.refinement_complete {
        return Err(FAILED);
    }
    let outside: HashSet<_> = refined.excluded_faces.into_iter().collect();
    let mut nodes: Vec<DVec2> = triangulation.vertices().map(|vertex| DVec2::new(vertex.position().x, vertex.position().y)).collect();
    // The middle of a side on the boundary lies on the true line.
    let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
    let key = |a: u32, b: u32| (a.min(b), a.max(b));
    let mut surface = Vec::with_capacity(chords.len());
    let mut points = Vec::new();
    for (number, chord) in chords.iter().enumerate() {
        let (a, b) = (corners[number].index() as u32, corners[(number + 1) % corners.len()].index() as u32);
        let middle = nodes.len() as u32;
        nodes.push(chord.middle);
        middles.insert(key(a, b), middle);
        surface.push(MeshEdge { nodes: [a, middle, b], face: chord.face });
        if let Some((name, in_the_middle)) = chord.point {
            points.push(CheckPoint { name, node: if in_the_middle { middle } else { a } });
        }
    }
    let mut elements = Vec::new();
    for face in triangulation.inner_faces().filter(|face| !outside.contains(&face.fix())) {
        let [a, b, c] = face.vertices().map(|vertex| vertex.index() as u32);
        let mut middle = |a: u32, b: u32| {
            *middles.entry(key(a, b)).or_insert_with(|| {
                nodes.push(0.5 * (nodes[a as usize] + nodes[b as usize]));
                nodes.len() as u32 - 1
            })
        };
        elements.push(Element::triangle([a, b, c, middle(a, b), middle(b, c), middle(c, a)]));
    }
    points.sort_by_key(|point: &CheckPoint| point.name);
    // The rim's outer edge on the side away from the bracket.
    let tip = chords.iter().rposition(|chord| (chord.start.y - d.rim_radius()).abs() < 1e-9).ok_or(FAILED)?;
    let rim = corners[tip].index() as u32;
    Ok(numbering::renumbered(Mesh { nodes, elements, surface, points, rim, singular: Vec::new() }))
}
