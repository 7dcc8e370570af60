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
//! The torque is `(T_t - T_s) (r + a)`, a being the distance of the pitch line from the tips: spans pull where the cords are.
//!
//! The boundary tooth is calibrated, not predicted: the paper compares the centrifugal force with "the sum of the radial inward
//! forces" without printing it. Taken here is the free body of a whole pitch without land reaction,
//! `inward = (T_in + T) sin(phi + beta) + Q (mu cos alpha - sin alpha)`, and m is chosen so that the paper's case (driven pulley,
//! 5000 rpm, 196 N) has its first lifted tooth at the printed 16. `(T_in + T) sin phi` in its place would give 12. An ordinary car belt of
//! twice that mass (preset `car-belt`) has its first lifted tooth at 7 there. With that belt the printed 16 comes out without calibration
//! if the printed speed is the engine's, so that the driven pulley turns at 2500 rpm, and the balance has `(T_in + T) sin phi`.
//!
//! # Repairs of the printed equations
//! - (5), (7), (13): printed `1/AE` is `l/AE`. (8): line i has `T(i-1)'`. (14): line M has `T(M-1)`.
//! - (15): the printed "v" is w; `v = f cos(phi - theta)` is missing. Y1: C6, C7 are printed, C5, C6 are meant.
//! - (17)-(19): tooth j - 1 meshes, so it has `cos phi`, and so has nu inside; as printed T* is 2.3 % low at the default belt.
//!   (18): f is missing before the two cosines of T*.
//! - (20): specific weight is used as density; omega is printed in rpm; "f = 2.55 m/N" is micrometres per newton.
//! - Step (4) calls j the boundary, Fig. 9 tooth 15 = j - 1.

use super::formula::{Columns, Formula, record};
use crate::real::{Lanes, Loop, Place, Real};
use crate::tape::{Fields, Set};
use std::f64::consts::PI;

mod block;
mod mesh;
mod notes;
mod profile;
mod table;

pub use table::model;

/// Most teeth in mesh.
const TEETH: usize = 60;
/// Boundaries: every tooth, and none.
const BOUNDARIES: usize = TEETH + 1;

/// The number that stands for lift angle "space": lifted teeth turn by the whole tooth space.
const SPACE: f64 = -1.0;
/// The number that stands for pitch mass "from-belt": what a pitch of the belt weighs by (20).
const FROM_BELT: f64 = -1.0;

record! {
    /// Inputs in the order of the table, in SI units.
    pub(super) Inputs {
        pulley_speed, tight_tension, slack_tension, teeth_in_mesh, friction, tooth_compliance, cord_modulus, cord_area, tip_radius,
        land_half_angle, space_half_angle, tooth_length, pressure_angle, tight_span_angle, slack_span_angle, pitch_mass, lift_angle,
        pitch, centrifugal_land_friction, pitch_line, belt_width, tooth_area, land_area, gross_cord_area, rubber_density, cord_density,
    }
}

record! {
    /// What depends on the belt and its pulley alone, besides the tables below.
    pub(super) Prepared {
        teeth, mass_radius, peak_complete_tight, peak_complete_slack, lift_margin, wrap_margin, pitch_radius, pitch_mass,
    }
}

record! {
    /// Outputs in the order of the table.
    pub(super) Result {
        centrifugal_force, boundary_tooth, boundary_position, incomplete_teeth, lift_speed, boundary_tension, peak_tooth_load,
        peak_tooth_load_complete, least_tooth_load, effective_tension, torque, pitch_mass_used,
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

const TOOTH: Set = Set::of(&[OUT.boundary_tooth, OUT.boundary_position, OUT.incomplete_teeth]);
const LIFT: Set = Set::of(&[OUT.lift_speed]);
const INCOMPLETE: Set = Set::of(&[OUT.boundary_tension, OUT.peak_tooth_load, OUT.least_tooth_load]);
/// Number of the condition that a tooth lifts.
const LIFTS: usize = 3;

pub(super) struct TimingBelt;

impl Formula for TimingBelt {
    const FIELDS: Fields = Fields {
        inputs: Inputs::<usize>::NAMES,
        prepared: Prepared::<usize>::NAMES,
        tables: TABLES,
        // Conditions, lift speed and boundary each walk over the teeth.
        iterations: 3 * TEETH as u64,
        conditions: LIFTS + 1,
        outputs: Result::<usize>::NAMES,
    };

    fn prepare<R: Real>(inputs: &[R], wanted: Set, prepared: &mut [R]) {
        let i = Inputs::read(inputs);
        let rows = mesh::RowCoefficients::new(&i);
        let elimination = mesh::Elimination::new(&rows);
        let (numbers, tables) = prepared.split_at_mut(NUMBERS);
        let (inward, boundaries) = tables.split_at_mut(2 * TEETH);
        let mut found = mesh::ToothTables {
            inward: in_two(inward),
            boundaries: (wanted.meets(INCOMPLETE)).then(|| {
                let mut parts = boundaries.chunks_mut(2 * BOUNDARIES);
                std::array::from_fn(|_| in_two(parts.next().expect("there are as many tables")))
            }),
        };
        let first = mesh::back(&rows, &elimination, &mut found);
        let mass = pitch_mass(&i).named("mass", "(20)");
        let half_pitch = i.land_half_angle + i.space_half_angle;
        Prepared {
            teeth: i.teeth_in_mesh,
            mass_radius: mass * i.tip_radius,
            // Loads fall towards the slack side: the first tooth's is the largest.
            peak_complete_tight: first.tight,
            peak_complete_slack: first.slack,
            lift_margin: R::select(i.lift_angle, i.space_half_angle - i.lift_angle, R::constant(1.0)),
            wrap_margin: R::constant(PI) - i.teeth_in_mesh * half_pitch,
            pitch_radius: i.tip_radius + i.pitch_line,
            pitch_mass: mass,
        }
        .write(numbers);
    }

    #[inline(always)]
    fn conditions<R: Real>(prepared: &[R::Shared], inputs: &[R], wanted: Set, margins: &mut [R]) {
        let p = Prepared::<R>::shared(prepared);
        let i = Inputs::read(inputs);
        margins[0] = i.tight_tension - i.slack_tension;
        margins[1] = p.lift_margin;
        margins[2] = p.wrap_margin;
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
        let effective = i.tight_tension - i.slack_tension;
        out[OUT.effective_tension] = effective;
        out[OUT.torque] = effective * p.pitch_radius;
        out[OUT.pitch_mass_used] = p.pitch_mass;
        if wanted.contains(OUT.peak_tooth_load_complete) {
            out[OUT.peak_tooth_load_complete] = i.tight_tension * p.peak_complete_tight + i.slack_tension * p.peak_complete_slack;
        }
        if wanted.meets(LIFT) {
            out[OUT.lift_speed] = (least_inward(&p, &i, prepared).max(zero) / p.mass_radius).sqrt();
        }
        if !wanted.meets(TOOTH | INCOMPLETE) {
            return;
        }
        let last = p.teeth.plus_whole(one);
        let boundary_tooth;
        if !wanted.contains(OUT.boundary_position) {
            boundary_tooth = walk(&p, &i, prepared, force);
        } else {
            // The same walk, with the margins of the tooth at which it ended and of the one before.
            let begin = [R::select(p.teeth, one, zero), one, zero, one];
            let [meshes, counted, before, at] = R::fold(
                teeth_until_one_lifts(&p).named(&["meshes", "counted", "before", "at"]),
                begin,
                #[inline(always)]
                |tooth, [meshes, counted, before, at]| {
                    let open = meshes - half;
                    let margin = inward(&i, prepared, tooth) - force;
                    let meshes = R::select(margin, meshes, zero);
                    [meshes, counted.plus_whole(meshes), R::select(open, at, before), R::select(open, margin, at)]
                },
            );
            boundary_tooth = counted.min(last).named("boundary_tooth", "");
            let inside = boundary_tooth - one + before / (before - at);
            let lifted = R::select(boundary_tooth - (one + half), inside, one);
            out[OUT.boundary_position] = R::select(meshes - half, boundary_tooth, lifted);
        }
        out[OUT.boundary_tooth] = boundary_tooth;
        out[OUT.incomplete_teeth] = last.plus_whole(-boundary_tooth);
        if !wanted.meets(INCOMPLETE) {
            return;
        }
        let at = boundary_tooth.plus_whole(-one).named("at_boundary", "");
        if wanted.contains(OUT.boundary_tension) {
            out[OUT.boundary_tension] = load_at(&p, &i, prepared, STAR, at);
        }
        if wanted.contains(OUT.peak_tooth_load) {
            out[OUT.peak_tooth_load] = load_at(&p, &i, prepared, FIRST, at).max(load_at(&p, &i, prepared, OWN, at));
        }
        if wanted.contains(OUT.least_tooth_load) {
            out[OUT.least_tooth_load] = load_at(&p, &i, prepared, BEFORE, at).min(load_at(&p, &i, prepared, LAST, at));
        }
        if !i.centrifugal_land_friction.is_zero() {
            with_land_friction(&i, boundary_tooth, out);
        }
    }
}

/// Two tables of the same length that stand one behind the other.
fn in_two<R>(tables: &mut [R]) -> [&mut [R]; 2] {
    let (tight, slack) = tables.split_at_mut(tables.len() / 2);
    [tight, slack]
}

/// The loop of a walk whose state begins with 1 as long as every tooth is pressed inwards.
#[inline(always)]
fn teeth_until_one_lifts<R: Real>(p: &Prepared<R>) -> Loop<R> {
    Loop::to(p.teeth, TEETH).until_zero(0)
}

/// The first lifted tooth: going from the tight side, 1 as long as every tooth so far is pressed inwards, counted.
#[inline(always)]
fn walk<R: Real>(p: &Prepared<R>, i: &Inputs<R>, prepared: &[R::Shared], force: R) -> R {
    let (zero, one) = (R::constant(0.0), R::constant(1.0));
    // There are teeth to walk over; asking makes the result depend on their number, which a loop alone does not.
    let begin = [R::select(p.teeth, one, zero), one];
    // Once a tooth has lifted the count stands.
    let [_, counted] = R::fold(
        teeth_until_one_lifts(p).named(&["meshes", "counted"]),
        begin,
        #[inline(always)]
        |tooth, [meshes, counted]| {
            let meshes = R::select(inward(i, prepared, tooth) - force, meshes, zero);
            [meshes, counted.plus_whole(meshes)]
        },
    );
    // Where others have more teeth, the walk goes on over some that never lift.
    counted.min(p.teeth.plus_whole(one))
}

/// The load with this number in [`mesh::Boundary`], with the boundary tooth at `at`, from 0.
#[inline(always)]
fn load_at<R: Real>(p: &Prepared<R>, i: &Inputs<R>, prepared: &[R::Shared], part: usize, at: R) -> R {
    let table = MESH + 2 * part * BOUNDARIES;
    let tight = R::passed_at(&prepared[table..table + BOUNDARIES], at, p.teeth);
    let slack = R::passed_at(&prepared[table + BOUNDARIES..table + 2 * BOUNDARIES], at, p.teeth);
    i.tight_tension * tight + i.slack_tension * slack
}

/// What presses a tooth (from 0) inwards with the complete mesh.
#[inline(always)]
fn inward<R: Real>(i: &Inputs<R>, prepared: &[R::Shared], tooth: Place) -> R {
    let tight = R::passed(&prepared[INWARD..INWARD + TEETH], tooth);
    let slack = R::passed(&prepared[INWARD + TEETH..INWARD + 2 * TEETH], tooth);
    i.tight_tension * tight + i.slack_tension * slack
}

#[inline(always)]
fn least_inward<R: Real>(p: &Prepared<R>, i: &Inputs<R>, prepared: &[R::Shared]) -> R {
    let first = R::select(p.teeth, inward(i, prepared, Place::at(0)), R::constant(0.0));
    let [least] = R::fold(
        Loop::to(p.teeth, TEETH).from(1).named(&["least"]),
        [first],
        #[inline(always)]
        |tooth, [least]| [least.min(inward(i, prepared, tooth))],
    );
    least
}

/// m of (20) where the word asks for it: the rubber of the tooth and of the belt's back, and the cords.
fn pitch_mass<R: Real>(i: &Inputs<R>) -> R {
    let rubber = i.rubber_density * ((i.tooth_area + i.land_area) * i.belt_width);
    let cords = i.cord_density * (i.gross_cord_area * i.pitch);
    R::select(i.pitch_mass, i.pitch_mass, rubber + cords)
}

/// T_c = (m/p) (r omega)^2: the tension that only bends the moving belt around.
fn centrifugal_tension<R: Real>(i: &Inputs<R>) -> R {
    pitch_mass(i) / i.pitch * (i.tip_radius * i.pulley_speed).squared()
}

/// The incomplete mesh with the option, for which no table serves: every pair is solved for itself.
#[inline(never)]
fn with_land_friction<R: Real>(i: &Inputs<R>, boundary_tooth: R, out: &mut [R]) {
    let option = i.centrifugal_land_friction;
    let [star, peak, least] = R::left_to_f64(|| {
        let rows = mesh::RowCoefficients::new(i);
        let solved = mesh::solve(&rows, i.tight_tension, i.slack_tension, boundary_tooth, option, centrifugal_tension(i));
        let (mut peak, mut least) = (solved.load[0], solved.load[0]);
        for tooth in 1..i.teeth_in_mesh.iterations(TEETH) {
            let there = R::constant(tooth as f64 + 0.5) - i.teeth_in_mesh;
            peak = R::select(there, peak, peak.max(solved.load[tooth]));
            least = R::select(there, least, least.min(solved.load[tooth]));
        }
        [solved.star, peak, least]
    });
    // The switch may be off for some of the designs that are computed together.
    let on = option - R::constant(0.5);
    for (output, number) in [(OUT.boundary_tension, star), (OUT.peak_tooth_load, peak), (OUT.least_tooth_load, least)] {
        out[output] = R::select(on, number, out[output]);
    }
}

#[cfg(test)]
mod tests;
