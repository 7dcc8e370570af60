//! A model with a study's formulas around it: what they give becomes an input or an output like any other, for every engine.
//!
//! Formulas that give inputs are evaluated before the model, formulas that read its outputs after it. An input that a formula gives is
//! an output of the extended model: nothing else may set it, and its value is shown like any other result. SlotNumbers that axes give to
//! formulas and not to the model, variables, are inputs.

mod columns;
mod first;
mod kernel;
mod nothing;
mod surroundings;
mod tables;

use super::description::{Input, Range};
use super::model::{Model, Origin};
use super::source::{CurveSource, Extension, FileSource};
use super::status::{Evaluation, Status};
use super::tolerance::ModelTolerance;
use crate::formula::{
    Expression, FormulaProblem, Formulas, MOST_ROOTS, MeasuredCurve, NameRole, QuantityUnit, Scope, ScopeName, Units, nominal_name,
    nominal_of,
};
use crate::interned::interned;
use crate::probability::Effect;
use crate::units::Unit;
use first::{FirstStage, NamedInputs};
use kernel::Extended;
pub use nothing::nothing;
use std::sync::Arc;
use surroundings::{ConditionPlace, ReadOutputs, Surroundings};
use tables::{ExtendedTables, presets};

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

/// A model with what a study adds to it, or the file of a model to the model that it is based on ([`nothing()`] if it is formulas alone).
///
/// # Errors
/// Everything that is wrong with it.
pub fn extended(base: &Arc<Model>, extension: Extension) -> Result<Model, Vec<ExtensionProblem>> {
    let formulas = checked(base, &extension)?;
    let roots = roots_of(base) + roots_in(&extension);
    if roots > MOST_ROOTS {
        let message =
            format!("there may be at most {MOST_ROOTS} roots in the formulas of a study and its model together, here are {roots}");
        return Err(vec![ExtensionProblem::Whole(message)]);
    }
    let around = surroundings(base, &extension, formulas);
    let tables = ExtendedTables::new(&around, &extension);
    let fields = base.kernel.formula().map(|formula| formula.fields());
    let around = Arc::new(around);
    let kernel = Extended::new((*around).clone(), fields);
    let effort = if around.is_alone() { kernel.effort() } else { base.effort };
    let FileSource { name, summary, source, limits, .. } =
        extension.file.as_deref().cloned().unwrap_or_else(|| FileSource { name: base.name.clone(), ..FileSource::default() });
    let words = |own: Option<String>, of_base: &String| own.unwrap_or_else(|| of_base.clone());
    let (remarks, notes, profile, pulley) = (base.remarks.clone(), base.notes.clone(), base.profile.clone(), base.pulley.clone());
    let doubts = base.doubts.clone();
    let wrapped = |around: &Arc<Surroundings>| around.clone();
    let model = Model {
        name,
        summary: words(summary, &base.summary),
        source: words(source, &base.source),
        limits: words(limits, &base.limits),
        effort,
        starter: if extension.file.is_some() { String::new() } else { base.starter.clone() },
        inputs: tables.inputs,
        outputs: tables.outputs,
        conditions: tables.conditions,
        presets: presets(&around, &extension),
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
        doubts: doubts.map(|doubts| {
            let around = wrapped(&around);
            Arc::new(move |model: &Model, inputs: &[f64]| doubts(&around.base, &around.units_of_base(model, inputs)))
                as super::model::Doubts
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

/// How many roots the formulas have that were added to a model.
fn roots_of(model: &Model) -> usize {
    model.origin.as_ref().map_or(0, |origin| roots_of(&origin.base) + roots_in(&origin.extension))
}

fn roots_in(extension: &Extension) -> usize {
    extension.written().iter().filter_map(|it| Expression::parse(&it.text).ok()).map(|it| it.roots()).sum()
}

/// What the model and its variables are called in formulas, in the order of their slots.
fn scope(base: &Model, extension: &Extension) -> Result<Scope, Vec<ExtensionProblem>> {
    let mut problems = Vec::new();
    let known = all_units(base, extension);
    let units = Units::new(&names_of_units(&known)).unwrap_or_else(|found| {
        let number = |at: usize| known[at].1.unwrap_or_default();
        problems.extend(found.into_iter().map(|(at, message)| ExtensionProblem::Unit(number(at), message)));
        Units::default()
    });
    let measure = |name: &str, unit: Unit| measure_of(&units, base, name, unit);
    let mut names: Vec<ScopeName> = base.inputs.iter().map(|input| name_of_input(input, measure(&input.name, input.unit))).collect();
    names.extend(extension.inputs().iter().map(|input| {
        let measure = units.of_name(&input.name).unwrap_or(input.unit.into());
        ScopeName { role: NameRole::Variable, ..name_of_input(input, measure) }
    }));
    for variable in &extension.variables {
        let nominal = nominal_of(variable);
        let measure = match (nominal, extension.tolerance_of(variable)) {
            (None, None) => units.of_name(variable),
            (None, Some(it)) if it.effect == Effect::Times => Ok(QuantityUnit::NONE),
            (Some(of), _) | (None, Some(ModelTolerance { of, .. })) => {
                base.input(of).map_or_else(|| units.of_name(of), |input| Ok(measure(of, base.inputs[input].unit)))
            }
        };
        match measure {
            Ok(measure) => names.push(ScopeName::new(variable, NameRole::Variable, measure)),
            Err(message) => problems.push(ExtensionProblem::Variable(variable.clone(), message)),
        }
    }
    names.extend(base.outputs.iter().map(|output| {
        let name = ScopeName::new(&output.name, NameRole::Output, measure(&output.name, output.unit));
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

/// Units that the model has of its own, which formulas around it know too.
fn base_units(base: &Model) -> Vec<String> {
    base.origin.as_ref().map_or_else(Vec::new, |origin| [base_units(&origin.base), origin.extension.units.clone()].concat())
}

/// All units that formulas know besides the usual ones, each with its number among those that are added.
fn all_units(base: &Model, extension: &Extension) -> Vec<(String, Option<usize>)> {
    let of_base = base_units(base);
    // A study may repeat those of its model.
    let added = extension.units.iter().enumerate().filter(|(_, unit)| !of_base.contains(unit));
    let added: Vec<_> = added.map(|(at, unit)| (unit.clone(), Some(at))).collect();
    of_base.iter().map(|unit| (unit.clone(), None)).chain(added).collect()
}

fn names_of_units(units: &[(String, Option<usize>)]) -> Vec<String> {
    units.iter().map(|(name, _)| name.clone()).collect()
}

/// What a name of the model measures: where the model has units of its own, its name says it.
fn measure_of(units: &Units, base: &Model, name: &str, unit: Unit) -> QuantityUnit {
    let own = base.origin.as_ref().and_then(|_| units.of_name(name).ok());
    own.unwrap_or_else(|| unit.into())
}

fn name_of_input(input: &Input, measure: QuantityUnit) -> ScopeName {
    let name = ScopeName::new(&input.name, NameRole::Input, measure);
    let name = if input.integer { name.whole() } else { name };
    if input.words.is_empty() { name } else { name.words(input.words.clone(), input.is_enumeration()) }
}

fn checked(base: &Model, extension: &Extension) -> Result<Formulas, Vec<ExtensionProblem>> {
    let scope = scope(base, extension)?;
    Formulas::of(&scope, &extension.written()).map_err(|problems| problems.into_iter().map(ExtensionProblem::Formula).collect())
}

fn surroundings(base: &Arc<Model>, extension: &Extension, formulas: Formulas) -> Surroundings {
    let inputs = base.inputs.len();
    let given: Vec<usize> = formulas.order().iter().map(|&it| &formulas.all()[it]).filter(|it| it.gives_input).map(|it| it.slot).collect();
    let ends = given.iter().flat_map(|&slot| ends(&base.inputs[slot], slot)).map(|(end, _)| end).collect();
    let first_variable = inputs + extension.inputs().len();
    // What the design says of an input stands where the input stands.
    let designed = |slot: usize| {
        let nominal = nominal_name(&base.inputs[slot].name);
        Some(first_variable + extension.variables.iter().position(|it| *it == nominal)?)
    };
    let first_output = first_variable + extension.variables.len();
    let before: Vec<usize> = formulas.before_model().collect();
    let own_inputs: Vec<usize> =
        (0..inputs).filter_map(|slot| designed(slot).or_else(|| (!given.contains(&slot)).then_some(slot))).collect();
    let rest: Vec<usize> = (inputs..first_output).filter(|slot| !own_inputs.contains(slot)).collect();
    let mut around = Surroundings {
        inputs: own_inputs.into_iter().chain(rest).collect(),
        inputs_of_file: inputs..first_variable,
        first_output,
        after: formulas.after_model().collect(),
        shown: extension.shown(),
        ends,
        conditions: Vec::new(),
        first: FirstStage::none(&before),
        reads: ReadOutputs::default(),
        before,
        given,
        base: base.clone(),
        formulas,
    };
    around.conditions = condition_places(&around, extension);
    around.reads = ReadOutputs::of(&around);
    if around.is_alone() {
        let margins = extension.formulas.len()..around.formulas.all().len();
        let asked: Vec<usize> = around.shown.iter().copied().chain(margins).collect();
        let of_file = extension.inputs();
        let slot = |name: &str| {
            let of_input = of_file.iter().position(|input| input.name == name).map(|it| inputs + it);
            of_input.or_else(|| extension.variables.iter().position(|it| it == name).map(|it| first_variable + it))
        };
        let default_word = |name: &str| {
            let input = of_file.iter().find(|input| input.name == name)?;
            Some(input.word_for(input.default)?.to_owned())
        };
        let named = NamedInputs { slot: &slot, default_word: &default_word, count: around.inputs.len() };
        around.first = FirstStage::of(&around.formulas, &around.before, &named, &asked);
    }
    around
}

/// The conditions in their order: what stands before the model, the model's, those of a file, what is left. One of a file comes behind
/// the requirements of the formulas that it depends on.
fn condition_places(around: &Surroundings, extension: &Extension) -> Vec<ConditionPlace> {
    let all = around.formulas.all();
    let needs = |of: &dyn Fn(usize) -> bool| {
        let needs = around.formulas.requirements().iter().enumerate();
        needs.filter(|(_, need)| of(need.formula)).map(|(need, _)| ConditionPlace::Need(need)).collect::<Vec<_>>()
    };
    // Of formulas alone none stands before a model.
    let mut places = if around.is_alone() { Vec::new() } else { needs(&|formula| !all[formula].reads_outputs) };
    places.extend((0..around.ends.len()).map(ConditionPlace::End));
    places.extend((0..around.base.conditions.len()).map(ConditionPlace::Base));
    for margin in extension.formulas.len()..all.len() {
        let ancestors = around.formulas.ancestors(margin);
        let new: Vec<_> = needs(&|formula| ancestors.contains(&formula)).into_iter().filter(|it| !places.contains(it)).collect();
        places.extend(new);
        places.push(ConditionPlace::Margin(margin));
    }
    let left: Vec<_> = needs(&|_| true).into_iter().filter(|it| !places.contains(it)).collect();
    let may_be_absent = around.shown.iter().copied().filter(|&formula| !all[formula].absent_with.is_empty());
    places.into_iter().chain(left).chain(may_be_absent.map(ConditionPlace::Absent)).collect()
}

/// The ends that a computed input must keep, with whether the end itself is out of range.
fn ends(input: &Input, slot: usize) -> Vec<(surroundings::RangeEnd, bool)> {
    let Range { low, high, includes_low, includes_high } = input.valid;
    let lower = low.is_finite().then(|| (surroundings::RangeEnd::new(slot, input.unit.to_si(low), false), !includes_low));
    let upper = high.is_finite().then(|| (surroundings::RangeEnd::new(slot, input.unit.to_si(high), true), !includes_high));
    lower.into_iter().chain(upper).collect()
}

/// The unit that the end of a name says.
///
/// # Errors
/// A sentence if it cannot be a unit.
pub fn unit_of_name(units: &Units, name: &str) -> Result<Unit, String> {
    Ok(unit_of_measure(units, name, units.of_name(name)?))
}

fn unit_of_measure(units: &Units, name: &str, measure: QuantityUnit) -> Unit {
    let symbol = units.symbol_of_name(name).unwrap_or_default().replace('2', "²").replace('3', "³");
    Unit::of_formulas(interned(&symbol), measure.factors())
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
                if let ConditionPlace::Base(own) = self.conditions[usize::from(condition)] {
                    Status::failed(own)
                } else {
                    Status::Ok
                }
            }
            other => other,
        };
        Evaluation { status, outputs: evaluation.outputs[..self.base_outputs()].to_vec() }
    }
}
