//! What the two belts' tables share: inputs, outputs, conditions.

use super::super::description::{Condition, Input, Output, Range, Worse};
use super::{FROM_TRACTION, LIMIT};
use crate::units;

/// What neither geometry nor traction decides.
const ALWAYS: &[&str] = &["effective_friction"];

/// What only the speed or the geometry decides, whatever the belt is squeezed with.
const WITHOUT_TRACTION: &[&str] = &[
    "driver_radius_mm",
    "driven_radius_mm",
    "driver_wrap_deg",
    "driven_wrap_deg",
    "traction_limit",
    "driven_traction_limit",
    "driver_traction_limit",
    "belt_speed_m_per_s",
    "centrifugal_force_N",
    "bending_stress_MPa",
    "optimum_thickness_mm",
];

/// What the belt's grip on the pulleys is about: told of a belt that slips, too.
const OF_GRIP: &[&str] = &["traction_used", "slip_margin", "clamping_safety", "clamping_utilisation"];

/// Axial forces with support by radial friction, and what is made of them.
const AXIAL: &[&str] = &[
    "driver_axial_coefficient",
    "driven_axial_coefficient",
    "driver_axial_force_N",
    "driven_axial_force_N",
    "axial_force_N",
    "thrust_ratio",
    "clamping_safety",
    "clamping_utilisation",
    "capacity_axial_force_N",
];

/// Forces and what is made of them, for a traction of zero.
const FORCES: &[&str] = &[
    "clamping_safety",
    "clamping_utilisation",
    "tight_force_N",
    "slack_force_N",
    "driver_axial_force_N",
    "driven_axial_force_N",
    "axial_force_N",
    "driver_axial_force_upper_N",
    "driven_axial_force_upper_N",
    "axial_force_upper_N",
    "tensile_stress_MPa",
    "max_stress_MPa",
    "stress_margin",
    "flank_pressure_MPa",
];

/// The outputs of a belt's list but for those in `others`.
fn all_but(outputs: &[Output], others: &[&[&str]]) -> Vec<String> {
    let kept = |name: &str| others.iter().all(|names| !names.contains(&name));
    outputs.iter().map(|output| output.name.clone()).filter(|name| kept(name)).collect()
}

/// Groove angle of either belt.
pub(in crate::models) fn groove_angle(default: f64, usual: (f64, f64), source: &str) -> Input {
    let doc = "Angle between the two flanks of a pulley.";
    Input { valid: Range::between(0.0, 180.0), ..Input::new("groove_angle_deg", "a", DEGREE, default, usual, doc, source) }
}

/// Ratio of either belt.
pub(in crate::models) fn ratio(usual: (f64, f64), source: &str) -> Input {
    Input::new("ratio", "R", NONE, 1.0, usual, "Driven radius over driver radius; above 1 the driver runs on its small radius.", source)
}

/// Traction of either belt; `default` may be [`LIMIT`].
pub(in crate::models) fn traction(default: f64, source: &str) -> Input {
    let doc = "Difference of the belt forces over their sum, (F1 - F2)/(F1 + F2), for which the axial force is set; \"limit\": the traction limit of the design.";
    Input {
        valid: Range::from_until(0.0, 1.0),
        ..Input::new("traction", "lambda", NONE, default, (0.05, 0.95), doc, source).with_words(&[("limit", LIMIT)])
    }
}

/// Torque of either belt.
pub(in crate::models) fn torque(default: f64, usual: (f64, f64)) -> Input {
    let doc = "Torque on the driver pulley.";
    Input { valid: Range::NOT_NEGATIVE, ..Input::new("torque_Nm", "T_L", NEWTON_METRE, default, usual, doc, "chosen") }
}

/// Axial force that the driven pulley is pressed with.
pub(in crate::models) fn clamping_force(usual: (f64, f64)) -> Input {
    let doc = "Axial force of the driven pulley, as hydraulics or a spring give it: the traction follows, so it is in place of a \
               traction; \"from-traction\": the traction is given, and the axial forces follow.";
    Input::new("clamping_force_N", "S_c", NEWTON, FROM_TRACTION, usual, doc, "chosen: as the paper")
        .with_words(&[("from-traction", FROM_TRACTION)])
        .instead_of("traction")
}

/// Speed of the driver, of either belt.
pub(in crate::models) fn driver_speed() -> Input {
    let doc = "Speed of the driver; with the belt's mass it gives the centrifugal force.";
    let source = "chosen: standing, as the paper neglects it";
    Input { valid: Range::NOT_NEGATIVE, ..Input::new("driver_speed_rpm", "omega", RPM, 0.0, (0.0, 9000.0), doc, source) }
}

/// Mass of either belt.
pub(in crate::models) fn belt_mass(usual: (f64, f64)) -> Input {
    let doc = "Mass of the belt per length, everything that goes round with it.";
    let source = "chosen: none, as the paper neglects it";
    Input { valid: Range::NOT_NEGATIVE, ..Input::new("belt_mass_kg_per_m", "m", KILOGRAM_PER_METRE, 0.0, usual, doc, source) }
}

/// Conditions of either belt with these outputs, in the order of [`super::conditions`].
pub(in crate::models) fn condition_table(outputs: &[Output]) -> Vec<Condition> {
    let condition = |reason: &str, strict: bool, gone: &[String], doc: &str| {
        Condition::new(reason, strict, &gone.iter().map(String::as_str).collect::<Vec<_>>(), doc)
    };
    let listed = |name: &&str| outputs.iter().any(|output| output.name == **name);
    let of = |names: &[&str]| names.iter().filter(|name| listed(name)).map(|&name| name.to_owned()).collect::<Vec<_>>();
    // The power is torque times speed, whatever the belt does.
    let geometry = all_but(outputs, &[ALWAYS, &["power_kW"]]);
    let slip = all_but(outputs, &[ALWAYS, WITHOUT_TRACTION, OF_GRIP, &["power_kW"]]);
    let unclamped = all_but(outputs, &[ALWAYS, WITHOUT_TRACTION, &["power_kW", "belt_force_N", "clamping_safety", "clamping_utilisation"]]);
    vec![
        condition("belt too short", true, &geometry, "The belt is longer than twice the centre distance."),
        condition("no geometry", true, &geometry, "A belt of this length fits around pulleys of this ratio."),
        condition("pulleys overlap", true, &geometry, "The radii add up to less than the centre distance."),
        condition(
            "friction beyond the wedge",
            true,
            &of(AXIAL),
            "friction * tan(groove_angle/2) is less than 1: otherwise the wedge would need no axial force.",
        ),
        condition(
            "slip on the driven pulley",
            false,
            &slip,
            "The traction is at most the limit of the driven pulley, or the clamping force is greater than P cos(a/2)/(2 mu): else the belt slips there.",
        ),
        condition(
            "slip on the driver",
            false,
            &slip,
            "The traction is at most the limit of the driver, which is the lower of the two where the ratio is above 1: else the belt slips there.",
        ),
        condition("no traction", true, &of(FORCES), "The traction is greater than 0, or there is no torque."),
        condition("no traction settles", true, &unclamped, "The clamping force holds the belt by some traction.").quiet(),
        condition(
            "slip by the traction",
            false,
            &of(&["clamping_safety", "clamping_utilisation"]),
            "The traction given is at most the limit: beyond it there is no clamping force to compare with.",
        )
        .quiet(),
        condition("no torque", true, &of(&["clamping_safety"]), "Without a torque any clamping force is safe.").quiet(),
        condition("no entry compression", true, &of(&["entry_compression"]), "Without traction there is no compression to compare with.")
            .quiet(),
    ]
}

use Worse::{Higher, Lower};
use units::{
    DEGREE, KILOGRAM_PER_METRE, KILOWATT, MEGAPASCAL, METRE_PER_SECOND, MILLIMETRE, NEWTON, NEWTON_METRE, NEWTON_PER_MILLIMETRE, NONE, RPM,
};

/// Outputs of either belt, in the order of [`super::Result`].
pub(in crate::models) fn output_table() -> Vec<Output> {
    vec![
        Output::new("driver_radius_mm", "r_driver", MILLIMETRE, Lower, "open belt", "Pitch radius of the driver pulley."),
        Output::new("driven_radius_mm", "r_driven", MILLIMETRE, Lower, "open belt", "Pitch radius of the driven pulley."),
        Output::new("driver_wrap_deg", "theta_driver", DEGREE, Lower, "open belt", "Wrap angle on the driver pulley."),
        Output::new("driven_wrap_deg", "theta_driven", DEGREE, Lower, "open belt", "Wrap angle on the driven pulley."),
        Output::new("effective_friction", "mu_e", NONE, Lower, "mu/sin(a/2)", "Friction of the wedge against sliding along the belt.")
            .with_bound_factor(2.0),
        Output::new(
            "traction_limit",
            "lambda_max",
            NONE,
            Lower,
            "lesser of the two",
            "Traction at which the belt slips on one of the pulleys.",
        ),
        Output::new(
            "driven_traction_limit",
            "",
            NONE,
            Lower,
            "(12), (13)",
            "Traction at which it slips on the driven pulley: the paper's limit.",
        ),
        Output::new("driver_traction_limit", "", NONE, Lower, "(12), (13)", "Traction at which it slips on the driver."),
        Output::new(
            "traction_used",
            "lambda_used",
            NONE,
            Higher,
            "(F1 - F2)/(F1 + F2)",
            "Traction that the drive runs at: the one given, the limit, or what the clamping force leaves.",
        )
        .with_bound_factor(4.5),
        Output::new(
            "slip_margin",
            "",
            NONE,
            Lower,
            "1 - lambda/lambda_max",
            "Distance to gross slip on the pulley that slips first, relative; 0 at the limit.",
        )
        .with_bound_factor(2.0),
        Output::new("active_arc_deg", "theta_a", DEGREE, Higher, "(12)", "Angle of the driven wrap over which the belt force changes.")
            .with_bound_factor(3.0),
        Output::new(
            "driver_axial_coefficient",
            "S~_driver",
            NONE,
            Higher,
            "(4), (15)",
            "Axial force of the driver over the sum of the belt forces.",
        )
        .with_bound_factor(2.0),
        Output::new(
            "driven_axial_coefficient",
            "S~_driven",
            NONE,
            Higher,
            "(5), (16)",
            "Axial force of the driven pulley over the sum of the belt forces.",
        )
        .with_bound_factor(2.0),
        Output::new("belt_force_N", "P", NEWTON, Higher, "(3), (14)", "Force that the belt transmits, F1 - F2."),
        Output::new("tight_force_N", "F1", NEWTON, Higher, "P(1+lambda)/(2 lambda)", "Belt force on the tight side."),
        Output::new("slack_force_N", "F2", NEWTON, Lower, "P(1-lambda)/(2 lambda)", "Belt force on the slack side.").with_bound_factor(3.5),
        Output::new("driver_axial_force_N", "S_driver", NEWTON, Higher, "(1), (6)", "Axial force that the driver needs.")
            .with_bound_factor(2.0),
        Output::new("driven_axial_force_N", "S_driven", NEWTON, Higher, "(2), (11)", "Axial force that the driven pulley needs.")
            .with_bound_factor(2.0),
        Output::new("axial_force_N", "S", NEWTON, Higher, "larger of S_driver, S_driven", "The larger of the two axial forces.")
            .with_bound_factor(2.0),
        Output::new(
            "driver_axial_force_upper_N",
            "",
            NEWTON,
            Higher,
            "F1/2 theta_driver/tan(a/2)",
            "Axial force of the driver if friction along the radius supports the belt nowhere: the upper bound.",
        )
        .with_bound_factor(2.0),
        Output::new(
            "driven_axial_force_upper_N",
            "",
            NEWTON,
            Higher,
            "F2/2 (theta_driven - theta_a)/tan(a/2) + P cos(a/2)/(2 mu)",
            "Axial force of the driven pulley without that support: the upper bound.",
        )
        .with_bound_factor(2.0),
        Output::new(
            "axial_force_upper_N",
            "",
            NEWTON,
            Higher,
            "larger of the two",
            "The larger of the two upper bounds: what hydraulics and bearings must bear.",
        )
        .with_bound_factor(2.0),
        Output::new(
            "clamping_safety",
            "",
            NONE,
            Lower,
            "S_driven 2 mu/(P cos(a/2))",
            "Axial force of the driven pulley over the force at which the belt slips there; practice asks for about 1.3.",
        )
        .with_bound_factor(2.0),
        Output::new("clamping_utilisation", "", NONE, Higher, "1/safety", "Its reciprocal, 0 without a torque: the one to constrain.")
            .with_bound_factor(2.0),
        Output::new("thrust_ratio", "", NONE, Higher, "S_driver/S_driven", "Axial force of the driver over that of the driven pulley.")
            .with_bound_factor(2.0),
        Output::new("belt_speed_m_per_s", "v", METRE_PER_SECOND, Higher, "r_driver omega", "Speed of the belt."),
        Output::new(
            "centrifugal_force_N",
            "",
            NEWTON,
            Higher,
            "m v^2",
            "Tension that only bends the moving belt around; F1 and F2 are what presses on the pulleys.",
        ),
        Output::new("power_kW", "", KILOWATT, Lower, "T_L omega", "Power that the drive transmits.").with_bound_factor(4.5),
        Output::new("tensile_stress_MPa", "sigma_t", MEGAPASCAL, Higher, "(17), (22): (F1 + m v^2)/A", "Tensile stress of the tight side."),
        Output::new("bending_stress_MPa", "sigma_b", MEGAPASCAL, Higher, "(18)", "Bending stress on the smaller pulley."),
        Output::new("max_stress_MPa", "sigma_max", MEGAPASCAL, Higher, "sigma_t + sigma_b", "Largest stress in the belt."),
        Output::new("stress_margin", "", NONE, Lower, "1 - sigma_max/sigma_y", "Distance to the strength, relative.")
            .with_bound_factor(2.0),
        Output::new(
            "optimum_thickness_mm",
            "h*",
            MILLIMETRE,
            Lower,
            "(19), (26)",
            "Thickness with the largest torque capacity; there bending takes half of the strength (the paper's safety factor 2).",
        ),
        Output::new(
            "torque_coefficient_N_per_mm",
            "C",
            NEWTON_PER_MILLIMETRE,
            Lower,
            "(20), (21), (27)",
            "Torque capacity at the optimum thickness over the product of the smaller and the driver radius.",
        ),
        Output::new(
            "torque_capacity_Nm",
            "T_cap",
            NEWTON_METRE,
            Lower,
            "r_driver ((sigma_y - sigma_b) A - m v^2) 2 lambda/(1+lambda)",
            "Driver torque at which the largest stress is the strength, at the traction used.",
        ),
        Output::new(
            "capacity_axial_force_N",
            "S_cap",
            NEWTON,
            Higher,
            "(4), (5), (15), (16)",
            "The larger axial force at the torque capacity.",
        ),
    ]
}
