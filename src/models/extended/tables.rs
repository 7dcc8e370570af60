//! The tables of an extended model: its inputs, outputs, conditions and presets.

use super::super::description::{CONDITION_BOUND_FACTOR, Condition, Input, Output, Preset, Range, Worse};
use super::super::source::{ConditionSource, Extension};
use super::super::tolerance::ModelTolerance;
use super::surroundings::{ConditionPlace, Surroundings};
use super::{all_units, ends, names_of_units, unit_of_measure};
use crate::formula::{FormulaKind, QuantityUnit, Units, nominal_of};
use crate::probability::Effect;
use crate::units::{NONE, Unit};

/// What is said of a number that axes give to formulas.
const VARIABLE: &str = "A variable of the study.";

/// The tables of an extended model.
pub struct ExtendedTables {
    pub inputs: Vec<Input>,
    pub outputs: Vec<Output>,
    pub conditions: Vec<Condition>,
}

impl ExtendedTables {
    /// Of a model with these formulas around it.
    pub fn new(around: &Surroundings, extension: &Extension) -> Self {
        let base = &around.base;
        let units = Units::new(&names_of_units(&all_units(base, extension))).unwrap_or_default();
        let unit = |name: &str, measure: QuantityUnit| unit_of_measure(&units, name, measure);
        let inputs = around.inputs.iter().map(|&slot| match slot.checked_sub(base.inputs.len()) {
            None => base.inputs[slot].clone(),
            Some(input) if around.inputs_of_file.contains(&slot) => extension.inputs()[input].clone(),
            Some(beyond) => {
                let name = &extension.variables[beyond - around.inputs_of_file.len()];
                let variable = |name: &str, unit: Unit, default: f64, doc: &str| {
                    let all = Range::between(f64::NEG_INFINITY, f64::INFINITY);
                    Input::new(name, "", unit, default, (f64::MIN, f64::MAX), doc, "the study").valid(all)
                };
                let of_name = |name: &str| unit(name, units.of_name(name).unwrap_or(QuantityUnit::NONE));
                let of_base = |name: &str| base.input(name).map(|input| &base.inputs[input]);
                match (nominal_of(name), extension.tolerance_of(name)) {
                    (Some(of), _) => of_base(of).cloned().unwrap_or_else(|| variable(of, of_name(of), 0.0, VARIABLE)),
                    (None, Some(ModelTolerance { of, effect: Effect::Plus })) => {
                        let unit = of_base(of).map_or_else(|| of_name(of), |input| input.unit);
                        variable(name, unit, 0.0, "What is added to what the design says.")
                    }
                    (None, Some(_)) => variable(name, NONE, 1.0, "The factor on what the design says."),
                    (None, None) => variable(name, of_name(name), 0.0, VARIABLE),
                }
            }
        });
        let whose = if extension.file.is_some() { "model" } else { "study" };
        let said = |own: &String, otherwise: String| if own.is_empty() { otherwise } else { own.clone() };
        let own = around.shown.iter().map(|&number| {
            let (formula, of) = (&around.formulas.all()[number], &extension.formulas[number]);
            let (symbol, unit, doc) = if formula.gives_input {
                let input = &base.inputs[formula.slot];
                (input.symbol.clone(), input.unit, format!("{} Given by a formula of the {whose}.", input.doc))
            } else {
                (String::new(), unit(&formula.name, formula.measure), format!("A formula of the {whose}."))
            };
            let (symbol, source, doc) = (said(&of.symbol, symbol), said(&of.source, formula.text.clone()), said(&of.doc, doc));
            let output = Output::new(extension.output_name(&formula.name), symbol, unit, of.worst.unwrap_or(Worse::Higher), source, doc);
            if formula.whole && !formula.gives_input { output.whole() } else { output }
        });
        let outputs: Vec<Output> = base.outputs.iter().cloned().chain(own.map(|it| it.with_bound_factor(CONDITION_BOUND_FACTOR))).collect();
        Self { inputs: inputs.collect(), conditions: conditions(around, extension, &outputs[base.outputs.len()..]), outputs }
    }
}

/// The conditions of an extended model, in the order of its margins.
fn conditions(around: &Surroundings, extension: &Extension, own: &[Output]) -> Vec<Condition> {
    let base = &around.base;
    let everything: Vec<&str> = base.outputs.iter().chain(own).map(|it| it.name.as_str()).collect();
    let formulas = around.formulas.all();
    let need = |number: usize| {
        let requirement = &around.formulas.requirements()[number];
        let formula = &formulas[requirement.formula];
        let dependents = around.formulas.dependents(requirement.formula);
        let gives_input = dependents.iter().any(|&it| formulas[it].gives_input);
        let is_taken = |name: &&str| dependents.iter().any(|&it| extension.output_name(&formulas[it].name) == *name);
        let names: Vec<&str> = own.iter().map(|it| it.name.as_str()).filter(is_taken).collect();
        let taken = if gives_input { &everything[..] } else { &names[..] };
        let whose = if formula.kind == FormulaKind::Margin { String::new() } else { "formula ".to_owned() };
        Condition::new(requirement.status.clone(), requirement.strict, taken, format!("The {whose}{} has a value.", formula.name))
    };
    let ranges: Vec<(&Input, bool)> = around
        .given
        .iter()
        .flat_map(|&slot| ends(&base.inputs[slot], slot).into_iter().map(move |(_, strict)| (&base.inputs[slot], strict)))
        .collect();
    let condition = |&place: &ConditionPlace| match place {
        ConditionPlace::Need(number) => need(number),
        ConditionPlace::End(number) => {
            let (input, strict) = ranges[number];
            let doc = format!("{} is {}, as the model needs it.", input.name, input.valid.in_words());
            Condition::new(format!("input {} out of range", input.name), strict, &everything, doc)
        }
        ConditionPlace::Base(number) => base.conditions[number].clone(),
        ConditionPlace::Margin(formula) => {
            let ConditionSource { reason, margin, strict, quiet, invalidates, doc } =
                &extension.conditions()[formula - extension.formulas.len()];
            let taken: Vec<&str> = invalidates.iter().map(String::as_str).collect();
            let doc =
                if doc.is_empty() { format!("{margin} is {} 0.", if *strict { "greater than" } else { "at least" }) } else { doc.clone() };
            let condition = Condition::new(reason, *strict, &taken, doc);
            if *quiet { condition.quiet() } else { condition }
        }
        ConditionPlace::Absent(formula) => {
            let name = extension.output_name(&formulas[formula].name);
            let doc = format!("What {name} is computed from has a value.");
            Condition::new(format!("formula {name}: no value"), false, &[&name], doc).quiet()
        }
    };
    around.conditions.iter().map(condition).collect()
}

/// Presets of the model, without what formulas give, and of a file.
pub fn presets(around: &Surroundings, extension: &Extension) -> Vec<Preset> {
    let own = extension.file.as_ref().map_or(&[][..], |file| &file.presets);
    let base = &around.base;
    let is_given = |name: &String| base.input(name).is_some_and(|slot| around.given.contains(&slot)) && !extension.is_nominal_set(name);
    let without = |preset: &Preset| {
        let mut preset = preset.clone();
        preset.changes.retain(|(name, _)| !is_given(name));
        preset
    };
    base.presets.iter().map(without).chain(own.iter().cloned()).collect()
}
