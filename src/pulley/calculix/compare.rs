//! Compares the results of CalculiX with those of the harmonics.

use super::forces::{Wrench, closed_form};
use super::recovery::Surface;
use super::results::Results;
use super::sweep::Sweep;
use super::{CalculixError, Job, NAME};
use crate::files::read_text;
use crate::pulley::mesh::Mesh;
use crate::pulley::response::{CHECK_POINTS, CHUNK, LONGEST, NAMED, View, respond};
use crate::pulley::section::{self, Fineness};
use crate::pulley::turn::{Case, Turn};
use glam::DVec3;
use std::path::Path;

/// A quantity computed in both ways.
#[derive(Clone, Debug, PartialEq)]
pub struct ComparedQuantity {
    /// What it is.
    pub quantity: String,
    /// Its unit.
    pub unit: &'static str,
    /// By harmonics, on the section mesh that studies use. For a reaction: the sum of the loads in closed form, reversed.
    pub harmonic: f64,
    /// By harmonics up to the 60th, on the section mesh that was swept.
    pub same_section: f64,
    /// By CalculiX.
    pub calculix: f64,
}

impl ComparedQuantity {
    /// The harmonics less CalculiX, in per cent of CalculiX.
    pub fn difference(&self) -> f64 {
        100.0 * (self.harmonic / self.calculix - 1.0)
    }

    /// The same on the section mesh that was swept.
    pub fn difference_on_same_section(&self) -> f64 {
        100.0 * (self.same_section / self.calculix - 1.0)
    }
}

/// Most bytes of a deck and of its results.
const MOST_BYTES: u64 = 512 << 20;

/// The results of both ways for a pulley.
struct SolverAnswers {
    rim_displacement: f64,
    volume: f64,
    largest: f64,
    /// z and r, mm, and angle, deg, of the largest stress.
    place: [f64; 3],
    check_points: [Option<f64>; CHECK_POINTS.len()],
}

/// Reads `pulley.inp` and `pulley.dat` in a directory and compares.
///
/// # Errors
/// A file that cannot be read or is incomplete.
pub fn compare(directory: &Path) -> Result<Vec<ComparedQuantity>, CalculixError> {
    let read = |extension: &str| {
        let path = directory.join(NAME).with_extension(extension);
        read_text(&path, MOST_BYTES, "export a coarser mesh").map_err(|error| CalculixError::Taken { what: error.to_string() })
    };
    let deck = read("inp")?;
    let job = Job::from_deck(&deck)?;
    let results = Results::new(&read("dat")?)?;
    let mesh = section::mesh(job.kind, &job.dimensions, &job.fineness).map_err(CalculixError::Flaw)?;
    let sweep = Sweep::new(&mesh, job.sectors);
    // Every node takes a line: a mesh with more nodes than the deck has bytes is refused before it is built.
    let positions = if sweep.nodes() <= deck.len() { sweep.positions(&mesh) } else { Vec::new() };
    if !has_nodes(&deck, &positions) {
        let what =
            "the deck has other nodes than its first lines give: it was changed, or another version of beltspace wrote it".to_owned();
        return Err(CalculixError::Unreadable { what });
    }
    let usual = harmonics(&job, &Fineness::USUAL)?;
    let same = harmonics(&job, &Fineness { harmonics: 60, every: true, ..job.fineness })?;
    let solid = calculix(&mesh, &job, &sweep, &results)?;
    let mut rows = Vec::new();
    let mut row = |quantity: String, unit: &'static str, harmonic: f64, same_section: f64, calculix: f64| {
        rows.push(ComparedQuantity { quantity, unit, harmonic, same_section, calculix });
    };
    row("rim displacement".to_owned(), "mm", usual.rim_displacement, same.rim_displacement, solid.rim_displacement);
    row("volume".to_owned(), "mm^3", usual.volume, same.volume, solid.volume);
    row("largest stress".to_owned(), "MPa", usual.largest, same.largest, solid.largest);
    for (number, (name, unit)) in [("z", "mm"), ("r", "mm"), ("angle", "deg")].into_iter().enumerate() {
        row(format!("largest stress: {name}"), unit, usual.place[number], same.place[number], solid.place[number]);
    }
    for (number, name) in CHECK_POINTS.iter().enumerate() {
        if let (Some(usual), Some(same), Some(solid)) = (usual.check_points[number], same.check_points[number], solid.check_points[number])
        {
            row(format!("stress at {name}"), "MPa", usual, same, solid);
        }
    }
    let at = |(&node, &force)| positions.get(node).map(|&position| (position, force));
    let Some(reactions) = results.reactions.iter().map(at).collect::<Option<Vec<_>>>() else {
        return Err(CalculixError::Unreadable {
            what: "the results have a node that the deck has not: they are of another deck".to_owned(),
        });
    };
    let reaction = Wrench::of(reactions.into_iter());
    let load = closed_form(&job.dimensions, &job.case);
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let expected = -load.force[axis];
        row(format!("reaction {name}"), "N", expected, expected, reaction.force[axis]);
    }
    row("reaction torque".to_owned(), "N mm", -load.moment.z, -load.moment.z, reaction.moment.z);
    Ok(rows)
}

/// Does the deck have these nodes, in this order?
fn has_nodes(deck: &str, positions: &[DVec3]) -> bool {
    let block = deck.lines().skip_while(|line| !line.starts_with("*NODE,")).skip(1).take_while(|line| !line.starts_with('*'));
    let mut expected = positions.iter();
    let same = |line: &str, at: &DVec3| {
        let numbers = line.split(',').skip(1).map(str::parse::<f64>);
        numbers.zip(at.to_array()).all(|(number, value)| number.is_ok_and(|number| (number - value).abs() < 1e-6))
    };
    block.into_iter().all(|line| expected.next().is_some_and(|at| same(line, at))) && expected.next().is_none()
}

fn harmonics(job: &Job, fineness: &Fineness) -> Result<SolverAnswers, CalculixError> {
    let mesh = section::mesh(job.kind, &job.dimensions, fineness).map_err(CalculixError::Flaw)?;
    let case = Case { phase: Some(job.case.phase.unwrap_or(0.0)), ..job.case };
    // No more than three points per edge and twelve stresses per harmonic.
    let room = (3 * mesh.surface.len() + CHUNK + NAMED) * 12 * (fineness.harmonics + 3);
    let mut table = vec![0.0; room.max(LONGEST)];
    let length = respond(&mesh, job.kind, &job.dimensions, job.poisson, fineness, &mut table);
    let view = View::new(&table[..length]);
    let summary = Turn::new(view, case).summary(None, [None; 2]);
    let largest = summary.largest;
    Ok(SolverAnswers {
        rim_displacement: summary.rim_displacement,
        volume: view.volume(),
        largest: largest.stress,
        place: [view.z()[largest.point], view.r()[largest.point], largest.theta.to_degrees()],
        check_points: summary.check_points.map(|peak| peak.map(|peak| peak.stress)),
    })
}

fn calculix(mesh: &Mesh, job: &Job, sweep: &Sweep, results: &Results) -> Result<SolverAnswers, CalculixError> {
    let surface = Surface::new(mesh, job, sweep, results)?;
    let peaks = surface.peaks();
    let excluded = job.dimensions.excluded_radius(job.kind);
    // As with the harmonics: not beside bracket and bolt heads, nor beside other places where stress is singular.
    let counts = |node: u32| {
        let at = mesh.nodes[node as usize];
        at.y >= excluded && !mesh.singular.iter().any(|(place, distance)| at.distance(*place) <= distance * (1.0 + 1e-9))
    };
    let counted = peaks.iter().filter(|peak| counts(peak.node));
    let none = || CalculixError::Unreadable { what: "no surface outside the bracket".to_owned() };
    let largest = counted.max_by(|a, b| a.stress.total_cmp(&b.stress)).ok_or_else(none)?;
    let at = mesh.nodes[largest.node as usize];
    let check_point = |name: &str| {
        let node = mesh.points.iter().find(|point| point.name == name)?.node;
        peaks.iter().find(|peak| peak.node == node).map(|peak| peak.stress)
    };
    Ok(SolverAnswers {
        rim_displacement: surface.rim_displacement(),
        volume: results.volume.unwrap_or(f64::NAN),
        largest: largest.stress,
        place: [at.x, at.y, largest.theta.to_degrees()],
        check_points: CHECK_POINTS.map(check_point),
    })
}
