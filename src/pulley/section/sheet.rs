//! Meshing a strip: stations across the sheet, with nodes on both sides and between.

use super::strip::{Piece, Station};
use super::{Fineness, Flaw};
use crate::pulley::mesh::{Element, Face, MeshEdge};
use glam::DVec2;

/// Most points of the surface that a section may have: the length of the table that is kept of a section.
pub const SURFACE_POINTS: usize = 1024;

/// A place across the sheet where nodes stand.
#[derive(Clone, Copy, Debug)]
pub struct SheetStation {
    /// Where.
    pub station: Station,
    /// The piece of the line that it follows (of two that meet there, the later).
    pub piece: usize,
}

/// Stations along a strip: corners of elements at even positions, the middles of their sides between.
#[derive(Clone, Debug)]
pub struct Stations {
    /// The stations.
    pub places: Vec<SheetStation>,
    /// Of each piece, the positions of its first and last station.
    pub spans: Vec<(usize, usize)>,
}

impl Stations {
    /// Divides the pieces of a line; `cuts` are places (piece, share of its length) where an element must end. On the hub, the first
    /// piece, elements are short from `beside` outwards (mm from the axis): the bracket's edge disturbs the bend beside it.
    pub fn new(pieces: &[Piece], thickness: f64, cuts: &[(usize, f64)], beside: f64, fineness: &Fineness) -> Self {
        let whole: f64 = pieces.iter().map(Piece::length).sum();
        // Large pulleys have longer elements in the same number.
        let straight = fineness.straight * (whole / 140.0).max(1.0);
        let mut stations = Self { places: Vec::new(), spans: Vec::new() };
        for (number, piece) in pieces.iter().enumerate() {
            let mut ends = vec![0.0, 1.0];
            ends.extend(cuts.iter().filter(|(it, share)| *it == number && *share > 0.0 && *share < 1.0).map(|(_, share)| share));
            ends.sort_by(f64::total_cmp);
            ends.dedup();
            let usual = match piece {
                Piece::Straight(..) => straight,
                Piece::Bend { arm, turn, .. } => {
                    // The outside of the bend is the longer side; its elements span no more than a twelfth of the turn each.
                    let radius = arm.length();
                    let outside = if *turn > 0.0 { radius + thickness } else { radius };
                    (fineness.bend * radius / outside).max(piece.length() / 24.0)
                }
            };
            let first = stations.places.len().saturating_sub(1);
            for range in ends.windows(2) {
                let held = number == 0 && piece.station(range[0]).left.y >= beside - 1e-9;
                let size = if held { fineness.held.min(usual) } else { usual };
                let count = (piece.length() * (range[1] - range[0]) / size).ceil().max(1.0) as usize;
                for half in 0..=2 * count {
                    // The station where pieces or cuts meet is there already.
                    if half == 0 && !stations.places.is_empty() {
                        stations.places.last_mut().expect("there is one").piece = number;
                        continue;
                    }
                    let share = range[0] + (range[1] - range[0]) * (half as f64 / (2 * count) as f64);
                    stations.places.push(SheetStation { station: piece.station(share), piece: number });
                }
            }
            stations.spans.push((first, stations.places.len() - 1));
        }
        stations
    }

    /// Position of the station in the middle of a piece.
    pub fn middle(&self, piece: usize) -> usize {
        let (first, last) = self.spans[piece];
        first + (last - first) / 2
    }
}

/// How many nodes stand across the sheet at a station.
pub fn across(position: usize, through: usize) -> usize {
    if position.is_multiple_of(2) { 2 * through + 1 } else { through + 1 }
}

/// The points across the sheet at a station, from the left side.
pub fn points(place: &SheetStation, position: usize, thickness: f64, through: usize) -> impl Iterator<Item = DVec2> {
    let count = across(position, through);
    let Station { left, through } = place.station;
    (0..count).map(move |depth| left + through * (thickness * (depth as f64 / (count - 1) as f64)))
}

/// Elements between stations, given the number of the node at a position and depth.
pub fn elements(positions: usize, through: usize, node: impl Fn(usize, usize) -> u32) -> Vec<Element> {
    let mut elements = Vec::with_capacity(positions / 2 * through);
    for position in (0..positions - 1).step_by(2) {
        let (near, middle, far) = (position, position + 1, position + 2);
        for layer in 0..through {
            let depth = 2 * layer;
            elements.push(Element::quadrilateral([
                node(near, depth),
                node(near, depth + 2),
                node(far, depth + 2),
                node(far, depth),
                node(near, depth + 1),
                node(middle, layer + 1),
                node(far, depth + 1),
                node(middle, layer),
            ]));
        }
    }
    elements
}

/// Which side of the sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// On the line itself.
    Left,
    /// A thickness to its right.
    Right,
}

/// Edges of one side of the sheet; `face` tells what the edge between two stations is, from its piece and the radius of its middle.
pub fn edges(
    stations: &Stations,
    side: Side,
    through: usize,
    node: impl Fn(usize, usize) -> u32,
    face: impl Fn(usize, f64) -> Face,
) -> Vec<MeshEdge> {
    let depth = |position: usize| if side == Side::Left { 0 } else { across(position, through) - 1 };
    let edge = |position: usize| {
        let mut nodes = [position, position + 1, position + 2].map(|it| node(it, depth(it)));
        if side == Side::Right {
            nodes.reverse();
        }
        let middle = &stations.places[position + 1];
        MeshEdge { nodes, face: face(middle.piece, middle.station.left.y) }
    };
    (0..stations.places.len() - 1).step_by(2).map(edge).collect()
}

/// Refuses a section with more surface than its table has room for.
pub fn bounded(edges: usize) -> Result<(), Flaw> {
    if 2 * edges + 2 > SURFACE_POINTS {
        Err(Flaw::Mesh { reason: "the section has too many bends and too much length for its thickness" })
    } else {
        Ok(())
    }
}

/// Share of a straight piece at which it crosses a radius.
pub fn share_at(piece: &Piece, radius: f64) -> f64 {
    match piece {
        Piece::Straight(from, to) => (radius - from.y) / (to.y - from.y),
        Piece::Bend { .. } => f64::NAN,
    }
}
