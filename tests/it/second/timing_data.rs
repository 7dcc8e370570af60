//! The belts of `timing-belt` as the specification gives them, and what the paper says of them in numbers and words.

use super::printed::{Golden, golden};

/// The belt and driven pulley that the paper's Fig. 9 was calibrated on. Angles in degrees.
pub const OHC_DRIVEN: &[(&str, f64)] = &[
    ("pulley_speed_rpm", 5000.0),
    ("tight_tension_N", 196.0),
    ("slack_tension_N", 0.0),
    ("teeth_in_mesh", 23.0),
    ("friction", 0.45),
    ("tooth_compliance_um_per_N", 2.55),
    ("cord_modulus_GPa", 78.4),
    ("cord_area_mm2", 21.5),
    ("tip_radius_mm", 66.32),
    ("land_half_angle_deg", 1.473),
    ("space_half_angle_deg", 2.618),
    ("tooth_length_mm", 6.10),
    ("pressure_angle_deg", 20.0),
    ("tight_span_angle_deg", 6.0),
    ("slack_span_angle_deg", 6.0),
    ("pitch_mass_g", 0.411),
    ("pitch_mm", 9.525),
    ("centrifugal_land_friction", 0.0),
    ("pitch_line_mm", 0.686),
    ("belt_width_mm", 12.7),
    ("tooth_area_mm2", 7.54),
    ("land_area_mm2", 8.23),
    ("gross_cord_area_mm2", 10.52),
    ("rubber_density_kg_per_m3", 1300.0),
    ("cord_density_kg_per_m3", 1500.0),
];
/// What differs on the driver: half the teeth, twice the speed.
pub const OHC_DRIVER: &[(&str, f64)] = &[
    ("pulley_speed_rpm", 10_000.0),
    ("teeth_in_mesh", 11.0),
    ("tip_radius_mm", 32.97),
    ("land_half_angle_deg", 2.945),
    ("space_half_angle_deg", 5.236),
];

/// All that the paper prints as a number; the rest of its results are curves lost in the scan.
pub const GOLDEN: &[(&str, Golden)] = &[
    ("timing-belt", golden("first incomplete tooth", &[], "boundary_tooth", 16.0, 0.5, "TIM Fig. 9; m calibrated on it")),
    ("timing-belt", golden("incomplete teeth", &[], "incomplete_teeth", 8.0, 0.5, "TIM Fig. 9, 16 to N+1 = 23")),
    // 20 kgf of 9.8 N on a pitch radius of 67.006 mm, worked out by hand.
    ("timing-belt", golden("torque of 20 kgf", &[], "torque_Nm", 13.133_176, 5e-7, "P = 196 N of TIM Fig. 9 at 66.32 mm + 0.686 mm")),
    // 95.8, 104.5 and 100.2 mm3 of rubber and cord.
    (
        "timing-belt",
        golden("pitch mass by (20)", &[("pitch_mass_g", -1.0)], "pitch_mass_used_g", 0.411, 5e-4, "TIM (20), the calibrated belt"),
    ),
    // 231, 256 and 145 mm3.
    ("timing-belt", golden("pitch mass of a car belt", CAR_BELT, "pitch_mass_used_g", 0.850, 5e-4, "TIM (20), 19.05 mm of section ZB")),
    (
        "timing-belt",
        golden("first lifted tooth of a car belt", CAR_BELT, "boundary_tooth", 7.0, 0.5, "worked out apart by dense elimination"),
    ),
];
/// An ordinary car belt on 44 teeth: 19.05 mm wide, section ZB, 13 cords, weighed by its own rubber and cords, which the word asks for.
pub const CAR_BELT: &[(&str, f64)] = &[
    ("pitch_mass_g", -1.0),
    ("cord_area_mm2", 6.79),
    ("tip_radius_mm", 66.02),
    ("belt_width_mm", 19.05),
    ("tooth_area_mm2", 12.13),
    ("land_area_mm2", 13.44),
    ("gross_cord_area_mm2", 15.20),
];

/// What the paper says without a number: `later` has its boundary nearer to the slack side.
pub struct Trend {
    pub what: &'static str,
    pub later: &'static [(&'static str, f64)],
    pub earlier: &'static [(&'static str, f64)],
    pub source: &'static str,
}

pub const TRENDS: &[Trend] = &[
    Trend {
        what: "tension moves the boundary to the slack side",
        later: &[("pulley_speed_rpm", 4000.0), ("tight_tension_N", 490.0)],
        earlier: &[("pulley_speed_rpm", 4000.0)],
        source: "TIM Fig. 10",
    },
    Trend {
        what: "speed moves the boundary to the tight side",
        later: &[("pulley_speed_rpm", 2000.0)],
        earlier: &[("pulley_speed_rpm", 3000.0)],
        source: "TIM Fig. 11",
    },
    Trend {
        what: "speed moves the boundary to the tight side",
        later: &[("pulley_speed_rpm", 3000.0)],
        earlier: &[("pulley_speed_rpm", 5000.0)],
        source: "TIM Fig. 11",
    },
];

/// Boundary teeth that follow from the calibration: not of the paper, which shows their order only.
pub const CALIBRATED: &[(&[(&str, f64)], f64)] = &[
    (&[], 16.0),
    (&[("pulley_speed_rpm", 4000.0)], 19.0),
    (&[("pulley_speed_rpm", 4000.0), ("tight_tension_N", 490.0)], 22.0),
    (&[("pulley_speed_rpm", 3000.0)], 21.0),
    (&[("pulley_speed_rpm", 2000.0)], 23.0),
];
