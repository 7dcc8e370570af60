//! Verification of the finite elements against closed forms.

mod balance;
mod patch;
mod properties;
mod rings;
mod series;

use super::fixtures::sections;
use super::loads::EdgePoint;
use super::mesh::{Element, Face, Mesh, MeshEdge};
use super::section::{Dimensions, Fineness};
use super::wide::{WIDTH, Wide};
use glam::DVec2;

/// Young's modulus of the cases, MPa.
const MODULUS: f64 = 206_000.0;
/// Their Poisson's ratio.
const POISSON: f64 = 0.29;

/// How the cells of a grid are divided into elements.
#[derive(Clone, Copy, Debug, PartialEq)]
enum CellDivision {
    /// One quadrilateral each.
    Whole,
    /// Two triangles each.
    Split,
}

/// A mesh of `count.0` elements along z and `count.1` along r with corners at `corner(i, j)` and straight sides. Its surface is all
/// around: of the faces, the innermost (small r) is `Bracket`, the outermost `Band`, the first in z `Seat`, the last `Free`.
fn grid(count: (usize, usize), division: CellDivision, corner: impl Fn(usize, usize) -> DVec2) -> Mesh {
    let (columns, rows) = (2 * count.0 + 1, 2 * count.1 + 1);
    // Numbers go along the shorter side first: a narrower band.
    let by_rows = columns <= rows;
    let mut number = vec![u32::MAX; columns * rows];
    let mut nodes = Vec::new();
    let places: Vec<(usize, usize)> = if by_rows {
        (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))).collect()
    } else {
        (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j))).collect()
    };
    for (i, j) in places {
        if division == CellDivision::Whole && i % 2 == 1 && j % 2 == 1 {
            continue;
        }
        number[j * columns + i] = nodes.len() as u32;
        // The middle of a side, or of the diagonal that splits a cell.
        nodes.push(0.5 * (corner(i / 2, j / 2) + corner(i.div_ceil(2), j.div_ceil(2))));
    }
    let at = |i: usize, j: usize| number[j * columns + i];
    let mut elements = Vec::new();
    for (i, j) in (0..count.1).flat_map(|j| (0..count.0).map(move |i| (2 * i, 2 * j))) {
        let [a, b, c, d] = [at(i, j), at(i + 2, j), at(i + 2, j + 2), at(i, j + 2)];
        let [ab, bc, cd, da] = [at(i + 1, j), at(i + 2, j + 1), at(i + 1, j + 2), at(i, j + 1)];
        match division {
            CellDivision::Whole => elements.push(Element::quadrilateral([a, b, c, d, ab, bc, cd, da])),
            CellDivision::Split => {
                let middle = at(i + 1, j + 1);
                elements.push(Element::triangle([a, b, c, ab, bc, middle]));
                elements.push(Element::triangle([a, c, d, middle, cd, da]));
            }
        }
    }
    let mut surface = Vec::new();
    let mut edge = |nodes, face| surface.push(MeshEdge { nodes, face });
    (0..columns - 1).step_by(2).rev().for_each(|i| edge([at(i + 2, 0), at(i + 1, 0), at(i, 0)], Face::Bracket));
    (0..rows - 1).step_by(2).for_each(|j| edge([at(0, j), at(0, j + 1), at(0, j + 2)], Face::Seat));
    let top = rows - 1;
    (0..columns - 1).step_by(2).for_each(|i| edge([at(i, top), at(i + 1, top), at(i + 2, top)], Face::Band));
    let last = columns - 1;
    (0..rows - 1).step_by(2).rev().for_each(|j| edge([at(last, j + 2), at(last, j + 1), at(last, j)], Face::Free));
    Mesh { nodes, elements, surface, points: Vec::new(), rim: 0, singular: Vec::new() }
}

/// The node nearest to a place (z, r).
fn node(mesh: &Mesh, z: f64, r: f64) -> u32 {
    let distance = |node: &usize| mesh.nodes[*node].distance_squared(DVec2::new(z, r));
    (0..mesh.nodes.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap() as u32
}

/// Loads on the degrees of freedom of tractions (r, z and circumference, MPa) on the surface.
fn tractions(mesh: &Mesh, traction: impl Fn(Face, &EdgePoint) -> [f64; 3]) -> Vec<f64> {
    let mut loads = vec![0.0; 3 * mesh.nodes.len()];
    for edge in &mesh.surface {
        for point in EdgePoint::three(mesh.edge(edge)) {
            let traction = traction(edge.face, &point);
            for (&node, value) in edge.nodes.iter().zip(point.value) {
                for axis in 0..3 {
                    loads[3 * node as usize + axis] += value * point.length * point.at.y * traction[axis];
                }
            }
        }
    }
    loads
}

/// Writes loads into one right side of all harmonics.
fn set(values: &mut [Wide], loads: &[f64]) {
    for (value, &load) in values.iter_mut().zip(loads) {
        *value = Wide([load; WIDTH]);
    }
}

/// The pressed cup of the reference numbers, by thickness.
fn cup(thickness: f64) -> Dimensions {
    let [.., (_, cup)] = sections();
    Dimensions { thickness, ..cup }
}

/// As usual, with every harmonic solved.
fn every() -> Fineness {
    Fineness { every: true, ..Fineness::USUAL }
}

/// Fails unless a number is as exact as asked for, relative to its expected value.
#[track_caller]
fn close(found: f64, expected: f64, relative: f64, what: &str) {
    let error = (found - expected) / expected;
    assert!(error.abs() <= relative, "{what}: {found} for {expected}, {:.4} %", 100.0 * error);
}
