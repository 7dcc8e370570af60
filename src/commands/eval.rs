//! `beltspace eval`: evaluates one design of a model or of a study.

use super::settings::{inputs_of, no_preset};
use super::{CommandTarget, draws, read_study, read_study_what_if, rows, target, threads};
use crate::cli;
use crate::terminal::report::draw_limits;
use crate::terminal::{self, TextGrid, bold, counted, dim, short};
use beltspace::certify;
use beltspace::error::{Error, Result};
use beltspace::export::{DrawnTally, pulley};
use beltspace::files::{MOVE, refuse_foreign, refuse_without_folder, replace};
use beltspace::models::{self, Evaluation, Evaluator, Model, Profile, Status, evaluate};
use beltspace::names::is_picture;
use beltspace::pictures::{self, PlotQuantity, Series};
use beltspace::plan::Plan;
use beltspace::probability::Effect;
use beltspace::screen::Control;
use beltspace::study::{Axis, Label, Levels, Quantity, ReportColumn, Study, number, value_of};
use beltspace::table::{Data, Table, TableColumn, csv_text};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

pub fn run(request: &cli::EvalArgs) -> Result<()> {
    if let Some(rows) = &request.table {
        return rows::run(request, rows);
    }
    let model = match target(&request.target)? {
        CommandTarget::Study(path) => return of_study(request, path),
        CommandTarget::Model(model) => model,
    };
    if request.design.is_some() {
        return Err(Error::Request(format!("--design is for studies, and {} is a model; use --set", model.name)));
    }
    let inputs = inputs_of(&model, request.preset.as_deref(), &request.set)?;
    print_one(&model, &inputs, None, request)
}

/// A design of a study in one of its scenarios; the user knows it by `number`.
struct ShownDesign<'p> {
    plan: &'p Plan,
    design: u64,
    number: u64,
    scenario: u64,
}

/// Prints one design in one scenario.
fn print_one(model: &Model, inputs: &[f64], of_study: Option<ShownDesign<'_>>, request: &cli::EvalArgs) -> Result<()> {
    let evaluation = evaluate(model, inputs);
    let spelled_out = model.spelled_out(inputs);
    let inputs = &spelled_out;
    for input in
        model.inputs.iter().zip(inputs).filter(|(it, value)| it.word_for(**value).is_none() && !(it.usual.0..=it.usual.1).contains(*value))
    {
        let (input, value) = input;
        terminal::remark(
            "note",
            &format!("{} = {value} lies outside {} to {}, which the source covers", input.name, input.usual.0, input.usual.1),
        );
    }
    model.notes_on(inputs, &evaluation).iter().for_each(|note| terminal::remark("note", note));
    along_the_belt(model, inputs, &evaluation, request)?;
    let reason = evaluation.status.reason(model);
    if request.json {
        let mut object = json!({ "model": model.name, "inputs": named_inputs(model, inputs), "outputs": named_outputs(model, &evaluation), "status": reason });
        if let Some(ShownDesign { plan, design, number, scenario }) = of_study {
            object["design"] = number.into();
            object["scenario"] = scenario.into();
            add_labels(plan, design, &mut object);
        }
        return terminal::print(&format!("{object:#}\n"));
    }
    let mut table = TextGrid::default();
    if let Some(ShownDesign { plan, design, .. }) = of_study {
        label_rows(plan, design, &mut table);
    }
    for (number, (input, &value)) in model.inputs.iter().zip(inputs).enumerate() {
        let text = match input.word_for(value) {
            _ if model.is_replaced(&input.name, inputs) => "-".to_owned(),
            Some(word) => word.to_owned(),
            None => short(value),
        };
        table.row([input.name.to_owned(), text, dim(&doc_of(model, number, |other| Some(inputs[other])))]);
    }
    let mut results = TextGrid::default();
    for (output, value) in model.outputs.iter().zip(&evaluation.outputs) {
        results.row([output.name.to_owned(), value.map_or("-".to_owned(), short), dim(&output.doc)]);
    }
    let why = match evaluation.status {
        Status::Ok => String::new(),
        Status::Failed(condition) => format!("  (unless: {})", model.conditions[usize::from(condition)].doc),
        Status::Overflow => "  (a value is too large for a 64-bit number)".to_owned(),
    };
    terminal::tell(&format!(
        "{}\n{}\n{}\n{}\n{} {reason}{why}\n",
        bold("inputs"),
        table.indented(2),
        bold("outputs"),
        results.indented(2),
        bold("status")
    ))
}

/// What an input is, and that it is not read where the words of other inputs say so.
fn doc_of(model: &Model, input: usize, value: impl Fn(usize) -> Option<f64>) -> String {
    let doc = &model.inputs[input].doc;
    if model.is_unread(input, value) { format!("Not read here. {doc}") } else { doc.clone() }
}

/// The labels of a design, before its inputs.
fn label_rows(plan: &Plan, design: u64, table: &mut TextGrid) {
    for (label, text) in plan.study.labels.iter().zip(plan.labels(design)) {
        table.row([label.name.clone(), terminal::told(text), dim("Label, as the catalogue has it.")]);
    }
}

/// The same in JSON, if the study has labels.
fn add_labels(plan: &Plan, design: u64, object: &mut Value) {
    let labels = plan.study.labels.iter().zip(plan.labels(design)).map(|(label, text)| (label.name.clone(), Value::from(text)));
    let labels: Map<_, _> = labels.collect();
    if !labels.is_empty() {
        object["labels"] = labels.into();
    }
}

fn named_inputs(model: &Model, inputs: &[f64]) -> Map<String, Value> {
    model.inputs.iter().enumerate().map(|(at, input)| (input.name.to_owned(), value_of(model, at, inputs[at]))).collect()
}

fn named_outputs(model: &Model, evaluation: &Evaluation) -> Map<String, Value> {
    let present = model.outputs.iter().zip(&evaluation.outputs).filter_map(|(output, value)| Some((&output.name, (*value)?)));
    present.map(|(name, value)| (name.to_owned(), number(value))).collect()
}

/// Writes `--profile` and `--plot`.
fn along_the_belt(model: &Model, inputs: &[f64], evaluation: &Evaluation, request: &cli::EvalArgs) -> Result<()> {
    if request.profile.is_none() && request.plot.is_none() {
        return Ok(());
    }
    if model.profile.is_none() {
        let with: Vec<_> = models::all().iter().filter(|it| it.profile.is_some()).map(|it| it.name.as_str()).collect();
        return Err(Error::Request(format!(
            "{} has no values along the belt for --profile and --plot; models that have them: {}",
            model.name,
            with.join(", ")
        )));
    }
    if evaluation.status != Status::Ok {
        return Err(Error::Request(format!("no values along the belt: the status is \"{}\"", evaluation.status.reason(model))));
    }
    refuse_foreign_files(model, request)?;
    let Some(Profile { columns, rows }) = model.along_the_belt(inputs) else { return Ok(()) };
    let column = |at: usize| rows.iter().map(|row| row[at]).collect::<Vec<_>>();
    if let Some(path) = &request.profile {
        let columns = columns.iter().enumerate().map(|(at, it)| TableColumn {
            unit: it.unit.symbol.to_owned(),
            ..TableColumn::new(&it.name, "profile", "", Data::Number(column(at).into_iter().map(Some).collect()))
        });
        replace(path, &csv_text(&Table { columns: columns.collect() }))?;
    }
    if let Some(path) = &request.plot {
        let mut panels: Vec<(PlotQuantity, Vec<Series>)> = Vec::new();
        for (at, it) in columns.iter().enumerate().skip(1) {
            let Some(drawn) = &it.drawn else { continue };
            let series = Series { label: it.label.clone(), x: column(0), y: column(at) };
            match panels.iter_mut().find(|(quantity, _)| quantity.name == *drawn) {
                Some((_, beside)) => beside.push(series),
                None => panels.push((PlotQuantity::new(drawn, it.unit.symbol), vec![series])),
            }
        }
        let position = PlotQuantity::new(&columns[0].name, columns[0].unit.symbol);
        replace(path, pictures::curves(&model.summary, &position, &panels).as_bytes())?;
        // A pulley has more pictures than the curves: they are written beside the file, with names that begin like its own.
        for (name, text) in pulley::pictures(model, &model.summary, inputs) {
            replace(&beside(path, name), text.as_bytes())?;
        }
    }
    Ok(())
}

/// `--profile` and `--plot` replace files that such a request wrote before, and no others.
fn refuse_foreign_files(model: &Model, request: &cli::EvalArgs) -> Result<()> {
    [&request.profile, &request.plot].into_iter().flatten().try_for_each(|path| refuse_without_folder(path))?;
    if let Some(path) = &request.profile {
        let headers: Vec<String> = models::all()
            .iter()
            .filter_map(|model| model.along_the_belt(&model.defaults()))
            .map(|profile| profile.columns.iter().map(|it| it.name.as_str()).collect::<Vec<_>>().join(",") + "\n")
            .collect();
        refuse_foreign(path, MOVE, |head| headers.iter().any(|header| head.starts_with(header)))?;
    }
    let Some(path) = &request.plot else { return Ok(()) };
    let further = if model.pulley.is_some() { &pulley::PICTURES[..] } else { &[] };
    let pictures = std::iter::once(path.clone()).chain(further.iter().map(|name| beside(path, name)));
    pictures.into_iter().try_for_each(|path| refuse_foreign(&path, MOVE, is_picture))
}

/// `plot.svg` and `section` make `plot-section.svg`.
fn beside(path: &Path, name: &str) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().map_or_else(String::new, |it| format!(".{}", it.to_string_lossy()));
    path.with_file_name(format!("{stem}-{name}{extension}"))
}

/// A study and the design of it that is asked for.
pub(super) fn studied(path: &Path, design: Option<u64>) -> Result<(Plan, u64)> {
    let (study, _) = read_study(path)?;
    let plan = Plan::new(study);
    let designs = plan.designs();
    let design = design.ok_or_else(|| Error::Request(format!("which design? use --design N, from 0 to {}", designs - 1)))?;
    if design >= designs {
        return Err(Error::Request(format!("there is no design {design}; the study's designs are 0 to {}", designs - 1)));
    }
    Ok((plan, design))
}

fn of_study(request: &cli::EvalArgs, path: &Path) -> Result<()> {
    if request.preset.is_some() {
        return Err(no_preset());
    }
    let (own, number) = studied(path, request.design)?;
    let (plan, design) = if request.set.is_empty() { (own, number) } else { (what_if(&own, number, path, &request.set)?, 0) };
    if request.draw.is_some() || (plan.study.probability.is_some() && request.scenario.is_some()) {
        let (one, scenario, inputs) = draws::drive(&plan, design, request)?;
        return print_one(&one.study.model, &inputs, Some(ShownDesign { plan: &one, design, number, scenario }), request);
    }
    let model = &plan.study.model;
    let scenarios = plan.scenarios();
    if plan.study.probability.is_some() && (request.profile.is_some() || request.plot.is_some()) {
        return Err(Error::Request(
            "--profile and --plot show one drive; add --scenario K, and --draw N unless it is to be that at the medians".to_owned(),
        ));
    }
    if let Some(scenario) = request.scenario.or((scenarios == 1 && plan.study.probability.is_none()).then_some(0)) {
        if scenario >= scenarios {
            return Err(Error::Request(format!("there is no scenario {scenario}; the study's scenarios are 0 to {}", scenarios - 1)));
        }
        let shown = ShownDesign { plan: &plan, design, number, scenario };
        return print_one(model, &plan.space.inputs(design, scenario), Some(shown), request);
    }
    if request.profile.is_some() || request.plot.is_some() {
        return Err(Error::Request(format!("--profile and --plot show one scenario; add --scenario K, from 0 to {}", scenarios - 1)));
    }
    print_worst(&plan, design, number, request)
}

/// The study of this one design, with what `--set` says.
fn what_if(own: &Plan, design: u64, path: &Path, set: &[String]) -> Result<Plan> {
    let mut study = read_study_what_if(path, set)?;
    let inputs = own.space.inputs(design, 0);
    let is_set = |name: &str| set.iter().any(|it| it.split('=').next().is_some_and(|it| it.trim() == name));
    // A formula that gave an input may be gone, so inputs have other numbers.
    let model = study.model.clone();
    let value = |axis: &Axis, column: usize| {
        let name = &model.inputs[axis.inputs()[column]].name;
        own.study.model.input(name).filter(|_| !is_set(name)).map_or_else(|| axis.value(column, 0), |own| inputs[own])
    };
    let alone = |axis: &Axis| -> Vec<Axis> {
        let level = |(column, &input): (usize, &usize)| Axis::Single { input, levels: Levels::List(vec![value(axis, column)]) };
        axis.inputs().iter().enumerate().map(level).collect()
    };
    study.design = study.design.iter().flat_map(alone).collect();
    let texts = own.study.labels.iter().zip(own.labels(design));
    study.labels = texts.map(|(label, text)| Label { name: label.name.clone(), axis: 0, texts: vec![text.to_owned()] }).collect();
    study.sample = None;
    Ok(Plan::new(study))
}

/// Prints the inputs of a design, which the user knows by `number`, every output at its worst scenario, and the constraints with their
/// margins.
fn print_worst(plan: &Plan, design: u64, number_of: u64, request: &cli::EvalArgs) -> Result<()> {
    let study = &plan.study;
    let model = &study.model;
    // As if the study asked for every output as a report column.
    let mut everything = Study::clone(study);
    let further = study.report.columns.iter().copied().filter(|it| *it != ReportColumn::from(it.of));
    everything.report.columns = (0..model.outputs.len()).map(|output| Quantity::Output(output).into()).chain(further).collect();
    // Proven bounds are told with what they took.
    everything.report.columns.retain(|it| !study.is_proven(it.of));
    let columns = certify::columns(&everything);
    let row = certify::rows(plan, &columns, &[design], 1, &Control::default())?.remove(0);
    let mut evaluator = Evaluator::new(model);
    let statuses = (0..plan.scenarios())
        .map(|scenario| (scenario, evaluator.evaluate(&plan.space.inputs(design, scenario), plan.used_outputs()).status));
    let failed = statuses.filter(|(_, status)| *status != Status::Ok).collect::<Vec<_>>();
    let status = failed.first().map_or(Status::Ok, |(_, status)| *status).reason(model);

    let mut varied: Vec<usize> = study.operation.iter().chain(&study.uncertainty).flat_map(|axis| axis.inputs()).copied().collect();
    if let Some(probability) = &study.probability {
        varied.extend(probability.drive.operation.iter().flat_map(|axis| axis.inputs()));
        varied.extend(probability.inputs.iter().filter(|it| it.acts() == Effect::Is).map(|it| it.input));
    }
    let inputs = (0..model.inputs.len()).filter(|input| !varied.contains(input));
    let enclosed = draws::enclosed(study, design)?;
    let failing = DrawnTally::of_design(plan, design, threads(None), &Control::default())?;
    let cases = draws::DrawnCases::of(plan, design);
    let at_worst = |name: &str, suffix: &str| {
        let name = format!("{name}{suffix}");
        columns.iter().position(|column| column.name == name).map(|at| row.columns[at])
    };
    let constraints = study.constraints.iter().map(|constraint| {
        let name = constraint.name(model);
        let worst = at_worst(&name, "_constrained").or_else(|| at_worst(&name, ""));
        (constraint, worst.filter(|it| it.value.is_some()))
    });
    if request.json {
        let inputs: Map<_, _> =
            inputs.map(|input| (model.inputs[input].name.to_owned(), value_of(model, input, row.inputs[input]))).collect();
        let outputs = columns
            .iter()
            .zip(&row.columns)
            .filter_map(|(column, at)| Some((column.name.clone(), json!({ "value": number(at.value?), "scenario": at.scenario }))));
        let constraints = constraints.map(|(constraint, worst)| {
            let value = worst.and_then(|it| it.value);
            json!({
                "of": constraint.name(model), "bounds": constraint.in_words(), "value": value.map(number),
                "margin": value.map(|value| number(constraint.margin(value))), "scenario": worst.map(|it| it.scenario),
                "holds": value.is_some_and(|value| constraint.holds(value)),
            })
        });
        let mut object = json!({
            "model": model.name, "design": number_of, "inputs": inputs, "outputs": outputs.collect::<Map<_, _>>(),
            "constraints": constraints.collect::<Vec<_>>(), "status": status, "feasible": row.feasible,
            "scenarios": plan.scenarios(), "scenarios_not_ok": failed.len(),
        });
        add_labels(plan, design, &mut object);
        if let Some((found, _)) = enclosed {
            object["enclosure"] =
                json!({ "yield_at_least": number(found.at_least), "yield_at_most": number(found.at_most), "boxes": found.boxes });
        }
        if !request.set.is_empty() {
            object["set"] = json!(request.set);
        }
        if let Some(failing) = failing {
            object["draws_fail_at"] = failing.to_json(plan, "this design");
        }
        if let Some(cases) = cases {
            object["cases_of_a_draw"] = cases.to_json();
        }
        return terminal::print(&format!("{object:#}\n"));
    }
    let mut table = TextGrid::default();
    label_rows(plan, design, &mut table);
    for input in inputs {
        let value = row.inputs[input];
        let text = model.inputs[input].word_for(value).map_or_else(|| short(value), str::to_owned);
        let known = |other: usize| (!varied.contains(&other)).then_some(row.inputs[other]);
        table.row([model.inputs[input].name.to_owned(), text, dim(&doc_of(model, input, known))]);
    }
    let mut results = TextGrid::default();
    results.row(["", "worst", "in scenario", ""].map(str::to_owned));
    for (column, at) in columns.iter().zip(&row.columns) {
        let value = at.value.map_or("-".to_owned(), short);
        results.row([column.name.clone(), value, at.scenario.to_string(), dim(&column.doc(study))]);
    }
    if let Some((found, words)) = enclosed {
        let doc = dim(&format!("Proven for the distributions themselves, not for draws of them ({words})."));
        results.row(["yield_at_least".to_owned(), short(found.at_least), String::new(), doc]);
        results.row(["yield_at_most".to_owned(), short(found.at_most), String::new(), String::new()]);
    }
    let mut margins = TextGrid::default();
    for (constraint, worst) in constraints {
        let value = worst.and_then(|it| it.value);
        let verdict = match value {
            Some(value) if constraint.holds(value) => "holds".to_owned(),
            Some(_) => bold("violated"),
            None => bold("no value"),
        };
        let margin = value.map_or("-".to_owned(), |value| short(constraint.margin(value)));
        margins.row([constraint.name(model), constraint.in_words(), verdict, "margin".to_owned(), margin]);
    }
    let not_ok = failed.first().map_or(String::new(), |(scenario, _)| {
        let are = if failed.len() == 1 { "is" } else { "are" };
        format!(" in scenario {scenario} ({} of {} {are} not ok)", failed.len(), counted(plan.scenarios(), "scenario"))
    });
    let with = if request.set.is_empty() { String::new() } else { format!(" with {}", request.set.join(", ")) };
    let of_all = match &study.probability {
        None => format!("worst of {}", counted(plan.scenarios(), "scenario")),
        Some(it) if it.levels == 1 => format!("over {}", counted(it.draws, "draw")),
        Some(it) => format!("over {}, worst of {}", counted(it.draws, "draw"), counted(it.levels, "level")),
    };
    terminal::tell(&format!(
        "{} {number_of}{with}, {of_all}\n\n{}\n{}\n{}\n{}\n{}\n{}\n{} {status}{not_ok}\n{} {}\n{}{}",
        bold("design"),
        bold("inputs"),
        table.indented(2),
        bold("outputs"),
        results.indented(2),
        bold("constraints"),
        margins.indented(2),
        bold("status"),
        bold("feasible"),
        if row.feasible { "yes" } else { "no" },
        failing.map_or_else(String::new, |it| draw_limits(&it, study)),
        cases.map_or_else(String::new, |it| it.table()),
    ))
}
