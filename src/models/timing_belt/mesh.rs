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
use crate::real::{Loop, Place, Real};

/// Gaps between teeth, with those before the first tooth and after the last.
const PLACES: usize = TEETH + 1;

/// More than any centrifugal force, for teeth that the pulley does not have.
const NEVER_LIFTS: f64 = 1e30;

/// Coefficients of the rows, divided by f cos phi.
#[derive(Clone, Copy, Debug)]
pub struct RowCoefficients<R> {
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
    /// Stretch of a pitch without friction, and what a lifted tooth gives, in units of what it takes in; the latter is hardly more than 1.
    stretch_per_in: R,
    out_per_in: R,
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
    fn named(self, tight: &'static str, slack: &'static str) -> Self {
        Self::new(self.tight.named(tight, ""), self.slack.named(slack, ""))
    }
    fn select(margin: R, at_least_zero: Self, below_zero: Self) -> Self {
        Self::new(R::select(margin, at_least_zero.tight, below_zero.tight), R::select(margin, at_least_zero.slack, below_zero.slack))
    }
}

/// What the incomplete mesh comes to if tooth j is the first lifted one: T*, the load of the first tooth, of the boundary tooth, of the
/// tooth before it, and of the last one. Loads fall from tooth to tooth on either side of the boundary, because every tension is
/// positive; so the largest and the least are among these.
pub type Boundary<R> = [Linear<R>; 5];

impl<R: Real> RowCoefficients<R> {
    pub fn new(i: &Inputs<R>) -> Self {
        let [one, two] = [1.0, 2.0].map(R::constant);
        let lift = lift_angle(i).named("lift", "");
        // (1 - e)/mu is 2 beta in the limit mu -> 0, which the least friction that can be told from it gives exactly.
        let around = (two * i.friction * i.land_half_angle).max(R::constant(1e-30)).named("around", "");
        let lost = (-(-around).exp_m1()).named("lost", "");
        let land = (two * i.land_half_angle * i.tip_radius).named("land", "");
        let meshed = i.space_half_angle.cos().named("meshed", "");
        let rigidity = (i.cord_modulus * i.cord_area * i.tooth_compliance * meshed).named("rigidity", "");
        let (sine, cosine) = (i.pressure_angle.sin(), i.pressure_angle.cos());
        let rotated = i.pressure_angle + lift;
        let free_stretch = ((land + i.tooth_length) / rigidity).named("free_stretch", "(13)");
        let lifted_in = ((i.space_half_angle + lift).cos() / meshed).named("lifted_in", "");
        let lifted_apart = (two * i.space_half_angle.sin() * lift.sin() / meshed).named("lifted_apart", "");
        Self {
            teeth: i.teeth_in_mesh,
            land_ratio: (one - lost).named("land_ratio", ""),
            lost,
            stretch: ((land * (lost / around) + i.tooth_length) / rigidity).named("stretch", "(5), (7)"),
            free_stretch,
            tight: (i.tight_span_angle.cos() / meshed).named("tight_cosine", ""),
            slack: (i.slack_span_angle.cos() / meshed).named("slack_cosine", ""),
            lifted_in,
            lifted_out: ((i.space_half_angle - lift).cos() / meshed).named("lifted_out", ""),
            lifted_apart,
            stretch_per_in: (free_stretch / lifted_in).named("stretch_per_in", ""),
            out_per_in: (one + lifted_apart / lifted_in).named("out_per_in", ""),
            flank: (cosine / meshed).named("flank", ""),
            lifted_flank: ((rotated.cos() + i.friction * rotated.sin()) / meshed).named("lifted_flank", ""),
            inwards: (i.space_half_angle + i.land_half_angle).sin().named("inwards", ""),
            load_inwards: (i.friction * cosine - sine).named("load_inwards", ""),
        }
    }

    /// At least zero from tooth `tooth` on, below zero before: half a tooth away from either, so that rounding cannot matter.
    fn reaches_last(&self, tooth: usize) -> R {
        R::constant(tooth as f64 + 0.5) - self.teeth
    }
}

/// The angle that lifted teeth are rotated by; the input's word stands for the whole tooth space.
pub fn lift_angle<R: Real>(i: &Inputs<R>) -> R {
    R::select(i.lift_angle, i.lift_angle, i.space_half_angle)
}

/// Elimination from the tight side over meshing teeth. Tables stand at gap + 1, so that there is a place before the first gap.
pub struct Elimination<R> {
    /// `T(i) = after[i] T(i+1) + tight[i] T_t`; at gap 0 it is T_t itself.
    after: [R; PLACES],
    tight: [R; PLACES],
    /// 1 - after.
    short: [R; PLACES],
    /// `T(1) + .. + T(i) = meshed_own[i] T(i+1) + meshed_tight[i] T_t`.
    meshed_own: [R; PLACES],
    meshed_tight: [R; PLACES],
}

impl<R: Real> Elimination<R> {
    pub fn new(rows: &RowCoefficients<R>) -> Self {
        let [zero, one] = [0.0, 1.0].map(R::constant);
        let [mut after, mut meshed_own, mut meshed_tight] = ["after", "meshed_own", "meshed_tight"].map(|name| R::table(name, zero));
        let [mut tight, mut short] = ["tight", "short"].map(|name| R::table(name, one));
        let gaps = Loop::to(rows.teeth, TEETH).from(1).named(&["tight_before", "short_before", "own", "of_tight"]);
        R::fold(
            gaps,
            [one, one, zero, zero],
            #[inline(always)]
            |gap, [tight_before, short_before, own, of_tight]| {
                let beyond = rows.stretch + rows.land_ratio * short_before;
                let pivot = one + beyond;
                let ratio = one / pivot;
                let taken_in = R::select(R::constant(1.5) - R::number(gap), rows.tight, rows.land_ratio);
                let tight_here = taken_in * tight_before * ratio;
                let short_here = beyond / pivot;
                let with_last = own + one;
                let (own, of_tight) = (with_last * ratio, with_last * tight_here + of_tight);
                R::put(&mut after, gap.next(), ratio);
                R::put(&mut tight, gap.next(), tight_here);
                R::put(&mut short, gap.next(), short_here);
                R::put(&mut meshed_own, gap.next(), own);
                R::put(&mut meshed_tight, gap.next(), of_tight);
                [tight_here, short_here, own, of_tight]
            },
        );
        Self { after, tight, short, meshed_own, meshed_tight }
    }
}

/// A tooth of the complete mesh: the tension before it and that leaving it, its load and what presses it inwards, (8) and the free body
/// of a pitch.
pub struct Tooth<R> {
    before: Linear<R>,
    pub leaving: Linear<R>,
    /// What the tight tension makes of H, the force on the tooth.
    by_tight: R,
    pub load: Linear<R>,
    pub inward: Linear<R>,
}

impl<R: Real> Tooth<R> {
    /// The tooth at `at`, from 0, given what is known of the one behind it: the tension that leaves this one, and H there, as far as
    /// the tight tension makes it.
    #[inline(always)]
    fn new(rows: &RowCoefficients<R>, e: &Elimination<R>, at: Place, leaving: Linear<R>, behind: R) -> Self {
        let [zero, one] = [0.0, 1.0].map(R::constant);
        let slack = Linear::new(zero, one);
        let is_last = R::beyond(at.next(), rows.teeth).named("is_last", "");
        let is_beyond = R::beyond(at, rows.teeth);
        let after_first = (R::number(at) - R::constant(0.5)).named("after_first", "");
        let [after, tight] = [&e.after, &e.tight].map(|table| R::get(table, at.next()));
        let leaving = Linear::select(is_last, slack, leaving);
        let inner = Linear::new(after * leaving.tight + tight, after * leaving.slack);
        let inner = Linear::select(is_beyond, slack, Linear::select(is_last, Linear::new(tight, rows.slack * after), inner));
        let before = Linear::select(after_first, inner, Linear::new(one, zero));
        // Of the tight tension, from the slack side on: H(i) = H(i+1) + k T(i). Of the slack tension, H(i) = -T(i) (1 - e lambda(i-1)).
        let land = R::select(after_first, rows.land_ratio, one);
        let last = R::select(after_first, rows.land_ratio, rows.tight) * before.tight;
        let by_tight = R::select(is_last, last, behind + rows.stretch * leaving.tight).named("force", "");
        let short = R::select(after_first, rows.lost * after + R::get(&e.short, at.next()), one);
        let out = R::select(is_last, rows.slack, one);
        let load = Linear::new(by_tight, -(out * leaving.slack * short)).over(rows.flank).named("load_tight", "load_slack");
        let pressed = before.scaled(land).plus(leaving).scaled(rows.inwards).plus(load.scaled(rows.load_inwards));
        let inward = Linear::select(is_beyond, Linear::new(R::constant(NEVER_LIFTS), zero), pressed);
        Self { before, leaving, by_tight, load, inward }
    }
}

/// The complete mesh, at tooth - 1.
pub struct Complete<R> {
    pub tension: [Linear<R>; TEETH],
    pub load: [Linear<R>; TEETH],
    pub inward: [Linear<R>; TEETH],
}

/// Solves the complete mesh of one design.
pub fn complete(rows: &RowCoefficients<f64>, e: &Elimination<f64>) -> Complete<f64> {
    let none = Linear::new(0.0, 0.0);
    let mut complete = Complete { tension: [none; TEETH], load: [none; TEETH], inward: [none; TEETH] };
    f64::fold(Loop::to(rows.teeth, TEETH).backwards(), [0.0, 1.0, 0.0], |at, [tight, slack, behind]| {
        let tooth = Tooth::new(rows, e, at, Linear::new(tight, slack), behind);
        complete.tension[at.known()] = tooth.leaving;
        complete.load[at.known()] = tooth.load;
        complete.inward[at.known()] = tooth.inward;
        [tooth.before.tight, tooth.before.slack, tooth.by_tight]
    });
    complete
}

/// The elimination from the slack side over lifted teeth, of T(i-1) and of T_s.
#[derive(Clone, Copy)]
struct Lifted<R> {
    /// T(i) = rho T(i-1) + sigma T_s with short = 1 - rho.
    sigma: R,
    short: R,
    /// The last gap's tension T(N).
    last: Linear<R>,
    /// The sum of the tensions from T(i) on.
    sum: Linear<R>,
}

impl<R: Real> Lifted<R> {
    /// Behind the last tooth.
    fn last() -> Self {
        let [zero, one] = [0.0, 1.0].map(R::constant);
        Self { sigma: one, short: one, last: Linear::new(one, zero), sum: Linear::new(zero, zero) }
    }

    /// Before the tooth at `at`, from what is behind it.
    #[inline(always)]
    fn before(self, rows: &RowCoefficients<R>, at: Place) -> Self {
        let [zero, one] = [0.0, 1.0].map(R::constant);
        let is_last = R::beyond(at.next(), rows.teeth).named("is_last", "");
        let after_first = (R::number(at) - R::constant(0.5)).named("after_first", "");
        let short_of = rows.stretch_per_in + rows.out_per_in * self.short;
        let pivot = one + short_of;
        let rho = R::select(after_first, one, rows.tight / rows.lifted_in) / pivot;
        let sigma = rows.out_per_in * self.sigma / pivot;
        let chained = |of: Linear<R>| Linear::new(of.tight * rho, of.slack + of.tight * sigma);
        let last = chained(self.last);
        let sum = chained(Linear::new(one + self.sum.tight, self.sum.slack));
        Self {
            sigma: R::select(is_last, one, sigma),
            short: R::select(is_last, one, short_of / pivot),
            last: Linear::select(is_last, Linear::new(one, zero), last),
            sum: Linear::select(is_last, Linear::new(zero, zero), sum),
        }
    }
}

/// The incomplete mesh if the tooth at `at` is the first lifted one.
#[inline(always)]
fn boundary<R: Real>(rows: &RowCoefficients<R>, e: &Elimination<R>, at: Place, behind: &Lifted<R>) -> Boundary<R> {
    let [zero, one] = [0.0, 1.0].map(R::constant);
    let after_first = (R::number(at) - R::constant(0.5)).named("after_first", "");
    // What the elimination from the tight side says of the tooth before.
    let [tight, short, meshed_own, meshed_tight] = [&e.tight, &e.short, &e.meshed_own, &e.meshed_tight].map(|table| R::get(table, at));
    let taken_in = R::select(R::number(at) - R::constant(1.5), rows.land_ratio, rows.tight);
    // k' + (1 - e lambda) + (in - out rho); no tooth before the first hands on.
    let meshed = rows.lost + rows.land_ratio * short;
    let pivot = rows.free_stretch + meshed + rows.lifted_out * behind.short - rows.lifted_apart;
    let star = Linear::new(taken_in * tight, rows.lifted_out * behind.sigma).over(pivot);
    let star = Linear::select(after_first, star, Linear::new(one, zero)).named("t_star_tight", "t_star_slack");
    let of_star = |own: R, slack: R| Linear::new(star.tight * own, star.slack * own + slack);
    // H(N+1) = cos(phi + theta) T(N) - cos(phi - theta) T_s, H(j) as the sum from there, H(j-1), H(1).
    let force_last = of_star(rows.lifted_in * behind.last.tight, rows.lifted_in * (behind.last.slack - rows.out_per_in));
    let own_in = rows.lifted_in * behind.last.tight + rows.free_stretch * behind.sum.tight;
    let force_own = of_star(own_in, -(rows.lifted_out * behind.sigma));
    let own = force_own.over(rows.lifted_flank);
    let force_before = force_own.plus(star.scaled(rows.free_stretch));
    let meshed = Linear::new(star.tight * meshed_own + meshed_tight, star.slack * meshed_own);
    let first = Linear::select(after_first, force_before.plus(meshed.scaled(rows.stretch)).over(rows.flank), own);
    let before = Linear::select(after_first, force_before.over(rows.flank), own);
    [star, first, own, before, force_last.over(rows.lifted_flank)]
}

/// Tables of what is found for every tooth, each number as what the tight and the slack tension make of it.
pub struct ToothTables<'a, R> {
    /// What presses a tooth of the complete mesh inwards, at tooth - 1.
    pub inward: [&'a mut [R]; 2],
    /// The incomplete mesh for every boundary: at j - 1 for j = 1 ..= N + 2, the last of which is the complete mesh.
    pub boundaries: Option<[[&'a mut [R]; 2]; 5]>,
}

/// Goes from the last tooth to the first over what [`Elimination`] made of them; returns the first tooth's load in the complete mesh.
pub fn back<R: Real>(rows: &RowCoefficients<R>, e: &Elimination<R>, found: &mut ToothTables<'_, R>) -> Linear<R> {
    let [zero, one] = [0.0, 1.0].map(R::constant);
    let Lifted { sigma, short, last, sum } = Lifted::last();
    // Tension and force behind, load of this tooth, load of the last, and what is lifted behind.
    let begin = [zero, one, zero, zero, zero, zero, zero, sigma, short, last.tight, last.slack, sum.tight, sum.slack];
    let teeth = Loop::to(rows.teeth, TEETH).backwards().named(&[
        "tension_tight",
        "tension_slack",
        "behind",
        "first_load_tight",
        "first_load_slack",
        "last_load_tight",
        "last_load_slack",
        "sigma",
        "short_behind",
        "last_in_tight",
        "last_in_slack",
        "sum_tight",
        "sum_slack",
    ]);
    let end = R::fold(
        teeth,
        begin,
        #[inline(always)]
        |at, state| {
            let [tight, slack, behind, _, _, last_tight, last_slack, sigma, short, last_in_tight, last_in_slack, sum_tight, sum_slack] =
                state;
            let tooth = Tooth::new(rows, e, at, Linear::new(tight, slack), behind);
            put(&mut found.inward, at, tooth.inward);
            let is_last = R::beyond(at.next(), rows.teeth);
            let last = Linear::select(is_last, tooth.load, Linear::new(last_tight, last_slack));
            let mut lifted =
                Lifted { sigma, short, last: Linear::new(last_in_tight, last_in_slack), sum: Linear::new(sum_tight, sum_slack) };
            if let Some(boundaries) = &mut found.boundaries {
                lifted = lifted.before(rows, at);
                for (table, number) in boundaries.iter_mut().zip(boundary(rows, e, at, &lifted)) {
                    put(table, at, number);
                }
            }
            let Tooth { before, by_tight, load, .. } = tooth;
            let Lifted { sigma, short, last: last_in, sum } = lifted;
            [
                before.tight,
                before.slack,
                by_tight,
                load.tight,
                load.slack,
                last.tight,
                last.slack,
                sigma,
                short,
                last_in.tight,
                last_in.slack,
                sum.tight,
                sum.slack,
            ]
        },
    );
    let (load, last) = (Linear::new(end[3], end[4]), Linear::new(end[5], end[6]));
    if let Some(boundaries) = &mut found.boundaries {
        // Without a boundary: the complete mesh; T* has no meaning there.
        for (table, number) in boundaries.iter_mut().zip([Linear::new(zero, zero), load, load, last, last]) {
            R::put_last(table[0], rows.teeth, number.tight);
            R::put_last(table[1], rows.teeth, number.slack);
        }
    }
    load
}

fn put<R: Real>(tables: &mut [&mut [R]; 2], at: Place, number: Linear<R>) {
    R::put(tables[0], at, number.tight);
    R::put(tables[1], at, number.slack);
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
pub fn solve<R: Real>(rows: &RowCoefficients<R>, tight: R, slack: R, j: R, option: R, centrifugal: R) -> Solved<R> {
    let [zero, one] = [0.0, 1.0].map(R::constant);
    let teeth = rows.teeth.iterations(TEETH).max(2);
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
