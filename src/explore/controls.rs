//! What can be changed on the page, and between which ends: constraints, objectives, axes, and single values.
//!
//! Each control names the part of the study that it changes, as `--set` takes it.

use crate::certify::{self, margin_columns};
use crate::error::Result;
use crate::live::given::{ends_of_fixed, fixed_inputs, slider_ends};
use crate::models::{Input, Model};
use crate::plan::Plan;
use crate::screen::Control;
use crate::study::{Axis, Constraint, Drive, Goal, Levels, Study, entry_leaves, entry_names, number, quoted_key, value_of};
use crate::table::written;
use serde_json::{Map, Value, json};

/// Designs that tell which values a constraint meets.
const SEEN: u64 = 32;
/// What a study file calls the share of draws that hold.
const YIELD: &str = "yield";
/// Most values of a list, and of rows, that can be changed.
const MOST_VALUES: usize = 1000;
const MOST_CELLS: usize = 400;

/// The controls of a study as its file has it.
///
/// # Errors
/// [`Error::Stopped`](crate::error::Error::Stopped) after `control.stop`.
pub fn controls(plan: &Plan, text: &str, threads: usize, control: &Control) -> Result<Value> {
    let study = &plan.study;
    let axes = |table: &str, axes: &[Axis]| -> Vec<Value> { axes.iter().map(|axis| axis_control(study, text, table, axis)).collect() };
    Ok(json!({
        "constraints": constraints(plan, text, threads, control)?,
        "objectives": objectives(study, text),
        "operation": axes("operation", study.operating()),
        "uncertainty": axes("uncertainty", &study.uncertainty),
        "design": axes("design", &study.design),
        "fixed": fixed(study, &entry_names(text, "fixed")),
        "formulas": entry_names(text, "formulas"),
        "drawn": drawn(study, text),
    }))
}

/// The distributions of a study and the number of draws, each with what can be set of it.
fn drawn(study: &Study, text: &str) -> Vec<Value> {
    let Some(probability) = &study.probability else { return Vec::new() };
    let names = probability.inputs.iter().map(|it| (it.name.as_str(), format!("uncertainty.{}", it.name)));
    let laws = names.map(|(name, part)| {
        let model = &probability.drive.model;
        let input = model.input(name).map(|it| &model.inputs[it]);
        let numbers: Vec<_> = entry_leaves(text, "uncertainty", name).into_iter().filter(|(_, value)| value.is_number()).collect();
        let law = numbers.first().map_or_else(String::new, |(keys, _)| keys[..keys.len() - 1].join(" "));
        let fields = numbers.iter().map(|(keys, value)| {
            let last = keys.last().map_or("", String::as_str);
            let label = if last.parse::<usize>().is_ok() { format!("value {last}") } else { last.to_owned() };
            json!({ "part": format!("{part}.{}", keys.join(".")), "label": label, "value": value })
        });
        json!({
            "law": law, "name": name, "unit": input.map_or("", |it| it.unit.symbol), "doc": input.map_or("", |it| &it.doc),
            "fields": fields.collect::<Vec<_>>(),
        })
    });
    let draws = json!({
        "law": "", "name": "draws", "unit": "", "doc": "How many draws choose designs.",
        "fields": [{ "part": "probability.draws", "label": "number", "value": probability.draws, "low": 256, "high": (4 * probability.draws).max(1024), "integer": true }],
    });
    laws.chain([draws]).collect()
}

/// Each constraint with its bounds, and with what it meets among designs from all over the study.
fn constraints(plan: &Plan, text: &str, threads: usize, control: &Control) -> Result<Vec<Value>> {
    let study = &plan.study;
    let names = entry_names(text, "constraints");
    if let Some(probability) = &study.probability {
        return Ok(of_draws(study, &probability.drive, text, &names));
    }
    if names.len() != study.constraints.len() {
        return Ok(Vec::new());
    }
    let designs: Vec<u64> = (0..SEEN.min(plan.designs())).map(|step| plan.design_at(plan.spread(step))).collect();
    let rows = certify::rows(plan, &margin_columns(study), &designs, threads, control)?;
    let each = study.constraints.iter().zip(names).enumerate().map(|(at, (constraint, name))| {
        let values = rows.iter().filter_map(|row| row.columns[at].value).filter(|it| it.is_finite());
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), it| (low.min(it), high.max(it)));
        let unit = study.unit_over(constraint.quantity, constraint.over);
        bound_control(&study.model, constraint, &name, &unit, [finite(low), finite(high)])
    });
    Ok(each.collect())
}

/// Of a study with distributions: what every draw must keep, and how many draws must.
fn of_draws(study: &Study, drive: &Drive, text: &str, names: &[String]) -> Vec<Value> {
    let each = names.iter().filter_map(|name| {
        let own = entry_leaves(text, "constraints", name);
        let given = own.iter().find(|(keys, _)| *keys == ["of"]).and_then(|(_, of)| of.as_str());
        let asked = given.unwrap_or(name);
        let of = |model: &Model, constraints: &'_ [Constraint]| {
            let mut found = constraints.iter().filter(|it| it.name(model) == asked);
            // Of two on the same quantity it cannot be told which is which.
            found.next().filter(|_| found.next().is_none()).copied()
        };
        if let Some(constraint) = of(&drive.model, &drive.constraints) {
            return Some(bound_control(&drive.model, &constraint, name, &drive.unit_of(&constraint), [Value::Null, Value::Null]));
        }
        // The yield of the file is bounded as that of the draws that choose designs, which has a name of its own.
        let constraint = of(&study.model, &study.constraints).or_else(|| match &study.constraints[..] {
            [only] if asked == YIELD => Some(*only),
            _ => None,
        })?;
        Some(bound_control(&study.model, &constraint, name, "", [number(0.5), number(1.0)]))
    });
    each.collect()
}

fn bound_control(model: &Model, constraint: &Constraint, name: &str, unit: &str, [low, high]: [Value; 2]) -> Value {
    let mut bounds = Map::new();
    for (bound, inclusive, exclusive) in [(constraint.low, "min", "above"), (constraint.high, "max", "below")] {
        if let Some((bound, excluded)) = bound {
            bounds.insert(if excluded { exclusive } else { inclusive }.to_owned(), number(bound));
        }
    }
    json!({
        "part": format!("constraints.{}", quoted_key(name)), "name": name, "of": constraint.name(model), "unit": unit,
        "doc": constraint.quantity.doc(model), "bounds": bounds, "low": low, "high": high,
    })
}

fn finite(value: f64) -> Value {
    if value.is_finite() { number(value) } else { Value::Null }
}

fn objectives(study: &Study, text: &str) -> Vec<Value> {
    let names = entry_names(text, "objectives");
    let each = study.objectives.iter().zip(names).map(|(it, name)| {
        json!({
            "part": format!("objectives.{name}"), "name": name, "goal": if it.goal == Goal::Min { "min" } else { "max" },
            // What is written as a table has a key for it.
            "plain": entry_leaves(text, "objectives", &name).iter().all(|(keys, _)| keys.is_empty()),
            "doc": it.quantity.doc(&study.model), "unit": study.unit_over(it.quantity, it.over),
        })
    });
    each.collect()
}

fn axis_control(study: &Study, text: &str, table: &str, axis: &Axis) -> Value {
    let model = &study.model;
    let names: Vec<&str> = axis.inputs().iter().map(|&input| model.inputs[input].name.as_str()).collect();
    let (Axis::Single { input, levels }, false) = (axis, axis.inputs().len() != 1) else {
        // Rows of a catalogue go by their labels.
        let labels: Vec<&str> = study.labels_of(axis).map(|it| it.name.as_str()).collect();
        let name = if labels.is_empty() { &names } else { &labels }.join(", ");
        let told = json!({ "form": "rows", "name": name, "rows": axis.count(), "table": table });
        return rows_control(study, text, table, &names).unwrap_or(told);
    };
    let described = &model.inputs[*input];
    let mut control = described_input(described);
    control["part"] = format!("{table}.{}", described.name).into();
    control["table"] = table.into();
    let (least, largest) = levels.ends();
    let of_range = |control: &mut Value, from: f64, to: f64, log: bool| {
        (control["form"], control["from"], control["to"], control["log"]) = ("range".into(), number(from), number(to), log.into());
    };
    match levels {
        Levels::List(values) => {
            let is_short = values.len() <= MOST_VALUES;
            control["form"] = if is_short { "list" } else { "rows" }.into();
            control["rows"] = values.len().into();
            control["values"] = if is_short { values.iter().map(|&it| value_of(model, *input, it)).collect() } else { Value::Null };
        }
        Levels::Even { from, to, count, log } => {
            of_range(&mut control, *from, *to, *log);
            control["count"] = (*count).into();
        }
        Levels::Step { from, step, count, log } => {
            of_range(&mut control, *from, levels.value(count - 1), *log);
            control["count"] = (*count).into();
            // Steps of a logarithmic axis are factors: its ends move in levels.
            control["step"] = if *log { Value::Null } else { number(*step) };
        }
        Levels::Continuous { from, to, log } => of_range(&mut control, *from, *to, *log),
    }
    span(&mut control, described, least, largest);
    control
}

/// The rows of an axis that sets these inputs, if they stand in the file and are not too many: the keys of each row with its values.
fn rows_control(study: &Study, text: &str, table: &str, names: &[&str]) -> Option<Value> {
    let model = &study.model;
    entry_names(text, table).into_iter().find_map(|entry| {
        let cells = entry_leaves(text, table, &entry);
        let mut columns: Vec<&str> = Vec::new();
        for (keys, _) in &cells {
            let [_, column] = keys.as_slice() else { return None };
            if !columns.contains(&column.as_str()) {
                columns.push(column);
            }
        }
        if !names.iter().all(|name| columns.contains(name)) || cells.len() > MOST_CELLS {
            return None;
        }
        let last = cells.last().and_then(|(keys, _)| keys[0].parse::<usize>().ok())?;
        let mut rows = vec![Map::new(); last];
        for (keys, value) in &cells {
            rows[keys[0].parse::<usize>().ok()? - 1].insert(keys[1].clone(), value.clone());
        }
        let described = |name: &&str| model.input(name).map_or_else(|| json!({ "name": name }), |it| described_input(&model.inputs[it]));
        Some(json!({
            "form": "table", "table": table, "part": format!("{table}.{entry}"), "name": names.join(", "), "rows": rows,
            "columns": columns.iter().map(described).collect::<Vec<_>>(),
        }))
    })
}

fn described_input(input: &Input) -> Value {
    json!({
        "name": input.name, "unit": input.unit.symbol, "symbol": input.symbol, "doc": input.doc, "integer": input.integer,
        "words": input.words.iter().map(|(word, _)| word).collect::<Vec<_>>(), "only_words": input.is_enumeration(),
    })
}

/// Between which ends a slider runs.
fn span(control: &mut Value, input: &Input, least: f64, largest: f64) {
    let (low, high) = slider_ends(input, least, largest);
    (control["low"], control["high"]) = (finite(low), finite(high));
}

/// Every input that has one value; those that the file gives come first.
fn fixed(study: &Study, given: &[String]) -> Vec<Value> {
    let model = &study.model;
    let mut controls: Vec<Value> = fixed_inputs(study)
        .map(|number_of| {
            let input = &model.inputs[number_of];
            let value = study.fixed[number_of];
            let mut control = described_input(input);
            control["part"] = input.name.clone().into();
            control["form"] = "value".into();
            control["value"] = value_of(model, number_of, value);
            control["shown"] = written(input, value).into();
            control["given"] = given.contains(&input.name).into();
            let (low, high) = ends_of_fixed(study, number_of);
            (control["low"], control["high"]) = (finite(low), finite(high));
            control
        })
        .collect();
    controls.sort_by_key(|control| control["given"] != true);
    controls
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shipped(name: &str) -> Value {
        let text = std::fs::read_to_string(format!("{}/studies/{name}.toml", env!("CARGO_MANIFEST_DIR"))).expect("a study");
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
        let study = Study::parse_in(&text, name, &folder).unwrap_or_else(|errors| panic!("{errors}"));
        controls(&Plan::new(study), &text, 2, &Control::default()).expect("controls")
    }

    #[test]
    fn what_every_draw_must_keep_has_sliders_too() {
        let told = shipped("push-belt-yield");
        let parts: Vec<_> =
            told["constraints"].as_array().expect("a list").iter().map(|it| (it["part"].clone(), it["bounds"].clone())).collect();
        let wanted = [
            ("constraints.slip_margin", json!({ "min": 0 })),
            ("constraints.stress_margin", json!({ "min": 0 })),
            ("constraints.axial_force_upper_N", json!({ "max": 75000 })),
            ("constraints.yield", json!({ "min": 0.999 })),
        ];
        assert_eq!(parts, wanted.map(|(part, bounds)| (json!(part), bounds)));
        assert_eq!(told["constraints"][2]["unit"], "N");
    }

    #[test]
    fn sliders_of_variables_go_beyond_what_the_file_gives() {
        let text = "model = \"metal-cvt\"\n[design]\nband_count = [6, 9]\n[operation]\nasked_Nm = [70, 150]\n[fixed]\nshare = 1.1\ntraction = 0.4\n\
                    [formulas]\ntorque_Nm = \"asked_Nm * share\"\n[objectives]\naxial_force_N = \"min\"\n";
        let study_of_text = |text: &str| Study::parse(text).unwrap_or_else(|errors| panic!("{errors}"));
        let study = study_of_text(text);
        let told = controls(&Plan::new(study.clone()), text, 2, &Control::default()).expect("controls");
        let ends = |control: &Value| (control["low"].as_f64().expect("a number"), control["high"].as_f64().expect("a number"));
        assert_eq!(ends(&told["operation"][0]), (0.0, 230.0));
        let share = told["fixed"].as_array().and_then(|all| all.iter().find(|it| it["name"] == "share")).expect("it is fixed");
        assert_eq!(ends(share), (0.0, 2.2));
    }

    #[test]
    fn rows_distributions_and_draws_have_parts_that_can_be_set() {
        let told = shipped("push-belt-yield");
        let cases = &told["operation"][0];
        assert_eq!((&cases["form"], &cases["part"]), (&json!("table"), &json!("operation.cases")));
        assert_eq!(cases["rows"][3], json!({ "asked_Nm": 150, "driver_speed_rpm": 4000, "ratio": 0.5 }));
        assert_eq!(cases["columns"][1]["unit"], "rpm");
        let parts: Vec<_> =
            told["drawn"].as_array().expect("a list").iter().flat_map(|it| it["fields"].as_array().expect("a list")).collect();
        let part = |name: &str| parts.iter().find(|it| it["part"] == name).map(|it| it["value"].clone());
        assert_eq!(part("uncertainty.friction.normal.mean"), Some(json!(0.08)));
        assert_eq!(part("uncertainty.belt_length_mm.plus.normal.sd"), Some(json!(0.3)));
        assert_eq!(part("uncertainty.torque_share.triangular.3"), Some(json!(1.05)));
        assert_eq!(part("probability.draws"), Some(json!(10000)));
        // Each of them can be set as it is.
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
        let text = std::fs::read_to_string(folder.join("push-belt-yield.toml")).expect("a study");
        let set: Vec<String> = parts.iter().map(|it| format!("{}={}", it["part"].as_str().expect("a text"), it["value"])).collect();
        let models = crate::models::Models::new();
        let (study, _) = Study::parse_set(&models, &text, "study.toml", &folder, &set).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(study.hash(), Study::parse_in(&text, "study.toml", &folder).expect("it is right").hash());
        // A design axis of rows has words in it; a catalogue in a file of its own has none that can be set.
        let told = shipped("pulley-design");
        assert_eq!(told["design"][0]["rows"][23]["section"], "pressed-cup");
        assert_eq!(shipped("catalogue-v-belts")["design"].as_array().expect("a list").iter().filter(|it| it["form"] == "rows").count(), 1);
    }

    #[test]
    fn a_constraint_of_draws_under_another_name_has_its_own_slider() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
        let text = std::fs::read_to_string(folder.join("push-belt-yield.toml")).expect("a study");
        let text = text.replace("slip_margin         = { min = 0 } ", "no_slip = { of = \"slip_margin\", min = 0 } ");
        let study = Study::parse_in(&text, "study.toml", &folder).unwrap_or_else(|errors| panic!("{errors}"));
        let told = controls(&Plan::new(study), &text, 2, &Control::default()).expect("controls");
        let parts: Vec<_> = told["constraints"].as_array().expect("a list").iter().map(|it| it["part"].clone()).collect();
        assert!(text.contains("no_slip") && parts.contains(&json!("constraints.no_slip")) && parts.len() == 4, "{parts:?}");
        let own = told["constraints"].as_array().expect("a list").iter().find(|it| it["name"] == "no_slip").expect("it is there");
        assert_eq!((&own["of"], &own["bounds"]), (&json!("slip_margin"), &json!({ "min": 0 })));
    }

    #[test]
    fn a_variable_of_the_study_has_a_slider_with_ends() {
        let told = shipped("push-belt-duty");
        let own = told["fixed"].as_array().expect("a list").iter().find(|it| it["name"] == "endurance_MPa").expect("a variable");
        let value = own["value"].as_f64().expect("a number");
        for end in ["low", "high"] {
            // Without an end the page takes one as far from the value as that is from zero.
            assert!(own[end].as_f64().is_none_or(|it| it.abs() < 1e3 * value), "{own}");
        }
    }
}
