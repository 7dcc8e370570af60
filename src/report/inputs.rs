//! What the page says of the inputs: their roles, their values, and of those that are drawn their distributions.

use crate::models::Input;
use crate::study::{Axis, Constraint, Probability, Study, UncertainInput, value_of};
use crate::table::{short, written};
use serde_json::{Value, json};

/// Every input with its role in the study, and its value if nothing varies it.
pub fn inputs(study: &Study) -> Vec<Value> {
    study.model.inputs.iter().enumerate().map(|(number, input)| described(study, number, input)).collect()
}

fn described(study: &Study, number: usize, input: &Input) -> Value {
    let mut described = json!({
        "name": input.name, "unit": input.unit.symbol, "symbol": input.symbol, "doc": input.doc, "only_for": input.only_for,
    });
    let drive = study.probability.as_deref().map(|it| &it.drive);
    let of_drive = drive.and_then(|it| Some((&it.operation[..], it.model.input(&input.name)?)));
    let axes = [("design", &study.design[..]), ("operation", &study.operation), ("uncertainty", &study.uncertainty)];
    let axes = axes.map(|(role, axes)| (role, axes, number));
    let axes = axes.into_iter().chain(of_drive.map(|(axes, number)| ("operation", axes, number)));
    let found = axes.filter_map(|(role, axes, number)| Some((role, column_of(axes, number)?))).next();
    if let Some((role, (axis, column))) = found {
        (described["role"], described["over"]) = (role.into(), over(input, axis, column).into());
        let (least, largest) = axis.ends(column);
        // Rows of a catalogue, and a choice between two, are no range that has ends.
        let is_range = role != "design" || axis.is_range();
        if role == "design" && study.labels_of(axis).next().is_some() {
            described["labelled"] = true.into();
        }
        if is_range && !input.is_enumeration() && input.word_for(least).is_none() && input.word_for(largest).is_none() {
            (described["least"], described["largest"]) = (least.into(), largest.into());
        }
    } else if let Some(law) = law_of(study.probability.as_deref(), &input.name) {
        (described["role"], described["over"]) = ("drawn".into(), law.as_given().into());
        described["drawn"] = law.in_words().into();
        // Where a picture needs one value: what is in the middle of the draws.
        let middle = law.distribution.mean();
        described["value"] = value_of(&study.model, number, law.effect.of(study.fixed[number], middle));
    } else {
        (described["role"], described["value"]) = ("fixed".into(), value_of(&study.model, number, study.fixed[number]));
    }
    described
}

/// Most numbers and texts that a page holds of the design axes.
const MOST_LEVELS: u64 = 20_000;

/// The levels of the design axes, with which a page knows what the number of a design stands for: of each axis how many it has, and of
/// every input and label their values. `null` where a number stands for a sampled design, or if they would be too many.
pub fn axes(study: &Study) -> Value {
    let width = |axis: &Axis| (axis.inputs().len() + study.labels_of(axis).count()) as u64;
    if study.sample.is_some() || study.design.iter().map(|axis| axis.count() * width(axis)).sum::<u64>() > MOST_LEVELS {
        return Value::Null;
    }
    let of_axis = |axis: &Axis| {
        let of_input = |(column, &input): (usize, &usize)| {
            let values: Vec<Value> = (0..axis.count()).map(|level| value_of(&study.model, input, axis.value(column, level))).collect();
            json!({ "name": study.model.inputs[input].name, "values": values })
        };
        let labels = study.labels_of(axis).map(|label| json!({ "name": label.name, "values": label.texts }));
        let columns: Vec<Value> = labels.chain(axis.inputs().iter().enumerate().map(of_input)).collect();
        json!({ "count": axis.count(), "columns": columns })
    };
    study.design.iter().map(of_axis).collect()
}

/// The distribution of an input, or of its tolerance.
fn law_of<'p>(probability: Option<&'p Probability>, name: &str) -> Option<&'p UncertainInput> {
    probability?.inputs.iter().find(|it| it.name == name)
}

fn column_of(axes: &[Axis], input: usize) -> Option<(&Axis, usize)> {
    axes.iter().find_map(|axis| Some((axis, axis.inputs().iter().position(|&it| it == input)?)))
}

/// The values that an axis gives an input, as text: its ends, or its words.
fn over(input: &Input, axis: &Axis, column: usize) -> String {
    let (least, largest) = axis.ends(column);
    if input.is_enumeration() {
        let mut words: Vec<_> = (0..axis.count()).map(|level| written(input, axis.value(column, level))).collect();
        words.dedup();
        return words.join(", ");
    }
    // The last of many steps may end in digits of rounding.
    let text = |value: f64| if input.word_for(value).is_some() { written(input, value) } else { short(value) };
    if least == largest { text(least) } else { format!("{} to {}", text(least), text(largest)) }
}

/// What every draw must keep, in how many operating cases, and how many draws there are; `null` without distributions.
pub fn drawn(study: &Study) -> Value {
    let Some(probability) = study.probability.as_deref() else { return Value::Null };
    let drive = &probability.drive;
    let constraint = |it: &Constraint| json!({ "of": it.name(&drive.model), "bounds": it.in_words(), "unit": drive.unit_of(it) });
    json!({
        "draws": probability.draws, "confirm": probability.confirm,
        "cases": drive.operation.iter().map(Axis::count).product::<u64>(),
        "constraints": drive.constraints.iter().map(constraint).collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::study_of;

    #[test]
    fn a_designs_number_is_told_by_its_axes() {
        let text = "[design]\ncases = [{ band_count = 6, band_thickness_mm = 0.2 }, { band_count = 9, band_thickness_mm = 0.15 }]\n\
                    groove_angle_deg = [20, 22, 24]\n[objectives]\naxial_force_N = \"min\"\n";
        let model = crate::models::find("metal-cvt").expect("it is a model");
        let plan = crate::plan::Plan::new(study_of(&model, text).expect("the study is right"));
        let axes = axes(&plan.study);
        for design in 0..plan.designs() {
            let (inputs, mut rest) = (plan.space.inputs(design, 0), design);
            for axis in axes.as_array().expect("a list").iter().rev() {
                let count = axis["count"].as_u64().expect("a count");
                for column in axis["columns"].as_array().expect("a list") {
                    let input = model.input(column["name"].as_str().expect("a name")).expect("an input");
                    let level = usize::try_from(rest % count).expect("it is small");
                    assert_eq!(column["values"][level].as_f64(), Some(inputs[input]), "design {design}: {column}");
                }
                rest /= count;
            }
            assert_eq!(rest, 0);
        }
        // A sampled design's number says nothing of its levels.
        let sampled = "[design]\ngroove_angle_deg = { from = 20, to = 24 }\n[sample]\nmethod = \"latin-hypercube\"\ncount = 1000\nseed = 7\n[objectives]\naxial_force_N = \"min\"\n";
        let sampled = study_of(&model, sampled).unwrap_or_else(|error| panic!("{error:?}"));
        assert_eq!(super::axes(&sampled), Value::Null);
    }

    #[test]
    fn only_ranges_have_ends() {
        let text = "[design]\ncases = [{ band_count = 6, band_thickness_mm = 0.2 }, { band_count = 9, band_thickness_mm = 0.15 }]\n\
                    strength_MPa = [800, 900]\ngroove_angle_deg = [20, 22, 24]\n[operation]\ntorque_Nm = [50, 100]\n[objectives]\naxial_force_N = \"min\"\n";
        let study = study_of(&crate::models::find("metal-cvt").expect("it is a model"), text).expect("the study is right");
        let ends: Vec<_> = inputs(&study)
            .iter()
            .filter_map(|it| Some((it["name"].as_str()?.to_owned(), it.get("least")?.as_f64()?, it["largest"].as_f64()?)))
            .collect();
        let of = |name: &str, least: f64, largest: f64| (name.to_owned(), least, largest);
        assert_eq!(ends.len(), 2, "{ends:?}");
        assert!(ends.contains(&of("groove_angle_deg", 20.0, 24.0)) && ends.contains(&of("torque_Nm", 50.0, 100.0)), "{ends:?}");
    }
}
