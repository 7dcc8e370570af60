//! A model with a study's formulas around it: what they give becomes an input or an output like any other, for every engine.
//!
//! Formulas that give inputs are evaluated before the model, formulas that read its outputs after it. An input that a formula gives is
//! an output of the extended model: nothing else may set it, and its value is shown like any other result. SlotNumbers that axes give to
//! formulas and not to the model, variables, are inputs.

mod columns;
mod interned;
mod kernel;
mod surroundings;

use super::description::{CONDITION_BOUND_FACTOR, Condition, Input, Output, Preset, Range, Worse};
use super::model::{CurveSource, Extension, Model, Origin};
use super::status::{Evaluation, Status};
use crate::formula::{FormulaProblem, Formulas, MeasuredCurve, NameRole, QuantityUnit, Scope, ScopeName, Units};
use crate::units::Unit;
use interned::interned;
use kernel::Extended;
use std::sync::Arc;
use surroundings::Surroundings;

/// What is wrong with an extension.
#[derive(Clone, Debug, PartialEq)]
pub enum ExtensionProblem {
    /// Of the own unit of this number.
    Unit(usize, String),
    /// Of a variable.
    Variable(String, String),
    /// Of the curve of this number, and where known the number of the point.
    Curve(usize, Option<usize>, String),
    /// Of a formula.
    Formula(FormulaProblem),
    /// Of all of it together.
    Whole(String),
}

/// A model with what a study adds to it.
///
/// # Errors
/// Everything that is wrong with it.
pub fn extended(base: &Arc<Model>, extension: Extension) -> Result<Model, Vec<ExtensionProblem>> {
    let formulas = checked(base, &extension)?;
    let around = surroundings(base, &extension, formulas);
    let tables = ExtendedTables::new(&around, &extension);
    let fields = base.kernel.formula().map(|formula| formula.fields());
    let around = Arc::new(around);
    let kernel = Extended::new((*around).clone(), fields);
    let (remarks, notes, profile, pulley) = (base.remarks.clone(), base.notes.clone(), base.profile.clone(), base.pulley.clone());
    let wrapped = |around: &Arc<Surroundings>| around.clone();
    let model = Model {
        inputs: tables.inputs,
        outputs: tables.outputs,
        conditions: tables.conditions,
        presets: presets(&around),
        kernel: Arc::new(kernel),
        remarks: remarks.map(|remarks| {
            let around = wrapped(&around);
            Arc::new(move |fixed: &[Option<f64>]| remarks(&around.fixed_of_base(fixed))) as super::model::Remarks
        }),
        notes: notes.map(|notes| {
            let around = wrapped(&around);
            Arc::new(move |model: &Model, inputs: &[f64], evaluation: &Evaluation| {
                notes(&around.base, &around.units_of_base(model, inputs), &around.evaluation_of_base(evaluation))
            }) as super::model::Notes
        }),
        profile: profile.map(|profile| {
            let around = wrapped(&around);
            Arc::new(move |model: &Model, inputs: &[f64]| profile(&around.base, &around.units_of_base(model, inputs)))
                as super::model::AlongTheBelt
        }),
        pulley: pulley.map(|pulley| {
            let around = wrapped(&around);
            Arc::new(move |model: &Model, inputs: &[f64]| pulley(&around.base, &around.units_of_base(model, inputs)))
                as super::model::PulleyOf
        }),
        origin: Some(Arc::new(Origin { base: base.clone(), extension })),
        ..(**base).clone()
    };
    model.flaw_of_sizes().map_or(Ok(model), |flaw| Err(vec![ExtensionProblem::Whole(flaw)]))
}

/// What the model and its variables are called in formulas, in the order of their slots.
fn scope(base: &Model, extension: &Extension) -> Result<Scope, Vec<ExtensionProblem>> {
    let mut problems = Vec::new();
    let units = Units::new(&extension.units).unwrap_or_else(|found| {
        problems.extend(found.into_iter().map(|(at, message)| ExtensionProblem::Unit(at, message)));
        Units::default()
    });
    let mut names: Vec<ScopeName> = base.inputs.iter().map(name_of_input).collect();
    for variable in &extension.variables {
        match units.of_name(variable) {
            Ok(measure) => names.push(ScopeName::new(variable, NameRole::Variable, measure)),
            Err(message) => problems.push(ExtensionProblem::Variable(variable.clone(), message)),
        }
    }
    names.extend(base.outputs.iter().map(|output| {
        let name = ScopeName::new(&output.name, NameRole::Output, output.unit.into());
        let name = if output.integer { name.whole() } else { name };
        let may_go = base.conditions.iter().any(|condition| condition.invalidates.contains(&output.name));
        if may_go { name.maybe_absent() } else { name }
    }));
    let mut curves = Vec::new();
    for (number, CurveSource { name, x, y, points }) in extension.curves.iter().enumerate() {
        let wrong = |point, message| ExtensionProblem::Curve(number, point, message);
        match (units.of_name(x), units.of_name(y)) {
            (Ok(x), Ok(y)) => match MeasuredCurve::new(name, x, y, points) {
                Ok(curve) => curves.push(curve),
                Err((point, message)) => problems.push(wrong(point, message)),
            },
            (x, y) => problems.extend([x.err(), y.err()].into_iter().flatten().map(|message| wrong(None, message))),
        }
    }
    if problems.is_empty() { Ok(Scope::new(units, names, curves)) } else { Err(problems) }
}

fn name_of_input(input: &Input) -> ScopeName {
    let name = ScopeName::new(&input.name, NameRole::Input, input.unit.into());
    let name = if input.integer { name.whole() } else { name };
    if input.words.is_empty() { name } else { name.words(input.words.clone(), input.is_enumeration()) }
}

fn checked(base: &Model, extension: &Extension) -> Result<Formulas, Vec<ExtensionProblem>> {
    let scope = scope(base, extension)?;
    Formulas::new(&scope, &extension.formulas).map_err(|problems| problems.into_iter().map(ExtensionProblem::Formula).collect())
}

fn surroundings(base: &Arc<Model>, extension: &Extension, formulas: Formulas) -> Surroundings {
    let inputs = base.inputs.len();
    let given: Vec<usize> = formulas.order().iter().map(|&it| &formulas.all()[it]).filter(|it| it.gives_input).map(|it| it.slot).collect();
    let needs = |reads_outputs: bool| {
        let of = |number: &usize| formulas.all()[formulas.requirements()[*number].formula].reads_outputs == reads_outputs;
        (0..formulas.requirements().len()).filter(of).collect()
    };
    let ends = given.iter().flat_map(|&slot| ends(&base.inputs[slot], slot)).map(|(end, _)| end).collect();
    Surroundings {
        inputs: (0..inputs).filter(|slot| !given.contains(slot)).chain(inputs..inputs + extension.variables.len()).collect(),
        first_output: inputs + extension.variables.len(),
        before: formulas.before_model().collect(),
        after: formulas.after_model().collect(),
        needs_before: needs(false),
        needs_after: needs(true),
        ends,
        maybe_absent: (0..formulas.all().len()).filter(|&it| !formulas.all()[it].absent_with.is_empty()).collect(),
        given,
        base: base.clone(),
        formulas,
    }
}

/// The ends that a computed input must keep, with whether the end itself is out of range.
fn ends(input: &Input, slot: usize) -> Vec<(surroundings::RangeEnd, bool)> {
    let Range { low, high, includes_low, includes_high } = input.valid;
    let lower = low.is_finite().then(|| (surroundings::RangeEnd::new(slot, input.unit.to_si(low), false), !includes_low));
    let upper = high.is_finite().then(|| (surroundings::RangeEnd::new(slot, input.unit.to_si(high), true), !includes_high));
    lower.into_iter().chain(upper).collect()
}

/// The tables of an extended model.
struct ExtendedTables {
    inputs: Vec<Input>,
    outputs: Vec<Output>,
    conditions: Vec<Condition>,
}

impl ExtendedTables {
    fn new(around: &Surroundings, extension: &Extension) -> Self {
        let base = &around.base;
        let units = Units::new(&extension.units).unwrap_or_default();
        let unit = |name: &str, measure: QuantityUnit| {
            let symbol = units.symbol_of_name(name).unwrap_or_default().replace('2', "²").replace('3', "³");
            Unit::of_formulas(interned(&symbol), measure.factors())
        };
        let inputs = around.inputs.iter().map(|&slot| match slot.checked_sub(base.inputs.len()) {
            None => base.inputs[slot].clone(),
            Some(variable) => {
                let name = &extension.variables[variable];
                let measure = units.of_name(name).unwrap_or(QuantityUnit::NONE);
                let all = Range::between(f64::NEG_INFINITY, f64::INFINITY);
                Input::new(name, "", unit(name, measure), 0.0, (f64::MIN, f64::MAX), "A variable of the study.", "the study").valid(all)
            }
        });
        let own = around.formulas.all().iter().map(|formula| {
            if formula.gives_input {
                let input = &base.inputs[formula.slot];
                let doc = format!("{} Given by a formula of the study.", input.doc);
                return Output::new(&input.name, &input.symbol, input.unit, Worse::Higher, &formula.text, doc);
            }
            let output = Output::new(
                &formula.name,
                "",
                unit(&formula.name, formula.measure),
                Worse::Higher,
                &formula.text,
                "A formula of the study.",
            );
            if formula.whole { output.whole() } else { output }
        });
        let outputs: Vec<Output> = base.outputs.iter().cloned().chain(own.map(|it| it.with_bound_factor(CONDITION_BOUND_FACTOR))).collect();
        Self { inputs: inputs.collect(), conditions: conditions(around, &outputs[base.outputs.len()..]), outputs }
    }
}

/// The conditions of an extended model, in the order of its margins.
fn conditions(around: &Surroundings, own: &[Output]) -> Vec<Condition> {
    let base = &around.base;
    let everything: Vec<&str> = base.outputs.iter().chain(own).map(|it| it.name.as_str()).collect();
    let formulas = around.formulas.all();
    let gives_input = |slots: &[usize]| formulas.iter().any(|it| it.gives_input && slots.contains(&it.slot));
    let need = |&number: &usize| {
        let requirement = &around.formulas.requirements()[number];
        let formula = &formulas[requirement.formula];
        let dependents = around.formulas.dependents(requirement.formula);
        let slots: Vec<usize> = dependents.iter().map(|&it| formulas[it].slot).collect();
        let names: Vec<&str> = dependents.iter().map(|&it| own[it].name.as_str()).collect();
        let taken = if gives_input(&slots) { &everything[..] } else { &names[..] };
        Condition::new(requirement.status.clone(), requirement.strict, taken, format!("The formula {} has a value.", formula.name))
    };
    let range = |&slot: &usize| {
        let input = &base.inputs[slot];
        let doc = format!("{} is {}, as the model needs it.", input.name, input.valid.in_words());
        ends(input, slot).into_iter().map(move |(_, strict)| (format!("input {} out of range", input.name), strict, doc.clone()))
    };
    let of_ranges = around.given.iter().flat_map(range).map(|(reason, strict, doc)| Condition::new(reason, strict, &everything, doc));
    let absent = |&formula: &usize| {
        let name = &formulas[formula].name;
        let doc = format!("What {name} is computed from has a value.");
        Condition::new(format!("formula {name}: no value"), false, &[own[formula].name.as_str()], doc).quiet()
    };
    let before = around.needs_before.iter().map(need).chain(of_ranges);
    let after = around.needs_after.iter().map(need).chain(around.maybe_absent.iter().map(absent));
    before.chain(base.conditions.iter().cloned()).chain(after).collect()
}

/// Presets without what formulas give.
fn presets(around: &Surroundings) -> Vec<Preset> {
    let base = &around.base;
    let is_given = |name: &String| base.input(name).is_some_and(|slot| around.given.contains(&slot));
    let without = |preset: &Preset| {
        let mut preset = preset.clone();
        preset.changes.retain(|(name, _)| !is_given(name));
        preset
    };
    base.presets.iter().map(without).collect()
}

impl Surroundings {
    /// Inputs of the model that no axis sets.
    fn fixed_of_base(&self, fixed: &[Option<f64>]) -> Vec<Option<f64>> {
        let position = |slot: usize| self.inputs.iter().position(|it| *it == slot);
        (0..self.base.inputs.len()).map(|slot| position(slot).and_then(|input| fixed[input])).collect()
    }

    /// Inputs of the model in their units.
    fn units_of_base(&self, model: &Model, inputs: &[f64]) -> Vec<f64> {
        let slots = self.before(&super::to_si(model, inputs)).slots;
        let position = |slot: usize| self.inputs.iter().position(|it| *it == slot);
        let value = |slot: usize| position(slot).map_or_else(|| self.base.inputs[slot].unit.from_si(slots[slot]), |input| inputs[input]);
        (0..self.base.inputs.len()).map(value).collect()
    }

    /// An evaluation as the model would have told it.
    fn evaluation_of_base(&self, evaluation: &Evaluation) -> Evaluation {
        let status = match evaluation.status {
            Status::Failed(condition) => {
                let own = condition.checked_sub(self.first_condition()).filter(|it| *it < self.base.conditions.len());
                own.map_or(Status::Ok, Status::Failed)
            }
            other => other,
        };
        Evaluation { status, outputs: evaluation.outputs[..self.base_outputs()].to_vec() }
    }
}
