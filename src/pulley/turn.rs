//! A load case over one revolution: the stresses of every surface point at every angle, the largest of them, and the fatigue of the
//! rotating pulley.
//!
//! The loads stand still and the pulley rotates: over one revolution a point of the surface goes through the stresses around the
//! circumference. Stresses are sums of harmonics; they are added up at 96 angles by the symmetries of cosine and sine (a quarter of the
//! angles gives the other three), and near the largest value again at finer angles.

#![allow(clippy::needless_range_loop, reason = "loops over lanes, of constant length, are what the compiler makes vectors of")]

use super::chunk::{ChunkStresses, QUARTER, Term, Terms, Waves, farthest, largest_of, length_squared, limits, synthesise};
use super::loads::{Complex, belt_harmonic};
use super::response::{BELT, CHECK_POINTS, CHUNK, NAMED, RIM, STRESSES, View};
use super::wide::Wide;
use std::f64::consts::PI;

pub use super::chunk::{ANGLES, Stress, von_mises_squared};

/// Loads on a section, N, mm and MPa, angles in rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// Normal force on a flank at the slack end, per length of band and angle: R(0) R_b / L, N/mm.
    pub normal: f64,
    /// Friction along the flank over normal force.
    pub along: f64,
    /// Friction around the circumference over normal force.
    pub around: f64,
    /// Growth of the load with the angle, mu'.
    pub growth: f64,
    /// Wrap angle.
    pub wrap: f64,
    /// Pressure under the bolt heads, MPa.
    pub pressure: f64,
    /// Angle of the first bolt from the slack end; none for the worst of all.
    pub phase: Option<f64>,
    /// Density times square of the angular speed, N/mm^4.
    pub spin: f64,
    /// Elastic modulus, MPa.
    pub modulus: f64,
}

/// The largest von Mises stress of a surface point over the turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    /// Number of the point.
    pub point: usize,
    /// Stress, MPa.
    pub stress: f64,
    /// Angle from the slack end, rad.
    pub theta: f64,
    /// Angle of the first bolt, rad.
    pub phase: f64,
}

/// Shares of a point's unit answers in its cosine and sine terms, for the two normal stresses and for the shear.
#[derive(Clone, Copy, Debug, Default)]
struct Shares {
    normal: [[f64; 2]; BELT],
    shear: [[f64; 2]; BELT],
}

/// Room for a chunk of points.
#[derive(Clone, Debug, Default)]
struct TurnRoom {
    terms: Terms,
    belt: ChunkStresses,
    held: ChunkStresses,
}

/// A load case on a section.
#[derive(Clone, Debug)]
pub struct Turn<'t> {
    view: View<'t>,
    case: Case,
    shares: Vec<Shares>,
    /// Waves at the angles of the first quarter, both ends included.
    quarter: Vec<Waves>,
}

impl<'t> Turn<'t> {
    /// A load case on a section that has been solved.
    pub fn new(view: View<'t>, case: Case) -> Self {
        let shares = (0..view.orders()).map(|order| {
            let (re, im) = belt_harmonic(case.growth, case.wrap, order);
            let (re, im) = (case.normal * re, case.normal * im);
            // The circumferential load answers a quarter wave later: X = A G (x1 + i x2).
            let cosine = [re, re * case.along, -im * case.around];
            let sine = [im, im * case.along, re * case.around];
            Shares {
                normal: std::array::from_fn(|load| [cosine[load], -sine[load]]),
                shear: std::array::from_fn(|load| [sine[load], cosine[load]]),
            }
        });
        let quarter = (0..=QUARTER).map(|step| Waves::new(2.0 * PI * step as f64 / ANGLES as f64, view.orders()));
        Self { shares: shares.collect(), quarter: quarter.collect(), view, case }
    }

    /// The section's answers.
    pub fn view(&self) -> View<'t> {
        self.view
    }

    /// The loads.
    pub fn case(&self) -> &Case {
        &self.case
    }

    /// Amplitudes of the belt's unit loads in a harmonic: a displacement is `Re(X exp(i k theta))` of its unit answers, around the
    /// axis `Im(X exp(i k theta))`.
    pub fn amplitudes(&self, order: usize) -> [Complex; BELT] {
        self.shares[order].shear.map(|[imaginary, real]| (real, imaginary))
    }

    /// Stresses of a chunk of points at all angles: from the belt, and from clamp and spin with the first bolt at the case's phase
    /// (at 0 if it is open).
    fn fill(&self, chunk: usize, room: &mut TurnRoom) {
        let places = chunk * CHUNK..(chunk + 1) * CHUNK;
        room.terms.iter_mut().for_each(Vec::clear);
        for (order, shares) in self.shares.iter().enumerate() {
            for (stress, terms) in room.terms.iter_mut().enumerate() {
                let shares = if stress == STRESSES - 1 { &shares.shear } else { &shares.normal };
                let mut term: Term = [Wide::ZERO; 2];
                for (load, share) in shares.iter().enumerate() {
                    let unit = &self.view.belt(order, load, stress)[places.clone()];
                    for lane in 0..CHUNK {
                        term[0][lane] += share[0] * unit[lane];
                        term[1][lane] += share[1] * unit[lane];
                    }
                }
                terms.push(term);
            }
        }
        synthesise(&room.terms, 1, &self.quarter, &mut room.belt);
        room.terms.iter_mut().for_each(Vec::clear);
        let phase = self.case.phase.unwrap_or(0.0);
        for clamp in 0..self.view.clamps() {
            let angle = phase * (clamp * self.view.bolts()) as f64;
            let (sine, cosine) = (self.case.pressure * libm::sin(angle), self.case.pressure * libm::cos(angle));
            for (stress, terms) in room.terms.iter_mut().enumerate() {
                let unit = &self.view.clamp(clamp, stress)[places.clone()];
                let share = if stress == STRESSES - 1 { [-sine, cosine] } else { [cosine, sine] };
                let mut term: Term = [Wide::ZERO; 2];
                for lane in 0..CHUNK {
                    term[0][lane] = share[0] * unit[lane];
                    term[1][lane] = share[1] * unit[lane];
                }
                if clamp == 0 {
                    let spin = &self.view.spin(stress)[places.clone()];
                    for lane in 0..CHUNK {
                        term[0][lane] += self.case.spin * spin[lane];
                    }
                }
                terms.push(term);
            }
        }
        synthesise(&room.terms, self.view.bolts(), &self.quarter, &mut room.held);
    }

    /// All results of a load case. `own` are surface points that the user asks for.
    pub fn summary(&self, fatigue: Option<Strength>, own: [Option<usize>; 2]) -> CaseSummary {
        let view = &self.view;
        let mut room = TurnRoom::default();
        let phases = self.phases();
        let mut largest = Peak::default();
        let mut tired: Vec<(f64, usize)> = Vec::new();
        for chunk in 0..view.padded() / CHUNK {
            let counted = &view.counted()[chunk * CHUNK..(chunk + 1) * CHUNK];
            if counted.iter().all(|it| *it == 0.0) {
                continue;
            }
            self.fill(chunk, &mut room);
            let limits = limits(&room.belt, &room.held);
            // The von Mises stress is a norm: that of belt and clamp together is no larger than the sum of both.
            let most = |lane: usize| limits.belt[lane] + limits.held[lane];
            if (0..CHUNK).any(|lane| counted[lane] != 0.0 && most(lane) >= largest.stress) {
                for &shift in &phases {
                    let (squares, angles) = largest_of(&room.belt, &room.held, shift, von_mises_squared);
                    for lane in (0..CHUNK).filter(|&lane| counted[lane] != 0.0) {
                        let stress = squares[lane].sqrt();
                        if stress > largest.stress {
                            largest = Peak { point: chunk * CHUNK + lane, stress, theta: angle(angles[lane]), phase: self.phase(shift) };
                        }
                    }
                }
            }
            if let Some(strength) = fatigue {
                let each = (0..CHUNK).filter(|&lane| counted[lane] != 0.0);
                tired.extend(each.map(|lane| (strength.used(limits.swing[lane], most(lane)), chunk * CHUNK + lane)));
            }
        }
        let largest = if largest.stress > 0.0 { self.refined(largest) } else { largest };
        let named = self.named(&phases, &mut room);
        let check_points =
            std::array::from_fn(|number| view.check_point(number).map(|point| Peak { point, ..self.refined(named.0[number]) }));
        CaseSummary {
            largest,
            check_points,
            own_points: own.map(|point| point.map(|point| self.peak(point, &phases, &mut room))),
            rim_displacement: named.1 / self.case.modulus,
            fatigue: fatigue.map(|strength| self.fatigue(strength, tired, &mut room)),
        }
    }

    /// Peaks of the check points at the angles that all points are evaluated at, and the largest displacement of the rim times the
    /// modulus.
    fn named(&self, phases: &[usize], room: &mut TurnRoom) -> ([Peak; CHECK_POINTS.len()], f64) {
        let first = self.view.padded();
        let mut peaks: [Peak; CHECK_POINTS.len()] = std::array::from_fn(|number| Peak { point: first + number, ..Peak::default() });
        let mut rim: f64 = 0.0;
        for chunk in 0..NAMED / CHUNK {
            self.fill(first / CHUNK + chunk, room);
            for &shift in phases {
                let (squares, angles) = largest_of(&room.belt, &room.held, shift, von_mises_squared);
                for lane in 0..CHUNK {
                    if let Some(peak) = peaks.get_mut(chunk * CHUNK + lane)
                        && squares[lane].sqrt() > peak.stress
                    {
                        *peak = Peak { stress: squares[lane].sqrt(), theta: angle(angles[lane]), phase: self.phase(shift), ..*peak };
                    }
                }
                if chunk == RIM / CHUNK {
                    let (squares, _) = largest_of(&room.belt, &room.held, shift, length_squared);
                    rim = rim.max(squares[RIM % CHUNK].sqrt());
                }
            }
        }
        (peaks, rim)
    }

    /// Shifts of the held field, in angles, that are tried: one if the phase is given, else all that differ.
    fn phases(&self) -> Vec<usize> {
        match self.case.phase {
            Some(_) => vec![0],
            None if ANGLES.is_multiple_of(self.view.bolts()) => (0..ANGLES / self.view.bolts()).collect(),
            None => (0..ANGLES).collect(),
        }
    }

    fn phase(&self, shift: usize) -> f64 {
        self.case.phase.unwrap_or_else(|| angle(shift))
    }

    /// Cosine and sine terms of one point's stresses, from the belt and, with the first bolt at `phase`, from what holds the pulley.
    fn terms_of(&self, point: usize, phase: f64) -> Vec<[[f64; 2]; STRESSES]> {
        let mut terms = vec![[[0.0; 2]; STRESSES]; self.shares.len()];
        for (order, (shares, term)) in self.shares.iter().zip(&mut terms).enumerate() {
            for (stress, term) in term.iter_mut().enumerate() {
                let shares = if stress == STRESSES - 1 { &shares.shear } else { &shares.normal };
                for (load, share) in shares.iter().enumerate() {
                    let unit = self.view.belt(order, load, stress)[point];
                    term[0] += share[0] * unit;
                    term[1] += share[1] * unit;
                }
            }
        }
        for clamp in 0..self.view.clamps() {
            let order = clamp * self.view.bolts();
            let (sine, cosine) = (libm::sin(phase * order as f64), libm::cos(phase * order as f64));
            for (stress, term) in terms[order].iter_mut().enumerate() {
                let unit = self.case.pressure * self.view.clamp(clamp, stress)[point];
                let share = if stress == STRESSES - 1 { [-sine, cosine] } else { [cosine, sine] };
                term[0] += share[0] * unit;
                term[1] += share[1] * unit;
            }
        }
        for (stress, term) in terms[0].iter_mut().enumerate() {
            term[0] += self.case.spin * self.view.spin(stress)[point];
        }
        terms
    }

    /// Von Mises stress of a point at every degree of the turn, both ends included, with the first bolt at `phase`, MPa.
    pub fn by_degree(&self, point: usize, phase: f64) -> Vec<f64> {
        let terms = self.terms_of(point, phase);
        (0..=360).map(|degree| at(&terms, PI * f64::from(degree) / 180.0)).collect()
    }

    /// Von Mises stress of a point at an angle, with the first bolt at `phase`, MPa.
    pub fn von_mises(&self, point: usize, theta: f64, phase: f64) -> f64 {
        at(&self.terms_of(point, phase), theta)
    }

    /// The largest stress of one point over the turn and the phases.
    fn peak(&self, point: usize, phases: &[usize], room: &mut TurnRoom) -> Peak {
        self.fill(point / CHUNK, room);
        let mut best = Peak { point, ..Peak::default() };
        for &shift in phases {
            let (squares, angles) = largest_of(&room.belt, &room.held, shift, von_mises_squared);
            let (stress, step) = (squares[point % CHUNK].sqrt(), angles[point % CHUNK]);
            if stress > best.stress {
                best = Peak { point, stress, theta: angle(step), phase: self.phase(shift) };
            }
        }
        self.refined(best)
    }

    /// A peak between the angles at which all points are evaluated: the vertex of a parabola, twice.
    fn refined(&self, peak: Peak) -> Peak {
        let terms = self.terms_of(peak.point, peak.phase);
        let mut best = Peak { stress: at(&terms, peak.theta), ..peak };
        for width in [angle(1), angle(1) / 16.0] {
            let [before, after] = [-width, width].map(|step| at(&terms, best.theta + step));
            let curvature = before + after - 2.0 * best.stress;
            if curvature < 0.0 {
                let theta = best.theta + (0.5 * width * (before - after) / curvature).clamp(-width, width);
                let stress = at(&terms, theta);
                if stress > best.stress {
                    best = Peak { stress, theta, ..best };
                }
            }
        }
        let turn = 2.0 * PI;
        Peak {
            theta: if best.theta < 0.0 {
                best.theta + turn
            } else if best.theta >= turn {
                best.theta - turn
            } else {
                best.theta
            },
            ..best
        }
    }
}

/// Von Mises stress at an angle of a point with these terms.
fn at(terms: &[[[f64; 2]; STRESSES]], theta: f64) -> f64 {
    let waves = Waves::new(theta, terms.len());
    let mut stress = [0.0; STRESSES];
    for (term, (cosine, sine)) in terms.iter().zip(&waves.0) {
        for (stress, term) in stress.iter_mut().zip(term) {
            *stress += term[0] * cosine + term[1] * sine;
        }
    }
    von_mises_squared(stress).sqrt()
}

/// An angle by its number, rad.
pub fn angle(step: usize) -> f64 {
    2.0 * PI * step as f64 / ANGLES as f64
}

/// Yield and fatigue strength, MPa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    /// Endurance limit: amplitude that is endured without limit at zero mean stress.
    pub endurance: f64,
    /// Tensile strength.
    pub tensile: f64,
}

impl Strength {
    /// Share of the strength that amplitude and mean use, after Goodman; a compressive mean neither helps nor harms.
    pub fn used(&self, amplitude: f64, mean: f64) -> f64 {
        amplitude / self.endurance + mean.max(0.0) / self.tensile
    }
}

/// The point that tires first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fatigue {
    /// Number of the point.
    pub point: usize,
    /// Largest von Mises stress of half the difference between two angles, MPa.
    pub amplitude: f64,
    /// Signed von Mises stress midway between them, MPa.
    pub mean: f64,
    /// Share of the strength used.
    pub used: f64,
}

/// The results of a load case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CaseSummary {
    /// The largest stress outside the excluded radius.
    pub largest: Peak,
    /// The check points in their order, where the section has them.
    pub check_points: [Option<Peak>; CHECK_POINTS.len()],
    /// The engineer's own points.
    pub own_points: [Option<Peak>; 2],
    /// Largest displacement of the rim, mm.
    pub rim_displacement: f64,
    /// The point that tires first, if asked for.
    pub fatigue: Option<Fatigue>,
}

impl Turn<'_> {
    /// The point that tires first. `tired` are points with no less than what they can use of their strength.
    fn fatigue(&self, strength: Strength, mut tired: Vec<(f64, usize)>, room: &mut TurnRoom) -> Fatigue {
        tired.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut worst = Fatigue::default();
        for (possible, point) in tired {
            if possible <= worst.used {
                break;
            }
            self.fill(point / CHUNK, room);
            let lane = point % CHUNK;
            let (amplitude, a, b) = widest(&room.belt, lane);
            // The point may stand anywhere between the bolts.
            let apart = ANGLES / if ANGLES.is_multiple_of(self.view.bolts()) { self.view.bolts() } else { 1 };
            let pressed = self.pressure_at(point, angle(a)) + self.pressure_at(point, angle(b));
            for held in &room.held[..apart] {
                let stress = [0, 1, 2].map(|it| 0.5 * (room.belt[a][it][lane] + room.belt[b][it][lane]) + held[it][lane]);
                // The kept stresses are less the normal stress, which counts in all three directions for the sign.
                let trace = stress[0] + stress[1] - 1.5 * pressed;
                let mean = von_mises_squared(stress).sqrt() * if trace < 0.0 { -1.0 } else { 1.0 };
                let used = strength.used(amplitude, mean);
                if used > worst.used {
                    worst = Fatigue { point, amplitude, mean, used };
                }
            }
        }
        worst
    }

    /// Pressure of the belt on a point at an angle, MPa.
    fn pressure_at(&self, point: usize, theta: f64) -> f64 {
        if theta > self.case.wrap { 0.0 } else { self.case.normal * self.view.pressed()[point] * libm::exp(self.case.growth * theta) }
    }
}

/// The two angles at which the stresses of one point differ most: half the von Mises stress of the difference, and their numbers.
fn widest(field: &ChunkStresses, lane: usize) -> (f64, usize, usize) {
    let history: [[f64; ANGLES]; STRESSES] = [0, 1, 2].map(|stress| std::array::from_fn(|step| field[step][stress][lane]));
    let (square, a, b) = farthest(&history);
    (0.5 * square.sqrt(), a, b)
}
