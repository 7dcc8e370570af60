//! Tensions and tooth loads of a belt on one pulley: what every pair of tensions has in common is solved once.
//!
//! One row per tooth gap i = 1..N, divided by f cos phi, so that what a meshing tooth gives counts as 1:
//!
//! `k_i T(i) = H(i) - H(i+1)`, `H(i) = in(i) T(i-1) - out(i) T(i)`, `T(0) = T_t`, `T(N+1) = T_s`
//!
//! A tridiagonal system with more on its diagonal than beside it, so it is eliminated without pivoting: from the tight side over the
//! teeth that mesh, `T(i) = lambda(i) T(i+1) + kappa(i) T_t`, from the slack side over those that are lifted,
//! `T(i) = rho(i) T(i-1) + sigma(i) T_s`. Neither depends on where the boundary is; at a boundary the two meet in one equation for
//! `T* = T(j-1)`. So all boundaries together cost no more than a few solves.
//!
//! Loads are small differences of tensions. They are summed from the slack side instead, `H(i) = H(i+1) + k_i T(i)`: all terms are
//! positive.
//!
//! lambda and rho are nearly one, because a tooth gives far more than a pitch stretches: what they lack of one, `1 - lambda = s/(1 + s)`
//! with `s = k + e (1 - lambda(i-1))`, has only positive terms and keeps every digit where their difference would lose two.

use super::{Inputs, TEETH};
use crate::real::Real;

/// More than any centrifugal force, for teeth that the pulley does not have.
const NEVER_LIFTS: f64 = 1e30;

/// Coefficients of the rows, divided by f cos phi.
#[derive(Clone, Copy, Debug)]
pub struct Rows<R> {
    /// Teeth in mesh, N + 1.
    pub teeth: R,
    /// `exp(-2 mu beta)`: what a land leaves of the tension.
    pub land_ratio: R,
    /// What it takes: 1 - land_ratio.
    pub lost: R,
    /// Stretch of a pitch per tension, with friction on the land and without: K and (S + l)/(A E).
    pub stretch: R,
    pub free_stretch: R,
    /// Cosines of the tight and slack span's inclination, and of phi + theta and phi - theta at a lifted tooth.
    pub tight: R,
    pub slack: R,
    pub lifted_in: R,
    pub lifted_out: R,
    /// cos(phi - theta) - cos(phi + theta), as a product.
    pub lifted_apart: R,
    /// What makes a tooth's load of H: cos alpha where it meshes, g where it is lifted.
    pub flank: R,
    pub lifted_flank: R,
    /// Radial shares of tension and tooth load: sin(phi + beta) and mu cos alpha - sin alpha.
    pub inwards: R,
    pub load_inwards: R,
}

/// A number that is linear in the two tensions.
#[derive(Clone, Copy, Debug)]
pub struct Linear<R> {
    pub tight: R,
    pub slack: R,
}

impl<R: Real> Linear<R> {
    fn new(tight: R, slack: R) -> Self {
        Self { tight, slack }
    }
    fn scaled(self, by: R) -> Self {
        Self::new(self.tight * by, self.slack * by)
    }
    fn over(self, by: R) -> Self {
        Self::new(self.tight / by, self.slack / by)
    }
    fn plus(self, other: Self) -> Self {
        Self::new(self.tight + other.tight, self.slack + other.slack)
    }
    fn select(margin: R, at_least_zero: Self, below_zero: Self) -> Self {
        Self::new(R::select(margin, at_least_zero.tight, below_zero.tight), R::select(margin, at_least_zero.slack, below_zero.slack))
    }
}

/// What the incomplete mesh comes to if tooth j is the first lifted one: T*, the load of the first tooth, of the boundary tooth, of the
/// tooth before it, and of the last one. Loads fall from tooth to tooth on either side of the boundary, because every tension is
/// positive; so the largest and the least are among these.
pub type Boundary<R> = [Linear<R>; 5];

impl<R: Real> Rows<R> {
    pub fn new(i: &Inputs<R>) -> Self {
        let [one, two] = [1.0, 2.0].map(R::constant);
        let lift = lift_angle(i);
        // (1 - e)/mu is 2 beta in the limit mu -> 0, which the least friction that can be told from it gives exactly.
        let around = (two * i.friction * i.land_half_angle).max(R::constant(1e-30));
        let lost = -(-around).exp_m1();
        let land = two * i.land_half_angle * i.tip_radius;
        let meshed = i.space_half_angle.cos();
        let rigidity = i.cord_modulus * i.cord_area * i.tooth_compliance * meshed;
        let (sine, cosine) = (i.pressure_angle.sin(), i.pressure_angle.cos());
        let rotated = i.pressure_angle + lift;
        Self {
            teeth: i.teeth_in_mesh,
            land_ratio: one - lost,
            lost,
            stretch: (land * (lost / around) + i.tooth_length) / rigidity,
            free_stretch: (land + i.tooth_length) / rigidity,
            tight: i.tight_span_angle.cos() / meshed,
            slack: i.slack_span_angle.cos() / meshed,
            lifted_in: (i.space_half_angle + lift).cos() / meshed,
            lifted_out: (i.space_half_angle - lift).cos() / meshed,
            lifted_apart: two * i.space_half_angle.sin() * lift.sin() / meshed,
            flank: cosine / meshed,
            lifted_flank: (rotated.cos() + i.friction * rotated.sin()) / meshed,
            inwards: (i.space_half_angle + i.land_half_angle).sin(),
            load_inwards: i.friction * cosine - sine,
        }
    }

    /// At least zero from tooth `tooth` on, below zero before: half a tooth away from either, so that rounding cannot matter.
    fn reaches_last(&self, tooth: usize) -> R {
        R::constant(tooth as f64 + 0.5) - self.teeth
    }

    /// What tooth `tooth` takes in of the tension before it, if it meshes.
    fn taken_in(&self, tooth: usize) -> R {
        if tooth == 1 { self.tight } else { self.land_ratio }
    }
}

/// The angle that lifted teeth are rotated by; the input's word stands for the whole tooth space.
pub fn lift_angle<R: Real>(i: &Inputs<R>) -> R {
    R::select(i.lift_angle, i.lift_angle, i.space_half_angle)
}

/// Elimination from the tight side over meshing teeth.
pub struct Elimination<R> {
    gaps: usize,
    /// `T(i) = after[i] T(i+1) + tight[i] T_t`; at 0 it is T_t itself.
    after: [R; TEETH + 1],
    tight: [R; TEETH + 1],
    /// 1 - after.
    short: [R; TEETH + 1],
    /// The last row of the complete mesh, whose tooth leaves into the slack span.
    after_last: [R; TEETH + 1],
}

impl<R: Real> Elimination<R> {
    pub fn new(rows: &Rows<R>) -> Self {
        let zero = R::constant(0.0);
        let gaps = rows.teeth.turns(TEETH).max(2) - 1;
        let (mut after, mut tight, mut after_last) = ([zero; TEETH + 1], [zero; TEETH + 1], [zero; TEETH + 1]);
        let mut short = [R::constant(1.0); TEETH + 1];
        let one = R::constant(1.0);
        tight[0] = one;
        for gap in 1..=gaps {
            let beyond = rows.stretch + rows.land_ratio * short[gap - 1];
            let pivot = one + beyond;
            after[gap] = one / pivot;
            short[gap] = beyond / pivot;
            tight[gap] = rows.taken_in(gap) * tight[gap - 1] * after[gap];
            after_last[gap] = rows.slack * after[gap];
        }
        Self { gaps, after, tight, short, after_last }
    }

    /// Tensions of the complete mesh, T(1)..T(N) at their numbers; T_t at 0, T_s from N + 1 on.
    fn complete(&self, rows: &Rows<R>) -> [Linear<R>; TEETH + 1] {
        let [zero, one] = [0.0, 1.0].map(R::constant);
        let slack = Linear::new(zero, one);
        let mut tension = [slack; TEETH + 1];
        tension[0] = Linear::new(one, zero);
        for gap in (1..=self.gaps).rev() {
            let behind = tension[(gap + 1).min(TEETH)];
            let inner = Linear::new(self.after[gap] * behind.tight + self.tight[gap], self.after[gap] * behind.slack);
            // Gap number `teeth - 1` is the last; those beyond it, which only a range of teeth has, are overwritten there.
            let last = Linear::new(self.tight[gap], self.after_last[gap]);
            let is_inner = Linear::select(rows.reaches_last(gap + 1), last, inner);
            tension[gap] = Linear::select(rows.reaches_last(gap), slack, is_inner);
        }
        tension
    }
}

/// The complete mesh: load of every tooth and what presses it inwards, (8) and the free body of a pitch.
pub struct Complete<R> {
    pub teeth: usize,
    /// At tooth - 1.
    pub tension: [Linear<R>; TEETH],
    pub load: [Linear<R>; TEETH],
    pub inward: [Linear<R>; TEETH],
}

/// Solves the complete mesh.
#[inline(never)]
pub fn complete<R: Real>(rows: &Rows<R>, elimination: &Elimination<R>) -> Complete<R> {
    let [zero, one] = [0.0, 1.0].map(R::constant);
    let tensions = elimination.complete(rows);
    let none = Linear::new(zero, zero);
    let (mut tension, mut load, mut inward) = ([none; TEETH], [none; TEETH], [none; TEETH]);
    let teeth = elimination.gaps + 1;
    let never = Linear::new(R::constant(NEVER_LIFTS), zero);
    // H of the tooth behind, as far as the tight side makes it.
    let mut behind = zero;
    for tooth in (1..=teeth).rev() {
        let at = tooth - 1;
        let before = tensions[at];
        let leaving = Linear::select(rows.reaches_last(tooth), Linear::new(zero, one), tensions[tooth]);
        // Of the tight tension, from the slack side on: H(i) = H(i+1) + k T(i). Of the slack tension, H(i) = -T(i) (1 - e lambda(i-1)).
        let land = if tooth == 1 { one } else { rows.land_ratio };
        let last = rows.taken_in(tooth) * before.tight;
        let by_tight = R::select(rows.reaches_last(tooth), last, behind + rows.stretch * leaving.tight);
        let short = if tooth == 1 { one } else { rows.lost * elimination.after[at] + elimination.short[at] };
        let out = R::select(rows.reaches_last(tooth), rows.slack, one);
        behind = by_tight;
        load[at] = Linear::new(by_tight, -(out * leaving.slack * short)).over(rows.flank);
        tension[at] = leaving;
        let pressed = before.scaled(land).plus(leaving).scaled(rows.inwards).plus(load[at].scaled(rows.load_inwards));
        inward[at] = Linear::select(rows.reaches_last(at), never, pressed);
    }
    Complete { teeth, tension, load, inward }
}

/// The incomplete mesh for every boundary: at j - 1 for j = 1 ..= N + 2, the last of which is the complete mesh.
#[inline(never)]
pub fn boundaries<R: Real>(rows: &Rows<R>, e: &Elimination<R>, complete: &Complete<R>) -> [Boundary<R>; TEETH + 1] {
    let [zero, one] = [0.0, 1.0].map(R::constant);
    let none = Linear::new(zero, zero);
    let (gaps, teeth) = (e.gaps, e.gaps + 1);
    let tight_itself = Linear::new(one, zero);
    let slack_itself = Linear::new(zero, one);

    // From the slack side, of T(i-1) and of T_s: T(i) = rho T(i-1) + sigma T_s with short = 1 - rho; the last gap's tension T(N); the
    // sum of the tensions from T(i) on.
    let (mut rho, mut sigma, mut short) = ([zero; TEETH + 1], [one; TEETH + 1], [one; TEETH + 1]);
    let (mut last, mut sum) = ([tight_itself; TEETH + 1], [none; TEETH + 1]);
    // In units of what a lifted tooth takes in; what it gives is hardly more.
    let (free_stretch, lifted_out) = (rows.free_stretch / rows.lifted_in, one + rows.lifted_apart / rows.lifted_in);
    for gap in (1..=gaps).rev() {
        let short_of = free_stretch + lifted_out * short[gap];
        let pivot = one + short_of;
        let beyond = rows.reaches_last(gap);
        let at = gap - 1;
        let own = if gap == 1 { rows.tight / rows.lifted_in / pivot } else { one / pivot };
        rho[at] = R::select(beyond, zero, own);
        short[at] = R::select(beyond, one, short_of / pivot);
        sigma[at] = R::select(beyond, one, lifted_out * sigma[gap] / pivot);
        let chained = |of: Linear<R>| Linear::new(of.tight * rho[at], of.slack + of.tight * sigma[at]);
        let summed = Linear::new(one + sum[gap].tight, sum[gap].slack);
        last[at] = Linear::select(beyond, tight_itself, chained(last[gap]));
        sum[at] = Linear::select(beyond, none, chained(summed));
    }

    let mut boundaries = [[none; 5]; TEETH + 1];
    // The sum T(1) + .. + T(j-2), of T* and of T_t.
    let (mut meshed_own, mut meshed_tight) = (zero, zero);
    for j in 1..=teeth {
        // At j - 1: what the elimination from the slack side says of T(j).
        let (sigma, last, sum) = (sigma[j - 1], last[j - 1], sum[j - 1]);
        let star = if j == 1 {
            tight_itself
        } else {
            let taken_in = rows.taken_in(j - 1);
            // k' + (1 - e lambda) + (in - out rho); no tooth before the first hands on.
            let meshed = rows.lost + rows.land_ratio * e.short[j - 2];
            let pivot = rows.free_stretch + meshed + rows.lifted_out * short[j - 1] - rows.lifted_apart;
            Linear::new(taken_in * e.tight[j - 2], rows.lifted_out * sigma).over(pivot)
        };
        let of_star = |own: R, slack: R| star.scaled(own).plus(slack_itself.scaled(slack));
        // H(N+1) = cos(phi + theta) T(N) - cos(phi - theta) T_s, H(j) as the sum from there, H(j-1), H(1).
        let force_last = of_star(rows.lifted_in * last.tight, rows.lifted_in * (last.slack - lifted_out));
        let force_own = of_star(rows.lifted_in * last.tight + rows.free_stretch * sum.tight, -(rows.lifted_out * sigma));
        let own = force_own.over(rows.lifted_flank);
        let (first, before) = if j == 1 {
            (own, own)
        } else {
            if j > 2 {
                let with_last = meshed_own + one;
                (meshed_own, meshed_tight) = (with_last * e.after[j - 2], with_last * e.tight[j - 2] + meshed_tight);
            }
            let force_before = force_own.plus(star.scaled(rows.free_stretch));
            let meshed = star.scaled(meshed_own).plus(tight_itself.scaled(meshed_tight));
            (force_before.plus(meshed.scaled(rows.stretch)).over(rows.flank), force_before.over(rows.flank))
        };
        boundaries[j - 1] = [star, first, own, before, force_last.over(rows.lifted_flank)];
    }
    // Without a boundary: the complete mesh; T* has no meaning there.
    let (first, mut last) = (complete.load[0], complete.load[0]);
    for j in 2..=teeth + 1 {
        // Beyond the last tooth, its load stays the last.
        last = if j == 2 { last } else { Linear::select(rows.reaches_last(j - 2), last, complete.load[j - 2]) };
        let of_complete = [none, first, first, last, last];
        let is_none = rows.reaches_last(j - 1);
        for (value, complete) in boundaries[j - 1].iter_mut().zip(of_complete) {
            *value = Linear::select(is_none, complete, *value);
        }
    }
    boundaries
}

/// Tensions and loads of every tooth with the boundary at `j`, solved for these very tensions: T(i) leaving tooth i and Q(i), at
/// tooth - 1. `centrifugal`: the tension T_c of the option for friction on lands, zero without it.
pub struct Solved<R> {
    pub tension: [R; TEETH],
    pub load: [R; TEETH],
    /// Where T* stands: T(j - 1).
    pub star: R,
}

/// The direct solve for one pair of tensions. With the option, lands where the centrifugal force outweighs the tension lose their
/// friction, all of them at once and for good, until nothing changes.
#[inline(never)]
pub fn solve<R: Real>(rows: &Rows<R>, tight: R, slack: R, j: R, option: R, centrifugal: R) -> Solved<R> {
    let [zero, one] = [0.0, 1.0].map(R::constant);
    let teeth = rows.teeth.turns(TEETH).max(2);
    // Without a lifted tooth the mesh is the plain complete one.
    let option = R::select(j - rows.teeth - R::constant(0.5), zero, option);
    let is_lifted = |tooth: usize| R::constant(tooth as f64 + 0.5) - j;
    // 1 where land i, behind tooth i, has friction: both its teeth mesh.
    let mut rubs: [R; TEETH + 1] = std::array::from_fn(|land| R::select(is_lifted(land + 1), zero, one));
    let mut solved = Solved { tension: [slack; TEETH], load: [zero; TEETH], star: tight };
    for _ in 0..=teeth {
        // What arrives at tooth i + 1 of T(i): share T(i) + rest, and the stretch of pitch i: stretch T(i) + offset.
        let share = |land: usize| one - rubs[land] * (one - rows.land_ratio);
        let rest = |land: usize| option * centrifugal * (one - share(land));
        let stretch = |land: usize| rows.free_stretch - rubs[land] * (rows.free_stretch - rows.stretch);
        let offset = |land: usize| option * centrifugal * rubs[land] * (rows.free_stretch - rows.stretch);
        let takes = |tooth: usize| R::select(is_lifted(tooth), rows.lifted_in, one);
        let gives = |tooth: usize| R::select(is_lifted(tooth), rows.lifted_out, R::select(rows.reaches_last(tooth), rows.slack, one));
        let (mut after, mut known) = ([zero; TEETH + 1], [zero; TEETH + 1]);
        known[0] = tight;
        for gap in 1..teeth {
            let (arriving, arriving_rest) =
                if gap == 1 { (rows.tight, zero) } else { (takes(gap) * share(gap - 1), takes(gap) * rest(gap - 1)) };
            let pivot = stretch(gap) + gives(gap) + takes(gap + 1) * share(gap) - arriving * after[gap - 1];
            let right = arriving * known[gap - 1] + arriving_rest - takes(gap + 1) * rest(gap) - offset(gap);
            after[gap] = gives(gap + 1) / pivot;
            known[gap] = right / pivot;
        }
        let mut next = slack;
        for tooth in (1..=teeth).rev() {
            next = R::select(rows.reaches_last(tooth), slack, after[tooth] * next + known[tooth]);
            solved.tension[tooth - 1] = next;
        }
        for tooth in 1..=teeth {
            let before = if tooth == 1 { tight } else { solved.tension[tooth - 2] };
            let entering = if tooth == 1 { rows.tight * tight } else { takes(tooth) * (share(tooth - 1) * before + rest(tooth - 1)) };
            let force = entering - gives(tooth) * solved.tension[tooth - 1];
            solved.load[tooth - 1] = R::select(is_lifted(tooth), force / rows.lifted_flank, force / rows.flank);
            // T(j - 1), of the last tooth before the boundary.
            solved.star = R::select(is_lifted(tooth), solved.star, solved.tension[tooth - 1]);
        }
        let mut changed = zero;
        for (rubs, &tension) in rubs[1..teeth].iter_mut().zip(&solved.tension) {
            let stays = R::select(-option, *rubs, R::select(tension - centrifugal, *rubs, zero));
            changed = changed + *rubs - stays;
            *rubs = stays;
        }
        if changed.is_zero() {
            break;
        }
    }
    solved
}
