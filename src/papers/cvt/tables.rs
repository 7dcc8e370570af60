//! Tables 1 and 2, with every reading of what they print.

use super::super::{Paper, PaperTable, numbers, words};
use super::{driver_force, free_radius, metal, rubber};
use crate::models::{optimum_thickness, printed_torque_coefficient, torque_coefficient};
use crate::table::Table;
use std::f64::consts::PI;

/// Radii of Table 1, mm: r0 and r1. The scan has one value for each where two columns belong; that they are for both belts is inferred.
pub(super) const PRINTED_RADII: (f64, f64) = (163.0, 45.0);
/// x = T/P2 as measured, Table 1.
pub(super) const MEASURED_X: f64 = 1.36;
/// r1, mm, at which (28) with the metal belt's own r0 gives the printed constant.
pub(super) const METAL_R1: f64 = 30.58;
/// Traction of the metal belt at the largest torque, Table 2.
pub(super) const METAL_TRACTION: f64 = 0.58;
/// Effective tension of both belts in Table 2, N.
pub(super) const EFFECTIVE_TENSION: f64 = 2000.0;

/// C_R of (21), N/mm, for radii in mm. The model derives the radii from a belt that closes; Table 1 gives radii that no belt of the
/// paper has.
pub(super) fn rubber_constant(r0: f64, r1: f64) -> f64 {
    let belt = rubber();
    let limit = belt.output("traction_limit");
    torque_coefficient(limit, belt.input("strength_MPa"), belt.input("elastic_modulus_MPa"), r0 / (r0 - r1), belt.input("belt_width_mm"))
}

/// C_M of (28), N/mm, with x as measured, for radii in mm.
pub(super) fn metal_constant(r0: f64, r1: f64) -> f64 {
    let belt = metal();
    let pull = (MEASURED_X - 1.0) / MEASURED_X * slip_pull();
    let width = 2.0 * belt.input("band_count") * belt.input("band_width_mm");
    printed_torque_coefficient(pull, belt.input("strength_MPa"), belt.input("elastic_modulus_MPa"), r0 / (r0 - r1), width)
}

/// The metal belt's constant with the traction at the slip limit in place of x, N/mm.
pub(super) fn consistent_metal_constant(r0: f64, r1: f64) -> f64 {
    let belt = metal();
    let width = 2.0 * belt.input("band_count") * belt.input("band_width_mm");
    let limit = belt.output("traction_limit");
    torque_coefficient(limit, belt.input("strength_MPa"), belt.input("elastic_modulus_MPa"), r0 / (r0 - r1), width)
}

/// exp(mu' theta) - 1 of the metal belt at 180 degrees.
pub(super) fn slip_pull() -> f64 {
    libm::expm1(metal().output("effective_friction") * PI)
}

/// Thickness of (19) and (26), mm, with sigma_t = sigma_y/2: of the rubber belt or of a metal band.
pub(super) fn best_thickness(belt: &super::Inputs, r0: f64, r1: f64) -> f64 {
    optimum_thickness(belt.input("strength_MPa"), belt.input("elastic_modulus_MPa"), r1, r0 / (r0 - r1))
}

/// Band tension that carries the effective tension at a traction, N: (1 + lambda)/(2 lambda) P.
pub(super) fn band_tension(traction: f64) -> f64 {
    (1.0 + traction) / (2.0 * traction) * EFFECTIVE_TENSION
}

/// The rubber belt of Table 2: the torque that makes the belt force the printed one.
pub(super) fn rubber_of_table_2() -> super::Inputs {
    let belt = rubber();
    let radius = belt.output("driver_radius_mm");
    belt.with(&[("traction", 0.8), ("torque_Nm", EFFECTIVE_TENSION * radius / 1000.0)])
}

/// Smallest radius of a belt at R = 2, mm.
pub(super) fn radius_at_2(belt: &super::Inputs) -> f64 {
    belt.with(&[("ratio", 2.0)]).output("driver_radius_mm")
}

struct CvtLine(&'static str, &'static str, &'static str, &'static str, Option<f64>, f64);

/// Both tables: quantity, unit, belt, reading, printed, computed.
pub(super) fn all() -> Vec<PaperTable> {
    let (r0, r1) = PRINTED_RADII;
    let (own_rubber, own_metal) = (free_radius(&rubber()), free_radius(&metal()));
    let (small_rubber, small_metal) = (radius_at_2(&rubber()), radius_at_2(&metal()));
    let printed = "printed radii, r0 163, r1 45 mm";
    let index = |rubber: f64, metal: f64| 100.0 * rubber / metal;
    let first = [
        CvtLine("effective friction", "", "rubber", "mu/sin(alpha/2)", Some(1.545), rubber().output("effective_friction")),
        CvtLine("effective friction", "", "metal", "mu/sin(alpha/2)", Some(0.419), metal().output("effective_friction")),
        CvtLine("contact angle at R = 1", "deg", "rubber", "geometry", Some(180.0), rubber().output("driver_wrap_deg")),
        CvtLine("contact angle at R = 1", "deg", "metal", "geometry", Some(180.0), metal().output("driver_wrap_deg")),
        CvtLine("initial belt radius r0", "mm", "rubber", "L/(2 pi)", Some(r0), own_rubber),
        CvtLine("initial belt radius r0", "mm", "metal", "L/(2 pi)", Some(r0), own_metal),
        CvtLine("minimum belt radius r1", "mm", "rubber", "geometry at R = 2", Some(r1), small_rubber),
        CvtLine("minimum belt radius r1", "mm", "metal", "geometry at R = 2", Some(r1), small_metal),
        CvtLine("coefficient C_R", "N/mm", "rubber", printed, Some(20.5), rubber_constant(r0, r1)),
        CvtLine("coefficient C_R", "N/mm", "rubber", "r0 163 mm, own r1 at R = 2", Some(20.5), rubber_constant(r0, small_rubber)),
        CvtLine("coefficient C_R", "N/mm", "rubber", "own r0 and r1 at R = 2", Some(20.5), rubber_constant(own_rubber, small_rubber)),
        CvtLine("coefficient C_M", "N/mm", "metal", printed, Some(112.9), metal_constant(r0, r1)),
        CvtLine("coefficient C_M", "N/mm", "metal", "own r0, r1 30.58 mm", Some(112.9), metal_constant(own_metal, METAL_R1)),
        CvtLine("coefficient C_M", "N/mm", "metal", "own r0 and r1 at R = 2", Some(112.9), metal_constant(own_metal, small_metal)),
        CvtLine("coefficient C", "N/mm", "metal", "printed radii, slip limit in place of x", None, consistent_metal_constant(r0, r1)),
        CvtLine("index, metal 100", "", "rubber", "printed C_R over printed C_M", Some(16.0), index(20.5, 112.9)),
        CvtLine("index, metal 100", "", "rubber", printed, Some(16.0), index(rubber_constant(r0, r1), metal_constant(r0, r1))),
    ];
    let loaded = rubber_of_table_2();
    let consistent = band_tension(METAL_TRACTION);
    let rubber_force = loaded.output("driver_axial_force_N");
    let metal_force = |tension: f64| driver_force(&metal(), tension, PI);
    let second = [
        CvtLine("tight side tension", "N", "rubber", "P (1 + lambda)/(2 lambda), lambda 0.8", Some(2250.0), loaded.output("tight_force_N")),
        CvtLine("band tension", "N", "metal", "P (1 + lambda)/(2 lambda), lambda 0.58", Some(2800.0), consistent),
        CvtLine("driver axial force", "N", "rubber", "(1)", Some(4720.0), rubber_force),
        CvtLine("driver axial force", "N", "metal", "(6) with the printed tension 2800 N", Some(15_780.0), metal_force(2800.0)),
        CvtLine("driver axial force", "N", "metal", "(6) with the tension of lambda 0.58", Some(15_780.0), metal_force(consistent)),
        CvtLine("index, metal 100", "", "rubber", "printed forces", Some(34.0), index(4720.0, 15_780.0)),
        CvtLine(
            "index, metal 100",
            "",
            "rubber",
            "(1) and (6) with the printed tensions",
            Some(34.0),
            index(rubber_force, metal_force(2800.0)),
        ),
    ];
    vec![
        PaperTable {
            id: "cvt-table-1",
            title: "Table 1: torque capacity of a rubber and a metal V-belt".to_owned(),
            caption: "Every printed value that follows from others, with each reading of the radii. The scan has one pair of \
                      radii where two columns belong; if it is meant for both belts, neither belt has it, and the printed constants do not follow from it."
                .to_owned(),
            group: Paper::Cvt,
            table: table(&first),
        },
        PaperTable {
            id: "cvt-table-2",
            title: "Table 2: axial force of a rubber and a metal V-belt".to_owned(),
            caption: "At an effective tension of 2000 N and R = 1. The forces follow from the printed tensions; the metal belt's tension does not \
                      follow from the printed traction, nor either index from the printed forces."
                .to_owned(),
            group: Paper::Cvt,
            table: table(&second),
        },
    ]
}

fn table(lines: &[CvtLine]) -> Table {
    let share = |line: &CvtLine| line.4.map(|printed| 100.0 * (line.5 / printed - 1.0));
    Table {
        columns: vec![
            words("quantity", "What it is.", lines.iter().map(|line| line.0)),
            words("unit", "Unit of both values.", lines.iter().map(|line| line.1)),
            words("belt", "The belt.", lines.iter().map(|line| line.2)),
            words("reading", "How it is computed.", lines.iter().map(|line| line.3)),
            numbers("printed", "", "As the paper prints it.", lines.iter().map(|line| line.4)),
            numbers("computed", "", "What comes out.", lines.iter().map(|line| Some(line.5))),
            numbers("difference_percent", "%", "Computed over printed.", lines.iter().map(share)),
        ],
    }
}
