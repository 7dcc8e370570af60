//! A map over two design axes: the best of each cell over all other axes, or the feasible share.

use crate::plan::Plan;
use crate::screen::Block;
use crate::space::Product;
use crate::study::{Best, Goal, MapSpec};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Cells above which only those that were met are kept while a chunk is swept.
pub const DENSE: u64 = 1 << 16;

/// What a cell holds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Feasible designs met.
    pub feasible: u64,
    /// Best key (less is better).
    key: f64,
    /// The design that has it, the lowest index of equals.
    pub index: u64,
}

const EMPTY: Cell = Cell { feasible: 0, key: f64::INFINITY, index: u64::MAX };

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Cells {
    All(Vec<Cell>),
    Met(HashMap<u64, Cell, BuildHasherDefault<CellHasher>>),
}

/// Spreads the numbers of cells: nobody chooses them to collide, and the standard hash costs more than all else that a cell takes.
#[derive(Clone, Default)]
struct CellHasher(u64);

impl Hasher for CellHasher {
    fn finish(&self) -> u64 {
        self.0
    }
    fn write(&mut self, _bytes: &[u8]) {
        unreachable!("cells are numbers")
    }
    fn write_u64(&mut self, number: u64) {
        // The golden section, and the high bits, which it mixes best, brought to where the table looks.
        self.0 = number.wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(32);
    }
}

/// The cells of a map, row-major in y, then x.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Map {
    goal: Goal,
    width: u64,
    height: u64,
    x: usize,
    y: usize,
    #[serde(skip)]
    designs: Option<Product>,
    cells: Cells,
}

impl PartialEq for Map {
    fn eq(&self, other: &Self) -> bool {
        (self.goal, self.width, self.height) == (other.goal, other.width, other.height)
            && (0..self.width * self.height).all(|cell| self.cell(cell) == other.cell(cell))
    }
}

impl Cell {
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
        let goal = match spec.value {
            Best::Value(_, goal) => goal,
            Best::Share => Goal::Min,
        };
        let cells =
            if width * height <= DENSE { Cells::All(vec![EMPTY; (width * height) as usize]) } else { Cells::Met(HashMap::default()) };
        Self { goal, width, height, x: spec.x, y: spec.y, designs: Some(plan.space.designs.clone()), cells }
    }

    /// Takes in a block; without a column only the share is counted.
    pub fn absorb(&mut self, block: &Block<'_>, column: Option<usize>) {
        let designs = self.designs.take().expect("a map that takes in blocks was made for a plan");
        for lane in block.feasible() {
            let index = block.index(lane);
            let cell = designs.digit(self.y, index) * self.width + designs.digit(self.x, index);
            let value = column.map_or(0.0, |column| block.values[column][lane]);
            let key = if self.goal == Goal::Min { value } else { -value };
            self.take(cell, Cell { feasible: 1, key: key + 0.0, index });
        }
        self.designs = Some(designs);
    }

    /// Adds feasible designs per cell that were counted elsewhere.
    pub fn add(&mut self, counts: &[u32]) {
        for (at, &count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
            // In a map of shares every key is 0, and which design has it is not asked.
            self.take(at as u64, Cell { feasible: u64::from(count), key: 0.0, index: u64::MAX });
        }
    }

    /// The best key of every cell, infinite where there is none: less is better.
    pub fn keys(&self) -> Vec<f64> {
        (0..self.width * self.height).map(|at| self.cell(at).map_or(f64::INFINITY, |cell| cell.key)).collect()
    }

    fn take(&mut self, at: u64, cell: Cell) {
        match &mut self.cells {
            Cells::All(cells) => cells[at as usize].take(cell),
            Cells::Met(cells) => cells.entry(at).or_insert(EMPTY).take(cell),
        }
    }

    /// Takes in the cells of other designs.
    pub fn merge(&mut self, other: Self) {
        match other.cells {
            Cells::All(cells) => {
                cells.into_iter().zip(0..).filter(|(cell, _)| cell.feasible > 0).for_each(|(cell, at)| self.take(at, cell))
            }
            Cells::Met(cells) => cells.into_iter().for_each(|(at, cell)| self.take(at, cell)),
        }
        // Once most cells have been met a table is smaller than a map of them.
        if let Cells::Met(cells) = &self.cells
            && cells.len() as u64 * 4 > self.width * self.height
        {
            let mut all = vec![EMPTY; (self.width * self.height) as usize];
            cells.iter().for_each(|(&at, &cell)| all[at as usize] = cell);
            self.cells = Cells::All(all);
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
            Cells::Met(cells) => cells.get(&at).copied(),
        };
        cell.filter(|cell| cell.feasible > 0)
    }

    /// The best value of a cell.
    pub fn value(&self, cell: Cell) -> f64 {
        (if self.goal == Goal::Min { cell.key } else { -cell.key }) + 0.0
    }
}
