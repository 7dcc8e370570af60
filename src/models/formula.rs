//! The two stages of a formula, and the same formula behind a table of functions for every number type.

use super::description::Model;
use crate::real::{LANES, Lanes, Real};
use crate::tape::{Fields, First, Known, List, Loops, Operation, Recordable, Recording, Second, Trace, Whole};

/// Most inputs that a model may have.
pub const INPUTS: usize = 64;
/// Most outputs that a model may have.
pub const OUTPUTS: usize = 48;
/// Most conditions that a model may have.
pub const CONDITIONS: usize = 12;

/// A model's formula in two stages, over any [`Real`]. All values are in SI units.
///
/// `prepare` holds what is dear (geometry, transcendental functions, solves) and should read as few inputs as the physics
/// allows: a sweep runs it once for every combination of the inputs that it reads. `finish` is the inner loop. What passes
/// between them is [`Fields::prepared_len`] numbers.
pub trait Formula {
    /// Names of what the formula reads and writes, for the shader.
    const FIELDS: Fields;
    /// First stage: what depends on the slow inputs only, as far as the outputs in `wanted` need it.
    fn prepare<R: Real>(inputs: &[R; INPUTS], wanted: u64, prepared: &mut [R]);
    /// Signed margins of the model's conditions, in the order of its table; those whose bit is not set in `wanted` may be left out.
    fn conditions<R: Real>(prepared: &[R::Shared], inputs: &[R; INPUTS], wanted: u64) -> [R; CONDITIONS];
    /// Second stage: writes the outputs whose bit is set in `wanted` (and may write others).
    fn finish<R: Real>(prepared: &[R::Shared], inputs: &[R; INPUTS], wanted: u64, outputs: &mut [R; OUTPUTS]);
    /// A shorter way to the same bits for a block of designs that have more in common than what is prepared: writes the columns asked
    /// for as [`Kernel::finish_columns`] does, in SI units, and returns true; false if this block is none of that kind.
    #[inline(always)]
    fn finish_block(_prepared: &[f64], _inputs: &[Lanes; INPUTS], _columns: &Columns<'_>, _results: &mut [Vec<f64>]) -> bool {
        false
    }
}

/// The set of outputs with these numbers.
pub const fn bits(numbers: &[usize]) -> u64 {
    let (mut set, mut i) = (0, 0);
    while i < numbers.len() {
        set |= 1 << numbers[i];
        i += 1;
    }
    set
}

/// Which inputs each part of a formula depends on: bit `i` for input number `i`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// What the first stage reads and passes on.
    pub prepared: u64,
    /// Each output.
    pub outputs: [u64; OUTPUTS],
    /// Each condition.
    pub conditions: [u64; CONDITIONS],
}

/// What a formula's second stage and conditions read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reads {
    /// Fields that the first stage passes on: bit `i` for number `i` of [`Fields::places`].
    pub prepared: u64,
    /// Inputs: bit `i` for input number `i`.
    pub inputs: u64,
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

/// Room for the inner loop, kept between calls: filling it anew would cost as much as a short block.
#[derive(Debug)]
pub struct Scratch {
    inputs: [Lanes; INPUTS],
    outputs: [Lanes; OUTPUTS],
}

impl Default for Scratch {
    fn default() -> Self {
        Self { inputs: [Lanes::splat(0.0); INPUTS], outputs: [Lanes::splat(0.0); OUTPUTS] }
    }
}

/// A formula as a sweep in f64 needs it, behind one table of functions. Every [`Formula`] is one; a model that is no formula over
/// any number type, such as a solver of its own, implements it directly and cannot be recorded.
pub trait Kernel: Send + Sync {
    /// How many numbers the first stage passes on.
    fn prepared_len(&self) -> usize;
    /// First stage in f64, as far as the outputs in `wanted` need it; `prepared` has [`Kernel::prepared_len`] places.
    fn prepare(&self, inputs: &[f64; INPUTS], wanted: u64, prepared: &mut [f64]);
    /// How many of the numbers that the first stage passed on are in use, from the first.
    fn prepared_used(&self, prepared: &[f64]) -> usize {
        prepared.len()
    }
    /// Inputs that the first stage reads for a design with these inputs, where it takes so long that what it passed on is worth keeping
    /// for another design of which these are the same: bit `i` for input number `i`. All: it is not worth keeping.
    fn prepared_reads(&self, _inputs: &[f64; INPUTS]) -> u64 {
        u64::MAX
    }
    /// Margins of all conditions in f64.
    fn conditions(&self, prepared: &[f64], inputs: &[f64; INPUTS]) -> [f64; CONDITIONS];
    /// Second stage in f64.
    fn finish(&self, prepared: &[f64], inputs: &[f64; INPUTS], wanted: u64, outputs: &mut [f64; OUTPUTS]);
    /// First stage in f64 with all that it can pass on.
    fn prepared(&self, inputs: &[f64; INPUTS]) -> Vec<f64> {
        let mut prepared = vec![0.0; self.prepared_len()];
        self.prepare(inputs, u64::MAX, &mut prepared);
        prepared
    }
    /// Second stage for many designs at once: same bits as [`Kernel::finish`].
    ///
    /// `results` has one column per asked output (in the output's unit), then one per asked condition (the margin).
    fn finish_columns(
        &self,
        model: &Model,
        prepared: &[f64],
        inputs: &[f64; INPUTS],
        columns: &Columns<'_>,
        scratch: &mut Scratch,
        results: &mut [Vec<f64>],
    );
    /// What depends on what, given what is known of the inputs.
    fn reach(&self, inputs: &[Known]) -> Reach;
    /// The formula to be recorded; `None` if it is none over any number type.
    fn formula(&self) -> Option<&dyn Recordable> {
        None
    }
    /// Bytes that a thread needs for a design: an estimate before anything is solved.
    fn footprint(&self, _inputs: &[f64; INPUTS]) -> Footprint {
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

    fn whole(&self, known: &[Known], wanted: u64, conditions: u64) -> Whole {
        let mut lengths = [0; 2];
        let (recording, nodes) = Recording::of(known, |named| {
            let inputs = padded(named);
            let mut prepared = vec![Trace::constant(0.0); F::FIELDS.prepared_len()];
            F::prepare(&inputs, wanted, &mut prepared);
            let [outputs, margins] = finish::<F>(&prepared, &inputs, wanted, conditions);
            lengths = [prepared.len(), outputs.len()];
            [prepared, outputs, margins].concat()
        });
        let (prepared, rest) = nodes.split_at(lengths[0]);
        let (outputs, conditions) = rest.split_at(lengths[1]);
        Whole { recording, prepared: prepared.to_vec(), outputs: outputs.to_vec(), conditions: conditions.to_vec() }
    }

    fn stages(&self, wanted: u64, conditions: u64) -> (First, Second) {
        let known = vec![Known::ANY; F::FIELDS.inputs.len()];
        let (recording, prepared) = Recording::recorded(Loops::Once, &known, |named| {
            let mut prepared = Trace::to_pass_on(&F::FIELDS);
            F::prepare(&padded(named), wanted, &mut prepared);
            F::FIELDS.places().map(|(first, _)| prepared[first].as_written()).collect()
        });
        (First { recording, prepared }, second::<F>(Loops::Once, &known, wanted, conditions))
    }

    fn second(&self, known: &[Known], wanted: u64, conditions: u64) -> Second {
        second::<F>(Loops::EveryIteration, known, wanted, conditions)
    }
}

fn second<F: Formula>(loops: Loops, known: &[Known], wanted: u64, conditions: u64) -> Second {
    let passed = vec![Known::ANY; F::FIELDS.prepared_len()];
    let mut count = 0;
    let (recording, nodes) = Recording::recorded(loops, &[known, &passed].concat(), |named| {
        let (inputs, prepared) = named.split_at(known.len());
        let [outputs, margins] = finish::<F>(prepared, &padded(inputs), wanted, conditions);
        count = outputs.len();
        [outputs, margins].concat()
    });
    let (outputs, conditions) = nodes.split_at(count);
    Second { recording, outputs: outputs.to_vec(), conditions: conditions.to_vec() }
}

/// Inputs of a formula that is recorded, as an array of the length that formulas take.
fn padded(named: &[Trace]) -> [Trace; INPUTS] {
    let mut inputs = [Trace::constant(0.0); INPUTS];
    inputs[..named.len()].copy_from_slice(named);
    inputs
}

/// Outputs and margins of the second stage of a formula that is recorded.
fn finish<F: Formula>(prepared: &[Trace], inputs: &[Trace; INPUTS], wanted: u64, conditions: u64) -> [Vec<Trace>; 2] {
    let mut outputs = [Trace::constant(0.0); OUTPUTS];
    F::finish(prepared, inputs, wanted, &mut outputs);
    let margins = F::conditions(prepared, inputs, conditions);
    [outputs[..F::FIELDS.outputs.len()].to_vec(), margins.to_vec()]
}

impl Reach {
    /// Of a formula that can be recorded.
    pub fn of(formula: &dyn Recordable, inputs: &[Known]) -> Self {
        let whole = formula.whole(inputs, u64::MAX, u64::MAX);
        let list = List::cut(
            &whole.recording,
            &whole.prepared.iter().chain(&whole.outputs).chain(&whole.conditions).copied().map(Some).collect::<Vec<_>>(),
        );
        let sets = list.dependencies(|input| 1 << input);
        let of: Vec<u64> = list.results.iter().flatten().map(|&node| sets[node as usize]).collect();
        let (prepared, rest) = of.split_at(whole.prepared.len());
        let (from_outputs, from_conditions) = rest.split_at(whole.outputs.len());
        let (mut outputs, mut conditions) = ([0; OUTPUTS], [0; CONDITIONS]);
        outputs[..from_outputs.len()].copy_from_slice(from_outputs);
        conditions[..from_conditions.len()].copy_from_slice(from_conditions);
        Self { prepared: prepared.iter().fold(0, |all, set| all | set), outputs, conditions }
    }
}

impl Reads {
    /// Of a formula that can be recorded, to give the outputs in `wanted` and all conditions.
    pub fn of(formula: &dyn Recordable, inputs: &[Known], wanted: u64) -> Self {
        let list = formula.second(inputs, wanted, u64::MAX).list(wanted, u64::MAX);
        let field_of: Vec<usize> =
            formula.fields().places().enumerate().flat_map(|(field, (_, length))| std::iter::repeat_n(field, length)).collect();
        let mut reads = Self { prepared: 0, inputs: 0 };
        for operation in &list.operations {
            if let Operation::Input(input) = *operation {
                match usize::from(input).checked_sub(inputs.len()) {
                    Some(passed) => reads.prepared |= 1 << field_of[passed],
                    None => reads.inputs |= 1 << input,
                }
            }
        }
        reads
    }
}

impl<F: Formula + Send + Sync> Kernel for F {
    fn prepared_len(&self) -> usize {
        F::FIELDS.prepared_len()
    }

    fn prepare(&self, inputs: &[f64; INPUTS], wanted: u64, prepared: &mut [f64]) {
        F::prepare(inputs, wanted, prepared);
    }

    fn conditions(&self, prepared: &[f64], inputs: &[f64; INPUTS]) -> [f64; CONDITIONS] {
        F::conditions(prepared, inputs, u64::MAX)
    }

    fn finish(&self, prepared: &[f64], inputs: &[f64; INPUTS], wanted: u64, outputs: &mut [f64; OUTPUTS]) {
        F::finish(prepared, inputs, wanted, outputs);
    }

    fn finish_columns(
        &self,
        model: &Model,
        prepared: &[f64],
        inputs: &[f64; INPUTS],
        columns: &Columns<'_>,
        scratch: &mut Scratch,
        results: &mut [Vec<f64>],
    ) {
        for (lanes, &value) in scratch.inputs.iter_mut().zip(inputs).take(model.inputs.len()) {
            *lanes = Lanes::splat(value);
        }
        finish_columns::<F>(prepared, columns, scratch, results);
        for (&output, result) in columns.outputs.iter().zip(results) {
            let unit = model.outputs[output].unit;
            if !unit.is_si() {
                result[..columns.count].iter_mut().for_each(|value| *value = unit.from_si(*value));
            }
        }
    }

    fn reach(&self, inputs: &[Known]) -> Reach {
        Reach::of(self, inputs)
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
    let Scratch { inputs, outputs } = scratch;
    let wanted = bits(columns.outputs);
    let asked = bits(columns.conditions);
    if F::finish_block(prepared, inputs, columns, results) {
        return;
    }
    for first in (0..columns.count).step_by(LANES) {
        for (input, column) in columns.varying {
            inputs[*input].0.copy_from_slice(&column[first..first + LANES]);
        }
        if wanted != 0 {
            F::finish(prepared, inputs, wanted, outputs);
            for (&output, result) in columns.outputs.iter().zip(&mut *results) {
                result[first..first + LANES].copy_from_slice(&outputs[output].0);
            }
        }
        if !columns.conditions.is_empty() {
            let margins = F::conditions(prepared, inputs, asked);
            for (&condition, result) in columns.conditions.iter().zip(&mut results[columns.outputs.len()..]) {
                result[first..first + LANES].copy_from_slice(&margins[condition].0);
            }
        }
    }
}

/// A struct of values of one type with named fields, read from and numbered like an array: the names of a model's inputs and
/// of what `prepare` passes on.
macro_rules! record {
    ($(#[$doc:meta])* $name:ident { $($field:ident),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub(super) struct $name<T> { $(pub $field: T),* }

        impl $name<usize> {
            /// The name of every field.
            #[allow(dead_code, reason = "some records are private to the Rust code")]
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
            #[inline(always)]
            pub fn read<const N: usize>(values: &[T; N]) -> Self {
                Self { $($field: values[$name::<usize>::NUMBER.$field]),* }
            }

            #[inline(always)]
            pub fn write(self, values: &mut [T]) {
                let values = &mut values[..$name::<usize>::NAMES.len()];
                $(values[$name::<usize>::NUMBER.$field] = self.$field;)*
            }
        }

        #[allow(dead_code, reason = "inputs and outputs are not passed between the stages")]
        impl<R: crate::real::Real> $name<R> {
            /// Reads what the first stage passed on.
            #[inline(always)]
            pub fn shared(values: &[R::Shared]) -> Self {
                let values = &values[..$name::<usize>::NAMES.len()];
                Self { $($field: R::shared(values[$name::<usize>::NUMBER.$field])),* }
            }
        }
    };
}
pub(super) use record;
