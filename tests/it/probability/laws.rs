//! Distributions of every kind, as text.

use crate::random::Random;

/// A distribution whose values lie between two numbers for the most part, and its name.
pub fn law(random: &mut Random, low: f64, high: f64) -> (String, &'static str) {
    let (middle, span) = (0.5 * (low + high), high - low);
    let at = |share: f64| low + share * span;
    // A lognormal value is positive, a Weibull one begins at its lower end.
    let law = random.below(if low > 0.0 { 10 } else { 9 });
    let (name, body) = match law {
        0 => ("uniform", format!("[{low:?}, {high:?}]")),
        1 => ("normal", format!("{{ mean = {middle:?}, sd = {:?} }}", span / 5.0)),
        2 => ("triangular", format!("[{low:?}, {:?}, {high:?}]", at(random.between(0.1, 0.9)))),
        3 => ("beta", format!("{{ alpha = 2, beta = {:?}, from = {low:?}, to = {high:?} }}", random.between(0.7, 5.0))),
        4 => ("weibull", format!("{{ shape = {:?}, scale = {:?}, from = {low:?} }}", random.between(1.1, 4.0), 0.4 * span)),
        5 => ("gumbel", format!("{{ mode = {:?}, scale = {:?} }}", at(0.3), 0.12 * span)),
        6 => ("discrete", format!("{{ values = [{low:?}, {middle:?}, {high:?}], weights = [1, {:?}, 2] }}", random.between(0.0, 3.0))),
        7 => {
            let values: Vec<String> = (0..7).map(|_| format!("{:?}", random.between(low, high))).collect();
            ("empirical", format!("[{}]", values.join(", ")))
        }
        8 if low > 0.0 => ("exponential", format!("{{ mean = {middle:?} }}")),
        8 => ("normal", format!("{{ mean = {:?}, sd = {:?} }}", at(0.6), span)),
        _ => ("lognormal", format!("{{ mean = {middle:?}, sd = {:?} }}", span / 5.0)),
    };
    // Cut off on one side, on both, or not at all; values beyond what the input may have are draws that do not hold.
    let ends = match (name, random.below(4)) {
        ("uniform" | "discrete" | "empirical" | "beta" | "triangular", 0 | 1) => String::new(),
        (_, 0) => format!(", from = {:?}", at(0.1)),
        (_, 1) => format!(", to = {:?}", at(0.9)),
        (_, 2) => format!(", from = {:?}, to = {:?}", at(-0.05), at(0.95)),
        _ => String::new(),
    };
    (format!("{{ {name} = {body}{ends} }}"), if ends.is_empty() { name } else { "truncated" })
}
