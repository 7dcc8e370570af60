//! A second implementation of the models (`timing-belt` in files of its own), written from the
//! specification alone, in N, mm, MPa and not by the methods that it suggests: bisection instead of
//! Newton, quadrature of the belt-element balance instead of closed forms. Both agreeing to 1e-9
//! therefore says something about the equations, not only about rounding.

mod printed;
pub mod timing_belt;

pub use printed::{GOLDEN, Golden};
pub mod timing_data;

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

/// V-belt CVT with a rubber belt. Absent `traction` means "limit", absent `clamping_force_N` "from-traction".
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

const WEDGE_FAILURE: [&str; 9] = [
    "thrust_ratio",
    "clamping_safety",
    "clamping_utilisation",
    "driver_axial_coefficient",
    "driven_axial_coefficient",
    "driver_axial_force_N",
    "driven_axial_force_N",
    "axial_force_N",
    "capacity_axial_force_N",
];
const SLIP: [&str; 22] = [
    "driver_axial_force_upper_N",
    "driven_axial_force_upper_N",
    "axial_force_upper_N",
    "thrust_ratio",
    "flank_pressure_MPa",
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
const NO_TRACTION: [&str; 14] = [
    "flank_pressure_MPa",
    "clamping_safety",
    "clamping_utilisation",
    "driver_axial_force_upper_N",
    "driven_axial_force_upper_N",
    "axial_force_upper_N",
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
    let turning = get("driver_speed_rpm") / 60.0 * 2.0 * PI;
    let mut out = Values::from([("effective_friction", effective), ("power_kW", get("torque_Nm") * turning / 1000.0)]);

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
    let (driven_limit, driver_limit) = (limit(driven_wrap), limit(driver_wrap));
    let (traction_limit, limiting_wrap) =
        if driven_wrap <= driver_wrap { (driven_limit, driven_wrap) } else { (driver_limit, driver_wrap) };
    out.insert("traction_limit", traction_limit);
    out.insert("driven_traction_limit", driven_limit);
    out.insert("driver_traction_limit", driver_limit);

    // Equilibrium of one belt element: both flanks carry the radial component of the belt force,
    // helped by friction only where the slip is radial. Returned per sheave and per radian.
    let axial = |force: f64, radial_friction: f64| {
        let normal = 0.5 * force / (sin + radial_friction * cos);
        normal * (cos - radial_friction * sin)
    };
    // The driven pulley carries the slack force over its idle arc, helped by radial friction or not, then a force
    // that grows with friction along the belt by this exponent.
    let driven_axial_of = |slack: f64, exponent: f64, radial_friction: f64| {
        let active = exponent / effective;
        integrate(0.0, driven_wrap - active, 2, |_| axial(slack, radial_friction))
            + integrate(0.0, active, panels_for(exponent), |angle| axial(slack * (effective * angle).exp(), 0.0))
    };

    let torque = 1000.0 * get("torque_Nm");
    let belt_force = torque / driver;
    out.insert("belt_force_N", belt_force);
    let clamping = inputs.get("clamping_force_N").copied();
    let wedged = friction * sin / cos >= 1.0;
    // The whole wrap active: the least that holds the belt on the driven pulley.
    let slip_force = belt_force * cos / (2.0 * friction);
    let held = clamping.is_none_or(|clamping| clamping > slip_force && !wedged);

    // 1 - lambda is carried beside lambda: near the limit of a rubber belt it is small, and the
    // slack side force and the entry compression hang on its relative accuracy.
    let (traction, rest, slack_force) = match (clamping, inputs.get("traction")) {
        (Some(clamping), _) if held && belt_force > 0.0 => {
            // The exponent by which the force grows around the driven pulley, from F2 = P/(e^x - 1): more growth, less axial force. The
            // active arc carries P/mu_e, whatever the growth; that quadrature finds the same force is checked below.
            let of_active = axial(belt_force / effective, 0.0);
            let of_all = |x: f64| axial(belt_force / x.exp_m1(), friction) * (driven_wrap - x / effective) + of_active;
            let (mut low, mut high) = (0.0, effective * driven_wrap);
            loop {
                let x = 0.5 * (low + high);
                if x <= low || x >= high {
                    break;
                }
                if of_all(x) > clamping {
                    low = x;
                } else {
                    high = x;
                }
            }
            ((0.5 * low).tanh(), 2.0 / (1.0 + low.exp()), belt_force / low.exp_m1())
        }
        (Some(clamping), _) => (0.0, 1.0, clamping / (driven_wrap * axial(1.0, friction))),
        (None, Some(&given)) => (given, 1.0 - given, 0.5 * (1.0 - given) * belt_force / given),
        (None, None) => {
            let q = (-effective * limiting_wrap).exp();
            (traction_limit, 2.0 * q / (1.0 + q), 0.5 * 2.0 * q / (1.0 + q) * belt_force / traction_limit)
        }
    };
    let is_number = clamping.is_some() || inputs.contains_key("traction");
    let slips_driven = if clamping.is_some() { clamping <= Some(slip_force) } else { is_number && traction > driven_limit };
    let slips_driver = held && is_number && traction > driver_limit;
    out.insert("traction_used", traction);
    out.insert("slip_margin", (traction_limit - traction) / traction_limit);

    // CVT (12) from the force ratio; clamped because rounding may pass the wrap at the limit.
    let exponent = (2.0 * traction / rest).ln_1p().min(effective * driven_wrap);
    out.insert("active_arc_deg", (exponent / effective).to_degrees());

    // Per unit of F1 + F2. The driver carries the tight force all around.
    let (tight, slack) = (0.5 * (1.0 + traction), 0.5 * rest);
    let driver_axial = integrate(0.0, driver_wrap, 2, |_| axial(tight, friction));
    let driven_axial = driven_axial_of(slack, exponent, friction);
    out.insert("driver_axial_coefficient", driver_axial);
    out.insert("driven_axial_coefficient", driven_axial);
    out.insert("thrust_ratio", driver_axial / driven_axial);
    let larger = driver_axial.max(driven_axial);
    if let (Some(clamping), true) = (clamping, held) {
        let again = driven_axial * (belt_force + 2.0 * slack_force);
        assert!((again - clamping).abs() <= 1e-10 * clamping, "{again} by quadrature, {clamping} given: {inputs:?}");
    }

    let sum = match clamping {
        Some(_) => belt_force + 2.0 * slack_force,
        None if torque == 0.0 => 0.0,
        None => belt_force / traction,
    };
    out.insert("tight_force_N", tight * sum);
    out.insert("slack_force_N", slack * sum);
    out.insert("driver_axial_force_N", driver_axial * sum);
    out.insert("driven_axial_force_N", driven_axial * sum);
    out.insert("axial_force_N", larger * sum);
    let (driver_upper, driven_upper) =
        (integrate(0.0, driver_wrap, 2, |_| axial(tight * sum, 0.0)), driven_axial_of(slack * sum, exponent, 0.0));
    out.insert("driver_axial_force_upper_N", driver_upper);
    out.insert("driven_axial_force_upper_N", driven_upper);
    out.insert("axial_force_upper_N", driver_upper.max(driven_upper));
    // The force that holds over the force that would just hold; without a traction of its own the belt force cancels.
    let safety = clamping.unwrap_or(driven_axial) / clamping.map_or(traction * cos / (2.0 * friction), |_| slip_force);
    out.insert("clamping_safety", safety);
    out.insert("clamping_utilisation", if torque == 0.0 { 0.0 } else { 1.0 / safety });

    let speed = turning * driver / 1000.0;
    let centrifugal = get("belt_mass_kg_per_m") * speed * speed;
    out.insert("belt_speed_m_per_s", speed);
    out.insert("centrifugal_force_N", centrifugal);

    let (modulus, strength) = (get("elastic_modulus_MPa"), get("strength_MPa"));
    let bending_modulus = inputs.get("bending_modulus_MPa").copied().unwrap_or(modulus);
    let smaller = driver.min(driven);
    let free = length / (2.0 * PI);
    // Strain of the outer fibre times E, per millimetre of thickness.
    let bending_rate = 0.5 * bending_modulus * (1.0 / smaller - 1.0 / free);
    let bending = bending_rate * belt.thickness;
    let area = belt.width * belt.thickness;
    let tensile = (tight * sum + centrifugal) / area;
    out.insert("tensile_stress_MPa", tensile);
    out.insert("bending_stress_MPa", bending);
    out.insert("max_stress_MPa", tensile + bending);
    out.insert("stress_margin", (strength - (tensile + bending)) / strength);

    // The thickness at which bending takes half of the strength.
    let optimum = 0.5 * strength / bending_rate;
    out.insert("optimum_thickness_mm", optimum);
    // Sum F1 + F2 when the tight side reaches what bending (and here the centrifugal force) leave of the strength.
    let strongest =
        |thickness: f64, centrifugal: f64| ((strength - bending_rate * thickness) * belt.width * thickness - centrifugal).max(0.0) / tight;
    // C is by definition the transmitted force at the optimum thickness per radius, at rest.
    let coefficient = traction * strongest(optimum, 0.0) / smaller;
    out.insert("torque_coefficient_N_per_mm", coefficient);
    let capacity = strongest(belt.thickness, centrifugal);
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
    } else {
        // A wedge of the half angle a/2, pressed inwards by F1 dtheta on two flanks of the length r dtheta.
        out.insert("flank_pressure_MPa", tight * sum / (2.0 * smaller * belt.thickness * (sin / cos)));
    }

    let unclamped: Vec<&str> =
        SLIP.iter().filter(|name| **name != "belt_force_N").chain(&["traction_used", "slip_margin"]).copied().collect();
    const SAFETY: [&str; 2] = ["clamping_safety", "clamping_utilisation"];
    let failures: [(bool, &str, &[&str]); 7] = [
        (wedged, "friction beyond the wedge", &WEDGE_FAILURE),
        (slips_driven, "slip on the driven pulley", &SLIP),
        (slips_driver, "slip on the driver", &SLIP),
        (clamping.is_none() && traction == 0.0 && torque > 0.0, "no traction", &NO_TRACTION),
        (!held, "", &unclamped),
        (clamping.is_none() && (slips_driven || slips_driver), "", &SAFETY),
        (torque == 0.0, "", &["clamping_safety"]),
    ];
    let mut status = "ok";
    for (_, reason, absent) in failures.into_iter().filter(|failure| failure.0) {
        if status == "ok" && !reason.is_empty() {
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
    // Between fixed centres the belt is as long as at rest: what one strand gains in stretch and tension the other loses.
    let is_fixed = get("tensioning") == 2.0;
    let slack = if is_fixed { (2.0 * get("installed_tension_N") - pull) / 2.0 } else { get("slack_tension_N") };
    let speed = angular * radius / 1000.0;
    let centrifugal = get("belt_mass_kg_per_m") * speed * speed;
    let mut out = Values::from([
        ("belt_speed_m_per_s", speed),
        ("slack_tension_used_N", slack),
        ("tight_tension_N", slack + pull),
        ("effective_tension_N", pull),
        ("centrifugal_tension_N", centrifugal),
        ("torque_Nm", torque / 1000.0),
    ]);
    let contact = slack - centrifugal;
    if contact <= 0.0 {
        return (if is_fixed { "slack belt" } else { "belt lifts" }, out);
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
    if used > available {
        // The tensions are those that the power asks for; what a slipping belt does to the pulley is another matter.
        out.retain(|name, _| !name.ends_with("_line_force_N_per_mm") && *name != "resultant_force_N");
        return ("slip", out);
    }
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
