//! What the two belts' tables share: inputs, outputs, conditions.

use super::super::description::{Condition, Input, Output, Range, Worse};
use super::LIMIT;
use crate::units;

/// Everything but the effective friction needs a belt that closes around two pulleys.
const NEEDS_GEOMETRY: &[&str] = &[
    "driver_radius_mm",
    "driven_radius_mm",
    "driver_wrap_deg",
    "driven_wrap_deg",
    "traction_limit",
    "driver_traction_limit",
    "slip_margin",
    "active_arc_deg",
    "driver_axial_coefficient",
    "driven_axial_coefficient",
    "belt_force_N",
    "tight_force_N",
    "slack_force_N",
    "driver_axial_force_N",
    "driven_axial_force_N",
    "axial_force_N",
    "tensile_stress_MPa",
    "bending_stress_MPa",
    "max_stress_MPa",
    "stress_margin",
    "optimum_thickness_mm",
    "torque_coefficient_N_per_mm",
    "torque_capacity_Nm",
    "capacity_axial_force_N",
    "printed_torque_coefficient_N_per_mm",
    "entry_compression",
];

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

/// Conditions of either belt, in the order of [`super::conditions`].
pub(in crate::models) fn condition_table() -> Vec<Condition> {
    vec![
        Condition::new("belt too short", true, NEEDS_GEOMETRY, "The belt is longer than twice the centre distance."),
        Condition::new("no geometry", true, NEEDS_GEOMETRY, "A belt of this length fits around pulleys of this ratio."),
        Condition::new("pulleys overlap", true, NEEDS_GEOMETRY, "The radii add up to less than the centre distance."),
        Condition::new(
            "friction beyond the wedge",
            true,
            &[
                "driver_axial_coefficient",
                "driven_axial_coefficient",
                "driver_axial_force_N",
                "driven_axial_force_N",
                "axial_force_N",
                "capacity_axial_force_N",
            ],
            "friction * tan(groove_angle/2) is less than 1: otherwise the wedge would need no axial force.",
        ),
        Condition::new(
            "slip",
            false,
            &[
                "active_arc_deg",
                "driver_axial_coefficient",
                "driven_axial_coefficient",
                "belt_force_N",
                "tight_force_N",
                "slack_force_N",
                "driver_axial_force_N",
                "driven_axial_force_N",
                "axial_force_N",
                "tensile_stress_MPa",
                "max_stress_MPa",
                "stress_margin",
                "torque_coefficient_N_per_mm",
                "torque_capacity_Nm",
                "capacity_axial_force_N",
                "printed_torque_coefficient_N_per_mm",
                "entry_compression",
            ],
            "The traction is at most the traction limit of the driven pulley: above it the whole belt slips.",
        ),
        Condition::new(
            "no traction",
            true,
            &[
                "tight_force_N",
                "slack_force_N",
                "driver_axial_force_N",
                "driven_axial_force_N",
                "axial_force_N",
                "tensile_stress_MPa",
                "max_stress_MPa",
                "stress_margin",
            ],
            "The traction is greater than 0, or there is no torque.",
        ),
        Condition::new("no entry compression", true, &["entry_compression"], "Without traction there is no compression to compare with.")
            .quiet(),
    ]
}

use Worse::{Higher, Lower};
use units::{DEGREE, MEGAPASCAL, MILLIMETRE, NEWTON, NEWTON_METRE, NEWTON_PER_MILLIMETRE, NONE};

/// Outputs of either belt, in the order of [`super::Result`].
pub(in crate::models) fn output_table() -> Vec<Output> {
    vec![
        Output::new("driver_radius_mm", "r_driver", MILLIMETRE, Lower, "open belt", "Pitch radius of the driver pulley."),
        Output::new("driven_radius_mm", "r_driven", MILLIMETRE, Lower, "open belt", "Pitch radius of the driven pulley."),
        Output::new("driver_wrap_deg", "theta_driver", DEGREE, Lower, "open belt", "Wrap angle on the driver pulley."),
        Output::new("driven_wrap_deg", "theta_driven", DEGREE, Lower, "open belt", "Wrap angle on the driven pulley."),
        Output::new("effective_friction", "mu_e", NONE, Lower, "mu/sin(a/2)", "Friction of the wedge against sliding along the belt.")
            .with_bound_factor(2.0),
        Output::new("traction_limit", "lambda_max", NONE, Lower, "(12), (13)", "Traction at which the belt slips on the driven pulley."),
        Output::new("driver_traction_limit", "", NONE, Lower, "(12), (13)", "Traction at which the belt would slip on the driver pulley."),
        Output::new("slip_margin", "", NONE, Lower, "1 - lambda/lambda_max", "Distance to gross slip, relative; 0 at the limit.")
            .with_bound_factor(2.0),
        Output::new("active_arc_deg", "theta_a", DEGREE, Higher, "(12)", "Angle of the driven wrap over which the belt force changes.")
            .with_bound_factor(4.5),
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
        Output::new("slack_force_N", "F2", NEWTON, Lower, "P(1-lambda)/(2 lambda)", "Belt force on the slack side.").with_bound_factor(4.5),
        Output::new("driver_axial_force_N", "S_driver", NEWTON, Higher, "(1), (6)", "Axial force that the driver needs.")
            .with_bound_factor(2.0),
        Output::new("driven_axial_force_N", "S_driven", NEWTON, Higher, "(2), (11)", "Axial force that the driven pulley needs.")
            .with_bound_factor(2.0),
        Output::new("axial_force_N", "S", NEWTON, Higher, "larger of S_driver, S_driven", "The larger of the two axial forces.")
            .with_bound_factor(2.0),
        Output::new("tensile_stress_MPa", "sigma_t", MEGAPASCAL, Higher, "(17), (22)", "Tensile stress of the tight side."),
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
            "r_driver (sigma_y - sigma_b) A 2 lambda/(1+lambda)",
            "Driver torque at which the largest stress is the strength.",
        ),
        Output::new(
            "capacity_axial_force_N",
            "S_cap",
            NEWTON,
            Higher,
            "(4), (5), (15), (16)",
            "The larger axial force at the torque capacity.",
        ),
        Output::new(
            "printed_torque_coefficient_N_per_mm",
            "C_M",
            NEWTON_PER_MILLIMETRE,
            Lower,
            "(28)",
            "The metal belt's constant as printed: too large if the entry compression is negative.",
        )
        .with_bound_factor(2.0),
        Output::new(
            "entry_compression",
            "P1/P2",
            NONE,
            Lower,
            "1 - (x-1)(e-1)",
            "Block compression at the entry that (28) implies: a negative value is not physical; 0 only at the slip limit.",
        ),
    ]
}
