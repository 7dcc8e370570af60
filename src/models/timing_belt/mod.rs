//! Timing belt on one pulley: complete meshing, and incomplete meshing where the centrifugal force lifts teeth out.
//!
//! Source: H. S. Kim, C. K. Yeo, I. H. Lee, on the force distribution of incomplete meshing teeth in timing belt drives; equation
//! numbers below are that paper's. Symbols: teeth 1 (tight side) .. N + 1 (slack side); T(i) tension leaving tooth i, Q(i) load of
//! tooth i; 2 beta angle of a tip land, 2 phi of a tooth space; `e = exp(-2 mu beta)`; S = 2 beta r length of a land, l of the belt's tooth part; f tooth
//! compliance; alpha flank pressure angle; Omega and psi inclination of the tight and slack span; m mass of a pitch; r tip radius;
//! j first lifted tooth, N + 2 if none lifts; theta angle that lifted teeth are rotated by.
//!
//! What this model computes is the tridiagonal system in [`mesh`], in which both tensions act linearly: `prepare` finds what
//! either of them does to every tooth, and to the tensions at every possible boundary. A pair of speed and tension then costs three
//! operations a tooth for what presses it inwards, and as many for the comparison with the centrifugal force. With T_s = 0
//! everything is linear in T_t, so the boundary depends on `m r omega^2 / T_t` alone.
//!
//! The boundary tooth is calibrated, not predicted: the paper compares the centrifugal force with "the sum of the radial inward
//! forces" without printing it. Taken here is the free body of a whole pitch without land reaction,
//! `inward = (T_in + T) sin(phi + beta) + Q (mu cos alpha - sin alpha)`, and m is chosen so that the paper's case (driven pulley,
//! 5000 rpm, 196 N) has its first lifted tooth at the printed 16. `(T_in + T) sin phi` in its place would give 12.
//!
//! # Repairs of the printed equations
//! - (5), (7), (13): printed `1/AE` is `l/AE`. (8): line i has `T(i-1)'`. (14): line M has `T(M-1)`.
//! - (15): the printed "v" is w; `v = f cos(phi - theta)` is missing. Y1: C6, C7 are printed, C5, C6 are meant.
//! - (17)-(19): tooth j - 1 meshes, so it has `cos phi`, and so has nu inside; as printed T* is 2.3 % low at the default belt.
//!   (18): f is missing before the two cosines of T*.
//! - (20): specific weight is used as density; omega is printed in rpm; "f = 2.55 m/N" is micrometres per newton.
//! - Step (4) calls j the boundary, Fig. 9 tooth 15 = j - 1.

use super::formula::{Columns, Formula, record};
use crate::real::{Lanes, Real};
use crate::tape::{Fields, Set};

mod block;
mod mesh;
mod profile;
mod table;

pub use table::model;

/// Most teeth in mesh.
const TEETH: usize = 60;
/// Boundaries: every tooth, and none.
const BOUNDARIES: usize = TEETH + 1;

/// The number that stands for lift angle "space": lifted teeth turn by the whole tooth space.
const SPACE: f64 = -1.0;

record! {
    /// Inputs in the order of the table, in SI units.
    pub(super) Inputs {
        pulley_speed, tight_tension, slack_tension, teeth_in_mesh, friction, tooth_compliance, cord_modulus, cord_area, tip_radius,
        land_half_angle, space_half_angle, tooth_length, pressure_angle, tight_span_angle, slack_span_angle, pitch_mass, lift_angle,
        pitch, centrifugal_land_friction,
    }
}

record! {
    /// What depends on the belt and its pulley alone, besides the tables below.
    pub(super) Prepared { teeth, mass_radius, peak_complete_tight, peak_complete_slack, lift_margin }
}

record! {
    /// Outputs in the order of the table.
    pub(super) Result {
        centrifugal_force, boundary_tooth, boundary_position, incomplete_teeth, lift_speed, boundary_tension, peak_tooth_load,
        peak_tooth_load_complete, least_tooth_load, effective_tension,
    }
}

const OUT: Result<usize> = Result::NUMBER;
const NUMBERS: usize = Prepared::<usize>::NAMES.len();

/// What either tension does to the inward force of every tooth; then, for every boundary, to T* and to the four loads of
/// [`mesh::Boundary`].
const TABLES: &[(&str, usize)] = &[
    ("inward_tight", TEETH),
    ("inward_slack", TEETH),
    ("star_tight", BOUNDARIES),
    ("star_slack", BOUNDARIES),
    ("first_tight", BOUNDARIES),
    ("first_slack", BOUNDARIES),
    ("own_tight", BOUNDARIES),
    ("own_slack", BOUNDARIES),
    ("before_tight", BOUNDARIES),
    ("before_slack", BOUNDARIES),
    ("last_tight", BOUNDARIES),
    ("last_slack", BOUNDARIES),
];
/// Where the tables of inward forces and of boundaries start.
const INWARD: usize = NUMBERS;
const MESH: usize = INWARD + 2 * TEETH;

/// Positions in [`mesh::Boundary`].
const STAR: usize = 0;
const FIRST: usize = 1;
const OWN: usize = 2;
const BEFORE: usize = 3;
const LAST: usize = 4;
const PARTS: usize = 5;
/// Outputs that need each.
const NEEDED_BY: [Set; PARTS] = [
    Set::of(&[OUT.boundary_tension]),
    Set::of(&[OUT.peak_tooth_load]),
    Set::of(&[OUT.peak_tooth_load]),
    Set::of(&[OUT.least_tooth_load]),
    Set::of(&[OUT.least_tooth_load]),
];

const TOOTH: Set = Set::of(&[OUT.boundary_tooth, OUT.boundary_position, OUT.incomplete_teeth]);
const LIFT: Set = Set::of(&[OUT.lift_speed]);
const INCOMPLETE: Set = Set::of(&[OUT.boundary_tension, OUT.peak_tooth_load, OUT.least_tooth_load]);
/// Number of the condition that a tooth lifts.
const LIFTS: usize = 2;

pub(super) struct TimingBelt;

impl Formula for TimingBelt {
    const FIELDS: Fields = Fields {
        inputs: Inputs::<usize>::NAMES,
        prepared: Prepared::<usize>::NAMES,
        tables: TABLES,
        // Conditions, lift speed and boundary each walk over the teeth.
        turns: 3 * TEETH as u64,
        conditions: LIFTS + 1,
        outputs: Result::<usize>::NAMES,
    };

    fn prepare<R: Real>(inputs: &[R], wanted: Set, prepared: &mut [R]) {
        let i = Inputs::read(inputs);
        let rows = mesh::Rows::new(&i);
        let elimination = mesh::Elimination::new(&rows);
        let complete = mesh::complete(&rows, &elimination);
        Prepared {
            teeth: i.teeth_in_mesh,
            mass_radius: i.pitch_mass * i.tip_radius,
            // Loads fall towards the slack side: the first tooth's is the largest.
            peak_complete_tight: complete.load[0].tight,
            peak_complete_slack: complete.load[0].slack,
            lift_margin: R::select(i.lift_angle, i.space_half_angle - i.lift_angle, R::constant(1.0)),
        }
        .write(prepared);
        for tooth in 0..complete.teeth {
            prepared[INWARD + tooth] = complete.inward[tooth].tight;
            prepared[INWARD + TEETH + tooth] = complete.inward[tooth].slack;
        }
        if wanted.meets(INCOMPLETE) {
            let boundaries = mesh::boundaries(&rows, &elimination, &complete);
            for (at, boundary) in boundaries[..=complete.teeth].iter().enumerate() {
                for (number, value) in boundary.iter().enumerate() {
                    prepared[MESH + 2 * number * BOUNDARIES + at] = value.tight;
                    prepared[MESH + (2 * number + 1) * BOUNDARIES + at] = value.slack;
                }
            }
        }
    }

    #[inline(always)]
    fn conditions<R: Real>(prepared: &[R::Shared], inputs: &[R], wanted: Set, margins: &mut [R]) {
        let p = Prepared::<R>::shared(prepared);
        let i = Inputs::read(inputs);
        margins[0] = i.tight_tension - i.slack_tension;
        margins[1] = p.lift_margin;
        if wanted.contains(LIFTS) {
            margins[LIFTS] = p.mass_radius * i.pulley_speed.squared() - least_inward(&p, &i, prepared);
        }
    }

    #[inline(always)]
    fn finish_block(prepared: &[f64], inputs: &[Lanes], columns: &Columns<'_>, results: &mut [Vec<f64>]) -> bool {
        block::teeth_at_one_load(prepared, inputs, columns, results)
    }

    #[inline(always)]
    fn finish<R: Real>(prepared: &[R::Shared], inputs: &[R], wanted: Set, out: &mut [R]) {
        let out = &mut out[..Result::<usize>::NAMES.len()];
        let (zero, half, one) = (R::constant(0.0), R::constant(0.5), R::constant(1.0));
        let p = Prepared::<R>::shared(prepared);
        let i = Inputs::read(inputs);
        let force = p.mass_radius * i.pulley_speed.squared(); // m r omega^2
        out[OUT.centrifugal_force] = force;
        out[OUT.effective_tension] = i.tight_tension - i.slack_tension;
        if wanted.contains(OUT.peak_tooth_load_complete) {
            out[OUT.peak_tooth_load_complete] = i.tight_tension * p.peak_complete_tight + i.slack_tension * p.peak_complete_slack;
        }
        if wanted.meets(LIFT) {
            out[OUT.lift_speed] = (least_inward(&p, &i, prepared).max(zero) / p.mass_radius).sqrt();
        }
        if !wanted.meets(TOOTH | INCOMPLETE) {
            return;
        }
        if !wanted.meets(INCOMPLETE) && !wanted.contains(OUT.boundary_position) {
            let boundary_tooth = walk(&p, &i, prepared, force);
            out[OUT.boundary_tooth] = boundary_tooth;
            out[OUT.incomplete_teeth] = p.teeth.plus_whole(one).plus_whole(-boundary_tooth);
            return;
        }
        // The same walk with everything that is found on the way: 1 as long as every tooth so far is pressed inwards, counted.
        let (mut meshes, mut boundary_tooth) = (R::select(p.teeth, one, zero), one);
        // Margins of the tooth at which the walk ended and of the one before it.
        let (mut before, mut at) = (zero, one);
        let mut picked = [[zero; 2]; PARTS];
        let mut part = 0;
        while part < PARTS {
            if wanted.meets(NEEDED_BY[part]) {
                picked[part] = boundary_entry::<R>(prepared, part, 0);
            }
            part += 1;
        }
        let teeth = p.teeth.turns(TEETH);
        let mut tooth = 0;
        while tooth < teeth {
            let margin = inward(&i, prepared, tooth) - force;
            let open = meshes - half;
            before = R::select(open, at, before);
            at = R::select(open, margin, at);
            meshes = R::select(margin, meshes, zero);
            boundary_tooth = boundary_tooth.plus_whole(meshes);
            tooth += 1;
            let still_open = meshes - half;
            let mut part = 0;
            while part < PARTS {
                if wanted.meets(NEEDED_BY[part]) {
                    let next = boundary_entry::<R>(prepared, part, tooth);
                    picked[part][0] = R::select(still_open, next[0], picked[part][0]);
                    picked[part][1] = R::select(still_open, next[1], picked[part][1]);
                }
                part += 1;
            }
        }
        boundary_tooth = boundary_tooth.min(p.teeth.plus_whole(one));
        out[OUT.boundary_tooth] = boundary_tooth;
        out[OUT.incomplete_teeth] = p.teeth.plus_whole(one).plus_whole(-boundary_tooth);
        let inside = boundary_tooth - one + before / (before - at);
        let lifted = R::select(boundary_tooth - (one + half), inside, one);
        out[OUT.boundary_position] = R::select(meshes - half, boundary_tooth, lifted);
        if wanted.meets(INCOMPLETE) {
            let load = |part: usize| i.tight_tension * picked[part][0] + i.slack_tension * picked[part][1];
            out[OUT.boundary_tension] = load(STAR);
            out[OUT.peak_tooth_load] = load(FIRST).max(load(OWN));
            out[OUT.least_tooth_load] = load(BEFORE).min(load(LAST));
            if !i.centrifugal_land_friction.is_zero() {
                with_land_friction(&i, boundary_tooth, out);
            }
        }
    }
}

/// The first lifted tooth: going from the tight side, 1 as long as every tooth so far is pressed inwards, counted.
#[inline(always)]
fn walk<R: Real>(p: &Prepared<R>, i: &Inputs<R>, prepared: &[R::Shared], force: R) -> R {
    let (zero, one) = (R::constant(0.0), R::constant(1.0));
    // There are teeth to walk over; asking makes the result depend on their number, which a loop alone does not.
    let (mut meshes, mut boundary_tooth) = (R::select(p.teeth, one, zero), one);
    let teeth = p.teeth.turns(TEETH);
    let mut tooth = 0;
    while tooth < teeth {
        meshes = R::select(inward(i, prepared, tooth) - force, meshes, zero);
        // Once a tooth has lifted the count stands.
        if meshes.is_zero() {
            break;
        }
        boundary_tooth = boundary_tooth.plus_whole(meshes);
        tooth += 1;
    }
    // Where others have more teeth, the walk goes on over some that never lift.
    boundary_tooth.min(p.teeth.plus_whole(one))
}

/// What both tensions do to a part of boundary number `at` + 1.
#[inline(always)]
fn boundary_entry<R: Real>(prepared: &[R::Shared], part: usize, at: usize) -> [R; 2] {
    let place = MESH + 2 * part * BOUNDARIES + at;
    [R::shared(prepared[place]), R::shared(prepared[place + BOUNDARIES])]
}

/// What presses a tooth (from 0) inwards with the complete mesh.
#[inline(always)]
fn inward<R: Real>(i: &Inputs<R>, prepared: &[R::Shared], tooth: usize) -> R {
    i.tight_tension * R::shared(prepared[INWARD + tooth]) + i.slack_tension * R::shared(prepared[INWARD + TEETH + tooth])
}

#[inline(always)]
fn least_inward<R: Real>(p: &Prepared<R>, i: &Inputs<R>, prepared: &[R::Shared]) -> R {
    let mut least = R::select(p.teeth, inward(i, prepared, 0), R::constant(0.0));
    let teeth = p.teeth.turns(TEETH);
    let mut tooth = 1;
    while tooth < teeth {
        least = least.min(inward(i, prepared, tooth));
        tooth += 1;
    }
    least
}

/// T_c = (m/p) (r omega)^2: the tension that only bends the moving belt around.
fn centrifugal_tension<R: Real>(i: &Inputs<R>) -> R {
    i.pitch_mass / i.pitch * (i.tip_radius * i.pulley_speed).squared()
}

/// The incomplete mesh with the option, for which no table serves: every pair is solved for itself.
#[inline(never)]
fn with_land_friction<R: Real>(i: &Inputs<R>, boundary_tooth: R, out: &mut [R]) {
    let rows = mesh::Rows::new(i);
    let option = i.centrifugal_land_friction;
    let solved = mesh::solve(&rows, i.tight_tension, i.slack_tension, boundary_tooth, option, centrifugal_tension(i));
    let (mut peak, mut least) = (solved.load[0], solved.load[0]);
    for tooth in 1..i.teeth_in_mesh.turns(TEETH) {
        let there = R::constant(tooth as f64 + 0.5) - i.teeth_in_mesh;
        peak = R::select(there, peak, peak.max(solved.load[tooth]));
        least = R::select(there, least, least.min(solved.load[tooth]));
    }
    // The switch may be off for some of the designs that are computed together.
    let on = option - R::constant(0.5);
    out[OUT.boundary_tension] = R::select(on, solved.star, out[OUT.boundary_tension]);
    out[OUT.peak_tooth_load] = R::select(on, peak, out[OUT.peak_tooth_load]);
    out[OUT.least_tooth_load] = R::select(on, least, out[OUT.least_tooth_load]);
}

#[cfg(test)]
mod tests;
