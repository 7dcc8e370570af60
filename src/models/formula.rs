//! The two stages of a formula, and the same formula behind a table of functions for every number type.

use super::description::Model;
use crate::real::{Dependence, LANES, Lanes, Real, RunningError};

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
    /// Names of what the formula reads and writes, for its twin in WGSL.
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

/// The names of a formula's values, in the order of its arrays.
#[derive(Clone, Copy, Debug)]
pub struct Fields {
    /// Of the inputs.
    pub inputs: &'static [&'static str],
    /// Of the single numbers that the first stage passes on.
    pub prepared: &'static [&'static str],
    /// Of the tables that it passes on after them, with their lengths.
    pub tables: &'static [(&'static str, usize)],
    /// Most loop turns that the twin's second stage and conditions take together, for drivers that end long loops.
    pub turns: u64,
    /// Of the outputs; there may be more than the model lists.
    pub outputs: &'static [&'static str],
}

impl Fields {
    /// How many numbers the first stage passes on.
    pub fn prepared_len(&self) -> usize {
        self.tables.iter().fold(self.prepared.len(), |sum, (_, length)| sum + length)
    }

    /// Of each field that the first stage passes on, tables after single numbers: where it starts and how long it is.
    pub fn places(&self) -> impl Iterator<Item = (usize, usize)> {
        let lengths = self.prepared.iter().map(|_| 1).chain(self.tables.iter().map(|(_, length)| *length));
        lengths.scan(0, |next, length| {
            *next += length;
            Some((*next - length, length))
        })
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
/// any number type, such as a solver of its own, implements it directly and has no [`Twin`].
pub trait Kernel: Sync {
    /// How many numbers the first stage passes on.
    fn prepared_len(&self) -> usize;
    /// First stage in f64, as far as the outputs in `wanted` need it; `prepared` has [`Kernel::prepared_len`] places.
    fn prepare(&self, inputs: &[f64; INPUTS], wanted: u64, prepared: &mut [f64]);
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
    /// What depends on what.
    fn reach(&self, inputs: &[Dependence; INPUTS]) -> Reach;
}

/// The same formula as a device has it: in f32, with bounds on its errors. Every [`Formula`] is one.
pub trait Twin: Sync {
    /// The names of the formula's values.
    fn fields(&self) -> Fields;
    /// What the second stage and the conditions read, to give the outputs in `wanted`.
    fn reads(&self, inputs: &[Dependence; INPUTS], wanted: u64) -> Reads;
    /// Outputs and condition margins in f32 with bounds on their errors.
    fn bounded(&self, inputs: &[RunningError; INPUTS]) -> ([RunningError; OUTPUTS], [RunningError; CONDITIONS]);
    /// Outputs and condition margins in f32, as a shader computes them.
    fn twin(&self, inputs: &[f32; INPUTS]) -> ([f32; OUTPUTS], [f32; CONDITIONS]);
}

/// Both stages with every output, over any number type.
pub fn run<F: Formula, R: Real<Shared = R>>(inputs: &[R; INPUTS]) -> ([R; OUTPUTS], [R; CONDITIONS]) {
    let mut prepared = vec![R::constant(0.0); F::FIELDS.prepared_len()];
    F::prepare(inputs, u64::MAX, &mut prepared);
    let mut outputs = [R::constant(0.0); OUTPUTS];
    F::finish(&prepared, inputs, u64::MAX, &mut outputs);
    (outputs, F::conditions(&prepared, inputs, u64::MAX))
}

impl<F: Formula + Sync> Kernel for F {
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

    fn reach(&self, inputs: &[Dependence; INPUTS]) -> Reach {
        let (outputs, conditions) = run::<F, Dependence>(inputs);
        let mut prepared = vec![Dependence::fixed(0.0); F::FIELDS.prepared_len()];
        F::prepare(inputs, u64::MAX, &mut prepared);
        let prepared = prepared.iter().fold(0, |set, value| set | value.inputs);
        Reach { prepared, outputs: outputs.map(|value| value.inputs), conditions: conditions.map(|value| value.inputs) }
    }
}

impl<F: Formula + Sync> Twin for F {
    fn fields(&self) -> Fields {
        F::FIELDS
    }

    fn reads(&self, inputs: &[Dependence; INPUTS], wanted: u64) -> Reads {
        let union = |prepared: &[Dependence], inputs: &[Dependence; INPUTS]| {
            let mut outputs = [Dependence::fixed(0.0); OUTPUTS];
            F::finish(prepared, inputs, wanted, &mut outputs);
            let asked = outputs.iter().enumerate().filter(|(output, _)| wanted >> output & 1 == 1).map(|(_, value)| value.inputs);
            asked.chain(F::conditions(prepared, inputs, u64::MAX).iter().map(|margin| margin.inputs)).fold(0, |all, set| all | set)
        };
        // Once with a bit for each field passed on and none for the inputs, once the other way round.
        let fields = F::FIELDS.places().enumerate();
        let field = |(field, (_, length))| std::iter::repeat_n(Dependence::varied(field, f64::NEG_INFINITY, f64::INFINITY), length);
        let passed: Vec<_> = fields.flat_map(field).collect();
        let silent = inputs.map(Dependence::without_inputs);
        let unknown = vec![Dependence::within(0, f64::NEG_INFINITY, f64::INFINITY); passed.len()];
        Reads { prepared: union(&passed, &silent), inputs: union(&unknown, inputs) }
    }

    fn bounded(&self, inputs: &[RunningError; INPUTS]) -> ([RunningError; OUTPUTS], [RunningError; CONDITIONS]) {
        run::<F, RunningError>(inputs)
    }

    fn twin(&self, inputs: &[f32; INPUTS]) -> ([f32; OUTPUTS], [f32; CONDITIONS]) {
        run::<F, f32>(inputs)
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
