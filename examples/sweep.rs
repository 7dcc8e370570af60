//! A study judged in memory: how thick and how many should the bands of a push belt be? Run with `cargo run --example sweep`.

use beltspace::{Options, Study};

const STUDY: &str = r#"
model = "metal-cvt"
[design]
band_thickness_mm = { from = 0.1, to = 0.4, count = 61 }
band_count = { from = 4, to = 14 }
[operation]
ratio = [0.5, 1, 2]
torque_Nm = 150
[constraints]
slip_margin = { min = 0 }
stress_margin = { min = 0 }
[objectives]
axial_force_N = "min"
stress_margin = "max"
"#;

/// Prints it.
pub fn main() -> beltspace::Result<()> {
    let outcome = Study::parse(STUDY)?.sweep(Options::default())?;
    let counts = outcome.counts;
    println!("{} of {} designs keep everything in {} scenarios", counts.feasible, counts.designs, counts.scenarios);
    for row in 0..outcome.front.rows() {
        let number = |name: &str| outcome.front.number(name, row).unwrap_or(f64::NAN);
        println!("{:2} bands of {:.3} mm: {:.0} N", number("band_count"), number("band_thickness_mm"), number("axial_force_N"));
    }
    for limit in &outcome.summary.limits {
        println!("{} of {} fail at {}", limit.designs, outcome.summary.sampled, limit.what);
    }
    Ok(())
}
