//! The names of the pulley's inputs and outputs, and the numbers that words of inputs stand for.

use super::super::formula::record;
use crate::tape::Set;

record! {
    /// Inputs in the order of the table, in SI units.
    pub(super) Inputs {
        power, speed, tensioning, slack_tension, installed_tension, wrap_angle, mean_radius, groove_angle, groove_count, belt_mass,
        friction_limit, friction_direction,
        section, accuracy,
        thickness, bore_diameter, cup_diameter, wall_diameter, wall_offset, hub_bend_radius, web_bend_radius, fold_radius,
        ridge_width, weld_diameter, wall_thickness, rim_thickness, lip_thickness, fillet_radius, groove_offset,
        groove_width, groove_height, floor_depth, floor_bend_radius, rim_height, contact_height,
        bracket_diameter, bolt_count, bolt_circle, bolt_hole, bolt_head, bolt_angle,
        clamp_force, tightening_torque, bolt_friction, bolt_pitch, bolt_pitch_diameter, bolt_proof_strength, joint_friction,
        elastic_modulus, poisson_ratio, density, yield_strength, tensile_strength, endurance_limit,
        point_1_r, point_1_z, point_2_r, point_2_z,
    }
}

record! {
    /// Outputs in the order of the table.
    pub(super) Result {
        belt_speed, slack_tension, tight_tension, effective_tension, centrifugal_tension, effective_friction, friction_used,
        friction_margin, torque, resultant_force, slack_end_line_force, tight_end_line_force, slack_end_flank_force,
        tight_end_flank_force,
        max_stress, max_stress_r, max_stress_z, max_stress_theta,
        bl, br, cl, cr, dl, dr, el, er, fl, fr, own_1, own_2,
        rim_displacement, volume, mass, yield_safety, fatigue_safety, fatigue_amplitude, fatigue_mean, excluded_radius,
        seat_pressure, bolt_utilisation, joint_slip_safety,
    }
}

pub(super) const OUT: Result<usize> = Result::NUMBER;

/// Outputs that the finite elements give.
pub(super) const FINITE_ELEMENTS: Set = Set::between(OUT.max_stress, OUT.rim_displacement).with(Set::of(&[
    OUT.yield_safety,
    OUT.fatigue_safety,
    OUT.fatigue_amplitude,
    OUT.fatigue_mean,
]));

/// The word "worst" of the angle of the first bolt.
pub(super) const ANGLE_WORST: f64 = -1.0;
/// The word "torque" of the clamp force.
pub(super) const TORQUE: f64 = -1.0;
/// The word "from-tensile" of the endurance limit.
pub(super) const FROM_TENSILE: f64 = -1.0;
/// The word "none" of a point of the engineer's own.
pub(super) const POINT_NONE: f64 = -1.0;
/// The word "fine" of the accuracy.
pub(super) const FINE: f64 = 0.5;
