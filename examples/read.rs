//! What a result directory says. Run with `cargo run --example read -- results/studies/metal-cvt`.

use beltspace::{Data, Stored};

/// Prints it.
pub fn main() -> beltspace::Result<()> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "results/studies/metal-cvt".to_owned());
    let stored = Stored::read(folder.as_ref())?;
    println!("{}: {} of {} designs are feasible", stored.study.title, stored.feasible, stored.designs);
    println!("{} designs on the front", stored.front.rows());
    for column in &stored.front.columns {
        let Data::Number(values) = &column.data else { continue };
        let least = values.iter().flatten().copied().fold(f64::INFINITY, f64::min);
        let largest = values.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max);
        println!("  {} from {least} to {largest}", column.name);
    }
    Ok(())
}
