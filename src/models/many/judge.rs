//! Status and presence of outputs over a chunk of rows.

use super::vectors::{clear, converted, failures, join, write_marked};
use crate::models::{Model, Status};
use crate::tape::ColumnValue;

/// The number of a status that is ok.
const OK: u16 = 0;

/// Judges rows of a model by the margins of its conditions.
#[derive(Debug)]
pub(crate) struct ColumnJudge {
    outputs: Vec<JudgedOutput>,
}

/// Room for a thread that judges.
#[derive(Debug, Default)]
pub(crate) struct JudgeRoom {
    /// Of each condition: does it fail anywhere, and in which rows?
    failed: Vec<(bool, Vec<bool>)>,
    /// Where an output is taken away.
    gone: Vec<bool>,
    /// Of each output that is asked for: has it overflown somewhere, and is that a status?
    overflown: Vec<bool>,
}

/// An output that is asked for.
#[derive(Debug)]
struct JudgedOutput {
    number: usize,
    /// The conditions that take it away where they fail.
    takers: Vec<usize>,
    /// Is it a status if it overflows?
    counts: bool,
}

impl ColumnJudge {
    /// For these outputs; an overflow is a status of those that count.
    pub fn new(model: &Model, outputs: &[usize], counts: impl Fn(usize) -> bool) -> Self {
        let takes = |condition: usize, output: usize| {
            model.conditions[condition].invalidates.iter().any(|name| *name == model.outputs[output].name)
        };
        let judged = |&number: &usize| JudgedOutput {
            number,
            takers: (0..model.conditions.len()).filter(|&it| takes(it, number)).collect(),
            counts: counts(number),
        };
        Self { outputs: outputs.iter().map(judged).collect() }
    }

    /// The conditions that take an output away, given by its place among those asked for.
    pub fn takers(&self, place: usize) -> &[usize] {
        &self.outputs[place].takers
    }

    /// Judges a chunk: `margin` of each condition and `value` of each output asked for, in SI units. Outputs are written in their units,
    /// NaN where they have no meaning; statuses as their numbers, which go side by side in vectors. Where there is no margin or no value it
    /// is what it was the last time, with this room; so is an output, as it was written then.
    pub fn judge<'c>(
        &self,
        model: &Model,
        margin: impl Fn(usize) -> Option<ColumnValue<'c>>,
        value: impl Fn(usize) -> Option<ColumnValue<'c>>,
        statuses: &mut [u16],
        outputs: &mut [&mut [f64]],
        room: &mut JudgeRoom,
    ) {
        let count = statuses.len();
        statuses.fill(OK);
        let JudgeRoom { failed, gone, overflown } = room;
        failed.resize_with(model.conditions.len(), Default::default);
        gone.resize(count, false);
        overflown.resize(self.outputs.len(), false);
        for (number, ((any, rows), condition)) in failed.iter_mut().zip(&model.conditions).enumerate() {
            rows.resize(count, false);
            *any = match margin(number) {
                None => *any,
                Some(ColumnValue::Each(margins)) => failures(margins, condition.strict, rows),
                Some(ColumnValue::One(margin)) => {
                    let fails = failures(&[margin], condition.strict, &mut [false]);
                    rows.fill(fails);
                    fails
                }
            };
        }
        // Of conditions that fail the first one is the status, so it is written last.
        for (number, (any, rows)) in failed.iter().enumerate().rev() {
            if *any && !model.conditions[number].quiet {
                write_marked(statuses, rows, Status::failed(number).into());
            }
        }
        for (place, ((column, output), overflown)) in outputs.iter_mut().zip(&self.outputs).zip(overflown).enumerate() {
            let unit = model.outputs[output.number].unit;
            let (multiply, divide) = unit.factors();
            let new = value(place);
            let is_new = new.is_some();
            let settled = match new {
                None => !*overflown,
                Some(ColumnValue::One(value)) => {
                    let value = unit.from_si(value);
                    column.fill(value);
                    value.is_finite()
                }
                Some(ColumnValue::Each(values)) => converted(values, (divide, multiply), column),
            };
            let mut takers = output.takers.iter().map(|&it| &failed[it]).filter(|(any, _)| *any).map(|(_, rows)| rows);
            *overflown &= !is_new;
            match takers.next() {
                _ if settled && !is_new => continue,
                None if settled => continue,
                None => gone.fill(false),
                Some(first) => gone.copy_from_slice(first),
            }
            takers.for_each(|rows| join(gone, rows));
            // What no condition takes away and is absent all the same has overflowed.
            *overflown |= is_new && clear(column, gone) && output.counts;
            if *overflown {
                let rows = column.iter().zip(&*gone).zip(&mut *statuses);
                for ((_, _), status) in rows.filter(|((value, gone), status)| value.is_nan() && !**gone && **status == OK) {
                    *status = Status::Overflow.into();
                }
            }
        }
    }
}
