//! What is known of a study before it runs.

use crate::memory::Needs;
use crate::models::Set;
use crate::parallel::to_be_had;
use crate::plan::Plan;
use crate::study::{Axis, Constraint, Study};
use crate::sweep::costs::{Speed, why_every_design};
use crate::table::{grouped, short};
use std::time::Duration;

/// How long the speed is measured.
const TRIAL: Duration = Duration::from_millis(100);
/// Draws of which this many are expected to miss the wanted yield tell little of it.
const FEW: f64 = 10.0;

/// Designs, and scenarios of each, in which contradictions of the inputs are looked for.
const DOUBTED_DESIGNS: u64 = 4096;
const DOUBTED_SCENARIOS: u64 = 4;

/// What is known of a study before it runs.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Outlook {
    /// Designs.
    pub designs: u64,
    /// Scenarios in which each is judged; of a study with distributions, the levels of its uncertainty.
    pub scenarios: u64,
    /// Evaluations of the model if every design is judged; draws count.
    pub evaluations: f64,
    /// About how many seconds that takes on the threads asked for.
    pub seconds: f64,
    /// Why every design is judged; `None` if bounds are tried first.
    pub why_every_design: Option<String>,
    /// About how many bytes of memory a run takes.
    pub memory: u64,
    /// About how many designs are on the front.
    pub front: u64,
    /// What a person should know, one sentence each: also ranges whose steps end early.
    pub warnings: Vec<String>,
}

impl Study {
    /// What is known of the study before it runs on so many threads; takes a fraction of a second.
    #[allow(clippy::cast_precision_loss, reason = "estimates")]
    pub fn outlook(&self, threads: usize) -> Outlook {
        let plan = Plan::new(self.clone());
        let threads = to_be_had(threads.max(1));
        let (designs, scenarios) = (plan.designs(), plan.scenarios());
        let draws = self.probability.as_ref().map_or(1.0, |it| it.evaluations() as f64);
        let seconds = Speed::measured(&plan, threads, TRIAL).of(designs, threads);
        let needs = Needs::of(&plan, threads, true);
        Outlook {
            designs,
            scenarios,
            evaluations: designs as f64 * scenarios as f64 * draws,
            seconds,
            why_every_design: why_every_design(&plan, seconds),
            memory: needs.run,
            front: needs.front,
            warnings: self.short_ranges.iter().cloned().chain(warnings(&plan)).collect(),
        }
    }
}

/// What a person should know of a study before it runs, one sentence each: axes without effect, values beyond what the model's source covers,
/// inputs that contradict each other.
pub fn warnings(plan: &Plan) -> Vec<String> {
    let study = &plan.study;
    let model = &study.model;
    let name = |axis: &Axis| axis.inputs().iter().map(|&input| model.inputs[input].name.as_str()).collect::<Vec<_>>().join(" + ");
    let mut warnings = study.left_out.clone();
    for axis in plan.inert_axes() {
        let axis = &study.design[axis];
        let levels = if axis.count() == 1 {
            String::new()
        } else {
            format!(": its {} levels only multiply the work and add equal designs", grouped(axis.count()))
        };
        warnings.push(format!("{} changes nothing that the study asks for{levels}", name(axis)));
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
    let known = |input: usize| (!set.contains(input)).then_some(study.fixed[input]);
    let is_set = |input: &usize| known(*input) != Some(study.model.inputs[*input].default);
    warnings.extend((0..study.fixed.len()).filter(is_set).filter_map(|input| study.model.unread(input, known)));
    warnings.extend(few_draws(study));
    warnings.extend(contradiction(plan));
    if study.constraints.is_empty() {
        warnings.push("there are no constraints: every design with status ok is feasible".to_owned());
    }
    warnings
}

/// Inputs that contradict each other, in the first design of those looked at where they do.
fn contradiction(plan: &Plan) -> Option<String> {
    let (designs, scenarios) = (plan.space.designs.coarse(DOUBTED_DESIGNS), plan.space.scenarios.coarse(DOUBTED_SCENARIOS));
    let mut found = designs.iter().filter_map(|&design| {
        let doubts = |&scenario: &u64| plan.study.model.doubts_on(&plan.space.inputs(design, scenario));
        scenarios.iter().find_map(|scenario| doubts(scenario).into_iter().next()).map(|doubt| (design, doubt))
    });
    let (design, doubt) = found.next()?;
    let others = found.count();
    let more = if others == 0 { String::new() } else { format!(" and {} more", grouped(others as u64)) };
    Some(format!("{doubt} (design {design}{more}, of {} looked at)", grouped(designs.len() as u64)))
}

fn unusual(plan: &Plan, input: usize, (low, high): (f64, f64), warnings: &mut Vec<String>) {
    let table = &plan.study.model.inputs[input];
    let outside = |value: f64| table.word_for(value).is_none() && !(table.usual.0..=table.usual.1).contains(&value);
    if outside(low) || outside(high) {
        let value = if low == high { short(low) } else { format!("{} to {}", short(low), short(high)) };
        warnings
            .push(format!("{} = {value} lies outside {} to {}, which the model's source covers", table.name, table.usual.0, table.usual.1));
    }
}

/// Wanted yields of which so few draws tell little.
fn few_draws(study: &Study) -> Vec<String> {
    let Some(probability) = &study.probability else { return Vec::new() };
    let warning = |constraint: &Constraint| {
        let name = constraint.name(&study.model);
        let wanted = constraint.low.map(|it| it.0).filter(|it| probability.is_share(constraint.quantity) && *it > 0.0)?;
        let misses = probability.draws as f64 * (1.0 - wanted);
        if wanted >= 1.0 || misses >= FEW {
            return None;
        }
        let draws = grouped((FEW / (1.0 - wanted)).ceil() as u64);
        Some(format!(
            "{name} at least {wanted}: only {} of {} draws may miss it, which tells little; use {draws} draws or more",
            short(misses.floor()),
            grouped(probability.draws)
        ))
    };
    study.constraints.iter().filter_map(warning).collect()
}
