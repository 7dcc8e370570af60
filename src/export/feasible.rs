//! The table of all feasible designs, block by block: it may be too long for the memory.

use super::{Certified, tables};
use crate::certify::{self, Column, Row, check_feasible};
use crate::error::{Error, Result};
use crate::plan::Plan;
use crate::reduce::{FEASIBLE_FILE, FeasibleCursor, FeasibleList};
use crate::screen::Control;
use crate::study::{Axis, Levels, Study};
use crate::table::Table;
use crate::table::stream::{BLOCK_ROWS, TableForm, TableStream};
use std::io::Write;
use std::path::Path;

/// Does the list have as many designs as the sweep has counted?
///
/// # Errors
/// [`Error::Disagreement`].
pub fn check_count(list: &FeasibleList, feasible: u64) -> Result<()> {
    let kept = list.indices().count() as u64;
    if kept == feasible {
        return Ok(());
    }
    Err(Error::Disagreement(format!("the sweep kept {kept} of the {feasible} feasible designs where it must keep all")))
}

/// All feasible designs of a sweep, as a table that may be longer than the memory: block by block, and again from the start as often as
/// somebody asks. Kept are a byte or two per design; each block is computed when it is asked for.
#[derive(Debug)]
pub struct FeasibleRows {
    plan: Plan,
    columns: Vec<Column>,
    list: FeasibleList,
    rows: u64,
}

impl FeasibleRows {
    pub(crate) fn new(outcome: &Certified<'_>, list: &FeasibleList) -> Self {
        let plan = Plan::new(outcome.plan.study.clone());
        Self { plan, columns: outcome.columns.clone(), list: list.clone(), rows: outcome.state.feasible }
    }

    /// Number of rows.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// A place before the first row.
    pub fn cursor(&self) -> FeasibleCursor {
        self.list.cursor()
    }

    /// The columns, without rows.
    pub fn header(&self) -> Table {
        table_of(&self.plan, &self.columns, &[])
    }

    /// The table of the next rows, 65 536 or the last ones, certified; `None` where there are no more. `control` can stop it.
    ///
    /// # Errors
    /// [`Error::Disagreement`] if the f64 reference finds a design infeasible; [`Error::Stopped`] after `control.stop`. The cursor stands
    /// where it stood then, so that the same rows can be asked for again.
    pub fn next(&self, cursor: &mut FeasibleCursor, threads: usize, control: &Control) -> Result<Option<Table>> {
        let mut ahead = cursor.clone();
        let table = next_block(&self.plan, &self.columns, &self.list, &mut ahead, threads, control)?;
        *cursor = ahead;
        Ok(table)
    }

    /// The whole table in memory.
    ///
    /// # Errors
    /// As [`Self::next`].
    pub fn table(&self, threads: usize, control: &Control) -> Result<Table> {
        let (mut cursor, mut whole) = (self.cursor(), self.header());
        while let Some(table) = self.next(&mut cursor, threads, control)? {
            whole.append(table);
        }
        Ok(whole)
    }
}

fn next_block(
    plan: &Plan,
    columns: &[Column],
    list: &FeasibleList,
    cursor: &mut FeasibleCursor,
    threads: usize,
    control: &Control,
) -> Result<Option<Table>> {
    let block: Vec<u64> = std::iter::from_fn(|| list.next(cursor)).take(BLOCK_ROWS).collect();
    if block.is_empty() {
        return Ok(None);
    }
    let rows = certify::rows(plan, columns, &block, threads, control)?;
    rows.iter().try_for_each(check_feasible)?;
    Ok(Some(table_of(plan, columns, &rows)))
}

fn table_of(plan: &Plan, columns: &[Column], rows: &[Row]) -> Table {
    let study = &plan.study;
    tables::of_rows(study, &tables::label_texts(plan), columns, rows, &|input| may_be_a_word(study, input))
}

/// Writes the table.
///
/// # Errors
/// [`Error::Disagreement`] if the f64 reference finds a design infeasible; [`Error::Stopped`] after `control.stop`; [`Error::Io`].
pub fn write(outcome: &Certified<'_>, list: &FeasibleList, threads: usize, control: &Control, out: &mut dyn Write) -> Result<()> {
    #[cfg(feature = "parquet")]
    let form = TableForm::Parquet;
    #[cfg(not(feature = "parquet"))]
    let form = TableForm::Csv;
    let mut stream = TableStream::new(form, out, Path::new(FEASIBLE_FILE));
    let (plan, columns) = (outcome.plan, &outcome.columns);
    let (mut cursor, mut is_first) = (list.cursor(), true);
    loop {
        let block = next_block(plan, columns, list, &mut cursor, threads, control)?;
        match block {
            Some(table) => stream.write(&table)?,
            // Without rows there are columns all the same.
            None if is_first => stream.write(&table_of(plan, columns, &[]))?,
            None => return stream.finish(),
        }
        is_first = false;
    }
}

/// Is a level of the design axis of this input a word? All blocks must have the same kind of column.
fn may_be_a_word(study: &Study, input: usize) -> bool {
    let table = &study.model.inputs[input];
    let of_axis = |axis: &Axis| match axis {
        Axis::Single { input: own, levels: Levels::List(values) } => *own == input && values.iter().any(|&it| table.word_for(it).is_some()),
        // Levels given by a rule are numbers.
        Axis::Single { .. } => false,
        Axis::Joint { inputs, rows } => {
            inputs.iter().position(|it| *it == input).is_some_and(|at| rows.iter().any(|row| table.word_for(row[at]).is_some()))
        }
    };
    table.is_enumeration() || study.design.iter().any(of_axis)
}
