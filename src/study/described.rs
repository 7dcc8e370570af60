//! Restores a study from [`Study::describe`], so that a result directory is enough even without the study file and its tables.

use super::drawn::{AskedQuantity, Drive, LawText, OverDraws, Probability, REPLICATES, Statistic, StatisticKind, UncertainInput};
use super::read::{CurvePoints, ModelText, read_model_text};
use super::{
    Axis, Best, Constraint, ContourSpec, Goal, HistogramSpec, Label, Levels, MapSpec, Objective, OverScenarios, Quantity, Report,
    ReportColumn, SampleSpec, SensitivitySpec, Spectrum, Study, Thresholds, TopSpec,
};
use crate::models::{CurveSource, Extension, FormulaSource, Model, ModelTolerance, Models, Worse, extended};
use crate::probability::{Effect, Sampling};
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::sync::Arc;

type Restored<T> = Result<T, String>;

impl Study {
    /// Restores the study of a description, such as a result's `study.json`. Described again it gives the same description.
    ///
    /// # Errors
    /// The first thing that is missing, or is not what a description has there.
    #[doc(hidden)]
    pub fn from_description(described: &Value) -> Result<Self, String> {
        Self::from_description_with(&Models::new(), described)
    }

    /// The same where the model is one of these.
    ///
    /// # Errors
    /// As [`Study::from_description`].
    #[doc(hidden)]
    pub fn from_description_with(models: &Models, described: &Value) -> Result<Self, String> {
        let name = text(described, "model")?;
        let model = match &described["model_file"] {
            Value::Null => models.find(name).ok_or_else(|| format!("there is no model \"{name}\""))?,
            file => model_of_file(models, name, file)?,
        };
        let extension = extension_of(described)?;
        let model = if extension == Extension::default() {
            model
        } else {
            Arc::new(extended(&model, extension).map_err(|_| "\"formulas\" do not fit the model")?)
        };
        let probability = match &described["probability"] {
            Value::Null => None,
            described => Some(Arc::new(probability_of(&model, described)?)),
        };
        let model = match &probability {
            None => model,
            Some(it) => Arc::new(it.model()?),
        };
        let axes = |role: &str| list(described, role)?.iter().map(|axis| axis_of(&model, axis)).collect::<Restored<Vec<_>>>();
        let mut fixed = model.defaults();
        for (name, value) in described["fixed"].as_object().ok_or("\"fixed\" is missing")? {
            let input = input_of(&model, name)?;
            fixed[input] = value_of(&model, input, value)?;
        }
        let study = Self {
            model: model.clone(),
            title: text(described, "title")?.to_owned(),
            design: axes("design")?,
            labels: labels_of(list(described, "design")?)?,
            sample: plain(&described["sample"], "sample")?,
            operation: axes("operation")?,
            spectrum: spectrum_of(&described["spectrum"])?,
            uncertainty: axes("uncertainty")?,
            probability,
            fixed,
            constraints: each(described, "constraints", |it| constraint_of(&model, it))?,
            objectives: each(described, "objectives", |it| {
                Ok(Objective {
                    quantity: quantity_of(&model, &it["of"])?,
                    goal: plain(&it["goal"], "goal")?,
                    resolution: plain(&it["resolution"], "resolution")?,
                    over: over_of(it)?,
                })
            })?,
            report: Report::default(),
            left_out: Vec::new(),
            short_ranges: Vec::new(),
        };
        let report = report_of(&study, described)?;
        let study = Self { report, ..study };
        study.check()?;
        // If this version would describe it otherwise, another version has written it.
        match super::differences(described, &study.describe()).first() {
            None => Ok(study),
            Some(difference) => Err(difference.clone()),
        }
    }
}

/// What is drawn, the drive of a draw, and what is asked of the draws.
fn probability_of(model: &Arc<Model>, described: &Value) -> Restored<Probability> {
    let input = |it: &Value| {
        let name = text(it, "input")?;
        let effect = match text(it, "effect")? {
            "is" => Effect::Is,
            "times" => Effect::Times,
            "plus" => Effect::Plus,
            other => return Err(format!("a drawn number cannot have the effect \"{other}\"")),
        };
        let law: LawText = plain(&it["distribution"], "distribution")?;
        let distribution = law.distribution().map_err(|problem| format!("{name}: {problem}"))?;
        let change = ModelTolerance { of: name, effect }.change();
        let in_model = effect != Effect::Is && model.origin.as_ref().is_some_and(|it| it.extension.has_nominal(name));
        let input = input_of(model, if in_model { &change } else { name })?;
        Ok(UncertainInput { input, name: name.to_owned(), effect, in_model, law, distribution })
    };
    let inputs = each(described, "inputs", input)?;
    let pair = |it: &Value| {
        let (first, second, value): (String, String, f64) = plain(it, "correlation")?;
        let place = |name: String| inputs.iter().position(|it| it.name == name).ok_or_else(|| format!("{name} has no distribution"));
        Ok((place(first)?, place(second)?, value))
    };
    let correlation = each(described, "correlation", pair)?;
    let sampling = match text(described, "method")? {
        "random" => Sampling::Random,
        "latin-hypercube" => Sampling::LatinHypercube { replicates: REPLICATES },
        "sobol" => Sampling::Sobol { replicates: REPLICATES },
        other => return Err(format!("draws cannot be spread by \"{other}\"")),
    };
    let drive = Drive {
        model: model.clone(),
        operation: each(described, "operation", |axis| axis_of(model, axis))?,
        spectrum: spectrum_of(&described["spectrum"])?,
        constraints: each(described, "constraints", |it| constraint_of(model, it))?,
    };
    let [draws, confirm, seed, levels] = ["draws", "confirm", "seed", "levels"].map(|key| plain(&described[key], key));
    let enclosure = described["enclosure"] == true;
    let statistics = each(described, "statistics", |it| statistic_of(model, it))?;
    let (draws, confirm, seed, levels) = (draws?, confirm?, seed?, levels?);
    Ok(Probability { inputs, correlation, draws, confirm, seed, sampling, levels, enclosure, drive, statistics })
}

fn statistic_of(model: &Model, described: &Value) -> Restored<Statistic> {
    let name = text(described, "name")?.to_owned();
    if !described["yield_of"].is_null() {
        return Ok(Statistic { name, kind: StatisticKind::YieldOf(constraint_of(model, &described["yield_of"])?) });
    }
    if !described["confirmed"].is_null() {
        return Ok(Statistic { name, kind: StatisticKind::Confirmed(plain(&described["confirmed"], "confirmed")?) });
    }
    if described["of"].is_null() {
        return Ok(Statistic { name, kind: StatisticKind::Yield });
    }
    let worse = worst_of(described)?.ok_or("a statistic has no worst end")?;
    let asked = AskedQuantity { quantity: quantity_of(model, &described["of"])?, over: over_of(described)?, worse };
    let draws: Option<OverDraws> = plain(&described["over_draws"], "over_draws")?;
    Ok(Statistic { name, kind: draws.map_or(StatisticKind::Plain(asked), |draws| StatisticKind::Over(asked, draws)) })
}

/// The model in a file, of the file's text.
fn model_of_file(models: &Models, name: &str, file: &Value) -> Restored<Arc<Model>> {
    let curves = each(file, "curves", curve_of)?;
    let source = ModelText { name, text: text(file, "text")?, file: "model_file", curves: CurvePoints::Known(&curves) };
    read_model_text(models, source).map_err(|problems| format!("model_file: {}", problems[0].message))
}

fn curve_of(curve: &Value) -> Restored<CurveSource> {
    let named = |key: &str| text(curve, key).map(str::to_owned);
    Ok(CurveSource { name: named("name")?, x: named("x")?, y: named("y")?, points: plain(&curve["points"], "points")? })
}

fn formula_of(formula: &Value) -> Restored<FormulaSource> {
    let said = |key: &str| if formula[key].is_null() { Ok(String::new()) } else { text(formula, key).map(str::to_owned) };
    let worst = match formula["worst"].as_str() {
        Some("lowest") => Some(Worse::Lower),
        Some("highest") => Some(Worse::Higher),
        _ => None,
    };
    let [integer, hidden] = ["integer", "hidden"].map(|key| formula[key] == true);
    let plain = FormulaSource::plain(text(formula, "name")?, text(formula, "is")?);
    Ok(FormulaSource { worst, integer, hidden, symbol: said("symbol")?, doc: said("doc")?, source: said("source")?, ..plain })
}

fn extension_of(described: &Value) -> Restored<Extension> {
    fn names(described: &Value, key: &str) -> Restored<Vec<String>> {
        if described[key].is_null() { Ok(Vec::new()) } else { plain(&described[key], key) }
    }
    fn parts<T>(described: &Value, key: &str, part: impl Fn(&Value) -> Restored<T>) -> Restored<Vec<T>> {
        if described[key].is_null() { Ok(Vec::new()) } else { each(described, key, part) }
    }
    Ok(Extension {
        units: names(described, "units")?,
        variables: names(described, "variables")?,
        curves: parts(described, "curves", curve_of)?,
        formulas: parts(described, "formulas", formula_of)?,
        file: None,
    })
}

fn report_of(study: &Study, described: &Value) -> Restored<Report> {
    let model = &study.model;
    let top = match &described["top"] {
        Value::Null => None,
        top => {
            Some(TopSpec { by: quantity_of(model, &top["by"])?, goal: plain(&top["goal"], "goal")?, count: plain(&top["count"], "count")? })
        }
    };
    let histogram = |it: &Value| {
        let [from, to]: [Option<f64>; 2] = [plain(&it["from"], "from")?, plain(&it["to"], "to")?];
        Ok(HistogramSpec { of: quantity_of(model, &it["of"])?, range: from.zip(to), bins: plain(&it["bins"], "bins")? })
    };
    let sample = match &described["feasible_sample"] {
        Value::Null => None,
        sample => Some(SampleSpec { count: plain(&sample["count"], "count")?, seed: plain(&sample["seed"], "seed")? }),
    };
    let sensitivity = match &described["sensitivity"] {
        Value::Null => None,
        it => {
            Some(SensitivitySpec { over: plain(&it["over"], "over")?, of: plain(&it["of"], "of")?, draws: plain(&it["draws"], "draws")? })
        }
    };
    Ok(Report {
        columns: each(described, "columns", |it| column_of(model, it))?,
        top,
        histograms: each(described, "histograms", histogram)?,
        maps: each(described, "maps", |it| map_of(study, it))?,
        sample,
        front_budget: plain(&described["front_budget"], "front_budget")?,
        variants: described["variants"] == true,
        feasible: described["feasible"] == true,
        sensitivity,
    })
}

fn map_of(study: &Study, map: &Value) -> Restored<MapSpec> {
    let model = &study.model;
    let axis = |key: &str| {
        let input = input_of(model, text(map, key)?)?;
        let position = study.design.iter().position(|axis| axis.inputs().first() == Some(&input));
        position.ok_or_else(|| format!("a map's {key} is no design axis"))
    };
    let value = match text(map, "best")? {
        "share" => Best::Share,
        "min" => Best::Value(quantity_of(model, &map["value"])?, Goal::Min),
        "max" => Best::Value(quantity_of(model, &map["value"])?, Goal::Max),
        other => return Err(format!("a map cannot show the best by \"{other}\"")),
    };
    let contours = map["contours"].as_array().map_or(&[][..], Vec::as_slice).iter().map(|it| {
        let at = match &it["at"] {
            Value::Array(values) => Thresholds::At(values.iter().map(number_of).collect::<Restored<_>>()?),
            _ => Thresholds::Changes,
        };
        Ok(ContourSpec { of: quantity_of(model, &it["of"])?, at })
    });
    Ok(MapSpec { x: axis("x")?, y: axis("y")?, value, contours: contours.collect::<Restored<_>>()? })
}

fn axis_of(model: &Model, axis: &Value) -> Restored<Axis> {
    if let Some(names) = axis["inputs"].as_array() {
        let inputs = names.iter().map(|name| input_of(model, name.as_str().unwrap_or_default())).collect::<Restored<Vec<_>>>()?;
        let row = |row: &Value| -> Restored<Vec<f64>> {
            let values = row.as_array().filter(|values| values.len() == inputs.len()).ok_or("a row has another length than its inputs")?;
            inputs.iter().zip(values).map(|(&input, value)| value_of(model, input, value)).collect()
        };
        return Ok(Axis::Joint { rows: list(axis, "rows")?.iter().map(row).collect::<Restored<_>>()?, inputs });
    }
    let input = input_of(model, text(axis, "input")?)?;
    let log = axis["spacing"] == "log";
    let number = |key: &str| number_of(&axis[key]);
    let has = |key: &str| !axis[key].is_null();
    let levels = match axis["values"].as_array() {
        Some(values) => Levels::List(values.iter().map(|value| value_of(model, input, value)).collect::<Restored<_>>()?),
        None if has("step") => Levels::Step { from: number("from")?, step: number("step")?, count: plain(&axis["count"], "count")?, log },
        None if has("count") => Levels::Even { from: number("from")?, to: number("to")?, count: plain(&axis["count"], "count")?, log },
        None => Levels::Continuous { from: number("from")?, to: number("to")?, log },
    };
    Ok(Axis::Single { input, levels })
}

/// The labels of all design axes.
fn labels_of(axes: &[Value]) -> Restored<Vec<Label>> {
    let mut labels = Vec::new();
    for (number, axis) in axes.iter().enumerate().filter(|(_, axis)| !axis["labels"].is_null()) {
        labels.extend(each(axis, "labels", |it| {
            Ok(Label { name: text(it, "name")?.to_owned(), axis: number, texts: plain(&it["texts"], "texts")? })
        })?);
    }
    Ok(labels)
}

fn constraint_of(model: &Model, constraint: &Value) -> Restored<Constraint> {
    let bound = |inclusive: &str, exclusive: &str| match (&constraint[inclusive], &constraint[exclusive]) {
        (Value::Null, Value::Null) => Ok(None),
        (Value::Null, excluded) => number_of(excluded).map(|bound| Some((bound, true))),
        (included, _) => number_of(included).map(|bound| Some((bound, false))),
    };
    let [low, high] = [bound("min", "above")?, bound("max", "below")?];
    Ok(Constraint { quantity: quantity_of(model, &constraint["of"])?, low, high, over: over_of(constraint)? })
}

fn spectrum_of(spectrum: &Value) -> Restored<Option<Spectrum>> {
    if spectrum.is_null() {
        return Ok(None);
    }
    let named = |key: &str| text(spectrum, key).map(str::to_owned);
    let weights = list(spectrum, "weights")?.iter().map(number_of).collect::<Restored<_>>()?;
    let [name, weight, unit] = [named("name")?, named("weight")?, named("unit")?];
    Ok(Some(Spectrum { axis: plain(&spectrum["axis"], "axis")?, name, weight, unit, weights }))
}

/// A column by its name, or with what else is said of it.
fn column_of(model: &Model, column: &Value) -> Restored<ReportColumn> {
    if column.is_string() {
        return quantity_of(model, column).map(ReportColumn::from);
    }
    let worst = worst_of(column)?;
    Ok(ReportColumn { of: quantity_of(model, &column["of"])?, over: over_of(column)?, worst })
}

/// The end that counts as the worst, where that is said.
fn worst_of(it: &Value) -> Restored<Option<Worse>> {
    match &it["worst"] {
        Value::Null => Ok(None),
        word if word == Worse::Higher.word() => Ok(Some(Worse::Higher)),
        word if word == Worse::Lower.word() => Ok(Some(Worse::Lower)),
        other => Err(format!("a worst end cannot be {other}")),
    }
}

fn over_of(it: &Value) -> Restored<OverScenarios> {
    let over = &it["over_scenarios"];
    if over.is_null() { Ok(OverScenarios::Worst) } else { plain(over, "over_scenarios") }
}

fn quantity_of(model: &Model, name: &Value) -> Restored<Quantity> {
    let name = name.as_str().ok_or("a quantity has no name")?;
    let input = model.input(name).map(Quantity::Input);
    input.or_else(|| model.output(name).map(Quantity::Output)).ok_or_else(|| format!("{} has no \"{name}\"", model.name))
}

fn input_of(model: &Model, name: &str) -> Restored<usize> {
    model.input(name).ok_or_else(|| format!("{} has no input \"{name}\"", model.name))
}

/// A number, or the word of an input.
fn value_of(model: &Model, input: usize, value: &Value) -> Restored<f64> {
    let table = &model.inputs[input];
    match value.as_str() {
        None => number_of(value),
        Some(word) => table.value_of(word).ok_or_else(|| format!("{} is never \"{word}\"", table.name)),
    }
}

fn number_of(value: &Value) -> Restored<f64> {
    value.as_f64().ok_or_else(|| format!("{value} is no number"))
}

fn text<'v>(object: &'v Value, key: &str) -> Restored<&'v str> {
    object[key].as_str().ok_or_else(|| format!("\"{key}\" is missing"))
}

fn list<'v>(object: &'v Value, key: &str) -> Restored<&'v [Value]> {
    object[key].as_array().map(Vec::as_slice).ok_or_else(|| format!("\"{key}\" is missing"))
}

fn each<T>(object: &Value, key: &str, read: impl Fn(&Value) -> Restored<T>) -> Restored<Vec<T>> {
    list(object, key)?.iter().map(read).collect()
}

/// What serde reads as it stands.
fn plain<T: DeserializeOwned>(value: &Value, key: &str) -> Restored<T> {
    T::deserialize(value).map_err(|error| format!("{key}: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn every_shipped_study_comes_back_from_its_description() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
        let (mut seen, mut drawn) = (0, 0);
        for entry in std::fs::read_dir(folder).expect("studies are shipped") {
            let path = entry.expect("it can be listed").path();
            let (study, _) = Study::read(&path).expect("it is right");
            let back = Study::from_description(&study.describe()).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            assert_eq!(back.hash(), study.hash(), "{}", path.display());
            assert_eq!(back.describe(), study.describe(), "{}", path.display());
            // The model of draws is made anew, and models are equal only if their formulas are the very same.
            assert_eq!(
                (&back.model.outputs, &back.model.conditions),
                (&study.model.outputs, &study.model.conditions),
                "{}",
                path.display()
            );
            let model = if study.probability.is_some() { study.model.clone() } else { back.model.clone() };
            drawn += u64::from(study.probability.is_some());
            // Values of inputs that axes set are never read, and what was left out is told only of the file.
            let told = study.clone();
            let back = Study { model, fixed: told.fixed, left_out: told.left_out, short_ranges: told.short_ranges, ..back };
            assert_eq!(back, study, "{}", path.display());
            seen += 1;
        }
        assert!(seen >= 8 && drawn >= 2);
    }

    #[test]
    fn labels_come_back_and_texts_that_do_not_fit_the_rows_do_not() {
        let text = "model = \"metal-cvt\"\nlabels = [\"part_no\", \"maker\"]\n[design]\nfriction = [0.08, 0.09]\ncases = [\n\
                    { maker = \"A\", part_no = \"007\", band_count = 8 },\n{ part_no = \"008\", maker = \"B, \\\"C\\\"\", band_count = 8 }]\n\
                    [objectives]\naxial_force_N = \"min\"\n";
        let study = Study::parse(text).unwrap_or_else(|errors| panic!("{errors}"));
        assert_eq!(study.labels.iter().map(|it| (it.name.as_str(), it.axis)).collect::<Vec<_>>(), [("part_no", 1), ("maker", 1)]);
        let described = study.describe();
        let back = Study::from_description(&described).expect("it comes back");
        assert_eq!((back.labels, back.design), (study.labels.clone(), study.design.clone()));
        let other = Study::parse(&text.replace("007", "07")).unwrap_or_else(|errors| panic!("{errors}"));
        assert_ne!(other.hash(), study.hash(), "a label is part of the hash");
        let refused = |edit: fn(&mut Value)| {
            let mut changed = described.clone();
            edit(&mut changed["design"][1]["labels"][0]);
            Study::from_description(&changed).expect_err("it was changed")
        };
        assert_eq!(refused(|it| it["texts"] = serde_json::json!(["007"])), "label \"part_no\": it has 1 texts for 2 rows");
        assert!(refused(|it| it["name"] = "friction".into()).contains("it is an input or a variable too"));
        assert_eq!(refused(|it| it["name"] = "maker".into()), "label \"maker\": it is there twice");
        assert!(refused(|it| it["texts"][0] = "a\nb".into()).contains("control character"));
        let mut same = described.clone();
        same["design"][1]["labels"] = serde_json::json!([{ "name": "part_no", "texts": ["007", "007"] }]);
        assert_eq!(Study::from_description(&same).unwrap_err(), "axis \"band_count\": two rows are equal");
    }

    #[test]
    fn words_joint_rows_samples_and_bounds_come_back_and_a_changed_description_does_not() {
        let text = r#"
            model = "metal-cvt"
            title = "Everything"
            [design]
            traction = ["limit", 0.4]
            cases = [{ band_count = 8, band_width_mm = 9 }, { band_count = 10, band_width_mm = 12 }]
            band_thickness_mm = { from = 0.1, to = 0.4, step = 0.1, spacing = "log" }
            [operation]
            ratio = { from = 0.5, to = 2, count = 3, spacing = "log" }
            [constraints]
            slip_margin = { above = 0, max = 0.9 }
            stress_margin = { min = 0, below = 2 }
            [objectives]
            axial_force_N = { goal = "min", resolution = 10 }
            [report]
            columns = ["max_stress_MPa"]
            maps = [{ x = "traction", y = "band_thickness_mm", best = "share" }]
            histograms = [{ of = "axial_force_N", bins = 4 }]
            sample = { count = 100, seed = 7 }
        "#;
        let sampled = "model = \"metal-cvt\"\n[design]\nband_thickness_mm = { from = 0.1, to = 0.4 }\n[sample]\nmethod = \"sobol\"\n\
                       count = 16\nseed = 3\n[objectives]\naxial_force_N = \"min\"\n";
        for text in [text, sampled] {
            let study = Study::parse_in(text, "study.toml", Path::new(".")).unwrap_or_else(|errors| panic!("{errors}"));
            let described = study.describe();
            let back = Study::from_description(&described).expect("it comes back");
            let told = study.clone();
            assert_eq!(Study { fixed: told.fixed, short_ranges: told.short_ranges, ..back }, study);
            let mut changed = described.clone();
            changed["further"] = 1.into();
            assert!(Study::from_description(&changed).is_err(), "a later version's description is not understood");
            let mut changed = described;
            changed["objectives"][0]["of"] = "axial_farce_N".into();
            assert_eq!(Study::from_description(&changed).unwrap_err(), "metal-cvt has no \"axial_farce_N\"");
        }
    }
}
