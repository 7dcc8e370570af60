//! Where formulas and model find each other's numbers.

use crate::formula::Formulas;
use crate::models::description::Condition;
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

/// Formulas around a model, and the numbers of everything.
///
/// Slots of the formulas are the model's inputs, then variables, then the model's outputs, then what formulas give besides. Inputs of
/// the extended model are the model's that no formula gives, then variables. Outputs are the model's, then one per formula. Conditions
/// are those of formulas before the model, valid ranges of inputs that formulas give, the model's, those of formulas after it, and one
/// per formula that may have no value.
#[derive(Clone, Debug)]
pub struct Surroundings {
    pub base: Arc<Model>,
    pub formulas: Formulas,
    /// Of each input: its slot.
    pub inputs: Vec<usize>,
    /// Inputs of the model that formulas give.
    pub given: Vec<usize>,
    /// Slot of the model's first output.
    pub first_output: usize,
    /// Formulas before the model, and after it, in the order in which they are evaluated.
    pub before: Vec<usize>,
    pub after: Vec<usize>,
    /// SlotNumbers of the requirements of either.
    pub needs_before: Vec<usize>,
    pub needs_after: Vec<usize>,
    pub ends: Vec<RangeEnd>,
    /// Formulas that may have no value.
    pub maybe_absent: Vec<usize>,
}

/// The numbers of one design.
pub struct SlotNumbers<R> {
    pub slots: Vec<R>,
    present: Vec<Option<R>>,
    needs: Vec<R>,
}

impl Surroundings {
    /// How many outputs of the model are listed.
    pub fn base_outputs(&self) -> usize {
        self.base.outputs.len()
    }

    /// How many conditions stand before the model's.
    pub fn first_condition(&self) -> usize {
        self.needs_before.len() + self.ends.len()
    }

    /// How many conditions there are.
    pub fn conditions(&self) -> usize {
        self.first_condition() + self.base.conditions.len() + self.needs_after.len() + self.maybe_absent.len()
    }

    /// Slots that a formula depends on, through others too.
    fn depends_on(&self, formula: usize) -> &[usize] {
        &self.formulas.all()[formula].depends_on
    }

    /// The model's outputs that a formula needs.
    fn outputs_of(&self, formula: usize) -> Set {
        let last = self.first_output + self.base_outputs();
        self.depends_on(formula)
            .iter()
            .filter(|&&slot| (self.first_output..last).contains(&slot))
            .map(|slot| slot - self.first_output)
            .collect()
    }

    /// The model's outputs that these outputs need.
    pub fn wanted_of_base(&self, wanted: Set) -> Set {
        let base = self.base_outputs();
        let own = (0..self.formulas.all().len()).filter(|formula| wanted.contains(base + formula)).map(|formula| self.outputs_of(formula));
        own.fold(wanted & Set::between(0, base), |set, it| set | it)
    }

    /// The model's outputs that conditions of formulas need.
    pub fn wanted_by_conditions(&self) -> Set {
        let needing = self.needs_after.iter().map(|&need| self.formulas.requirements()[need].formula);
        needing.chain(self.maybe_absent.iter().copied()).fold(Set::EMPTY, |set, formula| set | self.outputs_of(formula))
    }

    /// Do formulas ask whether outputs of the model have a value?
    pub fn asks_for_presence(&self) -> bool {
        self.formulas.all().iter().any(|formula| !formula.absent_with.is_empty())
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
        let one = R::constant(1.0);
        let mut numbers = SlotNumbers {
            slots: vec![one; self.formulas.slots()],
            present: vec![None; self.formulas.slots()],
            needs: vec![one; self.formulas.requirements().len()],
        };
        self.inputs.iter().zip(inputs).for_each(|(&slot, &value)| numbers.slots[slot] = value);
        for &formula in &self.before {
            self.formulas.evaluate(formula, &mut numbers.slots, &mut numbers.present, &mut numbers.needs);
        }
        numbers
    }

    /// All numbers, given the outputs of the model, and the margins of its conditions if [`Surroundings::asks_for_presence`].
    pub fn after<R: Real>(&self, numbers: &mut SlotNumbers<R>, outputs: &[R], margins: &[R]) {
        for (number, (output, &value)) in self.base.outputs.iter().zip(outputs).enumerate() {
            numbers.slots[self.first_output + number] = value;
            numbers.present[self.first_output + number] = present(&self.base.conditions, &output.name, margins);
        }
        for &formula in &self.after {
            self.formulas.evaluate(formula, &mut numbers.slots, &mut numbers.present, &mut numbers.needs);
        }
    }

    /// What formulas give, in their order.
    pub fn own_outputs<'n, R: Real>(&'n self, numbers: &'n SlotNumbers<R>) -> impl Iterator<Item = R> + 'n {
        self.formulas.all().iter().map(|formula| numbers.slots[formula.slot])
    }

    /// Margins of the conditions that stand before the model's.
    pub fn margins_before<'n, R: Real>(&'n self, numbers: &'n SlotNumbers<R>) -> impl Iterator<Item = R> + 'n {
        let needs = self.needs_before.iter().map(|&need| numbers.needs[need]);
        needs.chain(self.ends.iter().map(|end| end.margin(&numbers.slots)))
    }

    /// Margins of the conditions that stand after the model's.
    pub fn margins_after<'n, R: Real>(&'n self, numbers: &'n SlotNumbers<R>) -> impl Iterator<Item = R> + 'n {
        let needs = self.needs_after.iter().map(|&need| numbers.needs[need]);
        let present = |&formula: &usize| numbers.present[self.formulas.all()[formula].slot].unwrap_or(R::constant(1.0));
        needs.chain(self.maybe_absent.iter().map(present))
    }
}

/// At least zero where no condition takes an output away; `None` if none can.
fn present<R: Real>(conditions: &[Condition], output: &str, margins: &[R]) -> Option<R> {
    let taking = conditions.iter().zip(margins).filter(|(condition, _)| condition.invalidates.iter().any(|it| it == output));
    let kept = taking.map(|(condition, &margin)| {
        let [one, less] = [1.0, -1.0].map(R::constant);
        if condition.strict { R::select(-margin, less, one) } else { margin }
    });
    kept.reduce(R::min)
}
