//! A sample of the feasible designs: the first so many of a shuffled order of all designs.
//!
//! The order depends on the seed and the design index alone, so a design need only be asked for its own place in it, whoever judges it
//! and whatever was judged before. What is kept are the feasible designs of least place: the same ones however a sweep is cut, and any
//! that ends early is still a fair sample of what it has seen.

use super::Answers;
use super::reducer::{Put, Reducer, ReducerNeeds, ReducerResults, ReducerRoom};
use crate::error::Result;
use crate::names::MOST_DOTS;
use crate::plan::Plan;
#[cfg(feature = "pictures")]
use crate::reading::{Folder, sample};
use crate::sample::mix;
use crate::screen::Block;
use crate::study::{Report, Study};
use crate::table::csv;
#[cfg(feature = "parquet")]
use crate::table::parquet;
use multiversion::multiversion;
use serde::{Deserialize, Serialize};
#[cfg(feature = "pictures")]
use serde_json::{Map, Value};
use std::ops::RangeInclusive;

/// Its files.
const FILES: [&str; 2] = ["sample.csv", "sample.parquet"];
/// Rounds of the shuffle. With four of them, and hashes that nobody can tell from random functions, nobody can tell the order from a
/// random one (Luby and Rackoff, 1988).
pub const ROUNDS: usize = 4;

/// A shuffled order of all numbers of 64 bits, by a seed. A Feistel network: each round adds a hash of one half to the other, so no two
/// numbers have the same place, and halves of 32 bits are what devices count with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shuffle {
    /// One key a round.
    pub keys: [u32; ROUNDS],
}

impl Shuffle {
    /// The order of a seed.
    pub fn new(seed: u64) -> Self {
        let mut state = seed;
        let keys = std::array::from_fn(|_| {
            state = mix(state.wrapping_add(0x9e37_79b9_7f4a_7c15));
            (state >> 32) as u32
        });
        Self { keys }
    }

    /// The place of a number in the order.
    #[inline(always)]
    pub fn place(self, number: u64) -> u64 {
        let (mut high, mut low) = ((number >> 32) as u32, number as u32);
        for key in self.keys {
            (high, low) = (low, high ^ hash(low ^ key));
        }
        u64::from(high) << 32 | u64::from(low)
    }

    /// Which of the designs `row_index + offset` have their places in a range: `take` is told where they stand among the offsets.
    pub fn each_within(self, places: &RangeInclusive<u64>, row_index: u64, offsets: &[u64], mut take: impl FnMut(usize)) {
        let mut found = [0; CHUNK];
        for (number, offsets) in offsets.chunks(CHUNK).enumerate() {
            if places_of(self, row_index, offsets, &ALL[..offsets.len()], *places.end(), &mut found) {
                let within = found[..offsets.len()].iter().enumerate().filter(|(_, place)| places.contains(place));
                within.for_each(|(lane, _)| take(number * CHUNK + lane));
            }
        }
    }
}

/// Spreads every bit of a number over all of it: a hash of little bias from C. Wellons' search (github.com/skeeto/hash-prospector).
#[inline(always)]
fn hash(number: u32) -> u32 {
    let mut mixed = number;
    mixed = (mixed ^ mixed >> 16).wrapping_mul(0x21f0_aaad);
    mixed = (mixed ^ mixed >> 15).wrapping_mul(0x735a_2d97);
    mixed ^ mixed >> 15
}

/// The feasible designs of least place so far.
///
/// Invariant: `kept` holds at most `2 * count` designs, and once `count` have been seen, every design of the sample is among them and
/// none beyond `last` can be part of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FeasibleSample {
    count: usize,
    shuffle: Shuffle,
    /// Design indices; where each stands in the order need not be kept.
    kept: Vec<u64>,
    /// The largest place that may be part of it; found again when designs of a checkpoint are taken in.
    #[serde(skip, default = "no_limit")]
    last: u64,
}

fn no_limit() -> u64 {
    u64::MAX
}

impl PartialEq for FeasibleSample {
    fn eq(&self, other: &Self) -> bool {
        (self.count, self.shuffle) == (other.count, other.shuffle) && self.indices() == other.indices()
    }
}

impl FeasibleSample {
    /// Nothing seen yet; `count` is at least 1.
    pub fn new(count: usize, seed: u64) -> Self {
        Self { count, shuffle: Shuffle::new(seed), kept: Vec::new(), last: no_limit() }
    }

    fn push(&mut self, index: u64) {
        self.kept.push(index);
        if self.kept.len() >= 2 * self.count {
            self.shrink();
        }
    }

    fn shrink(&mut self) {
        let shuffle = self.shuffle;
        self.kept.sort_unstable_by_key(|&index| shuffle.place(index));
        // The same design may come twice, when a comparison merges what it has merged before.
        self.kept.dedup();
        self.kept.truncate(self.count);
        if self.kept.len() == self.count {
            self.last = shuffle.place(self.kept[self.count - 1]);
        }
    }

    /// The design indices of the sample, in rising order.
    pub fn indices(&self) -> Vec<u64> {
        let mut own = self.clone();
        own.shrink();
        own.kept.sort_unstable();
        own.kept
    }
}

/// Designs of a block that are looked at together.
const CHUNK: usize = 64;
/// None of them left out.
const ALL: [u64; CHUNK] = [u64::MAX; CHUNK];

/// The places of some designs, and whether any feasible one of them is at most at `last`. Round by round over all of them, in halves of
/// 32 bits: design by design it takes more than twice as long.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
fn places_of(shuffle: Shuffle, row_index: u64, offsets: &[u64], alive: &[u64], last: u64, places: &mut [u64; CHUNK]) -> bool {
    let (mut high, mut low) = ([0u32; CHUNK], [0u32; CHUNK]);
    for ((high, low), &offset) in high.iter_mut().zip(&mut low).zip(offsets) {
        let index = row_index + offset;
        (*high, *low) = ((index >> 32) as u32, index as u32);
    }
    for key in shuffle.keys {
        for (high, low) in high.iter_mut().zip(&mut low) {
            (*high, *low) = (*low, *high ^ hash(*low ^ key));
        }
    }
    for (place, (high, low)) in places.iter_mut().zip(high.into_iter().zip(low)) {
        *place = u64::from(high) << 32 | u64::from(low);
    }
    let mut any = 0;
    for (&place, &alive) in places.iter().zip(alive) {
        any |= alive & u64::from(place <= last);
    }
    any != 0
}

impl Reducer for FeasibleSample {
    const STATE: &'static str = "sample";

    fn asked(plan: &Plan, _ranges: &[(f64, f64)]) -> Vec<Self> {
        plan.study.report.sample.iter().map(|sample| Self::new(sample.count, sample.seed)).collect()
    }

    fn needs(report: &Report) -> Option<ReducerNeeds> {
        report.sample.map(|_| ReducerNeeds::Candidates)
    }

    fn absorb(&mut self, block: &Block<'_>) {
        let mut found = [0; CHUNK];
        for first in (0..block.count()).step_by(CHUNK) {
            let lanes = first..block.count().min(first + CHUNK);
            let (offsets, alive) = (&block.offsets[lanes.clone()], &block.alive[lanes.clone()]);
            if !places_of(self.shuffle, block.row_index, offsets, alive, self.last, &mut found) {
                continue;
            }
            for (lane, place) in lanes.zip(found) {
                if block.alive[lane] != 0 && place <= self.last {
                    self.push(block.index(lane));
                }
            }
        }
    }

    fn merge(&mut self, other: Self) {
        for index in other.kept {
            if self.shuffle.place(index) <= self.last {
                self.push(index);
            }
        }
    }

    fn state(&self) -> Self {
        let mut own = self.clone();
        own.shrink();
        own
    }

    fn fits(&self, asked: &Self, met: u64, designs: u64) -> bool {
        let same = (self.count, self.shuffle) == (asked.count, asked.shuffle);
        let few = self.kept.len() <= 2 * asked.count && self.kept.len() as u64 <= met;
        same && few && self.kept.iter().all(|&index| index < designs)
    }

    fn size(&self) -> u64 {
        self.kept.len() as u64
    }

    fn tell(&mut self, answers: &mut Answers) {
        self.shrink();
        answers.last_place = Some(self.last);
    }

    fn lacks(&self, fuller: &Self) -> Option<(&'static str, u64)> {
        let own = self.indices();
        fuller.indices().into_iter().find(|index| own.binary_search(index).is_err()).map(|index| ("sample", index))
    }

    fn designs(&self) -> Vec<u64> {
        self.indices()
    }

    fn designs_of(&self, feasible: u64) -> Option<u64> {
        Some(feasible.min(self.count as u64))
    }

    fn is_behind_the_front(&self) -> bool {
        true
    }

    fn files(study: &Study) -> Vec<String> {
        study.report.sample.iter().flat_map(|_| FILES.map(str::to_owned)).collect()
    }

    fn is_file(name: &str) -> bool {
        FILES.contains(&name)
    }

    fn write(&self, results: &ReducerResults<'_>, put: &mut Put<'_>) -> Result<()> {
        let table = (results.table)();
        put(FILES[0], csv::write(&table))?;
        #[cfg(feature = "parquet")]
        put(FILES[1], parquet::write(&table)?)?;
        Ok(())
    }

    #[cfg(feature = "pictures")]
    fn page(folder: &Folder<'_>, data: &mut Map<String, Value>) -> Result<()> {
        let Some(asked) = folder.plan.study.report.sample else { return Ok(()) };
        let all = folder.feasible.min(asked.count as u64);
        data.insert("sample".to_owned(), sample::read(&folder.path.join(FILES[0]), folder.plan, all)?);
        Ok(())
    }

    fn room(plan: &Plan) -> ReducerRoom {
        let Some(sample) = plan.study.report.sample else { return ReducerRoom::default() };
        let rows = (sample.count as u64).min(plan.designs());
        ReducerRoom { rows, indices: rows, dots: rows.min(MOST_DOTS), lists: vec![(FILES[0].to_owned(), rows)], ..ReducerRoom::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn places_of_a_block_are_those_of_its_designs() {
        let shuffle = Shuffle::new(9);
        let offsets: Vec<u64> = (0..CHUNK as u64).map(|lane| mix(lane) >> 20).collect();
        for (row_index, count) in [(0, CHUNK), (u64::from(u32::MAX), 7), (u64::MAX >> 1, 1), (5, 0)] {
            let expected: Vec<u64> = offsets[..count].iter().map(|offset| shuffle.place(row_index + offset)).collect();
            let mut found = [0; CHUNK];
            for last in [0, u64::MAX / 2, u64::MAX] {
                let any = places_of(shuffle, row_index, &offsets[..count], &vec![u64::MAX; count], last, &mut found);
                assert_eq!((&found[..count], any), (&expected[..], expected.iter().any(|&place| place <= last)));
                assert!(!places_of(shuffle, row_index, &offsets[..count], &vec![0; count], last, &mut found));
            }
        }
    }

    #[test]
    fn needs_say_who_can_feed_a_reducer() {
        let of = |needs: ReducerNeeds| (needs.beyond_bounds(), needs.beyond_devices());
        assert_eq!([ReducerNeeds::Candidates, ReducerNeeds::Counts].map(of), [(None, None); 2]);
        assert_eq!(of(ReducerNeeds::Designs("why")), (Some("why"), None));
        assert_eq!(of(ReducerNeeds::Blocks("why")), (Some("why"), Some("why")));
    }

    #[test]
    fn places_are_the_known_ones() {
        // By hand from the definition, so that a changed shuffle is noticed: results must not change with it.
        let keys = Shuffle::new(1).keys;
        assert_eq!(keys.len(), ROUNDS);
        let by_hand = |number: u64| {
            let (mut high, mut low) = (number >> 32, number & 0xffff_ffff);
            for key in keys {
                let mut mixed = low ^ u64::from(key);
                for (shift, factor) in [(16, 0x21f0_aaad), (15, 0x735a_2d97)] {
                    mixed = ((mixed ^ mixed >> shift) * factor) & 0xffff_ffff;
                }
                (high, low) = (low, high ^ mixed ^ mixed >> 15);
            }
            high << 32 | low
        };
        for number in [0, 1, 2, 99, u64::from(u32::MAX), 1 << 32, u64::MAX] {
            assert_eq!(Shuffle::new(1).place(number), by_hand(number), "{number}");
        }
    }

    #[test]
    fn no_two_numbers_have_the_same_place_and_every_number_is_as_likely_early() {
        for seed in [0, 1, 2, u64::MAX] {
            let shuffle = Shuffle::new(seed);
            let all: BTreeSet<u64> = (0..100_000).map(|number| shuffle.place(number)).collect();
            assert_eq!(all.len(), 100_000, "seed {seed}");
            // Of each stretch of designs, and of each remainder, a share that is theirs goes into a sample of a tenth.
            let limit = u64::MAX / 10;
            let chosen = |numbers: &mut dyn Iterator<Item = u64>| numbers.filter(|&number| shuffle.place(number) < limit).count();
            for part in 0..10 {
                let (stretch, every) =
                    (chosen(&mut (part * 10_000..(part + 1) * 10_000)), chosen(&mut (0..10_000).map(|it| 10 * it + part)));
                // Five standard deviations of 30.
                assert!((850..1150).contains(&stretch) && (850..1150).contains(&every), "seed {seed}: {stretch} {every}");
            }
        }
        let early = |seed| (0..1000).min_by_key(|&number| Shuffle::new(seed).place(number));
        assert!((0..20).map(early).collect::<BTreeSet<_>>().len() > 10, "seeds differ");
    }

    #[test]
    fn the_sample_is_that_of_sorting_everything_however_it_came() {
        for (count, seed) in [(1, 1), (7, 2), (50, 3), (2000, 4)] {
            let feasible = |index: u64| !mix(index ^ 77).is_multiple_of(3);
            let blocks = [600u64, 0, 900, 300].map(|first| {
                let alive: Vec<u64> = (first..first + 300).map(|index| if feasible(index) { u64::MAX } else { 0 }).collect();
                (first, alive)
            });
            let offsets: Vec<u64> = (0..300).collect();
            let block = |(first, alive): &(u64, Vec<u64>), sample: &mut FeasibleSample| {
                sample.absorb(&Block { row_index: *first, offsets: &offsets, feasible_count: 200, alive, values: &[] });
            };
            let mut whole = FeasibleSample::new(count, seed);
            blocks.iter().for_each(|it| block(it, &mut whole));
            let mut parts = FeasibleSample::new(count, seed);
            for it in blocks.iter().rev().chain(&blocks[1..3]) {
                // What is merged twice counts once, and a checkpoint keeps all that matters.
                let mut part = FeasibleSample::new(count, seed);
                block(it, &mut part);
                let bytes = postcard::to_stdvec(&part.state()).expect("it can be written");
                let read: FeasibleSample = postcard::from_bytes(&bytes).expect("it was written so");
                assert!(read.fits(&FeasibleSample::new(count, seed), 300, 1200));
                assert!(
                    !read.fits(&FeasibleSample::new(count, seed + 1), 300, 1200)
                        && !read.fits(&whole, 300, 1)
                        && !read.fits(&whole, 0, 1200)
                );
                parts.merge(read);
            }
            let mut all: Vec<u64> = (0..1200).filter(|&index| feasible(index)).collect();
            all.sort_by_key(|&index| Shuffle::new(seed).place(index));
            all.truncate(count);
            all.sort_unstable();
            assert_eq!((whole.indices(), &parts), (all, &whole));
            assert_eq!((whole.lacks(&parts), parts.designs_of(9)), (None, Some(9.min(count as u64))));
        }
    }
}
