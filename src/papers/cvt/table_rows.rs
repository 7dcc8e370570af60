//! What the tables and the section on the bands say in numbers beside what comes out.

use super::super::Printed;
use super::super::comparison::{Rows, digits};
use super::tables::{
    MEASURED_X, METAL_R1, METAL_TRACTION, PRINTED_RADII, band_tension, best_thickness, consistent_metal_constant, metal_constant,
    radius_at_2, rubber_constant, rubber_of_table_2, slip_pull,
};
use super::{driver_force, free_radius, metal, rubber};
use std::f64::consts::PI;

pub(super) fn table_1(rows: &mut Rows) {
    let at = "Table 1";
    let (r0, r1) = PRINTED_RADII;
    let [(own_rubber, small_rubber), (own_metal, small_metal)] = [rubber(), metal()].map(|belt| (free_radius(&belt), radius_at_2(&belt)));
    rows.number(
        at,
        "effective friction mu', rubber",
        "",
        &Printed::digits("1.545"),
        rubber().output("effective_friction"),
        "mu/sin(alpha/2) with the printed data: the definition.",
    )
    .identity("the scan had one of the three numbers wrong");
    rows.number(
        at,
        "effective friction mu', metal",
        "",
        &Printed::digits("0.419"),
        metal().output("effective_friction"),
        "mu/sin(alpha/2) with the printed data: the definition.",
    )
    .identity("the scan had one of the three numbers wrong");
    for (what, belt) in [("contact angle at R = 1, rubber", rubber()), ("contact angle at R = 1, metal", metal())] {
        rows.number(at, what, "deg", &Printed::digits("180"), belt.output("driver_wrap_deg"), "Equal pulleys: half a turn each.")
            .identity("the two pulleys were not equal at R = 1");
    }
    let radius = "L/(2 pi) of (18) with the belt lengths of Figs 1 and 7. The scan of this row is broken: it has one value where two columns belong, and that \
                  it is meant for both belts is inferred from that alone.";
    rows.number(at, "initial belt radius r0, rubber", "mm", &Printed::digits("163"), own_rubber, radius);
    rows.number(at, "initial belt radius r0, metal", "mm", &Printed::digits("163"), own_metal, radius);
    let least = "The open belt's geometry at R = 2, the largest ratio of Figs 1 and 7; the paper does not say at which ratio. That one radius is meant for \
                 both belts is inferred from a broken row of the scan, as for r0.";
    rows.number(at, "minimum belt radius r1, rubber", "mm", &Printed::digits("45"), small_rubber, least);
    rows.number(at, "minimum belt radius r1, metal", "mm", &Printed::digits("45"), small_metal, least);
    let c_r = Printed::digits("20.5");
    rows.number(
        at,
        "C_R with the printed radii",
        "N/mm",
        &c_r,
        rubber_constant(r0, r1),
        "(21) with the printed r0 163 and r1 45 mm: the printed constant does not follow from the radii as the scan has them.",
    );
    rows.fitted(
        at,
        "C_R with r0 163 mm and the belt's own r1",
        "N/mm",
        &c_r,
        rubber_constant(r0, small_rubber),
        format!("r1 = {} mm is the belt's radius at R = 2, r0 is the printed one: a mixture that was found by searching for one that meets the print.", digits(small_rubber)),
    );
    rows.number(
        at,
        "C_R with the belt's own r0 and r1",
        "N/mm",
        &c_r,
        rubber_constant(own_rubber, small_rubber),
        format!("r0 = L/(2 pi) = {} mm: with the belt's own length as well it misses the print.", digits(own_rubber)),
    );
    let c_m = Printed::digits("112.9");
    rows.number(
        at,
        "C_M with the printed radii",
        "N/mm",
        &c_m,
        metal_constant(r0, r1),
        "(28) with x 1.36 and the printed r0 163 and r1 45 mm, which are not this belt's.",
    );
    rows.fitted(
        at,
        "C_M with the belt's own r0 and r1 30.58 mm",
        "N/mm",
        &c_m,
        metal_constant(own_metal, METAL_R1),
        format!("r1 was searched for so that the printed constant comes out; the belt's radius at R = 2 is {} mm.", digits(small_metal)),
    );
    rows.number(
        at,
        "C_M with the belt's own r0 and r1",
        "N/mm",
        &c_m,
        metal_constant(own_metal, small_metal),
        format!("r0 = L/(2 pi) = {} mm and the radius at R = 2: near the print, but not it.", digits(own_metal)),
    );
    rows.unprinted(
        at,
        "metal constant at the slip limit in place of x, printed radii",
        "N/mm",
        consistent_metal_constant(r0, r1),
        "(28) takes x as measured and mu' theta as computed; the two agree only where (x-1)(e-1) = 1. With one traction for both, the \
         constant is this.",
    );
    rows.unprinted(
        at,
        "entry compression P1/P2 that x = 1.36 implies",
        "",
        1.0 - (MEASURED_X - 1.0) * slip_pull(),
        "1 - (x-1)(e-1): (6) assumes 0. It is nearly 0 at these data; with larger friction or wrap at the same x it turns negative, \
         which cannot be, and (28) overstates.",
    );
    rows.number(
        at,
        "traction of x = 1.36",
        "",
        &Printed::digits("0.58"),
        1.0 / (2.0 * MEASURED_X - 1.0),
        "lambda = 1/(2x - 1), from (24) and P1 = 0: the measured x and the measured slip are one measurement, written twice.",
    )
    .identity("x and the slip traction had been measured apart and did not fit together");
    rows.number(
        at,
        "index of the rubber belt, printed C_R over printed C_M",
        "",
        &Printed::digits("16"),
        100.0 * 20.5 / 112.9,
        "The table contradicts itself: its own constants give the .18 of the text. Which of its numbers is wrong cannot be told.",
    );
    rows.number(
        at,
        "index of the rubber belt, C_R at the printed radii over printed C_M",
        "",
        &Printed::digits("16"),
        100.0 * rubber_constant(r0, r1) / 112.9,
        format!(
            "(21) at the printed radii gives {} N/mm. Over the printed C_M it makes the printed index, and the \"6 to 7\" of the text, as if the \
             table's 20.5 were the number that is wrong: a reading, not proof.",
            digits(rubber_constant(r0, r1))
        ),
    )
    .reading();
    rows.number(
        "4.1.2",
        "index of the rubber belt, printed C_R over printed C_M",
        "",
        &Printed::digits("0.18"),
        20.5 / 112.9,
        "The text's index is the quotient of the table's constants.",
    )
    .identity("the scan had one of the three numbers wrong");
    let ratio = metal_constant(r0, r1) / rubber_constant(r0, r1);
    let three = "Text and table disagree among themselves: 5-6 in the abstract, 6-7 and 1/6-1/7 in the text and conclusion (2), 5.5 from the table's constants.";
    rows.number("Abstract", "capacity, metal over rubber, printed radii", "", &Printed::between(5.0, 6.0), ratio, three);
    rows.number("4.2, conclusion (2)", "capacity, metal over rubber, printed radii", "", &Printed::between(6.0, 7.0), ratio, three);
    rows.number(
        "4.2, conclusion (2)",
        "capacity, metal over rubber, printed C_M over C_R at the printed radii",
        "",
        &Printed::between(6.0, 7.0),
        112.9 / rubber_constant(r0, r1),
        "The same reading as for the index 16, the other way round.",
    )
    .reading();
    rows.number(
        at,
        "capacity, metal over rubber, quotient of the constants",
        "",
        &Printed::digits("5.5"),
        ratio,
        "The printed constants' quotient is 112.9/20.5 = 5.5; with (21) and (28) evaluated at the printed radii both constants are lower, the rubber belt's more.",
    );
}

pub(super) fn thickness(rows: &mut Rows) {
    let printed = Printed::digits("0.2");
    let (r0, r1) = PRINTED_RADII;
    let (own_r0, own_r1) = (free_radius(&metal()), radius_at_2(&metal()));
    let open = "(26) with sigma_t = sigma_y/2 = 250 MPa. The paper prints 0.2 mm as the thickness of the real bands; it does not claim that (26) gives it.";
    for (what, value, more) in [
        ("optimum band thickness, printed r0 163 and r1 45 mm", best_thickness(&metal(), r0, r1), String::new()),
        (
            "optimum band thickness, own r0 and r1 at R = 2",
            best_thickness(&metal(), own_r0, own_r1),
            format!(" r0 = L/(2 pi) = {} mm, r1 = {} mm.", digits(own_r0), digits(own_r1)),
        ),
        (
            "optimum band thickness, own r0 and printed r1 45 mm",
            best_thickness(&metal(), own_r0, r1),
            format!(
                " r0 = {} mm of the belt with an r1 that is not the belt's: a mixture, and the only one of the three that meets it.",
                digits(own_r0)
            ),
        ),
    ] {
        rows.number("(26), section 3", what, "mm", &printed, value, format!("{open}{more}")).reading();
    }
    let (own_r0, own_r1) = (free_radius(&rubber()), radius_at_2(&rubber()));
    for (what, value) in [
        ("optimum belt thickness, rubber, printed r0 163 and r1 45 mm", best_thickness(&rubber(), r0, r1)),
        ("optimum belt thickness, rubber, own r0 and r1 at R = 2", best_thickness(&rubber(), own_r0, own_r1)),
    ] {
        rows.unprinted(
            "(19)",
            what,
            "mm",
            value,
            "(19) with sigma_t = sigma_y/2 = 9 MPa; C_R of Table 1 holds for a belt of this thickness. The paper prints no thickness of the rubber \
             belt. Real belts are several times as thick: (19) takes one modulus for tension and bending, and a real belt bends far more easily than it stretches.",
        );
    }
}

pub(super) fn table_2(rows: &mut Rows) {
    let at = "Table 2";
    let loaded = rubber_of_table_2();
    let outputs = loaded.outputs();
    let (rubber_force, tension) = (outputs.get("driver_axial_force_N"), band_tension(METAL_TRACTION));
    let metal_force = driver_force(&metal(), 2800.0, PI);
    rows.number(
        at,
        "tight side tension T1, rubber",
        "N",
        &Printed::digits("2250"),
        outputs.get("tight_force_N"),
        "P (1 + lambda)/(2 lambda) with P 2000 N and lambda 0.8: the definition of lambda.",
    )
    .identity("the scan had one of the three numbers wrong");
    rows.number(
        at,
        "band tension T, metal",
        "N",
        &Printed::rounded("2800", 100.0),
        tension,
        "P (1 + lambda)/(2 lambda) with the printed P 2000 N and lambda 0.58 gives less than the printed tension. At 0.58 the model itself \
         says slip (limit 0.5774), so the equation is evaluated directly.",
    );
    rows.number(
        at,
        "driver axial force, rubber",
        "N",
        &Printed::rounded("4720", 10.0),
        rubber_force,
        "(1) with the printed data; the print is rounded to tens.",
    );
    rows.number(
        at,
        "driver axial force, metal, T 2800 N",
        "N",
        &Printed::rounded("15 780", 10.0),
        metal_force,
        "(6) with the printed data. mu - tan(alpha/2) as printed in (8) would give a negative force: the sum is meant.",
    );
    rows.number(
        at,
        "driver axial force, metal, T of lambda 0.58",
        "N",
        &Printed::rounded("15 780", 10.0),
        driver_force(&metal(), tension, PI),
        "(6) with the tension that follows from P and lambda: the printed force belongs to the printed 2800 N.",
    );
    rows.number(
        at,
        "index of the rubber belt",
        "",
        &Printed::digits("34"),
        100.0 * 4720.0 / 15_780.0,
        "The table contradicts itself: its own forces give 30. Which of its numbers is wrong cannot be told.",
    );
    let at_forces = metal().with(&[("friction", 0.11)]);
    rows.number(
        at,
        "index of the rubber belt, metal force with mu 0.11 and T of lambda 0.58",
        "",
        &Printed::digits("34"),
        100.0 * rubber_force / driver_force(&at_forces, tension, PI),
        "(6) with the friction that the measured forces of Fig. 9 follow, in place of Table 1's, and the tension that follows from P and lambda. A \
         reading, not proof.",
    )
    .reading();
    rows.number(
        "Abstract, 4.2, conclusion (2)",
        "driver axial force, metal over rubber",
        "",
        &Printed::between(3.0, 4.0),
        metal_force / rubber_force,
        "Both forces from (1) and (6) with the printed tensions.",
    );
    let driven = outputs.get("driven_axial_force_N");
    rows.statement(
        at,
        "the larger of both pulleys' forces, rubber",
        "the driver's",
        format!("driver {} N, driven {} N", digits(rubber_force), digits(driven)),
        rubber_force > driven,
        "(1) and (2) at lambda 0.8: the tight side's force acts on the whole wrap of the driver.",
    );
    let at_limit = metal().outputs();
    let (driver, driven) = (at_limit.get("driver_axial_force_N"), at_limit.get("driven_axial_force_N"));
    rows.statement(
        at,
        "the larger of both pulleys' forces, metal at its slip limit",
        "the driver's",
        format!("driver {} of the driven force", digits(driver / driven)),
        driver > driven,
        "(6) and (11) at the slip limit 0.577, because the printed 0.58 slips.",
    );
}
