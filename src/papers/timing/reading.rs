//! The printed boundary read otherwise: an ordinary car belt, the printed speed as the engine's, and another radial balance.

use super::Inputs;

/// Turns of the engine for one of the camshaft, whose pulley the paper calls driven.
pub(super) const ENGINE_TO_PULLEY: f64 = 2.0;

/// An ordinary car belt at a speed of its pulley, rpm, and a tight tension, N; it is weighed by its own rubber and cords.
pub(super) fn car_belt(speed: f64, tension: f64) -> Inputs {
    Inputs::preset("timing-belt", "car-belt").with(&[("pulley_speed_rpm", speed), ("tight_tension_N", tension)])
}

/// What presses a pitch inwards besides the tensions at the angle of a space, (T_in + T) sin phi.
#[derive(Clone, Copy)]
pub(super) enum Load {
    /// Nothing: the tensions alone.
    Without,
    /// The tooth load with its friction, Q (mu cos alpha - sin alpha).
    With,
}

/// The first tooth of the complete mesh whose centrifugal force exceeds (T_in + T) sin phi, with the tooth load or without.
pub(super) fn first_lifted(pulley: &Inputs, load: Load) -> usize {
    let angle = |name: &str| pulley.input(name).to_radians();
    let (phi, alpha, friction) = (angle("space_half_angle_deg"), angle("pressure_angle_deg"), pulley.input("friction"));
    let land_ratio = libm::exp(-2.0 * friction * angle("land_half_angle_deg"));
    let of_load = match load {
        Load::Without => 0.0,
        Load::With => friction * libm::cos(alpha) - libm::sin(alpha),
    };
    let (tensions, loads) = (pulley.column("tension_complete_N"), pulley.column("tooth_load_complete_N"));
    let force = pulley.output("centrifugal_force_N");
    let mut entering = pulley.input("tight_tension_N");
    for (at, (tension, load)) in tensions.iter().zip(loads).enumerate() {
        if (entering + tension) * libm::sin(phi) + load * of_load < force {
            return at + 1;
        }
        entering = land_ratio * tension;
    }
    tensions.len() + 1
}
