//! How far a study is from its first feasible design.

use super::exact::{self, Alone};
use super::reached::Reached;
use super::{design_in_words, design_inputs, number_or_null};
use crate::certify::{Row, margin_columns, rows};
use crate::error::Result;
use crate::plan::Plan;
use crate::screen::{Control, sample};
use crate::study::{Constraint, Study, number};
use crate::table::{brief, plain, short};
use serde_json::{Value, json};
use std::sync::atomic::Ordering;

/// Evaluations of the sample, and least designs of it.
const EVALUATIONS: u64 = 20_000_000;
const LEAST: u64 = 64;

/// How far off feasibility is, where no design is feasible.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Infeasible {
    /// Designs of the fixed sample.
    pub sampled: u64,
    /// Of these, designs that have a result in every scenario.
    pub with_result: u64,
    /// Per constraint of the study, in its order: what can be reached of it.
    pub reach: Vec<Reach>,
    /// The design of the sample that is nearest to feasible.
    pub nearest: Option<Nearest>,
}

/// What designs can reach of one constraint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Reach {
    /// The best worst value of any design, whatever it does to the other constraints. `None`: no design that was looked at has one.
    pub best: Option<Reached>,
    /// The best worst value of the designs that keep all other constraints: a bound there would let the first design through. `None`: no
    /// design that was looked at keeps the others.
    pub first: Option<Reached>,
}

/// The design of the sample with the least sum of violations, each relative to the spread of its quantity over the sample.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Nearest {
    /// The design.
    pub design: u64,
    /// All inputs in their units.
    pub inputs: Vec<f64>,
    /// Per constraint of the study: the worst value; `None` if it has none.
    pub values: Vec<Option<f64>>,
    /// Scenarios in which it has no result: more than 0 only if no design of the sample has a result in all.
    pub without_result: u64,
}

impl Infeasible {
    /// Looks for it in a fixed sample of the designs, and where that is quick enough among all.
    ///
    /// # Errors
    /// [`Error::Stopped`](crate::error::Error::Stopped) after `control.stop`.
    pub(super) fn of(plan: &Plan, threads: usize, control: &Control) -> Result<Self> {
        let most = plan.study.model.sample.min((EVALUATIONS / plan.scenarios().max(1)).max(LEAST));
        let designs: Vec<u64> = sample(plan.designs(), most).collect();
        control.reported.fetch_add(designs.len() as u64, Ordering::Relaxed);
        let looked_at = rows(plan, &margin_columns(&plan.study), &designs, threads, control)?;
        let mut reach = sampled_reach(&plan.study, &looked_at, designs.len() as u64 == plan.designs());
        for (constraint, reach) in reach.iter_mut().enumerate() {
            for (alone, reached) in [(Alone::Yes, &mut reach.best), (Alone::No, &mut reach.first)] {
                if let Some(found) = exact::best(plan, constraint, alone, threads, control)? {
                    *reached = found;
                }
            }
        }
        let with_result = looked_at.iter().filter(|row| row.without_result == 0).count() as u64;
        Ok(Self { sampled: designs.len() as u64, with_result, reach, nearest: nearest(&plan.study, looked_at) })
    }

    /// A sentence per constraint that stands in the way, and one for the nearest design.
    pub(super) fn in_words(&self, study: &Study) -> Vec<String> {
        let model = &study.model;
        let mut sentences = Vec::new();
        if self.with_result == 0 {
            let scenarios = self.nearest.as_ref().map_or(String::new(), |it| {
                format!("; {} comes nearest, with {} of its scenarios without one", named(it.design), it.without_result)
            });
            sentences.push(format!("no design of the sample of {} has a result in every scenario{scenarios}", self.sampled));
        }
        let of = |it: &Reached| if it.exact { "of all designs" } else { "of the sample" };
        for (constraint, reach) in study.constraints.iter().zip(&self.reach) {
            let what = constraint_in_words(study, constraint);
            let unit = &study.unit_over(constraint.quantity, constraint.over);
            // A bound of 0 on a yield would ask for nothing.
            let is_share = study.probability.as_ref().is_some_and(|it| it.is_share(constraint.quantity));
            if let Some(best) = reach.best.filter(|it| is_share && it.value == 0.0 && !constraint.holds(0.0)) {
                let which = if best.exact { "" } else { " of the sample" };
                sentences.push(format!("{what}: no draw of any design{which} holds; relax what the draws fail at"));
                continue;
            }
            let mut parts = Vec::new();
            if let Some(best) = reach.best.filter(|it| !constraint.holds(it.value)) {
                parts.push(format!(
                    "the best {} has {} ({})",
                    of(&best),
                    with_unit(&missing(constraint, best.value), unit),
                    named(best.design)
                ));
            }
            // The share of designs that fail it is below all of them then; the rest is in the way of another constraint.
            if reach.best.is_some_and(|it| constraint.holds(it.value)) && reach.first.is_some_and(|it| !constraint.holds(it.value)) {
                parts.push("some designs keep it, but none of them keeps all else".to_owned());
            }
            if let Some(first) = reach.first.filter(|it| !constraint.holds(it.value)) {
                let bound = with_unit(&letting_through(constraint, first.value), unit);
                let kept = if study.constraints.len() > 1 { " that keeps all else" } else { "" };
                let which = if first.exact { "the first design" } else { "the first design of the sample" };
                parts.push(format!("a bound of {bound} lets {which}{kept} through ({})", named(first.design)));
            }
            if !parts.is_empty() {
                sentences.push(format!("{what}: {}", parts.join("; ")));
            }
        }
        if let Some(nearest) = self.nearest.as_ref().filter(|it| it.without_result == 0) {
            let misses = study.constraints.iter().zip(&nearest.values).filter(|(it, value)| !value.is_some_and(|value| it.holds(value)));
            let misses = misses.map(|(it, value)| {
                let value = value.map_or("has no value".to_owned(), |value| format!("is {}", missing(it, value)));
                format!("{} {value}, wanted {}", it.name(model), it.in_words())
            });
            let misses: Vec<_> = misses.collect();
            let inputs = design_in_words(study, &nearest.inputs);
            sentences.push(format!("nearest to feasible in the sample: {} ({inputs}): {}", named(nearest.design), misses.join("; ")));
        }
        sentences
    }

    pub(super) fn to_json(&self, study: &Study) -> Value {
        let model = &study.model;
        let constraints = study.constraints.iter().zip(&self.reach).map(|(constraint, reach)| {
            let reached = |it: Option<Reached>| {
                it.map(|it| {
                    json!({
                        "value": number(it.value), "violation": number((-constraint.margin(it.value)).max(0.0)),
                        "design_index": it.design, "exact": it.exact,
                    })
                })
            };
            json!({
                "of": constraint.name(model), "bounds": constraint.in_words(),
                "best": reached(reach.best), "first": reached(reach.first),
            })
        });
        let nearest = self.nearest.as_ref().map(|nearest| {
            let values = study.constraints.iter().zip(&nearest.values).map(|(constraint, &value)| {
                let violation = value.map(|value| (-constraint.margin(value)).max(0.0));
                json!({
                    "of": constraint.name(model), "bounds": constraint.in_words(),
                    "value": number_or_null(value), "violation": number_or_null(violation),
                })
            });
            json!({
                "design_index": nearest.design, "inputs": design_inputs(study, &nearest.inputs),
                "scenarios_without_result": nearest.without_result, "constraints": values.collect::<Vec<_>>(),
            })
        });
        json!({
            "of": "a fixed sample of the designs; what is exact is of all designs",
            "sampled": self.sampled, "with_result": self.with_result,
            "constraints": constraints.collect::<Vec<_>>(), "nearest": nearest,
        })
    }
}

fn named(design: u64) -> String {
    format!("design {design}")
}

fn with_unit(value: &str, unit: &str) -> String {
    format!("{value} {unit}").trim_end().to_owned()
}

/// A value that misses its constraint, in as few digits as show that it does.
fn missing(constraint: &Constraint, value: f64) -> String {
    let shows = |text: &String| text.parse().is_ok_and(|told| !constraint.holds(told));
    [brief(value), short(value)].into_iter().find(shows).unwrap_or_else(|| plain(value))
}

/// A bound in few digits that this value keeps.
fn letting_through(constraint: &Constraint, value: f64) -> String {
    let is_least = constraint.margin(value) == constraint.low.map_or(f64::INFINITY, |(bound, _)| value - bound);
    let keeps = |text: &String| text.parse().is_ok_and(|bound: f64| if is_least { value >= bound } else { value <= bound });
    // One step of the last digit beyond is enough, whatever the rounding did.
    let step = 10f64.powf((value.abs().log10().floor() - 3.0).min(0.0));
    let beyond = brief(if is_least { value - step } else { value + step });
    [brief(value), beyond].into_iter().find(keeps).unwrap_or_else(|| plain(value))
}

/// A constraint with its unit, such as `stress_margin at least 0`.
fn constraint_in_words(study: &Study, constraint: &Constraint) -> String {
    let unit = study.unit_over(constraint.quantity, constraint.over);
    format!("{} {} {unit}", constraint.name(&study.model), constraint.in_words()).trim_end().to_owned()
}

/// What the rows of the sample reach of each constraint; `all`: they are all designs.
fn sampled_reach(study: &Study, rows: &[Row], all: bool) -> Vec<Reach> {
    let keeps = |row: &Row, number: usize| row.columns[number].value.is_some_and(|value| study.constraints[number].holds(value));
    let reach = |number: usize, constraint: &Constraint| {
        let better = |held: Option<Reached>, row: &Row| {
            let Some(value) = row.columns[number].value else { return held };
            let is_better = held.is_none_or(|held| {
                let (new, old) = (constraint.margin(value), constraint.margin(held.value));
                new > old || new == old && row.index < held.design
            });
            if is_better { Some(Reached { value, design: row.index, exact: all }) } else { held }
        };
        let with_result = || rows.iter().filter(|row| row.without_result == 0);
        let keeps_others = |row: &&Row| (0..study.constraints.len()).all(|other| other == number || keeps(row, other));
        Reach { best: with_result().fold(None, better), first: with_result().filter(keeps_others).fold(None, better) }
    };
    study.constraints.iter().enumerate().map(|(number, constraint)| reach(number, constraint)).collect()
}

/// The row nearest to feasible; of equally near ones that with the lowest index.
fn nearest(study: &Study, rows: Vec<Row>) -> Option<Nearest> {
    let least = rows.iter().map(|row| row.without_result).min()?;
    // A design without a result in more scenarios than another is not nearer, whatever it is in the rest.
    let rows: Vec<Row> = rows.into_iter().filter(|row| row.without_result == least).collect();
    let spread = |number: usize| {
        let values = rows.iter().filter_map(|row| row.columns[number].value);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        if high > low { high - low } else { 1.0 }
    };
    let spreads: Vec<f64> = (0..study.constraints.len()).map(spread).collect();
    let distance = |row: &Row| -> f64 {
        let parts = study.constraints.iter().zip(&row.columns).zip(&spreads);
        let part = |((constraint, at), spread): ((&Constraint, &crate::certify::AtWorst), &f64)| match at.value {
            Some(value) if constraint.holds(value) => 0.0,
            Some(value) => (-constraint.margin(value)).max(0.0) / spread,
            None => f64::INFINITY,
        };
        parts.map(part).sum()
    };
    let near = rows.iter().map(|row| (distance(row), row)).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.index.cmp(&b.1.index)));
    near.map(|(_, row)| Nearest {
        design: row.index,
        inputs: row.inputs.clone(),
        values: row.columns.iter().map(|at| at.value).collect(),
        without_result: row.without_result,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::study_of;

    #[test]
    fn a_yield_of_nothing_is_told_as_such() {
        let text = |least: f64| {
            format!(
                "[design]\nband_count = [6, 9]\n[operation]\ntorque_Nm = [50, 100]\n[uncertainty]\nfriction = {{ normal = {{ mean = 0.09, sd = 0.005 }} }}\n\
                 [fixed]\ntraction = 0.3\n[probability]\ndraws = 64\n[constraints]\nslip_margin = {{ min = {least} }}\nyield = {{ min = 0.9 }}\n[objectives]\nyield = \"max\"\n"
            )
        };
        let said = |least: f64| {
            let plan =
                Plan::new(study_of(&crate::models::find("metal-cvt").expect("it is a model"), &text(least)).expect("the study is right"));
            Infeasible::of(&plan, 1, &Control::default()).expect("nobody stops it").in_words(&plan.study)
        };
        let none = said(1e6);
        assert!(none[0].contains("at least 0.9: no draw of any design holds; relax what the draws fail at"), "{none:?}");
        assert!(!none.iter().any(|it| it.contains("a bound of 0 ")), "{none:?}");
        let some = said(0.5);
        assert!(
            some[0].contains("at least 0.9: the best of all designs has 0.8125") && some[0].contains("a bound of 0.8125 lets"),
            "{some:?}"
        );
    }
}
