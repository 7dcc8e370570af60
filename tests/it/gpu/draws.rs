//! Draws that are counted on a device: the same designs as on the CPU, what is not for a device, and errors that are noticed.

use super::{Prepared, assert_same, device, wrong};
use beltspace::error::Error;
use beltspace::screen::gpu::{Wrong, supports};

/// Every statistic that a device can give, factors and addends, values that an input may not have, and levels.
const EVERY: &str = r#"
model = "metal-cvt"
[design]
groove_angle_deg  = { from = 18, to = 30, count = 4 }
band_thickness_mm = { from = 0.10, to = 0.30, step = 0.04 }
band_count        = { from = 6, to = 14 }
[operation]
ratio     = [0.5, 2]
torque_Nm = [50, 150]
[uncertainty]
friction             = { normal = { mean = 0.08, sd = 0.006 }, from = 0.05, to = 0.11 }
strength_MPa         = { times = { uniform = [0.9, 1.1] } }
driver_speed_rpm     = { plus = { uniform = [-20, 400] } }
elastic_modulus_MPa  = [200000, 210000]
[probability]
draws = 40
confirm = 100
[fixed]
traction = 0.35
strength_MPa = 800
driver_speed_rpm = 0
belt_mass_kg_per_m = 1.1
[constraints]
slip_margin   = { min = 0 }
stress_margin = { min = 0, yield = 0.5 }
axial_force_N = { max = 51000, over_draws = "worst" }
yield         = { min = 0.3 }
[objectives]
axial_force_upper_N = { goal = "min", over_draws = "mean" }
stress_margin = { goal = "max", over_draws = "worst" }
yield         = "max"
band_count    = "min"
[report]
histograms = [{ of = "yield", from = 0, to = 1, bins = 7 }]
maps = [{ x = "band_thickness_mm", y = "groove_angle_deg", best = "share" }]
"#;

#[test]
fn draws_are_counted_as_on_the_cpu() {
    // Some draws of the first have a speed below zero, and so no result; of the second many designs are feasible.
    for (speeds, least) in [("[-20, 400]", 0), ("[0, 400]", 30)] {
        let study = Prepared::parse(&EVERY.replace("[-20, 400]", speeds));
        let (state, record) = study.on(device()).unwrap_or_else(|error| panic!("{error}"));
        assert_same(&study.on_cpu(), &state, speeds);
        assert!(state.feasible >= least, "{} designs are feasible", state.feasible);
        let unsure = record.unsure as f64 / record.designs as f64;
        assert!(unsure < 0.5, "{unsure} of the designs are unsure");
    }
}

#[test]
fn what_of_draws_is_not_for_a_device_is_named() {
    let limited = true;
    for (piece, other, told) in [
        (
            "over_draws = \"worst\" }\nyield         = \"max\"",
            "over_draws = \"sd\" }\nyield         = \"max\"",
            "stress_margin_draw_sd is a standard deviation over the draws, which the CPU computes",
        ),
        (
            "over_draws = \"worst\" }\nyield         = \"max\"",
            "over_draws = { quantile = 0.9 } }\nyield         = \"max\"",
            "stress_margin_draw_q90 is a quantile over the draws, which the CPU computes",
        ),
        ("draws = 40", "draws = 20000", "loop iterations over its scenarios are more than the 55000 that this driver can be trusted with"),
    ] {
        assert!(EVERY.contains(piece), "{piece}");
        let study = Prepared::parse(&EVERY.replace(piece, other));
        let error = supports(&study.plan, limited).expect_err(told).to_string();
        assert!(error.contains(told) && error.contains("use --engine cpu"), "{error}");
    }
    let timing = "model = \"timing-belt\"\n[design]\nslack_tension_N = { from = 100, to = 200, count = 3 }\n[uncertainty]\n\
                  tight_tension_N = { uniform = [300, 400] }\n[objectives]\nyield = \"max\"\n[constraints]\nincomplete_teeth = { max = 2 }\n";
    let error = supports(&Prepared::parse(timing).plan, limited).expect_err("it has tables").to_string();
    assert!(error.contains("draws of timing-belt need its tables by the draw, which the CPU computes"), "{error}");
}

#[test]
fn a_device_that_draws_or_counts_otherwise_is_noticed() {
    let refused = |pieces: &[(&str, &str)]| {
        let replace = pieces.iter().map(|&(piece, other)| (piece.to_owned(), other.to_owned())).collect();
        match Prepared::parse(EVERY).on(&wrong(Wrong { replace, ..Wrong::default() })) {
            Err(Error::ErrorBound(message)) => message,
            Err(other) => panic!("{other}"),
            Ok(_) => panic!("nobody objects to {pieces:?}"),
        }
    };
    for (piece, other) in [
        ("for (var draw = 0u; draw < DRAWS; draw++) {", "for (var draw = 1u; draw < DRAWS; draw++) {"),
        ("number < CASES; number++) {", "number + 1u < CASES; number++) {"),
        ("const FIRST_DRAW: u32 = FIRST_CASE + 8u;", "const FIRST_DRAW: u32 = FIRST_CASE + 7u;"),
        (
            "fn set_draw(own: ptr<function, Inputs>, draw: u32) -> u32 {\n    var built = YES;",
            "fn set_draw(own: ptr<function, Inputs>, draw: u32) -> u32 {\n    var built = select(YES, NO, draw == 7u);",
        ),
    ] {
        let told = refused(&[(piece, other)]);
        assert!(
            told.contains("more than the error bound of") || told.contains("the GPU is sure") || told.contains("the GPU counts"),
            "{told}"
        );
    }
    // Designs are given up that could still become feasible, as if the draws that remain did not count.
    let told = refused(&[("+ (DRAWS - draw - 1u) <", "<"), ("+ rest) * 0.5", ") * 0.5")]);
    assert!(told.contains("more than the error bound of") || told.contains("the GPU is sure") || told.contains("the GPU counts"), "{told}");
}
