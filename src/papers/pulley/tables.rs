//! Table 1: the data of the example, and the loads that follow from them.

use super::super::{Inputs, Paper, PaperTable, numbers, words};
use super::example;
use crate::table::Table;

/// The paper's coefficient of friction: a half of the square of the total one, because it acts both along the flank and around.
pub(super) fn friction_each_way(belt: &Inputs) -> f64 {
    belt.output("friction_used") * libm::cos(belt.input("friction_direction_deg").to_radians())
}

/// Force of a bolt, N, from the pressure under its head.
pub(super) fn bolt_force(pulley: &Inputs) -> f64 {
    let (outer, inner) = (pulley.input("bolt_head_mm"), pulley.input("bolt_hole_mm"));
    pulley.output("seat_pressure_MPa") * std::f64::consts::FRAC_PI_4 * (outer * outer - inner * inner)
}

struct PulleyLine(&'static str, &'static str, f64, &'static str);

/// Printed data, data that had to be chosen, and what follows.
pub(super) fn data() -> PaperTable {
    let pulley = example();
    let belt = Inputs::preset("pulley-load", "paper");
    let outputs = belt.outputs();
    let input = |what, unit, name: &str, origin| PulleyLine(what, unit, pulley.input(name), origin);
    let output = |what, unit, name: &str, origin| PulleyLine(what, unit, outputs.get(name), origin);
    let (printed, chosen) = ("printed", "chosen");
    let by_torque = pulley.with_word("clamp_force_N", "torque");
    let lines = [
        input("initial tension T_s", "N", "slack_tension_N", printed),
        input("contact angle", "deg", "wrap_angle_deg", printed),
        input("transfer power P", "kW", "power_kW", printed),
        input("revolutions n", "rpm", "speed_rpm", printed),
        input("yield strength", "MPa", "yield_strength_MPa", printed),
        input("number of bolts", "", "bolt_count", printed),
        input("pitch circle of the bolts", "mm", "bolt_circle_mm", printed),
        input("thread pitch of M6x1", "mm", "bolt_pitch_mm", printed),
        input("tightening torque", "Nm", "tightening_torque_Nm", printed),
        input("bracket diameter", "mm", "bracket_diameter_mm", printed),
        input("sheet thickness, section 4.4", "mm", "thickness_mm", printed),
        input("belt mean radius R_b", "mm", "mean_radius_mm", chosen),
        input("groove angle beta", "deg", "groove_angle_deg", chosen),
        input("number of grooves N", "", "groove_count", chosen),
        input("belt mass w", "kg/m", "belt_mass_kg_per_m", chosen),
        output("belt speed v", "m/s", "belt_speed_m_per_s", "(2)"),
        output("tight tension T_t", "N", "tight_tension_N", "(15)"),
        output("effective tension T_e", "N", "effective_tension_N", "(1), (3)"),
        output("centrifugal tension", "N", "centrifugal_tension_N", "(4)"),
        output("effective friction mu'", "", "effective_friction", "(13)"),
        PulleyLine("friction mu, each way", "", friction_each_way(&belt), "(12)"),
        output("total friction", "", "friction_used", "sqrt(2) mu"),
        output("line force Q at the slack end", "N/mm", "slack_end_line_force_N_per_mm", "(9)"),
        output("line force Q at the tight end", "N/mm", "tight_end_line_force_N_per_mm", "(9)"),
        output("flank force R at the slack end", "N/mm", "slack_end_flank_force_N_per_mm", "(10)"),
        output("flank force R at the tight end", "N/mm", "tight_end_flank_force_N_per_mm", "(10)"),
        output("resultant of the belt's force", "N", "resultant_force_N", "balance"),
        output("torque", "Nm", "torque_Nm", "balance"),
        PulleyLine("bolt force, M/(0.2 d)", "N", bolt_force(&pulley), "rule of thumb"),
        PulleyLine("bolt force, thread and head friction 0.15", "N", bolt_force(&by_torque), "torque balance"),
    ];
    PaperTable {
        id: "pulley-table-1",
        title: "Table 1: data of the example, and the loads that follow".to_owned(),
        caption: "The paper prints the data and no load. Belt radius, groove angle, number of grooves and the belt's mass stood in lost dialogs and \
                  are chosen."
            .to_owned(),
        group: Paper::Pulley,
        table: Table {
            columns: vec![
                words("quantity", "What it is.", lines.iter().map(|line| line.0)),
                words("unit", "Its unit.", lines.iter().map(|line| line.1)),
                numbers("value", "", "Its value.", lines.iter().map(|line| Some(line.2))),
                words("origin", "Printed, chosen, or the equation it follows from.", lines.iter().map(|line| line.3)),
            ],
        },
    }
}
