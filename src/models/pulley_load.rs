//! Loads of a V-belt on one pulley.
//!
//! Source: K.-S. Lee et al., on a design and analysis system for V-belt pulleys; equation numbers are that paper's. Symbols:
//! R_b mean radius; n speed; P power; w belt mass per length; beta groove angle; N grooves; theta_w wrap; T_t, T_s tight and
//! slack tension, totals over the grooves like w and P; T_c = w v^2.
//!
//! Friction has one total coefficient whose direction, `friction_direction_deg`, turns from around the circumference (0) to
//! along the flank (90, excluded). At 0, the default, it is the usual `mu' = mu / sin(beta/2)`; at 45 degrees, the preset `paper`, it
//! is the paper's "mu both ways", with a total sqrt(2) times the paper's mu. The friction along the flank carries part of the belt's
//! radial pull and is tied to the friction that the load needs: at 45 degrees the flanks are pressed the less the more power the belt
//! transmits, and idling is the worst load of the pulley. At 0 more power presses harder.
//!
//! The tension of the slack side is given (a weight or a spring holds it), or follows from that of the belt at rest: between fixed
//! centres the sum of both tensions stays what it was, `T_t + T_s = 2 T_0`, for a belt whose stretch is proportional to its tension.
//!
//! # Repairs of the printed equations
//! - Section 2.1 swaps the names of tight and slack tension; nomenclature and equations are right.
//! - g is in m/s^2; with w in kgf/m, `w v^2/g` is in kgf unless w is read as kg/m, which is what is done here.
//! - F is a force per length in the nomenclature but `F ds` a force in (4).
//! - (8), (13): the right side is `log(...)/theta`.
//! - Section 2.6 cites the belt's (4) for the pulley's own centrifugal load.
//! - The second friction component acts along the flank, inwards and towards the groove's mid-plane: the loads balance
//!   exactly only then (the paper's "radial" taken literally is 0.67 % off in its example).

use super::description::{Condition, Effort, Input, Output, Preset, Profile, ProfileColumn, Range, SAMPLE, Worse};
use super::evaluation::to_si;
use super::formula::{Formula, record};
use super::model::Model;
use crate::real::Real;
use crate::tape::{Fields, Set};
use crate::units::{
    self, DEGREE, KILOGRAM_PER_METRE, KILOWATT, METRE_PER_SECOND, MILLIMETRE, NEWTON, NEWTON_METRE, NEWTON_PER_MILLIMETRE, NONE,
};

record! {
    /// Inputs in the order of the table, in SI units.
    pub(super) Inputs {
        power, speed, tensioning, slack_tension, installed_tension, wrap_angle, mean_radius, groove_angle, groove_count, belt_mass,
        friction_limit, friction_direction,
    }
}

record! {
    /// What needs transcendental functions; the last three are condition margins.
    pub(super) Prepared {
        belt_speed, slack_tension, tight_tension, effective_tension, centrifugal_tension, effective_friction, friction_used, torque,
        resultant_force, slack_end_line_force, tight_end_line_force, flank_per_line, lift_margin, slackness_margin, balance_margin,
    }
}

record! {
    /// Outputs in the order of the table.
    pub(super) Result {
        belt_speed, slack_tension, tight_tension, effective_tension, centrifugal_tension, effective_friction, friction_used,
        friction_margin, torque, resultant_force, slack_end_line_force, tight_end_line_force, slack_end_flank_force,
        tight_end_flank_force,
    }
}

const OUT: Result<usize> = Result::NUMBER;

use Worse::{Higher, Lower};
use std::sync::Arc;

const PAPER: &str = "paper, Table 1";

/// The tensioning "slack": the tension of the slack side is given.
const SLACK: f64 = 1.0;
/// The tensioning "fixed-centres": the tension of the belt at rest is given.
const FIXED_CENTRES: f64 = 2.0;

/// The paper's direction of friction, in its input's unit.
pub(super) const PAPERS_FRICTION: (&str, f64) = ("friction_direction_deg", 45.0);

/// Number of conditions.
pub(super) const CONDITIONS: usize = 4;
/// The condition that friction holds the load.
pub(super) const SLIP: usize = 3;

/// What the belt does to the pulley. All of it takes for granted that the belt grips.
const ON_THE_PULLEY: [&str; 5] = [
    "resultant_force_N",
    "slack_end_line_force_N_per_mm",
    "tight_end_line_force_N_per_mm",
    "slack_end_flank_force_N_per_mm",
    "tight_end_flank_force_N_per_mm",
];

/// A handful of roundings: some value uses up all of its running error bound.
const SIMPLE: f64 = 4.5;

/// The model.
pub fn model() -> Model {
    Model {
        name: "pulley-load".into(),
        version: String::new(),
        summary: "V-belt pulley: tensions, friction and line loads over the wrap".into(),
        source: "K.-S. Lee et al.: design and analysis system for V-belt pulleys, eqs (1)-(16)".into(),
        limits: "The belt load is the steady one: no shock, no vibration, no heat. Friction acts in one direction all over the wrap. \
             Between fixed centres the belt stretches in proportion to its tension, and the centres do not give. What the load does to \
             the pulley is not part of this model."
            .into(),
        inputs: vec![
            Input {
                valid: Range::NOT_NEGATIVE,
                ..Input::new("power_kW", "P", KILOWATT, 3.0, (0.1, 50.0), "Power that the belt transmits.", PAPER)
            },
            Input::new("speed_rpm", "n", units::RPM, 3000.0, (100.0, 10_000.0), "Speed of the pulley.", PAPER),
            Input::enumeration(
                "tensioning",
                "",
                &[("slack", SLACK), ("fixed-centres", FIXED_CENTRES)],
                SLACK,
                "What stays as it is while the load varies: the slack side's tension (\"slack\": a weight or a spring pulls there) or the \
                 distance of the axes (\"fixed-centres\").",
                "paper: the slack side's",
            ),
            Input::new("slack_tension_N", "T_s", NEWTON, 700.0, (50.0, 3000.0), "Tension of the slack side, all grooves together.", PAPER)
                .read_only_for("tensioning", &["slack"]),
            Input::new(
                "installed_tension_N",
                "T_0",
                NEWTON,
                800.0,
                (50.0, 3000.0),
                "Tension of the belt at rest, all grooves together.",
                "chosen: about the mean of both sides",
            )
            .read_only_for("tensioning", &["fixed-centres"]),
            Input {
                valid: Range { high: 360.0, includes_high: true, ..Range::POSITIVE },
                ..Input::new(
                    "wrap_angle_deg",
                    "theta_w",
                    DEGREE,
                    88.0,
                    (30.0, 240.0),
                    "Angle over which the belt touches the pulley.",
                    PAPER,
                )
            },
            Input::new("mean_radius_mm", "R_b", MILLIMETRE, 60.0, (20.0, 300.0), "Radius at which the belt pulls.", "chosen; not printed"),
            Input {
                valid: Range::between(0.0, 180.0),
                ..Input::new(
                    "groove_angle_deg",
                    "beta",
                    DEGREE,
                    36.0,
                    (32.0, 40.0),
                    "Angle between the two flanks of a groove.",
                    "SAE J636",
                )
            },
            Input {
                integer: true,
                ..Input::new("groove_count", "N", NONE, 1.0, (1.0, 12.0), "Number of grooves that share the load.", "chosen")
            },
            Input::new(
                "belt_mass_kg_per_m",
                "w",
                KILOGRAM_PER_METRE,
                0.11,
                (0.03, 1.0),
                "Mass of all belts per length.",
                "13 mm belt, 1300 kg/m3",
            ),
            Input::new(
                "friction_limit",
                "mu_max",
                NONE,
                0.3,
                (0.25, 0.5),
                "Total friction that is available.",
                "dry rubber on steel, customary",
            ),
            Input {
                valid: Range::from_until(0.0, 90.0),
                ..Input::new(
                    "friction_direction_deg",
                    "gamma",
                    DEGREE,
                    0.0,
                    (0.0, 45.0),
                    "Direction of friction, from around the circumference (0) to along the flank (90); the paper's is 45.",
                    "customary for V-belts",
                )
            },
        ],
        outputs: vec![
            Output::new("belt_speed_m_per_s", "v", METRE_PER_SECOND, Higher, "(2)", "Speed of the belt.").with_bound_factor(SIMPLE),
            Output::new(
                "slack_tension_used_N",
                "T_su",
                NEWTON,
                Lower,
                "given, or T_0 - P/(2 v)",
                "Tension of the slack side, given or following from the installed one.",
            )
            .with_bound_factor(SIMPLE),
            Output::new("tight_tension_N", "T_t", NEWTON, Higher, "(2), (15)", "Tension of the tight side.").with_bound_factor(SIMPLE),
            Output::new("effective_tension_N", "T_e", NEWTON, Higher, "T_t - T_s", "Tension that transmits the power.")
                .with_bound_factor(SIMPLE),
            Output::new(
                "centrifugal_tension_N",
                "T_c",
                NEWTON,
                Higher,
                "w v^2",
                "Tension that makes the moving belt follow its curve and does not press on the pulley.",
            )
            .with_bound_factor(SIMPLE),
            Output::new("effective_friction", "mu'", NONE, Higher, "(13)", "Friction in the wedge that the load needs.")
                .with_bound_factor(SIMPLE),
            Output::new("friction_used", "mu", NONE, Higher, "(12)", "Total coefficient of friction that the load needs.")
                .with_bound_factor(SIMPLE),
            Output::new(
                "friction_margin",
                "",
                NONE,
                Lower,
                "1 - friction_used/friction_limit",
                "Distance to the available friction, relative.",
            )
            .with_bound_factor(SIMPLE),
            Output::new("torque_Nm", "", NEWTON_METRE, Higher, "(T_t - T_s) R_b", "Torque on the pulley.").with_bound_factor(SIMPLE),
            Output::new("resultant_force_N", "", NEWTON, Higher, "vectors T_t - T_c, T_s - T_c", "Force of the belt on the shaft.")
                .with_bound_factor(SIMPLE),
            Output::new(
                "slack_end_line_force_N_per_mm",
                "Q(0)",
                NEWTON_PER_MILLIMETRE,
                Higher,
                "(9)",
                "Radial load per length at the slack end.",
            )
            .with_bound_factor(SIMPLE),
            Output::new(
                "tight_end_line_force_N_per_mm",
                "Q(theta_w)",
                NEWTON_PER_MILLIMETRE,
                Higher,
                "(9)",
                "Radial load per length at the tight end.",
            )
            .with_bound_factor(SIMPLE),
            Output::new(
                "slack_end_flank_force_N_per_mm",
                "R(0)",
                NEWTON_PER_MILLIMETRE,
                Higher,
                "(10)",
                "Normal force per flank and length at the slack end.",
            )
            .with_bound_factor(SIMPLE),
            Output::new(
                "tight_end_flank_force_N_per_mm",
                "R(theta_w)",
                NEWTON_PER_MILLIMETRE,
                Higher,
                "(10)",
                "Normal force per flank and length at the tight end.",
            )
            .with_bound_factor(SIMPLE),
        ],
        conditions: conditions(&[], &[]),
        presets: vec![Preset::new("paper", &[PAPERS_FRICTION])],
        pulley: None,
        origin: None,
        starter: include_str!("../../studies/pulley-load.toml").into(),
        kernel: Arc::new(PulleyLoad),
        profile: Some(Arc::new(profile)),
        notes: None,
        remarks: None,
        doubts: None,
        effort: Effort { prepare: 2e-7, finish: 2e-9 },
        sample: SAMPLE,
        on_gpu: true,
    }
}

/// The conditions of the belt. `more`: further outputs that take a balanced load for granted; `gripping`: such that take grip for granted.
pub(super) fn conditions(more: &[&str], gripping: &[&str]) -> Vec<Condition> {
    let friction = ["friction_used", "friction_margin"];
    let all = [&["effective_friction"], &friction[..], &ON_THE_PULLEY, more].concat();
    vec![
        Condition::new("belt lifts", true, &all, "The slack tension exceeds the centrifugal tension; otherwise the belt lifts off."),
        Condition::new(
            "slack belt",
            true,
            &all,
            "The installed tension leaves the slack side more than the centrifugal tension: T_0 - P/(2 v) > w v^2; otherwise the belt hangs \
             loose there.",
        ),
        Condition::new(
            "no friction balances the load",
            true,
            &[&friction[..], &ON_THE_PULLEY[3..], more].concat(),
            "Friction in this direction can carry the load: cos(gamma) > mu' sin(gamma) cos(beta/2).",
        ),
        Condition::new(
            "slip",
            false,
            &[&ON_THE_PULLEY, gripping].concat(),
            "The friction that the load needs is at most friction_limit; otherwise the belt slips, and what it does to the pulley is not \
             known.",
        ),
    ]
}

pub(super) struct PulleyLoad;

impl Formula for PulleyLoad {
    const FIELDS: Fields = Fields::new(Inputs::<usize>::NAMES, Prepared::<usize>::NAMES, Result::<usize>::NAMES, CONDITIONS);

    fn prepare<R: Real>(inputs: &[R], _wanted: Set, prepared: &mut [R]) {
        let [one, two] = [1.0, 2.0].map(R::constant);
        let i = Inputs::read(inputs);
        let belt_speed = i.mean_radius * i.speed;
        let effective_tension = i.power / belt_speed;
        let centrifugal_tension = i.belt_mass * belt_speed.squared();
        let either = |slack: R, fixed: R| R::select(i.tensioning - R::constant(SLACK.midpoint(FIXED_CENTRES)), fixed, slack);
        let half = (effective_tension / two).named("half", "");
        let slack_tension = either(i.slack_tension, i.installed_tension - half);
        let tight_tension = either(i.slack_tension + effective_tension, i.installed_tension + half);
        // What presses the belt on the pulley at either end of the wrap.
        let slack_pressing = (slack_tension - centrifugal_tension).named("slack_pressing", "");
        let tight_pressing = (tight_tension - centrifugal_tension).named("tight_pressing", "");
        // (13): log((T_t - T_c)/(T_s - T_c)), exact also for a small load.
        let effective_friction = (effective_tension / slack_pressing).ln_1p() / i.wrap_angle;

        let (sine, cosine) = ((i.groove_angle / two).sin().named("groove_sine", ""), (i.groove_angle / two).cos());
        let along = i.friction_direction.cos().named("along", "");
        let across = (i.friction_direction.sin() * cosine).named("across", "");
        let balance_margin = along - effective_friction * across;
        let friction_used = effective_friction * sine / balance_margin;
        let both = slack_pressing.squared() + tight_pressing.squared();
        // The two strands pull at an angle of pi - theta_w to each other. The square cannot be negative but for rounding.
        let resultant = (both - two * slack_pressing * tight_pressing * i.wrap_angle.cos()).max(R::constant(0.0));
        Prepared {
            belt_speed,
            slack_tension,
            tight_tension,
            effective_tension,
            centrifugal_tension,
            effective_friction,
            friction_used,
            torque: effective_tension * i.mean_radius,
            resultant_force: resultant.sqrt(),
            slack_end_line_force: slack_pressing / i.mean_radius,
            tight_end_line_force: tight_pressing / i.mean_radius,
            flank_per_line: one / (two * (sine + friction_used * across)), // (10), for one groove
            lift_margin: either(slack_pressing, one),
            slackness_margin: either(one, slack_pressing),
            balance_margin,
        }
        .write(prepared);
    }

    #[inline(always)]
    fn conditions<R: Real>(prepared: &[R::Shared], inputs: &[R], _wanted: Set, margins: &mut [R]) {
        let p = Prepared::<R>::shared(prepared);
        margins[0] = p.lift_margin;
        margins[1] = p.slackness_margin;
        margins[2] = p.balance_margin;
        margins[SLIP] = p.friction_margin(Inputs::read(inputs).friction_limit);
    }

    #[inline(always)]
    fn finish<R: Real>(prepared: &[R::Shared], inputs: &[R], wanted: Set, out: &mut [R]) {
        let out = &mut out[..Result::<usize>::NAMES.len()];
        let p = Prepared::<R>::shared(prepared);
        let i = Inputs::read(inputs);
        const MARGIN: Set = Set::of(&[OUT.friction_margin]);
        const FLANK: Set = Set::of(&[OUT.slack_end_flank_force, OUT.tight_end_flank_force]);
        if wanted.meets(MARGIN) {
            out[OUT.friction_margin] = p.friction_margin(i.friction_limit);
        }
        if wanted.meets(FLANK) {
            let flank_per_line = p.flank_per_line / i.groove_count;
            out[OUT.slack_end_flank_force] = p.slack_end_line_force * flank_per_line;
            out[OUT.tight_end_flank_force] = p.tight_end_line_force * flank_per_line;
        }
        out[OUT.belt_speed] = p.belt_speed;
        out[OUT.slack_tension] = p.slack_tension;
        out[OUT.tight_tension] = p.tight_tension;
        out[OUT.effective_tension] = p.effective_tension;
        out[OUT.centrifugal_tension] = p.centrifugal_tension;
        out[OUT.effective_friction] = p.effective_friction;
        out[OUT.friction_used] = p.friction_used;
        out[OUT.torque] = p.torque;
        out[OUT.resultant_force] = p.resultant_force;
        out[OUT.slack_end_line_force] = p.slack_end_line_force;
        out[OUT.tight_end_line_force] = p.tight_end_line_force;
    }
}

impl<R: Real> Prepared<R> {
    /// 1 - mu/mu_max.
    #[inline(always)]
    fn friction_margin(&self, limit: R) -> R {
        R::constant(1.0) - self.friction_used / limit
    }
}

/// What a pulley's finite elements need of the belt's load, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WrapLoad<R> {
    /// Margins of the conditions.
    pub margins: [R; CONDITIONS],
    /// mu' of (13).
    pub effective_friction: R,
    /// Total coefficient of friction that the load needs.
    pub friction_used: R,
    /// R(0) of (10): normal force per flank and length at the slack end.
    pub flank_force: R,
    /// Torque on the pulley.
    pub torque: R,
}

/// The belt's load, for inputs that begin with those of this model.
pub(super) fn wrap_load<R: Real<Shared = R>>(si: &[R]) -> WrapLoad<R> {
    let mut prepared = [R::constant(0.0); Prepared::<usize>::NAMES.len()];
    PulleyLoad::prepare(si, Set::ALL, &mut prepared);
    let p = Prepared::<R>::shared(&prepared);
    let mut margins = [R::constant(0.0); CONDITIONS];
    PulleyLoad::conditions(&prepared, si, Set::ALL, &mut margins);
    WrapLoad {
        margins,
        effective_friction: p.effective_friction,
        friction_used: p.friction_used,
        flank_force: p.slack_end_line_force * p.flank_per_line / Inputs::read(si).groove_count,
        torque: p.torque,
    }
}

/// All outputs of this model, for inputs and outputs that begin with its own.
pub(super) fn finish_all<R: Real<Shared = R>>(si: &[R], outputs: &mut [R]) {
    let mut prepared = [R::constant(0.0); Prepared::<usize>::NAMES.len()];
    PulleyLoad::prepare(si, Set::ALL, &mut prepared);
    PulleyLoad::finish(&prepared, si, Set::ALL, outputs);
}

/// Tension, line force and flank force over the wrap, (14), (9), (10): from the slack end (0) to the tight end, a row a degree
/// or a little closer. `inputs` are in their units and must have status ok.
fn profile(model: &Model, inputs: &[f64]) -> Profile {
    let si = to_si(model, inputs);
    let i = Inputs::read(&si);
    let p = Prepared::<f64>::shared(&model.kernel.prepared(&si));
    let steps = inputs[Inputs::NUMBER.wrap_angle].ceil();
    let count = steps as u32;
    let rows = (0..=count).map(|step| {
        let part = f64::from(step) / steps;
        let pressing = libm::exp(p.effective_friction * i.wrap_angle * part) * (p.slack_tension - p.centrifugal_tension);
        let line_force = pressing / i.mean_radius;
        vec![
            inputs[Inputs::NUMBER.wrap_angle] * part,
            pressing + p.centrifugal_tension,
            NEWTON_PER_MILLIMETRE.from_si(line_force),
            NEWTON_PER_MILLIMETRE.from_si(line_force * p.flank_per_line / i.groove_count),
        ]
    });
    Profile {
        columns: vec![
            ProfileColumn::new("wrap_position_deg", DEGREE),
            ProfileColumn::new("tension_N", NEWTON),
            ProfileColumn::new("line_force_N_per_mm", NEWTON_PER_MILLIMETRE),
            ProfileColumn::new("flank_force_N_per_mm", NEWTON_PER_MILLIMETRE),
        ],
        rows: rows.collect(),
    }
}
