//! What a random study asks of its designs: objectives, constraints and reports, on formulas, inputs and outputs.

use super::study::Around;
use super::walk::Walker;
use crate::pipeline::naive::Evaluated;
use crate::random::Random;
use beltspace::models::{Evaluation, Worse};
use beltspace::study::{Quantity, Study};
use std::path::Path;

/// Most designs that are listed one by one.
const LISTED: u64 = 1000;

/// Objectives, reports and constraints as lines of their tables.
#[derive(Clone, Default)]
pub struct Asked {
    objectives: Vec<String>,
    report: Vec<String>,
    constraints: Vec<String>,
    /// The names that constraints may be of.
    names: Vec<String>,
}

/// A study with what it asks for, and its designs by the walker.
pub struct Whole {
    pub text: String,
    pub study: Study,
    pub evaluated: Evaluated,
}

/// Reads a study.
pub fn parsed(text: &str, folder: &Path) -> Study {
    Study::parse_in(text, "random.toml", folder).unwrap_or_else(|errors| panic!("{errors}\n{text}"))
}

/// Every design by the walker.
pub fn walked(study: &Study, walker: &Walker) -> Evaluated {
    let designs = study.design.iter().map(|axis| axis.count()).product();
    Evaluated::by(study, 0..designs, &|inputs: &[f64]| -> Evaluation { walker.evaluate(&study.model, inputs) })
}

impl Asked {
    /// Objectives and reports. Bounds serve no report but `top`.
    pub fn draw(around: &Around, random: &mut Random) -> Self {
        let base = &around.walker.base;
        let formulas: Vec<&str> = around.walker.formulas.iter().map(|it| it.name.as_str()).collect();
        let outputs: Vec<&str> = base.outputs.iter().map(|it| it.name.as_str()).collect();
        let has_numbers = |name: &&str| base.input(name).is_none_or(|it| base.inputs[it].words.is_empty());
        let inputs: Vec<&str> = around.given.iter().filter(|it| it.is_single()).map(|it| it.key.as_str()).filter(has_numbers).collect();
        let draw = |random: &mut Random| match random.below(10) {
            0..6 => random.pick(&formulas),
            6 | 7 if !inputs.is_empty() => random.pick(&inputs),
            _ => random.pick(&outputs),
        };
        let goal = |random: &mut Random| random.pick(&["min", "max"]);
        let mut asked = Self::default();
        let mut names: Vec<&str> = Vec::new();
        let wanted = random.pick(&[0, 1, 2, 2, 3, 3, 4]);
        while names.len() < wanted {
            let name = draw(random);
            if !names.contains(&name) {
                names.push(name);
                asked.objectives.push(format!("{name} = \"{}\"", goal(random)));
            }
        }
        if wanted == 0 || random.chance(0.4) {
            let (by, count) = (draw(random), random.pick(&[1, 5, 30, 5000]));
            asked.report.push(format!("top = {{ by = \"{by}\", count = {count}, goal = \"{}\" }}", goal(random)));
        }
        if random.chance(0.3) {
            let (of, bins) = (draw(random), random.pick(&[1, 8, 30]));
            asked.report.push(format!("histograms = [{{ of = \"{of}\", bins = {bins} }}]"));
        }
        let mut axes: Vec<&str> = around.given.iter().filter(|it| it.role == 0 && it.is_single()).map(|it| it.key.as_str()).collect();
        if axes.len() > 1 && random.chance(0.4) {
            random.shuffle(&mut axes);
            let name = draw(random);
            let value = match random.below(3) {
                0 => "best = \"share\"".to_owned(),
                _ if names.contains(&name) => format!("value = \"{name}\""),
                _ => format!("value = \"{name}\", best = \"{}\"", goal(random)),
            };
            asked.report.push(format!("maps = [{{ x = \"{}\", y = \"{}\", {value} }}]", axes[0], axes[1]));
        }
        let mut columns: Vec<String> = Vec::new();
        for _ in 0..random.below(4) {
            let name = draw(random);
            let column = format!("\"{name}\"");
            let chosen = around.given.iter().any(|it| it.role == 0 && it.key == name);
            if !chosen && !columns.contains(&column) {
                columns.push(column);
            }
        }
        if !columns.is_empty() {
            asked.report.push(format!("columns = [{}]", columns.join(", ")));
        }
        let mut sources = formulas.clone();
        random.shuffle(&mut sources);
        asked.names =
            (0..random.pick(&[0, 1, 1, 2, 3])).map(|_| draw(random).to_owned()).chain(sources.first().map(|it| (*it).to_owned())).collect();
        asked.names.dedup();
        asked
    }

    /// The study's text. With `all` the feasible designs are listed, else only what bounds can serve is asked for.
    pub fn text(&self, around: &Around, designs: u64, all: bool) -> String {
        let list = if designs <= LISTED { "variants = true" } else { "sample = 100000" };
        let mut report: Vec<&str> = self.report.iter().map(String::as_str).collect();
        if all {
            report.push(list);
        } else {
            report.retain(|it| it.starts_with("top") || it.starts_with("columns"));
        }
        let sections = [
            ("constraints", self.constraints.iter().map(String::as_str).collect()),
            ("objectives", self.objectives.iter().map(String::as_str).collect()),
            ("report", report),
        ];
        let written = |(name, lines): &(&str, Vec<&str>)| format!("\n[{name}]\n{}\n", lines.join("\n"));
        sections.iter().filter(|(_, lines)| !lines.is_empty()).map(written).fold(around.text(), |text, section| text + &section)
    }

    /// Places bounds between values that designs have in their worst scenario, or, of what is given exactly, at one.
    pub fn constrain(&mut self, random: &mut Random, study: &Study, evaluated: &Evaluated, impossible: bool) {
        let mut used: Vec<String> = Vec::new();
        for name in self.names.clone() {
            let model = &study.model;
            let quantity = model.output(&name).map(Quantity::Output).or_else(|| model.input(&name).map(Quantity::Input));
            let quantity = quantity.expect("it is known");
            let high = random.chance(0.5);
            let worse = if high { Worse::Higher } else { Worse::Lower };
            let Some(values) = evaluated.sorted_worst_values(study, quantity, worse).filter(|_| !used.contains(&name)) else { continue };
            let (least, largest) = (values[0], values[values.len() - 1]);
            let place = ((random.between(0.25, 0.97) * values.len() as f64) as usize).min(values.len() - 1);
            let place = if high { place } else { values.len() - 1 - place };
            let next = values[place..].iter().copied().find(|it| *it > values[place]);
            let bound = match next {
                _ if impossible && used.is_empty() => {
                    let far = (largest - least).max(largest.abs()).max(1e-9);
                    if high { least - far } else { largest + far }
                }
                _ if matches!(quantity, Quantity::Input(_)) => values[place],
                Some(next) if next - values[place] > 1e-6 * next.abs().max(values[place].abs()) => between(values[place], next),
                _ => continue,
            };
            let key = random.pick(if high { &["max", "below"] } else { &["min", "above"] });
            let other = match random.below(5) {
                0 if high && least < bound => format!(", min = {:?}", least - 0.1 * (largest - least).max(1e-3 * least.abs())),
                _ => String::new(),
            };
            self.constraints.push(format!("{name} = {{ {key} = {:?}{other} }}", bound + 0.0));
            used.push(name);
        }
    }
}

/// A short number between two.
fn between(low: f64, high: f64) -> f64 {
    let middle = low + (high - low) / 2.0;
    let shorter = (2..17).map(|digits| format!("{middle:.digits$e}").parse::<f64>().expect("a number was printed"));
    // Not so near to either that it would matter how they were rounded.
    let gap = (high - low) / 4.0;
    shorter.into_iter().find(|it| *it > low + gap && *it < high - gap).unwrap_or(middle)
}
