//! Cells of a large map that feasible designs have met, square by square: designs that follow each other lie beside each other.

use super::{Cell, EMPTY};
use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};

/// Cells along an edge of a square.
const EDGE: u64 = 8;
const SQUARE: usize = (EDGE * EDGE) as usize;

/// Those cells of a map that were met.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "MetList", into = "MetList")]
pub struct MetCells {
    /// Cells of the map along x.
    width: u64,
    /// By place of the square.
    squares: FxHashMap<(u64, u64), Box<[Cell; SQUARE]>>,
}

/// The same as a checkpoint keeps it: numbers of cells, rising, and the cells.
#[derive(Serialize, Deserialize)]
struct MetList {
    width: u64,
    cells: Vec<(u64, Cell)>,
}

impl MetCells {
    /// None yet, of a map of so many cells along x.
    pub fn new(width: u64) -> Self {
        Self { width, squares: FxHashMap::default() }
    }

    /// Cells along x.
    pub fn width(&self) -> u64 {
        self.width
    }

    /// Cells that there is room for.
    pub fn room(&self) -> u64 {
        (self.squares.len() * SQUARE) as u64
    }

    /// Where a cell, counted row by row, stands: its square, and its place there.
    fn place(&self, at: u64) -> ((u64, u64), usize) {
        let (x, y) = (at % self.width, at / self.width);
        ((y / EDGE, x / EDGE), (y % EDGE * EDGE + x % EDGE) as usize)
    }

    /// A cell, as it is before any design lies in it if none does.
    pub fn get(&self, at: u64) -> Cell {
        let (square, place) = self.place(at);
        self.squares.get(&square).map_or(EMPTY, |cells| cells[place])
    }

    /// The same, to be changed.
    #[inline]
    pub fn at(&mut self, at: u64) -> &mut Cell {
        let (square, place) = self.place(at);
        &mut self.squares.entry(square).or_insert_with(|| Box::new([EMPTY; SQUARE]))[place]
    }

    /// The cells in which feasible designs lie, in no order.
    pub fn cells(&self) -> impl Iterator<Item = (u64, Cell)> + '_ {
        let width = self.width;
        self.squares.iter().flat_map(move |(&(row, column), cells)| {
            let number = move |place: u64| (row * EDGE + place / EDGE) * width + column * EDGE + place % EDGE;
            cells.iter().zip(0..).filter(|(cell, _)| cell.is_met()).map(move |(&cell, place)| (number(place), cell))
        })
    }

    /// Takes in those of another part of the designs.
    pub fn merge(&mut self, other: Self) {
        for (square, cells) in other.squares {
            match self.squares.entry(square) {
                std::collections::hash_map::Entry::Vacant(free) => {
                    free.insert(cells);
                }
                std::collections::hash_map::Entry::Occupied(mut own) => {
                    own.get_mut().iter_mut().zip(*cells).for_each(|(own, other)| own.take(other));
                }
            }
        }
    }
}

impl From<MetList> for MetCells {
    fn from(list: MetList) -> Self {
        let mut met = Self::new(list.width.max(1));
        list.cells.into_iter().for_each(|(at, cell)| *met.at(at) = cell);
        met
    }
}

impl From<MetCells> for MetList {
    fn from(met: MetCells) -> Self {
        let mut cells: Vec<(u64, Cell)> = met.cells().collect();
        cells.sort_unstable_by_key(|(at, _)| *at);
        Self { width: met.width, cells }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::{BTreeMap, BTreeSet};

    #[test]
    fn cells_are_found_merged_and_kept_wherever_they_stand() {
        // Neither edge is a whole number of squares.
        let (width, height) = (1003, 517);
        let numbers = |seed: u64| (0..3000u64).map(move |it| (it * it * 7919 + it * seed) % (width * height));
        let taken = |at: u64, number: u64| Cell { feasible: number % 5, key: f64::from((at * 31 + number) as u16), index: at + number };
        let mut expected: BTreeMap<u64, Cell> = BTreeMap::new();
        let mut parts = [3, 50].map(|seed| {
            let mut met = MetCells::new(width);
            for (at, number) in numbers(seed).zip(0..).chain([(0, 1), (width - 1, 2), (width * height - 1, 3), (width * (height - 1), 4)]) {
                let cell = taken(at, number);
                met.at(at).take(cell);
                expected.entry(at).or_insert(EMPTY).take(cell);
            }
            met
        });
        let [first, second] = &mut parts;
        let mut first = first.clone();
        first.merge(second.clone());
        let found: BTreeMap<u64, Cell> = first.cells().collect();
        assert!(found == expected && found.len() > 4000, "{} cells", found.len());
        assert!((0..width * height).all(|at| first.get(at) == expected.get(&at).copied().unwrap_or(EMPTY)));
        let kept = postcard::to_allocvec(&first).expect("it can be written");
        assert!(postcard::from_bytes::<MetCells>(&kept).expect("it can be read") == first);
        let squares: BTreeSet<(u64, u64)> = expected.keys().map(|at| (at / width / 8, at % width / 8)).collect();
        assert_eq!(first.room(), 64 * squares.len() as u64);
    }
}
