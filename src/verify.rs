//! Compares a model on a device with f64 at single points: the errors, how much of the error bounds they use, and wrong decisions.
//!
//! The points are the ends of every range, both sides of every condition and constraint, and seeded random ones.

use crate::decision::Decision;
use crate::error::{Error, Result};
use crate::gpu::PointKernel;
use crate::models::{CONDITION_BOUND_FACTOR, Condition, Input, Model, Set, evaluate, holds, judge, to_si};
use crate::plan::Plan;
use crate::sample::mix;
use crate::study::{Constraint, Quantity};
use crate::tape::RunningError;

/// The errors of one output or condition.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Name of the output, or reason of the condition.
    pub name: String,
    /// Values compared.
    pub values: u64,
    /// Values about which the device says nothing, because their error bound is not finite.
    pub unbounded: u64,
    /// Median error, relative to the value; like the next three it leaves out points on a boundary.
    pub median_error: f64,
    /// Largest error relative to the value.
    pub largest_error: f64,
    /// Median error bound relative to the value.
    pub median_bound: f64,
    /// 99 of 100 error bounds are at most this, relative to the value.
    pub usual_bound: f64,
    /// Largest error as a fraction of its error bound.
    pub used: f64,
    /// Values with an error larger than their error bound.
    pub broken: u64,
    /// The first of these, in words.
    pub example: Option<String>,
}

/// The comparison of a model.
#[derive(Clone, Debug, Default)]
pub struct VerifyReport {
    /// Points compared.
    pub points: u64,
    /// Points whose status, or whose keeping of the constraints, the device was not sure of.
    pub unsure: u64,
    /// Points of which the device was sure and wrong.
    pub flips: u64,
    /// The first of these, in words.
    pub flip: Option<String>,
    /// Per output.
    pub outputs: Vec<Statistics>,
    /// Per condition.
    pub conditions: Vec<Statistics>,
}

impl VerifyReport {
    /// Do all error bounds hold, and was no sure decision wrong?
    ///
    /// # Errors
    /// [`Error::ErrorBound`] that names output, point, both values and the error bound.
    pub fn require(&self) -> Result<()> {
        let example = self.outputs.iter().chain(&self.conditions).find_map(|it| it.example.clone()).or_else(|| self.flip.clone());
        example.map_or(Ok(()), |example| Err(Error::ErrorBound(example)))
    }
}

/// Points at which to compare.
#[derive(Clone, Debug, Default)]
pub struct VerifyPoints {
    /// One value per input of the model, in its unit.
    inputs: Vec<Vec<f64>>,
    /// Does the point lie on a boundary? There values vanish, and a relative error means nothing.
    on_boundary: Vec<bool>,
}

impl From<Vec<Vec<f64>>> for VerifyPoints {
    fn from(inputs: Vec<Vec<f64>>) -> Self {
        Self { on_boundary: vec![false; inputs.len()], inputs }
    }
}

impl VerifyPoints {
    fn push(&mut self, inputs: Vec<f64>, on_boundary: bool) {
        self.inputs.push(inputs);
        self.on_boundary.push(on_boundary);
    }

    fn len(&self) -> usize {
        self.inputs.len()
    }

    fn truncate(mut self, count: usize) -> Self {
        self.inputs.truncate(count);
        self.on_boundary.truncate(count);
        self
    }
}

/// Random numbers in [0, 1), by seed and place.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mix(self.0)
    }

    #[allow(clippy::cast_precision_loss, reason = "53 bits are exact")]
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// The usual range of an input; where none is said, a valid one around the default.
fn tried(input: &Input) -> (f64, f64) {
    if input.usual != (f64::MIN, f64::MAX) {
        return input.usual;
    }
    let around = if input.word_for(input.default).is_some() { 1.0 } else { input.default };
    let reach = 0.5 * around.abs().max(1.0);
    let within = |value: f64, otherwise: f64| if input.valid.contains(value) { value } else { otherwise };
    let inside = if input.valid.contains(around) { around } else { 0.5 * (input.valid.low + input.valid.high) };
    (within(inside - reach, inside), within(inside + reach, inside))
}

/// A value of an input's usual range: an end of it, the default, or anything between, evenly or in the logarithm.
fn usual(input: &Input, random: &mut Random) -> f64 {
    if input.cpu_only {
        return input.default;
    }
    let (low, high) = tried(input);
    if !input.words.is_empty() && (input.is_enumeration() || random.next().is_multiple_of(6)) {
        // If there is only one word, no random number is needed.
        let which = if input.words.len() > 1 { random.next() % input.words.len() as u64 } else { 0 };
        return input.words[which as usize].1;
    }
    let value = match random.next() % 8 {
        0 => low,
        1 => high,
        2 => input.default,
        3 if low > 0.0 => low * libm::pow(high / low, random.unit()),
        _ => low + random.unit() * (high - low),
    };
    if input.integer { value.round() } else { value }
}

/// Points of a model: over its usual ranges, every second pair on the two sides of where a status changes.
pub fn points_of_model(model: &Model, samples: usize, seed: u64) -> VerifyPoints {
    let mut random = Random(mix(seed));
    let status = |inputs: &[f64]| evaluate(model, inputs).status;
    let mut points = VerifyPoints::default();
    while points.len() < samples {
        let here: Vec<f64> = model.inputs.iter().map(|input| usual(input, &mut random)).collect();
        points.push(here.clone(), false);
        if points.len() % 4 == 0 {
            let mut there = here.clone();
            let input = (random.next() % model.inputs.len() as u64) as usize;
            there[input] = usual(&model.inputs[input], &mut random);
            let both = sides(model, &here, &there, input, |inputs| status(inputs) == status(&here));
            both.into_iter().for_each(|side| points.push(side, true));
        }
    }
    points.truncate(samples)
}

/// The two points on either side of where `same` changes between two values of one input; none if it does not.
fn sides(model: &Model, here: &[f64], there: &[f64], input: usize, same: impl Fn(&[f64]) -> bool) -> Vec<Vec<f64>> {
    let table = &model.inputs[input];
    let special = |value: f64| table.word_for(value).is_some();
    if table.integer || special(here[input]) || special(there[input]) || same(there) {
        return Vec::new();
    }
    let (mut inside, mut outside) = (here.to_vec(), there.to_vec());
    for _ in 0..60 {
        let mut middle = inside.clone();
        middle[input] = 0.5 * (inside[input] + outside[input]);
        if same(&middle) { inside = middle } else { outside = middle }
    }
    vec![inside, outside]
}

/// Points of a study: corners of its space, random designs in random scenarios, and both sides of its constraints between them.
pub fn points_of_study(plan: &Plan, samples: usize, seed: u64) -> VerifyPoints {
    let mut random = Random(mix(seed));
    let model = &plan.study.model;
    let kept = |inputs: &[f64]| {
        let found = evaluate(model, inputs);
        let value = |quantity| match quantity {
            Quantity::Input(input) => Some(inputs[input]),
            Quantity::Output(output) => found.outputs[output],
        };
        let of_scenarios = plan.study.constraints.iter().filter(|it| it.over.is_worst());
        of_scenarios.map(|it| value(it.quantity).is_some_and(|value| it.holds(value))).collect::<Vec<_>>()
    };
    let (designs, scenarios) = (plan.designs(), plan.scenarios());
    let any = |random: &mut Random| plan.space.inputs(random.next() % designs, random.next() % scenarios);
    let mut points = VerifyPoints::default();
    for (design, scenario) in [(0, 0), (designs - 1, 0), (0, scenarios - 1), (designs - 1, scenarios - 1)] {
        points.push(plan.space.inputs(design, scenario), false);
    }
    while points.len() < samples {
        let here = any(&mut random);
        points.push(here.clone(), false);
        if points.len() % 4 == 0 {
            let other = any(&mut random);
            let varied: Vec<usize> = (0..here.len()).filter(|&input| here[input] != other[input]).collect();
            if let Some(&input) = varied.get((random.next() % varied.len().max(1) as u64) as usize) {
                let mut there = here.clone();
                there[input] = other[input];
                let all = kept(&here);
                let both = sides(model, &here, &there, input, |inputs| kept(inputs) == all);
                both.into_iter().for_each(|side| points.push(side, true));
            }
        }
    }
    points.truncate(samples)
}

/// Compares a device's kernel with f64 at these points; `constraints` are those of a study, if it is the kernel of one.
///
/// # Errors
/// [`Error::Gpu`].
pub fn compare(kernel: &PointKernel, model: &Model, constraints: &[Constraint], points: &VerifyPoints) -> Result<VerifyReport> {
    let si: Vec<Vec<f64>> = points.inputs.iter().map(|inputs| to_si(model, inputs)).collect();
    let found = kernel.evaluate(&si)?;
    let mut outputs: Vec<Collector> = model.outputs.iter().map(|it| Collector::new(&it.name)).collect();
    let mut conditions: Vec<Collector> = model.conditions.iter().map(|it| Collector::new(&it.reason)).collect();
    let mut report = VerifyReport { points: points.len() as u64, ..VerifyReport::default() };
    for (((inputs, &on_boundary), si), (values, margins)) in points.inputs.iter().zip(&points.on_boundary).zip(&si).zip(&found) {
        let prepared = model.kernel.prepared(si);
        let exact_margins = model.kernel.margins(&prepared, si);
        let exact = model.kernel.outputs(&prepared, si, Set::ALL);
        let (status, present) = judge(model, &exact_margins);
        let point = || describe(model, inputs);
        for (number, output) in model.outputs.iter().enumerate() {
            if present.contains(number) && exact[number].is_finite() {
                let bounded = RunningError { value: values[number].value, bound: values[number].bound * output.bound_factor };
                outputs[number].take(bounded, exact[number], on_boundary, |found| {
                    let in_unit = |value: f64| output.unit.from_si(value);
                    (in_unit(found.0), in_unit(exact[number]), in_unit(found.1), point())
                });
            }
        }
        let mut sure = Decision::Yes;
        for (number, condition) in model.conditions.iter().enumerate() {
            let bounded = RunningError { value: margins[number].value, bound: margins[number].bound * CONDITION_BOUND_FACTOR };
            conditions[number]
                .take(bounded, exact_margins[number], on_boundary, |found| (found.0, exact_margins[number], found.1, point()));
            if !condition.quiet || takes_away(model, condition, constraints) {
                sure = sure.and(holds(model, number, f64::from(bounded.value), bounded.bound));
            }
        }
        let mut ok = status == crate::models::Status::Ok;
        // A mean or sum is no number of a single point.
        for constraint in constraints.iter().filter(|it| it.over.is_worst()) {
            let Quantity::Output(output) = constraint.quantity else { continue };
            let unit = model.outputs[output].unit;
            ok &= present.contains(output) && constraint.holds(unit.from_si(exact[output]));
            let (value, bound) = (f64::from(values[output].value), values[output].bound * model.outputs[output].bound_factor);
            let sides = [constraint.low.map(|low| (low, 1.0)), constraint.high.map(|high| (high, -1.0))];
            for ((limit, strict), side) in sides.into_iter().flatten() {
                let margin = side * (value - unit.to_si(limit));
                let decision = if strict { Decision::above_zero(margin, bound) } else { Decision::at_least_zero(margin, bound) };
                sure = sure.and(decision);
            }
        }
        report.unsure += u64::from(sure == Decision::Unsure);
        if sure == if ok { Decision::No } else { Decision::Yes } {
            report.flips += 1;
            report.flip.get_or_insert_with(|| format!("the GPU is sure of {sure:?} where f64 says {ok}: {}", point()));
        }
    }
    report.outputs = outputs.into_iter().map(Collector::statistics).collect();
    report.conditions = conditions.into_iter().map(Collector::statistics).collect();
    Ok(report)
}

/// Does a condition, if it fails, invalidate an output that has a constraint?
fn takes_away(model: &Model, condition: &Condition, constraints: &[Constraint]) -> bool {
    let constrained = |name: &String| constraints.iter().any(|it| model.output(name).map(Quantity::Output) == Some(it.quantity));
    condition.invalidates.iter().any(constrained)
}

/// A point as text: all inputs by name.
fn describe(model: &Model, inputs: &[f64]) -> String {
    let each = model.inputs.iter().zip(inputs).map(|(input, &value)| match input.word_for(value) {
        Some(word) => format!("{} = \"{word}\"", input.name),
        None => format!("{} = {value}", input.name),
    });
    each.collect::<Vec<_>>().join(", ")
}

/// Collects what becomes [`Statistics`].
struct Collector {
    statistics: Statistics,
    errors: Vec<f64>,
    bounds: Vec<f64>,
}

impl Collector {
    fn new(name: &str) -> Self {
        Self { statistics: Statistics { name: name.to_owned(), ..Statistics::default() }, errors: Vec::new(), bounds: Vec::new() }
    }

    /// Takes a value; `describe` converts (found, bound) to (found, exact, bound) in the unit, and the point.
    fn take(&mut self, found: RunningError, exact: f64, on_boundary: bool, describe: impl FnOnce((f64, f64)) -> (f64, f64, f64, String)) {
        let it = &mut self.statistics;
        it.values += 1;
        if !found.bound.is_finite() || !found.value.is_finite() {
            it.unbounded += 1;
            return;
        }
        // f64 rounds too, though nine orders of magnitude less.
        let error = ((f64::from(found.value) - exact).abs() - 1e-13 * exact.abs()).max(0.0);
        if error > found.bound {
            it.broken += 1;
            if it.example.is_none() {
                let (gpu, f64s, bound, point) = describe((f64::from(found.value), found.bound));
                it.example = Some(format!(
                    "{}: the GPU gives {gpu}, f64 gives {f64s}; they differ by {:.3e}, more than the error bound of {bound:.3e}, at {point}",
                    it.name,
                    (gpu - f64s).abs()
                ));
            }
        }
        if found.bound > 0.0 {
            it.used = it.used.max(error / found.bound);
        }
        if exact != 0.0 && !on_boundary {
            self.errors.push(error / exact.abs());
            self.bounds.push(found.bound / exact.abs());
        }
    }

    fn statistics(mut self) -> Statistics {
        self.errors.sort_by(f64::total_cmp);
        self.bounds.sort_by(f64::total_cmp);
        let at = |sorted: &[f64], hundredth: usize| sorted.get((sorted.len().saturating_sub(1)) * hundredth / 100).copied().unwrap_or(0.0);
        Statistics {
            median_error: at(&self.errors, 50),
            largest_error: at(&self.errors, 100),
            median_bound: at(&self.bounds, 50),
            usual_bound: at(&self.bounds, 99),
            ..self.statistics
        }
    }
}
