//! The two stages of a formula, and the same formula behind a table of functions for every number type.

use super::description::Output;
use crate::real::{LANES, Lanes, Real};
use crate::tape::{Fields, Known, List, Recordable, Set, Trace};
use std::any::Any;

/// A model's formula in two stages, over any [`Real`]. All values are in SI units.
///
/// `prepare` holds what is expensive (geometry, transcendental functions, solves) and should read as few inputs as the physics
/// allows: a sweep runs it once for every combination of the inputs that it reads. `finish` is the inner loop. What passes
/// between them is [`Fields::prepared_len`] numbers. All slices are as long as [`Formula::FIELDS`] says, or longer; what is beyond
/// belongs to others.
pub trait Formula {
    /// Names of what the formula reads and writes, and how much of each there is.
    const FIELDS: Fields;
    /// First stage: what depends on the slow inputs only, as far as the outputs in `wanted` need it.
    fn prepare<R: Real>(inputs: &[R], wanted: Set, prepared: &mut [R]);
    /// Writes the signed margins of the model's conditions, in the order of its table; those that are not `wanted` may be left out.
    fn conditions<R: Real>(prepared: &[R::Shared], inputs: &[R], wanted: Set, margins: &mut [R]);
    /// Second stage: writes the outputs that are `wanted` (and may write others).
    fn finish<R: Real>(prepared: &[R::Shared], inputs: &[R], wanted: Set, outputs: &mut [R]);
    /// A shorter way to the same bits for a block of designs that have more in common than what is prepared: writes the columns asked
    /// for as [`Kernel::finish_columns`] does, in SI units, and returns true; false if this block is none of that kind.
    #[inline(always)]
    fn finish_block(_prepared: &[f64], _inputs: &[Lanes], _columns: &Columns<'_>, _results: &mut [Vec<f64>]) -> bool {
        false
    }
}

/// Which inputs each part of a formula depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct Dependencies {
    /// What the first stage reads and passes on.
    pub prepared: Set,
    /// Each output.
    pub outputs: Vec<Set>,
    /// Each condition.
    pub conditions: Vec<Set>,
}

/// Many designs that share their slow inputs, evaluated together: what varies, what is asked, and where it goes.
pub struct Columns<'a> {
    /// Number of designs, at most the length of every column rounded down to a multiple of [`LANES`] after rounding up `count`.
    pub count: usize,
    /// Inputs that differ between the designs, by number, in SI units.
    pub varying: &'a [(usize, Vec<f64>)],
    /// Outputs asked for, by number.
    pub outputs: &'a [usize],
    /// Conditions asked for, by number.
    pub conditions: &'a [usize],
}

impl Columns<'_> {
    /// Turns the outputs among the results from SI into their units.
    pub fn to_units(&self, outputs: &[Output], results: &mut [Vec<f64>]) {
        for (&output, result) in self.outputs.iter().zip(results) {
            let unit = outputs[output].unit;
            if !unit.is_si() {
                result[..self.count].iter_mut().for_each(|value| *value = unit.from_si(*value));
            }
        }
    }
}

/// Room for the inner loop, kept between calls: filling it anew would cost as much as a short block.
#[derive(Debug)]
pub struct Scratch {
    inputs: Vec<Lanes>,
    outputs: Vec<Lanes>,
    margins: Vec<Lanes>,
    /// Outputs with the least value that a design must have to be feasible, and whether that is itself too little. Of a design that surely
    /// has less a kernel may leave values unfinished, if it is infeasible with those too. Empty where the values of infeasible designs
    /// matter.
    pub(crate) least: Vec<(usize, f64, bool)>,
    /// What a kernel keeps that needs more than that.
    pub(crate) own: Option<Box<dyn Any + Send>>,
}

impl Scratch {
    /// Room for designs of a model that lists so many inputs (it may list more than its formula reads) and has this formula.
    pub fn new(inputs: usize, kernel: &dyn Kernel) -> Self {
        let Sizes { outputs, conditions, .. } = kernel.sizes();
        let [inputs, outputs, margins] = [inputs, outputs, conditions].map(|length| vec![Lanes::splat(0.0); length]);
        Self { inputs, outputs, margins, least: Vec::new(), own: None }
    }

    /// The same where these outputs must have at least these values.
    pub(crate) fn asking_for(self, least: Vec<(usize, f64, bool)>) -> Self {
        Self { least, ..self }
    }
}

/// How many numbers a formula reads, passes on and writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// Inputs.
    pub inputs: usize,
    /// Numbers that the first stage passes on.
    pub prepared: usize,
    /// Outputs; there may be more than the model lists.
    pub outputs: usize,
    /// Conditions; there may be more than the model lists.
    pub conditions: usize,
}

/// A formula as a sweep in f64 needs it, behind one table of functions. Every [`Formula`] is one; a model that is no formula over
/// any number type, such as a solver of its own, implements it directly and cannot be recorded. Slices are as long as
/// [`Kernel::sizes`] says.
pub trait Kernel: Send + Sync {
    /// How many numbers it reads, passes on and writes.
    fn sizes(&self) -> Sizes;
    /// How many numbers the first stage passes on.
    fn prepared_len(&self) -> usize {
        self.sizes().prepared
    }
    /// First stage in f64, as far as the outputs in `wanted` need it.
    fn prepare(&self, inputs: &[f64], wanted: Set, prepared: &mut [f64]);
    /// How many of the numbers that the first stage passed on are in use, from the first.
    fn prepared_used(&self, prepared: &[f64]) -> usize {
        prepared.len()
    }
    /// Inputs that the first stage reads for a design with these inputs, where it takes so long that what it passed on is worth keeping
    /// for another design of which these are the same. [`Set::ALL`]: it is not worth keeping.
    fn prepared_reads(&self, _inputs: &[f64]) -> Set {
        Set::ALL
    }
    /// Margins of all conditions in f64.
    fn conditions(&self, prepared: &[f64], inputs: &[f64], margins: &mut [f64]);
    /// Second stage in f64.
    fn finish(&self, prepared: &[f64], inputs: &[f64], wanted: Set, outputs: &mut [f64]);
    /// Second stage and margins together, to the same bits; what they have in common may be computed once.
    fn finish_with_conditions(&self, prepared: &[f64], inputs: &[f64], wanted: Set, outputs: &mut [f64], margins: &mut [f64]) {
        self.finish(prepared, inputs, wanted, outputs);
        self.conditions(prepared, inputs, margins);
    }
    /// First stage in f64 with all that it can pass on.
    fn prepared(&self, inputs: &[f64]) -> Vec<f64> {
        let mut prepared = vec![0.0; self.prepared_len()];
        self.prepare(inputs, Set::ALL, &mut prepared);
        prepared
    }
    /// Margins of all conditions in f64, in room of their own.
    fn margins(&self, prepared: &[f64], inputs: &[f64]) -> Vec<f64> {
        let mut margins = vec![0.0; self.sizes().conditions];
        self.conditions(prepared, inputs, &mut margins);
        margins
    }
    /// Second stage in f64, in room of its own; outputs that are not `wanted` may be anything.
    fn outputs(&self, prepared: &[f64], inputs: &[f64], wanted: Set) -> Vec<f64> {
        let mut outputs = vec![0.0; self.sizes().outputs];
        self.finish(prepared, inputs, wanted, &mut outputs);
        outputs
    }
    /// Second stage for many designs at once: same bits as [`Kernel::finish`].
    ///
    /// `results` has one column per asked output (in SI units), then one per asked condition (the margin).
    fn finish_columns(&self, prepared: &[f64], inputs: &[f64], columns: &Columns<'_>, scratch: &mut Scratch, results: &mut [Vec<f64>]);
    /// What depends on what, given what is known of the inputs.
    fn dependencies(&self, inputs: &[Known]) -> Dependencies;
    /// The formula to be recorded; `None` if it is none over any number type.
    fn formula(&self) -> Option<&dyn Recordable> {
        None
    }
    /// Bytes that a thread needs for a design: an estimate before anything is solved.
    fn footprint(&self, _inputs: &[f64]) -> Footprint {
        Footprint { prepared: 8 * self.prepared_len() as u64, scratch: 0 }
    }
}

/// Bytes that a thread needs for a design.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Footprint {
    /// What the first stage passes on.
    pub prepared: u64,
    /// What it needs meanwhile.
    pub scratch: u64,
}

impl<F: Formula + Send + Sync> Recordable for F {
    fn fields(&self) -> Fields {
        F::FIELDS
    }

    fn trace_prepare(&self, inputs: &[Trace], wanted: Set, prepared: &mut [Trace]) {
        F::prepare(inputs, wanted, prepared);
    }

    fn trace_conditions(&self, prepared: &[Trace], inputs: &[Trace], wanted: Set, margins: &mut [Trace]) {
        F::conditions(prepared, inputs, wanted, margins);
    }

    fn trace_finish(&self, prepared: &[Trace], inputs: &[Trace], wanted: Set, outputs: &mut [Trace]) {
        F::finish(prepared, inputs, wanted, outputs);
    }
}

impl Dependencies {
    /// Of a formula that can be recorded.
    pub fn of(formula: &dyn Recordable, inputs: &[Known]) -> Self {
        let whole = formula.whole(inputs, Set::ALL, Set::ALL);
        let list = List::cut(
            &whole.recording,
            &whole.prepared.iter().chain(&whole.outputs).chain(&whole.conditions).copied().map(Some).collect::<Vec<_>>(),
        );
        let sets = list.dependencies(|input| Set::one(input.into()));
        let of: Vec<Set> = list.results.iter().flatten().map(|&node| sets[node as usize]).collect();
        let (prepared, rest) = of.split_at(whole.prepared.len());
        let (outputs, conditions) = rest.split_at(whole.outputs.len());
        Self { prepared: prepared.iter().copied().collect(), outputs: outputs.to_vec(), conditions: conditions.to_vec() }
    }
}

impl<F: Formula + Send + Sync> Kernel for F {
    fn sizes(&self) -> Sizes {
        let Fields { inputs, conditions, outputs, .. } = F::FIELDS;
        Sizes { inputs: inputs.len(), prepared: F::FIELDS.prepared_len(), outputs: outputs.len(), conditions }
    }

    fn prepare(&self, inputs: &[f64], wanted: Set, prepared: &mut [f64]) {
        F::prepare(inputs, wanted, prepared);
    }

    fn conditions(&self, prepared: &[f64], inputs: &[f64], margins: &mut [f64]) {
        F::conditions(prepared, inputs, Set::ALL, margins);
    }

    fn finish(&self, prepared: &[f64], inputs: &[f64], wanted: Set, outputs: &mut [f64]) {
        F::finish(prepared, inputs, wanted, outputs);
    }

    fn finish_columns(&self, prepared: &[f64], inputs: &[f64], columns: &Columns<'_>, scratch: &mut Scratch, results: &mut [Vec<f64>]) {
        for (lanes, &value) in scratch.inputs.iter_mut().zip(inputs) {
            *lanes = Lanes::splat(value);
        }
        finish_columns::<F>(prepared, columns, scratch, results);
    }

    fn dependencies(&self, inputs: &[Known]) -> Dependencies {
        Dependencies::of(self, inputs)
    }

    fn formula(&self) -> Option<&dyn Recordable> {
        Some(self)
    }
}

/// The inner loop: eight designs at a time, compiled once per instruction set and chosen when the program runs.
///
/// Only `+ - * / min max` and selections are vectorised, which round alike on every instruction set, and nothing contracts a
/// product and a sum, so the choice never changes a bit.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn finish_columns<F: Formula>(prepared: &[f64], columns: &Columns<'_>, scratch: &mut Scratch, results: &mut [Vec<f64>]) {
    let Scratch { inputs, outputs, margins, .. } = scratch;
    let wanted = Set::of(columns.outputs);
    let asked = Set::of(columns.conditions);
    if F::finish_block(prepared, inputs, columns, results) {
        return;
    }
    for first in (0..columns.count).step_by(LANES) {
        for (input, column) in columns.varying {
            inputs[*input].0.copy_from_slice(&column[first..first + LANES]);
        }
        if !columns.outputs.is_empty() {
            F::finish(prepared, inputs, wanted, outputs);
            for (&output, result) in columns.outputs.iter().zip(&mut *results) {
                result[first..first + LANES].copy_from_slice(&outputs[output].0);
            }
        }
        if !columns.conditions.is_empty() {
            F::conditions(prepared, inputs, asked, margins);
            for (&condition, result) in columns.conditions.iter().zip(&mut results[columns.outputs.len()..]) {
                result[first..first + LANES].copy_from_slice(&margins[condition].0);
            }
        }
    }
}

/// A struct of values of one type with named fields, read from and written to a slice in the order of its fields: the inputs of a
/// model, what its first stage passes on, its outputs.
///
/// ```
/// beltspace::record! {
///     /// What the band is given.
///     Inputs { pull, friction, wrap }
/// }
/// assert_eq!(Inputs::NAMES, ["pull", "friction", "wrap"]);
/// assert_eq!(Inputs::NUMBER.wrap, 2);
/// let i = Inputs::read(&[100.0, 0.3, 4.7]);
/// assert_eq!(i.friction, 0.3);
/// ```
///
/// `read` and `write` work on the numbers that a stage is given, `shared` reads what the first stage passed on
/// ([`Real::Shared`]). A visibility may stand before the name.
#[macro_export]
macro_rules! record {
    ($(#[$doc:meta])* $visible:vis $name:ident { $($field:ident),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        $visible struct $name<T> { $(pub $field: T),* }

        #[allow(dead_code, reason = "some records are only read, some only written")]
        impl $name<usize> {
            /// The name of every field.
            pub const NAMES: &'static [&'static str] = &[$(stringify!($field)),*];

            /// The position of every field.
            pub const NUMBER: Self = {
                let mut next = 0;
                $(let $field = next; next += 1;)*
                let _ = next;
                Self { $($field),* }
            };
        }

        #[allow(dead_code, reason = "some records are only read, some only written")]
        impl<T: Copy> $name<T> {
            /// Reads the first numbers of a slice.
            #[inline(always)]
            pub fn read(values: &[T]) -> Self {
                // Checked once: no field is checked again.
                let values = &values[..$name::<usize>::NAMES.len()];
                Self { $($field: values[$name::<usize>::NUMBER.$field]),* }
            }

            /// Writes the first numbers of a slice.
            #[inline(always)]
            pub fn write(self, values: &mut [T]) {
                let values = &mut values[..$name::<usize>::NAMES.len()];
                $(values[$name::<usize>::NUMBER.$field] = self.$field;)*
            }
        }

        #[allow(dead_code, reason = "inputs and outputs are not passed between the stages")]
        impl<R: $crate::real::Real> $name<R> {
            /// Reads what the first stage passed on.
            #[inline(always)]
            pub fn shared(values: &[R::Shared]) -> Self {
                let values = &values[..$name::<usize>::NAMES.len()];
                Self { $($field: R::shared(values[$name::<usize>::NUMBER.$field])),* }
            }
        }
    };
}
pub(crate) use record;
