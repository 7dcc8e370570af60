//! `beltspace verify`: compares the GPU of this machine with f64.

use super::{CommandTarget, engine, read_study, target, threads};
use crate::cli;
use crate::terminal::{self, TextGrid, bold, counted, grouped};
use beltspace::error::{Error, Result};
use beltspace::gpu::PointKernel;
use beltspace::models::Model;
use beltspace::plan::Plan;
use beltspace::reduce::Reduction;
use beltspace::run::device::{self, Trusted};
use beltspace::screen::{Tables, Tally};
use beltspace::study::Constraint;
use beltspace::sweep::{Recheck, recheck_on_device};
use beltspace::verify::{Statistics, VerifyPoints, VerifyReport, compare, points_of_model, points_of_study};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;

pub fn run(request: &cli::VerifyArgs) -> Result<()> {
    let samples = usize::try_from(request.samples).map_err(|_| Error::Request("--samples: too many for this machine".to_owned()))?;
    let model = match target(&request.target)? {
        CommandTarget::Model(model) => model,
        CommandTarget::Study(path) => return of_study(request, path, samples),
    };
    let device = open(request, &model)?;
    let report = of_points(&device, &model, &[], &points_of_model(&model, samples, request.seed))?;
    print(request, &model.name, &device, &report, None)
}

/// Points of a study, and its sweep.
fn of_study(request: &cli::VerifyArgs, path: &Path, samples: usize) -> Result<()> {
    let (study, _) = read_study(path)?;
    let plan = Plan::new(study);
    let model = &plan.study.model;
    let device = open(request, model)?;
    let points = points_of_study(&plan, samples, request.seed);
    let report = of_points(&device, model, &plan.study.constraints, &points)?;
    let tables = Tables::new(&plan);
    let ranges = Tally::new(&plan, &tables, threads(None)).histogram_ranges(&plan);
    let reduction = Reduction::new(&plan, &ranges);
    // A kernel that breaks an error bound at single points is refused without a sweep.
    let swept = match report.require() {
        Ok(()) => Some(recheck_on_device(&plan, &tables, &reduction, threads(None), &device.on)?),
        Err(_) => None,
    };
    print(request, &terminal::told(&plan.study.title), &device, &report, swept.as_ref())
}

fn open(request: &cli::VerifyArgs, model: &Model) -> Result<Trusted> {
    device::refuse_cpu_only(model, "there is nothing on a GPU to compare with it")?;
    device::trusted(request.adapter.as_deref(), engine::wrong(model, &request.perturb)?)
}

fn of_points(device: &Trusted, model: &Arc<Model>, constraints: &[Constraint], points: &VerifyPoints) -> Result<VerifyReport> {
    let kernel = PointKernel::new(&device.on.device, model, &device.on.wrong.perturb)?;
    compare(&kernel, model, constraints, points)
}

fn print(request: &cli::VerifyArgs, what: &str, device: &Trusted, report: &VerifyReport, swept: Option<&Recheck>) -> Result<()> {
    if request.json {
        terminal::print(&format!("{:#}\n", describe(device, report, swept)))?;
    } else {
        terminal::tell(&page(what, device, report, swept))?;
    }
    report.require()
}

fn page(what: &str, device: &Trusted, report: &VerifyReport, swept: Option<&Recheck>) -> String {
    let mut grid = TextGrid::default();
    grid.row(["", "values", "error median", "largest", "bound median", "99 %", "used"].map(bold));
    let row = |it: &Statistics| {
        let small = |value: f64| format!("{value:.1e}");
        let used =
            format!("{:.1} %{}", 100.0 * it.used, if it.broken > 0 { format!("  broken {} times", it.broken) } else { String::new() });
        let numbers = [it.median_error, it.largest_error, it.median_bound, it.usual_bound].map(small);
        [it.name.clone(), grouped(it.values - it.unbounded)].into_iter().chain(numbers).chain([used])
    };
    for it in &report.outputs {
        grid.row(row(it));
    }
    for it in &report.conditions {
        grid.row(row(&Statistics { name: format!("status: {}", it.name), ..it.clone() }));
    }
    let mut facts = TextGrid::default();
    let mut fact = |what: &str, value: String| facts.row([bold(what), value]);
    fact("adapter", device.adapter.in_words());
    fact("points", grouped(report.points));
    fact("unsure", format!("{}, for f64 to decide", grouped(report.unsure)));
    fact("flips", format!("{} {} wrong", counted(report.flips, "sure decision"), if report.flips == 1 { "was" } else { "were" }));
    if let Some(swept) = swept {
        fact("tiles", format!("{} swept and judged again in f64: values, counts and survivors agree", counted(swept.designs, "design")));
    }
    let kept = if report.require().is_ok() { "all error bounds hold" } else { "an error bound or a decision is wrong" };
    format!(
        "{}: the GPU compared with f64; errors and error bounds relative to the value\n\n{}\n{}\n{}\n",
        bold(what),
        grid.indented(2),
        facts.indented(0),
        bold(kept)
    )
}

fn describe(device: &Trusted, report: &VerifyReport, swept: Option<&Recheck>) -> Value {
    let statistics = |it: &Statistics| {
        json!({
            "name": it.name, "values": it.values, "unbounded": it.unbounded, "broken": it.broken, "example": it.example,
            "median_error": it.median_error, "largest_error": it.largest_error,
            "median_promise": it.median_bound, "promise_of_99_percent": it.usual_bound, "share_of_promise": it.used,
        })
    };
    json!({
        "adapter": device.adapter.name, "driver": device.adapter.driver, "self_test": device.report.to_json(),
        "points": report.points, "unsure": report.unsure, "flips": report.flips, "kept": report.require().is_ok(),
        "outputs": report.outputs.iter().map(statistics).collect::<Vec<_>>(),
        "conditions": report.conditions.iter().map(statistics).collect::<Vec<_>>(),
        "tiles": swept.map(Recheck::to_json),
    })
}

#[cfg(test)]
mod tests {
    use super::super::unlike::cpu_only;
    use super::*;

    #[test]
    fn a_model_without_a_gpu_implementation_cannot_be_verified() {
        let request =
            cli::VerifyArgs { target: "cpu-only".to_owned(), samples: 1, seed: 1, adapter: None, perturb: Vec::new(), json: false };
        let refused = open(&request, &cpu_only()).map(drop).expect_err("it has no GPU implementation");
        assert!(matches!(refused, Error::CpuOnly { .. }));
        assert_eq!(refused.to_string(), "cpu-only is computed in f64 on the CPU only; there is nothing on a GPU to compare with it");
    }
}
