//! Whole tiles of a device's sweep, judged again in f64: values against their error bounds, counts, and that no survivor is missing.

use crate::decision::Decision;
use crate::error::{Error, Result};
use crate::models::{ManyOptions, evaluate_columns};
use crate::parallel::on_threads;
use crate::plan::Plan;
use crate::reduce::{Reduction, State};
use crate::sample::mix;
use crate::screen::gpu::{Answers, Checked, GpuEngine, on_device};
use crate::screen::{CpuEngine, Tables};
use crate::study::Quantity;
use crate::tape::RunningError;
use serde_json::{Value, json};
use std::collections::HashSet;
use std::ops::Range;

/// Designs that every run compares, or all if there are fewer.
pub const LEAST_DESIGNS: u64 = 100_000;
/// Tiles that these are in.
const TILES: u64 = 8;
/// Evaluations that a thread makes one by one to compare outputs in a single scenario.
const MOST_ALONE: u64 = 1 << 20;

/// What the comparison of whole tiles found.
#[derive(Clone, Debug, Default)]
pub struct Recheck {
    /// Designs compared.
    pub designs: u64,
    /// Of these, unsure ones.
    pub unsure: u64,
    /// Per quantity: name, values compared, largest fraction of the error bound that was used.
    pub used: Vec<(String, u64, f64)>,
}

impl Recheck {
    /// As it stands in `run.json`.
    pub fn to_json(&self) -> Value {
        let used = self.used.iter().map(|(name, values, used)| (name.clone(), json!({ "values": values, "share_of_promise": used })));
        json!({ "designs": self.designs, "unsure": self.unsure, "error": used.collect::<serde_json::Map<_, _>>() })
    }

    /// Counts a value; `Err` if it breaks the error bound.
    fn compare(&mut self, slot: usize, name: &str, found: RunningError, exact: f64) -> std::result::Result<(), (f64, f64)> {
        if self.used.len() <= slot {
            self.used.resize(slot + 1, (String::new(), 0, 0.0));
        }
        let entry = &mut self.used[slot];
        if entry.0.is_empty() {
            name.clone_into(&mut entry.0);
        }
        if !found.bound.is_finite() {
            return Ok(());
        }
        entry.1 += 1;
        // f64 rounds too, though nine orders of magnitude less.
        let error = (f64::from(found.value) - exact).abs() - 1e-13 * exact.abs();
        if error.is_nan() || error > found.bound {
            return Err((f64::from(found.value), found.bound));
        }
        if found.bound > 0.0 {
            entry.2 = entry.2.max(error / found.bound);
        }
        Ok(())
    }

    fn add(&mut self, other: Self) {
        self.designs += other.designs;
        self.unsure += other.unsure;
        for (slot, (name, values, used)) in other.used.into_iter().enumerate() {
            if self.used.len() <= slot {
                self.used.push((name, values, used));
            } else {
                let entry = &mut self.used[slot];
                *entry = (std::mem::take(&mut entry.0), entry.1 + values, entry.2.max(used));
            }
        }
    }
}

/// The compared tiles, with what f64 keeps of them: none of it may be missing in the end.
#[derive(Debug)]
pub struct Recheckable {
    report: Recheck,
    states: Vec<State>,
}

/// Tiles spread over a range: all of it if it is small. `by_rows`: each with a whole row at least, as far as the range has one there.
fn tiles(plan: &Plan, whole: &Range<u64>, by_rows: bool) -> Vec<Range<u64>> {
    let designs = whole.end - whole.start;
    // A design with draws takes as long as many without.
    let least = if plan.study.probability.is_some() { LEAST_DESIGNS.min(plan.study.model.sample) } else { LEAST_DESIGNS };
    if designs <= least {
        return if designs == 0 { Vec::new() } else { vec![whole.clone()] };
    }
    let size = least.div_ceil(TILES);
    let (stratum, width) = (designs / TILES, plan.fast.count());
    // Another run of another study looks elsewhere; the same study is compared at the same places.
    let seed = plan.study.hash().bytes().fold(0, |seed, byte| mix(seed ^ u64::from(byte)));
    (0..TILES)
        .map(|number| {
            let first = whole.start + number * stratum;
            let room = stratum.saturating_sub(size).max(1);
            let start = first + mix(seed ^ number) % room;
            let start = if by_rows { (start / width * width).max(whole.start) } else { start };
            let size = if by_rows { size.max(width) } else { size };
            start..(start + size).min(whole.end)
        })
        .collect()
}

impl Recheckable {
    /// Compares tiles of a range.
    ///
    /// # Errors
    /// [`Error::ErrorBound`] that names output, design, both values and the error bound, or the count that differs.
    pub fn new(
        plan: &Plan,
        tables: &Tables,
        reduction: &Reduction,
        engine: &mut GpuEngine<'_>,
        answers: &Answers,
        whole: &Range<u64>,
        threads: usize,
    ) -> Result<Self> {
        let mut found = Self { report: Recheck::default(), states: Vec::new() };
        for range in tiles(plan, whole, engine.judges_rows()) {
            let checked = engine.check(&range)?;
            let used = engine.used_outputs();
            let share = checked.len().div_ceil(threads.max(1)).max(1);
            let parts = on_threads(checked.chunks(share).enumerate(), |(number, part)| {
                compare(plan, tables, reduction, &used, range.start + (number * share) as u64, part)
            });
            let mut state = reduction.start();
            for part in parts {
                let (report, part) = part?;
                found.report.add(report);
                state.merge(part);
            }
            let state = state.state();
            require_counts(plan, engine, answers, &range, &state, tables, reduction)?;
            found.states.push(state);
        }
        Ok(found)
    }

    /// Nothing that f64 keeps of the compared tiles may be missing in the end.
    ///
    /// # Errors
    /// [`Error::ErrorBound`] that names a design that is.
    pub fn require_in(&mut self, reduction: &Reduction, end: &State) -> Result<()> {
        let mut both = reduction.restore(end.clone());
        for state in std::mem::take(&mut self.states) {
            both.merge(State { feasible: 0, ..state });
        }
        let both = both.state();
        let lost = |what: &str, index: u64| {
            Err(Error::ErrorBound(format!("design {index} belongs to the {what}, but the GPU did not hand it over")))
        };
        let held: HashSet<u64> = end.front.indices.iter().copied().collect();
        if let Some(&index) = both.front.indices.iter().find(|index| !held.contains(index)) {
            return lost("front", index);
        }
        let ends = |state: &State| -> Vec<_> { state.extremes.least.iter().chain(&state.extremes.largest).copied().collect() };
        if let Some((_, Some(extreme))) = ends(end).iter().zip(ends(&both)).find(|(a, b)| *a != b) {
            return lost("extremes", extreme.index);
        }
        if let Some((what, index)) = end.reported.lacks(&both.reported) {
            return lost(what, index);
        }
        Ok(())
    }

    /// The report alone.
    pub fn into_report(self) -> Recheck {
        self.report
    }
}

/// Compares designs in a row, from position `start` on.
fn compare(
    plan: &Plan,
    tables: &Tables,
    reduction: &Reduction,
    used: &[usize],
    start: u64,
    checked: &[Checked],
) -> Result<(Recheck, State)> {
    let mut report = Recheck { designs: checked.len() as u64, ..Recheck::default() };
    let mut reducers = reduction.start();
    let mut broken = None;
    let model = &plan.study.model;
    // What f64 says of every design: feasible or not, and the worst values of the feasible ones.
    let mut engine = CpuEngine::new(plan, tables);
    let mut feasible = vec![false; checked.len()];
    engine.screen(start..start + checked.len() as u64, |block| {
        reduction.absorb(&mut reducers, block);
        for lane in block.feasible() {
            let at = (plan.position_of(block.index(lane)) - start) as usize;
            feasible[at] = true;
            if checked[at].verdict != Decision::Yes {
                continue;
            }
            for (slot, ((tracked, _), values)) in plan.tracked.iter().zip(block.values).enumerate() {
                let exact = on_device(plan, tracked.quantity, values[lane]);
                let name = tracked.quantity.name(model);
                if let Err(found) = report.compare(slot, name, checked[at].worst[slot], exact) {
                    broken.get_or_insert_with(|| broken_bound(plan, tracked.quantity, block.index(lane), found, exact, "at its worst"));
                }
            }
        }
    });
    if let Some(broken) = broken {
        return Err(broken);
    }
    let each = plan.evaluations() / plan.scenarios();
    let step = (checked.len() as u64).saturating_mul(each).div_ceil(MOST_ALONE) as usize;
    let alone: Vec<_> = (start..).zip(checked).step_by(step.max(1)).filter(|(_, it)| !it.asked.is_empty()).collect();
    compare_alone(plan, used, &alone, &mut report)?;
    for (at, (checked, &feasible)) in checked.iter().zip(&feasible).enumerate() {
        report.unsure += u64::from(checked.verdict == Decision::Unsure);
        let design = plan.design_at(start + at as u64);
        if (checked.verdict == Decision::Yes) != feasible && checked.verdict != Decision::Unsure {
            let (gpu, f64s) = if feasible { ("infeasible", "feasible") } else { ("feasible", "infeasible") };
            return Err(Error::ErrorBound(format!("design {design}: the GPU is sure that it is {gpu}, f64 finds it {f64s}")));
        }
    }
    Ok((report, reducers.state()))
}

/// Compares the outputs of designs, given by their positions, in one scenario each.
fn compare_alone(plan: &Plan, used: &[usize], alone: &[(u64, &Checked)], report: &mut Recheck) -> Result<()> {
    let model = &plan.study.model;
    let scenario_of =
        |checked: &Checked| plan.slow_scenarios.source_index(checked.scenario.0) + plan.fast_scenarios.source_index(checked.scenario.1);
    let varied = plan.space.designs.inputs() | plan.space.scenarios.inputs();
    let mut columns: Vec<(&str, Vec<f64>)> = varied.iter().map(|it| (&*model.inputs[it].name, Vec::with_capacity(alone.len()))).collect();
    for &(position, checked) in alone {
        let inputs = plan.space.inputs(plan.design_at(position), scenario_of(checked));
        varied.iter().zip(&mut columns).for_each(|(input, (_, column))| column.push(inputs[input]));
    }
    let columns: Vec<(&str, &[f64])> = columns.iter().map(|(name, column)| (*name, &**column)).collect();
    let options = ManyOptions::default().outputs(used).inputs(&plan.study.fixed).threads(1);
    let found = evaluate_columns(model, &columns, &options)?;
    for (number, (&output, values)) in used.iter().zip(&found.outputs).enumerate() {
        let slot = plan.tracked.len() + number;
        let name = format!("{} in one scenario", model.outputs[output].name);
        for (&(position, checked), &value) in alone.iter().zip(values).filter(|(_, value)| !value.is_nan()) {
            let exact = model.outputs[output].unit.to_si(value);
            if let Err(found) = report.compare(slot, &name, checked.asked[number], exact) {
                let place = format!("in scenario {}", scenario_of(checked));
                return Err(broken_bound(plan, Quantity::Output(output), plan.design_at(position), found, exact, &place));
            }
        }
    }
    Ok(())
}

/// The error for a value that is farther from f64 than its error bound.
fn broken_bound(plan: &Plan, quantity: Quantity, design: u64, (found, bound): (f64, f64), exact: f64, place: &str) -> Error {
    let in_unit = |value: f64| match quantity {
        Quantity::Output(output) => plan.study.model.outputs[output].unit.from_si(value),
        Quantity::Input(_) => value,
    };
    let (found, exact, bound) = (in_unit(found), in_unit(exact), in_unit(bound));
    Error::ErrorBound(format!(
        "{} of design {design} {place}: the GPU gives {found}, f64 gives {exact}; they differ by {:.3e}, more than the error bound of {bound:.3e}",
        quantity.name(&plan.study.model),
        (found - exact).abs(),
    ))
}

/// The sweep of a tile must count what f64 counts in it.
fn require_counts(
    plan: &Plan,
    engine: &mut GpuEngine<'_>,
    answers: &Answers,
    range: &Range<u64>,
    state: &State,
    tables: &Tables,
    reduction: &Reduction,
) -> Result<()> {
    let mut reducers = reduction.start();
    let mut host = CpuEngine::new(plan, tables);
    let mut rest = vec![range.clone()];
    while let Some(next) = rest.pop() {
        let tile = engine.tile(&next, (next.end - next.start).min(engine.at_once()));
        if tile.end < next.end {
            rest.push(tile.end..next.end);
        }
        let flying = engine.start(tile.clone(), answers);
        let Some((counts, survivors)) = engine.finish(&flying)? else {
            let middle = tile.start + (tile.end - tile.start).div_ceil(2);
            rest.extend([tile.start..middle, middle..tile.end]);
            continue;
        };
        reduction.add_counts(&mut reducers, counts.sure, &counts.reported);
        let mut unsure: Vec<u64> = survivors.iter().filter(|it| it.unsure).map(|it| it.position).collect();
        unsure.sort_unstable();
        if unsure.len() as u64 != counts.unsure {
            return Err(Error::ErrorBound(format!("the GPU counted {} unsure designs and handed over {}", counts.unsure, unsure.len())));
        }
        host.screen_some(&unsure, |block| reduction.absorb(&mut reducers, block));
    }
    let found = reducers.state();
    let differ = |what: &str, gpu: u64, f64s: u64| {
        Err(Error::ErrorBound(format!(
            "of designs {} to {} in the sweep's order the GPU counts {gpu} {what}, f64 counts {f64s}",
            range.start,
            range.end - 1
        )))
    };
    if found.feasible != state.feasible {
        return differ("feasible designs", found.feasible, state.feasible);
    }
    if let Some((what, gpu, f64s)) = found.reported.miscounts(&state.reported) {
        return differ(what, gpu, f64s);
    }
    Ok(())
}
