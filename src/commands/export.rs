//! `beltspace export`: exports one design to another program.

use super::eval::studied;
use super::settings::inputs_of;
use super::{CommandTarget, find_model, target};
use crate::cli;
use crate::terminal::{self, TextGrid, bold, short};
use beltspace::error::{Error, Result};
use beltspace::models::{Design, Model, Status, evaluate};
use beltspace::pulley::calculix::{self, ComparedQuantity, Job};
use std::path::Path;
use std::sync::Arc;

pub fn run(request: &cli::ExportArgs) -> Result<()> {
    if request.compare {
        return compare(&request.calculix);
    }
    let (model, inputs) = design_of(request)?;
    let Some(design) = model.pulley_of(&inputs) else {
        return Err(Error::Request(format!(
            "{} is not computed with finite elements, so there is nothing to export; the model pulley is",
            model.name
        )));
    };
    let evaluation = evaluate(&model, &inputs);
    if evaluation.status != Status::Ok {
        let notes = model.notes_on(&inputs, &evaluation).join("; ");
        let reason = evaluation.status.reason(&model);
        return Err(Error::Request(format!("there is nothing to export: the status is \"{reason}\"{}", before(": ", &notes))));
    }
    let Design { kind, dimensions, fineness, case, poisson, density, .. } = design;
    // The deck's density is in t/mm^3.
    let job = Job { kind, dimensions, fineness, case, poisson, density: density * 1e-12, sectors: usize::from(request.sectors) };
    calculix::export(&job, &request.calculix).map_err(|error| failed(&error))?;
    let folder = request.calculix.display();
    if case.phase.is_none() {
        terminal::remark("note", "bolt_angle_deg is \"worst\": the exported model has its first bolt at 0 degrees");
    }
    terminal::print(&format!(
        "{folder}/{name}.inp\n\nrun     cd {folder} && OMP_NUM_THREADS=2 ccx -i {name}\nthen    beltspace export --calculix {folder} --compare\n",
        name = calculix::NAME
    ))
}

fn before(mark: &str, words: &str) -> String {
    if words.is_empty() { String::new() } else { format!("{mark}{words}") }
}

fn failed(error: &calculix::CalculixError) -> Error {
    Error::Request(error.to_string())
}

/// Model and inputs that a request names: a model with its settings, or a design of a study.
fn design_of(request: &cli::ExportArgs) -> Result<(Arc<Model>, Vec<f64>)> {
    let named = request.target.as_deref().ok_or_else(|| Error::Request("which design? name the model pulley or a study".to_owned()))?;
    if let CommandTarget::Study(path) = target(named)? {
        if !request.set.is_empty() || request.preset.is_some() {
            return Err(Error::Request("--set and --preset are for models; for a study use --design N".to_owned()));
        }
        let (plan, design) = studied(path, request.design)?;
        let scenarios = plan.scenarios();
        let scenario = request.scenario.or((scenarios == 1).then_some(0)).filter(|scenario| *scenario < scenarios).ok_or_else(|| {
            Error::Request(format!("a model for CalculiX is of one scenario; add --scenario K, from 0 to {}", scenarios - 1))
        })?;
        return Ok((plan.study.model.clone(), plan.space.inputs(design, scenario)));
    }
    let model = find_model(named)?;
    if request.design.is_some() {
        return Err(Error::Request(format!("--design is for studies, and {} is a model; use --set", model.name)));
    }
    let inputs = inputs_of(&model, request.preset.as_deref(), &request.set)?;
    Ok((model, inputs))
}

/// Prints the results of CalculiX beside those of beltspace.
fn compare(folder: &Path) -> Result<()> {
    let rows = calculix::compare(folder).map_err(|error| failed(&error))?;
    let mut table = TextGrid::default();
    table.row(["", "unit", "beltspace", "calculix", "difference %"].map(str::to_owned));
    for row in &rows {
        let ComparedQuantity { quantity, unit, harmonic, calculix, .. } = row;
        table.row([quantity.clone(), (*unit).to_owned(), short(*harmonic), short(*calculix), format!("{:.2}", row.difference())]);
    }
    terminal::print(&format!("{}\n{}", bold("comparison"), table.indented(2)))
}
