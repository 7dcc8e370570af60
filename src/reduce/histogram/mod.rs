//! How a quantity's worst value is distributed over the feasible designs.

#[cfg(feature = "pictures")]
mod page;

use super::naming::{is_named, numbered};
use super::reducer::{Put, Reducer, ReducerNeeds, ReducerResults, ReducerRoom};
use crate::error::Result;
use crate::plan::{Plan, worst_end};
#[cfg(feature = "pictures")]
use crate::reading::Folder;
use crate::screen::{Block, SortedRow};
use crate::study::{Report, Study};
use crate::table::csv;
use crate::table::{Data, Table, TableColumn};
use serde::{Deserialize, Serialize};
#[cfg(feature = "pictures")]
use serde_json::{Map, Value};

/// Counting so many designs one by one takes about as long as finding one edge among them.
const EDGE: usize = 12;

/// Counts per bin. Bin `i` of `n` holds `edge(i) <= value < edge(i + 1)`; the last one also its upper edge.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Histogram {
    /// Lower edge of the first bin.
    pub from: f64,
    /// Upper edge of the last bin.
    pub to: f64,
    /// Designs per bin.
    pub counts: Vec<u64>,
    /// Designs below the first bin.
    pub below: u64,
    /// Designs above the last bin.
    pub above: u64,
    /// Where its values are among those of a block; none where it was read from a checkpoint.
    #[serde(skip)]
    column: Option<usize>,
    /// What a value must be below to lie at each place but the last, once that is needed often: see [`Histogram::limit`].
    #[serde(skip)]
    limits: Vec<f64>,
}

impl PartialEq for Histogram {
    fn eq(&self, other: &Self) -> bool {
        let ends = |it: &Self| (it.from, it.to, it.below, it.above);
        ends(self) == ends(other) && self.counts == other.counts
    }
}

impl Histogram {
    /// Empty bins over a range that is not empty; `column` is where the values are among those of a block.
    pub fn new((from, to): (f64, f64), bins: usize, column: usize) -> Self {
        Self { from, to, counts: vec![0; bins], below: 0, above: 0, column: Some(column), limits: Vec::new() }
    }

    /// Lower edge of a bin, or the upper edge of the last.
    #[allow(clippy::cast_precision_loss, reason = "bins are few")]
    pub fn edge(&self, bin: usize) -> f64 {
        let (bins, width) = (self.counts.len() as f64, self.to - self.from);
        match bin as f64 {
            bin if bin == bins => self.to,
            bin if (bins * width).is_finite() => self.from + bin * width / bins,
            // Ends so far apart that a multiple of their distance is more than f64 holds.
            bin => self.from * (1.0 - bin / bins) + self.to * (bin / bins),
        }
    }

    /// What a value must be below to lie at a place, see [`Histogram::place`]: the bin's upper edge, and of the last bin the number after it.
    fn limit(&self, place: usize) -> f64 {
        if place == self.counts.len() { self.to.next_up() } else { self.edge(place) }
    }

    fn find_limits(&mut self) {
        if self.limits.is_empty() {
            self.limits = (0..=self.counts.len()).map(|place| self.limit(place)).collect();
        }
    }

    /// Where a value lies: 0 below the first bin, then bin by bin, and above the last one.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss, reason = "the value is in range")]
    pub(crate) fn place(&self, value: f64) -> usize {
        let bins = self.counts.len();
        if value < self.from {
            return 0;
        }
        if value > self.to {
            return bins + 1;
        }
        let guess = ((value - self.from) / (self.to - self.from) * bins as f64) as usize;
        let mut bin = guess.min(bins - 1);
        // The guess rounds; the edges decide.
        while bin > 0 && value < self.edge(bin) {
            bin -= 1;
        }
        while bin + 1 < bins && value >= self.edge(bin + 1) {
            bin += 1;
        }
        bin + 1
    }

    /// Adds designs whose values lie at a place.
    fn add_at(&mut self, place: usize, count: u64) {
        *match place.checked_sub(1) {
            None => &mut self.below,
            Some(bin) => self.counts.get_mut(bin).unwrap_or(&mut self.above),
        } += count;
    }

    /// Counts the values of those that are feasible, one by one.
    #[inline(always)]
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss, reason = "the edges decide")]
    fn count(&mut self, designs: impl Iterator<Item = (bool, f64)>) {
        self.find_limits();
        let bins = self.counts.len();
        let (from, per_unit) = (self.from, bins as f64 / (self.to - self.from));
        // Neighbours often have one value, above all where values are whole numbers: those are counted by runs.
        let (mut last, mut run, mut bin) = (f64::NAN, 0, 0);
        for (is_feasible, value) in designs {
            if !is_feasible {
                continue;
            }
            if value == last {
                run += 1;
                continue;
            }
            let guess = (((value - from) * per_unit) as usize).min(bins - 1);
            if value >= self.limits[guess] && value < self.limits[guess + 1] {
                self.counts[bin] += run;
                (last, run, bin) = (value, 1, guess);
            } else {
                self.count_at_place(value);
            }
        }
        self.counts[bin] += run;
    }

    /// Counts the designs of a row one by one.
    fn count_row(&mut self, row: &mut SortedRow<'_>, column: usize) {
        self.count(row.values(column).iter().map(|&value| (true, value)));
    }

    /// Counts a value whose bin was guessed wrongly, or that lies in none. There are few, so it is kept out of the loop over the others.
    #[cold]
    #[inline(never)]
    fn count_at_place(&mut self, value: f64) {
        self.add_at(self.place(value), 1);
    }

    /// Adds counts that were made elsewhere: below, every bin, above.
    pub fn add<N: Copy + Into<u64>>(&mut self, counts: &[N]) {
        let (below, rest) = counts.split_first().expect("there is a count below");
        let (above, bins) = rest.split_last().expect("there is a count above");
        self.below += (*below).into();
        self.above += (*above).into();
        self.counts.iter_mut().zip(bins).for_each(|(count, &bin)| *count += bin.into());
    }

    /// Bins; the first row counts what lies below, the last what lies above.
    pub fn table(&self) -> Table {
        let bins = self.counts.len();
        let edges = |shift: usize| (0..bins).map(move |bin| Some(self.edge(bin + shift)));
        let from = std::iter::once(None).chain(edges(0)).chain([Some(self.to)]).collect();
        let to = std::iter::once(Some(self.from)).chain(edges(1)).chain([None]).collect();
        let counts = std::iter::once(self.below).chain(self.counts.iter().copied()).chain([self.above]).map(Some).collect();
        Table {
            columns: vec![
                TableColumn::new("from", "bin", "Lower edge of the bin, included.", Data::Number(from)),
                TableColumn::new("to", "bin", "Upper edge of the bin, excluded but for the last bin.", Data::Number(to)),
                TableColumn::new("designs", "count", "Feasible designs whose worst value lies in the bin.", Data::Whole(counts)),
            ],
        }
    }
}

/// Names of the files of a study's histograms, without their extension.
pub fn names(study: &Study) -> Vec<String> {
    numbered(study.report.histograms.iter().map(|spec| format!("histogram-{}", spec.of.name(&study.model))))
}

impl Reducer for Histogram {
    const STATE: &'static str = "histograms";

    fn asked(plan: &Plan, ranges: &[(f64, f64)]) -> Vec<Self> {
        let all = plan.study.report.histograms.iter().zip(ranges);
        all.map(|(spec, &range)| Self::new(range, spec.bins, plan.position(spec.of, worst_end(&plan.study, spec.of)))).collect()
    }

    fn needs(report: &Report) -> Option<ReducerNeeds> {
        (!report.histograms.is_empty()).then_some(ReducerNeeds::Counts)
    }

    fn absorb(&mut self, block: &Block<'_>) {
        let column = self.column.expect("a histogram that takes in blocks was made for a plan");
        self.count(block.alive.iter().zip(&block.values[column]).map(|(&alive, &value)| (alive != 0, value)));
    }

    fn absorb_row(&mut self, row: &mut SortedRow<'_>) {
        let column = self.column.expect("a histogram that takes in rows was made for a plan");
        let Some((first, last)) = row.ends(column) else { return self.count_row(row, column) };
        let (low, high) = (self.place(first.min(last)), self.place(first.max(last)));
        if (high - low) * EDGE > row.count() {
            return self.count_row(row, column);
        }
        self.find_limits();
        let limits = std::mem::take(&mut self.limits);
        let (mut place, mut below) = (low, 0);
        row.count_below(column, &limits[low..high], |next| {
            self.add_at(place, (next - below) as u64);
            (place, below) = (place + 1, next);
        });
        self.add_at(high, (row.count() - below) as u64);
        self.limits = limits;
    }

    fn absorb_counted(&mut self, _block: &Block<'_>) {}

    fn merge(&mut self, other: Self) {
        self.counts.iter_mut().zip(&other.counts).for_each(|(count, other)| *count += other);
        self.below += other.below;
        self.above += other.above;
    }

    fn fits(&self, asked: &Self, met: u64, _designs: u64) -> bool {
        let same = (self.from, self.to, self.counts.len()) == (asked.from, asked.to, asked.counts.len());
        let counts = self.counts.iter().chain([&self.below, &self.above]);
        same && counts.copied().try_fold(0, u64::checked_add).is_some_and(|sum| sum <= met)
    }

    fn size(&self) -> u64 {
        self.counts.len() as u64
    }

    /// Below, every bin, above.
    fn count_words(&self) -> usize {
        self.counts.len() + 2
    }

    fn add_counts(&mut self, counts: &[u32]) {
        self.add(counts);
    }

    fn miscounts(&self, other: &Self) -> Option<(&'static str, u64, u64)> {
        let ends = [(self.below, other.below), (self.above, other.above)];
        let bins = self.counts.iter().copied().zip(other.counts.iter().copied());
        bins.chain(ends).find(|(own, other)| own != other).map(|(own, other)| ("designs in a bin", own, other))
    }

    fn files(study: &Study) -> Vec<String> {
        names(study).iter().flat_map(|name| ["csv", "svg"].map(|end| format!("{name}.{end}"))).collect()
    }

    fn is_file(name: &str) -> bool {
        // Those of other versions among them.
        is_named(name, "histogram-", &["csv", "parquet", "svg"])
    }

    fn write(&self, results: &ReducerResults<'_>, put: &mut Put<'_>) -> Result<()> {
        let study = &results.plan.study;
        let name = &names(study)[results.number];
        put(&format!("{name}.csv"), csv::write(&self.table()))?;
        #[cfg(feature = "pictures")]
        put(&format!("{name}.svg"), page::picture(study, &study.report.histograms[results.number], self).into_bytes())?;
        Ok(())
    }

    #[cfg(feature = "pictures")]
    fn page(folder: &Folder<'_>, data: &mut Map<String, Value>) -> Result<()> {
        page::histograms(folder, data)
    }

    fn room(plan: &Plan) -> ReducerRoom {
        ReducerRoom { bins: plan.study.report.histograms.iter().map(|it| it.bins as u64).sum(), ..ReducerRoom::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_decide_and_what_is_outside_is_counted() {
        let mut histogram = Histogram::new((0.1, 0.7), 6, 0);
        let edges: Vec<f64> = (0..=6).map(|bin| histogram.edge(bin)).collect();
        let values = edges.iter().flat_map(|edge| [*edge, edge.next_down()]).chain([0.7f64.next_up()]);
        histogram.count(values.map(|value| (true, value)));
        let wide = Histogram::new((-1.7e308, 1.7e308), 4, 0);
        let edges = [0, 1, 2, 3, 4].map(|bin| wide.edge(bin));
        let near = edges.iter().zip([-1.7e308, -0.85e308, 0.0, 0.85e308, 1.7e308]).all(|(a, b)| (a - b).abs() <= 1e-15 * b.abs());
        assert!(near && edges[0] == wide.from && edges[4] == wide.to, "{edges:?}");
        assert_eq!(histogram.counts, [2, 2, 2, 2, 2, 3]);
        assert_eq!((histogram.below, histogram.above), (1, 1));
    }

    #[test]
    fn a_value_lies_beyond_the_edges_below_it() {
        for (range, bins) in [((0.1, 0.7), 6), ((-1.7e308, 1.7e308), 5), ((0.0, 1e308), 3), ((0.0, f64::from_bits(3)), 4)] {
            let histogram = Histogram::new(range, bins, 0);
            let edges: Vec<f64> = (0..=bins).map(|bin| histogram.edge(bin)).collect();
            assert!(edges.is_sorted() && edges.iter().all(|edge| edge.is_finite()), "{edges:?}");
            for value in edges.iter().flat_map(|&edge| [edge.next_down(), edge, edge.next_up()]) {
                let passed = edges[..bins].iter().filter(|edge| value >= **edge).count() + usize::from(value > edges[bins]);
                assert_eq!(histogram.place(value), passed, "{value:e} in {range:?}");
            }
        }
    }
}
