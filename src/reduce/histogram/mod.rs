//! How a quantity's worst value is distributed over the feasible designs.

#[cfg(feature = "pictures")]
mod page;

use super::naming::{is_named, numbered};
use super::reducer::{Put, Reducer, ReducerNeeds, ReducerResults, ReducerRoom};
use crate::error::Result;
use crate::plan::{Plan, worst_end};
#[cfg(feature = "pictures")]
use crate::reading::Folder;
use crate::screen::Block;
use crate::study::{Report, Study};
use crate::table::csv;
use crate::table::{Data, Table, TableColumn};
use serde::{Deserialize, Serialize};
#[cfg(feature = "pictures")]
use serde_json::{Map, Value};

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
    /// Every [`Histogram::edge`], once it is needed often.
    #[serde(skip)]
    edges: Vec<f64>,
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
        Self { from, to, counts: vec![0; bins], below: 0, above: 0, column: Some(column), edges: Vec::new() }
    }

    /// Lower edge of a bin, or the upper edge of the last.
    #[allow(clippy::cast_precision_loss, reason = "bins are few")]
    pub fn edge(&self, bin: usize) -> f64 {
        let (bins, width) = (self.counts.len() as f64, self.to - self.from);
        match bin as f64 {
            bin if bin == bins => self.to,
            bin if width.is_finite() => self.from + bin * width / bins,
            // Ends so far apart that their distance is more than f64 holds.
            bin => self.from * (1.0 - bin / bins) + self.to * (bin / bins),
        }
    }

    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss, reason = "the value is in range")]
    pub(crate) fn count(&mut self, value: f64) {
        if value < self.from {
            self.below += 1;
        } else if value > self.to {
            self.above += 1;
        } else {
            let bins = self.counts.len();
            let guess = ((value - self.from) / (self.to - self.from) * bins as f64) as usize;
            let mut bin = guess.min(bins - 1);
            // The guess rounds; the edges decide.
            while bin > 0 && value < self.edge(bin) {
                bin -= 1;
            }
            while bin + 1 < bins && value >= self.edge(bin + 1) {
                bin += 1;
            }
            self.counts[bin] += 1;
        }
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

    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss, reason = "the edges decide")]
    fn absorb(&mut self, block: &Block<'_>) {
        let column = self.column.expect("a histogram that takes in blocks was made for a plan");
        let bins = self.counts.len();
        if self.edges.is_empty() {
            self.edges = (0..=bins).map(|bin| self.edge(bin)).collect();
        }
        let (from, per_unit) = (self.from, bins as f64 / (self.to - self.from));
        // Neighbours often have one value, above all where values are whole numbers: those are counted by runs.
        let (mut last, mut run, mut place) = (f64::NAN, 0, 0);
        for (&alive, &value) in block.alive.iter().zip(&block.values[column]) {
            if alive == 0 {
                continue;
            }
            if value == last {
                run += 1;
                continue;
            }
            let guess = (((value - from) * per_unit) as usize).min(bins - 1);
            if value >= self.edges[guess] && value < self.edges[guess + 1] {
                self.counts[place] += run;
                (last, run, place) = (value, 1, guess);
            } else {
                self.count(value);
            }
        }
        self.counts[place] += run;
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
        for bin in 0..=6 {
            histogram.count(histogram.edge(bin));
            histogram.count(histogram.edge(bin).next_down());
        }
        histogram.count(0.7f64.next_up());
        let wide = Histogram::new((-1.7e308, 1.7e308), 4, 0);
        let edges = [0, 1, 2, 3, 4].map(|bin| wide.edge(bin));
        let near = edges.iter().zip([-1.7e308, -0.85e308, 0.0, 0.85e308, 1.7e308]).all(|(a, b)| (a - b).abs() <= 1e-15 * b.abs());
        assert!(near && edges[0] == wide.from && edges[4] == wide.to, "{edges:?}");
        assert_eq!(histogram.counts, [2, 2, 2, 2, 2, 3]);
        assert_eq!((histogram.below, histogram.above), (1, 1));
    }
}
