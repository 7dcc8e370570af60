//! Stress on the surface of the three-dimensional model, from its displacements.
//!
//! Displacements are vectors in space: their slope along the section comes from the edges, around the axis from a trigonometric
//! polynomial through the planes. Strain in the surface and the known normal pressure give the stress.

use super::results::Results;
use super::sweep::Sweep;
use super::{CalculixError, Job};
use crate::pulley::loads::EdgePoint;
use crate::pulley::mesh::{Face, Mesh};
use crate::pulley::turn::von_mises_squared;
use glam::{DVec2, DVec3};
use std::collections::HashMap;
use std::f64::consts::PI;

/// Angles evaluated per sector: between the planes by the trigonometric polynomial.
const FINER: usize = 12;

/// Displacement and its derivative by the angle, at the evaluated angles.
type Ring = Vec<[DVec3; 2]>;

/// The displacement field on the surface.
#[derive(Debug)]
pub struct Surface<'m> {
    mesh: &'m Mesh,
    job: &'m Job,
    rings: HashMap<u32, Ring>,
    angles: usize,
}

/// A stress on the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceStress {
    /// Von Mises stress, MPa.
    pub stress: f64,
    /// Node of the section.
    pub node: u32,
    /// Angle from the slack end, rad.
    pub theta: f64,
}

/// Strain along the section and around the axis, and the shear between them.
type Strain = [f64; 3];

impl<'m> Surface<'m> {
    /// Takes the displacements of all surface nodes from the results.
    ///
    /// # Errors
    /// A surface node without displacement.
    pub fn new(mesh: &'m Mesh, job: &'m Job, sweep: &Sweep, results: &Results) -> Result<Self, CalculixError> {
        let mut rings = HashMap::new();
        let waves = RecoveredWaves::new(sweep.sectors());
        for node in mesh.surface.iter().flat_map(|edge| edge.nodes).chain([mesh.rim]) {
            if rings.contains_key(&node) {
                continue;
            }
            let on_plane = |sector: usize| {
                let number = sweep.on_plane(sector, node);
                let missing = || CalculixError::Unreadable { what: format!("node {} has no displacement in the results", number + 1) };
                results.displacements.get(&number).copied().ok_or_else(missing)
            };
            let values: Vec<DVec3> = (0..sweep.sectors()).map(on_plane).collect::<Result<_, _>>()?;
            rings.insert(node, waves.through(&values));
        }
        Ok(Self { mesh, job, rings, angles: FINER * sweep.sectors() })
    }

    fn angle(&self, step: usize) -> f64 {
        2.0 * PI * step as f64 / self.angles as f64
    }

    /// Largest displacement of the rim, mm.
    pub fn rim_displacement(&self) -> f64 {
        self.rings[&self.mesh.rim].iter().map(|[displacement, _]| displacement.length()).fold(0.0, f64::max)
    }

    /// Strains at all angles in a point of an edge.
    fn strains(&self, nodes: [u32; 3], point: &EdgePoint) -> Vec<Strain> {
        let rings = nodes.map(|node| &self.rings[&node]);
        let strain = |step: usize| {
            let (sine, cosine) = (libm::sin(self.angle(step)), libm::cos(self.angle(step)));
            let around = DVec3::new(-sine, cosine, 0.0);
            let along = DVec3::new(point.along.y * cosine, point.along.y * sine, point.along.x);
            let (mut by_length, mut by_angle) = (DVec3::ZERO, DVec3::ZERO);
            for (place, ring) in rings.iter().enumerate() {
                let [displacement, derivative] = ring[step];
                by_length += displacement * point.slope[place];
                by_angle += derivative * point.value[place];
            }
            let by_arc = by_angle / point.at.y;
            [along.dot(by_length), around.dot(by_arc), along.dot(by_arc) + around.dot(by_length)]
        };
        (0..self.angles).map(strain).collect()
    }

    /// The largest von Mises stress over the turn of every node of every smooth stretch of the surface.
    pub fn peaks(&self) -> Vec<SurfaceStress> {
        // Strains at the two points of Gauss of each edge, extended linearly to its nodes and averaged where two edges meet smoothly.
        const GAUSS: f64 = 0.577_350_269_189_625_8;
        const SMOOTH: f64 = 0.8;
        let mut peaks = Vec::new();
        let mut open: Vec<(u32, DVec2, Vec<Strain>, f64)> = Vec::new();
        for edge in &self.mesh.surface {
            let points = self.mesh.edge(edge);
            let [low, high] = [-GAUSS, GAUSS].map(|local| self.strains(edge.nodes, &EdgePoint::new(points, local)));
            let pressed = if edge.face == Face::Band { 1.0 } else { 0.0 };
            for (node, local) in edge.nodes.into_iter().zip([-1.0, 0.0, 1.0]) {
                let upper = 0.5 * (1.0 + local / GAUSS);
                let extended = |(low, high): (&Strain, &Strain)| std::array::from_fn(|it| low[it] + upper * (high[it] - low[it]));
                let strains: Vec<Strain> = low.iter().zip(&high).map(extended).collect();
                let way = EdgePoint::new(points, local).along;
                if local == 0.0 {
                    peaks.push(self.peak(node, &strains, pressed));
                } else if let Some(met) = open.iter().position(|(other, other_way, ..)| *other == node && way.dot(*other_way) > SMOOTH) {
                    let (_, _, others, other_pressed) = open.swap_remove(met);
                    let mean = |(a, b): (&Strain, &Strain)| std::array::from_fn(|it| 0.5 * (a[it] + b[it]));
                    let strains: Vec<Strain> = strains.iter().zip(&others).map(mean).collect();
                    peaks.push(self.peak(node, &strains, 0.5 * (pressed + other_pressed)));
                } else {
                    open.push((node, way, strains, pressed));
                }
            }
        }
        peaks.extend(open.iter().map(|(node, _, strains, pressed)| self.peak(*node, strains, *pressed)));
        peaks
    }

    /// The largest von Mises stress over the turn of a node, `pressed` being the belt's share of it.
    fn peak(&self, node: u32, strains: &[Strain], pressed: f64) -> SurfaceStress {
        let case = &self.job.case;
        let poisson = self.job.poisson;
        let radius = self.mesh.nodes[node as usize].y;
        let mut best = SurfaceStress { node, ..SurfaceStress::default() };
        for (step, [along, around, shear]) in strains.iter().enumerate() {
            let theta = self.angle(step);
            let normal = if theta <= case.wrap { -pressed * case.normal * libm::exp(case.growth * theta) / radius } else { 0.0 };
            let plane = case.modulus / (1.0 - poisson * poisson);
            // Less the normal stress, which adds poisson/(1 - poisson) of itself to both.
            let share = (poisson / (1.0 - poisson) - 1.0) * normal;
            let tension = [along + poisson * around, around + poisson * along].map(|it| plane * it + share);
            let stress = von_mises_squared([tension[0], tension[1], 0.5 * case.modulus / (1.0 + poisson) * shear]).sqrt();
            if stress > best.stress {
                best = SurfaceStress { stress, node, theta };
            }
        }
        best
    }
}

/// Cosines and sines of the trigonometric polynomial through equally spaced planes.
struct RecoveredWaves {
    planes: usize,
    /// At the evaluated angles.
    table: Vec<(f64, f64)>,
}

impl RecoveredWaves {
    fn new(planes: usize) -> Self {
        let count = FINER * planes;
        let wave = |step: usize| {
            let angle = 2.0 * PI * step as f64 / count as f64;
            (libm::cos(angle), libm::sin(angle))
        };
        Self { planes, table: (0..count).map(wave).collect() }
    }

    /// The polynomial through values on the planes, and its derivative.
    fn through(&self, values: &[DVec3]) -> Ring {
        let count = self.table.len();
        let mut ring = vec![[DVec3::ZERO; 2]; count];
        for order in 0..=self.planes / 2 {
            // The highest wave of an even number of planes has a cosine only, and half the weight.
            let weight = if order == 0 || 2 * order == self.planes { 1.0 } else { 2.0 } / self.planes as f64;
            let (mut cosines, mut sines) = (DVec3::ZERO, DVec3::ZERO);
            for (plane, &value) in values.iter().enumerate() {
                let (cosine, sine) = self.table[order * plane * FINER % count];
                cosines += value * (weight * cosine);
                sines += value * (weight * sine);
            }
            for (step, at) in ring.iter_mut().enumerate() {
                let (cosine, sine) = self.table[order * step % count];
                at[0] += cosines * cosine + sines * sine;
                at[1] += (sines * cosine - cosines * sine) * order as f64;
            }
        }
        ring
    }
}
