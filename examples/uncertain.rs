//! How hard must a push belt be squeezed if nobody knows its friction exactly? Run with `cargo run --example uncertain`.

use beltspace::models::{Status, evaluate, evaluate_many, find};
use beltspace::probability::{Distribution, Draws, Sampling, simultaneous};
use beltspace::sensitivity::sobol_indices;

/// The share of drives that a designer wants to hold.
const WANTED: f64 = 0.99;

/// Prints it.
pub fn main() -> beltspace::Result<()> {
    let model = find("metal-cvt").expect("the model comes with the library");
    let friction = Distribution::normal(0.08, 0.006)?.truncated(0.05, 0.11)?;
    let ratio = Distribution::triangular(0.5, 1.0, 1.6)?;
    let inputs = [("friction", friction), ("ratio", ratio)];

    // A draw is one drive as built: it holds if the belt does not slip. Every design is judged by the same draws.
    let holds = |draws: &Draws, traction: f64| -> beltspace::Result<u64> {
        let columns = draws.columns(0..draws.count());
        let tractions = vec![traction; columns[0].len()];
        let rows = [("friction", &columns[0][..]), ("ratio", &columns[1]), ("traction", &tractions)];
        Ok(evaluate_many(&model, &rows)?.statuses.iter().filter(|status| **status == Status::Ok).count() as u64)
    };
    let choosing = Draws::new(&inputs, 4096, Sampling::Random, 1)?.correlated(&[("friction", "ratio", -0.2)])?;
    let mut chosen = Vec::new();
    for step in 0..=10 {
        let traction = 0.3 + 0.02 * f64::from(step);
        if holds(&choosing, traction)? as f64 >= WANTED * choosing.count() as f64 {
            chosen.push(traction);
        }
    }
    println!("by {} draws {} of 11 tractions hold with {WANTED}", choosing.count(), chosen.len());

    // The draws that choose flatter what they have chosen: fresh ones judge it.
    let fresh = choosing.confirming(50_000)?;
    for traction in &chosen {
        let kept = holds(&fresh, *traction)?;
        let sure = simultaneous(kept, fresh.count(), 0.99, chosen.len() as u64)?;
        println!("  traction {traction:.2}: {kept} of {} hold, between {:.5} and {:.5}", fresh.count(), sure.low, sure.high);
    }

    let place = |name: &str| model.input(name).expect("it is an input");
    let (friction, ratio, force) = (place("friction"), place("ratio"), model.output("axial_force_N").expect("it is an output"));
    let indices = sobol_indices(&inputs, 4096, 1, |drawn| {
        let mut design = model.defaults();
        (design[friction], design[ratio]) = (drawn[0], drawn[1]);
        evaluate(&model, &design).outputs[force].unwrap_or(f64::NAN)
    })?;
    for index in indices {
        println!("{}: {:.2} of the variance of the axial force, {:.2} with others", index.name, index.first.mean, index.total.mean);
    }
    Ok(())
}
