//! The V-belt variator: geometry, axial forces, stress and torque capacity, shared by the rubber and the metal belt.
//!
//! Source: H. S. Kim, K. W. Kim, on ratio, torque load and axial force of rubber and metal V-belt CVTs; equation numbers
//! below are that paper's. Symbols: mu friction; a groove angle, both flanks together; R ratio `r_driven / r_driver` (the paper
//! defines none: R > 1 is underdrive); A centre distance; L belt length; `r_s` the smaller radius (the paper's r1 in (18)-(28));
//! `r0 = L / 2 pi` the radius at which the belt is free of bending; lambda the traction coefficient (F1 - F2)/(F1 + F2).
//!
//! One traction coefficient governs both belts. The metal belt's `x = T/P2` of (24) is it too: entry compression P1 = 0 gives
//! `x = (1 + lambda)/(2 lambda)`.
//!
//! The axial force follows from a traction, or the traction from an axial force of the driven pulley, which is what hydraulics or a
//! spring give: see [`clamped_slack`].
//!
//! # Repairs of the printed equations
//! - (8), (11): the denominator is printed `mu - tan(a/2)`; (6), (15), (16) and Table 2 show `mu + tan(a/2)`.
//! - (13): the exponent is `mu_e theta_a`, consistent with (12).
//! - (16): the middle line has a stray factor 2; its last line is right.
//! - Text after (4): the second symbol is F_N. The text's "(2)" for the coefficient x means (24).
//! - (28), the metal capacity constant, equals the consistent constant only at the slip limit, where `(x-1)(e-1) = 1`. With x
//!   fixed and larger friction or wrap it needs an entry compression P1 < 0, which cannot be, and overstates. Both constants
//!   are given: `torque_coefficient` and `printed_torque_coefficient`, with `entry_compression` = P1/P2.
//! - Table 1 prints 20.5 and 112.9 N/mm, while (21) and (28) with the printed radii (r0 163, r1 45 for both) give 18.503 and
//!   107.06. Rubber with its own radius at R = 2 (56.6) and r0 163 gives 20.5; metal with its own r0 (97.56) gives 112.9 at
//!   r1 = 30.58. Its index "16" disagrees with 20.5/112.9 = 18 %.
//! - Table 2's index 34 disagrees with 4720/15 780 = 30 %; its T = 2800 is not `(1 + 0.58)/(2 * 0.58) * 2000 = 2724`.
//! - Text and tables disagree on the ratio of the two belts' capacities: 5 to 6 in the abstract, 6 to 7 and 1/6 to 1/7 in the text,
//!   5.5 from Table 1.
//! - The measured x = 1.36 (lambda 0.581) and Table 2's 0.58 exceed the slip limit 0.5774 at mu = 0.08 by a hair: evaluated as
//!   designs they slip; (6) and (28) with these numbers are reproduced by [`wedge_factor`] and [`printed_torque_coefficient`].
//! - The paper's forces for the metal belt fit mu = 0.11, its slip limit fits mu = 0.08: its two data sets disagree. Measured
//!   slip of the rubber belt at lambda = 0.8 is not predicted (the model gives 0.985).
//! - The paper looks at slip on the driven pulley only. With R > 1 the driver wraps less and slips first: [`Prepared::traction_limit`]
//!   is the lesser of both pulleys' limits, and the paper's reading is `driven_traction_limit`.
//! - (1), (2), (6), (8) let radial friction support the belt fully in the idle arc: a lower bound of the axial force. Without that
//!   support the wedge factor is 1/tan(a/2): the upper bound, which hydraulics and bearings must bear.
//! - The paper's "safety factor 2" is `sigma_y = 2 sigma_t`; with `sigma_b = sigma_t` at the optimum thickness the combined
//!   stress is exactly `sigma_y`.

use super::formula::{Formula, record};
use crate::real::{ROOT_PARAMETERS, Real, RootFunction, RootStep, root_step};
use crate::tape::{Fields, Set};
use std::f64::consts::PI;

mod table;

pub(super) use table::{belt_mass, clamping_force, condition_table, driver_speed, groove_angle, output_table, ratio, torque, traction};

/// The number that stands for traction "limit": the belt is squeezed just enough not to slip.
pub const LIMIT: f64 = -1.0;

/// The number that stands for clamping force "from-traction": the traction is given, and the axial forces follow.
pub(super) const FROM_TRACTION: f64 = -1.0;

record! {
    /// Inputs of either belt, in SI units; `sections` counts the load-carrying sections: 1 rubber belt, or 2 packs of n bands.
    pub(super) Drive {
        friction, groove_angle, ratio, belt_length, centre_distance, width, thickness, sections, elastic_modulus, bending_modulus,
        strength, traction, torque, clamping_force, driver_speed, belt_mass,
    }
}

record! {
    /// What depends on friction, groove angle, ratio, belt length, centre distance, speed and mass, and on what the traction depends on:
    /// itself, or clamping force and torque.
    pub(super) Prepared {
        driver_radius, driven_radius, driver_wrap, driven_wrap, effective_friction, traction_limit, driven_traction_limit,
        driver_traction_limit, slip_margin, active_arc, driver_axial_coefficient, driven_axial_coefficient, driver_upper_coefficient,
        driven_upper_coefficient, thrust_ratio, utilisation, unsupported, traction, slack_share, clamped_sum, curvature, smaller_radius,
        free_ratio, printed_pull, entry_compression, belt_speed, centrifugal_force, length_margin, root_margin, overlap_margin,
        wedge_margin, driven_slip_margin, driver_slip_margin, clamp_margin,
    }
}

record! {
    /// Outputs of either belt; a belt's own stand behind them.
    pub(super) Result {
        driver_radius, driven_radius, driver_wrap, driven_wrap, effective_friction, traction_limit, driven_traction_limit,
        driver_traction_limit, traction_used, slip_margin, active_arc, driver_axial_coefficient, driven_axial_coefficient, belt_force,
        tight_force, slack_force, driver_axial_force, driven_axial_force, axial_force, driver_axial_force_upper,
        driven_axial_force_upper, axial_force_upper, clamping_safety, clamping_utilisation, thrust_ratio, belt_speed,
        centrifugal_force, power, tensile_stress, bending_stress, max_stress, stress_margin, optimum_thickness, torque_coefficient,
        torque_capacity, capacity_axial_force,
    }
}

const OUT: Result<usize> = Result::NUMBER;

/// How many conditions [`condition_table`] lists.
const CONDITIONS: usize = 11;

/// Axial force of one pulley per unit of belt force and wrap angle, (1) and (6): radial friction only, self-locked arc, each
/// sheave pressed by half of the belt's radial load. `sine` and `cosine` are those of half the groove angle.
pub fn wedge_factor<R: Real>(friction: R, sine: R, cosine: R) -> R {
    // (1 - mu tan)/(mu + tan), multiplied by the cosine: no division by a cosine that may vanish.
    (cosine - friction * sine) / (friction * cosine + sine)
}

/// `exp(mu_e wrap) - 1`, the tension ratio at gross slip less one; the exponent is kept where f64 can hold the result.
fn slip_pull<R: Real>(effective_friction: R, wrap: R) -> R {
    (effective_friction * wrap).min(R::constant(700.0)).exp_m1()
}

/// Largest traction coefficient without gross slip, from (12) with `theta_a` = wrap: `tanh(mu_e wrap / 2)`.
pub fn traction_limit<R: Real>(effective_friction: R, wrap: R) -> R {
    let pull = slip_pull(effective_friction, wrap).named("pull", "e - 1");
    pull / (pull + R::constant(2.0))
}

/// Thickness of the largest torque capacity, (19) and (26) with `sigma_t = sigma_y / 2`; radii and result in one length unit.
pub fn optimum_thickness<R: Real>(strength: R, elastic_modulus: R, smaller_radius: R, free_ratio: R) -> R {
    strength / elastic_modulus * smaller_radius * free_ratio
}

/// Torque capacity at the optimum thickness per product of radii, (20) and (27) with one traction coefficient:
/// `2 lambda/(1 + lambda) sigma_y^2/(2 E) r0/(r0 - r_s) width`; `width` is b for rubber and 2 n b for metal. At the slip limit
/// it is the papers' C_R (21).
pub fn torque_coefficient<R: Real>(traction: R, strength: R, elastic_modulus: R, free_ratio: R, width: R) -> R {
    traction / (R::constant(1.0) + traction) * strength.squared() / elastic_modulus * free_ratio * width
}

/// The metal belt's C_M exactly as printed, (28): `(x-1)/x (e-1) sigma_y^2/E n r0/(r0 - r_s) b`. `pull` is `(x-1)/x (e-1)`,
/// `width` is 2 n b.
pub fn printed_torque_coefficient<R: Real>(pull: R, strength: R, elastic_modulus: R, free_ratio: R, width: R) -> R {
    pull * strength.squared() / elastic_modulus * free_ratio * width / R::constant(2.0)
}

/// The largest sine of a lean that is looked at, 1 - 2^-44: pulleys that would need more overlap.
const LARGEST_SINE: f64 = 1.0 - 1.0 / (1_u64 << 44) as f64;

/// Pitch radius of the driver of an open belt: the root of `2 A cos g + pi (1 + R) r + 2 g (R - 1) r = L`, `sin g = (R - 1) r/A`.
///
/// The length is increasing and convex in r. The search starts at the root of its terms up to the second order,
/// `2 A + pi (1 + R) r + (R - 1)^2 r^2/A = L`; as those left out are above zero, this is at or above the root that is looked for, and
/// Newton's steps come down to it.
fn driver_radius<R: Real>(belt: &Drive<R>) -> R {
    let [one, two, four, pi] = [1.0, 2.0, 4.0, PI].map(R::constant);
    let Drive { ratio, belt_length, centre_distance, .. } = *belt;
    let step = (ratio - one).named("ratio_less_one", "");
    let sine_per_radius = (step / centre_distance).named("sine_per_radius", "(R - 1)/A");
    let both = (pi * (one + ratio)).named("both_half_turns", "");
    // At A/|R - 1| one pulley would begin to lie inside the other; a little less, so that the sine of the lean stays below 1. Equal pulleys
    // have no such end: any large one serves.
    let largest = (R::constant(LARGEST_SINE) * centre_distance / step.abs().max(R::constant(1e-9))).named("largest_radius", "");
    // Of a belt that is too short the start is below zero, whatever the square root.
    let chords = belt_length - two * centre_distance;
    let square = both.squared() + four * step * sine_per_radius * chords;
    let start = (two * chords / (both + square.max(R::constant(0.0)).sqrt())).named("first_radius", "");
    R::root_of::<BeltLength>((R::constant(0.0), largest), start, [sine_per_radius, both, belt_length, centre_distance])
}

/// The length that a belt has with this radius of the driver, less the belt's own.
struct BeltLength;

impl RootFunction for BeltLength {
    #[inline(always)]
    fn at<R: Real>(parameters: [R; ROOT_PARAMETERS], radius: R) -> (R, R) {
        let [one, two] = [1.0, 2.0].map(R::constant);
        let [sine_per_radius, both, belt_length, centre_distance] = parameters;
        let sine_of_lean = (sine_per_radius * radius).named("sine_of_lean", "");
        let lean = sine_of_lean.asin().named("lean", "");
        let chord = ((one - sine_of_lean) * (one + sine_of_lean)).sqrt().named("chord", "cos g");
        // (R - 1) r is A sin g.
        let straight = (two * centre_distance * (chord + lean * sine_of_lean)).named("straight", "2 A (cos g + g sin g)");
        (straight + both * radius - belt_length, both + two * centre_distance * (lean * sine_per_radius))
    }

    fn in_columns() -> Option<RootStep> {
        root_step!(BeltLength)
    }
}

/// Twice the slack side's force at which the driven pulley is pressed with `clamping_force`: the root v = F1 + F2 - P of
/// `v/4 (theta_driven - theta_a) k + P cos(a/2)/(2 mu) = clamping_force` with `theta_a = log(1 + 2 P/v)/mu_e`, (2) and (12).
///
/// `pull` is 2 P, `target` is `4 (clamping_force - P cos(a/2)/(2 mu))/k`, and `least`, above zero, the v at which the whole wrap is active.
/// The left side is increasing and convex in v and lies above its asymptote, at whose root h the bracket would end; without a torque that
/// is the root, so the bracket goes beyond it. It also begins below the root of a belt that just holds, so that boxes of designs next to
/// slip surely have one. The search starts where `v log(1 + 2 P/v)` would be `2 P (3 v + P)/(3 v + 4 P)`, at the root of
/// `v^2 + (4 P/3 - h) v = 2 P (2 target + P/mu_e)/(3 theta_driven)`: as the logarithm is less this is above the root, and Newton's steps
/// come down to it. Unlike F1 + F2, v keeps its digits where the slack side is nearly free of force.
fn clamped_slack<R: Real>(pull: R, target: R, driven_wrap: R, effective_friction: R, least: R) -> R {
    let [one, two, four] = [1.0, 2.0, 4.0].map(R::constant);
    let per_friction = (one / effective_friction).named("per_friction", "1/mu_e");
    let per_wrap = (one / driven_wrap).named("per_wrap", "1/theta_driven");
    let asymptote = ((target + pull * per_friction) * per_wrap).named("asymptote", "");
    let highest = asymptote.max(least).named("highest_slack", "");
    let two_thirds = R::constant(2.0 / 3.0);
    let half = ((asymptote - two_thirds * pull) / two).named("half", "");
    let square = half.squared() + two_thirds * pull * ((target + pull * per_friction / four) * per_wrap);
    let start = (half + square.sqrt()).max(least).named("first_slack", "");
    R::root_of::<ClampedPulley>((least / two, two * highest), start, [pull, target, driven_wrap, per_friction])
}

/// The left side of [`clamped_slack`]'s equation without the torque's part, times four over the wedge factor, less the target.
struct ClampedPulley;

impl RootFunction for ClampedPulley {
    #[inline(always)]
    fn at<R: Real>(parameters: [R; ROOT_PARAMETERS], slack: R) -> (R, R) {
        let one = R::constant(1.0);
        let [pull, target, driven_wrap, per_friction] = parameters;
        let gain = (pull / slack).named("gain", "F1/F2 - 1");
        let idle = (driven_wrap - gain.ln_1p() * per_friction).named("idle", "theta_driven - theta_a");
        (slack * idle - target, idle + gain / (one + gain) * per_friction)
    }

    fn in_columns() -> Option<RootStep> {
        root_step!(ClampedPulley)
    }
}

/// First stage for either belt.
#[inline(always)]
fn prepare<R: Real>(belt: &Drive<R>) -> Prepared<R> {
    let [one, two, four, pi] = [1.0, 2.0, 4.0, PI].map(R::constant);
    let Drive { friction, groove_angle, ratio, belt_length, centre_distance, .. } = *belt;

    let driver_radius = driver_radius(belt).named("driver_radius", "");
    let driven_radius = ratio * driver_radius;
    let lean = ((driven_radius - driver_radius) / centre_distance).min(one).max(-one).asin().named("lean", "");
    let driver_wrap = pi - two * lean;
    let driven_wrap = pi + two * lean;

    let (sine, cosine) = ((groove_angle / two).sin().named("groove_sine", ""), (groove_angle / two).cos().named("groove_cosine", ""));
    let effective_friction = friction / sine;
    let wedge = wedge_factor(friction, sine, cosine).named("wedge", "(1), (6)");
    let wedge_margin = cosine - friction * sine;

    let driven_pull = slip_pull(effective_friction, driven_wrap).named("driven_pull", "e - 1");
    let driven_traction_limit = driven_pull / (driven_pull + two);
    let driver_traction_limit = self::traction_limit(effective_friction, driver_wrap);
    let traction_limit = driven_traction_limit.min(driver_traction_limit);

    // At or above zero where the clamping force is given, and where the traction is a number or follows from one.
    let clamped = belt.clamping_force;
    let is_number = R::select(clamped, one, belt.traction);
    let given = R::select(belt.traction, belt.traction, traction_limit);
    let belt_force = (belt.torque / driver_radius).named("belt_force", "(3), (14)");
    let slip_force = (belt_force * cosine / (two * friction)).named("slip_force", "P cos(a/2)/(2 mu)");
    let to_hold = (clamped - slip_force).named("to_hold", "");
    let held = (to_hold / clamped).named("held", "");
    let (slack, idle_force) = if R::select(clamped, one, R::constant(0.0)).is_zero() {
        (one, one)
    } else {
        // Friction beyond the wedge has a status of its own.
        let idle_force = (four * to_hold / wedge.max(R::constant(1e-9))).max(R::constant(0.0));
        let idle_force = idle_force.named("idle_force", "2 F2 (theta_driven - theta_a)");
        let pull = two * belt_force;
        // Without a torque the whole wrap is never active: what is left must be above zero all the same.
        let least = (pull / driven_pull).max(R::constant(2e-30)).named("least_slack", "");
        (clamped_slack(pull, idle_force, driven_wrap, effective_friction, least).named("slack", "2 F2"), idle_force)
    };
    // Where a traction is given nothing of it may hang on the torque, so that a row of torques is prepared once.
    let clamped_sum = R::select(clamped, slack + belt_force, one);
    let traction = R::select(clamped, belt_force / clamped_sum, given);
    let slack_share = R::select(clamped, slack / clamped_sum, one - given);
    // (12): log((1 + lambda)/(1 - lambda)), exact also for small lambda; at the limit one pulley's whole wrap is active.
    let arc = ((two * traction / slack_share).ln_1p() / effective_friction).min(driven_wrap).named("arc", "(12)");
    let active_arc = R::select(is_number, arc, driven_wrap.min(driver_wrap));

    let smaller_radius = driver_radius.min(driven_radius);
    let free_radius = (belt_length / (two * pi)).named("free_radius", "r0");
    // The slack side's share times the idle arc; where the clamping force is given, by the equation that the slack side solves.
    let idle_share = R::select(clamped, idle_force / clamped_sum, slack_share * (driven_wrap - active_arc)).named("idle_share", "");
    let active_part = (traction / (two * friction) * cosine).named("active_part", "");
    // (4), (15) and (5), (16)
    let driver_axial_coefficient = (one + traction) / four * driver_wrap * wedge;
    let driven_axial_coefficient = idle_share / four * wedge + active_part;
    // Without friction along the radius the wedge factor is 1/tan(a/2).
    let unsupported = (cosine / sine).named("unsupported", "1/tan(a/2)");
    let belt_speed = driver_radius * belt.driver_speed;
    let margin = one - traction / traction_limit;
    // What is left of a number to the limit; the word stands at the limit itself, also where rounding makes that hard to tell.
    let left = |limit: R| R::select(belt.traction, limit - belt.traction, R::constant(0.0));
    Prepared {
        driver_radius,
        driven_radius,
        driver_wrap,
        driven_wrap,
        effective_friction,
        traction_limit,
        driven_traction_limit,
        driver_traction_limit,
        slip_margin: R::select(is_number, margin, R::constant(0.0)),
        active_arc,
        driver_axial_coefficient,
        driven_axial_coefficient,
        driver_upper_coefficient: (one + traction) / four * driver_wrap * unsupported,
        driven_upper_coefficient: idle_share / four * unsupported + active_part,
        thrust_ratio: driver_axial_coefficient / driven_axial_coefficient,
        unsupported,
        utilisation: R::select(clamped, slip_force / clamped, active_part / driven_axial_coefficient),
        traction,
        slack_share,
        clamped_sum,
        curvature: one / smaller_radius - one / free_radius,
        smaller_radius,
        free_ratio: free_radius / (free_radius - smaller_radius),
        // (28) with x = (1 + lambda)/(2 lambda): (x - 1)/x = (1 - lambda)/(1 + lambda)
        printed_pull: slack_share / (one + traction) * driven_pull,
        // P1/P2 = 1 - (x - 1)(e - 1), in the form that is exactly 0 at the limit: (lambda - limit)(e + 1)/(2 lambda)
        entry_compression: (traction - driven_traction_limit) * (driven_pull + two) / (two * R::select(-traction, one, traction)),
        belt_speed,
        centrifugal_force: belt.belt_mass * belt_speed.squared(),
        length_margin: belt_length - two * centre_distance,
        // The length at the largest radius, times |R - 1|, less the belt's.
        root_margin: two * pi * centre_distance * ratio.max(one) - belt_length * (ratio - one).abs(),
        overlap_margin: centre_distance - driver_radius - driven_radius,
        wedge_margin,
        // A clamping force that is just the slip force slips: the margin has to be below zero there. Any other share is a multiple of
        // 2^-53, from which this takes nothing.
        driven_slip_margin: R::select(clamped, held - R::constant(1e-37), left(driven_traction_limit)),
        driver_slip_margin: R::select(clamped, driver_traction_limit - traction, left(driver_traction_limit)),
        clamp_margin: R::select(clamped, held.min(wedge_margin), one),
    }
}

/// Margins of [`condition_table`].
#[inline(always)]
fn conditions<R: Real>(prepared: &Prepared<R>, belt: &Drive<R>, margins: &mut [R]) {
    let margins = &mut margins[..CONDITIONS];
    let one = R::constant(1.0);
    margins[0] = prepared.length_margin;
    margins[1] = prepared.root_margin;
    margins[2] = prepared.overlap_margin;
    margins[3] = prepared.wedge_margin;
    margins[4] = prepared.driven_slip_margin;
    margins[5] = prepared.driver_slip_margin;
    // Without traction only a torque of zero can be carried.
    margins[6] = R::select(-belt.torque, one, prepared.traction);
    margins[7] = prepared.clamp_margin;
    // What a slipping belt would need of a clamping force that is not given has no meaning.
    margins[8] = R::select(belt.clamping_force, R::constant(0.0), prepared.driven_slip_margin.min(prepared.driver_slip_margin));
    margins[9] = belt.torque;
    margins[10] = prepared.traction;
}

/// A belt: where its inputs stand in the common formula.
pub(super) trait Belt {
    /// Names of its inputs.
    const INPUT_NAMES: &'static [&'static str];
    /// Names of the outputs of either belt and of its own ones behind them.
    const OUTPUT_NAMES: &'static [&'static str];
    /// The drive that these inputs describe.
    fn drive<R: Real>(inputs: &[R]) -> Drive<R>;
    /// Writes the outputs that only this belt has, those in `wanted` at least; the common ones stand there already.
    fn own_outputs<R: Real>(prepared: &Prepared<R>, belt: &Drive<R>, wanted: Set, outputs: &mut [R]);
}

/// Names of the outputs of either belt, with `N - COMMON` own ones behind them.
pub(super) const fn with_own<const N: usize>(own: &[&'static str]) -> [&'static str; N] {
    let mut names = [""; N];
    let mut at = 0;
    while at < N {
        names[at] = if at < COMMON { Result::NAMES[at] } else { own[at - COMMON] };
        at += 1;
    }
    names
}

/// How many outputs either belt has.
pub(super) const COMMON: usize = Result::<usize>::NAMES.len();

/// The formula of a belt.
pub(super) struct Cvt<B>(pub B);

impl<B: Belt> Formula for Cvt<B> {
    const FIELDS: Fields = Fields::new(B::INPUT_NAMES, Prepared::<usize>::NAMES, B::OUTPUT_NAMES, CONDITIONS);

    fn prepare<R: Real>(inputs: &[R], _wanted: Set, prepared: &mut [R]) {
        prepare(&B::drive(inputs)).write(prepared);
    }
    #[inline(always)]
    fn conditions<R: Real>(prepared: &[R::Shared], inputs: &[R], _wanted: Set, margins: &mut [R]) {
        conditions(&Prepared::shared(prepared), &B::drive(inputs), margins);
    }
    #[inline(always)]
    fn finish<R: Real>(prepared: &[R::Shared], inputs: &[R], wanted: Set, outputs: &mut [R]) {
        let (prepared, belt) = (Prepared::shared(prepared), B::drive(inputs));
        finish(&prepared, &belt, wanted, outputs);
        B::own_outputs(&prepared, &belt, wanted, outputs);
    }
}

/// Outputs that are read straight from [`Prepared`].
const FROM_PREPARED: Set = Set::of(&[
    OUT.driver_radius,
    OUT.driven_radius,
    OUT.driver_wrap,
    OUT.driven_wrap,
    OUT.effective_friction,
    OUT.traction_limit,
    OUT.driven_traction_limit,
    OUT.driver_traction_limit,
    OUT.traction_used,
    OUT.slip_margin,
    OUT.active_arc,
    OUT.driver_axial_coefficient,
    OUT.driven_axial_coefficient,
    OUT.thrust_ratio,
    OUT.belt_speed,
    OUT.centrifugal_force,
]);
const FROM_TORQUE: Set = Set::of(&[
    OUT.belt_force,
    OUT.tight_force,
    OUT.slack_force,
    OUT.driver_axial_force,
    OUT.driven_axial_force,
    OUT.axial_force,
    OUT.tensile_stress,
    OUT.max_stress,
    OUT.stress_margin,
]);
const UPPER: Set = Set::of(&[OUT.driver_axial_force_upper, OUT.driven_axial_force_upper, OUT.axial_force_upper]);
const CLAMPING: Set = Set::of(&[OUT.clamping_safety, OUT.clamping_utilisation]);
const CAPACITY: Set = Set::of(&[OUT.torque_capacity, OUT.capacity_axial_force]);
const AT_OPTIMUM: Set = Set::of(&[OUT.optimum_thickness, OUT.torque_coefficient]);

/// Second stage for either belt.
#[inline(always)]
fn finish<R: Real>(p: &Prepared<R>, belt: &Drive<R>, wanted: Set, out: &mut [R]) {
    let out = &mut out[..COMMON];
    let [zero, one, two] = [0.0, 1.0, 2.0].map(R::constant);
    if wanted.meets(FROM_PREPARED) {
        out[OUT.driver_radius] = p.driver_radius;
        out[OUT.driven_radius] = p.driven_radius;
        out[OUT.driver_wrap] = p.driver_wrap;
        out[OUT.driven_wrap] = p.driven_wrap;
        out[OUT.effective_friction] = p.effective_friction;
        out[OUT.traction_limit] = p.traction_limit;
        out[OUT.driven_traction_limit] = p.driven_traction_limit;
        out[OUT.driver_traction_limit] = p.driver_traction_limit;
        out[OUT.traction_used] = p.traction;
        out[OUT.slip_margin] = p.slip_margin;
        out[OUT.active_arc] = p.active_arc;
        out[OUT.driver_axial_coefficient] = p.driver_axial_coefficient;
        out[OUT.driven_axial_coefficient] = p.driven_axial_coefficient;
        out[OUT.thrust_ratio] = p.thrust_ratio;
        out[OUT.belt_speed] = p.belt_speed;
        out[OUT.centrifugal_force] = p.centrifugal_force;
    }
    let area = belt_area(belt);
    let bending_stress = belt.bending_modulus * belt.thickness / two * p.curvature; // (18)
    out[OUT.bending_stress] = bending_stress;
    if wanted.contains(OUT.power) {
        out[OUT.power] = belt.torque * belt.driver_speed;
    }
    if wanted.meets(FROM_TORQUE) {
        let belt_force = belt.torque / p.driver_radius; // (3), (14)
        let force_sum = force_sum(p, belt);
        let tight_force = force_sum * (one + p.traction) / two;
        let driver_axial_force = p.driver_axial_coefficient * force_sum;
        let driven_axial_force = p.driven_axial_coefficient * force_sum;
        let tensile_stress = (tight_force + p.centrifugal_force) / area; // (17), (22)
        let max_stress = tensile_stress + bending_stress;
        out[OUT.belt_force] = belt_force;
        out[OUT.tight_force] = tight_force;
        out[OUT.slack_force] = force_sum * p.slack_share / two;
        out[OUT.driver_axial_force] = driver_axial_force;
        out[OUT.driven_axial_force] = driven_axial_force;
        out[OUT.axial_force] = driver_axial_force.max(driven_axial_force);
        out[OUT.tensile_stress] = tensile_stress;
        out[OUT.max_stress] = max_stress;
        out[OUT.stress_margin] = one - max_stress / belt.strength;
    }
    if wanted.meets(UPPER) {
        let force_sum = force_sum(p, belt);
        let driver_upper = p.driver_upper_coefficient * force_sum;
        let driven_upper = p.driven_upper_coefficient * force_sum;
        out[OUT.driver_axial_force_upper] = driver_upper;
        out[OUT.driven_axial_force_upper] = driven_upper;
        out[OUT.axial_force_upper] = driver_upper.max(driven_upper);
    }
    if wanted.meets(CLAMPING) {
        out[OUT.clamping_safety] = one / p.utilisation;
        out[OUT.clamping_utilisation] = R::select(-belt.torque, zero, p.utilisation);
    }
    if wanted.meets(CAPACITY) {
        // A belt that bending and its own mass alone overstrain carries nothing: capacity 0, not an error.
        let left = (belt.strength - bending_stress) * area - p.centrifugal_force;
        let tight_capacity = left.max(zero).named("tight_capacity", "");
        let per_tight = (two / (one + p.traction)).named("per_tight", "");
        let axial_per_tight = per_tight * p.driver_axial_coefficient.max(p.driven_axial_coefficient);
        out[OUT.torque_capacity] = tight_capacity * (per_tight * p.traction * p.driver_radius);
        out[OUT.capacity_axial_force] = tight_capacity * axial_per_tight;
    }
    if wanted.meets(AT_OPTIMUM) {
        let Drive { strength, bending_modulus, .. } = *belt;
        out[OUT.optimum_thickness] = optimum_thickness(strength, bending_modulus, p.smaller_radius, p.free_ratio);
        out[OUT.torque_coefficient] = torque_coefficient(p.traction, strength, bending_modulus, p.free_ratio, belt_width(belt));
    }
}

/// Width of all sections side by side.
#[inline(always)]
pub(super) fn belt_width<R: Real>(belt: &Drive<R>) -> R {
    (belt.sections * belt.width).named("width", "")
}

/// Area of all sections.
#[inline(always)]
fn belt_area<R: Real>(belt: &Drive<R>) -> R {
    (belt_width(belt) * belt.thickness).named("area", "")
}

/// F1 + F2 = P/lambda; with lambda = 0 it is 0 for P = 0 and has no meaning otherwise (condition "no traction"), unless a clamping force
/// tells it.
#[inline(always)]
pub(super) fn force_sum<R: Real>(p: &Prepared<R>, belt: &Drive<R>) -> R {
    let belt_force = belt.torque / p.driver_radius;
    let from_traction = belt_force / R::select(-p.traction, R::constant(1.0), p.traction);
    R::select(belt.clamping_force, p.clamped_sum, from_traction).named("force_sum", "F1 + F2")
}
