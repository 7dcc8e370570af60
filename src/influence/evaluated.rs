//! Quantities at combinations of the factors, by the f64 reference.

use super::subject::InfluenceSubject;
use crate::certify::{self, Row};
use crate::error::Result;
use crate::plan::Plan;
use crate::screen::Control;
use crate::study::{Axis, Study};

/// Combinations that are held in memory with all their columns.
const BLOCK: usize = 1 << 14;

/// Of each quantity, its value at each combination; NaN where it has none.
pub(super) type QuantityColumns = Vec<Vec<f64>>;

impl InfluenceSubject {
    /// The study with these axes in place of the factors.
    pub(super) fn with_axes(&self, design: Vec<Axis>) -> Plan {
        Plan::new(Study { design, ..self.base.clone() })
    }

    /// Values at drawn numbers: one column for each factor.
    pub(super) fn at_drawn(&self, columns: &[Vec<f64>], threads: usize, control: &Control) -> Result<QuantityColumns> {
        let inputs: Vec<usize> = self.factors.iter().flat_map(|it| it.inputs()).copied().collect();
        let count = columns.first().map_or(0, Vec::len);
        let mut values: QuantityColumns = vec![Vec::with_capacity(count); self.quantities.len()];
        let numbers: Vec<usize> = (0..count).collect();
        for block in numbers.chunks(BLOCK) {
            // A drive whose drawn inputs cannot have their values is none: it has no quantities, and does not hold.
            let row = |&number: &usize| -> Option<Vec<f64>> {
                let parts: Option<Vec<Vec<f64>>> = self.factors.iter().zip(columns).map(|(it, column)| it.values(column[number])).collect();
                parts.map(|parts| parts.concat())
            };
            let rows: Vec<Option<Vec<f64>>> = block.iter().map(row).collect();
            let valid: Vec<Vec<f64>> = rows.iter().flatten().cloned().collect();
            let mut found = Vec::new();
            if !valid.is_empty() {
                let designs: Vec<u64> = (0..valid.len() as u64).collect();
                let plan = self.with_axes(vec![Axis::Joint { inputs: inputs.clone(), rows: valid }]);
                found = certify::rows(&plan, &self.columns, &designs, threads, control)?;
            }
            let mut found = found.iter();
            for row in rows {
                self.take(row.and_then(|_| found.next()), &mut values);
            }
        }
        Ok(values)
    }

    /// Takes in a row; without one there is no drive.
    fn take(&self, row: Option<&Row>, values: &mut QuantityColumns) {
        for (quantity, values) in self.quantities.iter().zip(values) {
            let value = match (quantity.column, row) {
                (None, row) => Some(f64::from(u8::from(row.is_some_and(|row| row.feasible)))),
                (Some(column), Some(row)) => row.columns[column].value.filter(|_| row.complete[column]),
                (Some(_), None) => None,
            };
            values.push(value.unwrap_or(f64::NAN));
        }
    }

    /// Values of these designs of a plan, and which of them hold.
    pub(super) fn of_designs(
        &self,
        plan: &Plan,
        designs: &[u64],
        threads: usize,
        control: &Control,
    ) -> Result<(QuantityColumns, Vec<bool>)> {
        let mut values: QuantityColumns = vec![Vec::with_capacity(designs.len()); self.quantities.len()];
        let mut holding = Vec::with_capacity(designs.len());
        for block in designs.chunks(BLOCK) {
            for row in certify::rows(plan, &self.columns, block, threads, control)? {
                holding.push(row.feasible);
                self.take(Some(&row), &mut values);
            }
        }
        Ok((values, holding))
    }
}
