//! Where formulas and model find each other's numbers.

use super::first::{FirstStage, PassedNumber};
use crate::formula::Formulas;
use crate::models::description::{Condition, Output};
use crate::models::model::Model;
use crate::real::Real;
use crate::tape::Set;
use std::sync::Arc;

/// The end of a valid range that an input given by a formula must keep.
#[derive(Clone, Copy, Debug)]
pub struct RangeEnd {
    /// Slot of the input.
    slot: usize,
    /// In SI units.
    end: f64,
    is_upper: bool,
}

impl RangeEnd {
    pub fn new(slot: usize, end: f64, is_upper: bool) -> Self {
        Self { slot, end, is_upper }
    }

    /// Slot of the input.
    pub fn slot(self) -> usize {
        self.slot
    }

    fn margin<R: Real>(self, slots: &[R]) -> R {
        let (value, end) = (slots[self.slot], R::constant(self.end));
        if self.is_upper { end - value } else { value - end }
    }
}

/// What a condition of the extended model is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConditionPlace {
    /// A requirement of a formula, by number.
    Need(usize),
    /// An end of the valid range of an input that a formula gives, by number.
    End(usize),
    /// A condition of the model, by number.
    Base(usize),
    /// A condition of a file: number of the formula of its margin.
    Margin(usize),
    /// Whether a formula has a value.
    Absent(usize),
}

/// Formulas around a model, and the numbers of everything.
///
/// Slots of the formulas are the model's inputs, then those of a file, then variables, then the model's outputs, then what formulas give
/// besides. Inputs of the extended model are the model's that no formula gives, then those of a file, then variables. Outputs are the
/// model's, then the formulas that are shown.
#[derive(Clone, Debug)]
pub struct Surroundings {
    pub base: Arc<Model>,
    pub formulas: Formulas,
    /// Of each input: its slot.
    pub inputs: Vec<usize>,
    /// Inputs of the model that formulas give.
    pub given: Vec<usize>,
    /// Slots of the inputs of a file.
    pub inputs_of_file: std::ops::Range<usize>,
    /// Slot of the model's first output.
    pub first_output: usize,
    /// Formulas before the model, and after it, in the order in which they are evaluated.
    pub before: Vec<usize>,
    pub after: Vec<usize>,
    /// Formulas that are outputs, in their order.
    pub shown: Vec<usize>,
    pub ends: Vec<RangeEnd>,
    /// Of each condition, in their order, what it is.
    pub conditions: Vec<ConditionPlace>,
    /// What is computed once for designs that have slow inputs in common.
    pub first: FirstStage,
    /// What is read of the model.
    pub reads: ReadOutputs,
}

/// The numbers of one design.
pub struct SlotNumbers<R> {
    pub slots: Vec<R>,
    present: Vec<Option<R>>,
    needs: Vec<R>,
}

impl Surroundings {
    /// Are there formulas alone, around a model that is nothing?
    pub fn is_alone(&self) -> bool {
        self.base.inputs.is_empty() && self.base.outputs.is_empty()
    }

    /// How many outputs of the model are listed.
    pub fn base_outputs(&self) -> usize {
        self.base.outputs.len()
    }

    /// The model's outputs that these outputs need.
    pub fn wanted_of_base(&self, wanted: Set) -> Set {
        let base = self.base_outputs();
        let own = self.reads.by_shown.iter().enumerate().filter(|(at, _)| wanted.contains(base + at)).map(|(_, &set)| set);
        own.fold(wanted & self.reads.all, |set, it| set | it)
    }

    /// The formula that a condition is about; `None` for those of the model and of ranges.
    pub fn formula_of(&self, condition: ConditionPlace) -> Option<usize> {
        match condition {
            ConditionPlace::Need(need) => Some(self.formulas.requirements()[need].formula),
            ConditionPlace::Margin(formula) | ConditionPlace::Absent(formula) => Some(formula),
            ConditionPlace::End(_) | ConditionPlace::Base(_) => None,
        }
    }

    /// The inputs of the extended model that an input of the model comes from.
    pub fn sources(&self, input: usize) -> Set {
        let position = |slot: &usize| self.inputs.iter().position(|it| it == slot);
        match self.formulas.all().iter().find(|formula| formula.gives_input && formula.slot == input) {
            Some(formula) => formula.depends_on.iter().filter_map(position).collect(),
            None => position(&input).into_iter().collect(),
        }
    }

    /// All numbers that are known before the model is evaluated; inputs of the model are the first slots.
    pub fn before<R: Real>(&self, inputs: &[R]) -> SlotNumbers<R> {
        self.evaluated(inputs, &self.before, |_| ())
    }

    /// The same where the first stage has passed on these numbers.
    pub fn before_second<R: Real>(&self, inputs: &[R], passed: &[R]) -> SlotNumbers<R> {
        self.evaluated(inputs, &self.first.left, |numbers| {
            for (&to, &value) in self.first.passed.iter().zip(passed) {
                match to {
                    PassedNumber::Slot(slot) => numbers.slots[slot] = value,
                    PassedNumber::Need(need) => numbers.needs[need] = value,
                }
            }
        })
    }

    /// What the first stage passed on, behind what the model's did.
    pub fn passed_of<'p, R>(&self, prepared: &'p [R]) -> &'p [R] {
        if self.first.passed.is_empty() { &[] } else { &prepared[self.base.kernel.prepared_len()..][..self.first.passed.len()] }
    }

    /// What the first stage passes on.
    pub fn passed<'n, R: Real>(&'n self, numbers: &'n SlotNumbers<R>) -> impl Iterator<Item = R> + 'n {
        self.first.passed.iter().map(|&from| match from {
            PassedNumber::Slot(slot) => numbers.slots[slot],
            PassedNumber::Need(need) => numbers.needs[need],
        })
    }

    fn evaluated<R: Real>(&self, inputs: &[R], formulas: &[usize], known: impl FnOnce(&mut SlotNumbers<R>)) -> SlotNumbers<R> {
        let one = R::constant(1.0);
        let mut numbers = SlotNumbers {
            slots: vec![one; self.formulas.slots()],
            present: vec![None; self.formulas.slots()],
            needs: vec![one; self.formulas.requirements().len()],
        };
        self.inputs.iter().zip(inputs).for_each(|(&slot, &value)| numbers.slots[slot] = value);
        known(&mut numbers);
        for &formula in formulas {
            self.formulas.evaluate(formula, &mut numbers.slots, &mut numbers.present, &mut numbers.needs);
        }
        numbers
    }

    /// All numbers, given the outputs of the model, and the margins of its conditions if [`ReadOutputs::asks_for_presence`].
    pub fn after<R: Real>(&self, numbers: &mut SlotNumbers<R>, outputs: &[R], margins: &[R]) {
        for (number, (taking, &value)) in self.reads.taking.iter().zip(outputs).enumerate() {
            numbers.slots[self.first_output + number] = value;
            numbers.present[self.first_output + number] = present(&self.base.conditions, taking, margins);
        }
        for &formula in &self.after {
            self.formulas.evaluate(formula, &mut numbers.slots, &mut numbers.present, &mut numbers.needs);
        }
    }

    /// What formulas give that are outputs, in their order.
    pub fn own_outputs<'n, R: Real>(&'n self, numbers: &'n SlotNumbers<R>) -> impl Iterator<Item = R> + 'n {
        self.shown.iter().map(|&formula| numbers.slots[self.formulas.all()[formula].slot])
    }

    /// Margins of all conditions, given those of the model.
    pub fn margins<'n, R: Real>(&'n self, numbers: &'n SlotNumbers<R>, of_base: &'n [R]) -> impl Iterator<Item = R> + 'n {
        let one = R::constant(1.0);
        let slot = |formula: usize| self.formulas.all()[formula].slot;
        self.conditions.iter().map(move |&condition| match condition {
            ConditionPlace::Need(need) => numbers.needs[need],
            ConditionPlace::End(end) => self.ends[end].margin(&numbers.slots),
            ConditionPlace::Base(number) => of_base[number],
            // Of what has no value nothing is asked.
            ConditionPlace::Margin(formula) => {
                let margin = numbers.slots[slot(formula)];
                numbers.present[slot(formula)].map_or(margin, |present| R::select(present, margin, one))
            }
            ConditionPlace::Absent(formula) => numbers.present[slot(formula)].unwrap_or(one),
        })
    }
}

/// At least zero where none of these conditions takes an output away; `None` if none can.
fn present<R: Real>(conditions: &[Condition], taking: &[usize], margins: &[R]) -> Option<R> {
    let kept = taking.iter().map(|&number| {
        let margin = margins[number];
        if conditions[number].strict { R::select(-margin, R::constant(-1.0), R::constant(1.0)) } else { margin }
    });
    kept.reduce(R::min)
}

/// Which of the model's outputs are read, and by what: the names are looked up once, not for every design.
#[derive(Clone, Debug, Default)]
pub struct ReadOutputs {
    /// All outputs of the model.
    all: Set,
    /// Of each formula that is shown: the outputs that it needs.
    by_shown: Vec<Set>,
    /// Those that conditions of formulas need.
    pub by_conditions: Set,
    /// Of each output: the conditions of the model that take it away; none of those that no formula reads.
    taking: Vec<Vec<usize>>,
    /// Do formulas ask whether outputs of the model have a value?
    pub asks_for_presence: bool,
}

impl ReadOutputs {
    /// Looks it up; of `around` all the rest must be known.
    pub fn of(around: &Surroundings) -> Self {
        let all = around.formulas.all();
        let outputs = around.base_outputs();
        let read_by = |formula: usize| -> Set {
            all[formula].depends_on.iter().filter_map(|slot| slot.checked_sub(around.first_output)).filter(|&it| it < outputs).collect()
        };
        let conditions = &around.base.conditions;
        let read: Set = (0..all.len()).map(read_by).collect();
        let taking = |(output, it): (usize, &Output)| {
            let takes = |number: &usize| read.contains(output) && conditions[*number].invalidates.contains(&it.name);
            (0..conditions.len()).filter(takes).collect()
        };
        Self {
            all: (0..outputs).collect(),
            by_shown: around.shown.iter().map(|&formula| read_by(formula)).collect(),
            by_conditions: around.conditions.iter().filter_map(|&condition| around.formula_of(condition)).map(read_by).collect(),
            taking: around.base.outputs.iter().enumerate().map(taking).collect(),
            asks_for_presence: all.iter().any(|formula| !formula.absent_with.is_empty()),
        }
    }
}
