//! A flat belt over two pulleys of different diameter, by Eytelwein with centrifugal tension.
//!
//! Source: R. G. Budynas, J. K. Nisbett, Shigley's Mechanical Engineering Design, section 17-2; equation numbers below are that book's.
//! The belt is tightened until its tight side bears what is given per width: what the maker allows, corrected for pulley and speed, or
//! less. Slack and initial tension, and the friction that the drive needs, follow.
//!
//! The slip margin compares pulls, `1 - P/P_max`, not coefficients of friction: both are zero at slip, and pulls need no logarithm.

use super::description::{Condition, Effort, Input, Output, Range, Worse};
use super::formula::{Formula, record};
use super::model::Model;
use crate::real::Real;
use crate::tape::{Fields, Set};
use crate::units::{
    DEGREE, KILOGRAM_PER_CUBIC_METRE, KILOWATT, MEGAPASCAL, METRE_PER_SECOND, MILLIMETRE, NEWTON, NEWTON_METRE, NEWTON_PER_MILLIMETRE,
    NONE, RPM,
};
use Worse::{Higher, Lower};
use std::f64::consts::PI;

record! {
    /// Inputs in the order of the table, in SI units.
    Inputs {
        power, driver_speed, driver_diameter, driven_diameter, centre_distance, belt_width, belt_thickness, belt_density, friction,
        tension_per_width,
    }
}

record! {
    /// What depends on the pulleys and on friction only.
    Prepared { driver_wrap, driven_wrap, least_wrap, wrap_cosine, belt_length, grip, overlap_margin }
}

record! {
    /// Outputs in the order of the table.
    Result {
        driver_wrap, driven_wrap, belt_length, belt_speed, torque, effective_tension, centrifugal_tension, tight_tension, slack_tension,
        initial_tension, friction_used, slip_margin, power_capacity, shaft_load, belt_stress,
    }
}

const OUT: Result<usize> = Result::NUMBER;

struct FlatBelt;

impl Formula for FlatBelt {
    const FIELDS: Fields = Fields::new(Inputs::NAMES, Prepared::NAMES, Result::NAMES, 2);

    fn prepare<R: Real>(inputs: &[R], _wanted: Set, prepared: &mut [R]) {
        let [one, two, pi] = [1.0, 2.0, PI].map(R::constant);
        let i = Inputs::read(inputs);
        let [driver_radius, driven_radius] = [i.driver_diameter / two, i.driven_diameter / two];
        let sine = ((driven_radius - driver_radius) / i.centre_distance).min(one).max(-one).named("sine_of_lean", "");
        let lean = sine.asin().named("lean", "");
        let [driver_wrap, driven_wrap] = [pi - two * lean, pi + two * lean]; // (17-1)
        let least_wrap = driver_wrap.min(driven_wrap);
        let free = two * i.centre_distance * ((one - sine) * (one + sine)).sqrt();
        Prepared {
            driver_wrap,
            driven_wrap,
            least_wrap,
            wrap_cosine: least_wrap.cos(),
            belt_length: free + driver_wrap * driver_radius + driven_wrap * driven_radius, // (17-2)
            grip: -(-(i.friction * least_wrap)).exp_m1(),
            overlap_margin: i.centre_distance - driver_radius - driven_radius,
        }
        .write(prepared);
    }

    #[inline(always)]
    fn conditions<R: Real>(prepared: &[R::Shared], inputs: &[R], _wanted: Set, margins: &mut [R]) {
        margins[0] = Prepared::<R>::shared(prepared).overlap_margin;
        margins[1] = Tensions::new(&Inputs::read(inputs)).slack_pressing;
    }

    #[inline(always)]
    fn finish<R: Real>(prepared: &[R::Shared], inputs: &[R], wanted: Set, out: &mut [R]) {
        let out = &mut out[..Result::NAMES.len()];
        let [one, two] = [1.0, 2.0].map(R::constant);
        let (i, p) = (Inputs::read(inputs), Prepared::<R>::shared(prepared));
        let Tensions { belt_speed, effective, centrifugal, tight, slack, tight_pressing, slack_pressing } = Tensions::new(&i);
        let capacity = (tight_pressing * p.grip).named("capacity", "F1 - F2 at slip, (17-7)");
        out[OUT.driver_wrap] = p.driver_wrap;
        out[OUT.driven_wrap] = p.driven_wrap;
        out[OUT.belt_length] = p.belt_length;
        out[OUT.belt_speed] = belt_speed;
        out[OUT.torque] = i.power / i.driver_speed;
        out[OUT.effective_tension] = effective;
        out[OUT.centrifugal_tension] = centrifugal;
        out[OUT.tight_tension] = tight;
        out[OUT.slack_tension] = slack;
        out[OUT.initial_tension] = (tight_pressing + slack_pressing) / two; // (17-8)
        out[OUT.slip_margin] = one - effective / capacity;
        out[OUT.power_capacity] = capacity.max(R::constant(0.0)) * belt_speed;
        out[OUT.belt_stress] = i.tension_per_width / i.belt_thickness;
        if wanted.contains(OUT.friction_used) {
            out[OUT.friction_used] = (effective / slack_pressing).ln_1p() / p.least_wrap; // (17-7)
        }
        if wanted.contains(OUT.shaft_load) {
            // The strands pull at an angle of pi less the wrap to each other. The square cannot be negative but for rounding.
            let both = tight_pressing.squared() + slack_pressing.squared();
            out[OUT.shaft_load] = (both - two * tight_pressing * slack_pressing * p.wrap_cosine).max(R::constant(0.0)).sqrt();
        }
    }
}

/// Tensions of the belt; pressing is what is left of one over the centrifugal tension.
struct Tensions<R> {
    belt_speed: R,
    effective: R,
    centrifugal: R,
    tight: R,
    slack: R,
    tight_pressing: R,
    slack_pressing: R,
}

impl<R: Real> Tensions<R> {
    #[inline(always)]
    fn new(i: &Inputs<R>) -> Self {
        let belt_speed = (i.driver_diameter / R::constant(2.0) * i.driver_speed).named("belt_speed", "");
        let mass = (i.belt_density * i.belt_width * i.belt_thickness).named("mass_per_length", "");
        let centrifugal = (mass * belt_speed.squared()).named("centrifugal", "(e)");
        let effective = (i.power / belt_speed).named("effective", "(h)");
        let tight = (i.tension_per_width * i.belt_width).named("tight", "(17-12)");
        let slack = tight - effective;
        let tight_pressing = (tight - centrifugal).named("tight_pressing", "");
        let slack_pressing = (slack - centrifugal).named("slack_pressing", "");
        Self { belt_speed, effective, centrifugal, tight, slack, tight_pressing, slack_pressing }
    }
}

const BOOK: &str = "Shigley, example 17-1, rounded";

/// Few roundings add up in these values: some come close to the running error bound itself.
const SIMPLE: f64 = 4.5;

/// The model.
pub fn model() -> Model {
    Model::new("flat-belt", FlatBelt)
        .summary("Flat belt over two pulleys: tensions, slip, shaft load and belt stress")
        .source("R. G. Budynas, J. K. Nisbett: Shigley's Mechanical Engineering Design, section 17-2, eqs (17-1) to (17-12)")
        .limits(
            "Steady running of an open belt: no shock, no creep, no bending of the belt over the pulleys. Corrections for pulley \
             diameter and speed belong in the tension per width, a service factor in the power.",
        )
        .inputs([
            Input::new("power_kW", "H", KILOWATT, 15.0, (0.5, 30.0), "Transmitted power, with service and design factor.", BOOK)
                .valid(Range::NOT_NEGATIVE),
            Input::new("driver_speed_rpm", "n", RPM, 1750.0, (500.0, 3000.0), "Speed of the driver.", BOOK),
            Input::new("driver_diameter_mm", "d", MILLIMETRE, 150.0, (80.0, 400.0), "Diameter of the driver.", BOOK),
            Input::new("driven_diameter_mm", "D", MILLIMETRE, 450.0, (80.0, 1000.0), "Diameter of the driven pulley.", BOOK),
            Input::new("centre_distance_mm", "C", MILLIMETRE, 2400.0, (500.0, 4000.0), "Distance of the pulley axes.", BOOK),
            Input::new("belt_width_mm", "b", MILLIMETRE, 150.0, (50.0, 400.0), "Width of the belt.", BOOK),
            Input::new("belt_thickness_mm", "t", MILLIMETRE, 3.3, (1.0, 6.0), "Thickness of the belt.", BOOK),
            Input::new("belt_density_kg_per_m3", "gamma", KILOGRAM_PER_CUBIC_METRE, 1160.0, (900.0, 1300.0), "Density of the belt.", BOOK),
            Input::new("friction", "f", NONE, 0.8, (0.2, 0.9), "Coefficient of friction between belt and pulleys.", BOOK),
            Input::new(
                "tension_per_width_N_per_mm",
                "F_a C_p C_v",
                NEWTON_PER_MILLIMETRE,
                12.0,
                (3.0, 40.0),
                "Tension of the tight side per width: at most what the maker allows, corrected for pulley and speed.",
                BOOK,
            ),
        ])
        .outputs(
            [
                Output::new("driver_wrap_deg", "theta_d", DEGREE, Lower, "(17-1)", "Angle of wrap of the driver."),
                Output::new("driven_wrap_deg", "theta_D", DEGREE, Lower, "(17-1)", "Angle of wrap of the driven pulley."),
                Output::new("belt_length_mm", "L", MILLIMETRE, Higher, "(17-2)", "Length of the belt."),
                Output::new("belt_speed_m_per_s", "V", METRE_PER_SECOND, Higher, "pi d n", "Speed of the belt."),
                Output::new("torque_Nm", "T", NEWTON_METRE, Higher, "H / n", "Torque of the driver."),
                Output::new("effective_tension_N", "F1 - F2", NEWTON, Higher, "(h)", "Pull of the belt."),
                Output::new("centrifugal_tension_N", "F_c", NEWTON, Higher, "(e)", "Tension that only bends the moving belt around."),
                Output::new("tight_tension_N", "F1", NEWTON, Higher, "(17-12)", "Tension of the tight side."),
                Output::new("slack_tension_N", "F2", NEWTON, Lower, "F1 less the pull", "Tension of the slack side."),
                Output::new("initial_tension_N", "F_i", NEWTON, Higher, "(17-8)", "Tension at rest that gives these."),
                Output::new("friction_used", "f'", NONE, Higher, "(17-7)", "Coefficient of friction that the load needs."),
                Output::new(
                    "slip_margin",
                    "",
                    NONE,
                    Lower,
                    "(17-7)",
                    "What is left of the largest pull before the belt slips, a fraction of it.",
                ),
                Output::new("power_capacity_kW", "", KILOWATT, Lower, "(17-7)", "Power at which the belt slips."),
                Output::new("shaft_load_N", "", NEWTON, Higher, "resultant", "Force of the belt on either shaft while it runs."),
                Output::new("belt_stress_MPa", "", MEGAPASCAL, Higher, "F1 / (b t)", "Tensile stress of the tight side."),
            ]
            .map(|output| output.with_bound_factor(SIMPLE)),
        )
        .conditions([
            Condition::new(
                "pulleys overlap",
                true,
                &[
                    "driver_wrap_deg",
                    "driven_wrap_deg",
                    "belt_length_mm",
                    "friction_used",
                    "slip_margin",
                    "power_capacity_kW",
                    "shaft_load_N",
                ],
                "The pulleys lie beside each other.",
            ),
            Condition::new(
                "slack side lifts",
                true,
                &["friction_used", "slip_margin", "shaft_load_N"],
                "The tension of the slack side exceeds the centrifugal tension: otherwise no friction carries the load.",
            ),
        ])
        .starter(include_str!("../../studies/flat-belt.toml"))
        .effort(Effort { prepare: 2e-7, finish: 3e-9 })
}
