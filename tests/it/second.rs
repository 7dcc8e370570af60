//! A second implementation of the models (`timing-belt` in a file of its own), written from the
//! specification alone, in N, mm, MPa and not by the methods that it suggests: bisection instead of
//! Newton, quadrature of the belt-element balance instead of closed forms. Both agreeing to 1e-9
//! therefore says something about the equations, not only about rounding.

pub mod timing_belt;

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};

pub type Values = BTreeMap<&'static str, f64>;

/// A second implementation: from inputs in their units to the status and the outputs that have a meaning.
pub type Second = fn(&BTreeMap<String, f64>) -> (&'static str, Values);

/// The second implementation of every model that is a formula.
pub const SECOND: &[(&str, Second)] = &[
    ("rubber-cvt", rubber_cvt),
    ("metal-cvt", metal_cvt),
    ("pulley-load", pulley_load),
    ("timing-belt", timing_belt::timing_belt),
    ("flat-belt", flat_belt),
];

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

const fn golden(
    what: &'static str,
    inputs: &'static [(&'static str, f64)],
    output: &'static str,
    expected: f64,
    tolerance: f64,
    source: &'static str,
) -> Golden {
    Golden { what, inputs, output, expected, tolerance, source }
}

const UNDERDRIVE: &[(&str, f64)] = &[("ratio", 2.0)];
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
/// Here the belt's own r0 and radius at R = 2, with the force ratio of 180 degrees.
const TABLE_1_RUBBER_OWN_RADII: &[(&str, f64)] = &[("ratio", 2.0), ("traction", 0.984_54)];
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
    ("pulley-load", golden("belt speed", &[], "belt_speed_m_per_s", 18.850, 5e-4, "PUL (2), Table 1; R_b, beta, w chosen")),
    ("pulley-load", golden("tight tension", &[], "tight_tension_N", 859.155, 5e-4, "PUL (2), (15), Table 1; R_b, beta, w chosen")),
    ("pulley-load", golden("effective tension", &[], "effective_tension_N", 159.155, 5e-4, "PUL (2), T_t - T_s, Table 1; R_b, beta, w chosen")),
    ("pulley-load", golden("centrifugal tension", &[], "centrifugal_tension_N", 39.084, 5e-4, "PUL, w v^2, Table 1; R_b, beta, w chosen")),
    ("pulley-load", golden("effective friction", &[], "effective_friction", 0.140_481, 5e-7, "PUL (13), Table 1; R_b, beta, w chosen")),
    ("pulley-load", golden("total friction", &[], "friction_used", 0.070_860, 5e-7, "PUL (12), sqrt(2) times the paper's 0.050106")),
    ("pulley-load", golden("flank force at the slack end", &[], "slack_end_flank_force_N_per_mm", 15.4418, 5e-5, "PUL (10), Table 1; R_b, beta, w chosen")),
    ("pulley-load", golden("resultant", &[], "resultant_force_N", 1035.131, 5e-4, "PUL (9)-(16), Table 1; R_b, beta, w chosen")),
    ("pulley-load", golden("torque", &[], "torque_Nm", 9.549_30, 5e-6, "PUL (2), Table 1; R_b, beta, w chosen")),
    ("flat-belt", golden("wrap 3.0165 rad", EXAMPLE_17_1, "driver_wrap_deg", 3.0165 * RADIAN_IN_DEGREES, 5e-5 * RADIAN_IN_DEGREES, "Shigley, example 17-1")),
    ("flat-belt", golden("speed 2749 ft/min", EXAMPLE_17_1, "belt_speed_m_per_s", 2749.0 * FOOT_PER_MINUTE, 0.5 * FOOT_PER_MINUTE, "Shigley, example 17-1")),
    ("flat-belt", golden("F_c 25.6 lbf", EXAMPLE_17_1, "centrifugal_tension_N", 25.6 * POUND_IN_NEWTONS, 0.05 * POUND_IN_NEWTONS, "Shigley, example 17-1")),
    ("flat-belt", golden("(F1)a 420 lbf", EXAMPLE_17_1, "tight_tension_N", 420.0 * POUND_IN_NEWTONS, 0.5 * POUND_IN_NEWTONS, "Shigley, example 17-1")),
    ("flat-belt", golden("F_i 270.6 lbf", EXAMPLE_17_1, "initial_tension_N", 270.6 * POUND_IN_NEWTONS, 0.05 * POUND_IN_NEWTONS, "Shigley, example 17-1")),
    ("flat-belt", golden("f' 0.328", EXAMPLE_17_1, "friction_used", 0.328, 5e-4, "Shigley, example 17-1")),
];

/// V-belt CVT with a rubber belt. Absent `traction` means "limit".
fn rubber_cvt(inputs: &BTreeMap<String, f64>) -> (&'static str, Values) {
    let belt = Belt { width: value(inputs, "belt_width_mm"), thickness: value(inputs, "belt_thickness_mm"), metal: false };
    cvt(inputs, &belt)
}

/// V-belt CVT with a metal push belt. Absent `traction` means "limit".
fn metal_cvt(inputs: &BTreeMap<String, f64>) -> (&'static str, Values) {
    let belt = Belt {
        // Two packs of n bands side by side: as wide as 2 n bands for stress purposes.
        width: 2.0 * value(inputs, "band_count") * value(inputs, "band_width_mm"),
        thickness: value(inputs, "band_thickness_mm"),
        metal: true,
    };
    cvt(inputs, &belt)
}

fn value(inputs: &BTreeMap<String, f64>, name: &str) -> f64 {
    *inputs.get(name).unwrap_or_else(|| panic!("input {name} is missing"))
}

struct Belt {
    width: f64,
    thickness: f64,
    metal: bool,
}

/// Gauss-Legendre quadrature with three points per panel (error per panel ~ h^7 f^(6) / 2e6).
fn integrate(from: f64, to: f64, panels: usize, f: impl Fn(f64) -> f64) -> f64 {
    let half = 0.5 * (to - from) / panels as f64;
    let node = 0.6_f64.sqrt() * half;
    let mut sum = 0.0;
    for i in 0..panels {
        let middle = from + (2 * i + 1) as f64 * half;
        sum += 5.0 * (f(middle - node) + f(middle + node)) + 8.0 * f(middle);
    }
    sum * half / 9.0
}

/// Panels so that an exponential of this total exponent is integrated to about 1e-14.
fn panels_for(exponent: f64) -> usize {
    (exponent.abs() / 0.05).ceil().max(1.0) as usize
}

/// Driver radius, driven radius, and inclination of the strand (positive when the driven pulley is
/// the larger), or the reason why the belt does not close.
///
/// The unknown is the inclination g of the strand, not a radius: with sin g = |R - 1| r / A the
/// belt length is a function of g alone, increasing over the whole bracket (0, 90 degrees).
fn geometry(length: f64, centre: f64, ratio: f64) -> Result<(f64, f64, f64), &'static str> {
    let spare = length - 2.0 * centre;
    if spare <= 0.0 {
        return Err("belt too short");
    }
    let step = (ratio - 1.0).abs();
    let (driver, g) = if step == 0.0 {
        (spare / (2.0 * PI), 0.0)
    } else {
        // Length beyond 2 A; the strand's part as -4 A sin^2(g/2), which does not cancel.
        let excess = |g: f64| {
            let (s, c) = (0.5 * g).sin_cos();
            let radius = 2.0 * centre * s * c / step;
            radius * (PI * (1.0 + ratio) + 2.0 * g * step) - 4.0 * centre * s * s
        };
        let (mut low, mut high) = (0.0, FRAC_PI_2);
        if excess(high) <= spare {
            return Err("no geometry");
        }
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if excess(middle) < spare {
                low = middle;
            } else {
                high = middle;
            }
        }
        (centre * low.sin() / step, low)
    };
    let driven = ratio * driver;
    if driver + driven >= centre {
        return Err("pulleys overlap");
    }
    Ok((driver, driven, if ratio < 1.0 { -g } else { g }))
}

const WEDGE_FAILURE: [&str; 6] = [
    "driver_axial_coefficient",
    "driven_axial_coefficient",
    "driver_axial_force_N",
    "driven_axial_force_N",
    "axial_force_N",
    "capacity_axial_force_N",
];
const SLIP: [&str; 17] = [
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
];
const NO_TRACTION: [&str; 8] = [
    "tight_force_N",
    "slack_force_N",
    "driver_axial_force_N",
    "driven_axial_force_N",
    "axial_force_N",
    "tensile_stress_MPa",
    "max_stress_MPa",
    "stress_margin",
];

fn cvt(inputs: &BTreeMap<String, f64>, belt: &Belt) -> (&'static str, Values) {
    let get = |name: &str| value(inputs, name);
    let friction = get("friction");
    let (sin, cos) = (0.5 * get("groove_angle_deg").to_radians()).sin_cos();
    let effective = friction / sin;
    let mut out = Values::from([("effective_friction", effective)]);

    let length = get("belt_length_mm");
    let (driver, driven, g) = match geometry(length, get("centre_distance_mm"), get("ratio")) {
        Ok(closed) => closed,
        Err(status) => return (status, out),
    };
    let (driver_wrap, driven_wrap) = (PI - 2.0 * g, PI + 2.0 * g);
    out.insert("driver_radius_mm", driver);
    out.insert("driven_radius_mm", driven);
    out.insert("driver_wrap_deg", driver_wrap.to_degrees());
    out.insert("driven_wrap_deg", driven_wrap.to_degrees());

    // Belt forces at gross slip are as 1 : q, so that lambda_max = (1 - q) / (1 + q).
    let limit = |wrap: f64| -(-effective * wrap).exp_m1() / (1.0 + (-effective * wrap).exp());
    let traction_limit = limit(driven_wrap);
    out.insert("traction_limit", traction_limit);
    out.insert("driver_traction_limit", limit(driver_wrap));

    // 1 - lambda is carried beside lambda: near the limit of a rubber belt it is small, and the
    // slack side force and the entry compression hang on its relative accuracy.
    let q = (-effective * driven_wrap).exp();
    let (traction, rest) = match inputs.get("traction") {
        Some(&given) => (given, 1.0 - given),
        None => (traction_limit, 2.0 * q / (1.0 + q)),
    };
    let slip = inputs.contains_key("traction") && traction > traction_limit;
    out.insert("slip_margin", (traction_limit - traction) / traction_limit);

    // CVT (12) from the force ratio; clamped because rounding may pass the wrap at the limit.
    let exponent = (2.0 * traction / rest).ln_1p().min(effective * driven_wrap);
    let active = exponent / effective;
    out.insert("active_arc_deg", active.to_degrees());

    // Equilibrium of one belt element: both flanks carry the radial component of the belt force,
    // helped by friction only where the slip is radial. Returned per sheave and per radian.
    let axial = |force: f64, radial_friction: f64| {
        let normal = 0.5 * force / (sin + radial_friction * cos);
        normal * (cos - radial_friction * sin)
    };
    // Per unit of F1 + F2. The driver carries the tight force all around; the driven pulley the
    // slack force over its idle arc, then a force that grows with friction along the belt.
    let (tight, slack) = (0.5 * (1.0 + traction), 0.5 * rest);
    let driver_axial = integrate(0.0, driver_wrap, 2, |_| axial(tight, friction));
    let driven_axial = integrate(0.0, driven_wrap - active, 2, |_| axial(slack, friction))
        + integrate(0.0, active, panels_for(exponent), |angle| axial(slack * (effective * angle).exp(), 0.0));
    out.insert("driver_axial_coefficient", driver_axial);
    out.insert("driven_axial_coefficient", driven_axial);
    let larger = driver_axial.max(driven_axial);

    let torque = 1000.0 * get("torque_Nm");
    let belt_force = torque / driver;
    out.insert("belt_force_N", belt_force);
    let sum = if torque == 0.0 { 0.0 } else { belt_force / traction };
    out.insert("tight_force_N", tight * sum);
    out.insert("slack_force_N", slack * sum);
    out.insert("driver_axial_force_N", driver_axial * sum);
    out.insert("driven_axial_force_N", driven_axial * sum);
    out.insert("axial_force_N", larger * sum);

    let (modulus, strength) = (get("elastic_modulus_MPa"), get("strength_MPa"));
    let smaller = driver.min(driven);
    let free = length / (2.0 * PI);
    // Strain of the outer fibre times E, per millimetre of thickness.
    let bending_rate = 0.5 * modulus * (1.0 / smaller - 1.0 / free);
    let bending = bending_rate * belt.thickness;
    let tensile = tight * sum / (belt.width * belt.thickness);
    out.insert("tensile_stress_MPa", tensile);
    out.insert("bending_stress_MPa", bending);
    out.insert("max_stress_MPa", tensile + bending);
    out.insert("stress_margin", (strength - (tensile + bending)) / strength);

    // The thickness at which bending takes half of the strength.
    let optimum = 0.5 * strength / bending_rate;
    out.insert("optimum_thickness_mm", optimum);
    // Sum F1 + F2 when the tight side reaches the strength left over by bending.
    let strongest = |thickness: f64| (strength - bending_rate * thickness).max(0.0) * belt.width * thickness / tight;
    // C is by definition the transmitted force at the optimum thickness per radius.
    let coefficient = traction * strongest(optimum) / smaller;
    out.insert("torque_coefficient_N_per_mm", coefficient);
    let capacity = strongest(belt.thickness);
    out.insert("torque_capacity_Nm", driver * traction * capacity / 1000.0);
    out.insert("capacity_axial_force_N", larger * capacity);

    if belt.metal {
        // CVT (28) with (x - 1) / x = F2 / F1, which stays finite when x does not.
        let e_minus_1 = (effective * driven_wrap).exp_m1();
        let curvature = free / (free - smaller);
        let printed = rest / (1.0 + traction) * e_minus_1 * strength * strength / modulus * curvature * (0.5 * belt.width);
        out.insert("printed_torque_coefficient_N_per_mm", printed);
        if traction > 0.0 {
            // One quotient: at the limit numerator and denominator are then equal to rounding.
            let entry = 1.0 - rest * e_minus_1 / (2.0 * traction);
            out.insert("entry_compression", entry);
        }
    }

    let failures = [
        (friction * sin / cos >= 1.0, "friction beyond the wedge", &WEDGE_FAILURE[..]),
        (slip, "slip", &SLIP[..]),
        (traction == 0.0 && torque > 0.0, "no traction", &NO_TRACTION[..]),
    ];
    let mut status = "ok";
    for (_, reason, absent) in failures.into_iter().filter(|failure| failure.0) {
        if status == "ok" {
            status = reason;
        }
        out.retain(|name, _| !absent.contains(name));
    }
    (status, out)
}

/// Loads of a V-belt on a pulley.
fn pulley_load(inputs: &BTreeMap<String, f64>) -> (&'static str, Values) {
    let get = |name: &str| value(inputs, name);
    let radius = get("mean_radius_mm");
    let angular = get("speed_rpm") * 2.0 * PI / 60.0;
    let torque = 1e6 * get("power_kW") / angular; // N mm
    let pull = torque / radius;
    let slack = get("slack_tension_N");
    let speed = angular * radius / 1000.0;
    let centrifugal = get("belt_mass_kg_per_m") * speed * speed;
    let mut out = Values::from([
        ("belt_speed_m_per_s", speed),
        ("tight_tension_N", slack + pull),
        ("effective_tension_N", pull),
        ("centrifugal_tension_N", centrifugal),
        ("torque_Nm", torque / 1000.0),
    ]);
    let contact = slack - centrifugal;
    if contact <= 0.0 {
        return ("belt lifts", out);
    }

    // dT/da = mu' (T - Tc) with its variables separated: mu' theta is the integral of
    // dT / (T - Tc) over the tensions. No logarithm, and no loss when the pull is small.
    let wrap = get("wrap_angle_deg").to_radians();
    let (mut exponent, mut done) = (0.0, 0.0);
    while done < pull {
        let next = pull.min(done + 0.02 * (contact + done));
        exponent += integrate(done, next, 1, |gained| 1.0 / (contact + gained));
        done = next;
    }
    let effective = exponent / wrap;
    out.insert("effective_friction", effective);

    // Line force along the wrap, from the slack end; at the tight end this comes back to
    // T_t - T_c only if mu' is right.
    let pressing = |angle: f64| contact * (effective * angle).exp();
    let (slack_line, tight_line) = (pressing(0.0) / radius, pressing(wrap) / radius);
    out.insert("slack_end_line_force_N_per_mm", slack_line);
    out.insert("tight_end_line_force_N_per_mm", tight_line);

    // What the belt does to the pulley: pressure towards the axis and friction towards the tight
    // end, which is where the belt is pulled. Their sum must be that of the two strands.
    let panels = panels_for(wrap.max(exponent));
    let across = integrate(0.0, wrap, panels, |angle| pressing(angle) * (-angle.cos() - effective * angle.sin()));
    let along = integrate(0.0, wrap, panels, |angle| pressing(angle) * (-angle.sin() + effective * angle.cos()));
    out.insert("resultant_force_N", across.hypot(along));

    // Flank balance with two unknowns per flank and length, normal force and total friction:
    //   circumference: 2 N F cos(gamma)                                   = mu' Q
    //   radius:        2 N (R sin(beta/2) + F sin(gamma) cos(beta/2))     = Q
    let flanks = 2.0 * get("groove_count");
    let (sin, cos) = (0.5 * get("groove_angle_deg").to_radians()).sin_cos();
    let (gamma_sin, gamma_cos) = get("friction_direction_deg").to_radians().sin_cos();
    let flank = |line: f64| {
        let friction = effective * line / (flanks * gamma_cos);
        let normal = (line / flanks - friction * gamma_sin * cos) / sin;
        (normal, friction)
    };
    let (slack_normal, slack_friction) = flank(slack_line);
    if slack_normal <= 0.0 {
        return ("no friction balances the load", out);
    }
    let used = slack_friction / slack_normal;
    let available = get("friction_limit");
    out.insert("friction_used", used);
    out.insert("friction_margin", (available - used) / available);
    out.insert("slack_end_flank_force_N_per_mm", slack_normal);
    out.insert("tight_end_flank_force_N_per_mm", flank(tight_line).0);
    ("ok", out)
}

/// Integral of dT/T from 1 to a ratio of at least 1, without a logarithm and without loss where the ratio is near 1: `gained` is what
/// it is above 1.
fn exponent_of(gained: f64) -> f64 {
    let (mut exponent, mut done) = (0.0, 0.0);
    while done < gained {
        let next = gained.min(done + 0.02 * (1.0 + done));
        exponent += integrate(done, next, 1, |more| 1.0 / (1.0 + more));
        done = next;
    }
    exponent
}

/// Flat belt over two pulleys.
fn flat_belt(inputs: &BTreeMap<String, f64>) -> (&'static str, Values) {
    let get = |name: &str| value(inputs, name);
    let angular = get("driver_speed_rpm") * 2.0 * PI / 60.0;
    let [driver, driven] = ["driver_diameter_mm", "driven_diameter_mm"].map(|name| 0.5 * get(name));
    let centre = get("centre_distance_mm");
    let (width, thickness) = (get("belt_width_mm"), get("belt_thickness_mm"));
    let torque = 1e6 * get("power_kW") / angular; // N mm
    let pull = torque / driver;
    let speed = angular * driver / 1000.0;
    let centrifugal = get("belt_density_kg_per_m3") * width * thickness * 1e-6 * speed * speed;
    let tight = get("tension_per_width_N_per_mm") * width;
    let slack = tight - pull;
    let mut out = Values::from([
        ("belt_speed_m_per_s", speed),
        ("torque_Nm", torque / 1000.0),
        ("effective_tension_N", pull),
        ("centrifugal_tension_N", centrifugal),
        ("tight_tension_N", tight),
        ("slack_tension_N", slack),
        ("initial_tension_N", 0.5 * (tight + slack) - centrifugal),
        ("belt_stress_MPa", tight / (width * thickness)),
    ]);
    let lifts = slack - centrifugal <= 0.0;
    if centre - driver - driven <= 0.0 {
        return ("pulleys overlap", out);
    }
    // The straight strands touch both pulleys: their inclination is the angle whose tangent the right triangle has.
    let rise = driven - driver;
    let free = ((centre - rise) * (centre + rise)).sqrt();
    let lean = rise.atan2(free);
    let wraps = [PI - 2.0 * lean, PI + 2.0 * lean];
    out.insert("driver_wrap_deg", wraps[0].to_degrees());
    out.insert("driven_wrap_deg", wraps[1].to_degrees());
    out.insert("belt_length_mm", 2.0 * free + wraps[0] * driver + wraps[1] * driven);
    // At slip the tension over the centrifugal one falls along the smaller wrap as dT/da = -f T says: the pull is the sum of what
    // friction takes.
    let (friction, wrap) = (get("friction"), wraps[0].min(wraps[1]));
    let share = integrate(0.0, wrap, panels_for(friction * wrap), |angle| friction * (-friction * angle).exp());
    let capacity = (tight - centrifugal) * share;
    out.insert("power_capacity_kW", capacity.max(0.0) * speed / 1000.0);
    if lifts {
        return ("slack side lifts", out);
    }
    out.insert("friction_used", exponent_of(pull / (slack - centrifugal)) / wrap);
    out.insert("slip_margin", (capacity - pull) / capacity);
    // Both strands as vectors.
    let (along, across) = ((tight + slack - 2.0 * centrifugal) * lean.cos(), pull * lean.sin());
    out.insert("shaft_load_N", along.hypot(across));
    ("ok", out)
}
