//! Many draws of one design at once, by the recorded formula of the drive: how many of them hold.

use super::super::quantity::Quantity;
use super::drive::{DrawnDrive, needs};
use crate::masks::{count, keep_between, keep_margin};
use crate::models::input_to_si;
use crate::probability::Effect;
use crate::tape::{CHUNK, ColumnValue, Known, List, ListColumns, Set};

/// Most operations of a formula: each has a column of its own.
pub(super) const MOST_OPERATIONS: usize = 1000;

/// What a draw must keep, as a list of operations.
#[derive(Debug)]
pub struct DrawCounting {
    list: List,
    /// Of each condition of the drive that matters: its result, is it strict?
    conditions: Vec<(usize, bool)>,
    /// Of each constraint on an output: its result.
    outputs: Vec<(usize, usize)>,
    drawn: Set,
}

impl DrawCounting {
    /// For a kernel whose drive can be recorded and whose constraints all are of worst values.
    pub fn new(kernel: &DrawnDrive) -> Option<Self> {
        if kernel.holds.iter().any(|it| !it.over.is_worst()) {
            return None;
        }
        let base = &kernel.base;
        let formula = base.kernel.formula()?;
        // Written out, the loops that fill tables are a hundred thousand operations: recording them takes 40 MB.
        if !formula.fields().tables.is_empty() {
            return None;
        }
        let (asked, conditions) = needs(base, kernel.holds.iter().map(|it| it.quantity));
        let known = vec![Known::ANY; base.inputs.len()];
        let whole = formula.whole(&known, asked, conditions);
        let list = whole.list(asked, conditions);
        if list.operations.len() > MOST_OPERATIONS {
            return None;
        }
        let outputs = whole.outputs.len();
        let of_outputs = kernel.holds.iter().enumerate().filter_map(|(number, it)| Some((number, it.quantity.output()?)));
        Some(Self {
            list,
            conditions: conditions.iter().map(|it| (outputs + it, base.conditions[it].strict)).collect(),
            outputs: of_outputs.collect(),
            drawn: kernel.drawn.iter().map(|it| it.0).collect(),
        })
    }

    /// How many of these draws (a column per drawn input) hold for a design, given its inputs in SI units.
    pub fn holding(&self, kernel: &DrawnDrive, design: &[f64], columns: &[Vec<f64>]) -> u64 {
        let base = &kernel.base;
        let draws = columns.first().map_or(0, Vec::len);
        let mut alive = vec![u64::MAX; draws];
        let mut running = ListColumns::new(&self.list);
        let results = self.conditions.iter().map(|it| it.0).chain(self.outputs.iter().map(|it| it.1));
        running.turn_to(&self.list, results, |input| self.drawn.contains(input.into()));
        let mut actual: Vec<Vec<f64>> = vec![vec![0.0; draws]; columns.len()];
        let mut si = design.to_vec();
        let mut room = vec![0.0; CHUNK];
        for row in &kernel.cases.rows {
            si.copy_from_slice(design);
            for (&input, &value) in kernel.cases.inputs.iter().zip(row) {
                si[input] = input_to_si(&base.inputs[input], value);
            }
            for ((&(input, effect), drawn), actual) in kernel.drawn.iter().zip(columns).zip(&mut actual) {
                for ((to, drawn), alive) in actual.iter_mut().zip(drawn).zip(&mut alive) {
                    *to = kernel.actual((input, effect), if effect == Effect::Is { 0.0 } else { si[input] }, *drawn);
                    if !kernel.fits(input, *to) {
                        *alive = 0;
                    }
                }
            }
            let place = |input: usize| kernel.drawn.iter().position(|it| it.0 == input);
            let of_input =
                |input: u16| place(input.into()).map_or(ColumnValue::One(si[input as usize]), |at| ColumnValue::Each(&actual[at]));
            running.run(&self.list, draws, of_input, |running, first, length| {
                let alive = &mut alive[first..first + length];
                let mut values = |result: usize, take: &mut dyn FnMut(&[f64])| match running.result(&self.list, result) {
                    ColumnValue::Each(values) => take(values),
                    ColumnValue::One(value) => {
                        room[..length].fill(value);
                        take(&room[..length]);
                    }
                };
                for &(result, strict) in &self.conditions {
                    values(result, &mut |margins| keep_margin(alive, margins, strict));
                }
                for &(constraint, output) in &self.outputs {
                    let unit = base.outputs[output].unit;
                    let (low, high) = kernel.holds[constraint].ends();
                    values(output, &mut |values| {
                        let values: Vec<f64> = values.iter().map(|value| unit.from_si(*value)).collect();
                        keep_between(alive, &values, low, high);
                    });
                }
            });
            for constraint in &kernel.holds {
                let Quantity::Input(input) = constraint.quantity else { continue };
                let (unit, (low, high)) = (base.inputs[input].unit, constraint.ends());
                let value = |draw: usize| unit.from_si(place(input).map_or(si[input], |at| actual[at][draw]));
                let values: Vec<f64> = (0..draws).map(value).collect();
                keep_between(&mut alive, &values, low, high);
            }
        }
        count(&alive)
    }
}
