//! Why draws fail: counts over a sample of the designs and their draws.

use crate::error::{Error, Result};
use crate::models::fill_si;
use crate::parallel::on_threads;
use crate::plan::Plan;
use crate::screen::{Control, sample};
use crate::study::{DrawFailures, DrawnKernel, NO_SUCH_DRIVE, Probability};
use crate::tape::Set;
use serde_json::{Map, Value, json};
use std::ops::Range;
use std::sync::atomic::Ordering;

/// Evaluations of the drive that counting may take, and the least number of draws that are looked at.
const EVALUATIONS: u64 = 1 << 16;
const LEAST: u64 = 1 << 10;

/// Counts over a sample of draws of all designs. A draw may fail in several ways and counts in each.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnTally {
    /// Draws that were looked at, each of one design.
    pub sampled: u64,
    /// Of how many: designs times draws.
    pub of: u64,
    /// Of those that were looked at, how many hold.
    pub holding: u64,
    /// Statuses of the drive, by reason.
    pub statuses: Vec<(String, u64)>,
    /// Constraints that a draw must keep: violated, and violated without any other failure.
    pub constraints: Vec<(u64, u64)>,
}

impl DrawnTally {
    /// Counts; `None` if the study has no distributions.
    ///
    /// # Errors
    /// [`Error::Stopped`] after `control.stop`.
    pub fn new(plan: &Plan, threads: usize, control: &Control) -> Result<Option<Self>> {
        let Some(probability) = &plan.study.probability else { return Ok(None) };
        Self::of_designs(plan, probability, 0..plan.designs(), threads, control).map(Some)
    }

    /// The same over the draws of one design.
    ///
    /// # Errors
    /// [`Error::Stopped`] after `control.stop`.
    pub fn of_design(plan: &Plan, design: u64, threads: usize, control: &Control) -> Result<Option<Self>> {
        let Some(probability) = &plan.study.probability else { return Ok(None) };
        Self::of_designs(plan, probability, design..design + 1, threads, control).map(Some)
    }

    /// Counts over a sample of the draws of some designs, which stand one design behind the other.
    fn of_designs(plan: &Plan, probability: &Probability, designs: Range<u64>, threads: usize, control: &Control) -> Result<Self> {
        let drive = probability.drawn(None).map_err(|problem| Error::Request(problem.to_string()))?;
        let kernel = DrawnKernel::new(drive);
        let scenarios = plan.scenarios();
        let each = scenarios.saturating_mul(probability.evaluations() / probability.draws.max(1)).max(1);
        let of = (designs.end - designs.start).saturating_mul(probability.draws);
        let chosen: Vec<u64> = sample(of, (EVALUATIONS / each).max(LEAST)).collect();
        let share = chosen.len().div_ceil(threads.max(1)).max(1);
        let parts = on_threads(chosen.chunks(share), |part| {
            let mut found = Vec::with_capacity(part.len());
            for number in part {
                if control.stop.load(Ordering::Relaxed) {
                    break;
                }
                let (design, draw) = (designs.start + number / probability.draws, number % probability.draws);
                found.push(failures(plan, &kernel, design, draw as usize));
            }
            found
        });
        let found: Vec<DrawFailures> = parts.into_iter().flatten().collect();
        if found.len() < chosen.len() {
            return Err(Error::Stopped { kept: None });
        }
        let count = |is: &dyn Fn(&DrawFailures) -> bool| found.iter().filter(|it| is(it)).count() as u64;
        let model = &probability.drive.model;
        let heads = (0..model.conditions.len()).filter(|&it| model.first_of_reason(it) == it && !model.conditions[it].quiet);
        let mut statuses: Vec<(String, u64)> =
            heads.map(|it| (model.conditions[it].reason.to_string(), count(&|found| found.conditions.contains(it)))).collect();
        statuses.push((NO_SUCH_DRIVE.to_owned(), count(&|it| it.is_no_drive)));
        let constraints = (0..probability.drive.constraints.len()).map(|number| {
            let alone = DrawFailures { constraints: Set::one(number), ..DrawFailures::default() };
            (count(&|it| it.constraints.contains(number)), count(&|it| *it == alone))
        });
        let holding = count(&|it| it.is_none());
        Ok(Self { sampled: found.len() as u64, of, holding, statuses, constraints: constraints.collect() })
    }

    /// For `summary.json`, and for one design: `whose` draws they are.
    pub(crate) fn to_json(&self, plan: &Plan, whose: &str) -> Value {
        let Some(probability) = &plan.study.probability else { return Value::Null };
        let drive = &probability.drive;
        let constraints = drive.constraints.iter().zip(&self.constraints).map(|(constraint, (violated, only))| {
            json!({ "of": constraint.name(&drive.model), "bounds": constraint.in_words(), "violated": violated, "only": only })
        });
        json!({
            "of": format!("a fixed sample of the draws of {whose}; one draw may count in several places"),
            "draws": self.of, "sampled": self.sampled, "feasible": self.holding,
            "status": self.statuses.iter().map(|(reason, count)| (reason.clone(), json!(count))).collect::<Map<_, _>>(),
            "constraints": constraints.collect::<Vec<_>>(),
        })
    }
}

/// What a draw of a design fails at, at any level.
fn failures(plan: &Plan, kernel: &DrawnKernel, design: u64, draw: usize) -> DrawFailures {
    let model = &plan.study.model;
    let at_level = |level: u64| {
        let inputs = plan.space.inputs(design, level);
        let mut si = vec![0.0; inputs.len()];
        fill_si(model, &inputs, &mut si);
        kernel.failures(&si, draw)
    };
    (0..plan.scenarios()).map(at_level).fold(DrawFailures::default(), DrawFailures::with)
}
