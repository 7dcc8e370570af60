//! The formula of an extended model.

use super::columns::{ExtendedColumns, Lists};
use super::interned::{interned, interned_list};
use super::surroundings::Surroundings;
use crate::models::formula::{Columns, Dependencies, Footprint, Kernel, Scratch, Sizes};
use crate::real::Real;
use crate::tape::{Fields, Known, Recordable, Set, Trace};
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
            let variable = |slot: usize| interned(&format!("given_{slot}"));
            let inputs: Vec<_> = around.inputs.iter().map(|&slot| if slot < base { fields.inputs[slot] } else { variable(slot) }).collect();
            let own = around.formulas.all().iter().map(|formula| interned(&format!("own_{}", formula.name)));
            let outputs: Vec<_> = fields.outputs[..around.base_outputs()].iter().copied().chain(own).collect();
            let [inputs, outputs] = [inputs, outputs].map(|names| interned_list(&names));
            Fields { inputs, outputs, conditions: around.conditions(), ..fields }
        });
        Self { around, fields, lists: OnceLock::new() }
    }

    /// The second stage and the conditions, over any number type: outputs and margins, given how the model computes its own.
    fn results<R: Real>(&self, inputs: &[R], wanted: WantedResults, base: &impl Base<R>) -> (Vec<R>, Vec<R>) {
        let around = &self.around;
        let Sizes { outputs, conditions, .. } = around.base.kernel.sizes();
        let [mut outputs, mut margins] = [outputs, conditions].map(|length| vec![R::constant(1.0); length]);
        let mut numbers = around.before(inputs);
        let base_inputs = numbers.slots[..around.base.inputs.len()].to_vec();
        let own = if wanted.margins { around.wanted_by_conditions() } else { Set::EMPTY };
        let of_base = around.wanted_of_base(wanted.outputs) | own;
        if !of_base.is_empty() {
            base.finish(&base_inputs, of_base, &mut outputs);
        }
        if wanted.margins || around.asks_for_presence() {
            base.conditions(&base_inputs, &mut margins);
        }
        around.after(&mut numbers, &outputs, &margins);
        outputs.truncate(around.base_outputs());
        outputs.extend(around.own_outputs(&numbers));
        let mut all: Vec<R> = around.margins_before(&numbers).collect();
        all.extend(&margins[..around.base.conditions.len()]);
        all.extend(around.margins_after(&numbers));
        (outputs, all)
    }

    /// The inputs of the model.
    fn base_inputs<R: Real>(&self, inputs: &[R]) -> Vec<R> {
        let mut slots = self.around.before(inputs).slots;
        slots.truncate(self.around.base.inputs.len());
        slots
    }

    /// What the first stage of the model is asked for.
    fn prepared_for(&self, wanted: Set) -> Set {
        self.around.wanted_of_base(wanted) | self.around.wanted_by_conditions()
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
            prepared: around.base.kernel.prepared_len(),
            outputs: around.base_outputs() + around.formulas.all().len(),
            conditions: around.conditions(),
        }
    }

    fn prepare(&self, inputs: &[f64], wanted: Set, prepared: &mut [f64]) {
        self.around.base.kernel.prepare(&self.base_inputs(inputs), self.prepared_for(wanted), prepared);
    }

    fn prepared_used(&self, prepared: &[f64]) -> usize {
        self.around.base.kernel.prepared_used(prepared)
    }

    fn prepared_reads(&self, inputs: &[f64]) -> Set {
        self.sources(self.around.base.kernel.prepared_reads(&self.base_inputs(inputs)))
    }

    fn conditions(&self, prepared: &[f64], inputs: &[f64], margins: &mut [f64]) {
        let base = InF64 { kernel: &*self.around.base.kernel, prepared };
        let found = self.results(inputs, WantedResults { outputs: Set::EMPTY, margins: true }, &base).1;
        margins[..found.len()].copy_from_slice(&found);
    }

    fn finish(&self, prepared: &[f64], inputs: &[f64], wanted: Set, outputs: &mut [f64]) {
        let base = InF64 { kernel: &*self.around.base.kernel, prepared };
        let found = self.results(inputs, WantedResults { outputs: wanted, margins: false }, &base).0;
        outputs[..found.len()].copy_from_slice(&found);
    }

    fn finish_columns(&self, prepared: &[f64], inputs: &[f64], columns: &Columns<'_>, scratch: &mut Scratch, results: &mut [Vec<f64>]) {
        let lists = self.lists.get_or_init(|| Lists::new(&self.around));
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
        let needs =
            |needs: &[usize]| needs.iter().map(|&need| of_formula(around.formulas.requirements()[need].formula)).collect::<Vec<_>>();
        let conditions = [
            needs(&around.needs_before),
            around.ends.iter().map(|end| around.sources(end.slot())).collect(),
            of_base.conditions[..around.base.conditions.len()].iter().map(|&set| with_prepared(set)).collect(),
            needs(&around.needs_after),
            around.maybe_absent.iter().map(|&formula| of_formula(formula)).collect(),
        ]
        .concat();
        let own = (0..around.formulas.all().len()).map(of_formula).collect();
        Dependencies { prepared: self.sources(of_base.prepared), outputs: [outputs.clone(), own].concat(), conditions }
    }

    fn formula(&self) -> Option<&dyn Recordable> {
        self.around.base.kernel.formula().map(|_| self as &dyn Recordable)
    }

    fn footprint(&self, inputs: &[f64]) -> Footprint {
        self.around.base.kernel.footprint(&self.base_inputs(inputs))
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
        self.recordable().trace_prepare(&self.base_inputs(inputs), self.prepared_for(wanted), prepared);
    }

    fn trace_conditions(&self, prepared: &[Trace], inputs: &[Trace], _wanted: Set, margins: &mut [Trace]) {
        let base = Traced { formula: self.recordable(), prepared };
        let found = self.results(inputs, WantedResults { outputs: Set::EMPTY, margins: true }, &base).1;
        margins[..found.len()].copy_from_slice(&found);
    }

    fn trace_finish(&self, prepared: &[Trace], inputs: &[Trace], wanted: Set, outputs: &mut [Trace]) {
        let base = Traced { formula: self.recordable(), prepared };
        let found = self.results(inputs, WantedResults { outputs: wanted, margins: false }, &base).0;
        outputs[..found.len()].copy_from_slice(&found);
    }
}
