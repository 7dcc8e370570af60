//! The numbers that papers and books print, or that others worked out, for the inputs that they belong to.

use std::f64::consts::PI;

/// A number printed in the papers or worked out by hand from them.
pub struct Golden {
    pub what: &'static str,
    /// Only the inputs that differ from the model's defaults.
    pub inputs: &'static [(&'static str, f64)],
    pub output: &'static str,
    pub expected: f64,
    /// Half a unit of the last printed digit.
    pub tolerance: f64,
    pub source: &'static str,
}

pub(super) const fn golden(
    what: &'static str,
    inputs: &'static [(&'static str, f64)],
    output: &'static str,
    expected: f64,
    tolerance: f64,
    source: &'static str,
) -> Golden {
    Golden { what, inputs, output, expected, tolerance, source }
}

/// The paper's "mu both ways".
const PAPERS_FRICTION: &[(&str, f64)] = &[("friction_direction_deg", 45.0)];
/// A belt installed with 570 N between fixed centres, 2 kW at 900 rpm.
const IDLE_BETWEEN_FIXED_CENTRES: &[(&str, f64)] =
    &[("tensioning", 2.0), ("installed_tension_N", 570.0), ("power_kW", 2.0), ("speed_rpm", 900.0)];

/// The same with the paper's friction, of which so much is needed that 0.25 would not do.
const IDLE_WITH_THE_PAPERS_FRICTION: &[(&str, f64)] = &[
    ("tensioning", 2.0),
    ("installed_tension_N", 570.0),
    ("power_kW", 2.0),
    ("speed_rpm", 900.0),
    ("friction_direction_deg", 45.0),
    ("friction_limit", 0.4),
];

const UNDERDRIVE: &[(&str, f64)] = &[("ratio", 2.0)];
const CLAMPED_30_KN: &[(&str, f64)] = &[("ratio", 0.5), ("friction", 0.065), ("torque_Nm", 150.0), ("clamping_force_N", 30_000.0)];
const CLAMPED_25_KN: &[(&str, f64)] =
    &[("ratio", 2.0), ("clamping_force_N", 25_000.0), ("driver_speed_rpm", 3000.0), ("belt_mass_kg_per_m", 1.1)];
const SOFT_AT_4000_RPM: &[(&str, f64)] = &[("bending_modulus_MPa", 60.0), ("driver_speed_rpm", 4000.0), ("belt_mass_kg_per_m", 0.6)];
const CLAMPED_2_KN: &[(&str, f64)] = &[("ratio", 2.0), ("clamping_force_N", 2000.0)];
/// CVT Table 2: effective tension 2000 N on the 86.899 mm pulleys of the default belt at R = 1.
const TABLE_2_RUBBER: &[(&str, f64)] = &[("torque_Nm", 173.797_198_6)];
/// CVT Table 2 prints T = 2800 N at a traction of 0.58, which slips at the friction of its own
/// force column; 0.577 does not, and the driver's axial force depends on T alone.
const TABLE_2_METAL: &[(&str, f64)] = &[("traction", 0.577), ("torque_Nm", 98.156_434_42)];
/// CVT Table 1 gives r0 and r1 and 180 degrees of wrap: at R = 1, L = 2 pi r0 and
/// A = (L - 2 pi r1)/2. The traction is lambda_max, rounded down so that the belt does not slip.
const TABLE_1_RUBBER: &[(&str, f64)] =
    &[("belt_length_mm", 1_024.159_205_070), ("centre_distance_mm", 370.707_933_124), ("traction", 0.984_54)];
const TABLE_1_RUBBER_LARGER_RADIUS: &[(&str, f64)] =
    &[("belt_length_mm", 1_024.159_205_070), ("centre_distance_mm", 334.265_458_342), ("traction", 0.984_54)];
/// Here the belt's own r0 and its smaller radius at R = 2, at R = 1 again: at R = 2 the driver would slip with this traction.
const TABLE_1_RUBBER_OWN_RADII: &[(&str, f64)] = &[("centre_distance_mm", 355.126_354_87), ("traction", 0.984_54)];
const EQUATION_26: &[(&str, f64)] = &[("belt_length_mm", 613.238_885_981), ("centre_distance_mm", 165.247_773_579)];

/// Shigley, example 17-1, in the model's units: 15 hp with service factor 1.25 and design factor 1.1, 1750 rpm, pulleys of 6 and 18 in
/// 96 in apart, belt 6 by 0.13 in of 0.042 lbf/in^3, friction 0.8, 100 lbf/in times 0.70. Not here: the torque, 742.8 lbf in, of which
/// the book prints 742 and goes on with that, so that its slack tension of 172.6 lbf is 0.2 more than 172.40.
const EXAMPLE_17_1: &[(&str, f64)] = &[
    ("power_kW", 15.380_059_851_384_32),
    ("driver_speed_rpm", 1750.0),
    ("driver_diameter_mm", 152.4),
    ("driven_diameter_mm", 457.2),
    ("centre_distance_mm", 2438.4),
    ("belt_width_mm", 152.4),
    ("belt_thickness_mm", 3.302),
    ("belt_density_kg_per_m3", 1_162.555_997_828_531),
    ("friction", 0.8),
    ("tension_per_width_N_per_mm", 12.258_878_467_253_35),
];
const RADIAN_IN_DEGREES: f64 = 180.0 / PI;
const POUND_IN_NEWTONS: f64 = 4.448_221_615_260_5;
const FOOT_PER_MINUTE: f64 = 0.3048 / 60.0;

/// Not here, because no input produces them: C_M = 107.06, 112.9 and 114.1 of CVT (28) take
/// x = 1.36, a traction of 0.581 that slips at the 180 degrees of wrap they are computed with.
#[rustfmt::skip]
pub const GOLDEN: &[(&str, Golden)] = &[
    ("rubber-cvt", golden("driver radius at R = 2", UNDERDRIVE, "driver_radius_mm", 56.619, 5e-4, "CVT geometry, L 1066, A 260")),
    ("rubber-cvt", golden("driven radius at R = 2", UNDERDRIVE, "driven_radius_mm", 113.238, 5e-4, "CVT geometry, L 1066, A 260")),
    ("rubber-cvt", golden("driver wrap at R = 2", UNDERDRIVE, "driver_wrap_deg", 154.84, 5e-3, "CVT geometry, L 1066, A 260")),
    ("rubber-cvt", golden("driven wrap at R = 2", UNDERDRIVE, "driven_wrap_deg", 205.16, 5e-3, "CVT geometry, L 1066, A 260")),
    ("metal-cvt", golden("driver radius at R = 2", UNDERDRIVE, "driver_radius_mm", 31.270, 5e-4, "CVT geometry, L 613, A 156")),
    ("metal-cvt", golden("driven radius at R = 2", UNDERDRIVE, "driven_radius_mm", 62.540, 5e-4, "CVT geometry, L 613, A 156")),
    ("rubber-cvt", golden("slip limit, mu 0.4", &[], "traction_limit", 0.985, 5e-4, "CVT (12), R = 1")),
    ("metal-cvt", golden("slip limit, mu 0.08", &[], "traction_limit", 0.577, 5e-4, "CVT (12), R = 1; measured 0.58")),
    ("metal-cvt", golden("slip limit, mu 0.08", &[], "traction_limit", 0.5774, 5e-5, "CVT (12), R = 1; Table 2 gives 0.58")),
    ("metal-cvt", golden("slip limit, mu 0.1", &[("friction", 0.1)], "traction_limit", 0.677, 5e-4, "CVT (12), R = 1, Fig. 7")),
    ("metal-cvt", golden("slip limit, mu 0.11", &[("friction", 0.11)], "traction_limit", 0.719, 5e-4, "CVT (12), R = 1, Fig. 9")),
    ("rubber-cvt", golden("belt force", TABLE_2_RUBBER, "belt_force_N", 2000.0, 0.5, "CVT Table 2")),
    ("rubber-cvt", golden("tight side force", TABLE_2_RUBBER, "tight_force_N", 2250.0, 0.5, "CVT Table 2")),
    ("rubber-cvt", golden("driver axial force, printed", TABLE_2_RUBBER, "driver_axial_force_N", 4720.0, 5.0, "CVT Table 2")),
    ("rubber-cvt", golden("driver axial force, computed", TABLE_2_RUBBER, "driver_axial_force_N", 4724.0, 0.5, "CVT (6) with the data of Table 2")),
    ("metal-cvt", golden("band tension", TABLE_2_METAL, "tight_force_N", 2800.0, 0.5, "CVT Table 2")),
    ("metal-cvt", golden("driver axial force", TABLE_2_METAL, "driver_axial_force_N", 15_780.0, 5.0, "CVT Table 2 and (6)")),
    ("rubber-cvt", golden("C_R with the printed radii", TABLE_1_RUBBER, "torque_coefficient_N_per_mm", 18.503, 5e-4, "CVT (21) with the data of Table 1, r0 163, r1 45")),
    ("rubber-cvt", golden("C_R as printed", TABLE_1_RUBBER_LARGER_RADIUS, "torque_coefficient_N_per_mm", 20.5, 0.05, "CVT Table 1, with r0 163, r1 56.6")),
    ("rubber-cvt", golden("C_R with the belt's own radii", TABLE_1_RUBBER_OWN_RADII, "torque_coefficient_N_per_mm", 20.1, 0.05, "CVT (21), r0 169.7, r1 56.6")),
    ("metal-cvt", golden("optimum band thickness", EQUATION_26, "optimum_thickness_mm", 0.199, 5e-4, "CVT (26), sigma_t 250, r0 97.6, r1 45")),
    ("metal-cvt", golden("the driver slips first", UNDERDRIVE, "traction_used", 0.518_268_532_6, 5.1e-11, "audit of the models by another derivation, ten digits")),
    ("metal-cvt", golden("the driver slips first", UNDERDRIVE, "tight_force_N", 4_684.236_534, 5.1e-7, "audit of the models by another derivation, ten digits")),
    ("metal-cvt", golden("the driver slips first", UNDERDRIVE, "driver_axial_force_N", 23_007.902_4, 5.1e-5, "audit of the models by another derivation, ten digits")),
    ("metal-cvt", golden("the driver slips first", UNDERDRIVE, "driven_axial_force_N", 21_772.496_14, 5.1e-6, "audit of the models by another derivation, ten digits")),
    ("metal-cvt", golden("the driver slips first", UNDERDRIVE, "driver_axial_force_upper_N", 32_990.144_9, 5.1e-5, "audit of the models by another derivation, ten digits")),
    ("metal-cvt", golden("the driver slips first", UNDERDRIVE, "driven_axial_force_upper_N", 22_706.329_28, 5.1e-6, "audit of the models by another derivation, ten digits")),
    ("metal-cvt", golden("the driver slips first", UNDERDRIVE, "clamping_safety", 1.109_702_504, 5.1e-10, "audit of the models by another derivation, ten digits")),
    ("metal-cvt", golden("the driver slips first", UNDERDRIVE, "thrust_ratio", 1.056_741_6, 5.1e-8, "audit of the models by another derivation, ten digits")),
    ("metal-cvt", golden("the driver slips first", UNDERDRIVE, "torque_capacity_Nm", 33.564_259_8, 5.1e-8, "audit of the models by another derivation, ten digits")),
    ("metal-cvt", golden("clamped with 30 kN", CLAMPED_30_KN, "traction_used", 0.216_987_644_7, 5.1e-11, "audit of the models by another derivation, ten digits")),
    ("metal-cvt", golden("clamped with 30 kN", CLAMPED_30_KN, "tight_force_N", 6_726.009_767, 5.1e-7, "audit of the models by another derivation, ten digits")),
    ("metal-cvt", golden("clamped with 30 kN", CLAMPED_30_KN, "slack_force_N", 4_327.528_527, 5.1e-7, "audit of the models by another derivation, ten digits")),
    ("metal-cvt", golden("clamped with 30 kN", CLAMPED_30_KN, "driver_axial_force_N", 45_384.937_9, 5.1e-5, "audit of the models by another derivation, ten digits")),
    ("metal-cvt", golden("clamped with 30 kN", CLAMPED_30_KN, "clamping_safety", 1.656_462_867, 5.1e-10, "audit of the models by another derivation, ten digits")),
    ("metal-cvt", golden("clamped with 30 kN", CLAMPED_30_KN, "slip_margin", 0.501_459_360_7, 5.1e-11, "audit of the models by another derivation, ten digits")),
    ("metal-cvt", golden("clamped with 25 kN at 3000 rpm", CLAMPED_25_KN, "traction_used", 0.424_508_811_2, 5.1e-11, "audit of the models by another derivation, ten digits")),
    ("metal-cvt", golden("clamped with 25 kN at 3000 rpm", CLAMPED_25_KN, "centrifugal_force_N", 106.155_452_4, 5.1e-8, "audit of the models by another derivation, ten digits")),
    ("metal-cvt", golden("clamped with 25 kN at 3000 rpm", CLAMPED_25_KN, "tensile_stress_MPa", 151.994_993_1, 5.1e-8, "audit of the models by another derivation, ten digits")),
    ("metal-cvt", golden("clamped with 25 kN at 3000 rpm", CLAMPED_25_KN, "power_kW", 31.415_926_54, 5.1e-9, "audit of the models by another derivation, ten digits")),
    ("metal-cvt", golden("clamped with 25 kN at 3000 rpm", CLAMPED_25_KN, "slip_margin", 0.180_909_539_1, 5.1e-11, "audit of the models by another derivation, ten digits")),
    ("rubber-cvt", golden("soft in bending, 4000 rpm", SOFT_AT_4000_RPM, "bending_stress_MPa", 1.684_048_595, 5.1e-10, "audit of the models by another derivation, ten digits")),
    ("rubber-cvt", golden("soft in bending, 4000 rpm", SOFT_AT_4000_RPM, "tensile_stress_MPa", 2.884_564_357, 5.1e-10, "audit of the models by another derivation, ten digits")),
    ("rubber-cvt", golden("soft in bending, 4000 rpm", SOFT_AT_4000_RPM, "flank_pressure_MPa", 1.389_999_135, 5.1e-10, "audit of the models by another derivation, ten digits")),
    ("rubber-cvt", golden("soft in bending, 4000 rpm", SOFT_AT_4000_RPM, "torque_capacity_Nm", 568.741_651_6, 5.1e-8, "audit of the models by another derivation, ten digits")),
    ("rubber-cvt", golden("clamped with 2 kN", CLAMPED_2_KN, "traction_used", 0.478_733_484_5, 5.1e-11, "audit of the models by another derivation, ten digits")),
    ("rubber-cvt", golden("clamped with 2 kN", CLAMPED_2_KN, "driver_axial_force_N", 2_463.416_652, 5.1e-7, "audit of the models by another derivation, ten digits")),
    ("rubber-cvt", golden("clamped with 2 kN", CLAMPED_2_KN, "clamping_safety", 1.875_719_669, 5.1e-10, "audit of the models by another derivation, ten digits")),
    ("rubber-cvt", golden("clamped with 2 kN", CLAMPED_2_KN, "flank_pressure_MPa", 4.495_005_197, 5.1e-10, "audit of the models by another derivation, ten digits")),
    ("pulley-load", golden("belt speed", &[], "belt_speed_m_per_s", 18.850, 5e-4, "PUL (2), Table 1; R_b, beta, w chosen")),
    ("pulley-load", golden("tight tension", &[], "tight_tension_N", 859.155, 5e-4, "PUL (2), (15), Table 1; R_b, beta, w chosen")),
    ("pulley-load", golden("effective tension", &[], "effective_tension_N", 159.155, 5e-4, "PUL (2), T_t - T_s, Table 1; R_b, beta, w chosen")),
    ("pulley-load", golden("centrifugal tension", &[], "centrifugal_tension_N", 39.084, 5e-4, "PUL, w v^2, Table 1; R_b, beta, w chosen")),
    ("pulley-load", golden("effective friction", &[], "effective_friction", 0.140_481, 5e-7, "PUL (13), Table 1; R_b, beta, w chosen")),
    ("pulley-load", golden("total friction", PAPERS_FRICTION, "friction_used", 0.070_860, 5e-7, "PUL (12), sqrt(2) times the paper's 0.050106")),
    ("pulley-load", golden("flank force at the slack end", PAPERS_FRICTION, "slack_end_flank_force_N_per_mm", 15.4418, 5e-5, "PUL (10), Table 1; R_b, beta, w chosen")),
    ("pulley-load", golden("resultant", &[], "resultant_force_N", 1035.131, 5e-4, "PUL (9)-(16), Table 1; R_b, beta, w chosen")),
    ("pulley-load", golden("torque", &[], "torque_Nm", 9.549_30, 5e-6, "PUL (2), Table 1; R_b, beta, w chosen")),
    // Worked out by hand: half of 2 kW/(5.65487 m/s) is 176.839 N; mu = sin 18 deg ln(743.321/389.644)/1.535890 = 0.129953.
    ("pulley-load", golden("slack tension between fixed centres", IDLE_BETWEEN_FIXED_CENTRES, "slack_tension_used_N", 393.161, 5e-4, "T_0 - P/(2 v)")),
    ("pulley-load", golden("tight tension between fixed centres", IDLE_BETWEEN_FIXED_CENTRES, "tight_tension_N", 746.839, 5e-4, "T_0 + P/(2 v)")),
    ("pulley-load", golden("friction of idling between fixed centres", IDLE_BETWEEN_FIXED_CENTRES, "friction_used", 0.129_953, 5e-7, "mu' sin(beta/2)")),
    ("pulley-load", golden("the paper's friction of that", IDLE_WITH_THE_PAPERS_FRICTION, "friction_used", 0.306, 5e-4, "an audit's own computation")),
    ("flat-belt", golden("wrap 3.0165 rad", EXAMPLE_17_1, "driver_wrap_deg", 3.0165 * RADIAN_IN_DEGREES, 5e-5 * RADIAN_IN_DEGREES, "Shigley, example 17-1")),
    ("flat-belt", golden("speed 2749 ft/min", EXAMPLE_17_1, "belt_speed_m_per_s", 2749.0 * FOOT_PER_MINUTE, 0.5 * FOOT_PER_MINUTE, "Shigley, example 17-1")),
    ("flat-belt", golden("F_c 25.6 lbf", EXAMPLE_17_1, "centrifugal_tension_N", 25.6 * POUND_IN_NEWTONS, 0.05 * POUND_IN_NEWTONS, "Shigley, example 17-1")),
    ("flat-belt", golden("(F1)a 420 lbf", EXAMPLE_17_1, "tight_tension_N", 420.0 * POUND_IN_NEWTONS, 0.5 * POUND_IN_NEWTONS, "Shigley, example 17-1")),
    ("flat-belt", golden("F_i 270.6 lbf", EXAMPLE_17_1, "initial_tension_N", 270.6 * POUND_IN_NEWTONS, 0.05 * POUND_IN_NEWTONS, "Shigley, example 17-1")),
    ("flat-belt", golden("f' 0.328", EXAMPLE_17_1, "friction_used", 0.328, 5e-4, "Shigley, example 17-1")),
];
