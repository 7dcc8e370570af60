//! A V-belt pulley: its loads, its stresses by finite elements, its safety.
//!
//! Source: K.-S. Lee et al., design and analysis system for V-belt pulleys. The belt's loads are those of
//! [`pulley_load`]; the section, the finite elements and the stresses over the turn are in
//! [`pulley`](crate::pulley). What depends on the section alone is prepared once and serves any number of loads.
//!
//! Goodman's `fatigue_safety` takes the belt's stresses over one turn as the history of each point, with the clamp and the spin as
//! constants; the source names fatigue as future work.

mod design;
mod fields;
mod notes;
mod profile;
mod table;
#[cfg(test)]
mod tests;

pub use profile::CHECK_POINT_STRESSES;
pub use table::model;

use super::formula::{Columns, Dependencies, Footprint, Kernel, Scratch, Sizes};
use super::pulley_load;
use crate::pulley::Design;
use crate::pulley::response::{self, CHECK_POINTS, LONGEST, View};
use crate::pulley::section::{self, Flaw, SectionKind};
use crate::pulley::turn::{Case, CaseSummary, Peak, Turn};
use crate::real::Real;
use crate::tape::{Known, List, Recording, Set, Trace};
use crate::units::{CUBIC_MILLIMETRE, MEGAPASCAL, MILLIMETRE};
use design::{Body, Loading};
use fields::{FINITE_ELEMENTS, Inputs, OUT, Result};

/// The finite elements of a pulley.
pub(super) struct Pulley;

/// What stands before the section's answers: which condition its flaw fails (0: none), the margin of it, whether the answers are
/// there, and the volume in mm^3.
const HEAD: usize = 4;

/// Conditions by number, after those of the belt.
const NO_SECTION: usize = pulley_load::CONDITIONS;
const BAND: usize = NO_SECTION + 1;
const SEAT: usize = NO_SECTION + 2;
const BOTH_SIDES: usize = NO_SECTION + 3;
const WITH_F: usize = NO_SECTION + 4;
const OWN: [usize; 2] = [NO_SECTION + 5, NO_SECTION + 6];
const LOADED: usize = NO_SECTION + 7;
const CONDITIONS: usize = NO_SECTION + 8;

/// The condition that a flaw fails.
fn condition_of(flaw: &Flaw) -> usize {
    match flaw {
        Flaw::Band { .. } => BAND,
        Flaw::BoltCircle { .. } | Flaw::HeadOverBore { .. } | Flaw::HeadInHole { .. } | Flaw::HeadsMeet { .. } | Flaw::Flat { .. } => SEAT,
        _ => NO_SECTION,
    }
}

/// The section's answers in what was prepared, if it is possible and was solved.
fn answers(prepared: &[f64]) -> Option<View<'_>> {
    (prepared[2] != 0.0).then(|| View::new(&prepared[HEAD..]))
}

/// First stage, for all that it is told: what its answers depend on is what a [`Body`] has.
fn solve(body: &Body<f64>, wanted: Set, prepared: &mut [f64]) {
    let (kind, dimensions, fineness) = (body.kind(), &body.dimensions, body.fineness());
    prepared[..HEAD].fill(0.0);
    // Loads and flaws need no elements; volume and mass need no solution.
    let refused = |flaw: Flaw, prepared: &mut [f64]| {
        prepared[0] = condition_of(&flaw) as f64;
        prepared[1] = flaw.margin();
    };
    if let Err(flaw) = section::checked_outline(kind, dimensions) {
        return refused(flaw, prepared);
    }
    if !wanted.meets(FINITE_ELEMENTS | Set::of(&[OUT.volume, OUT.mass])) {
        return;
    }
    match section::mesh(kind, dimensions, &fineness) {
        Err(flaw) => refused(flaw, prepared),
        Ok(mesh) if response::folds_over(&mesh) => refused(Flaw::Mesh { reason: "its elements fold over" }, prepared),
        Ok(mesh) => {
            prepared[3] = response::volume(&mesh);
            if wanted.meets(FINITE_ELEMENTS) {
                response::respond(&mesh, kind, dimensions, body.poisson, &fineness, &mut prepared[HEAD..]);
                prepared[2] = 1.0;
            }
        }
    }
}

/// Margins of all conditions; `flaw` is that of a condition that a flaw of the section fails.
fn margins<R: Real>(belt: [R; pulley_load::CONDITIONS], torque: R, inputs: &[R], flaw: impl Fn(usize) -> R) -> [R; CONDITIONS] {
    let [yes, no] = [1.0, -1.0].map(R::constant);
    let i = Inputs::read(inputs);
    let mut margins = [yes; CONDITIONS];
    margins[..belt.len()].copy_from_slice(&belt);
    for condition in [NO_SECTION, BAND, SEAT] {
        margins[condition] = flaw(condition);
    }
    // Types are numbered from 1: machined is 1, welded discs are 2.
    let from = |number: f64, then: R, otherwise: R| R::select(i.section - R::constant(number - 0.5), then, otherwise);
    margins[BOTH_SIDES] = from(2.0, yes, no);
    margins[WITH_F] = from(3.0, yes, from(2.0, no, yes));
    // The word that stands for no point is a number below zero.
    margins[OWN[0]] = R::select(i.point_1_r, yes, no);
    margins[OWN[1]] = R::select(i.point_2_r, yes, no);
    margins[LOADED] = torque;
    margins
}

impl Kernel for Pulley {
    fn sizes(&self) -> Sizes {
        let [inputs, outputs] = [Inputs::<usize>::NAMES, Result::<usize>::NAMES].map(<[_]>::len);
        Sizes { inputs, prepared: HEAD + LONGEST, outputs, conditions: CONDITIONS }
    }

    fn prepare(&self, inputs: &[f64], wanted: Set, prepared: &mut [f64]) {
        solve(&Body::new(inputs, design::kind(inputs)), wanted, prepared);
    }

    fn prepared_used(&self, prepared: &[f64]) -> usize {
        HEAD + answers(prepared).map_or(0, |view| view.length())
    }

    fn prepared_reads(&self, inputs: &[f64]) -> Set {
        read_by(design::kind(inputs))
    }

    fn footprint(&self, inputs: &[f64]) -> Footprint {
        let body = Body::new(inputs, design::kind(inputs));
        let Ok(mesh) = section::mesh(body.kind(), &body.dimensions, &body.fineness()) else { return Footprint::default() };
        let (table, scratch) = response::bytes(&mesh, &body.dimensions, &body.fineness());
        // The last section is kept beside the one that is asked for; the mesh and its loads take a twentieth of what the equations do.
        Footprint { prepared: 8 * HEAD as u64 + table, scratch: scratch + scratch / 20 + table }
    }

    fn conditions(&self, prepared: &[f64], inputs: &[f64], room: &mut [f64]) {
        let flaw = |condition| if prepared[0] as usize == condition { prepared[1] } else { 1.0 };
        let load = pulley_load::wrap_load(inputs);
        room.copy_from_slice(&margins(load.margins, load.torque, inputs, flaw));
    }

    fn finish(&self, prepared: &[f64], inputs: &[f64], wanted: Set, outputs: &mut [f64]) {
        self.finish_after(prepared, inputs, wanted, outputs, &mut None);
    }

    fn finish_columns(&self, prepared: &[f64], inputs: &[f64], columns: &Columns<'_>, _scratch: &mut Scratch, results: &mut [Vec<f64>]) {
        let mut inputs = inputs.to_vec();
        let mut found = [0.0; Result::<usize>::NAMES.len()];
        let mut last = None;
        let wanted = Set::of(columns.outputs);
        for design in 0..columns.count {
            for (input, column) in columns.varying {
                inputs[*input] = column[design];
            }
            if !wanted.is_empty() {
                self.finish_after(prepared, &inputs, wanted, &mut found, &mut last);
            }
            for (&output, result) in columns.outputs.iter().zip(&mut *results) {
                result[design] = found[output];
            }
            if !columns.conditions.is_empty() {
                let margins = self.margins(prepared, &inputs);
                for (&condition, result) in columns.conditions.iter().zip(&mut results[columns.outputs.len()..]) {
                    result[design] = margins[condition];
                }
            }
        }
    }

    fn dependencies(&self, inputs: &[Known]) -> Dependencies {
        let Sizes { outputs, conditions, .. } = self.sizes();
        let mut all = Dependencies { prepared: Set::EMPTY, outputs: vec![Set::EMPTY; outputs], conditions: vec![Set::EMPTY; conditions] };
        let section = if let Known::Fixed(section) = inputs[Inputs::NUMBER.section] { Some(section) } else { None };
        for kind in SectionKind::ALL.into_iter().filter(|kind| section.is_none_or(|section| design::kind_of(section) == *kind)) {
            let of_kind = dependencies_of(inputs, kind);
            all.prepared |= of_kind.prepared;
            all.outputs.iter_mut().zip(of_kind.outputs).for_each(|(set, of)| *set |= of);
            all.conditions.iter_mut().zip(of_kind.conditions).for_each(|(set, of)| *set |= of);
        }
        all
    }
}

/// What depends on what for a type of section: the very code of both stages, recorded with a number in place of what is solved.
fn dependencies_of(inputs: &[Known], kind: SectionKind) -> Dependencies {
    let (recording, nodes) = Recording::of(&[inputs, &[Known::ANY]].concat(), |named| {
        let (inputs, unknown) = (&named[..inputs.len()], named[inputs.len()]);
        let (body, loading) = (union(unknown, Body::new(inputs, kind).numbers()), Loading::new(inputs, kind));
        let mut outputs = [Trace::constant(0.0); Result::<usize>::NAMES.len()];
        pulley_load::finish_all(inputs, &mut outputs);
        let mut out = Result::read(&outputs);
        write_bolts(&mut out, &loading);
        write(&mut out, &Answered::depending(unknown, body, &loading), &loading);
        out.write(&mut outputs);
        let margins = margins(loading.margins, loading.torque, inputs, |_| body);
        [body].into_iter().chain(outputs).chain(margins).collect()
    });
    let list = List::cut(&recording, &nodes.into_iter().map(Some).collect::<Vec<_>>());
    // What is solved depends on nothing else.
    let sets = list.dependencies(|input| if usize::from(input) < inputs.len() { Set::one(input.into()) } else { Set::EMPTY });
    let mut of = list.results.iter().flatten().map(|&node| sets[node as usize]);
    let prepared = of.next().expect("there is a node for every result");
    let outputs = of.by_ref().take(Result::<usize>::NAMES.len()).collect();
    let mut all = Dependencies { prepared, outputs, conditions: of.collect() };
    // A section that cannot be leaves all but the outputs of belt and bolts empty.
    all.outputs[OUT.max_stress..OUT.seat_pressure].iter_mut().for_each(|set| *set |= prepared);
    all
}

/// Inputs that the first stage reads for a type of section.
fn read_by(kind: SectionKind) -> Set {
    dependencies_of(&vec![Known::ANY; Inputs::<usize>::NAMES.len()], kind).prepared
}

/// Something that depends on all of these and of which nothing else is known.
fn union(unknown: Trace, numbers: impl IntoIterator<Item = Trace>) -> Trace {
    numbers.into_iter().fold(unknown, |all, number| all + number)
}

impl Pulley {
    /// Second stage; `last` is the load case before and what came of it, which is used again if nothing of it has changed.
    fn finish_after(
        &self,
        prepared: &[f64],
        inputs: &[f64],
        wanted: Set,
        outputs: &mut [f64],
        last: &mut Option<(Case, Asked, CaseSummary)>,
    ) {
        // What this design does not have must not be left from the one before.
        outputs.fill(0.0);
        pulley_load::finish_all(inputs, outputs);
        let loading = Loading::new(inputs, design::kind(inputs));
        let mut out = Result::read(outputs);
        write_bolts(&mut out, &loading);
        out.write(outputs);
        let balanced = loading.margins[..pulley_load::SLIP].iter().all(|margin| *margin > 0.0);
        // What slips is solved as if it gripped: designs that differ in friction_limit only share their stresses.
        if !balanced || prepared[0] != 0.0 {
            return;
        }
        let mut answered = Answered { volume: prepared[3], ..Answered::default() };
        if wanted.meets(FINITE_ELEMENTS)
            && let Some(view) = answers(prepared)
        {
            let fatigue = wanted.meets(Set::of(&[OUT.fatigue_safety, OUT.fatigue_amplitude, OUT.fatigue_mean]));
            let asked = Asked {
                strength: fatigue.then_some(loading.strength()),
                own: loading.own_points().map(|point| point.map(|point| nearest(&view, point))),
            };
            // Stresses do not depend on the modulus, and displacements are divided by it afterwards.
            let case = loading.pressing.case(1.0);
            let summary = match last {
                Some((before, asked_before, summary)) if *before == case && *asked_before == asked => *summary,
                _ => Turn::new(view, case).summary(asked.strength, asked.own),
            };
            *last = Some((case, asked, summary));
            answered = Answered::new(prepared[3], &summary, &view);
        }
        write(&mut out, &answered, &loading);
        out.write(outputs);
    }
}

/// What is asked of a load case.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Asked {
    strength: Option<crate::pulley::turn::Strength>,
    own: [Option<usize>; 2],
}

/// The surface point nearest to a place (z, r), mm; the first of equals.
pub(crate) fn nearest(view: &View<'_>, (z, r): (f64, f64)) -> usize {
    let square = |point: usize| {
        let (dz, dr) = (view.z()[point] - z, view.r()[point] - r);
        dz * dz + dr * dr
    };
    (0..view.points()).min_by(|&a, &b| square(a).total_cmp(&square(b))).unwrap_or(0)
}

/// What the section has answered to a load case, in mm, MPa and rad.
#[derive(Clone, Copy, Debug, Default)]
struct Answered<R> {
    volume: R,
    stress: R,
    /// Where it is: r and z, and the angle.
    place: [R; 2],
    theta: R,
    check_points: [R; CHECK_POINTS.len()],
    own_points: [R; 2],
    /// Largest displacement of the rim times the elastic modulus.
    rim: R,
    /// Share of the strength that fatigue uses, its amplitude and mean; `None` if nobody asked.
    fatigue: Option<[R; 3]>,
}

impl Answered<f64> {
    fn new(volume: f64, summary: &CaseSummary, view: &View<'_>) -> Self {
        let peak = summary.largest;
        let stress = |point: Option<Peak>| point.map_or(0.0, |peak| peak.stress);
        Self {
            volume,
            stress: peak.stress,
            place: [view.r()[peak.point], view.z()[peak.point]],
            theta: peak.theta,
            check_points: summary.check_points.map(stress),
            own_points: summary.own_points.map(stress),
            rim: summary.rim_displacement,
            fatigue: summary.fatigue.map(|it| [it.used, it.amplitude, it.mean]),
        }
    }
}

impl Answered<Trace> {
    /// What answers depend on that come of a body and a load on it, whatever is computed of these.
    fn depending(unknown: Trace, body: Trace, loading: &Loading<Trace>) -> Self {
        let stress = union(unknown, loading.pressing.numbers().into_iter().chain([body]));
        Self {
            volume: body,
            stress,
            place: [stress; 2],
            theta: stress,
            check_points: [stress; CHECK_POINTS.len()],
            own_points: loading.own_points.map(|point| union(unknown, [stress, point[0], point[1]])),
            rim: stress,
            fatigue: Some([union(unknown, [stress, loading.strength[0], loading.strength[1]]); 3]),
        }
    }
}

/// What the bolts bear and hold, whatever section they are on.
fn write_bolts<R: Real>(out: &mut Result<R>, loading: &Loading<R>) {
    out.seat_pressure = design::to_si(MEGAPASCAL, loading.pressing.pressure);
    out.bolt_utilisation = loading.bolt_utilisation;
    out.joint_slip_safety = loading.held_torque / loading.torque;
}

/// What section and belt load give together.
fn write<R: Real>(out: &mut Result<R>, answered: &Answered<R>, loading: &Loading<R>) {
    let (stress, length) = (|value| design::to_si(MEGAPASCAL, value), |value| design::to_si(MILLIMETRE, value));
    out.volume = design::to_si(CUBIC_MILLIMETRE, answered.volume);
    out.mass = out.volume * loading.density;
    out.excluded_radius = length(loading.excluded_radius);
    out.max_stress = stress(answered.stress);
    [out.max_stress_r, out.max_stress_z] = answered.place.map(length);
    out.max_stress_theta = answered.theta;
    [out.bl, out.br, out.cl, out.cr, out.dl, out.dr, out.el, out.er, out.fl, out.fr] = answered.check_points.map(stress);
    [out.own_1, out.own_2] = answered.own_points.map(stress);
    out.rim_displacement = length(answered.rim / loading.modulus);
    out.yield_safety = loading.yield_strength / answered.stress;
    if let Some([used, amplitude, mean]) = answered.fatigue {
        out.fatigue_safety = R::constant(1.0) / used;
        out.fatigue_amplitude = stress(amplitude);
        out.fatigue_mean = stress(mean);
    }
}
