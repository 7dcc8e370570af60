//! The form of a study file as JSON Schema, for editors and other programs, and as a page for people.
//!
//! Which keys a table takes comes from the reader. A schema sees the form only: names of a model, units and ranges are for the reader.

use super::read::{DISCRETE, LAWS, LEFT_OUT, LISTED, MODEL_KEYS, PARAMETERS, keys};
use crate::units::by_dimension;
use serde_json::{Map, Value, json};

/// A key of a table: its name, what its value is, and what it means.
type SchemaKey = (&'static str, Value, &'static str);

fn of(definition: &str) -> Value {
    json!({ "$ref": format!("#/$defs/{definition}") })
}

fn any_of(schemas: impl IntoIterator<Item = Value>) -> Value {
    json!({ "anyOf": schemas.into_iter().collect::<Vec<_>>() })
}

fn text() -> Value {
    json!({ "type": "string" })
}

fn truth() -> Value {
    json!({ "type": "boolean" })
}

fn word(words: &[&str]) -> Value {
    json!({ "enum": words })
}

fn whole(least: u64) -> Value {
    json!({ "type": "integer", "minimum": least })
}

fn list(items: Value) -> Value {
    json!({ "type": "array", "items": items })
}

/// Any names, all of this kind.
fn named(value: Value) -> Value {
    json!({ "type": "object", "additionalProperties": value })
}

/// A table of these keys and no others; it must take exactly the keys that the reader takes.
///
/// # Panics
/// If it does not: a key of the reader has no description here, or the other way round.
fn table(reader: &[&str], also: &[&str], needed: &[&str], described: Vec<SchemaKey>) -> Value {
    let mut wanted: Vec<&str> = reader.iter().chain(also).copied().collect();
    let mut told: Vec<&str> = described.iter().map(|it| it.0).collect();
    wanted.sort_unstable();
    told.sort_unstable();
    assert_eq!(wanted, told, "the schema tells every key that the reader takes, and no other");
    let properties: Map<String, Value> = described
        .into_iter()
        .map(|(key, mut schema, doc)| {
            schema["description"] = doc.into();
            (key.to_owned(), schema)
        })
        .collect();
    json!({ "type": "object", "properties": properties, "required": needed, "additionalProperties": false })
}

/// What is said of draws beside a quantity, in a study with distributions.
const OVER_DRAWS: &str = "over_draws";

fn over_scenarios() -> SchemaKey {
    ("over_scenarios", word(&["worst", "mean", "sum"]), "What becomes of the values over weighted cases; `worst` if left out.")
}

fn over_draws() -> SchemaKey {
    (OVER_DRAWS, of("over_draws"), "What becomes of the values over draws, in a study with distributions.")
}

fn quantity() -> SchemaKey {
    ("of", text(), "The quantity: an input or output; the name in front if left out.")
}

fn end(what: &'static str, name: &'static str) -> SchemaKey {
    (name, of("value"), what)
}

/// A tolerance: `key` is the name of its effect.
fn tolerance(key: &'static str, doc: &'static str) -> Value {
    table(&[key], &[], &[key], vec![(key, any_of([of("law"), of("range"), list(of("value"))]), doc)])
}

/// A distribution: one key that names it, with its parameters, and where draws are cut off.
fn law() -> Value {
    let parameters = |(name, parameters): (&&str, &&[&str])| {
        let one = |key: &&str| ((*key).to_owned(), of("value"));
        let needed: Vec<&str> = parameters.iter().copied().filter(|key| (*name, *key) != LEFT_OUT).collect();
        let length = parameters.len();
        let of_numbers = || {
            let properties: Map<String, Value> = parameters.iter().map(one).collect();
            json!({ "type": "object", "properties": properties, "required": needed, "additionalProperties": false })
        };
        let in_order = || json!({ "type": "array", "items": of("value"), "minItems": length, "maxItems": length });
        let mut schema = match *name {
            "discrete" => of("discrete"),
            "empirical" => any_of([list(of("value")), of("measured")]),
            name if LISTED.contains(&name) => any_of([of_numbers(), in_order()]),
            _ => of_numbers(),
        };
        let words: Vec<String> = parameters.iter().map(|it| format!("`{it}`")).collect();
        schema["description"] = match *name {
            "discrete" => "Values with weights.".to_owned(),
            "empirical" => "Measured values: a list, or the column of a file.".to_owned(),
            "weibull" => format!("Parameters {}; `from` is 0 if left out.", words.join(", ")),
            name if LISTED.contains(&name) => format!("Parameters {}, also as a list.", words.join(", ")),
            _ => format!("Parameters {}.", words.join(", ")),
        }
        .into();
        ((*name).to_owned(), schema)
    };
    let mut properties: Map<String, Value> = LAWS.iter().zip(&PARAMETERS).map(parameters).collect();
    for (key, doc) in [("from", "Draws below this are left out."), ("to", "Draws above this are left out.")] {
        properties.insert(key.to_owned(), json!({ "$ref": "#/$defs/value", "description": doc }));
    }
    let one_of: Vec<Value> = LAWS.iter().map(|name| json!({ "required": [name] })).collect();
    json!({
        "type": "object", "description": "A distribution, one of these, truncated by `from` and `to`.",
        "properties": properties, "oneOf": one_of, "additionalProperties": false,
    })
}

#[allow(clippy::too_many_lines, reason = "one table after the other")]
fn definitions() -> Value {
    let numbers = || list(of("value"));
    json!({
        "value": { "type": ["number", "string"], "description": "A number in the unit of the name, a text with a unit such as \"0.25 in\", or a word." },
        "axis": any_of([
            of("value"), numbers(), of("range"),
            json!({ "type": "array", "items": { "type": "object" }, "description": "Cases: rows of inputs that belong together." }),
            table(keys::CSV_ROWS, &[], &["csv"], vec![
                ("csv", text(), "A CSV file of cases, relative to the study."),
                ("unused", word(&["ok"]), "Columns that nothing uses are left out."),
            ]),
            table(keys::SPECTRUM, &[], &["cases", "weight"], vec![
                ("cases", json!({ "type": ["array", "object"] }), "The cases, as rows or `{ csv = \"file.csv\" }`."),
                ("weight", text(), "The column of weights: hours, shares, counts."),
            ]),
            of("uncertain"),
        ]),
        "range": table(keys::RANGE, &[], &["from", "to"], vec![
            end("The first level.", "from"),
            end("The last level.", "to"),
            ("count", whole(1), "How many levels."),
            ("step", of("value"), "The distance of two levels, in place of `count`; 1 for whole numbers."),
            ("spacing", word(&["linear", "log"]), "How the levels lie; `linear` if left out."),
        ]),
        "uncertain": any_of([of("tolerance"), of("law")]),
        "tolerance": any_of([
            tolerance("times", "A factor on what the design says."),
            tolerance("plus", "An addend to what the design says, in the unit of the name."),
        ]),
        "law": law(),
        "over_draws": any_of([
            word(&["mean", "worst", "sd"]),
            table(keys::QUANTILE, &[], &["quantile"], vec![("quantile", json!({ "type": "number" }), "The share of draws that are at least as good.")]),
        ]),
        "constraint": table(keys::CONSTRAINT, &[OVER_DRAWS, "yield"], &[], vec![
            end("The quantity is at least this.", "min"),
            end("The quantity is at most this.", "max"),
            end("The quantity is greater than this.", "above"),
            end("The quantity is less than this.", "below"),
            quantity(), over_scenarios(), over_draws(),
            ("yield", json!({ "type": "number" }), "The share of draws that must keep the bound."),
        ]),
        "objective": any_of([
            word(&["min", "max"]),
            table(keys::OBJECTIVE, &[OVER_DRAWS], &["goal"], vec![
                ("goal", word(&["min", "max"]), "Which way is better."),
                ("resolution", of("value"), "Values within one step of this count as equal."),
                quantity(), over_scenarios(), over_draws(),
            ]),
        ]),
        "column": any_of([
            text(),
            table(keys::REPORT_COLUMN, &[OVER_DRAWS], &["of"], vec![
                quantity(),
                ("worst", word(&["lowest", "highest"]), "Which end over the scenarios is shown."),
                over_scenarios(), over_draws(),
            ]),
        ]),
        "histogram": table(keys::HISTOGRAM, &[OVER_DRAWS], &["of"], vec![
            quantity(),
            ("bins", whole(1), "How many bins; 50 if left out."),
            end("Where the bins begin; found from the designs if left out.", "from"),
            end("Where they end.", "to"),
            over_draws(),
        ]),
        "map": table(keys::MAP, &[OVER_DRAWS], &["x", "y"], vec![
            ("x", text(), "The design axis across."),
            ("y", text(), "The design axis upwards."),
            ("value", text(), "The quantity, the best of the other axes; the share of feasible designs if left out."),
            ("best", word(&["min", "max", "share"]), "Which value of the other axes is shown."),
            ("contours", json!({ "type": ["boolean", "array"] }), "Lines over the map: true, values, or `{ of = ..., at = [...] }`."),
            over_draws(),
        ]),
        "contours": table(keys::CONTOURS, &[], &["of", "at"], vec![
            quantity(),
            ("at", numbers(), "The values."),
        ]),
        "top": table(keys::TOP, &[OVER_DRAWS], &["by", "count"], vec![
            ("by", text(), "The quantity."),
            ("count", whole(1), "How many designs."),
            ("goal", word(&["min", "max"]), "Which way is better; that of the objective if left out."),
            over_draws(),
        ]),
        "report_sample": any_of([whole(1), table(keys::REPORT_SAMPLE, &[], &["count"], vec![
            ("count", whole(1), "How many feasible designs."),
            ("seed", whole(0), "Which; 0 if left out."),
        ])]),
        "sensitivity": any_of([truth(), table(keys::SENSITIVITY, &[], &[], vec![
            ("over", word(&["design", "uncertainty"]), "Whose inputs are looked at."),
            ("of", list(text()), "The quantities; all that the study asks for if left out."),
            ("draws", whole(1), "How many draws."),
        ])]),
        "formula": any_of([text(), table(keys::FORMULA, &[], &["is"], vec![
            ("is", text(), "The formula."),
            ("worst", word(&["lowest", "highest"]), "Which end over the scenarios is the worst."),
            ("integer", truth(), "It gives whole numbers."),
            ("hidden", truth(), "It is no column by itself."),
            ("symbol", text(), "Its symbol."),
            ("doc", text(), "What it is, in a sentence."),
            ("source", text(), "Where it comes from."),
        ])]),
        "curve": table(keys::CURVE, &[], keys::CURVE, vec![
            ("csv", text(), "A CSV file with the points, relative to the study or the model's file."),
            ("x", text(), "The column across, whose name ends in its unit."),
            ("y", text(), "The column of values."),
        ]),
        "probability": table(keys::PROBABILITY, &[], &[], vec![
            ("draws", whole(1), "Draws that choose designs; 4096 if left out."),
            ("confirm", whole(1), "Fresh draws that judge what is reported; 1 000 000 if left out."),
            ("seed", whole(0), "Which draws; 1 if left out."),
            ("method", word(&["random", "latin-hypercube", "sobol"]), "How the draws are made."),
            ("correlation", list(json!({ "type": "array" })), "Pairs of inputs with their correlation: `[[\"a\", \"b\", -0.3]]`."),
            ("enclosure", truth(), "Yields of reported designs get proven bounds."),
        ]),
        "measured": table(keys::MEASURED, &[], keys::MEASURED, vec![
            ("csv", text(), "A CSV file of measured values."),
            ("column", text(), "Its column."),
        ]),
        "discrete": table(DISCRETE, &[], DISCRETE, vec![
            ("values", numbers(), "The values."),
            ("weights", list(of("value")), "How often each comes, relative to the others."),
        ]),
        "input": table(keys::INPUT, &[], &["default"], vec![
            ("default", of("value"), "Its value where nobody gives one."),
            ("valid", any_of([of("ends"), of("valid")]), "Numbers that it takes, ends included; any if left out."),
            ("usual", of("ends"), "Numbers for which the formulas are known to hold; others are told."),
            ("integer", truth(), "It takes whole numbers only."),
            ("words", list(text()), "Words that it takes, too; without `valid` nothing but them."),
            ("only_for", json!({ "type": "object", "minProperties": 1, "maxProperties": 1, "additionalProperties": list(text()) }), "It is read only where another input has one of these words."),
            ("follows", text(), "The input whose value it has unless it is given."),
            ("instead_of", text(), "The input whose place a number of this one takes."),
            ("symbol", text(), "Its symbol."),
            ("doc", text(), "What it is, in a sentence."),
            ("source", text(), "Where its values come from."),
        ]),
        "ends": json!({ "type": "array", "items": of("value"), "minItems": 2, "maxItems": 2, "description": "The least and the largest: `[low, high]`." }),
        "valid": table(keys::VALID, &[], &[], vec![
            end("The least.", "min"),
            end("It is greater than this.", "above"),
            end("The largest.", "max"),
            end("It is less than this.", "below"),
        ]),
        "condition": table(keys::CONDITION, &[], &["margin"], vec![
            ("margin", text(), "A formula: at least 0 where the condition holds."),
            ("strict", truth(), "It holds only where the margin is greater than 0."),
            ("quiet", truth(), "It takes outputs away and is no status."),
            ("invalidates", list(text()), "Outputs without meaning where it fails; all if left out."),
            ("doc", text(), "What holds, in a sentence."),
        ]),
        "output": any_of([text(), table(keys::OUTPUT, &[], &[], vec![
            ("worst", word(&["lowest", "highest"]), "Which end over the scenarios is the worst."),
            ("symbol", text(), "Its symbol."),
            ("doc", text(), "What it is, in a sentence."),
            ("source", text(), "Where it comes from."),
        ])]),
        "sample": table(keys::SAMPLE, &[], &["method", "count"], vec![
            ("method", word(&["sobol", "latin-hypercube", "random"]), "How designs are drawn from the ranges of the axes."),
            ("count", whole(1), "How many designs."),
            ("seed", whole(0), "Which; 0 if left out."),
        ]),
        "report": table(keys::REPORT, &[], &[], vec![
            ("columns", list(of("column")), "More columns of the tables."),
            ("top", of("top"), "A list of the best designs by one quantity."),
            ("histograms", list(of("histogram")), "Histograms over the feasible designs."),
            ("maps", list(of("map")), "Maps over two design axes."),
            ("sample", of("report_sample"), "A sample of the feasible designs."),
            ("front_budget", whole(1), "Most designs of the front; 1 000 000 if left out."),
            ("variants", truth(), "A list of every design, feasible or not."),
            ("feasible", truth(), "All feasible designs, in `feasible.parquet`."),
            ("sensitivity", of("sensitivity"), "Which input matters for each quantity."),
        ]),
    })
}

/// The form of a study file: the text of a JSON Schema, draft 2020-12.
pub fn study_schema() -> String {
    format!("{:#}\n", schema())
}

/// The form of the file of a model: the text of a JSON Schema, draft 2020-12.
pub fn model_schema() -> String {
    format!("{:#}\n", of_model())
}

fn of_model() -> Value {
    let mut schema = table(
        &MODEL_KEYS,
        &[],
        &["formulas"],
        vec![
            ("summary", text(), "What it is, in a sentence."),
            ("source", text(), "Where its formulas come from."),
            ("limits", text(), "What it leaves out."),
            ("base", text(), "A model of `beltspace models` whose inputs, outputs and conditions it has, too."),
            ("units", list(text()), "Units of one's own, such as `EUR`."),
            ("inputs", named(of("input")), "Its inputs; the name ends in the unit."),
            ("curves", named(of("curve")), "Measured data, used in formulas like a function."),
            ("formulas", named(of("formula")), "What it computes; the name ends in the unit."),
            ("conditions", named(of("condition")), "Where it has a meaning; the name is the status where it has none."),
            ("outputs", named(of("output")), "The formulas that are outputs, with what they are; all that are not hidden if left out."),
            ("presets", named(named(of("value"))), "Values of inputs that belong together."),
        ],
    );
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
    schema["title"] = "A model of beltspace in a file".into();
    schema["$defs"] = definitions();
    schema
}

fn schema() -> Value {
    let axes = |doc: &'static str| (named(of("axis")), doc);
    let (design, of_design) = axes("What is chosen: one axis per input, the last one fastest.");
    let (operation, of_operation) = axes("What the drive must survive.");
    let (uncertainty, of_uncertainty) = axes("What nobody knows exactly: levels, distributions or tolerances.");
    let mut schema = table(
        super::read::TOP_LEVEL,
        &[],
        &["model"],
        vec![
            ("model", text(), "The model: a name of `beltspace models`, or the file of one."),
            ("preset", any_of([text(), list(text())]), "A preset of the model in place of its defaults; a list is an axis over presets."),
            ("title", text(), "What the study is, for people."),
            ("units", list(text()), "Units of one's own, such as `EUR`."),
            ("labels", list(text()), "Columns of catalogues that are carried along as texts."),
            ("design", design, of_design),
            ("operation", operation, of_operation),
            ("uncertainty", uncertainty, of_uncertainty),
            ("probability", of("probability"), "How distributions are drawn from."),
            ("fixed", named(of("value")), "One value per input, in place of its default."),
            ("constraints", named(of("constraint")), "Bounds that every scenario must keep."),
            ("objectives", named(of("objective")), "What shall be small or large; the front is over these."),
            ("report", of("report"), "What else is written."),
            ("sample", of("sample"), "Designs drawn from the ranges, in place of a grid."),
            ("curves", named(of("curve")), "Measured data, used in formulas like a function."),
            ("formulas", named(of("formula")), "What the model does not know; the name ends in the unit."),
        ],
    );
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
    schema["title"] = "A study of beltspace".into();
    schema["$defs"] = definitions();
    schema
}

/// Tables of the page, in its order: heading, and place in the schema.
const PAGES: &[(&str, &str)] = &[
    ("Ranges: `{ from, to, ... }`", "range"),
    ("Tolerances in `[uncertainty]`", "tolerance"),
    ("Distributions in `[uncertainty]`", "law"),
    ("`discrete`: values with weights", "discrete"),
    ("`[probability]`", "probability"),
    ("A constraint", "constraint"),
    ("An objective", "objective"),
    ("`[report]`", "report"),
    ("A column of `columns`", "column"),
    ("`top`", "top"),
    ("A histogram", "histogram"),
    ("A map", "map"),
    ("Contours of a map", "contours"),
    ("`sample` of the report", "report_sample"),
    ("`sensitivity`", "sensitivity"),
    ("`over_draws`", "over_draws"),
    ("`[sample]`", "sample"),
    ("A formula", "formula"),
    ("A curve", "curve"),
    ("Measured values of `empirical`", "measured"),
];

/// Those of the file of a model.
const MODEL_PAGES: &[(&str, &str)] = &[
    ("`[inputs]` of a model", "input"),
    ("`valid` of an input", "valid"),
    ("`[conditions]` of a model", "condition"),
    ("`[outputs]` of a model", "output"),
];

/// What a value may be, in words.
fn kind(schema: &Value) -> String {
    if let Some(reference) = schema["$ref"].as_str() {
        return reference.trim_start_matches("#/$defs/").replace('_', " ");
    }
    if let Some(words) = schema["enum"].as_array() {
        return words.iter().filter_map(Value::as_str).map(|word| format!("`\"{word}\"`")).collect::<Vec<_>>().join(", ");
    }
    if let Some(kinds) = schema["anyOf"].as_array() {
        return kinds.iter().map(kind).collect::<Vec<_>>().join(" or ");
    }
    let told = |kind: &str| match kind {
        "string" => "text".to_owned(),
        "boolean" => "true or false".to_owned(),
        "integer" => "whole number".to_owned(),
        "array" if schema["items"]["$ref"].is_string() || schema["items"]["type"].is_string() => {
            format!("list of {}", self::kind(&schema["items"]))
        }
        "array" => "list".to_owned(),
        "object" => match &schema["additionalProperties"] {
            Value::Object(_) => format!("table: name = {}", self::kind(&schema["additionalProperties"])),
            _ => "table".to_owned(),
        },
        other => other.to_owned(),
    };
    match &schema["type"] {
        Value::Array(kinds) => kinds.iter().filter_map(Value::as_str).map(told).collect::<Vec<_>>().join(" or "),
        one => one.as_str().map_or_else(String::new, told),
    }
}

fn rows(schema: &Value, page: &mut String) {
    let is_table = |it: &&Value| it["properties"].is_object();
    let kinds = schema["anyOf"].as_array().filter(|_| !is_table(&schema));
    let tables = kinds.map_or_else(|| vec![schema], |kinds| kinds.iter().filter(is_table).collect());
    for table in tables {
        page.push_str("| key | value | meaning |\n|---|---|---|\n");
        let needed: Vec<&str> = table["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
        for (key, value) in table["properties"].as_object().into_iter().flatten() {
            let mark = if needed.contains(&key.as_str()) { " (needed)" } else { "" };
            let doc = value["description"].as_str().unwrap_or("");
            page.push_str(&format!("| `{key}`{mark} | {} | {doc} |\n", kind(value)));
        }
    }
}

/// Every key of a study file, as a page in Markdown.
pub fn study_reference() -> String {
    let schema = schema();
    let mut page = "# The study file: every key\n\n\
        This page is what `beltspace schema --markdown` prints; `beltspace schema` prints the same for editors, as JSON Schema. Both come from the \
        tables by which the reader refuses unknown keys. What the keys are for is told in [what a study says](manual/study.md) and in the pages that it \
        names.\n\n\
        A *value* is a number in the unit that the name ends in, a text with a unit such as `\"0.25 in\"`, or a word that the input takes. An \
        *axis* is a value, a list of values, a range, or cases: rows `[{ a = 1, b = 2 }, ...]`, `{ csv = \"file.csv\" }`, or with weights \
        `{ cases = ..., weight = \"column\" }`; in `[uncertainty]` also a distribution or a tolerance.\n\n## Top level\n\n"
        .to_owned();
    rows(&schema, &mut page);
    sections(&schema, PAGES, &mut page);
    page.push_str("\nWhat the parameters of a distribution mean is told in [probability](probability.md).\n");
    page.push_str(&units());
    page.push_str("\n## The file of a model\n\nIts form is what `beltspace schema --model` prints; formulas and curves are those of a study. See [models in a file](models-in-a-file.md).\n\n");
    let model = of_model();
    rows(&model, &mut page);
    sections(&model, MODEL_PAGES, &mut page);
    page
}

/// The units that values may be given in.
fn units() -> String {
    let mut page = "\n## Units\n\nA value with a unit is converted to the unit that the name ends in, which must measure the same: \
        `\"0.25 in\"` for a name in `_mm`. In formulas a number with a unit stands as `14[EUR/kg]`; see [formulas](formulas.md).\n\n\
        | what | units, and other ways to write them |\n|---|---|\n"
        .to_owned();
    for (what, units) in by_dimension() {
        let written = units.iter().map(|names| names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(" or "));
        page.push_str(&format!("| {what} | {} |\n", written.collect::<Vec<_>>().join(", ")));
    }
    page
}

fn sections(schema: &Value, pages: &[(&str, &str)], page: &mut String) {
    for (heading, definition) in pages {
        page.push_str(&format!("\n## {heading}\n\n"));
        let definition = &schema["$defs"][*definition];
        if let Some(doc) = definition["description"].as_str() {
            page.push_str(&format!("{doc}\n\n"));
        }
        if let Some(short) = definition["anyOf"].as_array().filter(|_| !definition["properties"].is_object()) {
            let short: Vec<String> = short.iter().filter(|it| !it["properties"].is_object()).map(kind).collect();
            if !short.is_empty() {
                page.push_str(&format!("In short {}, else a table:\n\n", short.join(" or ")));
            }
        }
        rows(definition, page);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_schema_tells_every_key_and_refers_to_what_there_is() {
        let schema = schema();
        let text = schema.to_string();
        let definitions = schema["$defs"].as_object().expect("there are some");
        for part in text.split("#/$defs/").skip(1) {
            let name = part.split('"').next().unwrap_or_default();
            assert!(definitions.contains_key(name), "{name}");
        }
        assert_eq!(schema["properties"].as_object().map(Map::len), Some(crate::study::read::TOP_LEVEL.len()));
        assert_eq!(schema["$defs"]["law"]["properties"].as_object().map(Map::len), Some(LAWS.len() + 2));
        let page = study_reference();
        assert!(page.contains("| `model` (needed) | text |") && page.contains("| `front_budget` |"));
    }

    #[test]
    #[should_panic(expected = "the schema tells every key that the reader takes")]
    fn a_key_without_a_description_is_found() {
        table(&["a", "b"], &[], &[], vec![("a", text(), "One.")]);
    }
}
