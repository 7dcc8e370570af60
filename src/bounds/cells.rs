//! Feasible designs by the cells of a map, counted in boxes.

use super::axes::{Axes, Spans};
use super::count::{BoxCounter, Inside, LARGE, LEAF, SettledBy, instances, reduce, varying};
use super::open::Open;
use crate::plan::Plan;
use crate::study::MapSpec;
use std::sync::atomic::Ordering;

/// Pairs count all cells of a box where they take this much less than all designs: cut into its cells, nearly all would be evaluated.
const CELL_SAVING: f64 = 4.0;

/// The two axes of a map among those of the search.
#[derive(Clone, Copy, Debug)]
pub struct CellAxes {
    x: usize,
    y: usize,
    /// Cells along x.
    width: u64,
}

impl CellAxes {
    /// Those of a map of a plan.
    pub fn new(plan: &Plan, axes: &Axes, spec: &MapSpec) -> Self {
        let place = |axis: usize| {
            let inputs = plan.study.design[axis].inputs();
            axes.all[..axes.designs].iter().position(|it| it.inputs == inputs).expect("maps are over axes of the design")
        };
        let (x, y) = (place(spec.x), place(spec.y));
        Self { x, y, width: axes.all[x].count() }
    }

    /// Both.
    pub fn axes(self) -> [usize; 2] {
        [self.x, self.y]
    }

    /// Both as a bit set.
    pub fn set(self) -> u64 {
        1 << self.x | 1 << self.y
    }

    /// Number of cells that a box has designs in.
    pub fn count(self, spans: &Spans) -> u64 {
        spans[self.x].count() * spans[self.y].count()
    }

    /// These cells, by their number in the map.
    pub fn of(self, spans: &Spans) -> impl Iterator<Item = u64> {
        let (across, width) = (spans[self.x], self.width);
        let rows = spans[self.y].low..=spans[self.y].high;
        rows.flat_map(move |row| (across.low..=across.high).map(move |column| u64::from(row) * width + u64::from(column)))
    }
}

impl BoxCounter<'_> {
    /// Counts the feasible designs of a box by cell: `take` is told of cells and what is to be added there. `None` if it was stopped.
    pub fn count_cells(&mut self, cells: CellAxes, spans: &Spans, open: &[Open], take: &mut dyn FnMut(u64, u64)) -> Option<()> {
        let before = self.pairs.evaluated;
        let counted = self.count_cells_of(cells, spans, open, 1, Inside::Box(1), take);
        self.settled.evaluations += self.pairs.evaluated - before;
        counted
    }

    /// Of a box each of whose feasible designs stands for `each` of the study.
    fn count_cells_of(
        &mut self,
        cells: CellAxes,
        spans: &Spans,
        open: &[Open],
        each: u64,
        inside: Inside,
        take: &mut dyn FnMut(u64, u64),
    ) -> Option<()> {
        let Some((open, pull)) = self.decide(spans, open, inside)? else { return Some(()) };
        let Some(bearing) = self.bearing_on(cells.set(), spans, &open, inside)? else { return Some(()) };
        let (spans, each) = (bearing.spans, each * bearing.each);
        let (open, varying) = (&bearing.open[..], varying(&spans, self.axes));
        // Along an axis of the map that nothing open depends on, all cells have the same count.
        let decisive = open.iter().fold(0, |all, item| all | self.requirements[item.requirement].asked.axis_set());
        let counted = reduce(&spans, !cells.set() | decisive, self.axes);
        let alike = self.axes.count(&spans) / self.axes.count(&counted);
        let inside_alike = bearing.inside.of_each(alike);
        let mut put = |levels: &Spans, count: u64| {
            let mut all = *levels;
            for axis in cells.axes().into_iter().filter(|axis| decisive >> axis & 1 == 0) {
                all[axis] = spans[axis];
            }
            cells.of(&all).for_each(|cell| take(cell, count * each));
        };
        let to_cut = decisive & cells.set() & varying;
        if to_cut == 0 {
            let count = self.count_decided(&counted, bearing.open, &pull, inside_alike)?;
            if count > 0 {
                put(&counted, count);
            }
            return Some(());
        }
        let designs = self.axes.count(&counted);
        let exhaustive = designs as f64 * self.operations_of(open);
        if exhaustive <= LEAF {
            self.settle(SettledBy::Evaluation, designs, inside_alike);
            for (design, _) in self.evaluate(&counted, open).into_iter().enumerate().filter(|(_, alive)| *alive) {
                put(&counted.at(0..self.axes.designs, design as u64), 1);
            }
            return Some(());
        }
        if exhaustive > LARGE && self.count_pairs_by_cell(cells, &counted, open, exhaustive, &mut put) {
            self.settle(SettledBy::Pairs, designs, inside_alike);
            return (!self.stop.load(Ordering::Relaxed)).then_some(());
        }
        let by = |a: &usize, b: &usize| pull[*a].total_cmp(&pull[*b]).then(spans[*a].count().cmp(&spans[*b].count()));
        let axis = cells.axes().into_iter().filter(|axis| to_cut >> axis & 1 == 1).max_by(by).expect("one of them decides");
        spans.halves(axis).iter().try_for_each(|part| self.count_cells_of(cells, part, open, each, bearing.inside, take))
    }

    /// Counts all cells of a box at once as pairs of two groups of axes, the first of which has no axis of the map; false if evaluating its
    /// designs takes less.
    fn count_pairs_by_cell(
        &mut self,
        cells: CellAxes,
        spans: &Spans,
        open: &[Open],
        exhaustive: f64,
        put: &mut dyn FnMut(&Spans, u64),
    ) -> bool {
        let pairing = self.pairing(cells.set(), spans, open, None);
        let Some((pairing, _)) = pairing.filter(|(_, cost)| cost * CELL_SAVING <= exhaustive) else { return false };
        let instances = instances(self.requirements, open, self.axes);
        self.pairs.count_each(&pairing, spans, &instances, put);
        true
    }
}
