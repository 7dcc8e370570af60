//! `beltspace models`: lists the models, or describes one.

use super::model_of;
use crate::cli;
use crate::terminal::{self, TextGrid, bold, dim};
use beltspace::error::{Error, Result};
use beltspace::models::{self, Input, Model, Range, Worse};
use beltspace::study::{number, value_of};
use beltspace::tape::{EquationLine, FormulaEquations};
use serde_json::{Map, Value, json};

pub fn run(request: &cli::ModelsArgs) -> Result<()> {
    let model = request.name.as_deref().map(model_of).transpose()?;
    let text = match (model, request.json) {
        (Some(model), _) if request.study && model.starter.is_empty() => {
            return Err(Error::Request(format!("{} comes from a file, and with no study; docs/models-in-a-file.md shows one", model.name)));
        }
        (Some(model), _) if request.study => model.starter.to_owned(),
        (Some(model), true) => format!("{:#}\n", describe(&model)),
        (None, true) => format!("{:#}\n", models::all().iter().map(|model| describe(model)).collect::<Value>()),
        (Some(model), false) => page(&model),
        (None, false) => list(),
    };
    // JSON and studies are for programs and files.
    if request.json || request.study { terminal::print(&text) } else { terminal::tell(&text) }
}

/// The usual range of an input of which none is said.
const ANY: (f64, f64) = (f64::MIN, f64::MAX);

fn list() -> String {
    let mut grid = TextGrid::default();
    for model in models::all() {
        grid.row([bold(&model.name), model.summary.to_owned()]);
    }
    format!(
        "{}\nInputs, outputs, units, ranges and sources of one:  beltspace models NAME\nA study to start from:  beltspace models NAME --study\n",
        grid.indented(0)
    )
}

fn page(model: &Model) -> String {
    let mut inputs = TextGrid::default();
    inputs.row(["input", "default", "usual", "valid"].map(bold));
    for input in &model.inputs {
        let (low, high) = input.usual;
        let word = input.word_for(input.default);
        let default = match word.zip(input.follows.as_ref().and_then(|other| model.input(other))) {
            Some((word, other)) => format!("{} ({word})", model.inputs[other].default),
            None => word.map_or_else(|| input.default.to_string(), str::to_owned),
        };
        let usual = if input.is_enumeration() || input.usual == ANY { "any".to_owned() } else { format!("{low} to {high}") };
        inputs.row([input.name.to_owned(), default, usual, input.valid_in_words()]);
    }
    let from = |source: &str| if source.is_empty() { String::new() } else { format!(" [{source}]") };
    let inputs = described(&inputs, model.inputs.iter().map(|input| format!("{}{}{}", input.doc, from(&input.source), only_for(input))));
    let mut outputs = TextGrid::default();
    outputs.row(["output", "symbol", "equation"].map(bold));
    for output in &model.outputs {
        outputs.row([&output.name, &output.symbol, &output.source].map(String::clone));
    }
    let outputs = described(&outputs, model.outputs.iter().map(|output| output.doc.to_owned()));
    let mut statuses = TextGrid::default();
    statuses.row([bold("status"), String::new()]);
    for condition in model.conditions.iter().filter(|condition| !condition.quiet) {
        statuses.row([condition.reason.to_owned(), format!("unless: {}", condition.doc)]);
    }
    let presets = presets(model);
    let mut formulas = TextGrid::default();
    formulas.row([bold("formula"), String::new()]);
    for (name, text) in model.formulas() {
        formulas.row([name.to_owned(), terminal::told(text)]);
    }
    let formulas = if model.formulas().is_empty() { String::new() } else { format!("{}\n", formulas.indented(2)) };
    let equations = equations(model);
    let where_run = if !model.on_gpu { "\nComputed in f64 on the CPU only." } else { "" };
    format!(
        "{}  {}\n\n{}{where_run}\n\n{}\n{}\n{formulas}{}\n{equations}{presets}{} {}\n",
        bold(&model.name),
        model.summary,
        model.source,
        inputs,
        outputs,
        statuses.indented(2),
        bold("Not in the model:"),
        model.limits,
    )
}

/// Names of the presets, and what they are where that is said.
fn presets(model: &Model) -> String {
    let presets = &model.presets;
    if presets.is_empty() {
        return String::new();
    }
    let names: Vec<_> = presets.iter().map(|it| it.name.as_str()).collect();
    let told = presets.iter().filter(|it| !it.about.is_empty()).map(|it| format!("{}\n", dim(&format!("  {}: {}", it.name, it.about))));
    format!("presets: {}\n{}\n", names.join(", "), told.collect::<String>())
}

/// What the model computes, line by line, with its symbols.
///
/// Of a model with formulas of its own, which stand on the page as they are written, it is what they are based on.
fn equations(model: &Model) -> String {
    let (model, of) = match model.base() {
        Some(base) => (base, format!(" of {}", base.name)),
        None => (model, String::new()),
    };
    let Some(FormulaEquations { lines, margins, .. }) = model.equations().filter(|it| !it.lines.is_empty()) else { return String::new() };
    let mut grid = TextGrid::default();
    for EquationLine { depth, left, right, source, .. } in lines {
        let indent = "  ".repeat(depth);
        let source = if source.is_empty() { String::new() } else { dim(&format!("  {source}")) };
        grid.row(if left.is_empty() {
            [format!("{indent}{right}"), String::new()]
        } else {
            [format!("{indent}{left}"), format!("= {right}{source}")]
        });
    }
    let mut statuses = TextGrid::default();
    for (condition, margin) in model.conditions.iter().zip(margins) {
        let sign = if condition.strict { ">" } else { ">=" };
        let reason = if condition.quiet { format!("absent: {}", condition.invalidates.join(", ")) } else { condition.reason.clone() };
        statuses.row([reason, format!("unless {margin} {sign} 0")]);
    }
    let head = bold(&format!("equations{of}, in SI units and radians"));
    format!("  {head}\n{}\n{}\n", grid.indented(2), statuses.indented(2))
}

/// A table with a sentence below each row but the first: beside the numbers the sentence would not fit a terminal.
fn described(table: &TextGrid, sentences: impl Iterator<Item = String>) -> String {
    let mut rows = table.indented_rows(2).into_iter();
    let head = rows.next().unwrap_or_default();
    let rows = rows.zip(sentences).map(|(row, sentence)| format!("{row}{}\n", dim(&format!("      {sentence}"))));
    head + &rows.collect::<String>()
}

/// Sentences that say what an input takes the place of, and for which words of which input it is read, if not always.
fn only_for(input: &Input) -> String {
    let replaced = input.instead_of.as_ref().map_or_else(String::new, |other| format!(" A number takes the place of {other}."));
    let read = input.only_for.as_ref().map_or_else(String::new, |it| format!(" Read for {} only.", it.in_words()));
    replaced + &read
}

/// A model as JSON, with everything of its tables.
fn describe(model: &Model) -> Value {
    let range = |range: &Range| {
        json!({
            "low": number(range.low),
            "includes_low": range.includes_low,
            "high": range.high.is_finite().then(|| number(range.high)),
            "includes_high": range.includes_high,
        })
    };
    let defaults = model.spelled_out(&model.defaults());
    let inputs = model.inputs.iter().enumerate().map(|(at, input)| {
        // A single word beside a range of numbers is `word`; several are listed in `words`.
        let word = if let [(word, _)] = &input.words[..] { Some(word) } else { None };
        let mut described = json!({
            "name": input.name, "symbol": input.symbol, "unit": input.unit.symbol,
            "default": value_of(model, at, defaults[at]),
            "valid": range(&input.valid), "usual": (input.usual != ANY).then(|| [number(input.usual.0), number(input.usual.1)]), "integer": input.integer,
            "word": word, "follows": input.follows, "doc": input.doc, "source": input.source,
        });
        if input.is_enumeration() {
            (described["valid"], described["usual"]) = (Value::Null, Value::Null);
        }
        if input.words.len() > 1 {
            described["words"] = input.words.iter().map(|(word, _)| word.as_str()).collect();
        }
        if let Some(other) = &input.instead_of {
            described["instead_of"] = other.as_str().into();
        }
        if let Some(only_for) = &input.only_for {
            described["only_for"] = json!(only_for);
        }
        described
    });
    let outputs = model.outputs.iter().map(|output| {
        json!({
            "name": output.name, "symbol": output.symbol, "unit": output.unit.symbol,
            "worst": if output.worse == Worse::Higher { "highest" } else { "lowest" },
            "doc": output.doc, "source": output.source,
        })
    });
    let conditions = model.conditions.iter().filter(|it| !it.quiet).map(|condition| {
        let absent = condition.invalidates.iter().filter(|name| model.output(name).is_some()).collect::<Vec<_>>();
        json!({ "status": condition.reason, "unless": condition.doc, "absent": absent })
    });
    let presets: Map<_, _> = model
        .presets
        .iter()
        .map(|preset| {
            let value = |(input, value): &(String, f64)| {
                let at = model.input(input).expect("a preset names inputs of its model");
                (input.clone(), value_of(model, at, *value))
            };
            let values: Map<_, _> = preset.changes.iter().map(value).collect();
            (preset.name.clone(), Value::from(values))
        })
        .collect();
    let mut described = json!({
        "name": model.name, "summary": model.summary, "source": model.source, "limits": model.limits,
        "gpu": model.on_gpu,
        "inputs": inputs.collect::<Vec<_>>(), "outputs": outputs.collect::<Vec<_>>(),
        "statuses": conditions.collect::<Vec<_>>(), "presets": presets,
    });
    if !model.formulas().is_empty() {
        described["formulas"] = model.formulas().into_iter().map(|(name, text)| json!({ "name": name, "is": text })).collect();
    }
    described
}

#[cfg(test)]
mod tests {
    use super::super::unlike::{cpu_only, with_a_section};
    use super::*;

    #[test]
    fn an_enumeration_is_listed_with_its_words_and_what_it_decides() {
        let page = page(&with_a_section());
        let line = |start: &str| page.lines().find(|line| line.trim_start().starts_with(start)).expect("it is listed").to_owned();
        assert_eq!(
            line("section ").split_whitespace().collect::<Vec<_>>().join(" "),
            r#"section pressed-cup any "machined", "welded-discs" or "pressed-cup""#
        );
        assert!(page.contains("Mass of a disc. [chosen] Read for section = \"machined\" or \"welded-discs\" only."), "{page}");
    }

    #[test]
    fn a_model_for_the_cpu_only_says_so() {
        let says = |model: &Model| page(model).contains("Computed in f64 on the CPU only.");
        assert!(says(&cpu_only()) && !says(&with_a_section()));
        assert_eq!((&describe(&cpu_only())["gpu"], &describe(&with_a_section())["gpu"]), (&json!(false), &json!(true)));
    }

    #[test]
    fn json_has_the_words_of_an_enumeration_and_what_it_decides() {
        let described = describe(&with_a_section());
        let inputs = described["inputs"].as_array().expect("a list");
        let [section, mass] = [&inputs[inputs.len() - 2], &inputs[inputs.len() - 1]];
        assert_eq!(section["words"], json!(["machined", "welded-discs", "pressed-cup"]));
        assert_eq!((&section["default"], &section["valid"], &section["word"]), (&json!("pressed-cup"), &Value::Null, &Value::Null));
        assert_eq!(mass["only_for"], json!({ "input": "section", "words": ["machined", "welded-discs"] }));
        assert!(inputs[0].get("only_for").is_none() && inputs[0].get("words").is_none());
        assert_eq!(described["presets"]["welded"], json!({ "section": "welded-discs" }));
    }
}
