//! What is around a design, for a page: the values of objectives and constraints along each axis, all else as it is.
//!
//! The page of a study in work asks for it design by design. The page of a result holds it for the knee only, within bounds that hold on
//! every machine, so that its bytes do too.

use crate::certify::{self, Column, Role};
use crate::error::Result;
use crate::live::around::{PLACES, Slice, around_with, most_designs, sliced};
use crate::live::given::{Given, GivenSlices, given_ranges};
use crate::models::Effort;
use crate::plan::Plan;
use crate::screen::Control;
use crate::study::number;
use serde_json::{Value, json};

/// Seconds of a thread that the slices of a result's page may take, by the model's own figures.
const MOST_SECONDS: f64 = 2.0;
/// Numbers that they may have; each has about 25 bytes with its scenario.
const MOST_NUMBERS: u64 = 20_000;
/// Places along an input, of which the page of a result takes the most that are within these bounds.
const GRAINS: [u64; 4] = [PLACES, 17, 9, 5];

/// Slices as the page draws them. Those over what the study gives come last, and of these what it leaves at defaults.
pub fn told(plan: &Plan, columns: &[Column], slices: &[Slice], given: &GivenSlices) -> Value {
    let study = &plan.study;
    let named = columns.iter().map(|it| json!({ "name": it.name, "unit": it.unit(study), "doc": it.doc(study) }));
    let slices = slices.iter().map(|slice| {
        let lines = (0..columns.len()).map(|at| {
            let of = |it: Option<f64>| it.filter(|it| it.is_finite()).map(number);
            let values = slice.rows.iter().map(|row| of(row.columns[at].value).unwrap_or(Value::Null));
            let scenarios = slice.rows.iter().map(|row| row.columns[at].value.map(|_| row.columns[at].scenario));
            json!({ "values": values.collect::<Vec<_>>(), "scenarios": scenarios.collect::<Vec<_>>() })
        });
        let status = |row: &certify::Row| (row.without_result > 0).then(|| row.status.reason(&study.model).to_owned());
        json!({
            "input": slice.name, "unit": slice.unit, "own": number(slice.own), "words": slice.words,
            "at": slice.values.iter().map(|&it| number(it)).collect::<Vec<_>>(),
            "feasible": slice.rows.iter().map(|row| row.feasible).collect::<Vec<_>>(),
            "status": slice.rows.iter().map(status).collect::<Vec<_>>(), "lines": lines.collect::<Vec<_>>(),
        })
    });
    json!({
        "columns": named.collect::<Vec<_>>(), "slices": slices.collect::<Vec<_>>(),
        "given": given.ranges.len(), "defaults": given.defaults, "given_left_out": given.is_left_out,
    })
}

/// The slices around the knee of a result, or why there are none; `null` if no axis has a slice. `text` is the study's.
///
/// # Errors
/// [`Error::Stopped`](crate::error::Error::Stopped) after `control.stop`.
pub fn of_knee(plan: &Plan, text: &str, knee: u64, threads: usize, control: &Control) -> Result<Value> {
    let axes = sliced(plan).count() as u64;
    if axes == 0 {
        return Ok(Value::Null);
    }
    let columns = certify::columns(&plan.study);
    let judged = columns.iter().filter(|it| it.role != Role::Report).count() as u64;
    let Effort { prepare, finish } = plan.effort();
    #[allow(clippy::cast_precision_loss, reason = "an estimate")]
    let fits = |slices: u64, places: u64| {
        let designs = slices * most_designs(places);
        (prepare + finish) * designs as f64 <= MOST_SECONDS && designs * judged <= MOST_NUMBERS
    };
    let is_proven = columns.iter().any(|it| plan.study.is_proven(it.quantity));
    // Without defaults: formulas that they make longer would take more memory than `check` says.
    let given = Given { defaults: Vec::new(), ..given_ranges(&plan.study, text) };
    let all = axes + given.said.len() as u64;
    let grain = |slices: u64| GRAINS.into_iter().find(|&places| fits(slices, places));
    let Some(places) = grain(all).or_else(|| grain(axes)).filter(|_| !is_proven) else {
        return Ok(json!({ "design": knee.to_string(), "left_out": true }));
    };
    let given = given.as_far_as(|_| fits(all, places));
    let (columns, slices) = around_with(plan, knee, places, &given.ranges, threads, control)?;
    let mut told = told(plan, &columns, &slices, &given);
    told["design"] = knee.to_string().into();
    Ok(told)
}
