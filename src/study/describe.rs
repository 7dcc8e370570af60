//! The resolved study in words and names: `study.json`, the study's hash, and what changed between two studies.

use super::drawn::{Drive, Probability, Statistic, StatisticKind};
use super::read::shown;
use super::{
    Axis, Best, Constraint, ContourSpec, Goal, Levels, Objective, OverScenarios, Quantity, ReportColumn, Spectrum, Study, Thresholds,
};
use crate::error::brief;
use crate::models::{CurveSource, Extension, FormulaSource, Model};
use crate::probability::{Effect, Sampling};
use serde_json::{Map, Value, json};
use sha2::{Digest, Sha256};

impl Study {
    /// Everything that the study asks for, by name and in units; arrays where the order matters.
    #[doc(hidden)]
    pub fn describe(&self) -> Value {
        let model = &self.model;
        let taken: Vec<usize> =
            [&self.design, &self.operation, &self.uncertainty].into_iter().flatten().flat_map(Axis::inputs).copied().collect();
        let fixed: Map<_, _> = (0..model.inputs.len())
            .filter(|input| !taken.contains(input))
            .map(|input| (model.inputs[input].name.to_owned(), value_of(model, input, self.fixed[input])))
            .collect();
        let axes = |axes: &[Axis]| Value::from(axes.iter().map(|axis| axis_of(model, axis)).collect::<Vec<_>>());
        let axis_name = |axis: usize| model.inputs[self.design[axis].inputs()[0]].name.as_str();
        let report = &self.report;
        let mut described = json!({
            "model": model.name,
            "title": self.title,
            "design": self.design.iter().enumerate().map(|(number, axis)| self.design_axis(number, axis)).collect::<Vec<_>>(),
            "sample": self.sample,
            "operation": axes(&self.operation),
            "uncertainty": axes(&self.uncertainty),
            "fixed": fixed,
            "constraints": self.constraints.iter().map(|it| constraint_of(model, it)).collect::<Vec<_>>(),
            "objectives": self.objectives.iter().map(|it| objective_of(model, it)).collect::<Vec<_>>(),
            "columns": report.columns.iter().map(|it| column_of(model, it)).collect::<Vec<_>>(),
            "top": report.top.map(|top| json!({ "by": top.by.name(model), "goal": top.goal, "count": top.count })),
            "histograms": report.histograms.iter().map(|it| {
                json!({ "of": it.of.name(model), "from": it.range.map(|it| it.0), "to": it.range.map(|it| it.1), "bins": it.bins })
            }).collect::<Vec<_>>(),
            "maps": report.maps.iter().map(|map| {
                let (value, best) = match map.value {
                    Best::Value(quantity, Goal::Min) => (Some(quantity.name(model)), "min"),
                    Best::Value(quantity, Goal::Max) => (Some(quantity.name(model)), "max"),
                    Best::Share => (None, "share"),
                };
                let mut described = json!({ "x": axis_name(map.x), "y": axis_name(map.y), "value": value, "best": best });
                    // Without contours a map is described as before there were any, so that hashes of older studies stay the same.
                if !map.contours.is_empty() {
                    described["contours"] = map.contours.iter().map(|it| contours_of(model, it)).collect();
                }
                described
            }).collect::<Vec<_>>(),
            "front_budget": report.front_budget,
        });
        // Likewise: the hash changes only if this is used.
        if let Some(sample) = report.sample {
            described["feasible_sample"] = json!({ "count": sample.count, "seed": sample.seed });
        }
        if let Some(it) = &self.spectrum {
            described["spectrum"] = spectrum_of(it);
        }
        if let Some(it) = &self.probability {
            described["probability"] = probability_of(it);
        }
        if report.variants {
            described["variants"] = true.into();
        }
        if report.feasible {
            described["feasible"] = true.into();
        }
        if let Some(it) = &report.sensitivity {
            described["sensitivity"] = json!({ "over": it.over, "of": it.of, "draws": it.draws });
        }
        let mut part = model.origin.as_ref();
        while let Some(origin) = part {
            match &origin.extension.file {
                Some(file) => described["model_file"] = model_file_of(&origin.extension, &file.text),
                None => describe_extension(&origin.extension, &mut described),
            }
            part = origin.base.origin.as_ref();
        }
        if !model.version.is_empty() {
            described["model_version"] = model.version.clone().into();
        }
        described
    }

    /// A design axis with its labels, if it has some.
    fn design_axis(&self, number: usize, axis: &Axis) -> Value {
        let mut described = axis_of(&self.model, axis);
        let own = self.labels.iter().filter(|it| it.axis == number);
        let own: Vec<_> = own.map(|it| json!({ "name": it.name, "texts": it.texts })).collect();
        if !own.is_empty() {
            described["labels"] = own.into();
        }
        described
    }

    /// A hash of what the study asks for: the same for two files that differ in comments and layout only.
    pub fn hash(&self) -> String {
        let digest = Sha256::digest(self.describe().to_string());
        digest.iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

/// What is drawn, the drive of a draw, and what is asked of the draws.
fn probability_of(it: &Probability) -> Value {
    let Drive { model, operation, spectrum, constraints } = &it.drive;
    let inputs = it.inputs.iter().map(|it| {
        let effect = match it.effect {
            Effect::Is => "is",
            Effect::Times => "times",
            Effect::Plus => "plus",
        };
        json!({ "input": it.name, "effect": effect, "distribution": it.law })
    });
    let pair = |&(a, b, value): &(usize, usize, f64)| json!([it.inputs[a].name, it.inputs[b].name, value]);
    let method = match it.sampling {
        Sampling::Random => "random",
        Sampling::LatinHypercube { .. } => "latin-hypercube",
        Sampling::Sobol { .. } => "sobol",
    };
    let mut described = json!({
        "inputs": inputs.collect::<Vec<_>>(),
        "correlation": it.correlation.iter().map(pair).collect::<Vec<_>>(),
        "draws": it.draws,
        "confirm": it.confirm,
        "seed": it.seed,
        "method": method,
        "levels": it.levels,
        "enclosure": it.enclosure,
        "operation": operation.iter().map(|axis| axis_of(model, axis)).collect::<Vec<_>>(),
        "constraints": constraints.iter().map(|it| constraint_of(model, it)).collect::<Vec<_>>(),
        "statistics": it.statistics.iter().map(|it| statistic_of(model, it)).collect::<Vec<_>>(),
    });
    if let Some(spectrum) = spectrum {
        described["spectrum"] = spectrum_of(spectrum);
    }
    described
}

fn statistic_of(model: &Model, statistic: &Statistic) -> Value {
    let mut described = json!({ "name": statistic.name });
    let (asked, draws) = match statistic.kind {
        StatisticKind::Yield => return described,
        StatisticKind::Confirmed(end) => {
            described["confirmed"] = json!(end);
            return described;
        }
        StatisticKind::YieldOf(constraint) => {
            described["yield_of"] = constraint_of(model, &constraint);
            return described;
        }
        StatisticKind::Plain(asked) => (asked, None),
        StatisticKind::Over(asked, draws) => (asked, Some(draws)),
    };
    described["of"] = asked.quantity.name(model).into();
    described["worst"] = asked.worse.word().into();
    describe_over(asked.over, &mut described);
    if let Some(draws) = draws {
        described["over_draws"] = json!(draws);
    }
    described
}

fn spectrum_of(it: &Spectrum) -> Value {
    let weights: Vec<_> = it.weights.iter().map(|&weight| number(weight)).collect();
    json!({ "axis": it.axis, "name": it.name, "weight": it.weight, "unit": it.unit, "weights": weights })
}

/// What a study adds to its model: units, variables, curves with their points, and formulas, each in the order of the file.
fn describe_extension(extension: &Extension, described: &mut Value) {
    let Extension { units, variables, curves, formulas, .. } = extension;
    let parts = [
        ("units", json!(units)),
        ("variables", json!(variables)),
        ("curves", curves.iter().map(curve_of).collect()),
        ("formulas", formulas.iter().map(formula_of).collect()),
    ];
    for (key, part) in parts {
        if part.as_array().is_some_and(|list| !list.is_empty()) {
            described[key] = part;
        }
    }
}

fn curve_of(curve: &CurveSource) -> Value {
    json!({ "name": curve.name, "x": curve.x, "y": curve.y, "points": curve.points })
}

/// A formula: name and text, and whatever else is said of it.
fn formula_of(formula: &FormulaSource) -> Value {
    let FormulaSource { name, text, worst, integer, hidden, symbol, doc, source } = formula;
    let mut described = json!({ "name": name, "is": text });
    if let Some(worst) = worst {
        described["worst"] = worst.word().into();
    }
    for (key, said) in [("integer", integer), ("hidden", hidden)] {
        if *said {
            described[key] = true.into();
        }
    }
    for (key, said) in [("symbol", symbol), ("doc", doc), ("source", source)] {
        if !said.is_empty() {
            described[key] = said.clone().into();
        }
    }
    described
}

/// The file of a model: its text, and the points of its curves, which stand in files of their own.
fn model_file_of(extension: &Extension, text: &str) -> Value {
    json!({ "text": text, "curves": extension.curves.iter().map(curve_of).collect::<Vec<_>>() })
}

/// Most differing entries of a list that are reported.
const MOST_DIFFERENCES: usize = 10;

/// A part in which two descriptions differ.
fn told(name: &str, was: &Value, is: &Value) -> String {
    format!("{}: was {}, is {}", brief(name), brief(&was.to_string()), brief(&is.to_string()))
}

/// The parts in which two descriptions differ, as `name: was ..., is ...`.
pub fn differences(was: &Value, is: &Value) -> Vec<String> {
    let empty = Map::new();
    let (was, is) = (was.as_object().unwrap_or(&empty), is.as_object().unwrap_or(&empty));
    let mut changed = Vec::new();
    let names: std::collections::BTreeSet<_> = was.keys().chain(is.keys()).collect();
    for name in names {
        let (was, is) = (&was.get(name).unwrap_or(&Value::Null), &is.get(name).unwrap_or(&Value::Null));
        if was == is {
            continue;
        }
        // Of a list only the entries that differ are worth reading.
        match (was.as_array(), is.as_array()) {
            (Some(was), Some(is)) if was.len() == is.len() => {
                changed
                    .extend(was.iter().zip(is).filter(|(was, is)| was != is).take(MOST_DIFFERENCES).map(|(was, is)| told(name, was, is)));
            }
            _ => changed.push(told(name, was, is)),
        }
    }
    changed
}

/// A value as people write it: a number, or the input's word.
pub fn value_of(model: &Model, input: usize, value: f64) -> Value {
    model.inputs[input].word_for(value).map_or_else(|| number(value), Value::from)
}

/// A number without a needless ".0".
#[allow(clippy::cast_possible_truncation, reason = "whole numbers below 2^53 are exact")]
pub fn number(value: f64) -> Value {
    if value.fract() == 0.0 && value.abs() < 9e15 { Value::from(value as i64) } else { Value::from(value) }
}

fn axis_of(model: &Model, axis: &Axis) -> Value {
    match axis {
        Axis::Single { input, levels } => {
            let name = &model.inputs[*input].name;
            let spacing = |log: bool| if log { "log" } else { "linear" };
            match levels {
                Levels::List(values) => {
                    json!({ "input": name, "values": values.iter().map(|&it| value_of(model, *input, it)).collect::<Vec<_>>() })
                }
                Levels::Even { from, to, count, log } => {
                    json!({ "input": name, "from": number(*from), "to": number(*to), "count": count, "spacing": spacing(*log) })
                }
                Levels::Step { from, step, count, log } => {
                    json!({ "input": name, "from": number(*from), "step": number(*step), "count": count, "spacing": spacing(*log) })
                }
                Levels::Continuous { from, to, log } => {
                    json!({ "input": name, "from": number(*from), "to": number(*to), "spacing": spacing(*log) })
                }
            }
        }
        Axis::Joint { inputs, rows } => {
            let row = |row: &Vec<f64>| -> Value { inputs.iter().zip(row).map(|(&input, &value)| value_of(model, input, value)).collect() };
            let names: Vec<_> = inputs.iter().map(|&input| model.inputs[input].name.as_str()).collect();
            json!({ "inputs": names, "rows": rows.iter().map(row).collect::<Vec<_>>() })
        }
    }
}

fn constraint_of(model: &Model, constraint: &Constraint) -> Value {
    let mut value = json!({ "of": constraint.quantity.name(model) });
    for (bound, inclusive, exclusive) in [(constraint.low, "min", "above"), (constraint.high, "max", "below")] {
        if let Some((bound, excluded)) = bound {
            value[if excluded { exclusive } else { inclusive }] = number(bound);
        }
    }
    describe_over(constraint.over, &mut value);
    value
}

fn objective_of(model: &Model, objective: &Objective) -> Value {
    let mut value = json!({ "of": objective.quantity.name(model), "goal": objective.goal, "resolution": objective.resolution });
    describe_over(objective.over, &mut value);
    value
}

/// A column that only has a name is described by that name, as before there was more to say.
fn column_of(model: &Model, column: &ReportColumn) -> Value {
    let name = column.of.name(model);
    if *column == ReportColumn::from(column.of) {
        return name.into();
    }
    let mut value = json!({ "of": name });
    describe_over(column.over, &mut value);
    if let Some(worst) = column.worst {
        value["worst"] = worst.word().into();
    }
    value
}

/// The hash changes only if something else than the worst is asked for.
fn describe_over(over: OverScenarios, value: &mut Value) {
    if !over.is_worst() {
        value["over_scenarios"] = over.word().into();
    }
}

fn contours_of(model: &Model, contours: &ContourSpec) -> Value {
    let at = match &contours.at {
        Thresholds::At(values) => values.iter().map(|&value| number(value)).collect(),
        Thresholds::Changes => Value::from("every change"),
    };
    json!({ "of": contours.of.name(model), "at": at })
}

impl Constraint {
    /// The bounds in words, such as `at least 0 and at most 30000`.
    pub fn in_words(&self) -> String {
        let low = self.low.map(|(bound, excluded)| format!("{} {}", if excluded { "above" } else { "at least" }, shown(bound)));
        let high = self.high.map(|(bound, excluded)| format!("{} {}", if excluded { "below" } else { "at most" }, shown(bound)));
        low.into_iter().chain(high).collect::<Vec<_>>().join(" and ")
    }
}

impl Quantity {
    /// Its unit's symbol.
    pub fn unit(self, model: &Model) -> &'static str {
        match self {
            Self::Input(input) => model.inputs[input].unit.symbol,
            Self::Output(output) => model.outputs[output].unit.symbol,
        }
    }

    /// What it is, in a sentence.
    pub fn doc(self, model: &Model) -> &str {
        match self {
            Self::Input(input) => &model.inputs[input].doc,
            Self::Output(output) => &model.outputs[output].doc,
        }
    }
}
