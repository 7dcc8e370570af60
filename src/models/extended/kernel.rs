//! The formula of an extended model.

use super::columns::{ExtendedColumns, Lists};
use super::first::PassedNumber;
use super::surroundings::{ConditionPlace, Surroundings};
use crate::interned::{interned, interned_list};
use crate::models::description::Effort;
use crate::models::formula::{Columns, Dependencies, Footprint, Kernel, Scratch, Sizes};
use crate::real::Real;
use crate::tape::{Fields, Known, List, Operation, Recordable, Set, Trace};
use std::sync::OnceLock;

/// A model's formula with a study's formulas around it.
pub struct Extended {
    around: Surroundings,
    /// Of the formula that is recorded, where the model's can be.
    fields: Option<Fields>,
    lists: OnceLock<Lists>,
}

impl Extended {
    /// Formulas around a model, and the names in its formula if that can be recorded.
    pub fn new(around: Surroundings, of_base: Option<Fields>) -> Self {
        let base = around.base.inputs.len();
        let fields = of_base.map(|fields| {
            // What stands before these keeps them apart from the words of a shader.
            let files = around.inputs_of_file.clone();
            let variable = |slot: usize| match files.clone().position(|it| it == slot) {
                Some(input) => interned(&format!("of_file_{input}")),
                None => interned(&format!("given_{slot}")),
            };
            let inputs: Vec<_> = around.inputs.iter().map(|&slot| if slot < base { fields.inputs[slot] } else { variable(slot) }).collect();
            let formulas = around.formulas.all();
            let own = around.shown.iter().map(|&formula| interned(&format!("own_{}", formulas[formula].name)));
            let passed = around.first.passed.iter().map(|&passed| match passed {
                PassedNumber::Slot(slot) => interned(&format!("kept_{slot}")),
                PassedNumber::Need(need) => interned(&format!("need_{need}")),
            });
            let prepared: Vec<_> = fields.prepared.iter().copied().chain(passed).collect();
            let outputs: Vec<_> = fields.outputs[..around.base_outputs()].iter().copied().chain(own).collect();
            let [inputs, prepared, outputs] = [inputs, prepared, outputs].map(|names| interned_list(&names));
            Fields { inputs, prepared, outputs, conditions: around.conditions.len(), ..fields }
        });
        Self { around, fields, lists: OnceLock::new() }
    }

    /// The second stage and the conditions, over any number type: outputs and margins, given how the model computes its own.
    fn results<R: Real>(&self, inputs: &[R], wanted: WantedResults, passed: &[R], base: &impl Base<R>) -> (Vec<R>, Vec<R>) {
        let around = &self.around;
        let Sizes { outputs, conditions, .. } = around.base.kernel.sizes();
        let [mut outputs, mut margins] = [outputs, conditions].map(|length| vec![R::constant(1.0); length]);
        let mut numbers = around.before_second(inputs, passed);
        let base_inputs = numbers.slots[..around.base.inputs.len()].to_vec();
        let own = if wanted.margins { around.reads.by_conditions } else { Set::EMPTY };
        let of_base = around.wanted_of_base(wanted.outputs) | own;
        if !of_base.is_empty() {
            base.finish(&base_inputs, of_base, &mut outputs);
        }
        if wanted.margins || around.reads.asks_for_presence {
            base.conditions(&base_inputs, &mut margins);
        }
        around.after(&mut numbers, &outputs, &margins);
        outputs.truncate(around.base_outputs());
        outputs.extend(around.own_outputs(&numbers));
        let all = around.margins(&numbers, &margins).collect();
        (outputs, all)
    }

    fn lists(&self) -> &Lists {
        self.lists.get_or_init(|| Lists::new(&self.around))
    }

    /// Outputs and margins in f64: of formulas alone from the list, which is quicker.
    fn results_in_f64(&self, prepared: &[f64], inputs: &[f64], wanted: WantedResults) -> (Vec<f64>, Vec<f64>) {
        let passed = self.around.passed_of(prepared);
        if self.around.is_alone() {
            let numbers = [inputs, passed].concat();
            let Lists { outputs, margins, .. } = self.lists();
            return if wanted.margins { (Vec::new(), margins.run(&numbers)) } else { (outputs.run(&numbers), Vec::new()) };
        }
        self.results(inputs, wanted, passed, &InF64 { kernel: &*self.around.base.kernel, prepared })
    }

    /// How long it takes, where it is formulas alone.
    pub fn effort(&self) -> Effort {
        let Lists { first, after, .. } = self.lists();
        let operations = |list: &List| list.operations.len() as f64;
        let roots = |list: &List| list.operations.iter().filter(|it| matches!(it, Operation::Root(_))).count() as f64;
        Effort {
            prepare: 1e-7 + 4e-9 * operations(first) + 1e-6 * roots(first),
            finish: 1e-9 + 3e-10 * operations(after) + 1e-6 * roots(after),
        }
    }

    /// The inputs of the model.
    fn base_inputs<R: Real>(&self, inputs: &[R]) -> Vec<R> {
        let mut slots = self.around.before(inputs).slots;
        slots.truncate(self.around.base.inputs.len());
        slots
    }

    /// What the first stage of the model is asked for.
    fn prepared_for(&self, wanted: Set) -> Set {
        self.around.wanted_of_base(wanted) | self.around.reads.by_conditions
    }

    /// A set of inputs of the model as one of the extended model.
    fn sources(&self, inputs: Set) -> Set {
        if inputs == Set::ALL {
            return Set::ALL;
        }
        inputs.iter().fold(Set::EMPTY, |set, input| set | self.around.sources(input))
    }
}

/// What is asked of a second stage.
#[derive(Clone, Copy)]
struct WantedResults {
    outputs: Set,
    margins: bool,
}

/// The second stage of the model.
trait Base<R> {
    fn finish(&self, inputs: &[R], wanted: Set, outputs: &mut [R]);
    fn conditions(&self, inputs: &[R], margins: &mut [R]);
}

struct InF64<'a> {
    kernel: &'a dyn Kernel,
    prepared: &'a [f64],
}

impl Base<f64> for InF64<'_> {
    fn finish(&self, inputs: &[f64], wanted: Set, outputs: &mut [f64]) {
        self.kernel.finish(self.prepared, inputs, wanted, outputs);
    }

    fn conditions(&self, inputs: &[f64], margins: &mut [f64]) {
        self.kernel.conditions(self.prepared, inputs, margins);
    }
}

struct Traced<'a> {
    formula: &'a dyn Recordable,
    prepared: &'a [Trace],
}

impl Base<Trace> for Traced<'_> {
    fn finish(&self, inputs: &[Trace], wanted: Set, outputs: &mut [Trace]) {
        self.formula.trace_finish(self.prepared, inputs, wanted, outputs);
    }

    fn conditions(&self, inputs: &[Trace], margins: &mut [Trace]) {
        self.formula.trace_conditions(self.prepared, inputs, Set::ALL, margins);
    }
}

impl Kernel for Extended {
    fn sizes(&self) -> Sizes {
        let around = &self.around;
        Sizes {
            inputs: around.inputs.len(),
            prepared: around.base.kernel.prepared_len() + around.first.passed.len(),
            outputs: around.base_outputs() + around.shown.len(),
            conditions: around.conditions.len(),
        }
    }

    fn prepare(&self, inputs: &[f64], wanted: Set, prepared: &mut [f64]) {
        if !self.around.first.passed.is_empty() {
            let passed = self.lists().first.run(inputs);
            prepared[self.around.base.kernel.prepared_len()..][..passed.len()].copy_from_slice(&passed);
        }
        if !self.around.is_alone() {
            self.around.base.kernel.prepare(&self.base_inputs(inputs), self.prepared_for(wanted), prepared);
        }
    }

    fn prepared_used(&self, prepared: &[f64]) -> usize {
        if self.around.is_alone() {
            return prepared.len();
        }
        self.around.base.kernel.prepared_used(prepared)
    }

    fn prepared_reads(&self, inputs: &[f64]) -> Set {
        if self.around.is_alone() {
            return Set::ALL;
        }
        self.sources(self.around.base.kernel.prepared_reads(&self.base_inputs(inputs)))
    }

    fn conditions(&self, prepared: &[f64], inputs: &[f64], margins: &mut [f64]) {
        let found = self.results_in_f64(prepared, inputs, WantedResults { outputs: Set::EMPTY, margins: true }).1;
        margins[..found.len()].copy_from_slice(&found);
    }

    fn finish(&self, prepared: &[f64], inputs: &[f64], wanted: Set, outputs: &mut [f64]) {
        let found = self.results_in_f64(prepared, inputs, WantedResults { outputs: wanted, margins: false }).0;
        outputs[..found.len()].copy_from_slice(&found);
    }

    fn finish_with_conditions(&self, prepared: &[f64], inputs: &[f64], wanted: Set, outputs: &mut [f64], margins: &mut [f64]) {
        if self.around.is_alone() {
            self.finish(prepared, inputs, wanted, outputs);
            return self.conditions(prepared, inputs, margins);
        }
        let (found, of_conditions) = self.results_in_f64(prepared, inputs, WantedResults { outputs: wanted, margins: true });
        outputs[..found.len()].copy_from_slice(&found);
        margins[..of_conditions.len()].copy_from_slice(&of_conditions);
    }

    fn finish_columns(&self, prepared: &[f64], inputs: &[f64], columns: &Columns<'_>, scratch: &mut Scratch, results: &mut [Vec<f64>]) {
        let lists = self.lists();
        let own = scratch.own.get_or_insert_with(|| Box::new(ExtendedColumns::new(&self.around, lists)));
        let own = own.downcast_mut::<ExtendedColumns>().expect("scratch serves one model");
        own.run(&self.around, lists, prepared, inputs, columns, results);
    }

    fn dependencies(&self, inputs: &[Known]) -> Dependencies {
        if self.formula().is_some() {
            return Dependencies::of(self, inputs);
        }
        // What is known of inputs that formulas give is not followed up.
        let around = &self.around;
        let position = |slot: usize| around.inputs.iter().position(|it| *it == slot);
        let known: Vec<Known> =
            (0..around.base.inputs.len()).map(|slot| position(slot).map_or(Known::ANY, |input| inputs[input])).collect();
        let of_base = around.base.kernel.dependencies(&known);
        let with_prepared = |set: Set| self.sources(set);
        let outputs: Vec<Set> = of_base.outputs[..around.base_outputs()].iter().map(|&set| with_prepared(set)).collect();
        let of_formula = |formula: usize| {
            let slots = around.formulas.all()[formula].depends_on.iter();
            slots.fold(Set::EMPTY, |set, &slot| match slot.checked_sub(around.first_output) {
                Some(output) if output < outputs.len() => set | outputs[output],
                _ => position(slot).map_or(set, |input| set | Set::one(input)),
            })
        };
        let conditions = around.conditions.iter().map(|&condition| match condition {
            ConditionPlace::End(end) => around.sources(around.ends[end].slot()),
            ConditionPlace::Base(number) => with_prepared(of_base.conditions[number]),
            _ => around.formula_of(condition).map_or(Set::EMPTY, of_formula),
        });
        let conditions = conditions.collect();
        let own = around.shown.iter().map(|&formula| of_formula(formula)).collect();
        Dependencies { prepared: self.sources(of_base.prepared), outputs: [outputs.clone(), own].concat(), conditions }
    }

    fn formula(&self) -> Option<&dyn Recordable> {
        self.around.base.kernel.formula().map(|_| self as &dyn Recordable)
    }

    fn footprint(&self, inputs: &[f64]) -> Footprint {
        let of_base = self.around.base.kernel.footprint(&self.base_inputs(inputs));
        Footprint { prepared: of_base.prepared + 8 * self.around.first.passed.len() as u64, ..of_base }
    }
}

impl Extended {
    fn recordable(&self) -> &dyn Recordable {
        self.around.base.kernel.formula().expect("only what can be recorded is")
    }
}

impl Recordable for Extended {
    fn fields(&self) -> Fields {
        self.fields.expect("only what can be recorded is")
    }

    fn trace_prepare(&self, inputs: &[Trace], wanted: Set, prepared: &mut [Trace]) {
        let own = self.around.base.kernel.prepared_len();
        if !self.around.first.passed.is_empty() {
            let numbers = self.around.before(inputs);
            prepared[own..].iter_mut().zip(self.around.passed(&numbers)).for_each(|(to, value)| *to = value);
        }
        self.recordable().trace_prepare(&self.base_inputs(inputs), self.prepared_for(wanted), prepared);
    }

    fn trace_conditions(&self, prepared: &[Trace], inputs: &[Trace], _wanted: Set, margins: &mut [Trace]) {
        let base = Traced { formula: self.recordable(), prepared };
        let passed = self.around.passed_of(prepared);
        let found = self.results(inputs, WantedResults { outputs: Set::EMPTY, margins: true }, passed, &base).1;
        margins[..found.len()].copy_from_slice(&found);
    }

    fn trace_finish(&self, prepared: &[Trace], inputs: &[Trace], wanted: Set, outputs: &mut [Trace]) {
        let base = Traced { formula: self.recordable(), prepared };
        let passed = self.around.passed_of(prepared);
        let found = self.results(inputs, WantedResults { outputs: wanted, margins: false }, passed, &base).0;
        outputs[..found.len()].copy_from_slice(&found);
    }
}
