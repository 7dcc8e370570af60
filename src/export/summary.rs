//! The outcome of a study in one page, `summary.json`, and how it was computed, `run.json`.

use super::{Certified, Confirmed};
use crate::bounds::Certificate;
use crate::models::OVERFLOW;
use crate::study::{Goal, Objective, number, value_of};
use crate::sweep::Left;
use serde_json::{Map, Value, json};
use std::time::Duration;

/// The design of the front nearest to the ideal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knee {
    /// Its row in the front table.
    pub row: usize,
    /// Its distance to the ideal, objectives scaled to [0, 1] over the front.
    pub distance: f64,
}

/// Numbers that describe a front and a sweep.
#[derive(Debug)]
pub struct Summary<'a> {
    outcome: &'a Certified<'a>,
    /// Best of each objective on the front; `None` without a front.
    pub ideal: Option<Vec<f64>>,
    /// The design at the least distance to the ideal; of equals the lowest index.
    pub knee: Option<Knee>,
}

impl<'a> Summary<'a> {
    /// Describes an outcome.
    pub fn new(outcome: &'a Certified<'a>) -> Self {
        let mut summary = Self { outcome, ideal: None, knee: None };
        let indices: Vec<u64> = outcome.front.iter().map(|row| row.index).collect();
        if let Some((ideal, knee)) = ideal_and_knee(&outcome.plan.study.objectives, &summary.points(), &indices) {
            (summary.ideal, summary.knee) = (Some(ideal), knee);
        }
        summary
    }

    /// The objective values of the front's designs, in table order.
    pub fn points(&self) -> Vec<Vec<f64>> {
        let columns: Vec<usize> = self.outcome.objective_columns();
        let value = |row: &crate::certify::Row, column: usize| row.columns[column].value.expect("a certified design has its objectives");
        self.outcome.front.iter().map(|row| columns.iter().map(|&column| value(row, column)).collect()).collect()
    }

    /// As JSON, in a fixed order.
    pub fn to_json(&self) -> Value {
        let Certified { plan, state, tally, front, .. } = self.outcome;
        let study = &plan.study;
        let model = &study.model;
        let names: Vec<_> = study.objectives.iter().map(|objective| objective.name(model)).collect();
        let named =
            |values: &[f64]| -> Map<_, _> { names.iter().zip(values).map(|(name, &value)| (name.clone(), number(value))).collect() };
        let points = self.points();
        let knee = self.knee.map(|knee| {
            let row = &front[knee.row];
            let inputs = study.design.iter().flat_map(|axis| axis.inputs());
            let inputs: Map<_, _> =
                inputs.map(|&input| (model.inputs[input].name.to_owned(), value_of(model, input, row.inputs[input]))).collect();
            let mut knee = json!({
                "design_index": row.index, "distance": number(knee.distance), "inputs": inputs, "objectives": named(&points[knee.row])
            });
            if !study.labels.is_empty() {
                let names = study.labels.iter().map(|it| it.name.clone());
                knee["labels"] = names.zip(plan.labels(row.index).map(Value::from)).collect::<Map<_, _>>().into();
            }
            knee
        });
        let extremes = names.iter().zip(state.extremes.least.iter().zip(&state.extremes.largest)).filter_map(|(name, (least, largest))| {
            let end = |it: &crate::reduce::Extreme| json!({ "value": number(it.value), "design_index": it.index });
            Some((name.clone(), json!({ "least": end(least.as_ref()?), "largest": end(largest.as_ref()?) })))
        });
        let statuses = tally.statuses(&self.outcome.plan.study);
        let mut status: Map<_, Value> = statuses.into_iter().map(|(reason, count)| (reason.to_owned(), count.into())).collect();
        // So rare that most summaries do not have it.
        if tally.overflow > 0 {
            status.insert(OVERFLOW.to_owned(), tally.overflow.into());
        }
        let constraints = study.constraints.iter().zip(tally.constraints.iter().zip(&tally.only)).map(|(constraint, (violated, only))| {
            json!({ "of": constraint.name(model), "bounds": constraint.in_words(), "violated": violated, "only": only })
        });
        let mut summary = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "model": model.name,
            "title": study.title,
            "study_hash": study.hash(),
            "designs": plan.designs(),
            "scenarios": plan.scenarios(),
            "feasible": state.feasible,
            "front": front.len(),
            "ideal": self.ideal.as_deref().map(named),
            "knee": knee,
            "extremes": extremes.collect::<Map<_, _>>(),
            "tally": {
                "of": "a fixed sample of the designs; one design may count in several places",
                "sampled": tally.sampled,
                "feasible": tally.feasible,
                "status": status,
                "constraints": constraints.collect::<Vec<_>>(),
            },
        });
        if let Some(drawn) = &self.outcome.drawn {
            summary["draws"] = drawn.to_json(plan, "all designs");
        }
        if let Some(confirmed) = Confirmed::of(self.outcome) {
            summary["confirmed"] = confirmed.to_json();
        }
        if let Some(influence) = self.outcome.influence_in_brief() {
            summary["sensitivity"] = influence;
        }
        let findings = &self.outcome.findings;
        if !findings.is_empty() {
            summary["findings"] = findings.to_json(study);
        }
        let remarks = study.remarks();
        if !remarks.is_empty() {
            summary["notes"] = remarks.into();
        }
        summary
    }
}

/// The best of each objective on a front, and the design nearest to it; `None` without a front. Of each design its values and its index.
pub(crate) fn ideal_and_knee(objectives: &[Objective], points: &[Vec<f64>], indices: &[u64]) -> Option<(Vec<f64>, Option<Knee>)> {
    if points.is_empty() || objectives.is_empty() {
        return None;
    }
    let ends = |objective: usize| {
        let values = points.iter().map(|point| point[objective]);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
    };
    let ends: Vec<_> = (0..objectives.len()).map(ends).collect();
    let best = |(objective, (low, high)): (&Objective, &(f64, f64))| if objective.goal == Goal::Min { *low } else { *high };
    let ideal: Vec<f64> = objectives.iter().zip(&ends).map(best).collect();
    let distance = |point: &[f64]| {
        let scaled = point
            .iter()
            .zip(&ideal)
            .zip(&ends)
            .map(|((value, ideal), (low, high))| if high > low { (value - ideal) / (high - low) } else { 0.0 });
        scaled.map(|it| it * it).sum::<f64>().sqrt()
    };
    let ranked = points.iter().enumerate().map(|(row, point)| Knee { row, distance: distance(point) });
    let knee = ranked.min_by(|a, b| a.distance.total_cmp(&b.distance).then(indices[a.row].cmp(&indices[b.row])));
    Some((ideal, knee))
}

impl Certified<'_> {
    /// The objective values of designs that are drawn behind the front.
    pub fn behind_the_front(&self) -> Vec<Vec<f64>> {
        let columns = self.objective_columns();
        let values = |row: &crate::certify::Row| columns.iter().map(|&column| row.columns[column].value.unwrap_or(f64::NAN)).collect();
        let drawn = self.named.iter().zip(self.state.reported.behind_the_front()).filter(|(_, behind)| *behind);
        drawn.flat_map(|(rows, _)| rows).map(values).collect()
    }

    /// Position of each objective among the columns.
    pub fn objective_columns(&self) -> Vec<usize> {
        let column = |objective: &Objective| self.columns.iter().position(|column| column.is_of(objective.quantity, objective.over));
        self.plan.study.objectives.iter().map(|objective| column(objective).expect("every objective has a column")).collect()
    }
}

/// How a result was computed: the only file of a result that differs from run to run.
#[derive(Clone, Debug)]
pub struct RunRecord {
    /// The engine that judged the designs.
    pub engine: &'static str,
    /// Worker threads.
    pub threads: usize,
    /// Designs judged by this run.
    pub designs: u64,
    /// Scenarios of each.
    pub scenarios: u64,
    /// Time that this run took to judge them.
    pub time: Duration,
    /// Was it resumed from a checkpoint, or merged from shards?
    pub origin: String,
    /// Designs that the f64 reference certified.
    pub certified: usize,
    /// The work of a device, if one was used.
    pub device: Option<Value>,
    /// How designs were judged.
    pub method: MethodRecord,
}

/// How designs were judged, and why.
#[derive(Clone, Debug)]
pub struct MethodRecord {
    /// Its name on the command line, or both names if bounds were given up; merged shards each had their own.
    pub name: &'static str,
    /// Why.
    pub why: String,
    /// Of bounds: what settled the designs.
    pub certificate: Option<Certificate>,
    /// How bounds were given up, if they were.
    pub left: Option<Left>,
}

impl RunRecord {
    /// Designs per second.
    #[allow(clippy::cast_precision_loss, reason = "a rate for people")]
    pub fn rate(&self) -> f64 {
        self.designs as f64 / self.time.as_secs_f64().max(1e-9)
    }

    /// As JSON, with the names of the files that belong to the result: no other file in the directory is this program's.
    pub fn to_json(&self, files: &[String]) -> Value {
        json!({
            "program": concat!("beltspace ", env!("CARGO_PKG_VERSION")),
            "engine": self.engine,
            "method": self.method.name,
            "method_chosen": self.method.why,
            "origin": self.origin,
            "threads": self.threads,
            "designs": self.designs,
            "scenarios": self.scenarios,
            "seconds": self.time.as_secs_f64(),
            "designs_per_second": self.rate(),
            "certified_designs": self.certified,
            "device": self.device,
            "certificate": self.method.certificate.as_ref().map(Certificate::to_json),
            "bounds_left": self.method.left.as_ref().map(Left::to_json),
            "platform": format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            "files": files,
        })
    }
}
