//! A model without a study: one design, then many. Run with `cargo run --example evaluate`.

use beltspace::models::{evaluate, evaluate_many, find};

/// Prints it.
pub fn main() -> beltspace::Result<()> {
    let model = find("rubber-cvt").expect("the model comes with the library");
    let one = evaluate(&model, &model.defaults());
    println!("with the defaults: {}", one.status.reason(&model));
    for (output, value) in model.outputs.iter().zip(&one.outputs) {
        println!("  {} = {}", output.name, value.map_or("absent".to_owned(), |value| value.to_string()));
    }

    // A column per input that changes; the others have their defaults.
    let widths: Vec<f64> = (20..=50).map(f64::from).collect();
    let many = evaluate_many(&model, &[("belt_width_mm", &widths)])?;
    let name = &model.outputs[0].name;
    let column = many.output(&model, name).expect("it is an output");
    for ((width, value), status) in widths.iter().zip(column).zip(&many.statuses) {
        println!("{width} mm: {name} = {value:?}, {}", status.reason(&model));
    }
    Ok(())
}
