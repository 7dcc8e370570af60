//! What f32 does not hold: a study with such numbers is not for a device.

use crate::error::Error;
use crate::models::input_to_si;
use crate::plan::Plan;
use crate::space::{Product, SpaceDimension};
use crate::study::{Axis, Levels, Quantity};

/// Random numbers are multiples of this fraction of their range.
const FINEST: f64 = 1.0 / (1u64 << 53) as f64;

/// The error of a study that a device cannot serve.
pub fn refuse(why: String) -> Error {
    Error::NotOnDevice { why }
}

/// Is a number zero or among the normal numbers of f32? Devices take what is smaller for zero, and what is larger for infinity.
pub fn holds(value: f64) -> bool {
    value == 0.0 || (f64::from(f32::MIN_POSITIVE)..=f64::from(f32::MAX)).contains(&value.abs())
}

/// A quantity's value as the device has it: outputs in SI, inputs in their unit.
pub fn on_device(plan: &Plan, quantity: Quantity, value: f64) -> f64 {
    match quantity {
        Quantity::Output(output) => plan.study.model.outputs[output].unit.to_si(value),
        Quantity::Input(_) => value,
    }
}

/// The first number of a study that f32 does not hold, in a sentence.
pub fn beyond_f32(plan: &Plan) -> Option<String> {
    axes(plan).or_else(|| fixed(plan)).or_else(|| bounds(plan))
}

/// The first histogram whose bins f32 does not hold, in a sentence.
pub fn histogram_beyond_f32(plan: &Plan, ranges: &[(f64, f64)]) -> Option<String> {
    let histograms = plan.study.report.histograms.iter().zip(ranges);
    histograms.into_iter().find_map(|(spec, &(from, to))| {
        let [low, high] = [from, to].map(|end| on_device(plan, spec.of, end));
        let width = (high - low) / spec.bins as f64;
        let all = [from, to, low, high, high - low, width, width.recip()].into_iter().all(holds);
        (!all).then(|| told(&format!("the histogram of {}", spec.of.name(&plan.study.model)), &format!("bins from {from:e} to {to:e}")))
    })
}

fn told(what: &str, value: &str) -> String {
    format!("{what} has {value}, and a device's numbers of 32 bits end at {:e} and {:e}", f32::MIN_POSITIVE, f32::MAX)
}

fn axes(plan: &Plan) -> Option<String> {
    let products: [&Product; 2] = [&plan.space.designs, &plan.space.scenarios];
    products.into_iter().flat_map(Product::dimensions).find_map(|(dimension, _)| {
        dimension.inputs().iter().enumerate().find_map(|(column, &input)| {
            let table = &plan.study.model.inputs[input];
            let wrong = |&value: &f64| !holds(value) || !holds(input_to_si(table, value));
            let value = values(dimension, column).into_iter().find(wrong)?;
            Some(told(&format!("the axis {}", table.name), &format!("a value or a step of {value:e} {}", table.unit.symbol)))
        })
    })
}

/// The values of an axis that are nearest to zero and farthest from it, as far as a rule gives them, or all that are listed.
fn values(dimension: &SpaceDimension, column: usize) -> Vec<f64> {
    let (low, high) = dimension.ends(column);
    let last = dimension.count() - 1;
    match dimension {
        SpaceDimension::Sampled(_) => vec![low, high, (high - low) * FINEST],
        SpaceDimension::Axis(Axis::Joint { .. } | Axis::Single { levels: Levels::List(_), .. }) => {
            (0..=last).map(|level| dimension.value(column, level)).collect()
        }
        SpaceDimension::Axis(_) => {
            // Next to a level at zero stands one that is a step away.
            let levels = [0, 1.min(last), last.saturating_sub(1), last].map(|level| dimension.value(column, level));
            levels.into_iter().chain([levels[1] - levels[0]]).collect()
        }
    }
}

fn fixed(plan: &Plan) -> Option<String> {
    let set = plan.space.designs.inputs() | plan.space.scenarios.inputs();
    let inputs = plan.study.model.inputs.iter().zip(&plan.study.fixed).enumerate();
    let mut others = inputs.filter(|&(input, _)| !set.contains(input));
    others.find_map(|(_, (table, &value))| {
        let wrong = !holds(value) || !holds(input_to_si(table, value));
        wrong.then(|| told(&table.name, &format!("the value {value:e} {}", table.unit.symbol)))
    })
}

/// Bounds of constraints, and resolutions.
fn bounds(plan: &Plan) -> Option<String> {
    let model = &plan.study.model;
    let wrong = |quantity: Quantity, value: f64| !holds(value) || !holds(on_device(plan, quantity, value));
    let constraints = plan.study.constraints.iter().flat_map(|it| [(it, it.low), (it, it.high)]);
    let bound = constraints.into_iter().find_map(|(constraint, bound)| {
        let (value, _) = bound.filter(|(value, _)| wrong(constraint.quantity, *value))?;
        Some(told(&format!("the constraint on {}", constraint.quantity.name(model)), &format!("the bound {value:e}")))
    });
    bound.or_else(|| {
        plan.study.objectives.iter().find_map(|it| {
            let value = it.resolution.filter(|&value| wrong(it.quantity, value) || !holds(value.recip()))?;
            Some(told(&format!("the objective {}", it.quantity.name(model)), &format!("the resolution {value:e}")))
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Study;

    fn refusal(text: &str) -> Option<String> {
        let text = format!("model = \"metal-cvt\"\n{text}\n");
        let plan = Plan::new(Study::parse_in(&text, "study.toml", ".".as_ref()).unwrap_or_else(|errors| panic!("{errors}")));
        let ranges: Vec<_> = plan.study.report.histograms.iter().map(|it| it.range.unwrap_or((0.0, 1.0))).collect();
        beyond_f32(&plan).or_else(|| histogram_beyond_f32(&plan, &ranges))
    }

    #[test]
    fn what_f32_does_not_hold_is_named() {
        let objective = "[objectives]\naxial_force_N = \"min\"";
        for (wrong, told) in [
            (format!("[design]\nband_thickness_mm = [1e-300, 0.1]\n{objective}"), "band_thickness_mm has a value or a step of 1e-300 mm"),
            // 1e-37 mm is 1e-40 m.
            (format!("[design]\nband_thickness_mm = [1e-37, 0.1]\n{objective}"), "band_thickness_mm has a value or a step of 1e-37 mm"),
            (format!("[design]\ntorque_Nm = {{ from = 0, to = 1e-36, count = 1000 }}\n{objective}"), "torque_Nm has a value or a step of"),
            (
                format!("[design]\ntorque_Nm = {{ from = 1, to = 1e39, count = 5 }}\n{objective}"),
                "the axis torque_Nm has a value or a step of",
            ),
            (format!("[design]\nratio = [1, 2]\n[operation]\ntorque_Nm = [1, 1e60]\n{objective}"), "the axis torque_Nm has a value"),
            (format!("[design]\nratio = [1, 2]\n[fixed]\nstrength_MPa = 1e33\n{objective}"), "strength_MPa has the value 1e33 MPa"),
            (
                format!("[design]\nratio = [1, 2]\n[constraints]\nstress_margin = {{ min = -1e39 }}\n{objective}"),
                "the constraint on stress_margin has the bound -1e39",
            ),
            (
                "[design]\nratio = [1, 2]\n[objectives]\naxial_force_N = { goal = \"min\", resolution = 1e-40 }".to_owned(),
                "the objective axial_force_N has the resolution 1e-40",
            ),
            (
                format!(
                    "[design]\nratio = [1, 2]\n{objective}\n[report]\nhistograms = [{{ of = \"stress_margin\", from = -1e39, to = 1, bins = 4 }}]"
                ),
                "the histogram of stress_margin has bins from -1e39 to 1e0",
            ),
        ] {
            let refused = refusal(&wrong).unwrap_or_else(|| panic!("{wrong} must be refused"));
            assert!(refused.contains(told), "{refused}");
        }
        for model in crate::models::all() {
            let plan = Plan::new(Study::parse_in(&model.starter, "study.toml", ".".as_ref()).expect("the starter is right"));
            assert_eq!(beyond_f32(&plan), None, "{}", model.name);
        }
    }
}
