//! A V-belt pulley: its loads, its stresses by finite elements, its safety.
//!
//! Source: K.-S. Lee et al., design and analysis system for V-belt pulleys. The belt's loads are those of
//! [`pulley_load`]; the section, the finite elements and the stresses over the turn are in
//! [`pulley`](crate::pulley). What depends on the section alone is prepared once and serves any number of loads.
//!
//! Goodman's `fatigue_safety` takes the belt's stresses over one turn as the history of each point, with the clamp and the spin as
//! constants; the source names fatigue as future work.

mod design;
mod notes;
mod profile;
mod table;
#[cfg(test)]
mod tests;

pub use design::Design;
pub use profile::CHECK_POINT_STRESSES;
pub use table::MODEL;

use super::description::Model;
use super::formula::{CONDITIONS, Columns, INPUTS, Kernel, OUTPUTS, Reach, Scratch, run};
use super::pulley_load::{self, PulleyLoad};
use crate::pulley::response::{self, LONGEST, View};
use crate::pulley::section::{self, Dimensions, Fineness, Flaw, Kind};
use crate::pulley::turn::{Case, Summary, Turn};
use crate::real::Dependence;
use crate::units::{CUBIC_MILLIMETRE, MEGAPASCAL, MILLIMETRE};
use std::cell::RefCell;
use table::{FINITE_ELEMENTS, Inputs, LOAD_OUTPUTS, OUT, Result, SECTION};

pub(super) struct Pulley;

/// What stands before the section's answers: which condition its flaw fails (0: none), the margin of it, whether the answers are
/// there, and the volume in mm^3.
const HEAD: usize = 4;

/// Conditions by number.
const NO_SECTION: usize = 2;
const BAND: usize = 3;
const SEAT: usize = 4;
const BOTH_SIDES: usize = 5;
const WITH_F: usize = 6;
const OWN: [usize; 2] = [7, 8];

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

/// What decides a section's answers.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Key {
    kind: Kind,
    dimensions: Dimensions,
    poisson: f64,
    fineness: Fineness,
    wanted: u64,
}

/// The last section that a thread has solved: axes that its type does not read leave it the same.
#[derive(Default)]
struct Last {
    key: Option<Key>,
    answers: Vec<f64>,
}

impl Last {
    fn recall(&self, key: &Key, prepared: &mut [f64]) -> bool {
        let known = self.key.as_ref() == Some(key);
        if known {
            prepared[..self.answers.len()].copy_from_slice(&self.answers);
        }
        known
    }

    fn keep(&mut self, key: Key, prepared: &[f64]) {
        self.key = Some(key);
        self.answers.clear();
        self.answers.extend(&prepared[..HEAD + View::new(&prepared[HEAD..]).length()]);
    }
}

thread_local! {
    static LAST: RefCell<Last> = RefCell::default();
}

/// The dimensions that a type reads; the others are zero.
fn of_kind(kind: Kind, dimensions: &Dimensions) -> Dimensions {
    let d = *dimensions;
    let sheet = Dimensions { wall_thickness: 0.0, rim_thickness: 0.0, lip_thickness: 0.0, fillet_radius: 0.0, groove_offset: 0.0, ..d };
    match kind {
        Kind::Machined => Dimensions {
            hub_bend_radius: 0.0,
            web_bend_radius: 0.0,
            fold_radius: 0.0,
            wall_radius: 0.0,
            wall_offset: 0.0,
            ridge_width: 0.0,
            weld_radius: 0.0,
            ..d
        },
        Kind::WeldedDiscs => Dimensions {
            cup_radius: 0.0,
            wall_radius: 0.0,
            wall_offset: 0.0,
            web_bend_radius: 0.0,
            fold_radius: 0.0,
            ridge_width: 0.0,
            floor_bend_radius: 0.0,
            floor_depth: 0.0,
            ..sheet
        },
        Kind::DoubleGroove => Dimensions { weld_radius: 0.0, ..sheet },
        Kind::PressedCup => Dimensions { ridge_width: 0.0, weld_radius: 0.0, ..sheet },
    }
}

impl Kernel for Pulley {
    fn prepared_len(&self) -> usize {
        HEAD + LONGEST
    }

    fn prepare(&self, inputs: &[f64; INPUTS], wanted: u64, prepared: &mut [f64]) {
        let (kind, dimensions) = (design::kind(inputs), design::dimensions(inputs));
        let design = Design::new(inputs);
        prepared[..HEAD].fill(0.0);
        // Loads and flaws need no elements; volume and mass need no solution.
        let refused = |flaw: Flaw, prepared: &mut [f64]| {
            prepared[0] = condition_of(&flaw) as f64;
            prepared[1] = flaw.margin();
        };
        if let Err(flaw) = section::checked_outline(kind, &dimensions) {
            return refused(flaw, prepared);
        }
        if wanted & (FINITE_ELEMENTS | 1 << OUT.volume | 1 << OUT.mass) == 0 {
            return;
        }
        let key = Key { kind, dimensions: of_kind(kind, &dimensions), poisson: design.poisson, fineness: design.fineness, wanted };
        if LAST.with_borrow(|last| last.recall(&key, prepared)) {
            return;
        }
        match section::mesh(kind, &dimensions, &design.fineness) {
            Err(flaw) => refused(flaw, prepared),
            Ok(mesh) if response::folds_over(&mesh) => refused(Flaw::Mesh { reason: "its elements fold over" }, prepared),
            Ok(mesh) => {
                prepared[3] = response::volume(&mesh);
                if wanted & FINITE_ELEMENTS != 0 {
                    response::respond(&mesh, kind, &dimensions, design.poisson, &design.fineness, &mut prepared[HEAD..]);
                    prepared[2] = 1.0;
                    LAST.with_borrow_mut(|last| last.keep(key, prepared));
                }
            }
        }
    }

    fn conditions(&self, prepared: &[f64], inputs: &[f64; INPUTS]) -> [f64; CONDITIONS] {
        let mut margins = [1.0; CONDITIONS];
        let load = pulley_load::wrap_load(inputs);
        margins[..2].copy_from_slice(&load.margins);
        let flaw = prepared[0] as usize;
        if flaw != 0 {
            margins[flaw] = prepared[1];
        }
        let sure = |is: bool| if is { 1.0 } else { -1.0 };
        let kind = design::kind(inputs);
        let i = Inputs::read(inputs);
        margins[BOTH_SIDES] = sure(kind != Kind::Machined);
        margins[WITH_F] = sure(kind != Kind::WeldedDiscs);
        margins[OWN[0]] = sure(i.point_1_r != table::POINT_NONE);
        margins[OWN[1]] = sure(i.point_2_r != table::POINT_NONE);
        margins
    }

    fn finish(&self, prepared: &[f64], inputs: &[f64; INPUTS], wanted: u64, outputs: &mut [f64; OUTPUTS]) {
        self.finish_after(prepared, inputs, wanted, outputs, &mut None);
    }

    fn finish_columns(
        &self,
        model: &Model,
        prepared: &[f64],
        inputs: &[f64; INPUTS],
        columns: &Columns<'_>,
        _scratch: &mut Scratch,
        results: &mut [Vec<f64>],
    ) {
        let mut inputs = *inputs;
        let mut outputs = [0.0; OUTPUTS];
        let mut last = None;
        let wanted = columns.outputs.iter().fold(0, |set, output| set | 1 << output);
        for design in 0..columns.count {
            for (input, column) in columns.varying {
                inputs[*input] = column[design];
            }
            if wanted != 0 {
                self.finish_after(prepared, &inputs, wanted, &mut outputs, &mut last);
            }
            for (&output, result) in columns.outputs.iter().zip(&mut *results) {
                result[design] = model.outputs[output].unit.from_si(outputs[output]);
            }
            if !columns.conditions.is_empty() {
                let margins = self.conditions(prepared, &inputs);
                for (&condition, result) in columns.conditions.iter().zip(&mut results[columns.outputs.len()..]) {
                    result[design] = margins[condition];
                }
            }
        }
    }

    fn reach(&self, inputs: &[Dependence; INPUTS]) -> Reach {
        let of = |set: &[usize]| set.iter().fold(0, |bits, &input| bits | inputs[input].inputs);
        let number = Inputs::NUMBER;
        let kinds = |name: &str| match inputs[number.section].known() {
            Some(kind) => Kind::ALL.get(kind as usize - 1).is_some_and(|kind| kind.name() == name),
            None => true,
        };
        let read = |input: &&usize| {
            let only = MODEL.inputs[**input].only_for;
            only.is_empty() || only.iter().any(|name| kinds(name))
        };
        let geometry: u64 = SECTION.iter().filter(read).fold(0, |bits, &input| bits | inputs[input].inputs);
        let (load, margins) = run::<PulleyLoad, Dependence>(inputs);
        let belt = (0..LOAD_OUTPUTS).filter(|&it| it != OUT.friction_margin).fold(0, |bits, output| bits | load[output].inputs);
        // A force that is given does not ask for the torque.
        let by_torque = inputs[number.clamp_force].known().is_none_or(|force| force == table::TORQUE);
        let torque = [number.tightening_torque, number.bolt_friction, number.bolt_pitch, number.bolt_pitch_diameter];
        let clamp = of(&[number.clamp_force]) | if by_torque { of(&torque) } else { 0 };
        let stress = geometry | belt | clamp | of(&[number.friction_direction, number.density, number.bolt_angle]);
        let own = [of(&[number.point_1_r, number.point_1_z]), of(&[number.point_2_r, number.point_2_z])];
        let fatigue = stress | of(&[number.tensile_strength, number.endurance_limit]);
        let mut outputs = [stress; OUTPUTS];
        for (output, load) in load.iter().enumerate().take(LOAD_OUTPUTS) {
            outputs[output] = load.inputs;
        }
        outputs[OUT.own_1] |= own[0];
        outputs[OUT.own_2] |= own[1];
        outputs[OUT.rim_displacement] |= of(&[number.elastic_modulus]);
        outputs[OUT.volume] = geometry;
        outputs[OUT.mass] = geometry | of(&[number.density]);
        outputs[OUT.excluded_radius] = geometry;
        outputs[OUT.clamp_pressure] = geometry | clamp;
        outputs[OUT.yield_safety] |= of(&[number.yield_strength]);
        for output in [OUT.fatigue_safety, OUT.fatigue_amplitude, OUT.fatigue_mean] {
            outputs[output] = fatigue;
        }
        let mut conditions = [0; CONDITIONS];
        conditions[0] = margins[0].inputs;
        conditions[1] = margins[1].inputs;
        conditions[NO_SECTION..=SEAT].fill(geometry);
        conditions[BOTH_SIDES..=WITH_F].fill(of(&[number.section]));
        conditions[OWN[0]] = of(&[number.point_1_r]);
        conditions[OWN[1]] = of(&[number.point_2_r]);
        Reach { prepared: geometry, outputs, conditions }
    }
}

impl Pulley {
    /// Second stage; `last` is the load case before and what came of it, which is used again if nothing of it has changed.
    fn finish_after(
        &self,
        prepared: &[f64],
        inputs: &[f64; INPUTS],
        wanted: u64,
        outputs: &mut [f64; OUTPUTS],
        last: &mut Option<(Case, Asked, Summary)>,
    ) {
        // What this design does not have must not be left from the one before.
        outputs.fill(0.0);
        pulley_load::finish_all(inputs, outputs);
        let load = pulley_load::wrap_load(inputs);
        if load.margins.iter().any(|margin| *margin <= 0.0) || prepared[0] != 0.0 {
            return;
        }
        let design = Design::new(inputs);
        let mut out = Result::read(outputs);
        out.volume = CUBIC_MILLIMETRE.to_si(prepared[3]);
        out.mass = out.volume * design.density;
        out.excluded_radius = MILLIMETRE.to_si(design.dimensions.excluded_radius(design.kind));
        out.clamp_pressure = MEGAPASCAL.to_si(design.case.pressure);
        if wanted & FINITE_ELEMENTS != 0
            && let Some(view) = answers(prepared)
        {
            let fatigue = wanted & (1 << OUT.fatigue_safety | 1 << OUT.fatigue_amplitude | 1 << OUT.fatigue_mean) != 0;
            let asked = Asked {
                strength: fatigue.then_some(design.strength),
                own: design.own_points.map(|point| point.map(|point| nearest(&view, point))),
            };
            let summary = match last {
                Some((case, before, summary)) if *case == design.case && *before == asked => *summary,
                _ => Turn::new(view, design.case).summary(asked.strength, asked.own),
            };
            *last = Some((design.case, asked, summary));
            write(&mut out, &summary, &view, &design);
        }
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

fn write(out: &mut Result<f64>, summary: &Summary, view: &View<'_>, design: &Design) {
    let stress = |value| MEGAPASCAL.to_si(value);
    let peak = summary.largest;
    out.max_stress = stress(peak.stress);
    out.max_stress_r = MILLIMETRE.to_si(view.r()[peak.point]);
    out.max_stress_z = MILLIMETRE.to_si(view.z()[peak.point]);
    out.max_stress_theta = peak.theta;
    let points = summary.check_points.map(|point| stress(point.map_or(0.0, |peak| peak.stress)));
    [out.bl, out.br, out.cl, out.cr, out.dl, out.dr, out.el, out.er, out.fl, out.fr] = points;
    [out.own_1, out.own_2] = summary.own_points.map(|point| stress(point.map_or(0.0, |peak| peak.stress)));
    out.rim_displacement = MILLIMETRE.to_si(summary.rim_displacement);
    out.yield_safety = design.yield_strength / peak.stress;
    if let Some(fatigue) = summary.fatigue {
        out.fatigue_safety = 1.0 / fatigue.used;
        out.fatigue_amplitude = stress(fatigue.amplitude);
        out.fatigue_mean = stress(fatigue.mean);
    }
}
