//! What the paper says in numbers and words beside what comes out.

use super::super::comparison::{Rows, digits, percent};
use super::super::{Comparison, Inputs, Paper, Printed};
use super::tables::{bolt_force, friction_each_way};
use super::thickness::{DIRECTIONS, SheetCase, choice};
use super::{Stressed, example};

/// All rows of the paper, in its order.
pub(super) fn all(studied: &[SheetCase], stressed: &[Stressed]) -> Vec<Comparison> {
    let mut rows = Rows::of(Paper::Pulley);
    data(&mut rows);
    loads(&mut rows);
    bolts(&mut rows);
    thickness(&mut rows, studied);
    stresses(&mut rows, stressed);
    rows.done()
}

/// Printed data and the inputs they are.
const DATA: [(&str, &str, &str, &str); 9] = [
    ("initial tension", "N", "slack_tension_N", "700"),
    ("contact angle", "deg", "wrap_angle_deg", "88"),
    ("transfer power", "kW", "power_kW", "3"),
    ("revolutions", "rpm", "speed_rpm", "3000"),
    ("yield strength", "MPa", "yield_strength_MPa", "270"),
    ("number of tightening bolts", "", "bolt_count", "4"),
    ("pitch circle diameter of bolts", "mm", "bolt_circle_mm", "45"),
    ("tightening torque", "Nm", "tightening_torque_Nm", "10"),
    ("bracket diameter", "mm", "bracket_diameter_mm", "55"),
];

fn data(rows: &mut Rows) {
    let example = example();
    for (what, unit, name, printed) in DATA {
        rows.input("Table 1", what, unit, &Printed::digits(printed), example.input(name), "Used as printed: the example's input.");
    }
}

fn loads(rows: &mut Rows) {
    let belt = Inputs::preset("pulley-load", "paper");
    let outputs = belt.outputs();
    let get = |name: &str| outputs.get(name);
    let chosen = "Not printed. The mean radius of 60 mm is chosen.";
    let follows = "Not printed. Follows from Table 1 with chosen R_b 60 mm, beta 36 deg, N 1 and w 0.11 kg/m.";
    rows.unprinted("(2)", "belt speed v", "m/s", get("belt_speed_m_per_s"), chosen);
    rows.unprinted(
        "(15)",
        "tight tension T_t",
        "N",
        get("tight_tension_N"),
        format!("{chosen} The paper's section 2.1 swaps the names of tight and slack tension; nomenclature and equations are right."),
    );
    rows.unprinted(
        "(4)",
        "centrifugal tension w v^2",
        "N",
        get("centrifugal_tension_N"),
        format!("{follows} With w in kgf/m, w v^2/g would be in kgf beside tensions in N; read as kg/m, w v^2 is in N."),
    );
    rows.unprinted("(13)", "effective friction mu'", "", get("effective_friction"), follows);
    rows.unprinted("(12)", "friction mu, along the flank and around alike", "", friction_each_way(&belt), follows);
    rows.unprinted("(12), (16)", "total friction", "", get("friction_used"), "Not printed. The paper lets mu act along the flank and around at once, so the resultant is sqrt(2) mu, which is what a friction limit must be compared with.");
    rows.unprinted("(10)", "flank force R at the slack end", "N/mm", get("slack_end_flank_force_N_per_mm"), follows);
    rows.unprinted("(10)", "flank force R at the tight end", "N/mm", get("tight_end_flank_force_N_per_mm"), follows);
    rows.unprinted(
        "(9)-(16)",
        "resultant of the belt's force",
        "N",
        get("resultant_force_N"),
        format!("{follows} It is the resultant of the tensions less the centrifugal tension, which never reaches the pulley."),
    );
    rows.unprinted("(3)", "torque", "Nm", get("torque_Nm"), "Not printed. Power over speed: no chosen value enters.");
    let half = belt.input("groove_angle_deg").to_radians() / 2.0;
    let mu = friction_each_way(&belt);
    let (along_flank, literal) = (libm::sin(half) + mu * libm::cos(half), libm::sin(half) + mu);
    rows.statement(
        "2.3, (16)",
        "radial force of the flanks if friction is radial, as the text says",
        "equal to Q of (10)",
        format!("{} more than Q", percent(literal / along_flank - 1.0).trim_start_matches('+')),
        (literal / along_flank - 1.0).abs() < 1e-9,
        "(10) balances Q only if that friction acts along the flank, inwards and towards the groove's middle; taken as radial the loads miss \
         the tensions' resultant. The model lets it act along the flank.",
    );
    let customary = belt.with(&[("friction_direction_deg", 0.0)]);
    let rise = customary.output("slack_end_flank_force_N_per_mm") / get("slack_end_flank_force_N_per_mm") - 1.0;
    rows.remark(
        "(12)",
        "flank force with friction around the circumference alone",
        percent(rise),
        "Not printed. mu' = mu/sin(beta/2), as customary for V-belts, presses harder than the paper's friction in both directions.",
    );
}

fn bolts(rows: &mut Rows) {
    let example = example();
    rows.unprinted(
        "2.4",
        "bolt force of 10 N m, M/(0.2 d)",
        "N",
        bolt_force(&example),
        "Not printed; the paper refers to a handbook. This is the rule of thumb with d 6 mm.",
    );
    let full = bolt_force(&example.with_word("clamp_force_N", "torque"));
    rows.unprinted(
        "2.4",
        "bolt force of 10 N m, thread and head friction 0.15",
        "N",
        full,
        "Not printed. The handbook's torque balance with M6x1 and a head of 12/6.6 mm; the friction is chosen.",
    );
}

fn thickness(rows: &mut Rows, studied: &[SheetCase]) {
    let at = "4.4, Fig. 12";
    let printed = Printed::digits("1.8");
    let stress = |thickness: f64| {
        let found = studied.iter().find(|sheet| sheet.thickness == thickness && sheet.direction == DIRECTIONS[0]);
        found.expect("it was studied").stress
    };
    rows.number(
        at,
        "sheet thickness chosen, friction as in the paper",
        "mm",
        &printed,
        choice(studied, DIRECTIONS[0]),
        format!(
            "Thinnest of 1.4, 1.6 .. 2.4 mm below 270 MPa: {} MPa at 1.6 and {} MPa at 1.8 mm. The paper's section is lost and ours, with the belt's \
             radius, mass and angle, is chosen; only the choice is printed of the three thicknesses that were tried.",
            digits(stress(1.6)),
            digits(stress(1.8))
        ),
    )
    .reading();
    rows.number(
        at,
        "sheet thickness chosen, friction around the circumference alone",
        "mm",
        &printed,
        choice(studied, DIRECTIONS[1]),
        "The customary direction of friction presses the flanks harder, and the same chosen section needs a thicker sheet: the paper's \
         assumption is not the safe one.",
    )
    .reading();
    let example = example().outputs();
    let not_printed = "Stood in a lost dialog; ours holds for a chosen section.";
    rows.unprinted(at, "largest stress at 1.8 mm", "MPa", example.get("max_stress_MPa"), not_printed);
    rows.unprinted(at, "volume at 1.8 mm", "mm3", example.get("volume_mm3"), not_printed);
}

fn stresses(rows: &mut Rows, stressed: &[Stressed]) {
    let at = "5, Fig. 13";
    for Stressed { of, largest, yield_strength, place, .. } in stressed {
        let why = if place.shape_changes { "A change of shape, the second of the paper's places." } else { "None of the paper's places." };
        let yields = if largest > yield_strength {
            " It exceeds the yield strength: with our dimensions this section would not do for the data of Table 1, so the paper's must be stiffer."
        } else {
            ""
        };
        rows.statement(
            at,
            &format!("largest stress, {}", of.words),
            "bolt seats, shape changes, last contact",
            format!("{} MPa {}", digits(*largest), place.words),
            place.shape_changes,
            format!("{why} Our dimensions are chosen, and which type has which place is lost with the figure.{yields}"),
        )
        .reading()
        .fails_if(
            "the largest stress outside the bolt seats stood on a flat wall: farther from the groove's floor than its bend radius, or from the \
             weld than a sheet's thickness. A section with bends on every side of the belt can hardly do that",
        );
    }
    let seats = stressed.iter().map(|one| format!("{} against {}", digits(one.seats().round()), digits(one.largest.round())));
    let seats: Vec<String> = seats.collect();
    rows.statement(
        at,
        "stress at bolt seats and bracket edge against the largest elsewhere, MPa, types 1 to 4",
        "among the high ones",
        seats.join(", "),
        stressed.iter().any(|one| one.seats() > one.largest),
        "So for the stiff type 1 alone. Beside the edges of bracket and bolt heads an elastic stress grows with every refinement of the mesh: \
         that zone is left out of the largest stress, and these values say as much of the mesh as of the pulley.",
    )
    .reading()
    .fails_if("the stress at the seats were below the largest elsewhere for all four types");
    let example = example();
    let (wrap, theta) = (example.input("wrap_angle_deg"), example.output("max_stress_theta_deg"));
    rows.statement(
        at,
        "angle of the largest stress, type 4, from the slack end",
        "the last contact with the belt",
        format!("{} deg of {wrap} deg", digits(theta)),
        (wrap - theta).abs() < 5.0,
        "If last contact means the tight end of the wrap: the belt presses hardest there, but the groove bends most where the belt presses on both \
         sides of a place, so ours stands before the end. The section is chosen.",
    )
    .reading()
    .fails_if("the angle were 5 degrees or more from the tight end of the wrap");
}
