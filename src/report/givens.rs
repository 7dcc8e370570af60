//! Inputs that formulas of a study give: where a drawing needs them, they are neither among the inputs nor columns of the front.

use crate::models::{Model, evaluate};
use crate::plan::Plan;
use crate::study::number;
use serde_json::{Map, Value, json};

/// Most numbers that a result's page holds of them.
const MOST_NUMBERS: usize = 20_000;
/// Seconds of an evaluation that takes long.
const LONG: f64 = 1e-4;

/// The given inputs of a design by their names, as far as they are the same in its first and last scenario: its dimensions. Of a drawn
/// drive as it is designed.
pub fn of_design(plan: &Plan, design: u64) -> Map<String, Value> {
    let model = drawn_model(plan);
    let places = places(model);
    if places.is_empty() {
        return Map::new();
    }
    let [first, last] = [false, true].map(|last| evaluate(model, &inputs(plan, model, design, last)));
    let same = |&place: &usize| first.outputs[place].filter(|it| last.outputs[place] == Some(*it)).map(|it| (place, it));
    places.iter().filter_map(same).map(|(place, value)| (model.outputs[place].name.clone(), number(value))).collect()
}

/// Those of some designs: their names, and of each design its numbers; `null` where no formula gives such an input. Where they
/// would be too many the last designs have none.
pub fn of_designs(plan: &Plan, designs: &[u64]) -> Value {
    let names: Vec<String> = designs.first().map_or_else(Vec::new, |&design| of_design(plan, design).into_iter().map(|it| it.0).collect());
    if names.is_empty() {
        return Value::Null;
    }
    let of = designs.iter().take(MOST_NUMBERS / names.len()).map(|&design| {
        let found = of_design(plan, design);
        (design.to_string(), names.iter().map(|name| found.get(name).cloned().unwrap_or_default()).collect())
    });
    json!({ "names": names, "of": of.collect::<Map<_, _>>() })
}

/// The model whose drive is drawn: within distributions that of a single draw.
fn drawn_model(plan: &Plan) -> &Model {
    plan.study.probability.as_ref().map_or(&*plan.study.model, |it| &*it.drive.model)
}

/// Outputs of a model that are inputs of the one that its formulas stand around; none of one that takes long.
fn places(model: &Model) -> Vec<usize> {
    let Some(base) = model.base().filter(|_| model.effort.prepare + model.effort.finish < LONG) else { return Vec::new() };
    (0..model.outputs.len()).filter(|&output| base.input(&model.outputs[output].name).is_some()).collect()
}

/// The inputs of the drawn model in the first or the last scenario. Where something is drawn operating cases are no scenarios of the study.
fn inputs(plan: &Plan, model: &Model, design: u64, last: bool) -> Vec<f64> {
    let end = |count: u64| if last { count - 1 } else { 0 };
    let own = plan.space.inputs(design, end(plan.scenarios()));
    let of_study = &plan.study.model;
    let mut inputs = model.defaults();
    for (place, input) in model.inputs.iter().enumerate() {
        if let Some(number) = of_study.input(&input.name) {
            inputs[place] = own[number];
        }
    }
    for axis in plan.study.probability.iter().flat_map(|it| &it.drive.operation) {
        for (column, &input) in axis.inputs().iter().enumerate() {
            inputs[input] = axis.value(column, end(axis.count()));
        }
    }
    inputs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Study;

    fn shipped(name: &str) -> Plan {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
        let text = std::fs::read_to_string(folder.join(format!("{name}.toml"))).expect("a study");
        Plan::new(Study::parse_in(&text, name, &folder).unwrap_or_else(|errors| panic!("{errors}")))
    }

    #[test]
    fn what_formulas_give_is_known_of_each_design() {
        // The first design has 36 teeth of 9.525 mm, and asks for 280 N; the camshaft takes 13 N m.
        let plan = shipped("timing-tension");
        let told = of_design(&plan, 0);
        let tip = 36.0 * 9.525 / (2.0 * std::f64::consts::PI) - 0.686;
        let close = |name: &str, value: f64| {
            let found = told[name].as_f64().unwrap_or(f64::NAN);
            assert!((found - value).abs() < 1e-9 * value.abs(), "{name} is {found}, not {value}");
        };
        close("tip_radius_mm", tip);
        close("teeth_in_mesh", 18.0);
        close("land_half_angle_deg", 64.8 / 36.0);
        close("slack_tension_N", 280.0 - 13_000.0 / (tip + 0.686));
        let front = of_designs(&plan, &[0, 5]);
        assert_eq!(front["names"].as_array().map(Vec::len), Some(told.len()));
        assert_eq!(front["of"].as_object().map(Map::len), Some(2));
    }

    #[test]
    fn without_formulas_of_inputs_there_are_none() {
        assert_eq!(of_designs(&shipped("metal-grid"), &[0]), Value::Null);
        // A clamping force that follows the torque is no dimension.
        assert_eq!(of_designs(&shipped("metal-cvt"), &[0]), Value::Null);
    }
}
