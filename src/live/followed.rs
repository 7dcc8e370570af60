//! What a search follows of a study: the worst values that its columns come from, without the bounds that designs are held against later.

use crate::certify::Column;
use crate::plan::{Plan, Tracked};
use crate::study::Study;

/// The worst values that the columns of some roles come from, without what a study confirms with fresh draws, which is no output of the sweep.
pub(super) fn followed(plan: &Plan, columns: &[Column], is_wanted: impl Fn(&Column) -> bool) -> Vec<Tracked> {
    let is_output = |column: &&Column| plan.study.confirmed(column.quantity).is_none() && is_wanted(column);
    columns.iter().filter(is_output).flat_map(Column::followed).collect()
}

/// Of each column: where the values that it comes from stand among those that a plan follows.
pub(super) fn places_of(plan: &Plan, columns: &[Column]) -> Vec<Vec<usize>> {
    let place = |wanted: &Tracked| plan.tracked.iter().position(|(it, _)| it == wanted);
    columns.iter().map(|column| column.followed().iter().filter_map(place).collect()).collect()
}

/// The study without the bounds of constraints that have one: the worst value is the same whatever the bound is, so that designs are held
/// against it later. Of two bounds the worst value depends on both.
pub(super) fn without_bounds(study: &Study) -> Study {
    let mut free = study.clone();
    for constraint in free.constraints.iter_mut().filter(|it| it.over.is_worst()) {
        match (&mut constraint.low, &mut constraint.high) {
            (Some(low), None) => *low = (f64::MIN, false),
            (None, Some(high)) => *high = (f64::MAX, false),
            _ => {}
        }
    }
    free
}
