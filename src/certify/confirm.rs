//! Rows computed together, confirmed by the scalar reference.

use super::reference::Reference;
use super::{Column, DesignColumns, Row, rows_of_columns};
use crate::error::{Error, Result};
use crate::models::Status;
use crate::parallel::on_threads;
use crate::plan::Plan;
use crate::screen::Control;
use crate::study::Axis;
use std::sync::atomic::Ordering;

/// Of so many designs one is computed by the reference in every scenario.
const ONE_OF: usize = 256;

/// The rows of the designs at these positions: computed in columns, and every number of them once more by the scalar reference in the
/// scenario that it is from. `None` where the designs must be computed one by one.
///
/// # Errors
/// [`Error::Stopped`] after `control.stop`; [`Error::Disagreement`] where the two differ in a bit.
pub(super) fn rows_together(
    plan: &Plan,
    columns: &[Column],
    positions: &[u64],
    threads: usize,
    control: &Control,
) -> Option<Result<Vec<Row>>> {
    let inputs: Vec<usize> = plan.study.design.iter().flat_map(Axis::inputs).copied().collect();
    if inputs.is_empty() {
        return None;
    }
    let mut values: Vec<Vec<f64>> = inputs.iter().map(|_| Vec::with_capacity(positions.len())).collect();
    let mut of_design = plan.study.fixed.clone();
    for &position in positions {
        plan.space.designs.set(plan.design_at(position), &mut of_design);
        values.iter_mut().zip(&inputs).for_each(|(column, &input)| column.push(of_design[input]));
    }
    let values: Vec<&[f64]> = values.iter().map(Vec::as_slice).collect();
    let designs = DesignColumns { inputs: &inputs, values: &values };
    let mut rows = match rows_of_columns(plan, columns, designs, threads, control)? {
        Ok(rows) => rows,
        Err(error) => return Some(Err(error)),
    };
    rows.iter_mut().zip(positions).for_each(|(row, &position)| row.index = plan.design_at(position));
    Some(confirm(plan, columns, &rows, threads, control).map(|()| rows))
}

/// Compares rows with the scalar reference.
fn confirm(plan: &Plan, columns: &[Column], rows: &[Row], threads: usize, control: &Control) -> Result<()> {
    let share = rows.len().div_ceil(threads.max(1)).max(1).next_multiple_of(ONE_OF);
    let parts = on_threads(rows.chunks(share), |part| {
        let mut reference = Reference::new(plan, columns, &control.stop);
        for (number, row) in part.iter().enumerate() {
            if control.stop.load(Ordering::Relaxed) {
                return Err(Error::Stopped { kept: None });
            }
            if number % ONE_OF == 0 {
                let whole = reference.row(plan.position_of(row.index)).ok_or(Error::Stopped { kept: None })?;
                if whole != *row {
                    return Err(Error::Disagreement(format!(
                        "design {}: computed together with others it is not what the scalar f64 reference finds: {}",
                        row.index,
                        difference(columns, row, &whole)
                    )));
                }
            }
            confirm_shown(plan, columns, row, &mut reference)?;
        }
        Ok(())
    });
    parts.into_iter().collect()
}

/// Compares what is shown of a design with the reference in the scenarios that it is from.
fn confirm_shown(plan: &Plan, columns: &[Column], row: &Row, reference: &mut Reference<'_>) -> Result<()> {
    let shown = row.columns.iter().filter(|it| it.value.is_some()).map(|it| it.scenario);
    let mut scenarios: Vec<u64> = shown.chain(row.first_without).collect();
    scenarios.sort_unstable();
    scenarios.dedup();
    for scenario in scenarios {
        let (status, value) = reference.at(row.index, scenario);
        for (column, at) in columns.iter().zip(&row.columns).filter(|(_, at)| at.value.is_some() && at.scenario == scenario) {
            let found = value(column.quantity).map(|it| it + 0.0);
            if found.map(f64::to_bits) != at.value.map(f64::to_bits) {
                return Err(Error::Disagreement(format!(
                    "{} of design {} in scenario {scenario}: computed together with others it is {}, by the scalar f64 reference {}",
                    column.name,
                    row.index,
                    in_words(at.value),
                    in_words(found)
                )));
            }
        }
        let asked = plan.tracked.iter().map(|(it, _)| it.quantity).chain(plan.study.constraints.iter().map(|it| it.quantity));
        let has_result = status == Status::Ok && asked.into_iter().all(|quantity| value(quantity).is_some());
        let is_first = row.first_without == Some(scenario);
        let is_before = row.first_without.is_none_or(|first| scenario < first);
        if (is_first && has_result) || (is_before && !has_result) {
            return Err(Error::Disagreement(format!(
                "design {} in scenario {scenario}: the scalar f64 reference finds {} result, computed together with others it has {}",
                row.index,
                if has_result { "a" } else { "no" },
                if has_result { "none" } else { "one" }
            )));
        }
    }
    Ok(())
}

/// In what two rows of a design differ first.
fn difference(columns: &[Column], row: &Row, whole: &Row) -> String {
    for (number, column) in columns.iter().enumerate() {
        let [own, found] = [row, whole].map(|it| (it.columns[number], it.complete[number]));
        if own != found {
            let told = |(at, _): (super::AtWorst, bool)| format!("{} in scenario {}", in_words(at.value), at.scenario);
            return format!("{} is {} and {}", column.name, told(own), told(found));
        }
    }
    if (row.feasible, row.without_result, row.first_without) != (whole.feasible, whole.without_result, whole.first_without) {
        let told = |it: &Row| {
            format!("{} with {} scenarios without a result", if it.feasible { "feasible" } else { "infeasible" }, it.without_result)
        };
        return format!("it is {} and {}", told(row), told(whole));
    }
    "its status or its inputs".to_owned()
}

fn in_words(value: Option<f64>) -> String {
    value.map_or_else(|| "absent".to_owned(), |value| value.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify;
    use crate::study::Study;
    use std::path::Path;

    #[test]
    fn a_row_that_differs_from_the_reference_is_refused() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/metal-cvt.toml");
        let plan = Plan::new(Study::read(&path).expect("it is right").0);
        let columns = certify::columns(&plan.study);
        let control = Control::default();
        let positions: Vec<u64> = plan.space.designs.coarse(600).iter().map(|&design| plan.position_of(design)).collect();
        let rows = rows_together(&plan, &columns, &positions, 2, &control).expect("it can be recorded").expect("nobody stops it");
        assert!(rows.iter().any(|it| it.feasible) && rows.iter().any(|it| !it.feasible));
        let judged = |rows: &[Row]| confirm(&plan, &columns, rows, 2, &control);
        judged(&rows).expect("they agree");
        let refused = |change: &dyn Fn(&mut Row), at: usize| {
            let mut changed = rows.clone();
            change(&mut changed[at]);
            match judged(&changed) {
                Err(Error::Disagreement(said)) => said,
                other => panic!("{other:?}"),
            }
        };
        let another = |row: &mut Row| row.columns[1].value = row.columns[1].value.map(f64::next_up);
        assert!(refused(&another, 5).contains(&format!("stress_margin of design {}", rows[5].index)));
        // A worst scenario that is not the worst is found where every scenario is computed.
        assert!(refused(&|row| row.columns[0].scenario += 1, 0).contains("axial_force_upper_N is "));
        assert!(refused(&|row| row.without_result += 1, ONE_OF).contains("scenarios without a result"));
        let feasible = (0..rows.len()).find(|&at| at % ONE_OF != 0 && rows[at].feasible).expect("there is one");
        assert!(refused(&|row| row.first_without = Some(0), feasible).contains("finds a result"));
        control.stop.store(true, Ordering::Relaxed);
        assert!(matches!(judged(&rows), Err(Error::Stopped { .. })));
    }
}
