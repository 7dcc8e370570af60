//! `beltspace check`: a dry run.

use super::{read_study, threads};
use crate::terminal::{self, Grid, bold, grouped, scaled, span};
use beltspace::error::Result;
use beltspace::models::Effort;
use beltspace::plan::Plan;
use beltspace::reduce::Reduction;
use beltspace::screen::{BLOCK, CpuEngine, Tables};
use beltspace::study::Axis;
use std::path::Path;
use std::time::{Duration, Instant};

/// How long the speed is measured.
const TRIAL: Duration = Duration::from_millis(300);
/// Seconds above which a single design is not tried.
const LONGEST: f64 = 1.0;

pub fn run(path: &Path) -> Result<()> {
    let (study, _) = read_study(path)?;
    let plan = Plan::new(study);
    let study = &plan.study;
    let model = study.model;
    let tables = Tables::new(&plan);
    let (designs, scenarios) = (plan.designs(), plan.scenarios());
    let name = |axis: &Axis| axis.inputs().iter().map(|&input| model.inputs[input].name).collect::<Vec<_>>().join(" + ");

    let mut axes = Grid::default();
    for (role, list) in [("design", &study.design), ("operation", &study.operation), ("uncertainty", &study.uncertainty)] {
        for axis in list {
            let ends: Vec<_> = axis.inputs().iter().enumerate().map(|(column, &input)| ends(&plan, axis, column, input)).collect();
            let levels = if study.sample.is_some() && role == "design" { "sampled".to_owned() } else { grouped(axis.count()) };
            axes.row([role.to_owned(), name(axis), levels, ends.join(", ")]);
        }
    }
    let (rate, how) = match trial(&plan, &tables) {
        Some(rate) => (rate, "measured over a moment"),
        None => (plan.seconds_per_design().recip(), "by what the model usually takes"),
    };
    let cores = threads(None);
    #[allow(clippy::cast_precision_loss, reason = "an estimate for people")]
    let evaluations = designs as f64 * scenarios as f64;
    // The sample behind what limits feasibility and a list of all designs are judged once more.
    let listed = if study.report.variants { designs } else { 0 };
    let judged = designs as f64 + designs.min(model.sample) as f64 + listed as f64;
    let seconds = judged / rate / cores as f64;
    let mut facts = Grid::default();
    let mut fact = |what: &str, value: String| facts.row([bold(what), value]);
    fact("model", format!("{}: {}", model.name, model.summary));
    fact("designs", grouped(designs));
    fact("scenarios", grouped(scenarios));
    fact("evaluations", format!("{evaluations:.3e}"));
    fact(
        "expected time",
        format!("about {} and what the front takes, on {cores} threads, {}designs/s ({how})", span(seconds), scaled(rate * cores as f64)),
    );
    fact("memory", format!("about {} MB and what the front takes", memory(&plan, cores)));
    let mut text = format!("{}\n\n{}\n{}", bold(&study.title), axes.indented(2), facts.indented(0));
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

/// Designs per second of one thread, over rows spread over the study; `None` if a single design takes too long to try.
#[allow(clippy::cast_precision_loss, reason = "an estimate for people")]
fn trial(plan: &Plan, tables: &Tables) -> Option<f64> {
    let Effort { prepare, finish } = plan.effort();
    if prepare + finish > LONGEST {
        return None;
    }
    let reduction = Reduction::new(plan, &vec![(0.0, 1.0); plan.study.report.histograms.len()]);
    let mut reducers = reduction.start();
    let mut engine = CpuEngine::new(plan, tables);
    let start = Instant::now();
    let (mut judged, mut step) = (0u64, 0u64);
    // Of a slow model only the beginnings of rows are tried.
    let row = plan.fast.count();
    let affordable = ((TRIAL.as_secs_f64() - prepare) / finish) as u64;
    let piece = row.clamp(1, 16 * BLOCK as u64).min(affordable.max(1));
    let grid = if piece == affordable.max(1) { row } else { piece };
    while start.elapsed() < TRIAL && (step < 4 || judged < plan.designs()) {
        let first = plan.spread(step) / grid * grid;
        let last = plan.designs().min(first + piece);
        engine.screen(first..last, |block| reduction.absorb(&mut reducers, block));
        judged += last - first;
        step += 1;
    }
    let seconds = start.elapsed().as_secs_f64();
    if grid == piece {
        return Some(judged as f64 / seconds);
    }
    // How much longer than the model says it took, and what that means for whole rows.
    let expected = step as f64 * prepare + judged as f64 * finish;
    Some((plan.seconds_per_design() * seconds / expected).recip())
}

/// Megabytes that tables, bins, map cells and blocks take.
pub fn memory(plan: &Plan, threads: usize) -> u64 {
    let report = &plan.study.report;
    let cells: u64 = report.maps.iter().map(|map| plan.study.design[map.x].count() * plan.study.design[map.y].count()).sum();
    let bins: u64 = report.histograms.iter().map(|it| it.bins as u64).sum();
    let kept = plan.fast.count().min(1 << 15) * 8 * 2 * plan.study.model.inputs.len() as u64;
    let prepared = CpuEngine::prepared_bytes(plan) * threads as u64;
    (cells * 32 + bins * 8 * (threads as u64 + 1) + kept + prepared) / 1_000_000 + 10
}

fn warnings(plan: &Plan, name: &impl Fn(&Axis) -> String) -> Vec<String> {
    let study = &plan.study;
    let mut warnings = Vec::new();
    for axis in plan.inert_axes() {
        let axis = &study.design[axis];
        warnings.push(format!(
            "{} changes nothing that the study asks for: {} times the work for designs that tie",
            name(axis),
            grouped(axis.count())
        ));
    }
    let roles = study.design.iter().chain(&study.operation).chain(&study.uncertainty);
    let mut set = 0u64;
    for axis in roles {
        for (column, &input) in axis.inputs().iter().enumerate() {
            set |= 1 << input;
            unusual(plan, input, axis.ends(column), &mut warnings);
        }
    }
    for (input, &value) in study.fixed.iter().enumerate().filter(|(input, _)| set >> input & 1 == 0) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use beltspace::models::{Model, find};
    use beltspace::study::Study;

    #[test]
    fn a_design_that_takes_seconds_is_not_tried_and_a_slow_row_only_begun() {
        let model = find("pulley-load").expect("it is a model");
        let trial_of = |effort: Effort| {
            let mut study = Study::parse(model.starter, "study.toml", ".".as_ref()).expect("the starter is right");
            study.model = Box::leak(Box::new(Model { effort, ..*model }));
            let plan = Plan::new(study);
            (trial(&plan, &Tables::new(&plan)), plan.seconds_per_design().recip())
        };
        let (rate, expected) = trial_of(Effort { prepare: 60.0, finish: 0.0 });
        assert!(rate.is_none() && expected > 0.0);
        // It says that it is slow and is not: that is noticed.
        let (rate, expected) = trial_of(Effort { prepare: 1e-5, finish: 1e-5 });
        assert!(rate.is_some_and(|rate| rate > 3.0 * expected), "{rate:?} {expected}");
    }
}
