//! A load case over one turn: stresses of every surface point at every angle, the largest of them, and the fatigue of what turns
//! through them.
//!
//! The belt stands still and the pulley turns: what a point of the surface sees over one turn is what stands around the
//! circumference. Stresses are sums of harmonics; at 96 angles they are added up with the symmetries of cosine and sine (a quarter
//! turn gives the other three), and near the largest value anew at finer angles.

use super::loads::{Complex, belt_harmonic};
use super::response::{BELT, CHECK_POINTS, CHUNK, STRESSES, View};
use std::f64::consts::PI;

/// Angles at which all points are evaluated, 3.75 degrees apart.
pub const ANGLES: usize = 96;
const QUARTER: usize = ANGLES / 4;

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

/// Stresses of one point at one angle: along and around, less the normal stress, and shear.
pub type Stress = [f64; STRESSES];

/// Square of the von Mises stress.
#[inline(always)]
pub fn von_mises_squared([along, around, shear]: Stress) -> f64 {
    along * along - along * around + around * around + 3.0 * (shear * shear)
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

/// Cosines and sines of k times an angle, for all harmonics.
#[derive(Clone, Debug)]
struct Waves(Vec<Complex>);

impl Waves {
    fn new(theta: f64, orders: usize) -> Self {
        let (sine, cosine) = (libm::sin(theta), libm::cos(theta));
        let mut waves = Vec::with_capacity(orders);
        let mut now = (1.0, 0.0);
        for _ in 0..orders {
            waves.push(now);
            now = (now.0 * cosine - now.1 * sine, now.1 * cosine + now.0 * sine);
        }
        Self(waves)
    }
}

/// Stresses of eight points at all angles.
type Field = Vec<[[f64; CHUNK]; STRESSES]>;

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

    /// Terms of the belt's stress on a chunk of points: per harmonic the cosine and the sine term of each stress.
    fn belt_terms(&self, chunk: usize, terms: &mut Vec<[[[f64; CHUNK]; 2]; STRESSES]>) {
        terms.clear();
        let places = chunk * CHUNK..(chunk + 1) * CHUNK;
        for (order, shares) in self.shares.iter().enumerate() {
            let mut term = [[[0.0; CHUNK]; 2]; STRESSES];
            for (stress, term) in term.iter_mut().enumerate() {
                let shares = if stress == STRESSES - 1 { &shares.shear } else { &shares.normal };
                for (load, share) in shares.iter().enumerate() {
                    let unit = &self.view.belt(order, load, stress)[places.clone()];
                    for lane in 0..CHUNK {
                        term[0][lane] += share[0] * unit[lane];
                        term[1][lane] += share[1] * unit[lane];
                    }
                }
            }
            terms.push(term);
        }
    }

    /// Terms of the clamp's and the spin's stress with the first bolt at an angle; harmonics are multiples of the number of bolts.
    fn held_terms(&self, chunk: usize, phase: f64, terms: &mut Vec<[[[f64; CHUNK]; 2]; STRESSES]>) {
        terms.clear();
        let places = chunk * CHUNK..(chunk + 1) * CHUNK;
        for clamp in 0..self.view.clamps() {
            let angle = phase * (clamp * self.view.bolts()) as f64;
            let (sine, cosine) = (self.case.pressure * libm::sin(angle), self.case.pressure * libm::cos(angle));
            let mut term = [[[0.0; CHUNK]; 2]; STRESSES];
            for (stress, term) in term.iter_mut().enumerate() {
                let unit = &self.view.clamp(clamp, stress)[places.clone()];
                let share = if stress == STRESSES - 1 { [-sine, cosine] } else { [cosine, sine] };
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
            }
            terms.push(term);
        }
    }

    fn fields(&self, terms: &[[[[f64; CHUNK]; 2]; STRESSES]], step: usize, field: &mut Field) {
        field.resize(ANGLES, [[0.0; CHUNK]; STRESSES]);
        synthesise(terms, step, &self.quarter, field);
    }

    /// Everything that a load case tells of the section.
    pub fn summary(&self, fatigue: Option<Strength>, own: [Option<usize>; 2]) -> Summary {
        let view = &self.view;
        let chunks = view.padded() / CHUNK;
        let (mut terms, mut belt, mut held) = (Vec::new(), Field::new(), Field::new());
        let mut largest = Peak::default();
        let mut tired: Vec<(f64, usize)> = Vec::new();
        let phases = self.phases();
        let mut known = 0.0;
        for chunk in 0..chunks {
            let counted = &view.counted()[chunk * CHUNK..(chunk + 1) * CHUNK];
            if counted.iter().all(|it| *it == 0.0) {
                continue;
            }
            self.belt_terms(chunk, &mut terms);
            self.fields(&terms, 1, &mut belt);
            self.held_terms(chunk, self.case.phase.unwrap_or(0.0), &mut terms);
            self.fields(&terms, view.bolts(), &mut held);
            let limits = limits(&belt, &held);
            let worth = |lane: usize| counted[lane] != 0.0 && chunk * CHUNK + lane < view.points();
            // Von Mises stress is a norm: belt and hold together are no larger than their sum.
            let possible = (0..CHUNK).filter(|&lane| worth(lane)).any(|lane| limits.belt[lane] + limits.held[lane] >= known);
            if possible {
                for &shift in &phases {
                    let (squares, angles) = largest_of(&belt, &held, shift);
                    for lane in (0..CHUNK).filter(|&lane| worth(lane)) {
                        let stress = squares[lane].sqrt();
                        if stress > largest.stress {
                            let phase = self.phase(shift);
                            largest = Peak { point: chunk * CHUNK + lane, stress, theta: angle(angles[lane]), phase };
                            known = stress;
                        }
                    }
                }
            }
            if let Some(strength) = fatigue {
                for lane in (0..CHUNK).filter(|&lane| worth(lane)) {
                    tired.push((strength.used(limits.swing[lane], limits.belt[lane] + limits.held[lane]), chunk * CHUNK + lane));
                }
            }
        }
        let fatigue = fatigue.map(|strength| self.fatigue(strength, tired));
        let refined = |point: usize| self.peak(point, &phases);
        Summary {
            largest: if largest.stress > 0.0 { self.refined(largest) } else { largest },
            check_points: std::array::from_fn(|number| view.check_point(number).map(refined)),
            own_points: own.map(|point| point.map(refined)),
            rim_displacement: self.rim_displacement(&phases),
            fatigue,
        }
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

    /// Stress of a point at any angle, from the belt alone or with what holds the pulley and its spin.
    fn stress_at(&self, point: usize, waves: &Waves, held: Option<&Waves>) -> Stress {
        let mut stress = [0.0; STRESSES];
        for (order, (shares, &(cosine, sine))) in self.shares.iter().zip(&waves.0).enumerate() {
            for (number, stress) in stress.iter_mut().enumerate() {
                let shares = if number == STRESSES - 1 { &shares.shear } else { &shares.normal };
                for (load, share) in shares.iter().enumerate() {
                    *stress += (share[0] * cosine + share[1] * sine) * self.view.belt(order, load, number)[point];
                }
            }
        }
        if let Some(waves) = held {
            self.add_held(point, waves, &mut stress);
        }
        stress
    }

    /// Adds the clamp, seen at an angle from the first bolt, and the spin.
    fn add_held(&self, point: usize, waves: &Waves, stress: &mut Stress) {
        for clamp in 0..self.view.clamps() {
            let (cosine, sine) = waves.0[clamp * self.view.bolts()];
            for (number, stress) in stress.iter_mut().enumerate() {
                let wave = if number == STRESSES - 1 { sine } else { cosine };
                *stress += self.case.pressure * wave * self.view.clamp(clamp, number)[point];
            }
        }
        for (number, stress) in stress.iter_mut().enumerate() {
            *stress += self.case.spin * self.view.spin(number)[point];
        }
    }

    /// Von Mises stress of a point at an angle, with the first bolt at `phase`, MPa.
    pub fn von_mises(&self, point: usize, theta: f64, phase: f64) -> f64 {
        let orders = self.view.orders();
        let stress = self.stress_at(point, &Waves::new(theta, orders), Some(&Waves::new(theta - phase, orders)));
        von_mises_squared(stress).sqrt()
    }

    /// Von Mises stress of a point over the turn at all angles, with the first bolt at `phase`, MPa.
    pub fn around(&self, point: usize, phase: f64) -> Vec<f64> {
        (0..ANGLES).map(|step| self.von_mises(point, angle(step), phase)).collect()
    }

    /// The largest stress of one point over the turn and the phases.
    fn peak(&self, point: usize, phases: &[usize]) -> Peak {
        let belt: Vec<Stress> = self.history(point);
        let held: Vec<Stress> = self.held_history(point);
        let mut best = Peak { point, ..Peak::default() };
        for &shift in phases {
            for (step, belt) in belt.iter().enumerate() {
                let held = &held[(step + ANGLES - shift) % ANGLES];
                let stress = von_mises_squared(std::array::from_fn(|it| belt[it] + held[it])).sqrt();
                if stress > best.stress {
                    best = Peak { point, stress, theta: angle(step), phase: self.phase(shift) };
                }
            }
        }
        self.refined(best)
    }

    /// A peak between the angles: twice a row of finer ones around the best.
    fn refined(&self, peak: Peak) -> Peak {
        const STEPS: i32 = 8;
        let mut best = peak;
        let mut width = angle(1);
        for _ in 0..2 {
            let centre = best.theta;
            for step in -STEPS..=STEPS {
                let theta = centre + width * f64::from(step) / f64::from(STEPS);
                let stress = self.von_mises(peak.point, theta, peak.phase);
                if stress > best.stress {
                    best = Peak { stress, theta, ..best };
                }
            }
            width /= f64::from(STEPS);
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

    /// One point's stresses from the belt alone at all angles.
    fn history(&self, point: usize) -> Vec<Stress> {
        let (chunk, lane) = (point / CHUNK, point % CHUNK);
        let (mut terms, mut field) = (Vec::new(), Field::new());
        self.belt_terms(chunk, &mut terms);
        self.fields(&terms, 1, &mut field);
        field.iter().map(|stress| stress.map(|lanes| lanes[lane])).collect()
    }

    /// One point's stresses from clamp and spin at all angles, with the first bolt at the case's phase (at 0 if it is open).
    fn held_history(&self, point: usize) -> Vec<Stress> {
        let (chunk, lane) = (point / CHUNK, point % CHUNK);
        let (mut terms, mut field) = (Vec::new(), Field::new());
        self.held_terms(chunk, self.case.phase.unwrap_or(0.0), &mut terms);
        self.fields(&terms, self.view.bolts(), &mut field);
        field.iter().map(|stress| stress.map(|lanes| lanes[lane])).collect()
    }

    /// Largest displacement of the rim over the turn, mm.
    fn rim_displacement(&self, phases: &[usize]) -> f64 {
        let view = &self.view;
        // Per harmonic and axis: cosine and sine term. u_theta is a sine where the others are cosines.
        let terms: Vec<[[f64; 2]; 3]> = self
            .shares
            .iter()
            .enumerate()
            .map(|(order, shares)| {
                let mut terms = [[0.0; 2]; 3];
                for load in 0..BELT {
                    let unit = view.rim_belt(order, load);
                    for axis in 0..3 {
                        let share = if axis == 2 { shares.shear[load] } else { shares.normal[load] };
                        terms[axis][0] += share[0] * unit[axis];
                        terms[axis][1] += share[1] * unit[axis];
                    }
                }
                terms
            })
            .collect();
        let belt = |waves: &Waves| -> [f64; 3] {
            std::array::from_fn(|axis| {
                terms.iter().zip(&waves.0).map(|(terms, (cosine, sine))| terms[axis][0] * cosine + terms[axis][1] * sine).sum()
            })
        };
        let held = |waves: &Waves| -> [f64; 3] {
            std::array::from_fn(|axis| {
                let clamp = |clamp: usize| {
                    let (cosine, sine) = waves.0[clamp * view.bolts()];
                    self.case.pressure * view.rim_clamp(clamp)[axis] * if axis == 2 { sine } else { cosine }
                };
                (0..view.clamps()).map(clamp).sum::<f64>() + self.case.spin * view.rim_spin()[axis]
            })
        };
        let wave = |theta: f64| Waves::new(theta, view.orders());
        let steps: Vec<Waves> = (0..ANGLES).map(|step| wave(angle(step))).collect();
        let pulled: Vec<[f64; 3]> = steps.iter().map(belt).collect();
        let offset = self.case.phase.unwrap_or(0.0);
        let pushed: Vec<[f64; 3]> = (0..ANGLES).map(|step| held(&wave(angle(step) - offset))).collect();
        let length = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|axis| (a[axis] + b[axis]) * (a[axis] + b[axis])).sum::<f64>();
        let mut best = (0.0, 0, 0);
        for &shift in phases {
            for (step, belt) in pulled.iter().enumerate() {
                let square = length(belt, &pushed[(step + ANGLES - shift) % ANGLES]);
                if square > best.0 {
                    best = (square, step, shift);
                }
            }
        }
        let phase = self.phase(best.2);
        let finer = (-8..=8).map(|part| {
            let theta = angle(best.1) + angle(1) * f64::from(part) / 8.0;
            length(&belt(&wave(theta)), &held(&wave(theta - phase)))
        });
        finer.fold(best.0, f64::max).sqrt() / self.case.modulus
    }
}

/// An angle by its number, rad.
pub fn angle(step: usize) -> f64 {
    2.0 * PI * step as f64 / ANGLES as f64
}

/// Yield and fatigue strength, MPa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    /// Amplitude that is endured for ever without mean stress.
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

/// What a load case tells of a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
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
    fn fatigue(&self, strength: Strength, mut tired: Vec<(f64, usize)>) -> Fatigue {
        tired.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut worst = Fatigue::default();
        for (possible, point) in tired {
            if possible <= worst.used {
                break;
            }
            let history = self.history(point);
            let held = self.held_history(point);
            let (amplitude, a, b) = widest(&history);
            let middle: Stress = std::array::from_fn(|it| 0.5 * (history[a][it] + history[b][it]));
            // The point may stand anywhere between the bolts.
            let apart = ANGLES / if ANGLES.is_multiple_of(self.view.bolts()) { self.view.bolts() } else { 1 };
            let (from_a, from_b) = (self.pressure_at(point, angle(a)), self.pressure_at(point, angle(b)));
            for held in &held[..apart] {
                let stress: Stress = std::array::from_fn(|it| middle[it] + held[it]);
                // The kept stresses are less the normal stress, which counts in all three directions for the sign.
                let trace = stress[0] + stress[1] - 1.5 * (from_a + from_b);
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

/// The two angles whose stresses differ most: half the von Mises stress of the difference, and their numbers.
fn widest(history: &[Stress]) -> (f64, usize, usize) {
    let mut best = (0.0, 0, 0);
    for (a, first) in history.iter().enumerate() {
        for (b, second) in history.iter().enumerate().skip(a + 1) {
            let square = von_mises_squared(std::array::from_fn(|it| first[it] - second[it]));
            if square > best.0 {
                best = (square, a, b);
            }
        }
    }
    (0.5 * best.0.sqrt(), best.1, best.2)
}

/// Bounds on the stresses of eight points over the turn, MPa.
struct Limits {
    /// Largest von Mises stress from the belt.
    belt: [f64; CHUNK],
    /// Largest from clamp and spin.
    held: [f64; CHUNK],
    /// No less than the amplitude: largest distance from the middle of the belt's stresses.
    swing: [f64; CHUNK],
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn synthesise(terms: &[[[[f64; CHUNK]; 2]; STRESSES]], step: usize, quarter: &[Waves], field: &mut Field) {
    for (place, waves) in quarter.iter().enumerate() {
        for stress in 0..STRESSES {
            // Cosine and sine terms, of even and of odd harmonics.
            let mut sums = [[0.0; CHUNK]; 4];
            for (number, term) in terms.iter().enumerate() {
                let order = number * step;
                let (cosine, sine) = waves.0[order];
                let odd = order % 2;
                let [cosines, sines] = &term[stress];
                for lane in 0..CHUNK {
                    sums[odd][lane] += cosine * cosines[lane];
                    sums[2 + odd][lane] += sine * sines[lane];
                }
            }
            let [ce, co, se, so] = sums;
            for lane in 0..CHUNK {
                let (even, odd) = (ce[lane] + so[lane], co[lane] + se[lane]);
                let (even_back, odd_back) = (ce[lane] - so[lane], co[lane] - se[lane]);
                field[place][stress][lane] = even + odd;
                field[(ANGLES - place) % ANGLES][stress][lane] = even_back + odd_back;
                field[ANGLES / 2 - place][stress][lane] = even - odd;
                field[ANGLES / 2 + place][stress][lane] = even_back - odd_back;
            }
        }
    }
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn limits(belt: &Field, held: &Field) -> Limits {
    let square = |stress: &[[f64; CHUNK]; STRESSES], lane: usize| von_mises_squared([stress[0][lane], stress[1][lane], stress[2][lane]]);
    let mut limits = Limits { belt: [0.0; CHUNK], held: [0.0; CHUNK], swing: [0.0; CHUNK] };
    let mut low = belt[0];
    let mut high = belt[0];
    for (belt, held) in belt.iter().zip(held) {
        for lane in 0..CHUNK {
            limits.belt[lane] = if square(belt, lane) > limits.belt[lane] { square(belt, lane) } else { limits.belt[lane] };
            limits.held[lane] = if square(held, lane) > limits.held[lane] { square(held, lane) } else { limits.held[lane] };
        }
        for stress in 0..STRESSES {
            for lane in 0..CHUNK {
                let value = belt[stress][lane];
                low[stress][lane] = if value < low[stress][lane] { value } else { low[stress][lane] };
                high[stress][lane] = if value > high[stress][lane] { value } else { high[stress][lane] };
            }
        }
    }
    for belt in belt {
        for lane in 0..CHUNK {
            let distance = von_mises_squared(std::array::from_fn(|it| belt[it][lane] - 0.5 * (low[it][lane] + high[it][lane])));
            limits.swing[lane] = if distance > limits.swing[lane] { distance } else { limits.swing[lane] };
        }
    }
    for lane in 0..CHUNK {
        limits.belt[lane] = limits.belt[lane].sqrt();
        limits.held[lane] = limits.held[lane].sqrt();
        limits.swing[lane] = limits.swing[lane].sqrt();
    }
    limits
}

/// Largest squares of von Mises stress over the turn, and where, with the held field shifted by some angles.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn largest_of(belt: &Field, held: &Field, shift: usize) -> ([f64; CHUNK], [usize; CHUNK]) {
    let mut squares = [0.0; CHUNK];
    let mut angles = [0.0; CHUNK];
    for (step, belt) in belt.iter().enumerate() {
        let held = &held[(step + ANGLES - shift) % ANGLES];
        for lane in 0..CHUNK {
            let square = von_mises_squared(std::array::from_fn(|it| belt[it][lane] + held[it][lane]));
            let larger = square > squares[lane];
            squares[lane] = if larger { square } else { squares[lane] };
            angles[lane] = if larger { step as f64 } else { angles[lane] };
        }
    }
    (squares, angles.map(|step| step as usize))
}
