//! The table of scenarios: the inputs that the operating cases and the uncertainty give, and the weight of a spectrum's case.

use super::tables::input_column;
use crate::error::{Error, Result};
use crate::plan::Plan;
use crate::study::Study;
use crate::table::{Data, Table, TableColumn, csv};
use std::io::{self, Write};
use std::ops::Range;

/// Most scenarios of a table that is held in memory.
const MOST: u64 = 20_000_000;
/// Rows that are written at a time, because there can be many scenarios.
const AT_A_TIME: u64 = 4096;

/// Some scenarios with their inputs in the units of the model, and their weight if the study has weights.
fn table(plan: &Plan, numbers: Range<u64>) -> Table {
    let study = &plan.study;
    let axes = study.operation.iter().chain(&study.uncertainty);
    let inputs: Vec<_> = axes.flat_map(|axis| axis.inputs().iter().enumerate().map(move |(place, &input)| (axis, place, input))).collect();
    let mut values = vec![Vec::new(); inputs.len()];
    let mut all = study.fixed.clone();
    for scenario in numbers.clone() {
        plan.space.scenarios.set(scenario, &mut all);
        values.iter_mut().zip(&inputs).for_each(|(column, &(.., input))| column.push(all[input]));
    }
    let mut columns = vec![TableColumn::index("scenario", "Number of the scenario.", numbers.clone().map(Some))];
    for (&(axis, place, input), values) in inputs.iter().zip(values) {
        let described = &study.model.inputs[input];
        let has_words = described.is_enumeration() || axis.has_number(place, |it| described.word_for(it).is_some());
        let column = input_column(described, values.into_iter(), has_words);
        columns.push(TableColumn { role: "scenario".to_owned(), ..column });
    }
    if let Some((spectrum, weights)) = plan.listed_weights() {
        let doc = format!("Weight of the case of {}.", spectrum.name);
        let values = numbers.map(|scenario| Some(weights.weight_of(scenario))).collect();
        columns
            .push(TableColumn { unit: spectrum.unit.clone(), ..TableColumn::new(&spectrum.weight, "weight", &doc, Data::Number(values)) });
    }
    Table { columns }
}

/// All of them as CSV.
///
/// # Errors
/// Those of `out`.
pub fn write(plan: &Plan, out: &mut dyn Write) -> io::Result<()> {
    out.write_all(&csv::header(&table(plan, 0..0)))?;
    let count = plan.scenarios();
    let firsts = std::iter::successors(Some(0), |first| Some(first + AT_A_TIME)).take_while(|&first| first < count);
    for first in firsts {
        out.write_all(&csv::rows(&table(plan, first..count.min(first + AT_A_TIME))))?;
    }
    out.flush()
}

impl Study {
    /// Every scenario: its number, its inputs in the units of the model, and its weight if the study has weights. The same as
    /// `scenarios.csv` of a result.
    ///
    /// # Errors
    /// [`Error::Request`] if there are more than 2e7 scenarios.
    pub fn scenario_table(&self) -> Result<Table> {
        let plan = Plan::new(self.clone());
        let count = plan.scenarios();
        if count > MOST {
            return Err(Error::Request(format!(
                "the study has {count} scenarios, and a table of them at most {MOST}; `beltspace sweep` writes all of them to scenarios.csv"
            )));
        }
        Ok(table(&plan, 0..count))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::study_of;

    #[test]
    fn rows_are_those_of_the_file_whatever_is_written_at_a_time() {
        let text = "[design]\nband_count = [6, 9]\n[operation]\ntorque_Nm = { from = 50, to = 150, count = 101 }\nratio = { from = 0.5, to = 2, count = 50 }\n\
                    [uncertainty]\ntraction = [\"limit\", 0.3]\n[objectives]\naxial_force_N = \"min\"\n";
        let study = study_of(&crate::models::find("metal-cvt").expect("it is a model"), text).expect("the study is right");
        let whole = study.scenario_table().expect("there is room");
        assert_eq!(whole.rows(), 101 * 50 * 2);
        let mut written = Vec::new();
        write(&Plan::new(study), &mut written).expect("it is in memory");
        assert_eq!(written, csv::write(&whole));
        let words = whole.columns.iter().map(|it| it.name.as_str()).collect::<Vec<_>>();
        assert_eq!(words, ["scenario", "torque_Nm", "ratio", "traction"]);
        let many = study_of(
            &crate::models::find("metal-cvt").expect("it is a model"),
            &text.replace("count = 101", "count = 5001").replace("count = 50 ", "count = 5000 "),
        );
        let refused = many.expect("the study is right").scenario_table().expect_err("there are 5e7");
        assert!(refused.to_string().contains("has 50010000 scenarios, and a table of them at most 20000000"), "{refused}");
        assert!(written.starts_with(b"scenario,torque_Nm,ratio,traction\n0,50,0.5,limit\n1,50,0.5,0.3\n2,50,"));
    }
}
