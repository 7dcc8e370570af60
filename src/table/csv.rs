//! CSV files: a header with units, decimal points, the shortest numbers, empty cells for absent values.

use super::Table;
use super::number::plain;
use crate::plan::Plan;
use csv::Writer;
use std::io::{self, Write};

const IN_MEMORY: &str = "writing into memory does not fail";

/// A table as CSV.
pub fn write(table: &Table) -> Vec<u8> {
    [header(table), rows(table)].concat()
}

/// The names of its columns, as the first line has them.
pub fn header(table: &Table) -> Vec<u8> {
    let mut writer = Writer::from_writer(Vec::new());
    writer.write_record(table.columns.iter().map(|column| column.name.as_str())).expect(IN_MEMORY);
    writer.into_inner().expect(IN_MEMORY)
}

/// Its rows.
pub fn rows(table: &Table) -> Vec<u8> {
    let mut writer = Writer::from_writer(Vec::new());
    for row in 0..table.rows() {
        writer.write_record(table.columns.iter().map(|column| column.data.text(row))).expect(IN_MEMORY);
    }
    writer.into_inner().expect(IN_MEMORY)
}

/// Every scenario with its inputs, and its weight if the study has weights. Rows are written one by one, because there can be many scenarios.
///
/// # Errors
/// Those of `out`.
pub fn scenarios(plan: &Plan, out: &mut dyn Write) -> io::Result<()> {
    let study = &plan.study;
    let axes = study.operation.iter().chain(&study.uncertainty);
    let inputs: Vec<usize> = axes.flat_map(|axis| axis.inputs()).copied().collect();
    let mut writer = Writer::from_writer(out);
    let names = inputs.iter().map(|&input| study.model.inputs[input].name.as_str());
    let weights = plan.listed_weights();
    writer.write_record(std::iter::once("scenario").chain(names).chain(weights.map(|(it, _)| &it.weight[..])))?;
    let mut values = study.fixed.clone();
    for scenario in 0..plan.scenarios() {
        plan.space.scenarios.set(scenario, &mut values);
        let cells = inputs.iter().map(|&input| match study.model.inputs[input].word_for(values[input]) {
            Some(word) => word.to_owned(),
            None => plain(values[input]),
        });
        let weight = weights.map(|(_, it)| plain(it.weight_of(scenario)));
        writer.write_record(std::iter::once(scenario.to_string()).chain(cells).chain(weight))?;
    }
    writer.flush()
}
