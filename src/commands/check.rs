//! `beltspace check`: checks a study and estimates its run.

use super::{draws, read_study_with, tell_short_ranges, threads};
use crate::cli;
use crate::terminal::{self, TextGrid, bold, counted, grouped, scaled, span};
use beltspace::error::{Error, Result};
use beltspace::memory::{Needs, large_files, most_feasible};
use beltspace::plan::Plan;
use beltspace::reduce::FEASIBLE_FILE;
use beltspace::run::warnings;
use beltspace::study::{Axis, StudyEdits};
use beltspace::sweep::costs::{PATIENCE, Speed, why_every_design};
use beltspace::sweep::{BoundsTrial, try_bounds};
use std::time::Duration;

/// How long the speed is measured.
const TRIAL: Duration = Duration::from_millis(300);
/// And how long bounds are tried, where the sweep would begin by them.
const TRIAL_OF_BOUNDS: Duration = Duration::from_millis(1500);
/// Seconds from which on a run is warned of.
const A_DAY: f64 = 86_400.0;

pub fn run(request: &cli::CheckArgs) -> Result<()> {
    let (study, _) = read_study_with(&request.study, StudyEdits { set: &request.set, feasible: request.feasible })?;
    let plan = Plan::new(study);
    let study = &plan.study;
    tell_short_ranges(study);
    let model = &study.model;
    let (designs, scenarios) = (plan.designs(), plan.scenarios());
    let name = |axis: &Axis| axis.inputs().iter().map(|&input| model.inputs[input].name.as_str()).collect::<Vec<_>>().join(" + ");

    let mut axes = TextGrid::default();
    for (role, list) in [("design", &study.design), ("operation", &study.operation), ("uncertainty", &study.uncertainty)] {
        for axis in list {
            let ends: Vec<_> = axis.inputs().iter().enumerate().map(|(column, &input)| ends(&plan, axis, column, input)).collect();
            let levels = if study.sample.is_some() && role == "design" { "sampled".to_owned() } else { grouped(axis.count()) };
            let weighted = study.spectrum.as_ref().filter(|it| std::ptr::eq(axis, &study.operation[it.axis]));
            let weights = weighted.map(|it| format!("{}, weighted by {}", it.name, it.weight));
            axes.row([role.to_owned(), name(axis), levels, ends.into_iter().chain(weights).collect::<Vec<_>>().join(", ")]);
        }
    }
    let mut of_draws: Vec<(String, String)> = Vec::new();
    if let Some(probability) = &study.probability {
        for axis in &probability.drive.operation {
            let ends: Vec<_> = axis.inputs().iter().enumerate().map(|(column, &input)| ends(&plan, axis, column, input)).collect();
            axes.row(["operation".to_owned(), name(axis), grouped(axis.count()), ends.join(", ")]);
        }
        draws::axes(probability, &mut axes);
        draws::facts(probability, |what, value| of_draws.push((what.to_owned(), value)))?;
        if let Some(path) = &request.draws {
            draws::write(probability, path)?;
        }
    } else if request.draws.is_some() {
        return Err(Error::Request("--draws is for studies with distributions; this one has none".to_owned()));
    }
    let mut formulas = TextGrid::default();
    for (name, text) in model.formulas() {
        formulas.row([bold("formula"), name.to_owned(), terminal::told(text)]);
    }
    let cores = threads(None);
    let speed = Speed::measured(&plan, cores, TRIAL);
    #[allow(clippy::cast_precision_loss, reason = "an estimate for people")]
    let evaluations = designs as f64 * scenarios as f64 * study.probability.as_ref().map_or(1.0, |it| it.evaluations() as f64);
    // The sample that shows what limits feasibility and a list of all designs are judged a second time.
    let listed = if study.report.variants || study.report.feasible { designs } else { 0 };
    let seconds = [designs, designs.min(model.sample), listed].iter().map(|&judged| speed.of(judged, cores)).sum();
    let rate = format!("on {}, {}designs/s ({})", counted(cores as u64, "thread"), scaled(speed.of(1, cores).recip()), speed.how());
    let one_by_one = format!("about {} plus the time for the front, {rate}", span(seconds));
    let mut by_trial = f64::INFINITY;
    let (method, expected) = match why_every_design(&plan, speed.of(designs, cores)) {
        Some(why) => (format!("every design: {why}"), one_by_one),
        None => {
            let left = span(PATIENCE * seconds);
            let method = format!("bounds; if they are not faster, every design after at most about {left}, {rate}");
            let trial = try_bounds(&plan, cores, TRIAL_OF_BOUNDS);
            by_trial = trial.as_ref().map_or(f64::INFINITY, BoundsTrial::expected);
            (method, by_bounds(trial, seconds, &one_by_one))
        }
    };
    if by_trial > A_DAY {
        warn_of_days(designs, seconds, cores, by_trial.is_finite());
    }
    let mut facts = TextGrid::default();
    let mut fact = |what: &str, value: String| facts.row([bold(what), value]);
    fact("model", format!("{}: {}", model.name, model.summary));
    fact("designs", grouped(designs));
    fact("scenarios", grouped(scenarios));
    of_draws.into_iter().for_each(|(what, value)| fact(&what, value));
    fact("evaluations", format!("{evaluations:.3e}"));
    fact("expected time", expected);
    fact("method", method);
    let needs = Needs::of(&plan, cores, true);
    let front =
        if study.objectives.is_empty() { String::new() } else { format!(", with about {} on the front", counted(needs.front, "design")) };
    fact("memory", format!("about {} MB{front}", needs.run.div_ceil(1_000_000)));
    if let Some(size) = feasible_file(&plan) {
        fact("feasible file", size);
    }
    for (name, bytes) in large_files(&plan, needs.front) {
        fact("large file", format!("{name}, about {} MB", grouped(bytes / 1_000_000)));
    }
    let mut text = format!("{}\n\n{}\n", bold(&terminal::told(&study.title)), axes.indented(2));
    if !model.formulas().is_empty() {
        text.push_str(&format!("{}\n", formulas.indented(2)));
    }
    text.push_str(&facts.indented(0));
    for warning in warnings(&plan) {
        text.push_str(&format!("{} {warning}\n", bold("warning:")));
    }
    terminal::tell(&text)
}

/// Warns of a run that is expected to take more than a day, if bounds do not settle it sooner.
pub(super) fn warn_of_days(designs: u64, seconds: f64, threads: usize, by_bounds: bool) {
    if seconds <= A_DAY {
        return;
    }
    let sooner = if by_bounds { ", if bounds do not settle them sooner" } else { "" };
    terminal::remark(
        "warning",
        &format!(
            "judging all {} takes about {} on {}{sooner}; larger steps and narrower axes make fewer designs, [sample] draws some of them, \
             fewer levels in [operation] and [uncertainty] make each cheaper, and beltspace slurm divides the work among machines",
            counted(designs, "design"),
            span(seconds),
            counted(threads as u64, "thread"),
        ),
    );
}

/// How long the method that begins by bounds is expected to take, where judging one by one takes so many `seconds`.
fn by_bounds(trial: Option<BoundsTrial>, seconds: f64, one_by_one: &str) -> String {
    match trial {
        Some(BoundsTrial::Finished(time)) => format!("about {} by bounds (tried: they settled every design)", span(time)),
        Some(trial @ BoundsTrial::Begun { settled, seconds: time }) if trial.expected() < seconds => format!(
            "about {} by bounds (tried for {}: {} % of the work)",
            span(trial.expected()),
            span(time),
            terminal::short((settled * 1e3).round() / 10.0),
        ),
        Some(BoundsTrial::Begun { seconds: time, .. }) => {
            format!("unknown (bounds settled little in {}); every design one by one: {one_by_one}", span(time))
        }
        None => format!("unknown by bounds; every design one by one: {one_by_one}"),
    }
}

/// What the file of all feasible designs takes at most, if the study asks for it.
pub(super) fn feasible_file(plan: &Plan) -> Option<String> {
    let (rows, bytes) = most_feasible(plan)?;
    let size = grouped((rows * bytes).div_ceil(1_000_000));
    Some(format!("{FEASIBLE_FILE}, at most {} x {bytes} bytes = {size} MB", counted(rows, "design")))
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
