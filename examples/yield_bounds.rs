//! How long proven bounds of a yield take, and how far they are apart. Run with `cargo run --release --example yield_bounds`.

use beltspace::Study;
use beltspace::bounds::YieldBounds;
use std::time::Instant;

/// How far apart the bounds are to be, and the most boxes.
const WIDTH: f64 = 1e-4;
const BOXES: u64 = 300_000;

const LAWS: [&str; 4] = [
    "friction = { normal = { mean = 0.08, sd = 0.006 }, from = 0.05, to = 0.11 }",
    "band_thickness_mm = { times = { normal = { mean = 1, sd = 0.005 } } }",
    "strength_MPa = { lognormal = { mean = 800, sd = 16 } }",
    "elastic_modulus_MPa = { normal = { mean = 210000, sd = 2000 } }",
];

/// A push belt with so many uncertain inputs, at two ratios.
fn study(inputs: usize, clamping_force: u32) -> String {
    let strength = if inputs < 3 { "[fixed]\nstrength_MPa = 800\n" } else { "" };
    let laws = LAWS[..inputs].join("\n");
    format!(
        "model = \"metal-cvt\"\n[design]\nclamping_force_N = [{clamping_force}]\n{strength}[operation]\nratio = [0.5, 2]\ntorque_Nm = [100]\n\
         [uncertainty]\n{laws}\n[constraints]\nslip_margin = {{ min = 0 }}\nstress_margin = {{ min = 0.13 }}\n[objectives]\nyield = \"max\"\n\
         [probability]\ndraws = 1\n"
    )
}

/// Prints a line for each study.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("inputs  clamping force    at least     at most      apart    boxes      time");
    for inputs in 2..=4 {
        for force in [24000, 27000] {
            let bounds = YieldBounds::new(&Study::parse(&study(inputs, force))?)?;
            let start = Instant::now();
            let found = bounds.of(0, WIDTH, BOXES)?;
            let time = start.elapsed().as_secs_f64();
            let apart = found.at_most - found.at_least;
            println!("{inputs:6} {force:13} N {:11.6} {:11.6} {apart:10.2e} {:8} {time:7.3} s", found.at_least, found.at_most, found.boxes);
        }
    }
    Ok(())
}
