//! Every feasible design, by its number.
//!
//! Numbers are kept packed, as differences of rising ones: a byte or two for each. What a thread or a tile has found is a piece of its own,
//! so that taking it in, and keeping it in a checkpoint, is no more than copying its bytes; the pieces are put in order when they are read.

use super::reducer::{Put, Reducer, ReducerNeeds, ReducerResults, ReducerRoom};
use crate::error::Result;
use crate::plan::Plan;
#[cfg(feature = "pictures")]
use crate::reading::Folder;
use crate::screen::Block;
use crate::study::{Report, Study};
use crate::table::stream::BLOCK_ROWS;
use serde::{Deserialize, Serialize};
#[cfg(feature = "pictures")]
use serde_json::{Map, Value};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Its file.
#[cfg(feature = "parquet")]
pub const FEASIBLE_FILE: &str = "feasible.parquet";
/// Its file.
#[cfg(not(feature = "parquet"))]
pub const FEASIBLE_FILE: &str = "feasible.csv";
/// Numbers that wait to be packed together.
const OPEN: usize = 1 << 16;
/// Bits of a byte that are part of a number; the last one says whether more bytes follow.
const BITS: u32 = 7;

/// Numbers in rising order, none twice: each as its difference to the one before, the first as it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct PackedIndices {
    count: u64,
    bytes: Vec<u8>,
}

impl PackedIndices {
    fn new(mut indices: Vec<u64>) -> Self {
        indices.sort_unstable();
        indices.dedup();
        let (mut bytes, mut last) = (Vec::with_capacity(indices.len()), 0);
        for &index in &indices {
            let mut rest = index - last;
            while rest >> BITS > 0 {
                bytes.push(rest as u8 | 1 << BITS);
                rest >>= BITS;
            }
            bytes.push(rest as u8);
            last = index;
        }
        Self { count: indices.len() as u64, bytes }
    }

    fn read(&self) -> IndexReader<'_> {
        IndexReader { bytes: &self.bytes, last: None }
    }

    /// Are these `count` rising numbers below `designs`? What was read from a checkpoint may have been changed.
    fn fits(&self, designs: u64) -> bool {
        let (mut reader, mut count) = (self.read(), 0);
        for index in reader.by_ref() {
            if index >= designs {
                return false;
            }
            count += 1;
        }
        reader.bytes.is_empty() && count == self.count
    }
}

/// Numbers as they are unpacked; ends early where the bytes are none.
struct IndexReader<'a> {
    bytes: &'a [u8],
    last: Option<u64>,
}

impl Iterator for IndexReader<'_> {
    type Item = u64;

    fn next(&mut self) -> Option<u64> {
        let (mut difference, mut shift) = (0u64, 0);
        loop {
            let (&byte, rest) = self.bytes.split_first()?;
            let bits = u64::from(byte & ((1 << BITS) - 1));
            if shift >= u64::BITS || bits << shift >> shift != bits {
                return None;
            }
            difference |= bits << shift;
            if byte >> BITS == 0 {
                // A number that does not rise is no number of a design.
                let index = self.last.map_or(Some(difference), |last| last.checked_add(difference).filter(|_| difference > 0))?;
                (self.bytes, self.last) = (rest, Some(index));
                return Some(index);
            }
            self.bytes = rest;
            shift += BITS;
        }
    }
}

/// The numbers of all feasible designs so far.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct FeasibleList {
    pieces: Vec<PackedIndices>,
    /// Not packed yet.
    #[serde(skip)]
    open: Vec<u64>,
}

impl PartialEq for FeasibleList {
    fn eq(&self, other: &Self) -> bool {
        self.closed().indices().eq(other.closed().indices())
    }
}

impl FeasibleList {
    fn push(&mut self, index: u64) {
        self.open.push(index);
        if self.open.len() >= OPEN {
            self.close();
        }
    }

    fn close(&mut self) {
        if !self.open.is_empty() {
            self.pieces.push(PackedIndices::new(std::mem::take(&mut self.open)));
        }
    }

    fn closed(&self) -> Self {
        let mut own = self.clone();
        own.close();
        own
    }

    /// The numbers in rising order, each once; of a list that a sweep has ended with.
    pub fn indices(&self) -> impl Iterator<Item = u64> + '_ {
        let mut cursor = self.cursor();
        std::iter::from_fn(move || self.next(&mut cursor))
    }

    /// A place before the first number.
    pub fn cursor(&self) -> FeasibleCursor {
        let mut cursor = FeasibleCursor { pieces: vec![(0, None); self.pieces.len()], next: BinaryHeap::new(), last: None };
        for piece in 0..self.pieces.len() {
            let first = self.read(piece, &mut cursor);
            cursor.next.extend(first.map(|index| Reverse((index, piece))));
        }
        cursor
    }

    /// The next number from a place of this list, which moves on.
    pub fn next(&self, cursor: &mut FeasibleCursor) -> Option<u64> {
        loop {
            let Reverse((index, piece)) = cursor.next.pop()?;
            let following = self.read(piece, cursor);
            cursor.next.extend(following.map(|index| Reverse((index, piece))));
            // The same design may come twice, when a comparison merges what it has merged before.
            if cursor.last.replace(index) != Some(index) {
                return Some(index);
            }
        }
    }

    fn read(&self, piece: usize, cursor: &mut FeasibleCursor) -> Option<u64> {
        let bytes = &self.pieces[piece].bytes;
        let (read, last) = &mut cursor.pieces[piece];
        let mut reader = IndexReader { bytes: bytes.get(*read..)?, last: *last };
        let index = reader.next()?;
        (*read, *last) = (bytes.len() - reader.bytes.len(), Some(index));
        Some(index)
    }
}

/// A place in a list of designs, which holds on to nothing of it.
#[derive(Clone, Debug)]
pub struct FeasibleCursor {
    /// Of each piece: bytes that were read, and the last number.
    pieces: Vec<(usize, Option<u64>)>,
    /// The next number of each piece that has one.
    next: BinaryHeap<Reverse<(u64, usize)>>,
    last: Option<u64>,
}

impl Reducer for FeasibleList {
    const STATE: &'static str = "list of feasible designs";

    fn asked(plan: &Plan, _ranges: &[(f64, f64)]) -> Vec<Self> {
        if plan.study.report.feasible { vec![Self::default()] } else { Vec::new() }
    }

    fn needs(report: &Report) -> Option<ReducerNeeds> {
        report.feasible.then_some(ReducerNeeds::Designs("feasible in [report] asks for every feasible design"))
    }

    fn absorb(&mut self, block: &Block<'_>) {
        for lane in block.feasible() {
            self.push(block.index(lane));
        }
    }

    fn merge(&mut self, mut other: Self) {
        self.pieces.append(&mut other.pieces);
        other.open.into_iter().for_each(|index| self.push(index));
    }

    fn state(&self) -> Self {
        self.closed()
    }

    fn fits(&self, _asked: &Self, met: u64, designs: u64) -> bool {
        let few = self.pieces.iter().fold(0, |sum: u64, piece| sum.saturating_add(piece.count)) <= met;
        few && self.open.is_empty() && self.pieces.iter().all(|piece| piece.fits(designs))
    }

    fn lacks(&self, fuller: &Self) -> Option<(&'static str, u64)> {
        let (own, fuller) = (self.closed(), fuller.closed());
        let mut own = own.indices().peekable();
        let missing = fuller.indices().find(|index| {
            while own.next_if(|it| it < index).is_some() {}
            own.peek() != Some(index)
        });
        missing.map(|index| ("list of feasible designs", index))
    }

    fn files(study: &Study) -> Vec<String> {
        if study.report.feasible { vec![FEASIBLE_FILE.to_owned()] } else { Vec::new() }
    }

    fn is_file(name: &str) -> bool {
        // Of either kind of build.
        ["feasible.parquet", "feasible.csv"].contains(&name)
    }

    /// Its file has more rows than fit into the memory: whoever writes the result writes it block by block.
    fn write(&self, _results: &ReducerResults<'_>, _put: &mut Put<'_>) -> Result<()> {
        Ok(())
    }

    #[cfg(feature = "pictures")]
    fn page(folder: &Folder<'_>, data: &mut Map<String, Value>) -> Result<()> {
        if folder.plan.study.report.feasible {
            let file = folder.path.join(FEASIBLE_FILE);
            crate::files::open(&file).map_err(|source| crate::reading::missing(&file, crate::Error::io(&file)(source)))?;
            data.insert("feasible_file".to_owned(), FEASIBLE_FILE.into());
        }
        Ok(())
    }

    fn room(plan: &Plan) -> ReducerRoom {
        if !plan.study.report.feasible {
            return ReducerRoom::default();
        }
        // Numbers that rise take a byte each where they lie close, and where they do not there are fewer of them.
        let designs = plan.designs();
        let numbers = plan.study.row_numbers();
        ReducerRoom {
            packed: designs,
            rows: designs.min(BLOCK_ROWS as u64),
            files: vec![(FEASIBLE_FILE.to_owned(), designs.saturating_mul(numbers))],
            ..ReducerRoom::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::mix;

    fn list(indices: impl IntoIterator<Item = u64>) -> FeasibleList {
        let mut list = FeasibleList::default();
        indices.into_iter().for_each(|index| list.push(index));
        list
    }

    #[test]
    fn numbers_come_back_in_order_whatever_the_pieces() {
        let all: Vec<u64> = (0..200_000u64).map(|it| it * 3 + mix(it) % 3).chain([u64::MAX - 1, u64::MAX]).collect();
        let mut parts = FeasibleList::default();
        for part in 0..5 {
            // Some are there twice, as after a comparison.
            parts.merge(list(all.iter().copied().enumerate().filter(|(at, _)| at % 5 == part || at % 77 == 0).map(|(_, it)| it)));
        }
        let kept = parts.state();
        assert!(kept.indices().eq(all.iter().copied()));
        let bytes = postcard::to_stdvec(&kept).expect("it can be written");
        assert!(bytes.len() < 2 * all.len(), "{} bytes for {} numbers", bytes.len(), all.len());
        let read: FeasibleList = postcard::from_bytes(&bytes).expect("it was written so");
        assert!(read == kept && !read.fits(&kept, u64::MAX, u64::MAX), "the last number is no design of so few");
        assert_eq!(parts.lacks(&kept), None);
        assert_eq!(list(all[..9].iter().copied()).lacks(&list(all[..10].iter().copied())), Some((FeasibleList::STATE, all[9])));
        assert_eq!(list([1, 2]).lacks(&list([0, 1, 2])), Some((FeasibleList::STATE, 0)));
    }

    #[test]
    fn a_changed_state_is_noticed() {
        let good = list([5, 6, 300]).state();
        let fits = |list: &FeasibleList| list.fits(&good, 3, 301);
        assert!(fits(&good) && !good.fits(&good, 2, 301) && !good.fits(&good, 3, 300));
        let spoilt = |spoil: fn(&mut PackedIndices)| {
            let mut other = good.clone();
            spoil(&mut other.pieces[0]);
            fits(&other)
        };
        assert!(!spoilt(|it| it.count += 1) && !spoilt(|it| it.bytes.truncate(3)) && !spoilt(|it| it.bytes.push(0)));
        assert!(!spoilt(|it| it.bytes = vec![255; 20]) && !spoilt(|it| it.bytes[1] = 0), "a number twice, or one that never ends");
    }
}
