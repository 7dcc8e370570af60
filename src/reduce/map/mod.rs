//! A map over two design axes: the best of each cell over all other axes, or the feasible share.

mod files;
mod met;
#[cfg(feature = "pictures")]
mod page;
#[cfg(feature = "pictures")]
mod picture;
mod shown;
#[cfg(feature = "pictures")]
mod stripes;

pub use files::{CSV_CELLS, cells, contours, contours_name, names};

use self::met::MetCells;
use super::Answers;
use super::reducer::{Put, Reducer, ReducerNeeds, ReducerResults, ReducerRoom};
use crate::error::Result;
use crate::plan::Plan;
#[cfg(feature = "pictures")]
use crate::reading::Folder;
use crate::screen::{Block, SortedRow};
use crate::space::Product;
use crate::study::{Best, Goal, MapSpec, Report, Study};
use serde::{Deserialize, Serialize};
#[cfg(feature = "pictures")]
use serde_json::Value;

/// Cells above which only squares with a cell that was met are kept while a chunk is swept.
const DENSE: u64 = 1 << 16;

/// What a cell holds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// In a map of shares: feasible designs met.
    pub feasible: u64,
    /// Best key (less is better).
    key: f64,
    /// In a map of the best: the design that has it, the lowest index of equals.
    pub index: u64,
}

const EMPTY: Cell = Cell { feasible: 0, key: f64::INFINITY, index: u64::MAX };

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Cells {
    All(Vec<Cell>),
    Met(MetCells),
}

/// The cells of a map, row-major in y, then x.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Map {
    goal: Goal,
    width: u64,
    height: u64,
    x: usize,
    y: usize,
    /// Where the values that it shows are among those of a block; none in a map of shares.
    #[serde(skip)]
    column: Option<usize>,
    /// The grid that the cells are of; none where it was read from a checkpoint.
    #[serde(skip)]
    designs: Option<Product>,
    /// Where the designs of a row lie, once whole rows come.
    #[serde(skip)]
    lanes: Option<LaneCells>,
    cells: Cells,
}

impl PartialEq for Map {
    fn eq(&self, other: &Self) -> bool {
        (self.goal, self.width, self.height) == (other.goal, other.width, other.height)
            && (0..self.width * self.height).all(|cell| self.cell(cell) == other.cell(cell))
    }
}

/// Where the designs of a row lie.
#[derive(Clone, Debug)]
struct LaneCells {
    /// What each lane adds to the row's cell; empty where all designs of a row lie in one.
    cells: Vec<u32>,
    /// In a map of shares: the cell of the last rows, and how many feasible designs each of their lanes has had.
    row_cell: u64,
    counts: Vec<u64>,
}

impl Cell {
    /// Does a feasible design lie in it?
    fn is_met(&self) -> bool {
        self.feasible > 0 || self.index < u64::MAX
    }

    /// Adds feasible designs, in a map of shares: every key is 0, and which design has it is not asked.
    fn add(&mut self, count: u64) {
        self.feasible += count;
        self.key = 0.0;
    }

    /// Is its best, if it has one, surely better than a design of this key, whose index is this one at least?
    #[inline]
    fn beats(&self, key: f64, least_index: u64) -> bool {
        self.key < key || self.key == key && self.index < least_index
    }

    fn take(&mut self, other: Self) {
        self.feasible += other.feasible;
        if other.key < self.key || (other.key == self.key && other.index < self.index) {
            (self.key, self.index) = (other.key, other.index);
        }
    }
}

impl Map {
    /// An empty map.
    pub fn new(plan: &Plan, spec: &MapSpec) -> Self {
        let (width, height) = (plan.study.design[spec.x].count(), plan.study.design[spec.y].count());
        let (goal, column) = match spec.value {
            Best::Value(quantity, goal) => (goal, Some(plan.position(quantity, goal.worse()))),
            Best::Share => (Goal::Min, None),
        };
        let cells =
            if width * height <= DENSE { Cells::All(vec![EMPTY; (width * height) as usize]) } else { Cells::Met(MetCells::new(width)) };
        Self { goal, width, height, x: spec.x, y: spec.y, column, designs: Some(plan.space.designs.clone()), lanes: None, cells }
    }

    /// The best key of every cell, infinite where there is none: less is better.
    pub fn keys(&self) -> Vec<f64> {
        (0..self.width * self.height).map(|at| self.cell(at).map_or(f64::INFINITY, |cell| cell.key)).collect()
    }

    fn take(&mut self, at: u64, cell: Cell) {
        match &mut self.cells {
            Cells::All(cells) => cells[at as usize].take(cell),
            Cells::Met(cells) => cells.at(at).take(cell),
        }
    }

    /// Number of cells along x and y.
    pub fn size(&self) -> (u64, u64) {
        (self.width, self.height)
    }

    /// A cell, counted row by row; `None` if no feasible design lies in it.
    pub fn cell(&self, at: u64) -> Option<Cell> {
        let cell = match &self.cells {
            Cells::All(cells) => cells.get(at as usize).copied(),
            Cells::Met(cells) => (at < self.width * self.height).then(|| cells.get(at)),
        };
        cell.filter(Cell::is_met)
    }

    /// Is the best of a cell surely better than a design of this key, whose index is this one at least?
    pub(crate) fn beats(&self, at: u64, key: f64, least_index: u64) -> bool {
        self.cell(at).is_some_and(|cell| cell.beats(key, least_index))
    }

    /// Adds feasible designs of a cell that were counted elsewhere, in a map of shares.
    pub(crate) fn add_feasible(&mut self, at: u64, count: u64) {
        match &mut self.cells {
            Cells::All(cells) => cells[at as usize].add(count),
            Cells::Met(cells) => cells.at(at).add(count),
        }
    }

    /// The cell of a design; of parts of its index, what they add to it.
    fn cell_of(&self, index: u64) -> u64 {
        let designs = self.designs.as_ref().expect("a map that takes in designs was made for a plan");
        designs.digit(self.y, index) * self.width + designs.digit(self.x, index)
    }

    /// Where the designs of a row lie: the same in every row but for the row's own cell.
    fn lane_cells(&self, row: &SortedRow<'_>) -> LaneCells {
        let mut cells: Vec<u32> = row.offsets().map(|offset| self.cell_of(offset) as u32).collect();
        if cells.iter().all(|&cell| cell == 0) {
            cells.clear();
        }
        LaneCells { row_cell: 0, counts: vec![0; if self.column.is_none() { cells.len() } else { 0 }], cells }
    }

    /// Adds the feasible designs that each lane has had to their cells.
    fn add_lanes(&mut self, lanes: &mut LaneCells) {
        for (count, &cell) in lanes.counts.iter_mut().zip(&lanes.cells).filter(|(count, _)| **count > 0) {
            self.add_feasible(lanes.row_cell + u64::from(cell), *count);
            *count = 0;
        }
    }

    /// Takes in designs of a row that lie in one cell. The best of them is at an end, if they have an order.
    fn absorb_one_cell(&mut self, row: &mut SortedRow<'_>, at: u64) {
        let Some(column) = self.column else { return self.add_feasible(at, row.count() as u64) };
        let best = row.ends(column).map(|(first, last)| self.goal.key(first).min(self.goal.key(last)));
        if best.is_some_and(|best| self.beats(at, best, row.row_index())) {
            return;
        }
        for place in 0..row.count() {
            let key = self.goal.key(row.values(column)[place]);
            if best.is_none_or(|best| key == best) {
                self.take(at, Cell { feasible: 0, key, index: row.index(place) });
            }
        }
    }

    /// The best value of a cell.
    pub fn value(&self, cell: Cell) -> f64 {
        self.goal.key(cell.key)
    }
}

impl Reducer for Map {
    const STATE: &'static str = "maps";

    fn asked(plan: &Plan, _ranges: &[(f64, f64)]) -> Vec<Self> {
        plan.study.report.maps.iter().map(|spec| Self::new(plan, spec)).collect()
    }

    fn needs(report: &Report) -> Option<ReducerNeeds> {
        (!report.maps.is_empty()).then_some(ReducerNeeds::Counts)
    }

    fn absorb(&mut self, block: &Block<'_>) {
        for lane in block.feasible() {
            let index = block.index(lane);
            let cell = self.cell_of(index);
            let Some(column) = self.column else {
                self.add_feasible(cell, 1);
                continue;
            };
            // Not counted: bounds may meet it more than once.
            let key = self.goal.key(block.values[column][lane]);
            self.take(cell, Cell { feasible: 0, key, index });
        }
    }

    fn absorb_row(&mut self, row: &mut SortedRow<'_>) {
        let row_cell = self.cell_of(row.row_index());
        let mut lanes = self.lanes.take().unwrap_or_else(|| self.lane_cells(row));
        if lanes.cells.is_empty() {
            self.absorb_one_cell(row, row_cell);
        } else if let Some(column) = self.column {
            let (goal, least_index, designs) = (self.goal, row.row_index(), row.designs(column));
            let take = |cell: &mut Cell, (lane, value): (u16, f64)| {
                let key = goal.key(value);
                if !cell.beats(key, least_index) {
                    cell.take(Cell { feasible: 0, key, index: designs.index(lane) });
                }
            };
            let all = designs.lanes.iter().copied().zip(designs.values.iter().copied());
            let with_cells = all.map(|it| (row_cell + u64::from(lanes.cells[usize::from(it.0)]), it));
            match &mut self.cells {
                Cells::All(cells) => with_cells.for_each(|(at, it)| take(&mut cells[at as usize], it)),
                Cells::Met(cells) => with_cells.for_each(|(at, it)| take(cells.at(at), it)),
            }
        } else {
            if lanes.row_cell != row_cell {
                self.add_lanes(&mut lanes);
                lanes.row_cell = row_cell;
            }
            row.count_lanes(&mut lanes.counts);
        }
        self.lanes = Some(lanes);
    }

    fn end_rows(&mut self) {
        if let Some(mut lanes) = self.lanes.take() {
            self.add_lanes(&mut lanes);
            self.lanes = Some(lanes);
        }
    }

    fn absorb_counted(&mut self, block: &Block<'_>) {
        if self.column.is_some() {
            self.absorb(block);
        }
    }

    fn merge(&mut self, other: Self) {
        debug_assert!(other.lanes.is_none_or(|it| it.counts.iter().all(|count| *count == 0)), "rows that were not ended");
        match (&mut self.cells, other.cells) {
            (_, Cells::All(cells)) => {
                cells.into_iter().zip(0..).filter(|(cell, _)| cell.is_met()).for_each(|(cell, at)| self.take(at, cell))
            }
            (Cells::Met(own), Cells::Met(cells)) => own.merge(cells),
            (Cells::All(own), Cells::Met(cells)) => cells.cells().for_each(|(at, cell)| own[at as usize].take(cell)),
        }
        // Once there is room for a quarter of the cells a table takes little more, and is quicker.
        if let Cells::Met(cells) = &self.cells
            && cells.room() * 4 > self.width * self.height
        {
            let mut all = vec![EMPTY; (self.width * self.height) as usize];
            cells.cells().for_each(|(at, cell)| all[at as usize] = cell);
            self.cells = Cells::All(all);
        }
    }

    fn fits(&self, asked: &Self, met: u64, designs: u64) -> bool {
        let place = |it: &Self| (it.goal, it.width, it.height, it.x, it.y);
        let size = asked.width * asked.height;
        let possible = |cell: Cell| !cell.key.is_nan() && (cell.index < designs || cell.index == u64::MAX);
        let (inside, cells): (bool, Box<dyn Iterator<Item = Cell>>) = match &self.cells {
            Cells::All(cells) => (cells.len() as u64 == size, Box::new(cells.iter().copied())),
            Cells::Met(cells) => {
                let fits = cells.width() == self.width && cells.cells().all(|(at, _)| at < size);
                (fits, Box::new(cells.cells().map(|(_, cell)| cell)))
            }
        };
        let mut sum = 0u64;
        let mut good = cells.map(|cell| {
            sum = sum.saturating_add(cell.feasible);
            possible(cell) && sum <= met
        });
        place(self) == place(asked) && inside && good.all(|good| good)
    }

    fn size(&self) -> u64 {
        (self.width * self.height).min(DENSE)
    }

    /// In a map of shares, its cells; the best of a cell comes back with the survivors.
    fn count_words(&self) -> usize {
        if self.column.is_some() { 0 } else { (self.width * self.height) as usize }
    }

    fn add_counts(&mut self, counts: &[u32]) {
        for (at, &count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
            self.add_feasible(at as u64, count.into());
        }
    }

    fn tell(&mut self, answers: &mut Answers) {
        if self.column.is_some() {
            answers.cells.push(self.keys());
        }
    }

    fn miscounts(&self, other: &Self) -> Option<(&'static str, u64, u64)> {
        let count = |map: &Self, at| map.cell(at).map_or(0, |cell| cell.feasible);
        let mut cells = (0..if self.column.is_some() { 0 } else { self.width * self.height }).map(|at| (count(self, at), count(other, at)));
        cells.find(|(own, other)| own != other).map(|(own, other)| ("feasible designs in a map's cell", own, other))
    }

    fn lacks(&self, fuller: &Self) -> Option<(&'static str, u64)> {
        // Of shares only the counts are reported.
        let cells = 0..if self.column.is_some() { self.width * self.height } else { 0 };
        let best = |map: &Self, at| map.cell(at).map(|cell| (map.value(cell).to_bits(), cell.index));
        let at = cells.into_iter().find(|&at| best(fuller, at) != best(self, at))?;
        Some(("map", best(fuller, at).map_or(0, |(_, index)| index)))
    }

    fn files(study: &Study) -> Vec<String> {
        files::all(study)
    }

    fn is_file(name: &str) -> bool {
        files::is_file(name)
    }

    fn write(&self, results: &ReducerResults<'_>, put: &mut Put<'_>) -> Result<()> {
        files::write(self, results, put)
    }

    #[cfg(feature = "pictures")]
    fn page(folder: &Folder<'_>, data: &mut serde_json::Map<String, Value>) -> Result<()> {
        page::maps(folder, data)
    }

    fn room(plan: &Plan) -> ReducerRoom {
        files::room(&plan.study)
    }
}
