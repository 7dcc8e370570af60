//! What the paper says in numbers and words beside what comes out.

use super::super::comparison::{Rows, digits, percent, percent_to};
use super::super::{Comparison, Paper, Printed};
use super::printed::boundary_tension;
use super::{TimingMesh, driven, driver_at_rest};

/// Newtons of a kilogram-force as the paper's data have it.
const KILOGRAM_FORCE: f64 = 9.8;

/// All rows of the paper, in its order.
pub(super) fn all() -> Vec<Comparison> {
    let mut rows = Rows::of(Paper::TimingBelt);
    data(&mut rows);
    loads(&mut rows);
    boundaries(&mut rows);
    equations(&mut rows);
    rows.done()
}

fn data(rows: &mut Rows) {
    let at = "Section 3";
    rows.number(
        at,
        "tooth compliance f of 0.025 mm/kgf, unit printed as m/N",
        "um/N",
        &Printed::digits("2.55"),
        1000.0 * 0.025 / KILOGRAM_FORCE,
        "The scan prints 2.55 m/N, which no tooth has: the prefix is lost. Read as micrometres it is 0.025 mm/kgf, a round number like the \
         paper's other data.",
    );
    for (what, printed, kgf) in [("tight tension 20 kgf", "196", 20.0), ("tight tension 50 kgf", "490", 50.0)] {
        rows.number(
            at,
            what,
            "N",
            &Printed::digits(printed),
            kgf * KILOGRAM_FORCE,
            "Round in kgf, which supports the reading of the compliance.",
        );
    }
    rows.number(
        at,
        "cord modulus E, 8000 kgf/mm2",
        "GPa",
        &Printed::digits("78.4"),
        8.0 * KILOGRAM_FORCE,
        "Round in kgf/mm2, as the tensions are in kgf.",
    );
}

fn loads(rows: &mut Rows) {
    let (driver, driven_at_rest) = (TimingMesh::of(&driver_at_rest(490.0)), TimingMesh::of(&driven(0.0, 490.0)));
    let most = driven_at_rest.load.iter().copied().fold(0.0, f64::max);
    let least = driver.load.iter().copied().fold(f64::INFINITY, f64::min);
    rows.statement(
        "Fig. 8",
        "loads of the driven pulley's teeth, at rest, 490 N",
        "below the driver's",
        format!("at most {} N, the driver's at least {} N", digits(most), digits(least)),
        most < least,
        "23 teeth share what 11 do. The values themselves rest on a chosen belt: section, radii and angles are not printed.",
    );
    let mesh = TimingMesh::of(&driven(5000.0, 196.0));
    let changes = mesh.changes();
    let (before, behind) = changes.split_at(mesh.first_lifted - 1);
    let range = |part: &[f64]| {
        let (low, high) = part.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), it| (low.min(*it), high.max(*it)));
        (low, high, format!("{} to {}", percent_to(low, 3), percent_to(high, 3)))
    };
    let (low, _, words) = range(before);
    rows.statement(
        "Fig. 9, conclusion (1)",
        "loads before the boundary, against complete meshing",
        "slightly larger",
        words,
        low > 0.0,
        "Lifted teeth take less, so those before them must take more of the same tension. The paper prints no amount.",
    );
    let (_, high, words) = range(behind);
    rows.statement(
        "Fig. 9, conclusion (1)",
        "loads behind the boundary, against complete meshing",
        "smaller",
        words,
        high < 0.0,
        "A lifted tooth, rotated by the tooth space, carries part of its load by friction: cos(alpha + theta) + mu sin(alpha + theta) exceeds \
         cos(alpha). The paper prints no amount.",
    );
}

fn boundaries(rows: &mut Rows) {
    let first = |speed: f64, tension: f64| driven(speed, tension).output("boundary_tooth");
    let calibrated = "Calibrated, not predicted: the paper prints neither the mass of a pitch nor the radial balance it compares with the \
                      centrifugal force. The mass is set to 0.411 g so that this tooth comes out.";
    let here = first(5000.0, 196.0);
    rows.fitted("Fig. 9", "first lifted tooth j, 5000 rpm, 196 N", "", &Printed::digits("16"), here, calibrated);
    rows.fitted(
        "Fig. 9",
        "boundary tooth j - 1, 5000 rpm, 196 N",
        "",
        &Printed::digits("15"),
        here - 1.0,
        "The last tooth that meshes, by the same calibration. Step (4) calls j itself the boundary.",
    );
    let moved = |from: f64, to: f64| format!("first lifted tooth {from}, then {to}");
    let tensions = [196.0, 490.0].map(|tension| first(4000.0, tension));
    rows.statement(
        "Fig. 10, conclusion (2)",
        "boundary at 4000 rpm, tight tension 196 N, then 490 N",
        "moves to the slack side",
        moved(tensions[0], tensions[1]),
        tensions[1] > tensions[0],
        "The inward force grows with the tension, the centrifugal force does not. The teeth themselves rest on the calibration.",
    );
    let speeds = [2000.0, 3000.0, 4000.0, 5000.0].map(|speed| first(speed, 196.0));
    rows.statement(
        "Fig. 11, conclusion (3)",
        "boundary at 196 N, 2000 to 5000 rpm",
        "moves to the tight side",
        format!("first lifted tooth {}", speeds.map(|tooth| tooth.to_string()).join(", ")),
        speeds.windows(2).all(|pair| pair[1] < pair[0]),
        "The centrifugal force grows with the square of the speed. Only the last of these teeth is printed (Fig. 9), and it is calibrated.",
    );
    let pulley = driven(5000.0, 196.0);
    rows.unprinted(
        "Fig. 9",
        "speed at which the first tooth of all lifts, 196 N",
        "rpm",
        pulley.output("lift_speed_rpm"),
        "Follows from the same balance and the calibrated mass; without slack tension it grows with the root of the tight tension.",
    );
}

fn equations(rows: &mut Rows) {
    let pulley = driven(5000.0, 196.0);
    let (j, own) = (pulley.output("boundary_tooth"), pulley.output("boundary_tension_N"));
    let literal = boundary_tension(&pulley, j as usize);
    rows.statement(
        "(17)-(19)",
        "boundary tension T*, 5000 rpm, 196 N: as printed, and by the system (7), (13)",
        &format!("{} N", digits(literal)),
        format!("{} N; the printed equation is off by {}", digits(own), percent(literal / own - 1.0)),
        false,
        "The printed (17) lets tooth j - 1 leave at phi - theta although it still meshes, and (19) keeps cos psi inside. With cos phi in both \
         places (19) is the solution of the system to rounding; that is what the model computes.",
    );
    let with_option = pulley.with(&[("centrifugal_land_friction", 1.0)]);
    rows.unprinted(
        "Step (5)",
        "boundary tension with the friction term of the centrifugal force",
        "N",
        with_option.output("boundary_tension_N"),
        format!(
            "The paper asks for this term without printing it. With lands relieved of the centrifugal tension the boundary tension changes by \
             {}; it is an option, off in the figures.",
            percent(with_option.output("boundary_tension_N") / own - 1.0)
        ),
    );
}
