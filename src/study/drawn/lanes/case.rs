//! One operating case of a draw: what all designs share, then what differs.

use super::super::super::quantity::Quantity;
use super::super::super::resolved::Constraint;
use super::super::drive::DrawnDrive;
use super::super::tracks::Track;
use super::{DrawnLanes, Parts};
use crate::masks::{any, keep_between, keep_margin};
use crate::models::Columns;

impl DrawnLanes {
    /// Computes the drive in a case and takes it in; false if nothing of the draw is open any more.
    pub(super) fn take_case(&mut self, kernel: &DrawnDrive, (draw, case, place): (usize, usize, usize), count: usize) -> bool {
        // What all designs share comes first: where it fails, the designs need not be looked at.
        self.compute_row(kernel, (draw, case, place));
        if self.judge_row(kernel, count) && !self.is_open(count) {
            return false;
        }
        if !self.results.is_empty() {
            self.take_lanes(kernel, place, count);
        }
        let place = kernel.cases.weights.as_ref().map(|it| it.places[case]);
        let mut folds = std::mem::take(&mut self.folds);
        for fold in &mut folds {
            let place = place.filter(|_| !fold.asked.over.is_worst());
            let quantity = fold.asked.quantity;
            self.with_values(kernel, quantity, count, &mut |values| fold.take(values, place));
        }
        self.folds = folds;
        self.is_open(count)
    }

    /// Computes what all designs share.
    fn compute_row(&mut self, kernel: &DrawnDrive, (draw, case, place): (usize, usize, usize)) {
        let Self { of_row: Parts { outputs, conditions }, row_outputs, row_margins, .. } = self;
        if let Some((_, Some(list))) = self.list.as_mut().filter(|_| self.is_listed) {
            let mut numbers = list.turn(kernel, &self.varying, (draw, case)).iter();
            outputs.iter().zip(&mut numbers).for_each(|(&output, &value)| row_outputs[output] = value);
            conditions.iter().zip(numbers).for_each(|(&condition, &margin)| row_margins[condition] = margin);
            return;
        }
        let (base, prepared) = (&kernel.base, &self.prepared[place]);
        if !outputs.is_empty() {
            base.kernel.finish(prepared, &self.si, outputs.iter().collect(), row_outputs);
        }
        if !conditions.is_empty() {
            base.kernel.conditions(prepared, &self.si, row_margins);
        }
    }

    /// Judges what all designs share; true if something of it fails.
    fn judge_row(&mut self, kernel: &DrawnDrive, count: usize) -> bool {
        let base = &kernel.base;
        let mut fails = false;
        for at in 0..self.of_row.conditions.len() {
            let number = self.of_row.conditions[at];
            let margin = self.row_margins[number];
            if !(margin > 0.0 || (margin == 0.0 && !base.conditions[number].strict)) {
                self.fail(number, count, &|mask| mask.fill(0));
                fails = true;
            }
        }
        let broken = |constraint: &Constraint| self.shared(kernel, constraint.quantity).is_some_and(|value| !keeps(constraint, value));
        if self.judged(kernel).any(broken) {
            self.holds[..count].fill(0);
            fails = true;
        }
        for at in 0..self.tracks.len() {
            if let Some(constraint) = self.kept_by_case(at)
                && self.shared(kernel, constraint.quantity).is_some_and(|value| !keeps(&constraint, value))
                && let Track::Keeping { kept, .. } = &mut self.tracks[at]
            {
                kept[..count].fill(0);
                fails = true;
            }
        }
        fails
    }

    /// Computes and judges what differs between the designs.
    fn take_lanes(&mut self, kernel: &DrawnDrive, place: usize, count: usize) {
        let base = &kernel.base;
        let Parts { outputs, conditions } = &self.of_lanes;
        if let Some((_, Some(list))) = self.list.as_mut().filter(|_| self.is_listed) {
            list.run(&self.varying, count, &mut self.results);
        } else {
            let asked = Columns { count, varying: &self.varying, outputs, conditions };
            base.kernel.finish_columns(&self.prepared[place], &self.si, &asked, &mut self.scratch, &mut self.results);
            asked.to_units(&base.outputs, &mut self.results);
        }
        let first = outputs.len();
        for at in 0..self.of_lanes.conditions.len() {
            let number = self.of_lanes.conditions[at];
            let margins = std::mem::take(&mut self.results[first + at]);
            self.fail(number, count, &|mask| keep_margin(mask, &margins, base.conditions[number].strict));
            self.results[first + at] = margins;
        }
        let mut holds = std::mem::take(&mut self.holds);
        for constraint in self.judged(kernel) {
            if self.shared(kernel, constraint.quantity).is_none() {
                let (low, high) = constraint.ends();
                self.with_values(kernel, constraint.quantity, count, &mut |values| keep_between(&mut holds[..count], values, low, high));
            }
        }
        self.holds = holds;
        for at in 0..self.tracks.len() {
            let Some(constraint) = self.kept_by_case(at).filter(|it| self.shared(kernel, it.quantity).is_none()) else { continue };
            let (low, high) = constraint.ends();
            let mut track = std::mem::replace(&mut self.tracks[at], Track::Idle);
            if let Track::Keeping { kept, .. } = &mut track {
                self.with_values(kernel, constraint.quantity, count, &mut |values| keep_between(&mut kept[..count], values, low, high));
            }
            self.tracks[at] = track;
        }
    }

    /// Constraints that every case of a draw must keep to hold.
    fn judged<'k>(&self, kernel: &'k DrawnDrive) -> impl Iterator<Item = &'k Constraint> + use<'k> {
        let counts = self.counts;
        kernel.holds.iter().filter(move |it| counts && it.over.is_worst())
    }

    /// The constraint of a track that must be kept in every case.
    fn kept_by_case(&self, track: usize) -> Option<Constraint> {
        match &self.tracks[track] {
            Track::Keeping { constraint, folds: None, .. } => Some(*constraint),
            _ => None,
        }
    }

    /// A condition takes away the status, and outputs: `keep` clears the masks of the designs where it fails.
    fn fail(&mut self, number: usize, count: usize, keep: &dyn Fn(&mut [u64])) {
        let Self { takes, holds, folds, tracks, .. } = self;
        let takes = &takes[number];
        if takes.holds {
            keep(&mut holds[..count]);
        }
        takes.folds.iter().for_each(|&it| keep(&mut folds[it].present[..count]));
        for &track in &takes.tracks {
            if let Track::Keeping { kept, .. } = &mut tracks[track] {
                keep(&mut kept[..count]);
            }
        }
    }

    /// The value of a quantity in the current draw and case, in its unit, if all designs share it.
    fn shared(&self, kernel: &DrawnDrive, quantity: Quantity) -> Option<f64> {
        let base = &kernel.base;
        match quantity {
            Quantity::Output(output) => {
                let differs = self.of_lanes.outputs.contains(&output);
                (!differs).then(|| base.outputs[output].unit.from_si(self.row_outputs[output]))
            }
            Quantity::Input(input) => {
                let differs = self.varying.iter().any(|it| it.0 == input);
                (!differs).then(|| base.inputs[input].unit.from_si(self.si[input]))
            }
        }
    }

    /// The values of a quantity, as a column.
    fn with_values(&mut self, kernel: &DrawnDrive, quantity: Quantity, count: usize, take: &mut dyn FnMut(&[f64])) {
        if let Some(shared) = self.shared(kernel, quantity) {
            self.same[..count].fill(shared);
        } else if let Quantity::Input(input) = quantity
            && let Some((_, column)) = self.varying.iter().find(|it| it.0 == input)
        {
            let unit = kernel.base.inputs[input].unit;
            self.same.iter_mut().zip(column).for_each(|(to, value)| *to = unit.from_si(*value));
        } else if let Some(at) = quantity.output().and_then(|output| self.of_lanes.outputs.iter().position(|it| *it == output)) {
            return take(&self.results[at][..count]);
        }
        take(&self.same[..count]);
    }

    /// Can any of the draws' cases that are left still change what is asked?
    fn is_open(&self, count: usize) -> bool {
        self.tracks.iter().any(|track| match track {
            Track::Holding(_) => any(&self.holds[..count]),
            Track::Keeping { kept, .. } => any(&kept[..count]),
            Track::Fresh | Track::Idle => false,
            Track::Sum { .. } | Track::Worst { .. } | Track::All { .. } => true,
        })
    }
}

/// Is a value that all designs share within the constraint, as a column of it would be?
fn keeps(constraint: &Constraint, value: f64) -> bool {
    let (low, high) = constraint.ends();
    value >= low && value <= high
}
