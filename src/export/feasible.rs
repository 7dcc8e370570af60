//! The table of all feasible designs, block by block: it may be too long for the memory.

use super::{Certified, tables};
use crate::certify::{self, check_feasible};
use crate::error::{Error, Result};
use crate::reduce::{FEASIBLE_FILE, FeasibleList};
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

/// Calls `take` with the table of the next designs, certified, until there are none; once at least, for its columns.
fn each_block(
    outcome: &Certified<'_>,
    list: &FeasibleList,
    threads: usize,
    control: &Control,
    mut take: impl FnMut(Table) -> Result<()>,
) -> Result<()> {
    let study = &outcome.plan.study;
    let mut indices = list.indices();
    let mut is_first = true;
    loop {
        let block: Vec<u64> = indices.by_ref().take(BLOCK_ROWS).collect();
        if block.is_empty() && !is_first {
            return Ok(());
        }
        let rows = certify::rows(outcome.plan, &outcome.columns, &block, threads, control)?;
        rows.iter().try_for_each(check_feasible)?;
        take(tables::of_rows(study, &tables::label_texts(outcome), &outcome.columns, &rows, &|input| may_be_a_word(study, input)))?;
        is_first = false;
    }
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
    each_block(outcome, list, threads, control, |table| stream.write(&table))?;
    stream.finish()
}

/// The whole table in memory.
///
/// # Errors
/// As [`write`], but for those of files.
pub fn table(outcome: &Certified<'_>, list: &FeasibleList, threads: usize, control: &Control) -> Result<Table> {
    let mut whole: Option<Table> = None;
    each_block(outcome, list, threads, control, |table| {
        match &mut whole {
            None => whole = Some(table),
            Some(whole) => whole.append(table),
        }
        Ok(())
    })?;
    whole.ok_or_else(|| Error::Disagreement("the table of feasible designs has no columns".to_owned()))
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
