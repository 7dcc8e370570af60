//! `beltspace check`: checks a study and estimates its run.

use super::{read_study, threads};
use crate::terminal::{self, TextGrid, bold, grouped, scaled, span};
use beltspace::error::Result;
use beltspace::memory::{Needs, large_files};
use beltspace::models::Set;
use beltspace::plan::Plan;
use beltspace::study::Axis;
use beltspace::sweep::costs::{PATIENCE, Speed, why_every_design};
use std::path::Path;
use std::time::Duration;

/// How long the speed is measured.
const TRIAL: Duration = Duration::from_millis(300);

pub fn run(path: &Path) -> Result<()> {
    let (study, _) = read_study(path)?;
    let plan = Plan::new(study);
    let study = &plan.study;
    let model = &study.model;
    let (designs, scenarios) = (plan.designs(), plan.scenarios());
    let name = |axis: &Axis| axis.inputs().iter().map(|&input| model.inputs[input].name.as_str()).collect::<Vec<_>>().join(" + ");

    let mut axes = TextGrid::default();
    for (role, list) in [("design", &study.design), ("operation", &study.operation), ("uncertainty", &study.uncertainty)] {
        for axis in list {
            let ends: Vec<_> = axis.inputs().iter().enumerate().map(|(column, &input)| ends(&plan, axis, column, input)).collect();
            let levels = if study.sample.is_some() && role == "design" { "sampled".to_owned() } else { grouped(axis.count()) };
            axes.row([role.to_owned(), name(axis), levels, ends.join(", ")]);
        }
    }
    let mut formulas = TextGrid::default();
    for (name, text) in model.formulas() {
        formulas.row([bold("formula"), name.to_owned(), terminal::told(text)]);
    }
    let cores = threads(None);
    let speed = Speed::measured(&plan, cores, TRIAL);
    #[allow(clippy::cast_precision_loss, reason = "an estimate for people")]
    let evaluations = designs as f64 * scenarios as f64;
    // The sample that shows what limits feasibility and a list of all designs are judged a second time.
    let listed = if study.report.variants { designs } else { 0 };
    let seconds = [designs, designs.min(model.sample), listed].iter().map(|&judged| speed.of(judged, cores)).sum();
    let method = match why_every_design(&plan, speed.of(designs, cores)) {
        Some(why) => format!("every design: {why}"),
        None => format!("bounds; if they are not faster, every design after at most about {}", span(PATIENCE * seconds)),
    };
    let mut facts = TextGrid::default();
    let mut fact = |what: &str, value: String| facts.row([bold(what), value]);
    fact("model", format!("{}: {}", model.name, model.summary));
    fact("designs", grouped(designs));
    fact("scenarios", grouped(scenarios));
    fact("evaluations", format!("{evaluations:.3e}"));
    fact(
        "expected time",
        format!(
            "about {} plus the time for the front, on {cores} threads, {}designs/s ({})",
            span(seconds),
            scaled(speed.of(1, cores).recip()),
            speed.how()
        ),
    );
    fact("method", method);
    let needs = Needs::of(&plan, cores, true);
    let front =
        if study.objectives.is_empty() { String::new() } else { format!(", with about {} designs on the front", grouped(needs.front)) };
    fact("memory", format!("about {} MB{front}", needs.run.div_ceil(1_000_000)));
    for (name, bytes) in large_files(&plan, needs.front) {
        fact("large file", format!("{name}, about {} MB", grouped(bytes / 1_000_000)));
    }
    let mut text = format!("{}\n\n{}\n", bold(&terminal::told(&study.title)), axes.indented(2));
    if !model.formulas().is_empty() {
        text.push_str(&format!("{}\n", formulas.indented(2)));
    }
    text.push_str(&facts.indented(0));
    for warning in warnings(&plan, &name) {
        text.push_str(&format!("{} {warning}\n", bold("warning:")));
    }
    terminal::print(&text)
}

fn ends(plan: &Plan, axis: &Axis, column: usize, input: usize) -> String {
    let table = &plan.study.model.inputs[input];
    let text = |value: f64| table.word_for(value).map_or_else(|| terminal::short(value), str::to_owned);
    if table.is_enumeration() {
        let mut words: Vec<String> = Vec::new();
        for word in (0..axis.count()).map(|level| text(axis.value(column, level))) {
            if !words.contains(&word) {
                words.push(word);
            }
        }
        return words.join(" or ");
    }
    let (low, high) = axis.ends(column);
    if low == high { text(low) } else { format!("{} to {}", text(low), text(high)) }
}

fn warnings(plan: &Plan, name: &impl Fn(&Axis) -> String) -> Vec<String> {
    let study = &plan.study;
    let mut warnings = Vec::new();
    for axis in plan.inert_axes() {
        let axis = &study.design[axis];
        warnings.push(format!(
            "{} changes nothing that the study asks for: its {} levels only multiply the work and add equal designs",
            name(axis),
            grouped(axis.count())
        ));
    }
    let roles = study.design.iter().chain(&study.operation).chain(&study.uncertainty);
    let mut set = Set::EMPTY;
    for axis in roles {
        for (column, &input) in axis.inputs().iter().enumerate() {
            set.insert(input);
            unusual(plan, input, axis.ends(column), &mut warnings);
        }
    }
    for (input, &value) in study.fixed.iter().enumerate().filter(|&(input, _)| !set.contains(input)) {
        unusual(plan, input, (value, value), &mut warnings);
    }
    if study.constraints.is_empty() {
        warnings.push("there are no constraints: every design with status ok is feasible".to_owned());
    }
    warnings
}

fn unusual(plan: &Plan, input: usize, (low, high): (f64, f64), warnings: &mut Vec<String>) {
    let table = &plan.study.model.inputs[input];
    let outside = |value: f64| table.word_for(value).is_none() && !(table.usual.0..=table.usual.1).contains(&value);
    if outside(low) || outside(high) {
        let value = if low == high { terminal::short(low) } else { format!("{} to {}", terminal::short(low), terminal::short(high)) };
        warnings
            .push(format!("{} = {value} lies outside {} to {}, which the model's source covers", table.name, table.usual.0, table.usual.1));
    }
}
