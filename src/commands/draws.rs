//! Draws of a study with distributions: what they are like, as a table, and one of them evaluated.

use crate::cli;
use crate::terminal::{TextGrid, bold, counted, grouped, short};
use beltspace::bounds::{EnclosureProblem, YieldBounds};
use beltspace::error::{Error, Result};
use beltspace::files::{MOVE, refuse_foreign, refuse_without_folder, replace};
use beltspace::plan::Plan;
use beltspace::probability::{Effect, Enclosure, pearson, spearman};
use beltspace::study::{Axis, Probability, Study, UncertainInput, value_of};
use beltspace::table::{Data, Table, TableColumn, csv_text};
use serde_json::{Map, Value, json};
use std::path::Path;

/// Most draws that correlations are shown of.
const SHOWN: u64 = 1 << 16;

/// What an input with a distribution is called in tables: that a factor or addend is drawn stands in its name.
fn column_name(it: &UncertainInput) -> String {
    match it.effect {
        Effect::Is => it.name.clone(),
        Effect::Times => format!("{}_times", it.name),
        Effect::Plus => format!("{}_plus", it.name),
    }
}

fn columns(probability: &Probability, draws: u64) -> Result<Vec<Vec<f64>>> {
    Ok(probability.choosing()?.columns(0..draws))
}

/// The axes of `check` that are drawn.
pub fn axes(probability: &Probability, grid: &mut TextGrid) {
    for it in &probability.inputs {
        grid.row(["drawn".to_owned(), it.name.clone(), String::new(), it.in_words()]);
    }
}

/// What else `check` says of the draws.
pub fn facts(probability: &Probability, mut fact: impl FnMut(&str, String)) -> Result<()> {
    let cases: u64 = probability.drive.operation.iter().map(Axis::count).product();
    let of_cases = if cases == 1 { String::new() } else { format!(", each in {}", counted(cases, "operating case")) };
    fact("draws", format!("{}{of_cases}; {} fresh ones judge what is reported", grouped(probability.draws), grouped(probability.confirm)));
    if !probability.correlation.is_empty() {
        let drawn = columns(probability, probability.draws.min(SHOWN))?;
        for &(a, b, _) in &probability.correlation {
            let both = |of: fn(&[f64], &[f64]) -> Option<f64>| of(&drawn[a], &drawn[b]).map_or("none".to_owned(), |it| format!("{it:.3}"));
            let names = format!("{} and {}", probability.inputs[a].name, probability.inputs[b].name);
            fact("correlation", format!("{names}: Pearson {}, Spearman {}", both(pearson), both(spearman)));
        }
    }
    Ok(())
}

/// Writes the draws that choose designs as CSV, replacing such a file only.
pub fn write(probability: &Probability, path: &Path) -> Result<()> {
    let names: Vec<String> = probability.inputs.iter().map(column_name).collect();
    let header = format!("draw,{}\n", names.join(","));
    refuse_without_folder(path)?;
    refuse_foreign(path, MOVE, |head| head.starts_with(&header))?;
    let drawn = columns(probability, probability.draws)?;
    let number = TableColumn::index("draw", "Number of the draw.", (0..probability.draws).map(Some));
    let of_inputs = names
        .iter()
        .zip(drawn)
        .map(|(name, values)| TableColumn::new(name, "draw", "", Data::Number(values.into_iter().map(Some).collect())));
    let table = Table { columns: std::iter::once(number).chain(of_inputs).collect() };
    replace(path, &csv_text(&table))
}

/// The drive of one draw of a design, or that at the medians, in one scenario: operating cases outside, levels inside. Its plan, the
/// scenario and the inputs.
pub fn drive(plan: &Plan, design: u64, request: &cli::EvalArgs) -> Result<(Plan, u64, Vec<f64>)> {
    let Some(probability) = &plan.study.probability else {
        return Err(Error::Request("--draw is for studies with distributions; this one has none".to_owned()));
    };
    let one = Plan::new(plan.study.of_one_draw());
    let scenarios = one.scenarios();
    let scenario = request
        .scenario
        .or((scenarios == 1).then_some(0))
        .ok_or_else(|| Error::Request(format!("a draw is shown in one operating case; add --scenario K, from 0 to {}", scenarios - 1)))?;
    if scenario >= scenarios {
        return Err(Error::Request(format!("there is no scenario {scenario}; those of a draw are 0 to {}", scenarios - 1)));
    }
    let mut inputs = one.space.inputs(design, scenario);
    if let Some(draw) = request.draw {
        if draw >= probability.draws {
            return Err(Error::Request(format!("there is no draw {draw}; the study's draws are 0 to {}", probability.draws - 1)));
        }
        let drawn = probability.choosing()?.columns(draw..draw + 1);
        for (it, drawn) in probability.inputs.iter().zip(drawn) {
            inputs[it.input] = it.acts().of(inputs[it.input], drawn[0]);
        }
    }
    Ok((one, scenario, inputs))
}

/// The operating cases of a draw, by the numbers by which `--scenario` shows them: the inputs that differ, and their values.
pub struct DrawnCases {
    one: Plan,
    inputs: Vec<usize>,
    design: u64,
}

impl DrawnCases {
    /// Those of a design; `None` if the study draws nothing or there is only one.
    pub fn of(plan: &Plan, design: u64) -> Option<Self> {
        plan.study.probability.as_ref()?;
        let one = Plan::new(plan.study.of_one_draw());
        let axes = one.study.operation.iter().chain(&one.study.uncertainty);
        let inputs = axes.flat_map(|axis| axis.inputs()).copied().collect();
        (one.scenarios() > 1).then_some(Self { one, inputs, design })
    }

    fn values(&self, scenario: u64) -> impl Iterator<Item = (usize, f64)> {
        let inputs = self.one.space.inputs(self.design, scenario);
        self.inputs.iter().map(move |&input| (input, inputs[input]))
    }

    /// As a table for people; of very many the first ones.
    pub fn table(&self) -> String {
        const SHOWN: u64 = 24;
        let model = &self.one.study.model;
        let mut grid = TextGrid::default();
        grid.row(std::iter::once(String::new()).chain(self.inputs.iter().map(|&input| model.inputs[input].name.clone())));
        let count = self.one.scenarios();
        for scenario in 0..count.min(SHOWN) {
            let text = |(input, value): (usize, f64)| model.inputs[input].word_for(value).map_or_else(|| short(value), str::to_owned);
            grid.row(std::iter::once(scenario.to_string()).chain(self.values(scenario).map(text)));
        }
        let more = if count > SHOWN { format!("  ... and {} more\n", grouped(count - SHOWN)) } else { String::new() };
        format!("\n{}, of which --scenario K shows one\n{}{more}", bold("operating cases of a draw"), grid.indented(2))
    }

    /// The same for programs, all of them.
    pub fn to_json(&self) -> Value {
        let model = &self.one.study.model;
        let inputs = |scenario| -> Map<String, Value> {
            self.values(scenario).map(|(input, value)| (model.inputs[input].name.clone(), value_of(model, input, value))).collect()
        };
        (0..self.one.scenarios()).map(|scenario| json!({ "scenario": scenario, "inputs": inputs(scenario) })).collect()
    }
}

/// Proven bounds of a design's yield, if the study asks for them, in words.
pub fn enclosed(study: &Study, design: u64) -> Result<Option<(Enclosure, String)>> {
    let refused = |problem: EnclosureProblem| Error::Request(problem.to_string());
    let Some(bounds) = YieldBounds::asked(study).map_err(refused)? else { return Ok(None) };
    let width = bounds.width();
    let found = bounds.of(design, width, YieldBounds::BOXES).map_err(refused)?;
    let reached = if found.width() <= width { String::new() } else { format!(", where {} was wanted: the budget is spent", short(width)) };
    let words = format!("{} boxes, {} apart{reached}", grouped(found.boxes), short(found.width()));
    Ok(Some((found, words)))
}
